"""The integrator "automatic": which one suits a model, by a rule that depends on nothing but the document."""

from __future__ import annotations

import math

import numpy as np

from components.load import loads_end
from components.model import Model
from systems.physics.spectrum import Array, RodOperator

SMALL = 200  # rods up to which error control costs little
STIFF = 1e5  # slowest time scale × fastest rate above which implicit steps are cheaper
_RIGID = 1e-10  # share of the highest eigenvalue below which a mode has no stiffness of its own


def choose(model: Model) -> str:
    """The name of the integrator: up to SMALL rods one with error control, else velocity Verlet.

    Of these the explicit one of order 8, unless the model is too stiff: unless stability would force on it
    more than STIFF / 5 steps in the slowest time scale, which is a period, a creep time or the duration of
    the loading. Where a person fixes the step, no error can be controlled.
    """
    if model.rods.count > SMALL or model.settings.time_step is not None:
        return "velocity_verlet"
    return "esdirk4" if stiffness(model) > STIFF else "dop853"


def stiffness(model: Model) -> float:
    """Slowest time scale × fastest rate, in the original geometry; 0 if nothing is stiff."""
    rods = model.rods
    if rods.count == 0 or not (model.particles.mobility > 0.0).any():
        return 0.0
    matrix = _scaled_stiffness(model)
    eigenvalues = np.asarray(np.linalg.eigvalsh(matrix), dtype=np.float64)
    if not eigenvalues[-1] > 0.0:
        return 0.0
    dampers = RodOperator(model, rods.damping).gershgorin() + model.environment.drag
    fastest = max(math.sqrt(float(eigenvalues[-1])), dampers)
    return fastest * _slowest(model, eigenvalues)


def _slowest(model: Model, eigenvalues: Array) -> float:
    """The slowest of the periods and creep times of modes, swinging of mechanisms, and the loading (s)."""
    rods = model.rods
    has_own = eigenvalues > _RIGID * eigenvalues[-1]
    lowest = float(eigenvalues[has_own][0])
    if not has_own.all():
        pull = np.hypot(*(model.particles.constant_force * model.particles.mobility).T).max()
        swinging = float(pull / rods.rest_length.max())
        lowest = min(lowest, swinging) if swinging > 0.0 else lowest
    creep = float((rods.damping * rods.rest_length / rods.stiffness).max())
    end = loads_end(model)
    return max(
        2.0 * math.pi / math.sqrt(lowest),
        creep,
        model.environment.drag / lowest,
        end if end < math.inf else 0.0,
    )


def _scaled_stiffness(model: Model) -> Array:
    """M^-½ K M^-½ of the free directions in the original geometry (1/s²)."""
    particles, rods = model.particles, model.rods
    ends = rods.between.astype(np.intp)
    length = np.where(rods.original_length > 0.0, rods.original_length, 1.0)
    axis = rods.difference / length[:, None]
    rows = np.arange(rods.count)
    compatibility = np.zeros((rods.count, particles.count, 2))
    compatibility[rows, ends[:, 1]] = axis
    compatibility[rows, ends[:, 0]] = -axis
    compatibility *= np.sqrt(particles.mobility)
    free = particles.mobility.ravel() > 0.0
    scaled = compatibility.reshape(rods.count, -1)[:, free]
    matrix: Array = scaled.T @ (scaled * (rods.stiffness / rods.rest_length)[:, None])
    return matrix
