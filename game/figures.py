"""Figures and tables of structures on paper, as reports and sheets have them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pinjoint.components import written
from pinjoint.components.bent import AXIAL, MOMENT, SHEAR, deflections, is_frame
from pinjoint.components.camera import Camera, Viewport
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import bends, nodes
from pinjoint.components.spans import extremes
from pinjoint.components.tags import DiagramShown
from pinjoint.components.view import Cut, Shape, View
from pinjoint.methods.guide import scale_to
from pinjoint.systems.render.backends.paper import GUTTER, PIXEL, ROOMS, WIDTH, Block, Figure, Layout
from pinjoint.systems.render.marks import Mark, Strokes, Text
from pinjoint.systems.render.model.arrows import full_load, largest_force
from pinjoint.systems.render.model.diagrams import diagram_room
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import Theme, load_theme
from pinjoint.systems.render.typography import text_width
from pinjoint.systems.statics.envelope import Envelope
from pinjoint.systems.statics.equations import largest
from pinjoint.tables import Table

_BESIDE_IT, _ABOVE, _BELOW = 56.0, 46.0, 62.0  # pixels around a structure, for supports, loads and diagrams
_DIAGRAM = 30.0  # pixels of the largest axial force
_SPARE = 70.0  # pixels more below a structure and half as many above it, where values need them
_PART = 0.42  # of the height of a page, that of figures made larger
_RIGHT, _UNDER = 44.0, 24.0  # pixels for dimensions on the right and below
_REACTIONS = 44.0  # pixels more above and below a structure with loads and reactions
_TALL = 40.0  # pixels of the largest value in diagrams without these
_CAPTION = 28.0  # points of a page for the caption of its figure
_NUMBERED = 3  # values for which numbers may stand before a figure is made larger
_ROWS = 120  # of a table that are printed
_TICK, _TYPE = 4.0, 11.0  # points: of dimensions, half a tick and the size of numbers


def signs(model: Model) -> str:
    """What is positive."""
    if bends(model):
        return tr(
            "Signs: axial forces are positive in tension, reactions to the right, upwards and counter-clockwise."
            " Bending moments M are drawn on the side in tension, and are positive where that is the right side of a rod,"
            " seen from its start to its end."
        )
    return tr("Signs: axial forces are positive in tension, reactions to the right and upwards.")


def diagram_titles() -> dict[str, str]:
    """Captions of diagrams, by quantity."""
    return {
        MOMENT: tr("Bending moments M (kN·m), on the side in tension"),
        SHEAR: tr("Shear forces V (kN)"),
        AXIAL: tr("Axial forces N (kN)"),
    }


def shape(model: Model) -> tuple[float, float]:
    """Width and height of a structure (m)."""
    position = model.particles.position
    width, height = np.ptp(position, axis=0).tolist() if len(position) else (1.0, 1.0)
    return max(width, 1e-9), max(height, 1e-9)


def in_a_row(layout: Layout, model: Model) -> int:
    """How many figures stand in a row."""
    wide, high = shape(model)
    return 2 if wide > layout.flat * high else 3


def figure(
    layout: Layout,
    model: Model,
    caption: str,
    *,
    diagrams: str | None = None,
    cuts: Sequence[Cut] = (),
    has_units: bool = True,
    bare: bool = False,
    row: int = 0,
    unit: float = 1.0,
    measured: bool = False,
    moved: bool = False,
    grows: bool = False,
    over: Shape | None = None,
    enveloped: Envelope | None = None,
) -> Block:
    """A picture of a model, with the diagrams of a quantity or their envelope, and a shape over it.

    row: how many figures stand in a row; 0: by its shape. unit: pixels per point of its texts. bare: without loads and
    reactions. measured: with its dimensions, all names and reactions. moved: so that displacements are well seen, by which
    factor the caption says; else undeformed. grows: until every value is told, up to a page of its own, on its side if the
    structure is wider than high.
    """
    model.delete(list(model.grids))
    row = row or in_a_row(layout, model)
    rooms = [((WIDTH - (row - 1) * GUTTER) / row, layout.figure * unit, 0.0)]
    if grows:
        wide, high = shape(model)
        across, tall = ROOMS[wide > high]
        rooms += [(WIDTH, _PART * ROOMS[0][1], _SPARE), (across, tall - _CAPTION, 2.0 * _SPARE)]
    view = View(legend=False, has_scale=False, all_diagrams=diagrams is not None, quantity=diagrams or AXIAL)
    view.names, view.shape, view.enveloped = measured, over, enveloped
    view.cuts, view.has_units, view.bare, view.pixel_ratio = tuple(cuts), has_units, bare, unit
    frame = is_frame(model)
    model.settings.diagram_scale = scale_to(_DIAGRAM, 0.0 if frame else largest(model.rods.axial_force))
    model.settings.displacement_scale, model.settings.original_diagrams = 0.0, not moved
    loaded = full_load(model).any(axis=1) | measured
    model.tag_only([model.particles[row] for row in np.flatnonzero(loaded).tolist()], DiagramShown)
    theme = replace(load_theme("light"), background=(255, 255, 255, 255))
    found, said = list[Figure](), caption
    for room in rooms:
        view.camera = _camera(model, unit, *room, measured=measured)
        if bare and frame:
            model.settings.diagram_scale = max(_TALL * unit / diagram_room(view.camera.viewport, unit), 1.0)
        view.largest_force = 1.3 * largest_force(model, view)  # so much shorter is the longest arrow
        if moved:
            scale = model.settings.displacement_scale = _well_seen(model, view)
            said = joined([caption, tr("displacements × {scale}", scale=written.given(scale))], ", ")
        picture = compose(model, view, theme)
        if measured:
            picture.marks.extend(_dimensions(model, view, theme))
            wide, high = picture.viewport.width + unit * _RIGHT, picture.viewport.height + unit * _UNDER
            picture = replace(picture, viewport=Viewport(0, 0, int(wide), int(high)))
        found.append(Figure(picture, layout.text(said, "caption")))
        if picture.untold <= (0, _NUMBERED):
            break
    made = min(found, key=lambda figure: figure.picture.untold)
    return made.width, [made]


def _camera(model: Model, unit: float, across: float, tall: float, spare: float, *, measured: bool) -> Camera:
    """Where a structure stands in a room of so many points across, and tall at most, with spare pixels around it."""
    wide, high = shape(model)
    right, under = (unit * _RIGHT, unit * _UNDER) if measured else (0.0, 0.0)
    beside = unit * (_BESIDE_IT + 12.0 * is_frame(model))  # px more for the values of moments
    above = unit * (_ABOVE + _REACTIONS * measured + 0.5 * spare)
    below = unit * (_BELOW + 0.5 * _REACTIONS * measured + spare)
    width = across / PIXEL - right
    height = min((width - 2.0 * beside) * high / wide + above + below, tall / PIXEL - under)
    if spare:
        width = min(width, (height - above - below) * wide / high + 2.0 * (beside + unit * spare))
    camera = Camera(viewport=Viewport(0, 0, int(width), int(height)))
    inner = Viewport(int(beside), int(above), int(width - 2.0 * beside), int(height - above - below))
    camera.fit(model.particles.position, 0.0, inner, 1.0)
    return camera


def _well_seen(model: Model, view: View) -> float:
    """By how much displacements are enlarged so that they are well seen."""
    bending = np.flatnonzero(model.rods.bending_stiffness > 0.0)
    bows = extremes(deflections(model, bending).stretches)[0]
    most = max(float(np.hypot(*model.particles.displacement.T).max(initial=0.0)), largest(bows))
    return scale_to(_DIAGRAM * view.pixel_ratio / view.camera.scale, most)


def _dimensions(model: Model, view: View, theme: Theme) -> Iterator[Mark]:
    """Chains of dimensions (m) below the viewport and on its right, of what is not too close together."""
    unit, places = view.pixel_ratio, model.particles.position[nodes(model)]
    if not len(places):
        return
    pixels, size, seen = view.camera.to_pixels(places), round(_TYPE * unit), view.camera.viewport
    for axis, line in ((0, seen.height + (_UNDER - 2.0 * _TICK) * unit), (1, seen.width + 2.0 * _TICK * unit)):
        known, first = np.unique(places[:, axis].round(6), return_index=True)
        ticks = pixels[first, axis]
        texts = [written.given(length) for length in np.diff(known).tolist()]
        room = [text_width(text, size) if axis == 0 else 1.2 * size for text in texts]
        if any(wide > abs(gap) for wide, gap in zip(room, np.diff(ticks).tolist(), strict=True)):
            known, ticks = known[[0, -1]], ticks[[0, -1]]
            texts = [written.given(float(known[1] - known[0]))]
        if len(known) < 2:
            continue
        ends = np.full((len(ticks), 2), line)
        ends[:, axis] = ticks
        across = _TICK * unit * np.eye(2)[1 - axis]
        yield Strokes(ends[:-1], ends[1:], 0.75 * unit, theme.ink)
        yield Strokes(ends - across, ends + across, 0.75 * unit, theme.ink)
        for (x, y), text in zip(0.5 * (ends[:-1] + ends[1:]), texts, strict=True):
            if axis == 0:
                yield Text(text, x, y - 0.75 * size, size, theme.text, anchor="centre")
            else:
                yield Text(text, x + 4.0 * unit, y, size, theme.text)


def printed(
    layout: Layout,
    table: Table,
    *,
    without_last: bool = False,
    texts: Mapping[str, Sequence[str]] | None = None,
) -> list[Block]:
    """A table on paper, with a note where it is longer than is printed; perhaps without its last column.

    texts: further columns of texts, by their titles, behind the names.
    """
    columns = table.columns[:-1] if without_last else table.columns
    head = [table.corner, *(f"{column.title}\n{column.unit}" for column in columns)]
    rows = table[1 : 1 + min(len(table.names), _ROWS)]
    if table.summed:
        rows.append(table[len(table) - 1])
    between = [*zip(*(texts or {}).values(), strict=True)]
    rows = [(row[0], *(between[at] if texts else ()), *row[1 : len(head)]) for at, row in enumerate(rows)]
    head[1:1] = texts or {}
    made = layout.tables(head, rows, summed=table.summed)
    left_out = len(table.names) - _ROWS
    if left_out > 0:
        note = tr("{count} more rows are not printed; sums are of all.", count=left_out)
        made[-1][1].append(layout.text(note, "caption"))
    return made
