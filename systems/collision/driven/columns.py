"""The arrays that the kernels of driven collisions share with step programs, and enumerations of their entries."""

from __future__ import annotations

from collections.abc import Mapping
from enum import auto
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.systems.collision.columns import NONE, Detail, Grid, Group, Integers, Places, zeros
from pinjoint.systems.program.entries import Account, Control


class Order(Places):
    """What a step program is to do next for the particles that meet in its steps."""

    GO_ON = auto()  # nothing: only between kernels of collisions
    LIST = auto()  # pairs anew, within Real.SPAN
    LEAVE = auto()  # return to Python; Whole.NEED says why
    EVALUATE = auto()  # the forces of the present state, if they are not known
    TAKE = auto()  # a step: to Real.END, or a whole one where that is infinite


class Phase(Places):
    """How far the present step is, as kernels of collisions see it."""

    BETWEEN = auto()  # no step has begun
    READY = auto()  # the forces at its beginning are known
    CLEAR = auto()  # steps were taken in which nothing can meet
    TRYING = auto()  # contact forces are to be tried
    TRIED = auto()  # it was taken, or foreseen, with them
    HELD = auto()  # contacts are closed at its end: does it hold an impact?
    OVER = auto()  # it was taken for good, up to an impact if there is one


class Goal(Places):
    """Where the step that is tried is to end."""

    WHOLE = auto()  # at its own end, or where it was cut
    IMPACT = auto()  # where the first pair meets
    PRESSED = auto()  # where it was found to begin with an impact of which nothing came


class Need(Places):
    """Why the program returned to Python."""

    NOTHING = auto()  # the steps are done, or a StopReason says why not
    ROOM = auto()  # for pairs, for contacts, or for impacts to report
    WAKE = auto()  # something struck what is asleep


class Whole(Places):
    """Entries of `Driven.whole`."""

    ALONE = auto()  # 1: take steps as if nothing could collide
    WANTED = auto()  # steps
    TOTAL = auto()  # steps so far, of the run
    FIRST = auto()  # those when the program was entered
    SINCE = auto()  # those at the origin of the steps
    FRESH = auto()  # 1: the forces are those of the present state
    REASON = auto()  # StopReason of the last step
    NEED = auto()
    PHASE = auto()
    GOAL = auto()
    LANDING = auto()  # 1: the step is to end at Real.UNTIL
    FORESEEN = auto()  # 1: the integrator's steps are known ahead
    KEEP = auto()  # 1: keep the state before the step is taken
    BACK = auto()  # 1: put the kept state back
    KEPT_TOTAL = auto()
    KEPT_SINCE = auto()
    CHOSEN = auto()  # persistent contacts in the present step
    TURN = auto()  # tries of the contact forces
    CUTS = auto()  # of the step
    REGULAR = auto()  # 1: the slope of the search is that of both ends of the step
    TRIES = auto()  # of the end of a step that ends at an impact
    MET = auto()  # 1: it ends at an impact
    CROWD = auto()  # 1: the step is one of a crowd
    CROWDS = auto()  # steps of crowds so far
    MEMBERS = auto()  # of the crowd
    BOUNCY = auto()  # 1: some restitution is below 1
    DAMPED = auto()  # 1: dampers or drag calm the motion
    REPORTED = auto()  # impacts
    STEPS = auto()  # to take at once
    PUSHED = auto()  # 1: contact forces acted in the last step
    EXAMINE = auto()  # 1: the next step is one that is looked through, though nothing seems near
    LISTED = auto()  # pairs in the list
    NEAR = auto()  # particles in them
    FOUND = auto()  # pairs when they were listed last; NONE: the grid had no room for LAYERS
    LAYERS = auto()  # of the grid, then
    LISTS = auto()  # so far
    # steps since the run began whose contacts were left as they were, since no forces close them
    UNCLOSED = auto()


class Real(Places):
    """Entries of `Driven.real`."""

    UNTIL = auto()  # s; no step ends later
    END = auto()  # s; of the step to take; infinite: a whole one
    ORIGIN = auto()  # s; from which steps are counted
    START = auto()  # s; of the present step
    NOW = auto()  # s; its end, as tried or foreseen
    IMPACT = auto()  # s; when a pair is to meet in it
    LAST = auto()  # s; until when it was tried
    LONGEST = auto()  # s; longest next step in persistent contact
    CUT = auto()  # s; length that the step was cut to
    HELD_LIMIT = auto()  # s; longest step while contacts persist
    PUSH = auto()  # share of h² a by which a foreseen step moves a particle
    BREAK = auto()  # s; when loads next change abruptly
    SPAN = auto()  # m; within which pairs must be listed
    KEPT_ORIGIN = auto()
    CROWD_STEP = auto()  # s; longest step of a crowd
    CROWD_LENGTH = auto()  # s; of the next step of a crowd
    CROWD_TRAVEL = auto()  # m; how far particles may go in it
    CROWD_TOLERANCE = auto()  # m; by which pairs may close beyond their room
    CROWD_LOSS = auto()  # J; by the impacts in it
    STRONGEST = auto()  # m/s²; the largest `pull`
    BY = auto()  # s; when the steps that are taken now have to end
    ROOM = auto()  # m; how far particles may move while nothing can meet
    FASTEST = auto()  # m/s; of them, in that time
    UNCLOSED = auto()  # of a radius; how far contacts were left open, or in one another, at most


class Tried(Places):
    """Rows of `Driven.search`, of each contact."""

    FORCES = auto()  # N; tried now
    LEAST = auto()  # m; the gap at the start, if particles are in one another
    GAP = auto()  # m; the gap beyond that at the end
    ALLOWED = auto()  # m; of it
    OLD_FORCES = auto()
    OLD_GAP = auto()
    FOUND = auto()  # N; the next forces
    SCALE = auto()
    OFFSET = auto()


class Driven(NamedTuple):
    """Driven particles, n of them, the obstacles after them, and the step that they are in the midst of.

    Of the document: position, span, weight (inverse mass, 1/kg, 0 where held), radius, size (the radius, ∞ for obstacles),
    restitution, node (1: of a structure); loose: the particles that are no nodes; asleep, and pull, acceleration by
    constant forces (m/s²).
    Of the list, whose arrays have room for more pairs than the Whole.LISTED that are there: near: the particles in pairs;
    pairs, rows i < j in ascending order, and of each pair lasting (1: a persistent contact), forces (N), normal, slow (speed
    below which it stays in contact, m/s), rate (at which it opens, m/s); listed: displacements when it was made, margin (m):
    how far each particle may move from there, negative: there is no list.
    Of the step: before, velocity: the state it begins with; ahead, ahead_speed: where it leads, as foreseen;
    acceleration, at its start; path_error (m); support: contact forces (kN); kept: control and account at the start.
    Of the search for contact forces: chosen, the pairs in persistent contact; search, with the rows of Tried; start, end:
    their normals at both ends of the step; block: the first contact of its block and the one after the last, as only
    contacts of particles that others connect depend on one another; slope, learnt (m/N); matrix, sides: work space.
    Of crowds: of each pair room, the gap at the start, if it is one (m), pushes, forces that are tried (N), and impulses
    (N·s).
    Of impacts: group, report; touching: the pairs that touch; parent, chain: work space, by which they are grouped.
    """

    position: Annotated[Array, "every", 2]
    span: Annotated[Array, "every", 2]
    weight: Annotated[Array, "every", 2]
    radius: Annotated[Array, "every"]
    size: Annotated[Array, "every"]
    restitution: Annotated[Array, "every"]
    node: Annotated[Integers, "every"]
    loose: Annotated[Integers, "n"]
    asleep: Annotated[NDArray[np.bool_], "n"]
    pull: Annotated[Array, "n"]
    near: Annotated[Integers, "n"]
    pairs: Annotated[Integers, "pairs", 2]
    lasting: Annotated[Integers, "pairs"]
    forces: Annotated[Array, "pairs"]
    normal: Annotated[Array, "pairs", 2]
    slow: Annotated[Array, "pairs"]
    rate: Annotated[Array, "pairs"]
    room: Annotated[Array, "pairs"]
    pushes: Annotated[Array, "pairs"]
    impulses: Annotated[Array, "pairs"]
    listed: Annotated[Array, "n", 2]
    margin: Annotated[Array, "n"]
    before: Annotated[Array, "n", 2]
    velocity: Annotated[Array, "n", 2]
    ahead: Annotated[Array, "n", 2]
    ahead_speed: Annotated[Array, "n", 2]
    acceleration: Annotated[Array, "n", 2]
    path_error: Annotated[Array, "n"]
    support: Annotated[Array, "n", 2]
    kept: Annotated[Array, len(Account) + len(Control)]
    chosen: Annotated[Integers, "contacts"]
    search: Annotated[Array, len(Tried), "contacts"]
    start: Annotated[Array, "contacts", 2]
    end: Annotated[Array, "contacts", 2]
    slope: Annotated[Array, "contacts", "contacts"]
    learnt: Annotated[Array, "contacts", "contacts"]
    matrix: Annotated[Array, "contacts", "columns"]
    block: Annotated[Integers, 2, "contacts"]
    sides: Annotated[Integers, 2, "contacts"]
    group: Group
    report: Annotated[Array, "reported", len(Detail)]
    touching: Annotated[Integers, "pairs"]
    parent: Annotated[Integers, "every"]
    chain: Annotated[Integers, "pairs"]
    whole: Annotated[Integers, len(Whole)]
    real: Annotated[Array, len(Real)]

    @classmethod
    def empty(cls, of_document: Mapping[str, Any], n: int, pairs: int, contacts: int) -> Driven:
        """Arrays of n particles, of which some are given, with room for so many pairs and persistent contacts."""
        every = len(of_document.get("radius", ()))
        given = {**of_document, "group": Group.empty(max(every, 2 * pairs), pairs)}
        room = {"pairs": pairs, "reported": 4 * pairs + 64, "contacts": contacts, "columns": contacts + 1}
        driven = zeros(cls, given, n=n, every=every, **room)
        driven.parent[:] = NONE
        return driven


class Listing(NamedTuple):
    """What the pairs of Driven are listed by; see kernels/neighbours.py.

    The particles that rods join to particle i are partners[first[i] : first[i + 1]]. found: work space, pairs, shape (p, 2).
    """

    first: Integers
    partners: Integers
    found: Integers
    grid: Grid

    @classmethod
    def empty(cls, between: Integers, every: int, n: int) -> Listing:
        """To list pairs of n particles, joined by rods between these, and of `every` with the obstacles."""
        ends = np.concatenate([between, between[:, ::-1]]).astype(np.int64)
        ends = ends[np.lexsort((ends[:, 1], ends[:, 0]))]
        first, partners = np.searchsorted(ends[:, 0], np.arange(n + 1)), np.ascontiguousarray(ends[:, 1])
        return cls(first, partners, np.zeros((0, 2), dtype=np.int64), Grid.empty(every, 1))
