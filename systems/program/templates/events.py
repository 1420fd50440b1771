"""Events: where a rod leaves the branch of a law that is not smooth, and where the quantity of an Event changes sign.

Integrators that control their steps end one there. For every such law, and every Event, the writer pastes `note` or
`look` into a loop over the rods or particles, and `turn` for every Event into one at the end of each step.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def mark(dt, displacement, velocity, marks, *columns):
    """Note for every rod which branch of its law it is on; returns how far the nearest is from leaving."""
    low = math.inf
    insert(rods)
    insert(particles)
    return low


def passed(dt, displacement, velocity, marks, first, *columns):
    """How far the nearest rod is from leaving its branch at the end of a step; negative: it has left.

    first: this is the first look at the step, which chooses the rods whose least margins are watched.
    """
    low = math.inf
    between = math.inf
    insert(rods)
    insert(particles)
    return low if low < math.inf else between


def note():
    """As a step begins."""
    branch = insert(branch)
    marks[r, insert(law) + Mark.BRANCH] = branch
    insert(margin_and_slope)
    marks[r, insert(law) + Mark.MARGIN] = gap
    marks[r, insert(law) + Mark.SLOPE] = slope
    marks[r, insert(law) + Mark.WATCHED] = 0.0
    low = min(low, gap)


def look():
    """As a step ends. A rod that has come back is found by the least margin that it had on the way.

    One that stays where its branches meet, as a cable between held particles does, hides no other.
    """
    branch = marks[r, insert(law) + Mark.BRANCH]
    insert(margin_and_slope)
    still = abs(gap) <= EVENT_FLOOR and abs(marks[r, insert(law) + Mark.MARGIN]) <= EVENT_FLOOR
    before = marks[r, insert(law) + Mark.SLOPE]
    if first and gap > 0.0 and before * dt < -insert(steady) and slope > 0.0:
        start = marks[r, insert(law) + Mark.MARGIN]
        least = lowest(start, before, gap, slope, dt)
        if least < min(start, gap) - least:
            marks[r, insert(law) + Mark.WATCHED] = 1.0
    if marks[r, insert(law) + Mark.WATCHED] > 0.0:
        gap = min(gap, -slope * dt)
    if still:
        between = min(between, gap)
    else:
        low = min(low, gap)


def of_rod():
    """gap: the margin of a rod, or its quantity on the side that it is on; slope: its rate, by a small part of the step."""
    insert(axial_force)
    gap = insert(margin)
    here = elongation
    elongation = here + rate * (insert(ahead) * dt)
    insert(axial_force)
    slope = (insert(margin) - gap) / (insert(ahead) * dt)
    elongation = here


def of_ends():
    """The same for the ends of a rod, from what rods.slip_rates tells."""
    gap = insert(margin)
    moment_start = soon_moment_start
    moment_end = soon_moment_end
    thrust = soon_thrust
    gain_start = then_start
    gain_end = then_end
    slope = (insert(margin) - gap) / small


def of_particle():
    """The same for a particle, at its displacement (x, y)."""
    x = displacement[r, 0]
    y = displacement[r, 1]
    gap = insert(margin)
    x += velocity[r, 0] * (insert(ahead) * dt)
    y += velocity[r, 1] * (insert(ahead) * dt)
    slope = (insert(margin) - gap) / (insert(ahead) * dt)


def happened(displacement, velocity, scratch, *columns):
    """True if the quantity of an Event changed sign in the step that ends here, of which the sides take note.

    A controlled step ends within EVENT_FLOOR of the change: a quantity that close counts as changed if it came from afar.
    """
    changed = False
    insert(rods)
    insert(particles)
    return changed


def turn():
    """As a step ends."""
    side = insert(sides)[r]
    gap = -insert(quantity) if side == Side.NEGATIVE else insert(quantity)
    if insert(turned):
        insert(sides)[r] = Side.ROSE if side == Side.NEGATIVE else Side.FELL
        changed = True
