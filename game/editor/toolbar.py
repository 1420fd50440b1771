"""Toolbar and menus: what can be done now in a scene, with what is selected, at a place, from the records of actions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
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

_PLACE = "place"  # the tools of mods stand at the end of its group, their other buttons in a group of their own

MODS = marked("Mods")

# The actions of the toolbar, in groups from the top to the bottom, by the names of these.
TOOLBAR: dict[str, tuple[str, ...]] = {
    marked("Run"): ("toggle run", "restart", "step back", "step", "slower", "faster", "settle"),
    marked("Statics"): ("toggle statics", "next theory"),
    marked("Steps"): (
        *("part before", "next part", "to the equations"),
        *("release x", "release y", "release moment", "release another"),
    ),
    marked("Method"): ("toggle diagrams of sets", "back"),
    marked("Edit"): ("undo", "redo", "copy", "paste", "duplicate", "delete"),
    marked("Draw"): (_PLACE, "rod", "rigid", "hinge", "support", "force", "moment", "velocity"),
    marked("Show"): (
        *("toggle diagrams", "toggle free bodies", "toggle theory", "toggle energy", "toggle table"),
        *("next shape", "fit", "new grid", "next grid"),
    ),
    marked("Model"): ("properties", "force method", "new", "load", "save again", "save"),
    marked("Window"): ("screenshot", "toggle full screen", "next theme", "toggle help"),
}
WORDS = {  # beside icons, where there is room: of actions, or of the icons that they have while they are on
    "toggle run": marked("run"),
    "pause": marked("pause"),
    "restart": marked("restart"),
    "step back": marked("step back"),
    "step": marked("step"),
    "slower": marked("slower"),
    "faster": marked("faster"),
    "settle": marked("equilibrium"),
    "toggle statics": marked("statics"),
    "next theory": marked("exact"),
    "part before": marked("previous"),
    "next part": marked("next"),
    "to the equations": marked("equations"),
    "release x": marked("release x"),
    "release y": marked("release y"),
    "release moment": marked("release M"),
    "release another": marked("another"),
    "toggle diagrams of sets": marked("diagrams"),
    "back": marked("close"),
    "undo": marked("undo"),
    "redo": marked("redo"),
    "copy": marked("copy"),
    "paste": marked("paste"),
    "duplicate": marked("duplicate"),
    "delete": marked("delete"),
    _PLACE: marked("particle"),
    "rod": marked("rod"),
    "rigid": marked("frame rod"),
    "hinge": marked("hinge"),
    "support": marked("support"),
    "force": marked("load"),
    "moment": marked("moment"),
    "velocity": marked("velocity"),
    "toggle diagrams": marked("diagrams"),
    "toggle free bodies": marked("free bodies"),
    "toggle theory": marked("comparison"),
    "toggle energy": marked("energies"),
    "toggle table": marked("table"),
    "next shape": marked("modes"),
    "fit": marked("show all"),
    "new grid": marked("new grid"),
    "next grid": marked("next grid"),
    "properties": marked("properties"),
    "force method": marked("force method"),
    "new": marked("new"),
    "load": marked("open"),
    "save again": marked("save"),
    "save": marked("save as"),
    "screenshot": marked("picture"),
    "toggle full screen": marked("full screen"),
    "next theme": marked("theme"),
    "toggle help": marked("help"),
    "walls.wall": marked("wall"),
    "probes.plot": marked("plot"),
    "collisions.speeds": marked("histogram"),
}


def toolbar_of(context: Context) -> Toolbar:
    """The buttons of the active scene; those whose keys would do nothing now are not enabled."""
    offered = {
        name: tuple(filter(None, (tool(context, action) for action in actions)))
        for name, actions in _actions_of_toolbar(context).items()
    }
    groups = {name: tools for name, tools in offered.items() if tools}
    return Toolbar(tuple(groups.values()), tuple(map(tr, groups)))


def _actions_of_toolbar(context: Context) -> dict[str, Sequence[str]]:
    """The names of its actions, by the names of groups; those of other scenes among them. None in forms."""
    if context.scenes.active.tools in FORMS:
        return {}
    groups = {
        name: [*group, *(of_mods(draw=True) if _PLACE in group else ())] for name, group in TOOLBAR.items()
    }
    last = groups.popitem()  # which stands at the bottom
    return {**groups, MODS: of_mods(draw=False), last[0]: last[1]}


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
    enabled = EXTENSIONS.acts_in(scene, binding.scenes) and bool(action.enabled(context))
    said, word = title or pressed_title or binding.title, WORDS.get(icon) or WORDS.get(name, "")
    return _tool(language(), name, said, word, binding.key, icon or name, pressed, enabled)


@lru_cache(maxsize=1024)  # a frame has some fifty
def _tool(spoken: str, name: str, title: str, word: str, *facts: Any) -> Tool:
    """A button or an entry whose title is said in the present language."""
    return replace(Tool(name, tr(title), *facts), word=tr(word) if word else "")


# --- menus -----------------------------------------------------------------------------------------------


Entry = str | tuple[str, str]  # an action, or an action and the title that suits the place
Groups = Iterable[Sequence[Entry]]


def menu_at(context: Context, pixel: Vector) -> Menu:
    """The menu of the selected elements, or of the canvas, opened at a pixel."""
    groups = _of_selection(context, pixel) if context.model.any_tagged(Selected) else _of_canvas(context)
    title = begun(heading(context.model, context.selected)) if context.model.any_tagged(Selected) else ""
    if context.scene in METHODS:
        picks = [("pick unknown", marked("release this"))] if context.scene == FORCE_METHOD else []
        groups, title = [picks, *_actions_of_toolbar(context).values()], ""
    entries = ([(entry, "") if isinstance(entry, str) else entry for entry in group] for group in groups)
    tools = (tuple(filter(None, (tool(context, *entry) for entry in group))) for group in entries)
    return Menu(title, tuple(group for group in tools if group), pixel, pointed=pixel)


def _of_selection(context: Context, pixel: Vector) -> Groups:
    """What the elements have in common comes first."""
    particles = context.model.tagged(Selected, Particle)
    rods = context.model.tagged(Selected, Rod)
    alone = len(context.selected) == 1
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
            "follow",
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
            *("rod", "rigid", *of_mods(draw=True)),
            ("paste", marked("paste here")),
            "select all",
        ],
        ["toggle run", "restart", "settle", "toggle statics", "next theory", "displacement method"],
        [
            *("toggle diagrams", "toggle undeformed", "toggle free bodies", "toggle utilisation"),
            *("next shape", "next influence line"),
            *("toggle table", "toggle theory", "toggle energy", "toggle events"),
        ],
        [*of_mods(draw=False)],
        ["fit", "new grid", "next grid", "toggle legend", "next theme", "next language"],
        [
            *("environment", "units", "toggle full screen", "toggle sound", "toggle help"),
            *("screenshot", "picture as svg", "picture as pdf", "sheet"),
        ],
    ]
    if context.view.strip.width == 0:
        known = {entry if isinstance(entry, str) else entry[0] for group in groups for entry in group}
        groups += [
            [action for action in group if action not in known]
            for group in _actions_of_toolbar(context).values()
        ]
    return groups
