"""Remarks: what a run did that a slowly growing load would not have done, said where it comes to rest."""

from typing import Any

import numpy as np
import pytest
from numba import njit

from pinjoint import Session
from pinjoint.documents import models
from pinjoint.systems.base import Law
from pinjoint.systems.statics.settle import settle
from tests.reference.models import model, particle, rod, von_mises_truss


def at_rest(source: str | dict[str, Any]) -> Session:
    session = Session.open(source)
    assert session.run(until="rest") == "at rest"
    return session


def kinds(session: Session) -> list[str]:
    return [remark.kind for remark in session.document.assessment.remarks]


def test_a_rod_that_yielded_only_in_the_overshoot() -> None:
    session = at_rest("overshoot_yield")
    assert kinds(session) == ["overshoot"]
    assert (
        "Rod AB yielded only because the sudden load overshot: in equilibrium its force is 9 kN, below its strength of 10 kN"
        in session.message
    )


def test_the_window_says_it_too() -> None:
    session = Session.open("overshoot_yield")
    session.press("space")
    while not session.simulation.halted:
        session.frame(0.05)
    session.update_view()
    assert "in equilibrium its force is 9 kN, below its strength of 10 kN" in session.view.status.notice
    session.press("r")
    session.frame(0.0)
    assert "overshoot" not in session.view.status.notice


def test_a_structure_that_passed_through_its_unstable_position() -> None:
    session = at_rest("snap_through")
    assert kinds(session) == ["snap-through"]
    assert "the structure becomes unstable at the load factor 0.02541 (25.41 kN" in session.message


def test_a_collapse_is_explained_where_its_remains_come_to_rest() -> None:
    session = at_rest("isostatic_collapse")
    assert kinds(session) == ["collapse"]
    assert "Plastic collapse at the load factor 0.8686" in session.message
    assert "rod BC yields" in session.message


def test_run_prints_it_and_lists_it_among_the_events(answer: Any) -> None:
    run = answer("run", "overshoot_yield")
    assert "only because the sudden load overshot" in run["message"]
    assert [(event["kind"], event["rods"]) for event in run["events"]] == [("overshoot", ["AB"])]


def test_a_rod_that_yielded_further_than_under_a_slow_ramp() -> None:
    document = models.document(models.load("hyperstatic_yield"))
    for each in document["rods"]:
        each["damping"] = 2.0
    assert "CD yielded more because the sudden load overshot" in at_rest(document).message


def test_a_sudden_load_below_the_limit_that_carried_it_past_the_unstable_position() -> None:
    """2910.8 kN snap the undamped von Mises truss that carries 3789.46 kN; so do 3500 kN with little damping."""
    document = von_mises_truss(force=-3500.0, damping=50.0)
    session = at_rest(document | {"environment": {"drag": 2.0}})
    assert kinds(session) == ["other equilibrium"]
    assert "displacement y of particle B differs by" in session.message


@pytest.mark.parametrize("name", ["isostatic", "hyperstatic", "hyperstatic_yield", "three_bar_plastic"])
def test_nothing_is_said_of_what_theory_would_do_as_well(name: str) -> None:
    session = at_rest(name)
    assert session.document.assessment.remarks == ()
    assert session.message.startswith("At rest since")
    assert session.message.count(".") == 2


def test_nothing_is_said_when_theory_does_not_know_the_history() -> None:
    """Edited on the way, or under loads that come one after the other."""
    session = at_rest("hyperstatic_yield")
    session.loads[0].force = (0, 0)
    assert session.run(until="rest") == "at rest"
    assert session.document.assessment.remarks == ()
    document = models.document(models.load("hyperstatic_yield"))
    later = {"kind": "ramp", "start": 1.0, "duration": 0.5}
    document["loads"].append({"on": "C", "force": [0, 260], "history": later})
    session = at_rest(document)
    assert session.rods["CD"].plastic_strain != 0.0
    assert session.document.assessment.remarks == ()


def test_restarting_forgets_that_the_model_was_edited_during_the_run() -> None:
    session = at_rest("overshoot_yield")
    session.particles["B"].force = (0, -8.5)
    session.restart()
    assert session.run(until="rest") == "at rest"
    assert "in equilibrium its force is 8.5 kN, below its strength of 10 kN" in session.message


def test_nothing_is_said_where_a_law_acts_that_statics_does_not_know() -> None:
    @njit  # type: ignore[untyped-decorator,unused-ignore]
    def more(particles_mass):  # type: ignore[no-untyped-def]
        return 0.0, -0.3 * particles_mass

    class More(Law):
        name = "test.more"
        each = "particles"
        kernel = more
        reads = ("particles.mass",)

    session = Session.open("overshoot_yield", systems=[More()])
    assert session.run(until="rest") == "at rest"
    assert session.rods["AB"].plastic_strain != 0.0
    assert session.document.assessment.remarks == ()


def test_the_collapse_load_of_textbooks_is_not_that_of_the_changed_shape() -> None:
    """Two bars in a shallow V: limit analysis knows their original slope, 0.1; they bear until they hang straight down."""
    strength = {"stiffness": 1e6, "tensile_strength": 10.0}
    ends = [particle(name, x, 0.1, fixed=[True, True]) for name, x in (("A", -1.0), ("C", 1.0))]
    middle = particle("B", 0.0, 0.0, force=[0.0, -40.0])
    session = Session.open(model([*ends, middle], [rod(*pair, **strength) for pair in ("AB", "BC")]))
    found = settle(session.model)
    (limit,) = (e for e in found.events if e.kind == "plastic mechanism")
    (lost,) = (e for e in found.events if e.kind == "collapse")
    assert limit.load_factor == pytest.approx(2.0 * 10.0 * 0.1 / np.hypot(1.0, 0.1) / 40.0, rel=1e-3)
    assert "the collapse load of textbooks" in limit.message
    assert lost.load_factor > 4.0 * limit.load_factor
    assert "Plastic collapse" not in lost.message
    assert f"at the load factor {limit.load_factor:.4g}" in lost.message
