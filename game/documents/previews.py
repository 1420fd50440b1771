"""Previews: models as small pictures show them, with forces in their rods."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from pinjoint.components.model import Model
from pinjoint.documents import models

LARGEST_SOLVED = 60  # rods, up to which a structure that never moved is solved for its picture
LARGEST_SHOWN = 2000  # rods, up to which forces can be told apart in one


def preview(source: str | Path) -> Model:
    """A model to look at only: a file as it was saved, an example at a moment when something happens. Raises ModelError."""
    if isinstance(source, str):
        return _example(source)
    model = models.load(source)
    if has_moved(model) and model.rods.count <= LARGEST_SHOWN:
        # Here only, since most pictures do without.
        from pinjoint.systems.statics.equations import Structure

        structure, particles = Structure.of(model), model.particles
        place = structure.field(particles.displacement, particles.rotation)
        moved = structure.respond(place, model.rods.plastic_strain)
        model.writable("rods.axial_force")[...] = moved.axial_force
    return model


def solved(path: Path) -> Model | None:
    """A small structure that never moved, with forces of linear theory; None if a file has no such. Raises ModelError."""
    from pinjoint.systems.statics.events import NoEquilibrium
    from pinjoint.systems.statics.theory import linear  # scipy

    model = models.load(path)
    if has_moved(model) or not 0 < model.rods.count <= LARGEST_SOLVED:
        return None
    try:
        model.writable("rods.axial_force")[...] = linear(model).axial_force
    except NoEquilibrium:  # of a mechanism, such as a pendulum
        return None
    return model


def has_moved(model: Model) -> bool:
    """True if the state of a model is another than the original one."""
    return bool(model.particles.displacement.any() or model.particles.velocity.any())


@cache
def _example(name: str) -> Model:
    model = models.load(name)
    for column, values in _states().get(name, {}).items():
        model.writable(column)[...] = np.array(values)
    return model


@cache
def _states() -> dict[str, dict[str, Any]]:
    """By example and column what differs then from its beginning; tests/golden/previews.py computes it."""
    states: dict[str, dict[str, Any]] = json.loads(
        (files("pinjoint.assets") / "previews.json").read_text("utf-8")
    )
    return states
