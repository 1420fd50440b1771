"""Actions of menus: going through one, and what they offer that no key does."""

from __future__ import annotations

from dataclasses import replace
from operator import attrgetter

from pinjoint.components.field import Vector
from pinjoint.components.language import marked, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.editor.actions.editing import all_of
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.force_method import ForceMethod
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.dividing import DIVISIONS, divide, divide_at
from pinjoint.systems.edit.picking import pick_rod
from pinjoint.systems.edit.placing import snapped
from pinjoint.systems.edit.rods import share_at
from pinjoint.systems.edit.supports import SUPPORTS, Held, held, support
from pinjoint.systems.edit.weight import weigh_along
from pinjoint.systems.input.actions import ACTIONS, MENU, PAUSE, Perform, actions_of
from pinjoint.systems.render.menu import entry_beside, pointed_at
from pinjoint.systems.render.theme import load_theme

action = actions_of("Menu", (MENU,), while_drawing=True, in_menu=True)
offer = actions_of("Menu")  # without a key


def _to_entry(way: str) -> Perform:
    """An arrow key in an open menu."""

    def act(context: Context, pixel: Vector) -> None:
        view, menu = context.view, context.view.menu
        if menu is None:
            return
        theme = load_theme(view.theme)
        here, count = pointed_at(view, theme, pixel), len(menu.entries)
        if way in ("up", "down"):
            chosen = (here + 1) % count if way == "down" else (max(here, 0) - 1) % count
        else:
            chosen = entry_beside(view, theme, here, 1 if way == "right" else -1)
        view.menu = replace(menu, chosen=chosen, pointed=pixel)

    return act


action("menu up", "up", "go to the entry above", repeats=True)(_to_entry("up"))
action("menu down", "down", "go to the entry below", repeats=True)(_to_entry("down"))
action("menu left", "left", "go to the column on the left", repeats=True)(_to_entry("left"))
action("menu right", "right", "go to the column on the right", repeats=True)(_to_entry("right"))


@action("choose entry", "click", "choose the entry; outside, close the menu")
@action("choose entry", "return", "choose the entry")
def _choose_nothing(context: Context, pixel: Vector) -> None:
    """A press that comes to no entry, or to one that would do nothing; others perform the action of the entry."""


@action("close menu", "escape", "close the menu", in_menu=False)
def _close_menu(context: Context, pixel: Vector) -> None:
    context.view.menu = None


@offer("environment", "", "open the properties of the environment")
def _environment(context: Context, pixel: Vector) -> None:
    context.select()
    ACTIONS["properties"].perform(context, pixel)


def _support(name: str, title: str) -> None:
    """The action that gives all selected particles a support."""
    wanted: Held = SUPPORTS[name]

    def is_held(context: Context) -> bool:
        particles = context.selected_of(Particle)
        return bool(particles) and all(held(particle) == wanted for particle in particles)

    @offer(name, "", title, pressed=is_held)
    def act(context: Context, pixel: Vector) -> None:
        particles = context.selected_of(Particle)
        if not particles:
            raise Refusal("No particle is selected; click one first.")
        named = support(context.model, particles, wanted)
        context.notice = tr("{element}: {value}", element=all_of(context, particles), value=tr(named))


_support("free", marked("free: no support"))
_support("pin", marked("pinned: held in x and y"))
_support("hold y", marked("roller: held in y"))
_support("hold x", marked("roller: held in x"))
_support("clamp", marked("clamped: held in x and y, cannot turn"))
_support("guide y", marked("guided: held in y, cannot turn"))
_support("guide x", marked("guided: held in x, cannot turn"))
_support("hold rotation", marked("cannot turn, free in x and y"))


def _selected(context: Context) -> list[Rod]:
    rods = context.selected_of(Rod)
    if not rods:
        raise Refusal("No rod is selected; click one first.")
    return rods


@offer("split", "", "divide the rod here")
def _split(context: Context, pixel: Vector) -> None:
    """Divide the rod under the pointer there, at a line of the grid if one is near."""
    rod = pick_rod(context.model, context.view, pixel)
    if rod is None:
        raise Refusal("There is no rod under the pointer; point at one.")
    name, point = context.name(rod), snapped(context.model, context.view, context.view.camera.to_model(pixel))
    parts = divide_at(context.model, rod, [round(share_at(rod, point), 6)])
    context.select(parts[0].ends[1])
    context.notice = tr("{rod}: divided at {particle}", rod=name, particle=parts[0].ends[1].name)


@offer("weight along", "", "add its weight as a distributed load", enabled=attrgetter("model.rods.count"))
def _weight_along(context: Context, pixel: Vector) -> None:
    """Let the selected rods, without any all, bear their weight along them."""
    context.notice = weigh_along(context.model, context.selected_of(Rod) or list(context.model.rods))


def _are_cables(context: Context) -> bool:
    rods = context.selected_of(Rod)
    return bool(rods) and all(rod.tension_only for rod in rods)


@offer("toggle cable", "", "cable: tension only", pressed=_are_cables)
def _toggle_cable(context: Context, pixel: Vector) -> None:
    """Let the selected rods bear tension only, or if all do so, compression as well."""
    rods = context.selected_of(Rod)
    if not rods:
        raise Refusal("No rod is selected; click one first.")
    cable = not all(rod.tension_only for rod in rods)
    context.model.assign(rods, "tension_only", cable)
    bears = tr("tension only, as a cable") if cable else tr("tension and compression")
    context.notice = tr("{element}: {value}", element=all_of(context, rods), value=bears)


def _can_divide(context: Context) -> bool:
    return any(rod.bending_stiffness > 0.0 for rod in context.selected_of(Rod))


def _divide(parts: int) -> Perform:
    """Divide the selected rods, and select their parts."""

    def act(context: Context, pixel: Vector) -> None:
        rods = _selected(context)
        named = all_of(context, rods)
        context.select(*divide(context.model, rods, parts))
        context.notice = (
            tr("{rod}: divided into {parts} parts", rod=named, parts=parts)
            if len(rods) == 1
            else tr("{rods}: each divided into {parts} parts", rods=named, parts=parts)
        )

    return act


for _parts, _title in DIVISIONS.items():
    offer(_title, "", _title, enabled=_can_divide)(_divide(_parts))


@offer("release", "", "release it in the force method", (PAUSE,))
def _release(context: Context, pixel: Vector) -> None:
    """Begin the force method with the selected rod as the static unknown."""
    rods, scene = context.selected_of(Rod), context.scenes["force method"]
    if len(rods) != 1:
        raise Refusal("Select one rod only: the one that is to be released.")
    assert isinstance(scene, ForceMethod)
    scene.first_unknown = rods[0].name
    context.scenes.request("force method")
