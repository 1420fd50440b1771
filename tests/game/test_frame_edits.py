"""What works for trusses works for frames: copies, undo, moving, deleting, restarting, scripts, and clear refusals."""

import json

import pytest

from pinjoint import Session
from pinjoint.documents.document import document
from pinjoint.documents.format import ModelError
from pinjoint.documents.models import load, save
from pinjoint.editor.clipboard import Part
from tests.reference.models import model, particle, rod

MEMBER = {
    "section": "IPE 200",
    "hinged": [False, True],
    "distributed_force": [0.5, -3.0],
    "temperature_gradient": 12.0,
    "bending_damping": 0.25,
}


def portal(**properties: object) -> Session:
    particles = [
        particle("A", 0, 0, fixed=[True, True], fixed_rotation=True),
        particle("B", 0, 3, moment=1.5, inertia=0.4, force=[5, 0]),
        *(particle("C", 4, 3), particle("D", 4, 0, fixed=[True, True], fixed_rotation=True)),
    ]
    rods = [rod(*ends, **(MEMBER | properties)) for ends in ("AB", "BC", "CD")]
    loads = [{"on": "C", "force": [0, -2], "moment": -0.75, "history": {"kind": "ramp"}}]
    return Session.open(model(particles, rods, loads=loads))


def facts(session: Session, names: list[str], table: str) -> list[dict[str, object]]:
    return [
        {k: v for k, v in one.items() if k not in ("name", "position", "between", "on")}
        for one in document(session.model)[table]
        if one["name"] in names
    ]


def test_copies_have_all_facts_of_bending() -> None:
    session = portal()
    session.press("ctrl+a")
    session.press("ctrl+d")
    particles, rods = [p.name for p in session.particles], [r.name for r in session.rods]
    assert facts(session, particles[4:], "particles") == facts(session, particles[:4], "particles")
    assert facts(session, rods[3:], "rods") == facts(session, rods[:3], "rods")
    loads = document(session.model)["loads"]
    assert [load["moment"] for load in loads] == [-0.75, -0.75]
    session.select(*session.particles, *session.rods)
    other = Session.open({"format": "pinjoint model", "version": 1})
    Part.described(Part.selected(session.model).text).paste(other.model, (0.0, 0.0))
    assert other.rods[0].section == "IPE 200"
    assert other.rods[0].hinged == (False, True)
    assert other.particles[1].moment == 1.5


def test_moving_a_joint_keeps_sections_and_joints() -> None:
    session = portal()
    b = session.particles["B"]
    b.position = (0.0, 3.5)
    assert session.rods["AB"].rest_length == 3.5
    assert session.rods["AB"].section == "IPE 200"
    assert session.rods["AB"].end_stiffness[0] == pytest.approx(
        3.0 * session.rods["AB"].bending_stiffness / 3.5
    )


def test_restarting_stops_what_was_clamped_since() -> None:
    session = portal()
    session.particles["B"].angular_velocity = 3.0
    session.run(time=0.01)
    session.particles["B"].fixed_rotation = True
    session.restart()
    assert session.particles["B"].angular_velocity == 0.0
    assert session.particles["B"].rotation == 0.0
    session.run(time=0.01)
    assert session.particles["B"].rotation == 0.0


def test_saved_and_loaded_and_continued_is_the_same(tmp_path) -> None:  # type: ignore[no-untyped-def]
    session, path = portal(), tmp_path / "portal.json"
    session.run(steps=200)
    session.save(path)
    again = Session.open(str(path))
    for each in (session, again):
        each.run(steps=100)
    assert document(again.model) == document(session.model)
    save(load(path), path)
    assert json.loads(path.read_text(encoding="utf-8"))["rods"][0]["section"] == "IPE 200"


def test_a_moment_that_can_turn_nothing_is_told_with_the_remedy() -> None:
    session = portal(hinged=[True, True])
    session.run(steps=10)
    assert "Particle B: a moment of 1.5 kN·m acts on it, but no rod is rigidly joined to it" in session.message
    session.rods["AB"].hinged = (True, False)
    session.loads[0].moment = 0.0
    session.run(steps=10)
    assert "moment" not in session.message


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"bending_stiffness": float("nan")}, "rod AB.*bending stiffness is nan; it must be a finite number"),
        ({"bending_stiffness": float("inf")}, "bending stiffness is inf"),
        ({"bending_stiffness": -1.0}, "bending stiffness is -1 kN·m²; it must be at least 0"),
        ({"second_moment": 0.0}, "second moment is 0 m⁴; it must be greater than 0|IPE 200 has another value"),
        ({"hinged": [True]}, r"hinged needs two entries, \[start, end\]; it has 1"),
        ({"hinged": "yes"}, r"hinged is 'yes'; it must be a pair of true or false, \[start, end\]"),
        ({"hinged": [1, 0]}, "must be true or false"),
        ({"distributed_force": [0.0, float("inf")]}, "distributed force y is inf"),
        ({"distributed_force": 3.0}, "must be a pair of numbers"),
        ({"temperature_gradient": "warm"}, "temperature gradient is 'warm'"),
        ({"bending_damping": -2.0}, "bending damping is -2"),
        ({"rotation": 1.0}, "no key 'rotation' here"),
    ],
)
def test_hostile_values_are_refused_with_element_value_and_remedy(
    changed: dict[str, object], told: str
) -> None:
    with pytest.raises(ModelError, match=told):
        portal(**changed)


def test_numbers_that_only_together_are_too_large_are_named() -> None:
    session = portal(section=None, youngs_modulus=1e25, second_moment=1e10, area=1.0)
    assert session.run(steps=1) == "diverged"
    assert "bending stiffness is 1e+35 kN·m², too large to compute with" in session.message
