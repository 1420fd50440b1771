"""Linear buckling: Euler's four loads, portals, columns under their own weight, and textbook matrices, assembled slowly."""

import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.systems.statics.buckling import Buckling
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import linear
from tests.reference.models import CLAMPED, PINNED, line, model, particle, rod

EI, LENGTH = 1000.0, 10.0
HEADS: dict[str, dict[str, Any]] = {
    "free": {},
    "pinned": {"fixed": [True, False]},
    "clamped": {"fixed": [True, False], "fixed_rotation": True},
}


def column(parts: int, foot: dict[str, Any], head: dict[str, Any], **facts: Any) -> dict[str, Any]:
    """An upright column of equal rods; what its head has besides."""
    places = [(0.0, LENGTH * i / parts) for i in range(parts + 1)]
    stiff = {"stiffness": 1e8, "bending_stiffness": EI, "density": 0.0, **facts}
    return line(places, foot, {"force": [0.0, -1.0], **head}, **stiff)


# tan u = u of the column that is clamped and pinned
CASES = [
    (CLAMPED, "free", math.pi / 2, {1: 7.52e-3, 2: 5.12e-4, 4: 3.28e-5, 8: 2.06e-6, 16: 1.29e-7}),
    (PINNED, "pinned", math.pi, {1: 0.2159, 2: 7.52e-3, 4: 5.12e-4, 8: 3.28e-5, 16: 2.06e-6}),
    (CLAMPED, "pinned", 4.493409457909064, {1: 0.4858, 2: 2.57e-2, 4: 2.05e-3, 8: 1.36e-4, 16: 8.60e-6}),
    (CLAMPED, "clamped", 2 * math.pi, {2: 1.32e-2, 4: 7.52e-3, 8: 5.12e-4, 16: 3.28e-5}),
]


@pytest.mark.parametrize(("foot", "head", "root", "errors"), CASES)
def test_eulers_four_loads(foot: dict[str, Any], head: str, root: float, errors: dict[int, float]) -> None:
    """P = u² EI/L²: the error of so many rods, of fourth order; the mode and the effective length π L/u."""
    for parts, error in errors.items():
        found = Buckling.of(parse(column(parts, foot, HEADS[head])))
        critical = root**2 * EI / LENGTH**2
        assert found.factors[0] / critical - 1.0 == pytest.approx(error, rel=0.01)
        assert found.effective_length == pytest.approx(math.pi * LENGTH / root / math.sqrt(1 + error), rel=1e-4)
        assert found.live == pytest.approx(-1.0, rel=1e-12)


def test_the_mode_of_a_pinned_column_is_a_sine() -> None:
    mode = Buckling.of(parse(column(8, PINNED, HEADS["pinned"]))).modes[0]
    along = math.pi * np.arange(9) / 8
    assert mode[:, 0] == pytest.approx(np.sin(along), abs=1e-5)
    assert mode[:, 2] == pytest.approx(-math.pi / LENGTH * np.cos(along), abs=1e-4)


@pytest.mark.parametrize("parts", [250])
def test_many_rods_are_solved_sparsely(parts: int) -> None:
    found = Buckling.of(parse(column(parts, CLAMPED, HEADS["free"], stiffness=1e5)), count=3)
    expected = [((2 * k + 1) * math.pi / 2 / LENGTH) ** 2 * EI for k in range(3)]
    assert found.factors == pytest.approx(expected, rel=1e-7)


def test_a_column_under_its_own_distributed_weight() -> None:
    """(q L)cr = 7.8373 EI/L²."""
    errors = []
    for parts in (2, 4, 8):
        own = column(parts, CLAMPED, {"force": [0.0, 0.0]}, distributed_force=[0.0, -1.0])
        errors.append(Buckling.of(parse(own)).factors[0] * LENGTH**3 / EI / 7.837347438943446 - 1.0)
    assert errors[0] < 0.02
    assert abs(errors[2]) < 5e-5
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.2)


def test_weight_acts_in_full_and_does_not_grow() -> None:
    """Half the critical load weighs on the column: so the force may be the other half."""
    light = column(4, CLAMPED, HEADS["free"])
    critical = Buckling.of(parse(light)).factors[0]
    heavy = column(4, CLAMPED, HEADS["free"])
    for each in heavy["particles"]:
        each["mass"] = 1000.0 if each["name"] == "P4" else 1e-9
    heavy["environment"] = {"acceleration": [0.0, -0.5 * critical]}
    found = Buckling.of(parse(heavy))
    assert found.factors[0] == pytest.approx(0.5 * critical, rel=1e-9)
    assert found.dead == pytest.approx(-0.5 * critical, rel=1e-9)
    heavy["environment"] = {"acceleration": [0.0, -1.1 * critical]}
    with pytest.raises(NoEquilibrium, match="already buckles under what the load factor does not multiply"):
        Buckling.of(parse(heavy))


def portal(parts: int, foot: dict[str, Any], beam: float) -> dict[str, Any]:
    """Columns 4 m high and a beam 6 m long, each of so many rods; both columns loaded by 1 kN."""
    corners = {"A": (0.0, 0.0), "B": (0.0, 4.0), "C": (6.0, 4.0), "D": (6.0, 0.0)}
    particles: list[dict[str, Any]] = [
        {"name": name, "position": list(at), **(foot if name in "AD" else {"force": [0.0, -1.0]})}
        for name, at in corners.items()
    ]
    rods = []
    for first, last, stiffness in (("A", "B", EI), ("B", "C", beam), ("D", "C", EI)):
        chain = [first, *(f"{first}{last}{i}" for i in range(1, parts)), last]
        start, end = np.array(corners[first]), np.array(corners[last])
        particles += [
            {"name": name, "position": (start + (end - start) * i / parts).tolist()}
            for i, name in enumerate(chain[1:-1], start=1)
        ]
        rods += [
            {"name": f"{a}-{b}", "between": [a, b], "stiffness": 1e9, "bending_stiffness": stiffness}
            for a, b in itertools.pairwise(chain)
        ]
    return model(particles, rods)


@pytest.mark.parametrize("beam", [300.0, 3000.0, 30000.0])
@pytest.mark.parametrize("foot", [CLAMPED, PINNED])
def test_portals_sway(foot: dict[str, Any], beam: float) -> None:
    """Feet clamped: u cot u = −6 β; pinned: u tan u = 6 β; β = (EI_b/l)/(EI_c/h)."""
    ratio = 6.0 * (beam / 6.0) / (EI / 4.0)
    if foot is CLAMPED:
        root = brentq(lambda u: u * math.cos(u) + ratio * math.sin(u), math.pi / 2, math.pi)
    else:
        root = brentq(lambda u: u * math.sin(u) - ratio * math.cos(u), 0.0, math.pi / 2)
    critical = root**2 * EI / 16.0
    errors = [Buckling.of(parse(portal(parts, foot, beam))).factors[0] / critical - 1.0 for parts in (1, 4)]
    assert 0.0 < errors[0] < (0.008 if foot is PINNED else 0.03)
    assert 0.0 < errors[1] < 6e-4


def textbook(made: Model) -> float:
    """The lowest critical factor by the matrices of textbooks (6/5, L/10, 2L²/15, −L²/30), one rod after another."""
    axial = linear(made).axial_force
    count = made.particles.count
    stiffness, geometric = np.zeros((2, 3 * count, 3 * count))
    for row in range(made.rods.count):
        rod = made.rods[row]
        (dx, dy), ea, ei = rod.difference, rod.stiffness, rod.bending_stiffness
        h = math.hypot(dx, dy)
        c, s = dx / h, dy / h
        turn = np.kron(np.eye(2), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
        bar = np.zeros((6, 6))
        bar[np.ix_([0, 3], [0, 3])] = ea / h * np.array([[1, -1], [-1, 1]])
        beam = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]])
        beam = np.array([*beam, -beam[0], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) * ei / h**3
        bar[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] += beam
        tension = np.zeros((6, 6))
        if ei:
            string = np.array(
                [
                    [36, 3 * h, -36, 3 * h],
                    [3 * h, 4 * h * h, -3 * h, -h * h],
                    [-36, -3 * h, 36, -3 * h],
                    [3 * h, -h * h, -3 * h, 4 * h * h],
                ]
            ) / (30 * h)
            tension[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = string
        else:
            tension[np.ix_([1, 4], [1, 4])] = np.array([[1, -1], [-1, 1]]) / h
        ends = made.rods.between[row].astype(int)
        place = np.concatenate([3 * end + np.arange(3) for end in ends])
        stiffness[np.ix_(place, place)] += turn.T @ bar @ turn
        geometric[np.ix_(place, place)] += axial[row] * turn.T @ tension @ turn
    turns = made.particles.inertia > 0.0
    free = np.column_stack([~made.particles.fixed, turns & ~made.particles.fixed_rotation]).ravel()
    values = eigh(-geometric[free][:, free], stiffness[free][:, free], eigvals_only=True)
    return float(1.0 / values[-1])


@pytest.mark.parametrize("number", range(6))
def test_random_frames_and_trusses_against_textbook_matrices(number: int) -> None:
    lot = np.random.default_rng([91, number])
    particles = [
        particle(
            f"P{i}",
            2.0 * (i // 2) + lot.uniform(-0.3, 0.3),
            3.0 * (i % 2) + lot.uniform(-0.3, 0.3),
            force=lot.normal(0.0, 10.0, 2).tolist(),
            **({0: PINNED, 1: CLAMPED}.get(i, {})),
        )
        for i in range(8)
    ]
    pairs = [(i, j) for i in range(8) for j in range(i + 1, 8) if j - i <= 2 or (j - i == 3 and i % 2)]
    bends = lot.random(len(pairs)) < (0.6 if number < 4 else 0.0)
    rods = [
        rod(f"P{i}", f"P{j}", stiffness=1e5, bending_stiffness=float(lot.uniform(20.0, 400.0)) if bent else 0.0)
        for (i, j), bent in zip(pairs, bends.tolist(), strict=True)
    ]
    made = parse(model(particles, rods))
    assert Buckling.of(made).factors[0] == pytest.approx(textbook(made), rel=1e-9)


def test_a_vierendeel_girder_gives_way_in_its_upper_chord() -> None:
    bays = 4
    particles = [particle(f"{side}{i}", 3.0 * i, 2.0 * (side == "U")) for i in range(bays + 1) for side in "LU"]
    particles[0] |= PINNED
    particles[2 * bays] |= {"fixed": [False, True]}
    particles[2 * (bays // 2) + 1]["force"] = [0.0, -10.0]
    pairs = [(f"{side}{i}", f"{side}{i + 1}") for side in "LU" for i in range(bays)]
    pairs += [(f"L{i}", f"U{i}") for i in range(bays + 1)]
    rods = [rod(*ends, stiffness=2e5, bending_stiffness=500.0) for ends in pairs]
    made = parse(model(particles, rods))
    found = Buckling.of(made)
    assert found.factors[0] == pytest.approx(textbook(made), rel=1e-9)
    names = made.particles.names
    pressed = {
        name for name, length in zip(made.rods.names, found.effective_length, strict=True) if length > 0.0
    }
    assert {"U1U2", "U2U3"} <= pressed
    assert not {"L1L2", "L2L3"} & pressed
    assert len(names) == 10


def test_a_shallow_truss_and_one_in_a_line() -> None:
    """Von Mises: K₀ = 2 EA/L (H/L)², K_G = 2 N/L (b/L)². In a line nothing resists."""
    session = Session.open("von_mises")
    found, rods = session.buckling(), session.model.rods
    (span, height) = np.abs(rods.difference[0])
    assert -found.factors[0] * found.live[0] == pytest.approx(
        rods.stiffness[0] * height**2 / span**2, rel=1e-12
    )
    line = column(2, PINNED, HEADS["pinned"], bending_stiffness=0.0)
    with pytest.raises(
        NoEquilibrium, match="a mechanism, which has no buckling load: nothing resists moving P1 along x"
    ):
        Buckling.of(parse(line))


def test_tension_holds_a_mechanism_beside_a_column() -> None:
    """A bar that hangs, loaded, beside the column: the column's load remains the answer."""
    document = column(4, CLAMPED, HEADS["free"])
    document["particles"] += [particle("top", 3.0, 9.0, **PINNED), particle("bob", 3.0, 5.0, force=[0.0, -1.0])]
    document["rods"].append(rod("top", "bob", stiffness=1e5))
    critical = (math.pi / 2 / LENGTH) ** 2 * EI
    assert Buckling.of(parse(document)).factors[0] == pytest.approx(critical * (1 + 3.28e-5), rel=1e-6)


def test_what_cannot_buckle_says_why() -> None:
    pulled = Buckling.of(parse(column(2, CLAMPED, {"force": [0.0, 1.0]})))
    assert not len(pulled.factors)
    assert pulled.message.startswith("The forces and loads compress no rod")
    held = Buckling.of(parse(column(1, CLAMPED, HEADS["clamped"])))
    assert "the ends of the compressed rod R0 cannot move sideways" in held.message
    bare = Buckling.of(parse(column(1, CLAMPED, {"force": [0.0, 0.0]})))
    assert bare.message.startswith("No force or load acts")
    strut = Buckling.of(parse(column(1, PINNED, HEADS["pinned"], hinged=[True, True])))
    assert not len(strut.factors)


def _with_a_short_beam(length: float) -> Model:
    """A frame of which the ends of a rod turn a billion times as hard as others."""
    frame = Session.open("two_storey_frame").model
    frame.particles[2].position = 6.00000000000114, 0.0
    frame.particles[4].position = 6.0 + length, 7.0
    frame.particles[1].force = 0.0, -33789827153.788177
    frame.rods[4].stiffness = 7.7345620118367115
    return frame


def test_very_short_rods_leave_the_loads_of_the_others_as_they_are() -> None:
    found, longer = Buckling.of(_with_a_short_beam(7.434768331e-6), 2), Buckling.of(_with_a_short_beam(7e-5), 2)
    assert found.factors == pytest.approx(longer.factors, rel=1e-4)


def test_what_round_off_alone_resists_has_no_answer() -> None:
    """The lowest load would be whatever is added to have it computed."""
    frame = Session.open("hyperstatic").model
    frame.rods[1].bending_stiffness, frame.rods[3].bending_stiffness = 48.69781049172676, 95464805.12276378
    frame.particles[0].position = 1.5000000000135028, 1.5000000000135028
    frame.particles[3].force = 0.0, -2783206662.9832897
    with pytest.raises(NoEquilibrium, match="stiffnesses less unequal"):
        Buckling.of(frame)


def test_notes_name_struts_and_strains() -> None:
    document = model(
        [
            particle("A", 0.0, 0.0, **PINNED),
            particle("B", 3.0, 4.0, force=[0.0, -10.0]),
            particle("C", 6.0, 0.0, **PINNED),
        ],
        [rod("A", "B", bending_stiffness=100.0, hinged=[True, True]), rod("B", "C")],
    )
    found = Buckling.of(parse(document))
    assert "is shortened by" in found.notes[0]
    assert "At a lower load, rod AB would buckle between its hinges" in found.notes[1]
    (coarse,) = Buckling.of(parse(column(1, PINNED, HEADS["pinned"]))).notes
    assert "Rod R0 bends more between its ends than a single rod can represent" in coarse
    assert not Buckling.of(parse(column(1, CLAMPED, HEADS["free"]))).notes


# --- the command -----------------------------------------------------------------------------------------


# --- about an exact equilibrium ------------------------------------------------------------------------


def about(made: Model, factor: float, count: int = 2) -> Buckling:
    """From the exact equilibrium at a load factor on."""
    return Buckling.of(made, count, settle(made, factor).equilibrium)


def test_a_straight_column_gives_way_a_little_later_since_it_is_shorter() -> None:
    """At P_E (1 + P_E/EA), the length being L (1 − P/EA); told from far below by a line, which errs by as much again, and
    by the square of what is missing. Of eight rods."""
    made = parse(column(8, PINNED, HEADS["pinned"], stiffness=1e5))
    linear_factor = Buckling.of(made).factors[0]
    strain = linear_factor / 1e5
    told = {share: about(made, share * linear_factor) for share in (0.01, 0.5, 0.75, 0.9999)}
    later = {share: found.factors[0] / linear_factor - 1.0 for share, found in told.items()}
    assert later[0.9999] == pytest.approx(strain, rel=0.02)
    assert later[0.01] == pytest.approx(2.0 * strain, rel=0.02)
    errors = [later[share] - later[0.9999] for share in (0.5, 0.75)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    assert told[0.5].effective_length == pytest.approx(LENGTH, rel=1e-3)
    assert "exact equilibrium at the load factor 49.35" in told[0.5].notes[0]


def test_the_limit_load_of_a_shallow_truss_is_approached_by_first_order() -> None:
    """P(w) = 2 EA (1/l − 1/L) (h − w): the stiffness falls like the root of what is missing to its largest value, so that
    the line from there ends as far behind it."""
    session = Session.open("von_mises")
    made, (span, height) = session.model, np.abs(session.model.rods.difference[0])
    length, stiffness = np.hypot(span, height), session.model.rods.stiffness[0]
    low = math.sqrt((span**2 * length) ** (2 / 3) - span**2)  # h − w at the limit, where l³ = b² L
    limit = (
        2.0
        * stiffness
        * low
        * (1.0 / np.hypot(span, low) - 1.0 / length)
        / -sum(one.force[1] for one in made.loads)
    )
    assert Buckling.of(made).factors[0] > 5.0 * limit
    for missing in (1e-2, 1e-4, 1e-6):
        beyond = about(made, (1.0 - missing) * limit).factors[0] / limit - 1.0
        assert beyond / missing == pytest.approx(1.0, abs=0.55 * missing**0.5)
    with pytest.raises(NoEquilibrium, match="not stable"):
        about(parse(column(1, PINNED, {"force": [0.0, 0.0]})), 1.0)


@pytest.mark.parametrize(
    ("moment", "share", "later"), [(1e-3, 0.5, 1.3e-5), (1e-2, 0.9, 1.5e-3), (0.1, 0.5, 1.9e-3)]
)
def test_an_eccentric_load_is_told_near_eulers(moment: float, share: float, later: float) -> None:
    """By 1 mm to 10 cm of 10 m; a column that bows as far as a tenth of its length grows stiffer (elastica)."""
    document = column(8, PINNED, HEADS["pinned"], stiffness=1e7)
    for end, sign in ((0, 1.0), (-1, -1.0)):
        document["particles"][end]["moment"] = sign * moment
    made = parse(document)
    euler = Buckling.of(made).factors[0]
    assert about(made, share * euler).factors[0] / euler - 1.0 == pytest.approx(later, rel=0.05)
    bowed = settle(made, share * euler).final.displacement[4, 0]
    secant = moment * (1.0 / math.cos(0.5 * math.pi * math.sqrt(share)) - 1.0)
    assert abs(bowed) == pytest.approx(secant, rel=5e-3)
    if moment == 0.1:
        far = about(made, 0.99 * euler)
        assert len(far.factors) == 0
        assert "makes the structure stiffer" in far.message


def test_the_command_tells_from_the_exact_equilibrium_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "column.json"
    path.write_text(json.dumps(column(8, PINNED, HEADS["pinned"], stiffness=1e5)), encoding="utf-8")
    assert main(["buckling", str(path), "--theory", "exact", "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["factors"][0] == pytest.approx(98.89, abs=0.01)
    assert found["axial_force"]["R1"]["factor 1"] == pytest.approx(-1.0, rel=1e-6)
    assert Session.open(str(path)).buckling(1, theory="exact").factors[0] == pytest.approx(
        found["factors"][0], rel=1e-9
    )
    assert main(["buckling", str(path), "--theory", "exact", "--set", "particles.P8.force=1,0"]) == 1


def test_the_command_prints_factors_modes_and_effective_lengths(
    answer: Any, capsys: pytest.CaptureFixture[str], tmp_path: Any
) -> None:
    path = tmp_path / "model.json"
    found = answer("buckling", column(2, CLAMPED, HEADS["free"]), "--modes", "2")
    assert len(found["factors"]) == len(found["modes"]) == 2
    assert found["factors"] == sorted(found["factors"])
    assert set(found["modes"][0]) == {"P0", "P1", "P2"}
    assert found["modes"][0]["P0"] == [0.0, 0.0, 0.0]
    assert len(found["modes"][0]["P2"]) == 3
    assert found["effective_length"]["R0"] == pytest.approx(20.0, rel=1e-3)
    assert found["leading"][0] == {"rod": "R1", "effective_length": pytest.approx(20.0, rel=1e-3)}
    assert found["effective_length_factor"]["R0"] == pytest.approx(2.0, rel=1e-3), "of both rods"
    assert found["axial_force"]["R0"] == pytest.approx(
        {"steady": 0.0, "factor 1": -1.0, "critical": -found["factors"][0]}, abs=1e-9
    )
    assert main(["buckling", str(path)]) == 0
    out = capsys.readouterr().out
    assert "mode 1" in out
    assert "effective length, m" in out
    assert main(["buckling", str(path), "--format", "csv", "--modes", "1"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "mode,factor,particle,x,y,rotation"


def test_the_command_says_why_there_is_no_factor(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["buckling", "collision_i"]) == 1
    assert "No force or load acts on the rods" in capsys.readouterr().out
    assert main(["buckling", "pendulum"]) == 1
    assert "Mechanism: the load moves bob" in capsys.readouterr().err


def test_few_modes_of_many_unknowns_are_found() -> None:
    """A hanging net of bars with one that is pushed: beside few critical factors, nearly all eigenvalues are 0."""
    side = 9
    particles = [
        particle(f"{i}.{j}", i, j, **(PINNED if j == side - 1 else {"force": [0.0, -1.0]}))
        for i in range(side)
        for j in range(side)
    ]
    steps = ((1, 0), (0, 1), (1, 1))
    rods = [
        rod(f"{i}.{j}", f"{i + a}.{j + b}")
        for i in range(side)
        for j in range(side)
        for a, b in steps
        if i + a < side and j + b < side
    ]
    pulled = Buckling.of(parse(model(particles, rods)))
    assert pulled.message.startswith("The forces and loads compress no rod")
    particles.append(particle("Q", -2.0, side - 1.0, **PINNED))
    rods.append(rod("Q", f"0.{side - 2}"))
    made = parse(model(particles, rods))
    found = Buckling.of(made, count=3)
    assert found.factors[0] == pytest.approx(textbook(made), rel=1e-6)


@pytest.mark.parametrize("stiffness", [1e6, 1e12])
def test_slender_columns_keep_their_digits(stiffness: float) -> None:
    """Matrices of many short rods have lost them; the energy of deformations has not."""
    found = Buckling.of(parse(column(100, CLAMPED, HEADS["free"], stiffness=stiffness)), count=1)
    assert found.factors[0] / ((math.pi / 2 / LENGTH) ** 2 * EI) - 1.0 == pytest.approx(8.4e-11, rel=0.2)


def test_a_factor_that_is_too_coarse_is_no_answer(
    answer: Any, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "model.json"
    for parts, coarse in ((2, True), (3, True), (4, False)):  # three are worse than two
        found = answer("buckling", column(parts, CLAMPED, HEADS["clamped"]), "--modes", "1", status=coarse)
        assert (found["factors"] == []) is coarse
        assert (found["upper_bounds"] == []) is not coarse
        assert (found["effective_length"] == {}) is coarse
        assert main(["buckling", str(path), "--modes", "1"]) == coarse
        assert ("load factor, at most" in capsys.readouterr().out) is coarse
        main(["buckling", str(path), "--modes", "1", "--format", "csv"])
        assert ("upper_bound" in capsys.readouterr().out) is coarse


def test_rods_in_a_line_are_one_member_and_who_stands_aside_has_no_length() -> None:
    """A column in four parts buckles; beside it stands one that is ten times as stiff."""
    particles = [{"name": f"A{k}", "position": [0.0, k]} for k in range(5)]
    particles[0] |= {"fixed": [True, True]}
    particles[4] |= {"fixed": [True, False], "force": [0.0, -1.0]}
    particles += [
        {"name": "B0", "position": [2.0, 0.0], "fixed": [True, True]},
        {"name": "B1", "position": [2.0, 2.0]},
        {"name": "B2", "position": [2.0, 4.0], "fixed": [True, False], "force": [0.0, -1.0]},
    ]
    alike = {"stiffness": 1e5, "bending_stiffness": 100.0}
    rods = [{"name": f"a{k}", "between": [f"A{k}", f"A{k + 1}"], **alike} for k in range(4)]
    stiff = alike | {"bending_stiffness": 1000.0}
    rods += [{"name": f"b{k}", "between": [f"B{k}", f"B{k + 1}"], **stiff} for k in range(2)]
    found = Buckling.of(parse(model(particles, rods)))
    assert found.member_length == pytest.approx([4.0] * 6)
    assert found.effective_length[:4] == pytest.approx([4.0] * 4, rel=1e-3)
    assert np.isnan(found.effective_length[4:]).all()
