"""Drawing: rods from particle to particle; forces and velocities as arrows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from components.field import Vector
from components.particle import Particle
from components.view import Preview, drawn_positions
from game.gestures.base import Gesture
from systems.edit.arrows import arrow_value, usual_force, usual_speed
from systems.edit.picking import pick_particle
from systems.edit.refusal import Refusal
from systems.edit.rods import check_ends, distance, join

if TYPE_CHECKING:
    from game.session import Session


class Drawing(Gesture):
    """What begins at a particle."""

    tool: ClassVar[str]

    def __init__(self, session: Session, particle: Particle) -> None:
        self.particle = particle

    def start(self, session: Session) -> Vector:
        """Where that particle is drawn (m). Raises Refusal if it is gone."""
        if not self.particle.exists:
            raise Refusal("The particle where this began was deleted meanwhile; begin at another one.")
        x, y = drawn_positions(session.model)[self.particle.row].tolist()
        return x, y


class DrawRod(Drawing):
    """From one particle to another."""

    tool = "rod"

    def __init__(self, session: Session, particle: Particle) -> None:
        super().__init__(session, particle)
        self.hint = f"rod from {particle.name}: L or click over another particle     Esc cancel"

    def drop(self, session: Session, pixel: Vector) -> None:
        self.start(session)
        other = pick_particle(session.model, session.view, pixel)
        if other is None:
            raise Refusal("A rod ends at a particle; point at one. P makes a new one.")
        rod = join(session.model, self.particle, other)
        session.notice = f"{session.name(rod)}: {rod.rest_length:.6g} m"

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        start = self.start(session)
        other = pick_particle(session.model, session.view, pixel)
        if other is None or other is self.particle:
            end = session.view.camera.to_model(pixel)
            return Preview("rod", start, end, f"{math.dist(start, end):.3g} m")
        try:
            check_ends(session.model, self.particle, other)
            label = f"{distance(self.particle, other):.6g} m"
        except Refusal:
            label = "joined already"
        return Preview("rod", start, DrawRod(session, other).start(session), label)


class DrawForce(Drawing):
    """The constant force on a particle, as an arrow from it."""

    tool = "force"

    def __init__(self, session: Session, particle: Particle) -> None:
        super().__init__(session, particle)
        self.hint = f"force on {particle.name}: F or click where its arrow ends     Esc cancel"

    def _force(self, session: Session, pixel: Vector) -> Vector:
        return arrow_value(session.view, self.start(session), pixel, usual_force(session.model))

    def drop(self, session: Session, pixel: Vector) -> None:
        x, y = self.particle.force = self._force(session, pixel)
        session.notice = f"Force on {self.particle.name}: ({x:g}, {y:g}) kN"

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        x, y = self._force(session, pixel)
        end = session.view.camera.to_model(pixel)
        return Preview("force", self.start(session), end, f"({x:g}, {y:g}) kN")


class DrawVelocity(Drawing):
    """The velocity of a particle, as an arrow from it; zero where it is held."""

    tool = "velocity"

    def __init__(self, session: Session, particle: Particle) -> None:
        if all(particle.fixed):
            raise Refusal(f"{particle.name} is held in both directions and cannot move; C frees it.")
        super().__init__(session, particle)
        self.hint = f"velocity of {particle.name}: V or click where its arrow ends     Esc cancel"

    def _velocity(self, session: Session, pixel: Vector) -> Vector:
        drawn = arrow_value(session.view, self.start(session), pixel, usual_speed(session.model))
        held = self.particle.fixed
        return 0.0 if held[0] else drawn[0], 0.0 if held[1] else drawn[1]

    def drop(self, session: Session, pixel: Vector) -> None:
        x, y = self.particle.velocity = self._velocity(session, pixel)
        session.notice = f"Velocity of {self.particle.name}: ({x:g}, {y:g}) m/s"

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        x, y = self._velocity(session, pixel)
        end = session.view.camera.to_model(pixel)
        return Preview("velocity", self.start(session), end, f"({x:g}, {y:g}) m/s")


TOOL_HINTS = {
    "rod": "rods: click two particles, or drag from one to another     L or Esc done",
    "force": "forces: drag an arrow from a particle     F or Esc done",
    "velocity": "velocities: drag an arrow from a particle     V or Esc done",
}
TOOLS: dict[str, type[DrawRod | DrawForce | DrawVelocity]] = {
    kind.tool: kind for kind in (DrawRod, DrawForce, DrawVelocity)
}
