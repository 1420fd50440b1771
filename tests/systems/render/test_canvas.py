"""Pictures on a surface, without a display."""

import numpy as np
import pygame
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint.components.camera import Camera, Viewport
from pinjoint.components.tags import Selected
from pinjoint.components.view import Status, View
from pinjoint.systems.render.backends.pygame_canvas import Canvas, _rounded, _small_rounded
from pinjoint.systems.render.backends.raster import stroke_coverage
from pinjoint.systems.render.marks import Fills, Panel, Picture, Stamps, Strokes, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.typography import WEIGHTS, text_width
from tests.properties.limits import within
from tests.systems.render.pictures import LIGHT, triangle


def blank(width: int = 600, height: int = 600) -> pygame.Surface:
    return pygame.Surface((width, height), 0, 32)


def colour_at(surface: pygame.Surface, pixel: object) -> tuple[int, ...]:
    x, y = np.round(np.asarray(pixel)).astype(int).tolist()
    return tuple(surface.get_at((x, y)))[:3]


def test_the_triangle_on_a_surface() -> None:
    model = triangle()
    model.tag_only([model.rods["BC"]], Selected)
    view = View(camera=Camera(centre=(1.0, 0.5), scale=200.0))
    surface = blank()
    Canvas().draw(surface, compose(model, view, LIGHT))
    pixels = view.camera.to_pixels
    assert colour_at(surface, pixels((0.5, 0.5))) == LIGHT.ink[:3]
    assert colour_at(surface, pixels((1.5, 0.5))) == LIGHT.ink[:3], "a selected rod keeps its colour"
    halo = colour_at(surface, np.add(pixels((1.5, 0.5)), [-3, 3]))
    assert max(halo) - min(halo) < 30, "and has a halo of grey"
    assert 120 < min(halo) < 230
    assert colour_at(surface, pixels((1.0, 1.0))) == LIGHT.hollow[:3]
    assert max(colour_at(surface, pixels((1.0, 1.0)) - [10, 0])) < 80  # the rim, from 8.25 to 10 px
    assert colour_at(surface, pixels((1.0, 0.6))) == LIGHT.background[:3]


def test_nothing_is_drawn_outside_of_the_viewport() -> None:
    surface = blank()
    surface.fill((1, 2, 3))
    view = View(camera=Camera(centre=(1.0, 0.5), scale=900.0, viewport=Viewport(150, 200, 300, 250)))
    view.heading, view.status = "A rather long heading", Status(state="running", problem="Too long a step.")
    Canvas().draw(surface, compose(triangle(), view, LIGHT))
    outside = pygame.surfarray.array3d(surface)
    assert (outside[150:450, 200:450] != [1, 2, 3]).any()
    outside[150:450, 200:450] = (1, 2, 3)
    assert (outside == [1, 2, 3]).all()


def test_the_same_picture_gives_the_same_pixels() -> None:
    view = View(camera=Camera(centre=(1.0, 0.5), scale=200.0), all_diagrams=True, heading="Pause")
    canvas, other = Canvas(), Canvas()
    images = []
    for drawing in (canvas, canvas, other):
        surface = blank()
        drawing.draw(surface, compose(triangle(), view, LIGHT))
        images.append(pygame.image.tobytes(surface, "RGB"))
    assert images[0] == images[1] == images[2]


@pytest.mark.parametrize("size", [10, 11, 12, 13, 20, 24, 40])
@pytest.mark.parametrize("weight", WEIGHTS)
def test_layout_and_font_agree_on_widths(size: int, weight: str) -> None:
    font = Canvas()._font(size, weight)
    for text in ("−198.03 kN", "t = 1.234 ms", "Press P to place a particle", "Σ ω₁ ← → é Ж"):
        drawn = font.size(text)[0]
        assert text_width(text, size, weight) == pytest.approx(drawn, abs=1 + 0.012 * drawn)


def test_figures_and_signs_that_are_needed_exist() -> None:
    font = Canvas()._font(12, "regular")
    assert None not in font.metrics("0123456789−×µ°±≤≥≈∞ΔΣλωσε²³₀₁₂←→↑↓·…–—°é")


@pytest.mark.parametrize(("anchor", "left"), [("left", 100), ("centre", 75), ("right", 50)])
def test_texts_stand_at_their_anchor(anchor: str, left: int) -> None:
    surface = blank(200, 60)
    text = "HHHH"
    size = 20
    width = text_width(text, size)
    picture = Picture(
        Viewport(0, 0, 200, 60),
        (255, 255, 255, 255),
        [Text(text, 100, 30, size, (0, 0, 0, 255), anchor=anchor)],
    )
    Canvas().draw(surface, picture)
    dark = np.argwhere(pygame.surfarray.array3d(surface)[:, :, 0] < 128)
    expected = 100 - {"left": 0.0, "centre": 0.5, "right": 1.0}[anchor] * width
    assert dark[:, 0].min() == pytest.approx(expected, abs=3)
    assert (dark[:, 1].min() + dark[:, 1].max() + 1) / 2 == pytest.approx(30, abs=1)


@pytest.mark.parametrize("size", [(1, 1), (9, 40), (15, 16), (120, 31), (300, 200)])
@pytest.mark.parametrize("radius", [0.0, 4.0, 7.5])
@pytest.mark.parametrize("outline", [None, (10, 20, 30, 90)])
def test_a_stretched_box_is_the_one_drawn_as_a_whole(
    size: tuple[int, int], radius: float, outline: tuple[int, int, int, int] | None
) -> None:
    panel = Panel(0, 0, *size, radius, (255, 250, 240, 219), outline)
    stretched, whole = _rounded(size, panel), _small_rounded(size, panel)
    assert pygame.image.tobytes(stretched, "RGBA") == pygame.image.tobytes(whole, "RGBA")


pixel = st.floats(20, 80)


@settings(deadline=None)
@given(pixel, pixel, pixel, pixel, st.floats(1.0, 8.0))
def test_strokes_cover_their_area(ax: float, ay: float, bx: float, by: float, width: float) -> None:
    """Σ coverage = length × width up to rounding each pixel to 1/255; ends are cut upright or level."""
    start, end = np.array([[ax, ay]]), np.array([[bx, by]])
    x, y, amount = stroke_coverage(start, end, width)
    length = float(np.hypot(bx - ax, by - ay))
    pixels = len(amount) + 2 * length + 10
    assert amount.sum() / 255 == pytest.approx(length * width, abs=0.5 / 255 * pixels * 1.5 + 0.01)
    assert len(set(zip(x.tolist(), y.tolist(), strict=True))) == len(x)
    backwards = stroke_coverage(end, start, width)
    np.testing.assert_array_equal(np.sort(amount), np.sort(backwards[2]))


def test_a_level_stroke_is_exact() -> None:
    x, y, amount = stroke_coverage(np.array([[2.0, 5.0]]), np.array([[6.0, 5.0]]), 3.0)
    covered = dict(zip(zip(x.tolist(), y.tolist(), strict=True), amount.tolist(), strict=True))
    assert covered == {(c, r): 255 if r in (4, 5) else 128 for c in range(2, 6) for r in (3, 4, 5, 6)}


def test_crossing_strokes_leave_no_notch() -> None:
    surface = blank(60, 60)
    strokes = Strokes(
        np.array([[5.0, 5.0], [5.0, 55.0]]), np.array([[55.0, 55.0], [55.0, 5.0]]), 4.0, (0, 0, 0, 255)
    )
    Canvas().draw(surface, Picture(Viewport(0, 0, 60, 60), (255, 255, 255, 255), [strokes]))
    middle = pygame.surfarray.array3d(surface)[28:32, 28:32]
    assert (middle == 0).all()


def test_many_strokes_are_all_drawn() -> None:
    rng = np.random.default_rng(0)
    start = rng.uniform(10, 500, (20_000, 2))
    surface = blank()
    strokes = Strokes(start, start + np.array([9.0, 7.0]), 1.0, (0, 0, 0, 255))
    Canvas().draw(surface, Picture(Viewport(0, 0, 600, 600), (255, 255, 255, 255), [strokes]))
    middles = (start + np.array([4.5, 3.5])).astype(int)
    dark = pygame.surfarray.array3d(surface)[:, :, 0]
    assert (dark[middles[:, 0], middles[:, 1]] < 200).mean() > 0.95


@pytest.mark.parametrize("turns", range(4))
def test_symbols_turn(turns: int) -> None:
    surface = blank(80, 80)
    stamp = Stamps("arrow", np.array([[40.0, 40.0]]), 20.0, 1.0, (0, 0, 0, 255), (0, 0, 0, 255), turns)
    Canvas().draw(surface, Picture(Viewport(0, 0, 80, 80), (255, 255, 255, 255), [stamp]))
    dark = np.argwhere(pygame.surfarray.array3d(surface)[:, :, 0] < 128) + 0.5
    step = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)][turns])
    along, across = (dark - 40) @ step, (dark - 40) @ step[::-1]
    assert along.min() == pytest.approx(0.5, abs=0.6)
    assert along.max() == pytest.approx(19.0, abs=1.0)
    assert np.abs(across).max() == pytest.approx(3.5, abs=0.6)
    assert along[np.abs(across) > 2].min() > 11  # the head is at the far end


def test_opacity_and_colour_of_a_stamped_disc() -> None:
    surface = blank(40, 40)
    disc = Stamps("disc", np.array([[20.0, 20.0]]), 8.0, 1.0, (255, 0, 0, 51), (255, 0, 0, 51))
    Canvas().draw(surface, Picture(Viewport(0, 0, 40, 40), (255, 255, 255, 255), [disc]))
    red, green, blue = colour_at(surface, (20, 20))
    assert red == 255
    assert green == pytest.approx(204, abs=2)
    assert blue == pytest.approx(204, abs=2)


@pytest.mark.parametrize(
    "name", ["a\0b", "\ud800", "\u202e", "\u0301", "x" * 1_000_000, "\x1b[31m\n\t", "🏗", ""]
)
def test_any_name_is_drawn(name: str) -> None:
    """Names in a file may hold anything; what fonts cannot draw ended the window."""
    surface = pygame.Surface((100, 40), depth=32)
    with within(20.0):
        Canvas().draw(
            surface,
            Picture(Viewport(0, 0, 100, 40), (255, 255, 255, 255), [Text(name, 5.0, 20.0, 13, (0, 0, 0, 255))]),
        )
    drawn = pygame.surfarray.array2d(surface) != surface.map_rgb((255, 255, 255))
    assert drawn.any() == (name != "")


@pytest.mark.parametrize("reach", [3e4, 4e4, 1e6])
def test_what_is_filled_may_reach_far_beyond_the_window(reach: float) -> None:
    """A diagram of which a person looks at a small part."""
    surface = blank(100, 100)
    corners = np.array([[[-reach, 40.0], [reach, 40.0], [reach, 60.0], [-reach, 60.0]]])
    Canvas().draw(
        surface, Picture(Viewport(0, 0, 100, 100), (255, 255, 255, 255), [Fills(corners, (0, 0, 255, 255))])
    )
    assert colour_at(surface, (50, 50)) == colour_at(surface, (2, 58)) == (0, 0, 255)
    assert colour_at(surface, (50, 30)) == colour_at(surface, (50, 70)) == (255, 255, 255)


@pytest.mark.filterwarnings("ignore:invalid value")
def test_a_picture_that_cannot_be_drawn_leaves_the_surface_to_others() -> None:
    surface, clip = pygame.Surface((40, 30), depth=32), pygame.Rect(0, 0, 40, 30)
    lines = np.array([[np.nan, 0.0]])
    marks = [Strokes(lines, lines + 5.0, 2.0, LIGHT.ink)]
    with pytest.raises(ValueError, match="NaN"):
        Canvas().draw(surface, Picture(Viewport(0, 0, 20, 30), LIGHT.panel, marks))
    assert surface.get_clip() == clip
