"""Changing the load on a structure from one value to another: increments, yields, and what comes after
a loss of stability."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from components.model import Model
from systems.statics.equations import Array, Flags
from systems.statics.events import Event, NoEquilibrium
from systems.statics.explain import describe_motion, moved, rod_names, slack_named
from systems.statics.factor import SOFT, lowest_mode, regular, soft_modes
from systems.statics.follow import Path, Point, Tangent
from systems.statics.relax import RUNAWAY, STEPS, relax

BEYOND = 1e-6  # of the change of load: how far beyond a loss of stability the structure moves on
FIRST_LOAD = 1 / 64  # of the change of load, under which a first-order mechanism takes its shape
UNEXCITED = 1e-6  # share of a mode in the response to the load, below which the load does not excite it
STALLED = 0.05  # of a rod's length: a jump that leads no further has hardly changed anything
MOST_STALLS = 2
PASSING = 1000  # steps of relaxing under hardly more load before the whole load is tried
MOST_INCREMENTS = 20000
CRUSHED = -0.9  # plastic strain of a rod of which a tenth is left: soon its ends meet, and it has no direction


@dataclass
class Loading:
    """One change of the load on a model, along a path.

    factors: load factors at its start and end. total: Σ |force| at the load factor 1 (kN).
    unstressed: nothing acts at the start, so that whatever moves there is a mechanism.
    events: what happened so far; `run` adds to them. slack: cables known to be.
    """

    model: Model
    path: Path
    factors: tuple[float, float]
    total: float
    unstressed: bool
    events: list[Event]
    point: Point
    slack: Flags
    stalls: int = field(init=False, default=0)
    mechanism: bool = field(init=False, default=False)

    def run(self) -> Point:
        """The equilibrium at the end of the change. Raises NoEquilibrium; `point` is the last good one."""
        tangent = self._begin()
        increment = np.inf
        for _ in range(MOST_INCREMENTS):
            if self.point.t >= 1.0:
                return self.point
            self._note_cables(tangent)
            tangent, increment = self._increment(tangent, increment)
            if np.abs(self.point.displacement).max() > RUNAWAY * self.path.structure.extent:
                motion = self.path.structure.spread(tangent.rate)
                if not tangent.flowing.any():
                    raise self._mechanism(motion, tangent.slack)
                raise self._collapse(tangent.flowing, motion)
            if not self.path.structure.linear and (self.point.plastic_strain <= CRUSHED).any():
                raise self._crushed(self.path.structure.spread(tangent.rate))
        raise self._lost()

    # --- the start ---------------------------------------------------------------------------------

    def _begin(self) -> Tangent:
        """Find the direction to start in; a mechanism first takes its shape under a small load."""
        path, structure = self.path, self.path.structure
        tangent = path.tangent(self.point)
        before = self.point
        modes = np.zeros((structure.size, 0))
        if self.unstressed:
            matrix = structure.tangent(before.response, tangent.soft)
            modes = soft_modes(matrix, structure.weight, tangent.factor)
        self.mechanism = modes.shape[1] > 0
        if not path.push.any():
            self._rest(tangent)
        elif not tangent.stable or self._unresisted(tangent):
            self._relax(FIRST_LOAD if self.unstressed else 1.0, None)
        if self.mechanism:
            fields = np.array([structure.spread(mode) for mode in modes.T])
            slack = path.branches(before.response).slack
            places = before.displacement, self.point.displacement
            self.events.append(first_order_mechanism(self.model, self.factor(0.0), fields, slack, *places))
        tangent = path.tangent(self.point)
        path.reference = float(np.linalg.norm(tangent.rate))
        return tangent

    def _rest(self, tangent: Tangent) -> None:
        """Without any change of load: improve the equilibrium, or leave it if it is not stable."""
        found = self.path.correct(self.point, self.point.displacement, 1.0, None)
        if found is None or not tangent.stable:
            self._relax(1.0, None)
        else:
            self.point = found

    def _unresisted(self, tangent: Tangent) -> bool:
        """True if the load pushes the structure where it has no stiffness but that of round-off."""
        rate = tangent.rate
        return float(rate @ self.path.push) < SOFT * float(rate @ (self.path.structure.weight * rate))

    # --- on the way ----------------------------------------------------------------------------------

    def _increment(self, tangent: Tangent, increment: float) -> tuple[Tangent, float]:
        """Take one increment; returns the tangent at its end and the increment to try next."""
        path, start = self.path, self.point
        increment = min(increment, (1.0 - start.t) * path.stretch(tangent))
        step = path.advance(start, tangent, increment)
        if step is None:
            return self._jump(tangent), np.inf
        found, following = step.point, step.tangent
        kept = path.stable_without(found, tangent.soft) if not following.stable else True
        if (following.stable and not self._unresisted(following)) or (kept and found.t >= 1.0):
            self._note_yields(tangent, found, following)
        elif kept and not np.array_equal(following.soft, tangent.soft):
            self._note_yields(tangent, found, following)
            self.point = found
            return self._jump(following), np.inf
        else:
            self.point, _, beyond = path.narrow(start, tangent, following, step.taken)
            return self._jump(beyond), np.inf
        self.point = found
        self._note_plastic_mechanism(tangent, following)
        return following, step.further

    def _note_yields(self, tangent: Tangent, found: Point, following: Tangent) -> None:
        """Report the rods that begin to yield."""
        new = (found.response.flowing | following.flowing) & ~tangent.flowing
        if not new.any():
            return
        names = self.model.rods.column("name")
        force = found.response.axial_force
        parts = []
        for sign, way in [(1.0, "tension"), (-1.0, "compression")]:
            rows = np.flatnonzero(new & (sign * force > 0.0))
            if len(rows):
                verb = "yields" if len(rows) == 1 else "yield"
                parts.append(f"{rod_names(self.model, rows)} {verb} in {way}")
        message = f"{' and '.join(parts)} {self._at(found.t)}."
        rods = tuple(str(names[row]) for row in np.flatnonzero(new))
        self.events.append(Event("yield", self.factor(found.t), _sentence(message), rods))

    def _note_cables(self, tangent: Tangent) -> None:
        """Report the cables that go slack, or tighten again."""
        for kind, verbs, rows in [
            ("slack", ("goes slack", "go slack"), np.flatnonzero(tangent.slack & ~self.slack)),
            ("taut", ("tightens", "tighten"), np.flatnonzero(self.slack & ~tangent.slack)),
        ]:
            if len(rows):
                message = f"{rod_names(self.model, rows)} {verbs[len(rows) > 1]} {self._at(self.point.t)}."
                names = self._rods(np.isin(np.arange(len(self.slack)), rows))
                self.events.append(Event(kind, self.factor(self.point.t), _sentence(message), names))
        self.slack = tangent.slack

    def _note_plastic_mechanism(self, tangent: Tangent, following: Tangent) -> None:
        """Report that only the rods' forces, not their stiffness, still hold the structure."""
        structure = self.path.structure
        if self.mechanism or not (following.flowing & ~tangent.flowing).any():
            return
        matrix = structure.tangent(self.point.response, following.soft, geometric=False)
        if regular(matrix, structure.weight, -SOFT).definite:
            return
        self.mechanism = True
        motion = structure.spread(following.rate)
        message = (
            f"Plastic mechanism {self._at(self.point.t)}: so many rods yield that moving"
            f" {describe_motion(self.model, motion[None])} is resisted only by the change of shape."
        )
        event = Event("plastic mechanism", self.factor(self.point.t), message, self._rods(following.flowing))
        self.events.append(Event(**(vars(event) | {"motion": _unit(motion)})))

    # --- loss of stability -----------------------------------------------------------------------------

    def _jump(self, beyond: Tangent) -> Tangent:
        """From the last stable point go on to the next stable equilibrium, and report what happened."""
        path, critical = self.path, self.point
        plastic = bool(beyond.flowing.any()) and path.stable_without(critical, beyond.slack)
        mode = self._mode(beyond)
        if self.mechanism and critical.t < FIRST_LOAD and not plastic:
            self._relax(FIRST_LOAD, mode)
        else:
            self._pass(critical, beyond, mode, plastic)
        change = path.structure.gather(self.point.displacement - critical.displacement)
        if path.structure.move(change, critical.response.reach) < STALLED:
            self.stalls += 1
        if self.stalls > MOST_STALLS:
            self._leap()
        return path.tangent(self.point)

    def _pass(self, critical: Point, beyond: Tangent, mode: Array, plastic: bool) -> None:
        """Move on under hardly more load; where that leads nowhere in good time, under the whole load."""
        try:
            self._relax(min(1.0, critical.t + BEYOND), mode, beyond if plastic else None, PASSING)
        except NoEquilibrium as reason:
            if reason.status != "limit reached":
                raise
            self._leap()
        else:
            self._note_jump(beyond, critical, mode)

    def _leap(self) -> None:
        """Give up following the path of a structure that hardly resists, and relax under the whole load."""
        message = (
            f"From {self._at(self.point.t).removeprefix('at ')} on the structure hardly resists some motion, so that"
            " its path is not followed: it is relaxed under the whole load."
        )
        self.events.append(Event("note", self.factor(self.point.t), message))
        self._relax(1.0, None)

    def _mode(self, beyond: Tangent) -> Array:
        """The motion in which stability is lost, in the direction in which it goes on."""
        structure, response = self.path.structure, self.point.response
        if beyond.factor.definite and beyond.flowing.any():
            return beyond.rate
        _, mode = lowest_mode(structure.tangent(response, beyond.soft), structure.weight)
        flow = structure.elongation_rate(mode, response) * np.sign(response.axial_force) * beyond.flowing
        pushed = float(mode @ self.path.push)
        lean = float(flow.sum()) if np.abs(flow).max(initial=0.0) > 0.0 else pushed
        if abs(pushed) <= UNEXCITED * np.linalg.norm(mode) * np.linalg.norm(self.path.push):
            lean = float(mode[np.abs(mode).argmax()]) if not beyond.flowing.any() else lean
        return mode if lean >= 0.0 else -mode

    def _relax(self, t: float, nudge: Array | None, plastic: Tangent | None = None, steps: int = STEPS) -> None:
        start = self.path.after(self.point, self.point.displacement, t)
        relaxed = relax(self.path, start, nudge, steps)
        if relaxed.outcome == "equilibrium":
            self.point = relaxed.point
        elif relaxed.outcome == "gave up":
            raise self._lost(relaxed.point)
        elif not (relaxed.point.plastic_strain != self.point.plastic_strain).any():
            away = relaxed.point
            raise self._mechanism(away.displacement - self.point.displacement, away.response.slack)
        else:
            motion = relaxed.point.displacement - self.point.displacement
            if plastic is not None and nudge is not None:
                raise self._collapse(plastic.flowing, self.path.structure.spread(nudge))
            raise self._collapse(relaxed.point.response.flowing, motion)

    def _note_jump(self, beyond: Tangent, critical: Point, mode: Array) -> None:
        push = self.path.push
        share = abs(float(mode @ push)) / (np.linalg.norm(mode) * np.linalg.norm(push))
        kind = "bifurcation" if beyond.sense > 0.0 and share < UNEXCITED else "snap-through"
        where = moved(self.model, critical.displacement, self.point.displacement)
        yielded = np.flatnonzero(self.point.plastic_strain != critical.plastic_strain)
        if kind == "bifurcation":
            what = "Bifurcation: the equilibrium became unstable"
            after = " It gave way to one side, and might as well have gone to the other."
        else:
            what = "Snap-through: the structure passed through its unstable position"
            after = ""
        rods = f" {_sentence(rod_names(self.model, yielded))} yielded on the way." if len(yielded) else ""
        message = f"{what} {self._at(critical.t)} and went on to the next stable one, {where}.{after}{rods}"
        names = self.model.rods.column("name")
        event_rods = tuple(str(names[row]) for row in yielded)
        motion = _unit(self.path.structure.spread(mode))
        self.events.append(Event(kind, self.factor(critical.t), message, event_rods, motion))

    def _collapse(self, flowing: Flags, motion: Array) -> NoEquilibrium:
        rows = np.flatnonzero(flowing)
        because = f"{rod_names(self.model, rows)} yield{'s' if len(rows) == 1 else ''}" if len(rows) else ""
        message = (
            f"Plastic collapse {self._at(self.point.t)}: {because} and nothing else resists moving"
            f" {describe_motion(self.model, motion[None])}. Lower the load or strengthen these rods."
        )
        factor = self.factor(self.point.t)
        self.events.append(Event("collapse", factor, message, self._rods(flowing), _unit(motion)))
        return NoEquilibrium("collapse", message)

    def _crushed(self, motion: Array) -> NoEquilibrium:
        """Something still holds the load, but what yields has no length left."""
        crushed = self.point.plastic_strain <= CRUSHED
        rows = np.flatnonzero(crushed)
        message = (
            f"Plastic collapse {self._at(self.point.t)}: {rod_names(self.model, rows)}"
            f" {'is' if len(rows) == 1 else 'are'} crushed to a tenth of the length."
            " Lower the load or strengthen what yields."
        )
        factor = self.factor(self.point.t)
        self.events.append(Event("collapse", factor, message, self._rods(crushed), _unit(motion)))
        return NoEquilibrium("collapse", message)

    def _mechanism(self, motion: Array, slack: Flags) -> NoEquilibrium:
        """In first-order theory a mechanism that the load moves never comes to rest."""
        message = (
            f"Mechanism: the load moves {describe_motion(self.model, motion[None])} and nothing resists."
            " Add rods or supports there."
        ) + slack_named(self.model, slack)
        self.events.append(Event("mechanism", self.factor(self.point.t), message, motion=_unit(motion)))
        return NoEquilibrium("mechanism", message)

    def _lost(self, point: Point | None = None) -> NoEquilibrium:
        message = (
            f"The equilibrium could not be followed beyond the load factor {self.factor(self.point.t):.6g};"
            " the last one is kept. Run the model through time, or apply the load in other steps."
        ) + (slack_named(self.model, point.response.slack) if point is not None else "")
        return NoEquilibrium("limit reached", message)

    # --- words -------------------------------------------------------------------------------------

    def factor(self, t: float) -> float:
        """The load factor at t."""
        first, last = self.factors
        return last if t >= 1.0 else first + t * (last - first)

    def _at(self, t: float) -> str:
        factor = self.factor(t)
        load = f" ({abs(factor) * self.total:.6g} kN in all)" if self.total > 0.0 else ""
        return f"at the load factor {factor:.6g}{load}"

    def _rods(self, flags: Flags) -> tuple[str, ...]:
        names = self.model.rods.column("name")
        return tuple(str(names[row]) for row in np.flatnonzero(flags))


def first_order_mechanism(
    model: Model, factor: float, fields: Array, slack: Flags, before: Array, after: Array
) -> Event:
    """What to tell about motions (k, n, 2) that nothing resists without load, and displacements (n, 2) under it."""
    message = f"First-order mechanism: without load nothing resists moving {describe_motion(model, fields)}."
    if np.array_equal(before, after):
        message += " Add rods or supports there if that is not meant." + slack_named(model, slack)
    else:
        message += f" It gives way until the load is held in another shape: {moved(model, before, after)}."
    return Event("mechanism", factor, message, motion=_unit(fields[0]))


def _unit(motion: Array) -> Array:
    """A field scaled so that the largest motion is 1."""
    scaled: Array = motion / np.hypot(motion[:, 0], motion[:, 1]).max()
    return scaled


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]
