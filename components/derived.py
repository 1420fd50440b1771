"""Derived columns: masses, lengths, limits and constant forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pinjoint.components.diagrams import NAMES, diagrams
from pinjoint.components.field import Column
from pinjoint.components.load import CONSTANT
from pinjoint.components.particle import DEFAULT_MASS
from pinjoint.components.rod import DEFAULT_STIFFNESS
from pinjoint.components.world import Derivation, World

FULL_TURN = 2.0 * np.pi  # rad


def derive_lengths(world: World) -> None:
    """Original difference and length of every rod, its rest length, and its misfit at its temperature."""
    rods = world.tables["rods"]
    position = world.tables["particles"].position
    ends = rods.between
    difference = world.writable("rods.difference")
    difference[...] = position[ends[:, 1]] - position[ends[:, 0]]
    original = world.writable("rods.original_length")
    original[...] = np.hypot(difference[:, 0], difference[:, 1])
    prescribed = rods.prescribed_rest_length
    rest = world.writable("rods.rest_length")
    rest[...] = np.where(np.isnan(prescribed), original, prescribed)
    thermal_strain = rods.thermal_expansion * rods.temperature_change
    world.writable("rods.misfit")[...] = original - rest * (1.0 + thermal_strain)


def derive_stiffness(world: World) -> None:
    """EA and EI of every rod: prescribed, else E·A and E·I, else those of a bar of which nothing is known."""
    rods = world.tables["rods"]
    for name, of_section, unknown in (
        ("stiffness", rods.area, DEFAULT_STIFFNESS),
        ("bending_stiffness", rods.second_moment, 0.0),
    ):
        with np.errstate(over="ignore", under="ignore"):  # too large numbers are reported before a run
            known = rods.youngs_modulus * of_section
        prescribed = rods.column(f"prescribed_{name}")
        automatic = np.where(np.isnan(known), unknown, known)
        world.writable(f"rods.{name}")[...] = np.where(np.isnan(prescribed), automatic, prescribed)


def derive_masses(world: World) -> None:
    """Lumped masses (half of each attached rod's density × rest length) and mobilities."""
    particles, rods = world.tables["particles"], world.tables["rods"]
    with np.errstate(over="ignore"):  # too large numbers are reported before a run
        half = 0.5 * rods.density * rods.rest_length
    lumped = np.bincount(rods.between.ravel(), np.repeat(half, 2), particles.count)
    lumped[lumped == 0.0] = DEFAULT_MASS
    prescribed = particles.prescribed_mass
    mass = world.writable("particles.mass")
    mass[...] = np.where(np.isnan(prescribed), lumped, prescribed)
    with np.errstate(over="ignore", divide="ignore"):  # too small numbers are, too
        mobility = np.where(particles.fixed, 0.0, 1000.0 / mass[:, None])
    world.writable("particles.mobility")[...] = mobility


def derive_bending(world: World) -> None:
    """What the ends of each rod feel, by its hinges: coefficients of slopes, all zero where nothing bends.

    A hinge is condensed: its end has no moment, and the shape of the rod is that without axial force.
    """
    rods = world.tables["rods"]
    length, stiffness = rods.rest_length, rods.bending_stiffness
    rigid: Column = ~rods.hinged & np.stack([stiffness, stiffness], axis=1).astype(bool)
    if not rigid.any():
        for name in (
            "end_stiffness",
            "end_damping",
            "initial_slopes",
            "load_shares",
            "bowing",
            "turning_shares",
        ):
            world.writable(f"rods.{name}")[...] = 0.0
        return
    both = np.asarray(rigid.all(axis=1))
    start, end = (rigid & ~both[:, None]).T  # the only rigid end

    def by_ends(of_start: ArrayLike, mixed: ArrayLike, of_end: ArrayLike, alone: ArrayLike) -> Column:
        alone = np.broadcast_to(alone, len(length))
        rows = (
            np.where(both, of_start, np.where(start, alone, 0.0)),
            np.where(both, mixed, 0.0),
            np.where(both, of_end, np.where(end, alone, 0.0)),
        )
        return np.stack(rows, axis=1)

    per_slope = by_ends(4.0, 2.0, 4.0, 3.0)
    with np.errstate(over="ignore", invalid="ignore"):  # too large numbers are reported before a run
        world.writable("rods.end_stiffness")[...] = (stiffness / length)[:, None] * per_slope
        prescribed = rods.bending_damping
        like_axis = rods.damping * stiffness / rods.stiffness
        damping = np.where(np.isnan(prescribed), like_axis, prescribed)
        world.writable("rods.end_damping")[...] = damping[:, None] * per_slope
        half = -0.5 * rods.thermal_expansion * rods.temperature_gradient * length
        world.writable("rods.initial_slopes")[...] = half[:, None] * rigid * [-1.0, 1.0] + 0.0
        area = by_ends(1.0 / 12.0, 0.0, -1.0 / 12.0, 1.0 / 8.0)[:, ::2] * (length**2)[:, None]
    area[end, 1] *= -1.0
    world.writable("rods.load_shares")[...] = area
    world.writable("rods.bowing")[...] = by_ends(4.0 / 30.0, -1.0 / 30.0, 4.0 / 30.0, 0.2)
    world.writable("rods.turning_shares")[...] = by_ends(0.5, 0.0, 0.5, 1.0)[:, ::2]


def derive_inertia(world: World) -> None:
    """Rotational inertias, and how rotations follow moments; of particles with rigid rod ends alone.

    ρL₀ min(1.5 EI/EA, L₀²/24) of each rigid end, so that where λ = EA L₀²/EI > 48 bending needs no smaller steps than the
    axes do: each rod has ω² ≤ 4EA/(mL²) max(1 + 12/λ, 48/λ).
    """
    particles, rods = world.tables["particles"], world.tables["rods"]
    ends, length = rods.between.ravel(), rods.rest_length
    count = np.bincount(ends, minlength=particles.count)
    rigid = (rods.turning_shares > 0.0).ravel()
    if not rigid.any():
        for name in ("inertia", "turning"):
            world.writable(f"particles.{name}")[...] = 0.0
        return
    with np.errstate(all="ignore"):  # such numbers are reported before a run
        radius = np.minimum(1.5 * rods.bending_stiffness / rods.stiffness, length**2 / 24.0)
        mass = np.repeat(rods.density * length, 2)
        mass = np.where(mass > 0.0, mass, (2.0 * particles.mass / count)[ends])
        own = np.bincount(ends, np.where(rigid, mass * np.repeat(radius, 2), 0.0), particles.count)
        turns = np.bincount(ends, rigid, particles.count) > 0
        prescribed = particles.prescribed_inertia
        inertia = world.writable("particles.inertia")
        inertia[...] = np.where(turns, np.where(np.isnan(prescribed), own, prescribed), 0.0)
        free = turns & ~particles.fixed_rotation
        world.writable("particles.turning")[...] = np.where(free, 1000.0 / inertia, 0.0)


def derive_diagrams(world: World) -> None:
    """Axial force, shear and bending moment at both ends of every rod, and the rotations of these, in the present state.

    By statics, with the distributed force per original length. A hinged end turns as far as its moment is zero.
    """
    particles, rods = world.tables["particles"], world.tables["rods"]
    first, second = rods.between.astype(np.intp).T
    present = rods.difference + particles.displacement[second] - particles.displacement[first]
    length = np.hypot(present[:, 0], present[:, 1])
    axis = present / np.where(length > 0.0, length, 1.0)[:, None]
    rotation, forces = particles.rotation[rods.between], (rods.axial_force, rods.end_moment)
    for name, values in diagrams(rods, axis, length, chord_rotation(world), rotation, forces).items():
        world.writable(f"rods.{name}")[...] = values


def chord_rotation(world: World) -> Column:
    """How far the chord of every rod has turned (rad), with the full turns that its rigid ends tell; shape (rods,)."""
    particles, rods = world.tables["particles"], world.tables["rods"]
    first, second = rods.between.astype(np.intp).T
    relative = particles.displacement[second] - particles.displacement[first]
    difference = rods.difference
    sine = difference[:, 0] * relative[:, 1] - difference[:, 1] * relative[:, 0]
    chord = np.arctan2(sine, (difference * (difference + relative)).sum(axis=1))
    return with_full_turns(chord, rods.turning_shares, particles.rotation[rods.between])


def with_full_turns(chord: Column, turning_shares: Column, rotation: Column) -> Column:
    """Rotations of chords (rods,) with those full turns that bring them nearest to the mean of their rigid ends."""
    mean = (turning_shares * rotation).sum(axis=1)
    turned: Column = chord + FULL_TURN * np.rint((mean - chord) / FULL_TURN)
    return turned


def derive_limits(world: World) -> None:
    """Strengths with "unlimited" (None or 0) as infinity; a cable goes slack before any compression."""
    for direction, name in (("tension", "tensile"), ("compression", "compressive")):
        values = world.tables["rods"].column(f"{name}_strength")
        unlimited = np.isnan(values) | (values == 0.0)
        world.writable(f"rods.{direction}_limit")[...] = np.where(unlimited, np.inf, values)
    world.writable("rods.compression_limit")[world.tables["rods"].tension_only] = np.inf


def derive_constant_force(world: World) -> None:
    """Own force, environment's force, mass × accelerations (kN), constant loads, and distributed forces."""
    particles, loads, rods = world.tables["particles"], world.tables["loads"], world.tables["rods"]
    environment = world.tables["environment"]
    constant = [row for row, history in enumerate(loads.history) if history["kind"] == CONSTANT["kind"]]
    with np.errstate(over="ignore", invalid="ignore"):  # too large numbers are reported before a run
        acceleration = particles.acceleration + environment.acceleration
        force = particles.force + environment.force + particles.mass[:, None] * acceleration / 1000.0
        np.add.at(force, loads.on[constant], loads.force[constant])
        if rods.distributed_force.any():
            half = 0.5 * rods.distributed_force * rods.rest_length[:, None]
            np.add.at(force, rods.between.ravel(), np.repeat(half, 2, axis=0))
    world.writable("particles.constant_force")[...] = force


def derive_constant_moment(world: World) -> None:
    """Own moment and that of constant loads (kN·m)."""
    particles, loads = world.tables["particles"], world.tables["loads"]
    constant = [row for row, history in enumerate(loads.history) if history["kind"] == CONSTANT["kind"]]
    moment = world.writable("particles.constant_moment")
    moment[...] = particles.moment
    np.add.at(moment, loads.on[constant], loads.moment[constant])


def derive_displacement_scale(world: World) -> None:
    """How much larger displacements are drawn."""
    settings = world.tables["settings"]
    prescribed, automatic = settings.prescribed_displacement_scale, settings.automatic_displacement_scale
    scale = np.where(np.isnan(prescribed), automatic, prescribed)
    world.writable("settings.displacement_scale")[...] = scale


DERIVATIONS = (
    Derivation(
        ("settings.displacement_scale",),
        ("settings.prescribed_displacement_scale", "settings.automatic_displacement_scale"),
        derive_displacement_scale,
    ),
    Derivation(
        ("rods.difference", "rods.original_length", "rods.rest_length", "rods.misfit"),
        (
            "rods.between",
            "rods.prescribed_rest_length",
            "rods.temperature_change",
            "rods.thermal_expansion",
            "particles.position",
        ),
        derive_lengths,
    ),
    Derivation(
        ("rods.stiffness", "rods.bending_stiffness"),
        (
            *("rods.prescribed_stiffness", "rods.prescribed_bending_stiffness"),
            *("rods.youngs_modulus", "rods.area", "rods.second_moment"),
        ),
        derive_stiffness,
    ),
    Derivation(
        ("particles.mass", "particles.mobility"),
        ("particles.prescribed_mass", "particles.fixed", "rods.between", "rods.density", "rods.rest_length"),
        derive_masses,
    ),
    Derivation(
        ("rods.tension_limit", "rods.compression_limit"),
        ("rods.tensile_strength", "rods.compressive_strength", "rods.tension_only"),
        derive_limits,
    ),
    Derivation(
        (
            *("rods.end_stiffness", "rods.end_damping", "rods.initial_slopes", "rods.load_shares"),
            *("rods.bowing", "rods.turning_shares"),
        ),
        (
            *("rods.bending_stiffness", "rods.stiffness", "rods.rest_length", "rods.hinged"),
            *("rods.damping", "rods.bending_damping", "rods.thermal_expansion", "rods.temperature_gradient"),
        ),
        derive_bending,
    ),
    Derivation(
        ("particles.inertia", "particles.turning"),
        (
            *("particles.prescribed_inertia", "particles.fixed_rotation", "particles.mass", "rods.between"),
            *(
                "rods.density",
                "rods.rest_length",
                "rods.bending_stiffness",
                "rods.stiffness",
                "rods.turning_shares",
            ),
        ),
        derive_inertia,
    ),
    Derivation(
        tuple(f"rods.{name}" for name in NAMES),
        (
            *(
                "particles.displacement",
                "particles.rotation",
                "rods.between",
                "rods.difference",
                "rods.rest_length",
            ),
            *("rods.axial_force", "rods.end_moment", "rods.distributed_force", "rods.turning_shares"),
            *(
                "rods.load_shares",
                "rods.bending_stiffness",
                "rods.thermal_expansion",
                "rods.temperature_gradient",
            ),
        ),
        derive_diagrams,
    ),
    Derivation(
        ("particles.constant_moment",),
        ("particles.moment", "loads.on", "loads.moment", "loads.history"),
        derive_constant_moment,
    ),
    Derivation(
        ("particles.constant_force",),
        (
            "particles.force",
            "rods.distributed_force",
            "rods.between",
            "rods.rest_length",
            "particles.acceleration",
            "particles.mass",
            "environment.force",
            "environment.acceleration",
            "loads.on",
            "loads.force",
            "loads.history",
        ),
        derive_constant_force,
    ),
)
