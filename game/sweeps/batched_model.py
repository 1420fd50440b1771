"""Batched model: variants of one model as equal, disjoint parts of the same tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.derived import DERIVATIONS
from pinjoint.components.field import Column, Field, Role
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import is_computed_with, is_extreme
from pinjoint.components.world import World

_TABLES = ("particles", "rods", "loads", "environment", "settings", "clock")


class BatchedModel:
    """Variants that differ in their numbers only, not in what there is and what is joined to what.

    variants: how many. A column of all of them, such as `batched["rods.stiffness"]`, has the shape (variants, rows, …).
    Functions that read the columns of a model see one that consists of disjoint parts: `batched.rods.stiffness` has
    the rows of all, and references point to rows of the same variant. A table with a single row, such as the
    environment, has a row for each particle then.
    """

    def __init__(self, model: Model, columns: dict[str, Column], variants: int) -> None:
        self.variants = variants
        self._model = model
        self._columns = columns
        self.tables = {name: _Table(self, name, variants * model.tables[name].count) for name in _TABLES}
        self.particles, self.rods, self.loads = (self.tables[name] for name in ("particles", "rods", "loads"))

    @classmethod
    def of(cls, model: Model, variants: int) -> BatchedModel:
        """So many copies of a model."""
        columns = {
            f"{name}.{field.name}": np.repeat(model.tables[name].column(field.name)[None], variants, axis=0)
            for name in _TABLES
            for field in model.tables[name].fields.values()
        }
        return cls(model, columns, variants)

    def part(self, variants: NDArray[np.intp]) -> BatchedModel:
        """Copies of some of the variants."""
        columns = {name: column[variants] for name, column in self._columns.items()}
        return BatchedModel(self._model, columns, len(variants))

    def as_model(self) -> Model:
        """This batch as a model, for functions that only read columns."""
        return cast(Model, self)

    def __getitem__(self, name: str) -> Column:
        return self._columns[name]

    def has(self, name: str) -> bool:
        """True if there is a column of this name."""
        return name in self._columns

    def single(self, name: str) -> Column:
        """A column of a table that has a single row in each variant, shape (variants, …)."""
        return self._columns[name][:, 0]

    def field(self, name: str) -> Field[object]:
        """The Field of a column."""
        table, _, field = name.partition(".")
        return self._model.tables[table].fields[field]

    def fields(self, table: str) -> Mapping[str, Field[Any]]:
        """The Fields of a table by name."""
        return self._model.tables[table].fields

    def writable(self, name: str) -> Column:
        """A column with the rows of all variants, for a derivation to fill."""
        column = self._columns[name]
        return column.reshape(-1, *column.shape[2:])

    def flat(self, name: str) -> Column:
        """A column as that of one model that consists of all variants."""
        table, references = name.partition(".")[0], self.field(name).references
        column = self._columns[name]
        if self._model.tables[table].kind.single:
            column = np.repeat(column, self._model.particles.count, axis=1)
        elif references is not None:
            rows = self._model.tables[references].count
            first = np.arange(self.variants, dtype=column.dtype) * column.dtype.type(rows)
            column = column + first.reshape(-1, *(1,) * (column.ndim - 1))
        return column.reshape(-1, *column.shape[2:])

    def derive(self) -> None:
        """Bring what follows directly from the document up to date, but for what only pictures need."""
        for derivation in DERIVATIONS:
            if not derivation.targets[0].startswith("settings."):
                derivation.compute(cast(World, self))

    def extreme(self) -> NDArray[np.bool_]:
        """Which variants have a number that is too large or too small to compute with."""
        found = np.zeros(self.variants, dtype=bool)
        for name, column in self._columns.items():
            if is_computed_with(self.field(name)):
                found |= is_extreme(self.field(name), column).reshape(self.variants, -1).any(axis=1)
        return found

    def state(self) -> Mapping[str, Column]:
        """Copies of the columns that time changes."""
        return {
            name: column.copy() for name, column in self._columns.items() if self.field(name).role is Role.STATE
        }

    def restore(self, state: Mapping[str, Column]) -> None:
        """Put a state back."""
        for name, column in state.items():
            self._columns[name][...] = column


class _Table:
    """A table with the rows of all variants."""

    def __init__(self, model: BatchedModel, name: str, count: int) -> None:
        self.count = count
        self._model, self._name = model, name

    def __getattr__(self, field: str) -> Column:
        if field.startswith("_"):
            raise AttributeError(field)
        return self.column(field)

    @property
    def fields(self) -> Mapping[str, Field[Any]]:
        """Its Fields by name."""
        return self._model.fields(self._name)

    def column(self, field: str) -> Column:
        """The column of a Field."""
        return self._model.flat(f"{self._name}.{field}")
