"""Discs on their way: the arrays of the flight kernels, their growth, and what comes out.

Importing this module imports numba; do so only where a plan is built.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from systems.collision import disc, state
from systems.collision.flight.kernels import advance
from systems.collision.impact.kernels import DIRECT
from systems.collision.state import Reason
from systems.collision.window.kernels import JOINED

Array = NDArray[np.float64]

REPORT = 4096  # impacts reported at a time
REST_HEIGHT = 1e-9  # of the radius; larger: bouncing ends sooner


@dataclass(frozen=True)
class Impacts:
    """Impacts in the order in which they happened.

    pairs: the two discs, shape (k, 2). time: s. impulse: N·s, along the line of centres. loss: energy lost, J.
    """

    pairs: NDArray[np.int64]
    time: Array
    impulse: Array
    loss: Array

    def __len__(self) -> int:
        return len(self.time)


class Discs:
    """Discs that fly, collide and rest on one another."""

    def __init__(
        self,
        position: ArrayLike,
        velocity: ArrayLike,
        radius: ArrayLike,
        inverse_mass: ArrayLike,
        *,
        displacement: ArrayLike = 0.0,
        acceleration: ArrayLike = 0.0,
        restitution: float = 1.0,
        rest_height: float = REST_HEIGHT,
        joined: Sequence[tuple[int, int]] | NDArray[Any] = (),
        time: float = 0.0,
    ) -> None:
        """Take over the state at `time` (s).

        position: original, shape (n, 2), m. velocity: shape (n, 2), m/s, 0 in held directions. radius: shape
        (n,), m. inverse_mass: of each direction, shape (n, 2), 1/kg, 0 where it is held. displacement: m;
        acceleration: m/s², without contacts. joined: pairs that never collide.
        """
        place = np.atleast_2d(np.asarray(position, dtype=np.float64))
        n = len(place)
        self.rows = np.zeros((n, disc.WIDTH))
        self.rows[:, disc.OX : disc.OY + 1] = place
        self.rows[:, disc.UX : disc.UY + 1] = displacement
        self.rows[:, disc.VX : disc.VY + 1] = velocity
        self.rows[:, disc.WX : disc.WY + 1] = inverse_mass
        self.rows[:, disc.GX : disc.GY + 1] = acceleration
        self.rows[:, disc.GX : disc.GY + 1][self.rows[:, disc.WX : disc.WY + 1] == 0.0] = 0.0
        self.rows[:, disc.AX : disc.AY + 1] = self.rows[:, disc.GX : disc.GY + 1]
        self.rows[:, disc.RADIUS] = radius
        self.rows[:, disc.EPOCH] = time
        self.numbers = np.zeros(state.NUMBERS)
        self.numbers[state.NOW] = time
        self.numbers[state.RESTITUTION] = restitution
        self.numbers[state.REST_HEIGHT] = rest_height
        self.counts = np.zeros(state.COUNTS, dtype=np.int64)
        self.counts[state.RENEW] = 1
        self.changes = np.zeros(n, dtype=np.int64)
        self.first, self.partners, self.bonds = _bonds(n, joined)
        self.boxes = np.zeros((n, 4))
        self.layer = np.zeros(n, dtype=np.int64)
        self.levels = np.zeros(64, dtype=np.int64)
        self.found = np.zeros(n, dtype=np.int64)
        self.members = np.full((2, n), -1, dtype=np.int64)
        self.mobility = np.zeros((n, 2))
        self.velocities = np.zeros((4, n, 2))
        self.matrix = np.zeros((DIRECT + 1, DIRECT))
        self._reserve_queue(2 * n + 64)
        self._reserve_grid(2)
        self._reserve_contacts(4 * n + 64)
        self.report = np.zeros((max(REPORT, len(self.links)), 2), dtype=np.int64)
        self.details = np.zeros((len(self.report), 3))

    # --- room -------------------------------------------------------------------------------------

    def _reserve_queue(self, size: int) -> None:
        self.times, self.meetings = np.zeros(size), np.zeros((size, 4), dtype=np.int64)

    def _reserve_grid(self, layers: int) -> None:
        n = len(self.rows)
        buckets = 1 << int(np.ceil(np.log2(max(4 * n * layers, 16))))
        self.heads = np.full(buckets, -1, dtype=np.int64)
        self.entries = np.zeros((4 * n * layers, 3), dtype=np.int64)

    def _reserve_contacts(self, size: int) -> None:
        self.links = np.zeros((size, 2), dtype=np.int64)
        self.contacts = np.zeros((size, 5))
        self.marks = np.zeros((3, size), dtype=np.int64)

    def _arrays(self) -> tuple[Any, ...]:
        return (
            self.rows, self.changes, self.boxes, self.layer, self.levels, self.heads, self.entries,
            self.first, self.partners, self.bonds, self.times, self.meetings, self.found, self.members,
            self.links, self.contacts, self.mobility, self.velocities, self.marks, self.matrix,
            self.report, self.details, self.numbers, self.counts,
        )  # fmt: skip

    # --- time -------------------------------------------------------------------------------------

    def advance(self, until: float, most_strikes: int = 2**62) -> tuple[Reason, Impacts]:
        """Let everything happen up to a time (s), at most `most_strikes` strikes; returns why it stopped, and impacts."""
        taken = [self._take()]
        while True:
            before = self.counts[state.STRIKES]
            reason = Reason(advance(until, most_strikes, *self._arrays()))
            most_strikes -= self.counts[state.STRIKES] - before
            taken.append(self._take())
            if reason is Reason.QUEUE_FULL:
                self.counts[state.RENEW] = 1
                self._reserve_queue(2 * len(self.times))
            elif reason is Reason.GRID_FULL:
                self._reserve_grid(int(self.counts[state.LAYERS]) + 1)
            elif reason is Reason.GROUP_FULL:
                self._reserve_contacts(2 * len(self.links))
                self.report = np.zeros((max(REPORT, len(self.links)), 2), dtype=np.int64)
                self.details = np.zeros((len(self.report), 3))
            elif reason is not Reason.REPORT_FULL:
                return reason, _joined_together(taken)

    def _take(self) -> Impacts:
        k = int(self.counts[state.REPORTED])
        self.counts[state.REPORTED] = 0
        details = self.details[:k].copy()
        return Impacts(self.report[:k].copy(), details[:, 0], details[:, 1], details[:, 2])

    @property
    def now(self) -> float:
        """Time (s) up to which everything has happened."""
        return float(self.numbers[state.NOW])

    @property
    def impacts(self) -> int:
        """How many there were."""
        return int(self.counts[state.IMPACTS])

    def state_at(self, time: float) -> tuple[Array, Array]:
        """Displacements (m) and velocities (m/s) at a time (s) between the last impact and the next."""
        rows = self.rows
        s = (time - rows[:, disc.EPOCH])[:, None]
        u, v, a = rows[:, disc.UX : disc.UY + 1], rows[:, disc.VX : disc.VY + 1], rows[:, disc.AX : disc.AY + 1]
        return u + s * (v + 0.5 * s * a), v + s * a


def _bonds(n: int, joined: Any) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int8]]:
    """Pairs as rows of partners: those of disc i are partners[first[i] : first[i + 1]]."""
    pairs = np.asarray(joined, dtype=np.int64).reshape(-1, 2)
    ends = np.concatenate([pairs, pairs[:, ::-1]])
    ends = ends[np.lexsort((ends[:, 1], ends[:, 0]))]
    first = np.searchsorted(ends[:, 0], np.arange(n + 1)).astype(np.int64)
    return first, np.ascontiguousarray(ends[:, 1]), np.full(len(ends), JOINED, dtype=np.int8)


def _joined_together(parts: list[Impacts]) -> Impacts:
    columns = ("pairs", "time", "impulse", "loss")
    return Impacts(*(np.concatenate([getattr(part, name) for part in parts]) for name in columns))
