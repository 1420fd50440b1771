"""Recordings name the mods that they were made with, and are not played as if without them."""

import io
import json
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.commands.command_line import main
from pinjoint.scripts.playing import Recorder, play, session_of
from pinjoint.scripts.script import Script, ScriptError
from tests.mods.conftest import Write
from tests.reference.models import model, particle

BALL: dict[str, Any] = model([particle("A", 0, 0)], [], settings={"integrator": "velocity_verlet"})
BREEZE = """
from numba import njit
from pinjoint.systems.base import Law

class Push(Law):
    name = "breeze.push"
    each = "particles"
    kernel = njit(lambda particles_mass: (0.001 * particles_mass, 0.0))
    reads = ("particles.mass",)

def plugin(app):
    app.system(Push)
"""


def recorded(path: Path) -> Path:
    session, file = Session.open(BALL), io.StringIO()
    Recorder(session, file, BALL)
    session.press("space")
    session.frame(0.1)
    session.press("space")
    path.write_text(file.getvalue(), encoding="utf-8")
    return path


def test_a_recording_with_a_mod_is_not_played_without_it(
    write_mod: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_mod("breeze", BREEZE)
    mods.load([folder])
    file = recorded(tmp_path / "recorded.jsonl")
    assert json.loads(file.read_text(encoding="utf-8").splitlines()[0])["mods"] == {"breeze": "1.0"}
    assert main(["play", str(file)]) == 0
    assert capsys.readouterr().err == ""
    mods.unload(mods.MODS[-1:])
    assert main(["play", str(file)]) == 2
    output = capsys.readouterr()
    assert "was recorded with mods that are not loaded: breeze 1.0. Name their folder: --mods" in output.err
    assert output.out == ""
    assert main(["play", str(file), "--mods", str(folder)]) == 0


def test_other_mods_than_recorded_are_told(
    write_mod: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    without = recorded(tmp_path / "without.jsonl")
    mods.load([write_mod("breeze", BREEZE)])
    file = recorded(tmp_path / "recorded.jsonl")
    mods.MODS[-1].version = "1.1"
    assert main(["play", str(file)]) == 0
    assert (
        "was recorded without the mods breeze 1.1 that are loaded now, so it may run differently."
        in capsys.readouterr().err
    )
    assert session_of(Script(without)).notice.endswith(
        "was recorded without the mods breeze 1.1 that are loaded now, so it may run differently."
    )


def test_scripts_that_say_nothing_of_mods_are_played_with_any(write_mod: Write, tmp_path: Path) -> None:
    mods.load([write_mod("breeze", BREEZE)])
    file = tmp_path / "old.jsonl"
    header = {"format": "pinjoint session", "version": 1, "model": "isostatic"}
    file.write_text(json.dumps(header) + '\n{"press": "i"}\n', encoding="utf-8")
    script = Script(file)
    session = session_of(script)
    assert play(script, session) == []
    assert session.notice == ""


def test_what_a_header_says_of_mods_is_checked(tmp_path: Path) -> None:
    file = tmp_path / "wrong.jsonl"
    file.write_text('{"format": "pinjoint session", "version": 1, "mods": ["breeze"]}\n', encoding="utf-8")
    with pytest.raises(ScriptError, match=r"mods is .*; write names and versions"):
        Script(file)
