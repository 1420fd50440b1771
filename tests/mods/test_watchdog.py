"""The watchdog interrupts what takes too long, exactly once, and leaves the interpreter as it was."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress

import pytest

from pinjoint.mods.watchdog import TooLong, within

# Tracing, as debuggers and coverage do: an interpreter that still believes an exception is due never returns.
TRACED = """
from pinjoint.mods.watchdog import TooLong, within
from tests.reference.lines import lines_run
def endless():
    while True:
        pass
try:
    within(0.01, lambda: True, endless)
except TooLong:
    print(lines_run(lambda: None))
"""


def busy(seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


def test_what_takes_too_long_is_interrupted() -> None:
    with pytest.raises(TooLong, match=r"more than 0\.01 s"):
        within(0.01, lambda: True, lambda: busy(10.0))


def test_what_catches_the_exception_and_goes_on_is_interrupted_again() -> None:
    caught = 0

    def stubborn() -> None:
        nonlocal caught
        while caught < 3:
            try:
                busy(10.0)
            except BaseException:
                caught += 1
        busy(10.0)

    with pytest.raises(TooLong):
        within(0.01, lambda: True, stubborn)
    assert caught == 3


def test_of_watches_inside_each_other_the_outermost_counts() -> None:
    with pytest.raises(TooLong, match=r"more than 0\.05 s"):
        within(0.05, lambda: True, lambda: within(0.001, lambda: True, lambda: busy(10.0)))
    within(0.05, lambda: True, lambda: within(0.001, lambda: True, lambda: busy(0.01)))
    busy(0.1)


def test_it_is_not_interrupted_where_it_may_not_be() -> None:
    may, reached = False, False

    def body() -> None:
        nonlocal may, reached
        busy(0.05)
        reached = may = True
        busy(10.0)

    try:
        within(0.01, lambda: may, body)
    except TooLong:
        assert reached
    else:
        raise AssertionError("It went on where it might be interrupted.")


def test_nothing_comes_after_the_end() -> None:
    for microseconds in range(0, 400, 4):  # the end and the interruption come as close as may be
        with suppress(TooLong):
            within(2e-4, lambda: True, lambda end=microseconds * 1e-6: busy(end))  # type: ignore[misc]
        busy(1e-4)


def test_a_debugger_still_works_afterwards(fresh_process: Callable[..., str]) -> None:
    assert fresh_process(TRACED, timeout=60.0).strip() == "1"
