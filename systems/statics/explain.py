"""Motions and rods in words, for messages that name the particle and the direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from components import written
from components.model import Model
from components.wording import cut
from systems.statics.equations import TURNS_ONLY, Array, Flags, Rows, largest

NAMED = 5  # at most so many by name, then "and 7 more"
DIRECTIONS = 3  # at most so many, then "and 7 more"
TAKES_PART = 0.1  # of the largest motion
ONE_WAY = 1e-3  # ratio of a particle's motions across and along, below which it has one direction


def listed(names: Sequence[str]) -> str:
    """Up to NAMED names, as in "B, C and D", and the number of the others."""
    shown = [cut(name) for name in names[:NAMED]]
    if len(names) > NAMED:
        return f"{', '.join(shown)} and {len(names) - NAMED} more"
    return " and ".join(filter(None, [", ".join(shown[:-1]), *shown[-1:]]))


def capitalised(text: str) -> str:
    """A text as the beginning of a sentence."""
    return text[:1].upper() + text[1:]


def rod_names(model: Model, rows: Rows) -> str:
    """Rods as a person calls them: "rods AB and CD", "rod 7"."""
    names = [str(model.rods.column("name")[row]) for row in rows.tolist()]
    if all(name.startswith("rod ") for name in names):
        return listed(names)
    return ("rod " if len(names) == 1 else "rods ") + listed(names)


def cables_named(model: Model) -> str:
    """The subject and verb of a sentence about a model's cables: "Rods AC and BD act"."""
    rows = np.flatnonzero(model.rods.tension_only)
    return f"{capitalised(rod_names(model, rows))} {'acts' if len(rows) == 1 else 'act'}"


def slack_named(model: Model, slack: Flags) -> str:
    """A sentence that names the slack cables, to follow another; "" if there are none."""
    rows = np.flatnonzero(slack)
    if not len(rows):
        return ""
    verb, them = ("is", "it") if len(rows) == 1 else ("are", "them")
    return f" {capitalised(rod_names(model, rows))} {verb} slack; tension {them} if that is not meant."


def divide_named(model: Model, rows: Rows, parts: Rows) -> str:
    """A sentence about rods that bend within themselves, and into how many to divide each; parts: of all rods."""
    names = model.rods.column("name")
    into = [f"{cut(str(names[row]))} into {parts[row]}" for row in rows.tolist()]
    more = f" and {len(into) - NAMED} more" if len(into) > NAMED else ""
    what = f"{capitalised(rod_names(model, rows))} {'bends within itself' if len(rows) == 1 else 'bend within themselves'}"
    into_parts = f"Divide {', '.join(into[:NAMED])}{more}, by the menu of a rod or session.divide."
    return f"{what}, more than one rod can follow. {into_parts}"


def describe_motion(model: Model, modes: Array) -> str:
    """Moving particles and their directions in modes (k, n, 2 or 3): "B and D along x, C in any direction".

    Rotations are named only where no particle moves.
    """
    names = model.particles.column("name")
    turns, modes = modes[:, :, 2:], modes[:, :, :2]
    if largest(modes) <= TURNS_ONLY * largest(turns):
        turning = np.flatnonzero(np.abs(turns).max(axis=(0, 2)) > TAKES_PART * largest(turns))
        return f"{listed([str(names[row]) for row in turning.tolist()])} round itself"
    size = np.sqrt((modes**2).sum(axis=(0, 2)))
    movers = np.flatnonzero(size > TAKES_PART * size.max())
    groups: dict[str, list[str]] = {}
    for row in movers.tolist():
        groups.setdefault(_direction(modes[:, row]), []).append(str(names[row]))
    told = [f"{listed(group)} {direction}" for direction, group in list(groups.items())[:DIRECTIONS]]
    rest = sum(len(group) for group in list(groups.values())[DIRECTIONS:])
    return ", ".join(told) + (f" and {rest} more" if rest else "")


def _direction(motions: Array) -> str:
    """The direction of one particle's motions (k, 2)."""
    _, sizes, ways = np.linalg.svd(motions, full_matrices=False)
    if len(sizes) > 1 and sizes[1] > ONE_WAY * sizes[0]:
        return "in any direction"
    x, y = ways[0]
    if abs(y) < ONE_WAY:
        return "along x"
    if abs(x) < ONE_WAY:
        return "along y"
    if x < 0.0:
        x, y = -x, -y
    return f"along ({x:.2f}, {y:.2f})"


def describe_way(model: Model, motion: Array) -> str:
    """The particles that move most in a motion (n, 2 or 3), and which way: "ball, which moves down"."""
    names = model.particles.column("name")
    size = np.hypot(*motion[:, :2].T)
    far = np.flatnonzero(size > 0.5 * size.max())
    x, y = motion[int(size.argmax()), :2] / size.max()
    if abs(x) < ONE_WAY:
        way = "up" if y > 0.0 else "down"
    elif abs(y) < ONE_WAY:
        way = "to the right" if x > 0.0 else "to the left"
    else:
        way = f"along ({x:.2f}, {y:.2f})"
    moves = "which moves" if len(far) == 1 else "which move"
    return f"{listed([str(names[row]) for row in far])}, {moves} {way}"


def moved(model: Model, before: Array, after: Array) -> str:
    """The particle that moved most between two fields of displacements (m), and its new displacement."""
    names = model.particles.column("name")
    before, after = before[:, :2], after[:, :2]
    change = after - before
    row = int(np.hypot(change[:, 0], change[:, 1]).argmax())
    return f"{names[row]} by {_pair(change[row])}, to the displacement {_pair(after[row])}"


def _pair(vector: Array) -> str:
    return written.place(np.where(np.abs(vector) < 1e-9 * np.abs(vector).max(), 0.0, vector), written.DIGITS)
