"""Menu: what can be done with the selected elements, or at a place of the canvas, from the records of actions."""

from __future__ import annotations

from collections.abc import Sequence

from pinjoint.components.field import Vector
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, rigid_joints
from pinjoint.components.toolbar import Menu
from pinjoint.editor.context import Context
from pinjoint.editor.toolbar import actions_of_toolbar, of_mods, tool
from pinjoint.systems.edit.dividing import DIVISIONS
from pinjoint.systems.edit.rods import is_rigid, share_at
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.input.actions import FORCE_METHOD, LIVE

Entry = str | tuple[str, str]  # an action, or an action and the title that suits the place
Groups = Sequence[Sequence[Entry]]

_PLOT = "probes.plot"  # offered where the mod that plots is there
_RESULTS = (
    ("properties", marked("properties")),
    ("toggle diagrams", marked("force diagram")),
    (_PLOT, marked("plot")),
    ("new slider", marked("slider for its load or stiffness")),
)
_SUPPORTS = ("free", "pin", "hold y", "hold x")
_CLAMPS = ("clamp", "guide y", "guide x", "hold rotation")
_FROM_HERE = (
    ("force", marked("load: click where its arrow ends")),
    ("moment", marked("moment: click left or right of it")),
    ("velocity", marked("velocity: click where its arrow ends")),
    ("rod", marked("rod from here")),
)
_PARTS = (("copy", marked("copy")), ("duplicate", marked("duplicate")), ("delete", marked("delete")))
_DIVISIONS = ("split", *DIVISIONS.values())
_OF_RODS = (
    ("toggle cable", marked("cable: tension only")),
    ("release", marked("release it in the force method")),
)


def menu_at(context: Context, pixel: Vector) -> Menu:
    """The menu of the selected elements, or of the canvas, opened at a pixel."""
    entries = [
        [entry if isinstance(entry, tuple) else (entry, "") for entry in group]
        for group in _groups(context, pixel)
    ]
    tools = [tuple(filter(None, (tool(context, *entry) for entry in group))) for group in entries]
    return Menu(_title(context), tuple(group for group in tools if group), pixel, pointed=pixel)


def _title(context: Context) -> str:
    if context.scene not in LIVE or not context.has_selected:
        return ""
    return begun(heading(context.model, context.selected))


def _groups(context: Context, pixel: Vector) -> Groups:
    if context.scene == FORCE_METHOD:
        unknown = [("pick unknown", marked("release this"))]
        return [unknown, *actions_of_toolbar(context)]
    return _of_selection(context, pixel) if context.has_selected else _of_canvas(context)


def _of_selection(context: Context, pixel: Vector) -> Groups:
    """What the elements have in common comes first."""
    selected, particles, rods = context.selected, context.selected_of(Particle), context.selected_of(Rod)
    alone = len(selected) == 1
    turns = (
        bool(rigid_joints(context.model)[[particle.row for particle in particles]].any())
        if particles
        else False
    )
    from_here = [entry for entry in _FROM_HERE if turns or entry[0] != "moment"]
    bent = any(rod.bending_stiffness > 0.0 for rod in rods)
    return [
        _RESULTS if particles or rods else _RESULTS[:1],
        (*_SUPPORTS, *(_CLAMPS if turns else ())) if particles else (),
        from_here if particles and alone else (),
        _joints(context, rods[0], pixel)
        if rods and alone
        else [("rigid", marked("rigid at both ends"))]
        if rods
        else (),
        (("force", marked("distributed load: click where its arrow ends")), "weight along")
        if rods and alone
        else (),
        (_DIVISIONS if alone else _DIVISIONS[1:]) if bent else (),
        (_OF_RODS if alone else _OF_RODS[:1]) if rods else (),
        _PARTS,
    ]


def _joints(context: Context, rod: Rod, pixel: Vector) -> Sequence[Entry]:
    """What can be done with the joints of a rod at its ends, first with the nearer one."""
    end = int(share_at(rod, context.view.camera.to_model(pixel)) > 0.5)
    particle = rod.ends[end].name
    here = (
        tr("hinge at {particle}", particle=particle)
        if is_rigid(rod, end)
        else tr("make rigid at {particle}", particle=particle)
    )
    return [("hinge", here), ("rigid", marked("rigid at both ends"))]


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
        ["toggle run", "restart", "settle"],
        ["toggle diagrams", "toggle free bodies", "toggle utilisation"],
        ["toggle theory", "toggle energy", "toggle events", "next shape"],
        [*of_mods(draw=False)],
        ["fit", "zoom in", "zoom out", "new grid", "next grid", "toggle legend", "next theme", "next language"],
        ["environment", "toggle full screen", "toggle help"],
        ["screenshot", "picture as svg", "picture as pdf"],
    ]
    if context.view.strip.width == 0:
        known = {entry if isinstance(entry, str) else entry[0] for group in groups for entry in group}
        groups += [[action for action in group if action not in known] for group in actions_of_toolbar(context)]
    return groups
