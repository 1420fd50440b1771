"""The session that the editing benchmark measures does what it says."""

from contextlib import closing
from pathlib import Path

import pytest

from tests.benchmarks import editing
from tests.benchmarks.editing import ANNOUNCED, SESSION, Hand


@pytest.mark.usefixtures("data")
def test_every_action_is_seen(tmp_path: Path) -> None:
    with closing(Hand(200)) as hand:
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
    monkeypatch.setattr(editing, "Hand", lambda rods: Hand(200))
    table = editing.report(quick=True)["reactions"]
    assert [row["action"] for row in table] == ["point at a particle", "zoom"]
