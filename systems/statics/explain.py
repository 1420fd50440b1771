"""Motions and rods in words, for messages that name the particle and the direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components import language, written
from pinjoint.components.arrays import Array, Flags, Rows
from pinjoint.components.language import begun, joined, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.wording import as_said, cut
from pinjoint.systems.statics.equations import TURNS_ONLY, largest
from pinjoint.systems.statics.response import of_axes

NAMED = 5  # at most so many by name, then "and 7 more"
DIRECTIONS = 3  # at most so many, then "and 7 more"
TAKES_PART = 0.1  # of the largest motion
ONE_WAY = 1e-3  # ratio of a particle's motions across and along, below which it has one direction


def listed(names: Sequence[str]) -> str:
    """Up to NAMED names, as in "B, C and D", and the number of the others."""
    return _few([as_said(Particle.noun, as_said(Rod.noun, cut(name))) for name in names])


def _few(parts: Sequence[str]) -> str:
    if len(parts) > NAMED:
        return tr("{names} and {count} more", names=joined(parts[:NAMED], ", "), count=len(parts) - NAMED)
    return language.listed(parts)


def rod_names(model: Model, rows: Rows) -> str:
    """Rods as a person calls them: "rods AB and CD", "rod 7"."""
    names = [str(model.rods.column("name")[row]) for row in rows.tolist()]
    if all(name.startswith("rod ") for name in names):
        return listed(names)
    return plural("rod {names}", "rods {names}", len(names), names=listed(names))


def slack_named(model: Model, slack: Flags) -> str:
    """Sentences that name the slack cables, and the struts that have buckled; "" if there are none."""
    struts = np.isfinite(model.rods.buckling_load)
    slack = of_axes(slack)[: len(struts)]
    said = []
    if len(rows := np.flatnonzero(slack & ~struts)):
        said += [
            plural(
                "{rods} is slack; tighten it if that is not intended.",
                "{rods} are slack; tighten them if that is not intended.",
                len(rows),
                rods=begun(rod_names(model, rows)),
            )
        ]
    if len(rows := np.flatnonzero(slack & struts)):
        rods = begun(rod_names(model, rows))
        said += [plural("{rods} has buckled.", "{rods} have buckled.", len(rows), rods=rods)]
    return joined(said)


def hinges_named(model: Model, flowing: Flags) -> str:
    """Where plastic hinges turn, as in "at B and C", and which rods yield along their axes; "" if no end flows."""
    if flowing.ndim == 1 or not flowing[:, 1:].any():
        return ""
    joints = np.unique(model.rods.between[flowing[: model.rods.count, 1:]])
    where = tr("at {particles}", particles=listed([str(model.particles.names[row]) for row in joints.tolist()]))
    rows = np.flatnonzero(of_axes(flowing))
    return tr("{hinges} while {rods} yields", hinges=where, rods=rod_names(model, rows)) if len(rows) else where


def divide_named(model: Model, rows: Rows, parts: Rows) -> str:
    """A sentence about rods that bend within themselves, and into how many to divide each; parts: of all rods."""
    names = model.rods.column("name")
    into = _few(
        [
            tr("{rod} into {parts}", rod=listed([str(names[row])]), parts=int(parts[row]))
            for row in rows.tolist()
        ]
    )
    return plural(
        "{rods} bends more between its ends than a single rod can represent. Divide {parts}, with"
        " the menu of the rod or session.divide.",
        "{rods} bend more between their ends than single rods can represent. Divide {parts},"
        " with the menu of a rod or session.divide.",
        len(rows),
        rods=begun(rod_names(model, rows)),
        parts=into,
    )


def describe_motion(model: Model, modes: Array) -> str:
    """Moving particles and their directions in modes (k, n, 2 or 3): "B and D along x, C in any direction".

    Rotations are named only where no particle moves.
    """
    names = model.particles.column("name")
    turns, modes = modes[:, :, 2:], modes[:, :, :2]
    if largest(modes) <= TURNS_ONLY * largest(turns):
        turning = np.flatnonzero(np.abs(turns).max(axis=(0, 2)) > TAKES_PART * largest(turns))
        those = [str(names[row]) for row in turning.tolist()]
        return plural("{names} about itself", "{names} about themselves", len(those), names=listed(those))
    size = np.sqrt((modes**2).sum(axis=(0, 2)))
    movers = np.flatnonzero(size > TAKES_PART * size.max())
    groups: dict[str, list[str]] = {}
    for row in movers.tolist():
        groups.setdefault(_direction(modes[:, row]), []).append(str(names[row]))
    told = joined(
        (joined([listed(group), direction]) for direction, group in list(groups.items())[:DIRECTIONS]), ", "
    )
    rest = sum(len(group) for group in list(groups.values())[DIRECTIONS:])
    return tr("{names} and {count} more", names=told, count=rest) if rest else told


def _direction(motions: Array) -> str:
    """The direction of one particle's motions (k, 2)."""
    _, sizes, ways = np.linalg.svd(motions, full_matrices=False)
    if len(sizes) > 1 and sizes[1] > ONE_WAY * sizes[0]:
        return tr("in any direction")
    x, y = ways[0]
    if abs(y) < ONE_WAY:
        return tr("along x")
    if abs(x) < ONE_WAY:
        return tr("along y")
    if x < 0.0:
        x, y = -x, -y
    return tr("along ({x}, {y})", x=written.number(x, 2), y=written.number(y, 2))


def nothing_stops(model: Model, motion: Array) -> str:
    """The sentence about the particles that move most in a motion (n, 2 or 3), which nothing stops."""
    names = model.particles.column("name")
    size = np.hypot(*motion[:, :2].T)
    far = np.flatnonzero(size > 0.5 * size.max())
    x, y = motion[int(size.argmax()), :2] / size.max()
    if abs(x) < ONE_WAY:
        way = tr("upwards") if y > 0.0 else tr("downwards")
    elif abs(y) < ONE_WAY:
        way = tr("to the right") if x > 0.0 else tr("to the left")
    else:
        way = tr("along ({x}, {y})", x=written.number(x, 2), y=written.number(y, 2))
    return plural(
        "{names} moves {way} and nothing stops it. Put something in its way, or hold it with a support.",
        "{names} move {way} and nothing stops them. Put something in their way, or hold them with supports.",
        len(far),
        names=listed([str(names[row]) for row in far]),
        way=way,
    )


def moved(model: Model, before: Array, after: Array) -> str:
    """The particle that moved most between two fields of displacements (m), and its new displacement."""
    names = model.particles.column("name")
    before, after = before[:, :2], after[:, :2]
    change = after - before
    row = int(np.hypot(change[:, 0], change[:, 1]).argmax())
    return tr(
        "{particle} moves by {change}, to the displacement {displacement}",
        particle=listed([str(names[row])]),
        change=_pair(change[row]),
        displacement=_pair(after[row]),
    )


def _pair(vector: Array) -> str:
    return written.place(np.where(np.abs(vector) < 1e-9 * np.abs(vector).max(), 0.0, vector), written.DIGITS)
