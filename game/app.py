"""The window: pygame-ce around a session."""

from __future__ import annotations

import gc
import itertools
import os
import sys
import time
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

import pygame

from pinjoint.boundary import Boundary
from pinjoint.components.camera import Viewport
from pinjoint.components.field import Vector
from pinjoint.components.language import language, tr
from pinjoint.components.mistake import Explained
from pinjoint.components.model import Model
from pinjoint.components.units import units_on_screen
from pinjoint.components.view import MAGNIFICATIONS, View, magnified
from pinjoint.documents import library, models
from pinjoint.documents.autosave import Autosave, unkept
from pinjoint.documents.open_documents import ModelFile, OpenDocument
from pinjoint.documents.preferences import DEFAULT_THEME, preferred, preferred_place, remember
from pinjoint.editor.frame import Frame
from pinjoint.editor.scenes.load import Load
from pinjoint.interrupts import closed_by_signals
from pinjoint.lessons.course import take_up_lesson
from pinjoint.pictures import on_paper, write
from pinjoint.preparation import Preparation
from pinjoint.scripts.lines import Failure
from pinjoint.scripts.performance import FOOTER, LARGER, Performance
from pinjoint.scripts.playing import Recorder
from pinjoint.scripts.script import Script
from pinjoint.session import Session
from pinjoint.systems.base import System
from pinjoint.systems.edit.hover import Hover
from pinjoint.systems.input.actions import LIVE
from pinjoint.systems.input.pygame_input import PygameInput
from pinjoint.systems.render.backends.pygame_canvas import encoded
from pinjoint.systems.render.backends.raster import load_raster
from pinjoint.systems.render.picture import symbol_at
from pinjoint.systems.render.pygame_render import PygameRender
from pinjoint.systems.render.pygame_sound import PygameSound

FIRST_SIZE = (1000, 720)  # points
FRAME = (16, 80)  # points that the frame of a window and the bars of a desktop take at least beside it
_SMALLEST_SIZE = (320, 240)
SELDOM = 1_000_000  # new objects, after which the garbage collector runs even while a person works
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")  # where Linux says what to draw on
ICON = files("pinjoint.assets") / "icons" / "pinjoint-64.png"
UNSEEN = ("offscreen", "dummy")  # drivers of SDL without a visible window

Place = tuple[int, int, int, int]  # left, top, width and height of a window (points)


class NoDisplay(Explained, RuntimeError):
    """There is nowhere to open a window; the message is the reason."""


def open_window(
    model: Model,
    file: ModelFile,
    theme: str | None = None,
    *,
    record: tuple[str | None, Any] = (None, None),
    lesson: Script | None = None,
) -> list[Failure]:
    """Show a model, or a choice of models if it has no name, until the window is closed. Raises NoDisplay.

    theme: the name of its colours; None: those that the person chose last. record: the file for a
    recording, if any, and the model as its header names it. lesson: a script to play first; its failed
    expectations are returned.
    """
    path, source = record
    autosave: Autosave | None = None
    trouble = ""
    try:
        autosave = Autosave()
    except OSError as error:  # nothing can be written
        trouble = unkept(library.data_folder(), error)
    magnification, place = preferred("magnification"), preferred_place()
    app = App(model, file, autosave, theme or preferred("theme"), Preparation(), magnification, place)
    app.session.lesson = lesson
    if preferred("maximised"):
        app.window.maximize()
    if lesson is None:
        app.session.scenes.begin(app.session)
    app.session.notice = trouble or app.session.notice
    if path is not None:
        with open(path, "w", encoding="utf-8") as script:
            Recorder(app.session, script, source)
            return app.run()
    if not file.name and lesson is None:
        app.welcome()
    return app.run()


def window_systems(folder: Path) -> list[System]:
    """The systems that a window adds to a session, without a window; unsaved work would go to the folder."""
    return [
        PygameInput(),
        Hover(symbol_at),
        Autosave(folder),
        Preparation(),
        PygameRender(pygame.Surface((1, 1))),
        PygameSound(),
    ]


def _find_display() -> None:
    """Get ready for a window that somebody can see, or one as SDL_VIDEODRIVER says. Raises NoDisplay, pygame.error."""
    chosen = "SDL_VIDEODRIVER" in os.environ
    if not chosen and sys.platform.startswith("linux") and not any(map(os.environ.get, DISPLAYS)):
        raise NoDisplay("neither {first} nor {second} is set", first=DISPLAYS[0], second=DISPLAYS[1])
    pygame.display.init()
    if not chosen and pygame.display.get_driver() in UNSEEN:  # the last resort of SDL
        pygame.display.quit()
        raise NoDisplay("the display cannot be reached")


def place_on(
    displays: Sequence[tuple[int, int]], place: Place | None, *, seen: bool = True
) -> tuple[tuple[int, int], tuple[int, int] | None]:
    """Size and position (None: wherever the desktop wants it) of a window that opens (points).

    displays: sizes, the first with the main menu. place: where it was last. seen: it has a frame and bars beside it.
    On a single display the window opens inside it; where several are relative to each other is not known.
    """
    (width, height), first = displays[0], magnified(float(displays[0][1]), float(displays[0][1]), 1.0)
    beside = FRAME if seen else (0, 0)
    most = max(width - beside[0], _SMALLEST_SIZE[0]), max(height - beside[1], _SMALLEST_SIZE[1])
    if place is None:
        return (min(round(first * FIRST_SIZE[0]), most[0]), min(round(first * FIRST_SIZE[1]), most[1])), None
    left, top, wide, high = place
    wide, high = max(wide, _SMALLEST_SIZE[0]), max(high, _SMALLEST_SIZE[1])
    if len(displays) > 1:
        across, down = sum(w for w, _ in displays), sum(h for _, h in displays)
        there = -across < left < across and -down < top < down
        return (min(wide, across), min(high, down)), (left, top) if there else None
    wide, high = min(wide, width), min(high, height)
    return (wide, high), (min(max(left, 0), width - wide), min(max(top, 0), height - high))


class App:
    """The window and its session.

    preparation: compiles in another process; without it, compiling stops the frames. place: where it was last.
    """

    def __init__(
        self,
        model: Model,
        file: ModelFile = ModelFile(),  # noqa: B008 (it cannot be changed)
        autosave: Autosave | None = None,
        theme: str = DEFAULT_THEME,
        preparation: Preparation | None = None,
        magnification: float = 1.0,
        place: Place | None = None,
    ) -> None:
        os.environ.setdefault("SDL_WINDOWS_DPI_AWARENESS", "permonitorv2")
        try:
            _find_display()
            displays = pygame.display.get_desktop_sizes()
            self._display_height = float(displays[0][1])
            size, position = place_on(displays, place, seen=pygame.display.get_driver() not in UNSEEN)
            at = pygame.WINDOWPOS_UNDEFINED if position is None else position
            self.window = pygame.Window("Pinjoint", size, at, resizable=True, allow_high_dpi=True)
            self.window.set_icon(pygame.image.load(BytesIO(ICON.read_bytes()), ICON.name))
        except pygame.error as error:
            raise NoDisplay(str(error)) from None
        self.window.minimum_size = _SMALLEST_SIZE
        pygame.key.set_repeat(400, 40)
        self.input = PygameInput()
        raster = preparation.raster if preparation else load_raster
        self.render = PygameRender(self.window.get_surface(), raster)
        further = [system for system in (autosave, preparation) if system is not None]
        systems: list[System] = [self.input, Hover(symbol_at), *further, self.render, PygameSound()]
        view = View(theme=theme, convention=preferred("convention"), sound=preferred("sound"))
        self.session = Session(model, systems, view, file)
        self.session.window = self
        self.session.faults_seen = 0  # so that mods that were left out are shown
        self.session.autosave = self.autosave = autosave
        self.preparation = preparation
        if preparation is not None:
            self.session.readiness = preparation
            preparation.open()
        self._chosen = self._choices()
        self._magnification = magnification
        self._clock, self._before = pygame.time.Clock(), time.perf_counter()
        self._follow_size()
        self.session.view.fit(model)
        self._full_screen = self._maximised = False
        self._known: OpenDocument | None = None
        self._boundary = Boundary(self.session)

    def run(self) -> list[Failure]:
        """Run frames at 60 Hz until the window is closed; returns the failed expectations of played scripts."""
        failures: list[Failure] = []
        thresholds = gc.get_threshold()
        gc.set_threshold(SELDOM)  # else it runs in the middle of large edits; see _clean_up
        played, around = self.session.lesson is not None, self._boundary.around
        self._boundary.begin()
        try:
            with closed_by_signals(self.input.close):
                while not self.closed:
                    self.next_frame()
                    with nullcontext() if played else around("lessons"):  # a script gets its exceptions
                        take_up_lesson(self.session)
                        lesson, self.session.lesson = self.session.lesson, None
                        failures += Performance(self, lesson).play() if lesson is not None else []
                    played = False
        finally:
            gc.set_threshold(*thresholds)
        with around("preferences"):  # where the window is, if somebody saw it and it does not fill the screen
            if not self._full_screen and pygame.display.get_driver() not in UNSEEN:
                remember("maximised", self.input.maximised)
                if not self.input.maximised:
                    remember("window", [*self.window.position, *self.window.size])
        if self.autosave is not None:
            with around(self.autosave.name):
                self.autosave.close(self.session.documents)
        if self.preparation is not None:
            with around(self.preparation.name):
                self.preparation.close()
        self.close()
        return failures

    def close(self) -> None:
        """Close the window at once; the garbage collector would do so later, together with the display of the next one."""
        self.window.destroy()
        pygame.display.quit()

    def welcome(self) -> None:
        """Begin with a choice of models."""
        load = self.session.scenes["load"]
        assert isinstance(load, Load)
        load.welcome = True
        self.session.act("load")

    def next_frame(self, *, wait: bool = True) -> Frame:
        """A frame when it is time for it, or at once."""
        if wait:
            self._clock.tick(60)
        now, before = time.perf_counter(), self._before
        self._before = now
        return self.frame(now - before)

    def frame(self, elapsed: float) -> Frame:
        """One frame: input, steps and picture."""
        around = self._boundary.around
        for follow in (self._follow_size, self._follow_title):
            with around("window"):
                follow()
        frame = Frame(self.session, elapsed)
        with around("frame"):
            frame = self.session.frame(elapsed)
        with around("window"):
            self._follow_choices()
            if self._boundary.undrawn:
                self._draw_plainly()
            if self.render.drawn:
                self.window.flip()
            elif not self.session.busy:
                self._clean_up()
        return frame

    def _draw_plainly(self) -> None:
        """Show why there is no picture, with as little as that needs."""
        surface, edge = self.render.surface, round(20.0 * self.session.view.pixel_ratio)
        surface.fill("black")
        self.render.shown, self.render.drawn = None, True
        with suppress(pygame.error):
            pygame.font.init()
            font = pygame.font.Font(None, edge)
            surface.blit(
                font.render(
                    self._boundary.said, True, "white", None, max(surface.get_width() - 2 * edge, edge)
                ),
                (edge, edge),
            )

    @property
    def closed(self) -> bool:
        """True once the person has closed the window."""
        return self.input.closed

    @property
    def size(self) -> tuple[int, int]:
        """Width and height (points of the display)."""
        width, height = self.window.size
        return width, height

    @size.setter
    def size(self, size: tuple[int, int]) -> None:
        self.window.size = size

    @property
    def room_below(self) -> int:
        """Points between the window and the lower edge of the display."""
        return max(int(self._display_height) - self.window.position[1] - self.window.size[1], 0)

    def _follow_size(self) -> None:
        """Let the viewport and the size of type follow the window, the display's pixel density and the person."""
        surface = self.window.get_surface()
        self.render.surface = surface
        width, height = surface.get_size()
        self.input.density = density = width / max(self.window.size[0], 1)
        ratio = density * magnified(height / density, self._display_height, self._magnification)
        view, footer = self.session.view, self.session.footer
        if footer is not None:
            low = min(round(FOOTER * ratio), height - 1)
            height -= low
            footer.camera.viewport, footer.pixel_ratio = Viewport(0, height, width, low), LARGER * ratio
        if ((width, height), ratio) != (self.session.extent, view.pixel_ratio):
            self.session.resize(width, height, ratio)

    def _follow_title(self) -> None:
        """Let the window's title name the model, after a dot while there is unsaved work."""
        session = self.session
        name = session.document.file.name or (tr("Untitled") if session.document.unsaved else "")
        title = f"{'• ' if session.document.unsaved else ''}{name} – Pinjoint" if name else "Pinjoint"
        if title != self.window.title:
            self.window.title = title

    def _clean_up(self) -> None:
        """Run the garbage collector while nothing happens.

        The elements of a newly opened model are frozen, since they stay: collecting a large model takes a tenth of
        a second, else in the middle of a drag.
        """
        if self._known is not self.session.document:
            self._known = self.session.document
            gc.unfreeze()
            gc.collect()
            gc.freeze()
        elif gc.get_count()[0] > 20_000:  # new objects
            gc.collect(0)

    def _choices(self) -> dict[str, str | bool]:
        """What the person has chosen; not what a script that is performed shows."""
        view, shown = self.session.view, dict[str, str | bool]()
        if self.session.footer is None:
            shown = {"language": language(), "convention": view.convention}
        if self.session.footer is None and self.session.course is None and self.session.scene in LIVE:
            shown["units"] = units_on_screen()
        return {"theme": view.theme, "sound": view.sound, **shown}

    def _follow_choices(self) -> None:
        """Keep what the person chooses for the next time."""
        for name, chosen in self._choices().items():
            if chosen != self._chosen.get(name):
                self._chosen[name] = chosen
                remember(name, chosen)

    def point(self, pixel: Vector) -> None:
        """Take the pointer to a pixel."""
        view = self.session.view
        view.pointer = pixel
        pygame.mouse.set_pos(pixel[0] / view.pixel_ratio, pixel[1] / view.pixel_ratio)

    def copied(self) -> str:
        """The text on the system's clipboard."""
        return pygame.scrap.get_text() if pygame.scrap.has_text() else ""

    def copy(self, text: str) -> None:
        """Put a text on the system's clipboard."""
        pygame.scrap.put_text(text)

    def magnify(self, by: int) -> str:
        """Draw type and symbols a step larger, or smaller if negative; 0: as they suit the window. Returns which."""
        at = MAGNIFICATIONS.index(self._magnification) + by
        chosen = MAGNIFICATIONS[min(max(at, 0), len(MAGNIFICATIONS) - 1)] if by else 1.0
        self._magnification = chosen
        remember("magnification", chosen)
        return f"{100.0 * chosen:.0f} %"

    def toggle_full_screen(self) -> None:
        """Fill the screen, or be again as before."""
        self._full_screen = not self._full_screen
        if self._full_screen:
            self._maximised = self.input.maximised
            self.window.set_fullscreen(desktop=True)
        else:
            self.window.set_windowed()
            if self._maximised:
                self.window.maximize()

    def screenshot(self, suffix: str = ".png") -> str:
        """Save the model as the window shows it, without panels and bars, in a folder of `_pictures`; returns the path.

        Where the window shows no model, all that it shows is saved, as a PNG. Raises OSError.
        """
        self.session.document.statics.go_on(to_the_end=True)
        drawn = [
            (model, on_paper(view))
            for model, view in self.session.stages
            if isinstance(model, Model) and view.card is None
        ]
        if not drawn:
            path = _unused(_pictures() / "pinjoint.png")
            models.replace(path, encoded(self.render.surface, ".png"))
            return str(path)
        path = _unused(_pictures() / f"pinjoint{suffix}")
        write(drawn, path, self.render.surface.get_size(), self.session.view.theme)
        return str(path)

    def save(self, name: str, contents: bytes) -> str:
        """Save a file beside pictures under this name, or one like it that is free; returns the path."""
        path = _unused(_pictures() / name)
        models.replace(path, contents)
        return str(path)


def _pictures() -> Path:
    """The folder that the person chose, else that in which the program was started."""
    chosen = library.chosen_folder()
    return chosen if chosen is not None and chosen.is_dir() else Path.cwd()


def _unused(path: Path) -> Path:
    """The path, or the first of path-2, path-3, … that does not exist."""
    further = (path.with_stem(f"{path.stem}-{number}") for number in itertools.count(2))
    return next(candidate for candidate in itertools.chain([path], further) if not candidate.exists())
