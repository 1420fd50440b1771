"""The arrays that the kernels of collisions share: their shapes, and an enumeration of the columns of each.

`discs[i, Disc.VX]` costs the same as `discs[i, 2]`: numba folds members of an IntEnum into constants.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from enum import IntEnum, auto
from functools import cache
from typing import Annotated, Any, NamedTuple, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array

Integers = NDArray[np.int64]
Arrays = TypeVar("Arrays")

EPSILON = sys.float_info.epsilon
SPEED_NOISE = 16.0 * EPSILON  # round-off of a speed, as a share of the speeds that it is computed from
NONE = -1  # no entry, no member
REST_HEIGHT = 1e-9  # of the smaller radius; bounces that would rise less end in contact
DIRECT = 48  # contacts up to which a projection is solved directly; larger groups are solved by sweeps
SHARED_START, SHARED_END = 1.0, 2.0  # flags of Disc.SHARED
# shortest step of piles and crowds, where discs are fast, as a share of the longest
SHORTEST_SHARE = 1.0 / 16.0
TINY = 1e-300  # more than none, in any unit


_hints = cache(get_type_hints)


def zeros(kind: Callable[..., Arrays], given: dict[str, Any] | None = None, **sizes: int) -> Arrays:
    """Arrays of zeros, but for those given. Their annotations say their shapes: numbers, and names of sizes."""
    made = dict(given or {})
    for name, hint in _hints(kind, include_extras=True).items():
        if name not in made:
            array, *shape = get_args(hint)
            made[name] = np.zeros([sizes.get(size, size) for size in shape], get_args(get_args(array)[1])[0])
    return kind(**made)


class Places(IntEnum):
    """Places in an array, and codes, numbered from 0 in order."""

    @staticmethod
    def _generate_next_value_(name: str, start: int, count: int, last_values: list[int]) -> int:
        return count


class Disc(Places):
    """Columns of `discs`: one row per disc, its path since its epoch t₀, the time of its last change.

    With s = t − t₀, u(t) = u₀ + v₀ s + a s²/2 is the displacement from the original position o; in a step h of persistent
    contact it is bent by s² (s − h) (b + c s), which takes nothing from its ends. Obstacles follow the discs: straight
    pieces that never move, rounded by their radius. Of a pair, an obstacle is the later row. The columns that time
    changes come first.
    """

    UX, UY = auto(), auto()  # displacement at the epoch, m
    VX, VY = auto(), auto()  # velocity at the epoch, m/s
    AX, AY = auto(), auto()  # acceleration of the path, m/s²
    EPOCH = auto()  # s
    # time at which the forces in its persistent contacts are due again, t₀ + h, s; ∞ if they are not
    STEP = auto()
    NOISE = auto()  # round-off in the velocity, from the impact or the contacts that caused it, m/s
    BX, BY = auto(), auto()  # how the path bends, m/s³
    CX, CY = auto(), auto()  # and how that changes, m/s⁴
    RADIUS = auto()  # m
    OX, OY = auto(), auto()  # original position, m; of an obstacle, its first end
    TX, TY = auto(), auto()  # vector from the first end of an obstacle to the other, m; 0 for discs
    CHANGES = auto()  # number of changes of the path so far
    GX, GY = auto(), auto()  # acceleration without contact forces, m/s²
    WX, WY = auto(), auto()  # inverse mass in each direction, 1/kg; 0 where the disc is held
    BOUNCE = auto()  # restitution of impacts with it
    SHARED = auto()  # ends of an obstacle that an earlier obstacle accounts for: SHARED_START + SHARED_END


FLIGHT = slice(Disc.UX, Disc.CY + 1)
"""Columns that time changes: those of `FreeFlightState.motion` (components/clock.py)."""


class Grid(NamedTuple):
    """Boxes around the paths of all discs, and a hash grid of the boxes; see kernels/grid.py.

    boxes: left, bottom, right, top, m. layer: of each disc. levels: the cells of layer k have the size cell × 2^levels[k],
    ascending; inverse: one by that size, 1/m. heads: first entry of each bucket; the number of buckets is a power of two,
    and that of entries four times one. after, before: the next entry in the same bucket and the one before. found: the
    discs that searches find; times: of impacts with them, s.
    """

    boxes: Annotated[Array, "n", 4]
    layer: Annotated[Integers, "n"]
    levels: Annotated[Integers, 64]
    inverse: Annotated[Array, 64]
    heads: Annotated[NDArray[np.int32], "buckets"]
    after: Annotated[NDArray[np.int32], "entries"]
    before: Annotated[NDArray[np.int32], "entries"]
    found: Annotated[Integers, "found"]
    times: Annotated[Array, "found"]

    @classmethod
    def empty(cls, n: int, layers: int) -> Grid:
        """A grid of n discs with room for so many layers."""
        buckets = 1 << int(np.ceil(np.log2(max(n * layers, 64))))
        entries = 4 << int(np.ceil(np.log2(max(2 * n * layers, 64))))
        grid = zeros(cls, n=n, buckets=buckets, entries=entries, found=2 * n + 2)
        grid.heads[:] = NONE
        return grid


class Queue(NamedTuple):
    """Impacts to come, a binary heap; see kernels/heap.py.

    times: s. impacts: two discs, and how often each had changed its path when the impact was computed; the impact is void
    once either has changed again.
    """

    times: Annotated[Array, "size"]
    impacts: Annotated[NDArray[np.int32], "size", 4]


class Constraints(NamedTuple):
    """Pairs that cannot have an impact: persistent contacts.

    Those of disc i are a chain of entries from first_persistent[i]: persistent, shape (capacity, 2), holds the columns of
    Entry, forces the force, N. A persistent contact is entered for each of its discs that is not held. Unused entries
    are chained from counts[Count.SPARE].
    """

    first_persistent: Integers
    persistent: Integers
    forces: Array

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


class Entry(Places):
    """Columns of `Constraints.persistent`."""

    OTHER = auto()  # the other disc of the contact
    NEXT = auto()  # the next entry of the same disc, or NONE


class Group(NamedTuple):
    """Discs ("members" 0, 1, …) that touch now, and the contacts between them, solved together.

    members: the disc of each member; place: the member that a disc is, or NONE. links: the two members of each contact.
    mobility: inverse mass of each member in each direction, 1/kg, 0 where it is held, so that N_cᵀ M⁻¹ N_d is the
    compliance of the contacts under the members' supports.
    motion: what impulses change: velocities, m/s, with impulses in N·s; or accelerations, m/s², with forces in N. initial,
    start, other: copies of other motion.
    Of a step in persistent contact: before, accelerations in the stage before, m/s²; bend, columns BX and BY of Disc;
    curve, CX and CY.
    noise: rate below which a contact closes by round-off only.
    active: the contacts of a projection; state: of each contact in the active-set method; chosen: those whose rates are now
    brought to 0. matrix: work space. cut_short: how many impacts had more reflections than are followed.
    """

    members: Annotated[Integers, "n"]
    place: Annotated[Integers, "n"]
    links: Annotated[Integers, "contacts", 2]
    contacts: Annotated[Array, "contacts", len(Contact)]
    mobility: Annotated[Array, "n", 2]
    motion: Annotated[Array, "n", 2]
    initial: Annotated[Array, "n", 2]
    start: Annotated[Array, "n", 2]
    other: Annotated[Array, "n", 2]
    before: Annotated[Array, "n", 2]
    bend: Annotated[Array, "n", 2]
    curve: Annotated[Array, "n", 2]
    noise: Annotated[Array, 1]
    active: Annotated[Integers, "contacts"]
    state: Annotated[Integers, "contacts"]
    chosen: Annotated[Integers, "contacts"]
    matrix: Annotated[Array, DIRECT + 1, DIRECT]
    cut_short: Annotated[Integers, 1]

    @classmethod
    def empty(cls, n: int, contacts: int) -> Group:
        """An empty group with room for n members and so many contacts."""
        group = zeros(cls, n=n, contacts=contacts)
        group.place[:] = NONE
        return group


class Contact(Places):
    """Columns of `Group.contacts`."""

    NX, NY = auto(), auto()  # unit vector from the first member to the second
    DISTANCE = auto()  # of the centres, m
    COMPLIANCE = auto()  # rate at which a unit impulse in the contact opens it, 1/kg
    BIAS = auto()  # added to the rate at which the contact opens
    IMPULSE = auto()  # of the present projection
    TOTAL_IMPULSE = auto()  # of the whole impact
    FORCE = auto()  # that has kept the discs apart since the group's last change, N; 0: none
    ROUND = auto()  # 1: the normal turns as the discs move around each other; 0: along a flat side it does not
    PREVIOUS = auto()  # impulse before a sweep to and fro
    DIRECTION = auto()  # sum of the changes of the impulse by the sweeps so far
    # vector from the first member to the nearest point of the second at the start of a step, m
    SX, SY = auto(), auto()


class Pile(NamedTuple):
    """Discs that take steps, the pairs of discs that are near, and the contacts of the present step; see kernels/pile.py.

    Of each disc in each direction, x and y in turns: speed, u = v/√w; root, √w; previous, u before the
    sweeps; direction, sum of the changes of u by the sweeps so far.
    Of each disc: shift, the farthest that contacts may shift it in the step, m; fastest, relative speed of a
    disc that it may meet, m/s; nearness, 1 if it is near another at the end of the step, 2 if another pushed it; pull,
    acceleration without contacts, m/s²; law, of its contacts in this step, see kernels/pile_energy.py; part, the first of
    the discs that push one another, with it among them.
    Of each part, at its first disc: gain, energy that the step supplies, J; energy, by which the round-off of
    that is measured, J; pushed_out, energy that pushing discs out of one another takes, J; bounced, 1 if a contact in which
    discs bounce pushes; change, twice the energy of the change of velocities by impulses, J; work, of the impulses beyond
    what the biases demand, J; share, of the impulses, that is kept.
    pairs: two discs each, ascending. forces: in the pairs in the step before, N. chosen: the pairs that are contacts; order:
    the same, in the order in which sweeps go through the contacts. ends: the two discs of a contact, one disc twice where
    the other is held. scale: square root of the compliances, 1/√kg. contacts_of: those of disc i from first[i] to
    first[i + 1]. queue: contacts still to be relaxed; queued: 1 for these.
    """

    speed: Annotated[Array, "coordinates"]
    root: Annotated[Array, "coordinates"]
    previous: Annotated[Array, "coordinates"]
    direction: Annotated[Array, "coordinates"]
    shift: Annotated[Array, "n"]
    fastest: Annotated[Array, "n"]
    nearness: Annotated[Array, "n"]
    pull: Annotated[Array, "n"]
    law: Annotated[Array, "n"]
    part: Annotated[NDArray[np.int32], "n"]
    gain: Annotated[Array, "n"]
    energy: Annotated[Array, "n"]
    pushed_out: Annotated[Array, "n"]
    bounced: Annotated[Array, "n"]
    change: Annotated[Array, "n"]
    work: Annotated[Array, "n"]
    share: Annotated[Array, "n"]
    pairs: Annotated[Integers, "pairs", 2]
    near: Annotated[Array, "pairs", len(PilePair)]
    forces: Annotated[Array, "pairs"]
    chosen: Annotated[Integers, "pairs"]
    order: Annotated[Integers, "pairs"]
    ends: Annotated[NDArray[np.uint32], "pairs", 2]
    contacts: Annotated[Array, "pairs", len(PileContact)]
    scale: Annotated[Array, "pairs"]
    first: Annotated[NDArray[np.int32], "bounds"]
    contacts_of: Annotated[NDArray[np.int32], "ends"]
    queue: Annotated[NDArray[np.int32], "pairs"]
    queued: Annotated[NDArray[np.int32], "pairs"]

    @classmethod
    def empty(cls, n: int, pairs: int) -> Pile:
        """A pile of n discs with room for so many pairs."""
        return zeros(cls, n=n, coordinates=2 * n, bounds=n + 1, pairs=pairs, ends=2 * pairs)


class PilePair(Places):
    """Columns of `Pile.near`, at the start of a step."""

    NX, NY = auto(), auto()  # unit vector from the first disc to the nearest point of the second
    GAP = auto()  # m
    RATE = auto()  # at which the gap opens, m/s
    PULL = auto()  # acceleration without contacts at which it opens, m/s²
    SPEED = auto()  # of the second relative to the first, m/s


class PileContact(Places):
    """Columns of `Pile.contacts`.

    Velocities u = v/√w and impulses are scaled so that a unit impulse opens its own contact at the rate 1:
    A = N W Nᵀ has a diagonal of ones. The rate at which a contact opens is
    (AX, AY)·(u of its first disc) + (BX, BY)·(u of its second disc) + BIAS.
    """

    AX, AY = auto(), auto()
    BX, BY = auto(), auto()
    BIAS = auto()
    IMPULSE = auto()
    PREVIOUS = auto()  # impulse before a sweep to and fro
    DIRECTION = auto()  # sum of the changes of the impulse by the sweeps so far


class Detail(Places):
    """Columns of `report`: the impacts that nobody has fetched yet, as impacts.py keeps them."""

    TIME = auto()  # s
    FIRST, SECOND = auto(), auto()  # the discs
    IMPULSE = auto()  # N·s, along the line of centres
    LOSS = auto()  # energy lost, J
    X, Y = auto(), auto()  # point of contact, m


class Number(Places):
    """Entries of `numbers`, float64: the real numbers of a flight."""

    NOW = auto()  # everything up to this time has happened, s
    HORIZON_END = auto()  # end of the present horizon, up to which all impacts are known, s
    HORIZON = auto()  # length of a horizon, s
    CELL = auto()  # size of the cells of the grid's finest layer, m
    CROWDING = auto()  # neighbours found per area of boxes, 1/m²
    RESTITUTION = auto()  # the least of all
    SMALLEST = auto()  # radius of the smallest disc, m
    STEP_LENGTH = auto()  # of the steps of piles, s; ∞ where nothing is pulled
    STEP_END = auto()  # end of the present step, s
    WORK_SINCE = auto()  # time since which Count.WORK is counted, s
    LOSS = auto()  # energy that impacts and piles have taken so far, the present step of a pile in full, J
    STOP = auto()  # at which forces change: a step of a pile ends there, s; ∞ if they do not
    # the largest LOSS until the present step of a pile, J: what appears later is no loss undone
    MOST_LOSS = auto()
    DEEPEST = auto()  # overlap in which a step of a pile began so far, in radii of the smaller disc


class Count(Places):
    """Entries of `counts`, int64: the whole numbers and flags of a flight."""

    QUEUED = auto()  # impacts in the queue
    LAYERS = auto()  # of the grid
    REPORTED = auto()  # impacts in the report
    IMPACTS = auto()  # so far, every contact of a joint impact counted
    EVENTS = auto()  # so far: impacts, a joint one counted once, and steps of persistent contact
    LEVEL = auto()  # coarsest level that a disc needed beyond those of the grid
    RENEW = auto()  # 1: a new horizon must be opened before anything else
    SPARE = auto()  # first unused entry of the table of persistent contacts
    SPARES = auto()  # number of unused entries
    STEPPING = auto()  # 1: discs take the steps of a pile
    CALM = auto()  # consecutive steps in which nothing in the pile moved fast
    WORK = auto()  # contacts in the events of late
    DISCS = auto()  # number of discs, without obstacles
    PATIENCE = auto()  # calm steps after which a pile seeks its equilibrium
    LISTED = auto()  # pairs in the list of a pile; NONE: they must be listed anew


# What a pile goes on from: FreeFlightState.pile, in this order.
PILE_COUNTS = [Count.STEPPING, Count.CALM, Count.WORK, Count.PATIENCE]
PILE_NUMBERS = [Number.STEP_END, Number.WORK_SINCE, Number.LOSS, Number.MOST_LOSS, Number.DEEPEST]


class Reason(Places):
    """Why a kernel of the flight returned."""

    DONE = auto()  # arrived
    BUSY = auto()  # as many events as were allowed
    REPORT_FULL = auto()  # fetch the reported impacts and go on
    QUEUE_FULL = auto()  # enlarge the queue and go on
    GRID_FULL = auto()  # enlarge the grid and go on
    GROUP_FULL = auto()  # enlarge the room for contacts and persistent contacts and go on
    SETTLE = auto()  # put the calm pile into its equilibrium and go on
    GO_ON = auto()  # go on with what is due now: a horizon, steps of a pile, or events
