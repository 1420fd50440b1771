"""Pasting: functions of templates as source of a step program; systems/program/templates says what they may hold."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import Any

# What stands for insert(…): an expression, or lines; or whether the lines below `if NAME:` are there, without it.
Insert = str | Sequence[str] | bool

_CHOICE = re.compile(r"( *)if (not )?(\w+):")
_LINE = re.compile(r"( *)insert\((\w+)\)")
_EXPRESSION = re.compile(r"insert\((\w+)\)")
_ON_LINES = re.compile(r"\(\n((?:[^()]|\([^()]*\))*\*columns),?\s*\)")
_WIDTH = 112


@cache
def source_of(function: Callable[..., Any]) -> str:
    """The source of a function, which takes a millisecond to find, with arguments that are groups on one line."""
    source = textwrap.dedent(inspect.getsource(function))
    return _ON_LINES.sub(lambda match: f"({' '.join(match[1].split())})", source)


@cache
def _head_and_body_of(function: Callable[..., Any]) -> tuple[str, Sequence[str]]:
    """The head of a function, stars before its groups, and the lines of its body."""
    head, body = source_of(function).split(":\n", 1)
    head = re.sub(r"(?<=[(\s])(state|forces|scratch|bounds|kept|observed)(?=[,)])", r"*\1", head)
    return head, body.splitlines()


@cache
def _statements_of(function: Callable[..., Any]) -> Sequence[str]:
    """The lines of a function without its head and its docstring."""
    source = source_of(function)
    definition = ast.parse(source).body[0]
    assert isinstance(definition, ast.FunctionDef)
    statements = definition.body[ast.get_docstring(definition) is not None :]
    if not statements:
        return []
    return textwrap.dedent("\n".join(source.splitlines()[statements[0].lineno - 1 :])).splitlines()


def pasted(function: Callable[..., Any], decorator: str, name: str = "", **inserts: Insert) -> str:
    """A template with a decorator, under its own or another name."""
    head, body = _head_and_body_of(function)
    if name:
        head = head.replace(f"def {function.__name__}(", f"def {name}(", 1)
    return "\n".join([f"@{decorator}", f"{head}:", *_filled(_chosen(body, inserts), inserts)])


def fragment(function: Callable[..., Any], **inserts: Insert) -> list[str]:
    """The lines of a template without its head and its docstring."""
    return _filled(_chosen(_statements_of(function), inserts), inserts)


def _chosen(lines: Sequence[str], inserts: Mapping[str, Insert]) -> list[str]:
    """The lines with those of every choice that is known, in place of `if NAME:` and `else:`."""
    kept: list[str] = []
    at = 0
    while at < len(lines):
        choice = _CHOICE.fullmatch(lines[at])
        made = inserts.get(choice[3]) if choice else None
        at += 1
        if choice is None or not isinstance(made, bool):
            kept.append(lines[at - 1])
            continue
        made = not made if choice[2] else made
        for wanted in (made, not made):
            block, at = _block(lines, at, choice[1])
            kept += _chosen(block, inserts) if wanted else []
            if lines[at : at + 1] != [f"{choice[1]}else:"]:
                break
            at += 1
    return kept


def _block(lines: Sequence[str], at: int, before: str) -> tuple[list[str], int]:
    """The lines from one on that are indented deeper than `before`, a level less deep, and the place after them."""
    first = at
    while at < len(lines) and lines[at].startswith(f"{before} "):
        at += 1
    return [line[4:] for line in lines[first:at]], at


def _filled(lines: Iterable[str], inserts: Mapping[str, Insert]) -> list[str]:
    filled: list[str] = []
    for line in lines:
        if "insert(" not in line:
            filled.append(line)
            continue
        whole = _LINE.fullmatch(line)
        made = inserts[whole[2]] if whole else ""
        if whole and not isinstance(made, str | bool):
            filled += [whole[1] + inserted for inserted in made]
        else:
            filled.append(_EXPRESSION.sub(lambda match: str(inserts[match[1]]), line))
    return filled


def expanded(source: str, groups: Mapping[str, Sequence[str]]) -> str:
    """The source with its names for every group that is an argument, such as *columns."""
    argument = re.compile(rf"(?<=[(\s])\*({'|'.join(groups)})\b")
    for name in (name for name, names in groups.items() if not names):
        source = source.replace(f"*{name}, ", "")
    lines: list[str] = []
    for line in source.splitlines():
        text = argument.sub(lambda match: ", ".join(groups[match[1]]), line) if "*" in line else line
        lines += [line] if text == line else _wrapped(text)
    return "\n".join(lines) + "\n"


def _wrapped(line: str) -> list[str]:
    """A definition or a call in lines that are not too long."""
    deeper = " " * (len(line) - len(line.lstrip()) + 8)
    lines: list[str] = []
    while len(line) > _WIDTH and (space := line.rfind(" ", len(deeper), _WIDTH + 1)) > 0:
        lines.append(line[:space])
        line = deeper + line[space + 1 :]
    return [*lines, line]


def indented(lines: Iterable[str]) -> list[str]:
    """The lines, a level deeper."""
    return [f"    {line}" for line in lines]
