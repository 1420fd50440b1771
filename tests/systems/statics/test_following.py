"""How paths of equilibria are followed."""

from collections import Counter
from typing import Any

import pytest

from pinjoint.documents import models
from pinjoint.systems.statics.follow import Path
from pinjoint.systems.statics.settle import settle


@pytest.mark.parametrize(
    ("name", "factor", "lost"),
    [
        ("snap_through", 1.0, 0.02540835943),
        ("williams_toggle", 2.0, 0.943015321),
        ("lees_frame", 1.0, 0.9278580583),
    ],
)
def test_a_loss_of_stability_is_located_in_a_dozen_increments(
    monkeypatch: pytest.MonkeyPatch, name: str, factor: float, lost: float
) -> None:
    """As exactly as by 42 halvings of the increment, by which these were found."""
    tried, attempt, narrow = Counter[bool](), Path.attempt, Path.narrow
    inside = []

    def counted(self: Path, *given: Any) -> Any:
        tried[bool(inside)] += 1
        return attempt(self, *given)

    def narrowed(self: Path, *given: Any) -> Any:
        inside.append(given)
        found = narrow(self, *given)
        inside.clear()
        return found

    monkeypatch.setattr(Path, "attempt", counted)
    monkeypatch.setattr(Path, "narrow", narrowed)
    [event] = settle(models.load(name), factor).events
    assert (event.kind, event.load_factor) == ("snap-through", pytest.approx(lost, rel=1e-9))
    assert 0 < tried[True] <= 12


def test_a_slack_rod_whose_ends_flow_takes_no_part_of_what_acts_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Directions of the path counted a force in it, agreed with nothing, and increments shrank to 1e-8 for good."""
    tried, attempt = [], Path.attempt

    def counted(self: Path, *given: Any) -> Any:
        tried.append(given)
        return attempt(self, *given)

    model = models.load("portal")
    model.rods["BC"].tension_only, model.rods["BC"].plastic_moment = True, 20.0
    monkeypatch.setattr(Path, "attempt", counted)
    state = settle(model, 1.0).equilibrium
    assert state.axial_force[1] == 0.0
    assert 0 < len(tried) < 100
