"""Hard cases of motion with known answers: stiff, heavy, strongly damped, tiny, nearly singular.

One list for the tests and for `pinjoint bench stability`. Each case is a model with the answer at any time;
`follow` runs it by one integrator and says how wrong the result is, or why there is none.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from pinjoint import Session
from pinjoint.components.field import Role
from pinjoint.components.settings import AUTOMATIC
from pinjoint.systems.physics.integrators import INTEGRATORS
from tests.reference import closed_forms
from tests.reference.elements import Model
from tests.reference.models import model, oscillator, particle, pendulum, rod, von_mises_truss

Array = NDArray[np.float64]
OMEGA = 2 * math.pi
GRAVITY = 9.81
# Infinite where there is none.
BOUNDLESS = ("tension_limit", "compression_limit", "moment_limit", "buckling_load")


@dataclass(frozen=True)
class Case:
    """A model and its displacements (m) at a time (s), shape (particles, 2).

    varied, value: its place in the map. time (s): how long to follow it. fixed_step (s): None automatic.
    """

    varied: str
    value: float
    document: Model
    time: float
    exact: Callable[[float], Array]
    fixed_step: float | None = None

    def __str__(self) -> str:
        return f"{self.varied} {self.value:g}"


@dataclass(frozen=True)
class Outcome:
    """How a case ended. error: of the displacements, relative to the largest so far. steps: time steps taken."""

    status: str
    message: str
    error: float
    finite: bool
    steps: int


def follow(case: Case, integrator: str, most_steps: int = 100_000) -> Outcome:
    """Run a case by one integrator, for its time or as many steps as are allowed."""
    settings = {"integrator": integrator, "collisions": False, "time_step": case.fixed_step}
    session = Session.open(case.document | {"settings": settings})
    if session.simulation.advance(most_steps, case.time) < most_steps:
        status = session.run(time=max(case.time - session.time, 0.0))
    else:
        status = "time reached"
    largest = max(float(np.abs(case.exact(t)).max()) for t in np.linspace(0.0, session.time, 33))
    wrong = float(np.abs(session.particles.displacement - case.exact(session.time)).max())
    return Outcome(
        status,
        session.message or session.simulation.step_size.warning,
        wrong / largest if largest > 0.0 else wrong,
        all_finite(session),
        session.model.clock.steps,
    )


def all_finite(session: Session) -> bool:
    """True if nothing that is shown or saved is infinite or not a number."""
    return all(
        np.isfinite(table.column(field.name)).all()
        for table in session.model.tables.values()
        for field in table.fields_in(Role.STATE, Role.DERIVED)
        if field.dtype is not object and not field.nullable and field.name not in BOUNDLESS
    )


# --- linear: two masses in a row, one mass ---------------------------------------------------------------


def in_series(stiffness: float, mass: float) -> Model:
    """A fixed end, 1 kg on a rod of 1 kN/m, and `mass` (kg) on a rod of `stiffness` (kN/m) behind it.

    10 N pull the heavier one suddenly.
    """
    pull_b, pull_c = ([0.01, 0], [0, 0]) if mass < 1.0 else ([0, 0], [0.01, 0])
    return model(
        [
            particle("A", 0, 0, fixed=[True, True]),
            particle("B", 1, 0, fixed=[False, True], mass=1.0, force=pull_b),
            particle("C", 2, 0, fixed=[False, True], mass=mass, force=pull_c),
        ],
        [rod("A", "B", stiffness=1.0, damping=0), rod("B", "C", stiffness=stiffness, damping=0)],
    )


def in_series_exact(time: float, stiffness: float, mass: float) -> Array:
    """u of A, B, C: u_static less its two modes, each swinging from −u_static.

    Frequencies and modes by a Jacobi rotation of M^-½ K M^-½; the lower ω² is the determinant over the
    higher one, so that no digits cancel at any ratio.
    """
    first, second, force = 1e3, 1e3 * stiffness, 10.0  # N/m, N/m, N
    a, d, b = first + second, second / mass, -second / math.sqrt(mass)
    high = (a + d) / 2 + math.hypot((a - d) / 2, b)
    angle = 0.5 * math.atan2(2 * b, a - d)
    modes = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    squares = np.array([high, first * second / mass / high])
    pull = modes.T @ (np.array([force, 0.0]) if mass < 1.0 else np.array([0.0, force / math.sqrt(mass)]))
    swing = 2 * np.sin(np.sqrt(squares) * time / 2) ** 2 / squares
    along = (modes @ (pull * swing)) / np.sqrt([1.0, mass])
    return np.array([[0.0, 0.0], [along[0], 0.0], [along[1], 0.0]])


def series(varied: str, stiffness: float, mass: float) -> Case:
    """Followed for about two thirds of a period of the slow motion."""
    slow = math.sqrt((1 + mass) * (1 + 1 / stiffness) / 1e3)
    value = mass if stiffness == 1.0 else stiffness
    return Case(
        varied,
        value,
        in_series(stiffness, mass),
        4.0 * slow,
        lambda time: in_series_exact(time, stiffness, mass),
    )


def damped(zeta: float) -> Case:
    """One mass, released; followed for a period, or three times its slow time constant."""
    moved = 0.1
    return Case(
        "damping ratio",
        zeta,
        oscillator(OMEGA, zeta, displacement=[moved, 0]),
        max(1.0, 6 * zeta / OMEGA),
        lambda time: _along_x(closed_forms.free_vibration(time, OMEGA, zeta, moved, 0.0)[0]),
    )


def stepping(integrator: str, share: float) -> Case:
    """The mass with ζ = 0.1, by a share of the integrator's stable step (of 2/ω where it has no limit)."""
    zeta, moved = 0.1, 0.1
    # a fixed step makes it that
    used = INTEGRATORS["velocity_verlet" if integrator == AUTOMATIC else integrator]
    limit = used.stable_step(OMEGA, zeta * OMEGA)
    if limit == math.inf:
        limit = 2 / OMEGA
    return Case(
        "step / limit",
        share,
        oscillator(OMEGA, zeta, displacement=[moved, 0]),
        max(1.0, 40 * share * limit),
        lambda time: _along_x(closed_forms.free_vibration(time, OMEGA, zeta, moved, 0.0)[0]),
        fixed_step=share * limit,
    )


def _along_x(displacement: float) -> Array:
    return np.array([[0.0, 0.0], [displacement, 0.0]])


# --- geometry: nearly no length, nearly in line, snap-through --------------------------------------------


def short_pendulum(length: float) -> Case:
    """A pendulum on a rod of nearly no length, under the gravity of the earth."""
    return swinging("rod's length, m", length, length, 1.0, 1.0, math.sqrt(length))


def in_units(value: float, length: float, force: float, mass: float) -> Case:
    """The pendulum in other units: lengths, forces and masses are so many times larger."""
    return swinging("units", value, length, force, mass, math.sqrt(mass * length / force))


def swinging(varied: str, value: float, length: float, force: float, mass: float, slower: float) -> Case:
    """Half a swing of a pendulum of 1 kg on 1 m, EA = 1 kN, released at 60°, in other units; in time `slower`."""
    angle = math.pi / 3
    period = 2 * math.pi / math.sqrt(GRAVITY) * closed_forms.pendulum_period_ratio(angle)
    document = pendulum(angle, length, GRAVITY * length / slower**2, mass, force)
    return Case(
        varied, value, document, 0.5 * period * slower, lambda time: length * pendulum_exact(time / slower)
    )


def pendulum_exact(time: float) -> Array:
    """Displacements of that pendulum at a time, in its own units, by scipy in polar coordinates."""
    r, theta = _pendulum()(time)[:2]
    angle = math.pi / 3
    bob = r * np.array([math.sin(theta), -math.cos(theta)])
    return np.array([[0.0, 0.0], bob - np.array([math.sin(angle), -math.cos(angle)])])


@cache
def _pendulum() -> Callable[[float], Array]:
    """(r, θ, r', θ') at a time."""

    def rates(_: float, y: Array) -> Array:
        r, theta, speed, turning = y
        outward = r * turning**2 + GRAVITY * math.cos(theta) - 1e3 * (r - 1.0)
        return np.array([speed, turning, outward, (-GRAVITY * math.sin(theta) - 2 * speed * turning) / r])

    start = [1.0, math.pi / 3, 0.0, 0.0]
    found = solve_ivp(rates, (0.0, 3.0), start, "DOP853", rtol=1e-12, atol=1e-13, dense_output=True)
    solution: Callable[[float], Array] = found.sol
    return solution


STIFFNESS, CROWN = 1e3, 1.0  # kN, kg


def crown(varied: str, value: float, height: float, load: float, time: float) -> Case:
    """Two rods of half span 1 m with a crown, suddenly loaded (kN, down), undamped; by scipy in one variable."""
    document = von_mises_truss(height, 1.0, STIFFNESS, -load, damping=0)
    document["particles"][1]["mass"] = CROWN
    original = math.hypot(1.0, height)

    def rates(_: float, y: Array) -> Array:
        rise = height - y[0]
        length = math.hypot(1.0, rise)
        elongation = (rise - height) * (rise + height) / (length + original)
        axial = STIFFNESS * elongation / original
        return np.array([y[1], 1e3 / CROWN * (load + 2 * axial * rise / length)])

    found = solve_ivp(rates, (0.0, time), [0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-16, dense_output=True)

    def displacement(at: float) -> Array:
        return np.array([[0.0, 0.0], [0.0, -float(found.sol(at)[0])], [0.0, 0.0]])

    return Case(varied, value, document, time, displacement)


def nearly_collinear(height: float) -> Case:
    """A light push on a flat truss: about a swing."""
    return crown("height / half span", height, height, 1e-3, 0.3)


def beside_snap_through(share: float) -> Case:
    """A share of the least sudden load that snaps the truss through."""
    limit = closed_forms.von_mises_dynamic_limit(0.2, 1.0, STIFFNESS)
    return crown("load / snap-through", share, 0.2, share * limit, 0.1)


# --- plasticity ------------------------------------------------------------------------------------------


def beside_collapse(share: float) -> Case:
    """One mass under a share of the strength of its rod, suddenly; from share 1 on nothing holds it."""
    mass, yields_at = 2.0, 0.01
    strength = mass * OMEGA**2 / 1000 * yields_at
    document = oscillator(OMEGA, mass=mass, force=share * strength)
    document["rods"][0] |= {"tensile_strength": strength, "compressive_strength": strength}
    return Case(
        "load / collapse",
        share,
        document,
        1.5,
        lambda time: _along_x(yields_at * closed_forms.elastic_plastic_step(time, OMEGA, share)),
    )


# --- the list --------------------------------------------------------------------------------------------


def cases() -> list[Case]:
    """All of them but the steps, which are each integrator's own."""
    powers = (-12, -9, -6, -3, 3, 6, 9, 12)
    return [
        *(series("stiffness ratio", 10.0**k, 1.0) for k in powers),
        *(series("mass ratio", 1.0, 10.0**k) for k in powers if abs(k) <= 9),
        *(damped(zeta) for zeta in (0.0, 1e-3, 0.1, 1.0, 10.0, 1e3)),
        *(short_pendulum(10.0**k) for k in (-3, -6, -9)),
        *(nearly_collinear(height) for height in (1e-1, 1e-3, 1e-6, 0.0)),
        *(beside_snap_through(share) for share in (0.5, 1 - 1e-4, 1 + 1e-4, 2.0)),
        *(beside_collapse(share) for share in (0.6, 0.999, 1.0, 1.5)),
        *(in_units(10.0**k, 10.0**k, 1.0, 1.0) for k in (-9, 9)),
        *(in_units(10.0**k, 1.0, 10.0**k, 10.0**k) for k in (-12, 12)),
    ]


SHARES = (1e-3, 0.1, 0.9, 1.1, 2.0, 10.0)  # of the stable step
