"""Execution: the variants of a plan computed in this process, by workers on this machine, or by a Dask cluster.

A process runs them one by one by one model, which is brought back after each.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import Any

from pinjoint.commands.analysis import State
from pinjoint.components.language import ENGLISH, english, spoken
from pinjoint.components.model import Model
from pinjoint.components.snapshot import Snapshot
from pinjoint.documents import models
from pinjoint.paths import apply_override, locate, quoted, settable
from pinjoint.sweeps.plan import Outcome, Plan, Record
from pinjoint.sweeps.variation import INSTALL, SweepError, as_text
from pinjoint.systems.base import CORES, cores
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule

_MOST_IN_A_TASK = 64  # variants; what a kill loses at most of each worker
_TASKS_PER_WORKER = 16  # so that no worker waits long for another's last task
_ANSWER_WITHIN = 10.0  # s
LARGE = 30_000  # variants × rods from which workers are worth the seconds in which they start
_SAFE_PATH = "PYTHONSAFEPATH"  # of the environment
LIGHT = 40  # rods up to which a variant takes as long as one of this many


class VariantRunner:
    """Runs variants of a plan by one model: opening one and loading its step program takes longer than most runs.

    A variant is edited and run inside a transaction that is taken back: commands have exact inverses, and
    all that time changes is in the snapshot, so that the next one begins with the same bits as the first.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._model = models.parse(plan.document)
        for override in plan.overrides:
            apply_override(self._model, override)
        self._targets = [locate(self._model, varied.path, settable)[0] for varied in plan.variations]
        self._simulation = Simulation(self._model, Schedule(all_systems()))
        self._beginning = Snapshot.take(self._model)

    def records(self, number: int) -> list[Record]:
        """A record of each state of a variant. Raises the errors of its overrides and of its run."""
        with self._taken_back():
            values = iter(self._plan.values(number))
            for varied, target in zip(self._plan.variations, self._targets, strict=True):
                given = list(islice(values, len(varied.columns)))
                with quoted(f"{varied.path}={', '.join(map(as_text, given))}"):
                    target.give_each(given if len(given) > 1 else given * len(target.handles))
            run = self._plan.analysis.run(self._simulation, self._plan.name, read=self._measured)
        about = run["status"], english(run["message"])
        return [(*about, *state.values()) for state in run["states"]]

    def _measured(self, model: Model, found: State) -> State:
        """What is kept of a state."""
        measures = {measure.column: measure.of(model, found) for measure in self._plan.measures}
        return {"time": found["time"], "load_factor": found["load_factor"], **measures}

    @contextmanager
    def _taken_back(self) -> Iterator[None]:
        """Changes of the model inside the `with` are taken back at its end."""
        try:
            with self._model.transaction("variant"):
                yield
                raise _TakenBack
        except _TakenBack:
            self._beginning.restore(self._model)
            self._simulation.forget()


class _TakenBack(Exception):
    pass


def compute(plan: Plan, numbers: Iterable[int]) -> Iterator[Outcome]:
    """Compute some variants of a plan, here and one by one, all by one model.

    One that cannot be computed is a record that says why, in English, as files are. Raises SweepError if this process has
    another version of Pinjoint, or other mods, than the plan is of.
    """
    plan.require_software()
    runner: VariantRunner | None = None
    for number in numbers:
        with spoken(ENGLISH):
            try:
                runner = runner or VariantRunner(plan)
                outcome = number, runner.records(number)
            except Exception as error:  # one bad variant of thousands must not end the others
                runner = None
                told = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
                outcome = plan.failure(number, told)
        yield outcome


def compute_all(
    plan: Plan, numbers: Sequence[int], workers: int | None, scheduler: str | None
) -> Iterator[list[Outcome]]:
    """Compute these variants, some at a time, in whatever order they get ready.

    workers: 1 computes in this process; more start that many on this machine; None: all cores that this process may use
    where there is much to do, by a rule, else 1.
    scheduler: the address of that of a running Dask cluster, which computes instead. Raises SweepError.
    """
    if workers is None:
        much = len(numbers) * max(len(plan.document.get("rods", ())), LIGHT) >= LARGE
        workers = cores() if much else 1
    if scheduler is None and workers == 1:
        computed = compute(plan, numbers)
        for task in _tasks(numbers, 1):
            yield list(islice(computed, len(task)))
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
        yield from _distributed(distributed, client, plan, numbers)


@contextmanager
def _local_client(distributed: Any, workers: int) -> Iterator[Any]:
    """Workers of this machine, which import nothing from the folder that somebody happens to be in."""
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        with distributed.Client(
            n_workers=workers,
            threads_per_worker=1,
            env={CORES: "1"},
            processes=True,
            dashboard_address="127.0.0.1:0",  # any port: several sweeps may run at once
            silence_logs=logging.CRITICAL,
        ) as client:
            yield client
    finally:
        os.environ.pop(_SAFE_PATH)
        os.environ |= {_SAFE_PATH: before} if before is not None else {}


def _client_of(distributed: Any, scheduler: str) -> Any:
    try:
        client = distributed.Client(scheduler, timeout=_ANSWER_WITHIN)
    except (OSError, ValueError) as error:
        raise SweepError(
            "No Dask scheduler answers at {scheduler} ({error}). Start one with: dask scheduler, and workers"
            " with: dask worker {scheduler}",
            scheduler=scheduler,
            error=error,
        ) from None
    try:
        client.wait_for_workers(1, timeout=_ANSWER_WITHIN)
    except TimeoutError:
        client.close()
        raise SweepError(
            "{scheduler} has no workers. Start some with: dask worker {scheduler}", scheduler=scheduler
        ) from None
    return client


def _distributed(distributed: Any, client: Any, plan: Plan, numbers: Sequence[int]) -> Iterator[list[Outcome]]:
    shared = client.submit(_same, plan, pure=False)  # unlike scattered data, survives the death of its workers

    def submit(task: Sequence[int]) -> Any:
        return client.submit(_computed, shared, task, pure=False)

    workers = max(len(client.scheduler_info()["workers"]), 1)
    tasks = {submit(task): task for task in _tasks(numbers, workers)}
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
        yield found or [plan.failure(number, why)]


def _result(distributed: Any, future: Any) -> list[Outcome] | None:
    """The result of a task; None if its workers died."""
    try:
        found: list[Outcome] = future.result()
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


def _computed(plan: Plan, numbers: Sequence[int]) -> list[Outcome]:
    return list(compute(plan, numbers))


def _tasks(numbers: Sequence[int], workers: int) -> list[Sequence[int]]:
    size = min(max(len(numbers) // (workers * _TASKS_PER_WORKER), 1), _MOST_IN_A_TASK)
    return [numbers[first : first + size] for first in range(0, len(numbers), size)]
