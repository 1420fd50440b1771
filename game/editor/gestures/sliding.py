"""Sliding: a drag of the knob of a slider, live, also while time passes; one drag is one entry of the log."""

from __future__ import annotations

from pinjoint.components.field import FieldError, Vector
from pinjoint.components.language import marked
from pinjoint.components.slider import Place
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.moving import Placing
from pinjoint.editor.sliders import move_to, slider_of

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

    def move(self, context: Context, pixel: Vector) -> None:
        slider = slider_of(context, self._key)
        value = slider.value_at(self._place.share_at(pixel[0] + self._grip))
        try:
            with context.document.history.as_one(self):
                move_to(context, self._key, value)
        except FieldError as error:
            context.notice = str(error)
