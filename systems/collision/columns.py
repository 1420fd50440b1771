"""The arrays that the kernels of collisions share: their shapes, and an enumeration of the columns of each.

`discs[i, Disc.VX]` costs the same as `discs[i, 2]`: numba folds members of an IntEnum into constants.
"""

from __future__ import annotations

import sys
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

EPSILON = sys.float_info.epsilon
SPEED_NOISE = 16.0 * EPSILON  # round-off of a speed, as a share of the speeds that it is computed from
NONE = -1  # no entry, no member
MOST_CHANGES = 2**31 - 1  # mask: the part of a disc's number of changes that an impact in the queue keeps
DIRECT = 48  # contacts up to which a projection is solved directly; larger groups are solved by sweeps
SHARED_START, SHARED_END = 1.0, 2.0  # flags of Disc.SHARED
OVERLAP = 1e-9  # of the reach of two nodes; a larger overlap at the start of a step is older than the run


# Steps of crowds; SHORTEST_SHARE also of piles
STEP_SHARE = 0.04  # longest step, as a share of the time in which a disc falls through its diameter
SHORTEST_SHARE = 1.0 / 16.0  # shortest step, where discs are fast, as a share of the longest
# Relative travel of two discs in a longer step than the shortest, at most, in radii of the smaller.
TRAVEL = 0.35


class Disc(IntEnum):
    """Columns of `discs`: one row per disc, its path since its epoch t₀, the time of its last change.

    With s = t − t₀, u(t) = u₀ + v₀ s + a s²/2 is the displacement from the original position o; in a step h of persistent
    contact it is bent by s² (s − h) (b + c s), which takes nothing from its ends. Obstacles follow the discs: straight
    pieces that never move, rounded by their radius. Of a pair, an obstacle is the later row. The columns that time
    changes come first.
    """

    UX, UY = 0, 1  # displacement at the epoch, m
    VX, VY = 2, 3  # velocity at the epoch, m/s
    AX, AY = 4, 5  # acceleration of the path, m/s²
    EPOCH = 6  # s
    STEP = 7  # time at which the forces in its persistent contacts are due again, t₀ + h, s; ∞ if they are not
    NOISE = 8  # round-off in the velocity, from the impact or the contacts that caused it, m/s
    BX, BY = 9, 10  # how the path bends, m/s³
    CX, CY = 11, 12  # and how that changes, m/s⁴
    RADIUS = 13  # m
    OX, OY = 14, 15  # original position, m; of an obstacle, its first end
    TX, TY = 16, 17  # vector from the first end of an obstacle to the other, m; 0 for discs
    CHANGES = 18  # number of changes of the path so far
    GX, GY = 19, 20  # acceleration without contact forces, m/s²
    WX, WY = 21, 22  # inverse mass in each direction, 1/kg; 0 where the disc is held
    BOUNCE = 23  # restitution of impacts with it
    SHARED = 24  # ends of an obstacle that an earlier obstacle accounts for: SHARED_START + SHARED_END


FLIGHT = slice(Disc.UX, Disc.CY + 1)
"""Columns that time changes: those of `FreeFlightState.motion` (components/clock.py)."""


class Grid(NamedTuple):
    """Boxes around the paths of all discs, and a hash grid of the boxes; see kernels/grid.py.

    boxes: left, bottom, right, top, shape (n, 4), m. layer: of each disc, shape (n,). levels: the cells of
    layer k have the size cell × 2^levels[k], ascending, shape (64,); inverse: one by that size, 1/m. heads: first entry
    of each bucket; the number of buckets is a power of two. after, before: the next entry in the same bucket and the one
    before, shape (4 × a power of two,). found: the discs that searches find, shape (2 n + 2,); times: of impacts with
    them, s.
    """

    boxes: Floats
    layer: Integers
    levels: Integers
    inverse: Floats
    heads: NDArray[np.int32]
    after: NDArray[np.int32]
    before: NDArray[np.int32]
    found: Integers
    times: Floats

    @classmethod
    def empty(cls, n: int, layers: int) -> Grid:
        """A grid of n discs with room for so many layers."""
        buckets = 1 << int(np.ceil(np.log2(max(n * layers, 64))))
        entries = 4 << int(np.ceil(np.log2(max(2 * n * layers, 64))))
        return cls(
            boxes=np.zeros((n, 4)),
            layer=np.zeros(n, dtype=np.int64),
            levels=np.zeros(64, dtype=np.int64),
            inverse=np.zeros(64),
            heads=np.full(buckets, NONE, dtype=np.int32),
            after=np.zeros(entries, dtype=np.int32),
            before=np.zeros(entries, dtype=np.int32),
            found=np.zeros(2 * n + 2, dtype=np.int64),
            times=np.zeros(2 * n + 2),
        )


class Queue(NamedTuple):
    """Impacts to come, a binary heap; see kernels/heap.py.

    times: shape (capacity,), s. impacts: shape (capacity, 4): two discs, and how often each had changed its
    path when the impact was computed; the impact is void once either has changed again.
    """

    times: Floats
    impacts: NDArray[np.int32]

    @classmethod
    def empty(cls, size: int) -> Queue:
        """A queue with room for `size` impacts."""
        return cls(np.zeros(size), np.zeros((size, 4), dtype=np.int32))


class Constraints(NamedTuple):
    """Pairs that cannot have an impact: pairs that never collide, and persistent contacts.

    The discs that never collide with disc i are partners[first[i] : first[i + 1]]. The persistent contacts of disc i
    are a chain of entries from first_persistent[i]: persistent, shape (capacity, 2), holds the columns of Entry,
    forces the force, N. A persistent contact is entered for each of its discs that is not held. Unused entries
    are chained from counts[Count.SPARE].
    """

    first: Integers
    partners: Integers
    first_persistent: Integers
    persistent: Integers
    forces: Floats

    @classmethod
    def of(cls, n: int, joined: Any, size: int, counts: Integers) -> Constraints:
        """Constraints of n discs: these pairs never collide, and there is room for `size` entries of contacts."""
        first, partners = partners_of(n, joined)
        contacts = np.zeros(n, dtype=np.int64), np.zeros((0, 2), dtype=np.int64), np.zeros(0)
        return cls(first, partners, *contacts).cleared(size, counts)

    def cleared(self, size: int, counts: Integers) -> Constraints:
        """These constraints without persistent contacts, with room for `size` entries."""
        counts[Count.SPARE], counts[Count.SPARES] = NONE, 0
        none = np.full_like(self.first_persistent, NONE)
        emptied = self._replace(first_persistent=none, persistent=self.persistent[:0], forces=self.forces[:0])
        return emptied.enlarged(size, counts)

    def enlarged(self, size: int, counts: Integers) -> Constraints:
        """These constraints with room for `size` entries; new unused entries are chained before the old ones."""
        old = len(self.persistent)
        persistent, forces = np.zeros((size, 2), dtype=np.int64), np.zeros(size)
        persistent[:old], forces[:old] = self.persistent, self.forces
        persistent[old:, Entry.NEXT] = np.arange(old + 1, size + 1)
        persistent[-1, Entry.NEXT] = counts[Count.SPARE]
        counts[Count.SPARE] = old
        counts[Count.SPARES] += size - old
        return self._replace(persistent=persistent, forces=forces)


def partners_of(n: int, joined: Any) -> tuple[Integers, Integers]:
    """`first` and `partners` of Constraints: of n discs, of which these pairs never collide."""
    pairs = np.asarray(joined, dtype=np.int64).reshape(-1, 2)
    ends = np.concatenate([pairs, pairs[:, ::-1]])
    ends = ends[np.lexsort((ends[:, 1], ends[:, 0]))]
    return np.searchsorted(ends[:, 0], np.arange(n + 1)), np.ascontiguousarray(ends[:, 1])


class Entry(IntEnum):
    """Columns of `Constraints.persistent`."""

    OTHER = 0  # the other disc of the contact
    NEXT = 1  # the next entry of the same disc, or NONE


class Group(NamedTuple):
    """Discs ("members" 0, 1, …) that touch now, and the contacts between them, solved together.

    members: the disc of each member; place: the member that a disc is, or NONE; shape (n,) both.
    links: the two members of each contact, shape (c, 2). contacts: shape (c, len(Contact)).
    mobility: inverse mass of each member in each direction, 1/kg, 0 where it is held, shape (n, 2), so that
    N_cᵀ M⁻¹ N_d is the compliance of the contacts under the members' supports.
    motion: what impulses change, shape (n, 2): velocities, m/s, with impulses in N·s; or accelerations, m/s²,
    with forces in N. initial, start, other: copies of other motion.
    steps: of a step in persistent contact, shape (len(Stage), n, 2).
    noise: rate below which a contact closes by round-off only, shape (1,).
    marks: work space, shape (len(Mark), c). matrix: work space, shape (DIRECT + 1, DIRECT).
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
    steps: Floats
    noise: Floats
    marks: Integers
    matrix: Floats

    @classmethod
    def empty(cls, n: int, contacts: int) -> Group:
        """An empty group with room for n members and so many contacts."""
        return cls(
            members=np.zeros(n, dtype=np.int64),
            place=np.full(n, NONE, dtype=np.int64),
            links=np.zeros((contacts, 2), dtype=np.int64),
            contacts=np.zeros((contacts, len(Contact))),
            mobility=np.zeros((n, 2)),
            motion=np.zeros((n, 2)),
            initial=np.zeros((n, 2)),
            start=np.zeros((n, 2)),
            other=np.zeros((n, 2)),
            steps=np.zeros((len(Stage), n, 2)),
            noise=np.zeros(1),
            marks=np.zeros((len(Mark), contacts), dtype=np.int64),
            matrix=np.zeros((DIRECT + 1, DIRECT)),
        )


class Contact(IntEnum):
    """Columns of `Group.contacts`."""

    NX, NY = 0, 1  # unit vector from the first member to the second
    DISTANCE = 2  # of the centres, m
    COMPLIANCE = 3  # rate at which a unit impulse in the contact opens it, 1/kg
    BIAS = 4  # added to the rate at which the contact opens
    IMPULSE = 5  # of the present projection
    TOTAL_IMPULSE = 6  # of the whole impact
    FORCE = 7  # that has kept the discs apart since the group's last change, N; 0: none
    ROUND = 8  # 1: the normal turns as the discs move around each other; 0: along a flat side it does not
    PREVIOUS = 9  # impulse before a sweep to and fro
    DIRECTION = 10  # sum of the changes of the impulse by the sweeps so far
    SX, SY = 11, 12  # vector from the first member to the nearest point of the second at the start of a step, m


class Stage(IntEnum):
    """Parts of `Group.steps`, of each member."""

    BEFORE = 0  # accelerations in the stage before, m/s²
    BEND = 1  # columns BX, BY of Disc
    CURVE = 2  # columns CX, CY of Disc


class Mark(IntEnum):
    """Rows of `Group.marks`."""

    ACTIVE = 0  # the contacts of a projection
    STATE = 1  # of each contact in the active-set method
    CHOSEN = 2  # the contacts whose rates are now brought to 0


class Pile(NamedTuple):
    """Discs that take steps, the pairs of discs that are near, and the contacts of the present step.

    See kernels/pile.py. motion: x and y of each disc in turns, shape (len(Motion), 2 n); travel: shape (len(Travel), n).
    pairs: two discs each, ascending, shape (p, 2); near: shape (p, len(PilePair)); forces: in the pairs in the step before,
    N, shape (p,). chosen: the pairs that are contacts; order: the same, in the order in which sweeps go through the
    contacts; shape (p,) both. ends: the two discs of a contact, one disc twice where the other is held, shape (p, 2).
    contacts: shape (p, len(PileContact)). scale: square root of the compliances, 1/√kg, shape (p,). contacts_of, shape
    (2 p,): those of disc i from first[i] to first[i + 1]. queue: contacts still to be relaxed; queued: 1 for these;
    shape (p,) both. part: the first of the discs that push one another, with it among them, shape (n,); parts: shape
    (len(Part), n).
    """

    motion: Floats
    travel: Floats
    pairs: Integers
    near: Floats
    forces: Floats
    chosen: Integers
    order: Integers
    ends: NDArray[np.uint32]
    contacts: Floats
    scale: Floats
    first: NDArray[np.int32]
    contacts_of: NDArray[np.int32]
    queue: NDArray[np.int32]
    queued: NDArray[np.int32]
    part: NDArray[np.int32]
    parts: Floats

    @classmethod
    def empty(cls, n: int, pairs: int) -> Pile:
        """A pile of n discs with room for so many pairs."""
        return cls(
            motion=np.zeros((len(Motion), 2 * n)),
            travel=np.zeros((len(Travel), n)),
            pairs=np.zeros((pairs, 2), dtype=np.int64),
            near=np.zeros((pairs, len(PilePair))),
            forces=np.zeros(pairs),
            chosen=np.zeros(pairs, dtype=np.int64),
            order=np.zeros(pairs, dtype=np.int64),
            ends=np.zeros((pairs, 2), dtype=np.uint32),
            contacts=np.zeros((pairs, len(PileContact))),
            scale=np.zeros(pairs),
            first=np.zeros(n + 1, dtype=np.int32),
            contacts_of=np.zeros(2 * pairs, dtype=np.int32),
            queue=np.zeros(pairs, dtype=np.int32),
            queued=np.zeros(pairs, dtype=np.int32),
            part=np.zeros(n, dtype=np.int32),
            parts=np.zeros((len(Part), n)),
        )


class PilePair(IntEnum):
    """Columns of `Pile.near`, at the start of a step."""

    NX, NY = 0, 1  # unit vector from the first disc to the nearest point of the second
    GAP = 2  # m
    RATE = 3  # at which the gap opens, m/s
    PULL = 4  # acceleration without contacts at which it opens, m/s²
    SPEED = 5  # of the second relative to the first, m/s


class PileContact(IntEnum):
    """Columns of `Pile.contacts`.

    Velocities u = v/√w and impulses are scaled so that a unit impulse opens its own contact at the rate 1:
    A = N W Nᵀ has a diagonal of ones. The rate at which a contact opens is
    (AX, AY)·(u of its first disc) + (BX, BY)·(u of its second disc) + BIAS.
    """

    AX, AY = 0, 1
    BX, BY = 2, 3
    BIAS = 4
    IMPULSE = 5
    PREVIOUS = 6  # impulse before a sweep to and fro
    DIRECTION = 7  # sum of the changes of the impulse by the sweeps so far


class Motion(IntEnum):
    """Parts of `Pile.motion`, of each disc in each direction."""

    SPEED = 0  # u = v/√w
    ROOT = 1  # √w
    PREVIOUS = 2  # u before the sweeps
    DIRECTION = 3  # sum of the changes of u by the sweeps so far


class Travel(IntEnum):
    """Rows of `Pile.travel`, of each disc."""

    SHIFT = 0  # farthest that contacts may shift the disc in the step, m
    FASTEST = 1  # fastest relative speed of a disc that it may meet, m/s
    NEAR = 2  # 1: it is near another at the end of the step; 2: another pushed it
    PULL = 3  # acceleration without contacts, m/s²


class Part(IntEnum):
    """Rows of `Pile.parts`. LAW: of each disc; the others: of a part, in the column of its first disc."""

    LAW = 0  # of the contacts of the disc in this step, see kernels/pile_energy.py
    GAIN = 1  # energy that the step supplies, J
    ENERGY = 2  # by which the round-off of GAIN is measured, J
    PUSHED_OUT = 3  # energy that pushing discs out of one another takes, J
    BOUNCED = 4  # 1: a contact in which discs bounce pushes
    CHANGE = 5  # twice the energy of the change of velocities by impulses, J
    WORK = 6  # of the impulses beyond what the biases demand, J
    SHARE = 7  # of the impulses, that is kept


class Report(NamedTuple):
    """Impacts that the kernels have reported and nobody has fetched yet.

    pairs: the two discs, shape (capacity, 2). details: shape (capacity, len(Detail)).
    """

    pairs: Integers
    details: Floats

    @classmethod
    def empty(cls, size: int) -> Report:
        """A report with room for `size` impacts."""
        return cls(np.zeros((size, 2), dtype=np.int64), np.zeros((size, len(Detail))))


class Detail(IntEnum):
    """Columns of `Report.details`."""

    TIME = 0  # s
    IMPULSE = 1  # N·s
    LOSS = 2  # energy lost, J
    X, Y = 3, 4  # point of contact, m


class Number(IntEnum):
    """Entries of `numbers`, float64: the real numbers of a flight."""

    NOW = 0  # everything up to this time has happened, s
    HORIZON_END = 1  # end of the present horizon, up to which all impacts are known, s
    HORIZON = 2  # length of a horizon, s
    CELL = 3  # size of the cells of the grid's finest layer, m
    CROWDING = 4  # neighbours found per area of boxes, 1/m²
    RESTITUTION = 5  # the least of all
    REST_HEIGHT = 6  # of the smaller radius; bounces that would rise less end in contact
    SMALLEST = 7  # radius of the smallest disc, m
    STEP_LENGTH = 8  # of the steps of piles, s; ∞ where nothing is pulled
    STEP_END = 9  # end of the present step, s
    WORK_SINCE = 10  # time since which Count.WORK is counted, s
    LOSS = 11  # energy that impacts and piles have taken so far, the present step of a pile in full, J
    STOP = 12  # at which forces change: a step of a pile ends there, s; ∞ if they do not
    MOST_LOSS = 13  # the largest LOSS until the present step of a pile, J: what appears later is no loss undone
    DEEPEST = 14  # overlap in which a step of a pile began so far, in radii of the smaller disc


class Count(IntEnum):
    """Entries of `counts`, int64: the whole numbers and flags of a flight."""

    QUEUED = 0  # impacts in the queue
    LAYERS = 1  # of the grid
    REPORTED = 2  # impacts in the report
    IMPACTS = 3  # so far, every contact of a joint impact counted
    EVENTS = 4  # so far: impacts, a joint one counted once, and steps of persistent contact
    LEVEL = 5  # coarsest level that a disc needed beyond those of the grid
    RENEW = 6  # 1: a new horizon must be opened before anything else
    SPARE = 7  # first unused entry of the table of persistent contacts
    SPARES = 8  # number of unused entries
    STEPPING = 9  # 1: discs take the steps of a pile
    CALM = 10  # consecutive steps in which nothing in the pile moved fast
    WORK = 11  # contacts in the events of late
    DISCS = 12  # number of discs, without obstacles
    PATIENCE = 13  # calm steps after which a pile seeks its equilibrium
    LISTED = 14  # pairs in the list of a pile; NONE: they must be listed anew


# What a pile goes on from: FreeFlightState.pile, in this order.
PILE_COUNTS = [Count.STEPPING, Count.CALM, Count.WORK, Count.PATIENCE]
PILE_NUMBERS = [Number.STEP_END, Number.WORK_SINCE, Number.LOSS, Number.MOST_LOSS, Number.DEEPEST]


class Reason(IntEnum):
    """Why a kernel of the flight returned."""

    DONE = 0  # arrived
    BUSY = 1  # as many events as were allowed
    REPORT_FULL = 2  # fetch the reported impacts and go on
    QUEUE_FULL = 3  # enlarge the queue and go on
    GRID_FULL = 4  # enlarge the grid and go on
    GROUP_FULL = 5  # enlarge the room for contacts and persistent contacts and go on
    SETTLE = 6  # put the calm pile into its equilibrium and go on
    GO_ON = 7  # go on with what is due now: a horizon, steps of a pile, or events
