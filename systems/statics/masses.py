"""Masses along rods that bend, for natural vibrations: members in four parts, whose masses move as their cubics do.

With masses at its ends alone, as motion in time has them, a simple beam of one rod would be told to swing ten times too
fast; so divided, its lowest frequency is 2.6e-4 too high, the second 4e-3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.arrays import Array, Flags, Rows
from pinjoint.components.derived import by_fixity, cubic, on_joints, own_slopes
from pinjoint.components.model import Model
from pinjoint.components.spans import Kinks
from pinjoint.systems.statics.assembly import Matrix
from pinjoint.systems.statics.bending import Bending
from pinjoint.systems.statics.buckling import members
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.response import Response
from pinjoint.systems.statics.state import Start, StaticState

PARTS = 4  # of a member, at least
# As of their rods.
_OF_PARTS = ("stiffness", "tension_limit", "compression_limit", "sense", "buckling_load", "flat")
CLOSE = 0.75 * np.pi  # of a wave, in radians along a part, up to which frequencies are within some 2 %


@dataclass(frozen=True)
class Divided:
    """A structure whose rods that bend and weigh something are divided. structure: the particles, then those between.

    whole: before. row: the rod that each part is of. inner: rows and shares of the rods where the particles between are.
    """

    structure: Structure
    whole: Structure
    row: Rows
    inner: tuple[Rows, Array]
    mass: Array  # kg/m, of the parts of rods that bend, else 0
    point: Array  # kg and kg·m², of particles, (n, 3)
    highest: float  # ω² (rad²/s²) up to which the parts vibrate closely enough

    @classmethod
    def of(cls, model: Model) -> Divided | None:
        """That of a model; None where no rod that bends has a mass."""
        rods, particles = model.rods, model.particles
        heavy = (rods.bending_stiffness > 0.0) & (rods.density > 0.0) & ~np.isfinite(rods.buckling_load)
        if not heavy.any():
            return None
        whole = _bending(model)
        member = members(model)
        parts = np.where(heavy, -(-PARTS // np.bincount(member)[member]), 1)
        row = np.repeat(np.arange(rods.count), parts)
        number = np.arange(len(row)) - (np.cumsum(parts) - parts)[row]
        first, last = number == 0, number == parts[row] - 1
        node = np.zeros(len(row), dtype=np.intp)  # at which a part begins, if inside
        node[~first] = particles.count + np.arange(len(row) - rods.count)
        ends = np.stack([node, np.roll(node, -1)], axis=1)
        ends[first, 0], ends[last, 1] = whole.ends[:, 0], whole.ends[:, 1]
        inner = row[~first], (number / parts[row])[~first]
        length = (rods.rest_length / parts)[row]
        inside, outer = (rods.bending_stiffness > 0.0)[row, None], np.stack([first, last], axis=1)
        fixity = rods.fixity[row]
        sprung = fixity / (fixity + (1.0 - fixity) * parts[row, None])  # of the same springs: k/(k + 3 EI n/L₀)
        per_slope, of_ends = by_fixity(np.where(outer, sprung, inside))
        between = Kinks.of(model).divided(row, number / parts[row], (number + 1) / parts[row])
        bending = Bending(
            rest_length=length,
            end_stiffness=(rods.bending_stiffness[row] / length)[:, None] * per_slope,
            initial_slopes=rods.initial_slopes[row] / parts[row, None],
            span_load=on_joints(between.on_clamped(length), of_ends["fixity"]),
            moment_limit=np.full((len(row), 2), np.inf),
            **of_ends,
        )
        between = particles.position[whole.ends[inner[0], 0]] + inner[1][:, None] * rods.difference[inner[0]]
        structure = replace(
            whole,
            **{name: getattr(whole, name)[row] for name in _OF_PARTS},
            position=np.concatenate([whole.position, between]),
            ends=ends,
            difference=whole.difference[row] / parts[row, None],
            original_length=whole.original_length[row] / parts[row],
            rest_length=length,
            misfit=whole.misfit[row] / parts[row],
            fixed=np.pad(whole.fixed, ((0, len(between)), (0, 0))),
            springs=np.pad(whole.springs, ((0, len(between)), (0, 0))),
            angle=np.pad(whole.angle, (0, len(between))),
            body=np.concatenate([whole.body, whole.body[whole.ends[inner[0], 0]]]),
            own_weight=np.pad(whole.own_weight, (0, len(between))),
            bending=bending,
        ).with_translations()
        mass = np.where(heavy, rods.density, 0.0)[row]
        own = (CLOSE / length[mass > 0.0]) ** 4 * rods.bending_stiffness[row[mass > 0.0]] / mass[mass > 0.0]
        return cls(structure, whole, row, inner, mass, _points(model, heavy), 1000.0 * float(own.min()))

    def at(self, state: StaticState | Start) -> tuple[Array, Response]:
        """Displacements (N, 3) and parts in a state, on the axes as these are bent there, under its load."""
        whole, (row, share), factor = self.whole, self.inner, state.load_factor
        assert whole.bending is not None
        place = whole.field(state.displacement, state.rotation)
        held = whole.respond(place, state.permanent, factor)
        assert held.bent is not None
        slopes = np.einsum("rij,rj->ri", own_slopes(whole.bending.fixity), held.bent.slopes)
        bow = cubic(*slopes.T)[row]
        powers = share[:, None] ** np.arange(4)
        aside = (bow * powers).sum(axis=1) * held.length[row]
        left = np.stack([-held.axis[row, 1], held.axis[row, 0]], axis=1)
        begun, moved = place[whole.ends[row, 0]], whole.relative(place)[row]
        turned = whole.chords(place)[row] + (bow[:, 1:] * np.arange(1, 4) * powers[:, :3]).sum(axis=1)
        shift = begun[:, :2] + share[:, None] * moved + aside[:, None] * left
        between = np.column_stack([shift, turned])
        force, permanent = held.axial_force[self.row], whole.yielding_parts(state.permanent)[self.row]
        if permanent.ndim > 1:  # only outer ends have turned in plastic hinges
            permanent[:, 1:] *= self.structure.ends < len(place)
        place, bending = np.concatenate([place, between]), self.structure.bending
        found = self.structure.respond(place, permanent, factor)
        assert found.bent is not None
        assert bending is not None
        bent = bending.bent(found.bent.slopes, force, found.axis, found.length, factor, couples=True)
        return place, replace(found, axial_force=force, slack=held.slack[self.row], bent=bent)

    def inertia(self, axis: Array) -> Matrix:
        """The mass matrix (Mg, Mg·m²), its rods with these axes: of their cubics, and of particles.

        An end turns as its joint, hinge or spring lets it.
        """
        structure, bending = self.structure, self.structure.bending
        assert bending is not None
        length, own = bending.rest_length, own_slopes(bending.fixity)
        one = np.ones_like(length)
        way = np.zeros((len(length), 6, 6))  # along, to the left, turning, of both ends
        for end in (0, 3):
            way[:, end, end : end + 2] = axis
            way[:, end + 1, end], way[:, end + 1, end + 1] = -axis[:, 1], axis[:, 0]
            way[:, end + 2, end + 2] = 1.0
        chord = (way[:, 4] - way[:, 1])[:, None] / length[:, None, None]
        way[:, 2::3] = chord + own @ (way[:, 2::3] - chord)
        rows = [
            [140.0, 0.0, 0.0, 70.0, 0.0, 0.0],
            [0.0, 156.0, 22.0, 0.0, 54.0, -13.0],
            [0.0, 22.0, 4.0, 0.0, 13.0, -3.0],
            [70.0, 0.0, 0.0, 140.0, 0.0, 0.0],
            [0.0, 54.0, 13.0, 0.0, 156.0, -22.0],
            [0.0, -13.0, -3.0, 0.0, -22.0, 4.0],
        ]
        scale = np.stack([one, one, length, one, one, length], axis=1)
        block = scale[:, :, None] * scale[:, None, :] * rows * (self.mass * length / 420e3)[:, None, None]
        full = structure.matrix(way.swapaxes(1, 2) @ block @ way)
        point = np.pad(self.point / 1000.0, ((0, len(self.inner[0])), (0, 0)))
        if isinstance(full, np.ndarray):
            return full + np.diag(structure.along_unknowns(point))
        from scipy.sparse import csc_matrix, diags

        return csc_matrix(full + diags(structure.along_unknowns(point)))


def _bending(model: Model) -> Structure:
    """The structure of a model with rotations, also where rods are all hinged."""
    found = Structure.of(model)
    if found.bending is None:
        fixed = np.column_stack([found.fixed, model.particles.fixed_rotation])
        springs = np.pad(found.springs, ((0, 0), (0, 1)))
        found = replace(found, bending=Bending.of(model, bows=True), fixed=fixed, springs=springs)
    return found.with_translations()


def _points(model: Model, heavy: Flags) -> Array:
    """Masses and rotational inertias of particles beside those of the rods that are divided, (n, 3).

    Those that are prescribed; else what other rods leave at their ends, and where no divided rod ends all there is.
    """
    particles, rods = model.particles, model.rods
    ends, count = rods.between.astype(np.intp), particles.count
    half = np.repeat(np.where(heavy, 0.0, 0.5 * rods.density * rods.rest_length), 2)
    beside = np.bincount(ends.ravel(), half, count)
    reached = np.bincount(ends[heavy].ravel(), minlength=count) > 0
    turned = np.bincount(ends[heavy[:, None] & (rods.turning_shares > 0.0)], minlength=count) > 0
    given, given_inertia = particles.prescribed_mass, particles.prescribed_inertia
    mass = np.where(np.isnan(given), np.where(reached, beside, particles.mass), given)
    inertia = np.where(np.isnan(given_inertia), np.where(turned, 0.0, particles.inertia), given_inertia)
    return np.stack([mass, mass, inertia], axis=1)
