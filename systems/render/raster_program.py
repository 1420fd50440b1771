"""The compiled drawing of large pictures, cached like the step programs."""

from __future__ import annotations

import inspect
from functools import cache
from typing import Any

from systems.program.compiler import compile_module, is_compiled, note_compiled
from systems.render.raster import SIGNATURES, Raster


@cache
def load_raster() -> Raster:
    """The kernels, compiled (which takes some seconds) or from the cache."""
    module = compile_module(*_parts())
    note_compiled(module)
    return Raster(module)


def has_raster() -> bool:
    """True if the kernels need not be compiled any more, only loaded."""
    return is_compiled(*_parts())


def _parts() -> tuple[str, dict[str, Any]]:
    """The source of the module, and the kernels that it wraps."""
    from systems.render import kernels

    known = {f"{name}_kernel": getattr(kernels, name) for name in SIGNATURES}
    return _source(kernels), known


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
