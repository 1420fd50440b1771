"""The one table of keys and buttons: what a person presses → which named action, in which scenes."""

from __future__ import annotations

from dataclasses import dataclass

SIMULATION, PAUSE = "simulation", "pause"
PROPERTIES, SAVE, LOAD, FORCE_METHOD = "properties", "save", "load", "force method"
LIVE = (SIMULATION, PAUSE)
PANELS = (PROPERTIES, SAVE, LOAD)
EVERY = (*LIVE, *PANELS, FORCE_METHOD)


@dataclass(frozen=True)
class Binding:
    """A key (or "click", "wheel up", …) that performs an action in some scenes.

    Key names are lower case: "escape", "return", "space", "a", "+", "left", "f1"; modifiers come first,
    in the order ctrl, shift: "ctrl+z", "ctrl+shift+z".
    """

    key: str
    action: str
    scenes: tuple[str, ...]
    title: str


BINDINGS: tuple[Binding, ...] = (
    Binding("escape", "pause", (SIMULATION,), "pause"),
    Binding("escape", "escape", (PAUSE,), "drop the selection, or run"),
    Binding("escape", "back", (*PANELS, FORCE_METHOD), "back to pause"),
    Binding("space", "toggle run", LIVE, "run / pause"),
    Binding("right", "step", (PAUSE,), "a single step"),
    Binding("return", "properties", (PAUSE,), "properties of the selected element"),
    Binding("s", "save", (PAUSE,), "save"),
    Binding("d", "load", (PAUSE,), "load"),
    Binding("k", "force method", (PAUSE,), "force method"),
    Binding("i", "toggle diagrams", (*LIVE, FORCE_METHOD), "force diagrams on / off"),
    Binding("g", "new grid", (PAUSE,), "new grid"),
    Binding("h", "next grid", (PAUSE,), "next grid"),
    Binding("r", "restart", LIVE, "restart from the beginning"),
    Binding("+", "faster", LIVE, "faster"),
    Binding("-", "slower", LIVE, "slower"),
    Binding("0", "natural pace", LIVE, "pace that suits the model"),
    Binding("ctrl+z", "undo", LIVE, "undo"),
    Binding("ctrl+y", "redo", LIVE, "redo"),
    Binding("ctrl+shift+z", "redo", LIVE, "redo"),
    Binding("home", "fit", (*LIVE, FORCE_METHOD), "fit the view"),
    Binding("tab", "toggle legend", (*LIVE, FORCE_METHOD), "legend on / off"),
    Binding("f1", "toggle help", EVERY, "these keys"),
    Binding("f11", "toggle full screen", EVERY, "full screen"),
    Binding("f12", "screenshot", EVERY, "save a picture"),
    Binding("click", "select", LIVE, "select"),
    Binding("ctrl+click", "add to selection", LIVE, "add to the selection"),
    Binding("wheel up", "zoom in", (*LIVE, FORCE_METHOD), "zoom in at the pointer"),
    Binding("wheel down", "zoom out", (*LIVE, FORCE_METHOD), "zoom out"),
    Binding("drag middle", "pan", (*LIVE, FORCE_METHOD), "move the view (or right button)"),
)

_BY_KEY = {(scene, binding.key): binding for binding in BINDINGS for scene in binding.scenes}


def action_for(scene: str, key: str) -> str | None:
    """The action that a key performs in a scene, or None."""
    binding = _BY_KEY.get((scene, key))
    return binding.action if binding else None


def help_lines(scene: str) -> list[tuple[str, str]]:
    """(key, title) of everything that can be pressed in a scene."""
    return [(binding.key, binding.title) for binding in BINDINGS if scene in binding.scenes]
