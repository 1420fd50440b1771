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
