"""Types: `python -m tests.types` is mypy, which is shown our folders under the names that they are imported by."""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
LINKS = ROOT / ".mypy" / "pinjoint"  # where mypy_path in pyproject.toml points


def link() -> None:
    """Lay the folders out as they are installed, by links that are made anew, for files come and go."""
    shutil.rmtree(LINKS.parent, ignore_errors=True)
    LINKS.mkdir(parents=True)
    for entry in (ROOT / "game").iterdir():
        (LINKS / entry.name).symlink_to(entry)
    for folder in ("components", "systems"):
        (LINKS / folder).symlink_to(ROOT / folder)


def main() -> int:
    link()
    command = [sys.executable, "-m", "mypy", *sys.argv[1:]]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for folder in ("components", "systems"):
        done.stdout = done.stdout.replace(f".mypy/pinjoint/{folder}/", f"{folder}/")
    print(done.stdout.replace(".mypy/pinjoint/", "game/"), end="")
    return done.returncode


if __name__ == "__main__":
    raise SystemExit(main())
