"""Frame clock: how far a frame lets time pass, at a pace that a person chose and the machine can keep."""

from __future__ import annotations

LONGEST_FRAME = 0.1  # s of real time that one frame may catch up
BUDGET = 0.012  # s of a frame that steps may take
FIRST_STEPS = 1000  # that the first frame may take, when their cost is not known yet
FASTEST, SLOWEST = 1e3, 1e-5  # simulated seconds per second shown, times the natural pace at 1


class FrameClock:
    """Turns elapsed real time into simulated time, and remembers what whole steps leave of it.

    natural: simulated seconds per second shown that suit the model; factor: a person's choice on top.
    lagging: True while the machine cannot keep the pace; the picture then shows less time per second.
    ahead: simulated time (s) that has passed for the person since the end of the last step.
    """

    def __init__(self) -> None:
        self.natural = 1.0
        self.factor = 1.0
        self.lagging = False
        self.shown_pace = 1.0
        self.ahead = 0.0
        self._seconds_per_step = 0.0

    @property
    def pace(self) -> float:
        """Simulated seconds per second shown that is wanted."""
        return self.natural * self.factor

    def faster(self, times: float) -> None:
        """Multiply the pace, within limits."""
        self.factor = min(max(self.factor * times, SLOWEST), FASTEST)

    def due(self, elapsed: float) -> float:
        """Simulated time (s) to let pass in a frame that took `elapsed` seconds."""
        return min(elapsed, LONGEST_FRAME) * self.pace

    @property
    def affordable(self) -> int:
        """Steps that the machine can take in a frame."""
        known = self._seconds_per_step
        return max(int(BUDGET / known), 1) if known > 0.0 else FIRST_STEPS

    def took(self, due: float, passed: float, steps: int, seconds: float) -> None:
        """Learn from a frame: time that was due and that passed in whole steps (s), and what these cost (s)."""
        self.lagging = steps >= self.affordable
        wanted = self.ahead + due
        self.ahead = 0.0 if self.lagging else max(wanted - passed, 0.0)
        self.shown_pace = self.pace * passed / wanted if self.lagging else self.pace
        if steps > 0:
            cost, known = seconds / steps, self._seconds_per_step
            self._seconds_per_step = cost if known == 0.0 else 0.8 * known + 0.2 * cost
