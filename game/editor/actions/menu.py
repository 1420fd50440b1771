"""Actions of menus and of the mouse alone: opening a menu, going through it, and what it offers that no key does."""

from __future__ import annotations

from dataclasses import replace

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.menu import Menu
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.editor.actions.editing import all_of
from pinjoint.editor.context import ACTIONS, Action, Context, action
from pinjoint.editor.gestures.drawing import Drawing
from pinjoint.editor.menu import menu_at
from pinjoint.editor.scenes.force_method import ForceMethod
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import pick
from pinjoint.systems.edit.supports import SUPPORTS, Held, support
from pinjoint.systems.input.bindings import LIVE
from pinjoint.systems.render.menu import menu_of
from pinjoint.systems.render.symbol_at import symbol_at


@action("open menu", while_drawing=True)
def _open_menu(context: Context, pixel: Vector) -> None:
    """The menu of what is under the pointer, which is selected; a drawing, or a tool in hand, is ended instead."""
    if context.cancel_gesture():
        return
    if context.scene in LIVE:
        model, view = context.model, context.view
        hit = pick(model, view, pixel) or symbol_at(model, view, pixel)
        if hit is None:
            context.select()
        elif hit not in context.selected:
            context.select(hit)
    context.view.menu = menu_at(context, pixel)


@action("more tools", while_drawing=True)
def _more_tools(context: Context, pixel: Vector) -> None:
    """The tools for which the toolbar has no room."""
    view = context.view
    groups = view.toolbar.folded(view.camera.viewport, view.pixel_ratio)
    context.view.menu = Menu("", groups, pixel, pointed=pixel) if groups else None


def _to_entry(way: str) -> Action:
    """An arrow key in an open menu."""

    def act(context: Context, pixel: Vector) -> None:
        layout = menu_of(context.view)
        if layout is None:
            return
        here, count = layout.pointed_at(pixel), len(layout.entries)
        if way in ("up", "down"):
            chosen = (here + 1) % count if way == "down" else (max(here, 0) - 1) % count
        else:
            chosen = layout.beside(here, 1 if way == "right" else -1)
        context.view.menu = replace(layout.menu, chosen=chosen, pointed=pixel)

    return act


for _way in ("up", "down", "left", "right"):
    action(f"menu {_way}", while_drawing=True)(_to_entry(_way))


@action("close menu", while_drawing=True)
def _close_menu(context: Context, pixel: Vector) -> None:
    context.view.menu = None


@action("choose entry", while_drawing=True)
def _choose_nothing(context: Context, pixel: Vector) -> None:
    """A press that comes to no entry, or to one that would do nothing; others perform the action of the entry."""


@action("open", while_drawing=True)
def _open(context: Context, pixel: Vector) -> None:
    """A double click: the properties of what it hits; it ends a chain of rods, and with a tool is another click."""
    if isinstance(context.gesture, Drawing) and context.gesture.goes_on:
        context.gesture = None
    elif isinstance(context.gesture, Drawing) or context.view.tool:
        ACTIONS["select"](context, pixel)
    elif (
        hit := pick(context.model, context.view, pixel) or symbol_at(context.model, context.view, pixel)
    ) is not None:
        if hit not in context.selected:
            context.select(hit)
        ACTIONS["properties"](context, pixel)


@action("environment")
def _environment(context: Context, pixel: Vector) -> None:
    context.select()
    ACTIONS["properties"](context, pixel)


def _hold(wanted: Held) -> Action:
    """Give all selected particles a support."""

    def act(context: Context, pixel: Vector) -> None:
        particles = context.selected_of(Particle)
        if not particles:
            raise Refusal("No particle is selected; click one first.")
        named = support(context.model, particles, wanted)
        context.notice = tr("{element}: {value}", element=all_of(context, particles), value=tr(named))

    return act


for _name, _wanted in SUPPORTS.items():
    action(_name)(_hold(_wanted))


@action("toggle cable")
def _toggle_cable(context: Context, pixel: Vector) -> None:
    """Let the selected rods bear tension only, or if all do so, compression as well."""
    rods = context.selected_of(Rod)
    if not rods:
        raise Refusal("No rod is selected; click one first.")
    cable = not all(rod.tension_only for rod in rods)
    context.model.assign(rods, "tension_only", cable)
    bears = tr("tension only, as a cable") if cable else tr("tension and compression")
    context.notice = tr("{element}: {value}", element=all_of(context, rods), value=bears)


@action("release")
def _release(context: Context, pixel: Vector) -> None:
    """Begin the force method with the selected rod as the static unknown."""
    rods, scene = context.selected_of(Rod), context.scenes["force method"]
    if len(rods) != 1:
        raise Refusal("Select one rod only: the one that is to be released.")
    assert isinstance(scene, ForceMethod)
    scene.first_unknown = rods[0].name
    context.scenes.request("force method")
