"""Plan: all variants of a sweep in a fixed order, and what each of them comes to."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from game import Session
from game.overrides import apply_override
from game.report import Analysis
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
        generator = np.random.default_rng([self.seed, sample])
        drawn = [
            v.draw(generator) if isinstance(v, Random) else t
            for v, t in zip(self.variations, taken, strict=True)
        ]
        return tuple(value for values in drawn for value in values)

    def overrides_of(self, number: int) -> tuple[str, ...]:
        """A variant as `pinjoint run MODEL --set …` has it."""
        values = map(as_text, self.values(number))
        return (*self.overrides, *(f"{path}={value}" for path, value in zip(self.varied, values, strict=True)))

    def compute(self, number: int) -> Outcome:
        """Compute a variant; one that cannot be is a record that says why."""
        try:
            session = Session.open(self.document)
            for override in self.overrides_of(number):
                apply_override(session.model, override)
            run = self.analysis.run(session, self.name)
        except Exception as error:  # one bad variant of thousands must not end the others
            known = isinstance(error, ValueError)
            return self.failure(number, str(error) if known else f"{type(error).__name__}: {error}")
        return number, [
            (run["status"], run["message"], s["time"], s["load_factor"], *(m.of(s) for m in self.measures))
            for s in run["states"]
        ]

    def failure(self, number: int, reason: str) -> Outcome:
        """What is recorded of a variant that could not be computed."""
        return number, [(FAILED, reason, *[None] * (len(RECORDED) - 2 + len(self.measures)))]

    def compute_all(self, numbers: Sequence[int]) -> list[Outcome]:
        """Compute some variants, here. Raises SweepError if this installation is not that of the plan."""
        self.installation.require()
        return [self.compute(number) for number in numbers]

    def fingerprint(self) -> str:
        """Tells plans apart: model, variations, seed, what is asked and measured, versions."""
        everything = msgspec.json.encode([msgspec.to_builtins(self), np.__version__], order="deterministic")
        return hashlib.sha256(everything).hexdigest()
