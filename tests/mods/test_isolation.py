"""Mods that fail while the program runs: each is named with its reason, switched off, and the model is intact."""

import math
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.documents.models import document
from pinjoint.mods import guard
from tests.mods.conftest import Write
from tests.reference.models import model, particle, rod

pytestmark = pytest.mark.usefixtures("in_window")

TRUSS: dict[str, Any] = model(
    [
        particle("A", 0.0, 0.0, fixed=[True, True]),
        particle("B", 1.0, 0.0, fixed=[False, True]),
        particle("C", 0.5, 1.0, force=[1.0, -2.0]),
    ],
    [rod("A", "C"), rod("B", "C")],
    settings={"integrator": "velocity_verlet", "collisions": False},  # the quickest to compile
)

SYSTEM = """
import esper
import numpy as np
from pinjoint.components import Particle
from pinjoint.systems.base import Phase, System

class Bad(System):
    name = "apple.bad"
    phase = Phase.{phase}
    writes = ("particles.velocity",)

    def process(self, frame):
        model = frame.session.model
        {body}

def plugin(app):
    app.system(Bad)
"""

LAW = """
from pinjoint.components import HistoryKind
from numba import njit
from pinjoint.systems.base import Commit, Law

{kernel}

class Bad(Law):
    name = "apple.bad"
    each = "particles"
    kernel = bad
    reads = ("particles.position",)
    {more}

def plugin(app):
    app.system(Bad)
"""
FAIR = "@njit\ndef bad(particles_position):\n    return 0.0, 0.0"

OTHER = "def plugin(app):\n    {}"

DELETE_ALL = "for p in session.particles: session.model.delete([p])"


@pytest.fixture
def session(write_mod: Write) -> Any:
    """A session with the mod that its code makes, and what the model was before."""

    def open_with(code: str) -> tuple[Session, dict[str, Any]]:
        made = Session.open(TRUSS, mods=[write_mod("apple", code)])
        return made, document(made.model)

    return open_with


def check_switched_off(session: Session, before: dict[str, Any], said: str) -> None:
    """The mod is named with the reason; the document is as it was; what follows works."""
    session.update_view()
    problem = session.view.status.problem
    assert "The mod 'apple' was switched off" in problem
    assert said in problem
    now = document(session.model)
    for section in ("environment", "settings", "particles", "rods"):
        stripped = [
            [{k: v for k, v in e.items() if k not in ("displacement", "velocity")} for e in made[section]]
            if isinstance(made[section], list)
            else made[section]
            for made in (before, now)
        ]
        assert stripped[0] == stripped[1]
    session.press("escape")
    session.update_view()
    assert "switched off" not in session.message
    session.particles["C"].force = (2.0, -2.0)
    session.frame(0.01)
    assert "switched off" not in session.message
    session.undo()


# --- frame systems -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("phase", ["INPUT", "RENDER"])
def test_an_exception_in_a_phase(session: Any, phase: str) -> None:
    body = 'model.particles["C"].force = (9.0, 9.0); model.writable("particles.velocity")[:] = 5.0; 1 / 0'
    made, before = session(SYSTEM.format(phase=phase, body=body))
    made.frame(0.01)
    assert made.particles.velocity.tolist() == [[0.0, 0.0]] * 3
    assert not made.document.history.can_undo
    check_switched_off(made, before, "ZeroDivisionError: division by zero (apple/__init__.py, line 14)")


@pytest.mark.parametrize(
    "body",
    [
        "while True: pass",
        'while True: model.particles["C"].force = (model.particles["C"].force[0] + 1.0, 0.0)',
        "while True: model.create(Particle, 1)",
    ],
)
def test_a_system_that_does_not_end_is_interrupted(
    session: Any, body: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guard, "PATIENCE", 0.2)
    made, before = session(SYSTEM.format(phase="EDIT", body=body))
    made.frame(0.01)
    check_switched_off(made, before, "it ran for more than 0.2 s (")


@pytest.mark.parametrize(
    "body",
    [
        "[model.delete([p]) for p in model.particles]; model.particles[0].force",
        "[esper.delete_entity(e) for e, _ in esper.get_component(Particle)]",
        "esper.clear_database()",
        "[esper.remove_component(e, Particle) for e, _ in esper.get_component(Particle)]",
    ],
)
def test_a_system_that_deletes_everything(session: Any, body: str) -> None:
    made, before = session(SYSTEM.format(phase="EDIT", body=body))
    made.select(made.particles["C"])
    made.frame(0.01)
    assert [made.model.describe(handle) for handle in made.selected] in (["particle C"], [])
    check_switched_off(made, before, "the system 'apple.bad' failed: ")
    made.model.delete([made.particles["C"]])
    assert made.rods.count == 0
    made.undo()
    assert made.rods.count == 2


def test_what_a_system_does_by_commands_is_one_step_of_undo(session: Any) -> None:
    body = 'model.particles["C"].force = (9.0, 9.0); model.particles["C"].mass = 4.0'
    made, before = session(SYSTEM.format(phase="EDIT", body=body))
    made.frame(0.01)
    assert made.particles["C"].mass == 4.0
    made.undo()
    assert document(made.model) == before


# --- compiled code ----------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("compiling")
@pytest.mark.parametrize(
    ("kernel", "more", "said"),
    [
        (
            "@njit(error_model='numpy')\ndef bad(particles_position):\n"
            "    return 1.0 / (particles_position[1] - 1.0), 0.0",
            "",
            "The run leads to numbers that are not finite. Without apple.bad the steps lead on.",
        ),

        ("@njit\ndef bad(particles_position):\n    particles_position[0] = 1.0\n    return 1.0, 1.0", "", "compile"),

        ("@njit\ndef bad(particles_weight):\n    return 0.0, 0.0", "", "there is no column particles.weight"),
        ("def bad(particles_position):\n    return 0.0, 0.0", "", "is not compiled"),
        (FAIR, "def needs(self, model): return 1 / 0", "ZeroDivisionError: division by zero (apple/__init__.py"),
        (FAIR, "def arrays(self, model): return 1 / 0", "ZeroDivisionError: division by zero (apple/__init__.py"),
        (FAIR, "reads = ('particles.mass',)", "does not declare that it reads"),
    ],
)  # fmt: skip
def test_a_law_that_spoils_the_step_program(session: Any, kernel: str, more: str, said: str) -> None:
    made, before = session(LAW.format(kernel=kernel, more=more))
    with pytest.raises(
        mods.ModError, match=r"The mod 'apple' was switched off: .* The run stopped at t = 0 s\."
    ):
        made.run(time=0.01)
    check_switched_off(made, before, said)
    assert made.run(time=0.01) == "time reached"
    mods.unload(mods.MODS[-1:])
    alone = Session.open(TRUSS)
    alone.run(time=0.01)
    assert made.model.clock.time == alone.model.clock.time
    assert made.particles.velocity.tobytes() == alone.particles.velocity.tobytes()


@pytest.mark.parametrize("integrator", ["velocity_verlet", "automatic"])
def test_a_law_that_is_spoilt_later_leaves_the_last_good_state(session: Any, integrator: str) -> None:
    kernel = """
@njit(error_model="numpy")
def bad(particles_position, particles_velocity, time):
    return (0.005 - time) ** 0.5 - 0.005 ** 0.5, 0.0
"""
    more = "reads = ('particles.position', 'particles.velocity')"
    made, _ = session(LAW.format(kernel=kernel, more=more))
    made.settings.integrator = integrator
    before = document(made.model)
    with pytest.raises(mods.ModError, match="The run stopped at t = "):
        made.run(time=0.01)
    assert 0.0 <= made.time < 0.006
    check_switched_off(
        made, before, "The run leads to numbers that are not finite. Without apple.bad the steps lead on."
    )
    assert made.run(time=0.01 - made.time) == "time reached"  # without the mod


def test_what_comes_with_the_program_is_not_to_blame_for_numbers_of_a_model() -> None:
    """The steps would be others without the pulse, and lead on for once."""
    pulse = {"kind": "pulse", "start": 1e-300, "duration": 0.01}
    made = Session.open(
        model(
            [particle("A", 0, 0), particle("B", 1, 0.3, velocity=[0.36, 1e30]), particle("C", 2, 0, mass=2)],
            [rod("A", "B", tension_only=True), rod("A", "C", rest_length=1e-30)],
            loads=[{"on": "C", "force": [5.0, 5.0], "history": pulse}],
        )
    )
    assert made.run(time=0.01) == "diverged"
    assert not any(mod.off for mod in mods.MODS)


def test_of_several_mods_that_act_the_one_that_spoils_the_run_is_found(write_mod: Write) -> None:
    spoilt = "@njit(error_model='numpy')\ndef bad(particles_position):\n    return particles_position[1] ** 0.5 - {}, 0.0"
    fair, bad = (LAW.format(kernel=spoilt.format(left), more="") for left in ("0.0", "(-1.0) ** 0.5"))
    folders = [write_mod("pear", fair.replace("apple", "pear")), write_mod("apple", bad)]
    made = Session.open(TRUSS, mods=folders)
    with pytest.raises(
        mods.ModError, match=r"The mod 'apple' was switched off: .* Without apple\.bad the steps lead"
    ):
        made.run(time=0.001)
    assert [mod.name for mod in mods.MODS if mod.off] == ["apple"]


# --- what is seen and pressed --------------------------------------------------------------------------------------


def test_an_action_that_fails_changes_nothing(session: Any) -> None:
    code = OTHER.format(
        "app.action('apple.a', key='ctrl+shift+j')(bad)\n\ndef bad(session, pixel):\n    {}\n    1 / 0"
    )
    made, before = session(code.replace("{}", DELETE_ALL))
    made.press("ctrl+shift+j")
    check_switched_off(made, before, "the action 'apple.a' failed: ZeroDivisionError: division by zero (apple/")
    made.press("ctrl+shift+j")
    assert "is switched off" in made.notice


INTEGRATOR = """
from pinjoint.systems.physics.integrators import VelocityVerlet

class Mine(VelocityVerlet):
    name = "apple.mine"
    {line}

def plugin(app):
    app.integrator(Mine)
"""


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("ends = 'apple:nothing'", "The kernel 'apple:nothing' of apple.mine cannot be found"),
        (
            "stable_step = staticmethod(lambda w, d: 1 / 0)",
            "the stable step of the integrator 'apple.mine' failed",
        ),
        ("stable_step = staticmethod(lambda w, d: float('nan'))", "return a number of at least 0"),
    ],
)
def test_without_an_integrator_that_fails_another_takes_the_steps(session: Any, line: str, said: str) -> None:
    made, _ = session(INTEGRATOR.format(line=line))
    made.settings.integrator = "mine"
    made.press("space")
    made.frame(1 / 60)
    assert said in made.message
    assert made.run(time=0.001) == "time reached"
    made.particles["C"].force = (2.0, -2.0)
    assert made.run(time=0.001) == "time reached"
    assert made.simulation.integrator.key == "dop853"


HARDER = """
from numba import njit
from pinjoint.systems.base import Law

class Harder(Law):
    name = "apple.harder"
    kernel = njit(lambda {given}, elongation: {force})
    adds = ("rods.axial_force",)
    {more}

def plugin(app):
    app.system(Harder)
"""
PULLED: dict[str, Any] = model(
    [
        particle("A", 0, 0, fixed=[True, True]),
        particle("B", 1, 0, fixed=[False, True], mass=1, velocity=[2.0, 0]),
    ],
    [rod("A", "B", name="r", stiffness=1000, damping=0, tensile_strength=1, compressive_strength=1)],
    settings={"integrator": "velocity_verlet", "time_step": 2e-06},
)


def test_the_work_of_a_law_that_takes_the_axial_force_is_accounted_for(write_mod: Write) -> None:
    """It is given what plasticity has cut, 1 kN, and may go beyond: what it adds is work of the law."""
    law = HARDER.format(given="axial_force", force="axial_force * (1.0 + 100.0 * abs(elongation))", more="")
    session = Session.open(PULLED, mods=[write_mod("apple", law)])
    session.run(time=0.0015)
    assert not mods.FAULTS
    assert session.rods["r"].axial_force > 1.05
    assert abs(session.energy.imbalance) < 2e-3 * session.energy.initial


def test_a_law_takes_the_place_of_plasticity(write_mod: Write) -> None:
    law = HARDER.format(given="axial_force", force="axial_force", more='replaces = ("plasticity",)')
    session = Session.open(PULLED, mods=[write_mod("apple", law)])
    plan = session.plan("simulation")
    assert (
        plan.left_out["plasticity.yielding"]
        == plan.left_out["plasticity.strength"]
        == "replaced by apple.harder"
    )
    session.run(time=0.0015)
    assert session.rods["r"].axial_force == pytest.approx(2.0 * math.sin(1.5), rel=1e-4)  # v √(k m) sin ωt
    assert session.rods["r"].plastic_strain == 0.0
    mods.MODS[-1].switch_off("for this test")
    session.rods["r"].stiffness = 1001  # an edit, after which there is another plan
    session.run(time=0.0015)
    assert session.rods["r"].plastic_strain > 0.0  # plasticity is back


def test_where_a_run_diverges_the_laws_of_mods_are_named(write_mod: Write) -> None:
    law = HARDER.format(
        given="rods_stiffness", force="1e9 * elongation", more='elastic, reads = True, ("rods.stiffness",)'
    )
    session = Session.open(PULLED, mods=[write_mod("apple", law)])
    assert session.run(time=1.0) == "diverged"
    assert "Laws of mods act in the model: apple.harder; see whether it runs without them." in session.message


HELD = """
import numpy as np
from numba import njit
from pinjoint.systems.base import Law

class Wind(Law):
    name = "apple.wind"
    each = "particles"
    kernel = njit(error_model="numpy")(lambda particles_mass: (2.0, 0.0))
    reads = ("particles.mass",)

    def leaves_flight_exact(self, model):
        return True

    def held_forces(self, model):
        return {forces}

def plugin(app):
    app.system(Wind)
"""
DISCS = model([{"name": name, "position": [x, 0.0], "mass": 5.0} for name, x in (("A", 0.0), ("B", 1.0))], [])


@pytest.mark.parametrize("forces", ["np.array([2.0, 0.0])", "np.full((model.particles.count, 2), [2.0, 0.0])"])
def test_the_law_of_a_mod_moves_discs_on_exact_paths(write_mod: Write, forces: str) -> None:
    """As the hand that pulls does: its forces act, and their work is all energy that there is."""
    session = Session.open(DISCS, mods=[write_mod("apple", HELD.format(forces=forces))])
    session.run(time=0.1)
    assert session.simulation.integrator.exact
    force, mass, time = 2000.0, 5.0, session.model.clock.time
    for name in "AB":
        assert session.particles[name].velocity == pytest.approx((force / mass * time, 0.0), rel=1e-9)
    assert session.energy.work == pytest.approx(session.energy.kinetic, rel=1e-9)


@pytest.mark.parametrize("forces", ["1 / 0", "np.zeros(3)", "np.full(2, np.nan)", "None"])
def test_forces_that_cannot_be_held_switch_a_mod_off(write_mod: Write, forces: str) -> None:
    session = Session.open(DISCS, mods=[write_mod("apple", HELD.format(forces=forces))])
    with pytest.raises(mods.ModError, match=r"held_forces of 'apple\.wind' failed"):
        session.run(time=0.1)
    assert not session.model.particles.displacement.any()


PAIRS = """
from numba import njit
from pinjoint.systems.base import Law

class Pull(Law):
    name = "apple.pull"
    each = "pairs"
    kernel = njit(error_model="numpy")(lambda apart, particles_mass: ({force}, 0.0))
    reads = ("particles.mass",)

    def cutoff(self, model):
        return {cutoff}

def plugin(app):
    app.system(Pull)
"""


@pytest.mark.parametrize(
    ("force", "cutoff", "said"),
    [
        ("0.0", "'far'", "cutoff of 'apple.pull' failed: TypeError: what it returned is 'far'"),
        ("0.0", "-1.0", "The cutoff of apple.pull is -1.0; give a distance above 0 m"),
        (
            "1.0 / (apart[0] - apart[0])",
            "5.0",
            "The run leads to numbers that are not finite. Without apple.pull the steps lead on.",
        ),
        ("apart", "5.0", "must return a pair, the force (fx, fy) on the first particle"),
    ],
)
def test_a_law_of_pairs_that_fails_is_named(
    session: Any, force: str, cutoff: str, said: str, request: pytest.FixtureRequest
) -> None:
    if "must return" in said:
        request.getfixturevalue("compiling")
    made, _ = session(PAIRS.format(force=force, cutoff=cutoff))
    made.press("space")
    made.frame(0.01)
    made.press("space")
    made.run(time=0.001)
    assert said in mods.MODS[-1].problem
