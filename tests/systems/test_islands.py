"""Which particles move together, found quickly and by walking from rod to rod."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pinjoint.documents import models
from pinjoint.systems.islands import IMMOVABLE, islands
from tests.reference.models import model, particle, rod


def walked(count: int, pairs: list[tuple[int, int]], held: set[int]) -> list[int]:
    """The same, one particle and one rod at a time."""
    found = [IMMOVABLE] * count
    number = 1
    for start in range(count):
        if start in held or found[start] != IMMOVABLE:
            continue
        waiting = [start]
        while waiting:
            at = waiting.pop()
            found[at] = number
            beside = [b if a == at else a for a, b in pairs if at in (a, b)]
            waiting += [other for other in beside if other not in held and found[other] == IMMOVABLE]
        number += 1
    return found


@given(st.data())
def test_islands_are_what_one_can_walk_to_without_passing_supports(data: st.DataObject) -> None:
    count = data.draw(st.integers(1, 12))
    rows = st.integers(0, count - 1)
    pairs = data.draw(st.lists(st.tuples(rows, rows).filter(lambda p: p[0] < p[1]), unique=True, max_size=16))
    held = data.draw(st.sets(rows, max_size=4))
    made = models.load(
        model(
            [particle(f"p{i}", i, i * i, fixed=[i in held] * 2) for i in range(count)],
            [rod(f"p{a}", f"p{b}") for a, b in pairs],
        )
    )
    assert islands(made).tolist() == walked(count, pairs, held)


def test_trusses_on_one_support_are_two_islands_and_on_one_roller_one() -> None:
    nodes = [particle("A", 0, 0), particle("B", 1, 0), particle("C", 2, 0)]
    rods = [rod("A", "B"), rod("B", "C")]
    for fixed, expected in (([True, True], [1, IMMOVABLE, 2]), ([False, True], [1, 1, 1])):
        nodes[1]["fixed"] = fixed
        assert islands(models.load(model(nodes, rods))).tolist() == expected


def test_a_long_chain_numbered_at_random_is_one_island() -> None:
    order = np.random.default_rng(5).permutation(500).tolist()
    nodes = [particle(f"p{i}", i, 0) for i in range(500)]
    chain = model(nodes, [rod(f"p{a}", f"p{b}") for a, b in itertools.pairwise(order)])
    assert set(islands(models.load(chain)).tolist()) == {1}


def test_an_empty_model_has_no_islands() -> None:
    assert islands(models.load(model([], []))).tolist() == []
