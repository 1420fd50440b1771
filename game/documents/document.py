"""Documents: a Model as the plain data that a model file holds, and back, every number bit for bit."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from types import NoneType
from typing import Any

import numpy as np

from pinjoint.completion import complete
from pinjoint.components.commands import Assign
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import SAVED, Column, Field, FieldError
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod
from pinjoint.components.section import NAMES, given_by
from pinjoint.components.settings import Settings
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.table import fields_of
from pinjoint.components.wording import cut, is_broken, missing, quoted, remedy
from pinjoint.documents.facts import Facts
from pinjoint.documents.format import (
    FOREIGN,
    FORMAT,
    MODS,
    SECTIONS,
    VERSION,
    ModelError,
    copied,
    fail,
    required,
    upgraded,
)
from pinjoint.documents.sliders import KEY as SLIDERS
from pinjoint.documents.sliders import read_sliders

_HEADER = ("format", "version", "title", "description")


def parse(document: Mapping[str, Any], source: str = "") -> Model:
    """The model that a document describes; `source` is named in messages. Raises ModelError."""
    complete()
    try:
        return _parsed(document)
    except RecursionError:
        if not source:
            raise ModelError("The document is nested too deeply to be a model.") from None
        raise ModelError("{source} is nested too deeply to be a model.", source=source) from None
    except (ModelError, FieldError) as error:
        raise ModelError(joined([f"{source}:", str(error)]) if source else str(error)) from None


def document(model: Model) -> dict[str, Any]:
    """The document that `parse` turns into this model again, bit for bit. Raises ModelError."""
    return Facts(model).document()


# --- from a document to a model ----------------------------------------------------------------------


@dataclass(frozen=True)
class _Section:
    """The elements of one kind in a document, or a component's part of each, and what to call them in messages."""

    path: str
    kind: type[Handle]
    elements: Sequence[Mapping[str, Any]]
    keys: Set[Any]  # that any element has
    whole: _Section | None = None  # that these are parts of

    def where(self, row: int, key: str = "") -> str:
        """The path of an element or of one of its keys, and the element's name if it has one."""
        if self.whole is not None:
            return self.whole.where(row, f"{self.path}.{key}")
        element = self.elements[row]
        path = self.path if self.kind.single else f"{self.path}[{row}]"
        name = element.get("name")
        of = f" ({self.kind.noun} {cut(name)})" if isinstance(name, str) else ""
        return f"{path}{'.' if key else ''}{key}{of}"


def _parsed(document: Any) -> Model:
    document = _of_this_version(document)
    try:
        document = upgraded(document)
    except ValueError as error:
        fail(f"$.{MODS}", str(error))
    _refuse_unknown(document, (*_HEADER, *SECTIONS, SLIDERS, FOREIGN, MODS), "$")
    model = Model()
    model.foreign_versions = dict(document.get(MODS, {}))
    model.title = _text(document, "title")
    model.description = _text(document, "description")
    # Settings last, which may name a load case.
    for name, kind in sorted(SECTIONS.items(), key=lambda item: item[1] is Settings):
        if name in document:
            _read(model, _section(f"$.{name}", kind, document[name]))
    if FOREIGN in document:
        _read_added(model, document[FOREIGN])
    if SLIDERS in document:
        model.sliders = read_sliders(model, document[SLIDERS])
    saved = model.clock.departure  # of a step that is under way; it needs all elements
    if saved is not None:
        model.writable("clock.departure")[0] = Snapshot.of_file(saved, model, "$.state.departure")
    return model


def _read_added(model: Model, kinds: Any) -> None:
    """Read the elements of mods' kinds; those of mods that are not loaded are kept as they are."""
    path = f"$.{FOREIGN}"
    if not isinstance(kinds, Mapping):
        fail(path, "it must be an object, not {found}.", found=_kind_of(kinds))
    for name, elements in kinds.items():
        if not isinstance(name, str) or "." not in name or not isinstance(elements, list | tuple):
            fail(path, "{name} must have the form {form}.", name=quoted(name), form='"mod.Kind": […]')
        if name not in EXTENSIONS.kinds:
            _refuse_misspelt(name, EXTENSIONS.kinds, path)
            model.foreign_kinds[name] = copied(elements, f"{path}.{name}")
    for name, kind in EXTENSIONS.kinds.items():  # kinds that refer to others come after them
        if name in kinds:
            _read(model, _section(f"{path}.{name}", kind, kinds[name]))


def _of_this_version(document: Any) -> Mapping[str, Any]:
    """The document, if it is one of the present version of the format."""
    if not isinstance(document, Mapping):
        fail("$", "it must be an object with the key 'format', not {found}.", found=_kind_of(document))
    stated = document.get("format")
    if not isinstance(stated, str) or stated != FORMAT:
        form = f'"format": "{FORMAT}"'
        fail("$.format", "it is {value}; a model file has {form}.", value=quoted(stated), form=form)
    version = document.get("version")
    if isinstance(version, bool) or not isinstance(version, int):
        form, value = f'"version": {VERSION}', quoted(version)
        fail("$.version", "it is {value}; write a whole number, at present {form}.", value=value, form=form)
    if version > VERSION:
        fail(
            "$.version",
            "it is {version}, but this program reads versions up to {newest} only; update Pinjoint.",
            version=version,
            newest=VERSION,
        )
    if version < VERSION:
        fail(
            "$.version",
            "there is no version {version}; the present one is {newest}.",
            version=version,
            newest=VERSION,
        )
    return document


def _text(document: Mapping[str, Any], key: str) -> str:
    text = document.get(key, "")
    if not isinstance(text, str):
        fail(f"$.{key}", "it is {value}; it must be a text.", value=quoted(text))
    if is_broken(text):
        fail(f"$.{key}", "it is {text!a}; one of its characters is damaged. Type it again.", text=text)
    return text


def _section(path: str, kind: type[Handle], value: Any) -> _Section:
    """The section at a path once its shape and all its keys are checked."""
    if not kind.single and not isinstance(value, list | tuple):
        fail(path, "it must be a list, not {found}.", found=_kind_of(value))
    elements = [value] if kind.single else value
    for row, element in enumerate(elements):
        if not isinstance(element, Mapping):
            place = path if kind.single else f"{path}[{row}]"
            fail(place, "it must be an object, not {found}.", found=_kind_of(element))
    section = _Section(path, kind, elements, set().union(*elements))
    known = [*(field.key for field in _saved(kind) if not field.component), FOREIGN]
    if not section.keys <= set(known):
        for row, element in enumerate(elements):
            _refuse_unknown(element, known, section.where(row), kind)
    for key in required(kind):
        for row, element in enumerate(elements):
            if key not in element:
                message = tr("its '{key}' is missing; every {kind} needs one.", key=key, kind=tr(kind.noun))
                fail(section.where(row), message)
    return section


def _saved(kind: type[Handle]) -> list[Field[Any]]:
    return [field for field in fields_of(kind) if field.role in SAVED]


def _components(kind: type[Handle]) -> dict[str, dict[str, Field[Any]]]:
    """The Fields of mods' components of a kind, by component and key."""
    found: dict[str, dict[str, Field[Any]]] = {}
    for field in _saved(kind):
        if field.component:
            found.setdefault(field.component, {})[field.key] = field
    return found


def _refuse_unknown(
    element: Mapping[Any, Any], keys: Sequence[str], where: str, kind: type[Handle] | None = None
) -> None:
    for key in element:
        if key in keys:
            continue
        if kind is not None and key in {field.key for field in fields_of(kind) if not field.component}:
            fail(
                where,
                "'{key}' is computed by the program and does not belong in a model file; remove it.",
                key=key,
            )
        if added := [
            name for name, of in EXTENSIONS.kinds.items() if kind is None and str(key) in (name, of.table)
        ]:
            form = f'"{FOREIGN}": {{"{added[0]}": […]}}'
            fail(where, "there is no key '{key}' here; write {form}.", key=key, form=form)
        key = str(key)
        fail(where, "there is no key '{key}' here; {remedy}", key=cut(key), remedy=remedy(key, keys))


def _kind_of(value: Any) -> str:
    names = {dict: tr("an object"), list: tr("a list"), str: tr("a text"), bool: tr("true or false")}
    names |= {NoneType: "null", int: tr("a number"), float: tr("a number")}
    return names.get(type(value)) or quoted(value)


def _read(model: Model, section: _Section) -> None:
    """Put the elements of a section into the model."""
    kind = section.kind
    if FOREIGN in section.keys:
        _check_components(section)
    if kind is Rod and not section.keys.isdisjoint(NAMES):
        section = _with_numbers(section)
    columns = {field.name: _column(model, section, field) for field in _saved(kind)}
    if kind is Grid:
        _check_grids(section, columns["shown"])
    handles: Sequence[Handle]
    table = model.tables[kind.table]
    try:
        with model.naming(lambda row, field: section.where(row, table.fields[field].key if field else "")):
            if kind.single:
                handles = [table[0]]
                for name, column in columns.items():
                    model.apply(Assign(kind.table, name, (handles[0].entity,), column))
                kind.after_change(table, np.array([0]), table.fields)
            else:
                handles = model.create(kind, len(section.elements), **columns)
    except FieldError as error:
        said = str(error)  # rules of mods need not name the place
        raise ModelError(said if said.startswith("$") else joined([f"{section.path}:", said])) from None
    if FOREIGN in section.keys:
        _keep_foreign(model, section, handles)


def _with_numbers(section: _Section) -> _Section:
    """Rods with the numbers that their section and material give, where an element states none itself."""
    elements = []
    for row, element in enumerate(section.elements):
        named = {}
        for key in NAMES:
            if element.get(key) is not None:
                named[key] = Rod.__dict__[key].check(element[key], section.where(row, key))
        elements.append({**given_by(**named), **element, **named} if named else element)
    return replace(section, elements=elements, keys=set().union(*elements))


# --- columns -----------------------------------------------------------------------------------------


def _column(model: Model, section: _Section, field: Field[Any]) -> Column:
    """The checked values of one field for all elements of a section, its default where none is given."""
    if field.name == "name":
        return _names(section, field)
    if field.component:
        parts = [element.get(FOREIGN, {}).get(field.component, {}) for element in section.elements]
        path = f"{FOREIGN}.{field.component}"
        section = _Section(path, section.kind, parts, set().union(*parts), whole=section)
    if field.key not in section.keys:
        return field.allocate(len(section.elements))
    if field.references is not None:
        return _rows_by_name(model, section, field)
    default = field.loaded(field.allocate(1), 0)
    values = [element.get(field.key, default) for element in section.elements]

    def where(row: int) -> str:
        return section.where(row, field.key)

    for row, value in enumerate(values if field.shape else ()):
        if not isinstance(value, list | tuple):  # else two values could pass for one vector for all
            field.check(value, where(row))
    return field.check_column(values, len(values), where)


def _names(section: _Section, field: Field[Any]) -> Column:
    """Given names, and the smallest free "load n" where none is given."""
    noun = section.kind.noun
    given = {name for element in section.elements if isinstance(name := element.get("name"), str)}
    free = (name for n in itertools.count(1) if (name := f"{noun} {n}") not in given)
    column = field.allocate(len(section.elements))
    row_of: dict[str, int] = {}
    for row, element in enumerate(section.elements):
        name = element["name"] if "name" in element else next(free)
        if not isinstance(name, str) or not name.strip():
            message = tr("it is {value}; it must be a text that is not empty.", value=quoted(name))
            fail(section.where(row, "name"), message)
        if name in row_of:
            first = section.where(row_of[name])
            message = tr("{first} has this name already; choose another name.", first=first)
            fail(section.where(row, "name"), message)
        row_of[name] = row
        column[row] = str(name)
    return column


def _rows_by_name(model: Model, section: _Section, field: Field[Any]) -> Column:
    """References, which documents make by name, as rows of the table that they point into."""
    assert field.references is not None
    target = model.tables[field.references]
    row_of = {name: row for row, name in enumerate(target.names)}
    column = field.allocate(len(section.elements))
    for row, element in enumerate(section.elements):
        value = element[field.key]
        names = value if field.shape else [value]
        count = field.shape[0] if field.shape else 1
        if not isinstance(names, list | tuple) or [isinstance(n, str) for n in names] != [True] * count:
            if field.shape:
                message = marked('it is {value}; it must be the names of two particles, such as ["A", "B"].')
            else:
                message = marked("it is {value}; it must be the name of a particle.")
            fail(section.where(row, field.key), message, value=quoted(value))
        for name in names:
            if name not in row_of:
                fail(section.where(row, field.key), missing(target.name, name, row_of))
        column[row] = [row_of[name] for name in names] if field.shape else row_of[value]
    return column


def _check_grids(section: _Section, shown: Column) -> None:
    """In the program the grid that is shown last hides the others."""
    rows = np.flatnonzero(shown).tolist()
    if len(rows) > 1:
        fail(
            section.where(rows[1], "shown"),
            "{first} is shown already; only one grid can be shown, give the others {form}.",
            first=section.where(rows[0]),
            form='"shown": false',
        )


# --- what belongs to mods ------------------------------------------------------------------------------


def _check_components(section: _Section) -> None:
    """Check that the data of mods has the form {"mod.Component": {…}}, with the keys of loaded mods. Raises ModelError."""
    known = _components(section.kind)
    for row, element in enumerate(section.elements):
        if FOREIGN not in element:
            continue
        where, components = section.where(row, FOREIGN), element[FOREIGN]
        if not isinstance(components, Mapping):
            fail(where, "it must be an object, not {found}.", found=_kind_of(components))
        for name, values in components.items():
            if not isinstance(name, str) or "." not in name or not isinstance(values, Mapping):
                form = '"mod.Component": {…}'
                fail(where, "{name} must have the form {form}.", name=quoted(name), form=form)
            if name not in known:
                _refuse_misspelt(name, known, where)
            if name in known:
                _refuse_unknown(values, list(known[name]), f"{where}: {name}")


def _refuse_misspelt(name: str, known: Collection[str], where: str) -> None:
    """Refuse unknown components of a loaded mod; those of other mods are kept unread. Raises ModelError."""
    components = itertools.chain.from_iterable(
        map(_components, (*SECTIONS.values(), *EXTENSIONS.kinds.values()))
    )
    mod = name.partition(".")[0]
    if mod in {loaded.partition(".")[0] for loaded in (*EXTENSIONS.kinds, *components)}:
        fail(
            where,
            "the mod '{mod}' has no '{name}' here; {remedy}",
            mod=mod,
            name=cut(name),
            remedy=remedy(name, known),
        )


def _keep_foreign(model: Model, section: _Section, handles: Sequence[Handle]) -> None:
    """Keep what belongs to components that are not loaded."""
    known = _components(section.kind)
    for row, (element, handle) in enumerate(zip(section.elements, handles, strict=True)):
        if FOREIGN not in element:
            continue
        foreign = {name: part for name, part in element[FOREIGN].items() if name not in known}
        if foreign or not element[FOREIGN]:  # an empty object stays too
            model.foreign[handle.entity] = copied(foreign, section.where(row, FOREIGN))
