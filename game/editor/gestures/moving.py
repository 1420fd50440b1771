"""Moving by dragging: particles while time stands still, a hand that pulls one while it passes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from components.field import FieldError, Vector
from components.particle import Particle
from components.view import Preview, drawn_positions
from game.editor.gestures.base import Gesture
from systems.edit.moving import Movable
from systems.edit.picking import Grip
from systems.edit.placing import check_free, snapped, snapped_to_points
from systems.edit.pull import hand_on
from systems.edit.refusal import Refusal

if TYPE_CHECKING:
    from components.handle import Handle
    from game.session import Session


class _Placing(Gesture):
    """A drag whose every move changes the document; one entry of the log, however far it goes."""

    hint = "let go to place     Esc put back"

    def drop(self, session: Session, pixel: Vector) -> None:
        self.move(session, pixel)

    def cancel(self, session: Session) -> None:
        session.history.retract(self)

    def leave(self, session: Session) -> None:
        """What was moved stays where it is."""


class Move(_Placing):
    """Dragging elements moves their original positions."""

    def __init__(self, session: Session, hit: Handle, pixel: Vector) -> None:
        selected = session.selected
        chosen = selected if hit in selected else [hit]
        if chosen == [hit]:
            session.select(hit)
        self._movable = Movable(session.model, chosen)
        self._start = self._movable.positions
        self._leader = self._movable.index(hit)  # the one that keeps to the grid
        self._grip = np.subtract(self._start[self._leader], session.view.camera.to_model(pixel))

    def move(self, session: Session, pixel: Vector) -> None:
        model, view = session.model, session.view
        wanted = np.add(view.camera.to_model(pixel), self._grip)
        target = snapped(model, view, (float(wanted[0]), float(wanted[1])))
        try:
            self._check_free(session, target)
            with session.history.as_one(self):
                self._movable.place(self._start + np.subtract(target, self._start[self._leader]))
        except (Refusal, FieldError) as error:
            session.notice = str(error)
        else:
            session.notice = self._told(target)

    def _check_free(self, session: Session, target: Vector) -> None:
        """Raise Refusal if the particle that keeps to the grid would come to lie on another."""
        particles = self._movable.particles
        if self._leader < len(particles):
            leader = particles[self._leader]
            x, y = np.subtract(drawn_positions(session.model)[leader.row], leader.position).tolist()
            check_free(session.model, session.view, (target[0] + x, target[1] + y), besides=particles)

    def _told(self, target: Vector) -> str:
        particles, count = self._movable.particles, len(self._movable)
        leader = particles[self._leader] if self._leader < len(particles) else self._movable.others[0]
        others = f" and {count - 1} more" if count > 1 else ""
        return f"{leader.name}{others}: ({100.0 * target[0]:.6g}, {100.0 * target[1]:.6g}) cm"  # type: ignore[attr-defined]


class MovePoint(_Placing):
    """Dragging one point of an element, such as the end of a wall."""

    def __init__(self, session: Session, grip: Grip) -> None:
        session.select(grip.element)
        self._held = grip

    def move(self, session: Session, pixel: Vector) -> None:
        element, point = self._held.element, self._held.point
        target = snapped_to_points(session.model, session.view, pixel, besides=element)
        try:
            with session.history.as_one(self):
                session.model.assign([element], point, [target])
        except FieldError as error:
            session.notice = str(error)
        else:
            x, y = (100.0 * value for value in target)
            session.notice = f"{session.name(element)}, {point}: ({x:.6g}, {y:.6g}) cm"


class PullParticle(Gesture):
    """Dragging a particle while time passes pulls it by a spring; see systems/edit/pull.py."""

    hint = "pull with the pointer     let go to release"

    def __init__(self, session: Session, particle: Particle) -> None:
        if session.settings.displacement_scale == 0.0:
            raise Refusal("Displacements are drawn at scale 0, so nothing can be pulled; set it above 0.")
        self._particle = particle
        session.simulation.advance(0)
        session.desk.assessment.disturb()
        session.timeline.hold(hand_on(session.model, session.view, particle, lambda: session.pace))

    def move(self, session: Session, pixel: Vector) -> None:
        x, y = session.view.camera.to_model(pixel)
        original, scale = self._particle.position, session.settings.displacement_scale
        hand = session.pull.hand
        if hand is not None:
            anchor = ((x - original[0]) / scale, (y - original[1]) / scale)
            session.timeline.hold(hand.at(anchor))

    def drop(self, session: Session, pixel: Vector) -> None:
        session.timeline.hold(None)

    def cancel(self, session: Session) -> None:
        session.timeline.hold(None)

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        hand = session.pull.hand
        if hand is None or not self._particle.exists:
            return None
        scale = session.settings.displacement_scale
        start, end = (
            (self._particle.position[0] + scale * u[0], self._particle.position[1] + scale * u[1])
            for u in (self._particle.displacement, hand.anchor)
        )
        return Preview("pull", start, end, f"{math.hypot(*session.pull.force):.4g} kN")
