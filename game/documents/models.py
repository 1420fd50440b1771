"""Models in files: found by path or name, mistakes explained, written as a whole or not at all."""

from __future__ import annotations

import codecs
import gc
import json
import math
import os
import re
import shutil
import sys
import time
import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import IO, Any, NoReturn

import msgspec

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import reason_of
from pinjoint.components.model import Model
from pinjoint.components.wording import nearest, quoted
from pinjoint.documents.document import document as document
from pinjoint.documents.document import parse as parse
from pinjoint.documents.format import ModelError as ModelError

LEFT = 3600.0  # s after which nobody writes to the file of a save any more


def bundled() -> list[str]:
    """Names of the models that come with the program and its mods, in alphabetical order."""
    return sorted(_bundled_files())


def _bundled_files() -> dict[str, Traversable]:
    """The files of these models by name."""
    entries = (
        entry
        for folder in (*EXTENSIONS.folders, files("pinjoint.assets") / "models")
        for entry in folder.iterdir()
    )
    return {entry.name.removesuffix(".json"): entry for entry in entries if entry.name.endswith(".json")}


# --- reading ---------------------------------------------------------------------------------------


class _RodHeader(msgspec.Struct):
    bending_stiffness: float = 0.0


class ModelHeader(msgspec.Struct):
    """The title and the description in a model file, and whether its rods bend."""

    title: str = ""
    description: str = ""
    rods: tuple[_RodHeader, ...] = ()

    @property
    def bends(self) -> bool:
        """True if some rod has bending stiffness."""
        return any(rod.bending_stiffness > 0.0 for rod in self.rods)


@cache
def header_of(name: str) -> ModelHeader:
    """What the start page needs of a bundled model, without the rest of its file; empty if it cannot be read."""
    try:
        return msgspec.json.decode(_found(name).read_bytes(), type=ModelHeader)
    except (OSError, ValueError, RecursionError):  # `load` explains it
        return ModelHeader()


def load(source: str | Path | Mapping[str, Any]) -> Model:
    """The model in a file, in the bundled model of that name, or in a document. Raises ModelError."""
    if isinstance(source, Mapping):
        return parse(source)
    if not isinstance(source, str | os.PathLike):
        raise ModelError(
            "{source} is not a model; give a file, the name of a bundled model, or a document.",
            source=quoted(source),
        )
    try:
        raw = _found(source).read_bytes()
    except IsADirectoryError:
        raise ModelError("'{source}' is a folder; name a model file in it.", source=source) from None
    except FileNotFoundError:
        near = nearest(Path(source).stem, bundled(), cutoff=0.6)
        message = marked("There is no file and no bundled model '{source}'.")
        if near:
            message = marked("There is no file and no bundled model '{source}'; did you mean '{near}'?")
        hint = tr("pinjoint --help lists the bundled models.")
        raise ModelError(joined([tr(message, source=source, near=near), hint])) from None
    except (OSError, ValueError) as error:
        raise ModelError(
            "{source} cannot be read: {reason}. Check its path and permissions.",
            source=source,
            reason=reason_of(error),
        ) from None
    with _nothing_collected():
        return parse(_decoded(raw, str(source)), str(source))


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """Switch the garbage collector off meanwhile: with millions of new elements it takes a third of the time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def _found(source: str | Path) -> Path | Traversable:
    """A bundled model's name wins over a file, so that it means the same in every folder."""
    found = _bundled_files().get(source) if isinstance(source, str) else None
    return found or Path(source)


def name_of(path: Path) -> str:
    """What the model in a file is called; bytes that are no text as "�"."""
    return os.fsencode(path.stem).decode(errors="replace")


def _decoded(raw: bytes, source: str) -> Any:
    """What JSON bytes say. Raises ModelError if they are not JSON or an object repeats a key."""
    # What editors and shells write besides UTF-8:
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise ModelError("{source} is written in UTF-16; save it in UTF-8.", source=source)
    if not raw.strip():
        raise ModelError("{source} is empty; save the model again.", source=source)
    raw = raw.removeprefix(codecs.BOM_UTF8)
    try:
        content = msgspec.json.decode(raw)
        # The decoder keeps only the last of repeated keys, so that fewer texts come back.
        if _count_texts(raw) != _count_texts(msgspec.json.encode(content)):
            _refuse_repeated_keys(_decoded_strictly(raw, source), f"{source}: $")
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        _decoded_strictly(raw, source)  # names the line
        raise _not_json(source, error) from None
    except RecursionError:
        raise ModelError("{source} is nested too deeply to be a model.", source=source) from None
    return content


def _count_texts(valid: bytes) -> int:
    """How many texts, keys included, valid JSON holds: without its escapes, quotes only delimit them."""
    return re.sub(rb"\\.", b"", valid).count(b'"') // 2


class _Pairs(list[tuple[str, Any]]):
    """An object of a JSON text, repeated keys included."""


def _decoded_strictly(raw: bytes, source: str) -> Any:
    def refuse(constant: str) -> NoReturn:
        raise ModelError(
            "{source} contains {number}; every number must be finite.", source=source, number=constant
        )

    def finite(number: str) -> float:
        return (
            float(number)
            if math.isfinite(float(number))
            else refuse(number if len(number) < 20 else f"{number[:9]}…")
        )

    try:
        return json.loads(
            raw, object_pairs_hook=_Pairs, parse_constant=refuse, parse_float=finite, parse_int=finite
        )
    except UnicodeDecodeError as error:
        line = 1 + raw[: error.start].count(b"\n")
        raise ModelError(
            "{source}: line {line} has a character that is not UTF-8; save the file in UTF-8.",
            source=source,
            line=line,
        ) from None
    except json.JSONDecodeError as error:
        raise _not_json(source, error) from None


def _not_json(source: str, error: Exception) -> ModelError:
    return ModelError(
        "{source} is not a JSON file ({error}); correct it, or save the model again.",
        source=source,
        error=error,
    )


def _refuse_repeated_keys(value: Any, path: str) -> None:
    if isinstance(value, _Pairs):
        keys: set[str] = set()
        for key, item in value:
            if key in keys:
                raise ModelError(
                    "{path}: this key stands twice in one object; keep one of the two.", path=f"{path}.{key}"
                )
            keys.add(key)
            _refuse_repeated_keys(item, f"{path}.{key}")
    elif isinstance(value, list):
        for index, item in enumerate(value):
            _refuse_repeated_keys(item, f"{path}[{index}]")


# --- writing ---------------------------------------------------------------------------------------


def save(model: Model, path: str | Path) -> None:
    """Write a model to a file, one element a line, as a whole or not at all. Raises ModelError."""
    content = document(model)
    try:
        replace(path, laid_out(content, depth=2).encode() + b"\n")
    except (OSError, ValueError) as error:
        raise ModelError(
            "{path} was not saved: {reason}. The file is as it was before; choose another folder or name.",
            path=path,
            reason=reason_of(error),
        ) from None


def replace(path: str | Path, content: bytes) -> None:
    """Give a file new content; at every moment it has either the old or the new one. Raises OSError, ValueError.

    A device, a pipe, and a file in a folder without write permission are written in place.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not (path.is_file() and os.access(path.parent, os.W_OK)):
        path.write_bytes(content)
        return
    _clear_leftovers(path.parent)
    temporary = path.with_name(f".{uuid.uuid4().hex}.tmp")
    try:
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, temporary)
        temporary.replace(path)
        _sync(path.parent)
    finally:
        temporary.unlink(missing_ok=True)


def lock_file(path: Path) -> IO[bytes] | None:
    """The open file, if no running program holds it; it is held until it is closed or the program ends."""
    file = path.open("ab")
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        return None
    return file


@cache
def _clear_leftovers(folder: Path) -> None:
    """Delete what programs that were killed while they saved have left in a folder."""
    for path in folder.glob(f".{'[0-9a-f]' * 32}.tmp"):
        with suppress(OSError):
            if time.time() - path.lstat().st_mtime > LEFT:
                path.unlink()


def _sync(folder: Path) -> None:
    """Let a folder's entries survive a power cut, where a system can be asked to."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def laid_out(value: Any, depth: int, indent: str = "") -> str:
    """JSON text whose outermost `depth` levels have one entry a line, indented by 2 spaces."""
    if depth == 0 or not isinstance(value, dict | list) or not value:
        return msgspec.json.format(msgspec.json.encode(value), indent=0).decode()
    inner, (opening, closing) = indent + "  ", "[]"
    if isinstance(value, dict):
        entries = [f"{laid_out(key, 0)}: {laid_out(item, depth - 1, inner)}" for key, item in value.items()]
        opening, closing = "{}"
    else:
        entries = [laid_out(item, depth - 1, inner) for item in value]
    return f"{opening}\n{inner}" + f",\n{inner}".join(entries) + f"\n{indent}{closing}"
