"""LAPACK without scipy.linalg around it: the same functions, wherever scipy keeps them."""

import sys
from collections.abc import Iterator

import numpy as np
import pytest
import scipy.linalg.lapack

from pinjoint.systems.statics import factor as ours


@pytest.fixture(autouse=True)
def _found_anew() -> Iterator[None]:
    ours.lapack.cache_clear()
    yield
    ours.lapack.cache_clear()


def test_it_is_the_module_that_scipy_uses() -> None:
    assert ours.lapack().dsytrf is scipy.linalg.lapack.dsytrf
    assert ours.lapack().dsytrs is scipy.linalg.lapack.dsytrs


def test_it_is_found_before_scipy_loads_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, ours.HOLDS_LAPACK)
    found = ours.lapack()
    assert found is not scipy.linalg.lapack
    matrix, right = np.array([[2.0, 1.0], [1.0, -3.0]]), np.array([1.0, 2.0])
    solutions = []
    for library in (found, scipy.linalg.lapack):
        factors, swaps, info = library.dsytrf(matrix, lower=1)
        assert info == 0
        solutions.append(library.dsytrs(factors, swaps, right, lower=1)[0])
    assert np.array_equal(*solutions)


def test_scipy_is_asked_where_it_keeps_lapack_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ours, "HOLDS_LAPACK", "scipy.linalg._elsewhere")
    assert ours.lapack() is scipy.linalg.lapack
