"""Every mode looks as it did when a person last looked at it; see regenerate.py for a wanted change.

Fonts are drawn a little differently by other versions of the drawing library, so pictures are compared as
seen from a distance: each is blurred by averaging squares of 4 by 4 pixels.
"""

from pathlib import Path

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from tests.golden.scenes import FOLDER, GOLDEN, drawn

MEAN_DIFFERENCE = 2.5  # of 255, per channel
CLEARLY_DIFFERENT = 25.0  # of 255, in any channel of a square
MOST_DIFFERENT = 0.005  # share of squares that may be clearly different
SQUARE = 4


def blurred(surface: pygame.Surface) -> NDArray[np.float64]:
    """Means of squares of pixels, shape (width / 4, height / 4, 3)."""
    pixels = pygame.surfarray.array3d(surface).astype(np.float64)
    width, height = pixels.shape[0] // SQUARE, pixels.shape[1] // SQUARE
    means: NDArray[np.float64] = pixels.reshape(width, SQUARE, height, SQUARE, 3).mean(axis=(1, 3))
    return means


def difference(one: pygame.Surface, other: pygame.Surface) -> tuple[float, float]:
    """The mean difference per channel, and the share of squares that are clearly different."""
    apart = np.abs(blurred(one) - blurred(other))
    return float(apart.mean()), float((apart.max(axis=2) > CLEARLY_DIFFERENT).mean())


@pytest.mark.parametrize("name", GOLDEN)
def test_it_looks_as_it_did(name: str, tmp_path: Path) -> None:
    found = drawn(*GOLDEN[name])
    golden = pygame.image.load(FOLDER / f"{name}.png")
    mean, share = difference(found, golden)
    if mean >= MEAN_DIFFERENCE or share >= MOST_DIFFERENT:
        pygame.image.save(found, tmp_path / f"{name}.png")
        pytest.fail(
            f"{name} looks different (mean {mean:.2f} of 255, {100 * share:.2f} % of squares): compare "
            f"{tmp_path / name}.png with {FOLDER / name}.png. If that is wanted: python -m tests.golden.regenerate"
        )


def test_there_is_no_picture_of_nothing() -> None:
    assert {path.stem for path in FOLDER.glob("*.png")} == set(GOLDEN)


def test_small_changes_are_noticed() -> None:
    """Everything 3 px to the right; a toolbar without icons."""
    golden = pygame.image.load(FOLDER / "pause.png")
    moved = golden.copy()
    moved.scroll(3, 0)
    assert difference(golden, moved)[1] > MOST_DIFFERENT
    gone = golden.copy()
    gone.fill(golden.get_at((1, 1)), (0, 0, 67, 480))
    assert difference(golden, gone)[1] > MOST_DIFFERENT


def test_the_pictures_are_small() -> None:
    for path in FOLDER.glob("*.png"):
        assert path.stat().st_size < 100_000
