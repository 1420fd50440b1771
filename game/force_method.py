"""The guide through the force method: three sets of one structure, in seven parts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from components.field import Role
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.tags import Selected
from components.view import View
from components.world import Handle
from game.document import document, parse
from game.live import Live
from game.schedule import Schedule
from game.simulation import Simulation
from systems.statics.force_method import (
    ForceMethodError,
    LinearState,
    Solution,
    Unknown,
    solve,
    unit_force,
)
from systems.statics.settle import settle

PARTS = 7
DRAWN_SHARE = 0.12  # of the structure's size that the largest displacement is drawn as
DIAGRAM_HEIGHT = 34.0  # px of the largest force diagram

_NAMES = ("Set 1: real structure", "Set 2: base structure", "Set 3: base structure, unit load")


@dataclass
class Set:
    """One of the three systems: its model, how it is seen, and its motion."""

    model: Model
    view: View
    live: Live

    def scale_to(self, state: LinearState) -> None:
        """Choose drawing scales for the displacements and forces that it will come to."""
        size = float(np.ptp(self.model.particles.position, axis=0).max())
        moved = float(np.abs(state.displacement).max(initial=0.0))
        pulled = float(np.abs(state.axial_force).max(initial=0.0))
        self.model.settings.displacement_scale = _round(DRAWN_SHARE * size / moved) if moved > 0.0 else 1.0
        self.model.settings.diagram_scale = _round(DIAGRAM_HEIGHT / pulled) if pulled > 0.0 else 1.0

    def settle(self) -> None:
        """Do not wait for the rest of the motion: go to where it ends, if it does."""
        final = settle(self.model).final
        if final.status == "equilibrium":
            with self.model.transaction("settle"):
                self.model.give("particles.displacement", final.displacement)
                self.model.give("particles.velocity", np.zeros_like(final.displacement))


class Guide:
    """Where the person is in the force method, and what was found.

    part: 1 to 7 as in REQUIREMENTS §4. sets: those that exist so far. Raises ForceMethodError at the
    start if the structure cannot carry its load.
    """

    def __init__(self, model: Model, schedule: Schedule, view: View) -> None:
        self._model, self._schedule, self._view = model, schedule, view
        self.part = 1
        self.unknown: Unknown | None = None
        self.solution: Solution | None = None
        self.exact_force: float | None = None
        self.refusal = ""
        self._pending: Particle | None = None
        real = solve(model, [])
        self.sets = [self._make_set([], unit=None)]
        self.sets[0].scale_to(real.real)

    # --- sets --------------------------------------------------------------------------------------

    def _make_set(self, released: Sequence[Unknown], unit: Unknown | None) -> Set:
        """A copy of the structure without some unknowns, under the real load or only a unit force."""
        copy = elastic_copy(self._model)
        copy.settings.time_step = None
        copy.settings.collisions = False
        if released:  # the base structure keeps all nodal masses
            copy.assign(list(copy.particles), "prescribed_mass", self._model.particles.mass.tolist())
        if unit is not None:
            _unload(copy)
            copy.assign(list(copy.particles), "force", unit_force(self._model, unit).tolist())
        for unknown in released:
            _release(copy, unknown)
        view = View(all_diagrams=self._view.all_diagrams, legend=False, pixel_ratio=self._view.pixel_ratio)
        return Set(copy, view, Live(Simulation(copy, self._schedule)))

    @property
    def running(self) -> list[Set]:
        """The sets that move in this part."""
        return {1: self.sets[:1], 3: self.sets[1:2], 5: self.sets[2:3], 7: self.sets[2:3]}.get(self.part, [])

    # --- going on ----------------------------------------------------------------------------------

    def next(self) -> bool:
        """Go on to the next part; False after the last. Part 2 is left by picking an unknown."""
        self.refusal = ""
        for running in self.running:
            running.settle()
        if self.part == PARTS:
            return False
        if self.part == 2:
            self.refusal = "Pick the rod or the constraint first."
            return True
        self.part += 1
        if self.part == 5:
            self._show_set_3()
        elif self.part == 7:
            self._apply_force()
        return True

    def pick(self, hit: Handle | None) -> None:
        """Take what was clicked in set 1 as the unknown (part 2)."""
        self.refusal = ""
        self._pending = None
        if isinstance(hit, Rod):
            self._take(Unknown(self._model.rods[hit.name]))
        elif isinstance(hit, Particle):
            self._pick_support(self._model.particles[hit.name])

    def _pick_support(self, particle: Particle) -> None:
        held = [axis for axis in (0, 1) if particle.fixed[axis]]
        if not held:
            self.refusal = f"{particle.name} has no constraint; pick a rod or a support."
        elif len(held) == 1:
            self._take(Unknown(particle, held[0]))
        else:
            self._pending = particle

    def pick_axis(self, axis: int) -> None:
        """Choose the direction of a particle constrained in both (part 2)."""
        if self._pending is not None:
            self._take(Unknown(self._pending, axis))

    def _take(self, unknown: Unknown) -> None:
        try:
            self.solution = solve(self._model, [unknown])
            exact = exact_forces(self._model, [unknown])
        except ForceMethodError as error:
            self.refusal = str(error)
            return
        self.unknown, self._pending = unknown, None
        self.exact_force = exact[0] if exact is not None else None
        self._mark(unknown)
        base = self._make_set([unknown], unit=None)
        base.scale_to(self.solution.base)
        self.sets = [self.sets[0], base]
        self.part = 3

    def _mark(self, unknown: Unknown) -> None:
        """The released element is drawn as selected in set 1."""
        model = self.sets[0].model
        table = model.rods if isinstance(unknown.element, Rod) else model.particles
        for handle in model.tagged(Selected):
            model.untag(handle, Selected)
        model.tag(table[unknown.element.name], Selected)

    def _show_set_3(self) -> None:
        assert self.unknown is not None
        assert self.solution is not None
        unit = self._make_set([self.unknown], unit=self.unknown)
        unit.scale_to(self.solution.units[0])
        self.sets.append(unit)

    def _apply_force(self) -> None:
        """The hyperstatic force in place of the unit force (part 7)."""
        assert self.unknown is not None
        assert self.solution is not None
        force, unit, third = float(self.solution.force[0]), self.solution.units[0], self.sets[2]
        applied = force * unit_force(self._model, self.unknown)
        third.model.assign(list(third.model.particles), "force", applied.tolist())
        third.scale_to(LinearState(force * unit.displacement, force * unit.axial_force))

    # --- what is said --------------------------------------------------------------------------------

    @property
    def message(self) -> str:
        """The line of red text: what is happening or expected."""
        if self.refusal:
            return self.refusal
        if self.part == 2:
            return "Select constraint direction" if self._pending else "Select the discontinuity element"
        return {
            1: "Real structure under the real load",
            3: f"Base structure: {self._released} is released",
            4: "How far the released place moved",
            5: f"Base structure under {self._unit_words} alone",
            6: "How far the unit force moves it",
            7: "Set 2 + set 3 = set 1",
        }[self.part]

    @property
    def hint(self) -> str:
        """The next possible step."""
        if self.part == 2:
            return (
                "X or Y direction"
                if self._pending
                else "click a rod or a support in set 1     Esc back to pause"
            )
        return f"K {'finish' if self.part == PARTS else 'next part'}     I forces     Esc back to pause"

    @property
    def _released(self) -> str:
        return self.unknown.name if self.unknown is not None else ""

    @property
    def _unit_words(self) -> str:
        if self.unknown is None or self.unknown.axis is None:
            return "a pair of unit forces"
        return "a unit force"

    def captions(self) -> list[tuple[str, ...]]:
        """For every set its name, and its displacement once it has been measured."""
        shown: list[tuple[str, ...]] = [(name,) for name in _NAMES[: len(self.sets)]]
        solution = self.solution
        if solution is None or self.part < 4:
            return shown
        what = "Δ" if self.unknown is not None and self.unknown.axis is None else "u"
        facts = [
            f"{what}_real = {millimetres(solution.delta_real[0])}",
            f"{what}₀ = {millimetres(solution.delta_base[0])}",
        ]
        if self.part >= 6:
            facts.append(f"{what}₁ = {millimetres(solution.delta_unit[0, 0])} per kN")
        shown = [(*caption, fact) for caption, fact in zip(shown, [*facts, ""], strict=False)]
        if self.part == PARTS:
            shown[2] = (f"Set 3: base structure, p = {_signed(solution.force[0])} kN", shown[2][1])
        return shown

    def working(self) -> tuple[str, ...]:
        """The compatibility equation with its numbers (part 7)."""
        solution = self.solution
        if solution is None or self.part < PARTS:
            return (
                ("Yielding is switched off: superposition needs linear behaviour.",) if self.part == 1 else ()
            )
        real, base, unit = solution.delta_real[0], solution.delta_base[0], solution.delta_unit[0, 0]
        exact = self.exact_force
        beside = f"     exact geometry gives {_signed(exact)} kN" if exact is not None else ""
        return (
            f"p = (Δ_real − Δ₀) / Δ₁ = ({_mm(real)} − ({_mm(base)})) mm / ({_mm(unit)} mm/kN)"
            f" = {_signed(solution.force[0])} kN{beside}",
        )

    def table(self) -> tuple[tuple[str, ...], ...]:
        """Set 1 = set 2 + set 3, rod by rod (part 7), in kN."""
        solution = self.solution
        if solution is None or self.part < PARTS:
            return ()
        sum_, rows = solution.superposed.axial_force, []
        for row, rod in enumerate(self._model.rods):
            real, base = float(solution.real.axial_force[row]), float(solution.base.axial_force[row])
            residual = float(sum_[row]) - real
            rows.append(
                (
                    rod.name,
                    *(_signed(n) for n in (real, base, float(sum_[row]) - base)),
                    f"{residual:.0e}".replace("-", "−"),
                )
            )
        return (("rod", "set 1", "set 2", "set 3", "residual"), *rows)


def elastic_copy(model: Model) -> Model:
    """The same structure without yielding, undisplaced and at rest, at the beginning of time."""
    copy = parse(document(model))
    copy.settings.plasticity = False
    for name in ("particles", "rods", "clock"):
        table = copy.tables[name]
        for field in table.fields_in(Role.STATE):
            if field is not Rod.plastic_strain:
                copy.writable(f"{name}.{field.name}")[...] = field.allocate(len(table))
    return copy


def exact_forces(model: Model, unknowns: Sequence[Unknown]) -> list[float] | None:
    """The unknowns' forces (kN) by exact geometry, without yielding; None if there is no equilibrium."""
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
    """No load, no acceleration, no lack of fit: only what is added acts."""
    model.delete(list(model.loads))
    model.environment.force = model.environment.acceleration = (0.0, 0.0)
    particles = list(model.particles)
    model.assign(particles, "acceleration", [(0.0, 0.0)] * len(particles))
    rods = list(model.rods)
    model.assign(rods, "prescribed_rest_length", model.rods.original_length.tolist())


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


def _mm(metres: float) -> str:
    return f"{1000.0 * metres:.4g}".replace("-", "−")


def millimetres(metres: float) -> str:
    """A displacement in mm, signed."""
    return f"{_mm(metres)} mm"


def _signed(number: float) -> str:
    """Two decimals, with a real minus sign and no negative zero."""
    return f"{round(float(number), 2) + 0.0:.2f}".replace("-", "−")
