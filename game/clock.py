"""Frame clock: how many fixed steps a frame takes, at a pace that a person chose and the machine can keep."""

from __future__ import annotations

LONGEST_FRAME = 0.1  # s of real time that one frame may catch up
BUDGET = 0.012  # s of a frame that steps may take
FASTEST, SLOWEST = 1e3, 1e-5  # simulated seconds per second shown, times the natural pace at 1


class FrameClock:
    """Turns elapsed real time into whole steps.

    natural: simulated seconds per second shown that suit the model; factor: a person's choice on top.
    lagging: True while the machine cannot keep the pace; the picture then shows less time per second.
    """

    def __init__(self) -> None:
        self.natural = 1.0
        self.factor = 1.0
        self.lagging = False
        self.shown_pace = 1.0
        self._carry = 0.0
        self._seconds_per_step = 0.0

    @property
    def pace(self) -> float:
        """Simulated seconds per second shown that is wanted."""
        return self.natural * self.factor

    def faster(self, times: float) -> None:
        """Multiply the pace, within limits."""
        self.factor = min(max(self.factor * times, SLOWEST), FASTEST)

    def steps(self, elapsed: float, step_size: float) -> int:
        """Whole steps for a frame that took `elapsed` seconds, at most what the budget allows."""
        wanted = min(elapsed, LONGEST_FRAME) * self.pace / step_size + self._carry
        affordable = BUDGET / self._seconds_per_step if self._seconds_per_step > 0.0 else 1000.0
        due = min(int(wanted), max(int(affordable), 1))
        self.lagging = due < int(wanted)
        self._carry = 0.0 if self.lagging else wanted - due
        self.shown_pace = self.pace if not self.lagging else self.pace * due / wanted
        return due

    def took(self, steps: int, seconds: float) -> None:
        """Learn what a step costs."""
        if steps > 0:
            cost = seconds / steps
            known = self._seconds_per_step
            self._seconds_per_step = cost if known == 0.0 else 0.8 * known + 0.2 * cost
