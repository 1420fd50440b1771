"""Moving by dragging: particles while time stands still, a hand that pulls one while it passes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from components.field import FieldError, Vector
from components.particle import Particle
from components.view import Preview, drawn_positions
from game.gestures.base import Gesture
from systems.edit.moving import movable, move, rows_of
from systems.edit.placing import check_free, snapped
from systems.edit.pull import hand_on
from systems.edit.refusal import Refusal

if TYPE_CHECKING:
    from components.world import Handle
    from game.session import Session


class Move(Gesture):
    """Dragging elements moves their original positions. One entry of the log, however far it goes."""

    hint = "let go to place     Esc put back"

    def __init__(self, session: Session, hit: Handle, pixel: Vector) -> None:
        selected = session.selected
        chosen = selected if hit in selected else [hit]
        if chosen == [hit]:
            session.select(hit)
        model = session.model
        self._particles = movable(model, chosen)
        self._start = model.particles.position[rows_of(model, self._particles)]
        self._leader = 0  # the one that keeps to the grid
        if isinstance(hit, Particle):
            self._leader = self._particles.index(hit)
        self._grip = np.subtract(self._start[self._leader], session.view.camera.to_model(pixel))

    def move(self, session: Session, pixel: Vector) -> None:
        model, view = session.model, session.view
        wanted = np.add(view.camera.to_model(pixel), self._grip)
        target = snapped(model, view, (float(wanted[0]), float(wanted[1])))
        leader = self._particles[self._leader]
        moved = np.subtract(drawn_positions(model)[leader.row], leader.position)
        try:
            check_free(model, view, (target[0] + moved[0], target[1] + moved[1]), besides=self._particles)
            with session.history.as_one(self):
                move(model, self._particles, self._start + np.subtract(target, self._start[self._leader]))
        except (Refusal, FieldError) as error:
            session.notice = str(error)
        else:
            session.notice = self._told(leader)

    def _told(self, leader: Particle) -> str:
        x, y = leader.position
        others = f" and {len(self._particles) - 1} more" if len(self._particles) > 1 else ""
        return f"{leader.name}{others}: ({100.0 * x:.6g}, {100.0 * y:.6g}) cm"

    def drop(self, session: Session, pixel: Vector) -> None:
        self.move(session, pixel)

    def cancel(self, session: Session) -> None:
        session.history.retract(self)

    def leave(self, session: Session) -> None:
        """What was moved stays where it is."""


class PullParticle(Gesture):
    """Dragging a particle while time passes pulls it by a spring; see systems/edit/pull.py."""

    hint = "pull with the pointer     let go to release"

    def __init__(self, session: Session, particle: Particle) -> None:
        if session.settings.displacement_scale == 0.0:
            raise Refusal("Displacements are drawn at scale 0, so nothing can be pulled; set it above 0.")
        self._particle = particle
        session.simulation.advance(0)
        session.desk.beside.disturb()
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
