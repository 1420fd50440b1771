"""Autosave: unsaved work outlives a killed program, no file is ever damaged, and a clean end leaves nothing."""

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pygame
import pytest

from pinjoint import Session
from pinjoint.app import App
from pinjoint.documents import library, models
from pinjoint.documents.autosave import Autosave, recovered_name
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.scenes.files import FileScene
from tests.benchmarks.models import lattice
from tests.reference.lines import lines_run
from tests.reference.models import triangle

pytestmark = pytest.mark.usefixtures("data")

ROOT = Path(__file__).parents[2]
INTERVAL = 0.2  # s between recovery files in these tests

# A window (without a display) in which somebody never stops editing; it tells each value once it is set.
WINDOW = """
import sys, time
from pinjoint.documents import models
from pinjoint.app import App
from pinjoint.documents.open_documents import ModelFile
from pinjoint.documents.autosave import Autosave
app = App(models.load(sys.argv[1]), ModelFile(None, "work"), Autosave(interval=float(sys.argv[2])))
value = 1000.0
while not app.input.closed:
    value += 1.0
    app.session.rods[0].stiffness = value
    app.frame(0.01)
    print(value, flush=True)
"""


@contextmanager
def window(model: Path, interval: float = INTERVAL) -> Iterator[subprocess.Popen[str]]:
    """A running window in another process, killed at the end if it still runs."""
    environment = os.environ | {"SDL_AUDIODRIVER": "dummy"}
    command = [sys.executable, "-c", WINDOW, str(model), str(interval)]
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def values_until(process: subprocess.Popen[str], seconds: float) -> list[tuple[float, float]]:
    """(when, value) of what a window told in so many seconds after its first word."""
    assert process.stdout is not None
    told: list[tuple[float, float]] = []
    for line in process.stdout:
        if line[0].isdigit():
            told.append((time.monotonic(), float(line)))
            if told[-1][0] - told[0][0] > seconds:
                return told
    raise AssertionError("The window ended by itself.")


@pytest.fixture
def model_file(tmp_path: Path) -> Path:
    models.save(models.parse(triangle()), tmp_path / "model.json")
    return tmp_path / "model.json"


def stiffness_in(path: Path) -> float:
    """That of the first rod in a file."""
    model = models.load(path)
    return float(model.rods.stiffness[0])


def kept(keeper: Autosave, session: Session) -> None:
    """Let frames pass until everything is written."""
    for _ in range(200):
        keeper.process(session.frame(0.0))
        if all(
            document.recovery is not None and document.recovery.exists()
            for document in session.documents
            if document.unsaved
        ):
            return
        time.sleep(0.01)
    raise AssertionError("Unsaved work was not written within 2 s.")


def gone(session: Session, data: Path) -> None:
    """Let frames pass until there are no recovery files."""
    for _ in range(200):
        session.frame(0.0)
        if not list((data / "autosave").glob("*.json")):
            return
        time.sleep(0.01)
    raise AssertionError("What was saved still had a recovery file after 2 s.")


# --- a program that is killed ------------------------------------------------------------------------


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_a_killed_window_loses_at_most_the_last_moments(model_file: Path) -> None:
    with window(model_file) as process:
        told = values_until(process, 1.5)
        process.send_signal(signal.SIGKILL)
        process.wait()
    (left,) = Autosave().left()
    recovered = models.load(left)
    value = recovered.rods[0].stiffness
    assert told[0][1] < value <= told[-1][1]  # how long ago, a busy machine decides
    assert recovered_name(left) == "work"


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_no_moment_of_being_killed_damages_a_file(tmp_path: Path, data: Path) -> None:
    large = lattice(3000)
    models.save(large, tmp_path / "large.json")
    rng = np.random.default_rng(7)
    for kills in (1, 2):
        with window(tmp_path / "large.json", interval=0.0) as process:  # writes without a pause
            values_until(process, 0.5 + 0.3 * rng.random())
            process.send_signal(signal.SIGKILL)
            process.wait()
        files = list((data / "autosave").glob("[!.]*.json"))
        assert len(files) == kills
        for file in files:
            recovered = models.load(file)
            assert recovered.rods.count == large.rods.count


def test_closing_the_window_keeps_what_nobody_saved(model_file: Path, data: Path) -> None:
    keeper = Autosave(interval=0.0)
    app = App(models.load(model_file), ModelFile(None, "work"), keeper)
    app.session.rods[0].stiffness = 5.0
    kept(keeper, app.session)
    assert list((data / "autosave").glob("*.json"))
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    app.run()
    (left,) = Autosave().left()
    assert stiffness_in(left) == 5.0
    assert recovered_name(left) == "work"
    assert not (data / "models").exists(), "it is no model that somebody saved"


def test_closing_keeps_every_model_with_unsaved_work_and_no_other(data: Path) -> None:
    keeper = Autosave(interval=60.0)  # which writes the first one in time, and the others at the end
    session = Session.open(triangle(), [keeper])
    session.autosave = keeper
    session.rods["AB"].stiffness = 5.0
    kept(keeper, session)
    for stiffness in (6.0, 7.0):
        session.documents.open("isostatic")
        session.rods["AB"].stiffness = stiffness
    session.documents.open("tower")
    session.run(steps=3)
    keeper.close(session.documents)
    later = Autosave()
    assert sorted(map(stiffness_in, later.left())) == [5.0, 6.0, 7.0]
    again = with_autosave(later)
    again.press("d")
    scene = again.scenes.active
    assert isinstance(scene, FileScene)
    offered = [tile for tile in scene.form.tiles if tile.source in later.left()]
    assert len(offered) == 3, "the start page shows them all"
    later.close(again.documents)
    assert len(Autosave().left()) == 3, "until they are saved or discarded"


# --- what is kept, and when --------------------------------------------------------------------------


def test_what_is_saved_needs_no_recovery_file(data: Path) -> None:
    keeper = Autosave(interval=0.0)
    session = Session.open(triangle(), [keeper])
    session.frame(0.0)
    assert not list((data / "autosave").glob("*.json"))
    session.rods["AB"].stiffness = 5.0
    kept(keeper, session)
    session.document.save_as(data / "a.json")
    gone(session, data)
    keeper.close(session.documents)
    assert not (data / "models").exists()


def passing(keeper: Autosave, session: Session) -> str:
    """Let a file be written, or not; returns what is said then."""
    session.notice, keeper._due = "", 0.0
    session.frame(0.0)
    assert keeper._thread is not None
    keeper._thread.join(10.0)
    session.frame(0.0)
    keeper._thread.join(10.0)  # of the next one
    return session.notice


def test_a_full_disk_is_said_once_and_what_it_kept_out_is_written_once_there_is_room(
    data: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def full(handle: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    keeper = Autosave(interval=0.0)
    session = Session.open(triangle(), [keeper])
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        for stiffness, is_said in ((5.0, True), (6.0, False)):
            session.rods["AB"].stiffness = stiffness
            said = passing(keeper, session)
            assert ("a crash would lose it" in said and "No space left" in said) is is_said
        assert not list((data / "autosave").glob("*.json"))
        assert not list((data / "autosave").glob(".*.tmp"))
    passing(keeper, session)
    (written,) = (data / "autosave").glob("*.json")
    assert stiffness_in(written) == 6.0, "though nobody edited it since"
    session.rods["AB"].stiffness = 7.0
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        passing(keeper, session)
    keeper.close(session.documents)
    assert stiffness_in(written) == 7.0, "also if the window is closed before it would be tried again"
    assert not caplog.records


def test_work_that_is_lost_as_the_window_closes_is_told_of(
    data: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    keeper = Autosave(interval=0.0)
    session = Session.open(triangle(), [keeper])
    session.rods["AB"].stiffness = 5.0

    def no_memory(path: Path, content: bytes) -> None:
        raise MemoryError

    monkeypatch.setattr(models, "replace", no_memory)
    keeper.close(session.documents)
    assert "MemoryError" in caplog.text


def test_a_model_that_no_file_can_hold_is_told_of_and_keeps_the_others_from_nothing(data: Path) -> None:
    keeper = Autosave(interval=0.0)
    session = Session.open(triangle(), [keeper])
    session.rods["AB"].stiffness = 5.0
    session.model.writable("particles.velocity")[0] = np.nan
    said = passing(keeper, session)
    assert "a crash would lose it" in said
    assert "nan" in said
    session.documents.open("isostatic")
    session.rods["AB"].stiffness = 7.0
    passing(keeper, session)
    (written,) = (data / "autosave").glob("*.json")
    assert stiffness_in(written) == 7.0
    keeper.close(session.documents)


def test_what_a_program_left_that_was_killed_while_it_saved_is_deleted(tmp_path: Path) -> None:
    """But nothing of one that may still be saving, nor what only looks alike."""
    killed, saving, alike = (tmp_path / f".{32 * letter}.tmp" for letter in "abg")
    for file in (killed, saving, alike):
        file.write_text("half")
    for file in (killed, alike):
        os.utime(file, 2 * (time.time() - 2.0 * models.LEFT,))
    models.replace(tmp_path / "model.json", b"content")
    assert {*tmp_path.glob(".*.tmp")} == {saving, alike}


def test_a_model_that_was_saved_and_left_at_once_leaves_no_recovery_file(data: Path) -> None:
    keeper = Autosave(interval=0.0)
    session = Session.open(triangle(), [keeper])
    session.rods["AB"].stiffness = 5.0
    kept(keeper, session)
    session.document.save_as(data / "a.json")
    session.documents.open("tower")
    keeper.close(session.documents)
    assert list((data / "autosave").iterdir()) == []


def test_a_recovery_file_is_written_at_most_every_few_seconds(data: Path) -> None:
    keeper = Autosave(interval=60.0)
    session = Session.open(triangle(), [keeper])
    session.rods["AB"].stiffness = 5.0
    kept(keeper, session)
    (file,) = (data / "autosave").glob("*.json")
    for value in range(6, 30):
        session.rods["AB"].stiffness = float(value)
        session.frame(0.0)
    assert keeper._thread is not None
    keeper._thread.join()  # of what would have been written too soon
    content = models.load(file)
    assert content.rods["AB"].stiffness == 5.0
    keeper.close(session.documents)


def test_ten_thousand_rods_do_not_stop_the_picture() -> None:
    keeper = Autosave(interval=0.0)
    session = Session(lattice(10_000), [])
    session.rods[0].stiffness = 5.0
    frame = session.frame(0.0)
    assert lines_run(lambda: keeper.process(frame)) < 2000  # none for each rod: a thread writes them
    kept(keeper, session)
    keeper.close(session.documents)


# --- recovery ----------------------------------------------------------------------------------------


def left_behind(data: Path, stiffness: float) -> Path:
    """What a program that crashed left: a lock that nobody holds any more, and a recovery file."""
    folder = data / "autosave"
    folder.mkdir(parents=True)
    (folder / "dead.lock").touch()
    model = models.parse(triangle(stiffness=stiffness))
    models.save(model, folder / "dead.1.my work.json")
    return folder / "dead.1.my work.json"


def with_autosave(keeper: Autosave) -> Session:
    session = Session.open(triangle(), [keeper])
    session.autosave = keeper
    return session


def test_what_was_left_behind_is_offered_first_and_opened(data: Path) -> None:
    left = left_behind(data, 5.0)
    keeper = Autosave(interval=0.0)
    session = with_autosave(keeper)
    session.press("d")
    scene = session.scenes.active
    assert isinstance(scene, FileScene)
    tile = scene.form.tiles[0]
    assert (tile.section, tile.title) == ("Your models", "my work")
    assert tile.caption.startswith("not saved")
    session.press("down")
    session.press("return")
    assert session.rods["AB"].stiffness == 5.0
    assert session.document.unsaved
    assert session.document.file == ModelFile(None, "my work"), "Ctrl+S asks for a name"
    session.rods["AB"].stiffness = 6.0
    kept(keeper, session)
    assert left.exists(), "until it is saved it can be recovered again"
    session.press("s")
    session.press("return")
    gone(session, data)
    keeper.close(session.documents)
    assert list((data / "autosave").iterdir()) == []


def test_what_was_left_behind_is_discarded_when_asked_twice(data: Path) -> None:
    left = left_behind(data, 5.0)
    keeper = Autosave()
    session = with_autosave(keeper)
    session.press("d")
    scene = session.scenes.active
    assert isinstance(scene, FileScene)
    assert scene.form.tiles[1].title == "Discard"
    for _ in range(2):
        session.press("down" if scene.form.chosen is None else "right")
    session.press("return")
    assert "deleted for ever" in scene.form.message
    assert left.exists()
    session.press("return")
    assert not left.exists()
    assert scene.form.tiles[0].title == "Learn: 1 Draw a structure"
    keeper.close(session.documents)
    assert Autosave().left() == []


def test_unsaved_work_of_a_running_program_is_not_offered(model_file: Path, data: Path) -> None:
    with window(model_file) as process:
        values_until(process, 0.6)
        assert list((data / "autosave").glob("*.json"))
        keeper = Autosave()
        assert keeper.left() == []
        keeper.close([])
        assert list((data / "autosave").glob("*.json"))


def test_scripts_write_nothing(data: Path) -> None:
    session = Session.open(triangle())
    session.rods["AB"].stiffness = 5.0
    session.frame(5.0)
    assert not data.exists()


def test_what_is_no_file_is_passed_over(data: Path) -> None:
    """The other recovery files are offered, and unsaved work is kept."""
    left = left_behind(data, 5.0)
    folder = left.parent
    (folder / "other.lock").mkdir()
    (folder / "dead.2.folder.json").mkdir()
    if hasattr(os, "symlink"):
        (folder / "dead.3.loop.json").symlink_to(folder / "dead.3.loop.json")
    keeper = Autosave(interval=0.0)
    assert left in keeper.left()
    session = with_autosave(keeper)
    session.rods["AB"].stiffness = 6.0
    kept(keeper, session)
    keeper.discard()
    assert not left.exists()
    keeper.close(session.documents)


@pytest.mark.skipif(not hasattr(os, "symlink"), reason="the system has no links")
def test_a_saved_model_that_is_gone_hides_no_other(data: Path) -> None:
    (data / "models").mkdir(parents=True)
    models.save(models.parse(triangle()), data / "models" / "a.json")
    (data / "models" / "b.json").symlink_to(data / "models" / "gone.json")
    assert [path.stem for path in library.saved()] == ["a"]
