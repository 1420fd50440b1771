"""Coefficients of Runge–Kutta methods, written for accelerations.

A stage of x' = v, v' = a is  v_s = v + h Σ a_sj a_j,  x_s = x + c_s h v + h² Σ (A²)_sj a_j: the velocities of
earlier stages are themselves sums of accelerations, so that only these need to be kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pinjoint.components.arrays import Array

Sparse = dict[int, float]  # by stage, zeros left out


@dataclass(frozen=True)
class Tableau:
    """A Runge–Kutta method.

    stages: a_sj by row; weights: of the result. order: of the result; estimate_order: the power of the step
    that the estimated error is proportional to. errors: weights of the embedded estimates of the error
    (none: the method has none).
    """

    order: int
    stages: tuple[Sparse, ...]
    weights: Sparse
    estimate_order: int = 0
    errors: tuple[Sparse, ...] = ()

    @cached_property
    def matrix(self) -> Array:
        """a_sj, shape (stages, stages)."""
        return np.array([self._row(row) for row in self.stages])

    def _row(self, sparse: Sparse) -> Array:
        row = np.zeros(len(self.stages))
        row[list(sparse)] = list(sparse.values())
        return row

    @property
    def constants(self) -> dict[str, Any]:
        """The tableau by the names of templates/runge_kutta.py; _V of velocities, _X of displacements."""
        weights = [self._row(self.weights), *(self._row(error) for error in self.errors)]
        return {
            "STAGES": len(self.stages),
            "EXPLICIT": not any(stage in row for stage, row in enumerate(self.stages)),
            "ESTIMATES": len(self.errors),
            "EXPONENT": 1.0 / self.estimate_order if self.errors else 0.0,
            "NODES": self.matrix.sum(axis=1),
            "STAGE_V": self.matrix,
            "STAGE_X": self.matrix @ self.matrix,
            "RESULT_V": np.array(weights),
            "RESULT_X": np.array([row @ self.matrix for row in weights]),
        }


# W. Kutta, Zeitschrift für Mathematik und Physik 46 (1901).
CLASSICAL = Tableau(
    order=4, stages=({}, {0: 1 / 2}, {1: 1 / 2}, {2: 1.0}), weights={0: 1 / 6, 1: 1 / 3, 2: 1 / 3, 3: 1 / 6}
)

# E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), II.5 and II.10:
# Dormand and Prince's method of order 8 with estimates of order 5 and 3.
DORMAND_PRINCE_8 = Tableau(
    order=8,
    estimate_order=8,
    stages=(
        {},
        {0: 5.26001519587677318785587544488e-2},
        {0: 1.97250569845378994544595329183e-2, 1: 5.91751709536136983633785987549e-2},
        {0: 2.95875854768068491816892993775e-2, 2: 8.87627564304205475450678981324e-2},
        {
            0: 2.41365134159266685502369798665e-1,
            2: -8.84549479328286085344864962717e-1,
            3: 9.24834003261792003115737966543e-1,
        },
        {
            0: 3.7037037037037037037037037037e-2,
            3: 1.70828608729473871279604482173e-1,
            4: 1.25467687566822425016691814123e-1,
        },
        {
            0: 3.7109375e-2,
            3: 1.70252211019544039314978060272e-1,
            4: 6.02165389804559606850219397283e-2,
            5: -1.7578125e-2,
        },
        {
            0: 3.70920001185047927108779319836e-2,
            3: 1.70383925712239993810214054705e-1,
            4: 1.07262030446373284651809199168e-1,
            5: -1.53194377486244017527936158236e-2,
            6: 8.27378916381402288758473766002e-3,
        },
        {
            0: 6.24110958716075717114429577812e-1,
            3: -3.36089262944694129406857109825,
            4: -8.68219346841726006818189891453e-1,
            5: 2.75920996994467083049415600797e1,
            6: 2.01540675504778934086186788979e1,
            7: -4.34898841810699588477366255144e1,
        },
        {
            0: 4.77662536438264365890433908527e-1,
            3: -2.48811461997166764192642586468,
            4: -5.90290826836842996371446475743e-1,
            5: 2.12300514481811942347288949897e1,
            6: 1.52792336328824235832596922938e1,
            7: -3.32882109689848629194453265587e1,
            8: -2.03312017085086261358222928593e-2,
        },
        {
            0: -9.3714243008598732571704021658e-1,
            3: 5.18637242884406370830023853209,
            4: 1.09143734899672957818500254654,
            5: -8.14978701074692612513997267357,
            6: -1.85200656599969598641566180701e1,
            7: 2.27394870993505042818970056734e1,
            8: 2.49360555267965238987089396762,
            9: -3.0467644718982195003823669022,
        },
        {
            0: 2.27331014751653820792359768449,
            3: -1.05344954667372501984066689879e1,
            4: -2.00087205822486249909675718444,
            5: -1.79589318631187989172765950534e1,
            6: 2.79488845294199600508499808837e1,
            7: -2.85899827713502369474065508674,
            8: -8.87285693353062954433549289258,
            9: 1.23605671757943030647266201528e1,
            10: 6.43392746015763530355970484046e-1,
        },
    ),
    weights={
        0: 5.42937341165687622380535766363e-2,
        5: 4.45031289275240888144113950566,
        6: 1.89151789931450038304281599044,
        7: -5.8012039600105847814672114227,
        8: 3.1116436695781989440891606237e-1,
        9: -1.52160949662516078556178806805e-1,
        10: 2.01365400804030348374776537501e-1,
        11: 4.47106157277725905176885569043e-2,
    },
    errors=(
        {
            0: 0.1312004499419488073250102996e-01,
            5: -0.1225156446376204440720569753e01,
            6: -0.4957589496572501915214079952e00,
            7: 0.1664377182454986536961530415e01,
            8: -0.3503288487499736816886487290e00,
            9: 0.3341791187130174790297318841e00,
            10: 0.8192320648511571246570742613e-01,
            11: -0.2235530786388629525884427845e-01,
        },
        {
            0: 5.42937341165687622380535766363e-2 - 0.244094488188976377952755905512,
            5: 4.45031289275240888144113950566,
            6: 1.89151789931450038304281599044,
            7: -5.8012039600105847814672114227,
            8: 3.1116436695781989440891606237e-1 - 0.733846688281611857341361741547,
            9: -1.52160949662516078556178806805e-1,
            10: 2.01365400804030348374776537501e-1,
            11: 4.47106157277725905176885569043e-2 - 0.220588235294117647058823529412e-1,
        },
    ),
)

# C. A. Kennedy, M. H. Carpenter, Applied Numerical Mathematics 44 (2003) 139–181, the implicit part of
# ARK4(3)6L[2]SA: every stage but the first is implicit with the same γ = 1/4; the last one is the result.
_LAST = {0: 82889 / 524892, 2: 15625 / 83664, 3: 69875 / 102672, 4: -2260 / 8211, 5: 1 / 4}
_EMBEDDED = {
    0: 4586570599 / 29645900160,
    2: 178811875 / 945068544,
    3: 814220225 / 1159782912,
    4: -3700637 / 11593932,
    5: 61727 / 225920,
}
KENNEDY_CARPENTER_4 = Tableau(
    order=4,
    estimate_order=4,
    stages=(
        {},
        {0: 1 / 4, 1: 1 / 4},
        {0: 8611 / 62500, 1: -1743 / 31250, 2: 1 / 4},
        {0: 5012029 / 34652500, 1: -654441 / 2922500, 2: 174375 / 388108, 3: 1 / 4},
        {
            0: 15267082809 / 155376265600,
            1: -71443401 / 120774400,
            2: 730878875 / 902184768,
            3: 2285395 / 8070912,
            4: 1 / 4,
        },
        _LAST,
    ),
    weights=_LAST,
    errors=({stage: _LAST[stage] - weight for stage, weight in _EMBEDDED.items()},),
)
