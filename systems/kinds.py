"""Kinds of numbers in kernels that others write: which ones machine code would compute with.

numba decides for every expression whether it is a truth value, a whole number of 64 bits or a float; in Python a
number only tells as it is computed. Here the same is decided, by the same rules, and the plain form of a kernel is
given what it needs to compute the same bits: conversions where branches meet, quotients by 0, errors where whole
numbers outgrow 64 bits. What these rules do not cover is refused, by name: such a kernel has machine code only.

A kind is "b", "i" or "f", a capital where the compiler may know the number itself, a tuple of kinds, an Array, or ""
for nothing.
"""

from __future__ import annotations

import ast
import copy
import inspect
import linecache
import math
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType, ModuleType
from typing import Any, NoReturn

import numpy as np

from pinjoint.systems.interpreter import (
    NoPlainForm,
    call_of,
    definition,
    library_of,
    literal,
    outside_of,
    plain_function,
    rewritten,
)

NOTHING = ""
MOST_POWER = 64  # constant whole exponents, by which machine code multiplies


@dataclass(frozen=True)
class Array:
    """Of numbers of one kind."""

    kind: str
    dimensions: int


Kind = str | Array | tuple["Kind", ...]
Environment = dict[str, Kind]  # the kinds of local names; of those that have a value on all ways
Rewritten = tuple[Any, Kind]  # an expression and its kind

_OF_TYPES: Mapping[Any, str] = {bool: "b", int: "i", float: "f", np.bool_: "b", np.int64: "i", np.float64: "f"}
_ARITHMETIC: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_COMPARISONS = ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq
_OPTIONS = (
    *("nopython", "error_model", "boundscheck", "cache", "nogil"),
    *("no_cpython_wrapper", "no_cfunc_wrapper", "_nrt"),
)
_OF_FLOATS = (
    *("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "exp2", "expm1", "log", "log1p", "log2", "log10"),
    *("sqrt", "fabs", "degrees", "radians"),
)
_INVERSE = ("sin", "cos", "tan", "sinh", "cosh", "tanh")
_TESTS = ("isnan", "isinf", "isfinite")
_ROUNDING = ("floor", "ceil", "trunc")
_FUNCTIONS: Mapping[Any, Mapping[str, tuple[int, str]]] = {  # how many floats each takes, kind of the result
    math: {
        **dict.fromkeys((*_OF_FLOATS, *(f"a{name}" for name in _INVERSE)), (1, "f")),
        **dict.fromkeys(("atan2", "hypot", "copysign"), (2, "f")),
        **dict.fromkeys(_TESTS, (1, "b")),
        **dict.fromkeys(_ROUNDING, (1, "i")),
    },
    np: {
        **dict.fromkeys((*_OF_FLOATS, *_ROUNDING, *(f"arc{name}" for name in _INVERSE)), (1, "f")),
        **dict.fromkeys(("sign", "deg2rad", "rad2deg"), (1, "f")),
        **dict.fromkeys(("arctan2", "hypot", "copysign", "minimum", "maximum"), (2, "f")),
        **dict.fromkeys(_TESTS, (1, "b")),
    },
}


def kind_of_dtype(dtype: Any) -> str:
    """The kind of an array's numbers; the name of their type where machine code computes differently with them."""
    return _OF_TYPES.get(dtype.type, dtype.name)


@dataclass(frozen=True)
class Typed:
    """A kernel for arguments of certain kinds: its plain form, and the kind of its result."""

    plain: Callable[..., Any]
    result: Kind


_typed: dict[Any, Typed] = {}
_begun: list[Any] = []


def typed(function: Callable[..., Any], kinds: Sequence[Kind]) -> Typed:
    """A kernel for arguments of these kinds. Raises NoPlainForm, which says what cannot be interpreted."""
    plain = plain_function(function)
    key = plain, tuple(kinds)
    if key in _begun:
        raise NoPlainForm(f"{plain.__name__} calls itself")
    if key not in _typed:
        for kind in _parts(tuple(kinds)):
            if len(kind) != 1:
                raise NoPlainForm(f"{plain.__name__} is given numbers of the type {kind}")
        _check_options(function, plain)
        _begun.append(key)
        try:
            _typed[key] = _Inference(plain).typed(kinds)
        finally:
            _begun.pop()
    return _typed[key]


def _parts(kind: Kind) -> Iterator[str]:
    """The kinds of all numbers in it."""
    if isinstance(kind, tuple):
        for part in kind:
            yield from _parts(part)
    else:
        yield kind.kind if isinstance(kind, Array) else kind


def _check_options(function: Any, plain: Any) -> None:
    options = getattr(function, "targetoptions", {})
    special = [name for name, value in options.items() if value and name not in _OPTIONS]
    if special or not getattr(function, "_can_compile", True):
        raise NoPlainForm(f"{plain.__name__} is compiled with {', '.join(special) or 'types of its own'}")


def _check_unchanged(plain: Any) -> None:
    """Raise NoPlainForm if the source is not that of the function in memory: its file was edited since."""
    file = plain.__code__.co_filename
    if _identity(plain.__code__) not in _functions_in("".join(linecache.getlines(file)), file):
        raise NoPlainForm(f"{plain.__name__} is another one by now in {file}")


def _identity(code: CodeType) -> tuple[Any, ...]:
    constants = repr([constant for constant in code.co_consts if not isinstance(constant, CodeType)])
    return code.co_firstlineno, code.co_name, code.co_code, code.co_names, constants


@lru_cache(maxsize=8)
def _functions_in(text: str, file: str) -> frozenset[tuple[Any, ...]]:
    """What all functions in a file are compiled to."""
    pending, found = [compile(text, file, "exec", dont_inherit=True)], list[CodeType]()
    while pending:
        found.append(pending.pop())
        pending += [constant for constant in found[-1].co_consts if isinstance(constant, CodeType)]
    return frozenset(map(_identity, found))


def _low(kind: Kind) -> Kind:
    """The same kind of a number that is not known before."""
    if isinstance(kind, tuple):
        return tuple(map(_low, kind))
    return kind.lower() if isinstance(kind, str) else kind


def _high(kind: Kind) -> Kind:
    """The same kind of a number that may be known before."""
    if isinstance(kind, tuple):
        return tuple(map(_high, kind))
    return kind.upper() if isinstance(kind, str) else kind


def _joined(a: Kind, b: Kind) -> Kind | None:
    """The kind of what may be of either; None if there is none."""
    if isinstance(a, tuple) and isinstance(b, tuple) and len(a) == len(b):
        parts = [_joined(x, y) for x, y in zip(a, b, strict=True)]
        return None if None in parts else tuple(parts)  # type: ignore[arg-type]
    if a == b or not (isinstance(a, str) and isinstance(b, str)):
        return a if a == b else None
    kinds = {a.lower(), b.lower()}
    if len(kinds) > 1 and kinds != {"i", "f"}:
        return None
    return min(kinds).upper() if a.isupper() and b.isupper() else min(kinds)


class _Inference:
    """Goes through one function for arguments of certain kinds."""

    def __init__(self, plain: Any) -> None:
        self._plain = plain
        self._outside = outside_of(plain)
        self._own = {*plain.__code__.co_varnames, *plain.__code__.co_cellvars}
        self._called: dict[str, Any] = {}  # plain forms of kernels that it calls, by new names
        self._result: Kind | None = None  # of what is returned, as far as is known
        self._chosen: set[str] = set()  # local names that may be one of several numbers
        self._loops: list[tuple[Environment, list[Environment]]] = []  # at the head of each; at each `break`

    def typed(self, kinds: Sequence[Kind]) -> Typed:
        """The function for arguments of these kinds."""
        read = definition(self._plain)
        while True:
            node = copy.deepcopy(read)
            given = node.args
            names = [argument.arg for argument in (*given.posonlyargs, *given.args)]
            if given.vararg or given.kwarg or given.kwonlyargs or len(names) != len(kinds):
                self._refuse(node, "the head of the function")
            known = self._result
            node.body, end = self._block(node.body, dict(zip(names, kinds, strict=True)))
            if end is not None:
                self._returns(node, NOTHING)
            if self._result == known:
                break
        _check_unchanged(self._plain)
        given.defaults = []
        assert self._result is not None
        return Typed(rewritten(self._plain, node, self._called), self._result)

    def _refuse(self, node: Any, what: str) -> NoReturn:
        line = f" in line {node.lineno}" if hasattr(node, "lineno") else ""
        raise NoPlainForm(f"{what}{line} of {self._plain.__name__}")

    # --- statements ------------------------------------------------------------------------------------

    def _block(self, statements: list[ast.stmt], env: Environment) -> tuple[list[ast.stmt], Environment | None]:
        """The statements, rewritten, and the kinds after them; None if nothing comes after."""
        made: list[ast.stmt] = []
        now: Environment | None = env
        for statement in statements:
            if now is None:
                break
            write = getattr(self, f"_do_{type(statement).__name__}", None)
            if write is None:
                self._refuse(statement, f"a statement '{type(statement).__name__.lower()}'")
            lines, now = write(statement, now)
            made += [ast.copy_location(line, statement) for line in lines]
        return made or [ast.Pass()], now

    def _meet(self, node: Any, ways: Sequence[Environment]) -> tuple[Environment, list[ast.stmt]]:
        """The kinds where several ways meet, and the conversions that are due there."""
        first, *others = ways
        kinds: Environment = {}
        for name, kind in first.items():
            for other in others:
                joined = _joined(kind, other[name]) if name in other else NOTHING
                if joined is None:
                    self._refuse(node, f"'{name}', of several kinds")
                if joined == NOTHING:
                    break
                kind = joined
            else:
                kinds[name] = kind
                if any(_low(way[name]) != way[name] for way in ways):
                    self._chosen.add(name)
        return kinds, [line for way in ways for line in self._conversions(node, way, kinds)]

    def _conversions(self, node: Any, now: Environment, then: Environment) -> list[ast.stmt]:
        """What makes the names be of the kinds that they are to be of."""
        lines: list[ast.stmt] = []
        for name, kind in then.items():
            if _low(now[name]) != _low(kind):
                value = self._as(node, ast.Name(name, ast.Load()), now[name], kind)
                lines.append(ast.Assign([ast.Name(name, ast.Store())], value))
        return lines

    def _do_Pass(self, node: ast.Pass, env: Environment) -> tuple[list[ast.stmt], Environment]:
        return [], env

    def _do_Expr(self, node: ast.Expr, env: Environment) -> tuple[list[ast.stmt], Environment]:
        if isinstance(node.value, ast.Constant):
            return [], env  # a docstring
        node.value, _ = self._read(node.value, env)
        return [node], env

    def _do_Return(self, node: ast.Return, env: Environment) -> tuple[list[ast.stmt], None]:
        if node.value is None:
            self._returns(node, NOTHING)
            return [node], None
        node.value, kind = self._read(node.value, env)
        if isinstance(kind, Array):
            self._refuse(node, "an array as the result")
        self._returns(node, kind)
        assert self._result is not None
        node.value = self._as(node, node.value, kind, self._result)
        return [node], None

    def _returns(self, node: Any, kind: Kind) -> None:
        joined = kind if self._result is None else _joined(self._result, kind)
        if joined is None:
            self._refuse(node, "results of several kinds")
        self._result = _low(joined)

    def _do_Assign(self, node: ast.Assign, env: Environment) -> tuple[list[ast.stmt], Environment]:
        node.value, kind = self._read(node.value, env)
        if self._has_choice(node.value):
            names = (part for target in node.targets for part in ast.walk(target))
            self._chosen |= {part.id for part in names if isinstance(part, ast.Name)}
        env = dict(env)
        for target in node.targets:
            self._bind(target, kind, env)
        return [node], env

    def _bind(self, target: ast.expr, kind: Kind, env: Environment) -> None:
        if isinstance(target, ast.Name) and kind != NOTHING:
            env[target.id] = kind
        elif isinstance(target, ast.Tuple) and isinstance(kind, tuple) and len(target.elts) == len(kind):
            for part, of_part in zip(target.elts, kind, strict=True):
                self._bind(part, of_part, env)
        else:
            self._refuse(target, "an assignment")

    def _do_AnnAssign(self, node: ast.AnnAssign, env: Environment) -> tuple[list[ast.stmt], Environment]:
        if node.value is None:
            self._refuse(node, "a declaration")
        return self._do_Assign(ast.copy_location(ast.Assign([node.target], node.value), node), env)

    def _do_AugAssign(self, node: ast.AugAssign, env: Environment) -> tuple[list[ast.stmt], Environment]:
        if not isinstance(node.target, ast.Name):
            self._refuse(node, "an assignment")
        name = ast.copy_location(ast.Name(node.target.id, ast.Load()), node)
        value = ast.copy_location(ast.BinOp(name, node.op, node.value), node)
        return self._do_Assign(ast.copy_location(ast.Assign([node.target], value), node), env)

    def _do_If(self, node: ast.If, env: Environment) -> tuple[list[ast.stmt], Environment | None]:
        node.test, known = self._tested(node.test, env)
        node.body, after = self._block(node.body, dict(env))
        node.orelse, otherwise = self._block(node.orelse, dict(env))
        ways = [way for way in (after, otherwise) if way is not None]
        if not ways:
            return [node], None
        kinds, conversions = self._meet(node, ways)
        if conversions and known:
            self._refuse(node, "a choice that may be known before")  # of which numba drops a branch
        return [node, *conversions], kinds

    def _tested(self, node: ast.expr, env: Environment) -> tuple[ast.expr, bool]:
        """A condition, and whether the compiler may know the answer."""
        test, kind = self._scalar(node, env)
        return test, kind.isupper()

    def _do_Break(self, node: ast.Break, env: Environment) -> tuple[list[ast.stmt], None]:
        self._loops[-1][1].append(env)
        return [node], None

    def _do_Continue(self, node: ast.Continue, env: Environment) -> tuple[list[ast.stmt], None]:
        head = self._loops[-1][0]
        return [*self._conversions(node, env, self._at_head(node, head, env)), node], None

    def _at_head(self, node: Any, head: Environment, env: Environment) -> Environment:
        """Let the kinds at the head of a loop be those that come around, too."""
        kinds, _ = self._meet(node, [head, env])
        head.clear()
        head.update(kinds)
        return kinds

    def _do_While(self, node: ast.While, env: Environment) -> tuple[list[ast.stmt], Environment | None]:
        def begin(head: Environment) -> None:
            made.test, _ = self._tested(copy.deepcopy(node.test), head)

        made = copy.copy(node)
        return self._loop(node, made, env, begin, endless=literal(node.test) is True)

    def _do_For(self, node: ast.For, env: Environment) -> tuple[list[ast.stmt], Environment | None]:
        made = copy.copy(node)
        self._chosen |= {part.id for part in ast.walk(node.target) if isinstance(part, ast.Name)}
        counts = isinstance(node.iter, ast.Call) and self._is_builtin(node.iter.func, "range")
        if counts:
            assert isinstance(node.iter, ast.Call)
            ends = [self._read(end, env) for end in node.iter.args]
            if node.iter.keywords or not all(_low(kind) == "i" for _, kind in ends):
                self._refuse(node, "a range of what are no whole numbers")
            made.iter, each = call_of("range", *(end for end, _ in ends)), "i"
        else:
            made.iter, kind = self._read(node.iter, env)
            kinds = {*kind} if isinstance(kind, tuple) else set()
            if len(kinds) != 1 or not isinstance(of_entry := kinds.pop(), str):
                self._refuse(node, "a loop")
            each = of_entry.lower()
        return self._loop(node, made, env, lambda head: self._bind(node.target, each, head))

    def _loop(
        self,
        node: Any,
        made: Any,
        env: Environment,
        begin: Callable[[Environment], None],
        endless: bool = False,
    ) -> tuple[list[ast.stmt], Environment | None]:
        """A loop, gone through until the kinds at its head stay the same."""
        if node.orelse:
            self._refuse(node, "an `else` of a loop")
        head = dict(env)
        while True:
            before, breaks = dict(head), list[Environment]()
            self._loops.append((head, breaks))
            inside = dict(head)
            begin(inside)
            made.body, end = self._block(copy.deepcopy(node.body), inside)
            self._loops.pop()
            if end is not None:
                made.body += self._conversions(node, end, self._at_head(node, head, end))
            if head == before:
                break
        if endless and not breaks:
            return [*self._conversions(node, env, head), made], None
        kinds, conversions = self._meet(node, breaks if endless else [head, *breaks])
        return [*self._conversions(node, env, head), made, *conversions], kinds

    # --- expressions -----------------------------------------------------------------------------------

    def _read(self, node: ast.expr, env: Environment) -> Rewritten:
        read = getattr(self, f"_of_{type(node).__name__}", None)
        if read is None:
            self._refuse(node, f"an expression '{type(node).__name__.lower()}'")
        made, kind = read(node, env)
        return ast.copy_location(made, node), kind

    def _scalar(self, node: ast.expr, env: Environment) -> tuple[ast.expr, str]:
        made, kind = self._read(node, env)
        if not isinstance(kind, str) or kind == NOTHING:
            self._refuse(node, "what is no number")
        return made, kind

    def _scalars(self, nodes: Sequence[ast.expr], env: Environment) -> tuple[list[ast.expr], str]:
        """Numbers, made of one kind."""
        return self._unified(nodes[0], [self._scalar(node, env) for node in nodes])

    def _unified(self, node: ast.expr, read: Sequence[tuple[ast.expr, str]]) -> tuple[list[ast.expr], str]:
        common = read[0][1]
        for _, kind in read:
            joined = _joined(common, kind)
            if not isinstance(joined, str):
                self._refuse(node, "truth values among numbers")
            common = joined
        return [self._as(m, m, k, common) for m, k in read], common

    def _as(self, node: Any, value: ast.expr, kind: Kind, wanted: Kind) -> ast.expr:
        """A value, converted."""
        if _low(kind) == _low(wanted):
            return value
        if isinstance(wanted, str):
            number = literal(value)
            made: ast.expr = call_of("float__", value) if number is None else ast.Constant(float(number))
            return ast.copy_location(made, value) if hasattr(value, "lineno") else made
        if not isinstance(value, ast.Tuple):
            self._refuse(node, "pairs of several kinds")
        assert isinstance(kind, tuple)
        assert isinstance(wanted, tuple)
        value.elts = [self._as(node, *each) for each in zip(value.elts, kind, wanted, strict=True)]
        return value

    def _of_Constant(self, node: ast.Constant, env: Environment) -> Rewritten:
        value = node.value
        if type(value) not in _OF_TYPES or (isinstance(value, int) and not -(2**63) <= value < 2**63):
            self._refuse(node, f"{value!r:.40}")
        return node, _OF_TYPES[type(node.value)].upper()

    def _of_Name(self, node: ast.Name, env: Environment) -> Rewritten:
        if node.id not in self._own:
            return self._from_outside(node)
        if node.id not in env:
            self._refuse(node, f"'{node.id}', which may have no value")
        return node, env[node.id]

    def _of_Attribute(self, node: ast.Attribute, env: Environment) -> Rewritten:
        return self._from_outside(node)

    def _value(self, node: ast.AST) -> Any:
        """What a name from outside, or of a module from outside, stands for; None if for nothing."""
        if isinstance(node, ast.Name) and node.id not in self._own:
            return self._outside.get(node.id)
        if isinstance(node, ast.Attribute):
            owner = self._value(node.value)
            return getattr(owner, node.attr, None) if isinstance(owner, ModuleType) else None
        return None

    def _from_outside(self, node: ast.expr) -> Rewritten:
        value = self._value(node)
        if type(value) in _OF_TYPES:
            number = value.item() if isinstance(value, np.generic) else value
            return self._of_Constant(ast.copy_location(ast.Constant(number), node), {})
        if isinstance(value, tuple) and value and all(type(entry) in (bool, int, float) for entry in value):
            return node, tuple(_OF_TYPES[type(entry)].upper() for entry in value)
        if isinstance(value, np.ndarray) and value.dtype.type in _OF_TYPES:
            return node, Array(kind_of_dtype(value.dtype).upper(), value.ndim)
        self._refuse(node, f"'{ast.unparse(node):.40}'")

    def _of_UnaryOp(self, node: ast.UnaryOp, env: Environment) -> Rewritten:
        node.operand, kind = self._scalar(node.operand, env)
        if isinstance(node.op, ast.Not):
            return node, "B" if kind.isupper() else "b"
        if isinstance(node.op, ast.Invert) or kind.lower() == "b":
            self._refuse(node, "an operation on bits")
        number = literal(node)
        made = node if number is None else ast.copy_location(ast.Constant(number), node)
        return self._whole(made, kind), kind

    def _whole(self, node: ast.expr, kind: str) -> ast.expr:
        """A number; whole ones of at most 64 bits."""
        return node if kind.lower() == "f" or literal(node) is not None else call_of("in_64_bits__", node)

    def _of_BinOp(self, node: ast.BinOp, env: Environment) -> Rewritten:
        if isinstance(node.op, ast.Pow):
            return self._power(node, env)
        (left, a), (right, b) = self._scalar(node.left, env), self._scalar(node.right, env)
        known = a.isupper() and b.isupper()
        kind = "f" if isinstance(node.op, ast.Div) or "f" in (a.lower(), b.lower()) else "i"
        if kind == "f":
            left, right = self._as(node, left, a, "f"), self._as(node, right, b, "f")
        kind = kind.upper() if known else kind
        if isinstance(node.op, ast.FloorDiv | ast.Mod):
            if "b" in (a.lower(), b.lower()):
                self._refuse(node, "a quotient of truth values")
            helper = "floor_divided__" if isinstance(node.op, ast.FloorDiv) else "remainder__"
            return call_of(helper, left, right), kind
        if type(node.op) not in _ARITHMETIC:
            self._refuse(node, f"an operation '{type(node.op).__name__.lower()}'")
        x, y = literal(left), literal(right)
        if x is None or y is None or (y == 0 and isinstance(node.op, ast.Div)):
            return self._whole(ast.BinOp(left, node.op, right), kind), kind
        number = _ARITHMETIC[type(node.op)](x, y)  # as Python itself does, before numba comes to see it
        return self._of_Constant(ast.copy_location(ast.Constant(number), node), env)

    def _power(self, node: ast.BinOp, env: Environment) -> Rewritten:
        return self._power_of(node, self._scalar(node.left, env), self._scalar(node.right, env))

    def _power_of(
        self, node: ast.expr, base: tuple[ast.expr, str], exponent: tuple[ast.expr, str]
    ) -> Rewritten:
        """A power. Where the optimiser knows base or exponent, it takes other ways to compute it."""
        (x, of_x), (y, of_y) = base, exponent
        known, number = literal(x), literal(y)
        if of_y.lower() == "i" and isinstance(number, int) and known is None:
            if of_x.lower() == "i" and 0 <= number <= MOST_POWER:
                return call_of("in_64_bits__", call_of("int_power__", x, y)), "i"
            if of_x.lower() == "f" and 0 <= number <= MOST_POWER:
                return ast.BinOp(x, ast.Pow(), y), "f"
            if of_x.lower() == "f" and -MOST_POWER <= number < 0:
                return call_of("inverse_power__", x, y), "f"
        elif of_y.lower() == "f" and of_x.lower() in ("i", "f") and (known is None or number is None):
            exact = known is None or known == 2 or (known > 0 and math.frexp(known)[0] != 0.5)
            varies = of_y.islower() and not self._has_choice(y) and (known is not None or of_x.islower())
            if exact and (number is not None or varies):
                return ast.BinOp(self._as(node, x, of_x, "f"), ast.Pow(), y), "f"
        self._refuse(node, "a power")

    def _has_choice(self, node: ast.expr) -> bool:
        """True if an expression may be one of several numbers, of which the compiler may know some."""
        return any(
            isinstance(part, ast.IfExp | ast.BoolOp) or (isinstance(part, ast.Name) and part.id in self._chosen)
            for part in ast.walk(node)
        )

    def _of_Compare(self, node: ast.Compare, env: Environment) -> Rewritten:
        if not all(isinstance(op, _COMPARISONS) for op in node.ops):
            self._refuse(node, "a comparison")
        read = [self._scalar(value, env) for value in (node.left, *node.comparators)]
        (node.left, *node.comparators), kind = self._unified(node, read)
        if (
            kind == "f" and [of_one for _, of_one in read].count("i") > 1
        ):  # which numba does not compare as floats
            self._refuse(node, "a comparison")
        return node, "B" if kind.isupper() else "b"

    def _of_BoolOp(self, node: ast.BoolOp, env: Environment) -> Rewritten:
        read = [self._scalar(value, env) for value in node.values]
        if len({kind.lower() for _, kind in read}) > 1:
            self._refuse(node, "`and` or `or` of several kinds")
        node.values = [value for value, _ in read]
        return node, max(kind for _, kind in read)

    def _of_IfExp(self, node: ast.IfExp, env: Environment) -> Rewritten:
        node.test, known = self._tested(node.test, env)
        (body, a), (orelse, b) = self._read(node.body, env), self._read(node.orelse, env)
        kind = _joined(a, b)
        if kind is None or (known and _low(a) != _low(b)):
            self._refuse(node, "a choice of several kinds")
        node.body, node.orelse = self._as(node, body, a, kind), self._as(node, orelse, b, kind)
        return node, kind

    def _of_Tuple(self, node: ast.Tuple, env: Environment) -> Rewritten:
        read = [self._read(entry, env) for entry in node.elts]
        if not read or any(isinstance(kind, Array) or kind == NOTHING for _, kind in read):
            self._refuse(node, "a tuple")
        node.elts = [entry for entry, _ in read]
        return node, tuple(kind for _, kind in read)

    def _of_Subscript(self, node: ast.Subscript, env: Environment) -> Rewritten:
        node.value, kind = self._read(node.value, env)
        if isinstance(kind, Array):
            indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            read = [self._scalar(index, env) for index in indices]
            if len(read) != kind.dimensions or not all(k.lower() == "i" for _, k in read):
                self._refuse(node, "a part of an array")
            made = [index for index, _ in read]
            node.slice = made[0] if len(made) == 1 else ast.Tuple(made, ast.Load())
            return node, kind.kind
        node.slice, of_index = self._scalar(node.slice, env)
        place = literal(node.slice)
        if isinstance(kind, tuple) and of_index.lower() == "i":
            if isinstance(place, int) and -len(kind) <= place < len(kind):
                return node, kind[place]
            if place is None and len({_low(k) for k in kind}) == 1:
                return node, max(kind, key=str)
        self._refuse(node, "an entry")

    # --- calls -----------------------------------------------------------------------------------------

    def _is_builtin(self, node: ast.expr, name: str) -> bool:
        return isinstance(node, ast.Name) and node.id == name and node.id not in (*self._own, *self._outside)

    def _of_Call(self, node: ast.Call, env: Environment) -> Rewritten:
        value = self._value(node.func)
        if hasattr(value, "py_func"):
            return self._of_kernel(node, value, env)
        if node.keywords or any(isinstance(argument, ast.Starred) for argument in node.args):
            self._refuse(node, "a call with keywords")
        if isinstance(node.func, ast.Name) and self._is_builtin(node.func, node.func.id):
            call = getattr(self, f"_call_{node.func.id}", None)
            if call is not None and node.args:
                made: Rewritten = call(node, env)
                return made
        if (library := library_of(value)) is not None:
            return self._of_library(node, library, value.__name__, env)
        self._refuse(node, f"a call of '{ast.unparse(node.func):.40}'")

    def _of_kernel(self, node: ast.Call, kernel: Any, env: Environment) -> Rewritten:
        """Of another kernel, for arguments of these kinds."""
        signature = inspect.signature(plain_function(kernel))
        try:
            bound = signature.bind(*node.args, **{k.arg or "": k.value for k in node.keywords})
        except TypeError:
            self._refuse(node, f"the arguments of '{ast.unparse(node.func):.40}'")
        bound.apply_defaults()
        arguments = [a if isinstance(a, ast.expr) else ast.Constant(a) for a in bound.arguments.values()]
        read = [self._read(ast.copy_location(a, node), env) for a in arguments]
        kinds = [_high(kind) if self._has_choice(argument) else kind for argument, kind in read]
        found = typed(kernel, kinds)
        name = f"kernel{len(self._called)}__"
        self._called[name] = found.plain
        return call_of(name, *(argument for argument, _ in read)), found.result

    def _of_library(self, node: ast.Call, library: Any, name: str, env: Environment) -> Rewritten:
        """A function of floats."""
        if library is np and name in ("absolute", "float64"):
            return self._call_float(node, env) if name == "float64" else self._call_abs(node, env)
        if library is math and name == "pow" and len(node.args) == 2:
            both = [self._scalar(argument, env) for argument in node.args]
            x, y = ((self._as(node, v, kind, "f"), "f" if kind.islower() else "F") for v, kind in both)
            return self._power_of(node, x, y)
        count, result = _FUNCTIONS[library].get(name, (0, ""))
        if count != len(node.args):
            self._refuse(node, f"a call of '{ast.unparse(node.func):.40}'")
        read = [self._scalar(argument, env) for argument in node.args]
        exact = name in (*_TESTS, *_ROUNDING, "sign")  # which numba takes of whole numbers differently
        for _, kind in read:
            if kind.lower() == "b" or (exact and kind.lower() == "i") or (name in _ROUNDING and kind == "F"):
                self._refuse(node, f"a call of '{name}' with a constant, or with what is no float")
        node.args = [self._as(node, value, kind, "f") for value, kind in read]
        if result == "i":
            return call_of(f"checked_{name}__", *node.args), "i"
        return node, result.upper() if all(kind.isupper() for _, kind in read) else result

    def _single(self, node: ast.Call, env: Environment) -> tuple[ast.expr, str]:
        if len(node.args) != 1:
            self._refuse(node, f"the arguments of '{ast.unparse(node.func):.40}'")
        return self._scalar(node.args[0], env)

    def _call_abs(self, node: ast.Call, env: Environment) -> Rewritten:
        argument, kind = self._single(node, env)
        if kind.lower() == "b":
            self._refuse(node, "the size of a truth value")
        return self._whole(call_of("abs", argument), kind), kind

    def _call_float(self, node: ast.Call, env: Environment) -> Rewritten:
        argument, kind = self._single(node, env)
        if kind.lower() == "b":
            self._refuse(node, "a float from a truth value")
        return call_of("float__", argument), "F" if kind.isupper() else "f"

    def _call_int(self, node: ast.Call, env: Environment) -> Rewritten:
        argument, kind = self._single(node, env)
        if kind == "F":  # beyond 64 bits it would be whatever the optimiser likes
            self._refuse(node, "a whole number from a constant")
        made = argument if kind.lower() == "i" else call_of("checked_int__", argument)
        return made, "I" if kind.isupper() else "i"

    def _call_bool(self, node: ast.Call, env: Environment) -> Rewritten:
        argument, kind = self._single(node, env)
        return call_of("bool", argument), "B" if kind.isupper() else "b"

    def _call_round(self, node: ast.Call, env: Environment) -> Rewritten:
        argument, kind = self._single(node, env)
        if kind != "f":
            self._refuse(node, "a rounded constant or whole number")
        return call_of("checked_round__", argument), "i"

    def _call_min(self, node: ast.Call, env: Environment) -> Rewritten:
        node.args, kind = self._scalars(node.args, env)
        if len(node.args) < 2 or kind.lower() == "b":
            self._refuse(node, "the least or the most of one")
        return node, kind

    _call_max = _call_min

    def _call_pow(self, node: ast.Call, env: Environment) -> Rewritten:
        if len(node.args) != 2:
            self._refuse(node, "a power")
        return self._power(ast.copy_location(ast.BinOp(node.args[0], ast.Pow(), node.args[1]), node), env)

    def _call_divmod(self, node: ast.Call, env: Environment) -> Rewritten:
        node.args, kind = self._scalars(node.args, env)
        if len(node.args) != 2 or kind.lower() == "b":
            self._refuse(node, "a quotient")
        return call_of("divided__", *node.args), (kind, kind)

    def _call_len(self, node: ast.Call, env: Environment) -> Rewritten:
        value, kind = self._read(node.args[0], env)
        if isinstance(kind, tuple):
            return ast.Constant(len(kind)), "I"
        if isinstance(kind, Array):
            return call_of("len", value), "i"
        self._refuse(node, "the length of what has none")
