"""Probing: what is wrong with a mod that loads, found without a run; `pinjoint mods check`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from components.spelling import missing
from game.checks import EVERYTHING
from game.documents import models
from game.editor.scenes import all_scenes
from game.registry import SYSTEMS
from systems.base import Commit, Law
from systems.catalogue import step_systems
from systems.input.bindings import BINDINGS
from systems.physics.integrators import INTEGRATORS
from systems.program.binding import ProgramError, bind, problem_of
from systems.program.writer import read_sources

if TYPE_CHECKING:
    from components.model import Model
    from game.mods.mod import Mod


def problems(mod: Mod) -> Iterator[str]:
    """Sentences about what no model could be run with, and keys that no scene listens to."""
    model = models.load(EVERYTHING)
    for system in [*step_systems(), *(make() for make in SYSTEMS)]:
        if system.mod is mod and isinstance(system, Law | Commit):
            yield from filter(None, [_problem_of(system, model)])
    for integrator in INTEGRATORS.values():
        if integrator.mod is mod:
            try:
                read_sources([integrator])
            except ProgramError as error:
                yield str(error)
    scenes = {scene.name for scene in all_scenes()}
    for binding in BINDINGS:
        if binding.action.startswith(f"{mod.name}."):
            for scene in set(binding.scenes) - scenes:
                yield f"The key '{binding.key}' for {binding.action}: {missing('scenes', scene, scenes)}"


def _problem_of(system: Law | Commit, model: Model) -> str:
    """What is wrong with its kernel, or ""."""
    try:
        return problem_of(bind(system, model), model)
    except ProgramError as error:
        return str(error)
