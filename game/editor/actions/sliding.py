"""Actions of the sliders on the canvas: moving and removing them."""

from __future__ import annotations

from functools import partial
from typing import Any

from pinjoint.components.field import Vector
from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.components.slider import Place, SetSliders
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.moving import Placing
from pinjoint.editor.sliders import LOAD, SCALE, control_of, loads, scales
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import actions_of

action = actions_of("More")
WHEEL = 0.02  # of its length, by which the wheel moves a slider


def _scale_to(context: Context, scale: float | None) -> None:
    """Draw displacements to a scale; None: to the automatic one."""
    for settings in context.scenes.active.scaled(context):
        settings.displacement_scale = scale


def _load_by(context: Context, factor: float) -> None:
    """Let the last load step of statics be this."""
    settings = context.model.settings
    settings.load_steps = (*settings.load_steps[:-1], factor)


def _slide(context: Context, key: int, share: float) -> None:
    """Take a slider to a share of its length, as one edit. Raises FieldError, and Refusal if it was removed meanwhile."""
    model = context.model
    if key == SCALE:
        _scale_to(context, scales(context.scenes.active.scaled(context)[0]).value_at(share))
        return
    if key == LOAD:
        _load_by(context, loads(model.settings).value_at(share))
        return
    if key >= len(model.sliders):
        raise Refusal("This slider has been removed.")
    slider = model.sliders[key]
    control, value = control_of(model, key, slider), slider.value_at(share)
    with model.transaction(control.title if control is not None else marked("slider")):
        for aim in slider.aims:
            handles, values = aim.handles(model.tables), list[Any]()
            for x, y in (getattr(handle, aim.field) for handle in handles if aim.axis):
                values.append((value, y) if aim.axis == "x" else (x, value))
            model.assign(handles, aim.field, values or [value] * len(handles))


class Slide(Placing):
    """Drags a knob; a grip beside it takes it there first."""

    hint = marked("drag along the line     let go to finish     Esc put it back")

    def __init__(self, context: Context, place: Place, pixel: Vector) -> None:
        self._place, self._key = place, place.control.key
        left, right, _ = place.track
        share = place.control.share
        knob = pixel[0] if share is None else left + share * (right - left)
        held = share is not None and abs(knob - pixel[0]) <= 9.0 * place.unit
        self._grip = knob - pixel[0] if held else 0.0
        if not held:
            self.move(context, pixel)

    def place(self, context: Context, pixel: Vector) -> str:
        _slide(context, self._key, self._place.share_at(pixel[0] + self._grip))
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


@action("automatic displacement scale")
def _automatic(context: Context, pixel: Vector) -> None:
    """Let the displacement scale follow from the model, or keep it as it is from now on."""
    [settings, *_] = context.scenes.active.scaled(context)
    is_automatic = settings.prescribed_displacement_scale is None
    _scale_to(context, settings.displacement_scale if is_automatic else None)


@action("click slider")
def _click_slider(context: Context, pixel: Vector) -> None:
    """Take the knob to a pixel on its line; on the button, remove the slider, or let the scale be automatic."""
    place = _slider_at(context, pixel)
    if place is None:
        return
    if not place.button.contains(pixel):
        Slide(context, place, pixel)
    elif place.control.key == SCALE:
        _automatic(context, pixel)
    elif place.control.key == LOAD:
        _load_by(context, 1.0)
    else:
        model, key = context.model, place.control.key
        with model.transaction(marked("slider removed")):
            model.execute(SetSliders(model.sliders[:key] + model.sliders[key + 1 :]))
        context.notice = tr("Slider removed: {title}. Ctrl+Z brings it back.", title=place.control.title)


@action("double click slider")
def _double_click_slider(context: Context, pixel: Vector) -> None:
    """The second click of two lets the displacement scale be automatic; of others it is another click."""
    place = _slider_at(context, pixel)
    if place is not None and place.control.key == SCALE and not place.button.contains(pixel):
        _scale_to(context, None)
    else:
        _click_slider(context, pixel)


def _step(by: float, context: Context, pixel: Vector) -> None:
    place = _slider_at(context, pixel)
    if place is not None and place.control.share is not None:
        with context.document.history.as_one(("slider", place.control.key)):
            _slide(context, place.control.key, place.control.share + by)


action("slider up")(partial(_step, WHEEL))
action("slider down")(partial(_step, -WHEEL))
