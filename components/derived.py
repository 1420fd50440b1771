"""Derived columns: masses, lengths, limits and constant forces."""

from __future__ import annotations

import numpy as np

from components.load import CONSTANT
from components.particle import DEFAULT_MASS
from components.rod import DEFAULT_STIFFNESS
from components.world import Derivation, World


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
    """EA of every rod: prescribed, else E·A, else that of a rod of which nothing is known."""
    rods = world.tables["rods"]
    with np.errstate(over="ignore", under="ignore"):  # too large numbers are reported before a run
        known = rods.youngs_modulus * rods.area
    prescribed = rods.prescribed_stiffness
    automatic = np.where(np.isnan(known), DEFAULT_STIFFNESS, known)
    world.writable("rods.stiffness")[...] = np.where(np.isnan(prescribed), automatic, prescribed)


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


def derive_limits(world: World) -> None:
    """Strengths with "unlimited" (None or 0) as infinity; a cable goes slack before any compression."""
    for direction, name in (("tension", "tensile"), ("compression", "compressive")):
        values = world.tables["rods"].column(f"{name}_strength")
        unlimited = np.isnan(values) | (values == 0.0)
        world.writable(f"rods.{direction}_limit")[...] = np.where(unlimited, np.inf, values)
    world.writable("rods.compression_limit")[world.tables["rods"].tension_only] = np.inf


def derive_constant_force(world: World) -> None:
    """Own force, environment's force, mass × accelerations (kN) and constant loads."""
    particles, loads = world.tables["particles"], world.tables["loads"]
    environment = world.tables["environment"]
    constant = [row for row, history in enumerate(loads.history) if history["kind"] == CONSTANT["kind"]]
    with np.errstate(over="ignore", invalid="ignore"):  # too large numbers are reported before a run
        acceleration = particles.acceleration + environment.acceleration
        force = particles.force + environment.force + particles.mass[:, None] * acceleration / 1000.0
        np.add.at(force, loads.on[constant], loads.force[constant])
    world.writable("particles.constant_force")[...] = force


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
        ("rods.stiffness",),
        ("rods.prescribed_stiffness", "rods.youngs_modulus", "rods.area"),
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
        ("particles.constant_force",),
        (
            "particles.force",
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
