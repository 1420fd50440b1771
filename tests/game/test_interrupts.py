"""Ctrl+C while the program loads, and while a script does."""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import game
from game.interrupts import quietly_interrupted

PROGRAM = ["/usr/bin/pinjoint", "-m", str(Path(game.__file__).parent / "__main__.py")]


@pytest.fixture(autouse=True)
def heard() -> Iterator[None]:
    """As in a process started in the foreground; one in the background may be told to ignore Ctrl+C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


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
