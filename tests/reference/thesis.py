"""The thesis' program without its window, as its appendix A spells it out: the peer that benchmarks run.

Particles, rods and the environment are objects in a dictionary of elements. In every step each rod looks at
its two particles, updates its state and hands them its force; the environment adds its own; then each
particle checks for collisions, sums what it received, finds its reactions, moves (x += v Δt + a Δt²/2,
v += a Δt) and forgets its forces. Vectors are lists and dictionaries of angles and lengths, as in
`tests.reference.polar`. Methods follow the thesis step by step and have its names, in snake case; what
stands in brackets are its sections and equations.

What differs is in the thesis' favour: directions that it compares for equality are told by a cosine, both
yield limits move with the plastic strain, as equation 55 says and A.2.2.9 does not, discs collide only while
they approach and part along the line of their centres, and `settings.collisions` can be off, where the
thesis checks every pair in every step. Loads with a history are added.
"""

import math

from tests.reference.elements import Document, Elements, Load, Model, read
from tests.reference.elements import Particle as ParticleData
from tests.reference.elements import Rod as RodData
from tests.reference.polar import (
    Polar,
    Vectors,
    add_vectors,
    cartesian_to_polar,
    decompose_vector,
    normalize_angle,
    polar_to_cartesian,
    project_vector,
    sum_vectors_dict,
)

NEWTONS_PER_KN = 1000.0


class PhysicalParticle:
    """What a particle is and does physically (4.3.2.1, A.2.1); forces in kN."""

    time_step = 1e-7  # s, of all particles, as is the next
    coef_restitution = 1.0

    def __init__(self, data: ParticleData):
        self.mass = data.mass or 1.0  # a held one may have none here, in the thesis none has none (A.2.1.13)
        self.radius = data.radius
        self.constraint = [float(held) for held in data.fixed]
        self.user_applied_accels = _vectors(data.acceleration)
        self.user_applied_forces = _vectors(data.force)
        self.forces: Vectors = {"angle": [0.0], "scalar": [0.0]}
        self.internal_forces: Vectors = {"angle": [0.0], "scalar": [0.0]}
        self.external_forces = _vectors(data.force)
        self.vels = _vectors(data.velocity)
        self.accels: Vectors = {"angle": [0.0], "scalar": [0.0]}
        self.original_pos = data.position
        self.pos = [data.position[0] + data.displacement[0], data.position[1] + data.displacement[1]]
        self.delta_pos = list(data.displacement)

    def update_physical_particle(self, others: list["Particle"]) -> tuple[list[float], Polar]:
        """Move by one time step; return the displacement and the external force (A.2.1.2)."""
        self.particle_collision(others)
        self.user_applied_accels = sum_vectors_dict(self.user_applied_accels)
        self.imposed_accel_to_force(self.user_applied_accels)
        self.forces = self.add_forces([self.internal_forces, self.external_forces])
        reaction = self.calculate_constraint_reaction()
        self.forces = self.add_forces([self.forces, reaction])
        self.accels = self.force_to_accel(self.forces)
        self.accels = sum_vectors_dict(self.accels)
        self.move()
        self.vels = self.accelerate()
        total_external_force = add_vectors(
            [self.external_forces["angle"][0], self.external_forces["scalar"][0]],
            [reaction["angle"][0], reaction["scalar"][0]],
        )
        self.reset()
        return self.delta_pos, total_external_force

    def add_internal_force(self, new_force: Vectors | Polar) -> None:
        """Receive a rod's force (A.2.1.3)."""
        if isinstance(new_force, dict):
            self.internal_forces["angle"].append(new_force["angle"][0])
            self.internal_forces["scalar"].append(new_force["scalar"][0])
        else:
            self.internal_forces["angle"].append(new_force[0])
            self.internal_forces["scalar"].append(new_force[1])
        self.internal_forces = sum_vectors_dict(self.internal_forces)

    def add_external_force(self, new_force: Vectors | Polar) -> None:
        """Receive any other force (A.2.1.4)."""
        if isinstance(new_force, dict):
            self.external_forces["angle"].append(new_force["angle"][0])
            self.external_forces["scalar"].append(new_force["scalar"][0])
        else:
            self.external_forces["angle"].append(new_force[0])
            self.external_forces["scalar"].append(new_force[1])
        self.external_forces = sum_vectors_dict(self.external_forces)

    def imposed_accel_to_force(self, accel: Vectors) -> None:
        """Receive the force that an imposed acceleration (m/s²) amounts to (A.2.1.7)."""
        force = {"angle": [accel["angle"][0]], "scalar": [self.mass * accel["scalar"][0] / NEWTONS_PER_KN]}
        self.add_external_force(force)

    def add_forces(self, groups: list[Vectors]) -> Vectors:
        """Return the sum of groups of forces (A.2.1.10)."""
        forces: Vectors = {"angle": [], "scalar": []}
        for group in groups:
            for angle in group["angle"]:
                forces["angle"].append(angle)
            for scalar in group["scalar"]:
                forces["scalar"].append(scalar)
        return sum_vectors_dict(forces)

    def move(self) -> None:
        """Take the new position (A.2.1.11)."""
        velocity = sum_vectors_dict(self.vels)
        vel_x, vel_y = polar_to_cartesian([velocity["angle"][0], velocity["scalar"][0]])
        accel_x, accel_y = polar_to_cartesian([self.accels["angle"][0], self.accels["scalar"][0]])
        self.pos[0] += vel_x * self.time_step + accel_x * self.time_step**2 / 2
        self.pos[1] += vel_y * self.time_step + accel_y * self.time_step**2 / 2
        self.delta_pos = [self.pos[0] - self.original_pos[0], self.pos[1] - self.original_pos[1]]

    def particle_collision(self, others: list["Particle"]) -> None:
        """Collide with all discs that overlap this one (A.2.1.12)."""
        for other in others:
            p2 = other.physics
            dx = p2.pos[0] - self.pos[0]
            dy = p2.pos[1] - self.pos[1]
            dist = math.hypot(dx, dy)
            if dist <= self.radius + p2.radius:
                self.collide(p2, [normalize_angle(math.atan2(dy, dx)), dist])

    def collide(self, p2: "PhysicalParticle", distance: Polar) -> None:
        """Exchange momentum along the line of centres, and part (equations 45 to 47, A.2.1.12)."""
        collision_angle, dist = distance
        v1_collision, v1_tangent = decompose_vector(
            [self.vels["angle"][0], self.vels["scalar"][0]], collision_angle
        )
        v2_collision, v2_tangent = decompose_vector(
            [p2.vels["angle"][0], p2.vels["scalar"][0]], collision_angle
        )
        v1 = v1_collision[1] * (1 if math.cos(v1_collision[0] - collision_angle) > 0 else -1)
        v2 = v2_collision[1] * (1 if math.cos(v2_collision[0] - collision_angle) > 0 else -1)
        if v2 >= v1:
            return
        total_mass = self.mass + p2.mass
        momentum = self.mass * v1 + p2.mass * v2
        v1_coll_final = (self.coef_restitution * p2.mass * (v2 - v1) + momentum) / total_mass
        v2_coll_final = (self.coef_restitution * self.mass * (v1 - v2) + momentum) / total_mass
        new_v1 = add_vectors(v1_tangent, [collision_angle, v1_coll_final])
        new_v2 = add_vectors(v2_tangent, [collision_angle, v2_coll_final])
        self.vels = {"angle": [new_v1[0]], "scalar": [new_v1[1]]}
        p2.vels = {"angle": [new_v2[0]], "scalar": [new_v2[1]]}
        overlap_x, overlap_y = polar_to_cartesian([collision_angle, self.radius + p2.radius - dist])
        self.pos = [self.pos[0] - overlap_x / 2, self.pos[1] - overlap_y / 2]
        p2.pos = [p2.pos[0] + overlap_x / 2, p2.pos[1] + overlap_y / 2]

    def force_to_accel(self, force: Vectors) -> Vectors:
        """Return the acceleration (m/s²) under a force (A.2.1.14)."""
        accels: Vectors = {"angle": [], "scalar": []}
        accels["angle"].append(force["angle"][0])
        accels["scalar"].append(NEWTONS_PER_KN * force["scalar"][0] / self.mass)
        return accels

    def accelerate(self) -> Vectors:
        """Return the new velocity (A.2.1.16)."""
        incremental_vel = {
            "angle": [self.accels["angle"][0]],
            "scalar": [self.accels["scalar"][0] * self.time_step],
        }
        return sum_vectors_dict(self.vels, incremental_vel)

    def calculate_constraint_reaction(self) -> Vectors:
        """Return the supports' force, and add what stops the particle to its velocities (A.2.1.17)."""
        reaction: Vectors = {"angle": [], "scalar": []}
        resultant = sum_vectors_dict(self.forces)
        resultant_x, resultant_y = decompose_vector([resultant["angle"][0], resultant["scalar"][0]])
        vel_x, vel_y = decompose_vector([self.vels["angle"][0], self.vels["scalar"][0]])
        if self.constraint[0] != 0.0:
            reaction["angle"].append(normalize_angle(resultant_x[0] + math.pi))
            reaction["scalar"].append(resultant_x[1])
            self.vels["angle"].append(normalize_angle(vel_x[0] + math.pi))
            self.vels["scalar"].append(vel_x[1])
        if self.constraint[1] != 0.0:
            reaction["angle"].append(normalize_angle(resultant_y[0] + math.pi))
            reaction["scalar"].append(resultant_y[1])
            self.vels["angle"].append(normalize_angle(vel_y[0] + math.pi))
            self.vels["scalar"].append(vel_y[1])
        return sum_vectors_dict(reaction)

    def reset(self) -> None:
        """Forget the forces and the acceleration of this step (A.2.1.18)."""
        self.accels = {"angle": [0.0], "scalar": [0.0]}
        self.external_forces = {
            "angle": [self.user_applied_forces["angle"][0]],
            "scalar": [self.user_applied_forces["scalar"][0]],
        }
        self.internal_forces = {"angle": [0.0], "scalar": [0.0]}
        self.forces = {"angle": [0.0], "scalar": [0.0]}


class PhysicalRod:
    """What a rod is and does physically (4.3.2.2, A.2.2); forces in kN, tension positive."""

    def __init__(self, data: RodData, attached_particles: list["Particle"]):
        self.attached_particles = attached_particles
        self.rest_length = data.rest_length
        self.stiffness = data.stiffness
        self.damp_coef = data.damping
        self.strength = [-data.compressive_strength, data.tensile_strength]
        self.plasticity = False
        self.plastic_deformation = data.plastic_strain
        self.delta_elastic_deformation = self.calculate_delta_elastic_deformation()
        self.update_rod_position()
        self.check_plasticity()
        self.rod_hooke_force()
        self.rod_damping()
        self.rod_resultant_force()

    def update_physical_rod(self) -> tuple[float, bool]:
        """Follow the particles, yield if need be, pull or push them; return N and the state (A.2.2.2)."""
        self.update_rod_position()
        self.check_plasticity()
        self.rod_hooke_force()
        self.rod_damping()
        self.rod_resultant_force()
        self.force_to_particles()
        return self.axial_force, self.plasticity

    def update_rod_position(self) -> None:
        """Take over the particles' positions, and what follows from them (A.2.2.5)."""
        self.pos1 = self.attached_particles[0].physics.pos
        self.pos2 = self.attached_particles[1].physics.pos
        self.angle_p1_to_p2, self.angle_p2_to_p1 = self.calculate_angles()
        self.current_deformation = self.calculate_deformation()
        self.delta_length = self.current_deformation * self.rest_length

    def rod_hooke_force(self) -> None:
        """Find the axial force (equation 51, A.2.2.6)."""
        self.hooke_force = self.stiffness * (self.current_deformation - self.plastic_deformation)

    def rod_damping(self) -> None:
        """Find the damper's force (equation 52, A.2.2.7)."""
        vels1 = self.attached_particles[0].physics.vels
        vels2 = self.attached_particles[1].physics.vels
        axial_vel1 = project_vector([vels1["angle"][0], vels1["scalar"][0]], self.angle_p1_to_p2)
        axial_vel2 = project_vector([vels2["angle"][0], vels2["scalar"][0]], self.angle_p2_to_p1)
        relative_vel1_to_2 = add_vectors(axial_vel1, axial_vel2, 1, -1)
        damping_sign = -1 if math.cos(relative_vel1_to_2[0] - self.angle_p1_to_p2) > 0 else 1
        self.damping_force = self.damp_coef * relative_vel1_to_2[1] * damping_sign

    def rod_resultant_force(self) -> None:
        """Sum Hooke's force and the damper's (A.2.2.8)."""
        self.axial_force = self.hooke_force + self.damping_force

    def check_plasticity(self) -> None:
        """Let the plastic strain take up what lies outside the elastic range (equation 57, A.2.2.9)."""
        self.plasticity = False
        compression, tension = self.delta_elastic_deformation
        if self.current_deformation > tension + self.plastic_deformation:
            self.plasticity = True
            self.plastic_deformation = self.current_deformation - tension
        elif self.current_deformation < compression + self.plastic_deformation:
            self.plasticity = True
            self.plastic_deformation = self.current_deformation - compression

    def calculate_angles(self) -> tuple[float, float]:
        """Return the angles from the first end to the second and back (A.2.2.10)."""
        dx = self.pos1[0] - self.pos2[0]
        dy = self.pos1[1] - self.pos2[1]
        angle, _length = cartesian_to_polar([dx, dy])
        return normalize_angle(angle + math.pi), normalize_angle(angle)

    def calculate_length(self) -> float:
        """Return the present length (m) (A.2.2.11)."""
        dx = self.pos1[0] - self.pos2[0]
        dy = self.pos1[1] - self.pos2[1]
        _angle, length = cartesian_to_polar([dx, dy])
        return length

    def calculate_deformation(self) -> float:
        """Return the strain (equation 50, A.2.2.12)."""
        length = self.calculate_length()
        return (length - self.rest_length) / self.rest_length

    def calculate_delta_elastic_deformation(self) -> list[float]:
        """Return the elastic range of strain, compression and tension (equation 56, A.2.2.13)."""
        return [self.strength[0] / self.stiffness, self.strength[1] / self.stiffness]

    def force_to_particles(self) -> None:
        """Pull or push both particles along the axis (A.2.2.14)."""
        first, second = self.attached_particles
        first.physics.add_internal_force([self.angle_p1_to_p2, self.axial_force])
        second.physics.add_internal_force([self.angle_p2_to_p1, self.axial_force])


class Particle:
    """A particle's physical component and what is shown of it (6.2.3.1, A.5.3)."""

    def __init__(self, data: ParticleData):
        self.name = data.name
        self.physics = PhysicalParticle(data)
        self.delta_pos = [0.0, 0.0]
        self.external_force = [0.0, 0.0]

    def update_physics(self, others: list["Particle"]) -> None:
        """Update the physical component; `others` are those it can collide with (A.5.3.2)."""
        self.delta_pos, self.external_force = self.physics.update_physical_particle(others)


class Rod:
    """A rod's physical component and what is shown of it (6.2.3.2, A.5.4)."""

    def __init__(self, data: RodData, particles: list[Particle]):
        self.name = data.name
        self.physics = PhysicalRod(data, [particles[data.start], particles[data.end]])
        self.hooke_force = 0.0
        self.rod_plasticity = False

    def update_physics(self) -> None:
        """Update the physical component (A.5.4.2)."""
        self.hooke_force, self.rod_plasticity = self.physics.update_physical_rod()


class Environment:
    """An acceleration and a force on every particle (4.3.2.3, A.2.3)."""

    def __init__(self, data: Elements):
        self.acceleration = _vectors(data.environment_acceleration)
        self.force = _vectors(data.environment_force)

    def apply_to_particles(self, particles: list[Particle]) -> None:
        """Hand each particle its share (A.2.3.1)."""
        for particle in particles:
            particle.physics.imposed_accel_to_force(self.acceleration)
            particle.physics.add_external_force(self.force)


class Simulation:
    """A dictionary of elements, and the thesis' update of their physics (A.1.8.4)."""

    def __init__(self, model: Model):
        data = read(model)
        particles = [Particle(each) for each in data.particles]
        self.elements: Document = {
            "environment": Environment(data),
            "particles": particles,
            "rods": [Rod(each, particles) for each in data.rods],
        }
        self.loads: list[tuple[Particle, Load]] = [(particles[load.particle], load) for load in data.loads]
        self.collisions = data.collisions
        PhysicalParticle.coef_restitution = data.restitution
        self.start = data.time
        self.steps = 0

    def update_elements_physics(self) -> None:
        """Advance every element by one time step."""
        particles = self.elements["particles"]
        for rod in self.elements["rods"]:
            rod.update_physics()
        self.elements["environment"].apply_to_particles(particles)
        for particle, load in self.loads:
            factor = load.factor(self.start + self.steps * PhysicalParticle.time_step)
            angle, scalar = cartesian_to_polar(list(load.force))
            particle.physics.add_external_force([angle, factor * scalar])
        for index, particle in enumerate(particles):
            particle.update_physics(particles[index + 1 :] if self.collisions else [])
        self.steps += 1

    def run(self, time_step: float, steps: int) -> None:
        """Advance by `steps` steps of `time_step` seconds."""
        PhysicalParticle.time_step = time_step
        for _ in range(steps):
            self.update_elements_physics()

    def result(self) -> Document:
        """Return the state by names, in m, m/s and kN; of rods what follows from it, without dampers."""
        rods = self.elements["rods"]
        for rod in rods:
            rod.physics.update_rod_position()
            rod.physics.check_plasticity()
            rod.physics.rod_hooke_force()
        particles = {particle.name: particle.physics for particle in self.elements["particles"]}
        return {
            "displacement": {name: tuple(each.delta_pos) for name, each in particles.items()},
            "velocity": {
                name: tuple(polar_to_cartesian([each.vels["angle"][0], each.vels["scalar"][0]]))
                for name, each in particles.items()
            },
            "axial_force": {rod.name: rod.physics.hooke_force for rod in rods},
            "plastic_strain": {rod.name: rod.physics.plastic_deformation for rod in rods},
        }


def taylor2(model: Model, time_step: float, steps: int) -> Document:
    """Run `steps` steps of `time_step` seconds; return the state by names."""
    simulation = Simulation(model)
    simulation.run(time_step, steps)
    return simulation.result()


def _vectors(cartesian: tuple[float, float]) -> Vectors:
    angle, scalar = cartesian_to_polar(list(cartesian))
    return {"angle": [angle], "scalar": [scalar]}
