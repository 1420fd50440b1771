"""Some of everything that `python -m tests.properties.fuzz` tries, which has as many as one likes."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.properties import damage
from tests.properties.bounds import checked, fuzzing

PERSONS = (("editing", "--count", "5", "--actions", "200"), ("windows", "--count", "4", "--actions", "250"))


@pytest.mark.parametrize("words", PERSONS, ids=lambda words: words[0])
def test_anything_that_a_person_does_interpreted(
    words: tuple[str, ...], fresh_process: Callable[..., str]
) -> None:
    fresh_process(fuzzing(*words, "--seed", "105"), {"PINJOINT_COMPILE": "never"})


@pytest.mark.parametrize("words", PERSONS, ids=lambda words: words[0])
def test_whatever_a_person_does_stays_within_arrays(words: tuple[str, ...]) -> None:
    done = checked(fuzzing(*words, "--seed", "50"))
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("first", range(0, 30, 5))
def test_any_damage_to_a_file(first: int) -> None:
    for seed in range(first, first + 5):
        damage.attempt(seed)
