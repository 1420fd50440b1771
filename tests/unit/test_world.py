"""World: handles, commands, transactions, versions, derived columns, tags, and esper contexts."""

import gc
import weakref
from typing import Any

import esper
import numpy as np
import pytest
from numpy.typing import NDArray

from pinjoint.components.commands import Assign, Command, Delete, Group
from pinjoint.components.derived import DERIVATIONS
from pinjoint.components.field import FieldError, Role
from pinjoint.components.grid import Grid
from pinjoint.components.load import Load
from pinjoint.components.model import KINDS, Model
from pinjoint.components.particle import DEFAULT_MASS, Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Environment
from pinjoint.components.tags import DiagramShown, Selected
from pinjoint.components.world import Derivation, World
from tests.reference.lines import lines_run


def triangle() -> Model:
    """A(0,0), B(1,1), C(2,0) m with rods AB, BC, CA."""
    model = Model()
    model.create(Particle, 3, name=["A", "B", "C"], position=[(0, 0), (1, 1), (2, 0)])
    model.create(Rod, 3, between=[(0, 1), (1, 2), (2, 0)], name=["AB", "BC", "CA"])
    return model


def logged(model: World) -> list[Command]:
    log: list[Command] = []
    model.on_command = log.append
    return log


def snapshot(model: World) -> dict[str, Any]:
    """Everything in the tables, bit for bit."""
    return {
        f"{table.name}.{name}": column[: table.count].tolist()
        if column.dtype == object
        else column[: table.count].tobytes()
        for table in model.tables.values()
        for name, column in [("entity", table.entity), *((n, table.current(n)) for n in table.fields)]
    } | {table.name: list(table) for table in model.tables.values()}


# --- handles -----------------------------------------------------------------------------------------


def test_a_handle_outlives_its_entity_and_says_so() -> None:
    model = triangle()
    log = logged(model)
    rod = model.rods["AB"]
    model.delete([rod])
    assert not rod.exists
    assert repr(rod) == "<deleted rod>"
    for act in (lambda: rod.row, lambda: rod.stiffness, lambda: rod.ends):
        with pytest.raises(LookupError, match=r"This rod was deleted; undo brings it back\."):
            act()
    with pytest.raises(LookupError, match="This rod was deleted"):
        rod.stiffness = 1.0
    model.delete([rod])
    model.apply(log.pop())
    assert log == []
    assert rod.exists
    assert model.rods["AB"] is rod
    assert repr(rod) == "<rod AB>"


def test_a_command_for_a_deleted_entity_changes_nothing() -> None:
    model = triangle()
    rod = model.rods["AB"]
    model.delete([rod])
    before = snapshot(model)
    with pytest.raises(LookupError, match="was deleted"):
        model.execute(Assign("rods", "stiffness", (rod.entity,), np.array([1.0])))
    with pytest.raises(LookupError, match="was deleted"):
        model.assign([model.rods["BC"], rod], "stiffness", [1.0, 2.0])
    assert snapshot(model) == before


def test_what_there_is_one_of_is_neither_created_nor_deleted() -> None:
    model = Model()
    with pytest.raises(ValueError, match="A model has exactly one environment; it cannot be deleted"):
        model.delete([model.environment])
    with pytest.raises(ValueError, match="A model has exactly one environment; change that one"):
        model.create(Environment)
    assert len(model.tables["environment"]) == 1


# --- what is refused -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "columns", "message"),
    [
        (Particle, {"name": ["A"]}, "There is a particle 'A' already; choose another name."),
        (Particle, {"name": ["E", "E"]}, "There is a particle 'E' already; choose another name."),
        (Particle, {"name": ["E", " "]}, "The name of a particle is empty; type at least one character."),
        (Particle, {"name": "E", "position": [(0, np.nan)]}, "particle E: original position y is nan"),
        (Particle, {"radius": [0.0]}, "particle 1: radius is 0 m; it must be greater than 0 m."),
        (Particle, {"mass": [-2.0]}, "particle 1: mass is -2 kg; it must be greater than 0 kg."),
        (Particle, {"mobility": [(1, 1)]}, "particle: mobility is computed and cannot be set."),
        (
            Particle,
            {"raduis": [1.0]},
            "There is no 'raduis' among the fields of particles; did you mean 'radius'?",
        ),
        (Particle, {"position": [(5, 5)] * 3}, "original position: 3 values for 1 elements"),
        (
            Particle,
            {"fixed": [(False, True)], "velocity": [(1.0, 2.0)]},
            "particle 1: velocity y is 2 m/s, but a support holds it along y; set the velocity to 0 or free the direction.",
        ),
        (Rod, {"between": [(0, 0)]}, "rod 1: both ends are A; a rod needs two different particles."),
        (
            Rod,
            {"between": [(1, 0)]},
            "rod 1: rod AB joins B and A already; two particles share at most one rod.",
        ),
        (Rod, {"between": [(1, 3), (3, 1)]}, "rod 2: rod 1 joins D and B already"),
        (Rod, {"between": [(0, 9)]}, "rod 1: ends is row 9 of the particles, but there are only 4"),
        (Rod, {"between": [(0, -1)]}, "rod 1: ends y is -1; it must be at least 0."),
        (Rod, {"between": [(0, 4)]}, "rod 1: ends is row 4 of the particles"),
        (
            Rod,
            {"between": [(0, 3)]},
            "rod 1: its ends are at the same place; move one of them or give it a rest",
        ),
        (Rod, {}, "A new rod needs 'between': names, handles or rows of the particles."),
        (Load, {"on": [9]}, "load 1: particle is row 9 of the particles, but there are only 4"),
        (Load, {"force": [(1, 1)]}, "A new load needs 'on': names, handles or rows of the particles."),
        (
            Load,
            {"on": [0], "history": [{"kind": "x"}]},
            "load 1: there is no kind of history 'x'; choose one of constant, ",
        ),
    ],
)
def test_a_creation_refused_leaves_nothing_behind(kind: Any, columns: dict[str, Any], message: str) -> None:
    model = triangle()
    model.create(Particle, name="D")  # at the same place as A
    log = logged(model)
    before = snapshot(model)
    count = max((len(values) for values in columns.values() if len(values) == 2), default=1)
    with pytest.raises(FieldError) as refusal:
        model.create(kind, count, **columns)
    assert message in str(refusal.value)
    assert snapshot(model) == before
    assert log == []
    model.activate()
    assert len(esper.get_component(kind)) == model.tables[kind.table].count


@pytest.mark.parametrize(
    ("element", "field", "value", "message"),
    [
        ("rods.AB", "name", "BC", "There is a rod 'BC' already; choose another name."),
        ("rods.AB", "name", "  ", "The name of a rod is empty"),
        ("rods.AB", "between", (0, 0), "rod AB: both ends are A; a rod needs two different particles."),
        ("rods.AB", "between", (2, 1), "rod AB: rod BC joins C and B already"),
        ("rods.AB", "between", (0, 3), "rod AB: ends is row 3 of the particles, but there are only 3"),
        (
            "rods.AB",
            "between",
            ("A", "Q"),
            "rod AB: There is no 'Q' among the particles; choose one of A, B, C",
        ),
        ("particles.A", "position", (1, 1), "particle A: at this position rod AB would have no length"),
        ("particles.C", "position", (1, 1), "particle C: at this position rod BC would have no length"),
        ("particles.A", "velocity", (0, 1), "particle A: velocity y is 1 m/s, but a support holds it along y"),
        ("particles.A", "radius", -1, "particle A: radius is -1 m; it must be greater than 0 m."),
    ],
)
def test_an_assignment_refused_changes_nothing(element: str, field: str, value: Any, message: str) -> None:
    model = triangle()
    model.particles["A"].fixed = (False, True)
    log = logged(model)
    before = snapshot(model)
    table, name = element.split(".")
    with pytest.raises(FieldError) as refusal:
        setattr(model.tables[table][name], field, value)
    assert message in str(refusal.value)
    assert snapshot(model) == before
    assert log == []


def test_a_rest_length_of_its_own_lets_a_rods_ends_meet_and_cannot_go_back() -> None:
    model = triangle()
    rod = model.rods["AB"]
    rod.rest_length = 1.0
    model.particles["A"].position = (1.0, 1.0)
    assert (rod.original_length, rod.rest_length) == (0.0, 1.0)
    with pytest.raises(FieldError, match="rod AB: its ends are at the same place"):
        rod.rest_length = None
    assert rod.rest_length == 1.0


# --- creation --------------------------------------------------------------------------------------------


def test_creation_takes_columns_overrides_and_defaults() -> None:
    model = Model()
    a, b = model.create(Particle, 2, position=[(0, 0), (1, 0)], mass=[None, 4.0], fixed=(True, False))
    assert (a.name, b.name) == ("particle 1", "particle 2")
    assert (a.mass, b.mass, b.prescribed_mass) == (DEFAULT_MASS, 4.0, 4.0)
    assert a.fixed == b.fixed == (True, False)
    [rod] = model.create(Rod, between=[(0, 1)], rest_length=0.5, name="AB")
    assert (rod.rest_length, rod.original_length, rod.name) == (0.5, 1.0, "AB")
    assert model.create(Particle, 0) == []


def test_elements_are_referred_to_by_name_handle_or_row() -> None:
    model = triangle()
    one, other = model.create(Particle, 2, name=["D", "E"], position=[(5, 0), (6, 0)])
    first, second = model.create(Rod, 2, between=[("A", one), (one, other.row)])
    assert [first.between, second.between] == [(0, 3), (3, 4)]
    first.between = ("B", "E")
    assert first.between == (1, 4)
    [load] = model.create(Load, on="E", force=(0, -1))
    assert load.particle.name == "E"
    with pytest.raises(FieldError, match="belongs to another model"):
        first.between = (triangle().particles["A"], "B")


def chessboard(side: int) -> tuple[Model, NDArray[np.intp]]:
    """A square lattice of particles and rods, with the rows of the particles at the ends of each rod."""
    grid = np.arange(side * side).reshape(side, side)
    pairs = [np.stack([grid[:, :-1], grid[:, 1:]], axis=-1), np.stack([grid[:-1], grid[1:]], axis=-1)]
    between = np.concatenate([part.reshape(-1, 2) for part in pairs])
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    model = Model()
    model.create(Particle, side * side, position=np.stack([x, y], axis=-1).reshape(-1, 2))
    model.create(Rod, len(between), between=between)
    return model, between


def test_many_rods_are_created_and_cut_at_once() -> None:
    side = 101  # odd: every second particle is a colour of the chessboard
    model, between = chessboard(side)
    assert model.rods.count == len(between) == 20_200
    assert model.rods.original_length.tolist() == [1.0] * len(between)
    inner = model.particles.mass.reshape(side, side)[1:-1, 1:-1]
    np.testing.assert_allclose(inner, 4 * 0.5 * 6.15, rtol=1e-15)
    log = logged(model)
    half = [model.particles[row] for row in range(0, side * side, 2)]
    model.delete(half)
    assert (model.particles.count, model.rods.count) == ((side * side) // 2, 0)
    model.apply(log.pop())
    np.testing.assert_array_equal(model.rods.between, between)


def test_creating_takes_time_in_proportion() -> None:
    few, many = (lines_run(lambda side=side: chessboard(side)) for side in (20, 40))
    assert many < 4.3 * few  # four times as many rods; a loop that is quadratic runs 16 times as many lines


def test_one_at_a_time_takes_no_longer_in_a_large_model() -> None:
    def lines(particles: int) -> int:
        model = Model()
        model.create(Particle, particles, position=np.arange(2 * particles).reshape(-1, 2))
        rows = np.arange(particles - 1)
        model.create(Rod, len(rows), between=np.stack([rows, rows + 1], axis=1))
        model.create(Rod, between=[(10, 12)])  # the first looks for the lowest free name, once
        return lines_run(lambda: [model.create(Rod, between=[(row, row + 2)]) for row in range(10)])

    assert lines(2000) <= 1.1 * lines(20)  # a search through all names would run a line for each


# --- commands and transactions ---------------------------------------------------------------------------


def test_a_group_that_fails_did_not_happen() -> None:
    model = triangle()
    log = logged(model)
    before = snapshot(model)
    a, b = model.particles["A"].entity, model.particles["B"].entity
    move = Assign("particles", "force", (b,), np.array([[1.0, 1.0]]))
    with pytest.raises(LookupError):
        model.execute(Group((move, Delete((a,)), Assign("particles", "force", (a,), np.zeros((1, 2))))))
    assert snapshot(model) == before
    assert log == []


def test_assigning_what_is_there_already_is_no_step() -> None:
    model = triangle()
    log = logged(model)
    revision = model.revision
    a = model.particles["A"]
    a.force, a.name, a.mass, a.fixed = a.force, a.name, None, a.fixed
    model.environment.drag = 0
    with model.transaction("nothing"):
        pass
    model.delete([])
    assert (log, model.revision) == ([], revision)


def test_before_change_comes_before_every_command() -> None:
    model = triangle()
    seen: list[float] = []
    model.before_change = lambda: seen.append(model.particles["A"].force[0])
    model.particles["A"].force = (1.0, 0.0)
    model.particles["A"].force = (2.0, 0.0)
    assert seen == [0.0, 1.0]


# --- versions and derived columns --------------------------------------------------------------------------


def versions(model: Model) -> dict[str, int]:
    return {f"{t.name}.{f}": t.version(f) for t in model.tables.values() for f in t.fields}


def changed(model: Model, before: dict[str, int]) -> set[str]:
    return {name for name, version in versions(model).items() if version != before[name]}


def test_versions_tell_exactly_what_changed() -> None:
    model = triangle()
    _ = model.particles.constant_force, model.rods.tension_limit
    before = versions(model)
    _ = model.particles.mass, model.particles["A"].position, model.rods.names
    assert changed(model, before) == set()
    model.particles["A"].force = (1.0, 0.0)
    assert changed(model, before) == {"particles.force"}
    _ = model.particles.constant_force
    assert changed(model, before) == {"particles.force", "particles.constant_force"}
    before = versions(model)
    model.writable("particles.velocity")
    assert changed(model, before) == {"particles.velocity"}
    before = versions(model)
    model.create(Grid)
    assert changed(model, before) == {f"grids.{name}" for name in model.grids.fields}
    before = versions(model)
    model.delete([model.rods["AB"], model.rods["CA"]])
    assert {name.split(".")[0] for name in changed(model, before)} == {"rods"}
    before = versions(model)
    model.delete([model.particles["A"]])  # BC's ends are in other rows now
    assert {name for name in changed(model, before) if name.startswith("rods")} == {"rods.between"}


def test_the_version_of_a_derived_column_is_that_of_its_latest_value() -> None:
    model = triangle()
    before = model.version("particles.mass")
    assert model.version("particles.mass") == before
    model.rods["AB"].density = 1.0
    assert model.version("particles.mass") > before
    newest = model.newest(Role.DOCUMENT)
    model.particles["A"].radius = 1.0
    assert model.newest(Role.DOCUMENT) > newest
    state = model.newest(Role.STATE)
    model.particles["A"].radius = 2.0
    assert model.newest(Role.STATE) == state


def counted() -> tuple[World, dict[str, int]]:
    """A model whose derivations count how often they are computed."""
    calls: dict[str, int] = {}

    def counting(derivation: Derivation) -> Derivation:
        name = derivation.compute.__name__

        def compute(world: World) -> None:
            calls[name] = calls.get(name, 0) + 1
            derivation.compute(world)

        return Derivation(derivation.targets, derivation.sources, compute)

    world = World(KINDS, [counting(derivation) for derivation in DERIVATIONS])
    world.create(Particle, 3, position=[(0, 0), (1, 1), (2, 0)])
    world.create(Rod, 2, between=[(0, 1), (1, 2)])
    calls.clear()
    return world, calls


def test_derived_columns_are_computed_when_read_and_only_after_a_change() -> None:
    world, calls = counted()
    particle, rod = world.tables["particles"][0], world.tables["rods"][0]
    assert calls == {}
    for _ in range(3):
        _ = particle.mass, rod.rest_length, world.column("particles.mobility")
    assert calls == {"lengths": 1, "masses": 1}
    particle.force = (1.0, 0.0)
    _ = particle.mass, rod.rest_length
    assert calls == {"lengths": 1, "masses": 1}
    _ = particle.constant_force
    rod.density = 3.0
    _ = rod.rest_length, particle.constant_force
    assert calls == {"lengths": 1, "masses": 2, "constant_forces": 2}
    particle.position = (0.0, 0.5)
    assert calls["lengths"] == 1
    _ = particle.constant_force
    assert calls == {"lengths": 2, "masses": 3, "constant_forces": 3}


def test_a_derivation_that_raised_is_tried_again() -> None:
    world, _ = counted()
    broken = True

    def compute(world: World) -> None:
        if broken:
            raise ZeroDivisionError
        world.writable("rods.strain")[...] = 0.25

    world.derive(Derivation(("rods.strain",), ("rods.stiffness",), compute))
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            world.column("rods.strain")
    broken = False
    assert world.column("rods.strain").tolist() == [0.25, 0.25]


def test_new_rows_are_derived_even_if_no_source_changed() -> None:
    world, _ = counted()

    def compute(world: World) -> None:
        world.writable("rods.strain")[...] = world.column("settings.restitution")[0]

    world.derive(Derivation(("rods.strain",), ("settings.restitution",), compute))
    assert world.column("rods.strain").tolist() == [1.0, 1.0]
    world.create(Rod, between=[(0, 2)])
    assert world.column("rods.strain").tolist() == [1.0, 1.0, 1.0]


def test_a_derivation_is_replaced_as_a_whole() -> None:
    world, _ = counted()

    def compute(world: World) -> None:
        for name in ("particles.mass", "particles.mobility"):
            world.writable(name)[...] = 7.0

    with pytest.raises(ValueError, match=r"Columns particles\.mass, particles\.mobility are derived together"):
        world.derive(Derivation(("particles.mass",), ("particles.fixed",), compute))
    world.derive(Derivation(("particles.mass", "particles.mobility"), ("particles.fixed",), compute))
    assert world.column("particles.mass").tolist() == [7.0] * 3
    forgotten = weakref.ref(compute)
    world.derive(Derivation(("particles.mass", "particles.mobility"), ("particles.fixed",), lambda world: None))
    del compute
    assert forgotten() is None


def test_the_constant_force_holds_all_that_time_does_not_change() -> None:
    model = triangle()
    a, b, _ = model.particles
    a.mass, a.force, a.acceleration = 2.0, (1.0, 2.0), (0.0, 10.0)
    model.environment.force, model.environment.acceleration = (0.5, 0.0), (0.0, -9.81)
    model.create(Load, 3, on=[0, 0, 0], force=[(10, 0), (5, 5), (100, 100)])
    model.loads[2].history = {"kind": "ramp"}
    expected = (1.0 + 0.5 + 10 + 5, 2.0 + 2.0 * (10.0 - 9.81) / 1000.0 + 5)
    assert a.constant_force == pytest.approx(expected, rel=1e-15)
    assert b.constant_force == pytest.approx((0.5, -9.81 * b.mass / 1000.0), rel=1e-15)


def test_unlimited_strengths_are_infinite() -> None:
    model = triangle()
    model.assign(list(model.rods), "tensile_strength", [None, 0.0, 5.0])
    assert model.rods.tension_limit.tolist() == [np.inf, np.inf, 5.0]
    assert model.rods.compression_limit.tolist() == [np.inf] * 3


def test_an_element_is_made_by_its_model_only() -> None:
    with pytest.raises(TypeError, match=r"A rod is part of a model; model.create\(Rod\) makes one"):
        Rod()


# --- tags --------------------------------------------------------------------------------------------------


def test_the_revision_of_tags_tells_when_marks_changed() -> None:
    model = triangle()
    a = model.particles["A"]
    model.tag_only([a], Selected)
    revision = model.tags_revision
    model.tag_only([a], Selected)
    model.tag_only([], DiagramShown)
    assert model.tags_revision == revision
    model.tag_only([], Selected)
    assert model.tags_revision > revision
    assert model.tagged(Selected) == []


# --- esper contexts ----------------------------------------------------------------------------------------


def test_worlds_do_not_see_each_other() -> None:
    first, second = triangle(), triangle()
    first.particles["A"].force = (1.0, 0.0)
    first.delete([first.particles["C"]])
    second.tag_only([second.particles["B"]], Selected)
    first.create(Particle, name=["D"])
    assert second.particles.names == ["A", "B", "C"]
    assert second.particles["A"].force == (0.0, 0.0)
    assert first.tagged(Selected) == []
    for model in (first, second):
        model.activate()
        assert {handle for _, handle in esper.get_component(Particle)} == set(model.particles)
        assert {handle for _, handle in esper.get_component(Rod)} == set(model.rods)


def test_a_world_goes_with_its_last_owner() -> None:
    gc.collect()
    before = set(esper.list_worlds())
    gc.disable()
    try:
        for _ in range(10):
            model = triangle()
            model.delete([model.particles["A"]])
        del model
        assert set(esper.list_worlds()) - before == set()
        kept = triangle()
        assert set(esper.list_worlds()) - before == {kept.context}
    finally:
        gc.enable()


def test_an_element_without_its_world_says_so() -> None:
    model = triangle()
    rods, rod, other = model.rods, model.rods["AB"], triangle()
    del model
    assert not rod.exists
    with pytest.raises(LookupError, match="The model of this rod is gone; keep the model"):
        _ = rod.stiffness
    with pytest.raises(LookupError, match="The model of these rods is gone; keep the model"):
        _ = rods.rest_length
    assert repr(rod) == "<deleted rod>"
    assert other.rods["AB"].stiffness == 164640.0
