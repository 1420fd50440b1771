"""Dragging: elements while time stands still, a hand that pulls a particle while it passes, a box to select."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, joined, marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.view import BETWEEN, Preview, drawn_positions
from pinjoint.editor.context import Context, Gesture
from pinjoint.editor.gestures.drawing import STEP, scale_said
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.arrows import arrow_scale
from pinjoint.systems.edit.picking import Grip, inside
from pinjoint.systems.edit.placing import Movable, check_free, snapped, snapped_to_points
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.physics.pace import natural_pace


class Placing(Gesture):
    """A drag of which every move changes the document; all its moves are one entry of the log."""

    hint = marked("let go to place it     Esc put it back")

    def place(self, context: Context, pixel: Vector) -> str:
        """Change the document as a pointer there says; returns what is said of it. Raises Refusal or FieldError."""
        raise NotImplementedError

    def move(self, context: Context, pixel: Vector) -> None:
        try:
            with context.document.history.as_one(self):
                context.notice = self.place(context, pixel) or context.notice
        except Mistake as error:
            context.notice = str(error)

    def drop(self, context: Context, pixel: Vector) -> None:
        self.move(context, pixel)

    def cancel(self, context: Context) -> None:
        context.document.history.retract(self)

    def leave(self, context: Context) -> None:
        """The elements stay where they are."""


class Move(Placing):
    """Drags elements, by their original positions."""

    def __init__(self, context: Context, hit: Handle, pixel: Vector) -> None:
        selected = context.selected
        chosen = selected if hit in selected else [hit]
        if chosen == [hit]:
            context.select(hit)
        self._movable = Movable(context.model, chosen)
        self._start = self._movable.positions
        self._leader = self._movable.index(hit)  # the row of the element under the pointer keeps to the grid
        self._grip = np.subtract(self._start[self._leader], context.view.camera.to_model(pixel))

    def place(self, context: Context, pixel: Vector) -> str:
        model, view = context.model, context.view
        wanted = np.add(view.camera.to_model(pixel), self._grip)
        target = snapped(model, view, (float(wanted[0]), float(wanted[1])))
        self._check_free(context, target)
        self._movable.place(self._start + np.subtract(target, self._start[self._leader]))
        particles, others, count = self._movable.particles, self._movable.others, len(self._movable)
        leader: Any = particles[self._leader] if self._leader < len(particles) else others[0]
        named = leader.said
        if count > 1:
            named = tr("{element} and {count} more", element=named, count=count - 1)
        return tr("{element}: {value}", element=named, value=written.place(target, written.DIGITS))

    def _check_free(self, context: Context, target: Vector) -> None:
        """Raise Refusal if the leading particle would come to lie on another."""
        particles = self._movable.particles
        if self._leader < len(particles):
            leader = particles[self._leader]
            x, y = np.subtract(drawn_positions(context.model)[leader.row], leader.position).tolist()
            check_free(context.model, context.view, (target[0] + x, target[1] + y), besides=particles)


class MovePoint(Placing):
    """Drags one point of an element, such as the end of a wall."""

    def __init__(self, context: Context, grip: Grip) -> None:
        context.select(grip.element)
        self._held = grip

    def place(self, context: Context, pixel: Vector) -> str:
        element, point = self._held.element, self._held.point
        target = snapped_to_points(context.model, context.view, pixel, besides=element)
        context.model.assign([element], point, [target])
        named = tr(context.model.tables[element.table].fields[point].title)
        return tr(
            "{element}, {point}: {place}",
            element=begun(heading(context.model, [element])),
            point=named,
            place=written.place(target, written.DIGITS),
        )


class MoveArrow(Placing):
    """Drags the arrow of a load on a particle or a rod: its force changes, by the scale of arrows that are drawn."""

    def __init__(self, context: Context, element: Particle | Rod, pixel: Vector) -> None:
        self._element, self._from = element, pixel
        self._field = Particle.force if isinstance(element, Particle) else Rod.distributed_force
        self._force = getattr(element, self._field.name)
        self.hint = joined([tr(Placing.hint), tr("Shift: free"), scale_said(context, self._field)], BETWEEN)
        rows = [element.row] if isinstance(element, Particle) else [end.row for end in element.ends]
        middle = context.view.camera.to_pixels(drawn_positions(context.model)[rows].mean(axis=0))
        out = np.subtract(pixel, middle) * [1.0, -1.0]
        self._way = (
            -1.0 if float(out @ self._force) < 0.0 else 1.0
        )  # it ends at the element, and is held at its tail

    def place(self, context: Context, pixel: Vector) -> str:
        scale = arrow_scale(context.model, context.view, self._field.name)
        points = np.subtract(pixel, self._from) * [1.0, -1.0] / context.view.pixel_ratio
        step = 1.0 if self.free else STEP
        added = self._way * step * scale * np.round(points / step)
        value = tuple(float(f"{part:.12g}") for part in np.add(self._force, added).tolist())
        context.model.assign([self._element], self._field.name, [value])
        return tr(
            "{element}: {value}",
            element=begun(self._element.said),
            value=written.stated(value, self._field.unit),
        )


class PullParticle(Gesture):
    """Pulls a particle by a spring while time passes; see systems/edit/pull.py."""

    hint = marked("pull with the pointer     let go to release it")

    def __init__(self, context: Context, particle: Particle) -> None:
        if context.model.settings.displacement_scale == 0.0:
            raise Refusal(
                "Displacements are drawn at scale 0, so nothing can be pulled; set the displacement scale above 0."
            )
        self._particle = particle
        context.simulation.advance(0)
        context.document.assessment.disturb("pulled")
        context.document.timeline.hold(
            Hand.on(context.model, context.view, particle, lambda: natural_pace(context.model))
        )

    def move(self, context: Context, pixel: Vector) -> None:
        x, y = context.view.camera.to_model(pixel)
        original, scale = self._particle.position, context.model.settings.displacement_scale
        hand = context.document.pull.hand
        if hand is not None:
            anchor = ((x - original[0]) / scale, (y - original[1]) / scale)
            context.document.timeline.hold(hand.at(anchor))

    def drop(self, context: Context, pixel: Vector) -> None:
        self.cancel(context)

    def cancel(self, context: Context) -> None:
        context.document.timeline.hold(None)

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        hand = context.document.pull.hand
        if hand is None or not self._particle.exists:
            return None
        scale = context.model.settings.displacement_scale
        start, end = (
            (self._particle.position[0] + scale * u[0], self._particle.position[1] + scale * u[1])
            for u in (self._particle.displacement, hand.anchor)
        )
        return Preview("pull", start, end, written.force(math.hypot(*context.document.pull.force)))


class BoxSelect(Gesture):
    """Selects the elements inside a box. adding: the elements selected before stay selected."""

    hint = marked("let go to select what is inside     Esc cancel")

    def __init__(self, context: Context, pixel: Vector, *, adding: bool) -> None:
        self._corner = context.view.camera.to_model(pixel)
        self._adding = adding

    def drop(self, context: Context, pixel: Vector) -> None:
        found = inside(context.model, self._corner, context.view.camera.to_model(pixel))
        context.select(*(context.selected if self._adding else ()), *found)

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        return Preview("box", self._corner, context.view.camera.to_model(pixel))
