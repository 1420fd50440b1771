"""Assembly: matrices of structures as sums of those of their rods, full or sparse.

It is kept for the last structures, since a hand that drags changes neither rods nor unknowns: a frame of 104 members is
solved in 3 ms in place of 4.6.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, TypeAlias, Union

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array, Rows

if TYPE_CHECKING:  # only large structures need it
    from scipy.sparse import csc_matrix

Matrix: TypeAlias = Union[Array, "csc_matrix"]  # full up to DENSE unknowns, else sparse

SYMMETRIC = {"SymmetricMode": True}  # pivots on the diagonal
DENSE = 100  # unknowns up to which full matrices are faster


@dataclass(frozen=True)
class Assembly:
    """Where the entries of rods' matrices go. ends: rows of the particles at both ends, (rods, 2).

    shape: of a field over the particles. index: of the unknowns in a flattened field, (N,).
    """

    ends: Rows
    shape: tuple[int, ...]
    index: Rows
    sparse: bool

    @classmethod
    def of(cls, ends: Rows, unknown: NDArray[np.bool_], *, sparse: bool) -> Assembly:
        """That of a structure with these unknowns, (n, …), in an order that keeps factors sparse, if they may be."""
        return _assembly(ends.tobytes(), unknown.tobytes(), unknown.shape, sparse)

    def matrix(self, parts: Array) -> Matrix:
        """Sum of the rods' matrices (rods, coordinates of both ends, coordinates of both ends), flattened."""
        size = len(self.index)
        if not self.sparse:
            kept, place = self._places
            full = np.bincount(place, parts[kept], size**2).astype(np.float64)
            return full.reshape(size, size)
        from scipy.sparse import csc_matrix

        kept, slot, rows, starts = self._slots
        values = np.bincount(slot, parts[kept], len(rows))
        return csc_matrix((values, rows, starts), shape=(size, size))

    @cached_property
    def _places(self) -> tuple[Rows, Rows]:
        """Those of the rods' entries that are between unknowns, and the place of each in the flat matrix."""
        size, width = len(self.index), self.shape[1]
        number = np.full(self.shape[0] * width, -1, dtype=np.intp)
        number[self.index] = np.arange(size, dtype=np.intp)
        own = number.reshape(-1, width)[self.ends].reshape(-1, 2 * width)
        row = np.repeat(own, 2 * width, axis=1).ravel()
        column = np.tile(own, (1, 2 * width)).ravel()
        kept = np.flatnonzero((row >= 0) & (column >= 0))
        return kept, column[kept] * size + row[kept]

    @cached_property
    def _slots(self) -> tuple[Rows, Rows, NDArray[np.int32], NDArray[np.int32]]:
        """The same for compressed columns: entries, the slot of each, and the slots' rows and starts."""
        size = len(self.index)
        kept, place = self._places
        places, slot = np.unique(place, return_inverse=True)
        counts = np.bincount(places // size, minlength=size)
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        return kept, slot, (places % size).astype(np.int32), starts


@lru_cache(maxsize=4)
def _assembly(ends: bytes, unknown: bytes, shape: tuple[int, int], sparse: bool) -> Assembly:
    rods = np.frombuffer(ends, dtype=np.intp).reshape(-1, 2)
    index = np.flatnonzero(np.frombuffer(unknown, bool))
    if is_sparse := sparse and len(index) > DENSE:
        index = index[_sparse_order(rods, shape[1], shape[0], index)]
    return Assembly(rods, shape, index, is_sparse)


def _sparse_order(ends: Rows, width: int, particles: int, index: Rows) -> Rows:
    """The order of unknowns (by their indices in a flattened field) that keeps factors sparse."""
    from scipy.sparse import csc_matrix, identity
    from scipy.sparse.linalg import splu

    links = spread_by_ends(np.ones((len(ends), 2 * width)), ends, particles)[:, index]
    pattern = csc_matrix(links.T @ links + identity(len(index)))
    order = splu(pattern, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=SYMMETRIC).perm_c
    return np.argsort(order)


def spread_by_ends(entries: Array, ends: Rows, particles: int) -> csc_matrix:
    """A matrix (rows, width × n) of which each row has its entries (rows, 2 × width) at the coordinates of two particles."""
    from scipy.sparse import csc_matrix

    width = entries.shape[1] // 2
    columns = width * np.repeat(ends, width, axis=1) + np.tile(np.arange(width), 2)
    rows = np.repeat(np.arange(len(ends)), 2 * width)
    return csc_matrix((entries.ravel(), (rows, columns.ravel())), (len(ends), width * particles))
