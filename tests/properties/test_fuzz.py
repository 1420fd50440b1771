"""Some of everything that `python -m tests.properties.fuzz` tries, which has as many as one likes."""

from collections.abc import Callable

import pytest

from tests.properties import damage
from tests.properties.bounds import fuzzing

PERSONS = "editing", "windows", "--actions"


def test_anything_that_a_person_does_interpreted(fresh_process: Callable[..., str]) -> None:
    interpreted = {"PINJOINT_COMPILE": "never"}
    fresh_process(fuzzing(*PERSONS, "150", "--count", "3", "--seed", "105"), interpreted, timeout=800.0)


@pytest.mark.parametrize("first", range(0, 30, 5))
def test_any_damage_to_a_file(first: int) -> None:
    for seed in range(first, first + 5):
        damage.attempt(seed)
