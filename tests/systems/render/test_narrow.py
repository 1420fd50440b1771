"""Windows of any size, down to one pixel, at any pixel ratio: every scene is drawn."""

import itertools

import numpy as np
import pygame
import pytest

from pinjoint import Session
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.typography import fitting, shortened, text_width
from pinjoint.systems.render.ui.form_box import window_of
from tests.properties.limits import within

SCENES = {  # what is pressed in the pause
    "pause": ("i", "m", "j"),
    "simulation": ("space",),
    "save": ("s", "text a long name"),
    "load": ("d", "text tri"),
    "properties": ("ctrl+a", "return", "tab", "text 12345.678"),
    "force method": ("k", "k", "k"),
    "help": ("f1",),
}
SIZES = [*((side, side) for side in (1, 2, 7, 31, 33, 120, 330)), (1, 1080), (1920, 1), (120, 90), (400, 300)]
RATIOS = 1.0, 1.25, 3.0


@pytest.mark.parametrize("keys", SCENES.values(), ids=SCENES)
def test_every_scene_is_drawn_at_every_size(keys: tuple[str, ...]) -> None:
    """A loop over texts too wide for their boxes never ended where a box had less room than nothing."""
    session, canvas = Session.open("hyperstatic"), Canvas()
    for key in keys:
        session.press(key)
    for (width, height), ratio in itertools.product(SIZES, RATIOS):
        with within(20.0, f"{session.scene} at {width}x{height}, ratio {ratio}"):
            session.resize(width, height, ratio)
            session.update_view()
            surface = pygame.Surface((width, height), depth=32)
            for shown, view in session.stages:
                canvas.draw(surface, compose(shown, view, load_theme("light")))
            session.press("click", (0.5 * width, 0.5 * height))


@pytest.mark.parametrize("room", [-100.0, -1e-9, 0.0, 5.0, 60.0, 1e9])
def test_a_box_shows_what_fits_around_its_caret(room: float) -> None:
    text = "12345.678"
    with within(10.0):
        for caret in range(len(text) + 1):
            start, visible = window_of(text, caret, room, 13)
            assert text[start:].startswith(visible)
            assert not visible or text_width(visible, 13) <= room
            assert start <= caret <= start + len(visible) or room < text_width("0", 13)


def test_long_texts_take_no_longer_than_what_is_seen_of_them() -> None:
    text = "a" * 1_000_000
    with within(5.0):
        assert fitting(text, 100.0, 12) < 100
        assert text_width(shortened(text, 100.0, 12), 12) <= 100
        start, visible = window_of(text, 900_000, 100.0, 12)
        assert 900_000 - 100 < start < start + len(visible) <= 900_000
        assert np.isfinite(start)
