"""Actions on time: running, stepping, restarting, settling, pace."""

from __future__ import annotations

import math
from functools import partial
from operator import attrgetter

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import Vector
from pinjoint.components.language import joined, plural, tr
from pinjoint.components.load import load_ends
from pinjoint.components.rod import nodes
from pinjoint.components.settings import PAUSE, STATICS
from pinjoint.editor.actions.editing import nudge
from pinjoint.editor.context import Context
from pinjoint.systems.collision.impacts import TooManyImpacts
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import SIMULATION, actions_of
from pinjoint.systems.physics.pace import natural_pace

action = actions_of("Time")

_PACE_STEP = 2.0
_WITH_TIME = (SIMULATION, PAUSE)  # the scenes in which keys of time mean something
FAR = 0.2  # s shown that one press skips
MOST_WORK = 1_000_000  # steps × elements of one skip, some 20 ms
MOST_IMPACTS = 1_000_000  # of free discs that the steps of one press may hold, about a second
MANY = 2000  # elements; the pace that suits larger models takes too long to find


@action(
    "toggle run",
    "space",
    "run or pause",
    pressed=lambda context: context.scenes.active.tools == "simulation",
    pressed_as=lambda context: ("pause", ""),
)
def _toggle_run(context: Context, pixel: Vector) -> None:
    """Run or pause; from statics, go on from the equilibrium, if it moves, or else begin undeformed."""
    if context.mode == STATICS and not _begin_from_statics(context):
        return
    context.scenes.request("pause" if context.mode == "simulation" else "simulation")


def _begin_from_statics(context: Context) -> bool:
    """Let the model begin in its equilibrium, as one entry of the log; False where it would only stay there.

    Asked a second time, it begins undeformed instead.
    """
    model, statics = context.model, context.document.statics
    velocity = model.tables["particles"].storage("velocity").copy()
    moving = velocity.any() or not nodes(model).all()
    statics.go_on(to_the_end=True)
    if statics.offered == statics.revision:
        context.restart()
        return True
    if statics.balanced and not moving and math.inf not in load_ends(model):
        statics.offered = statics.revision
        context.notice = tr(
            "In equilibrium nothing would move. Press Space again to let it begin undeformed, with its loads at once."
        )
        return False
    if statics.balanced:
        context.settle(model.settings.load_steps, anew=True)
        rows = np.flatnonzero(velocity.any(axis=1)).tolist()  # which equilibrium has none of
        model.assign([model.particles[row] for row in rows], "velocity", [tuple(velocity[row]) for row in rows])
    return True


action("pause")(lambda context, pixel: context.scenes.request("pause"))


def _arrow(way: float, far: bool, context: Context, pixel: Vector) -> None:
    """An arrow key: once there is a run, right is forward in time; before, it moves what is selected."""
    if context.document.at_beginning and nudge(context, (way, 0.0), far=far):
        return
    model, steps = context.model, 1
    size = model.clock.step_size
    if far and size > 0.0:  # fewer in large models, to keep the wait short
        elements = model.particles.count + model.rods.count + 1
        steps = max(MOST_WORK // elements, 1)
        if elements <= MANY:
            steps = min(max(round(FAR * natural_pace(model) / size), 1), steps)
    _step(context, round(way) * steps)


action("arrow right", "right", "step forward", (PAUSE,), repeats=True)(partial(_arrow, 1.0, False))
action("arrow left", "left", "step back", (PAUSE,), repeats=True)(partial(_arrow, -1.0, False))
action("far arrow right", "shift+right", "skip ahead", (PAUSE,), repeats=True)(partial(_arrow, 1.0, True))
action("far arrow left", "shift+left", "skip back", (PAUSE,), repeats=True)(partial(_arrow, -1.0, True))
action("step", ".", "step forward", (PAUSE,), repeats=True)(lambda context, pixel: _step(context, 1))
action(
    "step back",
    ",",
    "step back",
    (PAUSE,),
    repeats=True,
    enabled=lambda context: context.document.timeline.first < context.model.clock.steps,
)(lambda context, pixel: _step(context, -1))


def _step(context: Context, steps: int) -> None:
    clock, impacts = context.model.clock, context.simulation.impacts
    impacts.most_awaited = MOST_IMPACTS
    try:
        done = context.step(steps)
    except TooManyImpacts:
        raise Refusal(
            plural(
                "One step has more than {most} impacts. Press Space to run slowly enough to see them, or choose a smaller"
                " time step.",
                "{count} steps have more than {most} impacts. Press Space to run slowly enough to see them, or choose a"
                " smaller time step.",
                abs(steps),
                most=MOST_IMPACTS,
            )
        ) from None
    finally:
        impacts.most_awaited = math.inf
    time = written.time(clock.time)
    if done:
        context.notice = tr("Step {step}, t = {time}", step=clock.steps, time=time)
    elif steps < 0:
        context.notice = tr(
            "Step {step}, t = {time}: this is as far back as steps go. Ctrl+Z undoes what was done here, R restarts.",
            step=clock.steps,
            time=time,
        )
    else:
        context.notice = context.simulation.message


@action(
    "restart",
    "r",
    "restart from the undeformed shape",
    enabled=lambda context: not context.document.is_undeformed,
)
def _restart(context: Context, pixel: Vector) -> None:
    if context.document.is_undeformed:
        raise Refusal("This is the beginning already: no time has passed. Ctrl+Z undoes edits.")
    known = context.document.undeformed is not None
    context.restart()
    begun_at_rest = tr(
        "The file does not say with which velocities the run began, so all particles are at rest."
    )
    back = tr("Back at the beginning, undeformed; all edits are kept.")
    context.notice = back if known else joined([back, begun_at_rest])


@action("settle", "e", "find equilibrium at once", enabled=attrgetter("model.particles.count"))
def _settle(context: Context, pixel: Vector) -> None:
    """Go to the static equilibrium under the full load."""
    if context.mode == STATICS:
        raise Refusal("What is shown is the equilibrium already. Z changes the theory, Q leaves statics.")
    if context.model.particles.count == 0:
        raise Refusal("There is nothing to solve yet; draw a structure with P and L, or open one with D.")
    context.settle()
    context.view.follow(context.model, clear=True)


action("faster", "+", "run faster", _WITH_TIME, repeats=True, while_drawing=True)(
    lambda context, pixel: context.document.live.clock.faster(_PACE_STEP)
)
action("slower", "-", "run slower", _WITH_TIME, repeats=True, while_drawing=True)(
    lambda context, pixel: context.document.live.clock.faster(1.0 / _PACE_STEP)
)
action("natural pace", "0", "reset the speed to suit the model", _WITH_TIME, while_drawing=True)(
    lambda context, pixel: setattr(context.document.live.clock, "factor", 1.0)
)
