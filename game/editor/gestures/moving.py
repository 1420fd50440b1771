"""Dragging: elements while time stands still, a hand that pulls a particle while it passes, a box to select."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import Field, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, joined, marked, tr
from pinjoint.components.load import DIRECTIONS, SpanLoad
from pinjoint.components.mistake import Mistake
from pinjoint.components.particle import Particle
from pinjoint.components.view import BETWEEN, Preview, drawn_at
from pinjoint.editor.context import Context, Gesture, tell
from pinjoint.editor.gestures.drawing import STEP, along, scale_said
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.arrows import Loaded, arrow_scale, borne_at
from pinjoint.systems.edit.picking import Grip, inside
from pinjoint.systems.edit.placing import Movable, check_free, snapped, snapped_to_points
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.edit.typed import tidy
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.physics.pace import natural_pace

LATELY = 0.08  # s shown before a particle is let go, in which the pointer's velocity is what it is thrown at
FLICK = 8.0  # points by which it moves then, at least
LEVEL = 0.1  # cosine from which on an arrow counts as one towards or away from what bears it


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
            x, y = np.subtract(drawn_at(context.model, leader), leader.position).tolist()
            check_free(context.model, context.view, (target[0] + x, target[1] + y), besides=particles)


class MovePoint(Placing):
    """Drags one point of an element, such as the end of a wall."""

    def __init__(self, context: Context, grip: Grip) -> None:
        context.select(grip.element)
        self._held = grip

    def place(self, context: Context, pixel: Vector) -> str:
        element, point = self._held.element, self._held.point
        target = snapped_to_points(context.model, context.view, pixel, type(element), besides=element)
        context.model.assign([element], point, [target])
        named = tr(context.model.tables[element.table].fields[point].title)
        return tr(
            "{element}, {point}: {place}",
            element=begun(heading(context.model, [element])),
            point=named,
            place=written.place(target, written.DIGITS),
        )


class MoveArrow(Placing):
    """Drags the arrow of a load: forces and moments change by the scale of arrows that are drawn, places along rods."""

    def __init__(self, context: Context, element: Loaded, fields: Sequence[Field[Any]], pixel: Vector) -> None:
        self._element, self._from, self._said = element, pixel, ""
        self._values = {field: getattr(element, field.name) for field in fields}
        self._axes = np.eye(2)  # of forces
        said = []
        if fields[0].unit != "m":  # a place
            self._scale = arrow_scale(context.model, context.view, fields[0].name)
            said = [scale_said(context, fields[0])]
        self.hint = joined([tr(Placing.hint), tr("Shift: free"), *said], BETWEEN)
        if isinstance(element, SpanLoad) and element.direction == DIRECTIONS[1]:
            x, y = context.model.rods.difference[element.rod] / context.model.rods.original_length[element.rod]
            self._axes = np.array([[x, y], [-y, x]])
        force = np.zeros(2)
        if fields[0].shape:
            force = max((np.array(value) for value in self._values.values()), key=np.linalg.norm) @ self._axes
        out = np.subtract(
            pixel, context.view.camera.to_pixels(borne_at(context.model, context.view, element, pixel))
        )
        ahead = float(out @ (force * [1.0, -1.0]))
        held_at_tail = ahead < -LEVEL * float(np.hypot(*out) * np.hypot(*force))  # it ends at the element
        self._way = -1.0 if held_at_tail else 1.0

    def place(self, context: Context, pixel: Vector) -> str:
        for field, value in self._values.items():
            self._said = self._drag(context, field, value, pixel)
        return tr("{element}: {value}", element=begun(self._element.said), value=self._said)

    def _drag(self, context: Context, field: Field[Any], value: Any, pixel: Vector) -> str:
        """Change one Field from a value as a pointer there says; returns what it is then."""
        model, view = context.model, context.view
        step = 1.0 if self.free else STEP
        if field.unit == "m":
            rod = model.rods[self._element.rod]  # type: ignore[union-attr]
            value = along(context, rod, pixel, 0.0 if self.free else STEP)
        else:
            points = np.subtract(pixel, self._from) * [1.0, -1.0] / view.pixel_ratio
            added = step * self._scale * np.round(points / step)
            if field.shape:
                value = tuple(tidy(part) for part in (value + self._way * self._axes @ added).tolist())
            else:
                value = tidy(value - float(added[0]))  # above what bears it, counter-clockwise is to the left
        model.assign([self._element], field.name, [value])
        return written.length(value) if field.unit == "m" else written.stated(value, field.unit)

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        """What it is now, at the pointer."""
        at = context.view.camera.to_model(pixel)
        return Preview("", at, at, self._said)


class PullParticle(Gesture):
    """Pulls a particle by a spring while time passes, and throws it if it is let go in a flick; see systems/edit/pull.py."""

    hint = marked("pull with the pointer     let go to release it, in a flick to throw it")

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
        # Where the pointer was of late, by simulated time, which a recording that is played knows, too.
        self._path = deque([(context.time, particle.displacement)], maxlen=64)  # places

    def move(self, context: Context, pixel: Vector) -> None:
        x, y = context.view.camera.to_model(pixel)
        original, scale = self._particle.position, context.model.settings.displacement_scale
        hand = context.document.pull.hand
        if hand is not None:
            anchor = ((x - original[0]) / scale, (y - original[1]) / scale)
            context.document.timeline.hold(hand.at(anchor))
            if self._path[-1][0] == context.time:
                self._path.pop()
            self._path.append((context.time, anchor))

    def drop(self, context: Context, pixel: Vector) -> None:
        hand, velocity = context.document.pull.hand, self._flick(context)
        if hand is None or velocity is None or (hand := hand.throwing(context.model, velocity)).thrown is None:
            self.cancel(context)
            return
        context.document.timeline.hold(hand)
        speed = written.stated(math.hypot(*hand.thrown), "m/s", 3)
        tell(context, tr("thrown at {speed}.", speed=speed), self._particle)

    def _flick(self, context: Context) -> Vector | None:
        """The velocity of the pointer (m/s) over the last LATELY seconds shown; None if it moved less than FLICK."""
        view, model, now = context.view, context.model, context.time
        lately = LATELY * context.document.live.clock.factor * natural_pace(model)
        begun, start = next(
            (place for place in reversed(self._path) if place[0] <= now - lately), self._path[0]
        )
        (before, _), (last, end) = self._path[max(len(self._path) - 2, 0)], self._path[-1]
        moved, passed = np.subtract(end, start), (last if now - last < 1.5 * (last - before) else now) - begun
        passed = max(passed, lately - (last - before))  # less passes where the machine cannot keep the pace
        points = moved * model.settings.displacement_scale * view.camera.scale / view.pixel_ratio
        if np.hypot(*points) < FLICK:
            return None
        x, y = (moved / passed).tolist()
        return x, y

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
