"""Endless calls: where a kernel that others wrote does not return, it is named, and the process ends.

Nothing can stop machine code but that. A run of a mod with a loop that does not end hung in silence, and heard no Ctrl+C.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from typing import Any

from pinjoint.components.language import tr
from pinjoint.systems import is_ours
from pinjoint.systems.interpreter import plain_function

STATUS = 1  # of the process


class Patience:
    """seconds: that a call of a program with kernels of others may take, apart from compiling."""

    seconds = 600.0


def others_of(kernels: Iterable[Any]) -> list[Callable[..., Any]]:
    """Those kernels that are not ours."""
    return [k for k in kernels if callable(k) and not is_ours(k.__module__)]


def ending(function: Callable[..., Any], kernels: Iterable[Callable[..., Any]]) -> Callable[..., Any]:
    """A function that calls one of these kernels, and ends the process if it does not return."""

    def called(*given: Any) -> Any:
        ended = threading.Event()
        threading.Thread(target=_end, args=(ended, Patience.seconds, kernels), daemon=True).start()
        try:
            return function(*given)
        finally:
            ended.set()

    return called


def _end(ended: threading.Event, seconds: float, kernels: Iterable[Callable[..., Any]]) -> None:
    for _ in range(30):  # a compiler at work is waited for in between: it takes long where a machine is busy
        compiler = sys.modules.get("numba.core.compiler_lock")
        with compiler.global_compiler_lock if compiler is not None else nullcontext():
            pass
        if ended.wait(seconds / 30.0):
            return
    codes = [plain_function(kernel).__code__ for kernel in kernels]
    places = ", ".join(f"{code.co_name} ({code.co_filename}, {code.co_firstlineno})" for code in codes)
    said = tr(
        "A step has not ended for {seconds:g} s. It calls kernels of mods: {kernels}. Mend the loop that does not end,"
        " or run without the mod.",
        seconds=seconds,
        kernels=places,
    )
    print(f"pinjoint: {said}", file=sys.stderr, flush=True)
    os._exit(STATUS)
