"""Previews: models as small pictures show them, with forces in their rods."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from components.model import Model
from game.documents import models

LARGEST_SOLVED = 60  # rods, up to which a structure that never moved is solved for its picture
LARGEST_SHOWN = 2000  # rods, up to which forces can be told apart in one


def preview(source: str | Path) -> Model:
    """A model to look at only: a file as it was saved, an example at a moment when something happens. Raises ModelError."""
    return _example(source) if isinstance(source, str) else with_forces(models.load(source))


@cache
def _example(name: str) -> Model:
    model = models.load(name)
    for column, values in _states().get(name, {}).items():
        model.writable(column)[...] = np.array(values)
    return model


@cache
def _states() -> dict[str, dict[str, Any]]:
    """By example and column what differs then from its beginning; tests/golden/previews.py computes it."""
    states: dict[str, dict[str, Any]] = json.loads((files("assets") / "previews.json").read_text("utf-8"))
    return states


def with_forces(model: Model) -> Model:
    """The model with the axial forces of its displacements; of a small one that never moved, those of linear theory."""
    # Here only, since a start without small pictures does without.
    from systems.statics.equations import Structure
    from systems.statics.events import NoEquilibrium
    from systems.statics.theory import linear  # scipy

    rods = model.rods
    if not 0 < rods.count <= LARGEST_SHOWN:
        return model
    moved = model.particles.displacement.any() or model.particles.velocity.any()
    force = Structure.of(model).respond(model.particles.displacement, rods.plastic_strain).axial_force
    if not moved and rods.count <= LARGEST_SOLVED:
        with suppress(NoEquilibrium):  # of a mechanism, such as a pendulum
            force = linear(model).axial_force
    model.writable("rods.axial_force")[...] = force
    return model
