"""Equilibrium of small pin-jointed structures by dense matrices, independent of time stepping.

`direct_stiffness` is the linear elastic textbook method. `solve` follows the load through a sequence of
factors with exact (or linearised) geometry and elastic-perfectly plastic rods. Both take supports as they
are in the model (a support's displacement is a settlement), forces in kN and lengths in m.

Loads count with the final value of their history. Factors multiply forces and loads; accelerations grow
from 0 to 1 along with the first factor and then stay.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import minimize

from tests.reference.elements import Document, Elements, Model, read

LARGEST_MOVE = 0.02  # of the shortest rod, in one increment: a jump to another branch is longer
SMALLEST_INCREMENT = 1e-11  # of the way to the next factor
RESIDUAL = 1e-12  # of the largest force; the correction made from here on reaches round-off
ITERATIONS = 12


class NoEquilibrium(Exception):
    """No stable equilibrium follows continuously; `factor` is the last load factor that has one."""

    def __init__(self, factor: float, state: Document):
        super().__init__(f"No stable equilibrium follows the one at the load factor {factor:.12g}.")
        self.factor = factor
        self.state = state


def stiffness_matrix(model: Model) -> np.ndarray:
    """Return the linear elastic stiffness [kN/m] about the original positions, (2n, 2n), no supports."""
    elements = read(model)
    stiffness = np.zeros((2 * len(elements.particles), 2 * len(elements.particles)))
    for rod in elements.rods:
        along = np.array(rod.span) / math.hypot(*rod.span)
        pattern = np.concatenate([-along, along])
        freedoms = [2 * rod.start, 2 * rod.start + 1, 2 * rod.end, 2 * rod.end + 1]
        stiffness[np.ix_(freedoms, freedoms)] += rod.stiffness / rod.rest_length * np.outer(pattern, pattern)
    return stiffness


def direct_stiffness(model: Model) -> Document:
    """Return the linear elastic solution at the load factor 1, first-order about the original positions.

    K u = f with prescribed support displacements; misfit and plastic strain enter as initial forces.
    """
    elements = read(model)
    force = (_scaled_forces(elements) + _acceleration_forces(elements)).ravel()
    u = np.array([particle.displacement for particle in elements.particles]).ravel()
    free = ~np.array([particle.fixed for particle in elements.particles]).ravel()
    stiffness = stiffness_matrix(model)
    initial = np.zeros(u.size)
    axial_forces = []
    for rod in elements.rods:
        length = math.hypot(*rod.span)
        along = np.array(rod.span) / length
        n = rod.stiffness * ((length - rod.free_length) / rod.rest_length - rod.plastic_strain)
        initial[2 * rod.start : 2 * rod.start + 2] -= n * along
        initial[2 * rod.end : 2 * rod.end + 2] += n * along
        axial_forces.append(n)
    supports = stiffness[np.ix_(free, ~free)] @ u[~free]
    u[free] = np.linalg.solve(stiffness[np.ix_(free, free)], (force - initial)[free] - supports)
    reaction = np.where(free, 0.0, stiffness @ u + initial - force)
    for index, rod in enumerate(elements.rods):
        along = np.array(rod.span) / math.hypot(*rod.span)
        ends = u[2 * rod.end : 2 * rod.end + 2] - u[2 * rod.start : 2 * rod.start + 2]
        axial_forces[index] += rod.stiffness / rod.rest_length * float(along @ ends)
    plastic_strain = [rod.plastic_strain for rod in elements.rods]
    return _by_names(elements, 1.0, u, axial_forces, reaction, plastic_strain)


def direct_stiffness_of_cables(model: Model) -> Document:
    """Return the linear elastic solution of a model with cables: of all choices of slack ones the right one.

    It leaves no taut cable in compression and no slack one longer than it is without force. There is one at
    most, as the energy is convex. Raises ValueError if every choice that would do is a mechanism.
    """
    cables = [rod["name"] for rod in model["rods"] if rod.get("tension_only")]
    for slack in (set(chosen) for k in range(len(cables) + 1) for chosen in combinations(cables, k)):
        others = model | {"rods": [rod for rod in model["rods"] if rod["name"] not in slack]}
        free = ~np.array([particle.get("fixed", (False, False)) for particle in model["particles"]]).ravel()
        if np.linalg.cond(stiffness_matrix(others)[np.ix_(free, free)]) > 1e10:
            continue
        state = direct_stiffness(others)
        forces = state["axial_force"]
        small = 1e-12 * max(abs(n) for n in forces.values())
        stretched = any(_elongation(model, name, state["displacement"]) > 0.0 for name in slack)
        if not stretched and all(forces[name] >= -small for name in cables if name not in slack):
            return state | {"slack": slack}
    raise ValueError("No choice of slack cables leaves the others in tension.")


def _elongation(model: Model, name: str, displacement: Document) -> float:
    """First-order elongation [m] of a rod that fits."""
    rod = next(rod for rod in model["rods"] if rod["name"] == name)
    at = {particle["name"]: np.array(particle["position"]) for particle in model["particles"]}
    start, end = rod["between"]
    change = np.subtract(displacement[end], displacement[start])
    return float((at[end] - at[start]) @ change) / math.dist(at[start], at[end])


def solve(model: Model, factors: Sequence[float] = (1.0,), theory: str = "exact") -> list[Document]:
    """Follow the equilibrium through the load factors in turn; return one state per factor.

    `theory` is "exact", or "first-order" with the same yielding. A state holds, by
    names, displacement [m], reaction [kN], axial_force [kN], plastic_strain, and factor and residual [kN].
    Raises NoEquilibrium where stability is lost: a limit point, a bifurcation, or a plastic collapse.
    """
    return list(path(model, factors, theory))


def path(
    model: Model, factors: Sequence[float], theory: str = "exact", largest_increment: float = 1.0
) -> Iterator[Document]:
    """The same, one state after the other. largest_increment: of the way to the next factor; in smaller ones rods that
    unload do so nearer to where they should."""
    followed = Path(model, theory, largest_increment)
    followed.settle_initial_state()
    yield from (followed.follow_to(factor) for factor in factors)


def least_energy(model: Model, factor: float = 1.0) -> Document:
    """An elastic equilibrium where energy is least, found by going down from the initial state; mechanisms may move.

    Raises NoEquilibrium where there is no end of it.
    """
    followed = Path(model)
    free, force = followed.free, (factor * followed.patterns[0] + followed.patterns[1])
    at = followed.u.copy()

    def respond(x: np.ndarray) -> _Response:
        at[free] = x
        return followed.respond(at)

    def energy(x: np.ndarray) -> float:
        rods, forces = followed.elements.rods, respond(x).axial_force
        stored = sum(n**2 * rod.rest_length / (2 * rod.stiffness) for n, rod in zip(forces, rods, strict=True))
        return float(stored - force[free] @ (x - followed.u[free]))

    found = minimize(
        energy,
        followed.u[free],
        jac=lambda x: (respond(x).internal - force)[free],
        hess=lambda x: respond(x).tangent[np.ix_(free, free)],
        method="trust-exact",
        options={"gtol": 1e-9 * max(np.abs(force).max(), 1e-12), "maxiter": 3000, "initial_trust_radius": 0.05},
    )
    for _ in range(4):  # to round-off
        response = respond(found.x)
        found.x = (
            found.x
            + np.linalg.lstsq(
                response.tangent[np.ix_(free, free)], (force - response.internal)[free], rcond=1e-13
            )[0]
        )
    followed.u[free] = found.x
    followed.amounts = np.array([factor, 1.0, 0.0])
    state = followed.state()
    if not state["residual"] <= 1e-8 * max(np.abs(force).max(), *map(abs, state["axial_force"].values())):
        raise NoEquilibrium(factor, state)
    return state


def stability(model: Model, displacement: np.ndarray) -> float:
    """The least eigenvalue of an elastic structure's tangent at displacements (n, 2), relative to the largest."""
    followed = Path(model)
    free = followed.free
    eigenvalues = np.linalg.eigvalsh(followed.respond(displacement.ravel()).tangent[np.ix_(free, free)])
    return float(eigenvalues[0] / max(abs(eigenvalues[-1]), 1e-300)) if free.any() else 1.0


@dataclass(frozen=True)
class _Response:
    """Structure's answer to trial displacements: forces that hold it there, and their derivative."""

    internal: np.ndarray  # kN, shape (2n,)
    tangent: np.ndarray  # kN/m, shape (2n, 2n)
    axial_force: list[float]
    plastic_strain: list[float]


class Path:
    """The equilibrium path: the last state in equilibrium, and the way on to the next factor.

    The external force is `amounts @ patterns`: so much of the forces and loads, of the accelerations' forces,
    and of the forces that hold the given initial state.
    """

    def __init__(self, model: Model, theory: str = "exact", largest_increment: float = 1.0):
        self.largest_increment = largest_increment
        if theory not in ("exact", "first-order"):
            raise ValueError(f"The theory {theory!r} is unknown; use 'exact' or 'first-order'.")
        self.exact = theory == "exact"
        self.elements = read(model)
        self.free = ~np.array([particle.fixed for particle in self.elements.particles]).ravel()
        self.u = np.array([particle.displacement for particle in self.elements.particles]).ravel()
        self.plastic_strain = [rod.plastic_strain for rod in self.elements.rods]
        self.largest_move = LARGEST_MOVE * min(rod.rest_length for rod in self.elements.rods)
        self.grown = 1.0  # share of lack of fit and warmth
        held = self.respond(self.u)
        if held.plastic_strain != self.plastic_strain and not self.u[self.free].any():
            self.grow(max(map(abs, held.axial_force)))
        else:
            self.plastic_strain = held.plastic_strain  # what begins beyond its strength has yielded
        holding = np.where(self.free, self.respond(self.u).internal, 0.0)
        scaled = _scaled_forces(self.elements).ravel()
        self.patterns = np.array([scaled, _acceleration_forces(self.elements).ravel(), holding])
        self.amounts = np.array([0.0, 0.0, 1.0])

    def grow(self, scale: float) -> None:
        """Let lack of fit, warmth and settlements that make rods yield grow, little by little, without load."""
        whole, share, step = self.u.copy(), 0.0, min(1 / 64, self.largest_increment)
        self.u = np.zeros_like(whole)
        while share < 1.0:
            before, self.grown = self.u, min(1.0, share + step)
            self.u = np.where(self.free, before, self.grown * whole)
            found = self.newton(np.zeros_like(whole), scale)
            if found is not None:
                (self.u, self.plastic_strain), share = found, self.grown
                continue
            self.u, step = before, step / 2
            if step < SMALLEST_INCREMENT:
                raise ArithmeticError("There is no equilibrium without load.")

    def settle_initial_state(self) -> None:
        """Release what holds the given state at zero load (misfit, settlements), little by little."""
        self.walk_to(np.zeros(3))

    def follow_to(self, factor: float) -> Document:
        """Change the load factor to `factor`; return the state there."""
        self.walk_to(np.array([factor, 1.0, 0.0]))
        return self.state()

    def walk_to(self, amounts: np.ndarray) -> None:
        """Follow the path to `amounts`; halve an increment that fails, double one that succeeds."""
        start = self.amounts
        scale = max(np.abs(start @ self.patterns).max(), np.abs(amounts @ self.patterns).max())
        reached, increment = 0.0, min(1 / 8, self.largest_increment)
        while reached < 1.0 and scale > 0.0:
            target = min(1.0, reached + increment)
            trial = start + target * (amounts - start)
            found = self.newton(trial @ self.patterns, scale)
            if found is not None:
                self.u, self.plastic_strain = found
                self.amounts = trial
                reached, increment = target, min(2 * increment, self.largest_increment)
                continue
            increment = (target - reached) / 2
            if increment < SMALLEST_INCREMENT:
                raise NoEquilibrium(float(self.amounts[0]), self.state())
        self.amounts = amounts

    def newton(self, external: np.ndarray, scale: float) -> tuple[np.ndarray, list[float]] | None:
        """Return displacements and plastic strains in stable equilibrium with `external`, or None."""
        free = self.free
        u = self.u.copy()
        for _ in range(ITERATIONS):
            response = self.respond(u)
            residual = (external - response.internal)[free]
            tangent = response.tangent[np.ix_(free, free)]
            largest = max(scale, max(abs(n) for n in response.axial_force))
            relative = np.abs(residual).max(initial=0.0) / largest
            try:
                u[free] += np.linalg.solve(tangent, residual)
            except np.linalg.LinAlgError:
                return None
            if np.abs(u - self.u).max() > self.largest_move:
                return None
            if relative <= RESIDUAL:
                return (u, self.respond(u).plastic_strain) if _is_positive_definite(tangent) else None
        return None

    def respond(self, u: np.ndarray) -> _Response:
        """Return the forces and the consistent tangent at u, yielding from the last committed state."""
        internal = np.zeros(u.size)
        tangent = np.zeros((u.size, u.size))
        axial_forces, plastic_strains = [], []
        for rod, committed in zip(self.elements.rods, self.plastic_strain, strict=True):
            freedoms = [2 * rod.start, 2 * rod.start + 1, 2 * rod.end, 2 * rod.end + 1]
            elongation, along, length = self.kinematics(rod.span, rod.free_length, u[freedoms])
            strain = elongation / rod.rest_length
            trial = rod.stiffness * (strain - committed)
            slack = rod.tension_only and trial < 0.0
            n = 0.0 if slack else min(max(trial, -rod.compressive_strength), rod.tensile_strength)
            material = rod.stiffness / rod.rest_length if n == trial else 0.0
            block = material * np.outer(along, along)
            if self.exact:
                block += n / length * (np.eye(2) - np.outer(along, along))
            internal[freedoms] += n * np.concatenate([-along, along])
            tangent[np.ix_(freedoms, freedoms)] += np.block([[block, -block], [-block, block]])
            axial_forces.append(n)
            plastic_strains.append(committed if n == trial or slack else strain - n / rod.stiffness)
        return _Response(internal, tangent, axial_forces, plastic_strains)

    def kinematics(
        self, span: tuple[float, float], free_length: float, ends: np.ndarray
    ) -> tuple[float, np.ndarray, float]:
        """Return elongation [m], unit vector of the axis, and length [m], for the displacements of both ends.

        Exact: L − L₀ = ((2D + Δ)·Δ + D² − L₀²) / (L + L₀), written so that small Δ loses no digits.
        Linear: L − L₀ = D·Δ/|D| + |D| − L₀, with the axis as it was.
        """
        original = np.array(span)
        change = ends[2:] - ends[:2]
        original_length = math.hypot(*span)
        misfit = self.grown * (original_length - free_length)
        free_length = original_length - misfit
        if not self.exact:
            along = original / original_length
            return float(along @ change) + misfit, along, original_length
        present = original + change
        length = math.hypot(*present)
        squares = float((2 * original + change) @ change) + misfit * (original_length + free_length)
        return squares / (length + free_length), present / length, length

    def state(self) -> Document:
        """Return the present state by names."""
        response = self.respond(self.u)
        unbalanced = response.internal - self.amounts @ self.patterns
        reaction = np.where(self.free, 0.0, unbalanced)
        residual = float(np.abs(unbalanced[self.free]).max(initial=0.0))
        factor = float(self.amounts[0])
        state = _by_names(self.elements, factor, self.u, response.axial_force, reaction, self.plastic_strain)
        return state | {"residual": residual}


def _is_positive_definite(matrix: np.ndarray) -> bool:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True


def _scaled_forces(elements: Elements) -> np.ndarray:
    """Return what the load factor multiplies [kN], shape (particles, 2): forces, and loads' final value."""
    forces = np.array([particle.force for particle in elements.particles]) + elements.environment_force
    for load in elements.loads:
        forces[load.particle] += load.factor(math.inf) * np.array(load.force)
    return forces


def _acceleration_forces(elements: Elements) -> np.ndarray:
    """Return mass × (own + environment's acceleration) [kN], shape (particles, 2)."""
    accelerations = [np.add(p.acceleration, elements.environment_acceleration) for p in elements.particles]
    masses = np.array([particle.mass for particle in elements.particles])
    forces: np.ndarray = masses[:, None] * np.array(accelerations) / 1000
    return forces


def _by_names(
    elements: Elements,
    factor: float,
    u: np.ndarray,
    axial_forces: list[float],
    reaction: np.ndarray,
    plastic_strains: list[float],
) -> Document:
    particles = [particle.name for particle in elements.particles]
    rods = [rod.name for rod in elements.rods]
    pairs = {"displacement": u.reshape(-1, 2), "reaction": reaction.reshape(-1, 2)}
    numbers = {"axial_force": axial_forces, "plastic_strain": plastic_strains}
    state: Document = {"factor": factor}
    for title, rows in pairs.items():
        state[title] = {name: (float(x), float(y)) for name, (x, y) in zip(particles, rows, strict=True)}
    for title, values in numbers.items():
        state[title] = {name: float(value) for name, value in zip(rods, values, strict=True)}
    return state
