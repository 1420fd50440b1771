"""Generated modules, step programs above all: interpreted at once, compiled when that is worth it.

Machine code is kept in a cache on disk that processes share.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import linecache
import math
import os
import pickle
import sys
import threading
import time
import weakref
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from functools import cached_property
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from pinjoint.components.language import begun, tr
from pinjoint.components.mistake import wrong_variable
from pinjoint.systems.program import cache
from pinjoint.systems.program.binding import ProgramError
from pinjoint.systems.program.identity import key_of, reached_from
from pinjoint.systems.program.interpreter import NoPlainForm, Rewriting, plain_function, rewrite
from pinjoint.systems.program.kernel import Kernel, Use

# --- which form ------------------------------------------------------------------------------------


class Compile(Enum):
    """When programs are compiled: as PINJOINT_COMPILE says."""

    NEVER = "never"  # everything is interpreted
    SOON = ""  # what is short is interpreted; who runs for long compiles, or loads, the program in between
    ELSEWHERE = "elsewhere"  # other processes compile; this one loads what they made when it is told to
    ALWAYS = "always"  # before the first step


def _asked() -> Compile:
    try:
        return Compile(os.environ.get(VARIABLE, ""))
    except ValueError:
        raise wrong_variable(VARIABLE, tr("never or always")) from None


VARIABLE = "PINJOINT_COMPILE"
_STARTING = 0.05  # s of interpreting, of all modules, after which it is worth it to start the compiler up
_LOADING = 0.03  # s of interpreting after which it is sooner to load what is compiled
SMALL = 50  # rods or discs up to which the interpreted form may well take all steps of a run before another is loaded
LARGE = 300  # rods or discs from which on one step, interpreted, takes as long as a picture
LONGEST_CALL = 0.05  # s, interpreted
LONGEST_WORK = 2**15  # counted operations of a call that nothing divides: about as much, interpreted
_SECONDS_PER_BYTE = 2e-4  # of the interpreter's code, that compiling takes


class Choice:
    """Which form programs of this process run in; a window changes it to ELSEWHERE.

    changes: how often a program began, or changed its form, in this process; what steps cost is known until then.
    deadline: the time (time.perf_counter, s) from which on a step that is interpreted, and can be gone on with, raises
    Unfinished. patience: s that a call of kernels of others may take, apart from compiling. proved: how the names of modules
    begin whose kernels give the same bits in both forms.
    """

    compile = _asked()
    changes = 0
    deadline = math.inf
    spent = 0.0  # s of interpreting, of all modules
    patience = 600.0
    proved = ("pinjoint.",)


class Unfinished(Exception):
    """A step takes longer than a frame may: the next advance goes on with it."""


# --- modules ---------------------------------------------------------------------------------------


class GeneratedModule:
    """Generated source, with the kernels that it calls by name, in two forms: plain Python and machine code.

    Both compute the same bits, so that one may follow the other between any two calls. Nothing proves that of kernels that
    others wrote: what calls some is compiled before its first call, unless nothing may be. functions: what Python may
    call, by name, as declared. users: programs that call it. spent: time that interpreting took in this process (s).
    portion: of what there is to do, such as steps, for one interpreted call, so that another form may soon follow.
    """

    def __init__(
        self,
        name: str,
        contents: Callable[[], tuple[str, Mapping[str, Callable[..., Any]]]],
        warm_up: Callable[[], object] = lambda: None,
        needs: tuple[GeneratedModule, ...] = (),
    ) -> None:
        """name: of what it is for, which a process that compiles is given. contents: returns source and kernels; the
        call imports them. warm_up: calls all functions; needed where types are not declared. needs: modules whose machine
        code its own calls.
        """
        self.name = name
        self.spent = 0.0
        self.refusal = ""
        self._contents = contents
        self._needs = needs
        self.users: weakref.WeakSet[Any] = weakref.WeakSet()  # the module lives longer
        self.warm_up = warm_up
        self._form: Any = None
        self.portion = 1
        self._compiled = False
        self._patience = 0.0
        self._last = 0.0

    @cached_property
    def _source_and_kernels(self) -> tuple[str, Mapping[str, Callable[..., Any]]]:
        return self._contents()

    @property
    def source(self) -> str:
        """The Python that it consists of."""
        return self._source_and_kernels[0]

    @cached_property
    def key(self) -> str:
        """The name of the module in the cache, which hashes everything that is compiled into it."""
        return key_of(*self._source_and_kernels)

    @property
    def _kept(self) -> Path:
        """The file that is there once all of it is compiled and kept: for which types of arguments its functions are."""
        return cache.folder() / f"{self.key}.types"

    @cached_property
    def module(self) -> ModuleType:
        """The module, executed."""
        source, kernels = self._source_and_kernels
        shown = f"<{self.name} {hashlib.sha256(source.encode()).hexdigest()[:16]}>"
        linecache.cache[shown] = len(source), None, source.splitlines(keepends=True), shown  # for tracebacks
        module = ModuleType(shown)
        vars(module).update(kernels)
        exec(compile(source, shown, "exec"), vars(module))
        return module

    @cached_property
    def others(self) -> list[Callable[..., Any]]:
        """The kernels that others wrote among those that it calls: interpreted, they might give other bits."""
        called = (kernel for kernel in self._source_and_kernels[1].values() if callable(kernel))
        return [kernel for kernel in called if not str(kernel.__module__).startswith(Choice.proved)]

    @cached_property
    def functions(self) -> dict[str, Kernel]:
        """What Python may call."""
        made = vars(self.module).items()
        return {n: k for n, k in made if isinstance(k, Kernel) and k.use is Use.KEPT}

    @property
    def form(self) -> Any:
        """The functions by name, in the form that they run in now; is_machine: it is machine code."""
        if self._form is None:
            Choice.changes += 1
            if Choice.compile is Compile.ALWAYS:
                self.load()
            elif self.others and Choice.compile is not Compile.NEVER:
                self.load_or_tell()
            if self._form is None:
                self._begin_interpreted()
        elif self.spent > self._patience and Choice.spent > _STARTING and not self._compiled:
            self._lose_patience()
        return self._form

    @cached_property
    def rewritten(self) -> dict[str, Callable[..., Any]] | None:
        """The interpreted functions, not timed; None where a kernel has no source, and `refusal` says which."""
        try:
            return {name: function.interpreted for name, function in self.functions.items()}
        except NoPlainForm as error:
            self.refusal = tr(
                "{program} cannot be interpreted: {reason}", program=tr(self.name), reason=str(error)
            )
            return None

    def rewrite_all(self) -> None:
        """Rewrite everything that it calls, too, before it is called."""
        if self.rewritten is not None:
            kernels = self._source_and_kernels[1].values()
            rewrite(f for f in reached_from(kernels) if isinstance(f, Kernel))

    def begin(self, elements: int) -> None:
        """Choose the form for a model of so many elements: one of many would not get far interpreted."""
        if Choice.compile is Compile.SOON and (elements > LARGE or (elements > SMALL and self.is_compiled())):
            self.load_or_tell()

    def expect(self, work: int) -> None:
        """Choose the form for a single call of so many counted operations: a long one is not begun interpreted."""
        if Choice.compile is not Compile.SOON or work <= LONGEST_WORK or self._patience == math.inf:
            return
        seconds = work * LONGEST_CALL / LONGEST_WORK
        if not self._compiled and (self.is_compiled() or seconds > self.expected_seconds()):
            self.load_or_tell()

    def load_or_tell(self) -> None:
        """Go on with machine code, or else interpreted, and tell why. Raises ProgramError of kernels that others wrote."""
        try:
            self.load()
        except Exception as error:  # numba raises many kinds
            if self.others and isinstance(error, ProgramError):
                raise
            self._patience = math.inf
            cache.tell(
                tr(
                    "{program} cannot be got ready, so it runs in its slow form ({error}).",
                    program=begun(tr(self.name)),
                    error=str(error),
                )
            )

    @property
    def is_loaded(self) -> bool:
        """True if machine code runs."""
        return self._compiled

    def _begin_interpreted(self) -> None:
        """Use the interpreted form; where a kernel has none, machine code."""
        interpreted = self.rewritten
        if interpreted is None:
            if Choice.compile is Compile.NEVER:
                raise NoPlainForm(self.refusal)
            self.load()
            return

        def timed(function: Callable[..., Any]) -> Callable[..., Any]:
            def called(*given: Any) -> Any:
                # What other processes take tells nothing of the program, nor does what is done once.
                began = time.thread_time() - Rewriting.seconds
                try:
                    return function(*given)
                finally:
                    self._last = time.thread_time() - Rewriting.seconds - began
                    self.spent += self._last
                    Choice.spent += self._last

            return called

        self._patience = _LOADING
        _interpreted.append(self)
        functions = {name: timed(function) for name, function in interpreted.items()}
        self._form = self._form_of(functions, is_machine=False)

    def _form_of(self, functions: dict[str, Callable[..., Any]], *, is_machine: bool) -> SimpleNamespace:
        """A form of the functions, which end the process where a kernel that others wrote never returns."""
        if self.others:
            functions = {name: ending(function, self.others) for name, function in functions.items()}
        return SimpleNamespace(is_machine=is_machine, **functions)

    def did(self, work: int) -> None:
        """Note how much the last call did, interpreted, so that the next one takes about LONGEST_CALL."""
        share = LONGEST_CALL / max(self._last, 1e-6)
        self.portion = max(int(work * min(share, 8.0)), 1)

    def _lose_patience(self) -> None:
        """Load the compiled form, or compile it, if that is worth it by now."""
        if Choice.compile is not Compile.SOON:
            self._patience = math.inf
            return
        self._patience = 0.0 if self.is_compiled() else self.expected_seconds()
        if self.spent > self._patience:
            self.load_or_tell()

    def is_compiled(self) -> bool:
        """True if another process, or an earlier one, has compiled all of it."""
        there = self._compiled or self._kept.exists()
        return there and all(module.is_compiled() for module in self._needs)

    def expected_seconds(self) -> float:
        """How long compiling it will take, about."""
        own = 0.0 if self._kept.exists() else _SECONDS_PER_BYTE * self._size
        return own + sum(module.expected_seconds() for module in self._needs if not module.is_loaded)

    @cached_property
    def _size(self) -> int:
        """Bytes of the interpreter's code of all that is compiled."""
        reached = reached_from([*self.functions.values(), *self._source_and_kernels[1].values()])
        return sum(len(plain_function(f).__code__.co_code) for f in reached if not isinstance(f, type))

    def load(self) -> Any:
        """Go on with machine code from now on: compiled first if nobody has."""
        with _loading:
            for module in self._needs:
                module.load()
            if not self.load_kept():
                self._compile()
        return self._form

    def load_kept(self) -> bool:
        """Go on with machine code if another process, or an earlier one, has kept it; False if it has not.

        It calls nothing, so that a thread can load what another one interprets meanwhile.
        """
        with _loading:
            if self._compiled:
                return True
            if not self.is_compiled() or not all(module.load_kept() for module in self._needs):
                return False
            kept = cache.read(self._kept.name)
            if kept is None:  # damaged: it is compiled anew
                return False
            from pinjoint.systems.program.machine_code import compile_for

            for name, function in (machine := self._machine()).items():
                compile_for(function, kept, name)
            self._form, self._compiled = self._form_of(machine, is_machine=True), True
            Choice.changes += 1
            with contextlib.suppress(OSError):
                os.utime(self._kept)  # it was used
            return True

    def _machine(self) -> dict[str, Callable[..., Any]]:
        """The functions, to be compiled when they are called."""
        from pinjoint.systems.program.machine_code import adopt, machine_code

        adopt(self.module, self.key, reached_from(self._source_and_kernels[1].values()))
        return {name: machine_code(f) for name, f in self.functions.items()}

    def _compile(self) -> None:
        """Compile by calling everything, and keep that."""
        from pinjoint.systems.program.machine_code import types_of

        before, machine = self._form, self._machine()
        self._form, self._compiled = self._form_of(machine, is_machine=True), True
        Choice.changes += 1
        try:
            self.warm_up()
        except BaseException:
            self._form, self._compiled = before, False
            raise
        cache.write(self._kept.name, pickle.dumps(types_of(machine)))


def interpreted_here() -> list[GeneratedModule]:
    """What began interpreted in this process and has no machine code yet, the costliest first."""
    _interpreted[:] = (module for module in _interpreted if not module.is_loaded)
    return sorted(_interpreted, key=lambda module: -module.spent)


_loading = threading.RLock()
_interpreted: list[GeneratedModule] = []
_modules: dict[Any, GeneratedModule] = {}  # by source and kernels


def generated(
    name: str, source: str, kernels: Mapping[str, Callable[..., Any]], needs: tuple[GeneratedModule, ...] = ()
) -> GeneratedModule:
    """The module with this source, the same one each time. needs: as of GeneratedModule."""
    called = ((name, id(kernel)) for name, kernel in sorted(kernels.items()))
    return _modules.setdefault((source, *called), GeneratedModule(name, lambda: (source, kernels), needs=needs))


def entries_to(kernels: Mapping[str, Callable[..., Any]]) -> tuple[str, dict[str, Callable[..., Any]]]:
    """Source of a module with an entry to each kernel, under the given names, and the kernels as the source calls them."""
    lines = [
        '"""Entries to kernels. Generated; safe to delete."""',
        "from pinjoint.systems.program.kernel import kept",
        "entry = kept(_nrt=False)",
    ]
    for name, kernel in kernels.items():
        arguments = ", ".join(inspect.signature(plain_function(kernel)).parameters)
        lines += ["", "", "@entry", f"def {name}({arguments}):", f"    return kernel_{name}({arguments})"]
    return "\n".join([*lines, ""]), {f"kernel_{name}": kernel for name, kernel in kernels.items()}


# --- calls that do not end ---------------------------------------------------------------------------
#
# Nothing can stop machine code but the end of the process. A run of a mod with a loop that does not end hung in silence,
# and heard no Ctrl+C.


def ending(function: Callable[..., Any], kernels: Iterable[Callable[..., Any]]) -> Callable[..., Any]:
    """A function that calls one of these kernels, and ends the process if it does not return."""

    def called(*given: Any) -> Any:
        ended = threading.Event()
        threading.Thread(target=_end, args=(ended, Choice.patience, kernels), daemon=True).start()
        try:
            return function(*given)
        finally:
            ended.set()

    return called


def _end(ended: threading.Event, seconds: float, kernels: Iterable[Callable[..., Any]]) -> None:
    for _ in range(30):  # a compiler at work is waited for in between: it takes long where a machine is busy
        compiler = sys.modules.get("numba.core.compiler_lock")
        with compiler.global_compiler_lock if compiler is not None else contextlib.nullcontext():
            pass
        if ended.wait(seconds / 30.0):
            return
    codes = [plain_function(kernel).__code__ for kernel in kernels]
    places = ", ".join(f"{code.co_name} ({code.co_filename}, {code.co_firstlineno})" for code in codes)
    said = tr(
        "A step has not ended for {seconds:g} s. It calls kernels of mods: {kernels}. Mend the loop that does not end,"
        " or run without the mod.",
        seconds=seconds,
        kernels=places,
    )
    print(f"pinjoint: {said}", file=sys.stderr, flush=True)
    os._exit(1)


# --- on disk ---------------------------------------------------------------------------------------


def forget_unused() -> None:
    """Delete modules unused for two months, mostly of former versions, and what killed processes left."""
    folder, now = cache.folder(), time.time()
    for path in (
        path for kind in ("types", "plain", "tmp") for path in folder.glob(f"pinjoint_program_*.{kind}")
    ):
        with contextlib.suppress(OSError):
            if now - path.stat().st_mtime > 60 * 86400.0:
                for old in (*folder.glob(f"__pycache__/{path.stem}.*"), *folder.glob(f"{path.stem}.*")):
                    old.unlink(missing_ok=True)
