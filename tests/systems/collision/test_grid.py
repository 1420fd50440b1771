"""The grid of boxes finds what a look at all pairs finds, whatever their sizes."""

import numpy as np
import pytest

from pinjoint.systems.collision.columns import NONE, Count, Grid, Number
from pinjoint.systems.collision.kernels.grid import enter, leave, neighbours, set_layers


def grid_of(boxes: np.ndarray) -> tuple[Grid, np.ndarray]:
    """A grid of boxes, shape (n, 4), in which none is entered, and the counts that tell its layers."""
    numbers, counts = np.zeros(len(Number)), np.zeros(len(Count), dtype=np.int64)
    grid = Grid.empty(len(boxes), 64)
    grid.boxes[:] = boxes
    set_layers(grid, numbers, counts)
    grid.heads[:] = NONE
    return grid, counts


def found(i: int, grid: Grid, layers: int) -> list[int]:
    count = neighbours(i, grid, layers, 0)
    return grid.found[:count].tolist()


@pytest.mark.parametrize("spread", [0.0, 1.0, 6.0])
@pytest.mark.parametrize("away", [0.0, -1e6])
def test_a_search_finds_each_box_that_overlaps_once(spread: float, away: float) -> None:
    """Sizes differ up to 10^spread times, and a fifth of the boxes have left the grid."""
    random = np.random.default_rng(5)
    corner = random.uniform(-5.0, 5.0, (120, 2)) + away
    size = 0.5 * 10.0 ** random.uniform(-spread, 0.0, (120, 1)) * random.uniform(0.3, 1.0, (120, 2))
    boxes = np.hstack([corner, corner + size])
    grid, counts = grid_of(boxes)
    layers = int(counts[Count.LAYERS])
    for i in range(120):
        enter(i, grid, layers)
    for i in range(0, 120, 5):
        leave(i, grid, layers)
    pairs = set()
    for i in range(120):
        near = found(i, grid, layers)
        assert len(near) == len(set(near))
        pairs |= {(min(i, j), max(i, j)) for j in near}
    low, high = boxes[:, None, :2], boxes[:, None, 2:]
    overlap = ((low <= high[:, 0]) & (low.transpose(1, 0, 2) <= high)).all(axis=2)
    inside = np.arange(120) % 5 > 0
    expected = {(i, j) for i, j in np.argwhere(overlap).tolist() if i < j and (inside[i] or inside[j])}
    both = {(i, j) for i, j in expected if inside[i] and inside[j]}
    assert both <= pairs <= expected
