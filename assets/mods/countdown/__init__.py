"""Count down: a mode between pause and simulation, with keys of its own."""

from __future__ import annotations

import math
from typing import Any

from pinjoint.api import App, Context, Phase, Scene, System

SECONDS = 3.0


class CountDown(Scene):
    name = "count down"
    sources = ("pause",)
    targets = ("pause", "simulation")

    def enter(self, session: Context) -> None:
        self.left = SECONDS

    def busy(self, session: Context) -> bool:
        return True

    def hint(self, session: Context) -> str:
        return "Space begin now     + a second more     Esc back"


class Ticking(System):
    name = "countdown.ticking"
    phase = Phase.STEP
    scenes = ("count down",)

    def process(self, frame: Any) -> None:
        scene = frame.session.scenes.active
        scene.left -= frame.elapsed
        scene.heading = f"{math.ceil(scene.left)} …"
        if scene.left <= 0.0:
            frame.session.scenes.request("simulation")


def more(session: Any, pixel: Any) -> None:
    session.scenes.active.left += 1.0


def plugin(app: App) -> None:
    app.scene(CountDown)
    app.system(Ticking)
    here = ("count down",)
    start = app.action("countdown.start", key="y", scenes=("pause",), title="count down, then run")
    start(lambda session, pixel: session.scenes.request("count down"))
    app.action("countdown.more", key="+", scenes=here, title="a second more")(more)
    app.key("space", "toggle run", here, "begin now")
    app.key("escape", "back", here, "back to pause")
