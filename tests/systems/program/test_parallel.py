"""Programs of very large models: the same bits on any number of cores, whatever else happens on the way."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.arguments import UsageError
from pinjoint.commands.options import use_cores_as_asked
from pinjoint.components.mistake import Mistake
from pinjoint.documents import models
from pinjoint.systems.base import CORES, cores
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.program import blocks as layout
from pinjoint.systems.program import reordered as in_blocks
from pinjoint.systems.program import writer
from pinjoint.systems.program.blocks import Layout
from tests.benchmarks.models import lattice
from tests.reference import bits
from tests.reference.models import model, particle, rod

WIDTH, HEIGHT = 7, 5


def net() -> dict[str, Any]:
    """A net that yields, damped, under drag and ramps; nothing about it is numbered in any order."""
    rng = np.random.default_rng(3)
    numbers = rng.permutation(WIDTH * HEIGHT)
    at = {(x, y): f"P{numbers[y * WIDTH + x]}" for x in range(WIDTH) for y in range(HEIGHT)}
    pairs = [(p, (p[0] + dx, p[1] + dy)) for p in at for dx, dy in ((1, 0), (0, 1), (1, 1))]
    rods = [
        rod(at[a], at[b], damping=2, tensile_strength=60, compressive_strength=60) for a, b in pairs if b in at
    ]
    particles = [particle(name, *p, fixed=[p[0] == 0] * 2) for p, name in at.items()]
    ramp = {"kind": "ramp", "start": 0.0002, "duration": 0.001}
    return model(
        [particles[i] for i in rng.permutation(len(particles))],
        [rods[i] for i in rng.permutation(len(rods))],
        loads=[
            {"on": at[WIDTH - 1, y], "force": [5 * y, -40], "history": ramp | {"start": 1e-4 * y}}
            for y in (3, 0, 2)
        ],
        environment={"acceleration": [0, -9.81], "drag": 3},
        settings={"integrator": "velocity_verlet", "time_step": 1e-5, "collisions": False},
    )


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models of few rods in blocks of 12."""
    monkeypatch.setattr(writer, "SMALL", 0)
    monkeypatch.setattr(writer, "BLOCKS_FROM", 1)
    monkeypatch.setattr(layout, "BLOCK", 12)
    monkeypatch.setattr(in_blocks, "_WORTHWHILE", 0)


def run(on: int, steps: int = 700, *, compiled: bool = False) -> Session:
    """The net after some steps, on so many cores, which share the blocks of machine code alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(CORES, str(on))
        session = Session.open(net())
        if compiled:
            session.simulation.program.module.load()
        assert session.run(steps=steps) == "time reached"
    return session


def assert_same(one: Session, other: Session) -> None:
    assert bits.different(bits.columns(one.model), bits.columns(other.model)) == []


def test_a_layout_has_everything_once_and_blocks_that_touch_nobody(small_blocks: None) -> None:
    whole = models.load(net())
    made = Layout.of(whole)
    assert sorted(made.particles) == list(range(whole.particles.count))
    assert sorted(made.rods) == list(range(whole.rods.count))
    assert (made.particles[made.row] == np.arange(whole.particles.count)).all()
    assert (made.particles[made.ends] == whole.rods.between[made.rods]).all()
    blocks = len(made.first_rod) - 2
    assert blocks % layout.SHARES == 0
    assert whole.rods.count / blocks <= layout.BLOCK
    for block in range(blocks):
        ends = made.ends[made.first_rod[block] : made.first_rod[block + 1]]
        assert (made.first_particle[block] <= ends).all()
        assert (ends < made.first_particle[block + 1]).all()
    assert made.first_rod[-1] - made.first_rod[-2] > 0


def test_few_rods_are_between_blocks_however_a_model_is_numbered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(layout, "BLOCK", 1250)
    for at_random in (False, True):
        whole = lattice(10_000, at_random=at_random)
        made = Layout.of(whole)
        assert made.first_rod[-1] - made.first_rod[-2] < 0.12 * whole.rods.count


def test_the_number_of_cores_changes_no_bit(small_blocks: None) -> None:
    one, several = run(on=1), run(on=8, compiled=True)
    assert one.simulation.programs.compiled.form == writer.VERY_MANY
    assert one.model.clock.dissipated_plastic > 0.0
    assert_same(one, several)


def test_blocks_find_what_loops_over_all_rods_find(small_blocks: None, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = run(on=8)
    monkeypatch.setattr(writer, "SMALL", 200)
    whole = run(on=1)
    assert whole.simulation.programs.compiled.form == writer.FEW
    for name in ("displacement", "velocity", "reaction"):
        found, expected = (getattr(s.particles, name) for s in (blocks, whole))
        assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()
    assert np.abs(blocks.rods.plastic_strain - whole.rods.plastic_strain).max() < 1e-12
    for name, value in whole.energy.as_dict().items():
        assert getattr(blocks.energy, name) == pytest.approx(value, rel=1e-9, abs=1e-9)


def test_edits_undo_and_saving_on_the_way_change_no_bit(small_blocks: None, tmp_path: Path) -> None:
    """What others change while the program holds the state in blocks is not lost."""
    straight = run(on=8, steps=400)
    models.save(run(on=8, steps=150).model, tmp_path / "net.json")
    loaded = Session.open(tmp_path / "net.json")
    loaded.run(steps=250)
    assert_same(straight, loaded)
    edited = run(on=8, steps=400)
    edited.particles["P3"].velocity = (1.0, 2.0)
    edited.run(steps=50)
    assert edited.particles["P3"].velocity != straight.particles["P3"].velocity
    edited.undo()
    edited.undo()
    assert_same(straight, edited)


def test_what_is_deleted_is_left_out(small_blocks: None) -> None:
    session = run(on=8, steps=50)
    rods = session.model.rods.count
    session.model.delete([session.particles["P3"], session.rods[0]])
    assert session.model.rods.count < rods - 1
    assert session.run(steps=50) == "time reached"
    assert np.isfinite(session.particles.displacement).all()


def test_a_hand_that_moves_is_followed(small_blocks: None) -> None:
    session = run(on=8, steps=10)
    row = session.particles["P3"].row
    session.simulation.before_change()
    held, pull = session.particles["P3"], session.document.pull
    pull.take(Hand(held, 1e3, 0.0, tuple(session.particles.displacement[row])))
    session.simulation.advance(1)
    pull.move(session.model, (5.0, 0.0))
    session.simulation.advance(200)
    assert session.particles.displacement[row, 0] > 0.01


APART = """
import sys
from pinjoint.systems.program import reordered as in_blocks
from pinjoint.systems.program import blocks as layout
from pinjoint.systems.program import writer
writer.SMALL, writer.BLOCKS_FROM, layout.BLOCK, in_blocks._WORTHWHILE = 0, 1, 12, 0
from tests.reference import bits
from tests.systems.program.test_parallel import run
print(bits.digest(run(on=8, compiled=True).model))
"""


def test_any_threading_layer_gives_the_same_bits(small_blocks: None, fresh_process: Callable[..., str]) -> None:
    assert fresh_process(APART, {"NUMBA_THREADING_LAYER": "workqueue"}).strip() == bits.digest(run(on=1).model)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_forked_process_goes_on_alone(small_blocks: None) -> None:
    session = run(on=8, steps=100, compiled=True)
    child = os.fork()
    if child == 0:
        code = 1
        try:
            session.run(steps=50)
            code = 0 if cores() == 1 else 2
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    sys.stdout.flush()


def test_the_command_line_says_how_many_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CORES, "2")
    assert use_cores_as_asked(["run", "--cores", "1", "isostatic"]) == ["run", "isostatic"]
    assert cores() == 1
    with pytest.raises(UsageError, match="0 is not a whole number of at least 1"):
        use_cores_as_asked(["run", "--cores=0"])
    monkeypatch.setenv(CORES, "abc")
    with pytest.raises(
        Mistake, match="PINJOINT_CORES is 'abc'; set it to a whole number of at least 1, or leave it out"
    ):
        use_cores_as_asked(["run"])
