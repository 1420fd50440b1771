"""What the loops of drivers for many variants side by side share, as source.

Each lane takes the steps that the program of a single run would have it take, in the same order of operations.
Steps that nothing interrupts are taken by all lanes at once. Whichever lane has stopped, or has another step
before it, is kept, computed with the others all the same, and restored; such a step it takes alone, by the
program of a single run.
Written like fixed_steps.py, which says what `*columns` is; arrays have the lanes as their last axis, and what the
program provides there is there for lanes, with an array `spare` to write to, and one for a result. Besides, it
provides

    keep(lane, *single)
    restore(lane, *single)
        put aside what steps change of a lane; put it back
    alone(lane, …, *single)
        lets one of the lanes take a step by the program of a single run; returns (steps taken, StopReason)

and LANES. `*single` stands for what these take, `*everything` for the columns and that.
Each loop says which functions it needs for lanes, those that others call first, with the parameters that are numbers
of their own in each lane (VARYING), and which as they are.
"""

# ruff: noqa: F821
# mypy: ignore-errors


def look(
    going,
    plain,
    steps,
    total,
    age,
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
):
    """After steps: which of the lanes that took them (`plain`) stop, and why; `age` as they began."""
    due = False
    for lane in range(LANES):
        due = due or (plain[lane] and is_check_due(total[lane] + taken[lane], age[lane] + taken[lane]))
    if due:
        measure(displacement, velocity, force, resisting, measures, *columns, spare)
    for lane in range(LANES):
        if plain[lane]:
            now = total[lane] + taken[lane]
            if is_check_due(now, age[lane] + taken[lane]):
                over = time[lane] >= loads_end
                reason[lane] = judge(measures[:, lane], account[:, lane], dt[lane], SHADOW, ahead[lane], over)
            if reason[lane] == 0 and now % REVIEW_INTERVAL == 0:
                reason[lane] = 1
            going[lane] = reason[lane] == 0 and taken[lane] < steps[lane]


def set_aside(plain, *single):
    """Keep the lanes that do not take part in what all do next."""
    for lane in range(LANES):
        if not plain[lane]:
            keep(lane, *single)


def put_back(plain, *single):
    """Restore them."""
    for lane in range(LANES):
        if not plain[lane]:
            restore(lane, *single)
