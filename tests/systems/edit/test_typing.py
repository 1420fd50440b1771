"""Typing with a tool in hand: what keys are part of it, what it means, and what is refused."""

import math

import pytest

from pinjoint import Session
from pinjoint.components.language import spoken
from tests.reference.models import model, particle, rod
from tests.systems.edit.hand import EMPTY


def typed(session: Session, text: str, *keys: str) -> None:
    """Keys as a window gives them: each is pressed, and then its character arrives."""
    for character in text:
        session.press(character)
        session.type(character)
    for key in keys:
        session.press(key)


def new(tool: str) -> Session:
    """An empty model with a tool of the toolbar in hand."""
    session = Session.open(EMPTY)
    session.press(tool, (5.0, 5.0))
    return session


def beam() -> Session:
    return Session.open(
        model([particle("A", 0, 0), particle("B", 4, 0)], [rod("A", "B", bending_stiffness=1000.0)])
    )


def places(session: Session) -> list[tuple[float, float]]:
    return [one.position for one in session.model.particles]


def label(session: Session) -> tuple[str, str, str]:
    """What the box at the pointer says: what is typed, what it means, why it is refused."""
    session.update_view()
    preview = session.view.preview
    assert preview is not None
    return preview.typed, preview.label, preview.problem


@pytest.mark.parametrize("language", ["en", "pt"])
def test_a_portal_is_drawn_by_typing_only(language: str) -> None:
    with spoken(language):
        session = new("ctrl+r")
        for text in ("0; 0", "4 m@90", "600", "4 m <-90"):
            if text == "600":
                session.point(9.0, 4.1)  # to the right, nearly level
            typed(session, text, "return")
        assert places(session) == [(0.0, 0.0), (0.0, 4.0), (6.0, 4.0), (6.0, 0.0)]
        assert session.model.rods.between.tolist() == [[0, 1], [1, 2], [2, 3]]
        assert session.view.shows(session.model)


def test_a_beam_of_three_spans_is_drawn_by_differences_with_either_decimal_sign() -> None:
    session = new("l")
    for text in ("0;0", "4,5 m; 0", "4.5 m;", "450; 0"):
        typed(session, text, "return")
    assert places(session) == [(0.0, 0.0), (4.5, 0.0), (9.0, 0.0), (13.5, 0.0)]
    session.press("escape")
    session.undo()
    assert len(session.model.rods) == 2


def test_particles_are_placed_by_coordinates() -> None:
    session = new("p")
    typed(session, "150; -2.5 m", "return")
    typed(session, "0; 0", "return")
    assert places(session) == [(1.5, -2.5), (0.0, 0.0)]
    typed(session, "0; 0", "return")
    assert label(session) == ("0; 0| cm", "(0, 0) cm", session.gesture.problem)
    assert "is here already" in label(session)[2]
    typed(session, "", "backspace")
    typed(session, "5", "return")
    assert places(session)[-1] == (0.0, 0.05)


def test_a_rod_that_is_typed_ends_at_the_particle_that_is_there() -> None:
    session = beam()
    session.select()
    session.press("l", session.point(0.0, 0.0))
    typed(session, "400@0", "return")
    assert len(session.model.particles) == 2
    assert "already joins" in label(session)[2]
    typed(session, "", "backspace")
    typed(session, "90", "return")
    assert places(session)[-1] == (0.0, 4.0)


def test_a_length_alone_goes_towards_the_pointer_in_steps_of_15_degrees() -> None:
    session = new("l")
    typed(session, "0;0", "return")
    session.point(1.0, 0.6)
    typed(session, "2 m", "return")
    x, y = places(session)[-1]
    assert (x, y) == pytest.approx((2.0 * math.cos(math.radians(30.0)), 1.0), abs=1e-12)


def test_an_angle_alone_takes_the_distance_of_the_pointer() -> None:
    session = new("l")
    typed(session, "0;0", "return")
    session.point(3.0, 0.0)
    typed(session, "@60", "return")
    assert places(session)[-1] == pytest.approx((1.5, 1.5 * math.sqrt(3.0)), abs=1e-9)


@pytest.mark.parametrize(
    ("text", "force"),
    [
        ("-15", (0.0, -15.0)),
        ("300 N", (0.0, 0.3)),
        ("3; -15", (3.0, -15.0)),
        ("10@180", (-10.0, 0.0)),
        ("2 MN@-90", (0.0, -2000.0)),
    ],
)
def test_the_value_of_a_load_is_typed(text: str, force: tuple[float, float]) -> None:
    session = beam()
    session.press("f", session.point(4.0, 0.0))
    typed(session, text, "return")
    assert session.particles["B"].force == force
    session.undo()
    assert session.particles["B"].force == (0.0, 0.0)


def test_the_tool_begins_at_the_element_under_the_pointer_when_a_digit_is_typed() -> None:
    session = beam()
    session.press("f", (5.0, 5.0))
    session.point(2.0, 0.0)
    typed(session, "-20 kN/m", "return")
    assert session.rods["AB"].distributed_force == (0.0, -20.0)
    session.point(4.0, 0.0)
    typed(session, "-7", "return")
    assert session.particles["B"].force == (0.0, -7.0)
    session.point(2.0, 2.0)
    typed(session, "5", "return")
    assert "Begin at a particle" in session.notice or session.scene == "properties"


def test_a_moment_and_a_velocity_are_typed() -> None:
    session = beam()
    session.press("ctrl+m", session.point(4.0, 0.0))
    typed(session, "-12 kNm", "return")
    assert session.particles["B"].moment == -12.0
    session.press("v", session.point(4.0, 0.0))
    typed(session, "36 km/h@0", "return")
    assert session.particles["B"].velocity == (10.0, 0.0)


def test_what_is_wrong_is_said_in_the_box_and_nothing_is_lost() -> None:
    session = beam()
    session.press("f", session.point(4.0, 0.0))
    typed(session, "20 kN/m", "return")
    assert label(session) == ("20 kN/m|", "", "must be in N, kN, MN, not in kN/m")
    typed(session, "", "backspace", "backspace")
    assert label(session)[2] == ""
    typed(session, "", "return")
    assert session.particles["B"].force == (0.0, 20.0)
    session.press("f", session.point(4.0, 0.0))
    typed(session, "--", "return")
    assert label(session)[2] == "must be a number"
    typed(session, "", "escape")
    assert session.gesture is not None
    typed(session, "", "escape")
    assert session.gesture is None
    assert session.particles["B"].force == (0.0, 20.0)


def test_keys_belong_to_the_text_only_while_a_tool_is_in_hand() -> None:
    session = beam()
    pace = session.document.live.clock.factor
    typed(session, "+")
    assert session.document.live.clock.factor != pace
    session.press("f", session.point(4.0, 0.0))
    typed(session, "-2 kN@45")
    assert session.document.live.clock.factor != pace
    assert session.scene == "pause"
    assert session.view.quantity == "N"
    assert label(session)[0] == "-2 kN@45|"


def test_statics_says_nothing_of_keys_that_are_typed() -> None:
    session = beam()
    session.press("q")
    session.press("f", session.point(4.0, 0.0))
    typed(session, "-20.5")
    assert session.notice == ""


def test_a_click_ends_at_what_is_typed() -> None:
    session = new("l")
    session.click(0.0, 0.0)
    session.point(2.0, 0.0)
    typed(session, "3 m")
    session.click(2.0, 0.02)
    assert places(session)[-1] == (3.0, 0.0)


@pytest.mark.parametrize("text", ["-", ".", "0.5.", "1e", ";;", "@", "3@@4", "5 kk"])
@pytest.mark.parametrize("tool", ["f", "ctrl+f", "ctrl+m", "v", "l"])
def test_a_click_on_what_is_no_value_is_refused(tool: str, text: str) -> None:
    session = Session.open("portal")
    session.press(tool, session.point(3.0, 4.0))
    session.type(text)
    session.update_view()
    before = session.model.revision
    session.press("click", session.point(4.0, 3.0))
    session.update_view()
    assert session.model.revision == before or text in ("@", ";", ";;")


def test_a_wall_is_typed_from_point_to_point() -> None:
    session = new("w")
    typed(session, "-1 m; 0", "return")
    typed(session, "3 m@0", "return")
    [wall] = session.model.tables["walls"]
    assert (wall.start, wall.end) == ((-1.0, 0.0), (2.0, 0.0))


def test_what_is_typed_is_recorded_and_replayed(tmp_path: object) -> None:
    session = new("p")
    session.recorder = Kept()
    typed(session, "1 m; 2 m", "return")
    again = new("p")
    for key, pixel in session.recorder.pressed:
        again.press(key, pixel)
    assert places(again) == places(session) == [(1.0, 2.0)]


class Kept:
    """A recorder that keeps what was pressed."""

    def __init__(self) -> None:
        self.pressed: list[tuple[str, tuple[float, float] | None]] = []

    def press(self, key: str, pixel: tuple[float, float] | None) -> None:
        self.pressed.append((key, pixel))
