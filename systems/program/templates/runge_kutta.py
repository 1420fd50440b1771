"""Runge–Kutta integrators: one step with error control and events for every tableau.

Constants besides those of every template: the tableau's, STAGES, NODES, … (systems/physics/tableaus.py), and the loop's
(systems/physics/integrators.py). `work` has rows of shape (particles, D): the accelerations of the stages, the
displacement and velocity at a stage and then of the result, and what implicit stages need. `marks` has a row for
each rod. The function that computes the stages is called `stages` in the program.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def explicit_stages(time, dt, allowed, state, scratch, *columns):
    """Accelerations of the stages after the first; returns True: they can always be computed."""
    trial, speed = work[STAGES], work[STAGES + 1]
    for s in range(1, STAGES):
        extrapolate(s, dt, displacement, velocity, work, trial, speed)
        at = time + NODES[s] * dt
        evaluate(at, dt, trial, speed, *forces, stage_power, *columns)
        accelerate(force, resisting, work[s], particles_mobility)
        if POWERS or LOADS:
            for k in range(gained.shape[0]):
                gained[k] += RESULT_V[0, s] * stage_power[k]
    return True


def extrapolate(s, dt, displacement, velocity, work, trial, speed):
    """trial, speed ← displacement and velocity at stage `s`, from the accelerations of the stages before it."""
    for i in range(displacement.shape[0]):
        for d in range(D):
            p = 0.0
            q = 0.0
            for j in range(s):
                p += STAGE_V[s, j] * work[j, i, d]
                q += STAGE_X[s, j] * work[j, i, d]
            v = velocity[i, d]
            speed[i, d] = v + dt * p
            trial[i, d] = displacement[i, d] + dt * (NODES[s] * v + dt * q)


def accelerate(force, resisting, acceleration, particles_mobility):
    """acceleration ← that of the particles under the forces of a state (m/s²)."""
    for i in range(force.shape[0]):
        for d in range(D):
            total = force[i, d] + resisting[i, d] if RATES else force[i, d]
            acceleration[i, d] = total * particles_mobility[i, d]


def combine(kind, dt, tolerance, displacement, velocity, work, control, search):
    """The result of a step, left in the trial rows of `work`; returns its error: 1 is the tolerance, 0 without control.

    kind: 0 for what moves, 1 for what turns: the error of a step is the larger of the two.

    The norms are Euclidean over all particles, of displacement and velocity each relative to the largest so
    far: an integrator that controlled each component relative to itself would chase the round-off of particles
    that stand still. Those of rotations count from a share of what displacements amount to. Round-off of displacements x
    causes one of accelerations ω²x: in steps shorter than the longest stable one, some 6/ω, the velocities have less of
    it. Short steps can therefore cross a force that jumps, such as the damper of a cable.
    """
    trial, speed = work[STAGES], work[STAGES + 1]
    size_x = 0.0
    size_v = 0.0
    wrong_x = 0.0
    wrong_v = 0.0
    also_x = 0.0
    also_v = 0.0
    for i in range(displacement.shape[0]):
        for d in range(2 * kind, 2 + kind):
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
    largest_x = max(control[Control.LARGEST_DISPLACEMENT + 2 * kind], math.sqrt(size_x))
    largest_v = max(control[Control.LARGEST_SPEED + 2 * kind], math.sqrt(size_v))
    if kind > 0:
        largest_x = max(largest_x, LEAST_TURN * search[Search.LARGEST_DISPLACEMENT])
        largest_v = max(largest_v, LEAST_TURN * search[Search.LARGEST_SPEED])
    search[Search.LARGEST_DISPLACEMENT + 2 * kind] = largest_x
    search[Search.LARGEST_SPEED + 2 * kind] = largest_v
    size = size_x + size_v
    return error_of(
        dt, tolerance, search[Search.LIMIT], largest_x, largest_v, size, wrong_x, wrong_v, also_x, also_v
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
    if not (allowed_x > 0.0 or allowed_v > 0.0):
        return 0.0 * size
    scale_x = dt * dt / allowed_x if allowed_x > 0.0 else 0.0  # a push may have set off what has not moved yet
    scale_v = dt / allowed_v if allowed_v > 0.0 else 0.0
    wrong = scale_x * scale_x * wrong_x + scale_v * scale_v * wrong_v
    if ESTIMATES == 1:
        return math.sqrt(wrong)
    also = scale_x * scale_x * also_x + scale_v * scale_v * also_v
    return wrong / math.sqrt(wrong + 0.01 * also) if wrong > 0.0 else 0.0 * also


def narrow(search, h, gap):
    """Look for an event at the end of a step of length h, by the Illinois method; returns the length to try next.

    gap: the margin there. A step in which no rod leaves its branch, or which ends where one does, is returned as
    it is.
    """
    if gap < -EVENT_FLOOR:
        if search[Search.MOVED] < 0.0:
            search[Search.NEAR_MARGIN] *= 0.5
        search[Search.FAR] = h
        search[Search.FAR_MARGIN] = gap
        search[Search.MOVED] = min(search[Search.MOVED], 0.0) - 1.0
    elif search[Search.FAR] == 0.0 or gap <= EVENT_FLOOR:
        search[Search.ENDED] = 1.0
        return h
    else:
        if search[Search.MOVED] > 0.0:
            search[Search.FAR_MARGIN] *= 0.5
        search[Search.NEAR] = h
        search[Search.NEAR_MARGIN] = gap
        search[Search.MOVED] = max(search[Search.MOVED], 0.0) + 1.0
    width = search[Search.FAR] - search[Search.NEAR]
    if width <= EVENT_WIDTH * search[Search.LENGTH]:
        search[Search.ENDED] = 1.0
        return search[Search.FAR] if search[Search.NEAR] > 0.0 else search[Search.LENGTH]
    share = search[Search.NEAR_MARGIN] / (search[Search.NEAR_MARGIN] - search[Search.FAR_MARGIN])
    if abs(search[Search.MOVED]) >= EVENT_PATIENCE:  # margins of hardly more than rounding show no way: halve
        share = 0.5
    return search[Search.NEAR] + width * min(max(share, 0.02), 0.98)


def begin_search(search, length, gap):
    """Begin to look for events in a step of this length from a state with this margin."""
    search[Search.NEAR] = 0.0
    search[Search.FAR] = 0.0
    search[Search.NEAR_MARGIN] = max(gap, 0.0)
    search[Search.MOVED] = 0.0
    search[Search.ENDED] = 0.0
    search[Search.LENGTH] = length


def attempt(time, end, tolerance, smallest, control, state, scratch, *columns):
    """Find a step from `time` that meets the tolerance and passes no event.

    Returns (its length, 0 if there is none; the time it ends at; its error; whether a longer one was
    rejected). Its result is in the trial rows of `work`. A jump of the forces that neither a break nor a margin
    announces is crossed by a step of about the `smallest` length, whatever its error.
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
        fastest = max(control[Control.LARGEST_SPEED], control[Control.LARGEST_SPIN])
        allowed = (tolerance if tolerance > 0.0 else FIXED_TOLERANCE) * fastest
        solved = stages(time, h, allowed, *state, *scratch, *columns)
        error = 0.0
        for kind in range(D - 1):
            found = combine(kind, h, tolerance, displacement, velocity, work, control, search)
            if error >= 0.0 and not error >= found:  # also where it is not a number
                error = found
        if not solved or not error < math.inf:
            error = BEYOND
        elif EVENTS and search[Search.ENDED] == 0.0:
            first = search[Search.FAR] == 0.0
            wanted = narrow(search, h, passed(h, work[STAGES], work[STAGES + 1], marks, first, *columns))
            if wanted < smallest:  # the event is where the step begins
                search[Search.ENDED] = 1.0
                wanted = search[Search.LENGTH]
            if search[Search.ENDED] == 0.0:
                place = (time + wanted) - time
                if not search[Search.NEAR] < place < search[Search.FAR]:  # no time lies between the two
                    search[Search.ENDED] = 1.0
                    wanted = search[Search.FAR]
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


def step():
    """A step that meets the tolerance and passes no event."""
    least = max(SMALLEST_SHARE * min(size, end - time), np.nextafter(time, math.inf) - time)
    h, time, error, rejected = attempt(time, end, tolerance, least, control, *state, *scratch, *columns)
    if h == 0.0:
        return taken, StopReason.UNRESOLVED.value
    for i in range(displacement.shape[0]):
        for d in range(D):
            displacement[i, d] = work[STAGES, i, d]
            velocity[i, d] = work[STAGES + 1, i, d]
    if POWERS or LOADS:
        for k in range(gained.shape[0]):
            account[k] += 1000.0 * h * gained[k]
    if COMMITS:
        remember(time, h, displacement, account, *columns)
    evaluate(time, h, *state, power, *columns)
    accelerate(force, resisting, work[0], particles_mobility)
    for k in range(2 * (D - 1)):
        control[Control.LARGEST_DISPLACEMENT + k] = search[Search.LARGEST_DISPLACEMENT + k]
    if tolerance > 0.0:
        follow(control, h, limit, error, rejected)
    counted = total + taken + 1
    compared = control[Control.STEP_SIZE]


def follow(control, h, limit, error, rejected):
    """Choose the next step: a PI controller (Hairer, Nørsett and Wanner, IV.2 of volume II)."""
    step = control[Control.STEP_SIZE]
    factor = LENGTHEN
    if error > 0.0:
        wanted = (
            0.9
            * error ** (0.2 * PROPORTIONAL - EXPONENT)
            * max(control[Control.STEP_ERROR], LEAST_ERROR) ** PROPORTIONAL
        )
        factor = min(max(wanted, SHORTEN), LENGTHEN)
    if error > 1.0:  # a jump was crossed; the forces after it need no shorter steps
        control[Control.STEP_SIZE] = min(h * LENGTHEN, limit)
    elif rejected:
        control[Control.STEP_SIZE] = min(h * min(factor, 1.0), limit)
    else:
        control[Control.STEP_SIZE] = min(max(h * factor, step if h < step else 0.0), limit)
    control[Control.STEP_ERROR] = max(error, LEAST_ERROR)
