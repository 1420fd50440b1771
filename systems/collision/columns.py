"""The arrays of colliding discs: what each is, and what its columns mean. Kernels are given them in these tuples."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

EPSILON = 2.220446049250313e-16
SPEED_NOISE = 16.0 * EPSILON  # of the speeds that an impact or its contacts deal with: its round-off
NONE = -1

# Columns of `discs`, shape (n, DISC_WIDTH): one row per disc, its path since its epoch t₀, the time of its last
# change. u(t) = u₀ + v₀ (t − t₀) + a (t − t₀)²/2 is the displacement from the original position o. After the discs
# come obstacles: straight pieces that never move, rounded by their radius. Of two rows the later one is the obstacle.
# Those that meetings follow from come first, so that they lie together in memory.
UX, UY = 0, 1  # displacement at the epoch, m
VX, VY = 2, 3  # velocity at the epoch, m/s
AX, AY = 4, 5  # acceleration of the path, m/s²
EPOCH = 6  # s
RADIUS = 7  # m
OX, OY = 8, 9  # original position, m
TX, TY = 10, 11  # m; from the first end of an obstacle, its original position, to the other; 0 of discs
NOISE = 12  # m/s; round-off in its velocity, from the impact or the contacts that gave it
CHANGES = 13  # of its path so far
GX, GY = 14, 15  # acceleration without contact forces, m/s²
WX, WY = 16, 17  # inverse mass in each direction, 1/kg; 0 where the disc is held
STEP = 18  # s; when the forces in its lasting contacts are due again
BOUNCE = 19  # restitution of impacts with it
SHARED = 20  # ends of an obstacle for which another one answers: SHARED_START + SHARED_END, as far as they are
DISC_WIDTH = 21
SHARED_START, SHARED_END = 1.0, 2.0
MOVING = (UX, UY, VX, VY, AX, AY, EPOCH, STEP, NOISE)  # what time changes, as components/paths.py has it


# Kinds of pairs of which forces of others drive one, at the start of a step.
WATCHED, LEFT_ALONE, LASTING = 0, 1, 2
OVERLAP = 1e-9  # of the reach of two nodes; more at the start of a step is from before they ever parted


class Grid(NamedTuple):
    """Boxes around the paths of all discs, and a hash grid of them; see kernels/grid.py.

    boxes: left, bottom, right, top, shape (n, 4), m. layer: of each disc, shape (n,). levels: the cells of
    layer k have the size cell × 2^levels[k], ascending, shape (64,). heads: first entry of each bucket, a power
    of two of them. after: the next entry in the same bucket, shape (capacity,). found: room for the discs that a
    search finds, shape (n + 1,).
    """

    boxes: Floats
    layer: Integers
    levels: Integers
    heads: NDArray[np.int32]
    after: NDArray[np.int32]
    found: Integers


class Queue(NamedTuple):
    """Meetings to come, a binary heap; see kernels/queue.py.

    times: shape (capacity,), s. meetings: shape (capacity, 4): two discs, and how often each had changed its
    path when the meeting was foreseen; it is void once either has changed again.
    """

    times: Floats
    meetings: NDArray[np.int32]


MOST_CHANGES = 2**31 - 1  # that a meeting tells from one another, as a mask


class Ties(NamedTuple):
    """Pairs whose meetings are not foreseen.

    Those of disc i that never collide with it are partners[first[i] : first[i + 1]]. Those in lasting contact
    with it are a chain of entries from first_lasting[i]: lasting, shape (capacity, 2), holds the other disc and
    the next entry, forces the force, N. A lasting contact is entered for each of its discs that is
    not held. Unused entries are chained from counts[SPARE].
    """

    first: Integers
    partners: Integers
    first_lasting: Integers
    lasting: Integers
    forces: Floats


OTHER, NEXT = 0, 1  # columns of lasting


class Group(NamedTuple):
    """Discs ("members" 0, 1, …) that touch now, and the contacts between them, dealt with together.

    members: which disc a member is; place: which member a disc is, or −1; shape (n,) both.
    links: the two members of each contact, shape (c, 2). contacts: shape (c, CONTACT_WIDTH), columns below.
    mobility: inverse mass of each member in each direction, 1/kg, 0 where it is held, shape (n, 2), so that
    N_cᵀ M⁻¹ N_d is the compliance of the contacts under the members' supports.
    motion: what impulses change, shape (n, 2): velocities, m/s, with impulses in N·s; or accelerations, m/s²,
    with forces in N. initial, start, other: notes of other motion.
    noise: rate below which a contact closes by round-off only, shape (1,).
    marks: work space, shape (3, c); rows below. matrix: work space, shape (DIRECT + 1, DIRECT).
    """

    members: Integers
    place: Integers
    links: Integers
    contacts: Floats
    mobility: Floats
    motion: Floats
    initial: Floats
    start: Floats
    other: Floats
    noise: Floats
    marks: Integers
    matrix: Floats


NX, NY = 0, 1  # columns of contacts: unit vector from the first member to the second
DISTANCE = 2  # of their centres, m
OPENING = 3  # compliance of the contact itself, 1/kg
BIAS = 4  # added to the rate at which the contact opens
GIVEN = 5  # impulse of the present projection
IMPULSE = 6  # of the whole impact
FORCE = 7  # that has kept the discs apart since the group's last change, N; 0: none
ROUND = 8  # 1: the normal turns as the discs move around each other; 0: along a flat side it stays
BEFORE = 9  # impulse before a sweep to and fro
DIRECTION = 10  # in which sweeps so far led
CONTACT_WIDTH = 11

ACTIVE, STATE, CHOSEN = 0, 1, 2  # rows of marks: contacts of a projection; how they fare; those fitted now
DIRECT = 48  # contacts up to which a projection is solved directly; more: by sweeps


class Pile(NamedTuple):
    """Discs that take steps, the pairs of them that are near, and the contacts of the present step; see kernels/pile.py.

    motion: of each disc, shape (4, n, 2); travel: likewise, shape (4, n). pairs: two discs each, ascending, shape
    (p, 2); forces: in them in the step before, N, shape (p,). chosen: which pairs are contacts; order: the same, in
    the order in which sweeps go through the contacts; shape (p,) both. ends: the two discs of a contact, one twice
    where the other is held, shape (p, 2). contacts: shape (p, PILE_CONTACT_WIDTH). scale: root of their compliances,
    1/√kg, shape (p,).
    """

    motion: Floats
    travel: Floats
    pairs: Integers
    forces: Floats
    chosen: Integers
    order: Integers
    ends: NDArray[np.uint32]
    contacts: Floats
    scale: Floats


PILE_CONTACT_WIDTH = 8


class Report(NamedTuple):
    """Impacts that nobody has fetched yet.

    pairs: the two discs, shape (capacity, 2). details: time (s), impulse (N·s), energy lost (J) and the point
    of contact (x, y in m), shape (capacity, 5).
    """

    pairs: Integers
    details: Floats


# `numbers`, float64
NOW = 0  # s; everything up to now has happened
END = 1  # s; of the present window, in which all meetings are foreseen
WINDOW = 2  # s; length of a window
CELL = 3  # m; of the finest layer of the grid
CROWDING = 4  # neighbours found per area of boxes, 1/m²
RESTITUTION = 5  # the least of all
REST_HEIGHT = 6  # of the smaller radius; bounces that would rise less end in contact
SMALLEST = 7  # m; radius of the smallest disc
STEP_LENGTH = 8  # s; of the steps of piles, ∞ where nothing is pulled
STEP_END = 9  # s; of the present one
WORK_SINCE = 10  # s; since when WORK is counted
LOSS = 11  # J; energy that impacts and piles have taken so far, the present step of a pile in full
NUMBERS = 12

# `counts`, int64
QUEUED = 0  # meetings in the queue
LAYERS = 1  # of the grid
REPORTED = 2  # impacts in the report
IMPACTS = 3  # so far, every contact of a joint impact counted
EVENTS = 4  # so far: impacts, a joint one counted once, and steps of lasting contact
LEVEL = 5  # coarsest level that a disc needed beyond those of the grid
RENEW = 6  # 1: the window must be opened anew before anything else
SPARE = 7  # first unused entry of the table of lasting contacts
SPARES = 8  # how many are unused
STEPPING = 9  # 1: discs take the steps of a pile
CALM = 10  # steps one after the other in which nothing in the pile moved fast
WORK = 11  # contacts in the events of late
DISCS = 12  # how many there are
PATIENCE = 13  # calm steps after which a pile seeks its equilibrium
LISTED = 14  # pairs in the list of a pile; −1: they must be listed anew
COUNTS = 15
CROWD_COUNTS = (STEPPING, CALM, WORK, PATIENCE)  # what a pile goes on from
CROWD_NUMBERS = (STEP_END, WORK_SINCE, LOSS)


class Reason(IntEnum):
    """Why the flight returned."""

    DONE = 0  # arrived
    BUSY = 1  # as many events as were allowed
    REPORT_FULL = 2  # fetch the reported impacts and go on
    QUEUE_FULL = 3  # enlarge the queue and go on
    GRID_FULL = 4  # enlarge the grid and go on
    GROUP_FULL = 5  # enlarge the room for contacts and lasting contacts and go on
    SETTLE = 6  # put the calm pile into its equilibrium and go on
    GO_ON = 7  # go on with what is due now: a window, steps of a pile, or events
