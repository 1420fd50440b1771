"""Actions that begin, follow and end what is drawn and dragged with the pointer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from game.editor.actions.editing import take_up
from game.editor.actions.registry import ACTIONS, Action, action
from game.editor.gestures import TOOLS, BoxSelect, Drawing, DrawSupport, Move, MovePoint, PullParticle
from systems.edit.picking import pick_line, pick_particle, pick_point
from systems.edit.refusal import Refusal

if TYPE_CHECKING:
    from game.session import Session


@action("drag", while_drawing=True)
def _drag(session: Session, pixel: Vector) -> None:
    """With a tool, draw; else drag what is under the pointer, or a box to select where nothing is."""
    model, view = session.model, session.view
    particle = pick_particle(model, view, pixel)
    tool = session.gesture.tool if isinstance(session.gesture, Drawing) else view.tool
    if tool == DrawSupport.tool and particle is not None:
        session.gesture = DrawSupport(session, particle)
    elif tool:
        _use_at(session, tool, pixel)
    elif particle is not None and session.scene == "simulation":
        session.gesture = PullParticle(session, particle)
    elif session.scene == "pause" and particle is None and (grip := pick_point(model, view, pixel)) is not None:
        session.gesture = MovePoint(session, grip)
    elif session.scene == "pause" and (hit := particle or pick_line(model, view, pixel)) is not None:
        session.gesture = Move(session, hit, pixel)
    else:
        session.gesture = BoxSelect(session, pixel, adding=False)


@action("drag to add")
def _drag_to_add(session: Session, pixel: Vector) -> None:
    session.gesture = BoxSelect(session, pixel, adding=True)


@action("drag to", while_drawing=True)
def _drag_to(session: Session, pixel: Vector) -> None:
    if session.gesture is not None:
        session.gesture.move(session, pixel)


@action("drop", while_drawing=True)
def _drop(session: Session, pixel: Vector) -> None:
    gesture, session.gesture = session.gesture, None
    if gesture is not None:
        gesture.drop(session, pixel)


def _use_at(session: Session, tool: str, pixel: Vector) -> None:
    """Begin at the particle under the pointer; without one, what was begun by a key goes on.

    A tool that is done with at once is just used.
    """
    if tool not in TOOLS:
        ACTIONS[tool](session, pixel)
        return
    begun = TOOLS[tool].begin(session, pixel)
    if begun is not None:
        session.gesture = begun
    elif session.gesture is None:
        raise Refusal("Begin at a particle. Esc puts the tool away, P makes a new particle.")


def finish_drawing(session: Session, pixel: Vector) -> None:
    """End what was begun by a key or a click; where that is refused, it goes on."""
    assert session.gesture is not None
    session.gesture.drop(session, pixel)
    session.gesture = None


def click_with_tool(session: Session, pixel: Vector) -> bool:
    """Let a click begin or end a drawing; False if no tool is in hand."""
    if isinstance(session.gesture, Drawing):
        finish_drawing(session, pixel)
    elif session.view.tool:
        _use_at(session, session.view.tool, pixel)
    else:
        return False
    return True


def use(tool: str) -> Action:
    """A tool's key: where it can begin it does, pressed again it ends; elsewhere it takes the tool up."""

    def key(session: Session, pixel: Vector) -> None:
        if isinstance(session.gesture, Drawing) and session.gesture.tool == tool:
            finish_drawing(session, pixel)
            return
        session.leave_gesture()
        begun = TOOLS[tool].begin(session, pixel)
        if begun is not None:
            session.gesture = begun
        else:
            take_up(session, tool)

    return key


for _tool in TOOLS:
    action(_tool, while_drawing=True)(use(_tool))


def put_away(session: Session) -> bool:
    """Cancel what is being drawn, else put the tool away; False if there is neither."""
    gesture, session.gesture = session.gesture, None
    if gesture is not None:
        gesture.cancel(session)
    elif session.view.tool:
        session.view.tool = ""
    else:
        return False
    return True
