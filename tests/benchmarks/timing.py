"""How benchmarks take times: the shortest of several, in turns, of programs that take so many steps."""

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from pinjoint.components.model import Model
from pinjoint.systems.base import CORES
from pinjoint.systems.catalogue import step_systems
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.reordered import make_program
from pinjoint.systems.schedule import Schedule

STEP = 1e-6  # s, stable in all models of benchmarks


def program_runner(model: Model, steps: int, *, on: int = 1, form: str = "") -> Callable[[], None]:
    """Takes so many steps, on so many cores."""
    program = make_program(
        model, Schedule(step_systems()).step_plan("simulation", model), INTEGRATORS["velocity_verlet"], form
    )
    model.writable("clock.step_size")[0] = STEP

    def run() -> None:
        left = steps
        with _cores(on):
            while left > 0:
                left -= program.advance(left)[0]

    return run


@contextmanager
def _cores(count: int) -> Iterator[None]:
    before = os.environ.get(CORES)
    os.environ[CORES] = str(count)
    yield
    del os.environ[CORES]
    if before is not None:
        os.environ[CORES] = before


def best_of_each(
    *runners: Callable[[], None], rounds: int = 7, clock: Callable[[], float] = time.process_time
) -> list[float]:
    """The shortest time of each, taken in turns so that a disturbance hits all alike; first runs left out.

    Processor time of one core does not count what others do meanwhile; for several, time on the wall.
    """
    best = [np.inf] * len(runners)
    for runner in runners:
        runner()
    for _ in range(rounds):
        for index, runner in enumerate(runners):
            started = clock()
            runner()
            best[index] = min(best[index], clock() - started)
    return best
