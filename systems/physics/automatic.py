"""The integrator "automatic": which one suits a model, by a rule that depends on nothing but the document."""

from __future__ import annotations

import math

import numpy as np

from pinjoint.components.load import loads_end
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.systems.physics.bending import free_coordinates, stiffness_matrix
from pinjoint.systems.physics.pace import loaded_mode
from pinjoint.systems.physics.spectrum import RodOperator, highest_sprung

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
    return "esdirk4" if _stiffness(model) > STIFF else "dop853"


def _stiffness(model: Model) -> float:
    """Slowest time scale × fastest rate, in the original geometry; 0 if nothing is stiff."""
    rods, drag = model.rods, model.environment.drag
    if rods.count == 0 or not free_coordinates(model).any() or incomputable(model):
        return 0.0
    lowest, highest = _of_all_modes(model) if rods.count <= SMALL else _of_loaded_mode(model)
    if highest == 0.0:
        return 0.0
    fastest = max(math.sqrt(highest), RodOperator(model, rods.damping, rods.end_damping).gershgorin() + drag)
    end = loads_end(model)
    times = [end if end < math.inf else 0.0, float((rods.damping * rods.rest_length / rods.stiffness).max())]
    if lowest > 0.0:
        times += [2.0 * math.pi / math.sqrt(lowest), drag / lowest]
    return float(fastest * max(times))


def _of_all_modes(model: Model) -> tuple[float, float]:
    """The lowest and the highest ω² ((rad/s)²) of a small model; of mechanisms, of swinging."""
    matrix, _ = stiffness_matrix(model, by_mass=True)
    eigenvalues = np.linalg.eigvalsh(matrix)
    highest, swinging = max(float(eigenvalues[-1]), 0.0), _swinging(model)
    own = eigenvalues[eigenvalues > _RIGID * highest]
    lowest = float(own.min(initial=math.inf))
    return min(lowest, swinging) if len(own) < len(eigenvalues) and swinging > 0.0 else lowest, highest


def _of_loaded_mode(model: Model) -> tuple[float, float]:
    """The same of a model that is too large for all its modes: ω² of the one that the loads excite, and a bound."""
    mode = loaded_mode(model)
    highest = RodOperator(
        model, model.rods.stiffness / model.rods.rest_length, model.rods.end_stiffness
    ).gershgorin() + highest_sprung(model)
    return _swinging(model) if mode is None else mode[0] ** 2, highest


def _swinging(model: Model) -> float:
    """About ω² of a mechanism under the constant forces ((rad/s)²)."""
    pull = float(np.hypot(*(model.particles.constant_force * model.particles.mobility).T).max())
    return pull / float(model.rods.rest_length.max())
