"""A loop in a kernel of a mod that does not end: the mod is named, and Ctrl+C heard, in machine code, too."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from pinjoint import Session, mods
from pinjoint.interrupts import PATIENCE
from pinjoint.systems.run.recovery import Recovery
from tests.mods.conftest import Write
from tests.mods.test_isolation import LAW, TRUSS

ENDLESS = """
@compiled
def bad(particles_position):
    x = 1.0
    while x > 0.0:
        x = x * 1.0
    return x, 0.0
"""

RUN = """
import json, sys
from pinjoint import Session
from pinjoint.systems.program.compiler import Choice
Choice.patience = 1.0
print("runs", flush=True)
Session.open(json.loads(sys.argv[1]), mods=[sys.argv[2]]).run(time=0.1)
"""


def endless(write_mod: Write) -> Path:
    law = LAW.format(kernel=ENDLESS, more="").replace(
        "from numba import njit", "from pinjoint.api import compiled"
    )
    return write_mod("apple", law)


def process(form: str, *words: str) -> subprocess.Popen[str]:
    words, environment = (sys.executable, *words), os.environ | {"PINJOINT_COMPILE": form}
    return subprocess.Popen(words, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


@pytest.mark.parametrize("form", ["never", "always"])
def test_a_kernel_that_does_not_end_is_named(write_mod: Write, form: str) -> None:
    with process(form, "-c", RUN, json.dumps(TRUSS), str(endless(write_mod))) as run:
        _, said = run.communicate(timeout=120)
    assert run.returncode == 1
    assert "A step has not ended for 1 s. It calls kernels of mods: bad (" in said
    assert os.path.join("apple", "__init__.py") in said


COMPILES = """
import numpy
from numba import njit
from pinjoint.systems.program.compiler import Choice, ending
Choice.patience = 0.3
sorts = njit(lambda numbers: numpy.sort(numbers).sum() + numpy.unique(numbers).sum())
print(ending(sorts, [sorts.py_func])(numpy.ones(3)))
"""


def test_a_compiler_that_takes_long_is_no_kernel_that_does_not_end(fresh_process: Callable[..., str]) -> None:
    assert fresh_process(COMPILES) == "4.0\n"


def test_ctrl_c_is_heard_while_machine_code_does_not_end(write_mod: Write) -> None:
    folder = endless(write_mod)
    words = "-m", "pinjoint", "run", "isostatic", "--at", "1", "--mods", str(folder)
    with process("always", *words) as run:
        assert run.stderr is not None
        assert "no step in time was made yet" in run.stderr.readline()  # after 5 s
        began = time.monotonic()
        run.send_signal(signal.SIGINT)
        run.wait(timeout=60)
        assert run.returncode == 128 + signal.SIGINT
        assert time.monotonic() - began < PATIENCE + 5.0


def test_a_search_for_a_mod_to_blame_that_is_interrupted_leaves_the_good_state(
    write_mod: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    kernel = "@njit\ndef bad(particles_position):\n    return (particles_position[0] - 1.0) ** 0.5, 0.0"
    mods.load_all([write_mod("apple", LAW.format(kernel=kernel, more=""))])
    session = Session.open(TRUSS)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Recovery, "_lead_on", interrupted)
    with pytest.raises(KeyboardInterrupt):
        session.run(time=0.1)
    assert (session.particles.displacement == 0.0).all()
