"""Members that bend: hinges at their ends, loads between these, and moments at their joints."""

from __future__ import annotations

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.bent import Axes
from pinjoint.components.cases import case_told, factor_of_each, permanent
from pinjoint.components.rod import is_kinked, rigid_joints
from pinjoint.components.spans import Spans
from pinjoint.components.tags import DiagramShown
from pinjoint.systems.render.labels.nearness import ranges
from pinjoint.systems.render.labels.occupancy import STRONG
from pinjoint.systems.render.labels.placing import ANCHORS
from pinjoint.systems.render.marks import Discs, Fills, Owner, Owners, Points, Stamps, Strokes, Truths, Values
from pinjoint.systems.render.model.arrows import (
    FORCES,
    MOST,
    draw_arrows,
    full_load,
    head_length,
    largest_force,
    lengths,
)
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.model.values import (
    FIRST,
    SMALLEST,
    by_arrows,
    half_sizes,
    off,
    said,
    stated,
    write,
    write_around,
    write_spring,
)
from pinjoint.systems.render.symbols import RIM
from pinjoint.systems.render.theme import Colour

_HINGE = 3.5  # points, radius of a hinge beside a joint
_SPIRAL = 6.0  # likewise of a spring
_PLASTIC = 3.0, 6.0  # likewise of plastic hinges that have not turned, and of that which turned farthest
_ROUND_HINGE, _LEAST_TURNED = 4.0, 0.02  # points between one and its arrow; share of the farthest that has one
_SHORTEST = 5.0  # times its radius: the shortest rod at which a hinge is drawn
# Points, lengths of the arrows of the smallest and the largest distributed force, usually and beside diagrams.
_ROW, _LOW_ROW = (11.0, 22.0), (5.0, 11.0)
_APART = 15.0  # points between them
_MOST_ARROWS = 40  # of a rod
_FAR = 1e6  # pixels; what is beyond is left out
_BESIDE = 5.0  # points between a rod and arrows along it
_WIDEST_GAP, _GAP_SHARE = 84.0, 0.36  # between a joint and its rod drawn apart: points, and of the rod
_ARC = {"load": 15.0, "reaction": 21.0}  # points, radii of the arrows of moments
_SWEEP = np.radians(250.0)  # of these arrows
_PIECES = 20
# Ways from the middle of such an arrow to its value, corners first.
_AROUND = np.radians([90.0, 52.5, 127.5, 15.0, 165.0, 0.0, 180.0, -40.0, 220.0])
_AROUND = np.stack([np.cos(_AROUND), -np.sin(_AROUND)], axis=1)


def draw_hinges(sheet: Sheet) -> None:
    """Open circles at the ends of rods that turn freely at joints of others that do not, beside these joints; spirals, with
    their stiffness, at those that springs join."""
    model = sheet.model
    if not sheet.is_frame or not len(sheet.rods):
        return
    rigid, u = rigid_joints(model), sheet.unit
    fixity = model.rods.fixity[sheet.rods]
    which, end, joint, out = _ends(sheet, (fixity < 1.0) & rigid[sheet.ends[sheet.rods]], _HINGE)
    if not len(which):
        return
    rows = sheet.rods[which]
    sprung = fixity[which, end] > 0.0
    radius = np.where(sprung, _SPIRAL, _HINGE) * u
    at = sheet.centres[joint] + (sheet.radii[joint] + radius + 0.5 * u)[:, None] * out
    sheet.occupancy.parts.add(("rods", rows), at, at, radius)
    sheet.occupancy.block_squares(at, radius)
    sheet.explain("hinge", at[~sprung], at[~sprung])
    sheet.explain("spring", at[sprung], at[sprung])
    ink, hollow = sheet.theme.ink, sheet.theme.hollow
    if not sprung.all():
        some, of = ~sprung, ("rods", rows[~sprung])
        sheet.marks.append(Discs(at[some], radius[some], ink, hollow, RIM * u, of))
    if sprung.any():
        sheet.marks.append(Stamps("spiral", at[sprung], _SPIRAL * u, u, ink, hollow, of=("rods", rows[sprung])))
    for k in np.flatnonzero(sprung)[:MOST].tolist():
        row, side = int(rows[k]), int(end[k])
        stiffness, key = float(model.rods.end_springs[row, side]), ("rods.end_springs", 2 * row + side)
        write_spring(sheet, at[k], _SPIRAL * u, stiffness, "kN·m/rad", key, ("rods", row))


def draw_plastic_hinges(sheet: Sheet) -> None:
    """Filled circles at the ends of rods that yield or have yielded in bending, the larger the farther they turned, with an
    arrow the way in which each turned against its joint."""
    rods = sheet.model.rods
    if not (sheet.view.forces_known and is_kinked(sheet.model)):
        return
    turned = np.abs(rods.plastic_rotation)
    there = (rods.hinge_yielding | (turned > 0.0))[sheet.rods]
    which, end, joint, out = _ends(sheet, there, _PLASTIC[1])
    if not len(which):
        return
    rows, u, colour = sheet.rods[which], sheet.unit, sheet.theme.yielding
    share = turned[rows, end] / max(float(turned.max()), 1e-300)
    radius = (_PLASTIC[0] + (_PLASTIC[1] - _PLASTIC[0]) * np.sqrt(share)) * u
    fixity = rods.fixity[rows, end]
    past = np.where(fixity < 1.0, 2.0 * _SPIRAL * u, 0.0)  # the spring that stands there
    at = sheet.centres[joint] + (sheet.radii[joint] + past + radius + 0.5 * u)[:, None] * out
    of = "rods", rows
    sheet.occupancy.parts.add(of, at, at, radius)
    sheet.occupancy.block_squares(at, radius)
    sheet.marks.append(Discs(at, radius, colour, colour, 0.0, of))
    sheet.explain("plastic hinge", at, at)
    seen = share > _LEAST_TURNED if len(rows) <= MOST else np.zeros(len(rows), dtype=bool)
    sense = -rods.plastic_rotation[rows, end][seen]
    key, around = "rods.plastic_rotation", radius[seen] + _ROUND_HINGE * u
    draw_arcs(sheet, ("rods", rows[seen]), at[seen], around, sense, colour, key, sweep=np.pi, pieces=8)


def _ends(sheet: Sheet, wanted: Truths, radius: float) -> tuple[Rows, Rows, Rows, Points]:
    """Of ends that are wanted, (rods, 2), of rods long enough for circles of this radius (points) beside their joints: their
    places among the drawn rods, which ends they are, their joints, and unit vectors from these along the axes."""
    length = np.hypot(*(sheet.end - sheet.start).T)
    which, end = np.nonzero(wanted & (length > 2.0 * _SHORTEST * radius * sheet.unit)[:, None])
    rows = sheet.rods[which]
    tangent = Axes.of(sheet.model, rows).tangents(np.array([0.0, 1.0])) * np.array([1.0, -1.0])  # y down
    out = tangent[np.arange(len(rows)), end] * np.where(end == 0, 1.0, -1.0)[:, None]
    out /= np.maximum(np.hypot(*out.T), 1e-300)[:, None]
    return which, end, sheet.ends[rows, end], out


def draw_inextensible(sheet: Sheet) -> None:
    """Two short lines across the middles of rods that keep their lengths."""
    firm = sheet.model.rods.inextensible[sheet.rods]
    if not firm.any():
        return
    u, start, end = sheet.unit, sheet.start[firm], sheet.end[firm]
    along = (end - start) / np.maximum(np.hypot(*(end - start).T), 1e-300)[:, None]
    across, middle = along[:, ::-1] * [-5.0, 5.0] * u, 0.5 * (start + end)
    for shift in (-2.0 * u * along, 2.0 * u * along):
        ends = middle + shift - across, middle + shift + across
        sheet.marks.append(Strokes(*ends, 1.5 * u, sheet.theme.ink, ("rods", sheet.rods[firm])))
    sheet.occupancy.block_squares(middle, np.full(len(middle), 5.0 * u))
    sheet.explain("inextensible", middle, middle)


def gaps(lengths: Values, unit: float) -> Values:
    """What is left free between joints and rods of these lengths where they are drawn apart, in pixels."""
    return np.minimum(_GAP_SHARE * lengths, _WIDEST_GAP * unit)


# --- loads between ends ------------------------------------------------------------------------------


def draw_span_loads(sheet: Sheet) -> None:
    """What acts between the ends of rods: rows of arrows on the side from which they push, single arrows, curved ones."""
    spans, model = Spans.of(sheet.model), sheet.model
    if not len(spans.row) or model.share == 0.0:  # nothing holds the structure, and it carries nothing
        return
    acts = np.append(factor_of_each(model, "span_loads"), permanent(model))[spans.load, None]
    force, first, last = acts * spans.force, acts * spans.first, acts * spans.last
    spans = spans._replace(force=force, moment=acts[:, 0] * spans.moment, first=first, last=last)
    largest = sheet.model.share * max(float(np.hypot(*force.T).max()) for force in (spans.first, spans.last))
    spans = spans.some(np.isin(spans.row, sheet.rods))
    spread = (spans.first.any(axis=1) | spans.last.any(axis=1)) & (spans.end > spans.start)
    for own in (spans.load < 0, spans.load >= 0):
        _draw_rows(sheet, spans.some(spread & own), largest)
    _draw_points(sheet, spans)


def _draw_rows(sheet: Sheet, spans: Spans, largest: float) -> None:
    """Rows of arrows, of the largest of which so much is told; of rods' own, which are alike, once, of others at both ends.

    Either all are of rods themselves or none is.
    """
    if not 0 < len(spans.row) <= MOST:
        return
    force = np.stack([spans.first, spans.last], axis=1) * sheet.model.share
    u, colour, sizes = sheet.unit, sheet.theme.load, np.hypot(*np.moveaxis(force, -1, 0))
    size, each = sizes.max(axis=1), np.arange(len(spans.row))
    along = force[each, sizes.argmax(axis=1)] * [1.0, -1.0] / np.maximum(size, 1e-300)[:, None]
    least, most = _LOW_ROW if sheet.view.all_diagrams and sheet.view.forces_known else _ROW
    height = (least + (most - least) * size / largest) * u
    which, tips, shifted, part = _tips(sheet, spans, along)
    every = (force[which, 0] + part[:, None] * (force[which, 1] - force[which, 0])) * [1.0, -1.0]
    share = np.hypot(*every.T) / size[which]  # of its largest
    level = np.where(shifted[which], _APART * u, height[which] * share)
    every = np.where(
        shifted[which, None], along[which], every / np.maximum(share * size[which], 1e-300)[:, None]
    )
    tails, rows = tips - level[:, None] * every, spans.row[which]
    first = np.flatnonzero((which[:-1] == which[1:]) & ~shifted[which[1:]])
    line, of_line = (tails[first], tails[first + 1]), ("rods", rows[first])  # through the tails
    table, whose = ("rods", rows) if spans.load[0] < 0 else ("span_loads", spans.load[which])
    sheet.marks.append(Strokes(*line, 1.25 * u, colour, (table, whose[first])))
    sheet.occupancy.line(*line, STRONG, of_line)
    sheet.occupancy.parts.add(of_line, *line, u)
    seen = level > 2.0 * u  # points; shorter ones have no arrow
    of = table, whose[seen]
    draw_arrows(sheet, of, tails[seen], every[seen], level[seen], colour, ("rods", rows[seen]), 1.25)
    sheet.explain("load per length", tails, tips)
    told = _told(sheet, spans)
    for k in [k for k in np.unique(which).tolist() if k in told]:
        load, row, own, out = int(spans.load[k]), int(spans.row[k]), tails[which == k], -along[k]
        if load < 0 or (spans.first[k] == spans.last[k]).all():
            key = ("rods.distributed_force", row) if load < 0 else ("span_loads.end_intensity", load)
            _label_row(sheet, key, row, own, out, float(size[k]), bool(shifted[k]))
        else:
            for end, name in ((0, "start"), (-1, "end")):
                if value := float(sizes[k, end]):
                    key, at = (f"span_loads.{name}_intensity", load), np.repeat(own[[end]], 2, axis=0)
                    _label_row(sheet, key, row, at, out, value, bool(shifted[k]))


def _draw_points(sheet: Sheet, spans: Spans) -> None:
    """Arrows and curved arrows at places of rods, with their values."""
    if not (spans.force.any() or spans.moment.any()):
        return
    share, u, colour = sheet.model.share, sheet.unit, sheet.theme.load
    way = np.diff(sheet.centres[sheet.ends[spans.row]], axis=1)[:, 0]
    start = _shares_seen(sheet, spans, np.hypot(*way.T))[0]
    at = sheet.view.camera.to_pixels(Axes.of(sheet.model, spans.row).points(start[:, None])[:, 0])
    near, load = (np.abs(at) < _FAR).all(axis=1), spans.load
    some = np.flatnonzero(near & spans.force.any(axis=1))[:MOST]
    if len(some):
        force, of, rows = share * spans.force[some], ("span_loads", load[some]), spans.row[some]
        size = np.maximum(np.hypot(*force.T), 1e-300)
        along = force * [1.0, -1.0] / size[:, None]
        largest = max(largest_force(sheet.model, sheet.view), sheet.view.largest_force)
        length = lengths(sheet, FORCES, size, max(largest, float(size.max())))
        tip = at[some] - 1.5 * u * along
        tail = tip - length[:, None] * along
        draw_arrows(sheet, of, tail, along, length, colour, ("span_loads.force", load[some]))
        sheet.explain("load", tail, tip)
        for k, value in enumerate(size.tolist()):
            key = "span_loads.force", int(load[some[k]])
            text = f"{stated(sheet, value, 'kN')}{case_told(sheet.model, *key)}"
            places = by_arrows(half_sizes(sheet, [text])[0], tip[k], tail[k], 3.0 * u)
            leads = np.array([tail[k], 0.5 * (tail[k] + tip[k])]), -along[k]
            write(
                sheet,
                text,
                places,
                colour,
                key,
                ("rods", int(rows[k])),
                rank=FIRST - value,
                own=key,
                leads=leads,
            )
    some = np.flatnonzero(near & (spans.moment != 0.0))[:MOST]
    if len(some):
        moment, radius = share * spans.moment[some], np.full(len(some), _ARC["load"] * u)
        draw_arcs(sheet, ("span_loads", load[some]), at[some], radius, moment, colour, "span_loads.moment")
        sheet.explain("load moment", at[some], at[some])
        for k, value in zip(some.tolist(), moment.tolist(), strict=True):
            key, rod = ("span_loads.moment", int(load[k])), int(spans.row[k])
            write_moment(sheet, at[k], float(radius[0]), value, colour, key, of=("rods", rod))


def _told(sheet: Sheet, spans: Spans) -> set[int]:
    """Those whose value is told: of rods' own with the same force that follow one another, the one in the middle."""
    chains: list[tuple[set[tuple[float, ...]], list[int]]] = []  # joints of each, and which
    for index in np.flatnonzero(spans.load < 0).tolist():
        ends = sheet.ends[spans.row[index]].tolist()
        joints, own = {(*spans.first[index].tolist(), joint) for joint in ends}, [index]
        for chain in [chain for chain in chains if chain[0] & joints]:
            chains.remove(chain)
            joints, own = joints | chain[0], chain[1] + own
        chains.append((joints, own))
    return {own[len(own) // 2] for _, own in chains} | set(np.flatnonzero(spans.load >= 0).tolist())


def _tips(sheet: Sheet, spans: Spans, along: Points) -> tuple[Rows, Points, Truths, Values]:
    """Where the arrows of distributed forces end on rods, which force's each is, and which share of its way from its start;
    or, where one acts along its rod, beside it, which is told by force."""
    u, rows = sheet.unit, spans.row
    way = np.diff(sheet.centres[sheet.ends[rows]], axis=1)[:, 0]
    length = np.hypot(*way.T)
    shifted = np.abs((along * way).sum(axis=1)) > 0.97 * length
    low, high = _shares_seen(sheet, spans, length)
    seen = high - low
    count = np.clip(np.nan_to_num(np.round(seen * length / (_APART * u))), 2, _MOST_ARROWS).astype(np.intp)
    many = np.where(shifted, count, count + 1)
    many[np.where(spans.load < 0, 0.5, seen) * length < _APART * u] = 0
    which = np.repeat(np.arange(len(rows)), many)
    number = ranges(np.where(shifted, 1, 0), many)
    shares = low[which] + number / count[which] * seen[which]
    points = Axes.of(sheet.model, rows).some(which).points(shares[:, None])[:, 0]
    across = way[:, ::-1] * [1.0, -1.0] / np.maximum(length, 1e-300)[:, None]
    beside = _BESIDE * across * np.where(across[:, 1:] <= 0.0, 1.0, -1.0)
    tips = sheet.view.camera.to_pixels(points) + u * np.where(shifted[:, None], beside, -1.5 * along)[which]
    near = (np.bincount(which, ~(np.abs(tips) < _FAR).all(axis=1), len(rows)) == 0.0)[which]
    part = number / count[which]
    return which[near], tips[near], shifted, part[near]


def _shares_seen(sheet: Sheet, spans: Spans, length: Values) -> tuple[Values, Values]:
    """From which share to which loads are drawn on rods of these lengths in pixels, which are shorter where drawn apart."""
    if not sheet.view.free_bodies:
        return spans.start, spans.end
    apart = gaps(length, sheet.unit) / np.maximum(length, 1e-300)
    low, high = (apart + share * (1.0 - 2.0 * apart) for share in (spans.start, spans.end))
    return low, high


def _label_row(
    sheet: Sheet, key: tuple[str, int], row: int, tails: Points, out: Points, size: float, shifted: bool
) -> None:
    text, u = f"{stated(sheet, size, 'kN/m')}{case_told(sheet.model, *key)}", sheet.unit
    way = tails[-1] - tails[0]
    if shifted:
        out = np.array([way[1], -way[0]]) / max(float(np.hypot(*way)), 1e-9)
        out = out if out[1] <= 0.0 else -out
    shares = ANCHORS
    near = off(tails[0] + shares[:, None] * way, out, 2.0 * u, half_sizes(sheet, [text]))
    places, of = np.concatenate([near, near + out * 12.0 * u]), ("rods", row)
    at = shares * (len(tails) - 1.0)
    anchors = np.stack([np.interp(at, np.arange(len(tails)), part) for part in tails.T], axis=1)
    rank = FIRST - size
    write(sheet, text, places, sheet.theme.load, key, of, rank=rank, own=of, leads=(anchors, out), short=text)


# --- moments -----------------------------------------------------------------------------------------


def draw_moments(sheet: Sheet) -> None:
    """Curved arrows of the moments on joints that can bear them: of loads, and in diagrams of reactions."""
    model = sheet.model
    if not sheet.is_frame:
        return
    shown = np.zeros(model.particles.count, dtype=bool)
    if sheet.view.forces_known:
        shown[sheet.tagged(DiagramShown, "particles")] = True
        shown |= sheet.view.all_diagrams
    applied = model.particles.applied_moment if shown.all() else full_load(model)[:, 2]
    if shown.any():
        applied = np.where(shown, model.particles.applied_moment, applied)
        _draw_moments(sheet, "reaction", np.where(shown, model.particles.reaction_moment, 0.0))
    _draw_moments(sheet, "load", np.where(rigid_joints(model), applied, 0.0))


def _draw_moments(sheet: Sheet, name: str, moment: Values) -> None:
    """Arrows of moments (n,) around their particles, and their values; of many the largest."""
    rows = sheet.particles[(np.abs(moment[sheet.particles]) > SMALLEST) & np.isfinite(moment[sheet.particles])]
    rows = np.sort(rows[np.argsort(-np.abs(moment[rows]), kind="stable")][:MOST])
    if not len(rows):
        return
    radius = sheet.radii[rows] + (_ARC[name] - 4.0) * sheet.unit
    sheet.arcs[rows] = np.maximum(sheet.arcs[rows], radius)
    key = "particles.applied_moment" if name == "load" else "particles.reaction_moment"
    colour, of = sheet.colour_of(name), ("particles", rows)
    draw_arcs(sheet, of, sheet.centres[rows], radius, moment[rows], colour, key)
    sheet.explain(f"{name} moment", sheet.centres[rows], sheet.centres[rows])
    for at, size, row, value in zip(
        sheet.centres[rows], radius.tolist(), rows.tolist(), moment[rows].tolist(), strict=True
    ):
        text = said(sheet, abs(value), "kN·m") if name == "reaction" else ""
        write_moment(sheet, at, size, value, colour, (key, row), text)


def draw_arcs(
    sheet: Sheet,
    of: Owners,
    at: Points,
    radius: Values,
    moment: Values,
    colour: Colour,
    key: str,
    middle: float = np.pi / 2.0,
    sweep: float = _SWEEP,
    pieces: int = _PIECES,
) -> None:
    """Curved arrows about points (n, 2), of radii (n,), that turn as moments (n,) do, counter-clockwise if positive.

    They reach so far (sweep) around a middle, in radians: the usual ones are open below. key: of these parts of the
    picture, beside the rows of their elements.
    """
    if not len(at):
        return
    table, rows = of
    u, turn = sheet.unit, np.where(moment > 0.0, 1.0, -1.0)
    head = head_length(radius, u)
    angle = np.linspace(-0.5, 0.5, pieces + 1) * sweep
    angle = middle + turn[:, None] * angle  # from the right, over the top
    points = at[:, None] + radius[:, None, None] * np.stack([np.cos(angle), -np.sin(angle)], axis=2)
    first, last = points[:, :-1].reshape(-1, 2), points[:, 1:].reshape(-1, 2)
    every = np.repeat(rows, pieces)
    forward = points[:, -1] - points[:, -2]
    forward /= np.hypot(*forward.T)[:, None]
    neck, across = points[:, -1], forward[:, ::-1] * [-1.0, 1.0]
    tip, barb = neck + head[:, None] * forward, 0.5 * head[:, None] * across
    sheet.occupancy.line(first, last, STRONG, (key, every))
    for ends in ((first, last, every), (neck - barb, neck + barb, rows), (neck, tip, rows)):
        sheet.occupancy.parts.add((key, ends[2]), *ends[:2], u)
    sheet.marks.append(Strokes(first, last, 1.75 * u, colour, (table, every)))
    sheet.marks.append(Fills(np.stack([tip, neck + barb, neck - barb], axis=1), colour, (table, rows)))


def write_moment(
    sheet: Sheet,
    at: Points,
    radius: float,
    moment: float,
    colour: Colour,
    key: tuple[str, int],
    text: str = "",
    of: Owner | None = None,
) -> None:
    """Write the size of a moment outside its arrow; text: in place of the number as a person gave it; of: not a particle."""
    text = text or stated(sheet, abs(moment), "kN·m")
    short = text if key[0] == "particles.reaction_moment" else ""
    whose = key, of or ("particles", key[1]), key
    write_around(sheet, at, radius, _AROUND, text, colour, whose, abs(moment), short)
