"""One change of the load on a structure: increments, yields, and jumps where stability is lost."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import Array, Flags
from pinjoint.components.field import ENDS
from pinjoint.components.language import begun, joined, marked, plural, tr
from pinjoint.components.model import Model
from pinjoint.systems.statics.equations import SOFT, Structure, largest, normalised
from pinjoint.systems.statics.events import Event, NoEquilibrium
from pinjoint.systems.statics.explain import (
    describe_motion,
    hinges_named,
    listed,
    moved,
    rod_names,
    slack_named,
)
from pinjoint.systems.statics.factor import NO_STIFFNESS, is_stable, regular, softest, unresisted
from pinjoint.systems.statics.follow import HALF, NARROWINGS, Path, Point, Tangent
from pinjoint.systems.statics.relax import LARGEST_PLASTIC_ROTATION, RUNAWAY, STEPS, relax, torn
from pinjoint.systems.statics.response import of_axes, of_rods

BEYOND = 1e-6  # of the change of load, by which a jump begins beyond a loss of stability
_FIRST_LOAD = 1 / 64  # of the change of load, under which a first-order mechanism takes its shape
_UNEXCITED = 1e-6  # share of a mode in the response to the load, below which the load does not excite it
STALLED = 0.05  # of a rod's length: a shorter jump counts as a stall
_MOST_STALLS = 2
PASSING = 1000  # steps of relaxing under hardly more load before the whole load is tried
_MOST_INCREMENTS = 20000


@dataclass
class Loading:
    """One change of the load on a model, along a path.

    factors: load factors at its start and end. total: Σ |force| at the load factor 1 (kN).
    unstressed: no force acts at the start, so that any soft motion there is a mechanism.
    events: those so far, to which `run` adds. slack: cables known to be slack. begun: plastic strain before any load.
    """

    model: Model
    path: Path
    factors: tuple[float, float]
    total: float
    unstressed: bool
    events: list[Event]
    point: Point
    slack: Flags
    begun: Array
    stalls: int = field(init=False, default=0)
    mechanism: bool = field(init=False, default=False)

    def run(self) -> Point:
        """The equilibrium at the end of the change. Raises NoEquilibrium; `point` is the last good one."""
        tangent = self._begin()
        increment = np.inf
        for _ in range(_MOST_INCREMENTS):
            if self.point.t >= 1.0:
                return self.path.polished(self.point)
            self._note_cables(tangent)
            start = self.point, tangent
            tangent, increment = self._increment(tangent, increment)
            if self.path.structure.first_order:
                continue
            if largest(self.point.displacement[:, :2]) > RUNAWAY * self.path.structure.extent:
                motion = self.path.structure.spread(tangent.rate)
                if tangent.flowing.any():
                    raise self._collapse(tangent.flowing, motion)
                raise self._mechanism(motion, tangent.slack)
            if (beyond := self._torn(self.point)).any():
                self._narrow(*start)
                raise self._beyond_strains(beyond, self.path.structure.spread(tangent.rate))
        raise self._lost()

    # --- the start ---------------------------------------------------------------------------------

    def _begin(self) -> Tangent:
        """The tangent at the start; a mechanism first takes its shape under a small load."""
        path, structure = self.path, self.path.structure
        tangent = path.tangent(self.point)
        before = self.point
        modes = np.zeros((structure.size, 0))
        if self.unstressed:
            matrix = structure.tangent(before.response, tangent.soft)
            modes = unresisted(structure, before.response, matrix, tangent.factor)
        self.mechanism = modes.shape[1] > 0
        # No load: improve the equilibrium, or leave it if it is not stable.
        if not path.push(before.response, tangent.soft).any():
            found = path.correct(self.point, self.point.displacement, 1.0, None)
            if found is None or not tangent.stable:
                self._relax(1.0, None)
            else:
                self.point = found
        elif not tangent.stable or self._unresisted(tangent):
            self._relax(_FIRST_LOAD if self.unstressed else 1.0, None)
        if self.mechanism:
            slack, places = path.branches(before.response).slack, (before.displacement, self.point.displacement)
            event = first_order_mechanism(self.model, self.factor(0.0), structure.fields(modes), slack, *places)
            self.events.append(event)
        if self.point is not before:
            tangent = path.tangent(self.point)
        path.reference = path.size(tangent.rate)
        return tangent

    def _unresisted(self, tangent: Tangent) -> bool:
        """True if the load moves the structure against no more stiffness than round-off, and than what keeps it regular."""
        path, structure, rate = self.path, self.path.structure, tangent.rate
        push = path.push(self.point.response, tangent.soft)
        energy = float(rate @ push) - NO_STIFFNESS * float(structure.weight @ rate**2)
        return energy < SOFT * structure.effort(rate, self.point.response) + structure.round_off_of_energy(rate)

    # --- on the way ----------------------------------------------------------------------------------

    def _increment(self, tangent: Tangent, increment: float) -> tuple[Tangent, float]:
        """Take one increment; returns the tangent at its end and the increment to try next."""
        path, start = self.path, self.point
        increment = min(increment, (1.0 - start.t) * path.stretch(tangent))
        step = path.advance(start, tangent, increment)
        if step is None:
            return self._jump(tangent), np.inf
        found, following = step.point, step.tangent
        kept = following.stable or is_stable(path.structure, found.response, tangent.soft)
        if (following.stable and not self._unresisted(following)) or (kept and found.t >= 1.0):
            self._note_yields(tangent, found, following)
        elif kept and not np.array_equal(following.soft, tangent.soft):
            self._note_yields(tangent, found, following)
            self.point = found
            return self._jump(following), np.inf
        else:
            self.point, last, beyond = path.narrow(start, tangent, step)
            if beyond is None:
                self._note_yields(tangent, self.point, last)
                return last, HALF * step.taken
            return self._jump(beyond), np.inf
        self.point = found
        self._note_plastic_mechanism(tangent, following)
        return following, step.further

    def _note_yields(self, tangent: Tangent, found: Point, following: Tangent) -> None:
        """Report the rods that begin to yield."""
        new, t = of_axes((found.response.flowing | following.flowing) & ~tangent.flowing), found.t
        flows = tangent.flowing, found.response.flowing, following.flowing
        self.events += hinges_formed(self.model, self.path.structure, flows, self.factor(t), self.total)
        if not new.any():
            return
        force = found.response.axial_force
        said = [
            self._said_of(
                "{rods} yields in tension {at}.", "{rods} yield in tension {at}.", new & (force > 0.0), t
            ),
            self._said_of(
                "{rods} yields in compression {at}.",
                "{rods} yield in compression {at}.",
                new & (force < 0.0),
                t,
            ),
        ]
        self._tell("yield", t, joined(said), new)

    def _note_cables(self, tangent: Tangent) -> None:
        """Report the cables that go slack, or tighten again, and the struts that buckle, or become straight again."""
        present = of_axes(tangent.slack)
        given, back = present & ~self.slack, self.slack & ~present
        struts, t = self.path.structure.struts, self.point.t
        slack, taut, bent, straight = given & ~struts, back & ~struts, given & struts, back & struts
        for kind, rods, said in (
            ("slack", slack, self._said_of("{rods} goes slack {at}.", "{rods} go slack {at}.", slack, t)),
            ("taut", taut, self._said_of("{rods} becomes taut {at}.", "{rods} become taut {at}.", taut, t)),
            ("buckling", bent, self._said_of("{rods} buckles {at}.", "{rods} buckle {at}.", bent, t)),
            (
                "straight",
                straight,
                self._said_of("{rods} is straight again {at}.", "{rods} are straight again {at}.", straight, t),
            ),
        ):
            if said:
                self._tell(kind, t, said, rods)
        self.slack = present

    def _note_plastic_mechanism(self, tangent: Tangent, following: Tangent) -> None:
        """Report that only the forces of the rods hold the structure, no longer their stiffness."""
        structure = self.path.structure
        if self.mechanism or not (following.flowing & ~tangent.flowing).any():
            return
        if not self._is_plastic_mechanism(following):
            return
        self.mechanism = True
        motion = structure.spread(following.rate)
        told = {"at": self._at(self.point.t), "motion": describe_motion(self.model, motion[None])}
        if hinges := hinges_named(self.model, following.flowing):
            message = tr(
                "Plastic mechanism {at}, the collapse load of textbooks: with plastic hinges {hinges} nothing resists moving"
                " {motion}. Beyond it only large changes of shape carry more.",
                hinges=hinges,
                **told,
            )
        else:
            message = tr(
                "Plastic mechanism {at}, the collapse load of textbooks: so many rods yield that the others do not resist"
                " moving {motion}. Beyond it only large changes of shape carry more.",
                **told,
            )
        self._tell("plastic mechanism", self.point.t, message, following.flowing, motion)

    # --- loss of stability -----------------------------------------------------------------------------

    def _jump(self, beyond: Tangent) -> Tangent:
        """Go on from the last stable point to the next stable equilibrium, and report the jump."""
        path, critical = self.path, self.point
        structure = path.structure
        if (of_axes(beyond.slack) & ~self.slack & structure.struts).any():
            self._note_cables(beyond)
        plastic = bool(beyond.flowing.any()) and is_stable(path.structure, critical.response, beyond.slack)
        mode = self._mode(beyond)
        if plastic and structure.ends_yield and self._is_plastic_mechanism(beyond):
            raise self._collapse(beyond.flowing, structure.spread(mode))
        if self.mechanism and critical.t < _FIRST_LOAD and not plastic:
            self._relax(_FIRST_LOAD, mode)
        else:
            self._pass(critical, beyond, mode, plastic)
        change = path.structure.gather(self.point.displacement - critical.displacement)
        if path.structure.move(change, critical.response) < STALLED:
            self.stalls += 1
        if self.stalls > _MOST_STALLS:
            self._leap()
        return path.tangent(self.point)

    def _is_plastic_mechanism(self, tangent: Tangent) -> bool:
        """True if nothing but round-off, forces in a changing shape and their turning resists some motion: with plastic
        hinges in the original shape, to which textbooks hold."""
        structure = self.path.structure
        shape = structure.unmoved if structure.ends_yield else self.point.response
        matrix = structure.tangent(shape, tangent.soft, geometric=False)
        return not regular(matrix, structure.weight, -SOFT).definite

    def _pass(self, critical: Point, beyond: Tangent, mode: Array, plastic: bool) -> None:
        """Relax under hardly more load, or under the whole load if that does not end within PASSING steps."""
        try:
            self._relax(min(1.0, critical.t + BEYOND), mode, beyond if plastic else None, PASSING)
        except NoEquilibrium as reason:
            if reason.status != "limit reached":
                raise
            self._leap()
        else:
            self._note_jump(beyond, critical, mode)

    def _leap(self) -> None:
        """Relax a structure that hardly resists some motion under the whole load, off its path."""
        message = tr(
            "From the load factor {factor} on, there is a motion that the structure hardly resists. The load is"
            " therefore no longer increased step by step: the whole load acts at once, and the structure moves to"
            " equilibrium.",
            factor=written.number(self.factor(self.point.t)),
        )
        self._tell("note", self.point.t, message)
        self._relax(1.0, None)

    def _mode(self, beyond: Tangent) -> Array:
        """The motion in which stability is lost, in the direction of the jump."""
        structure, response = self.path.structure, self.point.response
        if beyond.factor.definite and beyond.flowing.any():
            return beyond.rate
        _, mode = softest(structure, response, beyond.soft)
        flow = structure.deformation_rates(mode, response) * np.sign(response.force) * beyond.flowing
        push = self.path.push(response, beyond.soft)
        pushed = float(mode @ push)
        lean = float(flow.sum()) if flow.any() else pushed
        if abs(pushed) <= _UNEXCITED * np.linalg.norm(mode) * np.linalg.norm(push):
            lean = float(mode[np.abs(mode).argmax()]) if not beyond.flowing.any() else lean
        return mode if lean >= 0.0 else -mode

    def _relax(self, t: float, nudge: Array | None, plastic: Tangent | None = None, steps: int = STEPS) -> None:
        """Move to the next stable equilibrium under the load at t. Raises NoEquilibrium if there is none."""
        start = self.point
        found, outcome = relax(self.path, self.path.after(start, start.displacement, t), nudge, steps)
        if outcome == "equilibrium":
            self.point = found
        elif outcome == "gave up":
            raise self._lost(found)
        elif not (found.plastic_strain != start.plastic_strain).any():
            way, slack = found.displacement - start.displacement, found.response.slack
            buckled = self.path.structure.buckled(slack)
            raise self._collapse(buckled, way) if buckled.any() else self._mechanism(way, slack)
        elif plastic is not None and nudge is not None:
            buckled = self.path.structure.buckled(plastic.slack)
            raise self._collapse(plastic.flowing | buckled, self.path.structure.spread(nudge))
        else:
            raise self._collapse(found.response.flowing, found.displacement - start.displacement)

    def _note_jump(self, beyond: Tangent, critical: Point, mode: Array) -> None:
        push = self.path.push(critical.response, beyond.soft)
        share = abs(float(mode @ push)) / (np.linalg.norm(mode) * np.linalg.norm(push))
        where = moved(self.model, critical.displacement, self.point.displacement)
        if beyond.sense > 0.0 and share < _UNEXCITED:
            kind = "bifurcation"
            message = marked(
                "Bifurcation: the equilibrium becomes unstable {at}, and the structure buckles to the next stable one:"
                " {where}. It moved to one side; it could just as well have moved to the other."
            )
        else:
            kind = "snap-through"
            message = marked(
                "Snap-through: the structure becomes unstable {at} and snaps to the next stable equilibrium: {where}."
            )
        yielded = self.point.plastic_strain != critical.plastic_strain
        rows = np.flatnonzero(of_rods(yielded))
        rods = tr("{rods} yielded on the way.", rods=begun(rod_names(self.model, rows))) if len(rows) else ""
        said = joined([tr(message, at=self._at(critical.t), where=where), rods])
        self._tell(kind, critical.t, said, yielded, self.path.structure.spread(mode))

    def _collapse(self, flowing: Flags, motion: Array) -> NoEquilibrium:
        rows, hinges = np.flatnonzero(of_axes(flowing)), hinges_named(self.model, flowing)
        told = {"at": self._at(self.point.t), "motion": describe_motion(self.model, motion[None])}
        told |= {"rods": rod_names(self.model, rows), "hinges": hinges}
        message = plural(
            "Plastic collapse {at}: {rods} yields and nothing else resists moving {motion}. Lower the load or strengthen"
            " this rod.",
            "Plastic collapse {at}: {rods} yield and nothing else resists moving {motion}. Lower the load or strengthen"
            " these rods.",
            len(rows),
            **told,
        )
        if hinges:
            message = tr(
                "Plastic collapse {at}: with plastic hinges {hinges} nothing resists moving {motion} any more. Lower the"
                " load or strengthen the members there.",
                **told,
            )
        if (of_axes(flowing) & self.slack).any():
            message = plural(
                "Collapse {at}: nothing resists moving {motion} while {rods} has buckled. Lower the load or stiffen"
                " this rod.",
                "Collapse {at}: nothing resists moving {motion} while {rods} yield or have buckled. Lower the load or"
                " stiffen these rods.",
                len(rows),
                **told,
            )
        earlier = next((event for event in self.events if event.kind == "plastic mechanism"), None)
        if earlier is not None:
            message = tr(
                "The changed shape gives way, too, {at}: nothing resists moving {motion} any more. The collapse load of"
                " textbooks, of the plastic mechanism in the original shape, is at the load factor {factor}.",
                factor=written.number(earlier.load_factor),
                **told,
            )
        self._tell("collapse", self.point.t, message, flowing, motion)
        return NoEquilibrium("collapse", message)

    def _torn(self, point: Point) -> Flags:
        """Of all that can yield, what has by more than any metal bears."""
        return torn(point.plastic_strain - self.begun)

    def _narrow(self, point: Point, tangent: Tangent) -> None:
        """Go from here only as far as no rod has torn."""
        increment = (self.point.t - point.t) * self.path.stretch(tangent)
        for _ in range(NARROWINGS):
            increment *= HALF
            tried = self.path.attempt(point, tangent, increment)
            if isinstance(tried, tuple) and not self._torn(tried[0]).any():
                point, tangent = tried
        self.point = point

    def _beyond_strains(self, rods: Flags, motion: Array) -> NoEquilibrium:
        """The end of a load that is still held, but by rods that no metal could be."""
        if of_axes(rods).any():
            rods = of_axes(rods)
        rows = np.flatnonzero(of_rods(rods))
        message = plural(
            "Beyond the load factor {factor}, {rods} yields by more than a tenth of its length, which is no result. Lower"
            " the load or strengthen this rod.",
            "Beyond the load factor {factor}, {rods} yield by more than a tenth of their length, which is no result. Lower"
            " the load or strengthen these rods.",
            len(rows),
            factor=written.number(self.factor(self.point.t)),
            rods=rod_names(self.model, rows),
        )
        if rods.ndim > 1:
            message = tr(
                "Beyond the load factor {factor}, the plastic hinges {hinges} turn by more than {most:g} rad, which is no"
                " result. Lower the load or strengthen the members there.",
                factor=written.number(self.factor(self.point.t)),
                hinges=hinges_named(self.model, rods),
                most=LARGEST_PLASTIC_ROTATION,
            )
        earlier = (event.message for event in self.events if event.kind == "plastic mechanism")
        message = joined([*earlier, message])
        self._tell("collapse", self.point.t, message, rods, motion)
        return NoEquilibrium("collapse", message)

    def _mechanism(self, motion: Array, slack: Flags) -> NoEquilibrium:
        """The end of a load that moves a mechanism, which has no equilibrium in first-order theory."""
        message = tr(
            "Mechanism: the load moves {motion} and nothing resists. Add rods or supports there.",
            motion=describe_motion(self.model, motion[None]),
        )
        message = joined([message, slack_named(self.model, slack)])
        self._tell("mechanism", self.point.t, message, motion=motion)
        return NoEquilibrium("mechanism", message)

    def _lost(self, point: Point | None = None) -> NoEquilibrium:
        message = tr(
            "No equilibrium was found beyond the load factor {factor}; the last one found is shown. Run the model in time,"
            " or apply the load in other steps.",
            factor=written.number(self.factor(self.point.t)),
        )
        slack = slack_named(self.model, point.response.slack) if point is not None else ""
        return NoEquilibrium("limit reached", joined([message, slack]))

    # --- words -------------------------------------------------------------------------------------

    def factor(self, t: float) -> float:
        """The load factor at t."""
        first, last = self.factors
        return last if t >= 1.0 else first + t * (last - first)

    def _at(self, t: float) -> str:
        return _at(self.factor(t), self.total)

    def _said_of(self, one: str, many: str, rods: Flags, t: float) -> str:
        """A sentence about one or many rods, at the load at t; "" about none."""
        if not (rows := np.flatnonzero(rods)).size:
            return ""
        return plural(one, many, len(rows), rods=begun(rod_names(self.model, rows)), at=self._at(t))

    def _tell(
        self, kind: str, t: float, message: str, rods: Flags | None = None, motion: Array | None = None
    ) -> None:
        """Add an event at t that concerns these rods and moves the structure in this way."""
        names = self.model.rods.column("name")
        concerned = () if rods is None else tuple(str(names[row]) for row in np.flatnonzero(of_rods(rods)))
        motion = None if motion is None else normalised(motion)
        self.events.append(Event(kind, self.factor(t), message, concerned, motion))


def hinges_formed(
    model: Model, structure: Structure, flows: tuple[Flags, Flags, Flags], factor: float, total: float = 0.0
) -> list[Event]:
    """The plastic hinges that form, but not that of ends at one joint another turns instead.

    flows: what yielded before, meanwhile, and from now on. total: Σ |force| at the load factor 1 (kN), to be told; or 0.
    """
    if flows[0].ndim == 1:
        return []
    ends, (before, meanwhile, following) = structure.ends, (flags[:, 1:] for flags in flows)
    new = following & ~before & ~np.isin(ends, ends[before & ~following])
    new |= meanwhile & ~before & ~np.isin(ends, ends[before | following])
    events = []
    for row, end in np.argwhere(new).tolist():
        rod, particle = model.rods.names[row], model.particles.names[ends[row, end]]
        message = tr(
            "A plastic hinge forms at {particle}, in {rod}, {at}.",
            particle=listed([particle]),
            rod=rod_names(model, np.array([row])),
            at=_at(factor, total),
        )
        place = {"particle": particle, "rod": rod, "end": ENDS[end]}
        events.append(Event("hinge", factor, message, (rod,), place=place))
    return events


def _at(factor: float, total: float) -> str:
    if total <= 0.0:
        return tr("at the load factor {factor}", factor=written.number(factor))
    force = written.force(abs(factor) * total)
    return tr("at the load factor {factor} ({force} in all)", factor=written.number(factor), force=force)


def first_order_mechanism(
    model: Model, factor: float, fields: Array, slack: Flags, before: Array, after: Array
) -> Event:
    """Event of motions (k, n, 2) that nothing resists without load; displacements (n, 2) without and under load."""
    message = tr(
        "First-order mechanism: without load nothing resists moving {motion}.",
        motion=describe_motion(model, fields),
    )
    if np.array_equal(before, after):
        advice = tr("Add rods or supports there if that is not intended.")
        message = joined([message, advice, slack_named(model, slack)])
    else:
        change = moved(model, before, after)
        message = joined(
            [message, tr("Under load it moves until another shape holds the load: {where}.", where=change)]
        )
    return Event("mechanism", factor, message, motion=normalised(fields[0]))
