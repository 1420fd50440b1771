"""Benchmarks measure what they say; how fast it is, is not tested."""

import importlib
import json
import math
from pathlib import Path

import pytest

from pinjoint.commands import bench
from pinjoint.commands.arguments import UsageError
from pinjoint.commands.output import FORMATS, Format
from pinjoint.components.settings import INTEGRATORS
from tests.benchmarks import collisions, drawing, ratios, speed, stability, start
from tests.reference.scenes_of_discs import gas, packed
from tests.stability.cases import damped


@pytest.mark.parametrize("name", bench.NAMES)
def test_every_benchmark_can_be_run(name: str) -> None:
    """A name that moved is noticed here, not by whoever runs the benchmark next."""
    assert callable(importlib.import_module(f"tests.benchmarks.{name}").report)


@pytest.mark.parametrize("format", FORMATS)
def test_what_was_measured_is_printed_in_every_format(
    format: Format, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (bench.CHECKOUT / "pyproject.toml").is_file()
    tables = {"steps": [{"rods": 3, "us": 0.5}, {"rods": 10, "us": math.nan}]}
    monkeypatch.setattr(speed, "report", lambda quick: tables)
    assert bench.command(["speed", "--quick", "--format", format]) == 0
    printed = capsys.readouterr().out
    if format == "json":
        assert json.loads(printed) == {"speed": {"steps": [{"rods": 3, "us": 0.5}, {"rods": 10, "us": None}]}}
    elif format == "csv":
        assert printed.splitlines()[:3] == [
            "benchmark,table,row,quantity,value",
            "speed,steps,1,rods,3",
            "speed,steps,1,us,0.5",
        ]
    else:
        assert [line.split() for line in printed.splitlines()[:3]] == [
            ["==", "speed", "=="],
            ["steps"],
            ["rods", "us"],
        ]


@pytest.mark.parametrize("words", [["--seed", "1"], ["speed", "--seed", "1"], ["differential", "--seed", "-1"]])
def test_only_models_drawn_by_lot_have_numbers(words: list[str]) -> None:
    with pytest.raises(UsageError, match="--seed takes a whole number"):
        bench.command(words)


def test_one_model_is_examined_by_its_number(capsys: pytest.CaptureFixture[str]) -> None:
    assert bench.command(["differential", "--seed", "14", "--format", "json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["differential"]["model"]
    assert row["seed"] == 14


def test_ratios_that_do_not_hold_are_told() -> None:
    good = {"kind": "elastic", "rods": "1000", "ns_per_rod": "8", "ratio_to_plain": "1.1"}
    large = good | {"rods": "100000", "ns_per_rod": "16"}
    assert list(ratios.broken([good, large])) == []
    small = good | {"rods": "3", "ns_per_rod": "90", "ratio_to_plain": "3"}
    assert list(ratios.broken([small, good])) == []
    assert "2.50 times a plain kernel" in "".join(ratios.broken([good | {"ratio_to_plain": "2.5"}]))
    assert "80.0 ns a rod among 100000" in "".join(ratios.broken([good, large | {"ns_per_rod": "80"}]))


def test_every_part_of_a_frame_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = {row["part"]: row["ms"] for row in drawing._frame(300, count=2)}
    assert {"render.pygame", "input.pygame", "edit.hover", "run.time", "whole frame"} <= set(rows)
    assert sum(rows.values()) - rows["whole frame"] <= rows["whole frame"]


def test_tables_and_the_picture_are_written(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    step = {"us_per_step": 1.0, "ns_per_rod": 10.0, "plain_ns_per_rod": 9.0, "rods": 1000}
    tables = {
        "steps": [{"kind": kind, **step} for kind in speed.KINDS],
        "ceiling": [{"rods": 1000, "memory_ns_per_rod": 2.0, "arithmetic_ns_per_rod": 1.0}],
        "peers": [{"peer": "another", "rods": 1000, "ns_per_rod": 200.0}],
    }
    bench.write_files("speed", tables, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "speed_steps.csv",
        "speed_ceiling.csv",
        "speed_peers.csv",
        "speed.png",
    }


def test_how_far_discs_sink_into_one_another_is_measured() -> None:
    scene = packed(5, 4)
    assert collisions._sunk(scene["position"], scene) <= 1e-12
    lower = scene["position"].copy()
    lower[0, 1] -= 0.01
    assert 0.1 < collisions._sunk(lower, scene) < 0.2


def test_pymunk_is_given_the_same_discs() -> None:
    scene = gas(30, 0.1)
    _, _, bodies = collisions._pymunk(scene, 0.1, 1.0, 0.0)
    assert sum(body.velocity.length**2 for body in bodies) == pytest.approx(30)


def test_the_map_of_stability_has_a_cell_for_every_integrator() -> None:
    case = damped(0.1)
    row = stability._row(case, lambda _: case, 100)
    assert (row["varied"], row["value"]) == ("damping ratio", "0.1")
    assert set(INTEGRATORS) < set(row)
    assert float(row["dop853"]) < 1e-8


def test_windows_are_timed_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(start, "COMMANDS", {"help": ["-c", "import tests.benchmarks.models"]})
    assert [row["cache"] for row in start._command("help")] == ["empty", "full"]
