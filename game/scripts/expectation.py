"""Expectations: what a session is to show, such as rods.AB.axial_force ≈ -28.34 ± 0.01."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from game.session import Session

_EXPECTATION = re.compile(
    r"^(?P<path>.+?)\s*(?P<relation>≈|~|=|<|>)\s*(?P<value>.+?)(?:\s*(?:±|\+-)\s*(?P<slack>\S+))?\s*$"
)


class ExpectationError(AssertionError):
    """Something is not as expected; the message says what, and what it is instead."""


def expect(session: Session, text: str) -> None:
    """Raise ExpectationError unless something is as a text says. Raises ValueError, LookupError for bad texts."""
    for expected, got in check(session, text):
        raise ExpectationError(f"expected {expected}, got {got}")


def check(session: Session, text: str) -> Iterator[tuple[str, Any]]:
    """(expected, got) if something is not as a text says."""
    match = _EXPECTATION.match(text)
    if match is None:
        raise ValueError(f"'{text}' is no expectation; write it like rods.AB.axial_force ≈ -28.34 ± 0.01.")
    got = read(session, match["path"])
    if not _holds(got, match["relation"], match["value"], match["slack"]):
        yield text, got


def _holds(got: Any, relation: str, value: str, slack: str | None) -> bool:
    if isinstance(got, bool | str) or got is None:
        return relation == "=" and str(got).lower() == value.strip("\"'").lower()
    if isinstance(got, tuple):
        raise ValueError(f"it has two components, {got}; ask for .x or .y.")
    try:
        wanted, within = float(value), float(slack or 0.0)
    except ValueError:
        said = f"{value} ± {slack}" if slack else value
        raise ValueError(f"it is {got}, which cannot be compared with '{said}'; write a number.") from None
    if relation in "<>":
        return bool(got < wanted if relation == "<" else got > wanted)
    tolerance = within if slack is not None or relation == "=" else 1e-9 * abs(wanted)
    return math.isfinite(got) and abs(got - wanted) <= tolerance


def read(session: Session, path: str) -> Any:
    """A quantity by its path: rods.AB.axial_force, particles.B.displacement.y, energy.imbalance, scene."""
    head, _, rest = path.strip().partition(".")
    if head in ("scene", "time", "message"):
        return getattr(session, head)
    if head == "energy":
        return _one_of(session, session.energy.as_dict(), rest, "energies")
    if head == "force_method":
        return _of_force_method(session, rest)
    if head == "count":
        return len(_one_of(session, session.model.tables, rest, "tables"))
    if head not in session.model.tables:
        raise LookupError(session.model.missing("quantities", head, session.model.tables))
    table = session.model.tables[head]
    component = None
    if rest.endswith((".x", ".y")):
        rest, component = rest[:-2], "xy".index(rest[-1])
    name, _, field = rest.rpartition(".")
    if field not in table.fields:
        raise LookupError(session.model.missing(f"quantities of {head}", field, table.fields))
    if not name and not table.kind.single:
        raise LookupError(f"{path} names no {table.kind.noun}; write {head}.NAME.{rest}.")
    value = getattr(table[name] if name else table[0], field)
    return value if component is None else value[component]


def _one_of(session: Session, found: Mapping[str, Any], name: str, what: str) -> Any:
    if name not in found:
        raise LookupError(session.model.missing(what, name, found))
    return found[name]


def _of_force_method(session: Session, quantity: str) -> Any:
    """A quantity of the force method: part, unknown, force, delta_real, … of the last unknown; real.AC, base.AC.

    superposed.AC is set 2 + set 3, which is to equal real.AC, set 1.
    """
    from game.force_method import words  # which scipy comes with

    guide = getattr(session.scenes.active, "guide", None)
    if guide is None:
        raise LookupError("the force method is not going on; press K in pause first.")
    if quantity == "unknown":
        return guide.unknown.name if guide.unknown else None
    if quantity == "part":
        return guide.part
    if quantity == "message":
        return words.message(guide)
    what, _, rod = quantity.partition(".")
    if guide.solution is not None and rod:  # a row of the final table
        return float(getattr(guide.solution, what).axial_force[guide.model.rods[rod].row])
    if guide.solution is None:
        raise LookupError("nothing is released yet; pick an unknown in part 2 first.")
    if quantity == "exact_force":
        return guide.exact[-1] if guide.exact is not None else None
    return float(getattr(guide.solution, quantity).ravel()[-1])
