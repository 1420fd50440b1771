"""Library: the models that a person saved, by name, in a folder of their own, or one that they chose."""

from __future__ import annotations

import os
import time
import unicodedata
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from platformdirs import user_data_path

from pinjoint.components import wording
from pinjoint.components.form import fits_file_names
from pinjoint.components.language import plural, tr
from pinjoint.components.mistake import Explained, reason_of
from pinjoint.documents import models, preferences

DATA_VARIABLE = "PINJOINT_DATA"  # names another folder than the system's own
_PLACES = "places.json"  # the file that tells which folder was chosen
_LONGEST_NAME = 100  # characters
MOST_BYTES = 200  # in UTF-8; file systems take 255, with what is added to a name
_KEPT_BY_WINDOWS = {
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{port}{n}" for port in ("com", "lpt") for n in "0123456789¹²³"),
}


class NameRefused(Explained, ValueError):
    """A name that no file can have on every system; the message says why and what helps."""


def data_folder() -> Path:
    """Where this person's data lies; it need not exist yet."""
    chosen = os.environ.get(DATA_VARIABLE)
    return Path(chosen) if chosen else user_data_path("pinjoint", appauthor=False)


@contextmanager
def data_in(folder: Path | None = None) -> Iterator[Path]:
    """As long as this lasts, this person's data lies in another folder; None: in an empty one that is gone afterwards."""
    before = os.environ.get(DATA_VARIABLE)
    with TemporaryDirectory() as empty:
        os.environ[DATA_VARIABLE] = str(folder or empty)
        try:
            yield folder or Path(empty)
        finally:
            if before is None:
                del os.environ[DATA_VARIABLE]
            else:
                os.environ[DATA_VARIABLE] = before


def own_folder() -> Path:
    """Where saved models lie if no other folder was chosen; it need not exist yet."""
    return data_folder() / "models"


def chosen_folder() -> Path | None:
    """The folder that the person chose for models and pictures; None if they chose none."""
    said = preferences.read(data_folder() / _PLACES).get("folder")
    return Path(said) if isinstance(said, str) and Path(said).is_absolute() else None


def models_folder() -> Path:
    """Where saved models lie; it need not exist yet."""
    return chosen_folder() or own_folder()


def choose_folder(typed: str, *, make: bool) -> None:
    """Let models and pictures lie in a folder from now on; "": where they would without one. make: it may be new.

    Raises NameRefused.
    """
    try:
        folder = Path(typed.strip()).expanduser() if typed.strip() else own_folder()
        if not folder.is_absolute():
            raise NameRefused(
                "{folder} is only a part of a path; write all of it, like {example}.",
                folder=typed,
                example=own_folder(),
            )
        if folder != own_folder() and not make and not folder.is_dir():
            raise NameRefused(
                "There is no folder {folder}; correct it, or save a model there first.", folder=folder
            )
        if make:
            folder.mkdir(parents=True, exist_ok=True)
    except NameRefused:
        raise
    except (OSError, RuntimeError, ValueError) as error:  # such as of an unknown user's ~
        raise NameRefused(
            "The folder {folder} cannot be used: {reason}. Write another one.",
            folder=typed,
            reason=reason_of(error),
        ) from None
    preferences.keep(data_folder() / _PLACES, "folder", "" if folder == own_folder() else str(folder))


def path_of(name: str) -> Path:
    """The file for a name. Raises NameRefused."""
    name = unicodedata.normalize("NFC", name.strip())  # the way to write é that all systems find
    wrong = sorted({character for character in name if not fits_file_names(character)})
    if not name:
        raise NameRefused("The name is empty; type at least one character.")
    if wrong:
        raise NameRefused(
            "A name cannot contain {character!r}; use letters, digits, spaces, - and _.", character=wrong[0]
        )
    if name.startswith(".") or name.endswith("."):
        raise NameRefused("A name cannot begin or end with a dot; remove it.")
    if name.partition(".")[0].rstrip().lower() in _KEPT_BY_WINDOWS:
        raise NameRefused("Windows cannot have files called '{name}'; choose another name.", name=name)
    if len(name) > _LONGEST_NAME:
        raise NameRefused(
            "The name has {count} characters; use at most {most}.", count=len(name), most=_LONGEST_NAME
        )
    if len(name.encode()) > MOST_BYTES:
        raise NameRefused(
            "The name takes {count} bytes in a file system; use at most {most}.",
            count=len(name.encode()),
            most=MOST_BYTES,
        )
    return models_folder() / f"{name}.json"


def saved() -> list[Path]:
    """The files of the saved models, the newest first; none if the folder cannot be read."""
    try:
        return newest_first(models_folder().glob("[!.]*.json"))
    except OSError:
        return []


def newest_first(paths: Iterable[Path]) -> list[Path]:
    """The paths at which there is something, by the time of the last change."""
    found = []
    for path in paths:
        with suppress(OSError):  # such as a link that leads nowhere
            found.append((path.stat().st_mtime, path))
    return [path for _, path in sorted(found, reverse=True)]


def find(name: str) -> Path | str | None:
    """The saved model of that name, else the bundled one; None if there is neither."""
    try:
        path = path_of(name)
    except NameRefused:
        return None
    if path.is_file():
        return path
    return name.strip() if name.strip() in models.bundled() else None


def nearest(name: str) -> str | None:
    """The name of a saved or bundled model that comes nearest, if one does."""
    known = [*map(models.name_of, saved()), *models.bundled()]
    return wording.nearest(name.strip(), known)


def written_age(path: Path) -> str:
    """How long ago a file was written, such as "3 minutes ago"; "" if it is gone."""
    try:
        seconds = max(time.time() - path.stat().st_mtime, 0.0)
    except OSError:
        return ""
    if (days := int(seconds / 86400.0)) >= 60:
        return time.strftime("%Y-%m-%d", time.localtime(time.time() - seconds))
    if days:
        return plural("1 day ago", "{count} days ago", days)
    if hours := int(seconds / 3600.0):
        return plural("1 hour ago", "{count} hours ago", hours)
    if minutes := int(seconds / 60.0):
        return plural("1 minute ago", "{count} minutes ago", minutes)
    return tr("just now")
