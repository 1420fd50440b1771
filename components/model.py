"""Model: the world of a Pinjoint document, with its particles, rods and everything around them."""

from __future__ import annotations

from typing import Any, cast

from components.clock import Clock
from components.derived import DERIVATIONS
from components.environment import Environment
from components.grid import Grid
from components.handle import Handle
from components.load import Load
from components.particle import Particle
from components.rod import Rod
from components.settings import Settings
from components.table import Table
from components.world import World

KINDS = (Environment, Settings, Clock, Particle, Rod, Load, Grid)
ADDED: dict[str, type[Handle]] = {}  # kinds of mods, as files call them: "walls.Wall"


class Model(World):
    """A world with the tables every Pinjoint document has.

    foreign: by entity, what its element of the model file held for mods' components, kept verbatim.
    foreign_kinds: the elements of kinds of mods that are not loaded, as in ADDED, kept likewise.
    """

    def __init__(self) -> None:
        super().__init__((*KINDS, *ADDED.values()), DERIVATIONS)
        self._environment = cast(Environment, self.tables["environment"][0])
        self._settings = cast(Settings, self.tables["settings"][0])
        self._clock = cast(Clock, self.tables["clock"][0])
        self.title = ""
        self.description = ""
        self.foreign: dict[int, dict[str, Any]] = {}
        self.foreign_kinds: dict[str, Any] = {}

    @property
    def particles(self) -> Table[Particle]:
        return self.tables["particles"]

    @property
    def rods(self) -> Table[Rod]:
        return self.tables["rods"]

    @property
    def loads(self) -> Table[Load]:
        return self.tables["loads"]

    @property
    def grids(self) -> Table[Grid]:
        return self.tables["grids"]

    @property
    def environment(self) -> Environment:
        return self._environment

    @property
    def settings(self) -> Settings:
        return self._settings

    @property
    def clock(self) -> Clock:
        return self._clock
