"""Drawing: rods from particle to particle, forces and velocities as arrows, supports, elements of mods."""

from __future__ import annotations

import math
from typing import ClassVar

from components.field import Vector
from components.handle import Handle
from components.particle import Particle
from components.view import Preview, drawn_positions
from game.editor.context import Context, Gesture
from systems.edit.arrows import arrow_end, arrow_value, usual_force, usual_speed
from systems.edit.picking import PARTICLE_REACH, pick_particle
from systems.edit.placing import snapped_to_points
from systems.edit.refusal import Refusal
from systems.edit.rods import check_ends, distance, join
from systems.edit.supports import NAMES, next_support, support, support_towards


class Drawing(Gesture):
    """What clicks and drags draw while a tool is in hand."""

    tool: ClassVar[str]

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        """A new one that begins at a pixel; None if it cannot begin there, or another of its kind is to go on."""
        raise NotImplementedError


class DrawFromParticle(Drawing):
    """What begins at a particle."""

    def __init__(self, context: Context, particle: Particle) -> None:
        self.particle = particle

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        particle = pick_particle(context.model, context.view, pixel)
        return cls(context, particle) if particle is not None else None

    def start(self, context: Context) -> Vector:
        """Where that particle is drawn (m). Raises Refusal if it is gone."""
        if not self.particle.exists:
            raise Refusal("The particle where this began was deleted meanwhile; begin at another one.")
        return drawn_at(context, self.particle)


class DrawRod(DrawFromParticle):
    """From one particle to another."""

    tool = "rod"

    def __init__(self, context: Context, particle: Particle) -> None:
        super().__init__(context, particle)
        self.hint = f"rod from {particle.name}: L or click over another particle     Esc cancel"

    def drop(self, context: Context, pixel: Vector) -> None:
        self.start(context)
        other = pick_particle(context.model, context.view, pixel)
        if other is None:
            raise Refusal("A rod ends at a particle; point at one. P makes a new one.")
        rod = join(context.model, self.particle, other)
        context.notice = f"{context.name(rod)}: {rod.rest_length:.6g} m"

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        start = self.start(context)
        other = pick_particle(context.model, context.view, pixel)
        if other is None or other is self.particle:
            end = context.view.camera.to_model(pixel)
            return Preview("rod", start, end, f"{math.dist(start, end):.3g} m")
        try:
            check_ends(context.model, self.particle, other)
            label = f"{distance(self.particle, other):.6g} m"
        except Refusal:
            label = "joined already"
        return Preview("rod", start, drawn_at(context, other), label)


class DrawArrow(DrawFromParticle):
    """A vector of a particle, as an arrow from it."""

    title: ClassVar[str]
    unit: ClassVar[str]

    def __init__(self, context: Context, particle: Particle) -> None:
        super().__init__(context, particle)
        key = self.tool[0].upper()
        self.hint = f"{self.tool} of {particle.name}: {key} or click where its arrow ends     Esc cancel"

    def usual(self, context: Context) -> float:
        """The size that an arrow of comfortable length stands for."""
        raise NotImplementedError

    def value(self, context: Context, pixel: Vector) -> Vector:
        """What the arrow to a pixel stands for."""
        return arrow_value(context.view, self.start(context), pixel, self.usual(context))

    def told(self, value: Vector) -> str:
        """A value as it is shown."""
        return f"({value[0]:g}, {value[1]:g}) {self.unit}"

    def drop(self, context: Context, pixel: Vector) -> None:
        value = self.value(context, pixel)
        context.model.assign([self.particle], self.tool, [value])
        context.notice = f"{self.title} {self.particle.name}: {self.told(value)}"

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        value, start = self.value(context, pixel), self.start(context)
        end = arrow_end(context.view, start, value, self.usual(context))
        return Preview(self.tool, start, end, self.told(value))


class DrawForce(DrawArrow):
    """The constant force on a particle."""

    tool, title, unit = "force", "Force on", "kN"

    def usual(self, context: Context) -> float:
        return usual_force(context.model)


class DrawVelocity(DrawArrow):
    """The velocity of a particle; zero where it is held."""

    tool, title, unit = "velocity", "Velocity of", "m/s"

    def __init__(self, context: Context, particle: Particle) -> None:
        if all(particle.fixed):
            raise Refusal(f"{particle.name} is held in both directions and cannot move; C frees it.")
        super().__init__(context, particle)

    def usual(self, context: Context) -> float:
        return usual_speed(context.model)

    def value(self, context: Context, pixel: Vector) -> Vector:
        x, y = super().value(context, pixel)
        held = self.particle.fixed
        return 0.0 if held[0] else x, 0.0 if held[1] else y


class DrawElement(Drawing):
    """An element of a mod's kind with two points, from one to the other."""

    kind: ClassVar[type[Handle]]
    key: ClassVar[str]

    def __init__(self, context: Context, pixel: Vector) -> None:
        self.from_ = snapped_to_points(context.model, context.view, pixel)
        self.hint = f"{self.kind.noun}: {self.key.upper()} or click where it ends     Esc cancel"

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        if isinstance(context.gesture, cls) or context.view.strip.contains(pixel):
            return None
        return cls(context, pixel)

    def drop(self, context: Context, pixel: Vector) -> None:
        end = snapped_to_points(context.model, context.view, pixel)
        if end == self.from_:
            raise Refusal(f"A {self.kind.noun} goes from one point to another; end it elsewhere.")
        first, last = self.kind.points
        [made] = context.model.create(self.kind, 1, **{first: [self.from_], last: [end]})
        context.select(made)
        context.notice = f"{context.name(made)}: {_length_and_angle(self.from_, end)}"

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        end = snapped_to_points(context.model, context.view, pixel)
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


def drawn_at(context: Context, particle: Particle) -> Vector:
    """Where a particle is drawn (m)."""
    x, y = drawn_positions(context.model)[particle.row].tolist()
    return x, y


SMALLEST_RIM = 5.0  # points, of a particle as it is drawn


class DrawSupport(DrawFromParticle):
    """The support of a particle, or of all that are selected if it is one of them.

    Who hardly drags at all meant to click, which leads to the next kind.
    """

    tool = "support"

    def __init__(self, context: Context, particle: Particle) -> None:
        super().__init__(context, particle)
        selected = [handle for handle in context.selected if isinstance(handle, Particle)]
        self._particles = selected if particle in selected else [particle]
        self.hint = "ground below or above: held in y     at a side: in x     between: both     Esc cancel"

    def drop(self, context: Context, pixel: Vector) -> None:
        along = self._along(context, pixel)
        particles = [particle for particle in self._particles if particle.exists]
        if along is None:
            name = next_support(context.model, particles)
        else:
            name = support(context.model, particles, support_towards(along))
        others = f" and {len(particles) - 1} more" if len(particles) > 1 else ""
        context.notice = f"{context.name(self.particle)}{others}: {name}"

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        """The symbol on the side to which it was dragged, with its point on the particle's rim."""
        along, (x, y) = self._along(context, pixel), self.start(context)
        if along is None:
            return None
        fixed, camera = support_towards(along), context.view.camera
        level = abs(along[0]) > abs(along[1])
        side = (math.copysign(1.0, along[0]), 0.0) if level else (0.0, math.copysign(1.0, along[1]))
        rim = max(self.particle.radius, SMALLEST_RIM * context.view.pixel_ratio / camera.scale)
        start = x + rim * side[0], y + rim * side[1]
        end = start[0] + side[0] / camera.scale, start[1] + side[1] / camera.scale
        return Preview("pinned" if all(fixed) else "roller", start, end, NAMES[fixed])

    def _along(self, context: Context, pixel: Vector) -> Vector | None:
        """From the particle to a pixel (m), or None if that is still on it."""
        start, end = self.start(context), context.view.camera.to_model(pixel)
        reach = PARTICLE_REACH * context.view.pixel_ratio / context.view.camera.scale
        along = end[0] - start[0], end[1] - start[1]
        return along if math.hypot(*along) > max(reach, self.particle.radius) else None
