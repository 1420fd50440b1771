"""The thesis' program in its own per-object style: the peer that benchmarks are measured against.

Particles, rods and the environment are objects in a dict of elements. In every step each rod looks at its
two particles, updates its state and hands them its force; the environment adds its own; then each particle
checks for collisions, sums what it received, moves (x += v Δt + a Δt²/2, v += a Δt) and forgets its forces.

Two differences, both in the thesis' favour: vectors are Cartesian pairs, where the thesis keeps dicts of
angles and lengths and sums them through sines and cosines; and both yield limits move with the plastic
strain, where the thesis moves only the one that yielded.
"""

import math

from tests.reference.elements import Document, Elements, Load, Model, read
from tests.reference.elements import Particle as ParticleData
from tests.reference.elements import Rod as RodData


class Particle:
    """A particle that collects forces [kN] and moves."""

    def __init__(self, data: ParticleData):
        self.name = data.name
        self.original_position = data.position
        self.position = [data.position[0] + data.displacement[0], data.position[1] + data.displacement[1]]
        self.velocity = list(data.velocity)
        self.fixed = data.fixed
        self.applied_force = data.force
        self.applied_acceleration = data.acceleration
        self.mass = data.mass
        self.radius = data.radius
        self.internal_force = [0.0, 0.0]
        self.external_force = [0.0, 0.0]
        self.reaction = [0.0, 0.0]

    def add_internal_force(self, x: float, y: float) -> None:
        """Receive a rod's force."""
        self.internal_force[0] += x
        self.internal_force[1] += y

    def add_external_force(self, x: float, y: float) -> None:
        """Receive any other force."""
        self.external_force[0] += x
        self.external_force[1] += y

    def add_acceleration(self, x: float, y: float) -> None:
        """Receive the force that an imposed acceleration [m/s²] amounts to."""
        self.add_external_force(self.mass * x / 1000, self.mass * y / 1000)

    def update(self, others: list["Particle"], time_step: float, restitution: float) -> None:
        """Collide with `others`, then move by one time step under the forces received; forget them."""
        for other in others:
            self.collide(other, restitution)
        self.add_external_force(*self.applied_force)
        self.add_acceleration(*self.applied_acceleration)
        for axis in (0, 1):
            force = self.internal_force[axis] + self.external_force[axis]
            if self.fixed[axis]:
                self.reaction[axis] = -force
                self.velocity[axis] = 0.0
                continue
            acceleration = 1000 * force / self.mass
            self.position[axis] += self.velocity[axis] * time_step + acceleration * time_step**2 / 2
            self.velocity[axis] += acceleration * time_step
        self.internal_force = [0.0, 0.0]
        self.external_force = [0.0, 0.0]

    def collide(self, other: "Particle", restitution: float) -> None:
        """If the discs overlap and approach, exchange momentum along the line of centres and part them."""
        dx = other.position[0] - self.position[0]
        dy = other.position[1] - self.position[1]
        distance = math.hypot(dx, dy)
        overlap = self.radius + other.radius - distance
        if overlap < 0:
            return
        nx, ny = dx / distance, dy / distance
        v1 = self.velocity[0] * nx + self.velocity[1] * ny
        v2 = other.velocity[0] * nx + other.velocity[1] * ny
        if v2 >= v1:
            return
        m1, m2 = self.mass, other.mass
        momentum = m1 * v1 + m2 * v2
        change1 = (restitution * m2 * (v2 - v1) + momentum) / (m1 + m2) - v1
        change2 = (restitution * m1 * (v1 - v2) + momentum) / (m1 + m2) - v2
        for axis, n in ((0, nx), (1, ny)):
            self.velocity[axis] += change1 * n
            other.velocity[axis] += change2 * n
            self.position[axis] -= overlap / 2 * n
            other.position[axis] += overlap / 2 * n


class Rod:
    """A rod that reads its two particles and hands them its force [kN]."""

    def __init__(self, data: RodData, particles: list[Particle]):
        self.name = data.name
        self.particle1 = particles[data.start]
        self.particle2 = particles[data.end]
        self.rest_length = data.rest_length
        self.stiffness = data.stiffness
        self.damping = data.damping
        self.elastic_range = (
            -data.compressive_strength / data.stiffness,
            data.tensile_strength / data.stiffness,
        )
        self.plastic_strain = data.plastic_strain
        self.update_geometry()
        self.check_plasticity()

    def update(self) -> None:
        """Follow the particles, yield if need be, and pull or push them."""
        self.update_geometry()
        self.check_plasticity()
        force = self.hooke_force() + self.damping_force()
        nx, ny = self.direction
        self.particle1.add_internal_force(force * nx, force * ny)
        self.particle2.add_internal_force(-force * nx, -force * ny)

    def update_geometry(self) -> None:
        """Measure the present axis and strain."""
        dx = self.particle2.position[0] - self.particle1.position[0]
        dy = self.particle2.position[1] - self.particle1.position[1]
        length = math.hypot(dx, dy)
        self.direction = (dx / length, dy / length)
        self.strain = (length - self.rest_length) / self.rest_length

    def check_plasticity(self) -> None:
        """Let the plastic strain take up what lies outside the elastic range."""
        lower, upper = self.elastic_range
        elastic_strain = self.strain - self.plastic_strain
        if elastic_strain > upper:
            self.plastic_strain = self.strain - upper
        elif elastic_strain < lower:
            self.plastic_strain = self.strain - lower

    def hooke_force(self) -> float:
        """Return the axial force N, tension positive."""
        return self.stiffness * (self.strain - self.plastic_strain)

    def damping_force(self) -> float:
        """Return the damper's tension, C times the rate of elongation."""
        nx, ny = self.direction
        v1, v2 = self.particle1.velocity, self.particle2.velocity
        return self.damping * ((v2[0] - v1[0]) * nx + (v2[1] - v1[1]) * ny)


class Environment:
    """What acts on every particle: a force, an acceleration, and drag."""

    def __init__(self, elements: Elements):
        self.force = elements.environment_force
        self.acceleration = elements.environment_acceleration
        self.drag = elements.drag

    def apply_to(self, particles: list[Particle]) -> None:
        """Hand each particle its share."""
        for particle in particles:
            vx, vy = particle.velocity
            particle.add_external_force(*self.force)
            particle.add_acceleration(
                self.acceleration[0] - self.drag * vx, self.acceleration[1] - self.drag * vy
            )


class Simulation:
    """The elements of a model, and the thesis' main loop over them."""

    def __init__(self, model: Model):
        data = read(model)
        particles = [Particle(each) for each in data.particles]
        self.elements: Document = {
            "particles": particles,
            "rods": [Rod(each, particles) for each in data.rods],
            "environment": Environment(data),
        }
        self.loads: list[tuple[Particle, Load]] = [(particles[load.particle], load) for load in data.loads]
        self.restitution = data.restitution
        self.collisions = data.collisions
        self.start = data.time
        self.steps = 0

    def step(self, time_step: float) -> None:
        """Advance every element by one time step."""
        particles = self.elements["particles"]
        for rod in self.elements["rods"]:
            rod.update()
        self.elements["environment"].apply_to(particles)
        for particle, load in self.loads:
            factor = load.factor(self.start + self.steps * time_step)
            particle.add_external_force(factor * load.force[0], factor * load.force[1])
        for index, particle in enumerate(particles):
            others = particles[index + 1 :] if self.collisions else []
            particle.update(others, time_step, self.restitution)
        self.steps += 1

    def run(self, time_step: float, steps: int) -> None:
        """Advance by `steps` steps."""
        for _ in range(steps):
            self.step(time_step)

    def result(self, time_step: float) -> Document:
        """Return the state by names, in m, m/s and kN; reactions are those of the last step's start."""
        for rod in self.elements["rods"]:
            rod.update_geometry()
            rod.check_plasticity()
        particles, rods = self.elements["particles"], self.elements["rods"]
        return {
            "time": self.start + self.steps * time_step,
            "steps": self.steps,
            "displacement": {
                p.name: (p.position[0] - p.original_position[0], p.position[1] - p.original_position[1])
                for p in particles
            },
            "velocity": {p.name: tuple(p.velocity) for p in particles},
            "reaction": {p.name: tuple(p.reaction) for p in particles},
            "axial_force": {rod.name: rod.hooke_force() for rod in rods},
            "plastic_strain": {rod.name: rod.plastic_strain for rod in rods},
        }


def taylor2(model: Model, time_step: float, steps: int) -> Document:
    """Run `steps` steps of `time_step` seconds; return the state by names."""
    simulation = Simulation(model)
    simulation.run(time_step, steps)
    return simulation.result(time_step)
