"""Plan: all variants of a sweep in a fixed order, what is asked of each, and the software that computes them."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from pinjoint import __version__
from pinjoint.commands.reports.report import Analysis
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import english, tr
from pinjoint.documents import models
from pinjoint.documents.open_documents import file_of
from pinjoint.mods import load
from pinjoint.mods.mod import INCLUDED
from pinjoint.paths import apply_override
from pinjoint.sweeps.measure import Measure, read_measures
from pinjoint.sweeps.variation import (
    FORMS,
    MOST_VARIANTS,
    Random,
    SweepError,
    Value,
    Values,
    Variation,
    read_variations,
)

FAILED = "failed"  # the status of a variant that could not be computed

Record = tuple[Any, ...]  # of one state: status, message, time, load factor, measures
RECORDED = ("status", "message", "time", "load_factor")
Outcome = tuple[int, list[Record]]  # the number of a variant, and a record of each of its states


@dataclass(frozen=True)
class NeededMod:
    """A mod of a sweep. folder: where it was found, "" if in an installed package."""

    name: str
    version: str
    folder: str


@dataclass(frozen=True)
class SoftwareEnvironment:
    """The software of a sweep, which its workers need. version: of Pinjoint. mods: besides those that come with it."""

    version: str
    mods: tuple[NeededMod, ...]

    @classmethod
    def present(cls) -> SoftwareEnvironment:
        """The software of this process, as it is now."""
        mods = (mod for mod in EXTENSIONS.mods if mod.loaded and mod.source != INCLUDED)
        return cls(
            __version__,
            tuple(
                NeededMod(mod.name, mod.version, "" if mod.source.startswith("package ") else str(mod.folder))
                for mod in mods
            ),
        )

    def require(self) -> None:
        """Load the mods that this process lacks. Raises SweepError if its version or mods differ even then."""
        if self.version != __version__:
            raise SweepError(
                "A worker has Pinjoint {present}, but the sweep needs {version}; install that version there.",
                present=__version__,
                version=self.version,
            )
        missing = set(self.mods) - set(SoftwareEnvironment.present().mods)
        if missing:
            folders = [mod.folder for mod in self.mods if mod in missing and mod.folder]
            load(map(Path, folders), installed=len(folders) < len(missing))
            missing -= set(SoftwareEnvironment.present().mods)
        for mod in sorted(missing, key=lambda mod: mod.name):
            wanted = {"name": mod.name, "version": mod.version, "folder": mod.folder}
            if mod.folder:
                raise SweepError(
                    "A worker lacks the mod '{name}' {version} in {folder}; install it there.", **wanted
                )
            raise SweepError("A worker lacks the mod '{name}' {version}; install it there.", **wanted)


@dataclass(frozen=True)
class Plan:
    """The variants of a sweep; the same plan gives the same bits, whoever computes which part of it.

    Variants are numbered: every combination of the values of all variations, those of the last varying
    fastest; if something is drawn, `samples` of each, the same draws for every combination.

    name, document: of the model. overrides: what is changed in every variant. software: what it is of.
    """

    name: str
    document: Mapping[str, Any]
    overrides: tuple[str, ...]
    variations: tuple[Variation, ...]
    samples: int
    seed: int
    measures: tuple[Measure, ...]
    analysis: Analysis
    software: SoftwareEnvironment

    @property
    def size(self) -> int:
        """Number of variants."""
        return self.samples * math.prod(len(v.values) for v in self.variations if isinstance(v, Values))

    @property
    def varied(self) -> tuple[str, ...]:
        """The paths to which a variant gives values."""
        return tuple(path for variation in self.variations for path in variation.columns)

    def values(self, number: int) -> tuple[Value, ...]:
        """The values of a variant, in the order of the paths that are varied."""
        place, sample = divmod(number, self.samples)
        combinations = self.size // self.samples
        drawn = any(isinstance(variation, Random) for variation in self.variations)
        generator = np.random.default_rng([self.seed, sample]) if drawn else None
        taken: list[Value] = []
        for variation in self.variations:
            if isinstance(variation, Values):
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
    drawn = any(isinstance(variation, Random) for variation in variations)
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
        read_measures(model, measure),
        analysis,
        SoftwareEnvironment.present(),
    )
    if plan.size > MOST_VARIANTS:
        raise SweepError(
            "These are {count} variants, more than {most}; vary in fewer steps.",
            count=plan.size,
            most=MOST_VARIANTS,
        )
    return plan
