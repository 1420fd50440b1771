"""GIFs of runs: every picture a later time, at the pace of the window, until the end."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from pinjoint.commands.command_line import main
from pinjoint.commands.render import FRAME, HELD, LONGEST
from pinjoint.session import Session
from pinjoint.systems.physics.pace import natural_pace


def opened(path: Path) -> Any:
    """A picture, with what only those that move have."""
    return Image.open(path)


def frames(path: Path) -> list[np.ndarray]:
    with opened(path) as image:
        pictures = []
        for number in range(image.n_frames):
            image.seek(number)
            pictures.append(np.asarray(image.convert("RGB"), dtype=np.int16))
        return pictures


def test_a_run_to_a_time_moves_from_the_first_picture_to_the_last(tmp_path: Path) -> None:
    path = tmp_path / "collision.gif"
    assert main(["render", "collision_iii", "--at", "0.5", "--output", str(path), "--size", "160x80"]) == 0
    pictures = frames(path)
    session = Session.open("collision_iii")
    assert len(pictures) == 1 + round(0.5 / natural_pace(session.model) / FRAME)
    assert {picture.shape for picture in pictures} == {(80, 160, 3)}
    changed = [np.abs(after - before).max() for before, after in pairwise(pictures)]
    assert min(changed) > 50
    with opened(path) as image:
        assert image.info["loop"] == 0
        assert image.info["duration"] == round(1000 * FRAME)
        image.seek(image.n_frames - 1)
        assert image.info["duration"] == round(1000 * HELD)


def test_a_run_to_rest_ends_at_rest_however_long_it_takes(tmp_path: Path) -> None:
    path = tmp_path / "isostatic.gif"
    assert main(["render", "isostatic", "--output", str(path), "--size", "64x48"]) == 0
    assert 2 < len(frames(path)) <= LONGEST / FRAME + 2


def test_a_file_that_cannot_be_written_is_explained(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    where = str(tmp_path / "no such folder" / "a.gif")
    assert main(["render", "collision_iii", "--at", "0.05", "--output", where, "--size", "64x48"]) == 2
    assert "cannot be written" in capsys.readouterr().err
