"""The compiled drawing of large pictures."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from typing import Any

from systems.program.compiler import CompiledUnit
from systems.render.raster import SIGNATURES, Raster


@cache
def load_raster() -> Raster:
    """The compiled drawing; compiling it takes some seconds."""
    return Raster(RASTER.load())


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    from systems.render import kernels  # imports numba

    lines = ["from numba import njit", ""]
    for name, signature in SIGNATURES.items():
        parameters = ", ".join(inspect.signature(getattr(kernels, name).py_func).parameters)
        lines += [
            f'@njit("{signature}", error_model="numpy", cache=True)',
            f"def {name}({parameters}):",
            f"    {name}_kernel({parameters})",
            "",
        ]
    return "\n".join(lines), {f"{name}_kernel": getattr(kernels, name) for name in SIGNATURES}


RASTER = CompiledUnit("raster", _contents)
