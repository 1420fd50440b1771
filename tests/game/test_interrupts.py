"""Ctrl+C while the program loads, and while a script does."""

import itertools
import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

import pinjoint
from pinjoint import elsewhere
from pinjoint.documents.library import DATA_VARIABLE
from pinjoint.interrupts import CLOSING, closed_by_signals, quietly_interrupted
from pinjoint.systems.program.writer import FEW

pytestmark = pytest.mark.usefixtures("hears_interrupts")
ROOT = Path(pinjoint.__file__).parents[1]
PROGRAM = ["/usr/bin/pinjoint", "-m", str(Path(pinjoint.__file__).parent / "__main__.py")]


@pytest.mark.parametrize("called", PROGRAM)
def test_the_program_ends_without_a_word(called: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [called, "run"])
    with quietly_interrupted():
        assert signal.getsignal(signal.SIGINT) is signal.SIG_DFL
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("called", PROGRAM)
def test_a_program_told_to_ignore_it_goes_on_to(called: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [called, "run"])
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with quietly_interrupted():
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@pytest.mark.parametrize("argv", [["study.py"], ["/lib/pytest/__main__.py"], [""], []])
def test_scripts_are_left_alone(argv: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", argv)
    with quietly_interrupted():
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("number", CLOSING)
def test_signals_close_a_window(number: signal.Signals) -> None:
    closed: list[bool] = []
    given = signal.signal(number, signal.default_int_handler)  # nohup has some of them ignored
    try:
        with closed_by_signals(lambda: closed.append(True)):
            signal.raise_signal(number)
        assert closed == [True]
        assert signal.getsignal(number) is signal.default_int_handler
    finally:
        signal.signal(number, given)
    if hasattr(signal, "setitimer"):
        assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


ENDLESS = """
import signal
from pinjoint import interrupts

interrupts.PATIENCE = 0.2
with interrupts.closed_by_signals(lambda: None):
    signal.raise_signal(signal.SIGTERM)
    while True:
        pass
"""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="the system has no timers")
def test_a_window_that_hangs_is_ended() -> None:
    done = subprocess.run([sys.executable, "-c", ENDLESS], cwd=ROOT, capture_output=True, timeout=60)
    assert done.returncode == -signal.SIGALRM


SWALLOWS = """
import signal, time
from pinjoint import interrupts

signal.signal(signal.SIGINT, signal.default_int_handler)
interrupts.PATIENCE = 0.2
interrupts.end_in_time()
while True:
    try:
        signal.raise_signal(signal.SIGINT)
        time.sleep(9.0)
    except KeyboardInterrupt:
        pass
"""


def test_a_program_that_does_not_heed_a_signal_is_ended() -> None:
    done = subprocess.run([sys.executable, "-c", SWALLOWS], cwd=ROOT, capture_output=True, timeout=60)
    assert done.returncode == 128 + signal.SIGINT


def test_what_compiles_ends_with_the_window_that_alone_hears_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(os, "getpid", lambda: os.getppid())  # as if what started it were gone
        process = elsewhere.started({("dop853", FEW, ""): b""}, urgent=True)
    assert (os.getsid(process.pid), *process.communicate(timeout=60)) == (process.pid, "", None)


COMMANDS = (
    "run tower",
    "verify warren_bridge",
    "sweep isostatic --vary rods.AB.stiffness=1e5:2e5:3000 --measure rods.AB.axial_force --output out.csv --workers 2",
    "mods check stiffening",
    "ball_on_frame",
)


@pytest.mark.parametrize(
    ("command", "number"),
    list(zip(COMMANDS, itertools.cycle([signal.SIGINT, signal.SIGTERM]), strict=False)),
    ids=[command[:8] for command in COMMANDS],
)
def test_anything_ends_when_it_is_told_to(command: str, number: signal.Signals, tmp_path: Path) -> None:
    """While it loads, compiles, rewrites kernels, computes, or draws, with an empty cache."""
    moment = random.Random(f"{command} {number}").uniform(0.5, 4.0)
    folders = dict.fromkeys(("XDG_CACHE_HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME"), str(tmp_path))
    words = [str(ROOT / "assets" / "mods" / word) if word == "stiffening" else word for word in command.split()]
    with (tmp_path / "said").open("w+") as said:
        program = subprocess.Popen(
            [sys.executable, "-m", "pinjoint", *words],
            env=os.environ | folders | {DATA_VARIABLE: str(tmp_path)},
            cwd=tmp_path,
            stdout=said,
            stderr=said,
        )
        with suppress(subprocess.TimeoutExpired):
            program.wait(moment)
        program.send_signal(number)
        program.wait(20)
        said.seek(0)
        # Dask prints one of its own where it is told to end while its workers begin.
        assert command.startswith("sweep") or "Traceback" not in said.read()


def test_a_window_ends_cleanly_when_it_is_told_to(tmp_path: Path) -> None:
    """It leaves no recovery file behind."""
    folders = {"XDG_DATA_HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path)}
    record, said = tmp_path / "record.jsonl", tmp_path / "said"
    with said.open("w") as file:
        window = subprocess.Popen(
            [sys.executable, "-m", "pinjoint", "isostatic", "--record", str(record)],
            env=os.environ | folders | {DATA_VARIABLE: str(tmp_path)},
            cwd=ROOT,
            stdout=file,
            stderr=file,
        )
        while not record.exists() and window.poll() is None:
            time.sleep(0.02)
        time.sleep(0.5)
        window.send_signal(signal.SIGTERM)
        assert window.wait(60) == 0
    assert said.read_text() == ""
    assert not list((tmp_path / "autosave").iterdir())
