"""Collisions in the window: the number of impacts, and the speeds of a gas beside Rayleigh's curve."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pinjoint.components import Model, Plot, Readout, Vector, written
from pinjoint.components.arrays import Array
from pinjoint.components.language import marked, tr
from pinjoint.components.rod import nodes
from pinjoint.mods import App

if TYPE_CHECKING:  # a command needs no editor
    from pinjoint.editor.context import Context

MANY = 100  # particles without rods from which on their speeds are shown by default
BINS = 16
_RANGE = 2.5  # times the root mean square speed, that the bars cover

ICON = (
    ("line", (-8.5, 8, 8.5, 8)),
    *(
        ("area", (x, 8, x, 8 - high, x + 2.6, 8 - high, x + 2.6, 8))
        for x, high in ((-7, 5), (-3.5, 12), (0, 15), (3.5, 7))
    ),
)


_asked: weakref.WeakKeyDictionary[Context, bool] = weakref.WeakKeyDictionary()


def free_speeds(model: Model) -> Array:
    """Speeds v √(m / m̄) (m/s) of the particles that no rod holds, m̄ their mean mass.

    In equilibrium the energies of all particles have one distribution, and so do these speeds for any masses.
    """
    particles = model.particles
    free = np.logical_not(particles.fixed.all(axis=1) | nodes(model))
    mass = particles.mass[free]
    found: Array = np.hypot(*particles.velocity[free].T) * np.sqrt(mass / (mass.mean() if len(mass) else 1.0))
    return found


def rayleigh(speed: Array, mean_square: float) -> Array:
    """Density (s/m) of the speeds of a two-dimensional gas: 2v/⟨v²⟩ exp(−v²/⟨v²⟩)."""
    return 2 * speed / mean_square * np.exp(-(speed**2) / mean_square)


def histogram(speed: Array, mean_square: float) -> tuple[Array, Array]:
    """Outline of the bars of a histogram: speeds (m/s) and densities (s/m)."""
    edges = np.linspace(0.0, _RANGE * np.sqrt(mean_square), BINS + 1)
    density, _ = np.histogram(np.minimum(speed, edges[-1]), edges)
    heights = density / (len(speed) * (edges[1] - edges[0]))
    return np.repeat(edges, 2), np.concatenate([[0.0], np.repeat(heights, 2), [0.0]])


def _is_gas(model: Model) -> bool:
    """True for many free particles that nothing accelerates."""
    pulled = any(model.environment.acceleration) or model.particles.acceleration.any()
    return not pulled and not model.rods.count and int((~model.particles.fixed.all(axis=1)).sum()) >= MANY


def _toggle_speeds(session: Context, pixel: Vector) -> None:
    """Show or hide the speeds of the particles."""
    shown = _asked[session] = not _asked.get(session, _is_gas(session.model))
    if not shown:
        session.notice = tr("The speeds of particles are hidden.")
    elif free_speeds(session.model).any():
        session.notice = tr("The speeds of particles are shown beside Rayleigh's curve.")
    else:
        session.notice = tr("The speeds of particles are shown as soon as a particle without rods moves.")


def panels(session: Context) -> Sequence[Readout]:
    """A panel with the number of impacts, if any, and one with the speeds, of a gas or on demand."""
    made = []
    if session.model.clock.collisions:
        made.append(Readout(tr("Impacts"), ((tr("so far"), str(session.model.clock.collisions)),)))
    if _asked.get(session, _is_gas(session.model)):
        speed = free_speeds(session.model)
        mean_square = float((speed**2).mean()) if len(speed) else 0.0
        if mean_square > 0.0:
            made.append(_speeds(speed, mean_square, session.model.clock.steps))
    return made


def _speeds(speed: Array, mean_square: float, revision: int) -> Readout:
    smooth = np.linspace(0.0, _RANGE * np.sqrt(mean_square), 80)
    curves = (
        (tr("particles"), *histogram(speed, mean_square)),
        (tr("Rayleigh"), smooth, rayleigh(smooth, mean_square)),
    )
    expected = np.sqrt(np.pi * mean_square) / 2
    rows = (
        (tr("mean"), f"{written.number(speed.mean())} m/s"),
        (tr("mean by Rayleigh"), f"{written.number(expected)} m/s"),
    )
    return Readout(
        tr("Speeds"),
        rows,
        Plot(tr("speed (m/s)"), tr("density (s/m)"), curves, hash((revision, speed.tobytes()))),
        closes="collisions.speeds",
    )


def plugin(app: App) -> None:
    """Register the panels and the key."""
    app.panel(panels)
    live, title = ("simulation", "pause"), marked("show or hide the speeds of particles")
    app.action("collisions.speeds", key="u", scenes=live, title=title, icon=ICON)(_toggle_speeds)
