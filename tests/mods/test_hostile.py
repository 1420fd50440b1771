"""Hostile mods: each is named, switched off and survived, in the window and without it, and `mods check` finds it."""

import sys
from collections.abc import Iterator
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.mods import guard, mod
from pinjoint.systems.input import pygame_input
from tests.mods.conftest import Write
from tests.mods.hostile import HOSTILE, KEY, LOAD, RUN, WINDOW, Hostile
from tests.mods.test_isolation import TRUSS

CASES = pytest.mark.parametrize("hostile", HOSTILE.values(), ids=HOSTILE)


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pygame_input, "IDLE_PAUSE", 0.0)
    for module in (guard, mod):
        monkeypatch.setattr(module, "PATIENCE", 0.3)
    monkeypatch.setitem(mod.Mod.call.__kwdefaults__, "patience", 0.3)


@pytest.fixture
def bad(write_mod: Write) -> Iterator[Any]:
    modules = {name: module for name, module in sys.modules.items() if not name.startswith("pinjoint_program")}
    yield lambda hostile: write_mod("bad", hostile.code)
    assert all(sys.modules.get(name) is module for name, module in modules.items())


def check_named(hostile: Hostile, sentences: list[str]) -> None:
    assert len(sentences) == 1, sentences
    assert "The mod 'bad' was " in sentences[0]
    assert hostile.said in sentences[0]


def modelled() -> Any:
    """A truss, with a load of the mod's history if it has one."""
    from pinjoint.components.load import HISTORIES

    kind = "bad" if "bad" in HISTORIES else "ramp"
    return {**TRUSS, "loads": [{"on": "C", "force": [0.0, -1.0], "history": {"kind": kind}}]}


@CASES
def test_in_a_window(hostile: Hostile, bad: Any) -> None:
    from pinjoint.app import App

    mods.load([bad(hostile)])
    app = App(models.parse(modelled()))
    try:
        app.session.resize(400, 300)
        app.frame(0.02)
        for _ in range(2):
            app.session.press(KEY)
            app.frame(0.02)
        app.session.click(0.2, 0.2)
        app.frame(0.02)
        assert isinstance(app.session.boxes, dict)
        if app.session.scene != "pause":
            app.session.scenes.request("pause")
        app.frame(0.02)
        if WINDOW in hostile.found or LOAD in hostile.found:
            check_named(hostile, mods.FAULTS)
        assert app.session.scene == "pause"
        app.session.particles["C"].force = (1.0, 0.0)
        app.session.undo()
        app.frame(0.02)
    finally:
        app.close()


@CASES
@pytest.mark.usefixtures("compiling")
def test_in_a_run_of_its_own(hostile: Hostile, bad: Any) -> None:
    mods.load([bad(hostile)])
    session = Session.open(modelled())
    if RUN in hostile.found and not mods.FAULTS:
        with pytest.raises(mods.ModError, match=r"The mod 'bad' was switched off: .* The run stopped at t = "):
            session.run(steps=20)
    else:
        assert session.run(steps=20) == "time reached"
    if mods.FAULTS or RUN in hostile.found or LOAD in hostile.found:
        check_named(hostile, mods.FAULTS)
    assert session.run(steps=20) == "time reached"
    assert session.particles.count == 3


@CASES
@pytest.mark.usefixtures("compiling")
def test_a_check_finds_it(hostile: Hostile, bad: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mods", "check", str(bad(hostile))]) == 1
    out = capsys.readouterr().out
    assert "bad 1.0: PROBLEMS" in out
    assert hostile.said in out
