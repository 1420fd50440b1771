"""Kernels that others write: the plain form computes the bits of machine code, or there is none."""

from __future__ import annotations

import importlib.util
import inspect
import math
import struct
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st

from pinjoint.systems.interpreter import NoPlainForm, in_lists
from pinjoint.systems.kinds import typed
from pinjoint.systems.machine_code import machine_code

HEAD = """
import math
import numpy as np
from math import sqrt
from numba import njit
from pinjoint.systems.kernels import compiled, part

TABLE = np.array([0.5, -1.5, 2.5])
BYTES = np.zeros(2, dtype=np.uint8)
GRID = np.arange(6.0).reshape(2, 3)
PAIR = (2, 0.5)
HALF, TWO, THIRD = 0.5, 2, np.float64(3.0)


def plain(x):
    return x


@compiled
def squared(x, scale=1.0):
    return scale * x * x


@compiled
def raised(x, exponent):
    return abs(x) ** exponent


@njit
def turned(pair, angle):
    return pair[0] * math.cos(angle) - pair[1] * math.sin(angle), pair[0] * math.sin(angle) + pair[1] * math.cos(angle)


@part()
def middle(x):
    if x > 1.0:
        return x
    return 0


def factory(factor):
    @compiled
    def made(x):
        return factor * x

    return made


tenfold = factory(10)
by_lambda = compiled(lambda x: x * HALF)
"""

NUMBERS = [
    *(
        0.0,
        -0.0,
        1.0,
        -1.0,
        2.0,
        -2.0,
        0.5,
        -0.5,
        3.0,
        1.5,
        2.5,
        -2.5,
        3.5,
        7.0,
        -7.0,
        0.1,
        123.456,
        1e16 + 2.0,
    ),
    *(1e300, -1e300, 1e-310, -1e-310, 5e-324, 1e18, 9.2e18, 9.223372036854775e18, 9.3e18, -9.3e18, 1e22),
    *(math.inf, -math.inf, math.nan, sys.float_info.max, 2.0**53, 2.0**63, -(2.0**63)),
]
WHOLE = [0, 1, -1, 2, -2, 3, 7, -7, 64, 2**31, 2**53 + 1, 2**62, 2**63 - 1, -(2**63), 3037000500]


def bits(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(bits, value))
    if isinstance(value, float):
        return "nan" if value != value else struct.pack("d", value)
    return type(value).__name__, value


def answer(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    try:
        return bits(function(*arguments))
    except (OverflowError, ValueError):
        return "not in 64 bits"
    except (ZeroDivisionError, IndexError) as error:
        return type(error).__name__


def imported(path: Path, text: str) -> Any:
    path.write_text(HEAD + text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def kernel(tmp_path: Path, body: str, arguments: str = "x, y, n, p") -> Any:
    lines = "\n".join(f"    {line}" for line in body.splitlines())
    return imported(tmp_path / "made.py", f"\n\n@compiled\ndef kernel({arguments}):\n{lines}\n").kernel


KINDS = ("f", "f", "i", ("f", "f"))

EXACT = [
    "return x ** 0.5, x ** 2.0, x ** -1.0, x ** -0.5, 2.0 ** x, 3.0 ** x, x ** 1.5, x ** 7, x ** 0, x ** HALF, x ** TWO",
    "return x ** y, abs(x) ** y, math.pow(x, y), math.pow(x, 2), math.pow(x, 0.5), pow(x, 3)",
    "return x ** (1 / 3), n ** y, raised(x, y), 10.0 ** x",
    "return x ** -1, x ** -2, x ** -3",
    "return x // y, x % y, divmod(x, y), x // 2, x % 2, 7 // y, 7.0 % y, x / y, 1 / x",
    "return n // 3, n % 3, n // -3, n % -3, 5 // n, 5 % n, n // n, divmod(n, 7), n / 3, n // 0, n % 0",
    "return n * n, n + n, -n, n * 3 - 1, n ** 3, n ** 2, abs(n), n * 1.5, n - x, n < x, n == x",
    "return int(x), round(x), math.floor(x), math.ceil(x), math.trunc(x)",
    "return int(math.sin(x) * 1e9), float(n), bool(x), int(x > 0), bool(n), float(round(x * 0.1))",
    "return min(x, y), max(x, y), min(x, 0), max(0, x), min(x, y, 0.5), max(x, y, n), min(n, 3), max(-n, n)",
    "return np.sign(x), np.abs(x), np.sqrt(x), np.minimum(x, y), np.maximum(x, 1), np.floor(x), np.ceil(x), np.trunc(x)",
    "return np.sin(x), np.arctan2(y, x), np.hypot(x, y), np.exp(x), np.log1p(x)",
    "return np.arcsinh(x), np.arccosh(x), np.arctanh(x), np.arcsin(x), np.arccos(x), np.arctan(x), np.rad2deg(x)",
    "return math.sqrt(x), sqrt(y), math.log(x), math.log2(x), math.log10(x), math.exp2(x), math.sinh(x), math.atanh(x)",
    "return math.hypot(x, y), math.atan2(x, y), math.copysign(x, y), math.degrees(x), math.isnan(x), math.isfinite(y)",
    "return -x, +x, not x, x and y, x or y, 0.0 < x < y, x if x > y else 0, (x > 0) - (x < 0), (x > 0) * y, n > x",
    "return x if x > 0 else 1, (x, 1.0) if x > y else (0, y)",
    "return squared(x), squared(x, 2), squared(scale=y, x=x), tenfold(x), by_lambda(y), tenfold(n), middle(x), -middle(0.0)",
    "a, b = turned(p, x)\nc = d = a * b\nreturn a, b, c - d, p[0], p[-1], len(p), PAIR[0] * x, PAIR[1]",
    "return TABLE[1] * x, GRID[1, 2] + y, TABLE[-1], GRID[0, -2], math.pi * x, np.e, THIRD * x, TWO // n",
    "s = 0\nfor k in range(n % 5):\n    s += x * k\nreturn s, -s",
    "s = 0\nwhile s < 10 and s == s:\n    if x > s:\n        s = s + 1.5\n        continue\n    s += 1"
    "\n    if s > 7:\n        break\nreturn s, -s",
    "s = 0\nwhile True:\n    s += 1\n    if s > 5:\n        s = y\n        break"
    "\n    if s * x > 3.0:\n        break\nreturn s * -1, 1 / s",
    "for z in p:\n    if z > x:\n        return z\nreturn 0",
    "a: float = 0\nif x > 0:\n    a = 1.0\nelif x < 0:\n    a = -1\nreturn -a, 1 / (a * y)",
    "'''Text.'''\npass\nif not x > 0.0:\n    return 0\nreturn x",
    "a = 1\nb = -a\na = 0.5\nreturn a, b // 2, b / 0",
    "i = n % 2\nreturn p[i], p[i - 1], p[-i]",
    "return n * n * n + 7 * n - 3, (n + 1) * (n - 1) // 2",
]  # fmt: skip


@pytest.mark.parametrize("body", EXACT)
def test_both_forms_give_the_same_bits(body: str, tmp_path: Path) -> None:
    made = kernel(tmp_path, body)
    plain = typed(made, KINDS).plain
    for k, x in enumerate(NUMBERS):
        for j, y in enumerate(NUMBERS):
            arguments = x, y, WHOLE[(k + j) % len(WHOLE)], (y, NUMBERS[k - j])
            found = answer(plain, arguments)
            assert found in ("not in 64 bits", answer(machine_code(made), arguments)), arguments


# --- random kernels --------------------------------------------------------------------------------

CONSTANTS = st.sampled_from(
    ["0", "1", "2", "-3", "0.5", "-0.0", "1e300", "2.5", "HALF", "TWO", "math.pi", "True"]
)
LEAVES = st.one_of(st.sampled_from(["x", "y", "n", "p[0]", "p[1]", "a", "b"]), CONSTANTS)


def compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    pairs = st.tuples(inner, inner)
    operators = st.sampled_from(["+", "-", "*", "/", "//", "%", "<", "==", ">="])
    ones = "abs sqrt(abs int(math.sin( float round math.floor( np.sign( squared middle not - bool math.exp( np.arctan("
    return st.one_of(
        st.builds(lambda ab, op: f"({ab[0]} {op} {ab[1]})", pairs, operators),
        st.builds(lambda ab, op: f"({ab[0]} {op} {ab[1]})", pairs, operators),
        st.builds(lambda f, a: f"({f}({a}){')' * f.count('(')})", st.sampled_from(ones.split()), inner),
        st.builds(lambda ab, f: f"{f}({ab[0]}, {ab[1]})", pairs, st.sampled_from(["min", "max", "math.atan2", "np.hypot"])),
        st.builds(lambda ab, c: f"({ab[0]} if {c} else {ab[1]})", pairs, inner),
        st.builds(lambda a, n: f"({a}) ** {n}", inner, st.sampled_from(["2", "3", "0.5", "-1.0", "1.5", "y", "0"])),
        st.builds(lambda ab, op: f"({ab[0]} {op} {ab[1]})", pairs, st.sampled_from(["and", "or"])),
    )  # fmt: skip


EXPRESSIONS = st.recursive(LEAVES, compound, max_leaves=8)
STATEMENTS = st.one_of(
    st.builds(lambda name, e: f"{name} = {e}", st.sampled_from("ab"), EXPRESSIONS),
    st.builds(lambda name, op, e: f"{name} {op}= {e}", st.sampled_from("ab"), st.sampled_from("+-*/"), EXPRESSIONS),
    st.builds(lambda t, e, f: f"if {t}:\n    a = {e}\nelse:\n    b = {f}", EXPRESSIONS, EXPRESSIONS, EXPRESSIONS),
    st.builds(lambda t, e: f"for k in range(3):\n    if {t}:\n        break\n    a = {e} - b * k", EXPRESSIONS, EXPRESSIONS),
    st.builds(lambda t, e: f"if {t}:\n    return {e}, 0", EXPRESSIONS, EXPRESSIONS),
)  # fmt: skip


@settings(
    max_examples=12, deadline=None, suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow]
)
@given(statements=st.lists(STATEMENTS, max_size=4), expressions=st.tuples(EXPRESSIONS, EXPRESSIONS))
def test_random_kernels_give_the_same_bits(statements: list[str], expressions: tuple[str, str]) -> None:
    body = "\n".join(["a = x", "b = 1", *statements, f"return {', '.join(expressions)}"])
    with tempfile.TemporaryDirectory() as folder:
        made = kernel(Path(folder), body)
        try:
            plain = typed(made, KINDS).plain
        except NoPlainForm:
            reject()
        for k, x in enumerate(NUMBERS):
            for j in range(4):
                y = NUMBERS[(k * 7 + j * 11) % len(NUMBERS)]
                arguments = x, y, WHOLE[(k + j) % len(WHOLE)], (y, NUMBERS[k - j])
                found = answer(plain, arguments)
                assert found in ("not in 64 bits", answer(machine_code(made), arguments)), (body, arguments)


REFUSED = [
    ("return np.where(x > 0, x, y)", "a call of 'np.where'"),
    ("return plain(x)", "a call of 'plain'"),
    ("return round(x, 2)", "the arguments of 'round'"),
    ("return x ** n", "a power"),
    ("a = 0.5\nreturn x ** a", "a power"),
    ("a = y\nif x > 0:\n    a = 0.5\nreturn abs(x) ** a", "a power"),
    ("return 8.0 ** x", "a power"),
    ("return (-2.0) ** x", "a power"),
    ("s = 0.0\nfor k in range(3):\n    s += abs(x) ** (0.5 * k)\nreturn s", "a power"),
    ("s = 0.0\nfor k in range(3):\n    s += raised(x, 0.5 * k)\nreturn s", "a power"),
    ("return raised(x, TABLE[1])", "a power"),
    ("return BYTES[0] * x", "'BYTES'"),
    ("return n < n + 1 < x", "a comparison"),
    ("return squared(**p)", "the arguments of 'squared'"),
    ("return int(1e300)", "a constant"),
    ("return 9223372036854775807 + 1", "9223372036854775808"),
    ("return 'a'", "'a'"),
    ("return x.real", "'x.real'"),
    ("return nowhere", "'nowhere'"),
    ("return p", ""),
    ("return p[2]", "an entry"),
    ("return p[x]", "an entry"),
    ("return p[:1]", "'slice'"),
    ("raise ValueError", "a statement 'raise'"),
    ("assert x > 0", "a statement 'assert'"),
    ("import json", "a statement 'import'"),
    ("try:\n    return x\nexcept: return y", "a statement 'try'"),
    ("def inner(): return x\nreturn inner()", "a statement 'functiondef'"),
    ("return (lambda: x)()", "a call"),
    ("return sum([x, y])", "a call of 'sum'"),
    ("return [z for z in p][0]", "'listcomp'"),
    ("if x > 0:\n    a = 1.0\nreturn a", "'a', which may have no value"),
    ("if x > 0:\n    return x", "results of several kinds"),
    ("a = True\nif x > 0:\n    a = 1.0\nreturn a", "several kinds"),
    ("x, y = y\nreturn x", "an assignment"),
    ("p[0] = 1.0\nreturn x", "an assignment"),
    ("for k in range(x):\n    pass\nreturn x", "a range"),
    ("for k in p:\n    pass\nelse:\n    return x\nreturn y", "an `else` of a loop"),
    ("return kernel(x, y, n, p)", "calls itself"),
    ("return squared(x, y, n)", "the arguments of 'squared'"),
    ("return -(x > 0)", "bits"),
    ("return n & 1", "'bitand'"),
    ("return x in p", "a comparison"),
    ("return 99999999999999999999", "99999"),
    ("return f'{x}'", "'joinedstr'"),
    ("return TABLE", "an array as the result"),
    ("return int", "'int'"),
]


@pytest.mark.parametrize(("body", "said"), REFUSED)
def test_what_might_differ_is_refused_by_name(body: str, said: str, tmp_path: Path) -> None:
    made = kernel(tmp_path, body)
    if not said:
        assert typed(made, KINDS).result == ("f", "f")
        return
    with pytest.raises(NoPlainForm) as caught:
        typed(made, KINDS)
    assert said in str(caught.value)


def test_python_calls_kernels_with_keywords_and_defaults(tmp_path: Path) -> None:
    squared = imported(tmp_path / "called.py", "").squared
    assert squared(3.0) == 9.0
    assert squared(scale=2.0, x=3.0) == 18.0


def test_a_file_that_was_edited_since_is_not_interpreted(tmp_path: Path) -> None:
    made = kernel(tmp_path, "return x")
    made.py_func.__code__ = made.py_func.__code__.replace(co_consts=(None, 1.0))
    with pytest.raises(NoPlainForm, match="kernel is another one by now"):
        typed(made, KINDS)


def test_kernels_of_our_own_have_kinds_too() -> None:
    """All that laws and commits are given are numbers; this is how those of mods would be interpreted."""
    from pinjoint.systems.physics import kernels

    numbers = {"rods_tension_only": "b", "particles_velocity": ("f", "f")}
    for name in ("elastic", "axial_damper", "taut_damper", "taut", "slack_branch", "slack_margin", "drag"):
        declared = getattr(kernels, name)
        kinds = [numbers.get(p, "f") for p in inspect.signature(declared.py_func).parameters]
        assert typed(declared, kinds).result in ("f", ("f", "f"))


def test_quotients_of_quotients_are_written_once(tmp_path: Path) -> None:
    """Written twice each, a line of forty of them was never done."""
    sizes = []
    for count in (4, 8, 16):
        names = [f"x{k}" for k in range(count)]
        file = tmp_path / f"quotients_{count}.py"
        file.write_text(f"def quotients({', '.join(names)}):\n    return {' / '.join(names)}\n")
        scope: dict[str, Any] = {}
        exec(compile(file.read_text(), str(file), "exec"), scope)
        plain = in_lists(scope["quotients"])
        assert plain(*[2.0] * count) == 2.0 ** (2 - count)
        assert plain(1.0, *[0.0] * (count - 1)) == math.inf
        sizes.append(len(plain.__code__.co_code))  # type: ignore[attr-defined]
    assert sizes[2] - sizes[1] < 3 * (sizes[1] - sizes[0])
