"""Elastic supports and springs at the ends of rods: closed forms, all theories, motion, edits and files."""

import json
import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.components.model import Model
from pinjoint.documents.models import document, parse
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import (
    FirstOrder,
    Indeterminacy,
    influence_line,
    linear,
    mechanisms,
    self_stress,
)
from pinjoint.systems.statics.unknowns import Unknown, redundants
from pinjoint.systems.statics.vibration import Vibrations
from tests.reference.frames import least_energy
from tests.reference.models import model, particle, rod

EI, EA, Q = 4000.0, 8e5, 10.0
BENDS = {"stiffness": EA, "bending_stiffness": EI}
PINNED, ROLLER = {"fixed": [True, True]}, {"fixed": [False, True]}


def two_spans(spring: float, **facts: Any) -> Model:
    """A beam of two spans of 5 m under q, its middle on a spring."""
    middle = particle("B", 5, 0, support_springs=[0, spring], **facts)
    rods = [rod(*ends, distributed_force=[0, -Q], **BENDS) for ends in ("AB", "BC")]
    return parse(model([particle("A", 0, 0, **PINNED), middle, particle("C", 10, 0, **ROLLER)], rods))


def test_a_beam_on_a_spring_in_the_middle() -> None:
    """R = (5qL⁴/384EI) / (L³/48EI + 1/k), with L = 10 m."""
    for spring in (1.0, 300.0, 1e6):
        found = linear(two_spans(spring))
        sunk, soft = 5.0 * Q * 10.0**4 / (384.0 * EI), 10.0**3 / (48.0 * EI)
        answer = sunk / (soft + 1.0 / spring)
        assert found.reaction[1] == pytest.approx([0.0, answer], rel=1e-10, abs=1e-9)
        assert found.displacement[1, 1] == pytest.approx(-answer / spring, rel=1e-9)
        assert found.diagrams["bending_moment"][0, 1] == pytest.approx(Q * 100.0 / 8.0 - answer * 2.5, rel=1e-9)
        assert found.reaction[:, 1].sum() == pytest.approx(Q * 10.0, rel=1e-12)


def test_a_cantilever_whose_clamp_gives_way() -> None:
    """θ = PL/k and u = PL³/3EI + θL; the energy is half the work of the load."""
    tip = particle("B", 3, 0, force=[0, -6.0])
    made = parse(model([particle("A", 0, 0, rotation_spring=700.0, **PINNED), tip], [rod("A", "B", **BENDS)]))
    found = linear(made)
    assert found.rotation[0] == pytest.approx(-18.0 / 700.0, rel=1e-12)
    assert found.displacement[1, 1] == pytest.approx(-6.0 * 27.0 / (3.0 * EI) - 3.0 * 18.0 / 700.0, rel=1e-12)
    assert found.reaction_moment[0] == pytest.approx(18.0, rel=1e-12)
    assert found.elastic_energy == pytest.approx(500.0 * 6.0 * -found.displacement[1, 1], rel=1e-12)


def test_springs_count_as_supports() -> None:
    made = two_spans(300.0)
    degrees, count = Indeterminacy.of(made), Count.of(made)
    assert (degrees.static, degrees.internal, degrees.external, degrees.mechanisms) == (1, 0, 1, 0)
    assert (count.degree, count.constraints) == (1, 4)
    assert self_stress(made).shape == (1, 6)
    loose = parse(
        model([particle("A", 0, 0, support_springs=[9.0, 9.0]), particle("B", 1, 0)], [rod("A", "B")])
    )
    assert len(mechanisms(loose)) == 1, "it turns about A"
    assert Indeterminacy.of(loose).static == 0


def test_the_force_method_takes_springs_as_redundants_and_as_parts() -> None:
    made = two_spans(300.0)
    answer = linear(made)
    released = solve(made, [Unknown.named(made, "B.y")])
    assert released.force == pytest.approx([answer.reaction[1, 1]], rel=1e-10)
    assert released.flexibility[0, 0] == pytest.approx(10.0**3 / (48.0 * EI) + 1.0 / 300.0, rel=1e-12)
    assert released.gap == pytest.approx([-5.0 * Q * 10.0**4 / (384.0 * EI)], rel=1e-12)
    assert released.delta_real == pytest.approx([answer.displacement[1, 1]], rel=1e-9)
    assert (released.delta_real - released.delta_base) / released.delta_unit[0] == pytest.approx(released.force)
    inside = solve(made, [Unknown.named(made, "AB.end")])
    assert inside.force == pytest.approx([answer.diagrams["bending_moment"][0, 1]], rel=1e-10)
    assert inside.superposed.reaction[:, 1] == pytest.approx(answer.reaction[:, 1], rel=1e-10)
    assert len(redundants(made)) == 1


def test_semi_rigid_ends_in_the_force_method() -> None:
    """A clamped beam with springs k at its ends: δ = L/3EI + 1/k."""
    clamped = {"fixed_rotation": True, **PINNED}
    beam = rod("A", "B", end_springs=[900.0, 400.0], distributed_force=[0, -Q], **BENDS)
    made = parse(model([particle("A", 0, 0, **clamped), particle("B", 6, 0, **clamped)], [beam]))
    found = solve(made, [Unknown.named(made, name) for name in ("AB.start", "AB.end")])
    wanted = np.array([[2.0, 1.0], [1.0, 2.0]]) / EI + np.diag([1 / 900.0, 1 / 400.0])
    assert found.flexibility == pytest.approx(wanted, rel=1e-12)
    assert found.force == pytest.approx(linear(made).diagrams["bending_moment"][0], rel=1e-10)


def test_influence_of_loads_on_a_spring() -> None:
    made = two_spans(300.0)
    line = influence_line(FirstOrder.of(made), "reaction", 1, 1)
    for row in (0, 1, 2):
        loaded = two_spans(300.0)
        loaded.assign(list(loaded.rods), "distributed_force", [(0.0, 0.0)] * 2)
        loaded.particles[row].force = (0.0, 1.0)
        assert line[row, 1] == pytest.approx(linear(loaded).reaction[1, 1], abs=1e-12)


def test_a_column_on_a_rotation_spring_buckles() -> None:
    """Against turning by a spring: kL tan kL = cL/EI, P = k²EI, sideways free; four rods."""
    length, spring = 4.0, 2000.0
    low, high = 0.0, 0.5 * math.pi
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if middle * math.tan(middle) < spring * length / EI else (low, middle)
    column = [particle("N0", 0, 0, rotation_spring=spring, **PINNED)]
    column += [particle(f"N{k}", 0, k, force=[0, -1.0 if k == 4 else 0.0]) for k in (1, 2, 3, 4)]
    rods = [rod(f"N{k}", f"N{k + 1}", name=str(k), stiffness=1e9, bending_stiffness=EI) for k in range(4)]
    found = Buckling.of(parse(model(column, rods)))
    assert found.factors[0] == pytest.approx(low**2 * EI / length**2, rel=1e-4)


def test_a_rigid_beam_swings_on_its_springs() -> None:
    """A mass M on two springs: ω² = 2k/M; statics about it, and motion, know the same frequency."""
    ends = [particle(n, x, 0, support_springs=[1e4, 50.0], mass=100.0) for n, x in (("A", 0), ("B", 2))]
    made = parse(model(ends, [rod("A", "B", density=0.0)]))
    assert Vibrations.of(made).angular_squared[0] == pytest.approx(1000.0 * 50.0 / 100.0, rel=1e-9)


def frame() -> dict[str, Any]:
    """A portal with elastic supports and semi-rigid ends, under loads, without dampers."""
    quiet = {"damping": 0.0, "bending_damping": 0.0, "density": 20.0, "stiffness": 8e4, "bending_stiffness": EI}
    particles = [
        particle("A", 0, 0, fixed=[True, False], support_springs=[0, 300.0], rotation_spring=500.0),
        particle("B", 0, 3),
        particle("C", 5, 3, force=[5.0, -10.0]),
        particle("D", 5, 0, support_springs=[200.0, 400.0]),
    ]
    rods = [rod("A", "B", **quiet), rod("B", "C", end_springs=[300.0, 800.0], **quiet), rod("C", "D", **quiet)]
    return model(particles, rods, settings={"collisions": False})


@pytest.mark.parametrize(
    ("integrator", "share"), [("dop853", 1e-9), ("esdirk4", 1e-9), ("velocity_verlet", 1e-4), ("rk4", 1e-5)]
)
def test_energy_is_kept_in_motion(integrator: str, share: float) -> None:
    made = frame()
    made["settings"]["integrator"] = integrator
    session = Session.open(made)
    session.run(time=0.2)
    energy = session.energy
    assert energy.elastic > 10.0
    assert abs(energy.imbalance) <= share * (energy.elastic + energy.kinetic)
    moved, reaction = session.particles["D"].displacement, session.particles["D"].reaction
    assert reaction == pytest.approx([-200.0 * moved[0], -400.0 * moved[1]], rel=1e-12)
    assert session.particles["D"].applied_force == (0.0, 0.0)


def test_the_exact_equilibrium_has_the_least_energy_and_ends_the_motion() -> None:
    made = frame()
    exact = settle(parse(made)).final
    assert exact.status == "equilibrium"
    place, turned = least_energy(parse(made))
    assert exact.displacement == pytest.approx(place, abs=1e-9)
    assert exact.rotation == pytest.approx(turned, abs=1e-9)
    for facts in made["rods"]:
        facts |= {"damping": 300.0, "bending_damping": 3.0}
    session = Session.open(made)
    session.run(until="rest")
    assert np.array([one.displacement for one in session.particles]) == pytest.approx(place, abs=1e-6)


def test_a_mass_on_a_spring_swings_without_rods() -> None:
    made = model([particle("A", 0, 0, mass=2.0, support_springs=[0.0, 50.0], displacement=[0.0, 0.1])], [])
    session = Session.open(made)
    session.run(time=0.5 * math.pi / math.sqrt(50000.0 / 2.0))
    assert session.particles["A"].displacement[1] == pytest.approx(0.0, abs=1e-9)
    assert session.particles["A"].velocity[1] == pytest.approx(-0.1 * math.sqrt(25000.0), rel=1e-9)


def test_programs_of_models_without_springs_are_as_before() -> None:
    without, sprung = frame(), frame()
    for one in without["particles"]:
        one |= {"support_springs": [0.0, 0.0], "rotation_spring": 0.0}
    sources = [Session.open(made).simulation.programs.compiled.source for made in (without, sprung)]
    assert "support_springs" not in sources[0]
    assert "support_springs" in sources[1]


def test_a_direction_has_a_rigid_support_or_a_spring() -> None:
    session = Session.open(frame())
    place = session.particles["D"]
    with pytest.raises(FieldError, match=r"rigid support holds it.*free the direction"):
        session.particles["A"].support_springs = (10.0, 300.0)
    place.fixed = (True, False)
    assert place.support_springs == (0.0, 400.0)
    session.undo()
    assert (place.fixed, place.support_springs) == ((False, False), (200.0, 400.0))
    given = frame()
    given["particles"][3]["fixed"] = [True, True]
    with pytest.raises(ValueError, match=r"particle D.*support"):
        parse(given)


def test_menus_put_supports_and_ends_on_springs_and_back() -> None:
    session = Session.open(frame())
    one, beam = session.particles["A"], session.rods["AB"]
    one.rotation_spring = 0.0
    one.fixed, one.fixed_rotation = (True, True), True
    session.select(one)
    session.act("springs")
    assert (one.fixed, one.support_springs, one.rotation_spring) == ((False, False), (1000.0, 1000.0), 1000.0)
    session.act("springs")
    assert (one.fixed, one.fixed_rotation, one.support_springs) == ((True, True), True, (0.0, 0.0))
    session.act("springs")
    session.act("pin")
    assert (one.fixed, one.support_springs, one.rotation_spring) == ((True, True), (0.0, 0.0), 0.0)
    session.select(beam)
    session.act("end springs")
    assert beam.end_springs == (1000.0, 1000.0)
    session.act("rigid")
    assert (beam.end_springs, beam.hinged) == ((0.0, 0.0), (False, False))


def test_files_keep_springs_and_are_as_before_without() -> None:
    made = parse(frame())
    again = json.loads(json.dumps(document(made)))
    assert again["particles"][3]["support_springs"] == [200.0, 400.0]
    assert again["rods"][1]["end_springs"] == [300.0, 800.0]
    assert "support_springs" not in again["particles"][1]
    assert "end_springs" not in again["rods"][0]
