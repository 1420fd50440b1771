"""Colliding discs, every pair looked at after every impact, in extended precision: slow, obvious, exact.

Compiled kernels are compared with this module. Discs move along x + v t + a t²/2 between impacts. Contact is
when the distance of two centres is the sum of the radii while it shrinks; the impulse acts along the line of
centres. Simultaneous impacts that share a disc are not meant to be computed with it.

Units: m, kg, s, N·s, J. Arrays have one row per disc (x, y).
"""

from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np

from pinjoint.systems.collision.columns import Detail

Real = np.longdouble
NEVER = Real(np.inf)


@dataclass(frozen=True)
class Impact:
    """What happened at one instant to two discs."""

    time: float
    pair: tuple[int, int]
    impulse: float
    loss: float


@dataclass(frozen=True)
class Scene:
    """Discs at one time. inverse_mass: of each direction, shape (n, 2), 0 where a disc is held."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    radius: np.ndarray
    inverse_mass: np.ndarray
    restitution: float = 1.0

    def precise(self) -> "Scene":
        """Return the same scene in extended precision, at rest in held directions."""
        held = np.asarray(self.inverse_mass) == 0
        return replace(
            self,
            position=np.array(self.position, Real),
            velocity=np.where(held, Real(0), np.array(self.velocity, Real)),
            acceleration=np.where(held, Real(0), np.array(self.acceleration, Real)),
            radius=np.array(self.radius, Real),
            inverse_mass=np.array(self.inverse_mass, Real),
        )

    def after(self, duration: Real) -> "Scene":
        """Return the discs after a flight without impacts."""
        flight = self.velocity * duration + self.acceleration * duration**2 / 2
        return replace(
            self, position=self.position + flight, velocity=self.velocity + self.acceleration * duration
        )

    def kinetic_energy(self) -> float:
        """Return Σ m v²/2 over the free directions."""
        free = self.inverse_mass > 0
        return float((self.velocity[free] ** 2 / self.inverse_mass[free]).sum() / 2)


def run(scene: Scene, duration: float) -> tuple[Scene, list[Impact]]:
    """Return the scene after a time, and the impacts on the way."""
    now, end, impacts = Real(0), Real(duration), []
    scene = scene.precise()
    while True:
        waiting, pair = min((time_to_impact(scene, i, j, end - now), (i, j)) for i, j in _pairs(scene))
        if now + waiting > end:
            return scene.after(end - now), impacts
        now += waiting
        scene, impulse, loss = strike(scene.after(waiting), *pair)
        impacts.append(Impact(float(now), pair, float(impulse), float(loss)))


def time_to_impact(scene: Scene, i: int, j: int, horizon: Real) -> Real:
    """Return the least t in [0, horizon] at which f(t) = |d + v t + a t²/2|² − (r₁ + r₂)² ≤ 0 falls; else NEVER."""
    d, v, a = (column[j] - column[i] for column in (scene.position, scene.velocity, scene.acceleration))
    reach = scene.radius[i] + scene.radius[j]
    gap = [a @ a / 4, v @ a, v @ v + d @ a, 2 * d @ v, d @ d - reach**2]
    if gap[-1] <= 0 and gap[-2] < 0:
        return Real(0)
    for low, high in pairwise([Real(0), *real_roots(derivative(gap), Real(0), horizon), horizon]):
        if value(gap, low) > 0 >= value(gap, high):
            return bisect(gap, low, high)
    return NEVER


def strike(scene: Scene, i: int, j: int) -> tuple[Scene, Real, Real]:
    """Return the scene after the impact of two touching discs, the impulse, and the energy lost.

    Impulse −(1 + e) (n·Δv) / (n·(W₁ + W₂) n); each disc changes along its free directions only.
    """
    line = scene.position[j] - scene.position[i]
    normal = line / np.sqrt(line @ line)
    speed = normal @ (scene.velocity[j] - scene.velocity[i])
    compliance = normal @ ((scene.inverse_mass[i] + scene.inverse_mass[j]) * normal)
    impulse = -(1 + Real(scene.restitution)) * speed / compliance
    velocity = scene.velocity.copy()
    velocity[i] -= impulse * scene.inverse_mass[i] * normal
    velocity[j] += impulse * scene.inverse_mass[j] * normal
    loss = (1 - Real(scene.restitution) ** 2) * speed**2 / compliance / 2
    return replace(scene, velocity=velocity), impulse, loss


def amplification(scene: Scene, duration: float, size: float = 1e-9) -> float:
    """Return by how much a small error at the start has grown at the end, at least 1."""
    direction = np.random.default_rng(0).normal(size=(2, len(scene.position), 2))
    direction *= scene.inverse_mass > 0
    direction /= np.abs(direction).max()
    moved = replace(
        scene, position=scene.position + size * direction[0], velocity=scene.velocity + size * direction[1]
    )
    there, _ = run(scene, duration)
    beside, _ = run(moved, duration)
    growth = max(np.abs(there.position - beside.position).max(), np.abs(there.velocity - beside.velocity).max())
    return max(float(growth) / size, 1.0)


def distance_to_piece(first: np.ndarray, span: np.ndarray) -> Real:
    """Return the distance from the origin to the straight piece from `first` to first + span."""
    squared = span @ span
    share = min(max(-(first @ span) / squared, Real(0)), Real(1)) if squared > 0 else Real(0)
    return np.sqrt(((first + share * span) ** 2).sum())


def time_to_piece(motion: np.ndarray, span: np.ndarray, reach: float, horizon: float) -> Real:
    """Return the least t in [0, horizon] at which a piece comes as near to the origin as `reach`; else NEVER.

    motion: place, velocity and acceleration of its first end, shape (3, 2). All times at which the distance to
    either end or to the straight line through them is `reach` are looked at.
    """
    (d, v, a), span, reach = np.array(motion, Real), np.array(span, Real), Real(reach)
    parts = [[a @ a / 4, v @ a, v @ v + e @ a, 2 * e @ v, e @ e - reach**2] for e in (d, d + span)]
    if span @ span > 0:
        normal = np.array([span[1], -span[0]]) / np.sqrt(span @ span)
        parts += [[normal @ a / 2, normal @ v, normal @ d - side] for side in (reach, -reach)]
    times = sorted({time for part in parts for time in real_roots(part, Real(0), Real(horizon))})
    for early, late in pairwise([*times, Real(horizon)]):
        middle = (early + late) / 2
        if distance_to_piece(d + v * middle + a * middle**2 / 2, span) < reach:
            return early
    return NEVER


# Polynomials, highest power first


def value(polynomial: list, t: Real) -> Real:
    """Return the polynomial at t."""
    total = Real(0)
    for coefficient in polynomial:
        total = total * t + coefficient
    return total


def derivative(polynomial: list) -> list:
    """Return the coefficients of the derivative."""
    degree = len(polynomial) - 1
    return [coefficient * (degree - k) for k, coefficient in enumerate(polynomial[:-1])]


def real_roots(polynomial: list, low: Real, high: Real) -> list:
    """Return where the polynomial changes sign between low and high: between the roots of its derivative once each."""
    if len(polynomial) < 2:
        return []
    turns = [low, *real_roots(derivative(polynomial), low, high), high]
    return [
        bisect(polynomial, a, b)
        for a, b in pairwise(turns)
        if (value(polynomial, a) > 0) != (value(polynomial, b) > 0)
    ]


def bisect(polynomial: list, low: Real, high: Real) -> Real:
    """Return where the polynomial changes sign between low and high, to the last bit."""
    sign = value(polynomial, low) > 0
    while low < (middle := (low + high) / 2) < high:
        if (value(polynomial, middle) > 0) == sign:
            low = middle
        else:
            high = middle
    return high


def _pairs(scene: Scene) -> list[tuple[int, int]]:
    movable = (scene.inverse_mass > 0).any(axis=1)
    return [(i, j) for i, j in combinations(range(len(scene.radius)), 2) if movable[i] or movable[j]]


class Impacts:
    """Impacts that free discs had, a column each: pairs (k, 2), time (s), impulse (N·s), loss (J), point (k, 2) (m)."""

    def __init__(self, rows: np.ndarray) -> None:
        self.time, self.impulse, self.loss = rows[:, [Detail.TIME, Detail.IMPULSE, Detail.LOSS]].T
        self.pairs = rows[:, [Detail.FIRST, Detail.SECOND]].astype(np.int64)
        self.point = rows[:, [Detail.X, Detail.Y]]

    def __len__(self) -> int:
        return len(self.time)
