"""The integrator "automatic": which one suits a model, by a rule that depends on nothing but the document."""

from __future__ import annotations

import math

import numpy as np

from pinjoint.components.load import loads_end
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.rod import bends
from pinjoint.systems.physics.bending import deformations, free_coordinates
from pinjoint.systems.physics.pace import loaded_mode
from pinjoint.systems.physics.spectrum import Array, FrameOperator, RodOperator

SMALL = 200  # rods up to which the modes of a model are found in no time, and steps cost next to nothing
AFFORDABLE = 5000  # rods up to which error control keeps up with a person's eye
STIFF = 1e5  # slowest time scale × fastest rate above which implicit steps are cheaper
_RIGID = 1e-10  # share of the highest eigenvalue below which a mode has no stiffness of its own


def choose(model: Model) -> str:
    """The name of the integrator: up to AFFORDABLE rods one with error control, else velocity Verlet.

    With error control, the explicit one of order 8, unless the model is too stiff: unless stability would force more
    than STIFF / 5 steps on it in the slowest time scale, which is a period, a creep time or the duration of the
    loading. Where a person fixes the step, no error can be controlled.
    """
    if model.rods.count > AFFORDABLE or model.settings.time_step is not None:
        return "velocity_verlet"
    if model.rods.count > SMALL:
        return suited_to(0.0 if incomputable(model) else _stiffness(model))
    return suited_to(_stiffness_of_all_modes(model))


def suited_to(stiffness: float) -> str:
    """The integrator with error control for a model of this stiffness."""
    return "esdirk4" if stiffness > STIFF else "dop853"


def _stiffness(model: Model) -> float:
    """As _stiffness_of_all_modes, of a model that is too large for all its modes; by the one that the loads excite."""
    rods, particles = model.rods, model.particles
    if not free_coordinates(model).any():
        return 0.0
    fastest = math.sqrt(_operator(model).gershgorin())
    fastest = max(fastest, _damping_operator(model).gershgorin() + model.environment.drag)
    mode = loaded_mode(model)
    if mode is None:  # a mechanism
        pull = float(np.hypot(*(particles.constant_force * particles.mobility).T).max())
        frequency = math.sqrt(pull / float(rods.rest_length.max()))
    else:
        frequency = mode[0]
    end = loads_end(model)
    times = [end if end < math.inf else 0.0, float((rods.damping * rods.rest_length / rods.stiffness).max())]
    if frequency > 0.0:
        times += [2.0 * math.pi / frequency, model.environment.drag / frequency**2]
    return float(fastest * max(times))


def _stiffness_of_all_modes(model: Model) -> float:
    """Slowest time scale × fastest rate, in the original geometry; 0 if nothing is stiff."""
    if model.rods.count == 0 or not free_coordinates(model).any():
        return 0.0
    with np.errstate(all="ignore"):  # of such numbers no run can begin, but undo and properties ask as well
        matrix = _of_frame(model) if bends(model) else _scaled_stiffness(model)
        if not np.isfinite(matrix).all():
            return 0.0
    eigenvalues = np.asarray(np.linalg.eigvalsh(matrix), dtype=np.float64)
    highest = max(float(eigenvalues[-1]), 0.0)
    if highest == 0.0:
        return 0.0
    fastest = max(math.sqrt(highest), _damping_operator(model).gershgorin() + model.environment.drag)
    return fastest * _slowest(model, eigenvalues)


def _operator(model: Model) -> RodOperator:
    """The operator of the stiffness of rods without forces."""
    rods = model.rods
    along = rods.stiffness / rods.rest_length
    return FrameOperator(model, along, rods.end_stiffness) if bends(model) else RodOperator(model, along)


def _damping_operator(model: Model) -> RodOperator:
    rods = model.rods
    return (
        FrameOperator(model, rods.damping, rods.end_damping)
        if bends(model)
        else RodOperator(model, rods.damping)
    )


def _of_frame(model: Model) -> Array:
    """_scaled_stiffness of a model that bends, rotations count by their inertias."""
    entries, rows, columns, stiffness, _ = deformations(model)
    free = free_coordinates(model)
    mobility = np.column_stack([model.particles.mobility, model.particles.turning])
    scaled = np.zeros((len(stiffness), free.size))
    scaled[rows, columns] = entries
    scaled = (scaled * np.sqrt(mobility).ravel())[:, free.ravel()]
    matrix: Array = scaled.T @ (scaled * stiffness[:, None])
    return matrix


def _slowest(model: Model, eigenvalues: Array) -> float:
    """The slowest of the periods and creep times of modes, swinging of mechanisms, and the loading (s)."""
    rods, drag = model.rods, model.environment.drag
    own = eigenvalues[eigenvalues > _RIGID * eigenvalues[-1]]
    pull = float(np.hypot(*(model.particles.constant_force * model.particles.mobility).T).max())
    swinging = pull / float(rods.rest_length.max())
    lowest = float(own.min())
    if len(own) < len(eigenvalues) and swinging > 0.0:
        lowest = min(lowest, swinging)
    creep = float((rods.damping * rods.rest_length / rods.stiffness).max())
    end = loads_end(model)
    return max(2.0 * math.pi / math.sqrt(lowest), creep, drag / lowest, end if end < math.inf else 0.0)


def _scaled_stiffness(model: Model) -> Array:
    """M^-½ K M^-½ of the free directions in the original geometry (1/s²)."""
    particles, rods = model.particles, model.rods
    axis = rods.difference / np.where(rods.original_length > 0.0, rods.original_length, 1.0)[:, None]
    rows, ends = np.arange(rods.count), rods.between.astype(np.intp)
    compatibility = np.zeros((rods.count, particles.count, 2))
    compatibility[rows, ends[:, 1]] = axis
    compatibility[rows, ends[:, 0]] = -axis
    mobility = particles.mobility.ravel()
    scaled = (compatibility.reshape(rods.count, -1) * np.sqrt(mobility))[:, mobility > 0.0]
    matrix: Array = scaled.T @ (scaled * (rods.stiffness / rods.rest_length)[:, None])
    return matrix
