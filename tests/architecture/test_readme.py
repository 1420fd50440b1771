"""The README is kept true: its Python runs, its keys are those of the program, its commands exist."""

from __future__ import annotations

import re
from pathlib import Path

from game import models
from game.cli import COMMANDS
from systems.input.bindings import BINDINGS

README = Path(__file__).parents[2] / "README.md"
TEXT = README.read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, flags=re.DOTALL)


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


def test_every_command_of_the_readme_exists() -> None:
    for block in blocks("sh"):
        for word in re.findall(r"(?:^|bin/)pinjoint ([\w-]+)", block, flags=re.MULTILINE):
            assert word.isupper() or word in COMMANDS or word in models.bundled(), word


if __name__ == "__main__":
    print(table_of_keys())
