"""Arrows: forces and velocities drawn as arrows, to a round scale, and what a drag of them changes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinjoint.components.bent import Axes
from pinjoint.components.field import Field, Vector
from pinjoint.components.load import Load, SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.round_numbers import round_down
from pinjoint.components.view import View, drawn_at
from pinjoint.systems.edit.picking import PARTICLE_REACH
from pinjoint.systems.edit.placing import SNAP_REACH
from pinjoint.systems.edit.rods import share_at

Loaded = Particle | Rod | Load | SpanLoad

COMFORTABLE = 100.0  # points, length of an arrow of usual size
LONGEST = 400.0  # points, of the largest arrow before another scale is taken
_ARC = 24.0  # points around what bears a moment, within which its arrow is
# By the same scale.
_DISTRIBUTED = {"start_intensity": "distributed_force", "end_intensity": "distributed_force"}
WHOLE = 0.3  # share of a distributed load at either end, by which its intensity there is dragged; between, both


def usual(model: Model, field: str) -> float:
    """The usual size of a vector of elements: the largest there is, else one that suits the model."""
    columns = [
        table.column(name)
        for table in (model.particles, model.rods, model.loads, model.span_loads)
        for name in (field, *(other for other, of in _DISTRIBUTED.items() if of == field))
        if name in table.fields
    ]
    largest = max(float(np.abs(column).max(initial=0.0)) for column in columns)
    if largest > 0.0:
        return largest
    if field == "velocity":
        return 5.0  # m/s
    if field == "moment":
        return 0.25 * usual(model, "force") * extent(model)
    rods = model.rods
    span = float(rods.original_length.max(initial=0.0)) or 1.0
    if field == "distributed_force":
        return usual(model, "force") / span
    if rods.count and (bending := rods.bending_stiffness.max()) > 0.0:
        return float(0.1 * bending / span**2)  # a usual slope
    if rods.count:
        return float(1e-3 * rods.stiffness.max())  # a usual strain
    return float(10.0 * model.particles.mass.max(initial=1.0) / 1000.0)  # 10 m/s² of a free body


def extent(model: Model) -> float:
    """The larger side (m) of the box around the particles' original places."""
    return float(np.ptp(model.particles.position, axis=0).max(initial=0.0)) or 1.0


def arrow_scale(model: Model, view: View, field: str) -> float:
    """How much of a vector one point of its arrow is: a round number, the same while the model is open.

    Only where the largest would be longer than a picture has room for, it is another one.
    """
    field = _DISTRIBUTED.get(field, field)
    size, kept = usual(model, field), view.arrow_scales.get(field, 0.0)
    if size > LONGEST * kept:
        kept = view.arrow_scales[field] = round_down(size / COMFORTABLE)
    return kept


def arrow_value(view: View, start: Vector, pixel: Vector, scale: float) -> Vector:
    """The vector that an arrow from the point `start` (m) of the picture to a pixel stands for, by its scale.

    Whole points count; a component within reach of zero is zero.
    """
    origin = view.camera.to_pixels(start)
    across = (pixel[0] - origin[0]) / view.pixel_ratio
    up = (origin[1] - pixel[1]) / view.pixel_ratio
    x, y = (
        0.0 if abs(points) <= SNAP_REACH else float(f"{round(points) * scale:.12g}") for points in (across, up)
    )
    return x, y


def arrow_end(view: View, start: Vector, value: Vector, scale: float) -> Vector:
    """The point (m) of the picture where the arrow for a value ends."""
    metres = view.pixel_ratio / scale / view.camera.scale
    return start[0] + metres * value[0], start[1] + metres * value[1]


def borne_at(model: Model, view: View, element: Loaded, pixel: Vector) -> Vector:
    """The point (m) of what bears a load, as it is drawn, from which its arrow at a pixel stands off."""
    if isinstance(element, Particle | Load):
        return drawn_at(model, element.particle if isinstance(element, Load) else element)
    rod = element if isinstance(element, Rod) else model.rods[element.rod]
    return _drawn_at(rod, min(max(share_at(rod, view.camera.to_model(pixel)), 0.0), 1.0))


def dragged(model: Model, view: View, element: Loaded, pixel: Vector) -> list[Field[Any]]:
    """What a drag of the arrow of a load at a pixel changes: where a span load begins or ends, if that is near.

    Else its force, its moment, or its intensity at that end or, in the middle, at both; [] where it has none of its own.
    """
    if isinstance(element, SpanLoad):
        return _dragged_between(model, view, element, pixel)
    kind: Any = type(element)
    if isinstance(element, Rod):
        return [Rod.distributed_force] if any(element.distributed_force) else []
    on = element.particle if isinstance(element, Load) else element
    rim = on.radius * view.camera.scale / view.pixel_ratio
    if element.moment and _away(view, drawn_at(model, on), pixel) <= rim + _ARC:
        return [kind.moment]
    return [kind.force] if any(element.force) else []


def _dragged_between(model: Model, view: View, load: SpanLoad, pixel: Vector) -> list[Field[Any]]:
    rod = model.rods[load.rod]
    length = rod.original_length
    start, end = (min(x, length) for x in (load.start, length if load.end is None else load.end))
    spread = any((*load.start_intensity, *load.end_intensity))
    from_start, from_end = (_away(view, _drawn_at(rod, x / length), pixel) for x in (start, end))
    if from_start <= PARTICLE_REACH:
        return [SpanLoad.start]
    if spread and from_end <= PARTICLE_REACH:
        return [SpanLoad.end]
    if load.moment and from_start <= _ARC:
        return [SpanLoad.moment]
    if any(load.force) and (from_start <= _ARC or not spread):
        return [SpanLoad.force]
    share = (share_at(rod, view.camera.to_model(pixel)) * length - start) / max(end - start, 1e-300)
    of_start, of_end = [SpanLoad.start_intensity], [SpanLoad.end_intensity]
    return of_start * (share < 1.0 - WHOLE) + of_end * (share > WHOLE) if spread else []


def _drawn_at(rod: Rod, share: float) -> Vector:
    """The point (m) at a share of a rod's axis, as it is drawn, which may be bent."""
    x, y = Axes.of(rod.ends[0].world, np.array([rod.row])).points(np.array([share]))[0, 0].tolist()  # type: ignore[arg-type]
    return x, y


def _away(view: View, point: Any, pixel: Vector) -> float:
    """How far (points) a point (m) of the picture is from a pixel."""
    return float(np.hypot(*(view.camera.to_pixels(point) - pixel))) / view.pixel_ratio
