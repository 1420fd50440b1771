"""Members that bend, in step programs: against the energy that their forces derive from."""

import numpy as np
import pytest

from game import Session
from game.documents.document import parse
from systems.physics.integrators import INTEGRATORS
from systems.program.writer import FEW, MANY, VERY_MANY
from systems.program.parallel import make_program
from tests.reference import frames


def program_of(model, integrator="velocity_verlet", form=FEW):  # type: ignore[no-untyped-def]
    session = Session(model)
    return session, make_program(session.model, session.simulation.programs.plan, INTEGRATORS[integrator], form)


@pytest.mark.parametrize("number", range(12))
@pytest.mark.parametrize(("loaded", "warm"), [(False, False), (True, False), (False, True), (True, True)])
def test_forces_are_the_derivatives_of_the_energy(number: int, loaded: bool, warm: bool) -> None:
    model = parse(frames.random_frame(np.random.default_rng([30, number]), loaded=loaded, warm=warm))
    session, program = program_of(model)
    program.observe()
    force, moment = frames.forces(session.model)
    free = session.model.particles.turning > 0.0
    size = max(np.abs(session.model.rods.axial_force).max(), np.abs(session.model.rods.end_moment).max())
    bound = 1e-14 * size + 2e-16 * session.model.rods.stiffness.max()  # displacements are as large as the rods
    assert np.abs(program.unbalanced - force).max() <= bound
    assert np.abs((program.unbalanced_moment - moment)[free]).max() <= bound
