"""The arrays that the kernels of driven collisions share with step programs, and enumerations of their entries."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.systems.collision.columns import NONE, Floats, Grid, Group, Integers, Report
from pinjoint.systems.entries import Account, Control


class Order(IntEnum):
    """What a step program is to do next for the particles that meet in its steps."""

    GO_ON = 0  # nothing: only between kernels of collisions
    LIST = 1  # pairs anew, within Real.SPAN
    LEAVE = 2  # return to Python; Whole.NEED says why
    EVALUATE = 3  # the forces of the present state, if they are not known
    TAKE = 4  # a step: to Real.END, or a whole one where that is infinite


class Phase(IntEnum):
    """How far the present step is, as kernels of collisions see it."""

    BETWEEN = 0  # no step has begun
    READY = 1  # the forces at its beginning are known
    CLEAR = 2  # steps were taken in which nothing can meet
    TRYING = 3  # contact forces are to be tried
    TRIED = 4  # it was taken, or foreseen, with them
    HELD = 5  # contacts are closed at its end: does it hold an impact?
    CROWD_TRYING = 6  # forces in a crowd are to be tried
    CROWD_TRIED = 7  # it was taken with them
    OVER = 8  # it was taken for good, up to an impact if there is one


class Goal(IntEnum):
    """Where the step that is tried is to end."""

    WHOLE = 0  # at its own end, or where it was cut
    IMPACT = 1  # where the first pair meets
    PRESSED = 2  # where it was found to begin with an impact of which nothing came


class Need(IntEnum):
    """Why the program returned to Python."""

    NOTHING = 0  # the steps are done, or a StopReason says why not
    ROOM = 1  # for pairs, for contacts, or for impacts to report
    WAKE = 2  # something struck what is asleep


class Whole(IntEnum):
    """Entries of `Driven.whole`."""

    ALONE = 0  # 1: take steps as if nothing could collide
    WANTED = 1  # steps
    TOTAL = 2  # steps so far, of the run
    FIRST = 3  # those when the program was entered
    SINCE = 4  # those at the origin of the steps
    FRESH = 5  # 1: the forces are those of the present state
    REASON = 6  # StopReason of the last step
    NEED = 7
    PHASE = 8
    GOAL = 9
    LANDING = 10  # 1: the step is to end at Real.UNTIL
    FORESEEN = 11  # 1: the integrator's steps are known ahead
    KEEP = 12  # 1: keep the state before the step is taken
    BACK = 13  # 1: put the kept state back
    KEPT_TOTAL = 14
    KEPT_SINCE = 15
    CHOSEN = 16  # persistent contacts in the present step
    TURN = 17  # tries of the contact forces
    CUTS = 18  # of the step
    REGULAR = 19  # 1: the slope of the search is that of both ends of the step
    TRIES = 20  # of the end of a step that ends at an impact
    MET = 21  # 1: it ends at an impact
    CROWD = 22  # 1: the step is one of a crowd
    CROWDS = 23  # steps of crowds so far
    MEMBERS = 24  # of the crowd
    BOUNCY = 25  # 1: some restitution is below 1
    DAMPED = 26  # 1: dampers or drag calm the motion
    REPORTED = 27  # impacts
    STEPS = 28  # to take at once
    PUSHED = 29  # 1: contact forces acted in the last step
    EXAMINE = 30  # 1: the next step is one that is looked through, though nothing seems near
    LOOSE = 31  # 1: contacts need to be closed only so far that impacts in the step are found
    LISTED = 32  # pairs in the list
    NEAR = 33  # particles in them
    FOUND = 34  # pairs when they were listed last; NONE: the grid had no room for LAYERS
    LAYERS = 35  # of the grid, then
    LISTS = 36  # so far
    UNCLOSED = 37  # steps since the run began whose contacts were left as they were, since no forces close them


class Real(IntEnum):
    """Entries of `Driven.real`."""

    UNTIL = 0  # s; no step ends later
    END = 1  # s; of the step to take; infinite: a whole one
    ORIGIN = 2  # s; from which steps are counted
    START = 3  # s; of the present step
    NOW = 4  # s; its end, as tried or foreseen
    IMPACT = 5  # s; when a pair is to meet in it
    LAST = 6  # s; until when it was tried
    LONGEST = 7  # s; longest next step in persistent contact
    CUT = 8  # s; length that the step was cut to
    HELD_LIMIT = 9  # s; longest step while contacts persist
    PUSH = 10  # share of h² a by which a foreseen step moves a particle
    BREAK = 11  # s; when loads next change abruptly
    SPAN = 12  # m; within which pairs must be listed
    KEPT_ORIGIN = 13
    CROWD_STEP = 14  # s; longest step of a crowd
    CROWD_LENGTH = 15  # s; of the next step of a crowd
    CROWD_TRAVEL = 16  # m; how far particles may go in it
    CROWD_TOLERANCE = 17  # m; by which pairs may close beyond their room
    CROWD_LOSS = 18  # J; by the impacts in it
    STRONGEST = 19  # m/s²; the largest `pull`
    BY = 20  # s; when the steps that are taken now have to end
    ROOM = 21  # m; how far particles may move while nothing can meet
    FASTEST = 22  # m/s; of them, in that time
    UNCLOSED = 23  # of a radius; how far contacts were left open, or in one another, at most


class Tried(IntEnum):
    """Rows of `Driven.search`, of each contact."""

    FORCES = 0  # N; tried now
    LEAST = 1  # m; the gap at the start, if particles are in one another
    GAP = 2  # m; the gap beyond that at the end
    ALLOWED = 3  # m; of it
    OLD_FORCES = 4
    OLD_GAP = 5
    FOUND = 6  # N; the next forces
    SCALE = 7
    OFFSET = 8


class Driven(NamedTuple):
    """Driven particles, n of them, the obstacles after them, and the step that they are in the midst of.

    Of the document: position, span, weight (inverse mass, 1/kg, 0 where held), shape (n + obstacles, 2); radius, size
    (the radius, ∞ for obstacles), restitution, node (1: of a structure), shape (n + obstacles,); loose: the particles
    that are no nodes; asleep, and pull, acceleration by constant forces (m/s²), shape (n,).
    Of the list, whose arrays have room for p pairs, of which Whole.LISTED are there: near: the particles in pairs, shape
    (n,); pairs, rows i < j in ascending order, shape (p, 2), and of each pair lasting (1: a persistent contact),
    forces (N), normal, slow (speed below which it stays in contact, m/s), rate (at which it opens, m/s); listed:
    displacements when it was made, margin (m): how far each particle may move from there, negative: there is no list.
    Of the step: before, velocity: the state it begins with; ahead, ahead_speed: where it leads, as foreseen;
    acceleration, at its start; path_error (m); support: contact forces (kN); kept: control and account at the start.
    Of the search for contact forces: chosen, the pairs in persistent contact; search, with the rows of Tried; start, end:
    their normals at both ends of the step; block: the first contact of its block and the one after the last, as only
    contacts of particles that others connect depend on one another; slope, learnt (m/N); matrix, sides: work space.
    Of crowds: of each pair room, the gap at the start, if it is one (m), pushes, forces that are tried (N), and impulses
    (N·s).
    Of impacts: group, report; touching: the pairs that touch; parent, chain: work space, by which they are grouped.
    """

    position: Floats
    span: Floats
    weight: Floats
    radius: Floats
    size: Floats
    restitution: Floats
    node: Integers
    loose: Integers
    asleep: NDArray[np.bool_]
    pull: Floats
    near: Integers
    pairs: Integers
    lasting: Integers
    forces: Floats
    normal: Floats
    slow: Floats
    rate: Floats
    room: Floats
    pushes: Floats
    impulses: Floats
    listed: Floats
    margin: Floats
    before: Floats
    velocity: Floats
    ahead: Floats
    ahead_speed: Floats
    acceleration: Floats
    path_error: Floats
    support: Floats
    kept: Floats
    chosen: Integers
    search: Floats
    start: Floats
    end: Floats
    slope: Floats
    learnt: Floats
    matrix: Floats
    block: Integers
    sides: Integers
    group: Group
    report: Report
    touching: Integers
    parent: Integers
    chain: Integers
    whole: Integers
    real: Floats

    @classmethod
    def empty(cls, of_document: Mapping[str, Any], n: int, pairs: int, contacts: int) -> Driven:
        """Arrays of n particles, of which some are given, with room for so many pairs and persistent contacts."""
        every = len(of_document["radius"])
        shapes: dict[str, tuple[tuple[int, ...], Any]] = {
            "near": ((n,), np.int64),
            "pairs": ((pairs, 2), np.int64),
            **dict.fromkeys(("lasting", "touching", "chain"), ((pairs,), np.int64)),
            **dict.fromkeys(("forces", "slow", "rate", "room", "pushes", "impulses"), ((pairs,), np.float64)),
            "normal": ((pairs, 2), np.float64),
            **dict.fromkeys(
                ("listed", "before", "velocity", "ahead", "ahead_speed", "acceleration", "support"),
                ((n, 2), np.float64),
            ),
            **dict.fromkeys(("margin", "path_error"), ((n,), np.float64)),
            "kept": ((len(Account) + len(Control),), np.float64),
            "chosen": ((contacts,), np.int64),
            "search": ((len(Tried), contacts), np.float64),
            **dict.fromkeys(("start", "end"), ((contacts, 2), np.float64)),
            **dict.fromkeys(("slope", "learnt"), ((contacts, contacts), np.float64)),
            "matrix": ((contacts, contacts + 1), np.float64),
            "block": ((2, contacts), np.int64),
            "sides": ((2, contacts), np.int64),
            "parent": ((every,), np.int64),
            "whole": ((len(Whole),), np.int64),
            "real": ((len(Real),), np.float64),
        }
        arrays = {name: np.zeros(shape, dtype) for name, (shape, dtype) in shapes.items()}
        arrays["parent"][:] = NONE
        return cls(
            **of_document,
            **arrays,
            group=Group.empty(max(every, 2 * pairs), pairs),
            report=Report.empty(4 * pairs + 64),
        )


class Listing(NamedTuple):
    """What the pairs of Driven are listed by; see kernels/neighbours.py.

    first, partners: the particles that rods join, as in Constraints. found: work space, pairs, shape (p, 2).
    """

    first: Integers
    partners: Integers
    found: Integers
    grid: Grid
