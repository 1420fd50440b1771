"""Tables: columns, their views, the order of rows and the index of names."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from pinjoint.components.field import Field, Role
from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, spawn_rods
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


def test_a_table_is_read_by_row_by_name_and_in_order_of_creation() -> None:
    _, table = beads(20)
    assert len(table) == 20
    assert table["bead 3"] is table[2]
    assert table.names == [f"bead {n}" for n in range(1, 21)]
    assert [bead.weight for bead in table] == table.weight.tolist() == list(range(20))
    assert [table[row].row for row in range(20)] == list(range(20))
    assert "bead 20" in table
    assert "bead 21" not in table


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


def test_columns_and_ids_are_read_only() -> None:
    world, table = beads(3)
    for view in (table.weight, table.column("colour"), world.column("beads.name"), table.entities):
        with pytest.raises(ValueError, match="read-only"):
            view[0] = view[1]
    assert table.weight.tolist() == [0.0, 1.0, 2.0]


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


@pytest.mark.parametrize("gone", [[0], [4], [0, 4], [1, 2, 3], [0, 1, 2, 3, 4], [0, 2, 4]])
def test_deleting_keeps_the_order_of_the_others_and_undo_the_places(gone: list[int]) -> None:
    world, table = beads(5)
    log: list[Any] = []
    world.on_command = log.append
    before = table.weight.tolist(), table.names, list(table), table.entities.tolist()
    world.delete([table[row] for row in reversed(gone)])
    kept = [row for row in range(5) if row not in gone]
    assert table.weight.tolist() == kept
    assert table.names == [f"bead {row + 1}" for row in kept]
    world.create(Bead, 3, name=["x", "y", "z"])
    world.apply(log.pop())
    world.apply(log.pop())
    assert (table.weight.tolist(), table.names, list(table), table.entities.tolist()) == before
    assert [table[f"bead {n}"].row for n in range(1, 6)] == [0, 1, 2, 3, 4]


def test_a_table_emptied_can_be_filled_again() -> None:
    world, table = beads(5)
    world.delete(list(table))
    assert (len(table), table.weight.tolist(), table.names) == (0, [], [])
    world.create(Bead, 2)
    assert table.names == ["bead 1", "bead 2"]


# --- names -----------------------------------------------------------------------------------------------


def test_new_names_take_the_smallest_free_numbers() -> None:
    world, table = beads(0)
    world.create(Bead, 9)
    world.create(Bead, 9)
    world.delete(list(table))
    world.create(Bead, 3, name=["bead 2", "bead 4", "pearl"])
    world.create(Bead, 3)
    assert table.names[3:] == ["bead 1", "bead 3", "bead 5"]
    world.delete([table["bead 1"], table["bead 4"]])
    table["bead 3"].name = "amber"
    world.create(Bead, 4)
    assert table.names[-4:] == ["bead 1", "bead 3", "bead 4", "bead 6"]


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


@pytest.mark.parametrize("gone", [[0], [1], [3], [0, 3], [2, 1]])
def test_references_follow_the_rows_they_point_to(gone: list[int]) -> None:
    model = Model()
    particles = model.create(Particle, 4, position=[(0, 0), (1, 0), (1, 1), (0, 1)])
    pairs = list(itertools.combinations(range(4), 2))
    spawn_rods(model, pairs)
    log: list[Any] = []
    model.on_command = log.append
    model.delete([particles[row] for row in gone])
    left = [pair for pair in pairs if not set(pair) & set(gone)]
    assert [[end.name for end in rod.ends] for rod in model.rods] == [
        [f"particle {row + 1}" for row in pair] for pair in left
    ]
    assert model.rods.between.dtype == np.uint32
    model.apply(log.pop())
    assert model.rods.between.tolist() == [list(pair) for pair in pairs]
    assert isinstance(model.rods[0], Rod)


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


def test_what_was_read_follows_its_column() -> None:
    model = Model()
    model.create(Particle, 2, position=[(0.0, 0.0), (1.0, 0.0)])
    seen = model.particles.velocity
    model.writable("particles.velocity")[1] = (3.0, 4.0)
    assert seen[1].tolist() == model.particles.velocity[1].tolist() == [3.0, 4.0]
