"""Statics of a document: the equilibrium from its undeformed beginning, found anew when it is read after an edit.

In a window it gets a part of each frame: what takes longer (yielding, exact geometry, thousands of rods, the comparison of
theories) comes frames later, and the last solution is pale until then. Scripts, pictures and recordings wait, for the same
bits. It lies beside the model, whose state it does not touch. While a model shows it (`World.show`), all columns of forces,
displacements and reactions are its own, so that pictures, panels, tables and scripts read it by no way of their own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import Column, Role
from pinjoint.components.language import joined, marked, plural, tr
from pinjoint.components.latest import Latest
from pinjoint.components.model import Model
from pinjoint.components.rod import can_collapse, nodes
from pinjoint.components.theory import EXACT, FIRST_ORDER
from pinjoint.components.view import Shape
from pinjoint.components.world import Shown
from pinjoint.documents.shapes import REST, last_motion
from pinjoint.systems.statics.behind import Behind

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.statics.envelope import Envelope
    from pinjoint.systems.statics.limit_analysis import LimitLoad
    from pinjoint.systems.statics.second_order import SecondOrder
    from pinjoint.systems.statics.settle import Settlement

# Kinds of events beyond the elastic range.
PLASTIC = frozenset(("yield", "hinge", "buckling", "plastic mechanism", "collapse"))
SAID = {FIRST_ORDER: marked("equilibrium, first order"), EXACT: marked("equilibrium, exact")}
_MOST_COMPARED = 300  # rods, up to which both theories take a moment only
# Of a frame of a window, for solving: at least and at most (s), and the share of the last one.
PART, _MOST, _SHARE = 0.03, 0.25, 0.5
SMALL = 200  # rods, up to which first order is found within the frame


class Statics:
    """The static solution of a model: a function of its document, by the theory and load steps of its settings.

    permanent: plastic strain and rotations of its undeformed beginning, (rods, 3). settlement: the way through the load
    steps; None where none can be computed, which `problem` explains. motion: into which its last state passes, where that
    is no equilibrium. revision: at which it was found. offered: that of which a person was told that it would not move.
    """

    def __init__(self, model: Model, permanent: Callable[[], Column]) -> None:
        self._model, self._permanent = model, permanent
        self._of: tuple[object, ...] = ()
        self._sought: tuple[object, ...] = ()  # what it follows from that was sought last
        self._solving: Behind[Settlement] | None = None
        self._comparing = Latest[Behind["Settlement"]]()  # by revision
        self._way: tuple[int, Behind[Settlement]] | None = None  # the same, of states on the way
        self._seen = -1  # the revision of the model up to which it is known that nothing changed
        self._columns: Mapping[str, Column] = {}
        self._settlement: Settlement | None = None
        self.problem = ""
        self.motion: Shape | None = None
        self.revision, self.offered = 0, -1
        # The revision of which the theories were compared, what came of it, the other one's way, the critical load factor.
        self._compared: tuple[int, SecondOrder | None, Settlement | None, float] = -1, None, None, np.inf
        self._limit = Latest["LimitLoad"]()  # by revision
        self._rest = -1, 0.0  # the revision that was asked for last, and since when (s)
        self.part = math.inf  # s of a frame, for solving

    @property
    def settlement(self) -> Settlement | None:
        """The way through the load steps, up to date; None where `problem` says why there is none."""
        self.solve()
        return self._settlement

    @property
    def columns(self) -> Mapping[str, Column]:
        """What columns of the model show, by "table.field", up to date."""
        self.solve()
        return self._columns

    @property
    def first_order(self) -> bool:
        """True by first-order theory."""
        return self._model.settings.theory == FIRST_ORDER

    @property
    def share(self) -> float:
        """The load factor of what is shown."""
        settlement = self.settlement
        return settlement.final.load_factor if settlement is not None else 1.0

    @property
    def balanced(self) -> bool:
        """True if what is shown is an equilibrium under the last load step."""
        settlement = self.settlement
        return settlement is not None and settlement.final.balanced and not self.is_late

    @property
    def is_late(self) -> bool:
        """True if what is shown, if anything, is the solution of what was there before an edit."""
        return self._of != self._sought

    @property
    def said(self) -> str:
        """The state of what is shown in a few words, in English."""
        settlement = self.settlement
        if self.is_late:
            return marked("not solved yet")
        if settlement is None:
            return marked("no solution")
        if self.first_order and not self._model.rods.count:
            return marked("no rods yet")
        return SAID[self._model.settings.theory] if settlement.status == "equilibrium" else settlement.status

    @property
    def message(self) -> str:
        """What there is to say about it: why there is no solution, what happened on the way, what is left out."""
        settlement = self.settlement
        if self._solving is not None and self._solving.seconds > REST:
            return tr("Solving for {seconds:.1f} s so far. Esc gives up.", seconds=self._solving.seconds)
        if settlement is None or self.is_late:
            return self.problem
        told = "" if settlement.status == "equilibrium" and not settlement.events else settlement.account
        return joined([told, *self._left_out()])

    def _left_out(self) -> list[str]:
        model = self._model
        moving = bool(model.particles.count and model.tables["particles"].storage("velocity").any())
        loose = np.flatnonzero(~nodes(model) & self.first_order)
        said = [tr("Statics leaves out velocities.")] if moving and model.rods.count else []
        if len(loose) and model.rods.count:
            told = plural(
                "Statics leaves out {name}, which has no rods.",
                "Statics leaves out {count} particles without rods.",
                len(loose),
                name=model.particles.names[loose[0]],
            )
            said.append(told)
        return said

    # --- finding -------------------------------------------------------------------------------------

    def solve(self) -> None:
        """Solve anew if the document changed; asked hundreds of times a picture."""
        model = self._model
        if self._seen == model.revision:
            return
        wanted = self._wanted()
        if wanted != self._sought:
            self.give_up()
            if self._sought[1:2] != wanted[1:2]:  # other rows
                self._settlement, self._columns, self.motion, self.problem = None, {}, None, ""
            self._sought = wanted
            self._solving = Behind(self._settled)
            self.go_on()
        self._seen = model.revision

    def share_frames(self, elapsed: float) -> None:
        """Let a window that has taken so long since its last frame (s) go on while something is solved."""
        self.part = min(max(PART, _SHARE * elapsed), _MOST)
        self.go_on()

    def go_on(self, *, to_the_end: bool = False) -> None:
        """Let what is being solved have its part of a frame; without a window, or to the end, all that it needs."""
        solving, model = self._solving, self._model
        if solving is None:
            return
        small = self.first_order and model.rods.count <= SMALL
        with model.own_state():
            if solving.part(math.inf if small or to_the_end else self.part):
                self._solving, self._of = None, self._sought
                self._take(solving)
        if self._solving is None:
            self.revision = model.next_revision()

    def give_up(self) -> bool:
        """Solve no more what is there now; False if it is solved."""
        solving, self._solving = self._solving, None
        if solving is not None:
            solving.give_up()
        return solving is not None

    def _wanted(self) -> tuple[object, ...]:
        """The revisions of all that a solution follows from; the second of them, that of the rows of tables."""
        model = self._model
        settings, particles = model.tables["settings"], model.tables["particles"]
        return (
            model.newest(Role.DOCUMENT),
            model.structure,
            *(settings.version(name) for name in ("theory", "load_steps")),
            *(particles.version(name) for name in ("displacement", "rotation")),  # settled supports
        )

    def settled(
        self,
        theory: str | None = None,
        load_factors: Sequence[float] | float | None = None,
        acting: Model | None = None,
    ) -> Settlement:
        """The way through load factors by a theory; None: those of the settings. Raises ValueError.

        acting: a copy of the model, in which another combination acts.
        """
        with self._model.own_state():
            return self._settled(theory, load_factors, acting)

    def _settled(
        self, theory: str | None = None, factors: Any = None, acting: Model | None = None
    ) -> Settlement:
        from pinjoint.systems.statics.settle import settle
        from pinjoint.systems.statics.state import Start

        model, settings = acting or self._model, self._model.settings
        factors = settings.load_steps if factors is None else factors
        return settle(model, factors, theory or settings.theory, Start.undeformed(model, self._permanent()))

    def envelope(
        self, names: Sequence[str] = (), theory: str | None = None, path: Sequence[str] = ()
    ) -> Envelope:
        """Bounds of what these combinations do, all there are if none is named, by a theory; or of what a force does that
        moves along a path of rods. Raises ValueError.
        """
        from pinjoint.systems.statics.envelope import Envelope

        model, settings = self._model, self._model.settings
        with model.own_state():
            by, permanent = theory or settings.theory, self._permanent()
            return Envelope.of(model, names, by, settings.load_steps, permanent, path)

    def second_order(self, elapsed: float | None = None) -> str:
        """By how much, and where, the theories differ, where that is worth a word; "" of a large structure.

        elapsed: s since it was asked for last, in a window, where nothing is said until the hand has rested, since it takes
        another solution; None: at once.
        """
        settlement = self.settlement
        if elapsed is not None:
            self._rest = self.revision, self._rest[1] + elapsed if self._rest[0] == self.revision else 0.0
        if self.is_late or settlement is None or not settlement.final.balanced:
            return ""
        if not 0 < self._model.rods.count <= _MOST_COMPARED:
            return ""
        if elapsed is not None and self._rest[1] < REST:
            return ""
        if self._compared[0] != self.revision:
            from pinjoint.systems.statics.second_order import SecondOrder

            theory = EXACT if self.first_order else FIRST_ORDER
            behind = self._comparing.get(self.revision, lambda: Behind(partial(self._settled, theory)))
            with self._model.own_state():
                if not behind.part(math.inf if elapsed is None else self.part):
                    return ""
            other = behind.result()
            both = (settlement, other) if self.first_order else (other, settlement)
            rests = other.final.balanced
            found = SecondOrder.of(self._model, *(one.final for one in both)) if rests else None
            differ = self.first_order and (found is not None or not rests)
            self._compared = self.revision, found, other, self._critical(other) if differ else np.inf
        _, difference, compared, critical = self._compared
        said = difference.said if difference is not None else ""
        if compared is not None and not compared.final.balanced and self.first_order:
            said = tr("exact: {status}", status=tr(compared.status))
        beyond = tr("above the critical load factor {factor}", factor=written.number(critical))
        return beyond if critical < self.share else said

    @property
    def limit_load(self) -> LimitLoad | None:
        """The collapse load by limit analysis, up to date; None where nothing limits it, and of large structures."""
        from pinjoint.systems.statics.limit_analysis import LimitLoad

        model = self._model
        if not 0 < model.rods.count <= _MOST_COMPARED or not can_collapse(model):
            return None

        def find() -> LimitLoad:
            with model.own_state():
                return LimitLoad.of(model)

        return self._limit.get(self.revision, find)

    def collapse(self, elapsed: float | None = None) -> tuple[str, bool]:
        """What limit analysis says beside load steps that went beyond the elastic range, "" if they did not; and whether
        members have to be divided for both to agree. elapsed: not None: once the hand has rested.
        """
        settlement = self.settlement
        if self.is_late or settlement is None or (elapsed is not None and self._rest[1] < REST):
            return "", False
        limit = self.limit_load
        passed = limit is not None and limit.factor < max(self._model.settings.load_steps)
        if limit is None or not (passed or not PLASTIC.isdisjoint(event.kind for event in settlement.events)):
            return "", False
        divides = limit.divides(self._model) if passed else ""
        return joined([limit.message, divides]), bool(divides)

    def _critical(self, exact: Settlement) -> float:
        """The load factor at which the structure buckles, by linear buckling or on its way in exact geometry."""
        from pinjoint.systems.statics.buckling import Buckling
        from pinjoint.systems.statics.events import NoEquilibrium

        model, jumps = self._model, ("snap-through", "bifurcation")
        factors = [event.load_factor for event in exact.events if event.kind in jumps]
        with suppress(NoEquilibrium, ValueError), model.own_state():
            factors += Buckling.of(model, 1).factors.tolist()
        return min(factors, default=np.inf)

    def _take(self, solved: Behind[Settlement]) -> None:
        try:
            self._settlement, self.problem = solved.result(), ""
        except ValueError as error:
            self._settlement, self.problem, self.motion = None, str(error), None
            self._columns = {}
            return
        self._columns = self._settlement.final.shown
        self.motion = last_motion(self._model, self._settlement)

    def on_the_way(self, parts: int) -> Iterator[float] | None:
        """Let the model show the states on the way through the load steps, each in so many parts; yields load factors.

        None while they are being solved, in the part of a frame that a window has for that.
        """
        model, steps = self._model, (0.0, *self._model.settings.load_steps)
        shares = np.arange(1, parts + 1) / parts
        factors = [0.0, *(a + share * (b - a) for a, b in pairwise(steps) for share in shares)]
        if self._way is None or self._way[0] != self.revision:
            if self._way is not None:
                self._way[1].give_up()
            self._way = self.revision, Behind(partial(self._settled, None, factors))
        with model.own_state():
            if not self._way[1].part(self.part):
                return None
        (_, solved), self._way = self._way, None
        return self._shown_in_turn(solved.result())

    def _shown_in_turn(self, settlement: Settlement) -> Iterator[float]:
        model = self._model
        outer = model.solution
        try:
            for state in settlement.states:
                if state.balanced:
                    model.show(Shown(state.shown, model.next_revision(), self.first_order, state.load_factor))
                    yield state.load_factor
        finally:
            model.show(outer)
