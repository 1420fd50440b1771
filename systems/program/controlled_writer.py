"""What a step program holds besides for drivers that control their steps; see systems/physics/runge_kutta.py."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from components.model import Model
from systems.base import ACCOUNTS, Driver, StepSystem
from systems.program.binding import Bound, bind
from systems.program.loops import RodLoop, indented
from systems.program.writer import DRIFT, RATE, SHIFT, Writer

MARKS = 4  # per rod and branching system: branch, margin, its slope as the step starts, whether it is watched
_AHEAD = 1e-3  # of a step, over which the slope of a margin is taken
_STEADY = 1e-8  # a margin that changes less in a step is not watched


class ControlledWriter(Writer):
    """Writes step programs whose driver needs powers at every stage, events and tangents."""

    def __init__(self, model: Model, systems: Sequence[StepSystem], driver: Driver, form: str) -> None:
        super().__init__(model, systems, driver, form)
        self.events = [(bind(s, model, "branch"), bind(s, model, "margin")) for s in self.branching]
        self.kernels |= {b.call: b.function for pair in self.events for b in pair} | {"lowest": _lowest()}
        self._add_columns(b for pair in self.events for b in pair)

    def _constants(self) -> str:
        return super()._constants() + f"EVENTS = {bool(self.events)}\nCOMMITS = {bool(self.commits)}\n"

    def _for_driver(self) -> list[str]:
        parts = [self._evaluate(), *([self._remember()] if self.commits else [])]
        parts += [self._mark(), self._passed()] if self.events else []
        return [*parts, self._tangent()] if self.driver.rod_rows else parts

    @property
    def _observed_forces(self) -> str:
        return (
            super()
            ._observed_forces.replace("forces(", "evaluate(")
            .replace("direction, ", "direction, power, ")
        )

    def _remember(self) -> str:
        """History of all rods at an accepted state."""
        slots = sorted({b.slot for b in self.commits})
        compute, lost = self._commits(self.commits)
        body = [
            *(f"lost_{slot} = 0.0" for slot in slots),
            *RodLoop(SHIFT, [*self._geometry(), *compute], scatter=[*lost.values()]).one_by_one(),
            *(f"account[{slot}] += 1000.0 * lost_{slot}" for slot in slots),
        ]
        head = f"def remember(time, dt, displacement, account, {self._columns_text()}):"
        return "\n".join(["@compiled", head, *indented(body)])

    def _commit(self) -> str:
        head, _, _ = super()._commit().partition("    accept(")
        return f"{head}    remember(time, dt, displacement, account, {self._columns_text()})"

    def _evaluate(self) -> str:
        """The forces of a trial state, with what each account gains per second."""
        head = (
            "def evaluate(time, dt, displacement, velocity, force, resisting, direction, power,"
            f" {self._columns_text()}):"
        )
        body = [f"power_{slot} = 0.0" for slot in range(len(ACCOUNTS))]
        body += self._particle_forces(powers=True)
        body += self._rod_loop(self._rod_forces([], powers=True))
        body += [f"power[{slot}] = power_{slot}" for slot in range(len(ACCOUNTS))]
        return "\n".join(["@compiled", head, *indented(body)])

    # --- events -----------------------------------------------------------------------------------

    def _mark(self) -> str:
        rods = [*self._geometry(), RATE]
        for first, (branch, margin) in zip(range(0, 1000, MARKS), self.events, strict=False):
            rods += [
                f"branch = {self._apply(branch, 'r')}",
                f"marks[r, {first}] = branch",
                *self._margin_and_slope(margin),
                f"marks[r, {first + 1}] = gap",
                f"marks[r, {first + 2}] = slope",
                f"marks[r, {first + 3}] = 0.0",
                "low = min(low, gap)",
            ]
        head = f"def mark(dt, displacement, velocity, marks, {self._columns_text()}):"
        body = ["low = math.inf", *RodLoop(SHIFT | DRIFT, rods).one_by_one(), "return low"]
        return "\n".join(["@compiled", head, *indented(body)])

    def _passed(self) -> str:
        rods = [*self._geometry(), RATE]
        for first, (_, margin) in zip(range(0, 1000, MARKS), self.events, strict=False):
            rods += [
                f"branch = marks[r, {first}]",
                *self._margin_and_slope(margin),
                f"before = marks[r, {first + 2}]",
                f"if first and gap > 0.0 and before * dt < -{_STEADY} and slope > 0.0:",
                f"    start = marks[r, {first + 1}]",
                "    least = lowest(start, before, gap, slope, dt)",
                "    if least < min(start, gap) - least:",
                f"        marks[r, {first + 3}] = 1.0",
                f"if marks[r, {first + 3}] > 0.0:",
                "    gap = min(gap, -slope * dt)",
                "low = min(low, gap)",
            ]
        head = f"def passed(dt, displacement, velocity, marks, first, {self._columns_text()}):"
        body = ["low = math.inf", *RodLoop(SHIFT | DRIFT, rods).one_by_one(), "return low"]
        return "\n".join(["@compiled", head, *indented(body)])

    def _margin_and_slope(self, margin: Bound) -> list[str]:
        return [
            f"gap = {self._apply(margin, 'r')}",
            "here = elongation",
            f"elongation = here + rate * ({_AHEAD} * dt)",
            f"slope = ({self._apply(margin, 'r')} - gap) / ({_AHEAD} * dt)",
            "elongation = here",
        ]

    # --- tangents ---------------------------------------------------------------------------------

    def _tangent(self) -> str:
        """How forces follow an acceleration that adds by_x × itself to displacements, by_v to velocities.

        Derivatives of the laws are central differences, wide enough for round-off and exact where a law
        is linear.
        """
        head = (
            "def tangent(time, dt, by_x, by_v, displacement, velocity, direction, along, across, diagonal,"
            f" beside, {self._columns_text()}):"
        )
        body = [*self._particle_tangents(), *RodLoop(SHIFT | DRIFT, self._rod_tangents()).one_by_one()]
        return "\n".join(["@compiled", head, *indented(body)])

    def _particle_tangents(self) -> list[str]:
        body = [
            "diagonal[i, 0] = 0.001 * particles_mass[i]",
            "diagonal[i, 1] = 0.001 * particles_mass[i]",
            "beside[i, 0] = 0.0",
        ]
        if self.particle_rates:
            body += [
                "vx = velocity[i, 0]",
                "vy = velocity[i, 1]",
                "small = 1e-6 * (abs(vx) + abs(vy)) + 1e-9",
            ]
        for b in self.particle_rates:
            for axis in range(2):
                body += [
                    f"velocity[i, {axis}] = v{'xy'[axis]} + small",
                    f"fx, fy = {self._apply(b, 'i')}",
                    f"velocity[i, {axis}] = v{'xy'[axis]} - small",
                    f"gx, gy = {self._apply(b, 'i')}",
                    f"velocity[i, {axis}] = v{'xy'[axis]}",
                    "share = 0.5 * by_v / small",
                    f"diagonal[i, {axis}] -= share * (f{'xy'[axis]} - g{'xy'[axis]})",
                    f"beside[i, 0] -= 0.5 * share * (f{'yx'[axis]} - g{'yx'[axis]})",
                ]
        return ["for i in range(displacement.shape[0]):", *indented(body)]

    def _rod_tangents(self) -> list[str]:
        lines = [
            *self._geometry(),
            "direction[r, 0] = nx",
            "direction[r, 1] = ny",
            RATE,
            *self._axial_force(),
            "total = axial_force",
            "here = elongation",
            "small = 1e-7 * (length + original)",
            "elongation = here + small",
            *self._axial_force(),
            "more = axial_force",
            "elongation = here - small",
            *self._axial_force(),
            "stiffness = by_x * (more - axial_force) / (2.0 * small)",
            "elongation = here",
            "axial_force = total",
        ]
        if self.rod_rates:
            damping_force = [f"damping_force += {self._apply(b, 'r')}" for b in self.rod_rates]
            lines += [
                "damping_force = 0.0",
                *damping_force,
                "total += damping_force",
                "present = rate",
                "small = small / by_v",
                "rate = present + small",
                "damping_force = 0.0",
                *damping_force,
                "more = damping_force",
                "rate = present - small",
                "damping_force = 0.0",
                *damping_force,
                "stiffness += by_v * (more - damping_force) / (2.0 * small)",
            ]
        return [*lines, "along[r] = stiffness", "across[r] = by_x * total * inverse"]


def _lowest() -> Any:
    from systems.physics.kernels import lowest  # numba is imported when a program is built, not before

    return lowest
