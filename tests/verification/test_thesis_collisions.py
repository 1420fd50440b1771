"""The thesis' six collisions, computed by `pinjoint run`, against the exact answers of the impact laws."""

import json

import pytest

from pinjoint.commands.command_line import main

ROOT = 3.0**0.5  # of offset centres: the line of centres is at 30° to the motion

SIX = {
    "i": ((2.5, 0.0), (2.5, 0.0)),
    "ii": ((1.25, 0.0), (3.75, 0.0)),
    "iii": ((0.0, 0.0), (5.0, 0.0)),
    "iv": ((5.0 * (1 - 10000) / 10001, 0.0), (10.0 / 10001, 0.0)),
    "v": ((5.0 * (10000 - 1) / 10001, 0.0), (5.0 * 20000 / 10001, 0.0)),
    "vi": ((1.25, -1.25 * ROOT), (3.75, 1.25 * ROOT)),
}


@pytest.mark.parametrize("case", SIX)
def test_velocities_after_the_impact(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", f"collision_{case}", "--at", "0.2", "--format", "json"]) == 0
    final = json.loads(capsys.readouterr().out)["states"][-1]
    assert final["collisions"] == 1
    for particle, expected in zip(final["particles"].values(), SIX[case], strict=True):
        assert particle["velocity"] == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert final["energy"]["imbalance"] == pytest.approx(0.0, abs=1e-12)
