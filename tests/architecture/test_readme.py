"""The README and its further pages are kept true: Python runs, keys and commands exist, links lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from game import models
from game.cli import COMMANDS
from systems.input.bindings import BINDINGS

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
TEXT = README.read_text(encoding="utf-8")
PAGES = [
    README,
    *(page for top in ("systems", "game", "assets") for page in sorted((ROOT / top).rglob("README.md"))),
]


def blocks(language: str, text: str = TEXT) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def anchors(text: str) -> set[str]:
    """What links can point to in a page: its headings, in lower case and with hyphens."""
    headings = re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_the_python_in_the_readme_runs() -> None:
    names: dict[str, object] = {}
    for block in blocks("python"):
        exec(compile(block, str(README), "exec"), names)


def test_the_table_of_keys_is_that_of_the_program() -> None:
    assert table_of_keys() in TEXT, "paste the output of: python -m tests.architecture.test_readme"


def readable(key: str) -> str:
    """As the README writes keys: "ctrl+shift+z" → "Ctrl+Shift+Z"."""
    return "+".join(part[:1].upper() + part[1:] for part in re.split(r"(?<=\w)\+", key))


def table_of_keys() -> str:
    """The README's table of keys, to be pasted there when bindings change."""
    merged: dict[tuple[str, str], list[str]] = {}
    for binding in BINDINGS:
        if binding.title:
            merged.setdefault((binding.key, binding.title), []).extend(binding.scenes)
    rows = [f"| {readable(key)} | {', '.join(scenes)} | {title} |" for (key, title), scenes in merged.items()]
    return "\n".join(["| key | in | does |", "| --- | --- | --- |", *rows])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\((?!https?:)([^)]*)\)", page.read_text(encoding="utf-8")):
        path, _, anchor = link.partition("#")
        target = (page.parent / path) if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target.read_text(encoding="utf-8")), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_command_exists(page: Path) -> None:
    for block in blocks("sh", page.read_text(encoding="utf-8")):
        for word in re.findall(r"(?:^|bin/)pinjoint ([\w-]+)", block, flags=re.MULTILINE):
            assert word.isupper() or word in COMMANDS or word in models.bundled(), word


if __name__ == "__main__":
    print(table_of_keys())
