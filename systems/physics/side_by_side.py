"""The loop of explicit Runge–Kutta drivers for many variants side by side, as source.

Each lane takes the steps that runge_kutta.py would have it take, in the same order of operations. Steps that are
met at the first attempt, and that nothing interrupts, are taken by all lanes at once; whichever lane has another
one before it (that is rejected, or ended by an event or a break) takes it alone, by the program of a single run.
Written like fixed_steps.py, which says what `*columns` is; arrays have the lanes as their last axis, and what
runge_kutta.py uses is there for lanes, with an array `spare` to write to. Besides, the program provides

    alone(lane, …, *single)
        lets one of the lanes take a step by the program of a single run; returns (steps taken, StopReason)

and LANES. `*single` stands for what that takes, `*everything` for the columns and that.
"""

# ruff: noqa: F821
# mypy: ignore-errors


def stages_side_by_side(
    at,
    time,
    dt,
    displacement,
    velocity,
    force,
    resisting,
    direction,
    work,
    gained,
    stage_power,
    spare,
    *columns,
):
    """Accelerations of the stages after the first."""
    trial, speed = work[STAGES], work[STAGES + 1]
    for s in range(1, STAGES):
        extrapolate(s, dt, displacement, velocity, work, trial, speed, spare)
        for lane in range(LANES):
            at[lane] = time[lane] + NODES[s] * dt[lane]
        evaluate(at, dt, trial, speed, force, resisting, direction, stage_power, *columns, spare)
        accelerate(force, resisting, work[s], *columns, spare)
        if POWERS or LOADS:
            for k in range(gained.shape[0]):
                for lane in range(LANES):
                    gained[k, lane] += RESULT_V[0, s] * stage_power[k, lane]


def aim_side_by_side(
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


def accept_side_by_side(plain, goal, dt, displacement, velocity, work, gained, account, spare, *columns):
    """The result of a step becomes the state of the lanes that take it."""
    trial, speed = work[STAGES], work[STAGES + 1]
    for i in range(displacement.shape[0]):
        for d in range(2):
            for lane in range(LANES):
                if plain[lane]:
                    displacement[i, d, lane] = trial[i, d, lane]
                    velocity[i, d, lane] = speed[i, d, lane]
    if POWERS or LOADS:
        for k in range(gained.shape[0]):
            for lane in range(LANES):
                if plain[lane]:
                    account[k, lane] += 1000.0 * dt[lane] * gained[k, lane]
    if COMMITS:
        remember(goal, dt, displacement, account, *columns, spare, plain)


def look_side_by_side(
    going,
    plain,
    steps,
    total,
    taken,
    reason,
    loads_end,
    control,
    displacement,
    velocity,
    force,
    resisting,
    account,
    measures,
    spare,
    *columns,
):
    """After a step: which of the lanes that took it stop, and why."""
    due = False
    for lane in range(LANES):
        due = due or (plain[lane] and is_check_due(total[lane] + taken[lane], total[lane] + taken[lane]))
    if due:
        measure(displacement, velocity, force, resisting, measures, *columns, spare)
    for lane in range(LANES):
        if plain[lane]:
            now = total[lane] + taken[lane]
            if is_check_due(now, now):
                over = control[TIME, lane] >= loads_end
                reason[lane] = judge(
                    measures[:, lane], account[:, lane], control[STEP, lane], SHADOW, 0.0, over
                )
            if reason[lane] == 0 and now % REVIEW_INTERVAL == 0:
                reason[lane] = 1
            going[lane] = reason[lane] == 0 and taken[lane] < steps[lane]


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
    time, goal, dt, at, error, gap = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]
    few = going.sum() // 2
    for lane in range(LANES):
        search[LONGEST, lane] = limit[lane]
    while True:
        evaluate(control[TIME], dt, displacement, velocity, force, resisting, direction, power, *columns, spare)
        accelerate(force, resisting, work[0], *columns, spare)
        look_side_by_side(
            going,
            plain,
            steps,
            total,
            taken,
            reason,
            loads_end,
            control,
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
        aim_side_by_side(
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
        stages_side_by_side(
            at,
            time,
            dt,
            displacement,
            velocity,
            force,
            resisting,
            direction,
            work,
            gained,
            stage_power,
            spare,
            *columns,
        )
        combine(dt, tolerance, displacement, velocity, work, control, search, spare, error)
        if EVENTS:
            passed(dt, work[STAGES], work[STAGES + 1], marks, True, *columns, spare, gap)
        for lane in range(LANES):
            plain[lane] = plain[lane] and error[lane] <= 1.0 and not (EVENTS and gap[lane] < -EVENT_FLOOR)
        accept_side_by_side(plain, goal, dt, displacement, velocity, work, gained, account, spare, *columns)
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
