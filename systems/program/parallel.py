"""Step programs of very large models, in blocks that cores share; and which kind of program a model gets."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column
from pinjoint.components.model import Model
from pinjoint.systems.base import CORES, Integrator, StepSystem
from pinjoint.systems.program.blocks import Layout
from pinjoint.systems.program.program import Program
from pinjoint.systems.program.reordered import ReorderedProgram
from pinjoint.systems.program.writer import VERY_MANY, form_of

_QUICK = ("omp", "tbb")  # threading layers that start the cores in some microseconds
_SPINS = "10000"  # some 0.1 ms that a core waits awake: waking it costs as much as a step of 10 000 rods
_WORTHWHILE = 100_000  # rods from which a layer that takes 50 µs to start the cores is worth it


_home = os.getpid()


def cores() -> int:
    """Number of cores that a computation may use: by PINJOINT_CORES, else as many as this process may.

    One in a process that was forked, for the threads of its parent are not there.
    """
    if os.getpid() != _home:
        return 1
    there = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    asked = os.environ.get(CORES, "")
    return min(max(int(asked), 1), there) if re.fullmatch("[0-9]{1,9}", asked) else there


def make_program(
    model: Model,
    systems: Sequence[StepSystem],
    integrator: Integrator,
    form: str = "",
    moving: NDArray[np.bool_] | None = None,
) -> Program:
    """The step program of a plan, in the form that suits the model or in another one.

    moving: which particles it moves, as in ReorderedProgram; None: all.
    """
    form = form or form_of(model, integrator, systems)
    if form == VERY_MANY:
        return BlockProgram(model, systems, integrator, form, moving)
    if moving is not None:
        return ReorderedProgram(model, systems, integrator, form, moving)
    return Program(model, systems, integrator, form)


class BlockProgram(ReorderedProgram):
    """A step program that holds its model in blocks, which cores share."""

    _versions: tuple[int, int] | None = None

    def bind(self) -> None:
        """Take hold of the model's columns: find blocks and copy rows anew."""
        self._block_cores = np.ones(1, dtype=np.int64)
        super().bind()

    def _find_layout(self) -> Layout:
        """The layout of the model, found anew if positions or rods changed."""
        model = self.model
        versions = model.particles.version("position"), model.rods.version("between")
        if versions != self._versions:
            self._whole, self._versions = Layout.of(model), versions
        return self._whole

    def _of_layout(self) -> dict[str, Any]:
        return super()._of_layout() | {
            "block_particles": self.layout.first_particle,
            "block_rods": self.layout.first_rod,
            "block_cores": self._block_cores,
        }

    def _column(self, path: str) -> Any:
        return None if path.startswith("block.") else super()._column(path)

    def _loads(self, prefix: str, ordered: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of a law of loads in order, and the first load of each block."""
        loads = super()._loads(prefix, ordered)
        first = np.searchsorted(loads[f"{prefix}_on"], self.layout.first_particle)
        return loads | {f"block_{prefix}": first}

    def _cores(self) -> int:
        """Number of cores that are worth using; results do not depend on it."""
        if not self.module.is_loaded:
            return 1
        os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # else idle threads spin for milliseconds
        os.environ.setdefault("GOMP_SPINCOUNT", _SPINS)
        import numba

        available = min(cores(), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]
        if available > 1:
            numba.set_num_threads(available)
            layer = numba.threading_layer()  # type: ignore[attr-defined]
            if layer not in _QUICK and self._rows("rods") < _WORTHWHILE:
                return 1
        return available

    def _of_no_rods(self) -> list[Column]:
        nothing = dict.fromkeys(("block_particles", "block_rods"), np.zeros(2, dtype=np.intp))
        return list((self.columns | nothing).values())

    def _load(self) -> None:
        self._block_cores[0] = self._cores() if self.module.is_loaded else 1
        super()._load()
