"""Compiling the source of a step program, with a cache on disk."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping
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
        parts += [plain.__qualname__, repr(getattr(function, "targetoptions", {})), _described(plain.__code__)]
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
    plain = isinstance(value, bool | int | float | complex | str | tuple | None | np.generic)
    return repr(value) if plain else type(value).__name__


def _cache_folder() -> Path:
    """A folder for generated modules that can be written to: the user's cache, or a temporary one."""
    for folder in (user_cache_path("pinjoint") / "programs", Path(tempfile.gettempdir()) / "pinjoint-programs"):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    return Path(tempfile.mkdtemp(prefix="pinjoint-programs-"))


_modules: dict[str, ModuleType] = {}


def compile_module(source: str, kernels: Mapping[str, Callable[..., Any]]) -> ModuleType:
    """The module with this source in which `kernels` are known by name; its machine code is cached.

    The file's name hashes everything that is compiled into it, because numba's cache does not notice
    edits of functions that a cached one calls.
    """
    import numba

    everything = "\n".join(
        [source, _meaning_of(kernels[name] for name in sorted(kernels)), numba.__version__, sys.version]
    )
    name = "pinjoint_program_" + hashlib.sha256(everything.encode()).hexdigest()[:24]
    if name not in _modules:
        path = _cache_folder() / f"{name}.py"
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


def _write_once(path: Path, text: str) -> None:
    """Write a file unless it is there with this text; other processes never see a part of it."""
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(temporary, path)
