"""Somebody who edits in statics: `python -m tests.properties.fuzz statics --count 50 --seed 1 --actions 200`.

After edits, undo and redo all columns that are shown are, to the bit, those of the document solved in a fresh model. A
dense program of the textbook, which shares nothing with ours, decides whether the structure is stable, and gives the numbers
of what is elastic in first order; in exact theory all forces balance as derivatives of the energy.
"""

import random
import traceback
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from pinjoint import Session
from pinjoint.components.cases import PERMANENT, cases
from pinjoint.components.field import FieldError
from pinjoint.components.load import DIRECTIONS, Load, SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bends, idle_moment, nodes
from pinjoint.systems.edit import Refusal
from tests.reference import frame_theory, frames
from tests.reference.sessions import solved_afresh

BASES = (
    *("portal", "gerber_beam", "two_storey_frame", "vierendeel", "three_hinged_arch", "braced_portal"),
    *("three_bar_plastic", "hyperstatic", "isostatic"),
)
COLLAPSES = "portal", "fixed_beam_collapse", "portal_collapse"
MENDING = 0.4  # of the edits after one that leaves a mechanism; the others go on from there
MENDS = "undo", "undo", "support", "clamp", "rod"
STEPS = ([1.0], [1.0], [1.0, 0.5], [0.5, 1.0], [1.0, 0.0])
CASES = PERMANENT, "wind", "snow"
WITHIN, ROUNDING = 1e-10, 1e-13  # of the largest number; over the lowest eigenvalue, more
SINGULAR, STABLE = 1e-9, 1e-6  # of the largest stiffness, of which the reference leaves round-off; eigenvalues
MOST_RODS, EXPLORING = 60, 5

Lot = random.Random
Edit = Callable[[Session, Lot, Any, Any], Any]  # of a particle, or of a rod
Course = tuple[Mapping[str, Edit], Sequence[str]]  # edits, and models that they begin from


def _moved(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    x, y = at.position
    at.position = x + lot.uniform(-0.2, 0.2), y + lot.uniform(-0.2, 0.2)


def _settled(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    at.displacement = tuple(lot.uniform(-0.01, 0.01) if held else 0.0 for held in at.fixed)


def _new_particle(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    [made] = session.model.create(Particle, position=[(lot.uniform(0.0, 6.0), lot.uniform(0.0, 6.0))])
    for row in lot.sample(range(made.row), min(2, made.row)):
        session.model.create(Rod, between=[(made.row, row)])


def _new_rod(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    ends = tuple(lot.sample(range(session.particles.count), 2))
    session.model.create(Rod, between=[ends], prescribed_bending_stiffness=[lot.choice([None, 5000.0])])


def _loaded_between(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    length = rod.original_length
    facts = {
        "start": lot.choice([0.0, lot.uniform(0.0, 0.5) * length]),
        "end": lot.choice([None, lot.uniform(0.5, 1.0) * length]),
        "force": (0.0, lot.choice([0.0, lot.uniform(-20.0, 20.0)])),
        "moment": lot.choice([0.0, lot.uniform(-9.0, 9.0)]),
        "start_intensity": (lot.uniform(-3.0, 3.0), lot.uniform(-9.0, 0.0)),
        "end_intensity": (0.0, lot.uniform(-9.0, 9.0)),
        "direction": lot.choice(DIRECTIONS),
        "temperature_change": lot.choice([0.0, lot.uniform(-20.0, 20.0)]),
        "case": lot.choice(CASES),
    }
    session.model.create(SpanLoad, rod=[rod.row], **{name: [value] for name, value in facts.items()})


def _of_a_case(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    facts: dict[str, Any] = {
        "force": (lot.uniform(-9.0, 9.0), 0.0),
        "settlement": (0.0, lot.uniform(-0.01, 0.0)),
    }
    facts |= {"settled_rotation": lot.choice([0.0, 0.002]), "case": lot.choice(CASES)}
    session.model.create(Load, on=[at.row], **{name: [value] for name, value in facts.items()})


def _combined(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    """One combination of all cases, by lot, and another; one of these, or one case alone, or all cases act."""
    known, settings = cases(session.model), session.settings
    settings.combinations = {
        "U": {case: lot.uniform(-1.0, 2.0) for case in known},
        "V": {PERMANENT: 1.35, lot.choice(CASES): 1.5},
    }
    settings.combination = lot.choice(["", "U", "U", "V", *known])


def _sprung(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    at.support_springs = lot.choice([0.0, 500.0]), lot.choice([0.0, 800.0])
    at.rotation_spring = lot.choice([0.0, 300.0])


def _plastic(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    rod.plastic_moment = lot.choice([None, 20.0, 60.0]) if rod.bending_stiffness else None


def _strut(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    if not (rod.bending_stiffness or rod.buckles):
        rod.prescribed_bending_stiffness = lot.choice([20.0, 200.0])
    rod.hinged, rod.buckles = (True, True), lot.random() < 0.7


def _strong(session: Session, lot: Lot, at: Any, rod: Any) -> None:
    rod.tensile_strength = rod.compressive_strength = lot.choice([None, None, 200.0, 60.0])


EDITS: dict[str, Edit] = {
    "force": lambda s, lot, at, rod: setattr(at, "force", (lot.uniform(-50.0, 50.0), lot.uniform(-50.0, 50.0))),
    "moment": lambda s, lot, at, rod: setattr(at, "moment", lot.uniform(-10.0, 10.0)),
    "load": lambda s, lot, at, rod: s.model.create(Load, on=[at.row], force=[(lot.uniform(-20.0, 20.0), -5.0)]),
    "no loads": lambda s, lot, at, rod: s.model.delete(list(s.loads)),
    "moved": _moved,
    "settled": _settled,
    "support": lambda s, lot, at, rod: setattr(
        at, "fixed", lot.choice([(True, True), (False, True), (True, False)])
    ),
    "free": lambda s, lot, at, rod: setattr(at, "fixed", (False, False)) if lot.random() < 0.2 else None,
    "clamp": lambda s, lot, at, rod: setattr(at, "fixed_rotation", lot.random() < 0.5),
    "particle": _new_particle,
    "no particle": lambda s, lot, at, rod: s.model.delete([at]) if lot.random() < 0.2 else None,
    "rod": _new_rod,
    "no rod": lambda s, lot, at, rod: s.model.delete([rod]) if lot.random() < 0.3 else None,
    "stiffness": lambda s, lot, at, rod: setattr(rod, "stiffness", rod.stiffness * lot.uniform(0.5, 2.0)),
    "hinge": lambda s, lot, at, rod: setattr(rod, "hinged", (lot.random() < 0.3, lot.random() < 0.3)),
    "along": lambda s, lot, at, rod: setattr(rod, "distributed_force", (0.0, lot.uniform(-20.0, 5.0))),
    "warmth": lambda s, lot, at, rod: setattr(rod, "temperature_change", lot.uniform(-20.0, 40.0)),
    "gradient": lambda s, lot, at, rod: setattr(rod, "temperature_gradient", lot.uniform(-50.0, 50.0)),
    "misfit": lambda s, lot, at, rod: setattr(
        rod, "rest_length", rod.original_length * lot.uniform(0.999, 1.001)
    ),
    "strength": _strong,
    "cable": lambda s, lot, at, rod: setattr(rod, "tension_only", lot.random() < 0.3),
    "divide": lambda s, lot, at, rod: s.divide(rod, 2),
    "theory": lambda s, lot, at, rod: s.press("z"),
    "steps": lambda s, lot, at, rod: setattr(s.settings, "load_steps", lot.choice(STEPS)),
    "undo": lambda s, lot, at, rod: s.press("ctrl+z"),
    "undo again": lambda s, lot, at, rod: s.press("ctrl+z"),
    "redo": lambda s, lot, at, rod: s.press("ctrl+y"),
    "panels": lambda s, lot, at, rod: s.press(lot.choice("iiaxm")),
    "frame": lambda s, lot, at, rod: s.frame(1.0 / 60.0),
}
LOADED: dict[str, Edit] = {
    "between": _loaded_between,
    "no loads between": lambda s, lot, at, rod: s.model.delete(list(s.span_loads)[:2]),
    "case": _of_a_case,
    "combination": _combined,
    "springs": _sprung,
    "end springs": lambda s, lot, at, rod: setattr(
        rod, "end_springs", (lot.choice([0.0, 1e3]), lot.choice([0.0, 2e3]))
    ),
    "inclined": lambda s, lot, at, rod: setattr(at, "support_angle", lot.choice([0.0, 0.5, -0.8])),
}
BEYOND_ELASTIC: dict[str, Edit] = EDITS | {"plastic": _plastic, "strut": _strut, "weak": _plastic}
ELASTIC: Course = (EDITS | LOADED, BASES)
COLLAPSING: Course = (BEYOND_ELASTIC | LOADED, COLLAPSES)


def attempt(
    seed: int,
    actions: int,
    seen: Counter[str],
    mending: float = MENDING,
    edits: Mapping[str, Edit] = EDITS,
    bases: Sequence[str] = BASES,
    every: int = 1,
) -> None:
    """Edits by lot in a bundled model, each checked; `seen` counts what the states are.

    mending: how often an edit that leaves no stable structure is followed by one that may give one back. every: how many
    edits apart what is shown is solved in a fresh model, too, which takes longer than all else.
    """
    lot, stable = random.Random(seed), True
    session = Session.open(lot.choice(bases))
    session.press("q")
    for number in range(actions):
        name, model = lot.choice(list(edits)), session.model
        if not stable and mending and lot.random() < mending:
            name = lot.choice(MENDS)
        poor = not (model.particles.count > 2 and model.rods.count)
        name = "undo" if poor or model.rods.count > MOST_RODS else name
        some = (lot.choice(list(table)) if table.count else None for table in (model.particles, model.rods))
        try:
            edits[name](session, lot, *some)
        except (FieldError, Refusal):
            seen["refused"] += 1
            continue
        assert session.scene == "statics"
        try:
            stable = check(session, seen, afresh=number % every == 0)
        except AssertionError as error:
            raise AssertionError(f"edit {number}, {name}: {error}") from error
        seen["states"] += 1
        seen["stable"] += stable


def check(session: Session, seen: Counter[str], *, afresh: bool = True) -> bool:
    """What is shown is the solution of what is there; returns whether that is stable, as the textbook says."""
    model, shown = session.model, session.document.statics
    wanted = shown.settlement
    if afresh:
        wanted = None
        with suppress(ValueError):
            wanted = solved_afresh(model)
        assert (shown.settlement is None) == (wanted is None), shown.problem
    if wanted is None or shown.settlement is None:
        assert not _is_usual(model), shown.problem
        seen["no numbers"] += 1
        return False
    assert shown.settlement.status == wanted.status
    for name, column in wanted.final.columns.items():
        assert np.array_equal(model.column(name), column, equal_nan=True), name
    lowest, balanced = _lowest(model, shown.share), shown.balanced
    stable = lowest > STABLE
    seen[f"{'first order' if shown.first_order else 'exact'}, {wanted.status}"] += 1
    if not balanced:
        gives_way = _is_inelastic(model) or not shown.first_order
        assert gives_way or not stable, f"there is an equilibrium, not '{wanted.status}'"
        return stable
    if not shown.first_order:
        _balances(model, shown.share)
    elif _is_inelastic(model) and not (stable and wanted.status == "equilibrium" and _stays_elastic(model)):
        seen["inelastic"] += 1
    elif stable:
        _agrees(model, shown.share, WITHIN + ROUNDING / lowest)
        seen["compared"] += 1
    else:
        seen["barely stable"] += 1
    return stable


def _is_inelastic(model: Model) -> bool:
    rods = model.rods
    yields = np.isfinite(rods.tensile_strength) | np.isfinite(rods.compressive_strength)
    struts = np.isfinite(rods.buckling_load)
    return bool((rods.tension_only | yields | struts).any() or np.isfinite(rods.moment_limit).any())


def _stays_elastic(model: Model) -> bool:
    """The elastic structure of the textbook lets no rod yield or buckle and no cable slacken, at any load step."""
    rods, limits = model.rods, np.stack([model.rods.compressive_strength, model.rods.buckling_load])
    for factor in (0.0, *model.settings.load_steps):
        found = frame_theory.solve(_plain(model, factor))
        force, moment = (
            np.array([by_rod[str(row)] for row in range(rods.count)])
            for by_rod in (found.end_axial_force, found.bending_moment)
        )
        if (np.abs(moment) > rods.moment_limit).any() or rods.plastic_rotation.any():
            return False
        bounds = np.where(rods.tension_only, 0.0, -np.fmin(*limits)), rods.tensile_strength
        if (force < bounds[0][:, None] - ROUNDING).any() or (force > bounds[1][:, None]).any():
            return False
    return True


def _is_usual(model: Model) -> bool:
    """There is a rod, nothing lies at one place, and no load reaches beyond its rod."""
    length, loads = model.rods.original_length, model.span_loads
    reaches = np.maximum(loads.start, np.nan_to_num(loads.end)) <= length[loads.rod.astype(int)] * (1.0 + 1e-9)
    return bool(model.rods.count and (length > 1e-6).all() and reaches.all())


# --- what the textbook says ---------------------------------------------------------------------------


def _plain(model: Model, factor: float) -> dict[str, Any]:
    """What the textbook needs: joints, their loads and supports, and rods, by numbers, each by the factor of its case; loads
    by the load factor too, but ramps with their full value."""
    rods, particles, used, settings = model.rods, model.particles, nodes(model), model.settings
    chosen = settings.combination
    by = settings.combinations.get(chosen, {chosen: 1.0}) if chosen else dict.fromkeys(cases(model), 1.0)
    own = by.get(PERMANENT, 0.0)
    with model.own_state():
        settled = own * np.column_stack([particles.displacement, particles.rotation])
    force, moment = own * (particles.force + np.array(model.environment.force)), own * particles.moment
    for one in model.loads:
        assert one.history["kind"] in ("constant", "ramp")
        share, row = by.get(one.case, 0.0), one.particle.row
        force[row] += share * np.array(one.force)
        moment[row] += share * one.moment
        settled[row] += share * np.array([*one.settlement, one.settled_rotation])
    weight = particles.mass[:, None] * (particles.acceleration + np.array(model.environment.acceleration))
    force = factor * force + own * weight / 1000.0
    joints = [
        {
            "name": str(row),
            "position": particles.position[row],
            "force": force[row],
            "moment": factor * moment[row],
            "fixed": particles.fixed[row].tolist(),
            "fixed_rotation": bool(particles.fixed_rotation[row]),
            "support_springs": particles.support_springs[row],
            "rotation_spring": float(particles.rotation_spring[row]),
            "support_angle": float(particles.support_angle[row]),
            "displacement": settled[row, :2],
            "rotation": settled[row, 2],
        }
        for row in np.flatnonzero(used).tolist()
    ]
    members: list[dict[str, Any]] = [
        {name: float(getattr(rod, name)) for name in ("stiffness", "bending_stiffness", "rest_length")}
        | {"thermal_expansion": rod.thermal_expansion, "name": str(rod.row)}
        | {"between": [str(end) for end in rods.between[rod.row].tolist()]}
        | {"hinged": list(rod.hinged), "end_springs": list(rods.end_springs[rod.row])}
        | {"inextensible": bool(rod.inextensible), "temperature_change": own * rod.temperature_change}
        | {"temperature_gradient": own * rod.temperature_gradient, "span_loads": []}
        | {"distributed_force": factor * own * np.array(rod.distributed_force)}
        | {"lack_of_fit": own * (rod.rest_length - rod.original_length)}
        for rod in rods
    ]
    for load in model.span_loads:
        share, member = by.get(load.case, 0.0), members[load.rod]
        for name in ("temperature_change", "temperature_gradient"):
            member[name] += share * getattr(load, name)
        facts = {
            name: factor * share * np.array(getattr(load, name))
            for name in ("force", "moment", "start_intensity", "end_intensity")
        }
        ends = {"start": load.start, "end": rods.original_length[load.rod] if load.end is None else load.end}
        member["span_loads"].append(facts | ends | {"direction": load.direction})
    return {"particles": joints, "rods": members}


def _lowest(model: Model, factor: float) -> float:
    """The lowest stiffness of the free coordinates as a share of the highest, scaled to diagonals of 1."""
    if not model.rods.count:
        return 0.0
    plain = _plain(model, factor)
    matrix, _, held, still, _ = frame_theory.assembled(plain)
    free = ~held & ~still
    matrix = matrix[np.ix_(free, free)]
    scale = np.sqrt(np.maximum(np.diag(matrix), SINGULAR * np.abs(matrix).max(initial=1e-300)))
    return float(np.linalg.eigvalsh(matrix / np.outer(scale, scale)).min(initial=1.0))


def _in_axes(model: Model, rows: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 2) on particles along the axes of their supports."""
    cosine, sine = np.cos(model.particles.support_angle[rows]), np.sin(model.particles.support_angle[rows])
    x, y = vectors.T
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x])


def _agrees(model: Model, factor: float, within: float) -> None:
    found, used = frame_theory.solve(_plain(model, factor)), np.flatnonzero(nodes(model))
    for table, rows, names in (
        (model.particles, used, ("displacement", "reaction", "reaction_moment")),
        (model.rods, range(model.rods.count), ("end_axial_force", "shear", "bending_moment")),
    ):
        for name in names:
            wanted = np.array([getattr(found, name)[str(row)] for row in rows])
            got = getattr(table, name)[list(rows)]
            if name == "reaction":
                wanted, got = (_in_axes(model, used, one) for one in (wanted, got))
            if name.startswith("reaction"):
                held = model.particles.fixed if name == "reaction" else model.particles.fixed_rotation
                if name == "reaction_moment" and not bends(model):  # trusses leave moments out, and say so
                    assert idle_moment(model) or not wanted.any(), name
                    continue
                wanted, got = np.where(held[used], wanted, 0.0), np.where(held[used], got, 0.0)
            size = max(np.abs(wanted).max(initial=0.0), 1e-3 if name == "displacement" else 1.0)
            assert np.abs(got - wanted).max(initial=0.0) <= within * size, name


def _balances(model: Model, factor: float) -> None:
    """All forces on free joints of the shape that is shown are 0: derivatives of energy, less the part of loads left out."""
    rods = model.rods
    unknown = (  # to that energy
        *(rods.plastic_rotation.any(), (rods.lateral_deflection > 0.0).any(), model.span_loads.count),
        model.settings.combination,
    )
    if factor != 1.0 or rods.count > 20 or any(unknown):
        return
    force, moment = frames.forces(model)  # under constant loads
    for one in model.loads:
        if one.history["kind"] == "ramp":
            force[one.particle.row] += one.force
            moment[one.particle.row] += one.moment
    used, largest = nodes(model), max(np.abs(model.rods.axial_force).max(), 1.0)
    free = used[:, None] & ~model.particles.fixed
    force = _in_axes(model, np.arange(len(used)), force)
    assert np.abs(force[free]).max(initial=0.0) <= 1e-6 * largest, "forces"
    turns = used & (model.particles.turning > 0.0)
    assert np.abs(moment[turns]).max(initial=0.0) <= 1e-6 * largest, "moments"


def explore(first: int, count: int, actions: int = 200) -> int:
    """Sessions with so many edits each; returns how many went wrong."""
    wrong, seen = 0, Counter[str]()
    for seed in range(first, first + count):
        try:
            attempt(seed, actions, seen, MENDING, *(ELASTIC, COLLAPSING)[seed % 2], every=EXPLORING)
        except Exception:
            wrong += 1
            print(f"statics, seed {seed}:\n{traceback.format_exc()}", flush=True)
    print(f"statics, seeds {first} to {first + count - 1}: {dict(seen)}", flush=True)
    print(f"{seen['stable'] / max(seen['states'], 1):.1%} of {seen['states']} states are stable", flush=True)
    return wrong
