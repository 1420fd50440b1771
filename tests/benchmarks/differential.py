"""The program against the slow references of tests/reference, on models drawn by lot with every feature.

Each number is one model. In motion, the default run to a time is compared with scipy's from event to event, and so is
the error that the program says it has made; equilibria and load–displacement curves are compared with an independent
Newton method in small increments, and their balance with sums written out here.
"""

import json
import math
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from pinjoint import Session
from pinjoint.documents import models
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.relax import LARGEST_PLASTIC_STRAIN
from pinjoint.systems.statics.settle import Settlement, settle
from pinjoint.systems.statics.state import StaticState
from tests.reference import statics, transients
from tests.reference.elements import Document
from tests.reference.random_models import KINDS, Case, case
from tests.reference.transients import Motion, Untraceable, follow

Row = dict[str, Any]
MODELS, FEW = 100 * len(KINDS), 2 * len(KINDS)
OF_STATE = ("displacement", "velocity", "axial_force")
PROMISED = {"displacement": 1e-6, "velocity": 1e-5, "axial_force": 1e-5, "energy": 1e-5, "imbalance": 1e-6}
PROMISED["balance"] = 1e-8  # where a run says that it is at rest
IN_EQUILIBRIUM = {"displacement": 1e-8, "axial_force": 1e-8, "balance": 1e-8, "curve": 1e-8}
WITHIN = 2.0  # times the estimate, the largest true error
FLOOR = 1e-11  # of the largest value: smaller errors are the reference's as well
SURE = 0.1  # of what is promised: a larger error of the reference decides nothing
COARSER = 1e-11  # a tolerance at which the reference shows how sure it is
PATIENCE = 60.0  # s of simulated time in which a model is expected to rest
CHAOTIC = 1e4  # times that errors grow; where they do, an estimate is to hold, and nothing is promised
NUDGE = 1e-9  # of the largest displacement, by which a model is begun otherwise to see what becomes of it
JUMPS = {"snap-through", "bifurcation", "mechanism"}
SOFT = 1e-9  # of the largest stiffness: what is softer may as well be stable
INCREMENTS = (100, 1600)  # per load factor, where rods yield; the second where the first decides nothing


@dataclass
class Finding:
    """How one model compared. errors: relative to the largest value; estimates: by quantity, (said, true)."""

    case: Case
    status: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    estimates: dict[str, tuple[float, float]] = field(default_factory=dict)
    wrong: list[str] = field(default_factory=list)
    ends_early: bool = False  # a curve, where there may be none to follow: a structure that gives way and jumps
    unsure: str = ""  # why nothing can be said
    seconds: float = 0.0


def report(*, quick: bool, seed: int | None = None) -> dict[str, list[Row]]:
    """Tables of errors by kind of model, and of all that disagree; or of one model alone, that of `seed`."""
    if seed is not None:
        return one(seed)
    return tables([examine(case(number)) for number in range(FEW if quick else MODELS)])


def examine(given: Case) -> Finding:
    """Compare one model."""
    found = Finding(given)
    started = time.perf_counter()
    try:
        compare = _rest if given.kind.rests else _motion if given.kind.moves else _equilibria
        compare(found)
    except Untraceable as problem:
        found.unsure = str(problem)
    except Exception as fault:  # whatever the program raises is a finding, too
        found.wrong.append(f"{type(fault).__name__}: {fault}")
    found.seconds = time.perf_counter() - started
    return found


# --- motion ----------------------------------------------------------------------------------------------


def _motion(found: Finding) -> None:
    given = found.case
    expected = follow(given.document, given.duration)
    session = Session.open(given.document)
    found.status = session.run(time=given.duration)
    if found.status not in ("time reached", "at rest"):
        found.wrong.append(f"{found.status}: {session.message}")
        return
    found.errors = errors(session, expected)
    if said := session.document.assessment.error(math.inf):
        for name, value in asdict(said).items():
            if name in OF_STATE:
                scale = expected.largest[name] or 1.0
                found.estimates[name] = (float(value) / scale, found.errors[name])
    _judge(found, PROMISED)
    for name, (estimate, true) in found.estimates.items():
        if true > max(WITHIN * estimate, FLOOR):
            found.wrong.append(f"{name} off by {true:.1e}, estimated {estimate:.1e}")
    if found.wrong:
        _consider_the_reference(found, expected)


def errors(session: Session, expected: Motion) -> dict[str, float]:
    """Of each quantity at the end of a run, the largest difference over the largest value in the whole run."""
    energy, model = session.energy.as_dict(), session.model
    differences = {
        "displacement": np.hypot(*(model.particles.displacement - expected.displacement).T).max(initial=0.0),
        "velocity": np.hypot(*(model.particles.velocity - expected.velocity).T).max(initial=0.0),
        "axial_force": np.abs(model.rods.axial_force - expected.axial_force).max(initial=0.0),
        "energy": max(abs(energy[name] - value) for name, value in expected.energy.items()),
        "imbalance": abs(energy["imbalance"]),
    }
    largest = expected.largest | {"imbalance": expected.largest["energy"]}
    return {name: float(value) / (largest[name] or 1.0) for name, value in differences.items()}


def _judge(found: Finding, promised: Mapping[str, float]) -> None:
    for name, error in found.errors.items():
        if not error <= promised[name]:
            found.wrong.append(f"{name} off by {error:.1e}")


def _consider_the_reference(found: Finding, expected: Motion) -> None:
    """Where the reference itself changes with its tolerance nothing can be said; else say how errors grow."""
    given = found.case
    again = follow(given.document, given.duration, COARSER)
    own = _difference(expected, again) / 10.0
    if own > SURE * PROMISED["displacement"]:
        found.unsure = f"the reference itself differs by {own:.1e} ({'; '.join(found.wrong)})"
        found.wrong = []
        return
    nudged = json.loads(json.dumps(given.document))
    for number, particle in enumerate(nudged["particles"]):
        if not any(particle.get("fixed", ())):
            size = NUDGE * expected.largest["displacement"] * (-1) ** number
            x, y = particle.get("displacement", (0.0, 0.0))
            particle["displacement"] = [x + size, y - size]
    growth = _difference(expected, follow(nudged, given.duration)) / NUDGE
    if growth > CHAOTIC:
        found.wrong = [each for each in found.wrong if "estimated" in each]
    if found.wrong:
        found.wrong.append(f"errors grow {growth:.0f} times")
    else:
        found.unsure = f"chaotic: errors grow {growth:.0f} times"


def _difference(one: Motion, other: Motion) -> float:
    moved = np.hypot(*(one.displacement - other.displacement).T).max(initial=0.0)
    return float(moved) / (one.largest["displacement"] or 1.0)


def _rest(found: Finding) -> None:
    """What is said to be at rest is in balance, and its account closes."""
    document = {key: value for key, value in found.case.document.items() if key != "settings"}
    session = Session.open(found.case.document)
    found.status = session.run(until="rest", limit=PATIENCE)
    model, energy = session.model, session.energy.as_dict()
    if found.status != "at rest":
        found.unsure = f"{found.status}: {session.message}"
        return
    rods, moved = model.rods, model.particles.displacement
    found.errors = {
        "balance": _out_of_balance(document, (1.0,), moved, rods.plastic_strain, rods.axial_force),
        "imbalance": abs(energy["imbalance"]) / max(map(abs, energy.values())),
    }
    _judge(found, PROMISED)


# --- equilibria ------------------------------------------------------------------------------------------


def _equilibria(found: Finding) -> None:
    given = found.case
    settlement = settle(models.load(given.document), given.kind.factors)
    found.status = settlement.status
    states = [state for state in settlement.states if state.status.endswith("equilibrium")]
    factors = given.kind.factors
    balances = [
        _out_of_balance(given.document, factors[: k + 1], s.displacement, s.plastic_strain, s.axial_force)
        for k, s in enumerate(states)
    ]
    found.errors["balance"] = max(balances, default=0.0)
    jumps = _jumps(settlement)
    expected, reason = _followed(given, INCREMENTS[0])
    if len(expected) > len(states) and not _yields_too_far(given.document, expected[len(states)]):
        found.wrong.append(f"{settlement.status}, but there is an equilibrium. {settlement.message}")
    if sum(state.status == "equilibrium" for state in states) > len(expected) and not jumps:
        if not expected and "load factor 0." in reason:
            found.unsure = "the reference finds no way from the state as it was drawn"
            return
        found.wrong.append(f"equilibrium without an event, but {reason}")
    if jumps and not given.kind.yields:
        _look_for_a_way(found, len(states))
    if not jumps:
        _compare_states(found, states, expected)
        if given.kind.yields and any(found.errors[name] > IN_EQUILIBRIUM[name] for name in found.errors):
            expected, reason = _followed(given, INCREMENTS[1])  # what unloads, unloads within an increment
            before = found.errors["axial_force"]
            _compare_states(found, states, expected)
            if found.errors["axial_force"] < before / 4.0:
                found.unsure = f"the reference approaches, {before:.1e} to {found.errors['axial_force']:.1e}"
                return
    if states and not given.kind.yields:
        _in_a_valley(found, states[-1], compares=not expected)
    if len(given.kind.factors) == 1 and settlement.status == "equilibrium":
        _curve(found)
    _judge(found, IN_EQUILIBRIUM)


def _jumps(settlement: Settlement) -> bool:
    """True if the path of equilibria ended on the way, and settling went on elsewhere."""
    return not JUMPS.isdisjoint(event.kind for event in settlement.events)


def _look_for_a_way(found: Finding, states: int) -> None:
    """Where settling jumps, stability is lost: small increments through stable equilibria do not come as far."""
    followed, _ = _followed(found.case, INCREMENTS[0], always=True)
    if len(followed) >= states:
        found.wrong.append("settling jumps, but stable equilibria lead all the way")


def _in_a_valley(found: Finding, state: StaticState, *, compares: bool) -> None:
    """An elastic equilibrium that lasts is where energy is least, as far as anything resists."""
    document = found.case.document
    least = statics.stability(document, state.displacement)
    if (least < -SOFT and state.status == "equilibrium") or (least > SOFT and "unstable" in state.status):
        found.wrong.append(f"{state.status}, where the least stiffness is {least:.1e} of the largest")
    if compares:
        try:
            lowest = statics.least_energy(document)
        except statics.NoEquilibrium:
            return
        errors = dict(found.errors)
        _compare_states(found, [state], [lowest])
        if found.errors["axial_force"] > IN_EQUILIBRIUM["axial_force"]:
            found.errors, found.unsure = errors, "another place of least energy was found"


def _yields_too_far(document: Document, state: Document) -> bool:
    """True if a state of the independent method is beyond the strains of which there is a result."""
    before = {rod["name"]: rod.get("plastic_strain", 0.0) for rod in document["rods"]}
    gained = (abs(strain - before[name]) for name, strain in state["plastic_strain"].items())
    return max(gained, default=0.0) > LARGEST_PLASTIC_STRAIN


def _followed(given: Case, increments: int, *, always: bool = False) -> tuple[list[Document], str]:
    """The states of the independent method, as far as it comes, and why it comes no farther.

    increments: per load factor, at least; where nothing yields, only if `always`.
    """
    largest = 1.0 / increments if given.kind.yields or always else 1.0
    states: list[Document] = []
    try:
        for state in statics.path(given.document, given.kind.factors, largest_increment=largest):
            states.append(state)
    except statics.NoEquilibrium as end:
        return states, str(end)
    return states, ""


def _compare_states(found: Finding, states: list[StaticState], expected: list[Document]) -> None:
    """The largest differences between states, relative to the largest values."""
    for name in ("displacement", "axial_force"):
        pairs = [
            (
                np.array(getattr(ours, name)),
                np.array(list(theirs[name].values())).reshape(getattr(ours, name).shape),
            )
            for ours, theirs in zip(states, expected, strict=False)
        ]
        largest = max((np.abs(value).max(initial=0.0) for _, value in pairs), default=0.0) or 1.0
        found.errors[name] = max(
            (float(np.abs(a - b).max(initial=0.0)) / largest for a, b in pairs), default=0.0
        )


def _out_of_balance(
    document: Document, factors: Sequence[float], moved: Any, plastic_strain: Any, given_force: Any
) -> float:
    """The largest force out of balance at the last of the factors over the largest so far, from displacements and
    plastic strains alone; a force beyond a strength or other than given counts, too."""
    path = statics.Path(document)
    elements = path.elements
    balance = (factors[-1] * path.patterns[0] + path.patterns[1]).reshape(-1, 2)
    forces, off = [], 0.0
    for k, rod in enumerate(elements.rods):
        ends = np.concatenate([moved[rod.start], moved[rod.end]])
        elongation, along, _ = path.kinematics(rod.span, rod.free_length, ends)
        n = rod.stiffness * (elongation / rod.rest_length - plastic_strain[k])
        n = max(n, 0.0) if rod.tension_only else n
        balance[rod.start] += n * along
        balance[rod.end] -= n * along
        forces.append(n)
        below = 0.0 if rod.tension_only else rod.compressive_strength
        off = max(off, n - rod.tensile_strength, -n - below, abs(n - given_force[k]))
    applied = np.abs(path.patterns[:2]).max(initial=0.0) * max(map(abs, factors))
    largest = max(np.abs(forces).max(initial=0.0), applied)
    free = path.free.reshape(-1, 2)
    return float(max(off, np.abs(balance[free]).max(initial=0.0))) / (largest or 1.0)


def _curve(found: Finding) -> None:
    """A curve to the load factor 1 is complete where nothing jumps on the way, and ends where settled; an elastic one
    is in balance at each point."""
    document = found.case.document
    if not (statics.Path(document).patterns[0] != 0.0).any():
        return  # nothing to scale
    model = models.load(document)
    settled = settle(model, (0.0, 1.0))  # as along the curve, where accelerations act before the load
    jumps = _jumps(settled)
    if settled.states[0].status != "equilibrium":
        return
    curve = Curve.of(model, Goal(1.0))
    if not curve.complete:
        found.ends_early = True
        if settled.status == "equilibrium" and not jumps:
            found.wrong.append(
                f"the curve ends at {curve.load_factor[-1]:.6g}, {len(curve.load_factor)} points"
            )
        return
    final = settled.final
    if settled.status == "equilibrium" and not jumps:
        largest = np.abs(final.axial_force).max(initial=0.0) or 1.0
        found.errors["curve"] = (
            float(np.abs(curve.axial_force[-1] - final.axial_force).max(initial=0.0)) / largest
        )
    if not found.case.kind.yields:
        points = list(zip(curve.load_factor.tolist(), curve.displacement, curve.axial_force, strict=True))
        plastic = final.plastic_strain
        off = [_out_of_balance(document, (1.0, t), moved, plastic, forces) for t, moved, forces in points[::5]]
        found.errors["balance"] = max(found.errors["balance"], *off)


# --- tables ----------------------------------------------------------------------------------------------


def tables(findings: list[Finding]) -> dict[str, list[Row]]:
    """Errors by kind of model, quality of the estimates, and what disagrees, with the numbers that give it again."""
    made = {
        "motion": list(_error_rows(findings, moves=True)),
        "estimates": list(_estimate_rows(findings)),
        "equilibrium": list(_error_rows(findings, moves=False)),
        "disagreements": [_row(f, "; ".join(f.wrong)) for f in findings if f.wrong],
        "undecided": [_row(f, f.unsure) for f in findings if f.unsure],
    }
    return {title: rows for title, rows in made.items() if rows}


def _row(found: Finding, what: str) -> Row:
    return {"seed": found.case.number, "kind": found.case.kind.title, "what": what}


def _by_kind(findings: Iterable[Finding]) -> dict[str, list[Finding]]:
    made: dict[str, list[Finding]] = {kind.title: [] for kind in KINDS}
    for each in findings:
        made[each.case.kind.title].append(each)
    return {title: group for title, group in made.items() if group}


def _error_rows(findings: list[Finding], *, moves: bool) -> Iterator[Row]:
    """The 99th percentile and the worst of each error; models that could not be decided are counted apart."""
    names = PROMISED if moves else IN_EQUILIBRIUM
    for title, group in _by_kind(f for f in findings if f.case.kind.moves is moves).items():
        row: Row = {"kind": title, "models": len(group), "undecided": sum(bool(f.unsure) for f in group)}
        row["disagree"] = sum(bool(f.wrong) for f in group)
        for name in names:
            values = [f.errors[name] for f in group if name in f.errors and not f.unsure]
            row[f"{name} 99 %"] = float(np.quantile(values, 0.99)) if values else math.nan
            row[f"{name} worst"] = max(values, default=math.nan)
        if not moves:
            row["curves that end where it jumps"] = sum(f.ends_early and not f.wrong for f in group)
        yield row | {"seconds": sum(f.seconds for f in group)}


def _estimate_rows(findings: list[Finding]) -> Iterator[Row]:
    """By kind and quantity: how many true errors the estimate bounds within a factor, and the worst ratio."""
    for title, group in _by_kind(f for f in findings if f.case.kind.moves and not f.unsure).items():
        for name in OF_STATE:
            pairs = [f.estimates[name] for f in group if name in f.estimates]
            ratios = [max(true, FLOOR) / max(said, FLOOR) for said, true in pairs]
            if ratios:
                yield {
                    "kind": title,
                    "quantity": name,
                    "estimates": len(pairs),
                    "beyond twice": sum(ratio > WITHIN for ratio in ratios),
                    "true/said median": float(np.median(ratios)),
                    "true/said worst": max(ratios),
                }


def one(number: int) -> dict[str, list[Row]]:
    """One model: what the program and the reference say, and how they compare."""
    given = case(number)
    found = examine(given)
    made = tables([found]) | {
        "model": [{"seed": number, "kind": given.kind.title, "duration_s": given.duration}]
    }
    made["document"] = [{"json": json.dumps(given.document)}]
    if given.kind.moves and not found.unsure:
        made |= _beside(given)
    return made


def _beside(given: Case) -> dict[str, list[Row]]:
    expected = transients.follow(given.document, given.duration)
    session = Session.open(given.document)
    session.run(time=given.duration)
    particles = [
        {
            "particle": name,
            "quantity": f"{what}.{axis}",
            "program": float(ours[k]),
            "reference": float(theirs[k]),
        }
        for what in ("displacement", "velocity")
        for name, ours, theirs in zip(
            session.particles.names, getattr(session.particles, what), getattr(expected, what), strict=True
        )
        for k, axis in enumerate("xy")
    ]
    rods = [
        {"rod": name, "program": float(ours), "reference": float(theirs)}
        for name, ours, theirs in zip(
            session.rods.names, session.rods.axial_force, expected.axial_force, strict=True
        )
    ]
    ours = session.energy.as_dict()
    energy = [{"energy": k, "program": ours[k], "reference": expected.energy.get(k, 0.0)} for k in ours]
    return {"particles": particles, "axial forces, kN": rods, "energies, J": energy}
