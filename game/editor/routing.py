"""Routing: which action a key or a button means, and where; what lies on top takes presses before the scene does."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.components.view import Hit, Readout
from pinjoint.editor.actions.typing import takes_typing, typed
from pinjoint.editor.context import Context
from pinjoint.systems.edit.typed import BEGINS
from pinjoint.systems.input.actions import ACTIONS, FORMS, LIVE, MENU, TABLE
from pinjoint.systems.render.picture import hits_at
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.controls import SLIDER
from pinjoint.systems.render.ui.menu import pointed_at

BUTTONS = ("click", "ctrl+click", "double click", "drag", "ctrl+drag", "right click")
WHEEL = ("wheel up", "wheel down")
_AT_POINTER = (*BUTTONS, *WHEEL)
_OF_TYPED = {"return": "accept typed", "backspace": "erase typed", "escape": "leave typed"}
_OF_ANSWER = {"backspace": "erase answer", "delete": "clear answer", "ctrl+a": ""}


class Press:
    """A key or a button, pressed at a pixel: what it hits and means now.

    It means something to a lesson, an open menu, the help, what is hit, or the scene.

    hit: what takes it, the topmost there; None: the scene decides. action: what it does, None: nothing; at: the pixel where.
    for_tools: it belongs to the toolbar, or is a right click on the model beside boxes to type into; a scene in which tools
    do not act is left first.
    """

    def __init__(self, context: Context, key: str, pixel: Vector) -> None:
        self._context, self._key, self._pixel = context, key, pixel
        self.hit = self._hit() if key in _AT_POINTER else None
        self.for_tools = self._is_for_tools()
        self.action, self.at = self._meaning()

    def _hit(self) -> Hit | None:
        context, key = self._context, self._key
        theme = load_theme(context.view.theme)
        for shown, view in reversed(context.stages):
            for hit in reversed(hits_at(shown, view, theme, self._pixel)):
                taken = (
                    hit.wheel is not None
                    if key in WHEEL
                    else key != "right click" or hit.action != "close menu"
                )
                if taken and not (isinstance(hit.item, Readout) and context.footer is not None):
                    return hit if hit.action is not None else None
        return None

    def _is_for_tools(self) -> bool:
        context = self._context
        view, scene = context.view, context.scenes.active
        if self._key not in _AT_POINTER or view.menu is not None or view.help or scene.covers(context):
            return False
        in_form = self._key == "right click" and context.scene in FORMS
        beside = in_form and not context.stages[0][1].covers(self._pixel)
        return beside or view.strip.contains(self._pixel)

    def _meaning(self) -> tuple[str | None, Vector]:
        """The action, if any, and where it acts."""
        view, key, pixel, hit = self._context.view, self._key, self._pixel, self.hit
        if (answer := self._to_lesson()) is not None or (answer := self._to_tool()) is not None:
            return answer or None, pixel
        if view.menu is not None and key in BUTTONS and pixel == view.menu.pointed:
            return "close menu", pixel  # the pointer has not moved: what came to lie under it is not meant
        if hit is not None:
            return self._on(hit), hit.at or pixel
        if (
            view.menu is not None
            and key not in _AT_POINTER
            and (action := ACTIONS.name_at(MENU, key)) is not None
        ):
            number = pointed_at(view, load_theme(view.theme), pixel) if key == "return" else -1
            entry = view.menu.entries[number] if number >= 0 else None
            return (entry.action, view.menu.at) if entry is not None and entry.enabled else (action, pixel)
        if view.help and key == "escape":
            return "close help", pixel
        scene = LIVE[0] if self.for_tools else self._context.scene
        over = (
            (scene in LIVE or self._context.mode in LIVE)
            and view.table_place.contains(pixel)
            and key not in _AT_POINTER
        )
        if over and (found := ACTIONS.name_at(TABLE, key)) is not None:
            return found, pixel
        found = ACTIONS.name_at(scene, key)
        if found is None and key == "double click":  # where it means nothing special, it is another click
            found = ACTIONS.name_at(scene, "click")
        return found, pixel

    def _on(self, hit: Hit) -> str | None:
        """What a button or the wheel does to what it hits."""
        view, key = self._context.view, self._key
        if key in WHEEL:
            return (hit.wheel or ("", ""))[key == "wheel down"] or None
        if hit.action == SLIDER:
            return None if key == "right click" else f"{key.removeprefix('ctrl+')} {SLIDER}"
        in_menu, in_help = view.menu is not None, view.help > 0
        if in_help and key == "right click":
            return "close help"
        # a panel that moves up is not closed, too
        once = key == "double click" and not (hit.again or in_menu or in_help)
        dragged = in_help and key.endswith("drag")
        if once or dragged or (key == "right click" and not in_menu) or not hit.enabled:
            return None
        return hit.action or None

    def _to_tool(self) -> str | None:
        """The action for what is typed with a tool in hand; "": the key is part of the text; None: it is not for it."""
        context, key = self._context, self._key
        if not takes_typing(context):
            return None
        if typed(context) and key in _OF_TYPED:
            return _OF_TYPED[key]
        return "" if self._is_typed(begun=bool(typed(context))) else None

    def _is_typed(self, *, begun: bool) -> bool:
        """True if the key is part of a number or its unit; begun: its beginning was typed already."""
        return self._key in BEGINS or (begun and (len(self._key) == 1 or self._key == "space"))

    def _to_lesson(self) -> str | None:
        """The action for the lesson that a person is in; "": it means nothing; None: it is not for it."""
        context, key = self._context, self._key
        course = context.course
        if course is None or context.footer is not None or context.scene not in LIVE:
            return None
        if course.awaits_choice and key in "123456789" and len(key) == 1:
            return f"answer {key}"
        if course.awaits_number and course.typed and key in _OF_ANSWER:
            return _OF_ANSWER[key]
        if course.writes and key == "escape":
            return "clear answer"
        if course.awaits_number and self._is_typed(begun=course.writes):
            return ""
        return "check answer" if key == "return" and course.takes_return else None
