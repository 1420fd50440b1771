"""Load cases: which loads act together, and by what factors combinations let them act.

Every load belongs to a case. What stands in fields of elements is of the case "permanent": forces, accelerations, weight,
what acts along rods, their warmth and lack of fit, and displacements of rigid supports. A combination has factors of
cases, 0 of those that it leaves out, "permanent" too; without one all cases act once.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.field import LARGEST, FieldError
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.particle import of_rigid_supports, turned_supports
from pinjoint.components.wording import cut, quoted
from pinjoint.components.world import World

Combinations = Mapping[str, Mapping[str, float]]
PERMANENT = marked("permanent")
TABLES = ("loads", "span_loads")  # of loads
# What factors follow from.
SOURCES = " ".join(["settings.combination settings.combinations", *(f"{name}.case" for name in TABLES)])
_LONGEST = 40  # letters of a name


def check_case(name: str, where: str) -> str:
    """The name of a case or combination, or FieldError."""
    if not name.strip() or len(name) > _LONGEST:
        raise FieldError(
            "{where}: the name is {name}; it must have 1 to {most} letters.",
            where=where,
            name=quoted(name),
            most=_LONGEST,
        )
    return name.strip()


def check_combinations(value: Any, where: str) -> Combinations:
    """Factors of cases by combination, or FieldError."""
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        raise FieldError(
            '{where}: combinations are {value}; they must be like {{"ULS": {{"permanent": 1.35, "wind": 1.5}}}}.',
            where=where,
            value=quoted(value),
        )
    found = {check_case(name, where): _check_factors(name, factors, where) for name, factors in value.items()}
    return MappingProxyType(found)


def _check_factors(combination: str, value: Any, where: str) -> Mapping[str, float]:
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        raise FieldError(
            "{where}: the combination '{name}' is {value}; it must give cases factors, like {{\"permanent\": 1.35}}.",
            where=where,
            name=cut(combination),
            value=quoted(value),
        )
    for case, factor in value.items():
        is_number = isinstance(factor, int | float | np.integer | np.floating) and not isinstance(factor, bool)
        if not is_number or not abs(factor) <= LARGEST:
            raise FieldError(
                "{where}: in the combination '{name}' the factor of '{case}' is {factor}; it must be a number.",
                where=where,
                name=cut(combination),
                case=cut(case),
                factor=quoted(factor),
            )
    return MappingProxyType({check_case(case, where): float(factor) for case, factor in value.items()})


def cases(world: World) -> list[str]:
    """The cases of a model: "permanent", then those of its loads in the order of these."""
    return list(dict.fromkeys([PERMANENT, *(case for name in TABLES for case in world.tables[name].case)]))


def factors(world: World) -> Mapping[str, float] | None:
    """The factors of the combination or case that is chosen, 0 of cases that it leaves out; None: all cases act once."""
    settings = world.tables["settings"]
    chosen = settings.combination[0]
    return settings.combinations[0].get(chosen, {chosen: 1.0}) if chosen else None


def choices(world: World) -> list[str]:
    """What can be chosen to act: "", all cases, then combinations, then single cases; [] where there is no choice."""
    known = cases(world)
    combinations = list(world.tables["settings"].combinations[0])
    alone = [case for case in known if case not in combinations] if len(known) > 1 else []
    return ["", *combinations, *alone] if combinations or alone else []


def alone(world: World) -> str:
    """The case that acts alone, of which loads that are drawn then are; "" if combinations or all cases act."""
    settings = world.tables["settings"]
    return "" if settings.combination[0] in settings.combinations[0] else str(settings.combination[0])


def case_told(world: World, table: str, row: int) -> str:
    """Behind the value of a load, a row of a table or of a Field of it: its case, " (wind)", where others act, too."""
    name = table.partition(".")[0]
    case = PERMANENT if name not in TABLES or alone(world) else world.tables[name].case[row]
    return "" if case == PERMANENT else f" ({tr(case)})"


def said(world: World, name: str) -> str:
    """What acts where a combination or case is chosen, for a person: "ULS", "case wind" or "all cases × 1"."""
    if not name:
        return tr("all cases × 1")
    return name if name in world.tables["settings"].combinations[0] else tr("case {case}", case=tr(name))


def acting(world: World) -> str:
    """What acts now: "ULS: 1.35 permanent + 1.5 wind"; "" where there is nothing to choose."""
    chosen = world.tables["settings"].combination[0]
    if not choices(world):
        return ""
    named = said(world, chosen)
    if chosen not in world.tables["settings"].combinations[0]:
        return named
    parts = [f"{written.given(factor)} {tr(case)}" for case, factor in (factors(world) or {}).items() if factor]
    return f"{named}: {' + '.join(parts) or '0'}".replace("+ −", "− ")


class Acting(NamedTuple):
    """Factors of what acts in k combinations: of fields of elements (k,), and of the loads of both tables, (k, loads)."""

    permanent: NDArray[np.float64]
    loads: NDArray[np.float64]
    span_loads: NDArray[np.float64]

    @classmethod
    def of(cls, world: World, *chosen: Mapping[str, float] | None) -> Acting:
        """Those of some combinations; None: all cases once. None given: those of the one that is chosen in the model."""
        every = chosen or (factors(world),)
        if every == (None,):
            return cls(np.ones(1), *(np.ones((1, world.tables[name].count)) for name in TABLES))
        known = cases(world)
        by = np.array([[1.0 if one is None else one.get(case, 0.0) for case in known] for one in every])
        number = {case: place for place, case in enumerate(known)}
        of_each = ([number[case] for case in world.tables[name].case] for name in TABLES)
        return cls(by[:, 0], *(by[:, np.array(places, dtype=np.intp)] for places in of_each))


def permanent(world: World) -> float:
    """The factor of what stands in fields of elements."""
    return 1.0 if factors(world) is None else float(Acting.of(world).permanent[0])


def factor_of_each(world: World, table: str) -> NDArray[np.float64]:
    """The factor of each load of a table, (loads,)."""
    found: NDArray[np.float64] = getattr(Acting.of(world), table)[0]
    return found


def unknown_case(world: World) -> str:
    """The sentence about a case of the chosen combination that no load is of; "" if there is none."""
    if (chosen := factors(world)) is None:
        return ""
    known = cases(world)
    for case in [case for case in chosen if case not in known][:1]:
        return tr(
            "The combination '{name}' names the case '{case}', which no load is of; there are {known}.",
            name=cut(world.tables["settings"].combination[0]),
            case=cut(case),
            known=", ".join(known),
        )
    return ""


def settled(world: World, acting: Acting | None = None) -> NDArray[np.float64]:
    """How far rigid supports are moved and turned, in statics: by displacements given and by loads, (particles, 3).

    acting: combinations, of which these follow one another.
    """
    particles, loads = world.tables["particles"], world.tables["loads"]
    acting = acting or Acting.of(world)
    own = np.column_stack([particles.storage("displacement"), particles.storage("rotation")])
    found = acting.permanent[:, None, None] * own
    if (by_loads := _settlements(world)).any():
        np.add.at(found.swapaxes(0, 1), loads.on, acting.loads.T[..., None] * by_loads[:, None])
    found[..., 2] *= particles.fixed_rotation
    for moved in found:
        moved[:, :2] = of_rigid_supports(world, moved[:, :2])
    result: NDArray[np.float64] = found.reshape(-1, 3)
    return result


def _settlements(world: World) -> NDArray[np.float64]:
    loads = world.tables["loads"]
    return np.column_stack([loads.settlement, loads.settled_rotation])


def idle_settlement(world: World, *, moving: bool) -> str:
    """The sentence about a settlement that moves no rigid support, or none while time passes; "" if there is none."""
    given, loads, particles = _settlements(world) != 0.0, world.tables["loads"], world.tables["particles"]
    if not given.any():
        return ""
    for row in np.flatnonzero(given.any(axis=1))[:1].tolist() if moving else ():
        load = world.describe(loads[row])
        return tr("Settlements act in statics only: while time passes, {load} moves no support.", load=load)
    turned = turned_supports(world) & particles.fixed.any(axis=1)
    held = np.column_stack([particles.fixed | turned[:, None], particles.fixed_rotation])
    for row in np.flatnonzero((given & ~held[loads.on]).any(axis=1))[:1].tolist():
        return tr(
            "{load}: no rigid support holds {particle} where it settles, so it moves nothing there.",
            load=begun(world.describe(loads[row])),
            particle=world.describe(particles[int(loads.on[row])]),
        )
    return ""


def rename(world: World, name: str, new: str) -> None:
    """Give a combination another name, which no other has, under which it still acts if it did."""
    settings = world.tables["settings"][0]
    known, acts = settings.combinations, settings.combination == name
    with world.transaction(marked("name")):
        settings.combination = "" if acts else settings.combination
        settings.combinations = {new if one == name else one: factors for one, factors in known.items()}
        settings.combination = new.strip() if acts else settings.combination


def choose(world: World, case: str | None, combination: str | None) -> None:
    """Let one combination act in a model, "": all cases once; or one case alone. Raises ValueError."""
    settings = world.tables["settings"][0]
    if case is not None and combination is not None:
        raise WrongValue("Choose a case or a combination, not both.")
    if case is not None:
        if case not in (known := cases(world)):
            raise FieldError(
                "There is no load case '{name}'; choose one of {known}.", name=cut(case), known=", ".join(known)
            )
        if case in settings.combinations:  # which means another thing by that name
            settings.combinations = {case: {case: 1.0}}
    settings.combination = case or combination or ""
