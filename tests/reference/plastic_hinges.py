"""Frames with plastic hinges by first-order theory, from event to event, slow and obvious.

Between events a frame is linear: ends that flow are hinges in `frame_theory`, and bars that yield bear a constant force. At
an event choices are tried of those at their strengths, those first that differ least from what flowed before or from
nothing, so that of ends at one joint one flows unless all must. Only the load is scaled; what else acts (warmth, lack of
fit, settled supports) is there from the beginning.
"""

from dataclasses import dataclass, field
from itertools import chain, combinations
from typing import Any

import numpy as np

from tests.reference import frame_theory

Document = dict[str, Any]
AT_LIMIT = 1e-10  # of a strength
AT_ONCE = 3  # so many begin to flow at most, or cease to while others go on
SINGULAR = 1e12  # condition number, of a scaled matrix
NONE = 1e-8  # of the largest rate: a smaller one is round-off
LOADS = ("force", "moment", "distributed_force", "more_at_end")
MOVES = ("displacement", "rotation")


@dataclass
class Frame:
    """A frame on its way. moment: bending moments of the rods' ends in the program's signs, (rods, 2); force: (rods,).

    rotation: plastic, of the ends (rods, 2), counter-clockwise; stretch: plastic elongation of the rods (m). hinges, yields:
    (load factor, name of the particle), (load factor, name of the rod), in the order in which they form.
    """

    document: Document
    factor: float = field(init=False, default=0.0)
    hinges: list[tuple[float, str]] = field(init=False, default_factory=list)
    yields: list[tuple[float, str]] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        rods = self.document["rods"]
        unlimited = {"plastic_moment": np.inf, "tensile_strength": np.inf, "compressive_strength": np.inf}
        strengths = [{key: rod.get(key) or top for key, top in unlimited.items()} for rod in rods]
        self.high = np.array([[s["tensile_strength"], *[s["plastic_moment"]] * 2] for s in strengths])
        self.low = -np.array([[s["compressive_strength"], *[s["plastic_moment"]] * 2] for s in strengths])
        at_first = frame_theory.solve(self._with({}, loads=False))
        self.effort, self.flow = self._efforts(at_first), np.zeros_like(self.high)
        self.displacement = np.array(list(at_first.displacement.values()))
        self.flowing: set[tuple[int, int]] = set()
        self.mechanism = False

    @property
    def moment(self) -> np.ndarray:
        """Bending moments, (rods, 2)."""
        return self.effort[:, 1:] * [-1.0, 1.0]

    def _efforts(self, found: frame_theory.Found) -> np.ndarray:
        """Axial forces and counter-clockwise moments on the ends, (rods, 3)."""
        rods = [rod["name"] for rod in self.document["rods"]]
        axial = [found.end_axial_force[name].mean() for name in rods]
        return np.column_stack([axial, [found.bending_moment[name] * [-1.0, 1.0] for name in rods]])

    def _with(self, flowing: dict[int, set[int]], *, loads: bool) -> Document:
        """The document with hinges where ends flow and no axial stiffness where rods yield, of loads or of all else."""
        particles = [
            {key: value for key, value in facts.items() if key not in (MOVES if loads else LOADS)}
            for facts in self.document["particles"]
        ]
        rods = []
        for row, rod in enumerate(self.document["rods"]):
            left_out = ("temperature_change", "temperature_gradient", "rest_length") if loads else LOADS
            facts = {key: value for key, value in rod.items() if key not in left_out}
            soft = flowing.get(row, set())
            hinged = [rod.get("hinged", (False, False))[end] or end + 1 in soft for end in (0, 1)]
            springs = [rod.get("end_springs", (0.0, 0.0))[end] * (end + 1 not in soft) for end in (0, 1)]
            facts |= {"hinged": hinged, "end_springs": springs}
            if 0 in soft:
                facts["stiffness"] = 0.0
            rods.append(facts)
        return {**self.document, "particles": particles, "rods": rods}

    def _rates(self, sense: float) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Rates of the efforts, flows and displacements by the load factor; None where nothing is in equilibrium."""
        side = (self.effort >= self.high * (1.0 - AT_LIMIT)) * 1.0 - (
            self.effort <= self.low * (1.0 - AT_LIMIT)
        )
        limited = [(int(row), int(part)) for row, part in np.argwhere(side)]
        kept: tuple[set[tuple[int, int]], ...] = (self.flowing & set(limited), set())
        changes = chain.from_iterable(combinations(limited, count) for count in range(AT_ONCE + 1))
        for chosen in (before.symmetric_difference(change) for change in changes for before in kept):
            by_rod: dict[int, set[int]] = {}
            for row, part in chosen:
                by_rod.setdefault(row, set()).add(part)
            document = self._with(by_rod, loads=True)
            if self._is_singular(document):
                continue
            found = frame_theory.solve(document)
            effort = sense * self._efforts(found)
            flow = np.zeros_like(effort)
            for row, rod in enumerate(document["rods"]):
                first, last = rod["between"]
                turned = [found.rotation[first], found.rotation[last]] - found.end_rotation[rod["name"]]
                at = {facts["name"]: np.array(facts["position"]) for facts in document["particles"]}
                along = (at[last] - at[first]) / np.hypot(*(at[last] - at[first]))
                stretch = along @ (found.displacement[last] - found.displacement[first])
                for part in by_rod.get(row, ()):
                    flow[row, part] = sense * (stretch if part == 0 else turned[part - 1])
                    effort[row, part] = 0.0
            flows = np.isin(np.arange(side.size), [3 * row + part for row, part in chosen]).reshape(side.shape)
            small_flow, small_effort = NONE * np.abs(flow).max(), NONE * np.abs(effort).max()
            if (side * flow >= -small_flow)[flows].all() and (side * effort <= small_effort)[~flows].all():
                self.flowing = set(chosen)
                return effort, flow, sense * np.array(list(found.displacement.values()))
        return None

    def _tell(self, before: set[tuple[int, int]]) -> None:
        """Note what begins to flow, a joint once though another end of it goes on for the first."""
        rods = self.document["rods"]

        def joints(of: set[tuple[int, int]]) -> set[str]:
            return {rods[row]["between"][part - 1] for row, part in of if part}

        for row, part in sorted(self.flowing - before):
            if part == 0:
                self.yields.append((self.factor, rods[row]["name"]))
        for name in sorted(joints(self.flowing - before) - joints(before - self.flowing)):
            self.hinges.append((self.factor, name))

    def to(self, factor: float) -> bool:
        """Go to a load factor; False if the frame collapses on the way."""
        sense = np.sign(factor - self.factor)
        while self.factor != factor:
            before = set(self.flowing)
            found = self._rates(float(sense))
            if found is None:
                return False
            self._tell(before)
            effort, flow, moved = found
            with np.errstate(divide="ignore", invalid="ignore"):
                room = np.where(effort > 0.0, self.high - self.effort, self.low - self.effort)
                wait = np.where(np.abs(effort) > 1e-13 * np.abs(effort).max(), room / effort, np.inf)
            wait[np.abs(room) <= AT_LIMIT * np.where(np.isfinite(self.high), self.high, 1.0)] = np.inf
            step = min(float(wait.min()), abs(factor - self.factor))
            self.effort = self.effort + step * effort
            self.flow = self.flow + step * flow
            self.displacement = self.displacement + step * moved
            self.factor = factor if step == abs(factor - self.factor) else float(self.factor + sense * step)
        return True

    def _is_singular(self, document: Document) -> bool:
        """True if nothing resists some motion, of unknowns scaled by the elastic frame's own stiffness."""
        whole, _, held, still, _ = frame_theory.assembled(self._with({}, loads=True))
        matrix, _, _, spinning, _ = frame_theory.assembled(document)
        if (spinning & ~still & ~held).any():  # a joint all ends at which flow
            return True
        free = ~held & ~still
        own = np.sqrt(np.diag(whole)[free])
        return bool(np.linalg.cond(matrix[np.ix_(free, free)] / own[:, None] / own) > SINGULAR)
