"""Transients to nearly full precision: scipy's method of order 8 with a tight tolerance, from event to event.

Between events the motion is smooth: no rod reaches its strength or unloads, no cable slackens or tightens, no discs
meet, no load has a kink. An event is located first and then integrated up to, so that nothing is interpolated.
What was done and lost is integrated along. Slow; for some rods and some periods.

A cable (tension only) is slack where its elastic strain is negative. Its damper does nothing then, and takes from a
taut cable at most what leaves no compression.
"""

import math
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from tests.reference.elements import Elements, Model, read

TIGHT = 1e-13  # relative tolerance of one step
MOST_EVENTS = 2000
AT_STRENGTH = 1e-12  # of it, within which a force is at a strength
CHECKS = 8  # parts of a step at whose ends events are looked for
NOISE = 1e-14  # of a margin, which tells nothing
SHORTEST = 0.02  # m; a rod that shrinks to a point turns at once and magnifies round-off without limit
ELASTIC, TENSION, COMPRESSION, SLACK = 0, 1, -1, 2  # the branch of its law that a rod is on

Array = np.ndarray


class Untraceable(Exception):
    """A motion that this reference cannot follow."""


@dataclass(frozen=True)
class Motion:
    """The state at the end, energies in J and forces in kN; `largest`: of each quantity, anywhere on the way."""

    displacement: Array  # m, (particles, 2)
    velocity: Array  # m/s, (particles, 2)
    axial_force: Array  # kN, (rods,), without dampers
    plastic_strain: Array
    energy: dict[str, float]
    largest: dict[str, float]
    events: int
    impacts: int


def follow(model: Model, duration: float, tolerance: float = TIGHT) -> Motion:
    """The motion of a model for so many seconds. Raises Untraceable."""
    motion = _Transient(read(model), tolerance)
    elements, end = motion.elements, motion.time + duration
    kinks = {time for load in elements.loads for time in load.kinks() if motion.time < time < end}
    for stop in sorted(kinks | {end}):
        while motion.time < stop:
            motion.to_next_event(stop)
    return motion.result()


class _Transient:
    """A model in motion: y holds displacements, velocities, and the work and losses (J) so far, in one row."""

    def __init__(self, elements: Elements, tolerance: float) -> None:
        self.elements, self.time, self.tolerance = elements, elements.time, tolerance
        self.events = self.impacts = 0
        self.lost_in_impacts = 0.0
        self._read_particles()
        self._read_rods()
        count = 2 * len(elements.particles)
        displacement = np.array([p.displacement for p in elements.particles]).ravel()
        velocity = np.array([p.velocity for p in elements.particles]).ravel()
        self.y = np.concatenate([displacement, velocity, np.zeros(3)])
        self.parts = slice(0, count), slice(count, 2 * count), slice(2 * count, None)
        self._begin_branches()
        self.largest = dict.fromkeys(("displacement", "velocity", "axial_force", "energy"), 0.0)
        self.initial = sum(self.stored(self.y))
        self.floors = self._floors()
        self.watched = bool(len(self.pairs) or len(self.walls) or self.yields.any() or self.cable.any())
        self.note(self.y)

    def _read_particles(self) -> None:
        elements = self.elements
        particles = elements.particles
        self.place = np.array([p.position for p in particles])
        self.mass = np.array([p.mass for p in particles])[:, None]
        self.free = ~np.array([p.fixed for p in particles])
        self.mobility = np.where(self.free, 1000.0 / self.mass, 0.0)  # m/s² per kN
        weight = np.array([p.acceleration for p in particles]) + elements.environment_acceleration
        force = np.array([p.force for p in particles]) + elements.environment_force
        self.constant = force + self.mass * weight / 1000.0
        self.radius = np.array([p.radius for p in particles])
        joined = {frozenset((rod.start, rod.end)) for rod in elements.rods}
        movable = self.free.any(axis=1)
        pairs = [
            pair
            for pair in combinations(range(len(particles)), 2)
            if elements.collisions and movable[list(pair)].any() and frozenset(pair) not in joined
        ]
        self.pairs = np.array(pairs, dtype=int).reshape(-1, 2)
        walls = [(k, wall) for wall in elements.walls for k in np.flatnonzero(movable)]
        self.walls = walls if elements.collisions else []

    def _read_rods(self) -> None:
        rods, count = self.elements.rods, len(self.elements.particles)
        self.start = np.array([rod.start for rod in rods], dtype=int)
        self.end = np.array([rod.end for rod in rods], dtype=int)
        self.span = np.array([rod.span for rod in rods]).reshape(-1, 2)
        self.pulls = np.zeros((count, len(rods)))  # by a rod's tension on each particle along its axis
        self.pulls[self.start, np.arange(len(rods))] = 1.0
        self.pulls[self.end, np.arange(len(rods))] = -1.0
        columns = ("stiffness", "rest_length", "free_length", "damping", "plastic_strain", "tension_only")
        self.stiffness, self.rest_length, free_length, self.damping, plastic, cable = (
            np.array([getattr(rod, name) for rod in rods], dtype=float) for name in columns
        )
        self.original = np.hypot(*self.span.T)
        self.misfit = self.original - free_length
        self.plastic_strain, self.cable = plastic, cable > 0.0
        self.strength = {
            TENSION: np.array([rod.tensile_strength for rod in rods]),
            COMPRESSION: np.array([math.inf if rod.tension_only else rod.compressive_strength for rod in rods]),
        }
        self.yields = np.minimum(*self.strength.values()) < math.inf
        self.limp = np.zeros(len(rods), dtype=bool)  # taut cables whose damper takes all their force
        self.dampened_cables = self.cable & (self.damping > 0.0)

    def _begin_branches(self) -> None:
        """What begins beyond its strength has yielded; what is at it yields on if it moves outwards."""
        self.branch = np.zeros(len(self.stiffness), dtype=int)
        u, v = self.kinematics(self.y)
        _, elongation, rate = self.geometry(u, v)
        for side, strength in self.strength.items():
            strain = elongation / self.rest_length - self.plastic_strain
            beyond = side * self.stiffness * strain > strength
            self.plastic_strain[beyond] += (strain - side * strength / self.stiffness)[beyond]
            trial = self.stiffness * (elongation / self.rest_length - self.plastic_strain)
            at_it = side * trial >= strength * (1.0 - AT_STRENGTH)
            self.branch[at_it & (side * rate > 0.0)] = side
        strain = elongation / self.rest_length - self.plastic_strain
        self.branch[self.cable & ((strain < 0.0) | ((strain == 0.0) & (rate <= 0.0)))] = SLACK
        trial = self.stiffness * strain
        self.limp = self.dampened_cables & (self.branch != SLACK) & (trial + self.damping * rate < 0.0)

    def _floors(self) -> Array:
        """Errors that do not matter: a share of what the first moments of the motion are like."""
        count = len(self.elements.particles)
        stiffness = np.zeros((2 * count, 2 * count))
        along = self.span / self.original[:, None]
        for k, (i, j) in enumerate(zip(self.start, self.end, strict=True)):
            pattern = np.zeros(2 * count)
            pattern[2 * i : 2 * i + 2], pattern[2 * j : 2 * j + 2] = -along[k], along[k]
            stiffness += self.stiffness[k] / self.rest_length[k] * np.outer(pattern, pattern)
        root = np.sqrt(self.mobility.ravel())
        fastest = math.sqrt(max(np.linalg.eigvalsh(root[:, None] * stiffness * root)[-1], 1.0))
        u, v = self.kinematics(self.y)
        varying = sum((np.abs(load.force).max() for load in self.elements.loads), 0.0)
        pushed = np.abs(self.acceleration(self.time, u, v)).max() + varying * self.mobility.max(initial=0.0)
        size = max(np.abs(u).max(), np.abs(v).max() / fastest, pushed / fastest**2, 1e-12)
        heaviest = float((self.mass[self.free.any(axis=1)]).max(initial=0.0))
        energy = 10.0 * heaviest * (size * fastest) ** 2
        return self.tolerance * np.concatenate(
            [np.full(2 * count, size), np.full(2 * count, size * fastest), np.full(3, energy)]
        )

    # --- laws ------------------------------------------------------------------------------------

    def kinematics(self, y: Array) -> tuple[Array, Array]:
        """Displacements and velocities, (particles, 2) each."""
        return y[self.parts[0]].reshape(-1, 2), y[self.parts[1]].reshape(-1, 2)

    def geometry(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Directions (rods, 2), elongations (m) and their rates (m/s), written so that small ones lose no digits."""
        change = u[self.end] - u[self.start]
        present = self.span + change
        length = np.hypot(*present.T)
        along = present / np.where(length > 0.0, length, 1.0)[:, None]
        growth = ((self.span + present) * change).sum(axis=1) / (length + self.original)
        rate = (along * (v[self.end] - v[self.start])).sum(axis=1)
        return along, growth + self.misfit, rate

    def tension(self, elongation: Array) -> Array:
        """N (kN) on the present branches, however far, without dampers."""
        elastic = self.stiffness * (elongation / self.rest_length - self.plastic_strain)
        if not self.watched_rods:
            return elastic
        found = np.where(self.branch == TENSION, self.strength[TENSION], elastic)
        found = np.where(self.branch == COMPRESSION, -self.strength[COMPRESSION], found)
        return np.where(self.branch == SLACK, 0.0, found)

    @property
    def watched_rods(self) -> bool:
        return bool((self.branch != ELASTIC).any())

    def dampers(self, tension: Array, rate: Array) -> Array:
        """The force of each damper (kN)."""
        force = self.damping * rate
        return np.where(self.branch == SLACK, 0.0, np.where(self.limp, -tension, force))

    def applied(self, time: float) -> Array:
        """All external forces (kN) but drag and reactions."""
        force = self.constant.copy()
        for load in self.elements.loads:
            force[load.particle] += load.factor(time) * np.array(load.force)
        return force

    def acceleration(self, time: float, u: Array, v: Array) -> Array:
        """m/s², (particles, 2)."""
        along, elongation, rate = self.geometry(u, v)
        tension = self.tension(elongation)
        total = self.applied(time) + self.pulls @ ((tension + self.dampers(tension, rate))[:, None] * along)
        return self.mobility * (total - self.elements.drag * self.mass * v / 1000.0)

    def rates(self, time: float, y: Array) -> Array:
        """dy/dt."""
        u, v = self.kinematics(y)
        along, elongation, rate = self.geometry(u, v)
        tension = self.tension(elongation)
        damper, applied = self.dampers(tension, rate), self.applied(time)
        drag = self.elements.drag * self.mass * v / 1000.0
        total = applied - drag + self.pulls @ ((tension + damper)[:, None] * along)
        yielding = (self.branch == TENSION) | (self.branch == COMPRESSION)
        gains = [
            1000.0 * (applied * v).sum(),
            1000.0 * ((damper * rate).sum() + (drag * v).sum()),
            1000.0 * (tension * rate)[yielding].sum(),
        ]
        return np.concatenate([v.ravel(), (self.mobility * total).ravel(), gains])

    def stored(self, y: Array) -> tuple[float, float]:
        """Kinetic and elastic energy (J)."""
        u, v = self.kinematics(y)
        tension = self.tension(self.geometry(u, v)[1])
        kinetic = 0.5 * (self.mass * v**2).sum()
        return float(kinetic), float(500.0 * (tension**2 * self.rest_length / self.stiffness).sum())

    # --- events ----------------------------------------------------------------------------------

    def margins(self, y: Array) -> Array:
        """How far each event is off, as strains, shares of speeds and lengths; infinite where none can happen.

        Of each rod the end of its branch, the other end of the elastic one, and of a cable's damper the beginning or
        end of its being all that the cable bears; of each pair of discs, and each disc and wall, that they meet.
        """
        u, v = self.kinematics(y)
        _, elongation, rate = self.geometry(u, v)
        speed = max(float(np.abs(v).max(initial=0.0)), 1e-300)
        strain = elongation / self.rest_length - self.plastic_strain
        b = self.branch
        elastic = self.strength[TENSION] / self.stiffness - strain
        first = np.where(b == ELASTIC, elastic, np.where(b == SLACK, -strain, b * rate / speed))
        lower = np.where(self.cable, strain, self.strength[COMPRESSION] / self.stiffness + strain)
        second = np.where(b == ELASTIC, lower, math.inf)
        held = (self.tension(elongation) + self.damping * rate) / self.stiffness
        third = np.where(self.dampened_cables & (b != SLACK), np.where(self.limp, -held, held), math.inf)
        return np.concatenate([first, second, third, self.gaps(u)])

    def gaps(self, u: Array) -> Array:
        """The distances (m) of discs from each other, then from walls."""
        place = self.place + u
        i, j = self.pairs.T
        between = np.hypot(*(place[j] - place[i]).T) - self.radius[i] - self.radius[j]
        walls = [np.hypot(*(place[k] - _nearest(wall, place[k]))) - self.radius[k] for k, wall in self.walls]
        return np.concatenate([between, walls])

    def to_next_event(self, stop: float) -> None:
        """Advance to the next event, or to the time `stop`; loads are those before `stop`."""
        before = math.nextafter(stop, -math.inf)
        rates = lambda time, y: self.rates(min(time, before), y)  # noqa: E731
        options = {"rtol": self.tolerance, "atol": self.floors, "max_step": self._clear_time()}
        solver = DOP853(rates, self.time, self.y, stop, **options)
        while solver.status == "running":
            if problem := solver.step():
                raise Untraceable(problem)
            if self.watched and (found := self._first_event(solver)):
                time, event = found
                if time > solver.t_old:
                    short = DOP853(rates, solver.t_old, self.y, time, **options)
                    while short.status == "running":
                        if problem := short.step():
                            raise Untraceable(problem)
                    self.y, self.time = short.y, time
                self.note(self.y)
                self._take(event)
                return
            self.y, self.time = solver.y, solver.t
            self.note(self.y)

    def _clear_time(self) -> float:
        """The longest step in which no disc can pass another unnoticed (s), about."""
        if not len(self.pairs) and not len(self.walls):
            return math.inf
        _, v = self.kinematics(self.y)
        fastest = (
            np.hypot(*v.T).max() + 0.01 * np.abs(self.acceleration(self.time, *self.kinematics(self.y))).max()
        )
        return float(self.radius.min() * CHECKS / 4.0 / max(fastest, 1e-9))

    def _first_event(self, solver: DOP853) -> tuple[float, int] | None:
        """The time and number of the first event in a step."""
        path = solver.dense_output()
        times = np.linspace(solver.t_old, solver.t, CHECKS + 1).tolist()
        margins = [self.margins(self.y), *(self.margins(path(time)) for time in times[1:-1])]
        margins.append(self.margins(solver.y))
        times, margins = self._with_dips(path, times, margins)
        for (start, early), (end, late) in pairwise(zip(times, margins, strict=True)):
            passed = np.flatnonzero(late < -NOISE)
            found = [(self._passes(path, k, start, end, early[k]), int(k)) for k in passed]
            if found:
                return min(found)
        return None

    def _with_dips(self, path, times: list[float], margins: list[Array]) -> tuple[list[float], list[Array]]:
        """The same and what lies below zero between two times at which a margin is above."""
        before, at, after = (np.array(margins[k : len(margins) - 2 + k]) for k in range(3))
        with np.errstate(invalid="ignore"):
            fall, rise = before - at, after - at
            lowest = (fall >= 0.0) & (rise >= 0.0) & (at > 0.0) & (at < fall + rise)
        dips = []
        for row, event in np.argwhere(lowest).tolist():
            around = (times[row], times[row + 2])
            value = lambda time, event=event: self.margins(path(time))[event]  # noqa: E731
            found = minimize_scalar(
                value, bounds=around, method="bounded", options={"xatol": 1e-6 * (around[1] - around[0])}
            )
            if found.fun < -NOISE:
                dips.append((float(found.x), self.margins(path(found.x))))
        both = sorted([*zip(times, margins, strict=True), *dips], key=lambda pair: pair[0])
        return [time for time, _ in both], [margin for _, margin in both]

    def _passes(self, path, event: int, start: float, end: float, margin: float) -> float:
        """When a margin passes zero; one that begins at zero may first become positive."""
        value = lambda time: self.margins(path(time))[event]  # noqa: E731
        if margin <= 0.0 or value(start) <= 0.0:  # the interpolation may be a little off
            inside = start + (end - start) * np.geomspace(1e-4, 1.0, 25)[:-1]
            positive = [time for time in inside.tolist() if value(time) > 0.0]
            if not positive:
                return start
            start = positive[-1]
        return brentq(value, start, end, xtol=1e-300, rtol=1e-15)

    def _take(self, event: int) -> None:
        """Let an event happen."""
        self.events += 1
        if self.events > MOST_EVENTS:
            raise Untraceable(f"More than {MOST_EVENTS} events until t = {self.time} s.")
        rods = len(self.branch)
        kind, rod = divmod(event, rods) if event < 3 * rods else (3, event - 3 * rods)
        if kind == 3:
            self._strike(rod)
        elif kind == 2:
            self.limp[rod] = ~self.limp[rod]
        else:
            self._change_branch(rod, upper=kind == 0)

    def _change_branch(self, rod: int, *, upper: bool) -> None:
        """Let a rod go over to another branch; one that unloads has taken up what exceeded its strength."""
        u, v = self.kinematics(self.y)
        _, elongation, rate = (value[rod] for value in self.geometry(u, v))
        before = self.branch[rod]
        if before in (TENSION, COMPRESSION):
            held = before * self.strength[before][rod] / self.stiffness[rod]
            self.plastic_strain[rod] = elongation / self.rest_length[rod] - held
        after = {ELASTIC: TENSION if upper else SLACK if self.cable[rod] else COMPRESSION}.get(before, ELASTIC)
        self.branch[rod] = after
        if after == SLACK:
            self.limp[rod] = False
        elif before == SLACK:
            self.limp[rod] = self.dampened_cables[rod] and rate < 0.0

    def _strike(self, meeting: int) -> None:
        """Impulse −(1 + e) (n·Δv) / (n·(W₁ + W₂) n) along the line of centres, on free directions."""
        u, v = self.kinematics(self.y)
        place, inverse = self.place + u, self.mobility / 1000.0
        if meeting < len(self.pairs):
            i, j = self.pairs[meeting]
            line, compliance, e = place[j] - place[i], inverse[i] + inverse[j], self.elements.restitution
            relative = v[j] - v[i]
        else:
            j, wall = self.walls[meeting - len(self.pairs)]
            i, line, compliance, relative = None, place[j] - _nearest(wall, place[j]), inverse[j], v[j]
            e = self.elements.restitution if wall.restitution is None else wall.restitution
        normal = line / np.hypot(*line)
        speed, yielding = normal @ relative, normal @ (compliance * normal)
        if speed >= 0.0 or yielding == 0.0:
            return
        impulse = -(1.0 + e) * speed / yielding
        v = v.copy()
        v[j] += impulse * inverse[j] * normal
        if i is not None:
            v[i] -= impulse * inverse[i] * normal
        self.lost_in_impacts += (1.0 - e**2) * speed**2 / yielding / 2
        self.impacts += 1
        self.y = self.y.copy()
        self.y[self.parts[1]] = v.ravel()
        self.note(self.y)

    # --- results ---------------------------------------------------------------------------------

    def note(self, y: Array) -> None:
        """Keep the largest values so far. Raises Untraceable where a rod that bears shrinks to nothing."""
        u, v = self.kinematics(y)
        _, elongation, _ = self.geometry(u, v)
        tension = self.tension(elongation)
        if (self.original + (elongation - self.misfit) < SHORTEST).any():
            raise Untraceable(f"A rod is shorter than {SHORTEST} m at t = {self.time} s.")
        work, *lost = np.abs(y[self.parts[2]]).tolist()
        values = {
            "displacement": np.hypot(*u.T).max(initial=0.0),
            "velocity": np.hypot(*v.T).max(initial=0.0),
            "axial_force": np.abs(tension).max(initial=0.0),
            "energy": max(*self.stored(y), work, *lost, self.lost_in_impacts),
        }
        self.largest = {name: max(value, float(values[name])) for name, value in self.largest.items()}

    def result(self) -> Motion:
        """The state now."""
        u, v = self.kinematics(self.y)
        tension = self.tension(self.geometry(u, v)[1])
        yielding = (self.branch == TENSION) | (self.branch == COMPRESSION)
        strain = self.geometry(u, v)[1] / self.rest_length
        plastic = np.where(yielding, strain - tension / self.stiffness, self.plastic_strain)
        kinetic, elastic = self.stored(self.y)
        work, damping, plastic_loss = self.y[self.parts[2]].tolist()
        energy = {
            "initial": self.initial,
            "work": work,
            "kinetic": kinetic,
            "elastic": elastic,
            "dissipated_damping": damping,
            "dissipated_plastic": plastic_loss,
            "dissipated_impact": self.lost_in_impacts,
        }
        return Motion(u, v, tension, plastic, energy, self.largest, self.events, self.impacts)


def _nearest(wall, place: Array) -> Array:
    """The point of a wall that is nearest to a place."""
    start, span = np.array(wall.start), np.subtract(wall.end, wall.start)
    share = np.clip((place - start) @ span / (span @ span), 0.0, 1.0)
    return start + share * span
