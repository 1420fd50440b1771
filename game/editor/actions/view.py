"""Actions on the view and the window."""

from __future__ import annotations

from operator import attrgetter

from pinjoint.components.field import Vector
from pinjoint.components.language import LANGUAGES, language, speak, tr
from pinjoint.editor.context import Context
from pinjoint.editor.view_model import pages_of_help
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import EVERY, IN_PICTURES, Perform, actions_of
from pinjoint.systems.render.theme import load_theme

action = actions_of("View", EVERY, while_drawing=True)

ZOOM_STEP = 1.2
THEMES = ("light", "dark", "colour-blind", "colour-blind-dark")  # in the order in which one follows another


def toggle(what: str) -> Perform:
    """Show something in the view, or hide it."""
    return lambda context, pixel: setattr(context.view, what, not getattr(context.view, what))


def _zoom(factor: float) -> Perform:
    return lambda context, pixel: context.scenes.active.zoom(context, factor, pixel)


action("zoom in", "wheel up", "zoom in at the pointer", IN_PICTURES)(_zoom(ZOOM_STEP))
action("zoom out", "wheel down", "zoom out", IN_PICTURES)(_zoom(1.0 / ZOOM_STEP))


@action("pan", "drag middle", "move the view (right button, too)", IN_PICTURES)
def _pan(context: Context, dragged: Vector) -> None:
    """It is given how far the pointer was dragged, in place of where it is."""
    context.scenes.active.pan(context, dragged)


@action("fit", "home", "show the whole model", IN_PICTURES)
def _fit(context: Context, pixel: Vector) -> None:
    context.scenes.active.fit(context)


action("toggle legend", "tab", "show or hide legend and toolbar", IN_PICTURES)(toggle("legend"))


@action("next theme", "t", "change the colours", IN_PICTURES)
def _next_theme(context: Context, pixel: Vector) -> None:
    """The theme after the present one."""
    theme = context.view.theme
    following = THEMES.index(theme) + 1 if theme in THEMES else 0
    context.view.theme = THEMES[following % len(THEMES)]
    context.notice = tr("Theme: {theme}", theme=tr(load_theme(context.view.theme).title))


@action("next language", "f2", "change the language: English, Português")
def _next_language(context: Context, pixel: Vector) -> None:
    """The language after the present one, in which all is said from now on."""
    codes = list(LANGUAGES)
    speak(codes[(codes.index(language()) + 1) % len(codes)])
    context.scenes.active.say_again(context)
    context.notice = tr("Language: {language}", language=LANGUAGES[language()])


def _magnify(by: int) -> Perform:
    """Larger or smaller type, symbols and panels, in a window."""

    def act(context: Context, pixel: Vector) -> None:
        if context.window is not None:
            context.notice = tr("Size of text and symbols: {size}", size=context.window.magnify(by))

    return act


_larger = _magnify(1)
action("larger", "ctrl++", "make text larger or smaller", repeats=True)(_larger)
action("larger", "ctrl+shift++")(_larger)
action("smaller", "ctrl+-", "make text larger or smaller", repeats=True)(_magnify(-1))
action("usual size", "ctrl+0", "reset the size of text")(_magnify(0))


@action("toggle help", "f1", "show help: keys and glossary", pressed=attrgetter("view.help"))
def _toggle_help(context: Context, pixel: Vector) -> None:
    """Show the next page of keys; after the last, none."""
    count = len(pages_of_help(context))
    context.view.help = (min(context.view.help, count) + 1) % (count + 1)


def _turn(by: int) -> Perform:
    """Another page of the keys, if there is one."""

    def act(context: Context, pixel: Vector) -> None:
        count = len(pages_of_help(context))
        context.view.help = min(max(min(context.view.help, count) + by, 1), count)

    return act


action("help on")(_turn(1))
action("help back")(_turn(-1))
action("close help")(lambda context, pixel: setattr(context.view, "help", 0))


@action("toggle full screen", "f11", "full screen on or off")
def _toggle_full_screen(context: Context, pixel: Vector) -> None:
    if context.window is not None:
        context.window.toggle_full_screen()


def _picture(suffix: str) -> Perform:
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


action("screenshot", "f12", "save a picture")(_picture(".png"))
action("picture as svg", "shift+f12", "save a picture as SVG")(_picture(".svg"))
action("picture as pdf", "ctrl+f12", "save a picture as PDF")(_picture(".pdf"))
