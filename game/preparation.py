"""Preparation: says what another process compiles, and whether a model has to wait for that.

Programs begin interpreted, so that most models never wait: see `is_live`.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence, Set
from itertools import islice
from typing import Any

import msgspec

from pinjoint.components.field import Role
from pinjoint.components.language import english
from pinjoint.components.model import Model
from pinjoint.documents.document import document
from pinjoint.documents.format import ModelError
from pinjoint.editor.context import Readiness, Waiting
from pinjoint.elsewhere import UNITS, Elsewhere, Job, Work, in_a_line, problem_of, tell_slower
from pinjoint.systems.base import Law, Phase, StepSystem, System
from pinjoint.systems.collision.driven.neighbours import DRIVEN
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES
from pinjoint.systems.collision.overlaps import PARTING, work_ahead
from pinjoint.systems.edit.pull import Pull
from pinjoint.systems.physics.system import (
    AxialDamping,
    AxialDampingOfCables,
    Drag,
    Elasticity,
    ElasticityAfterYielding,
    Slackness,
)
from pinjoint.systems.plasticity.system import FirstYield, Strength, Yielding
from pinjoint.systems.program import cache
from pinjoint.systems.program.binding import is_our_own
from pinjoint.systems.program.compiler import LARGE, LONGEST_WORK, Choice, Compile, GeneratedModule
from pinjoint.systems.program.program import module_of
from pinjoint.systems.program.writer import kind_of
from pinjoint.systems.render.backends.raster import RASTER, Raster, load_raster
from pinjoint.systems.run.simulation import Simulation

_BEGINNING = 1.5  # s in which the other process gets ready to compile
BY_AN_EDIT: Sequence[
    tuple[Set[str], str]
] = (  # systems that an edit brings, and which one they take the place of
    ({Pull.name}, ""),
    ({ElasticityAfterYielding.name, Strength.name, Yielding.name, FirstYield.name}, Elasticity.name),
    ({"loads.ramp"}, ""),
    ({Slackness.name, AxialDampingOfCables.name}, AxialDamping.name),
    ({Drag.name}, ""),
)
AHEAD = (RASTER, PARTING, DRIVEN, EVENTS, HORIZONS, PILES)  # which any model may come to need


def is_live(model: Model) -> bool:
    """True if a step takes less than a tenth of a second interpreted, so that a run can begin before it is compiled."""
    return max(model.rods.count, model.particles.count if model.rods.count == 0 else 0) <= LARGE


class Preparation(System, Readiness):
    """Has another process compile what the open model runs with, then what it may come to need.

    Runs begin, interpreted, meanwhile, and go on with machine code. What would be too slow waits, and models on which
    kernels of mods act. PINJOINT_COMPILE=always has all models wait, =never none.
    """

    name = "programs.preparation"
    phase = Phase.EVENTS
    reads = ("document", "state")
    writes = ("programs",)
    headless = False

    def __init__(self) -> None:
        self._asked = Choice.compile
        self.elsewhere = Elsewhere(compiles=self._asked is not Compile.NEVER)
        self._frames = 0
        self._works: dict[Job, Work] = {}
        self._needed: dict[Simulation, None] = {}  # what is asked about in this frame, in order
        self._waiting: dict[Job, float] = {}  # what keeps a simulation waiting, and since when
        self._said: set[str] = set()
        self._draws_many = False
        self._worked: tuple[object, tuple[int, int]] = (), (0, 0)  # by a simulation, as it was then
        self._seen = -1  # the model's revision in the last frame
        self._structure = -1  # when anything was made or deleted last, as of the last frame

    def open(self) -> None:
        """Let programs of this process begin interpreted, from now on until `close`."""
        if self._asked is not Compile.NEVER:
            Choice.compile = Compile.ELSEWHERE

    def process(self, frame: Any) -> None:
        """Say what is needed next; and once each, what could not be compiled or kept."""
        simulation = frame.session.simulation
        before, self._structure = self._structure, simulation.model.structure
        # A hand, which modes of a frame hold up for 60 ms.
        follows = frame.session.view.steady and not frame.session.busy
        if before == self._structure and not follows:  # what was made or deleted is seen first
            self._ask(simulation)
            self._compile_here()
            seen, self._seen = self._seen, simulation.model.revision
            if seen == self._seen:
                self._make_program(simulation)
        self._frames += 1
        if self._frames == 2:  # after the first picture
            self.elsewhere.begin()
        for sentence in cache.SAID:
            if english(sentence) not in self._said:
                self._said.add(english(sentence))
                frame.session.notice = sentence
                break

    def _ask(self, simulation: Simulation) -> None:
        """Have compiled and loaded what this frame needed, then what may be needed next."""
        simulations = self._needed | {simulation: None}
        needed = {job: simulation for simulation in simulations for job in self._jobs(simulation)}
        if self._draws_many:
            needed = {(RASTER.name,): simulation} | needed
        later = {job: simulation for job in _jobs_later(simulation) if job not in needed}
        asked, works = needed | later, self._works
        for job in islice((job for job in asked if job not in works), 1):  # finding it takes a part of a frame
            works[job] = Work(job, _module_of(job, asked[job]), b"" if job[0] in UNITS else None)
        self.finding = not works.keys() >= asked.keys()
        if all(job in works for job in needed):  # they are compiled by one process
            self.elsewhere.needed = [works[job] for job in needed]
            self.elsewhere.later = [works[job] for job in later if job in works]
            self._describe(asked)
        for work in (works[job] for job in needed if job in works):
            if not work.told and work.problem:
                work.told = True
                tell_slower(work.problem)
        self._waiting = {job: since for job, since in self._waiting.items() if job in needed}
        self._needed = {}

    def _describe(self, asked: Mapping[Job, Simulation]) -> None:
        """Note of which models the jobs are that the other process is about to do."""
        made: dict[Simulation, bytes] = {}
        for work in self._works.values():
            if work.job not in asked and work.document:
                work.document = None
        for work in self.elsewhere.lacking:
            try:
                if (by := asked.get(work.job)) is not None:
                    work.document = made[by] = made.get(by) or msgspec.json.encode(document(by.model))
            except ModelError as error:
                work.ended = in_a_line(error)

    def _make_program(self, simulation: Simulation) -> None:
        """Make the program before a key needs it: it is loaded, or rewritten by the thread, so that this is quick."""
        if not simulation.programs.ready and self.waits_for(simulation) is None:
            works = [self._works.get(job) for job in _jobs_of(simulation)]
            if all(work and work.module and self.elsewhere.is_ready(work.module) for work in works):
                simulation.program  # noqa: B018 (it is made when asked for)

    def _compile_here(self) -> None:
        """Compile what something waits for and the other process could not hand over, after a picture that says so."""
        for work in [self._works[job] for job in self._waiting if job in self._works]:
            if work.problem and not work.given_up:
                work.given_up = True
                tell_slower(problem_of(work.job, work.document or b""))
                return

    # --- what waits ----------------------------------------------------------------------------------

    @property
    def readies(self) -> bool:
        modules = (work.module for work in self.elsewhere.needed if not work.problem)
        return self.elsewhere.can_load and any(
            module is not None and not module.is_loaded for module in modules
        )

    def waits_for(self, simulation: Simulation) -> Waiting | None:
        self._needed[simulation] = None
        if self._asked is Compile.NEVER:
            return None
        parting, impacts = self._work_ahead(simulation)
        if (
            self._asked is not Compile.ALWAYS
            and is_live(simulation.model)
            and impacts <= 2**20  # operations, about a second: others are worth half a minute's wait to compile
            and all(map(is_our_own, simulation.plan))
        ):
            jobs: list[Job] = [(PARTING.name,)] if parting > LONGEST_WORK else []
        else:  # finding them takes the modes of a small model: 13 ms in each frame of a drag in pause
            jobs = self._jobs(simulation)
        left = [job for job in jobs if not self._is_ready(job)]
        if not left:
            return None
        now = time.monotonic()
        since = min(self._waiting.setdefault(job, now) for job in left)
        works = (self._works[job] for job in left if job in self._works)
        modules = (work.module for work in works if work.module is not None and not work.module.is_compiled())
        return Waiting(now - since, _BEGINNING + sum(module.expected_seconds() for module in modules))

    def _jobs(self, simulation: Simulation) -> list[Job]:
        """What a simulation runs with, and what parts its overlaps before, if that takes long."""
        parts = self._work_ahead(simulation)[0] > LONGEST_WORK
        return [*([(PARTING.name,)] if parts else []), *_jobs_of(simulation)]

    def _work_ahead(self, simulation: Simulation) -> tuple[int, int]:
        """Operations of the longest calls ahead; what touches is looked up after edits, not in the course of a run."""
        model, armed = simulation.model, simulation.armed
        seen = (
            simulation,
            armed,
            simulation.armed_revision if armed else model.newest(Role.DOCUMENT, Role.STATE),
        )
        if seen != self._worked[0]:
            self._worked = seen, work_ahead(model) if simulation.programs.collides else (0, 0)
        parting, impacts = self._worked[1]
        return 0 if armed else parting, impacts

    def _is_ready(self, job: Job) -> bool:
        """True if nothing has to wait for a job: it is loaded, or cannot be."""
        work = self._works.get(job)
        if work is None:
            return False
        return work.module is None or work.module.is_loaded or work.given_up or not self.elsewhere.can_load

    def raster(self) -> Raster | None:
        """The raster of large pictures, as soon as it is loaded."""
        self._draws_many = True
        return load_raster() if RASTER.is_loaded else None

    def close(self) -> None:
        """Let go of what is still being compiled."""
        self.elsewhere.close()
        Choice.compile = self._asked


# --- jobs ------------------------------------------------------------------------------------------------


def _jobs_of(simulation: Simulation) -> list[Job]:
    """What a simulation runs with, and what it will once something rests on a structure."""
    model, plan = simulation.model, simulation.plan
    if simulation.integrator.exact:
        # laws, such as a hand that pulls, and constant forces press particles together for long
        piles = any(isinstance(system, Law) for system in plan) or model.particles.constant_force.any()
        return [(unit.name,) for unit in (EVENTS, HORIZONS, *([PILES] if piles else []))]
    jobs = [_job(simulation, plan)]
    if simulation.programs.collides:  # particles that do not fly free may meet
        jobs.append((DRIVEN.name,))
    return jobs


def _jobs_later(simulation: Simulation) -> Iterator[Job]:
    """What a simulation may come to need: a program for what one edit brings, the likeliest first; and all units."""
    if not simulation.integrator.exact:
        present = {system.name for system in simulation.plan}
        for brought, replaced in BY_AN_EDIT:
            if not brought <= present and (not replaced or replaced in present):
                yield _job(simulation, simulation.schedule.named((brought | present) - {replaced}))
    yield from ((unit.name,) for unit in AHEAD)


def _job(simulation: Simulation, plan: Sequence[StepSystem]) -> Job:
    return kind_of(simulation.model, simulation.integrator, plan)


def _module_of(job: Job, simulation: Simulation) -> GeneratedModule | None:
    """What a job of a simulation is about; a step program is written for that. None if it cannot be."""
    if job[0] in UNITS:
        return UNITS[job[0]]
    try:
        plan = simulation.schedule.named(job[3:])
        return module_of(simulation.model, plan, simulation.integrator, job[1])
    except Exception:  # of a mod, which is told of when the program is needed
        cache.LOG.info("A program cannot be written.", exc_info=True)
        return None
