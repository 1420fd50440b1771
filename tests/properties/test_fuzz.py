"""A few of everything that `python -m tests.properties.fuzz` tries, which has as many as one likes."""

from __future__ import annotations

from pathlib import Path

import pytest

from game.documents import library, preferences
from systems.input import pygame_input
from tests.properties import damage
from tests.properties.fuzz import Fuzz
from tests.properties.windows import Monkey


@pytest.mark.parametrize("seed", [105, 110, 114, 120, 130])
def test_anything_that_a_person_does(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(library.DATA_VARIABLE, str(tmp_path))  # set back afterwards
    monkeypatch.chdir(tmp_path)
    Fuzz(seed, tmp_path).run(200)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_anything_that_a_person_does_to_a_window(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(library.DATA_VARIABLE, str(tmp_path))
    monkeypatch.setenv(preferences.CONFIG_VARIABLE, str(tmp_path))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pygame_input, "IDLE_PAUSE", 0.0)
    Monkey(seed, tmp_path).run(100)


@pytest.mark.parametrize("first", range(0, 30, 5))
def test_any_damage_to_a_file(first: int) -> None:
    for seed in range(first, first + 5):
        damage.attempt(seed)
