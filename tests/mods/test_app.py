"""What a mod registers works as what comes with Pinjoint does."""

import sys
import typing
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

from pinjoint import Session, mods
from pinjoint.commands.command_line import main
from pinjoint.components import Environment, World
from pinjoint.components.camera import Viewport
from pinjoint.components.commands import Command
from pinjoint.documents import models
from pinjoint.lessons import progress
from pinjoint.mods.declared import check
from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.mods.conftest import Write
from tests.mods.test_isolation import TRUSS
from tests.reference.hits import hits_for
from tests.reference.models import model, particle


def opened(write_mod: Write, body: str, head: str = "") -> Session:
    code = f"{head}\ndef plugin(app):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    return Session.open(TRUSS, mods=[write_mod("apple", code)])


def test_layers_are_drawn_below_and_above_the_model(write_mod: Write) -> None:
    head = """
from pinjoint.systems.render.marks import Text
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


TASK = """{{"task": "Hang a weight on B.", "model": "truss", "until": "particles.B.force.y < 0", "right": "It hangs.",
"solution": [{{"set": "particles.B.force=0,{load}"}}]}}""".replace("\n", " ")


@pytest.mark.parametrize(("load", "rc"), [(-5, 0), (5, 1)])
def test_a_mod_brings_lessons_in_its_folder(
    load: int, rc: int, write_mod: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_mod("apple")
    (folder / "lessons").mkdir()
    models.save(models.load(TRUSS), folder / "lessons" / "truss")
    lines = '{"format": "pinjoint session", "version": 1, "title": "Weights"}', TASK.format(load=load)
    (folder / "lessons" / "weights.jsonl").write_text("\n".join(lines), encoding="utf-8")
    assert main(["mods", "check", str(folder)]) == rc
    assert ("weights.jsonl line 2" in capsys.readouterr().out) == bool(rc)
    session = Session.open(TRUSS, mods=[folder])
    session.press("d")
    assert "Weights" in [tile.title for tile in session.scenes.active.form.tiles]  # type: ignore[attr-defined]
    session.type("weights")
    session.press("return")
    assert session.course is not None
    assert session.course.task.text == "Hang a weight on B."
    mods.unload(mods.MODS[-1:])
    assert "weights" not in [script.name for script in progress.shelf()]


def test_a_command_gets_its_words_and_a_failing_one_ends_with_a_reason(
    write_mod: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    opened(write_mod, "app.command('apple', lambda words: print(words) or len(words))")
    assert main(["apple", "a", "--b"]) == 2
    assert capsys.readouterr().out == "['a', '--b']\n"


def test_an_integrator_can_be_chosen(write_mod: Write) -> None:
    head = """
from pinjoint.systems.physics.integrators import VelocityVerlet
def begins(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    for d in range(2):
        a = (force[i, d] + resisting[i, d] if RATES else force[i, d]) * particles_mobility[i, d]
        if RATES:
            predicted[i, d] = velocity[i, d] + dt * a
        velocity[i, d] += 0.5 * dt * a
        displacement[i, d] += dt * velocity[i, d]
class Mine(VelocityVerlet):
    name = "apple.mine"
    begins = "apple:begins"
"""
    session = opened(write_mod, "app.integrator(Mine)", head)
    session.settings.integrator = "mine"
    session.settings.time_step = 1e-5
    session.run(steps=20)
    assert session.simulation.integrator.key == "mine"
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


@pytest.mark.parametrize(
    ("key", "said"), [("shift+j", "is the same as 'j'"), ("pgdown", "did you mean 'page down'")]
)
def test_a_key_that_no_keyboard_can_send_is_refused(write_mod: Write, key: str, said: str) -> None:
    with pytest.raises(mods.ModError, match=said):
        opened(write_mod, f"app.key({key!r}, 'toggle diagrams')")


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
from pinjoint.components import Component, Environment, Field, Rod
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


# --- kinds of elements and shapes ------------------------------------------------------------------------

GATE = """
import numpy as np
from pinjoint.components import Field, Handle, Pieces, Role
class Gate(Handle):
    table, noun, points = "gates", "gate", ("foot", "top")
    name: Field[str] = Field(title="name", doc=".", default="", dtype=str)
    foot: Field[tuple] = Field("m", shape=(2,), title="foot", doc=".")
    top: Field[tuple] = Field("m", shape=(2,), title="top", doc=".")
    swung: Field[float] = Field("rad", title="swung", doc=".", role=Role.STATE)
"""
FALLING = model(
    [particle("A", 0, 1.05)],
    [],
    environment={"acceleration": [0, -10]},
    components={"apple.Gate": [{"name": "g", "foot": [-1, 0], "top": [1, 0], "swung": 0.5}]},
)


def test_a_kind_of_a_mod_has_a_table_a_section_and_properties(write_mod: Write) -> None:
    opened(write_mod, "app.kind(Gate)", GATE)
    session = Session.open(FALLING)
    [gate] = session.table("gates")
    assert (gate.foot, gate.swung) == ((-1, 0), 0.5)
    assert models.document(session.model)["components"] == FALLING["components"]
    session.select(gate)
    session.press("return")
    assert {"foot x", "top y", "name"} <= set(session.boxes)
    mods.unload(mods.MODS[-1:])
    without = models.load(FALLING)
    assert "gates" not in without.tables
    assert models.document(without)["components"] == FALLING["components"]


def test_what_a_shape_says_is_collided_with_and_what_fails_switches_the_mod_off(write_mod: Write) -> None:
    body = "app.kind(Gate)\napp.shape(Gate, as_pieces)"
    head = GATE + "\ndef as_pieces(gates):\n    "
    lines = "ends = np.stack([gates.foot, gates.top], axis=1)\n    return Pieces(ends, np.arange(gates.count))"
    opened(write_mod, body, head + lines)
    session = Session.open(FALLING)
    session.run(time=0.5)
    assert session.impacts.time[0] == pytest.approx(0.2**0.5)
    assert session.impacts.as_csv().splitlines()[1].split(",")[1:3] == ["A", "g"]
    mods.unload(mods.MODS[-1:])


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ("raise KeyError('gone')", "the shape of gates failed: KeyError"),
        ("return 3", "the shape of gates failed: TypeError: as_pieces returned 3; it must return Pieces"),
        ("return Pieces(np.zeros((1, 2, 3)), np.zeros(1, dtype=int))", "`ends` has the shape"),
        ("return Pieces(np.full((1, 2, 2), np.nan), np.zeros(1, dtype=int))", "not finite"),
        ("return Pieces(np.zeros((1, 2, 2)), np.array([7]))", "row 7"),
        ("return Pieces(np.zeros((1, 2, 2)), np.array([0]), radius=-1.0)", "radius"),
        ("return Pieces(np.zeros((1, 2, 2)), np.array([0]), restitution=1.5)", "restitution"),
    ],
)
def test_a_shape_that_fails_switches_the_mod_off(write_mod: Write, shape: str, said: str) -> None:
    head = f"{GATE}\ndef as_pieces(gates):\n    {shape}\n"
    opened(write_mod, "app.kind(Gate)\napp.shape(Gate, as_pieces)", head)
    session = Session.open(FALLING)
    with pytest.raises(mods.ModError, match="The run stopped at t = 0 s"):
        session.run(time=0.1)
    assert said in session.message
    assert mods.MODS[-1].off
    assert models.document(session.model)["components"] == FALLING["components"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('"gates"', '"rods"'), "its table 'rods' is missing or already used"),
        (('"gates"', '"settings of mine"'), "cannot be the name of a table"),
        (('"gates"', '"execute"'), "cannot be the name of a table"),
        (('"gate",', '"rod",'), "its noun 'rod' is missing or already used"),
        (('"foot", "top"', '"foot", "tip"'), "its point 'tip' must be one of its Fields"),
        (("    name:", "    label:"), "needs a Field 'name'"),
        (("Role.STATE", "Role.DERIVED"), "cannot add derived columns"),
        (
            ("    name:", "    wide: Field[float] = Field(title='width', doc='', above=0.0)\n    name:"),
            r"Gate\.wide, its default: width is 0; it must be greater than 0\. With nullable=True",
        ),
        (
            ("    name:", "    wide: Field[float] = Field(title='width', doc='', default='x')\n    name:"),
            r"Gate\.wide, its default: width is 'x'; it must be a number\.",
        ),
        (("class Gate(Handle):", "class Gate(Handle):\n    single = True"), "a component of Settings"),
    ],
)
def test_a_kind_that_cannot_be_is_refused(write_mod: Write, change: tuple[str, str], said: str) -> None:
    from pinjoint.mods import ModError

    with pytest.raises(ModError, match=said):
        opened(write_mod, "app.kind(Gate)", GATE.replace(*change))


def test_a_tool_of_a_mod_draws_its_kind(write_mod: Write) -> None:
    opened(write_mod, "app.kind(Gate)\napp.tool(Gate, key='y', icon=[('line', (0, 0, 5, 5))])", GATE)
    session = Session.open(FALLING)
    session.point(0, 0.5)
    session.press("y")
    session.click(1, 0.5)
    assert [gate.name for gate in session.table("gates")] == ["g", "gate 1"]
    buttons = [tool.action for group in session.view.toolbar.groups for tool in group]
    assert "apple.gate" in buttons
    mods.unload(mods.MODS[-1:])
    session.update_view()
    assert "apple.gate" not in [tool.action for group in session.view.toolbar.groups for tool in group]


TOGGLED = """
done = []
@app.action("apple.toggle", key={key!r}, scenes=("pause",), title="turn it", icon={icon})
def toggle(session, pixel):
    session.model.particles["C"].force = (7.0, 0.0)
"""
CROSS = [("line", (-5.0, -5.0, 5.0, 5.0)), ("disc", (0.0, 0.0, 2.0))]


@pytest.mark.parametrize(("key", "shown"), [("y", "Y"), ("", ""), ("space", "")])
def test_an_action_with_an_icon_has_a_button_whatever_became_of_its_key(
    write_mod: Write, key: str, shown: str
) -> None:
    session = opened(write_mod, TOGGLED.format(key=key, icon=CROSS))
    session.view.camera.viewport = Viewport(0, 0, 1000, 720)
    session.update_view()
    assert session.view.toolbar.groups[-2][-1].action == "apple.toggle"
    session.view.pointer = hits_for(session, "apple.toggle")[0].middle
    toolbar, view = session.stages[-1]
    assert compose(toolbar, view, load_theme()).texts == ["Turn it", *([shown] if shown else [])]
    session.press("click", session.view.pointer)
    assert session.particles["C"].force == (7.0, 0.0)
    session.press("space")
    session.update_view()
    assert not session.view.toolbar.groups[-2][-1].enabled  # an action of pause
    mods.unload(mods.MODS[-1:])
    session.update_view()
    assert "apple.toggle" not in [tool.action for group in session.view.toolbar.groups for tool in group]


@pytest.mark.skipif(sys.version_info < (3, 12), reason="aliases of types are new in Python 3.12")
def test_aliases_of_types_are_what_they_mean() -> None:
    """numpy's NDArray is one since numpy 2.5; mods' arrays were refused."""
    alias: Any = vars(typing)["TypeAliasType"]
    item: Any = TypeVar("item")
    several = alias("several", tuple[float, ...])
    column = alias("column", np.ndarray[tuple[Any, ...], np.dtype[item]], type_params=(item,))
    check([1, 2.5], several, "places")
    check(np.ones(2), column[np.float64], "places")
    with pytest.raises(TypeError, match="places is"):
        check(["a"], several, "places")


def test_scripts_hear_of_a_mod_that_fails(write_mod: Write) -> None:
    session = opened(write_mod, 'app.action("apple.a", key="ctrl+shift+j")(lambda session, pixel: 1 / 0)')
    with pytest.raises(mods.ModError, match=r"action 'apple\.a' failed: ZeroDivisionError"):
        session.press("ctrl+shift+j")
    session.press("ctrl+shift+j")
    assert "is switched off" in session.notice


def test_scripts_hear_of_a_system_that_fails_in_a_frame(write_mod: Write) -> None:
    head = """
from pinjoint.systems.base import Phase, System
class Ends(System):
    name, phase = "apple.ends", Phase.EVENTS
    def process(self, frame):
        frame.session.particles["Z"]
"""
    session = opened(write_mod, "app.system(Ends)", head)
    with pytest.raises(mods.ModError, match=r"system 'apple\.ends' failed: KeyError"):
        session.frame(0.01)
    session.frame(0.01)


SPAN = """
from pinjoint.api import *
class Arch(Handle):
    table, noun, points = "arches", "arch", ("left", "top", "right")
    name: Field[str] = Field(dtype=str, doc=".")
    left: Field[tuple] = Field("m", shape=(2,), doc=".")
    top: Field[tuple] = Field("m", shape=(2,), doc=".")
    right: Field[tuple] = Field("m", shape=(2,), doc=".")
class Flag(Handle):
    table, noun, points = "flags", "flag", ("foot",)
    name: Field[str] = Field(dtype=str, doc=".")
    foot: Field[tuple] = Field("m", shape=(2,), doc=".")
"""
TOOLS = "app.kind(Arch)\napp.kind(Flag)\napp.tool(Arch, key='y', icon=[('line', (0, 0, 5, 5))])\napp.tool(Flag, key='z')"


def test_a_tool_draws_as_many_points_as_its_kind_has(write_mod: Write) -> None:
    session = opened(write_mod, TOOLS, SPAN)
    session.point(-1.0, 0.0)
    session.press("y")
    session.click(0.5, 1.0)
    session.point(1.0, 0.0)
    session.update_view()
    preview = session.view.preview
    assert preview is not None
    assert (preview.before, preview.start, preview.end) == (((-1.0, 0.0),), (0.5, 1.0), (1.0, 0.0))
    session.click(1.0, 0.0)
    [arch] = session.table("arches")
    assert (arch.left, arch.top, arch.right) == ((-1.0, 0.0), (0.5, 1.0), (1.0, 0.0))
    assert session.gesture is None
    session.press("y", session.point(1.005, 0.005))  # near the end of the first arch
    session.press("y", session.point(2.0, 1.0))
    session.press("y", session.point(3.0, 0.0))
    assert session.table("arches")[1].left == (1.0, 0.0)
    session.act("apple.arch", (5.0, 5.0))  # its button: the tool is taken in hand
    session.drag((-1.0, -1.0), (0.0, -0.5))
    session.type("100; -50")
    session.press("return")
    assert session.table("arches")[2].right == (1.0, -1.0)
    session.press("escape")
    session.press("ctrl+z")
    assert session.notice == "Undone: new arch"
    session.point(0.5, 0.5)
    session.press("z")
    assert session.table("flags")[0].foot == (0.5, 0.5)


def marked(session: Session, x: float, y: float) -> tuple[float, float] | None:
    """Where a ring marks that the tool in hand would begin, near a point."""
    pixel = session.point(x, y)
    session.view.pointer = pixel[0] + 3.0, pixel[1] - 3.0
    session.update_view()
    return session.view.preview and session.view.preview.start


def test_tools_of_mods_snap_to_particles_and_mark_it(write_mod: Write) -> None:
    session = opened(write_mod, TOOLS, SPAN)
    x, y = session.particles["B"].position = 1.234, 0.567
    session.act("apple.arch", (5.0, 5.0))  # taken in hand
    assert marked(session, x, y) == (x, y)
    assert marked(session, 0.5, 1.0) == (0.5, 1.0)
    near = x + 3.0 / session.view.camera.scale, y
    session.drag((-1.0, -1.0), near)
    session.click(2.0, 2.0)
    [arch] = session.table("arches")
    assert (arch.left, arch.top) == ((-1.0, -1.0), (x, y))
    session.press("escape")
    session.act("apple.flag", (5.0, 5.0))
    assert marked(session, x, y) == (x, y)
    session.click(*near)
    assert session.table("flags")[0].foot == (x, y)
    session.click(-1.0, -1.5)
    session.press("escape")
    session.drag((-1.0, -1.5), near)
    assert session.table("flags")[1].foot == (x, y)


def test_what_particles_collide_with_is_drawn_beside_them() -> None:
    session = Session.open(model([particle("ball", 0.25, 0.25, radius=0.2)], []))
    session.act("walls.wall", (5.0, 5.0))
    assert marked(session, 0.25, 0.15) not in (None, (0.25, 0.25))


@pytest.mark.parametrize(
    ("title", "code", "said"),
    [
        ("raise them", "session.particles['C'].force = (0, 5)", "raise them"),
        ("", "session.particles['C'].force = (0, 5)", "apple.lift"),
        ("raise them", "with session.model.transaction('a gust'): session.particles['C'].force = (0, 5)", "a gust"),
        (
            "raise them",
"session.particles['C'].mass = 2\n    with session.model.transaction('gust'): session.particles.mass = 3",
            "raise them",
        ),
    ],
)  # fmt: skip
def test_undo_tells_the_title_of_an_action_or_of_the_transaction_in_it(
    title: str, code: str, said: str, write_mod: Write
) -> None:
    body = f"@app.action('apple.lift', key='y', title={title!r})\ndef lift(session, pixel):\n    {code}"
    session = opened(write_mod, body)
    session.press("y")
    session.press("ctrl+z")
    assert session.notice == f"Undone: {said}"
    session.press("ctrl+y")
    assert session.notice == f"Redone: {said}"


BREAK = """
from pinjoint.api import *
class Break(System):
    name, title, phase = "apple.snap", {title!r}, Phase.EVENTS
    def process(self, frame):
        if frame.session.time > 0 and frame.session.rods.count == 2:
            frame.session.model.delete([frame.session.rods[0]])
"""


@pytest.mark.parametrize(("title", "said"), [("", "apple.snap"), ("break", "break")])
def test_undo_tells_the_title_of_a_system(title: str, said: str, write_mod: Write) -> None:
    session = opened(write_mod, "app.system(Break)", BREAK.format(title=title))
    session.run(time=0.01)
    assert session.rods.count == 1
    session.press("ctrl+z")  # what ran after it
    session.press("ctrl+z")
    assert session.notice == f"Undone: {said}"


PLAY = """
from pinjoint.api import *
class Play(Scene):
    name, heading, sources, like = "play", "Play", ("pause",), {like!r}
"""
GO = "app.scene(Play)\n@app.action('apple.play', key='y', scenes=('pause',))\ndef play(s, pixel): s.scenes.request('play')"


def test_a_scene_like_pause_has_its_keys_tools_and_clicks(write_mod: Write) -> None:
    session = opened(write_mod, GO, PLAY.format(like="pause"))
    session.press("y")
    session.frame(0.01)
    assert session.scene == "play"
    session.click(0.5, 1.0)
    assert session.selected == [session.particles["C"]]
    session.drag((0.5, 1.0), (0.6, 1.0))
    assert session.particles["C"].position == (0.6, 1.0)
    session.point(2.0, 2.0)
    session.press("p")
    assert session.particles.count == 4
    session.update_view()
    assert any(
        tool.enabled for group in session.view.toolbar.groups for tool in group if tool.action == "support"
    )
    assert "edit.hover" not in session.plan("play").left_out
    session.press("return")
    session.frame(0.01)
    assert session.scene == "properties"


def test_a_scene_like_simulation_lets_time_pass(write_mod: Write) -> None:
    session = opened(write_mod, GO, PLAY.format(like="simulation"))
    session.press("y")
    for _ in range(3):
        session.frame(0.01)
    assert session.time > 0.0
    session.press("space")
    session.frame(0.01)
    assert session.scene == "pause"


def test_a_scene_is_like_one_of_ours(write_mod: Write) -> None:
    with pytest.raises(
        mods.ModError, match=r"Play\.like: There is no 'paus' among the scenes; did you mean 'pause'"
    ):
        opened(write_mod, GO, PLAY.format(like="paus"))


def test_a_layer_gets_the_session(write_mod: Write) -> None:
    head = """
from pinjoint.api import *
def draw(sheet):
    yield Text(sheet.session.scene, 300.0, 300.0, sheet.font(12.0), sheet.theme.text)
"""
    session = opened(write_mod, "app.layer(draw)", head)
    texts = [
        mark.text for mark in compose(session.model, session.view, load_theme()).marks if isinstance(mark, Text)
    ]
    assert "pause" in texts, mods.FAULTS
