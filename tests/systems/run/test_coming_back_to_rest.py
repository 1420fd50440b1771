"""A run that came to rest is at rest at once wherever its state comes back: from undo, or from a file."""

from typing import Any

import pytest

from pinjoint import Session
from pinjoint.documents.document import document
from tests.reference.models import model, particle

Model = dict[str, Any]


def _fallen(drag: float) -> Model:
    """A disc that falls onto another."""
    return model(
        [particle("A", 0, 0, fixed=[True, True], radius=0.1), particle("B", 0, 0.5, radius=0.1, mass=1)],
        [],
        environment={"acceleration": [0, -9.81], "drag": drag},
        settings={"restitution": 0.2},
    )


CASES = {"rods": "isostatic", "flight": _fallen(0.0), "driven": _fallen(0.3)}
EACH = pytest.mark.parametrize("made", CASES.values(), ids=CASES)


def _at_rest(made: str | Model) -> Session:
    session = Session.open(made)
    assert session.run(until="rest") == "at rest"
    return session


def _assert_rests(session: Session, expected: Session) -> None:
    assert session.simulation.halted
    assert session.simulation.said == expected.simulation.said
    steps = session.model.clock.steps
    assert session.run(until="rest") == "at rest"
    assert session.model.clock.steps == steps == expected.model.clock.steps
    assert session.simulation.moved_until == expected.simulation.moved_until


@EACH
def test_a_saved_run_is_at_rest_at_once(made: str | Model) -> None:
    saved = _at_rest(made)
    _assert_rests(Session.open(document(saved.model)), saved)
    saved.run(time=1.0)  # passes without steps
    _assert_rests(Session.open(document(saved.model)), saved)


@EACH
def test_undo_comes_back_to_rest_at_once(made: str | Model) -> None:
    session, left = _at_rest(made), _at_rest(made)
    session.particles["B"].force = (1.0, 2.0)
    session.run(time=0.01)
    assert not session.model.clock.at_rest
    session.undo()
    session.undo()
    _assert_rests(session, left)
    session.undo()
    assert not session.model.clock.at_rest


def test_a_restart_does_not_rest() -> None:
    session = Session.open(document(_at_rest("isostatic").model))
    session.run(time=0.1)
    session.restart()
    session.particles["B"].force = (1.0, 2.0)
    assert session.run(until="rest") == "at rest"
    assert session.model.clock.steps > 96


@pytest.mark.parametrize(
    ("section", "change"),
    [
        ("particles", {"force": [0.5, 0.3]}),
        ("particles", {"velocity": [0.01, 0.0]}),
        ("rods", {"stiffness": 9e4}),
    ],
)
def test_a_file_changed_by_hand_goes_on(section: str, change: dict[str, Any]) -> None:
    saved = document(_at_rest("isostatic").model)
    for element in saved[section]:
        if not any(element.get("fixed", ())):
            element |= change
    session = Session.open(saved)
    assert session.run(steps=1) == "time reached"
    assert not session.model.clock.at_rest


def test_a_load_added_by_hand_lets_the_run_go_on() -> None:
    saved = document(_at_rest("isostatic").model)
    history = {"kind": "ramp", "start": 1.0, "duration": 0.5}
    saved["loads"] = [{"on": "B", "force": [0.0, -10.0], "history": history}]
    session = Session.open(saved)
    assert session.run(until="rest") == "at rest"
    assert session.time > 1.5
