"""What takes too long is interrupted, exactly once, and the interpreter is left as it was."""

import time
from collections.abc import Callable
from contextlib import suppress

import pytest

from pinjoint.mods.limit import TooLong, within

# Tracing, as debuggers and coverage do: an interpreter that still believes an exception is due never returns.
TRACED = """
from pinjoint.mods.limit import TooLong, within
from tests.reference.lines import lines_run
def endless():
    while True:
        pass
try:
    within(0.01, "<string>", endless)
except TooLong:
    print(lines_run(lambda: None))
"""


def busy(seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


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

    with pytest.raises(TooLong, match=r"more than 0\.01 s"):
        within(0.01, __file__, stubborn)
    assert caught == 3


def test_of_limits_inside_each_other_the_outermost_counts() -> None:
    with pytest.raises(TooLong, match=r"more than 0\.05 s"):
        within(0.05, __file__, lambda: within(0.001, __file__, lambda: busy(10.0)))
    within(5.0, __file__, lambda: within(0.001, __file__, lambda: busy(0.1)))
    busy(0.1)


def test_code_that_is_not_of_the_folder_is_not_interrupted() -> None:
    within(0.01, "elsewhere", lambda: busy(0.1))


def test_nothing_comes_after_the_end() -> None:
    for milliseconds in range(0, 40, 2):  # the end and the interruption come as close as may be
        with suppress(TooLong):
            within(2e-4, __file__, lambda end=milliseconds * 1e-3: busy(end))  # type: ignore[misc]
        busy(1e-4)


def test_a_debugger_still_works_afterwards(fresh_process: Callable[..., str]) -> None:
    assert fresh_process(TRACED, timeout=60.0).strip() == "1"
