"""Events: yielding, jumps and collapses of a structure while its load grows, in words and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.model import Model

RESTS = 1e-9  # of the largest motion: a smaller one counts as none


@dataclass(frozen=True)
class Event:
    """One event on the way to a load factor.

    kind: "yield", "hinge", "slack", "taut", "plastic mechanism", "snap-through", "bifurcation", "collapse", "mechanism",
        "free body" or "note"; "overshoot" or "other equilibrium" of a simulation compared with statics.
    load_factor: that of the event. rods: names of the rods concerned.
    motion: of all particles, (n, 2), where members bend with rotations (n, 3), the largest 1; None if nothing moves.
    place: of a plastic hinge, by name its "particle", "rod" and "end" ("start", "end"); else empty.
    """

    kind: str
    load_factor: float
    message: str
    rods: tuple[str, ...] = ()
    motion: NDArray[np.float64] | None = None
    place: Mapping[str, str] = field(default_factory=dict)

    def record(self, model: Model) -> dict[str, Any]:
        """It as plain data; its motion as {name: [x, y]}, or [x, y, rotation], of the particles that take part."""
        record: dict[str, Any] = {
            "kind": self.kind,
            "load_factor": self.load_factor,
            "message": self.message,
            "rods": list(self.rods),
            **self.place,
        }
        if self.motion is not None:
            names = model.particles.names
            taking_part = np.flatnonzero(np.abs(self.motion).max(axis=1) > RESTS)
            record["motion"] = {names[row]: self.motion[row].tolist() for row in taking_part}
        return record


class NoEquilibrium(Exception):
    """No further equilibrium; status: "mechanism", "collapse" or "limit reached".

    motion: what nothing resists in first-order theory, (n, …), the largest 1; None for other reasons.
    """

    def __init__(self, status: str, message: str, motion: NDArray[np.float64] | None = None) -> None:
        super().__init__(message)
        self.status, self.motion = status, motion
