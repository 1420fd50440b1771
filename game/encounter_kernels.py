"""The compiled part of encounters: where paths in a step first meet, and the joint impact of a group."""

from __future__ import annotations

from functools import cache
from types import ModuleType

from game.program_cache import compile_module

_SOURCE = '''\
"""Encounters within a step. Generated; safe to delete."""

from numba import njit

entry = njit(error_model="numpy", _nrt=False, cache=True)


@entry
def meeting(h, pairs, kinds, position, before, velocity, after, radius, span):
    return first_meeting(h, pairs, kinds, position, before, velocity, after, radius, span)


@entry
def impact(members, count, restitution, group):
    return strike(members, count, restitution, group)
'''


@cache
def kernels() -> ModuleType:
    """The kernels by name; compiled at the first call of each, or loaded from the cache."""
    from systems.collision.encounter.kernels import first_meeting, strike

    return compile_module(_SOURCE, {"first_meeting": first_meeting, "strike": strike})
