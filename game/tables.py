"""Tables of results: columns of numbers beside names, written as they are read, in the window, on paper and as CSV."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Array
from pinjoint.components.field import on_screen
from pinjoint.components.language import decimals

_SMALL = 1e-2  # smaller numbers are written as multiples of a power of 1000


class Column:
    """Numbers of one kind below each other: with equal decimals, and a power of ten in the head if all are small.

    key: what programs call it. values: given in a usual unit, and kept in that on screen, `plain_unit`; NaN where there is
    none. alike: else each number is written by itself, as it stands beside a structure. summed: there is a sum at the foot;
    decimals are then such that what is written adds up, if two more are enough. size: of the largest number of its kind;
    None: that in the column. least: of what is no rounding.
    """

    def __init__(
        self,
        title: str,
        unit: str,
        values: Array,
        *,
        key: str = "",
        alike: bool = True,
        summed: bool = False,
        digits: int = written.DIGITS,
        size: float | None = None,
        least: float = 0.0,
    ) -> None:
        unit, factor = on_screen(unit)
        values = factor * np.where(np.abs(values) <= written.ROUNDING * least, 0.0, values)
        digits = written.wanted(digits)
        self.key, self.values, self.plain_unit, self.summed = key, values, unit, summed
        total = float(np.nansum(values))
        greatest = max(float(np.nanmax(np.abs(values), initial=0.0)), abs(total) if summed else 0.0)
        greatest = greatest if size is None else factor * size
        power = math.floor(math.log10(greatest)) if greatest > 0.0 else 0
        self.power = 0 if greatest >= _SMALL or not (greatest and alike) else 3 * math.floor(power / 3)
        self._scaled, self._total = values / 10.0**self.power, total / 10.0**self.power
        self._alike, self._digits = alike, digits
        self._decimals = max(digits - 1 - (power - self.power), 0)
        self._nothing = written.ROUNDING * greatest / 10.0**self.power
        if summed:
            self._decimals = self._adding_up()
        ten = f"10{str(self.power).translate(written.RAISED)} " if self.power else ""
        self.title, self.unit = title, f"{ten}{unit}".strip()

    def _adding_up(self) -> int:
        for places in range(self._decimals, self._decimals + written.MORE_DIGITS + 1):
            rounded = float(np.round(self._scaled, places).sum())
            if abs(rounded - round(self._total, places)) < 0.5 * 10.0**-places:
                return places
        return self._decimals

    @property
    def plain(self) -> list[Any]:
        """What stands in the rows, for programs; None where there is none."""
        return [None if value != value else value for value in self.values.tolist()]

    @property
    def head(self) -> str:
        """Title and unit."""
        return f"{self.title} ({self.unit})" if self.unit else self.title

    def text(self, row: int) -> str:
        """The number in a row; below the last one their sum, "" where there is none."""
        if row == len(self._scaled):
            return self._text(self._total) if self.summed else ""
        return self._text(float(self._scaled[row]))

    def _text(self, value: float) -> str:
        if abs(value) <= self._nothing:
            return "0"
        if math.isnan(value):
            return ""
        if not self._alike:
            return written.number(value, self._digits)
        return decimals(f"{round(value, self._decimals) + 0.0:.{self._decimals}f}".replace("-", "−"))


class Words(Column):
    """A word in each row, by whose letters rows are ordered."""

    def __init__(self, title: str, words: Sequence[str], *, key: str) -> None:
        super().__init__(title, "", np.unique(words, return_inverse=True)[1].astype(np.float64), key=key)
        self._words = words

    @property
    def plain(self) -> list[Any]:
        return list(self._words)

    def text(self, row: int) -> str:
        return self._words[row]


class Table(Sequence[tuple[str, ...]]):
    """Columns beside the names of what their rows belong to, below a head; each row is written on demand, since a large
    structure has more than fit a page."""

    def __init__(self, corner: str, names: Sequence[str], columns: Sequence[Column]) -> None:
        self.corner, self.names, self.columns = corner, names, columns
        self.summed = any(column.summed for column in columns)

    def __len__(self) -> int:
        return 1 + len(self.names) + self.summed

    @overload
    def __getitem__(self, index: int) -> tuple[str, ...]: ...
    @overload
    def __getitem__(self, index: slice) -> list[tuple[str, ...]]: ...
    def __getitem__(self, index: int | slice) -> tuple[str, ...] | list[tuple[str, ...]]:
        places = range(len(self))[index]
        return self._row(places) if isinstance(places, int) else [self._row(place) for place in places]

    def _row(self, place: int) -> tuple[str, ...]:
        if place == 0:
            return (self.corner, *(column.head for column in self.columns))
        name = "Σ" if place > len(self.names) else self.names[place - 1]
        return (name, *(column.text(place - 1) for column in self.columns))

    def rows(self) -> Iterator[Sequence[Any]]:
        """Headings and the numbers in full, None where there is none, for CSV; without sums and powers of ten.

        Titles that occur more than once follow those before them, as in "M max at x".
        """
        titles = [column.title for column in self.columns]
        said = (f"{titles[k - 1]} {t}" if titles.count(t) > 1 else t for k, t in enumerate(titles))
        heads = (f"{title} ({column.plain_unit})" for title, column in zip(said, self.columns, strict=True))
        yield self.corner, *(head.removesuffix(" ()") for head in heads)
        yield from zip(self.names, *(column.plain for column in self.columns), strict=True)
