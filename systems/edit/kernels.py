"""Kernels of editing: the pull of a person's hand."""

from pinjoint.systems.program.kernel import compiled


@compiled
def pull(particles_displacement, particles_velocity, edit_pull_stiffness, edit_pull_damping, edit_pull_anchor):
    """Spring and damper between a particle and the point it is pulled to: F = k (a − u) − c v, in kN."""
    k, c = edit_pull_stiffness, edit_pull_damping
    return (
        k * (edit_pull_anchor[0] - particles_displacement[0]) - c * particles_velocity[0],
        k * (edit_pull_anchor[1] - particles_displacement[1]) - c * particles_velocity[1],
    )
