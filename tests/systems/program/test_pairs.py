"""Laws of pairs: fused equals stage by stage; lists of near pairs change no bit; forces, energies and mistakes."""

import math
from typing import Any

import numpy as np
import pytest
from numba import njit

from pinjoint import Session
from pinjoint.components import Model
from pinjoint.systems.base import Law
from pinjoint.systems.program import near_pairs
from pinjoint.systems.program.binding import ProgramError
from pinjoint.systems.program.compiler import Compile
from tests.reference import bits
from tests.reference.forms import programs
from tests.reference.models import model, particle, rod
from tests.systems.program.test_program import assert_identical, in_stages  # noqa: F401

CUTOFF = 0.5  # m


@njit(error_model="numpy")
def springy(apart, particles_mass, environment_drag):
    """Repels by k (c − r) along the line of both, k by their masses."""
    distance = math.hypot(apart[0], apart[1])
    force = -0.05 * particles_mass[0] * particles_mass[1] * (0.5 - distance) / distance
    return force * apart[0], force * apart[1]


@njit(error_model="numpy")
def springy_energy(apart, particles_mass):
    short = 0.5 - math.hypot(apart[0], apart[1])
    return 0.025 * particles_mass[0] * particles_mass[1] * short * short


class Springy(Law):
    """Soft balls of the radius 0.25 m that repel each other."""

    name = "test.springy"
    each = "pairs"
    kernel = staticmethod(springy)
    reads = ("particles.mass", "environment.drag")

    def cutoff(self, model: Model) -> float:
        return CUTOFF


class Conservative(Springy):
    name = "test.conservative"
    potential = staticmethod(springy_energy)


@njit
def sticky(apart, drift, rough, particles_position):
    return 0.01 * rough[0] * rough[1] * drift[0], 0.01 * rough[0] * rough[1] * drift[1]


class Sticky(Law):
    """Damps the motion of near particles relative to each other; over a shorter distance than others."""

    name = "test.sticky"
    each = "pairs"
    kernel = staticmethod(sticky)
    reads = ("particles.position",)
    account = "dissipated_damping"

    def cutoff(self, model: Model) -> float:
        return 0.3

    def arrays(self, model: Model) -> dict[str, np.ndarray]:
        return {"rough": np.linspace(1.0, 2.0, model.particles.count)}


LAWS = Conservative(), Sticky()


def crowd(count: int, seed: int = 1, **settings: Any) -> dict[str, Any]:
    """Particles in a square in which each has some ten neighbours, two of them joined by a rod, one held."""
    random = np.random.default_rng(seed)
    size = math.sqrt(count * math.pi * CUTOFF**2 / 10.0)
    particles = [
        particle(f"p{n}", *random.uniform(0.0, size, 2).tolist(), mass=float(random.uniform(0.5, 2.0)))
        | {"velocity": random.normal(0.0, 1.0, 2).tolist()}
        for n in range(count)
    ]
    particles[0] |= {"fixed": [True, True], "velocity": [0.0, 0.0]}
    made = model(particles, [rod("p1", "p2", stiffness=100.0, damping=0.01)])
    return made | {"settings": {"collisions": False, **settings}}


# --- the same bits ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("listed", [False, True])
def test_fused_is_bit_identical_to_every_pair_stage_by_stage(
    listed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if listed:
        monkeypatch.setattr(near_pairs, "ALL_PAIRS_DISCS", 0)
    document = crowd(12, sleeping=False)
    for one in document["particles"]:
        one["velocity"] = [100.0 * v for v in one["velocity"]]  # so that the list is renewed
    session = assert_identical(document, "velocity_verlet", [Springy(), *LAWS], steps=200)
    assert session.simulation.programs.compiled.columns["pair_count"][0] == -1 or listed


def run_by(integrator: str, count: int, **settings: Any) -> Session:
    session = Session.open(crowd(count, integrator=integrator, **settings), LAWS)
    assert session.run(steps=60) == "time reached"
    return session


INTEGRATORS = ["velocity_verlet", "semi_implicit_euler", "taylor2", "rk4", "dop853", "esdirk4"]


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_list_of_near_pairs_changes_no_bit(integrator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither a list, nor how far beyond the cutoff it reaches, nor too little room for it."""
    step = {} if integrator in ("dop853", "esdirk4") else {"time_step": 1e-3}
    monkeypatch.setattr(near_pairs, "ALL_PAIRS_DISCS", 1000)
    expected = bits.columns(run_by(integrator, 40, **step).model)
    monkeypatch.setattr(near_pairs, "ALL_PAIRS_DISCS", 0)
    for margin, room, least in ((0.3, 1.5, 4), (0.02, 1.5, 4), (0.3, 0.0, 0)):
        monkeypatch.setattr(near_pairs, "MARGIN", margin)
        monkeypatch.setattr(near_pairs, "ROOM", room)
        monkeypatch.setattr(near_pairs, "PER_PARTICLE", least)
        session = run_by(integrator, 40, **step)
        assert bits.different(bits.columns(session.model), expected) == []
        count = session.simulation.programs.compiled.columns["pair_count"][0]
        assert 100 < count < 40 * 39 / 2


@pytest.mark.parametrize("listed", [False, True])
def test_pairs_have_the_same_bits_in_both_forms(listed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if listed:
        monkeypatch.setattr(near_pairs, "ALL_PAIRS_DISCS", 0)
    found = []
    for choice in (Compile.NEVER, Compile.ALWAYS):
        with programs(choice):
            found.append(bits.columns(run_by("dop853", 40).model))
    assert bits.different(*found) == []


@pytest.mark.usefixtures("in_stages")
def test_large_models_have_laws_of_pairs_too() -> None:
    assert_identical(crowd(12, sleeping=False), "taylor2", list(LAWS), steps=50)


def test_saved_and_continued_undone_and_run_again_it_has_the_same_bits(tmp_path: Any) -> None:
    document = crowd(80, integrator="velocity_verlet", time_step=1e-3)
    through = Session.open(document, LAWS)
    through.run(steps=300)
    expected = bits.columns(through.model)
    session = Session.open(document, LAWS)
    session.run(steps=120)
    session.save(tmp_path / "half.json")
    again = Session.open(tmp_path / "half.json", LAWS)
    for continued in (session, again):
        continued.run(steps=180)
        assert bits.different(bits.columns(continued.model), expected) == []
    session.undo()
    session.undo()
    session.run(steps=300)
    assert bits.different(bits.columns(session.model), expected) == []


def test_frames_change_nothing() -> None:
    document = crowd(80, integrator="velocity_verlet", time_step=1e-3)
    frames = Session.open(document, LAWS)
    frames.press("space")
    while frames.model.clock.steps < 200:
        frames.frame(0.013)
    whole = Session.open(document, LAWS)
    whole.run(steps=frames.model.clock.steps)
    assert bits.different(bits.columns(whole.model), bits.columns(frames.model)) == []


# --- forces and energies -----------------------------------------------------------------------------------


def check_energy_and_momentum(integrator: str, *laws: Law) -> None:
    controlled = integrator in ("dop853", "esdirk4")
    document = crowd(20, integrator=integrator, **({} if controlled else {"time_step": 2e-5}))
    del document["particles"][0]["fixed"]
    session = Session.open(document, laws)
    before = (session.particles.mass[:, None] * session.particles.velocity).sum(axis=0)
    session.run(time=0.02)
    energy = session.energy
    assert abs(energy.work) > 0.05 * energy.initial
    bound = {"taylor2": 1e-2, "semi_implicit_euler": 1e-2}.get(integrator, 1e-5)
    assert abs(energy.imbalance) < bound * energy.initial
    after = (session.particles.mass[:, None] * session.particles.velocity).sum(axis=0)
    assert after == pytest.approx(before, abs=1e-11)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_energy_and_momentum_are_kept(integrator: str) -> None:
    """By a potential, to the error of the integrator."""
    check_energy_and_momentum(integrator, Conservative(), Sticky())


@pytest.mark.parametrize("integrator", ["velocity_verlet", "dop853"])
def test_energy_is_accounted_for_without_a_potential(integrator: str) -> None:
    """By the work of the forces, to the error of its sum, too."""
    check_energy_and_momentum(integrator, Springy())


@njit(error_model="numpy")
def gravity(apart, particles_mass):
    x, y = apart
    cube = (x * x + y * y) ** 1.5
    return 1e-3 * particles_mass[0] * particles_mass[1] * x / cube, 1e-3 * particles_mass[0] * particles_mass[
        1
    ] * y / cube


@njit(error_model="numpy")
def gravity_energy(apart, particles_mass):
    return -1e-3 * particles_mass[0] * particles_mass[1] / math.hypot(apart[0], apart[1])


class Gravity(Law):
    """G = 1 m³/(kg s²), without a cutoff."""

    name = "test.gravity"
    each = "pairs"
    kernel = staticmethod(gravity)
    potential = staticmethod(gravity_energy)
    reads = ("particles.mass",)


def test_a_planet_returns_after_its_year() -> None:
    """Kepler: T = 2π √(a³ / G (m₁ + m₂)), from the aphelion of an ellipse of the eccentricity 0.6."""
    sun, planet, axis, eccentricity = 3.0, 1.0, 1.0, 0.6
    far = axis * (1.0 + eccentricity)
    speed = math.sqrt((sun + planet) * (1.0 - eccentricity) / far)
    bodies = [
        particle("sun", 0.0, 0.0, mass=sun) | {"velocity": [0.0, -speed * planet / (sun + planet)]},
        particle("planet", far, 0.0, mass=planet) | {"velocity": [0.0, speed * sun / (sun + planet)]},
    ]
    session = Session.open(model(bodies, []) | {"settings": {"collisions": False}}, [Gravity()])
    session.run(time=2.0 * math.pi * math.sqrt(axis**3 / (sun + planet)))
    assert np.abs(session.particles.displacement).max() < 1e-6
    assert abs(session.energy.imbalance) < 1e-7 * session.energy.kinetic


def test_near_pairs_rest_where_their_forces_balance_and_reactions_know_of_them() -> None:
    """Two soft balls, one held, one under a weight of 0.01 kN: 0.05 (0.5 − r) = 0.01 → r = 0.3 m."""
    held = particle("A", 0.0, 0.0, fixed=[True, True], mass=1.0)
    loaded = particle("B", 0.4, 0.0, fixed=[False, True], mass=1.0) | {"force": [-0.01, 0.0]}
    document = model([held, loaded], []) | {"environment": {"drag": 10.0}, "settings": {"collisions": False}}
    session = Session.open(document, LAWS)
    assert session.run(until="rest") == "at rest"
    assert 0.4 + session.particles["B"].displacement[0] == pytest.approx(0.3, abs=1e-9)
    assert session.particles["A"].reaction[0] == pytest.approx(0.01, abs=1e-9)
    energy = session.energy
    assert energy.work == pytest.approx(0.01 * 0.1e3 - 25.0 * (0.2**2 - 0.1**2), rel=1e-6)
    assert abs(energy.imbalance) < 1e-8


def test_islands_do_not_sleep_while_others_act_on_them_from_afar() -> None:
    """Two trusses that rest; a ball flies by and pushes the second one."""
    particles, rods = [], []
    for name, x in (("a", 0.0), ("b", 5.0)):
        for place, end in enumerate("123"):
            fixed = {"fixed": [True, True]} if place < 2 else {}
            particles.append(particle(f"{name}{end}", x + place * 0.6, place % 2 * 0.7 + 0.2 * place, **fixed))
        rods += [rod(f"{name}{end}", f"{name}3", stiffness=100.0, damping=1.0) for end in "12"]
    ball = particle("ball", 8.5, 0.6, mass=1.0) | {"velocity": [-1.0, 0.0]}
    settings = {"collisions": False, "integrator": "velocity_verlet"}
    session = Session.open(model([*particles, ball], rods) | {"settings": settings}, [Conservative()])
    session.run(time=2.0)
    assert not session.particles.asleep.any()
    session.run(time=2.2)
    assert session.particles["b3"].displacement[0] != 0.0


class Odd(Springy):
    def __init__(self, distance: float) -> None:
        self.distance = distance

    def cutoff(self, model: Model) -> float:
        return self.distance


@pytest.mark.parametrize("distance", [1e-300, 1e3, 1e200, 1.7e308, math.inf])
def test_cutoffs_of_any_size(distance: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(near_pairs, "ALL_PAIRS_DISCS", 0)
    document = crowd(6, integrator="velocity_verlet", time_step=1e-4) | {"rods": []}
    session = Session.open(document, [Odd(distance)])
    before = session.particles.velocity.copy()
    assert session.run(steps=3) == "time reached"
    assert bool((session.particles.velocity != before).any()) is (distance > 1.0)


@pytest.mark.parametrize("distance", [-1.0, math.nan])
def test_cutoffs_of_no_size_are_refused(distance: float) -> None:
    with pytest.raises(ProgramError, match="give a distance above 0 m, or"):
        Session.open(crowd(4), [Odd(distance)]).run(steps=1)


# --- mistakes ----------------------------------------------------------------------------------------------


class Nowhere(Springy):
    def cutoff(self, model: Model) -> float:
        return 0.0


class Timed(Conservative):
    kernel = staticmethod(njit(lambda apart, time: apart))


class OfRods(Springy):
    kernel = staticmethod(njit(lambda apart, rods_stiffness: apart))
    reads = ("rods.stiffness",)


class Single(Springy):
    kernel = staticmethod(njit(lambda apart: apart[0]))


class NoEnergy(Conservative):
    potential = staticmethod(njit(lambda apart: apart))


@pytest.mark.usefixtures("kernels_of_mods")
@pytest.mark.parametrize(
    ("law", "says"),
    [
        (Nowhere, "The cutoff of test.springy is 0.0; give a distance above 0 m, or math.inf"),
        (Timed, "has a potential, so its force depends on positions only, but its kernel takes 'time'; remove"),
        (OfRods, "is called for each of the particles and cannot take rods_stiffness"),
        (Single, "must return a pair, the force (fx, fy) on the first particle in kN"),
        (NoEnergy, "must return one number, the energy of two particles"),
    ],
)
def test_mistakes_are_named(law: type[Law], says: str) -> None:
    with pytest.raises(ProgramError) as caught:
        Session.open(crowd(4), [law()]).run(steps=1)
    assert says in str(caught.value)
