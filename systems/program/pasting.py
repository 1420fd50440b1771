"""Pasting: functions of templates as source of a step program; systems/program/templates says what they may hold."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import Any

Inserts = Mapping[str, str | Sequence[str]]  # what stands for insert(…): an expression, or lines

_LINE = re.compile(r"( *)insert\((\w+)\)")
_EXPRESSION = re.compile(r"insert\((\w+)\)")
_ON_LINES = re.compile(r"\(\n((?:[^()]|\([^()]*\))*\*columns),?\s*\)")
_WIDTH = 112
_GROUPS = "|".join(
    (
        *("state", "forces", "scratch", "bounds", "limits", "kept", "observed"),
        *("placed", "moving", "pulled", "resisted", "acting", "tried", "accelerating", "correcting", "sizing"),
        *("strung", "diagonals", "inverses", "mobilities", "residuals", "vectors"),
    )
)


@cache
def source_of(function: Callable[..., Any]) -> str:
    """The source of a function, which takes a millisecond to find, with arguments that are groups on one line."""
    source = textwrap.dedent(inspect.getsource(function))
    return _ON_LINES.sub(lambda match: f"({' '.join(match[1].split())})", source)


@cache
def _head_and_body_of(function: Callable[..., Any]) -> tuple[str, Sequence[str]]:
    """The head of a function, stars before its groups, and the lines of its body."""
    head, body = source_of(function).split(":\n", 1)
    head = re.sub(rf"(?<=[(\s])({_GROUPS})(?=[,)])", r"*\1", head)
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


def pasted(function: Callable[..., Any], decorator: str, name: str = "", **inserts: str | Sequence[str]) -> str:
    """A template with a decorator, under its own or another name."""
    head, body = _head_and_body_of(function)
    if name:
        head = head.replace(f"def {function.__name__}(", f"def {name}(", 1)
    return "\n".join([f"@{decorator}", f"{head}:", *_filled(body, inserts)])


def fragment(function: Callable[..., Any], **inserts: str | Sequence[str]) -> list[str]:
    """The lines of a template without its head and its docstring."""
    return _filled(_statements_of(function), inserts)


def projected(lines: Sequence[str], names: Mapping[str, str]) -> list[str]:
    """What lines do with both components of vectors, done with the only one of others. names: how these are called."""
    body = _Projection(names).of(ast.parse("\n".join(lines)).body)
    return "\n".join(map(ast.unparse, body)).splitlines()


class _Projection(ast.NodeTransformer):
    """Leaves out what has to do with second components, [i, 1], and renames arrays."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self._names = names
        self._gone: set[str] = set()  # variables of second components

    def of(self, statements: Iterable[ast.stmt]) -> list[ast.stmt]:
        """The statements that are left."""
        kept = (self._kept(statement) for statement in statements)
        return [statement for statement in kept if statement is not None]

    def _kept(self, statement: ast.stmt) -> ast.stmt | None:
        if isinstance(statement, ast.For | ast.If | ast.FunctionDef):
            statement.body = self.of(statement.body)
            if not statement.body:
                return None
        elif any(self._is_second(node) for node in ast.walk(statement)):
            if isinstance(statement, ast.Assign | ast.AugAssign):
                targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
                self._gone |= {target.id for target in targets if isinstance(target, ast.Name)}
            return None
        visited: ast.stmt = self.visit(statement)
        return visited

    def _is_second(self, node: ast.AST) -> bool:
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Tuple):
            last = node.slice.elts[-1]
            return isinstance(last, ast.Constant) and last.value == 1
        return isinstance(node, ast.Name) and node.id in self._gone

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Rename an array."""
        return ast.Name(self._names.get(node.id, node.id), node.ctx)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """A loop over two components is one over a single one."""
        if ast.unparse(node) == "range(2)":
            return ast.parse("range(1)", mode="eval").body
        return self.generic_visit(node)


def _filled(lines: Iterable[str], inserts: Inserts) -> list[str]:
    filled: list[str] = []
    for line in lines:
        if "insert(" not in line:
            filled.append(line)
            continue
        whole = _LINE.fullmatch(line)
        if whole and not isinstance(inserts[whole[2]], str):
            filled += [whole[1] + inserted for inserted in inserts[whole[2]]]
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


def indented(lines: Iterable[str], levels: int = 1) -> list[str]:
    """The lines, so many levels deeper."""
    return ["    " * levels + line for line in lines]
