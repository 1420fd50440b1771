"""What stands above a model: status, legend, heading, scale."""

import itertools

import pytest

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.components.view import Status, drawn_positions
from pinjoint.systems.render.marks import Panel, Stamps, Text
from pinjoint.systems.render.picture import compose
from tests.reference.hits import hits_in
from tests.systems.render.pictures import LIGHT, fill, marks_of, picture_of, triangle, view_of


def test_status_bar() -> None:
    status = Status(time=1.234e-3, speed=0.35e-3, state="running", hint="Esc pauses")
    texts = picture_of(triangle(), width=900, status=status).texts
    assert {"Running", "t = 1.234 ms", "slow motion: 1 s shown = 0.35 ms", "Esc pauses"} <= set(texts)
    assert "Running" not in picture_of(triangle()).texts


def test_a_problem_is_told_in_full() -> None:
    problem = "The simulation stopped because its energy grew without cause. Set the time step to automatic."
    texts = picture_of(triangle(), status=Status(state="diverged", problem=problem)).texts
    assert problem in " ".join(texts)


@pytest.mark.parametrize(("displacement", "told"), [(4.3e-4, True), (0.0, False), (0.05, False)])
def test_displacements_too_small_to_be_seen_are_told(displacement: float, told: bool) -> None:
    model = triangle()
    model.particles["B"].displacement = (displacement, 0.0)
    said = "displacements up to 0.043 cm are too small to see: enlarge them with the slider"
    assert (said in " ".join(picture_of(model, width=900).texts)) == told
    model.settings.displacement_scale = 100.0
    assert said not in " ".join(picture_of(model, width=900).texts)


def test_the_ruler_stays_where_there_is_no_room_for_what_is_said_beside_it() -> None:
    model = triangle()
    model.particles["B"].displacement = (4.3e-4, 0.0)
    texts = picture_of(model, width=400).texts
    assert "50 cm" in texts
    assert not any("too small" in text for text in texts)


def test_legend_names_only_what_occurs() -> None:
    meanings = {"tension (kN)", "compression (kN)", "yielding", "load (kN)", "reaction (kN)"}
    model = triangle()
    assert not meanings & set(picture_of(model).texts)
    assert meanings & set(picture_of(model, all_diagrams=True).texts) == meanings - {"yielding"}
    model.rods["BC"].compressive_strength = 198.0
    fill(model, "rods.yielding", [False, True, False])
    assert meanings & set(picture_of(model).texts) == {"yielding"}
    assert not meanings & set(picture_of(model, legend=False, all_diagrams=True).texts)


def test_legend_leaves_out_what_is_not_in_the_picture() -> None:
    model = triangle()
    model.rods["BC"].compressive_strength = 198.0
    fill(model, "rods.yielding", [False, True, False])
    view = view_of(model, all_diagrams=True)
    view.camera.zoom(20.0, view.camera.to_pixels((0.5, 0.0)))
    texts = set(compose(model, view, LIGHT).texts)
    assert "tension (kN)" in texts
    assert not {"compression (kN)", "yielding", "load (kN)", "reaction (kN)"} & texts


def test_legend_explains_the_undeformed_structure_where_it_is_drawn() -> None:
    model = triangle()
    assert "undeformed" not in picture_of(model).texts
    model.particles["B"].displacement = (0.2, 0.0)
    assert "undeformed" in picture_of(model).texts


def test_heading_and_displacement_scale_are_written() -> None:
    model = triangle()
    model.settings.displacement_scale = 50.0
    picture = picture_of(model, heading="Pause")
    (heading,) = [mark for mark in marks_of(picture, Text) if mark.text == "Pause"]
    assert heading.colour == LIGHT.text
    assert heading.x < 100
    assert heading.y < 50
    assert any("displacements ×50" in text for text in picture.texts)


def test_scale_bar_is_as_long_as_it_says() -> None:
    model = triangle()
    view = view_of(model)
    ruler, *_ = marks_of(compose(model, view, LIGHT), Panel, LIGHT.muted)[-3:]
    assert ruler.width == round(0.5 * view.camera.scale)
    assert "50 cm" in compose(model, view, LIGHT).texts


def test_an_empty_model_says_how_to_begin() -> None:
    """By the names of its first tools; a click on one takes it up as the toolbar does, and the card makes room."""
    session = Session.open({"format": "pinjoint model", "version": 1})
    session.resize(1024, 640)
    session.update_view()
    texts = compose(session.model, session.view, LIGHT).texts
    assert {"An empty model", "Draw a particle", "P", "Open a model", "D"} <= set(texts)
    enabled = [hit for hit in hits_in(session) if hit.enabled and hit.at is not None]
    assert [hit.action for hit in enabled] == ["place", "rod", "rigid", "new grid", "load", "toggle help"]
    place, _, _, _, load, _ = enabled
    session.press("click", (place.left + 40.0, place.top + 5.0))
    session.update_view()
    assert session.view.tool == "place"
    assert "An empty model" not in compose(session.model, session.view, LIGHT).texts
    session.press("click", (place.left + 40.0, place.top + 5.0))
    assert session.particles.count == 1
    session.press("ctrl+z")
    session.press("escape")
    session.press("click", (load.left + 40.0, load.top + 5.0))
    assert session.scene == "load"


def test_the_scale_stays_where_it_is_while_that_is_free() -> None:
    session = Session.open("hyperstatic")
    session.resize(1280, 800)
    session.settle()
    placed: dict[tuple[str, int], int] = {}
    seen = []
    for _ in range(30):
        session.update_view()
        compose(session.model, session.view, LIGHT, placed)
        seen.append(placed["scale", 0])
        session.view.camera.zoom(0.98, (640.0, 300.0))
    assert len(set(seen)) == 1, seen


@pytest.mark.parametrize("size", [(1024, 640), (1280, 800), (1920, 1080)])
def test_a_long_notice_stands_beside_a_structure_that_fills_the_height(size: tuple[int, int]) -> None:
    session = Session.open("hyperstatic")
    session.resize(*size)
    session.settle()
    session.press("i")
    session.update_view()
    said = "Speeds beside Rayleigh's curve. They appear as soon as a particle that no rod holds is moving."
    session.view.status = Status(notice=said)
    marks = compose(session.model, session.view, LIGHT).marks
    pairs = itertools.pairwise(marks)
    [box] = [
        a
        for a, b in pairs
        if isinstance(a, Panel) and a.radius and isinstance(b, Stamps) and b.symbol == "disc"
    ]
    x, y = session.view.camera.to_pixels(drawn_positions(session.model)).T
    reach = 8.0
    covered = (x > box.left - reach) & (x < box.left + box.width + reach)
    covered &= (y > box.top - reach) & (y < box.top + box.height + reach)
    assert not covered.any()


def test_the_title_of_a_mode_stands_beside_a_legend_of_several_rows_off_the_structure() -> None:
    session = Session.open("hyperstatic")
    session.resize(1024, 640)
    for key in ("e", "i", "b"):
        session.press(key)
    session.select(session.rods["AC"])
    session.press("return")
    session.update_view()
    model, view = session.stages[0]
    assert isinstance(model, Model)
    texts = [mark for mark in compose(model, view, LIGHT).marks if isinstance(mark, Text)]
    (heading,) = [text for text in texts if text.text == "Properties"]
    (title,) = [text for text in texts if text.text.startswith("Mode 1 of 5")]
    (lowest,) = [text for text in texts if text.text == "undeformed"]
    assert heading.y < title.y < lowest.y + 20.0


def test_values_that_read_alike_share_a_number_or_a_line() -> None:
    session = Session.open("rope_bridge")
    session.press("q")
    session.view.all_diagrams = True
    session.resize(1280, 800)
    session.update_view()
    texts = compose(*session.stages[0], LIGHT).texts
    assert texts.count("1") > 10  # loads of the planks, all the same
    assert "2" not in texts
    assert texts[texts.index("rope 1, rope 20") + 1] == "0.8861"
    session = Session.open("falling_columns")
    session.press("q")
    session.view.all_diagrams = True
    session.resize(640, 480)
    session.press("m")
    session.update_view()
    texts = compose(*session.stages[0], LIGHT).texts
    assert texts[texts.index("column 1 … column 8") + 1] == "−0.09810"
