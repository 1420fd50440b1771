"""Actions on the view and the window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from game.editor.actions.registry import Action, action
from game.editor.shapes import NoShape
from game.editor.view_model import pages_of_help
from systems.edit.refusal import Refusal
from systems.render.theme import load_theme

if TYPE_CHECKING:
    from game.session import Session


ZOOM_STEP = 1.2
THEMES = ("light", "dark", "colour-blind", "colour-blind-dark")  # in the order in which one follows another


@action("fit", while_drawing=True)
def _fit(session: Session, pixel: Vector) -> None:
    session.scenes.active.fit(session)


@action("zoom in", while_drawing=True)
def _zoom_in(session: Session, pixel: Vector) -> None:
    session.scenes.active.zoom(session, ZOOM_STEP, pixel)


@action("zoom out", while_drawing=True)
def _zoom_out(session: Session, pixel: Vector) -> None:
    session.scenes.active.zoom(session, 1.0 / ZOOM_STEP, pixel)


@action("toggle legend", while_drawing=True)
def _toggle_legend(session: Session, pixel: Vector) -> None:
    session.view.legend = not session.view.legend


@action("toggle theory", while_drawing=True)
def _toggle_theory(session: Session, pixel: Vector) -> None:
    session.view.theory = not session.view.theory


@action("toggle energy", while_drawing=True)
def _toggle_energy(session: Session, pixel: Vector) -> None:
    session.view.energy = not session.view.energy


@action("next shape", while_drawing=True)
def _next_shape(session: Session, pixel: Vector) -> None:
    """Mechanisms, then natural modes, then none."""
    try:
        session.desk.shapes.next()
    except NoShape as error:
        raise Refusal(str(error)) from None
    session.view.shape = session.desk.shapes.shown


@action("next theme", while_drawing=True)
def _next_theme(session: Session, pixel: Vector) -> None:
    """The one after the present one."""
    view = session.view
    after = (*THEMES[THEMES.index(view.theme) + 1 :], THEMES[0]) if view.theme in THEMES else THEMES
    view.theme = after[0]
    session.notice = f"Theme: {load_theme(view.theme).title}"


@action("toggle help", while_drawing=True)
def _toggle_help(session: Session, pixel: Vector) -> None:
    """The next page; after the last, none."""
    session.view.help = (session.view.help + 1) % (len(pages_of_help(session)) + 1)


@action("close help", while_drawing=True)
def _close_help(session: Session, pixel: Vector) -> None:
    session.view.help = 0


@action("pan", while_drawing=True)
def _pan(session: Session, pixel: Vector) -> None:
    """Here `pixel` is how far the pointer was dragged."""
    session.scenes.active.pan(session, pixel)


@action("toggle full screen", while_drawing=True)
def _toggle_full_screen(session: Session, pixel: Vector) -> None:
    if session.window is not None:
        session.window.toggle_full_screen()


def _magnify(by: int) -> Action:
    """Larger or smaller type, symbols and panels, in a window."""

    def act(session: Session, pixel: Vector) -> None:
        if session.window is not None:
            session.notice = f"Size of type and symbols: {session.window.magnify(by)}"

    return act


for _name, _by in (("larger", 1), ("smaller", -1), ("usual size", 0)):
    action(_name, while_drawing=True)(_magnify(_by))


@action("screenshot", while_drawing=True)
def _screenshot(session: Session, pixel: Vector) -> None:
    if session.window is None:
        return
    try:
        session.notice = f"Picture saved: {session.window.screenshot()}"
    except OSError as error:
        raise Refusal(
            f"No picture was saved: {error.filename}: {error.strerror}. Start Pinjoint in a folder where you may write."
        ) from None
