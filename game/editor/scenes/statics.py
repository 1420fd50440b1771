"""Statics: the mode in which the equilibrium of the structure is shown, solved anew after every edit."""

from __future__ import annotations

from typing import Any

from pinjoint.components.bent import MOMENT
from pinjoint.components.field import CM, on_screen
from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.components.tags import DiagramShown
from pinjoint.editor.context import Context, Scene
from pinjoint.editor.readouts import pinned, retype
from pinjoint.editor.sliders import slider_stack
from pinjoint.systems.base import Phase, System
from pinjoint.systems.input.actions import METHODS


class Statics(Scene):
    """The equilibrium under the load, by first-order or exact theory: a function of the document, beside its state."""

    name = "statics"
    heading = marked("Statics")
    targets = ("pause", "simulation", "properties", "save", "load", *METHODS)

    def enter(self, context: Context) -> None:
        """Show the diagrams of all elements, unless some are shown, and all of the model above the sliders."""
        view = context.view
        if not (view.all_diagrams or context.model.any_tagged(DiagramShown)):
            view.all_diagrams, view.quantity = True, MOMENT
        view.sliders = slider_stack(context)
        view.follow(context.model, clear=True)  # of one slider more

    def type(self, context: Context, text: str) -> None:
        """Digits take the pinned numbers to that distance."""
        pin = pinned(context)
        if pin is not None and set(text) <= set("0123456789.,"):
            context.notice = ""  # that the same key lets no time pass
            retype(context, pin, pin.typed + text.replace(",", "."))

    def hint(self, context: Context) -> str:
        if pinned(context) is not None:
            hint = marked(
                "type x in {unit}     Esc or click again: take it away     Return properties     F1 help"
            )
            return tr(hint, unit=on_screen(CM[0])[0])
        if context.model.particles.count == 0:
            return tr("click a tool, then the canvas     right click menu     F1 help")
        return tr(
            "click select     I diagrams N, M, V     N table     Z theory     Space run     Q pause     F1 help"
        )


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
