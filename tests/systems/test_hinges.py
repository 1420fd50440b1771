"""Plastic hinges of one rod: the law in closed form against the energy's own answer, and how it is bounded."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from numba import njit
from scipy.optimize import brentq

import pinjoint.systems.program.machine_code  # noqa: F401 - by which numba knows kernels
from pinjoint.components.derived import by_fixity
from pinjoint.systems.plasticity.hinges import MOST_TRIALS, narrowed, slipped, slips


@njit(error_model="numpy")
def law(*facts: Any) -> Any:
    return slipped(*facts)


class Rod:
    """A random rod with rigid, sprung and hinged ends, in a state in which its ends may slip."""

    def __init__(self, lot: np.random.Generator, steep: float) -> None:
        self.bending, self.axial = 10 ** lot.uniform(0, 2), 10 ** lot.uniform(2, 5)
        self.length = lot.uniform(1.0, 4.0)
        fixity = np.array([[lot.choice([1.0, 1.0, 0.0, lot.uniform(0.1, 1.0)]) for _ in range(2)]])
        held = fixity[0] > 0.0
        per_slope, columns = by_fixity(fixity)
        self.stiffness, self.bowing = per_slope[0] * self.bending / self.length, columns["bowing"][0]
        self.moment = self.bending / self.length * 10 ** lot.uniform(-2.0, 0.0)
        self.limit = np.where(held, self.moment, math.inf)
        self.slopes, self.warped = lot.normal(0.0, steep, 2) * held, lot.normal(0.0, 0.02, 2) * held
        self.load = lot.normal(0.0, 0.5 * self.moment, 2) * held
        self.elongation = lot.normal(0.0, 0.01) * self.length
        self.strength = self.axial * 10 ** lot.uniform(-3.0, 0.0)

    @property
    def facts(self) -> tuple[Any, ...]:
        strength = (0.0, self.strength, self.strength)
        ends = self.bending, tuple(self.stiffness), tuple(self.warped), tuple(self.bowing), tuple(self.limit)
        return (self.elongation, *self.slopes, *self.load, self.axial, self.length, *strength, *ends)

    @staticmethod
    def matrix(parts: np.ndarray) -> np.ndarray:
        return np.array([[parts[0], parts[1]], [parts[1], parts[2]]])

    def force(self, slopes: np.ndarray) -> float:
        strain = self.elongation / self.length + 0.5 * slopes @ self.matrix(self.bowing) @ slopes
        return float(np.clip(self.axial * strain, -self.strength, self.strength))

    def moments(self, slopes: np.ndarray, force: float | None = None) -> np.ndarray:
        thrust = (self.force(slopes) if force is None else force) * self.length
        bent = self.matrix(self.stiffness) @ (slopes - self.warped) + self.load
        return np.asarray(bent + thrust * self.matrix(self.bowing) @ slopes)

    def least_energy(self) -> np.ndarray | None:
        """Slips by trying all nine ways in which ends may flow; the axial force of each is a root by bisection."""
        found = []
        for signs in itertools.product((0, 1, -1), repeat=2):
            flows = np.array(signs) != 0
            if (flows & ~np.isfinite(self.limit)).any():
                continue

            def slipping(force: float, signs: Any = signs, flows: Any = flows) -> np.ndarray:
                elastic = self.matrix(self.stiffness) + force * self.length * self.matrix(self.bowing)
                over = self.moments(self.slopes, force) - np.array(signs) * self.moment
                slip = np.zeros(2)
                slip[flows] = np.linalg.solve(elastic[np.ix_(flows, flows)], over[flows])
                return slip

            def miss(force: float, slipping: Any = slipping) -> float:
                return force - self.force(self.slopes - slipping(force))

            low, high = -10.0 * self.bending / self.length**2, self.axial
            if miss(low) >= 0.0:
                continue  # too near to its own buckling
            slip = slipping(brentq(miss, low, high, xtol=1e-300, rtol=1e-15))
            moments = self.moments(self.slopes - slip)
            rounding = 1e-9 * self.moment
            if (slip * signs >= 0.0).all() and (np.abs(moments) <= self.limit + rounding).all():
                found.append(slip)
        if not found:
            return None
        assert np.ptp(found, axis=0).max() <= 1e-9 * (1.0 + np.abs(self.slopes).max()), "there is one answer"
        return found[0]


@pytest.mark.parametrize("steep", [0.3, 0.02, 0.002])
def test_slips_are_those_of_least_energy(steep: float) -> None:
    lot, compared, yielded = np.random.default_rng(3), 0, 0
    for _ in range(700):
        rod = Rod(lot, steep)
        wanted = rod.least_energy()
        start, end, force = law(*rod.facts)
        if wanted is None or force * rod.length**2 / rod.bending < -9.0:
            continue
        compared, yielded = compared + 1, yielded + bool(wanted.any())
        slip = np.array([start, end])
        noise = 1e-15 * rod.axial * rod.length * np.abs(rod.matrix(rod.bowing) @ rod.slopes).max()
        by_noise = noise / min(rod.stiffness[rod.stiffness > 0.0].min(initial=math.inf), 1e300)
        assert slip == pytest.approx(wanted, rel=1e-12, abs=1e-14 * np.abs(rod.slopes).max() + 30.0 * by_noise)
        assert force == pytest.approx(rod.force(rod.slopes - slip), rel=1e-14, abs=1e-14 * rod.axial)
        assert (np.abs(rod.moments(rod.slopes - slip)) <= rod.limit * (1.0 + 1e-14) + 30.0 * noise).all()
    assert compared > 400
    assert yielded > 100


def test_ends_that_tie_share_what_slips_and_no_rounding_confuses_them() -> None:
    stiffness, bowing = (4.0, 2.0, 4.0), (4.0 / 30.0, -1.0 / 30.0, 4.0 / 30.0)
    for over in (1e-16, 1e-15, 1e-12, 1e-3):
        start, end = slips(6.0 * (1.0 + over), 6.0 * (1.0 + over), 0.0, stiffness, bowing, (6.0, 6.0))
        assert (start, end) == pytest.approx((over, over), abs=3e-16)
    assert slips(6.0, -6.0, 0.0, stiffness, bowing, (6.0, 6.0)) == (0.0, 0.0)
    assert slips(8.0, 0.0, 0.0, stiffness, bowing, (6.0, math.inf)) == (0.5, 0.0)


def test_axial_forces_are_found_in_few_trials() -> None:
    lot = np.random.default_rng(5)
    counted, tried = [], 0

    def counting(*facts: Any) -> Any:
        nonlocal tried
        tried += 1
        return narrowed.py_func(*facts)

    plain = slipped.py_func
    own = type(plain)(plain.__code__, {**plain.__globals__, "narrowed": counting})
    for _ in range(3000):
        tried = 0
        own(*Rod(lot, 0.3).facts)
        counted.append(tried)
    assert np.median(counted) <= 5
    assert max(counted) < MOST_TRIALS
