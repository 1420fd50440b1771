"""The compiled part of encounters: where paths in a step first meet, the joint impact of a group, overlaps."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

from game.program.cache import compile_module, is_compiled, note_compiled

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


@entry
def part(first, second, position, displacement, radius, inverse_mass, span, slack):
    return separate(first, second, position, displacement, radius, inverse_mass, span, slack)
'''


def _kernels() -> dict[str, Callable[..., Any]]:
    from systems.collision.kernels.encounter import first_meeting, strike
    from systems.collision.kernels.overlap import separate

    return {"first_meeting": first_meeting, "strike": strike, "separate": separate}


def has_encounters() -> bool:
    """True if the kernels need not be compiled any more, only loaded."""
    return is_compiled(_SOURCE, _kernels())


def note_encounters() -> None:
    """All kernels have been called, and so compiled."""
    note_compiled(kernels())


@cache
def kernels() -> ModuleType:
    """The kernels by name; compiled at the first call of each, or loaded from the cache."""
    return compile_module(_SOURCE, _kernels())
