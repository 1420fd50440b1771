"""The window: pygame-ce around a session; and pictures of a session without a display."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

import pygame

from components.camera import Viewport
from components.model import Model
from game.script import Recorder
from game.session import Session
from systems.base import System
from systems.edit.hover import Hover
from systems.input.pygame_input import PygameInput
from systems.render.picture import compose
from systems.render.pygame_canvas import Canvas
from systems.render.pygame_render import PygameRender
from systems.render.theme import load_theme

FRAME_RATE = 60  # Hz
FIRST_SIZE = (1000, 720)  # points
SMALLEST_SIZE = (320, 240)


class NoDisplay(RuntimeError):
    """There is nowhere to open a window; the message is the reason."""


def open_window(model: Model, title: str, record: tuple[str | None, Any] = (None, None)) -> None:
    """Show a model until the person closes the window. Raises NoDisplay.

    record: the file to write what the person does to, if any, and the model as the script names it.
    """
    app = App(model, title)
    path, source = record
    if path is None:
        app.run()
        return
    with open(path, "w", encoding="utf-8") as file:
        Recorder(app.session, file, source)
        app.run()


class App:
    """The window and its session."""

    def __init__(self, model: Model, title: str, theme: str = "light") -> None:
        os.environ.setdefault("SDL_WINDOWS_DPI_AWARENESS", "permonitorv2")
        try:
            pygame.display.init()
            self.window = pygame.Window(
                f"{title} – Pinjoint" if title else "Pinjoint", FIRST_SIZE, resizable=True, allow_high_dpi=True
            )
        except pygame.error as error:
            raise NoDisplay(str(error)) from None
        self.window.minimum_size = SMALLEST_SIZE
        pygame.key.set_repeat(400, 40)
        self.input = PygameInput()
        self.render = PygameRender(self.window.get_surface(), load_theme(theme))
        systems: list[System] = [self.input, Hover(), self.render]
        self.session = Session(model, systems)
        self.session.window = self
        self._follow_size()
        self.session.view.fit(model)
        self._full_screen = False

    def run(self) -> None:
        """Frames at 60 Hz until the window is closed."""
        clock = pygame.time.Clock()
        before = time.perf_counter()
        while not self.input.closed:
            now = time.perf_counter()
            self.frame(now - before)
            before = now
            clock.tick(FRAME_RATE)
        pygame.display.quit()

    def frame(self, elapsed: float) -> None:
        """One frame: input, steps and picture."""
        self._follow_size()
        self.session.frame(elapsed)
        if self.render.drawn:
            self.window.flip()

    def _follow_size(self) -> None:
        """Let the viewport and the size of type follow the window, and the display's pixel density."""
        surface = self.window.get_surface()
        self.render.surface = surface
        view = self.session.view
        viewport = Viewport(0, 0, *surface.get_size())
        if viewport != view.camera.viewport:
            view.camera.viewport = viewport
            view.pixel_ratio = surface.get_width() / max(self.window.size[0], 1)

    def toggle_full_screen(self) -> None:
        """Fill the screen, or stop doing so."""
        self._full_screen = not self._full_screen
        if self._full_screen:
            self.window.set_fullscreen(desktop=True)
        else:
            self.window.set_windowed()

    def screenshot(self) -> str:
        """Save what the window shows as a PNG in the working folder; returns its path."""
        path = _unused(Path.cwd() / "pinjoint.png")
        pygame.image.save(self.render.surface, path)
        return str(path)


def _unused(path: Path) -> Path:
    number = 1
    candidate = path
    while candidate.exists():
        number += 1
        candidate = path.with_stem(f"{path.stem}-{number}")
    return candidate


def render_png(session: Session, path: str, size: tuple[int, int], theme: str = "light") -> None:
    """Draw a session to a PNG file, without a display. Raises OSError if it cannot be written."""
    surface = pygame.Surface(size, depth=32)
    view = session.view
    view.camera.viewport = Viewport(0, 0, *size)
    view.fit(session.model)
    session.update_view()
    Canvas().draw(surface, compose(session.model, view, load_theme(theme)))
    with open(path, "wb") as file:
        pygame.image.save(surface, file, path if path.lower().endswith((".png", ".jpg", ".bmp")) else ".png")
