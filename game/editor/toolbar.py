"""The toolbar of a session: what its buttons offer now, from the table of keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from components.tags import DiagramShown
from components.toolbar import Tool, Toolbar
from game.editor.gestures import Drawing
from systems.input.bindings import Binding, toolbar

if TYPE_CHECKING:
    from game.session import Session

Condition = Callable[["Session"], bool]


def toolbar_of(session: Session) -> Toolbar:
    """The buttons of the active scene; those whose keys would do nothing now are not enabled."""
    groups = toolbar(session.scene)
    return Toolbar(tuple(tuple(_tool(session, binding) for binding in group) for group in groups))


def _tool(session: Session, binding: Binding) -> Tool:
    action = binding.action
    pressed = action == _in_hand(session) or _PRESSED.get(action, _never)(session)
    enabled = session.scene in binding.scenes and _NEEDS.get(action, _always)(session)
    icon = "pause" if action == "toggle run" and pressed else action
    return Tool(action, binding.title, binding.key, icon, pressed, enabled)


def _in_hand(session: Session) -> str:
    """The tool with which clicks draw, or ""."""
    return session.gesture.tool if isinstance(session.gesture, Drawing) else session.view.tool


def _always(session: Session) -> bool:
    return True


def _never(session: Session) -> bool:
    return False


def _shows_diagrams(session: Session) -> bool:
    return session.view.all_diagrams or session.model.any_tagged(DiagramShown)


def _has_selected(session: Session) -> bool:
    return session.has_selected


def _has_particles(session: Session) -> bool:
    return session.model.particles.count > 0


def _guided(session: Session, condition: Callable[[Any], bool]) -> bool:
    guide = getattr(session.scenes.active, "shown_guide", None)
    return guide is not None and condition(guide)


# Actions that switch something on, and whether it is.
_PRESSED: dict[str, Condition] = {
    "toggle run": lambda session: session.scene == "simulation",
    "toggle diagrams": _shows_diagrams,
    "toggle diagrams of sets": _shows_diagrams,
    "toggle theory": lambda session: session.view.theory,
    "toggle energy": lambda session: session.view.energy,
    "toggle help": lambda session: session.view.help > 0,
}
# What must be there for an action to do something.
_NEEDS: dict[str, Condition] = {
    "undo": lambda session: session.can_undo,
    "redo": lambda session: session.can_redo,
    "copy": _has_selected,
    "duplicate": _has_selected,
    "delete": _has_selected,
    "step back": lambda session: session.timeline.first < session.model.clock.steps,
    "restart": lambda session: not session.at_beginning,
    "settle": _has_particles,
    "rod": lambda session: session.model.particles.count > 1,
    "support": _has_particles,
    "force": _has_particles,
    "velocity": _has_particles,
    "next grid": lambda session: session.model.grids.count > 0,
    "force method": lambda session: session.model.rods.count > 0,
    "release x": lambda session: _guided(session, lambda guide: guide.axis_wanted is not None),
    "release y": lambda session: _guided(session, lambda guide: guide.axis_wanted is not None),
    "release another": lambda session: _guided(session, lambda guide: guide.can_release_another),
}
