"""Statics of members that bend: residual and tangent against the slow reference and against differences."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from pinjoint.components.arrays import Array
from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.session import Session
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.external import External
from tests.reference import frames

SMALL = 1e-6


def made(number: int, count: int = 5) -> tuple[Model, Structure, Array]:
    """A random frame in any state, turned by up to ±9 rad, its structure, and its coordinates (n, 3)."""
    model = parse(frames.random_frame(np.random.default_rng([71, number]), count))
    structure = Structure.of(model).with_translations()
    return model, structure, structure.field(model.particles.displacement, model.particles.rotation)


def unbalanced(model: Model, structure: Structure, place: Array) -> Array:
    """Forces (n, 3) out of balance under the whole load, 0 where nothing is solved for."""
    response = structure.respond(place, model.rods.plastic_strain, 1.0)
    found = External.of(model).at(1.0) - structure.internal(response)
    return np.where(structure.unknown, found, 0.0)


@pytest.mark.parametrize("number", range(12))
def test_forces_are_derivatives_of_the_energy(number: int) -> None:
    model, structure, place = made(number)
    force, moment = frames.forces(model)
    wanted = np.where(structure.unknown, np.column_stack([force, moment]), 0.0)
    found = unbalanced(model, structure, place)
    assert np.abs(found - wanted).max() < 1e-14 * np.abs(structure.respond(place, 0.0).axial_force).max() * 4.0


@pytest.mark.parametrize("number", range(6))
def test_forces_are_those_of_the_motion(number: int) -> None:
    """Under the same state as the program of the run sees."""
    model, structure, place = made(number)
    program = Session(model).simulation.programs.compiled
    program.observe()
    wanted = np.column_stack([program.unbalanced, program.unbalanced_moment])
    scale = np.abs(model.rods.axial_force).max()
    found = unbalanced(model, structure, place)
    assert np.abs(found - np.where(structure.unknown, wanted, 0.0)).max() < 4e-14 * scale


@pytest.mark.parametrize("number", range(12))
@pytest.mark.parametrize("flows", [False, True])
def test_the_tangent_is_the_derivative(number: int, flows: bool) -> None:
    """By central differences of the forces, elastic or with some rods yielding."""
    model, structure, place = made(number)
    if flows:
        limit = np.where(np.arange(model.rods.count) % 3 == 0, 1e-3, np.inf)
        structure = dataclasses.replace(structure, tension_limit=limit, compression_limit=limit)
    response = structure.respond(place, model.rods.plastic_strain, 1.0)
    assert response.flowing.any() == flows
    tangent: Any = structure.tangent(response, response.soft)
    differences = np.empty((structure.size, structure.size))
    elongations = np.empty((model.rods.count, structure.size))
    for column in range(structure.size):
        step = np.zeros(structure.size)
        step[column] = SMALL
        ahead, behind = place + structure.spread(step), place - structure.spread(step)
        change = unbalanced(model, structure, behind) - unbalanced(model, structure, ahead)
        differences[:, column] = structure.gather(change) / (2.0 * SMALL)
        longer = [structure.respond(at, 0.0).elongation for at in (ahead, behind)]
        elongations[:, column] = (longer[0] - longer[1]) / (2.0 * SMALL)
    assert np.abs(tangent - differences).max() < 1e-9 * np.abs(tangent).max()
    assert np.abs(tangent - tangent.T).max() <= 1e-15 * np.abs(tangent).max()
    of_rods = structure.compatibility(response).toarray()[: model.rods.count]
    assert np.abs(of_rods - elongations).max() < 1e-8
    assert structure.elongations(response, np.arange(model.rods.count)) == pytest.approx(of_rods, abs=1e-15)
