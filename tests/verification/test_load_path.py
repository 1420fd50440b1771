"""Load–displacement curves: on the closed form everywhere, through limit points, exactly to their goal."""

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.systems.statics.path import Curve, Goal
from tests.reference import closed_forms
from tests.reference.models import model, particle, three_bar_truss, von_mises_truss
from tests.reference.random_models import case

HEIGHT, HALF_SPAN, STIFFNESS = 1.0, 5.0, 1.28e6


def von_mises_forces(deflections: np.ndarray) -> np.ndarray:
    return np.array(
        [closed_forms.von_mises_force(d, HEIGHT, HALF_SPAN, STIFFNESS) for d in deflections.tolist()]
    )


@pytest.mark.parametrize("goal", [-2.5, -0.7, 0.3])
def test_every_point_lies_on_the_curve_of_the_von_mises_truss(goal: float) -> None:
    """P = 2 EA (H − δ)(1/L − 1/L₀), downhill behind the limit point, which dead load cannot hold."""
    limit, at_limit = closed_forms.von_mises_limit(HEIGHT, HALF_SPAN, STIFFNESS)
    curve = Session.open(von_mises_truss()).load_path(until=f"B.y={goal}")
    assert curve.complete
    deflection = -curve.displacement[:, 1, 1]
    assert deflection[-1] == pytest.approx(-goal, rel=1e-12)
    assert np.abs(curve.load_factor - von_mises_forces(deflection)).max() < 1e-12 * STIFFNESS
    unstable = (deflection > at_limit) & (deflection < 2 * HEIGHT - at_limit)
    assert (curve.stable == ~unstable).all()
    if goal == -2.5:
        peak = curve.load_factor[deflection < HEIGHT].max()
        assert 0.99 * limit < peak <= limit * (1 + 1e-12)


@pytest.mark.parametrize(("factor", "stable"), [(3000.0, True), (5000.0, True), (-2000.0, True)])
def test_it_ends_exactly_at_a_load_factor(factor: float, stable: bool) -> None:
    curve = Session.open(von_mises_truss()).load_path(factor)
    assert curve.complete
    assert curve.load_factor[-1] == pytest.approx(factor, rel=1e-12)
    assert bool(curve.stable[-1]) is stable


def test_an_elastic_plastic_curve_has_its_kink_at_first_yield() -> None:
    """Three bars: the stiffness falls where the vertical bar yields, at 1.7071 σA."""
    curve = Session.open(three_bar_truss(1.0, 0.003)).load_path(2.3 * 0.003)
    sag = -curve.displacement[:, 3, 1]
    kink = closed_forms.three_bar_first_yield(0.003)
    elastic = curve.load_factor <= kink * (1 + 1e-5)
    slopes = np.diff(curve.load_factor) / np.diff(sag)
    before, after = slopes[elastic[1:]], slopes[~elastic[1:]]
    assert before == pytest.approx(1000.0 * (1 + np.sqrt(0.5)), rel=1e-4)
    assert after == pytest.approx(1000.0 * np.sqrt(0.5), rel=1e-4)


def test_the_collapsing_triangle_keeps_less_and_less() -> None:
    curve = Session.open("isostatic_collapse").load_path(until="B.y=-0.05")
    peak = int(curve.load_factor.argmax())
    assert curve.load_factor[peak] == pytest.approx(0.868552, abs=1e-6)
    assert (np.diff(curve.load_factor[peak:]) < 0.0).all()
    assert not curve.stable[peak + 1 :].any()


def test_the_command_writes_a_table_to_plot(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["curve", "von_mises", "--until", "B.y=-2.2"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert list(rows[0])[:2] == ["load factor", "stable"]
    assert float(rows[-1]["B.y (m)"]) == pytest.approx(-2.2, rel=1e-12)
    assert {row["stable"] for row in rows} == {"0", "1"}
    assert "AB (kN)" in rows[0]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["isostatic", "--until", "C.x=1"], "C is held along x"),
        (["isostatic", "--until", "Z.x=1"], "Z"),
        (["isostatic", "--until", "B.y"], "write it like B.y=-2.5"),
        (["collision_i"], "apply one, which the load factor multiplies"),
    ],
)
def test_what_has_no_curve_is_refused(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["curve", *words]) == 2
    assert said in capsys.readouterr().err


def test_a_curve_that_ends_early_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["curve", "von_mises", "--until", "B.y=-2.2", "--points", "5"]) == 1
    assert "The curve stops at the load factor" in capsys.readouterr().err


def test_a_curve_of_a_mechanism_says_what_moves(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    square = model(
        [
            particle("A", 0, 0, fixed=[True, True]),
            particle("B", 1, 0, fixed=[True, True]),
            particle("C", 1, 1, force=[1, 0]),
            particle("D", 0, 1),
        ],
        [{"name": name, "between": list(name)} for name in ("BC", "CD", "DA")],
    )
    (tmp_path / "square.json").write_text(json.dumps(square))
    assert main(["curve", str(tmp_path / "square.json")]) == 1
    assert (
        "ends where it begins, at the load factor 0. The structure is a mechanism: C and D along x can move."
        in (capsys.readouterr().err)
    )


@pytest.mark.parametrize("number", [78020, 78255])
def test_curves_of_what_hangs_loosely_get_on(number: int) -> None:
    """Stiff rods turn much and elongate little on the way; then cables slacken, and forces hardly change."""
    curve = Curve.of(models.load(case(number).document), Goal(1.0))
    assert curve.complete
