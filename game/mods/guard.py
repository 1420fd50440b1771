"""Guards around what mods add to models and their runs: when it fails, the mod is switched off and the session goes on.

What a person sees and does of mods is guarded in interface.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from copy import copy
from dataclasses import replace
from inspect import getattr_static
from typing import Any, ClassVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, Field, FieldError, Role
from pinjoint.components.handle import Handle
from pinjoint.components.language import tr
from pinjoint.components.load import HistoryKind
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.obstacles import Pieces, Shape, check_pieces
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.table import Table
from pinjoint.components.view import View
from pinjoint.editor.context import Context
from pinjoint.mods.declared import as_declared, check_fields
from pinjoint.mods.mod import INCLUDED, Mod, ModError
from pinjoint.mods.watchdog import stop_after
from pinjoint.systems.base import Commit, Event, Integrator, Law, StepSystem, System
from pinjoint.systems.physics.integrators import VelocityVerlet

PATIENCE = 2.0  # s that a frame system may take; a longer one is interrupted

_ROLES = (Law, Commit, Event, Integrator, StepSystem, System)


# --- systems -------------------------------------------------------------------------------------------


def guarded_maker(mod: Mod, system: Callable[[], System]) -> Callable[[], System]:
    """What makes a system of a mod for every session; one that cannot be made any more does nothing."""
    name = guarded_system(mod, system()).name

    def make() -> System:
        made = mod.call(tr("making the system '{name}'", name=name), lambda: guarded_system(mod, system()))
        return made if made is not None else _nothing(name)

    return make


def check_declarations(system: Any) -> System:
    """A system whose class attributes are of the types that its role declares. Raises ModError, TypeError."""
    role = next((role for role in _ROLES if isinstance(system, role)), None)
    if role is None:
        raise ModError(
            "{name} is not a System; derive it from a class in pinjoint.systems.base.",
            name=type(system).__name__,
        )
    for name, hint in get_type_hints(role).items():
        if get_origin(hint) is ClassVar:
            if isinstance(getattr_static(system, name), property):  # might answer differently, or fail, later
                raise ModError(
                    "{name} is a property; give the value itself.", name=f"{type(system).__name__}.{name}"
                )
            as_declared(getattr(system, name), get_args(hint)[0], f"{type(system).__name__}.{name}")
    made: System = system
    return made


def _nothing(name: str) -> System:
    """A system of that name that no model needs."""
    made = System()
    vars(made).update(name=name, unneeded=tr("its mod is switched off"), needs=lambda model: False)
    return made


def guarded_system(mod: Mod, made: System) -> System:
    """The system of a mod, wrapped so that it is left out once the mod is switched off.

    The commands of a frame system, or of an event, are one step of undo. If the system raises or takes too long,
    or leaves what a Field cannot take, such as NaN, its commands are dropped whole, and the columns that it declares
    in `writes` and `adds` are restored.
    """
    system = check_declarations(made)
    what, process = tr("the system '{name}'", name=system.name), system.process
    system.mod = mod
    _guard_question(mod, system, "needs", bool, otherwise=False)
    if isinstance(system, StepSystem):
        _guard_question(mod, system, "arrays", Mapping[str, NDArray[Any]], otherwise={})
        _guard_question(mod, system, "leaves_flight_exact", bool, otherwise=False)
    else:
        vars(system)["process"] = lambda frame: _change_whole(
            mod, system, what, frame.session.model, lambda: _in_frame(process, frame)
        )
    if isinstance(system, Law):
        _guard_question(mod, system, "cutoff", float, otherwise=math.inf)
    if isinstance(system, Event):
        happen = system.happen
        vars(system)["happen"] = lambda model, *elements: _change_whole(
            mod, system, what, model, lambda: happen(model, *elements)
        )
    return system


def _guard_question(mod: Mod, system: System, name: str, declared: Any, otherwise: Any) -> None:
    """Let a question about a model that a system answers switch its mod off if it fails."""
    own, what = getattr(system, name), tr("{method} of '{name}'", method=name, name=system.name)
    vars(system)[name] = lambda model: mod.call(what, own, model, otherwise=otherwise, declared=declared)


def _change_whole(mod: Mod, system: System, what: str, model: Model, change: Callable[[], object]) -> None:
    """Let a system change a model, by all of its commands or by none, and only to what Fields can take."""
    tables = {column.partition(".")[0] for column in (*system.writes, *system.adds)} & model.tables.keys()
    before = Snapshot.take(model, *tables) if tables else None

    def changed() -> bool:
        with model.transaction(system.name):
            if mod.source == INCLUDED:
                change()
            else:
                interruptible(change, model, PATIENCE)
                _check_state(model, tables)
        return True

    if not mod.call(what, changed, otherwise=False, patience=PATIENCE) and before is not None:
        before.restore(model)


def _check_state(model: Model, tables: Iterable[str]) -> None:
    """Raise FieldError if the state of these tables holds what their Fields cannot take, such as NaN."""
    for table in (model.tables[name] for name in tables):
        for field in table.fields_in(Role.STATE):
            if field.dtype is not object:
                column: Column = table.column(field.name)
                field.check_column(column, table.count, lambda row, table=table: model.describe(table[row]))  # type: ignore[misc]


def _in_frame(process: Callable[[Any], object], frame: Any) -> object:
    with view_kept(frame.session):
        return process(frame)


@contextmanager
def view_kept(context: Context) -> Iterator[None]:
    """Put the view and the notice back if the body raises, or leaves in them what cannot be shown."""
    view, notice = context.view, context.notice
    attributes, camera = dict(vars(view)), copy(view.camera)
    try:
        yield
        check_view(context.view)
        as_declared(context.notice, str, tr("the session's notice"))
    except BaseException:
        vars(view).update(attributes, camera=camera)
        context.view, context.notice = view, notice
        raise


def check_view(view: View) -> None:
    """Raise TypeError or ValueError if a view holds what cannot be shown."""
    check_fields(view, View)
    numbers = (*view.camera.centre, view.camera.scale, view.pixel_ratio)
    if not (all(map(math.isfinite, numbers)) and view.camera.scale > 0.0 < view.pixel_ratio):
        raise WrongValue(
            "the view's camera is at {centre} with {scale} pixels per metre; give finite numbers, and a scale above 0",
            centre=str(numbers[:2]),
            scale=str(numbers[2]),
        )


def interruptible(change: Callable[[], object], model: Model, patience: float) -> None:
    """Run what changes a model by commands, and restore entities that it deleted past the tables.

    A command is never interrupted; code that does nothing but give commands is stopped before the first one after
    `patience` (s).
    """
    model.before_command = stop_after(patience)
    try:
        as_declared(change(), None, tr("what it returned"))
    finally:
        model.before_command = None
        model.check_entities()


# --- histories, integrators, shapes --------------------------------------------------------------------


def guarded_history(mod: Mod, kind: HistoryKind) -> HistoryKind:
    """The history of a mod, whose Python functions switch the mod off if they fail."""

    def guarded(name: str, declared: Any, otherwise: Any, *mistakes: type[Exception]) -> Any:
        own = getattr(kind, name)
        what = tr("{method} of the history '{name}'", method=name, name=kind.name)
        return lambda *given: mod.call(
            what, own, *given, otherwise=otherwise, declared=declared, mistakes=mistakes
        )

    return replace(
        kind,
        check=guarded("check", Any, None, FieldError),
        ends=guarded("ends", float, -math.inf),
        breaks=guarded("breaks", Iterable[float], ()),
        static=guarded("static", float, 0.0) if callable(kind.static) else kind.static,
        mod=mod,
    )


def guarded_integrator(mod: Mod, integrator: Integrator) -> Integrator:
    """The integrator of a mod, wrapped so that it is no longer chosen once the mod is switched off."""
    own = integrator.stable_step

    def stable_step(frequency: float, decay: float) -> float:
        size: float = as_declared(own(frequency, decay), float, "it")
        if not size >= 0.0:
            raise WrongValue(
                "it is {size} s; return a number of at least 0 (0: no step is stable)", size=str(size)
            )
        return size

    def called(frequency: float, decay: float) -> float:
        what = tr("the stable step of the integrator '{name}'", name=integrator.name)
        size: float = mod.call(what, stable_step, frequency, decay, otherwise=math.nan)
        return VelocityVerlet.stable_step(frequency, decay) if math.isnan(size) else size

    check_declarations(integrator).mod = mod
    vars(integrator)["stable_step"] = called
    return integrator


def guarded_shape(mod: Mod, kind: type[Handle], shape: Shape) -> Shape:
    """What elements of a mod's kind collide as, wrapped so that they are nothing if it fails."""
    nothing = Pieces(np.zeros((0, 2, 2)), np.zeros(0, dtype=np.intp))
    source = getattr(shape, "__name__", "its function")

    def pieces(table: Table[Any]) -> Pieces:
        made = shape(table)
        return check_pieces(
            table, as_declared(made, Pieces, source) if isinstance(made, Pieces) else made, source
        )

    def called(table: Table[Any]) -> Pieces:
        found: Pieces = mod.call(tr("the shape of {table}", table=kind.table), pieces, table, otherwise=nothing)
        return found

    return called


def guard_checkers(mod: Mod, fields: Iterable[Field[Any]]) -> None:
    """Let the checkers of a mod's Fields refuse values only by FieldError; without the mod, every value is kept."""
    for field in fields:
        if field.checker is not None:
            field.checker = _guarded_checker(mod, field, field.checker)


def _guarded_checker(mod: Mod, field: Field[Any], own: Callable[[Any, str], Any]) -> Callable[[Any, str], Any]:
    def checker(value: Any, where: str) -> Any:
        was_off = mod.off
        what = tr("the checker of {field}", field=field.name)
        made = mod.call(what, own, value, where, otherwise=value, mistakes=(FieldError,))
        if mod.off and not was_off:
            raise FieldError(
                "{where}: {field} cannot be checked; {problem}",
                where=where,
                field=field.title,
                problem=mod.problem,
            )
        return made

    return checker
