"""Supporting: a support is dragged to where its ground is to be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from components.field import Vector
from components.particle import Particle
from components.view import Preview
from game.editor.gestures.drawing import DrawFromParticle
from systems.edit.picking import PARTICLE_REACH
from systems.edit.supports import NAMES, next_support, support, support_towards

if TYPE_CHECKING:
    from game.session import Session

SMALLEST_RIM = 5.0  # points, of a particle as it is drawn


class DrawSupport(DrawFromParticle):
    """The support of a particle, or of all that are selected if it is one of them.

    Who hardly drags at all meant to click, which leads to the next kind.
    """

    tool = "support"

    def __init__(self, session: Session, particle: Particle) -> None:
        super().__init__(session, particle)
        selected = [handle for handle in session.selected if isinstance(handle, Particle)]
        self._particles = selected if particle in selected else [particle]
        self.hint = "ground below or above: held in y     at a side: in x     between: both     Esc cancel"

    def drop(self, session: Session, pixel: Vector) -> None:
        along = self._along(session, pixel)
        particles = [particle for particle in self._particles if particle.exists]
        if along is None:
            name = next_support(session.model, particles)
        else:
            name = support(session.model, particles, support_towards(along))
        others = f" and {len(particles) - 1} more" if len(particles) > 1 else ""
        session.notice = f"{session.name(self.particle)}{others}: {name}"

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        """The symbol on the side to which it was dragged, with its point on the particle's rim."""
        along, (x, y) = self._along(session, pixel), self.start(session)
        if along is None:
            return None
        fixed, camera = support_towards(along), session.view.camera
        level = abs(along[0]) > abs(along[1])
        side = (math.copysign(1.0, along[0]), 0.0) if level else (0.0, math.copysign(1.0, along[1]))
        rim = max(self.particle.radius, SMALLEST_RIM * session.view.pixel_ratio / camera.scale)
        start = x + rim * side[0], y + rim * side[1]
        end = start[0] + side[0] / camera.scale, start[1] + side[1] / camera.scale
        return Preview("pinned" if all(fixed) else "roller", start, end, NAMES[fixed])

    def _along(self, session: Session, pixel: Vector) -> Vector | None:
        """From the particle to a pixel (m), or None if that is still on it."""
        start, end = self.start(session), session.view.camera.to_model(pixel)
        reach = PARTICLE_REACH * session.view.pixel_ratio / session.view.camera.scale
        along = end[0] - start[0], end[1] - start[1]
        return along if math.hypot(*along) > max(reach, self.particle.radius) else None
