"""Motion at its limits, by every integrator: the answer is right, or the program says why it is not."""

import pytest

from pinjoint import Session
from pinjoint.components.settings import AUTOMATIC, INTEGRATORS
from pinjoint.systems.physics import integrators
from tests.reference.models import model, particle, rod
from tests.stability.cases import SHARES, Case, cases, follow, stepping

# Relative to the largest displacement, at automatic steps; the first order integrators are there to compare with.
ALLOWED = {
    AUTOMATIC: 1e-6,
    "dop853": 1e-6,
    "esdirk4": 1e-5,
    "rk4": 1e-2,
    "velocity_verlet": 0.1,
    "semi_implicit_euler": 0.1,
    "taylor2": 0.1,
}
MOST_STEPS = 20_000


@pytest.mark.parametrize("case", cases(), ids=str)
def test_right_or_explained(case: Case) -> None:
    """Without damping the thesis' scheme is stable at no step, and says so."""
    for integrator in INTEGRATORS:
        found = follow(case, integrator, MOST_STEPS)
        assert found.finite, integrator
        if integrator == "taylor2" and not found.error <= ALLOWED[integrator]:
            assert "stable at no time step" in found.message
        else:
            assert found.status in ("time reached", "at rest"), (integrator, found)
            assert found.error <= ALLOWED[integrator], (integrator, found)


@pytest.mark.parametrize("integrator", list(integrators.INTEGRATORS))
@pytest.mark.parametrize("share", SHARES)
def test_steps_below_and_above_the_limit(integrator: str, share: float) -> None:
    """A stable step is never stopped; an unstable one is, after whatever number of steps, and named."""
    case = stepping(integrator, share)
    found = follow(case, integrator)
    assert found.finite
    limited = integrators.INTEGRATORS[integrator].stable_step(1.0, 1.0) < float("inf")
    if share < 1.0:
        assert found.status in ("time reached", "at rest"), found
        assert found.error < (1e-3 if share < 0.01 else 0.5)
    elif not limited:
        assert found.error < 1e-3 or "Make the time step smaller" in found.message
    else:
        assert "s is too long" in found.message
        assert found.status == "diverged" or found.error < 0.5
    for steps in (1, 3, 7):
        assert follow(case, integrator, steps).error < 10.0


def test_a_creep_that_is_lost_in_rounding_is_rest() -> None:
    """Two metres from where it was drawn, a mass creeps by less in a step than the last digit of 2 m."""
    pushed = model(
        [particle("A", 0, 0, fixed=[True, True]), particle("B", 1, 0, fixed=[False, True], force=[-1, 0])],
        [rod("A", "B", tension_only=True)],
    )
    session = Session.open(pushed)
    assert session.run(until="rest", limit=1.0) == "at rest"
    assert session.particles["B"].displacement[0] == pytest.approx(-2.0 - 1.0 / 164640.0, rel=1e-12)
