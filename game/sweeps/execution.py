"""Execution: the variants of a plan computed in this process, by workers on this machine, or by a Dask cluster."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from pinjoint.components.language import ENGLISH, spoken
from pinjoint.sweeps.batches import Batches
from pinjoint.sweeps.plan import Outcome, Plan, Record
from pinjoint.sweeps.variant_runner import VariantRunner
from pinjoint.sweeps.variation import INSTALL, SweepError
from pinjoint.systems.program.parallel import VARIABLE, cores

MOST_IN_A_TASK = 64  # variants; what a kill loses at most of each worker
TASKS_PER_WORKER = 16  # so that no worker waits long for another's last task
ANSWER_WITHIN = 10.0  # s
LARGE = 30_000  # variants × rods from which workers are worth the seconds in which they start
SAFE_PATH = "PYTHONSAFEPATH"  # of the environment
LIGHT = 100  # rods up to which a variant takes as long as one of this many


@dataclass
class Computed:
    """Outcomes of some variants. faults: why some of them were not computed together though they should be able to.

    Such a fault costs time, not results: they are computed one by one. Counted are variants by what went wrong.
    """

    outcomes: list[Outcome]
    faults: Mapping[str, int] = field(default_factory=dict)


class Worker:
    """Computes variants of a plan in this process: together where that is possible, else one by one.

    Raises SweepError if this process has another version of Pinjoint, or other mods, than the plan is of.
    """

    def __init__(self, plan: Plan, threads: int = 1) -> None:
        plan.software.require()
        self._plan = plan
        self._runner: VariantRunner | None = None
        self._batches: Batches | None = None
        self._fault = ""  # why nothing is computed together
        try:
            self._batches = Batches(VariantRunner(plan), plan, threads)
        except Exception as error:
            self._fault = _told(error)

    @property
    def at_a_time(self) -> int:
        """Number of variants that are computed together; 1: none."""
        return self._batches.size if self._batches is not None else 1

    def compute(self, numbers: Sequence[int]) -> Computed:
        """Compute some variants; one that cannot be computed is a record that says why, in English, as files are."""
        with spoken(ENGLISH):
            return self._compute(numbers)

    def _compute(self, numbers: Sequence[int]) -> Computed:
        together: Mapping[int, list[Record]] = {}
        faults = Counter({self._fault: len(numbers)} if self._fault else {})
        if len(numbers) > 1:
            try:
                together = self.together(numbers)
            except Exception as error:
                faults[_told(error)] += len(numbers)
        return Computed([(n, together[n]) if n in together else self._alone(n) for n in numbers], faults)

    def together(self, numbers: Sequence[int]) -> dict[int, list[Record]]:
        """Records of those variants that can be computed together, by number."""
        return self._batches.records(numbers) if self._batches is not None else {}

    def _alone(self, number: int) -> Outcome:
        try:
            self._runner = self._runner or VariantRunner(self._plan)
            return number, self._runner.records(number)
        except Exception as error:  # one bad variant of thousands must not end the others
            self._runner = None
            return self._plan.failure(number, str(error) if isinstance(error, ValueError) else _told(error))


def _told(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def compute(plan: Plan, numbers: Sequence[int]) -> Computed:
    """Compute some variants of a plan, here and by this thread; see Worker.compute."""
    return Worker(plan).compute(numbers)


def suitable_workers(plan: Plan, variants: int, together: int) -> int:
    """All cores that this process may use where there is much to do one by one, by a rule; else 1."""
    if together > 1 or variants * max(len(plan.document.get("rods", ())), LIGHT) < LARGE:
        return 1
    return cores()


def compute_all(
    plan: Plan, numbers: Sequence[int], workers: int | None, scheduler: str | None
) -> Iterator[Computed]:
    """Compute these variants, some at a time, in whatever order they get ready.

    workers: 1 computes in this process; more start that many on this machine; None: as many as suit.
    scheduler: the address of that of a running Dask cluster, which computes instead. Raises SweepError.
    """
    here = Worker(plan, cores())
    if workers is None:
        workers = suitable_workers(plan, len(numbers), here.at_a_time)
    if scheduler is None and workers == 1:
        for task in _tasks(numbers, 1, here.at_a_time):
            yield here.compute(task)
        return
    try:
        import distributed
    except ImportError:
        raise SweepError(
            "Several workers need dask.distributed; use --workers 1, or install it with: {command}",
            command=INSTALL,
        ) from None
    workers = min(workers, len(numbers))
    with (
        _local_client(distributed, workers) if scheduler is None else _client_of(distributed, scheduler)
    ) as client:
        yield from _distributed(distributed, client, plan, numbers, here.at_a_time)


@contextmanager
def _local_client(distributed: Any, workers: int) -> Iterator[Any]:
    """Workers of this machine, which import nothing from the folder that somebody happens to be in."""
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        with distributed.Client(
            n_workers=workers,
            threads_per_worker=1,
            env={VARIABLE: "1"},
            processes=True,
            dashboard_address="127.0.0.1:0",  # any port: several sweeps may run at once
            silence_logs=logging.CRITICAL,
        ) as client:
            yield client
    finally:
        os.environ.pop(SAFE_PATH)
        os.environ |= {SAFE_PATH: before} if before is not None else {}


def _client_of(distributed: Any, scheduler: str) -> Any:
    try:
        client = distributed.Client(scheduler, timeout=ANSWER_WITHIN)
    except (OSError, ValueError) as error:
        raise SweepError(
            "No Dask scheduler answers at {scheduler} ({error}). Start one with: dask scheduler, and workers"
            " with: dask worker {scheduler}",
            scheduler=scheduler,
            error=error,
        ) from None
    try:
        client.wait_for_workers(1, timeout=ANSWER_WITHIN)
    except TimeoutError:
        client.close()
        raise SweepError(
            "{scheduler} has no workers. Start some with: dask worker {scheduler}", scheduler=scheduler
        ) from None
    return client


def _distributed(
    distributed: Any, client: Any, plan: Plan, numbers: Sequence[int], together: int
) -> Iterator[Computed]:
    shared = client.submit(_same, plan, pure=False)  # unlike scattered data, survives the death of its workers

    def submit(task: Sequence[int]) -> Any:
        return client.submit(compute, shared, task, pure=False)

    workers = max(len(client.scheduler_info()["workers"]), 1)
    tasks = {submit(task): task for task in _tasks(numbers, workers, together)}
    suspects: list[int] = []
    for future in distributed.as_completed(tasks):
        task = tasks.pop(future)
        found = _result(distributed, future)
        if found is None:
            suspects += task
        else:
            yield found
    for number in sorted(suspects):  # one at a time, so that only what kills a worker is blamed for it
        found = _result(distributed, submit([number]))
        why = "Every worker that computed this variant ended early; perhaps memory ran out."
        yield found or Computed([plan.failure(number, why)])


def _result(distributed: Any, future: Any) -> Computed | None:
    """The result of a task; None if its workers died."""
    try:
        found: Computed = future.result()
    except distributed.KilledWorker:
        return None
    except Exception as error:
        if isinstance(error, SweepError):
            raise
        raise SweepError(
            "A worker cannot compute this: {error}. Install the same software there as here.", error=error
        ) from None
    future.release()
    return found


def _same(plan: Plan) -> Plan:
    return plan


def _tasks(numbers: Sequence[int], workers: int, together: int) -> list[Sequence[int]]:
    """together: how many variants are best computed at a time."""
    size = min(max(len(numbers) // (workers * TASKS_PER_WORKER), 1), MOST_IN_A_TASK)
    if together > 1:
        size = min(max(len(numbers) // workers, 1), together)
    return [numbers[first : first + size] for first in range(0, len(numbers), size)]
