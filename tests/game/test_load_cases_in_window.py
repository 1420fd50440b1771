"""Load cases and combinations in the window, by keys and the mouse."""

import json
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.bent import Station
from pinjoint.components.cases import acting, choices
from pinjoint.components.language import spoken
from pinjoint.components.tags import Hovered
from pinjoint.components.view import Pin
from pinjoint.documents.document import document, parse
from pinjoint.editor.scenes.properties import Properties
from pinjoint.sheet import Solved, contents
from pinjoint.systems.render.backends.paper import LAYOUTS
from pinjoint.systems.render.picture import compose, hits_at
from pinjoint.systems.render.theme import load_theme
from tests.game.test_frames_by_mouse import opened
from tests.game.test_influence import three_spans
from tests.game.test_sheet import figures_of

Document = dict[str, Any]


def beam(**settings: Any) -> Document:
    """Three spans of 4 m: a load of its own that grows, snow, and a support that settles."""
    made: Document = three_spans()
    made["span_loads"] = [
        {"rod": "BC", "start_intensity": [0.0, -2.0], "end_intensity": [0.0, -6.0]},
        {"rod": "AB", "start": 2.0, "force": [0.0, -10.0], "case": "snow"},
    ]
    made["loads"] = [{"on": "B", "settlement": [0.0, -0.01], "case": "settling"}]
    ULS = {"permanent": 1.35, "snow": 1.5}
    return made | {"settings": {"combinations": {"ULS": ULS, "all": {**ULS, "settling": 1.0}}} | settings}


def in_statics(source: Document) -> Session:
    session = opened(source)
    session.press("q")
    session.frame(0.0)
    return session


def texts(session: Session) -> list[str]:
    session.frame(0.0)
    return compose(session.model, session.view, load_theme(session.view.theme)).texts


def titles(session: Session) -> list[str]:
    return [tool.title for tool in session.view.sliders.choices]


def choose(session: Session, title: str) -> None:
    """Click the choice of that title."""
    session.frame(0.0)
    number, theme = titles(session).index(title), load_theme(session.view.theme)
    place = session.view.choices_place
    for x in range(int(place.left), int(place.right), 4):
        hits = hits_at(session.model, session.view, theme, (x, place.middle[1]))
        if any(hit.item == number and hit.action for hit in hits):
            session.press("click", (x, place.middle[1]))
            return
    raise AssertionError(f"{title} is not in sight")


def test_one_click_shows_a_combination_or_a_case_and_the_legend_says_which() -> None:
    session = in_statics(beam())
    assert titles(session)[:-2] == [
        "All cases × 1",
        "ULS",
        "all",
        "Case permanent",
        "Case settling",
        "Case snow",
    ]
    shown = {}
    for title in titles(session)[:-2]:
        choose(session, title)
        shown[title] = texts(session)
    assert "all cases × 1" in shown["All cases × 1"]
    assert "ULS: 1.35 permanent + 1.5 snow" in shown["ULS"]
    assert "case snow" in shown["Case snow"]
    assert "8.1 kN/m" in shown["ULS"]
    assert "10 kN" in shown["Case snow"]
    assert not any(text.endswith("kN/m") for text in shown["Case snow"])
    session.undo()
    assert session.settings.combination == "settling"


def test_snow_alone_by_three_moments() -> None:
    """10 kN in the middle of the first of three spans of 4 m: M_B = −4 kN·m, M_C = 1 kN·m, so 8 kN·m below it."""
    session = in_statics(beam(combination="snow"))
    assert {"8.000 kN·m", "4.000 kN·m", "1.000 kN·m"} <= set(texts(session))


def test_keys_go_through_what_acts() -> None:
    session = in_statics(beam())
    seen = []
    for _ in choices(session.model):
        session.press("ctrl+g")
        seen.append(session.settings.combination)
    assert seen == ["ULS", "all", "permanent", "settling", "snow", "snow"]
    assert session.view.envelope
    session.press("ctrl+g")
    assert (session.settings.combination, session.view.envelope) == ("", False)
    session = in_statics(three_spans())
    assert titles(session) == []
    session.press("ctrl+g")
    assert session.notice.startswith("There is one load case only.")


def test_a_table_of_combinations_is_typed_and_taken_back() -> None:
    session = in_statics(beam(combinations={}))
    session.act("edit combinations")
    session.type("ULS 1")
    session.press("return")
    assert dict(session.settings.combinations["ULS 1"]) == {"permanent": 1.0, "settling": 1.0, "snow": 1.0}
    for case, factor in (("permanent", "1.35"), ("snow", "1.5"), ("settling", "0")):
        session.click_box(case)
        session.type(factor)
        session.press("return")
    assert dict(session.settings.combinations["ULS 1"]) == {"permanent": 1.35, "settling": 0.0, "snow": 1.5}
    session.click_box("new combination")
    session.type("ULS 1")
    session.press("return")
    assert "there is a combination 'ULS 1' already" in session.scenes.active.message
    session.type("SLS")
    session.press("return")
    assert list(session.settings.combinations) == ["ULS 1", "SLS"]
    session.click_box("combination")
    session.type("ULS")
    session.press("return")
    assert list(session.settings.combinations) == ["ULS", "SLS"]
    session.click_box("combination")
    scene = session.scenes.active
    assert isinstance(scene, Properties)
    scene.choose_word(session, 0)  # of its list: remove it
    assert list(session.settings.combinations) == ["SLS"]
    session.press("escape")
    session.press("escape")
    session.undo()
    assert not session.settings.combinations


def test_the_combination_that_acts_acts_on_under_a_new_name() -> None:
    session = in_statics(beam(combination="ULS"))
    session.act("edit combinations")
    session.click_box("combination")
    session.type("limit")
    session.press("return")
    assert session.settings.combination == "limit"
    session.press("escape")
    session.press("escape")
    session.undo()
    assert (session.settings.combination, list(session.settings.combinations)) == ("ULS", ["ULS", "all"])
    session.act("edit combinations")
    session.click_box("combination")
    scene = session.scenes.active
    assert isinstance(scene, Properties)
    scene.choose_word(session, 0)  # remove it
    assert session.settings.combination == ""


def test_own_loads_become_loads_of_a_case_by_their_box() -> None:
    source = three_spans()
    source["particles"][1]["force"] = [3.0, -5.0]  # type: ignore[index]
    source["rods"][1]["distributed_force"] = [0.0, -2.0]  # type: ignore[index]
    session = opened(source)
    for element in (session.particles["B"], session.rods["BC"]):
        session.select(element)
        session.press("return")
        session.click_box("case")
        session.type("wind")
        session.press("return")
        session.press("escape")
        session.press("escape")
    [load], [spread] = session.loads, session.span_loads
    assert (load.case, load.force, session.particles["B"].force) == ("wind", (3.0, -5.0), (0.0, 0.0))
    assert (spread.case, spread.start_intensity, spread.end) == ("wind", (0.0, -2.0), None)
    assert session.rods["BC"].distributed_force == (0.0, 0.0)
    session.undo()
    assert session.rods["BC"].distributed_force == (0.0, -2.0)


def test_what_is_drawn_while_a_case_acts_alone_is_of_that_case() -> None:
    session = in_statics(beam(combination="snow"))
    x, y = session.point(4.0, 0.0)
    for points in (60.0, 80.0):  # drawn again it is another force, no second load
        session.press("f", (x, y))
        session.press("f", (x, y + points))
    [load] = [load for load in session.loads if load.case == "snow"]
    assert load.force[1] < 0.0
    assert session.particles["B"].force == (0.0, 0.0)
    session.press("ctrl+f", session.point(9.0, 0.0))
    x, y = session.point(9.0, 0.0)
    session.press("click", (x, y + 60.0))
    assert session.span_loads[-1].case == "snow"


@pytest.mark.parametrize("combination", ["ULS", "snow", ""])
def test_files_hold_what_acts(combination: str) -> None:
    made = document(parse(beam(combination=combination)))
    assert made["settings"].get("combination", "") == combination
    assert acting(parse(made)) == acting(parse(beam(combination=combination)))


def test_in_portuguese() -> None:
    with spoken("pt"):
        session = in_statics(beam(combination="ULS"))
        assert "ULS: 1,35 permanente + 1,5 snow" in texts(session)
        assert titles(session)[0] == "Todos os casos × 1"


# --- envelopes -------------------------------------------------------------------------------------------


def test_the_window_draws_the_envelope_with_what_governs() -> None:
    """Three spans, ULS and with a support that settles by 1 cm: numbers by three moments, read from the picture."""
    session = in_statics(beam())
    choose(session, "Envelope")
    shown = texts(session)
    assert "envelope of ULS and all" in shown
    assert {"18.96 kN·m (all)", "10.08 kN·m (ULS)", "15.06 kN·m (all)"} <= set(shown)
    assert {"y: 9.480 kN (all) … 4.980 kN (ULS)", "y: 9.480 kN … 4.980 kN"} & set(shown)
    session.press("i")
    assert "−18.34 kN (all)" in texts(session)
    session.press("ctrl+g")
    assert "all cases × 1" in texts(session)
    for _ in choices(session.model):
        session.press("ctrl+g")
    assert "envelope of ULS and all" in texts(session)


def test_numbers_at_places_are_those_of_the_envelope() -> None:
    """Hand: M_B = −15.06 kN·m; 1 m beside it is what both combinations do there, each by three moments."""
    session = in_statics(beam())
    session.select(session.rods["AB"])
    expected = {}
    for name in ("ULS", "all"):
        choose(session, name)
        expected[name] = Station.of(session.model, 0, 3.0).forces
    choose(session, "Envelope")
    session.view.pin = Pin(session.rods["AB"], 3.0)
    session.frame(0.0)
    assert session.view.pin.told is not None
    rows = dict(session.view.pin.told.rows)
    for letter in "NVM":
        values = sorted((of[letter], name) for name, of in expected.items())
        if abs(values[0][0] - values[1][0]) < 1e-9:
            assert rows[f"{letter} min"] == rows[f"{letter} max"]
            continue
        for side, (value, name) in zip(("min", "max"), values, strict=True):
            assert rows[f"{letter} {side}"].endswith(f"({name})")
            assert float(rows[f"{letter} {side}"].split(" ")[0].replace("−", "-")) == pytest.approx(
                value, rel=1e-3
            )
    session.model.tag_only([session.particles["A"]], Hovered)
    session.frame(0.0)
    assert session.view.pointed is not None
    assert session.view.pointed.rows[-1] == ("combination", "all")


def test_a_pinned_place_under_the_pointer_is_told_once() -> None:
    session = in_statics(beam())
    choose(session, "Envelope")
    session.click(2.0, 0.0)
    for _ in range(2):
        session.frame(0.0)
    assert session.view.pin is not None
    assert texts(session).count("V max") == 1


@pytest.mark.parametrize("deed", ["ctrl+n", "delete"])
def test_what_is_shown_of_an_envelope_ends_with_its_model(deed: str) -> None:
    """The mark under the pointer is looked for before the picture knows that all is gone."""
    session = in_statics(beam())
    choose(session, "Envelope")
    session.select(*session.particles)
    session.frame(0.0)
    session.view.pointer = session.point(4.0, 0.1)
    session.press(deed)
    for _ in range(2):
        session.frame(0.0)
    assert not session.particles.count
    assert session.view.enveloped is None


def test_tables_name_what_governs() -> None:
    session = in_statics(beam())
    choose(session, "Envelope")
    session.press("n")
    session.frame(0.0)
    assert list(session.lister.tables) == ["envelope", "reactions"]
    heads, first, *_ = list(session.lister.table.rows())
    row = dict(zip(heads, first, strict=True))
    assert row["M max (kN·m)"] == pytest.approx(18.96, abs=5e-3)
    assert (row["M max in"], row["M min in"]) == ("all", "ULS")
    session.lister.turn(1)
    rows = {name: values for name, *values in session.lister.table.rows()}
    assert rows["C"][4:] == [pytest.approx(22.11), "all", pytest.approx(11.61), "ULS"]
    session.act("toggle envelope")
    session.frame(0.0)
    assert list(session.lister.tables) == ["rods", "particles", "sums"]
    assert session.lister.table[0][0] == "rod"


def test_there_is_none_without_combinations_or_equilibrium() -> None:
    session = in_statics(beam(combinations={}))
    session.act("toggle envelope")
    session.frame(0.0)
    assert session.notice.startswith("The model has no combinations")
    assert not session.view.envelope
    source = beam(theory="exact")
    source["settings"]["combinations"]["too much"] = {"snow": 1e7}
    session = in_statics(source | {"settings": source["settings"] | {"theory": "exact"}})
    session.act("toggle envelope")
    session.frame(0.0)
    assert session.view.enveloped.combinations == ("ULS", "all")
    assert list(session.view.enveloped.without) == ["too much"]
    assert "left out of the envelope: too much" in session.view.status.notice


def test_commands_draw_cases_combinations_and_envelopes(tmp_path: Path) -> None:
    model, made = tmp_path / "beam.json", tmp_path / "made.svg"
    model.write_text(json.dumps(beam()), encoding="utf-8")
    for options, said in (
        (["--combination", "ULS"], "ULS: 1.35 permanent + 1.5 snow"),
        (["--combination", "snow"], "case snow"),
        (["--envelope"], "envelope of ULS and all"),
    ):
        assert main(["render", str(model), "--static", "--diagrams", *options, "--output", str(made)]) == 0
        assert said in made.read_text(encoding="utf-8")
    assert main(["render", str(model), "--envelope", "--output", str(made)]) == 2
    assert main(["sheet", str(model), "--envelope", "--output", str(tmp_path / "sheet.pdf")]) == 0
    figures = figures_of(contents(Solved(parse(beam()), "first-order", ()), LAYOUTS[0]))
    captions = [figure.caption.text for figure in figures]
    assert any(caption.startswith("Envelope of ULS and all: Bending moments M") for caption in captions)
    assert main(["sheet", str(model), "--combination", "snow", "--output", str(tmp_path / "sheet.pdf")]) == 0


@pytest.mark.parametrize("deed", ["delete", "of another case"])
def test_a_case_that_acts_alone_is_that_of_some_load(deed: str) -> None:
    """When its last load is gone, all cases act again, and a file of that model can be read; undo lets it act again."""
    session = in_statics(beam(combination="snow"))
    snow = [one for one in [*session.model.loads, *session.model.span_loads] if one.case == "snow"]
    with session.model.transaction("all of them"):
        if deed == "delete":
            session.model.delete(snow)
        else:
            for load in snow:
                load.case = "wind"
    assert session.settings.combination == ""
    assert parse(document(session.model)).settings.combination == ""
    session.undo()
    assert session.settings.combination == "snow"
