"""Playing: a script performed in a session; and recording, which writes one."""

from __future__ import annotations

import json
import logging
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, TextIO

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.language import ENGLISH, joined, language, spoken, tr
from pinjoint.components.mistake import reason_of
from pinjoint.components.settings import STATICS
from pinjoint.components.units import USUAL, shown_in, units_on_screen
from pinjoint.components.wording import is_broken
from pinjoint.documents.format import ModelError
from pinjoint.scripts.lines import Failure, play_line
from pinjoint.scripts.script import HEADER, Script, ScriptError
from pinjoint.session import Session

LOG = logging.getLogger("pinjoint.recording")


def session_of(script: Script) -> Session:
    """The session that the header of a script asks for; its notice says what differs. Raises ScriptError."""
    different = check_mods(script)
    try:
        session = Session.open(script.source)
    except ModelError as error:
        raise script.error(script.lines[0][0], error) from None
    session.notice = joined((session.notice, different))
    return session


def check_mods(script: Script) -> str:
    """How the mods that are loaded differ from those that a script was recorded with, as a sentence; "" if they don't.

    Raises ScriptError if one is missing.
    """
    if script.mods is None:
        return ""
    here = _loaded_mods()
    if missing := [f"{name} {version}" for name, version in script.mods.items() if name not in here]:
        raise ScriptError(
            "{file} was recorded with mods that are not loaded: {mods}. Name their folder: --mods FOLDER.",
            file=script.path,
            mods=", ".join(missing),
        )
    others = [f"{name} {version}" for name, version in here.items() if version != script.mods.get(name)]
    if not others:
        return ""
    return tr(
        "{file} was recorded without the mods {mods} that are loaded now, so it may run differently.",
        file=script.path,
        mods=", ".join(others),
    )


def _loaded_mods() -> dict[str, str]:
    """Versions of the mods that act now, those that come with the program apart, by name."""
    return {mod.name: mod.version for mod in EXTENSIONS.mods if mod.loaded and not mod.off and not mod.included}


def play(script: Script, session: Session | None = None) -> list[Failure]:
    """Play all lines in a session (None: that of the header); returns failed expectations. Raises ScriptError."""
    session = session or session_of(script)
    with spoken(script.language), shown_in(script.units):
        return [
            failure
            for number, entry in script.lines[1:]
            for failure in play_line(script, number, entry, session)
        ]


# --- recording -------------------------------------------------------------------------------------------


class Recorder:
    """Writes what a person does in a window as lines of a script; where that becomes impossible, it ends and says so."""

    def __init__(self, session: Session, file: TextIO, model: Any) -> None:
        self._file = file
        self._session = session
        session.recorder = self
        spoken = {"language": language()} if language() != ENGLISH else {}
        units = {"units": units_on_screen()} if units_on_screen() != USUAL else {}
        self._write({**HEADER, "model": model, "mods": _loaded_mods(), **spoken, **units})
        self.resize()
        if session.scene == STATICS:  # in which a window begins
            self._write({"action": "toggle statics"})
        session.act("fit")  # what is fitted as a model is opened may differ
        self._write({"action": "fit"})

    def resize(self) -> None:
        """Write down the size of the window."""
        size = [*self._session.extent, self._session.view.pixel_ratio]
        self._write({**self._now, "resize": size})

    @property
    def _now(self) -> dict[str, Any]:
        """When, as the keys of a line."""
        steps, within = self._session.simulation.moment
        return {"at": steps} if within is None else {"at": steps, "within": within}

    def press(self, key: str, pixel: Vector | None) -> None:
        """Write down that a key or button was pressed at a pixel, or a text typed."""
        entry: dict[str, Any] = {**self._now, "input": key}
        if pixel is not None:
            entry["pixel"] = list(pixel)
        if key == "ctrl+v":  # a text from another program will not be there when the script is played
            entry["clipboard"] = self._session.clipboard
        self._write(entry)

    def _write(self, entry: Mapping[str, Any]) -> None:
        if self._file.closed:
            return
        line = json.dumps(entry, ensure_ascii=False)
        try:
            self._file.write((json.dumps(entry) if is_broken(line) else line) + "\n")
            self._file.flush()
        except OSError as error:
            with suppress(OSError):
                self._file.close()  # else its end would try again
            self._session.recorder = None
            said = tr(
                "The recording ends here: {file} cannot be written: {reason}.",
                file=self._file.name,
                reason=reason_of(error),
            )
            self._session.notice = said
            LOG.warning(said)
