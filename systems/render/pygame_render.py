"""Render: the picture of the session, drawn only when something changed."""

from __future__ import annotations

from typing import Any

import pygame

from systems.base import Phase, System
from systems.render.picture import compose
from systems.render.pygame_canvas import Canvas
from systems.render.theme import Theme


class PygameRender(System):
    """Composes and draws the picture on `surface`; `drawn` tells whether the last frame needed it."""

    name = "render.pygame"
    phase = Phase.RENDER

    def __init__(self, surface: pygame.Surface, theme: Theme) -> None:
        self.surface = surface
        self.theme = theme
        self.drawn = False
        self._canvas = Canvas()
        self._shown: Any = None

    def process(self, frame: Any) -> None:
        """Draw, unless the picture would be the same as the last."""
        session = frame.session
        shown = (session.model.revision, repr(session.view), id(self.surface), self.theme)
        self.drawn = shown != self._shown
        if self.drawn:
            self._canvas.draw(self.surface, compose(session.model, session.view, self.theme))
            self._shown = (session.model.revision, *shown[1:])
