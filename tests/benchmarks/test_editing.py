"""The session that the editing benchmark measures does what it says."""

from contextlib import closing
from pathlib import Path

import pytest

from tests.benchmarks import editing
from tests.benchmarks.editing import ANNOUNCED, SESSION, Hand
from tests.benchmarks.models import lattice, storeys


@pytest.mark.usefixtures("data")
def test_every_action_is_seen(tmp_path: Path) -> None:
    with closing(Hand(lattice(200, damping=1.0))) as hand:
        hand.session.document.save_as(tmp_path / "lattice.json")
        rods = hand.session.rods.count
        for what, act, times in SESSION:
            seen = False
            hand.wait()
            for _ in range(times):
                act(hand)
                hand.frame()
                seen |= hand.app.render.drawn
            assert seen or not what or what.endswith(ANNOUNCED), what
        assert hand.session.scene == "pause"
        assert hand.session.rods.count < rods
        assert len(hand.session.document.history._done) > 30


def test_the_table_names_every_action(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(editing, "SESSION", SESSION[:2])
    monkeypatch.setattr(editing, "Hand", lambda model: Hand(lattice(200, damping=1.0)))
    table = list(editing.reactions(quick=True))
    assert [row["action"] for row in table] == ["point at a particle", "zoom"]


def test_what_is_dragged_in_statics_is_solved_in_every_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(editing, "storeys", lambda bays, floors: storeys(6, 8))
    joint, slider = editing.drags(quick=True)
    assert (joint["dragged"], slider["dragged"]) == ("a joint", "a slider")
    for row in (joint, slider):
        assert row["rods"] == 104
        assert row["pale"] == 0
