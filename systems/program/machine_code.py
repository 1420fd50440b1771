"""Machine code of kernels, by numba, and the quick way to compile large programs of them.

Plain numba optimises each part with everything that it calls, and makes machine code of it, although only the entry
is called from Python. Here a part is only translated to LLVM code; the entry is linked with its parts, then optimised and
compiled as a whole, in a fraction of the time. Only the entry's parts call one another, so that arguments which a part
does not use are dropped: an array has nine, which would cost steps of a few rods a third of their time. What can be
called from Python by itself is a part, too, where another kernel calls it.

This uses inner classes of numba (from `_MachineCode` on). With the environment variable PINJOINT_PLAIN_NUMBA=1 all
kernels are compiled by numba's own `njit` with the same options: programs compute the same bits and take longer to
compile.
"""

# mypy: allow-untyped-calls

from __future__ import annotations

import hashlib
import os
import pickle
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from types import ModuleType
from typing import Any

# A vector library computes sines and powers that differ from those of Python in the last bit; read as numba is loaded.
os.environ.setdefault("NUMBA_DISABLE_INTEL_SVML", "1")

import numba
from numba import njit
from numba.core.caching import NullCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps
from numba.core.types import WrapperAddressProtocol, unliteral
from numba.extending import typeof_impl

from pinjoint.systems import is_ours
from pinjoint.systems.program import cache
from pinjoint.systems.program.kernel import PLAIN, Kernel, Use

_PROCESSOR = repr(cpu_target.target_context.codegen().magic_tuple())

_NO_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_FURTHER: dict[Use, dict[str, Any]] = {
    Use.PART: {"no_cfunc_wrapper": True},
    Use.SHARED: {**_NO_WRAPPERS, "parallel": True},
    Use.KEPT: {"nogil": True},  # without the lock, since a thread ends the process where a call never returns
}


def machine_code(kernel: Any) -> Any:
    """What numba makes of a kernel: it compiles itself when it is called, or when what calls it is compiled.

    What mods have declared by numba's own decorators is that already.
    """
    if not isinstance(kernel, Kernel):
        return kernel
    if kernel.machine is None:
        kernel.machine = _dispatcher_of(kernel)
    return kernel.machine


def _part_of(kernel: Kernel) -> Any:
    """What functions that numba compiles call for a kernel."""
    if PLAIN or kernel.use is not Use.PART:
        return machine_code(kernel)
    if kernel.machine_part is None:
        options = {"nopython": True, "boundscheck": None, **_NO_WRAPPERS, **kernel.targetoptions}
        kernel.machine_part = _Part(
            kernel.py_func, locals={}, targetoptions=options, pipeline_class=_PartCompiler
        )
    return kernel.machine_part


def _dispatcher_of(kernel: Kernel) -> Any:
    options, function = _FURTHER[kernel.use] | kernel.targetoptions, kernel.py_func
    if kernel.use is Use.KEPT and not PLAIN:
        options["pipeline_class"] = _EntryCompiler
    dispatcher: Any = njit(**options)(function)
    if kernel.use is Use.KEPT:
        dispatcher._cache = _MachineCode(function)
    if kernel.signature:
        dispatcher.compile(kernel.signature)
        dispatcher.disable_compile()
    return dispatcher


@typeof_impl.register(Kernel)
def _type_of(kernel: Kernel, context: Any) -> Any:
    """Functions that numba compiles call a kernel as what it makes of it."""
    return numba.typeof(_part_of(kernel))


def adopt(module: ModuleType, name: str, kernels: Iterable[Any]) -> None:
    """Let what is compiled of a module, which has this name in the cache, be found there; `kernels` are those it calls.

    A kernel of a mod with `cache=True` is compiled with its program only: numba trusts what it finds on disk.
    """
    for kernel in kernels:
        if isinstance(kernel, CPUDispatcher):
            kernel._cache = NullCache()  # type: ignore[attr-defined]
        if not is_ours(kernel.__module__):
            cpu_target.target_context.refresh()  # it may refer to anything of numba's
    module.__name__ = name
    sys.modules[name] = module  # what is cached looks the module up by its name
    for function in vars(module).values():
        if isinstance(function, Kernel) and function.py_func.__globals__ is vars(module):
            function.py_func.__module__ = name
    if "prange" in vars(module):
        vars(module)["prange"] = numba.prange


def types_of(machine: Mapping[str, Any]) -> dict[str, list[Any]]:
    """For which types of their arguments functions are compiled, by their names."""
    return {name: [signature.args for signature in f.nopython_signatures] for name, f in machine.items()}


def compile_for(function: Any, types: bytes, name: str) -> None:
    """Have machine code of a function, from the cache if it is there, for all types that were found to be needed."""
    for given in pickle.loads(types)[name]:
        if given not in function.overloads:
            function.compile(given)


class _Addressed(WrapperAddressProtocol):
    """A compiled function that others call by its address, so that it is no part of them."""

    def __init__(self, function: Any) -> None:
        (self._signature,) = function.nopython_signatures
        made = function.get_compile_result(self._signature)
        self._address = made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name)

    def __wrapper_address__(self) -> int:
        return int(self._address)

    def signature(self) -> Any:
        """The types of its arguments and of what it returns."""
        return self._signature


@lru_cache
def addressed(function: Any) -> Any:
    """What to give a compiled function that calls this one, which was compiled for one kind of arguments."""
    import numba.experimental.function_type  # noqa: F401 - by which numba knows the type of it

    return _Addressed(function)


class _MachineCode(NullCache):
    """Where numba looks for the machine code of a function, and leaves it.

    Its own cache on disk trusts what it finds. The name of the function's module hashes all that the code follows
    from, but for the types of the arguments.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    def _name(self, signature: Any) -> str:
        types = hashlib.sha256(f"{signature!r} {_PROCESSOR}".encode()).hexdigest()[:16]
        return f"{self._function.__module__}.{self._function.__name__}-{types}.code"

    def load_overload(self, signature: Any, target: Any) -> Any:
        """What was compiled for these types; None if it is to be compiled."""
        # all that Pinjoint's own kernels need; a compiler would take six times as long
        rtsys.initialize(target)
        name = self._name(signature)
        content = cache.read(name)
        if content is None:
            return None
        try:
            return CompileResult._rebuild(target, *pickle.loads(content))
        except Exception as error:  # such as a module that is gone
            cache.drop(name, error)
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep what was compiled, unless it holds addresses of this process."""
        for environment in result._find_referenced_environments():  # of parts, with which they raise errors
            result.library.codegen.set_env(environment.env_name, environment)
        if not result.library.has_dynamic_globals:
            cache.write(self._name(signature), dumps(result._reduce()))


# --- parts ---------------------------------------------------------------------------------------


class _PartCode(JITCodeLibrary):
    """LLVM code of a part and a list of the libraries that it calls. It is linked into others, and never run."""

    def finalize(self) -> None:
        """End construction without optimising: the entry that links this part optimises it."""
        # newer versions of numba: functions to call when cached code is loaded
        if hasattr(self, "_reload_init"):
            for called in self._linking_libraries:
                self._reload_init.update(called._reload_init)
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """The part and all that it calls, each once.

        Their functions are "linkonce_odr": where several parts bring the same function, the linker keeps one.
        """
        self._ensure_finalized()
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            for called in self._called({}):
                is_part = isinstance(called, _PartCode)
                module = called._final_module if is_part else called._get_module_for_linking()
                self._shared_module.link_in(module, preserve=True)
            for function in self._shared_module.functions:
                if not function.is_declaration and function.linkage.name == "external":
                    function.linkage = "linkonce_odr"
        return self._shared_module

    def _called(self, found: dict[Any, None]) -> dict[Any, None]:
        """All libraries that it calls, directly or not, in the order of the calls."""
        for called in self._linking_libraries:
            if called not in found:
                found[called] = None
                if isinstance(called, _PartCode):
                    called._called(found)
        return found

    @property
    def codegen(self) -> _PartCode:
        """The receiver of set_env(), which numba's compiler looks up here."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: only machine code has an environment, which is set once that is there."""


class _PartCompiler(Compiler):
    """Compiles a part as far as LLVM code."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or _PartCode(target.codegen(), "part"), *rest)


class _Part(CPUDispatcher):
    """What the name of a part stands for."""

    def get_call_template(self, given: Any, named: Any) -> Any:
        """The same version for the constant 3 as for any other integer."""
        plain = {name: unliteral(kind) for name, kind in named.items()}
        return super().get_call_template(tuple(unliteral(kind) for kind in given), plain)


# --- entries -------------------------------------------------------------------------------------


class _EntryCode(JITCodeLibrary):
    """Code of an entry; its parts become private, so that the optimiser may change how they are called.

    What is only internal has a name, by which the linker finds it for others, who call it as it was.
    """

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "private"
        super()._optimize_final_module()


class _EntryCompiler(Compiler):
    """Compiles an entry with its parts to machine code that can be cached."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        if library is None:
            library = _EntryCode(target.codegen(), "entry")
            library.enable_object_caching()
        super().__init__(typing, target, library, *rest)
