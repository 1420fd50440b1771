"""Settling: the equilibria of a structure while its load grows slowly through given factors.

Rods are elastic and perfectly plastic. In exact geometry settling follows the path of equilibria from the present state.
Where the path ends (a limit point, a bifurcation, too many rods yielding) it reports the event with its load and
moves on to the next stable equilibrium, if there is one.

First-order theory is about the original positions, and linear while no rod yields, slackens or tightens: then one
solution of K u = f with K factored once is the answer, so that diagrams of a frame follow the hand that edits it
(99 rods: 4 ms; 10 ms as a path). From event to event the same path is followed as in exact geometry.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import ROUND_OFF, Array
from pinjoint.components.field import LARGEST, FieldError
from pinjoint.components.language import begun, joined, marked, plural, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.rod import beside_thrust, extensible_elsewhere
from pinjoint.components.theory import EXACT
from pinjoint.components.wording import brief, quoted
from pinjoint.systems.statics.bending import needed_parts
from pinjoint.systems.statics.contacts import Discs, Sinking
from pinjoint.systems.statics.equations import SOFT, Structure, largest, normalised
from pinjoint.systems.statics.events import Event, NoEquilibrium
from pinjoint.systems.statics.explain import (
    describe_motion,
    divide_named,
    listed,
    nothing_stops,
    rod_names,
    slack_named,
)
from pinjoint.systems.statics.external import External, loose_bodies
from pinjoint.systems.statics.factor import SURELY_HELD, regular, soft_modes, softest
from pinjoint.systems.statics.follow import Path, Point
from pinjoint.systems.statics.loading import Loading, first_order_mechanism
from pinjoint.systems.statics.relax import BALANCED
from pinjoint.systems.statics.response import of_axes
from pinjoint.systems.statics.state import NEUTRAL, STABLE, UNSTABLE, Start, StaticState
from pinjoint.systems.statics.theory import FirstOrder

LARGEST_GROWTH, SMALLEST_GROWTH = 1 / 16, 1 / 1024  # shares by which lack of fit grows where rods yield by it
MOST_TOLD, MOST_HINGES = 3, 8  # events in an account besides the message, and plastic hinges
# Kinds of events that messages repeat.
TOLD = ("free body", "mechanism", "plastic mechanism", "snap-through", "bifurcation", "note")
NEARLY_SOFT = 1e-9  # of the rods' stiffness: a note about a motion that is resisted less
UNBALANCED = 1e-6  # of the largest force: a larger unbalanced force is no equilibrium
UNCHANGED = 1e-12  # of the load: a smaller change is round-off
MOST_DISCS = 250  # without rods; more would take minutes
IN_ONE_PLACE = 0.75  # of the sum of their radii: forces hardly part discs that overlap by more
THRUST = 0.15  # of the axial strength, above which a plastic moment is less
HELD = 1e-3  # of the forces that hold a state: a smaller difference from a scaled load counts as none


@dataclass(frozen=True, repr=False)
class Settlement:
    """One state per load factor, up to the first that is no equilibrium."""

    __repr__ = brief

    states: tuple[StaticState, ...]

    @property
    def final(self) -> StaticState:
        """The last state."""
        return self.states[-1]

    @property
    def equilibrium(self) -> StaticState:
        """The last state. Raises NoEquilibrium where it is none."""
        if not self.final.balanced:
            raise NoEquilibrium(self.status, self.message)
        return self.final

    @property
    def status(self) -> str:
        """Status of the last state."""
        return self.final.status

    @property
    def message(self) -> str:
        """The messages of all states, each once; "" if there are none."""
        return joined(dict.fromkeys(state.message for state in self.states))

    @property
    def account(self) -> str:
        """The plastic hinges in order, the message, or else the status, and the first of the other events."""
        hinges = [event for event in self.events if event.kind == "hinge"]
        others = [e.message for e in self.events if e.message not in self.message and e.kind != "hinge"]
        more = len(others) - MOST_TOLD
        said = [self.message or tr("Result: {status}.", status=tr(self.status))]
        if hinges:
            places = [
                joined([listed([e.place["particle"]]), "×", written.given(e.load_factor, 4)]) for e in hinges
            ]
            places[MOST_HINGES:] = ["…"] * (len(hinges) > MOST_HINGES)
            said.insert(0, tr("Plastic hinges by load factor: {places}.", places=joined(places, ", ")))
        said += others[:MOST_TOLD]
        return joined(
            [*said, plural("And one more event.", "And {count} more events.", more) if more > 0 else ""]
        )

    @property
    def events(self) -> tuple[Event, ...]:
        """The events of all states, in order."""
        return tuple(event for state in self.states for event in state.events)

    def beside(self, left_out: Sequence[str]) -> tuple[str, str]:
        """The status where laws of mods, these by name, are left out, and the sentence that names them; "" if none are."""
        if not left_out:
            return self.status, ""
        status = marked("equilibrium without mods") if self.status == "equilibrium" else self.status
        return status, tr("The equilibrium leaves out the laws of mods: {laws}.", laws=", ".join(left_out))


def settle(
    model: Model, factors: Sequence[float] | float = (1.0,), theory: str = EXACT, start: Start | None = None
) -> Settlement:
    """The equilibria at these load factors in turn, from a state (None: the present one, supports settled by loads).

    Factors multiply forces and loads; accelerations grow from 0 to 1 with the first factor and then stay.
    In a model that has not moved yet, lack of fit and moved supports act before the load; in any other model the
    forces that hold its present state are exchanged for the load, and load factors on the way count both.
    Ends early, with the status "mechanism", "collapse" or "limit reached", where there is no further equilibrium.
    theory: "first-order" about the original positions, with the same yielding, or "exact".
        It begins at the original positions: of the state only moved supports and plastic strain count.
    Raises FieldError for numbers too large or too small to compute with, ValueError for no load factors.
    """
    wanted = _factors(factors)
    problem = incomputable(model)
    if problem:
        raise FieldError(problem)
    start = start or Start.of(model)
    settling = _Settling(model, theory, start)
    found = settling.through(wanted)
    if theory == EXACT and model.settings.collisions:
        discs = Discs.of(model, start.displacement)
        if len(discs.radius) > 1 and _touch(settling, discs, wanted, found, start):
            return _SettlingWithDiscs(model, discs, start).through(wanted)
    return found


def _touch(
    settling: _Settling, discs: Discs, factors: Sequence[float], found: Settlement, start: Start
) -> bool:
    """True if a body without supports is pulled that others may hold, if discs overlap that did not at the beginning, or if
    they move so far that they may pass an obstacle."""
    loads = map(settling.external.at, factors)
    loose = [body for load in loads for body in loose_bodies(settling.structure, load)]
    if any(body.pull and len(body.particles) < len(discs.radius) for body in loose):
        return True
    places = [state.displacement for state in found.states]
    farthest = max(np.hypot(*(end - start.displacement).T).max(initial=0.0) for end in places)
    passes = len(discs.obstacles) and farthest > discs.smallest
    return bool(passes) or any(len(discs.touching(displacement)) for displacement in places)


def _factors(given: Sequence[float] | float) -> list[float]:
    try:
        factors = np.atleast_1d(
            np.empty(0) if isinstance(given, str | bool) else np.asarray(given, dtype=float)
        )
    except (TypeError, ValueError):
        factors = np.empty(0)
    if factors.ndim != 1 or len(factors) == 0 or not np.isfinite(factors).all():
        raise WrongValue(
            "Load factors are {value}; give at least one finite number, such as (1.0, 0.0).",
            value=quoted(given),
        )
    for factor in factors[np.abs(factors) > LARGEST].tolist()[:1]:
        raise FieldError(
            "The load factor {factor:g} is too large to compute with; make it at most {largest:g}.",
            factor=factor,
            largest=LARGEST,
        )
    return factors.tolist()


class _Settling:
    """A structure on its way through the load factors: its last equilibrium and the load that holds it there."""

    def __init__(self, model: Model, theory: str, start: Start) -> None:
        self.model = model
        self.structure = Structure.of(model, theory)
        self.external = External.of(model, theory)
        elsewhere = extensible_elsewhere(model) if theory == EXACT else ""
        notes = [*self.external.notes, *([elsewhere] if elsewhere else [])]
        self.events = [Event("note", 0.0, note) for note in notes]
        self.looked_for_bodies = self.soft = self.thrust_noted = False
        self.slender = np.zeros(model.rods.count, dtype=bool)
        self.begun = permanent = self.structure.yielding_parts(start.permanent)
        at_rest = Path(self.structure, self._nothing, self._nothing)
        place = self.structure.field(start.displacement, start.rotation)
        if self.structure.first_order:
            place = self.structure.of_supports(place)
        self.supports = place
        self.point = at_rest.start(place, permanent)
        self.largest = self.structure.largest_force(self.point.response)
        if self.largest > 0.0 and self.structure.first_order:
            with suppress(NoEquilibrium):  # of a mechanism: under load it is told of
                self.point = self._elastic(self._nothing, 0.0, permanent) or self.point
        yields = (self.point.plastic_strain != permanent).any()
        if yields and not self.structure.gather(self.point.displacement).any():
            self.point = self._grown() or self.point
        if not self.structure.first_order:
            self.largest = self.structure.largest_force(self.point.response)
        self.load = self._holding()
        self.factor = self.share = self._held_factor()
        if self.share:
            self.load = self.load - self.share * self._carried()
            at_present = Path(self.structure, self._nothing, self._nothing, (self.share, self.share))
            self.point = at_present.start(self.point.displacement, permanent)
        self.slack = of_axes(at_rest.branches(self.point.response).slack)

    def _grown(self) -> Point | None:
        """The equilibrium without load once lack of fit, warmth and moved supports have grown; None if there is none.

        Joints move as rods yield on the way: with all joints held at first, rods would yield that never do. Where a part
        is too large for that, too, it is begun from where joints would be if no rod yielded.
        """
        elastic = self.structure.unyielding
        moved, share, step = self.point.displacement, 0.0, LARGEST_GROWTH
        point = Point(0.0 * moved, self.begun, 0.0, self.point.response, 0.0)
        while share < 1.0 and step > SMALLEST_GROWTH:
            further = min(share + step, 1.0)
            path = Path(self.structure.grown(further), self._nothing, self._nothing)
            held = moved - self.structure.of_unknowns(moved)
            known = self.structure.of_unknowns(point.displacement) + further * held
            found = path.correct(point, known, 0.0, None)
            if found is None:
                unyielding = Path(elastic.grown(further), self._nothing, self._nothing)
                near = unyielding.correct(point, known, 0.0, None)
                found = None if near is None else path.correct(point, near.displacement, 0.0, None)
            if found is None:
                step *= 0.5
            else:
                point, share, step = found, further, min(2.0 * step, LARGEST_GROWTH)
        return point if share == 1.0 else None

    @cached_property
    def _theory(self) -> FirstOrder:
        """First-order theory of the structure while its cables are taut."""
        structure = self.structure
        if structure.sense.any():
            structure = replace(structure, sense=np.zeros_like(structure.sense))
        return FirstOrder(self.model, structure)

    def _elastic(self, load: Array, share: float, plastic_strain: Array) -> Point | None:
        """By first-order theory the equilibrium under a load, with this plastic strain; None if not all rods are elastic."""
        moved, response = self._theory.equilibrium(load, self.supports, plastic_strain, share, self.structure)
        if response.soft.any():
            return None
        return Point(moved, plastic_strain, 1.0, response, self.point.dissipated)

    @property
    def _nothing(self) -> Array:
        return np.zeros(self.structure.unknown.shape)

    def _holding(self) -> Array:
        """The forces in free directions that hold the present state."""
        held = self.structure.of_unknowns(self.structure.internal(self.point.response))
        of = self.structure.largest
        greatest = max(of(self.external.at(1.0)), self.largest)
        return held if of(held) > BALANCED * greatest else self._nothing

    def _carried(self) -> Array:
        """What whole distributed forces would add, in free directions, to the particles' forces if nothing flowed now."""
        response = self.point.response
        return self.structure.of_unknowns(self.structure.carried(response, np.zeros_like(response.soft)))

    def _held_factor(self) -> float:
        """The load factor of the forces that hold the present state; 0 if they are no scaled load."""
        if not self.load.any():
            return 0.0
        scaled = self.structure.of_unknowns(self.external.scaled) + self._carried()
        size = float((scaled * scaled).sum())
        factor = float((self.load * scaled).sum()) / size if size > 0.0 else 0.0
        return factor if largest(self.load - factor * scaled) <= HELD * largest(self.load) else 0.0

    def through(self, factors: Sequence[float]) -> Settlement:
        """The states at these load factors in turn, up to the first that is no equilibrium."""
        states: list[StaticState] = []
        for factor in factors:
            states.append(self.to(factor))
            if not states[-1].balanced:
                break
        return Settlement(tuple(states))

    def to(self, factor: float) -> StaticState:
        """The state at a load factor."""
        target = self.external.at(factor)
        message = ""
        try:
            self._check_bodies(target, factor)
            if self.load.any() and not self.structure.gather(self.point.displacement).any():
                self._change(self._nothing, self.factor, 0.0)
            self._change(target, factor, factor)
            status = self._stability(factor)
            self._check_balance(factor)
            self._note_slender(factor)
            self._note_thrust(factor)
        except NoEquilibrium as end:
            status, message = end.status, str(end)
            if end.motion is not None:
                self.events.append(Event(status, self.factor, message, motion=end.motion))
        return self._state(status, message)

    def _change(self, target: Array, factor: float, share: float) -> None:
        """Exchange the load for a target, and for so much of the distributed forces, which has this load factor."""
        if self.structure.first_order and not self.point.response.slack.any():
            elastic = self._elastic(target, share, self.point.plastic_strain)
            if elastic is not None:  # and so at every load between
                self.point, self.load, self.factor, self.share = elastic, target, factor, share
                return
        self._check_extensible()
        change = target - self.load
        exchanged = change + (share - self.share) * self._carried()
        if largest(exchanged) <= UNCHANGED * largest(target):
            path = Path(self.structure, target, self._nothing, (share, share))
        else:
            path = Path(self.structure, self.load, change, (self.share, share))
        total = float(np.hypot(*self.external.scaled[:, :2].T).sum())
        start, way = replace(self.point, t=0.0), (self.factor, factor)
        unstressed, known = not self.load.any(), (self.events, start, self.slack, self.begun)
        loading = Loading(self.model, path, way, total, unstressed, *known)
        try:
            self.point = loading.run()
            self.load, self.factor, self.share = target, factor, share
        except NoEquilibrium:
            self.point, t = loading.point, loading.point.t
            self.load, self.factor, self.share = path.load(t), loading.factor(t), path.share(t)
            raise
        finally:
            self.slack = loading.slack

    def _check_extensible(self) -> None:
        """Raise NoEquilibrium where rods are inextensible, which only the answer at once knows."""
        if len(rows := self.structure.inextensible):
            message = tr(
                "Inextensible rods, such as {rods}, are computed only while all others are elastic and all cables taut."
                " Switch yielding off, or let these rods have their EA.",
                rods=rod_names(self.model, rows[:1]),
            )
            raise NoEquilibrium("limit reached", message)

    def _stability(self, factor: float) -> str:
        """The kind of equilibrium; a motion against so little stiffness that few digits are certain is reported."""
        structure = self.structure
        if structure.size == 0:
            return STABLE
        known = any(event.kind in ("mechanism", "plastic mechanism") for event in self.events)
        if self._is_held():
            self.soft = self.soft or known
            return STABLE
        energy, mode = softest(structure, self.point.response)
        share = energy if structure.bending is None else energy / structure.effort(mode, self.point.response)
        kind = NEUTRAL if share < SOFT else STABLE
        if share < NEARLY_SOFT and not (known or self.soft):
            motion = structure.spread(mode)
            moving = describe_motion(self.model, motion[None])
            if kind == NEUTRAL:
                message = tr(
                    "Neutral equilibrium: nothing resists moving {motion}, so this is only one of many positions of rest."
                    " Add a support or a rod there if that is not intended.",
                    motion=moving,
                )
            else:
                message = tr(
                    "Nearly a mechanism: only {share:.1g} of the stiffness of the rods resists moving {motion}, so only"
                    " about {digits} digits of the results are certain.",
                    share=share,
                    motion=moving,
                    digits=int(np.log10(share / ROUND_OFF)),
                )
            message = joined([message, slack_named(self.model, self.point.response.slack)])
            self.events.append(Event("note", factor, message, motion=normalised(motion)))
        self.soft = self.soft or known or share < NEARLY_SOFT
        return kind

    def _is_held(self) -> bool:
        """True if all motions are resisted by far, found six times as fast as the softest of them."""
        structure, response = self.structure, self.point.response
        if structure.first_order and not response.soft.any():
            return self._theory.held
        return regular(structure.tangent(response, response.soft), structure.weight, -SURELY_HELD).definite

    def _check_balance(self, factor: float) -> None:
        """Report forces that rounding leaves unbalanced. Raises NoEquilibrium if they are many."""
        residual = self._residual()
        if residual <= BALANCED:  # else a note says so
            return
        springs, called = self.structure.stiffness / self.structure.rest_length, "EA/L₀"
        if self.structure.bending is not None:
            rods, called = self.model.rods, tr("EA/L₀ or 12 EI/L₀³")
            bent = rods.turning_shares.any(axis=1)
            across = 12.0 * rods.bending_stiffness / rods.rest_length**3
            springs = np.concatenate([springs, across[bent]])
        message = tr(
            "Rounding leaves {share:.1g} of the largest force unbalanced, because very soft and very stiff rods are joined"
            " ({stiffness} from {least:.3g} to {most:.3g} kN/m). Make their stiffnesses less unequal.",
            share=residual,
            stiffness=called,
            least=springs.min(),
            most=springs.max(),
        )
        if residual > UNBALANCED:
            beyond = tr("The computer's numbers do not have enough digits for this model.")
            raise NoEquilibrium("limit reached", joined([beyond, message]))
        self.events.append(Event("note", factor, message))

    def _residual(self) -> float:
        """The largest unbalanced force over the largest force so far."""
        structure, response = self.structure, self.point.response
        self.largest = max(self.largest, structure.largest(self.load), structure.largest_force(response))
        return structure.unbalanced(response, self.load) / self.largest if self.largest > 0.0 else 0.0

    def _note_slender(self, factor: float) -> None:
        """Report, once, the rods that bend more than one cubic follows."""
        response, rods = self.point.response, slice(self.model.rods.count)
        if response.bent is None or self.structure.first_order:
            return
        parts = needed_parts(self.model, response.axial_force[rods], response.bent.slopes[rods])
        rows = np.flatnonzero((parts > 1) & ~self.slender)
        if len(rows):
            self.slender[rows] = True
            self.events.append(Event("note", factor, divide_named(self.model, rows, parts)))

    def _note_thrust(self, factor: float) -> None:
        """Report, once, the axial forces beside which plastic moments are less than those that hinges heed."""
        rods, structure = slice(self.model.rods.count), self.structure
        if self.thrust_noted or not structure.ends_yield:
            return
        response = self.point.response
        force, hinges = response.axial_force[rods], structure.at_limit(response)[rods, 1:].any(axis=1)
        share = np.maximum(force / structure.tension_limit[rods], -force / structure.compression_limit[rods])
        over = np.flatnonzero((share > THRUST) & hinges)
        if len(over):
            self.thrust_noted = True
            most = over[share[over].argmax()]
            message = tr(
                "{rod} bears {share} of its strength by its axial force, which lowers its plastic moment to about {left};"
                " plastic hinges do not heed that. Compare M_p reduced by N in the table of results.",
                rod=begun(rod_names(self.model, np.array([most]))),
                share=written.share(share[most]),
                left=written.share(float(beside_thrust(share[most]))),
            )
            self.events.append(Event("note", factor, message, (self.model.rods.names[most],)))

    def _check_bodies(self, target: Array, factor: float) -> None:
        """Report bodies that nothing holds along an axis. Raises NoEquilibrium if one is pulled along it."""
        for body in loose_bodies(self.structure, target):
            if body.pull or not self.looked_for_bodies:
                event = body.event(self.model, factor)
                self.events.append(event)
                if body.pull:
                    raise NoEquilibrium("mechanism", event.message)
        self.looked_for_bodies = True

    def _state(self, status: str, message: str) -> StaticState:
        told = [message] if message else [e.message for e in self.events if e.kind in TOLD]
        state = StaticState.of(
            self.model,
            self.structure,
            self.point.response,
            self.point.displacement,
            self.load,
            load_factor=self.factor,
            dissipated_plastic=self.point.dissipated,
            acting=self.external.at(self.factor),
            residual=self._residual(),
            status=status,
            message=joined(told),
            events=tuple(self.events),
        )
        self.events.clear()
        return state


class _SettlingWithDiscs(_Settling):
    """Settling with discs that rest on one another and on the structure, under each whole load at once."""

    def __init__(self, model: Model, discs: Discs, start: Start) -> None:
        super().__init__(model, EXACT, start)
        self.discs = discs
        self.structure = self.bare = discs.beside(self.structure)
        self.point = replace(self.point, displacement=self._all(self.point.displacement))
        self.load, self.factor, self.share, self.outcome = self._nothing, 0.0, 0.0, ""

    def _all(self, field: Array) -> Array:
        """A field over the particles (n, …) as one over particles and obstacles."""
        return np.concatenate([field, np.zeros((len(self.discs.radius) - len(field), field.shape[1]))])

    def _particles(self, field: Array) -> Array:
        """The particles' part of a field over particles and obstacles."""
        return field[: self.model.particles.count]

    def _change(self, target: Array, factor: float, share: float) -> None:
        alone = int(self.discs.is_alone.sum())
        if alone > MOST_DISCS:
            raise NoEquilibrium(
                "limit reached",
                tr(
                    "Finding equilibrium takes at most {most} particles without rods; here there are {count}. Run the model"
                    " until rest instead.",
                    most=MOST_DISCS,
                    count=alone,
                ),
            )
        self._check_apart()
        target = self._all(target)
        sinking = Sinking(self.bare, self.discs, target, self.point, share)
        outcome = sinking.run()
        if outcome == "gave up":
            message = tr("No equilibrium of the particles was found. Run the model until rest instead.")
            raise NoEquilibrium("limit reached", message)
        if outcome == "falls":
            motion = self._particles(sinking.point.displacement - self.point.displacement)
            message = nothing_stops(self.model, motion)
            self.events.append(Event("free body", factor, message, motion=normalised(motion)))
            raise NoEquilibrium("mechanism", message)
        if self.structure is self.bare:
            self._note_mechanism(sinking.point)
        self.structure, self.point = sinking.path.structure, sinking.point
        self.load, self.factor, self.share = target, factor, share
        self.outcome = outcome

    def _check_apart(self) -> None:
        """Raise NoEquilibrium if two discs are so nearly in one place that no direction parts them."""
        pairs = self.discs.touching(self.point.displacement)
        share = -self.discs.gap(self.point.displacement, pairs) / self.discs.radius[pairs].sum(axis=1)
        for first, second in pairs[share > IN_ONE_PLACE][:1].tolist():
            names = [*self.model.particles.names, *self.discs.obstacles.names]
            raise NoEquilibrium(
                "limit reached",
                tr(
                    "{one} and {other} are nearly at the same place, so it is not clear which way they should move apart."
                    " Move one of them, or run the model.",
                    one=names[first],
                    other=names[second],
                ),
            )

    def _note_mechanism(self, found: Point) -> None:
        """Report the mechanisms of the rods alone."""
        bare, start = self.bare, self.point
        modes = soft_modes(bare.tangent(start.response, start.response.soft), bare.weight)
        if modes.shape[1] > 0:
            fields = bare.fields(modes)[:, : self.model.particles.count]
            slack, places = start.response.slack, map(self._particles, (start.displacement, found.displacement))
            self.events.append(first_order_mechanism(self.model, self.factor, fields, slack, *places))

    def _check_bodies(self, target: Array, factor: float) -> None:
        """None: loose bodies move until something is in their way."""

    def _stability(self, factor: float) -> str:
        """Whether the least push ends the balance; that discs roll on one another without resistance is usual."""
        if self.outcome != "unstable":
            return STABLE
        motion = self._particles(self.structure.spread(softest(self.structure, self.point.response)[1]))
        message = tr(
            "Unstable equilibrium: the slightest push moves {motion} further and further. Add a support or an obstacle there"
            " if that is not intended.",
            motion=describe_motion(self.model, motion[None]),
        )
        self.events.append(Event("note", factor, message, motion=normalised(motion)))
        return UNSTABLE
