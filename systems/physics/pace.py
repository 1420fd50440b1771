"""Pace: how many simulated seconds to show per second, so that a person sees the motion."""

from __future__ import annotations

import math

import numpy as np

from components.extremes import incomputable
from components.load import loads_end
from components.model import Model

DENSE = 100  # particles up to which a full matrix is solved, without loading a library for others
PERIOD_SHOWN = 2.0  # s in which one oscillation is shown
CREEP_SHOWN = 0.7  # s in which an overdamped model creeps by 1 − 1/e of the way
LOADING_SHOWN = 4.0  # s in which a load history is shown
FLIGHT_SHOWN = 2.5  # s in which a free body crosses the scene
REAL_TIME = (0.2, 5.0)  # a mechanism or flight this near to real time is shown in real time


def natural_pace(model: Model) -> float:
    """Simulated seconds per second shown, rounded to 1, 2 or 5 times a power of ten."""
    if incomputable(model):
        return 1.0
    swing = _response_time(model)
    pace = swing if swing is not None else _flight_pace(model)
    end = loads_end(model)
    if math.isfinite(end) and end > 0.0:
        pace = max(pace, end / LOADING_SHOWN)
    return _rounded(pace)


def _response_time(model: Model) -> float | None:
    """Pace from the mode that the loads excite, by Rayleigh's method on their static displacement.

    ω² = uᵀKu / uᵀMu, 2ζω = uᵀCu / uᵀMu. None if the loads move the model as a mechanism, or without rods.
    """
    if model.rods.count == 0 or not (model.particles.mobility > 0.0).any():
        return None
    displacement = _static_displacement(model)
    if displacement is None:
        return None
    rods = model.rods
    ends = rods.between.astype(np.intp)
    axis = rods.difference / np.where(rods.original_length > 0.0, rods.original_length, 1.0)[:, None]
    elongation = ((displacement[ends[:, 1]] - displacement[ends[:, 0]]) * axis).sum(axis=1)
    inertia = float((model.particles.mass[:, None] * displacement**2).sum()) / 1000.0
    if inertia == 0.0:
        return None
    frequency = math.sqrt(float((rods.stiffness / rods.rest_length * elongation**2).sum()) / inertia)
    damping = float((rods.damping * elongation**2).sum()) / inertia + model.environment.drag
    ratio = damping / (2.0 * frequency) if frequency > 0.0 else 0.0
    if frequency == 0.0:
        return None
    if ratio < 1.0:
        return 2.0 * math.pi / frequency / PERIOD_SHOWN
    creep = frequency / (ratio + math.sqrt(ratio * ratio - 1.0))
    return 1.0 / creep / CREEP_SHOWN


def _static_displacement(model: Model) -> np.ndarray | None:
    """Linear displacement under the present loads, or None where it is not small."""
    particles, rods = model.particles, model.rods
    free = np.flatnonzero(particles.mobility.ravel() > 0.0)
    ends = rods.between.astype(np.intp)
    axis = rods.difference / np.where(rods.original_length > 0.0, rods.original_length, 1.0)[:, None]
    columns = np.concatenate(
        [2 * ends[:, :1], 2 * ends[:, :1] + 1, 2 * ends[:, 1:], 2 * ends[:, 1:] + 1], axis=1
    )
    rows = np.repeat(np.arange(rods.count), 4)
    entries = np.concatenate([-axis, axis], axis=1)
    force = particles.constant_force.ravel().copy()
    for load in model.loads:
        force[2 * load.on : 2 * load.on + 2] += load.force
    if not force[free].any():
        force = np.ones_like(force) * np.where(np.arange(len(force)) % 2, -1.0, 0.3)
    stiffness = rods.stiffness / rods.rest_length
    slightly = 1e-10 * float(stiffness.max())  # so that a mechanism moves far, but not infinitely
    displacement = np.zeros(2 * particles.count)
    try:
        if particles.count <= DENSE:
            dense = np.zeros((rods.count, 2 * particles.count))
            dense[rows, columns.ravel()] = entries.ravel()
            dense = dense[:, free]
            matrix = dense.T @ (dense * stiffness[:, None]) + slightly * np.eye(len(free))
            displacement[free] = np.linalg.solve(matrix, force[free])
        else:
            from scipy.sparse import csc_matrix, identity
            from scipy.sparse.linalg import splu

            sparse = csc_matrix((entries.ravel(), (rows, columns.ravel())), (rods.count, 2 * particles.count))
            sparse = sparse[:, free]
            matrix = sparse.T @ sparse.multiply(stiffness[:, None]).tocsc()
            matrix = csc_matrix(matrix + slightly * identity(len(free), format="csc"))
            displacement[free] = splu(matrix).solve(force[free])
    except (RuntimeError, np.linalg.LinAlgError):  # exactly singular
        return None
    size = float(np.ptp(particles.position, axis=0).max())
    if not np.isfinite(displacement).all() or np.abs(displacement).max() > 0.5 * size:
        return None
    return displacement.reshape(-1, 2)


def _flight_pace(model: Model) -> float:
    """Pace from the time in which the fastest particle crosses the scene."""
    particles = model.particles
    if particles.count == 0:
        return 1.0
    size = max(float(np.ptp(particles.position, axis=0).max()), 20.0 * float(particles.radius.max()))
    speed = float(np.hypot(*particles.velocity.T).max())
    pull = float(np.hypot(*(particles.constant_force * particles.mobility).T).max())
    times = []
    if speed > 0.0:
        times.append(size / speed)
    if pull > 0.0:
        times.append(math.sqrt(2.0 * size / pull))
    pace = min(times, default=FLIGHT_SHOWN) / FLIGHT_SHOWN
    return 1.0 if REAL_TIME[0] <= pace <= REAL_TIME[1] else pace


def _rounded(pace: float) -> float:
    power = 10.0 ** math.floor(math.log10(pace))
    return float(min((1.0, 2.0, 5.0, 10.0), key=lambda step: abs(math.log(step * power / pace)))) * power
