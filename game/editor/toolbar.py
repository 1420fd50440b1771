"""Toolbar: the buttons of the active scene, from the table of keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from components.tags import DiagramShown
from components.toolbar import Tool, Toolbar
from game.editor.context import Context
from game.editor.gestures.drawing import Drawing
from systems.input.bindings import Binding, toolbar

Condition = Callable[["Context"], bool]


def toolbar_of(context: Context) -> Toolbar:
    """The buttons of the active scene; those whose keys would do nothing now are not enabled."""
    groups = toolbar(context.scene)
    return Toolbar(tuple(tuple(_tool(context, binding) for binding in group) for group in groups))


def _tool(context: Context, binding: Binding) -> Tool:
    action = binding.action
    pressed = action == _in_hand(context) or _PRESSED.get(action, _never)(context)
    enabled = context.scene in binding.scenes and _NEEDS.get(action, _always)(context)
    icon = "pause" if action == "toggle run" and pressed else action
    return Tool(action, binding.title, binding.key, icon, pressed, enabled)


def _in_hand(context: Context) -> str:
    """The tool with which clicks draw, or ""."""
    return context.gesture.tool if isinstance(context.gesture, Drawing) else context.view.tool


def _always(context: Context) -> bool:
    return True


def _never(context: Context) -> bool:
    return False


def _shows_diagrams(context: Context) -> bool:
    return context.view.all_diagrams or context.model.any_tagged(DiagramShown)


def _has_selected(context: Context) -> bool:
    return context.has_selected


def _has_particles(context: Context) -> bool:
    return context.model.particles.count > 0


def _guided(context: Context, condition: Callable[[Any], bool]) -> bool:
    guide = getattr(context.scenes.active, "shown_guide", None)
    return guide is not None and condition(guide)


# By action that switches something: whether it is on.
_PRESSED: dict[str, Condition] = {
    "toggle run": lambda context: context.scene == "simulation",
    "toggle diagrams": _shows_diagrams,
    "toggle diagrams of sets": _shows_diagrams,
    "toggle theory": lambda context: context.view.theory,
    "toggle energy": lambda context: context.view.energy,
    "toggle help": lambda context: context.view.help > 0,
}
# By action: whether it would do something now.
_NEEDS: dict[str, Condition] = {
    "undo": lambda context: context.can_undo,
    "redo": lambda context: context.can_redo,
    "copy": _has_selected,
    "duplicate": _has_selected,
    "delete": _has_selected,
    "step back": lambda context: context.timeline.first < context.model.clock.steps,
    "restart": lambda context: not context.at_beginning,
    "settle": _has_particles,
    "rod": lambda context: context.model.particles.count > 1,
    "support": _has_particles,
    "force": _has_particles,
    "velocity": _has_particles,
    "next grid": lambda context: context.model.grids.count > 0,
    "force method": lambda context: context.model.rods.count > 0,
    "release x": lambda context: _guided(context, lambda guide: guide.axis_wanted is not None),
    "release y": lambda context: _guided(context, lambda guide: guide.axis_wanted is not None),
    "release another": lambda context: _guided(context, lambda guide: guide.can_release_another),
}
