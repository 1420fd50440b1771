"""Loads between the ends of rods, against members divided at them, formulas of textbooks, fine meshes, and energy."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.components.bent import AXIAL, MOMENT, SHEAR, Station, deflections, inner_forces
from pinjoint.components.spans import extremes
from pinjoint.documents.document import parse
from pinjoint.systems.edit.dividing import divide
from pinjoint.systems.statics.theory import Indeterminacy, linear
from tests.reference import frame_theory
from tests.reference.span_loads import divided
from tests.verification.test_force_method_of_frames import checked, redundants
from tests.verification.test_frame_theory import free, held, random_frame

Document = dict[str, Any]
EI, EA = 2000.0, 2e5
DRAWN = {AXIAL: "end_axial_force", SHEAR: "shear", MOMENT: "bending_moment"}


def with_loads(seed: int) -> Document:
    """A random frame with loads between the ends of its rods, some of which do not bend."""
    document, lot = random_frame(seed), np.random.default_rng([seed, 7])
    place = {particle["name"]: np.array(particle["position"]) for particle in document["particles"]}
    document["span_loads"] = []
    for rod in document["rods"]:
        length = float(np.hypot(*np.subtract(*(place[name] for name in rod["between"]))))
        for _ in range(int(lot.integers(0, 3))):
            low, high = (length * np.sort(lot.choice(np.arange(1, 20), 2, replace=False)) / 20.0).tolist()
            load = {"rod": rod["name"], "start": low}
            load |= {"end": high} if lot.random() < 0.7 else {}
            load |= {"direction": "local"} if lot.random() < 0.3 else {}
            load |= {"start": 0.0} if lot.random() < 0.2 else {}
            for key, size in (("force", 20.0), ("start_intensity", 5.0), ("end_intensity", 5.0)):
                load |= {key: lot.normal(0.0, size, 2).tolist()} if lot.random() < 0.6 else {}
            load |= {"moment": float(lot.normal(0.0, 10.0))} if lot.random() < 0.4 and load["start"] else {}
            document["span_loads"].append(load)
    return document


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_random_frames_agree_with_members_divided_at_their_loads(seed: int) -> None:
    """Displacements, reactions, N, V and M at ends and where loads begin and end, on both sides, and deflections there."""
    document = with_loads(seed)
    session = Session.open(document)
    model = session.model
    if Indeterminacy.of(model).mechanisms:
        return
    reference, parts = divided(document)
    wanted = vars(frame_theory.solve(reference))
    size = {
        key: max(*(float(np.abs(value).max()) for value in of.values()), 1e-3) for key, of in wanted.items()
    }
    model.show(session.document.statics)

    def agree(found: Any, key: str, name: str, place: Any = ...) -> None:
        assert np.abs(np.asarray(found) - np.asarray(wanted[key][name])[place]).max() <= 1e-9 * size[key], (
            key,
            name,
        )

    for particle in model.particles:
        for key in ("displacement", "reaction", "reaction_moment"):
            agree(getattr(particle, key), key, particle.name)
    curves = {key: inner_forces(model, np.arange(model.rods.count), name) for name, key in DRAWN.items()}
    for row, rod in enumerate(model.rods):
        length, of_rod = rod.original_length, parts[rod.name]
        if rod.bending_stiffness > 0.0:
            agree(rod.end_rotation[0], "end_rotation", of_rod[0][1], 0)
            agree(rod.end_rotation[1], "end_rotation", of_rod[-1][1], 1)
        for number, (x, part) in enumerate(of_rod):
            until = of_rod[number + 1][0] if number + 1 < len(of_rod) else length
            for key, curve in curves.items():
                shares = np.array([np.nextafter(x / length, 1.0), np.nextafter(until / length, 0.0)])
                agree(curve.some(np.array([row])).at(shares)[0], key, part)
            if x > 0.0 and rod.bending_stiffness > 0.0:
                there, joint = Station.of(model, row, x), f"{rod.name} {number}"
                # Along it places move linearly.
                left = np.array([-rod.difference[1], rod.difference[0]]) / length
                away = left @ np.subtract(there.moved, wanted["displacement"][joint])
                assert abs(away) <= 1e-9 * size["displacement"], joint
                agree(there.rotation, "rotation", joint)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), parts=st.integers(2, 7))
def test_loads_travel_with_divide(seed: int, parts: int) -> None:
    """Divided members have the same displacements and reactions, and undo brings the loads back."""
    session = Session.open(with_loads(seed))
    model = session.model
    if Indeterminacy.of(model).mechanisms:
        return
    before = linear(model)
    loads = [tuple(load.force) for load in model.span_loads]
    divide(model, [rod for rod in model.rods if rod.bending_stiffness > 0.0], parts)
    after, count = linear(model), len(before.displacement)
    for name in ("displacement", "rotation", "reaction", "reaction_moment"):
        found, wanted = getattr(after, name)[:count], getattr(before, name)
        assert np.abs(found - wanted).max() <= 1e-8 * max(np.abs(wanted).max(), 1e-3), name
    session.undo()
    assert [tuple(load.force) for load in model.span_loads] == loads


@pytest.mark.parametrize("seed", range(15))
def test_the_force_method_superposes_them(seed: int) -> None:
    """By virtual work over moments that are no parabolas, with all unknowns."""
    made = parse(with_loads(seed))
    if not Indeterminacy.of(made).mechanisms:
        checked(made, redundants(made))


def simple(*loads: Document, **facts: Any) -> Document:
    """A simple beam of 4 m with these loads."""
    particles = [held("A", 0.0), {"name": "B", "position": [4.0, 0.0], "fixed": [False, True]}]
    rods = [{"name": "AB", "between": ["A", "B"], "stiffness": EA, "bending_stiffness": EI, **facts}]
    spans = [{"rod": "AB", **load} for load in loads]
    return {"format": "pinjoint model", "version": 1, "particles": particles, "rods": rods, "span_loads": spans}


def test_energy_is_conserved_in_motion() -> None:
    """A portal swings under forces and couples between the ends of its members, some hinged, one a bar."""
    document = frame()
    session = Session.open(document)
    session.run(time=0.2)
    energy = session.energy
    assert energy.kinetic > 0.1
    assert abs(energy.imbalance) <= 1e-6 * abs(energy.work)


def frame(parts: int = 1) -> Document:
    """A portal with a bar, that bends as far as the theory of beams lets it, without damping."""
    particles = [
        held("A", 0.0, 0.0, fixed_rotation=True),
        free("B", 0.0, 3.0, mass=20.0),
        free("C", 4.0, 3.0, mass=20.0),
        held("D", 4.0, 0.0),
    ]
    stiff = {"stiffness": 2e4, "bending_stiffness": 50.0, "damping": 0.0}
    rods = [
        {"name": "AB", "between": ["A", "B"], **stiff},
        {"name": "BC", "between": ["B", "C"], **stiff, "hinged": [False, True]},
        {"name": "CD", "between": ["C", "D"], **stiff},
        {"name": "AC", "between": ["A", "C"], "stiffness": 50.0, "damping": 0.0},
    ]
    loads = [
        {"rod": "AB", "start": 1.0, "force": [3.0, 0.0]},
        {"rod": "BC", "start": 0.5, "end": 3.0, "start_intensity": [1.0, -2.0], "end_intensity": [0.0, -5.0]},
        {"rod": "BC", "start": 2.5, "moment": 2.0},
        {"rod": "CD", "end_intensity": [0.0, -1.0], "direction": "local"},
        {"rod": "AC", "start": 2.0, "force": [0.0, -0.5], "moment": 0.3},
    ]
    facts = {"format": "pinjoint model", "version": 1, "settings": {"collisions": False}}
    return facts | {"particles": particles, "rods": rods, "span_loads": loads}


def test_a_run_comes_to_rest_where_exact_statics_says() -> None:
    document = frame()
    for rod in document["rods"]:
        rod["damping"] = 100.0
    document["environment"] = {"drag": 5.0}
    session = Session.open(document)
    state = session.statics(theory="exact").final
    session.run(until="rest")
    model = session.model
    assert np.abs(model.particles.displacement - state.displacement).max() <= 1e-6
    for name in ("shear", "bending_moment", "end_axial_force", "end_rotation"):
        assert np.abs(getattr(model.rods, name) - state.diagrams[name]).max() <= 1e-5, name


# --- formulas of textbooks, of beams clamped at both ends, and of the first of them at the other -----------------------

P, Q, M, L, A = 10.0, 6.0, 8.0, 4.0, 1.5
B = L - A
FIXED_END = [  # loads downwards, and M at the start and at the end, positive where the lower side is in tension
    ({"start": A, "force": [0.0, -P]}, -P * A * B**2 / L**2, -P * A**2 * B / L**2),
    ({"start": A, "moment": M}, -M * B / L**2 * (2 * A - B), M * A / L**2 * (2 * B - A)),
    ({"end_intensity": [0.0, -Q]}, -Q * L**2 / 30, -Q * L**2 / 20),
    (
        {"end": A, "start_intensity": [0.0, -Q], "end_intensity": [0.0, -Q]},
        -Q * A**2 / (12 * L**2) * (6 * L**2 - 8 * A * L + 3 * A**2),
        -Q * A**3 / (12 * L**2) * (4 * L - 3 * A),
    ),
    (
        {"start_intensity": [0.0, -2.0], "end_intensity": [0.0, -Q]},
        -(L**2) * (2.0 / 12 + (Q - 2.0) / 30),
        -(L**2) * (2.0 / 12 + (Q - 2.0) / 20),
    ),
]


@pytest.mark.parametrize(("load", "start", "end"), FIXED_END)
def test_fixed_end_moments(load: Document, start: float, end: float) -> None:
    """Of both ends clamped; with a hinge at the other end, M_s + M_e/2."""
    document = simple(load)
    for particle in document["particles"]:
        particle |= {"fixed": [True, True], "fixed_rotation": True}
    moment = linear(parse(document)).diagrams["bending_moment"][0]
    assert moment == pytest.approx([start, end], rel=1e-12)
    document["rods"][0]["hinged"] = [False, True]
    moment = linear(parse(document)).diagrams["bending_moment"][0]
    assert moment == pytest.approx([start + end / 2, 0.0], rel=1e-12)


@pytest.mark.parametrize("bends", [True, False])
def test_a_simple_beam_under_a_force(bends: bool) -> None:
    """M = Pab/L below it, V jumps, and the deflection there is Pa²b²/3EIL; a bar bears it, too."""
    session = Session.open(simple(FIXED_END[0][0], bending_stiffness=EI if bends else 0.0))
    model, one = session.model, np.array([0])
    model.show(session.document.statics)
    assert model.rods.largest_moment[0] == pytest.approx([P * A * B / L, A], rel=1e-12)
    shear = inner_forces(model, one, SHEAR).at(np.array([np.nextafter(A / L, 0.0), A / L]))
    assert shear[0] == pytest.approx([P * B / L, -P * A / L], rel=1e-12)
    sag = deflections(model, one).at(np.array([A / L]))[0, 0]
    assert sag == pytest.approx(-P * A**2 * B**2 / (3 * EI * L) if bends else 0.0, rel=1e-12)


@pytest.mark.parametrize(("place", "end"), [(0.0, 0), (L, 1)])
def test_what_acts_exactly_at_an_end_counts_in_all_that_is_told_there(place: float, end: int) -> None:
    """A simple beam with a couple and a force there: V = −M/L; the end has the couple and the force, and so have curves."""
    session = Session.open(simple({"start": place, "moment": M, "force": [0.0, -P]}))
    model, one = session.model, np.array([0])
    model.show(session.document.statics)
    rod = model.rods
    for name, curve in DRAWN.items():
        told, drawn = getattr(rod, curve)[0], inner_forces(model, one, name)
        assert drawn.at([0.0, 1.0])[0] == pytest.approx(told, rel=1e-12, abs=1e-12), curve
        both = extremes(drawn.stretches)[0][0]
        assert both == pytest.approx([min(*told, both[0]), max(*told, both[1])], rel=1e-12, abs=1e-12), curve
    sign = 1.0 - 2.0 * end
    assert rod.shear[0, end] == pytest.approx(M / L + sign * P)
    assert rod.shear[0, 1 - end] == pytest.approx(M / L)
    assert rod.bending_moment[0] == pytest.approx([0.0, 0.0], abs=1e-12)
    session.particles["AB"[end]].fixed_rotation = True
    model.show(session.document.statics)
    assert rod.bending_moment[0, end] == pytest.approx(sign * M)
    assert rod.largest_moment[0] == pytest.approx([sign * M, place])


def test_three_moments() -> None:
    """A beam of three spans under a trapezium, a force and a couple, against Clapeyron's equations."""
    spans, ei = (3.0, 4.0, 5.0), 2000.0
    places = np.cumsum([0.0, *spans])
    particles = [
        {"name": n, "position": [x, 0.0], "fixed": [n == "A", True]}
        for n, x in zip("ABCD", places, strict=True)
    ]
    rods = [{"name": n, "between": list(n), "bending_stiffness": ei} for n in ("AB", "BC", "CD")]
    loads = [
        {"rod": "AB", "start_intensity": [0.0, -2.0], "end_intensity": [0.0, -6.0]},
        {"rod": "BC", "start": 1.0, "force": [0.0, -P]},
        {"rod": "CD", "start": 2.0, "moment": M},
    ]
    facts = {"format": "pinjoint model", "version": 1}
    found = linear(parse(facts | {"particles": particles, "rods": rods, "span_loads": loads}))
    # 6EI × rotations of simple beams, by which their ends meet: at the end of AB, both of BC, the start of CD.
    one = 2.0 * 3.0**3 / 4 + 4.0 * 3.0**3 * 2 / 15
    two = [P * 1.0 * 3.0 * (4.0 + 3.0) / 4.0, P * 1.0 * 3.0 * (4.0 + 1.0) / 4.0]
    three = M / 5.0 * (5.0**2 - 3.0 * 3.0**2)  # M(L² − 3b²)/L, clockwise, of a couple counter-clockwise
    matrix = np.array([[2 * (3.0 + 4.0), 4.0], [4.0, 2 * (4.0 + 5.0)]])
    moments = np.linalg.solve(matrix, [-(one + two[0]), -(two[1] + three)])
    assert found.diagrams["bending_moment"][:, 0] == pytest.approx([0.0, *moments], rel=1e-9, abs=1e-9)


# --- exact geometry ----------------------------------------------------------------------------------------------------


def test_the_error_of_exact_geometry_falls_with_the_fourth_power_of_division() -> None:
    """A cantilever that bends far under a force and a trapezium, neither at a joint of any mesh: halves of halves."""
    tips = []
    for parts in (2, 4, 8, 16, 64):
        document = simple(
            {"start": 2.3, "force": [0.0, -25.0]},
            {"start": 0.7, "end": 3.1, "start_intensity": [2.0, -20.0], "end_intensity": [0.0, -40.0]},
            {"start": 1.9, "moment": 30.0},
        )
        document["particles"][0]["fixed_rotation"], document["particles"][1]["fixed"] = True, [False, False]
        document["rods"][0] |= {"bending_stiffness": 150.0, "stiffness": 1e6}
        session = Session.open(document)
        divide(session.model, list(session.model.rods), parts)
        state = session.statics(theory="exact").final
        assert state.status == "equilibrium"
        tips.append(state.displacement[1])
    errors = [float(np.hypot(*(tip - tips[-1]))) for tip in tips[:-1]]
    for coarse, fine in pairwise(errors):
        assert fine < coarse / 10.0


def test_trusses_bear_forces_and_couples_between_their_joints() -> None:
    """Bars are simple beams: joints feel forces by the lever rule, and of a couple M forces ±M/L across."""
    document = simple({"start": 1.0, "force": [0.0, -4.0]}, bending_stiffness=0.0)
    document["particles"].append({"name": "C", "position": [2.0, 2.0]})
    document["rods"] += [{"name": name, "between": list(name)} for name in ("AC", "BC")]
    document["span_loads"].append({"rod": "AC", "start": 0.7, "moment": 8.0})
    state = linear(parse(document))
    assert state.reaction[:2] == pytest.approx(np.array([[0.0, 3.0 + 2.0], [0.0, 1.0 - 2.0]]), abs=1e-9)
    across = 8.0 / math.sqrt(8.0)
    assert state.diagrams["shear"][1] == pytest.approx([across, across])
    assert state.diagrams["largest_moment"][1] == pytest.approx([across * 0.7 - 8.0, 0.7])
    for rod in document["rods"]:
        rod["damping"] = 200.0
    session = Session.open(document | {"settings": {"collisions": False}})
    exact = session.statics(theory="exact").final
    session.run(until="rest")
    assert session.model.particles.reaction == pytest.approx(exact.reaction, abs=1e-6)
