"""Sentences for people are said in their language: where they are raised, told, shown in panels or in --help."""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.catalogues import FIELDS, KEYWORDS, ROOT

SOURCES = [path for top in ("components", "systems", "game") for path in sorted((ROOT / top).rglob("*.py"))]
# The last marks a title by its place.
SAYING = {"tr", "tr_in", "plural", "marked", "joined", "begun", "Binding"}
TELLING = {"tell", "say", "switch_off", "told"}  # functions whose arguments are read by a person
SHOWN = {
    "help",
    "description",
    "epilog",
    "title",
    "doc",
    "hint",
    "notice",
    "message",
    "heading",
    "explanation",
    "note",
}
BY_EXTRACTION = {*FIELDS, "Binding"}  # catalogues hold their titles without a mark
FOR_PROGRAMMERS = {
    "TypeError",
    "AttributeError",
    "KeyError",
    "NotImplementedError",
    "AssertionError",
    "RuntimeError",
}
IN_PROGRAMS = (
    "systems/program/templates/",
    "systems/program/machine_code.py",
    "systems/program/interpreter.py",
)
NAMES = {"limit reached"}  # statuses, which scripts compare
PHRASE = re.compile(r"[A-Za-z]{2,}[,.:;]? [a-zA-Z]{2,}|[a-z]{3,}\.$")


def sentences(path: Path) -> Iterator[tuple[int, str]]:
    """(line, text) of literals that a person reads and that are not looked up in catalogues."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        for read in read_by_people(node):
            yield from unsaid(read)


def read_by_people(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.Raise(exc=ast.Call(func=called) as error) if name_of(called) not in FOR_PROGRAMMERS:
            extracted = name_of(called) in KEYWORDS and isinstance(error.args[0], ast.Constant)
            yield from [*error.args[extracted:], *(keyword.value for keyword in error.keywords)]
        case ast.Assign(targets=targets, value=value) if any(name_of(target) in SHOWN for target in targets):
            yield value
        case ast.AugAssign(target=target, value=value) if name_of(target) in SHOWN:
            yield value
        case ast.Call(func=called) as call:
            name = name_of(called)
            if name in TELLING:
                yield from call.args
            if name == "Readout":
                yield from call.args[:2]
            if name not in BY_EXTRACTION:
                yield from (keyword.value for keyword in call.keywords if keyword.arg in SHOWN)


def name_of(node: ast.AST) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def unsaid(node: ast.AST) -> Iterator[tuple[int, str]]:
    """Literals that read like a phrase, outside of what says them."""
    if isinstance(node, ast.Call) and name_of(node.func) in SAYING:
        return
    if isinstance(node, ast.Constant):
        said = node.value if isinstance(node.value, str) else ""
        if PHRASE.search(said) and said not in NAMES and not said.startswith("pinjoint "):
            yield node.lineno, node.value
        return
    for child in ast.iter_child_nodes(node):
        yield from unsaid(child)


def wanting() -> list[str]:
    found = []
    for path in SOURCES:
        place = path.relative_to(ROOT).as_posix()
        if not place.startswith(IN_PROGRAMS):
            found += [f"{place}:{line}: {text}" for line, text in sorted(set(sentences(path)))]
    return found


def test_sentences_are_looked_up_in_catalogues() -> None:
    """For the list: python -m tests.architecture.test_sentences"""
    assert not (found := wanting()), "\n".join(found)


def test_a_sentence_that_is_not_looked_up_is_found(tmp_path: Path) -> None:
    path = tmp_path / "sample.py"
    path.write_text('raise ModelError(f"The rod {name} has no ends.")\nself.notice = tr("It is fine here.")\n')
    assert [text for _, text in sentences(path)] == ["The rod ", " has no ends."]


if __name__ == "__main__":
    sys.stdout.write("\n".join([*wanting(), ""]))
