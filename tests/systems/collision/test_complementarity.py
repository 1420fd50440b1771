"""Contacts that push or open: against the least energy, found slowly, and where forces are not unique."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from pinjoint.systems.collision.driven.columns import Tried
from pinjoint.systems.collision.driven.kernels import complementarity
from tests.reference.complementarity import complementary as plainly


def complementary(slope: np.ndarray, gap: np.ndarray, forces: np.ndarray) -> tuple[np.ndarray, bool]:
    """Forces that leave gaps ≥ 0, where gaps follow forces by `slope`; False if none are found."""
    count = len(gap)
    search = np.zeros((len(Tried), count))
    search[Tried.GAP], search[Tried.FORCES] = gap, forces
    work = np.zeros((count, count + 1)), np.zeros((2, count), dtype=np.int64)
    found = complementarity.complementary(0, count, slope, search, *work)
    return search[Tried.FOUND], bool(found)


def problem(seed: int, contacts: int, freedoms: int) -> tuple[np.ndarray, np.ndarray]:
    """Lines of contacts on freedoms, and gaps without forces, that some motion could all open."""
    random = np.random.default_rng(seed)
    lines = random.normal(size=(contacts, freedoms))
    return lines, lines @ random.normal(size=freedoms)


@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 12))
@settings(max_examples=30)
def test_each_contact_pushes_or_is_open(seed: int, contacts: int, freedoms: int) -> None:
    """Also where more contacts than freedoms leave forces open; taken again, gaps that should be 0 are to round-off."""
    lines, gap = problem(seed, contacts, freedoms)
    slope = lines @ lines.T
    forces, scale = np.zeros(contacts), np.abs(gap).max()
    for _ in range(3):
        known = forces
        forces, found = complementary(slope, gap + slope @ known, known)
        assert found
        np.testing.assert_allclose(
            slope @ forces, slope @ plainly(slope, gap + slope @ known, known), atol=1e-9 * scale
        )
    left = gap + slope @ forces
    assert (forces >= 0.0).all()
    assert left.min() >= -1e-9 * scale
    assert np.abs(np.minimum(forces * np.diag(slope), left)).max() <= 1e-9 * scale
    # what moves goes the shortest way: min |Aᵀ F + b|² over F ≥ 0, where A b = gap
    shift = np.linalg.lstsq(lines, gap, rcond=None)[0]
    least, _ = nnls(lines.T, -shift)
    np.testing.assert_allclose(lines.T @ forces, lines.T @ least, atol=1e-8 * max(np.abs(shift).max(), 1.0))


def test_what_cannot_yield_is_not_pushed() -> None:
    slope = np.array([[2.0, 0.0], [0.0, 0.0]])
    forces, found = complementary(slope, np.array([-1.0, -1.0]), np.zeros(2))
    assert found
    assert forces == pytest.approx([0.5, 0.0])
