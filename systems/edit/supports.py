"""Supports: holding particles in one direction or both, and their rotation."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pinjoint.components.field import Vector
from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle, supported
from pinjoint.components.rod import rigid_joints

Held = tuple[bool, bool, bool]  # in x, in y, and the rotation

# What each kind of support is called by the action of menus and by people, in the order in which pressing the key goes
# through them; those that hold the rotation only where rigid rod ends would turn.
SUPPORTS: dict[Held, tuple[str, str]] = {
    (False, False, False): ("free", marked("free")),
    (True, True, False): ("pin", marked("pinned: held in x and y")),
    (True, True, True): ("clamp", marked("clamped: held in x and y, cannot turn")),
    (False, True, False): ("hold y", marked("roller: held in y")),
    (True, False, False): ("hold x", marked("roller: held in x")),
    (False, True, True): ("guide y", marked("guided: held in y, cannot turn")),
    (True, False, True): ("guide x", marked("guided: held in x, cannot turn")),
    (False, False, True): ("hold rotation", marked("cannot turn, free in x and y")),
}
SPRING = 1000.0  # kN/m, and kN·m/rad, of new springs
_DIAGONAL = math.tan(math.pi / 8.0)  # tan 22.5°; a direction farther from an axis counts along both


def held(particle: Particle) -> Held:
    """What a particle's support holds."""
    return (*particle.fixed, particle.fixed_rotation)


def next_support(model: Model, particles: Sequence[Particle]) -> str:
    """Give particles the support after that of the first one; returns its name."""
    turns, now = rigid_joints(model)[particles[0].row], held(particles[0])
    cycle = [kind for kind in SUPPORTS if turns or not kind[2] or kind == now]
    return support(model, particles, cycle[(cycle.index(now) + 1) % len(cycle)])


def support(model: Model, particles: Sequence[Particle], wanted: Held) -> str:
    """Hold particles in x and y and their rotation, or not; returns the name of the support."""
    with model.transaction(tr("support of {particle}", particle=model.describe(particles[0]))):
        for name in ("support_springs", "rotation_spring") if any(map(is_elastic, particles)) else ():
            model.assign(list(particles), name, np.zeros_like(model.particles.column(name)[: len(particles)]))
        model.assign(list(particles), "fixed", [wanted[:2]] * len(particles))
        model.assign(list(particles), "fixed_rotation", [wanted[2]] * len(particles))
    return tr(SUPPORTS[wanted][1])


def is_elastic(particle: Particle) -> bool:
    """True if springs hold a particle."""
    return any(particle.support_springs) or particle.rotation_spring > 0.0


def put_on_springs(model: Model, particles: Sequence[Particle]) -> str:
    """Let springs hold particles where rigid supports do, in y where none does, or these again; returns what they have."""
    rows = [particle.row for particle in particles]
    now, back = supported(model)[rows], all(map(is_elastic, particles))
    if not back:
        now[:, 2] &= rigid_joints(model)[rows]
        now[~now.any(axis=1), 1] = True
    springs = np.where(now & (not back), SPRING, 0.0)
    with model.transaction(tr("support of {particle}", particle=model.describe(particles[0]))):
        model.assign(list(particles), "fixed", now[:, :2] & back)
        model.assign(list(particles), "fixed_rotation", now[:, 2] & back)
        model.assign(list(particles), "support_springs", springs[:, :2])
        model.assign(list(particles), "rotation_spring", springs[:, 2])
    return tr("held rigidly") if back else tr("held by springs")


def support_towards(along: Vector) -> tuple[bool, bool]:
    """The directions that a ground at that side holds: y below or above, x at a side, both in between."""
    across, up = abs(along[0]), abs(along[1])
    return across > _DIAGONAL * up, up > _DIAGONAL * across
