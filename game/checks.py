"""Checks: one line in a test for any system, by the contract of systems; and a whole mod, which does all that it can."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from fnmatch import filter as matching
from inspect import isfunction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinjoint.components.additions import Component
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import MADE, SAVED, Column, Field, FieldError, Role, same
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.load import HISTORIES
from pinjoint.components.mistake import Explained, WrongValue
from pinjoint.components.model import Model
from pinjoint.components.settings import PAUSE
from pinjoint.components.table import fields_of
from pinjoint.components.wording import missing, nearest
from pinjoint.documents import models
from pinjoint.documents.library import data_in
from pinjoint.editor.frame import Frame
from pinjoint.editor.scenes import Scene, all_scenes
from pinjoint.interrupts import is_persons
from pinjoint.lessons.checking import check_lesson
from pinjoint.lessons.progress import lessons_in
from pinjoint.mods.loading import load_all
from pinjoint.mods.mod import LOG, Mod
from pinjoint.scripts.script import Script
from pinjoint.session import Session
from pinjoint.systems.base import Commit, Event, Integrator, Law, StepSystem, StopReason, System
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.input.actions import ACTIONS, SIMULATION
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.binding import KERNELS, PROVIDED, Bound, ProgramError, bind
from pinjoint.systems.program.compiler import Choice
from pinjoint.systems.program.faults import problem_of
from pinjoint.systems.program.identity import reached_from
from pinjoint.systems.program.interpreter import plain_function
from pinjoint.systems.program.near_pairs import pairs_within
from pinjoint.systems.program.program import MOTION, TURNING
from pinjoint.systems.program.writer import read_sources
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule, ScheduleError

STEPS = 40  # that step systems are run for
FRAMES = 3  # that frame systems are run for
FRAME = 1.0 / 60.0  # s
SIZES = ((640, 480, 1.0), (160, 120, 2.0))  # pixels, and pixels to a point, of pictures
SCALES = (1.0, 1e4, 1e-4)  # by which a person may zoom
PATIENCE = 30.0  # s that some steps of the small model may take
NEARBY = 1e-5  # of a distance, over which the slope of a potential is taken
NEAR = 0.8  # of the letters, from which on a name is a misspelt one
_NAMING = {  # what declares names, and names of what
    **dict.fromkeys(("scenes", "sources", "targets"), marked("scenes")),
    **dict.fromkeys(("before", "after", "systems"), marked("systems")),
}
_UNDECLARED = marked("{name}: it changed {column}, which it does not declare in writes or adds.")
_ASKED = marked("{name}: needs(model) changed {column}; it must not change the model.")
_NOT_REPEATED = marked("{name}: run twice, it gives another {column}; nothing may depend on chance.")
_NOT_IN_ORDER = marked(
    "{name}: registered in another order, it gives another {column}; the order must not matter."
)

# Supports, springs that yield, dampers, drag, a load that varies, and a free body.
EVERYTHING: Mapping[str, Any] = {
    "format": "pinjoint model",
    "version": 1,
    "settings": {"integrator": "velocity_verlet"},  # the quickest to compile
    "environment": {"acceleration": [0.0, -9.81], "drag": 0.1},
    "particles": [
        {"name": "A", "position": [0.0, 0.0], "fixed": [True, True]},
        {"name": "B", "position": [1.0, 0.0], "fixed": [False, True]},
        {"name": "C", "position": [0.6, 0.8], "force": [3.0, -20.0]},
        {"name": "D", "position": [5.0, 5.0], "velocity": [1.0, -2.0]},
    ],
    "rods": [
        {"name": "AB", "between": ["A", "B"]},
        {"name": "AC", "between": ["A", "C"], "tensile_strength": 10.0, "compressive_strength": 12.0},
        {"name": "BC", "between": ["B", "C"], "damping": 0.0, "plastic_strain": 1e-5},
    ],
    "loads": [{"on": "C", "force": [1.0, 0.0], "history": {"kind": "ramp", "duration": 0.5}}],
}
ELASTIC: Mapping[str, Any] = {
    **EVERYTHING,
    "rods": [{"name": "AC", "between": ["A", "C"]}, {"name": "BC", "between": ["B", "C"]}],
}
BODIES: Mapping[str, Any] = {
    "format": "pinjoint model",
    "version": 1,
    "settings": {"integrator": "velocity_verlet"},
    "particles": [
        {"name": "A", "position": [0.0, 0.0], "velocity": [1.0, 0.0]},
        {"name": "B", "position": [3.0, 0.0], "mass": 2.0},
    ],
}
MODELS: tuple[Any, ...] = (EVERYTHING, ELASTIC, BODIES)

Source = Any  # a model's name or document, or a function that returns a Model


class SystemCheckError(Explained, AssertionError):
    """A system that breaks its declarations; the message says how."""


@dataclass(frozen=True)
class Checked:
    """A checked system, and the number of models that need it."""

    name: str
    needed: int


def check_system(
    system: Callable[[], System] | str, models: Iterable[Source] = MODELS, *, mods: Iterable[str | Path] = ()
) -> Checked:
    """Run a system, given by its class, on several models. Raises SystemCheckError, which names what is wrong.

    The system may change only the columns that it declares, must give finite numbers, the same ones every time and
    in any order of registration, and must be needed by one of the models.

    mods: folders of mods that are loaded first, with whose components the models are read; a system of theirs, or
        of mods loaded before, can then be given by its name. Raises ModError.

    >>> from pinjoint.systems.physics.system import Drag
    >>> check_system(Drag).name
    'physics.drag'
    """
    load_all(mods)
    if isinstance(system, str):  # its class, so that what it does is not guarded
        known: dict[str, System] = {made.name: made for made in (*all_systems(), *INTEGRATORS.values())}
        if system not in known:
            raise SystemCheckError(missing(marked("systems"), system, known))
        system = type(known[system])
    name = system().name
    needed = sum(_check(system, source) for source in models)
    if not needed and isinstance(system(), Integrator):
        raise SystemCheckError(
            "No model uses {name}; give check_system models=[…] with rods or drag.", name=name
        )
    if not needed:
        raise SystemCheckError(
            "No model needs {name}; give check_system models=[…] for which needs() is true.", name=name
        )
    return Checked(name, needed)


def _model(source: Source) -> Model:
    return source() if callable(source) else models.load(source)


def _columns_of(model: Model) -> dict[str, Column]:
    """Copies of all columns of document and state."""
    return {
        f"{table.name}.{field.name}": table.column(field.name).copy()
        for table in model.tables.values()
        for field in table.fields_in(*SAVED)
    }


def _compare(
    name: str,
    before: Mapping[str, Column],
    after: Mapping[str, Column],
    refusal: str,
    allowed: Collection[str] = (),
) -> None:
    """Raise SystemCheckError if other columns than those allowed, by name or table, differ.

    refusal: its sentence, with {name} and {column}.
    """
    for column, old in before.items():
        if column in allowed or column.partition(".")[0] in allowed or same(old, after[column]):
            continue
        raise SystemCheckError(refusal, name=name, column=column)


def _check(make: Callable[[], System], source: Source) -> bool:
    """Check a system on a model; False if the model does not need it."""
    made = make()
    first = _run(made, source)
    if first is None:
        return False
    allowed = {*made.writes, *made.adds}
    if isinstance(made, StepSystem):  # the others of the program are at work, too
        allowed |= {*MOTION, *TURNING, "particles.asleep", "clock", "settings.integrator"}
        allowed |= {
            column for other in all_systems() if isinstance(other, StepSystem) for column in other.writes
        }
    after = _columns_of(first)
    _compare(made.name, _columns_of(_model(source)), after, _UNDECLARED, allowed)
    _check_finite(made.name, first)
    for backwards, refusal in ((False, _NOT_REPEATED), (True, _NOT_IN_ORDER)):
        again = _run(make(), source, backwards=backwards)
        if again is None:
            raise SystemCheckError(
                "{name}: needs(model) is sometimes true and sometimes false for the same model.", name=made.name
            )
        _compare(made.name, after, _columns_of(again), refusal)
    if isinstance(made, Law) and made.each == "pairs":
        _check_pairs(made, first)
    return True


def _run(system: System, source: Source, *, backwards: bool = False) -> Model | None:
    """A model after some steps or frames with a system; None if it needs no such one, as free flight no integrator.

    backwards: the systems of the program, this one instead of any of its name, are registered in the opposite order.
    """
    model = _model(source)
    if not isinstance(system, Integrator):
        before, needed = _columns_of(model), system.needs(model)
        _compare(system.name, before, _columns_of(model), _ASKED)
        if not needed:
            return None
    if not isinstance(system, StepSystem):
        _run_frames(system, Session(model))
        return model
    systems = [*(other for other in all_systems() if other.name != system.name), system]
    former = dict(INTEGRATORS)
    try:
        simulation = Simulation(model, Schedule(systems[::-1] if backwards else systems))
        if isinstance(system, Integrator):
            INTEGRATORS[system.key] = system
            model.settings.integrator = system.key
            if simulation.integrator is not system:
                return None
        simulation.advance(STEPS)
    except (ScheduleError, ProgramError) as error:
        raise SystemCheckError(str(error)) from None
    finally:
        INTEGRATORS.clear()
        INTEGRATORS.update(former)
    if simulation.reason is StopReason.DIVERGED:
        raise SystemCheckError(
            "{name}: in a run with it, numbers grow without limit. {message}",
            name=system.name,
            message=simulation.message,
        )
    return model


def _run_frames(system: System, session: Session) -> None:
    """Run a system for FRAMES frames. Raises SystemCheckError if it fails, or changes columns that it does not declare."""
    before = _columns_of(session.model)
    for _ in range(FRAMES):
        session.model.activate()
        try:
            system.process(Frame(session, FRAME))
        except Exception as error:
            told = {"name": system.name, "kind": type(error).__name__, "error": error}
            raise SystemCheckError("{name} raises {kind}: {error}", **told) from error
    _compare(system.name, before, _columns_of(session.model), _UNDECLARED, {*system.writes, *system.adds})


def _check_pairs(law: Law, model: Model) -> None:
    """Check that a law of pairs gives opposite forces, and those of its potential."""
    bound = bind(law, model)
    apart, force = _of_pairs(bound, model)
    if not np.allclose(force, -_of_pairs(bound, model, turned=True)[1], rtol=1e-9, atol=0.0):
        raise SystemCheckError(
            "{name}: the forces on two particles change if the two are swapped; they must be opposite in any order.",
            name=law.name,
        )
    if not law.potential:
        return
    energy, distance = bind(law, model, "potential"), np.hypot(*apart.T)
    for axis, step in enumerate(NEARBY * np.eye(2)):
        ahead, behind = (_of_pairs(energy, model, moved=side * step)[1][:, 0] for side in (1.0, -1.0))
        slope = (ahead - behind) / (2.0 * NEARBY * distance)
        wrong = np.abs(slope - force[:, axis]) > 1e-4 * (np.hypot(*force.T) + np.abs(ahead) / distance)
        if wrong.any():
            row = int(np.argmax(wrong))
            raise SystemCheckError(
                "{name}: at a distance of {distance:g} m the slope of its potential is {slope:g} kN, but the force"
                " on the first particle along the same axis is {force:g} kN; they must be equal.",
                name=law.name,
                distance=float(distance[row]),
                slope=float(slope[row]),
                force=float(force[row, axis]),
            )


def _of_pairs(
    bound: Bound, model: Model, *, turned: bool = False, moved: ArrayLike = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Vectors (m) between all pairs that a kernel acts on, and what it gives for them; what only programs provide is 0.

    turned: the second particle of each comes first; moved: vectors are longer by this share (x, y) of their length.
    """
    pairs = pairs_within(model, bound.cutoff)[:, :: -1 if turned else 1]

    def between(name: str) -> NDArray[np.float64]:
        return np.diff(model.column(f"particles.{name}")[pairs], axis=1)[:, 0]

    apart = between("position") + between("displacement")
    apart = apart + np.hypot(*apart.T)[:, None] * moved
    given = dict.fromkeys(PROVIDED, np.zeros(len(pairs))) | {"apart": apart, "drift": between("velocity")}
    for parameter in set(bound.parameters) - given.keys():
        table, _, name = parameter.partition("_")
        own = bound.arrays.get(parameter)
        column = model.column(f"{table}.{name}") if own is None else own
        shared = own is None and model.tables[table].kind.single
        given[parameter] = np.repeat(column, len(pairs), axis=0) if shared else column[pairs]
    rows = zip(*(map(_as_tuples, given[name].tolist()) for name in bound.parameters), strict=True)
    made = np.array([bound.function(*row) for row in rows], dtype=np.float64)
    return apart, made.reshape(len(pairs), -1 if len(pairs) else 2)


def _as_tuples(value: Any) -> Any:
    """A row as kernels get it."""
    return tuple(map(_as_tuples, value)) if isinstance(value, list) else value


def _check_finite(name: str, model: Model) -> None:
    for table in model.tables.values():
        for field in table.fields_in(Role.STATE):
            if field.dtype is float and not field.nullable and not np.isfinite(table.column(field.name)).all():
                column = f"{table.name}.{field.name}"
                raise SystemCheckError(
                    "{name}: after {count} steps with it, {column} is not finite.",
                    name=name,
                    count=STEPS,
                    column=column,
                )


# --- a whole mod -------------------------------------------------------------------------------------------


class Trial:
    """What is wrong with a mod, a sentence each, in `found`.

    Its kernels are compiled, it is seen, its scenes are entered, its keys pressed, its systems and integrators run.
    What it changes is forgotten; a part that fails does not keep the others from being tried.
    """

    def __init__(self, mod: Mod) -> None:
        self.mod = mod
        self.found: list[str] = []
        heard, known, patience = LOG.disabled, len(EXTENSIONS.faults), Choice.patience
        LOG.disabled, Choice.patience = True, PATIENCE
        try:
            with data_in():
                self._try_all()
        finally:
            LOG.disabled, Choice.patience = heard, patience
            del EXTENSIONS.faults[known:]

    def _try_all(self) -> None:
        systems = [s for s in (*all_systems(), *INTEGRATORS.values()) if s.mod is self.mod]
        scenes = [scene for scene in all_scenes() if scene.mod is self.mod]
        for system in systems:
            with self._part():
                self._read(system)
        with self._part():
            self._check_names([*systems, *scenes])
        root = self.mod.module
        for name in [name for name in sys.modules if name == root or name.startswith(f"{root}.")]:
            for made in vars(sys.modules[name]).values():
                if isinstance(made, type) and made.__module__ == name:
                    self._check_spelling(made)
        if self.found:
            return  # a run would only fail for the same reasons
        for scene in (PAUSE, SIMULATION, *(scene.name for scene in scenes)):
            with self._part():
                self._live_in(scene)
        for action, binding in ACTIONS.bound():
            for scene in binding.scenes if action.name.startswith(f"{self.mod.name}.") else ():
                with self._part():
                    self._press(action.name, binding.key, scene)
        for integrator in (*(s.key for s in systems if isinstance(s, Integrator)), "velocity_verlet"):
            with self._part():
                self._run(integrator)
        for folder in EXTENSIONS.folders:
            own = self.mod.folder is not None and folder.resolve().is_relative_to(self.mod.folder)
            for file in sorted(folder.glob("*.json")) if own else ():
                with self._part():
                    models.load(file)
        for file in lessons_in(self.mod.folder) if self.mod.folder is not None else ():
            with self._part():
                for failure in check_lesson(Script(file)):
                    self._note(f"{file.name} {failure}")

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

    # --- what can be read ------------------------------------------------------------------------------

    def _read(self, system: System) -> None:
        """Compile a system's kernels by themselves, and look for the columns that it names."""
        model = _sample(self.mod)
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
                if getattr(system, kernel, ""):
                    self._compile(system, kernel, model)

    def _compile(self, system: StepSystem, kernel: str, model: Model) -> None:
        try:
            bound = bind(system, model, kernel)
        except ProgramError:
            if system.needs(model):
                raise
            untried = tr("{name} was not tried: the model of this check does not need it.", name=system.name)
            self.mod.notes += [] if untried in self.mod.notes else [untried]  # `arrays` may have nothing for it
            return
        if any("print" in plain_function(one).__code__.co_names for one in reached_from([bound.function])):
            self._note(tr("The kernel of {system} prints, in every step; remove that.", system=system.name))
        elif problem := problem_of(bound, model):
            self._note(problem)

    def _check_names(self, declared: Iterable[System | Scene]) -> None:
        """Look for the scenes and systems that systems and scenes name."""
        from pinjoint.app import window_systems  # imports pygame

        with tempfile.TemporaryDirectory() as folder:
            plan = Session(Model(), systems=window_systems(Path(folder))).plan(PAUSE)
        active = [system.name for systems in plan.phases.values() for system in systems]
        known = {"scenes": [scene.name for scene in all_scenes()], "systems": [*plan.left_out, *active]}
        families = {name.partition(".")[0] for name in known["systems"]}
        for made in declared:
            for attribute, group in _NAMING.items():
                for name in getattr(made, attribute, None) or ():
                    of_others = attribute in ("before", "after") and name.partition(".")[0] not in families
                    if matching(known[group], name) or (of_others and not nearest(name, known[group], NEAR)):
                        continue  # a mod that is not loaded may have it
                    self._note(joined([f"{made.name}, {attribute}:", missing(group, name, known[group])]))

    def _check_spelling(self, made: type) -> None:
        """Look in a class for what is nearly what its role declares, and for Fields that are none."""
        role = next(base for base in made.__mro__ if base.__module__.partition(".")[0] != self.mod.module)
        if role is object:
            return
        hints = {name for base in role.__mro__ for name in vars(base).get("__annotations__", ())}
        declared, own = {*dir(role), *hints}, dict[str, Any]()
        for base in reversed(made.__mro__[: made.__mro__.index(role)]):
            own |= {name: value for name, value in vars(base).items() if name[0] != "_"}
        free = {name for name in declared - own.keys() if name[0] != "_"}
        methods = {name for name in free if isfunction(getattr(role, name, None))}
        for name, value in own.items():
            if isinstance(value, Field) or name in declared:
                continue
            is_method = isinstance(value, staticmethod) or (isfunction(value) and not hasattr(value, "py_func"))
            alike = methods if is_method else free - methods
            turned = [other for other in alike if sorted(other) == sorted(name)]
            if near := turned[0] if turned else nearest(name, alike, NEAR):
                told = {"kind": made.__name__, "name": name, "near": near}
                self._note(tr("{kind}.{name} means nothing; did you mean '{near}'?", **told))
        if not issubclass(made, Component | Handle):
            return
        for name, hint in vars(made).get("__annotations__", {}).items():
            plain = not isinstance(own.get(name), Field) and name not in hints and "ClassVar" not in str(hint)
            if plain and name[0] != "_" and not name.isupper():
                told = {
                    "kind": made.__name__,
                    "name": name,
                    "form": f'{name}: Field[float] = Field("…", doc="…")',
                }
                self._note(tr("{kind}.{name} is not a Field; write {form}.", **told))

    # --- what must be tried ----------------------------------------------------------------------------

    def _live_in(self, scene: str) -> None:
        """Let frames pass in a scene, and do there what a person can do everywhere."""
        session = _session(self.mod, scene)
        for systems in session.plan(scene).phases.values():
            for system in systems:
                if system.mod is self.mod and not isinstance(system, StepSystem):
                    _run_frames(system, session)
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

    def _press(self, action: str, key: str, scene: str) -> None:
        if scene not in (names := [known.name for known in all_scenes()]):
            problem = missing(marked("scenes"), scene, names)
            self._note(tr("The key '{key}' for {action}: {problem}", key=key, action=action, problem=problem))
            return
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
    scenes, ways = session.scenes, {session.scene: list[str]()}
    while scene not in ways:
        further = {
            name: [*way, name]
            for here, way in ways.items()
            for name in {*scenes.names} - {*ways}
            if name in scenes[here].targets or here in scenes[name].sources
        }
        if not further:
            raise WrongValue(
                "The scene '{name}' cannot be reached; list the scenes that lead to it in its sources",
                name=scene,
            )
        ways |= further
    return ways[scene]


def _sample(mod: Mod) -> Model:
    """A model with everything that Pinjoint has, and with the Fields, elements and histories of a mod."""
    model = models.load(EVERYTHING)
    for called, kind in EXTENSIONS.kinds.items():
        if called.partition(".")[0] == mod.name:
            places = {point: (0.3 * n, -0.5) for n, point in enumerate(kind.points)}
            at = {f.name: [range(2) if f.shape else 0] for f in fields_of(kind) if f.references is not None}
            model.create(kind, 1, **places, **at)
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
