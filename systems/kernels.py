"""How every kernel is compiled: IEEE division (no exception), no fastmath, so that bits are reproducible.

Those that only other kernels call are parts. numba makes machine code of every function by itself, after optimising
it with all that it calls, although of a program only the outermost one is ever entered. A part stays what it was
before that, and is optimised and made machine code of as a piece of what it is linked into, an entry: that compiles
a large program in a fraction of the time. An entry knows that nobody else calls its parts, which are handed only the
arguments that they use: of an array there are nine, and steps of a few rods spend a third of their time on others.
"""


# mypy: allow-untyped-calls

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from numba import njit
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.typed_passes import InlineOverloads, NopythonRewrites
from numba.core.types import Function, unliteral
from numba.core.typing.context import Context
from numba.core.untyped_passes import (
    FindLiterallyCalls,
    InlineClosureLikes,
    InlineInlinables,
    LiteralPropagationSubPipelinePass,
    LiteralUnroll,
    MakeFunctionToJitFunction,
    WithLifting,
)

# Passes over a function that look for what kernels do not have: `with`, closures and comprehensions, functions
# inlined before their types are known, loops over unlike things, expressions of whole arrays.
UNUSED = (
    WithLifting,
    InlineClosureLikes,
    MakeFunctionToJitFunction,
    InlineInlinables,
    FindLiterallyCalls,
    LiteralUnroll,
    LiteralPropagationSubPipelinePass,
    InlineOverloads,
    NopythonRewrites,
)

compiled = njit(error_model="numpy", no_cfunc_wrapper=True)  # type: ignore[call-overload]


class _Code(JITCodeLibrary):
    """What a part consists of, and which others it calls: to be linked, never run."""

    def finalize(self) -> None:
        """It is what it is: what takes it in optimises it."""
        if hasattr(
            self, "_reload_init"
        ):  # in newer versions of numba: what is to be done when cached code is loaded
            for called in self._linking_libraries:
                self._reload_init.update(called._reload_init)
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """It and all that it calls, each once; who links several such has one of each at last."""
        self._ensure_finalized()
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            for called in self._called({}):
                module = called._final_module if isinstance(called, _Code) else called._get_module_for_linking()
                self._shared_module.link_in(module, preserve=True)
            for function in self._shared_module.functions:
                if not function.is_declaration and function.linkage.name == "external":
                    function.linkage = "linkonce_odr"
        return self._shared_module

    def _called(self, found: dict[Any, None]) -> dict[Any, None]:
        """All code that it calls, directly or not, in the order in which it does."""
        for called in self._linking_libraries:
            if called not in found:
                found[called] = None
                if isinstance(called, _Code):
                    called._called(found)
        return found

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    @property
    def codegen(self) -> _Code:
        """Whoever asks for it wants to tell machine code its environment."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """There is no machine code to tell; only what parts raise would need it, and they raise nothing."""


class _Typing(Context):
    """What numba knows of types, and what it has found: for every a + b it would ask a dozen that may know the type.

    A large program has some six thousand such operations, of which a few hundred are different.
    """

    def __init__(self, known: Context) -> None:
        self.__dict__ = known.__dict__
        self._found: dict[Any, Any] = {}

    def resolve_function_type(self, function: Any, given: Any, named: Any) -> Any:
        """Types of what a call is given and returns."""
        known = self._lookup_global(function) or function
        if named or not isinstance(known, Function):
            return super().resolve_function_type(function, given, named)
        key = known, tuple(given)
        if key not in self._found:
            found = super().resolve_function_type(function, given, named)
            if found is None:
                return None
            self._found[key] = found
        return self._found[key]


class _Lean(Compiler):
    """numba's compiler, with what it found of types, and without passes that kernels have no use for."""

    _typing = _Typing(cpu_target.typing_context)

    def __init__(self, _: Any, *rest: Any) -> None:
        super().__init__(self._typing, *rest)

    def define_pipelines(self) -> list[PassManager]:
        """One that makes machine code."""
        (usual,) = super().define_pipelines()
        lean = PassManager(usual.pipeline_name)
        for kind, what_for in usual.passes:
            if kind not in UNUSED:
                lean.add_pass(kind, what_for)
        lean.finalize()
        return [lean]


class _Compiler(_Lean):
    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or _Code(target.codegen(), "part"), *rest)


class _Whole(JITCodeLibrary):
    """What an entry consists of: parts that are its own."""

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "linkonce_odr":
                function.linkage = "internal"
        super()._optimize_final_module()


class _EntryCompiler(_Lean):
    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        if library is None:
            library = _Whole(target.codegen(), "entry")
            library.enable_object_caching()
        super().__init__(typing, target, library, *rest)


class _ApartCompiler(_Compiler):
    def __init__(
        self, typing: Any, target: Any, library: Any, given: Any, result: Any, flags: Any, *rest: Any
    ) -> None:
        flags.noalias = True
        super().__init__(typing, target, library, given, result, flags, *rest)


class _Part(CPUDispatcher):
    def get_call_template(self, given: Any, named: Any) -> Any:
        """Of one that is given the constant 3, as of one that is given any integer: no others are compiled."""
        plain = {name: unliteral(kind) for name, kind in named.items()}
        return super().get_call_template(tuple(unliteral(kind) for kind in given), plain)

    def __call__(self, *given: Any, **named: Any) -> Any:
        """What was never compiled by itself cannot be called by itself."""
        raise TypeError(f"{self.py_func.__qualname__} is a part of programs: call it from a compiled function.")


def part(*, apart: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """A decorator like `compiled`, with further options, for functions that only compiled ones call.

    apart: no two of the arrays that it is given share memory that it writes to, which is then not made sure of.
    """
    chosen = {
        "error_model": "numpy",
        "nopython": True,
        "boundscheck": None,
        "no_cpython_wrapper": True,
        "no_cfunc_wrapper": True,
    }
    compiler = _ApartCompiler if apart else _Compiler
    return partial(_Part, locals={}, targetoptions=chosen | options, pipeline_class=compiler)


def entry(**options: Any) -> Any:
    """A decorator like `compiled`, with further options, for functions by which Python enters what parts make up."""
    return njit(error_model="numpy", cache=True, pipeline_class=_EntryCompiler, **options)
