"""Picture: composes the marks of a model, form or toolbar in painter's order."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.form import Form
from pinjoint.components.model import Model
from pinjoint.components.toolbar import Toolbar
from pinjoint.components.view import View
from pinjoint.systems.render.arrows import draw_loads, draw_particle_diagrams, draw_velocities
from pinjoint.systems.render.cuts import draw_cuts
from pinjoint.systems.render.diagrams import draw_diagrams
from pinjoint.systems.render.empty_card import draw_card, shows_card
from pinjoint.systems.render.free_bodies import draw_free_bodies
from pinjoint.systems.render.labels import Placed, place_labels
from pinjoint.systems.render.lesson_card import draw_lesson
from pinjoint.systems.render.marks import Picture
from pinjoint.systems.render.members import draw_distributed_forces, draw_hinges, draw_moments
from pinjoint.systems.render.overlays import BAR, draw_notice, draw_overlays, draw_scale, place_scale
from pinjoint.systems.render.page import draw_page
from pinjoint.systems.render.panel import compose_form
from pinjoint.systems.render.pointed import draw_pointed
from pinjoint.systems.render.readouts import ShownPanel, draw_readouts
from pinjoint.systems.render.sheet import Sheet, measure
from pinjoint.systems.render.sliders import draw_sliders
from pinjoint.systems.render.structure import (
    draw_ghost,
    draw_grid,
    draw_halos,
    draw_particles,
    draw_rods,
    draw_shape,
    label_names,
)
from pinjoint.systems.render.supports import draw_supports, support_sides
from pinjoint.systems.render.theme import Theme
from pinjoint.systems.render.toolbar import compose_toolbar
from pinjoint.systems.render.tools import draw_flashes, draw_preview
from pinjoint.systems.render.utilisation import shade_rods

Stage = tuple[Model | Form | Toolbar, View]  # what is shown, and how


def compose_all(
    stages: Sequence[Stage],
    theme: Theme,
    placed: Callable[[Model | Form | Toolbar, View], Placed] | None = None,
) -> list[Picture]:
    """The pictures of all stages, in their order; placed: where labels of a stage were.

    Those that depend on others come to know them: legends that explain all, and the toolbar's tip.
    """
    pictures: dict[int, Picture] = {}
    ranks = [2 if isinstance(shown, Toolbar) else int(view.explains_all) for shown, view in stages]
    for index in sorted(range(len(stages)), key=ranks.__getitem__):
        where = placed(*stages[index]) if placed is not None else None
        pictures[index] = compose(*stages[index], theme, where, [*pictures.values()])
    return [pictures[index] for index in range(len(stages))]


def compose(
    model: Model | Form | Toolbar,
    view: View,
    theme: Theme,
    placed: Placed | None = None,
    others: Sequence[Picture] = (),
) -> Picture:
    """The model (or form, or toolbar) as seen in a view, as marks in pixels. Reads it, changes nothing.

    Forces are read only where a diagram shows them, yielding only where a rod has a strength, and neither
    before they are known. placed: where labels were in the last picture of this model and view, updated to
    this one; labels move, come and go as little as possible. others: pictures beside or below this one, whose
    colours its legend explains if it does so for all, and which the tip of the toolbar does not cover.
    """
    if isinstance(model, Form):
        return compose_form(model, view, theme)
    if isinstance(model, Toolbar):
        return compose_toolbar(model, view, theme, others)
    if view.card is not None:
        return Picture(view.camera.viewport, theme.panel, draw_lesson(view, theme))
    sheet = measure(model, view, theme, placed)
    if view.page is None:
        return _composed(sheet)[0]
    if view.explains_all:
        sheet.legend = [name for picture in others for name in picture.meanings]
    return Picture(sheet.viewport, theme.background, draw_page(sheet))


def on_status_bar(view: View, pixel: Vector) -> bool:
    """True if a pixel of the picture of a model shows the status bar."""
    v = view.canvas
    return v.contains(pixel) and pixel[1] >= v.bottom - BAR * view.pixel_ratio


def panel_at(model: Model, view: View, theme: Theme, pixel: Vector) -> ShownPanel | None:
    """The panel that a pixel of the picture of a model shows."""
    if not (view.readouts and view.legend and view.panels.contains(pixel)):
        return None
    return next((panel for panel in shown_panels(model, view, theme) if panel.place.contains(pixel)), None)


def shown_panels(model: Model, view: View, theme: Theme) -> list[ShownPanel]:
    """The panels in the picture of a model."""
    return _composed(measure(model, view, theme))[1]


def _draw_structure(sheet: Sheet) -> None:
    """Rods, supports and particles, with diagrams, loads and velocities."""
    draw_diagrams(sheet)
    draw_ghost(sheet)
    draw_halos(sheet)
    sides = support_sides(sheet)
    draw_supports(sheet, sides)
    shade_rods(sheet)
    draw_rods(sheet)
    draw_particles(sheet)
    draw_hinges(sheet)
    sheet.marks += sheet.above
    draw_distributed_forces(sheet)
    draw_loads(sheet)
    draw_velocities(sheet)
    draw_moments(sheet)
    draw_cuts(sheet)
    draw_shape(sheet)
    draw_particle_diagrams(sheet, sides)


def _composed(sheet: Sheet) -> tuple[Picture, list[ShownPanel]]:
    """The picture of a model, and where its panels are."""
    model, theme = sheet.model, sheet.theme
    draw_grid(sheet)
    for layer in EXTENSIONS.below:
        sheet.marks += layer(sheet)
    if sheet.view.free_bodies and sheet.view.forces_known:
        draw_halos(sheet)
        draw_free_bodies(sheet)
        draw_distributed_forces(sheet)
        draw_particles(sheet)
    else:
        _draw_structure(sheet)
    label_names(sheet)
    for layer in EXTENSIONS.above:
        sheet.marks += layer(sheet)
    overlays, room = draw_overlays(sheet)
    overlays += draw_sliders(sheet)
    readouts, panels = draw_readouts(sheet, room)
    overlays += readouts
    overlays += draw_notice(sheet, room)
    scale = place_scale(sheet, room) if model.particles.count and sheet.view.has_scale else None
    if shows_card(model, sheet.view):
        overlays += draw_card(sheet.view, theme)
    labels = place_labels(sheet.labels, sheet.occupancy, sheet.unit, sheet.placed)
    over = [
        *draw_scale(sheet, scale),
        *draw_flashes(sheet),
        *draw_preview(sheet),
        *overlays,
        *draw_pointed(sheet),
    ]
    sheet.placed |= sheet.scales
    marks = [*sheet.marks, *labels, *over]
    return Picture(sheet.viewport, theme.background, marks, tuple(sheet.legend)), panels
