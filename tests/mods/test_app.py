"""What a mod registers works as what comes with Pinjoint does."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from components import Environment, World
from components.commands import Command
from game import Session, models, mods
from game.cli import main
from systems.render.marks import Text
from systems.render.picture import compose
from systems.render.theme import load_theme
from tests.mods.conftest import Write
from tests.mods.test_isolation import TRUSS


def opened(write_mod: Write, body: str, head: str = "") -> Session:
    code = f"{head}\ndef plugin(app):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    return Session.open(TRUSS, mods=[write_mod("apple", code)])


def test_layers_are_drawn_below_and_above_the_model(write_mod: Write) -> None:
    head = """
from systems.render.marks import Text
def says(text):
    def draw(sheet):
        x, y = sheet.view.camera.to_pixels((0.5, 0.5)).tolist()
        yield Text(text, x, y, sheet.font(12.0), sheet.theme.text)
    return draw
"""
    session = opened(write_mod, "app.layer(says('above'))\napp.layer(says('below'), below=True)", head)
    marks = compose(session.model, session.view, load_theme("light")).marks
    texts = [mark.text for mark in marks if isinstance(mark, Text)]
    assert texts.index("below") < texts.index("above")
    assert marks.index(next(m for m in marks if isinstance(m, Text) and m.text == "below")) < 3


def test_models_of_a_mod_are_opened_by_name(tmp_path: Path, write_mod: Write) -> None:
    (tmp_path / "models").mkdir()
    models.save(models.load(TRUSS), tmp_path / "models" / "apple_truss.json")
    opened(write_mod, f"app.models({str(tmp_path / 'models')!r})")
    assert "apple_truss" in models.bundled()
    assert Session.open("apple_truss").rods.count == 2
    mods.unload(mods.MODS[-1:])
    assert "apple_truss" not in models.bundled()


def test_a_command_gets_its_words_and_a_failing_one_ends_with_a_reason(
    write_mod: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    opened(write_mod, "app.command('apple', lambda words: print(words) or len(words))")
    assert main(["apple", "a", "--b"]) == 2
    assert capsys.readouterr().out == "['a', '--b']\n"


def test_an_integrator_can_be_chosen(write_mod: Write) -> None:
    head = """
from systems.physics.drivers import VelocityVerlet
class Mine(VelocityVerlet):
    '''Like Verlet's.'''
    name = "apple.mine"
"""
    session = opened(write_mod, "app.integrator(Mine)", head)
    session.settings.integrator = "mine"
    session.settings.time_step = 1e-5
    session.run(steps=20)
    assert session.simulation.integrator == "mine"
    other = Session.open(TRUSS)
    other.settings.integrator = "velocity_verlet"
    other.settings.time_step = 1e-5
    other.run(steps=20)
    assert session.particles.velocity.tobytes() == other.particles.velocity.tobytes()


def test_a_key_can_be_given_to_an_action_that_is_there(write_mod: Write) -> None:
    session = opened(write_mod, "app.key('ctrl+shift+j', 'toggle diagrams', ('pause',), 'forces')")
    session.press("ctrl+shift+j")
    assert session.view.all_diagrams
    mods.unload(mods.MODS[-1:])
    session.press("ctrl+shift+j")
    assert session.view.all_diagrams


class Rename:
    """A command of a mod's own: the model's title is in no table."""

    def __init__(self, title: str) -> None:
        self.title = title

    def apply(self, world: World) -> Command:
        """Give it; returns what gives the old one."""
        model: Any = world
        inverse = Rename(model.title)
        model.title = self.title
        return inverse


def fail_halfway(session: Session) -> None:
    with session.model.transaction("twice"):
        session.model.execute(Rename("newer"))
        raise ZeroDivisionError


def test_a_command_of_a_mods_own_is_undone_and_done_again() -> None:
    session = Session.open(TRUSS)
    session.model.execute(Rename("new"))
    assert session.model.title == "new"
    session.undo()
    assert session.model.title == ""
    session.redo()
    assert session.model.title == "new"
    with pytest.raises(ZeroDivisionError):
        fail_halfway(session)
    assert session.model.title == "new"


def test_facts_of_the_environment_and_of_all_rods_are_set_from_the_command_line(
    write_mod: Write, tmp_path: Path
) -> None:
    head = """
from components import Component, Environment, Field, Rod
class Air(Component):
    of = Environment
    heat: Field[float] = Field("K", title="temperature", doc="Of the air.", default=293.0)
class Paint(Component):
    of = Rod
    colour: Field[str] = Field(title="colour", doc="", default="red", dtype=str, choices=("red", "green"))
    coats: Field[int] = Field(title="coats", doc="", default=1, dtype=int, minimum=0)
"""
    opened(write_mod, "app.component(Air)\napp.component(Paint)", head)
    out = tmp_path / "out.csv"
    words = ["run", "isostatic", "--static", "--format", "csv", "--output", str(out)]
    assert main([*words, "--set", "rods.*.apple_coats=3", "--set", "environment.apple_heat=300"]) == 0
    assert ",rod,AB,apple_coats,3," in out.read_text(encoding="utf-8")
    assert main([*words, "--set", "rods.*.apple_coats=-1"]) == 2
    assert main([*words, "--set", "rods.*.apple_colour=blue"]) == 2
    assert "apple_heat" in vars(Environment)
