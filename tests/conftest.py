"""What several test folders share."""

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).resolve().parents[1]

# The first example of a plan may compile for seconds, so no example has a deadline. The same examples every
# time, so that a change is judged by what it changed; `--hypothesis-profile=explore` looks for new ones.
settings.register_profile("explore", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("pinjoint", settings.get_profile("explore"), derandomize=True)
settings.load_profile("pinjoint")


@pytest.fixture
def fresh_process() -> Callable[..., str]:
    """Run Python code in a process of its own; returns what it printed. `environment` adds variables."""

    def run(code: str, environment: Mapping[str, str] | None = None, timeout: float = 300.0) -> str:
        finished = subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"PYTHONPATH": str(ROOT)} | dict(environment or {}),
            capture_output=True,
            text=True,
            timeout=timeout,
        )
        assert finished.returncode == 0, finished.stderr
        return finished.stdout

    return run
