"""The command line as a person meets it: exit status, one clear line for what is wrong, nothing lost."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def pinjoint(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A process of its own, on no display but what `environment` says."""
    unset = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
    inherited = {name: value for name, value in os.environ.items() if name not in unset}
    return subprocess.run(
        [sys.executable, "-m", "game", *words],
        cwd=ROOT,
        env=inherited | environment,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=60,
    )


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere there always is a display")
@pytest.mark.parametrize("environment", [{}, {"DISPLAY": ":98765"}], ids=["none", "out of reach"])
def test_without_a_display_one_line_says_so(environment: dict[str, str]) -> None:
    found = pinjoint("isostatic", **environment)
    assert found.returncode == 3
    (line,) = [line for line in found.stderr.splitlines() if line.startswith("pinjoint: ")]
    assert "pinjoint run" in line
    assert found.stdout == ""
