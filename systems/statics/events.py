"""What happens to a structure while its load grows, in words and numbers."""

from __future__ import annotations

from dataclasses import dataclass

from systems.statics.equations import Array


@dataclass(frozen=True)
class Event:
    """Something that happened on the way to a load factor.

    kind: "yield", "plastic mechanism", "snap-through", "bifurcation", "collapse", "mechanism",
        "free body" or "note".
    load_factor: at which it happened. rods: names of those concerned.
    motion: of all particles, (n, 2), the largest of them 1 long; None if nothing moves.
    """

    kind: str
    load_factor: float
    message: str
    rods: tuple[str, ...] = ()
    motion: Array | None = None


class NoEquilibrium(Exception):
    """There is no equilibrium to go on to; status: "mechanism", "collapse" or "limit reached"."""

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status
