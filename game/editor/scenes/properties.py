"""Properties: what elements are, as boxes to type into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

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
from game.editor.scenes.base import Stage
from game.editor.scenes.form import FormScene
from systems.edit.picking import pick
from systems.forms import answers, properties, typing
from systems.render.form_layout import beside

if TYPE_CHECKING:
    from game.session import Session


class Properties(FormScene):
    """What the selected elements are, or the environment. Leaving applies all boxes at once."""

    name = "properties"
    heading = "Properties"

    def __init__(self) -> None:
        super().__init__()
        self._return_to: tuple[str, ...] = ("pause",)
        self._at_left = False

    def enter(self, session: Session) -> None:
        super().enter(session)
        self._at_left = _is_right(session, session.selected)

    def make_form(self, session: Session) -> Form:
        model, selected = session.model, session.selected
        form = Form(properties.heading(model, selected), lambda box: answers.problem(model, box))
        properties.fill(form, model, selected)
        return form

    def exit(self, session: Session) -> None:
        self._apply(session)
        self._return_to = ("pause",)
        super().exit(session)

    def _apply(self, session: Session) -> None:
        refused = answers.apply(self.form, session.model)
        if refused:
            session.notice = " ".join(sentence[:1].upper() + sentence[1:] for sentence in refused)

    def opened_from(self, scene: str) -> None:
        """Leaving goes back to that scene."""
        self._return_to = ("pause", scene) if scene == "simulation" else ("pause",)

    def leave(self, session: Session) -> None:
        session.scenes.request(*self._return_to)

    def accept(self, session: Session) -> None:
        """Return: accept the selected box; without one, leave."""
        if self.form.selected is None:
            self.leave(session)
        elif not typing.accept(self.form):
            self.form.selected.marked = True

    def hint(self, session: Session) -> str:
        if self.form.selected is not None:
            return "Return accept     Esc restore     Tab next box"
        return "Click a box     Tab next box     Esc apply and go back"

    # --- beside the model --------------------------------------------------------------------------

    def _split(self, session: Session) -> tuple[Viewport | None, Viewport]:
        view = session.view
        return beside(view.camera.viewport, view.pixel_ratio, at_left=self._at_left)

    def viewport(self, session: Session) -> Viewport:
        return self._split(session)[1]

    def stages(self, session: Session) -> Sequence[Stage]:
        form = super().stages(session)
        return form if self._split(session)[0] is None else [self.focus(session), *form]

    def focus(self, session: Session) -> tuple[Model, View]:
        """The model beside the boxes."""
        rest, view = self._split(session)[0], session.view
        camera = view.camera
        if rest is not None:  # what was seen in the whole window still is
            scale = camera.scale * rest.width / camera.viewport.width
            camera = replace(camera, viewport=rest, scale=scale)
        status = replace(view.status, hint="")
        return session.model, replace(view, camera=camera, keys=[], status=status, toolbar=Toolbar())

    def click_beside(self, session: Session, pixel: Vector) -> None:
        """A click on another element shows that one's properties, once these are applied."""
        if not typing.accept(self.form) or self.viewport(session).contains(pixel):
            return
        hit = pick(*self.focus(session), pixel)
        if hit is not None and [hit] != session.selected:
            self._apply(session)
            session.select(hit)
            self.form = self.make_form(session)


def _is_right(session: Session, selected: Sequence[Handle]) -> bool:
    """True if the selected elements are in the right half of the picture."""
    model, camera = session.model, session.view.camera
    entities: dict[type, list[int]] = {Particle: [], Rod: []}
    places = [getattr(handle, point) for handle in selected for point in handle.points]
    for handle in selected:
        if type(handle) in entities:
            entities[type(handle)].append(handle.entity)
    ends = model.rods.between[model.row_of_entity[entities[Rod]]].ravel()
    rows = np.concatenate([model.row_of_entity[entities[Particle]], ends.astype(np.intp)])
    points = np.concatenate([drawn_positions(model)[rows], np.reshape(places, (-1, 2))])
    return len(points) > 0 and bool(camera.to_pixels(points)[:, 0].mean() > camera.middle[0])
