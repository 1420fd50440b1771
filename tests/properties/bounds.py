"""Nothing reads or writes outside an array: code run in a process in which machine code checks every index.

`python -m tests.properties.bounds editing windows --count 20` is `python -m tests.properties.fuzz` in such a process. What
it compiles is kept in a folder apart, for what was compiled without checks has none. A kernel called by an address cannot
raise: numba prints the error and goes on with zero, so its process ends at once instead.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

OUTSIDE = 70  # status of a process in which a kernel, called by address, has read outside an array

_GUARD = f"""
import os, sys
def end(unraisable):
    sys.__unraisablehook__(unraisable)
    sys.stderr.flush()
    os._exit({OUTSIDE})
sys.unraisablehook = end
"""


def checked(code: str, folder: Path, timeout: float | None = None) -> subprocess.CompletedProcess[str]:
    """Run this code with all indices of machine code checked, which is kept in a folder."""
    cache = folder / "cache"  # apart: it comes to hold a folder "pinjoint", which Python would import
    cache.mkdir(exist_ok=True)
    (folder / "sitecustomize.py").write_text(_GUARD, encoding="utf-8")
    own = {"NUMBA_BOUNDSCHECK": "1", "PINJOINT_COMPILE": "always", "XDG_CACHE_HOME": str(cache)}
    # Compiling, which is what takes long here, takes a third. Without any optimising it takes as long, and code that goes by
    # addresses which would have been optimised away is not kept.
    own["NUMBA_OPT"] = "1"
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | own | {"PYTHONPATH": os.pathsep.join([str(folder), str(Path(__file__).parents[2])])},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=timeout,
    )


def main(words: Sequence[str] | None = None) -> int:
    """Fuzz with checked indices; returns the status of the process that did."""
    with tempfile.TemporaryDirectory() as folder:
        done = checked(fuzzing(*(sys.argv[1:] if words is None else words)), Path(folder))
    print(done.stdout, end="")
    return done.returncode


def fuzzing(*words: str) -> str:
    """Code that fuzzes as `python -m tests.properties.fuzz` with these words does."""
    return f"from tests.properties.fuzz import main\nraise SystemExit(main({list(words)!r}))"


if __name__ == "__main__":
    raise SystemExit(main())
