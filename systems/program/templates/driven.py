"""Steps among particles that may meet: between them, and before each is taken for good, `collide` is asked what to do.

`collide` is compiled once for all programs (systems/collision/driven/kernels/steps.py); `driven` holds its arrays. So is
`list_pairs` (neighbours.py there), with those of `listing`: apart, as each array costs time in every call of `collide`.
Their rows are those of the model. rows: the model's row of each particle of the program; empty if they are the
same, or if the program holds no particles (all are asleep).
place, speed: of the model's particles, other arrays than displacement and velocity only where there are `rows`.
*kept: copies of what a step that is taken back had changed. Contact forces (`support`, kN) last during a step and are
added last of all (`unpushed` is the sum without them), so that others can be tried without evaluating the rest again.
"""

# ruff: noqa: F821
# mypy: ignore-errors


def push():
    """Add the contact forces to all others."""
    for i in range(displacement.shape[0]):
        for d in range(D):
            unpushed[i, d] = force[i, d]
            force[i, d] += support[i, d]


def drive(
    collide,
    list_pairs,
    driven,
    listing,
    rows,
    place,
    speed,
    tolerance,
    limit,
    breaks,
    loads_end,
    control,
    state,
    scratch,
    account,
    measures,
    kept,
    *columns,
):
    """Take steps as `driven` says, alone, or as `collide` says in between."""
    whole = driven.whole
    real = driven.real
    alone = whole[Whole.ALONE] == 1
    coming = 0
    holds_all = rows.shape[0] < displacement.shape[0]
    acceleration = driven.acceleration if holds_all else own_acceleration
    pressing = driven.support if holds_all else own_support
    order = Order.TAKE.value
    if not alone:
        order = collide(driven, control, account, place, speed)
    while True:
        while order == Order.LIST.value:
            order = list_pairs(driven, listing, control, place, speed)
            if order == Order.GO_ON.value:
                order = collide(driven, control, account, place, speed)
        for i in range(rows.shape[0]):
            for d in range(2):
                displacement[i, d] = place[rows[i], d]
                velocity[i, d] = speed[rows[i], d]
        if whole[Whole.BACK] == 1:
            insert(put_back)
            whole[Whole.BACK] = 0
        if order == Order.LEAVE.value:
            return
        if order == Order.EVALUATE.value:
            if whole[Whole.FRESH] == 0:
                insert(present)
                whole[Whole.FRESH] = 1
            while breaks[coming] <= control[Control.TIME]:
                coming += 1
            real[Real.BREAK] = breaks[coming]
            few = holds_all and whole[Whole.NEAR] > 0
            near = driven.near if few else every
            for p in range(whole[Whole.NEAR] if few else every.shape[0]):
                i = near[p]
                for d in range(2):
                    total = unpushed[i, d] + resisting[i, d] if RATES else unpushed[i, d]
                    acceleration[i, d] = total * particles_mobility[i, d]
            for i in range(rows.shape[0]):
                for d in range(2):
                    driven.acceleration[rows[i], d] = acceleration[i, d]
        else:
            if whole[Whole.KEEP] == 1:
                insert(keep)
                whole[Whole.KEEP] = 0
            if not alone and whole[Whole.PUSHED] == 1:
                for i in range(rows.shape[0]):
                    for d in range(2):
                        pressing[i, d] = driven.support[rows[i], d]
                for i in range(displacement.shape[0]):
                    for d in range(2):
                        support[i, d] = pressing[i, d]
                    for d in range(D):
                        force[i, d] = unpushed[i, d] + support[i, d]
                if not ALIKE:
                    accelerate(force, resisting, work[0], particles_mobility)
                whole[Whole.PUSHED] = whole[Whole.CHOSEN] > 0
            insert(take)
            whole[Whole.FRESH] = 1
            if alone:
                return
        for i in range(rows.shape[0]):
            for d in range(2):
                place[rows[i], d] = displacement[i, d]
                speed[rows[i], d] = velocity[i, d]
        order = collide(driven, control, account, place, speed)


def take():
    """Take whole steps, or one to Real.END: in parts, where the error asks for that, and counted once all the same.

    One of too many parts is given up, soon if it only shows a moment: where round-off makes event after event, each ends the
    next part as soon as it begins, and there may be more of them than anybody waits for.
    How old a run of fixed steps is, by which it is checked, stays the same: impacts do not make it a new one.
    """
    end = real[Real.END]
    until = real[Real.UNTIL] if alone else (real[Real.BY] if end == math.inf else end)
    most = MOST_PARTS if whole[Whole.LANDING] else REVIEW_INTERVAL
    wanted = whole[Whole.WANTED] if alone else (whole[Whole.STEPS] if end == math.inf else most)
    longest = limit if whole[Whole.CHOSEN] == 0 else min(limit, real[Real.HELD_LIMIT])
    ended = StopReason.DONE.value
    before = whole[Whole.TOTAL]
    while True:
        total = whole[Whole.TOTAL]
        began = control[Control.TIME]
        taken, ended = advance(
            wanted,
            whole[Whole.FRESH] == 1,
            total,
            total - whole[Whole.SINCE],
            real[Real.ORIGIN],
            tolerance,
            longest,
            breaks,
            until,
            end,
            loads_end,
            control,
            *state,
            *scratch,
            account,
            measures,
            *columns,
        )
        whole[Whole.FRESH] = 1
        whole[Whole.TOTAL] = total + taken
        now = control[Control.TIME]
        if (taken > 0 or now > began) and (tolerance > 0.0 or now == end):
            age = 0 if tolerance > 0.0 else min(total + taken - whole[Whole.SINCE], CHECK_INTERVAL)
            real[Real.ORIGIN] = now - age * control[Control.STEP_SIZE]
            whole[Whole.SINCE] = total + taken - age
        goes_on = ended == StopReason.DONE or ended == StopReason.REVIEW or ended == StopReason.REST
        if alone or end == math.inf or now >= end or not goes_on:
            break
        if whole[Whole.TOTAL] - before >= most:
            ended = StopReason.UNRESOLVED.value
            break
    if not alone and end < math.inf:
        further = max(whole[Whole.TOTAL] - before - 1, 0)
        whole[Whole.TOTAL] -= further
        whole[Whole.SINCE] -= further
    whole[Whole.REASON] = ended
