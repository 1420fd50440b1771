"""Chronicle: what happened in the run of a document, when, and at which load, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.field import ENDS, Column, Role
from pinjoint.components.language import joined, marked, plural, tr
from pinjoint.components.latest import Latest
from pinjoint.components.load import load_factor
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.obstacles import obstacles
from pinjoint.components.rod import can_hinge, can_yield, has_cables, has_struts
from pinjoint.systems.base import StopReason
from pinjoint.systems.run.simulation import Simulation

_COLLAPSED = 4.0  # plastic strain over that of first yield, beyond which it is no overshoot if nothing resists
LARGEST = 100  # rods up to which stability is looked at: a fraction of a millisecond
MOST_NAMED = 3  # elements in a sentence
FIRST_IMPACTS, LOOKED_THROUGH = 3, 64  # instants of impacts that are told one by one, among so many impacts
TOLD, MOST_TOLD = 5.0, 2  # s for which a person is told of something, and of how much at a time


@dataclass(frozen=True)
class Happening:
    """Something that happened in a run.

    kind: "yield", "hinge", "collapse", "snap-through", "slack", "buckling", "impact", "impacts" (those that are only
    counted, as of the last), "rest", "diverged", or the name of an event of a mod.
    time: s. message: a sentence. elements: names of those concerned. load_factor: that of the loads then, if they share one.
    """

    kind: str
    time: float
    message: str
    elements: tuple[str, ...] = ()
    load_factor: float | None = None

    @property
    def when(self) -> str:
        """The time, and the share of the load unless that is all of it: "0.4345 s, 86.9 % of the load"."""
        if self.load_factor is None or self.load_factor == 1.0:
            return written.time(self.time)
        share = written.share(self.load_factor)
        return tr("{time}, {share} of the load", time=written.time(self.time), share=share)


class Chronicle:
    """What happened in a run so far, without what was taken back.

    Yielding, impacts, rest, divergence and events of mods are read from the state, which knows their instants. Cables
    that go slack, struts that buckle, collapses and snap-throughs are found by looking, in a window at every frame: they are
    dated to the look. newest: what was told first the last time.
    """

    def __init__(self, model: Model, simulation: Simulation) -> None:
        self._model, self._simulation = model, simulation
        self._seen: list[Happening] = []
        self._stands = Latest[bool]()  # whether the document is no mechanism
        # Names of slack cables, and of buckled struts, at the last look.
        self._given: dict[str, frozenset[str]] = {}
        self._looked = -1.0
        self._yielded, self._struck = Latest[list[Happening]](), Latest[tuple[list[Happening], int]]()
        self._known: set[Happening] = set()
        self.newest: list[Happening] = []
        self._telling: list[tuple[Happening, float]] = []

    @property
    def happenings(self) -> tuple[Happening, ...]:
        """All of the run, in order of time."""
        now = self._model.clock.time
        found = [*self._yields(), *self._hinges(), *self._events(), *self._impacts()]
        found += [seen for seen in self._seen if seen.time <= now]
        found.sort(key=lambda happening: happening.time)
        return (*found, *self._end())

    def look(self) -> None:
        """Note what can only be found by looking at the state as it is now."""
        model, now = self._model, self._model.clock.time
        if now < self._looked:  # time was taken back
            self._seen = [seen for seen in self._seen if seen.time <= now]
            self._given.clear()
        if now == self._looked or model.rods.count == 0:
            return
        self._looked = now
        rods = model.rods
        if has_cables(model):
            slack = rods.tension_only & (rods.axial_force <= 0.0)
            self._look_at("slack", slack, marked("Cable {name} goes slack."))
        if has_struts(model):
            self._look_at("buckling", rods.axial_force < -rods.buckling_load, marked("Strut {name} buckles."))
        if model.rods.count <= LARGEST:
            self._look_at_stability()

    def told(self, elapsed: float) -> str:
        """What happened lately, in sentences: each for TOLD seconds, of which so many passed since the last call."""
        now = self.happenings
        new = [one for one in now if one not in self._known and one.kind != "impacts"]
        self._known, self.newest = set(now), new
        left = [(happening, seconds - elapsed) for happening, seconds in self._telling if seconds > elapsed]
        self._telling = [pair for pair in left if pair[0] in self._known] + [(one, TOLD) for one in new]
        del self._telling[:-MOST_TOLD]
        return joined(tr("{when}: {message}", when=one.when, message=one.message) for one, _ in self._telling)

    # --- from the state ------------------------------------------------------------------------------

    def _yields(self) -> list[Happening]:
        """Rods that came to a strength, those of one instant together."""
        if not can_yield(self._model):
            return []
        at = self._model.rods.column("yielded_at")
        return self._yielded.get(at.tobytes(), lambda: self._yields_at(at))

    def _yields_at(self, at: Column) -> list[Happening]:
        names, found = self._model.rods.column("name"), []
        for time in np.unique(at[~np.isnan(at)]).tolist():
            some = tuple(names[at == time].tolist())
            said = plural("Rod {rods} yields.", "Rods {rods} yield.", len(some), rods=_listed(some))
            found.append(self._happening("yield", time, said, some))
        return found

    def _hinges(self) -> list[Happening]:
        """Particles at which plastic hinges first formed, those of one instant together."""
        first = {record["particle"]: record["time"] for record in reversed(hinge_records(self._model))}
        found: dict[float, list[str]] = {}
        for particle in reversed(first):
            found.setdefault(first[particle], []).append(particle)
        return [
            self._happening(
                "hinge", time, tr("A plastic hinge forms at {particles}.", particles=_listed(at)), tuple(at)
            )
            for time, at in found.items()
        ]

    def _events(self) -> list[Happening]:
        """Events that systems of mods declared."""
        found = []
        for event in self._simulation.events:
            some = event.fallen or event.risen
            what = event.event.rpartition(".")[2].replace("_", " ")
            message = f"{what[:1].upper()}{what[1:]}: {_listed(some)}."
            found.append(self._happening(event.event, event.time, message, some))
        return found

    def _impacts(self) -> list[Happening]:
        """The first impacts one by one, those of one instant together; how many came after them."""
        impacts, count = self._simulation.impacts, self._model.clock.collisions
        if count == 0:
            return []
        time = impacts.time
        known = LOOKED_THROUGH if len(time) == count else 0  # of more than are kept, the first are not known
        first = time[:known]
        told, shown = self._struck.get(first.tobytes(), lambda: self._collisions(first))
        if shown == count:
            return told
        last = float(time[-1]) if len(time) else self._model.clock.time
        if shown:
            further = plural("One more impact.", "{count} more impacts.", count - shown)
        else:
            further = plural("One impact.", "{count} impacts.", count)
        return [*told, Happening("impacts", last, further)]

    def _collisions(self, time: Column) -> tuple[list[Happening], int]:
        """What is told of the first impacts, and of how many."""
        names = [*self._model.particles.names, *obstacles(self._model).names]
        impacts, found, shown = self._simulation.impacts, [], 0
        instant = np.cumsum(np.diff(time, prepend=time[:1]) > written.ROUNDING * time)
        for number in range(min(instant.max(initial=-1) + 1, FIRST_IMPACTS)):
            those = np.flatnonzero(instant == number)
            pairs = np.stack([impacts.first[those], impacts.second[those]], axis=1)
            shown += len(pairs)
            met = [
                tr("{first} and {second}", first=names[first], second=names[second])
                for first, second in pairs.tolist()
            ]
            some = tuple(names[row] for row in dict.fromkeys(pairs.ravel().tolist()))
            message = tr("Impact of {pairs}.", pairs=_listed(met))
            found.append(self._happening("impact", float(time[those[0]]), message, some))
        return found, shown

    def _end(self) -> list[Happening]:
        """How the run ended by itself, if it did."""
        simulation = self._simulation
        if not simulation.halted:
            return []
        if simulation.reason is StopReason.DIVERGED:
            said = tr("The run stops, because its numbers grow without limit.")
            return [self._happening("diverged", self._model.clock.time, said)]
        return [self._happening("rest", simulation.moved_until, tr("Everything comes to rest."))] * bool(
            self._model.clock.steps
        )

    def _happening(self, kind: str, time: float, message: str, some: tuple[str, ...] = ()) -> Happening:
        """What happened, with the load then."""
        return Happening(kind, time, message, some, load_factor(self._model, time))

    # --- by looking ----------------------------------------------------------------------------------

    def _see(self, kind: str, message: str, some: tuple[str, ...] = (), time: float | None = None) -> None:
        """Note something; each kind once for the same elements, since structures vibrate."""
        if not any((seen.kind, seen.elements) == (kind, some) for seen in self._seen):
            self._seen.append(self._happening(kind, self._looked if time is None else time, message, some))

    def _look_at(self, kind: str, given: NDArray[np.bool_], message: str) -> None:
        """Note the rods that have given way since the last look."""
        names = frozenset(self._model.rods.column("name")[given].tolist())
        for name in sorted(names - self._given.get(kind, names)):
            self._see(kind, tr(message, name=name), (name,))
        self._given[kind] = names

    def _look_at_stability(self) -> None:
        """A structure that is held no more collapses if rods yield on and on; else it snaps through."""
        from pinjoint.systems.statics.factor import is_held  # not at the start of the program

        model, rods = self._model, self._model.rods
        edited = model.newest(Role.DOCUMENT)
        stands = self._stands.get(edited, lambda: not incomputable(model) and is_held(model, at_first=True))
        if not (stands and model.clock.steps) or is_held(model):
            return
        yielding = np.flatnonzero(rods.yielding) if can_yield(model) else np.empty(0, dtype=np.intp)
        limit = np.minimum(rods.tension_limit, rods.compression_limit) / rods.stiffness
        worn = yielding[np.abs(rods.plastic_strain[yielding]) > _COLLAPSED * limit[yielding]]
        hinges = np.argwhere(rods.hinge_yielding) if can_hinge(model) else np.empty((0, 2), dtype=np.intp)
        turned = np.abs(rods.plastic_rotation) * rods.end_stiffness[:, ::2] > _COLLAPSED * rods.moment_limit
        if len(worn):  # what yields less may do so in an overshoot that ends before it matters
            names, at = tuple(rods.column("name")[worn].tolist()), rods.column("yielded_at")[worn].max()
            said = plural(
                "The structure collapses: rod {rods} yields, and nothing else resists.",
                "The structure collapses: rods {rods} yield, and nothing else resists.",
                len(names),
                rods=_listed(names),
            )
            self._see("collapse", said, time=float(at))
        elif len(hinges) and turned[*hinges.T].any():
            rows, ends = hinges.T
            at, where = rods.hinge_formed_at[rows, ends].max(), np.unique(rods.between[rows, ends])
            names = tuple(model.particles.column("name")[where].tolist())
            said = tr(
                "The structure collapses: plastic hinges turn at {particles}, and nothing else resists.",
                particles=_listed(names),
            )
            self._see("collapse", said, names, time=float(at))
        elif not (len(yielding) or len(hinges) or any(seen.kind == "collapse" for seen in self._seen)):
            self._see("snap-through", tr("The structure snaps through into another shape."))


def hinge_records(model: Model) -> list[dict[str, Any]]:
    """The plastic hinges that formed at ends of rods in this run, as JSON tells them, in order of time."""
    if not can_hinge(model):
        return []
    rods, names = model.rods, model.particles.names
    at = rods.hinge_formed_at
    order = np.argwhere(at >= 0.0)[np.argsort(at[at >= 0.0], kind="stable")]
    return [
        {
            "kind": "hinge",
            "time": float(at[row, end]),
            "particle": names[rods.between[row, end]],
            "rod": rods.names[row],
            "end": ENDS[end],
        }
        for row, end in order.tolist()
    ]


def _listed(names: Sequence[str]) -> str:
    """Names, of many the first and how many more."""
    if len(names) <= MOST_NAMED:
        return ", ".join(names)
    return tr("{names} and {count} more", names=", ".join(names[:MOST_NAMED]), count=len(names) - MOST_NAMED)
