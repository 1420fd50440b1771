"""Panels stand beside the structure, in windows of any size, and none of them vanishes without a word."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.view import Readout, drawn_positions
from pinjoint.scripts.playing import Recorder, play, session_of
from pinjoint.scripts.script import Script
from pinjoint.systems.render.marks import Panel, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.reference.boxes import Box, overlap
from tests.reference.hits import hits_in

SIZES = [(640, 480), (480, 800), (1920, 1080)]
KEYS = ("m", "j", "o", "escape", "o", "u")  # theory, energy, a plot of the rod, one of the energies, speeds


def opened(name: str, size: tuple[int, int], *keys: str) -> Session:
    """A model in a window of that size, in which a rod is selected, if it has one, and keys are pressed."""
    session = Session.open(name)
    session.resize(*size)
    session.press("home")
    session.select(*list(session.rods)[:1])
    for key in keys:
        session.press(key)
        session.update_view()
    return session


def panels_of(session: Session) -> dict[str, Box]:
    """Boxes of the panels on the screen, by their titles; of those that are folded, one by theirs together."""
    marks = compose(session.model, session.view, load_theme("light")).marks
    titles = {readout.title for readout in session.view.readouts}
    return {
        text.text: (panel.left, panel.top, panel.left + panel.width, panel.top + panel.height)
        for panel, text in itertools.pairwise(marks)
        if isinstance(panel, Panel) and isinstance(text, Text) and any(map(text.text.startswith, titles))
    }


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["hyperstatic_yield", "warren_bridge", "staircase"])
def test_no_panel_covers_the_structure(name: str, size: tuple[int, int]) -> None:
    session = opened(name, size, *KEYS)
    places = session.view.camera.to_pixels(drawn_positions(session.model))
    for title, (left, top, right, bottom) in panels_of(session).items():
        x, y = places.T
        assert not ((x > left) & (x < right) & (y > top) & (y < bottom)).any(), title


@pytest.mark.parametrize("size", SIZES)
def test_every_panel_is_told_and_the_newest_is_whole(size: tuple[int, int]) -> None:
    session = opened("hyperstatic_yield", size, *KEYS)
    panels = panels_of(session)
    marks = compose(session.model, session.view, load_theme("light")).marks
    said = " ".join(mark.text for mark in marks if isinstance(mark, Text))
    assert all(readout.title in said for readout in session.view.readouts)
    _, top, _, bottom = panels["Energies"]
    assert bottom - top > 96.0
    boxes = list(panels.values())
    assert not any(overlap(one, other) for i, one in enumerate(boxes) for other in boxes[:i])
    assert all(bottom <= size[1] for _, _, _, bottom in boxes)


@pytest.mark.parametrize("size", SIZES)
def test_each_panel_is_closed_by_the_button_in_its_corner(size: tuple[int, int]) -> None:
    session = opened("hyperstatic_yield", size, *KEYS, "x", "ctrl+h")
    selected = session.selected
    assert len(session.view.readouts) > 5
    while session.view.readouts:
        close = next(hit for hit in hits_in(session) if isinstance(hit.item, Readout) and hit.action)
        titles = {readout.title for readout in session.view.readouts}
        for button in ("right click", "double click", "click"):
            assert {readout.title for readout in session.view.readouts} == titles
            session.press(button, close.middle)
            session.update_view()
        left = {readout.title for readout in session.view.readouts}
        assert close.item.title not in left
        assert left < titles
    assert (session.selected, session.view.menu, session.scene) == (selected, None, "pause")


def test_what_is_switched_on_last_is_unfolded() -> None:
    session = opened("hyperstatic_yield", (640, 480), "j", "o", "m")
    _, top, _, bottom = panels_of(session)["Energy account"]
    assert bottom - top < 45.0, "two titles: the plot has no room, either"
    for _ in range(2):
        session.press("j")
        session.update_view()
    _, top, _, bottom = panels_of(session)["Energy account"]
    assert bottom - top > 100.0


def test_a_small_panel_leaves_the_picture_as_it_is() -> None:
    session = Session.open("newtons_cradle")
    session.resize(1000, 720)
    session.press("home")
    before = session.view.camera.scale, session.view.camera.centre
    session.run(time=1.0)
    session.press("i")
    session.update_view()
    assert [readout.title for readout in session.view.readouts] == ["Impacts"]
    assert (session.view.camera.scale, session.view.camera.centre) == before
    ((left, _, right, _),) = panels_of(session).values()
    assert right - left < 150.0


def test_whoever_looks_closer_is_left_alone() -> None:
    session = opened("hyperstatic_yield", (640, 480))
    session.press("wheel up")
    before = session.view.camera.scale, session.view.camera.centre
    session.press("m")
    assert (session.view.camera.scale, session.view.camera.centre) == before
    session.press("home")
    assert session.view.camera.scale < before[0]


def test_the_model_takes_all_room_again_when_panels_go() -> None:
    session = opened("hyperstatic_yield", (640, 480))
    before = session.view.camera.scale
    for key in ("m", "tab", "tab", "m"):
        session.press(key)
    assert session.view.camera.scale == before


def test_a_click_beside_panels_is_recorded_where_it_was(tmp_path: Path) -> None:
    """Replaying knows no frames; still the picture is fitted alike, so that pixels mean the same places."""
    path = tmp_path / "script.jsonl"
    session = Session.open("hyperstatic")
    session.resize(640, 480)
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, "hyperstatic")
        session.press("home")
        for key in ("m", "o", "j"):
            session.press(key)
            session.update_view()
        for x, y in ((0.2, 0.3), (1.1, 0.9)):
            session.press("p", session.point(x, y))
    entries = [json.loads(line) for line in path.read_text().splitlines()]
    assert sum(entry.get("input") == "p" for entry in entries) == 2
    script = Script(path)
    again = session_of(script)
    assert play(script, again) == []
    np.testing.assert_array_equal(again.particles.position, session.particles.position)


def test_what_settles_out_of_the_picture_is_followed() -> None:
    session = opened("hyperstatic_yield", (640, 480))
    session.press("e")
    room, pixels = session.view.room, session.view.camera.to_pixels(drawn_positions(session.model))
    assert all(map(room.contains, pixels.tolist()))
    session.press("ctrl+z")
    session.press("wheel up")
    before = session.view.camera.scale
    session.press("e")
    assert session.view.camera.scale == before


def test_a_notice_stands_beside_the_panels() -> None:
    session = opened("hyperstatic_yield", (1000, 720), "m", "j")
    session.press("o")
    session.update_view()
    marks = compose(session.model, session.view, load_theme("light")).marks
    (said,) = [mark for mark in marks if isinstance(mark, Text) and mark.text.startswith("Plot: ")]
    assert said.x < min(left for left, *_ in panels_of(session).values())


@pytest.mark.parametrize("size", [(640, 480), (1024, 640), (1280, 800)])
def test_a_long_sentence_goes_on_in_the_next_line(size: tuple[int, int]) -> None:
    session = opened("isostatic", size)
    sentence = "The structure collapses: Rod BC yields and nothing else resists"
    rows = (("0.4345 s, 86.9 % of the load", "Rod BC yields"), ("0.4345 s, 86.9 % of the load", sentence))
    session.view.readouts = (Readout("What happened", rows),)
    marks = compose(session.model, session.view, load_theme("light")).marks
    [panel] = [a for a, b in itertools.pairwise(marks) if isinstance(b, Text) and b.text == "What happened"]
    assert isinstance(panel, Panel)
    within = [m for m in marks if isinstance(m, Text) and panel.left < m.x < panel.left + panel.width]
    within = [text for text in within if panel.top < text.y < panel.top + panel.height]
    assert sentence in " ".join(text.text for text in within)
    assert sum(text.text == rows[0][0] for text in within) == 2  # each with its instant
    assert len({(text.y, text.anchor) for text in within}) == len(within)


@pytest.mark.parametrize("name", ["hanging_net", "overshoot_yield", "isostatic"])
def test_a_notice_lies_on_no_slider(name: str) -> None:
    session = opened(name, (640, 480), "i")
    session.notice = "All comes to rest"
    session.update_view()
    marks = compose(session.model, session.view, load_theme("dark")).marks
    (at,) = [n for n, mark in enumerate(marks) if isinstance(mark, Text) and mark.text == session.notice]
    panel = [mark for mark in marks[:at] if isinstance(mark, Panel)][-1]
    box = panel.left, panel.top, panel.left + panel.width, panel.top + panel.height
    for slider in session.view.slider_places:
        right, lower = slider.left + slider.width, slider.top + slider.height
        assert not overlap(box, (slider.left, slider.top, right, lower))
