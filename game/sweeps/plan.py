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
from pinjoint.components.language import english, joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.open_documents import file_of
from pinjoint.mods import load
from pinjoint.paths import EVERY, PathError, apply_override, energy_named, locate
from pinjoint.sweeps.variation import FORMS, MOST_VARIANTS, SweepError, Value, Variation, read_variations

FAILED = "failed"  # the status of a variant that could not be computed

Record = tuple[Any, ...]  # of one state: status, message, time, load factor, measures
RECORDED = ("status", "message", "time", "load_factor")
Outcome = tuple[int, list[Record]]  # the number of a variant, and a record of each of its states
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
        raise SweepError("A distribution (~) needs a number of samples; add, for example, --samples 1000.")
    if not drawn and samples is not None:
        raise SweepError(
            "--samples works only with a distribution; write PATH~normal(MEAN,DEVIATION), or leave out --samples."
        )
    if samples is not None and samples < 1:
        raise SweepError("--samples {samples}: draw at least 1.", samples=samples)
    if seed < 0:
        raise SweepError("--seed {seed}: write a whole number of at least 0.", seed=seed)
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
        raise SweepError("Nothing is measured; add --measure: {form}.", form=tr(_FORM))
    return tuple(measures.values())


def _measured(model: Model, path: str) -> list[Measure]:
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
