"""A person who does anything, in every scene: `python -m tests.properties.fuzz editing --count 20 --seed 1`.

What they do is recorded like any session, so that a failure can be played again by `pinjoint play`. After
every action the models are sound; from time to time a file is saved and read, and the picture composed. At
the end, undoing everything leads to the start bit for bit, doing it all again to the end, and the recording
played in another session to the same end.
"""

import argparse
import contextlib
import importlib
import os
import random
import tempfile
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from pinjoint import Session
from pinjoint.components.field import Vector
from pinjoint.components.model import Model
from pinjoint.components.view import drawn_positions
from pinjoint.documents import library, models
from pinjoint.documents.library import data_in
from pinjoint.documents.open_documents import OpenDocument
from pinjoint.scripts.playing import Recorder, play, session_of
from pinjoint.scripts.script import EMPTY, Script
from pinjoint.systems.input.actions import ACTIONS, LIVE, TEXT
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.properties.soundness import Print, check_sound, contents
from tests.reference.sessions import put_states_aside

SIZES = ((640, 480), (1000, 720), (320, 240), (1920, 1080), (50, 50), (1200, 300), (1, 1))
TEXTS = (
    "0",
    "1",
    "-1",
    "0.5",
    "100",
    "200000",
    "1e3",
    "1e-9",
    "1e300",
    "-",
    ".",
    "yes",
    "a b",
    "é/π",
    "rod 1",
    "",
)
MOUSE = (
    *("click", "click", "double click", "right click", "ctrl+click", "drag", "ctrl+drag"),
    *("wheel up", "wheel down", "drag middle"),
)
OFTEN = {  # keys that are pressed more often than others, so that every scene is seen as much as any
    "simulation": ("l", "p", "i", "drag", "space"),
    "pause": (*"pplllcfv", "ctrl+r", "ctrl+j", "ctrl+m", *"kkk", "return", "space", "space", *"eh"),
    "statics": (*"zzqqiil", "drag", "return", "space", "delete"),
    "properties": ("escape", "tab", "tab", "return", "up", "down"),
    "save": ("escape", "return", "return"),
    "load": ("escape", "escape", "down", "return", "return"),
    "force method": ("k", "k", "k", "k", "click", "click", "click", "x", "y", "i"),
    "displacement method": (*"kkkkbn", "click", "click", "i"),
}
FRAMES = (0.0, 1.0 / 60.0, 1.0 / 60.0, 0.1)
KINDS = {  # what `python -m tests.properties.fuzz` can try: modules with explore(first seed, count)
    "editing": "tests.properties.fuzz",
    "windows": "tests.properties.windows",
    "damage": "tests.properties.damage",
    "models": "tests.properties.hostile_models",
    "statics": "tests.properties.solved_edits",
}
MOST_ELEMENTS = 150  # beyond this the person deletes before going on, so that everything stays quick


class Fuzz:
    """One session of random actions, from a seed: the same actions every time."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.random = random.Random(seed)
        self.folder = folder
        os.environ[library.DATA_VARIABLE] = str(folder / f"data-{seed}")
        self.record = folder / f"fuzz-{seed}.jsonl"
        source: Any = self.random.choice([EMPTY, *models.bundled()])
        self.session = Session.open(source)
        if seed % 2:  # most states of the undo log come back from a file
            put_states_aside(self.session, beyond=4 * self.session.simulation.checkpoint().state.nbytes)
        self._file = self.record.open("w", encoding="utf-8")
        self.recorder = Recorder(self.session, self._file, source)
        self.starts: WeakKeyDictionary[OpenDocument, Print] = WeakKeyDictionary()
        self._note_desk()

    def _note_desk(self) -> None:
        document = self.session.document
        if document not in self.starts and not document.history.can_undo:  # F7 opens a task and does it
            self.starts[document] = contents(document.model)

    # --- doing ---------------------------------------------------------------------------------------

    def act(self) -> None:
        """One action of the person."""
        session, chance = self.session, self.random.random()
        if session.model.particles.count + session.model.rods.count > MOST_ELEMENTS and session.scene in LIVE:
            self._do("ctrl+a", (0.0, 0.0))
            self._do("delete", (0.0, 0.0))
        elif chance < 0.40:
            known = [binding.key for _, binding in ACTIONS.bound() if session.scene in binding.scenes]
            self._press(self.random.choice([*known, *2 * OFTEN[session.scene]]))
        elif chance < 0.45:
            self._press(self.random.choice([binding.key for _, binding in ACTIONS.bound()]))
        elif chance < 0.65:
            self._press(self.random.choice(MOUSE))
        elif chance < 0.80:
            self._do(TEXT + self.random.choice(TEXTS))
        elif chance < 0.97:
            session.frame(self.random.choice(FRAMES))
        else:
            self._resize()
        self._note_desk()

    def _press(self, key: str) -> None:
        if key == "drag middle":
            self._do(key, (self.random.uniform(-300.0, 300.0), self.random.uniform(-300.0, 300.0)))
        else:
            self._do(key, self._place())
        if key.endswith("drag"):
            for _ in range(self.random.randrange(3)):
                self._do("drag to", self._place())
            if self.random.random() < 0.9:
                self._do("drop", self._place())

    def _do(self, key: str, place: Vector | None = None) -> None:
        """Press a key, after a frame, with the pointer at a place."""
        self.session.update_view()
        if place is not None and key != "drag middle":
            self.session.view.pointer = place
        self.session.press(key, place)

    def _place(self) -> Vector:
        """A pixel: mostly an element or near one."""
        stages = [(shown, view) for shown, view in self.session.stages if isinstance(shown, Model)]
        model, view = stages[0] if stages else (self.session.model, self.session.view)
        viewport = self.session.view.camera.viewport
        pixels = view.camera.to_pixels(drawn_positions(model)) if model.particles.count else np.empty((0, 2))
        near = pixels[np.isfinite(pixels).all(axis=1) & (np.abs(pixels) < 1e6).all(axis=1)]
        if not len(near) or self.random.random() < 0.4:
            return self.random.uniform(0, viewport.width), self.random.uniform(0, viewport.height)
        one, other = near[self.random.randrange(len(near))], near[self.random.randrange(len(near))]
        x, y = (one if self.random.random() < 0.7 else (one + other) / 2.0).tolist()
        return x + self.random.randint(-6, 6), y + self.random.randint(-6, 6)

    def _resize(self) -> None:
        self.session.resize(*self.random.choice(SIZES), self.random.choice((1.0, 1.0, 2.0)))

    # --- checking ------------------------------------------------------------------------------------

    def check(self) -> None:
        """What holds after every action."""
        for document in self.session.documents:
            check_sound(document.model)
        camera = self.session.view.camera
        assert np.isfinite([*camera.centre, camera.scale]).all()

    def check_file(self) -> None:
        """The model as it is now can be saved, and what is read is what was written."""
        path = self.folder / "saved.json"
        models.save(self.session.model, path)
        read = contents(models.load(path))
        here = contents(self.session.model)
        for name, column in here.items():
            if "." in name:
                assert read[name] == column, name

    def check_picture(self) -> None:
        """What is shown can be drawn."""
        self.session.update_view()
        for shown, view in self.session.stages:
            compose(shown, view, load_theme(self.session.view.theme))

    def run(self, actions: int) -> None:
        """Act and check, then go through the whole log."""
        for number in range(actions):
            self.act()
            self.check()
            if number % 50 == 0:
                self.check_file()
            if number % 10 == 0:
                self.check_picture()
        self._come_to_pause()
        end = contents(self.session.model)
        self._file.close()
        self.check_replay(end)
        self.check_log()

    def _come_to_pause(self) -> None:
        session = self.session
        if session.gesture is not None:
            self._do("drop")
        for _ in range(4):
            if session.scene == "simulation":
                self._do("space")
            elif session.scene != "pause":
                self._do("escape")
        if session.scene == "statics":
            self._do("q")
        assert session.scene == "pause", session.scene

    def check_log(self) -> None:
        """Undo all = start, redo all = end, for every model that is open."""
        session = self.session
        while session.redo():
            pass
        end, entries = contents(session.model), 0
        while True:
            if not session.document.history.can_undo and session.document in self.starts:
                assert _same(contents(session.model), self.starts[session.document])
            if not session.undo():
                break
            entries += 1
            check_sound(session.model)
        for _ in range(entries):
            assert session.redo()
        assert _same(contents(session.model), end)
        assert not session.redo()

    def check_replay(self, end: Print) -> None:
        """The recording, played in another session, ends with the same bits."""
        os.environ[library.DATA_VARIABLE] += "-replayed"
        script = Script(self.record)
        session = session_of(script)
        assert play(script, session) == []
        again = contents(session.model)
        for name, column in end.items():
            if "." in name:
                assert again[name] == column, name


def _same(one: Print, other: Print) -> bool:
    """Compares with a message that names what differs."""
    for name in one:
        assert one[name] == other[name], name
    return one.keys() == other.keys()


def explore(first: int, count: int, actions: int = 500) -> int:
    """Sessions with so many actions each; returns how many went wrong."""
    wrong = 0
    with data_in() as folder, contextlib.chdir(folder):
        for seed in range(first, first + count):
            fuzz = Fuzz(seed, folder)
            try:
                fuzz.run(actions)
            except Exception:
                wrong += 1
                kept = Path(tempfile.gettempdir()) / fuzz.record.name
                kept.write_bytes(fuzz.record.read_bytes())
                print(
                    f"editing, seed {seed}, what was done is in {kept}:\n{traceback.format_exc()}", flush=True
                )
            else:
                print(f"editing, seed {seed}: {actions} actions, sound", flush=True)
    return wrong


def main(words: Sequence[str] | None = None) -> int:
    """Try what is named, or everything; returns 1 if anything went wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.properties.fuzz", description=__doc__)
    parser.add_argument("what", nargs="*", metavar="WHAT", help=f"of {', '.join(KINDS)}; all by default")
    parser.add_argument("--count", type=int, default=20, help="of sessions, windows, files, …, of each kind")
    parser.add_argument("--seed", type=int, default=1, help="of the first one")
    parser.add_argument("--actions", type=int, help="of each, where editing or windows are tried alone")
    options = parser.parse_args(words)
    if unknown := set(options.what) - set(KINDS):
        parser.error(f"there is no {', '.join(unknown)}; choose from {', '.join(KINDS)}")
    tried = [importlib.import_module(KINDS[name]) for name in options.what or KINDS]
    given = () if options.actions is None else (options.actions,)
    return int(sum(module.explore(options.seed, options.count, *given) for module in tried) > 0)


if __name__ == "__main__":
    raise SystemExit(main())
