"""The compiled part of driven collisions: what happens in steps, gaps, joint impacts, overlaps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from components.field import Column
from components.model import Model
from systems.collision.driven.columns import Driven
from systems.collision.driven.kernels.steps import collide
from systems.collision.system import normals, persistent_contacts, support_forces
from systems.program.between import Between
from systems.program.compiler import GeneratedModule, entries_to


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    """The source, and the kernels by the names that it calls them."""
    from systems.collision.driven.kernels import joint_impacts, neighbours
    from systems.collision.kernels import overlap, pairs

    return entries_to(
        {
            "collide": collide,
            "list_pairs": neighbours.list_pairs,
            "gaps": pairs.measure_gaps,
            "resolve": joint_impacts.resolve,
            "part": overlap.separate,
        }
    )


DRIVEN = GeneratedModule("driven_collisions", _contents)


def kernels() -> Any:
    """The kernels by name, in the form that they run in now."""
    return DRIVEN.form


def idle() -> Driven:
    """Arrays of no particles."""
    none, vectors = np.zeros(0), np.zeros((0, 2))
    of_document: dict[str, Any] = dict.fromkeys(("position", "span", "weight"), vectors)
    of_document |= dict.fromkeys(("radius", "size", "restitution", "pull"), none)
    whole = {
        "node": np.zeros(0, dtype=np.int64),
        **dict.fromkeys(("loose", "partners"), np.zeros(0, dtype=np.int64)),
        "first": np.zeros(1, dtype=np.int64),
        "asleep": np.zeros(0, dtype=bool),
    }
    return Driven.empty({**of_document, **whole}, 0, 0, 0)


def _support(model: Model) -> Column:
    contacts, count = persistent_contacts(model), model.particles.count
    if contacts is None:
        return np.zeros((count, 2))
    return support_forces(normals(model, contacts.pairs), contacts.pairs, contacts.forces, count)


BETWEEN = Between(DRIVEN, collide, idle, _support)
