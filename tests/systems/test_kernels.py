"""Parts: kernels that only other kernels call."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numba import njit

import pinjoint.systems.program.machine_code  # noqa: F401 - by which numba knows kernels
from pinjoint.systems.plasticity.hinges import slips
from pinjoint.systems.program.compiler import GeneratedModule
from pinjoint.systems.program.interpreter import in_lists
from pinjoint.systems.program.kernel import part


@part()
def double(x):  # type: ignore[no-untyped-def]
    return x + x


@part()
def sum_of_doubles(values):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(values.shape[0]):
        total += double(values[i])
    return total


@njit(error_model="numpy")
def entry(values):  # type: ignore[no-untyped-def]
    return sum_of_doubles(values) + double(1.5) + double(2) + double(values.shape[0])


def test_a_part_of_a_part_computes_what_python_does() -> None:
    assert entry(np.array([0.25, 3.0])) == 6.5 + 3.0 + 4 + 4


def test_constants_make_no_version_of_a_part_of_their_own() -> None:
    entry(np.ones(2))
    assert sorted(str(kind) for (kind,) in double.machine_part.overloads) == ["float64", "int64"]


def test_a_part_is_interpreted_where_python_calls_it() -> None:
    assert double(1.5) == 3.0
    assert sum_of_doubles(np.array([0.25, 3.0])) == 6.5


SUMS = """
import numpy as np
from pinjoint.systems.program.kernel import kept, prange, shared

@kept()
def summed(moments, stiffness, bowing):
    total = 0.0
    for i in range(moments.shape[0]):
        {}
    return total

@shared
def fill(moments, stiffness, bowing, totals):
    for i in prange(moments.shape[0]):
        total = 0.0
        {}
        totals[i] = total

@kept()
def filled(moments, stiffness, bowing):
    totals = np.zeros(moments.shape[0])
    fill(moments, stiffness, bowing, totals)
    return totals.sum()
"""


def test_no_program_calls_what_another_one_made_of_the_same_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The optimiser changes how parts of an entry are called; what was linked later called them by their names."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    moments = np.linspace(-5.0, 7.0, 48).reshape(-1, 2)
    given = moments, np.array([4.0, 2.0, 4.0]), np.array([0.1, -0.02, 0.1])
    call = "total += slips(moments[i, {}], moments[i, {}], 1.0, 2.0, {}, stiffness, bowing)[0]"
    lines = "\n        ".join(call.format(i % 2, 1 - i % 2, float(i)) for i in range(8))
    module = GeneratedModule("sums", lambda: (SUMS.format(lines, lines), {"slips": slips}))
    interpreted = module.functions["summed"].py_func(*given)
    machine = module.load()
    assert machine.summed(*given) == pytest.approx(interpreted, rel=1e-14)
    assert machine.filled(*given) == pytest.approx(interpreted, rel=1e-14)


DIGEST = """
from pinjoint import Session
from pinjoint.systems.program.kernel import PLAIN
from tests.reference import bits

session = Session.open("isostatic")
session.settings.integrator = "velocity_verlet"
session.run(steps=40)
print(PLAIN, bits.digest(session.model), session.simulation.program.module.key)
"""


def test_plain_numba_computes_the_same_bits(fresh_process: Callable[..., str]) -> None:
    """And its programs go by other names, so that neither way takes what the other one cached."""
    plain, own = (
        fresh_process(DIGEST, {"PINJOINT_PLAIN_NUMBA": switch, "PINJOINT_COMPILE": "always"}).split()
        for switch in ("1", "")
    )
    assert (plain[0], own[0]) == ("True", "False")
    assert plain[1] == own[1]
    assert plain[2] != own[2]


@part()
def quotients(x, y):
    return x / y / (y * y) / (y + y) / (y * y) / (y - x) / (y + x) / (y * y) / y / (x * y) / (y + y) / (x * x)


def test_a_quotient_of_quotients_grows_with_each_once() -> None:
    """Written into both branches of what looks for a divisor of 0, each doubled all that came before."""
    assert len(in_lists(quotients).__code__.co_code) < 2000
    assert quotients(3.0, 7.0) == quotients.py_func(3.0, 7.0)
    assert math.isnan(quotients(0.0, 0.0))


KEPT = """
import sys
from pinjoint.systems.program import interpreter

definition, anew = interpreter._definition, []
interpreter._definition = lambda plain, source: anew.append(plain.__name__) or definition(plain, source)
sys.path.insert(0, {folder!r})
import scaled
print(scaled.grown(2.0), scaled.roots(-1.0), *anew)
interpreter.keep_rewritten()
"""
SCALED = """
import math
from pinjoint.systems.program.kernel import compiled

{constant}

@compiled
def grown(x):
    return FACTOR * x

@compiled
def roots(x):
    return math.sqrt(x)
"""


def test_what_is_rewritten_is_kept_until_it_or_a_constant_in_it_changes(
    tmp_path: Path, fresh_process: Callable[..., str]
) -> None:
    def printed(constant: str, factor: float = 3.0) -> str:
        (tmp_path / "scaled.py").write_text(SCALED.format(constant=constant))
        (tmp_path / "factors.py").write_text(f"FACTOR = {factor}")
        return fresh_process(KEPT.format(folder=str(tmp_path)), {"XDG_CACHE_HOME": str(tmp_path)}).strip()

    assert printed("FACTOR = 2.0") == "4.0 nan grown roots"
    assert printed("FACTOR = 2.0") == "4.0 nan"
    assert printed("from factors import FACTOR") == "6.0 nan grown roots"
    assert printed("from factors import FACTOR", 50.0) == "100.0 nan grown"
    assert printed("from factors import FACTOR", 50.0) == "100.0 nan"
