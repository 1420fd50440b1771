"""Discs in free flight: the arrays of the flight kernels, their growth, and the impacts that come out."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pinjoint.components.arrays import Array
from pinjoint.components.clock import FreeFlightState
from pinjoint.components.obstacles import NO_OBSTACLES, Obstacles
from pinjoint.systems.broad_phase import nearest
from pinjoint.systems.collision.columns import (
    FLIGHT,
    NONE,
    PILE_COUNTS,
    PILE_NUMBERS,
    SHARED_END,
    SHARED_START,
    SPEED_NOISE,
    Constraints,
    Count,
    Detail,
    Disc,
    Entry,
    Grid,
    Group,
    Integers,
    Number,
    Pile,
    Queue,
    Reason,
    zeros,
)
from pinjoint.systems.collision.system import fall_time
from pinjoint.systems.program.compiler import Choice, GeneratedModule, entries_to

_SAME_PLACE = 1e-12  # of the largest coordinate: ends of obstacles nearer than this are one
_REPORTED_AT_ONCE = 512  # impacts; fetched before more are reported
_PILE_STEP_SHARE = 0.03  # longest step of piles: of the time in which a disc falls through its diameter
# discs × events, or pairs × sweeps, after which a kernel returns: Python heeds Ctrl+C, a window draws
WORK_AT_ONCE = 2**22
_MORE_PATIENCE = 64  # calm steps between two searches for the equilibrium of a pile


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
        time: float = 0.0,
        obstacles: Obstacles = NO_OBSTACLES,
        lost: float = 0.0,
    ) -> None:
        """Take over the state at `time` (s).

        position: original, shape (n, 2), m. velocity: shape (n, 2), m/s, 0 in held directions. radius: shape
        (n,), m. inverse_mass: of each direction, shape (n, 2), 1/kg, 0 where it is held. displacement: m;
        acceleration: m/s², without contacts. obstacles: straight pieces that never move; in pairs their numbers follow
        those of the discs. lost: energy lost so far, J.
        """
        place = np.atleast_2d(np.asarray(position, dtype=np.float64))
        self._obstacles = obstacles
        self.count = len(place)
        n = self.count + len(self._obstacles)
        self.rows = np.zeros((n, len(Disc)))
        columns = (Disc.OX, place), (Disc.UX, displacement), (Disc.VX, velocity), (Disc.WX, inverse_mass)
        for first, values in (*columns, (Disc.GX, acceleration)):
            self._columns(first)[...] = values
        self._columns(Disc.GX)[self._columns(Disc.WX) == 0.0] = 0.0
        self._columns(Disc.AX)[...] = self._columns(Disc.GX)
        self.rows[: self.count, Disc.RADIUS] = radius
        self.rows[: self.count, Disc.EPOCH] = time
        self.rows[: self.count, Disc.BOUNCE] = restitution
        self.rows[:, Disc.STEP] = np.inf
        self._enter_obstacles()
        speed = np.abs(self._columns(Disc.VX)).sum(axis=1)
        self.rows[: self.count, Disc.NOISE] = SPEED_NOISE * speed
        self.numbers = np.zeros(len(Number))
        self.numbers[Number.NOW] = time
        self.numbers[Number.RESTITUTION] = self.rows[:, Disc.BOUNCE].min(initial=restitution)
        self.counts = np.zeros(len(Count), dtype=np.int64)
        self.counts[Count.RENEW], self.counts[Count.LISTED] = 1, NONE
        self.counts[Count.DISCS] = self.count
        self.numbers[Number.SMALLEST] = self.rows[: self.count, Disc.RADIUS].min(initial=np.inf)
        self.numbers[Number.STEP_LENGTH] = _PILE_STEP_SHARE * fall_time(
            self.rows[: self.count, Disc.RADIUS], np.hypot(*self._columns(Disc.GX).T)
        )
        self.numbers[Number.WORK_SINCE] = time
        self.numbers[[Number.LOSS, Number.MOST_LOSS]] = lost
        self.numbers[Number.STOP] = np.inf
        self.queue = zeros(Queue, size=2 * n + 64)
        self.grid = Grid.empty(n, 2)
        self.group = Group.empty(n, 4 * n + 64)
        self.pile = Pile.empty(n, len(self.group.links))
        self.report = np.zeros((max(_REPORTED_AT_ONCE, len(self.group.links)), len(Detail)))
        chains, entries = np.zeros(n, dtype=np.int64), np.zeros((0, 2), dtype=np.int64)
        none = Constraints(chains, entries, np.zeros(0))
        self.constraints = none.cleared(2 * len(self.group.links), self.counts)

    def _enter_obstacles(self) -> None:
        added, others = self.rows[self.count :], self._obstacles
        added[:, [Disc.OX, Disc.OY]], added[:, [Disc.TX, Disc.TY]] = others.start, others.span
        added[:, Disc.RADIUS], added[:, Disc.BOUNCE] = others.radius, others.restitution
        added[:, Disc.SHARED] = _shared_ends(others)

    def _columns(self, first: int) -> Array:
        """The x and y columns of the discs that begin with one."""
        return self.rows[: self.count, first : first + 2]

    # --- time -------------------------------------------------------------------------------------

    def advance(self, until: float, most_events: int = 2**62) -> tuple[Reason, Array]:
        """Let everything happen up to a time (s), at most `most_events` events, and not for longer than Choice allows.

        Returns DONE or BUSY, and the impacts in the order in which they happened, with the columns of Detail.
        """
        last = int(self.counts[Count.EVENTS]) + most_events
        taken = [self._take()]
        while True:
            left = last - int(self.counts[Count.EVENTS])
            reason = self._go_on(float(until), min(left, max(WORK_AT_ONCE // (self.count + 1), 1)))
            if self.counts[Count.REPORTED]:
                taken.append(self._take())
            late = self.counts[Count.EVENTS] >= last or perf_counter() > Choice.deadline
            if reason is Reason.DONE or (reason is Reason.BUSY and late):
                return reason, np.concatenate(taken)
            self._make_room(reason)

    def _go_on(self, until: float, most_events: int) -> Reason:
        """Let a pile take its steps, or else all discs fly within a horizon, which is opened if there is none."""
        rows, grid, constraints, report = self.rows, self.grid, self.constraints, self.report
        queue, group, pile = self.queue, self.group, self.pile
        numbers, counts = self.numbers, self.counts
        if counts[Count.STEPPING]:
            arrays = rows, grid, constraints, pile, report, numbers, counts
            return self._in_portions(PILES, until, most_events, *arrays)
        if counts[Count.RENEW]:
            reason = Reason(HORIZONS.form.open_horizon(rows, grid, constraints, queue, numbers, counts))
            if reason is not Reason.DONE:
                return reason
        arrays = rows, grid, constraints, queue, group, report, numbers, counts  # type: ignore[assignment]
        return self._in_portions(EVENTS, until, most_events, *arrays)

    def _in_portions(self, module: GeneratedModule, until: float, most_events: int, *arrays: Any) -> Reason:
        """Call the kernel that a module is named after; interpreted, it does a portion."""
        before, interpreted = int(self.counts[Count.EVENTS]), not module.is_loaded
        most = min(most_events, module.portion) if interpreted else most_events
        reason = Reason(getattr(module.form, module.name)(until, most, *arrays))
        if interpreted:
            module.did(int(self.counts[Count.EVENTS]) - before)
        return reason

    def _make_room(self, reason: Reason) -> None:
        n = len(self.rows)
        if reason is Reason.QUEUE_FULL:
            self.counts[Count.RENEW] = 1
            self.queue = zeros(Queue, size=2 * len(self.queue.times))
        elif reason is Reason.GRID_FULL:
            self.grid = Grid.empty(n, int(self.counts[Count.LAYERS]) + 1)
            self.counts[Count.LISTED] = NONE
        elif reason is Reason.GROUP_FULL:
            size = 2 * len(self.group.links)
            group = Group.empty(n, size)._replace(cut_short=self.group.cut_short)
            self.group, self.pile = group, Pile.empty(n, size)
            self.counts[Count.LISTED] = NONE
            self.report = np.zeros((max(_REPORTED_AT_ONCE, size), len(Detail)))
            self.constraints = self.constraints.enlarged(2 * size, self.counts)
        elif reason is Reason.SETTLE:
            self._settle()

    def _settle(self) -> None:
        """Put the calm pile into its equilibrium if that is near; if not, the pile goes on for a while."""
        from pinjoint.systems.collision.free.pile_equilibrium import EquilibriumSearch

        weight, pull = self._columns(Disc.WX), self._columns(Disc.GX)
        place = self._columns(Disc.OX) + self._columns(Disc.UX)
        radius = self.rows[: self.count, Disc.RADIUS]
        pairs, forces = self._persistent_contacts()
        pushing = np.sort(pairs, axis=1)
        end = EquilibriumSearch(place, radius, weight, pull, self._obstacles, pushing, forces).solve()
        if end is None:
            self.counts[Count.PATIENCE] = self.counts[Count.CALM] + _MORE_PATIENCE
            return
        discs, displacement, pairs, forces = end
        lying, free = self.rows[discs], weight[discs] > 0.0
        moving = lying[:, Disc.VX : Disc.VX + 2] ** 2 / 2.0
        fallen = lying[:, Disc.GX : Disc.GX + 2] * displacement[discs]
        self.numbers[Number.MOST_LOSS] = max(self.numbers[[Number.MOST_LOSS, Number.LOSS]])
        self.numbers[Number.LOSS] += ((moving + fallen)[free] / weight[discs][free]).sum()
        self._columns(Disc.UX)[...] += displacement
        self.rows[discs, Disc.VX : Disc.AY + 1] = 0.0
        self.numbers[Number.STEP_END] = self.now
        self.constraints = self.constraints.cleared(len(self.constraints.persistent), self.counts)
        both = np.concatenate([pairs, pairs[:, ::-1]])
        own = self.rows[both[:, 0], Disc.WX : Disc.WY + 1].any(axis=1)
        self._enter_persistent(both[own], np.tile(forces, 2)[own])
        self.counts[[Count.STEPPING, Count.WORK, Count.RENEW]] = 0, 0, 1
        self.numbers[Number.WORK_SINCE] = self.now

    def _take(self) -> Array:
        """The impacts reported since the last call."""
        k = int(self.counts[Count.REPORTED])
        self.counts[Count.REPORTED] = 0
        return self.report[:k].copy()

    # --- the state to resume from -------------------------------------------------------------------

    def state(self) -> FreeFlightState:
        """The state from which other discs with the same properties go on bit for bit."""
        pile = np.concatenate([self.counts[PILE_COUNTS], self.numbers[PILE_NUMBERS]])
        return FreeFlightState(self.rows[: self.count, FLIGHT].copy(), *self._persistent_contacts(), pile)

    def resume(self, state: FreeFlightState) -> None:
        """Go on from the state of other discs with the same properties."""
        self.rows[: self.count, FLIGHT] = state.motion
        counted = len(PILE_COUNTS)
        self.counts[PILE_COUNTS] = state.pile[:counted]
        self.numbers[PILE_NUMBERS] = state.pile[counted:]
        self.counts[Count.RENEW], self.counts[Count.LISTED] = 1, NONE
        self._enter_persistent(state.contacts, state.forces)

    def _enter_persistent(self, pairs: Integers, forces: Array) -> None:
        """Enter persistent contacts of the first disc of each pair with the second."""
        while len(pairs) > self.counts[Count.SPARES]:
            self.constraints = self.constraints.enlarged(2 * len(self.constraints.persistent), self.counts)
        for (i, j), force in zip(pairs[::-1].tolist(), forces[::-1].tolist(), strict=True):
            entry = self.counts[Count.SPARE]
            self.counts[Count.SPARE] = self.constraints.persistent[entry, Entry.NEXT]
            self.counts[Count.SPARES] -= 1
            self.constraints.persistent[entry] = j, self.constraints.first_persistent[i]
            self.constraints.forces[entry] = force
            self.constraints.first_persistent[i] = entry

    def _persistent_contacts(self) -> tuple[Integers, Array]:
        """Pairs of a disc and what it touches, and the forces between them (N), in the order of the chains."""
        pairs, entries = [], []
        for i in np.flatnonzero(self.constraints.first_persistent != NONE).tolist():
            entry = int(self.constraints.first_persistent[i])
            while entry != NONE:
                entries.append(entry)
                other, entry = self.constraints.persistent[entry].tolist()
                pairs.append((i, other))
        return np.array(pairs, dtype=np.int64).reshape(-1, 2), self.constraints.forces[entries]

    def contact_forces(self) -> Array:
        """The sum of the forces (N) on each disc in its persistent contacts, shape (n, 2)."""
        pairs, forces = self._persistent_contacts()
        owners, others = pairs.T
        displacement, _ = self.state_at(self.now)
        place = self.rows[:, [Disc.OX, Disc.OY]]
        place[: self.count] += displacement
        line = -nearest(place[others] - place[owners], self.rows[others][:, [Disc.TX, Disc.TY]])
        push = line * (forces / np.hypot(line[:, 0], line[:, 1]))[:, None]
        held = (self.rows[others][:, [Disc.WX, Disc.WY]] == 0.0).all(axis=1)  # without entries of their own
        total = np.zeros_like(place)
        for d in range(2):
            total[:, d] = np.bincount(owners, push[:, d], len(place))
            total[:, d] -= np.bincount(others[held], push[held, d], len(place))
        return total[: self.count]

    @property
    def at_rest(self) -> bool:
        """True if nothing moves and nothing will."""
        return not self.rows[: self.count, Disc.VX : Disc.AY + 1].any()

    @property
    def last_change(self) -> float:
        """Time (s) at which a path last changed."""
        return float(self.rows[: self.count, Disc.EPOCH].max())

    @property
    def now(self) -> float:
        """Time (s) up to which everything has happened."""
        return float(self.numbers[Number.NOW])

    @property
    def impacts(self) -> int:
        """Number of impacts so far."""
        return int(self.counts[Count.IMPACTS])

    def lost_at(self, time: float) -> float:
        """Energy (J) lost until a time (s) between the last event and the next; it never falls.

        In a step of a pile, weights on straight lines lose energy at a constant rate, after a jump at its start. What
        steps give back, as jammed discs are pushed apart, came from nowhere.
        """
        lost = float(self.numbers[Number.LOSS])
        if self.counts[Count.STEPPING] and self.numbers[Number.STEP_END] > time:
            weight, velocity = self._columns(Disc.WX), self._columns(Disc.VX)
            held = self._columns(Disc.GX) - self._columns(Disc.AX)
            rate = (held * velocity)[weight > 0.0] / weight[weight > 0.0]
            lost -= max(float(rate.sum()), 0.0) * float(self.numbers[Number.STEP_END] - time)
        return max(lost, float(self.numbers[Number.MOST_LOSS]))

    @property
    def deepest(self) -> float:
        """How far discs of a pile were in one another at most so far, in radii of the smaller disc."""
        return float(self.numbers[Number.DEEPEST])

    @property
    def created(self) -> float:
        """Energy (J) that steps of piles have given back of all that was lost, to discs that jam."""
        return max(float(self.numbers[Number.MOST_LOSS] - self.numbers[Number.LOSS]), 0.0)

    def state_at(self, time: float) -> tuple[Array, Array]:
        """Displacements (m) and velocities (m/s) at a time (s) between the last event and the next."""
        return state_on(self.rows[: self.count], time)


def state_on(paths: Array, time: float) -> tuple[Array, Array]:
    """Displacements (m) and velocities (m/s) at a time (s) on paths that begin with the columns FLIGHT of Disc."""
    s = (time - paths[:, Disc.EPOCH])[:, None]
    u, v, a = (paths[:, first : first + 2] for first in (Disc.UX, Disc.VX, Disc.AX))
    place, velocity = u + s * (v + 0.5 * s * a), v + s * a
    rows = np.flatnonzero(paths[:, Disc.STEP] < np.inf)
    if len(rows):
        s, left = s[rows], (time - paths[rows, Disc.STEP])[:, None]
        curve = paths[rows, Disc.CX : Disc.CY + 1]
        bend = paths[rows, Disc.BX : Disc.BY + 1] + s * curve
        place[rows] += s * s * left * bend
        velocity[rows] += s * (2.0 * left + s) * bend + s * s * left * curve
    return place, velocity


def _shared_ends(others: Obstacles) -> Array:
    """Column SHARED of obstacles: their ends that are also ends of an earlier obstacle with the same radius."""
    ends = np.concatenate([others.start, others.start + others.span])
    scale = np.abs(ends).max(initial=0.0) or 1.0
    spots = np.column_stack([np.round(ends / (scale * _SAME_PLACE)), np.tile(others.radius, 2)])
    _, first, spot = np.unique(spots, axis=0, return_index=True, return_inverse=True)
    owner = np.full(len(first), len(others))
    rows = np.tile(np.arange(len(others)), 2)
    np.minimum.at(owner, spot.ravel(), rows)
    shared = (owner[spot.ravel()] < rows).reshape(2, -1)
    return SHARED_START * shared[0] + SHARED_END * shared[1]


# --- the kernels ----------------------------------------------------------------------------------


def _contents(name: str) -> tuple[str, dict[str, Callable[..., Any]]]:
    from pinjoint.systems.collision.kernels import flight, horizon

    return entries_to({name: horizon.open_horizon if name == "open_horizon" else getattr(flight, name)})


def _warm_up(name: str) -> None:
    discs = Discs([[0.0, 0.0]], [[0.0, 0.0]], [1.0], [[1.0, 1.0]])
    if name == "open_horizon":
        HORIZONS.form.open_horizon(
            discs.rows, discs.grid, discs.constraints, discs.queue, discs.numbers, discs.counts
        )
    else:
        steps = name == "take_steps"
        discs.counts[Count.RENEW], discs.counts[Count.STEPPING] = 0, steps
        discs.advance(discs.now - float(steps))  # before the first step of a pile


def _module(name: str) -> GeneratedModule:
    return GeneratedModule(name, partial(_contents, name), partial(_warm_up, name))


# Each a module of its own, so that two processes can compile two at once: EVENTS lets events happen, HORIZONS finds the
# impacts to come, PILES takes the steps of piles, which only a hand that pulls, or gravity, forms.
EVENTS, HORIZONS, PILES = _module("fly"), _module("open_horizon"), _module("take_steps")
