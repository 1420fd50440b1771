"""Settings: how a model is computed and drawn; and environment: what acts on every particle. Part of the document."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Collection
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.cases import Combinations, cases, check_combinations
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import LARGEST, Field, FieldError, Vector, derived, if_known, look
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked, tr
from pinjoint.components.table import Table
from pinjoint.components.theory import FIRST_ORDER, THEORIES
from pinjoint.components.wording import cut, quoted

AUTOMATIC = "automatic"
NO_DIAGRAMS = "none"
# Of axial forces, bending moments and shears, in the order in which they follow one another.
DIAGRAMS = ("N", "M", "V")
INTEGRATORS = ChainMap(EXTENSIONS.integrators, {AUTOMATIC: None})  # the names of all there are at any time
# The scenes from which a person edits, and in which a model may open.
PAUSE, STATICS = HUBS = marked("pause"), marked("statics")
_MOST_LOAD_STEPS = 100


def _check_load_steps(value: Any, where: str) -> tuple[float, ...]:
    """Load factors, or FieldError."""
    steps = value.tolist() if hasattr(value, "tolist") else value
    if (
        isinstance(steps, list | tuple)
        and 0 < len(steps) <= _MOST_LOAD_STEPS
        and all(isinstance(s, int | float) and not isinstance(s, bool) and abs(s) <= LARGEST for s in steps)
    ):
        return tuple(map(float, steps))
    raise FieldError(
        "{where}: load steps are {value}; give a list of one to {most} load factors, such as [1] or [1, 0].",
        where=where,
        value=quoted(value),
        most=_MOST_LOAD_STEPS,
    )


class Settings(Handle):
    """Choices about computing and drawing. There is exactly one."""

    __slots__ = ()
    table, noun, single = "settings", "settings", True

    restitution: Field[float] = Field(
        default=1.0,
        minimum=0.0,
        maximum=1.0,
        title="coefficient of restitution",
        doc="Share of the approach speed that an impact gives back: 0 inelastic, 1 elastic.",
    )
    time_step: Field[float | None] = if_known(
        "s", doc="A fixed time step; automatic: as small as stability and accuracy need."
    )
    tolerance: Field[float] = Field(
        default=1e-9,
        minimum=1e-13,
        maximum=0.1,
        doc="Error allowed in one step, relative to the largest displacement and speed; only some integrators heed it.",
    )
    integrator: Field[str] = Field(
        default=AUTOMATIC, dtype=str, doc="The method that advances time.", choices=INTEGRATORS
    )
    collisions: Field[bool] = Field(dtype=bool, default=True, doc="Particles collide.")
    plasticity: Field[bool] = Field(
        dtype=bool, default=True, doc="Rods with a strength or a plastic moment yield."
    )
    plastic_hinges: Field[bool] = Field(
        dtype=bool,
        title="plastic hinges of sections",
        doc="Rods form plastic hinges at the plastic moments of their sections, too; else only where one is given.",
    )
    sleeping: Field[bool] = Field(
        dtype=bool,
        default=True,
        doc="Parts of the model at rest are left out of the computation until something reaches them.",
    )
    prescribed_displacement_scale: Field[float | None] = look(
        nullable=True,
        minimum=0.0,
        doc="Displacements are drawn this many times larger; automatic: enough to see them, 1 for large motions.",
        overrides="displacement_scale",
    )
    diagram_scale: Field[float] = look(
        "px/kN",
        default=1.0,
        minimum=0.0,
        title="force diagram scale",
        doc="Size of the force diagrams; where rods bend, relative to the size that fits.",
    )
    original_diagrams: Field[bool] = look(
        dtype=bool,
        default=True,
        title="statics on the undeformed shape",
        doc="In statics, the structure and its diagrams are drawn undeformed, and its deflected shape as a thin line.",
    )
    diagrams: Field[str] = look(
        default=NO_DIAGRAMS,
        dtype=str,
        title="diagrams at first",
        doc="Which force diagrams are shown when the model is opened: axial forces N, bending moments M or shears V.",
        choices=(NO_DIAGRAMS, *DIAGRAMS),
    )
    theory: Field[str] = look(
        dtype=str,
        default=FIRST_ORDER,
        doc="Of statics: first-order, about the original shape, or exact, about the deformed one.",
        choices=THEORIES,
    )
    load_steps: Field[tuple[float, ...]] = look(
        dtype=object,
        default=(1.0,),
        doc="Of statics: the factors of forces and loads that follow one another; the last is shown.",
        checker=_check_load_steps,
    )
    opens_in: Field[str] = look(
        dtype=str,
        default=PAUSE,
        doc="The mode in which a person meets the model: pause, before its motion, or statics, in equilibrium.",
        choices=HUBS,
    )
    combinations: Field[Combinations] = Field(
        dtype=object,
        default=MappingProxyType({}),
        doc="Factors of load cases by the name of the combination; cases that one leaves out do not act in it.",
        checker=check_combinations,
    )
    combination: Field[str] = Field(
        dtype=str,
        doc="The one that acts, of these, or a load case alone; none: all load cases, each with the factor 1.",
    )
    moving_force: Field[float] = Field(
        "kN", default=1.0, doc="Downwards: the force whose envelope along chosen rods statics shows."
    )
    automatic_displacement_scale: Field[float] = derived(default=1.0, doc="The scale that suits the model.")
    displacement_scale: Field[float] = derived(default=1.0, doc="As given, or the automatic one.")

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """The combination that acts is one of those there are, or a load case; without it all cases act."""
        settings = table[0]
        if settings.combination in ("", *settings.combinations, *cases(table.world)):  # type: ignore[arg-type]
            return
        if "combination" not in changed:
            settings.combination = ""
            return
        raise FieldError(
            "{where}: there is no combination '{name}'; {known}",
            where=table.world.describe(settings, "combination"),
            name=cut(settings.combination),
            known=tr("choose one of {known}.", known=", ".join(settings.combinations))
            if settings.combinations
            else tr("the model has none."),
        )


class Environment(Handle):
    """Force, acceleration and drag on all particles. There is exactly one."""

    __slots__ = ()
    table, noun, single = "environment", "environment", True

    force: Field[Vector] = Field("kN", shape=(2,), doc="Constant force on every particle.")
    acceleration: Field[Vector] = Field(
        "m/s²", shape=(2,), doc="Acceleration of every particle, such as gravity (0, -9.81)."
    )
    drag: Field[float] = Field("1/s", minimum=0.0, doc="Resistance to motion: force = −drag × mass × velocity.")
