"""The loop over steps, the same for every integrator, and when a state is checked.

The integrator says how one step is taken: a fragment `step`, in fixed_steps.py or runge_kutta.py.
"""

# ruff: noqa: F821, F841, SIM102
# mypy: ignore-errors


def is_check_due(total, age):
    """Whether a state is checked: at every multiple of CHECK_INTERVAL, before it at powers of 2."""
    return total % CHECK_INTERVAL == 0 or (age < CHECK_INTERVAL and age & (age - 1) == 0)


def aim(time, step, origin, age, tolerance):
    """When a step would end, and up to when a break ends it instead: no step of a sliver is left before the break."""
    if tolerance > 0.0:
        goal = time + step
        return goal, goal + 0.01 * step
    goal = origin + (age + 1) * step
    return goal, goal


def advance(
    steps,
    fresh,
    total,
    first,
    origin,
    tolerance,
    limit,
    bounds,
    loads_end,
    control,
    state,
    scratch,
    account,
    measures,
    *columns,
):
    """Take up to `steps` steps that end by `until` (s); returns (steps taken, StopReason).

    fresh: the forces are still those of the present state. total: all steps so far. first: steps since the time origin,
    which moves with every step whose size is controlled. tolerance: relative, of one step; 0: all steps have the length
    control[Control.STEP_SIZE]. breaks: times that no step passes, ascending, the last one infinite. landing: another such
    time (s), after which steps of fixed length are counted from there. A fixed step that breaks interrupt goes on to its
    end in pieces; none of them is taken where that end is after `until`, by more than rounding.

    States are checked after 1, 2, 4, … steps, because a step that is much too long makes garbage at once, and whenever the
    total is a multiple of CHECK_INTERVAL: at counts that do not depend on how the steps are divided into calls. Where they
    are all alike, what loads will supply (ahead, J) follows from the velocities to which the present forces lead; after one
    that was cut, the conserved energy is that of whole ones again, to which forces of contacts do not belong.
    """
    if not fresh:
        insert(present)
    time = control[Control.TIME]
    if ALIKE:
        inside = False
    else:
        search[Search.LIMIT] = limit
    rounding = SLACK * (until - time)
    ahead = 0.0
    taken = 0
    coming = 0
    while taken < steps:
        size = control[Control.STEP_SIZE]
        age = first + taken
        goal, reach = aim(time, size, origin, age, tolerance)
        while breaks[coming] <= time:
            coming += 1
        stop = breaks[coming]
        if time < landing < stop:
            stop = landing
        end = stop if reach >= stop else goal
        last = end
        if tolerance == 0.0:
            last = landing if time < landing < goal else goal
        if last - until > rounding:
            break
        insert(step)
        control[Control.TIME] = time
        is_over = tolerance > 0.0 or time >= goal or time == landing
        happening = STOPS and (EVENTS or is_over) and happened(displacement, velocity, *scratch, *columns)
        if is_over:
            taken += 1
            now = total + taken
            if is_check_due(now, counted):
                measure(displacement, velocity, force, resisting, measures, *columns)
                if FORESEES:
                    for i in range(displacement.shape[0]):
                        for d in range(D):
                            pull = force[i, d] + resisting[i, d] if RATES else force[i, d]
                            predicted[i, d] = velocity[i, d] + compared * pull * particles_mobility[i, d]
                    ahead = 1000.0 * compared * abs(load_power(time, predicted, *columns))
                reason = judge(measures, account, compared, SHADOW, ahead, time >= loads_end)
                if reason != StopReason.DONE:
                    return taken, reason.value
            if ALIKE:
                if cut:
                    measure(displacement, velocity, insert(force), resisting, measures, *columns)
                    account[Account.GUARD_ENERGY] = conserved(measures, account, size, SHADOW)
            if now % REVIEW_INTERVAL == 0:
                return taken, StopReason.REVIEW.value
        if happening:
            return taken, StopReason.EVENT.value
    return taken, StopReason.DONE.value
