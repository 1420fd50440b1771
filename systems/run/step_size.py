"""Step size of one model's run: its limit by stability, its automatic choice, and the warning if it is too long."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Role
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.systems.physics.automatic import SMALL
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.physics.spectrum import Spectrum, spectrum
from pinjoint.systems.run.programs import Programs
from pinjoint.systems.run.sleep import Sleep

_SAFETY = 0.9  # share of the stable step that the automatic step takes in large models
_ACCURATE = 0.1  # share in small ones, whose steps cost next to nothing; error ∝ its square
_FIRST_SHARE = 0.1  # of 1/ω, the step at which error control begins
_CRAWLING = 1e-3  # of it: so much shorter ones under error control are told of
_FREE_STEP = 1e-3  # s, where nothing limits the step
_DOUBTFUL_STEP = 1e-2  # times 1/ω, for an integrator that is stable at no step
_EIGENVALUE_ERROR = 1e-9  # of the highest frequency, and so of the largest stable step
OBSERVED = 1.0 / 120.0  # s shown, at the natural pace, between two looks at exact flight or at what touches
PASSED = 1e-4  # share of the time so far between two looks at exact flight, so that any time is reached in some steps
_DEFAULT_INTEGRATOR = "velocity_verlet"


def begin_steps(model: Model, size: float) -> None:
    """From now on steps have this size (s), counted from the present time."""
    clock = model.clock
    for name, value in ("origin", clock.time), ("origin_steps", clock.steps), ("step_size", size):
        model.writable(f"clock.{name}")[0] = value


class StepSize:
    """Chooses the steps of one model's run, which its clock keeps.

    stable: the largest stable step (s) that was found last. warning: the sentence that the
    chosen step is too long, or "".
    """

    def __init__(self, model: Model, programs: Programs, sleep: Sleep) -> None:
        self._model = model
        self._programs = programs
        self._sleep = sleep
        self.stable = math.inf
        self.warning = ""
        self._looked_at = -1  # the revision of the document for which `_between_looks` was found
        self._between_looks = math.inf

    @property
    def _fixed(self) -> float | None:
        """The step (s) that a person chose; None: automatic."""
        return self._model.settings.time_step

    @property
    def _controls_error(self) -> bool:
        """True if the integrator chooses each step by its error, within a limit."""
        return self._programs.integrator.estimates_error and self._fixed is None

    @property
    def longest_in_contact(self) -> float:
        """The longest step (s) while contacts persist, which the document alone decides; infinite without error control.

        The forces of contacts are constant in a step, of which the estimates of errors know nothing.
        """
        if not self._controls_error:
            return math.inf
        revision = self._model.newest(Role.DOCUMENT)
        if self._looked_at != revision:
            self._looked_at = revision
            self._between_looks = _rounded_down(
                OBSERVED * natural_pace(self._model, moving=False, of_steps=True)
            )
        return self._between_looks

    def begin(self, size: float) -> None:
        """From now on steps have this size (s); the guard against divergence compares with this moment."""
        model, program = self._model, self._programs.dynamics
        begin_steps(model, size)
        program.observe()
        model.writable("clock.guard_energy")[0] = program.conserved_energy()

    def look_up(self) -> Spectrum:
        """Find out what the present state allows, and warn of a step that a person made too long."""
        found = spectrum(self._model, self._model.rods.axial_force, self._rods_that_limit())
        limited = found.frequency > 0.0 or found.decay > 0.0
        integrator = self._programs.integrator
        self.stable = integrator.stable_step(found.frequency, found.decay) if limited else math.inf
        self.warning = ""
        if self.stable == 0.0 or self.unstable:
            self.warning = joined([self.remedy(self._fixed), tr("The run will probably diverge.")])
        return found

    def _rods_that_limit(self) -> NDArray[np.bool_] | None:
        """Under error control the rods that are awake limit the step; None: all do."""
        if not self._controls_error or not self._sleep.any_asleep:
            return None
        particles = self._model.particles
        awake = (particles.mobility > 0.0).any(axis=1) & ~particles.asleep
        return np.asarray(awake[self._model.rods.between].any(axis=1))

    def first(self) -> float:
        """The step size (s) with which a document begins."""
        found, limit = self.look_up(), 0.0
        # Error control begins anew.
        for name in ("step_error", "largest_displacement", "largest_speed", "largest_rotation", "largest_spin"):
            self._model.writable(f"clock.{name}")[0] = 0.0
        if self._controls_error:
            size, limit = self._first_controlled(found), self._limit()
        else:
            size = self._automatic(found) if self._fixed is None else self._fixed
        self._model.writable("clock.step_limit")[0] = limit
        return size

    def _first_controlled(self, found: Spectrum) -> float:
        """The step (s) at which error control begins."""
        fastest = max(found.frequency, 2.0 * found.decay)
        first = _FIRST_SHARE / fastest if fastest > 0.0 else _FREE_STEP
        return _rounded_down(min(first, self._limit() or math.inf))

    def _limit(self) -> float:
        """The longest step (s) under error control, by stability; 0: nothing limits it."""
        limit = _SAFETY * self.stable
        return _rounded_down(limit) if limit < math.inf else 0.0

    def _automatic(self, found: Spectrum) -> float:
        """The step (s) without error control."""
        if self.stable == 0.0:
            return _rounded_down(min(_DOUBTFUL_STEP / found.frequency, _FREE_STEP))
        share = _ACCURATE if self._model.rods.count <= SMALL else _SAFETY
        longest = _FREE_STEP
        if self._programs.integrator.exact:  # steps are only how often flight is looked at
            longest = min(
                longest,
                max(OBSERVED * natural_pace(self._model, of_steps=True), PASSED * self._model.clock.time),
            )
        return _rounded_down(min(share * self.stable, longest))

    def review(self, mean: float) -> None:
        """Change automatic steps if what is stable changed much. mean: of the steps since the last review (s)."""
        if self._controls_error:
            found = self.look_up()
            self._model.writable("clock.step_limit")[0] = self._limit()
            if mean < _CRAWLING * self._first_controlled(found):
                self.warning = tr(
                    "Forces change so fast that time steps of {step:.2g} s are needed, {count:.2g} for each simulated"
                    " second. Look for a law whose force becomes infinite, or that is much stiffer than the rods.",
                    step=mean,
                    count=1.0 / mean,
                )
        elif self._fixed is None:
            wanted, size = self._automatic(self.look_up()), self._model.clock.step_size
            if not 0.5 * wanted <= size <= min(1.5 * wanted, 0.95 * self.stable):
                self.begin(wanted)

    def limit_anew(self) -> None:
        """Under error control: find the limit of the step anew, as others are awake or stiffnesses changed."""
        if self._controls_error:
            self.look_up()
            self._model.writable("clock.step_limit")[0] = self._limit()

    @property
    def unstable(self) -> bool:
        """True if a person chose steps that are not below the largest stable one, at which errors grow already."""
        return self._fixed is not None and self._is_unstable(self._fixed)

    def _is_unstable(self, size: float) -> bool:
        return size >= self.stable * (1.0 - _EIGENVALUE_ERROR)

    def remedy(self, size: float | None) -> str:
        """The remedy for a run that is unstable with steps of this size (s), None: automatic."""
        integrator = self._programs.integrator
        name = integrator.name.rpartition(".")[2]
        if self.stable == 0.0:
            return tr(
                "Without damping {integrator} is stable at no time step: choose the integrator {other}, or give the rods"
                " damping.",
                integrator=name,
                other=_DEFAULT_INTEGRATOR,
            )
        if size is not None and self._is_unstable(size):
            return tr(
                "The time step {step:.3g} s is too long: {integrator} is stable with steps below {stable:.3g} s. Set it to"
                " automatic or make it smaller.",
                step=size,
                integrator=name,
                stable=self.stable,
            )
        if self._controls_error:
            return tr("Make the tolerance smaller.")
        if integrator.estimates_error:
            return tr("Set the time step to automatic, so that its error is controlled, or make it smaller.")
        if integrator is not INTEGRATORS[_DEFAULT_INTEGRATOR]:
            return tr(
                "Make the time step smaller, or choose the integrator {integrator}.",
                integrator=_DEFAULT_INTEGRATOR,
            )
        return tr("Make the time step smaller.")


def _rounded_down(size: float) -> float:
    """To three significant digits, so that the last bits of an eigenvalue do not matter."""
    digits = 2 - math.floor(math.log10(size))
    return math.floor(size * 10.0**digits) / 10.0**digits
