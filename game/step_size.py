"""Step sizes: those that suit what limits a model's steps, rounded so that last bits do not matter."""

from __future__ import annotations

import math

from systems.physics.automatic import SMALL

SAFETY = 0.9  # share of the stable step that the automatic step takes in large models
ACCURATE = 0.1  # share in small ones, whose steps cost next to nothing; error ∝ its square
FIRST_SHARE = 0.1  # of 1/ω, the step at which error control begins
FREE_STEP = 1e-3  # s, where nothing limits the step
DOUBTFUL_STEP = 1e-2  # times 1/ω, for an integrator that is stable at no step


def automatic_step(stable_step: float, frequency: float, rods: int, shown: float = math.inf) -> float:
    """The step (s) of an integrator without error control.

    frequency: the highest (rad/s). rods: how many there are. shown: what one step may last at most.
    """
    if stable_step == 0.0:
        return rounded_down(min(DOUBTFUL_STEP / frequency, FREE_STEP))
    share = ACCURATE if rods <= SMALL else SAFETY
    return rounded_down(min(share * stable_step, FREE_STEP, shown))


def is_outgrown(size: float, wanted: float, stable_step: float) -> bool:
    """True if an automatic step fits no more, now that another one is wanted."""
    return not 0.5 * wanted <= size <= min(1.5 * wanted, 0.95 * stable_step)


def step_limit(stable_step: float, shown: float = math.inf) -> float:
    """The largest step (s) where the error is controlled; 0: there is none."""
    limit = min(SAFETY * stable_step, shown)
    return rounded_down(limit) if limit < math.inf else 0.0


def first_step(frequency: float, decay: float, limit: float) -> float:
    """The step (s) with which error control begins; limit: that of `step_limit`."""
    fastest = max(frequency, 2.0 * decay)
    first = FIRST_SHARE / fastest if fastest > 0.0 else FREE_STEP
    return rounded_down(min(first, limit or math.inf))


def rounded_down(size: float) -> float:
    """To three significant digits, so that the last bits of an eigenvalue do not matter."""
    digits = 2 - math.floor(math.log10(size))
    return math.floor(size * 10.0**digits) / 10.0**digits
