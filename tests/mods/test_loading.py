"""Which mods are loaded, in which order, and what is said of the others. Nothing of these stays loaded."""

import io
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from pinjoint import Session, mods
from pinjoint.commands.command_line import main
from pinjoint.components import Particle
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.mods.loading import folder_of
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.physics.integrators import VelocityVerlet
from pinjoint.systems.program.compiler import Choice
from tests.mods.conftest import Write

BALL = {"format": "pinjoint model", "version": 1, "particles": [{"name": "A", "position": [0, 0]}]}
SAIL = """
    from pinjoint.components import Component, Field, Particle

    class Sail(Component):
        of = Particle
        area: Field[float] = Field("m²", title="sail area", doc="Of the sail.", minimum=0.0)

    def plugin(app):
        app.component(Sail)
"""


def load(tmp_path: Path) -> dict[str, mods.Mod]:
    return {mod.name: mod for mod in mods.load([tmp_path / "mods"])}


# --- order -------------------------------------------------------------------------------------------------


def test_a_mod_is_loaded_after_those_it_requires_else_by_name(tmp_path: Path, write_mod: Write) -> None:
    note = "from pinjoint.mods import FAULTS\ndef plugin(app): FAULTS.append(app.name)"
    write_mod("apple", note, 'requires = ["pear>=1", "pinjoint>=0.1"]')
    for name in ("plum", "pear", "fig"):
        write_mod(name, note)
    load(tmp_path)
    assert mods.FAULTS == ["fig", "pear", "apple", "plum"]


def test_a_missing_requirement_is_named(tmp_path: Path, write_mod: Write) -> None:
    write_mod("apple", manifest='requires = ["pear"]')
    assert "'pear', which is not installed" in load(tmp_path)["apple"].problem


@pytest.mark.parametrize("requirement", ["pinjoint>=99", "pear>=2,<3"])
def test_a_wrong_version_is_named(tmp_path: Path, write_mod: Write, requirement: str) -> None:
    write_mod("apple", manifest=f'requires = ["{requirement}"]')
    write_mod("pear")
    found = load(tmp_path)
    name, _, version = requirement.partition(">=")
    assert f"It requires {name} " in found["apple"].problem
    assert version.partition(",")[0] in found["apple"].problem
    assert not found["pear"].problem


def test_mods_that_require_each_other_are_named_and_others_go_on(tmp_path: Path, write_mod: Write) -> None:
    write_mod("apple", manifest='requires = ["pear"]')
    write_mod("pear", manifest='requires = ["plum"]')
    write_mod("plum", manifest='requires = ["apple"]')
    write_mod("quince", manifest='requires = ["plum"]')
    write_mod("fig")
    found = load(tmp_path)
    for name in ("apple", "pear", "plum"):
        assert all(other in found[name].problem for other in ("apple", "pear", "plum"))
        assert "require each other" in found[name].problem
    assert "'plum', which cannot be used" in found["quince"].problem
    assert not found["fig"].problem


def test_of_two_mods_of_one_name_the_first_found_is_used(tmp_path: Path, write_mod: Write) -> None:
    first = write_mod("apple")
    other = tmp_path / "other" / "apple"
    other.parent.mkdir()
    first.rename(other)
    second = write_mod("apple")
    found = mods.load([second, other])
    assert [mod.off for mod in found] == [False, True]
    assert str(second) in found[1].problem


def test_what_requires_a_mod_that_fails_is_left_out(tmp_path: Path, write_mod: Write) -> None:
    write_mod("apple", manifest='requires = ["pear"]')
    write_mod("pear", "def plugin(app): 1 / 0")
    found = load(tmp_path)
    assert "ZeroDivisionError" in found["pear"].problem
    assert "'pear', which cannot be used" in found["apple"].problem


# --- wrong mods ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("def plugin(app:\n    pass", "SyntaxError", ),
        ("import no_such_package\ndef plugin(app): pass", "no_such_package"),
        ("x = 1", "no function plugin"),
        ("plugin = 3", "no function plugin"),
        ("def plugin(): pass", "must take one argument"),
        ("def plugin(app):\n    raise RuntimeError('no luck')", "no luck (apple/__init__.py, line 2)"),
        ("def plugin(app): app.component(3)", "apple/__init__.py, line 1"),
        ("def plugin(app): app.action('toggle')(print)", "'apple.toggle'"),
        ("def plugin(app): app.command('run', print)", "command 'run' already"),
        ("def plugin(app): app.models('nowhere')", "no folder of models nowhere"),
        (
            "from pinjoint.editor.scenes import Scene\nclass P(Scene):\n    name = 'pause'\n"
            "def plugin(app): app.scene(P)",
            "a scene 'pause' already",
        ),
        (
            "from pinjoint.systems.base import System\nclass A(System):\n    name = 'apple.a'\n"
            "def plugin(app):\n    app.system(A)\n    app.system(A)",
            "Two systems are called apple.a",
        ),
        (
            "from pinjoint.components import Component, Field, Particle\nclass C(Component):\n    of = Particle\n"
            "    x: Field[float] = Field(title='x', doc='')\n"
            "class D(C):\n    pass\ndef plugin(app):\n    app.component(C)\n    app.component(D)",
            "'apple_x' already",
        ),
    ],
)  # fmt: skip
def test_a_wrong_mod_is_left_out_with_its_reason(
    tmp_path: Path, write_mod: Write, code: str, said: str
) -> None:
    write_mod("apple", code)
    write_mod("pear", SAIL)
    columns = set(vars(Particle))
    found = load(tmp_path)
    assert said in found["apple"].problem
    assert not found["pear"].problem
    assert set(vars(Particle)) - columns == {"pear_area"}


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("requires = 3", "requires is 3"),
        ('requires = ["a b c"]', "'a b c'"),
        ('author = "me"', "the key 'author'"),
        ("description = 1", "description is 1"),
        ("description = ", "not TOML"),
        ("description = " + "[" * 10_000, "nested too deeply"),
    ],
)
def test_a_wrong_manifest_is_named(tmp_path: Path, write_mod: Write, line: str, said: str) -> None:
    write_mod("apple", manifest=line)
    assert said in load(tmp_path)["apple"].problem


@pytest.mark.parametrize("version", ["", "new"])
def test_a_version_is_needed(tmp_path: Path, write_mod: Write, version: str) -> None:
    write_mod("apple", version=version)
    assert "version" in load(tmp_path)["apple"].problem


@pytest.mark.parametrize("name", ["my mod", "class", "a__b"])
def test_a_name_that_python_cannot_use_is_refused(tmp_path: Path, write_mod: Write, name: str) -> None:
    write_mod(name)
    assert "must be a Python name" in load(tmp_path)[name].problem


def test_a_folder_without_a_manifest_is_told_of(tmp_path: Path, write_mod: Write) -> None:
    (write_mod("apple") / "mod.toml").unlink()
    assert "mod.toml cannot be read" in load(tmp_path)["apple"].problem


def test_of_a_plugin_that_raises_nothing_stays(tmp_path: Path, write_mod: Write) -> None:
    write_mod(
        "apple",
        """
        from pinjoint.components import Component, Field, Particle, HistoryKind
        from pinjoint.editor.scenes import Scene

        class Sail(Component):
            of = Particle
            area: Field[float] = Field("m²", title="area", doc="")

        class Show(Scene):
            name = "show"

        def plugin(app):
            app.component(Sail)
            app.scene(Show)
            app.history(HistoryKind("apple", {}, "pinjoint.systems.loads.kernels:constant", 1.0, lambda h: 0.0))
            app.action("apple.a", key="ctrl+shift+f12")(lambda session, pixel: None)
            app.command("apple", lambda words: 0)
            raise RuntimeError("at last")
        """,
    )
    before = dict(ACTIONS), set(EXTENSIONS.commands), set(vars(Particle))
    assert "at last" in load(tmp_path)["apple"].problem
    assert (dict(ACTIONS), set(EXTENSIONS.commands), set(vars(Particle))) == before
    session = Session.open(BALL)
    with pytest.raises(KeyError):
        session.scenes["show"]


# --- keys ------------------------------------------------------------------------------------------------------

FREE = "ctrl+shift+j"
KEY = "def plugin(app): app.action('{0}.a', key='{1}', scenes=('pause',))(lambda s, p: None)"


def test_a_key_that_is_taken_stays_and_that_is_reported(tmp_path: Path, write_mod: Write) -> None:
    write_mod("apple", KEY.format("apple", "s"))
    write_mod("pear", KEY.format("pear", FREE))
    write_mod("plum", KEY.format("plum", FREE))
    found = load(tmp_path)
    assert ACTIONS.name_at("pause", "s") == "save"
    assert ACTIONS.name_at("pause", FREE) == "pear.a"
    assert "already does 'save' in pause" in found["apple"].notes[0]
    assert "already does 'pear.a'" in found["plum"].notes[0]
    assert not any(mod.off for mod in found.values())


def test_the_key_that_a_person_chose_is_kept(tmp_path: Path, write_mod: Write) -> None:
    (tmp_path / "config").mkdir()
    choice = '{"keys": {"pause": {"ctrl+shift+j": "plum.a"}}}'
    (tmp_path / "config" / "settings.json").write_text(choice, encoding="utf-8")
    write_mod("pear", KEY.format("pear", FREE))
    write_mod("plum", KEY.format("plum", FREE))
    load(tmp_path)
    assert ACTIONS.name_at("pause", FREE) == "plum.a"
    assert ACTIONS.name_at("simulation", FREE) is None


# --- components ----------------------------------------------------------------------------------------------------


def test_a_component_is_in_python_files_properties_and_results(tmp_path: Path, write_mod: Write) -> None:
    session = Session.open(BALL, mods=[write_mod("pear", SAIL)])
    ball = session.particles["A"]
    ball.pear_area = 2.5  # type: ignore[attr-defined]
    assert session.particles.pear_area.tolist() == [2.5]
    session.save(tmp_path / "ball.json")
    assert '"components": {"pear.Sail": {"area": 2.5}}' in (tmp_path / "ball.json").read_text(encoding="utf-8")
    assert Session.open(tmp_path / "ball.json").particles.pear_area.tolist() == [2.5]
    session.select(ball)
    session.act("properties")
    session.click_box("sail area")
    session.type("4")
    session.press("return")
    session.press("escape")
    assert ball.pear_area == 4.0  # type: ignore[attr-defined]
    session.undo()
    assert ball.pear_area == 2.5  # type: ignore[attr-defined]


def test_a_model_with_a_mods_data_opens_without_the_mod_and_is_saved_unchanged(
    tmp_path: Path, write_mod: Write
) -> None:
    session = Session.open(BALL, mods=[write_mod("pear", SAIL)])
    session.particles["A"].pear_area = 2.5  # type: ignore[attr-defined]
    session.save(tmp_path / "with.json")
    mods.unload(mods.MODS[-1:])
    without = Session.open(tmp_path / "with.json")
    assert "mods that are not loaded: pear" in without.message
    without.save(tmp_path / "without.json")
    assert (tmp_path / "with.json").read_bytes() == (tmp_path / "without.json").read_bytes()


def test_a_key_that_a_component_does_not_have_is_refused(write_mod: Write) -> None:
    Session.open(BALL, mods=[write_mod("pear", SAIL)])
    wrong = {"name": "A", "position": [0, 0], "components": {"pear.Sail": {"aera": 1.0}}}
    with pytest.raises(ValueError, match=r"particles\[0\].components.*pear.Sail.*'aera'.*did you mean 'area'"):
        Session.open({**BALL, "particles": [wrong]})
    wrong["components"] = {"pear.Sial": {}}
    with pytest.raises(ValueError, match=r"the mod 'pear' has no 'pear.Sial' here; did you mean 'pear.Sail'"):
        Session.open({**BALL, "particles": [wrong]})


# --- the command line ------------------------------------------------------------------------------------------------


def test_a_new_mod_works_at_the_first_try(
    tmp_path: Path, unloaded: None, compiling: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Choice, "proved", ("",))  # the kernel is compiled, to be checked; no program
    assert main(["mods", "new", "gust", "--into", str(tmp_path)]) == 0
    assert main(["mods", "check", str(tmp_path / "gust")]) == 0
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "gust"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


KERNEL = """
from pinjoint.components import HistoryKind
from numba import njit
from pinjoint.systems.base import Law
from pinjoint.systems.physics.integrators import VelocityVerlet

@njit
def pull({parameter}):
    return {result}

class Pull(Law):
    name = "apple.pull"
    each = "particles"
    kernel = pull
    reads = ("particles.position",)

class Mine(VelocityVerlet):
    name = "apple.mine"
    ends = "{ends}"

def plugin(app):
    app.system(Pull)
    app.integrator(Mine)
    app.history(HistoryKind("apple", {{}}, "{factor}", static=1.0, ends=lambda history: 0.0))

    @app.action("apple.eat", key="q", scenes=("{scene}",), title="eat")
    def eat(session, pixel):
        pass
"""
RIGHT = {
    "parameter": "particles_position",
    "result": "0.0, 0.0",
    "ends": VelocityVerlet.ends,
    "factor": "pinjoint.systems.loads.kernels:constant",
    "scene": "pause",
}


@pytest.mark.usefixtures("compiling")
@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, "apple 1.0: no problems"),
        ({"parameter": "particles_positon"}, "has a parameter 'particles_positon', but there is no column"),
        ({"parameter": "particles_mass"}, "does not declare that it reads 'particles.mass'"),
        ({"result": "0.0"}, "it must return a pair, the force (fx, fy) in kN"),
        ({"result": "nothing"}, "The kernel of apple.pull does not compile"),
        ({"ends": "apple:nothing"}, "The kernel 'apple:nothing' of apple.mine cannot be found"),
        ({"factor": "apple:nothing"}, "The kernel 'apple:nothing' of loads.apple cannot be found"),
        (
            {"scene": "paus"},
            "The key 'q' for apple.eat: There is no 'paus' among the scenes; did you mean 'pause'",
        ),
    ],
)
def test_a_check_finds_what_no_model_could_be_run_with(
    change: dict[str, str], said: str, write_mod: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_mod("apple", KERNEL.format(**{**RIGHT, **change}))
    assert main(["mods", "check", str(folder)]) == (1 if change else 0)
    assert said in capsys.readouterr().out


def test_mods_are_listed_checked_and_left_out(
    tmp_path: Path, write_mod: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    write_mod("apple", "def plugin(app): 1 / 0")
    write_mod("pear", SAIL)
    folder = str(tmp_path / "mods")
    assert main(["mods", "list", "--mods", folder]) == 1
    out = capsys.readouterr().out
    assert "apple 1.0: LEFT OUT" in out
    assert "ZeroDivisionError: division by zero (apple/__init__.py, line 1)" in out
    assert "pear 1.0: loaded" in out
    assert main(["mods", "new", "my mod"]) == 2
    assert main(["mods", "check", str(tmp_path)]) == 2


def test_bundled_examples_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert folder_of("wind").name == "wind"
    assert (folder_of("wind") / "mod.toml").is_file()
    (tmp_path / "wind").mkdir()
    assert folder_of("wind") == Path("wind"), "a folder of one's own goes first"
    assert main(["run", "pendulum", "--mods", "wnid"]) == 2
    assert "--mods wnid: there is no such folder" in capsys.readouterr().err


def test_a_persons_own_mods_are_loaded_unless_they_are_left_out(
    tmp_path: Path, write_mod: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    write_mod("pear", SAIL)
    (tmp_path / "data").mkdir()
    (tmp_path / "mods").rename(tmp_path / "data" / "mods")
    main(["mods", "list", "--no-mods"])
    assert "pear" not in capsys.readouterr().out.replace(str(tmp_path), "")
    main(["mods", "list"])
    assert "pear 1.0: loaded" in capsys.readouterr().out


def test_installed_packages_bring_mods(
    tmp_path: Path, write_mod: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_mod("pear", SAIL)
    info = tmp_path / "mods" / "pear-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: pear\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text("[pinjoint.mods]\npear = pear\nfig = fig:plugin\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path / "mods"))
    found = {mod.name: mod for mod in mods.load(installed=True)}
    assert not found["pear"].problem
    assert "There is no module 'fig'" in found["fig"].problem


def test_a_name_that_python_reads_as_another_one_is_refused(write_mod: Write) -> None:
    """The micro sign: attributes and parameters of that name have the Greek letter."""
    (found,) = mods.load([write_mod("\N{MICRO SIGN}m")])
    assert "must be a Python name" in found.problem


def test_a_mod_that_closes_standard_output_is_left_out_and_what_others_write_arrives(
    write_mod: Write, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = write_mod("apple", "import sys\ndef plugin(app):\n    sys.stdout.close()\n")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sys, "stdout", io.StringIO())
        (mod,) = mods.load([folder])
        assert mod.problem == "It closed sys.stdout, which the program needs; leave it open."
        print("arrives", flush=True)
    assert capfd.readouterr().out == "arrives\n"


def test_a_mod_is_unloaded_by_its_name_with_those_that_require_it(write_mod: Write) -> None:
    folders = [write_mod("pear", SAIL), write_mod("plum", manifest='requires = ["pear"]')]
    session = Session.open("pendulum", mods=folders)
    mods.unload(["pear"])
    assert not {"pear", "plum"} & {mod.name for mod in mods.MODS}
    session.run(time=0.1)  # goes on without them
    with pytest.raises(mods.ModError, match="There is no 'paer' among the mods"):
        mods.unload(["paer"])


def test_a_mod_that_failed_can_be_loaded_again(write_mod: Write) -> None:
    folder = write_mod("pear", "def plugin(app): 1 / 0")
    user = write_mod("plum", manifest='requires = ["pear"]')
    for _ in range(2):
        with pytest.raises(mods.ModError, match="ZeroDivisionError"):
            Session.open("pendulum", mods=[folder])
    (folder / "__init__.py").write_text(textwrap.dedent(SAIL), encoding="utf-8")
    Session.open("pendulum", mods=[folder, user])
    mods.MODS[-1].switch_off("It failed.")
    Session.open("pendulum", mods=[folder, user])
    assert [mod.problem for mod in mods.MODS if mod.name in ("pear", "plum")] == ["", ""]
