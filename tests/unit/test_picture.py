"""What a picture consists of, without a window."""

from __future__ import annotations

import itertools
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from components.camera import Camera, Viewport
from components.grid import Grid
from components.model import Model
from components.particle import Particle
from components.rod import spawn_rods
from components.tags import DiagramShown, Hovered, Selected
from components.view import Status, View
from components.world import Derivation
from systems.render.clip import clip_segments
from systems.render.diagrams import diagram_factor, scale_step, written
from systems.render.labels import half_size
from systems.render.marks import Discs, Fills, Panel, Picture, Rectangles, Stamps, Strokes, Text
from systems.render.overlays import written_length, written_speed, written_time
from systems.render.picture import compose, drawn_positions
from systems.render.supports import DOWN, LEFT, NO_SUPPORT, RIGHT, UP, freest_sides
from systems.render.theme import load_theme, theme_from, theme_names
from systems.render.typography import shortened, text_width, wrapped

LIGHT = load_theme("light")


def triangle() -> Model:
    """The thesis' isostatic triangle with its exact forces."""
    model = Model()
    fixed = [(False, True), (False, False), (True, True)]
    model.create(Particle, 3, name=["A", "B", "C"], position=[(0, 0), (1, 1), (2, 0)], fixed=fixed)
    spawn_rods(model, [(0, 1), (1, 2), (2, 0)], name=["AB", "BC", "CA"])
    fill(model, "rods.axial_force", [-28.34277, -198.02746, 20.0679])
    fill(model, "particles.applied_force", [(0, 0), (120, -160), (0, 0)])
    fill(model, "particles.reaction", [(0, 20.01479), (0, 0), (-120, 139.98521)])
    return model


def fill(model: Model, column: str, values: object) -> None:
    """Give a derived column values, whatever would otherwise compute it."""
    rows = np.asarray(values)

    def write(world: object) -> None:
        model.writable(column)[...] = rows

    model.derive(Derivation((column,), ("particles.position",), write))


def view_of(model: Model, width: int = 600, height: int = 600, **options: object) -> View:
    """A view that shows all of a model."""
    view = View(camera=Camera(viewport=Viewport(0, 0, width, height)), **options)
    view.camera.fit(np.asarray(model.particles.position), 90.0 * view.pixel_ratio)
    return view


def picture_of(model: Model, **options: object) -> Picture:
    return compose(model, view_of(model, **options), LIGHT)


def marks_of(picture: Picture, kind: type, colour: tuple[int, ...] | None = None) -> list:
    marks = [mark for mark in picture.marks if isinstance(mark, kind)]
    return [mark for mark in marks if colour is None or mark.colour[:3] == colour[:3]]


def text_boxes(picture: Picture, unit: float = 1.0) -> list[tuple[str, float, float, float, float]]:
    """Every text with the box (left, top, right, bottom) of its letters."""
    boxes = []
    for mark in marks_of(picture, Text):
        width = text_width(mark.text, mark.size, mark.weight)
        left = mark.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[mark.anchor] * width
        boxes.append((mark.text, left, mark.y - mark.size / 2, left + width, mark.y + mark.size / 2))
    return boxes


def overlapping(boxes: list[tuple[str, float, float, float, float]]) -> list[tuple[str, str]]:
    return [
        (a[0], b[0])
        for a, b in itertools.combinations(boxes, 2)
        if a[1] < b[3] and b[1] < a[3] and a[2] < b[4] and b[2] < a[4]
    ]


# --- rods and particles ----------------------------------------------------------------------------


def test_composing_needs_no_pygame() -> None:
    code = "import sys, systems.render.picture; print('pygame' in sys.modules, 'numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_drawn_positions_scale_displacements() -> None:
    model = triangle()
    model.writable("particles.displacement")[1] = (0.01, -0.02)
    model.settings.displacement_scale = 10.0
    np.testing.assert_allclose(drawn_positions(model), [(0, 0), (1.1, 0.8), (2, 0)], rtol=1e-15)


def test_rods_are_drawn_between_drawn_positions() -> None:
    model = triangle()
    model.writable("particles.displacement")[1] = (0.01, -0.02)
    model.settings.displacement_scale = 10.0
    view = view_of(model)
    (rods,) = marks_of(compose(model, view, LIGHT), Strokes, LIGHT.ink)
    pixels = view.camera.to_pixels(drawn_positions(model))
    np.testing.assert_allclose(rods.start, pixels[[0, 1, 2]], rtol=1e-12)
    np.testing.assert_allclose(rods.end, pixels[[1, 2, 0]], rtol=1e-12)


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
    model.tag(model.rods["BC"], Selected)
    model.tag(model.particles["A"], Selected)
    model.tag(model.rods["AB"], Hovered)
    picture = picture_of(model)
    view = view_of(model)
    a, _, c = view.camera.to_pixels(model.particles.position)
    strokes = reversed(marks_of(picture, Strokes))  # the first of each colour, since the legend comes later
    opaque = {s.colour: s for s in strokes if s.colour[3] == 255}
    np.testing.assert_allclose(opaque[LIGHT.selected].end[0], c)  # selected wins over yielding
    np.testing.assert_allclose(opaque[LIGHT.yielding].start[0], c)
    (halo,) = marks_of(picture, Strokes, LIGHT.hover)
    assert halo.colour[3] < 128
    np.testing.assert_allclose(halo.start[0], a)
    (ring,) = [discs for discs in marks_of(picture, Discs) if discs.rim and discs.ink == LIGHT.selected]
    np.testing.assert_allclose(ring.at, [a])


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
    assert freest_sides(np.array([fixed]), np.array([crowd], dtype=float)).tolist() == [side]


def test_supports_touch_the_rim_from_outside() -> None:
    model = triangle()
    view = view_of(model)
    stamps = {s.symbol: s for s in marks_of(compose(model, view, LIGHT), Stamps)}
    pixels = view.camera.to_pixels(model.particles.position)
    radius = 0.05 * view.camera.scale
    for symbol, row in (("roller", 0), ("pinned", 2)):
        assert stamps[symbol].turns == DOWN
        np.testing.assert_allclose(stamps[symbol].at, [pixels[row] + [0, radius - 1]])


def test_positions_that_are_no_numbers_are_left_out() -> None:
    model = triangle()
    model.writable("particles.displacement")[1] = (np.nan, np.inf)
    picture = picture_of(model, all_diagrams=True)
    assert "20.07 kN" in picture.texts
    assert "−28.34 kN" not in picture.texts
    for mark in picture.marks:
        for name in ("start", "end", "at", "corners"):
            assert np.isfinite(getattr(mark, name, 0.0)).all()


# --- grid ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [1e-3, 0.37, 3.0, 100.0, 5000.0])
def test_grid_lines_keep_a_distance_and_lie_on_multiples(scale: float) -> None:
    model = Model()
    model.create(Grid, 1, name=["grid 1"], spacing=[(0.5, 0.25)])
    view = View(camera=Camera(centre=(0.3, 0.1), scale=scale))
    (lines,) = marks_of(compose(model, view, LIGHT), Rectangles, LIGHT.grid)
    for axis, spacing, centre, flip in ((0, 0.5, 0.3, 1), (1, 0.25, 0.1, -1)):
        at = np.sort(lines.boxes[lines.boxes[:, 2 + axis] == 1, axis])
        assert (np.diff(at) >= 7).all()
        multiples = ((at - 300.0) / (flip * scale) + centre) / spacing
        assert np.abs(multiples - np.round(multiples)).max(initial=0.0) <= 0.51 / (scale * spacing) + 1e-9


def test_selected_grid_is_red_and_hidden_grids_are_not_drawn() -> None:
    model = Model()
    first, second = model.create(Grid, 2, name=["grid 1", "grid 2"], shown=[True, False])
    assert LIGHT.grid[:3] == (200, 200, 200)
    assert len(marks_of(picture_of(model), Rectangles, LIGHT.grid)) == 1
    model.tag(first, Selected)
    assert len(marks_of(picture_of(model), Rectangles, LIGHT.selected)) == 1
    model.tag(second, Selected)
    assert len(marks_of(picture_of(model), Rectangles, LIGHT.selected)) == 1


# --- force diagrams --------------------------------------------------------------------------------


def test_values_of_the_thesis_triangle() -> None:
    texts = picture_of(triangle(), all_diagrams=True).texts
    for value in ("−28.34", "−198.03", "20.07", "120.00", "160.00", "20.01", "139.99"):
        assert f"{value} kN" in texts
    assert texts.count("120.00 kN") == 2  # the load at B and the reaction at C
    assert {"A", "B", "C", "AB", "BC", "CA"} <= set(texts)


def test_diagram_heights_are_proportional_to_forces_and_shrink_together() -> None:
    model = triangle()
    for scale in (0.1, 1.0, 7.0):
        model.settings.diagram_scale = scale
        picture = picture_of(model, all_diagrams=True)
        (red,) = marks_of(picture, Fills, LIGHT.tension)
        (blue,) = marks_of(picture, Fills, LIGHT.compression)
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
    diagrams = [corners for fills in marks_of(picture, Fills) for corners in fills.corners if len(corners) == 4]
    assert len(diagrams) >= 3
    for corners in diagrams:
        on_rod, off_rod = (corners[0] + corners[3]) / 2, (corners[1] + corners[2]) / 2
        assert np.linalg.norm(off_rod - middle) > np.linalg.norm(on_rod - middle)


def test_a_rod_without_force_is_black_and_reads_zero() -> None:
    model = triangle()
    fill(model, "rods.axial_force", [0.0, -1e-7, 1.0])
    picture = picture_of(model, all_diagrams=True)
    (black,) = marks_of(picture, Fills, LIGHT.zero)
    assert len(black.corners) == 2
    assert LIGHT.zero[:3] == (0, 0, 0)
    assert picture.texts.count("0.00 kN") == 2


def test_only_marked_elements_show_their_diagrams() -> None:
    model = triangle()
    model.tag(model.rods["CA"], DiagramShown)
    model.tag(model.particles["A"], DiagramShown)
    texts = picture_of(model).texts
    assert "20.07 kN" in texts
    assert "20.01 kN" in texts
    assert not {"−28.34 kN", "−198.03 kN", "120.00 kN"} & set(texts)


def test_arrows_point_along_the_force_and_meet_the_rim() -> None:
    model = Model()
    model.create(Particle, 4, position=[(0, 0), (1, 0), (2, 0), (3, 0)])
    fill(model, "particles.applied_force", [(1.0, 0), (0, 2.0), (-3.0, 0), (0, -0.00009)])
    fill(model, "particles.reaction", [(0, 0), (0, 0), (0, 0), (0.00011, 0)])
    view = view_of(model)
    arrows = [s for s in marks_of(compose(model, view, LIGHT), Stamps) if s.symbol == "arrow"]
    assert not arrows
    view.all_diagrams = True
    picture = compose(model, view, LIGHT)
    arrows = [s for s in marks_of(picture, Stamps) if s.symbol == "arrow" and s.size == 20.0]
    pixels = view.camera.to_pixels(model.particles.position)
    radius = 0.05 * view.camera.scale
    by_row = {int(np.argmin(np.abs(pixels[:, 0] - at[0]))): (s.turns, at) for s in arrows for at in s.at}
    assert {row: turns for row, (turns, _) in by_row.items()} == {0: RIGHT, 1: UP, 2: LEFT, 3: RIGHT}
    for row, (_, at) in by_row.items():
        assert np.linalg.norm(at - pixels[row]) == pytest.approx(radius + 2.0)
    assert {"1.00 kN", "2.00 kN", "3.00 kN", "0.0001 kN"} <= set(picture.texts)
    assert all(s.ink[:3] == (0, 100, 255) for s in arrows)


def test_a_load_on_a_crowded_side_pushes_from_the_free_one() -> None:
    """The load on top of the triangle stands above it; its head ends at the rim."""
    model = triangle()
    view = view_of(model, all_diagrams=True)
    arrows = [s for s in marks_of(compose(model, view, LIGHT), Stamps) if s.symbol == "arrow"]
    top = view.camera.to_pixels((1.0, 1.0))
    (down,) = [s for s in arrows if s.turns == DOWN]
    np.testing.assert_allclose(down.at, [top - [0, 0.05 * view.camera.scale + 2.0 + 20.0]])


@pytest.mark.parametrize(
    ("force", "text"),
    [(-28.34277, "−28.34"), (198.0, "198.00"), (-0.0049, "0.00"), (0.0, "0.00"), (-0.005001, "−0.01")],
)
def test_written_forces(force: float, text: str) -> None:
    assert written(force) == text


# --- labels ----------------------------------------------------------------------------------------


def random_model(seed: int, particles: int, rods: int) -> Model:
    rng = np.random.default_rng(seed)
    model = Model()
    model.create(
        Particle, particles, position=rng.uniform(0, 4, (particles, 2)), fixed=rng.random((particles, 2)) < 0.2
    )
    pairs = np.array(list(itertools.combinations(range(particles), 2)))
    chosen = rng.choice(len(pairs), min(rods, len(pairs)), replace=False)
    spawn_rods(model, pairs[chosen])
    fill(model, "rods.axial_force", rng.normal(0, 100, len(chosen)))
    fill(model, "particles.applied_force", rng.normal(0, 50, (particles, 2)))
    return model


@settings(deadline=None, max_examples=40)
@given(
    st.integers(0, 10_000),
    st.integers(2, 30),
    st.sampled_from([(600, 600, 1.0), (1280, 800, 1.0), (320, 240, 1.0), (1200, 1200, 2.0), (200, 500, 1.0)]),
    st.booleans(),
)
def test_texts_never_overlap_and_stay_in_the_viewport(seed: int, n: int, size: tuple, problem: bool) -> None:
    width, height, ratio = size
    model = random_model(seed, n, 3 * n)
    model.tag(model.rods[0], Selected)
    status = Status(
        1.2e-3, 1e-3, "running", "Esc stops", "It diverged: a time step of 1 s is too large." * problem
    )
    view = view_of(model, width, height, heading="Pause", all_diagrams=True, pixel_ratio=ratio, status=status)
    picture = compose(model, view, LIGHT)
    boxes = text_boxes(picture)
    assert overlapping(boxes) == []
    for text, left, top, right, bottom in boxes:
        assert left >= -1, text
        assert top >= -1, text
        assert right <= width + 1, text
        assert bottom <= height + 1, text


def test_values_lie_clear_of_one_anothers_backing() -> None:
    picture = picture_of(random_model(3, 25, 70), width=1000, height=800, all_diagrams=True)
    pills = [m for m in marks_of(picture, Panel) if m.fill[3] == round(255 * 0.86)]
    boxes = [("", p.left, p.top, p.left + p.width, p.top + p.height) for p in pills]
    assert len(boxes) > 40
    assert overlapping(boxes) == []


def test_without_room_the_largest_and_the_selected_values_remain() -> None:
    model = random_model(5, 24, 200)
    forces = np.linspace(1.0, 200.0, 200)
    fill(model, "rods.axial_force", forces)
    fill(model, "particles.applied_force", np.zeros((24, 2)))
    model.tag(model.rods[0], Selected)
    texts = picture_of(model, width=500, height=500, all_diagrams=True).texts
    shown = [force for force in forces if written(force) in texts]
    assert 20 < len(shown) < 150
    assert written(forces[-1]) in texts
    assert written(forces[0]) in texts
    assert np.mean(shown) > np.mean(forces)


def test_very_short_rods_show_no_values_and_say_so() -> None:
    model = Model()
    count = 60
    model.create(Particle, count, position=[(0.1 * i, 0.0) for i in range(count)])
    spawn_rods(model, [(i, i + 1) for i in range(count - 1)])
    fill(model, "rods.axial_force", np.arange(1.0, count))
    texts = picture_of(model, all_diagrams=True).texts
    assert any("zoom in" in text for text in texts)
    assert written(59.0) not in texts


def test_names_of_all_show_only_where_there_are_few() -> None:
    model = random_model(1, 20, 30)
    assert not [text for text in picture_of(model).texts if text.startswith(("particle", "rod"))]
    model.tag(model.rods["rod 3"], Selected)
    model.tag(model.particles["particle 2"], Hovered)
    assert {"rod 3", "particle 2"} <= set(picture_of(model).texts)


# --- overlays --------------------------------------------------------------------------------------


def test_status_bar() -> None:
    status = Status(time=1.234e-3, speed=0.35e-3, state="running", hint="Esc pauses")
    texts = picture_of(triangle(), width=900, status=status).texts
    assert {"Running", "t = 1.234 ms", "1 s shown = 0.35 ms simulated", "Esc pauses"} <= set(texts)
    assert "Running" not in picture_of(triangle()).texts


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 s"),
        (1.234e-3, "1.234 ms"),
        (0.5, "0.5000 s"),
        (12.3456, "12.35 s"),
        (3.5e-8, "35.00 ns"),
        (12345.6, "12346 s"),
        (0.0009999999, "1.000 ms"),
    ],
)
def test_written_time(seconds: float, text: str) -> None:
    assert written_time(seconds) == text


def test_written_speed_and_length() -> None:
    assert written_speed(0.0) == ""
    assert written_speed(1.0) == "real time"
    assert written_speed(20.0) == "1 s shown = 20 s simulated"
    assert [written_length(x) for x in (0.5, 2.0, 0.005, 1000.0)] == ["50 cm", "2 m", "5 mm", "1 km"]


def test_a_problem_is_told_in_full() -> None:
    problem = "The simulation stopped because its energy grew without cause. Set the time step to automatic."
    texts = picture_of(triangle(), status=Status(state="diverged", problem=problem)).texts
    assert problem in " ".join(texts)


def test_legend_names_only_what_occurs() -> None:
    meanings = {"tension (kN)", "compression (kN)", "yielding", "external force (kN)"}
    model = triangle()
    assert not meanings & set(picture_of(model).texts)
    assert meanings & set(picture_of(model, all_diagrams=True).texts) == meanings - {"yielding"}
    model.rods["BC"].compressive_strength = 198.0
    fill(model, "rods.yielding", [False, True, False])
    assert meanings & set(picture_of(model).texts) == {"yielding"}
    assert not meanings & set(picture_of(model, legend=False, all_diagrams=True).texts)


def test_heading_and_displacement_scale_are_written() -> None:
    model = triangle()
    model.settings.displacement_scale = 50.0
    picture = picture_of(model, heading="Pause")
    (heading,) = [mark for mark in marks_of(picture, Text) if mark.text == "Pause"]
    assert heading.colour == LIGHT.heading
    assert heading.x < 100
    assert heading.y < 50
    assert any("displacements ×50" in text for text in picture.texts)


def test_scale_bar_is_as_long_as_it_says() -> None:
    model = triangle()
    view = view_of(model)
    ruler = marks_of(compose(model, view, LIGHT), Rectangles, LIGHT.muted)[-1]
    assert ruler.boxes[0, 2] == round(0.5 * view.camera.scale)
    assert "50 cm" in compose(model, view, LIGHT).texts


def test_an_empty_model_says_how_to_begin() -> None:
    picture = picture_of(Model(), status=Status(state="paused", hint="P new particle     L rod"))
    assert {"An empty model", "P", "new particle", "L", "rod"} <= set(picture.texts)


# --- parts -----------------------------------------------------------------------------------------

coordinate = st.floats(-50, 50)


@given(coordinate, coordinate, coordinate, coordinate)
def test_clipping_keeps_exactly_what_lies_inside(ax: float, ay: float, bx: float, by: float) -> None:
    start, end = np.array([[ax, ay]]), np.array([[bx, by]])
    low, high = np.array([-10.0, -20.0]), np.array([30.0, 15.0])
    t = np.linspace(0.0, 1.0, 501)[:, None]
    samples = start + t * (end - start)
    inside = ((samples > low + 1e-9) & (samples < high - 1e-9)).all(axis=1)
    kept_start, kept_end, rows = clip_segments(start, end, low, high)
    if len(rows) == 0:
        assert not inside.any()
        return
    for point in (kept_start, kept_end):
        assert (point >= low - 1e-6).all()
        assert (point <= high + 1e-6).all()
    step = (end - start)[0]
    along = samples @ step
    between = (along >= kept_start @ step - 1e-6) & (along <= kept_end @ step + 1e-6)
    assert (between | ~inside).all()


@given(st.text("abc de,fgh", max_size=80), st.integers(30, 400))
def test_wrapping_keeps_the_words_and_the_width(text: str, width: int) -> None:
    lines = wrapped(text, width, 13)
    assert all(text_width(line, 13) <= width for line in lines)
    if all(text_width(word, 13) <= width for word in text.split()):
        assert " ".join(lines).split() == text.split()


def test_shortening() -> None:
    assert shortened("Esc pauses", 500, 12) == "Esc pauses"
    assert shortened("Esc pauses", 50, 12).endswith("…")
    assert text_width(shortened("Esc pauses", 50, 12), 12) <= 50
    assert shortened("Esc", 1, 12) == ""


def test_figures_have_one_width() -> None:
    for weight in ("regular", "semibold"):
        assert len({text_width(figure, 12, weight) for figure in "0123456789"}) == 1
    assert half_size("−1", 12, "regular", 1.0)[0] > half_size("1", 12, "regular", 1.0)[0]


# --- themes ----------------------------------------------------------------------------------------


def test_themes_load_and_the_default_is_the_thesis() -> None:
    assert {"light", "dark", "colour-blind", "colour-blind-dark"} == set(theme_names())
    assert len({load_theme(name).title for name in theme_names()}) == 4
    assert LIGHT.background[:3] == (255, 255, 255)
    assert LIGHT.yielding[:3] == (255, 0, 255)
    assert LIGHT.force[:3] == (0, 100, 255)


def test_wrong_themes_are_refused_by_name() -> None:
    entries = {"title": "T"} | dict.fromkeys(LIGHT.__dataclass_fields__, "#102030") | {"title": "T"}
    assert theme_from(entries, "theme t").force == (16, 32, 48, 255)
    with pytest.raises(ValueError, match="no theme 'pink'; choose one of"):
        load_theme("pink")
    with pytest.raises(ValueError, match="theme t lacks the colour 'force'"):
        theme_from({k: v for k, v in entries.items() if k != "force"}, "theme t")
    with pytest.raises(ValueError, match="theme t has an unknown colour 'glow'"):
        theme_from(entries | {"glow": "#000000"}, "theme t")
    with pytest.raises(ValueError, match="theme t, force: 'blue' is no colour"):
        theme_from(entries | {"force": "blue"}, "theme t")


# Linear RGB as people without red, green or blue cones see it: Machado, Oliveira, Fernandes (2009), severity 1.
VISIONS = {
    "all cones": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour: tuple[int, ...], vision: object) -> np.ndarray:
    """CIE L*a*b* (D65) of an sRGB colour as seen by a vision."""
    c = np.array(colour[:3]) / 255.0
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = XYZ @ np.clip(np.asarray(vision) @ linear, 0, 1) / [0.9505, 1.0, 1.089]
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("name", ["colour-blind", "colour-blind-dark"])
def test_colour_blind_themes_tell_meanings_apart(name: str, vision: str) -> None:
    """A difference of 25 in L*a*b* is ten times what is just noticeable."""
    theme = load_theme(name)
    colours = {
        key: getattr(theme, key) for key in ("tension", "compression", "yielding", "selected", "force", "ink")
    }
    for (a, first), (b, second) in itertools.combinations(colours.items(), 2):
        assert np.linalg.norm(lab(first, VISIONS[vision]) - lab(second, VISIONS[vision])) > 25, (a, b)
