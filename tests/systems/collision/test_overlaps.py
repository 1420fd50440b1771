"""Overlaps: they are parted in portions, and what they will cost is counted before."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.session import Session
from pinjoint.systems.collision import overlaps
from pinjoint.systems.collision.overlaps import PARTING, work_ahead
from pinjoint.systems.program import compiler
from pinjoint.systems.program.compiler import LONGEST_WORK, Choice, Compile, Unfinished

COUNT = 40


@pytest.fixture(autouse=True)
def _no_deadline() -> Iterator[None]:
    yield
    Choice.deadline = math.inf


def crowd(count: int = COUNT, side: float = 0.3) -> Session:
    session = Session(Model())
    session.model.create(Particle, count, position=np.random.default_rng(1).uniform(0.0, side, (count, 2)))
    return session


def test_parting_that_a_frame_leaves_goes_on_to_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, session, left = crowd(), crowd(), 0
    whole.simulation.advance(0)
    monkeypatch.setattr(overlaps, "LONGEST_WORK", 1)
    monkeypatch.setattr(overlaps, "WORK_AT_ONCE", 1)
    Choice.deadline = 0.0
    while not session.simulation.armed:
        try:
            session.simulation.advance(0)
        except Unfinished:
            left += 1
            assert (session.particles.displacement == 0.0).all()
    assert left > 10
    assert session.particles.displacement.tobytes() == whole.particles.displacement.tobytes()
    assert session.simulation.note == whole.simulation.note != ""


def test_parting_begins_anew_after_an_edit() -> None:
    session = crowd()
    Choice.deadline = 0.0
    with pytest.raises(Unfinished):
        session.simulation.advance(0)
    session.particles[0].position = (9.0, 9.0)
    Choice.deadline = math.inf
    session.simulation.advance(0)
    assert tuple(session.particles[0].displacement) == (0.0, 0.0)


def test_work_ahead_is_counted() -> None:
    assert work_ahead(crowd(290, 1.0).model)[0] > LONGEST_WORK
    assert work_ahead(crowd(2).model)[1] == 0
    row = Session(Model())
    row.model.create(Particle, 290, position=[(0.1 * i, 0.0) for i in range(290)])
    parting, impacts = work_ahead(row.model)
    assert parting == 0
    assert impacts > LONGEST_WORK
    assert work_ahead(Session.open("newtons_cradle").model)[1] < LONGEST_WORK


def test_what_is_long_is_not_begun_interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded: list[str] = []
    monkeypatch.setattr(Choice, "compile", Compile.SOON)
    monkeypatch.setattr(PARTING, "_compiled", False)
    monkeypatch.setattr(PARTING, "_patience", 0.0)
    monkeypatch.setattr(compiler.GeneratedModule, "load_or_tell", lambda module: loaded.append(module.name))
    session = crowd(290, 1.0)
    Choice.deadline = 0.0
    with pytest.raises(Unfinished):
        session.simulation.advance(0)
    assert "parting" in loaded
