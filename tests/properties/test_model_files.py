"""Any model survives its file bit for bit; no file, however wrong, gives more than a ModelError."""

import copy
import struct
import tempfile
from pathlib import Path
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint.components.field import LARGEST, SMALLEST, Role, same
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.models import ModelError

finite = st.sampled_from([0.0, -0.0]) | st.floats(allow_nan=False, allow_infinity=False)
made = st.sampled_from([0.0, -0.0]) | st.floats(-LARGEST, LARGEST)
places = st.floats(-LARGEST, LARGEST)
positive = st.floats(SMALLEST, LARGEST)
names = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=4).filter(str.strip)


def pair(values: st.SearchStrategy[Any]) -> st.SearchStrategy[list[Any]]:
    return st.lists(values, min_size=2, max_size=2)


def objects(required: dict[str, Any], **optional: Any) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries(required, optional=optional)


foreign = st.dictionaries(
    names.map("mod.{}".format),
    st.dictionaries(
        names,
        st.recursive(
            st.none() | st.booleans() | st.integers() | finite | names,
            lambda inner: st.lists(inner, max_size=2),
        ),
        max_size=2,
    ),
    max_size=2,
)
histories = objects({"kind": st.just("constant")}) | objects(
    {"kind": st.just("ramp")}, start=made, duration=st.floats(0, LARGEST)
)


def particle_elements(name: str) -> st.SearchStrategy[dict[str, Any]]:
    elements = objects(
        {"name": st.just(name), "position": pair(places)},
        displacement=pair(finite),
        velocity=pair(finite),
        fixed=pair(st.booleans()),
        force=pair(made),
        acceleration=pair(made),
        mass=st.none() | positive,
        radius=positive,
        components=foreign,
    )
    return elements.map(without_velocity_where_fixed)


def without_velocity_where_fixed(element: dict[str, Any]) -> dict[str, Any]:
    if "velocity" in element and "fixed" in element:
        moving = zip(element["velocity"], element["fixed"], strict=True)
        element["velocity"] = [0.0 if held else speed for speed, held in moving]
    return element


def rod_elements(name: str, ends: list[str]) -> st.SearchStrategy[dict[str, Any]]:
    strengths = st.none() | st.floats(0, LARGEST)
    return objects(
        {"name": st.just(name), "between": st.just(ends), "rest_length": positive},
        stiffness=positive,
        tensile_strength=strengths,
        compressive_strength=strengths,
        damping=st.floats(0, LARGEST),
        density=st.floats(0, LARGEST),
        plastic_strain=finite,
        components=foreign,
    )


@st.composite
def documents(draw: st.DrawFn) -> dict[str, Any]:
    """A valid document with up to five particles."""
    nodes = draw(st.lists(names, max_size=5, unique=True))
    document: dict[str, Any] = {"format": "pinjoint model", "version": 1}
    document["particles"] = [draw(particle_elements(name)) for name in nodes]
    if len(nodes) > 1:
        ends = st.lists(st.sampled_from(nodes), min_size=2, max_size=2, unique=True)
        pairs = draw(st.lists(ends, max_size=5, unique_by=frozenset))
        rods = draw(st.lists(names, min_size=len(pairs), max_size=len(pairs), unique=True))
        document["rods"] = [draw(rod_elements(*rod)) for rod in zip(rods, pairs, strict=True)]
    if nodes:
        load = objects({"on": st.sampled_from(nodes)}, force=pair(made), history=histories, components=foreign)
        document["loads"] = draw(st.lists(load, max_size=3))
    hidden = objects({"shown": st.just(False)}, spacing=pair(positive))
    document["grids"] = draw(st.lists(hidden, max_size=2))
    rest = objects(
        {},
        title=names,
        description=names,
        environment=objects({}, force=pair(made), acceleration=pair(made), drag=st.floats(0, LARGEST)),
        settings=objects(
            {}, restitution=st.floats(0, 1), time_step=st.none() | positive, plasticity=st.booleans()
        ),
        state=objects({}, time=finite.map(abs), steps=st.integers(-(2**63) + 1, 2**63 - 1), work=finite),
    )
    return document | draw(rest)


def written_and_read(model: Model) -> Model:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.json"
        models.save(model, path)
        return models.load(path)


def bits(value: Any) -> bytes:
    """A number's bits, or those of the numbers in a vector."""
    return b"".join(struct.pack("d", part) for part in (value if isinstance(value, list) else [value]))


@settings(max_examples=150, deadline=None)
@given(documents())
def test_a_model_holds_the_bits_of_its_document_and_survives_its_file(document: dict[str, Any]) -> None:
    model = models.parse(document)
    again = written_and_read(model)
    assert (again.title, again.description) == (document.get("title", ""), document.get("description", ""))
    for name, table in model.tables.items():
        assert table.count == again.tables[name].count
        for field in table.fields_in(Role.DOCUMENT, Role.STATE):
            assert same(table.column(field.name), again.tables[name].column(field.name)), field.name
        kept = [model.foreign.get(handle.entity) for handle in table.handles]
        assert kept == [again.foreign.get(handle.entity) for handle in again.tables[name].handles]
    written = models.document(again)
    for section in ("particles", "rods", "loads", "grids"):
        table = model.tables[section]
        for element, handle, after in zip(
            document.get(section, []), table.handles, written.get(section, []), strict=True
        ):
            assert element.get("components") == after.get("components")
            for field in table.fields_in(Role.DOCUMENT, Role.STATE):
                if field.dtype is float and element.get(field.key) is not None:
                    held = getattr(handle, field.name)
                    assert bits(element[field.key]) == bits(list(held) if field.shape else held), field.name
                elif field.dtype in (bool, str) and field.key in element:
                    held = getattr(handle, field.name)
                    assert element[field.key] == (list(held) if field.shape else held)
            if section == "rods":
                assert after["between"] == element["between"]


# --- what is wrong -------------------------------------------------------------------------------------

scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.sampled_from([10**400, -(2**64), 1e308, -1e308, 5e-324])
    | st.floats()
    | st.text(max_size=3)
    | st.sampled_from(["A", "name", "ramp", "rods", "automatic"])
)
anything = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["kind", "name", "on", "force", "x.y"]) | st.text(max_size=2), inner)
    ),
    max_leaves=5,
)


def containers(value: Any) -> list[Any]:
    """Every list and object inside a document, itself first."""
    found = [value]
    for inner in value.values() if isinstance(value, dict) else value:
        if isinstance(inner, dict | list):
            found.extend(containers(inner))
    return found


def mutate(draw: st.DrawFn, document: Any) -> None:
    """Change one thing somewhere in a document."""
    container = draw(st.sampled_from(containers(document)))
    if isinstance(container, dict):
        key = draw(st.sampled_from(sorted(container)) if container else st.text(max_size=3))
        change = draw(st.sampled_from(["remove", "replace", "rename"]))
        value = container.pop(key, None)
        if change == "replace":
            container[key] = draw(anything)
        elif change == "rename":
            container[draw(st.text(max_size=5) | st.sampled_from(["components", "mass", "between"]))] = value
    else:
        index = draw(st.integers(0, len(container)))
        change = draw(st.sampled_from(["insert", "repeat", "remove"]))
        if change == "insert":
            container.insert(index, draw(anything))
        elif change == "repeat":
            container.extend(copy.deepcopy(container[index:]))
        else:
            del container[index : index + 1]


@st.composite
def mutated_documents(draw: st.DrawFn) -> dict[str, Any]:
    document = copy.deepcopy(draw(documents()))
    for _ in range(draw(st.integers(1, 3))):
        mutate(draw, document)
    return document


def outcome(source: Any, name: str) -> Model | str:
    """What reading gives: the model, or the message of the ModelError."""
    try:
        return models.load(source) if isinstance(source, Path) else models.parse(source, name)
    except ModelError as error:
        return str(error)


def assert_model_or_message(result: Model | str, start: str) -> None:
    if isinstance(result, str):
        assert result.startswith(start)
    else:
        assert models.document(written_and_read(result)) == models.document(result)


@settings(max_examples=200, deadline=None)
@given(mutated_documents())
def test_a_mutated_document_is_a_model_or_a_model_error(document: dict[str, Any]) -> None:
    assert_model_or_message(outcome(document, "mutated"), "mutated: $")
