"""First-order statics: all that is loaded, slack or yields, against independent solutions; and what is no result."""

import json
from collections.abc import Iterator
from itertools import chain, combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.theory import FIRST_ORDER, THEORIES
from pinjoint.documents import models
from pinjoint.systems.edit.dividing import divide
from pinjoint.systems.statics.follow import Path, Point, Tangent
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.second_order import SecondOrder
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import Start
from pinjoint.systems.statics.theory import Indeterminacy
from tests.benchmarks.models import storeys
from tests.reference import closed_forms, frame_theory, statics
from tests.reference import models as trusses
from tests.reference.elements import Model as Document
from tests.reference.elements import read
from tests.verification.test_frame_theory import SEEDS, agrees, random_frame
from tests.verification.test_settling import events, plastic_truss

Array = np.ndarray


def first_order(document: Document, *factors: float) -> Any:
    return settle(models.load(document), factors or (1.0,), "first-order")


@pytest.mark.timeout(60)
@pytest.mark.parametrize("theory", THEORIES)
def test_a_ring_is_tightened_by_a_rod_far_too_short_for_it(theory: str) -> None:
    """By a tenth, hundreds of times the strain at which it yields: that took a million steps."""
    places = {"A": (0, 0), "B": (2, 0), "C": (4, 0), "D": (-0.18, 1.84), "E": (2, 2), "F": (4, 2)}
    bent = [
        {"name": name, "between": list(name), "bending_stiffness": 8360.0} for name in ("AB", "BC", "AD", "CF")
    ]
    strong = {
        "rest_length": 2.0,
        "tensile_strength": 60.0,
        "compressive_strength": 60.0,
        "bending_stiffness": 8360.0,
    }
    document = {
        "format": "pinjoint model",
        "version": 1,
        "particles": [{"name": name, "position": list(place)} for name, place in places.items()],
        "rods": [*bent, {"name": "DE", "between": ["D", "E"], **strong}, {"name": "EF", "between": ["E", "F"]}],
    }
    found = settle(models.load(document), theory=theory)
    assert found.status == "neutral equilibrium"
    assert found.final.axial_force[4] == pytest.approx(60.0, rel=1e-9)
    assert 0.0 < found.final.plastic_strain[4] < 0.1


# --- elastic ----------------------------------------------------------------------------------------------


@settings(max_examples=25)
@given(seed=SEEDS)
def test_frames_with_everything(seed: int) -> None:
    """Hinges, moments, distributed forces, settled and turned supports, warm members and warm sides."""
    document = random_frame(seed)
    made = models.load(document)
    if not Indeterminacy.of(made).mechanisms:
        agrees(document, settle(made, theory="first-order").final, made, within=1e-10)


def subsets(of: list[Any]) -> Iterator[tuple[Any, ...]]:
    return chain.from_iterable(combinations(of, count) for count in range(len(of) + 1))


@settings(max_examples=15)
@given(seed=SEEDS)
def test_frames_with_cables_against_all_choices_of_slack_ones(seed: int) -> None:
    document = random_frame(seed)
    braces = [brace for brace in document["rods"] if not brace["bending_stiffness"]][:4]
    for brace in braces:
        brace["tension_only"] = True
    made = models.load(document)
    if Indeterminacy.of(made).mechanisms:
        return
    for slack in subsets(braces):
        chosen = [{**rod, "stiffness": 1e-9} if rod in slack else rod for rod in document["rods"]]
        forces = frame_theory.solve({**document, "rods": chosen}).end_axial_force
        if all((forces[brace["name"]].mean() < 0.0) == (brace in slack) for brace in braces):
            break
    found = settle(made, theory="first-order")
    assert found.status == "equilibrium"
    agrees({**document, "rods": chosen}, found.final, made, within=1e-10)


@settings(max_examples=20)
@given(seed=SEEDS)
def test_trusses_with_settlements_and_lack_of_fit(seed: int) -> None:
    document = trusses.random_truss(seed % 10_000, nodes=9, redundant=3)
    lot = np.random.default_rng(seed)
    document["particles"][0]["displacement"] = lot.normal(0.0, 0.01, 2).tolist()
    for rod in document["rods"]:
        rod |= {"plastic_strain": float(lot.normal(0.0, 1e-4)), "density": 100.0}
    document["environment"] = {"acceleration": [1.0, -9.81]}
    expected, found = statics.direct_stiffness(document), first_order(document).final
    for quantity in ("axial_force", "displacement", "reaction"):
        values = np.array(list(expected[quantity].values()))
        assert np.abs(getattr(found, quantity) - values).max() <= 1e-10 * np.abs(values).max()


def test_a_settlement_that_would_tear_what_is_held_strains_nothing_that_is_free() -> None:
    document = trusses.triangle((0, 0))
    document["particles"][0]["displacement"] = [0.0, -0.1]
    for rod in document["rods"]:
        rod |= {"tensile_strength": 1.0, "compressive_strength": 1.0}
    found = first_order(document)
    assert (found.status, found.events) == ("equilibrium", ())
    assert np.abs(found.final.axial_force).max() < 1e-9


def test_a_flexible_pendulum_is_a_mechanism() -> None:
    """Bending so soft beside the axes hid that the weight turns it: forces were told that do not balance."""
    found = settle(models.load("flexible_pendulum"), theory="first-order")
    assert found.status == "mechanism"
    (event,) = events(found, "mechanism")
    assert event.motion is not None
    assert event.motion[-1] == pytest.approx([0.0, -1.0, event.motion[-1, 2]], abs=1e-6)


def test_a_beam_gives_the_numbers_of_a_hand_calculation() -> None:
    found = Session.open("gerber_beam").statics().final
    assert found.status == "equilibrium"
    assert not found.displacement[:, 0].any()


# --- yielding ---------------------------------------------------------------------------------------------


class EventToEvent:
    """A truss by first-order theory from one yield to the next, trying all sets of those at their strengths."""

    def __init__(self, document: Document) -> None:
        elements = read(document)
        self.matrix = np.zeros((len(elements.rods), 2 * len(elements.particles)))
        for row, rod in enumerate(elements.rods):
            along = np.array(rod.span) / np.hypot(*rod.span)
            self.matrix[row, 2 * rod.start : 2 * rod.start + 2] = -along
            self.matrix[row, 2 * rod.end : 2 * rod.end + 2] = along
        free = ~np.array([particle.fixed for particle in elements.particles]).ravel()
        self.load = np.array([particle.force for particle in elements.particles]).ravel()[free]
        self.matrix = self.matrix[:, free]
        self.stiffness = np.array([rod.stiffness / rod.rest_length for rod in elements.rods])
        self.length = np.array([rod.rest_length for rod in elements.rods])
        self.low = -np.array([rod.compressive_strength for rod in elements.rods])
        self.high = np.array([rod.tensile_strength for rod in elements.rods])
        self.force, self.strain, self.factor = np.zeros(len(self.low)), np.zeros(len(self.low)), 0.0
        self.yields: list[float] = []
        self.flowing: set[int] = set()

    def rates(self, sense: float, side: Array) -> tuple[Array, Array] | None:
        """Rates of force and of elongation, and by them which rods flow; None at collapse."""
        for chosen in subsets(np.flatnonzero(side).tolist()):
            flows = np.isin(np.arange(len(side)), chosen)
            stiffness = np.where(flows, 0.0, self.stiffness)
            tangent = self.matrix.T @ (stiffness[:, None] * self.matrix)
            if np.linalg.cond(tangent) > 1e9:
                continue
            stretch = self.matrix @ np.linalg.solve(tangent, sense * self.load)
            if (side * stretch >= 0.0)[flows].all() and (side * stretch <= 0.0)[~flows].all():
                self.flowing = set(chosen)
                return stiffness * stretch, np.where(flows, stretch, 0.0)
        return None

    def to(self, factor: float) -> bool:
        """Go to a load factor; False if the truss collapses on the way."""
        sense = np.sign(factor - self.factor)
        while self.factor != factor:
            side = (self.force >= self.high * (1 - 1e-12)) * 1.0 - (self.force <= self.low * (1 - 1e-12))
            before = set(self.flowing)
            found = self.rates(sense, side)
            if found is None:
                return False
            if self.flowing - before:
                self.yields.append(self.factor)
            force, plastic = found
            with np.errstate(divide="ignore", invalid="ignore"):
                wait = (np.where(force > 0.0, self.high, self.low) - self.force) / force
            wait = float(np.where((force != 0.0) & (side * force <= 0.0), wait, np.inf).min())
            step = min(wait, abs(factor - self.factor))
            self.force = self.force + step * force
            self.strain = self.strain + step * plastic / self.length
            self.factor = factor if step == abs(factor - self.factor) else self.factor + sense * step
        return True


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), beyond=st.floats(0.3, 1.2))
def test_load_steps_with_yielding_from_event_to_event(seed: int, beyond: float) -> None:
    """Loaded towards collapse or beyond, unloaded with residual forces, loaded the other way."""
    document = plastic_truss(seed)
    whole = EventToEvent(document)
    whole.to(1e3)
    factors = [beyond * whole.factor, 0.0, -0.7 * whole.factor, 0.0]
    path, found = EventToEvent(document), first_order(document, *factors)
    for state, factor in zip(found.states, factors, strict=False):
        stands = path.to(factor)
        assert state.status == ("equilibrium" if stands else "collapse")
        assert state.load_factor == pytest.approx(path.factor, rel=1e-9)
        size = np.abs(path.force).max(initial=path.high.max())
        assert np.abs(state.axial_force - path.force).max() <= 1e-9 * size
        assert np.abs(state.plastic_strain - path.strain).max() <= 1e-9 * np.abs(path.strain).max(initial=1e-3)
    yields = [event.load_factor for event in events(found, "yield")]
    assert yields == pytest.approx(path.yields, rel=1e-9) or found.status == "collapse"


def test_the_collapse_load_of_limit_analysis_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["run", "three_bar_plastic", "--static", "--load-factors", "2", "--format", "json"]
    assert main([*words, "--theory", "first-order"]) == 1
    found = json.loads(capsys.readouterr().out)
    limit = closed_forms.three_bar_collapse(100.0) / 240.0
    (event,) = (event for event in found["events"] if event["kind"] == "collapse")
    assert (found["status"], found["theory"]) == ("collapse", "first-order")
    assert event["load_factor"] == pytest.approx(limit, rel=1e-9)
    assert event["motion"]["D"] == pytest.approx([0.0, -1.0], abs=1e-9)
    assert found["states"][-1]["load_factor"] == pytest.approx(limit, rel=1e-9)
    assert main(words) == 1
    assert "collapse load of textbooks" in json.loads(capsys.readouterr().out)["message"]


def test_a_tall_frame_collapses_when_its_feet_yield() -> None:
    """What sinks is so much that the share of stiffness which keeps the matrix regular seemed to hold it, for minutes."""
    model = storeys(1, 30)
    found = settle(model, 2.0, FIRST_ORDER, Start.undeformed(model, model.rods.plastic_strain))
    carried = 30 * 4.0 * 20.0 / 2.0  # kN, by each foot
    assert (found.status, found.events[-1].kind) == ("collapse", "collapse")
    assert found.final.load_factor == pytest.approx(model.rods.compression_limit[0] / carried, rel=1e-9)


def test_what_yields_by_more_than_a_tenth_is_no_result() -> None:
    found = settle(models.load("three_bar_plastic"), 2.0)
    (event,) = events(found, "collapse")
    assert event.rods == ("BD",)
    assert np.abs(found.final.plastic_strain).max() <= 0.1
    assert "large changes of shape" in found.message
    assert f"{found.final.load_factor:.4g}" in found.message


# --- where it begins --------------------------------------------------------------------------------------


@pytest.mark.parametrize("theory", ["first-order", "exact"])
def test_the_state_of_a_run_does_not_matter(theory: str) -> None:
    session = Session.open("hyperstatic_yield")
    before, revision = session.statics(theory), session.model.revision
    assert session.model.revision == revision
    session.run(time=0.3)
    assert session.particles.displacement.any()
    after = session.statics(theory).final
    assert (after.axial_force == before.final.axial_force).all()
    assert (after.displacement == before.final.displacement).all()


def test_first_order_theory_begins_at_the_original_positions() -> None:
    model = models.load("portal")
    settled = settle(model, theory="first-order").final
    settle(model).final.put(model)
    again = settle(model, theory="first-order", start=Start.present(model)).final
    assert (again.displacement == settled.displacement).all()


def test_a_curve_is_straight_between_yields_up_to_collapse() -> None:
    model = models.load("three_bar_plastic")
    limit = closed_forms.three_bar_collapse(100.0) / 240.0
    curve = Curve.of(model, Goal(2.0), theory="first-order")
    assert not curve.complete
    assert curve.load_factor[-1] == pytest.approx(limit, rel=1e-9)
    (event,) = curve.events
    assert (event.kind, event.motion[3].tolist()) == ("collapse", [0.0, -1.0])
    slope = np.diff(curve.displacement[:, 3, 1]) / np.diff(curve.load_factor)
    first = closed_forms.three_bar_first_yield(100.0) / 240.0
    before = curve.load_factor[1:] <= first * (1 + 1e-9)
    for piece in (slope[before], slope[~before]):
        assert piece == pytest.approx(piece[0], rel=1e-6)
    assert Curve.of(model, Goal.of(model, until="D.y=-0.001"), theory="first-order").complete


def test_second_order_is_told_by_its_size_and_place() -> None:
    """A cantilever under an axial load P: its moment and sway grow by about 1/(1 − P/P_cr)."""
    column = {"stiffness": 1e7, "bending_stiffness": 1000.0}
    for share in (0.002, 0.14):
        push = [1.0, -share * np.pi**2 * 1000.0 / (4.0 * 3.0**2)]
        places = [(0.0, 0.75 * i) for i in range(5)]
        made = models.load(trusses.line(places, trusses.CLAMPED, {"force": push}, **column))
        told = SecondOrder.of(made, settle(made, theory="first-order").final, settle(made).final)
        if share < 0.005:
            assert told is None
        else:
            assert told is not None
            assert told.place == "P4"
            assert told.share == pytest.approx(1.0 / (1.0 - share) - 1.0, rel=0.02)
            assert told.said == "second order: +16 % at P4"


def test_a_member_divided_in_two_yields_as_a_whole_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both halves of the column are at their strength and one shortens: that took a million steps."""
    session = Session.open("portal")
    session.rods["AB"].hinged, session.rods["AB"].rest_length = (True, True), 4.0027583138111735
    session.rods["CD"].compressive_strength = 60.0
    tried: list[float] = []
    attempt = Path.attempt

    def counted(path: Path, point: Point, tangent: Tangent, increment: float) -> Any:
        tried.append(increment)
        return attempt(path, point, tangent, increment)

    monkeypatch.setattr(Path, "attempt", counted)
    whole = settle(session.model, theory=FIRST_ORDER).final
    begun = len(tried)
    divide(session.model, [session.rods["CD"]])
    halves = settle(session.model, theory=FIRST_ORDER).final
    assert halves.displacement[:4] == pytest.approx(whole.displacement, rel=1e-9, abs=1e-12)
    assert halves.axial_force[[2, 3]] == pytest.approx(whole.axial_force[2], rel=1e-9) == -60.0
    assert len(tried) - begun <= begun + 3
