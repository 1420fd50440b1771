"""Statics: the mode in which the equilibrium of the structure is shown, solved anew after every edit."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

from pinjoint.components.bent import MOMENT
from pinjoint.components.field import CM, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod
from pinjoint.components.tags import DiagramShown, Selected
from pinjoint.components.view import Pin, View
from pinjoint.editor.context import Context, Scene
from pinjoint.systems.base import Phase, System
from pinjoint.systems.edit.picking import PARTICLE_REACH
from pinjoint.systems.edit.rods import share_at


class Statics(Scene):
    """The equilibrium under the load, by first-order or exact theory: a function of the document, beside its state."""

    name = "statics"
    heading = marked("Statics")
    targets = ("pause", "simulation", "properties", "save", "load", "force method")

    def enter(self, context: Context) -> None:
        """Show the diagrams of all elements, unless some are shown."""
        view = context.view
        if not (view.all_diagrams or context.model.any_tagged(DiagramShown)):
            view.all_diagrams, view.quantity = True, MOMENT

    def type(self, context: Context, text: str) -> None:
        """Digits take the pinned numbers to that distance."""
        pin = pinned(context)
        if pin is not None and set(text) <= set("0123456789.,"):
            context.notice = ""  # that the same key lets no time pass
            retype(context, pin, pin.typed + text.replace(",", "."))

    def hint(self, context: Context) -> str:
        if pinned(context) is not None:
            return tr("type x in cm     Esc or click again: take it away     Return properties     F1 help")
        if context.model.particles.count == 0:
            return tr("click a tool, then the canvas     right click menu     F1 help")
        return tr(
            "click select     I diagrams N, M, V     N table     Z theory     Space run     Q pause     F1 help"
        )


# --- numbers along members ----------------------------------------------------------------------------


def distance_at(model: Model, view: View, handle: Handle, pixel: Vector) -> float | None:
    """How far from the start of a rod (m) a pixel of it lies; None unless statics shows forces that change along it."""
    if not isinstance(handle, Rod) or model.solution is None or not view.forces_known:
        return None
    if not (handle.bending_stiffness or any(handle.distributed_force)):
        return None
    share = share_at(handle, view.camera.to_model(pixel))
    return min(max(share, 0.0), 1.0) * (handle.original_length if model.first_order else handle.length)


def pinned(context: Context) -> Pin | None:
    """The place on the selected rod whose numbers stay, if there is one."""
    pin, model = context.view.pin, context.model
    if pin is None or model.solution is None or not context.view.forces_known:
        return None
    return pin if model.tagged(Selected) == [pin.rod] else None


def pin_at(context: Context, hit: Handle | None, pixel: Vector) -> None:
    """Let the numbers at a pixel of a rod stay, or no more if it is where they stay already."""
    view, old, distance = context.view, pinned(context), None
    if isinstance(hit, Rod):
        distance = distance_at(context.model, view, hit, pixel)
    if old is not None and old.rod is hit and distance is not None:
        again = abs(old.distance - distance) * view.camera.scale <= PARTICLE_REACH * view.pixel_ratio
        distance = None if again else distance
    view.pin = Pin(hit, distance) if isinstance(hit, Rod) and distance is not None else None


def retype(context: Context, pin: Pin, typed: str) -> None:
    """Take pinned numbers to a typed distance (cm), as far as it is a number."""
    with suppress(ValueError):
        context.view.pin = replace(pin, distance=float(f"0{typed}") / CM[1], typed=typed)


class Solve(System):
    """Finds the static equilibrium of what was edited in the frame."""

    name = "statics.solve"
    phase = Phase.EDIT
    after = ("edit.actions",)
    scenes = ("statics", "properties")
    reads = ("document", "scene")
    writes = ("solution",)
    unneeded = marked("the model has no rods")

    def needs(self, model: Model) -> bool:
        return bool(model.rods.count)

    def process(self, frame: Any) -> None:
        """Solve, if anything changed."""
        if frame.model.solution is not None:  # not beside boxes that pause leads to
            frame.session.document.statics.solve()
