"""How long one waits for the program: from its start to a picture, to a run, and after edits of a running model.

Each row is a process of its own, first with an empty cache, then with what that left in it. The window is one of
SDL's dummy driver unless the environment names another: SDL_VIDEODRIVER=x11 with a DISPLAY opens real ones.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from game import Session
from game.preparation import AHEAD
from systems.collision.driven.compiled import DRIVEN
from systems.program.writer import form_of

Row = dict[str, Any]

PATIENCE = 120.0  # s that anything may take
SETTLED = 1.0  # s for which frames are watched after what was waited for
JOURNEYS = {
    "triangle, plasticity on": ("isostatic", "plasticity"),
    "triangle, one rod more": ("isostatic", "rod"),
    "bridge": ("warren_bridge", ""),
    "billiards": ("billiards_break", ""),
    "ball on a truss": ("ball_on_truss", ""),
}
BEGAN = "PINJOINT_BENCH_BEGAN"


def report(*, quick: bool) -> dict[str, list[Row]]:
    """The tables: seconds from the start to a picture and to a run, longest gaps between frames; compiling; commands."""
    names = list(JOURNEYS)[:2] if quick else list(JOURNEYS)
    return {
        "window": [row for name in names for row in journeys(name)],
        "compiling": compiling((DRIVEN.name,) if quick else ("isostatic", "ball_on_truss", *_ahead())),
        "commands": commands(),
    }


def journeys(name: str) -> list[Row]:
    """One with an empty cache and one with a full one."""
    with tempfile.TemporaryDirectory() as folder:
        return [_in_a_process(name, cache, Path(folder)) for cache in ("empty", "full")]


def _in_a_process(name: str, cache: str, folder: Path) -> Row:
    cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    words = [sys.executable, "-m", "tests.benchmarks.start", *JOURNEYS[name]]
    done = subprocess.run(words, env=_environment(folder), check=True, stdout=subprocess.PIPE, text=True)
    cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - cpu
    return {"journey": name, "cache": cache, **json.loads(done.stdout.splitlines()[-1]), "cpu_s": cpu}


def _environment(folder: Path) -> dict[str, str]:
    """That of somebody who never used the program, but for what is in the folder and Python's own compiling."""
    homes = {f"XDG_{what}_HOME": str(folder / what) for what in ("CACHE", "DATA", "CONFIG")}
    usual = {"SDL_VIDEODRIVER": "dummy", **os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    return {**usual, **homes, BEGAN: repr(time.time())}


def compiling(whats: Sequence[str]) -> list[Row]:
    """Processor seconds, with an empty cache, of processes that compile ahead of need: programs of models, or parts."""
    rows, ahead = [], _ahead()
    for what in whats:
        job = ahead.get(what) or _job(Session.open(what))
        with tempfile.TemporaryDirectory() as folder:
            cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            words = [sys.executable, "-m", "game.prepare", "--no-mods", *job]
            subprocess.run(words, env=_environment(Path(folder)), check=True, stdout=subprocess.DEVNULL)
            rows.append({"what": what, "cpu_s": resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - cpu})
    return rows


def _ahead() -> dict[str, list[str]]:
    """The names of the units that each process compiles ahead of need."""
    return {" ".join(unit.name for unit in units): [unit.name for unit in units] for units in AHEAD}


def _job(session: Session) -> list[str]:
    """What compiles the program of its model."""
    simulation = session.simulation
    plan = simulation.plan
    return [
        simulation.integrator.key,
        form_of(session.model, simulation.integrator),
        *(system.name for system in plan),
    ]


def commands() -> list[Row]:
    """Seconds of commands and imports in a fresh process, everything compiled already; the best of three."""
    words = {
        "import numpy, esper": ["-c", "import numpy, esper"],
        "import game": ["-c", "import numpy, esper, game"],
        "pinjoint --help": ["-m", "game", "--help"],
        "pinjoint run isostatic --static": ["-m", "game", "run", "isostatic", "--static"],
        "pinjoint run isostatic": ["-m", "game", "run", "isostatic"],
    }
    rows = []
    for name, some in words.items():
        seconds, cpu = zip(*(_cost(some) for _ in range(3)), strict=True)
        rows.append({"command": name, "seconds": min(seconds), "cpu_s": min(cpu)})
    return rows


def _cost(words: list[str]) -> tuple[float, float]:
    """Seconds by the clock, and of the processor."""
    began, cpu = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    subprocess.run([sys.executable, *words], env=environment, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - cpu


# --- in the process ------------------------------------------------------------------------------------


class Watched:
    """A window whose frames are timed.

    gap: the longest between two frames. work: most that one took of the processor. Both in s; on a busy
    machine the first is longer than it need be.
    """

    def __init__(self, model: str) -> None:
        from game.app import App
        from game.documents import models
        from game.preparation import Preparation

        self.app = App(models.load(model), preparation=Preparation())
        self.session = self.app.session
        self.gap = self.work = 0.0

    def frames_until(self, met: Callable[[], bool], longest: float = PATIENCE) -> float:
        """Frames at 60 Hz until something is met, or so many seconds are over; returns how many were."""
        began = before = time.perf_counter()
        while not met() and before - began < longest:
            work = time.thread_time()
            self.app.next_frame()
            now = time.perf_counter()
            self.gap, before = max(self.gap, now - before), now
            self.work = max(self.work, time.thread_time() - work)
        return before - began

    def frames_until_it_runs(self) -> Row:
        """Frames until steps are taken, and some more: how long that took, the longest gap and work of a frame."""
        self.gap = self.work = 0.0
        steps = self.session.model.clock.steps
        seconds = self.frames_until(lambda: bool(self.session.model.clock.steps > steps))
        self.frames_until(lambda: False, SETTLED)
        return {"run_after_s": seconds, "longest_gap_ms": 1e3 * self.gap, "most_work_ms": 1e3 * self.work}


def _main(model: str, edit: str) -> None:
    watched = Watched(model)
    session = watched.session
    if edit == "plasticity":
        session.settings.plasticity = False
    watched.app.frame(0.0)
    after = time.time() - float(os.environ[BEGAN])
    row: Row = {"picture_after_s": after, "picture_cpu_s": time.process_time()}
    session.press("space")
    row |= watched.frames_until_it_runs()
    if edit == "plasticity":
        session.settings.plasticity = True
    elif edit == "rod":
        _add_a_rod(session)
    edited = (
        watched.frames_until_it_runs()
        if edit
        else dict.fromkeys(("run_after_s", "longest_gap_ms", "most_work_ms"), "–")
    )
    row |= {f"edit_{name}": value for name, value in edited.items()}
    watched.app.preparation.close()  # type: ignore[union-attr]
    print(json.dumps(row))


def _add_a_rod(session: Any) -> None:
    """From the apex of the triangle to a particle that is held above it."""
    from components.particle import Particle
    from components.rod import spawn_rods

    with session.model.transaction("rod"):
        session.model.create(Particle, 1, position=[(1.0, 2.0)], fixed=[(True, True)])
        spawn_rods(session.model, [(1, session.particles.count - 1)])


if __name__ == "__main__":
    _main(sys.argv[1], sys.argv[2])
