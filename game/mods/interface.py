"""Guards around what mods let a person see and do: scenes, actions, commands, layers and panels."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

from pinjoint.commands.arguments import BAD_INPUT, UsageError
from pinjoint.components.field import FieldError, Vector
from pinjoint.components.language import Said, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.view import Plot, Readout, View
from pinjoint.components.wording import printable
from pinjoint.documents import models
from pinjoint.editor.context import Context, Scene
from pinjoint.mods.declared import check, check_has_run, result_of
from pinjoint.mods.guard import check_declarations, check_view, interruptible, made_anew, view_kept
from pinjoint.mods.mod import INCLUDED, Mod
from pinjoint.paths import PathError
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import ACTIONS, Perform
from pinjoint.systems.render.framing import framed
from pinjoint.systems.render.marks import Mark
from pinjoint.systems.render.sheet import Layer, Sheet

Panel = Callable[[Context], Readout | Sequence[Readout] | None]

MISTAKES = (UsageError, models.ModelError, FieldError, PathError, SystemExit)  # of a person at the command line
LONGEST = 400  # characters of a text in the window
MOST_MARKS = 1_000_000  # of a layer: an iterator may have no end, in code that nothing interrupts


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
            interruptible(lambda: function(context, pixel), model)

    return act


def guarded_command(mod: Mod, name: str, run: Callable[[list[str]], int]) -> Callable[[list[str]], int]:
    """A command of a mod for the command line, which may run as long as it likes."""
    what = tr("the command '{name}'", name=name)
    return mod.guarded(
        what, run, otherwise=BAD_INPUT, declared=int, patience=math.inf, mistakes=MISTAKES
    )  # of a list of its own


# --- what is seen ------------------------------------------------------------------------------------------


def guarded_layer(mod: Mod, draw: Layer) -> Layer:
    """A layer of a mod, whose marks are cut to what is seen; what it adds to the sheet itself is not drawn."""
    called = tr("what the layer draws")

    def drawn(sheet: Sheet) -> list[Mark]:
        if mod.source == INCLUDED:
            return list(draw(sheet))
        made = draw(replace(sheet, marks=list(sheet.marks), labels=[], legend=[], notes=[]))
        check(made, Iterable[Mark], called)
        marks = list(islice(made, MOST_MARKS + 1))
        if len(marks) > MOST_MARKS:
            raise WrongValue(
                "{called} has more than {count:,} entries; give fewer", called=called, count=MOST_MARKS
            )
        for mark in marks:
            check(mark, Mark, called)
        return [part for mark in marks for part in framed(mark, sheet.viewport, sheet.unit)]

    return mod.guarded(tr("its drawing layer"), drawn, otherwise=[])


def guarded_panel(mod: Mod, read: Panel) -> Callable[[Context], Sequence[Readout]]:
    """The panels that a function of a mod makes, as several or none."""
    called = tr("what {function} returned", function=getattr(read, "__name__", "a panel"))

    def readouts(context: Context) -> Sequence[Readout]:
        made = read(context)
        check(made, Readout | Sequence[Readout] | None, called)
        several = () if made is None else (made,) if isinstance(made, Readout) else made
        return tuple(map(_checked_readout, several))

    return mod.guarded(tr("its panel"), readouts, otherwise=())


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


# --- scenes ------------------------------------------------------------------------------------------------


_METHODS = {name for name, method in vars(Scene).items() if callable(method) and name[0] != "_"}
_READ = {"heading": str, "message": str, "boxes": dict[str, str]}  # as attributes or properties


def guarded_scene(mod: Mod, kind: type[Scene]) -> Callable[[], Scene]:
    """What makes the scene of a mod for every session; once the mod is switched off it does nothing and leads to pause.

    Where a method of it fails, that of all scenes takes its place; what cannot be shown is empty.
    """
    check_declarations(kind, Scene)
    kind()  # raises here what it would raise in every session
    what = tr("the scene '{name}'", name=kind.name)

    def asked(scene: Scene, name: str, *arguments: Any) -> Any:
        own = super(guarded, scene).__getattribute__(name)
        declared = _READ.get(name) or result_of(getattr(Scene, name))
        made = own if name in _READ else own(*arguments)
        called = name if name in _READ else tr("what {function} returned", function=name)
        if declared is None:
            check_has_run(made, called)
            return None
        check(made, declared, called)
        return _shown(made)

    def answer(scene: Scene, name: str, *arguments: Any) -> Any:
        mistakes = (LookupError,) if name == "click_box" else ()
        made = mod.call(what, asked, scene, name, *arguments, otherwise=mod, mistakes=mistakes)
        return getattr(Scene, name)(scene, *arguments) if made is mod else made

    def read(scene: Scene, name: str) -> Any:
        if name in _METHODS:
            return partial(answer, scene, name)
        if name in _READ:
            return mod.call(what, asked, scene, name, otherwise={} if name == "boxes" else "")
        return super(guarded, scene).__getattribute__(name)

    guarded: type[Scene] = type(kind.__name__, (kind,), {"__getattribute__": read, "mod": mod})
    plain: type[Scene] = type(kind.__name__, (Scene,), {"name": kind.name, "sources": kind.sources, "mod": mod})
    return made_anew(mod, tr("making the scene '{name}'", name=kind.name), guarded, plain)


def _shown(made: Any) -> Any:
    """What a scene shows. Raises TypeError for a View with what cannot be drawn."""
    if isinstance(made, str):
        return readable(made)
    for view in made if isinstance(made, list | tuple) else ():
        if isinstance(view, tuple):  # a stage
            _shown(view)
        elif isinstance(view, View):
            check_view(view, {})
    return made
