"""PINJOINT_COMPILE=never: no compiler is needed, not even importable; and what is said of other values."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WITHOUT = """
import sys


class Nowhere:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("numba", "llvmlite"):
            raise ModuleNotFoundError(f"No module named '{name}'", name=name)


sys.meta_path.insert(0, Nowhere())
"""
MAIN = f"{WITHOUT}\nfrom pinjoint.__main__ import main\nsys.exit(main())"
MOD = """
from pinjoint.api import Law
from numba import njit


@njit
def pull(particles_mass):
    return 0.001 * particles_mass, 0.0


class Pull(Law):
    name = "old.pull"
    each = "particles"
    kernel = pull
    reads = ("particles.mass",)


def plugin(app):
    app.system(Pull)
"""


def run(tmp_path: Path, *words: str, compile: str = "never") -> subprocess.CompletedProcess[str]:
    own = {f"PINJOINT_{name}": str(tmp_path / name) for name in ("DATA", "CONFIG")}
    variables = {**os.environ, **own, "PINJOINT_COMPILE": compile}
    command = [sys.executable, *words]
    return subprocess.run(command, cwd=ROOT, env=variables, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "words",
    [
        "run isostatic --integrator automatic",
        "run hyperstatic --static",
        "run collision_iii --at 0.05",
        "curve von_mises --until B.y=-0.5",
        "force-method hyperstatic --release AC",
        "sweep hyperstatic --vary rods.CD.stiffness=1e5:3e5:3 --measure rods.CD.strain --output {}/r.csv",
        "render hyperstatic_yield --at 0.001 --diagrams --output {}/p.png",
        "mods check assets/mods/magnets",
        "play 1_draw_a_truss",
    ],
)
def test_commands_need_no_compiler(words: str, tmp_path: Path) -> None:
    done = run(tmp_path, "-c", MAIN, *words.format(tmp_path).split())
    assert done.returncode == 0, done.stderr


WINDOW = f"""{WITHOUT}
from pinjoint.app import App
from pinjoint.documents import models

for name in ("hyperstatic_yield", "pile"):
    app = App(models.load(name))
    app.session.press("i")
    app.session.press("space")
    while not app.session.model.clock.steps:
        app.frame(1 / 60)
    app.session.press("space")
    app.session.press("e")
    app.frame(1 / 60)
    assert "switched off" not in app.session.message
    app.close()
"""


def test_the_window_needs_no_compiler(tmp_path: Path) -> None:
    done = run(tmp_path, "-c", WINDOW)
    assert done.returncode == 0, done.stderr


def test_a_mod_that_imports_it_is_named(tmp_path: Path) -> None:
    folder = tmp_path / "old"
    folder.mkdir()
    (folder / "mod.toml").write_text('name = "old"\nversion = "1.0"\n')
    (folder / "__init__.py").write_text(MOD)
    done = run(tmp_path, "-c", MAIN, "run", "isostatic", "--mods", str(folder))
    assert done.returncode == 2
    assert (
        "The mod 'old' cannot be used: It imports numba, which is not installed (old/__init__.py, line 3)"
        in done.stderr
    )
    assert "@compiled from pinjoint.api" in done.stderr


@pytest.mark.parametrize("words", ["run isostatic", "mods list"])
def test_other_values_are_refused(words: str, tmp_path: Path) -> None:
    done = run(tmp_path, "-m", "pinjoint", *words.split(), compile="sometimes")
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "pinjoint: PINJOINT_COMPILE is 'sometimes'; set it to never or always, or leave it out."
    ]
