"""Runge–Kutta drivers as source: one loop with error control and events for every tableau.

Written like fixed_steps.py, which says what `*columns` is. Besides, the program provides

    evaluate(time, dt, displacement, velocity, force, resisting, direction, power, *columns)
        like forces(), and power ← what each account gains per second (kN·m/s)
    mark(dt, displacement, velocity, marks, *columns)
        notes for every rod which branch of its law it is on; returns how far the nearest is from leaving
    passed(dt, displacement, velocity, marks, first, *columns)
        how far the nearest rod is from leaving its branch at the end of a step; negative: it has left.
        first: this is the first look at this step, which chooses the rods whose extremes are watched.

and the tableau's constants (see tableaus.py), EVENTS (some rod has branches) and CHECK_INTERVAL.

`work` has rows of shape (particles, 2): the accelerations of the stages, the trial displacement and
velocity, then what the stages need; `marks` one row per rod. `control` is the state of the controller: time
(s), step to try next (s), last error (1 is the tolerance), largest ‖displacement‖ (m) and ‖velocity‖ (m/s).
`search` is that of the search for one step: see narrow(), the largest norms if it is accepted, and how long
steps may be (s).
"""

# ruff: noqa: F821
# mypy: ignore-errors


def explicit_stages(
    time,
    dt,
    allowed,
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
):
    """Accelerations of the stages after the first; True, for it always succeeds."""
    trial, speed = work[STAGES], work[STAGES + 1]
    for s in range(1, STAGES):
        extrapolate(s, dt, displacement, velocity, work, trial, speed)
        at = time + NODES[s] * dt
        evaluate(at, dt, trial, speed, force, resisting, direction, stage_power, *columns)
        accelerate(force, resisting, work[s], *columns)
        if POWERS or LOADS:
            for k in range(gained.shape[0]):
                gained[k] += RESULT_V[0, s] * stage_power[k]
    return True


def extrapolate(s, dt, displacement, velocity, work, trial, speed):
    """What the stages before stage `s` make of displacement and velocity there."""
    for i in range(displacement.shape[0]):
        for d in range(2):
            p = 0.0
            q = 0.0
            for j in range(s):
                p += STAGE_V[s, j] * work[j, i, d]
                q += STAGE_X[s, j] * work[j, i, d]
            v = velocity[i, d]
            speed[i, d] = v + dt * p
            trial[i, d] = displacement[i, d] + dt * (NODES[s] * v + dt * q)


def accelerate(force, resisting, acceleration, *columns):
    """Acceleration (m/s²) under the forces of a state."""
    for i in range(force.shape[0]):
        fx = force[i, 0]
        fy = force[i, 1]
        if RATES:
            fx += resisting[i, 0]
            fy += resisting[i, 1]
        acceleration[i, 0] = fx * particles_mobility[i, 0]
        acceleration[i, 1] = fy * particles_mobility[i, 1]


def combine(dt, tolerance, displacement, velocity, work, control, search):
    """The result of a step into the trial rows, and its error: 1 is the tolerance, 0 without control.

    The norms are Euclidean over all particles, of displacement and velocity each relative to the largest so
    far: a driver that kept each component relative to itself would chase the round-off of what stands still.
    Round-off of displacements x is one of accelerations ω²x, so that in steps shorter than what is stable, some
    6/ω, velocities have less of it: a force that jumps, as the damper of a cable does, is crossed by such steps.
    """
    trial, speed = work[STAGES], work[STAGES + 1]
    size_x = 0.0
    size_v = 0.0
    wrong_x = 0.0
    wrong_v = 0.0
    also_x = 0.0
    also_v = 0.0
    for i in range(displacement.shape[0]):
        for d in range(2):
            p = 0.0
            q = 0.0
            for j in range(STAGES):
                p += RESULT_V[0, j] * work[j, i, d]
                q += RESULT_X[0, j] * work[j, i, d]
            v = velocity[i, d]
            speed[i, d] = v + dt * p
            trial[i, d] = displacement[i, d] + dt * (v + dt * q)
            size_x += trial[i, d] * trial[i, d]
            size_v += speed[i, d] * speed[i, d]
            if ESTIMATES > 0:
                p = 0.0
                q = 0.0
                for j in range(STAGES):
                    p += RESULT_V[1, j] * work[j, i, d]
                    q += RESULT_X[1, j] * work[j, i, d]
                wrong_x += q * q
                wrong_v += p * p
            if ESTIMATES > 1:
                p = 0.0
                q = 0.0
                for j in range(STAGES):
                    p += RESULT_V[2, j] * work[j, i, d]
                    q += RESULT_X[2, j] * work[j, i, d]
                also_x += q * q
                also_v += p * p
    search[TRIAL_X] = max(control[LARGEST_X], math.sqrt(size_x))
    search[TRIAL_V] = max(control[LARGEST_V], math.sqrt(size_v))
    return error_of(
        dt,
        tolerance,
        search[LONGEST],
        search[TRIAL_X],
        search[TRIAL_V],
        size_x + size_v,
        wrong_x,
        wrong_v,
        also_x,
        also_v,
    )


def error_of(dt, tolerance, longest, largest_x, largest_v, size, wrong_x, wrong_v, also_x, also_v):
    """The error of a step, by the squared norms of its result (`size`) and of the estimates."""
    allowed_x = tolerance * largest_x + ROUND_OFF_X * largest_x
    round_off = ROUND_OFF_V * largest_x / dt
    if EXPLICIT and dt < longest < math.inf:
        round_off *= (dt / longest) ** 2
    allowed_v = tolerance * largest_v + round_off
    if ESTIMATES == 0 or tolerance == 0.0:
        return 0.0 * size  # not a number if something overflowed
    if not (allowed_x > 0.0 and allowed_v > 0.0):
        return 0.0 * size
    scale_x = dt * dt / allowed_x
    scale_v = dt / allowed_v
    wrong = scale_x * scale_x * wrong_x + scale_v * scale_v * wrong_v
    if ESTIMATES == 1:
        return math.sqrt(wrong)
    also = scale_x * scale_x * also_x + scale_v * scale_v * also_v
    return wrong / math.sqrt(wrong + 0.01 * also) if wrong > 0.0 else 0.0 * also


def narrow(search, h, gap):
    """One look at the end of a step for an event, by the Illinois method; returns the length to try next.

    search: the state of the search – (near, far) with the event between them (far 0: none seen), the gaps
    there, which of them was moved last, and `ENDED` once the event is at the end of the step. A step that no
    rod leaves its branch in, or that ends where one does, is returned as it is.
    """
    if gap < -EVENT_FLOOR:
        if search[MOVED] < 0.0:
            search[NEAR_GAP] *= 0.5
        search[FAR] = h
        search[FAR_GAP] = gap
        search[MOVED] = -1.0
    elif search[FAR] == 0.0 or gap <= EVENT_FLOOR:
        search[ENDED] = 1.0
        return h
    else:
        if search[MOVED] > 0.0:
            search[FAR_GAP] *= 0.5
        search[NEAR] = h
        search[NEAR_GAP] = gap
        search[MOVED] = 1.0
    width = search[FAR] - search[NEAR]
    if width <= EVENT_WIDTH * search[LENGTH]:
        search[ENDED] = 1.0
        return search[FAR] if search[NEAR] > 0.0 else search[LENGTH]
    share = search[NEAR_GAP] / (search[NEAR_GAP] - search[FAR_GAP])
    return search[NEAR] + width * min(max(share, 0.02), 0.98)


def begin_search(search, length, gap):
    """Look for events anew in a step of this length from a state with this gap."""
    search[NEAR] = 0.0
    search[FAR] = 0.0
    search[NEAR_GAP] = max(gap, 0.0)
    search[MOVED] = 0.0
    search[ENDED] = 0.0
    search[LENGTH] = length


def attempt(
    time,
    end,
    tolerance,
    smallest,
    control,
    search,
    displacement,
    velocity,
    force,
    resisting,
    direction,
    work,
    rod_work,
    marks,
    power,
    gained,
    stage_power,
    *columns,
):
    """Find a step from `time` that meets the tolerance and passes no event.

    Returns (its length, 0 if there is none; the time it ends at; its error; whether a longer one was
    rejected). Its result is in the trial rows of `work`. A jump of the forces that no break or margin told of
    is crossed by a step of about the `smallest` length, whatever its error.
    """
    h = end - time
    gap = 0.0
    rejected = False
    if EVENTS:
        gap = mark(h, displacement, velocity, marks, *columns)
        begin_search(search, h, gap)
    while h >= smallest:
        ahead = end
        if h < end - time:
            ahead = time + h
            h = ahead - time
        for k in range(gained.shape[0]):
            gained[k] = RESULT_V[0, 0] * power[k]
        allowed = (tolerance if tolerance > 0.0 else FIXED_TOLERANCE) * control[LARGEST_V]
        solved = stages(
            time,
            h,
            allowed,
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
        )
        error = combine(h, tolerance, displacement, velocity, work, control, search)
        if not solved or not error < math.inf:
            error = BEYOND
        elif EVENTS and search[ENDED] == 0.0:
            first = search[FAR] == 0.0
            wanted = narrow(search, h, passed(h, work[STAGES], work[STAGES + 1], marks, first, *columns))
            if wanted < smallest:  # the event is where the step begins
                search[ENDED] = 1.0
                wanted = search[LENGTH]
            if wanted != h:
                h = wanted
                continue
        if error <= 1.0 or (error < BEYOND and h * SHORTEN < smallest):
            return h, ahead, error, rejected
        h *= max(SHORTEN, 0.9 * error ** (-EXPONENT))
        rejected = True
        if EVENTS:
            begin_search(search, h, gap)
    return 0.0, time, 0.0, True


def controlled(
    steps,
    first,
    origin,
    tolerance,
    limit,
    breaks,
    until,
    landing,
    control,
    search,
    displacement,
    velocity,
    force,
    resisting,
    direction,
    work,
    rod_work,
    marks,
    power,
    gained,
    stage_power,
    account,
    *columns,
):
    """Take up to `steps` steps that end by `until` (s); returns (steps taken, whether it can go on).

    tolerance: relative, of one step; 0: all steps are control[STEP] long. breaks: times that no step passes,
    ascending, the last one infinite; nor does one pass `landing` (s), where all steps begin anew. A fixed step
    that is interrupted goes on to its end in pieces.
    """
    time = control[TIME]
    search[LONGEST] = limit
    taken = 0
    coming = 0
    while taken < steps:
        step = control[STEP]
        goal, reach = aim(time, step, origin, first + taken, tolerance)
        while breaks[coming] <= time:
            coming += 1
        stop = breaks[coming]
        if time < landing < stop:
            stop = landing
        end = stop if reach >= stop else goal
        if end > until:
            break
        h, ahead, error, rejected = attempt(
            time,
            end,
            tolerance,
            max(SMALLEST_SHARE * min(step, end - time), np.nextafter(time, math.inf) - time),
            control,
            search,
            displacement,
            velocity,
            force,
            resisting,
            direction,
            work,
            rod_work,
            marks,
            power,
            gained,
            stage_power,
            *columns,
        )
        if h == 0.0:
            control[TIME] = time
            return taken, False
        time = ahead
        for i in range(displacement.shape[0]):
            for d in range(2):
                displacement[i, d] = work[STAGES, i, d]
                velocity[i, d] = work[STAGES + 1, i, d]
        if POWERS or LOADS:
            for k in range(gained.shape[0]):
                account[k] += 1000.0 * h * gained[k]
        if COMMITS:
            remember(time, h, displacement, account, *columns)
        evaluate(time, h, displacement, velocity, force, resisting, direction, power, *columns)
        accelerate(force, resisting, work[0], *columns)
        control[LARGEST_X] = search[TRIAL_X]
        control[LARGEST_V] = search[TRIAL_V]
        if tolerance > 0.0:
            taken += 1
            follow(control, h, limit, error, rejected)
        elif time >= goal or time == landing:
            taken += 1
    control[TIME] = time
    return taken, True


def aim(time, step, origin, age, tolerance):
    """When a step would end, and up to when a break would end it instead: none is left just behind a step."""
    if tolerance > 0.0:
        goal = time + step
        return goal, goal + 0.01 * step
    goal = origin + (age + 1) * step
    return goal, goal


def follow(control, h, limit, error, rejected):
    """Choose the next step: a PI controller (Hairer, Nørsett and Wanner, IV.2 of volume II)."""
    step = control[STEP]
    factor = LENGTHEN
    if error > 0.0:
        wanted = (
            0.9 * error ** (0.2 * PROPORTIONAL - EXPONENT) * max(control[ERROR], LEAST_ERROR) ** PROPORTIONAL
        )
        factor = min(max(wanted, SHORTEN), LENGTHEN)
    if rejected:
        control[STEP] = min(h * min(factor, 1.0), limit)
    else:
        control[STEP] = min(max(h * factor, step if h < step else 0.0), limit)
    control[ERROR] = max(error, LEAST_ERROR)


def advance(
    steps,
    fresh,
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
    search,
    displacement,
    velocity,
    force,
    resisting,
    direction,
    work,
    rod_work,
    marks,
    power,
    gained,
    stage_power,
    account,
    measures,
    *columns,
):
    """Take up to `steps` steps that end by `until` (s); returns (steps taken, StopReason).

    fresh: the forces are still those of the present state. total: all steps so far. first: steps since the
    time origin, which moves with every step whose size is controlled. Checks happen after 1, 2, 4, … steps in
    all, and whenever the total is a multiple of CHECK_INTERVAL: at counts that do not depend on how the steps
    are divided into calls.
    """
    if not fresh:
        evaluate(
            control[TIME], control[STEP], displacement, velocity, force, resisting, direction, power, *columns
        )
        accelerate(force, resisting, work[0], *columns)
    taken = 0
    while taken < steps:
        wanted = min(steps - taken, steps_to_check(total + taken, total + taken))
        done, good = integrate(
            wanted,
            first + taken,
            origin,
            tolerance,
            limit,
            breaks,
            until,
            landing,
            control,
            search,
            displacement,
            velocity,
            force,
            resisting,
            direction,
            work,
            rod_work,
            marks,
            power,
            gained,
            stage_power,
            account,
            *columns,
        )
        taken += done
        if not good:
            return taken, 4
        now = total + taken
        if done > 0 and is_check_due(now, now):
            measure(displacement, velocity, force, resisting, measures, *columns)
            reason = judge(measures, account, control[STEP], SHADOW, 0.0, control[TIME] >= loads_end)
            if reason != 0:
                return taken, reason
        if done > 0 and now % REVIEW_INTERVAL == 0:
            return taken, 1
        if done < wanted:
            break
    return taken, 0
