"""No array is read or written outside its bounds, whatever a person does."""

from tests.properties.bounds import OUTSIDE, checked

READS = """
import numpy as np
from pinjoint.systems.kernels import kept
from pinjoint.systems.machine_code import addressed, machine_code

@kept("float64(float64[:], int64)")
def at(values, row):
    return values[row]

"""


def test_a_read_outside_by_name_is_caught() -> None:
    done = checked(READS + "machine_code(at)(np.zeros(3), 3)", timeout=300)
    assert done.returncode == 1
    assert "IndexError" in done.stdout


def test_a_read_outside_by_address_ends_the_process_that_reads() -> None:
    # By its address, as programs call what others wrote: the C wrapper prints the error and returns 0.
    call = """
from numba import njit
read = machine_code(at)
address = addressed(read)
call = njit(lambda read, values, row: read(values, row))
print(call(address, np.zeros(3), 3))
"""
    process = f"import subprocess, sys; sys.exit(subprocess.call([sys.executable, '-c', {READS + call!r}]))"
    done = checked(process, timeout=300)
    assert done.returncode == OUTSIDE, done.stdout
    assert "IndexError" in done.stdout
