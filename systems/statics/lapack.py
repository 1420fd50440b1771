"""LAPACK's symmetric factorisation, without the rest of scipy.linalg around it.

Importing scipy.linalg takes 0.12 s, longer than most structures take to settle; the module of scipy that holds LAPACK
takes 3 ms.
"""

from __future__ import annotations

import sys
from functools import cache
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from typing import Any

HOLDS_LAPACK = "scipy.linalg._flapack"


@cache
def lapack() -> Any:
    """The module with dsytrf and dsytrs; scipy.linalg.lapack, which has the same, where scipy keeps it elsewhere."""
    import scipy

    if HOLDS_LAPACK in sys.modules:
        return sys.modules[HOLDS_LAPACK]
    spec = PathFinder.find_spec(HOLDS_LAPACK, [str(Path(scipy.__file__).parent / "linalg")])
    if spec is None or spec.loader is None:
        import scipy.linalg.lapack

        return scipy.linalg.lapack
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return sys.modules.setdefault(HOLDS_LAPACK, module)  # scipy.linalg takes the same one
