"""The source of a step program: laws, commits and a driver of one plan, written out as one flat module."""

from __future__ import annotations

import importlib
import inspect
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from components.model import KINDS, Model
from components.table import fields_of
from systems.base import ACCOUNTS, Commit, Driver, Law, StepSystem
from systems.physics.integrators import advance

CHECK_INTERVAL = 128  # steps between checks for rest and divergence; larger: notices later
REVIEW_INTERVAL = 8192  # steps between reviews of the step size, and between safe states

_TRIAL = {"particles_displacement": "displacement", "particles_velocity": "velocity"}
_SINGLE = ("environment", "settings", "clock")
_PROVIDED = ("elongation", "rate", "axial_force", "time", "dt")
_ALWAYS = (
    "particles_mobility",
    "particles_mass",
    "particles_constant_force",
    "rods_between",
    "rods_difference",
    "rods_original_length",
    "rods_rest_length",
    "rods_stiffness",
)


class ProgramError(ValueError):
    """A step system that cannot join the program; the message names it, the reason and the remedy."""


@dataclass(frozen=True)
class Bound:
    """A step system with its kernel and the names of the kernel's parameters."""

    system: StepSystem
    function: Callable[..., Any]
    parameters: tuple[str, ...]

    @property
    def call(self) -> str:
        """The name of the kernel in the program."""
        return "kernel_" + self.prefix

    @property
    def prefix(self) -> str:
        """The system's name as a Python name."""
        return self.system.name.replace(".", "_")


def bind(system: StepSystem) -> Bound:
    """Find a step system's kernel and its parameters. Raises ProgramError."""
    function = system.kernel
    if isinstance(function, str):
        module, _, attribute = function.partition(":")
        function = getattr(importlib.import_module(module), attribute)
    plain = getattr(function, "py_func", function)
    bound = Bound(system, function, tuple(inspect.signature(plain).parameters))
    _check_declared(bound)
    return bound


def _check_declared(b: Bound) -> None:
    """A kernel is given the columns that its system declares, and no others."""
    if isinstance(b.system, Driver) or _is_load_law(b):
        return
    declared = {column.replace(".", "_", 1) for column in (*b.system.reads, *b.system.writes)}
    for parameter in b.parameters:
        if parameter not in _PROVIDED and parameter not in declared:
            column = parameter.replace("_", ".", 1)
            raise ProgramError(
                f"The kernel of {b.system.name} takes {parameter}, but the system does not declare that it"
                f" reads '{column}'; add it to `reads`."
            )


class Writer:
    """Writes the source of one step program from the bound systems of a plan."""

    def __init__(self, systems: Sequence[StepSystem], driver: Driver) -> None:
        bound = [bind(system) for system in systems]
        laws = [b for b in bound if isinstance(b.system, Law)]
        self.commits = [b for b in bound if isinstance(b.system, Commit)]
        self.rod_laws = [b for b in laws if _each(b) == "rods" and "rate" not in b.parameters]
        self.rod_rates = [b for b in laws if _each(b) == "rods" and "rate" in b.parameters]
        self.particle_laws = [
            b for b in laws if _each(b) == "particles" and "particles_velocity" not in b.parameters
        ]
        self.particle_rates = [
            b for b in laws if _each(b) == "particles" and "particles_velocity" in b.parameters
        ]
        self.loads = [b for b in laws if _each(b) == "loads"]
        self.driver = bind(driver)
        self.bound = bound
        self.kernels = {b.call: b.function for b in bound} | {"judge": _judge()}
        self.rates = bool(self.rod_rates or self.particle_rates)
        self.powers = self.rates or bool(self.loads or self.particle_laws)
        self.columns = self._columns()

    def _columns(self) -> list[str]:
        """Names of all arrays that the stages read or write besides the driver's own."""
        names = dict.fromkeys(_ALWAYS)
        for b in self.bound:
            for parameter in b.parameters:
                if parameter not in _PROVIDED and parameter not in _TRIAL and not _is_load_law(b):
                    names[parameter] = None
            if _is_load_law(b):
                names.update(dict.fromkeys(f"{b.prefix}_{part}" for part in ("on", "force", "values", "first")))
        return list(names)

    # --- expressions ------------------------------------------------------------------------------

    def _argument(self, b: Bound, parameter: str, index: str) -> str:
        """How a kernel's parameter is written inside the loop over its rows."""
        if parameter in _PROVIDED:
            return parameter
        if parameter in _TRIAL:
            name = _TRIAL[parameter]
            return f"({name}[{index}, 0], {name}[{index}, 1])"
        table, _, column = parameter.partition("_")
        index = "0" if table in _SINGLE else index
        shape = self._shape(b, table, column)
        return f"({parameter}[{index}, 0], {parameter}[{index}, 1])" if shape else f"{parameter}[{index}]"

    def _shape(self, b: Bound, table: str, column: str) -> tuple[int, ...]:
        for kind in KINDS:
            if kind.table == table:
                for field in fields_of(kind):
                    if field.name == column:
                        return field.shape
        raise ProgramError(
            f"The kernel of {b.system.name} has a parameter '{table}_{column}', but there is no column"
            f" {table}.{column}; name parameters <table>_<column>, elongation, rate, axial_force or time."
        )

    def _apply(self, b: Bound, index: str) -> str:
        return f"{b.call}({', '.join(self._argument(b, p, index) for p in b.parameters)})"

    # --- stages -----------------------------------------------------------------------------------

    def source(self) -> str:
        """The program's source."""
        parts = [
            self._constants(),
            self._external(),
            self._forces("forces", accepted=False),
            self._forces("accept", accepted=True),
            self._resist(),
            self._measure(),
            self._observe(),
            self._pasted(self.driver.function, "integrate", "compiled"),
            self._pasted(advance, "advance", "entry"),
        ]
        return "\n\n".join(parts) + "\n"

    def _constants(self) -> str:
        return textwrap.dedent(
            f'''\
            """A step program. Generated; safe to delete."""

            import math

            from numba import njit

            compiled = njit(error_model="numpy")
            entry = njit(error_model="numpy", cache=True)
            RATES = {self.rates}
            POWERS = {self.powers}
            SHADOW = {int(getattr(self.driver.system, "conserved_energy", "") != "")}
            CHECK_INTERVAL = {CHECK_INTERVAL}
            REVIEW_INTERVAL = {REVIEW_INTERVAL}
            '''
        )

    def _columns_text(self) -> str:
        return ", ".join(self.columns)

    def _forces(self, name: str, *, accepted: bool) -> str:
        account = "account, " if accepted else ""
        lines = [
            "@compiled",
            f"def {name}(time, dt, displacement, velocity, force, resisting, direction, {account}{self._columns_text()}):",
            "    external(time, dt, displacement, velocity, force, resisting, " + self._columns_text() + ")",
        ]
        commits = accepted and self.commits
        if commits:
            lines += _indent(1, ["lost = 0.0"])
        lines += _indent(1, self._rod_loop(self._rod_forces(commits=bool(commits))))
        if commits:
            slot = ACCOUNTS.index(_account(self.commits[0]))
            lines += _indent(1, [f"account[{slot}] += 1000.0 * lost"])
        return "\n".join(lines)

    def _external(self) -> str:
        """Forces on the particles from outside (kN), and those of particle laws that resist motion."""
        head = f"def external(time, dt, displacement, velocity, force, resisting, {self._columns_text()}):"
        return "\n".join(["@compiled", head, *_indent(1, self._particle_forces())])

    def _particle_forces(self) -> list[str]:
        body = ["force[i, 0] = particles_constant_force[i, 0]", "force[i, 1] = particles_constant_force[i, 1]"]
        for b in self.particle_laws:
            body += [f"fx, fy = {self._apply(b, 'i')}", "force[i, 0] += fx", "force[i, 1] += fy"]
        body += self._particle_rate_forces()
        lines = ["for i in range(displacement.shape[0]):", *_indent(1, body)]
        for b in self.loads:
            lines += [
                f"for k in range({b.prefix}_on.shape[0]):",
                f"    i = {b.prefix}_on[k]",
                f"    factor = {b.call}(time, {b.prefix}_values, {b.prefix}_first[k])",
                f"    force[i, 0] += factor * {b.prefix}_force[k, 0]",
                f"    force[i, 1] += factor * {b.prefix}_force[k, 1]",
            ]
        return lines

    def _particle_rate_forces(self, powers: bool = False) -> list[str]:
        if not self.rates:
            return []
        body = ["resisting[i, 0] = 0.0", "resisting[i, 1] = 0.0"]
        for b in self.particle_rates:
            body += [f"fx, fy = {self._apply(b, 'i')}", "resisting[i, 0] += fx", "resisting[i, 1] += fy"]
            if powers:
                body.append(_particle_power(b))
        return body

    def _rod_loop(self, body: list[str]) -> list[str]:
        return [
            "for r in range(rods_between.shape[0]):",
            "    a = rods_between[r, 0]",
            "    b = rods_between[r, 1]",
            *_indent(1, body),
        ]

    @staticmethod
    def _geometry() -> list[str]:
        """Elongation (2D + Δu)·Δu / (L + L_original) + (L_original − L₀): no digits cancel."""
        return [
            "sx = displacement[b, 0] - displacement[a, 0]",
            "sy = displacement[b, 1] - displacement[a, 1]",
            "dx = rods_difference[r, 0]",
            "dy = rods_difference[r, 1]",
            "x = dx + sx",
            "y = dy + sy",
            "original = rods_original_length[r]",
            "length = math.sqrt(x * x + y * y)",
            "inverse = 1.0 / length if length > 0.0 else 0.0",
            "nx = x * inverse",
            "ny = y * inverse",
            "elongation = ((dx + x) * sx + (dy + y) * sy) / (length + original)"
            " + (original - rods_rest_length[r])",
        ]

    def _axial_force(self) -> list[str]:
        lines = ["axial_force = 0.0"]
        for b in self.rod_laws:
            lines.append(f"axial_force {'=' if 'axial_force' in b.parameters else '+='} {self._apply(b, 'r')}")
        return lines

    def _rod_forces(self, *, commits: bool) -> list[str]:
        lines = self._geometry()
        if commits:
            for b in self.commits:
                column = b.system.writes[0].replace(".", "_")
                lines += [f"{column}[r], gone = {self._apply(b, 'r')}", "lost += gone"]
        lines += self._axial_force()
        lines += _scatter("force", "axial_force")
        if self.rod_rates:
            lines += ["direction[r, 0] = nx", "direction[r, 1] = ny", *self._rate_forces()]
        return lines

    def _rate_forces(self, powers: bool = False) -> list[str]:
        lines = [
            "rate = (velocity[b, 0] - velocity[a, 0]) * nx + (velocity[b, 1] - velocity[a, 1]) * ny",
            "damping_force = 0.0",
        ]
        for b in self.rod_rates:
            lines.append(f"damping_force += {self._apply(b, 'r')}")
        if powers:
            slot = ACCOUNTS.index(_account(self.rod_rates[0]))
            lines.append(f"power_{slot} += damping_force * rate")
        return lines + _scatter("resisting", "damping_force")

    def _resist(self) -> str:
        """Dampers and drag at a velocity, and what each account gains per second."""
        lines = [
            "@compiled",
            f"def resist(time, dt, velocity, resisting, direction, power, {self._columns_text()}):",
        ]
        body = [f"power_{slot} = 0.0" for slot in range(len(ACCOUNTS))]
        particles = self._particle_rate_forces(powers=True)
        for b in self.particle_laws:
            particles += [f"fx, fy = {self._apply(b, 'i')}", _particle_power(b)]
        if particles:
            body += ["for i in range(velocity.shape[0]):", *_indent(1, particles)]
        for b in self.loads:
            body += [
                f"for k in range({b.prefix}_on.shape[0]):",
                f"    i = {b.prefix}_on[k]",
                f"    factor = {b.call}(time, {b.prefix}_values, {b.prefix}_first[k])",
                f"    power_0 += factor * ({b.prefix}_force[k, 0] * velocity[i, 0]"
                f" + {b.prefix}_force[k, 1] * velocity[i, 1])",
            ]
        if self.rod_rates:
            rods = ["nx = direction[r, 0]", "ny = direction[r, 1]", *self._rate_forces(powers=True)]
            body += self._rod_loop(rods)
        body += [f"power[{slot}] = power_{slot}" for slot in range(len(ACCOUNTS))]
        return "\n".join([*lines, *_indent(1, body)])

    def _measure(self) -> str:
        """Energies, residual and scales of an accepted state, for judge()."""
        body = [
            "kinetic = 0.0",
            "power_norm = 0.0",
            "potential = 0.0",
            "residual = 0.0",
            "largest = 0.0",
            "moved = 0.0",
            "for i in range(displacement.shape[0]):",
            "    for d in range(2):",
            "        kinetic += particles_mass[i] * velocity[i, d] * velocity[i, d]",
            "        potential += particles_constant_force[i, d] * displacement[i, d]",
            "        total = force[i, d] + resisting[i, d]" if self.rates else "        total = force[i, d]",
            "        power_norm += total * particles_mobility[i, d] * total",
            "        if particles_mobility[i, d] > 0.0:",
            "            residual = max(residual, abs(force[i, d]))",
            "        largest = max(largest, abs(particles_constant_force[i, d]))",
            "        moved = max(moved, abs(displacement[i, d]))",
            "elastic = 0.0",
            "stiffest = 0.0",
            *self._rod_loop(
                [
                    *self._geometry(),
                    *self._axial_force(),
                    "flexibility = rods_rest_length[r] / rods_stiffness[r]",
                    "elastic += axial_force * axial_force * flexibility",
                    "largest = max(largest, abs(axial_force))",
                    "stiffest = max(stiffest, 1.0 / flexibility)",
                ]
            ),
            "measures[0] = 0.5 * kinetic",
            "measures[1] = 1000.0 * power_norm",
            "measures[2] = 500.0 * elastic",
            "measures[3] = 1000.0 * potential",
            "measures[4] = residual",
            "measures[5] = largest",
            "measures[6] = 2.220446049250313e-16 * stiffest * moved",
        ]
        head = f"def measure(displacement, velocity, force, resisting, measures, {self._columns_text()}):"
        return "\n".join(["@compiled", head, *_indent(1, body)])

    def _observe(self) -> str:
        """The derived columns of rods and particles, and the measures, at a state."""
        columns = self._columns_text()
        body = [
            f"external(time, dt, displacement, velocity, applied, resisting, {columns})",
            f"forces(time, dt, displacement, velocity, force, resisting, direction, {columns})",
            f"measure(displacement, velocity, force, resisting, measures, {columns})",
            *self._rod_loop(
                [
                    *self._geometry(),
                    *self._axial_force(),
                    "rods_axial_force[r] = axial_force",
                    "rods_length[r] = length",
                    "rods_strain[r] = elongation / rods_rest_length[r]",
                ]
            ),
        ]
        head = (
            "def observe(time, dt, displacement, velocity, applied, force, resisting, direction, power, measures,"
            f" rods_axial_force, rods_length, rods_strain, {self._columns_text()}):"
        )
        return "\n".join(["@entry", head, *_indent(1, body)])

    def _pasted(self, function: Callable[..., Any], name: str, decorator: str) -> str:
        """A driver's source with the model's columns in place of *columns."""
        source = textwrap.dedent(inspect.getsource(function)).replace("*columns", self._columns_text())
        return f"@{decorator}\n" + source.replace(f"def {function.__name__}(", f"def {name}(", 1)


def _each(b: Bound) -> str:
    return b.system.each if isinstance(b.system, Law) else ""


def _is_load_law(b: Bound) -> bool:
    return _each(b) == "loads"


def _account(b: Bound) -> str:
    return b.system.account if isinstance(b.system, Law | Commit) else ACCOUNTS[0]


def _particle_power(b: Bound) -> str:
    sign = "+" if _account(b) == "work" else "-"
    return f"power_{ACCOUNTS.index(_account(b))} {sign}= fx * velocity[i, 0] + fy * velocity[i, 1]"


def _scatter(target: str, amount: str) -> list[str]:
    return [
        f"{target}[a, 0] += {amount} * nx",
        f"{target}[a, 1] += {amount} * ny",
        f"{target}[b, 0] -= {amount} * nx",
        f"{target}[b, 1] -= {amount} * ny",
    ]


def _indent(levels: int, lines: Iterable[str]) -> list[str]:
    return ["    " * levels + line for line in lines]


def _judge() -> Callable[..., Any]:
    from systems.physics.kernels import judge  # numba is imported when a program is built, not before

    return judge
