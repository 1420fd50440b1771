"""Calculations in parts: one that nobody asked for long begins anew."""

import time

import pytest

from pinjoint.systems.statics import behind
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
