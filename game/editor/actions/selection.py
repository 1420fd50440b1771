"""Actions on what is selected and whose forces are shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from components.particle import Particle
from components.rod import Rod
from components.tags import DiagramShown
from game.editor.actions.drawing import click_with_tool
from game.editor.actions.registry import action
from systems.edit.picking import pick
from systems.edit.selecting import everything

if TYPE_CHECKING:
    from game.session import Session


@action("select", while_drawing=True)
def _select(session: Session, pixel: Vector) -> None:
    """With a tool in hand, a click draws instead."""
    if not click_with_tool(session, pixel):
        hit = pick(session.model, session.view, pixel)
        session.select(*([hit] if hit is not None else []))


@action("add to selection")
def _add_to_selection(session: Session, pixel: Vector) -> None:
    hit = pick(session.model, session.view, pixel)
    if hit is not None:
        chosen = session.selected
        session.select(*([h for h in chosen if h is not hit] if hit in chosen else [*chosen, hit]))


@action("select all")
def _select_all(session: Session, pixel: Vector) -> None:
    chosen = everything(session.model)
    session.select(*chosen)
    session.notice = f"{len(chosen)} elements selected."


@action("toggle diagrams", while_drawing=True)
def _toggle_diagrams(session: Session, pixel: Vector) -> None:
    """Of the selected particles and rods; of all when nothing is selected."""
    model, view = session.model, session.view
    if not session.has_selected:
        view.all_diagrams = not view.all_diagrams
        model.tag_only([], DiagramShown)
        return
    chosen = {handle.entity: handle for handle in session.selected if isinstance(handle, Particle | Rod)}
    shown = {handle.entity: handle for handle in model.tagged(DiagramShown)}
    hide = chosen.keys() <= shown.keys()
    others = [shown[entity] for entity in shown.keys() - chosen.keys()]
    model.tag_only(others if hide else [*others, *chosen.values()], DiagramShown)
