"""The force method where members bend, and its virtual work: closed forms, linear theory, Maxwell's reciprocity."""

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pinjoint.commands import force_method as command
from pinjoint.commands.command_line import main
from pinjoint.components.model import Model
from pinjoint.components.particle import in_support_axes
from pinjoint.documents import models
from pinjoint.documents.models import parse
from pinjoint.systems.statics.force_method import Solution, solve
from pinjoint.systems.statics.superposition import SetState
from pinjoint.systems.statics.theory import Indeterminacy, linear
from pinjoint.systems.statics.unknowns import MethodError, Unknown, redundants
from tests.reference.models import model, random_truss
from tests.verification.test_frame_theory import EI, beam, free, held, random_frame

SEEDS = st.integers(0, 2**32 - 1)
L, Q = 4.0, 7.0


def solved(made: Model, *names: str) -> Solution:
    """The solution for these unknowns, which agrees with linear theory and with the displacements of its sets."""
    return checked(made, [Unknown.named(made, name) for name in names])


def checked(made: Model, unknowns: list[Unknown], within: float = 1e-9) -> Solution:
    found, theory = solve(made, unknowns), linear(made)
    size = np.abs(found.flexibility).max()
    assert np.abs(found.flexibility - found.flexibility.T).max() <= within * size
    assert (np.diag(found.flexibility) > 0.0).all()
    reach = max(np.abs(found.gap).max(), size * np.abs(found.force).max())
    for row, unknown in enumerate(unknowns):
        if unknown.of_end:
            continue  # displacements of the joints do not tell by how much a hinge opens
        measured = [moved(made, unknown, unit) for unit in found.units]
        assert np.abs(found.delta_unit[row] - measured).max() <= within * size
        for delta, state in ((found.delta_real, found.real), (found.delta_base, found.base)):
            assert abs(delta[row] - moved(made, unknown, state)) <= within * reach
    whole = found.superposed
    forces = max(np.abs(theory.axial_force).max(), np.abs(theory.reaction).max(), 1e-3)
    assert np.abs(whole.axial_force - theory.axial_force).max() <= within * forces
    assert np.abs(whole.reaction[:, :2] - theory.reaction).max() <= within * forces
    if len(whole.end_moment):
        moments = np.abs(theory.diagrams["bending_moment"]).max() + 1e-3
        assert np.abs(whole.bending_moment - theory.diagrams["bending_moment"]).max() <= within * moments
        assert np.abs(whole.reaction[:, 2] - theory.reaction_moment).max() <= within * moments
        assert np.abs(whole.rotation - theory.rotation).max() <= within * (np.abs(theory.rotation).max() + 1e-6)
    most = np.abs(theory.displacement).max() + 1e-6  # m: where all is held, sums of sets leave round-off
    assert np.abs(whole.displacement - theory.displacement).max() <= within * most
    return found


def moved(made: Model, unknown: Unknown, state: SetState) -> float:
    """How far a support is displaced, or the ends of a bar are farther apart, in a set."""
    if unknown.of_support:
        place = in_support_axes(made, np.column_stack([state.displacement, state.rotation]))
        return float(place[unknown.place])
    row = unknown.element.row
    first, second = state.displacement[made.rods.between[row]]
    return float((second - first) @ made.rods.difference[row] / made.rods.original_length[row])


def propped(**facts: Any) -> Model:
    """A cantilever AB on a prop at B, under a distributed load."""
    clamp = held("A", 0.0, fixed_rotation=True)
    prop = held("B", L, fixed=[False, True], **facts)
    return parse(model([clamp, prop], [beam("AB", distributed_force=[0.0, -Q])]))


def test_the_prop_of_a_cantilever_bears_three_eighths_of_its_load() -> None:
    found = solved(propped(), "B.y")
    assert found.gap[0] == pytest.approx(-Q * L**4 / (8.0 * EI), rel=1e-12)
    assert found.flexibility[0, 0] == pytest.approx(L**3 / (3.0 * EI), rel=1e-12)
    assert found.force[0] == pytest.approx(3.0 * Q * L / 8.0, rel=1e-12)


def test_a_moment_at_an_end_is_released_with_clamps_and_supports_of_any_row() -> None:
    """Two spans, clamped on the left: of the particles C is beyond the last rod's row."""
    clamp = held("A", 0.0, fixed_rotation=True)
    rods = [beam("AB", distributed_force=[0.0, -Q]), beam("BC")]
    made = parse(
        model([clamp, held("B", L, fixed=[False, True]), held("C", 2.0 * L, fixed=[False, True])], rods)
    )
    by_support, by_clamp = solved(made, "AB.start", "C.y"), solved(made, "AB.end", "A.rotation")
    assert by_support.force[0] == pytest.approx(-by_clamp.force[1], rel=1e-12)


@pytest.mark.parametrize("name", ["A.rotation", "AB.start"])
def test_the_same_by_its_clamp(name: str) -> None:
    """The reaction turns the beam up, which is tension at its top: a negative bending moment."""
    found = solved(propped(), name)
    sign = 1.0 if name == "A.rotation" else -1.0
    assert found.gap[0] == pytest.approx(sign * -Q * L**3 / (24.0 * EI), rel=1e-12)
    assert found.flexibility[0, 0] == pytest.approx(L / (3.0 * EI), rel=1e-12)
    assert found.force[0] == pytest.approx(sign * Q * L**2 / 8.0, rel=1e-12)


def test_a_released_support_that_has_moved_is_on_the_right_side_and_others_in_the_gap() -> None:
    c = -0.003
    found = solved(propped(displacement=[0.0, c]), "B.y")
    assert found.prescribed[0] == c
    assert found.gap[0] == pytest.approx(-Q * L**4 / (8.0 * EI), rel=1e-12)
    assert found.force[0] == pytest.approx(3.0 * Q * L / 8.0 + 3.0 * EI * c / L**3, rel=1e-12)
    found = solved(propped(displacement=[0.0, c]), "A.rotation")
    assert found.prescribed[0] == 0.0
    assert found.gap[0] == pytest.approx(-Q * L**3 / (24.0 * EI) + c / L, rel=1e-12)


def test_a_beam_clamped_at_both_ends_with_three_unknowns() -> None:
    particles = [held("A", 0.0, fixed_rotation=True), held("B", L, fixed_rotation=True)]
    made = parse(model(particles, [beam("AB", distributed_force=[0.0, -Q])]))
    found = solved(made, "B.x", "B.y", "B.rotation")
    assert found.force == pytest.approx([0.0, Q * L / 2.0, -Q * L**2 / 12.0], rel=1e-12, abs=1e-11)


def portal(load: float) -> Model:
    """Feet A and D clamped, height h, span l, the beam under a distributed load; axially stiff."""
    particles = [
        held("A", 0.0, fixed_rotation=True),
        free("B", 0.0, 3.0),
        free("C", 5.0, 3.0),
        held("D", 5.0, fixed_rotation=True),
    ]
    stiff = {"stiffness": 1e12}
    rods = [beam("AB", **stiff), beam("BC", distributed_force=[0.0, -load], **stiff), beam("CD", **stiff)]
    return parse(model(particles, rods))


def test_a_portal_clamped_at_its_feet() -> None:
    """Kleinlogel: thrust q l²/(4 h N₁), moment at the feet q l²/(12 N₁), N₁ = k + 2, k = h/l (equal EI)."""
    height, span, load = 3.0, 5.0, 10.0
    n = height / span + 2.0
    made = portal(load)
    found = solve(made, [Unknown.named(made, name) for name in ("D.x", "D.y", "D.rotation")])
    thrust, foot = load * span**2 / (4.0 * height * n), load * span**2 / (12.0 * n)
    assert found.force == pytest.approx([-thrust, load * span / 2.0, foot], rel=1e-6)
    corner = found.superposed.bending_moment[1, 0]
    assert corner == pytest.approx(-load * span**2 / (6.0 * n), rel=1e-6)


@settings(max_examples=25, deadline=None)
@given(SEEDS)
def test_random_frames_by_all_their_unknowns_and_by_some(seed: int) -> None:
    made = parse(random_frame(seed))
    degrees = Indeterminacy.of(made)
    assume(degrees.static and not degrees.mechanisms)
    unknowns = redundants(made)
    assert len(unknowns) == degrees.static
    checked(made, unknowns)
    lot = np.random.default_rng(seed)
    some = [unknowns[i] for i in sorted(lot.permutation(len(unknowns))[: 1 + lot.integers(len(unknowns))])]
    checked(made, some)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_random_trusses_with_warm_and_misfitting_rods(seed: int) -> None:
    made = parse(random_truss(seed))
    degrees = Indeterminacy.of(made)
    assume(degrees.static and not degrees.mechanisms)
    lot = np.random.default_rng(seed)
    for rod in made.rods:
        rod.temperature_change = float(lot.uniform(-30.0, 30.0))
        rod.thermal_expansion = 1.2e-5
    checked(made, redundants(made))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("AB", r"AB bends\. Release the moment at one of its ends instead: AB\.start or AB\.end"),
        ("AB.end", r"Without AB\.end the structure is a mechanism: B about itself can move"),
        ("B.rotation", "B is not clamped"),
        ("A.turn", "rods and supports"),
    ],
)
def test_unknowns_that_are_none_are_explained(name: str, words: str) -> None:
    made = propped()
    with pytest.raises(MethodError, match=words):
        solve(made, [Unknown.named(made, name)])


@pytest.mark.parametrize("name", ["hyperstatic", "tower", "portal", "two_storey_frame", "vierendeel"])
def test_bundled_models(name: str) -> None:
    made = models.load(name)
    checked(made, redundants(made))


def test_a_flexibility_that_is_zero_is_told_as_zero() -> None:
    """By symmetry a horizontal force at the foot of a portal does not lift it."""
    model = models.load("portal")
    flexibility = solve(model, [Unknown.named(model, name) for name in ("D.x", "D.y")]).flexibility
    assert flexibility[0, 1] == flexibility[1, 0] == 0.0
    assert (np.diag(flexibility) > 0.0).all()


def test_what_many_unknowns_do_alone_is_written_on_request(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def told(*words: str) -> str:
        assert main(["force-method", "two_storey_frame", "--all", *words]) == 0
        return capsys.readouterr().out

    whole = json.loads(told())
    monkeypatch.setattr(command, "MOST_SETS", 5)
    few = json.loads(told())
    assert few == whole | {"delta_unit": None, "flexibility": None, "virtual_work": {}}
    assert json.loads(told("--sets")) == whole
    assert "--sets writes it" in told("--format", "table")
    assert "delta_unit" not in told("--format", "csv")
