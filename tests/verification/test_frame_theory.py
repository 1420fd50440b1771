"""First-order answers of frames: an independent solver, and closed forms of textbooks."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint.commands.influence import influence
from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import StaticState
from pinjoint.systems.statics.theory import Indeterminacy, linear, mechanisms, self_stress
from pinjoint.systems.statics.unknowns import MethodError
from tests.reference import frame_theory
from tests.reference.models import model, rod

SEEDS = st.integers(0, 2**32 - 1)
ENDS = ("end_axial_force", "shear", "bending_moment", "end_rotation")
EI, EA = 4000.0, 8e5


def random_frame(seed: int, *, moves: bool = True) -> dict[str, Any]:
    """A frame of storeys and bays with braces, hinges, springs, warm members, loads and moved supports and clamps."""
    lot = np.random.default_rng(seed)
    bays, storeys = int(lot.integers(1, 4)), int(lot.integers(1, 4))
    particles: list[dict[str, Any]] = []
    for floor in range(storeys + 1):
        for bay in range(bays + 1):
            place = np.array([4.0 * bay, 3.0 * floor]) + lot.uniform(-0.5, 0.5, 2)
            facts: dict[str, Any] = {"name": f"P{floor}{bay}", "position": place.tolist()}
            if floor == 0:
                clamped = bool(lot.random() < 0.6) or bay == 0
                facts |= {"fixed": [True, True], "fixed_rotation": clamped}
                if moves:
                    facts["displacement"] = lot.normal(0.0, 0.01, 2).tolist()
                    facts["rotation"] = float(lot.normal(0.0, 0.002)) if clamped else 0.0
            facts["force"], facts["moment"] = lot.normal(0.0, 20.0, 2).tolist(), float(lot.normal(0.0, 10.0))
            particles.append(facts)
    rods: list[dict[str, Any]] = []

    def join(first: str, second: str, bends: bool) -> None:
        rod: dict[str, Any] = {"name": f"{first}-{second}", "between": [first, second]}
        rod["stiffness"] = float(10.0 ** lot.uniform(4.5, 6.5))
        rod["bending_stiffness"] = float(10.0 ** lot.uniform(2.5, 4.5)) if bends else 0.0
        rod["hinged"] = [bool(lot.random() < 0.12), bool(lot.random() < 0.12)]
        rod["distributed_force"] = lot.normal(0.0, 5.0, 2).tolist()
        rod["temperature_change"], rod["temperature_gradient"] = lot.normal(0.0, 30.0, 2).tolist()
        rods.append(rod)

    for floor in range(storeys + 1):
        for bay in range(bays + 1):
            if floor:
                join(f"P{floor - 1}{bay}", f"P{floor}{bay}", bends=True)
            if floor and bay:
                join(f"P{floor}{bay - 1}", f"P{floor}{bay}", bends=True)
                join(f"P{floor - 1}{bay - 1}", f"P{floor}{bay}", bends=False)
    for facts in rods:
        facts["end_springs"] = (10.0 ** lot.uniform(2.0, 4.0, 2) * (lot.random(2) < 0.2)).tolist()
    for facts in particles:
        free = [not held for held in (*facts.get("fixed", (False, False)), facts.get("fixed_rotation", False))]
        x, y, turning = (10.0 ** lot.uniform(2.0, 4.0, 3) * (lot.random(3) < 0.15) * free).tolist()
        facts |= {"support_springs": [x, y], "rotation_spring": turning}
        facts["support_angle"] = float(lot.uniform(-1.0, 1.0) * (lot.random() < 0.3))
    return model(particles, rods)


def agrees(document: dict[str, Any], found: StaticState, made: Model, *, within: float = 1e-9) -> None:
    """Every quantity, relative to the largest of its kind, at least 1e-3."""
    wanted = frame_theory.solve(document)
    names, rods = made.particles.names, made.rods.names
    columns: dict[str, Any] = {"displacement": found.displacement, "reaction": found.reaction}
    columns |= {"rotation": found.rotation, "reaction_moment": found.reaction_moment}
    pairs = [(values, [getattr(wanted, key)[name] for name in names], key) for key, values in columns.items()]
    pairs += [(found.diagrams[key], [getattr(wanted, key)[name] for name in rods], key) for key in ENDS]
    for values, expected, key in pairs:
        size = max(float(np.abs(expected).max()), 1e-3)
        assert np.abs(values - np.array(expected)).max() <= within * size, key


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS)
def test_random_frames_agree_with_an_independent_solver(seed: int) -> None:
    document = random_frame(seed)
    made = parse(document)
    degrees, count = Indeterminacy.of(made), Count.of(made)
    assert count.degree == degrees.static - degrees.mechanisms
    if not degrees.mechanisms:
        agrees(document, linear(made), made)


def held(name: str, x: float, y: float = 0.0, **facts: Any) -> dict[str, Any]:
    """A support: pinned, unless facts say otherwise."""
    return {"name": name, "position": [x, y], "fixed": [True, True], **facts}


def free(name: str, x: float, y: float = 0.0, **facts: Any) -> dict[str, Any]:
    return {"name": name, "position": [x, y], **facts}


def beam(name: str, **facts: Any) -> dict[str, Any]:
    """A rod AB between A and B that bends."""
    rod = {"stiffness": EA, "bending_stiffness": EI}
    return {"name": name, "between": list(name), **rod, **facts}


def answered(particles: list[dict[str, Any]], rods: list[dict[str, Any]]) -> tuple[Model, StaticState]:
    """A model and its linear answer, which agrees with the independent solver."""
    document = model(particles, rods)
    made = parse(document)
    found = linear(made)
    agrees(document, found, made)
    return made, found


def test_a_cantilever_under_a_tip_load() -> None:
    length, force = 3.0, -12.0
    clamp = held("A", 0.0, fixed_rotation=True)
    _, found = answered([clamp, free("B", length, force=[0.0, force])], [beam("AB")])
    assert found.displacement[1, 1] == pytest.approx(force * length**3 / (3.0 * EI), rel=1e-12)
    assert found.rotation[1] == pytest.approx(force * length**2 / (2.0 * EI), rel=1e-12)
    assert found.reaction_moment[0] == pytest.approx(-force * length, rel=1e-12)
    assert found.diagrams["bending_moment"][0] == pytest.approx([force * length, 0.0], abs=1e-10)
    assert found.diagrams["largest_moment"][0] == pytest.approx([force * length, 0.0], abs=1e-10)


def test_a_propped_cantilever_under_its_weight() -> None:
    """M = qL²/8 at the clamp, 3qL/8 on the prop, largest in the span 9qL²/128 at 3L/8 from the prop."""
    length, load = 4.0, 7.0
    particles = [held("A", 0.0, fixed_rotation=True), held("B", length, fixed=[False, True])]
    _, found = answered(particles, [beam("AB", distributed_force=[0.0, -load])])
    assert found.diagrams["bending_moment"][0] == pytest.approx([-load * length**2 / 8.0, 0.0], abs=1e-10)
    assert found.reaction[1] == pytest.approx([0.0, 3.0 * load * length / 8.0], abs=1e-10)
    assert found.rotation[1] == pytest.approx(load * length**3 / (48.0 * EI), rel=1e-12)
    assert found.diagrams["largest_moment"][0] == pytest.approx([-load * length**2 / 8.0, 0.0], abs=1e-10)


def test_a_simply_supported_beam_with_a_moment_in_the_span() -> None:
    """qL²/8 at the middle, found inside one rod."""
    length, load = 4.0, 7.0
    particles = [held("A", 0.0), held("B", length, fixed=[False, True])]
    _, found = answered(particles, [beam("AB", distributed_force=[0.0, -load])])
    assert found.diagrams["largest_moment"][0] == pytest.approx(
        [load * length**2 / 8.0, length / 2.0], rel=1e-12
    )
    assert found.diagrams["end_rotation"][0] == pytest.approx(
        np.array([-1.0, 1.0]) * load * length**3 / (24.0 * EI), rel=1e-12
    )


def test_a_beam_whose_ends_springs_hold() -> None:
    """M = qL²/12 / (1 + 2EI/kL); the ends turn by M/k. With one clamp, by the method of forces."""
    length, load, spring = 6.0, -8.0, 900.0
    full, soft = load * length**2 / 12.0, EI / (spring * length)
    made, found = answered(
        [held("A", 0, fixed_rotation=True), held("B", length, fixed_rotation=True)],
        [beam("AB", end_springs=[spring, spring], distributed_force=[0.0, load])],
    )
    moment = full / (1.0 + 2.0 * soft)
    assert made.rods.fixity == pytest.approx(1.0 / (1.0 + 3.0 * soft))
    assert found.diagrams["bending_moment"][0] == pytest.approx([moment, moment], rel=1e-12)
    assert found.diagrams["end_rotation"][0] == pytest.approx([moment / spring, -moment / spring], rel=1e-12)
    found = answered(
        [held("A", 0, fixed_rotation=True), held("B", length, fixed_rotation=True)],
        [beam("AB", end_springs=[0.0, spring], distributed_force=[0.0, load])],
    )[1]
    far = full / (1.0 + 4.0 * soft)
    assert found.diagrams["bending_moment"][0, 1] == pytest.approx(far, rel=1e-12)
    assert found.diagrams["bending_moment"][0, 0] == pytest.approx(1.5 * full - 0.5 * far, rel=1e-12)


def test_a_three_hinged_arch() -> None:
    """H = ql²/(8f) under the same load on every metre of the ground, and no moment anywhere if it is a parabola."""
    span, rise, load, parts = 20.0, 5.0, 8.0, 16
    x = np.linspace(0.0, span, parts + 1)
    y = 4.0 * rise * x * (span - x) / span**2
    particles = [free(f"P{i}", *at) for i, at in enumerate(zip(x.tolist(), y.tolist(), strict=True))]
    for foot in (particles[0], particles[-1]):
        foot["fixed"] = [True, True]
    rods = []
    for i in range(parts):
        way = math.hypot(x[i + 1] - x[i], y[i + 1] - y[i])
        facts = {
            "distributed_force": [0.0, -load * (x[i + 1] - x[i]) / way],
            "hinged": [i == parts // 2, False],
        }
        rods.append(rod(f"P{i}", f"P{i + 1}", stiffness=EA, bending_stiffness=EI, **facts))
    made, found = answered(particles, rods)
    assert Indeterminacy.of(made).static == 0
    thrust = load * span**2 / (8.0 * rise)
    assert found.reaction[[0, -1], 0] == pytest.approx([thrust, -thrust], rel=1e-9)
    assert found.diagrams["bending_moment"] == pytest.approx(0.0, abs=1e-7 * thrust)


def test_a_clamp_that_turns_and_a_support_that_sinks() -> None:
    """4EI/L θ and 2EI/L θ; 6EI/L² w."""
    length, turn, drop = 5.0, 1e-3, 2e-3
    particles = [
        held("A", 0.0, fixed_rotation=True, rotation=turn),
        held("B", length, fixed_rotation=True, displacement=[0.0, -drop]),
    ]
    _, found = answered(particles, [beam("AB")])
    sunk = 6.0 * EI * drop / length**2
    assert found.reaction_moment == pytest.approx(
        [4.0 * EI * turn / length + sunk, 2.0 * EI * turn / length + sunk]
    )


def test_a_warm_side_bends_what_is_free_and_stresses_what_is_held() -> None:
    """κ = −α ΔT/h; the free tip moves by κL²/2 without a moment, the clamped beam bears −EI κ."""
    length, gradient = 4.0, 50.0
    curvature = -1.2e-5 * gradient
    clamp = held("A", 0.0, fixed_rotation=True)
    _, found = answered([clamp, free("B", length)], [beam("AB", temperature_gradient=gradient)])
    assert found.displacement[1, 1] == pytest.approx(curvature * length**2 / 2.0, rel=1e-12)
    assert found.diagrams["bending_moment"] == pytest.approx(0.0, abs=1e-12)
    other = held("B", length, fixed_rotation=True)
    _, found = answered([clamp, other], [beam("AB", temperature_gradient=gradient)])
    assert found.diagrams["bending_moment"][0] == pytest.approx([-EI * curvature] * 2, rel=1e-12)


@pytest.mark.parametrize("hinged", [[False, False], [True, False]])
def test_influence_lines_are_what_a_moved_load_does(hinged: list[bool]) -> None:
    """Of moments, shears, clamps and rotations: the answers of first-order theory for a force at each place in turn."""
    particles = [
        held("A", 0.0, fixed_rotation=True),
        free("B", 0.0, 3.0),
        free("C", 2.0, 3.5),
        free("D", 4.0, 3.0),
        held("E", 4.0),
    ]
    rods = [beam("AB"), beam("BC", hinged=hinged), beam("CD"), beam("DE")]
    parts = {"start": ("bending_moment", 0), "end": ("bending_moment", 1), "shear": ("shear", 0)}
    names = [f"{rod}.{part}" for rod in ("AB", "BC", "DE") for part in parts]
    names = [name for name in names if not (hinged[0] and name == "BC.start")]
    names += ["A.rotation", "B.rotation", "C.y", "E.x", "BC"]
    made = parse(model(particles, rods))
    lines = influence(made, names)["influence"]
    for at, axis in [("B", 0), ("C", 0), ("C", 1), ("D", 1)]:
        unit = [
            p | {"force": [float(axis == 0), float(axis == 1)]} if p["name"] == at else p for p in particles
        ]
        answer = linear(parse(model(unit, rods)))
        for name in names:
            place, _, what = name.rpartition(".")
            if what in parts:
                quantity, end = parts[what]
                expected = answer.diagrams[quantity][made.rods[place].row, end]
            elif what == "rotation":
                of = answer.reaction_moment if place == "A" else answer.rotation
                expected = of[made.particles[place].row]
            elif place:
                of = answer.reaction if place == "E" else answer.displacement
                expected = of[made.particles[place].row, "xy".index(what)]
            else:
                expected = answer.axial_force[made.rods[name].row]
            assert lines[name]["of"][at][axis] == pytest.approx(expected, rel=1e-9, abs=1e-11)
    if hinged[0]:
        with pytest.raises(MethodError, match=r"BC\.start is hinged, so there is no bending moment"):
            influence(made, ["BC.start"])


def test_a_beam_with_a_hinge_too_many_is_a_mechanism() -> None:
    """It is named, moves without bending a rod, and the load on it has no linear answer."""
    particles = [
        held("A", 0.0, fixed_rotation=True),
        free("B", 2.0, force=[0.0, -1.0]),
        free("C", 4.0),
        held("D", 6.0, fixed=[False, True]),
    ]
    rods = [beam("AB"), beam("BC", hinged=[True, False]), beam("CD", hinged=[True, False])]
    made = parse(model(particles, rods))
    degrees = Indeterminacy.of(made)
    assert (degrees.static, degrees.mechanisms) == (0, 1)
    assert Count.of(made).degree == -1
    assert Count.of(made).numbers == "3·3 + 4 − 3·4 − 2 = −1"
    (motion,) = mechanisms(made)
    assert motion[:, 1] == pytest.approx([0.0, 0.0, 1.0, 0.0], abs=1e-12)
    assert np.abs(motion[:, 2]) == pytest.approx([0.0, 0.0, 0.5, 0.5], abs=1e-12)
    with pytest.raises(NoEquilibrium, match="Mechanism: the load moves C along y"):
        linear(parse(model([*particles[:2], {**particles[2], "force": [0.0, -1.0]}, particles[3]], rods)))
    assert linear(made).displacement[1, 1] == pytest.approx(-(2.0**3) / (3.0 * EI), rel=1e-9)


def test_states_of_self_stress_balance_every_joint() -> None:
    """A square of rigid corners, free: three states, each in balance by the forces and moments that it names."""
    corners = [("A", 0.0, 0.0), ("B", 3.0, 0.0), ("C", 3.0, 2.0), ("D", 0.0, 2.0)]
    made = parse(
        model([free(*corner) for corner in corners], [beam(name) for name in ("AB", "BC", "CD", "DA")])
    )
    states = self_stress(made)
    degrees = Indeterminacy.of(made)
    assert (degrees.static, degrees.internal, degrees.mechanisms, len(states)) == (3, 3, 3, 3)
    first, second = made.rods.between.astype(int).T
    axis = made.rods.difference / made.rods.original_length[:, None]
    left = np.stack([-axis[:, 1], axis[:, 0]], axis=1)
    for state in states:
        force, moment = state[:4], state[4:].reshape(4, 2)
        pull = force[:, None] * axis - (moment.sum(axis=1) / made.rods.original_length)[:, None] * left
        left_over, turning = np.zeros((4, 2)), np.zeros(4)
        np.add.at(left_over, first, pull)
        np.add.at(left_over, second, -pull)
        np.add.at(turning, made.rods.between.astype(int).ravel(), moment.ravel())
        assert np.abs(left_over).max() < 1e-12
        assert np.abs(turning).max() < 1e-12


def test_bars_bear_distributed_forces_at_both_ends() -> None:
    """A truss of two bars under their weight per metre of 3 kN: half of each hangs on their joint."""
    particles = [held("A", -4.0, 3.0), free("B", 0.0), held("C", 4.0, 3.0)]
    bar = {"stiffness": 1e6, "distributed_force": [0.0, -3.0]}
    made = parse(model(particles, [{"name": name, "between": list(name), **bar} for name in ("AB", "BC")]))
    found = linear(made)
    assert found.axial_force == pytest.approx([12.5, 12.5], rel=1e-12)  # 15 kN at B, on bars of slope 3:5
    assert found.reaction[:, 1].sum() == pytest.approx(30.0, rel=1e-12)
    assert settle(made).final.reaction[:, 1].sum() == pytest.approx(30.0, rel=1e-12)
    assert np.abs(found.diagrams["largest_moment"][:, 0]) == pytest.approx(3.0 * 5.0**2 / 8.0 * 0.8, rel=1e-12)
