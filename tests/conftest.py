"""What several test folders share."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import chdir
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from pinjoint.commands.command_line import main
from pinjoint.components.language import ENGLISH, spoken
from pinjoint.documents import library, preferences
from pinjoint.systems.program.compiler import Choice

ROOT = Path(__file__).resolve().parents[1]
# windows of tests, and of processes that they start, are seen by nobody
os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

# The first example of a plan may compile for seconds, so no example has a deadline. The same examples every
# time, so that a change is judged by what it changed; `--hypothesis-profile=explore` looks for new ones.
settings.register_profile("explore", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("pinjoint", settings.get_profile("explore"), derandomize=True)
settings.load_profile("pinjoint")


@pytest.fixture(autouse=True, scope="session")
def folder_of_the_tests(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tests leave nothing in the repository and with the user: keys and commands write where they are."""
    with pytest.MonkeyPatch.context() as patched, chdir(tmp_path_factory.mktemp("tests")):
        patched.setenv("PYTHONPATH", str(ROOT))  # for the processes that they start
        patched.setenv(library.DATA_VARIABLE, str(tmp_path_factory.mktemp("data")))
        patched.setenv(preferences.CONFIG_VARIABLE, str(tmp_path_factory.mktemp("config")))
        patched.setenv("PINJOINT_LANGUAGE", ENGLISH)
        yield


@pytest.fixture(autouse=True)
def form_of_programs() -> Iterator[None]:
    """A window that is left open would have all later tests interpreted, and compile for as long as they run."""
    before = Choice.compile
    yield
    assert Choice.compile is before, "close the window, or its Preparation, at the end of the test"


@pytest.fixture(autouse=True)
def kernels_of_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    """Laws that tests declare begin interpreted, as ours do: compiling each would take most of the time of all tests."""
    monkeypatch.setattr(Choice, "proved", ("pinjoint.", "tests."))


@pytest.fixture
def kernels_of_mods(kernels_of_tests: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Laws that the test declares are compiled before their first step, as those of mods are."""
    monkeypatch.setattr(Choice, "proved", ("pinjoint.",))


@pytest.fixture(autouse=True)
def in_english() -> Iterator[None]:
    """Tests that speak another language do so for themselves only."""
    with spoken(ENGLISH):
        yield


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the person's own models and recovery files, which is made when it is needed."""
    monkeypatch.setenv(library.DATA_VARIABLE, str(tmp_path / "data"))
    return tmp_path / "data"


@pytest.fixture
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the person's choices, which is made when it is needed."""
    monkeypatch.setenv(preferences.CONFIG_VARIABLE, str(tmp_path / "config"))
    return tmp_path / "config"


@pytest.fixture
def hears_interrupts() -> Iterator[None]:
    """Processes that the test starts hear Ctrl+C, even if it was started where that is ignored, by "&" above all."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., Any]:
    """Run a command that ends with `status`; returns the JSON that it prints. A model among its words is put into a file."""

    def run(*words: str | Mapping[str, Any], status: int = 0) -> Any:
        file, given = tmp_path / "model.json", []
        for word in words:
            if not isinstance(word, str):
                file.write_text(json.dumps(word), encoding="utf-8")
            given.append(word if isinstance(word, str) else str(file))
        assert main([*given, "--format", "json"]) == status
        return json.loads(capsys.readouterr().out)

    return run


@pytest.fixture
def fresh_process() -> Callable[..., str]:
    """Run Python code in a process of its own; returns what it printed. `environment` adds variables."""

    def run(code: str, environment: Mapping[str, str] | None = None, timeout: float = 300.0) -> str:
        finished = subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | dict(environment or {}),
            capture_output=True,
            text=True,
            timeout=timeout,
        )
        assert finished.returncode == 0, finished.stdout + finished.stderr
        return finished.stdout

    return run
