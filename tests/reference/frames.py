"""Frames, slow and obvious: the energy of corotational rods with bowing, and forces as its complex-step derivatives.

Nothing here shares a formula with the program but the energy itself: forces and moments are derivatives by a complex
step, exact to rounding. Slopes are those to the chord, wrapped once per rod by the mean of its rigid ends.
"""

import cmath
import math
from typing import Any

import numpy as np
from scipy.optimize import minimize

from pinjoint.components.model import Model

STEP = 1e-30


def stiffness_of(
    hinged: tuple[bool, bool], bent: bool, springs: tuple[float, float] = (0.0, 0.0)
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[int]]:
    """K/(EI/L₀), bowing, what slopes add to the area below the axis (per L₀²), and the ends that joints turn.

    springs: per EI/L₀. Ends that turn freely or by springs are where these and the rod have the least energy.
    """
    rod = np.array([[4.0, 2.0], [2.0, 4.0]])
    held = [end for end in (0, 1) if bent and (springs[end] or not hinged[end])]
    own = np.zeros((2, 2))
    if held:
        loose = [end for end in (0, 1) if springs[end] or hinged[end]]
        firm = [end for end in (0, 1) if end not in loose]
        own[firm, firm] = 1.0
        given = np.diag(springs)[loose] - rod[np.ix_(loose, firm)] @ np.eye(2)[firm]
        own[loose] = np.linalg.solve(rod[np.ix_(loose, loose)] + np.diag(springs)[np.ix_(loose, loose)], given)
    bowing = np.array([[4.0, -1.0], [-1.0, 4.0]]) / 30
    turned = np.diag([float(end in held) for end in (0, 1)]) - own
    stiffness = own.T @ rod @ own + turned.T @ np.diag(springs) @ turned
    return stiffness, own.T @ bowing @ own, own.T @ np.array([1 / 12, -1 / 12]), held


def angle(sine: Any, cosine: Any) -> Any:
    """atan2, also of numbers with a small imaginary part."""
    real = math.atan2(sine.real, cosine.real)
    turned = (cosine + 1j * sine) * cmath.exp(-1j * real)  # near the positive axis; exact in the imaginary part
    derivative = (sine.imag * cosine.real - cosine.imag * sine.real) / (sine.real**2 + cosine.real**2)
    assert turned.real > 0.0
    return real + 1j * derivative


def rod_energy(model: Model, row: int, shift: Any, turns: Any) -> Any:
    """Elastic energy of a rod less the work of its distributed force on its bent axis, not on its ends (kN·m)."""
    rod = model.rods[row]
    dx, dy = rod.difference
    x, y = dx + shift[0], dy + shift[1]
    length = cmath.sqrt(x * x + y * y)
    rest, original = rod.rest_length, rod.original_length
    elongation = ((dx + x) * shift[0] + (dy + y) * shift[1]) / (length + original) + original - rest
    elongation -= rest * (rod.thermal_expansion * rod.temperature_change + rod.plastic_strain)
    stiffness, bowing, area, rigid = stiffness_of(
        rod.hinged,
        rod.bending_stiffness > 0.0,
        tuple(k * rest / (rod.bending_stiffness or 1.0) for k in rod.end_springs),
    )
    chord = angle(dx * shift[1] - dy * shift[0], dx * x + dy * y)
    turns = [turn - plastic for turn, plastic in zip(turns, rod.plastic_rotation, strict=True)]
    mean = sum(turns[end].real for end in rigid) / len(rigid) if rigid else 0.0
    chord += 2 * math.pi * round((mean - chord.real) / (2 * math.pi))
    slopes = np.array([turns[0] - chord, turns[1] - chord])
    curvature = -rod.thermal_expansion * rod.temperature_gradient
    bent = slopes - np.array([-0.5, 0.5]) * curvature * rest
    strain = elongation / rest + 0.5 * slopes @ bowing @ slopes
    slack = rod.tension_only and strain.real < 0.0
    stored = 0.0 if slack else 0.5 * rod.stiffness * rest * strain**2
    stored += 0.5 * rod.bending_stiffness / rest * (bent @ stiffness @ bent)
    across = (-rod.distributed_force[0] * y + rod.distributed_force[1] * x) / length
    return stored - across * rest**2 * (area @ slopes)


def energy(model: Model, displacement: Any, rotation: Any) -> Any:
    """Elastic energy, of supports too, less the work of all constant forces and moments (kN·m)."""
    particles = model.particles
    total = -(particles.constant_force * displacement).sum() - (particles.constant_moment * rotation).sum()
    cosine, sine = np.cos(particles.support_angle), np.sin(particles.support_angle)
    x, y = displacement.T
    total += 0.5 * (particles.support_springs[:, 0] * (cosine * x + sine * y) ** 2).sum()
    total += 0.5 * (particles.support_springs[:, 1] * (cosine * y - sine * x) ** 2).sum()
    total += 0.5 * (particles.rotation_spring * rotation**2).sum()
    for row, (first, second) in enumerate(model.rods.between.astype(int).tolist()):
        shift = displacement[second] - displacement[first]
        total += rod_energy(model, row, shift, (rotation[first], rotation[second]))
    return total


def forces(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Forces (kN) and moments (kN·m) on the particles in the present state: the energy's negative derivatives."""
    state = np.column_stack([model.particles.displacement, model.particles.rotation])
    found = np.zeros_like(state)
    for place in np.ndindex(*state.shape):
        trial = state.astype(complex)
        trial[place] += 1j * STEP
        found[place] = -energy(model, trial[:, :2], trial[:, 2]).imag / STEP
    return found[:, :2], found[:, 2]


def random_frame(
    lot: np.random.Generator, count: int = 5, *, loaded: bool = True, warm: bool = True, sprung: bool = True
) -> dict[str, Any]:
    """A frame of so many particles in any state, with hinges, springs, bars, distributed forces and warm sides."""
    angles = np.sort(lot.uniform(0.0, 2.0 * math.pi, count))
    position = np.column_stack([np.cos(angles), np.sin(angles)]) * lot.uniform(1.0, 3.0, (count, 1))
    turned = float(lot.uniform(-9.0, 9.0))
    rotated = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    moved = position @ rotated.T - position + lot.normal(0.0, 0.05, (count, 2))
    particles = [
        {
            "name": f"P{i}",
            "position": position[i].tolist(),
            "displacement": moved[i].tolist(),
            "rotation": turned + float(lot.normal(0.0, 0.2)),
            "force": lot.normal(0.0, 1.0, 2).tolist(),
            "moment": float(lot.normal()),
        }
        for i in range(count)
    ]
    rods = []
    for a in range(count):
        for b in range(a + 1, count):
            facts: dict[str, Any] = {
                "name": f"R{a}{b}",
                "between": [f"P{a}", f"P{b}"],
                "stiffness": float(10 ** lot.uniform(2, 4)),
                "rest_length": float(np.hypot(*(position[b] - position[a])) * lot.uniform(0.97, 1.03)),
                "bending_stiffness": float(lot.choice([0.0, 10 ** lot.uniform(0, 2), 10 ** lot.uniform(0, 2)])),
                "hinged": [bool(lot.random() < 0.25), bool(lot.random() < 0.25)],
                "damping": float(lot.uniform(0.0, 1.0)),
            }
            if loaded:
                facts["distributed_force"] = lot.normal(0.0, 1.0, 2).tolist()
            if warm:
                facts["temperature_gradient"] = float(lot.normal(0.0, 1000.0))
            rods.append(facts)
    for facts in rods if sprung else ():
        facts["end_springs"] = (10 ** lot.uniform(0, 2, 2) * (lot.random(2) < 0.25)).tolist()
    rods[0] |= {"bending_stiffness": 10.0, "hinged": [False, False]}
    return {"format": "pinjoint model", "version": 1, "particles": particles, "rods": rods}


def least_energy(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (n, 2) and rotations (n,) of least energy near the present state, under all constant forces.

    By a trust region with complex-step gradients and their differences, then Newton's method to rounding. Supports and
    clamps stay where they are; the structure must be stable there.
    """
    free = np.column_stack([~model.particles.fixed, model.particles.turning > 0.0]).ravel()
    state = np.column_stack([model.particles.displacement, model.particles.rotation])

    def placed(unknowns: Any) -> Any:
        trial = state.astype(complex)
        trial.ravel()[free] = unknowns
        return trial

    def total(unknowns: Any) -> float:
        trial = placed(unknowns)
        return float(energy(model, trial[:, :2], trial[:, 2]).real)

    def gradient(unknowns: Any) -> np.ndarray:
        found = np.empty(len(unknowns))
        for place in range(len(unknowns)):
            trial = np.array(unknowns, dtype=complex)
            trial[place] += 1j * STEP
            at = placed(trial)
            found[place] = energy(model, at[:, :2], at[:, 2]).imag / STEP
        return found

    def hessian(unknowns: Any) -> np.ndarray:
        steps = 1e-6 * np.eye(len(unknowns))
        found = np.array([(gradient(unknowns + step) - gradient(unknowns - step)) / 2e-6 for step in steps])
        return 0.5 * (found + found.T)

    start = state.ravel()[free]
    found = minimize(total, start, jac=gradient, hess=hessian, method="trust-exact", options={"gtol": 1e-6})
    least = found.x
    for _ in range(4):
        least = least - np.linalg.solve(hessian(least), gradient(least))
    settled = placed(least).real
    return settled[:, :2], settled[:, 2]
