"""Handle: the component of an entity, through which its Fields are read and written."""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Callable, Collection, Mapping
from itertools import repeat
from operator import attrgetter
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column
from pinjoint.components.language import tr
from pinjoint.components.table import Store, Table, refuse_orphans
from pinjoint.components.wording import as_said, missing

_NAME = attrgetter("name")


class Handle:
    """The component of an entity: its identity, whose Fields read and write one row of a table.

    It refers to its world weakly: esper keeps every component, and so would keep every world for ever.
    """

    __slots__ = ("_world", "entity")

    table: ClassVar[str]  # name of the table, such as "rods"
    noun: ClassVar[str]  # what a person calls one, such as "rod"
    single: ClassVar[bool] = False  # exactly one in every world
    points: ClassVar[tuple[str, ...]] = ()  # Fields that are places in the plane (m), which move with it

    _world: weakref.ref[Store]
    entity: int

    def __init__(self) -> None:
        raise TypeError(
            tr(
                "A {noun} is part of a model; model.create({name}) makes one.",
                noun=tr(self.noun),
                name=type(self).__name__,
            )
        )

    @classmethod
    def of_world(cls, world: Store, count: int) -> list[Self]:
        """So many new handles, of a world that is yet to give each an entity; only `World.create` makes any."""
        handles = list(map(cls.__new__, repeat(cls, count)))
        deque(map(_set_world, handles, repeat(weakref.ref(world))), maxlen=0)
        return handles

    if not TYPE_CHECKING:  # else type checkers would accept any name

        def __getattr__(self, name: str) -> Any:
            """Refuse an unknown name, and suggest the nearest."""
            inner = {*dir(Handle), *Handle.__annotations__}
            facts = [known for known in dir(type(self)) if known not in inner and not known.startswith("_")]
            raise AttributeError(missing(tr("attributes of {table}", table=tr(self.table)), name, facts))

        def __setattr__(self, name: str, value: Any) -> None:
            """Set a Field; a misspelt one is refused, in kinds without __slots__ too."""
            if not hasattr(type(self), name):
                getattr(self, name)
            super().__setattr__(name, value)

    @property
    def said(self) -> str:
        """Its name as it is read: "rod 7", which nobody gave, in the present language."""
        name: str = _NAME(self)
        return as_said(self.noun, name)

    @property
    def world(self) -> Store:
        """The world it belongs to. Raises LookupError if that is gone."""
        world = self._world()
        return world if world is not None else refuse_orphans(tr("this {noun}", noun=tr(self.noun)))

    @property
    def row(self) -> int:
        """The row of the table in which this entity's values are now. Raises LookupError if deleted."""
        return self.world.row(self)

    @property
    def exists(self) -> bool:
        """False once the entity is deleted (and True again when that is undone)."""
        world = self._world()
        return world is not None and bool(world.row_of_entity[self.entity] >= 0)

    @classmethod
    def completed(cls, columns: Mapping[str, Column], count: int) -> Mapping[str, Column]:
        """The checked columns that new elements are given, with what follows from them."""
        return columns

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """Adjust what depends on changed Fields of some rows, or refuse the change by FieldError.

        Called after rows were created (all Fields changed) or assigned to, or others deleted (no rows, no Fields), inside
        the same transaction.
        """

    def __repr__(self) -> str:
        if not self.exists:
            return f"<deleted {self.noun}>"
        if not self.single:
            return f"<{self.world.describe(self)}>"
        fields = self.world.tables[self.table].fields.values()
        values = (f"{field.name}={getattr(self, field.name)!r}" for field in fields if field.overrides is None)
        return f"<{self.noun}: {', '.join(values)}>"


# Setters of the slots, for many handles at once without __setattr__.
_set_world: Callable[[Handle, weakref.ref[Store]], None] = vars(Handle)["_world"].__set__
set_entity: Callable[[Handle, int], None] = vars(Handle)["entity"].__set__
