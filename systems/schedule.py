"""Schedule: which systems run, in which order, for a scene and a model; and how long each takes."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from graphlib import CycleError, TopologicalSorter
from typing import Any, TypeVar

from components.model import Model
from systems.base import Commit, Integrator, Law, Phase, StepSystem, System

S = TypeVar("S", bound=System)


class ScheduleError(ValueError):
    """Systems that cannot be put in order; the message names them and says what to declare."""


class Schedule:
    """All registered systems, ordered within their phases.

    Order: `before` and `after`, ties by registration. Two systems of a phase of which one writes what the
    other touches must be ordered, directly or through others.
    """

    def __init__(self, systems: Iterable[System]) -> None:
        self._systems = tuple(systems)
        self.seconds: dict[str, float] = defaultdict(float)
        self._check_names()
        self._ordered = {phase: self._order_phase(phase) for phase in Phase}

    def _check_names(self) -> None:
        names = [system.name for system in self._systems]
        for system in self._systems:
            if not system.name:
                raise ScheduleError(f"{type(system).__name__} has no name; give it one like 'mymod.wind'.")
            if names.count(system.name) > 1:
                raise ScheduleError(f"Two systems are called {system.name}; names must be unique.")

    # --- order -----------------------------------------------------------------------------------

    def _order_phase(self, phase: Phase) -> tuple[System, ...]:
        systems = [system for system in self._systems if system.phase is phase]
        by_name = {system.name: system for system in systems}
        predecessors: dict[str, set[str]] = {system.name: set() for system in systems}
        for system in systems:
            for earlier in self._known(system, system.after, by_name):
                predecessors[system.name].add(earlier)
            for later in self._known(system, system.before, by_name):
                predecessors[later].add(system.name)
        ordered = self._sorted(systems, predecessors, phase)
        self._check_conflicts(ordered, predecessors)
        return tuple(ordered)

    def _known(self, system: System, others: Sequence[str], phase_systems: dict[str, S]) -> list[str]:
        """The named systems that are in the same phase; absent ones are allowed, misplaced ones are not."""
        for other in others:
            elsewhere = [s for s in self._systems if s.name == other and other not in phase_systems]
            if elsewhere:
                raise ScheduleError(
                    f"{system.name} asks to be ordered with {other}, which runs in another phase"
                    f" ({elsewhere[0].phase.value}); phases are ordered already."
                )
        return [other for other in others if other in phase_systems]

    @staticmethod
    def _sorted(systems: list[System], predecessors: dict[str, set[str]], phase: Phase) -> list[System]:
        rank = {system.name: index for index, system in enumerate(systems)}
        by_name = {system.name: system for system in systems}
        sorter = TopologicalSorter(predecessors)
        try:
            sorter.prepare()
        except CycleError as error:
            chain = " → ".join(error.args[1])
            raise ScheduleError(
                f"In phase {phase.value} these systems wait for each other: {chain}; drop one before/after."
            ) from None
        ready: list[str] = list(sorter.get_ready())
        ordered: list[System] = []
        while ready:
            ready.sort(key=rank.__getitem__)
            name = ready.pop(0)
            ordered.append(by_name[name])
            sorter.done(name)
            ready.extend(sorter.get_ready())
        return ordered

    def _check_conflicts(self, ordered: list[System], predecessors: dict[str, set[str]]) -> None:
        ancestors: dict[str, set[str]] = {}
        for system in ordered:
            direct = predecessors[system.name]
            ancestors[system.name] = direct.union(*(ancestors[name] for name in direct))
        for index, later in enumerate(ordered):
            for earlier in ordered[:index]:
                if _role(earlier) is not _role(later) or earlier.name in ancestors[later.name]:
                    continue
                for column in _contested(earlier, later):
                    raise ScheduleError(
                        f"{earlier.name} and {later.name} both touch {column}, at least one writing, and nothing"
                        f" says which comes first; declare before=('{later.name}',) or after=(…) on one."
                    )

    # --- plans -----------------------------------------------------------------------------------

    def frame_plan(self, phase: Phase, scene: str, model: Model) -> list[System]:
        """The frame systems of a phase that a scene activates and a model needs."""
        return [
            system
            for system in self._ordered[phase]
            if not isinstance(system, StepSystem) and _active(system, scene) and system.needs(model)
        ]

    def step_plan(self, model: Model) -> list[StepSystem]:
        """Laws and commits that the model needs, in order."""
        return [
            system
            for system in self._ordered[Phase.STEP]
            if isinstance(system, StepSystem) and not isinstance(system, Integrator) and system.needs(model)
        ]

    def left_out_of_statics(self, model: Model) -> str:
        """The sentence that names the laws of mods that a model needs and statics does not know; "" if there are none."""
        laws = (law for law in self.step_plan(model) if isinstance(law, Law) and law.mod is not None)
        names = ", ".join(law.name for law in laws if law.each != "loads")
        return f"Settling leaves out the laws of mods: {names}." if names else ""

    def named(self, names: Iterable[str]) -> list[StepSystem]:
        """The step systems with these names, in order. Raises KeyError if one is not there."""
        by_name = {s.name: s for s in self._ordered[Phase.STEP] if isinstance(s, StepSystem)}
        wanted = {by_name[name] for name in names}
        return [system for system in by_name.values() if system in wanted]

    def run(self, phase: Phase, scene: str, model: Model, frame: Any) -> None:
        """Run one phase of a frame, timing each system."""
        for system in self.frame_plan(phase, scene, model):
            if system.asks_esper:
                model.activate()
            started = time.perf_counter()
            system.process(frame)
            self.seconds[system.name] += time.perf_counter() - started


def _role(system: System) -> type:
    """Laws, commits and integrators are kept apart by the step program itself."""
    return next((role for role in (Law, Commit, Integrator) if isinstance(system, role)), System)


def _contested(one: System, other: System) -> list[str]:
    touched = set(one.reads) | set(one.writes) | set(one.adds)
    also = set(other.reads) | set(other.writes) | set(other.adds)
    written = (set(one.writes) & also) | (set(other.writes) & touched)
    mixed = (set(one.adds) & set(other.reads)) | (set(other.adds) & set(one.reads))
    return sorted(written | mixed)


def _active(system: System, scene: str) -> bool:
    return system.scenes is None or scene in system.scenes
