"""The pictures to compare: every mode, in a small window, without a display.

They depend on nothing but the program: no saved models, time by steps, a fixed window.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

import pygame

from components.camera import Viewport
from game import Session
from game.saved.library import data_in
from systems.render.picture import compose
from systems.render.pygame_canvas import Canvas
from systems.render.theme import load_theme

FOLDER = Path(__file__).parent
SIZE = 640, 480
NOWHERE = Path("nowhere")  # in place of the person's saved models; there is no such folder
EMPTY = {"format": "pinjoint model", "version": 1}


def drawn(name: str) -> pygame.Surface:
    """The picture of that name."""
    with data_in(NOWHERE):
        session = SCENES[name]()
        session.update_view()
        surface = pygame.Surface(SIZE, depth=32)
        canvas = Canvas()
        for shown, view in session.stages:
            canvas.draw(surface, compose(shown, view, load_theme(session.view.theme)))
        return surface


def _opened(source: object = "isostatic") -> Session:
    session = Session.open(source)  # type: ignore[arg-type]
    session.view.camera.viewport = Viewport(0, 0, *SIZE)
    session.view.fit(session.model)
    return session


def _pressed(*keys: str, source: object = "isostatic", theme: str = "light") -> Session:
    session = _opened(source)
    session.view.theme = theme
    for key in keys:
        session.press(key)
    return session


def _simulation_at_rest() -> Session:
    session = _opened()
    session.settings.displacement_scale = 50.0
    session.press("i")
    session.press("space")
    session.run(until="rest")
    return session


def _properties() -> Session:
    session = _opened()
    session.click(*session.particles["B"].position)
    session.press("return")
    return session


def _save() -> Session:
    session = _pressed("s")
    session.type("my bridge")
    return session


def _load() -> Session:
    """Narrowed down to few examples, so that a new one need not change the picture."""
    session = _pressed("d")
    session.type("hyperstatic")
    for _ in session.scenes.active.stages(session)[0][0].tiles:  # type: ignore[union-attr]
        session.scenes.active.advance(session, 0.0)
    return session


def _force_method() -> Session:
    session = _pressed("k", "k", source="hyperstatic")
    session.click(0.5, 1.0)
    for _ in range(4):
        session.press("k")
    return session


def _drawing_a_force() -> Session:
    """A selected rod, a tool in hand and what it is about to draw."""
    session = _opened("hyperstatic")
    session.click(0.75, 1.5)
    session.press("f", session.point(*session.particles["B"].position))
    session.point(0.4, 1.2)
    return session


def _drawing_a_wall() -> Session:
    """From the foot of the stairs, with the floor selected."""
    session = _opened("staircase")
    session.select(session.table("walls")["floor"])
    session.point(2.0, 0.0)
    session.press("w")
    session.point(1.0, -0.4)
    return session


SCENES: dict[str, Callable[[], Session]] = {
    "empty": lambda: _pressed(source=EMPTY),
    "pause": _pressed,
    "pause-dark": lambda: _pressed("i", "e", source="hyperstatic", theme="dark"),
    "pause-colour-blind": lambda: _pressed("i", "e", source="hyperstatic", theme="colour-blind"),
    "pause-colour-blind-dark": lambda: _pressed("i", "e", source="hyperstatic", theme="colour-blind-dark"),
    "drawing-a-force": _drawing_a_force,
    "drawing-a-wall": _drawing_a_wall,
    "simulation-at-rest": _simulation_at_rest,
    "properties": _properties,
    "save": _save,
    "load": _load,
    "force-method": _force_method,
    "help": lambda: _pressed("f1"),
}
