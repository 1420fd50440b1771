"""What happens between the steps of a program: kernels, compiled by themselves, that tell the program what to do next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from pinjoint.components.field import Column
from pinjoint.components.model import Model
from pinjoint.systems.interpreter import in_lists
from pinjoint.systems.kernels import Kernel
from pinjoint.systems.program.compiler import GeneratedModule


@dataclass(frozen=True)
class Between:
    """Kernels that step programs call by their addresses, so that they are compiled once for all of them.

    module: holds the kernels, by their names. idle: arrays of the kernels with which nothing happens between steps.
    support: the forces on particles (kN) that last from the step that led to the present state.
    """

    module: GeneratedModule
    kernels: Sequence[Kernel]
    idle: Callable[[], Any]
    support: Callable[[Model], Column]

    def functions(self, *, compiled: bool) -> list[Any]:
        """The kernels in one of their forms, to hand to a program in the same."""
        if compiled:
            from pinjoint.systems.machine_code import addressed

            form = self.module.form if self.module.is_loaded else self.module.load()
            return [addressed(getattr(form, kernel.py_func.__name__)) for kernel in self.kernels]
        return [in_lists(kernel) for kernel in self.kernels]
