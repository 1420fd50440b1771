"""The page about what a model consists of is made from the Fields: `python -m tests.architecture.test_fields`."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pinjoint.included  # noqa: F401 (adds walls)
from pinjoint.components.clock import Clock
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Field, Role
from pinjoint.components.handle import Handle
from pinjoint.components.load import HISTORIES
from pinjoint.components.model import KINDS
from pinjoint.components.table import fields_of
from pinjoint.systems.program.binding import find

PAGE = Path(__file__).parents[2] / "components" / "README.md"
HEAD = """\
# What a model consists of

<!-- Written by: python -m tests.architecture.test_fields -->

Every fact about an element has one name: in model files, in Python (`session.rods["AB"].stiffness`; the whole column is
`session.rods.stiffness`) and in the paths of `--set`, `--vary`, `--measure` and `expect` (`rods.AB.stiffness`). Of
vectors, paths also take `.x` and `.y`; where several elements are meant, `*` stands for all names.

`settings` says how the model is computed and drawn, `environment` what acts on all particles; there is one of each
(`session.settings.tolerance`, `--set settings.tolerance=1e-12`).

* **set**: a person makes it. It is saved, and edits of it can be undone.
* **drawn**: likewise, but only pictures depend on it: it can be changed in a run without touching that.
* **moves**: time changes it. It is saved, and can be set, too.
* **computed**: it follows from the rest and can only be read; **or set**: a value of one's own replaces it.
"""
SLIDERS = """
## sliders

Numbers that a person moves on the canvas, in model files only:

```json
"sliders": [{"of": "loads.wind.force.x", "from": 0, "to": 200},
            {"of": ["rods.AB.stiffness", "rods.BC.stiffness"], "from": 1e4, "to": 1e6, "logarithmic": true, "title": "EA"}]
```

* `of`: the path of a number, or several, which all get the value.
* `from`, `to`: its left and its right end, in the units above; either may be larger.
* `logarithmic`: equal ways are equal ratios. `title`: what it is called; left out, after its first path.
"""
ROLES = {Role.DOCUMENT: "set", Role.LOOK: "drawn", Role.STATE: "moves", Role.DERIVED: "computed"}


def page() -> str:
    """What the page is to say."""
    kinds = [kind for kind in KINDS if kind is not Clock]
    sections = [section(kind, kind.table) for kind in kinds]
    kinds = EXTENSIONS.kinds.items()
    ours = [(name, kind) for name, kind in kinds if kind.__module__.startswith("pinjoint.included")]
    sections += [section(kind, kind.table, f" (in files `components` / `{name}`)") for name, kind in ours]
    return "\n".join([HEAD, *sections, histories()]) + SLIDERS


def histories() -> str:
    """The kinds of histories that come with Pinjoint."""
    head = [
        "## Histories of loads",
        "",
        'Such as `{"kind": "ramp", "duration": 0.5}`: the factor of a load in time.',
        "",
    ]
    kinds = [kind for kind in HISTORIES.values() if kind.mod is None or kind.mod.included]
    lines = [
        f"| `{kind.name}` | {', '.join(f'`{name}`' for name in kind.parameters)} | {meaning(kind.factor)} |"
        for kind in kinds
    ]
    return (
        "\n".join([*head, "| kind | parameters (s, Hz, rad) | factor |", "| --- | --- | --- |", *lines]) + "\n"
    )


def meaning(factor: str) -> str:
    """What a factor's kernel says of itself."""
    return (find(factor, "").__doc__ or "").splitlines()[0]


def section(kind: type[Handle], name: str, where: str = "") -> str:
    about = (kind.__doc__ or "").splitlines()[0]
    head = [
        f"## {name}{where}",
        "",
        about,
        "",
        "| name | unit | default | | meaning |",
        "| --- | --- | --- | --- | --- |",
    ]
    return "\n".join([*head, *rows(kind)]) + "\n"


def rows(kind: type[Handle]) -> Iterator[str]:
    fields = {field.name: field for field in fields_of(kind) if not field.component}
    for field in fields.values():
        if field.overrides is None:
            own = fields[field.overridden_by] if field.overridden_by else None
            role = f"{ROLES[field.role]}, or set" if own else ROLES[field.role]
            yield f"| `{(own or field).key}` | {field.unit} | {default(own or field)} | {role} | {(own or field).doc} |"


def default(field: Field[Any]) -> str:
    if field.role is Role.DERIVED or field.references or field.name in ("name", "position"):
        return ""
    value = field.loaded(field.allocate(1), 0)
    if value is None:
        return field.absent
    return (
        value
        if isinstance(value, str)
        else f"`{json.dumps(dict(value) if isinstance(value, Mapping) else value)}`"
    )


def test_the_page_is_that_of_the_fields() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: python -m tests.architecture.test_fields"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
