"""Expectations: conditions on a session as texts, such as rods.AB.axial_force ≈ -28.34 ± 0.01."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Iterator, Mapping
from typing import Any, Protocol

from components.language import english, tr
from components.suggestions import missing
from components.wording import quoted
from game.paths import Readable, locate_one

_OF_SESSION = ("scene", "time", "message")
_SECTIONS = ("energy", "force_method", "count")
_NUMBERS = ("force", "delta_real", "delta_base", "delta_unit")  # of the force method
_SETS = ("real", "base", "superposed")

_EXPECTATION = re.compile(
    r"^(?P<path>.+?)\s*(?P<relation>[≈~=<>!]+)\s*(?P<value>.+?)(?:\s*(?:±|\+/?-)\s*(?P<slack>\S+))?\s*$"
)
_ORDERS = {"<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge}
_SAMENESS = ("=", "≈", "~")
_NOTHING = ("none", "null")  # texts for no value


class ExpectationError(AssertionError):
    """An expectation that does not hold; the message gives the expected and the present value."""


class Shown(Readable, Protocol):
    """The part of a session that expectations read."""

    @property
    def scene(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def scenes(self) -> Any: ...


def expect(session: Shown, text: str) -> None:
    """Raise ExpectationError unless a text holds; ValueError or LookupError if it cannot be tested."""
    for expected, got in check(session, text):
        raise ExpectationError(tr("expected {expected}, got {got}", expected=expected, got=str(got)))


def check(session: Shown, text: str) -> Iterator[tuple[str, Any]]:
    """(expected, got) if a text does not hold. Raises ValueError, LookupError."""
    match = _EXPECTATION.match(text)
    if match is None:
        raise ValueError(
            tr("'{text}' is not an expectation; write it like rods.AB.axial_force ≈ -28.34 ± 0.01.", text=text)
        )
    got = english(read(session, match["path"]))  # a script is the same in every language
    if not _holds(got, match["relation"], match["value"], match["slack"]):
        yield text, got


def _holds(got: Any, relation: str, value: str, slack: str | None) -> bool:
    if relation not in (*_SAMENESS, *_ORDERS):
        raise ValueError(
            tr(
                "'{relation}' does not compare anything; write one of {relations}.",
                relation=relation,
                relations=", ".join((*_SAMENESS, *_ORDERS)),
            )
        )
    if isinstance(got, bool | str) or got is None:
        if relation in _ORDERS:
            raise ValueError(
                tr(
                    "it is {value}, which is not a number; compare it with =, or with ≈ for a part of a text.",
                    value=quoted(got),
                )
            )
        said, wanted_text = (_typed(text) for text in (str(got), value.strip("\"'")))
        if got is None:
            return wanted_text in _NOTHING
        return said == wanted_text if relation == "=" else isinstance(got, str) and wanted_text in said
    if isinstance(got, tuple):
        raise ValueError(tr("it has two components, {value}; add .x or .y.", value=str(got)))
    if value.lower() in _NOTHING:
        return False
    try:
        wanted, within = float(value), float(slack or 0.0)
    except ValueError:
        said = f"{value} ± {slack}" if slack else value
        raise ValueError(
            tr(
                "it is {value}, which cannot be compared with '{wanted}'; write a number.",
                value=str(got),
                wanted=said,
            )
        ) from None
    if not within >= 0.0:
        raise ValueError(tr("± {tolerance}: write a tolerance of at least 0.", tolerance=slack))
    if relation in _ORDERS:
        return bool(_ORDERS[relation](got, wanted))
    tolerance = within if slack is not None or relation == "=" else 1e-9 * abs(wanted)
    return math.isfinite(got) and abs(got - wanted) <= tolerance


def _typed(text: str) -> str:
    """A text as it is typed, so that neither capitals nor real minus signs matter."""
    return text.lower().replace("−", "-")


def read(session: Shown, path: str) -> Any:
    """A quantity by its path: rods.AB.axial_force, particles.B.displacement.y, energy.imbalance, scene."""
    head, _, rest = path.strip().partition(".")
    if head in _OF_SESSION:
        return getattr(session, head)
    if head == "energy":
        return _one_of(session.energy.as_dict(), rest, "energies")
    if head == "force_method":
        return _of_force_method(session, rest)
    if head == "count":
        return len(_one_of(session.model.tables, rest, "tables"))
    if head not in session.model.tables:
        raise LookupError(missing("quantities", head, [*_OF_SESSION, *_SECTIONS, *session.model.tables]))
    target = locate_one(session.model, path.strip())
    return target.part(getattr(target.handles[0], target.field.name))


def _one_of(found: Mapping[str, Any], name: str, what: str) -> Any:
    if name not in found:
        raise LookupError(missing(what, name, found))
    return found[name]


def _of_force_method(session: Shown, quantity: str) -> Any:
    """A quantity of the force method: part, unknown, force, delta_real, … of the last unknown; force in a set.

    real.AC is the axial force of rod AC in set 1, base.AC in set 2, superposed.AC in set 2 + set 3.
    """
    guide = getattr(session.scenes.active, "guide", None)
    if quantity == "message" and session.scene == "force method":
        return session.scenes.active.message
    if guide is None:
        raise LookupError(tr("the force method is not open; press K in pause first."))
    if quantity == "unknown":
        return guide.unknown.name if guide.unknown else None
    if quantity == "part":
        return guide.part
    if guide.solution is None:
        raise LookupError(tr("no redundant is chosen yet; choose one in part 2 first."))
    what, _, rod = quantity.partition(".")
    if rod:  # a row of the final table
        of_set = _one_of({name: getattr(guide.solution, name) for name in _SETS}, what, "sets")
        return float(of_set.axial_force[guide.model.rods[rod].row])
    if quantity == "exact_force":
        return guide.exact[-1] if guide.exact is not None else None
    found = {name: getattr(guide.solution, name) for name in _NUMBERS}
    return float(_one_of(found, quantity, "quantities of the force method").ravel()[-1])
