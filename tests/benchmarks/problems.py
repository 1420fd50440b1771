"""Problems with known answers, for the benchmark of run time against error."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinjoint.documents import models
from pinjoint.documents.document import document
from tests.benchmarks.models import lattice
from tests.benchmarks.motion import equations
from tests.reference.closed_forms import elastic_plastic_step, free_vibration
from tests.reference.elements import Model
from tests.reference.models import oscillator, pendulum, square, triangle

Array = NDArray[np.float64]
TIGHT = 1e-13  # relative tolerance of references without a closed form


@dataclass(frozen=True)
class Problem:
    """A model, the time (s) to follow it for, and its displacements (m) then, shape (particles, 2)."""

    title: str
    document: Model
    time: float
    exact: Callable[[], Array]


def problems(*, quick: bool) -> list[Problem]:
    """All problems; `quick` leaves out those that take long."""
    chosen = [under_damped(), over_damped(), transient(), swinging(), yielding_step()]
    return chosen if quick else [*chosen, slow_yielding(), stiff_lattice()]


def under_damped() -> Problem:
    """Five periods of one mass, ζ = 0.05."""
    omega, zeta, speed = 2 * math.pi, 0.05, 0.1
    made = oscillator(omega, zeta, velocity=[speed, 0])
    return Problem(
        "under-damped mass", made, 5.0, lambda: _along_x(free_vibration(5.0, omega, zeta, 0.0, speed)[0])
    )


def over_damped() -> Problem:
    """One mass creeping back, ζ = 200: stiff."""
    omega, zeta, moved = 2 * math.pi, 200.0, 0.1
    made = oscillator(omega, zeta, displacement=[moved, 0])
    end = 2 * zeta / omega  # its slow time constant
    return Problem(
        "over-damped mass", made, end, lambda: _along_x(free_vibration(end, omega, zeta, moved, 0.0)[0])
    )


def transient() -> Problem:
    """The thesis' triangle under its suddenly applied force."""
    return _by_tight_integration("triangle's transient", triangle(stiffness=164640, damping=100), 2e-3)


def swinging() -> Problem:
    """A pendulum released at 90° on a stiff rod: a slow motion with a fast vibration in it."""
    made = pendulum(math.pi / 2)
    made["rods"][0]["damping"] = 0.01
    return _by_tight_integration("90° pendulum", made, 1.0)


def yielding_step() -> Problem:
    """An elastic, perfectly plastic mass under a sudden force 0.7 of the strength, beyond its first peak."""
    omega, share, mass = 2 * math.pi, 0.7, 2.0
    strength = mass * omega**2 / 1000 * 0.01
    made = oscillator(omega, mass=mass, force=share * strength)
    made["rods"][0] |= {"tensile_strength": strength, "compressive_strength": strength, "density": 0}
    return Problem(
        "elastic–plastic mass", made, 1.5, lambda: _along_x(0.01 * elastic_plastic_step(1.5, omega, share))
    )


def slow_yielding() -> Problem:
    """The thesis' square, its load growing slowly until rods yield: nearly static, very stiff."""
    limits = {"tensile_strength": 215, "compressive_strength": 215, "damping": 100, "stiffness": 164640}
    made = square(force=(0, 0), **limits)
    made["loads"] = [{"on": "C", "force": [0, -260], "history": {"kind": "ramp", "start": 0, "duration": 0.5}}]
    return _by_tight_integration("slow yielding", made, 0.5)


def stiff_lattice() -> Problem:
    """About 1000 stiff rods, pulled at one edge."""
    made = document(lattice(1000, stiffness=164640.0, damping=1.0, density=6.15))
    return _by_tight_integration("lattice of 1000 rods", made, 5e-3)


def _by_tight_integration(title: str, made: Model, time: float) -> Problem:
    return Problem(title, made, time, lambda: tightly(made, time))


def tightly(made: Model, time: float) -> Array:
    """Displacements (m) at a time by scipy, independent of our integrators."""
    from scipy.integrate import solve_ivp

    loaded = models.load(made)
    rates, start = equations(loaded)
    size = 2 * loaded.particles.count
    found = solve_ivp(rates, (0.0, time), start, "DOP853", t_eval=[time], rtol=TIGHT, atol=1e-18)
    return found.y[:size, -1].reshape(-1, 2)


def _along_x(displacement: float) -> Array:
    return np.array([[0.0, 0.0], [displacement, 0.0]])
