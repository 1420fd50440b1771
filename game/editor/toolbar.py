"""Toolbar and menus: what can be done now in a scene, with what is selected, at a place, from the records of actions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.language import begun, language, marked, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, rigid_joints
from pinjoint.components.tags import Selected
from pinjoint.components.toolbar import Menu, Tool, Toolbar
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.drawing import tool_in_hand
from pinjoint.systems.edit.dividing import DIVISIONS
from pinjoint.systems.edit.rods import is_rigid, share_at
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.input.actions import ACTIONS, FORCE_METHOD, FORMS, METHODS

PLACE = "place"  # the tools of mods stand at the end of its group, their other buttons in a group of their own

# The actions of the toolbar, in groups from the top to the bottom.
TOOLBAR: tuple[tuple[str, ...], ...] = (
    ("toggle run", "restart", "step back", "step", "slower", "faster", "settle"),
    ("toggle statics", "next theory"),
    ("part before", "next part", "to the equations", "release x", "release y", "release another"),
    ("toggle diagrams of sets", "back"),
    ("undo", "redo", "copy", "paste", "duplicate", "delete"),
    (PLACE, "rod", "rigid", "hinge", "support", "force", "moment", "velocity"),
    (
        *("toggle diagrams", "toggle free bodies", "toggle theory", "toggle energy", "toggle table"),
        *("next shape", "fit", "new grid", "next grid"),
    ),
    ("properties", "force method", "new", "load", "save again", "save"),
    ("screenshot", "toggle full screen", "next theme", "toggle help"),
)


def toolbar_of(context: Context) -> Toolbar:
    """The buttons of the active scene; those whose keys would do nothing now are not enabled."""
    groups = (
        tuple(filter(None, (tool(context, name) for name in group))) for group in _actions_of_toolbar(context)
    )
    return Toolbar(tuple(group for group in groups if group))


def _actions_of_toolbar(context: Context) -> list[list[str]]:
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
    enabled = scene in binding.scenes and bool(action.enabled(context))
    said = title or pressed_title or binding.title
    return _tool(language(), name, said, binding.key, icon or name, pressed, enabled)


@lru_cache(maxsize=1024)  # a frame has some fifty
def _tool(spoken: str, name: str, title: str, *facts: Any) -> Tool:
    """A button or an entry whose title is said in the present language."""
    return Tool(name, tr(title), *facts)


# --- menus -----------------------------------------------------------------------------------------------


Entry = str | tuple[str, str]  # an action, or an action and the title that suits the place
Groups = Iterable[Sequence[Entry]]


def menu_at(context: Context, pixel: Vector) -> Menu:
    """The menu of the selected elements, or of the canvas, opened at a pixel."""
    groups = _of_selection(context, pixel) if context.model.any_tagged(Selected) else _of_canvas(context)
    title = begun(heading(context.model, context.selected)) if context.model.any_tagged(Selected) else ""
    if context.scene in METHODS:
        picks = [("pick unknown", marked("release this"))] if context.scene == FORCE_METHOD else []
        groups, title = [picks, *_actions_of_toolbar(context)], ""
    entries = ([(entry, "") if isinstance(entry, str) else entry for entry in group] for group in groups)
    tools = (tuple(filter(None, (tool(context, *entry) for entry in group))) for group in entries)
    return Menu(title, tuple(group for group in tools if group), pixel, pointed=pixel)


def _of_selection(context: Context, pixel: Vector) -> Groups:
    """What the elements have in common comes first."""
    particles, rods, alone = (
        context.model.tagged(Selected, Particle),
        context.model.tagged(Selected, Rod),
        len(context.selected) == 1,
    )
    turns = bool(particles) and bool(rigid_joints(context.model)[[one.row for one in particles]].any())
    results = [
        ("toggle diagrams", marked("force diagram")),
        ("probes.plot", marked("plot")),  # where the mod that plots is there
        ("new slider", marked("slider for its load or stiffness")),
        ("next influence line", marked("influence lines")),
    ]
    yield [("properties", marked("properties")), *(results if particles or rods else ())]
    if particles:
        clamps = ("clamp", "guide y", "guide x", "hold rotation") if turns else ()
        yield ["free", "pin", "hold y", "hold x", *clamps, "springs"]
    if particles and alone:
        yield [
            ("force", marked("load: click where its arrow ends")),
            *([("moment", marked("moment: click left or right of it"))] if turns else ()),
            ("velocity", marked("velocity: click where its arrow ends")),
            ("rod", marked("rod from here")),
        ]
    if rods:
        hinge = [("hinge", _hinge_of(context, rods[0], pixel))] if alone else []
        yield [*hinge, ("rigid", marked("rigid at both ends"))]
    if rods and alone:
        yield [
            ("force", marked("distributed load: click where its arrow ends")),
            ("span load", marked("load from here: click where its arrow ends, or where it ends on the rod")),
            ("moment", marked("moment here: click left or right of it")),
            *(["clear span loads"] if (context.model.span_loads.rod == rods[0].row).any() else []),
            "weight along",
        ]
    if any(rod.bending_stiffness > 0.0 for rod in rods):
        yield ["end springs", *(["split"] if alone else ()), *DIVISIONS.values()]
    if rods:
        release = [("release", marked("release it in the force method"))] if alone else []
        yield [("toggle cable", marked("cable: tension only")), "toggle strut", "toggle inextensible", *release]
    yield [("copy", marked("copy")), ("duplicate", marked("duplicate")), ("delete", marked("delete"))]


def _hinge_of(context: Context, rod: Rod, pixel: Vector) -> str:
    """What a hinge would make of the nearer end of a rod."""
    end = int(share_at(rod, context.view.camera.to_model(pixel)) > 0.5)
    if is_rigid(rod, end):
        return tr("hinge at {particle}", particle=rod.ends[end].name)
    return tr("make rigid at {particle}", particle=rod.ends[end].name)


def _of_canvas(context: Context) -> Groups:
    """Where the toolbar is hidden, all that it has, too."""
    groups: list[list[Entry]] = [
        [
            ("place", marked("new particle here")),
            "rod",
            "rigid",
            *of_mods(draw=True),
            ("paste", marked("paste here")),
            "select all",
        ],
        ["toggle run", "restart", "settle", "toggle statics", "next theory", "displacement method"],
        [
            *(
                "toggle diagrams",
                "toggle undeformed",
                "toggle free bodies",
                "toggle utilisation",
                "next shape",
                "next influence line",
            ),
            *("toggle table", "toggle theory", "toggle energy", "toggle events"),
        ],
        [*of_mods(draw=False)],
        ["fit", "new grid", "next grid", "toggle legend", "next theme", "next language"],
        [
            "environment",
            "next units",
            "toggle full screen",
            "toggle help",
            "screenshot",
            "picture as svg",
            "picture as pdf",
            "sheet",
        ],
    ]
    if context.view.strip.width == 0:
        known = {entry if isinstance(entry, str) else entry[0] for group in groups for entry in group}
        groups += [
            [action for action in group if action not in known] for group in _actions_of_toolbar(context)
        ]
    return groups
