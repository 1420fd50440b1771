"""Tables: columns, their views, the order of rows and the index of names."""

from typing import Any

import numpy as np
import pytest

from pinjoint.components.field import Field, Role
from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.table import Table, fields_of
from pinjoint.components.world import World


class Bead(Handle):
    """A modder's element."""

    __slots__ = ()
    table, noun = "beads", "bead"

    name: Field[str] = Field(title="name", doc="Unique.", default="", dtype=str)
    colour: Field[str] = Field(title="colour", doc="Of it.", default="red", dtype=str)
    weight: Field[float] = Field("kg", title="weight", doc="Of it.", default=2.0)


class Marble(Bead):
    __slots__ = ()
    table, noun = "marbles", "marble"

    weight: Field[float] = Field("kg", title="weight", doc="Heavier.", default=3.0)
    size: Field[float] = Field("m", title="size", doc="Of it.")


class Thread(Handle):
    __slots__ = ()
    table, noun = "threads", "thread"

    through: Field[int] = Field(dtype="reference", references="beads", title="bead", doc="Row.", default=0)


def beads(count: int) -> tuple[World, Table[Bead]]:
    world = World([Bead])
    world.create(Bead, count, weight=np.arange(count, dtype=float))
    return world, world.tables["beads"]


# --- reading -----------------------------------------------------------------------------------------


def test_a_table_tells_what_it_holds() -> None:
    world, table = beads(2)
    first = table[0]
    assert first in table
    assert "bead 1" in table
    other, elsewhere = beads(2)
    assert first.world is not other
    assert first not in elsewhere
    assert 0 not in table
    world.delete([first])
    assert first not in table
    with pytest.raises(IndexError, match="There is no row 2; there are 1 beads"):
        table[2]


def test_a_name_or_column_that_is_not_there_is_explained() -> None:
    _, table = beads(3)
    with pytest.raises(KeyError, match=r"There is no 'bed 2' among the beads; did you mean 'bead 2'\?"):
        table["bed 2"]
    with pytest.raises(AttributeError, match="'wieght' among the columns of beads; did you mean 'weight'"):
        _ = table.wieght


def test_subclasses_inherit_fields_and_may_replace_them() -> None:
    fields = fields_of(Marble)
    assert [field.name for field in fields] == ["name", "colour", "weight", "size"]
    assert fields[2].default == 3.0
    world = World([Bead, Marble])
    [bead], [marble] = world.create(Bead), world.create(Marble)
    assert (bead.weight, marble.weight, marble.colour) == (2.0, 3.0, "red")


def test_only_state_and_derived_columns_are_granted_for_writing() -> None:
    model = Model()
    model.create(Particle, 2)
    model.writable("particles.velocity")[...] = 1.0
    assert model.particles.velocity.tolist() == [[1.0, 1.0]] * 2
    with pytest.raises(ValueError, match=r"particles\.position is part of the document"):
        model.writable("particles.position")


# --- views over time -----------------------------------------------------------------------------------


def test_a_view_follows_its_column_until_rows_come_or_go() -> None:
    world, table = beads(3)
    assert world.revision > 0
    view = table.weight
    table[0].weight = 7.0
    assert view.tolist() == [7.0, 1.0, 2.0]


@pytest.mark.parametrize("change", ["grow", "delete", "undo"])
def test_a_view_from_before_shows_the_past_and_cannot_write(change: str) -> None:
    world, table = beads(6)
    log: list[Any] = []
    world.on_command = log.append
    if change == "undo":
        world.delete([table[0], table[3]])
    weights, ids = table.weight, table.entities
    past = weights.tolist(), ids.tolist()
    if change == "grow":
        world.create(Bead, 1000)
    elif change == "delete":
        world.delete([table[0], table[3]])
    else:
        world.apply(log.pop())
    table[1].weight = -1.0
    assert (weights.tolist(), ids.tolist()) == past
    with pytest.raises(ValueError, match="read-only"):
        weights[0] = 5.0
    assert table.weight[1] == -1.0


# --- growing and shrinking -----------------------------------------------------------------------------


def test_capacity_doubles_so_that_appending_is_cheap() -> None:
    world, table = beads(0)
    capacities = set()
    for _ in range(300):
        world.create(Bead)
        capacities.add(len(table.entity))
    assert len(capacities) == len(range(3, 10))  # 8, 16, ... 512
    assert table.weight.tolist() == [2.0] * 300


# --- names -----------------------------------------------------------------------------------------------


def test_names_given_stay_found_after_every_way_of_renaming() -> None:
    world, table = beads(3)
    first, second, third = table
    log: list[Any] = []
    world.on_command = log.append
    world.assign([first, second, third], "name", ["bead 2", "bead 3", "bead 1"])
    for bead in table:
        assert table[bead.name] is bead
    assert [first.name, second.name, third.name] == ["bead 2", "bead 3", "bead 1"]
    world.apply(log.pop())
    world.assign([first, first], "name", ["x", "y"])
    assert sorted(name for name in ("x", "y", "bead 1") if name in table) == ["y"]
    assert table["y"] is first


# --- columns added later -----------------------------------------------------------------------------------


def test_a_column_added_later_holds_its_default_everywhere() -> None:
    world, table = beads(3)
    log: list[Any] = []
    world.on_command = log.append
    world.delete([table[1]])
    shine: Field[float] = Field(title="shine", doc="Of it.", default=0.5, role=Role.STATE)
    shine.__set_name__(Bead, "shine")
    table.add_column(shine)
    assert table.shine.tolist() == [0.5, 0.5]
    world.writable("beads.shine")[...] = 1.0
    world.apply(log.pop())
    assert table.shine.tolist() == [1.0, 0.5, 1.0]
    with pytest.raises(ValueError, match="already has a column 'shine'"):
        table.add_column(shine)


def test_a_table_refers_only_to_those_declared_before_it() -> None:
    world = World([Bead, Thread])
    with pytest.raises(ValueError, match=r"threads\.through must refer to a table declared before threads"):
        World([Thread, Bead])
    link: Field[int] = Field(dtype="reference", references="threads", title="thread", doc="Row.", default=0)
    link.__set_name__(Bead, "link")
    with pytest.raises(ValueError, match=r"beads\.link must refer to a table declared before beads"):
        world.tables["beads"].add_column(link)


# --- references --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("column", ["name", "position", "fixed", "velocity"])
def test_what_is_read_cannot_be_made_writable(column: str) -> None:
    model = Model()
    model.create(Particle, 3, position=[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)])
    for seen in (model.particles.column(column), model.particles.entities, model.column("settings.sleeping")):
        for array in (seen, seen.view(), seen[1:]):
            with pytest.raises(ValueError, match="WRITEABLE"):
                array.flags.writeable = True
    before = model.particles.column(column).tolist()
    model.create(Particle, 50, position=[(float(x), 5.0) for x in range(50)])
    assert model.particles.column(column)[:3].tolist() == before
