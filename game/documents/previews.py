"""Previews: models as small pictures show them, with forces in their rods."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from pinjoint.components.model import Model
from pinjoint.documents import models


def preview(source: str | Path) -> Model:
    """A model to look at only: a file as it was saved, an example at a moment when something happens. Raises ModelError.

    A small structure that never moved has the forces of linear theory.
    """
    if isinstance(source, str):
        return _example(source)
    model = models.load(source)
    particles, rods = model.particles, model.rods
    has_moved = particles.displacement.any() or particles.velocity.any()
    if 0 < rods.count <= (2000 if has_moved else 60):  # whose forces can be told apart, or are found at once
        # Here only, since examples do without.
        from pinjoint.systems.statics.equations import Structure
        from pinjoint.systems.statics.events import NoEquilibrium
        from pinjoint.systems.statics.theory import linear

        with suppress(NoEquilibrium):  # of a mechanism, such as a pendulum
            if has_moved:
                structure = Structure.of(model)
                place = structure.field(particles.displacement, particles.rotation)
                force = structure.respond(place, rods.plastic_strain).axial_force
            else:
                force = linear(model).axial_force
            model.writable("rods.axial_force")[...] = force
    return model


@cache
def _example(name: str) -> Model:
    """A bundled model, in the state (by name and column) that tests/golden/previews.py computes, or as it begins."""
    model = models.load(name)
    states = json.loads((files("pinjoint.assets") / "previews.json").read_text("utf-8"))
    for column, values in states.get(name, {}).items():
        model.writable(column)[...] = np.array(values)
    return model
