"""A window begins runs interpreted while another process compiles, and goes on with what was compiled there."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import pygame
import pytest

from pinjoint import elsewhere, mods, preparation
from pinjoint.app import App
from pinjoint.components.field import Role
from pinjoint.components.language import spoken
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.document import document
from pinjoint.editor.view_model import READYING
from pinjoint.elsewhere import UNITS, Job, parts_of, problem_of
from pinjoint.preparation import Preparation, _job, _jobs_of, is_live
from pinjoint.session import Session
from pinjoint.systems.input import pygame_input
from pinjoint.systems.physics import automatic
from pinjoint.systems.program import cache
from pinjoint.systems.program import compiler as programs
from pinjoint.systems.program.compiler import Choice, Compile, GeneratedModule, forget_unused
from pinjoint.systems.program.program import module_of
from pinjoint.systems.program.writer import FEW
from pinjoint.systems.render.backends.raster import RASTER
from pinjoint.systems.run import programs as run_programs
from tests.benchmarks.models import lattice, mesh, overlapping, touching

RAW_LOAD, RAW_CHOICE = GeneratedModule.load_kept, automatic.choose


class Process:
    """In place of a process that compiles: it ends when told to."""

    def __init__(self, jobs: list[Job], status: int | None) -> None:
        self.jobs = jobs
        self.returncode = status
        self.said = ""

    def poll(self) -> int | None:
        return self.returncode

    def terminate(self) -> None:
        self.returncode = -15

    def communicate(self) -> tuple[str, None]:
        return self.said, None


class Compiler:
    """All of them, in order; and what is compiled, by the names of jobs: nothing at first."""

    def __init__(self) -> None:
        self.processes: list[Process] = []
        self.status: int | None = None  # with which those end that are started from now on
        self.compiled = False
        self.loaded: list[GeneratedModule] = []

    def start(self, jobs: dict[Job, bytes], urgent: bool) -> Process:
        self.processes.append(Process(list(jobs), self.status))
        return self.processes[-1]

    def load(self, module: GeneratedModule) -> bool:
        if self.compiled and module not in self.loaded:
            if module is RASTER:
                RAW_LOAD(module) or module._compile()
            self.loaded.append(module)
        return self.compiled


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch) -> Compiler:
    """Nothing is compiled yet, and nothing was interpreted."""
    found = Compiler()
    monkeypatch.setattr(elsewhere, "started", found.start)
    monkeypatch.setattr(elsewhere, "INTERVAL", 0.001)
    monkeypatch.setattr(preparation, "AHEAD", ())
    monkeypatch.setattr(GeneratedModule, "is_compiled", lambda module: found.compiled)
    monkeypatch.setattr(GeneratedModule, "load_kept", lambda module: found.load(module))
    monkeypatch.setattr(GeneratedModule, "is_loaded", property(lambda module: module in found.loaded))
    monkeypatch.setattr(Choice, "compile", Compile.SOON)
    monkeypatch.setattr(programs, "_modules", {})  # what earlier tests compiled is loaded
    monkeypatch.setattr(programs, "_interpreted", [])
    for said in ("SAID", "TROUBLE"):  # by earlier tests
        monkeypatch.setattr(cache, said, [])
    monkeypatch.setattr(pygame_input, "IDLE_PAUSE", 0.0)
    return found


def window_of(model: Model, compiler: Compiler) -> Iterator[App]:
    """A window that has begun to compile."""
    window = App(model, preparation=Preparation())
    until(window, lambda: bool(compiler.processes))
    yield window
    assert window.preparation is not None
    window.preparation.close()
    window.close()


@pytest.fixture
def app(compiler: Compiler) -> Iterator[App]:
    yield from window_of(models.load("isostatic"), compiler)


@pytest.fixture
def large(compiler: Compiler) -> Iterator[App]:
    """A model that waits."""
    yield from window_of(lattice(600, damping=1.0), compiler)


def end(process: Process, said: str = "\n", status: int = 0) -> None:
    process.said = said
    process.returncode = status


def frames(app: App, count: int) -> None:
    for _ in range(count):
        app.frame(1 / 60)


def until(app: App, met: Callable[[], bool]) -> None:
    """Frames until something is met, which a thread brings about."""
    late = time.monotonic() + 20.0
    while not met():
        assert time.monotonic() < late
        app.frame(1 / 60)
        time.sleep(0.001)


# --- small models ----------------------------------------------------------------------------------------


def test_a_run_begins_at_once_and_says_nothing_of_compiling(app: App, compiler: Compiler) -> None:
    session = app.session
    session.press("space")
    frames(app, 2)
    assert session.model.clock.steps > 0
    assert session.view.status.state == "running"
    assert session.view.status.notice == ""
    assert session.view.forces_known
    assert compiler.loaded == []


@pytest.mark.parametrize("action", [".", "k"])
def test_stepping_and_the_force_method_begin_at_once_too(app: App, action: str) -> None:
    session = app.session
    session.press(action)
    frames(app, 2)
    moved = session.model if action == "." else session.scenes.active.guide.moving[0].model  # type: ignore[attr-defined]
    assert moved.clock.steps > 0
    assert READYING.partition(":")[0] not in session.view.status.notice


def test_a_hand_that_drags_in_pause_chooses_no_integrator(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That takes all modes of a small model, in each frame."""
    session, chosen = app.session, list[str]()
    session.press("i")
    until(app, lambda: session.simulation.programs.ready)
    monkeypatch.setattr(run_programs, "choose", lambda model: chosen.append(model.context) or RAW_CHOICE(model))
    x, y = session.view.camera.to_pixels(session.particles["B"].position).tolist()
    session.press("drag", (x, y))
    for number in range(1, 4):
        session.view.pointer = x + 5.0 * number, y
        session.press("drag to", session.view.pointer)
        frames(app, 1)
        assert number == 1 or session.model.context not in chosen
        chosen.clear()
        again = Session(models.load(document(session.model)))
        assert session.rods.axial_force.tolist() == again.rods.axial_force.tolist()
    session.press("drop", (x + 15.0, y))
    session.press("space")
    frames(app, 2)
    assert session.model.context in chosen


def test_what_the_open_model_needs_is_compiled_first(app: App, compiler: Compiler) -> None:
    simulation = app.session.simulation
    first = _job(simulation, simulation.plan)
    assert compiler.processes[0].jobs == [first]
    assert first[:2] == (simulation.integrator.key, FEW)
    end(compiler.processes[0])
    until(app, lambda: len(compiler.processes) > 1)
    later = compiler.processes[1].jobs
    assert [set(job) - set(first) for job in later] == [
        {"edit.pull"},
        {"loads.ramp"},
        {"physics.slackness", "physics.axial_damping_of_cables"},
        {"physics.drag"},
    ]


def edit(session: Session, column: str, value: object) -> None:
    """Set a field of all that have it, such as rods.tension_only."""
    table, _, field = column.partition(".")
    session.model.assign(list(session.model.tables[table]), field, value)


@pytest.mark.parametrize(
    ("column", "value"), [("settings.plasticity", True), ("rods.tension_only", True), ("environment.drag", 0.5)]
)
def test_what_an_edit_will_bring_is_compiled_before(
    app: App, compiler: Compiler, column: str, value: object
) -> None:
    session = app.session
    session.settings.plasticity = False
    frames(app, 3)
    soon = list(preparation._jobs_later(session.simulation))
    edit(session, column, value)
    assert _jobs_of(session.simulation)[0] in soon


def test_what_is_needed_comes_before_what_may_be(app: App, compiler: Compiler) -> None:
    end(compiler.processes[0])
    until(app, lambda: len(compiler.processes) > 1)  # for later
    app.session.documents.open("ball_on_truss")
    until(app, lambda: len(compiler.processes) > 2)
    program, driven = compiler.processes[2].jobs
    assert compiler.processes[1].returncode == -15
    assert program[:2] == ("dop853", "few")
    assert driven == ("driven_collisions",)


def test_free_particles_need_piles_once_something_pulls(app: App) -> None:
    app.session.documents.open(models.load("collision_i"))
    assert _jobs_of(app.session.simulation) == [("fly",), ("open_horizon",)]
    app.session.environment.acceleration = (0.0, -9.81)
    assert _jobs_of(app.session.simulation) == [("fly",), ("open_horizon",), ("take_steps",)]


def test_the_program_is_made_before_a_key_needs_it(app: App) -> None:
    for rod in app.session.rods:
        rod.tensile_strength = rod.compressive_strength = None  # so that no picture needs the program
    simulation, before = app.session.simulation, app.session.model.newest(Role.DOCUMENT)
    until(app, lambda: simulation.programs.ready)
    assert app.session.model.newest(Role.DOCUMENT) == before


def test_machine_code_is_loaded_as_soon_as_it_is_there(app: App, compiler: Compiler) -> None:
    simulation = app.session.simulation
    app.session.press("space")
    frames(app, 2)
    compiler.compiled = True
    until(app, lambda: simulation.programs.compiled.module in compiler.loaded)


# --- large models ----------------------------------------------------------------------------------------


def test_a_large_model_waits_and_shows_how_much_is_done(large: App, compiler: Compiler) -> None:
    session = large.session
    session.press("space")
    frames(large, 3)
    session.press("i")  # a key meanwhile
    frames(large, 3)
    assert session.model.clock.steps == 0
    status = session.view.status
    assert (status.state, status.notice.startswith(READYING.partition(":")[0])) == ("preparing", True)
    assert status.share is not None
    assert 0.0 <= status.share < 1.0
    assert not session.view.forces_known
    compiler.compiled = True
    until(large, lambda: session.model.clock.steps > 0)
    frames(large, 1)
    assert (session.view.status.notice, session.view.status.share) == ("", None)
    assert session.view.forces_known


def test_while_a_run_waits_frames_are_few(
    large: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They would take a fifth of a core from what compiles."""
    large.session.press("space")
    frames(large, 2)
    looks: list[float] = []
    monkeypatch.setattr(pygame_input.time, "sleep", looks.append)  # type: ignore[attr-defined]
    monkeypatch.setattr(elsewhere, "INTERVAL", 1.0)
    frames(large, 1)
    assert len(looks) >= pygame_input.WAITING_LOOKS


def test_what_is_awaited_and_cannot_be_compiled_there_is_compiled_here(
    large: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    here: list[Job] = []
    monkeypatch.setattr(preparation, "problem_of", lambda job, document: here.append(job) or "")
    large.session.press("space")
    compiler.status = compiler.processes[0].returncode = 1
    until(large, lambda: bool(here))
    assert here[0] == _jobs_of(large.session.simulation)[0]
    until(large, lambda: large.session.model.clock.steps > 0)


@pytest.mark.parametrize(("count", "live"), [(250, True), (600, False)])
def test_models_wait_from_a_size_on(count: int, live: bool) -> None:
    assert is_live(lattice(count)) == live


@pytest.mark.parametrize(
    ("made", "jobs"),
    [
        (lambda: overlapping(290), {"parting"}),
        (lambda: touching(290, 1), {"fly", "open_horizon"}),
        (lambda: touching(15, 15), set()),
        (lambda: overlapping(5), set()),
    ],
)
def test_calls_that_would_take_long_interpreted_wait(
    made: Callable[[], Model], jobs: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Choice, "compile", Compile.SOON)
    session, wanted = Session(made()), Preparation()
    monkeypatch.setattr(Preparation, "_is_ready", lambda preparation, job: False)
    assert (wanted.waits_for(session.simulation) is not None) == bool(jobs)
    assert {job[0] for job in wanted._waiting} == jobs
    session.simulation.armed = True  # overlaps are parted by then
    assert (wanted.waits_for(session.simulation) is not None) == ("fly" in jobs)


# --- faults ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "status", "told"),
    [
        ("", -9, "the process that gets it ready ended with status -9"),
        ("numba cannot be imported (No module)\n", 0, "numba cannot be imported (No module)."),
        ("Compiled programs cannot be kept\n", 0, "Compiled programs cannot be kept."),
        ("\n", 0, "what was got ready was not kept"),
    ],
)
def test_a_fault_of_the_compiler_costs_no_run_and_is_said_once(
    app: App, compiler: Compiler, said: str, status: int, told: str
) -> None:
    session = app.session
    session.press("space")
    end(compiler.processes[0], said, status)
    until(app, lambda: bool(session.notice))
    assert told in session.notice
    session.notice, steps = "", session.model.clock.steps
    frames(app, 5)
    assert session.model.clock.steps > steps
    assert session.notice == ""
    assert sum(process.jobs == compiler.processes[0].jobs for process in compiler.processes) == 1


@pytest.mark.parametrize("name", ["app", "large"])
def test_machine_code_that_cannot_be_loaded_costs_no_run(
    name: str, compiler: Compiler, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    app: App = request.getfixturevalue(name)

    def broken(module: GeneratedModule) -> bool:
        raise ImportError("numba needs another NumPy")

    monkeypatch.setattr(GeneratedModule, "load_kept", broken)
    app.session.press("space")
    compiler.compiled = True
    until(app, lambda: "numba needs another NumPy" in app.session.notice)
    frames(app, 3)
    assert app.session.model.clock.steps > 0


def test_nothing_is_compiled_where_that_is_not_wanted(
    compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Choice, "compile", Compile.NEVER)
    window = App(lattice(400, damping=1.0), preparation=Preparation())
    window.session.press("space")
    until(window, lambda: bool(window.session.model.clock.steps > 0))
    window.preparation.close()  # type: ignore[union-attr]
    window.close()
    assert compiler.processes == []
    assert Choice.compile is Compile.NEVER


def test_a_window_leaves_the_choice_of_the_form_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Choice, "compile", Compile.SOON)
    before, window = Choice.compile, Preparation()
    assert Choice.compile is before
    window.open()
    assert Choice.compile is Compile.ELSEWHERE
    window.close()
    assert Choice.compile is before


# --- jobs ------------------------------------------------------------------------------------------------


EDITS = {
    "settings.collisions": True,
    "settings.integrator": "velocity_verlet",
    "rods.temperature_change": 20.0,
    "rods.tension_only": True,
    "rods.hinged": (True, False),
    "rods.distributed_force": (0.0, -2.0),
}
OF_EACH_KIND = ("isostatic", "portal", "ball_on_frame", "hanging_net")
ASSETS = elsewhere._HOME.parent / "assets"
OF_MODS = {
    "magnets": "particles.magnets_pole",
    "stiffening": "rods.stiffening_cubic",
    "wind": "particles.wind_area",
}


@pytest.mark.parametrize("name", models.bundled())
def test_what_another_process_compiles_is_what_the_model_needs(name: str) -> None:
    """Also what it may come to need, such as the program for a hand that pulls."""
    _assert_the_same_there(Session(models.load(name)))
    for column, value in EDITS.items() if name in OF_EACH_KIND else ():
        session = Session(models.load(name))
        edit(session, column, value)
        _assert_the_same_there(session)


def test_what_another_process_compiles_is_what_lessons_need() -> None:
    given = [
        line["model"]
        for file in sorted((ASSETS / "lessons").rglob("*.jsonl"))
        for line in map(json.loads, file.read_text(encoding="utf-8").splitlines())
        if "model" in line
    ]
    assert len(given) > 20
    for model in given:
        _assert_the_same_there(Session(models.load(model)))


@pytest.mark.parametrize("mod", OF_MODS)
def test_what_another_process_compiles_is_what_a_mod_needs(mod: str) -> None:
    before = len(mods.MODS)
    try:
        mods.load_all([ASSETS / "mods" / mod])
        for name in ("isostatic", "portal", "ball_on_truss"):
            session = Session(models.load(name))
            edit(session, OF_MODS[mod], 0.5)
            assert any(system.name.startswith(mod) for system in session.simulation.plan)
            _assert_the_same_there(session)
    finally:
        mods.unload(mods.MODS[before:])


def test_a_model_waits_while_a_law_of_a_mod_acts_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Choice, "compile", Compile.SOON)
    before, window = len(mods.MODS), Preparation()
    try:
        mods.load_all([ASSETS / "mods" / "wind"])
        session = Session(models.load("isostatic"))
        assert window.waits_for(session.simulation) is None
        session.particles["A"].wind_area = 0.5  # type: ignore[attr-defined]
        assert window.waits_for(session.simulation) is not None
        session.undo()
        assert window.waits_for(session.simulation) is None
    finally:
        mods.unload(mods.MODS[before:])
        window.close()


def _assert_the_same_there(session: Session) -> None:
    simulation = session.simulation
    jobs = [*_jobs_of(simulation), *preparation._jobs_later(simulation)]
    document = msgspec.json.encode(models.document(session.model))
    for job in jobs:
        if job[0] not in UNITS:
            here = preparation._module_of(job, simulation)
            assert here is not None
            assert module_of(*parts_of(job, document)).key == here.key


def test_a_large_picture_is_whole_before_its_drawing_is_compiled(app: App, compiler: Compiler) -> None:
    large = App(mesh(10_000), preparation=app.preparation)
    frames(large, 4)
    slowly = pygame.surfarray.array2d(large.render.surface)
    compiler.compiled = True
    until(large, lambda: app.preparation.raster() is not None)
    large.session.view.pointer = (1.0, 1.0)
    frames(large, 1)
    assert large.render.drawn
    background, quickly = slowly[-300, 60], pygame.surfarray.array2d(large.render.surface)
    assert (slowly != background).sum() == pytest.approx((quickly != background).sum(), rel=0.1)


ALONE = (
    '{"format": "pinjoint model", "version": 1, "particles": [{"name": "A", "position": [0, 0]}],'
    ' "settings": {"integrator": "velocity_verlet"}}'  # the quickest to compile
)
BENT = {
    "particles": [
        {"name": "A", "position": [0, 0], "fixed": [True, True], "fixed_rotation": True},
        {"name": "B", "position": [1, 0]},
    ],
    "rods": [{"name": "AB", "between": ["A", "B"], "stiffness": 1e4, "bending_stiffness": 10.0}],
}
CHECK = """
import json, sys
from pinjoint import Session
session = Session.open(json.loads(sys.argv[1]))
session.simulation.program
module = session.simulation.programs.compiled.module
print(module.load_kept())
for entry in (module.form.advance, module.form.observe):
    print(sum(entry.stats.cache_hits.values()), sum(entry.stats.cache_misses.values()))
"""


PLANTED = """
import os, sys
with open(os.environ["PLANTED"], "a") as file:
    print(__name__, os.getpid(), file=file)
"""


@pytest.mark.parametrize("name", ["alone", "bent"])
def test_another_process_compiles_what_this_one_loads(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From nothing that lies in the folder somebody is in."""
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    for variable, value in (folders | {"PLANTED": str(tmp_path / "planted")}).items():
        monkeypatch.setenv(variable, value)
    planted = tmp_path / "models"
    planted.mkdir()
    for module in ("msgspec", "random", "pinjoint", "game", "json", "numpy", "numba", "sitecustomize"):
        (planted / f"{module}.py").write_text(PLANTED, encoding="utf-8")
    monkeypatch.chdir(planted)
    monkeypatch.setattr(sys, "path", ["", str(planted), *sys.path])
    document: dict[str, Any] = json.loads(ALONE)
    if name == "bent":
        document = {**document, **BENT}
    simulation = Session.open(document).simulation
    [job] = _jobs_of(simulation)
    process = elsewhere.started({job: msgspec.json.encode(models.document(simulation.model))}, urgent=True)
    assert process.communicate(timeout=300) == ("\n", None)
    assert process.returncode == 0
    assert not (tmp_path / "planted").exists()
    made: Any = preparation._module_of(job, simulation)
    assert list(tmp_path.rglob(f"{made.key}.types"))
    monkeypatch.chdir(ASSETS)
    done = subprocess.run(
        [sys.executable, "-c", CHECK, json.dumps(document)], check=True, capture_output=True, text=True
    )
    assert done.stdout.split() == ["True", *["1", "0"] * 2]


def test_a_window_goes_on_in_machine_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What another process compiled is what its program loads."""
    for variable in ("XDG_CACHE_HOME", "LOCALAPPDATA", "HOME"):
        monkeypatch.setenv(variable, str(tmp_path))
    folder: Callable[[], Path] = cache.folder.__wrapped__
    kept = folder()
    monkeypatch.setattr(cache, "folder", lambda: kept)
    monkeypatch.setattr(preparation, "AHEAD", ())
    monkeypatch.setattr(preparation, "BY_AN_EDIT", ())
    monkeypatch.setattr(programs, "_modules", {})
    monkeypatch.setattr(Choice, "compile", Compile.SOON)
    window = App(models.load(json.loads(ALONE)), preparation=Preparation())
    try:
        window.session.press("space")
        late = time.monotonic() + 300.0
        programs_of = window.session.simulation.programs
        while not (programs_of.ready and programs_of.compiled.module.is_loaded):
            assert time.monotonic() < late
            assert "slower" not in window.session.notice
            window.frame(1 / 60)
            time.sleep(0.1)
        assert window.session.model.clock.steps > 0
    finally:
        window.preparation.close()  # type: ignore[union-attr]
        window.close()


def test_another_process_speaks_the_language_of_the_window() -> None:
    job, damaged = ("dop853", FEW, ""), b'{"format": "another"}'
    with spoken("pt"):
        process = elsewhere.started({job: damaged}, urgent=True)
        problem = problem_of(job, damaged)
        assert process.communicate(timeout=300)[0] == f"{problem}\n"
    assert problem != problem_of(job, damaged)


def test_what_was_said_is_not_said_again_in_another_language(app: App, compiler: Compiler) -> None:
    end(compiler.processes[0], "", -9)
    until(app, lambda: "status -9" in app.session.notice)
    app.session.notice = ""
    with spoken("pt"):
        frames(app, 5)
    assert app.session.notice == ""
    assert len(cache.SAID) == 1


def test_where_it_is_not_known_what_was_compiled_it_is_compiled_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    module = GeneratedModule("test", lambda: ("", {}))
    cache.write(f"{module.key}.types", b"damaged")
    (tmp_path / f"{module.key}.types").write_bytes(b"cut")
    assert not module.load_kept()
    assert not module.is_compiled()


def test_without_numba_all_jobs_have_the_same_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinjoint.systems.program.machine_code", None)
    problems = {problem_of(job, b"") for job in [("raster",), ("dop853", FEW, "physics.elasticity")]}
    assert len(problems) == 1
    assert "numba cannot be imported" in problems.pop()


SMALL = """
from numba import njit
from pinjoint.systems.program.compiler import entries_to, generated
double = njit(lambda x: 2.0 * x)
print(generated("test", *entries_to({"answer": double})).load().answer(21.0))
"""


def test_processes_that_compile_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", SMALL], env=os.environ | folders, stdout=subprocess.PIPE, text=True
        )
        for _ in range(2)
    ]
    assert [process.communicate(timeout=300)[0].strip() for process in processes] == ["42.0"] * 2
    assert not list(tmp_path.rglob("*.tmp"))


def test_programs_that_nobody_uses_are_forgotten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    (tmp_path / "__pycache__").mkdir()
    for name, age in (("pinjoint_program_old", 61 * 86400), ("pinjoint_program_new", 0)):
        for file in (f"{name}.types", f"{name}.advance-1.code", f"__pycache__/{name}.advance-1.nbi"):
            (tmp_path / file).touch()
        for file in (f"{name}.types", f"{name}.advance-1.code-killed.tmp"):
            (tmp_path / file).touch()
            before = (tmp_path / file).stat().st_mtime - age
            os.utime(tmp_path / file, (before, before))
    forget_unused()
    assert {path.name for path in tmp_path.rglob("*.*")} == {
        "pinjoint_program_new.types",
        "pinjoint_program_new.advance-1.code",
        "pinjoint_program_new.advance-1.code-killed.tmp",
        "pinjoint_program_new.advance-1.nbi",
    }


def test_a_cache_that_cannot_be_written_is_said_once(app: App, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "SAID", ["Compiled programs cannot be kept."])
    frames(app, 1)
    assert app.session.notice == "Compiled programs cannot be kept."
    app.session.notice = ""
    frames(app, 2)
    assert app.session.notice == ""
