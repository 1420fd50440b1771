"""States of statics: where a structure is in equilibrium, with what acts in its rods and supports."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array, Flags, Rows
from pinjoint.components.cases import settled
from pinjoint.components.derived import amplitude, diagrams
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.particle import of_rigid_supports
from pinjoint.components.rod import bends, has_struts
from pinjoint.components.wording import brief
from pinjoint.systems.statics.equations import Structure
from pinjoint.systems.statics.events import Event
from pinjoint.systems.statics.response import Response, of_axes

STABLE, NEUTRAL, UNSTABLE = EQUILIBRIA = (
    marked("equilibrium"),
    marked("neutral equilibrium"),
    marked("unstable equilibrium"),
)


@dataclass(frozen=True, repr=False)
class StaticState:
    """The state at one load factor, in m, kN and J: the particles' fields are (n, 2) or (n,), the rods' (rods,).

    reaction: the supports' force, 0 where there is none; reaction_moment: likewise of clamps and rotation springs.
    diagrams: by the names of columns, (rods, 2), with the deflections of struts (rods,). residual: the largest unbalanced
    force over the largest so far.
    dissipated_plastic: since settling began. status: "equilibrium"; "neutral equilibrium" where nothing resists some
    motion, so that the place is one of many; "unstable equilibrium"; "mechanism", "collapse" or "limit reached", with
    which all values are those of the last equilibrium on the way. events: those on the way from the state before.
    contacts: rows of the discs that press each other, (k, 2), with contact_force (k,). acting: external forces (n, 2), where
    members bend with moments (n, 3).
    """

    __repr__ = brief

    load_factor: float
    displacement: Array
    rotation: Array
    plastic_strain: Array
    plastic_rotation: Array
    axial_force: Array
    strain: Array
    length: Array
    yielding: Flags
    hinge_yielding: Flags
    reaction: Array
    reaction_moment: Array
    diagrams: Mapping[str, Array]
    residual: float
    elastic_energy: float
    dissipated_plastic: float
    status: str
    message: str
    events: tuple[Event, ...]
    contacts: Rows
    contact_force: Array
    acting: Array

    @classmethod
    def of(
        cls,
        model: Model,
        structure: Structure,
        response: Response,
        displacement: Array,
        load: Array,
        **facts: Any,
    ) -> StaticState:
        """The state at these displacements (n, …) under a load; facts: the other fields of the state."""
        rods, count = slice(model.rods.count), model.particles.count  # what follows: contacts, obstacles
        pressing = rods.stop + np.flatnonzero(response.axial_force[rods.stop :] < 0.0)
        reaction = structure.reactions(response, load)[:count]
        stored = response.axial_force**2 * structure.rest_length / structure.stiffness
        stored += structure.stored_aside(response)
        stored[structure.inextensible] = 0.0
        elastic = 500.0 * float(stored[rods].sum())
        if structure.bending is not None and response.bent is not None:
            elastic += 1000.0 * float(structure.bending.energy(response.bent.slopes).sum())
        elastic += 500.0 * float((response.spring_force * displacement).sum())
        plastic, limited = response.plastic_strain[rods], structure.at_limit(response)[rods]
        none = np.zeros((rods.stop, 2))
        length = response.length
        if structure.first_order:  # response.length is that about which rods turn
            length = structure.original_length + response.elongation - structure.misfit
        of_struts = _of_struts(model, response)
        return cls(
            displacement=displacement[:count, :2],
            rotation=structure.rotation(displacement)[:count],
            plastic_strain=of_axes(plastic),
            plastic_rotation=none if plastic.ndim == 1 else plastic[:, 1:],
            axial_force=response.axial_force[rods],
            strain=response.strain[rods],
            length=length[rods],
            yielding=of_axes(limited),
            hinge_yielding=none > 0.0 if limited.ndim == 1 else limited[:, 1:],
            reaction=reaction[:, :2],
            reaction_moment=structure.rotation(reaction),
            diagrams={
                **of_struts,
                **diagrams(
                    model,
                    response.axis[rods],
                    response.length[rods],
                    structure.chords(displacement)[rods],
                    structure.rotation(displacement)[structure.ends[rods]],
                    (response.axial_force[rods], structure.end_moments(response)[rods]),
                    of_struts.get("lateral_deflection"),
                    share=response.share,
                    first_order=structure.first_order,
                ),
            },
            elastic_energy=elastic,
            contacts=structure.ends[pressing],
            contact_force=-response.axial_force[pressing],
            **facts,
        )

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """What the columns of a model are in this state, by "table.field"."""
        of_particles: dict[str, NDArray[Any]] = {
            "displacement": self.displacement,
            "velocity": np.zeros_like(self.displacement),
            "reaction": self.reaction,
            "rotation": self.rotation,
            "angular_velocity": np.zeros_like(self.rotation),
            "reaction_moment": self.reaction_moment,
        }
        of_rods: dict[str, NDArray[Any]] = {
            **self.diagrams,
            "end_moment": self.diagrams["bending_moment"] * [-1.0, 1.0],
            "axial_force": self.axial_force,
            "length": self.length,
            "strain": self.strain,
            "plastic_strain": self.plastic_strain,
            "plastic_rotation": self.plastic_rotation,
            "yielding": self.yielding,
            "hinge_yielding": self.hinge_yielding,
        }
        found = {f"particles.{name}": values for name, values in of_particles.items()}
        return found | {f"rods.{name}": values for name, values in of_rods.items()}

    @property
    def shown(self) -> dict[str, NDArray[Any]]:
        """The same, with what acts on particles."""
        force, moment = self.acting[:, :2], self.acting[:, 2:].sum(axis=1)
        return self.columns | {"particles.applied_force": force, "particles.applied_moment": moment}

    @property
    def permanent(self) -> Array:
        """What yielding has left in the rods and their ends, (rods, 3)."""
        return np.column_stack([self.plastic_strain, self.plastic_rotation])

    @property
    def balanced(self) -> bool:
        """True if all forces are in balance, whether or not the state is stable."""
        return self.status in EQUILIBRIA

    def put(self, model: Model) -> None:
        """Put a model into this state: its displacements and plastic strains, without velocity."""
        turning, columns = bends(model), self.columns
        moving = ("displacement", "velocity", *(("rotation", "angular_velocity") if turning else ()))
        yielded = ("plastic_strain", *(("plastic_rotation",) if turning else ()))
        for name in (*(f"particles.{name}" for name in moving), *(f"rods.{name}" for name in yielded)):
            model.give(name, columns[name])


def _of_struts(model: Model, response: Response) -> dict[str, NDArray[Any]]:
    """How far struts are bent aside, as a column by its name; none where there are none."""
    if not has_struts(model):
        return {}
    strain, plastic = (part[: model.rods.count] for part in (response.strain, of_axes(response.plastic_strain)))
    return {"lateral_deflection": amplitude(model.rods, strain, plastic)}


@dataclass(frozen=True)
class Start:
    """The state that settling starts from: displacement (n, 2) in m, rotation (n,), and what is permanent, plastic strain of
    rods (rods,), or with plastic rotations of their ends (rods, 3).

    load_factor: what acts there, if it is an equilibrium.
    """

    displacement: Array
    rotation: Array
    permanent: Array
    load_factor: float = field(default=1.0, kw_only=True)

    @classmethod
    def present(cls, model: Model) -> Start:
        """A model's present state, or the solution that it shows."""
        factor = 1.0 if model.solution is None else model.settings.load_steps[-1]
        return cls.stored(model.column, factor)

    @classmethod
    def stored(cls, column: Callable[[str], NDArray[Any]], load_factor: float = 1.0) -> Start:
        """The state in which columns are, by "table.field"."""
        strain, turned = column("rods.plastic_strain"), column("rods.plastic_rotation")
        moved, rotation = (column(f"particles.{name}").copy() for name in ("displacement", "rotation"))
        return cls(moved, rotation, np.column_stack([strain, turned]), load_factor=load_factor)

    @classmethod
    def of(cls, model: Model) -> Start:
        """The same, in which rigid supports are where loads let them settle."""
        start, moved = cls.present(model), settled(model)
        free = start.displacement - of_rigid_supports(model, start.displacement)
        rotation = np.where(model.particles.fixed_rotation, moved[:, 2], start.rotation)
        return replace(start, displacement=free + moved[:, :2], rotation=rotation)

    @classmethod
    def undeformed(cls, model: Model, permanent: Array) -> Start:
        """The undeformed beginning with what is permanent: only supports that have settled are displaced."""
        moved = settled(model)
        return cls(moved[:, :2], moved[:, 2], permanent)
