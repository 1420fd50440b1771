"""Models of the playground, pulled and thrown at random: `python -m tests.stability.pulled swing 3600` for an hour."""

import sys
import time

import numpy as np

from pinjoint import Session
from pinjoint.systems.edit.pull import Hand

FARTHEST = 1.0  # m, of a pull
FASTEST = 6.0  # m/s, of a throw
ACCOUNT = 1e-4  # of the energy that came in and that is there, what may be missing


def pulled_at_random(name: str, seconds: float, seed: int = 0) -> Session:
    """A session of a model in which hands pull and throw particles for some simulated time; its account is closed."""
    session, random = Session.open(name), np.random.default_rng(seed)
    model, timeline, run_to = session.model, session.document.timeline, session.simulation.run_to
    free = np.flatnonzero(~model.particles.fixed.all(axis=1))
    while session.time < seconds:
        particle = model.particles[int(random.choice(free))]
        session.simulation.advance(0)
        hand = Hand.on(model, session.view, particle, lambda: 1.0)
        for _ in range(int(random.integers(1, 5))):
            away = random.uniform(-FARTHEST, FARTHEST, 2)
            timeline.hold(hand.at(tuple((np.array(particle.displacement) + away).tolist())))
            run_to(session.time + random.uniform(0.05, 0.5))
        throws = random.random() < 0.5
        thrown = hand.throwing(model, tuple(random.uniform(-FASTEST, FASTEST, 2).tolist())) if throws else None
        timeline.hold(thrown if thrown is not None and thrown.thrown is not None else None)
        run_to(session.time + random.uniform(0.1, 2.0))
        check(session)
    return session


def check(session: Session) -> None:
    """The run goes on, its numbers are numbers, and no energy is missing."""
    energy = session.energy.as_dict()
    assert session.simulation.message == "" or session.simulation.halted, session.simulation.message
    assert not session.simulation.halted or session.model.clock.at_rest, session.simulation.message
    for column in (session.model.particles.displacement, session.model.particles.velocity):
        assert np.isfinite(column).all()
    moved = abs(energy["work"]) + energy["kinetic"] + energy["elastic"] + energy["dissipated_impact"]
    assert abs(energy["imbalance"]) <= ACCOUNT * max(moved, 1.0), energy


if __name__ == "__main__":
    began = time.perf_counter()
    ended = pulled_at_random(sys.argv[1], float(sys.argv[2]), *map(int, sys.argv[3:]))
    print(sys.argv[1], f"{ended.time:.0f} s simulated in {time.perf_counter() - began:.0f} s,", ended.energy)
