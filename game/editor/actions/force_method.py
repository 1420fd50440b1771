"""Actions of the force method's guide."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from components.field import Vector
from game.editor.actions.registry import action
from game.editor.scenes.force_method import ForceMethod
from game.force_method import PARTS
from systems.edit.picking import pick
from systems.edit.refusal import Refusal

if TYPE_CHECKING:
    from game.force_method.guide import Guide
    from game.session import Session


def _guide(session: Session) -> Guide | None:
    scene = session.scenes.active
    return scene.guide if isinstance(scene, ForceMethod) else None


def _work(session: Session, text: str, do: Callable[[], object]) -> None:
    scene = session.scenes.active
    assert isinstance(scene, ForceMethod)
    scene.work(session, text, do)


@action("next part")
def _next_part(session: Session, pixel: Vector) -> None:
    guide = _guide(session)
    if guide is None:
        return
    if guide.part == PARTS:
        session.scenes.request("pause")
    elif guide.part == 2:
        guide.next()
    else:
        _work(session, f"Computing part {guide.part + 1}", guide.next)


@action("pick unknown")
def _pick_unknown(session: Session, pixel: Vector) -> None:
    guide = _guide(session)
    if guide is not None and guide.part == 2:
        model, view = session.focus
        hit = pick(model, view, pixel) if view.camera.viewport.contains(pixel) else None
        _work(session, "Releasing it and solving anew", lambda: guide.pick(hit))


@action("release x")
def _release_x(session: Session, pixel: Vector) -> None:
    _pick_axis(session, 0)


@action("release y")
def _release_y(session: Session, pixel: Vector) -> None:
    _pick_axis(session, 1)


@action("release another")
def _release_another(session: Session, pixel: Vector) -> None:
    guide = _guide(session)
    if guide is not None and not guide.can_release_another:
        raise Refusal(
            "Every unknown is released." if guide.part == PARTS else "Go through all parts first, with K."
        )
    if guide is not None:
        guide.release_another()


def _pick_axis(session: Session, axis: int) -> None:
    guide = _guide(session)
    if guide is not None:
        _work(session, "Releasing it and solving anew", lambda: guide.pick_axis(axis))


@action("toggle diagrams of sets")
def _toggle_diagrams(session: Session, pixel: Vector) -> None:
    guide = _guide(session)
    if guide is not None:
        session.view.all_diagrams = not session.view.all_diagrams
        for one in guide.shown:
            one.view.all_diagrams = session.view.all_diagrams
