"""The loop of drivers with fixed steps for many variants side by side, as source; see side_by_side.py.

Each lane has steps of its own size. All take as many at once as none is checked, or interrupted, before.
"""

from systems.physics.side_by_side import look, put_back, set_aside

# ruff: noqa: F821
# mypy: ignore-errors

VARYING = {
    "external": ("time", "dt"),
    "forces": ("time", "dt"),
    "accept": ("time", "dt"),
    "resist": ("time", "dt"),
    "load_power": ("time",),
    "push": ("dt",),
    "measure": (),
    "integrate": ("first", "origin", "dt"),
}
AS_THEY_ARE = ("is_check_due", "steps_to_check")


def plan(going, plain, coming, steps, total, first, origin, dt, breaks, taken, time):
    """Which lanes have steps before them that no load interrupts; returns how many all of these may take."""
    count = CHECK_INTERVAL
    for lane in range(LANES):
        age = first[lane] + taken[lane]
        while breaks[coming[lane]] <= time[lane]:
            coming[lane] += 1
        stop = breaks[coming[lane]]
        plain[lane] = going[lane] and not stop < origin[lane] + (age + 1) * dt[lane]
        if plain[lane]:
            count = min(count, steps[lane] - taken[lane], steps_to_check(total[lane] + taken[lane], age))
            while count > 1 and origin[lane] + (age + count) * dt[lane] > stop:
                count //= 2
    return count


def advance(
    going,
    steps,
    total,
    first,
    origin,
    dt,
    breaks,
    loads_end,
    displacement,
    velocity,
    account,
    measures,
    force,
    resisting,
    direction,
    predicted,
    power,
    gained,
    spare,
    numbers,
    plain,
    coming,
    taken,
    reason,
    *everything,
):
    """Let the lanes that are going take up to so many steps each, as advance() of fixed_steps.py does.

    Returns when hardly half of them go on: the others may then be computed with more of their kind.
    """
    time, ahead, begun = numbers[0], numbers[1], numbers[2]
    few = going.sum() // 2
    while True:
        for lane in range(LANES):
            begun[lane] = first[lane] + taken[lane]
            time[lane] = origin[lane] + begun[lane] * dt[lane]
        forces(time, dt, displacement, velocity, force, resisting, direction, *columns, spare)
        if POWERS:
            resist(time, dt, displacement, velocity, resisting, direction, power, *columns, spare)
        if LOADS:
            push(dt, velocity, force, resisting, predicted, *columns, spare)
            load_power(time, predicted, *columns, spare, ahead)
            for lane in range(LANES):
                ahead[lane] = 1000.0 * dt[lane] * abs(ahead[lane])
        look(
            going,
            plain,
            steps,
            total,
            first,
            taken,
            reason,
            loads_end,
            time,
            dt,
            ahead,
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
        count = plan(going, plain, coming, steps, total, first, origin, dt, breaks, taken, time)
        set_aside(plain, *single)
        integrate(
            count,
            begun,
            origin,
            dt,
            displacement,
            velocity,
            force,
            resisting,
            direction,
            predicted,
            power,
            gained,
            account,
            *columns,
            spare,
        )
        put_back(plain, *single)
        for lane in range(LANES):
            if plain[lane]:
                taken[lane] += count
            elif going[lane]:
                done, reason[lane] = alone(lane, total, first, origin, dt, breaks, loads_end, taken, *single)
                taken[lane] += done
                going[lane] = done > 0 and reason[lane] == 0 and taken[lane] < steps[lane]
