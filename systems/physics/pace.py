"""Pace: how many simulated seconds to show per second, so that a person sees the motion."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.cases import factor_of_each
from pinjoint.components.load import loads_end, varying
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.rod import bends
from pinjoint.components.round_numbers import round_near
from pinjoint.systems.physics.bending import deformations, free_coordinates, stiffness_matrix

DENSE = 100  # particles up to which a full matrix is solved, without loading a library for others
_SLIGHTLY = 1e-10  # of the largest stiffness: holds mechanisms, which then move far, but not infinitely
_SHAKEN = 1e-8  # of the largest stiffness × size: forces that move mechanisms far, slender structures hardly
_PERIOD_SHOWN = 2.0  # s in which one oscillation is shown
_CREEP_SHOWN = 0.7  # s in which an overdamped model creeps by 1 − 1/e of the way
_LOADING_SHOWN = 4.0  # s in which a load history is shown
_FLIGHT_SHOWN = 2.5  # s in which a free body crosses the scene
_REAL_TIME = (0.05, 5.0)  # a mechanism or flight this near to real time is shown in real time
_REAL_STEPS = 0.2  # in its place, by which the steps of flights are chosen


def natural_pace(model: Model, *, moving: bool = True, of_steps: bool = False) -> float:
    """Simulated seconds per second shown, rounded to 1, 2 or 5 times a power of ten.

    moving: the present velocities count, too, where no rods swing. of_steps: not for a person, but as the steps of flights
    have always been chosen, so that runs keep their bits.
    """
    if incomputable(model):
        return 1.0
    swing = _response_time(model) if of_steps or not _is_loose(model) else None
    pace = (
        swing if swing is not None else _flight_pace(model, moving, _REAL_STEPS if of_steps else _REAL_TIME[0])
    )
    end = loads_end(model)
    if math.isfinite(end) and end > 0.0:
        pace = max(pace, end / _LOADING_SHOWN)
    return round_near(pace)


def _response_time(model: Model) -> float | None:
    """Pace from the mode that the loads excite; None if they move the model as a mechanism, or without rods."""
    response = loaded_mode(model)
    if response is None:
        return None
    frequency, damping = response
    ratio = damping / (2.0 * frequency)
    if ratio < 1.0:
        return 2.0 * math.pi / frequency / _PERIOD_SHOWN
    creep = frequency / (ratio + math.sqrt(ratio * ratio - 1.0))
    return 1.0 / creep / _CREEP_SHOWN


def loaded_mode(model: Model) -> tuple[float, float] | None:
    """ω (rad/s) and 2ζω (1/s) of the mode that the loads excite, by Rayleigh's method on their static displacement.

    ω² = uᵀKu / uᵀMu, 2ζω = uᵀCu / uᵀMu. None if the loads move the model as a mechanism, or without rods.
    """
    if model.rods.count == 0 or not free_coordinates(model).any():
        return None
    force = _forces(model)
    if not force[free_coordinates(model).ravel()].any():
        force = _everywhere(force)
    displacement = _static_displacement(model, force)
    if displacement is None:
        return None
    entries, rows, columns, stiffness, damping = deformations(model)
    moved = np.bincount(rows, entries * displacement.ravel()[columns], len(stiffness))
    particles = model.particles
    masses = np.column_stack([particles.mass, particles.mass, particles.inertia])[:, : displacement.shape[1]]
    inertia = float((masses * displacement**2).sum()) / 1000.0
    if inertia == 0.0:
        return None
    frequency = math.sqrt(float((stiffness * moved**2).sum()) / inertia)
    damped = float((damping * moved**2).sum()) / inertia + model.environment.drag
    return (frequency, damped) if frequency > 0.0 else None


def _everywhere(force: Array) -> Array:
    """Forces in place of these that excite all directions."""
    return np.where(np.arange(len(force)) % 2, -1.0, 0.3)


def _is_loose(model: Model) -> bool:
    """True if rods leave something free to move as drawn, such as a pendulum, be it pulled straight by its load."""
    if model.rods.count == 0 or not free_coordinates(model).any():
        return False
    shaken = _SHAKEN * deformations(model)[3].max() * float(np.ptp(model.particles.position, axis=0).max())
    return _static_displacement(model, shaken * _everywhere(_forces(model))) is None


def expected_response(model: Model) -> tuple[Array, Array] | None:
    """Linear displacement (n, 2), m, and axial force (rods,), kN, under all that acts.

    That is the loads at their full values, lack of fit, temperature and moved supports. None where the displacement is
    not small, as that of a mechanism.
    """
    particles, rods = model.particles, model.rods
    ends = rods.between.astype(np.intp)
    axis = rods.difference / np.where(rods.original_length > 0.0, rods.original_length, 1.0)[:, None]

    def axial_force(moved: Array) -> Array:
        elongation = rods.misfit + ((moved[ends[:, 1]] - moved[ends[:, 0]]) * axis).sum(axis=1)
        return np.asarray(rods.stiffness / rods.rest_length * elongation)

    moved = np.where(particles.mobility > 0.0, 0.0, particles.displacement)
    tension = axial_force(moved)[:, None] * axis
    force = _forces(model).reshape(free_coordinates(model).shape)
    np.add.at(force[:, :2], ends[:, 0], tension)
    np.add.at(force[:, :2], ends[:, 1], -tension)
    displacement = _static_displacement(model, force.ravel())
    if displacement is None:
        return None
    moved = displacement[:, :2] + moved
    return moved, axial_force(moved)


def _static_displacement(model: Model, force: Array) -> Array | None:
    """Linear displacement (n, 2), m, under forces (2n,) in kN; of models that bend with rotations; None where not small."""
    movable = free_coordinates(model)
    free = np.flatnonzero(movable.ravel())
    if not len(free):
        return np.zeros(movable.shape)
    solve = _solved_in_full if model.particles.count <= DENSE else _solved_sparsely
    displacement = np.zeros(movable.size)
    try:
        displacement[free] = solve(model, free, force[free])
    except (RuntimeError, np.linalg.LinAlgError):  # exactly singular
        return None
    size = float(np.ptp(model.particles.position, axis=0).max())
    moved = displacement.reshape(movable.shape)
    if not np.isfinite(displacement).all() or np.abs(moved[:, :2]).max() > 0.5 * size:
        return None
    return moved


def _forces(model: Model) -> Array:
    """The forces on the particles with all loads at their full values (kN), moments too where rods bend, flattened."""
    loads, varies = model.loads, varying(model.loads)
    force: Array = model.particles.constant_force.copy()
    moment = model.particles.constant_moment.copy()
    by_case = factor_of_each(model, "loads")
    np.add.at(force, loads.on[varies], (by_case[:, None] * loads.force)[varies])
    np.add.at(moment, loads.on[varies], (by_case * loads.moment)[varies])
    return (np.column_stack([force, moment]) if bends(model) else force).ravel()


def _solved_in_full(model: Model, free: NDArray[np.intp], force: Array) -> Array:
    """The displacements of free directions under forces, both (k,), by a full matrix."""
    matrix, stiffest = stiffness_matrix(model)
    held = matrix + _SLIGHTLY * stiffest * np.eye(len(free))
    return np.asarray(np.linalg.solve(held, force), dtype=np.float64)


def _solved_sparsely(model: Model, free: NDArray[np.intp], force: Array) -> Array:
    """The displacements of free directions by a sparse matrix. Raises RuntimeError if it is singular."""
    from scipy.sparse import csc_matrix, identity
    from scipy.sparse.linalg import splu

    entries, rows, columns, stiffness, _ = deformations(model)
    elongations = csc_matrix((entries, (rows, columns)), (len(stiffness), free_coordinates(model).size))
    elongations = elongations[:, free]
    matrix = elongations.T @ elongations.multiply(stiffness[:, None]).tocsc()
    held = matrix + _SLIGHTLY * stiffness.max() * identity(len(free), format="csc")
    return splu(csc_matrix(held)).solve(force)


def _flight_pace(model: Model, moving: bool, real_from: float) -> float:
    """Pace from the time in which the fastest particle crosses the scene."""
    particles = model.particles
    if particles.count == 0:
        return 1.0
    size = max(float(np.ptp(particles.position, axis=0).max()), 20.0 * float(particles.radius.max()))
    speed = float(np.hypot(*particles.velocity.T).max())
    pull = float(np.hypot(*(particles.constant_force * particles.mobility).T).max())
    times = []
    if moving and speed > 0.0:
        times.append(size / speed)
    if pull > 0.0:
        times.append(math.sqrt(2.0 * size / pull))
    pace = min(times, default=_FLIGHT_SHOWN) / _FLIGHT_SHOWN
    return 1.0 if real_from <= pace <= _REAL_TIME[1] else pace
