"""Headless: a context in which scripts and commands let time pass, without scenes or a picture; the base of Session."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from pinjoint.components.cases import choose
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.load import Load, SpanLoad
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import PAUSE, Environment
from pinjoint.components.table import Table
from pinjoint.components.theory import EXACT, FIRST_ORDER
from pinjoint.components.view import View
from pinjoint.components.wording import missing, quoted
from pinjoint.components.world import esper_kept
from pinjoint.documents import models
from pinjoint.documents.open_documents import ModelFile, Source, file_of
from pinjoint.editor.context import Context, Scene
from pinjoint.editor.frame import HeadlessFrame
from pinjoint.mods import load_all
from pinjoint.mods.mod import heeding_mods
from pinjoint.systems.base import DEFAULT_LIMIT, EVENT_INTERVAL, Phase, StopReason, System
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.edit.pull import Pull
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.statics.buckling import Buckling
    from pinjoint.systems.statics.displacement_method import Solution as DisplacementSolution
    from pinjoint.systems.statics.envelope import Envelope
    from pinjoint.systems.statics.force_method import Solution as ForceSolution
    from pinjoint.systems.statics.path import Curve
    from pinjoint.systems.statics.settle import Settlement


class Still(Scene):
    """The only scene where nobody looks."""

    name = "pause"


class Headless(Context):
    """The open documents of a script or a command.

    scenes, seen: the modes of a program that is seen, and its further systems, which come before ours.
    """

    def __init__(
        self,
        model: Model,
        systems: Iterable[System] = (),
        view: View | None = None,
        file: ModelFile = ModelFile(),  # noqa: B008 (it cannot be changed)
        scenes: Sequence[Scene] = (Still(),),
        seen: Iterable[System] = (),
    ) -> None:
        pull = Pull()
        wanted = {scene.name: scene.systems for scene in scenes}
        schedule = Schedule([*seen, *all_systems(pull), *systems], wanted)
        super().__init__(model, schedule, pull, scenes, view or View(), file)

    @classmethod
    def open(cls, source: Source, systems: Iterable[System] = (), mods: Iterable[str | Path] = ()) -> Self:
        """Open a model file, a bundled model by name, or a document. Raises ModelError.

        systems: further ones for this session. mods: folders of mods to load first, for the whole program;
        raises ModError if one of them cannot be used. The esper world that was current is so again.
        """
        if folders := list(mods):
            load_all(folders)
        with esper_kept():
            return cls(models.load(source), systems, file=file_of(source))

    # --- the model ---------------------------------------------------------------------------------

    @property
    def particles(self) -> Table[Particle]:
        """Particles by name."""
        return self.model.particles

    @property
    def rods(self) -> Table[Rod]:
        """Rods by name."""
        return self.model.rods

    @property
    def loads(self) -> Table[Load]:
        """Loads by name."""
        return self.model.loads

    @property
    def span_loads(self) -> Table[SpanLoad]:
        """Loads between the ends of rods by name."""
        return self.model.span_loads

    def table(self, name: str) -> Table[Any]:
        """The elements of any kind by name, those that mods add included: session.table("walls")["floor"]."""
        if name not in self.model.tables:
            raise KeyError(missing(marked("tables"), name, self.model.tables))
        return self.model.tables[name]

    @property
    def environment(self) -> Environment:
        """Force, acceleration and drag on all particles."""
        return self.model.environment

    @property
    def message(self) -> str:
        """What the window says now; "" if nothing.

        The fault of a mod, the question or refusal of the scene, why the run stopped, a warning or a notice, then the
        remarks on a run at rest.
        """
        said = (
            EXTENSIONS.last_fault(self.faults_seen)
            or self.scenes.active.message
            or self.simulation.said
            or self.notice
        )
        return joined([said, *(remark.message for remark in self.document.assessment.remarks)])

    # --- time --------------------------------------------------------------------------------------

    def run(
        self,
        until: str | None = None,
        *,
        time: float | None = None,
        steps: int | None = None,
        limit: float = DEFAULT_LIMIT,
    ) -> str:
        """Let time pass: until "rest" (at most `limit` s of simulated time), by `time` s, or by `steps`.

        Exactly so many steps are taken unless the run ends; the part of one up to an impact counts as a step.

        Returns "at rest", "time reached", "limit reached" or "diverged"; `message` says more. Raises ValueError, and
        ModError if a mod fails meanwhile: the run stops where it did, and a further one goes on without the mod. An
        interrupt (Ctrl+C) leaves the state after a step shortly before, from which a further run goes on.
        """
        if sum(option is not None for option in (until, time, steps)) != 1 or until not in (None, "rest"):
            raise WrongValue('Say how far to run: until="rest", time=SECONDS or steps=NUMBER, one of them.')
        limit = forward("limit", limit)
        time = None if time is None else forward("time", time)
        steps = None if steps is None else int(forward("steps", steps, whole=True))
        reached = "time reached" if until is None else "limit reached"
        with self.running() as simulation:
            if until is not None:
                simulation.run_until_rest(self.time + limit)
            elif time is not None:
                simulation.run_to(self.time + time)
            elif steps is not None:
                simulation.advance(steps)
        ended = {StopReason.REST: "at rest", StopReason.DIVERGED: "diverged"}
        return ended.get(simulation.reason, reached)

    @contextmanager
    def running(self) -> Iterator[Simulation]:
        """Let time pass by the simulation inside: that is one run in the log, which stops, by ModError, where a mod fails.

        Meanwhile systems of phase EVENTS run every EVENT_INTERVAL steps.
        """
        if self.model.solution is not None:  # whose columns show no run
            self.scenes.request(PAUSE)
            self.scenes.apply(self)
        self._act_in_scene()
        document, simulation = self.document, self.simulation
        document.note_beginning()
        document.history.begin_run()
        document.timeline.begin()
        try:
            with heeding_mods(simulation), self._without_frames(), simulation.watched():
                yield simulation
                document.chronicle.look()
        finally:
            if not self.scenes.time_passes:
                document.history.end_run()

    @contextmanager
    def _without_frames(self) -> Iterator[None]:
        """While time passes inside, systems of phase EVENTS run every EVENT_INTERVAL steps, and when it has passed."""
        simulation, frame = self.simulation, HeadlessFrame(self, 0.0)
        if self.footer is not None or not self.schedule.runs_headless(Phase.EVENTS, frame.scene, self.model):
            yield
            return

        def follow() -> int:
            beyond = self.model.clock.steps % EVENT_INTERVAL
            if beyond == 0:
                self.schedule.run(Phase.EVENTS, frame, headless=True)
            return EVENT_INTERVAL - beyond

        simulation.before_steps.append(follow)
        try:
            yield
        finally:
            simulation.before_steps.remove(follow)
        self.schedule.run(Phase.EVENTS, frame, headless=True)

    def load_path(
        self,
        factor: float = 1.0,
        *,
        until: str | None = None,
        points: int = 500,
        branch: int = 0,
        theory: str = EXACT,
    ) -> Curve:
        """The load–displacement curve, through limit points, up to a load factor, or "B.y=-2.5" or "B.rotation=1".

        theory: "exact", or "first-order" with straight lines between yields, up to the collapse load.
        branch: number of the bifurcation from which on it follows the other branch, along the mode; negative: against it.

        Changes nothing. Its arrays are load_factor (k,), displacement (k, particles, 2) in m, rotation (k, particles) in
        rad, axial_force (k, rods) in kN, bending_moment (k, rods, 2) in kN·m and stable (k,); its events are limit points
        and bifurcations; complete: False if it could not be followed so far. Raises ValueError.
        """
        from pinjoint.systems.statics.path import Curve, Goal

        goal = Goal.of(self.model, factor, until)
        return Curve.of(self.model, goal, points=points, branch=branch, theory=theory)

    def statics(
        self,
        theory: str | None = None,
        load_factors: Sequence[float] | float | None = None,
        *,
        case: str | None = None,
        combination: str | None = None,
    ) -> Settlement:
        """The equilibria at load factors from the undeformed beginning, by "first-order" or "exact" theory.

        None: as the settings of the model say. case: of which loads act alone. combination: of those of the settings; "":
        all cases act once. Changes nothing. Each of its `states`, of which `final` is the last, has
        load_factor, status and columns, in order of rows, as `columns["rods.bending_moment"]`: displacement, reaction
        (particles, 2), rotation, reaction_moment (particles,), axial_force, strain, plastic_strain, yielding (rods,), and
        in `diagrams` shear, bending_moment, end_axial_force, end_rotation (rods, 2) and largest_moment, with its place; m,
        rad, kN, kN·m. Its `events` are yields, cables that slacken, collapses with their motion; status and message are
        those of the end. Raises ValueError.

        >>> from pinjoint import Session
        >>> s = Session.open("three_bar_plastic")
        >>> s.statics(load_factors=[1.0, 0.0]).final.axial_force.round(2).tolist()
        [28.7, -40.59, 28.7]
        """
        acting = None
        if case is not None or combination is not None:
            acting = self.model.undeformed_copy()
            choose(acting, case, combination)
        return self.document.statics.settled(theory, load_factors, acting)

    def envelope(self, *combinations: str, theory: str | None = None, path: Sequence[str] = ()) -> Envelope:
        """The least and the most of N, V, M, reactions and displacements in some combinations of load cases, and in which.

        None named: in all of settings.combinations; theory None: as the settings say. Changes nothing. At the stations
        shares["M"] (rods, s) along rods, forces["M"].values (2, rods, s) are the least and the most, in kN, kN·m, and
        .governing the number of the combination in `combinations`, −1 where all are alike; so are reaction and displacement
        (2, particles, 3), with moments and rotations. extremes("M", row): both of a rod, with distance and combination.
        without: combinations without equilibrium, and why. path: names of rods, along which settings.moving_force moves
        instead; combinations are then where it stands. Raises ValueError, NoEquilibrium where none has one.
        """
        return self.document.statics.envelope(combinations, theory, path)

    def force_method(self, *released: str) -> ForceSolution:
        """The static unknowns of these names, such as "AC", "A.y" or "AB.start", by the force method; changes nothing.

        Without names as many as needed. Its arrays are gap, flexibility and force, in m, rad, kN, kN·m; superposed is the
        sum of its states base and units. Raises MethodError, a ValueError.
        """
        from pinjoint.systems.statics.force_method import solve
        from pinjoint.systems.statics.unknowns import Unknown, redundants

        unknowns = [Unknown.named(self.model, name) for name in released]
        return solve(self.model, unknowns or redundants(self.model))

    def displacement_method(self) -> DisplacementSolution:
        """The displacements of joints by the displacement method, K Δ = F; changes nothing.

        Its unknowns have names; its arrays are stiffness, load, displacement and members, k of every rod over the directions
        of its ends, in m, rad, kN, kN·m; superposed is the sum of its states base and units. Raises MethodError.

        >>> from pinjoint import Session
        >>> found = Session.open("hyperstatic").displacement_method()
        >>> [unknown.name for unknown in found.unknowns], found.stiffness.shape
        (['A.x', 'B.x', 'B.y', 'C.x', 'C.y'], (5, 5))
        """
        from pinjoint.systems.statics.displacement_method import solve

        return solve(self.model)

    def buckling(self, modes: int = 5, theory: str = FIRST_ORDER) -> Buckling:
        """Critical load factors by linear buckling, ascending, with their modes; changes nothing.

        theory: "exact" tells them from the exact equilibrium under the last load factor of the settings.

        Its arrays are factors (k,), modes (k, particles, 2), where members bend with rotations (k, particles, 3), and
        effective_length (rods,) in m, NaN of rods that are not compressed; message: why there is none. Raises
        ValueError, and NoEquilibrium without a state that could lose its stability.
        """
        from pinjoint.systems.statics.buckling import Buckling

        about = None if theory == FIRST_ORDER else self.document.statics.settled(theory).equilibrium
        return Buckling.of(self.model, modes, about)


def forward(name: str, value: float, *, whole: bool = False) -> float:
    """A time or a number of steps given by a script, checked. Raises ValueError."""
    number = isinstance(value, int | np.integer | (np.integer if whole else float | np.floating))
    if not number or isinstance(value, bool) or not math.isfinite(value):
        given = quoted(value)
        raise ValueError(
            tr("{name} is {value}; it must be a whole number.", name=name, value=given)
            if whole
            else tr("{name} is {value}; it must be a finite number.", name=name, value=given)
        )
    if whole and value >= 2**63:
        raise WrongValue("{name} is {value}; it must be below 2^63.", name=name, value=value)
    if value < 0:
        raise WrongValue(
            "{name} is {value}; time only runs forward: undo or restart goes back.", name=name, value=value
        )
    return float(value)
