"""The way to collapse as one computes it by hand: in first order, hinge by hinge, with moments and a displacement."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pinjoint.components.field import ENDS, MOVED
from pinjoint.components.language import joined, marked, tr, tr_in
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod, can_collapse
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.wording import as_said
from pinjoint.tables import Column, Table

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.statics.limit_analysis import LimitLoad

MOST = 100  # rods up to which the way is followed without being asked for
BEYOND = 1e-3  # of the collapse load, by which load steps go on to find it
_SAID = {
    "hinge": marked("hinge at {particle}, {rod}"),
    "yield": marked("{rod} yields"),
    "buckling": marked("{rod} buckles"),
    "slack": marked("{rod} goes slack"),
}
_LAST = {"plastic mechanism": marked("collapse"), "collapse": marked("collapse")}


def collapse_steps(model: Model, found: LimitLoad | None = None) -> Table | None:
    """A row for each step, from the undeformed beginning: its load factor, the moments at all ends where hinges form, the
    axial forces of rods that give way, and the largest displacement there is before collapse; None where nothing limits the
    load, and of large structures. found: the answer of limit analysis, where it is known.
    """
    if not 0 < model.rods.count <= MOST or not can_collapse(model):
        return None
    from pinjoint.systems.statics.limit_analysis import LimitLoad
    from pinjoint.systems.statics.settle import settle
    from pinjoint.systems.statics.state import Start

    start = Start.undeformed(model, 0.0 * model.rods.plastic_strain)
    limit = (found or LimitLoad.of(model)).factor
    if not (math.isfinite(limit) and limit > 0.0):
        return None
    told: list[tuple[float, list[str]]] = []
    sections, rods, names = dict[tuple[int, int], str](), dict[int, str](), model.rods.names
    for event in settle(model, (1.0 + BEYOND) * limit, FIRST_ORDER, start).events:
        if event.kind not in _SAID and event.kind not in _LAST:
            continue
        if not told or event.load_factor > told[-1][0] * (1.0 + 1e-9):  # else of one step
            told.append((event.load_factor, []))
        if event.kind in _LAST:
            said = [tr(_LAST[event.kind])]
        elif event.kind == "hinge":
            row, end = names.index(event.place["rod"]), ENDS.index(event.place["end"])
            sections[row, end] = f"M {event.place['rod']}.{event.place['end']}"
            rod = model.rods[row]
            said = [tr(_SAID["hinge"], particle=rod.ends[end].said, rod=rod.said)]
        else:
            rods |= {names.index(rod): f"N {rod}" for rod in event.rods}
            said = [tr(_SAID[event.kind], rod=as_said(Rod.noun, rod)) for rod in event.rods]
        told[-1][1].extend(one for one in said if one not in told[-1][1])
        if event.kind in _LAST:
            break
    if not told:
        return None
    states = settle(model, [factor for factor, _ in told], FIRST_ORDER, start).states
    told = told[: len(states)]
    moments = np.array([state.diagrams["bending_moment"] for state in states])
    forces = np.array([state.axial_force for state in states])
    moved = np.array([state.displacement for state in states])
    particle, axis = np.unravel_index(int(np.abs(moved[-1]).argmax()), moved[-1].shape)
    columns = [Column("λ", "", np.array([factor for factor, _ in told]), key="load_factor", alike=False)]
    columns += [
        Column(
            f"M {model.rods[row].said}.{tr_in('end of a rod', ENDS[end])}",
            "kN·m",
            moments[:, row, end],
            key=key,
        )
        for (row, end), key in sections.items()
    ]
    columns += [Column(f"N {model.rods[row].said}", "kN", forces[:, row], key=key) for row, key in rods.items()]
    most, key = model.particles[int(particle)], f"u{'xy'[axis]} {model.particles.names[particle]}"
    columns.append(Column(f"u{'xy'[axis]} {most.said}", MOVED[0], MOVED[1] * moved[:, particle, axis], key=key))
    return Table(
        tr("step"), [f"{k}: {joined(said, ', ')}" for k, (_, said) in enumerate(told, start=1)], columns
    )
