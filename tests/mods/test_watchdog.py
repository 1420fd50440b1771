"""The watchdog interrupts what takes too long, exactly once, and leaves the interpreter as it was."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest

from game.mods.watchdog import TooLong, interrupted_after

# Tracing, as debuggers and coverage do: an interpreter that still believes an exception is due never returns.
TRACED = """
from game.mods.watchdog import TooLong, interrupted_after
from tests.reference.lines import lines_run
try:
    with interrupted_after(0.01, lambda: True):
        while True:
            pass
except TooLong:
    print(lines_run(lambda: None))
"""


def busy(seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


def test_what_takes_too_long_is_interrupted() -> None:
    with pytest.raises(TooLong, match=r"more than 0\.01 s"), interrupted_after(0.01, lambda: True):
        busy(10.0)


def test_it_is_not_interrupted_where_it_may_not_be() -> None:
    may, reached = False, False
    try:
        with interrupted_after(0.01, lambda: may):
            busy(0.05)
            reached = may = True
            busy(10.0)
    except TooLong:
        assert reached
    else:
        raise AssertionError("It went on where it might be interrupted.")


def test_nothing_comes_after_the_end() -> None:
    for microseconds in range(0, 400, 4):  # the end and the interruption come as close as may be
        try:
            with interrupted_after(2e-4, lambda: True):
                busy(microseconds * 1e-6)
        except TooLong:
            pass
        busy(1e-4)


def test_a_debugger_still_works_afterwards(fresh_process: Callable[..., str]) -> None:
    assert fresh_process(TRACED, timeout=60.0).strip() == "1"
