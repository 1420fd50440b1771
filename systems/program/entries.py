"""Entries: names for the places in the small arrays that compiled functions and Python share.

    measures[Measure.KINETIC] = 0.5 * kinetic

numba compiles a member of these enumerations to its number, at no cost.
"""

from __future__ import annotations

from enum import IntEnum


class Account(IntEnum):
    """The energy account of a run (J): columns of the clock, in this order. `force_scale` is in kN."""

    WORK = 0  # of loads and edits
    DISSIPATED_DAMPING = 1
    DISSIPATED_PLASTIC = 2
    DISSIPATED_IMPACT = 3
    INITIAL_ENERGY = 4
    POTENTIAL_REFERENCE = 5  # the potential from which the work of constant forces counts
    FORCE_SCALE = 6  # the largest force ever
    ENERGY_SCALE = 7  # the most energy ever supplied
    GUARD_ENERGY = 8  # the conserved energy that the check for divergence compares with
    LARGEST_IMBALANCE = 9  # what the steps lost (positive) or created at most


SMALLEST_ENERGY = 1e-24  # J, below which the account tells nothing from round-off
ACCOUNT = tuple(entry.name.lower() for entry in Account)  # columns of the clock
ACCOUNTS = ACCOUNT[: Account.DISSIPATED_IMPACT + 1]  # those that laws and commits choose among


class Measure(IntEnum):
    """Sums and largest values over an observed state.

    A program that moves a part of a model finds those of the other part, which is asleep, in the second half,
    and includes them in the first.
    """

    KINETIC = 0  # energy (J)
    POWER_NORM = 1  # fᵀM⁻¹f (J/s²), f the force on each particle
    ELASTIC = 2  # energy (J)
    POTENTIAL = 3  # Σ constant force × displacement (J)
    RESIDUAL = 4  # largest unbalanced force on a free particle, dampers and drag apart (kN)
    LARGEST_FORCE = 5  # constant, or in a rod (kN)
    ROUND_OFF = 6  # of the forces in rods (kN)
    POWER = 7  # Σ force · velocity (W)
    ASLEEP_KINETIC = 8
    ASLEEP_POWER_NORM = 9
    ASLEEP_ELASTIC = 10
    ASLEEP_POTENTIAL = 11
    ASLEEP_RESIDUAL = 12
    ASLEEP_LARGEST_FORCE = 13
    ASLEEP_ROUND_OFF = 14
    ASLEEP_POWER = 15


MEASURED = slice(Measure.KINETIC, Measure.POWER + 1)  # of a whole model
ASLEEP = slice(Measure.ASLEEP_KINETIC, Measure.ASLEEP_POWER + 1)  # of the part that a program does not move


class Control(IntEnum):
    """The clock's columns that steer the steps, in this order."""

    TIME = 0  # s
    STEP_SIZE = 1  # s; of the step to try next
    STEP_ERROR = 2  # of the last step; 1 is the tolerance
    LARGEST_DISPLACEMENT = 3  # Euclidean norm over all particles, so far (m)
    LARGEST_SPEED = 4  # the same of velocities (m/s)
    LARGEST_ROTATION = 5  # of rotations, the third coordinates (m)
    LARGEST_SPIN = 6  # of angular velocities (m/s)


CONTROL = tuple(entry.name.lower() for entry in Control)


class Search(IntEnum):
    """The search for one step that meets the tolerance and ends where a rod leaves its branch.

    The event lies between the lengths NEAR and FAR of the step, which have margins of different sign.
    """

    NEAR = 0  # s
    FAR = 1  # s; 0: no event was seen yet
    NEAR_MARGIN = 2
    FAR_MARGIN = 3
    MOVED = 4  # how often NEAR was moved last, FAR if negative
    ENDED = 5  # 1 once the event is at the end of the step, or there is none
    LENGTH = 6  # s; of the step that is searched
    LARGEST_DISPLACEMENT = 7  # as in Control, if the step is accepted
    LARGEST_SPEED = 8
    LARGEST_ROTATION = 9
    LARGEST_SPIN = 10
    LIMIT = 11  # s; the longest step allowed


class Side(IntEnum):
    """Whether the quantity of an Event is positive or negative in a row, and whether it changed in the last step."""

    POSITIVE = 0
    NEGATIVE = 1
    FELL = 2  # to negative, which nobody was told yet
    ROSE = 3


class Mark(IntEnum):
    """What is noted of a rod for one law with branches, as a step begins; so many columns for each such law."""

    BRANCH = 0  # the branch of the law that it is on
    MARGIN = 1  # from leaving it
    SLOPE = 2  # rate of the margin (1/s)
    WATCHED = 3  # 1 if the margin falls and rises within the step, so that its least value counts
