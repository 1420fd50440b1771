"""Rod: a massless axial member between two different particles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from components.field import Field, FieldError, Role
from components.particle import Particle
from components.world import Handle, World


class Rod(Handle):
    """A pin-jointed bar: elastic or elastic–perfectly plastic, with an axial damper. Tension is positive."""

    __slots__ = ()
    table, noun = "rods", "rod"

    name: Field[str] = Field(title="name", doc="Unique among the rods.", default="", dtype=str)
    between: Field[tuple[int, int]] = Field(
        dtype="reference",
        shape=(2,),
        default=0,
        references="particles",
        title="ends",
        doc="Rows of the particles at its two ends.",
    )
    stiffness: Field[float] = Field(
        "kN", default=164640.0, above=0.0, title="stiffness", doc="EA: force per unit of strain."
    )
    prescribed_rest_length: Field[float | None] = Field(
        "m",
        default=None,
        nullable=True,
        above=0.0,
        title="rest length",
        key="rest_length",
        doc="Length without force; None: the distance between the original positions.",
        shown=("cm", 100.0),
        overrides="rest_length",
    )
    tensile_strength: Field[float | None] = Field(
        "kN", default=None, nullable=True, minimum=0.0, title="tensile strength", doc="None or 0: unlimited."
    )
    compressive_strength: Field[float | None] = Field(
        "kN",
        default=None,
        nullable=True,
        minimum=0.0,
        title="compressive strength",
        doc="None or 0: unlimited.",
    )
    damping: Field[float] = Field(
        "kN·s/m",
        default=100.0,
        minimum=0.0,
        title="damping coefficient",
        doc="Axial force per elongation rate.",
    )
    density: Field[float] = Field(
        "kg/m", default=6.15, minimum=0.0, title="density", doc="Mass per length.", shown=("kg/cm", 0.01)
    )
    plastic_strain: Field[float] = Field(
        role=Role.STATE, title="plastic strain", doc="Permanent part of the strain."
    )
    rest_length: Field[float] = Field(
        "m",
        role=Role.DERIVED,
        title="rest length",
        doc="Prescribed, or the distance between the original positions.",
        shown=("cm", 100.0),
        overridden_by="prescribed_rest_length",
    )
    difference: Field[tuple[float, float]] = Field(
        "m",
        shape=(2,),
        role=Role.DERIVED,
        title="original difference",
        doc="Original position of the second end minus that of the first.",
    )
    original_length: Field[float] = Field(
        "m", role=Role.DERIVED, title="original length", doc="Length of the original difference."
    )
    tension_limit: Field[float] = Field(
        "kN", role=Role.DERIVED, title="tension limit", doc="Tensile strength; infinite if unlimited."
    )
    compression_limit: Field[float] = Field(
        "kN", role=Role.DERIVED, title="compression limit", doc="Compressive strength; infinite if unlimited."
    )
    axial_force: Field[float] = Field(
        "kN", role=Role.DERIVED, title="axial force", doc="Without the damper's; tension positive."
    )
    length: Field[float] = Field(
        "m", role=Role.DERIVED, title="length", doc="Present distance between the ends.", shown=("cm", 100.0)
    )
    strain: Field[float] = Field(role=Role.DERIVED, title="strain", doc="Elongation / rest length.")
    yielding: Field[bool] = Field(
        dtype=bool, default=False, role=Role.DERIVED, title="yielding", doc="Axial force is at a strength."
    )

    @property
    def ends(self) -> tuple[Particle, Particle]:
        """The particles at its two ends."""
        particles = self.world.tables["particles"]
        first, second = self.between
        return particles[first], particles[second]

    def after_assigning(self, field: Field[Any]) -> None:
        """A rod without a rest length of its own needs some distance between its ends."""
        if field is Rod.prescribed_rest_length and not self.rest_length > 0.0:
            raise FieldError(
                f"{self.world.describe(self)}: its ends are at the same place; give it a rest length above 0."
            )


def spawn_rods(world: World, between: ArrayLike, **columns: Any) -> list[Rod]:
    """Create rods between pairs of particle rows, shape (n, 2), in bulk. Raises FieldError."""
    ends = np.asarray(between, dtype=np.int64).reshape(-1, 2)
    _check_ends(world, ends)
    with world.transaction("new rod"):
        rods = world.create(Rod, len(ends), between=ends, **columns)
        table = world.tables["rods"]
        lengths = table.rest_length[table.count - len(ends) :]
        for index in np.flatnonzero(~(lengths > 0.0))[:1].tolist():
            raise FieldError(
                f"{world.describe(rods[index])}: its ends are at the same place;"
                " place them apart or give it a rest length above 0."
            )
    return rods


def _check_ends(world: World, ends: NDArray[np.int64]) -> None:
    particles, rods = world.tables["particles"], world.tables["rods"]
    outside = ((ends < 0) | (ends >= particles.count)).any(axis=1)
    if outside.any():
        raise FieldError(
            f"A rod refers to particle row {ends[outside][0].tolist()}; there are {particles.count}."
        )
    same = ends[:, 0] == ends[:, 1]
    if same.any():
        name = particles.names[int(ends[same][0, 0])]
        raise FieldError(f"A rod needs two different particles; both ends are {name}.")
    codes = _pair_codes(np.concatenate([rods.between.astype(np.int64), ends]), particles.count)
    unique, first = np.unique(codes, return_index=True)
    if len(unique) < len(codes):
        repeated = np.setdiff1d(np.arange(len(codes)), first)[0] - rods.count
        a, b = (particles.names[int(row)] for row in ends[max(int(repeated), 0)])
        raise FieldError(f"There is a rod between {a} and {b} already; two particles share at most one.")


def _pair_codes(pairs: NDArray[np.int64], particles: int) -> NDArray[np.int64]:
    codes: NDArray[np.int64] = pairs.min(axis=1) * particles + pairs.max(axis=1)
    return codes
