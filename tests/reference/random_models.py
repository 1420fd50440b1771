"""Models drawn by lot: each number is one model, of a kind whose features are always the same.

A kind fixes which parts of the program take part, and with them what is compiled; all else differs from number to
number: geometry, stiffness over decades, supports, loads, histories, initial states.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np

from tests.reference.elements import Document, Model, read
from tests.reference.models import model, particle

Lot = np.random.Generator
HISTORIES = ("ramp", "sine", "pulse", "table", "record")
MEETS_NONE = 1e-3  # m, a radius


@dataclass(frozen=True)
class Kind:
    """What the models of a kind have. sizes: particles of a structure, from and to."""

    title: str
    moves: bool = True
    rests: bool = False  # followed until it is at rest
    # truss: stiff; graph: anything; chain: hanging; lattice: hundreds of rods; discs; on a truss
    shape: str = "truss"
    sizes: tuple[int, int] = (3, 8)
    islands: int = 1
    histories: tuple[str, ...] = ()
    damped: float = 0.0  # damping coefficients up to this share of what is critical
    drag: bool = False
    cables: bool = False
    yields: bool = False
    prestrained: bool = False  # misfit, temperature, moved supports, plastic strain
    stiffness: tuple[float, float] = (1e3, 1e5)  # kN
    factors: tuple[float, ...] = (1.0,)
    turns: tuple[float, float] = (3.0, 100.0)  # radians of the fastest vibration that a motion is followed for


ALL = Kind(
    "everything, in motion",
    histories=HISTORIES,
    damped=1.0,
    drag=True,
    cables=True,
    yields=True,
    prestrained=True,
)
KINDS = (
    Kind("elastic, undamped"),
    Kind("elastic, any graph", shape="graph"),
    Kind("hanging chains", shape="chain", stiffness=(10.0, 1e3), turns=(50.0, 1000.0)),
    Kind("damped, dragged", damped=2.0, drag=True),
    Kind("loads of every history", histories=HISTORIES, damped=0.5),
    Kind("lack of fit, warmth, moved supports", prestrained=True, shape="graph"),
    Kind("cables", cables=True, shape="graph"),
    Kind("cables with dampers", cables=True, damped=1.0, shape="graph"),
    Kind("yielding", yields=True),
    Kind("yielding, damped, under ramps", yields=True, damped=1.0, drag=True, histories=("ramp",)),
    Kind("stiff", damped=400.0, drag=True, turns=(0.5, 8.0)),
    Kind("islands and free particles", islands=3, damped=0.5, sizes=(3, 5)),
    ALL,
    replace(ALL, title="everything, islands", islands=3, sizes=(3, 5), shape="graph"),
    Kind("free discs that collide", shape="discs", sizes=(3, 9)),
    Kind("discs on trusses", shape="on a truss", sizes=(3, 6), damped=0.5, stiffness=(1e2, 1e4)),
    Kind("lattices of 220 to 400 rods", shape="lattice", turns=(10.0, 60.0)),
    Kind(
        "until at rest",
        rests=True,
        islands=3,
        sizes=(3, 5),
        damped=2.0,
        drag=True,
        cables=True,
        yields=True,
        histories=("ramp",),
    ),
    Kind("equilibrium: elastic", moves=False),
    Kind("equilibrium: elastic, prestrained", moves=False, prestrained=True),
    Kind("equilibrium: hanging chains", moves=False, shape="chain"),
    Kind("equilibrium: cables", moves=False, cables=True, sizes=(4, 8), prestrained=True),
    Kind("equilibrium: yielding", moves=False, yields=True),
    Kind("equilibrium: yielding, back and forth", moves=False, yields=True, factors=(0.8, -0.7, 0.3, 0.0)),
    Kind("equilibrium: everything", moves=False, yields=True, cables=True, prestrained=True, sizes=(4, 8)),
    Kind("equilibrium: any graph", moves=False, shape="graph"),
)


@dataclass(frozen=True)
class Case:
    """One model, and for how long (s) to follow its motion or which load factors to settle at."""

    number: int
    kind: Kind
    document: Model
    duration: float


def case(number: int) -> Case:
    """The model of a number; its kind is KINDS[number % len(KINDS)]."""
    kind = KINDS[number % len(KINDS)]
    lot = np.random.default_rng([20, number])
    document = SHAPES[kind.shape](lot, kind)
    return Case(number, kind, document, _duration(lot, kind, document))


def numbers_of(title: str, count: int) -> list[int]:
    """The first so many numbers of the models of a kind."""
    row = next(row for row, kind in enumerate(KINDS) if kind.title == title)
    return [row + len(KINDS) * turn for turn in range(count)]


def drawn(title: str, turn: int) -> Case:
    """One of the models of a kind."""
    return case(numbers_of(title, turn + 1)[turn])


# --- structures ------------------------------------------------------------------------------------------


def _structure(lot: Lot, kind: Kind) -> Model:
    """One or more trusses, or graphs, side by side, perhaps with free particles between them."""
    nodes: list[Document] = []
    rods: list[Document] = []
    for island in range(kind.islands):
        places, pairs = _truss(lot, kind) if kind.shape == "truss" else _graph(lot, kind)
        names = [f"{'abc'[island]}{k}" for k in range(len(places))]
        made = _nodes(lot, kind, names, np.add(places, (20.0 * island, 0.0)))
        if kind.shape == "truss":
            made[0]["fixed"], made[1]["fixed"] = [True, True], [False, True]
        for each in made:
            _initial_state(lot, kind, each)
        nodes += made
        rods += [_rod(lot, kind, made[i], made[j]) for i, j in pairs]
    if kind.islands > 1 and not kind.rests:
        free = [particle(f"free{k}", 5.0 * k, 30.0, velocity=[1.0, 0.5 * k], radius=0.2) for k in range(2)]
        nodes += free
    return _finished(lot, kind, nodes, rods)


def _truss(lot: Lot, kind: Kind) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Every node after two supports is tied to two others at an angle; some more rods make it redundant."""
    count = int(lot.integers(kind.sizes[0], kind.sizes[1] + 1))
    points = [np.zeros(2), np.array([2.0, 0.0])]
    pairs = [(0, 1)]
    while len(points) < count:
        first, second = sorted(lot.choice(len(points), 2, replace=False).tolist())
        point = lot.uniform(-3.0, 5.0, 2)
        one, other = points[first] - point, points[second] - point
        sine = abs(one[0] * other[1] - one[1] * other[0]) / (np.hypot(*one) * np.hypot(*other))
        if sine > 0.3 and min(math.dist(point, each) for each in points) > 0.7:
            pairs += [(first, len(points)), (second, len(points))]
            points.append(point)
    others = [pair for pair in combinations(range(count), 2) if pair not in pairs]
    chosen = lot.permutation(len(others))[: int(lot.integers(0, 4))].tolist()
    return np.array(points), pairs + [others[k] for k in chosen]


def _graph(lot: Lot, kind: Kind) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Particles in different cells of a grid, some joined: a structure, a mechanism, or both."""
    count = int(lot.integers(max(kind.sizes[0], 2), kind.sizes[1] + 1))
    cells = lot.permutation(16)[:count]
    places = np.stack([cells % 4, cells // 4], axis=1) + lot.uniform(-0.3, 0.3, (count, 2))
    pairs = list(combinations(range(count), 2))
    number = int(lot.integers(1, 2 * count))
    return places, [pairs[k] for k in sorted(lot.permutation(len(pairs))[:number].tolist())]


def _chain(lot: Lot, kind: Kind) -> Model:
    """Rods in a row that hang, loosely or tightly, between two supports or from one."""
    count = int(lot.integers(3, 9))
    span = lot.uniform(0.3, 1.05)
    along = np.linspace(0.0, 1.0, count)
    places = np.stack([count * span * along, -count * (1.0 - span) * along * (1.0 - along)], axis=1)
    places[1:-1] += lot.uniform(-0.15, 0.15, (count - 2, 2))
    nodes = _nodes(lot, kind, [f"a{k}" for k in range(count)], places)
    for node in nodes:
        node |= {"fixed": [False, False], "velocity": [0.0, 0.0], "force": [0.0, 0.0]}
    nodes[0]["fixed"] = [True, True]
    nodes[-1]["fixed"] = [bool(kind.moves is False or lot.random() < 0.7)] * 2
    rods = [_rod(lot, kind, one, other) for one, other in pairwise(nodes)]
    made = _finished(lot, kind, nodes, rods)
    made["environment"]["acceleration"] = [0.0, -9.81]
    return made


def _lattice(lot: Lot, kind: Kind) -> Model:
    """A jittered net of squares with diagonals, held at its lower edge, under sudden loads."""
    wide, high = int(lot.integers(8, 12)), int(lot.integers(7, 10))
    row = {(x, y): x + wide * y for y in range(high) for x in range(wide)}
    places = np.array([(x, y) for x, y in row], dtype=float) + lot.uniform(-0.2, 0.2, (len(row), 2))
    nodes = _nodes(lot, kind, [f"n{k}" for k in range(len(row))], places)
    for number, node in enumerate(nodes):
        node |= {"fixed": [number < wide] * 2, "velocity": [0.0, 0.0]}
    ways = [(1, 0), (0, 1), (1, 1), (-1, 1)]
    pairs = [(row[p], row[q]) for p in row for dx, dy in ways if (q := (p[0] + dx, p[1] + dy)) in row]
    rods = [_rod(lot, kind, nodes[i], nodes[j]) for i, j in pairs if lot.random() < 0.95]
    return _finished(lot, kind, nodes, rods)


def _nodes(lot: Lot, kind: Kind, names: list[str], places: np.ndarray) -> list[Document]:
    made = []
    for name, place in zip(names, places.tolist(), strict=True):
        fixed = ((False, False), (False, False), (False, True), (True, False), (True, True))[lot.integers(5)]
        node = particle(name, *place, fixed=list(fixed), radius=MEETS_NONE)
        if kind.shape in ("truss", "on a truss"):
            node["fixed"] = [False, False]
        if lot.random() < 0.7:
            node["force"] = _vector(lot, 50.0)
        if lot.random() < 0.3:
            node["acceleration"] = _vector(lot, 30.0)
        if lot.random() < 0.7:
            node["mass"] = float(10.0 ** lot.uniform(-0.5, 1.7))
        made.append(node)
    return made


def _initial_state(lot: Lot, kind: Kind, node: Document) -> None:
    """Velocities of particles that can move, displacements of some; of held ones, settlements."""
    fixed = node["fixed"]
    if kind.moves and lot.random() < 0.5:
        velocity = _vector(lot, 3.0)
        node["velocity"] = [0.0 if held else v for held, v in zip(fixed, velocity, strict=True)]
    if kind.prestrained and any(fixed) and lot.random() < 0.5:
        moved = _vector(lot, 0.005)
        node["displacement"] = [d if held else 0.0 for held, d in zip(fixed, moved, strict=True)]
    elif kind.moves and lot.random() < 0.3:
        node["displacement"] = _vector(lot, 0.001)


def _rod(lot: Lot, kind: Kind, one: Document, other: Document) -> Document:
    stiffness = float(np.exp(lot.uniform(*np.log(kind.stiffness))))
    length = math.dist(one["position"], other["position"])
    made: Document = {
        "name": one["name"] + other["name"],
        "between": [one["name"], other["name"]],
        "stiffness": stiffness,
        "density": float(lot.uniform(0.5, 20.0)),
        "damping": 0.0,
    }
    if kind.damped and lot.random() < 0.8:
        mass = made["density"] * length + 1.0
        critical = 2.0 * math.sqrt(stiffness / length * mass / 1000.0)
        made["damping"] = float(kind.damped * critical * lot.random() ** 2)
    if kind.cables and lot.random() < 0.5:
        made["tension_only"] = True
    if kind.yields and lot.random() < 0.7:
        for side in ("tensile_strength", "compressive_strength"):
            if lot.random() < 0.8:
                made[side] = _strength(lot, kind, stiffness)
    if kind.prestrained:
        if lot.random() < 0.4:
            made["rest_length"] = length * float(lot.uniform(0.998, 1.002))
        if lot.random() < 0.4:
            made["temperature_change"] = float(lot.uniform(-60.0, 60.0))
            made["thermal_expansion"] = float(lot.uniform(5e-6, 3e-5))
        if lot.random() < 0.3:
            made["plastic_strain"] = float(lot.uniform(-1e-3, 1e-3))
    return made


def _strength(lot: Lot, kind: Kind, stiffness: float) -> float:
    """In motion a share of the stiffness, as speeds are alike; in equilibrium some of the load."""
    return float(stiffness * lot.uniform(0.001, 0.01) if kind.moves else lot.uniform(40.0, 250.0))


def _finished(lot: Lot, kind: Kind, nodes: list[Document], rods: list[Document]) -> Model:
    """The document, so that every feature of its kind is there."""
    if kind.damped and not any(rod["damping"] for rod in rods):
        rods[0]["damping"] = 0.1 * kind.damped
    if kind.cables and not any(rod.get("tension_only") for rod in rods):
        rods[-1]["tension_only"] = True
    if kind.yields and not any(rod.get("tensile_strength") for rod in rods):
        rods[0]["tensile_strength"] = _strength(lot, kind, rods[0]["stiffness"])
    if kind.prestrained and not any(rod.get("plastic_strain") for rod in rods):
        rods[-1]["plastic_strain"] = 1e-4
    environment = {"acceleration": _vector(lot, 10.0), "force": _vector(lot, 1.0)}
    if kind.drag:
        environment["drag"] = float(lot.uniform(0.1, 20.0))
    made = model(nodes, rods, environment=environment, settings={"restitution": 1.0})
    if kind.histories:
        movable = [node["name"] for node in nodes if not all(node.get("fixed", (False, False)))]
        made["loads"] = [
            {"name": h, "on": str(lot.choice(movable or [nodes[0]["name"]])), "force": _vector(lot, 50.0)}
            for h in kind.histories
        ]
        end = _span_of_time(lot, kind, made)
        for load in made["loads"]:
            load["history"] = _history(lot, load["name"], end)
    return made


def _history(lot: Lot, kind: str, end: float) -> Document:
    """A history of which something happens within a time."""
    if kind == "sine":
        return {
            "kind": kind,
            "frequency": float(lot.uniform(0.3, 6.0) / end),
            "phase": float(lot.uniform(0, 6.0)),
        }
    if kind in ("ramp", "pulse"):
        start, duration = lot.uniform(0.0, 0.6, 2) * end
        return {"kind": kind, "start": float(start), "duration": float(duration)}
    times = np.sort(lot.uniform(0.0, 1.2 * end, int(lot.integers(2, 6))))
    values = {"table": "factors", "record": "accelerations"}[kind]
    return {"kind": kind, "times": times.tolist(), values: lot.uniform(-1.0, 1.0, len(times)).tolist()}


# --- discs -----------------------------------------------------------------------------------------------


def _discs(lot: Lot, kind: Kind) -> Model:
    """Free discs that come from all sides, with and without a common acceleration, and walls."""
    count = int(lot.integers(*kind.sizes))
    places = _apart(lot, count, 0.35)
    discs = [
        particle(
            f"d{k}",
            *place.tolist(),
            radius=float(lot.uniform(0.05, 0.15)),
            mass=float(10.0 ** lot.uniform(-1.0, 1.0)),
            velocity=(-place + lot.uniform(-1.0, 1.0, 2)).tolist(),
            acceleration=_vector(lot, 1.0) if lot.random() < 0.3 else [0.0, 0.0],
        )
        for k, place in enumerate(places)
    ]
    made = model(discs, [], settings={"restitution": float(lot.choice([1.0, 0.8, 0.5]))})
    made["environment"] = {"acceleration": [0.0, -1.0] if lot.random() < 0.5 else [0.0, 0.0]}
    if lot.random() < 0.5:
        floor = {"name": "floor", "start": [-3.0, -2.5], "end": [3.0, float(lot.uniform(-2.6, -2.4))]}
        made["components"] = {"walls.Wall": [floor | {"restitution": float(lot.choice([1.0, 0.7]))}]}
    return made


def _on_a_truss(lot: Lot, kind: Kind) -> Model:
    """Discs thrown at the nodes of a truss."""
    places, pairs = _truss(lot, kind)
    nodes = _nodes(lot, kind, [f"a{k}" for k in range(len(places))], places)
    nodes[0]["fixed"], nodes[1]["fixed"] = [True, True], [False, True]
    for node in nodes:
        node |= {"radius": float(lot.uniform(0.05, 0.2))}
    rods = [_rod(lot, kind, nodes[i], nodes[j]) for i, j in pairs]
    for k in range(int(lot.integers(1, 4))):
        target = places[lot.integers(len(places))]
        angle = lot.uniform(0.0, 2.0 * math.pi)
        from_there = np.array([math.cos(angle), math.sin(angle)])
        place = target + from_there * lot.uniform(0.4, 0.45)
        speed = -from_there * lot.uniform(15.0, 60.0) + lot.uniform(-1.0, 1.0, 2)
        if min(math.dist(place, node["position"]) for node in nodes) > 0.35:
            mass = float(10.0 ** lot.uniform(-1.0, 1.0))
            nodes.append(
                particle(f"d{k}", *place.tolist(), velocity=speed.tolist(), radius=0.03 + 0.01 * k, mass=mass)
            )
    made = _finished(lot, kind, nodes, rods)
    made["settings"]["restitution"] = float(lot.choice([1.0, 0.8, 0.5]))
    return made


def _apart(lot: Lot, count: int, distance: float) -> np.ndarray:
    places: list[np.ndarray] = []
    while len(places) < count:
        place = lot.uniform(-2.0, 2.0, 2)
        if all(math.dist(place, other) > distance for other in places):
            places.append(place)
    return np.array(places)


def _vector(lot: Lot, size: float) -> list[float]:
    """Up to `size` in each direction, now and then 0."""
    return [float(v) if lot.random() < 0.9 else 0.0 for v in lot.uniform(-size, size, 2)]


SHAPES: dict[str, Callable[[Lot, Kind], Model]] = {
    "truss": _structure,
    "graph": _structure,
    "chain": _chain,
    "lattice": _lattice,
    "discs": _discs,
    "on a truss": _on_a_truss,
}


# --- time ------------------------------------------------------------------------------------------------


def _duration(lot: Lot, kind: Kind, document: Model) -> float:
    """How long to follow a motion (s)."""
    if not kind.moves:
        return 0.0
    if kind.shape == "discs":
        return float(lot.uniform(0.5, 4.0))
    if "duration" in document:
        return float(document.pop("duration"))
    return _span_of_time(lot, kind, document, keep=False)


def _span_of_time(lot: Lot, kind: Kind, document: Model, *, keep: bool = True) -> float:
    """Some radians of the fastest vibration (s); kept in the document until its duration is asked for."""
    if not kind.moves:
        return 1.0
    turns = math.exp(lot.uniform(*np.log(kind.turns)))
    span = float(turns / fastest(document))
    if kind.shape == "on a truss":
        span = max(span, 0.03)
    if keep:
        document["duration"] = span
    return span


def fastest(document: Model) -> float:
    """The highest angular frequency (rad/s) of a model as it was drawn; at least 1."""
    elements = read({key: value for key, value in document.items() if key not in ("loads", "duration")})
    count = 2 * len(elements.particles)
    stiffness = np.zeros((count, count))
    for rod in elements.rods:
        along = np.array(rod.span) / math.hypot(*rod.span)
        pattern = np.zeros(count)
        pattern[2 * rod.start : 2 * rod.start + 2] = -along
        pattern[2 * rod.end : 2 * rod.end + 2] = along
        stiffness += rod.stiffness / rod.rest_length * np.outer(pattern, pattern)
    free = ~np.array([p.fixed for p in elements.particles]).ravel()
    masses = np.repeat([p.mass for p in elements.particles], 2)[free]
    scaled = 1000.0 * stiffness[np.ix_(free, free)] / np.sqrt(np.outer(masses, masses))
    return math.sqrt(max(float(np.linalg.eigvalsh(scaled)[-1]), 1.0)) if len(masses) else 1.0
