"""Render: the picture of the session, drawn only when something changed.

A toolbar that stays as it was is not drawn again: 3 of 23 ms of a picture with diagrams of 104 members, more of a small run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import pygame

from pinjoint.components.form import Form
from pinjoint.components.language import language
from pinjoint.components.model import Model
from pinjoint.components.toolbar import Toolbar
from pinjoint.components.units import units_on_screen
from pinjoint.components.view import View
from pinjoint.systems.base import Phase, System
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from pinjoint.systems.render.backends.raster import Raster
from pinjoint.systems.render.labels.placing import Placed
from pinjoint.systems.render.model.sheet import Shown, Stage
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme


class PygameRender(System):
    """Composes and draws the picture on `surface`; `drawn` tells whether the last frame needed it.

    shown: all that the picture on it follows from; None: it is to be drawn anew.
    """

    name = "render.pygame"
    phase = Phase.RENDER
    after = ("render.view",)
    reads = ("document", "state", "view")
    writes = ("surface",)

    def __init__(self, surface: pygame.Surface, raster: Callable[[], Raster | None] = lambda: None) -> None:
        self.surface = surface
        self.drawn = False
        self._canvas = Canvas(raster)
        self.shown: Any = None
        self._bar: object = None  # what the toolbar follows from that is drawn
        self._placed: dict[str, Placed] = {}

    def process(self, frame: Any) -> None:
        """Draw every stage of the scene, unless the picture would be the same as the last."""
        stages = frame.session.stages
        shown = id(self.surface), _looks(stages)
        self.drawn = shown != self.shown
        if self.drawn:
            before, self.shown = self.shown, None  # until all of it is drawn
            bar, former = _bar(stages), self._bar
            if before is not None and before[0] == id(self.surface) and bar == former is not None:
                stages = [stage for stage in stages if not isinstance(stage[0], Toolbar)]
            self._bar = bar
            theme = load_theme(frame.session.view.theme)
            self._placed = {_looked_at(*stage): self._placed.get(_looked_at(*stage), {}) for stage in stages}
            for picture in compose_all(stages, theme, lambda *stage: self._placed[_looked_at(*stage)]):
                self._canvas.draw(self.surface, picture)
            self.shown = id(self.surface), _looks(frame.session.stages)  # drawing may compute forces


def draw_unseen(frame: Any, size: tuple[int, int]) -> None:
    """Draw a frame as in a window of that size in pixels, to find what cannot be drawn."""
    PygameRender(pygame.Surface(size, depth=32)).process(frame)


def _bar(stages: Sequence[Stage]) -> object:
    """All that the strip of the toolbar follows from; None where others may be drawn there, or it reaches beyond."""
    bar, view = next((stage for stage in stages if isinstance(stage[0], Toolbar)), (None, None))
    if bar is None or view is None or view.help or view.menu:
        return None
    beside = (view is own or own.camera.viewport.left >= view.strip.right for _, own in stages)
    pointed = view.pointer is not None and view.strip.contains(view.pointer)
    if pointed or not all(beside) or any(isinstance(shown, Form) for shown, _ in stages):
        return None
    return language(), units_on_screen(), view.theme, view.pixel_ratio, view.camera.viewport, view.legend, bar


def _looked_at(shown: Shown, view: View) -> str:
    """The model and the view of a stage: while they are the same, labels keep their places."""
    return f"{shown.context if isinstance(shown, Model) else ''} {view.camera}"


def _looks(stages: Sequence[Stage]) -> tuple[object, ...]:
    """All that the pictures of some stages follow from."""
    shown = (
        s.looks if isinstance(s, Form) else (s.context, s.revision) if isinstance(s, Model) else s
        for s, _ in stages
    )
    return language(), units_on_screen(), tuple(view.looks for _, view in stages), tuple(shown)
