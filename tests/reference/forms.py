"""Choosing the form that programs run in, for one part of a test."""

from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.systems.collision.driven.neighbours import DRIVEN
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES
from pinjoint.systems.program import compiler
from pinjoint.systems.program.compiler import Choice, Compile, GeneratedModule

OF_ANY_MODEL = EVENTS, HORIZONS, PILES, DRIVEN
_STATE = "_form", "_compiled", "_patience", "spent"


@contextmanager
def programs(choice: Compile) -> Iterator[None]:
    """Inside the `with` programs are made anew, in the form of this choice."""
    chosen, made = Choice.compile, dict(compiler._modules)
    kept = [{name: getattr(module, name) for name in _STATE} for module in OF_ANY_MODEL]
    Choice.compile = choice
    compiler._modules.clear()
    for module in OF_ANY_MODEL:
        module._form, module._compiled, module.spent = None, False, 0.0
    try:
        yield
    finally:
        Choice.compile = chosen
        compiler._modules.clear()
        compiler._modules.update(made)
        for module, state in zip(OF_ANY_MODEL, kept, strict=True):
            vars(module).update(state)


def load_all() -> None:
    """Let everything that runs now go on with machine code."""
    for module in all_modules():
        if module._form is not None:
            module.load()


def all_modules() -> list[GeneratedModule]:
    """The modules that models run with, besides the drawing."""
    return [*compiler._modules.values(), *OF_ANY_MODEL]
