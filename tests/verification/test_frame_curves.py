"""Curves of frames: Euler's column behind its bifurcation against the elastica, Williams' toggle, Lee's frame."""

import json
import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from pinjoint.commands.command_line import main
from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.path import Curve, Goal
from tests.reference.closed_forms import von_mises_force
from tests.reference.models import CLAMPED, PINNED, line, model, particle, rod, von_mises_truss
from tests.verification.test_buckling import EI, HEADS, LENGTH, column


def williams(parts: int) -> Model:
    """Williams' toggle (in, lb): clamped feet, shallow, of so many rods for each half; 1 lb down on its crown."""
    half, rise = 12.943, 0.386
    places = [(half * i / parts, rise * (1 - abs(i - parts) / parts)) for i in range(2 * parts + 1)]
    document = line(places, CLAMPED, CLAMPED, stiffness=1.885e6, bending_stiffness=9.27e3)
    document["particles"][parts]["force"] = [0.0, -1.0]
    return parse(document)


def lee(parts: int) -> Model:
    """Lee's frame (cm, kN): legs of 120 with pinned feet, 1 kN down on a fifth of the beam; EA = 4320, EI = 1440."""
    places = [(0.0, 120.0 * i / parts) for i in range(parts + 1)]
    places += [(120.0 * i / parts, 120.0) for i in range(1, parts + 1)]
    document = line(places, PINNED, PINNED, stiffness=4320.0, bending_stiffness=1440.0)
    document["particles"][parts + parts // 5]["force"] = [0.0, -1.0]
    return parse(document)


def test_williams_toggle_snaps_through() -> None:
    """Limit loads against those of 32 rods for each half."""
    for parts, error in {1: 1.87e-2, 2: 1.06e-2, 4: 6.7e-4, 8: 4e-5}.items():
        curve = Curve.of(williams(parts), Goal(-0.8, (parts, 1)))
        assert curve.complete
        upper, lower = curve.events
        assert (upper.kind, lower.kind) == ("limit point", "limit point")
        assert upper.load_factor / 33.861203 - 1.0 == pytest.approx(error, rel=0.05)
        assert 0.0 < lower.load_factor / 31.262570 - 1.0 < error
        falling = (curve.displacement[:, parts, 1] > -0.8) & ~curve.stable
        assert falling.any()


@pytest.mark.parametrize(("parts", "error"), [(5, 3.6e-4), (10, 2.3e-5), (20, 1.4e-6)])
def test_lees_frame_snaps_back(parts: int, error: float) -> None:
    """Limit loads against those of 80 rods for each leg; between them the load turns negative."""
    curve = Curve.of(lee(parts), Goal(-90.0, (parts + parts // 5, 1)))
    assert curve.complete
    upper, lower = curve.events
    assert upper.load_factor / 1.85567274 - 1.0 == pytest.approx(error, rel=0.1)
    assert lower.load_factor / -0.94144309 - 1.0 == pytest.approx(2.5 * error, rel=0.1)
    assert (np.diff(curve.displacement[:, parts + parts // 5, 0]) < 0.0).any()


def elastica(turned: float) -> tuple[float, float, float]:
    """Load/Euler's, and the tip's x/L and y/L, of a cantilever that an upright force buckled until its tip turned so far."""
    modulus = math.sin(turned / 2.0) ** 2
    first, second = ellipk(modulus), ellipe(modulus)
    return (2.0 * first / math.pi) ** 2, 2.0 * math.sqrt(modulus) / first, 2.0 * second / first - 1.0


@pytest.mark.parametrize("turned", [0.5, 1.5])
def test_a_column_behind_its_bifurcation_is_the_elastica(turned: float) -> None:
    """From a straight column along the mode; of fourth order."""
    load, x, y = elastica(turned)
    critical, errors = (math.pi / 2 / LENGTH) ** 2 * EI, []
    for parts in (2, 4, 8):
        straight = parse(column(parts, CLAMPED, HEADS["free"]))
        goal = Goal.of(straight, until=f"P{parts}.rotation={-turned}")
        curve = Curve.of(straight, goal, branch=1)
        assert curve.complete
        assert [event.kind for event in curve.events] == ["bifurcation"]
        assert curve.events[0].load_factor == pytest.approx(Buckling.of(straight).factors[0], rel=1e-6)
        assert curve.rotation[-1, parts] == pytest.approx(-turned, rel=1e-12)
        assert curve.stable[-1]
        tip = curve.displacement[-1, parts] / LENGTH + [0.0, 1.0]
        errors.append(max(math.dist(tip, (x, y)), abs(curve.load_factor[-1] / critical / load - 1.0)))
    assert errors[-1] < 1e-4
    assert errors[0] / errors[1] > 8.0
    assert errors[1] / errors[2] > 12.0


def test_straight_on_is_unstable_and_both_sides_are_alike() -> None:
    straight = parse(column(2, CLAMPED, HEADS["free"]))
    sides = [Curve.of(straight, Goal(-2.0 * side, (2, 0)), branch=-side) for side in (1, -1)]
    for values in ("load_factor", "axial_force"):
        assert getattr(sides[0], values)[-1] == pytest.approx(getattr(sides[1], values)[-1], rel=1e-9)
    assert sides[0].rotation[-1] == pytest.approx(-sides[1].rotation[-1], rel=1e-9)
    curve = Curve.of(straight, Goal(40.0))
    assert curve.complete
    assert np.abs(curve.displacement[:, :, 0]).max() < 1e-9
    factor = curve.events[0].load_factor
    assert (curve.stable == (curve.load_factor < factor)).all()


def test_a_high_truss_bifurcates_before_it_snaps() -> None:
    """A two-bar truss that is high for its span, its crown free to move aside: of trusses, too."""
    tall = von_mises_truss(height=12.0, guided=False)

    def force(deflection: float) -> float:
        return von_mises_force(deflection, 12.0, 5.0, 1.28e6)

    curve = Curve.of(parse(tall), Goal(-8.0, (1, 1)))
    assert [event.kind for event in curve.events] == ["bifurcation", "bifurcation", "limit point"]
    for event in curve.events[:2]:  # where N (H/L)² + EA (L/L₀) (b/L)² = 0
        height = 12.0 - brentq(lambda down, at=event.load_factor: force(down) - at, 0.0, 7.0)
        length = math.hypot(height, 5.0)
        assert 25.0 / length**2 + (length - 13.0) / length * height**2 / length**2 == pytest.approx(
            0.0, abs=1e-9
        )
    aside = Curve.of(parse(tall), Goal(1.0, (1, 0)), branch=1)
    assert aside.complete
    assert aside.displacement[-1, 1, 0] == pytest.approx(1.0, rel=1e-12)
    assert aside.load_factor[-1] < aside.events[0].load_factor


# --- the command -----------------------------------------------------------------------------------------


def test_the_command_tells_points_and_events(capsys: pytest.CaptureFixture[str], tmp_path: Any) -> None:
    path = tmp_path / "column.json"
    path.write_text(json.dumps(column(2, CLAMPED, HEADS["free"])))
    words = ["curve", str(path), "--until", "P2.x=1", "--branch", "1"]
    assert main([*words, "--format", "json"]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert "Bifurcation at the load factor 24.6867" in said.err
    (event,) = found["events"]
    assert (event["kind"], event["load_factor"]) == ("bifurcation", pytest.approx(24.6867, rel=1e-5))
    assert len(event["motion"]["P2"]) == 3
    assert len(found["points"]) == len(found["load_factor"])
    last = found["points"][-1]
    assert last["particles"]["P2"]["displacement"][0] == pytest.approx(1.0, rel=1e-12)
    assert last["particles"]["P2"]["rotation"] == found["rotation"]["P2"][-1]
    assert last["rods"]["R0"]["bending_moment"][0] == found["bending_moment"]["R0.start"][-1]
    assert last["load_factor"] == found["load_factor"][-1]
    assert main([*words[:-2], "--branch", "3"]) == 1
    assert "The curve has one bifurcation, so there is no branch 3; choose 1 or -1." in capsys.readouterr().err


@pytest.mark.parametrize(
    ("until", "said"), [("P0.rotation=1", "P0 cannot turn"), ("P2.z=1", "or B.rotation=1, in rad")]
)
def test_goals_are_checked(until: str, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Goal.of(parse(column(2, CLAMPED, HEADS["free"])), until=until)


def test_a_first_order_curve_ends_where_a_joint_turns_about_itself() -> None:
    """All that resists a moment there has yielded: it does not unload and yield the other way, to and fro, instead."""
    document = model(
        [particle("A", 0, 0, **CLAMPED), particle("B", 3, 0, fixed=[True, True], moment=5.0)],
        [rod("A", "B", bending_stiffness=1000.0, plastic_moment=3.0)],
    )
    curve = Curve.of(parse(document), Goal(1.0), theory="first-order")
    assert [event.kind for event in curve.events] == ["hinge", "collapse"]
    assert curve.load_factor[-1] == pytest.approx(0.6, rel=1e-9)
    assert (np.diff(curve.load_factor) > 0.0).all()
