"""Faults of kernels that others write: found before a program runs, and named, in whichever form it runs."""

from __future__ import annotations

import traceback
from collections.abc import Iterable
from typing import Any

from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.systems.base import Integrator, Mod
from pinjoint.systems.program.binding import PROVIDED, Bound, ProgramError
from pinjoint.systems.program.compiler import Choice, Compile
from pinjoint.systems.program.interpreter import NoPlainForm, plain_function, rewrite

_RESULTS = {  # how many numbers, and which
    "rods": (1, marked("one number, the axial force (kN)")),
    "particles": (2, marked("a pair, the force (fx, fy) in kN")),
    "pairs": (2, marked("a pair, the force (fx, fy) on the first particle in kN")),
    "potential": (1, marked("one number, the energy of two particles, or of the ends of a rod (kN·m)")),
    "ends": (2, marked("a pair, the moments on the ends (M_start, M_end) in kN·m")),
    "rotations": (1, marked("one number, the moment on a particle in kN·m")),
    "branch": (1, marked("one number, the branch that the rod is on")),
    "margin": (1, marked("one number, positive while the rod stays on its branch")),
    "loads": (1, marked("one number, the factor of the load")),
    "commit": (2, marked("a pair, the new value of the column and the energy dissipated (kN·m)")),
    "event of rods": (1, marked("one number, whose sign counts")),
    "event of particles": (1, marked("one number, whose sign counts")),
}


def blame_mod(error: ProgramError) -> bool:
    """Switch off the mod whose system cannot join the step program; False if the system is no mod's."""
    mod: Mod | None = error.system.mod if error.system is not None else None
    if mod is None:
        return False
    mod.switch_off(str(error), error)
    return True


def check_plain_forms(bound: Iterable[Bound]) -> None:
    """Raise ProgramError for the first kernel of others that has no source, where nothing may be compiled."""
    if Choice.compile is not Compile.NEVER:
        return
    for b in bound:
        try:
            rewrite([b.function])
        except NoPlainForm as reason:
            raise ProgramError(
                "The kernel of {system} cannot be interpreted: {reason}. PINJOINT_COMPILE=never forbids compiling it;"
                " leave that out.",
                b.system,
                system=b.system.name,
                reason=str(reason),
            ) from reason


def explain(
    bound: Iterable[Bound], integrator: Integrator, model: Model, error: Exception, *, compiled: bool
) -> ProgramError:
    """Why a program failed: the first kernel that fails by itself or returns something of a wrong type."""
    if isinstance(error, ProgramError):
        return error
    others = [b for b in bound if not b.is_ours]
    for b in bound:
        problem = problem_of(b, model) if compiled else _failure(b, error) if _lines(b, error) else ""
        if problem:
            return ProgramError(problem, b.system)
    if len(others) == 1 and integrator.mod is None:
        return ProgramError(_failure(others[0], error), others[0].system)
    name, brief = integrator.name, _brief(error)
    if compiled:
        message = tr("The step program of {integrator} does not compile: {error}", integrator=name, error=brief)
    else:
        message = tr(
            "The step program of {integrator} cannot be interpreted: {error}", integrator=name, error=brief
        )
    return ProgramError(message, integrator)


def _lines(b: Bound, error: Exception) -> list[int]:
    """The lines of a kernel in which an error was raised."""
    code = plain_function(b.function).__code__
    last = max((line for *_, line in code.co_lines() if line), default=0)
    frames = traceback.extract_tb(error.__traceback__)
    here = [f.lineno for f in frames if f.filename == code.co_filename and f.lineno]
    return [line for line in here if code.co_firstlineno <= line <= last]


def _failure(b: Bound, error: Exception) -> str:
    """An error that a kernel raised, as a sentence."""
    code = plain_function(b.function).__code__
    line = (_lines(b, error) or [code.co_firstlineno])[-1]
    return tr(
        "The kernel of {system} failed: {error} ({file}, line {line}).",
        system=b.system.name,
        error=f"{type(error).__name__}: {error}",
        file="/".join(code.co_filename.split("/")[-2:]),
        line=line,
    )


def problem_of(b: Bound, model: Model) -> str:
    """The fault of a kernel, compiled by itself, as a sentence; "" if there is none, or if nothing may be compiled."""
    if Choice.compile is Compile.NEVER:
        return ""
    try:
        made = _result_type(b, model)
    except Exception as failure:  # numba raises many kinds
        return tr(
            "The kernel of {system} does not compile: {error}", system=b.system.name, error=_brief(failure)
        )
    from numba import types

    count, wanted = _RESULTS[b.purpose]
    if b.purpose == "commit":  # of both ends of a rod one more
        table, _, name = b.system.writes[0].partition(".")
        count += len(model.tables[table].fields[name].shape)
    numbers = tuple(getattr(made, "types", (made,)))
    if len(numbers) != count or not all(isinstance(n, types.Number | types.Boolean) for n in numbers):
        return tr(
            "The kernel of {system} returns {made}; it must return {wanted}.",
            system=b.system.name,
            made=str(made),
            wanted=tr(wanted),
        )
    return ""


def _brief(failure: Exception) -> str:
    lines = [line.strip() for line in str(failure).splitlines() if line.strip()]
    return f"{'; '.join(lines[1:4] or lines).rstrip('.')}."


def _result_type(b: Bound, model: Model) -> Any:
    """The numba type that a kernel returns when it is compiled by itself."""
    from numba import types
    from numba.np.numpy_support import from_dtype

    from pinjoint.systems.program.machine_code import machine_code

    def type_of(parameter: str) -> Any:
        made: Any = types.float64  # of what Pinjoint provides
        shape: tuple[int, ...] = (2,) if parameter in ("apart", "drift") else ()
        if parameter not in PROVIDED:
            own = b.arrays.get(parameter)
            table, _, name = parameter.partition("_")
            column = model.tables[table].storage(name) if own is None else own
            made, shape = from_dtype(column.dtype), column.shape[1:]
            if b.each == "pairs" and (own is not None or not model.tables[table].kind.single):
                shape = (2, *shape)
        for width in reversed(shape):
            made = types.UniTuple(made, width)  # type: ignore[no-untyped-call]
        return made

    of_load = (types.float64, types.Array(types.float64, 1, "C", readonly=True), types.uint32)
    signature = of_load if b.each == "loads" else tuple(map(type_of, b.parameters))
    dispatcher = machine_code(b.function)
    dispatcher.compile(signature)
    return dispatcher.overloads[signature].signature.return_type
