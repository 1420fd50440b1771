"""A model under random editing, compared after every step with a document of plain dictionaries."""

import copy
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import esper
import numpy as np
import pytest
from hypothesis import assume, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from pinjoint.components.commands import Command
from pinjoint.components.field import Field, FieldError, Role
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.load import CONSTANT, Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.table import fields_of

KINDS: dict[str, type[Handle]] = {kind.table: kind for kind in (Particle, Rod, Load, Grid)}
REFERENCES = {"rods": "between", "loads": "on"}
OVERRIDES = {
    "mass": "prescribed_mass",
    "rest_length": "prescribed_rest_length",
    "stiffness": "prescribed_stiffness",
}
SINGLES = {"environment": "drag", "settings": "restitution", "clock": "time"}

Element = dict[str, Any]
Document = dict[str, list[Element]]

# A small lattice makes particles meet; other numbers test that values survive to the last bit.
coordinate = st.sampled_from([0.0, 1.0, 2.0]) | st.floats(-1e3, 1e3)
vector = st.tuples(coordinate, coordinate)
positive = st.floats(1e-3, 1e3)
text = st.sampled_from(["A", "B", "C", "rod 1", "particle 2", "load 1", "grid 3"]) | st.text(
    min_size=1, max_size=3
)
VALUES: dict[str, dict[str, st.SearchStrategy[Any]]] = {
    "particles": {
        "name": text,
        "position": vector,
        "displacement": vector,
        "velocity": st.just((0.0, 0.0)) | vector,
        "fixed": st.tuples(st.booleans(), st.booleans()),
        "force": vector,
        "radius": positive,
        "prescribed_mass": st.none() | positive,
        "mass": st.none() | positive,
    },
    "rods": {
        "name": text,
        "stiffness": st.none() | positive,
        "prescribed_stiffness": st.none() | positive,
        "youngs_modulus": st.none() | positive,
        "area": st.none() | positive,
        "density": st.just(0.0) | positive,
        "tensile_strength": st.none() | st.floats(0.0, 1e3),
        "plastic_strain": st.floats(-1.0, 1.0),
        "prescribed_rest_length": st.none() | positive,
        "rest_length": st.none() | positive,
    },
    "loads": {
        "name": text,
        "force": vector,
        "history": st.just(dict(CONSTANT))
        | st.builds(lambda duration: {"kind": "ramp", "start": 0.0, "duration": duration}, positive),
    },
    "grids": {"name": text, "spacing": st.tuples(positive, positive), "shown": st.booleans()},
}
BAD_VALUES = [math.nan, math.inf, "1", None, -1.0, (1.0,), (1.0, math.nan), (True, 1.0), {}, 10**400, [[]]]


class Refused(Exception):
    """The document does not allow a change."""


# --- the document of plain dictionaries -----------------------------------------------------------------


def defaults(table: str) -> Element:
    fields = [field for field in fields_of(KINDS[table]) if field.role is not Role.DERIVED]
    found = {field.name: field.loaded(field.allocate(1), 0) for field in fields}
    return found | ({"history": dict(CONSTANT)} if table == "loads" else {})


def smallest_free_name(document: Document, table: str) -> str:
    names = {element["name"] for element in document[table]}
    number = 1
    while f"{KINDS[table].noun} {number}" in names:
        number += 1
    return f"{KINDS[table].noun} {number}"


def element_of(document: Document, table: str, identity: int) -> Element:
    return next(element for element in document[table] if element["identity"] == identity)


def distance(document: Document, rod: Element) -> float:
    (ax, ay), (bx, by) = (element_of(document, "particles", end)["position"] for end in rod["between"])
    return math.hypot(bx - ax, by - ay)


def change(document: Document, table: str, element: Element, field: str, value: Any) -> None:
    field = OVERRIDES.get(field, field)
    if element[field] == value and repr(element[field]) == repr(value):
        return
    element[field] = value
    if table == "particles" and field == "fixed":
        vx, vy = element["velocity"]
        # A held direction is set to +0; the other keeps its bits.
        element["velocity"] = (0.0 if value[0] else vx, 0.0 if value[1] else vy)
    if table == "grids" and field == "shown" and value:
        for other in document["grids"]:
            if other is not element:
                other["shown"] = False


def require_valid(document: Document) -> None:
    """What holds in every document, written as slowly and plainly as possible."""
    for elements in document.values():
        names = [element["name"] for element in elements]
        if len(set(names)) < len(names) or any(not name.strip() for name in names):
            raise Refused
    for particle in document["particles"]:
        if any(
            held and speed != 0.0 for held, speed in zip(particle["fixed"], particle["velocity"], strict=True)
        ):
            raise Refused
    pairs = [frozenset(rod["between"]) for rod in document["rods"]]
    if any(len(pair) < 2 for pair in pairs) or len(set(pairs)) < len(pairs):
        raise Refused
    for rod in document["rods"]:
        if rod["prescribed_rest_length"] is None and distance(document, rod) == 0.0:
            raise Refused


def stiffness(rod: Element) -> float:
    if rod["prescribed_stiffness"] is not None:
        return float(rod["prescribed_stiffness"])
    if rod["youngs_modulus"] is None or rod["area"] is None:
        return 164640.0
    return float(rod["youngs_modulus"] * rod["area"])


def lumped_mass(document: Document, particle: Element) -> float:
    if particle["prescribed_mass"] is not None:
        return float(particle["prescribed_mass"])
    mass = 0.0
    for rod in document["rods"]:
        if particle["identity"] in rod["between"]:
            mass += 0.5 * rod["density"] * (rod["prescribed_rest_length"] or distance(document, rod))
    return mass or 1.0


# --- the machine ------------------------------------------------------------------------------------------


class Editing(RuleBasedStateMachine):
    """Creates, assigns, deletes, fails, undoes and redoes; the world and the document must agree."""

    @initialize()
    def open_a_model(self) -> None:
        self.model = Model()
        self.document: Document = {table: [] for table in KINDS}
        self.handles: dict[int, Handle] = {}
        self.log: list[Command] = []
        self.redo_log: list[Command] = []
        self.past: list[Document] = []
        self.future: list[Document] = []
        self.model.on_command = self.log.append
        self.seen: dict[str, tuple[int, Any]] = {}
        self.start = self.bits()

    # --- one change of world and document alike ---------------------------------------------------------

    @contextmanager
    def step(self) -> Iterator[None]:
        """One step for a person: one entry of the log if anything changed, none if it was refused."""
        before, entries, bits = copy.deepcopy(self.document), len(self.log), self.bits()
        try:
            yield
        except Refused:
            self.document = before
            assert len(self.log) == entries
            assert self.bits() == bits
            return
        assert len(self.log) <= entries + 1
        if len(self.log) == entries:
            assert repr(self.document) == repr(before)
        else:
            self.past.append(before)
            self.redo_log.clear()
            self.future.clear()

    def agree(self, act: Any, plain: Any) -> Any:
        """Do the same to the world and to the document; both do it, or both refuse."""
        try:
            plain()
            require_valid(self.document)
        except Refused:
            with pytest.raises(FieldError):
                act()
            raise
        return act()

    def create(self, table: str, rows: list[Element]) -> None:
        """Create elements; references in `rows` are identities."""
        particles = [element["identity"] for element in self.document["particles"]]
        reference = REFERENCES.get(table)
        columns: dict[str, Any] = {key: [row[key] for row in rows] for key in rows[0]}
        if reference == "between":
            columns[reference] = [[particles.index(end) for end in row[reference]] for row in rows]
        elif reference == "on":
            columns[reference] = [particles.index(row[reference]) for row in rows]
        elements: list[Element] = []

        def plain() -> None:
            for row in rows:
                element = defaults(table) | row | {"identity": len(self.handles) + len(elements)}
                if not element["name"]:
                    element["name"] = smallest_free_name(self.document, table)
                self.document[table].append(element)
                elements.append(element)
            shown = [element for element in elements if element.get("shown")]
            for other in self.document["grids"] if shown else ():
                other["shown"] = other is shown[-1]

        def act() -> list[Any]:
            return self.model.create(KINDS[table], len(rows), **columns)

        handles = self.agree(act, plain)
        for element, handle in zip(elements, handles, strict=True):
            self.handles[element["identity"]] = handle

    def assign(self, table: str, identity: int, field: str, value: Any) -> None:
        def plain() -> None:
            change(self.document, table, element_of(self.document, table, identity), field, value)

        self.agree(lambda: setattr(self.handles[identity], field, value), plain)

    def delete(self, identities: set[int]) -> None:
        handles = [self.handles[identity] for identity in sorted(identities)]
        self.model.delete(handles)
        gone = {element["identity"] for element in self.document["particles"]} & identities
        for table, elements in self.document.items():
            self.document[table] = [
                element
                for element in elements
                if element["identity"] not in identities
                and not gone & set(element.get("between", ()))
                and element.get("on") not in gone
            ]

    def draw_element(self, data: st.DataObject) -> tuple[str, int]:
        pairs = [(table, element["identity"]) for table in KINDS for element in self.document[table]]
        return data.draw(st.sampled_from(pairs), "element")

    def anything(self, data: st.DataObject) -> None:
        """Some change, to be put inside a transaction."""
        kinds = ["particles", "grids"]
        if any(self.document.values()):
            kinds += ["assign", "assign", "delete"]
        if len(self.document["particles"]) > 1:
            kinds += ["rods", "loads"]
        kind = data.draw(st.sampled_from(kinds), "change")
        if kind == "assign":
            table, identity = self.draw_element(data)
            field = data.draw(st.sampled_from(sorted(VALUES[table])), "field")
            self.assign(table, identity, field, data.draw(VALUES[table][field], "value"))
        elif kind == "delete":
            self.delete({self.draw_element(data)[1]})
        else:
            self.create(kind, data.draw(self.rows_of(kind), "rows"))

    def rows_of(self, table: str, named: bool = False) -> st.SearchStrategy[list[Element]]:
        """Rows to create: always the reference, and the same few other Fields in every row."""
        particles = st.sampled_from([e["identity"] for e in self.document["particles"]] or [0])
        always: dict[str, st.SearchStrategy[Any]] = {
            "particles": {"position": vector},
            "rods": {"between": st.tuples(particles, particles)},
            "loads": {"on": particles},
            "grids": {},
        }[table]
        others = {k: v for k, v in VALUES[table].items() if k not in OVERRIDES and (named or k != "name")}
        return st.sets(st.sampled_from(sorted(others)), min_size=1, max_size=3).flatmap(
            lambda chosen: st.lists(
                st.fixed_dictionaries({k: others[k] for k in sorted(chosen)} | always), min_size=1, max_size=3
            )
        )

    # --- rules ------------------------------------------------------------------------------------------

    @rule(data=st.data(), table=st.sampled_from(["particles", "particles", "grids"]), named=st.booleans())
    def create_some(self, data: st.DataObject, table: str, named: bool) -> None:
        with self.step():
            self.create(table, data.draw(self.rows_of(table, named), "rows"))

    @precondition(lambda self: len(self.document["particles"]) > 1)
    @rule(data=st.data(), table=st.sampled_from(["rods", "rods", "loads"]), named=st.booleans())
    def create_some_that_refer(self, data: st.DataObject, table: str, named: bool) -> None:
        with self.step():
            self.create(table, data.draw(self.rows_of(table, named), "rows"))

    @precondition(lambda self: any(self.document.values()))
    @rule(data=st.data())
    def assign_any_field(self, data: st.DataObject) -> None:
        table, identity = self.draw_element(data)
        field = data.draw(st.sampled_from(sorted(VALUES[table])), "field")
        with self.step():
            self.assign(table, identity, field, data.draw(VALUES[table][field], "value"))

    @precondition(lambda self: self.document["rods"] or self.document["loads"])
    @rule(data=st.data())
    def assign_a_reference(self, data: st.DataObject) -> None:
        pairs = [(table, e["identity"]) for table in REFERENCES for e in self.document[table]]
        table, identity = data.draw(st.sampled_from(pairs), "element")
        particles = [element["identity"] for element in self.document["particles"]]
        one = st.sampled_from(particles)
        ends: Any = data.draw(st.tuples(one, one) if table == "rods" else one, "particles")
        rows = tuple(particles.index(end) for end in ends) if table == "rods" else particles.index(ends)

        def plain() -> None:
            element_of(self.document, table, identity)[REFERENCES[table]] = ends

        with self.step():
            self.agree(lambda: setattr(self.handles[identity], REFERENCES[table], rows), plain)

    @precondition(lambda self: any(self.document.values()))
    @rule(data=st.data())
    def assign_to_several(self, data: st.DataObject) -> None:
        table = data.draw(st.sampled_from([table for table, elements in self.document.items() if elements]))
        field = data.draw(st.sampled_from(sorted(set(VALUES[table]) - {"shown"})), "field")
        every = st.sampled_from([element["identity"] for element in self.document[table]])
        chosen = sorted(data.draw(st.sets(every, min_size=1), "elements"))
        values = data.draw(st.lists(VALUES[table][field], min_size=len(chosen), max_size=len(chosen)), "values")

        def plain() -> None:
            for identity, value in zip(chosen, values, strict=True):
                change(self.document, table, element_of(self.document, table, identity), field, value)

        with self.step():
            handles = [self.handles[identity] for identity in chosen]
            self.agree(lambda: self.model.assign(handles, field, values), plain)

    @precondition(lambda self: any(self.document.values()))
    @rule(data=st.data(), value=st.sampled_from(BAD_VALUES))
    def assign_what_no_field_takes(self, data: st.DataObject, value: Any) -> None:
        table, identity = self.draw_element(data)
        fields = sorted(set(VALUES[table]) - {"name"} if value == "1" else VALUES[table])
        name = data.draw(st.sampled_from(fields), "field")
        field: Field[Any] = getattr(KINDS[table], OVERRIDES.get(name, name))
        assume(not (value is None and field.nullable) and (value, name) != (-1.0, "plastic_strain"))
        before = self.bits()
        with pytest.raises(FieldError):
            setattr(self.handles[identity], name, value)
        assert self.bits() == before

    @rule(table=st.sampled_from(sorted(SINGLES)), value=st.sampled_from([0.0, 0.25, 1.0]))
    def assign_to_what_there_is_one_of(self, table: str, value: float) -> None:
        with self.step():
            # Not part of the plain document: that undo restores it is seen when everything is undone.
            setattr(self.model.tables[table][0], SINGLES[table], value)

    @precondition(lambda self: any(self.document.values()))
    @rule(data=st.data())
    def delete_any_subset(self, data: st.DataObject) -> None:
        every = [element["identity"] for elements in self.document.values() for element in elements]
        with self.step():
            self.delete(data.draw(st.sets(st.sampled_from(every), min_size=1), "deleted"))

    @rule(data=st.data(), changes=st.integers(1, 4))
    def a_transaction_that_fails(self, data: st.DataObject, changes: int) -> None:
        before, entries, bits = copy.deepcopy(self.document), len(self.log), self.bits()
        known = dict(self.handles)

        def attempt() -> None:
            with self.model.transaction("fails"):
                for _ in range(changes):
                    self.anything(data)
                raise Refused

        with pytest.raises(Refused):
            attempt()
        self.document, self.handles = before, known
        assert len(self.log) == entries
        assert self.bits() == bits

    @rule(data=st.data(), changes=st.integers(1, 4))
    def a_transaction_in_which_some_are_refused(self, data: st.DataObject, changes: int) -> None:
        with self.step(), self.model.transaction("goes on"):
            for _ in range(changes):
                before = copy.deepcopy(self.document)
                try:
                    self.anything(data)
                except Refused:
                    self.document = before

    @precondition(lambda self: self.log)
    @rule()
    def undo(self) -> None:
        self.redo_log.append(self.model.apply(self.log.pop()))
        self.future.append(self.document)
        self.document = self.past.pop()

    @precondition(lambda self: self.redo_log)
    @rule()
    def redo(self) -> None:
        self.log.append(self.model.apply(self.redo_log.pop()))
        self.past.append(self.document)
        self.document = self.future.pop()

    # --- what must hold after every step -----------------------------------------------------------------

    def bits(self) -> dict[str, Any]:
        """All columns of all tables, derived ones up to date, bit for bit."""
        return {
            f"{table.name}.{name}": column.tolist() if column.dtype == object else column.tobytes()
            for table in self.model.tables.values()
            for name, column in [("entity", table.entities), *((n, table.column(n)) for n in table.fields)]
        }

    @invariant()
    def every_value_is_that_of_the_document(self) -> None:
        for name, elements in self.document.items():
            table = self.model.tables[name]
            assert table.names == [element["name"] for element in elements]
            assert list(table) == [self.handles[element["identity"]] for element in elements]
            for element, handle in zip(elements, table, strict=True):
                assert table[element["name"]] is handle
                for field, value in element.items():
                    if field == "between":
                        assert tuple(handle.ends) == tuple(self.handles[end] for end in value)
                    elif field == "on":
                        assert handle.particle is self.handles[value]
                    elif field != "identity":
                        assert repr(getattr(handle, field)) == repr(value) or getattr(handle, field) == value

    @invariant()
    def rows_entities_and_esper_agree(self) -> None:
        model = self.model
        model.activate()
        rows = 0
        for table in model.tables.values():
            rows += len(table)
            assert model.row_of_entity[table.entities].tolist() == list(range(len(table)))
            assert [handle.entity for handle in table] == table.entities.tolist()
            assert dict(esper.get_component(table.kind)) == {handle.entity: handle for handle in table}
            for field in table.fields.values():
                assert len(table.column(field.name)) == len(table)
                if field.references is not None:
                    assert (table.column(field.name) < len(model.tables[field.references])).all()
        assert (model.row_of_entity >= 0).sum() == rows
        here = {id(handle) for table in model.tables.values() for handle in table}
        for handle in self.handles.values():
            assert handle.exists == (id(handle) in here)

    @invariant()
    def derived_columns_are_those_of_a_slow_computation(self) -> None:
        rods, particles = self.model.rods, self.model.particles
        lengths = [distance(self.document, rod) for rod in self.document["rods"]]
        assert rods.original_length.tolist() == pytest.approx(lengths, rel=1e-15)
        rest = [r["prescribed_rest_length"] or d for r, d in zip(self.document["rods"], lengths, strict=True)]
        assert rods.rest_length.tolist() == pytest.approx(rest, rel=1e-15)
        assert rods.stiffness.tolist() == [stiffness(rod) for rod in self.document["rods"]]
        masses = [lumped_mass(self.document, particle) for particle in self.document["particles"]]
        assert particles.mass.tolist() == pytest.approx(masses, rel=1e-13)
        held = np.array([particle["fixed"] for particle in self.document["particles"]], dtype=bool)
        assert ((particles.mobility == 0.0) == held.reshape(-1, 2)).all()

    @invariant()
    def what_kept_its_version_kept_its_bits(self) -> None:
        bits = self.bits()
        for table in self.model.tables.values():
            for name in table.fields:
                column = f"{table.name}.{name}"
                now = self.model.version(column), bits[column]
                before = self.seen.get(column, (-1, None))
                assert now[0] > before[0] or now == before
                assert now[0] <= self.model.revision
                self.seen[column] = now

    def teardown(self) -> None:
        end, steps = self.bits(), len(self.log)
        undone = [self.model.apply(self.log.pop()) for _ in range(steps)]
        assert self.bits() == self.start
        for command in reversed(undone):
            self.model.apply(command)
        assert self.bits() == end


TestEditing = Editing.TestCase
TestEditing.settings = settings(max_examples=50, stateful_step_count=30, deadline=None)
