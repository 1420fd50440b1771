"""Frame: the argument of frame systems, and the systems that perform presses and update the view."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pinjoint.components.field import Vector
from pinjoint.components.model import Model
from pinjoint.editor.context import Context
from pinjoint.editor.view_model import exaggerate, follows
from pinjoint.systems.base import Phase, System
from pinjoint.systems.input.actions import TEXT


@dataclass
class Frame:
    """One frame: the session, the seconds since the last frame, and what was pressed.

    pressed: (key or button, pixel) in the order in which a person pressed them; see input/actions.py.
    """

    session: Context
    elapsed: float
    pressed: list[tuple[str, Vector]] = field(default_factory=list)

    @property
    def scene(self) -> str:
        """The name of the active scene."""
        return self.session.scene

    @property
    def model(self) -> Model:
        """The model that is open."""
        return self.session.model


class HeadlessFrame(Frame):
    """A frame of a run without frames: nothing is pressed or drawn, and systems of the run's scene are active."""

    @property
    def scene(self) -> str:
        """The scene whose systems act in the run."""
        return self.session.simulation.programs.scene


class Exaggerate(System):
    """Lets the automatic displacement scale suit the model before anything is done to it."""

    name = "edit.scale"
    phase = Phase.EDIT
    before = ("edit.actions",)
    reads = ("document", "state")
    writes = ("scale",)

    def process(self, frame: Any) -> None:
        """Choose the scale anew where the model was edited, or has come to a stand."""
        exaggerate(frame.session)


class Actions(System):
    """Turns what was pressed into actions, lets the view follow, and makes the transitions of scenes requested."""

    name = "edit.actions"
    phase = Phase.EDIT
    reads = ("pressed",)
    writes = ("document", "scene", "view")

    def __init__(self) -> None:
        self._keyed = ""  # the scene in which a key was pressed last

    def process(self, frame: Any) -> None:
        """Let the view follow, perform the actions of the frame in their order, then let the scene change."""
        session = frame.session
        if follows(session):
            session.press("home")  # recorded as the key that does so
        for key, pixel in frame.pressed if session.footer is None else ():
            if not key.startswith(TEXT):
                self._keyed = session.scene
            elif self._keyed != session.scene:  # the key that led here; it is not meant for a box
                continue
            session.press(key, pixel)
        session.scenes.apply(session)


class ShowView(System):
    """Brings what the view says about the session up to date."""

    name = "render.view"
    phase = Phase.RENDER
    reads = ("document", "state", "scene")
    writes = ("view",)

    def process(self, frame: Any) -> None:
        """Status line, panels, previews, flashes, the toolbar."""
        frame.session.update_view(frame.elapsed)
