"""Influence lines in the window, in pictures and on the command line: by brute force, one force after the other."""

import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.bent import inner_forces
from pinjoint.components.load import SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.view import Shape
from pinjoint.documents import models
from pinjoint.documents.influence import Influence
from pinjoint.documents.statics import Statics
from pinjoint.sheet import Solved, contents
from pinjoint.systems.edit.dividing import divide
from pinjoint.systems.render.backends.paper import LAYOUTS
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.statics.theory import linear
from pinjoint.systems.statics.unknowns import MethodError
from tests.game.test_sheet import figures_of
from tests.systems.render.frame_models import frame, portal

SLOPING = frame(
    {
        "A": (0.0, 0.0, {"fixed": [True, True], "fixed_rotation": True}),
        "B": (3.0, 1.0, {}),
        "C": (7.0, 2.0, {"fixed": [False, True], "support_angle": 0.3}),
        "D": (10.0, 1.0, {"fixed": [True, True]}),
    },
    {"A B": {}, "B C": {"hinged": [True, False]}, "C D": {"end_springs": [0.0, 5000.0]}},
)


def by_brute_force(source: object, name: str, rod: str) -> float:
    """What 1 kN down at the middle of a rod adds to a quantity, by dividing the rod there."""
    made = models.load(source)  # type: ignore[arg-type]
    place, _, what = name.partition(".")
    parts = divide(made, [made.rods[rod]], 2)
    middle = ({*parts[0].ends} & {*parts[1].ends}).pop()
    own = (
        {"start": parts[0], "end": parts[1], "shear": parts[1], "": parts[1]}.get(what)
        if place == rod
        else None
    )
    before = read(made, own.name if own else place, what)
    middle.force = (middle.force[0], middle.force[1] - 1.0)
    return read(made, own.name if own else place, what) - before


def read(made: Model, place: str, what: str) -> float:
    found = linear(made)
    if place in made.rods:
        row = made.rods[place].row
        if what == "":
            return float(found.diagrams["end_axial_force"][row, 1])
        if what == "shear":
            return float(found.diagrams["shear"][row, 1])
        return float(found.diagrams["bending_moment"][row, ("start", "end").index(what)])
    row = made.particles[place].row
    if what == "rotation":
        return float(
            found.reaction_moment[row] if made.particles[place].fixed_rotation else found.rotation[row]
        )
    axis = "xy".index(what)
    along = np.array([np.cos(a := made.particles[place].support_angle), np.sin(a)])
    along = along if axis == 0 else np.array([-along[1], along[0]])
    held = made.particles[place].fixed[axis]
    return float(along @ (found.reaction[row] if held else found.displacement[row]))


@pytest.mark.parametrize("source", [portal(), SLOPING], ids=["portal", "sloping"])
@pytest.mark.parametrize(
    "name",
    ["AB", "BC", "AB.start", "BC.end", "CD.start", "BC.shear", "A.y", "A.rotation", "B.y", "C.rotation", "C.x"],
)
def test_a_force_at_the_middle_of_every_rod(source: object, name: str) -> None:
    made = models.load(source)  # type: ignore[arg-type]
    [line] = Influence.of(made, name)
    found = line.along(made).at(np.array([0.5]))[:, 0]
    wanted = [by_brute_force(source, name, rod) for rod in made.rods.names]
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize("source", [portal(), SLOPING], ids=["portal", "sloping"])
@pytest.mark.parametrize("letter", "NVM")
@pytest.mark.parametrize("where", [0.3, 0.75])
def test_a_place_within_a_member_without_dividing_it(source: object, letter: str, where: float) -> None:
    """Against 1 kN down at many places of every rod, read where the cut is."""
    made = models.load(source)  # type: ignore[arg-type]
    length = made.rods["BC"].original_length
    line, same = Influence.of(made, f"BC.{letter}@{100.0 * where:g}%", f"BC.{letter}@{where * length!r}")
    found, shares = line.along(made), np.array([0.1, 0.29, 0.31, 0.5, 0.74, 0.76, 0.9])
    assert found.at(shares) == pytest.approx(same.along(made).at(shares), abs=1e-12)
    for row, rod in enumerate(made.rods.names):
        wanted = []
        for share in shares.tolist():
            loaded = models.load(source)  # type: ignore[arg-type]
            before = inner(loaded, "BC", letter, where)
            at = share * loaded.rods[rod].original_length
            loaded.create(SpanLoad, rod=[row], start=[at], force=[(0.0, -1.0)])
            wanted.append(inner(loaded, "BC", letter, where) - before)
        assert found.at(shares)[row] == pytest.approx(wanted, rel=1e-9, abs=1e-9), rod


def inner(made: Model, rod: str, letter: str, share: float) -> float:
    statics = Statics(made, lambda: np.zeros((made.rods.count, 3)))
    made.settings.theory = "first-order"
    made.show(statics)
    return float(inner_forces(made, np.array([made.rods[rod].row]), letter).at(np.array([share]))[0, 0])


def test_three_spans_by_hand() -> None:
    """The middle moment of the middle one of three equal spans L, by three moments.

    P in its middle: M_B = M_C = −3/40 PL, so M = PL/4 − 3/40 PL = 0.175 PL; in the middle of a side span M_B = −PL/10 and
    M_C = PL/40, so M = −0.0375 PL.
    """
    made = models.load(three_spans())
    [line] = Influence.of(made, "BC.M@50%")
    assert line.along(made).at(np.array([0.5]))[:, 0] == pytest.approx([-0.0375 * 4, 0.175 * 4, -0.0375 * 4])
    session = Session.open(three_spans())
    session.press("q")
    session.select(session.rods["BC"])
    session.press("ctrl+i")
    session.frame(0.0)
    picture = compose(session.model, session.view, load_theme("light"))
    assert "0.7000" in picture.texts
    assert "bending moment of BC at 200 cm from its start" in session.view.shape.title
    shape = session.view.shape
    assert "0" not in [text for text, *_ in shape.values]
    for text, place, away in shape.values:  # drawn where they are, to one scale
        assert float(text.replace("−", "-")) == pytest.approx(-away[1] / scale_of(shape), abs=1e-3), place


def scale_of(shape: Shape) -> float:
    [away] = [away for text, _, away in shape.values if text == "0.7000"]
    return float(-away[1] / 0.7)


def three_spans() -> dict[str, object]:
    joints = {name: (4.0 * k, 0.0, {"fixed": [k == 0, True]}) for k, name in enumerate("ABCD")}
    return frame(joints, {"A B": {}, "B C": {}, "C D": {}})


def test_in_statics_the_place_that_was_clicked_counts() -> None:
    session = Session.open(three_spans())
    session.press("q")
    session.frame(0.0)
    session.click(9.0, 0.0)
    titles = []
    for _ in range(3):
        session.press("ctrl+i")
        titles.append(session.view.shape.title.split(" for ")[0] if session.view.shape else "")
    assert titles[0].startswith("Influence line: bending moment of CD at 10")
    assert titles[1].startswith("Influence line: shear force of CD at 10")
    assert titles[2] == ""  # a force downwards does nothing to N


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("BC.M@9", "is no place on BC, which is 4 m long"),
        ("BC.M@one", "is no place on BC"),
        ("BC.M@120%", "is no place on BC"),
        ("BC.M@2 kN", "is no place on BC"),
        ("AB.M@0", "is hinged"),
    ],
)
def test_wrong_places_are_named(name: str, said: str) -> None:
    source = three_spans()
    source["rods"][0]["hinged"] = [True, False]  # type: ignore[index]
    with pytest.raises(MethodError, match=said):
        Influence.of(models.load(source), name)  # type: ignore[arg-type]


def test_the_window_draws_one_after_the_other() -> None:
    session = Session.open("portal")
    session.press("ctrl+i")
    assert session.notice.startswith("Select one rod or one particle first")
    session.select(session.rods["BC"])
    shown = []
    for _ in range(6):
        session.press("ctrl+i")
        shown.append(session.view.shape.title.split(" for ")[0] if session.view.shape else "")
    assert shown == [
        "Influence line: bending moment of BC at 300 cm from its start",
        "Influence line: bending moment at the start of BC",
        "Influence line: bending moment at the end of BC",
        "Influence line: shear force of BC",
        "Influence line: axial force of BC",
        "",
    ]
    session.press("ctrl+i")
    session.frame(0.3)
    assert session.view.swing == 1.0  # it stays still
    session.rods["BC"].stiffness = 1e5
    session.frame(0.1)
    assert session.view.shape is None


def test_a_particle_and_a_mechanism() -> None:
    session = Session.open("hyperstatic")
    session.select(session.particles["A"])
    session.press("ctrl+i")
    assert session.view.shape is not None
    assert "displacement x of A" in session.view.shape.title
    session = Session.open(frame({"A": (0.0, 0.0, {"fixed": [True, True]})}, {}))
    session.select(session.particles["A"])
    session.press("ctrl+i")
    assert "There are no rods" in session.notice
    session = Session.open("pendulum")
    session.select(session.rods[0])
    session.press("ctrl+i")
    assert "A mechanism has no influence lines" in session.notice


def test_pictures_and_the_command_tell_extremes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "line.svg"
    assert main(["render", "portal", "--influence", "BC.start", "--output", str(picture)]) == 0
    assert "Influence line: bending moment at the start of BC" in picture.read_text(encoding="utf-8")
    assert main(["verify", "portal", "--influence", "BC.start", "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)["influence"]["BC.start"]["downwards"]
    assert found["least"]["rod"] == "BC"
    assert found["least"]["value"] == pytest.approx(-0.5048, abs=1e-4)
    assert main(["verify", "portal", "--influence", "BC.start"]) == 0
    assert "where 1 kN acts downwards on BC" in capsys.readouterr().out
    assert main(["verify", "portal", "--influence", "BC.start", "--path", "AB", "CD", "--format", "json"]) == 0
    along = json.loads(capsys.readouterr().out)["influence"]["BC.start"]["downwards"]
    assert along["most"] == found["most"]
    assert along["least"]["rod"] == "CD"
    assert main(["render", "portal", "--influence", "nothing", "--output", str(picture)]) == 2


def test_lines_stand_in_the_sheet(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, made = tmp_path / "beam.json", tmp_path / "sheet.pdf"
    model.write_text(json.dumps(three_spans() | {"title": "Beam"}), encoding="utf-8")
    assert main(["sheet", str(model), "--influence", "BC.M@2", "B.y", "--output", str(made)]) == 0
    assert made.stat().st_size > 10_000
    [line] = Influence.of(models.load(model), "BC.M@50%")
    shape = line.shape(models.load(model))
    parts = contents(Solved(models.load(model), "first-order"), LAYOUTS[0], [shape])
    captions = [figure.caption.text for figure in figures_of(parts)]
    assert any(caption.startswith("Influence line: bending moment of BC at 200 cm") for caption in captions)
    assert main(["sheet", str(model), "--influence", "BC.M@9", "--output", str(made)]) == 2
    assert main(["sheet", "pendulum", "--influence", "AB", "--output", str(made)]) == 1
    assert "A mechanism has no influence lines" in capsys.readouterr().err
