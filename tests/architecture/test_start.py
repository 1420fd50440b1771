"""What short commands and scripts import: half of their time, so that nothing is loaded that they do not need."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
REST_OF_SCIPY = ("scipy.linalg.blas", "scipy.sparse", "scipy.spatial")  # that takes 0.15 s
SCENES = ("pinjoint.session", "pinjoint.editor.scenes", "pinjoint.lessons.course")
SESSION = ("pinjoint.session", "pinjoint.editor.context", "pinjoint.systems.run.simulation")
WINDOW = ("pygame", "pinjoint.app", "pinjoint.preparation")
OTHER_COMMANDS = (
    "pinjoint.sweeps",
    "pinjoint.scripts.playing",
    "pinjoint.commands.play",
    "pinjoint.commands.mods",
    "pinjoint.checks",
)


def loaded_by(code: str) -> set[str]:
    """The modules that are there after a script, packages included."""
    done = subprocess.run(
        [sys.executable, "-c", f"import sys\n{code}\nprint(*sys.modules, file=sys.stderr)"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return set(done.stderr.splitlines()[-1].split())


def loaded_by_command(words: str) -> set[str]:
    """The modules that are there after a command."""
    code = (
        f"sys.argv = ['pinjoint', *'{words}'.split()]\nfrom pinjoint.__main__ import main\nassert main() == 0"
    )
    return loaded_by(code)


def test_the_version_is_told_before_anything_is_loaded() -> None:
    loaded = loaded_by_command("--version")
    assert not {name for name in loaded if name.split(".")[0] in ("components", "systems", "numpy", "argparse")}


@pytest.mark.parametrize("model", ["isostatic", "hyperstatic_yield"])
def test_small_structures_settle_without_the_rest_of_scipy(model: str) -> None:
    loaded = loaded_by_command(f"run {model} --static --format json")
    unwanted = {*WINDOW, *OTHER_COMMANDS, *REST_OF_SCIPY, *SESSION, "numba", "numpy.random", "numpy.ma"}
    assert not loaded & unwanted


def test_collisions_are_computed_without_statics() -> None:
    loaded = loaded_by_command("run collision_iii --at 0.2 --format json")
    assert not loaded & {
        *WINDOW,
        *OTHER_COMMANDS,
        *SCENES,
        "scipy.sparse",
        "pinjoint.systems.statics.equations",
    }


def test_a_command_loads_no_other() -> None:
    loaded = loaded_by_command("mods list")
    assert "pinjoint.commands.mods" in loaded
    assert not loaded & {*WINDOW, "pinjoint.sweeps", "pinjoint.commands.run", "pinjoint.commands.play", "scipy"}


def test_a_session_is_open_without_a_window_a_compiler_or_scipy() -> None:
    loaded = loaded_by("from pinjoint import Session\nSession.open('hyperstatic')")
    assert not loaded & {*WINDOW, *OTHER_COMMANDS, "numba", "scipy", "numpy.random"}


@pytest.mark.parametrize(
    "start",
    [
        "from pinjoint import Context; model = Model()",
        "from pinjoint.api import Model; model = Model()",
        "from pinjoint.documents import models; model = models.load('isostatic')",
        "from pinjoint.session import Session; model = Session.open('isostatic').model",
    ],
)
def test_models_can_hold_all_whatever_a_script_begins_with(start: str) -> None:
    loaded_by(
        f"from pinjoint.components import Model\n{start}\n"
        "from pinjoint.components.load import HISTORIES\n"
        "assert 'sine' in HISTORIES and 'walls' in model.tables"
    )


def test_the_package_imports_nothing_until_asked() -> None:
    assert {name for name in loaded_by("import pinjoint") if name.startswith("pinjoint")} == {"pinjoint"}


def test_the_command_line_keeps_to_one_thread_of_linear_algebra_unless_a_person_chose() -> None:
    """Idle threads of OpenBLAS take 0.1 s of a command to start and to end."""
    told = "import os, pinjoint.__main__\nsys.argv = ['pinjoint', 'mods', 'list']\npinjoint.__main__.main()\n"
    loaded_by(told + "assert os.environ['OPENBLAS_NUM_THREADS'] == '1'")
    loaded_by(
        "import os\nos.environ['OPENBLAS_NUM_THREADS'] = '2'\n"
        + told
        + "assert os.environ['OPENBLAS_NUM_THREADS'] == '2'"
    )


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted there")
def test_statics_of_scripts_keep_to_one_thread_of_linear_algebra() -> None:
    """Threads that wait for one another take a thousand times as long while other programs take the cores."""
    loaded_by(
        "import os\nos.environ.pop('OPENBLAS_NUM_THREADS', None)\nimport numpy\n"
        "threads = os.listdir('/proc/self/task')\n"
        "from pinjoint.systems.statics.factor import lapack\nlapack()\n"
        "assert 'OPENBLAS_NUM_THREADS' not in os.environ, 'for what else is loaded'\n"
        "assert os.listdir('/proc/self/task') == threads"
    )
