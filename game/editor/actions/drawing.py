"""Actions with the pointer: drawing, dragging, selecting."""

from __future__ import annotations

from components.field import Vector
from components.particle import Particle
from components.rod import Rod
from components.tags import DiagramShown
from game.editor.actions.editing import take_up
from game.editor.context import ACTIONS, Action, Context, action
from game.editor.gestures import TOOLS, BoxSelect, Drawing, DrawSupport, Move, MovePoint, PullParticle
from systems.edit.picking import pick, pick_line, pick_particle, pick_point
from systems.edit.refusal import Refusal
from systems.edit.selecting import everything


@action("drag", while_drawing=True)
def _drag(context: Context, pixel: Vector) -> None:
    """With a tool, draw; else drag what is under the pointer, or a box to select where nothing is."""
    model, view = context.model, context.view
    particle = pick_particle(model, view, pixel)
    tool = context.gesture.tool if isinstance(context.gesture, Drawing) else view.tool
    if tool == DrawSupport.tool and particle is not None:
        context.gesture = DrawSupport(context, particle)
    elif tool:
        _use_at(context, tool, pixel)
    elif particle is not None and context.scene == "simulation":
        context.gesture = PullParticle(context, particle)
    elif context.scene == "pause" and particle is None and (grip := pick_point(model, view, pixel)) is not None:
        context.gesture = MovePoint(context, grip)
    elif context.scene == "pause" and (hit := particle or pick_line(model, view, pixel)) is not None:
        context.gesture = Move(context, hit, pixel)
    else:
        context.gesture = BoxSelect(context, pixel, adding=False)


@action("drag to add")
def _drag_to_add(context: Context, pixel: Vector) -> None:
    context.gesture = BoxSelect(context, pixel, adding=True)


@action("drag to", while_drawing=True)
def _drag_to(context: Context, pixel: Vector) -> None:
    if context.gesture is not None:
        context.gesture.move(context, pixel)


@action("drop", while_drawing=True)
def _drop(context: Context, pixel: Vector) -> None:
    gesture, context.gesture = context.gesture, None
    if gesture is not None:
        gesture.drop(context, pixel)


def _use_at(context: Context, tool: str, pixel: Vector) -> None:
    """Begin at the particle under the pointer; without one, what was begun by a key goes on.

    A tool that is done with at once is just used.
    """
    if tool not in TOOLS:
        ACTIONS[tool](context, pixel)
        return
    begun = TOOLS[tool].begin(context, pixel)
    if begun is not None:
        context.gesture = begun
    elif context.gesture is None:
        raise Refusal("Begin at a particle. Esc puts the tool away, P makes a new particle.")


def finish_drawing(context: Context, pixel: Vector) -> None:
    """End what was begun by a key or a click; where that is refused, it goes on."""
    assert context.gesture is not None
    context.gesture.drop(context, pixel)
    context.gesture = None


def click_with_tool(context: Context, pixel: Vector) -> bool:
    """Let a click begin or end a drawing; False if no tool is in hand."""
    if isinstance(context.gesture, Drawing):
        finish_drawing(context, pixel)
    elif context.view.tool:
        _use_at(context, context.view.tool, pixel)
    else:
        return False
    return True


def use(tool: str) -> Action:
    """A tool's key: where it can begin it does, pressed again it ends; elsewhere it takes the tool up."""

    def key(context: Context, pixel: Vector) -> None:
        if isinstance(context.gesture, Drawing) and context.gesture.tool == tool:
            finish_drawing(context, pixel)
            return
        context.leave_gesture()
        begun = TOOLS[tool].begin(context, pixel)
        if begun is not None:
            context.gesture = begun
        else:
            take_up(context, tool)

    return key


for _tool in TOOLS:
    action(_tool, while_drawing=True)(use(_tool))


def put_away(context: Context) -> bool:
    """Cancel what is being drawn, else put the tool away; False if there is neither."""
    gesture, context.gesture = context.gesture, None
    if gesture is not None:
        gesture.cancel(context)
    elif context.view.tool:
        context.view.tool = ""
    else:
        return False
    return True


# --- selecting -------------------------------------------------------------------------------------------


@action("select", while_drawing=True)
def _select(context: Context, pixel: Vector) -> None:
    """With a tool in hand, a click draws instead."""
    if not click_with_tool(context, pixel):
        hit = pick(context.model, context.view, pixel)
        context.select(*([hit] if hit is not None else []))


@action("add to selection")
def _add_to_selection(context: Context, pixel: Vector) -> None:
    hit = pick(context.model, context.view, pixel)
    if hit is not None:
        chosen = context.selected
        context.select(*([h for h in chosen if h is not hit] if hit in chosen else [*chosen, hit]))


@action("select all")
def _select_all(context: Context, pixel: Vector) -> None:
    chosen = everything(context.model)
    context.select(*chosen)
    context.notice = f"{len(chosen)} elements selected."


@action("toggle diagrams", while_drawing=True)
def _toggle_diagrams(context: Context, pixel: Vector) -> None:
    """Of the selected particles and rods; of all when nothing is selected."""
    model, view = context.model, context.view
    if not context.has_selected:
        view.all_diagrams = not view.all_diagrams
        model.tag_only([], DiagramShown)
        return
    chosen = {handle.entity: handle for handle in context.selected if isinstance(handle, Particle | Rod)}
    shown = {handle.entity: handle for handle in model.tagged(DiagramShown)}
    hide = chosen.keys() <= shown.keys()
    others = [shown[entity] for entity in shown.keys() - chosen.keys()]
    model.tag_only(others if hide else [*others, *chosen.values()], DiagramShown)
