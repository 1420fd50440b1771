"""The source of a step program: laws, commits and a driver of one plan, written out as one flat module."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import Any

import numpy as np

from components.model import Model
from components.rod import is_warm
from systems.base import ACCOUNTS, Commit, Driver, Law, StepSystem
from systems.physics.automatic import SMALL
from systems.program.binding import PROVIDED, TRIAL, Bound, bind, check_names, find
from systems.program.loops import RodLoop, indented

REVIEW_INTERVAL = 8192  # steps between reviews of the step size, and between safe states

_AT_STRENGTH = 1.0 - 1e-9  # of its strength, from which on a rod is said to yield
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


ROUND_OFF = 2.220446049250313e-16  # of forces, relative to stiffness × displacement
EVERY = "displacement.shape[0]"
_IN_BLOCK = "{0}[block], {0}[block + 1]"

FORCED = (
    "time, dt, displacement, velocity, force, resisting, direction"  # what forces() takes, before the columns
)
PREDICTED = FORCED.replace("velocity", "predicted")
RESISTED = "time, dt, displacement, velocity, resisting, direction"  # what resist() takes, before the power

SHIFT = {f"s{d}": f"displacement[b, {i}] - displacement[a, {i}]" for i, d in enumerate("xy")}
DRIFT = {f"drift_{d}": f"velocity[b, {i}] - velocity[a, {i}]" for i, d in enumerate("xy")}
RATE = "rate = drift_x * nx + drift_y * ny"


FEW, MANY, VERY_MANY = "few", "many", "very many"  # rods: what is quickest for some is not for others
BLOCKS_FROM = 20_000  # rods: below, cores wait for each other longer than they help


def form_of(model: Model, driver: Driver) -> str:
    """The form of program that suits a model: rod by rod, in stages, or in blocks shared by cores."""
    if model.rods.count <= SMALL:
        return FEW
    return MANY if model.rods.count < BLOCKS_FROM or driver.controlled else VERY_MANY


class Writer:
    """Writes the source of one step program from the bound systems of a plan."""

    def __init__(self, model: Model, systems: Sequence[StepSystem], driver: Driver, form: str) -> None:
        self.model = model
        self.form = form
        self.warm = is_warm(model)
        self.bound = bound = [bind(system, model) for system in systems]
        check_names(bound)
        laws = sorted((b for b in bound if isinstance(b.system, Law)), key=lambda b: b.system.name)
        self.commits = [b for b in bound if isinstance(b.system, Commit)]
        of_rods = [b for b in laws if b.each == "rods"]
        of_particles = [b for b in laws if b.each == "particles"]
        self.rod_laws = [b for b in of_rods if not {"rate", "axial_force"} & set(b.parameters)]
        self.rod_laws += [b for b in bound if b.each == "rods" and b.replaces]
        self.rod_rates = [b for b in of_rods if "rate" in b.parameters]
        self.particle_laws = [b for b in of_particles if "particles_velocity" not in b.parameters]
        self.particle_rates = [b for b in of_particles if "particles_velocity" in b.parameters]
        self.loads = [b for b in laws if b.each == "loads"]
        self.branching = [b.system for b in bound if getattr(b.system, "margin", "")]
        self.driver = driver
        self.kernels = {b.call: b.function for b in bound} | _of_energy()
        self.rates = bool(self.rod_rates or self.particle_rates)
        self.working = [b for b in of_rods if b in self.rod_laws and not (b.replaces or _is_elastic(b))]
        self.powers = self.rates or bool(self.particle_laws or self.working)
        # All arrays that the stages read or write besides the driver's own.
        self.columns = [*_ALWAYS, *(["rods_misfit"] if self.warm else [])]
        self._add_columns(bound)

    def _add_columns(self, bound: Iterable[Bound]) -> None:
        names = dict.fromkeys(self.columns)
        for b in bound:
            for parameter in b.parameters:
                if parameter not in PROVIDED and parameter not in TRIAL and b.each != "loads":
                    names[parameter] = None
            if b.each == "loads":
                names.update(dict.fromkeys(f"{b.prefix}_{part}" for part in ("on", "force", "values", "first")))
        self.columns = list(names)

    # --- expressions ------------------------------------------------------------------------------

    def _argument(self, b: Bound, parameter: str, index: str) -> str:
        """How a kernel's parameter is written inside the loop over its rows."""
        if parameter in PROVIDED:
            return parameter
        name = TRIAL.get(parameter, parameter)
        if parameter in b.arrays:
            shape = b.arrays[parameter].shape[1:]
        else:
            table, _, column = parameter.partition("_")
            index = "0" if self.model.tables[table].kind.single else index
            shape = self.model.tables[table].fields[column].shape
        return f"({name}[{index}, 0], {name}[{index}, 1])" if shape else f"{name}[{index}]"

    def _apply(self, b: Bound, index: str) -> str:
        return f"{b.call}({', '.join(self._argument(b, p, index) for p in b.parameters)})"

    # --- stages -----------------------------------------------------------------------------------

    def source(self) -> str:
        """The program's source."""
        parts = [
            self._constants(),
            self._external(),
            *self._for_driver(),
            self._measure(),
            self._observe(),
            *(self._pasted(part, "inlined") for part in self.driver.parts),
            self._integrate(),
            self._pasted(f"{self.driver.entry}=advance", "entered"),
            *([self._commit()] if self.commits else []),
        ]
        return "\n\n".join(parts) + "\n"

    def _for_driver(self) -> list[str]:
        """Functions that the driver's source may call."""
        return [
            self._forces("forces", accepted=False),
            self._forces("accept", accepted=True),
            self._resist(),
            self._load_power(),
        ]

    def _constants(self) -> str:
        return textwrap.dedent(
            f'''\
            """A step program. Generated; safe to delete."""

            import math

            import numpy as np

            from systems.kernels import entry, part

            compiled = part()
            inlined = part(forceinline=True)
            entered = entry(_nrt={self._may_allocate})
            RATES = {self.rates}
            POWERS = {self.powers}
            LOADS = {bool(self.loads)}
            SHADOW = {float(self.driver.guard)}
            CHECK_INTERVAL = {self.driver.check_interval}
            REVIEW_INTERVAL = {REVIEW_INTERVAL}
            '''
        ) + "".join(f"{name} = {_literal(value)}\n" for name, value in self.driver.constants.items())

    @property
    def _may_allocate(self) -> bool:
        """True if it may ask for memory, as stages do and kernels of mods may; to be ready for it costs a call 2 µs."""
        own = all(str(kernel.__module__).startswith("systems.") for kernel in self.kernels.values())
        return self.form != FEW or not own

    def _columns_text(self) -> str:
        return ", ".join(self.columns)

    def _forces(self, name: str, *, accepted: bool) -> str:
        account = "account, " if accepted else ""
        lines = [
            "@compiled",
            f"def {name}({FORCED}, {account}{self._columns_text()}):",
            "    external(time, dt, displacement, velocity, force, resisting, " + self._columns_text() + ")",
        ]
        commits = self.commits if accepted else []
        slots = sorted({b.slot for b in commits})
        lines += indented([f"lost_{slot} = 0.0" for slot in slots])
        lines += indented(self._rod_loop(self._rod_forces(commits)))
        lines += indented([f"account[{slot}] += 1000.0 * lost_{slot}" for slot in slots])
        return "\n".join(lines)

    def _external(self) -> str:
        """Forces on the particles from outside (kN), and those of particle laws that resist motion."""
        head = f"def external(time, dt, displacement, velocity, force, resisting, {self._columns_text()}):"
        return "\n".join(["@compiled", head, *indented(self._particle_forces())])

    def _particle_forces(self, powers: bool = False, span: str = EVERY) -> list[str]:
        body = ["force[i, 0] = particles_constant_force[i, 0]", "force[i, 1] = particles_constant_force[i, 1]"]
        for b in self.particle_laws:
            body += [f"fx, fy = {self._apply(b, 'i')}", "force[i, 0] += fx", "force[i, 1] += fy"]
            body += [_particle_power(b)] if powers else []
        body += self._particle_rate_forces(powers)
        lines = [f"for i in range({span}):", *indented(body)]
        for b in self.loads:
            acting = f"{b.prefix}_on.shape[0]" if span == EVERY else _IN_BLOCK.format(f"block_{b.prefix}")
            lines += [
                f"for k in range({acting}):",
                f"    i = {b.prefix}_on[k]",
                f"    factor = {b.call}(time, {b.prefix}_values, {b.prefix}_first[k])",
                f"    force[i, 0] += factor * {b.prefix}_force[k, 0]",
                f"    force[i, 1] += factor * {b.prefix}_force[k, 1]",
            ]
            if powers:
                lines.append(f"    power_0 += {_load_power(b)}")
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

    def _rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.one_by_one() if self.form == FEW else loop.in_stages(self._is_float)

    def _short_rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.one_by_one()

    def _is_float(self, name: str) -> bool:
        """Whether an array with a row for each rod holds floating-point numbers."""
        if name == "direction":
            return True
        for b in self.bound:
            if name in b.arrays:
                return bool(b.arrays[name].dtype == np.float64)
        table, _, column = name.partition("_")
        return bool(np.dtype(self.model.tables[table].fields[column].storage) == np.float64)

    def _geometry(self) -> list[str]:
        """Elongation (2D + Δu)·Δu / (L + L_original) + misfit: no digits cancel.

        Where no rod is warm the misfit is L_original − L₀, and both are at hand. A rod whose ends meet has no
        direction and pulls nowhere, until something else parts them.
        """
        return [
            "dx = rods_difference[r, 0]",
            "dy = rods_difference[r, 1]",
            "x = dx + sx",
            "y = dy + sy",
            "original = rods_original_length[r]",
            "length = math.sqrt(x * x + y * y)",
            "inverse = 1.0 / length if length > 0.0 else 0.0",
            "nx = x * inverse",
            "ny = y * inverse",
            "both = length + original",
            "stretch = ((dx + x) * sx + (dy + y) * sy) / both if both > 0.0 else 0.0",
            f"elongation = stretch + {'rods_misfit[r]' if self.warm else '(original - rods_rest_length[r])'}",
        ]

    def _axial_force(self, *, without: Sequence[Bound] = ()) -> list[str]:
        lines = ["axial_force = 0.0"]
        for b in (b for b in self.rod_laws if b not in without):
            lines.append(f"axial_force {'=' if b.replaces else '+='} {self._apply(b, 'r')}")
        return lines

    def _rod_forces(self, commits: Sequence[Bound], powers: bool = False) -> RodLoop:
        compute, lost = self._commits(commits)
        if powers and self.working:
            compute += [*self._axial_force(without=self.working), "stored_force = axial_force"]
        compute += [*self._axial_force(), *_along_axis("pull", "axial_force")]
        forces = RodLoop(
            SHIFT,
            [*self._geometry(), *compute],
            ["pull_x", "pull_y", *lost],
            [*lost.values(), *_scatter("force", "pull")],
            [_column(b) for b in commits],
        )
        if not (self.rod_rates or (powers and self.working)):
            return forces
        direction = RodLoop({}, [], ["nx", "ny"], ["direction[r, 0] = nx", "direction[r, 1] = ny"])
        return forces + direction + self._rate_forces(powers)

    def _commits(self, commits: Sequence[Bound]) -> tuple[list[str], dict[str, str]]:
        """Lines that bring history up to date, and names of what is lost with lines that add it up.

        Those that take the axial force come last, when the others have changed it.
        """
        lines: list[str] = []
        lost = {}
        late = [b for b in commits if "axial_force" in b.parameters]
        for b in [*(b for b in commits if b not in late), *late]:
            lines += self._axial_force() if b in late[:1] else []
            lines.append(f"{_column(b)}[r], gone_{b.prefix} = {self._apply(b, 'r')}")
            lost[f"gone_{b.prefix}"] = f"lost_{b.slot} += gone_{b.prefix}"
        return lines, lost

    def _rate_forces(self, powers: bool = False) -> RodLoop:
        compute = [RATE, "damping_force = 0.0"]
        gains = {}
        for b in self.rod_rates:
            compute += [f"part = {self._apply(b, 'r')}", "damping_force += part"]
            if powers:
                gains[f"gain_{b.prefix}"] = (
                    f"power_{b.slot} {'-' if b.account == 'work' else '+'}= gain_{b.prefix}"
                )
                compute.append(f"gain_{b.prefix} = part * rate")
        if powers and self.working:
            gains["gain_working"] = "power_0 -= gain_working"
            compute.append("gain_working = (axial_force - stored_force) * rate")
        compute += _along_axis("drag", "damping_force")
        return RodLoop(
            DRIFT, compute, ["drag_x", "drag_y", *gains], [*gains.values(), *_scatter("resisting", "drag")]
        )

    def _resist(self) -> str:
        """Dampers and drag at a velocity, and what each account gains per second."""
        head = f"def resist({RESISTED}, power, {self._columns_text()}):"
        body = [*self._resistance(), *(f"power[{slot}] = power_{slot}" for slot in range(len(ACCOUNTS)))]
        return "\n".join(["@compiled", head, *indented(body)])

    def _resistance(self, span: str = EVERY) -> list[str]:
        body = [f"power_{slot} = 0.0" for slot in range(len(ACCOUNTS))]
        particles = self._particle_rate_forces(powers=True)
        for b in self.particle_laws:
            particles += [f"fx, fy = {self._apply(b, 'i')}", _particle_power(b)]
        if particles:
            body += [f"for i in range({span}):", *indented(particles)]
        if self.rod_rates or self.working:
            needed = {parameter for b in (*self.rod_rates, *self.working) for parameter in b.parameters}
            drag = self._rate_forces(powers=True)
            if self.working or needed & {"elongation", "axial_force"}:
                stored = [*self._axial_force(without=self.working), "stored_force = axial_force"]
                compute = [*(stored if self.working else []), *self._axial_force()]
                body += self._rod_loop(RodLoop(SHIFT, [*self._geometry(), *compute]) + drag)
            else:  # too little is computed to gain from stages
                axis = RodLoop({}, ["nx = direction[r, 0]", "ny = direction[r, 1]"])
                body += self._short_rod_loop(axis + drag)
        return body

    def _load_power(self) -> str:
        """What the varying loads do per second at a velocity."""
        body = ["power = 0.0"]
        for b in self.loads:
            body += [
                f"for k in range({b.prefix}_on.shape[0]):",
                f"    i = {b.prefix}_on[k]",
                f"    factor = {b.call}(time, {b.prefix}_values, {b.prefix}_first[k])",
                f"    power += {_load_power(b)}",
            ]
        head = f"def load_power(time, velocity, {self._columns_text()}):"
        return "\n".join(["@compiled", head, *indented([*body, "return power"])])

    # --- steps ------------------------------------------------------------------------------------

    def _integrate(self) -> str:
        """The driver's own function, or steps as it says that they begin and end for each particle.

        Inlined where it is called, once, the columns stay in registers.
        """
        if self.driver.kernel:
            return self._pasted(f"{self.driver.kernel}=integrate", "inlined")
        step = ["time = origin + (first + step) * dt", *self._move(), *self._enter_loads(), *self._complete()]
        head = (
            "def integrate(steps, first, origin, dt, displacement, velocity, force, resisting, direction,"
            f" predicted, power, gained, account, {self._columns_text()}):"
        )
        lines = ["for step in range(1, steps + 1):", *indented(step), *self._finish()]
        return "\n".join(["@inlined", head, *indented(lines)])

    def _move(self) -> list[str]:
        """To the next displacement; its forces."""
        accept = f"accept({PREDICTED}, account, {self._columns_text()})"
        return [*self._particles(self.driver.begins), accept]

    def _complete(self) -> list[str]:
        """To the next velocity; what resists it."""
        return [*self._particles(self.driver.ends), *(self._enter_powers("resist") if self.powers else [])]

    def _finish(self) -> list[str]:
        """What is left to do after many steps."""
        return []

    def _particles(self, where: str, span: str = EVERY) -> list[str]:
        """What a driver does with every particle."""
        lines = self._body_of(where)
        return [f"for i in range({span}):", *indented(lines)] if lines else []

    def _body_of(self, where: str) -> list[str]:
        function = ast.parse(_source_of(find(where, self.driver))).body[0]
        assert isinstance(function, ast.FunctionDef)
        told = ast.get_docstring(function) is not None
        return ast.unparse(function.body[told:]).splitlines()  # type: ignore[arg-type]

    def _enter_loads(self) -> list[str]:
        """The work of varying loads, their mean force times the displacement of the step."""
        if not self.loads:
            return []
        columns = self._columns_text()
        return [
            "began = origin + (first + step - 1) * dt",
            f"before = load_power(began, velocity, {columns})",
            f"after = load_power(time, velocity, {columns})",
            "account[0] += 500.0 * dt * (before + after)",
        ]

    def _enter_powers(self, resist: str, given: str = RESISTED) -> list[str]:
        """What each account gains in the step that ends here, by the trapezoidal rule."""
        return [
            f"{resist}({given}, gained, {self._columns_text()})",
            f"for k in range({len(ACCOUNTS)}):",
            "    account[k] += 500.0 * dt * (power[k] + gained[k])",
            "    power[k] = gained[k]",
        ]

    # --- reading ----------------------------------------------------------------------------------

    def _measure(self) -> str:
        """Energies, residual and scales of an accepted state, for judge(); those of what sleeps are in the last 8."""
        body = [
            "kinetic = 0.0",
            "power_norm = 0.0",
            "power = 0.0",
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
            "            power += total * velocity[i, d]",
            "            residual = max(residual, abs(force[i, d]))",
            "        largest = max(largest, abs(particles_constant_force[i, d]))",
            "        moved = max(moved, abs(displacement[i, d]))",
            "elastic = 0.0",
            "stiffest = 0.0",
            *self._stored().one_by_one(),
            "measures[0] = measures[8] + 0.5 * kinetic",
            "measures[1] = measures[9] + 1000.0 * power_norm",
            "measures[2] = measures[10] + 500.0 * elastic",
            "measures[3] = measures[11] + 1000.0 * potential",
            "measures[4] = max(measures[12], residual)",
            "measures[5] = max(measures[13], largest)",
            f"measures[6] = max(measures[14], {ROUND_OFF} * stiffest * moved)",
            "measures[7] = measures[15] + 1000.0 * power",
        ]
        head = f"def measure(displacement, velocity, force, resisting, measures, {self._columns_text()}):"
        return "\n".join(["@compiled", head, *indented(body)])

    def _stored(self) -> RodLoop:
        compute = [
            *self._geometry(),
            *self._axial_force(without=self.working),
            "flexibility = rods_rest_length[r] / rods_stiffness[r]",
            "largest = max(largest, abs(axial_force))",
            "stiffest = max(stiffest, 1.0 / flexibility)",
        ]
        return RodLoop(SHIFT, compute, scatter=["elastic += axial_force * axial_force * flexibility"])

    @property
    def _observed_forces(self) -> str:
        return f"forces({FORCED}, {self._columns_text()})"

    def _observe(self) -> str:
        """The derived columns of rods and particles, and the measures, at a state.

        A rod yields where its axial force is at its strength, but for round-off.
        """
        columns = self._columns_text()
        body = [
            f"external(time, dt, displacement, velocity, applied, resisting, {columns})",
            self._observed_forces,
            f"measure(displacement, velocity, force, resisting, measures, {columns})",
            "for i in range(displacement.shape[0]):",
            "    for d in range(2):",
            "        reaction[i, d] = 0.0 - (force[i, d] + resisting[i, d]) if fixed[i, d] else 0.0",
            *RodLoop(
                SHIFT,
                [
                    *self._geometry(),
                    *self._axial_force(),
                    "rods_axial_force[r] = axial_force",
                    "rods_length[r] = length",
                    "rods_strain[r] = elongation / rods_rest_length[r]",
                    f"low, high = {-_AT_STRENGTH} * compression[r], {_AT_STRENGTH} * tension[r]",
                    "yielding[r] = yields and (axial_force >= high or axial_force <= low)",
                ],
            ).one_by_one(),
        ]
        head = (
            "def observe(time, dt, displacement, velocity, applied, reaction, force, resisting, direction, power,"
            " measures, rods_axial_force, rods_length, rods_strain, yielding, fixed, tension, compression, yields,"
            f" {columns}):"
        )
        return "\n".join(["@entered", head, *indented(body)])

    def _commit(self) -> str:
        """The commits at a state that no step has led to."""
        arguments = f"{FORCED}, account, {self._columns_text()}"
        return f"@entered\ndef commit({arguments}):\n    accept({arguments})"

    def _pasted(self, where: str, decorator: str) -> str:
        """A driver's source, "module:function" or with "=new name", the model's columns for *columns."""
        where, _, name = where.partition("=")
        function = find(where, self.driver)
        source = _source_of(function).replace("*columns", self._columns_text())
        return f"@{decorator}\n" + source.replace(
            f"def {function.__name__}(", f"def {name or function.__name__}(", 1
        )


def read_sources(drivers: Iterable[Driver]) -> None:
    """Find the sources of drivers ahead of need; those of one take some frames."""
    for driver in drivers:
        for part in (driver.kernel, driver.begins, driver.ends, driver.entry, *driver.parts):
            if isinstance(part, str) and part:
                _source_of(find(part.partition("=")[0], driver))


@cache
def _source_of(function: Callable[..., Any]) -> str:
    """Its source, which takes a millisecond to find."""
    return textwrap.dedent(inspect.getsource(function))


def _particle_power(b: Bound) -> str:
    sign = "+" if b.account == "work" else "-"
    return f"power_{b.slot} {sign}= fx * velocity[i, 0] + fy * velocity[i, 1]"


def _load_power(b: Bound) -> str:
    return f"factor * ({b.prefix}_force[k, 0] * velocity[i, 0] + {b.prefix}_force[k, 1] * velocity[i, 1])"


def _column(commit: Bound) -> str:
    """The column that a commit writes, as the program names it."""
    return commit.system.writes[0].replace(".", "_", 1)


def _along_axis(name: str, amount: str) -> list[str]:
    return [f"{name}_x = {amount} * nx", f"{name}_y = {amount} * ny"]


def _scatter(target: str, name: str) -> list[str]:
    return [
        f"{target}[a, 0] += {name}_x",
        f"{target}[a, 1] += {name}_y",
        f"{target}[b, 0] -= {name}_x",
        f"{target}[b, 1] -= {name}_y",
    ]


def _literal(value: Any) -> str:
    return f"np.array({value.tolist()!r})" if isinstance(value, np.ndarray) else repr(value)


def _of_energy() -> dict[str, Callable[..., Any]]:
    from systems.physics.kernels import conserved, judge  # imports numba, when a program is built, not before

    return {"conserved": conserved, "judge": judge}


def _is_elastic(b: Bound) -> bool:
    return isinstance(b.system, Law) and b.system.elastic
