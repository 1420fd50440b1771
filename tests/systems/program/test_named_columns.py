"""Columns that kernels name by members of an IntEnum."""

from enum import IntEnum
from pathlib import Path
from types import FunctionType

import numpy as np
import pytest

from pinjoint.systems.program.compiler import generated
from pinjoint.systems.program.kernel import compiled

SOURCE = """
from pinjoint.systems.program.kernel import kept

@kept()
def second(row):
    return kernel(row)
"""


class Column(IntEnum):
    """Stands for the enumerations of the test."""

    SECOND = 1


def second(row):
    return row[Column.SECOND]


def test_a_column_with_another_number_is_compiled_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pinjoint.systems.program.cache.folder", lambda: tmp_path)
    answers = []
    for number in (1, 2):
        names = {"Column": IntEnum("Column", {"FIRST": 0, "SECOND": number}), "__name__": __name__}
        kernel = compiled(FunctionType(second.__code__, names))
        answers.append(generated("test", SOURCE, {"kernel": kernel}).load().second(np.array([0.5, 1.5, 2.5])))
    assert answers == [1.5, 2.5]
    assert len(list(tmp_path.glob("pinjoint_program_*.code"))) == 2
