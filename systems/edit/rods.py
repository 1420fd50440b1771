"""Rods: joining particles, and deleting elements so that masses follow."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from operator import itemgetter
from typing import Any

import numpy as np

from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.section import USUAL_SECTION
from pinjoint.components.table import flags
from pinjoint.components.view import drawn_positions
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.placing import rows_of

# What members have of their section and material.
_MADE_OF = (
    *(Rod.section, Rod.material, Rod.youngs_modulus, Rod.area, Rod.second_moment, Rod.thermal_expansion),
    *(Rod.prescribed_stiffness, Rod.prescribed_bending_stiffness, Rod.bending_damping, Rod.damping),
    *(Rod.density, Rod.tensile_strength, Rod.compressive_strength),
)


def distance(first: Particle, second: Particle) -> float:
    """Present distance (m) between two particles."""
    ends = [np.add(end.position, end.displacement) for end in (first, second)]
    return math.hypot(*(ends[1] - ends[0]))


def check_ends(model: Model, first: Particle, second: Particle) -> None:
    """Raise Refusal if two particles cannot be joined by a new rod."""
    if first is second:
        raise Refusal("A rod needs two different particles; point at another one.")
    ends = model.rods.between
    for row in np.flatnonzero(((ends == first.row) | (ends == second.row)).all(axis=1))[:1].tolist():
        raise Refusal(
            "{rod} already joins {first} and {second}; choose two other particles.",
            rod=begun(model.describe(model.rods[row])),
            first=first.said,
            second=second.said,
        )
    if distance(first, second) == 0.0:
        raise Refusal(
            "{first} and {second} are at the same place; move one of them first.",
            first=first.said,
            second=second.said,
        )


def join(model: Model, first: Particle, second: Particle, *, rigid: bool = False) -> Rod:
    """A new rod, without force as the particles are now; their masses follow from the rods again.

    rigid: a member with rigid ends, like the newest one that bends, else of the usual section. Raises Refusal if it
    cannot be.
    """
    with model.transaction(tr("new {noun}", noun=tr(Rod.noun))):
        check_ends(model, first, second)
        moved = first.displacement != second.displacement
        [rod] = model.create(
            Rod,
            between=[(first.row, second.row)],
            prescribed_rest_length=[distance(first, second) if moved else None],
            **(_like_members(model) if rigid else {}),
        )
        _masses_from_rods(model, [first, second])
    return rod


def members_met(model: Model, start: Vector, end: Vector, reach: float) -> list[tuple[float, Rod, float]]:
    """The members that bend and that a line between two points (m), longer by a reach (m) at both ends, meets inside.

    In order, with how far along the line (m) each is met, and at which share of its own length.
    """
    rods, way = model.rods, np.subtract(end, start)
    length = float(np.hypot(*way))
    if not rods.count or length == 0.0:
        return []
    first, last = drawn_positions(model)[rods.between.T]
    along, off = last - first, first - start
    with np.errstate(all="ignore"):  # of those that are parallel, or drawn farther away than numbers go
        across = way[0] * along[:, 1] - way[1] * along[:, 0]
        at = length * (off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) / across
        share = (off[:, 0] * way[1] - off[:, 1] * way[0]) / across
        near = np.minimum(share, 1.0 - share) * np.hypot(*along.T)
        met = (rods.bending_stiffness > 0.0) & (near > reach) & (at > -reach) & (at < length + reach)
        met &= np.abs(across) > 1e-6 * length * np.hypot(*along.T)  # sine of the angle between them
    return sorted(
        ((float(at[row]), rods[row], float(share[row])) for row in np.flatnonzero(met).tolist()),
        key=itemgetter(0),
    )


def _like_members(model: Model) -> dict[str, Any]:
    """What a new member is made of, by Field."""
    bent = np.flatnonzero(model.rods.bending_stiffness > 0.0)
    if not len(bent):
        return {"section": np.array([USUAL_SECTION], dtype=object)}
    return {field.name: model.rods.column(field.name)[bent[-1:]] for field in _MADE_OF}


def share_at(rod: Rod, point: Vector) -> float:
    """How far along a rod, as it is drawn, a point (m) lies: 0 at its start, 1 at its end."""
    ends = [end.row for end in rod.ends]
    start, end = drawn_positions(rod.ends[0].world)[ends]  # type: ignore[arg-type]
    along = end - start
    return float((np.subtract(point, start) * along).sum() / (along**2).sum())


def place_at(rod: Rod, share: float) -> Vector:
    """The point (m) at a share of the length of a rod, as it is drawn."""
    first, last = drawn_positions(rod.ends[0].world)[[end.row for end in rod.ends]]  # type: ignore[arg-type]
    x, y = (float(f"{part:.12g}") for part in (first + share * (last - first)).tolist())
    return x, y


def toggle_hinge(model: Model, rod: Rod, end: int) -> str:
    """Hinge an end of a rod, or make it rigid; returns what it is now. A bar that did not bend gets the usual section."""
    name, particle = model.describe(rod), rod.ends[end].said
    if is_rigid(rod, end):
        set_rigid(model, [(rod, end)], False, tr("hinge of {rod}", rod=name))
        return tr("hinged at {particle}", particle=particle)
    set_rigid(model, [(rod, end)], True, tr("rigid joint of {rod}", rod=name))
    return tr("rigidly joined at {particle}", particle=particle)


def toggle_joint(model: Model, particle: Particle) -> str:
    """Hinge all rods' ends at a particle, or make them rigid if they are hinged; returns what they are now."""
    rows = np.argwhere(model.rods.between == particle.row).tolist()
    if not rows:
        raise Refusal("No rod ends at {particle}; choose an end of a rod to hinge it.", particle=particle.said)
    ends, name = [(model.rods[row], end) for row, end in rows], model.describe(particle)
    if any(is_rigid(*end) for end in ends):
        set_rigid(model, ends, False, tr("hinges at {particle}", particle=name))
        return tr("all rods hinged to it")
    set_rigid(model, ends, True, tr("rigid joint at {particle}", particle=name))
    return tr("all rods rigidly joined")


def is_rigid(rod: Rod, end: int) -> bool:
    """True if a rod bends and is rigidly joined at that end."""
    return rod.fixity[end] == 1.0


def set_rigid(model: Model, ends: Iterable[tuple[Rod, int]], rigid: bool, title: str) -> None:
    """Make ends of rods rigid, or hinge them, in place of springs, as one edit; rods that did not bend are made of what new
    ones are."""
    hinged: dict[Rod, list[bool]] = {}
    springs: dict[Rod, list[float]] = {}
    for rod, end in ends:
        hinged.setdefault(rod, [rod.fixity[other] == 0.0 for other in (0, 1)])[end] = not rigid
        springs.setdefault(rod, list(rod.end_springs))[end] = 0.0
    with model.transaction(title):
        pinned = [rod for rod in hinged if rigid and rod.bending_stiffness == 0.0]
        for name, value in _like_members(model).items() if pinned else ():
            model.assign(pinned, name, np.repeat(value, len(pinned)))
        model.assign(list(hinged), "hinged", list(hinged.values()))
        model.assign(list(springs), "end_springs", list(springs.values()))


def delete(model: Model, handles: Iterable[Handle]) -> None:
    """Delete elements with all that refer to them; masses of the remaining particles follow from the rods again."""
    doomed = list(handles)
    rows = model.rows_of(doomed)
    particles = flags(rows["particles"], model.particles.count)
    rods = flags(rows["rods"], model.rods.count) | particles[model.rods.between].any(axis=1)
    ends = flags(model.rods.between[rods], model.particles.count)
    remaining = [model.particles[row] for row in np.flatnonzero(ends & ~particles).tolist()]
    with model.transaction(tr("delete")):
        _masses_from_rods(model, remaining)
        model.delete(doomed)


def _masses_from_rods(model: Model, particles: Sequence[Particle]) -> None:
    """Forget the masses that were prescribed for these particles."""
    given = ~np.isnan(model.particles.prescribed_mass[rows_of(model, particles)])
    model.assign(list(itertools.compress(particles, given.tolist())), "prescribed_mass", None)


GRAVITY = (0.0, -9.81)  # m/s², where the environment has no acceleration


def weigh_along(model: Model, rods: Sequence[Rod]) -> str:
    """Let rods bear their weight all along, as one edit; returns a sentence. Raises Refusal if they have none.

    Where the environment accelerates everything, all rods do, and particles keep as accelerations of their own what is
    left of it, so that each joint bears what it bore before.
    """
    everywhere = np.array(model.environment.acceleration)
    chosen = list(model.rods) if everywhere.any() else list(rods)
    rows = np.array([rod.row for rod in chosen], dtype=np.intp)
    if not (model.rods.density[rows] > 0.0).any():
        raise Refusal(
            "These rods have no density, so they weigh nothing; give them a density or a section first."
        )
    pull = everywhere if everywhere.any() else np.array(GRAVITY)
    weight = model.rods.density[rows][:, None] * pull / 1000.0
    particles = model.particles
    with model.transaction(tr("weight as distributed force")):
        if everywhere.any():
            half = 0.5 * model.rods.density * model.rods.rest_length
            lumped = np.bincount(model.rods.between.ravel(), np.repeat(half, 2), particles.count)
            left = 1.0 - lumped / particles.mass
            left[np.abs(left) < 1e-12] = 0.0
            model.assign(list(particles), "acceleration", particles.acceleration + left[:, None] * pull)
            model.environment.acceleration = (0.0, 0.0)
        model.assign(chosen, "distributed_force", model.rods.distributed_force[rows] + weight)
    if everywhere.any():
        return tr(
            "The weight of all rods acts along them now, as distributed forces; these replace the acceleration of the"
            " environment."
        )
    return plural(
        "{rod}: its weight acts along it now, as a distributed force (9.81 m/s² downwards)",
        "{count} rods: their weight acts along them now, as distributed forces (9.81 m/s² downwards)",
        len(chosen),
        rod=begun(model.describe(chosen[0])),
    )
