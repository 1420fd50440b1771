"""Axes of bent rods and the forces along them, against closed forms of beams."""

from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import AXIAL, FLAT, MOMENT, SHEAR, Axes, curved_lines, inner_forces, middles
from pinjoint.components.model import Model
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.spans import Curves, values, zeros
from pinjoint.documents.document import parse
from tests.systems.render.frame_models import CLAMPED, EI, FRAMES, PINNED, ROLLER, frame, portal_at_rest

SPAN, LOAD = 4.0, -3.0  # m, kN/m
ONE = np.array([0])


def beam(start: dict[str, Any], end: dict[str, Any], turns: tuple[float, float], **facts: Any) -> Model:
    """One rod along x under a distributed force, its ends turned so far (rad)."""
    rod = {"distributed_force": [0.0, LOAD], "stiffness": 1e-6, **facts}
    source = frame({"A": (0.0, 0.0, start), "B": (SPAN, 0.0, end)}, {"A B": rod})
    for particle, turn in zip(source["particles"], turns, strict=True):
        particle["rotation"] = turn
    session = Session(parse(source))
    session.document.get_ready()
    return session.model


def sag(model: Model, share: float) -> float:
    return float(Axes.of(model, ONE).points(np.array([share]))[0, 0, 1])


def test_a_simple_beam_sags_by_the_closed_form() -> None:
    turn = LOAD * SPAN**3 / (24.0 * EI)
    model = beam(PINNED, ROLLER, (turn, -turn))
    assert sag(model, 0.5) == pytest.approx(5.0 * LOAD * SPAN**4 / (384.0 * EI), rel=1e-12)
    x = 0.3 * SPAN
    expected = LOAD * x * (SPAN**3 - 2.0 * SPAN * x**2 + x**3) / (24.0 * EI)
    assert sag(model, 0.3) == pytest.approx(expected, rel=1e-12)
    polynomial = inner_forces(model, ONE, MOMENT)
    assert polynomial.at(np.array([0.5]))[0] == pytest.approx(-LOAD * SPAN**2 / 8.0, rel=1e-9)
    assert zeros(inner_forces(model, ONE, SHEAR).stretches)[1] == pytest.approx(0.5)


def test_hinged_ends_sag_alike() -> None:
    turn = LOAD * SPAN**3 / (24.0 * EI)
    rigid, hinged = beam(PINNED, ROLLER, (turn, -turn)), beam(PINNED, ROLLER, (0.0, 0.0), hinged=[True, True])
    shares = np.linspace(0.0, 1.0, 9)
    one, other = (Axes.of(model, ONE).points(shares) for model in (rigid, hinged))
    assert other == pytest.approx(one, rel=1e-12, abs=1e-15)
    assert hinged.rods.largest_moment[0] == pytest.approx([-LOAD * SPAN**2 / 8.0, 0.5 * SPAN])


def test_a_clamped_beam_sags_between_ends_that_do_not_turn() -> None:
    model = beam(CLAMPED, CLAMPED, (0.0, 0.0))
    assert sag(model, 0.5) == pytest.approx(LOAD * SPAN**4 / (384.0 * EI), rel=1e-12)
    polynomial = inner_forces(model, ONE, MOMENT)
    assert polynomial.at(np.array([1.0]))[0] == pytest.approx(LOAD * SPAN**2 / 12.0, rel=1e-9)
    which, shares = zeros(polynomial.stretches)
    assert which.tolist() == [0, 0]
    assert shares == pytest.approx([0.5 - 1.0 / 12.0**0.5, 0.5 + 1.0 / 12.0**0.5], rel=1e-9)


@pytest.mark.parametrize("name", FRAMES)
@pytest.mark.parametrize("quantity", DIAGRAMS)
def test_forces_along_rods_begin_and_end_with_the_columns(name: str, quantity: str) -> None:
    session = Session.open(FRAMES[name]())
    session.run(time=0.01)
    rods = session.model.rods
    polynomials = inner_forces(session.model, np.arange(rods.count), quantity)
    column = {AXIAL: rods.end_axial_force, MOMENT: rods.bending_moment, SHEAR: rods.shear}[quantity]
    found = polynomials.at(np.array([0.0, 1.0]))
    assert found == pytest.approx(column, rel=1e-9, abs=1e-9 * np.abs(column).max())


@pytest.mark.parametrize("name", FRAMES)
def test_no_moment_along_a_rod_is_larger_than_the_largest(name: str) -> None:
    session = Session.open(FRAMES[name]())
    session.run(time=0.01)
    rods = session.model.rods
    found = inner_forces(session.model, np.arange(rods.count), MOMENT).at(np.linspace(0.0, 1.0, 201))
    assert np.abs(found).max(axis=1) == pytest.approx(np.abs(rods.largest_moment[:, 0]), rel=1e-3, abs=1e-9)


def test_moments_change_with_the_shear() -> None:
    session = Session.open(portal_at_rest())
    model, rows = session.model, np.arange(3)
    session.document.get_ready()
    shares = np.linspace(0.0, 1.0, 7)
    slope = inner_forces(model, rows, MOMENT).derivative.at(shares) / model.rods.length[:, None]
    shear = inner_forces(model, rows, SHEAR).at(shares)
    # times the slope, which the moment has and the shear not
    axial = np.abs(model.rods.axial_force)[:, None] * 0.02
    assert (np.abs(slope - shear) <= axial).all()


def test_pieces_are_flat_and_follow_the_axis() -> None:
    session = Session.open(FRAMES["cantilever"]())
    session.model.writable("particles.rotation")[1] = 1.2
    model, scale = session.model, 80.0  # pixels per metre
    lines = curved_lines(model, FLAT / scale)
    assert lines is not None
    assert 4 <= len(lines.rods) <= 32
    assert lines.end[:-1] == pytest.approx(lines.start[1:])
    fine = Axes.of(model, ONE).points(np.linspace(0.0, 1.0, 2001))[0]
    step = lines.end - lines.start
    away = fine[:, None] - lines.start
    share = np.clip((away * step).sum(axis=2) / (step**2).sum(axis=1), 0.0, 1.0)
    distance = np.hypot(*np.moveaxis(away - share[..., None] * step, -1, 0)).min(axis=1)
    assert scale * distance.max() <= FLAT


def test_strongly_bent_rods_leave_joints_in_the_right_direction() -> None:
    """A quarter of a circle: upright tangents at both ends, and a middle on the circle within 2 %."""
    session = Session.open(FRAMES["cantilever"]())
    turn, chord = 0.5 * np.pi, 4.0
    session.model.writable("particles.rotation")[1] = turn
    session.model.writable("particles.displacement")[1] = chord * np.array(
        [np.cos(turn / 2) - 1.0, np.sin(turn / 2)]
    )
    found = Axes.of(session.model, ONE)
    start, end = found.tangents(np.array([0.0, 1.0]))[0]
    assert np.arctan2(start[1], start[0]) == pytest.approx(0.0, abs=1e-9)
    assert np.arctan2(end[1], end[0]) == pytest.approx(turn, abs=1e-9)
    radius = chord / (2.0 * np.sin(turn / 2.0))
    middle = found.points(np.array([0.5]))[0, 0] - np.array([0.0, radius])
    assert np.hypot(*middle) == pytest.approx(radius, rel=0.02)


def test_what_does_not_look_bent_has_no_pieces() -> None:
    assert curved_lines(Session.open("isostatic").model, 1e-9) is None
    assert len(middles(Session.open("isostatic").model)) == 0
    session = Session.open(portal_at_rest())
    assert curved_lines(session.model, 1.0) is None
    assert curved_lines(session.model, 1e-5) is not None


def test_curves_scale_with_displacements() -> None:
    session = Session.open(portal_at_rest())
    model, rows = session.model, np.arange(3)
    shares = np.linspace(0.0, 1.0, 5)
    model.settings.displacement_scale = 0.0
    straight = Axes.of(model, rows).points(shares)
    model.settings.displacement_scale = 1.0
    true = Axes.of(model, rows).points(shares)
    model.settings.displacement_scale = 30.0
    assert Axes.of(model, rows).points(shares) == pytest.approx(straight + 30.0 * (true - straight), rel=1e-12)


def test_rigid_joints_keep_their_angles() -> None:
    model = Session.open(portal_at_rest()).model
    model.settings.displacement_scale = 40.0
    tangent = Axes.of(model, np.array([0, 1])).tangents(np.array([0.0, 1.0]))
    column, girder = tangent[0, 1], tangent[1, 0]
    cosine = column @ girder / np.hypot(*column) / np.hypot(*girder)
    assert abs(cosine) < 1e-2


def test_zeros_of_random_polynomials() -> None:
    rng = np.random.default_rng(3)
    polynomials = rng.normal(size=(200, 5))
    which, shares = zeros(Curves.plain(polynomials).stretches)
    assert np.abs(values(polynomials[which], shares[:, None])).max() < 1e-12
    for row, polynomial in enumerate(polynomials):
        roots = np.roots(polynomial[::-1])
        real = np.sort(roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real < 1.0)])
        if len(real) == len(shares[which == row]):
            assert shares[which == row] == pytest.approx(real, abs=1e-9)
        else:  # a pair nearer to each other than samples
            assert np.diff(real).min() < 0.04
