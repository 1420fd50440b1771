"""The compiled part of encounters: gaps, where paths in a step first meet, joint impacts, forces, overlaps."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

from systems.program.compiler import compile_module

_SOURCE = '''\
"""Encounters within a step. Generated; safe to delete."""

from numba import njit

entry = njit(error_model="numpy", _nrt=False, cache=True)


@entry
def gaps(pairs, position, displacement, radius, span, gap, normal):
    measure_gaps(pairs, position, displacement, radius, span, gap, normal)


@entry
def kinds(pairs, contacts, node, position, displacement, radius, span, kinds):
    tell_kinds(pairs, contacts, node, position, displacement, radius, span, kinds)


@entry
def sway(h, before, velocity, after, later, listed, margin, sway):
    return bend(h, before, velocity, after, later, listed, margin, sway)


@entry
def meeting(h, pairs, kinds, position, before, velocity, after, radius, span, size, sway):
    return first_meeting(h, pairs, kinds, position, before, velocity, after, radius, span, size, sway)


@entry
def compliance(pairs, normal, pushed, weight, slope):
    yield_to_forces(pairs, normal, pushed, weight, slope)


@entry
def forces(slope, gap, forces, found, matrix, scale, offset, sides, wrong):
    return complementary(slope, gap, forces, found, matrix, scale, offset, sides, wrong)


@entry
def push(members, count, restitution, tolerance, group):  # one entry, so that what both share is compiled once
    if restitution < 0.0:
        hold_apart(members, count, tolerance, group)
    else:
        strike(members, count, restitution, group)


@entry
def part(first, second, position, displacement, radius, inverse_mass, span, slack):
    return separate(first, second, position, displacement, radius, inverse_mass, span, slack)
'''


def contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    """The source, and the kernels by the names that it calls them."""
    from systems.collision.kernels import driven as encounter
    from systems.collision.kernels import pairs
    from systems.collision.kernels.complementarity import complementary
    from systems.collision.kernels.overlap import separate

    parts = (
        pairs.measure_gaps,
        pairs.tell_kinds,
        pairs.yield_to_forces,
        encounter.bend,
        encounter.first_meeting,
        encounter.hold_apart,
        encounter.strike,
        complementary,
        separate,
    )
    return _SOURCE, {part.py_func.__name__: part for part in parts}


@cache
def kernels() -> ModuleType:
    """The kernels by name; compiled at the first call of each, or loaded from the cache."""
    return compile_module(*contents())
