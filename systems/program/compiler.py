"""Compiling the source of a step program, with a cache on disk."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import inspect
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from enum import Enum, EnumType
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np
from platformdirs import user_cache_path


def _meaning_of(functions: Iterable[Callable[..., Any]]) -> str:
    """All that decides what these compiled functions compute: code, options, what they refer to or call.

    Taken from the functions as they are in memory, for their files may have changed since, or be none.
    """
    parts: list[str] = []
    pending, seen = list(functions), set[Callable[..., Any]]()
    while pending:
        function = pending.pop()
        if function in seen:
            continue
        seen.add(function)
        plain = getattr(function, "py_func", function)
        parts += [
            f"{plain.__module__}.{plain.__qualname__}",
            repr(getattr(function, "targetoptions", {})),
            _described(plain.__code__),
        ]
        for name, value in sorted(_used_by(plain).items()):
            parts.append(f"{name} = {_constant(value)}")
            if hasattr(value, "py_func"):
                pending.append(value)
    return "\n".join(parts)


def _used_by(plain: Callable[..., Any]) -> dict[str, Any]:
    """What a function takes from around it: closure, globals, and attributes of modules among these."""
    outside = inspect.getclosurevars(plain)
    used: dict[str, Any] = {**outside.globals, **outside.nonlocals}
    for name, value in list(used.items()):
        if isinstance(value, ModuleType):
            names = plain.__code__.co_names
            used |= {f"{name}.{n}": getattr(value, n) for n in names if hasattr(value, n)}
    return used


def _described(code: CodeType) -> str:
    constants = [_described(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts]
    return repr((code.co_code, code.co_names, code.co_varnames, constants))


def _constant(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return repr((value.dtype.str, value.shape, value.tobytes()))
    if isinstance(value, EnumType):  # named columns
        members: Mapping[str, Enum] = value.__members__
        return repr([(name, member.value) for name, member in members.items()])
    plain = isinstance(value, bool | int | float | complex | str | tuple | None | np.generic)
    return repr(value) if plain else type(value).__name__


@cache
def cache_folder() -> Path:
    """A folder for generated modules that can be written to: the user's cache, or a temporary one.

    What lies there is run, so a temporary folder that somebody else may have made is not used.
    """
    owner = os.getuid() if hasattr(os, "getuid") else 0
    shared = Path(tempfile.gettempdir()) / f"pinjoint-programs-{owner}"
    for folder in (user_cache_path("pinjoint") / "programs", shared):
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                pass
            if not hasattr(os, "getuid") or folder.stat().st_uid == owner:
                return folder
        except OSError:
            continue
    return Path(tempfile.mkdtemp(prefix="pinjoint-programs-"))


_modules: dict[str, ModuleType] = {}
_compiled = set[str]()  # of these, those of which this process has called all


def compile_module(source: str, kernels: Mapping[str, Callable[..., Any]]) -> ModuleType:
    """The module with this source in which `kernels` are known by name; its machine code is cached."""
    name = _name_of(source, kernels)
    if name not in _modules:
        path = cache_folder() / f"{name}.py"
        _write_once(path, source)
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        vars(module).update(kernels)
        sys.modules[name] = module  # numba's cache looks the module up by its name
        spec.loader.exec_module(module)
        _modules[name] = module
    return _modules[name]


def _name_of(source: str, kernels: Mapping[str, Callable[..., Any]]) -> str:
    """The name of a generated module, which hashes everything that is compiled into it.

    numba's cache notices neither edits of functions that a cached one calls, nor another processor.
    """
    import numba
    from numba.core.registry import cpu_target

    processor = repr(cpu_target.target_context.codegen().magic_tuple())
    meaning = _meaning_of(kernels[name] for name in sorted(kernels))
    everything = "\n".join([source, meaning, numba.__version__, sys.version, processor])
    return "pinjoint_program_" + hashlib.sha256(everything.encode()).hexdigest()[:24]


def load_compiler() -> None:
    """Import the compiler and let it get ready, which takes longer than to load what it once compiled."""
    from numba import njit

    njit("int64(int64)")(lambda number: number)


def is_compiled(source: str, kernels: Mapping[str, Callable[..., Any]]) -> bool:
    """True if another process, or an earlier one, has compiled all of this module."""
    name = _name_of(source, kernels)
    return name in _compiled or (cache_folder() / f"{name}.done").exists()


def is_blank() -> bool:
    """True if nothing at all is compiled yet, as when the program is started for the first time."""
    return next(cache_folder().glob("*.done"), None) is None


def note_compiled(module: ModuleType) -> None:
    """Let other processes know that all of a module is compiled, and later ones that it is in use."""
    _compiled.add(module.__name__)
    with contextlib.suppress(OSError):
        (cache_folder() / f"{module.__name__}.done").touch()


def forget_unused(days: float = 60.0) -> None:
    """Delete modules that no program has used for so many days, of former versions mostly."""
    folder = cache_folder()
    for done in folder.glob("pinjoint_program_*.done"):
        with contextlib.suppress(OSError):
            if time.time() - done.stat().st_mtime > 86400.0 * days:
                for path in (*folder.glob(f"__pycache__/{done.stem}.*"), folder / f"{done.stem}.py", done):
                    path.unlink(missing_ok=True)


def _write_once(path: Path, text: str) -> None:
    """Write a file unless it is there with this text; other processes never see a part of it."""
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(temporary, path)
