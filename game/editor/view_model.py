"""View model: status line, panels, previews and flashes of a session, brought up to date once a frame."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import cases, written
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import FieldError, Vector
from pinjoint.components.language import begun, english, joined, listed, marked, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import PAUSE
from pinjoint.components.tags import Hovered, Selected
from pinjoint.components.theory import EXACT, FIRST_ORDER, NAMES
from pinjoint.components.view import (
    BETWEEN,
    MARGIN,
    Preview,
    Readout,
    Status,
    Trails,
    drawn_at,
    drawn_places,
    drawn_positions,
)
from pinjoint.editor.context import Context, Waiting
from pinjoint.editor.gestures.drawing import Drawing, DrawRod, tool_in_hand
from pinjoint.editor.gestures.moving import Placing
from pinjoint.editor.readouts import distance_at, pinned, readouts
from pinjoint.editor.sliders import slider_stack
from pinjoint.editor.toolbar import toolbar_of
from pinjoint.systems.base import StopReason
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import pick_end, pick_particle, ring_of
from pinjoint.systems.edit.rods import is_rigid
from pinjoint.systems.forms.results import along, told
from pinjoint.systems.input.actions import ACTIONS, LIVE, PROPERTIES
from pinjoint.systems.render.ui.overlays import BAR

READYING = marked("Getting ready for this model, once: about {seconds:.0f} s left.")
MOST_NAMED = 3  # of these, by their names
MOST_TRACED, LONGEST_TRAIL = 5, 600  # particles that leave trails, and moments in these
FARTHEST = 8.0  # times: by how much the view shows more than the original structure to follow what moves


def offer_tools(context: Context) -> None:
    """Let toolbar, sliders and help show what can be done now; what is not seen, or pressed in a drag, stays as it was."""
    view = context.view
    view.keys = tuple(ACTIONS.help_lines(context.scene)) if view.help else ()
    if not context.scenes.active.covers(context):
        view.sliders = slider_stack(context)
        if not isinstance(context.gesture, Placing):
            view.toolbar = toolbar_of(context)


def exaggerate(context: Context) -> None:
    """Let the automatic displacement scale suit the model, but not in the middle of a drag."""
    still = not context.scenes.time_passes or context.simulation.halted
    if context.gesture is None and context.document.exaggeration.review(still=still) and still:
        context.view.follow(context.model)


def follow(context: Context) -> None:
    """Let the view go with the particle that a person chose, be it where a frame draws or where a press acts."""
    view = context.view
    if view.followed is None:
        return
    particle, before = view.followed
    if not particle.exists or particle.world is not context.model:
        view.followed = None
        return
    here, centre = drawn_at(context.model, particle), view.camera.centre
    view.camera.centre = centre[0] + here[0] - before[0], centre[1] + here[1] - before[1]
    view.followed = particle, here


def _trace(context: Context) -> None:
    """Let what is selected leave trails while time passes; they end where time is taken back."""
    model, view = context.model, context.view
    particles = model.tagged(Selected, Particle)[:MOST_TRACED] if model.solution is None else []
    trails, of = view.trails, (*particles, model.settings.displacement_scale)
    if not particles:
        view.trails = Trails()
    elif trails.of != of or context.time != trails.time:
        goes_on = trails.of == of and context.time > trails.time
        places = trails.places[1 - LONGEST_TRAIL :] if goes_on else np.zeros((0, len(particles), 2))
        here = drawn_positions(model)[[particle.row for particle in particles]]
        view.trails = Trails(of, context.time, np.concatenate([places, here[None]]))


def show(context: Context, elapsed: float) -> None:
    """Let the view show the session as it is now, so many seconds after the last time."""
    view, scene = context.view, context.scenes.active
    solved, statics = context.model.solution is not None, context.document.statics
    view.steady = isinstance(context.gesture, Placing)
    if context.window is not None and context.footer is None:
        statics.share_frames(elapsed)
    if solved:  # a mechanism bears nothing, which is no force of 0
        borne = bool(context.model.rods.axial_force.any())
        view.forces_known = statics.balanced or statics.share != 0.0 or borne
    else:
        view.forces_known = context.readiness.waits_for(context.simulation) is None
    awaited = _awaited(context)
    said = _told(awaited) or (scene.message if scene.mod is not None else "")
    lately = context.document.chronicle.told(elapsed) if context.mode in LIVE and not solved else ""
    offer = None
    if context.notice:
        lasting = [context.notice]
    elif solved:
        rested = None if context.window is None else elapsed
        unfinished = tool_in_hand(context) in (DrawRod.tool, "place")  # more of the structure is to come
        lasting = ["" if unfinished else statics.message]
        if second := statics.second_order(rested) if context.gesture is None else "":
            offer = tr(NAMES[EXACT if statics.first_order else FIRST_ORDER]), "next theory"
        if context.gesture is None and not unfinished:
            collapse, divides = statics.collapse(rested)
            lasting.append(collapse)
            offer = (tr("divide there"), "divide at hinges") if divides else offer
        lasting.append(second)
    else:
        remarks = [remark.message for remark in context.document.assessment.remarks]
        lasting = [*remarks, "" if follows(context) else _gone(context)]
        lasting += [_unsettled(context)] * (not any(lasting))
    view.enveloped = None
    if view.envelope and solved:
        try:
            view.enveloped = context.document.envelope([rod.name for rod in view.path if rod.exists])
            if left_out := list(view.enveloped.without):
                said = tr(
                    "Without an equilibrium, and so left out of the envelope: {names}.", names=listed(left_out)
                )
                lasting.append(said)
        except ValueError as reason:  # there are none, or none has an equilibrium
            view.envelope, context.notice = False, str(reason)
    view.preview = _preview(context)
    if view.pressed is not None and not (view.pointer is not None and view.pressed.contains(view.pointer)):
        view.pressed = None
    view.flashes = _flashes(context)
    follow(context)
    _trace(context)
    view.heading = tr(scene.heading)
    view.provisional = _provisional(context)
    view.shape = context.document.shapes.shown or (statics.motion if solved else None)
    view.near_buckling = context.document.shapes.near_buckling(elapsed)
    moves = view.shape is not None or view.near_buckling
    view.swing = context.document.shapes.swing(elapsed) if moves else 1.0
    _show_readouts(context)
    _point_out(context)
    drawing = tr(context.gesture.hint) if context.gesture is not None else _hint_of_tool(context)
    drawing = drawing if context.mode in LIVE else ""
    view.status = Status(
        time=None if solved else context.time,
        speed=context.document.live.clock.shown_pace if context.busy else 0.0,
        state=_state_word(context, brief=bool(drawing)),
        hint=drawing or scene.hint(context),
        problem=_problem(context),
        notice=said or joined([*lasting, lately] if context.notice else [lately, *lasting]),
        offer=offer if not said else None,
        share=min(awaited.seconds / awaited.expected, 0.99) if awaited is not None else None,
    )


def _show_readouts(context: Context) -> None:
    """All panels, and the order in which they came."""
    view = context.view
    view.readouts = tuple(readouts(context))
    latest, since = max(view.since.values(), default=0), view.since
    view.since = {
        english(readout.title): since.get(english(readout.title), latest + number)
        for number, readout in enumerate(view.readouts, start=1)
    }


def _unsettled(context: Context) -> str:
    """The sentence that what was settled was edited since and is in equilibrium no more, "" if it is."""
    document = context.document
    if context.scene not in (PAUSE, PROPERTIES) or document.is_undeformed or document.assessment.balanced:
        return ""
    return tr(
        "The model was edited and is no longer in equilibrium. Press E for the new equilibrium (right click: settle)."
    )


def _provisional(context: Context) -> str:
    """Why what is shown is no equilibrium; "" if it is one, or nothing is computed."""
    model, document = context.model, context.document
    if not model.rods.count:
        return ""
    if model.solution is not None:
        return "" if document.statics.balanced else tr(document.statics.said)
    if not context.view.forces_known or document.assessment.in_equilibrium:
        return ""
    time = written.time(model.clock.time)
    return (
        tr("in motion, t = {time}", time=time) if context.busy else tr("no equilibrium, t = {time}", time=time)
    )


def _gone(context: Context) -> str:
    """The sentence that what moves has left the picture, "" if it has not."""
    model, view = context.model, context.view
    if context.scene not in LIVE or not 0 < model.particles.count <= 2000 or context.document.at_beginning:
        return ""
    x, y = view.camera.to_pixels(drawn_positions(model)).T
    v, reach = view.canvas, model.particles.radius * view.camera.scale
    bottom = v.bottom - BAR * view.pixel_ratio
    inside = (x > v.left - reach) & (x < v.right + reach) & (y > v.top - reach) & (y < bottom + reach)
    moving = ~model.particles.fixed.all(axis=1) & model.particles.displacement.any(axis=1)
    gone = np.flatnonzero(moving & ~inside)
    if not len(gone) or (moving & inside).sum() > len(gone):
        return ""
    if not (moving & inside).any():
        return tr(
            "Everything that moves has left the picture. Press Home to see it (right click: fit the view)."
        )
    names = listed([model.particles.names[row] for row in gone[:MOST_NAMED]])
    if len(gone) > MOST_NAMED:
        names = tr("{count} particles", count=len(gone))
    return plural(
        "{particles} has left the picture. Press Home to see everything (right click: fit the view).",
        "{particles} have left the picture. Press Home to see everything (right click: fit the view).",
        len(gone),
        particles=begun(names),
    )


def follows(context: Context) -> bool:
    """True if a window is to show all again now, since what moves has left it and nobody looks elsewhere.

    Scripts and recordings fit the view by lines of their own. What goes too far is not followed: nothing would be seen.
    """
    view, model = context.view, context.model
    by_itself = context.window is not None and context.busy and context.footer is None and view.followed is None
    busy = context.gesture is not None or view.menu is not None or view.tool or view.help
    if not by_itself or busy or not view.fitted or not _gone(context):
        return False
    scales = []
    for places in (drawn_places(model), model.particles.position):
        camera = replace(view.camera)
        camera.fit(places, MARGIN, view.room, view.pixel_ratio)
        scales.append(camera.scale)
    return scales[0] * FARTHEST > scales[1]


def _point_out(context: Context) -> None:
    """Say what the element under the pointer does now, in the view that shows it, and what the pinned place does."""
    model, view = context.stages[0]
    view.pointer, pointed = context.view.pointer, None
    if isinstance(model, Model) and (hovered := model.tagged(Hovered)):
        rows = told(model, hovered[0], forces_known=view.forces_known)
        if rows and view.enveloped is not None:
            rows.append((tr("combination"), cases.said(model, model.settings.combination)))
        pointed = Readout(model.describe(hovered[0]), tuple(rows)) if rows else None
        if isinstance(rod := hovered[0], Rod) and view.pointer is not None:
            place = distance_at(model, view, rod, view.pointer)
            pointed = pointed if place is None else along(model, rod, place, view.enveloped)
    view.pointed = context.view.pointed = pointed
    if (pin := context.view.pin) is not None:
        shown = pinned(context) is not None
        told_there = along(context.model, pin.rod, pin.distance, context.view.enveloped) if shown else None
        context.view.pin = replace(pin, told=told_there)


def _awaited(context: Context) -> Waiting | None:
    """What the run waits for, None if it does not (any more)."""
    readiness = context.readiness
    waited = readiness.waits_for(readiness.awaited) if readiness.awaited is not None else None
    if waited is None:
        readiness.awaited = None
    return waited


def _told(waited: Waiting | None) -> str:
    """The notice that a run gets ready, "" if none does."""
    if waited is None:
        return ""
    left = waited.expected - waited.seconds
    if left > 1.0:
        return tr(READYING, seconds=left)
    return tr("Getting ready for this model, once: nearly done.")


def _flashes(context: Context) -> NDArray[np.float64]:
    """Where particles collided within the last FLASH seconds shown (m), shape (k, 2)."""
    impacts = context.simulation.impacts
    if not context.busy or len(impacts) == 0:
        return np.zeros((0, 2))
    since = context.time - 0.15 * context.document.live.clock.shown_pace  # s shown
    first = max(int(np.searchsorted(impacts.time, since)), len(impacts) - 500)  # the last
    return np.column_stack([impacts.x[first:], impacts.y[first:]])


def _preview(context: Context) -> Preview | None:
    try:
        if context.gesture is None:
            return _pointed_at(context, context.view.pixel) if context.mode in LIVE else None
        gesture = context.gesture
        if not (isinstance(gesture, Drawing) and gesture.typed):
            return gesture.preview(context, context.view.pixel)
        at = context.view.camera.to_model(context.view.pixel)
        made = Preview("", at, at)  # while what is typed is no number yet, or none in such a unit
        with suppress(FieldError):
            made = gesture.preview(context, context.view.pixel) or made
        unit = "" if any(map(str.isalpha, gesture.typed)) else "°" if "@" in gesture.typed else gesture.unit[1]
        return replace(made, typed=f"{gesture.typed}| {unit}".rstrip(), problem=gesture.problem)
    except Refusal as error:
        context.gesture, context.notice = None, str(error)
        return None


def _hint_of_tool(context: Context) -> str:
    """The status line while clicks use the tool in hand."""
    tool = context.view.tool
    if tool == DrawRod.tool:
        steps = tr("rods: click from place to place, or drag"), DrawRod.kind(context)
        return joined([*steps, tr("double click ends the chain     Esc done")], BETWEEN)
    return tr(ACTIONS[tool].hint) if tool else ""


def _pointed_at(context: Context, pixel: Vector) -> Preview | None:
    """With a tool in hand: where a rod or a particle would begin, or what a click makes of the end under the pointer."""
    model, view = context.model, context.view
    if view.tool and view.pointer is not None and not view.covers(pixel):
        at = ACTIONS[view.tool].begins(context, pixel)
        if at is not None:
            return Preview("hinge", at, at, written.place(at, written.DIGITS))
    if view.tool != "hinge" or pick_particle(model, view, pixel) is not None:
        return None
    found = pick_end(model, view, pixel)
    if found is None:
        return None
    rod, end = found
    ring, particle = ring_of(model, view, rod, end), rod.ends[end].said
    label = (
        tr("hinge {rod} at {particle}", rod=rod.said, particle=particle)
        if is_rigid(rod, end)
        else tr("make {rod} rigid at {particle}", rod=rod.said, particle=particle)
    )
    return Preview("hinge", ring, ring, label)


def _state_word(context: Context, *, brief: bool) -> str:
    """The state of the run in English, which is translated where it is shown; brief: beside the steps of a tool."""
    if context.model.solution is not None:
        return context.document.statics.said
    if context.simulation.halted:
        return marked("at rest") if context.simulation.reason is StopReason.REST else marked("diverged")
    if context.readiness.awaited is not None:
        return marked("preparing")
    if not context.busy:
        moved = context.view.provisional and context.scene == PAUSE and not brief
        return marked("paused, not in equilibrium") if moved else marked("paused")
    if not context.document.live.clock.lagging:
        return marked("running")
    slow = (
        marked("running below the set speed: getting ready"),
        marked("running below the set speed: steps take too long"),
    )
    return slow[0] if context.readiness.readies else slow[1]


def _problem(context: Context) -> str:
    """Why the run stopped, or a warning though it goes on."""
    simulation = context.simulation
    if fault := EXTENSIONS.last_fault(context.faults_seen):
        return joined([fault, tr("Press Esc to close this message.")])
    if simulation.reason is StopReason.DIVERGED and simulation.halted:
        return simulation.message
    return simulation.warning
