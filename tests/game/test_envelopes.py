"""Load cases by command, script and hand: numbers of the bundled model, paths, sliders, division, copies, files, speed."""

import csv
import io
import json

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents.document import document
from pinjoint.systems.statics.envelope import States
from tests.reference.models import model, particle, rod

SPAN = 6.0


def over_supports(loads: tuple[float, float, float]) -> tuple[float, float]:
    """M_B and M_C of three equal spans, by the equations of three moments."""
    first, second, third = loads
    sums = [-(first + second) * SPAN**2 / 4.0, -(second + third) * SPAN**2 / 4.0]
    at_b, at_c = np.linalg.solve([[4.0, 1.0], [1.0, 4.0]], sums).tolist()
    return at_b, at_c


def test_the_bundled_model_by_three_moments() -> None:
    session = Session.open("load_cases")
    found = session.envelope()
    low, high = 1.35 * 4.0, 1.35 * 4.0 + 1.5 * 10.0
    least, most = found.extremes("M", 0)
    assert least == (pytest.approx(over_supports((high, high, low))[0]), SPAN, "spans 1 and 2")
    end = high * SPAN / 2.0 + over_supports((high, low, high))[0] / SPAN
    assert most == (pytest.approx(end**2 / 2.0 / high), pytest.approx(end / high), "spans 1 and 3")
    assert f"{least.value:.2f}".replace("-", "−") in session.model.description
    assert f"{most.value:.2f}" in session.model.description
    # Warmth: 4 B + C = 6 EI α T', by which B = C; a settlement of B: 4 B + C = 12 EI Δ/L², B + 4 C = −6 EI Δ/L².
    stiffness, expansion = 17550.0, 1.2e-5
    heat = session.statics(case="heat").final.diagrams["bending_moment"][0, 1]
    assert heat == pytest.approx(6.0 * stiffness * expansion * 20.0 / 5.0)
    sunk = session.statics(case="settlement").final.diagrams["bending_moment"][:2, 1]
    per = 6.0 * stiffness * 0.01 / SPAN**2
    assert sunk == pytest.approx(np.linalg.solve([[4.0, 1.0], [1.0, 4.0]], [2.0 * per, -per]))


def test_commands(capsys: pytest.CaptureFixture[str]) -> None:
    static = ["run", "load_cases", "--static", "--theory", "first-order"]
    assert main([*static, "--envelope"]) == 0
    assert "-82.44" in capsys.readouterr().out
    assert main([*static, "--envelope", "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["extremes"]["AB"]["M"][0]["combination"] == "spans 1 and 2"
    assert min(found["rods"]["AB"]["M"]["least"]) == pytest.approx(-82.44)
    assert main([*static, "--envelope", "--format", "csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    least = min(float(r["value"]) for r in rows if (r["name"], r["quantity"]) == ("AB", "M"))
    assert least == pytest.approx(-82.44)
    answers = []
    for more in (["--combination", "sun"], ["--set", "settings.combination=sun"], ["--case", "heat"]):
        assert main([*static, "--format", "json", *more]) == 0
        answers.append(json.loads(capsys.readouterr().out)["states"][0]["rods"]["AB"]["bending_moment"][1])
    assert answers[0] == answers[1] == pytest.approx(1.5 * answers[2] + 1.35 * over_supports((4.0,) * 3)[0])
    for wrong, said in [
        (["--combination", "moon"], "there is no combination 'moon'; choose one of spans 1 and 2"),
        (["--case", "moon"], "There is no load case 'moon'; choose one of permanent, settlement"),
    ]:
        assert main([*static, *wrong]) == 2
        assert said in capsys.readouterr().err
    assert main(["run", "load_cases", "--envelope"]) == 2
    assert main(["run", "portal", "--static", "--envelope"]) == 2  # it has none


def test_hands_on_loads_of_a_case() -> None:
    """Parts of a divided rod have its loads and warmth, of their cases; so have copies. What is found stays as it was."""
    session = Session.open("load_cases")
    session.model.create(type(session.span_loads[0]), rod=["AB"], start=[1.0], moment=[3.0], case=["live 1"])
    before = session.envelope()
    session.divide("AB", 3)
    after = session.envelope()
    assert after.reaction.values[:, :4] == pytest.approx(before.reaction.values, abs=1e-9)
    bounds = [[after.extremes("M", row)[side].value for row in (0, 3, 4)] for side in (0, 1)]
    whole = [one.value for one in before.extremes("M", 0)]
    assert [min(bounds[0]), max(bounds[1])] == pytest.approx(whole, abs=1e-9)
    session.undo()
    session.select(session.rods["AB"])
    session.press("ctrl+c")
    session.press("ctrl+v")
    cases = sorted(load.case for load in session.span_loads)
    assert cases.count("live 1") == 4
    assert cases.count("heat") == 4
    saved = document(session.model)
    assert document(Session.open(saved).model) == saved
    assert (Session.open(saved).envelope().forces["M"].values == session.envelope().forces["M"].values).all()


def test_a_slider_moves_a_settlement_and_motion_says_that_it_leaves_it_out() -> None:
    session = Session.open("load_cases")
    session.model.settings.combination = "sun and settlement"
    session.loads["sinking"].settlement = (0.0, -0.02)
    sunk = session.statics().final
    assert sunk.displacement[1, 1] == pytest.approx(-0.02)
    session.undo()
    assert session.statics().final.displacement[1, 1] == pytest.approx(-0.01)
    assert session.settle() == "equilibrium"
    assert session.particles["B"].displacement[1] == 0.0  # which would move again when statics begins
    session.run(time=0.001)
    assert "load sinking moves no support" in session.message
    session.loads["sinking"].settlement = (0.005, 0.0)
    assert "no rigid support holds particle B" in session.statics().account


def test_motion_has_the_loads_of_the_combination() -> None:
    """A particle of 2 kg by a load of 3 N × 1.5 and its weight × 0: v = a t; then by a ramp of another case."""
    made = model([particle("A", 0, 0, mass=2.0)], [], environment={"acceleration": [0.0, -9.81]})
    made["loads"] = [
        {"on": "A", "force": [0.003, 0.0], "case": "wind"},
        {"on": "A", "force": [0.0, 0.004], "history": {"kind": "ramp", "duration": 1.0}, "case": "snow"},
    ]
    made["settings"] = {"combinations": {"C": {"wind": 1.5, "snow": 0.5}}, "combination": "C"}
    session = Session.open(made)
    session.run(time=1.0)
    assert session.particles["A"].velocity == pytest.approx((1.5 * 1.5, 0.5 * 2.0 / 2.0), rel=1e-7)
    session.model.settings.combination = ""
    session.run(time=1.0)
    assert session.particles["A"].velocity[0] == pytest.approx(1.5 * 1.5 + 1.5, rel=1e-7)


def test_fifty_combinations_of_a_frame_at_once() -> None:
    """19 storeys of 12 bays: N, V, M of all members and all reactions; `bench editing` times as many."""
    storeys, bays = 19, 12
    clamp = {"fixed": [True, True], "fixed_rotation": True}
    particles = [
        particle(f"{i},{j}", 4.0 * i, 3.0 * j, **(clamp if j == 0 else {}))
        for j in range(storeys + 1)
        for i in range(bays + 1)
    ]
    stiff = {"stiffness": 1e6, "bending_stiffness": 2e4}
    rods = [rod(f"{i},{j - 1}", f"{i},{j}", **stiff) for j in range(1, storeys + 1) for i in range(bays + 1)]
    rods += [rod(f"{i},{j}", f"{i + 1},{j}", **stiff) for j in range(1, storeys + 1) for i in range(bays)]
    lot, made = np.random.default_rng(1), model(particles, rods)
    force = {"start_intensity": [0, -4], "end_intensity": [0, -9], "force": [0, -5]}
    made["span_loads"] = [
        {"rod": rods[row]["name"], "case": f"c{case}"} | force
        for case in range(50)
        for row in lot.choice(len(rods), 20, replace=False).tolist()
    ]
    made["settings"] = {"theory": "first-order"}
    session = Session.open(made)
    chosen = {f"c{case}": {f"c{case}": 1.0} for case in range(50)}
    found, true = States.superposed(session.model, chosen, 1.0)
    assert true.all()
    single = session.statics(case="c7").final
    assert found.reaction[7, :, :2] == pytest.approx(single.reaction, abs=1e-9)
    moments = found.forces["M"].some(np.arange(7 * len(rods), 8 * len(rods))).at(np.array([0.0]))
    assert moments[:, 0] == pytest.approx(single.diagrams["bending_moment"][:, 0], abs=1e-9)
