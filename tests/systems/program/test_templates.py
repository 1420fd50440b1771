"""Templates of step programs: what stands for what, and how it is put in."""

import ast
import re
from enum import IntEnum

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.systems.base import StopReason
from pinjoint.systems.program.binding import StepRole, bind, by_role
from pinjoint.systems.program.entries import ACCOUNTS, Account, Control, Mark, Measure, Search, Side
from pinjoint.systems.program.identity import meaning_of
from pinjoint.systems.program.kernel import part
from pinjoint.systems.program.pasting import expanded, fragment, pasted
from pinjoint.systems.program.program import _writer
from pinjoint.systems.program.writer import FEW, MANY, VERY_MANY

# mypy: ignore-errors
# ruff: noqa: F821, F841, SIM108


def template(time, state, *columns):
    """Of a state, and *all* of it."""
    insert(lines)
    total = insert(what) * 2.0
    other(time, *state, *columns)


def nothing():
    """To do."""


def choosing():
    """A choice in another."""
    if OUTER:
        first = 1
        if INNER:
            second = 2
        else:
            second = 3
    if first:
        last = 4


def test_a_template_is_pasted_with_lines_expressions_and_groups() -> None:
    source = pasted(template, "compiled", "step", lines=["for i in range(3):", "    a = i"], what="b[0]")
    assert expanded(source, {"state": ("x", "v"), "columns": ("mass",)}).splitlines() == [
        "@compiled",
        "def step(time, x, v, mass):",
        '    """Of a state, and *all* of it."""',
        "    for i in range(3):",
        "        a = i",
        "    total = b[0] * 2.0",
        "    other(time, x, v, mass)",
    ]


def test_a_fragment_is_what_follows_the_docstring() -> None:
    assert fragment(template, lines=[], what="1")[0] == "total = 1 * 2.0"
    assert fragment(nothing) == []


def test_of_a_choice_the_lines_that_are_wanted_stay() -> None:
    last = ["if first:", "    last = 4"]
    assert fragment(choosing, OUTER=True, INNER=True) == ["first = 1", "second = 2", *last]
    assert fragment(choosing, OUTER=True, INNER=False) == ["first = 1", "second = 3", *last]
    assert fragment(choosing, OUTER=False, INNER=True) == last


@pytest.mark.parametrize("form", [FEW, MANY, VERY_MANY])
@pytest.mark.parametrize("integrator", ["velocity_verlet", "dop853", "esdirk4"])
def test_nothing_of_a_template_is_left_in_a_program(integrator: str, form: str) -> None:
    session = Session.open("hyperstatic_yield")
    session.settings.integrator = integrator
    simulation = session.simulation
    writer = _writer(session.model, simulation.program.plan, simulation.integrator, form)
    tree = ast.parse(writer.source())
    assert not any(isinstance(node, ast.Starred) for node in ast.walk(tree))
    assert not any(isinstance(node, ast.Name) and node.id == "insert" for node in ast.walk(tree))
    assert not re.search(r"\b(ALIKE|BENDS|DAMPED|FORESEES|LOADED|MEETS|OF_AXIS|WARM)\b", writer.source())
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert functions[0].name == "advance"
    assert {"observe", "commit"} <= {function.name for function in functions}


def test_roles_follow_each_other_as_in_a_step() -> None:
    session = Session.open("hyperstatic_yield")
    plan = session.simulation.program.plan
    roles = by_role(bind(system, session.model) for system in reversed(plan))
    found = [b.system.name for some in roles.values() for b in some]
    assert found == [
        "loads.ramp",
        "plasticity.yielding",
        "physics.elasticity_after_yielding",
        "plasticity.strength",
        "plasticity.first_yield",
        "physics.axial_damping",
    ]
    assert [b.role for some in roles.values() for b in some] == [
        StepRole.LOAD,
        StepRole.HISTORY,
        StepRole.SUMMED,
        StepRole.REPLACING,
        StepRole.LATE_HISTORY,
        StepRole.RATE,
    ]


def test_a_program_is_compiled_anew_when_an_entry_moves() -> None:
    class Moved(IntEnum):
        WORK = 1

    class Stayed(IntEnum):
        WORK = 0

    Moved.__name__ = Stayed.__name__ = "Account"
    assert meaning_of([Moved]) != meaning_of([Stayed])


def test_a_program_is_compiled_anew_when_a_number_of_a_long_table_changes() -> None:
    """Also of one within a tuple, of which numpy would say the first and the last numbers only."""

    def reading(tables) -> str:
        @part()
        def read(row: int) -> float:
            return float(tables[1][0][row])

        return meaning_of([read])

    table = np.zeros(5000)
    changed = table.copy()
    changed[2500] = 1.0
    assert reading((table, (table,))) == reading((table.copy(), (table,)))
    assert reading((table, (table,))) != reading((table, (changed,)))


def test_entries_are_numbered_without_gaps() -> None:
    for entries in (Account, Control, Mark, Measure, Search, Side, StopReason):
        assert [int(entry) for entry in entries] == list(range(len(entries)))
    assert ACCOUNTS == ("work", "dissipated_damping", "dissipated_plastic", "dissipated_impact")
    for name in (
        "KINETIC",
        "POWER_NORM",
        "ELASTIC",
        "POTENTIAL",
        "RESIDUAL",
        "LARGEST_FORCE",
        "ROUND_OFF",
        "POWER",
    ):
        assert Measure[f"ASLEEP_{name}"] == Measure[name] + len(Measure) // 2
