"""Force diagrams in a picture."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.tags import DiagramShown
from pinjoint.systems.render.marks import Bars, Fills, Picture, Strokes
from pinjoint.systems.render.model.diagrams import diagram_factor, scale_step
from pinjoint.systems.render.picture import compose
from tests.systems.render.pictures import LIGHT, fill, marks_of, picture_of, triangle, view_of


def test_values_of_the_thesis_triangle() -> None:
    texts = picture_of(triangle(), all_diagrams=True).texts
    for value in ("−28.34", "−198.0", "20.07", "120.0", "20.01", "140.0"):
        assert f"{value} kN" in texts
    assert {"120 kN", "160 kN"} <= set(texts)  # the load at B, as it was given
    assert {"A", "B", "C", "AB", "BC", "CA"} <= set(texts)


def test_diagram_heights_are_proportional_to_forces_and_shrink_together() -> None:
    model = triangle()
    for scale in (0.1, 1.0, 7.0):
        model.settings.diagram_scale = scale
        picture = picture_of(model, all_diagrams=True)
        (red,) = marks_of(picture, Bars, LIGHT.tension)
        (blue,) = marks_of(picture, Bars, LIGHT.compression)
        corners = np.concatenate([blue.corners, red.corners])
        heights = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
        factor = diagram_factor(198.02746, 0.0, scale, 0.15 * 600)
        np.testing.assert_allclose(heights, np.array([28.34277, 198.02746, 20.0679]) * scale * factor)
        note = [text for text in picture.texts if "diagrams ×" in text]
        assert bool(note) == (factor != 1.0)
        assert all(f"diagrams ×{factor:g}" in text for text in note)


@given(st.floats(1e-3, 1e9), st.floats(1e-3, 1e3), st.floats(1.0, 500.0))
def test_scale_step_fits_and_wastes_no_more_than_a_step(largest: float, scale: float, room: float) -> None:
    factor = scale_step(largest, scale, room)
    assert room / 2.001 < largest * scale * factor <= room * (1 + 1e-9)


@given(st.floats(0.0, 1e9), st.floats(0.0, 1e9), st.floats(1e-3, 1e3), st.floats(10.0, 500.0))
def test_diagrams_always_fit_and_keep_their_scale_where_it_will_do(
    largest: float, loads: float, scale: float, room: float
) -> None:
    factor = diagram_factor(largest, loads, scale, room)
    assert largest * scale * factor <= room * (1 + 1e-9)
    if largest * scale <= room and not 1e-4 < loads < 0.05 * room:
        assert factor == 1.0
    if factor > 1.0:
        assert loads * factor <= 0.3 * room * (1 + 1e-9)


def test_diagrams_of_small_loads_are_enlarged_and_stay_so_while_the_forces_vibrate() -> None:
    model = triangle()
    fill(model, "particles.constant_force", [(0, 0), (0.12, -0.16), (0, 0)])
    notes = []
    for share in (1e-9, 0.5e-3, 1e-3):
        fill(model, "rods.axial_force", np.array([-28.34277, -198.02746, 20.0679]) * share)
        notes += [text for text in picture_of(model, all_diagrams=True).texts if "diagrams ×" in text]
    assert len(notes) == 3
    assert len(set(notes)) == 1


def test_diagrams_stand_outside_of_the_structure() -> None:
    picture = picture_of(triangle(), all_diagrams=True)
    middle = view_of(triangle()).camera.to_pixels((1.0, 1.0 / 3.0))
    diagrams = [corners for bars in marks_of(picture, Bars) for corners in bars.corners]
    assert len(diagrams) >= 3
    for corners in diagrams:
        on_rod, off_rod = (corners[0] + corners[3]) / 2, (corners[1] + corners[2]) / 2
        assert np.linalg.norm(off_rod - middle) > np.linalg.norm(on_rod - middle)


def test_a_rod_without_force_is_black_and_reads_zero() -> None:
    model = triangle()
    fill(model, "rods.axial_force", [0.0, -1e-7, 1.0])
    picture = picture_of(model, all_diagrams=True)
    (black,) = marks_of(picture, Bars, LIGHT.zero)
    assert len(black.corners) == 2
    assert LIGHT.zero[:3] == (0, 0, 0)
    assert picture.texts.count("0 kN") == 2


def test_only_marked_elements_show_their_diagrams() -> None:
    model = triangle()
    model.tag_only([model.rods["CA"], model.particles["A"]], DiagramShown)
    texts = picture_of(model).texts
    assert "20.07 kN" in texts
    assert "20.01 kN" in texts
    assert not {"−28.34 kN", "−198.0 kN", "120.0 kN"} & set(texts)


def arrows_of(picture: Picture, colour: tuple[int, ...]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Tails and tips of the arrows of one colour."""
    heads = [tip for mark in marks_of(picture, Fills, colour) for tip in mark.corners[:, 0]]
    lines = [mark for mark in marks_of(picture, Strokes) if mark.colour == colour]
    return list(zip([tail for mark in lines for tail in mark.start], heads, strict=True))


def test_arrows_point_along_the_force_and_meet_the_rim() -> None:
    model = Model()
    model.create(Particle, 4, position=[(0, 0), (1, 0), (2, 0), (3, 0)])
    fill(model, "particles.applied_force", [(1.0, 0), (0, 2.0), (-3.0, 0), (0, -0.00009)])
    fill(model, "particles.reaction", [(0, 0), (0, 0), (0, 0), (0.00011, 0)])
    view = view_of(model)
    assert not arrows_of(compose(model, view, LIGHT), LIGHT.load)
    view.all_diagrams = True
    picture = compose(model, view, LIGHT)
    found = [*arrows_of(picture, LIGHT.load), *arrows_of(picture, LIGHT.reaction)]
    pixels = view.camera.to_pixels(model.particles.position)
    radius = 0.05 * view.camera.scale
    by_row = {int(np.argmin(np.abs(pixels[:, 0] - tail[0]))): (tail, tip - tail) for tail, tip in found}
    along = {0: (1, 0), 1: (0, -1), 2: (-1, 0), 3: (1, 0)}
    for row, (tail, whole) in by_row.items():
        np.testing.assert_allclose(whole / np.hypot(*whole), along[row], atol=1e-9)
        assert np.linalg.norm(tail - pixels[row]) == pytest.approx(radius + 2.0)
    lengths = {row: np.hypot(*whole) for row, (_, whole) in by_row.items()}
    assert lengths[2] == pytest.approx(1.5 * lengths[1])
    assert {"1 kN", "2 kN", "3 kN", "0.0001100 kN"} <= set(picture.texts)
