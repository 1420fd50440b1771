"""A window goes on while its step program is compiled elsewhere, and what was compiled there is used."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

import pygame
import pytest

from components.field import Role
from game import preparation
from game.app import App
from game.documents import models
from game.editor.view_model import COMPILING
from game.preparation import Preparation
from game.prepare import Job, _example
from game.session import Session
from systems import cache
from systems.collision.driven import compiled as driven_kernels
from systems.input import pygame_input
from systems.program.compiler import GeneratedModule, forget_unused
from systems.program.program import _writer
from systems.program.writer import FEW, form_of


class Compiler:
    """In place of the process that compiles: it ends when told to."""

    def __init__(self) -> None:
        self.jobs: list[tuple[str, ...]] = []
        self.status: int | None = None

    def start(self, job: tuple[str, ...]) -> Compiler:
        self.jobs.append(job)
        return self

    def poll(self) -> int | None:
        return self.status


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch) -> Compiler:
    """Nothing is compiled yet."""
    found = Compiler()
    monkeypatch.setattr(preparation, "_started", found.start)
    monkeypatch.setattr(preparation, "has_program", lambda *plan: False)
    monkeypatch.setattr(GeneratedModule, "is_compiled", lambda unit: False)
    monkeypatch.setattr(preparation, "is_blank", lambda: False)
    monkeypatch.setattr(preparation, "AHEAD", ())
    return found


@pytest.fixture
def app(monkeypatch: pytest.MonkeyPatch, compiler: Compiler) -> Iterator[App]:
    monkeypatch.setattr(pygame_input, "IDLE_PAUSE", 0.0)
    window = App(models.load("isostatic"), preparation=Preparation())
    frames(window, 3)
    window.preparation._compiler.join()  # type: ignore[union-attr]
    frames(window, 1)
    yield window
    window.close()


def frames(app: App, count: int) -> None:
    for _ in range(count):
        app.frame(1 / 60)


def test_it_begins_with_the_model_that_is_open(app: App, compiler: Compiler) -> None:
    (job,) = compiler.jobs
    plan = app.session.simulation.plan
    assert job == (app.session.simulation.integrator.key, FEW, *(system.name for system in plan))


def test_on_a_first_start_it_begins_before_the_compiler_is_loaded(
    monkeypatch: pytest.MonkeyPatch, compiler: Compiler
) -> None:
    monkeypatch.setattr(preparation, "is_blank", lambda: True)
    window = App(models.load("isostatic"), preparation=Preparation())
    frames(window, 1)
    assert len(compiler.jobs) == 1
    compiler.status = 0
    frames(window, 1)
    assert window.session.model.clock.steps == 0
    assert not window.session.view.forces_known  # what is compiled cannot be loaded yet


def test_where_particles_may_meet_that_is_waited_for_too(app: App, compiler: Compiler) -> None:
    session = app.session
    session.open_here("ball_on_truss")
    frames(app, 1)
    program, driven, resting = compiler.jobs[1:]
    assert program[0] == session.simulation.integrator.key
    assert driven == ("driven_collisions",)
    assert resting == (*program, "collision.support")  # from when on the ball lies on the truss
    session.press("space")
    frames(app, 3)
    assert session.model.clock.steps == 0
    compiler.status = 0
    frames(app, 4)
    assert session.model.clock.steps > 0
    loaded = driven_kernels.kernels()  # though nothing has met yet
    for name in ("gaps", "kinds", "path_deviation", "time_of_impact", "compliance", "forces", "resolve"):
        assert getattr(loaded, name).signatures


def test_a_model_in_which_nothing_is_loose_does_not_wait_for_what_may_rest_on_it(
    app: App, compiler: Compiler
) -> None:
    app.session.open_here("warren_bridge")
    frames(app, 1)
    assert ("driven_collisions",) in compiler.jobs
    assert not any("collision.support" in job for job in compiler.jobs)


def test_what_other_models_may_need_comes_when_nothing_else_is_compiled(
    monkeypatch: pytest.MonkeyPatch, app: App, compiler: Compiler
) -> None:
    units = tuple((GeneratedModule(name, lambda: ("", {})),) for name in ("one", "two", "three"))
    monkeypatch.setattr(preparation, "AHEAD", units)
    monkeypatch.setattr(GeneratedModule, "is_compiled", lambda unit: unit.name == "two")
    frames(app, 2)
    assert len(compiler.jobs) == 1
    compiler.status = 0
    frames(app, 4)
    assert compiler.jobs[-2:] == [("one",), ("three",)]


def test_a_run_waits_and_says_so_and_goes_on(app: App, compiler: Compiler) -> None:
    session = app.session
    session.press("space")
    frames(app, 3)
    session.press("i")  # a key meanwhile
    frames(app, 3)
    assert session.model.clock.steps == 0
    assert session.view.status.notice.startswith(COMPILING)
    assert session.view.status.state == "preparing"
    assert not session.view.forces_known
    compiler.status = 0
    frames(app, 3)
    assert session.model.clock.steps > 0
    assert session.view.status.state == "running"
    assert session.view.status.notice == ""
    assert session.view.forces_known
    assert compiler.jobs[1] == (*compiler.jobs[0], "edit.pull")  # next, in case that it is pulled


def test_while_a_run_waits_frames_are_few(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They would take a fifth of a core from what compiles."""
    looks: list[float] = []
    monkeypatch.setattr(time, "sleep", looks.append)
    app.session.press("space")
    frames(app, 2)
    looks.clear()
    frames(app, 1)
    assert len(looks) == pygame_input.WAITING_LOOKS
    compiler.status = 0
    frames(app, 3)
    looks.clear()
    frames(app, 1)
    assert app.session.view.status.state == "running"
    assert looks == []


def test_what_cannot_be_compiled_there_is_compiled_here(app: App, compiler: Compiler) -> None:
    compiler.status = 1
    app.session.press("space")
    frames(app, 3)
    assert app.session.model.clock.steps > 0


def test_what_is_compiled_is_loaded_before_a_key_needs_it(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    for rod in app.session.rods:
        rod.tensile_strength = rod.compressive_strength = None  # so that no picture needs the program
    simulation, before = app.session.simulation, app.session.model.newest(Role.DOCUMENT)
    saved = app.session.document.unsaved
    compiler.status = 0
    frames(app, 2)
    assert (
        not simulation.programs.ready
    )  # it could not be compiled there; here it is when it must be, not before
    monkeypatch.setattr(preparation, "has_program", lambda *plan: True)
    frames(app, 1)
    assert simulation.programs.ready
    assert app.session.model.newest(Role.DOCUMENT) == before
    assert app.session.document.unsaved == saved


def test_what_a_hand_needs_is_loaded_while_nothing_happens(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    loaded: list[Job] = []
    monkeypatch.setattr(preparation, "is_prepared", lambda job: True)
    monkeypatch.setattr(preparation, "load_program", loaded.append)
    session = app.session
    session.press("space")
    compiler.status = 0
    frames(app, 6)
    assert session.model.clock.steps > 0
    assert loaded == []  # it would hold up a picture
    session.press("space")
    frames(app, 6)
    assert loaded == [(*compiler.jobs[0], "edit.pull")]


@pytest.mark.parametrize("name", ["isostatic", "tower", "ball_on_truss", "hanging_net"])
@pytest.mark.parametrize("warmth", [0.0, 20.0])
def test_what_another_process_compiles_is_what_the_model_needs(name: str, warmth: float) -> None:
    session = Session(models.load(name))
    session.model.assign(list(session.rods), "temperature_change", warmth)
    simulation = session.simulation
    plan = session.simulation.plan
    example, same_plan, integrator, form = _example(preparation._job(simulation, plan))
    there = _writer(example.model, same_plan, integrator, form)
    here = _writer(session.model, plan, simulation.integrator, form_of(session.model, simulation.integrator))
    assert there.source() == here.source()
    assert there.names == here.names


def test_free_particles_have_their_program_loaded_too(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(GeneratedModule, "is_compiled", lambda unit: True)
    app.session.adopt(models.load("collision_i"))
    compiler.status = 0
    frames(app, 3)
    assert app.session.simulation.programs.ready


def test_what_free_particles_need_is_compiled_by_two_processes_at_once(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled = set[str]()
    monkeypatch.setattr(GeneratedModule, "is_compiled", lambda unit: unit.name in compiled)
    app.session.adopt(models.load("collision_i"))
    frames(app, 2)
    assert compiler.jobs[1:] == [("fly",), ("open_horizon",)]
    compiled.add("fly")
    app.session.press("space")
    frames(app, 2)
    assert app.session.model.clock.steps == 0  # for want of the other half
    compiler.status = 0
    frames(app, 3)
    assert app.session.model.clock.steps > 0


def test_what_piles_need_is_waited_for_once_something_pulls(
    app: App, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(GeneratedModule, "is_compiled", lambda unit: unit.name != "take_steps")
    app.session.adopt(models.load("collision_i"))
    app.session.press("space")
    frames(app, 4)
    steps = app.session.model.clock.steps
    assert steps > 0
    app.session.environment.acceleration = (0.0, -9.81)
    frames(app, 3)
    assert compiler.jobs[1:] == [("open_horizon", "take_steps")]
    assert app.session.model.clock.steps == steps
    compiler.status = 0
    frames(app, 3)
    assert app.session.model.clock.steps > steps


def test_stepping_waits_too(app: App, compiler: Compiler) -> None:
    app.session.press(".")
    frames(app, 1)
    assert app.session.model.clock.steps == 0
    assert app.session.view.status.notice.startswith(COMPILING)
    compiler.status = 0
    app.session.press(".")
    assert app.session.model.clock.steps == 1


def test_the_force_method_waits_too(app: App, compiler: Compiler) -> None:
    session = app.session
    session.press("k")
    frames(app, 2)
    (structure,) = session.scenes.active.guide.moving  # type: ignore[attr-defined]
    assert not structure.view.forces_known
    assert structure.model.clock.steps == 0
    assert session.view.status.notice.startswith(COMPILING)
    compiler.status = 0
    frames(app, 3)
    assert structure.view.forces_known
    assert structure.model.clock.steps > 0


def test_a_large_picture_is_a_sketch_until_its_drawing_is_compiled(app: App, compiler: Compiler) -> None:
    from tests.benchmarks.models import mesh

    large = App(mesh(10_000), preparation=app.preparation)
    frames(large, 4)
    assert not large.render.drawn
    assert ("raster",) in compiler.jobs
    sketch = pygame.surfarray.array2d(large.render.surface)
    compiler.status = 0
    frames(large, 1)
    assert large.render.drawn
    whole = pygame.surfarray.array2d(large.render.surface)
    frames(large, 1)
    assert not large.render.drawn
    background = whole[-300, 60]
    assert (whole != background).sum() > 1.5 * (sketch != background).sum()


ALONE = '{"format": "pinjoint model", "version": 1, "particles": [{"name": "A", "position": [0, 0]}]}'
CHECK = f"""
from game import Session
session = Session.open({ALONE})
session.simulation.program
module = session.simulation.programs.compiled.module
for entry in (module.advance, module.observe):
    print(sum(entry.stats.cache_hits.values()), sum(entry.stats.cache_misses.values()))
"""


def test_another_process_compiles_what_this_one_loads(tmp_path: Path) -> None:
    session = Session.open(json.loads(ALONE))
    names = [system.name for system in session.simulation.plan]
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    command = [
        sys.executable,
        "-m",
        "game.prepare",
        "--no-mods",
        session.simulation.integrator.key,
        FEW,
        *names,
    ]
    subprocess.run(command, env=os.environ | folders, check=True, timeout=300)
    assert list(tmp_path.rglob("pinjoint_program_*.done"))
    done = subprocess.run(
        [sys.executable, "-c", CHECK], env=os.environ | folders, check=True, capture_output=True, text=True
    )
    assert done.stdout.split() == ["1", "0"] * 2


SMALL = """
from numba import njit
from systems.program.compiler import generated
double = njit(lambda x: 2.0 * x)
source = "from systems.kernels import kept\\n\\n@kept()\\ndef answer(x):\\n    return kernel(x)\\n"
print(generated("test", source, {"kernel": double}).load().answer(21.0))
"""


def test_processes_that_compile_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", SMALL], env=os.environ | folders, stdout=subprocess.PIPE, text=True
        )
        for _ in range(4)
    ]
    assert [process.communicate(timeout=300)[0].strip() for process in processes] == ["42.0"] * 4
    assert not list(tmp_path.rglob("*.tmp"))


def test_programs_that_nobody_uses_are_forgotten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    (tmp_path / "__pycache__").mkdir()
    for name, age in (("pinjoint_program_old", 61 * 86400), ("pinjoint_program_new", 0)):
        for file in (f"{name}.done", f"{name}.advance-1.code", f"__pycache__/{name}.advance-1.nbi"):
            (tmp_path / file).touch()
        for file in (f"{name}.done", f"{name}.advance-1.code-killed.tmp"):
            (tmp_path / file).touch()
            before = (tmp_path / file).stat().st_mtime - age
            os.utime(tmp_path / file, (before, before))
    forget_unused()
    assert {path.name for path in tmp_path.rglob("*.*")} == {
        "pinjoint_program_new.done",
        "pinjoint_program_new.advance-1.code",
        "pinjoint_program_new.advance-1.code-killed.tmp",
        "pinjoint_program_new.advance-1.nbi",
    }


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="folders have owners on POSIX systems only")
def test_a_folder_of_somebody_else_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What lies in the cache is run: one that another person made where all may write is left alone."""
    monkeypatch.setattr(cache, "user_cache_path", lambda name: tmp_path / "blocked")
    (tmp_path / "blocked").write_text("not a folder")
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    find: Callable[[], Path] = cache.folder.__wrapped__
    assert find().parent != tmp_path or find().name != "pinjoint-programs-12345"


PARTS = """
from systems.collision.free.discs import EVENTS, PILES, HORIZONS, engine

engine()
print(*(unit.is_compiled() for unit in (EVENTS, HORIZONS, PILES)))
"""


def test_parts_that_nobody_has_called_are_not_taken_for_compiled(tmp_path: Path) -> None:
    """The window compiled the steps of piles itself, and stood still for 8 s, for discs that cannot pile up."""
    folders = {"XDG_CACHE_HOME": str(tmp_path), "LOCALAPPDATA": str(tmp_path), "HOME": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", PARTS],
        env=os.environ | folders,
        check=True,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.stdout.split() == ["False"] * 3


def test_a_cache_that_cannot_be_written_is_said_once(app: App, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "TROUBLE", ["Compiled programs cannot be kept."])
    frames(app, 1)
    assert app.session.notice == "Compiled programs cannot be kept."
    app.session.notice = ""
    frames(app, 2)
    assert app.session.notice == ""
