"""Who is near whom is looked up when the document changes or particles have moved, not in every step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from game import Session
from systems.collision import vicinity
from tests.benchmarks.models import lattice


def test_a_step_looks_up_nothing_and_an_edit_does(monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session(lattice(200, damping=1.0))
    session.step()
    looked: list[Any] = []
    near_pairs: Callable[..., Any] = vicinity.near_pairs
    monkeypatch.setattr(vicinity, "near_pairs", lambda *where: looked.append(where) or near_pairs(*where))
    for _ in range(5):
        session.step()
    assert not looked
    session.particles[3].radius = 0.06
    session.step()
    assert looked
