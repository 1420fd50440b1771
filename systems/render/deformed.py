"""Where particles are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from components.model import Model


def drawn_positions(model: Model) -> NDArray[np.float64]:
    """Original position + displacement × displacement scale of every particle (m), shape (n, 2)."""
    particles = model.particles
    scale = model.settings.displacement_scale
    drawn: NDArray[np.float64] = particles.position + scale * particles.displacement
    return drawn
