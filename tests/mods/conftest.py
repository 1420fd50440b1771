"""What the tests of mods share."""

import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import pinjoint.api  # noqa: F401 (the mods that are included come before those of tests)
from pinjoint import mods
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.program.compiler import VARIABLE, Choice, Compile

Write = Callable[..., Path]


@pytest.fixture(autouse=True)
def interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Laws are interpreted, in processes that a test starts, too, unless it is about compiling them."""
    monkeypatch.setattr(Choice, "compile", Compile.NEVER)
    monkeypatch.setenv(VARIABLE, Compile.NEVER.value)


@pytest.fixture
def compiling(interpreted: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs with laws are compiled before their first step."""
    monkeypatch.setattr(Choice, "compile", Compile.SOON)


@pytest.fixture
def unloaded(data: Path, config: Path) -> Iterator[None]:
    """A program without a person's files; the mods that a test loads are unloaded after it."""
    before, keys = len(mods.MODS), dict(ACTIONS)
    yield
    mods.unload(mods.MODS[before:])
    mods.FAULTS.clear()
    assert keys == dict(ACTIONS)


@pytest.fixture
def in_window(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sessions say that a mod fails, and go on without it, as in a window."""
    monkeypatch.setattr("pinjoint.session.check_mods", lambda known: None)


@pytest.fixture
def write_mod(tmp_path: Path, unloaded: None) -> Write:
    """Write a mod into the folder tmp_path/mods/NAME; `manifest` adds lines, `code` is its __init__.py."""

    def write(name: str, code: str = "def plugin(app): pass", manifest: str = "", version: str = "1.0") -> Path:
        folder = tmp_path / "mods" / name
        folder.mkdir(parents=True)
        head = f'name = "{name}"\nversion = "{version}"\n'
        (folder / "mod.toml").write_text(head + manifest + "\n", encoding="utf-8")
        (folder / "__init__.py").write_text(textwrap.dedent(code), encoding="utf-8")
        return folder

    return write
