"""Input from pygame's events: keys and buttons by name, and where the pointer is."""

from __future__ import annotations

import math
import time
from typing import Any

import pygame

from pinjoint.components.field import Vector
from pinjoint.systems.base import Phase, System
from pinjoint.systems.input.actions import ACTIONS, FILES, MENU, TABLE, TEXT

_CLICK_REACH = 4.0  # points that the pointer may move while a button is down; more: a drag
IDLE_PAUSE = 0.016  # s between polls for events while nothing moves
_IDLE_LOOKS = 16  # polls before a frame passes without events
WAITING_LOOKS = 4  # polls while something is compiled, which frames would slow down

_NAMES = {
    pygame.K_ESCAPE: "escape",
    pygame.K_RETURN: "return",
    pygame.K_KP_ENTER: "return",
    pygame.K_SPACE: "space",
    pygame.K_BACKSPACE: "backspace",
    pygame.K_DELETE: "delete",
    pygame.K_TAB: "tab",
    pygame.K_HOME: "home",
    1073741925: "menu",  # SDLK_APPLICATION, which pygame has no name for
    pygame.K_LEFT: "left",
    pygame.K_RIGHT: "right",
    pygame.K_UP: "up",
    pygame.K_DOWN: "down",
    pygame.K_KP_PLUS: "+",
    pygame.K_KP_MINUS: "-",
    pygame.K_PLUS: "+",
    pygame.K_EQUALS: "+",
    pygame.K_MINUS: "-",
}


def _awaited(looks: int) -> list[pygame.event.Event]:
    """The next events, or none after some seconds. pygame.event.wait polls so often that it takes 2 % of a core."""
    for _ in range(looks):
        time.sleep(IDLE_PAUSE)
        if events := pygame.event.get():
            return events
    return []


class PygameInput(System):
    """Turns events into pressed keys and buttons; `closed` once the window's close icon was clicked.

    density: pixels per point of the window. maximised: it fills the desktop, between its bars.
    """

    name = "input.pygame"
    phase = Phase.INPUT
    writes = ("pressed", "view")

    def __init__(self) -> None:
        self.closed = self.maximised = False
        self.density = 1.0
        self._held: set[int] = set()  # keys that are down
        self._grip: tuple[str, Vector] | None = None  # the kind of click and where, while the button is down
        self._dragging = False
        self._right: Vector | None = None  # how far the pointer has gone since the right button went down
        self._clicked: tuple[float, Vector] | None = None  # when and where the last click was

    def close(self) -> None:
        """Close the window after this frame."""
        self.closed = True

    def process(self, frame: Any) -> None:
        """Collect the events since the last frame; sleep a little if nothing can happen without one."""
        session, events = frame.session, pygame.event.get()
        readiness = session.readiness
        waiting = readiness.awaited is not None
        if not events and session.footer is None and (waiting or not session.busy):
            events = _awaited(WAITING_LOOKS if waiting or readiness.finding else _IDLE_LOOKS)
        for event in events:
            self._handle(event, frame)
        dropped = [event.file for event in events if event.type == pygame.DROPFILE]
        if dropped:
            frame.pressed.append((FILES + "\n".join(dropped), session.view.pixel))

    def _handle(self, event: pygame.event.Event, frame: Any) -> None:
        view, ratio = frame.session.view, self.density
        if event.type in (pygame.QUIT, pygame.WINDOWCLOSE):
            self.closed = True
        elif event.type in (pygame.WINDOWMAXIMIZED, pygame.WINDOWRESTORED):
            self.maximised = event.type == pygame.WINDOWMAXIMIZED
        elif event.type == pygame.KEYDOWN:
            self._press(event, frame)
        elif event.type == pygame.TEXTINPUT:
            frame.pressed.append((TEXT + event.text, frame.session.view.pixel))
        elif event.type == pygame.KEYUP:
            self._held.discard(event.key)
        elif event.type == pygame.MOUSEMOTION:
            view.pointer = _scaled(event.pos, ratio)
            self._drag(event, frame, ratio)
        elif event.type == pygame.MOUSEBUTTONDOWN:
            view.pointer = _scaled(event.pos, ratio)
            if event.button == pygame.BUTTON_LEFT:
                held = pygame.key.get_mods()
                adds = _control(held) or held & pygame.KMOD_SHIFT
                self._grip = ("ctrl+click" if adds else "click", view.pointer)
            elif event.button == pygame.BUTTON_RIGHT:
                self._right = 0.0, 0.0
        elif event.type == pygame.MOUSEBUTTONUP:
            if event.button == pygame.BUTTON_LEFT:
                view.pointer = _scaled(event.pos, ratio)
                self._release(frame)
            elif event.button == pygame.BUTTON_RIGHT and self._right is not None:
                self._right, view.pointer = None, _scaled(event.pos, ratio)
                frame.pressed.append(("right click", view.pointer))
        elif event.type == pygame.MOUSEWHEEL and event.y:
            key = "wheel up" if event.y > 0 else "wheel down"
            frame.pressed += [(key, view.pixel)] * abs(event.y)
        elif event.type == pygame.WINDOWLEAVE:
            view.pointer = None
        elif event.type == pygame.WINDOWFOCUSLOST:  # no event tells of keys that are released elsewhere
            self._held.clear()
            if self._dragging:
                self._release(frame)
            self._grip = self._right = None

    def _press(self, event: pygame.event.Event, frame: Any) -> None:
        key, repeated = _key_name(event), event.key in self._held
        self._held.add(event.key)
        view, scene = frame.session.view, frame.session.scene
        over = MENU if view.menu is not None else TABLE if view.table_place.contains(view.pixel) else scene
        found = ACTIONS.at(over, key) or ACTIONS.at(scene, key)
        if key and (not repeated or (found is not None and found[0].repeats)):
            frame.pressed.append((key, frame.session.view.pixel))

    def _drag(self, event: pygame.event.Event, frame: Any, ratio: float) -> None:
        _, middle, right = event.buttons
        reach = _CLICK_REACH * frame.session.view.pixel_ratio
        if right and self._right is not None:  # a right click, until the pointer has gone too far for one
            across, down = _scaled(event.rel, ratio)
            self._right = gone = self._right[0] + across, self._right[1] + down
            if math.hypot(*gone) > reach:
                self._right = None
                frame.pressed.append(("drag middle", gone))
        elif middle or right:
            frame.pressed.append(("drag middle", _scaled(event.rel, ratio)))
        elif self._grip is not None:
            button, start = self._grip
            end = _scaled(event.pos, ratio)
            if not self._dragging and math.dist(start, end) > reach:
                self._dragging = True
                frame.pressed.append((button.replace("click", "drag"), start))
            if self._dragging:
                if frame.pressed and frame.pressed[-1][0].endswith("drag to"):
                    frame.pressed.pop()  # only the last place of a frame counts
                held = "shift+" if pygame.key.get_mods() & pygame.KMOD_SHIFT else ""
                frame.pressed.append((f"{held}drag to", end))

    def _release(self, frame: Any) -> None:
        """The left button is up again: the end of a drag, or a click."""
        grip, self._grip = self._grip, None
        dragging, self._dragging = self._dragging, False
        if grip is None:
            return
        key, pointer = "drop" if dragging else grip[0], frame.session.view.pixel
        now, before = time.monotonic(), self._clicked
        self._clicked = (now, pointer) if key == "click" else None
        reach = 2.0 * _CLICK_REACH * frame.session.view.pixel_ratio
        soon = key == "click" and before is not None and now - before[0] <= 0.4  # s
        if soon and before is not None and math.dist(pointer, before[1]) <= reach:
            key, self._clicked = "double click", None
        frame.pressed.append((key, pointer))


def _scaled(position: Any, ratio: float) -> Vector:
    return float(position[0]) * ratio, float(position[1]) * ratio


def _key_name(event: pygame.event.Event) -> str:
    """The name of a key as in the table of bindings, modifiers first; "" of a key that is never bound."""
    name = _NAMES.get(event.key) or pygame.key.name(event.key)
    held = ("ctrl+" if _control(event.mod) else "") + ("shift+" if event.mod & pygame.KMOD_SHIFT else "")
    try:
        return ACTIONS.key_named(held + name)
    except ValueError:
        return ""


def _control(modifiers: int) -> bool:
    return bool(modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META))
