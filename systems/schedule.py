"""Schedule: which systems run, in which order, for a scene and a model; and how long each takes.

>>> from pinjoint.systems.base import System
>>> class Idle(System):
...     name = "example.idle"
...     scenes = ("pause",)
>>> from pinjoint.components.model import Model
>>> Schedule([Idle()]).plan("simulation", Model()).left_out
{'example.idle': "not active in 'simulation', only in pause"}
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from graphlib import CycleError, TopologicalSorter
from typing import Any

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import tr
from pinjoint.components.mistake import Explained
from pinjoint.components.model import Model
from pinjoint.components.wording import remedy
from pinjoint.systems.base import Commit, Event, Integrator, Law, Phase, StepSystem, System


class ScheduleError(Explained, ValueError):
    """Systems that cannot be put in order; the message names them and says what to declare."""


@dataclass(frozen=True)
class Plan:
    """The systems that run in a scene with a model, in order, by phase; and why the others do not, by name."""

    scene: str
    phases: Mapping[Phase, tuple[System, ...]]
    left_out: Mapping[str, str]


class Schedule:
    """All registered systems, ordered within their phases.

    Order: `before` and `after`, ties by registration. Two systems of a phase of which one writes what the
    other touches must be ordered, directly or through others.

    wanted: by scene, names or patterns such as "physics.*" of systems that it activates although they do not
        name it. seconds: spent so far in each system, by name.
    """

    def __init__(self, systems: Iterable[System], wanted: Mapping[str, Sequence[str]] | None = None) -> None:
        self._systems = tuple(systems)
        self._wanted = wanted or {}
        self.seconds: dict[str, float] = defaultdict(float)
        self.call: Callable[[System, Any], None] = lambda system, frame: system.process(frame)
        self._check_names()
        self._replacing = self._find_replacing()
        self._ordered = {phase: self._order_phase(phase) for phase in Phase}
        of_frames = {p: [s for s in some if not isinstance(s, StepSystem)] for p, some in self._ordered.items()}
        self._of_frames = {
            (phase, headless): tuple(system for system in systems if system.headless or not headless)
            for phase, systems in of_frames.items()
            for headless in (False, True)
        }
        self._active: dict[tuple[System, str], bool] = {}

    def _check_names(self) -> None:
        names = [system.name for system in self._systems]
        for system in self._systems:
            if not system.name:
                raise ScheduleError(
                    "{system} has no name; give it one like 'mymod.wind'.", system=type(system).__name__
                )
            if names.count(system.name) > 1:
                raise ScheduleError(
                    "Two systems are called {name}; give one of them another name.", name=system.name
                )

    def _find_replacing(self) -> dict[System, tuple[System, ...]]:
        """By system: those that take its place where they act."""
        found: dict[System, list[System]] = {}
        for system in self._systems:
            for name in (system.replaces,) if isinstance(system.replaces, str) else system.replaces:
                others = [
                    s
                    for s in self._systems
                    if s is not system and (s.name == name or s.name.startswith(f"{name}."))
                ]
                if not others:
                    raise ScheduleError(
                        "{system} replaces '{name}', but there is no such system; {remedy}",
                        system=system.name,
                        name=name,
                        remedy=remedy(name, [s.name for s in self._systems]),
                    )
                for other in others:
                    found.setdefault(other, []).append(system)
        try:
            TopologicalSorter({s.name: [r.name for r in some] for s, some in found.items()}).prepare()
        except CycleError as error:
            chain = " → ".join(error.args[1])
            raise ScheduleError(
                "These systems replace each other: {chain}; remove one `replaces`.", chain=chain
            ) from None
        return {system: tuple(some) for system, some in found.items()}

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

    def _known(self, system: System, others: Sequence[str], phase_systems: Mapping[str, System]) -> list[str]:
        """The named systems that are in the same phase; absent ones are allowed, misplaced ones are not."""
        for other in others:
            elsewhere = [s for s in self._systems if s.name == other and other not in phase_systems]
            if elsewhere:
                raise ScheduleError(
                    "{system} names {other} in `before` or `after`, but that runs in another phase ({phase}). Remove it:"
                    " phases follow one another in a fixed order.",
                    system=system.name,
                    other=other,
                    phase=elsewhere[0].phase.value,
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
                "In phase {phase} these systems wait for each other: {chain}; remove one `before` or `after`.",
                phase=phase.value,
                chain=chain,
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
                if later in self._replacing.get(earlier, ()) or earlier in self._replacing.get(later, ()):
                    continue
                for column in _contested(earlier, later):
                    raise ScheduleError(
                        "{one} and {other} both use {column}, and at least one writes it, but nothing says which comes"
                        " first; declare before=('{other}',) or after=(…) on one.",
                        one=earlier.name,
                        other=later.name,
                        column=column,
                    )

    # --- plans -----------------------------------------------------------------------------------

    def is_active(self, system: System, scene: str) -> bool:
        """True if a system acts in a scene: it names the scene, or the scene names it."""
        known = self._active.get((system, scene))
        if known is None:
            known = system.scenes is None or EXTENSIONS.acts_in(scene, system.scenes)
            known = known or any(fnmatchcase(system.name, wanted) for wanted in self._wanted.get(scene, ()))
            self._active[system, scene] = known
        return known

    def acts(self, system: System, scene: str, model: Model) -> bool:
        """True if a system runs in a scene with a model: it is active and needed, and no other takes its place."""
        return self._is_wanted(system, scene, model) and self._replaced_by(system, scene, model) is None

    def _is_wanted(self, system: System, scene: str, model: Model) -> bool:
        return self.is_active(system, scene) and system.needs(model)

    def _replaced_by(self, system: System, scene: str, model: Model) -> System | None:
        """The system that takes the place of another one in a scene with a model."""
        replacing = self._replacing.get(system, ())
        return next((other for other in replacing if self._is_wanted(other, scene, model)), None)

    def _reason(self, system: System, scene: str, model: Model) -> str:
        """Why a system does not run in a scene with a model; "" if it does."""
        if not self.is_active(system, scene):
            return self.inactive(system, scene)
        if not system.needs(model):
            return tr(system.unneeded)
        other = self._replaced_by(system, scene, model)
        return tr("replaced by {system}", system=other.name) if other is not None else ""

    def inactive(self, system: System, scene: str) -> str:
        """The reason why a system is not active in a scene: where it is."""
        wanted = [other for other in self._wanted if self.is_active(system, other)]
        named = dict.fromkeys((*(system.scenes or ()), *wanted))
        if not named:
            return tr("not active in '{scene}', nor in any other scene", scene=scene)
        return tr("not active in '{scene}', only in {scenes}", scene=scene, scenes=", ".join(named))

    def plan(self, scene: str, model: Model) -> Plan:
        """Which systems run in a scene with a model, and why the others do not."""
        reasons = {system.name: self._reason(system, scene, model) for system in self._systems}
        phases = {
            phase: tuple(system for system in ordered if not reasons[system.name])
            for phase, ordered in self._ordered.items()
        }
        return Plan(scene, phases, {name: reason for name, reason in reasons.items() if reason})

    def step_plan(self, scene: str, model: Model) -> list[StepSystem]:
        """The step systems, integrators apart, that act in a scene and that the model needs, in order."""
        return [
            system
            for system in self._ordered[Phase.STEP]
            if isinstance(system, StepSystem)
            and not isinstance(system, Integrator)
            and self.acts(system, scene, model)
        ]

    def named(self, names: Iterable[str]) -> list[StepSystem]:
        """The step systems with these names, in order. Raises KeyError if one is not there."""
        by_name = {s.name: s for s in self._ordered[Phase.STEP] if isinstance(s, StepSystem)}
        wanted = {by_name[name] for name in names}
        return [system for system in by_name.values() if system in wanted]

    # --- running ---------------------------------------------------------------------------------

    def runs_headless(self, phase: Phase, scene: str, model: Model) -> bool:
        """True if systems of a phase run in a scene where there are no frames."""
        return any(self.acts(system, scene, model) for system in self._of_frames[phase, True])

    def run(self, phase: Phase, frame: Any, *, headless: bool = False) -> None:
        """Run one phase of a frame, timing each system; each is asked for when its turn comes.

        frame: has the active `scene` and the open `model`, which systems may change on the way.
        headless: only systems that also run where there are no frames.
        """
        for system in self._of_frames[phase, headless]:
            if self.acts(system, frame.scene, frame.model):
                frame.model.activate()
                started = time.perf_counter()
                self.call(system, frame)
                self.seconds[system.name] += time.perf_counter() - started


def _role(system: System) -> type:
    """The role of a step system, since the step program itself keeps roles apart; System for all others."""
    return next((role for role in (Law, Commit, Event, Integrator) if isinstance(system, role)), System)


def _contested(one: System, other: System) -> list[str]:
    touched = set(one.reads) | set(one.writes) | set(one.adds)
    also = set(other.reads) | set(other.writes) | set(other.adds)
    written = (set(one.writes) & also) | (set(other.writes) & touched)
    mixed = (set(one.adds) & set(other.reads)) | (set(other.adds) & set(one.reads))
    return sorted(written | mixed)
