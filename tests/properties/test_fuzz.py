"""A few sessions of somebody who does anything; `python -m tests.properties.fuzz` has as many as one likes."""

from __future__ import annotations

from pathlib import Path

import pytest

from game.documents import library
from tests.properties.fuzz import Fuzz


@pytest.mark.parametrize("seed", [105, 110, 114, 120, 130])
def test_anything_that_a_person_does(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(library.DATA_VARIABLE, str(tmp_path))  # set back afterwards
    monkeypatch.chdir(tmp_path)
    Fuzz(seed, tmp_path).run(200)
