"""Ctrl+C while the program loads, and while a script does."""

import signal
import sys
from pathlib import Path

import pytest

import game
from game.interrupts import unheard


@pytest.mark.parametrize("called", ["/usr/bin/pinjoint", "-m", str(Path(game.__file__).parent / "__main__.py")])
def test_the_program_ends_without_a_word(called: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [called, "run"])
    with unheard():
        assert signal.getsignal(signal.SIGINT) is signal.SIG_DFL
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("argv", [["study.py"], ["/lib/pytest/__main__.py"], [""], []])
def test_scripts_are_left_alone(argv: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", argv)
    with unheard():
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
