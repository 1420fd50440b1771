"""Checkpoint: a point in a run that one can return to and go on from, bit for bit."""

from __future__ import annotations

from dataclasses import dataclass

from pinjoint.components.field import Column
from pinjoint.components.snapshot import Snapshot


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """The state after a step, and how far edits are accounted for in it. The document is not part of it.

    state: all of it, or only the clock's where nothing else can have changed since.
    armed: the energy account and the step size fit the document.
    before_edit: measures of the state before edits that are not accounted for yet.
    stable_step, warning: of the simulation then. binding: `Programs.bindings` at that time; another
    number means that another plan is bound.
    """

    state: Snapshot
    time: float
    armed: bool
    before_edit: Column | None
    stable_step: float
    warning: str
    binding: int

    @property
    def whole(self) -> bool:
        """True if it keeps all of the state."""
        return "particles.displacement" in self.state.columns
