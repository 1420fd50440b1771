"""Properties: the Fields of elements, as boxes to type into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from components.camera import Viewport
from components.field import Vector
from components.form import Form
from components.handle import Handle
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.toolbar import Toolbar
from components.view import View, drawn_positions
from game.editor.context import Context, Stage
from game.editor.scenes.form import FormScene
from systems.edit.picking import pick
from systems.forms import answers, properties, typing
from systems.render.form_layout import beside


class Properties(FormScene):
    """The Fields of the selected elements, or of the environment. Leaving applies all boxes at once."""

    name = "properties"
    heading = "Properties"

    def __init__(self) -> None:
        super().__init__()
        self._return_to: tuple[str, ...] = ("pause",)
        self._at_left = False

    def enter(self, context: Context) -> None:
        super().enter(context)
        self._at_left = _is_right(context, context.selected)

    def make_form(self, context: Context) -> Form:
        model, selected = context.model, context.selected
        form = Form(properties.heading(model, selected), lambda box: answers.problem(model, box))
        properties.fill(form, model, selected)
        return form

    def exit(self, context: Context) -> None:
        self._apply(context)
        self._return_to = ("pause",)
        super().exit(context)

    def _apply(self, context: Context) -> None:
        refused = answers.apply(self.form, context.model)
        if refused:
            context.notice = " ".join(sentence[:1].upper() + sentence[1:] for sentence in refused)

    def opened_from(self, scene: str) -> None:
        """Leaving goes back to that scene."""
        self._return_to = ("pause", scene) if scene == "simulation" else ("pause",)

    def leave(self, context: Context) -> None:
        context.scenes.request(*self._return_to)

    def accept(self, context: Context) -> None:
        """Return: accept the selected box; without one, leave."""
        if self.form.selected is None:
            self.leave(context)
        elif not typing.accept(self.form):
            self.form.selected.marked = True

    def hint(self, context: Context) -> str:
        if self.form.selected is not None:
            return "Return accept     Esc restore     Tab next box"
        return "Click a box     Tab next box     Esc apply and go back"

    # --- beside the model --------------------------------------------------------------------------

    def _split(self, context: Context) -> tuple[Viewport | None, Viewport]:
        view = context.view
        return beside(view.camera.viewport, view.pixel_ratio, at_left=self._at_left)

    def viewport(self, context: Context) -> Viewport:
        return self._split(context)[1]

    def stages(self, context: Context) -> Sequence[Stage]:
        form = super().stages(context)
        return form if self._split(context)[0] is None else [self.focus(context), *form]

    def focus(self, context: Context) -> tuple[Model, View]:
        """The model beside the boxes."""
        rest, view = self._split(context)[0], context.view
        camera = view.camera
        if rest is not None:  # the same part of the model as in the whole window
            scale = camera.scale * rest.width / camera.viewport.width
            camera = replace(camera, viewport=rest, scale=scale)
        status = replace(view.status, hint="")
        return context.model, replace(view, camera=camera, keys=[], status=status, toolbar=Toolbar())

    def click_beside(self, context: Context, pixel: Vector) -> None:
        """A click on another element applies these boxes and shows those of that element."""
        if not typing.accept(self.form) or self.viewport(context).contains(pixel):
            return
        hit = pick(*self.focus(context), pixel)
        if hit is not None and [hit] != context.selected:
            self._apply(context)
            context.select(hit)
            self.form = self.make_form(context)


def _is_right(context: Context, selected: Sequence[Handle]) -> bool:
    """True if the selected elements are in the right half of the picture."""
    model, camera = context.model, context.view.camera
    entities: dict[type, list[int]] = {Particle: [], Rod: []}
    places = [getattr(handle, point) for handle in selected for point in handle.points]
    for handle in selected:
        if type(handle) in entities:
            entities[type(handle)].append(handle.entity)
    ends = model.rods.between[model.row_of_entity[entities[Rod]]].ravel()
    rows = np.concatenate([model.row_of_entity[entities[Particle]], ends.astype(np.intp)])
    points = np.concatenate([drawn_positions(model)[rows], np.reshape(places, (-1, 2))])
    return len(points) > 0 and bool(camera.to_pixels(points)[:, 0].mean() > camera.middle[0])
