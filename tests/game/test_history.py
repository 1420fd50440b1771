"""Random sequences of edits and runs: undone to the first bit, done again to the last, the energy accounted for."""

import contextlib
from collections.abc import Callable
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from tests.properties.soundness import contents
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.models import model, particle, square, triangle
from tests.reference.sessions import put_states_aside, states_put_aside

Step = tuple[str, Any]

ROUND_OFF = 1e-11  # of all energy that was turned over
INTEGRATION = 0.03  # of it; the automatic step is a tenth of the stable one


def structure() -> Model:
    """A square that has everything, whose plan no edit below changes: one program for all examples."""
    document = square(force=(10, -40), tensile_strength=60, compressive_strength=60, damping=8)
    return document | {
        "environment": {"acceleration": [0, -9.81], "drag": 2.0},
        "loads": [{"on": "B", "force": [8, 3], "history": {"kind": "ramp", "duration": 0.01}}],
    }


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.integers(0, 100).map(lambda k: low + (high - low) * k / 100)


def pairs(size: float) -> st.SearchStrategy[tuple[float, float]]:
    return st.tuples(numbers(-size, size), numbers(-size, size))


PARTICLES, RODS = st.sampled_from("ABC"), st.sampled_from(["AB", "BC", "CD", "DA", "AC", "BD"])

EDITS = st.one_of(
    st.tuples(st.just("force"), st.tuples(PARTICLES, pairs(60.0))),
    st.tuples(st.just("velocity"), st.tuples(PARTICLES, pairs(2.0))),
    st.tuples(st.just("displacement"), st.tuples(PARTICLES, pairs(1e-4))),
    st.tuples(st.just("fixed"), st.tuples(PARTICLES, st.tuples(st.booleans(), st.booleans()))),
    st.tuples(st.just("position"), st.tuples(PARTICLES, pairs(0.2))),
    st.tuples(st.just("mass"), st.tuples(PARTICLES, numbers(5.0, 50.0))),
    st.tuples(st.just("stiffness"), st.tuples(RODS, numbers(5e4, 3e5))),
    st.tuples(st.just("tensile_strength"), st.tuples(RODS, numbers(5.0, 80.0))),
    st.tuples(st.just("plastic_strain"), st.tuples(RODS, numbers(-1e-4, 1e-4))),
    st.tuples(st.just("damping"), st.tuples(RODS, numbers(1.0, 20.0))),
    st.tuples(st.just("drag"), numbers(0.1, 5.0)),
    st.tuples(st.just("load"), pairs(30.0)),
    st.tuples(st.just("grow"), pairs(0.5)),
    st.tuples(st.just("shrink"), st.none()),
)
RUNS = st.one_of(
    st.tuples(st.just("steps"), st.integers(1, 400)), st.tuples(st.just("time"), numbers(1e-5, 2e-3))
)
BACK_AND_FORTH = st.tuples(st.sampled_from(["undo", "redo", "restart"]), st.none())


def perform(session: Session, step: Step) -> None:
    """Do one thing that a person can do; what is refused is not done."""
    kind, value = step
    with contextlib.suppress(FieldError):
        _DEEDS[kind](session, value)


def _assign(table: str, field: str) -> Callable[[Session, Any], None]:
    def deed(session: Session, value: Any) -> None:
        name, new = value
        if name in session.model.tables[table]:
            setattr(session.model.tables[table][name], field, new)

    return deed


def _grow(session: Session, value: Any) -> None:
    """A new particle, tied to A and C."""
    with session.model.transaction("grow"):
        made = session.model.create(Particle, position=[(-1.0 + value[0], 2.5 + value[1])])[0]
        session.model.create(Rod, between=[(0, made.row), (2, made.row)], damping=5.0)


def _shrink(session: Session, value: Any) -> None:
    """The newest particle that was added goes, with its rods."""
    if len(session.particles) > 4:
        session.model.delete([session.particles[-1]])


_DEEDS: dict[str, Callable[[Session, Any], Any]] = {
    **{field: _assign("particles", field) for field in ("force", "velocity", "displacement", "fixed", "mass")},
    **{f: _assign("rods", f) for f in ("stiffness", "tensile_strength", "plastic_strain", "damping")},
    "position": lambda s, v: _move(s, v[0], v[1]),
    "drag": lambda s, v: setattr(s.environment, "drag", v),
    "load": lambda s, v: setattr(s.loads[0], "force", v),
    "grow": _grow,
    "shrink": _shrink,
    "steps": lambda s, v: s.run(steps=v),
    "time": lambda s, v: s.run(time=v),
    "undo": lambda s, v: s.undo(),
    "redo": lambda s, v: s.redo(),
    "restart": lambda s, v: s.restart(),
}


def _move(session: Session, name: str, by: tuple[float, float]) -> None:
    x, y = session.particles[name].position
    session.particles[name].position = (x + by[0], y + by[1])


@settings(max_examples=15)
@given(st.lists(st.one_of(EDITS, RUNS), min_size=1, max_size=8))
def test_undo_goes_back_entry_by_entry_through_every_state(steps: list[Step]) -> None:
    session = Session.open(structure())
    seen = [bits.columns(session.model)]
    for step in steps:
        before = len(seen)
        perform(session, step)
        now = bits.columns(session.model)
        if now != seen[-1]:
            seen.append(now)
        assert len(seen) <= before + 1
    for expected in reversed(seen[:-1]):
        assert session.undo()
        assert bits.different(bits.columns(session.model), expected) == []
    for expected in seen[1:]:
        assert session.redo()
        assert bits.different(bits.columns(session.model), expected) == []


@settings(max_examples=15)
@given(st.lists(st.one_of(EDITS, RUNS, BACK_AND_FORTH), min_size=2, max_size=14))
def test_edits_count_as_work_and_leave_the_energy_balanced(steps: list[Step]) -> None:
    """An edit changes the imbalance by round-off only, a run by the error of integration."""
    session = Session.open(structure())
    turnover = 1e-3
    for kind, value in steps:
        before = session.energy
        perform(session, (kind, value))
        after = session.energy
        turnover = max([turnover, *(abs(e) for energy in (before, after) for e in energy.as_dict().values())])
        if kind in ("steps", "time"):
            assert abs(after.imbalance - before.imbalance) <= INTEGRATION * turnover
        elif kind not in ("undo", "redo", "restart"):
            assert abs(after.imbalance - before.imbalance) <= ROUND_OFF * turnover
        assert abs(after.imbalance) <= 3 * INTEGRATION * turnover


def test_work_of_an_edit_is_the_energy_that_it_gives() -> None:
    """A velocity given to a particle at rest does ½mv²; a force given where it is displaced does none yet."""
    session = Session.open(structure())
    session.run(until="rest")
    before = session.energy
    particle = session.particles["B"]
    particle.velocity = (3.0, 4.0)
    session.simulation.advance(0)
    kinetic = particle.mass * 25.0 / 2
    assert abs(session.energy.work - before.work - kinetic) <= 1e-9 * kinetic
    work = session.energy.work
    particle.force = (100.0, 0.0)
    session.simulation.advance(0)
    assert abs(session.energy.work - work) <= 1e-9 * kinetic


def test_states_that_were_put_aside_come_back_with_the_paths_of_discs() -> None:
    session = Session.open("collision_i")
    put_states_aside(session, beyond=0)
    start = bits.columns(session.model)
    for _ in range(3):
        session.run(time=0.2)
        session.particles[0].force = (0.0, 0.001)
    session.run(time=0.2)
    end = bits.columns(session.model)
    assert states_put_aside(session) == 4
    while session.undo():
        pass
    assert bits.different(bits.columns(session.model), start) == []
    while session.redo():
        pass
    assert bits.different(bits.columns(session.model), end) == []


def test_what_a_script_deletes_is_undone_by_name() -> None:
    session = Session.open("isostatic")
    session.model.delete([session.rods["AB"]])
    assert session.undo() == "delete"
    assert session.redo() == "delete"


def test_what_was_moved_apart_before_an_edit_is_so_again_when_that_is_redone() -> None:
    """A run that no time passed in, but that parted discs, is undone and redone with the edit that followed."""
    discs = [particle("A", 0.0, 0.0), particle("B", 0.06, 0.0), particle("C", 1.0, 0.0)]
    session = Session.open(model(discs, []))
    session.press("space")
    session.press("u")  # any key accounts for edits, as a frame does
    session.select(session.particles["C"])
    session.press("c", (0.0, 0.0))
    session.press("space")
    assert session.particles["B"].displacement[0] > 0.0
    assert session.model.clock.steps == 0
    after = contents(session.model)
    assert session.undo()
    assert session.particles["B"].displacement[0] == 0.0
    before = contents(session.model)
    assert session.redo()
    assert contents(session.model) == after
    assert session.undo()
    assert contents(session.model) == before


def test_settling_at_the_end_of_a_load_is_repeated_there() -> None:
    """Settling sets the clock to the time from which the loads are constant; undo and redo do so, too."""
    rising = {"kind": "table", "times": [0.0, 0.5], "factors": [0.0, 1.0]}
    session = Session.open(triangle() | {"loads": [{"on": "B", "force": [0.0, -10.0], "history": rising}]})
    session.press("e")
    settled = contents(session.model)
    assert session.time == 0.5
    session.undo()
    assert session.time == 0.0
    session.redo()
    assert session.time == 0.5
    assert contents(session.model) == settled
