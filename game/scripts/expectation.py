"""Expectations: conditions on a session as texts, such as rods.AB.axial_force ≈ -28.34 ± 0.01."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from pinjoint.collapse_steps import collapse_steps
from pinjoint.components.field import ENDS
from pinjoint.components.handle import Handle
from pinjoint.components.language import english, listed, marked
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.model import Model
from pinjoint.components.view import View
from pinjoint.components.wording import cut, missing, quoted
from pinjoint.paths import PathError, locate, locate_one, readable

_OF_SESSION = ("scene", "time", "message")
_SECTIONS = ("energy", "force_method", "displacement_method", "count", "statics", "view")

_EXPECTATION = re.compile(
    r"^(?P<path>.+?)\s*(?P<relation>[≈~=<>!]+)\s*(?P<value>.+?)(?:\s*(?:±|\+/?-)\s*(?P<slack>\S+))?\s*$"
)
_ORDERS = {"<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge}
_SAMENESS = ("=", "≈", "~")
_NOTHING = ("none", "null")  # texts for no value


def check(session: Any, text: str) -> Iterator[tuple[str, Any]]:
    """(expected, got) if a text does not hold. Raises ValueError, LookupError."""
    path, relation, value, slack = parts_of(text)
    got = english(read(session, path))  # a script is the same in every language
    if not compared(got, relation, value, slack):
        yield text, got


def parts_of(text: str) -> tuple[str, str, str, str | None]:
    """Path, relation, value and slack of an expectation. Raises ValueError."""
    match = _EXPECTATION.match(text)
    if match is None:
        raise WrongValue(
            "'{text}' is not an expectation; write it like rods.AB.axial_force ≈ -28.34 ± 0.01.", text=text
        )
    return match["path"], match["relation"], match["value"], match["slack"]


def compared(got: Any, relation: str, value: str, slack: str | None) -> bool:
    """True if a value is so related to what an expectation says. Raises ValueError."""
    if relation not in (*_SAMENESS, *_ORDERS):
        raise WrongValue(
            "'{relation}' does not compare anything; write one of {relations}.",
            relation=relation,
            relations=", ".join((*_SAMENESS, *_ORDERS)),
        )
    if isinstance(got, bool | str) or got is None:
        if relation in _ORDERS:
            raise WrongValue(
                "it is {value}, which is not a number; compare it with =, or with ≈ for a part of a text.",
                value=quoted(got),
            )
        # As typed: neither capitals nor real minus signs matter.
        said, wanted_text = (text.lower().replace("−", "-") for text in (str(got), value.strip("\"'")))
        if got is None:
            return wanted_text in _NOTHING
        return said == wanted_text if relation == "=" else isinstance(got, str) and wanted_text in said
    if isinstance(got, tuple):
        raise WrongValue("it has two components, {value}; add .x or .y.", value=str(got))
    if value.lower() in _NOTHING:
        return False
    try:
        wanted, within = float(value), float(slack or 0.0)
    except ValueError:
        said = f"{value} ± {slack}" if slack else value
        raise WrongValue(
            "it is {value}, which cannot be compared with '{wanted}'; write a number.",
            value=str(got),
            wanted=said,
        ) from None
    if not within >= 0.0:
        raise WrongValue("± {tolerance}: write a tolerance of at least 0.", tolerance=slack)
    if relation in _ORDERS:
        return bool(_ORDERS[relation](got, wanted))
    tolerance = within if slack is not None or relation == "=" else 1e-9 * abs(wanted)
    return math.isfinite(got) and abs(got - wanted) <= tolerance


def read(session: Any, path: str) -> Any:
    """A quantity by its path: rods.AB.axial_force, max rods.*.axial_force, statics.degree, energy.imbalance, scene."""
    word, _, of_all = path.strip().partition(" ")
    if word in OVER_ALL and of_all:
        values = [value for _, value in each(session, of_all)]
        return float(OVER_ALL[word](values)) if values else math.nan
    head, _, rest = path.strip().partition(".")
    if head in _OF_SESSION:
        return getattr(session, head)
    if head == "energy":
        return _one_of(session.energy.as_dict(), rest, "energies")
    if head == "force_method":
        return _of_force_method(session, rest)
    if head == "displacement_method":
        return _of_displacement_method(session, rest)
    if head == "statics":
        assessed = {name: partial(of, session) for name, of in _ASSESSED.items()}
        of_model = {name: partial(of, session.model) for name, of in STATICS.items()}
        return _one_of(assessed | of_model, rest, "quantities of statics")()
    if head == "view":
        return _one_of(_seen(session.view), rest, "parts of the view")
    if head == "count":
        return len(_one_of(session.model.tables, rest, "tables"))
    if head not in session.model.tables:
        raise LookupError(
            missing(marked("quantities"), head, [*_OF_SESSION, *_SECTIONS, *session.model.tables])
        )
    target = locate_one(session.model, path.strip())
    return target.part(getattr(target.handles[0], target.field.name))


def each(session: Any, path: str) -> list[tuple[Handle, float]]:
    """The elements that a path such as rods.*.axial_force names, with their numbers; without those that have none."""
    target, rest = locate(session.model, path.strip(), readable)
    if rest:
        raise PathError("{path}: leave out '{rest}', which follows the path.", path=cut(path), rest=cut(rest))
    values = [(handle, target.part(getattr(handle, target.field.name))) for handle in target.handles]
    if target.field.axes == ENDS and not target.axis:
        values = [(handle, value) for handle, both in values for value in both]
    wrong = next((value for _, value in values if not isinstance(value, int | float | None)), None)
    if wrong is not None:
        if not target.field.shape:
            raise PathError("{path} is {value}, not a number.", path=cut(path), value=wrong)
        parts = [f"{target.key}.{axis}" for axis in target.field.axes]
        raise PathError(
            "{path} is {value}; name one number: {parts}.", path=cut(path), value=wrong, parts=listed(parts)
        )
    return [(handle, float(value)) for handle, value in values if value is not None]


OVER_ALL: dict[str, Callable[[Sequence[float]], float]] = {  # of what a path with * names
    "max": max,
    "min": min,
    "sum": math.fsum,
    "largest": lambda values: max(map(abs, values)),
}


def _frequency(model: Model) -> float:
    """The lowest natural frequency (Hz); NaN if nothing can vibrate."""
    from pinjoint.systems.statics.vibration import Vibrations  # scipy

    hertz = Vibrations.of(model).hertz
    return float(hertz[0]) if len(hertz) else math.nan


def _buckling(model: Model) -> float:
    """The lowest load factor of linear buckling; NaN if there is none, or only an upper bound."""
    from pinjoint.systems.statics.buckling import Buckling  # scipy

    found = Buckling.of(model, 1)
    return float(found.factors[0]) if len(found.factors) and not found.coarse else math.nan


def _first_yield(model: Model) -> float:
    """The load factor in first order at which something first yields, such as a plastic hinge; NaN if nothing can."""
    steps = collapse_steps(model)
    return float(steps.columns[0].values[0]) if steps is not None else math.nan


def _collapse(model: Model) -> float:
    """The collapse load factor by limit analysis."""
    from pinjoint.systems.statics.limit_analysis import LimitLoad  # scipy

    return LimitLoad.of(model).factor


def _width(model: Model) -> float:
    """How far the joints reach across the direction in which they reach farthest (m): 0 where they lie on one line."""
    points = model.particles.position
    if not len(points):
        return 0.0
    across = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][-1]
    return float(np.ptp(points @ across)) if len(points) > 1 else 0.0


def _in_equilibrium(session: Any) -> bool:
    """Whether what is shown is: the solution of statics, or the state."""
    document = session.document
    shown = (
        document.statics.balanced if session.model.solution is not None else document.assessment.in_equilibrium
    )
    return bool(shown)


STATICS: dict[str, Callable[[Model], float]] = {  # of a model, whatever its state
    "width": _width,
    "frequency": _frequency,
    "buckling": _buckling,
    "first_yield": _first_yield,
    "collapse": _collapse,
}
_ASSESSED: dict[str, Callable[[Any], Any]] = {  # by a session, until something changes
    "degree": lambda session: session.document.assessment.indeterminacy.static,
    "mechanisms": lambda session: session.document.assessment.indeterminacy.mechanisms,
    "equilibrium": _in_equilibrium,
}


def _seen(view: View) -> dict[str, Any]:
    """What a person can turn on and off."""
    return {name: value for name, value in vars(view).items() if isinstance(value, bool | str)} | {
        "shape": view.shape.title if view.shape is not None else ""
    }


def _one_of(found: Mapping[str, Any], name: str, what: str) -> Any:
    if name not in found:
        raise LookupError(missing(what, name, found))
    return found[name]


def _of_force_method(session: Any, quantity: str) -> Any:
    """A quantity of the force method: part, unknown, force, delta_real, … of the last unknown; force in a set.

    real.AC is the axial force of rod AC in set 1, base.AC in set 2, superposed.AC in set 2 + set 3.
    """
    guide = getattr(session.scenes.active, "guide", None)
    if quantity == "message" and session.scene == "force method":
        return session.scenes.active.message
    if guide is None:
        raise NotFound("the force method is not open; press K in pause first.")
    if quantity == "unknown":
        return guide.unknown.name if guide.unknown else None
    if quantity == "part":
        return guide.part
    if guide.solution is None:
        raise NotFound("no redundant is chosen yet; choose one in part 2 first.")
    what, _, rod = quantity.partition(".")
    if rod:  # a row of the final table
        sets = {name: getattr(guide.solution, name) for name in ("real", "base", "superposed")}
        of_set = _one_of(sets, what, "sets")
        return float(of_set.axial_force[guide.model.rods[rod].row])
    if quantity == "exact_force":
        return guide.exact[-1] if guide.exact is not None else None
    names = "force", "delta_real", "delta_base", "delta_unit"
    found = {name: getattr(guide.solution, name) for name in names}
    return float(_one_of(found, quantity, "quantities of the force method").ravel()[-1])


def _of_displacement_method(session: Any, quantity: str) -> Any:
    """A quantity of the displacement method: part, message, size, or an unknown by its name, such as B.x (m, rad)."""
    guide = getattr(session.scenes.active, "guide", None)
    if guide is None or session.scene != "displacement method":
        raise NotFound("the displacement method is not open; press Ctrl+K in pause first.")
    names = [unknown.name for unknown in guide.solution.unknowns]
    found = dict(zip(names, guide.solution.displacement.tolist(), strict=True))
    found |= {"part": guide.part, "message": session.scenes.active.message, "size": guide.size}
    return _one_of(found, quantity, "quantities of the displacement method")
