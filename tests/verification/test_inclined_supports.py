"""Rollers and springs whose axes are turned: hand formulas, both theories, the force method, and what motion says."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import FirstOrder, Indeterminacy, influence_line, linear, mechanisms
from pinjoint.systems.statics.unknowns import Unknown, redundants
from pinjoint.systems.statics.vibration import Vibrations
from tests.reference.models import model, particle, rod

EI, EA, Q, SLOPE = 4000.0, 8e5, 12.0, math.radians(30.0)
BENDS = {"stiffness": EA, "bending_stiffness": EI}


def beam(**facts: Any) -> Model:
    """A beam of 6 m under q, pinned, and on a roller on a plane that rises by 30°."""
    given = {"fixed": [False, True], "support_angle": SLOPE} | facts
    particles = [particle("A", 0, 0, fixed=[True, True]), particle("B", 6, 0, **given)]
    return parse(model(particles, [rod("A", "B", distributed_force=[0, -Q], **BENDS)]))


def portal(**facts: Any) -> Model:
    """A portal, 5 m by 4 m, clamped at A, its foot D on a roller on a plane that rises by 30°, a load to the right."""
    given = {"fixed": [False, True], "support_angle": SLOPE} | facts
    particles = [
        particle("A", 0, 0, fixed=[True, True], fixed_rotation=True),
        particle("B", 0, 4, force=[10.0, 0.0]),
        particle("C", 5, 4),
        particle("D", 5, 0, **given),
    ]
    rods = [rod("A", "B", **BENDS), rod("B", "C", distributed_force=[0, -Q], **BENDS), rod("C", "D", **BENDS)]
    return parse(model(particles, rods))


def test_a_beam_pushes_along_itself_on_an_inclined_roller() -> None:
    """R is normal to the plane, its vertical part half of the load: N = −R sin 30°; the roller moves along the plane."""
    made = beam()
    found, half = linear(made), 0.5 * Q * 6.0
    assert found.reaction[1] == pytest.approx([-half * math.tan(SLOPE), half], rel=1e-12)
    assert found.axial_force[0] == pytest.approx(-half * math.tan(SLOPE), rel=1e-12)
    shortened = half * math.tan(SLOPE) * 6.0 / EA
    assert found.displacement[1] == pytest.approx([-shortened, -shortened * math.tan(SLOPE)], rel=1e-9)
    assert found.diagrams["largest_moment"][0, 0] == pytest.approx(Q * 36.0 / 8.0, rel=1e-12)
    assert Indeterminacy.of(made).static == 0


def test_the_foot_of_a_portal_by_the_method_of_forces() -> None:
    """X along the normal of the plane, on the released portal, by integrals of moments alone (EA large)."""
    made = portal()
    made.assign(list(made.rods), "stiffness", 1e12)
    found = linear(made)
    points, weights = np.polynomial.legendre.leggauss(8)
    sums = np.zeros(2)
    for start, end in (((0, 0), (0, 4)), ((0, 4), (5, 4)), ((5, 4), (5, 0))):
        length = math.dist(start, end)
        for share, weight in zip(0.5 * (points + 1.0), 0.5 * weights * length, strict=True):
            x, y = (a + share * (b - a) for a, b in zip(start, end, strict=True))
            unit = -math.sin(SLOPE) * (0.0 - y) * -1.0 + math.cos(SLOPE) * (5.0 - x)
            loaded = 0.0 if start == (5, 4) else -Q * (5.0 - x) ** 2 / 2.0
            loaded -= 10.0 * (4.0 - y) if start == (0, 0) else 0.0
            sums += weight / EI * np.array([unit * loaded, unit * unit])
    answer = -sums[0] / sums[1]
    assert found.reaction[3] == pytest.approx([-answer * math.sin(SLOPE), answer * math.cos(SLOPE)], rel=1e-6)
    made = portal()
    released = solve(made, [Unknown.named(made, "D.y")])
    assert released.force == pytest.approx([answer], rel=1e-3)


def test_the_force_method_and_influence_lines_along_turned_axes() -> None:
    made = portal()
    found = linear(made)
    normal = np.array([-math.sin(SLOPE), math.cos(SLOPE)])
    for name in ("D.y", "A.x", "AB.start"):
        released = solve(made, [Unknown.named(made, name)])
        assert released.superposed.reaction[3, :2] == pytest.approx(found.reaction[3], rel=1e-9)
        assert released.superposed.end_moment == pytest.approx(released.real.end_moment, abs=1e-9)
    assert solve(made, [Unknown.named(made, "D.y")]).force == pytest.approx(
        [found.reaction[3] @ normal], rel=1e-9
    )
    assert len(redundants(made)) == Indeterminacy.of(made).static == 1
    line = influence_line(FirstOrder.of(made), "reaction", 3, 1)
    made.assign(list(made.rods), "distributed_force", [(0.0, 0.0)] * 3)
    for row, axis in ((1, 0), (2, 1), (3, 0)):
        made.assign(list(made.particles), "force", [(0.0, 0.0)] * 4)
        made.particles[row].force = (1.0, 0.0) if axis == 0 else (0.0, 1.0)
        assert line[row, axis] == pytest.approx(linear(made).reaction[3] @ normal, abs=1e-10)


def test_a_settlement_of_a_turned_support_counts_along_its_axis() -> None:
    moved = np.array([-math.sin(SLOPE), math.cos(SLOPE)]) * -0.01
    found = linear(portal(displacement=moved.tolist()))
    assert found.displacement[3] @ moved / (moved @ moved) == pytest.approx(1.0, rel=1e-9)


def test_turned_springs_and_turned_axes_of_clamps() -> None:
    """A spring of k along a plane beside a roller on it; and axes of a support that holds both do nothing."""
    found = linear(beam(support_springs=[500.0, 0.0], fixed=[False, True]))
    along = np.array([math.cos(SLOPE), math.sin(SLOPE)])
    assert found.reaction[1] @ along == pytest.approx(-500.0 * (found.displacement[1] @ along), rel=1e-9)
    assert linear(portal(fixed=[True, True])).reaction == pytest.approx(
        linear(portal(fixed=[True, True], support_angle=0.0)).reaction, rel=1e-10
    )


@pytest.mark.parametrize("steps", [0.0, 1e-4])
def test_the_exact_equilibrium_slides_along_the_plane(steps: float) -> None:
    made = portal()
    if steps:  # as good as first order
        made.assign(
            list(made.rods), "distributed_force", [(0.0, -Q * steps if k == 1 else 0.0) for k in range(3)]
        )
        made.particles[1].force = (10.0 * steps, 0.0)
    exact, first = settle(made).final, linear(made)
    assert exact.status == "equilibrium"
    normal = np.array([-math.sin(SLOPE), math.cos(SLOPE)])
    assert exact.displacement[3] @ normal == pytest.approx(0.0, abs=1e-15)
    assert exact.reaction[3] @ [normal[1], -normal[0]] == pytest.approx(0.0, abs=1e-12)
    assert exact.reaction.sum(axis=0) == pytest.approx(first.reaction.sum(axis=0), rel=1e-9)
    if steps:
        assert exact.reaction == pytest.approx(first.reaction, rel=1e-3, abs=1e-9)


def test_turning_the_whole_structure_turns_the_answers() -> None:
    turned = np.array([[math.cos(-SLOPE), -math.sin(-SLOPE)], [math.sin(-SLOPE), math.cos(-SLOPE)]])
    one, other = portal(), portal(support_angle=0.0)
    for place in other.particles:
        place.position = tuple((turned @ place.position).tolist())
        place.force = tuple((turned @ place.force).tolist())
    for member in other.rods:
        member.distributed_force = tuple((turned @ member.distributed_force).tolist())
    assert linear(other).reaction == pytest.approx(linear(one).reaction @ turned.T, rel=1e-9, abs=1e-9)
    assert Buckling.of(other).factors == pytest.approx(Buckling.of(one).factors, rel=1e-9)
    assert Vibrations.of(other).hertz == pytest.approx(Vibrations.of(one).hertz, rel=1e-8)
    assert settle(other).final.reaction == pytest.approx(settle(one).final.reaction @ turned.T, abs=1e-8)


def test_a_mechanism_slides_along_the_plane() -> None:
    [motion] = mechanisms(beam(fixed=[False, False], support_angle=SLOPE, support_springs=[0.0, 0.0]))
    assert motion[1, 1] != 0.0
    loose = parse(
        model(
            [
                particle("A", 0, 0, fixed=[False, True], support_angle=SLOPE),
                particle("B", 2, 0, fixed=[False, True]),
            ],
            [rod("A", "B")],
        )
    )
    [motion] = mechanisms(loose)
    assert motion[0] == pytest.approx(motion[0, 0] * np.array([1.0, math.tan(SLOPE)]), abs=1e-12)


def test_motion_refuses_by_name() -> None:
    session = Session(beam())
    session.run(time=0.1)
    assert session.time == 0.0
    assert "Particle B: its support is turned by 30°" in session.message
    assert "statics" in session.message
