"""Programs: the step programs, or exact flight, of one model, one for each plan; that of the present plan is bound."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import is_sprung
from pinjoint.components.settings import AUTOMATIC
from pinjoint.systems.base import Integrator, Law, Phase, StepSystem
from pinjoint.systems.collision.free.discs import Discs
from pinjoint.systems.collision.free.flight import Flight
from pinjoint.systems.collision.impacts import Impacts
from pinjoint.systems.collision.system import FreeFlight
from pinjoint.systems.physics.automatic import choose
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.binding import ProgramError
from pinjoint.systems.program.faults import blame_mod
from pinjoint.systems.program.program import Program
from pinjoint.systems.program.reordered import make_program
from pinjoint.systems.program.writer import kind_of
from pinjoint.systems.schedule import Plan, Schedule

_FREE_FLIGHT = FreeFlight()

Dynamics = Program | Flight  # what moves a model: forces and energies by the systems of its plan


class Programs:
    """What moves one model, made once for each plan; that of the present plan is bound to the model.

    scene: the scene whose systems act in the run. bindings: how often a plan was bound. compile_seconds: spent in writing
    programs, and compiling them, or loading them from the cache, if that was done at once.
    """

    def __init__(self, model: Model, schedule: Schedule, impacts: Impacts, scene: str) -> None:
        self.scene = scene
        self._model = model
        self._schedule = schedule
        self._impacts = impacts
        self.bindings = 0
        self.compile_seconds = 0.0
        self._made: dict[tuple[str, ...], Dynamics] = {}
        self._plan: list[StepSystem] | None = None
        self._integrator: Integrator | None = None
        self._bound: Dynamics | None = None
        self._before: Integrator | None = None  # chosen before the document changed
        self._observer: Dynamics | None = None

    @property
    def plan(self) -> list[StepSystem]:
        """The step systems, integrators apart, that act in the scene and that the model needs, in order."""
        if self._plan is None:
            self._plan = self._schedule.step_plan(self.scene, self._model)
        return self._plan

    @property
    def collides(self) -> bool:
        """True if particles may meet."""
        return any(system.impulsive for system in self.plan)

    def planned(self) -> Plan:
        """All systems that run in the scene with the model, the integrator among them, and why the others do not."""
        found = self._schedule.plan(self.scene, self._model)
        phases, left_out = dict(found.phases), dict(found.left_out)
        for integrator in (*INTEGRATORS.values(), _FREE_FLIGHT):
            if not self._schedule.is_active(integrator, self.scene):
                left_out[integrator.name] = self._schedule.inactive(integrator, self.scene)
            elif integrator is self.integrator:
                phases[Phase.STEP] = (*phases[Phase.STEP], integrator)
            else:
                left_out[integrator.name] = f"{self.integrator.name} integrates"
        return Plan(self.scene, phases, left_out)

    @contextmanager
    def in_scene(self, scene: str) -> Iterator[None]:
        """Questions inside the `with` are answered as if the systems of this scene acted."""
        before = self._plan, self._integrator, self.scene
        self._plan, self._integrator, self.scene = None, None, scene
        try:
            yield
        finally:
            self._plan, self._integrator, self.scene = before

    def differ_in(self, scene: str) -> bool:
        """True if other systems, or another integrator, act in this scene."""
        if scene == self.scene:
            return False
        here = self.plan, self._chosen
        with self.in_scene(scene):
            return (self.plan, self._chosen) != here

    @property
    def integrator(self) -> Integrator:
        """Exact flight if every system of the plan leaves it exact, else the integrator."""
        if self._integrator is None:
            self._integrator = _FREE_FLIGHT if self._is_exact else self._chosen
        return self._integrator

    @property
    def _is_exact(self) -> bool:
        """True if particles fly exactly."""
        free = self.collides and not is_sprung(self._model)
        return free and all(system.leaves_flight_exact(self._model) for system in self.plan)

    @property
    def _chosen(self) -> Integrator:
        """The integrator that the settings name; the automatic choice if they name none, or one that does not act here."""
        name = self._model.settings.integrator
        return INTEGRATORS[choose(self._model) if name == AUTOMATIC or self._refused else name]

    @property
    def _refused(self) -> str:
        """Why the integrator that the settings name does not act here; "" if it does, or if they name none."""
        name = self._model.settings.integrator
        if name == AUTOMATIC:
            return ""
        named = INTEGRATORS.get(name)
        if named is None:
            return tr("its mod is not loaded")
        if named.mod is not None and named.mod.off:
            return tr("its mod is switched off")
        return "" if self._schedule.is_active(named, self.scene) else self._schedule.inactive(named, self.scene)

    @property
    def note(self) -> str:
        """What a person should know of the choice of the integrator; "" if it is the one that the settings name."""
        refused = self._refused
        if not refused or self.integrator.exact:
            return ""
        return tr(
            "The integrator {chosen} cannot act ({reason}); {other} acts instead.",
            chosen=self._model.settings.integrator,
            other=self.integrator.key,
            reason=refused,
        )

    @property
    def ready(self) -> bool:
        """False if the next step or observation needs a program that is not loaded yet."""
        return self._bound is not None or self._key in self._made

    # --- the one that is bound -----------------------------------------------------------------------

    @property
    def dynamics(self) -> Dynamics:
        """The program or flight that moves the model, bound to it as it is now."""
        return self._bound or self.bind()

    @property
    def observer(self) -> Dynamics:
        """What is bound; until time is to pass, a program of another integrator will do, since all observe alike.

        To choose one takes all modes of a small model: half of each frame in which a hand drags in pause.
        """
        if self._bound is None and self._observer is None and self._before is not None and not self._is_exact:
            self._observer = self._made.get(kind_of(self._model, self._before, self.plan))
            if self._observer is not None:
                self._observer.bind()
        return self._bound or self._observer or self.bind()

    @property
    def compiled(self) -> Program:
        """The compiled program that moves the model; exact flight has none."""
        program = self.dynamics
        assert isinstance(program, Program)
        return program

    @property
    def flying(self) -> Discs | None:
        """The discs of exact flight in the midst of a step, if there are any; binds nothing."""
        return self._bound.flying if isinstance(self._bound, Flight) else None

    def bind(self) -> Dynamics:
        """Bind what moves the model to its columns. A mod whose system cannot join the program is switched off."""
        while self._bound is None:
            try:
                self._bound = self._of_plan()
                self.bindings += 1
            except ProgramError as error:
                if not blame_mod(error) and not self.blame_by_leaving_out(self._makes_program, str(error)):
                    raise
                self.void()  # the integrator may be that mod's
        return self._bound

    def blame_by_leaving_out(self, works: Callable[[], bool], problem: str) -> bool:
        """Leave out the mods of the plan one after the other, and switch off the one without which something works.

        What comes with the program is not to blame where numbers of a model are beyond computing.

        problem: a sentence that says what does not. False if it does not even work without all of them.
        """
        brought = dict.fromkeys(system.mod for system in (*self.plan, self.integrator))
        mods = [mod for mod in brought if mod is not None and not mod.included]
        culprit = None
        try:
            with ExitStack() as aside:
                for mod in mods:
                    aside.enter_context(mod.aside())
                    self.void()
                    if works():
                        culprit = mod
                        break
        finally:
            self.void()
        if culprit is None:
            return False
        names = [system.name for system in (*self.plan, self.integrator) if system.mod is culprit]
        told = tr("Without {systems} the steps lead on.", systems=", ".join(names))
        self.void()
        culprit.switch_off(joined([problem, told]))
        return True

    def _makes_program(self) -> bool:
        try:
            self._of_plan()
        except ProgramError:
            return False
        return True

    def unbind(self) -> None:
        """Release what is bound, since the plan may have changed."""
        self._plan = self._bound = self._observer = None

    def void(self) -> None:
        """Release what is bound and the chosen integrator, since the document changed."""
        self._before = self._integrator or self._before
        self._plan = self._integrator = self._bound = self._observer = None

    def _of_plan(self) -> Dynamics:
        """What moves the model by the present plan, bound to it. Raises ProgramError."""
        key = self._key
        if key in self._made:
            self._made[key].bind()
        else:
            started = time.perf_counter()
            self._made[key] = self._make()
            self.compile_seconds += time.perf_counter() - started
        return self._made[key]

    def _make(self) -> Dynamics:
        """Raises ProgramError, also for whatever is wrong with the integrator of a mod."""
        integrator = self.integrator
        if integrator.exact:
            return Flight(self._model, self._impacts, [law for law in self.plan if isinstance(law, Law)])
        try:
            return make_program(self._model, self.plan, integrator)
        except ProgramError:
            raise
        except Exception as error:
            if integrator.mod is None:
                raise
            message = tr(
                "The integrator {name} cannot make its step program: {error}.",
                name=integrator.name,
                error=f"{type(error).__name__}: {error}",
            )
            raise ProgramError(message, integrator) from error

    @property
    def _key(self) -> tuple[str, ...]:
        return kind_of(self._model, self.integrator, self.plan)
