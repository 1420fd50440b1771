"""Impacts and contacts with structures, and of particles under drag or a person's hand, through Session."""

import contextlib
import itertools
import math
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.clock import PersistentContacts
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.systems.broad_phase import gaps, nearest
from pinjoint.systems.collision.columns import Contact, Group
from pinjoint.systems.collision.driven.columns import Goal, Order, Phase, Real, Whole
from pinjoint.systems.collision.driven.kernels.contacts import MOST_STEP_CUTS, choose_contacts, judge_forces
from pinjoint.systems.collision.driven.kernels.steps import MOST_ENDS_TRIED, collide
from pinjoint.systems.collision.driven.neighbours import DRIVEN, NeighbourList
from pinjoint.systems.collision.kernels.impact import respond
from pinjoint.systems.collision.system import persistent_contacts
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.program.compiler import Compile, GeneratedModule, entries_to
from pinjoint.systems.program.entries import Account, Control
from pinjoint.systems.program.program import Program
from tests.benchmarks.models import touching
from tests.reference import bits
from tests.reference.forms import programs
from tests.reference.models import model, particle, portal_in_wind, rod, struck

GRAVITY = {"acceleration": [0.0, -9.81]}


def truss(ball: dict[str, Any], restitution: float = 0.5, **settings: Any) -> dict[str, Any]:
    """Two rods to two pins, and a ball above the node that they carry."""
    return model(
        [
            particle("A", 0.0, 0.0, fixed=[True, True]),
            particle("B", 1.0, 0.5),
            particle("C", 2.0, 0.0, fixed=[True, True]),
            particle("ball", 1.0, 0.65, mass=2.0) | ball,
        ],
        [rod(*ends, stiffness=200, damping=0.2, density=3) for ends in ("AB", "BC")],
        environment=GRAVITY,
        settings={"restitution": restitution, **settings},
    )


def test_what_a_window_loads_ahead_of_need_can_be_called() -> None:
    """Here, not in the process that compiles it, nor in the frame in which the window calls it."""
    DRIVEN.load()
    assert DRIVEN.is_compiled()


def state(session: Session) -> bytes:
    particles = session.model.particles
    return particles.displacement.tobytes() + particles.velocity.tobytes()


def gap(session: Session) -> float:
    """Between the rims of the ball and the node."""
    particles = session.particles
    rows = np.array([[particles.names.index("B"), particles.names.index("ball")]])
    return float(gaps(particles.position + particles.displacement, particles.radius, rows)[0][0])


def test_a_ball_comes_to_rest_on_a_truss_and_loads_it() -> None:
    session = Session.open(truss({}))
    assert session.run(until="rest") == "at rest"
    assert abs(gap(session)) < 1e-6 * 0.05
    loaded = Session.open(truss({"position": [1.0, 5.0], "fixed": [True, True]}))
    loaded.particles["B"].force = (0.0, -2.0 * 9.81e-3)
    loaded.settings.collisions = False
    loaded.settle()
    assert session.rods["AB"].axial_force == pytest.approx(loaded.rods["AB"].axial_force, rel=1e-7)
    assert session.particles["A"].reaction == pytest.approx(loaded.particles["A"].reaction, rel=1e-7)


def test_energy_is_accounted_for() -> None:
    session = Session.open(truss({}))
    session.run(time=0.5)
    energy = session.energy
    assert len(session.impacts) >= 3
    assert energy.dissipated_impact > 0.05 * energy.work
    assert energy.dissipated_impact == pytest.approx(session.impacts.energy_lost.sum(), rel=1e-3)
    assert energy.imbalance == pytest.approx(0.0, abs=1e-7 * energy.work)


def test_all_integrators_agree() -> None:
    found = {}
    for settings in ({}, {"integrator": "velocity_verlet", "time_step": 1e-4}, {"integrator": "rk4"}):
        session = Session.open(truss({}, **settings))
        session.run(time=0.19)
        found[session.simulation.integrator.key] = session
    exact = found.pop("dop853")
    assert len(exact.impacts) >= 4
    for session in found.values():
        assert len(session.impacts) == len(exact.impacts)
        np.testing.assert_allclose(session.impacts.time, exact.impacts.time, rtol=1e-4)
        np.testing.assert_allclose(
            session.model.particles.displacement, exact.model.particles.displacement, atol=1e-5
        )


@pytest.mark.parametrize("speed", [10.0, 1e3, 1e6])
def test_nothing_tunnels_through_a_node(speed: float) -> None:
    """First impact: impulse −(1 + e) v m_ball m_node / (m_ball + m_node), at the time of the free flight."""
    document = truss({"position": [1.0, 3.0], "velocity": [0.0, -speed]}, integrator="velocity_verlet")
    document["environment"] = {}
    document["settings"]["time_step"] = 1e-2
    session = Session.open(document)
    session.settings.restitution = 0.5
    session.run(time=3.0 / speed)
    node = session.particles["B"].mass
    assert session.impacts.time[0] == pytest.approx(2.4 / speed, rel=1e-12)
    assert session.impacts.impulse[0] == pytest.approx(1.5 * speed * 2.0 * node / (2.0 + node), rel=1e-12)


@pytest.mark.parametrize("integrator", ["velocity_verlet", "rk4", "dop853"])
def test_a_run_ends_at_its_time_also_shortly_before_an_impact(integrator: str) -> None:
    """The ball meets the node at 0.1 s; steps of 0.04 s would end there."""
    document = truss({"position": [1.0, 0.7], "velocity": [0.0, -1.0]}, integrator=integrator)
    document["environment"] = {}
    if integrator != "dop853":
        document["settings"]["time_step"] = 0.04
    session = Session.open(document)
    session.run(time=0.095)
    assert session.time == 0.095
    assert len(session.impacts) == 0
    assert session.particles["ball"].displacement[1] == pytest.approx(-0.095, rel=1e-12)
    session.run(time=0.01)
    assert session.impacts.time.tolist() == pytest.approx([0.1], rel=1e-12)


def test_how_a_run_is_divided_does_not_matter_nor_is_anything_lost_by_saving(tmp_path: Path) -> None:
    whole, divided = Session.open(truss({})), Session.open(truss({}))
    whole.run(steps=160)
    for _ in range(8):
        divided.run(steps=20)
        divided.save(tmp_path / "saved.json")
        divided = Session.open(tmp_path / "saved.json")
    assert whole.model.clock.collision_state is not None, "the ball rests on the node by now"
    assert state(whole) == state(divided)
    assert whole.energy == divided.energy


@pytest.mark.parametrize(("integrator", "tolerance"), [("esdirk4", 1e-6), ("dop853", 1e-9)])
def test_as_many_steps_are_taken_as_asked_for(integrator: str, tolerance: float) -> None:
    """A step that ends at an impact is one, in however many parts the error lets it be taken."""
    ball = {"position": [1.0, 0.7], "velocity": [0.0, 0.0]}
    session = Session.open(truss(ball, integrator=integrator, tolerance=tolerance))
    counts = []
    for _ in range(300):
        session.run(steps=1)
        counts.append(session.model.clock.steps)
    assert counts == list(range(1, 301))
    assert len(session.impacts) > 10


def test_interrupts_leave_no_contacts_that_the_state_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each comes after the program returned and before what began to persist is noted."""
    session, straight = Session.open(truss({})), Session.open(truss({}))
    straight.run(steps=160)
    drive, calls = Program.drive, itertools.count(1)

    def interrupted(program: Program, *bounds: Any) -> Any:
        done = drive(program, *bounds)
        if next(calls) % 3 == 0:
            raise KeyboardInterrupt
        return done

    monkeypatch.setattr(Program, "drive", interrupted)
    while (left := 160 - session.model.clock.steps) > 0:
        with contextlib.suppress(KeyboardInterrupt):
            session.run(steps=min(4, left))
    assert state(session) == state(straight)


def test_particles_joined_by_a_rod_pass_through_each_other() -> None:
    document = truss({})
    document["particles"][3] = {"name": "ball", "position": [1.0, 0.58], "mass": 2.0}
    document["rods"].append({"name": "B-ball", "between": ["B", "ball"], "stiffness": 1.0, "damping": 1.0})
    session = Session.open(document)
    session.run(time=0.2)
    assert len(session.impacts) == 0


def test_nodes_that_overlap_are_left_alone() -> None:
    document = truss({"position": [1.0, 5.0], "fixed": [True, True]})
    document["particles"].append({"name": "D", "position": [1.04, 0.45]})
    document["rods"] += [
        {"name": "AD", "between": ["A", "D"], "stiffness": 200, "damping": 1},
        {"name": "CD", "between": ["C", "D"], "stiffness": 200, "damping": 1},
    ]
    session = Session.open(document)
    session.run(time=0.2)
    assert len(session.impacts) == 0
    assert "overlap" not in session.message


def test_what_is_pressed_together_from_rest_is_in_contact_at_once() -> None:
    """A compressed rod is let go against a disc that touches it and parts by round-off: they meet before a moment
    that can be told from the present one, which once let no time pass for ever."""
    particles = [
        particle("A", 0, 0, fixed=[True, True]),
        particle("B", 1, 0, radius=0.0625, fixed=[False, True]),
        particle("C", 1.125, 0, radius=0.0625, velocity=[1e-17, 0]),
    ]
    rods = [rod("A", "B", rest_length=1.001)]
    session = Session.open(model(particles, rods, state={"time": 0.5, "origin": 0.5}))
    session.run(steps=40)
    assert session.model.clock.steps == 40
    assert session.particles["C"].velocity[0] > 1.0
    assert abs(session.energy.imbalance) < 1e-9 * session.energy.initial


def test_drag_slows_particles_between_impacts() -> None:
    """v = v₀ exp(−c t): distance to the impact v₀ (1 − exp(−c t))/c = 0.9 m."""
    particles = [particle("p", 0.0, 0.0, velocity=[2.0, 0.0]), particle("q", 1.0, 0.0)]
    session = Session.open(model(particles, [], environment={"drag": 1.0}))
    session.run(time=1.0)
    assert session.impacts.time[0] == pytest.approx(-np.log(1.0 - 0.45), rel=1e-9)
    assert session.particles["q"].velocity[0] == pytest.approx(2.0 * np.exp(-1.0), rel=1e-8)


def test_a_structure_without_anything_near_it_takes_the_same_steps() -> None:
    collides, alone = Session.open("warren_bridge"), Session.open("warren_bridge")
    alone.settings.collisions = False
    for session in (collides, alone):
        session.run(steps=300)
    assert "collision.discs" in [system.name for system in collides.simulation.plan]
    assert state(collides) == state(alone)


@pytest.mark.parametrize("below", ["floor", "disc"])
def test_a_particle_under_drag_that_begins_in_contact_lies_there(below: str) -> None:
    """Nothing moves at first, so that no speed tells that it is about to meet what it touches."""
    document = model([particle("p", 0.0, 0.05)], [], environment=GRAVITY | {"drag": 1.0})
    if below == "floor":
        document["components"] = {"walls.Wall": [{"name": "w", "start": [-1.0, 0.0], "end": [1.0, 0.0]}]}
    else:
        document["particles"].append(particle("q", 0.0, -0.05, fixed=[True, True]))
    session = Session.open(document)
    session.run(time=0.1)
    assert session.particles["p"].displacement == pytest.approx((0.0, 0.0), abs=1e-12)
    assert len(session.impacts) == 0


# --- several things in contact at once ------------------------------------------------------------------------


def box(discs: list[dict[str, Any]], half: float = 0.3, **sections: Any) -> dict[str, Any]:
    """Discs between two walls on a floor, of half the width `half` (m)."""
    ends = {
        "floor": ([-half, 0.0], [half, 0.0]),
        "left": ([-half, 0.0], [-half, 3.0]),
        "right": ([half, 0.0], [half, 3.0]),
    }
    walls = [{"name": name, "start": start, "end": end} for name, (start, end) in ends.items()]
    named = [{"name": f"p{k}", **disc} for k, disc in enumerate(discs)]
    return model(named, [], components={"walls.Wall": walls}, **({"environment": GRAVITY} | sections))


@pytest.mark.parametrize(("count", "restitution"), [(8, 0.5), (12, 0.0), (16, 0.0)])
def test_energy_never_grows_where_rows_of_discs_fit_exactly_between_walls(
    count: int, restitution: float
) -> None:
    """Six discs fill the box from wall to wall: which forces jam them is not determined, and must not matter."""
    places = [(-0.2 + 0.13 * (k % 4) + 0.003 * k, 0.06 + 0.13 * (k // 4)) for k in range(count)]
    discs = [{"position": list(place)} for place in places]
    session = Session.open(
        box(discs, environment=GRAVITY | {"drag": 0.5}, settings={"restitution": restitution})
    )
    before = energy_of_discs(session)
    for _ in range(30):
        how = session.run(time=0.1)
        now = energy_of_discs(session)
        assert now <= before + 1e-9 * abs(before)
        before = now
        if how == "at rest":
            break
    assert np.abs(session.particles.velocity).max() < 1.0
    assert abs(session.energy.imbalance) <= 1e-10
    assert_inside(session)


def energy_of_discs(session: Session) -> float:
    """Of motion and in the field of constant forces (J), 0 where they were drawn at rest."""
    particles = session.particles
    return session.energy.kinetic - 1000.0 * float((particles.constant_force * particles.displacement).sum())


@np.errstate(all="ignore")  # of what is lost
def gaps_of(near: NeighbourList, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Between the rims of pairs now (m), and unit vectors from the first of each to the second."""
    (i, j), driven, moved = pairs.T, near.driven, near.everywhere(near.displacement)
    line = nearest((driven.position[j] - driven.position[i]) + (moved[j] - moved[i]), driven.span[j])
    distance = np.hypot(*line.T)
    return distance - driven.radius[pairs].sum(axis=1), line / np.where(distance > 0.0, distance, 1.0)[:, None]


def assert_inside(session: Session) -> None:
    """Nothing sunk in by 1e-6 of a radius."""
    near = NeighbourList(session.model)
    near.look_up()
    near.list_within(0.0)
    gap, _ = gaps_of(near, near.pairs)
    assert gap.min(initial=0.0) >= -1e-6 * session.particles.radius.min()


def assert_lies(session: Session) -> None:
    """At rest, nothing sunk in by 1e-6 of a radius, and what holds it bears its weight."""
    particles, near = session.model.particles, NeighbourList(session.model)
    near.look_up()
    assert_inside(session)
    contacts = persistent_contacts(session.model)
    assert contacts is not None
    assert (contacts.forces >= 0.0).all()
    _, normal = gaps_of(near, contacts.pairs)
    force = 1000.0 * particles.constant_force
    for (i, j), n, push in zip(contacts.pairs, normal, contacts.forces, strict=True):
        force[i] -= push * n
        if j < particles.count:
            force[j] += push * n
    alone = np.ones(particles.count, dtype=bool)
    alone[session.model.rods.between.ravel()] = False
    weight = 1000.0 * np.abs(particles.constant_force).max()
    assert np.abs(force[alone]).max() <= 1e-6 * weight


@pytest.mark.parametrize("drag", [0.5, 20.0])
def test_a_small_pile_comes_to_rest_under_drag(drag: float) -> None:
    """What opened within a step once met again at its start, for ever."""
    discs = [{"position": [-0.2 + 0.13 * (k % 4) + 0.003 * k, 0.06 + 0.13 * (k // 4)]} for k in range(8)]
    environment = GRAVITY | {"drag": drag}
    session = Session.open(box(discs, environment=environment, settings={"restitution": 0.0}))
    assert session.run(until="rest", limit=20.0) == "at rest"
    assert_lies(session)
    assert abs(session.energy.imbalance) < 1e-9 * session.energy.work


@pytest.mark.parametrize(
    ("count", "restitution", "drag", "integrator"),
    [(14, 0.8, 2.0, "dop853"), (18, 0.5, 5.0, "dop853"), (14, 0.5, 2.0, "velocity_verlet")],
)
def test_jammed_rows_come_to_rest_under_drag(
    count: int, restitution: float, drag: float, integrator: str
) -> None:
    """What a contact force lacked, a gap within its tolerance, was in every step the same, and moved for ever.

    In the last of them a jam at the end of a step of 5 µs counted as energy that was missing from then on.
    """
    places = [(-0.2 + 0.13 * (k % 4) + 0.003 * k, 0.06 + 0.13 * (k // 4)) for k in range(count)]
    settings = {"restitution": restitution, "integrator": integrator}
    sections = {"environment": GRAVITY | {"drag": drag}, "settings": settings}
    session = Session.open(box([{"position": list(place)} for place in places], **sections))
    assert session.run(until="rest", limit=6.0) == "at rest"
    assert_lies(session)
    supplied = energy_of_discs(session)
    assert session.model.clock.energy_scale < 10.0 * abs(supplied)  # a larger one would make motion round-off


def test_a_ball_rests_on_a_cable() -> None:
    """Where it settles: the cable, loaded by its weight at mid span, is in balance with it."""
    rope = {"stiffness": 100, "damping": 2.0, "density": 1, "tension_only": True}
    document = truss({"position": [1.0, 0.1], "mass": 1.0, "fixed": [True, False]}, restitution=0.3)
    document["particles"][1]["position"] = [1.0, -0.1]
    document["rods"] = [rope | {"name": name, "between": list(name)} for name in ("AB", "BC")]
    session = Session.open(document)
    assert session.run(until="rest", limit=20.0) == "at rest"
    assert_lies(session)
    x, y = np.add(session.particles["B"].position, session.particles["B"].displacement)
    pull = session.rods["AB"].axial_force
    node = session.particles["B"].mass
    assert pull == pytest.approx(9.81e-3 * (1.0 + node) * np.hypot(x, y) / (-2.0 * y), rel=1e-7)


def test_elastic_bounces_that_a_damper_calms_end() -> None:
    """A spring presses a node onto a rock: its bounces become ever shorter, without end, and lose nothing themselves."""
    particles = [
        particle("pin", 0.0, 1.0, fixed=[True, True]),
        particle("node", 0.0, 0.5, fixed=[True, False], radius=0.02),
        particle("rock", 0.0, 0.25, fixed=[True, True], radius=0.2),
    ]
    spring = rod("pin", "node", stiffness=1.0, damping=0.01, rest_length=0.6)
    session = Session.open(model(particles, [spring], environment=GRAVITY, settings={"restitution": 1.0}))
    assert session.run(until="rest", limit=10.0) == "at rest"
    assert 100 < len(session.impacts) < 2000
    contacts = persistent_contacts(session.model)
    assert contacts is not None
    weight, pressed = 9.81 * session.particles["node"].mass, 1000.0 * (0.6 - 0.53) / 0.6
    assert contacts.forces == pytest.approx([weight + pressed], rel=1e-9)
    assert abs(session.energy.imbalance) <= 1e-10 * session.model.clock.energy_scale


def test_a_ball_that_makes_a_truss_yield_rests_on_what_is_left() -> None:
    """Its energy goes into impacts, dampers and plastic strain; afterwards no rod exceeds its strength."""
    document = truss({"mass": 20.0}, restitution=0.5)
    for each in document["rods"]:
        each |= {"tensile_strength": 0.3, "compressive_strength": 0.3, "damping": 2.0}
    session = Session.open(document)
    assert session.run(until="rest") == "at rest"
    assert_lies(session)
    energy = session.energy
    assert energy.dissipated_plastic > 0.1 * energy.work
    assert abs(energy.imbalance) < 1e-6 * energy.work
    assert np.abs(session.model.rods.axial_force).max() <= 0.3 * (1.0 + 1e-12)


def test_a_hand_presses_a_disc_onto_a_node() -> None:
    """From aside, then from above; it never passes, and all work is accounted for, in impacts and contact."""
    session = Session.open(truss({"position": [0.2, 1.5]}))
    session.simulation.advance(0)
    hand = Hand.on(session.model, session.view, session.particles["ball"], lambda: natural_pace(session.model))
    for k in range(20):
        session.document.timeline.hold(hand.at((0.8, -0.8 if k < 10 else -1.1)))
        session.run(time=0.1)
        assert gap(session) > -1e-6 * 0.05
    session.document.timeline.hold(None)
    energy = session.energy
    assert len(session.impacts) > 0
    assert abs(energy.imbalance) < 1e-6 * (abs(energy.work) + energy.dissipated_damping)


@pytest.mark.parametrize("count", [1, 14])
@pytest.mark.parametrize("integrator", ["dop853", "velocity_verlet"])
def test_forces_of_a_very_short_step_are_not_taken_for_energy_from_nowhere(integrator: str, count: int) -> None:
    """A jam in a step of microseconds pushes a thousand times harder than anything in the next one."""
    discs = [{"position": [-0.25 + 0.1 * (k % 6), 0.05 + 0.1 * (k // 6)]} for k in range(count)]
    discs[-1]["velocity"] = [0.05, 0.0]
    settings = {"restitution": 0.0, "integrator": integrator}
    session = Session.open(box(discs, environment=GRAVITY | {"drag": 5.0}, settings=settings))
    session.run(steps=1)  # the next one is checked
    contacts = persistent_contacts(session.model)
    assert contacts is not None
    session.model.writable("clock.collision_state")[0] = PersistentContacts(
        contacts.pairs, np.full(len(contacts.pairs), 1e8), math.inf
    )
    assert session.run(time=0.02) == "time reached"
    assert_inside(session)
    assert energy_of_discs(session) <= 0.5 * 0.05**2
    assert session.model.clock.energy_scale < 20.0  # of round-off a larger one would make motion


@pytest.mark.parametrize("count", [12, 30, 6])
def test_the_largest_imbalance_is_one_of_the_whole_account(count: int) -> None:
    """Steps are checked before what their contact forces do is entered, some 1e-4 of the energy, which is not lost."""
    places = [(-0.2 + 0.13 * (k % 4) + 0.003 * k, 0.06 + 0.13 * (k // 4)) for k in range(count)]
    discs = [{"position": list(place)} for place in places]
    session = Session.open(box(discs, environment=GRAVITY | {"drag": 0.5}, settings={"restitution": 0.3}))
    session.run(time=0.5)
    clock = session.model.clock
    assert abs(session.energy.imbalance) <= 1e-12 * clock.energy_scale
    assert abs(clock.largest_imbalance) <= 1e-12 * clock.energy_scale


def test_a_state_that_is_returned_to_is_under_its_own_contact_forces() -> None:
    """Those of the discarded state once counted in the energy that the steps from there on are compared with."""
    disc = {"position": [0.0, 0.1], "velocity": [0.05, 0.0]}
    settings = {"restitution": 0.0, "integrator": "velocity_verlet"}
    session = Session.open(box([disc], environment=GRAVITY | {"drag": 0.5}, settings=settings))
    simulation = session.simulation
    simulation.advance(0)
    simulation.program.observe()
    before, unbalanced = simulation.present(), simulation.program.unbalanced.copy()
    session.run(time=0.3)
    assert persistent_contacts(session.model) is not None
    before.restore(simulation.model)
    simulation.program.observe()
    assert simulation.program.unbalanced.tolist() == unbalanced.tolist()


def test_a_step_that_is_cut_does_not_outlast_the_run() -> None:
    """What is jammed is followed in steps that are short at first, but not shorter than a run that ends before."""
    disc = {"position": [0.0, 0.05], "velocity": [0.05, 0.0]}
    session = Session.open(box([disc], environment=GRAVITY | {"drag": 0.5}, settings={"restitution": 0.0}))
    session.run(time=0.1)
    contacts = persistent_contacts(session.model)
    assert contacts is not None
    session.model.writable("clock.collision_state")[0] = PersistentContacts(
        contacts.pairs, contacts.forces, 0.5 * session.model.clock.step_size
    )
    session.run(time=1e-4)
    assert session.time == pytest.approx(0.1001, abs=1e-15)


@pytest.mark.parametrize("integrator", list(INTEGRATORS))
def test_a_frame_in_which_nothing_meets_moves_as_without_collisions(integrator: str) -> None:
    """Also where more steps were taken at once than could be known to be clear, which are put back."""
    found = []
    with programs(Compile.NEVER):
        for collisions in (True, False):
            session = Session.open(portal_in_wind(integrator, collisions=collisions))
            session.run(steps=90)
            assert session.simulation.programs.collides is collisions
            found.append(bits.state(session.model))
    assert bits.different(*found) == []


@pytest.mark.parametrize("integrator", list(INTEGRATORS))
def test_up_to_an_impact_a_frame_moves_as_without_collisions(integrator: str) -> None:
    """The step that ends there is taken again, from the forces and moments at its beginning."""
    document = struck(integrator)
    with programs(Compile.NEVER):
        session, alone = Session.open(document), Session.open(document)
        alone.settings.collisions = False
        while session.model.clock.collisions == 0:
            session.run(steps=1)
        alone.simulation.run_to(session.time)
    frame, expected = session.model.particles, alone.model.particles
    assert np.abs(expected.angular_velocity).max() > 1e-3
    assert frame.rotation == pytest.approx(expected.rotation, rel=1e-12, abs=1e-15)
    assert frame.angular_velocity == pytest.approx(expected.angular_velocity, rel=1e-12, abs=1e-13)


def test_an_impact_that_would_be_reflected_for_minutes_ends() -> None:
    """Light discs between heavy ones are reflected the more often, the lighter they are: some 1e8 times for 1e16."""
    module = GeneratedModule("joint_impacts", lambda: entries_to({"respond": respond}))
    random = np.random.default_rng(12)
    place = np.array([(i + 0.5 * (j % 2), j * 0.75**0.5) for j in range(4) for i in range(4)])
    pairs = [(i, j) for i in range(16) for j in range(i) if np.hypot(*(place[i] - place[j])) < 1.1]
    group = Group.empty(len(place), len(pairs))
    group.links[...] = pairs
    group.contacts[:, [Contact.NX, Contact.NY]] = place[group.links[:, 1]] - place[group.links[:, 0]]
    group.mobility[...] = 10.0 ** random.uniform(-8.0, 8.0, (16, 1))
    group.motion[...] = random.normal(size=(16, 2))
    group.contacts[:, Contact.COMPLIANCE] = group.mobility[group.links, 0].sum(axis=1)
    energy = (group.motion**2 / group.mobility).sum()
    module.load().respond(1, 0, 1.0, group)  # which compiles it
    group.cut_short[0] = 0
    began = time.process_time()
    module.form.respond(16, len(pairs), 1.0, group)
    assert time.process_time() - began < 10.0  # about 1
    assert group.cut_short[0] == 1
    assert (group.motion**2 / group.mobility).sum() <= energy * (1.0 + 1e-9)
    change = (group.motion - group.initial) / group.mobility
    assert np.abs(change.sum(axis=0)).max() <= 1e-9 * np.abs(change).max()


@pytest.mark.parametrize("count", [8, 60])
def test_an_impact_along_a_row_of_discs_ends(count: int) -> None:
    """It leaves some that approach each other by round-off, from which no other impact follows."""
    model = touching(count, 1)
    model.create(Particle, 2, position=[(5.0, -5.0), (6.0, -5.0)], fixed=[(True, True), (False, False)])
    model.create(Rod, between=[(count, count + 1)])
    session = Session(model)
    session.run(steps=3)
    speed = session.particles.velocity[:count, 0]
    assert speed[:-1] == pytest.approx(np.zeros(count - 1), abs=1e-12)
    assert speed[-1] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("drag", [0.0, 1.0])
def test_impacts_that_were_not_reflected_to_the_end_are_told(drag: float) -> None:
    """Of free discs, and of such as an integrator moves; until the run is taken back to before them."""
    session, told = Session(touching(3, 1)), "2 joint impacts had more reflections than can be followed"
    session.environment.drag = drag
    session.run(steps=1)
    run = session.simulation
    flying = run.programs.flying or run._driven_steps._neighbours.driven
    flying.group.cut_short[0] = 2
    session.run(steps=1)
    assert told in run.said
    session.undo()
    session.undo()
    assert len(run.impacts) == 0
    assert told not in run.said


def two_apart(radii: float) -> tuple[Session, tuple[Any, ...]]:
    """A disc and another, so many radii farther away than where they touch, and what `collide` is given of them."""
    session = Session(touching(2, 1))
    near = NeighbourList(session.model)
    near.look_up()
    near.list_within(0.0)
    control, account = np.zeros(len(Control)), np.zeros(len(Account))
    control[Control.TIME], place = 1e-3, near.displacement.copy()
    place[1, 0] = 0.05 * radii
    return session, (near.driven, control, account, place, near.velocity)


def test_contacts_that_no_forces_close_are_counted_and_told() -> None:
    """A disc that is pressed into another while its step cannot be cut any more."""
    session, arrays = two_apart(-0.01)
    driven = arrays[0]
    driven.lasting[0] = 1
    assert choose_contacts(driven, np.zeros((2, 2)))
    driven.whole[Whole.TURN], driven.whole[Whole.CUTS] = 1, MOST_STEP_CUTS
    assert judge_forces(*arrays) == Order.GO_ON
    assert driven.whole[Whole.PHASE] == Phase.HELD  # the step is accepted
    assert driven.whole[Whole.UNCLOSED] == 1
    assert driven.real[Real.UNCLOSED] == pytest.approx(0.01, rel=1e-6)
    session.simulation._driven_steps.unclosed = 1, 0.01
    assert "In one step no forces were found that close all contacts" in session.simulation.warning
    assert "1.00 % of a radius" in session.simulation.warning


def test_a_step_that_is_not_found_to_end_at_its_impact_is_counted() -> None:
    """After so many tries it ends where the two have not met yet."""
    _, arrays = two_apart(0.01)
    whole, real = arrays[0].whole, arrays[0].real
    whole[Whole.PHASE], whole[Whole.GOAL], whole[Whole.TRIES] = Phase.HELD, Goal.IMPACT, MOST_ENDS_TRIED - 1
    real[Real.NOW] = real[Real.IMPACT] = 1e-3
    real[Real.LAST] = 1.0
    assert collide(*arrays) == Order.LEAVE
    assert whole[Whole.UNCLOSED] == 1
    assert real[Real.UNCLOSED] == pytest.approx(0.01, rel=1e-6)


def test_a_step_that_time_cannot_halve_ends() -> None:
    """Two discs that go on together for 3e14 s, where neither their gap nor a part of the step can be told."""
    far = {"A": (0.0, 786302574516043.8), "B": (0.5, 786302574516043.4)}
    discs = [
        particle(name, x, 0.0, displacement=[far_away, 0.0], velocity=[2.5, 0.0], mass=1.0)
        for name, (x, far_away) in far.items()
    ]
    document = model(
        [*discs, particle("C", 0.0, 2.0), particle("D", 0.0, -1.5)],
        [rod("C", "D")],
        settings={"restitution": 0.0, "tolerance": 1e-9},
        state={"time": 314521029806417.44, "step_size": 811667173693980.5, "steps": 4},
    )
    session = Session.open(document)
    session.step(3)
    assert session.model.clock.time > 314521029806417.44


@pytest.mark.parametrize("drag", [0.0, 1.0])
def test_discs_that_are_hardly_pulled_raise_no_warning(drag: float) -> None:
    discs = [
        particle("A", 0.0, 0.0, velocity=[1.0, 0.0]),
        particle("B", 9.0, 0.0, force=[5e-324, 0.0], mass=1.0),
    ]
    session = Session.open(model(discs, [], environment={"drag": drag}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        session.run(steps=3)
    assert session.particles["A"].displacement[0] > 0.0
