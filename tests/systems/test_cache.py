"""The cache of compiled programs: damaged files are compiled anew, and a full disk is done without."""

import os
import random
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from numba import njit

from pinjoint.systems.program import cache, compiler

SOURCE = """
from pinjoint.systems.program.kernel import kept

@kept()
def answer(x):
    return kernel(x)
"""


def emptied(content: bytes) -> bytes:
    """As a power cut leaves it."""
    return b""


def cut(content: bytes) -> bytes:
    """As a full disk leaves it."""
    return content[: len(content) // 2]


def garbage(content: bytes) -> bytes:
    """As a damaged file system leaves it."""
    return random.Random(1).randbytes(len(content))


def flipped(content: bytes) -> bytes:
    """As a failing disk leaves it: machine code with other bytes here and there."""
    damaged, chance = bytearray(content), random.Random(1)
    for _ in range(50):
        damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
    return bytes(damaged)


ROOT = Path(__file__).parents[2]
DAMAGES = (emptied, cut, garbage, flipped)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    monkeypatch.setattr(cache, "TROUBLE", [])
    monkeypatch.setattr(cache, "SAID", [])
    return tmp_path


@njit
def kernel(x):  # type: ignore[no-untyped-def]
    return 2.0 * x


def answer(monkeypatch: pytest.MonkeyPatch) -> float:
    """What the compiled module answers that a new process would load."""
    monkeypatch.setattr(compiler, "_modules", {})
    return float(compiler.generated("test", SOURCE, {"kernel": kernel}).load().answer(21.0))


def test_what_was_written_is_read(folder: Path) -> None:
    cache.write("some.code", b"content")
    assert cache.read("some.code") == b"content"
    assert cache.read("other.code") is None
    assert [path.name for path in folder.iterdir()] == ["some.code"]


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_program_is_compiled_anew(
    folder: Path, monkeypatch: pytest.MonkeyPatch, damage: Callable[[bytes], bytes]
) -> None:
    assert answer(monkeypatch) == 42.0
    (kept,) = folder.glob("*.code")
    kept.write_bytes(damage(kept.read_bytes()))
    assert answer(monkeypatch) == 42.0
    assert cache.read(kept.name) is not None


def test_a_program_that_cannot_be_loaded_is_compiled_anew(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is whole, but of no use here: what it names is gone. That is said once, and not found again."""
    answer(monkeypatch)
    (kept,) = folder.glob("*.code")
    for _ in range(2):
        cache.write(kept.name, b"cgone_module\nname\n.")
        assert answer(monkeypatch) == 42.0
    assert len(cache.SAID) == 1
    assert "gone_module" in cache.SAID[0]
    assert len(cache.read(kept.name) or b"") > 1000


def test_a_file_in_the_place_of_another_is_deleted(folder: Path) -> None:
    """Both are whole: one entry run as another would be called with arguments that it does not take."""
    cache.write("some.code", b"content")
    os.replace(folder / "some.code", folder / "other.code")
    assert cache.read("other.code") is None
    assert not any(folder.iterdir())


def _by_a_link(path: Path) -> None:
    path.replace(path.with_name("elsewhere"))
    path.symlink_to(path.with_name("elsewhere"))


REFUSALS: dict[str, Callable[[Path], None]] = {
    "may write to it": lambda path: path.chmod(path.stat().st_mode | 0o020),
    "others may write": lambda path: path.chmod(path.stat().st_mode | 0o002),
    "is a link": _by_a_link,
}
POSIX = pytest.mark.skipif(
    not hasattr(os, "getuid"), reason="files have owners and modes on POSIX systems only"
)


@POSIX
@pytest.mark.parametrize("why", [*REFUSALS, "another user"])
def test_a_file_that_others_could_have_written_is_not_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch, why: str
) -> None:
    assert answer(monkeypatch) == 42.0
    (kept,) = folder.glob("*.code")
    if why in REFUSALS:
        REFUSALS[why](kept)
    else:
        monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert cache.read(kept.name) is None
    assert not kept.exists()
    assert not kept.is_symlink()
    assert len(cache.SAID) == 1
    assert str(kept) in cache.SAID[0]
    assert why in cache.SAID[0]
    monkeypatch.undo()
    monkeypatch.setattr(cache, "folder", lambda: folder)
    assert answer(monkeypatch) == 42.0
    assert cache.read(kept.name) is not None


@POSIX
@pytest.mark.parametrize("why", [*REFUSALS, "another user", "may write to"])
@pytest.mark.parametrize("own", [True, False], ids=["own", "temporary"])
def test_a_folder_that_others_could_have_written_in_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, own: bool, why: str
) -> None:
    """The other place is taken, where that is safe; else nothing is kept, and both are said."""
    monkeypatch.setattr(cache, "SAID", [])
    monkeypatch.setattr(cache, "TROUBLE", [])
    cached, temporary = tmp_path / "cache", tmp_path / "temporary"
    temporary.mkdir()
    if not own:
        cached.write_text("not a folder")
    monkeypatch.setattr(cache, "user_cache_path", lambda name: cached)
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(temporary))
    find: Callable[[], Path] = cache.folder.__wrapped__
    found = find()
    assert found.parent == (cached if own else temporary)
    assert not cache.SAID
    if why in REFUSALS:
        REFUSALS[why](found)
    elif why == "another user":
        monkeypatch.setattr(cache, "_user", lambda: 12345)
        found.rename(found := temporary / "pinjoint-programs-12345") if not own else None
    else:
        found.parent.chmod(0o777)
    later = find()
    assert later.parent == temporary if own and why != "another user" else later == cache.NOWHERE
    assert str(found) in cache.SAID[0]
    assert why in cache.SAID[0]
    assert bool(cache.TROUBLE) == (later == cache.NOWHERE)


def test_a_folder_in_the_place_of_a_file_is_done_without(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer(monkeypatch)
    (kept,) = folder.glob("*.code")
    kept.unlink()
    kept.mkdir()
    assert answer(monkeypatch) == 42.0


OWN = """
from numba import njit

@njit(cache=True)
def twice(x):
    return 2.0 * x

@njit(cache=True)
def kernel(x):
    return twice(x)
"""


@pytest.mark.parametrize("damage", [emptied, flipped])
def test_a_cache_that_numba_keeps_of_a_kernel_is_not_trusted(
    folder: Path, monkeypatch: pytest.MonkeyPatch, damage: Callable[[bytes], bytes]
) -> None:
    """A mod may have written `cache=True`."""
    path = folder / "own_cache.py"
    path.write_text(OWN)
    names: dict[str, Any] = {"__name__": "own_cache", "__file__": str(path)}
    exec(compile(OWN, path, "exec"), names)
    assert names["kernel"](21.0) == 42.0
    for kept in (folder / "__pycache__").iterdir():
        kept.write_bytes(damage(kept.read_bytes()))
    exec(compile(OWN, path, "exec"), names)
    monkeypatch.setattr(compiler, "_modules", {})
    assert compiler.generated("test", SOURCE, {"kernel": names["kernel"]}).load().answer(21.0) == 42.0


FULL = """
import resource
import signal

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))  # every write to a file fails
from numba import njit
from pinjoint.systems.program.compiler import entries_to, generated

double = njit(lambda x: 2 * x)
module = generated("test", *entries_to({"answer": double})).load()
print(module.answer(21.0), module.answer(21))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="processes have no limits there")
def test_a_full_disk_is_done_without_and_said_once(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FULL],
        env=os.environ | {"XDG_CACHE_HOME": str(tmp_path), "HOME": str(tmp_path), "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.stdout.split() == ["42.0", "42"]
    assert done.stderr.count("cannot be kept") == 1
    assert str(tmp_path) in done.stderr
    assert "Traceback" not in done.stderr
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]
