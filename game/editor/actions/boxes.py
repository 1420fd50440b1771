"""Actions in the boxes and tiles of forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pinjoint.components.field import Vector
from pinjoint.components.language import marked
from pinjoint.components.mistake import WrongValue
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.form import FormScene
from pinjoint.editor.sliders import add_slider
from pinjoint.systems.edit import Refusal
from pinjoint.systems.forms.typing import MOST_CHARACTERS
from pinjoint.systems.input.actions import ACTIONS, FORMS, LOAD, PROPERTIES, SAVE, Perform, actions_of
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.menu import pointed_at

action = actions_of("Boxes", FORMS)
FILES = (SAVE, LOAD)


def _form_scene(context: Context) -> FormScene:
    scene = context.scenes.active
    if not isinstance(scene, FormScene):
        raise WrongValue(
            "In the scene '{scene}' there are no boxes; go to 'properties', 'save' or 'load' first.",
            scene=scene.name,
        )
    return scene


def _on_form(act: Callable[[Any, Context], object]) -> Perform:
    """An action on the scene of the form that is open."""
    return lambda context, pixel: act(_form_scene(context), context)


_accept = _on_form(lambda s, context: s.accept(context))
action("accept", "return", "accept the value, or go back", (PROPERTIES,))(_accept)
action("accept", "return", "save", (SAVE,))(_accept)
action("accept", "return", "open", (LOAD,))(_accept)
action("cancel", "escape", "restore the old value, or go back")(_on_form(lambda s, context: s.cancel(context)))
action("next box", "tab", "go to the next box", repeats=True)(
    _on_form(lambda s, context: s.next_box(context, 1))
)
action("previous box", "shift+tab", "go to the previous box", repeats=True)(
    _on_form(lambda s, context: s.next_box(context, -1))
)
action("click form", "click", "select a box, or accept its value", (PROPERTIES,))(
    lambda context, pixel: _form_scene(context).click(context, pixel)
)
action("click form", "click", "choose", FILES)(ACTIONS["click form"].perform)


for _way, _title in (
    ("up", marked("go up, or to the previous choice")),
    ("down", marked("go down, or to the next choice")),
    ("left", marked("move the cursor left")),
    ("right", marked("move the cursor right")),
):
    _act = _on_form(lambda s, context, way=_way: s.move(context, way))  # type: ignore[misc]
    action(f"go {_way}", _way, _title, (PROPERTIES,), repeats=True)(_act)
    action(f"go {_way}", _way, "choose a picture", FILES)(_act)
action("to the beginning", "home")(_on_form(lambda s, context: s.typing.place_caret(0)))
action("to the end", "end")(_on_form(lambda s, context: s.typing.place_caret(MOST_CHARACTERS)))
action("erase", "backspace", "erase", repeats=True)(_on_form(lambda s, context: s.erase(context)))
action("erase after", "delete", "erase after the cursor", repeats=True)(
    _on_form(lambda s, context: s.erase(context, after=True))
)
action("mark all", "ctrl+a", "select all text")(_on_form(lambda s, context: s.typing.mark_all()))
action("copy text", "ctrl+c", "copy")(_on_form(lambda s, context: s.copy(context)))
action("cut text", "ctrl+x", "cut")(_on_form(lambda s, context: s.cut(context)))
action("paste text", "ctrl+v", "paste")(_on_form(lambda s, context: s.paste(context)))


@action("slider of box", "ctrl+l", "add a slider for this number", (PROPERTIES,))
def _slider_of_box(context: Context, pixel: Vector) -> None:
    """A slider for what the selected box of properties holds."""
    scene = context.scenes.active
    box = scene.form.selected if isinstance(scene, FormScene) else None
    if box is None:
        raise Refusal("Click the box with the number first; then Ctrl+L makes a slider for it.")
    _, field, axis = f"{box.target}.".split(".")[:3]
    add_slider(context, box.elements, field, axis)


@action("choose word", where=(PROPERTIES,), in_menu=True)
def _choose_word(context: Context, pixel: Vector) -> None:
    """The word that was clicked in the list of a box, or that keys have come to."""
    view = context.view
    hit, theme = view.pressed, load_theme(view.theme)
    number = pointed_at(view, theme, view.pixel) if hit is None else int(hit.item)
    view.menu = None
    _form_scene(context).choose_word(context, number)


action("scroll up", "wheel up", "scroll up")(_on_form(lambda s, context: s.scroll(context, -1)))
action("scroll down", "wheel down", "scroll down")(_on_form(lambda s, context: s.scroll(context, 1)))
action("page up", "page up", repeats=True)(_on_form(lambda s, context: s.page(context, -1)))
action("page down", "page down", repeats=True)(_on_form(lambda s, context: s.page(context, 1)))
