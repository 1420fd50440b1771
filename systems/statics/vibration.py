"""Natural vibrations of a structure, unloaded or about an equilibrium under load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import LinearOperator, eigsh

from pinjoint.components.model import Model
from pinjoint.systems.statics.equations import ROUND_OFF, Array, Response, Structure, largest, normalised
from pinjoint.systems.statics.explain import divide_named
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.factor import Factor, pseudo_random
from pinjoint.systems.statics.settle import UNBALANCED
from pinjoint.systems.statics.state import Start, StaticState
from pinjoint.systems.statics.theory import FULL

LOWEST = 10  # modes of larger structures, unless more are asked for
DIVIDED = 4  # rods for each half wave of a member, with whose masses the lowest frequencies are within 5 %
SHIFT = 1e-9  # below zero, of the highest ω², so that mechanisms (ω = 0) can be found too


@dataclass(frozen=True)
class Vibrations:
    """angular_squared: ω² (rad²/s²), ascending, (k,); negative if the equilibrium is not stable.

    modes: (k, n, 2), where members bend with rotations (n, 3), the largest motion of each 1. note: the sentence about rods
    that would vibrate between their ends, where the model has no mass; "" if that hardly matters.
    """

    angular_squared: Array
    modes: Array
    note: str

    @classmethod
    def of(cls, model: Model, state: StaticState | Start | None = None, count: int | None = None) -> Vibrations:
        """The lowest natural modes of small undamped vibrations, K φ = ω² M φ, in which no rod yields.

        Where members bend, so do rotations vibrate, with the inertias of particles.

        state: the equilibrium about which the structure vibrates, stiffened or softened by its axial forces; None: the
        original positions, without axial forces and with taut cables. count: number of modes; None: all of a small
        structure, 10 of a large one.
        """
        structure = Structure.of(model).with_translations()
        mass, inertia = model.particles.mass, model.particles.inertia
        root = np.sqrt(structure.gather(structure.field(np.repeat(mass, 2).reshape(-1, 2), inertia)) / 1000.0)
        stiffness = structure.initial_tangent
        if state is not None:
            response = _present(structure, state)
            stiffness = structure.tangent(response, response.slack)
        if structure.size <= FULL:
            full = stiffness if isinstance(stiffness, np.ndarray) else stiffness.toarray()
            values, vectors = eigh(full / root[:, None] / root)
            noise = 8.0 * len(root) * ROUND_OFF * largest(values)
            values, vectors = np.where(np.abs(values) > noise, values, 0.0)[:count], vectors[:, :count]
        else:
            scaled = csc_matrix(diags(1.0 / root) @ stiffness @ diags(1.0 / root))
            values, vectors = _lowest(scaled, count or LOWEST)
        fields = structure.fields(vectors / root[:, None])
        modes = np.array([normalised(field) for field in fields]).reshape(fields.shape)
        return cls(values, modes, _note(model, values))

    @property
    def hertz(self) -> Array:
        """Frequencies (Hz), 0 for mechanisms and for motions that are not stable."""
        return np.sqrt(np.maximum(self.angular_squared, 0.0)) / (2.0 * np.pi)


def rests_under_load(model: Model) -> bool:
    """True if the present state is an equilibrium with forces in the rods."""
    structure = Structure.of(model).with_translations()
    response = _present(structure, Start.present(model))
    external, pull = External.of(model).at(1.0), structure.largest_force(response)
    unbalanced = structure.gather(external - structure.internal(response))
    return pull > 0.0 and structure.greatest(unbalanced) <= UNBALANCED * max(pull, structure.largest(external))


def _present(structure: Structure, state: StaticState | Start) -> Response:
    """The rods in a state under the whole load."""
    place = structure.field(state.displacement, state.rotation)
    return structure.respond(place, state.plastic_strain, 1.0)


def _note(model: Model, angular_squared: Array) -> str:
    """Which rods to divide, as their own mass lies in their ends and would vibrate nearly as slowly between these.

    Between hinges that is at ω² = π⁴ EI/(m L³). Of a member divided into n rods, it is n⁴ times as much.
    """
    rods, lowest = model.rods, angular_squared[angular_squared > 0.0]
    mass = rods.density * rods.rest_length
    bent = (rods.turning_shares > 0.0).any(axis=1) & (mass > 0.0)
    own = 1000.0 * np.pi**4 * rods.bending_stiffness[bent] / (mass[bent] * rods.rest_length[bent] ** 3)
    waves = np.zeros(rods.count)  # half ones in each rod, as if it were hinged
    waves[bent] = ((lowest[0] if len(lowest) else np.inf) / own) ** 0.25
    parts = np.clip(np.ceil(DIVIDED * waves - 0.01), 1, DIVIDED).astype(np.intp)
    rows = np.flatnonzero(parts > 1)
    return divide_named(model, rows, parts) if len(rows) else ""


def _lowest(matrix: csc_matrix, count: int) -> tuple[Array, Array]:
    """The eigenvalues nearest to zero of a large symmetric matrix, ascending, and their vectors."""
    shift = -SHIFT * float(abs(matrix).sum(axis=0).max())
    shifted = matrix.copy()
    shifted.setdiag(matrix.diagonal() - shift)
    inverse = LinearOperator(matrix.shape, matvec=Factor(shifted).solve, dtype=np.float64)
    start = pseudo_random(matrix.shape[0], 1)[:, 0]
    values, vectors = eigsh(matrix, count, sigma=shift, OPinv=inverse, v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]
