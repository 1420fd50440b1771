"""What happens between the steps of a program: a kernel, compiled by itself, that tells the program what to do next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from components.field import Column
from components.model import Model
from systems.interpreter import in_lists
from systems.kernels import Kernel
from systems.program.compiler import GeneratedModule


@dataclass(frozen=True)
class Between:
    """A kernel that step programs call by its address, so that it is compiled once for all of them.

    module: holds the kernel, as `collide`. idle: arrays of the kernel with which nothing happens between steps.
    support: the forces on particles (kN) that last from the step that led to the present state.
    """

    module: GeneratedModule
    kernel: Kernel
    idle: Callable[[], Any]
    support: Callable[[Model], Column]

    def function(self, *, compiled: bool) -> Any:
        """The kernel in one of its forms, to hand to a program in the same."""
        if compiled:
            from systems.machine_code import addressed

            form = self.module.form if self.module.is_loaded else self.module.load()
            return addressed(form.collide)
        return in_lists(self.kernel)
