"""Policies of a run: the size of steps, when islands are reviewed, and what a person is told of a run."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pinjoint.components import written
from pinjoint.components.language import plural, tr
from pinjoint.components.model import Model
from pinjoint.systems.base import Integrator, StopReason
from pinjoint.systems.physics.automatic import SMALL
from pinjoint.systems.program.entries import SMALLEST_ENERGY

FAILURES = (StopReason.DIVERGED, StopReason.UNRESOLVED, StopReason.FAILED)
ENDING = (StopReason.EVENT, *FAILURES)  # reasons that end a step early

SAFETY = 0.9  # share of the stable step that the automatic step takes in large models
ACCURATE = 0.1  # share in small ones, whose steps cost next to nothing; error ∝ its square
FIRST_SHARE = 0.1  # of 1/ω, the step at which error control begins
CRAWLING = 1e-3  # of it: so much shorter ones under error control are told of
FREE_STEP = 1e-3  # s, where nothing limits the step
DOUBTFUL_STEP = 1e-2  # times 1/ω, for an integrator that is stable at no step

EIGENVALUE_ERROR = 1e-9  # of the highest frequency, and so of the largest stable step
TOLD_OVERLAP = 2e-3  # of a radius; smaller: tells of piles of like discs, too, whose steps leave up to 1.3e-3
TOLD_SHARE = 0.1  # of all energy ever supplied; smaller: warns of lattices by automatic steps of Verlet

# Columns of the clock; 0 where error control begins anew.
ERROR_CONTROL = ("step_error", "largest_displacement", "largest_speed", "largest_rotation", "largest_spin")


# --- step sizes ------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Limits:
    """What a state allows: the highest angular frequency (rad/s), decay (1/s), and the largest stable step (s)."""

    frequency: float
    decay: float
    stable_step: float

    @classmethod
    def of(cls, integrator: Integrator, frequency: float, decay: float) -> Limits:
        """The limits of an integrator; infinite where nothing swings or decays."""
        limited = frequency > 0.0 or decay > 0.0
        return cls(frequency, decay, integrator.stable_step(frequency, decay) if limited else math.inf)


@dataclass(frozen=True, slots=True)
class StepPolicy:
    """How the steps of a run are chosen.

    fixed: the step (s) that a person chose; None: automatic. rods: how many the model has.
    observed: gives the longest step (s) of exact flight, which is only how often it is looked at.
    """

    integrator: Integrator
    fixed: float | None
    rods: int
    observed: Callable[[], float] = lambda: math.inf

    @property
    def controls_error(self) -> bool:
        """True if the integrator chooses each step by its error, within a limit."""
        return self.integrator.estimates_error and self.fixed is None

    def is_doubtful(self, limits: Limits) -> bool:
        """True if the run will probably diverge, of which a person is warned."""
        stable = limits.stable_step
        return stable == 0.0 or (self.fixed is not None and is_unstable(self.fixed, stable))

    def first(self, limits: Limits) -> tuple[float, float]:
        """The step (s) that a run begins with, and its limit (s) under error control, 0: none."""
        if self.controls_error:
            fastest, limit = max(limits.frequency, 2.0 * limits.decay), self.limit(limits)
            first = FIRST_SHARE / fastest if fastest > 0.0 else FREE_STEP
            return rounded_down(min(first, limit or math.inf)), limit
        return self.fixed if self.fixed is not None else self._automatic(limits), 0.0

    def reviewed(self, limits: Limits, size: float) -> float | None:
        """The step (s) to go on with instead of `size` (s) if that fits the present state no more, or None.

        Only for automatic steps without error control.
        """
        wanted = self._automatic(limits)
        fits = 0.5 * wanted <= size <= min(1.5 * wanted, 0.95 * limits.stable_step)
        return None if fits else wanted

    def crawls(self, limits: Limits, mean: float) -> bool:
        """True if forces change so fast that error control takes tiny steps. mean: of many steps (s)."""
        return self.controls_error and mean < CRAWLING * self.first(limits)[0]

    def limit(self, limits: Limits) -> float:
        """The longest step (s) under error control, by stability; 0: nothing limits it."""
        limit = SAFETY * limits.stable_step
        return rounded_down(limit) if limit < math.inf else 0.0

    def _automatic(self, limits: Limits) -> float:
        """The step (s) without error control."""
        stable = limits.stable_step
        if stable == 0.0:
            return rounded_down(min(DOUBTFUL_STEP / limits.frequency, FREE_STEP))
        share = ACCURATE if self.rods <= SMALL else SAFETY
        observed = self.observed() if self.integrator.exact else math.inf
        return rounded_down(min(share * stable, FREE_STEP, observed))


def is_unstable(size: float, stable: float) -> bool:
    """True if steps of this size (s) are not below the largest stable one (s), at which errors grow already."""
    return size >= stable * (1.0 - EIGENVALUE_ERROR)


def rounded_down(size: float) -> float:
    """To three significant digits, so that the last bits of an eigenvalue do not matter."""
    digits = 2 - math.floor(math.log10(size))
    return math.floor(size * 10.0**digits) / 10.0**digits


def begin_steps(model: Model, size: float) -> None:
    """From now on steps have this size (s), counted from the present time."""
    clock = model.clock
    for name, value in ("origin", clock.time), ("origin_steps", clock.steps), ("step_size", size):
        model.writable(f"clock.{name}")[0] = value


# --- what is told -----------------------------------------------------------------------------------------


def energy_warning(imbalance: float, scale: float) -> str:
    """The sentence that steps lost (positive) or created this energy (J); "" if it is a small part of all supplied."""
    if not abs(imbalance) > TOLD_SHARE * scale + SMALLEST_ENERGY:
        return ""
    share = abs(imbalance) / max(scale, SMALLEST_ENERGY)
    if share >= 10.0:
        times = written.number(share, 3)
        if imbalance > 0.0:
            return tr(
                "The time steps lost {times} times the supplied energy: the errors of the results may be as large.",
                times=times,
            )
        return tr(
            "The time steps created {times} times the supplied energy: the errors of the results may be as large.",
            times=times,
        )
    part = written.share(share)
    if imbalance > 0.0:
        return tr(
            "The time steps lost {share} of the supplied energy: the errors of the results may be as large.",
            share=part,
        )
    return tr(
        "The time steps created {share} of the supplied energy: the errors of the results may be as large.",
        share=part,
    )


def overlap_warning(deepest: float) -> str:
    """The sentence that discs of a pile were in one another by this share of a radius; "" where that is common."""
    if deepest <= TOLD_OVERLAP:
        return ""
    return tr(
        "Discs of a pile were in one another by up to {share} of a radius: its places and energies are off accordingly.",
        share=written.share(deepest),
    )


def contact_warning(steps: int, most: float) -> str:
    """The sentence that so many steps left contacts open, or discs in one another, by a share of a radius; "" if none."""
    if not steps:
        return ""
    return plural(
        "In one step no forces were found that close all contacts: they were left open, or discs in one another, by up to"
        " {share} of a radius.",
        "In {count} steps no forces were found that close all contacts: they were left open, or discs in one another, by up"
        " to {share} of a radius.",
        steps,
        share=written.share(most),
    )


def at_rest_since(time: float) -> str:
    """The message of a model that came to rest at this time (s)."""
    return tr("At rest since t = {time}.", time=written.time(time))
