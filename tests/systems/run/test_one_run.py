"""One model, one run: looking at a moment, in whatever way, changes no bit of what comes after."""

import io
import json
import math
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.documents.document import document, parse
from pinjoint.documents.format import ModelError
from pinjoint.scripts.playing import Recorder, play
from pinjoint.scripts.script import Script
from pinjoint.systems.base import StopReason
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.program.program import Program
from pinjoint.systems.run.program_steps import ProgramSteps
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.models import model, oscillator, particle

END = 0.6
LOOKS = [0.05, 0.0501, 0.17, 0.2, 0.31, 0.4, 0.52]


def _moving(**settings: Any) -> Model:
    return {**oscillator(2 * math.pi, 0.1, velocity=[0.1, 0]), "settings": settings}


def _yielding() -> Model:
    made = _moving()
    made["rods"] = [rod | {"tensile_strength": 2e-4} for rod in made["rods"]]
    return made


def _discs(drag: float = 0.0, **settings: Any) -> Model:
    """Two discs that bounce between two that are held."""
    return model(
        [
            particle("A", 0, 0, velocity=[3, 0.5], mass=1, radius=0.1),
            particle("B", 0.6, 0.1, velocity=[-2, 0], mass=2, radius=0.1),
            particle("C", 1.2, 0, fixed=[True, True], radius=0.1),
            particle("D", -0.6, 0, fixed=[True, True], radius=0.1),
        ],
        [],
        environment={"drag": drag},
        settings=settings,
    )


def _stacked(aside: float = 0.0, **settings: Any) -> Model:
    """Two discs that come to lie on a third; a pulse and a ramp lift them off again."""
    return model(
        [
            particle("A", 0, 0, fixed=[True, True], radius=0.1),
            particle("B", 0, 0.22, mass=1, radius=0.1),
            particle("C", aside, 0.45, mass=2, radius=0.1),
        ],
        [],
        environment={"acceleration": [0, -9.81], "drag": 0.3},
        loads=[
            {"on": "B", "force": [0, 0.05], "history": {"kind": "pulse", "start": 0.5, "duration": 0.05}},
            {"on": "C", "force": [0, 0.06], "history": {"kind": "ramp", "start": 0.7, "duration": 0.05}},
        ],
        settings={"restitution": 0.2, **settings},
    )


CASES = {
    "automatic": _moving(),
    "Verlet": _moving(integrator="velocity_verlet"),
    "fixed steps of Verlet": _moving(integrator="velocity_verlet", time_step=0.013),
    "fixed steps of rk4": _moving(integrator="rk4", time_step=0.07),
    "esdirk4": _moving(integrator="esdirk4"),
    "yielding": _yielding(),
    "flight": _discs(),
    "driven": _discs(drag=0.3),
    "driven by Verlet": _discs(drag=0.3, integrator="velocity_verlet"),
}
EACH = pytest.mark.parametrize("made", CASES.values(), ids=CASES)


def _run_to(session: Session, time: float) -> None:
    session.simulation.run_to(time)


def _left_alone(made: Model, time: float = END) -> Session:
    session = Session.open(made)
    _run_to(session, time)
    assert session.time == time
    return session


def _assert_same(one: Session, other: Session) -> None:
    assert bits.different(bits.columns(one.model), bits.columns(other.model)) == []


@EACH
def test_looking_at_moments_changes_nothing(made: Model) -> None:
    looked_at = Session.open(made)
    for time in LOOKS:
        looked_at.run(time=time - looked_at.time)
        _ = looked_at.energy, looked_at.rods.axial_force
    _run_to(looked_at, END)
    _assert_same(_left_alone(made), looked_at)


@pytest.mark.parametrize(
    ("made", "looks"),
    [(_stacked(aside=0.005), 37), (_stacked(integrator="rk4", time_step=0.003), 211)],
    ids=["as contacts end", "as a load jumps within a step"],
)
def test_looking_changes_nothing_of_what_lies_on_something(made: Model, looks: int) -> None:
    end, looked_at = 0.9, Session.open(made)
    for number in range(1, looks):
        _run_to(looked_at, end * number / looks)
    _run_to(looked_at, end)
    _assert_same(_left_alone(made, end), looked_at)


@EACH
@pytest.mark.parametrize("rate", [25.0, 71.0])
def test_frames_change_nothing(made: Model, rate: float) -> None:
    shown = Session.open(made)
    shown.press("space")
    while shown.time < 0.9 * END:
        shown.frame(1.0 / rate)
    shown.press("space")
    _run_to(shown, END)
    _assert_same(_left_alone(made), shown)


@EACH
def test_a_run_saved_within_a_step_goes_on_as_if_it_had_not_been(made: Model, tmp_path: Path) -> None:
    saved = _left_alone(made, LOOKS[2])
    saved.save(tmp_path / "within.json")
    again = Session.open(tmp_path / "within.json")
    _assert_same(saved, again)
    _run_to(again, END)
    _assert_same(_left_alone(made), again)


@EACH
def test_undo_returns_to_a_moment_and_the_run_goes_on_from_it(made: Model) -> None:
    session = _left_alone(made, LOOKS[2])
    session.particles[0].mass = 7.0
    assert session.model.clock.departure is None
    session.run(time=0.1)
    session.undo()
    session.undo()
    _assert_same(_left_alone(made, LOOKS[2]), session)
    _run_to(session, END)
    _assert_same(_left_alone(made), session)


@EACH
def test_an_edit_within_a_step_is_made_at_that_moment_and_repeated_exactly(made: Model, tmp_path: Path) -> None:
    (tmp_path / "made.json").write_text(json.dumps(made), encoding="utf-8")
    session = Session.open(tmp_path / "made.json")
    recorded = io.StringIO()
    Recorder(session, recorded, str(tmp_path / "made.json"))
    session.press("space")
    for length in (0.03, 0.011, 0.06, 0.017):
        session.frame(length)
    session.press("p", session.point(0.5, 0.4))  # a new particle
    for length in (0.03, 0.011):
        session.frame(length)
    session.press("space")
    assert session.particles.count > len(made["particles"])
    script = tmp_path / "recorded.jsonl"
    script.write_text(recorded.getvalue(), encoding="utf-8")
    again = Session.open(made)
    assert play(Script(script), again) == []
    _assert_same(session, again)


def test_stepping_goes_from_one_whole_step_to_the_next() -> None:
    session = _left_alone(_moving(), LOOKS[2])
    whole, within = session.simulation.moment
    assert within == LOOKS[2]
    assert session.model.clock.steps == whole + 1
    assert session.step(1)
    assert session.simulation.moment == (whole + 1, None)
    after = bits.columns(session.model)
    _run_to(session, session.time + 0.01)
    assert session.step(-1)
    assert bits.different(bits.columns(session.model), after) == []


@EACH
def test_a_moment_within_a_step_is_found_from_another_one_of_that_step(made: Model) -> None:
    shown, found = Session.open(made), Session.open(made)
    for number in range(1, 60):
        _run_to(shown, 0.01 * number)
        with found.running() as simulation:
            simulation.go_to(*shown.simulation.moment)
        assert (found.time, found.simulation.moment) == (shown.time, shown.simulation.moment)
    _assert_same(shown, found)


@pytest.mark.parametrize("name", ["automatic", "fixed steps of Verlet", "driven", "flight"])
def test_what_a_hand_did_within_steps_is_done_again(name: str) -> None:
    session = Session.open(CASES[name])
    session.press("space")
    session.frame(0.02)
    hand = Hand.on(session.model, session.view, session.particles["B"], lambda: 1.0)
    session.document.timeline.hold(hand)
    for number in range(5):
        session.document.timeline.hold(hand.at((0.01 * number, 0.0)))
        session.frame(0.013)
    session.document.timeline.hold(None)
    session.frame(0.013)
    session.press("space")
    session.step(1)
    steps, there = session.model.clock.steps, bits.columns(session.model)
    session.run(time=0.1)
    assert session.document.timeline.go_to(steps)
    assert bits.different(bits.columns(session.model), there) == []


@pytest.mark.parametrize("how", [["run", "isostatic", "--until-rest"], ["verify", "isostatic"]])
def test_every_way_to_run_is_the_same_run(how: list[str], answer: Any) -> None:
    session = Session.open("isostatic")
    assert session.run(until="rest") == "at rest"
    found = answer(*how)
    found = found.get("simulation", found)
    assert (found["time"], found["steps"]) == (session.time, session.model.clock.steps)
    assert session.model.clock.steps < 100


def test_a_report_has_the_bits_of_a_session(answer: Any) -> None:
    session = Session.open("isostatic")
    session.run(time=0.0023)
    (_, found) = answer("run", "isostatic", "--at", "0.001,0.0023")["states"]
    assert found["particles"]["B"]["displacement"] == list(session.particles["B"].displacement)
    assert found["rods"]["AB"]["axial_force"] == session.rods["AB"].axial_force


def test_a_run_that_fails_after_undo_goes_back_to_a_whole_step(monkeypatch: pytest.MonkeyPatch) -> None:
    session = _left_alone(CASES["fixed steps of Verlet"], LOOKS[2])
    simulation = session.simulation
    whole, within = simulation.moment
    assert within is not None
    session.run(time=0.1)
    session.undo()
    monkeypatch.setattr(ProgramSteps, "advance", lambda *_: (0, StopReason.DIVERGED))
    assert session.run(steps=1) == "diverged"
    assert simulation.moment == (whole, None)


@pytest.mark.parametrize("name", ["automatic", "Verlet", "driven"])
def test_an_interrupt_leaves_a_whole_step(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session.open(CASES[name])
    enters = "drive" if name == "driven" else "advance"
    advance = getattr(Program, enters)

    def interrupted(program: Program, *bounds: Any) -> Any:
        done = advance(program, *bounds)
        if session.time > 0.2:
            session.model.writable("clock.steps")[0] = 3  # as where the clock is still to follow
            raise KeyboardInterrupt
        return done

    session.run(time=0.1)
    with monkeypatch.context() as patched:
        patched.setattr(Program, enters, interrupted)
        with pytest.raises(KeyboardInterrupt):
            session.run(time=END)
    _run_to(session, END)
    _assert_same(_left_alone(CASES[name]), session)


def test_a_damaged_departure_is_refused_by_name() -> None:
    session = _left_alone(_moving(), LOOKS[2])
    damages: dict[str, Any] = {
        "particles.displacement": [[0, 0]],
        "clock.time": ["x"],
        "clock.work": 3,
        "clock.departure": [{}],
    }
    for key, value in damages.items():
        made = document(session.model)
        made["state"]["departure"][key] = value
        with pytest.raises(ModelError, match=rf"state\.departure\.{key}"):
            parse(made)


@pytest.mark.parametrize("size", [{}, {"radius": 0.1}], ids=["alone", "beside a disc"])
def test_a_moment_that_too_many_parts_of_a_step_lead_to_is_not_shown(size: dict[str, float]) -> None:
    """The step is a million times as long as what happens allows, which shows once it is begun."""
    made = oscillator(3e6, force=10.0, **size)
    made["particles"].append(particle("C", 5.0, 0.0, mass=1.0, **size))
    made |= {"settings": {"integrator": "dop853"}, "state": {"time": 0.0, "step_size": 1.0, "steps": 0}}
    looked_at, left_alone = Session.open(made), Session.open(made)
    looked_at.simulation.advance(0)
    assert not looked_at.simulation.show(0.5)
    for session in (looked_at, left_alone):
        session.step(3)
    assert 0.0 < looked_at.time < 1e-3
    _assert_same(left_alone, looked_at)
