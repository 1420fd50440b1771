"""Calculations in parts: one that nobody asked for long begins anew."""

import math
import time

import pytest

from pinjoint import Session
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.systems.statics import behind
from pinjoint.systems.statics.settle import settle
from tests.properties.limits import within


def test_what_was_forgotten_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """The next part waited for ever for a thread that had ended."""
    monkeypatch.setattr(behind, "_FORGOTTEN", 0.05)

    def calculate() -> int:
        for _ in range(3):
            behind.rest()
        return 7

    calculation = behind.Behind(calculate)
    assert not calculation.part(0.0)
    time.sleep(0.3)
    with within(10.0):
        while not calculation.part(1.0):
            pass
    assert calculation.result() == 7


def test_while_one_rests_another_structure_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both waited for the lock that Python 3.11 has around cached properties, until the one was forgotten."""
    monkeypatch.setattr(behind, "_FORGOTTEN", 20.0)
    begun = []

    def calculate() -> None:
        begun.append(1)
        settle(Session.open("portal").model, (1.0,), FIRST_ORDER)

    calculation = behind.Behind(calculate)
    assert not calculation.part(0.0)
    settle(Session.open("vierendeel").model, (1.0,), FIRST_ORDER)
    assert calculation.part(math.inf)
    assert begun == [1], "it was not forgotten"
