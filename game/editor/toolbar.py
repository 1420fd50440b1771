"""Toolbar: the buttons of the active scene, and what they and the entries of menus say of actions now."""

from __future__ import annotations

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import tr
from pinjoint.components.toolbar import Tool, Toolbar
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.drawing import tool_in_hand
from pinjoint.systems.input.actions import ACTIONS, FORMS

PLACE = "place"  # the tools of mods stand at the end of its group, their other buttons in a group of their own

# The actions of the toolbar, in groups from the top to the bottom.
TOOLBAR: tuple[tuple[str, ...], ...] = (
    ("toggle run", "restart", "step back", "step", "slower", "faster", "settle"),
    ("next part", "release x", "release y", "release another"),
    ("toggle diagrams of sets", "back"),
    ("undo", "redo", "copy", "paste", "duplicate", "delete"),
    (PLACE, "rod", "rigid", "hinge", "support", "force", "moment", "velocity"),
    (
        *("toggle diagrams", "toggle free bodies", "toggle theory", "toggle energy"),
        *("next shape", "fit", "new grid", "next grid"),
    ),
    ("properties", "force method", "new", "load", "save again", "save"),
    ("screenshot", "toggle full screen", "next theme", "toggle help"),
)


def toolbar_of(context: Context) -> Toolbar:
    """The buttons of the active scene; those whose keys would do nothing now are not enabled."""
    groups = (
        tuple(filter(None, (tool(context, name) for name in group))) for group in actions_of_toolbar(context)
    )
    return Toolbar(tuple(group for group in groups if group))


def actions_of_toolbar(context: Context) -> list[list[str]]:
    """The names of its actions, in groups; those of other scenes among them. None in forms."""
    if context.scenes.active.tools in FORMS:
        return []
    groups = [[*group, *(of_mods(draw=True) if PLACE in group else ())] for group in TOOLBAR]
    return [*groups[:-1], of_mods(draw=False), groups[-1]]  # the last group stands at the bottom


def of_mods(*, draw: bool) -> list[str]:
    """The actions of mods that have a button: those that draw, or the others."""
    return [name for name in EXTENSIONS.icons if draw is (ACTIONS[name].draws is not None)]


def tool(context: Context, name: str, title: str = "") -> Tool | None:
    """What a button or an entry of a menu says of an action now; None if the scene does not offer it.

    title: where that of the action does not fit.
    """
    scene = context.scenes.active.tools
    binding = ACTIONS.offer(name, scene)
    if binding is None:
        return None
    action = ACTIONS[name]
    pressed = name == tool_in_hand(context) or bool(action.pressed(context))
    icon, pressed_title = action.pressed_as(context) if pressed else ("", "")
    said = tr(title or pressed_title or binding.title)
    enabled = scene in binding.scenes and bool(action.enabled(context))
    return Tool(name, said, binding.key, icon or name, pressed, enabled)
