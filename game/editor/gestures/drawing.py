"""Drawing: rods from particle to particle; forces and velocities as arrows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from components.field import Vector
from components.handle import Handle
from components.particle import Particle
from components.view import Preview, drawn_positions
from game.editor.gestures.base import Gesture
from systems.edit.arrows import arrow_end, arrow_value, usual_force, usual_speed
from systems.edit.picking import pick_particle
from systems.edit.placing import snapped_to_points
from systems.edit.refusal import Refusal
from systems.edit.rods import check_ends, distance, join

if TYPE_CHECKING:
    from game.session import Session


class Drawing(Gesture):
    """What clicks and drags draw while a tool is in hand."""

    tool: ClassVar[str]

    @classmethod
    def begin(cls, session: Session, pixel: Vector) -> Drawing | None:
        """A new one that begins at a pixel; None if it cannot begin there, or another of its kind is to go on."""
        raise NotImplementedError


class DrawFromParticle(Drawing):
    """What begins at a particle."""

    def __init__(self, session: Session, particle: Particle) -> None:
        self.particle = particle

    @classmethod
    def begin(cls, session: Session, pixel: Vector) -> Drawing | None:
        particle = pick_particle(session.model, session.view, pixel)
        return cls(session, particle) if particle is not None else None

    def start(self, session: Session) -> Vector:
        """Where that particle is drawn (m). Raises Refusal if it is gone."""
        if not self.particle.exists:
            raise Refusal("The particle where this began was deleted meanwhile; begin at another one.")
        return drawn_at(session, self.particle)


class DrawRod(DrawFromParticle):
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


class DrawArrow(DrawFromParticle):
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


class DrawElement(Drawing):
    """An element of a mod's kind with two points, from one to the other."""

    kind: ClassVar[type[Handle]]
    key: ClassVar[str]

    def __init__(self, session: Session, pixel: Vector) -> None:
        self.from_ = snapped_to_points(session.model, session.view, pixel)
        self.hint = f"{self.kind.noun}: {self.key.upper()} or click where it ends     Esc cancel"

    @classmethod
    def begin(cls, session: Session, pixel: Vector) -> Drawing | None:
        if isinstance(session.gesture, cls) or session.view.strip.contains(pixel):
            return None
        return cls(session, pixel)

    def drop(self, session: Session, pixel: Vector) -> None:
        end = snapped_to_points(session.model, session.view, pixel)
        if end == self.from_:
            raise Refusal(f"A {self.kind.noun} goes from one point to another; end it elsewhere.")
        first, last = self.kind.points
        [made] = session.model.create(self.kind, 1, **{first: [self.from_], last: [end]})
        session.select(made)
        session.notice = f"{session.name(made)}: {_length_and_angle(self.from_, end)}"

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        end = snapped_to_points(session.model, session.view, pixel)
        return Preview("rod", self.from_, end, _length_and_angle(self.from_, end))


def _length_and_angle(start: Vector, end: Vector) -> str:
    angle = math.degrees(math.atan2(end[1] - start[1], end[0] - start[0])) + 0.0
    return f"{math.dist(start, end):.6g} m, {angle:.4g}°"


def drawing_of(kind: type[Handle], tool: str, key: str) -> type[DrawElement]:
    """What draws elements of a kind with two points; `tool` is the name of its action."""
    return type(f"Draw{kind.__name__}", (DrawElement,), {"kind": kind, "tool": tool, "key": key})


TOOL_HINTS = {
    "place": "click where particles are to be     Esc done",
    "support": "supports: drag from a particle to its ground, or click for the next kind     Esc done",
    "rod": "rods: click two particles, or drag from one to another     L or Esc done",
    "force": "forces: drag an arrow from a particle     F or Esc done",
    "velocity": "velocities: drag an arrow from a particle     V or Esc done",
}
TOOLS: dict[str, type[Drawing]] = {kind.tool: kind for kind in (DrawRod, DrawForce, DrawVelocity)}


def drawn_at(session: Session, particle: Particle) -> Vector:
    """Where a particle is drawn (m)."""
    x, y = drawn_positions(session.model)[particle.row].tolist()
    return x, y
