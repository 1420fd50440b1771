"""How every kernel is compiled: IEEE division (no exception), no fastmath, so that bits are reproducible."""

from numba import njit

compiled = njit(error_model="numpy")
