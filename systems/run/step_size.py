"""Step size of one model's run: its limit by stability, its automatic choice, and the warning if it is too long."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Role
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.physics.spectrum import spectrum
from pinjoint.systems.run.policy import (
    ERROR_CONTROL,
    Limits,
    StepPolicy,
    begin_steps,
    is_unstable,
    rounded_down,
)
from pinjoint.systems.run.programs import Programs
from pinjoint.systems.run.sleep import Sleep

OBSERVED = 1.0 / 120.0  # s shown, at the natural pace, between two looks at exact flight or at what touches
PASSED = 1e-4  # share of the time so far between two looks at exact flight, so that any time is reached in some steps
DEFAULT_INTEGRATOR = "velocity_verlet"


class StepSize:
    """Applies the policy of step sizes to one model's clock.

    stable: the largest stable step (s) that was found last. warning: the sentence that the
    chosen step is too long, or "".
    """

    def __init__(self, model: Model, programs: Programs, sleep: Sleep) -> None:
        self._model = model
        self._programs = programs
        self._sleep = sleep
        self.stable = math.inf
        self.warning = ""
        self._looked_at = -1  # the revision of the document for which `observed` was found
        self._between_looks = math.inf

    @property
    def _policy(self) -> StepPolicy:
        model = self._model
        return StepPolicy(
            self._programs.integrator,
            model.settings.time_step,
            model.rods.count,
            self._observed,
        )

    def _observed(self) -> float:
        """The time (s) between two looks at exact flight."""
        return max(OBSERVED * natural_pace(self._model), PASSED * self._model.clock.time)

    @property
    def longest_in_contact(self) -> float:
        """The longest step (s) while contacts persist, which the document alone decides; infinite without error control.

        The forces of contacts are constant in a step, of which the estimates of errors know nothing.
        """
        if not self._policy.controls_error:
            return math.inf
        revision = self._model.newest(Role.DOCUMENT)
        if self._looked_at != revision:
            self._looked_at = revision
            self._between_looks = rounded_down(OBSERVED * natural_pace(self._model, moving=False))
        return self._between_looks

    def begin(self, size: float) -> None:
        """From now on steps have this size (s); the guard against divergence compares with this moment."""
        model, program = self._model, self._programs.dynamics
        begin_steps(model, size)
        program.observe()
        model.writable("clock.guard_energy")[0] = program.conserved_energy()

    def look_up(self) -> Limits:
        """Find out what the present state allows, and warn of a step that a person made too long."""
        policy = self._policy
        found = spectrum(self._model, self._model.rods.axial_force, self._rods_that_limit(policy))
        limits = Limits.of(policy.integrator, found.frequency, found.decay)
        self.stable, self.warning = limits.stable_step, ""
        if policy.is_doubtful(limits):
            self.warning = joined([self.remedy(policy.fixed), tr("The run will probably diverge.")])
        return limits

    def _rods_that_limit(self, policy: StepPolicy) -> NDArray[np.bool_] | None:
        """Under error control the rods that are awake limit the step; None: all do."""
        if not policy.controls_error or not self._sleep.any_asleep:
            return None
        particles = self._model.particles
        awake = (particles.mobility > 0.0).any(axis=1) & ~particles.asleep
        return np.asarray(awake[self._model.rods.between].any(axis=1))

    def first(self) -> float:
        """The step size (s) with which a document begins."""
        limits = self.look_up()
        for name in ERROR_CONTROL:
            self._model.writable(f"clock.{name}")[0] = 0.0
        size, limit = self._policy.first(limits)
        self._model.writable("clock.step_limit")[0] = limit
        return size

    def review(self, mean: float) -> None:
        """Change automatic steps if what is stable changed much. mean: of the steps since the last review (s)."""
        policy = self._policy
        if policy.controls_error:
            limits = self.look_up()
            self._model.writable("clock.step_limit")[0] = policy.limit(limits)
            if policy.crawls(limits, mean):
                self.warning = tr(
                    "Forces change so fast that time steps of {step:.2g} s are needed, {count:.2g} for each simulated"
                    " second. Look for a law whose force becomes infinite, or that is much stiffer than the rods.",
                    step=mean,
                    count=1.0 / mean,
                )
        elif policy.fixed is None:
            wanted = policy.reviewed(self.look_up(), self._model.clock.step_size)
            if wanted is not None:
                self.begin(wanted)

    def limit_anew(self) -> None:
        """Under error control: find the limit of the step anew, as others are awake or stiffnesses changed."""
        if self._policy.controls_error:
            self._model.writable("clock.step_limit")[0] = self._policy.limit(self.look_up())

    @property
    def unstable(self) -> bool:
        """True if a person chose steps that are not below the largest stable one."""
        fixed = self._policy.fixed
        return fixed is not None and is_unstable(fixed, self.stable)

    def remedy(self, size: float | None) -> str:
        """The remedy for a run that is unstable with steps of this size (s), None: automatic."""
        integrator = self._programs.integrator
        name = integrator.name.rpartition(".")[2]
        if self.stable == 0.0:
            return tr(
                "Without damping {integrator} is stable at no time step: choose the integrator {other}, or give the rods"
                " damping.",
                integrator=name,
                other=DEFAULT_INTEGRATOR,
            )
        if size is not None and is_unstable(size, self.stable):
            return tr(
                "The time step {step:.3g} s is too long: {integrator} is stable with steps below {stable:.3g} s. Set it to"
                " automatic or make it smaller.",
                step=size,
                integrator=name,
                stable=self.stable,
            )
        if self._policy.controls_error:
            return tr("Make the tolerance smaller.")
        if integrator.estimates_error:
            return tr("Set the time step to automatic, so that its error is controlled, or make it smaller.")
        if integrator is not INTEGRATORS[DEFAULT_INTEGRATOR]:
            return tr(
                "Make the time step smaller, or choose the integrator {integrator}.",
                integrator=DEFAULT_INTEGRATOR,
            )
        return tr("Make the time step smaller.")
