"""Factors of load histories: factor(time, values, first), `values[first:]` being its parameters."""

from systems.kernels import compiled


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
