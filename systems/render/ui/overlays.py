"""Overlays: heading, status bar, problem banner, legend and scale bar."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from itertools import product

import numpy as np

from pinjoint.components import written
from pinjoint.components.bent import farthest
from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.cases import acting
from pinjoint.components.field import on_screen
from pinjoint.components.language import begun, marked, plural, tr
from pinjoint.components.round_numbers import round_down
from pinjoint.components.theory import EXACT, FIRST_ORDER, NAMES, THEORIES
from pinjoint.components.view import BETWEEN, LEAST_MODEL
from pinjoint.systems.render import marks
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.labels.placing import GIVEN, Numbered, Placed
from pinjoint.systems.render.marks import Discs, Mark, Panel, Stamps, Strokes
from pinjoint.systems.render.model.diagrams import EXPLAINED
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.model.structure import HALO_OPACITY
from pinjoint.systems.render.model.utilisation import scale_bar
from pinjoint.systems.render.symbols import dashed
from pinjoint.systems.render.theme import Colour, Theme, faded
from pinjoint.systems.render.typography import ALL, font_size, line_height, text_width, wrapped
from pinjoint.systems.render.ui.buttons import button
from pinjoint.systems.render.ui.layout import Column, Drawn, Gap, Paper, Part, Plate, Row, Text, icon

EDGE = 14.0  # points between overlays and the edges of the viewport
_FEW_LINES, _AROUND_NOTICE = 3, 52.0  # of a notice: lines; points at the sides of its text, its sign among them
BAR = 28.0  # points, height of the status bar
_ROW, _ROWS_BESIDE = 28.0, 2  # of the legend: points, and how many stand beside the heading
_STRIP = 19.0  # points, height of the scale
_TALL = 8, 12, 16, 24, 5, 3, 2, 1  # rows of numbered values, where they find room
_SCALE, LIST = ("scale", 0), ("list", 0)  # keys by which their places are kept
_WIDEST = 100_000  # pixels


def draw_overlays(sheet: Sheet) -> tuple[list[Mark], tuple[float, float]]:
    """Marks in fixed places, kept free of labels; and the height taken at the top and the bottom."""
    status, bottom = _status_bar(sheet)
    v, u = sheet.viewport, sheet.unit
    text, heading = _heading(sheet.view.heading, sheet.theme), Paper(u)
    room = v.width - 2 * EDGE * u
    right, top = float(v.left), float(v.top)
    if sheet.view.heading:
        lines = text.height(u, room)
        heading.put(text, Rectangle(v.left + EDGE * u, v.top + 9.0 * u, room, lines))
        right, top = v.left + EDGE * u + min(text.width(u), room), v.top + (EDGE - 4.0) * u + lines
    sheet.occupancy.block_marks(heading.marks)
    legend, below = _legend(sheet, right, top)
    caption, below = _caption(sheet, top, below)
    return status + heading.marks + legend + caption, (below, bottom)


# --- the status bar --------------------------------------------------------------------------------


def _status_bar(sheet: Sheet) -> tuple[list[Mark], float]:
    """The bar at the bottom, if there is anything to say, and the height that is left above it.

    The time and the pace are left out where they would leave no room for the next possible step.
    """
    v, u, theme, status = sheet.viewport, sheet.unit, sheet.theme, sheet.view.status
    if not (status.state or status.hint):
        return [], float(v.bottom)
    top, thin = round(v.bottom - BAR * u), max(round(u), 1)
    sheet.occupancy.block(v.left, top, v.width, BAR * u)
    bar: list[Mark] = [
        Panel(v.left, top, v.width, v.bottom - top, 0.0, theme.panel),
        Panel(v.left, top, v.width, thin, 0.0, theme.line),
    ]
    paper, steps, parts = Paper(u, marks=bar), status.hint.split(BETWEEN), list[Part]()
    if status.state:
        state = Text(begun(tr(status.state)), 12.0, theme.text, "semibold")
        moods = {"running": theme.running, "paused": theme.halted, "halted": theme.halted}
        mood = moods.get(status.state.partition(" ")[0], theme.resting)
        parts.append(Row((icon("disc", 3.5, theme.problem if status.problem else mood, 7.0), state), 6.0))
        time = "" if status.time is None else f"t = {written.time(status.time)}"
        for said in filter(None, (time, written.pace(status.speed))):
            text = Text(said, 12.0, theme.text)
            behind = 6.0 * u + text_width(steps[0], sheet.font(12.0))
            whole = Row([*parts, text], 18.0, (EDGE, 0.0, 0.0)).width(u) + behind
            parts += [text] if whole <= v.width else []
    room = v.width - Row(parts, 18.0, (EDGE, 0.0, 0.0)).width(u) - 24.0 * u
    while len(steps) > 1 and text_width(BETWEEN.join(steps), sheet.font(12.0)) > room:
        steps.pop()
    hint = Text(BETWEEN.join(steps), 12.0, theme.muted, anchor="right", grow=1.0)
    paper.put(
        Row([*parts, hint], 18.0, (EDGE, 0.0, 0.0)),
        Rectangle(v.left, top + thin, v.width, v.bottom - top - thin),
    )
    return paper.marks, float(top)


# --- heading and problem ---------------------------------------------------------------------------


def _heading(said: str, theme: Theme) -> Text:
    """The heading (the mode, or the next task), top left."""
    return Text(said, 20.0, theme.text, "semibold", lines=ALL)  # points


def heading_height(text: str, width: float, unit: float, theme: Theme, explained: Sequence[str] = ()) -> float:
    """Pixels that a heading takes at the top of a viewport, with a legend that explains these names."""
    heading, room = _heading(text, theme), width - 2 * EDGE * unit
    height = heading.height(unit, room) + (EDGE + 4.0) * unit
    if not explained:
        return height
    right = EDGE * unit + min(heading.width(unit), room)
    plates, beside = _arranged(tuple(meanings_of(explained).items()), theme, width, right, unit)
    rows = len(plates) * _ROW * unit
    return max(height, rows + 2 * _ABOVE * unit - 4.0 * unit) if beside else height + rows


def taken_by_heading(sheet: Sheet) -> float:
    """Pixels that the heading of a picture takes at the top, with the legend of diagrams of rods that bend."""
    if not sheet.is_frame:
        return 0.0
    explained = (*EXPLAINED[sheet.view.quantity], *_theory(sheet)) if sheet.view.legend else ()
    return heading_height(sheet.view.heading, sheet.viewport.width, sheet.unit, sheet.theme, explained)


def _caption(sheet: Sheet, heading_end: float, top: float) -> tuple[list[Mark], float]:
    """The caption of the viewport and the title of a shape, at the top between hairlines; and the lower end of all there.

    They stand below the legend, which ends at `top`; a title alone beside it where it has room there.
    """
    v, u, theme = sheet.viewport, sheet.unit, sheet.theme
    paper, shape, thin = Paper(u), sheet.view.shape, max(round(u), 1)
    looks = [(line, "regular", theme.muted) for line in sheet.view.caption]
    if looks:
        sides = (v.width, thin), (thin, v.height)
        paper.marks += [Panel(v.left, v.top, *size, 0.0, theme.line) for size in sides]
        looks[0] = looks[0][0], "semibold", theme.text
    if sheet.view.provisional and not _RESULTS.isdisjoint(sheet.legend):
        looks.append((sheet.view.provisional, "semibold", theme.halted))
    if shape is not None:
        looks.append((shape.title, "semibold", theme.sketch))
    if not looks:
        return [], top
    room = v.width - 2 * EDGE * u
    behind = faded(theme.background, 0.85)  # keeps lines of a grid out of the text
    lines = []
    for said, weight, colour in looks:
        for line in wrapped(said, room, sheet.font(13.0), weight):
            text = Row((Text(line, 13.0, colour, weight),), around=(4.0, 0.0, 0.0))
            lines.append(Row((Plate(text, behind, radius=3.0), Gap(grow=1.0))))
    column = Column(lines)
    high, wide = column.height(u, room), column.width(u)
    left, upper = v.left + EDGE * u, top
    if not sheet.view.caption and not sheet.occupancy.is_taken(left, heading_end + 8.0 * u, wide, high):
        upper = heading_end
    paper.put(column, Rectangle(left - 4.0 * u, upper + 8.0 * u, room + 8.0 * u, high))
    sheet.occupancy.block_marks(paper.marks)
    return paper.marks, max(top, upper + 8.0 * u + high)


def put_notice(paper: Paper, sheet: Sheet, ends: tuple[float, float]) -> None:
    """The problem or the notice, wrapped, with its button, at the bottom or the top, in the middle or aside, where it hides
    least."""
    status, (top, bottom) = sheet.view.status, ends
    said = status.problem or status.notice
    if not said:
        return
    u, theme = sheet.unit, sheet.theme
    ink, ground = (theme.problem, theme.problem_panel) if status.problem else (theme.text, theme.panel)
    sign = Drawn(partial(_exclaimed, "!" if status.problem else "i", ink, ground), 18.0, 18.2)
    offer = []
    if status.offer is not None and not status.problem:
        title, action = status.offer
        said_on_it = Row((Text(title, 12.0, theme.focus, "semibold"),), around=(8.0, 1.0, 1.0))
        offer = [button(said_on_it, action, theme, stands_out=True)]
    # beside the panels, unless it is long; the button beside the text, unless this is long there
    for v, beside in ((sheet.view.room, offer), (sheet.view.room, []), (sheet.viewport, offer)):
        around = _AROUND_NOTICE * u + sum(one.width(u) + 10.0 * u for one in beside)
        room = min(v.width - 2 * EDGE * u, 640.0 * u) - around
        most = max(int((min(bottom, v.bottom) - top - 60.0 * u) / line_height(sheet.font(13.0))), 1)
        text = Text(said, 13.0, ink, lines=most, grow=1.0)
        if text.height(u, room) <= _FEW_LINES * line_height(sheet.font(13.0)):
            break
    widest = max(text_width(line, sheet.font(13.0)) for line in wrapped(said, room, sheet.font(13.0)))
    below = [] if beside or not offer else [Row((Gap(grow=1.0), *offer))]
    inside = Column((Row((sign, text, *beside), 10.0, top=True), *below), 6.0, (12.0, 10.0, 10.0))
    whole = Plate(inside, ground, ink if status.problem else theme.line, radius=6.0)
    width = max([widest + around, *(one.width(u) + 24.0 * u for one in offer)])
    height = whole.height(u, width)
    places = _for_notice(sheet, v, width, height, (top, min(bottom, v.bottom)))
    left, upper = _least_hidden(sheet, places, width, height)
    sheet.occupancy.block(left, upper, width, height)
    paper.put(whole, Rectangle(left, upper, width, height))
    paper.marks += _progress(sheet, left + 12.0 * u, upper + height - 5.0 * u, width - 24.0 * u)


def _exclaimed(sign: str, ink: Colour, paper: Colour, place: Rectangle, u: float) -> list[Mark]:
    """A sign in a disc."""
    (x, y), size = place.middle, font_size(13.0, u)
    disc = Stamps("disc", np.array([[x, y]]), 9.0 * u, u, ink, ink)
    return [disc, marks.Text(sign, x, y, size, paper, "semibold", "centre")]


def _for_notice(
    sheet: Sheet, v: Viewport, width: float, height: float, ends: tuple[float, float]
) -> list[tuple[float, float]]:
    """Left and top of places for a notice: in the middle, or to the right of it, below, at the top or above sliders."""
    gap, (top, bottom) = 10.0 * sheet.unit, ends
    sliders = min((place.top for place in sheet.view.slider_places), default=bottom)
    across = v.left + (v.width - width) / 2, v.right - width - gap
    return [
        (left, upper)
        for upper in (bottom - height - gap, top + gap, sliders - height - gap)
        for left in across
        if upper >= top
    ] or [(across[0], bottom - height - gap)]


def _progress(sheet: Sheet, left: float, top: float, width: float) -> list[Mark]:
    """A bar that says how much of what the notice tells of is done."""
    status, thick, theme = sheet.view.status, 3.0 * sheet.unit, sheet.theme
    if status.share is None or status.problem:
        return []
    done = max(status.share * width, thick)
    return [
        Panel(left, top, width, thick, thick / 2, theme.line, None),
        Panel(left, top, done, thick, thick / 2, theme.text, None),
    ]


# --- legend ----------------------------------------------------------------------------------------

_RESULTS = {"tension", "compression", "moment", "shear", "reaction", "reaction moment", "utilisation"}
_ABOVE, _PAD, _BETWEEN = 10.0, 9.0, 14.0  # points: to the edges, inside a row, between its entries
MEANINGS = {
    "tension": marked("tension"),
    "compression": marked("compression"),
    "moment": marked("M on the tension side"),
    "shear": marked("shear force V"),
    "yielding": marked("yielding"),
    "utilisation": marked("utilisation 0 to 100 %"),
    "axial utilisation": marked("utilisation 0 to 100 %, of N alone where the depth is unknown"),
    "first": marked("first to yield"),
    "near buckling": marked("pulses: compression above 0.8 of the critical"),
    "slack": marked("slack cable"),
    "load": marked("load"),
    "reaction": marked("reaction"),
    "inertia": marked("inertia −m a"),
    "velocity": marked("velocity"),
    "hinge": marked("hinge"),
    "plastic hinge": marked("plastic hinge"),
    "spring": marked("spring"),
    "inextensible": marked("inextensible"),
    "ghost": marked("undeformed"),
    "deflected": marked("deflected"),
    **NAMES,
}
_SCALES = ("utilisation", "axial utilisation")
_ACTING = "acting"  # what of load cases is shown
_IN_WORDS = (*THEORIES, _ACTING)
# By what occurs of a colour.
UNITS = dict.fromkeys(("tension", "compression", "shear", "load", "reaction", "inertia"), "kN")
UNITS |= {"load per length": "kN/m"}
UNITS |= dict.fromkeys(("moment", "load moment", "reaction moment", "inertia moment"), "kN·m")
_MEANT = {name: [of for of in UNITS if of.split(" ")[0] == name] for name in MEANINGS}  # what shares a colour


def meanings_of(legend: Sequence[str]) -> dict[str, str]:
    """The colours of a legend, in order, and what they mean, with the units that occur."""
    found = {}
    for name, meaning in MEANINGS.items():
        units = [on_screen(UNITS[of])[0] for of in _MEANT[name] if of in legend]
        if units or name in legend:
            said = tr(meaning)
            found[name] = f"{said} ({', '.join(units)})" if units else said
    return found


def _legend(sheet: Sheet, right: float, heading_end: float) -> tuple[list[Mark], float]:
    """The colours that occur and what they mean, in rows top right; and the lower end of all at the top.

    They stand beside the heading, which ends at `right`, if one or two rows have room there, else below it.
    """
    v, u, theme = sheet.viewport, sheet.unit, sheet.theme
    meanings = meanings_of([*sheet.legend, *_theory(sheet)]) if sheet.view.legend and sheet.legend else {}
    shown = sheet.view.enveloped
    if meanings and (said := acting(sheet.model) if shown is None else shown.said):
        meanings[_ACTING] = said
    if not meanings or v.width < LEAST_MODEL * u:
        return [], heading_end
    plates, beside = _arranged(tuple(meanings.items()), theme, v.width, right - v.left, u)
    top = v.top + _ABOVE * u if beside else heading_end + 8.0 * u
    paper = Paper(u)
    for plate in plates:
        width = plate.width(u)
        paper.put(plate, Rectangle(v.right - _ABOVE * u - width, top, width, 24.0 * u))
        top += _ROW * u
    sheet.occupancy.block_marks(paper.marks)
    return paper.marks, max(top - 4.0 * u, heading_end)


def _theory(sheet: Sheet) -> tuple[str, ...]:
    """The theory of what is shown in statics."""
    return () if sheet.model.solution is None else (FIRST_ORDER if sheet.model.first_order else EXACT,)


@lru_cache(maxsize=16)  # pictures of a model have two at most
def _arranged(
    meanings: tuple[tuple[str, str], ...], theme: Theme, width: float, heading: float, u: float
) -> tuple[list[Plate], bool]:
    """A legend in rows, and whether it stands beside the heading, which takes the left up to `heading`, else below it."""
    entries = []
    for name, said in meanings:
        wide = 70.0 if name in _SCALES else 16.0  # points: a scale, a symbol
        swatch = [] if name in _IN_WORDS else [Drawn(partial(_swatch, name, theme), wide)]
        text = Text(said, 11.0, theme.text, "semibold" if name in _IN_WORDS else "regular")
        entries.append(Row((*swatch, text), 6.0))
    room = width - heading - (_ABOVE + _BETWEEN + 2 * _PAD) * u
    beside = max(entry.width(u) for entry in entries) <= room
    rows = _rows(entries, room, u) if beside else []
    if not rows or len(rows) > _ROWS_BESIDE:
        rows, beside = _rows(entries, width - 2 * (_ABOVE + _PAD) * u, u), False
    paper = faded(theme.panel, 0.94)
    return [Plate(Row(row, _BETWEEN, (_PAD, 0.0, 0.0)), paper, theme.line, radius=6.0) for row in rows], beside


def _rows(entries: Sequence[Row], room: float, u: float) -> list[list[Row]]:
    """The entries in rows that fit into `room`, at least one each."""
    rows: list[list[Row]] = [[]]
    for entry in entries:
        if rows[-1] and Row([*rows[-1], entry], _BETWEEN).width(u) > room:
            rows.append([])
        rows[-1].append(entry)
    return rows


def _swatch(name: str, theme: Theme, place: Rectangle, u: float) -> list[Mark]:
    """A small sample of what a colour means: a diagram, a yielding rod, a slack cable, an arrow."""
    x, y, width = place.left, place.middle[1], place.width
    if name in _SCALES:
        return scale_bar(theme, x, y, width, u)
    in_ink = ("slack", "hinge", "spring", "inextensible", "moment", "shear", "velocity", "inertia")
    drawn_in = {
        "first": "yielding",
        "near buckling": "compression",
        "plastic hinge": "yielding",
        "deflected": "sketch",
    } | dict.fromkeys(in_ink, "ink")
    colour = getattr(theme, drawn_in.get(name, name))
    ends = np.array([[x, y]]), np.array([[x + width, y]])
    if name == "hinge":
        return [Stamps("ring", ends[0] + [width / 2, 0.0], 4.0 * u, u, theme.ink, theme.hollow)]
    if name == "plastic hinge":
        return [Discs(ends[0] + [width / 2, 0.0], np.array([4.5 * u]), colour, colour)]
    if name == "inextensible":
        left, right = (x + width / 2 + shift * u for shift in (-2.0, 2.0))
        above, below = (np.array([[left, y + dy * u], [right, y + dy * u]]) for dy in (-5.0, 5.0))
        return [Strokes(above, below, 1.5 * u, colour)]
    if name == "spring":
        return [Stamps("spiral", ends[0] + [width / 2, 0.0], 6.0 * u, u, theme.ink, theme.hollow)]
    if name in ("load", "reaction", "inertia", "velocity"):
        return [Stamps("arrow", ends[0], width, u, colour, colour)]
    if name in ("first", "near buckling"):
        return [Strokes(*ends, 9.0 * u, faded(colour, HALO_OPACITY))]
    if name == "yielding":
        return [Strokes(*ends, 3.0 * u, colour)]
    if name == "deflected":
        return [Strokes(*ends, 1.25 * u, colour)]
    if name in ("slack", "ghost"):
        return [Strokes(*dashed(*ends, width / 5)[:2], 1.25 * u, colour)]
    return [Panel(x, y - 5.0 * u, width, 10.0 * u, 1.0 * u, faded(colour, 0.18), colour)]


# --- scale -----------------------------------------------------------------------------------------


def place_scale(sheet: Sheet, room: tuple[float, float]) -> tuple[Rectangle, float, list[str]] | None:
    """A place along the edges where the scale hides nothing, which is taken, the metres that its ruler means (0: none), and
    notes; None if there is none.

    There is room for how many values are hidden, before that is known; this is said alone, and over rods, in need.
    Where the notes have no place, the ruler still can have one.
    """
    v, u, values = sheet.viewport, sheet.unit, hidden_values(sheet, {})
    length = round_down(min(120.0 * u, 0.25 * v.width) / sheet.view.camera.scale)
    notes = _displacements(sheet) + sheet.notes
    for said, metres in product((notes, []), (length, 0.0)):
        whole = _scale(sheet, metres, values, said)
        if whole is None or (width := whole.width(u)) > v.width - 2 * EDGE * u:
            continue
        place = Rectangle(*_freest(sheet, width, room), width, _STRIP * u)
        in_need = not said and not sheet.occupancy.is_taken(*place.box)
        if in_need or not sheet.occupancy.crossed(*place.box):
            sheet.occupancy.block(*place.box)
            return place, metres, said
    return None


def draw_scale(sheet: Sheet, scale: tuple[Rectangle, float, list[str]] | None) -> list[Mark]:
    """A round length to scale, how many values are hidden, and by how much displacements and diagrams are scaled."""
    if scale is None:
        return []
    place, metres, notes = scale
    whole, paper = _scale(sheet, metres, hidden_values(sheet, sheet.placed), notes), Paper(sheet.unit)
    if whole is not None:
        paper.put(whole, replace(place, width=min(whole.width(sheet.unit), place.width)))
    return paper.marks


def hidden_values(sheet: Sheet, placed: Placed) -> int:
    """How many values there are beside those that are placed, but for loads, which a person gave; 0 in a file."""
    if not sheet.view.advises:
        return 0
    fields = {field for field in sheet.values if not field.startswith(GIVEN)}
    return sum(sheet.values[field] for field in fields) - sum(field in fields for field, _ in placed)


def _scale(sheet: Sheet, metres: float, hidden: int, notes: list[str]) -> Plate | None:
    """The ruler and what is said beside it, if so many values are hidden."""
    if sheet.view.table[0]:
        values = plural("{count} value only in the table", "{count} values only in the table", hidden)
    else:
        values = plural("{count} value hidden: zoom in", "{count} values hidden: zoom in", hidden)
    said = [*([written.length(metres)] if metres else []), *([values] if hidden else []), *notes]
    if not said:
        return None
    theme = sheet.theme
    ruler = Drawn(partial(_ruler, theme), metres * sheet.view.camera.scale / sheet.unit)
    text = Text("   ".join(said), 11.0, theme.muted, grow=1.0)
    row = Row((*([ruler] if metres else []), text), 8.0, (6.0, 0.0, 0.0), high=_STRIP)
    return Plate(row, faded(theme.background, 0.8), radius=4.0)


def draw_references(sheet: Sheet, values: Sequence[Numbered], former: int) -> list[Mark]:
    """Numbers that stand for values, and these in columns that cover no text, where the last picture has them if that is
    free; neither where there is no room, loads first. former: that place, -1 without one."""
    if not values:
        return []
    lines, occupancy, u = [], sheet.occupancy, sheet.unit
    for name, short, colour in _told(sheet, values):
        lines.append(Row((Text(name, 9.0, colour, grow=1.0), Text(short, 9.0, colour, "semibold")), 6.0))
    low, high = sheet.viewport.corners
    held = np.array([divmod(former, _WIDEST)], dtype=np.float64)
    for covered, rows in product((0, STRONG), _TALL):
        columns = [Column(lines[at : at + rows]) for at in range(0, len(lines), rows)]
        inside = Row(columns, 10.0, (6.0, 3.0, 3.0), top=True)
        block = Plate(inside, faded(sheet.theme.background, 0.9), sheet.theme.line, radius=4.0)
        size = np.array([width := block.width(u), block.height(u, width)])
        inside_it = ((held >= low) & (held + size <= high)).all(axis=1)
        for corners in (held[inside_it], None):
            if corners is None:
                x = np.arange(low[0] + 6.0 * u, high[0] - size[0], 6.0 * u)
                y = np.arange(high[1] - 6.0 * u - size[1], low[1], -6.0 * u)
                corners = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
            cells = occupancy.cells_of(corners, np.broadcast_to(size, corners.shape))
            free = np.flatnonzero(occupancy.are_free(cells, covered))
            if len(free):
                at, paper = corners[free[0]].tolist(), Paper(u)
                paper.put(block, Rectangle(*at, *size.tolist()))
                sheet.scales[LIST] = int(at[0]) * _WIDEST + int(at[1])
                return [*(mark for *_, own in values for mark in own), *paper.marks]
    results = [one for one in values if not one[1].is_given()]
    for _, label, _ in values:
        if label.is_given() or len(results) == len(values):
            sheet.placed.pop(label.key or ("", 0), None)
    return draw_references(sheet, results, former) if len(results) < len(values) else []


def _told(sheet: Sheet, values: Sequence[Numbered]) -> Iterator[tuple[str, str, Colour]]:
    """What tells of values that read alike: their number, or the names of two, or of neighbours; the value; its colour."""
    alike = dict[tuple[int, str, Colour, str], list[int]]()
    for number, label, _ in values:
        table, row = label.of or ("rods", 0)
        alike.setdefault((number, label.short, label.colour, "" if number else table), []).append(row)
    for (number, short, colour, table), rows in alike.items():
        every, names = np.unique(rows), [str(number)] * bool(number)
        for run in [] if number else np.split(every, np.flatnonzero(np.diff(every) > 1) + 1):
            said = [
                sheet.model.tables[table].handles[row].said for row in (run[[0, -1]] if len(run) > 2 else run)
            ]
            names += [" … ".join(said)] if len(run) > 2 else said
        yield from ((", ".join(names[at : at + 2]), short, colour) for at in range(0, len(names), 2))


def _ruler(theme: Theme, at: Rectangle, u: float) -> list[Mark]:
    """A line with a tick at both ends."""
    x, y, length = round(at.left), round(at.top + 6.0 * u), round(at.width)
    thin, tick = max(round(1.5 * u), 1), round(7.0 * u)
    line, ends = (x, y + tick, length, thin), ((x, y, thin, tick), (x + length - thin, y, thin, tick))
    return [Panel(*box, 0.0, theme.muted) for box in (line, *ends)]


def _freest(sheet: Sheet, width: float, room: tuple[float, float]) -> tuple[float, float]:
    """Left and top of the place along the edges where a strip hides least."""
    v, u, (top, bottom) = sheet.viewport, sheet.unit, room
    height = _STRIP * u
    low, high = bottom - height - 6.0 * u, top + 6.0 * u
    first, last = v.left + 8.0 * u, v.right - width - 8.0 * u
    places = [(first, low), ((first + last) / 2, low), (last, low), (first, high), (last, high)]
    places.append((first, max(high - _ROW * u, v.top)))  # beside the last row of the legend
    stays = sheet.placed.get(_SCALE, 0)  # where it was, while that is as free as any
    tried = sorted(places, key=lambda place: place != places[stays])
    best = _least_hidden(sheet, tried, width, height)
    sheet.scales[_SCALE] = places.index(best)
    return best


def _least_hidden(
    sheet: Sheet, places: Sequence[tuple[float, float]], width: float, height: float
) -> tuple[float, float]:
    """Where, of places, a box lies on nothing else, or else hides least, the first of several; left and top."""
    best, least = places[0], (True, sys.maxsize)
    for at in places:
        hidden = sheet.occupancy.is_taken(*at, width, height), sheet.occupancy.crossed(*at, width, height)
        best, least = (at, hidden) if hidden < least else (best, least)
        if not any(hidden):
            break
    return best


def _displacements(sheet: Sheet) -> list[str]:
    """The exaggeration of displacements, if no slider shows it, or a hint where a structure seems not to move."""
    model, scale = sheet.model, sheet.model.settings.displacement_scale
    if scale != 1.0:
        return [] if sheet.view.slider_places else [tr("displacements ×{scale:g}", scale=scale)]
    if not (sheet.view.advises and model.rods.count):
        return []
    largest = float(np.abs(model.particles.displacement).max(initial=0.0))
    if largest * sheet.view.camera.scale >= sheet.unit:
        return []
    inside = farthest(model, np.flatnonzero(model.rods.bending_stiffness > 0.0))[0]
    largest = max(largest, float(inside.max(initial=0.0)))
    if not 1e-6 < largest * sheet.view.camera.scale < sheet.unit:  # pixels; smaller ones count as none
        return []
    return [
        tr(
            "displacements up to {largest} are too small to see: enlarge them with the slider",
            largest=written.length(largest, 2),
        )
    ]
