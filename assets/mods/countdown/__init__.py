"""Count down: a mode between pause and simulation, with keys of its own."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from components import Vector
from game.editor.scenes import Scene

if TYPE_CHECKING:
    from game import Session
    from game.mods import App

SECONDS = 3.0


class CountDown(Scene):
    name = "count down"
    sources = ("pause",)
    targets = ("pause", "simulation")

    def enter(self, session: Session) -> None:
        self.left = SECONDS

    def advance(self, session: Session, elapsed: float) -> None:
        self.left -= elapsed
        self.heading = f"{math.ceil(self.left)} …"
        if self.left <= 0.0:
            session.scenes.request("simulation")

    def busy(self, session: Session) -> bool:
        return True

    def hint(self, session: Session) -> str:
        return "Space begin now     + a second more     Esc back"


def more(session: Session, pixel: Vector) -> None:
    scene = session.scenes.active
    assert isinstance(scene, CountDown)
    scene.left += 1.0


def plugin(app: App) -> None:
    app.scene(CountDown)
    here = ("count down",)
    go = app.action("countdown.start", key="n", scenes=("pause",), title="count down, then run")
    go(lambda session, pixel: session.scenes.request("count down"))
    app.action("countdown.more", key="+", scenes=here, title="a second more")(more)
    app.key("space", "toggle run", here, "begin now")
    app.key("escape", "back", here, "back to pause")
