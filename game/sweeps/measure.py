"""Measures: the numbers of a result that a sweep keeps."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from operator import getitem
from typing import Any

from pinjoint.commands.reports.results import State, reported
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.paths import EVERY, PathError, energy_named, locate
from pinjoint.sweeps.variation import SweepError

_OF_THE_RUN = ("residual", "collisions")
_ANYWAY = ("time", "load_factor")  # columns that every result has
_TABLES = ("particles", "rods")
_SECTIONS = (*_TABLES, "energy")
_BETWEEN = re.compile(
    rf",(?=\s*(?:(?:{'|'.join(_SECTIONS)})\.|(?:{'|'.join((*_OF_THE_RUN, *_ANYWAY))})\s*(?:,|$)))"
)
_FORM = marked("write it like rods.CD.axial_force, rods.*.strain, particles.C.displacement.y or energy.elastic")


@dataclass(frozen=True)
class Measure:
    """One number of a state: the column it goes to, where it is found, what to call it, its unit.

    keys: in the facts of a state; element: the name of that in whose row it is, "" if it is not of an element.
    """

    column: str
    keys: tuple[str, ...]
    element: str
    axis: int | None
    title: str
    unit: str

    def of(self, model: Model, found: State) -> Any:
        """Its value in the facts of a state of a model."""
        value: Any = reduce(getitem, self.keys, found)
        if not self.element:
            return value
        row = model.tables[self.keys[0]][self.element].row
        number = value.item(row) if self.axis is None else value.item(row, self.axis)
        return None if number != number else number

    @property
    def label(self) -> str:
        """For the axis of a diagram."""
        return self.title + (f", {self.unit}" if self.unit else "")


def read_measures(model: Model, texts: Iterable[str]) -> tuple[Measure, ...]:
    """The measures of a model that paths, or lists of paths with commas, name. Raises SweepError."""
    measures: dict[str, Measure] = {}
    for text in texts:
        for path in _BETWEEN.split(text):
            measures |= {measure.column: measure for measure in _read(model, path.strip())}
    if not measures:
        raise SweepError("Nothing is measured; add --measure: {form}.", form=tr(_FORM))
    return tuple(measures.values())


def _read(model: Model, path: str) -> list[Measure]:
    section, _, rest = path.partition(".")
    if path in _ANYWAY:
        return []
    if path in _OF_THE_RUN:
        return [Measure(path, (path,), "", None, path, "")]
    if section not in _SECTIONS:
        names = ", ".join(_OF_THE_RUN)
        raise SweepError("--measure {path}: {form}, or one of {names}.", path=path, form=tr(_FORM), names=names)
    try:
        if section == "energy":
            return [
                Measure(path, ("energy", energy_named(rest)), "", None, f"{rest.replace('_', ' ')} energy", "J")
            ]
        target, rest = locate(
            model,
            path,
            lambda table: {f.name: f for f in reported(model, table.name)} if table.name in _TABLES else {},
        )
        if rest:
            raise PathError("'{rest}' does not belong to the quantity; {form}.", rest=rest, form=tr(_FORM))
    except PathError as error:
        raise SweepError(joined([f"--measure {path}:", str(error)])) from None
    elements = target.table.names if target.element == EVERY else [target.element]
    return [
        Measure(
            column=f"{section}.{element}.{target.key}" + (f".{axis}" if axis else ""),
            keys=(section, target.field.name),
            element=element,
            axis=target.field.axes.index(axis) if axis else None,
            title=tr(
                "{quantity} of {element}", quantity=joined([tr(target.field.title), axis]), element=element
            ),
            unit=target.field.unit_of(axis),
        )
        for element in elements
        for axis in ([target.axis] if target.axis or not target.field.shape else target.field.axes)
    ]
