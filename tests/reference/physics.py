"""The physics of particles and pin-jointed rods, written per object with plain loops: slow, obvious, exact.

Compiled kernels are compared with this module. Geometry is exact (a rod pulls along its present axis),
rods are elastic-perfectly plastic with a viscous damper beside them, particles are lumped masses. Discs do
not collide here.

Units: m, kg, s; forces kN; energies J. Arrays have one row per particle (x, y) in the model's order.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.reference.elements import Document, Model, Rod, read

NEWTONS_PER_KN = 1000.0


@dataclass(frozen=True)
class Forces:
    """What acts in one state (displacement, velocity, time); forces in kN, powers in W."""

    axial_force: list[float]  # N of each rod, without its damper
    applied: np.ndarray  # own force, environment, accelerations × mass, loads
    reaction: np.ndarray  # the supports' force on the structure
    acceleration: np.ndarray  # m/s²
    damping_power: float
    drag_power: float


class Simulation:
    """One model in motion: its state, the forces in that state, and an account of its energy.

    The state is the displacement `u` [m] and velocity `v` [m/s], shape (particles, 2), the plastic strain
    of every rod, and the time [s].
    """

    def __init__(self, model: Model):
        self.elements = read(model)
        self.start = self.time = self.elements.time
        self.u = np.array([particle.displacement for particle in self.elements.particles])
        self.v = np.array([particle.velocity for particle in self.elements.particles])
        self.plastic_strain = [rod.plastic_strain for rod in self.elements.rods]
        self.dissipated_damping = self.dissipated_drag = self.dissipated_plastic = self.work = 0.0
        self.commit_plasticity(self.u)
        # the account begins after an initial state beyond the strength has yielded
        self.dissipated_plastic = 0.0
        self.forces = self.evaluate(self.time, self.u, self.v)
        self.initial_energy = self.kinetic_energy() + self.elastic_energy()

    # Laws: pure functions of a (trial) state.

    def elongation(self, rod: Rod, u: np.ndarray) -> float:
        """Return L − L₀ [m], L₀ without force at its temperature.

        From the displacements, so that no digits are lost to absolute coordinates: with original difference D
        and change of displacement Δ: L² − D² = (2D + Δ)·Δ, so L − L₀ = (2D + Δ)·Δ / (L + |D|) + (|D| − L₀).
        """
        dx, dy = rod.span
        change_x = u[rod.end][0] - u[rod.start][0]
        change_y = u[rod.end][1] - u[rod.start][1]
        length = math.hypot(dx + change_x, dy + change_y)
        original = math.hypot(dx, dy)
        growth = ((2 * dx + change_x) * change_x + (2 * dy + change_y) * change_y) / (length + original)
        return float(growth + (original - rod.free_length))

    def direction(self, rod: Rod, u: np.ndarray) -> tuple[float, float]:
        """Return the unit vector along the present axis, from the rod's start to its end."""
        x = rod.span[0] + u[rod.end][0] - u[rod.start][0]
        y = rod.span[1] + u[rod.end][1] - u[rod.start][1]
        length = math.hypot(x, y)
        return x / length, y / length

    def elongation_rate(self, rod: Rod, u: np.ndarray, v: np.ndarray) -> float:
        """Return dL/dt [m/s], the relative velocity of the ends along the axis."""
        nx, ny = self.direction(rod, u)
        return float(nx * (v[rod.end][0] - v[rod.start][0]) + ny * (v[rod.end][1] - v[rod.start][1]))

    def elastic_force(self, index: int, u: np.ndarray) -> float:
        """Return EA (ε − ε_p) [kN] of rod number `index`, as if it could not yield further."""
        rod = self.elements.rods[index]
        strain = self.elongation(rod, u) / rod.rest_length
        return rod.stiffness * (strain - self.plastic_strain[index])

    def axial_force(self, index: int, u: np.ndarray) -> float:
        """Return N [kN], tension positive: the elastic force held at the strength (the return map)."""
        rod = self.elements.rods[index]
        return min(max(self.elastic_force(index, u), -rod.compressive_strength), rod.tensile_strength)

    def applied_force(self, index: int, time: float) -> np.ndarray:
        """Return the external force [kN] on particle number `index`, without drag and reaction."""
        elements = self.elements
        particle = elements.particles[index]
        acceleration = np.add(particle.acceleration, elements.environment_acceleration)
        force = np.add(particle.force, elements.environment_force)
        force += particle.mass * acceleration / NEWTONS_PER_KN
        for load in elements.loads:
            if load.particle == index:
                force += load.factor(time) * np.array(load.force)
        return force

    def evaluate(self, time: float, u: np.ndarray, v: np.ndarray) -> Forces:
        """Return the forces and accelerations in the state (u, v) at `time`; changes nothing."""
        rods, particles = self.elements.rods, self.elements.particles
        internal = np.zeros((len(particles), 2))
        axial_forces = []
        damping_power = drag_power = 0.0
        for index, rod in enumerate(rods):
            axial_force = self.axial_force(index, u)
            rate = self.elongation_rate(rod, u, v)
            nx, ny = self.direction(rod, u)
            pull = axial_force + rod.damping * rate
            internal[rod.start] += (pull * nx, pull * ny)
            internal[rod.end] -= (pull * nx, pull * ny)
            axial_forces.append(axial_force)
            damping_power += NEWTONS_PER_KN * rod.damping * rate**2
        applied = np.zeros((len(particles), 2))
        reaction = np.zeros((len(particles), 2))
        acceleration = np.zeros((len(particles), 2))
        for index, particle in enumerate(particles):
            applied[index] = self.applied_force(index, time)
            drag = -self.elements.drag * particle.mass * v[index] / NEWTONS_PER_KN
            total = internal[index] + applied[index] + drag
            for axis in (0, 1):
                if particle.fixed[axis]:
                    reaction[index][axis] = -total[axis]
                else:
                    acceleration[index][axis] = NEWTONS_PER_KN * total[axis] / particle.mass
            drag_power += self.elements.drag * particle.mass * float(v[index] @ v[index])
        return Forces(axial_forces, applied, reaction, acceleration, damping_power, drag_power)

    # Commits: the only places where the state changes.

    def commit_plasticity(self, u: np.ndarray) -> None:
        """Let ε_p take up what exceeds the strength at the displacements u, and book |N| |Δε_p| L₀."""
        for index, rod in enumerate(self.elements.rods):
            axial_force = self.axial_force(index, u)
            excess_strain = (self.elastic_force(index, u) - axial_force) / rod.stiffness
            self.plastic_strain[index] += excess_strain
            self.dissipated_plastic += NEWTONS_PER_KN * abs(axial_force * excess_strain) * rod.rest_length

    def advance(self, end: float, u: np.ndarray, v: np.ndarray) -> None:
        """Accept (u, v) at the time `end`; work and dissipation by the trapezoidal rule, error O(h²)."""
        before, moved, time_step = self.forces, u - self.u, end - self.time
        self._accept(end, u, v)
        after = self.forces
        self.work += NEWTONS_PER_KN * float(np.sum((before.applied + after.applied) / 2 * moved))
        self.dissipated_damping += time_step * (before.damping_power + after.damping_power) / 2
        self.dissipated_drag += time_step * (before.drag_power + after.drag_power) / 2

    def _accept(self, end: float, u: np.ndarray, v: np.ndarray) -> None:
        self.time = end
        self.u, self.v = u, v
        self.forces = self.evaluate(self.time, u, v)

    # What the outside wants to know.

    def kinetic_energy(self) -> float:
        """Return Σ m v²/2 [J]."""
        particles = self.elements.particles
        return sum(particle.mass * float(v @ v) / 2 for particle, v in zip(particles, self.v, strict=True))

    def elastic_energy(self) -> float:
        """Return Σ N² L₀ / (2 EA) [J]."""
        rods, axial_forces = self.elements.rods, self.forces.axial_force
        return NEWTONS_PER_KN * sum(
            n**2 * rod.rest_length / (2 * rod.stiffness) for rod, n in zip(rods, axial_forces, strict=True)
        )

    def energy(self) -> dict[str, float]:
        """Return the account [J]; imbalance = initial + work − (kinetic + elastic + dissipated)."""
        kinetic, elastic = self.kinetic_energy(), self.elastic_energy()
        dissipated = self.dissipated_damping + self.dissipated_drag + self.dissipated_plastic
        return {
            "initial": self.initial_energy,
            "work": self.work,
            "kinetic": kinetic,
            "elastic": elastic,
            "dissipated_damping": self.dissipated_damping,
            "dissipated_drag": self.dissipated_drag,
            "dissipated_plastic": self.dissipated_plastic,
            "imbalance": self.initial_energy + self.work - (kinetic + elastic + dissipated),
        }

    def result(self) -> Document:
        """Return the state by names: vectors as tuples, forces in kN, energies in J."""
        particles = [particle.name for particle in self.elements.particles]
        rods = [rod.name for rod in self.elements.rods]
        by_particle = {
            "displacement": self.u,
            "velocity": self.v,
            "acceleration": self.forces.acceleration,
            "reaction": self.forces.reaction,
        }
        result: Document = {"time": self.time, "energy": self.energy()}
        for title, rows in by_particle.items():
            result[title] = {name: (float(x), float(y)) for name, (x, y) in zip(particles, rows, strict=True)}
        for title, values in {
            "axial_force": self.forces.axial_force,
            "plastic_strain": self.plastic_strain,
        }.items():
            result[title] = {name: float(value) for name, value in zip(rods, values, strict=True)}
        return result


Observer = Callable[[Simulation], None]


def velocity_verlet(model: Model, time_step: float, steps: int, observe: Observer | None = None) -> Document:
    """Run `steps` steps of velocity Verlet, second order also with dampers.

    x₊ = x + h v + h²/2 a, yield at x₊, predict v* = v + h a, correct v₊ = v + h/2 (a + a(x₊, v*)); the next
    step's acceleration is a(x₊, v₊), with dampers and drag at the corrected velocity.
    """
    return _run(_verlet_step, model, time_step, steps, observe)


def taylor2(model: Model, time_step: float, steps: int, observe: Observer | None = None) -> Document:
    """Run `steps` steps of the thesis' scheme, x₊ = x + h v + h²/2 a, v₊ = v + h a: first order."""
    return _run(_taylor_step, model, time_step, steps, observe)


def _run(
    step: Callable[[Simulation, float, float], None],
    model: Model,
    time_step: float,
    steps: int,
    observe: Observer | None,
) -> Document:
    simulation = Simulation(model)
    breaks = sorted({time for load in simulation.elements.loads for time in load.breaks()})
    for number in range(1, steps + 1):
        end = simulation.start + number * time_step
        inside = [time for time in breaks if simulation.time < time < end]
        for piece in (*inside, end):
            step(simulation, piece - simulation.time if inside else time_step, piece)
        if observe is not None:
            observe(simulation)
    return simulation.result()


def _verlet_step(s: Simulation, h: float, end: float) -> None:
    a = s.forces.acceleration
    u = s.u + h * s.v + h**2 / 2 * a
    s.commit_plasticity(u)
    predicted = s.evaluate(end, u, s.v + h * a)
    s.advance(end, u, s.v + h / 2 * (a + predicted.acceleration))


def _taylor_step(s: Simulation, h: float, end: float) -> None:
    a = s.forces.acceleration
    u = s.u + h * s.v + h**2 / 2 * a
    s.commit_plasticity(u)
    s.advance(end, u, s.v + h * a)
