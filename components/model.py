"""Model: the world of a Pinjoint document, with its particles, rods and everything around them."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinjoint.components.clock import Clock
from pinjoint.components.commands import Assign
from pinjoint.components.derived import DERIVATIONS
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import MADE
from pinjoint.components.grid import Grid
from pinjoint.components.load import Load, SpanLoad
from pinjoint.components.particle import Particle, of_rigid_supports
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Environment, Settings
from pinjoint.components.slider import Slider
from pinjoint.components.table import Table
from pinjoint.components.world import World

KINDS = (Environment, Settings, Clock, Particle, Rod, Load, SpanLoad, Grid)


class Model(World):
    """A world with the tables every Pinjoint document has.

    foreign: by entity, what its element of the model file held for mods' components, kept verbatim.
    foreign_kinds: the elements of kinds of mods that are not loaded, as in EXTENSIONS.kinds, kept likewise.
    foreign_versions: the versions of the mods that wrote what the file held, by name.
    sliders: what can be moved on the canvas; the command SetSliders changes them.
    """

    # With more than 29 attributes in its dict, every access to a world would take longer.
    __slots__ = (
        "clock",
        "environment",
        "foreign_versions",
        "grids",
        "loads",
        "particles",
        "rods",
        "settings",
        "sliders",
        "span_loads",
    )

    def __init__(self) -> None:
        super().__init__((*KINDS, *EXTENSIONS.kinds.values()), DERIVATIONS)
        self.particles: Table[Particle] = self.tables["particles"]
        self.rods: Table[Rod] = self.tables["rods"]
        self.loads: Table[Load] = self.tables["loads"]
        self.span_loads: Table[SpanLoad] = self.tables["span_loads"]
        self.grids: Table[Grid] = self.tables["grids"]
        self.environment: Environment = self.tables["environment"][0]
        self.settings: Settings = self.tables["settings"][0]
        self.clock: Clock = self.tables["clock"][0]
        self.title = ""
        self.description = ""
        self.foreign: dict[int, dict[str, Any]] = {}
        self.foreign_kinds: dict[str, Any] = {}
        self.foreign_versions: dict[str, str] = {}
        self.sliders: tuple[Slider, ...] = ()

    def undeformed_copy(self) -> Model:
        """The same document at the beginning of time: only moved supports are displaced, and rods strained for good."""
        copy = Model()
        for name, table in self.tables.items():
            kept = [field.name for field in table.fields_in(*MADE)] + (
                ["plastic_strain", "plastic_rotation"] if name == "rods" else []
            )
            columns = {field: table.column(field) for field in kept}
            if name == "particles":
                columns["displacement"] = of_rigid_supports(self, table.storage("displacement"))
                columns["rotation"] = np.where(table.fixed_rotation, table.storage("rotation"), 0.0)
            if table.kind.single:
                [one] = copy.tables[name]
                for field, column in columns.items():
                    copy.apply(Assign(name, field, (one.entity,), column))
            else:
                copy.create(table.kind, table.count, **columns)
        return copy

    def __repr__(self) -> str:
        counts = ", ".join(
            f"{table.count} {name}" for name, table in self.tables.items() if not table.kind.single
        )
        return f"<Model '{self.title or 'untitled'}': {counts}>"
