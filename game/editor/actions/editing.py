"""Actions that select, drag, change, copy and delete elements, and take that back."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import Field, Vector
from pinjoint.components.language import begun, listed, marked, plural, tr
from pinjoint.components.settings import HUBS, PAUSE, STATICS
from pinjoint.components.tags import Selected
from pinjoint.editor.clipboard import Part
from pinjoint.editor.context import Context, tell
from pinjoint.editor.gestures.drawing import Drawing, DrawSupport, tool_in_hand
from pinjoint.editor.gestures.moving import BoxSelect, Move, MoveArrow, MovePoint, PullParticle
from pinjoint.editor.readouts import pin_at, pinned, retype
from pinjoint.editor.scenes.properties import Properties
from pinjoint.editor.toolbar import menu_at
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.arrows import Loaded, dragged
from pinjoint.systems.edit.picking import everything, pick, pick_grid, pick_line, pick_particle, pick_point
from pinjoint.systems.edit.placing import Movable, nudged, snapped
from pinjoint.systems.edit.rods import delete
from pinjoint.systems.forms.properties import counted, heading
from pinjoint.systems.input.actions import ACTIONS, IN_LESSONS, IN_PICTURES, LIVE, SIMULATION, actions_of
from pinjoint.systems.render.picture import load_at, symbol_at

action = actions_of("Select and edit")

BESIDE = 30.0  # points to the right and down, where a duplicate appears


# --- the pointer -----------------------------------------------------------------------------------------


def _any_selected(context: Context) -> bool:
    return context.model.any_tagged(Selected)


@action("select", "click", "select", while_drawing=True)
def _select(context: Context, pixel: Vector) -> None:
    """With a tool in hand, a click begins or finishes a drawing instead."""
    if isinstance(context.gesture, Drawing):
        context.gesture.finish(context, pixel)
    elif context.view.tool:
        _draw(context, context.view.tool, pixel)
    else:
        hit = pick(context.model, context.view, pixel)
        pin_at(context, hit, pixel)
        context.select(*([hit] if hit is not None else []))


@action("add to selection", "ctrl+click", "add to the selection")
def _add_to_selection(context: Context, pixel: Vector) -> None:
    """Also the grid, which a plain click beside an element never takes."""
    model, view = context.model, context.view
    hit = pick(model, view, pixel) or pick_grid(model, view, pixel)
    if hit is not None:
        chosen = context.selected
        context.select(*([h for h in chosen if h is not hit] if hit in chosen else [*chosen, hit]))


@action("open", "double click", "open the properties of an element", while_drawing=True)
def _open(context: Context, pixel: Vector) -> None:
    """A double click: the properties of what it hits; it ends a chain of rods, and with a tool is another click."""
    if isinstance(context.gesture, Drawing) and context.gesture.goes_on:
        context.gesture = None
    elif isinstance(context.gesture, Drawing) or context.view.tool:
        _select(context, pixel)
    elif (
        hit := pick(context.model, context.view, pixel) or symbol_at(context.model, context.view, pixel)
    ) is not None:
        if hit not in context.selected:
            context.select(hit)
        ACTIONS["properties"].perform(context, pixel)


def _cancel(context: Context) -> bool:
    """Take back what is being drawn or dragged, else put the tool away; False if there is neither."""
    gesture, context.gesture = context.gesture, None
    tool, context.view.tool = context.view.tool, context.view.tool if gesture is not None else ""
    if gesture is not None:
        gesture.cancel(context)
    return bool(gesture or tool)


@action("open menu", "shift+f10", where=IN_PICTURES)
@action("open menu", "menu", "open the menu at the pointer", IN_PICTURES)
@action(
    "open menu", "right click", "open the menu at the pointer", IN_PICTURES, in_menu=True, while_drawing=True
)
def _open_menu(context: Context, pixel: Vector) -> None:
    """The menu of what is under the pointer, which is selected; a drawing, or a tool in hand, is ended instead."""
    if _cancel(context):
        return
    if context.mode in LIVE:
        model, view = context.model, context.view
        hit = pick(model, view, pixel) or symbol_at(model, view, pixel)
        if hit is None:
            context.select()
        elif hit not in context.selected:
            context.select(hit)
    context.view.menu = menu_at(context, pixel)


@action("drag", "drag", "pull a particle, or select in a box", (SIMULATION,))
@action("drag", "drag", "move an element, or select in a box", HUBS, while_drawing=True)
def _drag(context: Context, pixel: Vector) -> None:
    """With a tool, draw; else drag the element under the pointer; where there is none, a box to select in."""
    model, view = context.model, context.view
    particle = pick_particle(model, view, pixel)
    tool = tool_in_hand(context)
    if tool == DrawSupport.tool and particle is not None:
        context.gesture = DrawSupport(context, particle)
    elif tool:
        _draw(context, tool, pixel)
    elif particle is not None and context.mode == "simulation":
        context.gesture = PullParticle(context, particle)
    elif context.mode in HUBS and particle is None and (grip := pick_point(model, view, pixel)) is not None:
        context.gesture = MovePoint(context, grip)
    elif context.mode in HUBS and particle is None and (held := _arrow_at(context, pixel)) is not None:
        context.gesture = MoveArrow(context, *held, pixel)
    elif context.mode in HUBS and (hit := particle or pick_line(model, view, pixel)) is not None:
        context.gesture = Move(context, hit, pixel)
    else:
        context.gesture = BoxSelect(context, pixel, adding=False)


def _arrow_at(context: Context, pixel: Vector) -> tuple[Loaded, list[Field[Any]]] | None:
    """What has the arrow of a load at a pixel, and what a drag of it changes; on rods only where span loads begin or end."""
    model, view = context.model, context.view
    element = load_at(model, view, pixel)
    for one in (
        [] if element is None else [element, *(load for load in model.loads if load.particle is element)]
    ):
        if fields := dragged(model, view, one, pixel):
            on_line = fields[0].unit != "m" and pick_line(model, view, pixel, 4.0) is not None  # points
            return None if on_line else (one, fields)
    return None


action("drag to add", "ctrl+drag", "add all in a box to the selection")(
    lambda context, pixel: setattr(context, "gesture", BoxSelect(context, pixel, adding=True))
)


def _drag_to(free: bool, context: Context, pixel: Vector) -> None:
    if context.gesture is not None:
        context.gesture.free = free
        context.gesture.move(context, pixel)


action("drag to", "drag to", where=IN_LESSONS, while_drawing=True)(partial(_drag_to, False))
action("drag freely to", "shift+drag to", where=IN_LESSONS, while_drawing=True)(partial(_drag_to, True))


@action("drop", "drop", where=IN_LESSONS, while_drawing=True)
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
    action = ACTIONS[tool]
    if action.draws is None:
        action.perform(context, pixel)
        return
    begun = action.draws(context, pixel)
    if begun is not None:
        context.gesture = begun
    elif context.gesture is None:
        raise Refusal("Begin at a particle. P makes a new particle, Esc puts the tool away.")


# --- keys ------------------------------------------------------------------------------------------------


@action("escape", "escape", "put the tool away, or deselect", HUBS)
@action("escape", "escape", "put the tool away, or pause", (SIMULATION,), while_drawing=True)
def _escape(context: Context, pixel: Vector) -> None:
    """Cancel the drawing, else put the tool away, else hide a shape, else end the run or deselect."""
    if _cancel(context) or context.document.statics.give_up():
        return
    if context.document.shapes.shown is not None:
        context.document.shapes.hide()
    elif context.mode == "simulation":
        context.scenes.request("pause")
    elif _any_selected(context):
        context.select()
    elif context.mode == STATICS:
        context.notice = tr("Nothing is selected. Q leaves statics, F1 shows all keys.")
    else:
        context.notice = tr("Nothing is selected, and the run is paused. Space starts it, F1 shows all keys.")


@action(
    "properties",
    "return",
    "open the properties of the selection",
    pressed=lambda context: context.scene == "properties",
)
def _properties(context: Context, pixel: Vector) -> None:
    """The properties of the selected elements, or the environment; leaving them leads back to this scene."""
    properties = context.scenes["properties"]
    assert isinstance(properties, Properties)
    properties.opened_from(context.scene)
    context.scenes.request_from_pause("properties")


@action("delete", "backspace", "delete the selection", (SIMULATION, PAUSE))
@action("delete", "delete", "delete the selection", enabled=_any_selected)
def _delete(context: Context, pixel: Vector) -> None:
    doomed = context.selected
    if not doomed:
        raise Refusal("Nothing is selected; first click what you want to delete.")
    before = {table.name: table.count for table in context.model.tables.values()}
    named = begun(heading(context.model, [doomed[0]]))
    delete(context.model, doomed)
    gone = {name: count - context.model.tables[name].count for name, count in before.items()}
    if sum(gone.values()) == 1:
        context.notice = tr("{element} deleted.", element=named)
    else:
        elements = [
            counted(context.model.tables[name].kind.noun, count) for name, count in gone.items() if count
        ]
        context.notice = tr("{elements} deleted.", elements=listed(elements))


@action("erase place", "backspace", "erase the typed x, or delete the selection", (STATICS,))
def _erase_place(context: Context, pixel: Vector) -> None:
    pin = pinned(context)
    if pin is not None and pin.typed:
        retype(context, pin, pin.typed[:-1])
    else:
        _delete(context, pixel)


def nudge(context: Context, direction: Vector, *, far: bool) -> bool:
    """Move the selected elements by about a pixel or, if far, a grid spacing; False if none are selected."""
    model = context.model
    chosen = Movable(model, context.selected)
    if not len(chosen):
        return False
    positions = nudged(model, context.view, chosen.positions, direction, far=far)
    moved = [*chosen.particles, *chosen.others]
    with context.document.history.as_one(("nudge", *(handle.entity for handle in moved))):
        chosen.place(positions)
    tell(context, written.place(positions[0], written.DIGITS), *moved)
    return True


def _move(direction: Vector, far: bool, always: bool, context: Context, pixel: Vector) -> None:
    """An arrow key: move what is selected; once a run has begun only if `always`, as with Ctrl."""
    if (always or context.document.at_beginning) and nudge(context, direction, far=far):
        return
    if always:
        raise Refusal("Nothing that can be moved is selected; click a particle or a rod first.")
    if _any_selected(context):
        raise Refusal(
            "Once a run has begun, arrow keys step through time. Ctrl with an arrow moves the selection; R goes back"
            " to the beginning."
        )


for _held, _name, _title in (
    ("", "arrow", marked("move the selection (before a run)")),
    ("shift+", "far arrow", marked("move it by the grid (before a run)")),
    ("ctrl+", "move", marked("move the selection")),
    ("ctrl+shift+", "move far", marked("move it by the grid")),
):
    for _way, _direction in {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}.items():
        if "move" in _name or _direction[1]:  # without Ctrl, left and right go through time
            _act = partial(_move, _direction, "far" in _name, "move" in _name)
            action(
                f"{_name} {_way}", _held + _way, _title, HUBS if "move" in _name else (PAUSE,), repeats=True
            )(_act)
            if "move" in _name:  # where no time passes
                action(f"{_name} {_way}", _held.replace("ctrl+", "") + _way, _title, (STATICS,))(_act)


def _can_go(by: int, context: Context) -> bool:
    """True if there is something to take back (-1), or to repeat (1)."""
    history = context.document.history
    return (history.can_undo if by < 0 else history.can_redo) or context.documents.can_move(by)


@action("undo", "ctrl+z", "undo", repeats=True, enabled=partial(_can_go, -1))
def _undo(context: Context, pixel: Vector) -> None:
    title = context.undo()
    context.notice = tr("Undone: {title}", title=tr(title)) if title else tr("There is nothing to undo.")


@action("redo", ("ctrl+y", "ctrl+shift+z"), "redo", repeats=True, enabled=partial(_can_go, 1))
def _redo(context: Context, pixel: Vector) -> None:
    title = context.redo()
    context.notice = tr("Redone: {title}", title=tr(title)) if title else tr("There is nothing to redo.")


@action("select all", "ctrl+a", "select all")
def _select_all(context: Context, pixel: Vector) -> None:
    chosen = everything(context.model)
    context.select(*chosen)
    context.notice = plural("{count} element selected.", "{count} elements selected.", len(chosen))


@action("copy", "ctrl+c", "copy the selection", enabled=_any_selected)
def _copy(context: Context, pixel: Vector) -> None:
    context.clipboard = Part.selected(context.model).text
    context.notice = tr("Copied. Ctrl+V pastes it at the pointer.")


@action("cut", "ctrl+x", "cut the selection")
def _cut(context: Context, pixel: Vector) -> None:
    _copy(context, pixel)
    delete(context.model, context.selected)
    context.notice = tr("Cut. Ctrl+V pastes it at the pointer.")


@action("paste", "ctrl+v", "paste at the pointer")
def _paste(context: Context, pixel: Vector) -> None:
    """Paste around the pointer, from the toolbar around the middle of the view; the first place snaps to the grid."""
    if context.view.strip.contains(pixel):
        pixel = context.view.canvas.middle
    part = Part.described(context.clipboard)
    position = part.places
    middle = 0.5 * (position.min(axis=0) + position.max(axis=0))
    x, y = (position[0] + context.view.camera.to_model(pixel) - middle).tolist()
    offset = np.subtract(snapped(context.model, context.view, (x, y)), position[0]).tolist()
    made = part.paste(context.model, (offset[0], offset[1]))
    context.select(*made)
    context.notice = plural(
        "Pasted {count} element; drag it where it belongs.",
        "Pasted {count} elements; drag them where they belong.",
        len(made),
    )


@action("duplicate", "ctrl+d", "duplicate the selection", enabled=_any_selected)
def _duplicate(context: Context, pixel: Vector) -> None:
    view = context.view
    beside = BESIDE * view.pixel_ratio / view.camera.scale
    model = context.model
    made = Part.selected(model).paste(model, snapped(model, view, (beside, -beside)), marked("duplicate"))
    context.select(*made)
    context.notice = plural(
        "Duplicated {count} element; drag the copy where it belongs.",
        "Duplicated {count} elements; drag the copies where they belong.",
        len(made),
    )
