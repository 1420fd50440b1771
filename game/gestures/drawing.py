"""Drawing: rods from particle to particle; forces and velocities as arrows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from components.field import Vector
from components.particle import Particle
from components.view import Preview, drawn_positions
from game.gestures.base import Gesture
from systems.edit.arrows import arrow_end, arrow_value, usual_force, usual_speed
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
        return drawn_at(session, self.particle)


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
        return Preview("rod", start, drawn_at(session, other), label)


class DrawArrow(Drawing):
    """A vector of a particle, as an arrow from it."""

    title: ClassVar[str]
    unit: ClassVar[str]

    def __init__(self, session: Session, particle: Particle) -> None:
        super().__init__(session, particle)
        key = self.tool[0].upper()
        self.hint = f"{self.tool} of {particle.name}: {key} or click where its arrow ends     Esc cancel"

    def usual(self, session: Session) -> float:
        """The size that an arrow of comfortable length stands for."""
        raise NotImplementedError

    def value(self, session: Session, pixel: Vector) -> Vector:
        """What the arrow to a pixel stands for."""
        return arrow_value(session.view, self.start(session), pixel, self.usual(session))

    def told(self, value: Vector) -> str:
        """A value as it is shown."""
        return f"({value[0]:g}, {value[1]:g}) {self.unit}"

    def drop(self, session: Session, pixel: Vector) -> None:
        value = self.value(session, pixel)
        session.model.assign([self.particle], self.tool, [value])
        session.notice = f"{self.title} {self.particle.name}: {self.told(value)}"

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        value, start = self.value(session, pixel), self.start(session)
        end = arrow_end(session.view, start, value, self.usual(session))
        return Preview(self.tool, start, end, self.told(value))


class DrawForce(DrawArrow):
    """The constant force on a particle."""

    tool, title, unit = "force", "Force on", "kN"

    def usual(self, session: Session) -> float:
        return usual_force(session.model)


class DrawVelocity(DrawArrow):
    """The velocity of a particle; zero where it is held."""

    tool, title, unit = "velocity", "Velocity of", "m/s"

    def __init__(self, session: Session, particle: Particle) -> None:
        if all(particle.fixed):
            raise Refusal(f"{particle.name} is held in both directions and cannot move; C frees it.")
        super().__init__(session, particle)

    def usual(self, session: Session) -> float:
        return usual_speed(session.model)

    def value(self, session: Session, pixel: Vector) -> Vector:
        x, y = super().value(session, pixel)
        held = self.particle.fixed
        return 0.0 if held[0] else x, 0.0 if held[1] else y


TOOL_HINTS = {
    "place": "particles: click where they are to be     Esc done",
    "support": "supports: click particles, again for the next kind     Esc done",
    "rod": "rods: click two particles, or drag from one to another     L or Esc done",
    "force": "forces: drag an arrow from a particle     F or Esc done",
    "velocity": "velocities: drag an arrow from a particle     V or Esc done",
}
TOOLS: dict[str, type[DrawRod | DrawForce | DrawVelocity]] = {
    kind.tool: kind for kind in (DrawRod, DrawForce, DrawVelocity)
}


def drawn_at(session: Session, particle: Particle) -> Vector:
    """Where a particle is drawn (m)."""
    x, y = drawn_positions(session.model)[particle.row].tolist()
    return x, y
