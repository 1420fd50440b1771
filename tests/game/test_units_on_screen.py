"""Units on screen: all that is said follows them, what is typed without a unit is in them, and files stay as they are."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.commands.arguments import UsageError
from pinjoint.commands.command_line import main
from pinjoint.commands.language import speak_as_asked
from pinjoint.components.field import FieldError
from pinjoint.components.form import Form
from pinjoint.components.units import PRESETS, USUAL, show_in, shown_in, units_on_screen
from pinjoint.documents import preferences
from pinjoint.documents.document import document
from pinjoint.documents.models import load
from pinjoint.editor.scenes.form import FormScene
from pinjoint.scripts.playing import play
from pinjoint.scripts.script import Script
from pinjoint.systems.render.marks import Text
from tests.golden.scenes import composed


@pytest.fixture(autouse=True)
def usual() -> Iterator[None]:
    """Other tests are to find the usual units."""
    yield
    show_in(USUAL)


def statics(name: str = "portal") -> Session:
    session = Session.open(name)
    session.press("q")
    return session


def form_of(session: Session) -> Form:
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    return scene.form


def texts(session: Session) -> set[str]:
    session.frame(0.0)
    return {mark.text for picture in composed(session) for mark in picture.marks if isinstance(mark, Text)}


def test_presets_say_all_in_their_units() -> None:
    session = statics()
    session.select(session.rods["BC"])
    session.press("return")
    for units, wanted in (
        (USUAL, {"length": "600.0 cm", "axial force": "−32.40 kN", "largest displacement": "1.435 cm (BC)"}),
        ("m kN mm", {"length": "6.000 m", "axial force": "−32.40 kN", "largest displacement": "14.35 mm (BC)"}),
        ("N mm", {"length": "6000 mm", "axial force": "−32403 N", "largest displacement": "14.35 mm (BC)"}),
    ):
        show_in(units)
        session.press("escape")
        session.press("return")
        session.update_view()
        session.frame(0.0)
        readings = {one.title: one.text for one in form_of(session).readings}
        assert {title: readings[title] for title in wanted} == wanted


def test_pictures_and_legend_follow() -> None:
    session = statics()
    show_in("m, N, N·m, N/m")
    seen = texts(session)
    assert {"M on the tension side (N·m)", "load (N, N/m)", "20000 N/m"} <= seen
    assert any(text.endswith(" N·m") for text in seen)
    assert not any("kN" in text for text in seen)


def test_some_units_and_digits_are_chosen_one_by_one() -> None:
    show_in("mm displacement, MN, 6 digits")
    session = statics()
    assert session.model.particles.kind.displacement.on_screen == ("mm", 1000.0)
    assert session.model.particles.kind.position.on_screen == ("cm", 100.0)
    assert "0.0324032 MN" in texts(session)


@pytest.mark.parametrize("text", ["apples", "kN displacement", "12 digits", "m, s"])
def test_what_is_no_unit_is_refused_and_changes_nothing(text: str) -> None:
    with pytest.raises(FieldError, match="is no unit on screen"):
        show_in(text)
    assert units_on_screen() == USUAL


def test_what_is_typed_without_a_unit_is_in_that_on_screen() -> None:
    session = statics()
    show_in("N mm")
    session.select(session.rods["BC"])
    session.press("return")
    session.click_box("rest length")
    box = form_of(session).selected
    assert box is not None
    assert (box.unit, box.text) == ("mm", "6000")
    session.type("6100")
    session.press("return")
    assert session.rods["BC"].rest_length == 6.1
    session.click_box("distributed force y")
    session.type("-12 kN/m")
    session.press("return")
    assert session.rods["BC"].distributed_force == (0.0, -12.0)
    session.press("escape")
    session.press("f", session.point(*session.particles["C"].position))
    session.type("-1500")
    session.press("return")
    assert session.particles["C"].force == (0.0, -1.5)


def test_limits_are_told_in_the_unit_on_screen() -> None:
    session = statics()
    show_in("m kN mm")
    session.select(session.particles["B"])
    session.press("return")
    session.click_box("radius")
    session.type("-1")
    box = form_of(session).selected
    assert box is not None
    assert box.problem == "must be greater than 0 m"


def test_files_stay_as_they_are(tmp_path: Path) -> None:
    before = document(load("portal"))
    show_in("N mm")
    session = Session.open("portal")
    session.save(tmp_path / "portal.json")
    assert document(load(tmp_path / "portal.json"))["rods"] == before["rods"]


def test_a_key_goes_through_the_presets() -> None:
    session = statics()
    for name in (*list(PRESETS)[1:], USUAL):
        session.press("shift+f2")
        assert units_on_screen() == name
        assert name in session.notice


def test_the_table_and_its_csv_name_the_units() -> None:
    show_in("N mm")
    session = statics()
    head, *rows = session.lister.tables["rods"].rows()
    assert "N start (N)" in head
    assert rows[1][1] == pytest.approx(1000.0 * session.rods["BC"].end_axial_force[0])


def test_results_of_commands_keep_the_units_of_the_contract(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PINJOINT_UNITS", "")
    found = []
    for words in (["run"], ["run", "--units", "N mm"]):
        assert main(speak_as_asked([*words, "portal", "--static", "--format", "csv"])) == 0
        found.append(capsys.readouterr().out)
    assert units_on_screen() == "N mm"
    assert found[0] == found[1]


def test_units_that_there_are_not_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PINJOINT_UNITS", "miles")
    with pytest.raises(UsageError, match="PINJOINT_UNITS miles: “miles” is no unit on screen"):
        speak_as_asked(["run"])


def test_a_script_is_played_in_its_own_units(tmp_path: Path) -> None:
    show_in("N mm")
    lines = (
        '{"format": "pinjoint session", "version": 1, "model": "isostatic"%s}\n'
        '{"action": "environment"}\n{"box": "force y"}\n{"type": "-2"}\n{"press": "return"}\n'
        '{"expect": "environment.force.y = %s"}\n'
    )
    for number, values in enumerate((("", "-2"), (', "units": "N mm"', "-0.002"))):
        path = tmp_path / f"{number}.jsonl"
        path.write_text(lines % values)
        assert play(Script(path)) == []
    assert units_on_screen() == "N mm"


def test_units_hold_for_a_while() -> None:
    with shown_in("m kN mm"):
        assert units_on_screen() == "m kN mm"
    assert units_on_screen() == USUAL


def test_the_methods_of_courses_keep_one_set_of_units() -> None:
    session = Session.open("hyperstatic")
    show_in("N mm")
    session.press("k")
    assert units_on_screen() == USUAL
    assert any("kN" in text for text in texts(session))
    session.press("escape")
    assert units_on_screen() == "N mm"


def test_single_units_and_decimals_are_chosen_in_a_list() -> None:
    """By the mouse or by keys; what is chosen replaces what was of its kind, and a preset all."""
    session = Session.open("isostatic")
    deeds = {
        "forces: N": "N",
        "lengths: m": "N, m",
        "digits: 3": "N, m, 3 digits",
        "forces: MN": "m, 3 digits, MN",
        "moduli of elasticity: MPa": "m, 3 digits, MN, MPa GPa",
        "stresses: kN/cm²": "m, 3 digits, MN, MPa GPa, kN/cm² MPa",
        "rotational springs: N·mm/rad": "m, 3 digits, MN, MPa GPa, kN/cm² MPa, N·mm/rad",
    }
    for chosen, says in (deeds | {"all: N mm": "N mm"}).items():
        session.press("ctrl+f2")
        menu = session.view.menu
        assert menu is not None
        number = [entry.title for entry in menu.entries].index(chosen)
        for _ in range(number + 1):
            session.press("down")
        session.press("return")
        assert units_on_screen() == says
    show_in("m, N, 3 digits")
    session.press("ctrl+f2")
    pressed = [entry.title for entry in session.view.menu.entries if entry.pressed]
    assert pressed[:3] == ["lengths: m", "displacements: m", "forces: N"]
    assert pressed[-1] == "digits: 3"
    session.press("escape")
    assert session.view.menu is None


def test_single_units_are_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(preferences.CONFIG_VARIABLE, str(tmp_path))
    for kept, read in (("m, N, 3 digits", "m, N, 3 digits"), ("m, quarks", USUAL), (3, USUAL)):
        preferences.remember("units", kept)
        assert preferences.preferred("units") == read
