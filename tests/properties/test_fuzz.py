"""Some of everything that `python -m tests.properties.fuzz` tries, which has as many as one likes."""

from collections import Counter
from collections.abc import Callable

import pytest

from tests.properties import damage, solved_edits
from tests.properties.bounds import fuzzing

PERSONS = "editing", "windows", "--actions"


def test_anything_that_a_person_does_interpreted(fresh_process: Callable[..., str]) -> None:
    interpreted = {"PINJOINT_COMPILE": "never"}
    fresh_process(fuzzing(*PERSONS, "150", "--count", "3", "--seed", "105"), interpreted, timeout=800.0)


@pytest.mark.parametrize("first", range(0, 30, 5))
def test_any_damage_to_a_file(first: int) -> None:
    for seed in range(first, first + 5):
        damage.attempt(seed)


@pytest.mark.timeout(120)
@pytest.mark.parametrize(
    ("seed", "mending", "least", "most"),
    [(2, solved_edits.MENDING, 0.7, 0.95), (3, 0.0, 0.7, 1.0), (5, 0.0, 0.2, 0.5)],
)
def test_any_edits_in_statics(seed: int, mending: float, least: float, most: float) -> None:
    """Most states are stable, by construction, and some are not. 3: a rod a tenth too long that yields, 5: a structure with
    a slack cable that falls in on itself, took minutes."""
    seen = Counter[str]()
    solved_edits.attempt(seed, 60, seen, mending)
    assert least <= seen["stable"] / seen["states"] <= most


@pytest.mark.timeout(120)
@pytest.mark.parametrize("seed", [1, 3])
def test_any_edits_in_statics_of_frames_that_collapse(seed: int) -> None:
    """With plastic hinges and struts that buckle, which are drawn, too."""
    seen = Counter[str]()
    solved_edits.attempt(seed, 60, seen, edits=solved_edits.BEYOND_ELASTIC, bases=solved_edits.COLLAPSES)
    assert seen["inelastic"] > 0


@pytest.mark.timeout(120)
@pytest.mark.parametrize(("seed", "course"), [(2, solved_edits.ELASTIC), (17, solved_edits.COLLAPSING)])
def test_any_edits_in_statics_of_what_a_course_loads(seed: int, course: solved_edits.Course) -> None:
    """Cases, combinations, settlements by loads, loads between ends, springs and inclined supports, too."""
    seen = Counter[str]()
    solved_edits.attempt(seed, 60, seen, solved_edits.MENDING, *course)
    assert seen["compared"] > 0
