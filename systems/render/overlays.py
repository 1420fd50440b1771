"""Overlays: heading, status bar, problem banner, legend, scale bar, and the card of an empty model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from components import written
from components.camera import Viewport
from components.round_numbers import round_down
from components.view import BETWEEN
from systems.render.marks import Mark, Panel, Stamps, Strokes, Text, boxes
from systems.render.sheet import Sheet
from systems.render.structure import HALO_OPACITY
from systems.render.symbols import dashed
from systems.render.theme import Colour, faded
from systems.render.typography import at_most, font_size, line_height, shortened, text_width, wrapped
from systems.render.utilisation import scale_bar

_EDGE = 14.0  # points between overlays and the edges of the viewport
_HEADING = 20.0  # points, size of its type
_SMALL = 300.0  # points; lower viewports leave out optional overlays
_FEW_LINES = 3  # of a notice
_NOISE = 1e-6  # pixels; smaller displacements count as none
BAR = 28.0  # points, height of the status bar
_ROW, _ROWS_BESIDE = 28.0, 2  # of the legend: points, and how many stand beside the heading
_STRIP = 19.0  # points, height of the scale


def draw_overlays(sheet: Sheet) -> tuple[list[Mark], tuple[float, float]]:
    """Marks in fixed places, kept free of labels; and the height taken at the top and the bottom."""
    marks, bottom = _status_bar(sheet)
    heading, heading_end = _heading(sheet)
    legend, top = _legend(sheet, heading_end)
    blank = sheet.model.particles.count == 0 and sheet.view.page is None
    empty = _empty(sheet, bottom) if blank else []
    caption, top = _caption(sheet, top)
    return marks + heading + legend + caption + empty, (top, bottom)


# --- the status bar --------------------------------------------------------------------------------


def _status_bar(sheet: Sheet) -> tuple[list[Mark], float]:
    """The bar at the bottom, if there is anything to say, and the height that is left above it."""
    v, u, theme, status = sheet.viewport, sheet.unit, sheet.theme, sheet.view.status
    bottom = float(v.bottom)
    if not (status.state or (status.hint and _shows_hint(sheet))):
        return [], bottom
    top, thin = round(bottom - BAR * u), max(round(u), 1)
    sheet.occupancy.block(v.left, top, v.width, BAR * u)
    marks: list[Mark] = [boxes(theme.panel, (v.left, top, v.width, v.bottom - top))]
    marks.append(boxes(theme.line, (v.left, top, v.width, thin)))
    middle = (top + thin + bottom) / 2
    x = v.left + _EDGE * u
    if status.state:
        dot = np.array([[x + 3.5 * u, middle]])
        marks.append(Stamps("disc", dot, 3.5 * u, u, _state_colour(sheet), _state_colour(sheet)))
        x += 13.0 * u
        state = status.state[0].upper() + status.state[1:]
        x = _append(sheet, marks, state, x, middle, theme.text, "semibold")
        time = "" if status.time is None else f"t = {written.time(status.time)}"
        for text in (time, written.pace(status.speed)):
            x = _append(sheet, marks, text, x, middle, theme.text)
    _append_hint(sheet, marks, x, middle)
    return marks, float(top)


def _append(
    sheet: Sheet, marks: list[Mark], text: str, x: float, y: float, colour: Colour, weight: str = "regular"
) -> float:
    """Write a part of the status bar if it fits; returns where the next one begins."""
    size = sheet.font(12.0)
    width = text_width(text, size, weight)
    if not text or x + width > sheet.viewport.right - _EDGE * sheet.unit:
        return x
    marks.append(Text(text, x, y, size, colour, weight))
    return x + width + 18.0 * sheet.unit


def _shows_hint(sheet: Sheet) -> bool:
    """False where the hint stands on the card of an empty model instead."""
    return sheet.model.particles.count > 0 or sheet.view.page is not None


def _append_hint(sheet: Sheet, marks: list[Mark], x: float, y: float) -> None:
    """The next possible steps at the right end, as many as there is room for."""
    v, u, size = sheet.viewport, sheet.unit, sheet.font(12.0)
    if not _shows_hint(sheet):
        return
    right = v.right - _EDGE * u
    room, steps = right - x - 6.0 * u, sheet.view.status.hint.split(BETWEEN)
    while len(steps) > 1 and text_width(BETWEEN.join(steps), size) > room:
        steps.pop()
    text = shortened(BETWEEN.join(steps), room, size)
    if text == BETWEEN.join(steps) or len(text) > 12:
        marks.append(Text(text, right, y, size, sheet.theme.muted, anchor="right"))


def _state_colour(sheet: Sheet) -> Colour:
    theme, status = sheet.theme, sheet.view.status
    if status.problem:
        return theme.problem
    return {"running": theme.running, "paused": theme.halted, "halted": theme.halted}.get(
        status.state.lower(), theme.resting
    )


# --- heading and problem ---------------------------------------------------------------------------


def heading_height(text: str, width: float, unit: float) -> float:
    """Pixels that a heading takes at the top of a viewport."""
    size = font_size(_HEADING, unit)
    lines = wrapped(text, width - 2 * _EDGE * unit, size, "semibold")
    return len(lines) * line_height(size) + _EDGE * unit + 4.0 * unit


def _heading(sheet: Sheet) -> tuple[list[Mark], tuple[float, float]]:
    """The heading (the mode, or the next task) top left; and its right and lower end."""
    v, u, size = sheet.viewport, sheet.unit, sheet.font(_HEADING)
    left, top = v.left + _EDGE * u, v.top + _EDGE * u
    if not sheet.view.heading:
        return [], (v.left, v.top)
    lines = wrapped(sheet.view.heading, v.width - 2 * _EDGE * u, size, "semibold")
    marks: list[Mark] = []
    for number, line in enumerate(lines):
        y = top + 9.0 * u + number * line_height(size)
        sheet.occupancy.block(left, y - size / 2, text_width(line, size, "semibold"), size)
        marks.append(Text(line, left, y, size, sheet.theme.text, "semibold"))
    right = left + max(text_width(line, size, "semibold") for line in lines)
    return marks, (right, top + len(lines) * line_height(size) - 4.0 * u)


def _caption(sheet: Sheet, top: float) -> tuple[list[Mark], float]:
    """The caption of the viewport and the title of a shape, at the top between hairlines; and their lower end."""
    v, u, theme, size = sheet.viewport, sheet.unit, sheet.theme, sheet.font(13.0)
    shape = (sheet.view.shape.title,) if sheet.view.shape is not None else ()
    marks: list[Mark] = []
    if sheet.view.caption:
        thin = max(round(u), 1)
        marks.append(boxes(theme.line, (v.left, v.top, v.width, thin), (v.left, v.top, thin, v.height)))
    elif not shape:
        return [], top
    left, room = v.left + _EDGE * u, v.width - 2 * _EDGE * u
    paper = faded(theme.background, 0.85)  # keeps lines of a grid out of the text
    number = 0
    for line in (*sheet.view.caption, *shape):
        weight, colour = ("semibold", theme.text) if number == 0 else ("regular", theme.muted)
        if line in shape:
            weight, colour = "semibold", theme.sketch
        for text in wrapped(line, room, size, weight):
            y = top + 8.0 * u + (number + 0.5) * line_height(size)
            width = text_width(text, size, weight)
            sheet.occupancy.block(left, y - size / 2, width, size)
            marks.append(Panel(left - 4.0 * u, y - 0.7 * size, width + 8.0 * u, 1.4 * size, 3.0 * u, paper))
            marks.append(Text(text, left, y, size, colour, weight))
            number += 1
    return marks, top + 8.0 * u + number * line_height(size)


def _beside_panels(sheet: Sheet, said: str, size: int, around: float) -> tuple[Viewport, float, list[str]]:
    """Where a notice stands, and the width and lines of its text: beside the panels, unless it is long."""
    for v in (sheet.view.room, sheet.viewport):
        room = min(v.width - 2 * _EDGE * sheet.unit, 640.0 * sheet.unit) - around
        lines = wrapped(said, room, size)
        if len(lines) <= _FEW_LINES:
            break
    return v, room, lines


def draw_notice(sheet: Sheet, ends: tuple[float, float]) -> list[Mark]:
    """The problem or the notice, wrapped, at the bottom or the top, in the middle or aside, where it hides least."""
    status, (top, bottom) = sheet.view.status, ends
    said = status.problem or status.notice
    if not said:
        return []
    u, theme, size = sheet.unit, sheet.theme, sheet.font(13.0)
    pad, icon = 12.0 * u, 18.0 * u
    around = 2 * pad + icon + 10.0 * u
    v, room, lines = _beside_panels(sheet, said, size, around)
    bottom = min(bottom, v.bottom)
    width = around + max(text_width(line, size) for line in lines)
    most = max(int((bottom - top - 60.0 * u) / line_height(size)), 1)
    lines = at_most(lines, most, room, size)
    height = len(lines) * line_height(size) + 2 * pad - 4.0 * u
    left, upper = _freest_of(sheet, _for_notice(sheet, v, width, height, (top, bottom)), width, height)
    sheet.occupancy.block(left, upper, width, height)
    first = upper + height / 2 - (len(lines) - 1) * line_height(size) / 2
    at = np.array([[left + pad + icon / 2, first]])
    ink, paper = (theme.problem, theme.problem_panel) if status.problem else (theme.text, theme.panel)
    return [
        Panel(left, upper, width, height, 6.0 * u, paper, ink if status.problem else theme.line),
        Stamps("disc", at, icon / 2, u, ink, ink),
        Text("!" if status.problem else "i", float(at[0, 0]), first, size, paper, "semibold", "centre"),
        *(
            Text(line, left + pad + icon + 10.0 * u, first + number * line_height(size), size, ink)
            for number, line in enumerate(lines)
        ),
        *_progress(sheet, left + pad, upper + height - 5.0 * u, width - 2 * pad),
    ]


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

_BAR_WIDTH = 70.0  # points, of a scale of colours
_MEANINGS = {
    "tension": "tension (kN)",
    "compression": "compression (kN)",
    "moment": "M on the tension side (kN·m)",
    "shear": "shear V (kN)",
    "yielding": "yielding",
    "utilisation": "0 to 100 % of the strength",
    "first": "first at its strength",
    "slack": "slack cable",
    "load": "load (kN)",
    "reaction": "reaction (kN)",
    "inertia": "inertia −m a (kN)",
    "velocity": "velocity",
    "hinge": "hinge",
    "ghost": "undeformed",
}


def _legend(sheet: Sheet, heading_end: tuple[float, float]) -> tuple[list[Mark], float]:
    """The colours that occur and what they mean, in rows top right; and the lower end of all at the top.

    They stand beside the heading if one or two rows have room there, else below it.
    """
    v, u, theme, size = sheet.viewport, sheet.unit, sheet.theme, sheet.font(11.0)
    names = [name for name in _MEANINGS if name in sheet.legend] if sheet.view.legend else []
    right = v.right - 10.0 * u
    if not names or v.width < 240.0 * u:
        return [], heading_end[1]
    pad, swatch, gap, height = 9.0 * u, 16.0 * u, 14.0 * u, 24.0 * u
    swatches = [_BAR_WIDTH * u if name == "utilisation" else swatch for name in names]
    entries = [
        wide + 6.0 * u + text_width(_MEANINGS[name], size) for name, wide in zip(names, swatches, strict=True)
    ]
    room, whole = right - heading_end[0] - gap - 2 * pad, right - v.left - 10.0 * u - 2 * pad
    beside = max(entries) <= room and len(_rows(entries, gap, room)) <= _ROWS_BESIDE
    if not beside and v.height < _SMALL * u:
        return [], heading_end[1]
    top = v.top + 10.0 * u if beside else heading_end[1] + 8.0 * u
    marks: list[Mark] = []
    for first, last in _rows(entries, gap, room if beside else whole):
        width = sum(entries[first:last]) + gap * (last - first - 1) + 2 * pad
        left, x = right - width, right - width + pad
        sheet.occupancy.block(left, top, width, height)
        marks.append(Panel(left, top, width, height, 6.0 * u, faded(theme.panel, 0.94), theme.line))
        for name, wide, entry in list(zip(names, swatches, entries, strict=True))[first:last]:
            marks += _swatch(sheet, name, x, top + height / 2, wide)
            marks.append(Text(_MEANINGS[name], x + wide + 6.0 * u, top + height / 2, size, theme.text))
            x += entry + gap
        top += _ROW * u
    return marks, max(top - 4.0 * u, heading_end[1])


def _rows(widths: list[float], gap: float, room: float) -> list[tuple[int, int]]:
    """Ranges of entries that fit side by side into `room`, at least one each."""
    rows, first, used = [], 0, 0.0
    for index, width in enumerate(widths):
        if index > first and used + width > room:
            rows.append((first, index))
            first, used = index, 0.0
        used += width + gap
    return [*rows, (first, len(widths))]


def _swatch(sheet: Sheet, name: str, x: float, y: float, width: float) -> list[Mark]:
    """A small sample of what a colour means: a diagram, a yielding rod, a slack cable, an arrow."""
    u, theme = sheet.unit, sheet.theme
    if name == "utilisation":
        return scale_bar(theme, x, y, width, u)
    role = {
        "slack": "ink",
        "hinge": "ink",
        "moment": "ink",
        "shear": "ink",
        "velocity": "ink",
        "inertia": "ink",
        "first": "yielding",
    }.get(name, name)
    colour = getattr(theme, role)
    ends = np.array([[x, y]]), np.array([[x + width, y]])
    if name == "hinge":
        return [Stamps("ring", ends[0] + [width / 2, 0.0], 4.0 * u, u, theme.ink, theme.hollow)]
    if name in ("load", "reaction", "inertia", "velocity"):
        return [Stamps("arrow", ends[0], width, u, colour, colour)]
    if name == "first":
        return [Strokes(*ends, 9.0 * u, faded(colour, HALO_OPACITY))]
    if name == "yielding":
        return [Strokes(*ends, 3.0 * u, colour)]
    if name in ("slack", "ghost"):
        return [Strokes(*dashed(*ends, width / 5)[:2], 1.25 * u, colour)]
    return [Panel(x, y - 5.0 * u, width, 10.0 * u, 1.0 * u, faded(colour, 0.18), colour)]


# --- scale -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Scale:
    """Where the scale stands, in pixels: a ruler of that length, which means so many metres (0: none), and a text."""

    left: float
    top: float
    metres: float
    ruler: float
    room: float
    notes: list[str]


def place_scale(sheet: Sheet, room: tuple[float, float]) -> Scale | None:
    """A place along the edges where the scale hides nothing, which is taken; None if there is none.

    There is room for how many values are hidden, before that is known; this is said alone, and over rods, in need.
    """
    v, u, size = sheet.viewport, sheet.unit, sheet.font(11.0)
    metres = round_down(min(120.0 * u, 0.25 * v.width) / sheet.view.camera.scale)
    notes, length = _displacements(sheet) + sheet.notes, metres * sheet.view.camera.scale
    choices = [
        (metres, length, notes),
        (0.0, 0.0, notes),
        *([(0.0, 0.0, list[str]())] if sheet.values.total() else []),
    ]
    for metres, length, said in choices:
        ruler = length + 8.0 * u if length else 0.0
        text = "   ".join(_said(metres, sheet.values.total(), said))
        width = text_width(text, size)
        if not text or width > v.width - ruler - 2 * _EDGE * u:
            continue
        scale = Scale(*_freest(sheet, ruler + width + 12.0 * u, room), metres, length, width, said)
        box = scale.left, scale.top, ruler + width + 12.0 * u, _STRIP * u
        in_need = not said and not sheet.occupancy.is_taken(*box)
        if in_need or not sheet.occupancy.crossed(*box):
            sheet.occupancy.block(*box)
            return scale
    return None


def draw_scale(sheet: Sheet, scale: Scale | None) -> list[Mark]:
    """A round length to scale, how many values are hidden, and by how much displacements and diagrams are scaled."""
    hidden = sheet.values.total() - sum(1 for field, _ in sheet.placed if field in sheet.values)
    said = _said(scale.metres, hidden, scale.notes) if scale else []
    if scale is None or not said:
        return []
    u, size = sheet.unit, sheet.font(11.0)
    ruler = scale.ruler + 8.0 * u if scale.ruler else 0.0
    text = shortened("   ".join(said), scale.room, size)
    x, y = round(scale.left + 6.0 * u), round(scale.top + 6.0 * u)
    width = ruler + text_width(text, size) + 12.0 * u
    return [
        Panel(scale.left, scale.top, width, _STRIP * u, 4.0 * u, faded(sheet.theme.background, 0.8)),
        *([_ruler(sheet, x, y, round(scale.ruler))] if scale.ruler else []),
        Text(text, x + ruler, y + 4.0 * u, size, sheet.theme.muted),
    ]


def _said(metres: float, hidden: int, notes: list[str]) -> list[str]:
    """What is said beside the ruler, if so many values are hidden."""
    values = "1 value" if hidden == 1 else f"{hidden} values"
    length = [written.length(metres)] if metres else []
    return [*length, *([f"{values} hidden: zoom in"] if hidden else []), *notes]


def _freest(sheet: Sheet, width: float, room: tuple[float, float]) -> tuple[float, float]:
    """Left and top of the place along the edges where a strip hides least."""
    v, u, (top, bottom) = sheet.viewport, sheet.unit, room
    height = _STRIP * u
    low, high = bottom - height - 6.0 * u, top + 6.0 * u
    first, last = v.left + 8.0 * u, v.right - width - 8.0 * u
    places = [(first, low), ((first + last) / 2, low), (last, low), (first, high), (last, high)]
    places.append((first, max(high - _ROW * u, v.top)))  # beside the last row of the legend
    return _freest_of(sheet, places, width, height)


def _freest_of(
    sheet: Sheet, places: list[tuple[float, float]], width: float, height: float
) -> tuple[float, float]:
    """Left and top of the first of the places where a box lies on nothing else, if possible, and hides least."""
    occupancy = sheet.occupancy
    hides = [(occupancy.is_taken(*at, width, height), occupancy.crossed(*at, width, height)) for at in places]
    return places[hides.index(min(hides))]


def _ruler(sheet: Sheet, x: int, y: int, length: int) -> Mark:
    thin, tick = max(round(1.5 * sheet.unit), 1), round(7.0 * sheet.unit)
    ends = (x, y, thin, tick), (x + length - thin, y, thin, tick)
    return boxes(sheet.theme.muted, (x, y + tick, length, thin), *ends)


def _displacements(sheet: Sheet) -> list[str]:
    """The exaggeration of displacements, if no slider shows it, or a hint where a structure seems not to move."""
    model, scale = sheet.model, sheet.model.settings.displacement_scale
    if scale != 1.0:
        return [] if sheet.view.slider_places else [f"displacements ×{scale:g}"]
    largest = float(np.abs(model.particles.displacement).max(initial=0.0)) if model.rods.count else 0.0
    if not _NOISE < largest * sheet.view.camera.scale < sheet.unit:
        return []
    return [f"displacements up to {written.length(largest, 2)}, too small to see; their slider enlarges them"]


# --- nothing to see --------------------------------------------------------------------------------


def _empty(sheet: Sheet, bottom: float) -> list[Mark]:
    """A card in the middle that says how to begin."""
    v, u, theme = sheet.viewport, sheet.unit, sheet.theme
    title, size = sheet.font(20.0), sheet.font(13.0)
    steps = [step.split(" ", 1) for step in sheet.view.status.hint.split(BETWEEN) if " " in step]
    keys = max((text_width(key, size, "semibold") for key, _ in steps), default=0) + 12.0 * u
    widest = keys + max((text_width(rest, size) for _, rest in steps), default=0)
    width = min(v.width - 2 * _EDGE * u, max(widest + 64.0 * u, 280.0 * u))
    emblem = 68.0 * u if v.height >= _SMALL * u else 0.0
    height = emblem + 62.0 * u + len(steps) * 1.1 * line_height(size)
    middle, top = v.left + v.width / 2, v.top + (bottom - v.top - height) / 2
    marks: list[Mark] = [
        Panel(middle - width / 2, top, width, height, 12.0 * u, theme.background, theme.line),
        *(_emblem(sheet, middle, top + 24.0 * u) if emblem else []),
        Text("An empty model", middle, top + emblem + 26.0 * u, title, theme.text, "semibold", "centre"),
    ]
    left, y = middle - widest / 2, top + emblem + 58.0 * u
    for number, (key, rest) in enumerate(steps):
        at = y + number * 1.1 * line_height(size)
        marks.append(Text(key, left, at, size, theme.text, "semibold"))
        marks.append(Text(rest, left + keys, at, size, theme.muted))
    return marks


def _emblem(sheet: Sheet, middle: float, top: float) -> list[Mark]:
    """Two small triangles of rods."""
    u, theme = sheet.unit, sheet.theme
    nodes = np.array([[-36.0, 42.0], [0.0, 42.0], [36.0, 42.0], [-18.0, 6.0], [18.0, 6.0]]) * u + [middle, top]
    rods = np.array([[0, 1], [1, 2], [0, 3], [3, 1], [1, 4], [4, 2], [3, 4]])
    return [
        Strokes(nodes[rods[:, 0]], nodes[rods[:, 1]], 2.0 * u, theme.ghost),
        Stamps("ring", nodes, 5.0 * u, u, theme.ghost, theme.background),
    ]
