"""Sessions as a script drives them, with good and with bad input."""

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import esper
import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components import FieldError, Rod
from tests.properties.limits import interrupted_after
from tests.reference.models import model, particle


@pytest.fixture
def session() -> Session:
    return Session.open("isostatic")


def test_a_whole_column_is_assigned_as_one_command(session: Session) -> None:
    session.rods.damping = 0
    session.particles.force = np.array([[0, 0], [1, 2], [3, 4]])
    assert session.rods.damping.tolist() == [0.0, 0.0, 0.0]
    assert session.particles["C"].force == (3.0, 4.0)
    session.undo()
    session.undo()
    assert session.rods["AB"].damping == 100.0
    assert session.particles["B"].force == (120.0, -160.0)
    assert not session.document.history.can_undo


@pytest.mark.parametrize(
    ("column", "value", "error", "words"),
    [
        ("mass", [1, 2], FieldError, "2 values for 3 elements"),
        ("mass", -1, FieldError, "particle A: mass is -1 kg"),
        ("name", "x", FieldError, "already"),
        ("reaction", 0, FieldError, "computed and cannot be set"),
        ("masss", 1, AttributeError, "There is no 'masss' among the columns"),
    ],
)
def test_a_column_that_cannot_be_assigned_says_why(
    session: Session, column: str, value: Any, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        setattr(session.particles, column, value)
    assert session.particles.names == ["A", "B", "C"]
    assert session.particles.name == "particles"
    assert not session.document.history.can_undo


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"time": 1.0, "steps": 1},
        {"until": "dawn"},
        {"time": -1.0},
        {"time": np.nan},
        {"time": np.inf},
        {"time": "1"},
        {"time": True},
        {"steps": 1.5},
        {"steps": -1},
        {"until": "rest", "limit": np.inf},
    ],
)
def test_a_run_that_has_no_end_is_refused(session: Session, how: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"how far|must be|only runs forward"):
        session.run(**how)
    assert session.time == 0.0
    assert not session.document.history.can_undo


def test_numbers_of_numpy_say_how_far_to_run(session: Session) -> None:
    session.run(steps=np.int64(3))  # type: ignore[arg-type]
    session.run(time=np.float32(1e-4))  # type: ignore[arg-type]
    assert session.time > 1e-4
    with pytest.raises(TypeError):
        session.step(1.5)  # type: ignore[arg-type]


@pytest.mark.parametrize("factors", [(), None, (np.nan,), ("a",), [[1.0]]])
def test_load_factors_that_are_none_are_refused(session: Session, factors: Any) -> None:
    with pytest.raises(ValueError, match="Load factors are"):
        session.settle(factors)
    assert session.settle(1) == "equilibrium"


def test_a_load_path_and_a_pointer_need_finite_numbers(session: Session) -> None:
    with pytest.raises(ValueError, match="load factor is nan"):
        session.load_path(np.nan)
    with pytest.raises(ValueError, match="finite coordinates"):
        session.click(np.nan, 0.0)
    with pytest.raises(ValueError, match="finite coordinates"):
        session.drag((0.0, 0.0), (np.inf, 0.0))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("energy.heat = 1", "no 'heat' among the energies"),
        ("count.beams = 1", "no 'beams' among the tables"),
        ("rods.axial_force = 0", "the name of the rod is missing; write rods.NAME.axial_force"),
        ("rods.AB.axial_force ≈ 1 ± x", "cannot be compared with '1 ± x'"),
        ("rods.AB.axial_force ≈ 1 ± -1", "at least 0"),
        ("rods.AB.axial_force ≈ 1 ± nan", "at least 0"),
        ("rods.AB.axial_force == 1", "'==' does not compare anything; write one of =, ≈"),
        ("rods.AB.axial_force != 1", "'!=' does not compare anything"),
    ],
)
def test_an_expectation_of_nothing_says_so(session: Session, text: str, words: str) -> None:
    with pytest.raises((LookupError, ValueError), match=words):
        session.expect(text)


def test_what_is_expected_holds_or_does_not(session: Session) -> None:
    for text in ("time <= 0", "time >= 0", "time ≈ 0 +/- 1e-9", "settings.time_step = null", " scene = pause "):
        session.expect(text)
    for text in ("time <= -1", "rods.AB.tensile_strength = none", "settings.time_step = 1"):
        with pytest.raises(AssertionError):
            session.expect(text)


def test_after_an_edit_or_settling_nothing_is_said_of_the_run_before(session: Session) -> None:
    session.run(until="rest")
    assert session.message.startswith("At rest since")
    session.particles["B"].force = (1.0, 0.0)
    assert session.message == ""
    session.run(until="rest")
    assert session.settle(1e6) == "collapse"
    assert "Plastic collapse" in session.message
    collapsing = Session.open("isostatic_collapse")
    assert collapsing.settle() == "collapse"
    assert "moving B along (0.71, −0.71)" in collapsing.message


def test_sessions_and_tables_tell_what_they_are(session: Session) -> None:
    assert repr(session) == "<Session 'isostatic': 3 particles, 3 rods, pause, t = 0 s>"
    assert repr(session.rods) == "<3 rods: AB, BC, CA>"
    assert repr(session.loads) == "<0 loads>"


def test_elements_of_another_model_are_refused(session: Session) -> None:
    """Their ids are those of other elements here: deleting a rod of one deleted a particle of the other."""
    other = Session.open("hyperstatic")
    stranger = other.rods["AC"]
    for change in (
        lambda: session.model.delete([stranger]),
        lambda: session.model.assign([stranger], "damping", 1.0),
        lambda: session.select(stranger),
    ):
        with pytest.raises(LookupError, match="rod AC> belongs to another model"):
            change()
    assert session.particles.names == ["A", "B", "C"]
    assert session.selected == []


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickle.dumps])
def test_sessions_and_models_are_not_copied_by_halves(session: Session, copied: Callable[[Any], Any]) -> None:
    for whole in (session, session.model):
        with pytest.raises(TypeError, match=r"cannot be copied or pickled\. Save"):
            copied(whole)


def test_what_no_script_can_mean_is_refused() -> None:
    session = Session.open("isostatic")
    with pytest.raises(ValueError, match=r"steps is 1000000000000000000000; it must be below 2\^63"):
        session.run(steps=10**21)
    with pytest.raises(ValueError, match="elapsed is nan; it must be a finite number"):
        session.frame(float("nan"))
    with pytest.raises(ValueError, match="Load factors are '1'; give at least one finite number"):
        session.settle("1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no 'simulated' among the comparisons; did you mean 'simulation'"):
        session.document.assessment.comparison().worst("simulated")
    with pytest.raises(ValueError, match="5 is not a model; give a file"):
        Session.open(5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="rod AB: There is no 'Q' among the particles"):
        session.rods["AB"].between = ("Q", "C")  # type: ignore[assignment]


def test_a_script_sees_what_there_is(session: Session, tmp_path: Path) -> None:
    assert {"stiffness", "count", "column"} <= set(dir(session.rods))
    assert repr(session.model).startswith("<Model 'Isostatic triangle': 3 particles, 3 rods, ")
    assert "theory='first-order'" in repr(session.settings)
    assert "t = 0 s after 0 steps" in repr(session.simulation)
    begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    for suffix, begin in begins.items():
        session.picture(tmp_path / f"x{suffix}")
        assert (tmp_path / f"x{suffix}").read_bytes().startswith(begin)
    assert session._repr_png_().startswith(begins[".png"])
    with pytest.raises(ValueError, match=r"\.xyz: choose a file that ends with one of \.png"):
        session.picture(tmp_path / "x.xyz")
    for size in ((0, 0), (-5, 100), (800.5, 600), (100_000, 100)):
        with pytest.raises(ValueError, match=f"{size[0]} x {size[1]} is no size of a picture"):
            session.picture(tmp_path / "x.png", size=size)


def test_a_window_of_another_size_shows_the_whole_model_until_somebody_looks_closer(session: Session) -> None:
    def all_seen() -> bool:
        room = session.view.canvas
        return all(room.contains((x, y)) for x, y in session.view.camera.to_pixels(session.particles.position))

    for size in ((640, 480), (2560, 1440), (400, 900)):
        session.resize(*size)
        assert all_seen()
    scale = session.view.camera.scale
    session.press("wheel up", (200.0, 450.0))
    session.resize(640, 480)
    assert session.view.camera.scale == pytest.approx(1.2 * scale)
    session.press("home")
    session.resize(1280, 800)
    assert all_seen()
    session.press("drag middle", (30.0, 0.0))
    centre = session.view.camera.centre
    session.resize(640, 480)
    assert session.view.camera.centre == centre


def test_any_time_may_be_given_for_a_run() -> None:
    session = Session.open("isostatic")
    assert session.run(time=1e91) == "at rest"
    with pytest.raises(ValueError, match=r"steps is 1\d+; it must be below 2\^63"):
        session.run(steps=10**91)


def test_more_steps_than_can_be_counted_are_begun() -> None:
    discs = [particle("A", 0, 0, velocity=[-1, 0]), particle("B", 1, 0, velocity=[1, 0])]
    session = Session.open(model(discs, [], settings={"time_step": 1e-30}))
    with interrupted_after(3.0), pytest.raises(KeyboardInterrupt):
        session.run(time=1e301)


def test_opening_a_model_leaves_the_current_world_of_esper_as_it_was() -> None:
    esper.switch_world("a script's own")
    try:
        model = Session.open("isostatic").model
        assert esper.current_world == "a script's own"
        model.activate()
        assert len(esper.get_component(Rod)) == model.rods.count
    finally:
        esper.switch_world("default")
        esper.delete_world("a script's own")
