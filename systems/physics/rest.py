"""Rest: the rule by which a run ends, judge() in kernels.py, for each island of a model by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinjoint.components.arrays import Array, Flags, Rows
from pinjoint.components.model import Model
from pinjoint.components.particle import is_sprung, spring_stiffness
from pinjoint.components.rod import strut_energy
from pinjoint.systems.physics.bending import bending_energy, bowing_work, levers
from pinjoint.systems.physics.kernels import LOST_UNSEEN, REST_RESIDUAL, SMALL_SHARE
from pinjoint.systems.program.entries import MEASURED, Measure

UNSEEN = 1e-6  # residual of a motion that is lost in rounding, of the largest force; larger: it is not at rest

_BEYOND = np.errstate(over="ignore", invalid="ignore")  # a number that is not finite is not at rest


@dataclass(frozen=True)
class RestMeasure:
    """How near to rest the particles and rods of a model are, row by row.

    residual: unbalanced force on particles where they are free (kN). kinetic: energy of particles (J). load, pull:
    largest force on particles, and in rods (kN). elastic: energy of rods (J). round_off: of forces in rods (kN).
    """

    residual: Array
    kinetic: Array
    load: Array
    pull: Array
    elastic: Array
    round_off: Array

    @classmethod
    @_BEYOND
    def of(cls, model: Model, unbalanced: Array, turning: Array | float = 0.0) -> RestMeasure:
        """The measure of the state last observed; moments count as forces by the shortest rod at their particle.

        unbalanced, turning: force and moment on each particle without dampers and drag (kN, kN·m).
        """
        particles, rods = model.particles, model.rods
        flexibility, lever, free = rods.rest_length / rods.stiffness, levers(model), particles.turning > 0.0
        moved = np.abs(particles.displacement).max(axis=1, initial=0.0)[rods.between].max(axis=1, initial=0.0)
        rolled = np.abs(particles.rotation)[rods.between].max(axis=1, initial=0.0)
        firm = rods.end_stiffness.max(axis=1, initial=0.0) / rods.rest_length
        pushed = (np.abs(unbalanced) * (particles.mobility > 0.0)).max(axis=1, initial=0.0)
        loaded = np.abs(particles.constant_force).max(axis=1, initial=0.0)
        bending = np.abs(rods.end_moment).max(axis=1, initial=0.0) / rods.rest_length
        spin = np.where(free, particles.angular_velocity, 0.0)
        return cls(
            residual=np.maximum(pushed, np.abs(turning) * free * lever),
            kinetic=0.5 * (particles.mass * (particles.velocity**2).sum(axis=1) + particles.inertia * spin**2),
            load=np.maximum(loaded, np.abs(particles.constant_moment) * lever),
            pull=np.maximum(np.abs(rods.axial_force), bending),
            elastic=500.0 * rods.axial_force**2 * flexibility
            + 1000.0 * (bending_energy(model) + strut_energy(model)),
            round_off=np.finfo(float).eps * (moved / flexibility + firm * rolled),
        )

    @_BEYOND
    def at_rest(
        self, of_particle: Rows, of_rod: Rows, force_scale: Array | float, energy_scale: Array | float
    ) -> Flags:
        """Which islands are at rest.

        of_particle, of_rod: the island of each. force_scale (kN), energy_scale (J): of the clock, one for all islands
        or one for each.
        """
        count = int(of_particle.max(initial=0)) + 1
        largest = _largest(count, (of_particle, self.load), (of_rod, self.pull))
        round_off = _largest(count, (of_rod, self.round_off))
        still_force = np.maximum(
            REST_RESIDUAL * np.maximum(largest, SMALL_SHARE * force_scale), 8.0 * round_off
        )
        elastic = np.bincount(of_rod, self.elastic, count)
        least = np.where(elastic > 0.0, SMALL_SHARE**2, 1.0) * energy_scale
        still_energy = REST_RESIDUAL**2 * np.maximum(elastic, least)
        residual = _largest(count, (of_particle, self.residual))
        kinetic = np.bincount(of_particle, self.kinetic, count)
        return (residual <= still_force) & (kinetic <= still_energy)

    def measures(self, model: Model, particles: Flags, rods: Flags) -> Array:
        """The measures of these particles and rods at rest, shape (8,)."""
        work = model.particles.constant_force[particles] * model.particles.displacement[particles]
        turned = model.particles.constant_moment[particles] * model.particles.rotation[particles]
        measures = np.zeros(len(Measure))
        measures[Measure.ELASTIC] = self.elastic[rods].sum()
        if is_sprung(model):
            moved = np.column_stack([model.particles.displacement, model.particles.rotation])
            measures[Measure.ELASTIC] += 500.0 * (spring_stiffness(model) * moved**2)[particles].sum()
        bowed = turned.sum() + bowing_work(model)[rods].sum()
        measures[Measure.POTENTIAL] = 1000.0 * work.sum() + 1000.0 * bowed
        measures[Measure.RESIDUAL] = self.residual[particles].max(initial=0.0)
        measures[Measure.LARGEST_FORCE] = max(
            self.load[particles].max(initial=0.0), self.pull[rods].max(initial=0.0)
        )
        measures[Measure.ROUND_OFF] = self.round_off[rods].max(initial=0.0)
        return measures[MEASURED]


def rests_unseen(measures: Array, lost: float, damped: float, energy_scale: float) -> bool:
    """True if a state whose steps no longer change anything is at rest but for rounding, within some more digits.

    measures: as of Program. lost: by the steps (J). damped: taken by dampers and drag (J).
    """
    residual, largest = measures[Measure.RESIDUAL], measures[Measure.LARGEST_FORCE]
    is_still = residual <= UNSEEN * largest and measures[Measure.KINETIC] <= UNSEEN**2 * energy_scale
    return bool(is_still and lost <= damped + LOST_UNSEEN * energy_scale)


def may_rest(measures: Array, force_scale: float, energy_scale: float) -> bool:
    """True if a state of which a file says that it is at rest may be so, by a rule that all at rest meet."""
    largest = max(measures[Measure.LARGEST_FORCE], force_scale)
    is_still = measures[Measure.RESIDUAL] <= max(UNSEEN * largest, 8.0 * measures[Measure.ROUND_OFF])
    return bool(is_still and measures[Measure.KINETIC] <= UNSEEN**2 * energy_scale)


def _largest(count: int, *values: tuple[Rows, Array]) -> Array:
    """The largest value on each island."""
    found = np.zeros(count)
    for island, of_island in values:
        np.maximum.at(found, island, of_island)
    return found
