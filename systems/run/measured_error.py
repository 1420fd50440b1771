"""Measured error: a run taken again with finer steps, whose difference from it measures its error."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass

import numpy as np

from pinjoint.components.field import Column
from pinjoint.components.rod import bends
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.base import REVIEW_INTERVAL
from pinjoint.systems.program.entries import SMALLEST_ENERGY
from pinjoint.systems.program.program import Program
from pinjoint.systems.run.simulation import STUCK, Simulation

_FINER_TOLERANCE = 1e-2  # of the run's, by which it is taken again where the error is controlled
FINEST_TOLERANCE = 1e-13
OF_BENDING = "rotation", "bending_moment"
_PIECES = 64  # parts of a run at whose ends the quantities are compared
MOST_STEPS = 16  # times those of the run, in which it is taken again: methods of order 3 need 5 times as many
_MOST_CREATED = 10.0  # of all energy supplied; Verlet creates 4 times as much at 0.9 of its stable step
_MOST_LOST = 0.25  # of it; more: finer steps lose much, too, and agree on what is wrong
# Evaluations of the forces of rods up to which the error is measured without being asked for:
IN_A_FRAME, IN_A_COMMAND = 5_000_000, 60_000_000  # about 0.2 s and 3 s


@dataclass(frozen=True)
class MeasuredError:
    """Of the state that a run has reached.

    displacement, velocity, axial_force: the largest of any particle or rod (m, m/s, kN). relative,
    relative_velocity, relative_axial_force: the same to the largest that was seen of all in the run. Likewise rotation (rad)
    and bending_moment (kN·m), 0 where nothing bends.
    """

    displacement: float
    relative: float
    velocity: float
    relative_velocity: float
    axial_force: float
    relative_axial_force: float
    rotation: float
    relative_rotation: float
    bending_moment: float
    relative_bending_moment: float

    def record(self, *, bent: bool) -> dict[str, float]:
        """As plain data, without what only members that bend have if there are none."""
        return {key: value for key, value in asdict(self).items() if bent or not key.endswith(OF_BENDING)}


def work(simulation: Simulation) -> int:
    """Number of evaluations of a rod's force in the run; running it again takes at least as many."""
    stages: int = simulation.integrator.constants.get("STAGES", 1)
    return simulation.model.clock.steps * max(simulation.model.rods.count, 1) * stages


def measure_error(simulation: Simulation, beginning: Snapshot) -> MeasuredError | None:
    """The error of a run from `beginning` until now, in which nothing was edited; None if it has no meaning.

    The run is taken again by half its steps, or where the error is controlled by a hundredth of the
    tolerance and half the longest step, and taken back. By Richardson's argument the error of a method of
    order p is the difference times 2^p / (2^p − 1). Yielding, which only Runge–Kutta methods locate inside a
    step, leaves order 1. There is no estimate where particles met (the slightest difference grows from impact
    to impact), where events might change the model, where so much energy was lost or created that the steps are
    too long for that argument, or where the error is below round-off.
    """
    model = simulation.model
    clock, then = model.clock, beginning.columns
    met = clock.collisions > then["clock.collisions"][0] or clock.collision_state is not None
    meaningless = met or simulation.program.watches_events or simulation.integrator.exact
    lost = clock.largest_imbalance / max(clock.energy_scale, SMALLEST_ENERGY)
    coarse = not -_MOST_CREATED <= lost <= _MOST_LOST
    coarse |= simulation.note == STUCK or simulation.step_size.unstable  # the energy may be right
    if meaningless or coarse or not clock.time > then["clock.time"][0]:
        return None
    program = simulation.programs.compiled
    reached, size, target = _quantities(program), clock.step_size, simulation.moved_until
    steps = clock.steps - then["clock.steps"][0]
    yielded = clock.dissipated_plastic > then["clock.dissipated_plastic"][0]
    with simulation.aside(beginning):
        if program.tolerance > 0.0:
            largest, factor = _by_tolerance(program, target, MOST_STEPS * max(steps, _PIECES)), 1.0
        else:
            largest = _by_steps(simulation, program, target, size)
            order = 1 if yielded and not program.integrator.controlled else program.integrator.order
            factor = 2.0**order / (2.0**order - 1.0)
        again = _quantities(program)
    largest = np.maximum(largest, _sizes(reached))
    difference = factor * _sizes(map(np.subtract, reached, again))
    if not np.isfinite(largest + difference).all():
        return None
    relative = np.divide(difference, largest, out=np.zeros(len(largest)), where=largest > 0.0)
    return MeasuredError(*np.stack([difference, relative], axis=1).ravel().tolist())


def _quantities(program: Program) -> list[Column]:
    """What is compared in the present state: of particles (n, 2) in m and m/s, of rods in kN; rotations, bending moments."""
    program.observe()
    particles, rods = program.model.particles, program.model.rods
    moments = rods.bending_moment if bends(program.model) else np.zeros(0)
    found = particles.displacement, particles.velocity, rods.axial_force, particles.rotation, moments
    return [column.copy() for column in found]


def _sizes(quantities: Iterable[Column]) -> Column:
    """The largest of each, of any particle or rod, shape (5,)."""
    lengths = (np.hypot(*some.T) if some.ndim > 1 else np.abs(some) for some in quantities)
    return np.array([length.max(initial=0.0) for length in lengths])


def _by_tolerance(program: Program, target: float, most: int) -> Column:
    """Run to a time with a hundredth of the tolerance and half the longest step; returns as _pieces does."""
    tolerance = program.tolerance
    program.tolerance = max(_FINER_TOLERANCE * tolerance, FINEST_TOLERANCE)
    program.model.writable("clock.step_limit")[0] *= 0.5
    try:
        return _pieces(program, target, most) if program.tolerance < 0.2 * tolerance else _UNKNOWN
    finally:
        program.tolerance = tolerance


def _by_steps(simulation: Simulation, program: Program, target: float, size: float) -> Column:
    """Run to a time by equal steps, at most half as long as `size`; returns as _pieces does."""
    clock = program.model.clock
    steps = math.ceil(2.0 * (target - clock.time) / size * (1.0 - 1e-9))
    simulation.step_size.begin((target - clock.time) / steps)
    largest, piece = _sizes(_quantities(program)), -(-steps // _PIECES)
    while steps > 0:
        taken, _ = program.advance(min(piece, steps))
        if taken == 0:
            return _UNKNOWN
        steps -= taken
        largest = np.maximum(largest, _sizes(_quantities(program)))
    return largest


def _pieces(program: Program, target: float, most: int) -> Column:
    """Run to a time exactly, past all that would stop a run.

    Returns the largest quantities at the ends of pieces; not numbers if it did not get there in `most` steps.
    """
    clock, largest = program.model.clock, _sizes(_quantities(program))
    for end in np.linspace(clock.time, target, _PIECES + 1)[1:].tolist():
        while (before := clock.time) < end:
            taken, _ = program.advance(min(most, REVIEW_INTERVAL), end, end)
            most -= taken
            if clock.time == before or most <= 0:
                return _UNKNOWN
        largest = np.maximum(largest, _sizes(_quantities(program)))
    return largest


_UNKNOWN = np.array([math.nan])  # of each quantity
