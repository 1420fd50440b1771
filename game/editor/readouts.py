"""Readouts of a session: theory beside the run, its energy account, free bodies, and numbers of places along members."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from operator import itemgetter
from textwrap import wrap
from typing import TYPE_CHECKING

from pinjoint.components import written
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import FieldError, Vector, on_screen
from pinjoint.components.free_body import Force, on_joint, on_rod
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, joined, marked, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bearing, bends
from pinjoint.components.tags import Selected
from pinjoint.components.view import Pin, Readout, View
from pinjoint.documents.assessment import LARGEST
from pinjoint.editor.context import Context
from pinjoint.paths import ENERGIES
from pinjoint.systems.base import StopReason
from pinjoint.systems.edit.picking import PARTICLE_REACH
from pinjoint.systems.edit.placing import SNAP_REACH
from pinjoint.systems.edit.rods import share_at
from pinjoint.systems.statics.counting import Count

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.statics.verify import Comparison, Theories

BESIDE = marked("Theory beside the run")  # the title of a panel
MOST_ELEMENTS = 3  # selected elements with a readout of their own
_MOST_JOINTS = 6  # whose sums are shown while none is selected
MOST_EVENTS = 10  # of a run, that are listed
UNSEEN = 1e-7  # of the largest force on a body: left out of sums
NOTHING = 1e-12  # of the largest exact value of its kind: round-off, shown as 0

_BEFORE_SIGNS = re.compile("([+−=]) ")  # where a sum may be broken
_WAYS = {"simulation": marked("the run"), "linear": marked("linear theory"), "exact": marked("exact theory")}
_WORST = {"simulation": marked("largest error of the run"), "linear": marked("largest error of linear theory")}
_DISTURBED = {
    "edited": marked("edited during the run"),
    "pulled": marked("pulled during the run"),
    "settled": marked("settled during the run"),
}
_ENERGIES = ENERGIES | {
    "initial": marked("at the beginning"),
    "work": marked("work of the loads"),
    "imbalance": marked("numerical imbalance"),
}
_ERRORS = {
    "relative": marked("error of displacements"),
    "relative_velocity": marked("error of velocities"),
    "relative_axial_force": marked("error of axial forces"),
    "relative_rotation": marked("error of rotations"),
    "relative_bending_moment": marked("error of bending moments"),
}


def readouts(context: Context) -> Iterator[Readout]:
    """The panels that a person switched on, each with the action that switches it off, then those of mods."""
    panels = {"free bodies": _equilibrium, "theory": _theory, "energy": _energy, "events": _events}
    shown = context.view.wanted | ({"free bodies"} if context.view.free_bodies else set())
    for name, read in panels.items():
        if name in shown:
            yield from (replace(readout, closes=f"toggle {name}") for readout in read(context))
    for panel in EXTENSIONS.panels:
        yield from panel(context)


def _events(context: Context) -> Iterator[Readout]:
    """What happened in the run, the latest last."""
    found = [(event.when, event.message.rstrip(".")) for event in context.document.chronicle.happenings]
    left_out = len(found) - MOST_EVENTS
    earlier = [(plural("one earlier event", "{count} earlier events", left_out), "")] if left_out > 0 else []
    rows = (*earlier, *found[-MOST_EVENTS:]) or ((tr("nothing yet"), ""),)
    yield Readout(tr("What happened"), rows)


def _energy(context: Context) -> Iterator[Readout]:
    energies = context.energy.as_dict()
    nothing = 1e-5 * max(map(abs, energies.values()))  # less is shown as 0 beside the largest
    rows = [
        (tr(_ENERGIES[name]), f"{written.number(value, nothing=nothing)} J") for name, value in energies.items()
    ]
    error = None if context.busy else context.document.assessment.error()  # which takes a run of its own
    if error is not None:
        for key, share in error.record(bent=bends(context.model)).items():
            if key in _ERRORS:
                said = tr("{share} of the largest", share=written.share(share, 2))
                rows.append((tr(_ERRORS[key]), said if share > NOTHING else tr("rounding only")))
    yield Readout(tr("Energy account"), tuple(rows))


def _error(share: float) -> str:
    """A relative error, unless it is nothing but rounding."""
    return written.share(share, 2) if share > NOTHING else tr("rounding only")


# --- numbers along members ----------------------------------------------------------------------------


def distance_at(model: Model, view: View, rod: Rod, pixel: Vector) -> float | None:
    """How far from the start of a rod (m) a pixel of it lies; None unless statics shows forces that change along it."""
    bends_or_bears = rod.bending_stiffness or bearing(model)[rod.row]
    if model.solution is None or not (view.forces_known and bends_or_bears):
        return None
    share = min(max(share_at(rod, view.camera.to_model(pixel)), 0.0), 1.0)
    return share * (rod.original_length if model.first_order else rod.length)


def pinned(context: Context) -> Pin | None:
    """The place on the selected rod whose numbers stay, if there is one."""
    pin, model = context.view.pin, context.model
    if pin is None or model.solution is None or not context.view.forces_known:
        return None
    return pin if model.tagged(Selected) == [pin.rod] else None


def pin_at(context: Context, hit: Handle | None, pixel: Vector) -> None:
    """Let the numbers at a pixel of a rod stay, or no more if it is where they stay already."""
    view, old = context.view, pinned(context)
    view.pin = None
    if isinstance(hit, Rod) and (distance := distance_at(context.model, view, hit, pixel)) is not None:
        middle = 0.5 * hit.original_length
        if abs(distance - middle) * view.camera.scale <= SNAP_REACH * view.pixel_ratio:
            distance = middle
        away = abs(old.distance - distance) if old is not None and old.rod is hit else math.inf
        if away * view.camera.scale > PARTICLE_REACH * view.pixel_ratio:
            view.pin = Pin(hit, distance)


def retype(context: Context, pin: Pin, typed: str) -> None:
    """Take pinned numbers to a typed distance (cm), as far as it is a number."""
    with suppress(ValueError):
        context.view.pin = replace(pin, distance=float(f"0{typed}") / Rod.length.on_screen[1], typed=typed)


# --- free bodies -----------------------------------------------------------------------------------------


def _equilibrium(context: Context) -> Iterator[Readout]:
    """The forces on selected joints and rods and their sums, or without any the sums of all joints."""
    model, chosen = context.model, [h for h in context.selected if isinstance(h, Particle | Rod)]
    if not context.view.forces_known:
        return
    for handle in chosen[:MOST_ELEMENTS]:
        forces = on_joint(model, handle.row) if isinstance(handle, Particle) else on_rod(model, handle.row)
        rows = [(tr(force.name), _parts(force, forces)) for force in forces]
        title = tr("Free body: {element}", element=model.describe(handle))
        yield Readout(title, (*rows, *_sums(forces)))
    if not chosen:
        shown = [
            (f"{particle.said} {title}" if title else "", total)
            for particle in list(model.particles)[:_MOST_JOINTS]
            for title, total in _sums(on_joint(model, particle.row))
        ]
        more = model.particles.count - _MOST_JOINTS
        rest = (
            [(plural("and one more", "and {count} more", more), tr("select one to see it"))] if more > 0 else []
        )
        units = ", ".join(on_screen(unit)[0] for unit in ("kN", "kN·m")[: 1 + bends(model)])
        yield Readout(tr("Free bodies: sums of forces ({unit})", unit=units), (*shown, *rest))


def _parts(force: Force, forces: Sequence[Force]) -> str:
    """Both parts of a force; 0 where one is nothing beside the largest force on its body."""
    nothing = written.ROUNDING * max(max(abs(other.x), abs(other.y)) for other in forces)
    unit, _ = on_screen("kN")
    x, y = (written.amount(part, "kN", nothing=nothing, bare=True) for part in (force.x, force.y))
    turns = written.ROUNDING * max(abs(other.moment) for other in forces)
    if abs(force.moment) <= turns:
        return f"x {x}   y {y} {unit}"
    moment = written.moment(force.moment)
    return f"x {x}   y {y} {unit}   M {moment}" if max(abs(force.x), abs(force.y)) > nothing else f"M {moment}"


def _sums(forces: Sequence[Force]) -> Iterator[tuple[str, str]]:
    """The sums of both parts, and where there are moments theirs, with their numbers."""
    parts = {"ΣFx": [force.x for force in forces], "ΣFy": [force.y for force in forces]}
    if any(force.moment or force.lever for force in forces):
        about_start = any(force.lever for force in forces)
        each = [part for force in forces for part in (force.moment, force.lever)]
        parts[tr("ΣM about its start") if about_start else "ΣM"] = each
    largest = max((max(map(abs, terms)) for terms in parts.values() if terms), default=0.0)
    for title, terms in parts.items():
        _, factor = on_screen("kN·m" if "M" in title else "kN")
        terms = [factor * term if abs(term) > UNSEEN * largest else 0.0 for term in terms]
        lines = wrap(_BEFORE_SIGNS.sub("\\1\xa0", written.total(terms)), 34)  # characters
        for number, line in enumerate(lines):
            yield "" if number else title, line.replace("\xa0", " ")


# --- theory ----------------------------------------------------------------------------------------------


def _theory(context: Context) -> Iterator[Readout]:
    if context.model.rods.count == 0:
        yield Readout(tr(BESIDE), ((tr("There are no rods to compare."), ""),))
    elif not context.document.assessment.is_small:
        yield Readout(tr(BESIDE), ((tr("more than {count} rods: use", count=LARGEST), "pinjoint verify"),))
    else:
        try:
            theory, comparison = context.document.assessment.theories, context.document.assessment.comparison()
        except FieldError:  # running or settling names the number
            yield Readout(tr(BESIDE), ((tr("numbers too large or too small"), ""),))
            return
        yield Readout(tr(BESIDE), tuple(_overview(context, theory, comparison)))
        for handle in context.selected[:MOST_ELEMENTS]:
            yield from _of_element(context.model, handle, comparison)


def _overview(context: Context, theory: Theories, comparison: Comparison) -> Iterator[tuple[str, str]]:
    from pinjoint.systems.statics.verify import JUMPS

    settlement = theory.settlement
    yield from _verdict(context, comparison)
    count, degrees = Count.of(context.model), context.document.assessment.indeterminacy
    yield count.formula, count.numbers
    if said := count.by_rank(degrees.static, degrees.mechanisms):
        yield tr("by matrix rank"), said
    if theory.refusal is not None:
        mechanism = theory.refusal.status == "mechanism"
        yield (
            tr("linear theory"),
            tr("no solution: this is a mechanism") if mechanism else tr("cannot be used: there are cables"),
        )
    if theory.exact is None:
        share = written.share(settlement.final.load_factor)
        yield (
            tr("exact theory"),
            tr("{status} at {share} of the load", status=tr(settlement.status), share=share),
        )
    if (limit := context.document.statics.limit_load) is not None:
        told = tr("collapse at load × {factor}", factor=written.number(limit.factor))
        yield tr("limit analysis"), told if limit.motion is not None else tr(limit.status)
    for event in settlement.events:
        if event.kind in JUMPS:
            yield (tr(event.kind), tr("at {share} of the load", share=written.share(event.load_factor)))
    for way, title in _WORST.items():
        worst = comparison.worst(way)
        if worst is not None:
            error = _error(getattr(worst, f"{way}_error"))
            yield tr(title), tr("{error} ({where})", error=error, where=tr(worst.title))
    if any(comparison.worst(way) is not None for way in _WORST):
        yield tr("errors: in % of the largest value of that kind"), ""
    disturbed = context.document.assessment.disturbed
    if disturbed and not context.document.at_beginning:
        yield tr(_DISTURBED[disturbed]), tr("theory leaves this out")


def _verdict(context: Context, comparison: Comparison) -> Iterator[tuple[str, str]]:
    """Whether a run at rest is where a slowly growing load leads to, and if not, why."""
    from pinjoint.systems.statics.verify import DEPARTURES

    if context.simulation.reason is not StopReason.REST or comparison.worst("simulation") is None:
        return
    if comparison.differs:
        reasons = [
            DEPARTURES[remark.kind]
            for remark in context.document.assessment.remarks
            if remark.kind in DEPARTURES
        ]
        why = joined(map(tr, dict.fromkeys(reasons)), ", ")
        yield tr("differs from static theory"), why or tr("see pinjoint verify")
    else:
        yield tr("at rest"), tr("as static theory predicts")


def _of_element(model: Model, handle: Handle, comparison: Comparison) -> Iterator[Readout]:
    """Readouts of all quantities of an element that theory computes: in the run and by both theories, with errors."""
    if not isinstance(handle, Rod | Particle):
        return
    for quantity, place in sorted(comparison.of(handle.table, handle.row), key=itemgetter(1)):
        row, nothing = comparison.row(quantity, place), NOTHING * comparison.scale(quantity)
        unit, factor = model.tables[handle.table].fields[row.quantity].on_screen
        rows = []
        for way, title in _WAYS.items():
            value, error = getattr(row, way), getattr(row, f"{way}_error", None)
            clear = 0.0 if value is not None and abs(value) <= nothing else value
            named = tr(title)
            if error is not None:
                named = tr("{theory}, error {error}", theory=named, error=_error(error))
            rows.append((named, "—" if clear is None else f"{written.number(factor * clear)} {unit}"))
        yield Readout(begun(tr(row.title)), tuple(rows))
