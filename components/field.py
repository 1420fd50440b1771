"""Field: one fact about an entity, with its unit, limits, role and meaning, as a typed descriptor."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Set
from dataclasses import KW_ONLY, dataclass, field
from enum import Enum
from functools import partial
from typing import Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.language import decimals, joined, marked, tr
from pinjoint.components.mistake import Mistake, WrongValue
from pinjoint.components.wording import is_broken, quoted

T = TypeVar("T")
Vector = tuple[float, float]
Column = NDArray[Any]

# The usual unit on screen of lengths and of displacements, which may have another one, and how many of it are a metre.
CM, MOVED = ("cm", 100.0), ("displacement", 100.0)
LARGEST, SMALLEST = 1e30, 1e-30  # sizes of numbers to compute with, in inside units; SMALLEST of those above 0
_FEW = 8  # rows up to which checking values one by one is faster than as an array
# By a Field's dtype: the numpy type of its column, its default; and what numbers and flags given for a whole column may
# be: numpy's kinds, or the types in a list.
_STORAGE: dict[Any, tuple[Any, Any, str, set[type]]] = {
    float: (np.float64, 0.0, "fiu", {float, int, np.float64, np.int64}),
    bool: (np.bool_, False, "b", {bool, np.bool_}),
    int: (np.int64, 0, "i", {int, np.int64}),
    str: (object, "", "", set()),
    object: (object, None, "", set()),
    "reference": (np.uint32, 0, "iu", {int, np.int64, np.uint32}),
}


# What else is shown in place of a usual unit: the unit, and how many of it are one of the usual; see components/units.py.
SCREEN: dict[str, tuple[str, float]] = {}


def on_screen(usual: str) -> tuple[str, float]:
    """The unit that a person wants to see in place of a usual one, and how many of it are one of that."""
    return SCREEN.get(usual) or (CM[0] if usual == MOVED[0] else usual, 1.0)


class Role(Enum):
    """Who makes a fact, and therefore what saving, undo and snapshots do with it."""

    DOCUMENT = "document"  # a person made it: saved, changed by commands, undoable
    LOOK = "look"  # likewise, but it only says how the model is drawn: no run depends on it
    STATE = "state"  # time made it: saved, kept by snapshots
    DERIVED = "derived"  # computed from the others: never saved

    __hash__ = object.__hash__  # each is one of a kind, and looked up at every change


MADE = (Role.DOCUMENT, Role.LOOK)  # by a person
SAVED = (*MADE, Role.STATE)


class FieldError(Mistake, ValueError):
    """A value that a Field cannot take; the message names the element, the value and the remedy."""


@dataclass(eq=False, repr=False)
class Field(Generic[T]):
    """One column of a table, and the attribute of a handle that reads and writes one row of it.

    Reading gives a plain Python value (a vector is an immutable tuple). Assigning is a command: it is
    checked, undoable, and marks the column as changed.

    unit: unit inside the program and in files; `shown` is the usual (unit, factor) on screen, by default the same.
    title: what a person calls it; by default its name with spaces.
    dtype: float, bool, int, str, "reference" (row of another table, stored as uint32) or object.
    shape: () or (2,); wider where it is computed. axes: what its parts are called, as many as it has.
    default: what an element has that is given none; left out, None if that is allowed, else 0, False or "".
    minimum, maximum: inclusive limits; `above`: exclusive lower limit. Numbers that a person makes have limits
        anyway, so that all can be computed with: LARGEST, and SMALLEST where they are above 0.
    nullable: None is allowed and stored as NaN; `absent` is what a person calls it.
    references: the table that a reference points into.
    overrides: the derived Field of the same handle that this one replaces when it is not None, and whose name people and
        files know; assigning to that one, which knows it as overridden_by, sets this one instead.
    choices: the values that a text may take (None: any); a register may grow later.
    key: the name in model files, by default the attribute's.
    component: the mod's component that it is part of, such as "wind.Sail"; "": of Pinjoint's own.
    checker: checks values of dtype object; or texts further, in place of `choices`.
    storage: the numpy type of the column. plain: it is one number in every row, and never None.
    """

    unit: str = ""
    _: KW_ONLY
    doc: str
    title: str = ""
    default: Any = ...
    dtype: Any = float
    shape: tuple[int, ...] = ()
    axes: tuple[str, ...] = ()
    role: Role = Role.DOCUMENT
    shown: tuple[str, float] = ("", 0.0)
    minimum: float | None = None
    maximum: float | None = None
    above: float | None = None
    nullable: bool = False
    absent: str = marked("automatic")
    references: str | None = None
    overrides: str | None = None
    choices: Collection[str] | None = None
    key: str = ""
    checker: Callable[[Any, str], Any] | None = None
    name: str = field(default="", init=False)
    overridden_by: str | None = field(default=None, init=False)
    component: str = field(default="", init=False)

    def __post_init__(self) -> None:
        self.shape = self.shape or (len(self.axes),) * bool(self.axes)
        self.axes = self.axes or ("x", "y")
        if self.nullable and (self.shape or self.dtype in (int, bool, "reference")):
            raise WrongValue(
                "A Field that can be None must be one float, text or object ('{field}' is not).",
                field=self.title or self.doc,
            )
        if self.dtype == "reference":
            self.minimum, self.maximum = 0, np.iinfo(np.uint32).max
        if self.dtype is float and self.role in MADE:
            self._limit()
        if not self.shown[1]:
            self.shown = self.unit, 1.0
        self.derived = self.role is Role.DERIVED  # asked so often that comparing roles would be felt
        storage, default, self._kinds, self._types = _STORAGE[self.dtype]
        if self.default is ...:
            self.default = None if self.nullable else default
        self.storage: np.dtype[Any] = np.dtype(storage)
        self._has_objects = self.storage.hasobject
        self.plain = not (self.shape or self.nullable or self._has_objects)

    @property
    def on_screen(self) -> tuple[str, float]:
        """The unit that a person sees it in, and how many of it are one of the unit inside."""
        usual, factor = self.shown
        unit, more = on_screen(usual)
        return unit, factor * more

    def _limit(self) -> None:
        """Give the limits that every number has to those that are not stated."""
        if self.maximum is None:
            self.maximum = LARGEST
        if self.minimum is None:
            self.minimum = SMALLEST if self.above == 0.0 else -LARGEST if self.above is None else None

    def __set_name__(self, owner: type, name: str) -> None:
        known = self.overrides or name
        self.name = name
        self.key = self.key or known
        self.title = self.title or known.replace("_", " ")
        if self.overrides is not None:
            vars(owner)[self.overrides].overridden_by = name

    @overload
    def __get__(self, handle: None, owner: type) -> Field[T]: ...
    @overload
    def __get__(self, handle: object, owner: type) -> T: ...
    def __get__(self, handle: Any, owner: type) -> Field[T] | T:
        if handle is None:
            return self
        found: Field[T] | T = handle.world.read(handle, self)
        return found

    def __set__(self, handle: Any, value: T | None) -> None:
        handle.world.assign([handle], self.name, [value])

    # --- storage ---------------------------------------------------------------------------------

    def allocate(self, rows: int) -> Column:
        """A column of `rows` rows holding the default."""
        column = np.empty((rows, *self.shape), dtype=self.storage)
        if self._has_objects:
            column.fill(self.default)
        else:
            column[...] = self.stored(self.default)
        return column

    def stored(self, value: Any) -> Any:
        """A checked Python value as it is kept in the column."""
        return math.nan if value is None and self.dtype is float else value

    def loaded(self, column: Column, row: int) -> Any:
        """A column's entry as a plain Python value."""
        if self._has_objects:
            return column[row]
        if self.shape:
            return tuple(column[row].tolist())
        plain = column.item(row)
        return None if self.nullable and plain != plain else plain

    # --- checking --------------------------------------------------------------------------------

    def check_default(self, owner: str) -> None:
        """Raise FieldError if an element that is given no value could not be saved and read again."""
        where = tr("{owner}.{name}, its default", owner=owner, name=self.name)
        try:
            try:
                column = self.allocate(1)
            except (TypeError, ValueError):  # numpy's errors do not name the place
                self.check(self.default, where)
                raise
            self.check_column(column, 1, lambda row: where)
        except FieldError as error:
            raise FieldError(joined([str(error), tr("With nullable=True, None can be its default.")])) from None

    def check(self, value: Any, where: str) -> Any:
        """Return `value` normalised, or raise FieldError naming `where` (such as "rod AB")."""
        if value is None and self.nullable:
            return None
        if self.checker is not None and self.dtype is not str:
            return self.checker(value, where)
        if self.dtype in (float, int, "reference"):
            return self._check_numbers(value, where)
        if self.dtype is bool:
            return self._check_flags(value, where)
        if self.dtype is str:
            return self._check_text(value, where)
        return value

    def _check_numbers(self, value: Any, where: str) -> Any:
        if not self.shape:
            return self._check_number(value, where)
        values = self._components(
            value, where, marked("{where}: {title} is {value}; it must be a pair of numbers, {parts}.")
        )
        return tuple(self._check_number(v, where, axis) for v, axis in zip(values, self.axes, strict=True))

    def named(self, axis: str = "") -> str:
        """What a person calls it, or its part along an axis: "velocity x"."""
        return joined([tr(self.title), tr(axis) if axis not in ("", VALUE) else ""])

    def _refusal(self, message: str, where: str, value: Any, axis: str = "", **more: Any) -> FieldError:
        return FieldError(message, where=where, title=self.named(axis), value=quoted(value), **more)

    def unit_of(self, axis: str) -> str:
        """The unit of the part called so, "" being the whole; where parts have several, they stand in order: "kN·m, m"."""
        units = self.unit.split(", ")
        return units[self.axes.index(axis)] if axis and len(units) > 1 else self.unit

    def _check_number(self, value: Any, where: str, axis: str = "") -> Any:
        if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
            if self.dtype == "reference":
                what = marked("{where}: {title} is {value}; it must be an element, its name or its row.")
            else:
                what = marked("{where}: {title} is {value}; it must be a number.")
            raise self._refusal(what, where, value, axis)
        try:
            number: Any = float(value)
        except OverflowError:  # 10**400
            number = math.inf
        if not math.isfinite(number):
            message = marked("{where}: {title} is {value}; it must be a finite number.")
            raise self._refusal(message, where, number, axis)
        if self.dtype is not float and ((number := int(value)) != value or number.bit_length() > 63):
            message = marked("{where}: {title} is {value}; it must be a whole number below 2^63.")
            raise self._refusal(message, where, value, axis)
        self.check_limits(number, where, axis)
        return number

    def check_limits(self, number: float, where: str, axis: str = "") -> None:
        """Raise FieldError if a number, of the part along an axis if it has any, breaks a limit."""
        if limit := self.limit_broken_by(number):
            amount = joined([decimals(f"{number:.15g}"), self.unit])
            message = marked("{where}: {title} is {amount}; it must be {limit}.")
            raise self._refusal(message, where, number, axis, amount=amount, limit=limit)

    def limit_broken_by(self, number: float, *, shown: bool = False) -> str | None:
        """The limit that a number breaks, in words (in the unit on screen if `shown`), or None."""
        unit, factor = self.on_screen if shown else (self.unit, 1.0)

        def amount(limit: float) -> str:
            return joined([decimals(f"{limit * factor:g}"), unit])

        if self.above is not None and not number > self.above:
            return tr("greater than {limit}", limit=amount(self.above))
        if self.minimum is not None and number < self.minimum:
            return tr("at least {limit}", limit=amount(self.minimum))
        if self.maximum is not None and number > self.maximum:
            return tr("at most {limit}", limit=amount(self.maximum))
        return None

    def _check_flags(self, value: Any, where: str) -> Any:
        pair = marked("{where}: {title} is {value}; it must be a pair of true or false, {parts}.")
        values = self._components(value, where, pair) if self.shape else [value]
        if not all(isinstance(v, bool | np.bool_) for v in values):
            raise self._refusal(marked("{where}: {title} is {value}; it must be true or false."), where, value)
        flags = tuple(bool(v) for v in values)
        return flags if self.shape else flags[0]

    def _check_text(self, value: Any, where: str) -> Any:
        choices = self.choices if self.checker is None else None
        if choices is not None and not (isinstance(value, str) and value in choices):
            message = marked("{where}: {title} is {value}; choose one of {choices}.")
            raise self._refusal(message, where, value, choices=", ".join(choices))
        if not isinstance(value, str):
            raise self._refusal(marked("{where}: {title} is {value}; it must be a text."), where, value)
        if is_broken(value):
            message = marked("{where}: {title} is {value}; one of its characters is damaged. Type it again.")
            raise self._refusal(message, where, value)
        text = str(value)  # numpy's texts are of another type
        return text if self.checker is None else self.checker(text, where)

    def _components(self, value: Any, where: str, refusal: str) -> list[Any]:
        """The parts of a value. Raises FieldError, with this message if it has none."""
        parts = f"[{', '.join(self.axes)}]"
        if isinstance(value, str | bytes | Mapping | Set) or not np.iterable(value):
            raise self._refusal(refusal, where, value, parts=parts)
        values = list(value)
        if len(values) != self.shape[0]:
            message = marked("{where}: {title} needs two entries, {parts}; it has {count}.")
            raise self._refusal(message, where, value, count=len(values), parts=parts)
        return values

    # --- checking a whole column at once ------------------------------------------------------------

    def check_column(self, values: Any, rows: int, where: Callable[[int], str]) -> Column:
        """Check a list or array with a value for each row, or one value for all; shape (rows, *shape).

        `where(row)` is what a person calls the element in a row. Raises FieldError.
        """
        column = np.empty((rows, *self.shape), dtype=self.storage)
        plain = None if rows <= _FEW and isinstance(values, list) else self._plain(values)
        if plain is not None and plain.shape in (column.shape, self.shape):
            plain = np.broadcast_to(plain, column.shape)
            for row in np.flatnonzero(~self._allowed(plain))[:1].tolist():
                self.check(plain[row], where(row))
            column[...] = plain
            return column
        if isinstance(values, np.ndarray):
            values = values.tolist()
        items = values if isinstance(values, list | tuple) else [values] * rows
        if len(items) != rows:
            raise FieldError(
                "{title}: {count} values for {rows} elements; give one value for each element, or one for all.",
                title=self.named(),
                count=len(items),
                rows=rows,
            )
        any_text = self.dtype is str and self.choices is None and self.checker is None
        if any_text and set(map(type, items)) == {str} and not is_broken("".join(items)):
            column[:] = items
            return column
        known: dict[str | None, Any] = {}  # texts most elements share: many rods open in half the time
        for row, item in enumerate(items):
            shared = item is None or type(item) is str
            if not (shared and item in known):
                column[row] = self.stored(self.check(item, where(row)))
            if shared:
                column[row] = known.setdefault(item, column[row])
        return column

    def _plain(self, values: Any) -> Column | None:
        """`values` as an array, if they are of the right type already; NaN is None."""
        if not self._types or self.checker is not None:
            return None
        if isinstance(values, np.ndarray):
            return values if values.dtype.kind in self._kinds else None
        try:
            objects = np.array(values, dtype=object)
            given = objects.ravel().tolist()
            if not set(map(type, given)) <= self._types | ({type(None)} if self.nullable else set()):
                return None
            plain = objects.astype(np.int64 if self.dtype == "reference" else self.storage)
        except (ValueError, OverflowError):  # lists of unequal lengths; numbers out of range
            return None
        return plain if np.isnan(plain).sum() == given.count(None) else None

    def _allowed(self, values: Column) -> NDArray[np.bool_]:
        """Which rows of an array hold numbers that the Field can take, shape (rows,)."""
        ok: NDArray[np.bool_] = np.isfinite(values)
        if self.above is not None:
            ok &= values > self.above
        if self.minimum is not None:
            ok &= values >= self.minimum
        if self.maximum is not None:
            ok &= values <= self.maximum
        if self.nullable:
            ok |= np.isnan(values)
        return np.asarray(ok.all(axis=1)) if self.shape else ok


VALUE = marked("value")  # the part of a quantity that is called like the whole, beside where it is
ENDS = (marked("start"), marked("end"))  # of rods: the parts of what each end has of its own

# Fields that say how a model is drawn, that time makes, and that are computed from others; of them, of the ends of rods;
# and numbers above 0 that need not be given.
look = partial(Field, role=Role.LOOK)
state = partial(Field, role=Role.STATE)
derived = partial(Field, role=Role.DERIVED)
by_end = partial(derived, axes=ENDS)
if_known = partial(Field, nullable=True, above=0.0)


def same(first: Column, second: Column) -> bool:
    """True if two columns hold the same values, bit for bit."""
    if first.dtype == object:
        return bool(first.tolist() == second.tolist())
    return first.tobytes() == second.tobytes()
