"""A run that is watched: what is done to a large model is seen before the run gets ready to go on."""

from __future__ import annotations

from game import Session
from tests.benchmarks.models import lattice

FRAME = 1.0 / 60.0


def test_an_edit_of_a_large_model_is_shown_before_the_run_gets_ready() -> None:
    session = Session(lattice(2_500, damping=1.0))
    session.press("space")
    session.frame(FRAME)
    assert not session.simulation.armed
    for _ in range(6):
        session.frame(FRAME)
    assert session.model.clock.steps > 0
    session.particles[0].force = (0.0, -1.0)
    session.frame(FRAME)
    assert not session.simulation.armed
    session.frame(FRAME)
    assert session.simulation.armed
    before = session.model.clock.steps
    for _ in range(6):
        session.frame(FRAME)
    assert session.model.clock.steps > before


def test_a_small_model_goes_on_at_once() -> None:
    session = Session.open("hyperstatic")
    session.press("space")
    session.frame(FRAME)
    assert session.model.clock.steps > 0
