"""Simulation, linear and exact theory side by side, and what theory says of a structure: what `pinjoint verify` prints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from pinjoint.commands.analysis import by_element, static_facts
from pinjoint.commands.influence import NOTHING
from pinjoint.commands.output import Row, aligned, as_written
from pinjoint.components.language import decimals, joined, marked, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import can_collapse, euler_load
from pinjoint.headless import Headless
from pinjoint.systems.base import DEFAULT_LIMIT
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.explain import describe_motion, listed
from pinjoint.systems.statics.limit_analysis import LimitLoad
from pinjoint.systems.statics.state import StaticState
from pinjoint.systems.statics.theory import Indeterminacy, mechanisms, self_stress
from pinjoint.systems.statics.verify import DEPARTURES, ELSEWHERE, QUANTITIES, Comparison, Theories
from pinjoint.systems.statics.verify import Row as Compared
from pinjoint.systems.statics.vibration import Vibrations

VERIFIED, NOT_VERIFIED = marked("verified"), marked("not verified")
LEFT_OUT = marked("left out")  # of a simulation
MOST_WORK = 200_000  # steps × elements of a simulation that nobody asked for: some seconds, interpreted
_PORTIONS = 10  # in which they are taken
SHOWN = 6  # mechanisms and frequencies in a table
_ANSWERS = {
    "simulation": marked("simulation"),
    "linear": marked("linear theory"),
    "exact": marked("exact theory"),
}
_ERRORS = {"simulation_error": marked("error of simulation"), "linear_error": marked("error of linear theory")}
_VALUES = _ANSWERS | _ERRORS  # of a quantity of an element, with their titles

Found = dict[str, Any]


def compare(session: Headless, name: str, limit: float | None, *, simulate: bool = True) -> Found:
    """Theory beside the simulation run to rest (at most `limit` s of simulated time), as plain data.

    limit: None: DEFAULT_LIMIT, and the simulation is left out where it takes more than MOST_WORK.

    simulate: False for theory alone. `status` is "verified" if the simulation came to rest in the exact
    equilibrium; "differs from static theory" if it departed from the path of a slowly growing load, as `message`
    explains first; "theory only" without a simulation; else "not verified", and `message` gives the reason.
    """
    model = session.model
    theory = Theories.of(model)
    found = _found_by_theory(model, name, theory)
    at_rest = False
    if simulate and model.rods.count:
        status = _run_to_rest(session, limit)
        takes_long = tr(
            "Not at rest after {steps} steps, so the simulation is left out here; --limit SECONDS lets it go on.",
            steps=model.clock.steps,
        )
        found["simulation"] = {
            "status": status,
            "message": session.message if status != LEFT_OUT else takes_long,
            "time": model.clock.time,
            "steps": model.clock.steps,
            "integrator": session.simulation.integrator.key,
        }
        at_rest = status == "at rest"
        simulate = status != LEFT_OUT
    comparison = theory.beside(model, simulated=at_rest)
    found |= _by_element(comparison if model.rods.count else None)
    worst = {way: comparison.worst(way) for way in ("simulation", "linear")}
    found["worst"] = {way: row and asdict(row) for way, row in worst.items() if model.rods.count}
    found["remarks"] = [event.record(model) for event in session.document.assessment.remarks]
    if theory.exact is not None and (at_rest or not simulate) and model.rods.count:
        departed = any(remark["kind"] in DEPARTURES for remark in found["remarks"])
        differs = marked("differs from static theory") if departed else NOT_VERIFIED
        agreed = differs if comparison.differs else VERIFIED
        found["status"] = agreed if simulate else marked("theory only")
    if can_collapse(model):
        found["limit_load"] = LimitLoad.of(model).record(model)
    found["compression_members"] = _compression_members(model, theory.exact or theory.linear)
    laws = ", ".join(left_out_of_statics(model))
    left_out = [tr("Theory leaves out the laws of mods: {laws}.", laws=laws)] if laws else []
    found["message"] = "\n".join([*left_out, *_messages(found)])
    return found


def _run_to_rest(session: Headless, limit: float | None) -> str:
    """The status of a run until at rest, or LEFT_OUT."""
    if limit is not None:
        return session.run(until="rest", limit=limit)
    steps = MOST_WORK // _PORTIONS // (session.model.particles.count + session.model.rods.count) + 1
    for _ in range(_PORTIONS):
        status = session.run(steps=steps)
        if status != "time reached":
            return status
        if session.time >= DEFAULT_LIMIT:
            return session.run(until="rest", limit=0.0)
    return LEFT_OUT


def _by_element(comparison: Comparison | None) -> dict[str, dict[str, Any]]:
    """The rows as {"rods": {name: {quantity: values}}, "particles": {name: {quantity: {axis: values}}}}."""
    tables: dict[str, dict[str, Any]] = {"rods": {}, "particles": {}}
    for row in comparison.rows if comparison is not None else ():
        values = {key: value for key, value in vars(row).items() if key in _VALUES}
        quantities = tables[f"{row.element}s"].setdefault(row.name, {})
        if row.component:
            quantities.setdefault(row.quantity, {})[row.component] = values
        else:
            quantities[row.quantity] = values
    return tables


def _found_by_theory(model: Model, name: str, theory: Theories) -> Found:
    settlement, degrees, count = theory.settlement, Indeterminacy.of(model), Count.of(model)
    free = Vibrations.of(model)
    loaded = Vibrations.of(model, settlement.final).hertz.tolist() if theory.exact is not None else None
    rods, names = model.rods.names, model.particles.names
    return {
        "model": name,
        "status": NOT_VERIFIED,
        "message": "",
        "indeterminacy": {
            name: getattr(degrees, name) for name in ("static", "internal", "external", "mechanisms")
        },
        "count": {
            **{name: number for name, number in asdict(count).items() if number is not None},
            "degree": count.degree,
        },
        "cables": [name for name, cable in zip(rods, model.rods.tension_only, strict=True) if cable],
        "mechanisms": [
            {
                "description": describe_motion(model, motion[None]),
                "motion": {name: m for name, m in zip(names, motion.tolist(), strict=True) if any(m)},
            }
            for motion in mechanisms(model)
        ],
        **_self_stress(model),
        "states": {
            way: by_element(model, static_facts(model, state)) if state is not None else None
            for way, state in (("linear", theory.linear), ("exact", theory.exact))
        },
        "frequencies": {"unloaded": free.hertz.tolist(), "loaded": loaded, "in_motion": free.lumped},
        "frequencies_note": free.note,
        "simulation": None,
        "linear": {
            "status": theory.refusal.status if theory.refusal else "equilibrium",
            "message": str(theory.refusal or ""),
        },
        "exact": {
            "status": settlement.status,
            "message": settlement.message,
            "events": [event.record(model) for event in settlement.events],
        },
    }


def _compression_members(model: Model, state: StaticState | None) -> Found:
    """The compression of rods between two hinges beside π² EI/L², at which they buckle, by name."""
    euler, names = euler_load(model), model.rods.names
    force = np.zeros(model.rods.count) if state is None else state.axial_force
    pressed = np.flatnonzero((force < 0.0) & np.isfinite(euler))
    return {
        names[row]: {
            "axial_force": float(force[row]),
            "euler_load": float(euler[row]),
            "share": float(-force[row] / euler[row]),
            "buckles": bool(model.rods.buckles[row]),
        }
        for row in pressed.tolist()
    }


def _self_stress(model: Model) -> Found:
    """The states of self-stress: axial forces by rod, and where members bend the moments on both ends beside them."""
    states, rods = self_stress(model), model.rods
    found: Found = {"self_stress": [dict(zip(rods.names, state.tolist(), strict=False)) for state in states]}
    rigid = rods.turning_shares > 0.0
    if rigid.any():
        moments = np.zeros((len(states), rods.count, 2))
        moments[:, rigid] = states[:, rods.count :] * np.where(np.nonzero(rigid)[1], 1.0, -1.0)
        found["self_stress_moments"] = [dict(zip(rods.names, of.tolist(), strict=True)) for of in moments]
    return found


def _messages(found: Found) -> Iterator[str]:
    """Sentences about the answers: departures from statics, missing answers, remarks."""
    if not found["rods"]:
        yield tr("The model has no rods, so there is nothing to compare. Use: pinjoint run MODEL")
        return
    departures = [remark["message"] for remark in found["remarks"] if remark["kind"] in DEPARTURES]
    yield from departures
    worst = found["worst"]["simulation"]
    if found["status"] == NOT_VERIFIED and worst is not None:
        yield tr(
            "The simulation came to rest in another state than the exact equilibrium: the {quantity} differs by"
            " {error:.1e}. Statics applies lack of fit and moved supports first, and then all loads together, slowly."
            " Where rods yield or the structure snaps through, the end may differ if loads act suddenly or one after"
            " another, or if the model starts in motion.",
            quantity=Compared(**worst).title,
            error=worst["simulation_error"],
        )
    members = found["compression_members"]
    slender = [name for name, of in members.items() if of["share"] > 1.0 and not of["buckles"]]
    if slender:
        yield plural(
            "Rod {rods} would buckle between its hinges: its compression is above π² EI/L². Let it buckle, divide or"
            " stiffen it.",
            "Rods {rods} would buckle between their hinges: their compression is above π² EI/L². Let them buckle, divide or"
            " stiffen them.",
            len(slender),
            rods=listed(slender),
        )
    for way, said in {
        "simulation": marked("Simulation: {message}"),
        "linear": marked("Linear theory: {message}"),
        "exact": marked("Exact theory: {message}"),
    }.items():
        if found[way] is not None and found[way]["message"] and found[way]["status"] != "at rest":
            yield tr(said, message=found[way]["message"])
    for remark in found["remarks"]:
        if remark["kind"] not in DEPARTURES and remark["message"] not in found["exact"]["message"]:
            yield remark["message"]


# --- as text -------------------------------------------------------------------------------------------


def rows(found: Found) -> Iterator[Row]:
    """One row for each quantity of an element, headings first."""
    yield "element", "name", "quantity", "component", "unit", *_VALUES
    for quantity, (table, unit, _) in QUANTITIES.items():
        for name, component, values in _values(found, quantity):
            yield table[:-1], name, quantity, component, unit, *(values[way] for way in _VALUES)


def _values(found: Found, quantity: str) -> Iterator[tuple[str, str, Found]]:
    """(name, component, values) of a quantity of every element; the component of a scalar is ""."""
    for name, quantities in found[QUANTITIES[quantity][0]].items():
        of = quantities.get(quantity, {})
        yield from ((name, *item) for item in ([("", of)] if "exact" in of else of.items()))


def _degrees(found: Found) -> str:
    """The degrees of static and kinematic indeterminacy in words."""
    degrees = found["indeterminacy"]
    static, moving = degrees["static"], degrees["mechanisms"]
    kinematic = tr("no mechanisms")
    if moving:
        kinematic = plural(
            "kinematically indeterminate: one mechanism",
            "kinematically indeterminate: {count} mechanisms",
            moving,
        )
    if static:
        statical = tr(
            "statically indeterminate to degree {static} (internal {internal}, external {external})", **degrees
        )
    else:
        statical = tr("no self-stress") if moving else tr("statically determinate")
    cables = tr("all cables are counted as taut") if found["cables"] else ""
    return joined([statical, kinematic, cables], "; ")


def _formula(found: Found) -> str:
    """The rule for counting by hand with its numbers, and what the rank says where there are mechanisms."""
    numbers, degrees = dict(found["count"]), found["indeterminacy"]
    del numbers["degree"]
    count = Count(**numbers)
    said = count.by_rank(degrees["static"], degrees["mechanisms"])
    rule = f"{count.formula} = {count.numbers}"
    return tr("{rule}; by matrix rank: {said}", rule=rule, said=said) if said else rule


def lines(found: Found) -> Iterator[str]:
    """What `compare` found, as aligned tables to read."""
    yield f"{found['model']}: {_verdict(found)}"
    yield from filter(None, [found["message"]])
    if found["rods"]:
        yield _formula(found)
        yield _degrees(found)
    for mechanism in found["mechanisms"][:SHOWN]:
        yield tr("mechanism: {description}", description=mechanism["description"])
    for when, said in {
        "unloaded": marked("natural frequencies without load, Hz: {values}"),
        "loaded": marked("natural frequencies under load, Hz: {values}"),
    }.items():
        if frequencies := found["frequencies"][when]:
            values = [*map(as_written, frequencies[:SHOWN]), *(["…"] if len(frequencies) > SHOWN else [])]
            yield tr(said, values="  ".join(values))
    yield from filter(None, [found["frequencies_note"]])
    if limit := found.get("limit_load"):
        yield limit["message"]
    for quantity, (_, unit, title) in QUANTITIES.items():
        shown, factor = ("mm", 1000.0) if unit == "m" else (unit, 1.0)
        rows = {f"{name} {tr(axis)}".rstrip(): values for name, axis, values in _values(found, quantity)}
        if rows:
            yield ""
            yield from aligned(_cells(f"{tr(title)}, {shown}", factor, rows))
    if members := found["compression_members"]:
        yield ""
        heading = [tr("compression members, kN"), "−N", "π² EI/L²", "−N L²/(π² EI)"]
        given = ([name, -of["axial_force"], of["euler_load"], of["share"]] for name, of in members.items())
        yield from aligned([heading, *given])
    for way, said in {
        "simulation": marked("largest error of the simulation: {error:.1e}, in the {quantity}"),
        "linear": marked("largest error of linear theory: {error:.1e}, in the {quantity}"),
    }.items():
        if row := found["worst"].get(way):
            yield ""
            yield tr(said, error=row[f"{way}_error"], quantity=Compared(**row).title)


def _verdict(found: Found) -> str:
    """The status in words: how well the answers agree."""
    worst = {way: row and row[f"{way}_error"] for way, row in found["worst"].items()}
    if found["status"] != VERIFIED:
        return tr(found["status"])
    if (linear := worst["linear"]) and linear > ELSEWHERE:
        return tr(
            "verified, simulation and exact theory agree to {simulation:.1e}; linear theory is off by {linear:.1e}",
            **worst,
        )
    return tr("verified, simulation and exact theory agree to {simulation:.1e}", **worst)


def _cells(title: str, factor: float, rows: dict[str, Found]) -> list[Row]:
    largest = max(abs(values[way] or 0.0) for values in rows.values() for way in _ANSWERS)
    cells: list[Row] = [[title, *(tr(_VALUES[way]) for way in _VALUES)]]
    for name, values in rows.items():
        numbers = [
            "—" if v is None else factor * v if abs(v) > NOTHING * largest else 0.0
            for v in (values[way] for way in _ANSWERS)
        ]
        errors = ["—" if values[w] is None else decimals(f"{values[w]:.1e}") for w in _ERRORS]
        cells.append([name, *numbers, *errors])
    return cells
