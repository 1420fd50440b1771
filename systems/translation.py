"""How numba translates a kernel to LLVM code, in half of the time.

numba asks for the types of each operation anew, and writes sixty instructions for an element of an array, of which
the optimiser leaves three. Here answers are kept, and elements, shapes, tuples and arguments are translated without
detours. The same operations remain, so that the optimiser ends with the same code.

This uses inner classes of numba.
"""

# mypy: allow-untyped-calls

from __future__ import annotations

from collections import Counter
from typing import Any

from numba.core.cgutils import ir as llvm  # type: ignore[attr-defined]
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.ir import Assign
from numba.core.lowering import Lower
from numba.core.registry import cpu_target
from numba.core.typed_passes import InlineOverloads, NativeLowering, NopythonRewrites
from numba.core.types import Array, BaseTuple, Boolean, Function, Integer, IntEnumMember, Number, intp, uintp
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
# inlined before their types are known, loops over tuples of different types, expressions of whole arrays.
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

DATA, SHAPE = 4, 5  # places in what numba knows of an array


# --- types ---------------------------------------------------------------------------------------


class Typing(Context):
    """numba's context of types, with a memory of what functions return.

    For every `a + b` numba asks a dozen candidates, and again as it translates it. A large program has some six thousand
    such operations, of which a few hundred differ in types.
    """

    def __init__(self, known: Context) -> None:
        self.__dict__ = known.__dict__

    def resolve_value_type(self, value: Any) -> Any:
        """The type of a constant or a function."""
        return _remembering(super().resolve_value_type(value))

    def _lookup_global(self, value: Any) -> Any:
        return _remembering(super()._lookup_global(value))


def _remembering(known: Any) -> Any:
    """Have a function of numba remember its signature for arguments of the same types, as far as `Typing` asks."""
    if isinstance(known, Function) and "get_call_type" not in vars(known):
        ask, found = known.get_call_type, dict[Any, Any]()

        def remembered(context: Any, given: Any, named: Any) -> Any:
            if named or not isinstance(context, Typing):
                return ask(context, given, named)
            key = tuple(given)
            if key not in found:
                found[key] = ask(context, given, named)
            return found[key]

        vars(known)["get_call_type"] = remembered
    return known


# --- LLVM code -----------------------------------------------------------------------------------


class _Builder(llvm.IRBuilder):  # type: ignore[misc]
    """Writes LLVM code; to take from a tuple or an array's header what was put there needs no instruction."""

    def extract_value(self, agg: Any, idx: Any, name: str = "") -> Any:
        """A member of a tuple."""
        path = [idx] if isinstance(idx, int) else list(idx)
        while path and isinstance(agg, llvm.instructions.InsertValue):
            put = list(agg.indices)
            if path[: len(put)] == put:
                agg, path = agg.value, path[len(put) :]
            elif put[: len(path)] == path:
                break
            else:
                agg = agg.aggregate
        return super().extract_value(agg, path, name) if path else agg


class _Lowering(Lower):
    """numba's translation of one function."""

    def init(self) -> None:
        """Find the arguments that stay what they are: they need no place in memory."""
        super().init()
        assigned = (found.target.name for block in self.blocks.values() for found in block.find_insts(Assign))
        self._constant = set[str]()
        if not self.context.enable_nrt:  # else their owners are counted
            self._constant = {name for name, times in Counter(assigned).items() if times == 1}
        self._given: dict[str, Any] = {}

    def setup_function(self, fndesc: Any) -> None:
        """Begin the function."""
        super().setup_function(fndesc)
        self.builder.__class__ = _Builder

    def storevar(self, value: Any, name: str, argidx: int | None = None) -> None:
        """Let a variable have a value; argidx: which argument it is."""
        if argidx is not None and name in self._constant:
            self._given[name] = value
        else:
            super().storevar(value, name, argidx)

    def loadvar(self, name: str) -> Any:
        """The value of a variable."""
        return self._given[name] if name in self._given else super().loadvar(name)

    def delvar(self, name: str) -> None:
        """Let go of what a variable owns."""
        if self.context.enable_nrt:
            super().delvar(name)

    def lower_expr(self, resty: Any, expr: Any) -> Any:
        """The value of an expression."""
        if expr.op == "getattr" and expr.attr == "shape" and isinstance(self.typeof(expr.value.name), Array):
            return self.builder.extract_value(self.loadvar(expr.value.name), SHAPE)
        return super().lower_expr(resty, expr)

    def lower_getitem(self, resty: Any, expr: Any, value: Any, index: Any, signature: Any) -> Any:
        """The value of `value[index]`."""
        place = self._element(value, index)
        if place is None:
            return super().lower_getitem(resty, expr, value, index, signature)
        array: Any = self.typeof(value.name)
        found = self.context.unpack_value(self.builder, array.dtype, place, None if array.aligned else 1)
        return self.context.cast(self.builder, found, array.dtype, resty)

    def lower_setitem(self, target_var: Any, index_var: Any, value_var: Any, signature: Any) -> Any:
        """Let `target[index]` have a value."""
        place = self._element(target_var, index_var)
        if place is None:
            return super().lower_setitem(target_var, index_var, value_var, signature)
        array: Any = self.typeof(target_var.name)
        given = self.loadvar(value_var.name)
        value = self.context.cast(self.builder, given, self.typeof(value_var.name), array.dtype)
        return self.context.pack_value(self.builder, array.dtype, value, place, None if array.aligned else 1)

    def _element(self, array: Any, index: Any) -> Any:
        """The address of one number in an array in C order; None where something else is meant."""
        kind: Any = self.typeof(array.name)
        at: Any = self.typeof(index.name)
        along = [_integer(one) for one in getattr(at, "types", [at])]
        if not (
            isinstance(kind, Array)
            and kind.layout == "C"
            and isinstance(kind.dtype, Number | Boolean)
            and len(along) == kind.ndim > 0
            and all(along)
            and not self.context.enable_boundscheck
        ):
            return None
        write, header, given = self.builder, self.loadvar(array.name), self.loadvar(index.name)
        place = None
        for axis, integer in enumerate(along):
            length = write.extract_value(header, (SHAPE, axis))
            row = write.extract_value(given, axis) if isinstance(at, BaseTuple) else given
            row = self._counted(integer, row, length)
            place = row if place is None else write.add(write.mul(place, length), row)
        return write.gep(write.extract_value(header, DATA), [place])

    def _counted(self, integer: Any, row: Any, length: Any) -> Any:
        """A row that counts from the end if it is negative, as it counts from the beginning."""
        if isinstance(row, llvm.Constant) and row.type == length.type and row.constant >= 0:
            return row
        row = self.context.cast(self.builder, row, integer, intp if integer.signed else uintp)
        if not integer.signed:
            return row
        is_behind = self.builder.icmp_signed("<", row, row.type(0))
        return self.builder.select(is_behind, self.builder.add(row, length), row)


def _integer(kind: Any) -> Any:
    """The type of integers that an index is of, if it is one."""
    kind = kind.dtype if isinstance(kind, IntEnumMember) else kind
    return kind if isinstance(kind, Integer) else None


@register_pass(mutates_CFG=True, analysis_only=False)
class _NativeLowering(NativeLowering):
    _name = "native_lowering_of_kernels"

    @property
    def lowering_class(self) -> type[Lower]:
        return _Lowering


class LeanCompiler(Compiler):
    """numba's compiler with all that, and without the passes that kernels have no use for."""

    _typing = Typing(cpu_target.typing_context)

    def __init__(self, _: Any, *rest: Any) -> None:
        super().__init__(self._typing, *rest)
        self.state.targetctx.typing_context = self._typing

    def define_pipelines(self) -> list[PassManager]:
        """The usual passes, less the unused ones."""
        (usual,) = super().define_pipelines()
        lean = PassManager(usual.pipeline_name)
        for kind, purpose in usual.passes:
            if kind not in UNUSED:
                lean.add_pass(_NativeLowering if kind is NativeLowering else kind, purpose)
        lean.finalize()
        return [lean]
