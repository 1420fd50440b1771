"""Picture: composes the marks of a model, form or toolbar in painter's order; and what lies at a pixel of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.form import Form
from pinjoint.components.load import Load, SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.toolbar import Toolbar
from pinjoint.components.view import Hit, Listing, View
from pinjoint.systems.broad_phase import distance_to_segments
from pinjoint.systems.render.labels.placing import Placed, place_labels
from pinjoint.systems.render.marks import Fills, Mark, Owners, Picture, Points, Stamps, Strokes
from pinjoint.systems.render.model.arrows import draw_loads, draw_particle_diagrams, draw_velocities
from pinjoint.systems.render.model.cuts import draw_cuts
from pinjoint.systems.render.model.diagrams import draw_diagrams
from pinjoint.systems.render.model.envelopes import draw_envelope, draw_enveloped_reactions
from pinjoint.systems.render.model.free_bodies import draw_free_bodies
from pinjoint.systems.render.model.members import (
    draw_hinges,
    draw_inextensible,
    draw_moments,
    draw_plastic_hinges,
    draw_span_loads,
)
from pinjoint.systems.render.model.sheet import MANY, Sheet, Shown, Stage, measure
from pinjoint.systems.render.model.structure import (
    draw_deflected,
    draw_ghost,
    draw_grid,
    draw_halos,
    draw_particles,
    draw_rods,
    draw_shape,
    label_names,
)
from pinjoint.systems.render.model.supports import draw_supports, support_sides
from pinjoint.systems.render.model.tools import draw_flashes, draw_preview, draw_trails
from pinjoint.systems.render.model.utilisation import shade_rods
from pinjoint.systems.render.theme import Colour, Theme, load_theme
from pinjoint.systems.render.ui.controls import put_controls
from pinjoint.systems.render.ui.form import compose_form
from pinjoint.systems.render.ui.layout import Paper
from pinjoint.systems.render.ui.lesson_card import compose_lesson
from pinjoint.systems.render.ui.listing import compose_listing
from pinjoint.systems.render.ui.overlays import (
    LIST,
    draw_overlays,
    draw_references,
    draw_scale,
    hidden_values,
    place_scale,
    put_notice,
    taken_by_heading,
)
from pinjoint.systems.render.ui.page import draw_page
from pinjoint.systems.render.ui.pointed import draw_pointed
from pinjoint.systems.render.ui.readouts import put_readouts
from pinjoint.systems.render.ui.toolbar import compose_toolbar

REACH = 6.0  # points from the lines of an arrow

_Lines = tuple[Points, Points, float, Owners]  # from, to, reach in pixels beside them, and whose each is


def compose_all(
    stages: Sequence[Stage], theme: Theme, placed: Callable[[Shown, View], Placed] | None = None
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
    model: Shown, view: View, theme: Theme, placed: Placed | None = None, others: Sequence[Picture] = ()
) -> Picture:
    """The model (or form, or toolbar, or table) as seen in a view, as marks in pixels. Reads it, changes nothing.

    Forces are read only where a diagram shows them, yielding only where a rod has a strength, and neither
    before they are known. placed: where labels were in the last picture of this model and view, updated to
    this one; labels move, come and go as little as possible. others: pictures beside or below this one, whose
    colours its legend explains if it does so for all, and which the tip of the toolbar does not cover.
    """
    if isinstance(model, Form):
        return compose_form(model, view, theme)
    if isinstance(model, Toolbar):
        return compose_toolbar(model, view, theme, others)
    if isinstance(model, Listing):
        return compose_listing(model, view, theme)
    if view.card is not None:
        return compose_lesson(view.card, view, theme)
    sheet = measure(model, view, theme, placed)
    if view.page is None:
        return _composed(sheet)
    if view.explains_all:
        sheet.legend = [name for picture in others for name in picture.meanings]
    return Picture(sheet.viewport, theme.background, draw_page(sheet))


def hits_at(model: Shown, view: View, theme: Theme, pixel: Vector) -> list[Hit]:
    """Where a press at a pixel does something in the picture of a stage, the topmost last.

    The toolbar is composed only where it or what opens over it may lie, a model only where panels stand beside it or
    a notice has a button.
    """
    if isinstance(model, Toolbar) and not (view.strip.contains(pixel) or view.help or view.menu):
        return []
    if isinstance(model, Listing) and not view.table_place.contains(pixel):
        return []
    paper, panels = Paper(view.pixel_ratio), view.readouts and view.legend and view.panels.contains(pixel)
    if not isinstance(model, Model) or view.card is not None or panels or view.status.offer:
        paper.hits += compose(model, view, theme).hits
    else:
        put_controls(paper, model, view, theme)
    return [hit for hit in paper.hits if hit.contains(pixel)]


def _draw_structure(sheet: Sheet) -> None:
    """Rods, supports and particles, with diagrams, loads and velocities."""
    if sheet.view.enveloped is None:
        draw_diagrams(sheet, taken_by_heading(sheet))
    else:
        draw_envelope(sheet, sheet.view.enveloped, taken_by_heading(sheet))
    draw_ghost(sheet)
    if sheet.view.enveloped is None:
        draw_deflected(sheet)
    draw_halos(sheet)
    sides = support_sides(sheet)
    draw_supports(sheet, sides)
    shade_rods(sheet)
    draw_rods(sheet)
    draw_particles(sheet)
    draw_hinges(sheet)
    draw_plastic_hinges(sheet)
    draw_inextensible(sheet)
    sheet.marks += sheet.above
    draw_cuts(sheet)
    draw_shape(sheet)
    _draw_arrows(sheet, sides)


def _draw_arrows(sheet: Sheet, sides: NDArray[np.int64]) -> None:
    """Loads, velocities and reactions, beside supports on these sides of particles."""
    if sheet.view.bare:
        return
    if sheet.view.enveloped is not None:
        draw_enveloped_reactions(sheet, sheet.view.enveloped)
        return
    draw_span_loads(sheet)
    if not sheet.view.all_diagrams:
        draw_loads(sheet)
    draw_velocities(sheet)
    draw_moments(sheet)
    draw_particle_diagrams(sheet, sides)


def _composed(sheet: Sheet) -> Picture:
    """The picture of a model."""
    model, theme = sheet.model, sheet.theme
    draw_grid(sheet)
    for layer in EXTENSIONS.below:
        sheet.marks += layer(sheet)
    sheet.marks += draw_trails(sheet)
    if sheet.view.free_bodies and sheet.view.forces_known:
        draw_halos(sheet)
        draw_free_bodies(sheet)
        draw_span_loads(sheet)
        draw_particles(sheet)
    else:
        _draw_structure(sheet)
    label_names(sheet)
    for layer in EXTENSIONS.above:
        sheet.marks += layer(sheet)
    overlays, room = draw_overlays(sheet)
    paper = Paper(sheet.unit, sheet.view.pointer, overlays)
    for place in (*sheet.view.slider_places, *[sheet.view.choices_place] * bool(sheet.view.sliders.choices)):
        sheet.occupancy.block(*place.box)
    put_readouts(paper, sheet, room)
    put_notice(paper, sheet, room)
    scale = place_scale(sheet, room) if model.particles.count and sheet.view.has_scale else None
    put_controls(paper, model, sheet.view, theme)
    preview = draw_preview(sheet)
    former = dict(sheet.placed)
    labels, referred = place_labels(
        sheet.labels, sheet.occupancy, sheet.unit, sheet.placed, steady=sheet.view.steady
    )
    over = [
        *draw_references(sheet, referred, former.get(LIST, -1)),
        *draw_scale(sheet, scale),
        *draw_flashes(sheet),
        *preview,
        *overlays,
        *draw_pointed(sheet, former),
    ]
    sheet.placed |= sheet.scales
    marks = [*sheet.marks, *labels, *over]
    untold = hidden_values(sheet, sheet.placed), len(referred)
    return Picture(sheet.viewport, theme.background, marks, tuple(sheet.legend), paper.hits, untold)


# --- whose the arrows are ----------------------------------------------------------------------------


def symbol_at(model: Model, view: View, pixel: Vector) -> Particle | Rod | None:
    """The particle or rod whose arrow or support lies under a pixel, of a load that which bears it."""
    found = _symbol_at(model, view, pixel)
    if isinstance(found, Load):
        return found.particle
    return model.rods[found.rod] if isinstance(found, SpanLoad) else found


def load_at(model: Model, view: View, pixel: Vector) -> Particle | Rod | Load | SpanLoad | None:
    """Whose arrow of a load lies under a pixel."""
    return _symbol_at(model, view, pixel, load_theme(view.theme).load)


def _symbol_at(
    model: Model, view: View, pixel: Vector, colour: Colour | None = None
) -> Particle | Rod | Load | SpanLoad | None:
    """Whose arrow or support lies under a pixel, of a colour or any.

    None in large models, and while something is drawn, when a click means a place.
    """
    elsewhere = view.covers(pixel) or not view.camera.viewport.contains(pixel)
    if elsewhere or view.tool or view.preview is not None or model.particles.count > MANY:
        return None
    sheet = measure(model, view, load_theme(view.theme))
    best, found = np.inf, None
    marks = [mark for mark in _symbols(sheet) if colour is None or getattr(mark, "colour", None) == colour]
    for start, end, reach, of in (lines for mark in marks for lines in _lines_of(mark, sheet.unit)):
        away = distance_to_segments(np.array(pixel), start, end)
        if len(away) and (nearest := int(np.argmin(away))) >= 0 and away[nearest] <= min(reach, best):
            best, found = float(away[nearest]), (of[0], int(of[1][nearest]))
    return None if found is None else model.tables[found[0]][found[1]]


def _symbols(sheet: Sheet) -> list[Mark]:
    """The marks of supports and arrows as the picture has them."""
    if sheet.view.free_bodies and sheet.view.forces_known:
        draw_free_bodies(sheet)
        draw_span_loads(sheet)
    else:
        sides = support_sides(sheet)
        draw_supports(sheet, sides)
        if sheet.view.enveloped is None:  # which may be of the model before, and has no arrows
            _draw_arrows(sheet, sides)
    return sheet.marks


def _lines_of(mark: Mark, unit: float) -> Iterator[_Lines]:
    """The lines along which a mark of elements lies."""
    match mark:
        case Strokes(start, end, _, _, (str(), _) as of):
            yield start, end, REACH * unit, of
        case Fills(corners, _, (str(), _) as of):
            for k in range(corners.shape[1]):
                yield corners[:, k - 1], corners[:, k], REACH * unit, of
        case Stamps(_, at, size, turns=turns, of=(str(), _) as of):
            quarter = 0.5 * np.pi * turns
            yield at, at + size * np.array([np.cos(quarter), np.sin(quarter)]), size / 2, of
