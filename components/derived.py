"""Derived columns: masses, lengths, limits, constant forces; and forces and bending moments along rods, by statics."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pinjoint.components.cases import SOURCES, Acting
from pinjoint.components.field import Column, Field
from pinjoint.components.load import SpanLoad, varying
from pinjoint.components.particle import DEFAULT_MASS
from pinjoint.components.rod import AT_STRENGTH, DEFAULT_STIFFNESS, euler_load, has_struts, plastic_moments
from pinjoint.components.section import Section
from pinjoint.components.spans import Curves, Kinks, extremes
from pinjoint.components.table import Table
from pinjoint.components.world import Derivation, World

# What acts between the ends of rods, and where.
_BETWEEN = " ".join(
    [
        SOURCES,
        *(f"rods.{name}" for name in ("distributed_force", "rest_length", "original_length")),
        *(f"span_loads.{field.name}" for field in vars(SpanLoad).values() if isinstance(field, Field)),
    ]
)


def derives(table: str, targets: str, sources: str) -> Callable[[Callable[[World], None]], Derivation]:
    """A decorator of what computes columns of a table from others, which may be named without the table."""

    def full(names: str) -> tuple[str, ...]:
        return tuple(name if "." in name else f"{table}.{name}" for name in names.split())

    return lambda compute: Derivation(full(targets), full(sources), compute)


def _or_automatic(prescribed: Column, automatic: ArrayLike) -> Column:
    return np.where(np.isnan(prescribed), automatic, prescribed)


@derives(
    "rods",
    "difference original_length rest_length misfit free_curvature",
    "between prescribed_rest_length temperature_change temperature_gradient thermal_expansion particles.position"
    f" span_loads.rod span_loads.temperature_change span_loads.temperature_gradient {SOURCES}",
)
def lengths(world: World) -> None:
    """Original difference and length of every rod, its rest length, and its misfit and curvature at its temperature."""
    rods = world.tables["rods"]
    position = world.tables["particles"].position
    ends = rods.between
    difference = world.writable("rods.difference")
    difference[...] = position[ends[:, 1]] - position[ends[:, 0]]
    original = world.writable("rods.original_length")
    original[...] = np.hypot(difference[:, 0], difference[:, 1])
    rest = world.writable("rods.rest_length")
    rest[...] = _or_automatic(rods.prescribed_rest_length, original)
    for name, values in unforced(world, original, rest, Acting.of(world)).items():
        world.writable(f"rods.{name}")[...] = values[0]


def unforced(world: World, original: Column, rest: Column, acting: Acting) -> dict[str, Column]:
    """Misfits and curvatures without force, by lack of fit and warmth, of rods of these lengths, (combinations, rods)."""
    rods, loads = world.tables["rods"], world.tables["span_loads"]
    by_loads = np.zeros((2, len(acting.permanent), rods.count))
    for found, name in zip(by_loads, ("temperature_change", "temperature_gradient"), strict=True):
        np.add.at(found.T, loads.rod, acting.span_loads.T * loads.column(name)[:, None])
    expansion, share = rods.thermal_expansion, acting.permanent[:, None]
    misfit = (
        share * (original - rest * (1.0 + expansion * rods.temperature_change)) - rest * expansion * by_loads[0]
    )
    return {"misfit": misfit, "free_curvature": -expansion * (share * rods.temperature_gradient + by_loads[1])}


@derives(
    "rods",
    "stiffness bending_stiffness",
    "prescribed_stiffness prescribed_bending_stiffness youngs_modulus area second_moment",
)
def stiffnesses(world: World) -> None:
    """EA and EI of every rod: prescribed, else E·A and E·I, else those of a bar of which nothing is known."""
    rods = world.tables["rods"]
    for name, of_section, unknown in (
        ("stiffness", rods.area, DEFAULT_STIFFNESS),
        ("bending_stiffness", rods.second_moment, 0.0),
    ):
        with np.errstate(over="ignore", under="ignore"):  # too large numbers are reported before a run
            known = rods.youngs_modulus * of_section
        automatic = _or_automatic(known, unknown)
        world.writable(f"rods.{name}")[...] = _or_automatic(rods.column(f"prescribed_{name}"), automatic)


@derives("rods", "section_modulus", "section second_moment")
def section_moduli(world: World) -> None:
    """W of every rod whose section knows its depth; NaN of others."""
    rods = world.tables["rods"]
    known = {name: Section.named(name) for name in set(rods.section) if name is not None}
    depths = [np.nan if (found := known.get(name)) is None else found.depth for name in rods.section]
    world.writable("rods.section_modulus")[...] = rods.second_moment / (
        0.5 * np.array(depths, dtype=np.float64)
    )


@derives("particles", "mass mobility", "prescribed_mass fixed rods.between rods.density rods.rest_length")
def masses(world: World) -> None:
    """Lumped masses (half of each attached rod's density × rest length) and mobilities."""
    particles, rods = world.tables["particles"], world.tables["rods"]
    with np.errstate(over="ignore"):  # too large numbers are reported before a run
        half = 0.5 * rods.density * rods.rest_length
    lumped = np.bincount(rods.between.ravel(), np.repeat(half, 2), particles.count)
    lumped[lumped == 0.0] = DEFAULT_MASS
    mass = world.writable("particles.mass")
    mass[...] = _or_automatic(particles.prescribed_mass, lumped)
    with np.errstate(over="ignore", divide="ignore"):  # too small numbers are, too
        mobility = np.where(particles.fixed, 0.0, 1000.0 / mass[:, None])
    world.writable("particles.mobility")[...] = mobility


@derives(
    "rods",
    "end_stiffness end_damping initial_slopes bowing turning_shares fixity",
    "bending_stiffness stiffness rest_length hinged end_springs damping bending_damping free_curvature",
)
def bending(world: World) -> None:
    """What the ends of each rod feel, by their joints: coefficients of slopes, all zero where nothing bends.

    Hinges and springs are condensed: the shape of the rod is that without axial force.
    """
    rods = world.tables["rods"]
    length, stiffness, springs = rods.rest_length, rods.bending_stiffness, rods.end_springs
    bent = (stiffness > 0.0)[:, None]
    if not (bent & ~(rods.hinged & (springs == 0.0))).any():
        for name in bending.targets:
            world.writable(name)[...] = 0.0
        return
    with np.errstate(over="ignore", invalid="ignore"):  # too large numbers are reported before a run
        softened = springs / np.where(springs > 0.0, springs + (3.0 * stiffness / length)[:, None], 1.0)
        fixity = np.where(springs > 0.0, softened, ~rods.hinged) * bent
        per_slope, of_ends = by_fixity(fixity)
        world.writable("rods.end_stiffness")[...] = (stiffness / length)[:, None] * per_slope
        damping = _or_automatic(rods.bending_damping, rods.damping * stiffness / rods.stiffness)
        world.writable("rods.end_damping")[...] = damping[:, None] * per_slope
        world.writable("rods.initial_slopes")[...] = initial_slopes(rods.free_curvature, length, fixity)
    for name, values in of_ends.items():
        world.writable(f"rods.{name}")[...] = values


def by_fixity(fixity: Column) -> tuple[Column, dict[str, Column]]:
    """End stiffnesses per EI/L₀, (rods, 3), and the columns of these names, of rods whose ends are held so, (rods, 2)."""
    start, end = fixity.T
    both = 4.0 - start * end
    (ss, se), (es, ee) = np.moveaxis(own_slopes(fixity), 0, -1)
    bowing = [4.0 * ss**2 - 2.0 * ss * es + 4.0 * es**2, 4.0 * ss * se - ss * ee - se * es + 4.0 * es * ee]
    bowing.append(4.0 * se**2 - 2.0 * se * ee + 4.0 * ee**2)
    shares = fixity / np.where(fixity.any(axis=1), start + end, 1.0)[:, None]
    return np.stack([12.0 * start, 6.0 * start * end, 12.0 * end], axis=1) / both[:, None], {
        "fixity": fixity,
        "bowing": np.stack(bowing, axis=1) / 30.0 + 0.0,
        "turning_shares": shares,
    }


def initial_slopes(curvature: Column, length: Column, fixity: Column) -> Column:
    """Slopes of ends without moments of rods so curved (…, rods), by how firmly their ends are joined, (…, rods, 2)."""
    return (0.5 * curvature * length)[..., None] * (fixity > 0.0) * [-1.0, 1.0] + 0.0


def own_slopes(fixity: Column) -> Column:
    """How the slopes of rods' own ends follow from those of their joints without load, (rods, 2, 2).

    A spring k lets the end of a rod turn by M/k less than its joint; one without stiffness is a hinge. By its transpose,
    moments that hold both ends still become those that hold the joints still.
    """
    start, end = fixity.T
    rows = [[start * (4.0 - end), 2.0 * (start - 1.0) * end], [2.0 * (end - 1.0) * start, end * (4.0 - start)]]
    found: Column = np.moveaxis(np.array(rows), -1, 0) / (4.0 - start * end)[:, None, None]
    return found


@derives("rods", "span_load", f"fixity {_BETWEEN}")
def span_loads(world: World) -> None:
    """What acts between the ends of rods, by slopes of their joints."""
    rods = world.tables["rods"]
    clamped = Kinks.of(world).on_clamped(rods.rest_length)
    world.writable("rods.span_load")[...] = on_joints(clamped, rods.fixity)


def on_joints(clamped: Column, fixity: Column) -> Column:
    """Work of loads by slopes of clamped ends, (rods, 7), as that by slopes of joints that hold the ends so."""
    found = clamped.copy()
    found[:, :6] = np.einsum("rij,rik->rjk", own_slopes(fixity), clamped[:, :6].reshape(-1, 2, 3)).reshape(
        -1, 6
    )
    return found


def on_axis(load: Column, axis: Column) -> tuple[Column, Column]:
    """Of what acts between ends, (rods, 7): work along and across axes (rods, 2) by unit slopes of the ends, (rods, 2) each.

    Couples count as across.
    """
    by_end = load[:, :6].reshape(-1, 2, 3)
    x, y = axis[:, :1], axis[:, 1:]
    return by_end[..., 0] * x + by_end[..., 1] * y, by_end[..., 1] * x - by_end[..., 0] * y + by_end[..., 2]


@derives(
    "particles",
    "inertia turning",
    "prescribed_inertia fixed_rotation mass rods.between rods.density rods.rest_length rods.bending_stiffness"
    " rods.stiffness rods.turning_shares",
)
def inertias(world: World) -> None:
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
        inertia = world.writable("particles.inertia")
        inertia[...] = np.where(turns, _or_automatic(particles.prescribed_inertia, own), 0.0)
        free = turns & ~particles.fixed_rotation
        world.writable("particles.turning")[...] = np.where(free, 1000.0 / inertia, 0.0)


@derives("rods", "buckling_load", "buckles bending_stiffness rest_length fixity tension_only inextensible")
def buckling_loads(world: World) -> None:
    """P of struts, infinite of other rods."""
    rods, load = world.tables["rods"], world.writable("rods.buckling_load")
    load[...] = np.where(rods.buckles, euler_load(world), np.inf) if rods.buckles.any() else np.inf


@derives("rods", "lateral_deflection", "buckling_load stiffness rest_length strain plastic_strain")
def lateral_deflections(world: World) -> None:
    """Amplitude (2L₀/π) √r of the half sine of struts, r being what of their shortening is not elastic."""
    rods, found = world.tables["rods"], world.writable("rods.lateral_deflection")
    found[...] = amplitude(rods, rods.strain, rods.plastic_strain)


def amplitude(rods: Table[Any], strain: Column, plastic_strain: Column) -> Column:
    """That at these strains, (rods,)."""
    nearer = plastic_strain - strain - rods.buckling_load / rods.stiffness
    return 2.0 / math.pi * rods.rest_length * np.sqrt(np.maximum(nearer, 0.0))


@derives(
    "rods",
    "tension_limit compression_limit",
    "tensile_strength compressive_strength tension_only buckling_load",
)
def limits(world: World) -> None:
    """Strengths with "unlimited" (None or 0) as infinity; cables slacken, and slender struts buckle, before they yield."""
    for direction, name in (("tension", "tensile"), ("compression", "compressive")):
        values = world.tables["rods"].column(f"{name}_strength")
        unlimited = np.isnan(values) | (values == 0.0)
        world.writable(f"rods.{direction}_limit")[...] = np.where(unlimited, np.inf, values)
    rods, limit = world.tables["rods"], world.writable("rods.compression_limit")
    limit[rods.tension_only | (rods.buckling_load < limit)] = np.inf


_OF_MOMENTS = "plastic_moment fixity section material bending_stiffness settings.plastic_hinges"


@derives("rods", "moment_limit", _OF_MOMENTS)
def moment_limits(world: World) -> None:
    """Plastic moments of the ends that moments reach, with "unlimited" as infinity."""
    rods = world.tables["rods"]
    limit = np.where(rods.fixity > 0.0, plastic_moments(world)[:, None], np.inf)
    world.writable("rods.moment_limit")[...] = limit


@derives("rods", "hinge_yielding", "end_moment moment_limit settings.plasticity")
def plastic_hinges(world: World) -> None:
    """Ends whose moments are at the plastic moment, but for round-off."""
    rods, settings = world.tables["rods"], world.tables["settings"]
    reached = np.abs(rods.end_moment) >= rods.moment_limit * AT_STRENGTH
    world.writable("rods.hinge_yielding")[...] = reached & settings.plasticity[:, None]


@derives(
    "particles",
    "constant_force",
    "force acceleration mass environment.force environment.acceleration"
    f" rods.between {_BETWEEN} loads.on loads.force loads.history",
)
def constant_forces(world: World) -> None:
    """Own force, environment's force, mass × accelerations (kN), constant loads, and what rods bear between their ends."""
    particles, loads, rods = world.tables["particles"], world.tables["loads"], world.tables["rods"]
    environment = world.tables["environment"]
    constant = ~varying(loads)
    with np.errstate(over="ignore", invalid="ignore"):  # too large numbers are reported before a run
        acceleration = particles.acceleration + environment.acceleration
        force = particles.force + environment.force + particles.mass[:, None] * acceleration / 1000.0
        acting = Acting.of(world)
        force *= acting.permanent[0]
        np.add.at(force, loads.on[constant], (acting.loads[0, :, None] * loads.force)[constant])
        if len((between := Kinks.of(world)).row):
            np.add.at(force, rods.between.ravel(), between.on_ends(rods.count).reshape(-1, 2))
    world.writable("particles.constant_force")[...] = force


@derives("particles", "constant_moment", f"moment loads.on loads.moment loads.history {SOURCES}")
def constant_moments(world: World) -> None:
    """Own moment and that of constant loads (kN·m)."""
    loads = world.tables["loads"]
    constant, moment = ~varying(loads), world.writable("particles.constant_moment")
    acting = Acting.of(world)
    moment[...] = acting.permanent[0] * world.tables["particles"].moment
    np.add.at(moment, loads.on[constant], (acting.loads[0] * loads.moment)[constant])


@derives("settings", "displacement_scale", "prescribed_displacement_scale automatic_displacement_scale")
def displacement_scale(world: World) -> None:
    """How much larger displacements are drawn."""
    settings = world.tables["settings"]
    scale = _or_automatic(settings.prescribed_displacement_scale, settings.automatic_displacement_scale)
    world.writable("settings.displacement_scale")[...] = scale


# --- diagrams along rods -------------------------------------------------------------------------


def chord_rotation(world: World) -> Column:
    """How far the chord of every rod has turned (rad), with the full turns that its rigid ends tell; shape (rods,)."""
    particles, rods = world.tables["particles"], world.tables["rods"]
    first, second = rods.between.astype(np.intp).T
    relative = particles.displacement[second] - particles.displacement[first]
    difference = rods.difference
    sine = difference[:, 0] * relative[:, 1] - difference[:, 1] * relative[:, 0]
    if world.first_order:
        found: Column = sine / np.maximum(rods.original_length, 1e-300) ** 2
        return found
    chord = np.arctan2(sine, (difference * (difference + relative)).sum(axis=1))
    rotation = particles.rotation[rods.between] - rods.plastic_rotation
    return with_full_turns(chord, rods.turning_shares, rotation)


def with_full_turns(chord: Column, turning_shares: Column, rotation: Column) -> Column:
    """Rotations of chords (rods,) with those full turns that bring them nearest to the mean of their rigid ends."""
    mean = (turning_shares * rotation).sum(axis=1)
    found: Column = chord + math.tau * np.rint((mean - chord) / math.tau)
    return found


@derives(
    "rods",
    "end_axial_force shear bending_moment end_rotation largest_moment",
    "particles.displacement particles.rotation between difference axial_force end_moment turning_shares"
    f" plastic_rotation {_BETWEEN} span_load bending_stiffness free_curvature lateral_deflection",
)
def present_diagrams(world: World) -> None:
    """Axial force, shear and bending moment at both ends of every rod, and the rotations of these, in the present state.

    By statics, with distributed forces per original length. A hinged end turns as far as its moment is zero.
    """
    particles, rods = world.tables["particles"], world.tables["rods"]
    first, second = rods.between.astype(np.intp).T
    present = rods.difference + particles.displacement[second] - particles.displacement[first]
    length = np.hypot(present[:, 0], present[:, 1])
    axis = present / np.where(length > 0.0, length, 1.0)[:, None]
    rotation, forces = particles.rotation[rods.between], (rods.axial_force, rods.end_moment)
    aside = rods.lateral_deflection if has_struts(world) else None
    for name, values in diagrams(world, axis, length, chord_rotation(world), rotation, forces, aside).items():
        world.writable(f"rods.{name}")[...] = values


def diagrams(
    world: World,
    axis: Column,
    length: Column,
    chord: Column,
    rotation: Column,
    forces: tuple[Column, Column],
    aside: Column | None = None,
    *,
    share: float = 1.0,
    first_order: bool = False,
) -> Mapping[str, Column]:
    """The columns of `present_diagrams` of all rods, (rods, 2), with so much of what acts between their ends.

    axis, length, chord: directions (rods, 2), lengths (m) and rotations (rad) of the chords; rotation: of the particles at
    both ends, (rods, 2). forces: axial (rods,), and moments on both ends, counter-clockwise (rods, 2).
    aside: lateral deflections of struts (m), (rods,); None where there are none. first_order: other axes count as straight
    where forces act on them.
    """
    rods, (axial_force, moment) = world.tables["rods"], forces
    between, bent = Kinks.of(world, share), 0.0 if first_order else 1.0
    slopes = rigid_slopes(rods, rotation, chord)
    couple = share * rods.span_load[:, 6] - bent * share * (on_axis(rods.span_load, axis)[0] * slopes).sum(
        axis=1
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        shear = np.where(length > 0.0, (moment.sum(axis=1) + couple) / length, 0.0)
    x, y = axis[:, :1], axis[:, 1:]
    on_ends = between.on_ends(rods.count) * [[[-1.0], [1.0]]]
    slopes = all_slopes(rods, slopes, on_axis(between.on_clamped(rods.rest_length), axis)[1])
    bending_moment, left = moment * [-1.0, 1.0], np.concatenate([-y, x], axis=1)
    thrust = (bent * axial_force * length)[:, None] * cubic(*slopes.T)
    of_struts = None if aside is None else axial_force * aside
    moments = moments_along(bending_moment, between, left, length, thrust, of_struts)
    return {
        "end_axial_force": axial_force[:, None] - on_ends[..., 0] * x - on_ends[..., 1] * y,
        "shear": shear[:, None] + on_ends[..., 1] * x - on_ends[..., 0] * y,
        "bending_moment": bending_moment,
        "end_rotation": chord[:, None] + slopes,
        "largest_moment": _largest_moment(moments, length),
    }


def rigid_slopes(rods: Table[Any], rotation: Column, chord: Column) -> Column:
    """Slopes to the chords of those ends that are joined rigidly, less plastic rotations; 0 at others; (rods, 2).

    rotation: of the particles at both ends, (rods, 2). chord: (rods,).
    """
    return np.where(rods.turning_shares > 0.0, rotation - chord[:, None] - rods.plastic_rotation, 0.0)


def all_slopes(rods: Table[Any], slopes: Column, load: Column) -> Column:
    """Slopes of rods' own ends, by those of their joints (0 at hinges), warmth and what acts between clamped ends.

    load: that, by unit slopes of these, (rods, 2).
    """
    length, stiffness = rods.rest_length, rods.bending_stiffness
    bent = stiffness > 0.0
    loaded = np.divide(length, stiffness, out=np.zeros(len(length)), where=bent)[:, None] * load
    warped = np.where(bent, -0.5 * rods.free_curvature * length, 0.0)
    free = np.array([1.0, -1.0]) * warped[:, None] + loaded / 3.0 - loaded[:, ::-1] / 6.0  # between hinges
    own = own_slopes(rods.fixity)
    found: Column = np.einsum("rij,rj->ri", own, slopes) + np.einsum("rij,rj->ri", np.eye(2) - own, free)
    return found


# sin πξ as a u + b u² of u = ξ (1 − ξ), exact in the middle and at quarters, elsewhere but for 0.002.
_QUARTIC = 256.0 / 3.0 * (0.75 - math.sqrt(0.5))
HALF_SINE = np.array([0.0, 4.0 - 0.25 * _QUARTIC, 1.25 * _QUARTIC - 4.0, -2.0 * _QUARTIC, _QUARTIC])


def cubic(start: Column, end: Column) -> Column:
    """The deflection φ_s ξ (1 − ξ)² − φ_e ξ² (1 − ξ) between ends with these slopes, lowest coefficient first, (rods, 4)."""
    return np.stack([np.zeros(len(start)), start, -(2.0 * start + end), start + end], axis=1)


def moments_along(
    ends: Column,
    between: Kinks,
    left: Column,
    length: Column,
    by_thrust: Column,
    of_struts: Column | None = None,
) -> Curves:
    """M(ξ) = M_s (1 − ξ) + M_e ξ + what acts between the ends makes of simple beams + N v(ξ) of all rods.

    ends: M_s and M_e, (rods, 2). left: unit vectors to the left of the chords, length: theirs. by_thrust: N v, (rods, 4),
    but for the half sine of struts, of which of_struts has N v in the middle, (rods,); None: there are none.
    """
    straight = by_thrust.copy()
    straight[:, 0] += ends[:, 0]
    straight[:, 1] += ends[:, 1] - ends[:, 0]
    found = between.bulges(left, length).plus(straight)
    return found if of_struts is None else found.plus(np.outer(of_struts, HALF_SINE))


def _largest_moment(moments: Curves, length: Column) -> Column:
    """The bending moment of largest size, and its distance from the start (m), of every rod."""
    row, low, high, polynomials = moments.stretches
    if polynomials.shape[1] > 4:  # of struts
        both, places = extremes(moments.stretches)
        most = np.abs(both).argmax(axis=1)[:, None]
        return np.hstack(
            [np.take_along_axis(both, most, 1), np.take_along_axis(places, most, 1) * length[:, None]]
        )
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        start, linear, square, cube = polynomials.T
        root = np.sqrt(np.maximum(square**2 - 3.0 * cube * linear, 0.0))
        both = -(square + np.copysign(root, square))
        found = np.stack([low, high, both / (3.0 * cube), linear / both])
    found = np.where((found > low) & (found <= high), found, low)
    values = start + found * (linear + found * (square + found * cube))
    chosen, each = np.abs(values).argmax(axis=0), np.arange(len(row))
    values, found = values[chosen, each], found[chosen, each]
    order = np.lexsort((-np.abs(values), row))
    most = order[np.unique(row[order], return_index=True)[1]] if len(row) > len(length) else each
    return np.stack([values[most], found[most] * length], axis=1)


DERIVATIONS = [known for known in globals().copy().values() if isinstance(known, Derivation)]  # all those above
