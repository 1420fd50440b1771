"""Hover: what a click would hit is marked before the click."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from components.tags import Hovered
from systems.base import Phase, System
from systems.edit.picking import pick

if TYPE_CHECKING:
    from components.model import Model


class Hover(System):
    """Marks the element under the pointer."""

    name = "edit.hover"
    phase = Phase.EDIT
    scenes = ("simulation", "pause", "properties", "force method")

    def needs(self, model: Model) -> bool:
        return model.particles.count + model.grids.count > 0

    def process(self, frame: Any) -> None:
        """Move the mark if the pointer is over something else now."""
        model, view = frame.session.focus
        pointer = frame.session.view.pointer
        inside = pointer is not None and view.camera.viewport.contains(pointer)
        hit = pick(model, view, pointer) if inside else None
        before = model.tagged(Hovered)
        if before == [hit] or (hit is None and not before):
            return
        for handle in before:
            model.untag(handle, Hovered)
        if hit is not None:
            model.tag(hit, Hovered)
