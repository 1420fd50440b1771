"""Runs that blow up are stopped in time and explained; good ones are never stopped; rest is rest."""

import itertools
import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.field import Role
from pinjoint.documents import models
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.models import chain, model, oscillator, particle, pendulum, rod, square, triangle
from tests.stability.cases import BOUNDLESS

OMEGA = 100.0
RELEASED: dict[str, Any] = {"velocity": [1.0, 0], "displacement": [0.003, 0]}


def ramp(document: Model, name: str, force: tuple[float, float], duration: float, start: float = 0.0) -> Model:
    history = {"kind": "ramp", "start": start, "duration": duration}
    return document | {"loads": [{"on": name, "force": list(force), "history": history}]}


def scaled(document: Model, force: float, mass: float) -> Model:
    """The same motion in other units: stiffness, damping and forces × force, masses × mass."""
    for member in document["rods"]:
        member["stiffness"] = 164640.0 * force
        member["damping"] = 3.0 * force
    for node in document["particles"]:
        node["force"] = [f * force for f in node.get("force", (0, 0))]
        node["mass"] = node.get("mass", 10.0) * mass
    return document


def stressed(document: Model, strain: float) -> Model:
    """All rods too long for their places."""
    for member in document["rods"]:
        places = {node["name"]: node["position"] for node in document["particles"]}
        length = math.dist(*(places[end] for end in member["between"]))
        member["rest_length"] = length * (1 + strain)
    return document


def yielding(strength: float, zeta: float = 0.0, **properties: Any) -> Model:
    document = oscillator(OMEGA, zeta, **properties)
    document["rods"][0] |= {"tensile_strength": strength, "compressive_strength": strength}
    return document


def flying() -> Model:
    document = triangle(force=(0, 0), stiffness=2e4, damping=0.2)
    for node, velocity in zip(document["particles"], ([1, 2], [-3, 0.5], [0.3, -0.7]), strict=True):
        node |= {"fixed": [False, False], "velocity": velocity}
    return document


SMALL = oscillator(OMEGA, force=1.0)
ELASTIC: dict[str, Model] = {
    "released": oscillator(OMEGA, **RELEASED),
    "suddenly loaded": SMALL,
    "loaded at once by a ramp": ramp(oscillator(OMEGA), "B", (1, 0), 0.0),
    "loaded later at once": ramp(oscillator(OMEGA, **RELEASED), "B", (1, 0), 0.0, start=0.777),
    "loaded by a short ramp": ramp(oscillator(OMEGA), "B", (1, 0), 0.003),
    "loaded by a long ramp": ramp(oscillator(OMEGA), "B", (1, 0), 0.5),
    "lightly damped": oscillator(OMEGA, 0.05, force=1.0),
    "lightly damped, ramp": ramp(oscillator(OMEGA, 0.05), "B", (1, 0), 0.0),
    "half damped": oscillator(OMEGA, 0.5, force=1.0, **RELEASED),
    "half damped, ramp": ramp(oscillator(OMEGA, 0.5), "B", (1, 0), 0.0),
    "overdamped": oscillator(OMEGA, 2.0, force=1.0, **RELEASED),
    "overdamped, ramp": ramp(oscillator(OMEGA, 2.0), "B", (1, 0), 0.0),
    "strongly overdamped": oscillator(OMEGA, 30.0, force=1.0, **RELEASED),
    "square": square(),
    "undamped square": square(damping=0),
    "undamped square, ramp": ramp(square(force=(0, 0), damping=0), "C", (30, -70), 0.0),
    "prestressed square": stressed(square(force=(5, -10), damping=1), 0.001),
    "chain": chain(9, 4000.0, 2.0) | {"environment": {"acceleration": [3.0, 0]}},
    "flying": flying(),
    "huge": scaled(square(), 1e12, 1e9),
    "tiny": scaled(square(), 1e-12, 1e-15),
    "drag only": model(
        [particle("p", 0, 0, velocity=[1, 2])], [], environment={"drag": 50.0, "acceleration": [0, -9.81]}
    ),
}
PLASTIC: dict[str, Model] = {
    "yields once": yielding(1.2, force=1.0),
    "yields, damped": yielding(1.2, 0.1, force=1.0),
    "yields to and fro": yielding(0.3, velocity=[3.0, 0]),
    "yields, ramp": ramp(yielding(1.2), "B", (1, 0), 0.0),
    "square yields": ramp(
        square(force=(0, 0), damping=1, tensile_strength=60, compressive_strength=60), "C", (0, -90), 0.0
    ),
    "collapses": yielding(0.9, 0.1, force=1.0),
}


def limit(document: Model) -> float:
    """The largest stable step in the initial state."""
    session = Session.open(document)
    session.simulation.advance(0)
    return session.simulation.step_size.stable


def stepping(document: Model, share: float, integrator: str = "velocity_verlet") -> Session:
    """A session whose step is this share of the stable one."""
    size = share * limit(document | {"settings": {"integrator": integrator}})
    return Session.open(document | {"settings": {"time_step": size, "integrator": integrator}})


def each(documents: dict[str, Model]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("document", list(documents.values()), ids=list(documents))


def assert_finite(session: Session) -> None:
    for table in session.model.tables.values():
        for field in table.fields_in(Role.STATE, Role.DERIVED):
            if field.dtype is not object and not field.nullable and field.name not in BOUNDLESS:
                assert np.isfinite(table.column(field.name)).all(), f"{table.name}.{field.name}"


# --- divergence ------------------------------------------------------------------------------------------


@each(ELASTIC)
@pytest.mark.parametrize("share", [1.1, 1.5, 2.0, 5.0, 10.0])
def test_too_large_a_step_is_stopped_and_explained(document: Model, share: float) -> None:
    """The limit with dampers is a safe one: strongly damped models may bear 1.1 and 1.5 times it."""
    session = stepping(document, share)
    size = session.settings.time_step
    start = bits.columns(session.model, Role.STATE)
    span = max(np.abs(session.particles.displacement).max(), 1e-3)
    status = "time reached"
    while status == "time reached" and session.model.clock.steps < 2000:
        status = session.run(steps=17)  # what a frame may show
        assert_finite(session)
        assert np.abs(session.particles.displacement).max() < 1e5 * max(span, session.time**2 * 10)
    if status != "diverged":
        assert share < 2.0
        assert (session.model.rods.damping > 0.0).any()
        assert abs(session.energy.imbalance) <= 0.5 * max(session.energy.initial, abs(session.energy.work))
        return
    assert session.simulation.halted
    assert f"{size:.3g} s is too long" in session.message
    assert "automatic" in session.message
    assert "The last good state, at t = 0 s, was kept." in session.message
    clock = {name for name in start if name.startswith("clock.")}
    assert set(bits.different(bits.columns(session.model, Role.STATE), start)) <= clock
    assert session.time == 0.0
    assert session.run(steps=10) == "diverged"  # until something is changed


def test_the_remedy_for_an_integrator_that_controls_its_error_is_to_let_it() -> None:
    session = Session.open(oscillator(2.0 * math.pi, 0.0, velocity=[5.0, 0.0]))
    session.settings.integrator, session.settings.time_step = "esdirk4", 1.0
    assert session.run(steps=50) == "diverged"
    assert "Set the time step to automatic, so that its error is controlled" in session.message
    session.settings.time_step = None
    assert session.run(time=1.0) == "time reached"


def test_following_the_remedy_works() -> None:
    session = stepping(SMALL, 1.3)
    assert session.run(steps=500) == "diverged"
    session.settings.time_step = None
    assert session.run(steps=500) == "time reached"
    assert session.message == ""


@each(PLASTIC)
@pytest.mark.parametrize("share", [1.1, 2.0, 5.0, 10.0])
def test_too_large_a_step_with_yielding_is_at_least_warned_of(document: Model, share: float) -> None:
    """Yielding eats the energy that instability makes: such a run need not blow up, but it is finite."""
    session = stepping(document, share)
    status = session.run(steps=3000)
    assert_finite(session)
    assert "s is too long" in session.message or status == "at rest"


@each({name: ELASTIC[name] for name in ("released", "suddenly loaded", "undamped square", "chain")})
def test_the_thesis_scheme_without_damping_diverges_at_any_step(document: Model) -> None:
    """Its energy grows by 1 + (ωh)²/2 each step, slowly at small steps."""
    size = 0.1 * limit(document)
    session = Session.open(document | {"settings": {"time_step": size, "integrator": "taylor2"}})
    assert session.run(steps=20_000) == "diverged"
    assert_finite(session)
    assert "stable at no time step" in session.message
    assert "velocity_verlet" in session.message


def test_the_thesis_scheme_is_warned_of_before_it_diverges() -> None:
    session = Session.open(oscillator(OMEGA, **RELEASED) | {"settings": {"integrator": "taylor2"}})
    session.run(steps=10)
    assert "stable at no time step" in session.message


@pytest.mark.parametrize("zeta", [0.02, 0.3, 1.0, 3.0])
def test_the_thesis_scheme_is_stable_up_to_its_limit(zeta: float) -> None:
    document = oscillator(OMEGA, zeta, **RELEASED)
    assert stepping(document, 0.99, "taylor2").run(steps=5000) != "diverged"
    assert stepping(document, 1.05, "taylor2").run(steps=5000) == "diverged"


def test_the_last_good_state_is_not_the_first() -> None:
    """After thousands of good steps, an edit that makes the step too long costs nothing but itself."""
    session = Session.open(oscillator(OMEGA, **RELEASED) | {"settings": {"time_step": 1e-3}})
    session.run(steps=20_000)
    good = bits.columns(session.model, Role.STATE)
    session.rods["AB"].stiffness *= 1000.0
    assert session.run(steps=1000) == "diverged"
    changed = bits.different(bits.columns(session.model, Role.STATE), good)
    assert all(name.startswith("clock.") for name in changed)
    assert session.model.clock.steps == 20_000
    assert "The last good state, at t = 20.00 s" in session.message


def test_an_automatic_step_that_proves_too_long_is_halved() -> None:
    """Rods that come to lie in one line are stiffer together than at the start."""
    nodes = [particle("M", 0, 0, mass=1.0, force=[900.0, 0.0])]
    nodes += [particle(n, 0.3, y, fixed=[True, True]) for n, y in zip("ABCD", (-3, -1, 1, 3), strict=True)]
    document = model(nodes, [rod("M", n, stiffness=100.0, damping=0) for n in "ABCD"])
    session = Session.open(document)
    assert session.run(steps=30_000) == "time reached"
    assert abs(session.energy.imbalance) < 0.01 * abs(session.energy.work)


# --- no false alarms -------------------------------------------------------------------------------------


# Where each step near the limit yields to the other side, the dissipated energy does come from nowhere.
TOO_COARSE = ("yields to and fro", 0.99)


@pytest.mark.parametrize(
    ("document", "share"),
    [
        pytest.param(document, share, id=f"{name}-{share}")
        for name, document in (ELASTIC | PLASTIC).items()
        for share in (0.99, 0.7, 0.1)
        if (name, share) != TOO_COARSE
    ],
)
def test_no_alarm_up_to_the_stable_limit(document: Model, share: float) -> None:
    session = stepping(document, share)
    assert session.run(steps=4000) in ("time reached", "at rest"), session.message
    assert_finite(session)


@each({name: ELASTIC[name] for name in ("released", "suddenly loaded", "loaded by a short ramp")})
def test_no_alarm_when_the_step_changes_within_a_swing(document: Model) -> None:
    """Near the limit Verlet's energy swings by far more than it is: a new step must not compare with it."""
    for steps in range(20, 29):
        session = stepping(document, 0.97)
        session.run(steps=steps)
        session.settings.time_step = 0.01 * session.settings.time_step
        assert session.run(steps=1000) == "time reached", session.message
        session.settings.integrator = "taylor2"
        session.settings.time_step = 1e-3 * session.settings.time_step
        assert session.run(steps=1000) == "time reached", session.message


def test_no_alarm_at_a_short_last_step() -> None:
    for steps, part in itertools.product((126, 127, 128, 255), (0.01, 0.3, 0.9)):
        session = stepping(ELASTIC["released"], 0.97)
        size = session.settings.time_step
        assert session.run(time=(steps + part) * size) == "time reached", session.message
        assert session.time == pytest.approx((steps + part) * size, rel=1e-14)
        assert session.run(steps=300) == "time reached", session.message


def test_no_alarm_when_a_strength_is_lowered_below_the_force() -> None:
    """What is beyond the new strength yields at once; that is the edit's doing, not the integrator's."""
    session = Session.open(yielding(20.0, 0.3, force=10.0))
    session.run(until="rest")
    session.rods["AB"].tensile_strength = 11.0
    session.run(steps=200)
    session.particles["B"].force = (0.5, 0.0)
    session.rods["AB"].tensile_strength = 1.0
    assert session.run(until="rest") == "at rest"
    assert abs(session.energy.imbalance) < 0.01 * abs(session.energy.work)


def test_no_alarm_for_rods_prestressed_beyond_their_strength() -> None:
    document = stressed(square(damping=1, tensile_strength=60, compressive_strength=60), 0.002)
    assert Session.open(document).run(until="rest") == "at rest"


@pytest.mark.parametrize("name", models.bundled())
def test_no_alarm_in_bundled_models(name: str) -> None:
    """Far enough for slow growth in small ones; in large ones, as far as an unstable step would be seen."""
    session = Session.open(name)
    steps = 3_000 if session.model.particles.count <= 20 else 500
    assert session.run(steps=steps) in ("time reached", "at rest"), session.message
    assert session.message.startswith("At rest") or session.message == ""
    assert_finite(session)


# --- rest ------------------------------------------------------------------------------------------------


@each(
    {
        "released": oscillator(OMEGA, displacement=[0.01, 0]),
        "suddenly loaded": SMALL,
        "pendulum": pendulum(1.5, stiffness=20.0),
        "hanging": oscillator(OMEGA) | {"environment": {"acceleration": [9.81, 0]}},
    }
)
def test_a_turning_point_is_not_rest(document: Model) -> None:
    """Every step of an undamped swing is looked at, turning points among them; and one is told why."""
    session = Session.open(document)
    assert session.run(until="rest", limit=3.0) == "limit reached"
    assert session.time == pytest.approx(3.0, rel=1e-12)
    assert "Nothing damps the motion" in session.message


@pytest.mark.parametrize("zeta", [0.02, 0.3, 1.0, 5.0])
def test_an_unloaded_ring_dies_out(zeta: float) -> None:
    """Without any load the scale of forces is what they were at most."""
    session = Session.open(oscillator(OMEGA, zeta, displacement=[0.01, 0]))
    assert session.run(until="rest") == "at rest"
    assert abs(session.particles["B"].displacement[0]) < 1e-11 * 0.01
    assert session.time > -math.log(1e-9) / (OMEGA * (zeta + math.sqrt(max(zeta**2 - 1, 0.0))))


def test_rest_is_as_exact_as_is_said() -> None:
    """Residual at most 1e-8 of the largest force, a displacement to match."""
    session = Session.open(oscillator(OMEGA, 0.2, force=1.0))
    assert session.run(until="rest") == "at rest"
    assert session.particles["B"].displacement[0] == pytest.approx(1000.0 / (2.0 * OMEGA**2), rel=1e-8)
    assert session.simulation.residual <= 1e-8


def test_no_rest_before_the_last_load_has_come() -> None:
    """A model that lies still waits for a ramp that begins later; then it rests in its new place."""
    document = ramp(oscillator(OMEGA, 1.0), "B", (1.0, 0.0), duration=0.5, start=0.7)
    session = Session.open(document)
    assert session.run(until="rest") == "at rest"
    assert session.time >= 1.2
    assert session.particles["B"].displacement[0] == pytest.approx(1000.0 / (2.0 * OMEGA**2), rel=1e-8)
    early = Session.open(document)
    assert early.run(until="rest", limit=1.0) == "limit reached"
    assert "A load is still changing" in early.message


@each(
    {
        "empty": model([], []),
        "a particle": model([particle("p", 0, 0)], []),
        "an unloaded truss": square(force=(0, 0)),
        "all held": model([particle("p", 0, 0, fixed=[True, True], force=[1, 1])], []),
    }
)
def test_what_no_force_moves_is_at_rest(document: Model) -> None:
    session = Session.open(document)
    assert session.run(until="rest") == "at rest"
    assert session.model.clock.steps <= 128


@each(
    {
        "flies": model([particle("p", 0, 0, velocity=[1e-6, 0])], []),
        "flies together": flying(),
        "falls": model([particle("p", 0, 0, acceleration=[0, -1e-9])], []),
        "falls at its final speed": model(
            [particle("p", 0, 0, velocity=[0, -0.1], acceleration=[0, -1])], [], environment={"drag": 10.0}
        ),
    }
)
def test_what_moves_is_not_at_rest(document: Model) -> None:
    assert Session.open(document).run(until="rest", limit=2.0) == "limit reached"


def test_a_limit_is_reached_exactly_and_never_waited_for_in_vain() -> None:
    """Whatever the rounding of step × count: k·h may fall a last bit short of the limit."""
    for size, count in itertools.product((0.1, 0.3, 0.7, 1e-3, 3e-3), range(1, 60, 7)):
        document = model([particle("p", 0, 0, velocity=[1, 0])], [], settings={"time_step": size})
        for end in (size * count, round(size * count, 6), math.nextafter(size * count, math.inf)):
            session = Session.open(document)
            assert session.run(until="rest", limit=end) == "limit reached"
            assert session.time == pytest.approx(end, rel=1e-14)
            assert session.particles["p"].displacement[0] == pytest.approx(end, rel=1e-12)


# --- rods that shrink to nothing -------------------------------------------------------------------------


@pytest.mark.parametrize("aside", [0.0, 1e-300, 1e-160, 1e-12, 1e-6, 1e-3])
@pytest.mark.parametrize("damping", [0.0, 0.002])
def test_a_rod_through_zero_length_in_motion_stays_finite(aside: float, damping: float) -> None:
    """A mass shot at the other end of its rod and past it."""
    nodes = [particle("A", 0, 0, fixed=[True, True]), particle("B", 1, aside, velocity=[-20, 0], mass=1)]
    session = Session.open(model(nodes, [rod("A", "B", stiffness=0.1, damping=damping)]))
    passed = False
    for _ in range(300):
        session.run(steps=3)
        assert_finite(session)
        passed = passed or session.particles["B"].displacement[0] < -1.1
    assert passed


@pytest.mark.parametrize("apart", [0.0, 1e-320, 1e-200, 1e-12])
def test_a_rod_without_length_that_wants_one_stays_finite(apart: float) -> None:
    """Ends at one place, a rest length of 1: no direction, so no push, until something parts them."""
    nodes = [particle("A", 0, 0, fixed=[True, True]), particle("B", apart, 0, mass=1)]
    document = model(nodes, [rod("A", "B", stiffness=1000, rest_length=1.0, damping=1.0)])
    document["environment"] = {"drag": 20.0}  # or it would swing for ever
    session = Session.open(document)
    session.run(steps=2000)
    assert_finite(session)
    assert session.rods["AB"].axial_force < 1e-6
    session.particles["B"].force = (0.0, 1.0)
    session.run(until="rest")
    assert_finite(session)
    assert session.rods["AB"].axial_force == pytest.approx(1.0, rel=1e-6)
    assert session.rods["AB"].length == pytest.approx(1.001, rel=1e-6)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("properties", [{"velocity": [1e300, 0.0], "mass": 1e-9}, {"velocity": [1e300, 0.0]}])
def test_numbers_that_are_too_large_are_said_in_the_window_only(properties: dict[str, Any]) -> None:
    """Nothing is written on standard error, not even while a hand pulls."""
    session = Session.open(model([particle("A", 0.0, 0.0, **properties), particle("B", 1.0, 0.0)], []))
    for key in ("j", "i", "space"):
        session.press(key)
    session.frame(0.01)
    session.press("drag", session.point(0.0, 0.0))
    session.press("drag to", session.point(0.5, 0.5))
    session.frame(0.01)
    session.press("drop")
    session.frame(0.01)
    assert np.isfinite(session.particles.velocity).all()
    assert "too large" in session.view.status.problem
