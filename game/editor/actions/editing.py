"""Actions that make, change and delete elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from components.particle import Particle
from game.editor.actions.registry import action
from systems.edit.moving import Movable, nudged
from systems.edit.picking import pick_particle
from systems.edit.placing import place
from systems.edit.refusal import Refusal
from systems.edit.rods import delete
from systems.edit.supports import next_support
from systems.forms.properties import heading

if TYPE_CHECKING:
    from game.session import Session


@action("place", while_drawing=True)
def _place(session: Session, pixel: Vector) -> None:
    """Under the pointer; from the toolbar, with the clicks that follow."""
    if session.view.strip.contains(pixel):
        take_up(session, "place")
        return
    particle = place(session.model, session.view, pixel)
    x, y = particle.position
    session.notice = f"{session.name(particle)}: ({100.0 * x:g}, {100.0 * y:g}) cm"


@action("delete")
def _delete(session: Session, pixel: Vector) -> None:
    doomed = session.selected
    if not doomed:
        raise Refusal("Nothing is selected; click what is to be deleted first.")
    before = {table.name: table.count for table in session.model.tables.values()}
    named = session.name(doomed[0])
    delete(session.model, doomed)
    gone = {name: count - session.model.tables[name].count for name, count in before.items()}
    told = [f"{count} {name if count > 1 else name[:-1]}" for name, count in gone.items() if count]
    session.notice = f"{named} deleted." if sum(gone.values()) == 1 else f"{', '.join(told)} deleted."


@action("support")
def _support(session: Session, pixel: Vector) -> None:
    """Of the particle under the pointer, or of the selected ones; without any, of those clicked or dragged next."""
    hit = pick_particle(session.model, session.view, pixel)
    chosen = [handle for handle in session.selected if isinstance(handle, Particle)]
    if hit is not None and hit not in chosen:
        chosen = [hit]
    if not chosen:
        take_up(session, "support")
        return
    support = next_support(session.model, chosen)
    session.notice = f"{_all_of(session, chosen)}: {support}"


def take_up(session: Session, tool: str) -> None:
    """Let clicks use a tool from now on; if they do already, put it away."""
    session.leave_gesture()
    session.view.tool = "" if session.view.tool == tool else tool


def _all_of(session: Session, particles: list[Particle]) -> str:
    return session.name(particles[0]) if len(particles) == 1 else f"{len(particles)} particles"


def nudge(session: Session, direction: Vector, *, far: bool) -> bool:
    """Move what is selected by about a pixel, or (far) a grid spacing; False if nothing is."""
    model = session.model
    chosen = Movable(model, session.selected)
    if not len(chosen):
        return False
    positions = nudged(model, session.view, chosen.positions, direction, far=far)
    moved = [*chosen.particles, *chosen.others]
    with session.history.as_one(("nudge", *(handle.entity for handle in moved))):
        chosen.place(positions)
    x, y = positions[0].tolist()
    named = _all_of(session, chosen.particles) if not chosen.others else heading(model, moved)
    session.notice = f"{named[:1].upper()}{named[1:]}: ({100.0 * x:g}, {100.0 * y:g}) cm"
    return True
