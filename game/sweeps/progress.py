"""Progress: how far a sweep is, for a person."""

from __future__ import annotations

import time
from typing import TextIO

_WIDTH = 30
_EVERY = 0.2  # s


class ProgressBar:
    """A bar on a terminal; elsewhere, such as in the log of a cluster, a line for every tenth."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._began: tuple[float, int] | None = None
        self._shown = 0.0
        self._tenths = 0

    def __call__(self, done: int, total: int, failed: int) -> None:
        """Show that so many variants are done, of which so many failed."""
        now = time.monotonic()
        began, first = self._began = self._began or (now, done)
        left = (now - began) / (done - first) * (total - done) if done > first else None
        text = f"{done}/{total} variants" + (f", {failed} failed" if failed else "")
        text += f", {_duration(left)} left" if left is not None and done < total else ""
        if self._stream.isatty():
            if now - self._shown >= _EVERY or done == total:
                self._shown = now
                filled = "█" * (_WIDTH * done // total)
                self._stream.write(f"\r\x1b[K{filled:░<{_WIDTH}} {text}" + ("\n" if done == total else ""))
        elif 10 * done // total > self._tenths:
            self._tenths = 10 * done // total
            self._stream.write(text + "\n")
        self._stream.flush()


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return (
        f"{hours:d} h {minutes:02d} min"
        if hours
        else f"{minutes:d} min {seconds:02d} s"
        if minutes
        else f"{seconds:d} s"
    )
