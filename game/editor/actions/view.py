"""Actions on the view and the window."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.components.language import LANGUAGES, language, speak, tr
from pinjoint.components.rod import has_strength
from pinjoint.documents.shapes import NoShape
from pinjoint.editor.context import Action, Context, action
from pinjoint.editor.view_model import pages_of_help
from pinjoint.systems.edit import Refusal
from pinjoint.systems.render.theme import load_theme

ZOOM_STEP = 1.2
THEMES = ("light", "dark", "colour-blind", "colour-blind-dark")  # in the order in which one follows another


def _toggle(shown: str) -> Action:
    """Show something in the view, or hide it."""
    return lambda context, pixel: setattr(context.view, shown, not getattr(context.view, shown))


def _magnify(by: int) -> Action:
    """Larger or smaller type, symbols and panels, in a window."""

    def act(context: Context, pixel: Vector) -> None:
        if context.window is not None:
            context.notice = tr("Size of text and symbols: {size}", size=context.window.magnify(by))

    return act


# Pan is given how far the pointer was dragged, in place of where it is.
_ACTIONS: dict[str, Action] = {
    "fit": lambda context, pixel: context.scenes.active.fit(context),
    "zoom in": lambda context, pixel: context.scenes.active.zoom(context, ZOOM_STEP, pixel),
    "zoom out": lambda context, pixel: context.scenes.active.zoom(context, 1.0 / ZOOM_STEP, pixel),
    "pan": lambda context, dragged: context.scenes.active.pan(context, dragged),
    **{f"toggle {shown}": _toggle(shown) for shown in ("legend", "theory", "energy", "events")},
    "toggle free bodies": _toggle("free_bodies"),
    **{name: _magnify(by) for name, by in (("larger", 1), ("smaller", -1), ("usual size", 0))},
    "close help": lambda context, pixel: setattr(context.view, "help", 0),
}
for _name, _act in _ACTIONS.items():
    action(_name, while_drawing=True)(_act)


@action("next shape", while_drawing=True)
def _next_shape(context: Context, pixel: Vector) -> None:
    """Show the next mechanism, buckling mode or natural mode; after the last, none."""
    if context.view.put_together() and context.view.shape is not None:
        return
    try:
        context.document.shapes.next()
        shown = context.document.shapes.shown
        context.notice = shown.note if shown is not None else ""
    except NoShape as error:
        raise Refusal(str(error)) from None
    context.view.shape = context.document.shapes.shown


@action("toggle utilisation", while_drawing=True)
def _toggle_utilisation(context: Context, pixel: Vector) -> None:
    """Show how much of its strength each rod bears, or hide it."""
    view = context.view
    if not view.utilisation and not has_strength(context.model):
        raise Refusal(
            "No rod has a strength yet. Select rods, press Return, and type in a tensile or compressive strength."
        )
    view.utilisation = view.put_together() or not view.utilisation


@action("next theme", while_drawing=True)
def _next_theme(context: Context, pixel: Vector) -> None:
    """The theme after the present one."""
    theme = context.view.theme
    following = THEMES.index(theme) + 1 if theme in THEMES else 0
    context.view.theme = THEMES[following % len(THEMES)]
    context.notice = tr("Theme: {theme}", theme=tr(load_theme(context.view.theme).title))


@action("next language", while_drawing=True)
def _next_language(context: Context, pixel: Vector) -> None:
    """The language after the present one, in which all is said from now on."""
    codes = list(LANGUAGES)
    speak(codes[(codes.index(language()) + 1) % len(codes)])
    context.scenes.active.say_again(context)
    context.notice = tr("Language: {language}", language=LANGUAGES[language()])


@action("toggle help", while_drawing=True)
def _toggle_help(context: Context, pixel: Vector) -> None:
    """Show the next page of keys; after the last, none."""
    count = len(pages_of_help(context))
    context.view.help = (min(context.view.help, count) + 1) % (count + 1)


def _turn(by: int) -> Action:
    """Another page of the keys, if there is one."""

    def act(context: Context, pixel: Vector) -> None:
        count = len(pages_of_help(context))
        context.view.help = min(max(min(context.view.help, count) + by, 1), count)

    return act


action("help on", while_drawing=True)(_turn(1))
action("help back", while_drawing=True)(_turn(-1))


@action("toggle full screen", while_drawing=True)
def _toggle_full_screen(context: Context, pixel: Vector) -> None:
    if context.window is not None:
        context.window.toggle_full_screen()


def _picture(suffix: str) -> Action:
    """Save a picture of the model in a format."""

    def act(context: Context, pixel: Vector) -> None:
        if context.window is None:
            return
        try:
            context.notice = tr("Picture saved: {file}", file=context.window.screenshot(suffix))
        except OSError as error:
            raise Refusal(
                "No picture was saved: {file}: {reason}. Start Pinjoint in a folder where you may write.",
                file=error.filename,
                reason=error.strerror,
            ) from None

    return act


for _name, _suffix in (("screenshot", ".png"), ("picture as svg", ".svg"), ("picture as pdf", ".pdf")):
    action(_name, while_drawing=True)(_picture(_suffix))
