"""Hover: marks the element under the pointer, or that whose arrow or support is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from pinjoint.components.additions import outlines
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.tags import Hovered
from pinjoint.components.view import View
from pinjoint.systems.base import Phase, System
from pinjoint.systems.edit.picking import pick


class Hover(System):
    """Marks the element under the pointer; beside all elements the one that `beside` finds there."""

    name = "edit.hover"
    phase = Phase.EDIT
    after = ("edit.actions",)
    reads = ("document", "view")
    writes = ("tags",)
    unneeded = marked("the model has nothing to point at")
    scenes = ("simulation", "pause", "statics", "properties", "force method", "displacement method")

    def __init__(self, beside: Callable[[Model, View, Vector], Handle | None] = lambda *where: None) -> None:
        self._beside = beside
        self._looked: Any = None  # context, revision, camera and pointer of the last frame

    def needs(self, model: Model) -> bool:
        return model.particles.count + model.grids.count > 0 or any(outlines(model))

    def process(self, frame: Any) -> None:
        """Move the mark if the pointer is over something else now."""
        model, view = frame.session.stages[0]
        if not isinstance(model, Model) or frame.session.view.steady:  # boxes cover it, or a hand drags
            return
        pointer = frame.session.view.pointer
        shown = view.canvas, pointer, view.menu, view.sliders
        if self._looked == (model.context, model.revision, view.camera, *shown):
            return
        hit = None
        if pointer is not None and view.menu is None and view.camera.viewport.contains(pointer):
            hit = pick(model, view, pointer) or self._beside(model, view, pointer)
        model.tag_only([] if hit is None else [hit], Hovered)
        self._looked = (model.context, model.revision, replace(view.camera), *shown)
