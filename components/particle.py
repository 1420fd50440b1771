"""Particle: a lumped mass, a free body or the node of a structure."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import CM, MOVED, Field, FieldError, Vector, derived, if_known, state
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined
from pinjoint.components.table import Store, Table, flags

DEFAULT_MASS = 1.0  # kg, of a particle without rods
AXES = ("x", "y", "rotation")  # in which a particle moves


class Particle(Handle):
    """A disc with mass. Present position = original position + displacement; y is up."""

    __slots__ = ()
    table, noun = "particles", "particle"

    name: Field[str] = Field(doc="Its name; no two particles have the same.", dtype=str)
    position: Field[Vector] = Field(
        "m", shape=(2,), title="original position", doc="Where it was drawn, before any displacement.", shown=CM
    )
    displacement: Field[Vector] = state(
        "m", shape=(2,), doc="Present position minus original position.", shown=MOVED
    )
    velocity: Field[Vector] = state(
        "m/s", shape=(2,), doc="How fast it moves; zero in a constrained direction."
    )
    rotation: Field[float] = state(
        "rad",
        doc="By how much it has turned with the rods rigidly joined to it, counter-clockwise; full turns are counted.",
    )
    angular_velocity: Field[float] = state(
        "rad/s", doc="How fast it turns, counter-clockwise; zero where it is clamped."
    )
    asleep: Field[bool] = state(
        dtype=bool,
        doc="At rest with all that is joined to it, and left out of the computation until something reaches it.",
    )
    fixed: Field[tuple[bool, bool]] = Field(
        dtype=bool, shape=(2,), title="constrained", doc="Held by a support along x, along y."
    )
    fixed_rotation: Field[bool] = Field(
        dtype=bool,
        title="rotation constrained",
        doc="Clamped: the rods rigidly joined to it cannot turn there.",
    )
    support_angle: Field[float] = Field(
        "rad",
        doc="By how much the two axes are turned along which its support holds it, counter-clockwise; in statics.",
        shown=("°", 180.0 / math.pi),
    )
    support_springs: Field[Vector] = Field(
        "kN/m",
        shape=(2,),
        minimum=0.0,
        doc="Stiffness of an elastic support along x, along y, from the original position; 0: none.",
    )
    rotation_spring: Field[float] = Field(
        "kN·m/rad", minimum=0.0, doc="Stiffness of an elastic support against turning; 0: none."
    )
    force: Field[Vector] = Field("kN", shape=(2,), title="load", doc="Constant force on it.")
    moment: Field[float] = Field(
        "kN·m",
        title="applied moment",
        doc="Constant moment on it, counter-clockwise; only rods rigidly joined to it feel it.",
    )
    acceleration: Field[Vector] = Field(
        "m/s²", shape=(2,), title="applied acceleration", doc="Adds mass × acceleration to its force."
    )
    radius: Field[float] = Field(
        "m", default=0.05, above=0.0, doc="Radius of its disc, with which it collides.", shown=CM
    )
    prescribed_mass: Field[float | None] = if_known(
        "kg",
        doc="Its mass; automatic: half the mass of each attached rod, or 1 kg without rods.",
        overrides="mass",
    )
    prescribed_inertia: Field[float | None] = if_known(
        "kg·m²",
        doc="Its moment of inertia; automatic: from the rods rigidly joined to it, so that no smaller steps are needed.",
        overrides="inertia",
    )
    mass: Field[float] = derived(
        "kg",
        default=DEFAULT_MASS,
        above=0.0,
        doc="As given, or half the mass of each attached rod, or 1 kg without rods.",
    )
    mobility: Field[Vector] = derived(
        "m/s²/kN", shape=(2,), doc="Acceleration per force in each direction: 1000/mass, 0 where constrained."
    )
    inertia: Field[float] = derived(
        "kg·m²",
        title="rotational inertia",
        doc="As given, or the sum of ρL₀ min(1.5 EI/EA, L₀²/24) over the rod ends rigidly joined to it.",
    )
    turning: Field[float] = derived(
        "rad/s²/(kN·m)",
        title="rotational mobility",
        doc="Angular acceleration per moment: 1000/inertia, 0 where it is clamped or has no rigid ends.",
    )
    constant_force: Field[Vector] = derived(
        "kN",
        shape=(2,),
        doc="All constant external force: its own, the environment's, mass × accelerations and constant loads.",
    )
    constant_moment: Field[float] = derived(
        "kN·m", doc="All constant external moment: its own and that of constant loads."
    )
    applied_force: Field[Vector] = derived(
        "kN", shape=(2,), title="sum of loads", doc="All loads and weights on it now, without reactions."
    )
    reaction: Field[Vector] = derived(
        "kN", shape=(2,), doc="The force on it of its support, rigid or elastic; 0 where it has none."
    )

    applied_moment: Field[float] = derived(
        "kN·m", title="external moment", doc="All external moment on it now, without reactions."
    )
    reaction_moment: Field[float] = derived(
        "kN·m", doc="The moment of its clamp or rotation spring on it, counter-clockwise; 0 where it has none."
    )

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """A constrained direction has no velocity; no rod may lose its length."""
        if "velocity" in changed:
            for place, axis in np.argwhere(table.fixed[rows] & (table.velocity[rows] != 0.0))[:1].tolist():
                raise FieldError(
                    "{where}: velocity {axis} is {speed:g} m/s, but a support holds it along {axis}; set the velocity"
                    " to 0 or free the direction.",
                    where=table.world.describe(table[rows[place]], "velocity"),
                    axis="xy"[axis],
                    speed=table.velocity[rows[place], axis],
                )
        elif "fixed" in changed:
            stopped = np.where(table.fixed[rows], 0.0, table.velocity[rows])
            table.world.assign([table[row] for row in rows.tolist()], "velocity", stopped)
        if "angular_velocity" in changed:
            turning = table.fixed_rotation[rows] & (table.angular_velocity[rows] != 0.0)
            for row in rows[turning][:1].tolist():
                raise FieldError(
                    "{where}: angular velocity is {angular_velocity:g} rad/s, but it is clamped; set the angular"
                    " velocity to 0 or free the rotation.",
                    where=table.world.describe(table[row], "angular_velocity"),
                    angular_velocity=table.angular_velocity[row],
                )
        elif "fixed_rotation" in changed:
            stopped = np.where(table.fixed_rotation[rows], 0.0, table.angular_velocity[rows])
            table.world.assign([table[row] for row in rows.tolist()], "angular_velocity", stopped)
        _check_springs(table, rows, changed)
        if "position" in changed:
            _check_rods(table, rows)


def _check_springs(table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
    """A direction that a rigid support holds from now on has no spring; none is put where one holds it already."""
    for held, name in (("fixed", "support_springs"), ("fixed_rotation", "rotation_spring")):
        springs, rigid = table.column(name)[rows], table.column(held)[rows]
        idle = rigid & (springs > 0.0)
        if not idle.any():
            continue
        particles = [table[row] for row in rows.tolist()]
        if name not in changed:
            table.world.assign(particles, name, np.where(rigid, 0.0, springs))
            continue
        place, *axis = np.argwhere(idle)[0].tolist()
        raise FieldError(
            "{where}: a rigid support holds it there, where a spring would do nothing; free the direction or leave the"
            " spring out.",
            where=joined([table.world.describe(particles[place], name), *("xy"[k] for k in axis)]),
        )


def supported(world: Store) -> NDArray[np.bool_]:
    """In which directions supports, rigid or elastic, act on particles: x, y and rotation, shape (particles, 3)."""
    particles = world.tables["particles"]
    rigid = np.column_stack([particles.fixed, particles.fixed_rotation])
    return rigid | (spring_stiffness(world) > 0.0)


def turned_supports(world: Store) -> NDArray[np.bool_]:
    """Which particles have supports that do not act along x and y, shape (particles,)."""
    particles = world.tables["particles"]
    found: NDArray[np.bool_] = particles.support_angle != 0.0
    return found & supported(world)[:, :2].any(axis=1) if found.any() else found


def in_support_axes(world: Store, field: NDArray[np.float64], *, back: bool = False) -> NDArray[np.float64]:
    """Vectors (particles, 2 or 3) along the axes of supports, those without any along x and y; back: from there."""
    angle = np.where(turned_supports(world), world.tables["particles"].support_angle, 0.0)
    return turned(field, -angle if back else angle)


def turned(field: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (n, 2 or 3) along axes that are turned by angles (n,); what turns, their third part, is the same there."""
    if not np.count_nonzero(angle):
        return field
    found, cosine, sine = field.copy(), np.cos(angle), np.sin(angle)
    found[:, 0] = cosine * field[:, 0] + sine * field[:, 1]
    found[:, 1] = cosine * field[:, 1] - sine * field[:, 0]
    return found


def of_rigid_supports(world: Store, field: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (particles, 2) as far as they lie in directions that rigid supports hold."""
    held = np.where(world.tables["particles"].fixed, in_support_axes(world, field), 0.0)
    return in_support_axes(world, held, back=True)


def is_sprung(world: Store) -> bool:
    """True if some support is elastic."""
    particles = world.tables["particles"]
    return bool(particles.support_springs.any() or particles.rotation_spring.any())


def spring_stiffness(world: Store) -> NDArray[np.float64]:
    """Stiffness of elastic supports in x, y (kN/m) and against turning (kN·m/rad), shape (particles, 3)."""
    particles = world.tables["particles"]
    return np.column_stack([particles.support_springs, particles.rotation_spring])


def _check_rods(table: Table[Any], rows: NDArray[np.intp]) -> None:
    """Raise FieldError if a rod at one of these particles has lost its length."""
    world = table.world
    moved = flags(rows, table.count)
    ends = world.column("rods.between")
    at_them = np.flatnonzero(moved[ends[:, 0]] | moved[ends[:, 1]])
    for row in rods_without_length(world, at_them)[:1].tolist():
        first, second = ends[row].tolist()
        particle = table[first if moved[first] else second]
        raise FieldError(
            "{particle}: at this position {rod} would have no length; place the particle elsewhere or give the rod a"
            " rest length.",
            particle=world.describe(particle),
            rod=world.describe(world.tables["rods"][row]),
        )


def rods_without_length(world: Store, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of these rods whose ends are at the same place and that have no rest length of their own."""
    ends = world.column("particles.position")[world.column("rods.between")[rows]]
    together = (ends[:, 0] == ends[:, 1]).all(axis=1)
    found: NDArray[np.intp] = rows[together & np.isnan(world.column("rods.prescribed_rest_length")[rows])]
    return found
