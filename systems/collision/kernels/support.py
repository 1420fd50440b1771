"""The law of particles in lasting contact."""

from systems.kernels import compiled


@compiled
def support(collision_support_force):
    """What others push a particle with during this step, in kN."""
    return collision_support_force[0], collision_support_force[1]
