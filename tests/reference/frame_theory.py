"""First-order theory of frames by the textbook: 6 × 6 matrices of members, hinges condensed, loads by fixed-end forces.

Written from textbooks, in local axes, with a hinge as a rotation of its own that is eliminated. Nothing is shared with
the program: neither its coordinates (elongation and slopes) nor its assembly. Signs of results are the program's.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.linalg import eigh

Document = dict[str, Any]
EXPANSION = 1.2e-5


@dataclass(frozen=True)
class Member:
    """One rod in local axes: forces on its ends = stiffness × displacements of them + fixed, each (x, y, θ) twice.

    springs: of ends that turn otherwise than their joints, by their places, with the stiffness between; 0 of hinges.
    """

    places: list[int]
    turned: np.ndarray
    stiffness: np.ndarray
    fixed: np.ndarray
    springs: dict[int, float]
    length: float
    longer: float | None = None  # of inextensible ones, which have no axial stiffness


def member(rod: Document, places: list[int], span: np.ndarray) -> Member:
    """The matrices of a rod as if it were rigid at both ends; those that are not are in `springs`."""
    length = float(np.hypot(*span))
    cosine, sine = span / length
    rest = rod.get("rest_length", length)
    firm = rod.get("inextensible", False)
    axial, bend = 0.0 if firm else rod["stiffness"] / rest, rod.get("bending_stiffness", 0.0) / rest
    shear, lever = 12.0 * bend / length**2, 6.0 * bend / length
    stiffness = np.array(
        [
            [axial, 0.0, 0.0, -axial, 0.0, 0.0],
            [0.0, shear, lever, 0.0, -shear, lever],
            [0.0, lever, 4.0 * bend, 0.0, -lever, 2.0 * bend],
            [-axial, 0.0, 0.0, axial, 0.0, 0.0],
            [0.0, -shear, -lever, 0.0, shear, -lever],
            [0.0, lever, 2.0 * bend, 0.0, -lever, 4.0 * bend],
        ]
    )
    rotation = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    turned = np.kron(np.eye(2), rotation)
    expansion = rod.get("thermal_expansion", EXPANSION)
    longer = rod.get("lack_of_fit", rest - length) + rest * expansion * rod.get("temperature_change", 0.0)
    curvature = -expansion * rod.get("temperature_gradient", 0.0)
    bent = rod.get("bending_stiffness", 0.0) * curvature
    fixed = np.array([axial * longer, 0.0, bent, -axial * longer, 0.0, -bent])
    own = rod.get("distributed_force", (0.0, 0.0))  # that changes linearly
    own = {"start_intensity": own, "end_intensity": np.add(own, rod.get("more_at_end", (0.0, 0.0)))}
    for load in (own, *rod.get("span_loads", ())):
        turn = np.eye(2) if load.get("direction") == "local" else rotation[:2, :2]
        fixed -= borne(load, turn, length, rest)
    bars = bend == 0.0
    hinged, given = rod.get("hinged", (False, False)), rod.get("end_springs", (0.0, 0.0))
    springs = {2 + 3 * end: given[end] * (not bars) for end in (0, 1) if hinged[end] or given[end] or bars}
    if bars:  # simple beams
        fixed[[1, 4]] += np.array([1.0, -1.0]) * (fixed[2] + fixed[5]) / -length
        fixed[[2, 5]] = 0.0
    return Member(places, turned, stiffness, fixed, springs, length, longer if firm else None)


def borne(load: Document, turn: np.ndarray, length: float, rest: float) -> np.ndarray:
    """What a load between clamped ends puts on these, in local axes: work on cubics, forces and couples in balance."""
    start = min(load.get("start", 0.0) / length, 1.0)
    end = max(min(load.get("end", length) / length, 1.0), start)
    points, weights = np.polynomial.legendre.leggauss(3)
    share = (points + 1.0) / 2.0
    first, last = (turn @ load.get(key, (0.0, 0.0)) for key in ("start_intensity", "end_intensity"))
    spread = (first + share[:, None] * (last - first)) * (weights * (end - start) / 2.0 * rest)[:, None]
    forces = np.vstack([turn @ load.get("force", (0.0, 0.0)), spread])
    x, (along, across) = np.array([start, *(start + share * (end - start))]), forces.T
    couple = np.array([load.get("moment", 0.0), 0.0, 0.0, 0.0])
    first_moment = (across * rest * x * (1 - x) ** 2 + couple * (1 - x) * (1 - 3 * x)).sum()
    last_moment = (-across * rest * x**2 * (1 - x) + couple * x * (3 * x - 2)).sum()
    right = across @ x + (couple.sum() - first_moment - last_moment) / length
    pulled = along @ x
    return np.array(
        [along.sum() - pulled, across.sum() - right, first_moment, pulled, right, last_moment], dtype=float
    )


def with_own_turns(of: Member) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and fixed-end forces with the ends' own rotations, after the six coordinates of the joints."""
    places = list(range(6))
    for number, end in enumerate(of.springs):
        places[end] = 6 + number
    size = 6 + len(of.springs)
    stiffness, fixed = np.zeros((size, size)), np.zeros(size)
    stiffness[np.ix_(places, places)], fixed[places] = of.stiffness, of.fixed
    for end, spring in of.springs.items():
        both = [end, places[end]]
        stiffness[np.ix_(both, both)] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return stiffness, fixed


def condensed(of: Member) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and fixed-end forces on the joints, without the ends' own rotations."""
    stiffness, fixed = with_own_turns(of)
    inner = stiffness[:6, 6:] @ np.linalg.pinv(stiffness[6:, 6:])
    return stiffness[:6, :6] - inner @ stiffness[6:, :6], fixed[:6] - inner @ fixed[6:]


@dataclass(frozen=True)
class Found:
    """By names: displacement, rotation, reaction, reaction_moment of particles; (start, end) of what rods have."""

    displacement: dict[str, np.ndarray]
    rotation: dict[str, float]
    reaction: dict[str, np.ndarray]
    reaction_moment: dict[str, float]
    end_axial_force: dict[str, np.ndarray]
    shear: dict[str, np.ndarray]
    bending_moment: dict[str, np.ndarray]
    end_rotation: dict[str, np.ndarray]


def assembled(document: Document) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, list[Member]]:
    """The stiffness of all coordinates, the loads on them, which are held, which turn nothing, and the members.

    Coordinates are along the axes of supports.
    """
    particles, rods = document["particles"], document["rods"]
    row = {particle["name"]: i for i, particle in enumerate(particles)}
    members = []
    for rod in rods:
        first, second = (row[name] for name in rod["between"])
        span = np.subtract(particles[second]["position"], particles[first]["position"])
        places = [*range(3 * first, 3 * first + 3), *range(3 * second, 3 * second + 3)]
        members.append(member(rod, places, span))
    size = 3 * len(particles)
    matrix, load = np.zeros((size, size)), np.zeros(size)
    for of in members:
        stiffness, fixed = condensed(of)
        matrix[np.ix_(of.places, of.places)] += of.turned.T @ stiffness @ of.turned
        load[of.places] -= of.turned.T @ fixed
    applied = np.array([[*p.get("force", (0.0, 0.0)), p.get("moment", 0.0)] for p in particles]).ravel()
    held = np.array(
        [[*p.get("fixed", (False, False)), p.get("fixed_rotation", False)] for p in particles]
    ).ravel()
    turn = axes_of(particles)
    matrix = turn @ matrix @ turn.T + np.diag(springs_of(particles))
    load, applied = turn @ load, turn @ applied
    rigid = {of.places[end] for of in members for end in (2, 5) if of.springs.get(end, 1.0)}
    still = np.array([i % 3 == 2 and i not in rigid for i in range(size)])
    return matrix, load + applied, held, still, members


def axes_of(particles: list[Document]) -> np.ndarray:
    """By which vectors of all coordinates become those along the axes of supports."""
    turn = np.eye(3 * len(particles))
    for place, facts in enumerate(particles):
        cosine, sine = np.cos(facts.get("support_angle", 0.0)), np.sin(facts.get("support_angle", 0.0))
        turn[3 * place : 3 * place + 2, 3 * place : 3 * place + 2] = [[cosine, sine], [-sine, cosine]]
    return turn


def springs_of(particles: list[Document]) -> np.ndarray:
    """The stiffness of elastic supports, of all coordinates."""
    springs = [[*p.get("support_springs", (0.0, 0.0)), p.get("rotation_spring", 0.0)] for p in particles]
    return np.array(springs, dtype=float).ravel()


def solve(document: Document) -> Found:
    """The answer of linear theory to a model's document, with settlements of supports and clamps."""
    particles, rods = document["particles"], document["rods"]
    matrix, load, held, still, members = assembled(document)
    free = ~held & ~still
    placed = [[*p.get("displacement", (0.0, 0.0)), p.get("rotation", 0.0)] for p in particles]
    turn = axes_of(particles)
    moved = np.where(held & ~still, turn @ np.array(placed).ravel(), 0.0)
    firm = [of for of in members if of.longer is not None]
    along = np.zeros((len(firm), len(load)))
    for row, of in zip(along, firm, strict=True):
        row[of.places] = of.turned[3] - of.turned[0]
    along = along @ turn.T
    bordered = np.block(
        [[matrix[np.ix_(free, free)], along[:, free].T], [along[:, free], np.eye(len(firm)) * 0.0]]
    )
    longer = np.array([of.longer for of in firm], dtype=float)
    right = np.concatenate([(load - matrix @ moved)[free], longer - along @ moved])
    solved = np.linalg.solve(bordered, right)
    moved[free], forces = np.split(solved, [int(free.sum())])
    load = load - forces @ along
    reaction = np.where(held, matrix @ moved - load, 0.0) - springs_of(particles) * moved
    reaction, moved = (turn.T @ reaction).reshape(-1, 3), turn.T @ moved
    names = [particle["name"] for particle in particles]
    of_rods = {rod["name"]: end_forces(of, moved) for rod, of in zip(rods, members, strict=True)}
    for of, force in zip(firm, forces, strict=True):
        of_rods[rods[members.index(of)]["name"]][0][[0, 3]] += [-force, force]
    return Found(
        displacement={name: moved.reshape(-1, 3)[i, :2] for i, name in enumerate(names)},
        rotation={name: float(moved[3 * i + 2]) for i, name in enumerate(names)},
        reaction={name: reaction[i, :2] for i, name in enumerate(names)},
        reaction_moment={name: float(reaction[i, 2]) for i, name in enumerate(names)},
        end_axial_force={name: forces[[0, 3]] * [-1.0, 1.0] for name, (forces, _) in of_rods.items()},
        shear={name: forces[[1, 4]] * [1.0, -1.0] for name, (forces, _) in of_rods.items()},
        bending_moment={name: forces[[2, 5]] * [-1.0, 1.0] for name, (forces, _) in of_rods.items()},
        end_rotation={name: turns for name, (_, turns) in of_rods.items()},
    )


def end_forces(of: Member, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces of the particles on the ends of a rod in its axes, (6,), and the rotations of its ends, (2,)."""
    local = of.turned @ moved[of.places]
    if of.stiffness[2, 2] > 0.0:
        stiffness, fixed = with_own_turns(of)
        pushed = fixed[6:] + stiffness[6:, :6] @ local
        local[list(of.springs)] = -np.linalg.solve(stiffness[6:, 6:], pushed)
    else:
        local[[2, 5]] = (local[4] - local[1]) / of.length
    return of.stiffness @ local + of.fixed, local[[2, 5]]


def natural_frequencies(document: Document, parts: int) -> np.ndarray:
    """ω² (rad²/s²), ascending, of a frame whose rods that bend are divided so, with consistent masses.

    An end with a hinge or spring has a rotation of its own. Bars have halves of their masses at their ends, in place of
    which a mass may be prescribed.
    """
    particles, rods = document["particles"], document["rods"]
    row = {particle["name"]: i for i, particle in enumerate(particles)}
    size = 3 * len(particles) + sum(3 * parts + 2 for _ in rods)
    stiffness, mass, used = np.zeros((size, size)), np.zeros((size, size)), 3 * len(particles)
    along: list[np.ndarray] = []
    for rod in rods:
        first, last = (row[name] for name in rod["between"])
        span = np.subtract(particles[last]["position"], particles[first]["position"])
        bends = rod.get("bending_stiffness", 0.0) > 0.0
        count = parts if bends else 1
        inner = [list(range(used + 3 * i, used + 3 * i + 3)) for i in range(count - 1)]
        used += 3 * (count - 1)
        chain = [list(range(3 * first, 3 * first + 3)), *inner, list(range(3 * last, 3 * last + 3))]
        for end in (0, -1):
            spring = rod.get("end_springs", (0.0, 0.0))[end]
            if bends and (spring or rod.get("hinged", (False, False))[end]):
                both = [chain[end][2], used]
                stiffness[np.ix_(both, both)] += spring * np.array([[1.0, -1.0], [-1.0, 1.0]])
                chain[end][2], used = used, used + 1
        for start, end in pairwise(chain):
            of = member(
                {k: v for k, v in rod.items() if k not in ("rest_length", "end_springs")},
                [*start, *end],
                span / count,
            )
            matrix = of.turned.T @ of.stiffness @ of.turned
            stiffness[np.ix_(of.places, of.places)] += matrix
            weight = rod.get("density", 6.15) * of.length / 1000.0
            if bends:
                local = weight * consistent(of.length)
                along.append(np.zeros((size, size)))
                along[-1][np.ix_(of.places, of.places)] = of.turned.T @ local @ of.turned
                mass += along[-1]
            else:
                for place in (*start[:2], *end[:2]):
                    mass[place, place] += weight / 2.0
    for name, weight in ((p["name"], p["mass"] / 1000.0) for p in particles if "mass" in p):
        for place in (3 * row[name], 3 * row[name] + 1):
            mass[place, place] = weight + sum(of[place, place] for of in along)
    held = [[*p.get("fixed", (False, False)), p.get("fixed_rotation", False)] for p in particles]
    stiffness[np.diag_indices(3 * len(particles))] += springs_of(particles)
    free = np.pad(~np.array(held).ravel(), (0, size - 3 * len(particles)), constant_values=True)
    heavy, light = free & (np.diag(mass) > 0.0), free & (np.diag(mass) == 0.0)
    inner = stiffness[np.ix_(heavy, light)] @ np.linalg.pinv(stiffness[np.ix_(light, light)])
    left = stiffness[np.ix_(heavy, heavy)] - inner @ stiffness[np.ix_(light, heavy)]
    found: np.ndarray = eigh(left, mass[np.ix_(heavy, heavy)], eigvals_only=True)
    return found


def consistent(length: float) -> np.ndarray:
    """The mass matrix of a rod of mass 1 that moves as its cubic: integrals of products of Hermite's polynomials."""
    points, weights = np.polynomial.legendre.leggauss(5)
    x, weights = 0.5 * (points + 1.0), 0.5 * weights
    zero = np.zeros_like(x)
    along = np.stack([1.0 - x, zero, zero, x, zero, zero])
    shapes = [
        1 - 3 * x**2 + 2 * x**3,
        x * (1 - x) ** 2 * length,
        3 * x**2 - 2 * x**3,
        -(x**2) * (1 - x) * length,
    ]
    across = np.stack([zero, shapes[0], shapes[1], zero, shapes[2], shapes[3]])
    matrix: np.ndarray = (along * weights) @ along.T + (across * weights) @ across.T
    return matrix
