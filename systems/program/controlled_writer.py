"""Step programs of integrators that control their steps: powers, events, tangents; see templates/runge_kutta.py."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pinjoint.components.model import Model
from pinjoint.systems.base import Integrator, StepSystem
from pinjoint.systems.physics.kernels import lowest
from pinjoint.systems.plasticity.kernels import AT_LIMIT
from pinjoint.systems.program.binding import Bound, StepRole, bind
from pinjoint.systems.program.entries import Mark
from pinjoint.systems.program.loops import RodLoop
from pinjoint.systems.program.templates import events, forces, implicit, rods, runge_kutta
from pinjoint.systems.program.writer import NO_POWER, POWER_RETURNED, Writer

_AHEAD = 1e-3  # of a step, over which the slope of a margin is taken
_LASTING = 1.0 - AT_LIMIT  # share of a plastic moment at which an end that goes on turning slips
_STEADY = 1e-8  # a margin that changes less in a step is not watched


class ControlledWriter(Writer):
    """Writes step programs whose integrator needs powers at every stage, events and tangents."""

    def __init__(self, model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> None:
        super().__init__(model, systems, integrator, form)
        self.branches = [(bind(s, model, "branch"), bind(s, model, "margin")) for s in self.branching]
        self.names |= {b.call: b.function for pair in self.branches for b in pair} | {"lowest": lowest}
        self._add_columns(b for pair in self.branches for b in pair)

    @property
    def kernels(self) -> list[Bound]:
        """All kernels of the systems, which are tried one by one if the program does not compile."""
        return [*super().kernels, *(b for pair in self.branches for b in pair)]

    @property
    def scratch(self) -> tuple[str, ...]:
        return ("search", "work", "rod_work", "marks", "power", "gained", "stage_power")

    def _values(self) -> dict[str, Any]:
        located = bool(self.branches or self.events)
        return super()._values() | {"EVENTS": located, "COMMITS": bool(self.commits)}

    def _of_steps(self) -> list[str]:
        parts = [self._evaluate(), *([self._remember()] if self.commits else [])]
        if self.branches or self.events:
            parts += [self._located(events.mark, events.note), self._located(events.passed, events.look)]
        parts += self._happened()
        return [*parts, self._tangent()] if self.integrator.rod_rows else parts

    def _steps(self) -> dict[str, list[str]]:
        return {"present": self.lines(forces.present), "step": self.lines(runge_kutta.step)}

    def _remember(self) -> str:
        compute, lost = self._histories(self.commits)
        loop = RodLoop(self.shift, [*self.geometry(), *compute], scatter=[*lost.values()]).one_by_one()
        return self.function(forces.remember, "compiled", history=self._with_losses(self.commits, loop))

    def _evaluate(self) -> str:
        lines = [
            *NO_POWER,
            *self._particle_forces(powers=True),
            *self._rod_loop(self._rod_forces([], powers=True)),
            *POWER_RETURNED,
            *self._pushes(),
        ]
        return self.function(forces.evaluate, "compiled", trial_forces=lines)

    # --- events -----------------------------------------------------------------------------------

    def _located(self, function: Callable[..., float], template: Callable[[], None]) -> str:
        """A function that does what the template says for every law that has branches, and every event."""
        lines: dict[str, list[str]] = {"rods": [], "particles": []}
        for place, (branch, margin) in enumerate(self.branches):
            of_row = events.of_ends if "gain_start" in margin.parameters else events.of_rod
            slope = self._slope(of_row, self._apply(margin, "r"), [])
            lines["rods"] += self._look(template, place, self._apply(branch, "r"), slope)
        for place, b in enumerate(self.events, start=len(self.branches)):
            of_row = events.of_rod if b.each == "rods" else events.of_particle
            quantity = self._apply(b, "r")
            if b.each == "particles":
                quantity = quantity.replace("(displacement[r, 0], displacement[r, 1])", "(x, y)")
            side = f"-1.0 if {b.sides}[r] == Side.NEGATIVE else 1.0"
            slope = self._slope(of_row, f"branch * {quantity}", self._needed_force(b))
            lines[b.each] += self._look(template, place, side, slope)
        slipping = self.lines(rods.slip_rates, ahead=str(_AHEAD), share=str(_LASTING)) if self.slips else []
        return self.function(function, "compiled", **self._each_row(lines, slipping))

    def _look(self, template: Callable[[], None], place: int, branch: str, slope: list[str]) -> list[str]:
        law = str(len(Mark) * place)
        return self.lines(template, law=law, branch=branch, steady=str(_STEADY), margin_and_slope=slope)

    def _slope(self, template: Callable[[], None], margin: str, axial_force: list[str]) -> list[str]:
        """Lines that give a margin and its rate. axial_force: lines by which it follows from the elongation."""
        return self.lines(template, margin=margin, axial_force=axial_force, ahead=str(_AHEAD))

    def _turned(self, place: int) -> str:
        margin = f"marks[r, {len(Mark) * (len(self.branches) + place)} + Mark.MARGIN]"
        return f"gap < -EVENT_FLOOR or (gap <= EVENT_FLOOR and {margin} > EVENT_FLOOR)"

    # --- tangents ---------------------------------------------------------------------------------

    def _tangent(self) -> str:
        particles = [
            line
            for b in self.of[StepRole.RESISTANCE]
            for line in self.lines(implicit.particle_tangent, force=self._apply(b, "i"))
        ]
        particles += [
            line
            for b in self.of[StepRole.TURNING]
            for line in self.lines(implicit.turning_tangent, moment=self._apply(b, "i"))
        ]
        damping_force = [
            "damping_force = 0.0",
            *(f"damping_force += {self._apply(b, 'r')}" for b in self.of[StepRole.RATE]),
        ]
        tangent = self.lines(
            implicit.rod_tangent,
            DAMPED=bool(self.of[StepRole.RATE]),
            rate=self.rate(),
            axial_force=self._axial_force(),
            damping_force=damping_force,
            bending=self._tangent_of_ends(),
        )
        loop = RodLoop(self.shift | self.drift, [*self.geometry(), *tangent])
        return self.function(implicit.tangent, "compiled", particles=particles, rods=loop.one_by_one())

    def _tangent_of_ends(self) -> list[str]:
        return self.lines(
            rods.tangent_of_ends,
            by_slopes=self._tangent_by(self.of[StepRole.ENDS], "slope", "by_x"),
            by_rates=self._tangent_by(self.of[StepRole.RATE_OF_ENDS], "rate", "by_v"),
            moments=self.end_moments(),
        )

    def _tangent_by(self, laws: Sequence[Bound], kind: str, share: str) -> list[str]:
        """Lines that add how the moments of these laws follow the slopes, or their rates."""
        lines: list[str] = []
        for line in self.lines(rods.tangent_by, share=share, laws="laws") if laws else []:
            lines += self.end_laws(laws, "summed") if line == "laws" else [line.replace("slope", kind)]
        return lines
