"""Plastic hinges in statics: against calculation from event to event, and closed forms of collapse and shakedown."""

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.language import english, spoken
from pinjoint.documents import models
from pinjoint.results import Results
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.settle import Settlement, settle
from pinjoint.systems.statics.state import Start
from pinjoint.systems.statics.unknowns import MethodError
from tests.reference.models import model
from tests.reference.plastic_hinges import Frame
from tests.verification.test_frame_theory import free, held

Document = dict[str, Any]
STRENGTHS = ("plastic_moment", "tensile_strength", "compressive_strength")
SEEDS = st.integers(0, 2**31)


def hinged_frame(seed: int) -> Document:
    """A frame of storeys and bays that yields at its ends, with loads on joints, inside beams and along members."""
    lot = np.random.default_rng(seed)
    bays, storeys = int(lot.integers(1, 3)), int(lot.integers(1, 3))
    particles: list[Document] = []
    rods: list[Document] = []
    same = {"stiffness": 1e6, "bending_stiffness": 1e4, "plastic_moment": 100.0}

    def join(first: str, second: str, weight: float = 0.0) -> None:
        facts = dict(same)
        if alike > 0.3:
            facts["bending_stiffness"] = float(10.0 ** lot.uniform(3.5, 4.5))
            facts["plastic_moment"] = float(lot.uniform(60.0, 150.0))
        if lot.random() < 0.1:
            facts["hinged"] = [bool(lot.random() < 0.5), False]
        facts["distributed_force"] = [0.0, -weight]
        rods.append({"name": f"{first}-{second}", "between": [first, second], **facts})

    alike = lot.random()
    for floor in range(storeys + 1):
        for bay in range(bays + 1):
            name, x, y = f"P{floor}{bay}", 6.0 * bay, 4.0 * floor
            if floor == 0:
                particles.append(held(name, x, y, fixed_rotation=bool(lot.random() < 0.7) or bay == 0))
                continue
            push = [float(lot.uniform(5.0, 20.0)) if bay == 0 else 0.0, float(lot.uniform(-40.0, 0.0))]
            particles.append(free(name, x, y, force=push))
            if lot.random() < 0.1:
                particles[-1]["moment"] = float(lot.normal(0.0, 20.0))
            join(f"P{floor - 1}{bay}", name)
    for floor in range(1, storeys + 1):
        for bay in range(bays):
            middle, weight = f"M{floor}{bay}", float(lot.uniform(0.0, 8.0) * (lot.random() < 0.4))
            push = [0.0, -float(lot.uniform(10.0, 60.0))]
            particles.append(
                free(middle, 6.0 * bay + float(lot.choice([2.0, 3.0, 3.7])), 4.0 * floor, force=push)
            )
            join(f"P{floor}{bay}", middle, weight)
            join(middle, f"P{floor}{bay + 1}", weight)
            if lot.random() < 0.3:
                strength = float(lot.uniform(20.0, 80.0))
                strengths = {"tensile_strength": strength, "compressive_strength": strength}
                ends = [f"P{floor - 1}{bay}", f"P{floor}{bay + 1}"]
                rods.append({"name": f"brace {floor}{bay}", "between": ends, "stiffness": 2e5, **strengths})
    return model(particles, rods)


def scaled(document: Document, share: float) -> Document:
    """The same, with so much of its loads and strengths."""
    document = copy.deepcopy(document)
    for facts in document["particles"]:
        facts["force"] = [share * part for part in facts.get("force", (0.0, 0.0))]
        facts["moment"] = share * facts.get("moment", 0.0)
    for rod in document["rods"]:
        rod["distributed_force"] = [share * part for part in rod.get("distributed_force", (0.0, 0.0))]
        rod |= {key: share * rod[key] for key in STRENGTHS if key in rod}
    return document


def events(found: Settlement, kind: str) -> list[Any]:
    return [event for event in found.events if event.kind == kind]


def same_hinges(found: Settlement, frame: Frame, within: float) -> None:
    """The same joints at the same load factors, in order; those that form at once in any."""
    told = [(event.load_factor, event.place["particle"]) for event in events(found, "hinge")]
    wanted = frame.hinges
    assert len(told) >= len(wanted), (told, wanted)
    assert [f for f, _ in told[: len(wanted)]] == pytest.approx([f for f, _ in wanted], rel=within)
    for factor, name in wanted:
        assert any(n == name and f == pytest.approx(factor, rel=within) for f, n in told), (name, told, wanted)
    yields = [factor for event in events(found, "yield") for factor in [event.load_factor] * len(event.rods)]
    assert yields[: len(frame.yields)] == pytest.approx([factor for factor, _ in frame.yields], rel=within)


@settings(max_examples=4, deadline=None)
@given(seed=SEEDS)
def test_frames_up_to_collapse_from_event_to_event(seed: int) -> None:
    document = hinged_frame(seed)
    frame = Frame(document)
    assert not frame.to(1e4)
    found = settle(models.load(document), 1e4, "first-order")
    assert found.status == "collapse"
    (collapse,) = events(found, "collapse")
    assert collapse.load_factor == pytest.approx(frame.factor, rel=1e-9)
    same_hinges(found, frame, 1e-9)


@settings(max_examples=4, deadline=None)
@given(seed=SEEDS, share=st.floats(0.5, 1.05))
def test_load_steps_leave_the_residual_moments_of_theory(seed: int, share: float) -> None:
    document = hinged_frame(seed)
    whole = Frame(document)
    whole.to(1e4)
    factors = [share * whole.factor, 0.0, -0.6 * whole.factor, 0.2 * whole.factor, 0.0]
    found, frame = settle(models.load(document), factors, "first-order"), Frame(document)
    for state, factor in zip(found.states, factors, strict=False):
        stands = frame.to(factor)
        assert state.status == ("equilibrium" if stands else "collapse")
        assert state.load_factor == pytest.approx(frame.factor, rel=1e-9)
        size = np.abs(frame.moment).max(initial=1.0)
        assert np.abs(state.diagrams["bending_moment"] - frame.moment).max() <= 1e-9 * size
        axial = frame.effort[:, 0]
        assert np.abs(state.axial_force - axial).max() <= 1e-9 * np.abs(axial).max(initial=size)


@settings(max_examples=4, deadline=None)
@given(seed=SEEDS)
def test_exact_geometry_under_loads_so_small_that_shape_does_not_count(seed: int) -> None:
    document = scaled(hinged_frame(seed), 1e-6)
    frame = Frame(document)
    frame.to(1e4)
    found = settle(models.load(document), 1.2 * frame.factor)
    (limit,) = events(found, "plastic mechanism") or events(found, "collapse")
    assert limit.load_factor == pytest.approx(frame.factor, rel=1e-6)
    same_hinges(found, frame, 1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_the_tangent_of_flowing_ends_is_the_derivative(seed: int) -> None:
    """In exact geometry, at displacements drawn by lot, with some ends beyond their plastic moments."""
    lot = np.random.default_rng(seed)
    document = hinged_frame(seed)
    structure = Structure.of(models.load(document))
    place = structure.spread(lot.normal(0.0, 0.02, structure.size))
    response = structure.respond(place, np.zeros((len(structure.ends), 3)), 0.7)
    assert response.flowing[:, 1:].any()
    tangent: Any = structure.tangent(response, response.soft | response.tied)
    step = 1e-7
    for column in range(structure.size):
        ahead, behind = (
            structure.gather(
                structure.internal(
                    structure.respond(place + sign * step * way, np.zeros((len(structure.ends), 3)), 0.7)
                )
            )
            for way in [structure.spread(np.eye(structure.size)[column])]
            for sign in (1.0, -1.0)
        )
        difference = (ahead - behind) / (2.0 * step)
        assert np.abs(tangent[:, column] - difference).max() <= 1e-6 * np.abs(tangent).max()


# --- closed forms ------------------------------------------------------------------------------------------

BEAM = {"stiffness": 1e6, "bending_stiffness": 1e4, "plastic_moment": 100.0}


def portal() -> Document:
    """4 m high, 6 m wide, H = 20 kN and V = 40 kN: sway with the beam, 6 M_p = λ (4 H + 3 V), λ = 3."""
    particles = [
        held("A", 0.0, fixed_rotation=True),
        free("B", 0.0, 4.0, force=[20.0, 0.0]),
        free("C", 3.0, 4.0, force=[0.0, -40.0]),
        free("D", 6.0, 4.0),
        held("E", 6.0, fixed_rotation=True),
    ]
    return model(particles, [{"name": n, "between": list(n), **BEAM} for n in ("AB", "BC", "CD", "DE")])


def test_a_portal_collapses_with_four_hinges_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (file := tmp_path / "portal.json").write_text(json.dumps(portal()))
    words = ["run", str(file), "--static", "--load-factors", "4", "--theory", "first-order", "--format", "json"]
    assert main(words) == 1
    told = json.loads(capsys.readouterr().out)
    hinges = [event for event in told["events"] if event["kind"] == "hinge"]
    assert [event["particle"] for event in hinges] == ["D", "C", "E", "A"]
    assert {key: hinges[0][key] for key in ("rod", "end")} in (
        {"rod": "CD", "end": "end"},
        {"rod": "DE", "end": "start"},
    )
    (collapse,) = (event for event in told["events"] if event["kind"] == "collapse")
    assert collapse["load_factor"] == pytest.approx(3.0, rel=1e-9)
    assert collapse["motion"]["C"][1] == pytest.approx(-0.75 * collapse["motion"]["C"][0], rel=1e-6)
    of_rods = told["states"][-1]["rods"]
    assert of_rods["AB"]["hinge_yielding"] == [True, False]
    assert of_rods["DE"]["plastic_rotation"][1] > 0.0
    assert "A, C, D and E" in told["message"]


def test_a_fixed_beam_keeps_the_moments_that_are_left_when_the_load_goes() -> None:
    """W at L/3: at first yield of the nearer clamp WL = 27/4 M_p, at collapse 9 M_p; elastic unloading from 8.5 M_p."""
    span, first, last = 6.0, 27.0 / 4.0, 9.0
    rods = [{"name": n, "between": list(n), **BEAM} for n in ("AB", "BC")]
    load = free("B", span / 3.0, force=[0.0, -100.0 / span])
    clamped = [held("A", 0.0, fixed_rotation=True), load, held("C", span, fixed_rotation=True)]
    found = settle(models.load(model(clamped, rods)), [8.5, 0.0], "first-order")
    assert events(found, "hinge")[0].load_factor == pytest.approx(first, rel=1e-9)
    whole = settle(models.load(model(clamped, rods)), 20.0, "first-order")
    assert events(whole, "collapse")[0].load_factor == pytest.approx(last, rel=1e-9)
    elastic = 100.0 * 8.5 * np.array([-4.0 / 27.0, 8.0 / 81.0, -2.0 / 27.0])
    loaded, left = (
        [state.diagrams["bending_moment"][row, end] for row, end in ((0, 0), (0, 1), (1, 1))]
        for state in found.states
    )
    assert np.array(left) == pytest.approx(np.array(loaded) - elastic, rel=1e-9)
    assert loaded[0] == pytest.approx(-100.0, rel=1e-9)


def two_spans(loads: tuple[float, float]) -> Document:
    """Spans of 4 m on three supports, with loads in their middles (kN)."""
    supports = [held("A", 0.0), {"name": "B", "position": [4.0, 0.0], "fixed": [False, True]}]
    supports += [{"name": "C", "position": [8.0, 0.0], "fixed": [False, True]}]
    middles = [free(name, x, force=[0.0, -load]) for name, x, load in zip("DE", (2.0, 6.0), loads, strict=True)]
    return model(
        [*supports, *middles], [{"name": n, "between": list(n), **BEAM} for n in ("AD", "DB", "BE", "EC")]
    )


@pytest.mark.parametrize("theory", ["first-order", "exact"])
@pytest.mark.parametrize("beyond", [0.97, 1.03])
def test_a_continuous_beam_under_repeated_loads_shakes_down_up_to_its_limit(theory: str, beyond: float) -> None:
    """Loads that come and go: 2 · 13 WL/64 + 12 WL/64 = 3 M_p, WL = 96/19 M_p; collapse under both at once only at 6 M_p."""
    size = 1.0 if theory == "first-order" else 1e-3  # of the loads, so that shape does not count
    load = beyond * size * 96.0 / 19.0 * 100.0 / 4.0
    permanent = np.zeros((4, 3))
    sizes = []
    for _ in range(8):
        for one, other in ((load, 0.0), (load, load), (0.0, load), (load, load)):
            document = two_spans((one, other))
            for rod in document["rods"]:
                rod["plastic_moment"] *= size
            made = models.load(document)
            found = settle(made, (1.0, 0.0), theory, Start.undeformed(made, permanent))
            assert found.status == "equilibrium"
            permanent = found.final.permanent
        sizes.append(np.abs(permanent[:, 1:]).max())
    growth = np.diff(sizes)[-5:]
    if beyond < 1.0:
        assert np.abs(growth).max() <= 1e-9 * sizes[-1]
    else:
        assert growth == pytest.approx(growth[0], rel=1e-3)
        assert growth[0] > 0.01 * sizes[0]


def test_the_same_hinge_turns_to_and_fro_under_a_load_that_changes_its_sign() -> None:
    """A propped cantilever: beyond WL = 16/3 M_p every cycle of load steps takes the same work, below it none."""
    rods = [{"name": n, "between": list(n), **BEAM} for n in ("AB", "BC")]
    roller = {"name": "C", "position": [4.0, 0.0], "fixed": [False, True]}
    for beyond in (0.99, 1.05):
        push = free("B", 2.0, force=[0.0, -beyond * 16.0 / 3.0 * 100.0 / 4.0])
        made = models.load(model([held("A", 0.0, fixed_rotation=True), push, roller], rods))
        found = settle(made, [1.0, -1.0] * 4, "first-order")
        work = np.diff([state.dissipated_plastic for state in found.states])
        assert found.status == "equilibrium"
        assert work == pytest.approx(work[0], rel=1e-9, abs=1e-9)
        assert (work[0] > 1.0) == (beyond > 1.0)


def test_a_settled_state_goes_on_from_where_it_is() -> None:
    made = models.load(portal())
    final = settle(made, 2.9, "first-order").final
    final.put(made)
    assert (made.rods.plastic_rotation == final.plastic_rotation).all()
    again = settle(made, 2.9, "first-order").final
    assert again.diagrams["bending_moment"] == pytest.approx(
        final.diagrams["bending_moment"], rel=1e-8, abs=1e-8
    )
    assert again.plastic_rotation == pytest.approx(final.plastic_rotation, abs=1e-12)


def test_axial_forces_that_lower_plastic_moments_are_told() -> None:
    document = portal()
    for rod in document["rods"]:
        rod |= {"tensile_strength": 300.0, "compressive_strength": 300.0}
    made = models.load(document)
    (note,) = events(settle(made, 2.9, "first-order"), "note")
    assert note.rods == ("DE",)
    assert "M_p reduced by N" in note.message
    made.settings.theory = "first-order"
    session = Session.open({**document, "settings": {"theory": "first-order", "load_steps": [2.9]}})
    session.press("q")
    rods = Results.of(session.model).rods
    (reduced,) = (column for column in rods.columns if column.key == "reduced_plastic_moment")
    share = max(np.abs(session.model.rods.end_axial_force[3])) / 300.0
    assert reduced.values[3] == pytest.approx(118.0 * (1.0 - share), rel=1e-9)
    assert [column.key for column in rods.columns if "plastic_rotation" in column.key]
    assert session.rods["DE"].plastic_rotation[1] > 0.0


def test_methods_of_elastic_structures_refuse_what_has_turned_in_hinges() -> None:
    session = Session.open(portal())
    session.model.settings.theory = "first-order"
    settle(session.model, 2.9, "first-order").final.put(session.model)
    with pytest.raises(MethodError, match="Rods BC and DE"):
        session.force_method()


def test_a_slack_cable_that_lets_a_frame_with_hinges_fall_is_told() -> None:
    """What is slack is known of rods and of their ends there, and which are struts of rods."""
    particles = [
        held("A", 0.0, fixed_rotation=True),
        *(free(name, x, 4.0) for name, x in (("B", 0.0), ("C", 1.5), ("D", 2.25))),
        free("E", 3.0, 4.0, fixed=[True, False], displacement=[-0.00073, 0.0], moment=-3.2),
    ]
    beam: Document = {"bending_stiffness": 8000.0}
    properties: list[Document] = [beam, {"tension_only": True}, {}, beam | {"plastic_moment": 70.0}]
    named = zip(("AB", "BC", "CD", "DE"), properties, strict=True)
    rods = [{"name": name, "between": list(name), **facts} for name, facts in named]
    found = models.load(model(particles, rods))
    assert settle(found, theory=found.settings.theory).status == "mechanism"


def test_of_ends_that_reach_one_plastic_moment_together_as_many_turn_as_have_to() -> None:
    """A column without shear bears one moment M_p all along: C turns, D and E need not before B does, at 3 V λ = 2 M_p."""
    particles = [
        held("A", 0.0, fixed_rotation=True),
        *(free("B", 0.0, 4.0, force=[60.0, 0.0]), free("C", 3.0, 4.0, force=[0.0, -60.0]), free("D", 6.0, 4.0)),
        free("E", 6.0, 0.0, fixed_rotation=True),
        free("P", 2.9, 4.5),
    ]
    beam: Document = {"bending_stiffness": 8000.0}
    yields = beam | {"plastic_moment": 70.0}
    named = {"AB": beam, "BC": yields, "CD": beam | {"tension_only": True}, "DE": yields, "PD": {}, "PC": {}}
    rods = [{"name": name, "between": list(name), **facts} for name, facts in named.items()]
    found = settle(models.load(model(particles, rods)), 1.4, "first-order")
    assert found.status == "collapse"
    assert events(found, "collapse")[0].load_factor == pytest.approx(7 / 9, rel=1e-9)
    first = events(found, "hinge")[0]
    assert (first.place["particle"], first.load_factor) == ("C", pytest.approx(2 / 3, rel=1e-9))


def test_joints_that_nobody_named_are_told_in_the_language_that_is_spoken() -> None:
    joints = [
        free("particle 1", 0.0, fixed=[True, True], fixed_rotation=True),
        free("particle 2", 2.0, force=[0.0, -10.0]),
    ]
    rods = [
        {
            "name": "rod 1",
            "between": ["particle 1", "particle 2"],
            "bending_stiffness": 1e3,
            "plastic_moment": 5.0,
        }
    ]
    with spoken("pt"):
        told = settle(models.load(model(joints, rods)), 1.0, "first-order").account
    assert "partícula 1 × 0,25" in told
    assert "particle" not in told
    assert "particle 1 × 0.25" in english(told)
