"""Departure: the whole step that a run left to show a moment within the next, and goes back to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from pinjoint.components.field import FieldError, Role
from pinjoint.components.language import marked
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.world import World

_REFUSAL = marked(
    "{where}: this is not what Pinjoint saves here. Remove it: the run then goes on within its accuracy."
)


class Departure(Mapping[str, Any]):
    """All state after a whole step, from which the run goes on bit for bit whatever is shown of the next step.

    It belongs to the document as it is: an edit makes what is shown the state, and there is no departure any more. As a
    mapping it is what a model file holds: a list of values for each column, "table.field", that time makes.
    """

    def __init__(self, state: Snapshot) -> None:
        self.state = state

    @classmethod
    def of_file(cls, saved: Mapping[str, Any], world: World, where: str) -> Departure:
        """The departure of which a model file holds these columns. Raises FieldError.

        Columns of mods that are not loaded are left out; others that are missing have their defaults.
        """
        layout, arrays = [], []
        for name, table in world.tables.items():
            for field in table.fields_in(Role.STATE):
                column, key = field.allocate(table.count), f"{name}.{field.name}"
                if key in saved and field.checker is check_departure:
                    raise FieldError(_REFUSAL, where=f"{where}.{key}")
                if key in saved:
                    values = saved[key]
                    if not isinstance(values, list | tuple) or len(values) != table.count:
                        raise FieldError(_REFUSAL, where=f"{where}.{key}")
                    column = field.check_column(list(values), table.count, partial(_path, f"{where}.{key}"))
                layout.append((name, (field.name,)))
                arrays.append(column)
        return cls(Snapshot(tuple(layout), tuple(arrays), world.orders))

    @property
    def nbytes(self) -> int:
        """Memory that it takes, bytes."""
        return self.state.size

    @property
    def steps(self) -> int:
        """How many steps had been taken."""
        return int(self.state.columns["clock.steps"][0])

    def __iter__(self) -> Iterator[str]:
        return iter(name for name, column in self.state.columns.items() if column.tolist() != [None])

    def __len__(self) -> int:
        return len(list(iter(self)))

    def __getitem__(self, name: str) -> Any:
        column = self.state.columns[name]
        if column.dtype.kind == "f" and np.isnan(column).any():
            return [None if value != value else value for value in column.tolist()]
        return column.tolist()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Departure) and dict(self) == dict(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Departure from step {self.steps}>"


def _path(column: str, row: int) -> str:
    return f"{column}[{row}]"


def check_departure(value: Any, where: str) -> Mapping[str, Any]:
    """A departure, or what a model file holds of one, until `of_file` makes it one. Raises FieldError."""
    if isinstance(value, Mapping):
        return value
    raise FieldError(_REFUSAL, where=where)
