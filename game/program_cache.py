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
from types import ModuleType
from typing import Any

from platformdirs import user_cache_path


def _sources_of(functions: Iterable[Callable[..., Any]]) -> str:
    """The text of every module in which these compiled functions, or others they call, are written."""
    texts: dict[str, str] = {}
    pending = [getattr(function, "py_func", function) for function in functions]
    seen = set()
    while pending:
        plain = pending.pop()
        if plain in seen:
            continue
        seen.add(plain)
        path = inspect.getsourcefile(plain) or ""
        texts.setdefault(path, Path(path).read_text(encoding="utf-8"))
        called = (plain.__globals__.get(name) for name in plain.__code__.co_names)
        pending += [plain_of for other in called if (plain_of := getattr(other, "py_func", None))]
    return "".join(texts[path] for path in sorted(texts))


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

    everything = "\n".join([source, _sources_of(kernels.values()), numba.__version__, sys.version])
    name = "pinjoint_program_" + hashlib.sha256(everything.encode()).hexdigest()[:24]
    if name not in _modules:
        path = _cache_folder() / f"{name}.py"
        _write_once(path, source)
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None and spec.loader is not None
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
