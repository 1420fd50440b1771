"""Diagrams: axial force, shear and bending moment along rods, by statics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pinjoint.components.field import Column
from pinjoint.components.table import Table

NAMES = ("end_axial_force", "shear", "bending_moment", "end_rotation", "largest_moment")


def diagrams(
    rods: Table[Any],
    axis: Column,
    length: Column,
    chord: Column,
    rotation: Column,
    forces: tuple[Column, Column],
    *,
    share: float = 1.0,
    first_order: bool = False,
) -> Mapping[str, Column]:
    """The columns NAMES of all rods, (rods, 2), with so much of their distributed forces.

    axis, length, chord: directions (rods, 2), lengths (m) and rotations (rad) of the chords; rotation: of the particles at
    both ends, (rods, 2). forces: axial (rods,), and moments on both ends, counter-clockwise (rods, 2).
    first_order: axes count as straight where forces act on them.
    """
    axial_force, moment = forces
    rest, bent = rods.rest_length, 0.0 if first_order else 1.0
    tangential, transverse = along_and_across(share * rods.distributed_force, axis)
    slopes = rigid_slopes(rods, rotation, chord)
    couple = -bent * tangential * (rods.load_shares * slopes).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        shear = np.where(length > 0.0, (moment.sum(axis=1) + couple) / length, 0.0)
    ahead = np.array([-0.5, 0.5])
    slopes = all_slopes(rods, slopes, transverse)
    bending_moment = moment * [-1.0, 1.0]
    return {
        "end_axial_force": axial_force[:, None] - ahead * (tangential * rest)[:, None],
        "shear": shear[:, None] + ahead * (transverse * rest)[:, None],
        "bending_moment": bending_moment,
        "end_rotation": chord[:, None] + slopes,
        "largest_moment": _largest_moment(
            bending_moment, slopes, bent * axial_force * length, transverse * rest * length, length
        ),
    }


def along_and_across(force: Column, axis: Column) -> tuple[Column, Column]:
    """Parts of forces (rods, 2) along axes (rods, 2) and to their left, (rods,)."""
    return (force * axis).sum(axis=1), force[:, 1] * axis[:, 0] - force[:, 0] * axis[:, 1]


def rigid_slopes(rods: Table[Any], rotation: Column, chord: Column) -> Column:
    """Slopes to the chords of those ends that are joined rigidly, 0 at others; likewise of rates; (rods, 2).

    rotation: of the particles at both ends, (rods, 2). chord: (rods,).
    """
    return np.where(rods.turning_shares > 0.0, rotation - chord[:, None], 0.0)


def all_slopes(rods: Table[Any], slopes: Column, transverse: Column) -> Column:
    """Slopes of both ends of every rod, those at hinges by M = 0 of its cubic and a transverse force (kN/m)."""
    length, stiffness = rods.rest_length, rods.bending_stiffness
    rigid, bent = rods.turning_shares > 0.0, stiffness > 0.0
    by_force = np.divide(transverse * length**3, 48.0 * stiffness, out=np.zeros(len(length)), where=bent)
    warped = np.where(bent, 0.5 * rods.thermal_expansion * rods.temperature_gradient * length, 0.0)
    signs = np.array([1.0, -1.0])
    free = signs * warped[:, None]
    loaded = signs * by_force[:, None]
    beyond = (slopes - free)[:, ::-1]  # of the other end
    hinged = free + np.where(rigid[:, ::-1], loaded - 0.5 * beyond, 2.0 * loaded)
    return np.where(rigid, slopes, hinged)


def cubic(start: Column, end: Column) -> Column:
    """The deflection φ_s ξ (1 − ξ)² − φ_e ξ² (1 − ξ) between ends with these slopes, lowest coefficient first, (rods, 4)."""
    return np.stack([np.zeros(len(start)), start, -(2.0 * start + end), start + end], axis=1)


def moments_along(ends: Column, load: Column, by_thrust: Column) -> Column:
    """M(ξ) = M_s (1 − ξ) + M_e ξ − ½ q L₀ L ξ (1 − ξ) + N v(ξ) of rods, lowest coefficient first, (rods, 4).

    ends: M_s and M_e, (rods, 2). load: q L₀ L, (rods,). by_thrust: N v, (rods, 4).
    """
    start, end = ends.T
    straight = np.stack([start, end - start - 0.5 * load, 0.5 * load, np.zeros(len(start))], axis=1)
    return straight + by_thrust


def _largest_moment(ends: Column, slopes: Column, thrust: Column, load: Column, length: Column) -> Column:
    """The bending moment of largest size, and its distance from the start (m), of every rod; thrust: N L; load: q L₀ L."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        start, linear, square, cube = moments_along(ends, load, thrust[:, None] * cubic(*slopes.T)).T
        root = np.sqrt(np.maximum(square**2 - 3.0 * cube * linear, 0.0))
        both = -(square + np.copysign(root, square))
        found = np.stack([np.zeros_like(start), np.ones_like(start), both / (3.0 * cube), linear / both])
    found = np.where((found > 0.0) & (found <= 1.0), found, 0.0)
    values = start + found * (linear + found * (square + found * cube))
    values[1] = ends[:, 1]
    chosen, rows = np.abs(values).argmax(axis=0), np.arange(len(start))
    return np.stack([values[chosen, rows], found[chosen, rows] * length], axis=1)
