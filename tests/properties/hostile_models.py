"""Models that somebody could write, of numbers from 5e-324 to 1e30 and of every structure, through every command.

Whatever a model holds, a command ends with an exit status of the program and sentences: no traceback, no warning, no
number in its answer that is not finite, and the file as it was. What takes longer than PATIENCE is interrupted as by
Ctrl+C, and ends then. `python -m tests.properties.fuzz models` tries as many as one likes, in another process, which
is ended where it does not end itself.
"""

import io
import json
import math
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from pinjoint import Session
from pinjoint.commands import command_line
from pinjoint.documents import models
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.properties.limits import interrupted_after

PATIENCE = 10.0  # s of processor time, then Ctrl+C
GRACE = 50.0  # s in which what is interrupted ends
# Nothing raised while an object ends goes on; the program itself ends all the same then.
_SWALLOWED = re.compile(r"Exception ignored .*\bInterrupt\b", re.DOTALL)
MOST_MEMORY = 6 << 30  # bytes of address space
EXTREMES = (0.0, 5e-324, 1e-300, 1e-30, 1e-19, 1e-9, 1e-3, 1.0, 3.0, 1e3, 1e9, 1e16, 1e30)
VALUES: tuple[Any, ...] = (None, True, -1, 10**30, 1e300, "", "A", "\x1b[31m")
JUNK: tuple[Any, ...] = (*VALUES, [], [1], [0, 0], {}, {"kind": 1}, [[[]]])
INTEGRATORS = ("automatic", "velocity_verlet", "rk4", "dop853", "esdirk4", "semi_implicit_euler", "taylor2")
HISTORIES: tuple[dict[str, Any], ...] = (
    {"kind": "constant"},
    {"kind": "ramp", "start": 0.0, "duration": 0.1},
    {"kind": "sine", "frequency": 2.0, "phase": 0.0},
    {"kind": "pulse", "start": 0.0, "duration": 0.01},
    {"kind": "table", "times": [0.0, 0.1], "factors": [0.0, 1.0]},
)
KEYS = ("space", *"kkimjebo", "escape", "home", "return", "+", "t", "ctrl+a", "n", ".", "delete", "ctrl+z")


class Hostile:
    """Documents and commands from a seed, the same ones every time."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.wild = self.random.choice((0.0, 0.03, 0.15, 0.5))  # share of the numbers that are extreme
        self.bends = self.random.random() < 0.4

    def number(self, usual: float, *, above: bool = False) -> float:
        """A number near a usual one, or an extreme one."""
        if self.random.random() < self.wild:
            found = self.random.choice(EXTREMES)
            return max(found, 1e-30) if above else found * self.random.choice((1.0, 1.0, -1.0))
        return usual

    def pair(self, x: float, y: float) -> list[float]:
        """A vector."""
        return [self.number(x), self.number(y)]

    def some(self, **entries: Any) -> dict[str, Any]:
        """Some of these entries of an element."""
        return {key: value for key, value in entries.items() if self.random.random() < 0.3}

    def document(self) -> dict[str, Any]:
        """A model; one in six with a part that is no such thing."""
        count, draw = self.random.choice((0, 1, 1, 2, 2, 3, 4, 5, 8)), self.random.random
        places = [(float(n % 3), float(n // 3) + 0.3 * (n % 2)) for n in range(count)]
        pairs = [(i, j) for i in range(count) for j in range(i)]
        chosen = [pair for pair in pairs if draw() < self.random.choice((0.0, 0.4, 0.9))]
        made: dict[str, Any] = {"format": "pinjoint model", "version": 1}
        made["particles"] = [self._particle(f"P{n}", *place) for n, place in enumerate(places)]
        made["rods"] = [self._rod(f"P{i}", f"P{j}") for i, j in chosen]
        if count and draw() < 0.5:
            made["loads"] = [self._load(f"P{n}") for n in range(count) if draw() < 0.5]
        if draw() < 0.3:
            walls = [{"start": self.pair(-1.0, -0.2 - n), "end": self.pair(3.0, -0.2 - n)} for n in range(2)]
            made["components"] = {"walls.Wall": walls}
        made["environment"] = self.some(
            force=self.pair(0.0, -1.0), acceleration=self.pair(0.0, -9.81), drag=abs(self.number(0.1))
        )
        made["settings"] = self._settings()
        if draw() < 0.3:
            made["span_loads"] = [self._span_load(f"P{i}P{j}") for i, j in chosen if draw() < 0.5]
        if draw() < 0.17:
            self._damage(made)
        return made

    def _particle(self, name: str, x: float, y: float) -> dict[str, Any]:
        fixed = self.random.choice(([True, True], [False, True], [False, False], [False, False]))
        speed = self.pair(self.random.gauss(0, 1), self.random.gauss(0, 1))
        return {"name": name, "position": self.pair(x, y), "fixed": fixed} | self.some(
            displacement=self.pair(0.016, -0.01),
            velocity=[0.0 if held else v for held, v in zip(fixed, speed, strict=True)],
            force=self.pair(10.0, -100.0),
            acceleration=self.pair(1.0, -9.81),
            mass=self.number(2.0, above=True),
            radius=self.number(0.2, above=True),
            **(self._turning() if self.bends else {}),
        )

    def _turning(self) -> dict[str, Any]:
        """What particles have where rods bend."""
        held = self.random.random() < 0.3
        return {
            "fixed_rotation": held,
            "rotation": self.number(0.01),
            "angular_velocity": 0.0 if held else self.number(1.0),
            "moment": self.number(2.0),
            "inertia": self.number(0.1, above=True),
        }

    def _bending(self) -> dict[str, Any]:
        """What rods have that bend."""
        return {
            "bending_stiffness": abs(self.number(1e3)),
            "second_moment": self.number(1e-5, above=True),
            "youngs_modulus": self.number(2e8, above=True),
            "hinged": [self.random.random() < 0.3, self.random.random() < 0.3],
            "end_springs": [self.random.choice([0.0, 0.0, 500.0]), self.random.choice([0.0, 0.0, 0.0, 1e6])],
            "distributed_force": self.pair(1.0, -5.0),
            "temperature_gradient": self.number(20.0),
            "bending_damping": abs(self.number(0.1)),
            "section": self.random.choice(4 * ("IPE 200", "shs 100x5", "rectangle 30×50") + ("HEX 1",)),
            "material": self.random.choice(6 * ("S235", "timber C24") + ("cheese",)),
        }

    def _span_load(self, rod: str) -> dict[str, Any]:
        return {"rod": rod} | self.some(
            start=abs(self.number(0.3)),
            end=abs(self.number(0.6)),
            force=self.pair(1.0, -5.0),
            moment=self.number(2.0),
            start_intensity=self.pair(1.0, -5.0),
            end_intensity=self.pair(-1.0, 3.0),
            direction=self.random.choice(("global", "local")),
        )

    def _rod(self, first: str, second: str) -> dict[str, Any]:
        return {"name": f"{first}{second}", "between": [first, second]} | self.some(
            stiffness=self.number(1e5, above=True),
            rest_length=self.number(1.0, above=True),
            tensile_strength=abs(self.number(100.0)),
            compressive_strength=abs(self.number(100.0)),
            damping=abs(self.number(10.0)),
            density=abs(self.number(1.0)),
            temperature_change=self.number(30.0),
            thermal_expansion=abs(self.number(1e-5)),
            tension_only=True,
            plastic_strain=self.number(1e-3),
            **(self._bending() if self.bends else {}),
        )

    def _load(self, on: str) -> dict[str, Any]:
        history = dict(self.random.choice(HISTORIES))
        for key, value in history.items():
            if isinstance(value, float):
                history[key] = self.number(value)
        moment = {"moment": self.number(1.0)} if self.bends else {}
        return {"on": on, "force": self.pair(5.0, 5.0), "history": history} | moment

    def _settings(self) -> dict[str, Any]:
        return self.some(
            restitution=self.random.choice((0.0, 0.5, 1.0)),
            time_step=self.number(1e-4, above=True),
            integrator=self.random.choice(INTEGRATORS),
            collisions=self.random.random() < 0.5,
            plasticity=self.random.random() < 0.5,
            displacement_scale=abs(self.number(10.0)),
            diagram_scale=abs(self.number(1.0)),
        )

    def _damage(self, value: Any) -> None:
        """Put something else in the place of a part."""
        while isinstance(value, dict | list) and value:
            keys = list(value) if isinstance(value, dict) else range(len(value))
            key = self.random.choice(keys)
            if not isinstance(value[key], dict | list) or not value[key] or self.random.random() < 0.3:
                value[key] = self.random.choice(JUNK)
                return
            value = value[key]

    def words(self, folder: Path, model: str) -> list[str]:
        """A command with this model."""
        draw, out = self.random.choice, folder / "out"
        until = f"{abs(self.number(draw((1e-4, 0.01, 1.0)))):g}"
        limit = ["--limit", f"{self.number(draw((0.01, 1.0, 60.0)), above=True):g}"]
        factors = draw(([], ["--load-factors", f"{self.number(1.0):g},{self.number(0.0):g}"]))
        draw_to = ["--size", draw(("64x48", "300x200")), "--output"]
        (folder / "record.csv").write_text(f"0,0\n{until}1,{self.number(1.0)}\n1e30,0\n", encoding="utf-8")
        measured = ["--measure", "energy.kinetic", "--output", f"{out}.csv", "--workers", "1"]
        return draw(
            (
                ["run", model, "--at", until, "--format", "json"],
                ["run", model, *limit, "--format", draw(("json", "table", "csv"))],
                ["run", model, "--static", *factors, "--format", "json"],
                ["curve", model, "--points", "20", "--format", "json", "--factor", f"{self.number(1.0):g}"],
                ["verify", model, "--format", "json"],
                ["force-method", model, "--all"],
                ["sweep", model, "--static", "--vary", "environment.drag=0,1", *measured],
                ["sweep", model, "--at", until, "--vary", "settings.restitution=0,1", *measured],
                ["render", model, *draw_to, f"{out}.png", *draw(([], ["--diagrams"], ["--at", f"{until}1"]))],
                ["render", model, *draw_to, f"{out}.png", draw(("--mode", "--mechanism")), "1"],
                ["render", model, *draw_to, f"{out}.gif", "--at", "0.01"],
                ["plot", model, "--of", "energy.kinetic", "--until", f"{until}1", "--output", f"{out}.png"],
                ["shake", model, str(folder / "record.csv"), "--output", f"{out}.json"],
                ["plan", model, "--scene", draw(("pause", "simulation", "force method"))],
                ["window", model],
                ["window", model],
                ["play", self._script(folder, model)],
            )
        )

    def _script(self, folder: Path, model: str) -> str:
        lines: list[dict[str, Any]] = [{"format": "pinjoint session", "version": 1, "model": model}]
        for _ in range(6):
            lines.append(
                self.random.choice(
                    (
                        {"press": self.random.choice(KEYS)},
                        {"click": self.pair(1.0, 0.3)},
                        {"drag": [self.pair(0.0, 0.0), self.pair(1.0, 1.0)]},
                        {"run": abs(self.number(0.01))},
                        {"steps": 20},
                        {"set": f"particles.P1.radius={self.number(0.1)}"},
                        {"action": "undo"},
                        {"expect": "energy.kinetic < 1e300"},
                        {"resize": [self.random.choice((1, 200)), self.random.choice((1, 3000)), 1]},
                    )
                )
            )
        path = folder / "script.jsonl"
        path.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
        return str(path)


def window(model: str, seed: int) -> int:
    """Keys, frames and pictures as in a window; returns an exit status."""
    drawn = random.Random(seed)
    session = Session.open(model)
    for _ in range(8):
        session.press(drawn.choice(KEYS))
        session.frame(drawn.choice((0.0, 1 / 60, 0.1)))
        if session.scene == "pause" and drawn.random() < 0.3:
            session.view.fit(session.model)
        session.update_view()
        for shown, view in session.stages:
            compose(shown, view, load_theme("light"))
    return 0


def attempt(seed: int, folder: Path, patience: float = PATIENCE) -> str:
    """What is wrong with the answer to a model and a command; "" if nothing is."""
    hostile, path = Hostile(seed), folder / "model.json"
    written = json.dumps(hostile.document())
    path.write_text(written, encoding="utf-8")
    words = hostile.words(folder, str(path))
    out, err = io.StringIO(), io.StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(err), interrupted_after(patience):
            status = window(str(path), seed) if words[0] == "window" else command_line.main(words)
    except KeyboardInterrupt:
        status = 130
    except models.ModelError:
        status = 2
    except BaseException:
        return f"{' '.join(words)}\n{traceback.format_exc()}"
    told = err.getvalue()
    problems = [
        *(["a status that is none"] if status not in (0, 1, 2, 130) else []),
        *(
            ["a traceback or a warning"]
            if ("Traceback" in told or "Warning:" in told) and not _SWALLOWED.search(told)
            else []
        ),
        *(["nothing said"] if status == 2 and words[0] != "window" and not told else []),
        *(["the file changed"] if path.read_text(encoding="utf-8") != written else []),
        *(_not_finite(out.getvalue()) if "json" in words and status in (0, 1) else []),
    ]
    return "".join(f"{' '.join(words)}\n{problem}\n{told[-2000:]}" for problem in problems[:1])


def _not_finite(text: str) -> list[str]:
    try:
        json.loads(text, parse_constant=lambda name: math.nan / 0)
    except (ValueError, ZeroDivisionError):
        return ["JSON that is none"]
    return []


def explore(first: int, count: int) -> int:
    """Try seeds in another process, which is ended where it hangs; returns how many went wrong."""
    wrong, seed, last = 0, first, first + count
    while seed < last:
        with _worker(seed, last) as process:
            assert process.stdout is not None
            for line in process.stdout:
                answer = json.loads(line)
                seed = answer["seed"] + 1
                if answer["problem"]:
                    wrong += 1
                    print(f"seed {answer['seed']}: {answer['problem']}", flush=True)
                elif answer["seconds"] > 2.0 * PATIENCE:
                    print(f"seed {answer['seed']} took {answer['seconds']:.0f} s of processor time", flush=True)
            ended = process.wait()
        if ended:  # it was ended, or it died
            wrong += 1
            print(f"seed {seed}: its process ended with {ended} (−24: it hung)", flush=True)
            seed += 1
    print(f"{count} models and commands from seed {first}, {wrong} went wrong", flush=True)
    return wrong


@contextmanager
def _worker(first: int, last: int) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "tests.properties.hostile_models", str(first), str(last)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def work(first: int, last: int) -> None:
    """Try seeds, a line of JSON for each; ends at the first that hangs, and after one that was interrupted.

    An interrupt in a compiler may leave it unfit to compile anything else.
    """
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    with tempfile.TemporaryDirectory() as folder:
        os.environ["PINJOINT_DATA"] = folder
        for seed in range(first, last):
            signal.alarm(0)
            resource.setrlimit(resource.RLIMIT_CPU, (_spent() + int(PATIENCE + GRACE), resource.RLIM_INFINITY))
            began = time.process_time()
            problem = attempt(seed, Path(folder))
            seconds = time.process_time() - began
            print(json.dumps({"seed": seed, "problem": problem, "seconds": seconds}), flush=True)
            if seconds > PATIENCE:
                return


def _spent() -> int:
    import resource

    used = resource.getrusage(resource.RUSAGE_SELF)
    return math.ceil(used.ru_utime + used.ru_stime)


if __name__ == "__main__":
    work(int(sys.argv[1]), int(sys.argv[2]))
