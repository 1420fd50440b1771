"""Ratios within one run of `pinjoint bench speed` that hold on every machine: `python -m tests.benchmarks.ratios DIR`.

Exits with 1 and says which do not. The bounds leave room for a busy machine; what was measured is in README.md beside it.
"""

import csv
import sys
from collections.abc import Iterator
from pathlib import Path

TO_PLAIN = 2.0  # of a program's time to that of a plain kernel for the same model, from 900 rods on
TO_SMALL = 6.0  # of the time per rod among 10⁵ rods to that among 10³


def broken(rows: list[dict[str, str]]) -> Iterator[str]:
    """What does not hold, in sentences. rows: of the table of steps, with one core."""
    for row in rows:
        if int(row["rods"]) >= 900 and (ratio := float(row["ratio_to_plain"])) > TO_PLAIN:
            yield f"{row['kind']}, {row['rods']} rods: {ratio:.2f} times a plain kernel, above {TO_PLAIN:g}."
    for kind in dict.fromkeys(row["kind"] for row in rows):
        cost = {int(row["rods"]): float(row["ns_per_rod"]) for row in rows if row["kind"] == kind}
        small = min((rods for rods in cost if rods >= 900), default=0)
        large = max(cost)
        if small and cost[large] > TO_SMALL * cost[small]:
            yield (
                f"{kind}: {cost[large]:.1f} ns a rod among {large}, {cost[small]:.1f} among {small}; that is more"
                f" than {TO_SMALL:g} times as much."
            )


def main(folder: str) -> int:
    """Read the table that was written to a folder; the exit status."""
    with open(Path(folder) / "speed_steps.csv", newline="", encoding="utf-8") as file:
        found = list(broken(list(csv.DictReader(file))))
    print("\n".join(found) or "The ratios hold.")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
