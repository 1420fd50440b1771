"""Loads that change in time: one law per kind of history that a model uses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.cases import factor_of_each
from pinjoint.components.language import marked
from pinjoint.components.load import HistoryKind, flattened
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.systems.base import Law


class VaryingLoads(Law):
    """Loads whose history is of one kind; constant loads are part of the constant force."""

    each = "loads"
    unneeded = marked("no load has a history of this kind")
    reads = ("loads.on", "loads.force", "loads.history")
    adds = ("particles.force",)

    def __init__(self, kind: HistoryKind) -> None:
        self.kind, self.mod = kind, kind.mod
        self.name = f"loads.{kind.name}"  # type: ignore[misc]
        self.kernel = kind.factor  # type: ignore[misc]

    def _rows(self, model: Model) -> list[int]:
        histories = model.loads.history
        return [row for row, history in enumerate(histories) if history["kind"] == self.kind.name]

    def needs(self, model: Model) -> bool:
        return not (self.mod is not None and self.mod.off) and bool(self._rows(model))

    def arrays(self, model: Model) -> Mapping[str, NDArray[Any]]:
        """Particles, forces and flattened parameters of these loads."""
        rows = self._rows(model)
        values: list[float] = []
        first: list[int] = []
        begun: dict[int, int] = {}  # first index of the values of a history, which loads may share
        for row in rows:
            history = model.loads.history[row]
            if id(history) not in begun:
                begun[id(history)] = len(values)
                values += flattened(history[name] for name in self.kind.parameters)
            first.append(begun[id(history)])
        prefix, factor = self.name.replace(".", "_"), factor_of_each(model, "loads")[rows]
        return {
            **({f"{prefix}_moment": factor * model.loads.moment[rows]} if bends(model) else {}),
            f"{prefix}_on": np.ascontiguousarray(model.loads.on[rows]),
            f"{prefix}_force": factor[:, None] * model.loads.force[rows],
            f"{prefix}_values": np.array(values, dtype=np.float64),
            f"{prefix}_first": np.array(first, dtype=np.uint32),
        }
