"""Typing with a tool in hand: coordinates, lengths and angles, and values of what is drawn; accepting and erasing them."""

from __future__ import annotations

from pinjoint.components import written
from pinjoint.components.field import Vector
from pinjoint.components.language import begun
from pinjoint.components.particle import Particle
from pinjoint.editor.context import Context, tell
from pinjoint.editor.gestures.drawing import DrawArrow, Drawing, DrawSupport, TypePoint
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.placing import particle_at
from pinjoint.systems.edit.typed import BEGINS, MOST
from pinjoint.systems.input.actions import ACTIONS, LIVE, actions_of

action = actions_of("Draw", while_drawing=True)


def takes_typing(context: Context) -> bool:
    """True if what is typed belongs to a tool: that of the drawing, or that in hand, except those that only click."""
    gesture = context.gesture
    if context.mode not in LIVE or context.view.menu is not None or context.view.help:
        return False
    if gesture is not None:
        return isinstance(gesture, Drawing) and not isinstance(gesture, DrawSupport)
    return context.view.tool == "place" or (
        context.view.tool != "" and ACTIONS[context.view.tool].draws is not None
    )


def typed(context: Context) -> str:
    """What was typed so far with a tool in hand."""
    return context.gesture.typed if isinstance(context.gesture, Drawing) else ""


def type_with_tool(context: Context, text: str) -> None:
    """Type characters with a tool in hand; what begins as no number is passed over."""
    if not typed(context) and text[:1] not in BEGINS:
        return
    context.notice = ""  # that the same key lets no time pass
    if not isinstance(context.gesture, Drawing):
        try:
            context.gesture = _drawing_for(context, context.view.tool)
        except Refusal as error:
            context.notice = str(error)
            return
    context.gesture.typed = (context.gesture.typed + text)[:MOST]
    context.gesture.problem = ""


def _drawing_for(context: Context, tool: str) -> Drawing:
    """The drawing that is typed into: one from the element at the pointer, else the place where the tool is to begin."""
    draws = ACTIONS[tool].draws
    found = draws(context, context.view.pixel) if draws is not None else None
    if isinstance(found, DrawArrow) or (found is not None and isinstance(found.origin, Particle)):
        return found
    if found is None and draws is not None:
        raise Refusal("Begin at a particle. P makes a new particle, Esc puts the tool away.")

    def begin(point: Vector) -> Drawing | None:
        there = particle_at(context.model, point)
        if draws is None:
            if there is not None:
                raise Refusal(
                    "{particle} is here already; choose another place, or zoom in.", particle=begun(there.said)
                )
            [made] = context.model.create(Particle, position=[point])
            tell(context, written.place(point, written.DIGITS), made)
            return None
        x, y = context.view.camera.to_pixels(point).tolist()
        drawing: Drawing | None = draws(context, (x, y)) or found
        assert drawing is not None
        drawing.origin = there or point
        return drawing

    return TypePoint(context, tool, begin)


def _retype(context: Context, kept: int | None) -> None:
    """Take back the last character that was typed, or all; a place that is not typed any more is given up."""
    assert isinstance(context.gesture, Drawing)
    context.gesture.typed, context.gesture.problem = context.gesture.typed[:kept], ""
    if isinstance(context.gesture, TypePoint) and not context.gesture.typed:
        context.gesture = None


action("accept typed")(lambda context, pixel: context.gesture.accept(context, pixel))
action("erase typed", repeats=True)(lambda context, pixel: _retype(context, -1))
action("leave typed")(lambda context, pixel: _retype(context, 0))
