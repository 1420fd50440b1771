"""Plain single-purpose kernels: what one would write for just this model, as the yardstick for ours."""

import math

import numpy as np
from numba import njit

from pinjoint.components.model import Model


@njit(error_model="numpy")
def elastic_verlet(steps, h, u, v, f, mobility, external, ends, difference, original, rest, stiffness):
    """Velocity Verlet of elastic rods."""
    for _ in range(steps):
        for i in range(u.shape[0]):
            for d in range(2):
                v[i, d] += 0.5 * h * f[i, d] * mobility[i, d]
                u[i, d] += h * v[i, d]
                f[i, d] = external[i, d]
        for r in range(ends.shape[0]):
            a = ends[r, 0]
            b = ends[r, 1]
            sx = u[b, 0] - u[a, 0]
            sy = u[b, 1] - u[a, 1]
            x = difference[r, 0] + sx
            y = difference[r, 1] + sy
            length = math.sqrt(x * x + y * y)
            stretch = ((difference[r, 0] + x) * sx + (difference[r, 1] + y) * sy) / (length + original[r])
            force = stiffness[r] * (stretch + original[r] - rest[r]) / rest[r] / length
            f[a, 0] += force * x
            f[a, 1] += force * y
            f[b, 0] -= force * x
            f[b, 1] -= force * y
        for i in range(u.shape[0]):
            for d in range(2):
                v[i, d] += 0.5 * h * f[i, d] * mobility[i, d]


@njit(error_model="numpy")
def full_verlet(
    steps,
    h,
    u,
    v,
    f,
    mobility,
    external,
    ends,
    difference,
    original,
    rest,
    stiffness,
    damping,
    tension,
    compression,
    plastic,
    predicted,
    resisting,
    axis,
):
    """Velocity Verlet of elastic–plastic rods with dampers evaluated at the corrected velocity."""
    dissipated = 0.0
    for _ in range(steps):
        for i in range(u.shape[0]):
            for d in range(2):
                a = (f[i, d] + resisting[i, d]) * mobility[i, d]
                predicted[i, d] = v[i, d] + h * a
                v[i, d] += 0.5 * h * a
                u[i, d] += h * v[i, d]
                f[i, d] = external[i, d]
                resisting[i, d] = 0.0
        for r in range(ends.shape[0]):
            a = ends[r, 0]
            b = ends[r, 1]
            sx = u[b, 0] - u[a, 0]
            sy = u[b, 1] - u[a, 1]
            x = difference[r, 0] + sx
            y = difference[r, 1] + sy
            length = math.sqrt(x * x + y * y)
            nx = x / length
            ny = y / length
            stretch = ((difference[r, 0] + x) * sx + (difference[r, 1] + y) * sy) / (length + original[r])
            strain = (stretch + original[r] - rest[r]) / rest[r]
            force = stiffness[r] * (strain - plastic[r])
            if force > tension[r]:
                before = plastic[r]
                plastic[r] = strain - tension[r] / stiffness[r]
                dissipated += tension[r] * (plastic[r] - before) * rest[r]
                force = tension[r]
            elif force < -compression[r]:
                before = plastic[r]
                plastic[r] = strain + compression[r] / stiffness[r]
                dissipated += compression[r] * (before - plastic[r]) * rest[r]
                force = -compression[r]
            f[a, 0] += force * nx
            f[a, 1] += force * ny
            f[b, 0] -= force * nx
            f[b, 1] -= force * ny
            rate = (predicted[b, 0] - predicted[a, 0]) * nx + (predicted[b, 1] - predicted[a, 1]) * ny
            drag = damping[r] * rate
            resisting[a, 0] += drag * nx
            resisting[a, 1] += drag * ny
            resisting[b, 0] -= drag * nx
            resisting[b, 1] -= drag * ny
            axis[r, 0] = nx
            axis[r, 1] = ny
        for i in range(u.shape[0]):
            for d in range(2):
                v[i, d] += 0.5 * h * (f[i, d] + resisting[i, d]) * mobility[i, d]
                resisting[i, d] = 0.0
        for r in range(ends.shape[0]):
            a = ends[r, 0]
            b = ends[r, 1]
            rate = (v[b, 0] - v[a, 0]) * axis[r, 0] + (v[b, 1] - v[a, 1]) * axis[r, 1]
            drag = damping[r] * rate
            dissipated += drag * rate * h
            resisting[a, 0] += drag * axis[r, 0]
            resisting[a, 1] += drag * axis[r, 1]
            resisting[b, 0] -= drag * axis[r, 0]
            resisting[b, 1] -= drag * axis[r, 1]
    return dissipated


def arrays_of(model: Model, *, full: bool) -> list[np.ndarray]:
    """Fresh arguments for the plain kernels after (steps, h), from the columns of a model."""
    particles, rods = model.particles, model.rods
    shape = particles.position.shape
    shared = [
        np.zeros(shape),
        np.zeros(shape),
        np.zeros(shape),
        particles.mobility.copy(),
        particles.constant_force.copy(),
        rods.between.copy(),
        rods.difference.copy(),
        rods.original_length.copy(),
        rods.rest_length.copy(),
        rods.stiffness.copy(),
    ]
    if not full:
        return shared
    return [
        *shared,
        rods.damping.copy(),
        rods.tension_limit.copy(),
        rods.compression_limit.copy(),
        np.zeros(rods.count),
        np.zeros(shape),
        np.zeros(shape),
        np.zeros((rods.count, 2)),
    ]
