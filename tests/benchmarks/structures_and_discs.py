"""Discs on structures, beside the same structures without discs, in one run: what a step costs."""

import json
import time
from importlib.resources import files
from typing import Any

import numpy as np

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from tests.benchmarks.models import lattice
from tests.reference.forms import load_all
from tests.reference.models import model, particle, rod

Row = dict[str, Any]
GRAVITY = {"acceleration": [0.0, -9.81]}


def deck(balls: int, columns: int = 20, rows: int = 3) -> dict[str, Any]:
    """A lattice of damped rods on two supports, and balls that fall onto it."""
    random, spacing = np.random.default_rng(0), 0.5
    nodes = [(row, column) for row in range(rows) for column in range(columns)]
    particles = [
        particle(f"n{r}.{c}", spacing * c, spacing * r, fixed=[r == 0 and c in (0, columns - 1)] * 2, mass=10.0)
        for r, c in nodes
    ]
    ends = [((r, c), (r + dr, c + dc)) for r, c in nodes for dr, dc in ((0, 1), (1, 0), (1, 1))]
    rods = [
        rod("n{}.{}".format(*a), "n{}.{}".format(*b), stiffness=1e4, damping=20.0)
        for a, b in ends
        if b[0] < rows and b[1] < columns
    ]
    width, top = spacing * (columns - 1), spacing * (rows - 1)
    for k in range(balls):
        x, y = width * (k + 0.5) / balls + random.uniform(-0.05, 0.05), top + 0.5 + random.uniform(0.0, 0.5)
        particles.append(particle(f"ball{k}", x, y, radius=0.12))
    return model(particles, rods, environment=GRAVITY, settings={"restitution": 0.3})


def ball_on_truss(ball: bool) -> dict[str, Any]:
    """The bundled model; without the ball the node that it strikes is given a push."""
    document = _bundled("ball_on_truss")
    if not ball:
        document["particles"] = [p for p in document["particles"] if p["name"] != "ball"]
        next(p for p in document["particles"] if p["name"] == "F")["velocity"] = [0.0, -1.0]
    return document


def ball_on_net(ball: bool) -> dict[str, Any]:
    """A ball that comes to lie on a hanging net of cables, above one of its nodes."""
    document = _bundled("hanging_net")
    document["settings"] |= {"collisions": True, "restitution": 0.5}
    if ball:
        document["particles"].append(particle("ball", 1.27, 1.79, mass=5.0, radius=0.25))
    return document


def large(balls: int) -> Model:
    """A lattice of about 10 000 rods, and balls that fall onto its upper edge."""
    made = lattice(10_000, damping=1.0)
    made.environment.acceleration = (0.0, -9.81)
    corner, radius = made.particles.position.max(axis=0), 0.2
    random = np.random.default_rng(1)
    for k in range(balls):
        x, y = corner[0] * (k + 0.5) / balls, corner[1] + radius + 0.05 + random.uniform(0.001, 0.02)
        made.create(Particle, position=(x, y), radius=radius, mass=0.1)
    return made


def _bundled(name: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(
        (files("pinjoint.assets") / "models" / f"{name}.json").read_text(encoding="utf-8")
    )
    return document


def _measured(session: Session, seconds: float) -> tuple[float, int]:
    """Processor time (s) and number of steps of the next seconds."""
    steps, started = session.model.clock.steps, time.process_time()
    session.run(time=seconds)
    return time.process_time() - started, session.model.clock.steps - steps


def _row(name: str, alone: Session, struck: Session, seconds: float, later: float = 0.0) -> Row:
    for session in (alone, struck):
        session.run(time=1e-6 + later)
    load_all()
    own, own_steps = _measured(alone, seconds)
    spent, steps = _measured(struck, seconds)
    contacts = struck.model.clock.collision_state
    return {
        "structure": name,
        "rods": struck.rods.count,
        "impacts": len(struck.impacts),
        "contacts": 0 if contacts is None else len(contacts.pairs),  # type: ignore[union-attr]
        "own_us_a_step": 1e6 * own / own_steps,
        "us_a_step": 1e6 * spent / steps,
        "times_its_own": (spent / steps) / (own / own_steps),
        "s_per_s": spent / seconds,
        "unaccounted": float(abs(struck.energy.imbalance) / struck.model.clock.energy_scale),
    }


def driven(*, quick: bool) -> list[Row]:
    """Discs on structures: a step, as a multiple of that of the structure alone, and processor time per simulated second.

    unaccounted: energy that is nowhere, of all that was supplied.
    """
    opened = Session.open
    rows = [
        _row("deck, 30 balls", opened(deck(0)), opened(deck(30)), 0.5 if quick else 2.0),
        _row("ball on truss", opened(ball_on_truss(False)), opened(ball_on_truss(True)), 1.2),
        _row("net, a ball lying", opened(ball_on_net(False)), opened(ball_on_net(True)), 1.0, later=2.0),
    ]
    if not quick:
        rows.append(_row("lattice, 100 balls", Session(large(0)), Session(large(100)), 0.3))
    return rows
