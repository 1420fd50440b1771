"""A plan's kernels executed stage by stage in plain Python: what a fused step program has to equal, bit for bit.

Every stage fills arrays of its own, rod by rod and particle by particle: geometry, each law, the sum of the
laws, the scatter, the same for what depends on velocity. The order of every sum is the documented one: laws of
rods that take no axial force in order of name, then those that replace the sum in order of the plan, rods
scattered once, in their order; dampers and drag in an array of their own.
"""

import importlib
import inspect
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from pinjoint.components.load import load_breaks
from pinjoint.components.model import Model
from pinjoint.systems.base import ACCOUNTS, Commit, Law, StepSystem

Pair = tuple[float, float]
Step = tuple[float, float, float]


class Kernel:
    """A step system's kernel as plain Python, and how to call it for one row."""

    def __init__(self, system: StepSystem, model: Model) -> None:
        self.system: Any = system  # a law or a commit, whose attributes differ
        self.model = model
        self.function: Callable[..., Any] = _plain(system.kernel)
        self.parameters = tuple(inspect.signature(self.function).parameters)
        self.arrays = system.arrays(model)

    def __call__(self, row: int, provided: dict[str, Any]) -> Any:
        return self.function(*(self._value(name, row, provided) for name in self.parameters))

    def _value(self, name: str, row: int, provided: dict[str, Any]) -> Any:
        if name in provided:
            return provided[name]
        if name in self.arrays:
            value = self.arrays[name][row]
        else:
            table, _, column = name.partition("_")
            value = self.model.tables[table].column(column)[0 if self.model.tables[table].kind.single else row]
        return tuple(value.tolist()) if np.ndim(value) else value.item()

    def of_two(self, first: int, second: int, provided: dict[str, Any]) -> Any:
        """Its result for two particles, of each of which it gets the values."""
        given = [
            provided[name] if name in provided else tuple(self._value(name, row, {}) for row in (first, second))
            for name in self.parameters
        ]
        return self.function(*given)

    @property
    def takes_rate(self) -> bool:
        return "rate" in self.parameters or "particles_velocity" in self.parameters

    @property
    def replaces(self) -> bool:
        return "axial_force" in self.parameters and "rate" not in self.parameters


def _plain(kernel: Any) -> Callable[..., Any]:
    if isinstance(kernel, str):
        module, _, name = kernel.partition(":")
        kernel = getattr(importlib.import_module(module), name)
    plain: Callable[..., Any] = kernel.py_func
    return plain


class Stages:
    """One model with the kernels of a plan, executed by velocity Verlet or the thesis' scheme.

    u, v, plastic (by the commit's column): the state; `account` by name, in J, that of the loads included.
    """

    def __init__(self, model: Model, systems: Sequence[StepSystem]) -> None:
        self.model = model
        kernels = [Kernel(system, model) for system in systems]
        laws = [k for k in kernels if isinstance(k.system, Law)]
        named = sorted(laws, key=lambda k: k.system.name)
        of_rods = [k for k in named if k.system.each == "rods"]
        self.adding = [k for k in of_rods if not k.takes_rate and not k.replaces]
        self.replacing = [k for k in laws if k.system.each == "rods" and k.replaces]
        self.damping = [k for k in of_rods if k.takes_rate]
        self.pushing = [k for k in named if k.system.each == "particles" and not k.takes_rate]
        self.resisting = [k for k in named if k.system.each == "particles" and k.takes_rate]
        of_pairs = [k for k in named if k.system.each == "pairs"]
        self.attracting = [k for k in of_pairs if "drift" not in k.parameters]
        self.slowing = [k for k in of_pairs if "drift" in k.parameters]
        self.loading = [k for k in named if k.system.each == "loads"]
        self.commits = [k for k in kernels if isinstance(k.system, Commit)]
        self.u = model.particles.displacement.tolist()
        self.v = model.particles.velocity.tolist()
        self.history = {k.system.writes[0]: model.column(k.system.writes[0]).tolist() for k in self.commits}
        stored = [k for k in of_rods if not k.takes_rate and k.system.elastic]
        self.working = [k for k in (*self.adding, *self.replacing) if k not in stored]
        self.account = dict.fromkeys(ACCOUNTS, 0.0)
        self.ends = model.rods.between.tolist()
        self.mobility = model.particles.mobility.tolist()

    # --- stages over rods ------------------------------------------------------------------------

    def geometry(self, u: list[list[float]]) -> tuple[list[Pair], list[float]]:
        """Directions and elongations of all rods."""
        rods = self.model.rods
        directions, elongations = [], []
        for row, (a, b) in enumerate(self.ends):
            dx, dy = rods.difference[row].tolist()
            sx, sy = u[b][0] - u[a][0], u[b][1] - u[a][1]
            x, y = dx + sx, dy + sy
            length = math.sqrt(x * x + y * y)
            inverse = 1.0 / length if length > 0.0 else 0.0
            directions.append((x * inverse, y * inverse))
            original, misfit = rods.original_length[row].item(), rods.misfit[row].item()
            both = length + original
            stretch = ((dx + x) * sx + (dy + y) * sy) / both if both > 0.0 else 0.0
            elongations.append(stretch + misfit)
        return directions, elongations

    def rates(self, v: list[list[float]], directions: list[Pair]) -> list[float]:
        """Rates of elongation."""
        return [
            (v[b][0] - v[a][0]) * nx + (v[b][1] - v[a][1]) * ny
            for (a, b), (nx, ny) in zip(self.ends, directions, strict=True)
        ]

    def commit(self, elongations: list[float], time: float, dt: float) -> None:
        """Every commit for every rod."""
        late = [kernel for kernel in self.commits if "axial_force" in kernel.parameters]
        for kernel in (*(kernel for kernel in self.commits if kernel not in late), *late):
            column, lost = self.history[kernel.system.writes[0]], 0.0
            forces = self.axial_forces(elongations, time, dt) if kernel in late else elongations
            for row, (elongation, force) in enumerate(zip(elongations, forces, strict=True)):
                given = {"elongation": elongation, "axial_force": force, "time": time, "dt": dt}
                provided = self._past(row) | given
                column[row], gone = kernel(row, provided)
                lost += gone
            self.account[kernel.system.account] += 1000.0 * lost

    def _past(self, row: int) -> dict[str, Any]:
        return {name.replace(".", "_", 1): column[row] for name, column in self.history.items()}

    def axial_forces(
        self, elongations: list[float], time: float, dt: float, without: Sequence[Kernel] = ()
    ) -> list[float]:
        """One array for each law, then their sum in order, then the laws that replace it."""
        given = [
            self._past(row) | {"elongation": elongation, "time": time, "dt": dt}
            for row, elongation in enumerate(elongations)
        ]
        adding = [kernel for kernel in self.adding if kernel not in without]
        parts = [[kernel(row, provided) for row, provided in enumerate(given)] for kernel in adding]
        total = [0.0] * len(given)
        for part in parts:
            total = [so_far + force for so_far, force in zip(total, part, strict=True)]
        for kernel in self.replacing:
            if kernel in without:
                continue
            total = [kernel(r, given[r] | {"axial_force": force}) for r, force in enumerate(total)]
        return total

    def damping_forces(
        self, elongations: list[float], forces: list[float], rates: list[float], time: float, dt: float
    ) -> tuple[list[float], list[tuple[str, float]]]:
        """The sum of the laws that depend on the rate, and (account, what it gains per second) one by one."""
        total, powers = [], []
        for row, rate in enumerate(rates):
            given = {"elongation": elongations[row], "axial_force": forces[row], "rate": rate}
            so_far = 0.0
            for kernel in self.damping:
                part = kernel(row, self._past(row) | given | {"time": time, "dt": dt})
                so_far += part
                account = kernel.system.account
                powers.append((account, -(part * rate) if account == "work" else part * rate))
            total.append(so_far)
        return total, powers

    def scatter(self, target: list[list[float]], forces: list[float], directions: list[Pair]) -> None:
        """Each rod pulls at both its ends."""
        for (a, b), force, (nx, ny) in zip(self.ends, forces, directions, strict=True):
            target[a][0] += force * nx
            target[a][1] += force * ny
            target[b][0] -= force * nx
            target[b][1] -= force * ny

    # --- stages over particles -------------------------------------------------------------------

    def _pulls(self, kernels: list[Kernel], u: Any, v: Any, time: float, dt: float) -> list[list[Pair]]:
        return [
            [
                kernel(
                    row,
                    {
                        "particles_displacement": tuple(u[row]),
                        "particles_velocity": tuple(v[row]),
                        "time": time,
                        "dt": dt,
                    },
                )
                for row in range(len(u))
            ]
            for kernel in kernels
        ]

    def external(self, u: Any, v: Any, time: float, dt: float) -> list[list[float]]:
        """Constant forces, laws of particles, varying loads."""
        total = self.model.particles.constant_force.tolist()
        for part in self._pulls(self.pushing, u, v, time, dt):
            for row, (x, y) in enumerate(part):
                total[row][0] += x
                total[row][1] += y
        for on, x, y in self._loads(time):
            total[on][0] += x
            total[on][1] += y
        for i, j, x, y, _ in self._pairs(self.attracting, u, v, time, dt):
            self._push_apart(total, i, j, x, y)
        return total

    def _pairs(self, kernels: list[Kernel], u: Any, v: Any, time: float, dt: float) -> Iterator[Any]:
        """The forces between particles i < j within the cutoff, all pairs looked at: (i, j, fx, fy, kernel)."""
        place = self.model.particles.position.tolist()
        for i in range(len(u)):
            for j in range(i + 1, len(u)):
                x, y = ((place[j][d] - place[i][d]) + (u[j][d] - u[i][d]) for d in range(2))
                drift = v[j][0] - v[i][0], v[j][1] - v[i][1]
                for kernel in kernels:
                    if x * x + y * y < kernel.system.cutoff(self.model) ** 2:
                        given = {"apart": (x, y), "drift": drift, "time": time, "dt": dt}
                        yield i, j, *kernel.of_two(i, j, given), kernel

    @staticmethod
    def _push_apart(total: list[list[float]], i: int, j: int, x: float, y: float) -> None:
        total[i][0] += x
        total[i][1] += y
        total[j][0] -= x
        total[j][1] -= y

    def _varying(self, time: float) -> Iterator[tuple[int, float, float, float]]:
        """The loads that vary: on which particle, in full, and the factor of it at a time."""
        for kernel in self.loading:
            on, force, values, first = (
                kernel.arrays[f"{kernel.system.name.replace('.', '_')}_{part}"].tolist()
                for part in ("on", "force", "values", "first")
            )
            for particle, (x, y), start in zip(on, force, first, strict=True):
                yield particle, x, y, kernel.function(time, values, start)

    def _loads(self, time: float) -> list[tuple[int, float, float]]:
        return [(particle, factor * x, factor * y) for particle, x, y, factor in self._varying(time)]

    def load_power(self, time: float, v: Any) -> float:
        """What the varying loads do per second."""
        total = 0.0
        for particle, x, y, factor in self._varying(time):
            total += factor * (x * v[particle][0] + y * v[particle][1])
        return total

    # --- a state, and steps ----------------------------------------------------------------------

    def forces(self, u: Any, v: Any, time: float, dt: float, accepted: bool) -> tuple[Any, Any]:
        """What acts whatever the velocity, and what resists motion; an accepted state commits history first."""
        force = self.external(u, v, time, dt)
        directions, elongations = self.geometry(u)
        if accepted:
            self.commit(elongations, time, dt)
        axial = self.axial_forces(elongations, time, dt)
        self.scatter(force, axial, directions)
        return force, self.resistance(u, v, time, dt)[0]

    def resistance(self, u: Any, v: Any, time: float, dt: float) -> tuple[Any, dict[str, float]]:
        """Dampers and drag, and what each account gains per second (kN·m/s)."""
        total = [[0.0, 0.0] for _ in u]
        power = dict.fromkeys(ACCOUNTS, 0.0)
        for kernels, target in ((self.resisting, total), (self.pushing, None)):
            parts = self._pulls(kernels, u, v, time, dt)
            for row in range(len(u)):
                for kernel, part in zip(kernels, parts, strict=True):
                    x, y = part[row]
                    if target is not None:
                        target[row][0] += x
                        target[row][1] += y
                    sign = 1.0 if kernel.system.account == "work" else -1.0
                    power[kernel.system.account] += sign * (x * v[row][0] + y * v[row][1])
        for i, j, x, y, kernel in self._pairs([*self.attracting, *self.slowing], u, v, time, dt):
            if kernel in self.slowing:
                self._push_apart(total, i, j, x, y)
            if not kernel.system.potential:
                sign = 1.0 if kernel.system.account == "work" else -1.0
                done = x * (v[i][0] - v[j][0]) + y * (v[i][1] - v[j][1])
                power[kernel.system.account] += sign * done
        directions, elongations = self.geometry(u)
        axial = self.axial_forces(elongations, time, dt)
        rates = self.rates(v, directions)
        damping, taken = self.damping_forces(elongations, axial, rates, time, dt)
        self.scatter(total, damping, directions)
        for account, value in taken:
            power[account] += value
        left = list(self.working)
        before = self.axial_forces(elongations, time, dt, without=left)
        for account in [name for name in ACCOUNTS if any(k.system.account == name for k in self.working)]:
            left = [k for k in left if k.system.account != account]
            after = self.axial_forces(elongations, time, dt, without=left)
            for force, own, rate in zip(after, before, rates, strict=True):
                power[account] += (force - own) * rate * (-1.0 if account == "work" else 1.0)
            before = after
        return total, power

    def run(self, integrator: str, dt: float, steps: int) -> None:
        """Take steps from time 0, cut at the times at which loads change abruptly."""
        force, resisting = self.forces(self.u, self.v, 0.0, dt, accepted=False)
        power = self.resistance(self.u, self.v, 0.0, dt)[1]
        for size, start, time in self._pieces(dt, steps):
            half = 0.5 * size
            a = self._accelerations(force, resisting)
            middle = [[v + half * a for v, a in zip(*row, strict=True)] for row in zip(self.v, a, strict=True)]
            predicted = [
                [v + size * a for v, a in zip(*row, strict=True)] for row in zip(self.v, a, strict=True)
            ]
            self.u = [
                [u + size * m for u, m in zip(*row, strict=True)] for row in zip(self.u, middle, strict=True)
            ]
            if self.loading:
                before = self.load_power(start, middle)
                self.account["work"] += 500.0 * size * (before + self.load_power(time, middle))
            if integrator == "velocity_verlet":
                force, resisting = self.forces(self.u, predicted, time, size, accepted=True)
                a = self._accelerations(force, resisting)
            self.v = [[m + half * a for m, a in zip(*row, strict=True)] for row in zip(middle, a, strict=True)]
            if integrator == "taylor2":
                force, resisting = self.forces(self.u, self.v, time, size, accepted=True)
            resisting, gained = self.resistance(self.u, self.v, time, size)
            for name in ACCOUNTS:
                self.account[name] += 500.0 * size * (power[name] + gained[name])
            power = gained

    def _pieces(self, dt: float, steps: int) -> Iterator[Step]:
        """(size, start, end) of every step, or of the pieces that breaks cut it into."""
        time, breaks = 0.0, load_breaks(self.model)
        for step in range(1, steps + 1):
            end = step * dt
            inside = [at for at in breaks if time < at < end]
            if not inside:
                yield dt, (step - 1) * dt, end
            for piece in (*inside, end) if inside else ():
                yield piece - time, piece - (piece - time), piece
                time = piece
            time = end

    def _accelerations(self, force: Any, resisting: Any) -> list[list[float]]:
        return [
            [(f + r) * m for f, r, m in zip(*row, strict=True)]
            for row in zip(force, resisting, self.mobility, strict=True)
        ]
