"""Guards around the code of mods: when it fails, the mod is switched off and the session goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from components.field import FieldError
from components.load import HistoryKind
from components.model import Model
from components.snapshot import Snapshot
from game.editor.context import Scene
from game.mods.mod import INCLUDED, Mod
from game.mods.watchdog import interrupted_after, stop_after
from systems.base import Event, Integrator, StepSystem, System
from systems.physics.integrators import VelocityVerlet

PATIENCE = 2.0  # s that a frame system may take; a longer one is interrupted


def guarded_system(mod: Mod, system: System) -> System:
    """The system of a mod, wrapped so that it is left out once the mod is switched off.

    The commands of a frame system, or of an event, are one step of undo. If the system raises or takes too long,
    its commands are dropped whole, and the columns that it declares in `writes` and `adds` are restored.
    """
    needs, process = system.needs, system.process
    what = f"the system '{system.name}'"

    def needed(model: Model) -> bool:
        return bool(mod.call(f"the question whether '{system.name}' is needed", needs, model, otherwise=False))

    def processed(frame: Any) -> None:
        _change_whole(mod, system, what, frame.session.model, lambda: process(frame))

    system.mod = mod
    vars(system)["needs"] = needed
    if isinstance(system, StepSystem):
        arrays, asked = system.arrays, f"the question for the arrays of '{system.name}'"
        vars(system)["arrays"] = lambda model: mod.call(asked, arrays, model, otherwise={})
    else:
        vars(system)["process"] = processed
    if isinstance(system, Event):
        happen = system.happen
        vars(system)["happen"] = lambda model, *elements: _change_whole(
            mod, system, what, model, lambda: happen(model, *elements)
        )
    return system


def _change_whole(mod: Mod, system: System, what: str, model: Model, change: Callable[[], None]) -> None:
    """Let a system change a model, by all of its commands or by none."""
    tables = {column.partition(".")[0] for column in (*system.writes, *system.adds)}
    before = Snapshot.take(model, *tables & model.tables.keys()) if tables & model.tables.keys() else None
    try:
        with model.transaction(system.name):
            if mod.source == INCLUDED:
                change()
            else:
                _watched(change, model)
    except Exception as error:  # any error of code that is not ours
        if before is not None:
            before.restore(model)
        mod.fail(what, error)


def _watched(change: Callable[[], None], model: Model) -> None:
    """Run what a system changes; interrupt it after PATIENCE, and restore entities that it deleted past the tables.

    A command is never interrupted; a system that does nothing but give commands is stopped before the next one.
    """
    model.before_command = stop_after(PATIENCE)
    try:
        with interrupted_after(PATIENCE, lambda: not model.changing):
            change()
    finally:
        model.before_command = None
        model.check_entities()


def guarded_history(mod: Mod, kind: HistoryKind) -> HistoryKind:
    """The history of a mod, whose Python functions switch the mod off if they fail."""

    def guarded(what: str, function: Callable[..., Any], otherwise: Any, *mistakes: type[Exception]) -> Any:
        what = f"the {what} of the history '{kind.name}'"
        return lambda *given: mod.call(what, function, *given, otherwise=otherwise, mistakes=mistakes)

    static = kind.static
    if callable(static):
        own = static
        static = guarded("static factor", lambda history: float(own(history)), 0.0)
    return replace(
        kind,
        check=guarded("check", kind.check, None, FieldError),
        ends=guarded("end", lambda history: float(kind.ends(history)), -math.inf),
        breaks=guarded("breaks", lambda history: tuple(kind.breaks(history)), ()),
        static=static,
        mod=mod,
    )


def guarded_integrator(mod: Mod, integrator: Integrator) -> Integrator:
    """The integrator of a mod, wrapped so that it is no longer chosen once the mod is switched off."""
    own = integrator.stable_step

    def stable_step(frequency: float, decay: float) -> float:
        size = float(own(frequency, decay))
        if not size >= 0.0:
            raise ValueError(f"it is {size} s; return a step of at least 0, which says that none is stable")
        return size

    def called(frequency: float, decay: float) -> float:
        what = f"the stable step of the integrator '{integrator.name}'"
        size: float = mod.call(what, stable_step, frequency, decay, otherwise=math.nan)
        return VelocityVerlet.stable_step(frequency, decay) if math.isnan(size) else size

    integrator.mod = mod
    vars(integrator)["stable_step"] = called
    return integrator


_METHODS = tuple(name for name, method in vars(Scene).items() if callable(method) and name[0] != "_")


def guarded_scene(mod: Mod, kind: type[Scene]) -> type[Scene]:
    """The scene of a mod, wrapped so that it does nothing and leads to pause once the mod is switched off."""
    methods = {name: _guarded_method(mod, kind, name) for name in _METHODS}
    return type(kind.__name__, (kind,), {**methods, "mod": mod})


def _guarded_method(mod: Mod, kind: type[Scene], name: str) -> Callable[..., Any]:
    own, plain = getattr(kind, name), getattr(Scene, name)

    def method(scene: Scene, session: Any, *arguments: Any) -> Any:
        made = mod.call(f"the scene '{kind.name}'", own, scene, session, *arguments, otherwise=mod)
        if made is not mod:
            return made
        return plain(scene, session, *arguments)

    return method
