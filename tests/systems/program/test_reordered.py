"""Programs that hold a part of a model: the same bits, by the same compiled code, and the rest is left alone."""

import numpy as np
import pytest

from pinjoint.documents import models
from pinjoint.session import Session
from pinjoint.systems.catalogue import step_systems
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program import blocks as layout
from pinjoint.systems.program import reordered as in_blocks
from pinjoint.systems.program import writer
from pinjoint.systems.program.reordered import ReorderedProgram, make_program
from pinjoint.systems.schedule import Schedule
from tests.reference.elements import Model
from tests.systems.program.test_parallel import net

APART = (20.0, 3.0)  # m


def two_nets() -> Model:
    """The same net twice, with rods, particles and loads of both in turns."""
    document = net()
    for kind in ("particles", "rods", "loads"):
        document[kind] = [e for one in document[kind] for e in (one, second(one))]
    return document


def second(element: Model) -> Model:
    other = element | {key: f"{element[key]}'" for key in ("name", "on") if key in element}
    if "between" in element:
        other["between"] = [f"{name}'" for name in element["between"]]
    if "position" in element:
        other["position"] = [x + d for x, d in zip(element["position"], APART, strict=True)]
    return other


@pytest.mark.parametrize("form", [writer.FEW, writer.MANY, writer.VERY_MANY])
def test_a_part_moves_with_the_bits_of_the_whole(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(layout, "BLOCK", 12)
    monkeypatch.setattr(in_blocks, "_WORTHWHILE", 0)
    both, one = (Session.open(two_nets()).model for _ in range(2))
    systems, integrator = Schedule(step_systems()).step_plan("simulation", both), INTEGRATORS["velocity_verlet"]
    moving = np.array([not name.endswith("'") for name in one.particles.column("name")])
    whole = make_program(both, systems, integrator, form)
    part = ReorderedProgram(one, systems, integrator, form, moving)
    assert part.module is whole.module
    for program in (whole, part):
        program.module.load()
    assert len(whole.module.form.advance.signatures) == 1
    for program in (whole, part):
        program.model.writable("clock.step_size")[0] = 1e-5
        program.advance(300)
    for name in ("displacement", "velocity"):
        columns = [getattr(model.particles, name) for model in (both, one)]
        assert columns[1][moving].any()
        assert columns[0][moving].tobytes() == columns[1][moving].tobytes()
        assert not columns[1][~moving].any()
    of_it = moving[one.rods.between[:, 0]]
    assert both.rods.plastic_strain[of_it].tobytes() == one.rods.plastic_strain[of_it].tobytes()
    assert not one.rods.plastic_strain[~of_it].any()


def test_particles_that_hold_what_moves_are_part_of_it() -> None:
    model = models.load(net())
    moving = (model.particles.mobility > 0.0).any(axis=1)
    made = layout.Layout.in_order(model).part(moving)
    assert len(made.rods) < model.rods.count  # those between supports
    assert (made.particles[made.ends] == model.rods.between[made.rods]).all()
