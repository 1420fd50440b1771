"""What kernels become before the optimiser sees them: elements of arrays of every kind, shapes, arguments, errors."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint.systems import cache
from pinjoint.systems.kernels import compiled, kept
from pinjoint.systems.machine_code import machine_code


class Place(IntEnum):
    """A place in an array."""

    SECOND = 1


SECOND = Place.SECOND


@compiled
def looked_up(grid: Any, row: Any, column: Any) -> Any:
    """Elements by integers of several types, from both ends, and through a row of its own."""
    whole = grid[row]
    return (
        grid[row, column],
        grid[-1, -2],
        grid[np.uint32(1), np.int8(-1)],
        grid[SECOND, 0],
        whole[column],
        whole[SECOND],
        grid.shape[0] * 10 + grid.shape[1],
    )


@compiled
def written(grid: Any, row: Any, value: Any) -> Any:
    """Elements are set; an argument gets another value."""
    grid[row, 0] = value
    grid[-1, SECOND] = value
    row = row + 1
    grid[row, -1] = value
    return row


@compiled
def strict(x: float) -> float:
    """Raise ValueError for what is too large."""
    if x > 2.0:
        raise ValueError("too large", x)
    return x


@kept()
def look_up(grid: Any, row: Any, column: Any) -> Any:
    return looked_up(grid, row, column)


@kept()
def write(grid: Any, row: Any, value: Any) -> Any:
    return written(grid, row, value)


@kept()
def be_strict(x: float) -> float:
    return strict(x)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty cache."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)


def rows(kind: Any) -> np.ndarray:
    return (np.arange(12).reshape(3, 4) % 5).astype(kind)


ORDERS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "C": lambda grid: grid,
    "F": np.asfortranarray,
    "strided": lambda grid: np.repeat(grid, 2, axis=1)[:, ::2],
}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("kind", [np.float64, np.int32, np.uint8, np.bool_])
def test_elements_are_those_of_python(kind: Any, order: str) -> None:
    grid = ORDERS[order](rows(kind))
    for row, column in ((0, 2), (-2, -1), (np.uint32(2), np.int16(-4))):
        assert machine_code(look_up)(grid, row, column) == looked_up.py_func(grid, row, column)


def test_arrays_that_are_only_read_are_read() -> None:
    grid = rows(float)
    grid.flags.writeable = False
    assert machine_code(look_up)(grid, 1, 1) == looked_up.py_func(grid, 1, 1)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("kind", [np.float64, np.int32, np.bool_])
def test_elements_are_written_as_in_python(kind: Any, order: str) -> None:
    ours, theirs = ORDERS[order](rows(kind)).copy(), rows(kind)
    assert machine_code(write)(ours, 0, 1) == written.py_func(theirs, 0, 1)
    assert np.array_equal(ours, theirs)


def test_an_error_of_what_is_called_holds_its_values() -> None:
    assert machine_code(be_strict)(2.0) == 2.0
    with pytest.raises(ValueError, match=r"\('too large', 3\.0\)"):
        machine_code(be_strict)(3.0)
