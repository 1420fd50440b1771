"""The README and its further pages are kept true: Python runs, keys and commands exist, links lead somewhere."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from game.commands import COMMANDS
from game.commands.command_line import main
from game.documents import models
from systems.input.bindings import BINDINGS

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
TEXT = README.read_text(encoding="utf-8")
PAGES = [
    README,
    *(
        page
        for top in ("components", "systems", "game", "assets")
        for page in sorted((ROOT / top).rglob("README.md"))
    ),
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


LONG = ("open", "bench", "sweep", "play")  # or with a window, or tried elsewhere
WITHOUT_WINDOW = [
    words
    for line in re.findall(r"^pinjoint (.*)$", "".join(blocks("sh")), flags=re.MULTILINE)
    if (words := shlex.split(line, comments=True))[0] in set(COMMANDS) - set(LONG) and len(words) > 1
]


@pytest.mark.parametrize("words", WITHOUT_WINDOW, ids=" ".join)
def test_every_command_does_what_it_says(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("RECORD.csv").write_text("0,0\n0.1,1\n0.2,0\n", encoding="utf-8")
    assert main(words) == 0
    if "--output" in words:
        assert Path(words[words.index("--output") + 1]).stat().st_size > 0


if __name__ == "__main__":
    print(table_of_keys())
