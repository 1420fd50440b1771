"""Plan: all variants of a sweep in a fixed order, and what is asked of each."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from game.commands.reports.report import Analysis
from game.sweeps.installation import Installation
from game.sweeps.measure import Measure
from game.sweeps.variation import Random, Value, Values, Variation, as_text

FAILED = "failed"  # the status of a variant that could not be computed

Record = tuple[Any, ...]  # of one state: status, message, time, load factor, measures
RECORDED = ("status", "message", "time", "load_factor")
Outcome = tuple[int, list[Record]]  # the number of a variant, and a record of each of its states


@dataclass(frozen=True)
class Plan:
    """What a sweep computes; the same plan gives the same bits, whoever computes which part of it.

    Variants are numbered: every combination of the values of all variations, those of the last varying
    fastest; if something is drawn, `samples` of each, the same draws for every combination.

    name, document: of the model. overrides: what is changed in every variant. installation: what it is of.
    """

    name: str
    document: Mapping[str, Any]
    overrides: tuple[str, ...]
    variations: tuple[Variation, ...]
    samples: int
    seed: int
    measures: tuple[Measure, ...]
    analysis: Analysis
    installation: Installation

    @property
    def size(self) -> int:
        """How many variants there are."""
        return self.samples * math.prod(len(v.values) for v in self.variations if isinstance(v, Values))

    @property
    def varied(self) -> tuple[str, ...]:
        """The paths to which a variant gives values."""
        return tuple(path for variation in self.variations for path in variation.columns)

    def values(self, number: int) -> tuple[Value, ...]:
        """What a variant gives to the paths that are varied."""
        combination, sample = divmod(number, self.samples)
        taken: list[tuple[Value, ...]] = []
        for variation in reversed(self.variations):
            if isinstance(variation, Values):
                combination, index = divmod(combination, len(variation.values))
                taken.insert(0, (variation.values[index],))
            else:
                taken.insert(0, ())
        if any(isinstance(variation, Random) for variation in self.variations):
            generator = np.random.default_rng([self.seed, sample])
            taken = [
                v.draw(generator) if isinstance(v, Random) else t
                for v, t in zip(self.variations, taken, strict=True)
            ]
        return tuple(value for values in taken for value in values)

    def overrides_of(self, number: int) -> tuple[str, ...]:
        """A variant as `pinjoint run MODEL --set …` has it."""
        values = map(as_text, self.values(number))
        return (*self.overrides, *(f"{path}={value}" for path, value in zip(self.varied, values, strict=True)))

    def failure(self, number: int, reason: str) -> Outcome:
        """What is recorded of a variant that could not be computed."""
        return number, [(FAILED, reason, *[None] * (len(RECORDED) - 2 + len(self.measures)))]

    def fingerprint(self) -> str:
        """Tells plans apart: model, variations, seed, what is asked and measured, versions."""
        everything = msgspec.json.encode([msgspec.to_builtins(self), np.__version__], order="deterministic")
        return hashlib.sha256(everything).hexdigest()
