"""The neighbour list of driven particles: its arrays, what the document and the state of a model say of it, its kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.clock import PersistentContacts
from pinjoint.components.field import Column, Role
from pinjoint.components.model import Model
from pinjoint.components.obstacles import obstacles
from pinjoint.components.particle import Particle
from pinjoint.components.rod import nodes
from pinjoint.systems.broad_phase import gaps
from pinjoint.systems.collision.columns import NONE, Grid, Integers
from pinjoint.systems.collision.driven.columns import Driven, Listing, Order, Phase, Real, Whole
from pinjoint.systems.collision.driven.kernels.neighbours import list_pairs
from pinjoint.systems.collision.driven.kernels.steps import collide
from pinjoint.systems.collision.system import fall_time, persistent_contacts
from pinjoint.systems.program.compiler import GeneratedModule, entries_to
from pinjoint.systems.program.entries import Account, Control
from pinjoint.systems.program.interpreter import in_lists

_CONTACTS = 8  # room at first
_STEP_SHARE = 0.04  # longest step of crowds: of the time in which a disc falls through its diameter
MORE, LEAST_ROOM = 1.5, 16  # times the pairs there are, and beyond that: room for those that come near later
_OF_PAIRS = (
    *("pairs", "lasting", "forces", "normal", "slow", "rate", "room", "pushes", "impulses"),
    *("touching", "chain", "group", "report"),
)
_OF_CONTACTS = ("chosen", "search", "start", "end", "slope", "learnt", "matrix", "block", "sides")


class NeighbourList:
    """The pairs of one model's particles that are near each other, in the arrays that the kernels share.

    driven, listing: these arrays; kernels list the pairs (driven/kernels/neighbours.py). count: of the particles. The
    numbers of obstacles follow those of the particles.
    """

    driven: Driven
    listing: Listing

    def __init__(self, model: Model) -> None:
        self.model = model
        self._revision = -1
        self._held: PersistentContacts | None = None
        self._is_stored = False

    # --- the document --------------------------------------------------------------------------------

    def look_up(self) -> None:
        """Read from the document which particles may collide, if the document changed."""
        revision = self.model.newest(Role.DOCUMENT)
        if self._revision == revision:
            return
        self._revision, self._held = revision, None
        particles = self.model.particles
        self.obstacles = obstacles(self.model)
        self.count = particles.count
        self._document = self._of_document()
        self.driven = Driven.empty(self._document, self.count, 0, _CONTACTS)
        every = self.count + len(self.obstacles)
        self.listing = Listing.empty(self.model.rods.between, every, self.count)
        self.driven.margin[:] = -1.0  # no pair is listed yet
        whole, real = self.driven.whole, self.driven.real
        whole[Whole.BOUNCY] = (self.driven.restitution < 1.0).any()
        whole[Whole.DAMPED] = self.model.rods.damping.any() or self.model.environment.drag > 0.0
        real[Real.LONGEST] = np.inf
        pull = self.driven.pull
        real[Real.CROWD_STEP] = _STEP_SHARE * fall_time(particles.radius, pull)
        real[Real.STRONGEST] = pull.max(initial=0.0)

    def _of_document(self) -> dict[str, Any]:
        """The arrays of Driven that follow from the document."""
        particles, others = self.model.particles, self.obstacles
        alike = np.full(self.count, self.model.settings.restitution)
        span = self.everywhere(np.zeros((self.count, 2)))
        span[self.count :] = others.span
        node = np.ones(self.count + len(others), dtype=np.int64)
        node[: self.count] = nodes(self.model)
        return {
            "position": np.concatenate([particles.position, others.start]),
            "span": span,
            "weight": self.everywhere(np.where(particles.fixed, 0.0, 1.0 / particles.mass[:, None])),
            "radius": np.concatenate([particles.radius, others.radius]),
            "size": np.concatenate([particles.radius, np.full(len(others), np.inf)]),
            "restitution": np.concatenate([alike, others.restitution]),
            "node": node,
            "loose": np.flatnonzero(node[: self.count] == 0),
            "asleep": self.model.tables["particles"].storage("asleep"),
            "pull": np.hypot(*(particles.mobility * particles.constant_force).T),
        }

    def everywhere(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the particles, followed by zeros for the obstacles, which do not move."""
        if len(self.obstacles) == 0:
            return np.ascontiguousarray(values)
        return np.concatenate([values, np.zeros((len(self.obstacles), *values.shape[1:]), values.dtype)])

    # --- the list ------------------------------------------------------------------------------------

    @property
    def pairs(self) -> Integers:
        """Those listed."""
        return self.driven.pairs[: self.driven.whole[Whole.LISTED]]

    def list_within(self, span: float) -> None:
        """List the pairs that can meet before any particle has moved by `span` (m) from where it is."""
        control, state = np.zeros(len(Control)), (self.displacement, self.velocity)
        control[Control.STEP_SIZE], self.driven.real[Real.SPAN] = self.model.clock.step_size, span
        while DRIVEN.form.list_pairs(self.driven, self.listing, control, *state) == Order.LEAVE:
            self.make_room()

    def make_room(self) -> None:
        """Make the room that was wanted: for pairs, to find them, or for twice as many persistent contacts."""
        whole = self.driven.whole
        if whole[Whole.FOUND] == NONE:
            grid = Grid.empty(self.count + len(self.obstacles), int(whole[Whole.LAYERS]) + 1)
            self.listing = self.listing._replace(grid=grid)
        elif whole[Whole.FOUND] > len(self.driven.pairs):
            self._make_room_for_pairs(int(whole[Whole.FOUND]))
        elif self.driven.lasting[: whole[Whole.LISTED]].sum() > len(self.driven.chosen):
            new = Driven.empty(self._document, self.count, 0, 2 * len(self.driven.chosen))
            self.driven = self.driven._replace(**{name: getattr(new, name) for name in _OF_CONTACTS})

    def _make_room_for_pairs(self, count: int) -> None:
        """Make room for more than `count` pairs; those listed stay."""
        old, listed = self.driven, int(self.driven.whole[Whole.LISTED])
        new = Driven.empty(self._document, self.count, int(MORE * count) + LEAST_ROOM, 0)
        for name in ("pairs", "lasting", "forces"):
            getattr(new, name)[:listed] = getattr(old, name)[:listed]
        self.driven = old._replace(**{name: getattr(new, name) for name in _OF_PAIRS})
        self.listing = self.listing._replace(found=np.empty_like(new.pairs))

    # --- persistent contacts ----------------------------------------------------------------------------

    def load_contacts(self) -> None:
        """Begin with the state of the model: take its persistent contacts, if they are others than were stored last."""
        driven, held = self.driven, persistent_contacts(self.model)
        known, self._is_stored = self._is_stored and held is self._held, False  # not stored: interrupted
        driven.whole[Whole.PHASE], driven.whole[Whole.EXAMINE] = Phase.BETWEEN, 0
        if self.model.clock.steps == 0:
            driven.whole[Whole.UNCLOSED], driven.real[Real.UNCLOSED] = 0, 0.0
        if known:
            return
        driven.lasting[:], driven.forces[:] = 0, 0.0
        driven.real[Real.LONGEST] = np.inf if held is None else held.longest_step
        self._held = held
        if held is None:
            return
        if len(held.pairs) > len(driven.pairs):
            self._make_room_for_pairs(len(held.pairs))
        driven, rows = self.driven, slice(len(held.pairs))
        order = np.lexsort(held.pairs.T[::-1])
        driven.pairs[rows], driven.lasting[rows], driven.forces[rows] = held.pairs[order], 1, held.forces[order]
        driven.whole[Whole.LISTED] = len(held.pairs)
        self.list_within(0.0)  # of these contacts, those of pairs that may collide go on

    def store_contacts(self) -> None:
        """Note the persistent contacts in the state of the model."""
        driven, held = self.driven, self._held
        rows = np.flatnonzero(driven.lasting[: driven.whole[Whole.LISTED]])
        longest = float(driven.real[Real.LONGEST])
        if len(rows) or held is not None:
            self._held = (
                PersistentContacts(driven.pairs[rows], driven.forces[rows], longest) if len(rows) else None
            )
            self.model.writable("clock.collision_state")[0] = self._held
        self._is_stored = True

    # --- how near ------------------------------------------------------------------------------------

    @property
    def displacement(self) -> Array:
        """Of the particles, now (m); not a read-only view, for which kernels are not compiled."""
        return self.model.tables["particles"].storage("displacement")

    @property
    def velocity(self) -> Array:
        """Of the particles, now (m/s)."""
        return self.model.tables["particles"].storage("velocity")


# --- the kernels -------------------------------------------------------------------------------------


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    """The source, and the kernels by the names that it calls them."""
    source, kernels = entries_to({"collide": collide, "list_pairs": list_pairs})
    layout = [_layout(arrays) for arrays in idle()]  # what is kept on disk is of no use for another
    return f"{source}# arrays: {layout}\n", kernels


def _layout(arrays: Any) -> Any:
    """The names, types and dimensions of arrays, in named tuples of their own where they are."""
    if isinstance(arrays, np.ndarray):
        return arrays.dtype.str, arrays.ndim
    return [(name, _layout(held)) for name, held in zip(arrays._fields, arrays, strict=True)]


def idle() -> tuple[Driven, Listing]:
    """Arrays of no particles, with which nothing can meet."""
    return Driven.empty({}, 0, 0, 0), Listing.empty(np.zeros((0, 2), dtype=np.int64), 0, 0)


def lasting_forces(model: Model) -> Column:
    """The forces of contacts on particles (kN) that last from the step that led to the present state."""
    contacts, particles = persistent_contacts(model), model.particles
    total = np.zeros((particles.count, 2))
    if contacts is not None:
        place, pairs = particles.position + particles.displacement, contacts.pairs
        _, normal = gaps(place, particles.radius, pairs, obstacles(model))
        push = normal * (0.001 * contacts.forces)[:, None]
        for d in range(2):
            # obstacles come after them
            total[:, d] = np.bincount(pairs[:, 1], push[:, d], len(total))[: len(total)]
            total[:, d] -= np.bincount(pairs[:, 0], push[:, d], len(total))
    return total


def _warm_up() -> None:
    """Call every compiled function once."""
    model, none = Model(), np.zeros((0, 2))
    model.create(Particle, 2, position=[(0.0, 0.0), (0.09, 0.0)], velocity=[(1.0, 0.0), (0.0, 0.0)])
    near = NeighbourList(model)
    near.look_up()
    near.list_within(0.0)
    DRIVEN.form.collide(idle()[0], np.zeros(len(Control)), np.zeros(len(Account)), none, none)


DRIVEN = GeneratedModule("driven_collisions", _contents, _warm_up)


def between_steps(*, compiled: bool) -> list[Any]:
    """What step programs call between their steps, in the form that they have: by address, so that it is compiled once."""
    if not compiled:
        return [in_lists(kernel) for kernel in (collide, list_pairs)]
    from pinjoint.systems.program.machine_code import addressed

    form = DRIVEN.form if DRIVEN.is_loaded else DRIVEN.load()
    return [addressed(form.collide), addressed(form.list_pairs)]
