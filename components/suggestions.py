"""Suggestions: what to say about a name that does not exist, with the nearest one that does."""

from __future__ import annotations

import difflib
from collections.abc import Collection

from pinjoint.components.language import tr
from pinjoint.components.wording import LONGEST, cut

_FEW = 50  # names; so few are listed: all keys of a rod are


def nearest(name: str, names: Collection[str], cutoff: float = 0.6) -> str | None:
    """The one of some names that comes nearest, whatever its capitals; None if none comes near."""
    folded = {known.casefold(): known for known in names}
    found = difflib.get_close_matches(name[:LONGEST].casefold(), folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else None


def remedy(name: str, names: Collection[str]) -> str:
    """The end of a sentence about a name that is not among some: the nearest name, or all of them."""
    few = len(names) <= _FEW
    if near := nearest(name, names, cutoff=0.6 if few else 0.4):
        return tr("did you mean '{name}'?", name=cut(near))
    if not few:
        return tr("there are {count} to choose from.", count=len(names))
    return tr("choose one of {names}.", names=", ".join(map(cut, names))) if names else tr("there are none.")


def missing(group: str, name: str, names: Collection[str]) -> str:
    """The sentence that says that a name is not in a group, and which one comes nearest."""
    return tr(
        "There is no '{name}' among the {group}; {remedy}",
        name=cut(name),
        group=tr(group),
        remedy=remedy(name, names),
    )
