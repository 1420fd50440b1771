"""Results: the table that a sweep ends with, as CSV or Parquet and as a picture."""

from __future__ import annotations

import importlib.util
import io
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.commands.analysis import FOUND
from pinjoint.components import written
from pinjoint.components.language import tr
from pinjoint.documents.models import replace
from pinjoint.sweeps.plan import RECORDED, Plan
from pinjoint.sweeps.variation import INSTALL, SweepError

MOST_LINES = 12


class Results:
    """One row per variant and reported state, in the order of the plan; columns by name.

    `variant` counts from 0; then what was varied, by path; `status`, `message`, `time` (s) and `load_factor`
    as `pinjoint run` reports them; then the measures, by path, in the units of model files. A variant that
    could not be computed has the status "failed", the reason as its message, and no measures (None).
    """

    def __init__(self, plan: Plan, finished: Mapping[int, list[Any]]) -> None:
        self.plan = plan
        names = ("variant", *plan.varied, *RECORDED, *(measure.column for measure in plan.measures))
        columns: list[list[Any]] = [[] for _ in names]  # no rows beside them: a million variants take 1 GB
        for number in range(plan.size):
            varied = plan.values(number)
            for record in finished[number]:
                for column, value in zip(columns, (number, *varied, *record), strict=True):
                    column.append(value)
        self.columns = dict(zip(names, columns, strict=True))

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column as an array; missing numbers are NaN."""
        if name not in self.columns:
            raise KeyError(
                tr(
                    "There is no column '{name}'; choose one of {names}.",
                    name=name,
                    names=", ".join(self.columns),
                )
            )
        column = self.columns[name]
        numbers = all(value is None or isinstance(value, float) for value in column)
        return np.array(column, dtype=float if numbers else None)

    def __len__(self) -> int:
        return len(self.columns["variant"])

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """Each row, its values by column."""
        return (dict(zip(self.columns, row, strict=True)) for row in zip(*self.columns.values(), strict=True))

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {status}" for status, count in self.counts().items())
        return f"<{len(self)} rows of a sweep ({counts}): {', '.join(self.columns)}>"

    def counts(self) -> dict[str, int]:
        """Number of variants that ended with each status."""
        last = dict(zip(self.columns["variant"], self.columns["status"], strict=True))
        return dict(sorted(Counter(last.values()).items()))

    @property
    def found(self) -> NDArray[np.bool_]:
        """Which rows are answers; the others hold a last good state, or nothing."""
        return np.isin(self.columns["status"], FOUND)

    # --- files -----------------------------------------------------------------------------------------

    def write(self, path: str | Path) -> None:
        """Write a .csv or .parquet file, as a whole or not at all. Raises SweepError, OSError."""
        check_output(path := Path(path))
        if path.suffix == ".csv":
            replace(path, written.as_csv([self.columns, *zip(*self.columns.values(), strict=True)]).encode())
        else:
            replace(path, self._as_parquet())

    def _as_parquet(self) -> bytes:
        """Units are kept with each column."""
        import pyarrow
        from pyarrow import parquet

        units = {"time": "s"} | {measure.column: measure.unit for measure in self.plan.measures}
        arrays = [
            pyarrow.array(column, pyarrow.float64() if set(column) == {None} else None)
            for column in self.columns.values()
        ]
        fields = [
            pyarrow.field(name, array.type, metadata={"unit": units.get(name, "")})
            for name, array in zip(self.columns, arrays, strict=True)
        ]
        made = pyarrow.BufferOutputStream()
        parquet.write_table(pyarrow.table(arrays, schema=pyarrow.schema(fields)), made)
        found: bytes = made.getvalue().to_pybytes()
        return found

    # --- a picture ---------------------------------------------------------------------------------------

    def plot(self, path: str | Path) -> None:
        """Draw each measure against what was varied first, as PNG; one line per value of the others.

        Only answers are drawn. What was drawn at random is shown as points. Raises SweepError, OSError.
        """
        check_output(path := Path(path), [".png"])
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        measures = self.plan.measures[:12]  # more panels would be too small
        drawn = any(variation.distribution for variation in self.plan.variations)
        figure, axes = pyplot.subplots(
            len(measures),
            squeeze=False,
            sharex=True,
            figsize=(8.0, 1.0 + 3.0 * len(measures)),
            layout="constrained",
        )
        for axis, measure in zip(axes[:, 0], measures, strict=True):
            for label, rows in self._lines().items():
                x = self[self.plan.varied[0]][rows]
                axis.plot(x, self[measure.column][rows], "." if drawn else ".-", label=label)
            axis.set_ylabel(measure.label)
            axis.grid(alpha=0.3)
        axes[-1, 0].set_xlabel(self.plan.variations[0].label)
        figure.suptitle(self.plan.name)
        if 1 < len(self._lines()) <= MOST_LINES:
            axes[0, 0].legend()
        made = io.BytesIO()
        figure.savefig(made, format="png", dpi=120)
        pyplot.close(figure)
        replace(path, made.getvalue())

    def _lines(self) -> dict[str, NDArray[np.intp]]:
        """The rows of each line, by its label: what else is varied, and the state where there are several."""
        others = [v.path for v in self.plan.variations[1:] if v.values]
        asked = {"time": self.plan.analysis.times, "load_factor": self.plan.analysis.load_factors}
        others += [name for name, values in asked.items() if values is not None and len(values) > 1]
        lines: dict[str, list[int]] = {}
        for row in np.flatnonzero(self.found).tolist():
            values = [(name, self.columns[name][row]) for name in others]
            label = ", ".join(f"{k} {v:.6g}" if isinstance(v, float) else f"{k} {v}" for k, v in values)
            lines.setdefault(label, []).append(row)
        return {label: np.array(rows) for label, rows in lines.items()}


def check_output(path: Path, suffixes: Sequence[str] = (".csv", ".parquet")) -> None:
    """Refuse what could not be written in the end. Raises SweepError."""
    if path.suffix not in suffixes:
        endings = ", ".join(suffixes)
        raise SweepError("{file}: choose a file that ends with one of {endings}.", file=path, endings=endings)
    module = {".parquet": "pyarrow", ".png": "matplotlib"}.get(path.suffix)
    if module is not None and importlib.util.find_spec(module) is None:
        raise SweepError(
            "A {suffix} file needs {module}; install it with: {command}",
            suffix=path.suffix,
            module=module,
            command=INSTALL,
        )
    if path.is_dir() or not path.parent.is_dir():
        raise SweepError(
            "{path} cannot be written: it is a folder, or its folder is missing. Choose another file.",
            path=path,
        )
