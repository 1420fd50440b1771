"""Scripted sessions: they are played in the real scenes with the real keys, and replay to the same bits."""

import io
import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.field import Role
from pinjoint.scripts.playing import Recorder, play, session_of
from pinjoint.scripts.script import Script, ScriptError, lessons

SCRIPTS = sorted(Path(__file__).parent.glob("*.jsonl"))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
@pytest.mark.usefixtures("data")
def test_session(path: Path) -> None:
    script = Script(path)
    assert [str(failure) for failure in play(script)] == []


@pytest.mark.parametrize("name", lessons())
def test_lesson(name: str) -> None:
    lesson = Script(name)
    assert [str(failure) for failure in play(lesson)] == []
    assert lesson.title
    assert lesson.description


def test_a_script_that_saves_can_be_played_again_and_leaves_nothing_behind(tmp_path: Path, data: Path) -> None:
    saving = next(path for path in SCRIPTS if path.stem == "every_scene")
    assert [main(["play", str(saving)]) for _ in range(2)] == [0, 0]
    assert not data.exists()
    assert main(["play", str(saving), "--data", str(tmp_path / "kept")]) == 0
    assert list((tmp_path / "kept").rglob("*.json"))


def test_an_expectation_that_fails_says_what_where_expected_and_got(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "wrong.jsonl"
    path.write_text(
        '{"format": "pinjoint session", "version": 1, "model": "isostatic"}\n'
        '{"run": "rest"}\n{"expect": "rods.AB.axial_force ≈ -29 ± 0.1"}\n',
        encoding="utf-8",
    )
    assert main(["play", str(path)]) == 1
    said = capsys.readouterr()
    assert "line 3: expected rods.AB.axial_force ≈ -29 ± 0.1, got -28.34" in said.err
    assert "one expectation failed" in said.out


def test_a_session_expects_the_same_in_python() -> None:
    session = Session.open("isostatic")
    session.run(until="rest")
    session.expect("rods.AB.axial_force ≈ -28.34 ± 0.01")
    session.expect("scene = pause")
    with pytest.raises(AssertionError, match=r"expected time < 0, got 0\.0"):
        session.expect("time < 0")
    with pytest.raises(LookupError, match="did you mean 'AB'"):
        session.expect("rods.ABX.strain = 0")


@pytest.mark.usefixtures("data")
def test_a_part_of_a_text_is_expected_too() -> None:
    session = Session.open("isostatic")
    session.press("r")
    session.expect("message ≈ no time has passed")
    session.press("d")
    session.type("what nobody saved")
    session.press("return")
    session.expect("message ≈ File not found")
    with pytest.raises(AssertionError, match="File not found: there is"):
        session.expect("message = File not found")
    with pytest.raises(ValueError, match="which is not a number"):
        session.expect("message < a")


def test_an_expected_text_may_have_typed_minus_signs() -> None:
    session = Session.open("isostatic")
    session.press("p", tuple(session.view.camera.to_pixels([0.25, -0.5]).tolist()))
    session.expect("message = Particle 1: (25, -50) cm")
    session.expect("message ≈ (25, −50) cm")


def test_a_message_of_the_force_method_is_expected() -> None:
    session = Session.open("pendulum")
    session.press("k")
    session.expect("message ≈ mechanism")
    session.expect("force_method.message ≈ mechanism")


def test_settling_tells_what_yielded() -> None:
    session = Session.open("hyperstatic_yield")
    session.press("e")
    session.expect("message ≈ Rod CD yields in compression at the load factor 0.922")
    session = Session.open("hyperstatic")
    session.press("e")
    session.rods["CD"].compressive_strength = 80.0
    session.press("e")
    session.expect("message ≈ rod CD yielded")


@pytest.mark.parametrize(
    ("further", "words"),
    [
        ('"modle": "isostatic"', "line 1: there is no 'modle'"),
        ('"model": null', "line 1: model is null; write the name"),
    ],
)
def test_wrong_headers_are_explained(tmp_path: Path, further: str, words: str) -> None:
    path = tmp_path / "wrong.jsonl"
    path.write_text('{"format": "pinjoint session", "version": 1, ' + further + "}", encoding="utf-8")
    with pytest.raises(ScriptError, match=words):
        Script(path)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('{"pres": "k"}', r"line 2: there is no key 'pres' here; did you mean 'press'"),
        ('{"press": "k", "run": 1}', "line 2: a line can do one thing"),
        ('{"expect": "rods.AB"}', "is not an expectation"),
        ('{"expect": "rods.AX.strain = 0"}', "choose one of AB, BC, CA"),
        ('{"expect": "rods.*.strain = 0"}', "it names every rod; write a name"),
        ('{"expect": "settings.restition = 1"}', "did you mean 'restitution'"),
        ('{"expect": "speed = 1"}', "There is no 'speed' among the quantities"),
        ('{"expect": "particles.B.position = 1"}', "add .x or .y"),
        ('{"expect": "rods.AB.axial_force = high"}', "cannot be compared with 'high'; write a number"),
        ('{"press": 5}', 'line 2: press is 5; write it like {"press": "space"}'),
        ('{"set": 5}', "line 2: set is 5; write it like"),
        ('{"click": [1]}', r"click is \[1\]; write it like"),
        ('{"drag": [0, 1]}', r"drag is \[0, 1\]; write it like"),
        ('{"run": "dawn"}', 'run is "dawn"; write it like {"run": 0.5}'),
        ('{"run": true}', "run is true; write it like"),
        ('{"run": 1e999}', "run is Infinity; write it like"),
        ('{"run": NaN}', "run is NaN; write it like"),
        ('{"steps": 1.5}', "steps is 1.5; write it like"),
        ('{"resize": [0, 100, 1]}', r"resize is \[0, 100, 1\]; write it like"),
        ("[1]", "line 2: write an object"),
        ("{", "line 2: this is not JSON"),
    ],
)
def test_wrong_lines_are_explained(tmp_path: Path, line: str, words: str) -> None:
    path = tmp_path / "wrong.jsonl"
    header = '{"format": "pinjoint session", "version": 1, "model": "isostatic"}\n'
    path.write_text(header + line + "\n", encoding="utf-8")
    with pytest.raises(ScriptError, match=words):
        play_file(path)


def play_file(path: Path) -> None:
    play(Script(path))


def test_a_recording_replays_to_the_same_bits(tmp_path: Path) -> None:
    """Frames of irregular length while recording; the replay takes the same steps between the same inputs."""
    session = Session.open("hyperstatic")
    file = io.StringIO()
    Recorder(session, file, "hyperstatic")
    random = np.random.default_rng(7)
    session.press("i")
    session.press("space")
    for _ in range(20):
        session.frame(float(random.uniform(0.005, 0.03)))
    session.click(1.5, 0.75)
    session.press("delete")
    for _ in range(20):
        session.frame(float(random.uniform(0.005, 0.03)))
    session.press("escape")
    session.press("p", (250.0, 130.0))
    path = tmp_path / "recorded.jsonl"
    path.write_text(file.getvalue(), encoding="utf-8")
    assert all(json.loads(line) for line in file.getvalue().splitlines())
    replayed = replayed_from(path)
    assert _bits(replayed) == _bits(session)


def test_a_window_that_is_resized_replays_to_the_same_bits(tmp_path: Path) -> None:
    session, path = Session.open("isostatic"), tmp_path / "recorded.jsonl"
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, "isostatic")
        session.press("p", (100.0, 100.0))
        session.resize(900, 500, 2.0)
        session.press("home")
        session.press("p", (700.0, 100.0))
    replayed = replayed_from(path)
    assert replayed.view.camera == session.view.camera
    assert _bits(replayed) == _bits(session)


@pytest.mark.parametrize("name", ["gerber_beam", "isostatic"])
def test_a_recording_begins_with_the_view_that_it_is_played_in(name: str, tmp_path: Path) -> None:
    session, path = Session.open(name), tmp_path / "recorded.jsonl"
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, name)
    replayed = replayed_from(path)
    assert replayed.view.camera == session.view.camera


def test_a_key_acts_where_the_pointer_was(tmp_path: Path) -> None:
    session, path = Session.open("isostatic"), tmp_path / "recorded.jsonl"
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, "isostatic")
        session.update_view()
        session.view.pointer = 100.0, 100.0
        session.press("l", session.view.pixel)
    replayed = replayed_from(path)
    assert replayed.view.pointer == session.view.pointer


def test_what_was_pasted_from_another_program_is_in_the_recording(tmp_path: Path) -> None:
    other = Session.open("pendulum")
    other.press("ctrl+a")
    other.press("ctrl+c")
    session, path = Session.open("isostatic"), tmp_path / "recorded.jsonl"
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, "isostatic")
        session.clipboard = other.clipboard
        session.press("ctrl+v", (100.0, 100.0))
    replayed = replayed_from(path)
    assert replayed.particles.count == session.particles.count > 3
    assert _bits(replayed) == _bits(session)


def replayed_from(path: Path) -> Session:
    replayed = session_of(Script(path))
    play(Script(path), replayed)
    return replayed


def _bits(session: Session) -> dict[str, bytes]:
    return {
        f"{table.name}.{field.name}": repr(table.column(field.name).tolist()).encode()
        for table in session.model.tables.values()
        for field in table.fields_in(Role.DOCUMENT, Role.STATE)
    }


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
def test_a_recording_that_cannot_be_written_ends_and_says_so() -> None:
    """A full disk ended the window."""
    session = Session.open("isostatic")
    with open("/dev/full", "w", encoding="utf-8") as file:
        Recorder(session, file, "isostatic")
        assert "recording ends here: /dev/full cannot be written: No space left" in session.notice
        session.press("p")
        session.resize(300, 200)
