"""Actions that move between the modes, on files, and in the boxes and tiles of forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.mistake import WrongValue
from pinjoint.documents.models import ModelError
from pinjoint.documents.open_documents import stamp_of
from pinjoint.editor.context import Action, Context, action
from pinjoint.editor.scenes.form import FormScene
from pinjoint.editor.scenes.properties import Properties
from pinjoint.systems.edit import Refusal
from pinjoint.systems.forms import typing

_MOVES: dict[str, Action] = {
    "pause": lambda context, pixel: context.scenes.request("pause"),
    "back": lambda context, pixel: context.scenes.request("pause"),
    "toggle run": lambda context, pixel: context.scenes.request(
        "pause" if context.scene == "simulation" else "simulation"
    ),
    "save": lambda context, pixel: _to_pause_and(context, "save"),
    "load": lambda context, pixel: _to_pause_and(context, "load"),
    "new": lambda context, pixel: context.open_here(None),
}
for _name, _move in _MOVES.items():
    action(_name)(_move)


def _to_pause_and(context: Context, scene: str) -> None:
    """Go to a scene that is entered from pause."""
    context.scenes.request(*(("pause", scene) if context.scene == "simulation" else (scene,)))


@action("escape", while_drawing=True)
def _escape(context: Context, pixel: Vector) -> None:
    """Cancel the drawing, else put the tool away, else hide a shape, else end the run or deselect."""
    if context.cancel_gesture():
        return
    if context.document.shapes.shown is not None:
        context.document.shapes.hide()
    elif context.scene == "simulation":
        context.scenes.request("pause")
    elif context.has_selected:
        context.select()
    else:
        context.notice = tr("Nothing is selected, and the run is paused. Space starts it, F1 shows all keys.")


@action("force method")
def _force_method(context: Context, pixel: Vector) -> None:
    if context.model.particles.count == 0:
        raise Refusal("There is nothing to solve yet; draw a structure with P and L, or open one with D.")
    context.scenes.request("force method")


# --- files -----------------------------------------------------------------------------------------------


@action("save again")
def _save_again(context: Context, pixel: Vector) -> None:
    """Save to the same file; a model without one is named first, and a file that was changed since is asked about."""
    file = context.document.file
    if file.path is None:
        _to_pause_and(context, "save")
        return
    there = stamp_of(file.path)
    if there not in ((), file.stamp):
        context.document.file = replace(file, stamp=there)
        raise Refusal(
            "Another window or program has changed '{file}'. Press Ctrl+S again to replace it, or S to save under"
            " another name.",
            file=file.name,
        )
    try:
        context.save_as(file.path)
    except ModelError as error:
        context.notice = str(error)


@action("properties")
def _properties(context: Context, pixel: Vector) -> None:
    """The properties of the selected elements, or the environment; leaving them leads back to this scene."""
    properties = context.scenes["properties"]
    assert isinstance(properties, Properties)
    properties.opened_from(context.scene)
    _to_pause_and(context, "properties")


# --- boxes and tiles -------------------------------------------------------------------------------------


def _form_scene(context: Context) -> FormScene:
    scene = context.scenes.active
    if not isinstance(scene, FormScene):
        raise WrongValue(
            "In the scene '{scene}' there are no boxes; go to 'properties', 'save' or 'load' first.",
            scene=scene.name,
        )
    return scene


def _on_form(name: str, act: Callable[[FormScene, Context], object]) -> None:
    action(name)(lambda context, pixel: act(_form_scene(context), context))


_on_form("accept", lambda scene, context: scene.accept(context))
_on_form("cancel", lambda scene, context: scene.cancel(context))
_on_form("next box", lambda scene, context: scene.next_box(context, 1))
_on_form("previous box", lambda scene, context: scene.next_box(context, -1))
_on_form("erase", lambda scene, context: scene.erase(context))
_on_form("erase after", lambda scene, context: scene.erase(context, after=True))
_on_form("go left", lambda scene, context: scene.move(context, "left"))
_on_form("go right", lambda scene, context: scene.move(context, "right"))
_on_form("go up", lambda scene, context: scene.move(context, "up"))
_on_form("go down", lambda scene, context: scene.move(context, "down"))
_on_form("to the beginning", lambda scene, context: typing.place_caret(scene.form, 0))
_on_form("to the end", lambda scene, context: typing.place_caret(scene.form, typing.MOST_CHARACTERS))
_on_form("mark all", lambda scene, context: typing.mark_all(scene.form))
_on_form("copy text", lambda scene, context: scene.copy(context))
_on_form("cut text", lambda scene, context: scene.cut(context))
_on_form("paste text", lambda scene, context: scene.paste(context))
_on_form("scroll up", lambda scene, context: scene.scroll(context, -1))
_on_form("scroll down", lambda scene, context: scene.scroll(context, 1))
_on_form("page up", lambda scene, context: scene.page(context, -1))
_on_form("page down", lambda scene, context: scene.page(context, 1))
action("click form")(lambda context, pixel: _form_scene(context).click(context, pixel))
