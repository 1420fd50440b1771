"""How the kernels of this package are compiled: as all others, but for what makes that quicker.

References to arrays are not counted: kernels are given many arrays at once and allocate none, so that counting
would only double the time of an impact. Those that only other kernels call cannot be called from Python,
which halves the time it takes to compile them. What a program is made of becomes a part of it before anything is
optimised; as a function of its own, it would be optimised once more with all that it calls.
"""

from numba import njit

compiled = njit(error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)  # type: ignore[call-overload]
inlined = njit(error_model="numpy", _nrt=False, inline="always")  # type: ignore[call-overload]
