"""Force diagrams: rectangles on rods, arrows at particles, and their values."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from components.tags import DiagramShown
from systems.render.labels import Label, half_size
from systems.render.marks import Fills, Points, Stamps, Strokes
from systems.render.sheet import DIRECTIONS, Rows, Sheet, typical_length
from systems.render.supports import NO_SUPPORT
from systems.render.symbols import ARROW_LENGTH, SUPPORT_DEPTH
from systems.render.theme import Colour, faded

SMALLEST_FORCE = 1e-4  # kN; less is drawn as none
_MOST_VALUES = 400  # written at once; the largest forces first
_FEW_VALUES = 24  # up to which each carries its unit
_VALUE_SIZE, _DENSE_SIZE = 12.0, 11.0  # points, of few values and of many
_BACKING = 0.86  # opacity behind a value


def written(force: float) -> str:
    """A force (kN) as people read it: two decimals, more for a small one, the real minus sign."""
    if 0.0 < abs(force) < 0.01:
        decimals = 1 - math.floor(math.log10(abs(force)))
        text = f"{force:.{min(decimals, 4)}f}"
    else:
        text = f"{force:.2f}"
    return text.replace("-", "−") if float(text) else text.lstrip("-")


def scale_step(largest: float, scale: float, room: float) -> float:
    """The largest of 1, 0.9, … 0.2, 0.1, 0.09, … by which `largest` × `scale` fits into `room`.

    Shrinking all diagrams alike keeps them comparable; steps keep their scale steady while forces change.
    """
    if not largest * scale > room:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(room / (largest * scale)))
    return decade * math.floor(room / (largest * scale) / decade + 1e-9)


def draw_rod_diagrams(sheet: Sheet) -> None:
    """A rectangle on each rod that shows its diagram, |N| × diagram scale high, and the value of N."""
    force, rows, start, end = _shown_rods(sheet)
    if not len(rows):
        return
    scale = sheet.model.settings.diagram_scale * sheet.unit
    factor = scale_step(float(np.abs(force).max()), scale, _room(sheet, start, end))
    if factor != 1.0:
        sheet.notes.append(f"diagrams ×{factor:g}")
    height = np.abs(force[rows]) * scale * factor
    normal = _outward_normals(sheet, rows, start, end)
    values = force[rows]
    for name, mask in (
        ("tension", values > SMALLEST_FORCE),
        ("compression", values < -SMALLEST_FORCE),
        ("zero", np.abs(values) <= SMALLEST_FORCE),
    ):
        if mask.any():
            _draw_rectangles(sheet, name, start[mask], end[mask], (normal * height[:, None])[mask])
    _label_rods(sheet, values, (start + end) / 2, normal, height)


def _shown_rods(sheet: Sheet) -> tuple[NDArray[np.float64], Rows, Points, Points]:
    """Axial forces of all rods; rows and visible ends of those whose diagram is drawn."""
    if sheet.view.all_diagrams:
        shown = np.ones(len(sheet.rods), dtype=bool)
    else:
        shown = sheet.chosen(sheet.tagged(DiagramShown, "rods"), sheet.rods)
    if not shown.any():
        return np.empty(0), sheet.rods[:0], sheet.start[:0], sheet.end[:0]
    force = np.nan_to_num(sheet.model.rods.axial_force)
    return force, sheet.rods[shown], sheet.start[shown], sheet.end[shown]


def _room(sheet: Sheet, start: Points, end: Points) -> float:
    """The greatest height (pixels) of a diagram that leaves the structure readable."""
    window = min(sheet.viewport.width, sheet.viewport.height)
    return max(min(0.15 * window, 0.6 * typical_length(start, end)), 10.0 * sheet.unit)


def _outward_normals(sheet: Sheet, rows: Rows, start: Points, end: Points) -> Points:
    """Unit normals (pixels) away from the middle of the original structure; upwards or left if through it."""
    rods = sheet.model.rods
    along = end - start
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    position = sheet.model.particles.position
    middles = 0.5 * (position[sheet.ends[:, 0]] + position[sheet.ends[:, 1]])
    outward = (middles[rows] - middles.mean(axis=0)) * [1.0, -1.0]
    # Judged in the original geometry, so that a diagram does not change sides while the rod moves.
    original = rods.difference[rows] * [1.0, -1.0]
    side = outward[:, 0] * original[:, 1] - outward[:, 1] * original[:, 0]
    tie = np.abs(side) < 1e-6 * rods.original_length[rows] * (np.ptp(middles, axis=0).max() + 1e-300)
    upwards = np.where(
        np.abs(original[:, 0]) > 1e-9 * rods.original_length[rows], original[:, 0], original[:, 1]
    )
    chosen: Points = normal * np.where(np.where(tie, upwards, side) < 0.0, -1.0, 1.0)[:, None]
    return chosen


def _draw_rectangles(sheet: Sheet, name: str, start: Points, end: Points, rise: Points) -> None:
    colour: Colour = getattr(sheet.theme, name)
    corners = np.stack([start, end, end + rise, start + rise], axis=1)
    sheet.marks.append(Fills(corners, faded(colour, 0.16)))
    following = np.roll(corners, -1, axis=1)
    sheet.marks.append(
        Strokes(corners.reshape(-1, 2), following.reshape(-1, 2), 1.25 * sheet.unit, faded(colour, 0.9))
    )
    if name != "zero":
        sheet.legend.append(name)


def _label_rods(
    sheet: Sheet,
    values: NDArray[np.float64],
    middle: Points,
    normal: Points,
    height: NDArray[np.float64],
) -> None:
    theme, u = sheet.theme, sheet.unit
    few = len(values) <= _FEW_VALUES
    size, ending = (sheet.font(_VALUE_SIZE), " kN") if few else (sheet.font(_DENSE_SIZE), "")
    seen = np.flatnonzero(sheet.sees(middle))
    for index in seen[np.argsort(-np.abs(values[seen]), kind="stable")][:_MOST_VALUES].tolist():
        value = float(values[index])
        text = written(value) + ending
        name = "zero" if abs(value) <= SMALLEST_FORCE else "tension" if value > 0.0 else "compression"
        half = half_size(text, size, "semibold", u)
        sheet.labels.append(
            Label(
                text,
                list(_places_by_rod(middle[index], normal[index], float(height[index]), half, few)),
                size,
                getattr(theme, name),
                # Two digits only, so that tiny changes do not reorder the labels from frame to frame.
                rank=-float(f"{abs(value):.1e}"),
                weight="semibold",
                backing=faded(theme.background, _BACKING),
            )
        )


def _places_by_rod(
    middle: Points, normal: Points, height: float, half: tuple[float, float], roomy: bool
) -> Iterator[tuple[float, float]]:
    """Where the value of a rod may stand: in its diagram if it fits, else beyond, else behind the rod.

    Among many rods it stands on its own one first, since beside it, it might be taken for another's.
    reach is how far a label extends from its middle along the normal, slide a step along the rod.
    """
    along = np.array([-normal[1], normal[0]])
    reach = float(np.abs(normal) @ half)
    slide = float(np.abs(along) @ half)
    inside = [height / 2] if height > 1.2 * reach or not roomy else []
    for distance in (*inside, height + reach, height / 2, -reach):
        for step in (0.0, 1.0, -1.0, 2.0, -2.0):
            x, y = middle + normal * distance + along * step * slide
            yield float(x), float(y)


def draw_particle_diagrams(sheet: Sheet, crowd: NDArray[np.float64], sides: NDArray[np.int64]) -> None:
    """Arrows of the horizontal and vertical external force on each particle that shows its diagram."""
    shown = sheet.particles
    if not sheet.view.all_diagrams:
        shown = shown[sheet.chosen(sheet.tagged(DiagramShown, "particles"), shown)]
    if not len(shown):
        return
    particles = sheet.model.particles
    force = (particles.applied_force + particles.reaction)[shown]
    pairs = np.argwhere(np.abs(force) > SMALLEST_FORCE)
    if not len(pairs):
        return
    sheet.legend.append("force")
    rows, axis = shown[pairs[:, 0]], pairs[:, 1]
    value = force[pairs[:, 0], axis]
    # Model y is up, pixels' y is down: a positive vertical force points in direction 3.
    direction = np.where(axis == 0, np.where(value > 0, 0, 2), np.where(value > 0, 3, 1))
    tail, outer = _arrow_places(sheet, rows, direction, crowd, sides)
    length = ARROW_LENGTH * sheet.unit
    for turns in range(4):
        mask = direction == turns
        if mask.any():
            sheet.marks.append(
                Stamps("arrow", tail[mask], length, sheet.unit, sheet.theme.force, sheet.theme.force, turns)
            )
    sheet.occupancy.block_squares(tail + DIRECTIONS[direction] * length / 2, np.full(len(rows), 0.2 * length))
    _label_arrows(sheet, value, tail + DIRECTIONS[direction] * length / 2, outer)


def _arrow_places(
    sheet: Sheet,
    rows: Rows,
    direction: NDArray[np.int64],
    crowd: NDArray[np.float64],
    sides: NDArray[np.int64],
) -> tuple[Points, NDArray[np.int64]]:
    """Tails of the arrows, and on which side of its particle each stands.

    An arrow starts at the rim, or ends at it where the side that it comes from is freer; there it stands
    beyond the support, if there is one.
    """
    u = sheet.unit
    opposite = (direction + 2) % 4
    supported = sides[rows] != NO_SUPPORT
    busy_ahead = crowd[rows, direction] + 0.8 * (supported & (sides[rows] == direction))
    busy_behind = crowd[rows, opposite] + 0.8 * (supported & (sides[rows] == opposite))
    pushes = busy_behind < busy_ahead - 0.1
    side = np.where(pushes, opposite, direction)
    gap = sheet.radii[rows] + 2.0 * u + np.where(supported & (sides[rows] == side), SUPPORT_DEPTH * u, 0.0)
    outward = DIRECTIONS[side]
    start = sheet.centres[rows] + outward * gap[:, None]
    return start + outward * np.where(pushes, ARROW_LENGTH * u, 0.0)[:, None], side


def _label_arrows(sheet: Sheet, value: NDArray[np.float64], middle: Points, side: NDArray[np.int64]) -> None:
    theme, u = sheet.theme, sheet.unit
    few = len(value) <= _FEW_VALUES
    size, ending = (sheet.font(_VALUE_SIZE), " kN") if few else (sheet.font(_DENSE_SIZE), "")
    seen = np.flatnonzero(sheet.sees(middle))
    for index in seen[np.argsort(-np.abs(value[seen]), kind="stable")][:_MOST_VALUES].tolist():
        text = written(abs(float(value[index]))) + ending
        half = half_size(text, size, "semibold", u)
        sheet.labels.append(
            Label(
                text,
                list(_places_by_arrow(middle[index], DIRECTIONS[side[index]], half, u)),
                size,
                theme.force,
                # Arrows are few and say little without their value: before the rods.
                rank=-1e9 - float(f"{abs(value[index]):.1e}"),
                weight="semibold",
                backing=faded(theme.background, _BACKING),
            )
        )


def _places_by_arrow(
    middle: Points, outward: Points, half: tuple[float, float], u: float
) -> Iterator[tuple[float, float]]:
    """Where the value of an arrow may stand: beyond its outer end, beside it, beside that end."""
    across = np.array([outward[1], outward[0]])
    length, width = float(np.abs(outward) @ half), float(np.abs(across) @ half)
    beyond, beside = ARROW_LENGTH * u / 2 + length, width + 7.5 * u
    places = [(beyond, 0.0)]
    for along in (0.0, length - ARROW_LENGTH * u / 2, ARROW_LENGTH * u / 2):
        places += [(along, beside), (along, -beside)]
    places += [(beyond, width), (beyond, -width), (0.0, beside + width), (0.0, -beside - width)]
    for along, sideways in places:
        x, y = middle + outward * along + across * sideways
        yield float(x), float(y)
