"""The compiled part of driven collisions: what happens in steps, gaps, joint impacts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pinjoint.components.field import Column
from pinjoint.components.model import Model
from pinjoint.components.obstacles import obstacles
from pinjoint.systems.broad_phase import gaps
from pinjoint.systems.collision.columns import Grid, partners_of
from pinjoint.systems.collision.driven.columns import Driven, Listing
from pinjoint.systems.collision.driven.kernels.neighbours import list_pairs
from pinjoint.systems.collision.driven.kernels.steps import collide
from pinjoint.systems.collision.system import persistent_contacts
from pinjoint.systems.program.compiler import Between, GeneratedModule, entries_to


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    """The source, and the kernels by the names that it calls them."""
    source, kernels = entries_to({"collide": collide, "list_pairs": list_pairs})
    layout = [_layout(arrays) for arrays in idle()]  # what is kept on disk is of no use for another
    return f"{source}# arrays: {layout}\n", kernels


def _layout(arrays: Any) -> Any:
    """The names, types and dimensions of arrays, in named tuples of their own where they are."""
    if isinstance(arrays, np.ndarray):
        return arrays.dtype.str, arrays.ndim
    return [(name, _layout(held)) for name, held in zip(arrays._fields, arrays, strict=True)]


DRIVEN = GeneratedModule("driven_collisions", _contents)


def idle() -> tuple[Driven, Listing]:
    """Arrays of no particles."""
    none, vectors = np.zeros(0), np.zeros((0, 2))
    of_document: dict[str, Any] = dict.fromkeys(("position", "span", "weight"), vectors)
    of_document |= dict.fromkeys(("radius", "size", "restitution", "pull"), none)
    whole = {
        "node": np.zeros(0, dtype=np.int64),
        "loose": np.zeros(0, dtype=np.int64),
        "asleep": np.zeros(0, dtype=bool),
    }
    driven = Driven.empty({**of_document, **whole}, 0, 0, 0)
    return driven, Listing(*partners_of(0, ()), driven.pairs, Grid.empty(0, 1))


def _support(model: Model) -> Column:
    contacts, particles = persistent_contacts(model), model.particles
    total = np.zeros((particles.count, 2))
    if contacts is not None:
        place, pairs = particles.position + particles.displacement, contacts.pairs
        _, normal = gaps(place, particles.radius, pairs, obstacles(model))
        push = normal * (0.001 * contacts.forces)[:, None]
        for d in range(2):
            # obstacles come after them
            total[:, d] = np.bincount(pairs[:, 1], push[:, d], len(total))[: len(total)]
            total[:, d] -= np.bincount(pairs[:, 0], push[:, d], len(total))
    return total


BETWEEN = Between(DRIVEN, (collide, list_pairs), idle, _support)
