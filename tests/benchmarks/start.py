"""How long one waits for the program: from its start to a picture, from Space to the first step, for edits, commands.

Each row is a process of its own with folders of its own, first with an empty cache, then with what that left in it. The
window is one of SDL's dummy driver unless the environment names another: SDL_VIDEODRIVER=x11 with a DISPLAY opens real
ones.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.benchmarks.models import CROWDS

Row = dict[str, Any]

PATIENCE = 120.0  # s that anything may take
THINKING = 0.5  # s of frames between the first picture and Space, and between two edits
SETTLED = 1.0  # s for which frames are watched after what was waited for
QUICK = ("isostatic", "ball_on_truss")
EDITS = ("plasticity", "rod", "break", "pull", "statics")  # in mid run; see _Edits
BEGAN = "PINJOINT_BENCH_BEGAN"
# from which the processes import the benchmarks, wherever this one was started
ROOT = Path(__file__).parents[2]
ASSETS = ROOT / "assets"
MODELS, MODS = ASSETS / "models", ASSETS / "mods"
SCRIPT = (
    "from pinjoint import Session; s = Session.open('hyperstatic'); assert s.run(until='rest') == 'at rest'"
)
LAW = (
    "from pinjoint import Session; s = Session.open('isostatic', mods=['{}']);"
    " s.rods['AB'].stiffening_cubic = 9.0; s.run(time=0.01)"
)
COMMANDS = {
    "import pinjoint": ["-c", "import pinjoint"],
    "pinjoint --help": ["-m", "pinjoint", "--help"],
    "pinjoint run isostatic": ["-m", "pinjoint", "run", "isostatic"],
    "pinjoint run isostatic --static": ["-m", "pinjoint", "run", "isostatic", "--static"],
    "pinjoint run collision_iii --at 0.2": ["-m", "pinjoint", "run", "collision_iii", "--at", "0.2"],
    "a script: hyperstatic to rest": ["-c", SCRIPT],
    "a script with a mod's law": ["-c", LAW.format(MODS / "stiffening")],
}


def report(*, quick: bool) -> dict[str, list[Row]]:
    """The tables: first pictures and steps of models and of crowds, edits of a running one, on busy cores, no window."""
    models = QUICK if quick else tuple(sorted(path.stem for path in MODELS.glob("*.json")))
    edits = EDITS[:2] if quick else EDITS
    return {
        "models": [row for name in models for row in _cold_and_warm(name, "")],
        "crowds": [row for name in list(CROWDS)[: 1 if quick else None] for row in _cold_and_warm(name, "")],
        "edits": [row for edit in edits for row in _cold_and_warm("isostatic", edit)],
        "two busy cores": list(_busily(QUICK[:1] if quick else QUICK)),
        "commands": [row for name in list(COMMANDS)[quick * 2 :] for row in _command(name)],
    }


def _busily(models: tuple[str, ...]) -> Iterator[Row]:
    """Windows beside two processes that take all they can get."""
    for name in models:
        with _burning(2):
            yield from _cold_and_warm(name, "rod", again=False)


@contextmanager
def _burning(count: int) -> Iterator[None]:
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()


def _cold_and_warm(model: str, edit: str, *, again: bool = True) -> Iterator[Row]:
    """A window with an empty cache, and one with a full one."""
    with tempfile.TemporaryDirectory() as folder:
        for cache in ("empty", "full") if again else ("empty",):
            words = [sys.executable, "-m", "tests.benchmarks.start", model, edit]
            environment = _environment(Path(folder))
            done = subprocess.run(
                words, env=environment, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True
            )
            yield {"model": model, "edit": edit, "cache": cache, **json.loads(done.stdout.splitlines()[-1])}


def _environment(folder: Path) -> dict[str, str]:
    """That of somebody who never used the program, but for what is in the folder and Python's own compiling."""
    homes = {f"XDG_{what}_HOME": str(folder / what) for what in ("CACHE", "DATA", "CONFIG")}
    usual = {"SDL_VIDEODRIVER": "dummy", **os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    return {**usual, **homes, BEGAN: repr(time.time())}


def _command(name: str) -> Iterator[Row]:
    """Seconds of a fresh process, with an empty cache; then with what some runs left there, the best of three."""
    with tempfile.TemporaryDirectory() as folder:
        costs = [_cost(COMMANDS[name], Path(folder)) for _ in range(4)]
    for cache, (seconds, cpu) in (("empty", costs[0]), ("full", min(costs[1:]))):
        yield {"command": name, "cache": cache, "seconds": seconds, "cpu_s": cpu}


def _cost(words: list[str], folder: Path) -> tuple[float, float]:
    """Seconds by the clock, and of the processor."""
    began, cpu = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(
        [sys.executable, *words], env=_environment(folder), cwd=ROOT, check=True, stdout=subprocess.DEVNULL
    )
    return time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - cpu


# --- in the process ------------------------------------------------------------------------------------


class Watched:
    """A window whose frames are timed while it runs.

    gap: the longest between two frames. work: most that one took of the processor. Both in s; on a busy
    machine the first is longer than it need be.
    """

    def __init__(self, model: str) -> None:
        from pinjoint.app import App
        from pinjoint.documents import models
        from pinjoint.preparation import Preparation

        made = CROWDS[model]() if model in CROWDS else models.load(model)
        self.app = App(made, preparation=Preparation())
        self.session = self.app.session
        self.gap = self.work = 0.0

    def frames_until(self, met: Callable[[], bool], longest: float = PATIENCE) -> float:
        """Frames at 60 Hz until something is met, or so many seconds are over; returns how many were."""
        began = before = time.perf_counter()
        while not met() and before - began < longest:
            work, busy = time.thread_time(), self.session.busy  # a window that waits for a person sleeps
            self.app.next_frame()
            now = time.perf_counter()
            if busy and self.session.busy:
                self.gap, self.work = max(self.gap, now - before), max(self.work, time.thread_time() - work)
            before = now
        return before - began

    def frames_until_it_runs(self, act: Callable[[], object]) -> Row:
        """Do something, then frames until a step of what moves is on the screen, and until all of it is compiled."""
        self.gap = self.work = 0.0
        began = time.perf_counter()
        act()
        before = self._moment
        self.frames_until(lambda: self._moment != before)
        first = time.perf_counter() - began
        self.frames_until(lambda: False, SETTLED)
        asked = self.app.preparation.elsewhere  # type: ignore[union-attr]
        compiled = SETTLED + self.frames_until(
            lambda: all(work.module is None or work.module.is_loaded for work in asked.needed)
        )
        return {
            "first_step_s": first,
            "compiled_s": compiled,
            "longest_gap_ms": 1e3 * self.gap,
            "most_work_ms": 1e3 * self.work,
        }

    @property
    def _moment(self) -> tuple[float, ...]:
        return tuple(model.clock.time for model, _ in self.session.stages if hasattr(model, "clock"))


def _main(model: str, edit: str) -> None:
    watched = Watched(model)
    session = watched.session
    if edit == "plasticity":
        session.settings.plasticity = False
    watched.app.frame(0.0)
    row: Row = {"picture_s": time.time() - float(os.environ[BEGAN])}
    watched.frames_until(lambda: False, THINKING)
    if edit:
        session.press("space")
        watched.frames_until(lambda: False, THINKING)
    row |= watched.frames_until_it_runs(_ACTS[edit](session))
    watched.app.preparation.close()  # type: ignore[union-attr]
    print(json.dumps(row))


def _add_a_rod(session: Any) -> None:
    """From the apex of the triangle to a particle that is held above it."""
    from pinjoint.components.particle import Particle
    from pinjoint.components.rod import Rod

    with session.model.transaction("rod"):
        session.model.create(Particle, 1, position=[(1.0, 2.0)], fixed=[(True, True)])
        session.model.create(Rod, between=[(0, session.particles.count - 1)])


def _pull(session: Any) -> None:
    x, y = session.particles[1].position
    session.press("drag", session.point(x, y))
    session.press("drag to", session.point(x + 0.1, y))


_ACTS: dict[str, Callable[[Any], Callable[[], object]]] = {
    "": lambda session: lambda: session.press("space"),
    "plasticity": lambda session: lambda: setattr(session.settings, "plasticity", True),
    "rod": lambda session: lambda: _add_a_rod(session),
    "break": lambda session: lambda: session.model.delete([session.rods[0]]),
    "pull": lambda session: lambda: _pull(session),
    "statics": lambda session: lambda: session.press("k"),
}


if __name__ == "__main__":
    _main(sys.argv[1], sys.argv[2])
