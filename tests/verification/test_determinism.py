"""The same model gives the same bits: in every process, however steps are divided, saved and reloaded."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.systems.base import REVIEW_INTERVAL
from pinjoint.systems.physics.integrators import VelocityVerlet
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.models import model, particle, rod, square


def yielding() -> Model:
    """A square under ramps, an oscillating load and gravity, yielding, damped, with drag: all that keeps history."""
    document = square(force=(0, 0), tensile_strength=60, compressive_strength=60, damping=2)
    return document | {
        "environment": {"acceleration": [0, -9.81], "drag": 3.0},
        "loads": [
            {"on": "C", "force": [30, -150], "history": {"kind": "ramp", "start": 0.001, "duration": 0.05}},
            {"on": "B", "force": [10, 0], "history": {"kind": "ramp", "start": 0.03, "duration": 0.0}},
            {"on": "B", "force": [0, 5], "history": {"kind": "sine", "frequency": 40, "phase": 0}},
        ],
    }


def stiffening() -> Model:
    """A rod pulled to many times its length: tension makes it swing sideways ever faster."""
    return model(
        [
            particle("A", 0, 0, fixed=[True, True]),
            particle("M", 1, 0, velocity=[0, 30], force=[5000, 0], mass=1),
        ],
        [rod("A", "M", stiffness=1000, damping=0)],
        environment={"drag": 3.0},
    )


def with_verlet(document: Model) -> Model:
    """The same with the integrator of large models."""
    return document | {"settings": {"integrator": "velocity_verlet"}}


DOCUMENTS: dict[str, Callable[[], Model]] = {
    "yielding": yielding,
    "stiffening": stiffening,
    "yielding, Verlet": lambda: with_verlet(yielding()),
    "stiffening, Verlet": lambda: with_verlet(stiffening()),
}
EACH = pytest.mark.parametrize("title", DOCUMENTS)
CHECK_INTERVAL = VelocityVerlet.check_interval
FAR = REVIEW_INTERVAL + 3 * CHECK_INTERVAL + 77


def run(document: Model, parts: Sequence[int]) -> Session:
    session = Session.open(document)
    for steps in parts:
        assert session.run(steps=steps) == "time reached"
    assert session.model.clock.steps == sum(parts)
    return session


def assert_same(one: Session, other: Session) -> None:
    assert bits.different(bits.columns(one.model), bits.columns(other.model)) == []


@cache
def straight(title: str) -> Session:
    """All steps of a document in one go, to compare with."""
    return run(DOCUMENTS[title](), [FAR])


HASH = """
from pinjoint import Session
from tests.reference import bits
from tests.verification.test_determinism import DOCUMENTS, FAR
for make in DOCUMENTS.values():
    session = Session.open(make())
    session.run(steps=FAR)
    print(bits.digest(session.model))
"""


def test_same_bits_in_fresh_processes(fresh_process: Callable[..., str]) -> None:
    """Also with another order of sets and dicts of texts."""
    here = [bits.digest(straight(title).model) for title in DOCUMENTS]
    assert fresh_process(HASH, {"PYTHONHASHSEED": "1"}).split() == here


@EACH
@pytest.mark.parametrize(
    "parts",
    [
        [1] * 5 + [FAR - 5],
        [CHECK_INTERVAL, REVIEW_INTERVAL, FAR - CHECK_INTERVAL - REVIEW_INTERVAL],
        [CHECK_INTERVAL - 1, 2, FAR - CHECK_INTERVAL - 1],
        [997] * (FAR // 997) + [FAR % 997],
    ],
    ids=["single steps", "at intervals", "across a check", "odd"],
)
def test_dividing_the_steps_changes_nothing(title: str, parts: list[int]) -> None:
    assert_same(straight(title), run(DOCUMENTS[title](), parts))


@EACH
def test_frame_rate_changes_nothing(title: str) -> None:
    """Frames of any length show moments within steps; the steps are the same."""
    sessions = []
    for lengths in ([1 / 60], [0.003, 0.04, 0.0, 0.017], [0.1]):
        session = Session.open(DOCUMENTS[title]())
        session.simulation.advance(0)
        session.press("space")
        for _ in range(9):
            session.press("+")
        index = 0
        while session.model.clock.steps < 3000:
            session.frame(lengths[index % len(lengths)])
            index += 1
            assert index < 5000
        session.press("space")
        sessions.append(session)
    last = max(session.model.clock.steps for session in sessions)
    for session in sessions:
        with session.running() as simulation:
            simulation.go_to(last, None)
        assert_same(session, sessions[0])


@EACH
@pytest.mark.parametrize("saved_at", [1, CHECK_INTERVAL - 1, 1000, REVIEW_INTERVAL + 5])
def test_saved_and_reloaded_it_goes_on_with_the_same_bits(title: str, saved_at: int, tmp_path: Path) -> None:
    session = run(DOCUMENTS[title](), [saved_at])
    session.save(tmp_path / "model.json")
    reloaded = Session.open(tmp_path / "model.json")
    assert_same(session, reloaded)
    reloaded.run(steps=FAR - saved_at)
    assert_same(straight(title), reloaded)
    assert straight(title).energy == reloaded.energy


def test_reloading_keeps_the_step_size_until_the_next_review(tmp_path: Path) -> None:
    """A reloaded run must not heed its frequency earlier than one that was never saved."""
    session = run(with_verlet(stiffening()), [200])
    size = session.model.clock.step_size
    session.save(tmp_path / "model.json")
    reloaded = Session.open(tmp_path / "model.json")
    reloaded.run(steps=1)
    assert reloaded.model.clock.step_size == size
    fresh = Session.open(with_verlet(stiffening()))
    fresh.run(steps=REVIEW_INTERVAL)
    assert fresh.model.clock.step_size != size  # else this test could not fail


def test_saving_after_an_edit_goes_on_with_the_same_bits(tmp_path: Path) -> None:
    """The work of the edit and the step size that it asks for are not lost."""
    session = run(yielding(), [500])
    session.rods["AB"].stiffness = 200_000
    session.particles["B"].force = (5, 5)
    session.save(tmp_path / "model.json")
    reloaded = Session.open(tmp_path / "model.json")
    for each in (session, reloaded):
        each.run(steps=1000)
    assert_same(session, reloaded)
    assert session.energy == reloaded.energy


@EACH
def test_reading_changes_nothing(title: str) -> None:
    looked, ran = (Session.open(DOCUMENTS[title]()) for _ in range(2))
    assert looked.energy.imbalance == 0.0
    _ = looked.rods[0].axial_force, looked.particles[0].reaction, looked.simulation.residual
    assert_same(looked, ran)
    looked.run(steps=300)
    _ = looked.energy, looked.particles.reaction, looked.simulation.residual
    looked.frame(0.1)
    looked.run(steps=300)
    ran.run(steps=600)
    assert_same(looked, ran)


def test_a_saved_time_is_kept(tmp_path: Path) -> None:
    """A document may say at which time it begins, without having run before."""
    document = with_verlet(yielding()) | {"state": {"time": 0.02}}
    session = Session.open(document)
    applied = session.particles["C"].applied_force
    assert session.time == 0.02
    assert applied[0] == pytest.approx(30 * (0.02 - 0.001) / 0.05, rel=1e-12)
    session.run(steps=1)
    assert session.time == pytest.approx(0.02 + session.model.clock.step_size, rel=1e-15)


SETTLED = """
import hashlib
from pinjoint.systems.statics.settle import settle
from tests.benchmarks.models import lattice
found = hashlib.sha256()
for rods in (150, 300):
    for strength in (None, 20.0):
        model = lattice(rods, tensile_strength=strength, compressive_strength=strength)
        for state in settle(model, (1.0, 0.0)).states:
            found.update(state.displacement.tobytes() + state.axial_force.tobytes())
print(found.hexdigest())
"""


def test_settling_has_the_same_bits_on_any_number_of_threads_of_the_linear_algebra_library(fresh_process):
    chosen = [{f"{library}_NUM_THREADS": threads for library in ("OPENBLAS", "MKL", "OMP")} for threads in "13"]
    assert len({fresh_process(SETTLED, environment) for environment in chosen}) == 1
