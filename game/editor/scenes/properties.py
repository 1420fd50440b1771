"""Properties: the Fields of elements, as boxes to type into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pinjoint.components.camera import Camera, Viewport
from pinjoint.components.field import MADE, Vector
from pinjoint.components.form import Form
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.components.view import LEAST_BESIDE, View, drawn_positions
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.form import FormScene
from pinjoint.systems.edit.picking import pick
from pinjoint.systems.forms import answers, properties, results
from pinjoint.systems.render.model.sheet import Stage
from pinjoint.systems.render.ui.form import FormLayout


class Properties(FormScene):
    """The Fields of the selected elements, or of the environment, beside the model.

    What a box takes acts as soon as it is accepted. All boxes of a visit are one entry of the log.
    """

    name = "properties"
    heading = marked("Properties")

    def __init__(self) -> None:
        super().__init__()
        self._return_to: tuple[str, ...] = ("pause",)  # also whose tools act beside the boxes
        self._at_left = False
        self._looked: tuple[object, ...] = ()  # the camera and the part of the window beside the boxes, and
        self._camera = Camera()  # what shows the model there
        self._read: tuple[object, ...] = ()  # what the readings were made from
        self._made = 0  # the revision of the model that the boxes show

    def enter(self, context: Context) -> None:
        super().enter(context)
        self._at_left = _is_right(context, context.selected)
        if not context.view.fitted:  # it is not fitted anew beside the boxes
            for at_left in (True, False):  # where nothing is covered, in the right column rather
                aside = context.view.beside(at_left=at_left)
                if aside is not None and replace(context.view, aside=aside).shows(context.model):
                    self._at_left = at_left
        self._looked = ()

    def make_form(self, context: Context) -> Form:
        model, selected = context.model, context.selected
        form = Form(properties.heading(model, selected), lambda box: answers.problem(model, box))
        form.boxes = properties.boxes_of(model, selected)
        form.readings = [*results.results(model, selected, known=context.view.forces_known)]
        self._read, self._made = (), model.newest(*MADE)
        return form

    def exit(self, context: Context) -> None:
        refused = self._apply(context, typing=True)
        if refused:
            context.notice = joined(map(begun, refused))
        self._return_to = ("pause",)
        super().exit(context)

    # --- live --------------------------------------------------------------------------------------

    def _apply(self, context: Context, *, typing: bool = False) -> list[str]:
        """Give the model what is accepted; the boxes then say what it has. Returns the sentences about refused ones."""
        before = context.model.revision
        with context.document.history.as_one(("properties", id(self.form))):
            refused = answers.apply(self.form, context.model, typing=typing)
        if context.model.revision != before:
            self.form.heading = properties.heading(context.model, context.selected)
            properties.refresh(self.form, context.model, context.selected)
            self._read_results(context)
        return refused

    def changed(self, context: Context) -> None:
        self._apply(context)

    def next_box(self, context: Context, by: int) -> None:
        super().next_box(context, by)
        self._apply(context)

    def click(self, context: Context, pixel: Vector) -> None:
        super().click(context, pixel)
        self._apply(context)

    def click_box(self, context: Context, title: str) -> None:
        super().click_box(context, title)
        self._apply(context)

    def accept(self, context: Context) -> None:
        """Return: accept the selected box; without one, leave."""
        if self.form.selected is None:
            self.leave(context)
        elif self.typing.accept():
            self._apply(context)
        else:
            self.form.selected.marked = True

    @property
    def tools(self) -> str:
        return self._return_to[-1]

    def opened_from(self, scene: str) -> None:
        """Leaving goes back to that scene."""
        self._return_to = ("pause", scene) if scene == "simulation" else (scene,)

    def leave(self, context: Context) -> None:
        context.scenes.request(*self._return_to)

    def hint(self, context: Context) -> str:
        if self.form.selected is not None:
            return tr("Return accept     Esc take back     Tab next box")
        return tr("Click a box     Tab next box     Esc back")

    # --- beside the model --------------------------------------------------------------------------

    def _aside(self, context: Context) -> Viewport | None:
        return context.view.beside(at_left=self._at_left)

    def viewport(self, context: Context) -> Viewport:
        return self._aside(context) or super().viewport(context)

    def covers(self, context: Context) -> bool:
        return self._aside(context) is None

    def stages(self, context: Context) -> Sequence[Stage]:
        model, view = self._beside(context)
        self._read_results(context)
        if view.aside is None:
            return [(self.form, view)]
        return [(model, view), (self.form, replace(view, status=context.view.status))]

    def layout(self, context: Context) -> FormLayout:
        """Where boxes are as results stand above them, whether a picture was drawn or not."""
        self._read_results(context)
        return super().layout(context)

    def _read_results(self, context: Context) -> None:
        """Let the readings say what the elements do now."""
        model, known = context.model, context.view.forces_known
        now = id(self.form), model.revision, known, self.form.heading
        if now != self._read:
            self._read = now
            self.form.readings = [*results.results(model, context.selected, known=known)]
        made = model.newest(*MADE)
        if made != self._made:  # as by a slider beside them
            self._made = made
            properties.refresh(self.form, model, context.selected)

    def _beside(self, context: Context) -> tuple[Model, View]:
        """The model where it was, and what is seen of it beside the boxes."""
        aside, view = self._aside(context), context.view
        if aside is None:
            return context.model, view
        beside = replace(view, aside=aside, keys=(), status=replace(view.status, hint=""))
        roomy = view.canvas.width - aside.width >= LEAST_BESIDE * view.pixel_ratio + aside.width
        beside.readouts = view.readouts if roomy else ()
        beside.camera = self._camera_beside(context.model, beside)
        return context.model, beside

    def _camera_beside(self, model: Model, view: View) -> Camera:
        """The camera as it is; of a model that was wholly in sight and would be covered in part, one that shows it."""
        now = replace(view.camera), view.canvas
        if now != self._looked:
            self._looked, self._camera = now, now[0]
            if view.fitted and not view.shows(model):
                beside = replace(view, camera=replace(view.camera), shares=False)
                beside.fit(model)
                self._camera = beside.camera
        return replace(self._camera)

    def click_beside(self, context: Context, pixel: Vector) -> None:
        """A click on another element shows its boxes."""
        if not self.typing.accept() or self.viewport(context).contains(pixel):
            return
        hit = pick(*self._beside(context), pixel)
        if hit is not None and [hit] != context.selected:
            self.turn_to(context, hit)

    def turn_to(self, context: Context, handle: Handle) -> None:
        """Apply these boxes and show those of another element."""
        if self.typing.accept():
            self._apply(context)
            super().turn_to(context, handle)
            self.form = self.make_form(context)


def _is_right(context: Context, selected: Sequence[Handle]) -> bool:
    """True if the selected elements are in the right half of the picture."""
    model, camera, rows_by_table = context.model, context.view.camera, context.model.rows_of(selected)
    places = [getattr(handle, point) for handle in selected for point in handle.points]
    ends = model.rods.between[rows_by_table["rods"]].ravel()
    rows = np.concatenate([rows_by_table["particles"], ends.astype(np.intp)])
    points = np.concatenate([drawn_positions(model)[rows], np.reshape(places, (-1, 2))])
    return len(points) > 0 and bool(camera.to_pixels(points)[:, 0].mean() > camera.middle[0])
