"""A few models of any numbers in every command; `python -m tests.properties.fuzz models` has as many as one likes."""

from pathlib import Path

import pytest

from tests.properties.hostile_models import Hostile, attempt


@pytest.mark.usefixtures("data")
@pytest.mark.parametrize("seed", range(24))
def test_every_command_answers_every_model(seed: int, tmp_path: Path) -> None:
    assert attempt(seed, tmp_path, patience=60.0) == ""


def test_a_seed_makes_the_same_model_and_command_every_time(tmp_path: Path) -> None:
    one, other = Hostile(7), Hostile(7)
    assert one.document() == other.document()
    assert one.words(tmp_path, "m") == other.words(tmp_path, "m")
