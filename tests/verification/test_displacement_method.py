"""The displacement method: slope deflection by hand, matrices of members from textbooks, statics, the force method."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.components.particle import in_support_axes, spring_stiffness
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.documents import models
from pinjoint.documents.models import parse
from pinjoint.methods.displacements import DisplacementTables
from pinjoint.systems.statics.displacement_method import MOST, Solution, solve
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.theory import linear
from pinjoint.systems.statics.unknowns import MethodError
from tests.benchmarks.models import lattice
from tests.reference import frame_theory
from tests.reference.models import random_truss
from tests.systems.render.frame_models import CLAMPED, EA, EI, PINNED, ROLLER, frame
from tests.verification.test_frame_theory import random_frame

SEEDS = st.integers(0, 2**32 - 1)


def checked(made: Model, within: float = 1e-10) -> Solution:
    """The solution, which agrees with statics, and with the sums and states that it is shown by."""
    found, theory = solve(made), linear(made)
    whole, count = found.superposed, len(found.unknowns)
    size = max(np.abs(theory.axial_force).max(), np.abs(whole.end_moment).max(), np.abs(theory.reaction).max())
    assert np.abs(whole.axial_force - theory.axial_force).max() <= within * size
    assert np.abs(whole.reaction[:, :2] - theory.reaction).max() <= within * size
    assert np.abs(whole.displacement - theory.displacement).max() <= within * np.abs(theory.displacement).max()
    if len(whole.end_moment) and theory.diagrams:
        assert np.abs(whole.bending_moment - theory.diagrams["bending_moment"]).max() <= within * size
    at = tuple(np.array([unknown.place for unknown in found.unknowns]).T)
    stiff = spring_stiffness(made)  # springs hold joints, too
    columns = np.array([in_support_axes(made, unit.reaction)[at] for unit in found.units]).T + np.diag(
        stiff[at]
    )
    moved = [in_support_axes(made, np.column_stack([one.displacement, one.rotation])) for one in found.units]
    springs = np.einsum("ipa,pa,jpa->ij", moved, stiff, moved)
    assert np.abs(columns - found.stiffness).max() <= 1e-12 * np.abs(found.stiffness).max()
    shares = [[found.shares(i, j).sum() for j in range(count)] for i in range(count)]
    assert np.abs(shares + springs - found.stiffness).max() <= 1e-12 * np.abs(found.stiffness).max()
    assert np.abs(found.stiffness @ found.displacement - found.load).max() <= 1e-9 * np.abs(found.load).max()
    return found


@given(SEEDS)
def test_random_frames_agree_with_statics_and_with_matrices_from_a_textbook(seed: int) -> None:
    document = random_frame(seed)
    for facts in document["particles"]:  # axes of supports that are none do not count
        if not any((*facts.get("fixed", ()), *facts["support_springs"])):
            facts["support_angle"] = 0.0
    made = parse(document)
    found, turn = checked(made), frame_theory.axes_of(document["particles"])
    matrix, load, held, still, members = frame_theory.assembled(document)
    free = ~held & ~still
    placed = [[*p.get("displacement", (0.0, 0.0)), p.get("rotation", 0.0)] for p in document["particles"]]
    moved = np.where(held & ~still, turn @ np.ravel(placed), 0.0)
    assert found.stiffness == pytest.approx(matrix[np.ix_(free, free)], rel=1e-9, abs=1e-9 * matrix.max())
    wanted = (load - matrix @ moved)[free]
    assert found.load == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    tables = DisplacementTables(made, found)
    for member, stiffness, fast in zip(members, found.members, tables.fixed_end_forces, strict=True):
        own, fixed = frame_theory.condensed(member)
        way = member.turned @ turn[np.ix_(member.places, member.places)].T
        turned = way.T @ own @ way
        assert stiffness == pytest.approx(turned, abs=1e-9 * np.abs(turned).max())
        ends = way.T @ fixed + turned @ moved[member.places]
        assert fast == pytest.approx(ends, abs=1e-9 * max(np.abs(ends).max(), np.abs(wanted).max()))
    for i in range(len(free.nonzero()[0])):
        assert tables.shares(i, len(found.unknowns)).sum() + joint(document, free)[i] == pytest.approx(
            found.load[i], abs=1e-9 * np.abs(wanted).max()
        )


def joint(document: frame_theory.Document, free: np.ndarray) -> np.ndarray:
    """The loads on the joints themselves."""
    rows = [[*p.get("force", (0.0, 0.0)), p.get("moment", 0.0)] for p in document["particles"]]
    return (frame_theory.axes_of(document["particles"]) @ np.ravel(rows))[free]


@given(SEEDS)
def test_random_trusses(seed: int) -> None:
    checked(parse(random_truss(seed)))


@pytest.mark.parametrize("name", ["portal", "hyperstatic", "vierendeel", "tower", "gerber_beam", "isostatic"])
def test_k_is_that_of_the_engine_to_the_last_bit(name: str) -> None:
    made = models.load(name)
    found = checked(made)
    tangent = Structure.of(made, FIRST_ORDER).initial_tangent
    assert (found.stiffness == (tangent if isinstance(tangent, np.ndarray) else tangent.toarray())).all()


def test_a_two_span_beam_by_slope_deflection() -> None:
    """Clamped at A, on rollers at B and C: M_AB = 2EI φ_B/L − qL²/12 …, and the moments at B and at C are in balance."""
    q, left, right = 10.0, 6.0, 4.0
    particles = {"A": (0.0, 0.0, CLAMPED), "B": (left, 0.0, ROLLER), "C": (left + right, 0.0, ROLLER)}
    rods = {"A B": {"distributed_force": [0.0, -q]}, "B C": {"bending_stiffness": 2.0 * EI}}
    made = models.load(frame(particles, rods))
    found = checked(made)
    k_1, k_2 = EI / left, 2.0 * EI / right
    matrix = np.array([[4.0 * k_1 + 4.0 * k_2, 2.0 * k_2], [2.0 * k_2, 4.0 * k_2]])
    load = np.array([q * left**2 / 12.0, 0.0])
    turns = [i for i, unknown in enumerate(found.unknowns) if unknown.axis == 2]
    assert [found.unknowns[i].name for i in turns] == ["B.rotation", "C.rotation"]
    assert found.stiffness[np.ix_(turns, turns)] == pytest.approx(matrix, rel=1e-12)
    assert found.load[turns] == pytest.approx(load, rel=1e-12)
    phi = np.linalg.solve(matrix, load)
    assert found.displacement[turns] == pytest.approx(phi, rel=1e-9)
    clamp = q * left**2 / 12.0 + 2.0 * k_1 * phi[0]
    assert found.superposed.end_moment[0, 0] == pytest.approx(clamp, rel=1e-9)
    assert found.superposed.end_moment[1, 1] == pytest.approx(0.0, abs=1e-9)


def test_a_portal_on_pins_by_slope_deflection() -> None:
    """A stiff beam on two columns that are hinged at their feet sways by H h³/(2 · 3EI) where axes hardly shorten."""
    h, force = 4.0, 12.0
    particles = {"A": (0.0, 0.0, PINNED), "B": (0.0, h, {}), "C": (6.0, h, {}), "D": (6.0, 0.0, PINNED)}
    stiff = {"bending_stiffness": 1e12, "stiffness": 1e12}
    columns = {"hinged": [True, False], "stiffness": 1e12}, {"hinged": [False, True], "stiffness": 1e12}
    loads = [{"name": f"on {at}", "on": at, "force": [force / 2.0, 0.0]} for at in "BC"]
    made = models.load(frame(particles, {"A B": columns[0], "B C": stiff, "C D": columns[1]}, loads=loads))
    found = solve(made)
    names = [unknown.name for unknown in found.unknowns]
    assert "A.rotation" not in names  # condensed: hinged ends need no unknown
    assert found.stiffness[0, 0] - 1e12 / 6.0 == pytest.approx(3.0 * EI / h**3, rel=1e-6)
    assert found.displacement[names.index("B.x")] == pytest.approx(force * h**3 / (6.0 * EI), rel=1e-6)


def test_a_bar_by_hand() -> None:
    """Two bars at 45° under a weight: k = Σ EA/L (c², cs, s²)."""
    particles = {"A": (0.0, 0.0, PINNED), "B": (2.0, 0.0, PINNED), "C": (1.0, -1.0, {"force": [0.0, -10.0]})}
    found = checked(
        models.load(frame(particles, {"A C": {"bending_stiffness": 0.0}, "B C": {"bending_stiffness": 0.0}}))
    )
    k = EA / np.sqrt(2.0)
    assert found.stiffness == pytest.approx(np.diag([k, k]), rel=1e-12, abs=1e-9 * k)
    assert found.shares(0, 1) == pytest.approx([-k / 2.0, k / 2.0], rel=1e-12)
    assert found.displacement == pytest.approx([0.0, -10.0 / k], rel=1e-12, abs=1e-20)


def test_a_portal_of_inextensible_members_has_three_unknowns() -> None:
    """Slope deflection: 24EI/h³ of the sway, 6EI/h² between it and the joints, 4EI/h + 4EI/L of these, 2EI/L between."""
    h, span, q = 4.0, 6.0, 10.0
    particles = {"A": (0.0, 0.0, CLAMPED), "B": (0.0, h, {}), "C": (span, h, {}), "D": (span, 0.0, CLAMPED)}
    rods = {"A B": {}, "B C": {"distributed_force": [0.0, -q]}, "C D": {}}
    source = frame(particles, {name: facts | {"inextensible": True} for name, facts in rods.items()})
    made = models.load(source | {"loads": [{"on": "B", "force": [12.0, 0.0]}]})
    found = checked(made)
    assert [unknown.name for unknown in found.unknowns] == ["B.x", "B.rotation", "C.rotation"]
    joint, lever = 4.0 * EI / h + 4.0 * EI / span, 6.0 * EI / h**2
    matrix = [
        [24.0 * EI / h**3, lever, lever],
        [lever, joint, 2.0 * EI / span],
        [lever, 2.0 * EI / span, joint],
    ]
    assert found.stiffness == pytest.approx(np.array(matrix), rel=1e-12)
    assert found.load == pytest.approx([12.0, -q * span**2 / 12.0, q * span**2 / 12.0], rel=1e-12)
    assert found.shares(0, 0) == pytest.approx([12.0 * EI / h**3, 0.0, 12.0 * EI / h**3], rel=1e-12)


@given(SEEDS)
def test_random_frames_of_some_inextensible_members(seed: int) -> None:
    document, lot = random_frame(seed), np.random.default_rng(seed)
    for member in document["rods"]:
        member["inextensible"] = bool(lot.random() < 0.3)
    made = parse(document)
    try:
        linear(made)
    except NoEquilibrium as reason:  # inextensible members that hold each other
        with pytest.raises(MethodError, match=re.escape(str(reason)[:40])):
            solve(made)
        return
    checked(made, within=1e-9)


def test_both_methods_give_the_same_forces_by_script() -> None:
    session = Session.open("two_storey_frame")
    by_forces, by_displacements = session.force_method(), session.displacement_method()
    assert (len(by_forces.unknowns), len(by_displacements.unknowns)) == (6, 12)
    moments = by_forces.superposed.end_moment
    assert by_displacements.superposed.end_moment == pytest.approx(moments, abs=1e-9 * np.abs(moments).max())
    assert len(session.force_method("AC.start").unknowns) == 1


@pytest.mark.parametrize(("source", "said"), [("pendulum", "mechanism"), (lattice(1500), f"up to {MOST}")])
def test_what_has_no_solution_is_refused(source: object, said: str) -> None:
    with pytest.raises(MethodError, match=said):
        solve(source if isinstance(source, Model) else models.load(source))  # type: ignore[arg-type]


def test_cables_are_refused_by_name() -> None:
    made = models.load("hyperstatic")
    made.rods["AC"].tension_only = True
    with pytest.raises(MethodError, match="AC acts in tension only"):
        solve(made)
