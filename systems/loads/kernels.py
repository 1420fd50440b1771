"""Factors of load histories: factor(time, values, first), `values[first:]` being its parameters."""

import math

from pinjoint.systems.program.kernel import compiled


@compiled
def constant(time, values, first):
    """1 at all times."""
    return 1.0


@compiled
def ramp(time, values, first):
    """0 up to `start`, then linearly to 1 over `duration`."""
    start = values[first]
    duration = values[first + 1]
    if time >= start + duration:
        return 1.0
    if time <= start:
        return 0.0
    return (time - start) / duration


@compiled
def sine(time, values, first):
    """sin(2π `frequency` t + `phase`)."""
    return math.sin(2.0 * math.pi * values[first] * time + values[first + 1])


@compiled
def pulse(time, values, first):
    """1 from `start` for a `duration`, else 0."""
    start = values[first]
    return 1.0 if start <= time < start + values[first + 1] else 0.0


@compiled
def interpolated(time, values, first):
    """Linear between the points (times, then values, each list after its length), constant outside."""
    count = int(values[first])
    times, heights = first + 1, first + 2 + count
    if time <= values[times]:
        return values[heights]
    if time >= values[times + count - 1]:
        return values[heights + count - 1]
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if values[times + middle] <= time:
            low = middle
        else:
            high = middle
    share = (time - values[times + low]) / (values[times + high] - values[times + low])
    return values[heights + low] + share * (values[heights + high] - values[heights + low])
