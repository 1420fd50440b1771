"""Laws of mods: they are compiled before the first step, else interpreted; faults are told alike in both forms."""

import sys
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.systems.program import cache, compiler
from pinjoint.systems.program.compiler import Choice, Compile
from tests.mods.conftest import Write
from tests.mods.test_isolation import TRUSS

LAW = """
import math
import numpy as np
from pinjoint.api import Law, compiled
from numba import njit

{kernel}

class Force(Law):
    name = "apple.force"
    each = "particles"
    kernel = force
    reads = ("particles.position", "particles.displacement", "particles.velocity", "particles.mass")

    def arrays(self, model):
        return {arrays}

def plugin(app):
    app.system(Force)
"""


@pytest.fixture
def opened(write_mod: Write, monkeypatch: pytest.MonkeyPatch) -> Any:
    def opened_in(form: Compile, kernel: str, arrays: str = "{}") -> Session:
        monkeypatch.setattr(Choice, "compile", form)
        return Session.open(TRUSS, mods=[write_mod("apple", LAW.format(kernel=kernel, arrays=arrays))])

    return opened_in


def is_interpreted(session: Session) -> bool:
    return not session.simulation.programs.compiled.module.is_loaded


INTERPRETED = """
def factory(k):
    @njit
    def made(velocity):
        return -k * velocity[0]
    return made

drag, half = factory(0.5), compiled(lambda x: 0.5 * x)

@compiled
def size(x, scale=2):
    return abs(x) ** 1.5 * scale

class Forces:
    @compiled
    def push(particles_mass, particles_velocity, particles_displacement, dt):
        s = 0
        for part in particles_displacement:
            s += size(scale=half(part), x=part)
        return drag(particles_velocity) + s, -0.1 * particles_mass ** 0.5 + dt // 1

force = Forces.push
"""


def test_both_forms_give_the_same_bits(opened: Any) -> None:
    """Kernels made by factories, in classes, of lambdas; called with keywords and defaults."""
    session = opened(Compile.NEVER, INTERPRETED)
    session.run(steps=30)
    assert is_interpreted(session)
    before = session.particles.displacement.tobytes()
    session.undo()
    session.simulation.programs.compiled.module.load()
    session.run(steps=30)
    assert not is_interpreted(session)
    assert session.particles.displacement.tobytes() == before


COMPILED = [
    "exec('def plain(particles_mass): return 0.1, 0.0')\nforce = compiled(plain)",
    "@njit(fastmath=True)\ndef force(particles_mass):\n    return 0.1, 0.0",
    "@compiled\ndef force(particles_mass):\n    return 0.1, 0.0",
]


@pytest.mark.parametrize("kernel", COMPILED)
def test_a_law_waits_until_it_is_compiled(opened: Any, kernel: str) -> None:
    session = opened(Compile.SOON, kernel)
    assert session.run(steps=5) == "time reached"
    assert not is_interpreted(session)
    assert not cache.SAID


@pytest.mark.parametrize("kernel", COMPILED[1:])
def test_without_a_compiler_it_is_interpreted(opened: Any, kernel: str) -> None:
    session = opened(Compile.NEVER, kernel)
    assert session.run(steps=5) == "time reached"
    assert is_interpreted(session)
    assert (session.particles.velocity[2] > 0.0).any()


def test_without_a_compiler_a_kernel_without_source_is_named(opened: Any) -> None:
    session = opened(Compile.NEVER, COMPILED[0])
    with pytest.raises(mods.ModError, match=r"The kernel of apple\.force cannot be interpreted: ") as caught:
        session.run(steps=5)
    assert "there is no source" in str(caught.value)
    assert "PINJOINT_COMPILE=never" in str(caught.value)
    assert session.run(steps=5) == "time reached"


def test_where_the_compiler_is_damaged_a_law_is_interpreted_and_that_is_told(
    opened: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = opened(Compile.SOON, COMPILED[-1])
    monkeypatch.setitem(sys.modules, "pinjoint.systems.program.machine_code", None)
    monkeypatch.setattr(compiler, "_modules", {})
    monkeypatch.setattr(cache, "SAID", told := [])
    assert session.run(steps=5) == "time reached"
    assert is_interpreted(session)
    assert "cannot be got ready, so it runs in its slow form" in told[0]


FAULTS = [
    ("return particles_displacement[0] - particles_displacement[0], particles_mass, 0.0", "failed: ValueError: too many"),
    ("return particles_displacement", ""),
    ("return (0.0 * particles_mass) ** -2, 0.0", "failed: ZeroDivisionError"),
    ("return particles_displacement[int(particles_mass) + 5], 0.0", "failed: IndexError: tuple index out of range"),
    ("if particles_displacement[0] > 1e-7:\n        raise ValueError('x')\n    return 0.0, 0.0", "failed: ValueError: x"),
    ("assert particles_displacement[0] < 1e-7, 'too far'\n    return 0.0, 0.0", "failed: AssertionError: too far"),
    ("return (0.5e-7 - particles_displacement[0]) ** 0.5, 0.0", "Without apple.force the steps lead on"),
    ("return 0.1 / (particles_mass - particles_mass), 0.0", "Without apple.force the steps lead on"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("form", "body", "said"),
    [
        *((Compile.NEVER, *fault) for fault in FAULTS),
        *((Compile.SOON, *fault) for fault in FAULTS if "raise" in fault[0]),
        *((Compile.ALWAYS, *fault) for fault in FAULTS if "**" in fault[0]),
    ],
)
def test_faults_are_told_alike(opened: Any, form: Compile, body: str, said: str) -> None:
    kernel = f"@compiled\ndef force(particles_displacement, particles_mass):\n    {body}"
    session = opened(form, kernel)
    if not said:
        assert session.run(steps=5) == "time reached"
        return
    with pytest.raises(mods.ModError, match="The mod 'apple' was switched off: ") as caught:
        session.run(steps=200)
    assert said in str(caught.value)
    assert "apple" in str(caught.value)
    assert session.run(steps=5) == "time reached"


def test_arrays_of_another_type_are_heeded(opened: Any) -> None:
    kernel = "@compiled\ndef force(power):\n    return 0.001 * power, 0.0"
    arrays = "{'power': np.ones(3, dtype=float if model.particles.mass[2] == 2.5 else int)}"
    session = opened(Compile.SOON, kernel, arrays)
    session.run(steps=5)
    before = session.particles.velocity[2, 0]
    session.particles["C"].mass = 2.5
    session.run(steps=5)
    assert session.particles.velocity[2, 0] > before


def test_an_array_that_is_a_column_itself_is_refused(opened: Any) -> None:
    """Interpreted, its kernel would be given what the column held as a call began; compiled, what it holds now."""
    kernel = "@compiled\ndef force(moved):\n    return -moved[0], 0.0"
    with pytest.raises(mods.ModError, match=r"is particles\.displacement itself, which steps write to"):
        opened(Compile.NEVER, kernel, "{'moved': model.particles.displacement[:]}").run(time=0.01)
