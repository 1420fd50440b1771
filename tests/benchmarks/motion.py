"""The equations of motion as one compiled function, for integrators that take any: scipy's."""

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pinjoint.components.model import Model

Array = NDArray[np.float64]


@njit(error_model="numpy")
def _rates(t, y, out, mobility, external, loads, ramp, ends, difference, original, rest, rods):
    """d/dt of (displacements, velocities, plastic strains); rods: stiffness, damping, tension, compression."""
    count, first = mobility.shape[0], 4 * mobility.shape[0]
    factor = min(max(t / ramp, 0.0), 1.0) if ramp > 0.0 else 1.0
    for i in range(count):
        for d in range(2):
            out[2 * i + d] = y[2 * (count + i) + d]
            out[2 * (count + i) + d] = external[i, d] + factor * loads[i, d]
    for r in range(ends.shape[0]):
        a, b = 2 * ends[r, 0], 2 * ends[r, 1]
        dx, dy = difference[r, 0], difference[r, 1]
        sx, sy = y[b] - y[a], y[b + 1] - y[a + 1]
        x, y_ = dx + sx, dy + sy
        length = math.sqrt(x * x + y_ * y_)
        nx, ny = x / length, y_ / length
        elongation = ((dx + x) * sx + (dy + y_) * sy) / (length + original[r]) + (original[r] - rest[r])
        va, vb = 2 * count + a, 2 * count + b
        rate = (y[vb] - y[va]) * nx + (y[vb + 1] - y[va + 1]) * ny
        trial = rods[0, r] * (elongation / rest[r] - y[first + r])
        force = min(max(trial, -rods[3, r]), rods[2, r])
        yields = (trial >= rods[2, r] and rate > 0.0) or (trial <= -rods[3, r] and rate < 0.0)
        out[first + r] = rate / rest[r] if yields else 0.0
        force += rods[1, r] * rate
        out[va] += force * nx
        out[va + 1] += force * ny
        out[vb] -= force * nx
        out[vb + 1] -= force * ny
    for i in range(count):
        for d in range(2):
            out[2 * (count + i) + d] *= mobility[i, d]


def equations(model: Model) -> tuple[Callable[[float, Array], Array], Array]:
    """(y' = f(t, y), y at the beginning) of a model whose loads all follow one ramp from 0.

    y: displacements (m), velocities (m/s), then the plastic strain of every rod.
    """
    particles, rods = model.particles, model.rods
    loads = np.zeros((particles.count, 2))
    ramp = 0.0
    for load in model.loads:
        loads[load.on] += load.force
        ramp = float(load.history.get("duration", 0.0))
    properties = np.stack([rods.stiffness, rods.damping, rods.tension_limit, rods.compression_limit])
    arguments = (
        particles.mobility.copy(),
        particles.constant_force.copy(),
        loads,
        ramp,
        rods.between.astype(np.int64),
        rods.difference.copy(),
        rods.original_length.copy(),
        rods.rest_length.copy(),
        properties,
    )
    start = np.concatenate([particles.displacement.ravel(), particles.velocity.ravel(), rods.plastic_strain])

    def rates(t: float, y: Array) -> Array:
        out = np.empty_like(y)
        _rates(t, y, out, *arguments)
        return out

    rates(0.0, start)
    return rates, start
