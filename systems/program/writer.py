"""The source of a step program: laws, commits and an integrator of one plan, as one flat module.

What is the same for all plans is pasted from systems/program/templates; this module writes the rest, which depends
on the plan: which kernels are called for each particle and rod, with which columns, and where their energy goes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from pinjoint.components.model import Model
from pinjoint.components.particle import is_sprung
from pinjoint.components.rod import (
    AT_STRENGTH,
    bears_between,
    bends,
    is_kinked,
    is_warm,
    is_warped,
    turned_between,
)
from pinjoint.systems import is_ours
from pinjoint.systems.base import MOST_PARTS, REVIEW_INTERVAL, Event, Integrator, StepSystem, StopReason
from pinjoint.systems.collision.driven.columns import Order, Real, Whole
from pinjoint.systems.collision.kernels.grid import are_listed
from pinjoint.systems.physics.automatic import SMALL
from pinjoint.systems.physics.kernels import conserved, judge
from pinjoint.systems.plasticity.hinges import CLOSE, FIRM, MOST_TRIALS, narrowed, softening
from pinjoint.systems.program.binding import (
    HISTORIES,
    PROVIDED,
    TRIAL,
    TURNING,
    Bound,
    ProgramError,
    StepRole,
    bind,
    by_role,
    check_names,
    find,
    written_row,
)
from pinjoint.systems.program.entries import ACCOUNTS, Account, Control, Mark, Measure, Search, Side
from pinjoint.systems.program.interpreter import plain_function
from pinjoint.systems.program.loops import ALL, RodLoop
from pinjoint.systems.program.near_pairs import ARRAYS
from pinjoint.systems.program.pasting import Insert, expanded, fragment, indented, pasted, source_of
from pinjoint.systems.program.templates import driven, events, fixed_steps, forces, observing, rods, steps

# --- what programs call things ---------------------------------------------------------------------

ALWAYS = (  # columns of every program
    "particles_mobility",
    "particles_mass",
    "particles_constant_force",
    "rods_between",
    "rods_difference",
    "rods_original_length",
    "rods_rest_length",
    "rods_stiffness",
)
OBSERVED = (
    *("rods_axial_force", "rods_length", "rods_strain", "yielding"),  # written
    *("fixed", "tension", "compression", "yields"),  # read
)
OF_BENDING = (  # columns of models that bend
    *("particles_masses", "per_arm", "lever"),
    *("rods_turning_shares", "rods_bowing", "rods_end_stiffness"),
)
PUSHED = ("support", "unpushed")  # arrays of programs whose particles may meet
STATE = ("displacement", "velocity", "force", "resisting", "direction")
EVERY = "displacement.shape[0]"  # particles

# What functions take before the columns.
TRIAL_STATE = "time, dt, *state"
PREDICTED = "time, dt, displacement, predicted, *forces"
RESISTED = "time, dt, displacement, velocity, resisting, direction"

_OF_PAIR = {  # what kernels of pairs are provided with
    "apart": "(x, y)",
    "drift": "(velocity[j, 0] - velocity[i, 0], velocity[j, 1] - velocity[i, 1])",
}

NO_POWER = tuple(f"power_{name} = 0.0" for name in ACCOUNTS)
POWER_RETURNED = tuple(f"power[Account.{name.upper()}] = power_{name}" for name in ACCOUNTS)

# -------------------------------------------------------------------------------------------------

FEW, MANY, VERY_MANY = "few", "many", "very many"  # rods: what is quickest for some is not for others
BLOCKS_FROM = 20_000  # rods: below, cores wait for each other longer than they help

_HEAD = '''\
"""A step program: the laws and the integrator of one plan as one module. Generated; safe to delete.

Python calls three functions: advance() takes steps, observe() reads a state, commit() brings history up to date
after an edit (where anything has a history). advance() comes first, then what it calls, from the loop over steps
down to the kernels of one rod; constants come last. Functions hand on arrays one by one, since tuples would cost
twice as much; systems/program/templates/__init__.py says what each array is.

Put in by name are

{kernels}
"""

import math

import numpy as np

from pinjoint.systems.program.kernel import compiled, kept, part

inlined = part(forceinline=True)
entered = kept(no_cfunc_wrapper=True, _nrt={may_allocate})  # nobody calls them by address
'''


_TRAITS = {  # of a whole model
    "warm": is_warm,
    "bends": bends,
    "loaded": bears_between,
    "turned": turned_between,
    "warped": is_warped,
    "sprung": is_sprung,
    "kinked": is_kinked,
}


def kind_of(model: Model, integrator: Integrator, systems: Sequence[StepSystem]) -> tuple[str, ...]:
    """What says which program a plan gets: integrator, form, traits of the model, systems."""
    traits = " ".join(name for name, has in _TRAITS.items() if has(model))
    return integrator.key, form_of(model, integrator, systems), traits, *(system.name for system in systems)


def form_of(model: Model, integrator: Integrator, systems: Iterable[StepSystem] = ()) -> str:
    """The form of program that suits a model: rod by rod, in stages, or in blocks shared by cores.

    Rod by rod the programs of controlled steps are the quickest at any size, and take half as long to compile. Events
    look at all rods after each step, and laws of pairs at all particles, in the order of the model.
    """
    if integrator.controlled or model.rods.count <= SMALL:
        return FEW
    whole = any(isinstance(s, Event) or getattr(s, "each", "") == "pairs" for s in systems)
    return MANY if whole or model.rods.count < BLOCKS_FROM else VERY_MANY


class Writer:
    """Writes the source of one step program from the bound systems of a plan.

    names: what the source refers to, kernels and enumerations. rates: something depends on velocity. powers: some
    account gains by the step. working: laws of rods whose force is no part of the elastic energy. rows: those of rods that
    one loop of a step goes over: the first, and that after the last. zeros: what stands for columns that hold nothing else,
    which would cost a step of a large frame a twelfth.
    """

    rows = ALL

    def __init__(self, model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> None:
        self.model = model
        self.form = form
        self.integrator = integrator
        traits = (has(model) for has in _TRAITS.values())
        self.warm, self.bends, self.loaded, self.turned, warped, self.sprung, self.kinked = traits
        self.zeros = {} if warped else {"rods_initial_slopes": "(0.0, 0.0)"}
        self.coordinates = 3 if self.bends else 2
        self.collides = any(system.impulsive for system in systems)
        self.shift = {f"s{d}": f"displacement[b, {i}] - displacement[a, {i}]" for i, d in enumerate("xy")}
        self.drift = {f"drift_{d}": f"velocity[b, {i}] - velocity[a, {i}]" for i, d in enumerate("xy")}
        if self.bends:
            self.shift |= {f"turn_{end}": f"displacement[{end}, 2] * per_arm[0]" for end in "ab"}
            self.drift |= {f"spin_{end}": f"velocity[{end}, 2] * per_arm[0]" for end in "ab"}
        bound = (bind(system, model) for system in systems if system.kernel)
        self.bound = [b for b in bound if self.bends or b.each not in ("ends", "rotations")]
        check_names(self.bound)
        self.of = by_role(self.bound)
        self.slips = self.of[StepRole.SLIPS][-1:]
        self.commits = [b for role in HISTORIES for b in self.of[role]]
        self.events = self.of[StepRole.EVENT]
        self.branching = [b.system for b in self.bound if getattr(b.system, "margin", "")]
        self.names: dict[str, Callable[..., Any]] = {b.call: b.function for b in self.bound}
        self.names |= {"conserved": conserved, "judge": judge}
        kinds = [Account, Control, Mark, Measure, Search, Side, StopReason]
        kinds += [Order, Real, Whole] if self.collides else []
        self.names |= {kind.__name__: kind for kind in kinds}
        self.pairs = [*self.of[StepRole.PAIR_FORCE], *self.of[StepRole.PAIR_RESISTANCE]]
        self.ends = [*self.of[StepRole.ENDS], *self.of[StepRole.RATE_OF_ENDS]]
        could_store = [*self.pairs, *self.of[StepRole.ENDS], *self.of[StepRole.REPLACING]]
        conservative = [b.system for b in could_store if getattr(b.system, "potential", "")]
        self.potentials = {system.name: bind(system, model, "potential") for system in conservative}
        self.names |= {b.call: b.function for b in self.potentials.values()}
        self.rates = bool(
            self._damps
            or self.of[StepRole.RESISTANCE]
            or self.of[StepRole.PAIR_RESISTANCE]
            or self.of[StepRole.TURNING]
        )
        in_rods = [*self.of[StepRole.SUMMED], *self.of[StepRole.REPLACING]]
        for b in in_rods if self.slips else ():
            if not {"time", "dt"}.isdisjoint(b.parameters):
                raise ProgramError(
                    "{system} makes axial forces that change with time, beside which no plastic hinges are known; leave it"
                    " out, or the plastic moments of rods.",
                    b.system,
                    system=b.system.name,
                )
        self.working = [b for b in in_rods if not getattr(b.system, "elastic", False)]
        self.working_ends = [b for b in self.of[StepRole.ENDS] if b.system.name not in self.potentials]
        stored = sum(b.system.name in self.potentials for b in self.pairs)
        pushing = bool(self.of[StepRole.PARTICLE_FORCE]) or stored < len(self.pairs)
        self.powers = self.rates or pushing or bool(self.working) or bool(self.working_ends)
        # All arrays that the functions read or write besides the integrator's own.
        self.columns = [*ALWAYS, *(["rods_misfit"] if self.warm else []), *(OF_BENDING if self.bends else ())]
        self.columns += ["rods_span_load"] if self.loaded else []
        self.columns += ["particles_support_springs"] if self.sprung else []
        self.columns += ["rods_plastic_rotation"] if self.kinked else []
        self._add_columns([*self.bound, *self.potentials.values()])
        if self.pairs:
            self.columns = list(dict.fromkeys([*self.columns, "particles_position", *ARRAYS]))
            self.names["are_listed"] = are_listed
        if self.collides:
            self.columns += PUSHED
        if self.slips:
            self.columns = list(dict.fromkeys([*self.columns, "rods_moment_limit", "rods_bending_stiffness"]))
            self.names |= {"softening": softening, "narrowed": narrowed}

    @property
    def kernels(self) -> list[Bound]:
        """All kernels of the systems, which are tried one by one if the program does not compile."""
        return [*self.bound, *self.potentials.values()]

    def _add_columns(self, bound: Iterable[Bound]) -> None:
        names = dict.fromkeys(self.columns)
        for b in bound:
            if b.role is StepRole.LOAD:
                names.update(dict.fromkeys(f"{b.prefix}_{part}" for part in ("on", "force", "values", "first")))
            else:
                known = PROVIDED | {*TRIAL, *(TURNING if self.bends else ()), *self.zeros}
                taken = (p for p in b.parameters if p not in known)
                names.update(dict.fromkeys(b.stored(p) if p in b.arrays else p for p in taken))
            if b.role is StepRole.EVENT:
                names[b.sides] = None
        self.columns = list(names)

    # --- templates --------------------------------------------------------------------------------

    @cached_property
    def _inserts(self) -> dict[str, Insert]:
        """What is known in every template: which lines it keeps, and what stands for some words."""
        return {
            "ALIKE": not self.integrator.controlled,
            "BENDS": self.bends,
            "KINKED": self.kinked,
            "SLIPS": bool(self.slips),
            "FORESEES": bool(self.of[StepRole.LOAD]) and not self.integrator.controlled,
            "LOADED": self.loaded,
            "LOADS": bool(self.of[StepRole.LOAD]),
            "MEETS": self.collides,
            "POWERS": self.powers,
            "SPRUNG": self.sprung,
            "TURNED": self.turned,
            "WARM": self.warm,
            "mass": "particles_masses[i, d]" if self.bends else "particles_mass[i]",
        }

    def function(self, template: Callable[..., Any], decorator: str, name: str = "", **inserts: Insert) -> str:
        """A template as a function of the program, under its own or another name."""
        return pasted(template, decorator, name, **(self._inserts | inserts))

    def lines(self, template: Callable[..., Any], **inserts: Insert) -> list[str]:
        """The lines of a template."""
        return fragment(template, **(self._inserts | inserts))

    # --- expressions ------------------------------------------------------------------------------

    def _argument(self, b: Bound, parameter: str, index: str) -> str:
        """How a kernel's parameter is written inside the loop over its rows, or over pairs of particles i and j."""
        if parameter in PROVIDED:
            return _OF_PAIR.get(parameter, parameter)
        if parameter in self.zeros:
            return self.zeros[parameter]
        if parameter in TURNING and self.bends:
            return f"{TURNING[parameter]}[{index}, 2] * per_arm[0]"
        name, single = TRIAL.get(parameter, parameter), False
        if parameter in b.arrays:
            name, shape = b.stored(parameter), b.arrays[parameter].shape[1:]
        else:
            table, _, column = parameter.partition("_")
            single = self.model.tables[table].kind.single
            shape = self.model.tables[table].fields[column].shape
            index = "0" if single else index
        if b.each == "pairs" and not single:
            return f"({written_row(name, 'i', shape)}, {written_row(name, 'j', shape)})"
        return written_row(name, index, shape)

    def _apply(self, b: Bound, index: str) -> str:
        return f"{b.call}({', '.join(self._argument(b, p, index) for p in b.parameters)})"

    # --- the module -------------------------------------------------------------------------------

    def source(self) -> str:
        """The program's source."""
        parts = [
            self._head(),
            *([self._drive()] if self.collides else []),
            self.function(
                steps.advance,
                "compiled" if self.collides else "entered",
                "",
                force="unpushed" if self.collides else "force",
                **self._steps(),
            ),
            *(self.function(part, "inlined") for part in (steps.aim, steps.is_check_due)),
            *(self._pasted(part, "inlined") for part in reversed(self.integrator.parts)),
            *self._of_steps(),
            *([self._slipping] if self.slips else []),
            self.function(forces.external, "compiled", particle_forces=self._particle_forces()),
            self._measure(),
            self._observe(),
            *([self.function(forces.commit, "entered")] if self.commits else []),
            "".join(f"{name} = {_literal(value)}\n" for name, value in self._values().items()),
        ]
        return expanded("\n\n\n".join(part.rstrip() for part in parts), self.groups)

    @property
    def groups(self) -> dict[str, Sequence[str]]:
        """The arguments that stand for one word in templates."""
        return {
            "state": STATE,
            "forces": STATE[2:],
            "scratch": self.scratch,
            "bounds": ("breaks", "until", "landing"),
            "kept": (*(f"kept_{name}" for name in self.kept), "own_acceleration", "own_support", "every"),
            "observed": (*OBSERVED, *(["rods_end_moment"] if self.bends else [])),
            "columns": self.columns,
            "needed": [name for name in self.columns if re.search(rf"\b{name}\b", self._slipping)],
        }

    @property
    def scratch(self) -> tuple[str, ...]:
        """Arrays that steps write to and nobody reads afterwards."""
        return ("predicted", "power", "gained")

    @property
    def written(self) -> dict[str, str]:
        """The columns that commits write, "table.field", by their names in the program."""
        return {_column(b): b.system.writes[0] for b in self.commits}

    @property
    def kept(self) -> list[str]:
        """What steps change besides the state of the particles, the clock and the account, and the state where it turns."""
        changed = "unpushed", "resisting", "power", *self.written, *(b.sides for b in self.events)
        return [*changed, *(STATE[:2] if self.bends else ())]

    def _drive(self) -> str:
        """The function by which steps are entered where particles may meet."""
        return self.function(
            driven.drive,
            "entered",
            "",
            keep=self._copies("kept_{0}", "{0}"),
            put_back=self._copies("{0}", "kept_{0}"),
            present=self.lines(forces.present),
            take=self.lines(driven.take),
        )

    def _copies(self, to: str, of: str) -> list[str]:
        """Lines that keep what steps change, or put it back."""
        lines = []
        for name in self.kept:
            whole = [f"r, {d}" for d in range(self.coordinates)]
            places = whole if name in ("unpushed", "resisting") else whole[2:] if name in STATE else ["r"]
            places = self._places(name) if name in self.written else places
            copies = (f"    {to.format(name)}[{place}] = {of.format(name)}[{place}]" for place in places)
            lines += [f"for r in range({name}.shape[0]):", *copies]
        return lines

    def _pushes(self) -> list[str]:
        """The lines by which contact forces are added to all others."""
        return self.lines(driven.push) if self.collides else []

    def _head(self) -> str:
        kernels = "\n".join(f"    {name} = {_origin(function)}" for name, function in self.names.items())
        return _HEAD.format(kernels=kernels, may_allocate=self._may_allocate)

    def _values(self) -> dict[str, Any]:
        """The constants of the module."""
        return {
            "D": self.coordinates,
            "RATES": self.rates,
            "POWERS": self.powers,
            "LOADS": bool(self.of[StepRole.LOAD]),
            "STOPS": bool(self.events),
            "EVENTS": False,
            "EPSILON": sys.float_info.epsilon,  # round-off of forces, relative to stiffness × displacement
            "SLACK": 1e-12,  # share of the time to go by which the end of a fixed step may be late
            "SHADOW": float(self.integrator.guard),
            "CHECK_INTERVAL": self.integrator.check_interval,
            "MOST_PARTS": MOST_PARTS,
            "REVIEW_INTERVAL": REVIEW_INTERVAL,
            **({"CLOSE": CLOSE, "FIRM": FIRM, "MOST_TRIALS": MOST_TRIALS} if self.slips else {}),
            **self.integrator.constants,
        }

    @property
    def _may_allocate(self) -> bool:
        """True if it may ask for memory, as stages do and kernels of mods may; a call is 2 µs slower then."""
        own = all(is_ours(named.__module__) for named in self.names.values())
        return self.form != FEW or not own

    def _pasted(self, where: str, decorator: str) -> str:
        """A template of the integrator, "module:function" or with "=new name"."""
        where, _, name = where.partition("=")
        return self.function(find(where, self.integrator), decorator, name)

    def _each_coordinate(self, line: str) -> list[str]:
        """A line for every coordinate {0} of a particle."""
        return [line.format(d) for d in range(self.coordinates)]

    def _of_steps(self) -> list[str]:
        """Functions that the integrator's templates call."""
        loads = [
            line
            for b in self.of[StepRole.LOAD]
            for line in self._each_load(b, f"power += {self._load_power(b)}")
        ]
        return [
            self._forces("accept", self.commits),
            self._forces("forces", []),
            self._resist(),
            self.function(forces.load_power, "compiled", loads=loads),
            *self._happened(),
        ]

    # --- particles --------------------------------------------------------------------------------

    def _particle_forces(self, powers: bool = False, span: str = EVERY) -> list[str]:
        """Forces on the particles from outside, and of the laws that resist their motion."""
        held = " - particles_support_springs[i, {0}] * displacement[i, {0}]" * self.sprung
        body = self._each_coordinate(f"force[i, {{0}}] = particles_constant_force[i, {{0}}]{held}")
        for b in self.of[StepRole.PARTICLE_FORCE]:
            body += [f"fx, fy = {self._apply(b, 'i')}", "force[i, 0] += fx", "force[i, 1] += fy"]
            body += [_particle_power(b)] if powers else []
        body += self._particle_resistance(powers)
        lines = [f"for i in range({span}):", *indented(body)]
        for b in self.of[StepRole.LOAD]:
            push = [
                *self._each_coordinate(f"force[i, {{0}}] += factor * {b.prefix}_force[k, {{0}}]"),
                *([f"power_work += {self._load_power(b)}"] if powers else []),
            ]
            lines += self._each_load(b, *push, within="" if span == EVERY else f"block_{b.prefix}")
        return lines + self._each_pair((b, self._pair_forces(b, powers)) for b in self.pairs)

    def _each_pair(self, lines: Iterable[tuple[Bound, Sequence[str]]]) -> list[str]:
        """A loop over the pairs of particles, with the lines of each law for those within its cutoff."""
        laws: list[str] = []
        for b, own in lines:
            laws += [f"if squared < pair_reach[{2 + self.pairs.index(b)}]:", *indented(own)] if own else []
        return self.lines(forces.each_pair, laws=laws) if laws else []

    def _pair_forces(self, b: Bound, powers: bool) -> list[str]:
        """Lines that add the force of a law to those on both particles."""
        target = "force" if b.role is StepRole.PAIR_FORCE else "resisting"
        return [
            f"fx, fy = {self._apply(b, 'i')}",
            *(f"{target}[i, {d}] += f{axis}" for d, axis in enumerate("xy")),
            *(f"{target}[j, {d}] -= f{axis}" for d, axis in enumerate("xy")),
            *(self._pair_power(b) if powers else []),
        ]

    def _load_power(self, b: Bound) -> str:
        """What a load does per second at its factor."""
        parts = self._each_coordinate(f"{b.prefix}_force[k, {{0}}] * velocity[i, {{0}}]")
        return f"factor * ({' + '.join(parts)})"

    @staticmethod
    def _each_load(b: Bound, *lines: str, within: str = "") -> list[str]:
        """Lines for every load `k` on a particle `i`, in a block of them or in all."""
        acting = f"{within}[block], {within}[block + 1]" if within else f"{b.prefix}_on.shape[0]"
        return [
            f"for k in range({acting}):",
            f"    i = {b.prefix}_on[k]",
            f"    factor = {b.call}(time, {b.prefix}_values, {b.prefix}_first[k])",
            *indented(lines),
        ]

    def _particle_resistance(self, powers: bool = False) -> list[str]:
        if not self.rates:
            return []
        body = self._each_coordinate("resisting[i, {0}] = 0.0")
        for b in self.of[StepRole.RESISTANCE]:
            body += [f"fx, fy = {self._apply(b, 'i')}", "resisting[i, 0] += fx", "resisting[i, 1] += fy"]
            body += [_particle_power(b)] if powers else []
        for b in self.of[StepRole.TURNING]:
            body += [f"turned = {self._apply(b, 'i')} * per_arm[0]", "resisting[i, 2] += turned"]
            gain = f"power_{b.account} {_sign(b, '+', '-')}= turned * velocity[i, 2]"
            body += [gain] if powers else []
        return body

    # --- rods -------------------------------------------------------------------------------------

    def _rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.one_by_one(self.rows) if self.form == FEW else loop.in_stages(self._is_float, self.rows)

    def _is_float(self, name: str) -> bool:
        """Whether an array with a row for each rod holds floating-point numbers."""
        if name == "direction":
            return True
        for b in self.bound:
            if name in b.stored_arrays:
                return bool(b.stored_arrays[name].dtype == np.float64)
        table, _, column = name.partition("_")
        return bool(np.dtype(self.model.tables[table].fields[column].storage) == np.float64)

    def geometry(self) -> list[str]:
        """Lines that give elongation, length and direction of a rod, and the slopes of its ends."""
        return self.lines(rods.geometry, unslipped=self._unslipped() if self.slips else [])

    def _unslipped(self) -> list[str]:
        """Lines that give the axial force and the end moments of a rod whose ends do not slip."""
        law = self.end_laws(self.of[StepRole.ENDS], "moment")
        return [*self._axial_force(), *self.lines(rods.end_moments, law=law, SLIPS=False)]

    @cached_property
    def _slipping(self) -> str:
        """The function that tells how far the ends of a rod slip; "" where none can."""
        if not self.slips:
            return ""
        rows = {name: written_row(f"rods_{name}", "r", (3,)) for name in ("end_stiffness", "bowing")}
        laws = {"unslipped": self._unslipped(), "axial_force": self._axial_force()}
        slips = self._apply(self.slips[0], "r")
        return self.function(rods.slipping, "compiled", "", slips=slips, **laws, **rows)

    def rate(self, *, of_axis: bool = False) -> list[str]:
        """Lines that give how fast a rod grows longer, and how fast its slopes grow; of_axis: also of the bowed axis."""
        return self.lines(rods.rate, OF_AXIS=of_axis)

    def end_laws(self, laws: Sequence[Bound], made: str, powers: bool = False) -> list[str]:
        """Lines that sum up the moments that laws give the ends of a rod; powers: and what each does per second."""
        lines = [f"{made}_start = 0.0", f"{made}_end = 0.0"]
        for b in laws:
            lines.append(f"part_start, part_end = {self._apply(b, 'r')}")
            lines += [f"{made}_start += part_start", f"{made}_end += part_end"]
            lines += [f"gain_{b.prefix} = part_start * rate_start + part_end * rate_end"] if powers else []
        return lines

    def end_moments(self) -> list[str]:
        """Lines that give the moments on the ends of a rod, dampers apart, once its axial force is known."""
        return self.lines(rods.end_moments, law=self.end_laws(self.of[StepRole.ENDS], "moment"))

    def _axial_force(self, *, without: Sequence[Bound] = ()) -> list[str]:
        lines = ["axial_force = 0.0"]
        lines += [f"axial_force += {self._apply(b, 'r')}" for b in self.of[StepRole.SUMMED] if b not in without]
        replacing = [b for b in self.of[StepRole.REPLACING] if b not in without]
        return lines + [f"axial_force = {self._apply(b, 'r')}" for b in replacing]

    def _working_forces(self) -> list[str]:
        """Lines that give the force that stores energy, then with the working laws of one account after the other."""
        lines = [*self._axial_force(without=self.working), "stored_force = axial_force"]
        later = list(self.working)
        for name in accounts_of(self.working)[:-1]:
            later = [b for b in later if b.account != name]
            lines += [*self._axial_force(without=later), f"force_{name} = axial_force"]
        return lines

    def _forces(self, name: str, commits: Sequence[Bound]) -> str:
        lines = self._with_losses(commits, self._rod_loop(self._rod_forces(commits)))
        return self.function(getattr(forces, name), "compiled", rod_forces=[*lines, *self._pushes()])

    @staticmethod
    def _with_losses(commits: Sequence[Bound], loop: Sequence[str]) -> list[str]:
        """A loop over the rods, between lines that begin and enter what is lost by history."""
        accounts = accounts_of(commits)
        entered = [f"account[Account.{name.upper()}] += 1000.0 * lost_{name}" for name in accounts]
        return [*(f"lost_{name} = 0.0" for name in accounts), *loop, *entered]

    def _rod_forces(self, commits: Sequence[Bound], powers: bool = False) -> RodLoop:
        compute, lost = self._histories(commits)
        if powers and self.working:
            compute += self._working_forces()
        compute += [*self._axial_force(), *_along_axis("pull", "axial_force")]
        made, scatter = ["pull_x", "pull_y"], _scatter("force", "pull")
        if self.bends:
            couple = " + couple" if self.loaded else ""
            compute += [*self.end_moments(), *_across_axis("pull", f"moment_start + moment_end{couple}")]
            made, scatter = [*made, "moment_start", "moment_end"], [*scatter, *_turn("force", "moment")]
        pull = RodLoop(
            self.shift,
            [*self.geometry(), *compute],
            [*made, *lost],
            [*lost.values(), *scatter],
            [_column(b) for b in commits],
        )
        if not (self._damps or (powers and (self.working or self.working_ends))):
            return pull
        direction = RodLoop({}, [], ["nx", "ny"], ["direction[r, 0] = nx", "direction[r, 1] = ny"])
        if self.bends:
            direction += RodLoop({}, [], ["inverse"], ["direction[r, 2] = inverse"])
        return pull + direction + self._dampers(powers)

    @property
    def _damps(self) -> bool:
        """Whether anything in rods depends on how fast they change."""
        return bool(self.of[StepRole.RATE] or self.of[StepRole.RATE_OF_ENDS])

    def _histories(self, commits: Sequence[Bound]) -> tuple[list[str], dict[str, str]]:
        """Lines that bring history up to date, and names of what is lost with lines that add it up."""
        lines: list[str] = []
        late = [b for b in commits if b.role is StepRole.LATE_HISTORY]
        for b in commits:
            lines += self._axial_force() if b in late[:1] else []
            made = [f"{_column(b)}[{place}]" for place in self._places(_column(b))]
            lines.append(f"{', '.join(made)}, gone_{b.prefix} = {self._apply(b, 'r')}")
        return lines, {f"gone_{b.prefix}": f"lost_{b.account} += gone_{b.prefix}" for b in commits}

    def _places(self, name: str) -> list[str]:
        """The indices of what a column that commits write holds of rod `r`."""
        shape = self.model.rods.fields[self.written[name].partition(".")[2]].shape
        return ["r, 0", "r, 1"] if shape else ["r"]

    def _dampers(self, powers: bool = False) -> RodLoop:
        """Forces that depend on how fast rods grow longer, and what the accounts gain by them per second."""
        compute = [*self.rate(of_axis=powers and bool(self.working)), "damping_force = 0.0"]
        of_axis = "axis_rate" if self.bends else "rate"
        gains = {}
        for b in self.of[StepRole.RATE]:
            compute += [f"part = {self._apply(b, 'r')}", "damping_force += part"]
            if powers:
                gains[f"gain_{b.prefix}"] = f"power_{b.account} {_sign(b, '-', '+')}= gain_{b.prefix}"
                compute.append(f"gain_{b.prefix} = part * rate")
        if powers:
            before, accounts = "stored_force", accounts_of(self.working)
            for name in accounts:
                force = "axial_force" if name == accounts[-1] else f"force_{name}"
                gains[f"taken_{name}"] = f"power_{name} {'-' if name == 'work' else '+'}= taken_{name}"
                compute.append(f"taken_{name} = ({force} - {before}) * {of_axis}")
                before = force
        compute += _along_axis("drag", "damping_force")
        made, scatter = ["drag_x", "drag_y"], _scatter("resisting", "drag")
        if self.bends:
            compute += self.end_laws(self.of[StepRole.RATE_OF_ENDS], "twist", powers)
            compute += _across_axis("drag", "twist_start + twist_end")
            made, scatter = [*made, "twist_start", "twist_end"], [*scatter, *_turn("resisting", "twist")]
            if powers:
                compute += self.end_laws(self.working_ends, "worked", powers) if self.working_ends else []
                for b in (*self.working_ends, *self.of[StepRole.RATE_OF_ENDS]):
                    gain = f"gain_{b.prefix}"
                    gains[gain] = f"power_{b.account} {_sign(b, '-', '+')}= {gain}"
        return RodLoop(self.drift, compute, [*made, *gains], [*gains.values(), *scatter])

    def _resist(self) -> str:
        return self.function(forces.resist, "compiled", resistance=[*self._resistance(), *POWER_RETURNED])

    def _resistance(self, span: str = EVERY) -> list[str]:
        body = [*NO_POWER]
        particles = self._particle_resistance(powers=True)
        for b in self.of[StepRole.PARTICLE_FORCE]:
            particles += [f"fx, fy = {self._apply(b, 'i')}", _particle_power(b)]
        if particles:
            body += [f"for i in range({span}):", *indented(particles)]
        body += self._each_pair((b, self._pair_resistance(b)) for b in self.pairs)
        acting = [*self.of[StepRole.RATE], *self.of[StepRole.RATE_OF_ENDS], *self.working, *self.working_ends]
        if acting:
            needed = {parameter for b in acting for parameter in b.parameters}
            drag = self._dampers(powers=True)
            working = self.working or self.working_ends
            if working or needed & {"elongation", "axial_force", "slope_start", "slope_end"}:
                compute = [*(self._working_forces() if self.working else []), *self._axial_force()]
                body += self._rod_loop(RodLoop(self.shift, [*self.geometry(), *compute]) + drag)
            else:  # too little is computed to gain from stages
                axis = RodLoop({}, ["nx = direction[r, 0]", "ny = direction[r, 1]"])
                axis += RodLoop({}, ["inverse = direction[r, 2]"] if self.bends else [])
                body += (axis + drag).one_by_one(self.rows)
        return body

    # --- steps ------------------------------------------------------------------------------------

    def _steps(self) -> dict[str, list[str]]:
        """What the loop over steps does with this integrator."""
        return {
            "present": self.lines(forces.present),
            "step": self.lines(fixed_steps.step, displacement=self._move(), velocity=self._accelerate()),
        }

    def _move(self) -> list[str]:
        """The lines that lead to the next displacement, and give its forces."""
        return [*self._particles(self.integrator.begins), f"accept({PREDICTED}, account, *columns)"]

    def _accelerate(self) -> list[str]:
        """The lines that lead to the next velocity, and give what resists it."""
        return [*self._particles(self.integrator.ends), *self._gains("resist", RESISTED)]

    def _particles(self, where: str, span: str = EVERY) -> list[str]:
        """A loop in which the integrator moves every particle; none where it has nothing to do."""
        if not where:
            return []
        lines = self.lines(find(where, self.integrator), total_force=self.lines(fixed_steps.total_force))
        return [f"for i in range({span}):", *indented(lines)]

    def _gains(self, resist: str, given: str) -> list[str]:
        """The lines by which each account gains in the step that ends here."""
        if not self.powers:
            return []
        powers = self.lines(fixed_steps.powers, accounts=str(len(ACCOUNTS)))
        return [f"{resist}({given}, gained, *columns)", *powers]

    # --- events -----------------------------------------------------------------------------------

    def _happened(self) -> list[str]:
        """The function that tells at the end of a step whether the quantity of an event changed sign."""
        lines: dict[str, list[str]] = {"rods": [], "particles": []}
        for place, b in enumerate(self.events):
            lines[b.each] += [
                *self._needed_force(b),
                *self.lines(
                    events.turn, sides=b.sides, quantity=self._apply(b, "r"), turned=self._turned(place)
                ),
            ]
        return [self.function(events.happened, "compiled", **self._each_row(lines))] if self.events else []

    def _turned(self, place: int) -> str:
        """The condition that the quantity of an event, `gap` on the side that it was on, changed sign in the step."""
        return "gap < 0.0"

    def _needed_force(self, b: Bound) -> list[str]:
        return self._axial_force() if "axial_force" in b.parameters else []

    def _each_row(self, lines: Mapping[str, list[str]], slipping: Sequence[str] = ()) -> dict[str, Any]:
        """Loops over the rods and over the particles with these lines, where there are any, for row `r`."""
        of_rods, of_particles = lines["rods"], lines["particles"]
        rate = [*self.rate(of_axis=True), *slipping, "rate = axis_rate"] if self.bends else self.rate()
        rod_loop = RodLoop(self.shift | self.drift, [*self.geometry(), *rate, *of_rods]).one_by_one()
        particle_loop = [f"for r in range({EVERY}):", *indented(of_particles)]
        return {"rods": rod_loop if of_rods else [], "particles": particle_loop if of_particles else []}

    # --- reading ----------------------------------------------------------------------------------

    def _measure(self) -> str:
        of_axes, energies = (
            [
                f"elastic += 2.0 * {self._apply(self.potentials[name], 'r')}"
                for name in names
                if name in self.potentials
            ]
            for names in ([b.system.name for b in laws] for laws in (self.of[StepRole.REPLACING], self.ends))
        )
        stored = self.lines(rods.stored, moments=self.end_moments(), of_axes=of_axes, energies=energies)
        compute = [*self.geometry(), *self._axial_force(without=self.working), *stored]
        return self.function(
            observing.measure,
            "compiled",
            rods=RodLoop(self.shift, compute).one_by_one(),
            pairs=self._each_pair((b, self._pair_energy(b)) for b in self.pairs),
        )

    def _pair_resistance(self, b: Bound) -> list[str]:
        """Lines that give the power of a law, and the force if it resists motion."""
        if b.role is StepRole.PAIR_RESISTANCE:
            return self._pair_forces(b, powers=True)
        power = self._pair_power(b)
        return [f"fx, fy = {self._apply(b, 'i')}", *power] if power else []

    def _pair_power(self, b: Bound) -> list[str]:
        """The line that adds what the force of a law does per second to two particles; none where a potential tells."""
        if b.system.name in self.potentials:
            return []
        slower = "velocity[i, {0}] - velocity[j, {0}]".format
        return [f"power_{b.account} {_sign(b, '+', '-')}= fx * ({slower(0)}) + fy * ({slower(1)})"]

    def _pair_energy(self, b: Bound) -> list[str]:
        """Lines that measure the energy of two particles and the force between them, as far as they follow from places."""
        lines = []
        if b.system.name in self.potentials:
            lines.append(f"potential -= {self._apply(self.potentials[b.system.name], 'i')}")
        if b.role is StepRole.PAIR_FORCE and not {"time", "dt"} & set(b.parameters):
            lines += [f"fx, fy = {self._apply(b, 'i')}", "largest = max(largest, abs(fx), abs(fy))"]
        return lines

    def _observe(self) -> str:
        observed = self.lines(rods.observed, at_strength=str(AT_STRENGTH), moments=self.end_moments())
        loop = RodLoop(self.shift, [*self.geometry(), *self._axial_force(), *observed])
        return self.function(observing.observe, "entered", rods=loop.one_by_one())


def read_sources(integrators: Iterable[Integrator]) -> None:
    """Find the sources of integrators ahead of need; those of one take some frames."""
    for one in integrators:
        for part in (one.begins, one.ends, *one.parts):
            if isinstance(part, str) and part:
                source_of(find(part.partition("=")[0], one))


def accounts_of(bound: Iterable[Bound]) -> list[str]:
    """The accounts of these, each once, in order."""
    theirs = {b.account for b in bound}
    return [name for name in ACCOUNTS if name in theirs]


def _sign(b: Bound, of_work: str, of_loss: str) -> str:
    return of_work if b.account == "work" else of_loss


def _particle_power(b: Bound) -> str:
    return f"power_{b.account} {_sign(b, '+', '-')}= fx * velocity[i, 0] + fy * velocity[i, 1]"


def _column(commit: Bound) -> str:
    """The column that a commit writes, as the program names it."""
    return commit.system.writes[0].replace(".", "_", 1)


def _along_axis(name: str, amount: str) -> list[str]:
    return [f"{name}_x = {amount} * nx", f"{name}_y = {amount} * ny"]


def _across_axis(name: str, moments: str) -> list[str]:
    """The force across the axis that keeps the balance with moments on the ends: V = (M_a + M_b)/L."""
    return [f"shear = ({moments}) * inverse", f"{name}_x += shear * ny", f"{name}_y -= shear * nx"]


def _turn(target: str, name: str) -> list[str]:
    """Moments on the ends of a rod act on its particles the other way."""
    return [f"{target}[a, 2] -= {name}_start * per_arm[0]", f"{target}[b, 2] -= {name}_end * per_arm[0]"]


def _scatter(target: str, name: str) -> list[str]:
    return [
        f"{target}[a, 0] += {name}_x",
        f"{target}[a, 1] += {name}_y",
        f"{target}[b, 0] -= {name}_x",
        f"{target}[b, 1] -= {name}_y",
    ]


def _literal(value: Any) -> str:
    return f"np.array({value.tolist()!r})" if isinstance(value, np.ndarray) else repr(value)


def _origin(function: Any) -> str:
    plain = plain_function(function)
    return f"{plain.__module__}.{plain.__qualname__}"
