"""Rods that bend: slopes of their ends to the chord, end moments and stiffness, of all rods at once.

Corotational Euler–Bernoulli rods with the bowing of their cubic. Their potential, of the elongation e of the chord and
the slopes φ, is ½ EA L₀ ε² + ½ (φ − φ⁰)ᵀ K (φ − φ⁰) − φᵀ p, with ε = e/L₀ + ½ φᵀ B φ and p what acts between the ends.
Hinged ends are columns of zeros. Lengths in m, forces in kN; arrays have one row for each rod, (rods, …).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import ROUND_OFF, Array, Flags
from pinjoint.components.derived import on_axis
from pinjoint.components.model import Model

_UNLIMITED = 1e200  # kN·m, of ends without a plastic moment, with which one may compute
_SENSES = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]  # in which both ends may flow
WITHIN = 2.5  # −N L₀²/EI of one rod, up to which its cubic bends as compression makes it


@dataclass(frozen=True)
class Bent:
    """The state of bending. slopes: of rigid ends to the chord, 0 at others, (rods, 2). bowed: L₀ B φ (m), by which slopes
    elongate the axis, (rods, 2). moment: on the ends, counter-clockwise, (rods, 2). shear: across the chord, (rods,).

    along, across: of forces between the ends, their work along and across the chord by unit slopes (kN·m), (rods, 2).
    """

    slopes: Array
    bowed: Array
    moment: Array
    shear: Array
    along: Array
    across: Array


@dataclass(frozen=True)
class Bending:
    """What the ends of rods feel, as in the columns of the same names.

    end_stiffness, bowing: (rods, 3) for (start start, start end, end end); span_load: (rods, 7); the others (rods, 2).
    moment_limit: plastic moments, infinite of ends that do not yield.
    """

    rest_length: Array
    end_stiffness: Array
    bowing: Array
    turning_shares: Array
    fixity: Array
    initial_slopes: Array
    span_load: Array
    moment_limit: Array

    @classmethod
    def of(cls, model: Model, *, bows: bool) -> Bending:
        """That of a model; in first-order theory rods do not bow, and without plasticity no end yields."""
        columns = {field.name: model.rods.column(field.name).copy() for field in fields(cls)}
        columns["bowing"] *= bows
        if not model.settings.plasticity:
            columns["moment_limit"][...] = np.inf
        return cls(**columns)

    @property
    def rigid(self) -> Flags:
        """The ends that are joined rigidly, (rods, 2)."""
        return self.turning_shares > 0.0

    def with_bars(self, rest_length: Array) -> Bending:
        """The same with more rods, of these rest lengths, that do not bend."""
        more = {
            name: np.concatenate([values, np.zeros((len(rest_length), *values.shape[1:]))])
            for name, values in vars(self).items()
        }
        more["moment_limit"][len(self.rest_length) :] = np.inf
        return replace(self, **more | {"rest_length": np.concatenate([self.rest_length, rest_length])})

    # --- hinges ------------------------------------------------------------------------------------

    @property
    def _of_ends(self) -> Array:
        """The moment at each end by its own slope, (rods, 2)."""
        return self.end_stiffness[:, ::2]

    def carried_over(self, moment: Array, hinges: Flags) -> Array:
        """What moments (rods, 2) at hinges leave at the other ends while these do not turn, (rods, 2)."""
        stiff, mixed = self._of_ends, self.end_stiffness[:, 1:2]
        share = np.divide(mixed, stiff, where=hinges & (stiff != 0.0), out=np.zeros_like(stiff))
        return np.where(hinges, 0.0, (share * moment)[:, ::-1])

    def hinged(self, hinges: Flags) -> Bending:
        """The same with hinges at some rigid ends, (rods, 2), at which slopes are still those of the joints."""
        own = np.where(hinges, 0.0, self._of_ends - self.carried_over(self.end_stiffness[:, [1, 1]], hinges))
        mixed = np.where(hinges.any(axis=1), 0.0, self.end_stiffness[:, 1])
        load = self.span_load.copy()
        for part in range(3):
            kept = load[:, part:6:3]
            load[:, part:6:3] = np.where(hinges, 0.0, kept - self.carried_over(kept, hinges))
        stiffness = np.stack([own[:, 0], mixed, own[:, 1]], axis=1)
        return replace(self, end_stiffness=stiffness, span_load=load)

    # --- states ------------------------------------------------------------------------------------

    def bow(self, slopes: Array) -> tuple[Array, Array]:
        """L₀ B φ (rods, 2), and the elongation of the axis by bowing, ½ L₀ φᵀ B φ (rods,)."""
        bowed = self.rest_length[:, None] * _product(self.bowing, slopes)
        return bowed, 0.5 * (bowed * slopes).sum(axis=1)

    def bent(
        self, slopes: Array, axial_force: Array, axis: Array, length: Array, share: float, couples: bool
    ) -> Bent:
        """The state with these slopes, while so much of what there is between the ends acts.

        couples: on the bent axis forces make a couple, unlike in first-order theory.
        """
        bowed, _ = self.bow(slopes)
        along, across = on_axis(share * self.span_load, axis)
        moment = _product(self.end_stiffness, slopes - self.initial_slopes) + axial_force[:, None] * bowed
        moment -= across
        couple = share * self.span_load[:, 6] - ((along * slopes).sum(axis=1) if couples else 0.0)
        shear = (moment.sum(axis=1) + couple) / np.where(length > 0.0, length, np.inf)
        return Bent(slopes, bowed, moment, shear, along, across - share * self.span_load[:, 2:6:3])

    def carried(self, bent: Bent, axis: Array, length: Array, couples: bool) -> tuple[Array, Array]:
        """What all that acts between the ends adds to the moments on these (rods, 2) and to the shear (rods,)."""
        along, across = on_axis(self.span_load, axis)
        couple = self.span_load[:, 6] - ((along * bent.slopes).sum(axis=1) if couples else 0.0)
        return -across, (couple - across.sum(axis=1)) / np.where(length > 0.0, length, np.inf)

    def energy(self, slopes: Array) -> Array:
        """½ (φ − φ⁰)ᵀ K (φ − φ⁰) of every rod (kN·m)."""
        bend = slopes - self.initial_slopes
        return 0.5 * (bend * _product(self.end_stiffness, bend)).sum(axis=1)

    # --- plastic hinges ------------------------------------------------------------------------------

    def by_slopes(self, axial_force: Array) -> Array:
        """Moments by the slopes of both ends, K + N L₀ B, (rods, 2, 2)."""
        stiffness: Array = self.end_stiffness + (axial_force * self.rest_length)[:, None] * self.bowing
        return stiffness[:, [0, 1, 1, 2]].reshape(-1, 2, 2)

    def end_moments(self, slopes: Array, axial_force: Array, axis: Array, share: float) -> Array:
        """Those (rods, 2) of rods with these slopes and axial forces, as in `bent`."""
        bowed, across = self.bow(slopes)[0], on_axis(share * self.span_load, axis)[1]
        moment: Array = _product(self.end_stiffness, slopes - self.initial_slopes) - across
        return moment + axial_force[:, None] * bowed

    def hessian(self, bent: Bent, extensional: Array, axial_force: Array, geometric: bool) -> Array:
        """d²/d(e, ψ, φ of both ends)² of the potential, (rods, 4, 4); e, ψ: elongation and turning of the chord."""
        found = np.zeros((len(extensional), 4, 4))
        found[:, 0, 0] = extensional
        found[:, 0, 2:] = found[:, 2:, 0] = extensional[:, None] * bent.bowed
        found[:, 2:, 2:] = extensional[:, None, None] * _dyad(bent.bowed, bent.bowed)
        found[:, 2:, 2:] += self.by_slopes(axial_force if geometric else np.zeros_like(axial_force))
        if geometric:
            found[:, 1, 2:] = found[:, 2:, 1] = bent.along
            found[:, 1, 1] = (bent.across * bent.slopes).sum(axis=1)
        return found

    # --- rates ---------------------------------------------------------------------------------------

    def ways(self, axis: Array, length: Array) -> Array:
        """Elongation and turning of the chord, slopes of both rigid ends, by the coordinates of both ends, (rods, 4, 6)."""
        left = np.stack([-axis[:, 1], axis[:, 0]], axis=1) / np.where(length > 0.0, length, np.inf)[:, None]
        found = np.zeros((len(length), 4, 6))
        found[:, 0, 3:5], found[:, 1, 3:5], found[:, 2:, 3:5] = axis, left, -left[:, None]
        found[:, :, :2] = -found[:, :, 3:5]
        found[:, 2, 2] = found[:, 3, 5] = 1.0
        found[:, 2:] *= self.rigid[:, :, None]
        return found

    def slope_rates(self, change: Array, turns: Array, axis: Array, length: Array) -> Array:
        """Rates of the slopes of rigid ends (rods, 2); change: of the second end relative to the first (rods, 2)."""
        aside = axis[:, 0] * change[:, 1] - axis[:, 1] * change[:, 0]
        chord = aside / np.where(length > 0.0, length, np.inf)
        return np.where(self.rigid, turns - chord[:, None], 0.0)

    def moments(self, slopes: Array) -> Array:
        """Moments (rods, 2) by which rods that are straight resist small slopes."""
        return _product(self.end_stiffness, slopes)

    def stiffness(
        self,
        bent: Bent,
        extensional: Array,
        axial_force: Array,
        axis: Array,
        length: Array,
        geometric: bool,
        flowing: Flags | None = None,
    ) -> Array:
        """d²/d(x, y, θ of both ends)² of the potential, (rods, 6, 6), less what a straight bar has.

        extensional: EA/L₀, 0 of rods that do not resist elongation. flowing: ends whose moments stay (rods, 2).
        """
        inverse = 1.0 / np.where(length > 0.0, length, np.inf)
        # In the basis (n · ds, m · ds, dθ_a, dθ_b) of the chord's direction n and left side m; not by `ways`, in which what
        # cancels of 12 EI/L³ costs structures with short members two or three digits.
        start, end, turned = (np.zeros((len(length), 4)) for _ in range(3))
        start[:, 1] = end[:, 1] = -inverse
        start[:, 2] = end[:, 3] = 1.0
        turned[:, 1] = inverse
        axial = bent.bowed[:, :1] * start + bent.bowed[:, 1:] * end
        axial[:, 0] = 1.0
        block = extensional[:, None, None] * _dyad(axial, axial)
        block[:, 0, 0] = 0.0
        by_slopes = self.end_stiffness
        if geometric:
            by_slopes = by_slopes + (axial_force * self.rest_length)[:, None] * self.bowing
        of_start, mixed, of_end = by_slopes.T[:, :, None, None]
        block += of_start * _dyad(start, start) + of_end * _dyad(end, end)
        block += mixed * (_dyad(start, end) + _dyad(end, start))
        if geometric:
            block[:, 0, 1] += bent.shear * inverse
            block[:, 1, 0] += bent.shear * inverse
            turning = _dyad(turned, bent.along[:, :1] * start + bent.along[:, 1:] * end)
            block += turning + turning.swapaxes(1, 2)
            block += (bent.across * bent.slopes).sum(axis=1)[:, None, None] * _dyad(turned, turned)
        if flowing is not None and flowing.any():
            hessian = self.hessian(bent, extensional, axial_force, geometric)
            axial[:] = 0.0
            axial[:, 0] = 1.0
            basis = np.stack([axial, turned, start, end], axis=1)
            pulled = hessian[:, 2:] @ basis
            block -= pulled.swapaxes(1, 2) @ flows(hessian[:, 2:, 2:], pulled, flowing)
        way = np.zeros((len(length), 4, 6))
        way[:, 0, 3:5], way[:, 1, 3], way[:, 1, 4] = axis, -axis[:, 1], axis[:, 0]
        way[:, :2, :2] = -way[:, :2, 3:5]
        way[:, 2, 2] = way[:, 3, 5] = 1.0
        return way.swapaxes(1, 2) @ block @ way


def needed_parts(model: Model, axial_force: Array, slopes: Array | None = None) -> NDArray[np.intp]:
    """Into how many rods each would have to be divided, so that each bends as its cubic does; 1 of most, (rods,).

    While ν = −N L₀²/EI is at most 2.5 in every rod, critical loads are exact to 0.75 %. slopes: of the ends, (rods, 2),
    at most a quarter turn; None: small.
    """
    rods = model.rods
    bent = (rods.turning_shares > 0.0).any(axis=1)
    pressed = np.where(bent, -axial_force * rods.rest_length**2, 0.0)
    ratio = np.divide(pressed, rods.bending_stiffness, out=np.zeros(rods.count), where=bent)
    by_force = np.sqrt(np.maximum(ratio, 0.0) / WITHIN)
    by_slopes = 0.0 if slopes is None else 4.0 * np.abs(slopes).max(axis=1, initial=0.0) / math.tau - 1e-9
    parts: NDArray[np.intp] = np.ceil(np.maximum(by_force, by_slopes)).astype(np.intp)
    return np.maximum(parts, 1)


def flows(stiffness: Array, excess: Array, flowing: Flags) -> Array:
    """By what ends that flow (rods, 2) turn in their hinges so that these moments vanish there, (rods, 2, …); 0 at others.

    stiffness: moments by both slopes, (rods, 2, 2). excess: (rods, 2, …).
    """
    own = stiffness[:, [0, 1], [0, 1]]
    flowing = flowing & (own != 0.0)
    mixed = np.where(flowing.all(axis=1), stiffness[:, 0, 1], 0.0)[:, None, None]
    own = np.where(flowing, own, 1.0)[:, :, None]
    given = np.where(flowing[:, :, None], excess.reshape(*flowing.shape, -1), 0.0)
    across = own[:, ::-1] * given - mixed * given[:, ::-1]
    return (across / (own[:, :1] * own[:, 1:] - mixed * mixed)).reshape(excess.shape)


def at_limits(sense: Array, limit: Array) -> Array:
    """The moments of ends that flow in these senses, 1 or −1; 0 of others."""
    return sense * np.where(sense != 0.0, limit, 0.0)


def yielding(stiffness: Array, moment: Array, limit: Array) -> Array:
    """The senses, 1 or −1, in which ends flow so that no moment exceeds its limit, 0 of others, (rods, 2).

    A linear complementarity problem of two. moment: of the ends if none flows; the rest as of `flows` and `Bending`.
    """
    found, rows = np.zeros_like(moment), np.flatnonzero((np.abs(moment) > limit).any(axis=1))
    if not len(rows):
        return found
    stiffness, moment, limit = stiffness[rows], moment[rows], np.minimum(limit[rows], _UNLIMITED)
    senses, solved = np.zeros_like(moment), np.zeros(len(rows), dtype=bool)
    noise = 4.0 * ROUND_OFF * np.abs(moment).max(axis=1, initial=0.0, keepdims=True)
    for sense in _SENSES:
        way = np.broadcast_to(sense, moment.shape)
        turned = flows(stiffness, moment - at_limits(way, limit), way != 0)
        left = np.abs(moment - (stiffness @ turned[:, :, None])[:, :, 0])
        right = np.where(way != 0, way * turned >= 0.0, left <= limit + noise).all(axis=1)
        senses[right & ~solved], solved = sense, solved | right
    found[rows] = senses
    return found


def _product(symmetric: Array, vectors: Array) -> Array:
    """2 × 2 matrices (rods, 3) times vectors (rods, 2)."""
    found: Array = symmetric[:, ::2] * vectors + symmetric[:, 1:2] * vectors[:, ::-1]
    return found


def _dyad(one: Array, other: Array) -> Array:
    return one[:, :, None] * other[:, None, :]
