"""Parts: kernels that only other kernels call."""

import numpy as np
import pytest
from numba import njit

from systems.kernels import part


@part()
def double(x):  # type: ignore[no-untyped-def]
    return x + x


@part()
def sum_of_doubles(values):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(values.shape[0]):
        total += double(values[i])
    return total


@njit(error_model="numpy")
def entry(values):  # type: ignore[no-untyped-def]
    return sum_of_doubles(values) + double(1.5) + double(2) + double(values.shape[0])


def test_a_part_of_a_part_computes_what_python_does() -> None:
    assert entry(np.array([0.25, 3.0])) == 6.5 + 3.0 + 4 + 4


def test_constants_make_no_version_of_a_part_of_their_own() -> None:
    entry(np.ones(2))
    assert sorted(str(kind) for (kind,) in double.overloads) == ["float64", "int64"]  # type: ignore[attr-defined]


def test_a_part_that_is_called_from_python_says_so() -> None:
    entry(np.ones(2))
    with pytest.raises(TypeError, match="double is a part of programs"):
        double(1.5)
