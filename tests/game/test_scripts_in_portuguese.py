"""Scripts, results and files are the same in every language."""

import json
import re
from pathlib import Path

import pytest

from pinjoint.commands.command_line import main
from pinjoint.components.language import english, language, spoken
from pinjoint.documents import library
from pinjoint.lessons.checking import check_lesson
from pinjoint.scripts.playing import Recorder, play, session_of
from pinjoint.scripts.script import TO_DO, Script, ScriptError, lessons
from pinjoint.session import Session
from pinjoint.systems.render.marks import Stamps
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme
from tests.pseudo import pseudo

SCRIPTED = sorted((Path(__file__).parents[1] / "scripted").glob("*.jsonl"))


@pytest.mark.parametrize("source", [*lessons(), *SCRIPTED], ids=lambda source: Path(source).stem)
def test_scripts_play_where_every_word_differs(source):
    with pseudo(), library.data_in():
        assert not play(Script(source))


@pytest.mark.parametrize("name", lessons(TO_DO))
def test_tasks_of_lessons_are_solved_where_every_word_differs(name):
    with pseudo(), library.data_in():
        assert not check_lesson(Script(name))


def pressed_and_read() -> tuple[object, ...]:
    """What a script reads while it presses keys: notices, boxes, panels and colours."""
    session = Session.open("hyperstatic_yield")
    session.select(session.rods["AB"])
    said = []
    for key in ("c", "ctrl+d", "ctrl+z", "ctrl+y", "delete", "ctrl+z", "ctrl+l", "m", "j", ".", "r"):
        session.press(key)
        said.append(str(english(session.notice)))
    session.press("return")
    session.click_box("tension only")
    session.type("y")
    boxes = session.boxes
    session.press("escape")
    session.press("escape")
    session.press("space")
    session.frame(0.01)
    [picture, *_] = compose_all(session.stages, load_theme("light"))
    inks = [mark.ink for mark in picture.marks if isinstance(mark, Stamps)]
    return said, boxes, list(session.view.since), inks


def test_what_scripts_read_is_as_in_english() -> None:
    before = pressed_and_read()
    assert before[1]["tension only"] == "yes"
    with pseudo():
        assert pressed_and_read() == before


TAKEN = re.compile(r'"[a-z_]*seconds": [0-9.e-]+')  # how long it took
RESULTS = (
    ["run", "isostatic"],
    ["run", "isostatic_collapse", "--static"],
    ["run", "hyperstatic_yield", "--at", "0.01,0.02"],
    ["verify", "isostatic"],
    ["buckling", "eulers_columns"],
    ["force-method", "hyperstatic", "--all"],
    ["curve", "von_mises"],
    ["plan", "isostatic"],
)


@pytest.mark.parametrize("words", RESULTS, ids=lambda words: " ".join(words[:2]))
@pytest.mark.parametrize("form", ["json", "csv"])
def test_results_for_machines_are_the_same_in_both_languages(words, form, capsys):
    def written() -> tuple[int, str]:
        return main([*words, "--format", form]), TAKEN.sub("", capsys.readouterr().out)

    first = written()
    assert first[1]
    with spoken("pt"):
        assert written() == first


@pytest.mark.parametrize("name", ["isostatic", "portal", "newtons_cradle"])
def test_files_are_the_same_in_both_languages(name, tmp_path):
    def saved(file: str) -> bytes:
        session = Session.open(name)
        session.run(time=0.05)
        session.act("new slider")
        session.document.save_as(tmp_path / file)
        return (tmp_path / file).read_bytes()

    first = saved("a.json")
    with spoken("pt"):
        assert saved("b.json") == first


def recorded(path: Path) -> list[dict]:
    session = Session.open("isostatic")
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, "isostatic")
        session.press("t", (300.0, 200.0))
        session.press("right click", (500.0, 300.0))
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_recordings_say_their_language_unless_it_is_english(tmp_path):
    assert "language" not in recorded(tmp_path / "en.jsonl")[0]
    with spoken("pt"):
        assert recorded(tmp_path / "pt.jsonl")[0]["language"] == "pt"
    assert Script(tmp_path / "en.jsonl").language == "en"
    assert Script(tmp_path / "pt.jsonl").language == "pt"
    assert not any(Script(name).language for name in lessons())


@pytest.mark.parametrize(
    ("header", "around", "expected"), [("en", "pt", "en"), ("pt", "en", "pt"), ("", "pt", "pt")]
)
def test_scripts_are_played_in_their_language(tmp_path, monkeypatch, header, around, expected):
    path = tmp_path / "script.jsonl"
    first = {"format": "pinjoint session", "version": 1} | ({"language": header} if header else {})
    path.write_text(f'{json.dumps(first)}\n{{"action": "fit"}}\n')
    heard = []
    monkeypatch.setattr(Session, "act", lambda session, name: heard.append(language()))
    with spoken(around):
        play(Script(path), session_of(Script(path)))
        assert language() == around
    assert heard == [expected]


def test_a_language_that_there_is_not_is_refused(tmp_path):
    path = tmp_path / "script.jsonl"
    path.write_text('{"format": "pinjoint session", "version": 1, "language": "xx"}\n')
    with pytest.raises(ScriptError, match='the language is "xx"; write one of en, pt'):
        Script(path)


def test_the_command_plays_in_english_unless_another_language_is_asked_for(monkeypatch):
    from pinjoint.scripts import playing

    heard = []
    monkeypatch.setattr(playing, "play", lambda script, session: heard.append(language()) or [])
    with spoken("pt"):
        monkeypatch.setenv("PINJOINT_LANGUAGE", "")
        main(["play", "4_collisions"])
        monkeypatch.setenv("PINJOINT_LANGUAGE", "pt")
        main(["play", "4_collisions"])
    assert heard == ["en", "pt"]
