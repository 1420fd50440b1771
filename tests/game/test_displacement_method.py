"""The displacement method as a person goes through it: scene and keys, command line, report, both languages."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.bent import farthest
from pinjoint.components.language import spoken
from pinjoint.components.rod import Rod
from pinjoint.components.tags import Selected
from pinjoint.documents import models
from pinjoint.methods import displacement_words as words
from pinjoint.methods.displacements import DisplacementGuide, DisplacementTables
from pinjoint.methods.report import contents, report
from pinjoint.systems.edit.arrows import extent
from pinjoint.systems.render.backends.paper import LAYOUTS, WIDTH
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.statics.displacement_method import solve
from tests.game.test_force_method_report import number, rows_in, written_in
from tests.game.test_force_method_scene import said
from tests.systems.render.frame_models import frame


def guide_of(session: Session) -> DisplacementGuide:
    assert session.scene == "displacement method"
    guide: DisplacementGuide = session.scenes.active.guide  # type: ignore[attr-defined]
    return guide


def led(source: Any, *keys: str) -> tuple[Session, DisplacementGuide]:
    session = Session.open(source)
    session.resize(1280, 800)
    for key in ("ctrl+k", *keys):
        session.press(key)
    return session, guide_of(session)


def test_six_parts_from_pause_to_pause() -> None:
    session, guide = led("portal")
    before = models.document(session.model)
    assert words.working(guide)[0].startswith("n = 6 directions")
    assert "the force method has 3 equations" in words.working(guide)[1]
    session.press("k")
    assert words.working(guide)[0].startswith("Δ₁ = B.x,  Δ₂ = B.y,  Δ₃ = B.rotation")
    assert words.table(guide)[1] == ("AB", "4.000", "410000", "12000", "6000", "12000", "4500", "4500", "2250")
    session.press("k")
    assert words.table(guide)[-1][1:] == ("35.00", "−60.00", "−60.00", "0", "−60.00", "60.00")
    for acting in range(6):
        session.press("k")
        assert (guide.part, guide.acting) == (4, acting)
        session.frame(1 / 60)
    session.press("k")
    assert guide.part == 5
    assert words.table(guide)[1][:4] == ("Δ₁ B.x", "190583", "0", "4500.0")
    session.press("k")
    assert words.table(guide)[1] == ("AB.start", "−20.279", "0", "−20.279", "0")
    assert words.working(guide)[1] == "Equilibrium of all joints: what is left to hold them is 0 kN."
    session.expect("displacement_method.B.x ≈ 0.01121 ± 0.00001")
    session.expect("displacement_method.part = 6")
    session.press("k")
    assert session.scene == "pause"
    assert models.document(session.model) == before


def test_a_structure_without_unknowns_is_gone_through_to_its_end() -> None:
    clamped = {"fixed": [True, True], "fixed_rotation": True}
    session = Session.open(frame({"A": (0.0, 0.0, clamped), "B": (4.0, 0.0, clamped)}, {"A B": {}}))
    session.press("ctrl+k")
    for _ in range(4):
        session.press("k")
        session.frame(0.02)
        assert compose_all(session.stages, load_theme("light"))
    assert session.scene == "pause"


def test_b_goes_back_and_n_to_the_equations() -> None:
    session, guide = led("hyperstatic", "k", "k", "k", "k")
    assert (guide.part, guide.acting) == (4, 1)
    for part, acting in ((4, 0), (3, 0), (2, 0), (1, 0), (1, 0)):
        session.press("b")
        assert (guide.part, guide.acting) == (part, acting)
        assert len(guide.sets) == max(1, min(part - 1, 3))
    for key in ("k", "k", "k", "n"):
        session.press(key)
    assert guide.part == 5
    session.press("b")
    assert (guide.part, guide.acting) == (4, guide.size - 1)


@pytest.mark.parametrize("keys", [("k", "click", "k", "k", "k", "k"), ()])
def test_b_goes_back_in_the_force_method(keys: tuple[str, ...]) -> None:
    session = Session.open("hyperstatic")
    session.press("k")
    parts = [1]
    for key in keys:
        if key == "click":
            session.click(0.5, 1.0)
        else:
            session.press(key)
        parts.append(session.scenes.active.guide.part)  # type: ignore[attr-defined]
    for wanted in reversed(range(1, parts[-1])):
        session.press("b")
        guide = session.scenes.active.guide  # type: ignore[attr-defined]
        assert guide.part == wanted
        assert len(guide.sets) == {1: 1, 2: 1, 3: 2, 4: 2}.get(wanted, 3)
    if keys:
        assert not guide.released
        session.press("k")
        session.click(0.5, 1.0)
        assert guide.part == 3


def test_the_other_method_is_one_key_away() -> None:
    session, _ = led("portal")
    session.press("ctrl+k")
    assert session.scene == "force method"
    session.press("ctrl+k")
    assert guide_of(session).part == 1
    session.press("escape")
    assert session.scene == "pause"


def test_pointing_at_an_entry_shows_its_members() -> None:
    session, guide = led("portal", "k", "k", "k", "n")
    places = {}
    for x in range(0, session.view.canvas.width, 10):
        for y in range(600, 800, 4):
            session.view.pointer = (float(x), float(y))
            assert session.stages
            if guide.pointed is not None:
                places[guide.pointed] = session.scenes.active.message, guide.sets[0].model.tagged(Selected, Rod)
    assert set(places) == {(i, j) for i in range(6) for j in range(7)}
    message, rods = places[0, 0]
    assert message == "k₁₁ = 2250.0 (AB) + 188333 (BC) = 190583 kN/m"
    assert [rod.name for rod in rods] == ["AB", "BC"]
    assert places[0, 6][0] == "F₁ = 35.000 (joints) = 35.000 kN"
    assert places[1, 6][0] == "F₂ = −60.000 (BC) = −60.000 kN"
    assert places[0, 1][0] == "k₁₂ = 0 kN/m"
    session.view.pointer = None
    assert session.stages
    assert session.scenes.active.message == "Nothing holds the joints: K Δ = F"


def test_a_click_on_a_rod_shows_its_k() -> None:
    session, guide = led("portal", "k")
    session.click(0.0, 2.0)
    assert guide.member is not None
    assert guide.member.name == "AB"
    head, first, *_ = words.table(guide)
    assert head == ("k AB", "A.x", "A.y", "A.rotation", "B.x", "B.y", "B.rotation")
    assert first == ("A.x", "2250.0", "0", "−4500.0", "−2250.0", "0", "−4500.0")
    assert "k, rod AB" in " ".join(said(session))
    session.press("k")
    assert guide.member is None


@pytest.mark.parametrize("size", [(640, 480), (1280, 800), (400, 300)])
@pytest.mark.parametrize("source", ["portal", "hyperstatic", "gerber_beam", "pendulum"])
@pytest.mark.parametrize("language", ["en", "pt"])
def test_every_part_is_drawn(source: str, size: tuple[int, int], language: str) -> None:
    with spoken(language):
        session = Session.open(source)
        session.resize(*size)
        session.press("ctrl+k")
        for key in ("", "k", "k", "k", "i", "n", "k"):
            if key:
                session.press(key)
            session.frame(1 / 60)
            assert all(
                picture.marks is not None for picture in compose_all(session.stages, load_theme("light"))
            )
            session.click(0.5, 0.5)


def test_a_structure_without_unknowns_has_fixed_end_forces_only() -> None:
    document = models.document(models.load("portal"))
    for particle in document["particles"]:
        particle |= {"fixed": [True, True], "fixed_rotation": True}
    session, guide = led(document, "k", "k", "k")
    assert (guide.part, guide.size) == (6, 0)
    session.press("b")
    assert guide.part == 3
    assert report(guide.tables, "textbook")


# --- command line and report -----------------------------------------------------------------------------


def test_the_command_tells_it_in_every_format(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["displacement-method", "hyperstatic"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["unknowns"] == ["A.x", "B.x", "B.y", "C.x", "C.y"]
    assert found["force_method"] == 1
    assert found["axial_force"]["BD"] == pytest.approx(-14.6446609406726, rel=1e-12)
    assert found["members"]["AB"]["directions"] == ["A.x", "A.y", "B.x", "B.y"]
    assert main(["displacement-method", "hyperstatic", "--format", "csv"]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[0] == "K,Δ₁,Δ₂,Δ₃,Δ₄,Δ₅,F (kN),Δ (m)"
    assert float(rows[1].split(",")[-1]) == found["displacement"][0]
    assert main(["displacement-method", "portal", "--format", "table"]) == 0
    text = capsys.readouterr().out
    assert "n = 6 directions in which joints are free" in text
    assert re.search(r"Σ +190583 +4500 +−188333", text)
    assert main(["displacement-method", "pendulum"]) == 2
    assert "mechanism" in capsys.readouterr().err


def solved(name: str) -> DisplacementTables:
    model = models.load(name)
    return DisplacementTables(model, solve(model))


def test_the_report_says_what_the_solution_is(tmp_path: Path) -> None:
    found = solved("portal")
    parts = [*written_in(contents(found, "textbook"))]
    lines = [part for part in parts if isinstance(part, str)]
    assert "Statics gives the same forces and moments: largest differences 0 kN, 0 kN·m." in lines
    [entries] = [part for part in parts if isinstance(part, list) and part[0][:2] == ["K", "members"]]
    for row in entries[1:]:
        terms = [number(term)[0] for term in re.findall(r"−?[0-9.]+(?= \()", row[1].replace("− ", "−"))]
        total, half = number(row[2].split(" ")[0])
        assert sum(terms) == pytest.approx(total, abs=2.0 * half + 1e-9)
    path = tmp_path / "portal.pdf"
    assert (
        main(["displacement-method", "portal", "--report", str(path), "--output", str(tmp_path / "x.json")])
        == 0
    )
    assert path.read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", ["portal", "hyperstatic", "two_storey_frame", "vierendeel"])
@pytest.mark.parametrize("language", ["en", "pt"])
def test_nothing_in_the_report_stands_beyond_the_margins(name: str, layout: Any, language: str) -> None:
    with spoken(language):
        for row in rows_in(contents(solved(name), "textbook", layout)):
            assert row.wrap(WIDTH, 1e6)[0] <= WIDTH + 0.5


def test_diagrams_of_displaced_sets_are_those_of_first_order() -> None:
    """Axial forces do not bend what is drawn displaced, by a unit above all."""
    session = Session.open("portal")
    session.model.assign(list(session.rods), "inextensible", True)
    session.resize(1280, 800)
    for key in ("ctrl+k", "k", "k", "k", "n"):
        session.press(key)
    session.frame(0.0)
    shown = said(session)
    assert "52.50 kN·m" in shown
    assert {text for text in shown if re.fullmatch(r"\d{4,6}", text)} <= {
        "3000",
        "4500",
        "6000",
        "12000",
        "24000",
    }


def test_members_that_bow_more_than_joints_move_are_drawn_no_larger_than_others() -> None:
    """A portal whose joints hardly move under a load along its beam, which bows."""
    source = models.document(Session.open("portal").model)
    source["loads"], source["sliders"] = [], []
    _, guide = led(source)
    shown = guide.sets[0].model
    most = farthest(shown, np.arange(shown.rods.count))[0].max() * shown.settings.displacement_scale
    assert 0.0 < most < 0.2 * extent(shown)
