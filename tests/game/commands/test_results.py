"""Results of runs as data, JSON, table and CSV: the states at the times that were asked for."""

import csv
import io
import json
import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.analysis import Analysis, by_element, facts
from pinjoint.commands.output import FORMATS, Format, ResultError, formatted
from pinjoint.commands.run import lines, rows
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.paths import ENERGIES
from tests.reference.models import triangle

ENERGY = {name: float(n) for n, name in enumerate(ENERGIES)}


@pytest.fixture
def solved() -> Model:
    """The isostatic triangle with a state set by hand, as if it had been computed."""
    solved = models.parse(triangle() | {"state": {"time": 0.1 + 0.2, "collisions": 2}})
    solved.writable("particles.displacement")[1] = (0.000907917, -0.001497751)
    solved.writable("particles.velocity")[1] = (-0.0, 1 / 3)
    solved.writable("particles.reaction")[...] = [(0, 20.01479), (0, 0), (-120, 139.98521)]
    solved.writable("rods.axial_force")[...] = [-28.34277, -198.02746, 20.06790]
    solved.writable("rods.length")[...] = [1.41, 1.42, 2.0]
    solved.writable("rods.yielding")[1] = True
    return solved


def state(model: Model, energy: dict[str, float], **given: float) -> dict[str, Any]:
    return by_element(model, facts(model, energy, **given))


def written(run: dict[str, Any], format: Format) -> str:
    return formatted(format, run, rows, lines)


def run(*states: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {
        "model": "isostatic",
        "status": "equilibrium",
        "message": "",
        "time": 0.3,
        "steps": 1200,
        "time_step": 2.5e-4,
        "integrator": "velocity_verlet",
        "wall_seconds": 0.012,
        "compile_seconds": 1.5,
        "events": [],
        "states": list(states),
    } | changes


def test_a_state_holds_every_element_and_the_account(solved: Model) -> None:
    made = state(solved, ENERGY, load_factor=1.0, residual=1e-12)
    assert list(made) == ["time", "load_factor", "particles", "rods", "energy", "residual", "collisions"]
    assert made["particles"]["B"] == {
        "position": [1.0, 1.0],
        "displacement": [0.000907917, -0.001497751],
        "velocity": [0.0, 1 / 3],
        "reaction": [0.0, 0.0],
        "mass": pytest.approx(6.15 * math.sqrt(2), rel=1e-15),
    }
    assert made["rods"]["BC"] == {
        "axial_force": -198.02746,
        "length": 1.42,
        "strain": 0.0,
        "plastic_strain": 0.0,
        "yielding": True,
    }
    assert made["energy"] == ENERGY
    others = {"time": 0.1 + 0.2, "load_factor": 1.0, "residual": 1e-12, "collisions": 2}
    assert {key: made[key] for key in others} == others


def test_json_keeps_full_precision(solved: Model) -> None:
    made = state(solved, ENERGY)
    again = json.loads(written(run(made), "json"))
    assert again["states"] == [made]
    assert again["states"][0]["time"].hex() == (0.1 + 0.2).hex()
    assert math.copysign(1, again["states"][0]["particles"]["B"]["velocity"][0]) == -1.0


def test_json_has_one_element_a_line(solved: Model) -> None:
    lines = [line.strip() for line in written(run(state(solved, ENERGY)), "json").splitlines()]
    assert sum(line.startswith('"B": {"position": [1.0, 1.0], ') for line in lines) == 1


def test_numbers_of_numpy_become_plain() -> None:
    events = [{"time": np.float64(0.5), "step": np.int64(3), "at": np.array([1.0, 2.0])}]
    again = json.loads(written(run(events=events), "json"))
    assert again["events"] == [{"time": 0.5, "step": 3, "at": [1.0, 2.0]}]


def test_what_is_not_finite_is_refused_by_name(solved: Model) -> None:
    solved.writable("rods.axial_force")[1] = math.nan
    with pytest.raises(
        ResultError, match=r"rod BC: axial force is nan, not a finite number; report an earlier state\."
    ):
        state(solved, ENERGY)
    solved.writable("rods.axial_force")[1] = 0.0
    solved.writable("particles.velocity")[2, 1] = -math.inf
    with pytest.raises(ResultError, match=r"particle C: velocity is \(0\.0, -inf\), not a finite"):
        state(solved, ENERGY)


@pytest.mark.parametrize("format", FORMATS)
def test_no_format_writes_what_is_not_finite(solved: Model, format: Format) -> None:
    made = state(solved, ENERGY)
    made["particles"]["B"]["velocity"][1] = math.inf
    with pytest.raises(ResultError, match=r"result\.states\[0\]\.particles\.B\.velocity\[1\] is inf"):
        written(run(made), format)


@pytest.mark.parametrize("name", ["work", "imbalance"])
def test_energies_must_be_there_and_finite(solved: Model, name: str) -> None:
    with pytest.raises(ResultError, match=rf"energy\.{name} is nan"):
        state(solved, ENERGY | {name: math.nan})
    with pytest.raises(KeyError, match=name):
        state(solved, {key: value for key, value in ENERGY.items() if key != name})


def test_the_table_shows_every_element_with_units(solved: Model) -> None:
    text = written(run(state(solved, ENERGY, load_factor=0.5, residual=1e-9), message="All is well."), "table")
    lines = text.splitlines()
    assert lines[:4] == [
        "isostatic: equilibrium",
        "All is well.",
        "time 0.3 s, 1200 steps of 0.00025 s, integrator velocity_verlet",
        "computed in 0.012 s, ready after 1.5 s",
    ]
    assert "At load factor 0.5" in lines
    titles = next(n for n, line in enumerate(lines) if line.startswith("particle "))
    assert lines[titles].split("  ")[-1] == "mass"
    assert lines[titles + 1].split() == ["m", "m", "mm", "mm", "m/s", "m/s", "kN", "kN", "kg"]
    b = lines[titles + 3].split()
    assert b[:5] == ["B", "1", "1", "0.907917", "-1.497751"]
    assert b[5:9] == ["0", "0.3333333", "0", "0"]
    rods = next(n for n, line in enumerate(lines) if line.startswith("rod "))
    assert lines[rods + 1].split() == ["kN", "m"]
    assert lines[rods + 3].split() == ["BC", "-198.0275", "1.42", "0", "0", "yes"]
    assert len({len(line) for line in lines[rods + 2 : rods + 5]}) == 1  # aligned
    assert "dissipated by damping   2" in lines
    assert lines[-1] == "unbalanced forces: 1e-09 of the largest force; impacts: 2"


def test_the_table_of_a_run_without_states() -> None:
    assert written(run(status="mechanism", time_step=None), "table").splitlines() == [
        "isostatic: mechanism",
        "time 0.3 s, 1200 steps, integrator velocity_verlet",
        "computed in 0.012 s, ready after 1.5 s",
    ]


def test_csv_has_one_number_a_line(solved: Model) -> None:
    solved.particles["B"].name = 'B, "the\ntop"'
    text = written(run(state(solved, ENERGY), state(solved, ENERGY, load_factor=2.0, residual=0.5)), "csv")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert list(rows[0]) == ["time", "load_factor", "element", "name", "quantity", "value", "unit"]
    assert len(rows) == 2 * (3 * 9 + 3 * 5 + 7 + 2)
    values = {(r["load_factor"], r["element"], r["name"], r["quantity"]): (r["value"], r["unit"]) for r in rows}
    assert values["", "particle", 'B, "the\ntop"', "velocity_y"] == (repr(1 / 3), "m/s")
    assert values["2.0", "rod", "BC", "axial_force"] == ("-198.02746", "kN")
    assert values["", "rod", "BC", "yielding"] == ("1", "")
    assert values["", "energy", "", "imbalance"] == ("6.0", "J")
    assert values["", "run", "", "residual"] == ("", "")
    assert values["2.0", "run", "", "residual"] == ("0.5", "")
    assert {r["time"] for r in rows} == {repr(0.1 + 0.2)}


# --- at the times that were asked for -----------------------------------------------------------------

DAMPED = triangle(damping=100, density=6.15)


def test_states_are_reported_at_exactly_the_times_asked_for() -> None:
    times = (0.0, 1e-4, 3e-4, 0.3, 0.7)
    run = Analysis(times=times).run(Session.open(DAMPED).simulation, "triangle")
    assert run["status"] == "time reached"
    assert [made["time"] for made in run["states"]] == list(times)
    forces = [made["rods"]["AB"]["axial_force"] for made in run["states"]]
    assert forces[0] == 0.0
    assert forces[1] != forces[2] != forces[3]
    assert forces[3] == forces[4]  # at rest before 0.3 s; from then on time passes without steps


def test_a_report_on_the_way_does_not_change_the_run() -> None:
    direct = Analysis(times=(3e-4,)).run(Session.open(DAMPED).simulation, "triangle")
    reported = Analysis(times=(1.2345e-4, 3e-4)).run(Session.open(DAMPED).simulation, "triangle")
    assert reported["states"][-1] == direct["states"][-1]
