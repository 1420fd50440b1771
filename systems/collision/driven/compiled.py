"""The compiled part of driven collisions: gaps, times of impact, joint impacts, contact forces, overlaps."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

from systems.program.compiler import compile_module

_SOURCE = '''\
"""Driven collisions. Generated; safe to delete."""

from numba import njit

entry = njit(error_model="numpy", _nrt=False, cache=True)


@entry
def gaps(pairs, position, displacement, radius, span, gap, normal):
    measure_gaps(pairs, position, displacement, radius, span, gap, normal)


@entry
def kinds(pairs, contacts, node, position, displacement, radius, span, kinds):
    classify_pairs(pairs, contacts, node, position, displacement, radius, span, kinds)


@entry
def path_deviation(h, before, velocity, after, later, listed, margin, path_error):
    return path_errors(h, before, velocity, after, later, listed, margin, path_error)


@entry
def time_of_impact(h, pairs, kinds, position, before, velocity, after, radius, span, size, path_error):
    return first_impact(h, pairs, kinds, position, before, velocity, after, radius, span, size, path_error)


@entry
def compliance(pairs, normal, pushed, weight, slope):
    compliance_matrix(pairs, normal, pushed, weight, slope)


@entry
def forces(slope, gap, forces, found, matrix, scale, offset, sides, wrong):
    return complementary(slope, gap, forces, found, matrix, scale, offset, sides, wrong)


@entry
def resolve(members, count, restitution, tolerance, group):  # one entry, so that what both share is compiled once
    if restitution < 0.0:
        separate_motion(members, count, tolerance, group)
    else:
        resolve_impact(members, count, restitution, group)


@entry
def part(first, second, position, displacement, radius, inverse_mass, span, slack):
    return separate(first, second, position, displacement, radius, inverse_mass, span, slack)
'''


def contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    """The source, and the kernels by the names that it calls them."""
    from systems.collision.kernels import driven, pairs
    from systems.collision.kernels.complementarity import complementary
    from systems.collision.kernels.overlap import separate

    parts = (
        pairs.measure_gaps,
        pairs.classify_pairs,
        pairs.compliance_matrix,
        driven.path_errors,
        driven.first_impact,
        driven.separate_motion,
        driven.resolve_impact,
        complementary,
        separate,
    )
    return _SOURCE, {part.py_func.__name__: part for part in parts}


@cache
def kernels() -> ModuleType:
    """The kernels by name; compiled at the first call of each, or loaded from the cache."""
    return compile_module(*contents())
