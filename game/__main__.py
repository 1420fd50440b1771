"""The program: `pinjoint`, or `python -m pinjoint`."""

import os
import sys
import warnings

from pinjoint.interrupts import end_in_time, ended_with, mark_interrupts, quietly_interrupted
from pinjoint.version import __version__


def main() -> int:
    """Run the command line; returns the exit status."""
    if not sys.warnoptions:  # they are for those who write programs; -W shows them
        warnings.simplefilter("ignore")
    if sys.argv[1:] == ["--version"] and _version_written():
        return 0
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small, and waiting threads take 0.1 s
    with quietly_interrupted():
        from pinjoint.components.mistake import Mistake
        from pinjoint.streams import prepare_streams, tell

        prepare_streams()
        try:
            from pinjoint.commands.language import speak_as_asked

            words = speak_as_asked(sys.argv[1:])
            from pinjoint.commands import command_line
            from pinjoint.commands.progress import told
        except Mistake as error:  # of --language, or of a variable of the environment
            tell(str(error))
            return 2
    end_in_time()
    mark_interrupts()
    with told():
        status = command_line.main(words)
    return ended_with(status)


def _version_written() -> bool:
    """Write the version before anything is loaded; False if that fails: the command line says why."""
    try:
        print(f"pinjoint {__version__}", flush=True)
    except OSError:
        return False
    return sys.stdout is not None


if __name__ == "__main__":
    raise SystemExit(main())
