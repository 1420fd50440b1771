"""Guards around what mods add to models and their runs: when it fails, the mod is switched off and the session goes on.

What a person sees and does of mods is guarded in interface.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from copy import copy
from dataclasses import replace
from functools import partial
from inspect import getattr_static
from typing import Any, ClassVar, TypeVar, get_args, get_origin, get_type_hints

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
from pinjoint.mods.declared import check, check_fields, check_has_run, result_of
from pinjoint.mods.limit import check_limit
from pinjoint.mods.mod import INCLUDED, Mod, ModError
from pinjoint.systems.base import Commit, Event, Integrator, Law, StepSystem, System
from pinjoint.systems.physics.integrators import VelocityVerlet

T = TypeVar("T")

PATIENCE = 2.0  # s that a frame system may take; a longer one is interrupted

_ROLES = (Law, Commit, Event, Integrator, StepSystem, System)
_QUESTIONS = ("needs", "arrays", "leaves_flight_exact", "cutoff", "held_forces")  # that systems answer


# --- systems -------------------------------------------------------------------------------------------


def guarded_maker(mod: Mod, system: Callable[[], System]) -> Callable[[], System]:
    """What makes a system of a mod for every session; one that cannot be made any more does nothing."""
    name = guarded_system(mod, system()).name
    what = tr("making the system '{name}'", name=name)
    return made_anew(mod, what, lambda: guarded_system(mod, system()), lambda: _nothing(name))


def made_anew(mod: Mod, what: str, make: Callable[[], T], nothing: Callable[[], T]) -> Callable[[], T]:
    """What makes something of a mod again and again, or nothing that does what it does not."""
    make_it = mod.guarded(what, make)
    return lambda: nothing() if (found := make_it()) is None else found


def check_declarations(made: Any, role: type) -> None:
    """Raise ModError or TypeError if class attributes are not of the types that the role declares."""
    for name, hint in get_type_hints(role).items():
        if get_origin(hint) is ClassVar:
            called = f"{(made if isinstance(made, type) else type(made)).__name__}.{name}"
            if isinstance(getattr_static(made, name, None), property):  # might answer otherwise, or fail, later
                raise ModError("{name} is a property; give the value itself.", name=called)
            check(getattr(made, name, None), get_args(hint)[0], called)


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
    role = next((role for role in _ROLES if isinstance(made, role)), None)
    if role is None:
        name = type(made).__name__
        raise ModError("{name} is not a System; derive it from a class in pinjoint.systems.base.", name=name)
    check_declarations(made, role)
    made.mod, own = mod, vars(made)
    what, process = tr("the system '{name}'", name=made.name), made.process
    if isinstance(made, Law):
        own["held_forces"] = partial(_forces_of_each, made.held_forces)
    for name in _QUESTIONS:
        if hasattr(role, name):
            asked = tr("{method} of '{name}'", method=name, name=made.name)
            declared, plain = result_of(getattr(role, name)), getattr(role, name)(made, None)
            own[name] = mod.guarded(asked, getattr(made, name), otherwise=plain, declared=declared)
    needs = own["needs"]
    own["needs"] = lambda model: needs(model) and not mod.off
    if not isinstance(made, StepSystem):
        own["process"] = lambda frame: _change_whole(
            mod, made, what, frame.session.model, lambda: _in_frame(process, frame)
        )
    if isinstance(made, Event):
        happen = made.happen
        own["happen"] = lambda model, *elements: _change_whole(
            mod, made, what, model, lambda: happen(model, *elements)
        )
    return made


def _forces_of_each(held_forces: Callable[[Model], NDArray[np.float64]], model: Model) -> NDArray[np.float64]:
    """What a law answered, for each particle. Raises ValueError if it is not finite, or of another shape."""
    return np.broadcast_to(np.asarray_chkfinite(held_forces(model)), (model.particles.count, 2))


def _change_whole(mod: Mod, system: System, what: str, model: Model, change: Callable[[], object]) -> None:
    """Let a system change a model, by all of its commands or by none, and only to what Fields can take."""
    tables = {column.partition(".")[0] for column in (*system.writes, *system.adds)} & model.tables.keys()
    before = Snapshot.take(model, *tables) if tables else None

    def changed() -> bool:
        with model.transaction(system.name):
            if mod.source == INCLUDED:
                change()
            else:
                interruptible(change, model)
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
        check_view(context.view, attributes if context.view is view else {})
        check(context.notice, str, tr("the session's notice"))
    except BaseException:
        vars(view).update(attributes, camera=camera)
        context.view, context.notice = view, notice
        raise


def check_view(view: View, shown: Mapping[str, Any]) -> None:
    """Raise TypeError or ValueError if a view holds what cannot be shown, beside what it showed before."""
    check_fields(view, View, shown)
    numbers = (*view.camera.centre, view.camera.scale, view.pixel_ratio)
    if not (all(map(math.isfinite, numbers)) and view.camera.scale > 0.0 < view.pixel_ratio):
        raise WrongValue(
            "the view's camera is at {centre} with {scale} pixels per metre; give finite numbers, and a scale above 0",
            centre=str(numbers[:2]),
            scale=str(numbers[2]),
        )


def interruptible(change: Callable[[], object], model: Model) -> None:
    """Run what changes a model by commands, and restore entities that it deleted past the tables.

    A command is never interrupted; code that does nothing but give commands is stopped before the first one that is late.
    """
    model.before_command = check_limit
    try:
        check_has_run(change(), tr("what it returned"))
    finally:
        model.before_command = None
        model.check_entities()


# --- histories, integrators, shapes --------------------------------------------------------------------


def guarded_history(mod: Mod, kind: HistoryKind) -> HistoryKind:
    """The history of a mod, whose Python functions switch the mod off if they fail."""

    def guarded(name: str, declared: Any, otherwise: Any, own: Any = None, mistakes: Any = ()) -> Any:
        what = tr("{method} of the history '{name}'", method=name, name=kind.name)
        how = {"otherwise": otherwise, "declared": declared, "mistakes": mistakes}
        return mod.guarded(what, own or getattr(kind, name), **how)

    return replace(
        kind,
        check=guarded("check", None, None, mistakes=(FieldError,)),
        ends=guarded("ends", float, -math.inf),
        breaks=guarded("breaks", tuple[float, ...], (), own=lambda history: tuple(kind.breaks(history))),
        static=guarded("static", float, 0.0) if callable(kind.static) else kind.static,
        mod=mod,
    )


def guarded_integrator(mod: Mod, integrator: Integrator) -> Integrator:
    """The integrator of a mod, wrapped so that it is no longer chosen once the mod is switched off."""
    own, what = integrator.stable_step, tr("the stable step of the integrator '{name}'", name=integrator.name)

    def stable_step(frequency: float, decay: float) -> float:
        size = own(frequency, decay)
        check(size, float, "it")
        if not size >= 0.0:
            raise WrongValue(
                "it is {size} s; return a number of at least 0 (0: no step is stable)", size=str(size)
            )
        return size

    def called(frequency: float, decay: float) -> float:
        size: float | None = mod.call(what, stable_step, frequency, decay)
        return VelocityVerlet.stable_step(frequency, decay) if size is None else size

    check_declarations(integrator, Integrator)
    integrator.mod = mod
    vars(integrator)["stable_step"] = called
    return integrator


def guarded_shape(mod: Mod, kind: type[Handle], shape: Shape) -> Shape:
    """What elements of a mod's kind collide as, wrapped so that they are nothing if it fails."""
    nothing = Pieces(np.zeros((0, 2, 2)), np.zeros(0, dtype=np.intp))
    source = getattr(shape, "__name__", "its function")

    def pieces(table: Table[Any]) -> Pieces:
        made = shape(table)
        if isinstance(made, Pieces):
            check_fields(made, Pieces)
        return check_pieces(table, made, source)

    return mod.guarded(tr("the shape of {table}", table=kind.table), pieces, otherwise=nothing)


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
