"""Step programs: fused is bit-identical to stage by stage, mods join, mistakes are explained, the cache is right."""

import importlib.util
import shutil
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from numba import njit

from pinjoint import Session
from pinjoint.components.field import Field, Role
from pinjoint.documents import models
from pinjoint.systems.base import Commit, Law
from pinjoint.systems.program import loops, writer
from pinjoint.systems.program.binding import ProgramError
from pinjoint.systems.program.compiler import generated
from pinjoint.systems.program.kernel import compiled
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.models import model, oscillator, particle, rod, square
from tests.reference.stages import Stages

# --- fused and stage by stage ----------------------------------------------------------------------------


def everything() -> Model:
    """Dampers, drag, ramps, strengths on some rods, prestress, motion."""
    document = square(force=(20, -70), damping=3)
    for member in document["rods"][:3]:
        member |= {"tensile_strength": 40, "compressive_strength": 35}
    document["rods"][3]["rest_length"] = 1.4995
    document["particles"][1] |= {"velocity": [2.0, -1.0], "acceleration": [5.0, 0.0]}
    return document | {
        "environment": {"force": [0.5, 0], "acceleration": [0, -9.81], "drag": 8.0},
        "loads": [
            {"on": "C", "force": [3, -90], "history": {"kind": "ramp", "start": 0.0005, "duration": 0.001}},
            {"on": "B", "force": [7, 2], "history": {"kind": "ramp", "duration": 0.0}},
        ],
    }


def nothing() -> Model:
    """No dampers, strengths, loads or drag."""
    document = square(damping=0)
    document["particles"][1]["velocity"] = [2.0, -1.0]
    return document


@pytest.mark.parametrize("integrator", ["velocity_verlet", "taylor2"])
@pytest.mark.parametrize(
    "document", [everything(), nothing(), square()], ids=["everything", "nothing", "dampers only"]
)
def test_fused_is_bit_identical_to_stage_by_stage(document: Model, integrator: str) -> None:
    assert_identical(document, integrator, [])


@pytest.fixture
def in_stages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Loops as in large models, for a few rods at a time."""
    monkeypatch.setattr(writer, "SMALL", 0)
    monkeypatch.setattr(loops, "CHUNK", 4)


def test_loops_of_large_models_give_the_same_bits(in_stages: None) -> None:
    assert_identical(everything(), "velocity_verlet", [Heat(), Ties(), ProgressiveDamper()])
    assert_identical(nothing(), "taylor2", [])


def test_loops_of_large_models_give_the_same_bits_with_any_integrator(
    in_stages: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = everything() | {"settings": {"integrator": "semi_implicit_euler", "time_step": 5e-6}}
    large, small = (Session.open(document) for _ in range(2))
    large.run(steps=300)
    monkeypatch.setattr(writer, "SMALL", 200)
    small.run(steps=300)
    assert large.simulation.programs.compiled.form != small.simulation.programs.compiled.form
    assert bits.different(bits.columns(large.model), bits.columns(small.model)) == []


def assert_identical(document: Model, integrator: str, mods: list[Any], steps: int = 500) -> Session:
    size = 5e-6
    settings = document.get("settings", {}) | {"integrator": integrator, "time_step": size}
    session = Session.open(document | {"settings": settings}, mods)
    session.simulation.advance(0)
    stages = Stages(session.model, [s for s in session.simulation.plan if s.kernel])
    assert session.run(steps=steps) == "time reached"
    stages.run(integrator, size, steps)
    nodes, clock = session.particles, session.model.clock
    assert nodes.displacement.any()
    assert nodes.displacement.tobytes() == np.array(stages.u).tobytes()
    assert nodes.velocity.tobytes() == np.array(stages.v).tobytes()
    for name, column in stages.history.items():
        assert session.model.column(name).tobytes() == np.array(column).tobytes()
    assert {name: getattr(clock, name) for name in stages.account} == stages.account
    return session


# --- mods ------------------------------------------------------------------------------------------------


@compiled
def heated(rods_stiffness, elongation):
    return -rods_stiffness * 1e-5 * 30.0


class Heat(Law):
    """A rod 30 K warmer is longer by 3e-4 of its length, so pushes with EA·3e-4."""

    name = "zzz.heat"  # after plasticity.strength in every alphabet: the strength must see it all the same
    kernel = staticmethod(heated)
    reads = ("rods.stiffness",)
    adds = ("rods.axial_force",)


@compiled
def tied(particles_displacement, tie):
    return -tie * particles_displacement[0], -tie * particles_displacement[1]


class Ties(Law):
    """A spring from every particle to its original position, its stiffness an array of its own."""

    name = "mod.ties"
    each = "particles"
    kernel = staticmethod(tied)
    reads = ("particles.displacement",)
    adds = ("particles.force",)

    def arrays(self, model: Any) -> Mapping[str, np.ndarray]:
        return {"tie": np.full(model.particles.count, 50.0)}


@compiled
def progressive(rate, elongation, axial_force):
    return 0.5 * rate * (1.0 + abs(elongation)) + 0.0 * axial_force


class ProgressiveDamper(Law):
    """A damper that knows the elongation."""

    name = "mod.progressive_damper"
    kernel = staticmethod(progressive)
    adds = ("rods.axial_force",)
    account = "dissipated_damping"


@njit
def along_curve(elongation, steps, table):
    """A force that is linear between the values at some elongations; `table` has a row of rows."""
    (at, force), found = table, 0.0
    for k in range(len(steps) - 1):
        if at[k] <= elongation < at[k + 1]:
            found = force[k] + (elongation - at[k]) * steps[k]
    return found


class Curve(Law):
    """A characteristic of each rod by four points of a curve: rows of four numbers, and of two rows of four."""

    name = "mod.curve"
    kernel = staticmethod(along_curve)
    adds = ("rods.axial_force",)

    def arrays(self, model: Any) -> Mapping[str, np.ndarray]:
        at = np.linspace(-0.02, 0.02, 4)
        force = np.arange(model.rods.count)[:, None] + at**3
        table = np.stack([np.broadcast_to(at, force.shape), force], axis=1)
        return {"table": table, "steps": np.diff(force, append=0.0) / np.diff(at)[0]}


class OneEach(Law):
    """Rows of a single number come as a tuple of one."""

    name = "mod.one_each"
    kernel = staticmethod(njit(lambda elongation, slope: slope[0] * elongation))
    adds = ("rods.axial_force",)

    def arrays(self, model: Any) -> Mapping[str, np.ndarray]:
        return {"slope": np.full((model.rods.count, 1), 5.0)}


@pytest.mark.parametrize("small", [0, 200])
def test_rows_of_arrays_come_whole_however_wide_they_are(small: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "SMALL", small)
    assert_identical(nothing(), "velocity_verlet", [Curve(), OneEach()], steps=100)


class Fatigue:
    """Columns of a mod: the largest elongation that a rod ever had, and its force over time."""

    peak: ClassVar[Field] = Field("m", role=Role.STATE, title="peak", doc="Largest elongation so far.")
    wear: ClassVar[Field] = Field("kN·s", role=Role.STATE, title="wear", doc="|N| over time so far.")


@compiled
def remembered(elongation, rods_peak):
    return max(rods_peak, elongation), 0.0


class Peaks(Commit):
    """Keeps the largest elongation."""

    name = "mod.peaks"
    kernel = staticmethod(remembered)
    writes = ("rods.peak",)


def with_peaks(document: Model, mods: list[Any]) -> Session:
    made = models.load(document)
    made.rods.add_column(Fatigue.peak)
    return Session(made, mods)


def test_mods_join_the_program_bit_for_bit() -> None:
    for document in (everything(), nothing()):
        assert_identical(document, "velocity_verlet", [Heat(), Ties(), ProgressiveDamper()])


def test_a_heated_rod_between_fixed_ends_pushes_with_its_thermal_force() -> None:
    """N = −EA α ΔT, whatever its name comes after; a strength below it limits it."""
    fixed = [particle("A", 0, 0, fixed=[True, True]), particle("B", 1, 0, fixed=[True, True])]
    document = model(fixed, [rod("A", "B", stiffness=1000, damping=0)])
    assert Session.open(document, [Heat()]).rods["AB"].axial_force == pytest.approx(-0.3, rel=1e-12)
    document["rods"][0]["compressive_strength"] = 0.2
    assert Session.open(document, [Heat()]).rods["AB"].axial_force == -0.2


def test_a_law_of_particles_changes_the_frequency_and_balances_the_energy() -> None:
    """A mass between a rod and a tie swings with ω² = (k_rod + k_tie)/m; the tie's energy is work."""
    omega, mass, size = 100.0, 2.0, 2e-5
    both = np.sqrt(omega**2 + 50_000.0 / mass)
    document = oscillator(omega, displacement=[0.01, 0]) | {"settings": {"time_step": size}}
    session = Session.open(document, [Ties()])
    session.run(steps=700)
    turned = 2 * np.arcsin(both * size / 2)
    assert session.particles["B"].displacement[0] == pytest.approx(0.01 * np.cos(turned * 700), abs=1e-12)
    assert abs(session.energy.imbalance) <= (both * size) ** 2 * session.energy.initial


@njit
def tied_by_memory(particles_displacement):
    pulls = np.zeros(2)
    for axis in range(2):
        pulls[axis] = -50.0 * particles_displacement[axis]
    return pulls[0], pulls[1]


class TiesByMemory(Law):
    """The same force as that of Ties, from a kernel that asks for memory."""

    name = "test.ties_by_memory"
    each = "particles"
    kernel = staticmethod(tied_by_memory)
    reads = ("particles.displacement",)
    adds = ("particles.force",)


QUICKLY_COMPILED = {"integrator": "velocity_verlet", "collisions": False}


def test_the_kernel_of_a_mod_may_ask_for_memory() -> None:
    """Programs of our kernels alone do without, which makes their calls shorter."""
    by_hand, by_memory = (
        Session.open(oscillator(2.0, velocity=[0.1, 0.0]) | {"settings": QUICKLY_COMPILED}, [law])
        for law in (Ties(), TiesByMemory())
    )
    for session in (by_hand, by_memory):
        session.run(time=0.3)
    assert (by_memory.particles.displacement == by_hand.particles.displacement).all()


@compiled
def hardening(elongation):
    return 1e7 * elongation**3


class Hardening(Law):
    """A rod that stiffens: its energy is not N²L₀/2EA."""

    name = "mod.hardening"
    kernel = staticmethod(hardening)
    adds = ("rods.axial_force",)


class Damaged(Law):
    """A rod that bears less the farther it is stretched: takes what the others give."""

    name = "mod.damaged"
    kernel = staticmethod(njit(lambda axial_force, elongation: axial_force / (1.0 + 1e5 * elongation**2)))
    adds = ("rods.axial_force",)


class Lost(Hardening):
    """The same force, but what it takes counts as lost."""

    name = "mod.lost"
    account = "dissipated_plastic"


def test_laws_of_rods_of_several_accounts_are_told_apart() -> None:
    assert_identical(nothing(), "velocity_verlet", [Hardening(), Lost(), Damaged(), Heat()], steps=100)


@pytest.mark.parametrize("law", [Hardening(), ProgressiveDamper(), Damaged(), Lost()])
def test_energy_balances_with_any_law_of_rods(law: Law) -> None:
    """What is missing is an error of second order."""
    missing = []
    for steps in (100, 200):
        document = oscillator(100.0, velocity=[2.0, 0]) | {"settings": {"time_step": 0.004 / steps}}
        session = Session.open(document, [law])
        session.run(steps=steps)
        energy = session.energy
        moved = abs(energy.work) + energy.dissipated_damping + abs(energy.dissipated_plastic)
        assert moved > 0.1 * energy.initial
        missing.append(abs(energy.imbalance) / energy.initial)
    assert missing[0] < 1e-3
    assert missing[0] / missing[1] == pytest.approx(4.0, rel=0.1)


def test_a_commit_writes_its_own_column() -> None:
    session = with_peaks(oscillator(100.0, displacement=[0.003, 0]), [Peaks()])
    largest = 0.003
    for _ in range(100):
        session.run(steps=1)
        largest = max(largest, session.particles["B"].displacement[0])
    assert session.rods.peak.tolist() == [largest]


class Wear(Commit):
    """Adds up the axial force over time (kN·s)."""

    name = "mod.wear"
    writes = ("rods.wear",)

    @staticmethod
    @compiled
    def kernel(rods_wear, axial_force, dt):
        return rods_wear + abs(axial_force) * dt, 0.0


@pytest.mark.parametrize(
    ("rods", "integrator"), [(1, "velocity_verlet"), (1, "dop853"), (201, "velocity_verlet")]
)
def test_a_commit_may_take_the_axial_force_and_edits_take_no_time(rods: int, integrator: str) -> None:
    """Rod by rod, with error control, and in stages."""
    particles = [particle(f"A{row}", 0, row, fixed=[True, True]) for row in range(rods)]
    particles += [
        particle(f"B{row}", 1, row, fixed=[False, True], velocity=[1 + row, 0]) for row in range(rods)
    ]
    document = model(particles, [rod(f"A{row}", f"B{row}", stiffness=1000, damping=0) for row in range(rods)])
    made = models.load(document | {"settings": {"integrator": integrator}})
    made.rods.add_column(Fatigue.wear)
    session = Session(made, [Wear()])
    expected = np.zeros(rods)
    for _ in range(20 if rods == 1 else 4):
        session.particles["B0"].force = (session.time, 0.0)
        before = session.time
        session.run(steps=1)
        expected += abs(session.rods.axial_force) * (session.time - before)
    assert session.rods.wear == pytest.approx(expected, rel=1e-12)
    assert expected.min() > 0.0


def test_laws_that_differ_only_in_a_captured_number_are_told_apart() -> None:
    def stiffener(extra: float) -> Law:
        @compiled
        def law(elongation):
            return extra * elongation

        class Stiffener(Law):
            name = "mod.stiffener"
            kernel = staticmethod(law)
            adds = ("rods.axial_force",)

        return Stiffener()

    document = oscillator(100.0, displacement=[0.01, 0])
    forces = [Session.open(document, [stiffener(k)]).rods["AB"].axial_force for k in (0.0, 40.0)]
    assert forces == pytest.approx([0.2, 0.6], rel=1e-12)


@compiled
def later(time):
    return 0.001 * max(0.0, time - 0.5), 0.0


class Later(Law):
    """A push that begins after half a second, 1 N for every second."""

    name = "mod.later"
    each = "particles"
    kernel = staticmethod(later)


def test_what_changes_with_time_does_not_let_a_model_rest() -> None:
    alone = model([particle("A", 0, 0)], []) | {"settings": {"integrator": "rk4", "time_step": 1e-3}}
    session = Session.open(alone, [Later()])
    session.run(time=1.5)
    assert session.particles["A"].displacement[0] == pytest.approx(1.0 / 6.0, rel=1e-6)  # t³/6 of 1 kg
    session = Session.open(alone, [Later()])
    assert session.run(until="rest", limit=0.4) == "limit reached"
    assert (
        "mod.later changes with time, so the model never comes to rest; run to a time instead."
        in session.message
    )


# --- mistakes --------------------------------------------------------------------------------------------


def law(kernel: Any, **attributes: Any) -> Law:
    """A law called mod.wrong with this kernel."""
    kernel = kernel if isinstance(kernel, str) else staticmethod(kernel)
    return type("Wrong", (Law,), {"name": "mod.wrong", "kernel": kernel} | attributes)()


def commit(kernel: Any, **attributes: Any) -> Commit:
    return type("Wrong", (Commit,), {"name": "mod.wrong", "kernel": staticmethod(kernel)} | attributes)()


@compiled
def of_mass(particles_mass):
    return particles_mass


@compiled
def of_charge(rods_charge):
    return rods_charge


@compiled
def failing(elongation):
    return elongation.nothing


def plain(elongation):
    return elongation


class OwnArray(Law):
    name = "mod.wrong"
    each = "particles"
    kernel = staticmethod(tied)
    reads = ("particles.displacement",)

    def arrays(self, model: Any) -> Mapping[str, np.ndarray]:
        return {"tie": np.ones(model.particles.count + 1)}


class WideArray(OwnArray):
    def arrays(self, model: Any) -> Mapping[str, np.ndarray]:
        return {"tie": np.ones((model.particles.count, 5, 13))}


@pytest.mark.usefixtures("kernels_of_mods")
@pytest.mark.parametrize(
    ("system", "says"),
    [
        (law(njit(lambda elongation, time: time), elastic=True), "remove `elastic` or the parameter"),
        (WideArray(), "has 65 numbers in a row; a kernel takes 1 to 64"),
        (law(of_mass, each="particles"), "reads 'particles.mass'; add it to `reads`"),
        (law(of_charge, reads=("rods.charge",)), "no column rods.charge"),
        (law(of_mass, each="particles", reads=("particles.mass",)), "must return a pair, the force"),
        (law(of_mass, reads=("particles.mass",)), "for each of the rods and cannot take particles_mass"),
        (law(failing), "does not compile"),
        (law(plain), "not compiled; put `@compiled`"),
        (law("systems.nowhere:law"), "cannot be found"),
        (law("pinjoint.systems.physics.kernels:nothing"), "cannot be found"),
        (law(heated, each="rod"), "choose one of rods, ends, particles, rotations, pairs, loads"),
        (law(heated, reads=("rods.stiffness",), account="heat"), "choose one of work"),
        (law(failing, each="particles"), "name parameters <table>_<column>, time, dt or"),
        (commit(progressive, writes=("rods.yielding",)), "a parameter 'rate', but there is no column"),
        (commit(remembered, writes=("rods.density",)), "not part of the document"),
        (commit(remembered, writes=()), "has writes = []"),
        (OwnArray(), "has 3 rows for 2 particles"),
    ],
)
def test_a_system_that_cannot_join_is_named_with_the_remedy(system: Any, says: str) -> None:
    with pytest.raises(ProgramError, match=r"mod\.wrong") as caught:
        Session.open(oscillator(100.0), [system]).run(steps=1)
    assert says in str(caught.value)


def test_a_name_that_is_no_python_name_is_refused() -> None:
    system = law(heated, name="my mod.heat", reads=("rods.stiffness",))
    with pytest.raises(ProgramError, match=r"'my mod\.heat'.*name it like"):
        Session.open(oscillator(100.0), [system]).run(steps=1)


# --- the cache -------------------------------------------------------------------------------------------

COMPILE = f"""
from pinjoint import Session
alone = {{"format": "pinjoint model", "version": 1, "particles": [{{"name": "A", "position": [0, 0]}}]}}
session = Session.open(alone | {{"settings": {QUICKLY_COMPILED}}})
session.run(steps=1)
print(session.simulation.programs.compile_seconds)
"""


def test_a_second_process_loads_instead_of_compiling(fresh_process: Callable[..., str], tmp_path: Path) -> None:
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    folders["PINJOINT_COMPILE"] = "always"
    first, second = (float(fresh_process(COMPILE, folders)) for _ in range(2))
    assert list(tmp_path.rglob("pinjoint_program_*.code"))
    assert second < 0.5 * first


SHARED = f"""
import gc, pickle
from pinjoint import Session
from pinjoint.systems.program import cache
from pinjoint.systems.program.compiler import Choice, Compile
Choice.compile = Compile.ELSEWHERE
alone = {{"format": "pinjoint model", "version": 1, "particles": [{{"name": "A", "position": [0, 0]}}]}}
alone["settings"] = {QUICKLY_COMPILED}
session, other = Session.open(alone), Session.open(alone)
module = session.simulation.program.module
assert other.simulation.program.module is module
del other
gc.collect()
module.load()
print({{name: len(types) for name, types in pickle.loads(cache.read(f"{{module.key}}.types")).items()}})
"""


def test_a_program_that_is_gone_does_not_keep_another_from_being_compiled(
    fresh_process: Callable[..., str], tmp_path: Path
) -> None:
    """What was kept said that it needs nothing, so that each later process compiled or loaded it in its first step."""
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    assert fresh_process(SHARED, folders).strip() == "{'advance': 1, 'observe': 1}"


def test_an_unwritable_cache_folder_is_done_without(fresh_process: Callable[..., str], tmp_path: Path) -> None:
    """A file stands where the folder should be: it is left alone, and the run works all the same."""
    blocked, temporary = tmp_path / "cache", tmp_path / "temporary"
    blocked.write_text("not a folder")
    temporary.mkdir()
    folders = {"XDG_CACHE_HOME": str(blocked), "LOCALAPPDATA": str(blocked), "HOME": str(blocked)}
    folders["PINJOINT_COMPILE"] = "always"
    assert float(fresh_process(COMPILE, folders | {"TMPDIR": str(temporary), "TEMP": str(temporary)})) > 0.0
    assert blocked.read_text() == "not a folder"
    assert list(temporary.rglob("pinjoint_program_*.code"))


SOURCE = "from pinjoint.systems.program.kernel import kept\n\n\n@kept()\ndef answer(x):\n    return kernel(x)\n"
CALLER = "from numba import njit\nimport edited_helpers as helpers\n\n@njit\ndef kernel(x):\n    return helpers.twice(x)\n"
CALLEE = "from numba import njit\n\nFACTOR = 2.0\n\n@njit\ndef twice(x):\n    return FACTOR * x\n"


def test_an_edited_kernel_is_noticed_in_what_it_calls_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pinjoint.systems.program.cache.folder", lambda: tmp_path)
    answers = []
    for factor in ("2.0", "5.0"):
        (tmp_path / "edited_helpers.py").write_text(CALLEE.replace("2.0", factor))
        (tmp_path / "edited_kernel.py").write_text(CALLER)
        shutil.rmtree(tmp_path / "__pycache__", ignore_errors=True)
        for name in ("edited_helpers", "edited_kernel"):
            spec = importlib.util.spec_from_file_location(name, tmp_path / f"{name}.py")
            assert spec is not None
            assert spec.loader is not None
            monkeypatch.setitem(sys.modules, name, importlib.util.module_from_spec(spec))
            spec.loader.exec_module(sys.modules[name])
        program = generated("test", SOURCE, {"kernel": sys.modules["edited_kernel"].kernel}).load()
        answers.append(program.answer(10.0))
    assert answers == [20.0, 50.0]
    assert len(list(tmp_path.glob("pinjoint_program_*.code"))) == 2


def test_a_kernel_that_moved_to_another_module_is_compiled_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is cached may know what it calls by its module, and cannot be loaded where that is gone."""
    monkeypatch.setattr("pinjoint.systems.program.cache.folder", lambda: tmp_path)
    for name in ("kernels_before", "kernels_after"):
        spec = importlib.util.spec_from_loader(name, loader=None)
        assert spec is not None
        module = importlib.util.module_from_spec(spec)
        exec(CALLEE.replace("twice", "kernel"), vars(module))
        assert generated("test", SOURCE, {"kernel": vars(module)["kernel"]}).load().answer(10.0) == 20.0
    assert len(list(tmp_path.glob("pinjoint_program_*.code"))) == 2
