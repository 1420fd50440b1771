"""The compiled part of driven collisions: gaps, times of impact, joint impacts, contact forces, overlaps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from systems.program.compiler import GeneratedModule, entries_to


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    """The source, and the kernels by the names that it calls them."""
    from systems.collision.kernels import complementarity, driven, overlap, pairs

    return entries_to(
        {
            "gaps": pairs.measure_gaps,
            "kinds": pairs.classify_pairs,
            "path_deviation": driven.path_errors,
            "time_of_impact": driven.first_impact,
            "compliance": pairs.compliance_matrix,
            "forces": complementarity.complementary,
            "resolve": driven.resolve,
            "part": overlap.separate,
        }
    )


DRIVEN = GeneratedModule("driven_collisions", _contents)


def kernels() -> Any:
    """The kernels by name, in the form that they run in now."""
    return DRIVEN.form
