"""Arrows and supports stand for their particles and rods, where they are drawn."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.tags import Hovered
from pinjoint.editor.frame import Frame
from pinjoint.systems.edit.hover import Hover
from pinjoint.systems.edit.picking import pick
from pinjoint.systems.render.marks import Points, Stamps, Strokes
from pinjoint.systems.render.picture import compose, symbol_at
from pinjoint.systems.render.theme import load_theme

LIGHT = load_theme("light")


def opened(model: str, *keys: str) -> Session:
    session = Session.open(model)
    session.resize(1280, 800)
    session.settle()
    for key in keys:
        session.press(key)
    session.frame(0.0)  # with the displacement scale of what is settled
    session.update_view()
    return session


def arrow_of(session: Session, colour: str, table: str, row: int) -> tuple[float, float]:
    """An end, beside all elements, of the strokes of an element in a colour, in pixels."""
    ends: list[Points] = []
    for mark in compose(session.model, session.view, LIGHT).marks:
        if isinstance(mark, Strokes) and mark.colour == getattr(LIGHT, colour) and mark.of is not None:
            of_it = mark.of[1] == row if mark.of[0] == table else np.zeros(len(mark.start), dtype=bool)
            ends += [mark.start[of_it], mark.end[of_it]]
    free = [tuple(p) for p in np.concatenate(ends).tolist() if pick(session.model, session.view, p) is None]
    assert free
    return free[len(free) // 2]


@pytest.mark.parametrize(
    ("model", "keys", "colour", "mark", "owner"),
    [
        ("portal", ("i", "i", "i"), "load", ("loads", 0), ("particles", "B")),  # the wind, without diagrams
        ("portal", (), "load", ("rods", 1), ("rods", "BC")),
        ("portal", (), "reaction", ("particles", 0), ("particles", "A")),
        ("isostatic", ("i",), "reaction", ("particles", 0), ("particles", "A")),
        ("isostatic", ("x",), "load", ("particles", 1), ("particles", "B")),
    ],
)
def test_an_arrow_is_its_elements(
    model: str, keys: tuple[str, ...], colour: str, mark: tuple[str, int], owner: tuple[str, str]
) -> None:
    session = opened(model, *keys)
    pixel = arrow_of(session, colour, *mark)
    found = symbol_at(session.model, session.view, pixel)
    assert found is not None
    assert (found.table, found.name) == owner


def test_a_support_is_its_particles() -> None:
    session = opened("portal")
    [stamps] = [
        mark
        for mark in compose(session.model, session.view, LIGHT).marks
        if isinstance(mark, Stamps) and mark.symbol == "clamped"
    ]
    x, y = stamps.at[0].tolist()
    assert symbol_at(session.model, session.view, (x + 6.0, y + 10.0)) is session.particles["A"]


def test_a_pixel_beside_all_symbols_and_any_with_a_tool_in_hand_are_nobodys() -> None:
    session = opened("portal")
    x, y = session.view.camera.to_pixels((3.0, 2.0)).tolist()
    assert symbol_at(session.model, session.view, (x, y)) is None
    pixel = arrow_of(session, "load", "rods", 1)
    session.view.tool = "place"
    assert symbol_at(session.model, session.view, pixel) is None


def test_an_arrow_is_hovered_has_a_menu_and_opens_but_a_click_is_beside_it() -> None:
    session = opened("portal")
    pixel = arrow_of(session, "load", "rods", 1)
    session.view.pointer = pixel
    Hover(symbol_at).process(Frame(session, 0.0))
    assert session.model.tagged(Hovered) == [session.rods["BC"]]
    session.press("click", pixel)
    assert session.selected == []
    session.press("right click", pixel)
    assert session.view.menu is not None
    assert session.view.menu.title == "Rod BC"
    session.press("escape")
    session.press("escape")
    assert session.selected == []
    session.press("double click", pixel)
    assert session.scene == "properties"
    assert session.selected == [session.rods["BC"]]
