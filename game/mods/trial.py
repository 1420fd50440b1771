"""Trial: a mod does all that it can, with a model that has everything, so that its mistakes show."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pinjoint.checks import EVERYTHING, FRAME, STEPS, run_frames
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import MADE, Field, FieldError
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.load import HISTORIES
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.suggestions import missing
from pinjoint.documents import models
from pinjoint.documents.library import data_apart
from pinjoint.editor.frame import Frame
from pinjoint.editor.scenes import all_scenes
from pinjoint.interrupts import is_persons
from pinjoint.mods.mod import LOG, Mod
from pinjoint.session import Session
from pinjoint.systems.base import Commit, Event, Integrator, Law, StepSystem, System
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.input.actions import ACTIONS, PAUSE, SIMULATION
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.binding import KERNELS, ProgramError, bind
from pinjoint.systems.program.endless import Patience
from pinjoint.systems.program.faults import problem_of
from pinjoint.systems.program.writer import read_sources

SIZES = ((640, 480, 1.0), (160, 120, 2.0))  # pixels, and pixels to a point, of the pictures
SCALES = (1.0, 1e4, 1e-4)  # by which a person may zoom
PATIENCE = 30.0  # s that some steps of the small model may take


def mistakes_of(mod: Mod) -> list[str]:
    """What is wrong with a mod, a sentence each.

    Its kernels are compiled, it is seen, its scenes are entered, its keys pressed, its systems and integrators run.
    What it changes is forgotten; a part that fails does not keep the others from being tried.
    """
    return _Trial(mod).found


class _Trial:
    """found: the mistakes so far, each once."""

    def __init__(self, mod: Mod) -> None:
        self.mod = mod
        self.found: list[str] = []
        heard, known, patience = LOG.disabled, len(EXTENSIONS.faults), Patience.seconds
        LOG.disabled, Patience.seconds = True, PATIENCE
        try:
            with data_apart():
                self._try_all()
        finally:
            LOG.disabled, Patience.seconds = heard, patience
            del EXTENSIONS.faults[known:]

    def _try_all(self) -> None:
        systems = [s for s in (*all_systems(), *INTEGRATORS.values()) if s.mod is self.mod]
        for system in systems:
            with self._part():
                self._read(system)
        self._check_keys()
        if self.found:
            return  # a run would only fail for the same reasons
        with self._part():
            _sample(self.mod)
        for scene in (PAUSE, SIMULATION, *(scene.name for scene in all_scenes() if scene.mod is self.mod)):
            with self._part():
                self._live_in(scene)
        for action, binding in ACTIONS.bound():
            for scene in binding.scenes if action.name.startswith(f"{self.mod.name}.") else ():
                with self._part():
                    self._press(binding.key, scene)
        for integrator in (s.key for s in systems if isinstance(s, Integrator)):
            with self._part():
                self._run(integrator)
        with self._part():
            self._run("velocity_verlet")
        for folder in EXTENSIONS.folders:
            for file in sorted(folder.glob("*.json")) if self._owns(folder) else ():
                with self._part():
                    models.load(file)

    @contextmanager
    def _part(self) -> Iterator[None]:
        """Note what fails inside, and go on as if it had not."""
        try:
            yield
        except BaseException as error:  # of code that is not ours
            if is_persons(error):
                raise
            if not self.mod.off:
                self._note(
                    str(error) if isinstance(error, ProgramError | FieldError) else self.mod.describe(error)
                )
        if self.mod.off:
            self._note(self.mod.problem)
            self.mod.problem = ""

    def _note(self, mistake: str) -> None:
        if mistake not in self.found:
            self.found.append(mistake)

    def _owns(self, folder: Path) -> bool:
        return self.mod.folder is not None and folder.resolve().is_relative_to(self.mod.folder)

    # --- what can be read ------------------------------------------------------------------------------

    def _read(self, system: System) -> None:
        """Compile a system's kernels by themselves, and look for the columns that it names."""
        model = models.load(EVERYTHING)
        for name in (*system.reads, *system.writes, *system.adds):
            table, _, column = name.partition(".")
            if column and (table not in model.tables or column not in model.tables[table].fields):
                known = [f"{t.name}.{f}" for t in model.tables.values() for f in t.fields]
                self._note(joined([f"{system.name}:", missing(marked("columns"), name, known)]))
        if isinstance(system, StepSystem):
            system.leaves_flight_exact(model)
        if isinstance(system, Integrator):
            read_sources([system])
        elif isinstance(system, Law | Commit | Event):
            for kernel in KERNELS:
                if getattr(system, kernel, "") and (problem := problem_of(bind(system, model, kernel), model)):
                    self._note(problem)

    def _check_keys(self) -> None:
        group, scenes = marked("scenes"), {scene.name for scene in all_scenes()}
        for action, binding in ACTIONS.bound():
            if action.name.startswith(f"{self.mod.name}."):
                for scene in sorted(set(binding.scenes) - scenes):
                    problem = missing(group, scene, scenes)
                    sentence = tr(
                        "The key '{key}' for {action}: {problem}",
                        key=binding.key,
                        action=action.name,
                        problem=problem,
                    )
                    self._note(sentence)

    # --- what must be tried ----------------------------------------------------------------------------

    def _live_in(self, scene: str) -> None:
        """Let frames pass in a scene, and do there what a person can do everywhere."""
        session = _session(self.mod, scene)
        for systems in session.plan(scene).phases.values():
            for system in systems:
                if system.mod is self.mod and not isinstance(system, StepSystem):
                    run_frames(system, session)
        for size in SIZES:
            session.resize(*size)
            for scale in SCALES:
                session.view.camera.scale *= scale
                session.frame(FRAME)
                _draw(session, size)
                session.view.camera.scale /= scale
        session.click(0.3, 0.3)
        session.drag((0.3, 0.3), (0.6, 0.3))
        session.press("wheel up")
        session.press("f1")
        _draw(session, SIZES[0])
        session.press("escape")
        session.type("1")
        assert session.boxes is not None
        session.frame(FRAME)
        if session.scene == scene != PAUSE:
            session.scenes.request(PAUSE)
            session.frame(FRAME)

    def _press(self, key: str, scene: str) -> None:
        session = _session(self.mod, scene)
        session.select(*session.particles.handles[:1])
        session.press(key)
        session.frame(FRAME)
        _draw(session, SIZES[0])

    def _run(self, integrator: str) -> None:
        session = Session(_sample(self.mod))
        session.model.settings.integrator = integrator
        session.run(steps=STEPS)
        if session.message and self.mod.off is False and session.simulation.halted:
            self._note(
                tr(
                    "A run with it ends after {count} steps: {message}",
                    count=session.model.clock.steps,
                    message=session.message,
                )
            )


# --- the model -------------------------------------------------------------------------------------------


def _session(mod: Mod, scene: str) -> Session:
    """A session with everything, in a scene."""
    session = Session(_sample(mod))
    session.scenes.request(*_way_to(session, scene))
    session.scenes.apply(session)
    return session


def _way_to(session: Session, scene: str) -> list[str]:
    """The scenes through which one gets from pause to a scene, itself included. Raises ValueError."""
    ways: dict[str, list[str]] = {session.scene: []}
    for here in (pending := [session.scene]):
        for name in session.scenes.names:
            if name not in ways and (
                name in session.scenes[here].targets or here in session.scenes[name].sources
            ):
                ways[name] = [*ways[here], name]
                pending.append(name)
    if scene not in ways:
        raise WrongValue(
            "The scene '{name}' cannot be reached; list the scenes that lead to it in its sources", name=scene
        )
    return ways[scene]


def _sample(mod: Mod) -> Model:
    """A model with everything that Pinjoint has, and with the Fields, elements and histories of a mod."""
    model = models.load(EVERYTHING)
    for called, kind in EXTENSIONS.kinds.items():
        if called.partition(".")[0] == mod.name:
            places = {point: (0.3 * n, -0.5) for n, point in enumerate(kind.points)}
            model.create(kind, 1, **places)
    for name, history in HISTORIES.items():
        if history.mod is mod:
            model.create(type(model.loads[0]), 1, on=2, force=(0.1, 0.0), history={"kind": name})
    for table in model.tables.values():
        for field in table.fields_in(*MADE) if table.count else ():
            if field.component.partition(".")[0] == mod.name:
                _fill(field, table.handles[0])
    return model


def _fill(field: Field[Any], element: Any) -> None:
    """Give a mod's Field of an element a value that is not nothing, if it can take one."""
    if field.dtype in (float, int, bool) and not field.default:
        value = 1 if field.maximum is None else min(1, field.maximum)
        plain = bool(value) if field.dtype is bool else field.dtype(max(value, field.minimum or 0))
        with suppress(FieldError):  # a rule of its own
            setattr(element, field.name, (plain, plain) if field.shape else plain)


def _draw(session: Session, size: tuple[int, int, float]) -> None:
    from pinjoint.systems.render.pygame_render import draw_unseen  # imports pygame

    session.update_view()
    draw_unseen(Frame(session, FRAME), size[:2])
