"""Stability: whether forces of rods hold a structure in its present shape, found quickly enough for every frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinjoint.components.model import Model
from pinjoint.systems.statics.equations import Structure

RESISTED = 1e-9  # of the largest stiffness: a motion that is resisted less counts as not resisted
RESISTED_BY_BENDING = 1e-12  # the same where members bend, which long ones do a million times more easily


def is_held(model: Model, *, at_first: bool = False) -> bool:
    """True if every small displacement of the nodes is resisted: the tangent stiffness is positive definite.

    at_first: as if no rod bore any force yet, so that mechanisms are not held, whatever tension keeps them in shape.
    Yielding rods and slack cables do not resist elongation.
    """
    particles, rods = model.particles, model.rods
    structure = replace(Structure.of(model).with_translations(), sparse=False)
    place = structure.field(particles.displacement, particles.rotation)
    response = structure.respond(place, rods.plastic_strain, 1.0)
    soft = rods.yielding | (rods.tension_only & (rods.axial_force <= 0.0))
    tangent = structure.tangent(response, soft & (not at_first), geometric=not at_first)
    share = RESISTED if structure.bending is None else RESISTED_BY_BENDING
    try:
        np.linalg.cholesky(tangent - share * np.eye(structure.size) * np.abs(tangent).max(initial=0.0))
    except np.linalg.LinAlgError:
        return False
    return structure.size > 0
