"""Dividing: members as chains of shorter ones, so that loads find a particle inside and buckling is followed closely."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pinjoint.components.arrays import Array
from pinjoint.components.bent import deflected
from pinjoint.components.derived import chord_rotation
from pinjoint.components.field import SAVED
from pinjoint.components.language import begun, marked, plural, tr
from pinjoint.components.load import SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.slider import SetSliders
from pinjoint.components.wording import quoted
from pinjoint.systems.edit import Refusal

MOST_PARTS = 1000
# Titles of what menus offer, by the number of parts.
DIVISIONS = {2: marked("divide in two"), 4: marked("divide in four")}
# Half a rod has half of the first and twice the others; sliders that move these move the first part only.
_WITH_LENGTH, _AGAINST_LENGTH = ("prescribed_rest_length",), ("damping", "bending_damping")


def divide(model: Model, rods: Sequence[Rod], parts: int = 2) -> list[Rod]:
    """Divide rods into equally long ones, as one edit; returns the new ones, in order. Raises Refusal."""
    if isinstance(parts, bool) or not isinstance(parts, int) or not 2 <= parts <= MOST_PARTS:
        raise Refusal(
            "A rod can be divided into 2 to {most} equal parts, not {parts}.",
            most=MOST_PARTS,
            parts=quoted(parts),
        )
    places = np.arange(1, parts) / parts
    with model.transaction(tr("divide {rods}", rods=several(model, rods))):
        return [part for rod in rods for part in divide_at(model, rod, places)]


def several(model: Model, rods: Sequence[Rod]) -> str:
    """Some rods as a person calls them: "rod AB", "3 rods"."""
    return plural("{rod}", "{count} rods", len(rods), rod=model.describe(rods[0]))


def divide_at(model: Model, rod: Rod, places: Sequence[float] | Array) -> list[Rod]:
    """Divide a rod at places, as shares of its length from its start; returns its parts. Raises Refusal.

    The parts bend, weigh, bear and are damped as the rod did, which is the first of them now, and the state is that of
    its curve. Hinges and springs stay at its ends.
    """
    name = model.describe(rod)
    if rod.bending_stiffness == 0.0:
        raise Refusal(
            "{rod} does not bend, and pinned bars in a line are a mechanism; join it rigidly or give it a bending"
            " stiffness first.",
            rod=begun(name),
        )
    shares = np.asarray(places, dtype=np.float64)
    lengths = np.diff(shares, prepend=0.0, append=1.0)
    if not (lengths > 0.0).all():
        raise Refusal(
            "{rod}: the places where it is divided must be between 0 and 1, in ascending order.",
            rod=begun(name),
        )
    ends, last = rod.ends, len(lengths) - 1
    cuts = rod.original_length * np.append(np.append(0.0, shares), 1.0)
    with model.transaction(tr("divide {rods}", rods=name)):
        between = _particles(model, rod, shares)
        chain = [ends[0], *between, ends[1]]
        pairs = [(first.row, second.row) for first, second in itertools.pairwise(chain)]
        columns = _columns(model, rod, lengths)
        for name in ("hinged", "end_springs", "plastic_rotation"):
            columns[name][1:, 0] = columns[name][:-1, 1] = 0
        names = _names(model, rod, last + 1)
        for field, values in columns.items():
            model.assign([rod], field, values[:1])
        model.assign([rod], "between", [pairs[0]])
        model.assign([rod], "name", names[:1])
        rest = {field: values[1:] for field, values in columns.items()}
        made = model.create(Rod, last, name=names[1:], between=pairs[1:], **rest)
        _let_sliders_move(model, rod, made)
        for load in [load for load in model.span_loads if load.rod == rod.row]:
            _let_parts_bear(model, load, [rod, *made], cuts)
        if kept := model.foreign.get(rod.entity):
            model.foreign.update({part.entity: kept for part in made})
    return [rod, *made]


def _columns(model: Model, rod: Rod, lengths: Array) -> dict[str, Any]:
    """What the parts have, by Field."""
    row, table = rod.row, model.rods
    columns = {}
    for field in table.fields_in(*SAVED):
        if field.name in ("name", "between"):
            continue
        values = np.repeat(table.storage(field.name)[row : row + 1], len(lengths), axis=0)
        if field.name in _WITH_LENGTH:
            values = values * lengths
        elif field.name in _AGAINST_LENGTH:
            values = values / lengths
        columns[field.name] = values
    return columns


def _names(model: Model, rod: Rod, count: int) -> list[str]:
    """The rod's name with numbers from 1 on, behind its own if they are taken."""
    stem = rod.name
    while model.rods.taken(wanted := [f"{stem} {number}" for number in range(1, count + 1)]):
        stem += " 1"
    return wanted


def _particles(model: Model, rod: Rod, shares: Array) -> list[Particle]:
    """New particles on the rod as it is bent now: its cubic, and what a distributed force adds to it."""
    first, second = rod.ends
    rows = [first.row, second.row]
    particles = model.particles

    def along(column: str) -> Any:
        start, end = particles.column(column)[rows]
        return start + np.multiply.outer(shares, end - start)

    across, slopes = deflected(model, rod.row, shares)
    # the beginning, which stays as it was drawn
    if not (particles.displacement.any() or particles.rotation.any()):
        across, slopes = 0.0 * across, 0.0 * slopes
    return model.create(
        Particle,
        len(shares),
        position=along("position"),
        displacement=along("displacement") + across,
        velocity=along("velocity"),
        rotation=chord_rotation(model)[rod.row] + slopes,
        angular_velocity=along("angular_velocity"),
        radius=min(first.radius, second.radius),
    )


def _let_parts_bear(model: Model, load: SpanLoad, parts: Sequence[Rod], cuts: Array) -> None:
    """Give the parts of a rod, between cuts (m) from its start, what a load on it exerts there."""
    start, end = load.start, cuts[-1] if load.end is None else min(load.end, cuts[-1])
    first, last = np.array([load.start_intensity, load.end_intensity])
    own = max(int(np.searchsorted(cuts[:-1], start, side="right")) - 1, 0)
    of_all = {name: getattr(load, name) for name in ("case", "temperature_change", "temperature_gradient")}
    made: list[dict[str, Any]] = []
    for number, (part, (low, high)) in enumerate(zip(parts, itertools.pairwise(cuts.tolist()), strict=True)):
        begins, ends, here = max(start, low), min(end, high), number == own
        values = first + (np.array([[begins], [ends]]) - start) / (end - start or 1.0) * (last - first)
        spread = begins < ends and bool(values.any())
        if here or spread:
            facts = {"rod": part.row, "start": begins - low}
            facts |= {"end": ends - low if spread and ends < high else None}
            facts |= {"force": load.force, "moment": load.moment} if here else {}
            facts |= {"start_intensity": values[0], "end_intensity": values[1]} if spread else {}
            made.append(facts | {"direction": load.direction, **of_all})
        elif load.temperature_change or load.temperature_gradient:
            made.append({"rod": part.row, **of_all})
    none: dict[str, Any] = {"start": 0.0, "moment": 0.0}
    none |= dict.fromkeys(("force", "start_intensity", "end_intensity"), (0.0, 0.0))
    for name, value in [("end", None), *(none | made[0]).items()]:
        model.assign([load], name, [value])
    for facts in made[1:]:
        model.create(SpanLoad, 1, **{name: [value] for name, value in facts.items()})


def _let_sliders_move(model: Model, rod: Rod, parts: Sequence[Rod]) -> None:
    """Let sliders that move a number of the rod move that of the other parts as well."""
    apart = (*_WITH_LENGTH, *_AGAINST_LENGTH)
    sliders = []
    for slider in model.sliders:
        own = [aim for aim in slider.aims if aim.element is rod and aim.field not in apart]
        added = tuple(replace(aim, element=part) for aim in own for part in parts)
        sliders.append(replace(slider, aims=slider.aims + added))
    if tuple(sliders) != model.sliders:
        model.execute(SetSliders(tuple(sliders)))
