"""The contract that our systems and a modder's share.

A law is a declaration and a kernel, a function of one row:

>>> from pinjoint.systems.program.kernel import compiled
>>> @compiled
... def weight(particles_mass):
...     return 0.0, -0.00981 * particles_mass
>>> class Weight(Law):
...     name = "example.weight"
...     each = "particles"
...     kernel = weight
...     reads = ("particles.mass",)
>>> Weight().phase.value
'step'
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from enum import Enum, IntEnum
from typing import Any, ClassVar, Protocol

import esper
import numpy as np
from numpy.typing import NDArray

from pinjoint.components.handle import Handle
from pinjoint.components.language import marked, tr
from pinjoint.components.mistake import wrong_variable
from pinjoint.components.model import Model
from pinjoint.systems.program.entries import ACCOUNTS

__all__ = [
    "ACCOUNTS",
    "CORES",
    "DEFAULT_LIMIT",
    "EVENT_INTERVAL",
    "MOST_PARTS",
    "REVIEW_INTERVAL",
    "Commit",
    "Event",
    "Integrator",
    "Law",
    "Mod",
    "Phase",
    "StepSystem",
    "StopReason",
    "System",
    "cores",
]


class Phase(Enum):
    """The parts of a frame, in order. A frame is `for phase in Phase: schedule.run(phase, frame)` and nothing else."""

    INPUT = "input"  # input devices report pressed keys and buttons
    EDIT = "edit"  # presses become actions, actions become commands; scenes change; hovering
    STEP = "step"  # time passes; laws, commits, events and the integrator are compiled into one program
    EVENTS = "events"  # what follows from what happened in the steps: probes, autosave, edits by mods
    RENDER = "render"  # the view is brought up to date, and drawn; the model is only read


class StopReason(IntEnum):
    """Why a step program returned."""

    DONE = 0  # took all the steps it was asked for
    REVIEW = 1  # a fixed number of steps since the step size was last reviewed
    REST = 2  # nothing moves any more
    DIVERGED = 3  # energy came from nowhere, or a number is not finite
    UNRESOLVED = 4  # no step, however small, has a finite result, or too many small ones lead to its end
    EVENT = 5  # the quantity of an Event changed sign
    FAILED = 6  # a kernel raised an error


class Mod(Protocol):
    """The extension that brought a system; see game/mods/mod.py."""

    @property
    def included(self) -> bool:
        """True if it comes with the program."""

    @property
    def off(self) -> bool:
        """True if it was left out or switched off."""

    def switch_off(self, reason: str, error: BaseException | None = None) -> None:
        """Call no code of the mod any more."""

    def aside(self) -> AbstractContextManager[None]:
        """As if it were switched off, inside the `with`."""


CORES = "PINJOINT_CORES"  # of the environment: how many threads and processes compute
DEFAULT_LIMIT = 60.0  # s of simulated time in which a model is expected to come to rest
REVIEW_INTERVAL = 8192  # steps between reviews of the step size, and between safe states
MOST_PARTS = 512  # of a step that are taken to show a moment within it
EVENT_INTERVAL = 16  # steps, at multiples of which systems of phase EVENTS run where there are no frames
_home = os.getpid()


def cores() -> int:
    """Number of cores that a computation may use: by PINJOINT_CORES, else as many as this process may. Raises Mistake.

    One in a process that was forked, for the threads of its parent are not there.
    """
    there = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    asked = os.environ.get(CORES) or str(there)
    if not re.fullmatch("0*[1-9][0-9]{0,8}", asked):
        raise wrong_variable(CORES, tr("a whole number of at least 1"))
    return min(int(asked), there) if os.getpid() == _home else 1


class System(esper.Processor):  # type: ignore[misc,unused-ignore]
    """Behaviour, run once in every frame of the scenes it is active in.

    name: qualified, such as "physics.elasticity"; unique.
    title: what undo calls its edits, such as "break"; "": its name.
    before, after: names of systems in the same phase that must run later, earlier.
    reads, writes: columns ("particles.velocity") or named resources ("view") it touches. Two systems of a phase
        that touch the same thing, one writing, must be ordered by before/after.
    adds: columns that it adds to; additions never conflict.
    replaces: names of systems, or of their families such as "plasticity", that it takes the place of: where it is
        active and needed, they are left out.
    scenes: names of the scenes it is active in; None: all. A scene may name further systems (`Scene.systems`).
    unneeded: why a model for which `needs` is False leaves the system out, such as "the model has no cables".
    headless: of a system in phase EVENTS: it also runs where there are no frames, in `Session.run` and on the
        command line, every EVENT_INTERVAL steps and at the end of a run; only an Event acts at the same instant
        however a run is divided.
    mod: the mod that brought it, if one did; set by the program.
    """

    name: ClassVar[str] = ""
    title: ClassVar[str] = ""
    phase: ClassVar[Phase] = Phase.EDIT
    before: ClassVar[tuple[str, ...]] = ()
    after: ClassVar[tuple[str, ...]] = ()
    reads: ClassVar[tuple[str, ...]] = ()
    writes: ClassVar[tuple[str, ...]] = ()
    adds: ClassVar[tuple[str, ...]] = ()
    replaces: ClassVar[tuple[str, ...]] = ()
    scenes: ClassVar[tuple[str, ...] | None] = None
    unneeded: ClassVar[str] = marked("the model has nothing for it to do")
    headless: ClassVar[bool] = True
    mod: Mod | None = None

    def needs(self, model: Model) -> bool:
        """False if this model has nothing for the system to do; it is then left out of the plan."""
        return True

    def process(self, frame: Any) -> None:
        """Do one frame's work. `frame` is the running session's frame."""
        raise NotImplementedError


class StepSystem(System):
    """Compiled behaviour inside the steps: a law, a commit, an event or an integrator.

    kernel: "module:function" of a function with @compiled above it, or the function itself. Its parameters are
        bound by name: `<table>_<column>`, `time`, `dt`, an entry of `arrays`, or one of the quantities
        that the role provides. "": the system adds nothing to the step program.
    impulsive: it acts at instants, by impacts of particles (systems/collision), at which steps have to end.
    """

    phase: ClassVar[Phase] = Phase.STEP
    scenes: ClassVar[tuple[str, ...] | None] = ("simulation", "force method")
    kernel: ClassVar[str | Callable[..., Any]] = ""
    impulsive: ClassVar[bool] = False

    def leaves_flight_exact(self, model: Model) -> bool:
        """True if particles fly on exact paths between impacts all the same, for which no integrator is needed.

        A law that does so gives its forces by `held_forces`.
        """
        return False

    def arrays(self, model: Model) -> Mapping[str, NDArray[Any]]:
        """Further read-only arrays for the kernel, renewed whenever the document changes."""
        return {}

    def process(self, frame: Any) -> None:
        """Step systems run inside the step program, not frame by frame."""


class Law(StepSystem):
    """Forces from a (trial) state; pure.

    each = "rods": the kernel maps scalars of one rod to an axial force (kN). Provided are `elongation` (m),
        `rate` (m/s, of elongation) and `axial_force`. Laws without `rate` add up in order of name. A law
        that takes `axial_force` is then given the sum and its result replaces it; several, in the order
        of the schedule. Laws with `rate` add up beside it and may take the result.
    each = "particles": maps one particle's values (vectors as pairs) to a force (x, y).
    each = "pairs": maps what two particles have that are nearer to each other than `cutoff` to the force (x, y) on the
        first; the second gets the opposite one. Provided are `apart` (m, from the first to the second) and `drift`
        (m/s, its rate); columns of the particles come as pairs, of the first and of the second.
    each = "ends": maps the slopes of a rod's ends to its chord (`slope_start`, `slope_end`, rad) to the moments on its
        ends (M_start, M_end), counter-clockwise. Provided is also `axial_force`, which adds moments by the bow of the axis
        by itself. Laws with `rate_start` or `rate_end` (rad/s, of the slopes) add up beside the others. One that takes
        `moment_start` and `moment_end`, the sum of all, tells instead how far the ends slip in plastic hinges (rad);
        `limit_start`, `limit_end` (kN·m) and `thrust` (N L₀) are provided to it.
    each = "rotations": maps one particle's values to a moment that resists its turning.
    each = "loads": `factor(time, values, first)`; `arrays` gives `<name>_on`, `_force`, `_values`, `_first`.
    account: where the energy goes that the law's force takes from the motion; of a law that takes `axial_force`, the
        difference that it makes.
    elastic: a law of rods that stores this energy instead: N²L₀/2EA of its result is the elastic energy.
    branch, margin: of a law of rods, like a commit's.
    potential: of a law of pairs: a kernel that maps `apart` and columns to the energy (kN·m) of which the force is the
        negative gradient. The work of the force is then exact to round-off; else it is summed up step by step. Likewise
        of a law of ends: a kernel that maps the slopes to the energy stored; of an elastic law of rods that takes
        `axial_force`, one that maps its result to what is stored besides N²L₀/2EA.
    """

    each: ClassVar[str] = "rods"
    account: ClassVar[str] = "work"
    elastic: ClassVar[bool] = False
    branch: ClassVar[str | Callable[..., Any]] = ""
    margin: ClassVar[str | Callable[..., Any]] = ""
    potential: ClassVar[str | Callable[..., Any]] = ""

    def cutoff(self, model: Model) -> float:
        """Distance (m) from which on a law of pairs has no force; infinite: all pairs act on each other."""
        return math.inf

    def held_forces(self, model: Model) -> NDArray[np.float64]:
        """Forces (kN) that exact flight holds constant during a step, shape (particles, 2), or (2,) for the same on all."""
        return np.zeros(2)


class Commit(StepSystem):
    """History of one rod, brought up to date once per accepted step, and before the first after an edit.

    The kernel maps scalars of one rod (`elongation`, `axial_force` and `dt` provided; 0 s after an edit) to
    (the new value of the one column in `writes`, the energy dissipated in kN·m); of a column with a number for each end to
    (at the start, at the end, energy). Those that take the axial force come after the others. Where plastic hinges can form,
    `slip_start`, `slip_end` (rad, beyond the plastic rotations) are provided, and `moment_start`, `moment_end` without them.

    branch, margin: kernels by which integrators locate events where the rod's law is not smooth; "": none.
        branch(elongation, rate, …) is the number of the branch of the law that the rod is about to follow;
        margin(branch, elongation, rate, dt, …) is positive while the rod stays on it, has no unit, and is 0
        where it leaves it.
    notes: it only notes what happens, in a column that no law reads; so nothing changes with time because of it.
    """

    account: ClassVar[str] = "dissipated_plastic"
    notes: ClassVar[bool] = False
    branch: ClassVar[str | Callable[..., Any]] = ""
    margin: ClassVar[str | Callable[..., Any]] = ""


class Event(StepSystem):
    """What happens at the instant at which a quantity of a rod or particle changes sign.

    The kernel maps scalars of one row to the quantity, which has no unit and a size of about 1, such as
    1 − N / strength. Of rods `elongation` (m), `rate` (m/s) and `axial_force` (kN) are provided. Every row counts as
    positive when a run begins: one that is negative then has changed sign after the first step.

    Integrators that control their steps end one where a quantity passes 0, within 1e-11; the others end the first
    step that has passed it. The run stops there, and `happen` may change the model by commands, before it goes on:
    at the same time, with the same bits, in the window at any frame rate, in scripts and on the command line.
    clock.events keeps, in the state, which elements are negative, by name: one that is renamed counts as a new one.

    each: "rods" or "particles".
    """

    each: ClassVar[str] = "rods"

    def happen(self, model: Model, fallen: Sequence[Handle], risen: Sequence[Handle]) -> None:
        """Do what follows for the elements whose quantity became negative, and positive again.

        It should depend on the model alone, since steps that are taken back and run again call it again.
        """
        raise NotImplementedError


class Integrator(StepSystem):
    """Advances time. Its functions are source, pasted into the program: see systems/program/templates.

    begins, ends: what becomes of a particle before and after the forces of a step, if its steps are all alike.
    stable_step: the largest stable step (s) for the highest angular frequency ω (rad/s) and decay ζω
        (1/s) of a model, not both 0; infinite if unconditionally stable, 0 if stable at none.
    order: of convergence. parts: templates that its steps call,
        "module:function" or "module:function=name in the program". constants: numbers and arrays by name.
    controlled: it owns time and step size and locates events (see templates/runge_kutta.py); else its steps are all
        alike. Either ends a step, or a piece of one, where a load changes abruptly.
    estimates_error: it chooses its steps so that settings.tolerance is met, unless the step is fixed.
    exact: its results do not depend on the steps; it has no kernel.
    particle_rows, rod_rows: arrays of shape (particles, 2) and (rods,) that it needs.
    check_interval: steps between checks for rest and divergence; larger: notices later.
    guard: which energy it conserves, for the check for divergence; `shadow` in systems/physics/kernels.py.
    push: p, if every step x₊ = x + h v + p h² a, v₊ = v + h a + O(h²), a being the acceleration at its start, so that
        the step's end is foreseen; 0: it is not.
    """

    reads: ClassVar[tuple[str, ...]] = ("particles.mobility",)
    writes: ClassVar[tuple[str, ...]] = (
        *("particles.displacement", "particles.velocity", "particles.rotation", "particles.angular_velocity"),
        "clock.time",
    )
    order: ClassVar[int] = 0
    begins: ClassVar[str] = ""
    ends: ClassVar[str] = ""
    parts: ClassVar[tuple[str, ...]] = ()
    constants: ClassVar[Mapping[str, Any]] = {}
    controlled: ClassVar[bool] = False
    estimates_error: ClassVar[bool] = False
    exact: ClassVar[bool] = False
    particle_rows: ClassVar[int] = 0
    rod_rows: ClassVar[int] = 0
    check_interval: ClassVar[int] = 128
    guard: ClassVar[float] = 0.0
    push: ClassVar[float] = 0.0

    @property
    def key(self) -> str:
        """The name by which models choose it."""
        return self.name.rpartition(".")[2]

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """Largest stable step (s) for the highest angular frequency and the highest decay."""
        raise NotImplementedError
