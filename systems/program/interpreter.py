"""The plain form of kernels: Python that computes the same bits as their machine code, without a compiler.

A kernel's source is rewritten, function by function, with all that it calls. Arrays become nested lists, which Python
reads five times as fast, when a kernel is entered, and are put back when it returns. What differs from the arithmetic
of machine code is replaced:

    x / 0                 is infinite or not a number, and raises nothing; so with roots, powers, sines, …
    x ** 2                is x * x
    math.hypot            is that of the C library
    a[i, j]               is a[i][j], and a.shape[0] is len(a)
    Enum.MEMBER, CONSTANT are the numbers that they stand for

That is all that Pinjoint's own kernels need. Kernels of mods are interpreted only where nothing may be compiled, by the
same rules, which do not cover all that numba does: whole numbers beyond 64 bits, other whole exponents, functions that
overflow, arrays that are filled as a whole, or two kinds of numbers in one name may give other bits then, or an error.
"""

from __future__ import annotations

import ast
import copy
import hashlib
import inspect
import linecache
import marshal
import math
import sys
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from enum import IntEnum
from itertools import count
from operator import attrgetter
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from pinjoint.systems import is_ours
from pinjoint.systems.program import cache

Interpreted = Callable[..., Any]


class NoPlainForm(Exception):
    """A kernel that cannot be interpreted, as its source is not known; the message says so, without a full stop."""


# --- arithmetic ------------------------------------------------------------------------------------

_NAN, _INFINITE = math.nan, math.inf
_LEAST, _MOST = -(2**63), 2.0**63  # whole numbers of machine code: from, and less than


def _quotient(x: float, y: float) -> float:
    """x / y where y is 0."""
    if x == 0.0 or x != x:
        return _NAN
    return math.copysign(_INFINITE, x) * math.copysign(1.0, y)


def _power(x: float, y: float) -> float:
    """pow() of the C library."""
    try:
        return math.pow(x, y)
    except OverflowError:
        return -_INFINITE if x < 0.0 and y % 2.0 == 1.0 else _INFINITE
    except ValueError:
        if x == 0.0:
            return math.copysign(_INFINITE, x) if y % 2.0 == 1.0 else _INFINITE
        return _NAN


def _hypot(x: float, y: float) -> float:
    """hypot() of the C library, by which Python takes the magnitude of complex numbers; its own differs in last bits."""
    try:
        return abs(complex(x, y))
    except OverflowError:  # which Python also raises for what is no number, after another function overflowed
        return _INFINITE if x == x and y == y else _NAN


def _quiet(function: Callable[..., float]) -> Callable[..., float]:
    """A function of the C library that raises nothing."""

    def computed(*given: float) -> float:
        try:
            return function(*given)
        except ValueError:
            return _NAN
        except OverflowError:
            return math.copysign(_INFINITE, given[0])

    return computed


def _whole(rounding: Callable[[float], int]) -> Callable[[float], int]:
    """A whole number, as machine code converts it: the least one for what has none."""

    def converted(x: float) -> int:
        return rounding(x) if -_MOST < x < _MOST else _LEAST

    return converted


def _sum(rows: list[Any], column: int) -> float:
    total = 0.0
    for row in rows:
        total += row[column]
    return total


_AS_COMPILED: dict[str, Any] = {
    "hypot": _hypot,
    "pow": _power,
    "floor": _whole(math.floor),
    "ceil": _whole(math.ceil),
    "int64": int,
}


# --- rewriting -------------------------------------------------------------------------------------


class _Part:
    """A slice of a list, which like that of an array shares its entries."""

    def __init__(self, whole: Any, start: int | None, stop: int | None) -> None:
        self._whole = whole
        self._start, self._stop, _ = slice(start, stop).indices(len(whole))

    def __len__(self) -> int:
        return max(self._stop - self._start, 0)

    def __getitem__(self, k: int) -> Any:
        return self._whole[self._start + k]

    def __setitem__(self, k: int, value: Any) -> None:
        self._whole[self._start + k] = value


_HELPERS = {
    "quotient__": _quotient,
    "power__": _power,
    "root__": math.sqrt,
    "floor__": math.floor,
    "whole__": _whole(int),
    "part__": _Part,
    "sum__": _sum,
}


_Path = tuple[str, ...]  # a name from outside, and those of attributes


def _found(outside: Mapping[str, Any], path: _Path) -> Any:
    """What a path leads to, through modules and enumerations; None if nowhere."""
    value = outside.get(path[0]) if path else None
    for name in path[1:]:
        through = isinstance(value, ModuleType) or (isinstance(value, type) and issubclass(value, IntEnum))
        value = getattr(value, name, None) if through else None
    return value


def _mark(value: Any) -> str:
    """What rewriting heeds of something from outside: a number itself, of others what they are called."""
    number = isinstance(value, int | float | np.generic)
    return repr(value) if number else getattr(value, "__name__", type(value).__name__)


def _as_compiled(outside: Mapping[str, Any], path: _Path) -> Any:
    """What a path leads to, in the arithmetic of machine code."""
    value, name = _found(outside, path), path[-1]
    if _found(outside, path[:-1]) not in (math, np):
        return value
    return _AS_COMPILED.get(name, _quiet(getattr(math, name)) if hasattr(math, name) else value)


class _Rewriting(ast.NodeTransformer):
    """Rewrites one function. `outside` looks up the names that it takes from outside."""

    def __init__(self, outside: Mapping[str, Any], own: set[str]) -> None:
        self.taken: dict[str, _Path] = {}  # what the rewritten function takes from outside, by new names
        self.seen: dict[_Path, str] = {}  # what all that was looked up was
        self._outside = outside
        self._own = own
        self._temporaries = count()

    # names and constants

    def _value(self, node: ast.AST) -> Any:
        """What a name from outside, or an attribute of one, is; None for everything else."""
        path = self._path(node)
        value = _found(self._outside, path)
        if path:
            self.seen[path] = _mark(value)
        return value

    def _path(self, node: ast.AST) -> _Path:
        if isinstance(node, ast.Name):
            return () if node.id in self._own else (node.id,)
        path = self._path(node.value) if isinstance(node, ast.Attribute) else ()
        return (*path, node.attr) if path and isinstance(node, ast.Attribute) else ()

    def _known(self, node: ast.Name | ast.Attribute) -> ast.expr | None:
        value = self._value(node)
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, bool | int | float):
            return ast.copy_location(ast.Constant(int(value) if isinstance(value, IntEnum) else value), node)
        return None

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if not isinstance(node.ctx, ast.Load) or node.id in self._own:
            return node
        known = self._known(node)
        if known is None and node.id in self._outside:
            self.taken[node.id] = (node.id,)
        return known or node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        known = self._known(node)
        if known is not None:
            return known
        owner = self._value(node.value)
        if isinstance(owner, ModuleType):
            name = f"{owner.__name__.replace('.', '_')}_{node.attr}__"
            self.taken[name] = self._path(node)
            return ast.copy_location(ast.Name(name, ast.Load()), node)
        self.generic_visit(node)
        return node.value if node.attr == "value" else node  # of an enumeration, which is a number here

    # arithmetic

    def _twice(self, node: ast.expr) -> tuple[ast.expr, ast.expr]:
        """A value that is used twice: an expression that computes it, and one for the second use."""
        if isinstance(node, ast.Name | ast.Constant):
            return node, node
        name = f"t{next(self._temporaries)}__"  # names that end like this are found in no kernel
        return ast.NamedExpr(ast.Name(name, ast.Store()), node), ast.Name(name, ast.Load())

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.op, ast.Div):
            return self._divided(node)
        return self._raised(node) if isinstance(node.op, ast.Pow) else node

    def _divided(self, node: ast.BinOp) -> ast.expr:
        if isinstance(node.right, ast.Constant) and node.right.value != 0:
            return node
        (early, a), (first, b) = self._twice(node.left), self._twice(node.right)
        # found before, once: written twice, a quotient of quotients doubles with each of them
        if early is not a:
            first = ast.BoolOp(ast.Or(), [ast.Compare(early, [ast.Is()], [ast.Constant(None)]), first])
        return ast.copy_location(
            ast.IfExp(first, ast.BinOp(a, ast.Div(), b), _call_of("quotient__", a, b)), node
        )

    def _raised(self, node: ast.BinOp) -> ast.expr:
        exponent = _literal(node.right)
        if exponent == 2:
            first, second = self._twice(node.left)
            return ast.copy_location(ast.BinOp(first, ast.Mult(), second), node)
        if isinstance(exponent, int):
            return node
        return ast.copy_location(_call_of("power__", node.left, node.right), node)

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.stmt:
        if not isinstance(node.op, ast.Div | ast.Pow):
            self.generic_visit(node)
            return node
        read = copy.deepcopy(node.target)
        read.ctx = ast.Load()
        assigned = ast.Assign([node.target], ast.BinOp(read, node.op, node.value))
        return self.visit(ast.fix_missing_locations(ast.copy_location(assigned, node)))

    def visit_Call(self, node: ast.Call) -> ast.expr:
        called = self._value(node.func)
        if called is math.sqrt or called is np.sqrt:
            first, second = self._twice(self.visit(node.args[0]))
            possible = ast.Compare(first, [ast.GtE()], [ast.Constant(0.0)])
            computed = ast.IfExp(possible, _call_of("root__", second), ast.Constant(_NAN))
            return ast.copy_location(computed, node)
        if called is math.floor and len(node.args) == 1:
            return self._floor(node)
        name = node.func.id if isinstance(node.func, ast.Name) and node.func.id not in self._outside else ""
        if name in ("min", "max") and len(node.args) == 2:
            return self._least_or_most(node, ast.Lt() if name == "min" else ast.Gt())
        if isinstance(node.func, ast.Attribute) and node.func.attr == "sum":
            column = node.func.value  # a[:, k]
            if isinstance(column, ast.Subscript) and isinstance(column.slice, ast.Tuple):
                rows, place = self.visit(column.value), self.visit(column.slice.elts[1])
                return ast.copy_location(_call_of("sum__", rows, place), node)
        self.generic_visit(node)
        if name == "int" and len(node.args) == 1:
            node.func = ast.Name("whole__", ast.Load())
        return node

    def _floor(self, node: ast.Call) -> ast.expr:
        """As _whole(), without a call."""
        first, second = self._twice(self.visit(node.args[0]))
        within = ast.Compare(ast.Constant(-_MOST), [ast.Lt(), ast.Lt()], [first, ast.Constant(_MOST)])
        return ast.copy_location(ast.IfExp(within, _call_of("floor__", second), ast.Constant(_LEAST)), node)

    def _least_or_most(self, node: ast.Call, better: ast.cmpop) -> ast.expr:
        """The second argument where it is better, else the first; numbers that are none never are."""
        (early, a), (first, b) = (self._twice(self.visit(argument)) for argument in node.args)
        return ast.copy_location(ast.IfExp(ast.Compare(first, [better], [early]), b, a), node)

    # arrays, which are lists

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            depth = _literal(node.slice)
            if isinstance(depth, int):
                row = self.visit(node.value.value)
                for _ in range(depth):
                    row = ast.Subscript(row, ast.Constant(0), ast.Load())
                return ast.copy_location(_call_of("len", row), node)
        if isinstance(node.slice, ast.Slice):
            self.generic_visit(node)
            ends = [part or ast.Constant(None) for part in (node.slice.lower, node.slice.upper)]
            return ast.copy_location(_call_of("part__", node.value, *ends), node)
        if isinstance(node.slice, ast.Tuple):
            *outer, last = (self.visit(index) for index in node.slice.elts)
            row = self.visit(node.value)
            for index in outer:
                row = ast.Subscript(row, index, ast.Load())
            return ast.copy_location(ast.Subscript(row, last, node.ctx), node)
        self.generic_visit(node)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.decorator_list, node.returns = [], None
        node.args.defaults = []  # they are taken from the function itself
        for argument in (*node.args.posonlyargs, *node.args.args):
            argument.annotation = None
        node.body = [self.visit(statement) for statement in node.body]
        return node


def _literal(node: ast.expr) -> Any:
    """The number, or another constant, that an expression is; None if it is none."""
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = _literal(node.operand)
        return -value if isinstance(value, int | float) else None
    return None


def _call_of(name: str, *arguments: ast.expr) -> ast.Call:
    """The call of a function by name."""
    return ast.Call(ast.Name(name, ast.Load()), list(arguments), [])


# --- functions -------------------------------------------------------------------------------------


def plain_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """What a kernel, or a function that numba's own decorators made, was declared as; other functions as they are."""
    return getattr(function, "py_func", function)


class Rewriting:
    """seconds: processor time that rewriting took while kernels were called, which is no time of theirs."""

    seconds = 0.0


_rewritten: dict[Any, Interpreted] = {}  # by the function that was declared
_rewriting = threading.RLock()


def in_lists(function: Callable[..., Any]) -> Interpreted:
    """A kernel, and all that it calls, rewritten: it takes nested lists in place of arrays.

    Raises NoPlainForm where its source is not known.
    """
    plain = plain_function(function)
    if plain not in _rewritten:
        _rewritten[plain] = _rewritten_in_lists(plain)
    return _rewritten[plain]


def rewrite(functions: Iterable[Callable[..., Any]]) -> None:
    """Rewrite kernels before they are called, as a thread does while nothing else is to be done."""
    for function in functions:
        if isinstance(plain_function(function), FunctionType):
            with _rewriting:
                in_lists(function)


def keep_rewritten() -> None:
    """Keep on disk what was rewritten since the last call, as a thread does from time to time."""
    with _rewriting:
        written = {source.kept: marshal.dumps(source.forms) for source in _sources.values() if source.changed}
        for source in _sources.values():
            source.changed = False
    for name, content in written.items():
        cache.write(name, content)


_Form = tuple[
    CodeType, dict[str, _Path], dict[_Path, str]
]  # rewritten; what it takes from outside, and what was seen


class _Source:
    """A file as it was read: which of its functions are rewritten, in this process or, `kept` in the cache, before.

    forms: by line and name. changed: there are more than are kept. left: definitions that are not rewritten, by line.
    """

    def __init__(self, file: str, lines: list[str]) -> None:
        self.lines = lines
        about = "".join([sys.version, file, *linecache.getlines(__file__), *lines]).encode()
        self.kept = f"pinjoint_program_{hashlib.sha256(about).hexdigest()[:24]}.plain"
        self.forms: dict[tuple[int, str], _Form] = marshal.loads(cache.read(self.kept) or marshal.dumps({}))
        self.changed = False
        self.left: dict[int, list[_Defined]] = {}


_sources: dict[str, _Source] = {}


def _source(file: str) -> _Source:
    """Raises NoPlainForm."""
    linecache.checkcache(file)
    lines = linecache.getlines(file)
    if not lines:
        raise NoPlainForm(f"there is no source of {file}")
    if file not in _sources or _sources[file].lines is not lines:
        _sources[file] = _Source(file, lines)
    return _sources[file]


def _rewritten_in_lists(plain: Any) -> Interpreted:
    code, outside = plain.__code__, plain.__globals__
    source, place = _source(code.co_filename), (code.co_firstlineno, code.co_name)
    if plain.__closure__:
        outside = outside | inspect.getclosurevars(plain).nonlocals
    form = source.forms.get(place)
    if form is None or any(_mark(_found(outside, path)) != mark for path, mark in form[2].items()):
        form = _rewritten_form(plain, source, outside)
        if place[1] != "<lambda>":  # of which there may be several on a line
            source.forms[place], source.changed = form, True
    scope: dict[str, Any] = dict(_HELPERS)
    exec(form[0], scope)
    made: Any = scope[form[0].co_names[-1]]
    for name, path in form[1].items():
        scope[name] = _in_scope(_as_compiled(outside, path), name, scope)
    made.__defaults__ = plain.__defaults__
    return made


def _rewritten_form(plain: Any, source: _Source, outside: Mapping[str, Any]) -> _Form:
    code, node = plain.__code__, _definition(plain, source)
    rewriting = _Rewriting(outside, {*code.co_varnames, *code.co_cellvars})
    module = ast.Module([ast.fix_missing_locations(rewriting.visit(node))], [])
    return compile(module, code.co_filename, "exec"), rewriting.taken, rewriting.seen


def _in_scope(value: Any, name: str, scope: dict[str, Any]) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if not hasattr(value, "py_func"):
        return value
    plain = value.py_func
    # of others it has to be seen whether there is source
    surely = is_ours(plain.__module__) and plain not in _rewritten
    return _when_called(value, name, scope) if surely else in_lists(value)


def _when_called(function: Callable[..., Any], name: str, scope: dict[str, Any]) -> Interpreted:
    """What rewrites a kernel when it is called first, and stands for it in this scope until then: most never are."""

    def first_call(*given: Any, **named: Any) -> Any:
        began = time.thread_time()
        with _rewriting:
            scope[name] = in_lists(function)
        Rewriting.seconds += time.thread_time() - began
        return scope[name](*given, **named)

    return first_call


_Defined = ast.FunctionDef | ast.Lambda


def _definitions(
    file: str, source: _Source, nodes: Callable[[ast.Module], Iterable[ast.AST]]
) -> dict[int, list[_Defined]]:
    """The functions among nodes of a file, by the line on which they, or their decorators, begin."""
    found: dict[int, list[_Defined]] = {}
    try:
        parsed = ast.parse("".join(source.lines))
    except SyntaxError as error:  # it is another text, such as a page with the function in it
        raise NoPlainForm(f"{file} is no source: {error}") from error
    for node in nodes(parsed):
        if isinstance(node, _Defined):
            decorators = node.decorator_list if isinstance(node, ast.FunctionDef) else []
            found.setdefault(min(n.lineno for n in (node, *decorators)), []).append(node)
    return found


def _definition(plain: Any, source: _Source) -> ast.FunctionDef:
    """The definition of a function, to be changed: one that was changed before is read again."""
    code, file = plain.__code__, plain.__code__.co_filename
    at_top = attrgetter("body")  # where most kernels are; to look through all takes ten times as long
    for nodes in (None, at_top, ast.walk):
        if nodes is not None:
            source.left = _definitions(file, source, nodes)
        there = source.left.get(code.co_firstlineno, [])
        for node in [node for node in there if _compiles_to(code, node)][:1]:
            there.remove(node)
            if isinstance(node, ast.FunctionDef):
                return node
            body: list[ast.stmt] = [ast.Return(node.body)]
            return ast.copy_location(ast.FunctionDef("lambda__", node.args, body, []), node)
    raise NoPlainForm(f"there is no source of {plain.__qualname__} in {file}")


def _compiles_to(code: CodeType, node: _Defined) -> bool:
    """True if this is the function, of several on one line."""
    if not isinstance(node, ast.Lambda):
        return node.name == code.co_name
    body = node.body
    place = body.lineno, body.end_lineno, body.col_offset, body.end_col_offset
    return code.co_name == "<lambda>" and place in code.co_positions()


# --- arrays in, arrays out -------------------------------------------------------------------------


def interpreted(function: Callable[..., Any]) -> Interpreted:
    """A kernel as Python calls it: with arrays, or named tuples of arrays, of which it may change the entries."""
    with _rewriting:
        rewritten = in_lists(function)

    def called(*given: Any, **named: Any) -> Any:
        lists: dict[int, tuple[Any, Any]] = {}
        try:
            by_name = {name: _listed(argument, lists) for name, argument in named.items()}
            return rewritten(*[_listed(argument, lists) for argument in given], **by_name)
        finally:
            for array, values in lists.values():
                if array.flags.writeable and array.size:
                    array[...] = values

    return called


def _listed(argument: Any, lists: dict[int, tuple[Any, Any]]) -> Any:
    if isinstance(argument, np.ndarray):
        if id(argument) not in lists:
            lists[id(argument)] = argument, argument.tolist()
        return lists[id(argument)][1]
    if isinstance(argument, tuple):
        entries = [_listed(entry, lists) for entry in argument]
        return type(argument)(*entries) if hasattr(argument, "_fields") else tuple(entries)
    return argument.item() if isinstance(argument, np.generic) else argument
