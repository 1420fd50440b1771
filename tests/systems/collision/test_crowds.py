"""Crowds: discs under drag of which many touch take steps together."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from pinjoint import Session
from pinjoint.components.particle import Particle
from pinjoint.systems.collision.columns import Contact, Group
from pinjoint.systems.collision.driven.columns import Whole
from pinjoint.systems.collision.driven.kernels.crowd import CROWD_CONTACTS
from pinjoint.systems.collision.kernels.projection import separate_motion
from pinjoint.systems.collision.system import persistent_contacts
from pinjoint.systems.program.compiler import Compile, GeneratedModule, entries_to
from tests.reference import bits, scenes_of_discs
from tests.reference.forms import load_all, programs
from tests.systems.collision.test_driven_collisions import GRAVITY, assert_lies, box, energy_of_discs

GRAVITY_PULL = 9.81
CROWDS = GeneratedModule("crowds", lambda: entries_to({"separate": separate_motion}))


def heap(count: int, width: float, *, seed: int = 0, **sections: Any) -> Session:
    """Discs of several sizes, in rows above the floor of a box."""
    rng = np.random.default_rng(seed)
    columns = max(1, int(width / 0.13))
    places = [
        ((k % columns + 0.5) * width / columns - 0.5 * width, 0.07 + 0.13 * (k // columns))
        for k in range(count)
    ]
    radii = rng.uniform(0.03, 0.06, count)
    discs = [
        {"position": list(place), "radius": radius, "mass": 400.0 * radius * radius}
        for place, radius in zip(places, radii.tolist(), strict=True)
    ]
    sections = {"environment": GRAVITY | {"drag": 0.5}, "settings": {"restitution": 0.3}} | sections
    return Session.open(box(discs, half=0.5 * width, **sections))


def deepest(session: Session) -> float:
    """By how much discs are in one another or in the floor, in the smallest radius."""
    place, radius = session.particles.position + session.particles.displacement, session.particles.radius
    into = scenes_of_discs.deepest(place, radius, np.ones(len(radius), dtype=bool))
    return float(max(into, (radius - place[:, 1]).max(), 0.0) / radius.min())


def random_group(discs: int, slack: float, seed: int) -> Any:
    """Discs each of which touches all others, in random directions, and their motion."""
    rng = np.random.default_rng(seed)
    links = np.array([(i, j) for j in range(discs) for i in range(j)])
    angle = rng.uniform(0.0, 2.0 * math.pi, len(links))
    group = Group.empty(discs, len(links))
    group.links[...] = links
    group.contacts[:, [Contact.NX, Contact.NY]] = np.column_stack([np.cos(angle), np.sin(angle)])
    group.contacts[:, Contact.BIAS] = slack * rng.uniform(0.0, 1.0, len(links))
    group.mobility[...], group.motion[...] = rng.uniform(0.2, 5.0, (discs, 1)), rng.normal(size=(discs, 2))
    return group


def hold_apart(group: Any) -> None:
    """Change the motion so that no contact closes faster than its bias."""
    CROWDS.load().separate(len(group.members), len(group.links), 1e-13, group)


def opening(group: Any) -> NDArray[np.float64]:
    """Rates at which contacts open, their biases included."""
    apart = group.motion[group.links[:, 1]] - group.motion[group.links[:, 0]]
    normal, bias = group.contacts[:, [Contact.NX, Contact.NY]], group.contacts[:, Contact.BIAS]
    rates: NDArray[np.float64] = (normal * apart).sum(axis=1) + bias
    return rates


def pushed(group: Any) -> NDArray[np.float64]:
    """What the impulses do to the motion."""
    along = group.contacts[:, [Contact.NX, Contact.NY]] * group.contacts[:, [Contact.IMPULSE]]
    total = np.zeros_like(group.motion)
    np.add.at(total, group.links[:, 1], along)
    np.add.at(total, group.links[:, 0], -along)
    change: NDArray[np.float64] = group.mobility * total
    return change


@example(seed=181, discs=7, slack=0.0)  # of two quotients that are equal one was taken for larger
@given(seed=st.integers(0, 10**6), discs=st.integers(2, 9), slack=st.sampled_from([0.0, 0.7]))
def test_contacts_are_held_apart_by_the_least_change_of_motion(seed: int, discs: int, slack: float) -> None:
    """The conditions of Karush, Kuhn and Tucker, which only the least change satisfies."""
    group = random_group(discs, slack, seed)
    before = group.motion.copy()
    hold_apart(group)
    impulses, rates = group.contacts[:, Contact.IMPULSE], opening(group)
    np.testing.assert_allclose(
        group.motion, before + pushed(group), rtol=0, atol=1e-11 * (1.0 + impulses.max())
    )
    assert impulses.min() >= 0.0
    assert rates.min() >= -1e-11 * (1.0 + impulses.max())
    assert np.abs(impulses * rates).max() <= 1e-11 * (1.0 + impulses.max()) ** 2


@example(seed=12, discs=12, known=0.34375)  # impulses after the last sweep that pull
@given(st.integers(0, 10**6), st.integers(12, 20), st.floats(0.0, 1e3))
def test_impulses_that_are_not_found_do_no_work(seed: int, discs: int, known: float) -> None:
    """Sweeps over so many contacts that depend on one another go on for long, and may begin with any impulses."""
    group = random_group(discs, 0.3, seed)
    before = group.motion.copy()
    group.contacts[:, Contact.IMPULSE] = known
    hold_apart(group)
    impulses = group.contacts[:, Contact.IMPULSE]
    np.testing.assert_allclose(group.motion, before + pushed(group), rtol=0, atol=1e-9 * (1.0 + impulses.max()))
    assert impulses.min() >= 0.0
    assert (impulses * opening(group)).sum() <= 1e-9 * (1.0 + impulses.max()) ** 2
    masses = 1.0 / group.mobility
    assert (masses * group.motion**2).sum() <= (masses * before**2).sum() * (1.0 + 1e-12)


def test_contacts_that_open_push_by_nothing() -> None:
    """What is left of impulses, too small for a sweep to take back, was a push, and the step tried again in vain."""
    group = random_group(12, 0.3, 0)
    group.contacts[:, Contact.IMPULSE] = 1e-20
    separate_motion(12, len(group.links), 1e-13, group)
    opens = opening(group) > 1e-9
    assert opens.any()
    assert not group.contacts[opens, Contact.IMPULSE].any()


@pytest.mark.parametrize(("width", "restitution", "seed"), [(0.9, 0.0, 1), (0.6, 0.9, 3)])
def test_energy_never_grows_and_nothing_sinks_in(width: float, restitution: float, seed: int) -> None:
    session = heap(40, width, seed=seed, settings={"restitution": restitution})
    load_all()
    before = energy_of_discs(session)
    for _ in range(12):
        session.run(time=0.05)
        now = energy_of_discs(session)
        assert now <= before + 1e-9
        assert deepest(session) <= 1e-6
        before = now
    assert abs(session.energy.imbalance) <= 1e-10
    assert len(session.impacts) > 50
    assert session.simulation.warning == ""


def test_what_contacts_take_is_no_work() -> None:
    """The weights work alone; what forces of contact take is entered as taken by impacts."""
    session = heap(24, 0.55)
    load_all()
    session.run(time=0.3)
    assert taken(session) > 0
    weights = 1000.0 * float((session.particles.constant_force * session.particles.displacement).sum())
    assert session.energy.work == pytest.approx(weights, rel=1e-12)
    assert abs(session.energy.imbalance) <= 1e-10


def taken(*sessions: Session) -> int:
    """How many steps of crowds these have taken since they began."""
    lists = [session.simulation._driven_steps._neighbours for session in sessions]
    return sum(int(near.driven.whole[Whole.CROWDS]) for near in lists)


def test_a_crowd_has_the_same_bits_in_both_forms() -> None:
    found = []
    for choice in (Compile.NEVER, Compile.ALWAYS):
        with programs(choice):
            session = heap(24, 0.55)
            session.run(time=0.25)
            found.append(bits.columns(session.model))
            assert taken(session) >= 10
    assert bits.different(*found) == []


@pytest.mark.parametrize("settings", [{}, {"restitution": 0.0, "integrator": "rk4", "time_step": 1e-3}])
def test_a_heap_comes_to_rest_and_weighs_on_the_floor(settings: dict[str, Any]) -> None:
    session = heap(36, 0.9, **({"settings": settings} if settings else {}))
    assert session.run(until="rest", limit=60.0) == "at rest"
    contacts, weight = persistent_contacts(session.model), GRAVITY_PULL * session.particles.mass.sum()
    assert contacts is not None
    assert len(contacts.pairs) >= CROWD_CONTACTS
    floor = contacts.pairs[:, 1] == 36  # obstacles come after the particles, the floor first
    assert contacts.forces[floor].sum() == pytest.approx(weight, rel=1e-7)
    assert np.abs(session.particles.applied_force).max() <= 1e-8 * weight
    assert deepest(session) <= 1e-6


@pytest.mark.parametrize(("restitution", "drag"), [(0.0, 5.0), (0.0, 0.5), (0.5, 4.0)])
def test_a_narrow_heap_comes_to_rest(restitution: float, drag: float) -> None:
    """The forces of the step before were good enough for every next one, and a trace of motion never ended."""
    sections = {"environment": GRAVITY | {"drag": drag}, "settings": {"restitution": restitution}}
    session = heap(14, 0.4, seed=2, **sections)
    assert session.run(until="rest", limit=6.0) == "at rest"
    assert_lies(session)


def test_a_saved_crowd_goes_on_with_the_same_bits(tmp_path: Path) -> None:
    session = heap(40, 0.9)
    session.run(time=0.12)
    session.save(tmp_path / "heap.json")
    other = Session.open(tmp_path / "heap.json")
    before = taken(session)
    for one in (session, other):
        one.run(time=0.12)
    assert taken(session, other) - before >= 2 * 10
    assert session.particles.displacement.tobytes() == other.particles.displacement.tobytes()
    assert session.particles.velocity.tobytes() == other.particles.velocity.tobytes()


def test_frames_do_not_change_the_bits_of_a_crowd() -> None:
    sessions = [heap(40, 0.9) for _ in range(2)]
    for session, frames in zip(sessions, (60, 17), strict=True):
        for k in range(1, frames + 1):
            session.simulation.run_to(0.25 * k / frames)
    steps = [session.model.clock.steps for session in sessions]
    assert taken(*sessions) > 30
    assert steps[0] == steps[1]
    assert sessions[0].particles.velocity.tobytes() == sessions[1].particles.velocity.tobytes()


def test_a_disc_that_falls_on_a_heap_bounces() -> None:
    """By its own restitution, or nearly: what it strikes gives way."""
    session = heap(30, 0.9, settings={"restitution": 0.8}, environment=GRAVITY | {"drag": 2.0})
    assert session.run(until="rest", limit=60.0) == "at rest"
    session.particles["p0"].velocity = (0.0, 0.0)
    place = session.particles.position + session.particles.displacement
    above = place[np.argmax(place[:, 1])] + [0.0, 0.5]
    session.model.create(Particle, 1, name=["ball"], position=[above], radius=0.05, mass=1.0)
    fastest = 0.0
    for _ in range(60):
        session.run(time=0.01)
        fastest = max(fastest, session.particles["ball"].velocity[1])
    assert 0.3 < fastest < 0.8 * math.sqrt(2 * GRAVITY_PULL * 0.5) + 0.1


def test_an_edit_in_mid_run_does_not_speak_of_overlaps_that_steps_left() -> None:
    session = heap(40, 0.9)
    session.run(time=0.12)
    assert 0.0 < deepest(session) < 1e-6
    session.particles["p0"].force = (0.1, 0.0)
    session.run(time=0.01)
    assert session.simulation.note == ""
