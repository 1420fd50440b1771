"""Programs compute the same bits interpreted and compiled, and when the one follows the other, at any step."""

import itertools
import math

import pytest

from pinjoint import Session
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program import compiler
from pinjoint.systems.program.compiler import Compile, GeneratedModule
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.forms import all_modules, load_all, programs
from tests.reference.models import portal_in_wind, struck
from tests.reference.random_models import drawn
from tests.verification.test_determinism import DOCUMENTS

KINDS = (
    "everything, in motion",
    "cables with dampers",
    "loads of every history",
    "stiff",
    "free discs that collide",
    "discs on trusses",
)  # each is compiled, where test_differential.py has not

STEPS = 90
OF_EACH_FORM = "velocity_verlet", "esdirk4", "dop853"  # of step programs
MEETING = {  # what may meet: steps that were tried are put back, and taken again
    **{f"truss, {name}": struck(name, bends=False) for name in OF_EACH_FORM},
    **{f"frame, {name}": struck(name) for name in INTEGRATORS},
    **{f"portal, {name}": portal_in_wind(name) for name in OF_EACH_FORM},
}


def state(model: str | Model, steps: int, choice: Compile, switch: int | None = None, **chosen: str) -> bytes:
    """All columns after so many steps; machine code takes over after `switch` of them."""
    with programs(choice):
        session = Session.open(model)
        for name, value in chosen.items():
            setattr(session.settings, name, value)
        if switch is not None:
            session.run(steps=switch)
            load_all()
        session.run(steps=steps - (switch or 0))
        loaded = {module.is_loaded for module in all_modules() if module._form is not None}
        assert loaded == {choice is Compile.ALWAYS} if switch is None else True in loaded
        return bits.digest(session.model).encode()


@pytest.mark.parametrize(("turn", "switch"), [(0, 1), (1, 17), (2, 59)])
@pytest.mark.parametrize("title", KINDS)
def test_random_models_have_the_same_bits_in_both_forms_and_in_one_after_the_other(
    title: str, turn: int, switch: int
) -> None:
    document = drawn(title, turn).document
    interpreted = state(document, 60, Compile.NEVER)
    assert state(document, 60, Compile.ALWAYS) == interpreted
    assert state(document, 60, Compile.ELSEWHERE, switch) == interpreted


@pytest.mark.parametrize("integrator", list(INTEGRATORS))
def test_all_integrators_have_the_same_bits_in_both_forms(integrator: str) -> None:
    interpreted = state("hyperstatic_yield", 40, Compile.NEVER, integrator=integrator)
    assert state("hyperstatic_yield", 40, Compile.ALWAYS, integrator=integrator) == interpreted


@pytest.mark.parametrize("document", [make() for make in DOCUMENTS.values()], ids=list(DOCUMENTS))
def test_bits_do_not_depend_on_the_portions_of_interpreted_steps(
    document: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pinjoint.systems.program.compiler.LONGEST_CALL", 0.0)
    assert state(document, 100, Compile.NEVER) == state(document, 100, Compile.ALWAYS)


@pytest.mark.parametrize("document", MEETING.values(), ids=list(MEETING))
def test_bits_of_what_may_meet_do_not_depend_on_the_portions(
    document: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Portions are of one step where calls may take no time, and of 1, 8, 64, … where they may take any."""
    found = set()
    for longest in (0.0, math.inf):
        monkeypatch.setattr("pinjoint.systems.program.compiler.LONGEST_CALL", longest)
        found.add(state(document, STEPS, Compile.NEVER))
    assert len(found) == 1


@pytest.mark.parametrize("title", ["frame, velocity_verlet", "frame, esdirk4", "portal, dop853"])
def test_machine_code_may_take_over_from_frames_at_any_step(title: str) -> None:
    document = MEETING[title]
    interpreted = state(document, STEPS, Compile.NEVER)
    for switch in (13, STEPS - 1):
        assert state(document, STEPS, Compile.ELSEWHERE, switch) == interpreted, switch


@pytest.mark.parametrize(
    ("title", "collisions"),
    [("frame, velocity_verlet", False), ("portal, dop853", False), ("portal, dop853", True)],
)
def test_frames_may_be_compiled_between_the_portions_of_their_steps(
    title: str, collisions: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The compiler calls all functions once, in the midst of a call that takes many steps."""
    portions, did = itertools.count(1), GeneratedModule.did

    def compiles(module: GeneratedModule, work: int) -> None:
        did(module, work)
        if next(portions) == STEPS // 2:
            module.load()

    monkeypatch.setattr(compiler, "LONGEST_CALL", 0.0)
    monkeypatch.setattr(GeneratedModule, "load_kept", lambda module: False)  # which would call nothing
    found = set()
    for compiled in (False, True):
        with programs(Compile.ELSEWHERE):
            monkeypatch.setattr(GeneratedModule, "did", compiles if compiled else did)
            session = Session.open(MEETING[title])
            session.settings.collisions = collisions
            session.run(steps=STEPS)
            assert session.simulation.programs.compiled.module.is_loaded is compiled
            found.add(bits.digest(session.model))
    assert len(found) == 1
