"""Input from pygame's events: keys and buttons by name, and where the pointer is."""

from __future__ import annotations

from typing import Any

import pygame

from components.field import Vector
from systems.base import Phase, System

CLICK_REACH = 4.0  # px that the pointer may move between pressing and releasing a button in a click
IDLE_WAIT = 100  # ms to sleep for an event while nothing moves

_NAMES = {
    pygame.K_ESCAPE: "escape",
    pygame.K_RETURN: "return",
    pygame.K_KP_ENTER: "return",
    pygame.K_SPACE: "space",
    pygame.K_BACKSPACE: "backspace",
    pygame.K_DELETE: "delete",
    pygame.K_TAB: "tab",
    pygame.K_HOME: "home",
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


class PygameInput(System):
    """Turns events into pressed keys and buttons; `closed` once the window's close icon was clicked."""

    name = "input.pygame"
    phase = Phase.INPUT

    def __init__(self) -> None:
        self.closed = False
        self._pressed_at: dict[int, Vector] = {}
        self._dragging = False

    def process(self, frame: Any) -> None:
        """Collect the events since the last frame; sleep a little where nothing can happen without one."""
        events = pygame.event.get()
        if not events and not frame.session.busy:
            events = [pygame.event.wait(IDLE_WAIT), *pygame.event.get()]
        for event in events:
            self._handle(event, frame)

    def _handle(self, event: pygame.event.Event, frame: Any) -> None:
        view = frame.session.view
        ratio = view.pixel_ratio
        if event.type in (pygame.QUIT, pygame.WINDOWCLOSE):
            self.closed = True
        elif event.type == pygame.KEYDOWN:
            key = _key_name(event)
            if key:
                frame.pressed.append((key, view.pointer or view.camera.middle))
        elif event.type == pygame.MOUSEMOTION:
            view.pointer = _scaled(event.pos, ratio)
            self._drag(event, frame, ratio)
        elif event.type == pygame.MOUSEBUTTONDOWN:
            view.pointer = self._pressed_at[event.button] = _scaled(event.pos, ratio)
        elif event.type == pygame.MOUSEBUTTONUP:
            self._release(event, frame, ratio)
        elif event.type == pygame.MOUSEWHEEL and event.y:
            key = "wheel up" if event.y > 0 else "wheel down"
            frame.pressed += [(key, view.pointer or view.camera.middle)] * abs(event.y)
        elif event.type == pygame.WINDOWLEAVE:
            view.pointer = None

    def _drag(self, event: pygame.event.Event, frame: Any, ratio: float) -> None:
        _, middle, right = event.buttons
        if middle or right:
            frame.pressed.append(("drag middle", _scaled(event.rel, ratio)))

    def _release(self, event: pygame.event.Event, frame: Any, ratio: float) -> None:
        start = self._pressed_at.pop(event.button, None)
        end = _scaled(event.pos, ratio)
        if event.button != pygame.BUTTON_LEFT or start is None:
            return
        if max(abs(end[0] - start[0]), abs(end[1] - start[1])) <= CLICK_REACH * ratio:
            key = "ctrl+click" if pygame.key.get_mods() & (pygame.KMOD_CTRL | pygame.KMOD_META) else "click"
            frame.pressed.append((key, end))


def _scaled(position: Any, ratio: float) -> Vector:
    return float(position[0]) * ratio, float(position[1]) * ratio


def _key_name(event: pygame.event.Event) -> str:
    """The name of a key as in the table of bindings, modifiers first."""
    name = _NAMES.get(event.key) or pygame.key.name(event.key)
    control = event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META)
    shift = event.mod & pygame.KMOD_SHIFT and (control or len(name) > 1)
    return ("ctrl+" if control else "") + ("shift+" if shift else "") + name if name else ""
