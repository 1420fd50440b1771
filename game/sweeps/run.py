"""A sweep: many variants of one model, and what was measured of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from game.commands.reports.report import Analysis
from game.documents import models
from game.documents.open_documents import file_of
from game.paths import apply_override
from game.sweeps.execution import outcomes
from game.sweeps.installation import Installation
from game.sweeps.journal import Journal
from game.sweeps.measure import read_measures
from game.sweeps.plan import FAILED, Plan
from game.sweeps.results import Results, check_output
from game.sweeps.variation import FORMS, MOST_VARIANTS, Random, SweepError, Value, read_variations

Progress = Callable[[int, int, int], None]  # done, of how many, failed


def sweep(
    source: str | Path | Mapping[str, Any],
    vary: Iterable[str] | Mapping[str, Sequence[Value]],
    measure: Iterable[str],
    analysis: Analysis = Analysis(),  # noqa: B008 (it cannot be changed)
    *,
    overrides: Iterable[str] = (),
    samples: int | None = None,
    seed: int = 0,
    output: str | Path | None = None,
    workers: int | None = 1,
    scheduler: str | None = None,
    progress: Progress = lambda done, total, failed: None,
) -> Results:
    """Compute all variants of a model and keep what is measured of each.

    source: a model file, the name of a bundled model, or a document. vary: texts such as
    "rods.CD.tensile_strength=150:300:31" or "rods.*.stiffness~normal(164640,5%)", or values by path.
    measure: paths such as "rods.CD.plastic_strain"; a vector becomes two columns. analysis: what is asked of
    each. overrides: what is changed in all, as in "rods.*.damping=0". samples, seed: of what is drawn.
    output: a .csv or .parquet file; while it is not complete, a file beside it keeps what is finished, and
    the same sweep goes on from there. workers: processes; 1 is this one, None as many as suit (a script that
    asks for more than 1 guards its main code by `if __name__ == "__main__"`). scheduler: the address of that of
    a running Dask cluster, which computes instead. progress: told how many are done, of how many, and failed.

    Same arguments, same bits, however many workers. Raises SweepError, ModelError,
    PathError, and OSError if the output cannot be written.
    """
    plan = plan_of(source, vary, measure, analysis, overrides, samples, seed)
    if workers is not None and workers < 1:
        raise SweepError(f"{workers} workers cannot compute; ask for at least 1.")
    path = None if output is None else Path(output)
    if path is not None:
        check_output(path)
    journal = Journal(path, plan)
    journal.open()
    failed = sum(map(_is_failure, journal.finished.values()))
    missing = [number for number in range(plan.size) if number not in journal.finished]
    progress(len(journal.finished), plan.size, failed)
    for found in outcomes(plan, missing, workers, scheduler) if missing else ():
        journal.add(found)
        failed += sum(_is_failure(records) for _, records in found)
        progress(len(journal.finished), plan.size, failed)
    results = Results(plan, journal.finished)
    if path is not None:
        results.write(path)
        journal.remove()
    return results


def _is_failure(records: Sequence[Sequence[Any]]) -> bool:
    return bool(records[-1][0] == FAILED)


def plan_of(
    source: str | Path | Mapping[str, Any],
    vary: Iterable[str] | Mapping[str, Sequence[Value]],
    measure: Iterable[str],
    analysis: Analysis,
    overrides: Iterable[str],
    samples: int | None,
    seed: int,
) -> Plan:
    """What is to be computed, read and checked; see `sweep`. Raises SweepError, ModelError, PathError."""
    model = models.load(source)
    document = models.document(model)
    overrides = tuple(overrides)
    for override in overrides:
        apply_override(model, override)
    variations = read_variations(model, vary)
    drawn = any(isinstance(variation, Random) for variation in variations)
    if not variations:
        raise SweepError(f"Nothing is varied; {FORMS}.")
    if drawn and samples is None:
        raise SweepError("What is drawn (~) needs the number of samples; say --samples 1000.")
    if not drawn and samples is not None:
        raise SweepError(
            "--samples goes with a distribution; write PATH~normal(MEAN,DEVIATION), or leave it out."
        )
    if samples is not None and samples < 1:
        raise SweepError(f"--samples {samples}: draw at least 1.")
    if seed < 0:
        raise SweepError(f"--seed {seed}: write a whole number from 0 on.")
    plan = Plan(
        file_of(source).name,
        document,
        overrides,
        variations,
        samples or 1,
        seed,
        read_measures(model, measure),
        analysis,
        Installation.present(),
    )
    if plan.size > MOST_VARIANTS:
        raise SweepError(
            f"These are {plan.size} variants; vary in fewer steps, at most {MOST_VARIANTS} together."
        )
    return plan
