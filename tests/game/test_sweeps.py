"""Sweeps: which variants there are, what they come to, what survives a kill, and what is refused."""

import csv
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.analysis import Analysis
from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.paths import apply_override
from pinjoint.sweeps import SweepError, sweep
from pinjoint.sweeps.execution import VariantRunner, compute, compute_all
from pinjoint.sweeps.plan import plan_of
from pinjoint.sweeps.results import Results
from tests.reference.models import square, triangle

MODEL = triangle(damping=100, density=6.15, tensile_strength=215, compressive_strength=215)
STATIC = Analysis(load_factors=(1.0,))
STIFFNESS = "rods.CA.stiffness"
FORCE_Y = "particles.B.force.y=-100:-300:3"
MEASURES = ["rods.AB.axial_force,particles.B.displacement", "energy.elastic"]
COLUMNS = ("rods.AB.axial_force", "particles.B.displacement.x", "particles.B.displacement.y", "energy.elastic")
USUAL_PORT = 8787  # of Dask's dashboard
DRAWN = "rods.*.stiffness~normal(164640,5%)"


def run_alone(overrides: Sequence[str], analysis: Analysis) -> dict[str, Any]:
    session = Session.open(MODEL)
    for override in overrides:
        apply_override(session.model, override)
    return analysis.run(session.simulation, "alone")  # type: ignore[return-value]


# --- variants ------------------------------------------------------------------------------------------


def test_all_combinations_the_last_varying_fastest() -> None:
    found = sweep(MODEL, [FORCE_Y, f"{STIFFNESS}=100000,200000"], MEASURES, STATIC)
    assert found["particles.B.force.y"].tolist() == [-100, -100, -200, -200, -300, -300]
    assert found[STIFFNESS].tolist() == [100000, 200000] * 3
    assert found["variant"].tolist() == list(range(6))


@pytest.mark.parametrize("analysis", [STATIC, Analysis(), Analysis(times=(1e-4, 2e-4))])
def test_a_variant_has_the_bits_of_a_run_of_its_own(analysis: Analysis) -> None:
    found = sweep(MODEL, [FORCE_Y], MEASURES, analysis, overrides=["rods.*.damping=10"])
    rows = list(zip(*(found.columns[name] for name in ("status", "time", *COLUMNS)), strict=True))
    for load in (-100.0, -200.0, -300.0):
        alone = run_alone(["rods.*.damping=10", f"particles.B.force.y={load}"], analysis)
        for state in alone["states"]:
            x, y = state["particles"]["B"]["displacement"]
            force, elastic = state["rods"]["AB"]["axial_force"], state["energy"]["elastic"]
            assert rows.pop(0) == (alone["status"], state["time"], force, x, y, elastic)
    assert not rows


def begun() -> dict[str, Any]:
    """The model in the middle of a run."""
    session = Session.open(MODEL)
    session.run(time=1e-4)
    session.simulation.account_for_edits()
    return models.document(session.model)


def loaded() -> dict[str, Any]:
    """The triangle with a cable, which becomes slack and taut, under loads that change in time."""
    made = triangle(damping=100, density=6.15)
    made["rods"] = [rod | {"tension_only": rod["name"] == "CA"} for rod in made["rods"]]
    return made | {
        "loads": [
            {"name": "up", "on": "B", "force": [0, -90], "history": {"kind": "ramp", "duration": 2e-4}},
            {"name": "on", "on": "B", "force": [30, 0], "history": {"kind": "ramp", "start": 1e-4}},
        ]
    }


ORDERS: dict[str, tuple[Any, list[str], Analysis]] = {
    "yielding in some": (
        square(damping=100, density=6.15),
        ["rods.CD.compressive_strength=null,40,300", "rods.AC.stiffness=-1,164640"],
        Analysis((1.0, 0.0)),
    ),
    "plasticity in some": (
        triangle(damping=20, density=6.15, tensile_strength=215, compressive_strength=215),
        ["settings.plasticity=true,false", "rods.BC.compressive_strength=205,290"],  # only in the overshoot
        Analysis(),
    ),
    "another integrator in some": (
        MODEL,
        ["settings.integrator=velocity_verlet,automatic", "rods.*.damping=0,50,100"],
        Analysis(times=(1e-4, 2e-4)),
    ),
    "begun before": (
        begun,
        ["rods.CA.stiffness=1e5,164640,2e5", "particles.B.velocity.x=0,0.1"],
        Analysis(times=(3e-4,)),
    ),
    "loads, geometry, environment": (
        loaded,
        [
            "loads.up.force.y=-80,-90",
            "particles.B.position.y=0.8,1.2",
            "environment.drag=0.5,10",
            "settings.integrator=rk4,semi_implicit_euler",
        ],
        Analysis(times=(1e-4, 1e-3)),
    ),
    "numbers that are refused, and extreme": (
        MODEL,
        ["rods.CA.temperature_change=-1e9,0", "rods.CA.stiffness=-1,1e-40,1e5", "particles.B.name=D"],
        Analysis(times=(1e-4,)),
    ),
    "never at rest in some": (MODEL, ["rods.*.damping=0,100"], Analysis(limit=0.01)),
    "discs that meet": (
        "collision_ii",
        ["settings.restitution=1,0.5", "particles.particle 1.radius=0.05,0.06"],
        Analysis(times=(0.5,)),
    ),
}


@pytest.mark.parametrize("name", ORDERS)
def test_variants_leave_nothing_behind(name: str) -> None:
    source, vary, analysis = ORDERS[name]
    measures = [
        "rods.*.axial_force,rods.*.plastic_strain",
        "particles.*.velocity",
        "energy.work,energy.imbalance",
    ]
    plan = plan_of(source() if callable(source) else source, vary, measures, analysis, (), None, 0)
    alone = [outcome for number in range(plan.size) for outcome in compute(plan, [number])]
    assert list(compute(plan, range(plan.size))) == alone
    assert list(compute(plan, range(plan.size)[::-1])) == alone[::-1]


AB = "rods.AB.axial_force"


def test_one_measure_may_be_a_text() -> None:
    one, listed = (sweep(MODEL, {STIFFNESS: [1e5]}, asked, STATIC) for asked in (AB, [AB]))
    assert one[AB].tolist() == listed[AB].tolist()


def test_one_number_of_all_elements_and_of_the_statics_of_a_variant() -> None:
    """As an expectation of the same model reads them, whatever is shown."""
    asked = "largest rods.*.bending_moment, min rods.*.axial_force,sum particles.*.reaction.y, statics.collapse"
    first_order = Analysis(load_factors=(0.5,), theory="first-order")
    factors = [30.0, 60.0]
    found = sweep("portal_collapse", ["rods.*.plastic_moment=30,60"], asked, first_order)
    for row, moment in zip(found, factors, strict=True):
        session = Session.open("portal_collapse")
        session.rods.plastic_moment = moment
        session.settings.load_steps = (0.5,)
        session.press("q")
        for path in asked.split(","):
            session.expect(f"{path.strip()} ≈ {row[path.strip()]} ± 1e-9")
    assert found["statics.collapse"][1] == pytest.approx(2.0 * found["statics.collapse"][0])


def test_results_have_rows() -> None:
    found = sweep("isostatic", {"rods.CA.stiffness": [1e5, 2e5]}, ["rods.AB.axial_force"])
    assert len(found) == 2
    assert [row["rods.CA.stiffness"] for row in found] == [1e5, 2e5]
    assert "2 at rest" in repr(found)


def test_ranges_lists_and_values_from_python() -> None:
    def taken(vary: Any) -> list[Any]:
        return sweep(MODEL, vary, ["residual"], STATIC).columns[STIFFNESS]

    assert taken([f"{STIFFNESS}=1e4:1e6:3:log"]) == pytest.approx([1e4, 1e5, 1e6], rel=1e-14)
    assert taken({STIFFNESS: np.linspace(1e5, 3e5, 3)}) == [1e5, 2e5, 3e5]
    assert taken({STIFFNESS: [1 / 3 * 1e6]}) == [1 / 3 * 1e6]
    words = sweep(MODEL, ["settings.plasticity=true,false"], ["rods.*.yielding"], STATIC)
    assert words.columns["settings.plasticity"] == [True, False]
    assert words.columns["rods.BC.yielding"] == [False, False]


def test_every_rod_is_drawn_for_itself_and_more_samples_keep_the_first() -> None:
    few, many = (sweep(MODEL, [DRAWN], ["residual"], STATIC, samples=n, seed=1) for n in (3, 5))
    paths = [f"rods.{rod}.stiffness" for rod in ("AB", "BC", "CA")]
    drawn = np.array([many[path] for path in paths])
    assert len(np.unique(drawn)) == 15
    assert [few[path].tolist() for path in paths] == drawn[:, :3].tolist()
    other = sweep(MODEL, [DRAWN], ["residual"], STATIC, samples=3, seed=2)
    assert not np.isin(other[paths[0]], drawn).any()


@pytest.mark.parametrize(
    ("distribution", "mean", "deviation"),
    [("normal(200,5%)", 200, 10), ("lognormal(200,60)", 200, 60), ("uniform(100,300)", 200, 200 / 12**0.5)],
)
def test_what_is_drawn_has_the_mean_and_deviation_asked_for(
    distribution: str, mean: float, deviation: float
) -> None:
    plan = plan_of(MODEL, [f"{STIFFNESS}~{distribution}"], ["residual"], STATIC, (), 4000, 3)
    drawn = np.array([plan.values(number)[0] for number in range(plan.size)], dtype=float)
    assert drawn.mean() == pytest.approx(mean, abs=4 * deviation / 4000**0.5)
    assert drawn.std() == pytest.approx(deviation, rel=0.1)


def test_every_combination_meets_the_same_draws() -> None:
    found = sweep(MODEL, [FORCE_Y, f"{STIFFNESS}~uniform(1e5,2e5)"], ["residual"], STATIC, samples=2)
    assert found["particles.B.force.y"].tolist() == [-100, -100, -200, -200, -300, -300]
    assert found[STIFFNESS].tolist() == found[STIFFNESS][:2].tolist() * 3


def test_variants_that_fail_are_recorded_with_the_reason() -> None:
    found = sweep(MODEL, [f"{STIFFNESS}=-5,164640"], MEASURES, STATIC)
    assert found.columns["status"] == ["failed", "equilibrium"]
    assert "stiffness is -5 kN; it must be greater than 0 kN" in found.columns["message"][0]
    assert np.isnan(found[COLUMNS[0]]).tolist() == [True, False]
    assert found.counts() == {"equilibrium": 1, "failed": 1}


def test_workers_compute_the_same_bits(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    """Another sweep may be running, whose scheduler has the usual port; nothing needs to be said about that."""
    arguments: Any = (MODEL, [DRAWN], MEASURES, STATIC)
    with socket.socket() as usual:
        with suppress(OSError):  # somebody has it already
            usual.bind(("", USUAL_PORT))
            usual.listen()
        for workers in (1, 2):
            output = tmp_path / f"{workers}.csv"
            sweep(*arguments, samples=12, seed=1, workers=workers, output=output)
    assert not [warning for warning in recwarn if "port" in str(warning.message).lower()]
    assert (tmp_path / "1.csv").read_bytes() == (tmp_path / "2.csv").read_bytes()


PLANTED = """
import sys
sys.path.remove("")
from pinjoint.sweeps.run import sweep

if __name__ == "__main__":
    sweep("isostatic", {"rods.AB.stiffness": [1e5, 2e5]}, ["rods.AB.axial_force"], workers=2, output="out.csv")
"""


def test_workers_import_nothing_from_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fresh_process: Callable[..., str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for module in ("_weakrefset", "random", "socket", "msgspec"):
        (tmp_path / f"{module}.py").write_text("open('ran', 'w').close()")
    fresh_process(PLANTED)
    assert (tmp_path / "out.csv").exists()
    assert not (tmp_path / "ran").exists()


# --- kills -----------------------------------------------------------------------------------------------


class KilledError(Exception):
    pass


def killed_after(count: int) -> Callable[[int, int, int], None]:
    def progress(done: int, total: int, failed: int) -> None:
        if done >= count:
            raise KilledError

    return progress


def interrupted(output: Path, **options: Any) -> None:
    with pytest.raises(KilledError):
        sweep(MODEL, [DRAWN], MEASURES, STATIC, samples=20, output=output, progress=killed_after(7), **options)


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The numbers of the variants that are computed."""
    numbers: list[int] = []
    records = VariantRunner.records

    def noted(self: VariantRunner, number: int) -> Any:
        numbers.append(number)
        return records(self, number)

    monkeypatch.setattr(VariantRunner, "records", noted)
    return numbers


def test_a_killed_sweep_goes_on_without_repeating(tmp_path: Path, computed: list[int]) -> None:
    output = tmp_path / "results.csv"
    interrupted(output)
    assert computed == list(range(7))
    journal = tmp_path / "results.csv.journal"
    journal.write_bytes(journal.read_bytes()[:-9])  # as if killed while it wrote the last line
    sweep(MODEL, [DRAWN], MEASURES, STATIC, samples=20, output=output)
    assert computed == [*range(7), *range(6, 20)]
    assert [path.name for path in tmp_path.iterdir()] == ["results.csv"]
    whole = tmp_path / "whole.csv"
    sweep(MODEL, [DRAWN], MEASURES, STATIC, samples=20, output=whole)
    assert output.read_bytes() == whole.read_bytes()


@pytest.mark.parametrize(
    "damage",
    [
        b"\xff\x00\x00",
        b"",
        b"[" * 100_000,
        b"[[3]]",
        b'[[3, [["equilibrium"]]]]',
        b"[[99, []]]",
        b'{"3": 4}',
        b'[[3, [["equilibrium", 7, 0.0, 1.0, [], "x"]]]]',
        None,  # a failing disk may turn one number into another, which would be reported as a result
    ],
    ids=lambda damage: repr(damage and damage[:12]),
)
def test_a_damaged_line_is_computed_anew(tmp_path: Path, computed: list[int], damage: bytes | None) -> None:
    output = tmp_path / "results.csv"
    interrupted(output)
    journal = tmp_path / "results.csv.journal"
    lines = journal.read_bytes().split(b"\n")
    damaged = lines[3].replace(b"1", b"2", 1) if damage is None else damage
    journal.write_bytes(b"\n".join([*lines[:3], damaged, *lines[4:]]))
    computed.clear()
    sweep(MODEL, [DRAWN], MEASURES, STATIC, samples=20, output=output)
    assert computed == [2, *range(7, 20)]


@pytest.mark.parametrize("foreign", [b"my diary", b"my diary\n", b"my\ndiary\n", b"\x00" * 9])
def test_a_file_that_is_no_journal_is_left_alone(tmp_path: Path, foreign: bytes) -> None:
    journal = tmp_path / "results.csv.journal"
    journal.write_bytes(foreign)
    with pytest.raises(SweepError, match="or something else"):
        sweep(MODEL, [DRAWN], MEASURES, STATIC, samples=20, output=tmp_path / "results.csv")
    assert journal.read_bytes() == foreign


@pytest.mark.parametrize("kept", [b"", b'{"pinjo'])
def test_a_journal_that_a_kill_left_at_its_first_line_begins_anew(tmp_path: Path, kept: bytes) -> None:
    (tmp_path / "results.csv.journal").write_bytes(kept)
    assert (
        len(sweep(MODEL, [DRAWN], MEASURES, STATIC, samples=2, output=tmp_path / "results.csv")["variant"]) == 2
    )


@pytest.mark.parametrize(
    "change",
    [
        {"seed": 1},
        {"overrides": ["rods.AB.damping=1"]},
        {"measure": ["residual"]},
        {"analysis": Analysis()},
        {"source": triangle(damping=99)},
        {"vary": ["rods.*.stiffness~normal(164640,6%)"]},
    ],
    ids=lambda change: next(iter(change)),
)
def test_what_is_kept_of_another_sweep_is_not_mixed_in_or_lost(tmp_path: Path, change: dict[str, Any]) -> None:
    output = tmp_path / "results.csv"
    interrupted(output)
    kept = (tmp_path / "results.csv.journal").read_bytes()
    arguments = {"source": MODEL, "vary": [DRAWN], "measure": MEASURES, "analysis": STATIC, "samples": 20}
    with pytest.raises(SweepError, match="holds an unfinished sweep with another model, variation, seed"):
        sweep(**(arguments | change), output=output)
    assert (tmp_path / "results.csv.journal").read_bytes() == kept


# --- results ---------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found() -> Results:
    return sweep(MODEL, ["particles.B.force.y=-50,-100", f"{STIFFNESS}=-1,1e5,2e5"], MEASURES, STATIC)


def test_csv_keeps_every_digit(found: Results, tmp_path: Path) -> None:
    found.write(tmp_path / "results.csv")
    with open(tmp_path / "results.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["failed", "equilibrium", "equilibrium"] * 2
    for name in ("particles.B.force.y", *COLUMNS):
        assert [float(row[name] or "nan") for row in rows] == pytest.approx(
            found[name].tolist(), rel=0, nan_ok=True
        )


def test_parquet_keeps_types_and_units(found: Results, tmp_path: Path) -> None:
    from pyarrow import parquet

    found.write(tmp_path / "results.parquet")
    table = parquet.read_table(tmp_path / "results.parquet")
    assert {name: table[name].to_pylist() for name in table.column_names} == found.columns
    assert table.schema.field("particles.B.displacement.x").metadata[b"unit"] == b"m"
    assert str(table.schema.field("rods.AB.axial_force").type) == "double"


def test_a_plot_is_a_picture_with_a_panel_per_measure(found: Results, tmp_path: Path) -> None:
    found.plot(tmp_path / "plot.png")
    content = (tmp_path / "plot.png").read_bytes()
    assert content.startswith(b"\x89PNG")
    width, height = (int.from_bytes(content[at : at + 4], "big") for at in (16, 20))
    assert (width, height) == (960, 120 * (1 + 3 * len(COLUMNS)))


# --- refusals --------------------------------------------------------------------------------------------

VARY = {
    "rods.CX.stiffness=1:2:3": "There is no 'CX' among the rods; choose one of AB, BC, CA.",
    "rods.CA.stifness=1:2:3": "there is no key 'stifness'; did you mean 'stiffness'?",
    "rods.CA.axial_force=1:2:3": "'axial_force' is computed and cannot be set",
    "rods.CA.stiffness": "it has no values; write PATH=START:STOP:COUNT",
    "rods.CA.stiffness=": "'' is not a value of stiffness",
    "rods.CA.stiffness=1,x": "'x' is not a value of stiffness",
    "rods.CA.stiffness=1:2": "a range has a start, a stop and a count",
    "rods.CA.stiffness=1:2:3:lin": "a range has a start, a stop and a count",
    "rods.CA.stiffness=1:2:0": "'0' is not a count; write a whole number of at least 1",
    "rods.CA.stiffness=1:inf:3": "'inf' is not a finite number",
    "rods.CA.stiffness=0:5:3:log": "a :log range cannot reach or cross 0",
    "rods.CA.stiffness=1:2:200000000": "'200000000' is not a count; write a whole number of at least 1, at most 10000000",
    "particles.B.force=1,2": "vary one component, force.x or force.y",
    "particles.B.force.z=1,2": "load has no part 'z'; write one of force.x, force.y",
    "rods.CA.stiffness~normal(1)": "'normal(1)' is not a distribution; write one of normal, lognormal, uniform",
    "rods.CA.stiffness~weibull(1,2)": "'weibull(1,2)' is not a distribution",
    "rods.CA.stiffness~normal(1,-2)": "the standard deviation must be at least 0",
    "rods.CA.stiffness~lognormal(-1,2)": "the mean of a lognormal above 0",
    "rods.CA.stiffness~uniform(2,1)": "write uniform(LOWEST,HIGHEST), the lower value first",
    "settings.plasticity~normal(1,2)": "plasticity is not a number; list its values after =",
}


@pytest.mark.parametrize(("text", "reason"), VARY.items(), ids=VARY.keys())
def test_variations_that_make_no_sense(text: str, reason: str) -> None:
    with pytest.raises(SweepError) as caught:
        sweep(MODEL, [text], MEASURES, STATIC)
    assert str(caught.value).startswith(f"{text}: ")
    assert reason in str(caught.value)


MEASURE = {
    "rods.CX.strain": "There is no 'CX' among the rods; choose one of AB, BC, CA.",
    "rods.CA.stiffness": "there is no key 'stiffness'; choose one of axial_force, length",
    "rods.CA.strain.x": "strain has no parts, such as 'x'; write strain.",
    "energy.heat": "there is no energy 'heat'; choose one of kinetic, elastic",
    "statics.heat": "it is none of width, frequency, buckling, first_yield, collapse",
    "largest particles.*.displacement": "name one component, such as displacement.x",
    "largest energy.kinetic": "write it like rods.CD.axial_force",
    "grids.1.spacing": "write it like rods.CD.axial_force",
    "nonsense": "write it like rods.CD.axial_force",
}


@pytest.mark.parametrize(("text", "reason"), MEASURE.items(), ids=MEASURE.keys())
def test_measures_that_do_not_exist(text: str, reason: str) -> None:
    with pytest.raises(SweepError) as caught:
        sweep(MODEL, [FORCE_Y], [text], STATIC)
    assert reason in str(caught.value)


@pytest.mark.parametrize("values", ["=1,2", "~normal(1,1)"])
def test_all_of_none_cannot_be_varied(values: str) -> None:
    """The discs of collision_ii have no rods."""
    with pytest.raises(SweepError, match=r"^rods\.\*\.stiffness.*: the model has no rods"):
        sweep("collision_ii", [f"rods.*.stiffness{values}"], ["residual"], samples=2)


SWEEPS = {
    "Nothing is varied": {"vary": []},
    "Nothing is measured": {"measure": []},
    "give it a list of at least one value": {"vary": {STIFFNESS: []}},
    "rods.CA.stiffness: give it a list": {"vary": {STIFFNESS: 2e5}},
    "rods.CA.stiffness is varied twice": {"vary": [f"{STIFFNESS}=1,2", f"{STIFFNESS}=3:4:2"]},
    "would overwrite rods.CA.stiffness": {"vary": [f"{STIFFNESS}=1,2", "rods.*.stiffness=3,4"]},
    "would overwrite particles.B.force.y": {"vary": [FORCE_Y, "particles.*.force.y=1"]},
    "needs a number of samples": {"vary": [DRAWN]},
    "A number of samples works only with a distribution": {"samples": 5},
    "0 samples: draw at least 1": {"vary": [DRAWN], "samples": 0},
    "The seed is -1": {"seed": -1},
    "These are 100000000 variants": {"vary": [f"rods.{rod}.stiffness=1:2:10000" for rod in ("AB", "BC")]},
    "0 workers: use at least 1": {"workers": 0},
    "results.txt: choose a file that ends with one of .csv, .parquet": {"output": "results.txt"},
    "its folder is missing": {"output": "no/such/folder/results.csv"},
}


@pytest.mark.parametrize(("reason", "change"), SWEEPS.items(), ids=SWEEPS.keys())
def test_sweeps_that_cannot_be_done(reason: str, change: dict[str, Any]) -> None:
    arguments: dict[str, Any] = {"source": MODEL, "vary": [FORCE_Y], "measure": MEASURES, "analysis": STATIC}
    with pytest.raises(SweepError) as caught:
        sweep(**(arguments | change))
    assert reason in str(caught.value)


def test_an_installation_that_differs_does_not_compute() -> None:
    from dataclasses import replace

    plan = plan_of(MODEL, [FORCE_Y], MEASURES, STATIC, (), None, 0)
    with pytest.raises(SweepError, match=r"the sweep needs 9\.9"):
        list(compute_all(replace(plan, version="9.9"), [0], 1, None))


# --- the command -------------------------------------------------------------------------------------------


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output, plot = tmp_path / "results.csv", tmp_path / "plot.png"
    words = ["sweep", "isostatic", "--vary", f"{STIFFNESS}=-1,1e5:1", "--measure", "residual", "--static"]
    assert main([*words, "--output", str(output), "--workers", "1"]) == 2
    assert "a range has a start, a stop and a count" in capsys.readouterr().err
    words[3] = f"{STIFFNESS}=-1,1e5"
    assert main([*words, "--output", str(output), "--plot", str(plot), "--workers", "1"]) == 0
    assert capsys.readouterr().out == f"{output}: 1 equilibrium, 1 failed; its column 'message' says why\n"
    assert output.is_file()
    assert plot.is_file()
    words[3] = f"{STIFFNESS}=-1,-2"
    assert main([*words, "--output", str(output), "--workers", "1"]) == 1


def test_an_output_that_cannot_be_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results.csv.journal").mkdir()
    words = ["sweep", "isostatic", "--vary", f"{STIFFNESS}=1,2", "--measure", "residual", "--workers", "1"]
    assert main([*words, "--output", str(tmp_path / "results.csv")]) == 2
    assert "results.csv.journal cannot be written: Is a directory" in capsys.readouterr().err


def test_what_every_result_has_may_be_asked_for() -> None:
    found = sweep(MODEL, {STIFFNESS: [1e5]}, ["energy.elastic,time,load_factor,residual"], STATIC)
    assert [measure.column for measure in found.plan.measures] == ["energy.elastic", "residual"]
    with pytest.raises(SweepError, match="Nothing is measured"):
        sweep(MODEL, {STIFFNESS: [1e5]}, ["time"], STATIC)
