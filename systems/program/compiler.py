"""Compiling generated modules, step programs above all, with a cache on disk that processes share."""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import linecache
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from types import CodeType, ModuleType
from typing import Any

import numpy as np

from systems import cache


def _meaning_of(functions: Iterable[Callable[..., Any]]) -> str:
    """All that decides what these compiled functions compute: code, options, what they refer to or call.

    Read from the functions in memory: their files may have changed since they were imported.
    """
    parts: list[str] = []
    for function in _reached_from(functions):
        if isinstance(function, type):
            parts.append(_constant(function))
            continue
        plain = getattr(function, "py_func", function)
        parts += [
            f"{plain.__module__}.{plain.__qualname__}",
            repr(getattr(function, "targetoptions", {})),
            _described(plain.__code__),
            *(f"{name} = {_constant(value)}" for name, value in sorted(_used_by(plain).items())),
        ]
    return "\n".join(parts)


def _reached_from(functions: Iterable[Callable[..., Any]]) -> Iterator[Callable[..., Any]]:
    """These functions and all compiled ones that they call, each once."""
    pending, seen = list(functions), set[Callable[..., Any]]()
    while pending:
        function = pending.pop()
        if function not in seen:
            seen.add(function)
            yield function
            if not isinstance(function, type):
                used = _used_by(getattr(function, "py_func", function))
                pending += [value for _, value in sorted(used.items()) if hasattr(value, "py_func")]


def _used_by(plain: Callable[..., Any]) -> dict[str, Any]:
    """The names that a function takes from outside: closure, globals, and attributes of modules among these."""
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
    if isinstance(value, type) and issubclass(value, IntEnum):
        return repr((value.__name__, [(member.name, member.value) for member in value]))
    plain = isinstance(value, bool | int | float | complex | str | tuple | None | np.generic)
    return repr(value) if plain else type(value).__name__


_LAYOUT = 2  # of what is kept on disk: raise it where former files are of no use any more
_modules: dict[str, ModuleType] = {}
_compiled = set[str]()  # names of modules all functions of which this process has called


def compile_module(source: str, kernels: Mapping[str, Callable[..., Any]]) -> ModuleType:
    """The module with this source in which `kernels` are known by name; its machine code is cached."""
    from systems.kernels import forget_own_cache

    name = _name_of(source, kernels)
    if name not in _modules:
        for function in _reached_from(kernels.values()):
            forget_own_cache(function)
        module = ModuleType(name)
        vars(module).update(kernels)
        sys.modules[name] = module  # what is cached looks the module up by its name
        shown = f"<{name}>"
        linecache.cache[shown] = len(source), None, source.splitlines(keepends=True), shown  # for tracebacks
        exec(compile(source, shown, "exec"), vars(module))
        _modules[name] = module
    return _modules[name]


def _name_of(source: str, kernels: Mapping[str, Callable[..., Any]]) -> str:
    """The name of a generated module, which hashes everything that is compiled into it.

    numba's own cache would notice neither edits of functions that a cached one calls, nor another processor.
    """
    import numba
    from numba.core.registry import cpu_target

    from systems.kernels import PLAIN

    processor = repr(cpu_target.target_context.codegen().magic_tuple())
    meaning = _meaning_of(kernels[name] for name in sorted(kernels))
    about = source, meaning, numba.__version__, sys.version, processor, f"plain: {PLAIN}", f"layout: {_LAYOUT}"
    return "pinjoint_program_" + hashlib.sha256("\n".join(about).encode()).hexdigest()[:24]


@dataclass(frozen=True)
class CompiledUnit:
    """A generated module that is the same for every model: the drawing, or kernels of collisions.

    name: the name that a compiling process is given. contents: returns the source, and the kernels by their names in
    the source; the call imports them. warm_up: calls all functions, so that numba compiles or loads them; not needed
    where types are declared.
    """

    name: str
    contents: Callable[[], tuple[str, Mapping[str, Callable[..., Any]]]]
    warm_up: Callable[[], None] = lambda: None

    @cached_property
    def module(self) -> ModuleType:
        """The module; what was not called yet may still have to be compiled."""
        return compile_module(*self.contents())

    @cached_property
    def _module_name(self) -> str:
        return _name_of(*self.contents())

    def is_compiled(self) -> bool:
        """True if it need only be loaded."""
        return _is_noted(self._module_name)

    def load(self) -> ModuleType:
        """The module with all its functions ready; compiled first, if nobody has."""
        if self._module_name not in _compiled:
            self.warm_up()
            note_compiled(self.module)
        return self.module


def entries_to(kernels: Mapping[str, Callable[..., Any]]) -> tuple[str, dict[str, Callable[..., Any]]]:
    """Source of a module with an entry to each kernel, under the given names, and the kernels as the source calls them."""
    lines = [
        '"""Entries to kernels. Generated; safe to delete."""',
        "from systems.kernels import kept",
        'entry = kept(error_model="numpy", _nrt=False)',
    ]
    for name, kernel in kernels.items():
        arguments = ", ".join(inspect.signature(getattr(kernel, "py_func", kernel)).parameters)
        lines += ["", "", "@entry", f"def {name}({arguments}):", f"    return kernel_{name}({arguments})"]
    return "\n".join([*lines, ""]), {f"kernel_{name}": kernel for name, kernel in kernels.items()}


def load_compiler() -> None:
    """Import and start up the compiler, which takes longer than loading a compiled module."""
    from numba import njit

    njit("int64(int64)")(lambda number: number)


def is_compiled(source: str, kernels: Mapping[str, Callable[..., Any]]) -> bool:
    """True if another process, or an earlier one, has compiled all of this module."""
    return _is_noted(_name_of(source, kernels))


def _is_noted(name: str) -> bool:
    return name in _compiled or (cache.folder() / f"{name}.done").exists()


def is_blank() -> bool:
    """True if nothing at all is compiled yet: the program is started for the first time."""
    return next(cache.folder().glob("*.done"), None) is None


def note_compiled(module: ModuleType) -> None:
    """Note on disk that all of a module is compiled and kept, and when it was last used."""
    _compiled.add(module.__name__)
    if not cache.TROUBLE:
        with contextlib.suppress(OSError):
            (cache.folder() / f"{module.__name__}.done").touch()


def forget_unused(days: float = 60.0) -> None:
    """Delete modules unused for so many days, mostly of former versions, and what killed processes left."""
    folder, now = cache.folder(), time.time()
    for path in (*folder.glob("pinjoint_program_*.done"), *folder.glob("pinjoint_program_*.tmp")):
        with contextlib.suppress(OSError):
            if now - path.stat().st_mtime > 86400.0 * days:
                for old in (*folder.glob(f"__pycache__/{path.stem}.*"), *folder.glob(f"{path.stem}.*")):
                    old.unlink(missing_ok=True)
