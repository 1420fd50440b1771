"""Step sizes: those that suit what limits a model's steps, rounded so that last bits do not matter."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from components.model import Model
from systems.base import Integrator
from systems.collision.system import FreeFlight
from systems.physics.automatic import SMALL
from systems.physics.integrators import INTEGRATORS
from systems.physics.pace import natural_pace
from systems.physics.spectrum import Spectrum, spectrum
from systems.run.sleep import Sleep

SAFETY = 0.9  # share of the stable step that the automatic step takes in large models
ACCURATE = 0.1  # share in small ones, whose steps cost next to nothing; error ∝ its square
FIRST_SHARE = 0.1  # of 1/ω, the step at which error control begins
FREE_STEP = 1e-3  # s, where nothing limits the step
DOUBTFUL_STEP = 1e-2  # times 1/ω, for an integrator that is stable at no step
SHOWN = 1.0 / 120.0  # s shown, at the natural pace, that one step may last
DEFAULT_DRIVER = "velocity_verlet"


class StepSize:
    """What limits the steps of one model's run, and which size suits them.

    stable: the largest stable step (s) that was found last. warning: that the steps are longer, or "".
    smooth: steps are not longer than what is shown at once.
    """

    def __init__(self, model: Model, sleep: Sleep, driver: Callable[[], Integrator]) -> None:
        self._model = model
        self._sleep = sleep
        self._driver = driver
        self.stable = math.inf
        self.warning = ""
        self.smooth = True

    def look_up(self) -> Spectrum:
        """Find out what the present state allows, and warn of a step that a person made too long."""
        found = spectrum(self._model, self._model.rods.axial_force, self._rods_that_limit)
        self.stable = math.inf
        if found.frequency > 0.0 or found.decay > 0.0:
            self.stable = self._driver().stable_step(found.frequency, found.decay)
        size = self._model.settings.time_step
        self.warning = ""
        if self.stable == 0.0 or (size is not None and size > self.stable):
            self.warning = f"{self.remedy(size)} The run will probably diverge."
        return found

    @property
    def _rods_that_limit(self) -> NDArray[np.bool_] | None:
        """Where the error is controlled those that are awake limit the step; None: all rods do."""
        if not self._controls_error or not self._sleep.any_asleep:
            return None
        particles = self._model.particles
        awake = (particles.mobility > 0.0).any(axis=1) & ~particles.asleep
        return np.asarray(awake[self._model.rods.between].any(axis=1))

    @property
    def _controls_error(self) -> bool:
        return self._driver().estimates_error and self._model.settings.time_step is None

    def remedy(self, size: float | None) -> str:
        """What to do about a run that is unstable with steps of this size (s), None: automatic."""
        driver = self._driver()
        name = driver.name.rpartition(".")[2]
        if self.stable == 0.0:
            return (
                f"Without damping {name} is stable at no time step:"
                f" choose the integrator {DEFAULT_DRIVER}, or give the rods damping."
            )
        if size is not None and size > self.stable:
            return (
                f"The time step {size:.3g} s is above the largest stable one, {self.stable:.3g} s for"
                f" {name}: set it to automatic or make it smaller."
            )
        if self._controls_error:
            return "Make the tolerance smaller."
        if driver.estimates_error:
            return "Set the time step to automatic, so that the error is controlled, or make it smaller."
        if driver is not INTEGRATORS[DEFAULT_DRIVER]:
            return f"Make the time step smaller, or choose the integrator {DEFAULT_DRIVER}."
        return "Make the time step smaller."

    def first(self) -> float:
        """The step size (s) with which a document begins."""
        found = self.look_up()
        for name in ("step_limit", "step_error", "largest_displacement", "largest_speed"):
            self._model.writable(f"clock.{name}")[0] = 0.0
        if self._controls_error:
            self._limit()
            return first_step(found.frequency, found.decay, self._model.clock.step_limit)
        chosen = self._model.settings.time_step
        return chosen if chosen is not None else self._automatic(found.frequency)

    def reviewed(self) -> float | None:
        """The step size (s) to go on with if what is stable changed much, or None."""
        if self._model.settings.time_step is not None:
            return None
        found = self.look_up()
        if self._controls_error:
            self._limit()
            return None
        wanted = self._automatic(found.frequency)
        return wanted if is_outgrown(self._model.clock.step_size, wanted, self.stable) else None

    def limit_anew(self) -> None:
        """Others are awake than before."""
        if self._controls_error:
            self.look_up()
            self._limit()

    def _limit(self) -> None:
        """Where the error is controlled, stability and the eye limit the step."""
        self._model.writable("clock.step_limit")[0] = step_limit(self.stable, self._longest_shown())

    def _automatic(self, frequency: float) -> float:
        shown = self._longest_shown() if isinstance(self._driver(), FreeFlight) else math.inf
        return automatic_step(self.stable, frequency, self._model.rods.count, shown)

    def _longest_shown(self) -> float:
        """What one step may last (s) so that a person sees it."""
        return SHOWN * natural_pace(self._model) if self.smooth else math.inf


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
