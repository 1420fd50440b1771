"""Influence lines in the window, in pictures and on the command line: by brute force, one force after the other."""

import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.model import Model
from pinjoint.components.spans import values
from pinjoint.documents import models
from pinjoint.documents.influence import Influence
from pinjoint.systems.edit.dividing import divide
from pinjoint.systems.statics.theory import linear
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
    line = Influence.of(made, name)
    found = values(line.along(made), np.array([0.5]))[:, 0]
    wanted = [by_brute_force(source, name, rod) for rod in made.rods.names]
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * np.abs(wanted).max())


def test_the_window_draws_one_after_the_other() -> None:
    session = Session.open("portal")
    session.press("ctrl+i")
    assert session.notice.startswith("Select one rod or one particle first")
    session.select(session.rods["BC"])
    shown = []
    for _ in range(5):
        session.press("ctrl+i")
        shown.append(session.view.shape.title.split(" for ")[0] if session.view.shape else "")
    assert shown == [
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
