"""Showing: what the view says of a session, brought up to date once a frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from components.view import Preview, Readout, Status
from game.editor.gestures import TOOL_HINTS
from game.editor.readouts import own_readouts
from systems.base import StopReason
from systems.edit.refusal import Refusal
from systems.input.bindings import LIVE, help_lines
from systems.render.help import help_pages

if TYPE_CHECKING:
    from game.session import Session

COMPILING = "Preparing the step program, which takes a while for the first model of its kind:"
FLASH = 0.15  # s shown, for which an impact is marked
MOST_FLASHES = 500  # impacts marked at a time

PANELS: list[Callable[[Session], Sequence[Readout]]] = []  # that mods add beside the model


def show(session: Session) -> None:
    """Let the view show the session as it is now."""
    view, scene = session.view, session.scenes.active
    view.forces_known = session.waited_for(session.simulation) is None
    said = _awaited(session) or session.notice
    view.preview = _preview(session)
    view.flashes = _flashes(session)
    view.heading = scene.heading
    view.shape = session.desk.shapes.shown
    pages = pages_of_help(session) if view.help else []
    view.keys, view.more_keys = pages[view.help - 1] if pages else [], view.help < len(pages)
    _show_readouts(session)
    view.status = Status(
        time=session.time,
        speed=session.clock.shown_pace if session.busy else 0.0,
        state=_state_word(session),
        hint=_drawing_hint(session) or scene.hint(session),
        problem=_problem(session),
        notice=said or " ".join(remark.message for remark in session.remarks),
    )


def pages_of_help(session: Session) -> list[list[tuple[str, str]]]:
    """What can be pressed in the active scene; the page that is shown is one of them."""
    scene, view = session.scenes.active, session.view
    pages = help_pages(help_lines(scene.name), scene.helped(session), view.pixel_ratio)
    view.help = min(view.help, len(pages))
    return pages


def _show_readouts(session: Session) -> None:
    """All panels, and in which order they came."""
    view = session.view
    view.readouts = (*own_readouts(session), *_panels(session))
    latest, since = max(view.since.values(), default=0), view.since
    view.since = {
        readout.title: since.get(readout.title, latest + number)
        for number, readout in enumerate(view.readouts, start=1)
    }


def _panels(session: Session) -> Iterator[Readout]:
    return (readout for panel in PANELS for readout in panel(session))


def make_room(session: Session) -> None:
    """Let the model stand beside the panels, if there are any that would cover it.

    After actions, and never because of time or frames, so that a recording is replayed in the same picture.
    """
    view = session.view
    wanted = view.theory or view.energy or any(readout.is_large for readout in _panels(session))
    view.share(session.model, shares=view.legend and wanted)


def _awaited(session: Session) -> str:
    """That a step program is waited for, "" if none is (any more)."""
    waited = session.waited_for(session.awaited) if session.awaited is not None else None
    if waited is None:
        session.awaited = None
        return ""
    return f"{COMPILING} {waited:.0f} s."


def _flashes(session: Session) -> NDArray[np.float64]:
    """Where particles collided within the last moment that was shown."""
    impacts = session.impacts
    if not session.busy or len(impacts) == 0:
        return np.zeros((0, 2))
    since = session.time - FLASH * session.clock.shown_pace
    first = max(int(np.searchsorted(impacts.time, since)), len(impacts) - MOST_FLASHES)
    return np.column_stack([impacts.x[first:], impacts.y[first:]])


def _preview(session: Session) -> Preview | None:
    try:
        return session.gesture.preview(session, session.pointer) if session.gesture is not None else None
    except Refusal as error:
        session.gesture, session.notice = None, str(error)
        return None


def _drawing_hint(session: Session) -> str:
    if session.scene not in LIVE:
        return ""
    return session.gesture.hint if session.gesture is not None else TOOL_HINTS.get(session.view.tool, "")


def _state_word(session: Session) -> str:
    if session.simulation.halted:
        return "at rest" if session.simulation.reason is StopReason.REST else "diverged"
    if session.awaited is not None:
        return "preparing"
    if not session.busy:
        return "paused"
    return "running, slower than asked" if session.clock.lagging else "running"


def _problem(session: Session) -> str:
    """What went wrong, or a person should know though the run goes on."""
    simulation = session.simulation
    if session.fault:
        return f"{session.fault} Esc takes this away."
    if simulation.reason is StopReason.DIVERGED and simulation.halted:
        return simulation.message
    return simulation.warning or simulation.note
