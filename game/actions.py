"""Named actions: the only way in, for keys, mouse, scripts and mods."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from components.field import Vector
from components.grid import Grid
from components.particle import Particle
from components.rod import Rod
from components.tags import DiagramShown
from components.view import drawn_positions
from systems.edit.picking import pick

if TYPE_CHECKING:
    from game.session import Session

Action = Callable[["Session", Vector], None]

ACTIONS: dict[str, Action] = {}

ZOOM_STEP = 1.2
PACE_STEP = 2.0


def action(name: str) -> Callable[[Action], Action]:
    """Register a function(session, pixel) as a named action; `pixel` is where the pointer is."""

    def register(function: Action) -> Action:
        if name in ACTIONS:
            raise ValueError(f"There is an action '{name}' already.")
        ACTIONS[name] = function
        return function

    return register


# --- scenes ------------------------------------------------------------------------------------------


@action("pause")
def _pause(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause")


@action("back")
def _back(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause")


@action("escape")
def _escape(session: Session, pixel: Vector) -> None:
    if session.selected:
        session.select()
    else:
        session.scenes.request("simulation")


@action("toggle run")
def _toggle_run(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause" if session.scene == "simulation" else "simulation")


def _to(scene: str) -> Action:
    return lambda session, pixel: session.scenes.request(scene)


for _name in ("properties", "save", "load", "force method"):
    action(_name)(_to(_name))


# --- time --------------------------------------------------------------------------------------------


@action("step")
def _step(session: Session, pixel: Vector) -> None:
    session.run(steps=1)


@action("restart")
def _restart(session: Session, pixel: Vector) -> None:
    session.restart()


@action("faster")
def _faster(session: Session, pixel: Vector) -> None:
    session.clock.faster(PACE_STEP)


@action("slower")
def _slower(session: Session, pixel: Vector) -> None:
    session.clock.faster(1.0 / PACE_STEP)


@action("natural pace")
def _natural_pace(session: Session, pixel: Vector) -> None:
    session.clock.factor = 1.0


@action("undo")
def _undo(session: Session, pixel: Vector) -> None:
    session.undo()


@action("redo")
def _redo(session: Session, pixel: Vector) -> None:
    session.redo()


# --- selection and diagrams ------------------------------------------------------------------------------


@action("select")
def _select(session: Session, pixel: Vector) -> None:
    hit = pick(session.model, session.view.camera, pixel)
    session.select(*([hit] if hit is not None else []))


@action("add to selection")
def _add_to_selection(session: Session, pixel: Vector) -> None:
    hit = pick(session.model, session.view.camera, pixel)
    if hit is not None:
        chosen = session.selected
        session.select(*([h for h in chosen if h is not hit] if hit in chosen else [*chosen, hit]))


@action("toggle diagrams")
def _toggle_diagrams(session: Session, pixel: Vector) -> None:
    """Of the selected particles and rods; of all when nothing is selected."""
    model, view = session.model, session.view
    chosen = [handle for handle in session.selected if isinstance(handle, Particle | Rod)]
    if not session.selected:
        view.all_diagrams = not view.all_diagrams
        for handle in model.tagged(DiagramShown):
            model.untag(handle, DiagramShown)
        return
    shown = set(map(id, model.tagged(DiagramShown)))
    hide = all(id(handle) in shown for handle in chosen)
    for handle in chosen:
        (model.untag if hide else model.tag)(handle, DiagramShown)


# --- grids -------------------------------------------------------------------------------------------


@action("new grid")
def _new_grid(session: Session, pixel: Vector) -> None:
    with session.model.transaction("new grid"):
        for grid in session.model.grids:
            if grid.shown:
                grid.shown = False
        session.model.create(Grid)


@action("next grid")
def _next_grid(session: Session, pixel: Vector) -> None:
    """The one after the shown grid; after the last, none; after none, the first."""
    grids = list(session.model.grids)
    shown = [index for index, grid in enumerate(grids) if grid.shown]
    following = shown[-1] + 1 if shown else 0
    with session.model.transaction("next grid"):
        for index, grid in enumerate(grids):
            if grid.shown != (index == following):
                grid.shown = index == following


# --- view --------------------------------------------------------------------------------------------


@action("fit")
def _fit(session: Session, pixel: Vector) -> None:
    session.view.camera.fit(drawn_positions(session.model))


@action("zoom in")
def _zoom_in(session: Session, pixel: Vector) -> None:
    session.view.camera.zoom(ZOOM_STEP, pixel)


@action("zoom out")
def _zoom_out(session: Session, pixel: Vector) -> None:
    session.view.camera.zoom(1.0 / ZOOM_STEP, pixel)


@action("toggle legend")
def _toggle_legend(session: Session, pixel: Vector) -> None:
    session.view.legend = not session.view.legend


@action("toggle help")
def _toggle_help(session: Session, pixel: Vector) -> None:
    session.view.help = not session.view.help


@action("pan")
def _pan(session: Session, pixel: Vector) -> None:
    """Here `pixel` is how far the pointer was dragged."""
    session.view.camera.pan(pixel)


@action("toggle full screen")
def _toggle_full_screen(session: Session, pixel: Vector) -> None:
    if session.window is not None:
        session.window.toggle_full_screen()


@action("screenshot")
def _screenshot(session: Session, pixel: Vector) -> None:
    if session.window is not None:
        session.notice = f"Picture saved: {session.window.screenshot()}"
