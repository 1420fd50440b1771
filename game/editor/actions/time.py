"""Actions on time: stepping, restarting, pace, undo and redo."""

from __future__ import annotations

import math

from pinjoint.components import written
from pinjoint.components.field import Vector
from pinjoint.components.language import joined, plural, tr
from pinjoint.editor.actions.editing import nudge
from pinjoint.editor.context import Action, Context, action
from pinjoint.systems.collision.impacts import TooManyImpacts
from pinjoint.systems.edit import Refusal

PACE_STEP = 2.0
FAR = 0.2  # s shown that one press skips
MOST_WORK = 1_000_000  # steps × elements of one skip, some 20 ms
MOST_IMPACTS = 1_000_000  # of free discs that the steps of one press may hold, about a second
MANY = 2000  # elements; the pace that suits larger models takes too long to find


def _arrow(direction: Vector, steps: int, *, far: bool) -> Action:
    """The action of an arrow key: once there is a run, right is forward in time; before, it moves what is selected."""

    def act(context: Context, pixel: Vector) -> None:
        if context.document.at_beginning and nudge(context, direction, far=far):
            return
        if steps:
            _step(context, steps * (_far(context) if far else 1))
        elif context.has_selected:
            raise Refusal(
                "Once a run has begun, arrow keys step through time. Ctrl with an arrow moves the selection; R goes back"
                " to the beginning."
            )

    return act


def _move(direction: Vector, *, far: bool) -> Action:
    """The action of an arrow key with Ctrl: move what is selected, whether there is a run or not."""

    def act(context: Context, pixel: Vector) -> None:
        if not nudge(context, direction, far=far):
            raise Refusal("Nothing that can be moved is selected; click a particle or a rod first.")

    return act


for _name, _direction, _steps in (
    ("left", (-1.0, 0.0), -1),
    ("right", (1.0, 0.0), 1),
    ("up", (0.0, 1.0), 0),
    ("down", (0.0, -1.0), 0),
):
    action(f"arrow {_name}")(_arrow(_direction, _steps, far=False))
    action(f"far arrow {_name}")(_arrow(_direction, _steps, far=True))
    action(f"move {_name}")(_move(_direction, far=False))
    action(f"move far {_name}")(_move(_direction, far=True))


def _far(context: Context) -> int:
    """Steps of one skip; fewer in large models, to keep the wait short."""
    model = context.model
    elements, size = model.particles.count + model.rods.count + 1, model.clock.step_size
    most = max(MOST_WORK // elements, 1)
    if elements > MANY or size == 0.0:
        return most if size > 0.0 else 1
    return min(max(round(FAR * context.pace / size), 1), most)


def _step(context: Context, steps: int) -> None:
    clock, impacts = context.model.clock, context.impacts
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


action("step")(lambda context, pixel: _step(context, 1))
action("step back")(lambda context, pixel: _step(context, -1))
action("faster", while_drawing=True)(lambda context, pixel: context.document.live.clock.faster(PACE_STEP))
action("slower", while_drawing=True)(lambda context, pixel: context.document.live.clock.faster(1.0 / PACE_STEP))
action("natural pace", while_drawing=True)(
    lambda context, pixel: setattr(context.document.live.clock, "factor", 1.0)
)


@action("restart")
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


@action("undo")
def _undo(context: Context, pixel: Vector) -> None:
    title = context.undo()
    context.notice = tr("Undone: {title}", title=tr(title)) if title else tr("There is nothing to undo.")


@action("redo")
def _redo(context: Context, pixel: Vector) -> None:
    title = context.redo()
    context.notice = tr("Redone: {title}", title=tr(title)) if title else tr("There is nothing to redo.")


@action("settle")
def _settle(context: Context, pixel: Vector) -> None:
    """Go to the static equilibrium under the full load."""
    context.settle()
    context.view.follow(context.model, clear=True)
