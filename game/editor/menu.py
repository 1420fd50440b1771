"""Menu: what can be done with the selected elements, or at a place of the canvas, from the table of keys."""

from __future__ import annotations

from collections.abc import Sequence

from components.field import Vector
from components.handle import Handle
from components.menu import Menu
from components.particle import Particle
from components.rod import Rod
from game.editor.context import Context
from game.editor.toolbar import tool
from systems.forms.properties import heading
from systems.input.bindings import ADDED_BUTTONS, ADDED_TOOLS, FORCE_METHOD, LIVE, offers, toolbar

Entry = str | tuple[str, str]  # an action, or an action and the title that suits the place
Groups = Sequence[Sequence[Entry]]

# They keep it open.
IN_MENU = (
    "open menu",
    "more tools",
    "choose entry",
    *(f"menu {way}" for way in ("up", "down", "left", "right")),
)

_PLOT = "probes.plot"  # offered where the mod that plots is there
_RESULTS = (
    ("properties", "properties"),
    ("toggle diagrams", "force diagram"),
    (_PLOT, "plot"),
    ("new slider", "slider for it"),
)
_SUPPORTS = ("free", "pin", "hold y", "hold x")
_FROM_HERE = (
    ("force", "load: click its end"),
    ("velocity", "velocity: click its end"),
    ("rod", "rod from here"),
)
_PARTS = (("copy", "copy"), ("duplicate", "duplicate"), ("delete", "delete"))
_OF_RODS = (("toggle cable", "cable: tension only"), ("release", "release it in the force method"))


def menu_at(context: Context, pixel: Vector) -> Menu:
    """The menu of the selected elements, or of the canvas, opened at a pixel."""
    groups = _groups(context)
    offered = offers(context.scene)
    entries = [[entry if isinstance(entry, tuple) else (entry, "") for entry in group] for group in groups]
    tools = [
        tuple(tool(context, offered[action], title) for action, title in group if action in offered)
        for group in entries
    ]
    return Menu(_title(context), tuple(group for group in tools if group), pixel, pointed=pixel)


def _title(context: Context) -> str:
    if context.scene not in LIVE or not context.has_selected:
        return ""
    named = heading(context.model, context.selected)
    return named[:1].upper() + named[1:]


def _groups(context: Context) -> Groups:
    if context.scene == FORCE_METHOD:
        unknown = [("pick unknown", "release this")]
        return [unknown, *([binding.action for binding in group] for group in toolbar(context.scene))]
    return _of_selection(context.selected) if context.has_selected else _of_canvas(context)


def _of_selection(selected: Sequence[Handle]) -> Groups:
    """What the elements have in common comes first."""
    particles = any(isinstance(handle, Particle) for handle in selected)
    one = particles and len(selected) == 1
    rods = any(isinstance(handle, Rod) for handle in selected)
    results = _RESULTS if particles or rods else _RESULTS[:1]
    only_rod = _OF_RODS if len(selected) == 1 else _OF_RODS[:1]
    return [
        results,
        _SUPPORTS if particles else (),
        _FROM_HERE if one else (),
        only_rod if rods else (),
        _PARTS,
    ]


def _of_canvas(context: Context) -> Groups:
    """Where the toolbar is hidden, all that it has, too."""
    groups: list[list[Entry]] = [
        [("place", "new particle here"), "rod", *ADDED_TOOLS, ("paste", "paste here"), "select all"],
        ["toggle run", "restart", "settle"],
        ["toggle diagrams", "toggle free bodies", "toggle utilisation"],
        ["toggle theory", "toggle energy", "toggle events", "next shape"],
        [binding.action for binding in ADDED_BUTTONS],
        ["fit", "zoom in", "zoom out", "new grid", "next grid", "toggle legend", "next theme"],
        ["environment", "screenshot", "toggle full screen", "toggle help"],
    ]
    if context.view.strip.width == 0:
        known = {entry if isinstance(entry, str) else entry[0] for group in groups for entry in group}
        whole = [[binding.action for binding in group] for group in toolbar(context.scene)]
        groups += [[action for action in group if action not in known] for group in whole]
    return groups
