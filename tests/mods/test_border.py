"""What follows where a mod fails: exit statuses, what is said and what is not, threads, Ctrl+C, and the names of modules."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.commands.command_line import main
from pinjoint.components.field import FieldError
from pinjoint.interrupts import Interrupt, interrupt, is_persons, mark_interrupts
from pinjoint.scripts.playing import play
from pinjoint.scripts.script import Script
from tests.conftest import ROOT
from tests.mods.conftest import Write
from tests.mods.test_isolation import SYSTEM, TRUSS

EXAMPLES = ROOT / "assets" / "mods"
FAILS = SYSTEM.format(phase="EVENTS", body="model.clock.steps < 32 or 1 / 0")
Pinjoint = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def truss(tmp_path: Path) -> str:
    (tmp_path / "truss.json").write_text(json.dumps(TRUSS), encoding="utf-8")
    return str(tmp_path / "truss.json")


@pytest.fixture
def pinjoint(tmp_path: Path) -> Pinjoint:
    """Run the program in a process of its own."""

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        folders = {"PINJOINT_DATA": str(tmp_path / "data"), "PINJOINT_CONFIG": str(tmp_path / "config")}
        return subprocess.run(
            [sys.executable, "-m", "pinjoint", *words],
            env={**os.environ, **folders, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    return run


# --- what comes out ------------------------------------------------------------------------------------------


def test_a_mod_that_fails_in_a_run_is_told_in_one_sentence_and_by_the_exit_status(
    write_mod: Write, truss: str, pinjoint: Pinjoint
) -> None:
    done = pinjoint("run", truss, "--at", "0.05", "--format", "json", "--mods", str(write_mod("apple", FAILS)))
    assert done.returncode == 1
    assert "The mod 'apple' was switched off: the system 'apple.bad' failed: ZeroDivisionError" in done.stderr
    assert "Traceback" not in done.stderr
    found = json.loads(done.stdout)
    assert found["status"] == "mod failed"
    assert "The run stopped at t = " in found["message"]
    assert found["steps"] == 32
    assert found["states"][-1]["particles"]["C"]["displacement"][1] < 0.0


def test_a_script_does_not_pass_where_a_mod_failed(
    write_mod: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mods.load([write_mod("apple", FAILS)])
    lines = [
        {"format": "pinjoint session", "version": 1, "model": TRUSS},
        {"steps": 64},
        {"expect": "scene = pause"},
    ]
    path = tmp_path / "script.jsonl"
    path.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    (failure,) = play(Script(path))
    assert (failure.line, failure.expected) == (2, "mods that work")
    assert "ZeroDivisionError" in failure.got
    assert main(["play", str(path)]) == 1
    capsys.readouterr()


def test_an_equilibrium_without_the_laws_of_mods_is_not_called_one(
    tmp_path: Path, unloaded: None, capsys: pytest.CaptureFixture[str]
) -> None:
    rod = {"name": "AC", "between": ["A", "C"], "components": {"stiffening.Material": {"cubic": 1.0}}}
    (tmp_path / "stiff.json").write_text(
        json.dumps({**TRUSS, "rods": [rod, TRUSS["rods"][1]]}), encoding="utf-8"
    )
    words = ["run", str(tmp_path / "stiff.json"), "--static", "--format", "json"]
    assert main([*words, "--mods", str(EXAMPLES / "stiffening")]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "equilibrium without mods"
    assert found["left_out"] == ["stiffening.cubic"]
    assert found["message"].endswith("The equilibrium leaves out the laws of mods: stiffening.cubic.")
    assert main([*words, "--set", "rods.*.stiffening_cubic=0"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["status"], found["left_out"]) == ("equilibrium", [])
    assert main(["verify", words[1], "--theory-only"]) == 0
    assert "Theory leaves out the laws of mods: stiffening.cubic." in capsys.readouterr().out
    assert main(["curve", words[1]]) == 1  # C can move
    assert "The curve leaves out the laws of mods: stiffening.cubic." in capsys.readouterr().err


def test_answers_of_the_force_method_and_of_curves_name_the_laws_that_they_leave_out(
    unloaded: None, capsys: pytest.CaptureFixture[str], answer: Any
) -> None:
    stiff = ["--set", "rods.*.stiffening_cubic=1", "--format", "json", "--mods", str(EXAMPLES / "stiffening")]
    for words, title in (
        (["force-method", "hyperstatic", "--all"], "force method"),
        (["curve", "isostatic"], "curve"),
    ):
        assert main([*words, *stiff]) == 1
        said = capsys.readouterr()
        assert json.loads(said.out)["left_out"] == ["stiffening.cubic"]
        assert f"The {title} leaves out the laws of mods: stiffening.cubic." in said.err
        assert answer(*words)["left_out"] == []


def test_a_mod_that_was_asked_for_is_not_left_out_of_what_is_computed(
    write_mod: Write, truss: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(write_mod("apple", "raise SystemExit(7)"))
    assert main(["run", truss, "--at", "0.01", "--mods", folder]) == 2
    assert (
        "The mod 'apple' cannot be used: SystemExit: 7 (apple/__init__.py, line 1)." in capsys.readouterr().err
    )
    assert main(["mods", "list", "--mods", folder]) == 1
    assert main(["mods", "check", folder]) == 1


def test_mods_of_a_person_that_end_the_program_do_not_end_it(
    write_mod: Write, tmp_path: Path, truss: str, pinjoint: Pinjoint
) -> None:
    write_mod("apple", "raise KeyboardInterrupt")
    write_mod("pear", "import sys\nsys.exit()")
    (tmp_path / "data").mkdir()
    (tmp_path / "mods").rename(tmp_path / "data" / "mods")
    done = pinjoint("run", truss, "--static")
    assert done.returncode == 0
    assert "The mod 'apple' was left out: KeyboardInterrupt (apple/__init__.py, line 1)." in done.stderr
    assert "The mod 'pear' was left out: SystemExit (pear/__init__.py, line 2)." in done.stderr


# --- modules and threads ---------------------------------------------------------------------------------------


def test_a_mod_that_is_called_like_a_module_leaves_that_alone(
    write_mod: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("numpy", "json", "pinjoint"):
        module = sys.modules[name]
        (found,) = mods.load([write_mod(name)])
        assert f"There is a Python module '{name}' already; give the mod another name." in found.problem
        assert sys.modules[name] is module
        assert main(["mods", "new", name, "--into", str(tmp_path / "new")]) == 2
        assert f"There is a Python module '{name}' already" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


LATE = SYSTEM.format(
    phase="EVENTS",
    body="import threading, time; threading.Thread(target=time.sleep, args=(60.0,), name='late').start()",
)


def test_threads_of_mods_do_not_keep_the_program_from_ending(
    write_mod: Write, truss: str, pinjoint: Pinjoint
) -> None:
    began = time.monotonic()
    done = pinjoint("run", truss, "--at", "0.001", "--mods", str(write_mod("apple", LATE)))
    assert done.returncode == 0
    assert "threads did not end and were left: late" in done.stderr
    assert time.monotonic() - began < 50.0


# --- Ctrl+C ------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT")
def test_ctrl_c_ends_the_program_whatever_a_mod_does(
    write_mod: Write, truss: str, hears_interrupts: None
) -> None:
    code = "def plugin(app):\n    print('here', flush=True)\n    while True:\n        pass"
    running = subprocess.Popen(
        [sys.executable, "-m", "pinjoint", "run", truss, "--mods", str(write_mod("apple", code))],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert running.stdout is not None
    assert running.stdout.readline() == "here\n"
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=20)
    assert running.returncode == 130
    assert said == "pinjoint: Interrupted.\n"


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT")
def test_where_ctrl_c_is_ignored_an_interrupt_is_of_a_mod(hears_interrupts: None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    assert not is_persons(KeyboardInterrupt())


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT")
def test_ctrl_c_is_told_from_an_exception_of_a_mod() -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    assert is_persons(KeyboardInterrupt())  # there is no telling
    try:
        mark_interrupts()
        with pytest.raises(Interrupt) as caught:
            signal.raise_signal(signal.SIGINT)
        assert is_persons(caught.value)
        assert not is_persons(KeyboardInterrupt())
        assert not is_persons(SystemExit())
    finally:
        signal.signal(signal.SIGINT, before)


def test_ctrl_c_is_not_lost_in_what_a_compiler_calls() -> None:
    """As LLVM calls it, from where no exception goes on."""
    ended: list[str] = []

    def _raw_object_cache_notify() -> None:
        signal.raise_signal(signal.SIGINT)
        ended.append("the call")

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        with pytest.raises(Interrupt):  # noqa: PT012 (it comes at any time of the wait)
            _raw_object_cache_notify()
            time.sleep(20.0)
    finally:
        signal.signal(signal.SIGINT, before)
    assert ended == ["the call"]


# --- what Fields and frames are given -----------------------------------------------------------------------------

CHECKER = """
from pinjoint.components import Component, Field, Particle

def check(value, where):
    return 1 / value

class Sail(Component):
    of = Particle
    area: Field[object] = Field(dtype=object, default=1.0, doc="", checker=check)

def plugin(app):
    app.component(Sail)
"""


def test_a_checker_that_fails_refuses_the_value(write_mod: Write) -> None:
    session: Any = Session.open(TRUSS, mods=[write_mod("apple", CHECKER)])
    session.particles["C"].apple_area = 4
    assert session.particles["C"].apple_area == 0.25
    with pytest.raises(
        FieldError, match=r"particle C: area cannot be checked; the checker of apple_area failed: Zero"
    ):
        session.particles["C"].apple_area = 0
    assert session.particles["C"].apple_area == 0.25
    assert "was switched off" in session.message


KIND = """
from pinjoint.components import Field, Handle

class Sail(Handle):
    table, noun = "sails", "sail"
    name: Field[str] = Field(dtype=str, doc="")

    @property
    def __class__(self):
        raise RuntimeError("no class")

def plugin(app):
    app.kind(Sail)
    app.action("apple.set", key="ctrl+shift+j")(lambda session, pixel: setattr(session, "trap", Trap()))

class Trap:
    def __getattribute__(self, name):
        raise RuntimeError("no luck")
    def __bool__(self):
        raise RuntimeError("no luck")
    def __iter__(self):
        raise RuntimeError("no luck")
"""


@pytest.mark.usefixtures("in_window")
def test_code_of_a_mod_that_no_guard_surrounds_is_named_all_the_same(write_mod: Write) -> None:
    session = Session.open(TRUSS, mods=[write_mod("apple", KIND)])
    session.press("ctrl+shift+j")
    frame = session.scenes.active.hint
    trap: Any = vars(session)["trap"]
    session.scenes.active.hint = lambda context: bool(trap)  # type: ignore[method-assign, assignment, return-value]
    session.frame(0.01)
    session.scenes.active.hint = frame  # type: ignore[method-assign]
    session.frame(0.01)
    assert (
        "The mod 'apple' was switched off: code that the program called failed: RuntimeError: no luck"
        in session.message
    )
