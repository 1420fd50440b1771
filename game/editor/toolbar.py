"""Toolbar: the buttons of the active scene, from the table of keys; what is on, and what would do something now."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pinjoint.components.bent import is_frame
from pinjoint.components.language import tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.tags import DiagramShown
from pinjoint.components.toolbar import Tool, Toolbar
from pinjoint.editor.context import Context
from pinjoint.editor.gestures.drawing import Drawing
from pinjoint.force_method import PARTS
from pinjoint.systems.edit.dividing import DIVISIONS
from pinjoint.systems.edit.rods import is_rigid
from pinjoint.systems.edit.supports import SUPPORTS, Held, held
from pinjoint.systems.input.bindings import Binding, offers, toolbar
from pinjoint.systems.render.diagrams import NAMES

Condition = Callable[[Context], bool]


def toolbar_of(context: Context) -> Toolbar:
    """The buttons of the active scene; those whose keys would do nothing now are not enabled."""
    groups = toolbar(context.scenes.active.tools)
    more = offers(context.scenes.active.tools).get("more tools")
    return Toolbar(
        tuple(tuple(tool(context, binding) for binding in group) for group in groups),
        None if more is None else tool(context, more),
    )


def tool(context: Context, binding: Binding, title: str = "") -> Tool:
    """What a button or an entry of a menu says of an action now; title: where that of the table does not fit."""
    action = binding.action
    hidden = context.view.free_bodies and action in _OF_ONE_PIECE
    pressed = action == _in_hand(context) or (not hidden and action in _PRESSED and _PRESSED[action](context))
    enabled = context.scenes.active.tools in binding.scenes and (
        action not in _NEEDS or _NEEDS[action](context)
    )
    icon = "pause" if action == "toggle run" and pressed else action
    if action == "toggle diagrams" and pressed and is_frame(context.model):
        icon, title = (
            f"diagram {context.view.quantity}",
            title or tr("diagrams, now: {quantity}", quantity=tr(NAMES[context.view.quantity])),
        )
    return Tool(action, tr(title or binding.title), binding.key, icon, pressed, enabled)


def _in_hand(context: Context) -> str:
    """The tool with which clicks draw, or ""."""
    return context.gesture.tool if isinstance(context.gesture, Drawing) else context.view.tool


def _held(wanted: Held) -> Condition:
    """Whether all selected particles have a support."""

    def holds(context: Context) -> bool:
        particles = context.selected_of(Particle)
        return bool(particles) and all(held(particle) == wanted for particle in particles)

    return holds


def _are_cables(context: Context) -> bool:
    rods = context.selected_of(Rod)
    return bool(rods) and all(rod.tension_only for rod in rods)


def _are_rigid(context: Context) -> bool:
    """Whether the selected rods, or else those that will be drawn, are rigid at both ends."""
    rods = [] if _in_hand(context) == "rod" else context.selected_of(Rod)
    return all(is_rigid(rod, end) for rod in rods for end in (0, 1)) if rods else context.view.rigid


def _shows_diagrams(context: Context) -> bool:
    if context.has_selected and not context.view.all_diagrams:
        shown = {handle.entity for handle in context.model.tagged(DiagramShown)}
        return {handle.entity for handle in context.selected_of(Particle, Rod)} <= shown
    return context.view.all_diagrams or context.model.any_tagged(DiagramShown)


def _guided(condition: Callable[[Any], bool]) -> Condition:
    """Whether there is a guide of the force method of which a condition is true."""

    def holds(context: Context) -> bool:
        guide = getattr(context.scenes.active, "shown_guide", None)
        return guide is not None and condition(guide)

    return holds


# By action that switches something: whether it is on.
_PRESSED: dict[str, Condition] = {
    "toggle run": lambda context: context.scenes.active.tools == "simulation",
    "toggle diagrams": _shows_diagrams,
    "toggle diagrams of sets": _shows_diagrams,
    "properties": lambda context: context.scene == "properties",
    "toggle free bodies": lambda context: context.view.free_bodies,
    "toggle utilisation": lambda context: context.view.utilisation,
    "toggle theory": lambda context: context.view.theory,
    "toggle energy": lambda context: context.view.energy,
    "toggle events": lambda context: context.view.events,
    "next shape": lambda context: context.view.shape is not None,
    "rigid": _are_rigid,
    **{name: _held(wanted) for name, wanted in SUPPORTS.items()},
    "toggle cable": _are_cables,
    "toggle help": lambda context: context.view.help > 0,
}
# What these show is not seen while rods and joints are apart.
_OF_ONE_PIECE = ("toggle diagrams", "toggle utilisation", "next shape")
# By action: whether it would do something now.
_NEEDS: dict[str, Condition] = {
    "undo": lambda context: context.can_undo,
    "redo": lambda context: context.can_redo,
    **dict.fromkeys(("copy", "duplicate", "delete"), lambda context: context.has_selected),
    "step back": lambda context: context.document.timeline.first < context.model.clock.steps,
    "restart": lambda context: not context.document.is_undeformed,
    **dict.fromkeys(
        ("settle", "support", "force", "moment", "velocity"),
        lambda context: context.model.particles.count > 0,
    ),
    **dict.fromkeys(("hinge", "weight along"), lambda context: context.model.rods.count > 0),
    **dict.fromkeys(
        DIVISIONS.values(), lambda context: any(r.bending_stiffness > 0.0 for r in context.selected_of(Rod))
    ),
    "next grid": lambda context: context.model.grids.count > 0,
    "force method": lambda context: context.model.rods.count > 0,
    **dict.fromkeys(("release x", "release y"), _guided(lambda guide: guide.axis_wanted is not None)),
    "release moment": _guided(lambda guide: guide.clamp_wanted),
    "report": _guided(lambda guide: guide.part == PARTS),
    "pick unknown": _guided(lambda guide: guide.part == 2),
    "release another": _guided(lambda guide: guide.can_release_another),
}
