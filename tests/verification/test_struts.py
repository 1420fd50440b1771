"""Struts: rods between hinges that buckle by an axial law, in statics, in motion, drawn, and beside other laws."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.bent import deflections, inner_forces
from pinjoint.documents import models
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.settle import settle
from tests.reference.elastica import pinned_column
from tests.reference.elements import Model as Document
from tests.reference.models import model, particle, random_truss, rod

HELD = {"fixed": [True, True]}
STRUT = {"hinged": [True, True], "buckles": True}
EI, LENGTH = 50.0, 2.0
EULER = math.pi**2 * EI / LENGTH**2


def column(push: float = 0.0, **properties: Any) -> Document:
    """A vertical strut on a hinge, its top guided and pushed down."""
    top = particle("B", 0, LENGTH, fixed=[True, False], force=[0.0, -push])
    facts = STRUT | {"stiffness": 1e5, "bending_stiffness": EI} | properties
    return model([particle("A", 0, 0, **HELD), top], [rod("A", "B", **facts)])


def strutted(seed: int, share: float = 0.6) -> Document:
    """A redundant truss drawn by lot in which some compressed rods buckle."""
    document = random_truss(seed, nodes=7, redundant=4, load=300.0)
    lot = np.random.default_rng(seed)
    forces = settle(models.load(document), theory="first-order").final.axial_force
    places = {p["name"]: p["position"] for p in document["particles"]}
    for each, force in zip(document["rods"], forces.tolist(), strict=True):
        length = math.dist(*(places[name] for name in each["between"]))
        limit = share * lot.uniform(0.5, 2.0) * max(-force, 50.0)
        each |= STRUT | {"bending_stiffness": limit * length**2 / math.pi**2}
    return document


@pytest.mark.parametrize(("shortening", "within"), [(0.001, 1e-6), (0.01, 3e-5), (0.05, 7.5e-4), (0.1, 3.2e-3)])
def test_a_strut_against_the_elastica(shortening: float, within: float) -> None:
    document = column(stiffness=1e11)
    document["particles"][1] |= {"fixed": [True, True], "displacement": [0.0, -shortening * LENGTH]}
    made = models.load(document)
    state = settle(made).final
    force, deflection = pinned_column(shortening)
    assert -state.axial_force[0] / EULER == pytest.approx(force, rel=within)
    state.put(made)
    made.give("rods.strain", state.strain)
    assert made.rods["AB"].lateral_deflection / LENGTH == pytest.approx(deflection, rel=shortening)
    assert abs(deflections(made, np.array([0])).at(np.array([0.5]))[0, 0]) == pytest.approx(
        made.rods["AB"].lateral_deflection, rel=1e-12
    )


def test_in_first_order_it_bears_its_buckling_load_and_collapses_there() -> None:
    found = settle(models.load(column(1.25 * EULER)), theory="first-order")
    assert found.status == "collapse"
    assert [(event.kind, event.rods) for event in found.events] == [
        ("buckling", ("AB",)),
        ("collapse", ("AB",)),
    ]
    assert [event.load_factor for event in found.events] == pytest.approx([0.8, 0.8], rel=1e-9)


def test_beyond_it_bends_aside_and_stores_the_work() -> None:
    push = 1.01 * EULER
    made = models.load(column(push))
    found = settle(made, (1.0, 0.0))
    loaded, unloaded = found.states
    r = 0.02
    assert loaded.axial_force[0] == pytest.approx(-push, rel=1e-12)
    assert loaded.displacement[1, 1] == pytest.approx(-LENGTH * (r + EULER / 1e5), rel=1e-9)
    straight = 500.0 * EULER**2 * LENGTH / 1e5
    assert loaded.elastic_energy == pytest.approx(
        straight + 1000.0 * EULER * LENGTH * (r + r * r / 4), rel=1e-9
    )
    assert [event.kind for event in found.events] == ["buckling", "straight"]
    assert unloaded.displacement == pytest.approx(0.0, abs=1e-12)


def test_a_stocky_one_yields_and_a_slender_one_never_does() -> None:
    stocky = settle(models.load(column(1.5 * EULER, compressive_strength=0.9 * EULER)), theory="first-order")
    assert [event.kind for event in stocky.events] == ["yield", "collapse"]
    assert stocky.final.load_factor == pytest.approx(0.6, rel=1e-9)
    slender = settle(models.load(column(1.02 * EULER, compressive_strength=1.1 * EULER)))
    assert [event.kind for event in slender.events] == ["buckling"]
    assert slender.final.plastic_strain[0] == 0.0
    pulled = settle(models.load(column(-EULER, tensile_strength=0.5 * EULER)), theory="first-order")
    assert [event.kind for event in pulled.events] == ["yield", "collapse"]


@settings(max_examples=12)
@given(seed=st.integers(0, 10_000))
def test_struts_of_trusses_obey_their_law_and_balance(seed: int) -> None:
    """Independently of the engine: N of each rod by its length alone, and forces at nodes, in both theories."""
    document = strutted(seed)
    names = [p["name"] for p in document["particles"]]
    places = np.array([p["position"] for p in document["particles"]])
    load = np.array([p.get("force", [0.0, 0.0]) for p in document["particles"]])
    free = ~np.array([p.get("fixed", [False, False]) for p in document["particles"]])
    for theory in ("exact", "first-order"):
        found = settle(models.load(document), theory=theory)
        if found.status != "equilibrium":
            continue
        unbalanced = load.copy()
        for each, force in zip(document["rods"], found.final.axial_force.tolist(), strict=True):
            a, b = (names.index(name) for name in each["between"])
            start, end = places[a], places[b]
            length, moved = math.dist(start, end), found.final.displacement[[a, b]]
            axis = (end - start) / length
            longer = float(axis @ (moved[1] - moved[0]))
            if theory == "exact":
                present = end + moved[1] - start - moved[0]
                longer, axis = math.hypot(*present) - length, present / math.hypot(*present)
            stiffness, euler = each["stiffness"], math.pi**2 * each["bending_stiffness"] / length**2
            r = -longer / length - euler / stiffness
            law = (
                -euler * (1.0 + (r / 2 if theory == "exact" else 0.0)) if r > 0 else stiffness * longer / length
            )
            assert force == pytest.approx(law, rel=1e-7, abs=1e-6)
            unbalanced[a] += force * axis
            unbalanced[b] -= force * axis
        assert np.abs(unbalanced[free]).max() < 1e-6


@pytest.mark.parametrize(
    ("integrator", "within"), [("automatic", 1e-8), ("velocity_verlet", 2e-3), ("esdirk4", 1e-8), ("rk4", 1e-6)]
)
def test_motion_buckles_and_its_energy_closes(integrator: str, within: float) -> None:
    document = column(0.0, damping=100.0, density=100.0)
    document["loads"] = [
        {"on": "B", "force": [0.0, -1.02 * EULER], "history": {"kind": "ramp", "start": 0.0, "duration": 0.1}}
    ]
    document["settings"] = {"integrator": integrator}
    session = Session.open(document)
    told = session.document.chronicle
    for _ in range(4):
        session.run(time=0.05)
        told.look()
    energy = session.energy
    assert session.rods["AB"].axial_force < -EULER
    assert abs(energy.imbalance) < within * energy.work
    assert [one.message for one in told.happenings if one.kind == "buckling"] == ["Strut AB buckles."]


def test_the_energy_of_a_free_swing_closes() -> None:
    """Undamped, in and out of buckling."""
    document = column(1.02 * EULER, damping=0.0, density=100.0)
    document["settings"] = {"integrator": "velocity_verlet"}
    session = Session.open(document)
    session.run(time=0.15)
    assert abs(session.energy.imbalance) < 1e-4 * session.energy.work


def test_any_truss_comes_to_rest_where_statics_has_it() -> None:
    document = strutted(3, share=0.8)
    for each in document["rods"]:
        each |= {"damping": 500.0, "density": 10.0}
    state = settle(models.load(document)).final
    session = Session.open(document)
    session.run(until="rest", limit=200.0)
    forces = session.model.rods.axial_force
    assert (forces < -session.model.rods.buckling_load).any()
    assert np.abs(forces - state.axial_force).max() < 1e-4 * np.abs(forces).max()


def test_curves_follow_a_strut_beyond_its_buckling_load() -> None:
    curve = Curve.of(models.load(column(1.02 * EULER)), Goal(1.0))
    assert curve.complete
    assert -curve.axial_force[-1, 0] == pytest.approx(1.02 * EULER, rel=1e-9)


def test_it_is_ignored_where_it_has_no_meaning() -> None:
    for facts in ({"bending_stiffness": 0.0}, {"hinged": [True, False]}, {"tension_only": True}):
        made = models.load(column(**facts))
        assert made.rods["AB"].buckling_load == math.inf


def test_verify_checks_compression_members(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "column.json"
    path.write_text(json.dumps(column(1.5 * EULER, buckles=False)), encoding="utf-8")
    assert main(["verify", str(path)]) == 0
    said = capsys.readouterr().out
    assert "Rod AB would buckle between its hinges" in said
    assert re.search(r"AB +185\.\d+ +123\.\d+ +1\.5\n", said)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.8])
def test_a_pull_sideways_feels_the_softening(share: float) -> None:
    """A column of eight rods between hinges under P: its stiffness in the middle is u³/3(tan u − u), u = π/2 √(P/P_E), of
    that without P [Timoshenko, Gere, section 1.3]: 1 − P/P_E, but for 2 %."""
    sides = []
    for push in (0.0, share * EULER):
        particles = [particle(f"n{k}", 0, k * LENGTH / 8) for k in range(9)]
        particles[0] |= HELD
        particles[4]["force"] = [1e-4, 0.0]
        particles[8] |= {"fixed": [True, False], "force": [0.0, -push]}
        rods = [rod(f"n{k}", f"n{k + 1}", stiffness=1e7, bending_stiffness=EI) for k in range(8)]
        state = settle(models.load(model(particles, rods))).final
        sides.append(state.displacement[4, 0])
    u = 0.5 * math.pi * math.sqrt(share)
    assert sides[0] / sides[1] == pytest.approx(u**3 / (3.0 * (math.tan(u) - u)), rel=1e-3)
    assert sides[0] / sides[1] == pytest.approx(1.0 - share, rel=2e-2)


def test_one_slider_loads_all_of_eulers_columns() -> None:
    session = Session.open("eulers_columns")
    (slider,) = session.model.sliders
    assert [(aim.table, aim.element, aim.field, aim.axis) for aim in slider.aims] == [
        ("loads", None, "force", "y")
    ]
    assert {load.on for load in session.model.loads} == {session.particles[f"{name}8"].row for name in "ABCD"}


@pytest.mark.parametrize("theory", ["exact", "first-order"])
def test_moments_along_it_are_its_force_times_its_deflection(theory: str) -> None:
    """In the diagram, the largest in tables; between the ends, at which they are 0."""
    document = column(push=0.0)
    document["particles"][1] |= {"fixed": [True, True], "displacement": [0.0, -0.02 * LENGTH]}
    document["settings"] = {"theory": theory}
    session = Session.open(document)
    state = session.statics().final
    most = state.axial_force[0] * state.diagrams["lateral_deflection"][0]
    assert most < -0.08 * EULER * LENGTH
    middle = 0.5 * LENGTH * (0.98 if theory == "exact" else 1.0)
    assert state.diagrams["largest_moment"][0] == pytest.approx([most, middle])
    session.press("q")
    along = inner_forces(session.model, np.array([0]), "M").at(np.array([0.0, 0.25, 0.5, 1.0]))[0]
    assert along == pytest.approx([0.0, most * math.sqrt(0.5), most, 0.0], rel=1e-3, abs=1e-12)


@pytest.mark.parametrize("theory", ["first-order", "exact"])
@pytest.mark.parametrize("push", [0.0, 1.25 * EULER])
def test_beside_plastic_hinges_what_gives_way_is_told_as_without(theory: str, push: float) -> None:
    """What buckles or is a mechanism says the same beside a beam, far from it, that has plastic hinges."""
    loose = [particle("C", 5, 0, **HELD), particle("D", 5, 1, force=[0.0 if push else 1.0, 0.0])]
    document = column(push)
    document["particles"] += loose
    document["rods"].append(rod("C", "D", **({"tension_only": True} if push else {})))
    alone = settle(models.load(document), theory=theory)
    document["particles"] += [particle("E", 9, 0, **HELD, fixed_rotation=True), particle("F", 11, 0)]
    document["rods"].append(rod("E", "F", bending_stiffness=100.0, plastic_moment=10.0))
    beside = settle(models.load(document), theory=theory)
    assert (beside.status, beside.message) == (alone.status, alone.message)
    assert [event.kind for event in beside.events] == [event.kind for event in alone.events]
