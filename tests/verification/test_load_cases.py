"""Load cases: a combination acts as a model whose numbers are multiplied by hand, and as the sum of its cases."""

import copy
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import inner_forces
from pinjoint.components.field import FieldError
from pinjoint.components.load import Load
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


# --- envelopes -----------------------------------------------------------------------------------------


def patterns(**settings: Any) -> Session:
    """Two spans of 6 m under g = 4 kN/m, and q = 10 kN/m on one, the other or both."""
    beam = {"stiffness": 1e6, "bending_stiffness": 2e4, "distributed_force": [0, -4.0]}
    supports = [particle(name, x, 0, fixed=[name == "A", True]) for name, x in (("A", 0), ("B", 6), ("C", 12))]
    combinations = {name: {"permanent": 1.0, **dict.fromkeys(name, 1.0)} for name in ("LR", "L", "R")}
    made = model(supports, [rod("A", "B", **beam), rod("B", "C", **beam)])
    load = {"start_intensity": [0, -10.0], "end_intensity": [0, -10.0]}
    made["span_loads"] = [{"rod": "AB", "case": "L"} | load, {"rod": "BC", "case": "R"} | load]
    made["settings"] = {"combinations": combinations, "theory": "first-order", **settings}
    return Session.open(made)


def test_patterns_of_two_spans_by_hand() -> None:
    """M_B = −(w₁ + w₂) L²/16; in a span under w, R = wL/2 + M_B/L at its end and M = R²/2w at R/w."""
    length, found = 6.0, patterns().envelope()
    assert found.combinations == ("LR", "L", "R")
    assert not found.without
    at_support = {name: -(4.0 * 2 + 10.0 * len(name)) * 36.0 / 16.0 for name in found.combinations}
    least, most = found.extremes("M", 0)
    assert least == pytest.approx((at_support["LR"], length, least.combination))
    assert least.combination == "LR"
    end = 14.0 * 3.0 + at_support["L"] / length
    assert (most.value, most.distance) == pytest.approx((end**2 / 28.0, end / 14.0), rel=1e-12)
    assert most.combination == "L"
    assert found.reaction.values[:, 1, 1] == pytest.approx(
        [-2 * at_support["L"] / 6 + 54.0, 84.0 - 2 * at_support["LR"] / 6]
    )
    assert found.reaction.governing[:, 1, 1].tolist() == [1, 0]
    assert found.reaction.governing[:, 0, 0].tolist() == [-1, -1]  # nothing in any
    least, most = found.extremes("V", 0)
    assert (least.value, least.combination) == (pytest.approx(at_support["LR"] / 6 - 42.0), "LR")
    assert (most.value, most.combination) == (pytest.approx(end), "L")


@pytest.mark.parametrize(
    ("seed", "theory"), [(1, "first-order"), (2, "first-order"), (3, "exact"), (4, "first-order")]
)
def test_envelopes_by_brute_force(seed: int, theory: str) -> None:
    """The least and the most of N, V, M at many places of all combinations, each solved alone and shown."""
    document = frame(seed)
    document["settings"]["theory"] = theory
    lot = np.random.default_rng(seed)
    combinations = {
        f"C{k}": dict(zip(CASES, lot.uniform(-1.5, 1.5, 4).tolist(), strict=True)) for k in range(6)
    }
    document["settings"]["combinations"] = combinations
    if seed == 4:  # rods that yield, or not
        document["rods"][4] |= {"tensile_strength": 90.0, "compressive_strength": 90.0}
    session = Session.open(document)
    found = session.envelope()
    every = np.arange(session.rods.count)
    shares = np.linspace(0.0, 1.0, 41)
    along: dict[str, list[np.ndarray]] = {name: [] for name in "NVM"}
    stations: dict[str, list[np.ndarray]] = {name: [] for name in "NVM"}
    reactions, yields = [], []
    session.press("q")
    for name in combinations:
        session.model.settings.combination = name
        for letter in "NVM":
            curves = inner_forces(session.model, every, letter)
            along[letter].append(curves.at(shares))
            stations[letter].append(curves.at(found.shares[letter]))
        reactions.append(np.column_stack([session.particles.reaction, session.particles.reaction_moment]))
        yields.append(bool(session.rods.yielding.any()))
    assert any(yields) == (seed == 4)
    assert not all(yields)
    for letter in "NVM":
        values, bounds = np.array(stations[letter]), found.forces[letter].values
        size = np.abs(values).max()
        assert bounds[0] == pytest.approx(values.min(axis=0), abs=1e-9 * size)
        assert bounds[1] == pytest.approx(values.max(axis=0), abs=1e-9 * size)
        for row in every.tolist():
            least, most = found.extremes(letter, row)
            brute = np.array(along[letter])[:, row]
            assert least.value <= brute.min() + 1e-9 * size
            assert most.value >= brute.max() - 1e-9 * size
            where = curves_at(session, combinations, letter, row, least.distance)
            assert where[least.combination] == pytest.approx(least.value, abs=1e-6 * size)
    assert found.reaction.values[0] == pytest.approx(np.min(reactions, axis=0), abs=1e-8)
    assert found.reaction.values[1] == pytest.approx(np.max(reactions, axis=0), abs=1e-8)


def curves_at(session: Session, names: Any, letter: str, row: int, distance: float) -> dict[str, float]:
    """What a force at a place is in each combination, {"": …} of one of them."""
    share, found = np.array([distance / float(session.rods.original_length[row])]), {}
    for name in names:
        session.model.settings.combination = name
        found[name] = float(inner_forces(session.model, np.array([row]), letter).at(share)[0, 0])
    return found | {"": found[name]}


def test_combinations_without_a_solution_are_named() -> None:
    session = patterns(theory="exact")
    session.model.settings.combinations = {"good": {"permanent": 1.0}, "much": {"permanent": 1.0, "push": 1.0}}
    session.model.create(Load, on=[2], force=[(-9e4, 0.0)], case=["push"])
    found = session.envelope()
    assert found.combinations == ("good",)
    assert list(found.without) == ["much"]
    with pytest.raises(ValueError, match="bad"):
        session.envelope("bad")
    session.model.settings.combinations = {}
    with pytest.raises(ValueError, match="has no combinations"):
        session.envelope()
