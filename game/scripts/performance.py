"""Performance: a scripted session played in a window, at a pace to follow."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from contextlib import nullcontext
from typing import Any, Protocol

from pinjoint.components.field import Vector
from pinjoint.components.language import marked, spoken, tr
from pinjoint.components.units import shown_in
from pinjoint.components.view import Page, Status, View
from pinjoint.documents import library
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.frame import Frame
from pinjoint.scripts.lines import Failure, play_line
from pinjoint.scripts.script import Script
from pinjoint.session import Session
from pinjoint.systems.base import REVIEW_INTERVAL
from pinjoint.systems.physics.pace import natural_pace

FOOTER = 112.0  # points, height of the strip for the words of a script below the picture
LARGER = 1.25  # factor of the type in that strip
RATE = 60.0  # pictures a second of a run
_BEAT = 0.7  # s between two actions
REACH = 0.4  # s of a movement of the pointer
READING = 1.2, 0.055  # s that a sentence stays: at least, and for each character
PATIENCE = 6.0  # s of a run shown at its natural pace, before it goes faster and faster
DONE = marked("This is the end. Go on from here as you like; Ctrl+Z goes back, step by step.")


class Screen(Protocol):
    """The part of a window that a performance uses; size: in points of the display."""

    session: Session
    size: tuple[int, int]

    @property
    def closed(self) -> bool: ...
    @property
    def room_below(self) -> int: ...
    def next_frame(self, *, wait: bool = True) -> Frame: ...
    def point(self, pixel: Vector) -> None: ...


class Performance:
    """Plays a script in a window; Space goes on at once, Esc ends it, other keys do nothing.

    pace: 1 for people; 0 without waiting.
    """

    def __init__(self, screen: Screen, script: Script, pace: float = 1.0) -> None:
        self._screen = screen
        self._script = script
        self._pace = pace
        self._hurried = self._ended = False
        self._running_since: float | None = None
        self._natural = 0.0  # simulated seconds per second shown of what runs

    def play(self) -> list[Failure]:
        """Play all lines, or until the person ends it; returns failed expectations. Raises ScriptError.

        The script saves in a folder of its own; afterwards its models count as unsaved work.
        """
        apart = nullcontext() if self._script.has_data else library.data_in()
        with apart as folder, spoken(self._script.language), shown_in(self._script.units):
            failures = self._perform_all()
        for document in self._screen.session.documents:
            if document.file.path is not None and folder in document.file.path.parents:
                document.file, document.saved = ModelFile(None, document.file.name), -1
        return failures

    def _perform_all(self) -> list[Failure]:
        session, failures = self._screen.session, list[Failure]()
        session.footer = View()
        grown = min(round(FOOTER), self._screen.room_below)
        self._grow(grown)
        self._say(tr(self._script.title))
        try:
            for number, entry in self._script.lines[1:]:
                self._hurried = False
                self._lead_to(entry)
                if self._ended:
                    break
                failures += self._perform(number, entry)
                self._watch(entry)
        finally:
            session.footer = None
            self._grow(-grown)
        if not self._ended and session.course is None:  # where a task was shown, its card says what to do next
            session.notice = tr(DONE)
        return failures

    # --- one line ------------------------------------------------------------------------------------

    def _perform(self, number: int, entry: Mapping[str, Any]) -> list[Failure]:
        session = self._screen.session
        self._wait_for_program()
        self._running_since = None
        simulation = session.simulation
        simulation.before_steps.append(self._watch_time)
        try:
            if set(entry) != {"type"}:
                return play_line(self._script, number, entry, session)
            failures = []
            for letter in entry["type"]:
                failures += play_line(self._script, number, {"type": letter}, session)
                self._wait(0.12)
            return failures
        finally:
            simulation.before_steps.remove(self._watch_time)

    def _lead_to(self, entry: Mapping[str, Any]) -> None:
        """Move the pointer to the target of the next line."""
        target = self._target(entry)
        if target is None:
            return
        view = self._screen.session.view
        start = view.pixel
        began, share = time.monotonic(), 0.0
        while share < 1.0 and not self._skipping:
            share = min((time.monotonic() - began) / (REACH * self._pace), 1.0)
            ease = share * share * (3.0 - 2.0 * share)
            self._screen.point(
                (start[0] + ease * (target[0] - start[0]), start[1] + ease * (target[1] - start[1]))
            )
            self._frame()

    def _target(self, entry: Mapping[str, Any]) -> Vector | None:
        """The pixel at which a line acts, if it acts at one."""
        if isinstance(pixel := entry.get("pixel"), list):
            return float(pixel[0]), float(pixel[1])
        at = entry.get("over") or entry.get("click") or (entry.get("drag") or [None])[0]
        if not isinstance(at, list) or len(at) != 2:
            return None
        x, y = self._screen.session.stages[0][1].camera.to_pixels((float(at[0]), float(at[1]))).tolist()
        return x, y

    def _watch(self, entry: Mapping[str, Any]) -> None:
        """Leave time to see what a line has done."""
        if "resize" in entry:
            width, height, ratio = (*entry["resize"], 1.0)[:3]
            self._screen.size = round(width / ratio), round(height / ratio + FOOTER)
        if "say" in entry:
            self._say(tr(entry["say"]))
        elif not entry.keys() & {"expect", "resize", "window"}:  # of which nothing is seen
            self._wait(_BEAT if "input" not in entry else 0.1 * _BEAT)

    def _say(self, text: str) -> None:
        footer = self._screen.session.footer
        if text and footer is not None:
            footer.page = Page((text,))
            footer.status = Status(time=None, state=tr("Lesson"), hint=tr("Space goes on     Esc ends it"))
            least, each = READING
            self._wait(max(least, each * len(text)))

    # --- time ------------------------------------------------------------------------------------------

    @property
    def _skipping(self) -> bool:
        return self._hurried or self._ended or self._pace == 0.0

    def _wait(self, seconds: float) -> None:
        """Let frames pass for some seconds; one frame at least."""
        began = time.monotonic()
        self._frame()
        while not self._skipping and time.monotonic() - began < seconds * self._pace:
            self._frame()

    def _wait_for_program(self) -> None:
        """Let frames pass while the step program is compiled."""
        session = self._screen.session
        while not self._ended and not session.readiness.lets(session.simulation):
            self._frame()

    def _watch_time(self) -> int:
        """Show the state of a run; returns its steps until the next picture."""
        simulation = self._screen.session.simulation
        if self._running_since is None:
            self._running_since, self._natural = time.monotonic(), natural_pace(simulation.model)
        clock = simulation.model.clock
        now, end = clock.time, clock.time + clock.step_size
        simulation.before_steps.remove(self._watch_time)  # the run stands still during the picture
        while not self._skipping:
            self._frame()
            shown = time.monotonic() - self._running_since
            between = 2.0 ** max(shown - PATIENCE * self._pace, 0.0) * self._natural / RATE
            now += between
            if now >= end or not simulation.show(now):
                break
        simulation.rejoin()
        simulation.before_steps.append(self._watch_time)
        steps = between / clock.step_size if clock.step_size > 0.0 and not self._skipping else REVIEW_INTERVAL
        return math.ceil(min(max(steps, 1.0), REVIEW_INTERVAL))

    def _frame(self) -> None:
        """One frame, and the keys that the person pressed meanwhile."""
        screen = self._screen
        pointer = screen.session.view.pointer
        pressed = [key for key, _ in screen.next_frame(wait=self._pace > 0.0).pressed]
        screen.session.view.pointer = pointer  # the mouse of the person does not count
        self._hurried |= any(key in ("space", "return", "right", "click") for key in pressed)
        self._ended |= "escape" in pressed or screen.closed

    def _grow(self, points: int) -> None:
        """Add points to the height of the window, for the footer; where there is no room, the picture shrinks."""
        width, height = self._screen.size
        self._screen.size = width, height + points
