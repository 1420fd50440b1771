"""Actions of the sliders on the canvas: moving and removing them."""

from __future__ import annotations

from functools import partial

from pinjoint.components.field import Vector
from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.components.slider import Place
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.moving import Placing
from pinjoint.editor.sliders import SCALE, move_to, remove_slider, scale_to, slider_of
from pinjoint.systems.input.actions import actions_of

action = actions_of("More")
WHEEL = 0.02  # of its length, by which the wheel moves a slider
KNOB_REACH = 9.0  # points from the knob's middle within which a drag holds it where it was gripped


class Slide(Placing):
    """Drags a knob; a grip beside it takes it there first."""

    hint = marked("drag along the line     let go to finish     Esc put it back")

    def __init__(self, context: Context, place: Place, pixel: Vector) -> None:
        self._place, self._key = place, place.control.key
        left, right, _ = place.track
        share = place.control.share
        knob = pixel[0] if share is None else left + share * (right - left)
        held = share is not None and abs(knob - pixel[0]) <= KNOB_REACH * place.unit
        self._grip = knob - pixel[0] if held else 0.0
        if not held:
            self.move(context, pixel)

    def place(self, context: Context, pixel: Vector) -> str:
        share = self._place.share_at(pixel[0] + self._grip)
        move_to(context, self._key, slider_of(context, self._key).value_at(share))
        return ""


def _slider_at(context: Context, pixel: Vector) -> Place | None:
    """The slider at a pixel, of whichever model that the scene shows."""
    models = (view for shown, view in context.scenes.active.stages(context) if isinstance(shown, Model))
    return next(filter(None, (view.slider_at(pixel) for view in models)), None)


@action("drag slider")
def _drag_slider(context: Context, pixel: Vector) -> None:
    place = _slider_at(context, pixel)
    if place is not None and not place.button.contains(pixel):
        context.gesture = Slide(context, place, pixel)


@action("click slider")
def _click_slider(context: Context, pixel: Vector) -> None:
    """Take the knob to a pixel on its line; on the button, remove the slider, or let the scale be automatic."""
    place = _slider_at(context, pixel)
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
    place = _slider_at(context, pixel)
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
    place = _slider_at(context, pixel)
    if place is not None and place.control.share is not None:
        value = slider_of(context, place.control.key).value_at(place.control.share + by)
        with context.document.history.as_one(("slider", place.control.key)):
            move_to(context, place.control.key, value)


action("slider up")(partial(_step, WHEEL))
action("slider down")(partial(_step, -WHEEL))
action("automatic displacement scale")(lambda context, pixel: automatic(context))
