"""Actions of the pointer: drawing with tools, dragging, selecting."""

from __future__ import annotations

from pinjoint.components.bent import AXIAL, QUANTITIES, is_frame
from pinjoint.components.field import Vector
from pinjoint.components.language import begun, plural, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.tags import DiagramShown
from pinjoint.editor.context import ACTIONS, Context, action
from pinjoint.editor.gestures.drawing import TOOLS, Drawing, DrawSupport
from pinjoint.editor.gestures.moving import BoxSelect, Move, MovePoint, PullParticle
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import everything, pick, pick_grid, pick_line, pick_particle, pick_point
from pinjoint.systems.render.diagrams import NAMES


@action("drag", while_drawing=True)
def _drag(context: Context, pixel: Vector) -> None:
    """With a tool, draw; else drag the element under the pointer; where there is none, a box to select in."""
    model, view = context.model, context.view
    particle = pick_particle(model, view, pixel)
    tool = context.gesture.tool if isinstance(context.gesture, Drawing) else view.tool
    if tool == DrawSupport.tool and particle is not None:
        context.gesture = DrawSupport(context, particle)
    elif tool:
        _draw(context, tool, pixel)
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
    if isinstance(gesture, Drawing):
        context.gesture = gesture.following(context)


def _draw(context: Context, tool: str, pixel: Vector) -> None:
    """Begin a drawing with a tool at a pixel; where none can begin, one that a key began goes on.

    Tools without a drawing of their own ("place", "support") act at once.
    """
    if tool not in TOOLS:
        ACTIONS[tool](context, pixel)
        return
    begun = TOOLS[tool].begin_anywhere(context, pixel)
    if begun is not None:
        context.gesture = begun
    elif context.gesture is None:
        raise Refusal("Begin at a particle. P makes a new particle, Esc puts the tool away.")


for _kind in TOOLS.values():
    action(_kind.tool, while_drawing=True)(_kind.use)


# --- selecting -------------------------------------------------------------------------------------------


@action("select", while_drawing=True)
def _select(context: Context, pixel: Vector) -> None:
    """With a tool in hand, a click begins or finishes a drawing instead."""
    if isinstance(context.gesture, Drawing):
        context.gesture.finish(context, pixel)
    elif context.view.tool:
        _draw(context, context.view.tool, pixel)
    else:
        hit = pick(context.model, context.view, pixel)
        context.select(*([hit] if hit is not None else []))


@action("add to selection")
def _add_to_selection(context: Context, pixel: Vector) -> None:
    """Also the grid, which a plain click beside an element never takes."""
    model, view = context.model, context.view
    hit = pick(model, view, pixel) or pick_grid(model, view, pixel)
    if hit is not None:
        chosen = context.selected
        context.select(*([h for h in chosen if h is not hit] if hit in chosen else [*chosen, hit]))


@action("select all")
def _select_all(context: Context, pixel: Vector) -> None:
    chosen = everything(context.model)
    context.select(*chosen)
    context.notice = plural("{count} element selected.", "{count} elements selected.", len(chosen))


@action("toggle diagrams", while_drawing=True)
def _toggle_diagrams(context: Context, pixel: Vector) -> None:
    """The diagrams of the selected particles and rods; of all when nothing is selected, or all are shown.

    Where rods bend, those of N, M and V follow one another before there are none.
    """
    model, view = context.model, context.view
    apart = view.put_together()
    if apart and (view.all_diagrams or model.any_tagged(DiagramShown)):
        return
    if view.all_diagrams or not context.has_selected:
        view.all_diagrams = _following(context, view.all_diagrams)
        model.tag_only([], DiagramShown)
        return
    chosen = {handle.entity: handle for handle in context.selected if isinstance(handle, Particle | Rod)}
    shown = {handle.entity: handle for handle in model.tagged(DiagramShown)}
    shows = _following(context, chosen.keys() <= shown.keys())
    others = [shown[entity] for entity in shown.keys() - chosen.keys()]
    model.tag_only([*others, *chosen.values()] if shows else others, DiagramShown)


def _following(context: Context, shown: bool) -> bool:
    """Whether diagrams are shown after this, of the next quantity where rods bend."""
    view, last = context.view, QUANTITIES[-1]
    if not is_frame(context.model):
        return not shown
    if shown and view.quantity == last:
        return False
    view.quantity = QUANTITIES[QUANTITIES.index(view.quantity) + 1] if shown else AXIAL
    context.notice = tr("{quantity}. Press I for the next.", quantity=begun(tr(NAMES[view.quantity])))
    return True
