"""Actions of the sliders on the canvas: moving and removing them."""

from __future__ import annotations

from functools import partial

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.sliding import Slide
from pinjoint.editor.sliders import SCALE, move_to, remove_slider, scale_to, slider_of
from pinjoint.systems.input.actions import actions_of

action = actions_of("More")
WHEEL = 0.02  # of its length, by which the wheel moves a slider


@action("drag slider")
def _drag_slider(context: Context, pixel: Vector) -> None:
    place = context.slider_at(pixel)
    if place is not None and not place.button.contains(pixel):
        context.gesture = Slide(context, place, pixel)


@action("click slider")
def _click_slider(context: Context, pixel: Vector) -> None:
    """Take the knob to a pixel on its line; on the button, remove the slider, or let the scale be automatic."""
    place = context.slider_at(pixel)
    if place is None:
        return
    if not place.button.contains(pixel):
        Slide(context, place, pixel)
    elif place.control.key == SCALE:
        automatic(context)
    else:
        remove_slider(context, place.control.key)
        context.notice = tr("Slider removed: {title}. Ctrl+Z brings it back.", title=place.control.title)


@action("double click slider")
def _double_click_slider(context: Context, pixel: Vector) -> None:
    """The second click of two lets the displacement scale be automatic; of others it is another click."""
    place = context.slider_at(pixel)
    if place is not None and place.control.key == SCALE and not place.button.contains(pixel):
        scale_to(context, None)
    else:
        _click_slider(context, pixel)


def automatic(context: Context) -> None:
    """Let the displacement scale follow from the model, or keep it as it is from now on."""
    [settings, *_] = context.scenes.active.scaled(context)
    is_automatic = settings.prescribed_displacement_scale is None
    scale_to(context, settings.displacement_scale if is_automatic else None)


def _step(by: float, context: Context, pixel: Vector) -> None:
    place = context.slider_at(pixel)
    if place is not None and place.control.share is not None:
        value = slider_of(context, place.control.key).value_at(place.control.share + by)
        with context.document.history.as_one(("slider", place.control.key)):
            move_to(context, place.control.key, value)


action("slider up")(partial(_step, WHEEL))
action("slider down")(partial(_step, -WHEEL))
action("automatic displacement scale")(lambda context, pixel: automatic(context))
