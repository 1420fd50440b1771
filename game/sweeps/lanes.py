"""Functions of a step program for many variants of a model side by side, made from those for one.

A processor that follows one small model waits for each result before it can go on; of variants side by side it
computes several at once. Arrays get one more axis, the lanes, last; around what is computed there is a loop over
the lanes, innermost, which the compiler vectorises. For each lane these are the same operations, in the same
order, hence the same bits.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Mapping, Sequence
from copy import deepcopy
from typing import Any

_MOST, _LEAST = 128, 32  # lanes; fewer than the least are not worth it
_KEPT_NEAR = 3200  # particles × lanes, so that what steps need stays near the processor


def lanes_for(particles: int) -> int:
    """How many variants of a model of so many particles are best computed side by side."""
    lanes = _MOST
    while lanes > _LEAST and lanes * particles > _KEPT_NEAR:
        lanes //= 2
    return lanes


_COMMON = ("rods_between",)  # arrays of all lanes together, besides constants and what laws of loads look up
_COMMON_ENDS = ("_on", "_values", "_first")
_KNOWN = ("range", "min", "max", "abs", "math")
_LANE = ast.Name("lane", ast.Load())


class LaneFunction:
    """A function of one variant, rewritten for lanes.

    No two of its arrays may share memory that it writes to. Its last parameters are `spare`, shape (spares, LANES),
    to write to, and `result`, shape (LANES,), if it returns anything.

    source: its definition. varying: parameters that are numbers of their own in each lane. called: those that it
    calls, for lanes too, by name. constants: choices by these are made here.
    """

    def __init__(
        self,
        source: ast.FunctionDef,
        varying: Collection[str],
        called: Mapping[str, LaneFunction] | None = None,
        constants: Mapping[str, Any] | None = None,
    ) -> None:
        self._varying = set(varying)
        self._common = {argument.arg for argument in source.args.args} - self._varying
        self._looked_up: set[str] = set()  # names of rows
        self._called = called or {}
        self._calls: list[tuple[ast.Call, str]] = []  # and the name of the result; ""
        self._loops: list[ast.For] = []
        self.returns = False
        function: ast.FunctionDef = _Settled(constants or {}).visit(deepcopy(source))
        function.body = self._body(function.body)
        first = max((self._function(call).spares for call, _ in self._calls), default=0)
        self._slots = {name: slot for slot, name in enumerate(self._lasting(), first)}
        self.spares: int = first + len(self._slots)
        for loop in self._loops:
            loop.body = [_InLane(self._varying, self._slots).visit(line) for line in loop.body]
        for call, result in self._calls:
            self._hand_over(call, result)
        function.args.args += [ast.arg(name) for name in ("spare", *(["result"] if self.returns else []))]
        function.decorator_list = [ast.Name("apart", ast.Load())]
        self.source = ast.unparse(ast.fix_missing_locations(function))

    def _body(self, lines: Iterable[ast.stmt]) -> list[ast.stmt]:
        """What is the same for all lanes stays, and calls; what is between goes into loops over the lanes."""
        made: list[ast.stmt] = []
        between: list[ast.stmt] = []
        for line in lines:
            if isinstance(line, ast.Return):
                self.returns = True
                told = _line("result[lane] = 0.0")
                told.value = line.value  # type: ignore[attr-defined]
                between.append(told)
            elif self._adds_there(line):
                made += self._in_a_loop(between) + self._in_a_loop([line])
                between = []
            elif call := self._call_in(line):
                made += [*self._in_a_loop(between), ast.Expr(call)]
                between = []
            elif not (isinstance(line, ast.For) or self._is_common(line)):
                between.append(line)
            else:
                made += self._in_a_loop(between)
                between = []
                made.append(self._kept(line))
        return made + self._in_a_loop(between)

    def _call_in(self, line: ast.stmt) -> ast.Call | None:
        """The call that a line consists of, besides a name for its result."""
        call = line.value if isinstance(line, ast.Expr | ast.Assign) else None
        if not (
            isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in self._called
        ):
            return None
        self._calls.append((call, ast.unparse(line.targets[0]) if isinstance(line, ast.Assign) else ""))
        return call

    def _function(self, call: ast.Call) -> LaneFunction:
        return self._called[ast.unparse(call.func)]

    def _hand_over(self, call: ast.Call, result: str) -> None:
        """Give a call all lanes of its arguments, what is spare, and where to leave its result."""
        rows = {
            name: ast.Subscript(ast.Name("spare", ast.Load()), ast.Constant(slot), ast.Load())
            for name, slot in self._slots.items()
        }
        call.args = [rows.get(ast.unparse(argument), argument) for argument in call.args]
        call.args += [ast.Name("spare", ast.Load()), *([rows[result]] if result else [])]

    def _adds_there(self, line: ast.stmt) -> bool:
        """Whether it adds to what was looked up: alone in a loop, nothing in it can be the same in memory."""
        return isinstance(line, ast.AugAssign) and bool(_names(line.target) & self._looked_up)

    def _is_common(self, line: ast.stmt) -> bool:
        """Whether it is the same for all lanes: a comment, a choice, a look-up of who is meant, a view of an array."""
        if isinstance(line, ast.Expr):
            return isinstance(line.value, ast.Constant)
        if isinstance(line, ast.Pass):
            return True
        if isinstance(line, ast.If):
            return self._knows(line.test)
        if isinstance(line, ast.Assign):
            return self._knows(line.value) and any(isinstance(n, ast.Subscript) for n in ast.walk(line.value))
        return False

    def _kept(self, line: ast.stmt) -> ast.stmt:
        if isinstance(line, ast.For):
            self._common |= _names(line.target)
            line.body = self._body(line.body)
        elif isinstance(line, ast.If):
            line.body, line.orelse = self._body(line.body), self._body(line.orelse)
        elif isinstance(line, ast.Assign):
            found = {name for target in line.targets for name in _names(target)}
            self._common |= found
            self._looked_up |= found
        return line

    def _knows(self, value: ast.expr) -> bool:
        """Whether a value is the same for all lanes."""
        elements = [n for n in ast.walk(value) if isinstance(n, ast.Subscript) and not _is_view(n)]
        return all(is_common(ast.unparse(e.value)) for e in elements) and all(
            name.isupper() or name in self._common or name in _KNOWN for name in _names(value)
        )

    def _in_a_loop(self, lines: list[ast.stmt]) -> list[ast.stmt]:
        if not lines:
            return []
        loop = _line("for lane in range(LANES):\n    pass")
        assert isinstance(loop, ast.For)
        loop.body = lines
        self._loops.append(loop)
        return [loop]

    def _lasting(self) -> list[str]:
        """Local numbers that several of the loops and calls know: they are kept in `spare`."""
        known: dict[str, int] = {}
        for loop in self._loops:
            stored = (n for line in loop.body for n in ast.walk(line) if isinstance(n, ast.Name))
            known |= {n.id: 0 for n in stored if isinstance(n.ctx, ast.Store)}
        known |= {result: 0 for _, result in self._calls if result}
        pieces = [{name for line in loop.body for name in _names(line)} for loop in self._loops]
        pieces += [_names(call) | {result} for call, result in self._calls]
        for piece in pieces:
            for name in piece & set(known):
                known[name] += 1
        return [name for name, count in known.items() if count > 1]


class _Settled(ast.NodeTransformer):
    """Leaves of choices by constants what is chosen: it needs no loop of its own."""

    def __init__(self, constants: Mapping[str, Any]) -> None:
        self._constants = constants

    def visit_If(self, node: ast.If) -> ast.stmt | list[ast.stmt]:
        self.generic_visit(node)
        test = ast.unparse(node.test)
        if not _names(node.test) <= set(self._constants):
            return node
        return (node.body if eval(test, dict(self._constants)) else node.orelse) or ast.Pass()


class _InLane(ast.NodeTransformer):
    """Gives elements of arrays, and numbers of their own, the index of their lane."""

    def __init__(self, varying: Collection[str], slots: dict[str, int]) -> None:
        self._varying, self._slots = varying, slots

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        if not (is_common(ast.unparse(node.value)) or ast.unparse(node.slice) == "lane"):
            index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            node.slice = ast.Tuple([*map(self.visit, index), _LANE], ast.Load())
        return node

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in self._slots:
            place = ast.Tuple([ast.Constant(self._slots[node.id]), _LANE], ast.Load())
            return ast.Subscript(ast.Name("spare", ast.Load()), place, node.ctx)
        if node.id in self._varying:
            return ast.Subscript(ast.Name(node.id, ast.Load()), _LANE, node.ctx)
        return node


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def is_common(name: str) -> bool:
    """Whether an array of this name is one for all lanes."""
    return name.isupper() or name in _COMMON or name.endswith(_COMMON_ENDS)


def _is_view(node: ast.Subscript) -> bool:
    """Whether it is a part of an array, such as the rows of a stage, and not an element."""
    return (isinstance(node.slice, ast.Name) and node.slice.id.isupper()) or isinstance(node.slice, ast.BinOp)


def _line(text: str) -> ast.stmt:
    return ast.parse(text).body[0]


def functions(source: str) -> dict[str, ast.FunctionDef]:
    """The functions of a module, by name."""
    return {line.name: line for line in ast.parse(source).body if isinstance(line, ast.FunctionDef)}


def head(source: str) -> str:
    """What a module says before and between its functions."""
    others: Sequence[ast.stmt] = [
        line for line in ast.parse(source).body if not isinstance(line, ast.FunctionDef)
    ]
    return "\n".join(ast.unparse(line) for line in others) + "\n"
