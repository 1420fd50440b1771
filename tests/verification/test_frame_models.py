"""What the bundled models of members that bend say in their descriptions: textbooks' numbers against the program."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.models import parse
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.limit_analysis import LimitLoad
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import StaticState
from pinjoint.systems.statics.theory import linear


def document(name: str) -> dict[str, Any]:
    return models.document(models.load(name))


def first_order(content: dict[str, Any]) -> tuple[Model, StaticState]:
    model = parse(content)
    return model, linear(model)


def along(model: Model, state: StaticState, quantity: str, rod: str) -> list[float]:
    """A quantity at both ends of a rod."""
    found: list[float] = state.diagrams[quantity][model.rods[rod].row].tolist()
    return found


def stiffened(content: dict[str, Any], factor: float) -> dict[str, Any]:
    """A frame whose members stretch so much less."""
    rods = [rod | {"stiffness": rod["stiffness"] * factor} for rod in content["rods"]]
    return content | {"rods": rods}


def divided(name: str) -> dict[str, Any]:
    """A chain of rods with each of them halved."""
    content = document(name)
    for rod in [rod for rod in content["rods"] if rod["name"] != "cable"]:
        first, second = (next(p for p in content["particles"] if p["name"] == end) for end in rod["between"])
        middle = [0.5 * (a + b) for a, b in zip(first["position"], second["position"], strict=True)]
        content["particles"].append({"name": f"{rod['name']}/2", "position": middle})
        content["rods"].append(
            rod | {"name": f"{rod['name']}+", "between": [f"{rod['name']}/2", second["name"]]}
        )
        rod["between"] = [first["name"], f"{rod['name']}/2"]
    return content


def test_the_portal_has_the_moments_of_members_that_only_bend() -> None:
    """With (I_b/h)/(I_c/L)·… = 1: qL²/18 and qL²/36 by weight, 3Hh/14 and 4Hh/14 by wind; nearly so as it stretches."""
    weight, wind = 20.0 * 6.0**2, 35.0 * 4.0
    exact = {
        ("AB", 0): weight / 36 - wind * 4 / 14,
        ("AB", 1): -weight / 18 + wind * 3 / 14,
        ("CD", 0): -weight / 18 - wind * 3 / 14,
        ("CD", 1): weight / 36 + wind * 4 / 14,
    }
    assert [round(moment) for moment in exact.values()] == [-20, -10, -70, 60]
    for factor, within in ((1.0, 6e-3), (1e6, 1e-7)):
        model, state = first_order(stiffened(document("portal"), factor))
        for (rod, end), moment in exact.items():
            assert along(model, state, "bending_moment", rod)[end] == pytest.approx(moment, abs=within * 70.0)


def test_the_columns_of_a_storey_bear_the_wind_above_it_together() -> None:
    model, state = first_order(document("two_storey_frame"))
    for columns, wind in ((("AC", "BD"), 50.0), (("CE", "DF"), 30.0)):
        names = ["-".join(column) if "-".join(column) in model.rods.names else column for column in columns]
        assert sum(along(model, state, "shear", name)[0] for name in names) == pytest.approx(wind, rel=1e-9)


def test_equilibrium_alone_solves_the_gerber_beam() -> None:
    for change in (lambda c: None, lambda c: c["particles"][4].update(position=[14, 0.05])):
        content = document("gerber_beam")
        change(content)
        model, state = first_order(content)
        largest = state.diagrams["largest_moment"]
        assert along(model, state, "bending_moment", "AB")[1] == pytest.approx(-60.0, rel=1e-3)
        assert largest[model.rods["GH"].row][0] == pytest.approx(20.0, rel=1e-9)
    model, state = first_order(document("gerber_beam"))
    assert along(model, state, "bending_moment", "HC")[1] == pytest.approx(-60.0, rel=1e-9)
    assert along(model, state, "bending_moment", "BG") == pytest.approx([-60.0, 0.0], rel=1e-9, abs=1e-9)


def test_the_three_hinged_arch_bends_under_half_of_its_load_only() -> None:
    half, whole = document("three_hinged_arch"), document("three_hinged_arch")
    for load in whole["loads"]:
        load["force"] = [0.0, -10.0]
    model, state = first_order(half)
    moments = [along(model, state, "bending_moment", rod.name)[1] for rod in model.rods]
    assert moments == pytest.approx([30, 40, 30, 0, -30, -40, -30, 0], rel=1e-9, abs=1e-9)
    assert state.reaction[0] == pytest.approx([40.0, 50.0], rel=1e-9)
    model, state = first_order(whole)
    assert np.abs(state.diagrams["bending_moment"]).max() < 1e-9 * 80.0
    assert state.reaction[0] == pytest.approx([10.0 * 16.0**2 / (8.0 * 4.0), 70.0], rel=1e-9)


def test_the_chords_of_the_vierendeel_girder_share_the_shear() -> None:
    model, state = first_order(document("vierendeel"))
    for panel, shear in enumerate((50.0, 30.0, 10.0, -10.0, -30.0, -50.0)):
        both = [along(model, state, "shear", f"{chord}{panel}-{chord}{panel + 1}")[0] for chord in "LU"]
        assert sum(both) == pytest.approx(shear, rel=1e-9)
        assert both[0] == pytest.approx(both[1], rel=0.01)
    ends = along(model, state, "bending_moment", "L0-L1")
    assert ends == pytest.approx([-25.0, 25.0], rel=0.06)


@pytest.mark.parametrize(
    ("name", "load", "limit", "within"),
    [("williams_toggle", 0.16, 0.1509, 1e-3), ("lees_frame", 2.0, 1.8557, 1e-4)],
)
def test_limit_loads_of_toggle_and_angle(name: str, load: float, limit: float, within: float) -> None:
    """As said, and as near to that of rods half as long as the element promises."""
    found = []
    for content in (document(name), divided(name)):
        events = [event for event in settle(parse(content)).final.events if event.kind == "snap-through"]
        found.append(load * events[0].load_factor)
    assert found[0] == pytest.approx(limit, rel=5e-4)
    assert found[0] == pytest.approx(found[1], rel=within)


def test_a_moment_rolls_the_cantilever_into_a_circle() -> None:
    content = document("rolled_cantilever")
    assert content["loads"][0]["moment"] == pytest.approx(2.0 * math.pi * 10.0 / 5.0, rel=1e-12)
    model = parse(content)
    state = settle(model).final
    places = model.particles.position + state.displacement
    assert np.abs(places[-1]).max() < 1e-9
    assert state.rotation[-1] == pytest.approx(2.0 * math.pi, rel=1e-11)
    radius = np.hypot(*(places - 0.5 * (places[0] + places[10])).T)
    assert radius == pytest.approx(np.full(21, 5.0 / (2.0 * math.pi)), rel=1.01 * 0.81 / 20**4)
    assert np.abs(state.diagrams["bending_moment"]) == pytest.approx(4.0 * math.pi, rel=1e-9)


def test_four_columns_buckle_under_eulers_loads() -> None:
    """π²EI/(βL)² with tan(π/β) = π/β of the third; errors of eight rods as the table of the element says."""
    content = document("eulers_columns")
    for particle in content["particles"]:
        particle.pop("force", None)
    beta = np.array([2.0, 1.0, math.pi / 4.493409457909064, 0.5])
    alone = [content | {"loads": [load]} for load in content["loads"]]
    critical = [3.0 * float(Buckling.of(parse(one), count=1).factors[0]) for one in alone]
    assert critical == pytest.approx(10.0 / beta**2, rel=6e-4)
    assert np.round(10.0 / beta**2, 2).tolist() == [2.5, 10.0, 20.46, 40.0]


@pytest.mark.parametrize(
    ("name", "hinges"),
    [
        ("fixed_beam_collapse", {"A": 1.2, "C": 1.2, "B": 1.6}),
        ("portal_collapse", {"E": 0, "D": 0, "A": 0, "C": 1.5}),
    ],
)
def test_plastic_hinges_form_by_the_formulas_of_the_descriptions(name: str, hinges: dict[str, float]) -> None:
    """12 and 16 M_p/L² of the beam of 10 kN/m; 6 M_p = λ (4 H + 3 V) of the portal; a factor of 0 is not asked for."""
    model = models.load(name)
    found = settle(model, 2.0, "first-order").events
    told = [(e.place["particle"], e.load_factor) for e in found if e.kind == "hinge"]
    assert [particle for particle, _ in told] == list(hinges)
    for particle, factor in told:
        assert not hinges[particle] or factor == pytest.approx(hinges[particle], rel=1e-9)
    assert LimitLoad.of(model).factor == pytest.approx(max(hinges.values()), rel=1e-9)
    shown = settle(model, model.settings.load_steps, "first-order").final
    span = along(model, shown, "bending_moment", "BC")
    if name == "fixed_beam_collapse":
        assert span == pytest.approx([48.0, -64.0], rel=1e-6)
    assert sum(factor < model.settings.load_steps[-1] for _, factor in told) == 2


@pytest.mark.parametrize(
    ("push", "weight", "factor"), [(14.9, 40.0, 4 / (3 * 40)), (60.1, 40.0, 4 / (4 * 60.1))]
)
def test_the_beam_or_the_sway_of_the_portal_may_collapse_alone(
    push: float, weight: float, factor: float
) -> None:
    model = models.load("portal_collapse")
    model.loads["H"].force, model.loads["V"].force = (push, 0.0), (0.0, -weight)
    assert LimitLoad.of(model).factor == pytest.approx(70.0 * factor, rel=1e-9)


def test_the_frame_sways_ten_times_as_far_in_resonance() -> None:
    session = Session.open("sway_resonance")
    static = parse(document("sway_resonance") | {"loads": [{"on": "B", "force": [5.0, 0.0]}]})
    sway = linear(static).displacement[1, 0]
    assert sway == pytest.approx(4.6e-3, rel=0.01)
    session.run(time=10.0)
    largest = 0.0
    for _ in range(82):
        session.run(time=0.01)
        largest = max(largest, abs(session.particles["B"].displacement[0]))
    assert largest == pytest.approx(10.0 * sway, rel=0.02)
    assert abs(session.energy.imbalance) < 1e-6


def test_the_flexible_pendulum_keeps_its_energy_and_a_stiff_one_its_period() -> None:
    session = Session.open("flexible_pendulum")
    session.run(time=1.0)
    assert abs(session.energy.imbalance) < 1e-11 * 40.0
    stiff = document("flexible_pendulum")
    stiff["rods"] = [rod | {"bending_stiffness": 20.0} for rod in stiff["rods"]]
    session = Session.open(stiff)
    period = 2.0 * math.pi * math.sqrt(2.0 * 2.0 / (3.0 * 9.81)) * 1.1803
    assert period == pytest.approx(2.73, abs=0.005)
    session.run(time=0.5 * period)
    tip = session.particles["P12"]
    assert tip.position[0] + tip.displacement[0] == pytest.approx(-2.0, rel=1e-3)


def test_ball_and_corner_part_by_newtons_law() -> None:
    session = Session.open("ball_on_frame")
    session.run(time=1.0)
    while not session.model.clock.collisions:
        before = session.particles["ball"].velocity
        session.run(time=1e-4)
    assert before[0] == pytest.approx(math.sqrt(2.0 * 9.81 * 2.0), rel=1e-3)
    ball, corner = session.particles["ball"], session.particles["B"]
    assert (ball.mass, corner.mass) == (300.0, 645.0)
    shared = 1.5 * before[0] * 300.0 / 945.0
    assert ball.velocity[0] == pytest.approx(before[0] - shared * 645.0 / 300.0, abs=0.01)
    assert corner.velocity[0] == pytest.approx(shared, rel=0.05)
    assert (round(ball.velocity[0], 2), round(shared, 2)) == (-0.15, 2.98)


@pytest.mark.parametrize(
    ("name", "duration"), [("portal", 0.5), ("flexible_pendulum", 0.5), ("rolled_cantilever", 0.5)]
)
def test_defaults_are_exact_to_a_millionth(name: str, duration: float) -> None:
    """Against a tolerance of 1e-12, of the largest displacement and rotation."""
    content, found = document(name), []
    for settings in ({}, {"integrator": "dop853", "tolerance": 1e-12}):
        session = Session.open(content | {"settings": content["settings"] | settings})
        session.run(time=duration)
        particles = session.particles
        found.append(
            [particles.displacement.copy(), particles.rotation.copy(), session.rods.bending_moment.copy()]
        )
    for default, tight in zip(*found, strict=True):
        assert np.abs(default - tight).max() <= 1e-6 * np.abs(tight).max()
