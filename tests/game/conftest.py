"""Frames of windows and sessions in tests last as long on a loaded machine as on an idle one."""

from itertools import count
from types import SimpleNamespace

import pytest

from pinjoint.systems.collision.free import discs, flight
from pinjoint.systems.run import real_time, simulation

READING = 1e-4  # s that pass from one reading of the clock to the next


@pytest.fixture(autouse=True)
def clock_of_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """What steps cost, and when a frame must end, is read on a clock of the tests' own, so that a run's frames take the
    same steps everywhere.
    """
    readings = count()
    own = SimpleNamespace(perf_counter=lambda: READING * next(readings))
    for module in (real_time, simulation, flight):
        monkeypatch.setattr(module, "time", own)
    monkeypatch.setattr(discs, "perf_counter", own.perf_counter)
