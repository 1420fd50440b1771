"""Who is near whom is looked up when the document changes or particles have moved, not in every step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from game import Session
from systems.collision import vicinity
from systems.near import FEW, near_pairs
from tests.benchmarks.models import lattice


def test_a_step_looks_up_nothing_and_an_edit_does(monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session(lattice(200, damping=1.0))
    session.step()
    looked: list[Any] = []

    def looked_up(*where: Any) -> Any:
        looked.append(where)
        return near_pairs(*where)

    monkeypatch.setattr(vicinity, "near_pairs", looked_up)
    for _ in range(5):
        session.step()
    assert not looked
    session.particles[3].radius = 0.06
    session.step()
    assert looked


@pytest.mark.parametrize("count", [20, FEW + 20])
@pytest.mark.parametrize("sizes", [(0.05,), (0.05, 0.3), (0.001, 0.02, 0.02, 0.4)])
def test_all_pairs_within_reach_are_found_once_and_in_order(sizes: tuple[float, ...], count: int) -> None:
    random = np.random.default_rng(len(sizes))
    place, reach = random.uniform(0.0, 2.0, (count, 2)), random.choice(sizes, count)
    place[:2], reach[:2] = [(0.1, 0.1), (0.4, 0.5)], 0.25  # these just touch
    pairs = [
        (i, j)
        for i in range(count)
        for j in range(i + 1, count)
        if np.hypot(*(place[j] - place[i])) <= reach[i] + reach[j]
    ]
    assert (0, 1) in pairs
    assert near_pairs(place, reach).tolist() == [list(pair) for pair in pairs]


def test_no_discs_are_near_no_discs() -> None:
    assert near_pairs(np.zeros((0, 2)), np.zeros(0)).shape == (0, 2)
