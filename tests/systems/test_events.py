"""Events: a compiled predicate ends a step where it changes sign, and a handler changes the model by commands."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from numba import njit

from pinjoint import Session
from pinjoint.commands.analysis import Analysis
from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.systems.base import EVENT_INTERVAL, Event, Phase, System
from pinjoint.systems.program.binding import ProgramError
from tests.reference import bits, models
from tests.reference.models import oscillator

OMEGA, LIMIT = 20.0, 0.5  # rad/s; share of the largest elongation at which a rod breaks


@njit
def _within(elongation: float, rods_rest_length: float) -> float:
    return 1.0 - elongation / rods_rest_length / 1e-3


class Breaking(Event):
    """A rod breaks at a strain of 1e-3."""

    name = "test.breaking"
    kernel = _within
    reads = ("rods.rest_length",)

    def __init__(self) -> None:
        self.times: list[float] = []

    def happen(self, model: Model, fallen: Sequence[Handle], risen: Sequence[Handle]) -> None:
        self.times.append(model.clock.time)
        model.delete(fallen)


@njit
def _above(particles_displacement: tuple[float, float]) -> float:
    return particles_displacement[0] / 1e-3


class Crossing(Event):
    """Notes when a particle passes its original position, and which way."""

    name = "test.crossing"
    each = "particles"
    kernel = _above
    reads = ("particles.displacement",)

    def __init__(self) -> None:
        self.seen: list[tuple[float, str, int]] = []

    def happen(self, model: Model, fallen: Sequence[Handle], risen: Sequence[Handle]) -> None:
        for way, handles in (("fell", fallen), ("rose", risen)):
            self.seen += [(model.clock.time, way, handle.row) for handle in handles]


def pulled(integrator: str = "automatic", **settings: Any) -> dict[str, Any]:
    """A mass that flies off once the rod that holds it breaks: x = (v/ω) sin ωt reaches 1e-3 m at half its largest."""
    speed = OMEGA * 1e-3 / LIMIT
    document = oscillator(OMEGA)
    document["particles"][1]["velocity"] = [speed, 0.0]
    document["settings"] = {"integrator": integrator, "collisions": False, **settings}
    return document


BREAKS = math.asin(LIMIT) / OMEGA  # s


def test_a_rod_breaks_at_the_instant_at_which_its_strain_reaches_the_limit() -> None:
    breaking = Breaking()
    session = Session.open(pulled(), [breaking])
    session.run(time=0.2)
    assert breaking.times == pytest.approx([BREAKS], rel=1e-9)
    assert session.rods.count == 0
    free = OMEGA * 1e-3 / LIMIT * math.cos(math.asin(LIMIT))  # m/s, that it keeps
    assert session.particles[1].velocity[0] == pytest.approx(free, rel=1e-9)
    assert session.particles[1].displacement[0] == pytest.approx(1e-3 + free * (0.2 - BREAKS), rel=1e-9)


@pytest.mark.parametrize("integrator", ["rk4", "dop853", "esdirk4"])
def test_integrators_that_locate_events_agree(integrator: str) -> None:
    breaking = Breaking()
    session = Session.open(pulled(integrator), [breaking])
    session.run(time=0.1)
    assert breaking.times == pytest.approx([BREAKS], rel=1e-5 if integrator == "rk4" else 1e-8)


@pytest.mark.parametrize("integrator", ["velocity_verlet", "semi_implicit_euler", "taylor2"])
def test_others_end_the_first_step_that_passes_it(integrator: str) -> None:
    breaking = Breaking()
    session = Session.open(pulled(integrator, time_step=1e-5), [breaking])
    session.run(time=0.1)
    (happened,) = breaking.times
    assert happened == pytest.approx(BREAKS, abs=3e-5)
    assert happened / 1e-5 == pytest.approx(round(happened / 1e-5), abs=1e-6)


def test_nothing_happens_twice_nor_where_nothing_changes_sign() -> None:
    crossing = Crossing()
    document = oscillator(OMEGA)
    document["particles"][1]["velocity"] = [1e-3 * OMEGA, 0.0]
    document["settings"] = {"collisions": False}
    session = Session.open(document, [crossing])
    session.run(time=2.0 * math.pi / OMEGA * 2.25)
    half = math.pi / OMEGA
    seen = [(time, way) for time, way, row in crossing.seen if row == 1]
    assert [way for _, way in seen] == ["rose", "fell", "rose", "fell", "rose"][-len(seen) :]
    assert [time for time, _ in seen if time > 0.0] == pytest.approx(
        [half, 2 * half, 3 * half, 4 * half], rel=1e-8
    )


# --- taken back, saved, switched off ---------------------------------------------------------------------------


def test_a_break_is_taken_back_by_undo_and_comes_again_at_the_same_time() -> None:
    breaking = Breaking()
    session = Session.open(pulled(), [breaking])
    session.run(time=0.1)
    broken = bits.state(session.model)
    while session.document.history.can_undo:
        session.undo()
    assert (session.rods.count, session.time) == (1, 0.0)
    session.run(time=0.1)
    assert bits.state(session.model) == broken
    assert breaking.times[0] == breaking.times[1]


def test_a_saved_run_goes_on_as_if_it_had_not_been_saved(tmp_path: Path) -> None:
    crossing, again = Crossing(), Crossing()
    document = oscillator(OMEGA)
    document["particles"][1]["velocity"] = [1e-3 * OMEGA, 0.0]
    document["settings"] = {"collisions": False}
    session = Session.open(document, [crossing])
    session.run(steps=40)
    session.save(tmp_path / "half.json")
    other = Session.open(tmp_path / "half.json", [again])
    before = len(crossing.seen)
    for one in (session, other):
        one.run(steps=200)
    assert again.seen == crossing.seen[before:]
    assert bits.state(other.model) == bits.state(session.model)


def test_reports_at_times_neither_miss_nor_move_an_event() -> None:
    breaking = Breaking()
    plain = Session.open(pulled(), [breaking])
    plain.run(time=0.2)
    (when,) = breaking.times
    other = Breaking()
    session = Session.open(pulled(), [other])
    found = Analysis(times=(0.9 * when, 0.999999 * when, 1.000001 * when, 0.15)).run_in(session, "held")
    assert other.times == [when]
    assert [len(state["rods"]) for state in found["states"]] == [1, 1, 0, 0]


class Straining(System):
    """Notes in phase EVENTS at which steps it ran, and stiffens a rod once."""

    name = "test.straining"
    phase = Phase.EVENTS
    scenes = ("simulation",)

    def __init__(self) -> None:
        self.steps: list[int] = []

    def process(self, frame: Any) -> None:
        self.steps.append(frame.model.clock.steps)
        if len(self.steps) == 3:
            frame.session.rods[0].stiffness *= 2.0


def test_systems_of_phase_events_run_without_frames_at_fixed_step_counts() -> None:
    one, other = Straining(), Straining()
    whole, halves = Session.open(pulled(), [one]), Session.open(pulled(), [other])
    stiffness = whole.rods[0].stiffness
    whole.run(steps=96)
    halves.run(steps=48)
    halves.run(steps=48)
    assert set(range(0, 96, EVENT_INTERVAL)) <= set(one.steps)
    assert one.steps[-1] == 96
    assert whole.rods[0].stiffness == 2.0 * stiffness
    assert sorted(set(one.steps)) == sorted(set(other.steps))


def test_steps_that_diverge_break_nothing() -> None:
    breaking = Breaking()
    session = Session.open("isostatic", [breaking])
    session.settings.integrator, session.settings.time_step = "velocity_verlet", 0.001
    assert session.run(time=0.01) == "diverged"
    assert (breaking.times, session.rods.count, session.time) == ([], 3, 0.0)


def test_a_report_within_a_fixed_step_that_an_event_ends_is_of_its_time() -> None:
    document = pulled("rk4", time_step=0.004)
    plain, reported = Breaking(), Breaking()
    run = Session.open(document, [plain])
    run.run(time=0.0275)
    session = Session.open(document, [reported])
    (state,) = Analysis(times=(0.0275,)).run_in(session, "held")["states"]
    assert state["time"] == 0.0275
    assert reported.times == pytest.approx(plain.times, rel=1e-12)
    moved = state["particles"][run.particles[1].name]["displacement"]
    assert moved == pytest.approx(run.particles[1].displacement, rel=1e-12)


def test_what_happened_is_listed_without_what_was_taken_back() -> None:
    session = Session.open(pulled(), [Breaking()])
    session.run(time=0.1)
    (event,) = session.simulation.events
    while session.document.history.can_undo:
        session.undo()
    assert session.simulation.events == []
    while session.document.history.can_redo:
        session.redo()
    assert session.simulation.events == [event]
    session.restart()
    assert session.simulation.events == []
    session.run(time=0.1)
    assert session.simulation.events == []  # the rod is broken


def test_an_event_may_read_what_collisions_change() -> None:
    class Fast(Crossing):
        name = "test.fast"
        reads = ("particles.displacement", "particles.velocity")

    Session.open("ball_on_truss", [Fast()]).run(steps=2)


def test_an_event_for_neither_rods_nor_particles_is_refused_by_name() -> None:
    class Wrong(Breaking):
        name = "test.wrong"
        each = "loads"

    with pytest.raises(ProgramError, match=r"test\.wrong has each = 'loads'; choose rods or particles"):
        Session.open(pulled(), [Wrong()]).run(steps=1)


def bouncing(wall: float) -> dict[str, Any]:
    """A particle under drag that flies to a wall, at most 0.5 m, and back; where it was drawn, its quantity changes sign."""
    return models.model(
        [models.particle("p", 0.0, 0.0, displacement=[0.5, 0.0], velocity=[-5.0, 0.0])],
        [],
        environment={"drag": 0.1},
        components={"walls.Wall": [{"name": "w", "start": [wall, -1.0], "end": [wall, 1.0]}]},
    )


def test_what_a_step_that_is_taken_again_would_have_led_to_does_not_happen() -> None:
    """Error control would have steps lead beyond the wall."""
    crossing = Crossing()
    session = Session.open(bouncing(-0.04), [crossing])
    session.run(time=0.3)
    assert len(session.impacts) == 1
    assert crossing.seen == []


def test_events_happen_between_impacts_again_after_undo() -> None:
    """v = v₀ exp(−c t) at first: 0.5 m are past at −ln(1 − 0.01)/0.1 s."""
    crossing = Crossing()
    session = Session.open(bouncing(-0.55), [crossing])
    session.run(time=0.05)
    session.run(time=0.2)
    (first,) = crossing.seen
    assert first == (pytest.approx(-10.0 * math.log(0.99), rel=1e-9), "fell", 0)
    session.undo()
    session.run(time=0.4)
    assert len(session.impacts) == 1
    assert crossing.seen[:2] == [first, first]
    assert [way for _, way, _ in crossing.seen] == ["fell", "fell", "rose"]
