"""Extensions: all that mods add to the program, and the parts of Pinjoint that are written as mods."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Extensions:
    """What was added, by what it is and in the order in which it was; a mod that is withdrawn takes its entries back.

    Where Pinjoint has such things of its own that are looked up by name, they are among them.

    catalogues: by mod, its folder of translations. kinds: of elements, as files call them: "walls.Wall". obstacles: by kind
    of elements, what tells the Pieces with which particles collide. histories: kinds of histories of loads, by name.
    integrators: by the name that models use. systems, scenes: what makes one for every session. likes: by scene, the one of
    ours as in which all acts that it does not use otherwise. below, above: layers that
    draw below and above the elements. icons: the parts of each, by action. panels: what reads a panel beside the model.
    commands: of the command line, by name. folders: with models that are opened by name. versions: of the mods whose data
    files hold. upgrades: by mod, what brings such data up to date.

    mods: all that were found, those that come with the program first. faults: sentences about those that were left out
    or failed while the program ran, the oldest first.
    """

    catalogues: dict[str, Path] = field(default_factory=dict)
    kinds: dict[str, type[Any]] = field(default_factory=dict)
    obstacles: dict[type[Any], Callable[[Any], Any]] = field(default_factory=dict)
    histories: dict[str, Any] = field(default_factory=dict)
    integrators: dict[str, Any] = field(default_factory=dict)
    systems: list[Callable[[], Any]] = field(default_factory=list)
    scenes: list[Callable[[], Any]] = field(default_factory=list)
    likes: dict[str, str] = field(default_factory=dict)
    below: list[Callable[[Any], Any]] = field(default_factory=list)
    above: list[Callable[[Any], Any]] = field(default_factory=list)
    icons: dict[str, Any] = field(default_factory=dict)
    panels: list[Callable[[Any], Any]] = field(default_factory=list)
    commands: dict[str, Any] = field(default_factory=dict)
    folders: list[Path] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)
    upgrades: dict[str, Callable[[dict[str, Any], str], None]] = field(default_factory=dict)
    mods: list[Any] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def acts_in(self, scene: str, scenes: Collection[str]) -> bool:
        """Whether what acts in some scenes acts in this one: it is among them, or like one of them."""
        return scene in scenes or self.likes.get(scene) in scenes

    def last_fault(self, seen: int) -> str:
        """The mod that failed last and why; "" if no more failed than a person has seen."""
        return self.faults[-1] if len(self.faults) > seen else ""


EXTENSIONS = Extensions()  # of this process; several sessions with different mods are not asked for
