"""Field: one fact about an entity, with its unit, limits, role and meaning, as a typed descriptor."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from components.world import Handle

T = TypeVar("T")
Vector = tuple[float, float]
Column = NDArray[Any]


class Role(Enum):
    """Who makes a fact, and therefore what saving, undo and snapshots do with it."""

    DOCUMENT = "document"  # a person made it: saved, changed by commands, undoable
    STATE = "state"  # time made it: saved, kept by snapshots
    DERIVED = "derived"  # computed from the others: never saved


class FieldError(ValueError):
    """A value that a Field cannot take; the message names the element, the value and the remedy."""


class Field(Generic[T]):
    """One column of a table, and the attribute of a handle that reads and writes one row of it.

    Reading gives a plain Python value (a vector is an immutable tuple). Assigning is a command: it is
    checked, undoable, and marks the column as changed.

    dtype: float, bool, int, str, "reference" (row of another table, stored as uint32) or object.
    shape: () or (2,).
    unit: unit inside the program and in files; `shown` is (unit, factor) on screen.
    minimum, maximum: inclusive limits; `above`: exclusive lower limit.
    nullable: None is allowed and stored as NaN.
    references: the table that a reference points into.
    overrides: the derived Field of the same handle that this one replaces when it is not None.
    overridden_by: on a derived Field, the one that assigning to it sets instead.
    choices: the values that a text may take (None: any).
    key: the name in model files, where it differs from the attribute's.
    checker: replaces the built-in check for values of dtype object.
    """

    name: str = ""

    def __init__(
        self,
        unit: str = "",
        *,
        title: str,
        doc: str,
        default: Any = 0.0,
        dtype: Any = float,
        shape: tuple[int, ...] = (),
        role: Role = Role.DOCUMENT,
        shown: tuple[str, float] | None = None,
        minimum: float | None = None,
        maximum: float | None = None,
        above: float | None = None,
        nullable: bool = False,
        references: str | None = None,
        overrides: str | None = None,
        overridden_by: str | None = None,
        choices: tuple[str, ...] | None = None,
        key: str | None = None,
        checker: Callable[[Any, str], Any] | None = None,
    ) -> None:
        self.unit = unit
        self.title = title
        self.doc = doc
        self.default = default
        self.dtype = dtype
        self.shape = shape
        self.role = role
        self.shown = shown if shown is not None else (unit, 1.0)
        self.minimum = minimum
        self.maximum = maximum
        self.above = above
        self.nullable = nullable
        self.references = references
        self.overrides = overrides
        self.overridden_by = overridden_by
        self.choices = choices
        self.checker = checker
        self._key = key

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @property
    def key(self) -> str:
        """The name of this fact in model files."""
        return self._key or self.name

    @overload
    def __get__(self, handle: None, owner: type) -> Field[T]: ...
    @overload
    def __get__(self, handle: Handle, owner: type) -> T: ...
    def __get__(self, handle: Handle | None, owner: type) -> Field[T] | T:
        if handle is None:
            return self
        value: T = handle.world.read(handle, self)
        return value

    def __set__(self, handle: Handle, value: T | None) -> None:
        handle.world.write(handle, self, value)

    # --- storage ---------------------------------------------------------------------------------

    @property
    def storage(self) -> np.dtype[Any]:
        """The numpy type of the column."""
        if self.dtype == "reference":
            return np.dtype(np.uint32)
        return np.dtype(
            {float: np.float64, bool: np.bool_, int: np.int64, str: object, object: object}[self.dtype]
        )

    def allocate(self, rows: int) -> Column:
        """A column of `rows` rows holding the default."""
        column = np.empty((rows, *self.shape), dtype=self.storage)
        column[...] = self.stored(self.default) if self.storage != np.dtype(object) else None
        if self.storage == np.dtype(object):
            column[:] = [self.default] * rows
        return column

    def stored(self, value: Any) -> Any:
        """A checked Python value as it is kept in the column."""
        return math.nan if value is None and self.dtype is float else value

    def loaded(self, value: Any) -> Any:
        """A column's entry as a plain Python value."""
        if self.storage == np.dtype(object):
            return value
        if self.shape:
            return tuple(value.tolist())
        plain = value.item()
        return None if self.nullable and plain != plain else plain

    # --- checking --------------------------------------------------------------------------------

    def check(self, value: Any, where: str) -> Any:
        """Return `value` normalised, or raise FieldError naming `where` (such as "rod AB")."""
        if value is None and self.nullable:
            return None
        if self.checker is not None:
            return self.checker(value, where)
        if self.dtype is float or self.dtype is int:
            return self._check_numbers(value, where)
        if self.dtype is bool:
            return self._check_flags(value, where)
        if self.dtype is str:
            return self._check_text(value, where)
        return value

    def _check_numbers(self, value: Any, where: str) -> Any:
        if not self.shape:
            return self._check_number(value, where, self.title)
        values = self._components(value, where, "numbers")
        return tuple(
            self._check_number(v, where, f"{self.title} {axis}") for v, axis in zip(values, "xy", strict=True)
        )

    def _check_number(self, value: Any, where: str, title: str) -> Any:
        if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.number):
            raise FieldError(f"{where}: {title} is {value!r}; it must be a number.")
        number = self.dtype(value)
        if not math.isfinite(number):
            raise FieldError(f"{where}: {title} is {number}; it must be a finite number.")
        problem = self.limit_broken_by(number)
        if problem:
            raise FieldError(f"{where}: {title} is {number:g}{self._in_unit}; it must be {problem}.")
        return number

    def limit_broken_by(self, number: float) -> str | None:
        """The limit that a number breaks, in words, or None."""
        if self.above is not None and not number > self.above:
            return f"greater than {self.above:g}{self._in_unit}"
        if self.minimum is not None and number < self.minimum:
            return f"at least {self.minimum:g}{self._in_unit}"
        if self.maximum is not None and number > self.maximum:
            return f"at most {self.maximum:g}{self._in_unit}"
        return None

    def _check_flags(self, value: Any, where: str) -> Any:
        values = self._components(value, where, "true or false") if self.shape else [value]
        if not all(isinstance(v, bool | np.bool_) for v in values):
            raise FieldError(f"{where}: {self.title} is {value!r}; it must be true or false.")
        flags = tuple(bool(v) for v in values)
        return flags if self.shape else flags[0]

    def _check_text(self, value: Any, where: str) -> str:
        if not isinstance(value, str):
            raise FieldError(f"{where}: {self.title} is {value!r}; it must be a text.")
        if self.choices is not None and value not in self.choices:
            raise FieldError(f"{where}: {self.title} is '{value}'; choose one of {', '.join(self.choices)}.")
        return value

    def _components(self, value: Any, where: str, of_what: str) -> list[Any]:
        if isinstance(value, str | bytes | Mapping) or not hasattr(value, "__len__"):
            raise FieldError(f"{where}: {self.title} is {value!r}; it must be a pair of {of_what}, [x, y].")
        if len(value) != self.shape[0]:
            raise FieldError(f"{where}: {self.title} has {len(value)} entries; it must have two, [x, y].")
        return list(value)

    @property
    def _in_unit(self) -> str:
        return f" {self.unit}" if self.unit else ""

    def check_column(self, values: Any, rows: int, where: str) -> Column:
        """Check a whole column at once; shape (rows, *shape) after broadcasting. Raises FieldError."""
        if self.storage == np.dtype(object):
            return self._object_column(values, rows)
        column = np.empty((rows, *self.shape), dtype=self.storage)
        try:
            column[...] = np.asarray(values, dtype=self.storage)
        except (TypeError, ValueError) as error:
            raise FieldError(f"{where}: {self.title} must be {rows} rows of numbers ({error}).") from None
        if self.dtype is float:
            self._check_limits(column, where)
        return column

    @staticmethod
    def _object_column(values: Any, rows: int) -> Column:
        column = np.empty(rows, dtype=object)
        column[:] = list(values)
        return column

    def _check_limits(self, column: Column, where: str) -> None:
        ok = np.isfinite(column) | (np.isnan(column) if self.nullable else False)
        with np.errstate(invalid="ignore"):
            if self.above is not None:
                ok &= ~(column <= self.above)
            if self.minimum is not None:
                ok &= ~(column < self.minimum)
            if self.maximum is not None:
                ok &= ~(column > self.maximum)
        if ok.all():
            return
        first = tuple(int(i) for i in np.argwhere(~ok)[0])
        self._check_number(float(column[first]), f"{where} {first[0]}", self.title)
