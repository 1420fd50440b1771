"""The guide through the force method: three sets of one structure, in seven parts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from components.commands import Assign
from components.field import Column, Role
from components.handle import Handle
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.table import Table
from components.tags import Selected
from components.view import View
from game.documents.shapes import DRAWN_SHARE, extent
from game.force_method import PARTS
from systems.run.real_time import RealTimeRunner
from systems.run.simulation import Simulation
from systems.schedule import Schedule
from systems.statics.force_method import (
    ForceMethodError,
    SetState,
    Solution,
    Unknown,
    counted_indeterminacy,
    solve,
    unit_force,
)
from systems.statics.settle import settle

DIAGRAM_HEIGHT = 34.0  # px of the largest force diagram
SWING = 3.0  # s in which a mechanism is shown to move there and back


@dataclass
class Set:
    """One of the three systems: its model, how it is seen, and its motion."""

    model: Model
    view: View
    live: RealTimeRunner

    @property
    def simulation(self) -> Simulation:
        """The run of the model."""
        return self.live.simulation

    @property
    def moves(self) -> bool:
        """True while its motion is shown."""
        return not self.live.simulation.halted

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass."""
        self.live.frame(elapsed)

    def scale_to(self, state: SetState) -> None:
        """Choose drawing scales for the displacements and forces at the end of the motion."""
        moved = float(np.abs(state.displacement).max(initial=0.0))
        pulled = float(np.abs(state.axial_force).max(initial=0.0))
        share = DRAWN_SHARE * extent(self.model)
        self.model.settings.displacement_scale = _round(share / moved) if moved > 0.0 else 1.0
        self.model.settings.diagram_scale = _round(DIAGRAM_HEIGHT / pulled) if pulled > 0.0 else 1.0

    def settle(self) -> None:
        """Skip the rest of the motion: go to its end, if there is one."""
        final = settle(self.model).final
        if final.status == "equilibrium":
            with self.model.transaction("settle"):
                self.model.give("particles.displacement", final.displacement)
                self.model.give("particles.velocity", np.zeros_like(final.displacement))


class Mechanism:
    """A structure that cannot carry its load, swinging along its motion, shape (n, 2)."""

    moves = True
    simulation = None  # no run: `advance` sets the displacements

    def __init__(self, model: Model, motion: Column, view: View) -> None:
        self.model, self.view = model, view
        self.model.settings.displacement_scale = 1.0
        self._motion = DRAWN_SHARE * extent(model) * motion
        self._time = 0.0

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass."""
        self._time += elapsed
        swing = math.sin(2.0 * math.pi * self._time / SWING)
        self.model.writable("particles.displacement")[...] = swing * self._motion


class Guide:
    """The part of the force method that the person is in, and the results so far.

    part: 1 to 7 as in REQUIREMENTS §4. released: the static unknowns, the newest last. solution: with all
    of them. sets: those that exist so far. mechanism: the structure that the last refused release would leave.
    Raises ForceMethodError at the start if the structure cannot carry its load.
    """

    def __init__(self, model: Model, schedule: Schedule, view: View) -> None:
        self.model, self._schedule, self._view = model, schedule, view
        self.part = 1
        self.released: list[Unknown] = []
        self.solution: Solution | None = None
        self.exact: list[float] | None = None
        self.refusal = ""
        self.mechanism: Mechanism | None = None
        self.axis_wanted: Particle | None = None
        real = solve(model, [])
        self.degree = counted_indeterminacy(model)
        self.sets = [self._make_set([], unit=None)]
        self.sets[0].scale_to(real.real)

    @property
    def unknown(self) -> Unknown | None:
        """The unknown that was released last."""
        return self.released[-1] if self.released else None

    # --- sets --------------------------------------------------------------------------------------

    def _make_set(self, released: Sequence[Unknown], unit: Unknown | None) -> Set:
        """A copy of the structure without some unknowns, under the real load or only a unit force."""
        copy = base_structure(self.model, released)
        if unit is not None:
            _unload(copy)
            copy.assign(list(copy.particles), "force", unit_force(self.model, unit).tolist())
        return Set(
            copy, view_like(self._view), RealTimeRunner(Simulation(copy, self._schedule, "force method"))
        )

    @property
    def running(self) -> list[Set]:
        """The sets that move in this part."""
        return {1: self.sets[:1], 3: self.sets[1:2], 5: self.sets[2:3], 7: self.sets[2:3]}.get(self.part, [])

    @property
    def shown(self) -> list[Set | Mechanism]:
        """The sets and mechanisms to show, from left to right."""
        return [*self.sets, self.mechanism] if self.mechanism is not None else [*self.sets]

    @property
    def moving(self) -> list[Set | Mechanism]:
        """The sets and mechanisms in motion."""
        shown: list[Set | Mechanism] = [*self.running, *([self.mechanism] if self.mechanism else [])]
        return [one for one in shown if one.moves]

    # --- going on ----------------------------------------------------------------------------------

    def next(self) -> bool:
        """Go on to the next part; False after the last. Part 2 is left by picking an unknown."""
        self._forget_refusal()
        if self.part == PARTS:
            return False
        for running in self.running:
            running.settle()
        if self.part == 2:
            self.refusal = "Pick the rod or the constraint first."
            return True
        self.part += 1
        if self.part == 5:
            self._show_set_3()
        elif self.part == 7:
            self._apply_forces()
        return True

    @property
    def can_release_another(self) -> bool:
        """True if the base structure is still hyperstatic and the unknowns so far are solved."""
        return self.part == PARTS and len(self.released) < self.degree

    def release_another(self) -> None:
        """Repeat the method for a further unknown, those so far released as well (part 7 → part 2)."""
        if self.part == PARTS:
            self.sets[2].settle()
            self.sets, self.part = self.sets[:1], 2

    def pick(self, hit: Handle | None) -> None:
        """Take the element clicked in set 1 as the unknown (part 2)."""
        self._forget_refusal()
        self.axis_wanted = None
        if isinstance(hit, Rod):
            self._take(Unknown(self.model.rods[hit.name]))
        elif isinstance(hit, Particle):
            self._pick_support(self.model.particles[hit.name])

    def _pick_support(self, particle: Particle) -> None:
        held = [axis for axis in (0, 1) if particle.fixed[axis]]
        if not held:
            self.refusal = f"{particle.name} has no constraint; pick a rod or a support."
        elif len(held) == 1:
            self._take(Unknown(particle, held[0]))
        else:
            self.axis_wanted = particle

    def pick_axis(self, axis: int) -> None:
        """Choose the direction of a particle constrained in both (part 2)."""
        if self.axis_wanted is not None:
            self._take(Unknown(self.axis_wanted, axis))

    def _take(self, unknown: Unknown) -> None:
        wanted = [*self.released, unknown]
        if unknown.name in {known.name for known in self.released}:
            self.refusal = f"{unknown.name} is released already; pick another one."
            return
        try:
            self.solution = solve(self.model, wanted)
        except ForceMethodError as error:
            self._refuse(error, wanted)
            return
        self.released, self.axis_wanted = wanted, None
        self.exact = exact_forces(self.model, wanted)
        self._mark_released()
        base = self._make_set(wanted, unit=None)
        base.scale_to(self.solution.base)
        self.sets = [self.sets[0], base]
        self.part = 3

    def _refuse(self, error: ForceMethodError, wanted: Sequence[Unknown]) -> None:
        """Say why a release is refused, and show the mechanism, if it would leave one."""
        self.refusal = str(error)
        if error.motion is not None:
            base = base_structure(self.model, wanted)
            self.mechanism = Mechanism(base, error.motion, view_like(self._view))

    def _forget_refusal(self) -> None:
        self.refusal, self.mechanism = "", None

    def _mark_released(self) -> None:
        """The released elements are drawn as selected in set 1."""
        model = self.sets[0].model
        tables: dict[str, Table[Any]] = model.tables
        model.tag_only([tables[one.element.table][one.element.name] for one in self.released], Selected)

    def _show_set_3(self) -> None:
        assert self.solution is not None
        unit = self._make_set(self.released, unit=self.released[-1])
        unit.scale_to(self.solution.units[-1])
        self.sets.append(unit)

    def _apply_forces(self) -> None:
        """The hyperstatic forces in place of the unit force (part 7)."""
        assert self.solution is not None
        third = self.sets[2]
        force, displacement, axial_force = (np.zeros(shape) for shape in _shapes(self.solution))
        for p, unknown, unit in zip(self.solution.force, self.released, self.solution.units, strict=True):
            force += p * unit_force(self.model, unknown)
            displacement += p * unit.displacement
            axial_force += p * unit.axial_force
        third.model.assign(list(third.model.particles), "force", force.tolist())
        third.scale_to(SetState(displacement, axial_force))
        for name in (
            "displacement_scale",
            "diagram_scale",
        ):  # the same scale, so that the sum of sets 2 and 3 can be seen
            scale = min(getattr(one.model.settings, name) for one in self.sets)
            for one in self.sets:
                setattr(one.model.settings, name, scale)


def _shapes(solution: Solution) -> tuple[tuple[int, ...], ...]:
    moved = solution.base.displacement.shape
    return moved, moved, solution.base.axial_force.shape


def view_like(view: View) -> View:
    """A view of a set with the choices of the view of the window."""
    return View(all_diagrams=view.all_diagrams, legend=False, pixel_ratio=view.pixel_ratio)


def elastic_copy(model: Model) -> Model:
    """The same structure without yielding, at rest at the beginning of time; only moved supports are displaced."""
    copy = Model()
    for name, table in model.tables.items():
        kept = [field.name for field in table.fields_in(Role.DOCUMENT)] + ["plastic_strain"] * (name == "rods")
        columns = {field: table.column(field) for field in kept}
        if name == "particles":
            columns["displacement"] = np.where(table.fixed, table.displacement, 0.0)
        if table.kind.single:
            [one] = copy.tables[name]
            for field, column in columns.items():
                copy.apply(Assign(name, field, (one.entity,), column))
        else:
            copy.create(table.kind, table.count, **columns)
    copy.settings.plasticity = False
    return copy


def base_structure(model: Model, released: Sequence[Unknown]) -> Model:
    """An elastic copy without some unknowns, which keeps all nodal masses."""
    copy = elastic_copy(model)
    copy.settings.time_step = None
    copy.settings.collisions = False
    if released:
        copy.assign(list(copy.particles), "prescribed_mass", model.particles.mass.tolist())
    for unknown in released:
        _release(copy, unknown)
    return copy


def exact_forces(model: Model, unknowns: Sequence[Unknown]) -> list[float] | None:
    """The unknowns' forces (kN) by exact geometry, without yielding; None if there is no equilibrium."""
    if not unknowns:
        return []
    final = settle(elastic_copy(model)).final
    if final.status != "equilibrium":
        return None
    return [
        float(final.axial_force[unknown.element.row])
        if unknown.axis is None
        else float(final.reaction[unknown.element.row, unknown.axis])
        for unknown in unknowns
    ]


def _unload(model: Model) -> None:
    """Remove loads, accelerations, misfits, temperature changes and moved supports."""
    model.delete(list(model.loads))
    model.environment.force = model.environment.acceleration = (0.0, 0.0)
    particles = list(model.particles)
    model.assign(particles, "acceleration", [(0.0, 0.0)] * len(particles))
    model.assign(particles, "displacement", [(0.0, 0.0)] * len(particles))
    rods = list(model.rods)
    model.assign(rods, "plastic_strain", [0.0] * len(rods))
    model.assign(rods, "prescribed_rest_length", model.rods.original_length.tolist())
    model.assign(rods, "temperature_change", [0.0] * len(rods))


def _release(model: Model, unknown: Unknown) -> None:
    if unknown.axis is None:
        model.delete([model.rods[unknown.element.name]])
        return
    particle = model.particles[unknown.element.name]
    x, y = particle.fixed
    particle.fixed = (x and unknown.axis != 0, y and unknown.axis != 1)


def _round(number: float) -> float:
    power = 10.0 ** math.floor(math.log10(number))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= number * (1 + 1e-9))
