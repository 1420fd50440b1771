"""Steps among particles that may meet: one kernel that tells a step program what to do next, again and again.

    BETWEEN ─► READY ─► TRYING ─► TRIED ─► HELD ─► OVER ─► BETWEEN
                          ▲          │        │
                          └──────────┴────────┘  with other contact forces, or another end

The step is taken, or foreseen where the integrator allows that, with contact forces that are tried; once they close the
contacts, its paths are looked through for the first impact. If there is one the step is taken again, to end there.
"""

import math

from pinjoint.systems.base import StopReason
from pinjoint.systems.collision.driven.columns import Goal, Need, Order, Phase, Real, Whole
from pinjoint.systems.collision.driven.kernels.contacts import (
    begin_search,
    choose_contacts,
    judge_forces,
    keep_contacts,
    note_unclosed,
    resume_search,
    try_forces,
)
from pinjoint.systems.collision.driven.kernels.crowd import (
    begin_crowd,
    crowd_span,
    is_crowd,
    judge_crowd,
    try_crowd,
)
from pinjoint.systems.collision.driven.kernels.impacts import resolve_touching, set_rest_speeds
from pinjoint.systems.collision.driven.kernels.paths import (
    DOUBTFUL,
    first_impact,
    foreseen_span,
    keep_state,
    meeting,
    plan_clear_steps,
    span_to_list,
    take_back,
    went_too_far,
)
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.program.entries import Control

MOST_ENDS_TRIED = 60  # for a step that ends at an impact


@compiled
def collide(driven, control, account, place, speed):
    """The Order of what a step program is to do next.

    place, speed: of the particles now, shape (n, 2) both. control, account: entries of Control and Account.
    """
    whole = driven.whole
    order = Order.GO_ON
    while order == Order.GO_ON:
        phase = whole[Whole.PHASE]
        if phase == Phase.BETWEEN:
            order = _open(driven, control, place, speed)
        elif phase == Phase.READY:
            order = _begin(driven, control, account, place, speed)
        elif phase == Phase.CLEAR:
            order = _check_clear(driven, control, account, place, speed)
        elif phase == Phase.TRYING:
            order = (
                try_crowd(driven, control, account)
                if whole[Whole.CROWD]
                else try_forces(driven, control, account)
            )
        elif phase == Phase.TRIED:
            if whole[Whole.CROWD]:
                order = judge_crowd(driven, control, account, place, speed)
            else:
                order = judge_forces(driven, control, account, place, speed)
        elif phase == Phase.HELD:
            order = _look(driven, control, account, place, speed)
        else:
            order = _close(driven, control, account, place, speed)
    return order.value


@compiled
def _leave(driven, need, phase):
    driven.whole[Whole.NEED] = need
    driven.whole[Whole.PHASE] = phase
    return Order.LEAVE


@compiled
def _list_within(driven, span, phase):
    driven.real[Real.SPAN] = span
    driven.whole[Whole.PHASE] = phase
    return Order.LIST


@compiled
def _go_on(driven, phase):
    driven.whole[Whole.PHASE] = phase
    return Order.GO_ON


@compiled
def _open(driven, control, place, speed):
    """See whether another step is wanted, and whether it is one of a crowd."""
    whole = driven.whole
    if whole[Whole.REASON] != StopReason.DONE or whole[Whole.TOTAL] - whole[Whole.FIRST] >= whole[Whole.WANTED]:
        return _leave(driven, Need.NOTHING, Phase.BETWEEN)
    span = crowd_span(driven, control, place, speed)
    if span > 0.0:
        return _list_within(driven, span, Phase.BETWEEN)
    whole[Whole.CROWD] = is_crowd(driven, place, speed)
    whole[Whole.PHASE] = Phase.READY
    return Order.EVALUATE


@compiled
def _begin(driven, control, account, place, speed):
    """Keep the state, and choose where the step is to end."""
    whole, real = driven.whole, driven.real
    start, size = control[Control.TIME], control[Control.STEP_SIZE]
    whole[Whole.FORESEEN] = (
        real[Real.PUSH] > 0.0 and real[Real.BREAK] > start + 2.0 * size and not whole[Whole.CROWD]
    )
    clears = whole[Whole.LISTED] == 0 and not whole[Whole.LANDING] and not whole[Whole.EXAMINE]
    if whole[Whole.FORESEEN] and not clears:
        span = foreseen_span(driven, size, place, speed)
        if span > 0.0:
            return _list_within(driven, span, Phase.BETWEEN)
    keep_state(driven, control, account, place, speed, whole[Whole.FORESEEN] and not clears)
    real[Real.START] = start
    whole[Whole.CHOSEN], whole[Whole.STEPS] = 0, 1
    real[Real.BY] = real[Real.UNTIL]
    if clears:
        whole[Whole.FORESEEN], whole[Whole.KEEP] = 0, 1
        if plan_clear_steps(driven, control, place, speed):
            whole[Whole.PHASE] = Phase.CLEAR
            return Order.TAKE
        whole[Whole.EXAMINE] = 1
        return Order.GO_ON
    whole[Whole.EXAMINE] = 0
    if whole[Whole.CROWD]:
        return _begin_crowd(driven, control, account, place, speed)
    whole[Whole.KEEP] = whole[Whole.FORESEEN] == 0
    if not choose_contacts(driven, place):
        return _leave(driven, Need.ROOM, Phase.READY)
    whole[Whole.GOAL], whole[Whole.MET], whole[Whole.CUTS] = Goal.WHOLE, 0, 0
    real[Real.CUT] = real[Real.LONGEST]
    real[Real.END] = real[Real.UNTIL] if whole[Whole.LANDING] else math.inf
    if whole[Whole.CHOSEN] > 0 and real[Real.LONGEST] < size:
        real[Real.END] = min(real[Real.END], start + real[Real.LONGEST])
    if real[Real.END] < math.inf:
        fits = real[Real.END] <= real[Real.UNTIL]
    else:  # a step that is not foreseen is found not to fit as it is taken
        fits = not whole[Whole.FORESEEN] or (real[Real.UNTIL] - start) * (1.0 + 1e-12) >= size
    if not fits:
        return _leave(driven, Need.NOTHING, Phase.BETWEEN)
    begin_search(driven)
    return _go_on(driven, Phase.TRYING)


@compiled
def _begin_crowd(driven, control, account, place, speed):
    """Begin a step of a crowd, with its impacts, or leave where it would end after Real.UNTIL."""
    whole, real = driven.whole, driven.real
    start, h = control[Control.TIME], real[Real.CROWD_LENGTH]
    if not _has_room(driven):
        return _leave(driven, Need.ROOM, Phase.BETWEEN)
    end = min(start + h, real[Real.UNTIL]) if whole[Whole.LANDING] else start + h
    if end > real[Real.UNTIL]:
        return _leave(driven, Need.NOTHING, Phase.BETWEEN)
    real[Real.END] = math.inf if h == control[Control.STEP_SIZE] and not whole[Whole.LANDING] else end
    control[Control.STEP_SIZE] = min(control[Control.STEP_SIZE], real[Real.HELD_LIMIT])
    driven.kept[Control.STEP_SIZE] = control[Control.STEP_SIZE]
    begin_crowd(driven, account, speed)
    for k in range(account.shape[0]):
        driven.kept[control.shape[0] + k] = account[k]
    whole[Whole.KEEP] = 1
    whole[Whole.PHASE] = Phase.TRYING
    return Order.EVALUATE


@compiled
def _check_clear(driven, control, account, place, speed):
    """Take steps back in which a particle went farther, or faster, than was expected; the next one is looked through."""
    whole = driven.whole
    if whole[Whole.TOTAL] == whole[Whole.KEPT_TOTAL] and whole[Whole.REASON] == StopReason.DONE:
        whole[Whole.EXAMINE] = 1
    elif went_too_far(driven, place, speed):
        take_back(driven, control, account, place, speed)
        whole[Whole.EXAMINE] = 1
    return _go_on(driven, Phase.BETWEEN)


@compiled
def _retry(driven, control, account, place, speed, end):
    """Take the step again, to another end (s)."""
    take_back(driven, control, account, place, speed)
    driven.real[Real.END] = end
    resume_search(driven, end)
    return _go_on(driven, Phase.TRYING)


@compiled
def _accept(driven):
    """The step is as it is to be: take it, if it was only foreseen."""
    driven.whole[Whole.PHASE] = Phase.OVER
    return Order.TAKE if driven.whole[Whole.FORESEEN] else Order.GO_ON


@compiled
def _look(driven, control, account, place, speed):
    """Look for the first impact in a step whose contacts are closed, or at one at its end."""
    whole, real = driven.whole, driven.real
    start, now = real[Real.START], real[Real.NOW]
    if now == start or whole[Whole.REASON] == StopReason.DIVERGED or whole[Whole.GOAL] == Goal.PRESSED:
        return _accept(driven)
    if whole[Whole.GOAL] == Goal.IMPACT:
        return _approach(driven, control, account, place, speed)
    after = driven.ahead if whole[Whole.FORESEEN] else place
    later = driven.ahead_speed if whole[Whole.FORESEEN] else speed
    span = 0.0 if whole[Whole.FORESEEN] else span_to_list(driven, now - start, after, later)
    if span > 0.0:
        return _list_within(driven, span, Phase.HELD)
    after_start = first_impact(driven, now - start, after)
    if after_start == DOUBTFUL:
        middle = 0.5 * (start + now)
        if not start < middle < now:  # time resolves no shorter step
            return _accept(driven)
        return _retry(driven, control, account, place, speed, middle)
    impact = start + after_start
    if impact > now:
        return _accept(driven)
    whole[Whole.MET] = 1
    if impact == start:
        return _press(driven, control, account, place, speed, after_start)
    whole[Whole.GOAL], whole[Whole.TRIES] = Goal.IMPACT, 0
    real[Real.IMPACT], real[Real.LAST] = impact, now
    return _retry(driven, control, account, place, speed, impact)


@compiled
def _approach(driven, control, account, place, speed):
    """See whether the step ends where the first pair meets; if not, Newton's method on the gap tells where to end it."""
    whole, real = driven.whole, driven.real
    time, start = real[Real.IMPACT], real[Real.START]
    whole[Whole.TRIES] += 1
    if real[Real.NOW] != time:  # persistent contacts allowed only a part of the step
        return _accept(driven)
    after = driven.ahead if whole[Whole.FORESEEN] else place
    later = driven.ahead_speed if whole[Whole.FORESEEN] else speed
    late, missed = meeting(driven, after, later)
    better = min(time - late, real[Real.LAST])
    if missed == 0.0 or better == time or not start < better < time + (time - start):
        return _accept(driven)
    if whole[Whole.TRIES] >= MOST_ENDS_TRIED:
        note_unclosed(driven, missed)
        return _accept(driven)
    real[Real.IMPACT] = better
    return _retry(driven, control, account, place, speed, better)


@compiled
def _press(driven, control, account, place, speed, soon):
    """Resolve impacts at the start of a step: of particles that are pressed together from rest, or meet so soon (s) after
    it that time resolves no moment between.

    At which speed they stay in contact is known from the step that was tried.
    """
    whole, real = driven.whole, driven.real
    later = driven.ahead_speed if whole[Whole.FORESEEN] else speed
    if not _has_room(driven):
        return _leave(driven, Need.ROOM, Phase.HELD)
    real[Real.LAST] = real[Real.NOW]
    set_rest_speeds(driven, real[Real.NOW] - real[Real.START], later, control[Control.STEP_SIZE])
    take_back(driven, control, account, place, speed)
    if resolve_touching(driven, control, account, place, speed, 2.0 * soon):
        if whole[Whole.LANDING]:
            whole[Whole.REASON] = StopReason.EVENT
        return _end(driven)
    whole[Whole.GOAL] = Goal.PRESSED  # only round-off presses them together
    real[Real.END] = real[Real.LAST]
    begin_search(driven)
    return _go_on(driven, Phase.TRYING)


@compiled
def _close(driven, control, account, place, speed):
    """End a step: note which contacts persist, and resolve what touches."""
    whole, real = driven.whole, driven.real
    h = control[Control.TIME] - real[Real.START]
    if h == 0.0 or whole[Whole.REASON] == StopReason.DIVERGED:
        return _leave(driven, Need.NOTHING, Phase.BETWEEN)
    if not _has_room(driven):
        return _leave(driven, Need.ROOM, Phase.OVER)
    keep_contacts(driven, h, control, account, place, speed)
    set_rest_speeds(driven, h, speed, control[Control.STEP_SIZE])
    resolve_touching(driven, control, account, place, speed, 0.0)
    if whole[Whole.LANDING] and whole[Whole.MET]:
        whole[Whole.REASON] = StopReason.EVENT
    return _end(driven)


@compiled
def _has_room(driven):
    """True if there is room to report an impact of every pair."""
    return driven.whole[Whole.REPORTED] + driven.whole[Whole.LISTED] <= driven.report.shape[0]


@compiled
def _end(driven):
    """Go on after impacts, in Python if something struck what is asleep."""
    if driven.whole[Whole.NEED] == Need.WAKE:
        return _leave(driven, Need.WAKE, Phase.BETWEEN)
    return _go_on(driven, Phase.BETWEEN)
