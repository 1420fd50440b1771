"""A monkey at a window: random keys, clicks, drags, wheels and sizes, in every scene of every bundled model.

Nothing that it does may raise, warn, or take a minute; the models stay sound, and edits that nobody saved are there
when the window was closed. `python -m tests.properties.fuzz windows` has as many as one likes.
"""

import contextlib
import os
import random
import traceback
import warnings
from pathlib import Path
from typing import Any

import pygame

from pinjoint.app import App
from pinjoint.documents import library, models
from pinjoint.documents.autosave import Autosave
from pinjoint.documents.library import data_in
from pinjoint.documents.open_documents import ModelFile
from pinjoint.documents.preferences import CONFIG_VARIABLE
from pinjoint.scripts.performance import Performance
from pinjoint.systems.input import pygame_input
from pinjoint.systems.input.actions import ACTIONS
from tests.properties.fuzz import OFTEN, TEXTS
from tests.properties.limits import within
from tests.properties.soundness import check_sound, contents

LIMIT = 60.0  # s of processor time that a frame may take, compiling included
MOST_ELEMENTS = 1500  # beyond this everything is deleted, so that frames stay quick
SIDES = (1, 2, 5, 17, 40, 120, 240, 320, 400, 640, 720, 1000, 1080)
LARGEST = 3840, 2160  # pixels
RATIOS = (1.0, 1.0, 1.25, 1.5, 2.0, 3.0)
ELAPSED = (0.0, 1.0 / 60.0, 1.0 / 60.0, 0.1, 1.0, 30.0)
LONG = ("x" * 100_000, "1" * 100_000, "\n\t\0", "\ud800", "नमस्ते e\u0301 \u202e🏗", "[" * 10_000)


class Dense:
    """A window on a display with several pixels per point: everything but its surface is that of a real one."""

    def __init__(self, window: pygame.Window, ratio: float) -> None:
        self.__dict__.update(_window=window, _ratio=ratio, _surface=pygame.Surface((1, 1)))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._window, name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._window, name, value)

    def get_surface(self) -> pygame.Surface:
        """The surface to draw on."""
        size = tuple(max(round(side * self._ratio), 1) for side in self._window.size)
        if self._surface.get_size() != size:
            self.__dict__["_surface"] = pygame.Surface(size, depth=32)
        surface: pygame.Surface = self._surface
        return surface

    def flip(self) -> None:
        """There is nothing to see."""


class Monkey:
    """One window and what is done to it, from a seed: the same every time."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.random = random.Random(seed)
        os.environ[library.DATA_VARIABLE] = str(folder / f"data-{seed}")
        os.environ[CONFIG_VARIABLE] = str(folder / f"config-{seed}")
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
        os.environ["SDL_NO_SIGNAL_HANDLERS"] = "1"  # so that signals end it: nobody runs App.run here
        name = self.random.choice(models.bundled())
        self.app = App(models.load(name), ModelFile(None, name), Autosave(interval=0.5))
        self.app.window.minimum_size = (1, 1)
        self.ratio = self.random.choice(RATIOS)
        self.app.window = Dense(self.app.window, self.ratio)  # type: ignore[assignment]
        self.session = self.app.session
        self._codes = {pygame.key.name(code): code for code in _codes()}
        self._down = False

    # --- doing -------------------------------------------------------------------------------------------

    def act(self) -> str:
        """Post the events of one action; returns what it is."""
        chance = self.random.random()
        elements = self.session.model.particles.count + self.session.model.rods.count
        if elements > MOST_ELEMENTS and self.session.scene == "pause":
            return self._key("ctrl+a") + self._key("delete")
        # else it stays for long where few keys lead away
        if chance < 0.03 and self.session.scene != "simulation":
            return self._key("escape")
        if chance < 0.5:
            known = [b.key for _, b in ACTIONS.bound() if self.session.scene in b.scenes]
            return self._key(self.random.choice([*known, *2 * OFTEN.get(self.session.scene, ("space",))]))
        if chance < 0.55:
            return self._key(self.random.choice([*self._codes]))
        if chance < 0.77:
            return self._mouse()
        if chance < 0.87:
            return self._text(self.random.choice(TEXTS if self.random.random() < 0.95 else LONG))
        if chance < 0.93:
            return self._resize()
        kind = self.random.choice((pygame.WINDOWLEAVE, pygame.WINDOWFOCUSLOST, pygame.WINDOWEXPOSED))
        pygame.event.post(pygame.event.Event(kind))
        return pygame.event.event_name(kind)

    def _key(self, name: str) -> str:
        *modifiers, last = name[:-1].split("+")
        last, mod = last + name[-1], 0
        for modifier in modifiers:
            mod |= {"ctrl": pygame.KMOD_CTRL, "shift": pygame.KMOD_SHIFT}.get(modifier, 0)
        if last not in self._codes:  # such as "drag"
            return self._mouse()
        code = self._codes[last]
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=code, mod=mod, unicode="", scancode=0))
        if len(last) == 1 and not mod & pygame.KMOD_CTRL:
            pygame.event.post(pygame.event.Event(pygame.TEXTINPUT, text=last))
        pygame.event.post(pygame.event.Event(pygame.KEYUP, key=code, mod=mod, unicode="", scancode=0))
        return name

    def _text(self, text: str) -> str:
        pygame.event.post(pygame.event.Event(pygame.TEXTINPUT, text=text))
        return f"text {text[:20]!r}"

    def _place(self) -> tuple[int, int]:
        """Points in the window: a button, an element, or anywhere, sometimes outside."""
        width, height = self.app.size
        view = self.session.view
        if self.random.random() < 0.5 and self.session.model.particles.count:
            row = self.random.randrange(self.session.model.particles.count)
            x, y = view.camera.to_pixels(self.session.model.particles.position[row]).tolist()
            if abs(x) < 1e6 and abs(y) < 1e6:
                return round(x / self.ratio), round(y / self.ratio)
        reach = 10 if self.random.random() < 0.1 else 0
        x, y = (self.random.randint(-reach, side + reach) for side in (width, height))
        return (self.random.randint(0, 40), y) if self.random.random() < 0.2 else (x, y)

    def _mouse(self) -> str:
        at, post, new = self._place(), pygame.event.post, pygame.event.Event
        kind = self.random.choice(("click", "click", "click", "down", "move", "up", "wheel", "pan", "menu"))
        held = (1, 0, 0) if self._down else (0, 0, 0)
        pygame.key.set_mods(self.random.choice((0, 0, 0, pygame.KMOD_LCTRL)))
        if kind == "wheel":
            post(new(pygame.MOUSEWHEEL, x=0, y=self.random.choice((-9, -1, 1, 2)), flipped=False))
            return kind
        rel = self.random.randint(-300, 300), self.random.randint(-300, 300)
        buttons = (0, 1, 0) if kind == "pan" else held
        post(new(pygame.MOUSEMOTION, pos=at, rel=rel, buttons=buttons))
        if kind in ("click", "down"):
            post(new(pygame.MOUSEBUTTONDOWN, pos=at, button=pygame.BUTTON_LEFT))
            self._down = True
        if kind in ("click", "up"):
            post(new(pygame.MOUSEBUTTONUP, pos=at, button=pygame.BUTTON_LEFT))
            self._down = False
        if kind == "menu":
            for event in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
                post(new(event, pos=at, button=pygame.BUTTON_RIGHT))
        return f"{kind} at {at}"

    def _resize(self) -> str:
        draw = self.random.random()
        size = LARGEST if draw < 0.03 else (self.random.choice(SIDES), self.random.choice(SIDES))
        self.app.size = max(round(size[0] / self.ratio), 1), max(round(size[1] / self.ratio), 1)
        return f"size {self.app.size}"

    # --- checking ----------------------------------------------------------------------------------------

    def run(self, actions: int) -> None:
        """Act, let frames pass, and check; then close the window."""
        done: list[str] = []
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                for _ in range(actions):
                    done.append(self.act())
                    self._frame()
                    for document in self.session.documents:
                        check_sound(document.model)
                self.close()
        except BaseException as error:
            error.add_note(f"ratio {self.ratio}, after {len(done)} actions: {', '.join(done[-30:])}")
            raise
        finally:
            if self.app.preparation is None and pygame.display.get_init():
                self.app.close()

    def _frame(self) -> None:
        with within(LIMIT, f"a frame in {self.session.scene} at {self.app.size}"):
            self.app.frame(self.random.choice(ELAPSED))
        if self.session.lesson is not None:  # as App.run does
            lesson, self.session.lesson = self.session.lesson, None
            self._key("escape")
            with within(LIMIT, "a lesson that was left at once"):
                Performance(self.app, lesson).play()

    def close(self) -> None:
        """Close the window as a person does; what nobody saved stays in recovery files."""
        pygame.event.post(pygame.event.Event(pygame.QUIT))
        with within(LIMIT, "the last frame"):
            self.app.frame(0.0)
        assert self.app.closed
        autosave = self.app.autosave
        assert autosave is not None
        edited = [d for d in self.session.documents if d.edited and d.model.particles.count]
        ends = [contents(document.model) for document in edited]
        autosave.close(self.session.documents)
        files = {document.recovery for document in edited} | {*autosave.left()}
        assert {*(library.data_folder() / "autosave").glob("*.json")} == files
        for document, end in zip(edited, ends, strict=True):
            assert document.recovery is not None
            kept = contents(models.load(document.recovery))
            for name, column in end.items():
                assert "." not in name or kept[name] == column, name


def _codes() -> list[int]:
    """The keys of a keyboard."""
    return [
        value
        for name, value in vars(pygame).items()
        if name.startswith("K_") and name != "K_UNKNOWN" and pygame.key.name(value)
    ]


def explore(first: int, count: int, actions: int = 300) -> int:
    """Windows with so many actions each; returns how many went wrong."""
    pygame_input.IDLE_PAUSE = 0.0
    wrong = 0
    with data_in() as folder, contextlib.chdir(folder):
        for seed in range(first, first + count):
            try:
                Monkey(seed, folder).run(actions)
            except Exception:
                wrong += 1
                print(f"windows, seed {seed}:\n{traceback.format_exc()}", flush=True)
            else:
                print(f"windows, seed {seed}: {actions} actions, sound", flush=True)
    return wrong
