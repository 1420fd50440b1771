"""What is drawn of models with more elements than can be seen singly, and the fast forms of slow rules."""

import numpy as np
import pytest

from pinjoint.components.camera import Viewport
from pinjoint.components.model import Model
from pinjoint.components.tags import Selected
from pinjoint.components.view import View
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.occupancy import FAINT, STRONG, Occupancy
from pinjoint.systems.render.marks import Bars, Picture, Strokes
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.benchmarks.models import lattice

LIGHT = load_theme("light")


def view_of(model: Model) -> View:
    view = View(all_diagrams=True)
    view.camera.viewport = Viewport(0, 0, 1280, 800)
    view.fit(model)
    return view


def strokes(picture: Picture, colour: tuple[int, ...]) -> Strokes:
    (mark,) = [mark for mark in picture.marks if isinstance(mark, Strokes) and mark.colour == colour]
    return mark


def test_rods_too_short_for_diagrams_take_the_colour_of_their_force() -> None:
    model = lattice(60_000)
    force = np.zeros(model.rods.count)
    force[:100], force[100:300] = 5.0, -5.0
    model.writable("rods.axial_force")[...] = force
    model.tag_only([model.rods[0]], Selected)
    picture = compose(model, view_of(model), LIGHT)
    assert not [mark for mark in picture.marks if isinstance(mark, Bars)]
    found = {
        name: len(strokes(picture, getattr(LIGHT, name)).start) for name in ("tension", "compression", "ink")
    }
    assert found == {"tension": 100, "compression": 200, "ink": model.rods.count - 300}
    [halo] = [m for m in picture.marks if isinstance(m, Strokes) and m.colour[:3] == LIGHT.selected[:3]]
    assert len(halo.start) == 1
    assert {"tension (kN)", "compression (kN)"} <= set(picture.texts)
    assert any("zoom in to see force diagrams" in text for text in picture.texts)


def test_of_many_arrows_the_largest_of_each_square_is_drawn() -> None:
    model = lattice(20_000)
    force = np.zeros((model.particles.count, 2))
    force[:, 1] = -1.0
    largest = model.particles.count // 2
    force[largest] = (0.0, -2.0)
    model.writable("particles.applied_force")[...] = force
    view = view_of(model)
    picture = compose(model, view, LIGHT)
    at = strokes(picture, LIGHT.load).start
    assert 100 < len(at) < model.particles.count / 2
    x = view.camera.to_pixels(model.particles.position[largest])[0]
    assert np.abs(at[:, 0] - x).min() < 1e-9
    assert any("zoom in to see all loads and reactions" in text for text in picture.texts)
    view.camera.zoom(8.0, view.camera.middle)
    closer = compose(model, view, LIGHT)
    assert not any("all external forces" in text for text in closer.texts)


@pytest.mark.parametrize("seed", range(4))
def test_many_segments_are_clipped_as_each_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-2, 3, (60, 2))
    points[5], points[6, 1] = np.nan, np.inf
    ends = rng.integers(0, 60, (200, 2))
    low, high = np.zeros(2), np.ones(2)
    first, last = points[ends.T]
    start, end, rows = clip_segments(first, last, low, high)
    each = [clip_segments(points[[one]], points[[other]], low, high)[:2] for one, other in ends]
    np.testing.assert_array_equal(rows, [row for row, (one, _) in enumerate(each) if len(one)])
    np.testing.assert_array_equal(start, np.concatenate([one for one, _ in each]))
    np.testing.assert_array_equal(end, np.concatenate([other for _, other in each]))


@pytest.mark.parametrize("covering", [0, FAINT, STRONG])
def test_free_boxes_are_those_without_anything_in_them(covering: int) -> None:
    rng = np.random.default_rng(7)
    occupancy = Occupancy(Viewport(10, 20, 120, 90), 1.0)
    for _ in range(8):
        occupancy.block(*rng.uniform(0, 100, 2), *rng.uniform(2, 12, 2))
    start = rng.uniform(0, 130, (12, 2))
    occupancy.line(start, start + rng.uniform(-30, 30, (12, 2)), STRONG)
    occupancy.line(start + 9.0, start[::-1], FAINT)
    cells = occupancy.cells_of(rng.uniform(0, 130, (300, 2)), rng.uniform(1, 30, (300, 2)))
    blocked = occupancy.taken | (occupancy.lined > covering)
    expected = [not blocked[top:bottom, left:right].any() for left, top, right, bottom in cells.tolist()]
    assert 0 < sum(expected) < 300
    assert occupancy.are_free(cells, covering).tolist() == expected
