"""The compiled drawing of large pictures, cached like the step programs."""

from __future__ import annotations

import inspect
from functools import cache

from game.program_cache import compile_module
from systems.render.raster import SIGNATURES, Raster


@cache
def load_raster() -> Raster:
    """The kernels, compiled (which takes some seconds) or from the cache."""
    from systems.render import kernels

    known = {f"{name}_kernel": getattr(kernels, name) for name in SIGNATURES}
    return Raster(compile_module(_source(kernels), known))


def _source(kernels: object) -> str:
    lines = ["from numba import njit", ""]
    for name, signature in SIGNATURES.items():
        parameters = ", ".join(inspect.signature(getattr(kernels, name).py_func).parameters)
        lines += [
            f'@njit("{signature}", error_model="numpy", cache=True)',
            f"def {name}({parameters}):",
            f"    {name}_kernel({parameters})",
            "",
        ]
    return "\n".join(lines)
