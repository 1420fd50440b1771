"""Integrators: how accurate each is, up to which step it is stable, and when to choose it.

Their functions are templates: fixed_steps.py, runge_kutta.py and implicit.py in systems/program/templates.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.systems.base import Integrator
from pinjoint.systems.physics.tableaus import CLASSICAL, DORMAND_PRINCE_8, KENNEDY_CARPENTER_4, Tableau

_RUNGE_KUTTA = "pinjoint.systems.program.templates.runge_kutta"
_IMPLICIT = "pinjoint.systems.program.templates.implicit"
_FIXED_STEPS = "pinjoint.systems.program.templates.fixed_steps"

_SEARCHED = ("extrapolate", "accelerate", "error_of", "combine", "begin_search", "narrow", "follow")
_CONTROLLED = tuple(f"{_RUNGE_KUTTA}:{part}" for part in _SEARCHED)
_SOLVED = ("relax", "precondition", "multiply", "correct", "size_of", "implicit_stages=stages")


class VelocityVerlet(Integrator):
    """2nd order, the quickest step: for large models. Its energy error stays bounded for ever.

    Symplectic without dampers. These are evaluated at the corrected velocity, which keeps the order and most
    of the stable step. An impact or a rod that yields within a step costs the order: the error is then O(h).
    """

    name = "physics.velocity_verlet"
    begins = f"{_FIXED_STEPS}:verlet_begins"
    ends = f"{_FIXED_STEPS}:verlet_ends"
    order: ClassVar[int] = 2
    guard = 1.0
    push = 0.5

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """(2/ω)(√(1+ζ²) − ζ), written so that no digits cancel and that ω may be 0."""
        return 2.0 / (math.hypot(frequency, decay) + decay)


class SemiImplicitEuler(VelocityVerlet):
    """1st order, energy bounded for ever: to compare with.

    Symplectic without dampers, and stable up to the step of velocity Verlet.
    """

    name = "physics.semi_implicit_euler"
    guard = 2.0
    push = 1.0
    begins = f"{_FIXED_STEPS}:euler_begins"
    ends = ""
    order: ClassVar[int] = 1


class ThesisTaylor(Integrator):
    """1st order, the thesis' scheme: to compare with. Without damping energy grows at any step.

    x += v h + a h²/2, v += a h: the energy of an undamped mode grows by (ωh)²/2 a step.
    """

    name = "physics.taylor2"
    push = 0.5
    begins = f"{_FIXED_STEPS}:taylor2_begins"
    ends = f"{_FIXED_STEPS}:taylor2_ends"
    order: ClassVar[int] = 1

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """The lesser of 4ζ/ω and 1/(ζω); 0 without damping.

        For a = −ω²x − 2ζωv the amplification matrix has trace 2 − z²/2 − 2ζz and determinant
        1 − 2ζz + z²/2 (z = ωh; the ζz³ terms cancel): by Jury's conditions z ≤ 4ζ and z ≤ 1/ζ. It holds
        for one mode; in a model, a mode with less damping than its share may still grow.
        """
        if decay == 0.0:
            return 0.0
        limit = 1.0 / decay
        return limit if frequency == 0.0 else min(limit, 4.0 * decay / frequency**2)


def runge_kutta_constants(tableau: Tableau, proportional: float = 0.0, lengthen: float = 6.0) -> dict[str, Any]:
    """A tableau's constants and those of the loop in runge_kutta.py.

    proportional: how much the next step follows the change of the error (0: not at all).
    """
    return (
        tableau.constants
        | {
            "SHORTEN": 0.2,  # least and
            "LENGTHEN": lengthen,  # most that a step is multiplied by to get the next
            "LEAST_ERROR": 1e-4,  # smaller ones say nothing about the next
            "BEYOND": 1e300,  # the error of a step that has no result
            "PROPORTIONAL": proportional,
            "ROUND_OFF_X": 1e-15,  # of the largest displacement: errors below it are not chased
            "ROUND_OFF_V": 1e-13,  # the same per longest step, for velocities
            "LEAST_TURN": 1e-3,  # share of what displacements amount to, below which no error of rotations counts
            "FIXED_TOLERANCE": 1e-10,  # of implicit stages where nothing else says how exact they must be
            "SMALLEST_SHARE": 1e-12,  # of the step to try, below which the run is given up
            "EVENT_FLOOR": 1e-11,  # share of a strength within which an event is located
            "EVENT_WIDTH": 1e-10,  # share of a step within which it is
            "EVENT_PATIENCE": 3.0,  # how often one end of the interval it lies in moves before the interval is halved
            "SLACK": 0.0,
        }
    )


class RungeKutta4(Integrator):
    """4th order, steps all alike: exact for smooth motion at little cost. It loses a little energy.

    The energy of an undamped mode falls by (ωh)⁶/72 a step. Yielding and unloading end a step, so that the
    order is kept.
    """

    name = "physics.rk4"
    parts = (*_CONTROLLED, f"{_RUNGE_KUTTA}:explicit_stages=stages", f"{_RUNGE_KUTTA}:attempt")
    order: ClassVar[int] = 4
    controlled = True
    guard = -1.0
    constants = runge_kutta_constants(CLASSICAL)
    particle_rows = 4 + 2
    radius: ClassVar[float] = 2.61

    @classmethod
    def stable_step(cls, frequency: float, decay: float) -> float:
        """radius / max(ω, 2ζω)."""
        return cls.radius / max(frequency, 2.0 * decay)


class DormandPrince853(RungeKutta4):
    """8th order with error control: the most exact for small models that are not stiff.

    Embedded estimates of order 5 and 3 choose the step so that settings.tolerance is met; energy is as exact
    as that. Yielding, unloading and the kinks of loads end steps. Stability limits the step, too.
    """

    name = "physics.dop853"
    order: ClassVar[int] = 8
    estimates_error = True
    constants = runge_kutta_constants(DORMAND_PRINCE_8, proportional=0.04)
    particle_rows = 12 + 2
    radius: ClassVar[float] = 5.96
    check_interval = 8


class ImplicitRungeKutta4(RungeKutta4):
    """4th order with error control, implicit, stable at every step: for stiff and strongly damped models.

    Six stages, of which five are implicit, L-stable: vibrations much faster than the step die out instead of
    being followed, and energy with them. Each stage is solved by Newton's method and conjugate gradients.
    A step that a person fixes at many periods may end in another equilibrium than the nearest.
    """

    name = "physics.esdirk4"
    parts = (*_CONTROLLED, *(f"{_IMPLICIT}:{part}" for part in _SOLVED), f"{_RUNGE_KUTTA}:attempt")
    estimates_error = True
    constants = (
        runge_kutta_constants(KENNEDY_CARPENTER_4, proportional=0.08, lengthen=2.0)
        | {
            "GAMMA": 0.25,
            "ROUND_OFF_V": 1e-15,  # stages are solved for accelerations: steps so short that a jump is crossed know them
            "MOST_CORRECTIONS": 10,
            "NEWTON_SHARE": 1e-2,
            "NEWTON_FLOOR": 1e-12,
            "SOLVER_SHARE": 1e-9,
        }
    )
    particle_rows = 6 + 13
    rod_rows = 2
    check_interval = 2

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """Infinite."""
        return math.inf


_EXACT = VelocityVerlet, DormandPrince853, ImplicitRungeKutta4, RungeKutta4
INTEGRATORS: dict[str, Integrator] = EXTENSIONS.integrators  # ours, then those of mods
# the last two to compare with
INTEGRATORS |= {kind.key: kind for kind in (kind() for kind in (*_EXACT, SemiImplicitEuler, ThesisTaylor))}
