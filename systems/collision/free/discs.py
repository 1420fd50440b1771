"""Discs on their way: the arrays of the flight kernels, their growth, and what comes out.

Importing this module imports numba; do so only where a plan is built.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from components.obstacles import NO_OBSTACLES, Obstacles
from components.paths import Paths
from systems.broad_phase import nearest
from systems.collision import columns as arrays
from systems.collision.columns import Floats, Grid, Group, Integers, Pile, Queue, Reason, Report, Ties
from systems.collision.kernels.pile import STEP_SHARE
from systems.collision.system import REST_HEIGHT

SAME_PLACE = 1e-12  # of the largest coordinate: ends of obstacles nearer than this are one
REPORT = 4096  # impacts reported at a time
MORE_PATIENCE = 64  # calm steps from one search for the equilibrium of a pile to the next


@dataclass(frozen=True)
class Impacts:
    """Impacts in the order in which they happened.

    pairs: the two discs, shape (k, 2). time: s. impulse: N·s, along the line of centres. loss: energy lost, J.
    point: where they touched, shape (k, 2), m.
    """

    pairs: Integers
    time: Floats
    impulse: Floats
    loss: Floats
    point: Floats

    def __len__(self) -> int:
        return len(self.time)


class Discs:
    """Discs that fly, collide and rest on one another.

    fly, take_steps, open_window: the kernels that advance them, compiled; a subclass has them.
    """

    fly: Callable[..., int]
    take_steps: Callable[..., int]
    open_window: Callable[..., int]

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
        obstacles: Obstacles | None = None,
        lost: float = 0.0,
    ) -> None:
        """Take over the state at `time` (s).

        position: original, shape (n, 2), m. velocity: shape (n, 2), m/s, 0 in held directions. radius: shape
        (n,), m. inverse_mass: of each direction, shape (n, 2), 1/kg, 0 where it is held. displacement: m;
        acceleration: m/s², without contacts. rest_height: bounces that would rise less, relative to the
        smaller radius, end in lasting contact. joined: pairs that never collide. obstacles: what else there is;
        in pairs they count on after the discs. lost: energy lost so far, J.
        """
        place = np.atleast_2d(np.asarray(position, dtype=np.float64))
        self._obstacles = obstacles if obstacles is not None else NO_OBSTACLES
        self.count = len(place)
        n = self.count + len(self._obstacles)
        self.rows = np.zeros((n, arrays.DISC_WIDTH))
        self._columns(arrays.OX)[...] = place
        self._columns(arrays.UX)[...] = displacement
        self._columns(arrays.VX)[...] = velocity
        self._columns(arrays.WX)[...] = inverse_mass
        self._columns(arrays.GX)[...] = acceleration
        self._columns(arrays.GX)[self._columns(arrays.WX) == 0.0] = 0.0
        self._columns(arrays.AX)[...] = self._columns(arrays.GX)
        self.rows[: self.count, arrays.RADIUS] = radius
        self.rows[: self.count, arrays.EPOCH] = time
        self.rows[: self.count, arrays.BOUNCE] = restitution
        self.rows[:, arrays.STEP] = np.inf
        added, others = self.rows[self.count :], self._obstacles
        added[:, [arrays.OX, arrays.OY]], added[:, [arrays.TX, arrays.TY]] = others.start, others.span
        added[:, arrays.RADIUS], added[:, arrays.BOUNCE] = others.radius, others.restitution
        added[:, arrays.SHARED] = _shared_ends(others)
        speed = np.abs(self._columns(arrays.VX)).sum(axis=1)
        self.rows[: self.count, arrays.NOISE] = arrays.SPEED_NOISE * speed
        self.numbers = np.zeros(arrays.NUMBERS)
        self.numbers[arrays.NOW] = time
        self.numbers[arrays.RESTITUTION] = self.rows[:, arrays.BOUNCE].min(initial=restitution)
        self.numbers[arrays.REST_HEIGHT] = rest_height
        self.counts = np.zeros(arrays.COUNTS, dtype=np.int64)
        self.counts[arrays.RENEW], self.counts[arrays.LISTED] = 1, arrays.NONE
        self.counts[arrays.DISCS] = self.count
        self.numbers[arrays.SMALLEST] = self.rows[: self.count, arrays.RADIUS].min(initial=np.inf)
        self.numbers[arrays.STEP_LENGTH] = STEP_SHARE * self._fall_time()
        self.numbers[arrays.WORK_SINCE] = time
        self.numbers[arrays.LOSS] = lost
        self.queue = _queue(2 * n + 64)
        self.grid = _grid(n, 2)
        self.group = room_for(n, 4 * n + 64)
        self.pile = _pile(n, len(self.group.links))
        self.report = _report(max(REPORT, len(self.group.links)))
        self.ties = _ties(n, joined, 2 * len(self.group.links), self.counts)

    def _columns(self, first: int) -> Floats:
        """The x and y columns of the discs that begin with one."""
        return self.rows[: self.count, first : first + 2]

    def _fall_time(self) -> float:
        """Median time (s) in which discs that are pulled fall through their diameters; ∞ without any."""
        pull = np.hypot(*self._columns(arrays.GX).T)
        radius, pull = self.rows[: self.count][pull > 0.0, arrays.RADIUS], pull[pull > 0.0]
        return float(np.median(np.sqrt(4.0 * radius / pull))) if len(pull) else np.inf

    # --- time -------------------------------------------------------------------------------------

    def advance(self, until: float, most_events: int = 2**62) -> tuple[Reason, Impacts]:
        """Let everything happen up to a time (s), at most `most_events` events.

        Returns DONE or BUSY, and the impacts.
        """
        last = int(self.counts[arrays.EVENTS]) + most_events
        taken = [self._take()]
        while True:
            reason = self._go_on(float(until), last - int(self.counts[arrays.EVENTS]))
            if self.counts[arrays.REPORTED]:
                taken.append(self._take())
            if reason in (Reason.DONE, Reason.BUSY):
                return reason, _concatenated(taken)
            self._make_room(reason)

    def _go_on(self, until: float, most_events: int) -> Reason:
        """Let a pile take its steps, or else all fly, in a window that is opened if there is none."""
        rows, grid, ties, queue, group, report = (
            self.rows,
            self.grid,
            self.ties,
            self.queue,
            self.group,
            self.report,
        )
        numbers, counts = self.numbers, self.counts
        if counts[arrays.STEPPING]:
            return Reason(
                self.take_steps(until, most_events, rows, grid, ties, self.pile, report, numbers, counts)
            )
        if counts[arrays.RENEW]:
            reason = Reason(self.open_window(rows, grid, ties, queue, numbers, counts))
            if reason is not Reason.DONE:
                return reason
        return Reason(self.fly(until, most_events, rows, grid, ties, queue, group, report, numbers, counts))

    def _make_room(self, reason: Reason) -> None:
        n = len(self.rows)
        if reason is Reason.QUEUE_FULL:
            self.counts[arrays.RENEW] = 1
            self.queue = _queue(2 * len(self.queue.times))
        elif reason is Reason.GRID_FULL:
            self.grid = _grid(n, int(self.counts[arrays.LAYERS]) + 1)
            self.counts[arrays.LISTED] = arrays.NONE
        elif reason is Reason.GROUP_FULL:
            size = 2 * len(self.group.links)
            self.group, self.pile = room_for(n, size), _pile(n, size)
            self.counts[arrays.LISTED] = arrays.NONE
            self.report = _report(max(REPORT, size))
            self.ties = _more_lasting(self.ties, 2 * size, self.counts)
        elif reason is Reason.SETTLE:
            self._settle()

    def _settle(self) -> None:
        """Put the calm pile into its equilibrium if that is near; if not, it goes on for a while."""
        from systems.collision.free.pile_equilibrium import Resting

        weight, pull = self._columns(arrays.WX), self._columns(arrays.GX)
        place = self._columns(arrays.OX) + self._columns(arrays.UX)
        radius = self.rows[: self.count, arrays.RADIUS]
        owners, entries = self._lasting_entries()
        pushing = np.sort(np.column_stack([owners, self.ties.lasting[entries, arrays.OTHER]]), axis=1)
        end = Resting(
            place,
            radius,
            weight,
            pull,
            self._may_collide,
            self._obstacles,
            pushing,
            self.ties.forces[entries],
        ).repose()
        if end is None:
            self.counts[arrays.PATIENCE] = self.counts[arrays.CALM] + MORE_PATIENCE
            return
        lying, free = self.rows[end.discs], weight[end.discs] > 0.0
        moving = lying[:, arrays.VX : arrays.VX + 2] ** 2 / 2.0
        fallen = lying[:, arrays.GX : arrays.GX + 2] * end.displacement[end.discs]
        self.numbers[arrays.LOSS] += ((moving + fallen)[free] / weight[end.discs][free]).sum()
        self._columns(arrays.UX)[...] += end.displacement
        self.rows[end.discs, arrays.VX : arrays.AY + 1] = 0.0
        self.numbers[arrays.STEP_END] = self.now
        self.ties = _more_lasting(_without_lasting(self.ties, self.counts), len(self.ties.lasting), self.counts)
        both = np.concatenate([end.pairs, end.pairs[:, ::-1]])
        own = self.rows[both[:, 0], arrays.WX : arrays.WY + 1].any(axis=1)
        self._note_lasting(both[own], np.tile(end.forces, 2)[own])
        self.counts[[arrays.STEPPING, arrays.WORK, arrays.RENEW]] = 0, 0, 1
        self.numbers[arrays.WORK_SINCE] = self.now

    def _may_collide(self, pairs: Integers) -> NDArray[np.bool_]:
        n = len(self.rows)
        owners = np.repeat(np.arange(n), np.diff(self.ties.first))
        may: NDArray[np.bool_] = np.isin(pairs @ [n, 1], owners * n + self.ties.partners, invert=True)
        return may

    def _take(self) -> Impacts:
        k = int(self.counts[arrays.REPORTED])
        self.counts[arrays.REPORTED] = 0
        details = self.report.details[:k].copy()
        return Impacts(
            self.report.pairs[:k].copy(), details[:, 0], details[:, 1], details[:, 2], details[:, 3:]
        )

    # --- what is to come, to go on with later -------------------------------------------------------

    def paths(self) -> Paths:
        """All that the future follows from besides what the discs are: with it others go on, bit for bit."""
        owners, entries = self._lasting_entries()
        pairs = np.column_stack([owners, self.ties.lasting[entries, arrays.OTHER]])
        crowd = np.concatenate(
            [self.counts[list(arrays.CROWD_COUNTS)], self.numbers[list(arrays.CROWD_NUMBERS)]]
        )
        return Paths(self.rows[: self.count, list(arrays.MOVING)], pairs, self.ties.forces[entries], crowd)

    def follow(self, paths: Paths) -> None:
        """Go on as the discs did that these paths were taken from."""
        self.rows[: self.count, list(arrays.MOVING)] = paths.motion
        counted = len(arrays.CROWD_COUNTS)
        self.counts[list(arrays.CROWD_COUNTS)] = paths.crowd[:counted]
        self.numbers[list(arrays.CROWD_NUMBERS)] = paths.crowd[counted:]
        self.counts[arrays.RENEW], self.counts[arrays.LISTED] = 1, arrays.NONE
        self._note_lasting(paths.contacts, paths.forces)

    def _note_lasting(self, pairs: Integers, forces: Floats) -> None:
        """Enter lasting contacts of the first disc of each pair with the second."""
        while len(pairs) > self.counts[arrays.SPARES]:
            self.ties = _more_lasting(self.ties, 2 * len(self.ties.lasting), self.counts)
        for (i, j), force in zip(pairs[::-1].tolist(), forces[::-1].tolist(), strict=True):
            entry = self.counts[arrays.SPARE]
            self.counts[arrays.SPARE] = self.ties.lasting[entry, arrays.NEXT]
            self.counts[arrays.SPARES] -= 1
            self.ties.lasting[entry] = j, self.ties.first_lasting[i]
            self.ties.forces[entry] = force
            self.ties.first_lasting[i] = entry

    def _lasting_entries(self) -> tuple[Integers, Integers]:
        """The discs that have lasting contacts, once for each, and the entries, in the order of the chains."""
        owners, entries = [], []
        for i in np.flatnonzero(self.ties.first_lasting != arrays.NONE).tolist():
            entry = int(self.ties.first_lasting[i])
            while entry != arrays.NONE:
                owners.append(i)
                entries.append(entry)
                entry = int(self.ties.lasting[entry, arrays.NEXT])
        return np.array(owners, dtype=np.int64), np.array(entries, dtype=np.int64)

    def contact_forces(self) -> Floats:
        """The sum of the forces (N) with which others keep each disc away in lasting contacts, shape (n, 2)."""
        owners, entries = self._lasting_entries()
        others = self.ties.lasting[entries, arrays.OTHER]
        displacement, _ = self.state_at(self.now)
        place = self.rows[:, [arrays.OX, arrays.OY]]
        place[: self.count] += displacement
        line = -nearest(place[others] - place[owners], self.rows[others][:, [arrays.TX, arrays.TY]])
        push = line * (self.ties.forces[entries] / np.hypot(line[:, 0], line[:, 1]))[:, None]
        held = (self.rows[others][:, [arrays.WX, arrays.WY]] == 0.0).all(axis=1)  # without entries of their own
        total = np.zeros_like(place)
        for d in range(2):
            total[:, d] = np.bincount(owners, push[:, d], len(place))
            total[:, d] -= np.bincount(others[held], push[held, d], len(place))
        return total[: self.count]

    @property
    def at_rest(self) -> bool:
        """True if nothing moves and nothing will."""
        return not self.rows[: self.count, arrays.VX : arrays.AY + 1].any()

    @property
    def last_change(self) -> float:
        """Time (s) at which a path last changed."""
        return float(self.rows[: self.count, arrays.EPOCH].max())

    @property
    def now(self) -> float:
        """Time (s) up to which everything has happened."""
        return float(self.numbers[arrays.NOW])

    @property
    def impacts(self) -> int:
        """How many there were."""
        return int(self.counts[arrays.IMPACTS])

    def lost_at(self, time: float) -> float:
        """Energy (J) lost until a time (s) between the last event and the next.

        What a step of a pile takes is that of its weights on straight lines, at a constant rate, and a jump at first.
        """
        lost = float(self.numbers[arrays.LOSS])
        if self.counts[arrays.STEPPING] and self.numbers[arrays.STEP_END] > time:
            weight, velocity = self._columns(arrays.WX), self._columns(arrays.VX)
            held = self._columns(arrays.GX) - self._columns(arrays.AX)
            rate = (held * velocity)[weight > 0.0] / weight[weight > 0.0]
            lost -= float(rate.sum()) * float(self.numbers[arrays.STEP_END] - time)
        return lost

    def state_at(self, time: float) -> tuple[Floats, Floats]:
        """Displacements (m) and velocities (m/s) at a time (s) between the last event and the next."""
        s = (time - self.rows[: self.count, arrays.EPOCH])[:, None]
        u, v, a = (self._columns(first) for first in (arrays.UX, arrays.VX, arrays.AX))
        return u + s * (v + 0.5 * s * a), v + s * a


def _shared_ends(others: Obstacles) -> Floats:
    """Which ends of obstacles, as in the column SHARED, are those of an earlier one with the same radius, too."""
    ends = np.concatenate([others.start, others.start + others.span])
    scale = np.abs(ends).max(initial=0.0) or 1.0
    spots = np.column_stack([np.round(ends / (scale * SAME_PLACE)), np.tile(others.radius, 2)])
    _, first, spot = np.unique(spots, axis=0, return_index=True, return_inverse=True)
    owner = np.full(len(first), len(others))
    rows = np.tile(np.arange(len(others)), 2)
    np.minimum.at(owner, spot.ravel(), rows)
    shared = (owner[spot.ravel()] < rows).reshape(2, -1)
    found: Floats = arrays.SHARED_START * shared[0] + arrays.SHARED_END * shared[1]
    return found


def _queue(size: int) -> Queue:
    return Queue(np.zeros(size), np.zeros((size, 4), dtype=np.int32))


def _grid(n: int, layers: int) -> Grid:
    entries = 4 * n * layers
    buckets = 1 << int(np.ceil(np.log2(max(entries, 16))))
    return Grid(
        boxes=np.zeros((n, 4)),
        layer=np.zeros(n, dtype=np.int64),
        levels=np.zeros(64, dtype=np.int64),
        heads=np.full(buckets, arrays.NONE, dtype=np.int32),
        after=np.zeros(2 * entries, dtype=np.int32),
        found=np.zeros(n + 1, dtype=np.int64),
    )


def room_for(n: int, contacts: int) -> Group:
    """An empty group of at most n members and so many contacts."""
    return Group(
        members=np.zeros(n, dtype=np.int64),
        place=np.full(n, arrays.NONE, dtype=np.int64),
        links=np.zeros((contacts, 2), dtype=np.int64),
        contacts=np.zeros((contacts, arrays.CONTACT_WIDTH)),
        mobility=np.zeros((n, 2)),
        motion=np.zeros((n, 2)),
        initial=np.zeros((n, 2)),
        start=np.zeros((n, 2)),
        other=np.zeros((n, 2)),
        noise=np.zeros(1),
        marks=np.zeros((3, contacts), dtype=np.int64),
        matrix=np.zeros((arrays.DIRECT + 1, arrays.DIRECT)),
    )


def _pile(n: int, pairs: int) -> Pile:
    """Room for so many pairs."""
    return Pile(
        motion=np.zeros((4, n, 2)),
        travel=np.zeros((4, n)),
        pairs=np.zeros((pairs, 2), dtype=np.int64),
        forces=np.zeros(pairs),
        chosen=np.zeros(pairs, dtype=np.int64),
        order=np.zeros(pairs, dtype=np.int64),
        ends=np.zeros((pairs, 2), dtype=np.uint32),
        contacts=np.zeros((pairs, arrays.PILE_CONTACT_WIDTH)),
        scale=np.zeros(pairs),
    )


def _report(size: int) -> Report:
    return Report(np.zeros((size, 2), dtype=np.int64), np.zeros((size, 5)))


def _ties(n: int, joined: Any, lasting: int, counts: Integers) -> Ties:
    pairs = np.asarray(joined, dtype=np.int64).reshape(-1, 2)
    ends = np.concatenate([pairs, pairs[:, ::-1]])
    ends = ends[np.lexsort((ends[:, 1], ends[:, 0]))]
    ties = Ties(
        first=np.searchsorted(ends[:, 0], np.arange(n + 1)),
        partners=np.ascontiguousarray(ends[:, 1]),
        first_lasting=np.zeros(n, dtype=np.int64),
        lasting=np.zeros((0, 2), dtype=np.int64),
        forces=np.zeros(0),
    )
    return _more_lasting(_without_lasting(ties, counts), lasting, counts)


def _without_lasting(ties: Ties, counts: Integers) -> Ties:
    """The same table without entries, used or not, of lasting contacts."""
    counts[arrays.SPARE], counts[arrays.SPARES] = arrays.NONE, 0
    none = np.full(len(ties.first_lasting), arrays.NONE, dtype=np.int64)
    return ties._replace(first_lasting=none, lasting=np.zeros((0, 2), dtype=np.int64), forces=np.zeros(0))


def _more_lasting(ties: Ties, size: int, counts: Integers) -> Ties:
    """The same table with more unused entries, chained before those there are."""
    old = len(ties.lasting)
    lasting, forces = np.zeros((size, 2), dtype=np.int64), np.zeros(size)
    lasting[:old], forces[:old] = ties.lasting, ties.forces
    lasting[old:, arrays.NEXT] = np.arange(old + 1, size + 1)
    lasting[-1, arrays.NEXT] = counts[arrays.SPARE]
    counts[arrays.SPARE] = old
    counts[arrays.SPARES] += size - old
    return ties._replace(lasting=lasting, forces=forces)


def _concatenated(parts: list[Impacts]) -> Impacts:
    columns = ("pairs", "time", "impulse", "loss", "point")
    return Impacts(*(np.concatenate([getattr(part, name) for part in parts]) for name in columns))
