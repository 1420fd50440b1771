"""Rod: a massless axial member between two different particles."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.cases import permanent
from pinjoint.components.field import (
    CM,
    ENDS,
    VALUE,
    Column,
    Field,
    FieldError,
    Vector,
    by_end,
    derived,
    if_known,
    state,
)
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.particle import Particle, rods_without_length
from pinjoint.components.section import (
    MATERIALS,
    SECTIONS,
    Material,
    by_area,
    check_material,
    check_section,
    given_by,
    plastic_moment,
)
from pinjoint.components.table import Table, flags
from pinjoint.components.world import World

AT_STRENGTH = 1.0 - 1e-9  # share of its strength from which on a rod is said to yield
DEFAULT_STIFFNESS = 164640.0  # kN, of a rod of which no other is known
_NAMED_BY = {"area": "section", "second_moment": "section", "youngs_modulus": "material"}
_NUMBERS_OF_NAMES = {*_NAMED_BY, "material"}
_OF_HINGES = {"plastic_moment", "prescribed_bending_stiffness", *_NAMED_BY}


class Rod(Handle):
    """A pin-jointed bar: elastic or elastic–perfectly plastic, with an axial damper. Tension is positive."""

    __slots__ = ()
    table, noun = "rods", "rod"

    name: Field[str] = Field(doc="Its name; no two rods have the same.", dtype=str)
    between: Field[tuple[int, int]] = Field(
        dtype="reference",
        shape=(2,),
        references="particles",
        title="ends",
        doc="The particles at its two ends: names in files, rows in Python.",
    )
    prescribed_stiffness: Field[float | None] = if_known(
        "kN",
        doc="EA, force per unit of strain; automatic: Young's modulus × area, or 164640 kN if either is unknown.",
        overrides="stiffness",
    )
    youngs_modulus: Field[float | None] = if_known(
        "kN/m²",
        absent="unknown",
        title="Young's modulus",
        doc="E of the material: steel 210 GPa, aluminium 70, concrete 30, timber 11.",
        shown=("GPa", 1e-6),
    )
    area: Field[float | None] = if_known(
        "m²",
        absent="unknown",
        doc="A of the cross-section: E·A is the stiffness, axial force / A the stress.",
        shown=("cm²", 1e4),
    )
    second_moment: Field[float | None] = if_known(
        "m⁴",
        absent="unknown",
        title="second moment",
        doc="I of the cross-section: E·I is the bending stiffness.",
        shown=("cm⁴", 1e8),
    )
    section: Field[str | None] = Field(
        dtype=str,
        nullable=True,
        absent="none",
        choices=SECTIONS,
        checker=check_section,
        doc="IPE, HEA, HEB, CHS, SHS or 'rectangle 300×500': sets A and I and, by its material, weight and strength.",
    )
    material: Field[str | None] = Field(
        dtype=str,
        nullable=True,
        absent="none",
        choices=MATERIALS,
        checker=check_material,
        doc="Sets E and thermal expansion and, if the area is known, weight and strength.",
    )
    prescribed_rest_length: Field[float | None] = if_known(
        "m",
        doc="Length without force; automatic: the distance between the original positions.",
        shown=CM,
        overrides="rest_length",
    )
    tensile_strength: Field[float | None] = Field(
        "kN", nullable=True, absent="unlimited", minimum=0.0, doc="Tension at which it yields; 0: unlimited."
    )
    compressive_strength: Field[float | None] = Field(
        "kN",
        nullable=True,
        absent="unlimited",
        minimum=0.0,
        doc="Compression at which it yields; 0: unlimited.",
    )
    plastic_moment: Field[float | None] = if_known(
        "kN·m",
        absent="unlimited",
        doc="Bending moment at which its ends yield (plastic hinges); else its section's, by “plastic hinges of sections”.",
    )
    damping: Field[float] = Field(
        "kN·s/m",
        default=100.0,
        minimum=0.0,
        title="damping coefficient",
        doc="Axial force of its damper per rate of elongation.",
    )
    density: Field[float] = Field(
        "kg/m", default=6.15, minimum=0.0, doc="Mass per length.", shown=("kg/cm", 0.01)
    )
    temperature_change: Field[float] = Field(
        "K", doc="How much warmer it is than when it had its rest length; it expands as it warms."
    )
    thermal_expansion: Field[float] = Field(
        "1/K",
        default=1.2e-5,
        minimum=0.0,
        doc="Strain per change of temperature; steel: 12·10⁻⁶/K.",
        shown=("10⁻⁶/K", 1e6),
    )
    tension_only: Field[bool] = Field(
        dtype=bool,
        doc="A cable: it bears tension only, and is slack when its ends are closer than its rest length.",
    )
    inextensible: Field[bool] = Field(
        dtype=bool,
        doc="In first-order theory it keeps its length, whatever EA is, and does not yield; elsewhere it has its EA.",
    )
    buckles: Field[bool] = Field(
        dtype=bool,
        title="strut that buckles",
        doc="Hinged at both ends, with an EI, it bends aside at P = π² EI/L₀² and then bears P (1 + r/2), r the share of"
        " its length that its ends come nearer; in first-order theory P. Loads along it and its mass do not count.",
    )
    prescribed_bending_stiffness: Field[float | None] = Field(
        "kN·m²",
        nullable=True,
        minimum=0.0,
        doc="EI, moment per curvature; 0: pinned at both ends; automatic: E × second moment, or 0 if either is unknown.",
        overrides="bending_stiffness",
    )
    hinged: Field[tuple[bool, bool]] = Field(
        dtype=bool,
        axes=ENDS,
        doc="Ends that turn freely; the others are rigidly joined. Without bending stiffness both turn freely.",
    )
    end_springs: Field[Vector] = Field(
        "kN·m/rad",
        axes=ENDS,
        minimum=0.0,
        doc="Stiffness of springs that join its ends to what turns with their particles, in place of hinges or rigid"
        " joints; 0: none.",
    )
    distributed_force: Field[Vector] = Field(
        "kN/m",
        shape=(2,),
        doc="Force per unit of original length, all along it; its direction does not turn with the rod.",
    )
    temperature_gradient: Field[float] = Field(
        "K/m", doc="How much warmer it gets per metre of depth towards its left side, seen from start to end."
    )
    bending_damping: Field[float | None] = Field(
        "kN·m·s",
        nullable=True,
        minimum=0.0,
        doc="c in the damping moments at its ends, c [4 2; 2 4] × rates of the end slopes; automatic: damping × EI/EA.",
    )
    plastic_strain: Field[float] = state(doc="Permanent part of the strain.")
    plastic_rotation: Field[Vector] = state(
        "rad", axes=ENDS, doc="Permanent part of the slopes of its ends, in plastic hinges."
    )
    yielded_at: Field[float | None] = state(
        "s", nullable=True, absent="not yet", doc="When it first yielded in this run."
    )
    hinge_formed_at: Field[Vector] = state(
        "s",
        axes=ENDS,
        default=(-1.0, -1.0),
        doc="When plastic hinges first formed at its ends in this run; −1: not yet.",
    )
    stiffness: Field[float] = derived(
        "kN",
        default=DEFAULT_STIFFNESS,
        doc="EA: as given, or Young's modulus × area, or 164640 kN if either is unknown.",
    )
    bending_stiffness: Field[float] = derived(
        "kN·m²", doc="EI: as given, or Young's modulus × second moment, or 0: pinned at both ends."
    )
    rest_length: Field[float] = derived(
        "m", above=0.0, doc="As given, or the distance between the original positions.", shown=CM
    )
    difference: Field[tuple[float, float]] = derived(
        "m",
        shape=(2,),
        title="original difference",
        doc="Original position of the second end minus that of the first.",
        shown=CM,
    )
    original_length: Field[float] = derived("m", doc="Length of the original difference.", shown=CM)
    misfit: Field[float] = derived(
        "m",
        doc="Original length − rest length × (1 + thermal strain): its elongation where it was drawn.",
        shown=CM,
    )
    free_curvature: Field[float] = derived(
        "1/m", doc="Its curvature without moments, by the temperature gradient."
    )
    end_stiffness: Field[tuple[float, float, float]] = derived(
        "kN·m",
        axes=("ss", "se", "ee"),
        doc="End moments per slope: EI/L₀ (4, 2, 4), with one hinge 3 EI/L₀ at the other end; less with springs.",
    )
    end_damping: Field[tuple[float, float, float]] = derived(
        "kN·m·s", axes=("ss", "se", "ee"), doc="End moments per rate of slope, likewise."
    )
    bowing: Field[tuple[float, float, float]] = derived(
        axes=("ss", "se", "ee"), doc="Twice the strain of the axis per slopes: its share of bending."
    )
    fixity: Field[Vector] = by_end(
        doc="How firmly its ends are joined: 0 by a hinge, 1 rigidly, k/(k + 3 EI/L₀) by a spring."
    )
    turning_shares: Field[Vector] = by_end(
        doc="Weight of each end in its mean rotation, from which full turns are counted."
    )
    initial_slopes: Field[Vector] = by_end(
        "rad", doc="Slopes of its ends to its chord while no moment acts, caused by the temperature gradient."
    )
    span_load: Field[tuple[float, ...]] = derived(
        "kN·m",
        axes=("start x", "start y", "start turn", "end x", "end y", "end turn", "turn"),
        doc="Work of what acts between its ends, by unit slopes of these: forces × deflections, couples × rotations; turn:"
        " couples.",
    )
    section_modulus: Field[float | None] = derived(
        "m³",
        nullable=True,
        absent="unknown",
        doc="W = second moment / half the depth, which the section gives.",
        shown=("cm³", 1e6),
    )
    tension_limit: Field[float] = derived("kN", doc="Tensile strength; infinite if unlimited.")
    compression_limit: Field[float] = derived("kN", doc="Compressive strength; infinite if unlimited.")
    buckling_load: Field[float] = derived(
        "kN", doc="P = π² EI/L₀², the compression at which a strut buckles; infinite of other rods."
    )
    lateral_deflection: Field[float] = derived(
        "m", doc="How far a strut that has buckled is bent aside in the middle, (2L₀/π) √r.", shown=CM
    )
    moment_limit: Field[Vector] = by_end(
        "kN·m", doc="Plastic moment; infinite if unlimited, or where an end turns freely."
    )
    axial_force: Field[float] = derived(
        "kN", doc="Positive in tension; the force of its damper is not included."
    )
    length: Field[float] = derived("m", doc="Present distance between the ends.", shown=CM)
    strain: Field[float] = derived(doc="Elongation / rest length, without thermal expansion.")
    end_moment: Field[Vector] = by_end(
        "kN·m", doc="Moments on its ends, counter-clockwise; those of its dampers are not included."
    )
    end_axial_force: Field[Vector] = by_end(
        "kN", doc="Axial force at each end; that of the rod is its mean along it."
    )
    shear: Field[Vector] = by_end(
        "kN", doc="At its ends: force of the part before a cut on the part beyond it, positive to the left."
    )
    bending_moment: Field[Vector] = by_end(
        "kN·m", doc="At its ends; positive: the side on its right is in tension."
    )
    end_rotation: Field[Vector] = by_end(
        "rad", doc="By how much its ends have turned, counter-clockwise, also where they are hinged."
    )
    largest_moment: Field[Vector] = derived(
        "kN·m, m",
        axes=(VALUE, marked("distance")),
        doc="The bending moment of largest size, and how far from the start.",
    )
    yielding: Field[bool] = derived(dtype=bool, doc="Its axial force has reached a strength.")
    hinge_yielding: Field[tuple[bool, bool]] = by_end(
        dtype=bool, doc="The bending moment there has reached the plastic moment: a plastic hinge."
    )

    @property
    def ends(self) -> tuple[Particle, Particle]:
        """The particles at its two ends."""
        particles = self.world.tables["particles"]
        first, second = self.between
        return particles[first], particles[second]

    @classmethod
    def completed(cls, columns: Mapping[str, Column], count: int) -> Mapping[str, Column]:
        """With the numbers that a section and a material give, where none are given themselves."""
        names = [columns.get(name, [None] * count) for name in ("section", "material")]
        given = [given_by(*pair) for pair in zip(*names, strict=True)]
        made = dict(columns)
        for name in dict.fromkeys(name for each in given for name in each):
            field = vars(cls)[name]
            if name == "material" or name not in columns:
                column = made[name] = made.get(name, field.allocate(count)).copy()
                for row, each in enumerate(given):
                    column[row] = each.get(name, column[row])
        return made

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """A rod joins two different particles that no other joins, and has some length."""
        if "between" in changed:
            _check_ends(table, rows)
        if "between" in changed or "prescribed_rest_length" in changed:
            for row in rods_without_length(table.world, rows)[:1].tolist():
                raise FieldError(
                    "{rod}: its ends are at the same place; move one of them or give it a rest length above 0.",
                    rod=table.world.describe(table[row]),
                )
        if "inextensible" in changed or "tension_only" in changed:
            for row in rows[table.inextensible[rows] & table.tension_only[rows]][:1].tolist():
                raise FieldError(
                    "{rod}: a cable cannot be inextensible; let it bear compression, too, or have an EA.",
                    rod=table.world.describe(table[row]),
                )
        if "section" in changed or not _NUMBERS_OF_NAMES.isdisjoint(changed):
            _heed_names(table, rows, changed)
        if not _OF_HINGES.isdisjoint(changed):
            _check_plastic_moment(table, rows)
        if "temperature_change" in changed or "thermal_expansion" in changed:
            _check_warmth(table, rows)


def _heed_names(table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
    """Let numbers follow the names of section and material, and names not stand beside other numbers than theirs.

    The joints stay: a bar that did not bend is hinged at both ends. Raises FieldError for new rods that contradict
    themselves.
    """
    world, alone = table.world, len(changed) == 1
    if alone and not {"section", "material"}.isdisjoint(changed):
        pinned = table.bending_stiffness[rows] == 0.0
        for row in rows.tolist():
            _follow_names(table, table[row])
        stiff = rows[pinned & (table.bending_stiffness[rows] > 0.0)]
        world.assign([table[row] for row in stiff.tolist()], "hinged", [(True, True)] * len(stiff))
        return
    named = (table.section[rows] != None) | (table.material[rows] != None)  # noqa: E711 (of each row)
    for row in rows[named].tolist():
        rod = table[row]
        for name, number in _contradictions(rod, changed):
            if not alone:
                field, value = table.fields[number], getattr(rod, number)
                unit, factor = field.on_screen
                raise FieldError(
                    "{rod}: {title} is {value:.6g} {unit}, but {name} has another value; leave out one of the two.",
                    rod=world.describe(rod),
                    title=field.named(),
                    value=value * factor,
                    unit=unit,
                    name=getattr(rod, name),
                )
            world.assign([rod], name, None)


def _follow_names(table: Table[Any], rod: Rod) -> None:
    given = given_by(rod.section, rod.material)
    substance = Material.named(rod.material) if rod.material is not None else None
    if rod.section is None and substance is not None and rod.area is not None:
        given |= by_area(substance, rod.area)
    known = {"stiffness": rod.section or rod.area, "bending_stiffness": rod.section or rod.second_moment}
    automatic = [f"prescribed_{name}" for name, by in known.items() if by and "youngs_modulus" in given]
    for name, value in [*given.items(), *((name, None) for name in automatic)]:
        table.world.assign([rod], name, [value])


def _contradictions(rod: Rod, changed: Collection[str]) -> list[tuple[str, str]]:
    """Names that a rod has beside another, changed number than theirs, each with the Field of that."""
    given = given_by(rod.section, rod.material)
    return [
        (name, number)
        for number, name in _NAMED_BY.items()
        if number in changed
        and getattr(rod, name) is not None
        and not math.isclose(getattr(rod, number) or math.inf, given[number], rel_tol=1e-3)
    ]


def _check_plastic_moment(table: Table[Any], rows: NDArray[np.intp]) -> None:
    """Only what bends has a plastic moment."""
    idle = (table.bending_stiffness[rows] == 0.0) & ~np.isnan(table.plastic_moment[rows])
    for row in rows[idle][:1].tolist():
        raise FieldError(
            "{rod}: it does not bend, so that it has no plastic moment ({moment:g} kN·m); give it a bending stiffness"
            " above 0, or remove the plastic moment.",
            rod=table.world.describe(table[row]),
            moment=table.plastic_moment[row],
        )


def _check_warmth(table: Table[Any], rows: NDArray[np.intp]) -> None:
    """A rod that cools does not shrink to nothing."""
    strain = table.thermal_expansion[rows] * table.temperature_change[rows]
    for row in rows[strain <= -1.0][:1].tolist():
        change = table.temperature_change[row]
        raise FieldError(
            "{rod}: a temperature change of {change:g} K would leave it no length; cool it less or lower its"
            " thermal expansion.",
            rod=table.world.describe(table[row]),
            change=change,
        )


def _check_ends(table: Table[Any], rows: NDArray[np.intp]) -> None:
    world, names = table.world, table.world.tables["particles"].column("name")
    ends = table.between[rows]
    for row in rows[ends[:, 0] == ends[:, 1]][:1].tolist():
        raise FieldError(
            "{where}: both ends are {name}; a rod needs two different particles.",
            where=world.describe(table[row], "between"),
            name=names[table.between[row, 0]],
        )
    first, second = table.between.astype(np.uint64).T
    pairs = (np.minimum(first, second) << np.uint64(32)) | np.maximum(first, second)
    ordered = np.sort(pairs)
    for pair in ordered[1:][ordered[1:] == ordered[:-1]][:1]:
        *others, row = sorted(np.flatnonzero(pairs == pair).tolist(), key=lambda row: (row in rows, row))
        one, two = names[table.between[row]]
        raise FieldError(
            "{where}: {other} joins {one} and {two} already; two particles share at most one rod.",
            where=world.describe(table[row], "between"),
            other=world.describe(table[others[-1]]),
            one=one,
            two=two,
        )


def is_warm(world: World) -> bool:
    """True if rods have another elongation where they were drawn than by their lengths: the temperature of some has changed,
    or what is permanent acts by another factor than 1."""
    tables = (world.tables["rods"], world.tables["span_loads"])
    return any(table.temperature_change.any() for table in tables) or permanent(world) != 1.0


def is_warped(world: World) -> bool:
    """True if some rod that bends is warmer on one side."""
    return bool(world.tables["rods"].initial_slopes.any())


def bends(world: World) -> bool:
    """True if some rod has bending stiffness, and an end that is not hinged, or if a moment acts between its ends."""
    rods = world.tables["rods"]
    return bool(rods.turning_shares.any() or turned_between(world))


def rigid_joints(world: World) -> NDArray[np.bool_]:
    """Which particles have rigid ends of rods that bend, shape (particles,)."""
    rods = world.tables["rods"]
    return flags(rods.between[rods.turning_shares > 0.0], world.tables["particles"].count)


def idle_moment(world: World) -> str:
    """The sentence about a moment on a particle without rigid rod ends, which turns nothing; "" if there is none."""
    particles, loads = world.tables["particles"], world.tables["loads"]
    moment = np.abs(particles.moment)
    np.maximum.at(moment, loads.on, np.abs(loads.moment))
    if not moment.any():
        return ""
    for row in np.flatnonzero((moment > 0.0) & ~rigid_joints(world))[:1].tolist():
        return tr(
            "{particle}: a moment of {moment:g} kN·m acts on it, but no rod is rigidly joined to it, so the moment turns"
            " nothing. Join a rod rigidly or remove the moment.",
            particle=begun(world.describe(particles[row])),
            moment=moment[row],
        )
    return ""


def extensible_elsewhere(world: World) -> str:
    """The sentence about inextensible rods where their EA counts all the same; "" if there are none."""
    rods = world.tables["rods"]
    for row in np.flatnonzero(rods.inextensible)[:1].tolist():
        return tr(
            "Only first-order theory takes {rod} for inextensible; here its EA counts.",
            rod=world.describe(rods[row]),
        )
    return ""


def bears_between(world: World) -> bool:
    """True if something acts between the ends of some rod that bends, or a moment between those of any."""
    return bool(world.tables["rods"].span_load.any())


def turned_between(world: World) -> bool:
    """True if a moment acts between the ends of some rod."""
    return bool(world.tables["span_loads"].moment.any())


def bearing(world: World) -> NDArray[np.bool_]:
    """Between the ends of which rods something acts, (rods,)."""
    rods, loads = world.tables["rods"], world.tables["span_loads"]
    found: NDArray[np.bool_] = np.asarray(rods.distributed_force.any(axis=1))
    parts = [loads.column(name) for name in ("force", "start_intensity", "end_intensity")]
    acting = np.column_stack([loads.moment, *parts]).any(axis=1)
    found[loads.rod[acting]] = True
    return found


def nodes(world: World) -> NDArray[np.bool_]:
    """Which particles rods join, shape (particles,)."""
    return flags(world.tables["rods"].between, world.tables["particles"].count)


def has_cables(world: World) -> bool:
    """True if some rod bears tension only."""
    return bool(world.tables["rods"].tension_only.any())


def euler_load(world: World) -> NDArray[np.float64]:
    """π² EI/L₀² of rods with EI that are hinged at both ends, infinite of others, (rods,)."""
    rods = world.tables["rods"]
    pinned = (rods.bending_stiffness > 0.0) & ~rods.fixity.any(axis=1) & ~rods.tension_only
    return np.where(pinned, math.pi**2 * rods.bending_stiffness / rods.rest_length**2, np.inf)


def has_struts(world: World) -> bool:
    """True if some rod buckles as a strut."""
    rods = world.tables["rods"]
    return bool(rods.buckles.any() and (rods.buckling_load < np.inf).any())


def strut_energy(world: World) -> NDArray[np.float64]:
    """What struts that have buckled store besides N² L₀/2EA (kN·m), by their axial forces, (rods,)."""
    rods = world.tables["rods"]
    load, force = rods.buckling_load, rods.axial_force
    buckled = force < -load
    beyond = np.where(buckled, force**2 - load**2, 0.0)
    load = np.where(buckled, load, 1.0)
    return rods.rest_length * beyond * (1.0 / load - 0.5 / rods.stiffness)


def can_yield(world: World) -> bool:
    """True if plasticity is on and some rod has a strength."""
    return bool(world.tables["settings"].plasticity[0]) and has_strength(world)


def can_collapse(world: World) -> bool:
    """True if some force or moment in rods has a limit, so that limit analysis has an answer."""
    limited = world.tables["settings"].plasticity[0] and np.isfinite(plastic_moments(world)).any()
    return bool(limited) or can_yield(world) or has_struts(world)


def plastic_moments(world: World) -> NDArray[np.float64]:
    """Those that rods are given, or, where settings say so, their sections have, infinite of others, (rods,)."""
    rods = world.tables["rods"]
    found: NDArray[np.float64] = np.where(np.isnan(rods.plastic_moment), np.inf, rods.plastic_moment)
    if world.tables["settings"].plastic_hinges[0]:
        names = list(zip(rods.section.tolist(), rods.material.tolist(), strict=True))
        known = {pair: plastic_moment(*pair) for pair in set(names)}
        of_sections = np.array([known[pair] for pair in names])
        found = np.where(np.isinf(found) & (rods.bending_stiffness > 0.0), of_sections, found)
    return found


def can_hinge(world: World) -> bool:
    """True if plasticity is on and some end of a rod has a plastic moment."""
    return bool(world.tables["settings"].plasticity[0]) and has_plastic_moments(world)


def has_plastic_moments(world: World) -> bool:
    """True if some end of a rod has a plastic moment, whether plasticity is on or not."""
    return bool(np.isfinite(world.tables["rods"].moment_limit).any())


def is_kinked(world: World) -> bool:
    """True if some end of a rod has turned in a plastic hinge, or can."""
    return can_hinge(world) or bool(world.tables["rods"].plastic_rotation.any())


def has_strength(world: World) -> bool:
    """True if some rod has a strength, whether plasticity is on or not."""
    rods = world.tables["rods"]
    return bool(((rods.tension_limit < np.inf) | (rods.compression_limit < np.inf)).any())


def bends_unchecked(world: World) -> NDArray[np.bool_]:
    """Of which rods utilisation leaves out the bending, for want of a section that knows its depth, (rods,)."""
    rods = world.tables["rods"]
    return (rods.turning_shares > 0.0).any(axis=1) & np.isnan(rods.section_modulus)


def thrust(world: World) -> NDArray[np.float64]:
    """Axial force over the strength, where it is largest, of each rod, (rods,); 0 of those without a strength."""
    rods = world.tables["rods"]
    pulled = rods.end_axial_force / rods.tension_limit[:, None]
    pressed = -rods.end_axial_force / rods.compression_limit[:, None]
    found: NDArray[np.float64] = np.maximum(pulled, pressed).max(axis=1, initial=0.0)
    return found


def beside_thrust(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """The share of a plastic moment that remains beside a share n of the axial strength, 1.18 (1 − n) ≤ 1.

    Of I-sections bent in the plane of their webs [B. G. Neal, 1977].
    """
    return np.clip(1.18 * (1.0 - share), 0.0, 1.0)


def reduced_plastic_moment(world: World) -> NDArray[np.float64]:
    """M_p beside axial forces, (rods,), for checking; NaN without a plastic moment. Hinges do not heed it."""
    limit = world.tables["rods"].moment_limit.min(axis=1)
    return beside_thrust(thrust(world)) * np.where(np.isfinite(limit), limit, np.nan)


def utilisation(world: World) -> NDArray[np.float64]:
    """The largest stress of each rod, |N|/A + |M|/W, over the yield stress, (rods,); NaN where it has no strength. Of struts
    at least −N over the buckling load.

    Yield stresses are strengths over A, each in its direction. At both ends and where M is largest; of N alone where the
    depth is unknown.
    """
    rods = world.tables["rods"]
    force, bent = rods.axial_force[:, None], np.zeros((rods.count, 1))
    modulus = rods.section_modulus
    if (known := ~np.isnan(modulus) & ~np.isnan(rods.area)).any():
        moment, place = rods.largest_moment.T
        ends = rods.end_axial_force
        share = np.divide(place, rods.length, out=np.zeros(rods.count), where=rods.length > 0.0)
        force = np.column_stack([ends, ends[:, 0] + share * (ends[:, 1] - ends[:, 0])])
        lever = np.divide(rods.area, modulus, out=np.zeros(rods.count), where=known)
        bent = lever[:, None] * np.abs(np.column_stack([rods.bending_moment, moment]))
    pulled = (bent + force).max(axis=1) / rods.tension_limit
    pressed = (bent - force).max(axis=1) / rods.compression_limit
    pressed = np.maximum(pressed, -rods.axial_force / rods.buckling_load)
    either = (
        np.isfinite(rods.tension_limit) | np.isfinite(rods.compression_limit) | np.isfinite(rods.buckling_load)
    )
    return np.where(either, np.maximum(np.maximum(pulled, pressed), 0.0), np.nan)
