"""The integrator "automatic": which one suits a model, by a rule that depends on nothing but the document."""

from __future__ import annotations

import math

import numpy as np

from pinjoint.components.load import loads_end
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.systems.physics.bending import deformations, free_coordinates
from pinjoint.systems.physics.pace import loaded_mode
from pinjoint.systems.physics.spectrum import Array, coarse_rates

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
    if incomputable(model):  # no run can begin, but undo and properties ask as well
        return suited_to(0.0)
    if model.rods.count > SMALL:
        return suited_to(_stiffness(model))
    return suited_to(float(stiffnesses(model, np.array([model.environment.drag]))[0]))


def suited_to(stiffness: float) -> str:
    """The integrator with error control for a model of this stiffness."""
    return "esdirk4" if stiffness > STIFF else "dop853"


def _stiffness(model: Model) -> float:
    """As `stiffnesses`, of a model that is too large for all its modes; by the one that the loads excite."""
    rods, particles = model.rods, model.particles
    if not free_coordinates(model).any():
        return 0.0
    squared, damped = coarse_rates(model)
    fastest = max(math.sqrt(squared[0]), damped[0] + model.environment.drag)
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


def stiffnesses(model: Model, drag: Array) -> Array:
    """Slowest time scale × fastest rate of each of the equal disjoint blocks that a model consists of.

    In the original geometry; 0 if nothing is stiff. The blocks are constrained alike. drag: the environment's
    (1/s), one for each block.
    """
    rods, blocks = model.rods, len(drag)
    if rods.count == 0 or not free_coordinates(model).any():
        return np.zeros(blocks)
    eigenvalues = np.asarray(np.linalg.eigvalsh(_scaled_stiffness(model, blocks)), dtype=np.float64)
    highest = np.maximum(eigenvalues[:, -1], 0.0)
    fastest = np.maximum(np.sqrt(highest), coarse_rates(model, blocks)[1] + drag)
    with np.errstate(divide="ignore", invalid="ignore"):
        found: Array = np.where(highest > 0.0, fastest * _slowest(model, eigenvalues, drag), 0.0)
    return found


def _slowest(model: Model, eigenvalues: Array, drag: Array) -> Array:
    """The slowest of the periods and creep times of modes, swinging of mechanisms, and the loading (s)."""
    rods, blocks = model.rods, len(drag)
    has_own = eigenvalues > _RIGID * eigenvalues[:, -1:]
    lowest = np.where(has_own, eigenvalues, math.inf).min(axis=1)
    pull = np.hypot(*(model.particles.constant_force * model.particles.mobility).T).reshape(blocks, -1)
    swinging = pull.max(axis=1) / rods.rest_length.reshape(blocks, -1).max(axis=1)
    lowest = np.where(has_own.all(axis=1) | (swinging == 0.0), lowest, np.minimum(lowest, swinging))
    creep = (rods.damping * rods.rest_length / rods.stiffness).reshape(blocks, -1).max(axis=1)
    end = loads_end(model)
    times = [2.0 * math.pi / np.sqrt(lowest), creep, drag / lowest]
    slowest: Array = np.maximum.reduce([*times, np.full(blocks, end if end < math.inf else 0.0)])
    return slowest


def _scaled_stiffness(model: Model, blocks: int) -> Array:
    """M^-½ K M^-½ of the free coordinates of each block in the original geometry (1/s²)."""
    entries, rows, columns, stiffness, _ = deformations(model)
    free, of_block = free_coordinates(model), model.rods.count // blocks
    width, kinds = free.size // blocks, len(stiffness) // model.rods.count
    mobility = np.column_stack([model.particles.mobility, model.particles.turning])[:, : free.shape[1]]
    kind, rod = np.divmod(rows, model.rods.count)
    block, row = np.divmod(rod, of_block)
    scaled = np.zeros((blocks, kinds * of_block, width))
    scaled[block, kind * of_block + row, columns % width] = entries
    scaled *= np.sqrt(mobility).reshape(blocks, 1, width)
    scaled = np.ascontiguousarray(scaled[:, :, free.ravel()[:width]])
    stiffness = stiffness.reshape(kinds, blocks, of_block).swapaxes(0, 1).reshape(blocks, -1, 1)
    matrices: Array = scaled.transpose(0, 2, 1) @ (scaled * stiffness)
    return matrices
