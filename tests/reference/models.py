"""Small model dicts with known answers. Lengths in m, forces in kN, masses in kg."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from tests.reference.elements import Document, Model

Pair = tuple[float, float]

CLAMPED: Document = {"fixed": [True, True], "fixed_rotation": True}
PINNED: Document = {"fixed": [True, True]}


def model(particles: list[Document], rods: list[Document], **sections: Any) -> Model:
    """Return a model dict of these particles and rods; further sections by keyword."""
    return {"format": "pinjoint model", "version": 1, "particles": particles, "rods": rods} | sections


def particle(name: str, x: float, y: float, **properties: Any) -> Document:
    """Return a particle at the original position (x, y)."""
    return {"name": name, "position": [x, y]} | properties


def rod(start: str, end: str, **properties: Any) -> Document:
    """Return a rod that is named by its two ends."""
    return {"name": start + end, "between": [start, end]} | properties


def line(places: Iterable[Pair], first: Document, last: Document, **properties: Any) -> Model:
    """Return particles P0, P1, … at these places, the first and the last with more facts, on rods R0, R1, … in a row."""
    particles = [particle(f"P{i}", *place) for i, place in enumerate(places)]
    particles[0] |= first
    particles[-1] |= last
    rods = [rod(f"P{i}", f"P{i + 1}", name=f"R{i}", **properties) for i in range(len(particles) - 1)]
    return model(particles, rods)


def triangle(force: Pair = (120, -160), **properties: Any) -> Model:
    """Return the thesis' isostatic triangle: roller A, loaded B, pinned C; rods take `properties`."""
    return model(
        [
            particle("A", 0, 0, fixed=[False, True]),
            particle("B", 1, 1, force=list(force)),
            particle("C", 2, 0, fixed=[True, True]),
        ],
        [rod(start, end, **properties) for start, end in ("AB", "BC", "CA")],
    )


def square(force: Pair = (0, -100), **properties: Any) -> Model:
    """Return the thesis' hyperstatic square with both diagonals: roller A, loaded C, pinned D."""
    return model(
        [
            particle("A", 0, 0, fixed=[False, True]),
            particle("B", 0, 1.5),
            particle("C", 1.5, 1.5, force=list(force)),
            particle("D", 1.5, 0, fixed=[True, True]),
        ],
        [rod(start, end, **properties) for start, end in ("AB", "BC", "CD", "DA", "AC", "BD")],
    )


def oscillator(
    omega: float, zeta: float = 0.0, mass: float = 2.0, force: float = 0.0, **properties: Any
) -> Model:
    """Return one mass on one rod of length 1 along x: exactly linear, u'' + 2ζω u' + ω² u = F/m.

    The mass is particle B, its displacement is along x; `properties` go to it.
    """
    stiffness = mass * omega**2 / 1000
    damping = 2 * zeta * mass * omega / 1000
    return model(
        [
            particle("A", 0, 0, fixed=[True, True]),
            particle("B", 1, 0, fixed=[False, True], mass=mass, force=[force, 0], **properties),
        ],
        [rod("A", "B", stiffness=stiffness, damping=damping)],
    )


def chain(count: int, stiffness: float, mass: float) -> Model:
    """Return `count` masses in a row between fixed ends, on rods of length 1 with k = `stiffness` [N/m]."""
    ends = (0, count + 1)
    particles = [particle(f"p{i}", i, 0, fixed=[i in ends, True], mass=mass) for i in range(count + 2)]
    rods = [rod(f"p{i}", f"p{i + 1}", stiffness=stiffness / 1000, damping=0) for i in range(count + 1)]
    return model(particles, rods)


def pendulum(
    amplitude: float, length: float = 1.0, gravity: float = 9.81, mass: float = 1.0, stiffness: float = 200.0
) -> Model:
    """Return a mass on a stiff rod, released `amplitude` [rad] from the vertical below the pivot."""
    bob = (length * math.sin(amplitude), -length * math.cos(amplitude))
    return model(
        [particle("O", 0, 0, fixed=[True, True]), particle("P", *bob, mass=mass)],
        [rod("O", "P", stiffness=stiffness, damping=0)],
        environment={"acceleration": [0, -gravity]},
    )


def von_mises_truss(
    height: float = 1.0,
    half_span: float = 5.0,
    stiffness: float = 1.28e6,
    force: float = -1.0,
    guided: bool = True,
    **properties: Any,
) -> Model:
    """Return two rods from fixed supports to a crown B, loaded by `force` [kN] in y; guided in y or free."""
    return model(
        [
            particle("A", -half_span, 0, fixed=[True, True]),
            particle("B", 0, height, fixed=[guided, False], force=[0, force]),
            particle("C", half_span, 0, fixed=[True, True]),
        ],
        [rod("A", "B", stiffness=stiffness, **properties), rod("B", "C", stiffness=stiffness, **properties)],
    )


def three_bar_truss(force: float, strength: float, stiffness: float = 1000.0) -> Model:
    """Return a vertical bar of length 1 and two at 45° hung from fixed points, `force` [kN] down at P."""
    properties = {"stiffness": stiffness, "tensile_strength": strength, "compressive_strength": strength}
    return model(
        [
            particle("L", -1, 1, fixed=[True, True]),
            particle("M", 0, 1, fixed=[True, True]),
            particle("R", 1, 1, fixed=[True, True]),
            particle("P", 0, 0, force=[0, -force]),
        ],
        [rod(support, "P", **properties) for support in "LMR"],
    )


def panel_truss(force: float = -10.0) -> Model:
    """Return four panels of 2 m, height 2 m: pin L1, rollers L3 and L5, `force` [kN] in y at L2.

    Redundant by one; diagonals L1-U2, U2-L3, L3-U4, U4-L5.
    """
    lower = [particle(f"L{i}", 2 * i - 2, 0) for i in range(1, 6)]
    upper = [particle(f"U{i}", 2 * i - 2, 2) for i in range(2, 5)]
    lower[0]["fixed"] = [True, True]
    lower[2]["fixed"] = lower[4]["fixed"] = [False, True]
    lower[1]["force"] = [0, force]
    chords = [("L1", "L2"), ("L2", "L3"), ("L3", "L4"), ("L4", "L5"), ("U2", "U3"), ("U3", "U4")]
    posts = [("L2", "U2"), ("L3", "U3"), ("L4", "U4")]
    diagonals = [("L1", "U2"), ("U2", "L3"), ("L3", "U4"), ("U4", "L5")]
    return model(lower + upper, [rod(start, end) for start, end in chords + posts + diagonals])


def random_truss(seed: int, nodes: int = 6, redundant: int = 2, load: float = 100.0) -> Model:
    """Return a stable truss drawn by lot: every node after two supports is tied to two others at an angle.

    `redundant` more rods; stiffnesses over a decade, forces up to `load` [kN] on all nodes.
    """
    lot = np.random.default_rng(seed)
    points = [np.array([0.0, 0.0]), np.array([2.0, 0.0])]
    pairs = [(0, 1)]
    while len(points) < nodes:
        first, second = sorted(lot.choice(len(points), 2, replace=False).tolist())
        point = lot.uniform(-3.0, 5.0, 2)
        arms = points[first] - point, points[second] - point
        lengths = [math.hypot(*arm) for arm in arms]
        sine = abs(arms[0][0] * arms[1][1] - arms[0][1] * arms[1][0]) / math.prod(lengths)
        if sine > 0.3 and min(math.dist(point, other) for other in points) > 0.7:
            pairs += [(first, len(points)), (second, len(points))]
            points.append(point)
    others = [(i, j) for j in range(nodes) for i in range(j) if (i, j) not in pairs]
    pairs += [others[k] for k in lot.permutation(len(others))[:redundant].tolist()]
    names = [f"n{number}" for number in range(nodes)]
    forces = lot.uniform(-load, load, (nodes, 2)).tolist()
    particles = [
        particle(name, *point.tolist(), force=force)
        for name, point, force in zip(names, points, forces, strict=True)
    ]
    particles[0]["fixed"], particles[1]["fixed"] = [True, True], [False, True]
    stiffness = 10.0 ** lot.uniform(5.0, 6.0, len(pairs))
    return model(
        particles,
        [rod(names[i], names[j], stiffness=k) for (i, j), k in zip(pairs, stiffness.tolist(), strict=True)],
    )


def random_structure(seed: int) -> Model:
    """Return a structure of soft and weak rods and cables between nodes drawn by lot: stable, a mechanism, or neither.

    It moves far under its load, so that rods yield, unload, go slack, become straight and snap through.
    """
    lot = np.random.default_rng(seed)
    count = int(lot.integers(4, 9))
    points = lot.uniform(0.0, 5.0, (count, 2))
    while min(math.dist(points[i], points[j]) for i in range(count) for j in range(i)) < 0.6:
        points = lot.uniform(0.0, 5.0, (count, 2))
    pairs = [(i, j) for i in range(count) for j in range(i + 1, count)]
    lot.shuffle(pairs)
    pairs = sorted(map(tuple, pairs[: 2 * count - 3 + int(lot.integers(-2, 4))]))
    particles = [particle(f"n{row}", *point) for row, point in enumerate(points.tolist())]
    for each in particles:
        if lot.random() < 0.6:
            each["force"] = lot.uniform(-12.0, 12.0, 2).tolist()
    pinned, guided = lot.permutation(count)[:2].tolist()
    particles[pinned]["fixed"], particles[guided]["fixed"] = [True, True], [bool(lot.random() < 0.3), True]
    has_cables, rods = lot.random() < 0.4, []
    for i, j in pairs:
        each = rod(f"n{i}", f"n{j}", stiffness=float(np.exp(lot.uniform(np.log(200.0), np.log(7000.0)))))
        each["tension_only"] = bool(has_cables and lot.random() < 0.4)
        if lot.random() < 0.7:
            each["tensile_strength"], each["compressive_strength"] = lot.uniform(5.0, 60.0, 2).tolist()
        rods.append(each)
    return model(particles, rods, settings={"collisions": False})


def opensees_truss() -> Model:
    """Return the three-rod elastic truss of the OpenSees manual (inches and kips; E 3000, A 10, 5, 5)."""
    supports = [particle(str(i), x, 0, fixed=[True, True]) for i, x in enumerate((0, 144, 168), start=1)]
    return model(
        [*supports, particle("4", 72, 96, force=[100, -50])],
        [rod(str(i), "4", stiffness=3000 * area) for i, area in enumerate((10, 5, 5), start=1)],
    )


def two_discs(
    restitution: float, mass1: float = 1.0, mass2: float = 1.0, offset: float = 0.0, speed: float = 5.0
) -> Model:
    """Return two free discs of radius 0.05; 1 comes along x at `speed`, 2 rests, `offset` in y."""
    return model(
        [
            particle("1", -0.5, 0, velocity=[speed, 0], mass=mass1, radius=0.05),
            particle("2", 0, offset, mass=mass2, radius=0.05),
        ],
        [],
        settings={"restitution": restitution},
    )


def struck(integrator: str, *, bends: bool = True) -> Model:
    """Return a braced portal with a cable and a beam that yields, on which two balls fall while loads change.

    Its feet are clamped if its members bend. Steps end at impacts: they are tried, put back, and taken again.
    """
    more: Document = {"bending_stiffness": 5.0} if bends else {}
    members = [rod(start, end, stiffness=2000, damping=0.5, **more) for start, end in ("AB", "BC", "CD")]
    members[1] |= {"tensile_strength": 4.0, "compressive_strength": 4.0}
    braces = [rod("A", "C", stiffness=500, damping=0.2, tension_only=True)]
    braces += [] if bends else [rod("B", "D", stiffness=2000, damping=0.5)]
    feet: Document = {"fixed": [True, True], "fixed_rotation": bends}
    return model(
        [
            particle("A", 0, 0, **feet),
            particle("B", 0, 1),
            particle("C", 1, 1),
            particle("D", 1, 0, **feet),
            particle("ball", 0.02, 1.16, radius=0.1, mass=5, velocity=[0, -3]),
            particle("other", 0.1, 1.38, radius=0.1, mass=2, velocity=[0, -6]),
        ],
        members + braces,
        settings={"integrator": integrator},
        environment={"acceleration": [0, -9.81], "drag": 0.5},
        loads=[
            {"on": "C", "force": [20, 0], "history": {"kind": "ramp", "start": 0.002, "duration": 0.0}},
            {"on": "B", "force": [0, 1], "history": {"kind": "sine", "frequency": 30}},
        ],
    )


def portal_in_wind(integrator: str, **settings: Any) -> Model:
    """Return a portal frame at rest under the weight of its beam, until wind rises: faster than its rest let expect."""
    column = {"stiffness": 1_640_000, "bending_stiffness": 12_000, "density": 61.3, "damping": 6000}
    beam = {"stiffness": 1_130_000, "bending_stiffness": 18_000, "density": 2080, "damping": 3000}
    feet = {"fixed": [True, True], "fixed_rotation": True}
    sunk, turned = 0.000149325736, 0.003353410298
    return model(
        [
            particle("A", 0, 0, **feet),
            particle("B", 0, 4, displacement=[4.5364786e-05, -sunk], rotation=-turned),
            particle("C", 6, 4, displacement=[-4.5364786e-05, -sunk], rotation=turned),
            particle("D", 6, 0, **feet),
        ],
        [rod("A", "B", **column), rod("B", "C", **beam, distributed_force=[0, -20]), rod("C", "D", **column)],
        settings={"integrator": integrator} | settings,
        loads=[{"on": "B", "force": [35, 0], "history": {"kind": "ramp", "start": 0.01, "duration": 0.5}}],
    )
