"""Energy that steps make or lose: told where it matters, stopped where it is most of it, and never called rest."""

from typing import Any

import pytest

from pinjoint import Session
from pinjoint.components.settings import AUTOMATIC
from pinjoint.documents import models
from pinjoint.systems.physics.integrators import INTEGRATORS
from tests.reference.elements import Model
from tests.reference.models import model, oscillator, particle, square, triangle

OMEGA = 1000.0
STRUCK: dict[str, Any] = {"velocity": [0.001, 0.0]}
TELLS = "the supplied energy"


def stepping(document: Model, integrator: str, size: float | None) -> Session:
    return Session.open(
        document | {"settings": {"integrator": integrator, "time_step": size, "collisions": False}}
    )


def share_of_limit(document: Model, integrator: str, share: float) -> Session:
    """By a share of the stable step (of 2/ω where the integrator has no limit)."""
    session = stepping(document, "velocity_verlet", None)
    session.simulation.advance(0)
    if INTEGRATORS[integrator].stable_step(1.0, 1.0) < float("inf"):
        session.settings.integrator = integrator
        session.simulation.advance(0)
    return stepping(document, integrator, share * session.simulation.step_size.stable)


# --- one undamped mode -----------------------------------------------------------------------------------

DIVERGED, TOLD, SILENT = "diverged", "told", "silent"
ONE_MODE = [  # integrator, ωh, what becomes of 2000 steps
    *((verlet, 2.0, DIVERGED) for verlet in ("velocity_verlet", "semi_implicit_euler")),
    *((verlet, 1.9999, DIVERGED) for verlet in ("velocity_verlet", "semi_implicit_euler")),
    *((verlet, z, TOLD) for verlet in ("velocity_verlet", "semi_implicit_euler") for z in (1.98, 1.8, 1.0)),
    *((verlet, 0.2, SILENT) for verlet in ("velocity_verlet", "semi_implicit_euler")),
    *(("rk4", z, TOLD) for z in (2.6, 2.5, 2.0, 0.5)),
    ("rk4", 0.1, SILENT),
    *(("dop853", z, TOLD) for z in (5.9, 5.0, 3.0)),
    ("dop853", 0.5, SILENT),
    *(("esdirk4", z, TOLD) for z in (20.0, 2.0)),
    ("esdirk4", 0.1, SILENT),
    ("taylor2", 0.1, DIVERGED),
    ("taylor2", 0.01, TOLD),
]


@pytest.mark.parametrize(("integrator", "phase", "expected"), ONE_MODE)
def test_one_mode_near_the_stable_step(integrator: str, phase: float, expected: str) -> None:
    """An undamped oscillator that was struck: its energy stays what it was, or the program says that it does not."""
    session = stepping(oscillator(OMEGA, **STRUCK), integrator, phase / OMEGA)
    status = session.run(steps=2000)
    assert status == ("diverged" if expected == DIVERGED else "time reached")
    assert (TELLS in session.message or "stable at no time step" in session.message) == (
        expected == TOLD or (integrator == "taylor2")
    )
    off = abs(session.model.clock.largest_imbalance) / session.energy.initial
    assert (off > 0.1) == (expected == TOLD)


@pytest.mark.parametrize("integrator", [*INTEGRATORS, AUTOMATIC])
def test_automatic_steps_of_one_mode_need_no_warning(integrator: str) -> None:
    session = stepping(oscillator(OMEGA, **STRUCK), integrator, None)
    session.run(steps=500)
    assert session.message == "" or integrator == "taylor2"


# --- good runs are not warned of -------------------------------------------------------------------------

DAMPED = {
    "triangle": triangle(),
    "square": square(),
    "lightly damped": oscillator(OMEGA, 0.05, force=1.0),
    "overdamped": oscillator(OMEGA, 5.0, force=1.0),
}


@pytest.mark.parametrize("integrator", list(INTEGRATORS))
@pytest.mark.parametrize("document", DAMPED.values(), ids=DAMPED)
def test_damped_models_well_below_the_stable_step_rest_without_a_warning(
    document: Model, integrator: str
) -> None:
    session = share_of_limit(document, integrator, 0.03 if integrator == "taylor2" else 0.4)
    assert session.run(until="rest") == "at rest"
    assert session.simulation.residual <= 1e-8
    assert TELLS not in session.message


@pytest.mark.parametrize("name", models.bundled())
def test_bundled_models_need_no_warning(name: str) -> None:
    session = Session.open(name)
    told = "Settlements act in statics only" if name == "load_cases" else ""
    for steps in (1, 1, 30, 500):
        session.run(steps=steps)
        assert session.simulation.warning.partition(":")[0] == told


# --- rest ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("integrator", "phase"),
    [("velocity_verlet", 2.0), ("semi_implicit_euler", 2.0), ("rk4", 2.5), ("dop853", 5.0), ("esdirk4", 20.0)],
)
@pytest.mark.parametrize("start", [STRUCK, {"force": 1.0}], ids=["struck", "loaded"])
def test_nothing_undamped_comes_to_rest(integrator: str, phase: float, start: dict[str, Any]) -> None:
    """Neither where the method takes the motion, nor where states far apart are the same because they alternate."""
    session = stepping(oscillator(OMEGA, **start), integrator, phase / OMEGA)
    status = session.run(until="rest", limit=20_000 * phase / OMEGA)
    assert status in ("limit reached", "diverged")
    if status == "limit reached":
        assert "Nothing damps the motion" in session.message
        assert TELLS in session.message or "in the same state again" in session.message


def test_what_is_left_of_a_motion_that_yielded_is_not_at_rest_because_the_method_took_it() -> None:
    document = oscillator(OMEGA, velocity=[0.1, 0.0])
    document["rods"][0] |= {"tensile_strength": 0.1, "compressive_strength": 0.1}
    session = stepping(document, "rk4", 2.0 / OMEGA)
    assert session.run(until="rest", limit=10.0) == "limit reached"
    assert session.energy.dissipated_plastic > 0.0


def test_motion_that_is_too_slow_for_its_numbers_is_not_rest() -> None:
    """In a step of 1e-18 s a particle at 1 m/s moves by less than the last digit of its place."""
    document = model([particle("p", 0, 0, displacement=[1.0, 0.0], velocity=[1.0, 0.0])], [])
    session = stepping(document, "velocity_verlet", 1e-18)
    assert session.run(steps=20_000) == "time reached"
    assert "in the same state again" in session.message


@pytest.mark.parametrize("words", [["--at", "20"], ["--until-rest"]])
def test_a_motion_that_alternates_is_found_out_however_long_it_is_to_run(words: list[str], answer: Any) -> None:
    """At Verlet's stable step a mass under a force is at 0 and at twice the equilibrium in turn, with the right energy."""
    made = oscillator(1000.0, mass=1.0, force=1.0)
    made["settings"] = {"integrator": "velocity_verlet", "time_step": 0.002}
    found = answer("run", made, *words, status=1)
    assert found["status"] == "diverged"
    assert "in the same state again" in found["message"]
    session = Session.open(made)
    session.run(time=0.5)
    assert "0.002 s is too long" in session.message
