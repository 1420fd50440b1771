"""Actions in the boxes and tiles of properties, save and load."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from components.field import Vector
from game.editor.actions.registry import action
from game.editor.scenes.base import SceneError
from game.editor.scenes.form import FormScene
from systems.forms import typing

if TYPE_CHECKING:
    from game.session import Session


def _form_scene(session: Session) -> FormScene:
    scene = session.scenes.active
    if not isinstance(scene, FormScene):
        raise SceneError(f"In {scene.name} there are no boxes; go to properties, save or load first.")
    return scene


def _on_form(name: str, act: Callable[[FormScene, Session], object]) -> None:
    @action(name)
    def _act(session: Session, pixel: Vector) -> None:
        act(_form_scene(session), session)


_on_form("accept", lambda scene, session: scene.accept(session))
_on_form("cancel", lambda scene, session: scene.cancel(session))
_on_form("next box", lambda scene, session: scene.next_box(session, 1))
_on_form("previous box", lambda scene, session: scene.next_box(session, -1))
_on_form("erase", lambda scene, session: scene.erase(session))
_on_form("erase after", lambda scene, session: scene.erase(session, after=True))
_on_form("go left", lambda scene, session: scene.move(session, "left"))
_on_form("go right", lambda scene, session: scene.move(session, "right"))
_on_form("go up", lambda scene, session: scene.move(session, "up"))
_on_form("go down", lambda scene, session: scene.move(session, "down"))
_on_form("to the beginning", lambda scene, session: typing.place_caret(scene.form, 0))
_on_form("to the end", lambda scene, session: typing.place_caret(scene.form, typing.MOST_CHARACTERS))
_on_form("mark all", lambda scene, session: typing.mark_all(scene.form))
_on_form("copy text", lambda scene, session: scene.copy(session))
_on_form("cut text", lambda scene, session: scene.cut(session))
_on_form("paste text", lambda scene, session: scene.paste(session))
_on_form("scroll up", lambda scene, session: scene.scroll(session, -1))
_on_form("scroll down", lambda scene, session: scene.scroll(session, 1))
_on_form("page up", lambda scene, session: scene.page(session, -1))
_on_form("page down", lambda scene, session: scene.page(session, 1))


@action("click form")
def _click_form(session: Session, pixel: Vector) -> None:
    _form_scene(session).click(session, pixel)
