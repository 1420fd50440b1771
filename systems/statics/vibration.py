"""Natural vibrations of a structure, unloaded or about an equilibrium under load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import LinearOperator, eigsh

from pinjoint.components import written
from pinjoint.components.arrays import ROUND_OFF, Array
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.systems.statics.assembly import Matrix
from pinjoint.systems.statics.equations import Structure, largest
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.factor import Factor, pseudo_random
from pinjoint.systems.statics.masses import Divided
from pinjoint.systems.statics.response import Response
from pinjoint.systems.statics.settle import UNBALANCED
from pinjoint.systems.statics.state import Start, StaticState
from pinjoint.systems.statics.theory import FULL

LOWEST = 10  # modes of larger structures, unless more are asked for
SHIFT = 1e-9  # below zero, of the highest ω², so that mechanisms (ω = 0) can be found too
ALIKE = 0.01  # share by which frequencies with masses along rods and in particles may differ without a word


@dataclass(frozen=True)
class Vibrations:
    """angular_squared: ω² (rad²/s²), ascending, (k,); negative if the equilibrium is not stable.

    modes: (k, n, 2), where members bend with rotations (n, 3), the largest motion of each 1, of the particles and
    behind them the places where rods were divided. structure: with these. place: how far these are displaced; 0 if unloaded.
    total: the number of modes that there are. lumped: the lowest frequency (Hz) above 0 with all masses in particles, as in
    motion; None: nothing vibrates so.
    """

    angular_squared: Array
    modes: Array
    structure: Structure
    place: Array
    total: int
    lumped: float | None

    @classmethod
    def of(cls, model: Model, state: StaticState | Start | None = None, count: int | None = None) -> Vibrations:
        """The lowest natural modes of small undamped vibrations, K φ = ω² M φ, in which no rod yields.

        Rods that bend have their masses all along them, and are divided: modes are those that the parts show closely, the
        lowest in any case. All other masses lie in particles.

        state: the equilibrium about which the structure vibrates, stiffened or softened by its axial forces; None: the
        original positions, without axial forces and with taut cables. count: number of modes; None: all of a small
        structure, 10 of a large one.
        """
        divided, whole = Divided.of(model), Structure.of(model).with_translations()
        masses = whole.field(np.repeat(model.particles.mass, 2).reshape(-1, 2), model.particles.inertia)
        place, response = np.zeros(whole.unknown.shape), whole.unmoved
        if state is not None:
            place, response = _present(whole, state)
        mass = whole.along_unknowns(masses) / 1000.0
        values, vectors = _modes(whole, response, state is not None, mass, count)
        lumped = np.sqrt(values[values > 0.0][:1]) / (2.0 * np.pi)
        structure, total = whole, whole.size
        if divided is not None:
            structure = divided.structure
            place, response = np.zeros(structure.unknown.shape), structure.unmoved
            if state is not None:
                place, response = divided.at(state)
            values, vectors = _modes(
                structure, response, state is not None, divided.inertia(response.axis), count
            )
            total = max(int((values <= divided.highest).sum()), int((values <= 0.0).sum()) + 1)
            values, vectors = values[:total], vectors[:, :total]
        return cls(
            values,
            structure.motions(vectors),
            structure,
            place,
            total,
            float(lumped[0]) if len(lumped) else None,
        )

    @property
    def hertz(self) -> Array:
        """Frequencies (Hz), 0 for mechanisms and for motions that are not stable."""
        return np.sqrt(np.maximum(self.angular_squared, 0.0)) / (2.0 * np.pi)

    @property
    def note(self) -> str:
        """A sentence about the lowest frequency with masses in particles, as in motion; "" where it is about the same."""
        moving = self.hertz[self.angular_squared > 0.0]
        if not len(moving):
            return ""
        if self.lumped is None:
            return tr(
                "Motion in time has all masses in the joints, where nothing vibrates here; divide the rods to see"
                " them swing."
            )
        if abs(self.lumped - moving[0]) <= ALIKE * moving[0]:
            return ""
        return tr(
            "Motion in time has all masses in the joints: its lowest frequency is {hertz} Hz here, closer to this one if"
            " rods are divided.",
            hertz=written.number(self.lumped),
        )


def rests_under_load(model: Model) -> bool:
    """True if the present state is an equilibrium with forces in the rods."""
    structure, present = Structure.of(model).with_translations(), Start.present(model)
    response = _present(structure, present)[1]
    external, pull = External.of(model).at(present.load_factor), structure.largest_force(response)
    unbalanced = structure.gather(external - structure.internal(response))
    return pull > 0.0 and structure.greatest(unbalanced) <= UNBALANCED * max(pull, structure.largest(external))


def _present(structure: Structure, state: StaticState | Start) -> tuple[Array, Response]:
    """Displacements and rods in a state under its load."""
    place = structure.field(state.displacement, state.rotation)
    return place, structure.respond(place, state.permanent, state.load_factor)


def _modes(
    structure: Structure, response: Response, loaded: bool, mass: Array | Matrix, count: int | None
) -> tuple[Array, Array]:
    """ω² and φ (N, k); mass: a matrix, or its diagonal (N,). loaded: with what axial forces add, and slack cables."""
    stiffness = structure.tangent(response, response.slack) if loaded else structure.initial_tangent
    root = np.sqrt(mass if mass.ndim == 1 else mass.diagonal())
    if structure.size <= FULL:
        full, heavy = (m if isinstance(m, np.ndarray) else m.toarray() for m in (stiffness, mass))
        heavy = None if mass.ndim == 1 else heavy / root[:, None] / root
        values, vectors = eigh(full / root[:, None] / root, heavy)
        noise = 8.0 * len(root) * ROUND_OFF * largest(values)
        values, vectors = np.where(np.abs(values) > noise, values, 0.0)[:count], vectors[:, :count]
    else:
        scale = diags(1.0 / root)
        heavy = None if mass.ndim == 1 else csc_matrix(scale @ mass @ scale)
        values, vectors = _lowest(csc_matrix(scale @ stiffness @ scale), heavy, count or LOWEST)
    return values, vectors / root[:, None]


def _lowest(matrix: csc_matrix, heavy: csc_matrix | None, count: int) -> tuple[Array, Array]:
    """The eigenvalues nearest to zero of a large symmetric matrix, ascending, and their vectors; heavy: of masses, or 1."""
    shift = -SHIFT * float(abs(matrix).sum(axis=0).max())
    shifted = matrix.copy()
    shifted.setdiag(matrix.diagonal() - shift)
    if heavy is not None:
        shifted = csc_matrix(matrix - shift * heavy)
    inverse = LinearOperator(matrix.shape, matvec=Factor(shifted).solve, dtype=np.float64)
    start = pseudo_random(matrix.shape[0], 1)[:, 0]
    values, vectors = eigsh(matrix, count, M=heavy, sigma=shift, OPinv=inverse, v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]
