"""Single steps that hold more than a person can wait for."""

import pytest

from pinjoint import Session
from pinjoint.editor.actions import time as actions
from pinjoint.systems.collision.free import flight
from tests.reference.models import model, particle

BOX = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
FAST = model(
    [particle("A", 0.5, 0.5, velocity=[1000.0, 300.0], radius=0.1), particle("B", 0.2, 0.8, radius=0.1)],
    [],
    components={"walls.Wall": [{"start": a, "end": b} for a, b in zip(BOX, BOX[1:] + BOX[:1], strict=True)]},
    settings={"restitution": 1.0, "time_step": 1.0},
)


@pytest.mark.parametrize("key", ["right", "shift+right"])
def test_a_step_with_too_many_impacts_is_refused_and_nothing_has_happened(
    key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flight, "EVENTS_AT_ONCE", 50)
    session, other = Session.open(FAST), Session.open(FAST)
    with monkeypatch.context() as patch:
        patch.setattr(actions, "MOST_IMPACTS", 100)
        session.press(key)
    assert "more than 100 impacts" in session.notice
    assert (session.time, session.model.clock.collisions, len(session.impacts)) == (0.0, 0, 0)
    session.step()  # a script waits
    other.step()
    assert session.model.clock.collisions == other.model.clock.collisions > 1000
    assert session.particles["A"].velocity == other.particles["A"].velocity
    session.undo()
    assert session.time == 0.0
