"""Preferences: what a person chose for every session, kept in a settings file of their own.

A damaged file loses nothing: what cannot be read counts as not chosen, and is put aside when something is written.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from platformdirs import user_config_path

from pinjoint.components.language import LANGUAGES
from pinjoint.components.units import USUAL, can_show
from pinjoint.components.view import CONVENTIONS, MAGNIFICATIONS, TEXTBOOK
from pinjoint.documents import models
from pinjoint.systems.render.theme import theme_names

CONFIG_VARIABLE = "PINJOINT_CONFIG"  # names another folder than the system's own
DEFAULT_THEME = "light"
# By entry: the default, and whether something is a choice.
_CHOICES: Mapping[str, tuple[Any, Callable[[Any], bool]]] = {
    "theme": (DEFAULT_THEME, lambda one: one in theme_names()),
    "language": ("", lambda one: one in list(LANGUAGES)),
    "units": (USUAL, can_show),
    "convention": (TEXTBOOK, lambda one: one in CONVENTIONS),
    "magnification": (1.0, lambda one: one in MAGNIFICATIONS),
    "sound": (True, lambda one: one in (True, False)),
    "maximised": (False, lambda one: one in (False, True)),
}
FARTHEST = 100_000  # points that a window is away from a corner of the display, or wide, at most


def settings_path() -> Path:
    """The settings file; it need not exist yet."""
    chosen = os.environ.get(CONFIG_VARIABLE)
    folder = Path(chosen) if chosen else user_config_path("pinjoint", appauthor=False)
    return folder / "settings.json"


def preferred(entry: str) -> Any:
    """The choice that was made last; the default where none can be read, or it is one no more."""
    default, known = _CHOICES[entry]
    last = read(settings_path()).get(entry)
    return last if known(last) else default


def preferred_keys() -> list[tuple[str, str, str]]:
    """(scene, key, action) of every key that a person chose: {"keys": {"pause": {"w": "wind.toggle"}}}."""
    by_scene = read(settings_path()).get("keys")
    if not isinstance(by_scene, dict):
        return []
    return [
        (scene, key, action)
        for scene, keys in by_scene.items()
        if isinstance(keys, dict)
        for key, action in keys.items()
        if isinstance(action, str)
    ]


def preferred_place() -> tuple[int, int, int, int] | None:
    """Left, top, width and height of the window (points) when it was closed last; None where that cannot be read."""
    place = read(settings_path()).get("window")
    if not isinstance(place, list) or len(place) != 4:
        return None
    if not all(type(number) is int and abs(number) <= FARTHEST for number in place):
        return None
    left, top, width, height = place
    return left, top, width, height


def remember(entry: str, choice: str | float | list[int]) -> None:
    """Keep what was chosen, or the place of the "window"."""
    keep(settings_path(), entry, choice)


# --- files of choices ------------------------------------------------------------------------------------


def read(path: Path) -> dict[str, Any]:
    """What a file says; nothing if it is damaged, or not there."""
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return entries if isinstance(entries, dict) else {}


def keep(path: Path, entry: str, choice: object) -> None:
    """Write an entry of a file, the others as they are.

    Where nothing can be written, it is not kept. A file that cannot be read, such as one with a slip in what was
    written by hand, is put aside.
    """
    entries = read(path)
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        if not entries and path.is_file() and path.stat().st_size > 0:
            models.replace(path.with_stem(f"{path.stem}-unreadable"), path.read_bytes())
        models.replace(path, json.dumps({**entries, entry: choice}, indent=1).encode() + b"\n")
