"""How the kernels of this package are compiled: as all others, but for two things.

References to arrays are not counted: kernels are given many arrays at once and allocate none, so that counting
would only double the time of an impact. Those that only other kernels call cannot be called from Python,
which halves the time it takes to compile them.
"""

from numba import njit

compiled = njit(error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)  # type: ignore[call-overload]
entry = njit(error_model="numpy", _nrt=False)  # type: ignore[call-overload]
