"""The loop of explicit Runge–Kutta drivers for many variants side by side, as source; see side_by_side.py.

What runge_kutta.py uses is there for lanes. A step is plain if it is met at the first attempt and nothing
interrupts it: that it is rejected, or ends at an event, is known once all lanes have taken it.
"""

from systems.physics.side_by_side import look, put_back, set_aside

# ruff: noqa: F821
# mypy: ignore-errors

VARYING = {
    "evaluate": ("time", "dt"),
    "extrapolate": ("dt",),
    "accelerate": (),
    "stages": ("time", "dt", "allowed"),
    "combine": ("dt", "tolerance"),
    "mark": ("dt",),
    "passed": ("dt",),
    "measure": (),
    "remember": ("time", "dt"),
}
AS_THEY_ARE = ("is_check_due", "error_of", "aim", "follow")


def plan(
    going, plain, coming, taken, first, origin, tolerance, breaks, until, landing, control, time, goal, dt
):
    """Which lanes have a step before them that nothing interrupts, when it ends and how long it is."""
    for lane in range(LANES):
        time[lane] = control[TIME, lane]
        step = control[STEP, lane]
        goal[lane], reach = aim(time[lane], step, origin[lane], first[lane] + taken[lane], tolerance[lane])
        while breaks[coming[lane]] <= time[lane]:
            coming[lane] += 1
        interrupted = reach >= breaks[coming[lane]] or time[lane] < landing <= reach
        plain[lane] = going[lane] and not interrupted and goal[lane] <= until
        dt[lane] = goal[lane] - time[lane]


def accept(goal, dt, displacement, velocity, work, gained, account, spare, *columns):
    """The result of a step becomes the state."""
    trial, speed = work[STAGES], work[STAGES + 1]
    for i in range(displacement.shape[0]):
        for d in range(2):
            for lane in range(LANES):
                displacement[i, d, lane] = trial[i, d, lane]
                velocity[i, d, lane] = speed[i, d, lane]
    if POWERS or LOADS:
        for k in range(gained.shape[0]):
            for lane in range(LANES):
                account[k, lane] += 1000.0 * dt[lane] * gained[k, lane]
    if COMMITS:
        remember(goal, dt, displacement, account, *columns, spare)


def advance(
    going,
    steps,
    total,
    first,
    origin,
    tolerance,
    limit,
    breaks,
    until,
    landing,
    loads_end,
    control,
    displacement,
    velocity,
    account,
    measures,
    search,
    force,
    resisting,
    direction,
    work,
    rod_work,
    marks,
    power,
    gained,
    stage_power,
    spare,
    numbers,
    plain,
    coming,
    taken,
    reason,
    *everything,
):
    """Let the lanes that are going take up to so many steps each, as advance() of runge_kutta.py does.

    Returns when hardly half of them go on: the others may then be computed with more of their kind.
    """
    time, goal, dt, error, gap, none = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]
    few = going.sum() // 2
    for lane in range(LANES):
        search[LONGEST, lane] = limit[lane]
    while True:
        evaluate(control[TIME], dt, displacement, velocity, force, resisting, direction, power, *columns, spare)
        accelerate(force, resisting, work[0], *columns, spare)
        look(
            going,
            plain,
            steps,
            total,
            total,
            taken,
            reason,
            loads_end,
            control[TIME],
            control[STEP],
            none,
            displacement,
            velocity,
            force,
            resisting,
            account,
            measures,
            spare,
            *columns,
        )
        if going.sum() <= few:
            return
        plan(
            going,
            plain,
            coming,
            taken,
            first,
            origin,
            tolerance,
            breaks,
            until,
            landing,
            control,
            time,
            goal,
            dt,
        )
        if EVENTS:
            mark(dt, displacement, velocity, marks, *columns, spare, gap)
        for k in range(gained.shape[0]):
            for lane in range(LANES):
                gained[k, lane] = RESULT_V[0, 0] * power[k, lane]
        stages(
            time,
            dt,
            tolerance,
            displacement,
            velocity,
            force,
            resisting,
            direction,
            work,
            rod_work,
            gained,
            stage_power,
            *columns,
            spare,
            error,
        )
        combine(dt, tolerance, displacement, velocity, work, control, search, spare, error)
        if EVENTS:
            passed(dt, work[STAGES], work[STAGES + 1], marks, True, *columns, spare, gap)
        for lane in range(LANES):
            plain[lane] = plain[lane] and error[lane] <= 1.0 and not (EVENTS and gap[lane] < -EVENT_FLOOR)
        set_aside(plain, *single)
        accept(goal, dt, displacement, velocity, work, gained, account, spare, *columns)
        put_back(plain, *single)
        for lane in range(LANES):
            if plain[lane]:
                control[TIME, lane] = goal[lane]
                control[LARGEST_X, lane] = search[TRIAL_X, lane]
                control[LARGEST_V, lane] = search[TRIAL_V, lane]
                taken[lane] += 1
                if tolerance[lane] > 0.0:
                    follow(control[:, lane], dt[lane], limit[lane], error[lane], False)
            elif going[lane]:
                done, reason[lane] = alone(
                    lane,
                    total,
                    first,
                    origin,
                    tolerance,
                    limit,
                    breaks,
                    until,
                    landing,
                    loads_end,
                    taken,
                    *single,
                )
                taken[lane] += done
                going[lane] = done > 0 and reason[lane] == 0 and taken[lane] < steps[lane]
