"""Pull: a spring between the pointer and the particle that a person drags while time passes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Vector
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.view import View
from pinjoint.systems.base import Law
from pinjoint.systems.edit.arrows import COMFORTABLE, usual

FOLLOWS_WITHIN = 0.5  # s shown, the period of a free particle on the spring
FOLLOWED_CLOSELY = 8  # particles without rods, among which the hand's force is followed within a step
HELD = 1e-3  # sin² of an angle: directions this near to those of rods are held by them
STEPS_PER_RADIAN = 5.0  # at least, so that the spring does not upset the integration


@dataclass(frozen=True)
class Hand:
    """A spring (kN/m) with a damper (kN·s/m) from a particle to the displacement `anchor` (m).

    thrown: the velocity (m/s) at which it lets go of the particle; None: it holds it.
    """

    particle: Particle
    stiffness: float
    damping: float
    anchor: Vector
    thrown: Vector | None = None

    @classmethod
    def on(cls, model: Model, view: View, particle: Particle, pace: Callable[[], float]) -> Hand:
        """A hand that holds a particle where it is; `pace()`: seconds simulated per second shown.

        A particle without rods follows the pointer within FOLLOWS_WITHIN. One of a structure is pulled by no
        more than the usual force of the model when the pointer is COMFORTABLE points away, so that a stiff
        truss bends instead of being torn apart. The damper is critical for the particle by itself.
        """
        clock = model.clock
        # its steps are chosen so: to them any stiffness is good
        by_error = clock.step_limit > 0.0 or clock.step_error > 0.0
        step = 0.0 if by_error else clock.step_size  # 0 where no run could begin, too
        fastest = 1.0 / (STEPS_PER_RADIAN * step) if step > 0.0 else math.inf
        if (model.rods.between == particle.row).any():
            reach = COMFORTABLE * view.pixel_ratio / view.camera.scale / model.settings.displacement_scale
            stiffness = min(particle.mass * fastest**2 / 1000.0, usual(model, "force") / reach)
        else:
            stiffness = particle.mass * min(2.0 * math.pi / (FOLLOWS_WITHIN * pace()), fastest) ** 2 / 1000.0
        damping = 2.0 * math.sqrt(1000.0 * stiffness * particle.mass) / 1000.0
        return cls(particle, stiffness, damping, particle.displacement)

    def at(self, anchor: Vector) -> Hand:
        """This hand with another anchor (m)."""
        return replace(self, anchor=anchor)

    def throwing(self, model: Model, velocity: Vector) -> Hand:
        """This hand as it lets go at a velocity (m/s), as far as supports and taut rods let that be; as it is where none."""
        row, rods = self.particle.row, model.rods
        mine = (rods.between == row).any(axis=1)
        mine &= ~(rods.tension_only & (rods.axial_force <= 0.0))
        start, end = (model.particles.displacement[rods.between[mine, side]] for side in (0, 1))
        along = rods.difference[mine] + end - start
        held = np.concatenate([along / np.hypot(*along.T)[:, None], np.eye(2)[model.particles.fixed[row]]])
        size, ways = np.linalg.eigh(held.T @ held)
        free, now = ways[:, size < HELD], model.particles.velocity[row]
        x, y = (now + free @ (free.T @ (velocity - now))).tolist()
        return replace(self, thrown=(x, y) if free.size else None)


class Pull(Law):
    """The force of the hand on one particle. Its work is accounted for; without a hand the law is left out."""

    name = "edit.pull"
    unneeded = marked("no hand pulls a particle")
    each = "particles"
    kernel = "pinjoint.systems.edit.kernels:pull"
    reads = ("particles.displacement", "particles.velocity")
    adds = ("particles.force",)
    account = "work"

    def __init__(self) -> None:
        self.hand: Hand | None = None
        self._arrays: dict[str, NDArray[np.float64]] = {}

    def needs(self, model: Model) -> bool:
        return self.hand is not None and self.hand.particle.exists

    def leaves_flight_exact(self, model: Model) -> bool:
        """Among many particles the force may be taken to be constant during a step."""
        return model.particles.count > FOLLOWED_CLOSELY

    def take(self, hand: Hand | None) -> None:
        """Pull by this hand from now on, or let go. The step program must be bound anew."""
        self.hand = hand if hand is None or hand.thrown is None else None
        self._arrays = {}

    def move(self, model: Model, anchor: Vector) -> None:
        """Pull to another displacement (m)."""
        assert self.hand is not None
        self.hand = self.hand.at(anchor)
        if self._arrays:
            self._arrays["edit_pull_anchor"][self.hand.particle.row] = anchor
        model.writable("particles.velocity")  # marks the state as changed: its forces are no longer known

    def arrays(self, model: Model) -> Mapping[str, NDArray[Any]]:
        """Stiffness, damping and anchor for each particle, zero but for the one that is pulled."""
        count = model.particles.count
        if not self._arrays or len(self._arrays["edit_pull_anchor"]) != count:
            self._arrays = {
                "edit_pull_stiffness": np.zeros(count),
                "edit_pull_damping": np.zeros(count),
                "edit_pull_anchor": np.zeros((count, 2)),
            }
            if self.hand is not None:  # else the program is got ready for one that may come
                row = self.hand.particle.row
                self._arrays["edit_pull_stiffness"][row] = self.hand.stiffness
                self._arrays["edit_pull_damping"][row] = self.hand.damping
                self._arrays["edit_pull_anchor"][row] = self.hand.anchor
        return self._arrays

    @property
    def force(self) -> Vector:
        """The hand's force (kN) now; zero without one."""
        hand = self.hand
        if hand is None:
            return 0.0, 0.0
        x, y = (
            hand.stiffness * (a - u) - hand.damping * v
            for a, u, v in zip(hand.anchor, hand.particle.displacement, hand.particle.velocity, strict=True)
        )
        return x, y

    def held_forces(self, model: Model) -> NDArray[np.float64]:
        forces = np.zeros((model.particles.count, 2))
        if self.hand is not None:
            forces[self.hand.particle.row] = self.force
        return forces
