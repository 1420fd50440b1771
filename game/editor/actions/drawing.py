"""Actions that draw: particles, rods and their ends, supports, arrows, grids."""

from __future__ import annotations

from operator import attrgetter

from pinjoint.components import written
from pinjoint.components.field import Vector
from pinjoint.components.grid import Grid
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import HUBS
from pinjoint.components.tags import Selected
from pinjoint.editor.context import Context, tell
from pinjoint.editor.gestures.drawing import (
    DrawForce,
    DrawMoment,
    DrawRod,
    DrawSpanLoad,
    DrawVelocity,
    onto_member,
    take_up,
    tool_in_hand,
)
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import pick_end, pick_particle, pick_rod
from pinjoint.systems.edit.placing import place, snapped
from pinjoint.systems.edit.rods import is_rigid, set_rigid, share_at, toggle_hinge, toggle_joint
from pinjoint.systems.edit.supports import next_support
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.input.actions import actions_of

action = actions_of("Draw")


def _free(context: Context, pixel: Vector) -> Vector | None:
    """The point (m) under a pixel, on the grid if near it; None on a particle."""
    model, view = context.model, context.view
    taken = pick_particle(model, view, pixel) is not None
    return None if taken else snapped(model, view, view.camera.to_model(pixel))


@action(
    "place",
    "p",
    "draw a particle",
    while_drawing=True,
    begins=_free,
    hint=marked("click where you want particles     Esc done"),
)
def _place(context: Context, pixel: Vector) -> None:
    """A particle under the pointer; from the toolbar, under the clicks that follow."""
    if context.view.strip.contains(pixel):
        take_up(context, "place")
        return
    model, view = context.model, context.view
    particle = place(model, view, snapped(model, view, view.camera.to_model(pixel)))
    tell(context, written.place(particle.position, written.DIGITS), particle)


# The status line names the kind of rods, too.
action(
    "rod",
    "l",
    "draw a rod between two particles",
    while_drawing=True,
    draws=DrawRod.begin_anywhere,
    begins=lambda context, pixel: _free(context, pixel) and onto_member(context, pixel),
)(DrawRod.use)


def _are_rigid(context: Context) -> bool:
    """Whether the selected rods, or else those that will be drawn, are rigid at both ends."""
    rods = [] if tool_in_hand(context) == DrawRod.tool else context.model.tagged(Selected, Rod)
    return all(is_rigid(rod, end) for rod in rods for end in (0, 1)) if rods else context.view.rigid


@action(
    "rigid", "ctrl+r", "draw frame rods, or make selected rods rigid", while_drawing=True, pressed=_are_rigid
)
def _rigid(context: Context, pixel: Vector) -> None:
    """Make the selected rods rigid at both ends, or pinned if they are so; without any, draw such rods.

    In an empty model it always leads to rods that bend, as its card promises, also where these were the last drawn.
    """
    drawing = DrawRod.tool in (tool_in_hand(context), context.view.tool)
    rods = [] if drawing else context.model.tagged(Selected, Rod)
    if not rods:
        context.view.rigid = not (context.view.rigid and (drawing or context.model.rods.count))
        if isinstance(context.gesture, DrawRod):
            context.gesture.say(context)
        elif context.view.rigid and not drawing:
            take_up(context, DrawRod.tool)
        context.notice = (
            tr("New rods will be rigid at both ends.")
            if context.view.rigid
            else tr("New rods will be pinned at both ends.")
        )
        return
    ends = [(rod, end) for rod in rods for end in (0, 1)]
    rigid = not all(is_rigid(*end) for end in ends)
    set_rigid(context.model, ends, rigid, tr("rigid joints") if rigid else tr("hinges"))
    context.view.rigid = rigid
    named, section = begun(heading(context.model, rods)), rods[0].section
    if not rigid:
        context.notice = tr("{rods}: pinned at both ends", rods=named)
    elif section is None:
        context.notice = tr("{rods}: rigid at both ends", rods=named)
    else:
        context.notice = tr("{rods}: rigid at both ends, {section}", rods=named, section=section)


@action("joining", "ctrl+t", "join rods to members that they meet, or cross these", while_drawing=True)
def _joining(context: Context, pixel: Vector) -> None:
    context.view.joins = not context.view.joins
    if isinstance(context.gesture, DrawRod):
        context.gesture.say(context)
    context.notice = (
        tr("New rods will be joined to members that they meet.")
        if context.view.joins
        else tr("New rods will cross members that they meet.")
    )


@action(
    "hinge",
    "ctrl+j",
    "hinge an end of a rod, or make it rigid",
    while_drawing=True,
    enabled=attrgetter("model.rods.count"),
    hint=marked("click near a rod's end: hinged or rigid     at a joint: all rods there     Esc done"),
)
def _hinge(context: Context, pixel: Vector) -> None:
    """Hinge the rod's end under the pointer, or make it rigid; at a particle all ends there; else take up the tool."""
    model, view = context.model, context.view
    if (particle := pick_particle(model, view, pixel)) is not None:
        tell(context, tr(toggle_joint(model, particle)), particle)
    elif (end := _end_at(context, pixel)) is not None:
        tell(context, tr(toggle_hinge(model, *end)), end[0])
    elif view.tool == "hinge" and not view.covers(pixel):
        raise Refusal(
            "Click near the end of a rod, where a ring appears, or on a joint. Esc puts the tool away."
        )
    else:
        take_up(context, "hinge")


def _end_at(context: Context, pixel: Vector) -> tuple[Rod, int] | None:
    """The end of a rod near a pixel; in a menu of one rod, the nearer one."""
    found = pick_end(context.model, context.view, pixel)
    rods = context.model.tagged(Selected, Rod)
    if found is None and context.view.tool != "hinge" and len(rods) == 1:
        rod = pick_rod(context.model, context.view, pixel)
        share = share_at(rods[0], context.view.camera.to_model(pixel))
        return (rods[0], int(share > 0.5)) if rod is rods[0] else None
    return found


@action(
    "support",
    "c",
    "add or change a support",
    enabled=attrgetter("model.particles.count"),
    hint=marked("supports: drag from a particle to its ground, or click for the next kind     Esc done"),
)
def _support(context: Context, pixel: Vector) -> None:
    """The next support of the particle under the pointer, else of the selected ones; without any, take up the tool."""
    hit = pick_particle(context.model, context.view, pixel)
    chosen = context.model.tagged(Selected, Particle)
    if hit is not None and hit not in chosen:
        chosen = [hit]
    if not chosen:
        take_up(context, "support")
        return
    tell(context, tr(next_support(context.model, chosen)), *chosen)


action(
    "force",
    "f",
    "draw a load on a particle or a rod",
    while_drawing=True,
    draws=DrawForce.begin,
    enabled=attrgetter("model.particles.count"),
    hint=marked("loads: drag an arrow from a particle     from a rod: a distributed load     F or Esc done"),
)(DrawForce.use)
action(
    "span load",
    "ctrl+f",
    "draw a load at a place of a rod",
    while_drawing=True,
    draws=DrawSpanLoad.begin,
    enabled=attrgetter("model.rods.count"),
    hint=marked("loads between ends: click on a rod where one acts or begins     Esc done"),
)(DrawSpanLoad.use)
action(
    "moment",
    "ctrl+m",
    "draw a moment on a particle or a rod",
    while_drawing=True,
    draws=DrawMoment.begin,
    enabled=attrgetter("model.particles.count"),
    hint=marked("moments: drag from a particle or a rod, to the left for counter-clockwise     Esc done"),
)(DrawMoment.use)
action(
    "velocity",
    "v",
    "draw the velocity of a particle",
    while_drawing=True,
    draws=DrawVelocity.begin,
    enabled=attrgetter("model.particles.count"),
    hint=marked("velocities: drag an arrow from a particle     V or Esc done"),
)(DrawVelocity.use)


@action("new grid", "g", "add a grid", HUBS)
def _new_grid(context: Context, pixel: Vector) -> None:
    with context.model.transaction(marked("new grid")):
        context.model.assign(list(context.model.grids), "shown", False)
        context.model.create(Grid)


@action("next grid", "h", "show the next grid", HUBS, enabled=attrgetter("model.grids.count"))
def _next_grid(context: Context, pixel: Vector) -> None:
    """Show the grid after the shown one; after the last, none; after none, the first."""
    grids = list(context.model.grids)
    shown = [index for index, grid in enumerate(grids) if grid.shown]
    following = shown[-1] + 1 if shown else 0
    with context.model.transaction(marked("next grid")):
        context.model.assign(grids, "shown", [index == following for index in range(len(grids))])
