"""The guide through a method: three sets of one structure, part by part; that through the force method, in seven."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pinjoint.components.bent import MOMENT, farthest, is_frame
from pinjoint.components.field import LARGEST, SMALLEST, Column, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle, supported
from pinjoint.components.rod import Rod, bends, rigid_joints
from pinjoint.components.round_numbers import round_down
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.table import Table
from pinjoint.components.tags import Selected
from pinjoint.components.view import THESIS, View
from pinjoint.documents.shapes import DRAWN_SHARE
from pinjoint.methods import PARTS
from pinjoint.methods.copies import base_structure, exact_forces, loaded, still
from pinjoint.methods.tables import ForceTables
from pinjoint.systems.edit.arrows import extent
from pinjoint.systems.run.real_time import RealTimeRunner
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.force_method import Solution, solve
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.superposition import SetState, Superposition
from pinjoint.systems.statics.unknowns import MethodError, Unknown

_DIAGRAM_HEIGHT = 34.0  # px of the largest force diagram
_SWING = 3.0  # s in which a mechanism is shown to move there and back


@dataclass
class Set:
    """One of the three systems: its model, its view and its run in real time.

    live: None of a frame, which stays undeformed, its forces drawn at once by first-order theory. suited: the scale that
    shows its own displacements well.
    """

    model: Model
    view: View
    live: RealTimeRunner | None = None
    suited: float = 1.0

    @property
    def simulation(self) -> Simulation | None:
        """The run of the set, if it has one."""
        return self.live.simulation if self.live is not None else None

    @property
    def moves(self) -> bool:
        """True if frames change the set."""
        return self.live is not None and not self.live.simulation.halted

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass."""
        if self.live is not None:
            self.live.frame(elapsed)

    def scale_to(self, state: SetState) -> None:
        """Choose drawing scales for the displacements and forces of a final state."""
        size = extent(self.model) if self.model.rods.count else 0.0
        between = farthest(self.model, np.flatnonzero(self.model.rods.bending_stiffness > 0.0))[0]
        self.suited = scale_to(DRAWN_SHARE * size, max(largest(state.displacement), largest(between)))
        if not is_frame(self.model):
            self.model.settings.diagram_scale = scale_to(_DIAGRAM_HEIGHT, largest(state.axial_force))

    def settle(self) -> None:
        """Skip the rest of the motion: go to its equilibrium, if there is one."""
        final = settle(self.model).final if self.live is not None else None
        if final is not None and final.balanced:
            with self.model.transaction("settle"):
                final.put(self.model)


def scale_to(drawn: float, size: float) -> float:
    """The round scale at which a size is drawn so large, if a model can have that; 1 where it, or the picture, has none."""
    return round_down(min(max(drawn / size, SMALLEST), LARGEST)) if min(drawn, size) > 0.0 else 1.0


class Mechanism:
    """A structure that swings along the motion (n, 2) that nothing resists."""

    moves = True
    simulation = None  # the motion is prescribed

    def __init__(self, model: Model, motion: Column, view: View) -> None:
        self.model, self.view = model, view
        self.model.settings.displacement_scale = 1.0
        self._motion = DRAWN_SHARE * extent(model) * motion
        self._time = 0.0

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass."""
        self._time += elapsed
        swing = math.sin(2.0 * math.pi * self._time / _SWING)
        self.model.writable("particles.displacement")[...] = swing * self._motion[:, :2]
        if self._motion.shape[1] > 2:
            self.model.writable("particles.rotation")[...] = swing * self._motion[:, 2]


class Guide:
    """The present part of a method, and the answers so far.

    part: 1 to `parts`. solution: with all unknowns, once they are known. acting: the number, from 0, of that which acts in
    set 3. sets: those that exist so far. refusal: of what was picked. mechanism: that which a refused release would leave.
    quantity: of which frames show diagrams. Raises MethodError at the start if the structure cannot carry its load.
    """

    parts = PARTS
    whole = False  # tables are not parted into blocks side by side
    one_scale = False  # a slider scales the displacements of all sets

    def __init__(self, model: Model, schedule: Schedule, view: View) -> None:
        self.model, self._schedule, self._view = model, schedule, view
        self.part, self.acting = 1, 0
        self.solution: Superposition | None = None
        self.refusal = ""
        self.mechanism: Mechanism | None = None
        self.quantity = MOMENT
        self.count = Count.of(model)
        self.sets: list[Set] = []

    @property
    def shown_now(self) -> tuple[object, ...]:
        """What the equations and the table depend on."""
        return (self.part, self.acting, self.quantity)

    @property
    def is_frame(self) -> bool:
        """True if members bend, so that the sets stay still."""
        return bends(self.model)

    def next_quantity(self) -> None:
        """Show diagrams of M, V or N in all sets of a frame."""
        self.quantity = DIAGRAMS[(DIAGRAMS.index(self.quantity) + 1) % len(DIAGRAMS)]
        for one in self.sets:
            one.view.quantity = self.quantity

    @property
    def running(self) -> list[Set]:
        """The sets that move in this part."""
        return []

    @property
    def shown(self) -> list[Set | Mechanism]:
        """The structures in the picture, from left to right."""
        return [*self.sets, self.mechanism] if self.mechanism is not None else [*self.sets]

    @property
    def moving(self) -> list[Set | Mechanism]:
        """The structures that frames change."""
        return [one for one in (*self.running, self.mechanism) if one is not None and one.moves]

    def point(self, cell: tuple[int, int] | None) -> None:
        """The pointer is over a cell (row, column) of the table, or over none."""

    def _still(self, copy: Model, state: SetState, *, moved: bool = False) -> Set:
        """A set that shows a state without running."""
        view = view_like(self._view)
        view.all_diagrams, view.quantity = True, self.quantity
        return Set(still(copy, self.model, state, moved=moved), view)


class ForceGuide(Guide):
    """Of the force method, of which parts 5 and 6 are gone through for every unknown.

    released: the static unknowns, the newest last. exact: the unknowns by exact geometry.
    """

    solution: Solution | None

    def __init__(self, model: Model, schedule: Schedule, view: View) -> None:
        super().__init__(model, schedule, view)
        self.axis_wanted: Particle | None = None  # the support of which a direction is to be chosen
        self.one_scale = not self.is_frame
        self.released: list[Unknown] = []
        self._known = 0  # those of a solution before
        self.exact: list[float] | None = None
        self.sets = [self._make_set([], solve(model, []).real)]
        self._scale_alike()

    @property
    def unknown(self) -> Unknown | None:
        """The unknown that acts in set 3, or is to."""
        return self.released[self.acting] if self.released else None

    @property
    def in_thesis(self) -> bool:
        """True if texts follow the thesis' convention, p = (Δ − Δ₀) / Δ₁, not the textbook's."""
        return self._view.convention == THESIS

    @property
    def shown_now(self) -> tuple[object, ...]:
        return (*super().shown_now, self.in_thesis, len(self.released))

    @property
    def tables(self) -> ForceTables:
        """The tables of the solution."""
        assert self.solution is not None
        return ForceTables(self.model, self.solution)

    @property
    def clamp_wanted(self) -> bool:
        """True if the support of which a direction is to be chosen has a moment, too."""
        return self.axis_wanted is not None and self._clamps(self.axis_wanted)

    # --- sets --------------------------------------------------------------------------------------

    def _make_set(self, released: Sequence[Unknown], state: SetState, amounts: Sequence[float] = ()) -> Set:
        """A copy of the structure without some unknowns, under the real load, or under so much of them alone.

        Where members bend it stays still; else it runs towards the state.
        """
        copy = loaded(self.model, released, amounts) if amounts else base_structure(self.model, released)
        known = self.sets[0].model.settings if released else None  # a person may have chosen its scale
        copy.settings.displacement_scale = known.prescribed_displacement_scale if known is not None else None
        if bends(self.model):
            return self._still(copy, state)
        live = RealTimeRunner(Simulation(copy, self._schedule, "force method"))
        made = Set(copy, view_like(self._view), live)
        made.scale_to(state)
        return made

    def _scale_alike(self) -> None:
        """Draw the displacements of all sets to the smallest of their scales: who moves further is softer."""
        scale = min(one.suited for one in self.sets)
        for one in self.sets:
            one.model.writable("settings.automatic_displacement_scale")[0] = scale

    @property
    def running(self) -> list[Set]:
        return {1: self.sets[:1], 3: self.sets[1:2], 5: self.sets[2:3], 7: self.sets[2:3]}.get(self.part, [])

    # --- going on ----------------------------------------------------------------------------------

    def next(self) -> bool:
        """Go on to the next part; False after the last. Part 2 is left by picking all unknowns, or with some of them."""
        self._forget_refusal()
        if self.part == PARTS:
            return False
        for running in self.running:
            running.settle()
        if self.part == 2:
            if len(self.released) > self._known:
                self._release()
            elif self.axis_wanted is None:  # else the direction is still asked for
                self.refusal = tr("First click the rod or the support to release, in set 1.")
            return True
        self.part += 1
        if self.part == PARTS and self.acting < len(self.released) - 1:
            self.acting, self.part = self.acting + 1, 5
        if self.part == 5:
            self._act_alone()
        elif self.part == PARTS:
            self._apply_forces()
        return True

    def back(self) -> None:
        """Go back to the part before; what part 2 released is chosen again."""
        self._forget_refusal()
        self.axis_wanted = None
        if self.part == 2 and self._known:
            return
        self.part = max(self.part - 1, 1)
        if self.part == 4 and self.acting > self._known:
            self.acting, self.part = self.acting - 1, 6
        if self.part == 2:
            del self.released[self._known :]
            self.solution = solve(self.model, self.released) if self.released else None
            self._show_released()
        self.sets = self.sets[: {1: 1, 2: 1, 3: 2, 4: 2}.get(self.part, 3)]
        if self.part == 6:
            self._act_alone()

    def _act_alone(self) -> None:
        """A unit of the acting unknown in set 3 (parts 5 and 6)."""
        alone = [float(number == self.acting) for number in range(len(self.released))]
        self.sets = [*self.sets[:2], self._make_set(self.released, self._times(alone), alone)]
        self._scale_alike()

    @property
    def can_release_another(self) -> bool:
        """True if the primary structure is still hyperstatic and the unknowns so far are solved."""
        return self.part == PARTS and len(self.released) < self.count.degree

    def release_another(self) -> None:
        """Repeat the method for a further unknown, those so far released as well (part 7 → part 2)."""
        if self.part == PARTS:
            self.sets[2].settle()
            self.sets, self.part, self._known = self.sets[:1], 2, len(self.released)

    def pick(self, hit: Handle | None, near: Vector = (0.0, 0.0)) -> None:
        """Take the element that was clicked in set 1 at a point (m) as an unknown (part 2)."""
        self._forget_refusal()
        self.axis_wanted = None
        if isinstance(hit, Rod):
            rod = self.model.rods[hit.name]
            self._take(Unknown(rod, self._end_of(rod, near)))
        if not isinstance(hit, Particle):
            return
        particle = self.model.particles[hit.name]
        held = np.flatnonzero(supported(self.model)[particle.row, :2]).tolist() + [2] * self._clamps(particle)
        if not held:
            self.refusal = tr("{particle} has no support; click a rod or a support.", particle=particle.said)
        elif len(held) == 1:
            self._take(Unknown(particle, held[0]))
        else:
            self.axis_wanted = particle

    def _end_of(self, rod: Rod, near: Vector) -> int | None:
        """The rigid end of a rod that is nearer to a point (m), of which the moment is released; None of a bar."""
        rigid = self.model.rods.turning_shares[rod.row] > 0.0
        if not rigid.any():
            return None
        places = self.model.particles.position[list(rod.between)]
        return int(np.where(rigid, np.hypot(*(places - near).T), np.inf).argmin())

    def _clamps(self, particle: Particle) -> bool:
        """True if a support holds rods against turning."""
        return bool(supported(self.model)[particle.row, 2] and rigid_joints(self.model)[particle.row])

    def pick_axis(self, axis: int) -> None:
        """Choose the direction of a support that holds several: 0: x, 1: y, 2: the moment of a clamp (part 2)."""
        if self.axis_wanted is not None and (axis < 2 or self.clamp_wanted):
            self._take(Unknown(self.axis_wanted, axis))

    def _take(self, unknown: Unknown) -> None:
        wanted = [*self.released, unknown]
        if unknown.name in {known.name for known in self.released}:
            self.refusal = tr("{name} is released already; pick another one.", name=unknown.said)
            return
        try:
            self.solution = solve(self.model, wanted)
        except MethodError as error:
            self.refusal = str(error)
            if error.motion is not None:
                left = base_structure(self.model, wanted)
                self.mechanism = Mechanism(left, error.motion, view_like(self._view))
            return
        self.released, self.axis_wanted = wanted, None
        self._show_released()
        if len(wanted) == self.count.degree:
            self._release()

    def _show_released(self) -> None:
        """Draw the released elements as selected in set 1."""
        first = self.sets[0].model
        tables: dict[str, Table[Any]] = first.tables
        first.tag_only([tables[one.element.table][one.element.name] for one in self.released], Selected)

    def _release(self) -> None:
        """Go on with what was picked (part 2 → part 3)."""
        assert self.solution is not None
        self.exact = exact_forces(self.model, self.released)
        self.sets = [self.sets[0], self._make_set(self.released, self.solution.base)]
        self._scale_alike()
        self.part, self.acting = 3, self._known

    def _forget_refusal(self) -> None:
        self.refusal, self.mechanism = "", None

    def _times(self, amounts: Sequence[float]) -> SetState:
        """The state of the released structure under so much of its unknowns."""
        assert self.solution is not None
        state = SetState.superposed(self.solution.units, amounts)
        for bar in (unknown for unknown in self.released if unknown.of_bar):
            state.axial_force[bar.place] = 0.0  # cut
        return state

    def _apply_forces(self) -> None:
        """The unknowns' values in place of the unit force (part 7)."""
        assert self.solution is not None
        amounts = self.solution.force.tolist()
        third, state = self.sets[2], self._times(amounts)
        if self.is_frame:
            self.sets[2] = self._make_set(self.released, state, amounts)
            return
        force = loaded(self.model, self.released, amounts).particles.force
        third.model.assign(list(third.model.particles), "force", force.tolist())
        third.scale_to(state)
        self._scale_alike()
        scale = min(one.model.settings.diagram_scale for one in self.sets)
        for one in self.sets:  # equal, so that the pictures add up, too
            one.model.settings.diagram_scale = scale


def view_like(view: View) -> View:
    """The view of a set in a window with this view."""
    return View(all_diagrams=view.all_diagrams, legend=False, pixel_ratio=view.pixel_ratio, fitted=True)
