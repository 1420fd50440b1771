"""A plan holds what its model needs and nothing else, as read from the file itself."""

import itertools
import json
from importlib.resources import files
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Environment
from pinjoint.documents import models
from pinjoint.systems.base import Phase

STRENGTHS = ("tensile_strength", "compressive_strength")


def entries(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(
        (files("pinjoint.assets") / "models" / f"{name}.json").read_text(encoding="utf-8")
    )
    return found


def needed(model: dict[str, Any]) -> set[str]:
    """The laws and commits that a model file asks for."""
    rods = model.get("rods", [])
    plastic = model.get("settings", {}).get("plasticity", True)
    yields = plastic and any(rod.get(strength) for rod in rods for strength in STRENGTHS)
    has_yielded = any(rod.get("plastic_strain") for rod in rods)
    systems = (
        {"physics.elasticity_after_yielding" if yields or has_yielded else "physics.elasticity"}
        if rods
        else set()
    )
    if yields:
        systems |= {"plasticity.strength", "plasticity.yielding", "plasticity.first_yield"}
    if plastic and any(rod.get("plastic_moment") for rod in rods):
        systems |= {"plasticity.hinges", "plasticity.turning", "plasticity.first_hinges"}
    cables = any(rod.get("tension_only") for rod in rods)
    if cables:
        systems.add("physics.slackness")
    if any(rod.get("damping", Rod.damping.default) for rod in rods):
        systems.add("physics.axial_damping_of_cables" if cables else "physics.axial_damping")
    bends = any(rod.get("bending_stiffness") and rod.get("hinged") != [True, True] for rod in rods)
    if bends:
        systems.add("physics.bending")
    if bends and any(rod.get("damping", Rod.damping.default) for rod in rods):
        systems.add("physics.bending_damping")
    if model.get("environment", {}).get("drag", Environment.drag.default):
        systems |= {"physics.drag", "physics.turning_drag"} if bends else {"physics.drag"}
    if model.get("settings", {}).get("collisions", True) and can_meet(model):
        systems.add("collision.discs")
    kinds = {load.get("history", {"kind": "constant"})["kind"] for load in model.get("loads", [])}
    return systems | {f"loads.{kind}" for kind in kinds - {"constant"}}


def can_meet(model: dict[str, Any]) -> bool:
    """Whether there are two particles without a rod between them, or one and a wall, of which one can move."""
    held = {one["name"] for one in model["particles"] if all(one.get("fixed", [False, False]))}
    joined = {frozenset(rod["between"]) for rod in model.get("rods", [])}
    if model.get("components") and len(held) < len(model["particles"]):
        return True
    pairs = itertools.combinations([one["name"] for one in model["particles"]], 2)
    return any(not held.issuperset(pair) and frozenset(pair) not in joined for pair in pairs)


def planned(session: Session) -> set[str]:
    return {system.name for system in session.simulation.plan}


@pytest.mark.parametrize("name", models.bundled())
def test_a_plan_holds_what_the_model_needs_and_nothing_else(name: str) -> None:
    assert planned(Session.open(name)) == needed(entries(name))


def test_every_system_is_left_out_of_some_plan() -> None:
    plans = [needed(entries(name)) for name in models.bundled()]
    for system in set().union(*plans):
        assert any(system not in plan for plan in plans), system


@pytest.mark.parametrize(
    ("edit", "systems"),
    [
        (
            lambda s: setattr(s.rods["AB"], "tensile_strength", 10.0),
            {"plasticity.strength", "plasticity.yielding", "plasticity.first_yield"},
        ),
        (lambda s: setattr(s.environment, "drag", 1.0), {"physics.drag"}),
    ],
    ids=["a strength", "drag"],
)
def test_an_edit_brings_a_system_in_and_undoing_it_takes_it_out(edit: Any, systems: set[str]) -> None:
    session = Session.open("isostatic")
    for rod in session.rods:
        rod.tensile_strength = rod.compressive_strength = None
    before = planned(session)
    edit(session)
    assert systems <= planned(session) - before
    session.undo()
    assert planned(session) == before


def test_an_empty_model_needs_nothing() -> None:
    session = Session.open({"format": "pinjoint model", "version": 1})
    assert planned(session) == set()
    names = [system.name for system in session.schedule.plan("pause", session.model).phases[Phase.EDIT]]
    assert "edit.hover" not in names
