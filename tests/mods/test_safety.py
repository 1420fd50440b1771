"""After a crash with mods, the next window opens without them, once."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pinjoint import Session, mods
from pinjoint.commands.with_mods import LEFT_OUT, crashed, in_use, load_as_asked
from tests.mods.conftest import Write

HOLD = """
from pinjoint.mods import load
from pinjoint.commands.with_mods import in_use
load(installed=True)
with in_use():
    print("ready", flush=True)
    input()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="kill -9")
def test_a_crash_leaves_the_mods_out_once(tmp_path: Path, write_mod: Write) -> None:
    write_mod("pear")
    (tmp_path / "data").mkdir()
    (tmp_path / "mods").rename(tmp_path / "data" / "mods")
    window = subprocess.Popen([sys.executable, "-c", HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert window.stdout is not None
    assert window.stdout.readline() == b"ready\n"
    assert not crashed()
    os.kill(window.pid, signal.SIGKILL)
    window.communicate()
    assert load_as_asked(["run", "isostatic", "--no-mods"]) == ["run", "isostatic"]
    assert load_as_asked(["isostatic"]) == ["isostatic"]
    assert mods.FAULTS == [LEFT_OUT]
    assert [mod.name for mod in mods.MODS if mod.name == "pear"] == []
    assert load_as_asked(["isostatic"]) == ["isostatic"]
    assert [mod.name for mod in mods.MODS if mod.name == "pear"] == ["pear"]


def test_a_clean_end_leaves_nothing_behind(tmp_path: Path, write_mod: Write) -> None:
    mods.load([write_mod("pear")])
    with in_use():
        assert len(list((tmp_path / "data" / "running").iterdir())) == 1
    assert not crashed()


def test_settling_says_which_laws_it_does_not_know(unloaded: None) -> None:
    folder = Path(__file__).parents[2] / "assets" / "mods" / "stiffening"
    session = Session.open("isostatic", mods=[folder])
    assert session.settle() == "equilibrium"
    assert "leaves out" not in session.notice
    session.rods[0].stiffening_cubic = 1.0  # type: ignore[attr-defined]
    assert session.settle() == "equilibrium without mods"
    assert session.notice.endswith("The equilibrium leaves out the laws of mods: stiffening.cubic.")
