"""Preparation: says what another process compiles, and whether a model has to wait for that.

Programs begin interpreted, so that most models never wait: see `is_live`.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from itertools import islice
from typing import Any

from pinjoint.components.field import Role
from pinjoint.components.language import english, tr
from pinjoint.components.model import Model
from pinjoint.documents.format import ModelError
from pinjoint.editor.context import Waiting
from pinjoint.elsewhere import Elsewhere, slower
from pinjoint.prepare import UNITS, Job, described, in_a_line, problem_of
from pinjoint.systems import cache
from pinjoint.systems.base import Law, Phase, StepSystem, System
from pinjoint.systems.collision.driven.compiled import DRIVEN
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES
from pinjoint.systems.collision.free.flight import may_pile
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
from pinjoint.systems.program.binding import is_our_own
from pinjoint.systems.program.compiler import (
    LARGE,
    LOG,
    LONGEST_WORK,
    UNCOMPILED,
    Choice,
    Compile,
    GeneratedModule,
    tell,
)
from pinjoint.systems.program.program import module_of
from pinjoint.systems.program.writer import form_of, traits_of
from pinjoint.systems.render.raster import RASTER, Raster, load_raster
from pinjoint.systems.run.simulation import Simulation

LONGEST_IMPACT = 2**20  # operations, about a second: a window waits half a minute to compile what takes longer
BEGINNING = 1.5  # s in which the other process gets ready to compile
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


class Preparation(System):
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
        self._modules: dict[Job, GeneratedModule | None] = {}  # None: it cannot be written
        self._documents: dict[Job, bytes] = {}  # of models, for the other process
        self._needed: dict[Job, Simulation] = {}  # by this frame, in order, and by what
        self._waiting: dict[Job, float] = {}  # what keeps a simulation waiting, and since when
        self._given_up: set[Job] = set()  # of these: what cannot be compiled at all
        self._told: set[Job] = set()  # of these: what went wrong with them, in the language of then
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
        if before == self._structure:  # what was made or deleted is seen first
            self._ask(simulation)
            self._compile_here()
            seen, self._seen = self._seen, simulation.model.revision
            if seen == self._seen:
                self._make_program(simulation)
        self._frames += 1
        if self._frames == 2:  # after the first picture
            self.elsewhere.begin()
        self._tell(frame.session)

    def _ask(self, simulation: Simulation) -> None:
        """Have compiled and loaded what this frame needed, then what may be needed next."""
        needed = self._needed | dict.fromkeys(self._jobs(simulation), simulation)
        if self._draws_many:
            needed = {(RASTER.name,): simulation} | needed
        later = {job: simulation for job in _jobs_later(simulation) if job not in needed}
        unknown = ((job, by) for job, by in (needed | later).items() if job not in self._modules)
        for job, by in islice(unknown, 1):  # finding it takes a part of a frame
            self._modules[job] = _module_of(job, by)
        if (found := self._known(needed)) is not None:
            self._describe(needed | later)
            self.elsewhere.ask(found, self._known(later) or {}, self._documents)
        for job in needed:
            if job not in self._told and (problem := self._problem_of(job)):
                self._told.add(job)
                tell(slower(problem))
        self._waiting = {job: since for job, since in self._waiting.items() if job in needed}
        self._needed = {}

    def _describe(self, jobs: Mapping[Job, Simulation]) -> None:
        """Note of which models the jobs are that the other process is about to do."""
        self._documents = {job: document for job, document in self._documents.items() if job in jobs}
        made: dict[Simulation, bytes] = {}
        for job in self.elsewhere.lacking:
            try:
                if (by := jobs.get(job)) is not None:
                    self._documents[job] = made[by] = made.get(by) or described(by.model)
            except ModelError as error:
                self.elsewhere.ended[job] = in_a_line(error)

    def _known(self, jobs: Iterable[Job]) -> dict[Job, GeneratedModule] | None:
        """The modules of jobs, once all are known: they are compiled by one process."""
        if any(job not in self._modules for job in jobs):
            return None
        return {job: module for job in jobs if (module := self._modules[job]) is not None}

    def _make_program(self, simulation: Simulation) -> None:
        """Make the program before a key needs it: it is loaded, or rewritten by the thread, so that this is quick."""
        if not simulation.programs.ready and self.waits_for(simulation) is None:
            modules = [self._modules.get(job) for job in _jobs_of(simulation)]
            if all(module is not None and self.elsewhere.is_ready(module) for module in modules):
                simulation.program  # noqa: B018 (it is made when asked for)

    def _compile_here(self) -> None:
        """Compile what something waits for and the other process could not hand over, after a picture that says so."""
        for job in self._waiting:
            if self._problem_of(job) and job not in self._given_up:
                self._given_up.add(job)
                if problem := problem_of(job, self._documents.get(job, b"")):
                    tell(slower(problem))
                return

    def _tell(self, session: Any) -> None:
        for sentence in (*cache.REFUSED, *cache.TROUBLE, *UNCOMPILED):
            if english(sentence) not in self._said:
                self._said.add(english(sentence))
                session.notice = sentence
                return

    def _problem_of(self, job: Job) -> str:
        """Why a job cannot be had from the other process; "" if it can, as far as is known."""
        problem, module = self.elsewhere.ended.get(job), self._modules.get(job)
        if problem is None or module is None or module.is_compiled():
            return ""
        return problem or tr("what was compiled was not kept")

    # --- what waits ----------------------------------------------------------------------------------

    def waits_for(self, simulation: Simulation) -> Waiting | None:
        """What a simulation waits for; None if it can go on, interpreted or compiled."""
        jobs = self._jobs(simulation)
        self._needed |= dict.fromkeys(jobs, simulation)
        if self._asked is Compile.NEVER:
            return None
        parting, impacts = self._work_ahead(simulation)
        if (
            self._asked is not Compile.ALWAYS
            and is_live(simulation.model)
            and impacts <= LONGEST_IMPACT
            and all(map(is_our_own, simulation.plan))
        ):
            jobs = [(PARTING.name,)] if parting > LONGEST_WORK else []
        left = [job for job in jobs if not self._is_ready(job)]
        if not left:
            return None
        now = time.monotonic()
        since = min(self._waiting.setdefault(job, now) for job in left)
        modules = [module for job in left if (module := self._modules.get(job)) and not module.is_compiled()]
        expected = BEGINNING + sum(module.expected_seconds() for module in modules)
        return Waiting(now - since, expected)

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
            collides = any(system.impulsive for system in simulation.plan)
            self._worked = seen, work_ahead(model) if collides else (0, 0)
        parting, impacts = self._worked[1]
        return 0 if armed else parting, impacts

    def _is_ready(self, job: Job) -> bool:
        """True if nothing has to wait for a job: it is loaded, or cannot be."""
        if job not in self._modules:
            return False
        module, given_up = self._modules[job], job in self._given_up or not self.elsewhere.can_load
        return module is None or module.is_loaded or given_up

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
        piles = may_pile(model, any(isinstance(system, Law) for system in plan))
        return [(unit.name,) for unit in (EVENTS, HORIZONS, *([PILES] if piles else []))]
    jobs = [_job(simulation, plan)]
    if any(system.impulsive for system in plan):  # particles that do not fly free may meet
        jobs.append((DRIVEN.name,))
    return jobs


def _jobs_later(simulation: Simulation) -> Iterator[Job]:
    """What a simulation may come to need: a program for what one edit brings, the likeliest first; and all units."""
    if not simulation.integrator.exact:
        present = {system.name for system in simulation.plan}
        for brought, replaced in BY_AN_EDIT:
            if not brought <= present and (not replaced or replaced in present):
                yield _job_with(simulation, brought, without=replaced)
    yield from ((unit.name,) for unit in AHEAD)


def _job_with(simulation: Simulation, names: Set[str], without: str = "") -> Job:
    present = {system.name for system in simulation.plan}
    return _job(simulation, simulation.schedule.named((names | present) - {without}))


def _job(simulation: Simulation, plan: Sequence[StepSystem]) -> Job:
    form = form_of(simulation.model, simulation.integrator, plan)
    traits = " ".join(traits_of(simulation.model))
    return simulation.integrator.key, form, traits, *(system.name for system in plan)


def _module_of(job: Job, simulation: Simulation) -> GeneratedModule | None:
    """What a job of a simulation is about; a step program is written for that. None if it cannot be."""
    if job[0] in UNITS:
        return UNITS[job[0]]
    try:
        plan = simulation.schedule.named(job[3:])
        return module_of(simulation.model, plan, simulation.integrator, job[1])
    except Exception:  # of a mod, which is told of when the program is needed
        LOG.info("A program cannot be written.", exc_info=True)
        return None
