"""The compiled drawing of large pictures against areas, against small pictures, and within its bounds."""

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from pinjoint.components.camera import Viewport
from pinjoint.components.field import Vector
from pinjoint.systems.render.backends.kernels import BLOCK, cover_strokes
from pinjoint.systems.render.backends.pygame_canvas import Canvas, _fill, _pixel, _pixels
from pinjoint.systems.render.backends.raster import load_raster, stroke_coverage
from pinjoint.systems.render.marks import Bars, Discs, Fills, Mark, Picture, Points, Strokes

BLACK, WHITE = (0, 0, 0, 255), (255, 255, 255, 255)
SIZE = 40


def darkness(mark: Mark, viewport: Viewport = Viewport(0, 0, SIZE, SIZE)) -> NDArray[np.float64]:  # noqa: B008
    """How much of each pixel (column, row) of a small white picture a black mark of many parts covers."""
    surface = pygame.Surface((SIZE, SIZE), depth=32)
    surface.fill(WHITE)
    Canvas(load_raster).draw(surface, Picture(viewport, None, [mark]))
    return 1.0 - pygame.surfarray.array3d(surface)[:, :, 1] / 255.0


def many(part: Points, times: int = 400) -> Points:
    """A single part, and others that lie far outside."""
    return np.concatenate([part, np.full((times, *part.shape[1:]), -1e4)])


def random_strokes(number: int, seed: int) -> tuple[Points, Points]:
    rng = np.random.default_rng(seed)
    start = rng.uniform(-10, SIZE + 10, (number, 2))
    return start, start + rng.uniform(-12, 12, (number, 2))


@pytest.mark.parametrize("width", [0.3, 1.0, 2.5, 7.0])
def test_strokes_are_those_of_small_pictures(width: float) -> None:
    start, end = random_strokes(60, 1)
    expected = np.zeros((SIZE, SIZE))
    x, y, amount = stroke_coverage(start, end, width)
    inside = (x >= 0) & (x < SIZE) & (y >= 0) & (y < SIZE)
    expected[x[inside], y[inside]] = amount[inside] / 255.0
    far = np.tile([[-1e4, 0.0]], (3000, 1)), np.tile([[-2e4, 0.0]], (3000, 1))
    mark = Strokes(np.concatenate([start, far[0]]), np.concatenate([end, far[1]]), width, BLACK)
    assert np.abs(darkness(mark) - expected).max() < 1.5 / 255.0  # sums of float32 there, of float64 here


@pytest.mark.parametrize("spread", [3.0, 30.0, 9000.0])
def test_polygons_are_those_of_pygame(spread: float) -> None:
    rng, found, expected = np.random.default_rng(2), *(pygame.Surface((SIZE, SIZE), depth=32) for _ in "12")
    for opacity in (0, 1, 40, 229, 254, 255) * 10:
        corners = rng.normal(SIZE / 2, spread, (3, int(rng.integers(3, 20)), 2))
        colour = (*rng.integers(0, 256, 3).tolist(), opacity)
        load_raster().fills(_pixels(found), (4, 3, 30, 40), Fills(corners, colour), _pixel(found, colour))
        expected.set_clip((4, 3, 26, 37))
        _fill(expected, corners, colour)
        assert found.get_buffer().raw == expected.get_buffer().raw


def test_translucent_strokes_do_not_add_up_where_they_cross() -> None:
    cross = np.array([[5.0, 20.0], [20.0, 5.0]]), np.array([[35.0, 20.0], [20.0, 35.0]])
    start, end = (np.tile(ends, (500, 1)) for ends in cross)
    found = darkness(Strokes(start, end, 4.0, (0, 0, 0, 51)))
    assert found.max() == pytest.approx(0.2, abs=0.003)


def bars(start: Vector, end: Vector, height: float, times: int = 400) -> tuple[Points, Points, Points]:
    """Start, end and rise of one bar, and others that lie far outside."""
    (dx, dy), places = np.subtract(end, start), np.array([start, end], dtype=np.float64)
    rise = np.array([[-dy, dx]]) * height / np.hypot(dx, dy)
    first, last = (many(place[None], times) for place in places)
    return first, last, np.concatenate([rise, np.full((times, 2), 3.0)])


@pytest.mark.parametrize("height", [0.2, 1.0, 7.0, -7.0])
@pytest.mark.parametrize("seed", range(5))
def test_bars_have_their_area(seed: int, height: float) -> None:
    """Σ of what one covers of all pixels is its area, to the rounding of each pixel it has an edge in."""
    start, end = np.random.default_rng(seed).uniform(10, SIZE - 10, (2, 2))
    length = float(np.hypot(*(end - start)))
    found = float(darkness(Bars(*bars(start, end, height), BLACK)).sum())
    edges = 2.0 * (length + abs(height)) + 10.0
    assert found == pytest.approx(length * abs(height), abs=0.5 * edges / 255)


def test_an_upright_bar_is_exact_in_every_pixel() -> None:
    expected = np.zeros((SIZE, SIZE))
    expected[3:9, 5:8] = np.outer([0.75, 1, 1, 1, 1, 1], [1, 1, 0.5])
    for start, end, height in (
        ((3.25, 5.0), (9.0, 5.0), 2.5),
        ((3.25, 7.5), (9.0, 7.5), -2.5),
        ((3.25, 5.0), (3.25, 7.5), -5.75),
        ((9.0, 7.5), (9.0, 5.0), -5.75),
    ):
        found = darkness(Bars(*bars(start, end, height), BLACK))
        np.testing.assert_allclose(found, expected, atol=0.5 / 255 + 1e-9)


def test_bars_look_like_those_of_small_pictures() -> None:
    """Which are rounded to whole pixels: these are."""
    mark = Bars(*bars((4.0, 6.0), (12.0, 6.0), 5.0), BLACK)
    few = Bars(mark.start[:1], mark.end[:1], mark.rise[:1], BLACK)
    inside = (slice(5, 12), slice(7, 11))  # polygons of whole pixels take in their last ones
    np.testing.assert_array_equal(darkness(few)[inside], darkness(mark)[inside])
    assert darkness(few).sum() == pytest.approx(darkness(mark).sum(), abs=14.0)


def test_bars_of_no_size_are_not_there() -> None:
    place = np.full((400, 2), 20.0)
    assert not darkness(Bars(place, place, np.zeros_like(place), BLACK)).any()
    assert not darkness(Bars(place, place, place, BLACK)).any()
    assert not darkness(Bars(place, place + 5.0, np.zeros_like(place), BLACK)).any()


def test_bars_lie_over_each_other() -> None:
    start, end, rise = bars((3.0, 5.0), (9.0, 5.0), 3.0)
    start, end, rise = (np.concatenate([part[:1], part]) for part in (start, end, rise))
    found = darkness(Bars(start, end, rise, (0, 0, 0, 128)))
    assert found[5, 6] == pytest.approx(0.75, abs=0.005)


@pytest.mark.parametrize("radius", [1.25, 2.0, 5.5, 12.0])
def test_discs_have_their_area(radius: float) -> None:
    at = np.random.default_rng(3).uniform(15, 25, (1, 2))
    mark = Discs(many(at), np.full(401, radius), BLACK, WHITE)
    assert darkness(mark).sum() == pytest.approx(np.pi * radius**2, rel=0.03)


@pytest.mark.parametrize("rim", [0.0, 1.75])
def test_discs_look_like_those_of_small_pictures(rim: float) -> None:
    at = np.random.default_rng(4).uniform(2, SIZE - 2, (20, 2))
    few, lots, moved = (
        darkness(Discs(places, np.full(len(places), 5.0), BLACK, WHITE, rim))
        for places in (at, many(at), at + 0.5)
    )
    assert np.abs(few - lots).mean() < 0.5 * np.abs(few - moved).mean()


@pytest.mark.parametrize(
    "mark",
    [
        Strokes(np.full((3000, 2), -50.0), np.full((3000, 2), 90.0), 3.0, BLACK),
        Bars(
            np.full((400, 2), -50.0),
            np.tile([[90.0, -50.0]], (400, 1)),
            np.tile([[0.0, 140.0]], (400, 1)),
            BLACK,
        ),
        Discs(np.full((400, 2), 20.0), np.full(400, 60.0), BLACK, WHITE),
    ],
    ids=["strokes", "bars", "discs"],
)
def test_nothing_is_drawn_outside_of_the_viewport(mark: Mark) -> None:
    found = darkness(mark, Viewport(10, 15, 12, 9))
    assert found[10:22, 15:24].max() == 1.0
    found[10:22, 15:24] = 0.0
    assert not found.any()


def test_surfaces_of_other_sizes_come_next() -> None:
    canvas = Canvas(load_raster)
    box = bars((0.0, 0.0), (90.0, 0.0), 90.0)
    for size in ((30, 20), (50, 60), (10, 10)):
        surface = pygame.Surface(size, depth=32)
        surface.fill(WHITE)
        start, end = np.full((3000, 2), (-5.0, 5.0)), np.full((3000, 2), (95.0, 5.0))
        marks: list[Mark] = [Bars(*box, (255, 0, 0, 255)), Strokes(start, end, 2.0, BLACK)]
        canvas.draw(surface, Picture(Viewport(0, 0, *size), None, marks))
        assert surface.get_at((size[0] - 1, size[1] - 1))[:3] == (255, 0, 0)
        assert surface.get_at((size[0] - 1, 5))[:3] == (0, 0, 0)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (300.0, 0.0), (-300.0, 0.0), (0.0, 900.0), (0.0, -900.0)])
def test_what_strokes_can_reach_lies_within_the_clip(shift: Vector) -> None:
    """Blocks beyond the last column would be read, and cleared, wherever strokes lie to the right of a window."""
    start = np.array([[10.0, 20.0], [90.0, 300.0]]) + shift
    end = np.array([[50.0, 20.0], [170.0, 10.0]]) + shift
    cover, touched = np.zeros((360, 160), dtype=np.uint8), np.zeros((360, 160 // BLOCK), dtype=np.uint8)
    left, top, right, bottom = cover_strokes.py_func(cover, touched, (5, 7, 160, 360), start, end, 2.0)
    assert 5 <= left <= right <= 160
    assert 7 <= top <= bottom <= 360
