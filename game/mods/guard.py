"""Guards around all that mods add: when it fails, the mod is switched off and the session goes on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import replace
from functools import partial
from inspect import getattr_static
from itertools import islice
from typing import TYPE_CHECKING, Any, ClassVar, get_args, get_origin, get_type_hints

import numpy as np

from pinjoint.commands.arguments import BAD_INPUT, UsageError
from pinjoint.components.field import Column, Field, FieldError, Role, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import Said, tr
from pinjoint.components.load import HistoryKind
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.obstacles import Pieces, Shape
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.table import Table
from pinjoint.components.view import Plot, Readout, View
from pinjoint.components.wording import printable, quoted
from pinjoint.documents import models
from pinjoint.mods.declared import check, check_fields, check_has_run, result_of
from pinjoint.mods.limit import T, check_limit
from pinjoint.mods.mod import LONGEST, Mod, ModError
from pinjoint.paths import PathError
from pinjoint.systems.base import Commit, Event, Integrator, Law, StepSystem, System
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import ACTIONS, Perform
from pinjoint.systems.physics.integrators import VelocityVerlet
from pinjoint.systems.render.framing import framed
from pinjoint.systems.render.marks import Mark
from pinjoint.systems.render.model.sheet import Layer, Sheet

if TYPE_CHECKING:  # a command needs no editor
    from pinjoint.editor.context import Context, Scene

PATIENCE = 2.0  # s that a frame system may take; a longer one is interrupted

_ROLES = (Law, Commit, Event, Integrator, StepSystem, System)
Panel = Callable[[Any], Readout | Sequence[Readout] | None]  # is given the context
_MOST_MARKS = 1_000_000  # of a layer: an iterator may have no end, in code that nothing interrupts
_READ = {"heading": str, "message": str, "boxes": dict[str, str]}  # as attributes or properties


class Guard:
    """Around what one mod adds: for each kind of extension, what stands in its place."""

    def __init__(self, mod: Mod) -> None:
        self.mod = mod

    def system(self, system: Callable[[], System]) -> Callable[[], System]:
        """What makes a system of a mod for every session; one that cannot be made any more does nothing."""
        name = self.wrapped(system()).name
        what = tr("making the system '{name}'", name=name)

        def nothing() -> System:
            made = System()
            vars(made).update(name=name, unneeded=tr("its mod is switched off"), needs=lambda model: False)
            return made

        return self._made_anew(what, lambda: self.wrapped(system()), nothing)

    def _made_anew(self, what: str, make: Callable[[], T], nothing: Callable[[], T]) -> Callable[[], T]:
        """What makes something of a mod again and again, or nothing that does what it does not."""
        make_it = self.mod.guarded(what, make)
        return lambda: nothing() if (found := make_it()) is None else found

    def wrapped(self, made: System) -> System:
        """The system of a mod, wrapped so that it is left out once the mod is switched off.

        The commands of a frame system, or of an event, are one step of undo. If the system raises or takes too long,
        or leaves what a Field cannot take, such as NaN, its commands are dropped whole, and the columns that it declares
        in `writes` and `adds` are restored.
        """
        role = next((role for role in _ROLES if isinstance(made, role)), None)
        if role is None:
            name = type(made).__name__
            raise ModError(
                "{name} is not a System; derive it from a class in pinjoint.systems.base.", name=name
            )
        _check_declarations(made, role)
        made.mod, own = self.mod, vars(made)
        what, process = tr("the system '{name}'", name=made.name), made.process
        if isinstance(made, Law):  # finite, for each particle
            held = made.held_forces
            own["held_forces"] = lambda model: np.broadcast_to(
                np.asarray_chkfinite(held(model)), (model.particles.count, 2)
            )
        for name in ("needs", "arrays", "leaves_flight_exact", "cutoff", "held_forces"):
            if hasattr(role, name):
                asked = tr("{method} of '{name}'", method=name, name=made.name)
                declared, plain = result_of(getattr(role, name)), getattr(role, name)(made, None)
                own[name] = self.mod.guarded(asked, getattr(made, name), otherwise=plain, declared=declared)
        needs = own["needs"]
        own["needs"] = lambda model: needs(model) and not self.mod.off

        def frame_kept(frame: Any) -> object:
            with _view_kept(frame.session):
                return process(frame)

        if not isinstance(made, StepSystem):
            own["process"] = lambda frame: self._change_whole(
                made, what, frame.session.model, lambda: frame_kept(frame)
            )
        if isinstance(made, Event):
            happen = made.happen
            own["happen"] = lambda model, *elements: self._change_whole(
                made, what, model, lambda: happen(model, *elements)
            )
        return made

    def _change_whole(self, system: System, what: str, model: Model, change: Callable[[], object]) -> None:
        """Let a system change a model, by all of its commands or by none, and only to what Fields can take."""
        tables = {column.partition(".")[0] for column in (*system.writes, *system.adds)} & model.tables.keys()
        before = Snapshot.take(model, *tables) if tables else None

        def changed() -> bool:
            with model.transaction(system.title or system.name, of_mod=True):
                if self.mod.included:
                    change()
                else:
                    _interruptible(change, model)
                    for table in (model.tables[name] for name in tables):  # such as NaN, which no Field takes
                        for field in table.fields_in(Role.STATE):
                            if field.dtype is not object:
                                column: Column = table.column(field.name)
                                field.check_column(column, table.count, lambda row: model.describe(table[row]))  # noqa: B023
            return True

        if not self.mod.call(what, changed, otherwise=False, patience=PATIENCE) and before is not None:
            before.restore(model)

    def history(self, kind: HistoryKind) -> HistoryKind:
        """The history of a mod, whose Python functions switch the mod off if they fail."""

        functions: dict[str, Any] = {}
        for name, declared, otherwise in (
            ("check", None, None),
            ("ends", float, -math.inf),
            ("breaks", tuple[float, ...], ()),
            ("static", float, 0.0),
        ):
            if callable(own := getattr(kind, name)):
                what = tr("{method} of the history '{name}'", method=name, name=kind.name)
                mistakes = (FieldError,) if name == "check" else ()
                functions[name] = self.mod.guarded(
                    what, own, otherwise=otherwise, declared=declared, mistakes=mistakes
                )
        return replace(kind, **functions, mod=self.mod)

    def integrator(self, integrator: Integrator) -> Integrator:
        """The integrator of a mod, wrapped so that it is no longer chosen once the mod is switched off."""
        own = integrator.stable_step
        what = tr("the stable step of the integrator '{name}'", name=integrator.name)

        def checked(frequency: float, decay: float) -> float:
            size = own(frequency, decay)
            check(size, float, "it")
            if not size >= 0.0:
                raise WrongValue(
                    "it is {size} s; return a number of at least 0 (0: no step is stable)", size=str(size)
                )
            return size

        def stable_step(frequency: float, decay: float) -> float:
            size: float | None = self.mod.call(what, checked, frequency, decay)
            return VelocityVerlet.stable_step(frequency, decay) if size is None else size

        _check_declarations(integrator, Integrator)
        vars(integrator).update(mod=self.mod, stable_step=stable_step)
        return integrator

    def shape(self, kind: type[Handle], shape: Shape) -> Shape:
        """What elements of a mod's kind collide as, wrapped so that they are nothing if it fails."""
        nothing = Pieces(np.zeros((0, 2, 2)), np.zeros(0, dtype=np.intp))
        source = getattr(shape, "__name__", "its function")

        def pieces(table: Table[Any]) -> Pieces:
            made = shape(table)
            if not isinstance(made, Pieces):
                message = tr(
                    "{source} returned {value}; it must return Pieces.", source=source, value=quoted(made)
                )
                raise TypeError(message)
            check_fields(made, Pieces)
            made.check(table, source)
            return made

        return self.mod.guarded(tr("the shape of {table}", table=kind.table), pieces, otherwise=nothing)

    def checkers(self, fields: Iterable[Field[Any]]) -> None:
        """Let the checkers of a mod's Fields refuse values only by FieldError; without the mod, every value is kept."""
        for field in fields:
            if field.checker is not None:
                field.checker = partial(self._checked, field, field.checker)

    def _checked(self, field: Field[Any], own: Callable[[Any, str], Any], value: Any, where: str) -> Any:
        was_off, what = self.mod.off, tr("the checker of {field}", field=field.name)
        made = self.mod.call(what, own, value, where, otherwise=value, mistakes=(FieldError,))
        if self.mod.off and not was_off:
            raise FieldError(
                "{where}: {field} cannot be checked; {problem}",
                where=where,
                field=field.title,
                problem=self.mod.problem,
            )
        return made

    def action(self, name: str, function: Perform, title: str = "") -> Perform:
        """An action of a mod: one step of undo, called by its title, dropped whole if it fails."""
        what = tr("the action '{name}'", name=name)

        def act(context: Context, pixel: Vector) -> None:
            if self.mod.off:
                raise Refusal(
                    "The mod '{name}' is switched off: {problem}", name=self.mod.name, problem=self.mod.problem
                )
            self.mod.call(what, changed, context, pixel, mistakes=(Refusal, FieldError))

        def changed(context: Context, pixel: Vector) -> None:
            model = context.model
            with model.transaction(title or name, of_mod=True), _view_kept(context):
                _interruptible(lambda: function(context, pixel), model)

        return act

    def command(self, name: str, run: Callable[[list[str]], int]) -> Callable[[list[str]], int]:
        """A command of a mod for the command line, which may run as long as it likes."""
        what = tr("the command '{name}'", name=name)
        of_person = (UsageError, models.ModelError, FieldError, PathError, SystemExit)
        return self.mod.guarded(
            what, run, otherwise=BAD_INPUT, declared=int, patience=math.inf, mistakes=of_person
        )

    def layer(self, draw: Layer) -> Layer:
        """A layer of a mod, whose marks are cut to what is seen; what it adds to the sheet itself is not drawn."""
        called = tr("what the layer draws")

        def drawn(sheet: Sheet) -> list[Mark]:
            if self.mod.included:
                return list(draw(sheet))
            made = draw(replace(sheet, marks=list(sheet.marks), labels=[], legend=[], notes=[]))
            check(made, Iterable[Mark], called)
            marks = list(islice(made, _MOST_MARKS + 1))
            if len(marks) > _MOST_MARKS:
                raise WrongValue(
                    "{called} has more than {count:,} entries; give fewer", called=called, count=_MOST_MARKS
                )
            for mark in marks:
                check(mark, Mark, called)
            return [part for mark in marks for part in framed(mark, sheet.viewport, sheet.unit)]

        return self.mod.guarded(tr("its drawing layer"), drawn, otherwise=[])

    def panel(self, read: Panel) -> Callable[[Context], Sequence[Readout]]:
        """The panels that a function of a mod makes, as several or none."""
        called = tr("what {function} returned", function=getattr(read, "__name__", "a panel"))

        def readouts(context: Context) -> Sequence[Readout]:
            made = read(context)
            check(made, Readout | Sequence[Readout] | None, called)
            several = () if made is None else (made,) if isinstance(made, Readout) else made
            return tuple(map(_checked_readout, several))

        return self.mod.guarded(tr("its panel"), readouts, otherwise=())

    def scene(self, kind: type[Scene], usual: type[Scene]) -> Callable[[], Scene]:
        """What makes the scene of a mod for every session; once the mod is switched off it does nothing and leads to pause.

        Where a method of it fails, that of all scenes (`usual`) takes its place; what cannot be shown is empty.
        """
        _check_declarations(kind, usual)
        methods = {name for name, method in vars(usual).items() if callable(method) and name[0] != "_"}
        kind()  # raises here what it would raise in every session
        what = tr("the scene '{name}'", name=kind.name)

        def asked(scene: Scene, name: str, *arguments: Any) -> Any:
            own = super(guarded, scene).__getattribute__(name)
            declared = _READ.get(name) or result_of(getattr(usual, name))
            made = own if name in _READ else own(*arguments)
            called = name if name in _READ else tr("what {function} returned", function=name)
            if declared is None:
                check_has_run(made, called)
                return None
            check(made, declared, called)
            return _shown(made)

        def answer(scene: Scene, name: str, *arguments: Any) -> Any:
            mistakes = (LookupError,) if name == "click_box" else ()
            made = self.mod.call(what, asked, scene, name, *arguments, otherwise=self.mod, mistakes=mistakes)
            return getattr(usual, name)(scene, *arguments) if made is self.mod else made

        def read(scene: Scene, name: str) -> Any:
            if name in methods:
                return partial(answer, scene, name)
            if name in _READ:
                return self.mod.call(what, asked, scene, name, otherwise={} if name == "boxes" else "")
            return super(guarded, scene).__getattribute__(name)

        guarded: type[Scene] = type(kind.__name__, (kind,), {"__getattribute__": read, "mod": self.mod})
        plain: type[Scene] = type(
            kind.__name__, (usual,), {"name": kind.name, "sources": kind.sources, "mod": self.mod}
        )
        return self._made_anew(tr("making the scene '{name}'", name=kind.name), guarded, plain)


# --- what is looked at ---------------------------------------------------------------------------------------


def _check_declarations(made: Any, role: type) -> None:
    """Raise ModError or TypeError if class attributes are not of the types that the role declares."""
    for name, hint in get_type_hints(role).items():
        if get_origin(hint) is ClassVar:
            called = f"{(made if isinstance(made, type) else type(made)).__name__}.{name}"
            if isinstance(getattr_static(made, name, None), property):  # might answer otherwise, or fail, later
                raise ModError("{name} is a property; give the value itself.", name=called)
            check(getattr(made, name, None), get_args(hint)[0], called)


@contextmanager
def _view_kept(context: Context) -> Iterator[None]:
    """Put the view and the notice back if the body raises, or leaves in them what cannot be shown."""
    view, notice = context.view, context.notice
    attributes, camera = dict(vars(view)), copy(view.camera)
    try:
        yield
        _check_view(context.view, attributes if context.view is view else {})
        check(context.notice, str, tr("the session's notice"))
    except BaseException:
        vars(view).update(attributes, camera=camera)
        context.view, context.notice = view, notice
        raise


def _check_view(view: View, shown: Mapping[str, Any]) -> None:
    """Raise TypeError or ValueError if a view holds what cannot be shown, beside what it showed before."""
    check_fields(view, View, shown)
    numbers = (*view.camera.centre, view.camera.scale, view.pixel_ratio)
    if not (all(map(math.isfinite, numbers)) and view.camera.scale > 0.0 < view.pixel_ratio):
        raise WrongValue(
            "the view's camera is at {centre} with {scale} pixels per metre; give finite numbers, and a scale above 0",
            centre=str(numbers[:2]),
            scale=str(numbers[2]),
        )


def _interruptible(change: Callable[[], object], model: Model) -> None:
    """Run what changes a model by commands, and restore entities that it deleted past the tables.

    A command is never interrupted; code that does nothing but give commands is stopped before the first one that is late.
    """
    model.before_command = check_limit
    try:
        check_has_run(change(), tr("what it returned"))
    finally:
        model.before_command = None
        model.check_entities()


def _checked_readout(readout: Readout) -> Readout:
    """A readout whose texts can be printed. Raises ValueError for curves that cannot be drawn, and for what closes it
    and is no action.
    """
    rows = tuple((readable(tr(name)), readable(value)) for name, value in readout.rows)
    if readout.closes and readout.closes not in ACTIONS:
        raise WrongValue(
            "the panel '{title}' names '{action}' to close it; there is no such action",
            title=readout.title,
            action=readout.closes,
        )
    plot = readout.plot and _checked_plot(readout.plot)
    return Readout(readable(tr(readout.title)), rows, plot, readout.closes)


def _checked_plot(plot: Plot) -> Plot:
    for name, x, y in plot.curves:
        if x.ndim != 1 or x.shape != y.shape:
            raise WrongValue(
                "the curve '{name}' has x of shape {x} and y of shape {y}; both must be (n,)",
                name=name,
                x=str(x.shape),
                y=str(y.shape),
            )
    curves = tuple((readable(tr(name)), x, y) for name, x, y in plot.curves)
    return replace(plot, x_title=readable(tr(plot.x_title)), y_title=readable(tr(plot.y_title)), curves=curves)


def readable(text: str) -> str:
    """A text of a mod as it can be shown."""
    return Said(printable(text[:LONGEST]), readable, text)


def _shown(made: Any) -> Any:
    """What a scene shows. Raises TypeError for a View with what cannot be drawn."""
    if isinstance(made, str):
        return readable(made)
    for view in made if isinstance(made, list | tuple) else ():
        if isinstance(view, tuple):  # a stage
            _shown(view)
        elif isinstance(view, View):
            _check_view(view, {})
    return made
