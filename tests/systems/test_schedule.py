"""The scheduler: order, ties, cycles, conflicts by name; and that what a model does not need is left out.

What bundled models need is told by their files, in test_skipping.py.
"""

import random
from typing import Any

import pytest

from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.systems.base import Phase, System
from pinjoint.systems.catalogue import step_systems
from pinjoint.systems.schedule import Schedule, ScheduleError
from tests.reference.models import model, oscillator, particle


class Noting:
    """A frame in a scene that notes what ran."""

    def __init__(self, scene: str = "pause") -> None:
        self.scene, self.model, self.ran = scene, Model(), list[str]()


def system(name: str, **attributes: Any) -> System:
    """A frame system that notes in the frame that it ran."""

    def process(self: System, frame: Noting) -> None:
        frame.ran.append(self.name)

    return type("Noted", (System,), {"name": name, "process": process} | attributes)()


def order(*systems: System, phase: Phase = Phase.EDIT) -> list[str]:
    return [s.name for s in Schedule(systems).plan("pause", Model()).phases[phase]]


# --- order -----------------------------------------------------------------------------------------------


def test_ties_are_in_the_order_of_registration() -> None:
    assert order(system("c"), system("a"), system("b")) == ["c", "a", "b"]


def test_before_and_after_decide() -> None:
    assert order(system("c", after=("b",)), system("a", before=("b",)), system("b")) == ["a", "b", "c"]


def test_order_holds_through_others_whatever_the_registration() -> None:
    chain = [system(f"s{i}", after=(f"s{i - 1}",)) for i in range(8)]
    for seed in range(20):
        random.Random(seed).shuffle(chain)
        assert order(*chain) == [f"s{i}" for i in range(8)]


def test_names_that_are_absent_are_allowed() -> None:
    assert order(system("a", after=("some.mod",)), system("b", before=("other.mod",))) == ["a", "b"]


def test_phases_run_apart() -> None:
    early, late = system("early", phase=Phase.INPUT), system("late", phase=Phase.RENDER)
    assert order(late, early, phase=Phase.INPUT) == ["early"]
    assert order(late, early, phase=Phase.RENDER) == ["late"]


def test_systems_run_in_the_scenes_that_they_name() -> None:
    everywhere, paused = system("everywhere"), system("paused", scenes=("pause",))
    schedule = Schedule([everywhere, paused])
    for scene, expected in [("pause", ["everywhere", "paused"]), ("simulation", ["everywhere"])]:
        frame = Noting(scene)
        schedule.run(Phase.EDIT, frame)
        assert frame.ran == expected


def test_each_system_is_timed_and_what_the_model_does_not_need_is_left_out() -> None:
    idle = system("idle", needs=lambda self, model: False)
    schedule = Schedule([system("busy"), idle])
    frame = Noting()
    schedule.run(Phase.EDIT, frame)
    assert frame.ran == ["busy"]
    assert schedule.seconds.keys() == {"busy"}
    assert schedule.seconds["busy"] > 0.0


def test_a_system_takes_the_place_of_those_it_replaces_where_it_acts() -> None:
    wanted = [True]
    both = system("old.one", writes=("x.y",)), system("old.two")
    new = system("new", replaces=("old",), writes=("x.y",), scenes=("pause",), needs=lambda self, m: wanted[0])
    schedule = Schedule([*both, new])
    for wanted[0], scene, ran in (
        (True, "pause", ["new"]),
        (False, "pause", ["old.one", "old.two"]),
        (True, "simulation", ["old.one", "old.two"]),
    ):
        frame = Noting(scene)
        schedule.run(Phase.EDIT, frame)
        assert frame.ran == ran
        assert [s.name for s in schedule.plan(scene, Model()).phases[Phase.EDIT]] == ran
    wanted[0] = True
    assert schedule.plan("pause", Model()).left_out["old.one"] == "replaced by new"


# --- mistakes --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("systems", "says"),
    [
        ([system("a", after=("b",)), system("b", after=("a",))], "wait for each other: .*remove one"),
        ([system("a", before=("a",))], "wait for each other: a → a"),
        ([system("a"), system("a")], "Two systems are called a"),
        ([system("")], "Noted has no name"),
        (
            [system("a.one", replaces=("b",)), system("b.two", replaces=("a",))],
            "replace each other: .*remove one",
        ),
        ([system("a", replaces="beta"), system("bets")], "a replaces 'beta', but there is no .* mean 'bets'"),
        (
            [system("a", phase=Phase.INPUT), system("b", after=("a",))],
            "b names a in `before` or `after`, but that runs in another phase",
        ),
        (
            [system("a", writes=("rods.strain",)), system("b", reads=("rods.strain",))],
            "a and b both use rods.strain, .*declare before",
        ),
        ([system("a", writes=("x.y",)), system("b", writes=("x.y",))], "a and b both use x.y"),
        ([system("a", adds=("x.y",)), system("b", reads=("x.y",))], "a and b both use x.y"),
        ([system("a", adds=("x.y",)), system("b", writes=("x.y",))], "a and b both use x.y"),
    ],
)
def test_mistakes_are_named_with_the_remedy(systems: list[System], says: str) -> None:
    with pytest.raises(ScheduleError, match=says):
        Schedule(systems)


@pytest.mark.parametrize(
    "systems",
    [
        [system("a", reads=("x.y",)), system("b", reads=("x.y",))],
        [system("a", adds=("x.y",)), system("b", adds=("x.y",))],
        [system("a", writes=("x.y",)), system("b", reads=("x.y",), after=("a",))],
        [system("a", writes=("x.y",)), system("m", after=("a",)), system("b", reads=("x.y",), after=("m",))],
        [system("a", writes=("x.y",), phase=Phase.INPUT), system("b", writes=("x.y",))],
    ],
    ids=["reads", "additions", "ordered", "ordered through another", "other phase"],
)
def test_what_cannot_conflict_is_allowed(systems: list[System]) -> None:
    Schedule(systems)


# --- skipping --------------------------------------------------------------------------------------------

ELASTIC, DAMPED = ("physics.elasticity",), ("physics.elasticity", "physics.axial_damping")
YIELDING = (
    "physics.elasticity_after_yielding",
    "physics.axial_damping",
    "plasticity.strength",
    "plasticity.yielding",
    "plasticity.first_yield",
)
RAMP, DRAG = ("loads.ramp",), ("physics.drag",)


def plan(document: Any) -> set[str]:
    return {s.name for s in Schedule(step_systems()).step_plan("simulation", models.load(document))}


def test_nothing_is_done_for_what_is_not_there() -> None:
    """A single property brings in the system that it needs, and no other."""
    bare = oscillator(100.0)
    assert plan(bare) == set(ELASTIC)
    assert plan(oscillator(100.0, 0.1)) == set(DAMPED)
    assert plan(bare | {"environment": {"drag": 0.1}}) == set(ELASTIC + DRAG)
    load = {"on": "B", "force": [1, 0]}
    assert plan(bare | {"loads": [load]}) == set(ELASTIC)
    assert plan(bare | {"loads": [load | {"history": {"kind": "ramp"}}]}) == set(ELASTIC + RAMP)
    bare["rods"][0]["tensile_strength"] = 0
    assert plan(bare) == set(ELASTIC)
    bare["rods"][0]["tensile_strength"] = 5
    assert plan(bare) == set(YIELDING) - {"physics.axial_damping"}
    assert plan(bare | {"settings": {"plasticity": False}}) == set(ELASTIC)
    bare["rods"][0] |= {"tensile_strength": 0, "plastic_strain": 0.01}
    assert plan(bare) == {"physics.elasticity_after_yielding"}
    assert plan(model([particle("p", 0, 0)], [])) == set()
