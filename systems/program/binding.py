"""Step systems and their kernels, checked before they join a step program: names, parameters, roles."""

from __future__ import annotations

import importlib
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Role
from pinjoint.components.language import tr
from pinjoint.components.mistake import Explained
from pinjoint.components.model import Model
from pinjoint.components.table import read_only
from pinjoint.components.wording import is_identifier
from pinjoint.systems import is_ours
from pinjoint.systems.base import Commit, Event, Law, StepSystem
from pinjoint.systems.program.entries import ACCOUNTS
from pinjoint.systems.program.identity import reached_from, used_by
from pinjoint.systems.program.interpreter import plain_function

_TO_COMMITS = ("elongation", "axial_force", "time", "dt")
_OF_SLIPPING = ("moment_start", "moment_end")  # as if the ends did not slip
_OF_BRANCHES = (*_OF_SLIPPING, "gain_start", "gain_end", "thrust", "elongation", "rate", "dt")
_PROVIDED_TO: Mapping[str, tuple[str, ...]] = {  # by what the kernel is called for
    "rods": (*_TO_COMMITS, "rate"),
    "particles": ("time", "dt"),
    "pairs": ("apart", "drift", "time", "dt"),
    "potential": ("apart", "axial_force", "slope_start", "slope_end"),
    "ends": (
        *("slope_start", "slope_end", "axial_force", "rate_start", "rate_end", "time", "dt"),
        *(*_OF_SLIPPING, "limit_start", "limit_end", "thrust"),
    ),
    "rotations": ("time", "dt"),
    "commit": (*_TO_COMMITS, *_OF_SLIPPING, "slip_start", "slip_end"),
    "branch": _OF_BRANCHES,
    "margin": (*_OF_BRANCHES, "branch"),
    "event of rods": ("elongation", "rate", "axial_force"),
    "event of particles": (),
}
PROVIDED = {name for names in _PROVIDED_TO.values() for name in names}
TRIAL = {"particles_displacement": "displacement", "particles_velocity": "velocity"}
# Of models that bend.
TURNING = {"particles_rotation": "displacement", "particles_angular_velocity": "velocity"}

KERNELS = ("kernel", "branch", "margin", "potential")  # of a system, as its attributes

_WIDEST_ROW = 64  # numbers of an array that a kernel gets, as a tuple; more would take long to compile

_KINDS = ("rods", "ends", "particles", "rotations", "pairs", "loads")


class ProgramError(Explained, ValueError):
    """A step system that cannot join the program; the message names it, the reason and the remedy."""

    def __init__(self, message: str, system: StepSystem | None = None, /, **values: Any) -> None:
        super().__init__(message, **values)
        self.system = system


class StepRole(Enum):
    """How the result of a kernel enters a step, in the order in which the kernels follow from each other."""

    PARTICLE_FORCE = "adds to the force on a particle"
    RESISTANCE = "adds to the force that resists a particle's motion"
    PAIR_FORCE = "adds to the forces on two particles"
    PAIR_RESISTANCE = "adds to the forces that resist the motion of two particles"
    LOAD = "is the factor of a load"
    HISTORY = "is the history of a rod"
    SUMMED = "adds to the axial force of a rod"
    REPLACING = "replaces the axial force of a rod, which it is given"
    LATE_HISTORY = "is the history of a rod, by its axial force"
    RATE = "adds to the force of a rod's dampers"
    ENDS = "adds to the moments on the ends of a rod"
    RATE_OF_ENDS = "adds to the moments of dampers on the ends of a rod"
    SLIPS = "is how far the ends of a rod slip, by their moments"
    TURNING = "adds to the moment that resists a particle's turning"
    EVENT = "stops the run where it changes sign"


HISTORIES = (StepRole.HISTORY, StepRole.LATE_HISTORY)


@dataclass(frozen=True)
class Bound:
    """A step system with its kernel, the names of the kernel's parameters, and its own arrays by name.

    cutoff: of a law of pairs (m).
    """

    system: StepSystem
    function: Callable[..., Any]
    parameters: tuple[str, ...]
    arrays: Mapping[str, NDArray[Any]]
    kernel: str = "kernel"
    cutoff: float = math.inf

    @property
    def call(self) -> str:
        """The name of the kernel in the program."""
        return f"{self.kernel}_{self.prefix}"

    @property
    def is_ours(self) -> bool:
        """True if its kernel is Pinjoint's own."""
        return is_ours(plain_function(self.function).__module__)

    @property
    def prefix(self) -> str:
        """The system's name as a Python name."""
        return self.system.name.replace(".", "_")

    @property
    def sides(self) -> str:
        """The array that notes of each row whether the quantity of an event is negative."""
        return f"{self.prefix}_sides"

    def stored(self, name: str) -> str:
        """What the program calls one of its arrays: no other system's array, and nothing else there, is called so."""
        return name if name.startswith(f"{self.prefix}_") else f"{self.prefix}_{name}"

    @property
    def stored_arrays(self) -> dict[str, NDArray[Any]]:
        """Its own arrays, by their names in the program."""
        return {self.stored(name): array for name, array in self.arrays.items()}

    @property
    def each(self) -> str:
        """The table for each row of which the kernel of a law or an event is called; "" for other roles."""
        return self.system.each if isinstance(self.system, Law | Event) else ""

    @property
    def rows(self) -> str:
        """The table whose rows its kernel is given."""
        tables = {"pairs": "particles", "rotations": "particles", "ends": "rods", "": "rods"}
        return tables.get(self.each, self.each)

    @property
    def purpose(self) -> str:
        """The purpose of the kernel: a key of _PROVIDED_TO."""
        if isinstance(self.system, Event):
            return f"event of {self.each}"
        return (self.each or "commit") if self.kernel == "kernel" else self.kernel

    @property
    def account(self) -> str:
        """The account that the energy of its force belongs to."""
        return self.system.account if isinstance(self.system, Law | Commit) else ACCOUNTS[0]

    @property
    def follows_time(self) -> bool:
        """Whether its result changes with time while nothing moves. Loads are apart: their histories say when they end."""
        times = ("time",) if self.each else ("time", "dt")
        if isinstance(self.system, Commit) and self.system.notes:
            return False
        return self.each != "loads" and any(name in self.parameters for name in times)

    @property
    def follows_state(self) -> bool:
        """Whether its result stays the same as long as nothing moves on an island and nothing is edited; loads are apart."""
        others = self.arrays or any(parameter.startswith("clock_") for parameter in self.parameters)
        return self.each == "loads" or not (others or self.follows_time or self.each == "pairs")

    @property
    def role(self) -> StepRole:
        """How the result of its kernel enters a step; the kernel's parameters tell."""
        given = set(self.parameters)
        if isinstance(self.system, Event):
            return StepRole.EVENT
        if self.each == "loads":
            return StepRole.LOAD
        if self.each == "particles":
            return StepRole.RESISTANCE if "particles_velocity" in given else StepRole.PARTICLE_FORCE
        if self.each == "pairs":
            resists = given & {"drift", "particles_velocity"}
            return StepRole.PAIR_RESISTANCE if resists else StepRole.PAIR_FORCE
        if self.each == "ends" and "moment_start" in given:
            return StepRole.SLIPS
        if self.each == "ends":
            return StepRole.RATE_OF_ENDS if given & {"rate_start", "rate_end"} else StepRole.ENDS
        if self.each == "rotations":
            return StepRole.TURNING
        if self.each == "":
            return StepRole.LATE_HISTORY if "axial_force" in given else StepRole.HISTORY
        if "rate" in given:
            return StepRole.RATE
        return StepRole.REPLACING if "axial_force" in given else StepRole.SUMMED


def by_role(bound: Iterable[Bound]) -> dict[StepRole, list[Bound]]:
    """The laws, commits and events of each role, in the order of a step.

    Laws whose results add up go by name. The others, of which each takes the result of the one before, keep their
    order, the schedule's.
    """
    keep_order = (*HISTORIES, StepRole.REPLACING, StepRole.EVENT)
    found: dict[StepRole, list[Bound]] = {role: [] for role in StepRole}
    for b in bound:
        if isinstance(b.system, Law | Commit | Event):
            found[b.role].append(b)
    return {
        role: some if role in keep_order else sorted(some, key=lambda b: b.system.name)
        for role, some in found.items()
    }


def is_our_own(system: StepSystem) -> bool:
    """True if all kernels of a step system are Pinjoint's own; finding out loads none."""
    declared = [getattr(system, name, "") for name in KERNELS]
    modules = [
        k.partition(":")[0] if isinstance(k, str) else plain_function(k).__module__ for k in declared if k
    ]
    return all(map(is_ours, modules))


def bind(system: StepSystem, model: Model, kernel: str = "kernel") -> Bound:
    """Find a step system's kernel (or its `branch` or `margin`) and its parameters. Raises ProgramError."""
    try:
        return _bound(system, model, kernel)
    except ProgramError as error:
        error.system = system
        raise
    except Exception as error:
        if system.mod is None:
            raise
        raise ProgramError(
            "{system} cannot be read: {error}.",
            system,
            system=system.name,
            error=f"{type(error).__name__}: {error}",
        ) from error


def _bound(system: StepSystem, model: Model, kernel: str) -> Bound:
    _check_role(system, model)
    function = find(getattr(system, kernel), system)
    plain = getattr(function, "py_func", None)
    if plain is None:
        raise ProgramError(
            "The kernel of {system} is not compiled; put `@compiled` of pinjoint.api above it.",
            system=system.name,
        )
    if system.mod is not None and (chance := _source_of_chance(function)):
        raise ProgramError(
            "The kernel of {system} draws random numbers ({source}), so that no run could be repeated. Draw them"
            " before the run, with a seed, and hand them over by `arrays`.",
            system=system.name,
            source=chance,
        )
    parameters = tuple(inspect.signature(plain).parameters)
    arrays = {name: read_only(array) for name, array in system.arrays(model).items()}
    bound = Bound(system, function, parameters, arrays, kernel, _cutoff(system, model))
    for name, array in bound.arrays.items():
        if _is_column(name, model):
            raise ProgramError(
                "The array '{name}' of {system} has the name of a column; rename it.",
                name=name,
                system=system.name,
            )
        if not bound.is_ours and (column := _column_in(array, model)):
            raise ProgramError(
                "The array '{name}' of {system} is {column} itself, which steps write to while kernels read it; hand"
                " over a copy, or read the column.",
                name=name,
                system=system.name,
                column=column,
            )
    if bound.each != "loads":
        for parameter in bound.parameters:
            _check_parameter(bound, parameter, model)
    return bound


def _source_of_chance(kernel: Callable[..., Any]) -> str:
    """The first thing by which a kernel, or one that it calls, draws random numbers; "" if there is none."""
    for function in reached_from([kernel]):
        for name, value in {} if isinstance(function, type) else used_by(plain_function(function)).items():
            owner = getattr(value, "__self__", value)  # of functions such as random.random, a generator
            module = owner.__name__ if isinstance(owner, ModuleType) else type(owner).__module__
            if module == "random" or module.startswith("numpy.random"):
                return name
    return ""


def _column_in(array: NDArray[Any], model: Model) -> str:
    """The column that an array shares memory with, "table.field", or ""; the forms of a program would differ by it."""
    for table in model.tables.values():
        for field in table.fields_in(Role.DOCUMENT, Role.STATE):
            if np.may_share_memory(array, table.storage(field.name)):
                return f"{table.name}.{field.name}"
    return ""


def _cutoff(system: StepSystem, model: Model) -> float:
    """The cutoff of a law of pairs (m); infinite for others. Raises ProgramError."""
    if not (isinstance(system, Law) and system.each == "pairs"):
        return math.inf
    distance = system.cutoff(model)
    if not distance > 0.0:
        raise ProgramError(
            "The cutoff of {system} is {distance}; give a distance above 0 m, or math.inf for all pairs.",
            system=system.name,
            distance=str(distance),
        )
    return float(distance)


def written_row(name: str, index: str, shape: Sequence[int]) -> str:
    """A row of a column or an array in the source of a program: a number, or a tuple of numbers or of tuples.

    >>> written_row("rods_curve", "r", (3,))
    '(rods_curve[r, 0], rods_curve[r, 1], rods_curve[r, 2])'
    """
    if not shape:
        return f"{name}[{index}]"
    parts = [written_row(name, f"{index}, {k}", shape[1:]) for k in range(shape[0])]
    return f"({', '.join(parts)}{',' if len(parts) == 1 else ''})"


def check_names(bound: Iterable[Bound]) -> None:
    """Raise ProgramError if two kernels or arrays would have the same name in the program."""
    owner: dict[str, str] = {}
    for b in bound:
        for name in (b.call, *b.stored_arrays):
            if name in owner:
                raise ProgramError(
                    "{one} and {other} are both called '{name}' in the step program; rename one of them.",
                    b.system,
                    one=owner[name],
                    other=b.system.name,
                    name=name,
                )
            owner[name] = b.system.name


def _check_role(system: StepSystem, model: Model) -> None:
    name = system.name
    if not all(is_identifier(part) for part in name.split(".")):
        raise ProgramError(
            "The name '{name}' of a step system cannot be used; name it like 'mymod.wind', by no word of Python.",
            name=name,
        )
    if isinstance(system, Law) and system.each not in _KINDS:
        raise ProgramError(
            "{law} has each = '{each}'; choose one of {choices}.",
            law=name,
            each=system.each,
            choices=", ".join(_KINDS),
        )
    if isinstance(system, Event) and system.each not in ("rods", "particles"):
        raise ProgramError(
            "{event} has each = '{each}'; choose rods or particles.", event=name, each=system.each
        )
    if isinstance(system, Law | Commit) and system.account not in ACCOUNTS:
        raise ProgramError(
            "{system} has the account '{account}'; choose one of {choices}.",
            system=name,
            account=system.account,
            choices=", ".join(ACCOUNTS),
        )
    if isinstance(system, Commit):
        table, _, column = (system.writes[0] if len(system.writes) == 1 else "").partition(".")
        field = model.tables["rods"].fields.get(column) if table == "rods" else None
        if field is None or field.role is Role.DOCUMENT or field.shape not in ((), (2,)):
            raise ProgramError(
                "{system} has writes = {columns}; a commit writes exactly one column of the rods, which has one number,"
                " or one of each end, in each row and is not part of the document.",
                system=name,
                columns=list(system.writes),
            )


def find(kernel: str | Callable[..., Any], owner: StepSystem) -> Callable[..., Any]:
    """The function that "module:function" names, or the function itself. Raises ProgramError, which names the owner."""
    if not isinstance(kernel, str):
        return getattr(kernel, "__func__", kernel)  # of a class: a method
    module, _, attribute = kernel.partition(":")
    try:
        found = getattr(importlib.import_module(module), attribute)
    except (Exception, SystemExit) as error:  # of the module, which may be a mod's
        raise ProgramError(
            "The kernel '{kernel}' of {system} cannot be found: {error}; write it like 'package.module:function'.",
            owner,
            kernel=kernel,
            system=owner.name,
            error=str(error),
        ) from None
    return found


def _check_parameter(b: Bound, parameter: str, model: Model) -> None:
    """Raise ProgramError unless the parameter is provided, an array of the system or a column that it declares."""
    rows, name = b.rows, b.system.name
    provided = _PROVIDED_TO[b.purpose]
    conservative = isinstance(b.system, Law) and b.system.potential
    if parameter in ("time", "dt", "drift", "particles_velocity") and conservative:
        raise ProgramError(
            "{law} has a potential, so its force depends on positions only, but its kernel takes '{parameter}'; remove"
            " one of the two.",
            law=name,
            parameter=parameter,
        )
    if parameter in ("time", "dt") and getattr(b.system, "elastic", False):
        raise ProgramError(
            "{law} is elastic, so the energy it stores depends on the state only, but its kernel takes '{parameter}';"
            " remove `elastic` or the parameter.",
            law=name,
            parameter=parameter,
        )
    if parameter in provided:
        return
    if parameter in b.arrays:
        if len(b.arrays[parameter]) != model.tables[rows].count:
            raise ProgramError(
                "The array '{name}' of {system} has {count} rows for {elements} {table}; give it one row for each.",
                name=parameter,
                system=name,
                count=len(b.arrays[parameter]),
                elements=model.tables[rows].count,
                table=tr(rows),
            )
        width = math.prod(b.arrays[parameter].shape[1:])
        if not 0 < width <= _WIDEST_ROW:
            raise ProgramError(
                "The array '{name}' of {system} has {count} numbers in a row; a kernel takes 1 to {most}.",
                name=parameter,
                system=name,
                count=width,
                most=_WIDEST_ROW,
            )
        return
    table, _, column = parameter.partition("_")
    if not _is_column(parameter, model):
        raise ProgramError(
            "The kernel of {system} has a parameter '{parameter}', but there is no column {column}; name parameters"
            " <table>_<column>, {provided} or like an entry of `arrays`.",
            system=name,
            parameter=parameter,
            column=f"{table}.{column}",
            provided=", ".join(provided),
        )
    if f"{table}.{column}" not in (*b.system.reads, *b.system.writes):
        raise ProgramError(
            "The kernel of {system} takes {parameter}, but the system does not declare that it reads '{column}'; add it"
            " to `reads`.",
            system=name,
            parameter=parameter,
            column=f"{table}.{column}",
        )
    if table != rows and not model.tables[table].kind.single:
        raise ProgramError(
            "The kernel of {system} is called for each of the {table} and cannot take {parameter}; take a column of the"
            " {table} or of a table with a single row, such as the environment.",
            system=name,
            table=tr(rows),
            parameter=parameter,
        )


def _is_column(name: str, model: Model) -> bool:
    table, _, column = name.partition("_")
    return table in model.tables and column in model.tables[table].fields
