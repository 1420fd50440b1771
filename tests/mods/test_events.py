"""Events of mods: the same in all ways of running; one that fails switches its mod off."""

import io
import json
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.scripts.playing import Recorder, play
from pinjoint.scripts.script import Script
from tests.reference import bits
from tests.systems.test_events import pulled

MOD = """
from numba import njit
from pinjoint.systems.base import Event

@njit
def within(elongation, rods_rest_length):
    return 1.0 - elongation / rods_rest_length / 1e-3

class Breaking(Event):
    name = "breaking.rods"
    kernel = within
    reads = ("rods.rest_length",)

    def happen(self, model, fallen, risen):
        model.environment.force = (model.clock.time, 0.0)  # so that files and reports tell when
        model.delete(fallen)

def plugin(app):
    app.system(Breaking)
"""
MANIFEST = 'name = "breaking"\nversion = "1"\n'


@pytest.fixture
def mod(tmp_path: Path) -> Path:
    folder = tmp_path / "breaking"
    folder.mkdir()
    (folder / "__init__.py").write_text(MOD, encoding="utf-8")
    (folder / "mod.toml").write_text(MANIFEST, encoding="utf-8")
    return folder


def test_a_mods_event_happens_at_the_same_time_to_the_bit_in_all_four_ways_of_running(
    mod: Path, tmp_path: Path, unloaded: None, answer: Any
) -> None:
    mods.load([mod])
    file = tmp_path / "held.json"
    file.write_text(json.dumps(pulled()), encoding="utf-8")
    run = Session.open(file)
    run.simulation.program.module.load()  # the others are interpreted
    run.run(time=0.2)
    expected = run.simulation.events
    assert [(happening.event, happening.fallen) for happening in expected] == [("breaking.rods", ("AB",))]

    frames = Session.open(file)
    recorded = io.StringIO()
    Recorder(frames, recorded, str(file))
    frames.press("space")
    while frames.time < 0.1:
        frames.frame(1.0 / 144.0)
    frames.press("space")
    assert frames.simulation.events == expected

    recording = tmp_path / "recorded.jsonl"
    recording.write_text(recorded.getvalue(), encoding="utf-8")
    script = Script(recording)
    played = Session.open(script.source)
    assert play(script, played) == []
    assert played.simulation.events == expected
    assert bits.state(played.model) == bits.state(frames.model)

    found = answer("run", str(file), "--at", "0.2")
    (event,) = found["events"]
    assert (event["event"], event["time"], event["fallen"]) == ("breaking.rods", expected[0].time, ["AB"])
    assert found["states"][-1]["rods"] == {}


def test_a_handler_that_fails_switches_its_mod_off_and_leaves_the_model_as_it_was(
    mod: Path, unloaded: None
) -> None:
    code = (mod / "__init__.py").read_text(encoding="utf-8")
    fails = code.replace("model.delete(fallen)", "raise RuntimeError('no luck')")
    (mod / "__init__.py").write_text(fails, encoding="utf-8")
    mods.load([mod])
    session = Session.open(pulled())
    with pytest.raises(
        mods.ModError, match=r"no luck \(breaking/__init__.py, line 16\). The run stopped at t = 26.18 ms"
    ):
        session.run(time=0.2)
    assert session.rods.count == 1
    assert session.environment.force == (0.0, 0.0)
    assert "RuntimeError: no luck" in mods.FAULTS[-1]
