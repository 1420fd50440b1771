"""What acts between the ends of rods, what they bear of it there, and what curves along them it makes.

Shares ξ count from 0 at the start of a rod to 1 at its end. Loads are sums of size · ⟨ξ − a⟩ⁿ/n! from places a on: n = 1
is a force that grows from there, 0 a constant one, −1 a force there, −2 a couple (Macaulay). Integrated once they are what
N and V gain along a rod, twice M, four times the deflection; against cubics of unit slopes, what clamped ends bear.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinjoint.components.arrays import Rows
from pinjoint.components.cases import Acting, factors
from pinjoint.components.field import Column
from pinjoint.components.load import DIRECTIONS
from pinjoint.components.world import World

_FACTORIALS = np.array([math.factorial(n) for n in range(7)], dtype=np.float64)
# Between which a zero of a polynomial is looked for, and the shares that are one to it.
_GRID, _ROUNDING = np.linspace(0.0, 1.0, 33), 2e-16
_POWERS = 6  # coefficients of a deflection below a force that grows


def _tail(place: Column, power: Rows) -> Column:
    """(1 − a)ⁿ/n!, 0 where n is negative."""
    known = np.maximum(power, 0)
    return np.where(power < 0, 0.0, (1.0 - place) ** known / _FACTORIALS[known])


def groups(first: Rows, last: Rows) -> tuple[Rows, Rows]:
    """The whole numbers from first to last (n,), without these, one after the other, and before each of which they are."""
    many = last - first
    of = np.repeat(np.arange(len(many)), many)
    return of, np.arange(len(of)) - np.repeat(np.cumsum(many) - last, many)


class Spans(NamedTuple):
    """What acts between the ends of rods: on which (k,), from which share to which, and of whose load, −1: the rod's own.

    force (kN), moment (kN·m): at the start; first, last: force per length there and at the end (kN/m); (k, 2) but moments.
    """

    row: Rows
    start: Column
    end: Column
    force: Column
    moment: Column
    first: Column
    last: Column
    load: Rows

    @classmethod
    def of(cls, world: World) -> Spans:
        """Those of a model, along x and y; places beyond the end of a rod count as its end."""
        rods, loads = world.tables["rods"], world.tables["span_loads"]
        own = _pressed(rods.distributed_force)
        nothing, none, force = np.zeros((len(own), 2)), np.zeros(len(own)), rods.distributed_force[own]
        found = cls(own, none, none + 1.0, nothing, none, force, force, np.full(len(own), -1))
        if not loads.count:
            return found
        row = loads.rod.astype(np.intp)
        length = np.maximum(rods.original_length[row], 1e-300)
        local = (loads.column("direction") == DIRECTIONS[1])[:, None]
        ahead = np.where(local, rods.difference[row] / length[:, None], [1.0, 0.0])
        left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
        forces = (
            given[:, :1] * ahead + given[:, 1:] * left
            for given in (loads.force, loads.start_intensity, loads.end_intensity)
        )
        force, first, last = forces
        start = np.minimum(loads.start / length, 1.0)
        end = np.maximum(np.minimum(np.nan_to_num(loads.end / length, nan=1.0), 1.0), start)
        more = (row, start, end, force, loads.moment, first, last, np.arange(loads.count))
        return cls(*map(np.concatenate, zip(found, more, strict=True)))

    def some(self, which: NDArray[np.bool_]) -> Spans:
        """Some of them."""
        return Spans(*(column[which] for column in self))


class Kinks(NamedTuple):
    """Terms of what acts along rods, by rod and place: row, a, n and size, (k,); of whose load, −1 being the rod's own.

    size: x, y (kN) and, of couples, −M (kN·m), (k, 3).
    """

    row: Rows
    place: Column
    order: Rows
    size: Column
    load: Rows

    @classmethod
    def of(cls, world: World, share: float = 1.0, acting: Acting | None = None) -> Kinks:
        """Those of a model, of so much of its loads, each by the factor of its case.

        acting: combinations, of which the rods follow one another.
        """
        found = cls._of_all(world, share)
        if acting is None and factors(world) is None:
            return found
        acting = acting or Acting.of(world)
        by = np.column_stack([acting.span_loads, acting.permanent])[:, found.load]
        combination, kink = np.nonzero(by)
        row, place, order, size, load = (column[kink] for column in found)
        row = combination * world.tables["rods"].count + row
        return cls(row, place, order, by[combination, kink, None] * size, load)

    @classmethod
    def _of_all(cls, world: World, share: float) -> Kinks:
        rods = world.tables["rods"]
        if not world.tables["span_loads"].count:  # of which nothing needs to be sorted: a third of the time
            own = _pressed(rods.distributed_force)
            size = np.zeros((len(own), 3))
            size[:, :2] = share * rods.distributed_force[own] * rods.rest_length[own, None]
            return cls(own, np.zeros(len(own)), np.zeros_like(own), size, np.full(len(own), -1))
        row, start, end, force, moment, first, last, load = Spans.of(world)
        per_share = share * rods.rest_length[row, None] * (end > start)[:, None]
        growth = np.divide(
            last - first, (end - start)[:, None], out=np.zeros_like(first), where=per_share != 0.0
        )
        parts = (
            (-2, start, np.zeros_like(force)),
            (-1, start, share * force),
            (0, start, per_share * first),
            (1, start, per_share * growth),
            (0, end, -per_share * last),
            (1, end, -per_share * growth),
        )
        order = np.repeat([part[0] for part in parts], len(row))
        place = np.concatenate([part[1] for part in parts])
        size = np.pad(np.concatenate([part[2] for part in parts]), ((0, 0), (0, 1)))
        size[: len(row), 2] = -share * moment
        acting = np.flatnonzero(size.any(axis=1) & ((place < 1.0) | (order < 0)))
        whose = acting % max(len(row), 1)
        acting = acting[np.lexsort((order[acting], place[acting], row[whose]))]
        whose = acting % max(len(row), 1)
        return cls(row[whose], place[acting], order[acting], size[acting], load[whose])

    def some(self, which: NDArray[np.bool_]) -> Kinks:
        """Some of them."""
        return Kinks(*(column[which] for column in self))

    def divided(self, row: Rows, low: Column, high: Column) -> Kinks:
        """Those of parts of rods, (p,), by rows ascending, from share to share."""
        first, last = (np.searchsorted(row, self.row, side=side) for side in ("left", "right"))
        kink, part = groups(first, last)
        place, order, size, load = (column[kink] for column in self[1:])
        after, width = place - low[part], (high - low)[part]
        scaled = size * width[:, None] ** np.maximum(order + 1, 0)[:, None]
        inside = (after >= 0.0) & ((place < high[part]) | (high[part] == 1.0))
        passing = (after < 0.0) & (order >= 0)
        begun = np.where((order == 1)[:, None], -(after * width)[:, None] * size, 0.0)
        parts = (
            (inside, after / width, order, scaled),
            (passing, 0.0 * after, order, scaled),
            (passing & (order == 1), 0.0 * after, np.zeros_like(order), begun),
        )
        columns = [
            (part[one], place[one], order[one], size[one], load[one]) for one, place, order, size in parts
        ]
        made = [np.concatenate(column) for column in zip(*columns, strict=True)]
        sorted_rows = np.lexsort((made[1], made[0]))
        return Kinks(*(column[sorted_rows] for column in made))

    def on_ends(self, count: int) -> Column:
        """What both ends of rods bear by the lever rule (kN), (count, 2, 2)."""
        total, start = _tail(self.place, self.order + 1), _tail(self.place, self.order + 2)
        found = np.zeros((count, 2, 2))
        both = np.stack([start, total - start], axis=1)
        np.add.at(found, self.row, both[:, :, None] * self.size[:, None, :2])
        return found

    def on_clamped(self, length: Column) -> Column:
        """Work by unit slopes of clamped ends of rods of these lengths (kN·m): of forces x, forces y and couples for the
        start, for the end; and of couples by a unit rotation of the chord; (rods, 7).

        Forces turn with nothing, so that their moments on the ends follow the chord.
        """
        found = np.zeros((len(length), 7))
        if not len(self.row):
            return found
        second, third, fourth = (_tail(self.place, self.order + more) for more in (2, 3, 4))
        levers = np.stack([2.0 * third - 6.0 * fourth, 4.0 * third - second - 6.0 * fourth], axis=1)
        size = self.size * np.column_stack([length, length, np.ones_like(length)])[self.row]
        np.add.at(found[:, :6], self.row, (levers[:, :, None] * size[:, None]).reshape(-1, 6))
        np.add.at(found[:, 6], self.row, -self.size[:, 2])
        return found

    def integrated(self, times: int, size: Column, count: int, powers: int) -> Curves:
        """So often integrated from the starts of rods: curves of these sizes (k,) with so many coefficients.

        What jumps at a start does so just after it, so that curves begin with what the joint bears.
        """
        power = self.order + times
        places = np.where(power == 0, np.maximum(self.place, np.nextafter(0.0, 1.0)), self.place)
        size = np.where(power < 0, 0.0, size / _FACTORIALS[np.maximum(power, 0)])
        from_start = (places <= 0.0) & (power >= 0)
        polynomials = np.zeros((count, powers))
        np.add.at(polynomials, (self.row[from_start], power[from_start]), size[from_start])
        inside = (places > 0.0) & (size != 0.0)
        return Curves(polynomials, self.row[inside], places[inside], power[inside], size[inside])

    def bulges(self, left: Column, length: Column) -> Curves:
        """What M is between the ends of simple beams (kN·m); left: unit vectors (rods, 2), length: of the chords (m)."""
        size = (self.size[:, :2] * left[self.row]).sum(axis=1) * length[self.row] + self.size[:, 2]
        found = self.integrated(2, size, len(left), 4)
        at_end = np.bincount(self.row, size * _tail(self.place, self.order + 2), len(left))
        found.polynomials[:, 1] -= at_end
        return found

    def sags(self, left: Column, length: Column, stiffness: Column) -> Curves:
        """How far axes between clamped ends bend to the left (m), 0 where nothing bends."""
        soft = np.divide(length**2, stiffness, out=np.zeros_like(length), where=stiffness > 0.0)[self.row]
        size = (self.size[:, :2] * left[self.row]).sum(axis=1) * length[self.row] + self.size[:, 2]
        size = soft * size
        found = self.integrated(4, size, len(left), _POWERS)
        away, slope = (
            np.bincount(self.row, size * _tail(self.place, self.order + times), len(left)) for times in (4, 3)
        )
        found.polynomials[:, 2] += slope - 3.0 * away
        found.polynomials[:, 3] += 2.0 * away - slope
        return found


# --- curves along rods ------------------------------------------------------------------------------


class Stretches(NamedTuple):
    """Curves cut where they have kinks: of which curve each is, from which share to which, (p,), and polynomials (p, d)."""

    row: Rows
    low: Column
    high: Column
    polynomials: Column


@dataclass(frozen=True)
class Curves:
    """Polynomials of ξ, (n, d), the lowest coefficients first, to which from a place on size · (ξ − place)^power is added.

    row: the curves to which, ascending; place, power, size: (k,).
    """

    polynomials: Column
    row: Rows
    place: Column
    power: Rows
    size: Column

    @classmethod
    def plain(cls, polynomials: Column) -> Curves:
        """Polynomials alone."""
        none = np.zeros(0, dtype=np.intp)
        return cls(polynomials, none, np.zeros(0), none, np.zeros(0))

    @classmethod
    def together(cls, every: Sequence[Curves]) -> Curves:
        """Those of several, one after the other."""
        width = max(one.polynomials.shape[1] for one in every)
        before = np.cumsum([0, *map(len, every[:-1])])
        polynomials = [
            np.pad(one.polynomials, ((0, 0), (0, width - one.polynomials.shape[1]))) for one in every
        ]
        rows = [one.row + first for one, first in zip(every, before.tolist(), strict=True)]
        kinks = (np.concatenate([one._kinks[part] for one in every]) for part in (1, 2, 3))
        return cls(np.concatenate(polynomials), np.concatenate(rows), *kinks)

    def __len__(self) -> int:
        return len(self.polynomials)

    def plus(self, polynomials: Column) -> Curves:
        """With these polynomials added."""
        found, added = self.polynomials, polynomials
        if found.shape[1] < added.shape[1]:
            found, added = added, found
        found = found.copy()
        found[:, : added.shape[1]] += added
        return Curves(found, *self._kinks)

    def times(self, factor: float) -> Curves:
        """Multiplied by a number."""
        return Curves(factor * self.polynomials, self.row, self.place, self.power, factor * self.size)

    def some(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Curves:
        """Those of some rods, in this order."""
        polynomials = self.polynomials[which]
        if not len(self.row):
            return Curves(polynomials, *self._kinks)
        chosen = np.arange(len(self))[which]
        first, last = (np.searchsorted(self.row, chosen, side=side) for side in ("left", "right"))
        row, kinks = groups(first, last)
        return Curves(polynomials, row, *(column[kinks] for column in self._kinks[1:]))

    @property
    def _kinks(self) -> tuple[Rows, Column, Rows, Column]:
        return self.row, self.place, self.power, self.size

    @property
    def derivative(self) -> Curves:
        """Of each, by ξ; without what jumps."""
        goes_on = self.power > 0
        row, place, power, size = (column[goes_on] for column in self._kinks)
        return Curves(derivative(self.polynomials), row, place, power - 1, size * power)

    @property
    def most(self) -> Column:
        """What each is at most, about."""
        found: Column = np.abs(self.polynomials).sum(axis=1)
        return found + np.bincount(self.row, np.abs(self.size), len(self))

    def at(self, shares: ArrayLike) -> Column:
        """Values at shares (k,) or (n, k), shape (n, k); where one jumps, that after it."""
        found = values(self.polynomials, np.asarray(shares))
        if len(self.row):
            along = np.broadcast_to(shares, found.shape)[self.row]
            beyond = along - self.place[:, None]
            more = self.size[:, None] * np.maximum(beyond, 0.0) ** self.power[:, None]
            np.add.at(found, self.row, np.where(beyond >= 0.0, more, 0.0))
        return found

    def with_kinks(self, shares: Column) -> Column:
        """Shares (k,) for each curve, ascending, and with them, where some have kinks, those just before and at these."""
        every = np.broadcast_to(shares, (len(self), len(shares)))
        if not len(self.row):
            return every
        number = np.arange(len(self.row)) - np.searchsorted(self.row, self.row)
        more = np.ones((len(self), 2 * (number.max() + 1)))
        more[self.row, 2 * number] = np.nextafter(self.place, 0.0)
        more[self.row, 2 * number + 1] = self.place
        return np.sort(np.concatenate([every, more], axis=1), axis=1)

    @property
    def stretches(self) -> Stretches:
        """These curves cut at their kinks; what one jumps by at its end is a stretch of no length."""
        count = len(self)
        whole = np.arange(count)
        if not len(self.row):
            return Stretches(whole, np.zeros(count), np.ones(count), self.polynomials)
        both = np.concatenate(
            [np.column_stack([whole, np.zeros(count)]), np.column_stack([self.row, self.place])]
        )
        row, low = np.unique(both, axis=0).T
        row = row.astype(np.intp)
        last = np.append(row[1:] != row[:-1], True)
        high = np.where(last, 1.0, np.append(low[1:], 1.0))
        polynomials = self.polynomials[row]
        kink, piece = groups(*(np.searchsorted(row, self.row, side=side) for side in ("left", "right")))
        acts = low[piece] >= self.place[kink]
        kink, piece = kink[acts], piece[acts]
        for index in range(polynomials.shape[1]):  # (ξ − a)ⁿ as powers of ξ
            above = self.power[kink] - index
            has = above >= 0
            part = _FACTORIALS[self.power[kink]] / _FACTORIALS[index] / _FACTORIALS[np.maximum(above, 0)]
            grown = self.size[kink] * part * (-self.place[kink]) ** np.maximum(above, 0)
            np.add.at(polynomials[:, index], piece[has], grown[has])
        return Stretches(row, low, high, polynomials)


def zeros(stretches: Stretches) -> tuple[Rows, Column]:
    """Where stretches of curves change sign inside: of which curve, and at which share, in order."""
    polynomials = stretches.polynomials
    samples = stretches.low[:, None] + (stretches.high - stretches.low)[:, None] * _GRID
    sampled = values(polynomials, samples)
    signs = np.sign(sampled)
    which, place = (signs[:, :-1] * signs[:, 1:] < 0.0).nonzero()
    low, high = samples[which, place], samples[which, place + 1]
    first, last, before = sampled[which, place], sampled[which, place + 1], signs[which, place]
    terms, slopes, step = polynomials[which], derivative(polynomials)[which], 0.5 * (high - low)
    with np.errstate(over="ignore", invalid="ignore"):  # of numbers beyond computing
        part = first / (first - last)
    share = low + (high - low) * np.where(np.isnan(part), 0.5, part)
    # From where a straight line is zero, Newton's method, or half the interval where that is less: down to rounding.
    for _ in range(60):
        value, slope = _each(terms, share), _each(slopes, share)
        ahead = value * before > 0.0
        low, high = np.where(ahead, share, low), np.where(ahead, high, share)
        newton = -np.divide(value, slope, out=np.full(len(value), np.inf), where=slope != 0.0)
        further, size = share + newton, np.abs(newton)
        safe = (further >= low) & (further <= high) & (size < 0.5 * np.abs(step)) | (size < _ROUNDING)
        step = np.where(safe, newton, 0.5 * (low + high) - share)
        if not np.count_nonzero(np.abs(step) >= _ROUNDING):
            break
        share = share + step
    touching, at = (signs[:, 1:-1] == 0.0).nonzero()  # a sample that is a zero itself
    if len(touching):
        touching, at = (part[signs[touching, at] * signs[touching, at + 2] < 0.0] for part in (touching, at))
        which, share = np.append(which, touching), np.append(share, samples[touching, at + 1])
        order = np.lexsort((share, which))
        which, share = which[order], share[order]
    return stretches.row[which], share


def extremes(stretches: Stretches) -> tuple[Column, Column]:
    """The least and the greatest value of each curve, and the shares where they are, (n, 2) each."""
    row, low, high, polynomials = stretches
    every = np.arange(len(row))
    inside, between = zeros(Stretches(every, low, high, derivative(polynomials)))
    which = np.concatenate([every, every, inside])
    shares = np.concatenate([low, high, between])
    found = values(polynomials[which], shares[:, None])[:, 0]
    curve = row[which]
    order = np.lexsort((found, curve))
    count = int(row.max(initial=-1)) + 1
    both = order[np.searchsorted(curve[order], np.arange(count)[:, None] + [0, 1]) - [0, 1]]
    return found[both], shares[both]


def values(polynomials: Column, shares: Column) -> Column:
    """Values of polynomials (n, d) at shares (k,) or (n, k), shape (n, k)."""
    found = np.zeros((len(polynomials), np.shape(shares)[-1]))
    for coefficient in polynomials.T[::-1]:
        found *= shares
        found += coefficient[:, None]
    return found


def _each(polynomials: Column, shares: Column) -> Column:
    """Values of polynomials (n, d) at one share each, (n,): in a third of the time of the same by `values`."""
    found = np.zeros(len(shares))
    for coefficient in polynomials.T[::-1]:
        found = found * shares + coefficient
    return found


def derivative(polynomials: Column) -> Column:
    """Of polynomials (n, d), by ξ, (n, d − 1)."""
    found: Column = polynomials[:, 1:] * np.arange(1.0, polynomials.shape[1])
    return found


def _pressed(force: Column) -> Rows:
    """Which rods bear forces distributed along them, of vectors (rods, 2)."""
    return np.flatnonzero((force[:, 0] != 0.0) | (force[:, 1] != 0.0))
