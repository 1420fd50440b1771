"""Culprits: finding and switching off the mod that broke a step program or its numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pinjoint.components.field import Column
from pinjoint.components.language import listed, tr
from pinjoint.components.model import Model
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.base import REVIEW_INTERVAL, Mod, StepSystem
from pinjoint.systems.interpreter import plain_function
from pinjoint.systems.program.binding import ROWS_OF, ProgramError, bind
from pinjoint.systems.program.near_pairs import pairs_within
from pinjoint.systems.program.program import MOTION, TURNING, Program
from pinjoint.systems.program.reference_laws import in_turn


def blame_mod(error: ProgramError) -> bool:
    """Switch off the mod whose system cannot join the step program; False if the system is no mod's."""
    mod: Mod | None = error.system.mod if error.system is not None else None
    if mod is None:
        return False
    if not mod.off:
        mod.switch_off(str(error), error)
    return True


def find_culprit(program: Program, safe: Snapshot) -> Mod | None:
    """Switch off the mod whose kernel was the first to return a number not finite after a safe state; None if none was.

    The steps are taken again one by one. Then the kernels are called one after the other, row by row, in the state
    before the first bad step and in the state after it.
    """
    model = program.model
    if not any(system.mod for system in program.systems):
        return None
    if program.failure is not None and blame_mod(program.failure):
        system = program.failure.system
        return system.mod if system is not None else None
    if _finite(model):  # an integrator that controls its steps leaves a state before the bad step
        good = Snapshot.take(model)
        _move_ahead(model)
    else:
        good = _last_good(program, safe)
    led_to = {name: model.column(name).copy() for name in (*MOTION, *TURNING, "clock.time")}
    good.restore(model)
    try:
        found = _bad_kernel(program, model, led_to)
    except ProgramError as error:  # which a kernel raised
        return error.system.mod if error.system is not None and blame_mod(error) else None
    if found is None:
        return None
    system, element, value = found
    mod = system.mod
    if mod is None:
        return None
    code = plain_function(bind(system, model).function).__code__
    mod.switch_off(
        tr(
            "{system} gave {value} for {element}, which is not finite ({file}, line {line}).",
            system=system.name,
            value=str(value),
            element=element,
            file="/".join(code.co_filename.split("/")[-2:]),
            line=code.co_firstlineno,
        )
    )
    return mod


def _finite(model: Model) -> bool:
    return all(bool(np.isfinite(model.column(name)).all()) for name in (*MOTION, *TURNING))


def _move_ahead(model: Model) -> None:
    """Take one step at constant velocity: to about the state that was refused."""
    step = model.clock.step_size
    model.writable("particles.displacement")[...] += step * model.particles.velocity
    model.writable("clock.time")[0] += step


def _last_good(program: Program, safe: Snapshot) -> Snapshot:
    """The state before the first step to a state that is not finite; the model is left in the latter."""
    model = program.model
    safe.restore(model)
    before = safe
    for _ in range(REVIEW_INTERVAL):
        before = Snapshot.take(model)
        program.advance(1)
        if not _finite(model):
            break
    return before


def _bad_kernel(
    program: Program, model: Model, led_to: Mapping[str, Column]
) -> tuple[StepSystem, str, float] | None:
    """The first system with a result that is not finite, now or in the state this led to, the element, the result."""
    for columns in ({}, led_to):
        for name, values in columns.items():  # where these are finite
            model.writable(name)[...] = np.where(np.isfinite(values), values, model.column(name))
        for system, given in in_turn(program.systems, model):
            for row, column in np.argwhere(~np.isfinite(given))[:1].tolist():
                return system, _element(system, model, row), float(given[row, column])
    return None


def _element(system: StepSystem, model: Model, row: int) -> str:
    each = getattr(system, "each", "rods")
    if each == "pairs":
        pair = pairs_within(model, bind(system, model).cutoff)[row].tolist()
        return listed([model.describe(model.particles[particle]) for particle in pair])
    each = ROWS_OF.get(each, each)
    return (
        model.describe(model.tables[each][row]) if row < model.tables[each].count else tr("row {row}", row=row)
    )
