"""Copies of a structure for the force method: elastic, released, unloaded, and still with the forces of a state."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components.model import Model
from pinjoint.components.particle import in_support_axes, supported, turned_supports
from pinjoint.components.world import Shown
from pinjoint.components.written import ROUNDING
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.superposition import SetState, Superposition
from pinjoint.systems.statics.unknowns import Unknown

_ACTING = {  # what loads, moves or strains a structure, by table
    "environment": ("force", "acceleration"),
    "particles": ("force", "moment", "acceleration", "displacement", "rotation"),
    "rods": (
        *("distributed_force", "temperature_change", "temperature_gradient"),
        *("plastic_strain", "plastic_rotation"),
    ),
}


def elastic_copy(model: Model) -> Model:
    """The same structure without yielding, at rest at the beginning of time; only moved supports are displaced."""
    copy = model.undeformed_copy()
    copy.settings.plasticity = False
    return copy


def base_structure(model: Model, released: Sequence[Unknown]) -> Model:
    """An elastic copy without some unknowns, which keeps all nodal masses."""
    copy = elastic_copy(model)
    copy.settings.time_step = None
    copy.settings.collisions = False
    if released:
        copy.assign(list(copy.particles), "prescribed_mass", model.particles.mass.tolist())
    for unknown in released:
        _release(copy, unknown)
    return copy


def unloaded(model: Model, released: Sequence[Unknown]) -> Model:
    """The released structure under nothing: no loads, lack of fit, warmth or displacements of supports."""
    copy = base_structure(model, released)
    copy.delete([*copy.loads, *copy.span_loads])
    copy.settings.combination = ""
    for table in map(copy.tables.__getitem__, _ACTING):
        for name in _ACTING[table.name]:
            copy.assign(list(table), name, np.zeros_like(table.column(name)))
    copy.assign(list(copy.rods), "prescribed_rest_length", copy.rods.original_length.tolist())
    return copy


def loaded(model: Model, released: Sequence[Unknown], amounts: Sequence[float]) -> Model:
    """The released structure under so much of its unknowns, and nothing else."""
    copy = unloaded(model, released)
    force = np.zeros((model.particles.count, 3))
    for unknown, amount in zip(released, amounts, strict=True):
        unit, couple = unknown.unit_load(model)
        # seen on the joint; the other of the pair acts on the rod
        np.add.at(unit[:, 2], model.rods.between, -couple)
        force += amount * unit
    copy.assign(list(copy.particles), "force", force[:, :2].tolist())
    copy.assign(list(copy.particles), "moment", force[:, 2].tolist())
    return copy


def held(copy: Model, solution: Superposition) -> Model:
    """The copy, in which the unknowns of the displacement method are constrained."""
    fixed = np.column_stack([copy.particles.fixed, copy.particles.fixed_rotation])
    for one in solution.unknowns:
        fixed[one.place] = True
    copy.assign(list(copy.particles), "fixed", fixed[:, :2].tolist())
    copy.assign(list(copy.particles), "fixed_rotation", fixed[:, 2].tolist())
    return copy


def still(copy: Model, whole: Model, state: SetState, *, moved: bool = False) -> Model:
    """A copy of a structure, perhaps without some of its rods, with the forces of a state; none may run.

    moved: with its displacements; else undeformed.
    """
    rods = copy.rods
    if moved:
        copy.settings.original_diagrams = False
        copy.show(Shown({}, 0, True, 1.0))  # as first-order theory has it: forces act on the original geometry
    here = [whole.rods[name].row for name in rods.names]
    copy.writable("particles.displacement")[...] = state.displacement if moved else 0.0
    copy.writable("particles.rotation")[...] = state.rotation if moved else 0.0
    if rods.bending_stiffness.any() and not moved:
        copy.writable("rods.bending_stiffness")[...] *= 1e9  # what is drawn stays straight
    load = np.pad(External.of(copy).at(1.0), ((0, 0), (0, 1)))
    held = supported(copy)
    held[:, :2] |= turned_supports(copy)[:, None]
    counts = held & (np.abs(state.reaction) > ROUNDING * largest(state.axial_force))
    reaction = np.where(counts, state.reaction, 0.0)
    told = {
        "particles.reaction": reaction[:, :2],
        "particles.reaction_moment": reaction[:, 2],
        "particles.applied_force": load[:, :2],
        "particles.applied_moment": load[:, 2],
        "rods.axial_force": state.axial_force[here],
        "rods.end_moment": state.end_moment[here],
    }
    for name in told:
        table, _, column = name.partition(".")
        copy.tables[table].column(column)  # up to date first, so that what is told stays
    for name, values in told.items():
        copy.writable(name)[...] = values
    return copy


def exact_forces(model: Model, unknowns: Sequence[Unknown]) -> list[float] | None:
    """The unknowns by exact geometry (kN, kN·m), without yielding; None if there is no equilibrium."""
    if not unknowns:
        return []
    final = settle(elastic_copy(model)).final
    if not final.balanced:
        return None
    reaction = in_support_axes(model, np.column_stack([final.reaction, final.reaction_moment]))
    moment = final.diagrams["bending_moment"]
    return [
        float((final.axial_force if one.of_bar else moment if one.of_end else reaction)[one.place])
        for one in unknowns
    ]


def _release(model: Model, unknown: Unknown) -> None:
    name, axis = unknown.element.name, unknown.axis
    if unknown.of_bar:
        model.delete([model.rods[name]])
    elif unknown.of_end:
        rod, kept = model.rods[name], np.arange(2) != axis
        rod.hinged = tuple((np.array(rod.hinged) | ~kept).tolist())
        rod.end_springs = tuple((np.array(rod.end_springs) * kept).tolist())
    elif axis == 2:
        model.particles[name].fixed_rotation, model.particles[name].rotation_spring = False, 0.0
    else:
        particle, kept = model.particles[name], np.arange(2) != axis
        particle.fixed = tuple((np.array(particle.fixed) & kept).tolist())
        particle.support_springs = tuple((np.array(particle.support_springs) * kept).tolist())
