"""Timeline: checkpoints of a run since the last edit, to step back through; the steps between are run again."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.systems.edit.pull import Hand, Pull
from pinjoint.systems.run.checkpoint import Checkpoint
from pinjoint.systems.run.simulation import Simulation

Moment = tuple[int, float | None]  # see Simulation.moment
_LONG = 2_000_000  # steps × particles of a run that is not gone through again
_RUN_UP = 64  # steps before the one gone back to, where a checkpoint is kept for going back further


class Timeline:
    """Keeps checkpoints at fixed step counts, so that what is kept does not depend on the frames.

    Between them a run is a function of the step only, but for the hand that pulls a particle; what it did, and when, be
    it within a step, is noted, and done again when a stretch of time is run again. memory: bytes that checkpoints may take.
    """

    def __init__(self, simulation: Simulation, pull: Pull, memory: int = 256 * 2**20) -> None:
        self._simulation = simulation
        self._pull = pull
        self._memory = memory
        self.clear()

    def clear(self) -> None:
        """Forget all checkpoints, since after an edit earlier steps cannot be run again."""
        self._checkpoints: dict[int, Checkpoint] = {}
        # Steps begun and the moment when the hand changed, and to what.
        self._hands: list[tuple[int, Moment, Hand | None]] = []
        self._interval = 128  # steps; doubled whenever there are too many
        self._went_back = False

    @property
    def _now(self) -> int:
        return self._simulation.model.clock.steps

    @property
    def first(self) -> int:
        """The earliest step that one can go back to."""
        return min(self._checkpoints, default=self._now)

    @property
    def kept(self) -> int:
        """How many checkpoints are kept."""
        return len(self._checkpoints)

    # --- recording -------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Time is about to pass; after going back, later changes of the hand are forgotten."""
        if self._went_back:
            self._went_back = False
            if any(at >= self._now for at, *_ in self._hands):
                self._hands = [entry for entry in self._hands if entry[0] < self._now]
                self._checkpoints = {at: point for at, point in self._checkpoints.items() if at <= self._now}
        if not self._checkpoints and self._simulation.model.clock.departure is None:
            self._keep()

    @contextmanager
    def recording(self) -> Iterator[None]:
        """Keep checkpoints of the time that passes inside."""
        self.begin()
        self._simulation.before_steps.append(self._watch)
        try:
            yield
        finally:
            self._simulation.before_steps.remove(self._watch)

    def _watch(self) -> int:
        beyond = self._now % self._interval
        if beyond == 0 or self._now in self._checkpoints or not self._checkpoints:
            self._keep()
        return self._interval - beyond

    def _keep(self) -> None:
        now = self._now
        if now in self._checkpoints and self._checkpoints[now].armed:
            return
        checkpoint = self._checkpoints[now] = self._simulation.checkpoint()
        if len(self._checkpoints) > max(min(512, self._memory // max(checkpoint.state.nbytes, 1)), 2):
            self._interval *= 2
            kept = {self.first, now}
            self._checkpoints = {
                at: point for at, point in self._checkpoints.items() if at % self._interval == 0 or at in kept
            }

    def hold(self, hand: Hand | None) -> None:
        """Pull by a hand from now on, differently, or let go (None, or one that throws)."""
        self.begin()
        moment = self._simulation.moment
        anew = self._change_hand(hand)
        self._hands.append((self._now, moment, hand))
        if anew or self._now in self._checkpoints:  # a checkpoint at this step must hold the new hand
            self._checkpoints[self._now] = self._simulation.checkpoint()

    def _change_hand(self, hand: Hand | None) -> bool:
        """Let the hand change; True if another step program takes over, which takes longer to bind than many steps."""
        held = self._pull.hand
        self._simulation.stay()
        thrown = hand.thrown if hand is not None else None
        if held is not None and hand is not None and held.particle is hand.particle and thrown is None:
            self._pull.move(self._simulation.model, hand.anchor)
            self._simulation.wake()
            return False
        self._simulation.before_change()
        self._pull.take(hand)
        if hand is not None and thrown is not None:
            self._simulation.model.writable("particles.velocity")[hand.particle.row] = thrown
        return True

    # --- going back ------------------------------------------------------------------------------------

    def go_to(self, steps: int) -> bool:
        """Return to a step between the first and the last that was run; False if it cannot be reached."""
        if not self._checkpoints or steps < self.first:
            return False
        start = max(at for at in self._checkpoints if at <= steps)
        self._resume(start)
        self._follow_hand(start + 1, steps)
        if self._now < steps - _RUN_UP:
            self._run_to(steps - _RUN_UP)
            self._keep()
        self._run_to(steps)
        if self._pull.hand is not None:
            self._change_hand(None)
        self._went_back = True
        return self._now == steps

    def revisited(self, most: int) -> Iterator[None]:
        """Let the model go through the run again, up to so many steps of it; afterwards it is as it was.

        For those who begin to look after a run, such as plots. None where a hand pulls, or the run was long.
        """
        first, now = self.first, self._now
        if first == now or (now - first) * self._simulation.model.particles.count > _LONG or self._pull.hand:
            return
        present, kept, went_back = self._simulation.checkpoint(), self._checkpoints, self._went_back
        before = first
        try:
            self._resume(first)
            for steps in sorted({first + (now - first) * part // most for part in range(most)}):
                self._follow_hand(before + (before == first), steps)
                self._run_to(steps)
                yield
                before = steps
        finally:
            if self._pull.hand is not None:
                self._change_hand(None)
            self._simulation.resume(present)
            self._checkpoints, self._went_back = kept, went_back

    def _follow_hand(self, since: int, steps: int) -> None:
        """Do again what the hand did from a step on until another one is begun."""
        for at, moment, hand in self._hands:
            if since <= at <= steps:
                self._simulation.go_to(*moment)
                self._simulation.stay()
            if since <= at < steps:
                self._change_hand(hand)

    def _resume(self, at: int) -> None:
        hand = next((hand for when, _, hand in reversed(self._hands) if when <= at), None)
        if hand is not self._pull.hand:
            self._simulation.before_change()  # it runs by another program now
            self._pull.take(hand)
        self._simulation.resume(self._checkpoints[at])

    def _run_to(self, steps: int) -> None:
        self._simulation.advance(max(steps - self._now, 0))
