"""How many cores a computation may use."""

from __future__ import annotations

import os

VARIABLE = "PINJOINT_CORES"

_home = os.getpid()


def cores() -> int:
    """What the environment variable PINJOINT_CORES says, else as many as this process may use.

    One in a process that was forked, for the threads of its parent are not there.
    """
    if os.getpid() != _home:
        return 1
    there = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    asked = os.environ.get(VARIABLE, "")
    return min(max(int(asked), 1), there) if asked.isdigit() else there
