"""Loads: forces on particles that follow a history in time, and what acts between the ends of rods."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pkgutil import resolve_name
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.cases import PERMANENT, check_case, factor_of_each
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import CM, LARGEST, MOVED, Field, FieldError, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked, tr
from pinjoint.components.particle import Particle
from pinjoint.components.table import Table
from pinjoint.components.wording import cut, quoted
from pinjoint.components.world import World

History = Mapping[str, Any]
DIRECTIONS = (marked("global"), marked("local"))  # of the forces of span loads


@dataclass(frozen=True)
class HistoryKind:
    """A way in which a load changes in time: force × factor(time).

    parameters: name → default of each number (or list of numbers) that a history of this kind has.
    factor: the compiled factor(time, values, first), or its "module:function", `values[first:]` being the
        parameters, flattened in order of declaration, lists preceded by their length.
    static: the factor that stands for it in statics, or what computes it from the parameters.
    ends: the time after which the factor no longer changes (infinite: never), from the parameters.
    check: raises FieldError for parameters that make no sense. mod: the mod that brought it, if one did.
    breaks: the times at which the factor jumps or has a kink; integrators do not step over them.
    """

    name: str
    parameters: Mapping[str, Any]
    factor: str | Callable[..., Any]
    static: float | Callable[[History], float]
    ends: Callable[[History], float]
    check: Callable[[History, str], None] = lambda history, where: None
    mod: Any = None
    breaks: Callable[[History], Iterable[float]] = lambda history: ()


HISTORIES: dict[str, HistoryKind] = EXTENSIONS.histories  # ours below, then those of mods


def _check_history(value: Any, where: str) -> History:
    """A history with all its parameters, or FieldError."""
    if not isinstance(value, Mapping) or not isinstance(value.get("kind"), str):
        raise FieldError(
            '{where}: history is {value}; it must be like {{"kind": "ramp", "duration": 0.5}}.',
            where=where,
            value=quoted(value),
        )
    kind = HISTORIES.get(value["kind"])
    if kind is None:
        raise FieldError(
            "{where}: there is no kind of history '{kind}'; choose one of {known}.",
            where=where,
            kind=cut(value["kind"]),
            known=", ".join(sorted(HISTORIES)),
        )
    unknown = sorted(map(str, set(value) - {"kind", *kind.parameters}))
    if unknown:
        raise FieldError(
            "{where}: a history of the kind '{kind}' has no '{unknown}'; it takes only: {allowed}.",
            where=where,
            kind=kind.name,
            unknown=cut(unknown[0]),
            allowed=", ".join(["kind", *kind.parameters]),
        )
    full = {"kind": kind.name} | {
        name: _check_parameter(value.get(name, default), default, name, where)
        for name, default in kind.parameters.items()
    }
    kind.check(full, where)
    return MappingProxyType(full)


def _check_parameter(value: Any, default: Any, name: str, where: str) -> Any:
    if isinstance(default, tuple):
        if isinstance(value, np.ndarray):
            value = value.tolist()
        if not isinstance(value, list | tuple):
            raise FieldError(
                "{where}: {name} of the history is {value}; it must be a list of numbers.",
                where=where,
                name=name,
                value=quoted(value),
            )
        return tuple(_check_parameter(item, 0.0, name, where) for item in value)
    is_number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    if not is_number or not abs(value) <= LARGEST:
        raise FieldError(
            "{where}: {name} of the history is {value}; it must be a number between -{largest:g} and {largest:g}.",
            where=where,
            name=name,
            value=quoted(value),
            largest=LARGEST,
        )
    return float(value)


def _check_ramp(history: History, where: str) -> None:
    if history["duration"] < 0.0:
        raise FieldError(
            "{where}: duration of the history is {duration:g} s; it must be at least 0 s.",
            where=where,
            duration=history["duration"],
        )


HISTORIES["constant"] = HistoryKind(
    "constant", {}, "pinjoint.systems.loads.kernels:constant", static=1.0, ends=lambda history: -math.inf
)
HISTORIES["ramp"] = HistoryKind(
    "ramp",
    {"start": 0.0, "duration": 1.0},
    "pinjoint.systems.loads.kernels:ramp",
    static=1.0,
    ends=lambda history: float(history["start"] + history["duration"]),
    breaks=lambda history: (history["start"], history["start"] + history["duration"]),
    check=_check_ramp,
)

CONSTANT = _check_history({"kind": "constant"}, "load")


# Of the loads that act together, which combinations multiply by a factor.
_CASE = partial(
    Field,
    dtype=str,
    title=marked("case"),
    default=PERMANENT,
    checker=check_case,
    doc=marked("The case that it is of, such as wind or snow."),
)


class Load(Handle):
    """A force on one particle, multiplied by a history of time, or a settlement of its support; several may act there."""

    __slots__ = ()
    table, noun = "loads", "load"

    name: Field[str] = Field(doc="Its name; no two loads have the same.", dtype=str)
    on: Field[int] = Field(
        dtype="reference",
        references="particles",
        title="particle",
        doc="The particle that it acts on: its name in files, its row in Python.",
    )
    force: Field[Vector] = Field(
        "kN", shape=(2,), doc="Force on the particle while the factor of its history is 1."
    )
    moment: Field[float] = Field(
        "kN·m",
        doc="Moment on the particle while the factor is 1, counter-clockwise; only rods rigidly joined to it feel it.",
    )
    history: Field[History] = Field(
        dtype=object,
        default=CONSTANT,
        doc="How the load changes in time: its factor multiplies force and moment.",
        checker=_check_history,
    )
    case: Field[str] = _CASE()
    settlement: Field[Vector] = Field(
        "m",
        shape=(2,),
        doc="How far it moves the rigid support of the particle, in directions that are constrained; in statics.",
        shown=MOVED,
    )
    settled_rotation: Field[float] = Field(
        "rad", doc="By how much it turns the clamp of the particle, counter-clockwise; in statics."
    )

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """The case that acts alone is that of some load."""
        _check_acting(table, changed)

    @property
    def particle(self) -> Particle:
        """The particle it acts on."""
        found: Particle = self.world.tables["particles"][self.on]
        return found


class SpanLoad(Handle):
    """What acts between the ends of a rod: a force and a moment at a place, a force distributed from there on, warmth.

    Several may act on a rod. Forces keep their directions while it moves, and act per original length.
    """

    __slots__ = ()
    table, noun = "span_loads", "span load"

    name: Field[str] = Field(doc="Its name; no two span loads have the same.", dtype=str)
    rod: Field[int] = Field(
        dtype="reference",
        references="rods",
        doc="The rod that it acts on: its name in files, its row in Python.",
    )
    start: Field[float] = Field(
        "m",
        minimum=0.0,
        shown=CM,
        doc="Where force and moment act, and where the distributed force begins: from the start of the rod, undeformed.",
    )
    end: Field[float | None] = Field(
        "m",
        nullable=True,
        absent=marked("end of the rod"),
        minimum=0.0,
        shown=CM,
        doc="Where the distributed force ends, from the start of the rod.",
    )
    force: Field[Vector] = Field("kN", shape=(2,), doc="Force at its start.")
    moment: Field[float] = Field("kN·m", doc="Moment at its start, counter-clockwise.")
    start_intensity: Field[Vector] = Field(
        "kN/m",
        shape=(2,),
        title="intensity at start",
        doc="Force per length where the distributed force begins; in between it changes linearly.",
    )
    end_intensity: Field[Vector] = Field(
        "kN/m", shape=(2,), title="intensity at end", doc="Force per length where the distributed force ends."
    )
    direction: Field[str] = Field(
        dtype=str,
        default=DIRECTIONS[0],
        choices=DIRECTIONS,
        doc="Of forces: global, x to the right and y up, or local, x along the undeformed rod and y to its left.",
    )
    case: Field[str] = _CASE()
    temperature_change: Field[float] = Field("K", doc="How much warmer it makes the whole rod, which expands.")
    temperature_gradient: Field[float] = Field(
        "K/m", doc="How much warmer it makes the whole rod per metre of depth towards its left side."
    )

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """It ends where it starts, or farther along the rod; the case that acts alone is that of some load."""
        _check_acting(table, changed)
        for row in rows[table.end[rows] < table.start[rows]][:1].tolist():
            raise FieldError(
                "{load}: its end, {end:g} m along the rod, is before its start, {start:g} m.",
                load=table.world.describe(table[row]),
                end=table.end[row],
                start=table.start[row],
            )


def _check_acting(table: Table[Any], changed: Collection[str]) -> None:
    if "case" in changed:
        settings = table.world.tables["settings"]
        settings.kind.after_change(settings, np.zeros(0, dtype=np.intp), ())


def varying(loads: Table[Load]) -> NDArray[np.bool_]:
    """Which loads change in time, (loads,); the others are part of the constant forces and moments."""
    return np.array([history["kind"] != CONSTANT["kind"] for history in loads.history], dtype=bool)


def factor_at(history: History, time: float) -> float:
    """The factor of a history at a time (s); NaN where the mod that brought it is off."""
    kind = HISTORIES[history["kind"]]
    factor = resolve_name(kind.factor) if isinstance(kind.factor, str) else kind.factor
    values = np.array(flattened(history[name] for name in kind.parameters), dtype=np.float64)
    if kind.mod is None:
        return float(factor(time, values, 0))
    return float(
        kind.mod.call(tr("the factor of a load"), factor, time, values, 0, otherwise=np.nan, declared=float)
    )


def load_factor(world: World, time: float) -> float | None:
    """The factor at a time (s) that all varying loads share, 1 being the whole load; None if there are none, or several."""
    loads = world.tables["loads"]
    histories = loads.history[varying(loads)].tolist()
    if not histories or any(history != histories[0] for history in histories):
        return None
    factor = factor_at(histories[0], time)
    return None if math.isnan(factor) else factor


def flattened(parameters: Iterable[Any]) -> list[float]:
    """Numbers in order, lists preceded by their length."""
    values: list[float] = []
    for parameter in parameters:
        values += (len(parameter), *parameter) if isinstance(parameter, tuple) else (parameter,)
    return values


def static_factor(history: History) -> float:
    """The factor that stands for a history in statics."""
    static = HISTORIES[history["kind"]].static
    return static(history) if callable(static) else static


def factor_now(world: World, load: Load) -> float:
    """The factor of a load in what columns show, by its history at the time of the run or in statics, and by its case."""
    by_case = float(factor_of_each(world, load.table)[load.row])
    if world.solution is not None:
        return by_case * world.solution.share * static_factor(load.history)
    return by_case * factor_at(load.history, float(world.tables["clock"].time[0]))


def load_ends(world: World) -> list[float]:
    """The time (s) after which each load does not change any more; −∞ if it never does."""
    return [HISTORIES[history["kind"]].ends(history) for history in world.tables["loads"].history]


def loads_end(world: World) -> float:
    """The time (s) after which no load changes any more; −∞ without varying loads."""
    return max(load_ends(world), default=-math.inf)


def load_breaks(world: World) -> list[float]:
    """Times (s), ascending, that no step may pass: just before and at every jump or kink of a load."""
    histories = world.tables["loads"].history
    times = sorted({float(t) for history in histories for t in HISTORIES[history["kind"]].breaks(history)})
    return [side for time in times for side in (math.nextafter(time, -math.inf), time)]
