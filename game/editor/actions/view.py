"""Actions on the view and the window."""

from __future__ import annotations

from components.field import Vector
from game.documents.shapes import NoShape
from game.editor.context import Action, Context, action
from game.editor.view_model import pages_of_help
from systems.edit import Refusal
from systems.render.theme import load_theme

ZOOM_STEP = 1.2
THEMES = ("light", "dark", "colour-blind", "colour-blind-dark")  # in the order in which one follows another

# Actions of the scene; pan is given how far the pointer was dragged, in place of where it is.
_SCENE: dict[str, Action] = {
    "fit": lambda context, pixel: context.scenes.active.fit(context),
    "zoom in": lambda context, pixel: context.scenes.active.zoom(context, ZOOM_STEP, pixel),
    "zoom out": lambda context, pixel: context.scenes.active.zoom(context, 1.0 / ZOOM_STEP, pixel),
    "pan": lambda context, dragged: context.scenes.active.pan(context, dragged),
}
for _name, _act in _SCENE.items():
    action(_name, while_drawing=True)(_act)


def _toggle(shown: str) -> Action:
    """Show something in the view, or hide it."""
    return lambda context, pixel: setattr(context.view, shown, not getattr(context.view, shown))


for _shown in ("legend", "theory", "energy"):
    action(f"toggle {_shown}", while_drawing=True)(_toggle(_shown))


@action("next shape", while_drawing=True)
def _next_shape(context: Context, pixel: Vector) -> None:
    """Show the next mechanism or natural mode; after the last, none."""
    try:
        context.document.shapes.next()
    except NoShape as error:
        raise Refusal(str(error)) from None
    context.view.shape = context.document.shapes.shown


@action("next theme", while_drawing=True)
def _next_theme(context: Context, pixel: Vector) -> None:
    """The theme after the present one."""
    view = context.view
    after = (*THEMES[THEMES.index(view.theme) + 1 :], THEMES[0]) if view.theme in THEMES else THEMES
    view.theme = after[0]
    context.notice = f"Theme: {load_theme(view.theme).title}"


@action("toggle help", while_drawing=True)
def _toggle_help(context: Context, pixel: Vector) -> None:
    """Show the next page of keys; after the last, none."""
    context.view.help = (context.view.help + 1) % (len(pages_of_help(context)) + 1)


@action("close help", while_drawing=True)
def _close_help(context: Context, pixel: Vector) -> None:
    context.view.help = 0


@action("toggle full screen", while_drawing=True)
def _toggle_full_screen(context: Context, pixel: Vector) -> None:
    if context.window is not None:
        context.window.toggle_full_screen()


def _magnify(by: int) -> Action:
    """Larger or smaller type, symbols and panels, in a window."""

    def act(context: Context, pixel: Vector) -> None:
        if context.window is not None:
            context.notice = f"Size of type and symbols: {context.window.magnify(by)}"

    return act


for _name, _by in (("larger", 1), ("smaller", -1), ("usual size", 0)):
    action(_name, while_drawing=True)(_magnify(_by))


@action("screenshot", while_drawing=True)
def _screenshot(context: Context, pixel: Vector) -> None:
    if context.window is None:
        return
    try:
        context.notice = f"Picture saved: {context.window.screenshot()}"
    except OSError as error:
        raise Refusal(
            f"No picture was saved: {error.filename}: {error.strerror}. Start Pinjoint in a folder where you may write."
        ) from None
