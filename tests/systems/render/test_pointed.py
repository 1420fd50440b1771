"""The numbers of the element under the pointer: right, and never over it."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.handle import Handle
from pinjoint.components.load import factor_at
from pinjoint.components.tags import Hovered
from pinjoint.components.view import Readout, drawn_positions
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.marks import Panel, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.reference.boxes import overlap, text_box
from tests.systems.render.frame_models import EI, simple_beam

LIGHT = load_theme("light")


def told(session: Session, handle: Handle) -> dict[str, str]:
    """What the picture says of an element, by title."""
    point_at(session, handle)
    pointed = session.view.pointed
    return dict(pointed.rows) if pointed is not None else {}


def point_at(session: Session, handle: Handle) -> None:
    places = drawn_positions(session.model)
    if handle.table == "rods":
        place = places[list(session.model.rods.between[handle.row])].mean(axis=0)
    else:
        place = places[handle.row] if handle.table == "particles" else handle.start  # type: ignore[attr-defined]
    session.view.pointer = tuple(session.view.camera.to_pixels(place).tolist())
    session.model.tag_only([handle], Hovered)
    session.update_view()


def settled(model: str, size: tuple[int, int] = (1000, 720)) -> Session:
    session = Session.open(model)
    session.resize(*size)
    session.settle()
    return session


def test_a_rod_tells_its_force_strain_utilisation_and_length() -> None:
    session = settled("isostatic")
    assert told(session, session.rods["BC"]) == {
        "axial force": "−198.0 kN",
        "utilisation": "92.1 %",
        "strain": "−1.203 ‰",
        "length": "141.3 cm",
    }


def test_a_particle_tells_its_displacement_reactions_speed_and_loads() -> None:
    session = settled("braced_portal")
    rows = told(session, session.particles["A"])
    assert {"displacement", "reaction", "speed"} <= set(rows)
    assert rows["displacement"] == "x 0   y 0 cm"
    rows = told(session, session.particles["D"])
    assert rows["load 1"] == "(50, 0) of (50, 0) kN"  # it has grown to all of it


def test_a_load_that_grows_tells_what_it_is_now() -> None:
    session = Session.open("braced_portal")
    [load] = session.model.loads
    half = load.history["start"] + 0.5 * load.history["duration"]
    assert factor_at(load.history, half) == pytest.approx(0.5)
    session.run(time=half)
    assert told(session, session.particles["D"])["load 1"] == "(25, 0) of (50, 0) kN"


def test_walls_tell_their_places_in_centimetres() -> None:
    session = Session.open("pile")
    rows = told(session, session.model.tables["walls"]["floor"])
    assert rows["start"] == "(0, 0) cm"
    assert rows["end"] == "(160, 0) cm"


def test_nothing_is_told_without_a_pointer_or_while_something_is_drawn() -> None:
    session = settled("isostatic")
    point_at(session, session.rods["AB"])
    assert "axial force" in compose(session.model, session.view, LIGHT).texts
    session.view.help = 1
    assert "axial force" not in compose(session.model, session.view, LIGHT).texts
    session.view.help = 0
    session.model.tag_only([], Hovered)
    session.update_view()
    assert session.view.pointed is None


@pytest.mark.parametrize("size", [(640, 480), (1280, 800)])
@pytest.mark.parametrize("model", ["isostatic", "braced_portal", "warren_bridge", "tower", "von_mises"])
def test_it_lies_in_the_picture_and_not_over_its_element(model: str, size: tuple[int, int]) -> None:
    session = settled(model, size)
    told_of = 0
    for handle in [*list(session.model.rods)[::5], *list(session.model.particles)[::5]]:
        point_at(session, handle)
        picture = compose(session.model, session.view, LIGHT)
        title = session.model.describe(handle)
        found = [i for i, mark in enumerate(picture.marks) if isinstance(mark, Text) and mark.text == title]
        if not found:
            continue
        told_of += 1
        box = picture.marks[found[-1] - 1]
        assert isinstance(box, Panel)
        low, high = np.array([box.left, box.top]), np.array([box.left + box.width, box.top + box.height])
        canvas = session.view.canvas
        assert (low >= [canvas.left, canvas.top]).all()
        assert (high <= [canvas.right, canvas.bottom]).all()
        ends = list(session.model.rods.between[handle.row]) if handle.table == "rods" else [handle.row] * 2
        start, end = session.view.camera.to_pixels(drawn_positions(session.model)[ends])
        assert not len(clip_segments(start[None], end[None], low, high)[2]), title
    assert told_of > 1


@pytest.mark.parametrize("size", [(640, 480), (1024, 640)])
def test_it_covers_no_value_in_the_narrow_sets_of_the_force_method(size: tuple[int, int]) -> None:
    session = Session.open("hyperstatic")
    session.resize(*size)
    for key in ("k", "i"):
        session.press(key)
    told_of = 0
    for name in ("AB", "AC", "CD", "DA"):
        model, view = session.stages[0]
        places = drawn_positions(model)[list(model.rods[name].between)]
        session.view.pointer = session.point(*(0.7 * places[0] + 0.3 * places[1]).tolist())
        model.tag_only([model.rods[name]], Hovered)
        session.update_view()
        model, view = session.stages[0]
        picture = compose(model, view, LIGHT)
        title = model.describe(model.rods[name])
        at = max((i for i, m in enumerate(picture.marks) if isinstance(m, Text) and m.text == title), default=0)
        if not at:
            continue
        told_of += 1
        panel = picture.marks[at - 1]
        assert isinstance(panel, Panel)
        box = panel.left, panel.top, panel.left + panel.width, panel.top + panel.height
        values = [mark for mark in picture.marks[:at] if isinstance(mark, Text) and mark.text.endswith("kN")]
        covered = [mark.text for mark in values if overlap(text_box(mark, 0.7 * mark.size), box)]
        assert not covered, name
    assert told_of >= 3


# --- along members ---------------------------------------------------------------------------------------

LOAD, SPAN = 8.0, 4.0  # kN/m, m


def along(session: Session, x: float) -> Readout | None:
    """What is told with the pointer there on AB."""
    session.point(x, 0.0)
    session.model.tag_only([session.rods["AB"]], Hovered)
    session.update_view()
    return session.view.pointed


def by_hand(x: float, load: float = LOAD) -> dict[str, float]:
    """V = q(L/2 − x), M = qx(L − x)/2, v = −qx(L³ − 2Lx² + x³)/24EI and its slope; in kN, kN·m, cm, mrad."""
    return {
        "N": 0.0,
        "V": load * (SPAN / 2.0 - x),
        "M": load * x * (SPAN - x) / 2.0,
        "displacement": -100.0 * load * x * (SPAN**3 - 2.0 * SPAN * x**2 + x**3) / 24.0 / EI,
        "rotation": -1000.0 * load * (SPAN**3 - 6.0 * SPAN * x**2 + 4.0 * x**3) / 24.0 / EI,
    }


def assert_told(readout: Readout | None, x: float, load: float = LOAD) -> None:
    assert readout is not None
    assert float(readout.title.removeprefix("rod AB, x = ").removesuffix(" cm")) == pytest.approx(
        100.0 * x, rel=1e-3
    )
    told_of = {name: text.rpartition(" ")[0].rpartition("y ")[2] for name, text in readout.rows}
    wanted = by_hand(x, load)
    assert [*told_of] == [*wanted]
    for name, text in told_of.items():
        assert float(text.replace("−", "-")) == pytest.approx(wanted[name], rel=6e-4, abs=1e-9), name


def test_pointing_along_a_member_tells_what_a_hand_calculates() -> None:
    session = simple_beam(-LOAD, SPAN)
    for x in (0.5, 1.0, 3.5):
        assert_told(along(session, x), x)
    assert "rod AB, x = 350 cm" in compose(session.model, session.view, LIGHT).texts
    session.press("q")
    told_of = along(session, 1.0)
    assert told_of is not None
    assert told_of.title == "rod AB", "in motion there is no equilibrium along it"


def test_a_click_pins_the_numbers_of_a_place_which_follow_edits() -> None:
    session = simple_beam(-LOAD, SPAN)
    session.click(1.0, 0.0)
    session.update_view()
    assert session.view.pin is not None
    assert_told(session.view.pin.told, 1.0)
    texts = compose(session.model, session.view, LIGHT).texts
    assert {"rod AB, x = 100 cm", "12.00 kN·m"} <= set(texts)
    session.rods["AB"].distributed_force = (0.0, -2.0 * LOAD)
    session.update_view()
    assert_told(session.view.pin.told, 1.0, 2.0 * LOAD)
    assert_told(along(session, 3.0), 3.0, 2.0 * LOAD)
    texts = compose(session.model, session.view, LIGHT).texts
    assert {"rod AB, x = 100 cm", "rod AB, x = 300 cm"} <= set(texts), "both find room"
    session.press("escape")
    session.update_view()
    assert session.view.pin.told is None
    session.click(1.0, 0.0)
    session.click(1.0, 0.0)
    session.update_view()
    assert session.view.pin is None, "a second click there takes it away"


def test_a_typed_distance_takes_pinned_numbers_there() -> None:
    session = simple_beam(-LOAD, SPAN)
    session.click(1.0, 0.0)
    for character in "150.5":
        session.press(character)  # as a window tells a key, and the text that it writes
        session.type(character)
    session.update_view()
    assert session.view.pin is not None
    assert session.notice == ""
    assert_told(session.view.pin.told, 1.505)
    session.press("backspace")
    session.press("backspace")
    session.update_view()
    assert_told(session.view.pin.told, 1.5)
    session.type("0")
    session.update_view()
    assert_told(session.view.pin.told, SPAN)  # 1500 cm are beyond its end
    for _ in range(4):
        session.press("backspace")
    assert session.model.rods.count == 1
    session.press("backspace")
    assert session.model.rods.count == 0, "with nothing typed it deletes what is selected"
    session.update_view()
    session.undo()
    session.update_view()


def test_bars_tell_of_themselves_as_they_are_the_same_all_along() -> None:
    session = Session.open("isostatic")
    session.press("q")
    session.click(0.5, 0.5)
    rows = told(session, session.rods["AB"])
    assert session.view.pin is None
    assert rows["axial force"] == "−28.28 kN"
