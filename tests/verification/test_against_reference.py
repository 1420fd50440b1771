"""Compiled step programs against the slow, obvious physics of tests/reference, on generated models."""

import itertools
import math
from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pinjoint import Session
from tests.reference import physics
from tests.reference.elements import Document
from tests.reference.models import model, particle

STEPS = 200
AGREEMENT = 1e-11  # of the largest value of its kind in the run; both round in another order, 200 times
ROUNDING = 1e-14  # of a strain, whose force is this times the stiffness; both round positions near 1 m

NOTHING = 1e-20  # kN, m, …: what rounding leaves where all values of a kind are zero

SHORTEST = 0.1  # m; a rod that shrinks to a point turns at once and magnifies round-off without limit

REFERENCES = {"velocity_verlet": physics.velocity_verlet, "taylor2": physics.taylor2}


def decimals(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers between two limits that print shortly."""
    return st.integers(0, 1000).map(lambda k: low + (high - low) * k / 1000)


def vectors(size: float) -> st.SearchStrategy[list[float]]:
    """Pairs of numbers up to `size`, often 0."""
    numbers = st.one_of(st.just(0.0), decimals(-size, size))
    return st.lists(numbers, min_size=2, max_size=2)


@st.composite
def particles(draw: Callable[..., Any], count: int) -> list[Document]:
    """Particles apart from each other, some constrained, loaded and moving."""
    cells = draw(
        st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=count, max_size=count, unique=True)
    )
    made = []
    for index, (x, y) in enumerate(cells):
        fixed = draw(st.sampled_from([(False, False), (False, False), (False, True), (True, True)]))
        velocity = draw(vectors(3.0))
        made.append(
            particle(
                f"p{index}",
                x + draw(decimals(-0.3, 0.3)),
                y + draw(decimals(-0.3, 0.3)),
                fixed=list(fixed),
                velocity=[0.0 if held else v for v, held in zip(velocity, fixed, strict=True)],
                displacement=draw(vectors(0.001)),
                force=draw(vectors(20.0)),
                acceleration=draw(vectors(30.0)),
                mass=draw(st.one_of(st.none(), decimals(0.5, 40.0))),
            )
        )
    return made


@st.composite
def trusses(draw: Callable[..., Any], *, full: bool, damped: bool) -> Document:
    """Small trusses; `full`: with drag, a ramp and strengths; `damped`: with dampers in some rods."""
    nodes = draw(particles(draw(st.integers(2, 5))))
    pairs = list(itertools.combinations(range(len(nodes)), 2))
    chosen = draw(st.lists(st.sampled_from(pairs), min_size=1, max_size=6, unique=True))
    rods = [draw(_rods(nodes, pair, full=full, damped=damped)) for pair in chosen]
    sections: dict[str, Any] = {
        "environment": {"force": draw(vectors(1.0)), "acceleration": draw(vectors(10.0))}
    }
    if damped:
        rods[0]["damping"] = draw(decimals(0.01, 2.0))  # so that the plan is the same for all examples
    if full:
        rods[0]["tensile_strength"] = rods[0]["stiffness"] * draw(decimals(0.002, 0.02))
        sections["environment"]["drag"] = draw(decimals(0.1, 20.0))
        sections["loads"] = [draw(_ramps(nodes)) for _ in range(draw(st.integers(1, 3)))]
    return model(nodes, rods, **sections)


@st.composite
def _rods(
    draw: Callable[..., Any], nodes: list[Document], pair: tuple[int, int], *, full: bool, damped: bool
) -> Document:
    start, end = (nodes[index] for index in pair)
    stiffness = 10.0 ** draw(decimals(2.0, 5.0))
    made = {
        "name": f"{start['name']}{end['name']}",
        "between": [start["name"], end["name"]],
        "stiffness": stiffness,
        "damping": draw(st.one_of(st.just(0.0), decimals(0.0, 2.0))) if damped else 0.0,
        "density": draw(decimals(0.5, 20.0)),
    }
    if full and draw(st.booleans()):
        for side in ("tensile_strength", "compressive_strength"):
            made[side] = draw(
                st.one_of(st.none(), st.just(0.0), decimals(0.002, 0.02).map(lambda e: e * stiffness))
            )
    elif draw(st.booleans()):
        length = math.dist(start["position"], end["position"])
        made["rest_length"] = length * draw(decimals(0.99, 1.01))
    return made


@st.composite
def _ramps(draw: Callable[..., Any], nodes: list[Document]) -> Document:
    history = {"kind": "ramp", "start": draw(decimals(0.0, 0.01)), "duration": draw(decimals(0.0, 0.02))}
    return {"on": draw(st.sampled_from(nodes))["name"], "force": draw(vectors(50.0)), "history": history}


@st.composite
def flights(draw: Callable[..., Any]) -> Document:
    """Particles without rods."""
    bodies = draw(particles(draw(st.integers(1, 4))))
    return model(bodies, [], environment={"force": draw(vectors(1.0)), "acceleration": draw(vectors(10.0))})


SHARES = decimals(0.02, 0.5)  # of the stable step


@pytest.mark.parametrize(
    ("full", "damped", "integrator", "part"),
    [
        (True, True, "velocity_verlet", 1.0),
        (True, True, "taylor2", 0.1),
        (False, True, "velocity_verlet", 1.0),
        (False, False, "velocity_verlet", 1.0),
    ],
    ids=["yielding, damped, loaded", "the same by the thesis scheme", "damped", "undamped"],
)
@settings(max_examples=15)
@given(st.data(), SHARES)
def test_trusses(
    full: bool, damped: bool, integrator: str, part: float, data: st.DataObject, share: float
) -> None:
    assert_agreement(data.draw(trusses(full=full, damped=damped)), integrator, part * share)


@settings(max_examples=20)
@given(flights())
def test_particles_without_rods(document: Document) -> None:
    assert_agreement(document, "velocity_verlet", 1.0)


def assert_agreement(document: Document, integrator: str, share: float) -> None:
    """Run both with the same step and compare all that they know."""
    size = _step(document, share)
    choices = {"integrator": integrator, "time_step": size, "collisions": False}
    document = document | {"settings": choices}
    session = Session.open(document)
    status = session.run(steps=STEPS)
    if status == "diverged":  # so large a deformation that the step was too long: the reference must agree
        creation = Creation()
        REFERENCES[integrator](document, size, STEPS, creation)
        assert creation.share > 0.1
        return
    steps = session.model.clock.steps
    assert (status, steps) == ("time reached", STEPS) or status == "at rest"
    largest = Largest()
    expected = REFERENCES[integrator](document, size, steps, largest)
    assume(largest.shortest > SHORTEST)
    assert session.time == pytest.approx(expected["time"], rel=1e-15)
    stiffest = max((rod["stiffness"] for rod in document["rods"]), default=0.0)
    largest.values["axial_force"] += ROUNDING / AGREEMENT * stiffest
    of_particles, of_rods = ("displacement", "velocity", "reaction"), ("axial_force", "plastic_strain")
    for table, quantities in ((session.particles, of_particles), (session.rods, of_rods)):
        for quantity in quantities:
            found = dict(zip(table.names, table.column(quantity).tolist(), strict=True))
            assert_same(quantity, found, expected[quantity], largest.values[quantity])
    assert_same_energy(session, expected["energy"], largest.values["energy"])


class Creation:
    """Notes how much energy came from nowhere at worst, as a share of all that was supplied until then."""

    def __init__(self) -> None:
        self.share = self.supplied = 0.0

    def __call__(self, simulation: physics.Simulation) -> None:
        energy = simulation.energy()
        self.supplied = max(self.supplied, energy["initial"], abs(energy["work"]))
        share = -energy["imbalance"] / self.supplied
        self.share = share if not share < self.share else self.share  # not a number counts too


class Largest:
    """Notes the largest value of every quantity in a reference run, and the shortest length of a rod."""

    def __init__(self) -> None:
        self.values: dict[str, float] = defaultdict(float)
        self.shortest = math.inf

    def __call__(self, simulation: physics.Simulation) -> None:
        forces = simulation.forces
        for rod in simulation.elements.rods:
            self.shortest = min(self.shortest, rod.rest_length + simulation.elongation(rod, simulation.u))
        for quantity, values in {
            "displacement": simulation.u,
            "velocity": simulation.v,
            "reaction": forces.reaction,
            "axial_force": forces.axial_force,
            "plastic_strain": simulation.plastic_strain,
            "energy": list(simulation.energy().values()),
        }.items():
            now = float(np.abs(values).max(initial=0.0))
            self.values[quantity] = max(self.values[quantity], now)


def _step(document: Document, share: float) -> float:
    """A share of the stable step of Verlet in the initial state.

    Without supports, whose directions would hide the stiffness of rods that turn during the run.
    """
    free = [body | {"fixed": [False, False]} for body in document["particles"]]
    session = Session.open(document | {"particles": free, "settings": {"integrator": "velocity_verlet"}})
    session.simulation.advance(0)
    limit = session.simulation.step_size.stable
    return share * limit if math.isfinite(limit) else 1e-3 * share


def assert_same(quantity: str, found: dict[str, Any], expected: dict[str, Any], scale: float) -> None:
    assert found.keys() == expected.keys()
    for name, value in found.items():
        for one, other in zip(_numbers(value), _numbers(expected[name]), strict=True):
            close = abs(one - other) <= AGREEMENT * scale + NOTHING
            assert close, (quantity, name, value, expected[name])


def _numbers(value: Any) -> Iterable[float]:
    return value if isinstance(value, list | tuple) else (value,)


def assert_same_energy(session: Session, expected: dict[str, float], scale: float) -> None:
    found = session.energy.as_dict()
    expected = expected | {
        "dissipated_damping": expected["dissipated_damping"] + expected.pop("dissipated_drag")
    }
    for name, value in expected.items():
        assert abs(found[name] - value) <= AGREEMENT * scale, (name, found[name], value)
