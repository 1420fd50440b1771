"""Plan: all variants of a sweep in a fixed order, what is asked of each, and the software that computes them."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import getitem
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from pinjoint import __version__
from pinjoint.commands.analysis import Analysis, State, reported
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import ENDS
from pinjoint.components.language import english, joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.open_documents import file_of
from pinjoint.mods import load
from pinjoint.paths import EVERY, PathError, apply_override, energy_named, locate
from pinjoint.scripts.expectation import OVER_ALL, STATICS
from pinjoint.sweeps.variation import FORMS, MOST_VARIANTS, SweepError, Value, Variation, read_variations

FAILED = "failed"  # the status of a variant that could not be computed

Record = tuple[Any, ...]  # of one state: status, message, time, load factor, measures
RECORDED = ("status", "message", "time", "load_factor")
Outcome = tuple[int, list[Record]]  # the number of a variant, and a record of each of its states
_OF_THE_RUN = ("residual", "collisions")
_ANYWAY = ("time", "load_factor")  # columns that every result has
_TABLES = ("particles", "rods")
_SECTIONS = (*_TABLES, "energy", "statics")
_A_NUMBER = rf"(?:(?:{'|'.join(OVER_ALL)})\s+)?(?:{'|'.join(_SECTIONS)})\."
_BETWEEN = re.compile(rf",(?=\s*(?:{_A_NUMBER}|(?:{'|'.join((*_OF_THE_RUN, *_ANYWAY))})\s*(?:,|$)))")
_FORM = marked(
    "write it like rods.CD.axial_force, largest rods.*.strain, particles.C.displacement.y, energy.elastic or"
    " statics.collapse"
)


@dataclass(frozen=True)
class Measure:
    """One number of a state: the column it goes to, where it is found, what to call it, its unit.

    keys: in the facts of a state, or "statics" and what of STATICS. element: the name of that in whose row it is, "" if it
    is not of an element. over: by which of OVER_ALL its numbers, or those of EVERY element, become one.
    """

    column: str
    keys: tuple[str, ...]
    element: str
    axis: int | None
    title: str
    unit: str
    over: str = ""

    def of(self, model: Model, found: State) -> Any:
        """Its value in the facts of a state of a model."""
        section, name = self.keys[0], self.keys[-1]
        value: Any = STATICS[name](model) if section == "statics" else reduce(getitem, self.keys, found)
        if self.over:
            rows = slice(None) if self.element == EVERY else model.tables[section][self.element].row
            numbers = value[rows] if self.axis is None else value[rows, self.axis]
            numbers = numbers[~np.isnan(numbers)].ravel().tolist()
            value = float(OVER_ALL[self.over](numbers)) if numbers else None
        elif self.element:
            row = model.tables[section][self.element].row
            value = value.item(row) if self.axis is None else value.item(row, self.axis)
        return None if value != value else value

    @property
    def label(self) -> str:
        """For the axis of a diagram."""
        return self.title + (f", {self.unit}" if self.unit else "")


@dataclass(frozen=True)
class Plan:
    """The variants of a sweep; the same plan gives the same bits, whoever computes which part of it.

    Variants are numbered: every combination of the values of all variations, those of the last varying
    fastest; if something is drawn, `samples` of each, the same draws for every combination.

    name, document: of the model. overrides: what is changed in every variant. version: of Pinjoint. mods: besides those
    that come with it, each with its version and the folder where it was found, "" if in an installed package.
    """

    name: str
    document: Mapping[str, Any]
    overrides: tuple[str, ...]
    variations: tuple[Variation, ...]
    samples: int
    seed: int
    measures: tuple[Measure, ...]
    analysis: Analysis
    version: str
    mods: tuple[tuple[str, str, str], ...]

    def require_software(self) -> None:
        """Load the mods that this process lacks. Raises SweepError if its version or mods differ even then."""
        if self.version != __version__:
            raise SweepError(
                "A worker has Pinjoint {present}, but the sweep needs {version}; install that version there.",
                present=__version__,
                version=self.version,
            )
        missing = set(self.mods) - set(_present_mods())
        if missing:
            folders = [folder for mod in self.mods if mod in missing and (folder := mod[2])]
            load(map(Path, folders), installed=len(folders) < len(missing))
            missing -= set(_present_mods())
        for name, version, folder in sorted(missing):
            wanted = {"name": name, "version": version, "folder": folder}
            if folder:
                raise SweepError(
                    "A worker lacks the mod '{name}' {version} in {folder}; install it there.", **wanted
                )
            raise SweepError("A worker lacks the mod '{name}' {version}; install it there.", **wanted)

    @property
    def size(self) -> int:
        """Number of variants."""
        return self.samples * math.prod(len(variation.values) or 1 for variation in self.variations)

    @property
    def varied(self) -> tuple[str, ...]:
        """The paths to which a variant gives values."""
        return tuple(path for variation in self.variations for path in variation.columns)

    def values(self, number: int) -> tuple[Value, ...]:
        """The values of a variant, in the order of the paths that are varied."""
        place, sample = divmod(number, self.samples)
        combinations = self.size // self.samples
        drawn = any(variation.distribution for variation in self.variations)
        generator = np.random.default_rng([self.seed, sample]) if drawn else None
        taken: list[Value] = []
        for variation in self.variations:
            if variation.values:
                combinations //= len(variation.values)
                index, place = divmod(place, combinations)
                taken.append(variation.values[index])
            elif generator is not None:
                taken += variation.draw(generator)
        return tuple(taken)

    def failure(self, number: int, reason: str) -> Outcome:
        """The record of a variant that could not be computed."""
        return number, [(FAILED, english(reason), *[None] * (len(RECORDED) - 2 + len(self.measures)))]

    def fingerprint(self) -> str:
        """Tells plans apart: model, variations, seed, what is asked and measured, versions."""
        everything = [msgspec.to_builtins(self, enc_hook=english), np.__version__]
        content = msgspec.json.encode(everything, order="deterministic")
        return hashlib.sha256(content).hexdigest()


def _present_mods() -> tuple[tuple[str, str, str], ...]:
    """The mods of this process, as they are now."""
    return tuple(
        (mod.name, mod.version, "" if mod.source.startswith("package ") else str(mod.folder))
        for mod in EXTENSIONS.mods
        if mod.loaded and not mod.included
    )


def plan_of(
    source: str | Path | Mapping[str, Any],
    vary: Iterable[str] | Mapping[str, Sequence[Value]],
    measure: Iterable[str],
    analysis: Analysis,
    overrides: Iterable[str],
    samples: int | None,
    seed: int,
) -> Plan:
    """The plan that the arguments of `sweep` describe, checked. Raises SweepError, ModelError, PathError."""
    model = models.load(source)
    document = models.document(model)
    overrides = tuple(overrides)
    for override in overrides:
        apply_override(model, override)
    variations = read_variations(model, vary)
    drawn = any(variation.distribution for variation in variations)
    if not variations:
        raise SweepError("Nothing is varied; {form}.", form=tr(FORMS))
    if drawn and samples is None:
        raise SweepError("A distribution (~) needs a number of samples, such as 1000.")
    if not drawn and samples is not None:
        raise SweepError(
            "A number of samples works only with a distribution; write PATH~normal(MEAN,DEVIATION), or leave it out."
        )
    if samples is not None and samples < 1:
        raise SweepError("{samples} samples: draw at least 1.", samples=samples)
    if seed < 0:
        raise SweepError("The seed is {seed}; write a whole number of at least 0.", seed=seed)
    plan = Plan(
        file_of(source).name,
        document,
        overrides,
        variations,
        samples or 1,
        seed,
        _read_measures(model, measure),
        analysis,
        __version__,
        _present_mods(),
    )
    if plan.size > MOST_VARIANTS:
        raise SweepError(
            "These are {count} variants, more than {most}; vary in fewer steps.",
            count=plan.size,
            most=MOST_VARIANTS,
        )
    return plan


# --- measures -------------------------------------------------------------------------------------------


def _read_measures(model: Model, texts: Iterable[str]) -> tuple[Measure, ...]:
    """The measures of a model that paths, or lists of paths with commas, name. Raises SweepError."""
    measures: dict[str, Measure] = {}
    for text in [texts] if isinstance(texts, str) else texts:
        for path in _BETWEEN.split(text):
            measures |= {measure.column: measure for measure in _measured(model, path.strip())}
    if not measures:
        raise SweepError("Nothing is measured; {form}.", form=tr(_FORM))
    return tuple(measures.values())


def _measured(model: Model, text: str) -> list[Measure]:
    word, _, of_all = text.partition(" ")
    over, path = (word, of_all.strip()) if word in OVER_ALL else ("", text)
    section, _, rest = path.partition(".")
    if path in _ANYWAY:
        return []
    if path in _OF_THE_RUN:
        return [Measure(path, (path,), "", None, path, "")]
    if section not in _SECTIONS or (over and section not in _TABLES):
        names = ", ".join(_OF_THE_RUN)
        raise SweepError("{path}: {form}, or one of {names}.", path=text, form=tr(_FORM), names=names)
    try:
        if section == "statics":
            if rest not in STATICS:
                raise PathError("it is none of {names}.", names=", ".join(STATICS))
            return [Measure(path, ("statics", rest), "", None, path, "")]
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
        raise SweepError(joined([f"{text}:", str(error)])) from None
    field, key = target.field, f"{section}.{target.element or EVERY}.{target.key}"
    if over:
        if field.shape and field.axes != ENDS and not target.axis:
            raise SweepError(
                "{path}: name one component, such as {key}.{axis}.",
                path=text,
                key=target.key,
                axis=field.axes[0],
            )
        column = f"{over} {key}" + (f".{target.axis}" if target.axis else "")
        axis = field.axes.index(target.axis) if target.axis else None
        keys = (section, field.name)
        return [Measure(column, keys, target.element or EVERY, axis, column, field.unit_of(target.axis), over)]
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
