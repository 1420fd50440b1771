"""Actions on rods that bend: hinges and rigid ends, division, weight."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.rod import Rod
from pinjoint.editor.actions.editing import all_of
from pinjoint.editor.context import Action, Context, action
from pinjoint.editor.gestures.drawing import DrawRod
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.dividing import DIVISIONS, divide, divide_at
from pinjoint.systems.edit.picking import End, pick_end, pick_particle, pick_rod
from pinjoint.systems.edit.placing import snapped
from pinjoint.systems.edit.rods import is_rigid, join_rigidly, share_at, toggle_hinge, toggle_joint
from pinjoint.systems.edit.weight import weigh_along


@action("rigid", while_drawing=True)
def _rigid(context: Context, pixel: Vector) -> None:
    """Make the selected rods rigid at both ends, or pinned if they are so; without any, draw such rods."""
    drawing = isinstance(context.gesture, DrawRod) or context.view.tool == DrawRod.tool
    rods = [] if drawing else context.selected_of(Rod)
    if not rods:
        context.view.rigid = not context.view.rigid
        if isinstance(context.gesture, DrawRod):
            context.gesture.say(context)
        elif context.view.rigid and not drawing:
            context.take_up(DrawRod.tool)
        context.notice = (
            tr("New rods will be rigid at both ends.")
            if context.view.rigid
            else tr("New rods will be pinned at both ends.")
        )
        return
    rigid = not all(is_rigid(rod, end) for rod in rods for end in (0, 1))
    join_rigidly(context.model, rods, rigid)
    context.view.rigid = rigid
    named, section = all_of(context, rods), rods[0].section
    if not rigid:
        context.notice = tr("{rods}: pinned at both ends", rods=named)
    elif section is None:
        context.notice = tr("{rods}: rigid at both ends", rods=named)
    else:
        context.notice = tr("{rods}: rigid at both ends, {section}", rods=named, section=section)


@action("hinge", while_drawing=True)
def _hinge(context: Context, pixel: Vector) -> None:
    """Hinge the rod's end under the pointer, or make it rigid; at a particle all ends there; else take up the tool."""
    model, view = context.model, context.view
    if (particle := pick_particle(model, view, pixel)) is not None:
        context.notice = tr(
            "{element}: {value}", element=context.name(particle), value=tr(toggle_joint(model, particle))
        )
    elif (end := _end_at(context, pixel)) is not None:
        made = toggle_hinge(model, end.rod, end.number)
        context.notice = tr("{element}: {value}", element=context.name(end.rod), value=tr(made))
    elif view.tool == "hinge" and not view.covers(pixel):
        raise Refusal(
            "Click near the end of a rod, where a ring appears, or on a joint. Esc puts the tool away."
        )
    else:
        context.take_up("hinge")


def _end_at(context: Context, pixel: Vector) -> End | None:
    """The end of a rod near a pixel; in a menu of one rod, the nearer one."""
    found = pick_end(context.model, context.view, pixel)
    rods = context.selected_of(Rod)
    if found is None and context.view.tool != "hinge" and len(rods) == 1:
        rod = pick_rod(context.model, context.view, pixel)
        share = share_at(rods[0], context.view.camera.to_model(pixel))
        return End(rods[0], int(share > 0.5)) if rod is rods[0] else None
    return found


def _divide(parts: int) -> Action:
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
    action(_title)(_divide(_parts))


@action("split")
def _split(context: Context, pixel: Vector) -> None:
    """Divide the rod under the pointer there, at a line of the grid if one is near."""
    rod = pick_rod(context.model, context.view, pixel)
    if rod is None:
        raise Refusal("There is no rod under the pointer; point at one.")
    name, point = context.name(rod), snapped(context.model, context.view, context.view.camera.to_model(pixel))
    parts = divide_at(context.model, rod, [round(share_at(rod, point), 6)])
    context.select(parts[0].ends[1])
    context.notice = tr("{rod}: divided at {particle}", rod=name, particle=parts[0].ends[1].name)


@action("weight along")
def _weight_along(context: Context, pixel: Vector) -> None:
    """Let the selected rods, without any all, bear their weight along them."""
    context.notice = weigh_along(context.model, context.selected_of(Rod) or list(context.model.rods))


def _selected(context: Context) -> list[Rod]:
    rods = context.selected_of(Rod)
    if not rods:
        raise Refusal("No rod is selected; click one first.")
    return rods
