"""Names and values, and where they find room."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint.components.camera import Viewport
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.tags import Hovered, Selected
from pinjoint.components.view import Status
from pinjoint.components.written import number
from pinjoint.systems.render.labels.occupancy import FAINT, STRONG, Occupancy
from pinjoint.systems.render.labels.placing import Label, Placed, place_labels
from pinjoint.systems.render.marks import Panel, Text
from pinjoint.systems.render.picture import compose
from tests.benchmarks.models import mesh
from tests.reference.boxes import overlapping, text_boxes
from tests.systems.render.pictures import LIGHT, fill, marks_of, picture_of, triangle, view_of


def random_model(seed: int, particles: int, rods: int) -> Model:
    rng = np.random.default_rng(seed)
    model = Model()
    model.create(
        Particle, particles, position=rng.uniform(0, 4, (particles, 2)), fixed=rng.random((particles, 2)) < 0.2
    )
    pairs = np.array(list(itertools.combinations(range(particles), 2)))
    chosen = rng.choice(len(pairs), min(rods, len(pairs)), replace=False)
    model.create(Rod, len(pairs[chosen]), between=pairs[chosen])
    fill(model, "rods.axial_force", rng.normal(0, 100, len(chosen)))
    fill(model, "particles.applied_force", rng.normal(0, 50, (particles, 2)))
    return model


@settings(deadline=None, max_examples=25)
@given(
    st.integers(0, 10_000),
    st.integers(2, 30),
    st.sampled_from([(600, 600, 1.0), (1280, 800, 1.0), (320, 240, 1.0), (1200, 1200, 2.0), (200, 500, 1.0)]),
    st.booleans(),
)
def test_texts_never_overlap_and_stay_in_the_viewport(seed: int, n: int, size: tuple, problem: bool) -> None:
    width, height, ratio = size
    model = random_model(seed, n, 3 * n)
    model.tag_only([model.rods[0]], Selected)
    status = Status(
        1.2e-3, 1e-3, "running", "Esc stops", "It diverged: a time step of 1 s is too large." * problem
    )
    view = view_of(model, width, height, heading="Pause", all_diagrams=True, pixel_ratio=ratio, status=status)
    picture = compose(model, view, LIGHT)
    boxes = text_boxes(marks_of(picture, Text))
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
    assert len(boxes) > 20
    assert overlapping(boxes) == []


def test_without_room_the_largest_values_and_what_is_selected_come_first() -> None:
    model = random_model(0, 60, 150)
    forces = np.linspace(1.0, 200.0, 150)
    fill(model, "rods.axial_force", forces)
    fill(model, "particles.applied_force", np.zeros((60, 2)))
    texts = picture_of(model, width=900, height=900, all_diagrams=True).texts
    shown = [force for force in forces if number(force) in texts]
    assert 10 < len(shown) < 60
    assert any(f"{150 - len(shown)} values hidden: zoom in" in text for text in texts)
    assert number(forces[-1]) in texts
    assert np.mean(shown) > np.mean(forces)


def test_the_values_of_what_is_selected_come_before_larger_ones() -> None:
    model = triangle()
    model.tag_only([model.rods["CA"]], Selected)
    texts = picture_of(model, all_diagrams=True).texts
    assert texts.index("20.07 kN") < texts.index("−198.0 kN") < texts.index("−28.34 kN")


def test_very_short_rods_show_no_values_and_say_so() -> None:
    model = Model()
    count = 120
    model.create(Particle, count, position=[(0.1 * i, 0.0) for i in range(count)])
    model.create(Rod, count - 1, between=[(i, i + 1) for i in range(count - 1)])
    fill(model, "rods.axial_force", np.arange(1.0, count))
    texts = picture_of(model, all_diagrams=True).texts
    assert any("zoom in" in text for text in texts)
    assert number(119.0) not in texts


def test_names_of_all_show_only_where_there_are_few() -> None:
    model = random_model(1, 20, 30)
    assert not [text for text in picture_of(model).texts if text.startswith(("particle", "rod"))]
    model.tag_only([model.rods["rod 3"]], Selected)
    model.tag_only([model.particles["particle 2"]], Hovered)
    assert {"rod 3", "particle 2"} <= set(picture_of(model, pointer=(0.0, 0.0)).texts)
    assert "particle 2" not in picture_of(model).texts  # nothing points at it


PLACES = [(30.0, 50.0), (70.0, 50.0)]


def place_of(
    blocked: float | None, placed: Placed, line: tuple[float, int] | None = None, *, steady: bool = False
) -> float | None:
    """The x at which a label stands that may be at 30 or 70, by a square that is taken and a line."""
    occupancy = Occupancy(Viewport(0, 0, 100, 100), 1.0)
    if blocked is not None:
        occupancy.block(blocked - 5.0, 45.0, 10.0, 10.0)
    if line is not None:
        occupancy.line(np.array([[line[0], 0.0]]), np.array([[line[0], 100.0]]), line[1])
    label = Label("1", PLACES, 11, LIGHT.text, 0.0, key=("rods.name", 7), short="1")
    marks, _ = place_labels([label], occupancy, 1.0, placed, steady=steady)
    return next((mark.x for mark in marks if isinstance(mark, Text)), None)


def test_labels_stay_where_they_were_in_the_last_picture() -> None:
    placed: Placed = {}
    assert place_of(30.0, placed) == 70.0
    assert placed == {("rods.name", 7): 1}
    assert place_of(None, placed) == 70.0
    assert place_of(70.0, placed) == 30.0
    assert place_of(None, placed) == 30.0
    assert place_of(None, {}) == 30.0


def test_labels_move_to_where_they_cover_less() -> None:
    assert place_of(None, {("rods.name", 7): 1}, (70.0, STRONG)) == 30.0
    assert place_of(None, {("rods.name", 7): 1}, (30.0, STRONG)) == 70.0
    assert place_of(30.0, {("rods.name", 7): 0}, (70.0, FAINT)) == 70.0


def test_while_a_hand_drags_labels_move_only_from_what_is_taken() -> None:
    placed: Placed = {}
    assert place_of(None, placed, steady=True) == 30.0, "it was nowhere"
    assert place_of(None, placed, (30.0, STRONG), steady=True) == 30.0
    assert place_of(30.0, placed, (30.0, STRONG), steady=True) == 70.0
    assert place_of(None, placed, steady=True) == 70.0


def test_what_has_no_place_any_more_is_forgotten() -> None:
    placed = {("rods.name", 7): 1, ("rods.name", 8): 0}
    occupancy = Occupancy(Viewport(0, 0, 100, 100), 1.0)
    assert place_labels([], occupancy, 1.0, placed) == ([], [])
    assert not placed


def share_that_stays(model: Model, placed: Placed, *, forget: bool) -> float:
    """The least share of the values in one picture that the one before had, too, while forces vibrate by a tenth."""
    view, told, rng = view_of(model, 900, 900, all_diagrams=True), [], np.random.default_rng(6)
    count = model.rods.count
    for _ in range(5):
        fill(model, "rods.axial_force", np.linspace(100.0, 200.0, count) * rng.uniform(0.9, 1.1, count))
        if forget:
            placed.clear()
        texts = compose(model, view, LIGHT, placed).texts
        told.append({key // 6 for name, key in placed if name == "rods.N"})
        assert all(number(float(model.rods.axial_force[row])) in texts for row in told[-1])
    return min(len(now & before) / len(now) for before, now in itertools.pairwise(told))


def test_values_come_and_go_only_where_forces_change_much() -> None:
    model, placed = mesh(300), {}
    assert share_that_stays(model, {}, forget=True) < 0.85
    assert share_that_stays(model, placed, forget=False) > 0.85
    weak = [key // 6 for (name, key), place in placed.items() if name == "rods.N" and place >= 1000]
    fill(model, "rods.axial_force", np.where(np.isin(np.arange(model.rods.count), weak), 1.0, 180.0))
    compose(model, view_of(model, 900, 900, all_diagrams=True), LIGHT, placed)
    assert any(("rods.axial_force", row) not in placed for row in weak)


def test_values_of_many_forces_leave_the_rods_to_their_own_where_there_is_room() -> None:
    model, count = Model(), 30
    model.create(Particle, count, position=[(0.0, float(i)) for i in range(count)])
    model.create(Rod, count - 1, between=[(i, i + 1) for i in range(count - 1)])
    fill(model, "rods.axial_force", np.arange(1.0, count))
    fill(model, "particles.applied_force", np.tile([0.0, -0.25], (count, 1)))
    view = view_of(model, 400, 2400, all_diagrams=True)
    picture = compose(model, view, LIGHT)
    middle = view.camera.to_pixels((0.0, 0.0))[0]
    forces = [mark for mark in marks_of(picture, Text, LIGHT.load) if mark.text == "0.25"]
    assert len(forces) == count
    inside = [mark for mark in forces[1:] if abs(mark.x - middle) < 10.0]
    assert len(inside) <= 1  # below the lowest particle there is no rod
    assert {number(float(force)) for force in range(1, count)} <= set(picture.texts)


@pytest.mark.filterwarnings("error")
def test_what_lies_far_outside_takes_no_room() -> None:
    taken = Occupancy(Viewport(0, 0, 200, 100), 1.0)
    far = np.array([[1e300, -1e300], [np.inf, 0.0], [1e30, 50.0]])
    taken.line(far, far[::-1], STRONG)
    taken.block_squares(far[[0, 2]], np.array([5.0, 5.0]))
    assert not taken.taken.any()
    assert not taken.lined.any()
