"""Damaged files of the program itself: its cache, journals, settings, recovery files and saved models.

Disks fail, fill up, and lose power; people edit. Whatever a file holds then, the program starts, says what it cannot
read, loses nothing else, and can write the file again. `python -m tests.properties.fuzz damage` has as many as one likes.
"""

import io
import os
import random
import shutil
import tempfile
import traceback
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import msgspec
from numba import njit

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents import library, models, preferences
from pinjoint.documents.autosave import Autosave
from pinjoint.systems.program import cache, compiler
from tests.properties.limits import within
from tests.reference.models import triangle

LIMIT = 60.0  # s of processor time
WORDS = (
    b"",
    b"null",
    b"[]",
    b"{}",
    b"5",
    b'"text"',
    b"[" * 100_000,
    b'{"a":' * 5_000,
    b"1e999",
    b"\xff\xfe\x00",
    b"\0" * 99,
)
SETTINGS = b'{"theme": "dark", "magnification": 1.25, "keys": {"pause": {"w": "undo"}}}'
SOURCE = "from pinjoint.systems.program.kernel import kept\n\n@kept()\ndef answer(x):\n    return kernel(x)\n"


@njit
def kernel(x):  # type: ignore[no-untyped-def]
    """What the cached program calls."""
    return 2.0 * x


def damaged(content: bytes, chance: random.Random) -> bytes:
    """A content as failing disks, power cuts, full disks and people leave it."""
    at = chance.randrange(len(content) + 1)
    kind = chance.randrange(9)
    if kind == 0:
        return content[:at]
    if kind == 1:
        return chance.randbytes(len(content))
    if kind == 2:
        return chance.choice(WORDS)
    if kind == 3:
        return content[:at] + chance.choice(WORDS) + content[at:]
    if kind == 4:
        return content + content[at:]
    if kind == 5:
        length = chance.randint(1, 4096)
        return content[:at] + b"\0" * len(content[at : at + length]) + content[at + length :]
    if kind == 6:  # another number, text or word
        parts = content.split(b",")
        parts[chance.randrange(len(parts))] = chance.choice(
            (b"-1", b"1e400", b'"x"', b"null", b"[[]]", b"true")
        )
        return b",".join(parts)
    flipped = bytearray(content)
    for _ in range(1 if kind == 7 else 40):
        if flipped:
            flipped[chance.randrange(len(flipped))] ^= 1 << chance.randrange(8)
    return bytes(flipped)


def spoil(path: Path, chance: random.Random) -> None:
    """Damage a file, or put something else in its place."""
    content = path.read_bytes()
    draw = chance.random()
    if draw < 0.9:
        path.write_bytes(damaged(content, chance))
        return
    path.unlink()
    if draw < 0.95:
        path.mkdir()
    elif draw < 0.98 and hasattr(os, "symlink"):
        path.symlink_to(path)


# --- what is damaged, and what holds then ----------------------------------------------------------------


def compiled_program(folder: Path, chance: random.Random) -> None:
    """A program on disk: the same answer, whatever is there."""
    cache.folder = lambda: folder  # type: ignore[assignment]
    compiler._modules.clear()
    names = {"kernel": kernel}
    assert compiler.generated("test", SOURCE, names).load().answer(21.0) == 42.0
    for path in folder.glob("*.code"):
        spoil(path, chance)
    compiler._modules.clear()
    assert compiler.generated("test", SOURCE, names).load().answer(21.0) == 42.0


def settings(folder: Path, chance: random.Random) -> None:
    """The choices of a person: those that can be read, and new ones are kept."""
    os.environ[preferences.CONFIG_VARIABLE] = str(folder)
    path = preferences.settings_path()
    path.write_bytes(SETTINGS)
    spoil(path, chance)
    preferences.preferred("theme")
    preferences.preferred_keys()
    preferences.preferred("magnification")
    if not path.is_dir() and not path.is_symlink():
        preferences.remember("theme", "colour-blind")
        assert preferences.preferred("theme") == "colour-blind"


def journal(folder: Path, chance: random.Random) -> None:
    """A sweep that was killed: its journal is gone on with, or refused with a sentence and left as it is."""
    model, output = folder / "model.json", folder / "out.csv"
    models.save(models.parse(triangle()), model)
    words = [
        "sweep",
        str(model),
        "--vary",
        "rods.AB.stiffness=100000,200000,300000",
        "--measure",
        "energy.elastic",
        "--static",
        "--workers",
        "1",
        "--output",
        str(output),
    ]
    assert _status(words)[0] == 0
    whole = output.read_bytes()
    output.unlink()
    path = folder / "out.csv.journal"
    _kill_sweep(words)
    spoil(path, chance)
    before = path.read_bytes() if path.is_file() else b""
    status, said = _status(words)
    assert status in (0, 2), said
    if status == 0:
        assert output.read_bytes() == whole
    else:
        assert said.startswith("pinjoint: ")
        assert not path.is_file() or path.read_bytes() == before


def _kill_sweep(words: list[str]) -> None:
    """Leave the journal that a kill leaves after the last variant."""
    from pinjoint.sweeps import run

    removed, run.Journal.remove = run.Journal.remove, lambda journal: None  # type: ignore[method-assign]
    try:
        assert _status(words)[0] == 0
    finally:
        run.Journal.remove = removed  # type: ignore[method-assign]
    Path(words[-1]).unlink()


def _status(words: list[str]) -> tuple[int, str]:
    """The exit status of a command, and what it says on standard error."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        status = main(words)
    assert "Traceback" not in err.getvalue(), err.getvalue()
    return status, err.getvalue()


def unsaved_work(folder: Path, chance: random.Random) -> None:
    """What a crash left: it is offered, opened or explained, and stays until somebody discards it."""
    os.environ[library.DATA_VARIABLE] = str(folder)
    left = folder / "autosave" / "dead.1.my work.json"
    left.parent.mkdir(exist_ok=True)
    (left.parent / "dead.lock").touch()
    made = models.parse(triangle(stiffness=5.0))
    left.write_bytes(msgspec.json.encode(models.document(made)))
    _open_damaged(left, chance)


def saved_model(folder: Path, chance: random.Random) -> None:
    """A saved model: it is shown, opened or explained, and stays as it is."""
    os.environ[library.DATA_VARIABLE] = str(folder)
    path = folder / "models" / "my work.json"
    path.parent.mkdir()
    models.save(models.parse(triangle(stiffness=5.0)), path)
    _open_damaged(path, chance)


def _open_damaged(path: Path, chance: random.Random) -> None:
    """Damage a file and choose its picture among those that can be opened."""
    spoil(path, chance)
    before = path.read_bytes() if path.is_file() else None
    keeper = Autosave(interval=0.0)
    session = Session.open("isostatic", [keeper])
    session.autosave = keeper
    session.rods[0].stiffness = 7.0
    session.press("d")
    session.frame(0.1)
    session.type("my work")
    session.press("down")
    session.press("return")
    session.frame(0.1)
    opened = [document.model.rods[0].stiffness for document in session.documents if document.model.rods.count]
    assert 7.0 in opened
    assert before is None or path.read_bytes() == before
    keeper.close(session.documents)


FILES: tuple[Callable[[Path, random.Random], None], ...] = (
    compiled_program,
    settings,
    journal,
    unsaved_work,
    saved_model,
)


def attempt(seed: int) -> None:
    """Damage one file, and see that the program goes on."""
    chance = random.Random(seed)
    which = FILES[seed % len(FILES)]
    environment, found = dict(os.environ), cache.folder
    folder = Path(tempfile.mkdtemp())
    try:
        with warnings.catch_warnings(), within(LIMIT, which.__name__):
            warnings.simplefilter("error")
            which(folder, chance)
    except BaseException as error:
        error.add_note(f"{which.__name__}, seed {seed}")
        raise
    finally:
        cache.folder = found
        os.environ.clear()
        os.environ.update(environment)
        shutil.rmtree(folder, ignore_errors=True)


def explore(first: int, count: int) -> int:
    """Damage as many files; returns how many of them did harm."""
    wrong = 0
    for seed in range(first, first + count):
        try:
            attempt(seed)
        except Exception:
            wrong += 1
            print(f"damage, seed {seed}:\n{traceback.format_exc()}", flush=True)
    print(f"{count} damaged files from seed {first}, {wrong} did harm", flush=True)
    return wrong
