"""What a step program holds besides for integrators that control their steps; see templates/runge_kutta.py."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from components.model import Model
from systems.base import Integrator, StepSystem
from systems.entries import Mark
from systems.program.binding import Bound, StepRole, bind
from systems.program.loops import RodLoop
from systems.program.pasting import fragment, pasted
from systems.program.templates import events, forces, implicit, rods
from systems.program.writer import DRIFT, NO_POWER, POWER_RETURNED, SHIFT, TRIAL_STATE, Writer

_AHEAD = 1e-3  # of a step, over which the slope of a margin is taken
_STEADY = 1e-8  # a margin that changes less in a step is not watched


class ControlledWriter(Writer):
    """Writes step programs whose integrator needs powers at every stage, events and tangents."""

    def __init__(self, model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> None:
        super().__init__(model, systems, integrator, form)
        self.events = [(bind(s, model, "branch"), bind(s, model, "margin")) for s in self.branching]
        self.names |= {b.call: b.function for pair in self.events for b in pair} | {"lowest": _lowest()}
        self._add_columns(b for pair in self.events for b in pair)

    @property
    def scratch(self) -> tuple[str, ...]:
        return ("search", "work", "rod_work", "marks", "power", "gained", "stage_power")

    def _values(self) -> dict[str, Any]:
        return super()._values() | {"EVENTS": bool(self.events), "COMMITS": bool(self.commits)}

    def _of_steps(self) -> list[str]:
        parts = [self._evaluate(), *([self._remember()] if self.commits else [])]
        parts += [self._mark(), self._passed()] if self.events else []
        return [*parts, self._tangent()] if self.integrator.rod_rows else parts

    @property
    def _evaluation(self) -> str:
        return f"evaluate({TRIAL_STATE}, power, *columns)"

    def _remember(self) -> str:
        compute, lost = self._histories(self.commits)
        loop = RodLoop(SHIFT, [*self.geometry(), *compute], scatter=[*lost.values()]).one_by_one()
        return pasted(forces.remember, "compiled", history=self._with_losses(self.commits, loop))

    def _commit(self) -> str:
        return pasted(forces.commit, "entered", history="remember(time, dt, displacement, account, *columns)")

    def _evaluate(self) -> str:
        lines = [
            *NO_POWER,
            *self._particle_forces(powers=True),
            *self._rod_loop(self._rod_forces([], powers=True)),
            *POWER_RETURNED,
        ]
        return pasted(forces.evaluate, "compiled", trial_forces=lines)

    # --- events -----------------------------------------------------------------------------------

    def _mark(self) -> str:
        return pasted(events.mark, "compiled", rods=self._each_event(events.note))

    def _passed(self) -> str:
        return pasted(events.passed, "compiled", rods=self._each_event(events.look))

    def _each_event(self, template: Callable[[], None]) -> list[str]:
        """A loop over the rods with this template for every law that has branches."""
        lines = [*self.geometry(), *fragment(rods.rate)]
        for place, (branch, margin) in enumerate(self.events):
            lines += fragment(
                template,
                law=str(len(Mark) * place),
                branch=self._apply(branch, "r"),
                steady=str(_STEADY),
                margin_and_slope=fragment(
                    events.margin_and_slope, margin=self._apply(margin, "r"), ahead=str(_AHEAD)
                ),
            )
        return RodLoop(SHIFT | DRIFT, lines).one_by_one()

    # --- tangents ---------------------------------------------------------------------------------

    def _tangent(self) -> str:
        particles = [
            line
            for b in self.of[StepRole.RESISTANCE]
            for line in fragment(implicit.particle_tangent, force=self._apply(b, "i"))
        ]
        damping_force = [
            "damping_force = 0.0",
            *(f"damping_force += {self._apply(b, 'r')}" for b in self._rates),
        ]
        tangent = fragment(
            implicit.rod_tangent,
            rate=fragment(rods.rate),
            axial_force=self._axial_force(),
            dampers=fragment(implicit.damper_tangent, damping_force=damping_force) if self._rates else [],
        )
        loop = RodLoop(SHIFT | DRIFT, [*self.geometry(), *tangent])
        return pasted(implicit.tangent, "compiled", particles=particles, rods=loop.one_by_one())

    @property
    def _rates(self) -> list[Bound]:
        return self.of[StepRole.RATE]


def _lowest() -> Any:
    from systems.physics.kernels import lowest  # numba is imported when a program is built, not before

    return lowest
