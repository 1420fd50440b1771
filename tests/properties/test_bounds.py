"""No array is read or written outside its bounds, whatever a person does."""

import os
from pathlib import Path

import pytest

from tests.properties.bounds import OUTSIDE, checked, fuzzing
from tests.properties.test_fuzz import PERSONS

READS = """
import numpy as np
from pinjoint.systems.program.kernel import kept
from pinjoint.systems.program.machine_code import addressed, machine_code

@kept("float64(float64[:], int64)")
def at(values, row):
    return values[row]

"""


@pytest.fixture(scope="session")
def checking(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of what is compiled with checks, one for all processes that run the tests."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "checking"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


def test_a_read_outside_by_name_is_caught(tmp_path: Path) -> None:
    """In code that is compiled, and in what was kept of it: the second process compiles nothing."""
    kept = set()
    for _ in range(2):
        done = checked(READS + "machine_code(at)(np.zeros(3), 3)", tmp_path, timeout=300)
        assert done.returncode == 1
        assert "IndexError" in done.stdout
        kept.add(tuple((path, path.stat().st_mtime_ns) for path in tmp_path.rglob("*.at-*.code")))
    (code,) = kept
    assert len(code) == 1


def test_a_read_outside_by_address_ends_the_process_that_reads(checking: Path) -> None:
    # By its address, as programs call what others wrote: the C wrapper prints the error and returns 0.
    call = """
from numba import njit
read = machine_code(at)
address = addressed(read)
call = njit(lambda read, values, row: read(values, row))
print(call(address, np.zeros(3), 3))
"""
    process = f"import subprocess, sys; sys.exit(subprocess.call([sys.executable, '-c', {READS + call!r}]))"
    done = checked(process, checking, timeout=300)
    assert done.returncode == OUTSIDE, done.stdout
    assert "IndexError" in done.stdout


def test_whatever_a_person_does_stays_within_arrays(checking: Path) -> None:
    """Every program is compiled for it, with checks: one person who does much, in one process."""
    done = checked(fuzzing(*PERSONS, "300", "--count", "1", "--seed", "50"), checking)
    assert done.returncode == 0, done.stdout
