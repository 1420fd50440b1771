"""Scripts: JSON lines that play a session through the real scenes and keys; see playing.py.

The first line is a header, {"format": "pinjoint session", "version": 1, "model": "isostatic"} (a bundled
name, a path relative to the script, or a whole document; left out: an empty model), perhaps with a "title" and
a "description", the "mods" that it was recorded with, {"wind": "1.0"}, without which it is not played, and the
"language" of a recording, "pt", unless that is English, and the "units" on screen,
unless these are the usual ones. Every further line does one thing:

    {"press": "space"}                          a key; "over": [x, y] first moves the pointer there (m)
    {"click": [1.0, 1.0]}                       at a point of the model (m); "button": "ctrl+click"
    {"drag": [[0, 0], [1, 1]]}                  between points of the model (m); "button"
    {"type": "200000"}   {"box": "stiffness"}   typing, and selecting a box by its title
    {"set": "particles.B.force=120,-160"}       as --set of the command line
    {"action": "undo"}                          a named action
    {"divide": ["AB", 4]}                       a rod that bends, into so many equal parts
    {"run": "rest"}   {"run": 0.5}              until at rest; or by seconds
    {"steps": 128}                              by steps
    {"expect": "rods.AB.axial_force ≈ -28.34 ± 0.01"}   also =, <, >, <=, >=; scene, time, count.rods, energy.…
    {"expect": "clock.collisions = 3"}          the number of impacts
    {"expect": "message ≈ not found"}           the message in the window; of a text, ≈ asks for a part
    {"input": "click", "pixel": [512, 300]}     what a window recorded
    {"resize": [1280, 800, 2]}                  the window's pixels, and pixels per point
    {"say": "Press Space."}                     shown below the picture in a window; else nothing
    {"task": "…", …}                            a task of a lesson, see game/lessons/tasks.py
    {"answer": ["AB", "CD"]}                    what a student answers to it; also a text or a number

"clipboard" gives the text on the clipboard at that moment.

"at": N on a line first lets time pass to the N-th step, as it had in a recording, and "within": T to that time (s)
within the next one; "window": [width, height] sets the size of the view in pixels. Replaying gives the same bits.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from pinjoint.components.field import FieldError
from pinjoint.components.language import ENGLISH, LANGUAGES, tr
from pinjoint.components.mistake import Mistake, reason_of
from pinjoint.components.settings import STATICS
from pinjoint.components.units import USUAL, shown_in
from pinjoint.components.wording import as_json, cut, remedy

HEADER = {"format": "pinjoint session", "version": 1}
_HEADER_KEYS = (*HEADER, "model", "title", "description", "mods", "language", "units")
EMPTY = {"format": "pinjoint model", "version": 1}
# On which a person draws a structure.
NEW = EMPTY | {"settings": {"opens_in": STATICS}, "grids": [{"spacing": [0.5, 0.5]}]}
# Folders of bundled lessons; those to do ask a student for something.
TO_WATCH, TO_DO = "lessons", "lessons/tasks"


class ScriptError(Mistake, ValueError):
    """A script that cannot be played; the message names the line, the reason and the remedy."""


def lessons(folder: str = TO_WATCH) -> list[str]:
    """Names of the bundled lessons TO_WATCH or TO_DO, in order."""
    names = sorted(entry.name for entry in files("pinjoint.assets").joinpath(folder).iterdir())
    return [name.removesuffix(".jsonl") for name in names if name.endswith(".jsonl")]


def _found(source: str | Path) -> Path | Traversable:
    """The lesson of that name, or else a file."""
    for folder in (TO_WATCH, TO_DO):
        if isinstance(source, str) and source in lessons(folder):
            return files("pinjoint.assets").joinpath(folder, f"{source}.jsonl")
    return Path(source)


class Script:
    """A script read from a file, or a lesson by its name, ready to be played in a session.

    title, description: from its header, or "". language: in which it is played, since a recording says where panels and
    menus were hit, which are as wide as their words; "": any. mods: versions, by name, of those that it was recorded with;
    None: the header says nothing of mods. has_data: whether a folder is chosen in which the script saves and loads; else
    it must be kept away from the models that the person saved.
    """

    has_data, language = False, ""

    def __init__(self, source: str | Path) -> None:
        self.path = _found(source)
        self.lines = list(self._read())
        header = self.lines[0][1] if self.lines else {}
        if header.get("format") != HEADER["format"]:
            form = json.dumps({**HEADER, "model": "isostatic"})
            raise ScriptError("{file}: write the first line like {form}.", file=source, form=form)
        if header.get("version") != HEADER["version"]:
            raise ScriptError(
                "{file}: this program cannot read version {version}; update Pinjoint.",
                file=source,
                version=as_json(header.get("version")),
            )
        self._check_header(header)
        self.mods: dict[str, str] | None = header.get("mods")
        recorded = any("pixel" in entry for _, entry in self.lines)
        self.language = header.get("language", ENGLISH if recorded else "")
        self.units = header.get("units", USUAL)
        self.title, self.description = (str(header.get(key, "")) for key in ("title", "description"))

    def _check_header(self, header: Mapping[str, Any]) -> None:
        for key in header:
            if key not in _HEADER_KEYS:
                keys = ", ".join(_HEADER_KEYS)
                raise self.error(1, tr("there is no '{key}'; use one of {keys}.", key=cut(key), keys=keys))
        if not isinstance(model := header.get("model", EMPTY), str | dict):
            value = as_json(model)
            raise self.error(
                1, tr("model is {value}; write the name of a model, or a whole model.", value=value)
            )
        mods = {} if header.get("mods") is None else header["mods"]
        if not isinstance(mods, dict) or not all(isinstance(version, str) for version in mods.values()):
            form, value = '{"wind": "1.0"}', as_json(mods)
            said = tr("mods is {value}; write names and versions, such as {form}.", value=value, form=form)
            raise self.error(1, said)
        try:
            with shown_in(header.get("units", USUAL)):
                pass
        except (FieldError, TypeError, AttributeError) as error:
            raise self.error(1, error) from None
        if (code := header.get("language", "")) not in ("", *LANGUAGES):
            known = ", ".join(LANGUAGES)
            said = tr("the language is {code}; write one of {languages}.", code=as_json(code), languages=known)
            raise self.error(1, said)

    def error(self, line: int, reason: object) -> ScriptError:
        """What is wrong with a line."""
        return ScriptError("{file} line {line}: {reason}", file=self.path, line=line, reason=reason)

    @classmethod
    def of_lines(cls, title: str, lines: Iterable[tuple[int, Mapping[str, Any]]]) -> Script:
        """A script of some lines of another one, which is not in a file of its own."""
        made = cls.__new__(cls)
        made.units = USUAL
        made.path, made.title, made.description, made.mods, made.has_data = Path(), title, "", None, True
        made.lines = [(0, dict(HEADER)), *((number, dict(entry)) for number, entry in lines)]
        return made

    def _read(self) -> Iterator[tuple[int, dict[str, Any]]]:
        try:
            text = self.path.read_text(encoding="utf-8-sig")
        except FileNotFoundError:
            near = remedy(str(self.path), [*lessons(TO_DO), *lessons()])
            raise ScriptError(
                "There is no file and no lesson '{file}'; {remedy}", file=self.path, remedy=near
            ) from None
        except OSError as error:
            raise ScriptError(
                "{file} cannot be read: {reason}. Check its path.", file=self.path, reason=reason_of(error)
            ) from None
        except UnicodeDecodeError as error:
            raise ScriptError(
                "{file} is not in UTF-8 ({error}); save it in UTF-8.", file=self.path, error=error
            ) from None
        for number, line in enumerate(text.splitlines(), start=1):
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            try:
                entry = json.loads(line)
            except RecursionError:
                raise self.error(number, tr("this is nested too deeply; write it simpler.")) from None
            except ValueError as error:  # also numbers of thousands of digits
                reason = getattr(error, "msg", str(error))
                raise self.error(
                    number, tr("this is not JSON ({reason}); correct it.", reason=reason)
                ) from None
            if not isinstance(entry, dict):
                raise self.error(number, tr("write an object, such as {form}.", form='{"press": "space"}'))
            yield number, entry

    @property
    def source(self) -> Any:
        """The model in the header: a document, a path, or the name of a bundled model."""
        source = self.lines[0][1].get("model", EMPTY)
        return self.beside(source) if isinstance(source, str) else source

    def beside(self, name: str) -> str | Path:
        """The file of that name beside the script, if there is one, else the name, which is that of a bundled model."""
        path = self.path.parent / name if isinstance(self.path, Path) else None
        return path if path is not None and path.is_file() else name

    @property
    def name(self) -> str:
        """The name of its file."""
        return self.path.name.removesuffix(".jsonl")

    @property
    def task_count(self) -> int:
        """How many tasks it has: 0 if it is no lesson that asks a student to do something."""
        return sum("task" in entry for _, entry in self.lines)
