"""Menu: what can be done at a place, in a list that opens there."""

from __future__ import annotations

from dataclasses import dataclass

from pinjoint.components.field import Vector
from pinjoint.components.toolbar import Tool


@dataclass(frozen=True)
class Menu:
    """Entries in groups under a title, opened at a pixel, where they act.

    chosen: the number of the entry that keys have come to; -1: none yet. pointed: where the pointer was then; once it
    is elsewhere, the entry under it counts.
    """

    title: str
    groups: tuple[tuple[Tool, ...], ...]
    at: Vector
    chosen: int = -1
    pointed: Vector | None = None

    @property
    def entries(self) -> tuple[Tool, ...]:
        """The entries of all groups, from the top."""
        return tuple(tool for group in self.groups for tool in group)
