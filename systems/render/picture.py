"""A model as a picture: what is drawn, where, in which order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.view import View, drawn_positions
from systems.render.diagrams import draw_particle_diagrams, draw_rod_diagrams
from systems.render.help import draw_help
from systems.render.labels import place_labels
from systems.render.marks import Picture
from systems.render.overlays import draw_overlays, draw_scale
from systems.render.sheet import measure
from systems.render.structure import draw_ghost, draw_grid, draw_halos, draw_particles, draw_rods, label_names
from systems.render.supports import crowding, draw_supports, support_sides
from systems.render.theme import Theme

if TYPE_CHECKING:
    from components.model import Model

__all__ = ["compose", "drawn_positions"]


def compose(model: Model, view: View, theme: Theme) -> Picture:
    """The model as seen in a view, as marks in pixels. Reads the model, changes nothing.

    Forces are read only where a diagram shows them, yielding only where a rod has a strength.
    """
    sheet = measure(model, view, theme)
    draw_grid(sheet)
    draw_rod_diagrams(sheet)
    draw_ghost(sheet)
    draw_halos(sheet)
    crowd = crowding(sheet)
    sides = support_sides(model.particles.fixed, crowd)
    draw_supports(sheet, sides)
    draw_rods(sheet)
    draw_particles(sheet)
    draw_particle_diagrams(sheet, crowd, sides)
    label_names(sheet)
    overlays, room = draw_overlays(sheet)
    labels = place_labels(sheet.labels, sheet.occupancy, sheet.unit)
    scale = draw_scale(sheet, room) if model.particles.count else []
    viewport = view.camera.viewport
    return Picture(viewport, theme.background, [*sheet.marks, *labels, *scale, *overlays, *draw_help(sheet)])
