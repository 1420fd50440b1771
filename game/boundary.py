"""Boundary: no exception of a computation ends a window: it is told of, its traceback is kept, and the rest goes on."""

from __future__ import annotations

import logging
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from pinjoint.components.language import tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.wording import cut
from pinjoint.documents.library import data_folder
from pinjoint.editor.context import Context
from pinjoint.mods.mod import blamed_on_mod
from pinjoint.systems.base import Phase, System

LOG = logging.getLogger("pinjoint.window")
REST = 1.0  # s for which what failed is left alone, unless a person does something
FAULTS = "faults.log"  # among this person's data


class Boundary:
    """Around each system of a frame, and around what else a window does, from `begin` on; scripts get exceptions.

    said: what failed last, as a sentence.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._failing: dict[System, float] = {}  # when they are tried again
        self._written: set[str] = set()
        self._holds, self.said = False, ""

    def begin(self) -> None:
        """From now on the window itself runs the frames."""
        self._holds, self._context.schedule.call = True, self._call

    @property
    def undrawn(self) -> bool:
        """True if there is no picture of the session as it is now."""
        return any(system.phase is Phase.RENDER for system in self._failing)

    def _call(self, system: System, frame: Any) -> None:
        """Let a system do its part of a frame; one that fails rests, but for what a person does."""
        if time.monotonic() < self._failing.get(system, 0.0) and not frame.pressed:
            return
        with self.around(system.name):
            self._failing[system] = time.monotonic() + REST
            system.process(frame)
            del self._failing[system]
        if system in self._failing:
            with suppress(Exception):
                self._leave_alone(system)

    def _leave_alone(self, system: System) -> None:
        """End what would make a system fail in every frame."""
        if system.phase is Phase.STEP:
            self._context.scenes.request("pause")
        if system.phase is not Phase.EVENTS:
            self._context.leave_gesture()

    @contextmanager
    def around(self, what: str) -> Iterator[None]:
        """Tell of whatever is raised inside, and go on after it."""
        try:
            yield
        except Exception as error:
            if not self._holds:
                raise
            with suppress(Exception):  # such as a MemoryError while it is told
                # of a person, such as in a script that was dropped on the window
                if isinstance(error, Mistake):
                    self._context.notice = self.said = str(error)
                elif not blamed_on_mod(error):
                    self._tell(what, error)

    def _tell(self, what: str, error: Exception) -> None:
        file, problem = data_folder() / FAULTS, cut(f"{type(error).__name__}: {error}".rstrip(": .\n"))
        self._context.notice = self.said = tr(
            "A fault of the program in '{part}' ({problem}). Your model is kept: go on, undo with Ctrl+Z if something looks"
            " wrong, and save. Please report it; the details are in {file}.",
            part=what,
            problem=problem,
            file=file,
        )
        if self.said not in self._written:
            self._written.add(self.said)
            LOG.error("A fault in '%s'", what, exc_info=error)
            file.parent.mkdir(parents=True, exist_ok=True)
            with file.open("a", encoding="utf-8", errors="replace") as written:
                written.write(f"{time.ctime()}, {what}\n{''.join(traceback.format_exception(error))}\n")
