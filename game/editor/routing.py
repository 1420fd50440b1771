"""Routing: which action a key or a button means, and where; what lies on top takes presses before the scene does."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.components.view import Hit, Readout
from pinjoint.editor.context import Context
from pinjoint.systems.input.actions import ACTIONS, FORMS, LIVE, MENU
from pinjoint.systems.render.picture import hits_at
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.menu import pointed_at
from pinjoint.systems.render.ui.sliders import SLIDER

BUTTONS = ("click", "ctrl+click", "double click", "drag", "ctrl+drag", "right click")
WHEEL = ("wheel up", "wheel down")
AT_POINTER = (*BUTTONS, *WHEEL)
DIGITS = frozenset("0123456789.,-+")


def hit_at(context: Context, key: str, pixel: Vector) -> Hit | None:
    """What is pressed by a button or the wheel at a pixel, the topmost that takes it; None: the scene decides."""
    if key not in AT_POINTER:
        return None
    theme = load_theme(context.view.theme)
    for shown, view in reversed(context.stages):
        for hit in reversed(hits_at(shown, view, theme, pixel)):
            taken = (
                hit.wheel is not None if key in WHEEL else key != "right click" or hit.action != "close menu"
            )
            if taken and not (isinstance(hit.item, Readout) and context.performing):
                return hit if hit.action is not None else None
    return None


def meaning(context: Context, key: str, pixel: Vector, hit: Hit | None) -> tuple[str | None, Vector]:
    """The action, if any, that a key or button means at a pixel, and where it acts.

    It means it to a lesson, an open menu, the help, what is hit there, or the scene.
    """
    view = context.view
    if (answer := _to_lesson(context, key)) is not None:
        return answer or None, pixel
    if view.menu is not None and key in BUTTONS and pixel == view.menu.pointed:
        return "close menu", pixel  # the pointer has not moved: what came to lie under it is not meant
    if hit is not None:
        return _pressed(context, key, hit), hit.at or pixel
    if view.menu is not None and key not in AT_POINTER and (action := ACTIONS.name_at(MENU, key)) is not None:
        number = pointed_at(view, load_theme(view.theme), pixel) if key == "return" else -1
        entry = view.menu.entries[number] if number >= 0 else None
        return (entry.action, view.menu.at) if entry is not None and entry.enabled else (action, pixel)
    if view.help and key == "escape":
        return "close help", pixel
    scene = LIVE[0] if for_tools(context, key, pixel) else context.scene
    found = ACTIONS.name_at(scene, key)
    if found is None and key == "double click":  # where it means nothing special, it is another click
        found = ACTIONS.name_at(scene, "click")
    return found, pixel


def _pressed(context: Context, key: str, hit: Hit) -> str | None:
    """What a button or the wheel does to what it hits."""
    if key in WHEEL:
        return (hit.wheel or ("", ""))[key == "wheel down"] or None
    if hit.action == SLIDER:
        return None if key == "right click" else f"{key.removeprefix('ctrl+')} {SLIDER}"
    in_menu, in_help = context.view.menu is not None, context.view.help > 0
    if in_help and key == "right click":
        return "close help"
    # a panel that moves up is not closed, too
    once = key == "double click" and not (hit.again or in_menu or in_help)
    if once or (in_help and key.endswith("drag")) or (key == "right click" and not in_menu) or not hit.enabled:
        return None
    return hit.action or None


def _to_lesson(context: Context, key: str) -> str | None:
    """The action of a key for the lesson that a person is in; "": it means nothing; None: it is not for it."""
    course = context.course
    if course is None or context.performing or context.scene not in LIVE:
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
