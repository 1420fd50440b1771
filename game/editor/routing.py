"""Routing: which action a key or a button means, and where; what lies on top takes clicks before the scene does."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.editor.context import Context
from pinjoint.editor.view_model import pages_of_help
from pinjoint.systems.input.actions import FORMS, LIVE, MENU, action_for
from pinjoint.systems.render.empty_card import card_button_at
from pinjoint.systems.render.help import help_closed_by
from pinjoint.systems.render.lesson_card import lesson_button_at
from pinjoint.systems.render.menu import menu_of
from pinjoint.systems.render.picture import on_status_bar, panel_at
from pinjoint.systems.render.theme import load_theme

CLICKS = ("click", "ctrl+click", "double click", "drag", "ctrl+drag")  # the pointer may slip in a click
ONCE = tuple(click for click in CLICKS if click != "double click")  # a panel that moves up is not closed, too
BUTTONS = (*CLICKS, "right click")
AT_POINTER = (*BUTTONS, "wheel up", "wheel down")
ON_SLIDER = {
    **dict.fromkeys(("click", "ctrl+click"), "click slider"),
    "double click": "double click slider",
    **dict.fromkeys(("drag", "ctrl+drag"), "drag slider"),
    "wheel up": "slider up",
    "wheel down": "slider down",
}


# The scene, whether a menu, the help, or the toolbar takes clicks, and the title of the slider that does.
Layer = tuple[str, bool, bool, bool, str]
Meaning = tuple[str | None, Vector]  # the name of an action, if any, and the pixel where it acts


def meaning(context: Context, key: str, pixel: Vector) -> Meaning:
    """What a key or button means at a pixel: to an open menu, the help, the toolbar, a slider, or the scene."""
    view = context.view
    if (answer := _to_lesson(context, key, pixel)) is not None:
        return answer or None, pixel
    if view.menu is not None and (found := _in_menu(context, key, pixel)) is not None:
        return found
    if view.help and (key == "escape" or key in AT_POINTER):
        return _on_help(context, key, pixel), pixel
    if for_tools(context, key, pixel):
        on_toolbar = view.strip.contains(pixel)
        return _on_toolbar(context, key, pixel) if on_toolbar else action_for(LIVE[0], key), pixel
    tool = card_button_at(context.model, view, pixel) if key in ONCE and context.scene in LIVE else None
    if tool is not None:
        return tool.action if tool.enabled else None, (view.strip.left, view.strip.top)  # as by the toolbar
    if key in AT_POINTER and context.slider_at(pixel):
        return ON_SLIDER.get(key), pixel
    if key in BUTTONS and not context.performing and not context.scenes.active.covers(context):
        model, shown = context.focus
        if on_status_bar(shown, pixel):
            return None, pixel
        if (panel := panel_at(model, shown, load_theme(view.theme), pixel)) is not None:
            return (panel.action_at(pixel) if key in ONCE else None), pixel
    return scene_meaning(context.scene, key), pixel


DIGITS = frozenset("0123456789.,-+")


def _to_lesson(context: Context, key: str, pixel: Vector) -> str | None:
    """The action of a key or button for the lesson that a person is in; "": it means nothing; None: it is not for it."""
    course, beside = context.course, context.beside
    if course is None or beside is None or context.performing:
        return None
    if key in AT_POINTER and beside.camera.viewport.contains(pixel):
        if key.startswith("wheel"):
            return "lesson up" if key == "wheel up" else "lesson down"
        return lesson_button_at(beside, pixel) if key in ONCE else ""
    if context.scene not in LIVE:
        return None
    if course.awaits_choice and key in "123456789" and len(key) == 1:
        return f"answer {key}"
    if course.awaits_number and (key in DIGITS or (course.typed and key == "backspace")):
        return "" if key in DIGITS else "erase answer"
    return "check answer" if key == "return" and course.takes_return else None


def for_tools(context: Context, key: str, pixel: Vector) -> bool:
    """True if a press belongs to the toolbar, or is a right click on the model beside boxes to type into.

    A scene in which tools do not act is left first.
    """
    view, scene = context.view, context.scenes.active
    if key not in AT_POINTER or view.menu is not None or view.help or scene.covers(context):
        return False
    beside = key == "right click" and context.scene in FORMS and not context.focus[1].covers(pixel)
    return beside or view.strip.contains(pixel)


def layer(context: Context, pixel: Vector) -> Layer:
    """What takes a click at a pixel."""
    view = context.view
    slider = context.slider_at(pixel)
    on_slider = slider.control.title if slider is not None else ""
    return context.scene, view.menu is not None, view.help > 0, view.strip.contains(pixel), on_slider


def scene_meaning(scene: str, key: str) -> str | None:
    """The action of a key in a scene; where a second click means nothing special, it is another click."""
    found = action_for(scene, key)
    return action_for(scene, "click") if found is None and key == "double click" else found


def _in_menu(context: Context, key: str, pixel: Vector) -> Meaning | None:
    """What a key means to the open menu; None: it is not for the menu, which it closes."""
    layout = menu_of(context.view)
    assert layout is not None
    if key in BUTTONS and pixel == layout.menu.pointed:
        return "close menu", pixel  # the pointer has not moved: what came to lie under it is not meant
    if key == "return" or (key in BUTTONS and layout.frame.contains(pixel)):
        number = layout.pointed_at(pixel) if key == "return" else layout.entry_at(pixel)
        entry = layout.menu.entries[number] if number >= 0 else None
        if entry is None or not entry.enabled:
            return "choose entry", pixel  # nothing
        return entry.action, layout.menu.at
    if key in CLICKS:
        return "close menu", pixel
    action = action_for(MENU, key)
    return None if action is None else (action, pixel)


def _on_help(context: Context, key: str, pixel: Vector) -> str | None:
    """Clicks on the help leaf through it or close it, and go no further."""
    if key == "escape":
        return "close help"
    if key in ("wheel up", "wheel down"):
        return "help back" if key == "wheel up" else "help on"
    if key not in ("click", "ctrl+click", "double click", "right click"):
        return None
    pages, shown = pages_of_help(context), context.view.help
    viewport = context.scenes.active.helped(context)
    page = pages[min(shown, len(pages)) - 1] if pages else []
    closed = help_closed_by(page, shown < len(pages), viewport, context.view.pixel_ratio, pixel)
    return "close help" if closed or key == "right click" else "toggle help"


def _on_toolbar(context: Context, key: str, pixel: Vector) -> str | None:
    button = context.view.button_at(pixel)
    return button.tool.action if button is not None and button.tool.enabled and key in CLICKS else None
