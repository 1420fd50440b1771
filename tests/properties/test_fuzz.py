"""Some of everything that `python -m tests.properties.fuzz` tries, which has as many as one likes."""

from collections.abc import Callable

import pytest

from tests.properties import damage
from tests.properties.bounds import checked, fuzzing

PERSONS = "editing", "windows", "--actions"


def test_anything_that_a_person_does_interpreted(fresh_process: Callable[..., str]) -> None:
    interpreted = {"PINJOINT_COMPILE": "never"}
    fresh_process(fuzzing(*PERSONS, "150", "--count", "3", "--seed", "105"), interpreted, timeout=800.0)


def test_whatever_a_person_does_stays_within_arrays() -> None:
    """Every program is compiled for it, with checks: one person who does much, in one process."""
    done = checked(fuzzing(*PERSONS, "300", "--count", "1", "--seed", "50"))
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("first", range(0, 30, 5))
def test_any_damage_to_a_file(first: int) -> None:
    for seed in range(first, first + 5):
        damage.attempt(seed)
