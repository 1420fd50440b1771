"""Inextensible members in first-order theory: moment distribution and other hand methods, multipliers, and refusals."""

import math
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import FirstOrder, Indeterminacy, influence_line, linear
from pinjoint.systems.statics.unknowns import MethodError, Unknown
from tests.reference.models import CLAMPED, model, particle, rod
from tests.verification.test_frame_theory import SEEDS, agrees, random_frame

EI, Q = 4000.0, 12.0
FIRM = {"stiffness": 5e4, "bending_stiffness": EI, "inextensible": True}


def portal(height: float = 4.0, span: float = 6.0, **facts: Any) -> Model:
    """A clamped portal of inextensible members, by default under q on its beam."""
    given = {"distributed_force": [0.0, -Q]} | facts
    particles = [
        particle("A", 0, 0, **CLAMPED),
        particle("B", 0, height),
        particle("C", span, height),
        particle("D", span, 0, **CLAMPED),
    ]
    return parse(
        model(particles, [rod("A", "B", **FIRM), rod("B", "C", **FIRM | given), rod("C", "D", **FIRM)])
    )


def test_a_portal_by_kleinlogel() -> None:
    """With k = h/l, N = k + 2: corners −ql²/6N, feet ql²/12N, thrust ql²/4hN; legs keep their lengths."""
    found, k = linear(portal()), 4.0 / 6.0
    corner, foot = -Q * 36.0 / (6.0 * (k + 2.0)), Q * 36.0 / (12.0 * (k + 2.0))
    assert found.diagrams["bending_moment"][1] == pytest.approx([corner, corner], rel=1e-11)
    assert found.reaction[0] == pytest.approx([(foot - corner) / 4.0, 0.5 * Q * 6.0], rel=1e-11)
    assert found.axial_force == pytest.approx([-36.0, -(foot - corner) / 4.0, -36.0], rel=1e-11)
    assert found.displacement == pytest.approx(np.zeros((4, 2)), abs=1e-15)
    assert found.strain == pytest.approx(np.zeros(3), abs=0.0)


def test_a_swaying_portal_by_slope_deflection() -> None:
    """Under a load H at the corner: sway of both corners alike, corner moments Hh/2 · 3k/(6k + 1), k = I_b h / I_c l."""
    made = portal(distributed_force=[0.0, 0.0])
    made.particles["B"].force = (10.0, 0.0)
    found, k = linear(made), 4.0 / 6.0
    corner = 10.0 * 4.0 / 2.0 * 3.0 * k / (6.0 * k + 1.0)
    assert np.abs(found.diagrams["bending_moment"][1]) == pytest.approx([corner, corner], rel=1e-11)
    assert found.displacement[1] == pytest.approx(found.displacement[2], abs=1e-15)
    assert found.displacement[1, 1] == pytest.approx(0.0, abs=1e-15)


def test_moment_distribution_at_a_joint_that_cannot_move() -> None:
    """Three members at B, clamped, pinned and clamped far away: 4EI/L, 3EI/L, 4EI/L; fixed-end moment qL²/12."""
    particles = [
        particle("A", 0, 0, **CLAMPED),
        particle("B", 6, 0),
        particle("C", 10, 0, fixed=[False, True]),
        particle("D", 6, -3, **CLAMPED),
    ]
    rods = [
        rod("A", "B", distributed_force=[0.0, -Q], **FIRM | {"inextensible": False, "stiffness": 1e6}),
        rod("B", "C", **FIRM),
        rod("B", "D", **FIRM),
    ]
    shares = np.array([4.0 / 6.0, 3.0 / 4.0, 4.0 / 3.0])
    fixed = Q * 36.0 / 12.0
    at_joint = fixed * shares / shares.sum()
    rods[0] |= {"inextensible": True}
    found = linear(parse(model(particles, rods)))
    moments = found.diagrams["bending_moment"]
    assert abs(moments[1, 0]) == pytest.approx(at_joint[1], rel=1e-11)
    assert abs(moments[2, 0]) == pytest.approx(at_joint[2], rel=1e-11)
    assert abs(moments[0, 1]) == pytest.approx(fixed - at_joint[0], rel=1e-11)
    assert abs(moments[0, 0]) == pytest.approx(fixed + 0.5 * at_joint[0], rel=1e-11)


def test_answers_are_those_of_very_stiff_members() -> None:
    firm = linear(portal())
    soft = portal()
    soft.assign(list(soft.rods), "inextensible", False)
    soft.assign(list(soft.rods), "stiffness", 1e11)
    stiff = linear(soft)
    assert firm.axial_force == pytest.approx(stiff.axial_force, rel=1e-6)
    assert firm.elastic_energy == pytest.approx(stiff.elastic_energy, rel=1e-6)


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS)
def test_random_frames_agree_with_an_independent_solver(seed: int) -> None:
    document = random_frame(seed)
    lot = np.random.default_rng(seed)
    for member in document["rods"]:
        member["inextensible"] = bool(lot.random() < 0.3)
    made = parse(document)
    if Indeterminacy.of(made).mechanisms:
        return
    with suppress(NoEquilibrium):  # of self-stress
        agrees(document, linear(made), made)


def test_the_force_method_has_no_terms_of_inextensible_rods() -> None:
    made = portal()
    answer = linear(made)
    found = solve(made, [Unknown.named(made, name) for name in ("D.x", "D.y", "D.rotation")])
    assert not found.work.axial.softness.any()
    assert found.force[:2] == pytest.approx(answer.reaction[3], rel=1e-9)
    assert found.superposed.axial_force == pytest.approx(answer.axial_force, rel=1e-9)
    assert found.gap == pytest.approx(-found.flexibility @ found.force, rel=1e-9)


def test_influence_lines() -> None:
    made = portal(distributed_force=[0.0, 0.0])
    thrust = influence_line(FirstOrder.of(made), "reaction", 3, 0)
    force = influence_line(FirstOrder.of(made), "axial_force", 1)
    made.particles["B"].force = (1.0, 0.0)
    found = linear(made)
    assert thrust[1, 0] == pytest.approx(found.reaction[3, 0], rel=1e-9)
    assert force[1, 0] == pytest.approx(found.axial_force[1], rel=1e-9)


def test_warmth_and_lack_of_fit_move_joints_by_themselves() -> None:
    made = portal(distributed_force=[0.0, 0.0])
    made.assign(list(made.rods), "temperature_change", [30.0, 0.0, 30.0])
    found = linear(made)
    assert found.displacement[1:3, 1] == pytest.approx([30.0 * 1.2e-5 * 4.0] * 2, rel=1e-11)
    assert found.length[0] == pytest.approx(4.0 * (1.0 + 30.0 * 1.2e-5), rel=1e-14)


def test_self_stressed_rods_are_refused_by_name() -> None:
    corners = [
        ("A", 0, 0, {"fixed": [True, True]}),
        ("B", 1, 0, {"fixed": [False, True]}),
        ("C", 1, 1, {}),
        ("D", 0, 1, {}),
    ]
    pairs = ["AB", "BC", "CD", "DA", "AC", "BD"]
    particles = [particle(name, x, y, **facts) for name, x, y, facts in corners]
    particles[2]["force"] = [10.0, 0.0]
    made = parse(model(particles, [rod(*pair, inextensible=True) for pair in pairs]))
    with pytest.raises(NoEquilibrium, match=r"axial forces of rods AB, BC, CD, DA, AC and 1 more.*self-stress"):
        linear(made)
    with pytest.raises(MethodError, match="self-stress"):
        solve(made, [Unknown.named(made, "AC")])
    made.rods["BD"].inextensible = False
    found = linear(made)
    assert found.axial_force[5] == pytest.approx(0.0, abs=1e-9)
    assert found.displacement == pytest.approx(np.zeros((4, 2)), abs=1e-15)
    ends = [particle(name, x, 0, fixed=[True, True]) for x, name in enumerate("AB")]
    held = parse(model(ends, [rod("A", "B", inextensible=True)]))
    with pytest.raises(NoEquilibrium, match="of rod AB, which are inextensible"):
        linear(held)


def test_yielding_beside_inextensible_rods_is_refused_and_cables_are_none() -> None:
    held = {"fixed": [True, True]}
    places = ("A", 0, 0, held), ("B", 1, 0, {"force": [50.0, -50.0]}), ("C", 0, 1, held)
    rods = [rod("A", "B", inextensible=True), rod("B", "C", tensile_strength=20.0)]
    made = parse(model([particle(name, x, y, **facts) for name, x, y, facts in places], rods))
    found = settle(made, theory="first-order").final
    assert found.status == "limit reached"
    assert "Inextensible rods, such as rod AB" in found.message
    with pytest.raises(FieldError, match="a cable cannot be inextensible"):
        made.rods["AB"].tension_only = True


def test_exact_theory_motion_and_buckling_say_that_ea_counts() -> None:
    said = "Only first-order theory takes rod AB for inextensible"
    made = portal()
    exact = settle(made).final
    assert said in exact.message
    assert exact.axial_force[0] / 5e4 == pytest.approx(exact.strain[0], rel=1e-9)
    made.particles["B"].force = (0.0, -1.0)
    assert any(said in note for note in Buckling.of(made).notes)
    session = Session(portal())
    session.run(time=0.001)
    assert said in session.simulation.note


def test_curves_refuse_inextensible_rods_in_first_order_and_have_their_ea_in_exact_theory() -> None:
    with pytest.raises(ValueError, match="rod AB should be; let such rods have their EA"):
        Curve.of(portal(), Goal(1.0), theory="first-order")
    assert Curve.of(portal(), Goal(1.0)).complete


def test_menus_mark_rods_and_pictures_show_it() -> None:
    session = Session(portal())
    session.select(session.rods["AB"], session.rods["BC"], session.rods["CD"])
    session.act("toggle inextensible")
    assert not any(one.inextensible for one in session.rods)
    session.act("toggle inextensible")
    assert all(one.inextensible for one in session.rods)
    session.press("q")
    assert session.scene == "statics"
    assert math.isfinite(session.rods["AB"].axial_force)
