"""Load cases: a combination acts as a model whose numbers are multiplied by hand, and as the sum of its cases."""

import copy
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.documents.models import ModelError
from tests.reference.models import model, particle, rod

Document = dict[str, Any]
CASES = ("permanent", "live", "wind", "heat")
FACTORS = {"permanent": 1.35, "live": -1.5, "heat": 0.6}  # and no wind


def frame(seed: int) -> Document:
    """A storey by lot: springs, an inclined roller, hinges, loads of all kinds and cases."""
    lot = np.random.default_rng(seed)

    def vector(size: float) -> list[float]:
        return lot.uniform(-size, size, 2).tolist()

    places = {"A": (0, 0), "B": (0, 3), "C": (4, 3.5), "D": (8, 3), "E": (8.5, 0.2)}
    particles = [particle(name, *place, force=vector(5.0), moment=2.0) for name, place in places.items()]
    particles[0] |= {"fixed": [True, True], "fixed_rotation": True, "displacement": [0.001, -0.002]}
    particles[4] |= {"fixed": [False, True], "support_angle": float(lot.uniform(-1, 1))}
    particles[2] |= {"support_springs": [0.0, 200.0], "rotation_spring": 300.0}
    stiff = {"stiffness": 8e5, "bending_stiffness": 9e3, "density": 40.0}
    rods = [rod(*ends, **stiff, distributed_force=vector(3.0), temperature_change=5.0) for ends in ("AB", "BC")]
    rods += [rod(*ends, **stiff, temperature_gradient=9.0) for ends in ("CD", "DE")]
    rods += [rod("B", "D", stiffness=3e5, temperature_change=-20.0)]
    rods[2] |= {"hinged": [False, True], "end_springs": [500.0, 0.0]}
    made = model(particles, rods, environment={"acceleration": [0.3, -9.81], "force": [0.1, 0.0]})
    made["loads"], made["span_loads"] = [], []
    for case in CASES:
        names = lot.choice(list(places), 2)
        made["loads"] += [
            {"on": str(name), "force": vector(9.0), "moment": float(lot.normal()), "case": case}
            for name in names
        ]
        made["loads"].append({"on": "A", "settlement": vector(0.01), "settled_rotation": 0.002, "case": case})
        made["loads"].append({"on": "E", "settlement": vector(0.01), "case": case})
        name = str(lot.choice(["AB", "BC", "CD", "DE"]))
        spread = {"start_intensity": vector(4.0), "end_intensity": vector(4.0), "direction": "local"}
        made["span_loads"] += [
            {"rod": name, "start": 0.5, "end": 2.0, "force": vector(9.0), "moment": 3.0, "case": case} | spread,
            {"rod": name, "temperature_change": 30.0, "temperature_gradient": -40.0, "case": case},
        ]
    made["settings"] = {
        "combinations": {"ULS": FACTORS, "all": dict.fromkeys(CASES, 1.0)},
        "theory": "first-order",
    }
    return made


def multiplied(document: Document, factors: dict[str, float]) -> Document:
    """The same without cases: all numbers times the factors of their cases."""
    made = copy.deepcopy(document)
    made["settings"] = {"theory": "first-order"}
    permanent = factors.get("permanent", 0.0)

    def scale(element: Document, factor: float, *names: str) -> None:
        for name in names:
            if name in element:
                element[name] = (factor * np.array(element[name])).tolist()

    scale(made["environment"], permanent, "acceleration", "force")
    for one in made["particles"]:
        scale(one, permanent, "force", "moment", "displacement")
    for one in made["rods"]:
        scale(one, permanent, "distributed_force", "temperature_change", "temperature_gradient")
    for one in [*made["loads"], *made["span_loads"]]:
        of_load = ("settlement", "settled_rotation", "temperature_change", "temperature_gradient")
        factor = factors.get(one.pop("case"), 0.0)
        scale(one, factor, "force", "moment", "start_intensity", "end_intensity", *of_load)
    return made


def columns(session: Session, **which: str) -> dict[str, np.ndarray]:
    final = session.statics(**which).final
    assert final.balanced
    return {name: values for name, values in final.columns.items() if values.dtype == float}


@pytest.mark.parametrize("seed", range(6))
def test_a_combination_acts_as_a_model_multiplied_by_hand(seed: int) -> None:
    document = frame(seed)
    session = Session.open(document)
    for theory, within in (("first-order", 1e-11), ("exact", 1e-7)):
        session.model.settings.theory = theory
        for which, factors in [
            ({"combination": "ULS"}, FACTORS),
            ({"case": "wind"}, {"wind": 1.0}),
            ({"case": "permanent"}, {"permanent": 1.0}),
            ({"combination": ""}, dict.fromkeys(CASES, 1.0)),
            ({}, dict.fromkeys(CASES, 1.0)),
        ]:
            by_hand = Session.open(multiplied(document, factors))
            by_hand.model.settings.theory = theory
            alike(columns(session, **which), columns(by_hand), within)


def alike(found: dict[str, np.ndarray], answer: dict[str, np.ndarray], within: float) -> None:
    for name, values in answer.items():
        if name not in (
            "rods.length",
            "rods.largest_moment",
            "rods.strain",
        ):  # by a misfit; jumps; by rest lengths
            size = np.abs(values).max(initial=0.0)
            assert found[name] == pytest.approx(values, rel=within, abs=within * max(size, 1e-3)), name


@pytest.mark.parametrize("seed", range(6))
def test_a_combination_is_the_sum_of_its_cases(seed: int) -> None:
    """By first-order theory, and so are the sets of both methods."""
    document = frame(seed)
    document["rods"][-1]["rest_length"] = 8.001  # which is permanent, too
    session = Session.open(document)
    cases = {case: columns(session, case=case) for case in CASES}
    found = columns(session, combination="ULS")
    for name in ("particles.displacement", "particles.reaction", "rods.axial_force", "rods.bending_moment"):
        summed = sum(factor * cases[case][name] for case, factor in FACTORS.items())
        size = max(np.abs(cases[case][name]).max() for case in CASES)
        assert found[name] == pytest.approx(summed, rel=1e-11, abs=1e-11 * size), name
    session.model.settings.combination = "ULS"
    for method in (session.force_method(), session.displacement_method()):
        state = method.superposed
        assert state.displacement == pytest.approx(found["particles.displacement"], abs=1e-11)
        assert state.bending_moment == pytest.approx(found["rods.bending_moment"], abs=1e-8)
        assert method.real.axial_force == pytest.approx(found["rods.axial_force"], abs=1e-8)


def test_undo_files_and_bad_input() -> None:
    session = Session.open(frame(1))
    settings = session.model.settings
    settings.combination = "ULS"
    settings.combinations = {"other": {"permanent": 1.0}}  # without the one that acts: then all cases do
    assert settings.combination == ""
    session.undo()
    assert (settings.combination, settings.combinations["ULS"]) == ("ULS", FACTORS)
    for name, value, said in [
        ("combination", "SLS", "settings: there is no combination 'SLS'; choose one of ULS, all."),
        ("combinations", {"A": {"live": "2"}}, "in the combination 'A' the factor of 'live' is '2'"),
        ("combinations", {"A": 2.0}, "the combination 'A' is 2.0; it must give cases factors"),
        ("combinations", {" ": {}}, "the name is ' '"),
        ("combinations", ["A"], "they must be like"),
    ]:
        with pytest.raises(FieldError) as refused:
            setattr(settings, name, value)
        assert said in str(refused.value)
    with pytest.raises(FieldError, match="load 1: the name is ''"):
        session.loads["load 1"].case = ""
    with pytest.raises(
        ValueError, match=r"There is no load case 'wnd'; choose one of permanent, live, wind, heat."
    ):
        session.statics(case="wnd")
    with pytest.raises(ValueError, match="Choose a case or a combination"):
        session.statics(case="wind", combination="ULS")
    settings.combinations = {"ULS": {"wnd": 1.5}}
    assert "names the case 'wnd', which no load is of" in session.statics().account
    document = frame(1)
    document["settings"]["combination"] = "SLS"
    with pytest.raises(ModelError, match=r"\$.settings.combination: there is no combination 'SLS'"):
        Session.open(document)
