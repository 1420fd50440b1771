"""Particles, rods, supports and grids in a picture."""

import numpy as np
import pytest

from pinjoint.components.camera import Camera
from pinjoint.components.grid import Grid
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.tags import Hovered, Selected
from pinjoint.components.view import View
from pinjoint.components.world import Derivation
from pinjoint.systems.render.marks import Bars, Discs, Fills, Panel, Stamps, Strokes, Text
from pinjoint.systems.render.model.supports import DOWN, LEFT, NO_SUPPORT, RIGHT, UP, freest_sides
from pinjoint.systems.render.picture import compose
from tests.systems.render.pictures import LIGHT, fill, marks_of, picture_of, triangle, view_of


def test_ghost_appears_only_when_displacements_are_seen() -> None:
    model = triangle()
    model.writable("particles.displacement")[1] = (0.001, 0.0)
    assert not marks_of(picture_of(model), Strokes, LIGHT.ghost)
    model.settings.displacement_scale = 100.0
    assert marks_of(picture_of(model), Strokes, LIGHT.ghost)


def test_particle_radius_is_to_scale_and_never_too_small_to_hit() -> None:
    model = Model()
    model.create(Particle, 2, position=[(0, 0), (1, 0)], radius=[0.05, 0.01])
    view = View(camera=Camera(centre=(0.5, 0.0), scale=200.0))
    (discs,) = marks_of(compose(model, view, LIGHT), Discs)
    radii = dict(zip(discs.at[:, 0].round().tolist(), discs.radius.tolist(), strict=True))
    assert radii == {200: 10.0, 400: 5.0}


def test_selection_hovering_and_yielding_show() -> None:
    model = triangle()
    model.rods["BC"].compressive_strength = 198.0
    model.rods["CA"].compressive_strength = 198.0
    fill(model, "rods.yielding", [False, True, True])
    model.tag_only([model.rods["BC"], model.particles["A"]], Selected)
    model.tag_only([model.rods["AB"]], Hovered)
    picture = picture_of(model, pointer=(0.0, 0.0))
    view = view_of(model)
    a, b, c = view.camera.to_pixels(model.particles.position)
    strokes = reversed(marks_of(picture, Strokes))  # the first of each colour, since the legend comes later
    opaque = {s.colour: s for s in strokes if s.colour[3] == 255}
    np.testing.assert_allclose(opaque[LIGHT.yielding].end[0], c)  # BC, though it is selected
    np.testing.assert_allclose(opaque[LIGHT.yielding].start[1], c)
    halos = [*marks_of(picture, Strokes, LIGHT.hover), *marks_of(picture, Strokes, LIGHT.selected)]
    assert all(halo.colour[3] < 128 and halo.width > 3 * opaque[LIGHT.ink].width for halo in halos)
    np.testing.assert_allclose([halo.start[0] for halo in halos], [a, b])
    (glow,) = [discs for discs in marks_of(picture, Discs) if discs.ink[:3] == LIGHT.selected[:3]]
    np.testing.assert_allclose(glow.at, [a])
    assert {discs.ink for discs in marks_of(picture, Discs) if discs.rim} == {LIGHT.ink}


def test_cables_are_thin_and_slack_ones_dashed() -> None:
    model = triangle()
    model.rods["BC"].tension_only = model.rods["CA"].tension_only = True
    fill(model, "rods.axial_force", [-1.0, 2.0, 0.0])
    view = view_of(model)
    a, b, c = view.camera.to_pixels(model.particles.position)
    dashes, bars, cables = [s for s in marks_of(picture_of(model), Strokes) if s.colour == LIGHT.ink][:3]
    np.testing.assert_allclose([bars.start[0], bars.end[0]], [a, b])
    np.testing.assert_allclose([cables.start[0], cables.end[0]], [b, c])
    assert cables.width < bars.width
    np.testing.assert_allclose([dashes.start[0], dashes.end[-1]], [c, a])
    gaps = np.hypot(*(dashes.start[1:] - dashes.end[:-1]).T)
    assert len(gaps) > 3
    assert (gaps > 2.0).all()
    assert "slack cable" in picture_of(model).texts


def test_derived_columns_are_read_only_when_needed() -> None:
    model = triangle()

    def refuse(world: object) -> None:
        raise AssertionError("computed although nothing shows it")

    columns = ("rods.axial_force", "rods.yielding", "particles.applied_force", "particles.reaction")
    model.derive(Derivation(columns, ("particles.position",), refuse))
    picture_of(model)
    with pytest.raises(AssertionError, match="nothing shows it"):
        picture_of(model, all_diagrams=True)


@pytest.mark.parametrize(
    ("fixed", "crowd", "side"),
    [
        ((False, False), (0, 0, 0, 0), NO_SUPPORT),
        ((False, True), (0, 0, 0, 0), DOWN),
        ((False, True), (0, 1, 0, 0), UP),
        ((True, False), (0, 0, 0, 0), LEFT),
        ((True, False), (0, 0, 1, 0), RIGHT),
        ((True, True), (1, 0, 0, 1), DOWN),
        ((True, True), (1, 1, 0, 0), LEFT),
        ((True, True), (0, 1, 1, 0), RIGHT),
    ],
)
def test_supports_stand_where_no_rod_is(fixed: tuple, crowd: tuple, side: int) -> None:
    at_left = np.array([False])
    assert freest_sides(np.array([fixed]), np.array([crowd], dtype=float), at_left).tolist() == [side]


def test_what_is_symmetrical_has_symmetrical_supports() -> None:
    """Three bars that hang from a ceiling; two columns held along x."""
    hanging = [[0.5, 0.5, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.5, 0.5, 0.0]]
    held = np.ones((3, 2), dtype=bool)
    right = np.array([False, False, True])
    assert freest_sides(held, np.array(hanging), right).tolist() == [LEFT, UP, RIGHT]
    upright, along_x = np.array([[0.0, 1.0, 0.0, 1.0]] * 2), np.array([[True, False]] * 2)
    assert freest_sides(along_x, upright, np.array([False, True])).tolist() == [LEFT, RIGHT]


@pytest.mark.filterwarnings("error")
def test_positions_that_are_no_numbers_are_left_out() -> None:
    model = triangle()
    model.writable("particles.displacement")[1] = (np.nan, np.inf)
    picture = picture_of(model, all_diagrams=True)
    assert "20.07 kN" in picture.texts
    assert "−28.34 kN" not in picture.texts
    for mark in picture.marks:
        for name in ("start", "end", "at", "corners"):
            assert np.isfinite(getattr(mark, name, 0.0)).all()


@pytest.mark.parametrize("scale", [1e-3, 0.37, 3.0, 100.0, 5000.0])
def test_grid_lines_keep_a_distance_and_lie_on_multiples(scale: float) -> None:
    model = Model()
    model.create(Grid, 1, name=["grid 1"], spacing=[(0.5, 0.25)])
    view = View(camera=Camera(centre=(0.3, 0.1), scale=scale))
    drawn = marks_of(compose(model, view, LIGHT), Panel, LIGHT.grid)
    lines = np.array([mark[:4] for mark in drawn]).reshape(-1, 4)
    for axis, spacing, centre, flip in ((0, 0.5, 0.3, 1), (1, 0.25, 0.1, -1)):
        at = np.sort(lines[lines[:, 2 + axis] == 1, axis])
        assert (np.diff(at) >= 7).all()
        multiples = ((at - 300.0) / (flip * scale) + centre) / spacing
        assert np.abs(multiples - np.round(multiples)).max(initial=0.0) <= 0.51 / (scale * spacing) + 1e-9


def test_selected_grid_is_red_and_hidden_grids_are_not_drawn() -> None:
    model = Model()
    first, second = model.create(Grid, 2, name=["grid 1", "grid 2"], shown=[True, False])
    assert LIGHT.grid[:3] == (200, 200, 200)
    lines = len(marks_of(picture_of(model), Panel, LIGHT.grid))
    for selected in ([first], [first, second]):
        model.tag_only(selected, Selected)
        assert len(marks_of(picture_of(model), Panel, LIGHT.selected)) == lines > 0
        assert not marks_of(picture_of(model), Panel, LIGHT.grid)


@pytest.mark.parametrize("radius", [150.0, 1e5, 1e11, 1e30])
def test_discs_of_any_size_are_drawn_by_few_lines(radius: float) -> None:
    model = Model()
    model.create(Particle, 3, position=[(-radius, 0), (0, 0), (1, 0)], radius=[radius, 0.1, 0.1])
    view = View(camera=Camera(centre=(0.5, 0.0), scale=200.0))
    low, high = view.camera.viewport.left, view.camera.viewport.left + view.camera.viewport.width
    rims = marks_of(compose(model, view, LIGHT), Strokes, LIGHT.ink)
    points = np.concatenate([np.empty((0, 2)), *(rim.start for rim in rims), *(rim.end for rim in rims)])
    assert len(points) < 20_000
    assert (points >= low - 10).all()
    assert (points <= high + 10).all()
    if radius < 1e12:  # beyond, its edge is not known to a pixel
        assert len(points)
        edge = view.camera.to_pixels((0.0, 0.0))
        np.testing.assert_allclose(points[:, 0], edge[0], atol=5.0)


def test_every_mark_of_an_element_says_whose_it_is() -> None:
    model = triangle()
    model.tag_only([model.rods["AB"]], Selected)
    fill(model, "particles.displacement", [(0, 0), (0.5, 0), (0, 0)])
    picture = picture_of(model, all_diagrams=True, legend=False)
    marks = [mark for mark in picture.marks if mark.of]
    places = {Strokes: "start", Bars: "start", Stamps: "at", Discs: "at", Fills: "corners"}
    for mark in marks:
        if isinstance(mark, Panel | Text):
            continue
        assert len(mark.of[1]) == len(getattr(mark, places[type(mark)]))
    said = {(mark.text, *mark.of) for mark in marks if isinstance(mark, Text)}
    assert {
        ("−28.34 kN", "rods", 0),
        ("BC", "rods", 1),
        ("C", "particles", 2),
        ("20.01 kN", "particles", 0),
    } <= said
    anonymous = [mark for mark in picture.marks if getattr(mark, "of", None) is None]
    assert not [mark for mark in anonymous if isinstance(mark, Bars | Stamps | Discs)]
