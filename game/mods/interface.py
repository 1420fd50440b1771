"""Guards around what mods let a person see and do: scenes, actions, commands, layers and panels."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from inspect import getattr_static
from typing import Any

from pinjoint.commands.arguments import BAD_INPUT, UsageError
from pinjoint.components.field import FieldError, Vector
from pinjoint.components.language import english, in_both, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.view import Plot, Readout, View
from pinjoint.components.wording import printable
from pinjoint.documents import models
from pinjoint.editor.context import Context, Scene
from pinjoint.mods.declared import as_declared, result_of
from pinjoint.mods.guard import check_view, interruptible, view_kept
from pinjoint.mods.mod import INCLUDED, PATIENCE, Mod
from pinjoint.paths import PathError
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import ACTIONS, Perform
from pinjoint.systems.render.framing import framed
from pinjoint.systems.render.marks import Mark
from pinjoint.systems.render.sheet import Layer, Sheet

Panel = Callable[[Context], Readout | Sequence[Readout] | None]

MISTAKES = (UsageError, models.ModelError, FieldError, PathError, SystemExit)  # of a person at the command line
LONGEST = 400  # characters of a text in the window


# --- what is done ----------------------------------------------------------------------------------------


def guarded_action(mod: Mod, name: str, function: Perform) -> Perform:
    """An action of a mod: one step of undo, dropped whole if it fails."""
    what = tr("the action '{name}'", name=name)

    def act(context: Context, pixel: Vector) -> None:
        if mod.off:
            raise Refusal("The mod '{name}' is switched off: {problem}", name=mod.name, problem=mod.problem)
        mod.call(what, changed, context, pixel, mistakes=(Refusal, FieldError))

    def changed(context: Context, pixel: Vector) -> None:
        model = context.model
        with model.transaction(name), view_kept(context):
            interruptible(lambda: function(context, pixel), model, PATIENCE)

    return act


def guarded_command(mod: Mod, name: str, run: Callable[[list[str]], int]) -> Callable[[list[str]], int]:
    """A command of a mod for the command line, which may run as long as it likes."""

    def command(words: list[str]) -> int:
        status: int = mod.call(
            tr("the command '{name}'", name=name),
            run,
            list(words),
            otherwise=BAD_INPUT,
            declared=int,
            patience=math.inf,
            mistakes=MISTAKES,
        )
        return status

    return command


# --- what is seen ------------------------------------------------------------------------------------------


def guarded_layer(mod: Mod, draw: Layer) -> Layer:
    """A layer of a mod, whose marks are cut to what is seen; what it adds to the sheet itself is not drawn."""

    def drawn(sheet: Sheet) -> list[Mark]:
        if mod.source == INCLUDED:
            return list(draw(sheet))
        own = replace(sheet, marks=list(sheet.marks), labels=[], legend=[], notes=[])
        marks = as_declared(draw(own), Iterable[Mark], tr("what the layer draws"))
        return [part for mark in marks for part in framed(mark, sheet.viewport, sheet.unit)]

    return lambda sheet: mod.call(tr("its drawing layer"), drawn, sheet, otherwise=[])


def guarded_panel(mod: Mod, read: Panel) -> Callable[[Context], Sequence[Readout]]:
    """The panels that a function of a mod makes, as several or none."""
    called = tr("what {function} returned", function=getattr(read, "__name__", "a panel"))

    def readouts(context: Context) -> Sequence[Readout]:
        made = as_declared(read(context), Readout | Sequence[Readout] | None, called)
        several = () if made is None else (made,) if isinstance(made, Readout) else made
        return tuple(map(_checked_readout, several))

    return lambda context: mod.call(tr("its panel"), readouts, context, otherwise=())


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
    return in_both(printable(text[:LONGEST]), printable(str(english(text))[:LONGEST]))


# --- scenes ------------------------------------------------------------------------------------------------


_METHODS = tuple(name for name, method in vars(Scene).items() if callable(method) and name[0] != "_")
_READ = ("heading", "message", "boxes")  # as attributes or properties
_CLASS = {"name": str, "targets": tuple[str, ...], "sources": tuple[str, ...], "systems": tuple[str, ...]}


def guarded_scene(mod: Mod, kind: type[Scene]) -> Callable[[], Scene]:
    """What makes the scene of a mod for every session; once the mod is switched off it does nothing and leads to pause."""
    for name, declared in _CLASS.items():
        as_declared(getattr(kind, name, None), declared, f"{kind.__name__}.{name}")
    kind()  # raises here what it would raise in every session
    guards: dict[str, Any] = {name: _guarded_method(mod, kind, name) for name in _METHODS}
    guards |= {name: _guarded_property(mod, kind, name) for name in _READ}
    guarded: type[Scene] = type(kind.__name__, (kind,), {**guards, "mod": mod})
    plain: type[Scene] = type(kind.__name__, (Scene,), {"name": kind.name, "sources": kind.sources, "mod": mod})

    def make() -> Scene:
        made = mod.call(tr("making the scene '{name}'", name=kind.name), guarded)
        return made if made is not None else plain()

    return make


def _guarded_method(mod: Mod, kind: type[Scene], name: str) -> Callable[..., Any]:
    """A method of a scene; if it fails, that of all scenes takes its place."""
    own, plain = getattr(kind, name), getattr(Scene, name)
    declared = result_of(plain)
    mistakes = (LookupError,) if name == "click_box" else ()

    def asked(scene: Scene, *arguments: Any) -> Any:
        made = as_declared(own(scene, *arguments), declared, tr("what {function} returned", function=name))
        return None if declared is None else _shown(made)

    def method(scene: Scene, *arguments: Any) -> Any:
        what = tr("the scene '{name}'", name=kind.name)
        made = mod.call(what, asked, scene, *arguments, otherwise=mod, mistakes=mistakes)
        return plain(scene, *arguments) if made is mod else made

    return method


def _guarded_property(mod: Mod, kind: type[Scene], name: str) -> property:
    """An attribute or property of a scene that is read; if it cannot be shown, it is empty."""
    own, plain = getattr_static(kind, name), getattr_static(Scene, name)
    declared = result_of(plain.fget) if isinstance(plain, property) and plain.fget else type(plain)
    empty: Any = {} if name == "boxes" else ""

    def asked(scene: Scene) -> Any:
        made = own.__get__(scene) if isinstance(own, property) else vars(scene).get(name, own)
        return _shown(as_declared(made, declared, name))

    def write(scene: Scene, value: Any) -> None:
        if isinstance(own, property):
            own.__set__(scene, value)
        else:
            vars(scene)[name] = value

    what = tr("the scene '{name}'", name=kind.name)
    return property(lambda scene: mod.call(what, asked, scene, otherwise=empty), write)


def _shown(made: Any) -> Any:
    """What a scene shows. Raises TypeError for a View with what cannot be drawn."""
    if isinstance(made, str):
        return readable(made)
    for view in made if isinstance(made, tuple) else ():
        if isinstance(view, tuple):  # a stage
            _shown(view)
        elif isinstance(view, View):
            check_view(view)
    return made
