"""What a scene is, and the machine that moves between them at one point of the frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from systems.base import Mod

if TYPE_CHECKING:
    from components.camera import Viewport
    from components.field import Vector
    from components.form import Form
    from components.model import Model
    from components.toolbar import Toolbar
    from components.view import View
    from game.session import Session


Stage = tuple["Model | Form | Toolbar", "View"]


# The systems that let time pass, for scenes that want what happens in a simulation.
PHYSICS = ("run.*", "physics.*", "plasticity.*", "loads.*", "collision.*", "edit.pull")


class SceneError(ValueError):
    """A transition that does not exist; the message says from where to where, and what does."""


class Scene:
    """One mode. Systems say by their `scenes` in which they are active; keys are in input/bindings.py.

    heading: the word shown top left in red. targets: scenes that may follow. sources: further scenes that
    this one may follow, which need not know it. systems: names, or patterns such as "physics.*", of systems that
    are active in it although they do not name it; PHYSICS lists those that let time pass.
    mod: the mod that brought it, if one did; set by the program.
    """

    name: ClassVar[str]
    heading: str = ""
    targets: ClassVar[tuple[str, ...]] = ("pause",)
    sources: ClassVar[tuple[str, ...]] = ()
    systems: ClassVar[tuple[str, ...]] = ()
    mod: Mod | None = None

    @property
    def message(self) -> str:
        """What it asks, tells or refuses in a place of its own; "" if nothing."""
        return ""

    def enter(self, session: Session) -> None:
        """Called once when the scene becomes the active one."""

    def exit(self, session: Session) -> None:
        """Called once when it stops being the active one."""

    def finish(self) -> None:
        """Do now what was put off until a picture has announced it."""

    def zoom(self, session: Session, factor: float, pixel: Vector) -> None:
        """Look closer, so that what is under a pixel stays there."""
        session.view.camera.zoom(factor, pixel)
        session.view.fitted = False

    def pan(self, session: Session, pixels: Vector) -> None:
        """Move the picture by so many pixels (right, down)."""
        session.view.camera.pan(pixels)
        session.view.fitted = False

    def fit(self, session: Session) -> None:
        """Show everything."""
        session.view.fit(session.model)

    def helped(self, session: Session) -> Viewport:
        """The part of the window in which its keys are shown."""
        return session.view.canvas

    def resized(self, session: Session) -> None:
        """The window has another size."""

    def busy(self, session: Session) -> bool:
        """True while frames change something without a person's doing."""
        return False

    def focus(self, session: Session) -> tuple[Model, View]:
        """The model that a pointer picks from, and its view."""
        return session.model, session.view

    def type(self, session: Session, text: str) -> None:
        """Text was typed."""

    def click_box(self, session: Session, title: str) -> None:
        """Select the box with that title. Raises LookupError."""
        raise LookupError(f"In {self.name} there are no boxes; go to properties, save or load first.")

    @property
    def boxes(self) -> dict[str, str]:
        """What the boxes contain, by their titles."""
        return {}

    def stages(self, session: Session) -> Sequence[Stage]:
        """What is shown: models and forms, each in its view."""
        return [(session.model, session.view)]

    def hint(self, session: Session) -> str:
        """The next possible step, for the status line."""
        return ""


class Scenes:
    """The state machine: exactly one scene is active; a requested transition waits for `apply`."""

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self._by_name = {scene.name: scene for scene in scenes}
        self.active = scenes[0]
        self._requested: list[str] = []

    def __getitem__(self, name: str) -> Scene:
        return self._by_name[name]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all scenes."""
        return tuple(self._by_name)

    def request(self, *names: str) -> None:
        """Ask for a transition, or a chain of them. Raises SceneError if one is not legal."""
        here = self._by_name[self._requested[-1]] if self._requested else self.active
        for name in names:
            if name not in self._by_name:
                known = ", ".join(self._by_name)
                raise SceneError(f"There is no scene '{name}'; there are {known}.")
            if name not in here.targets and here.name not in self._by_name[name].sources:
                targets = ", ".join(here.targets)
                raise SceneError(f"From {here.name} one cannot go to {name}, only to {targets}.")
            here = self._by_name[name]
        self._requested.extend(names)

    def apply(self, session: Session) -> None:
        """Make the requested transitions: exit, then enter. From a scene of a mod that is switched off, to pause."""
        if self.active.mod is not None and self.active.mod.off and not self._requested:
            self.request("pause")
        while self._requested:
            name = self._requested.pop(0)
            self.active.exit(session)
            self.active = self._by_name[name]
            self.active.enter(session)
            if session.time_passes:
                session.history.begin_run()
            else:
                session.history.end_run()
