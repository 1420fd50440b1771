"""Diagrams of N, M and V along members that bend."""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pygame
import pytest

from pinjoint import Session
from pinjoint.components.bent import AXIAL, MOMENT, SHEAR
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.tags import DiagramShown
from pinjoint.components.view import drawn_positions
from pinjoint.systems.edit.picking import pick_rod
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from pinjoint.systems.render.marks import Bars, Discs, Fills, Picture, Strokes, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import faded
from pinjoint.systems.render.ui.overlays import MEANINGS
from tests.systems.render.frame_models import (
    CLAMPED,
    EI,
    PINNED,
    ROLLER,
    at_rest,
    frame,
    gerber_at_rest,
    portal_at_rest,
    simple_beam,
)
from tests.systems.render.pictures import LIGHT

INK = faded(LIGHT.ink, 0.9)  # of outlines


def shown(
    source: dict[str, Any], quantity: str, width: int = 1000, height: int = 720, **settings: Any
) -> tuple[Picture, Session]:
    session = Session.open(source)
    for name, value in settings.items():
        setattr(session.settings, name, value)
    session.resize(width, height)
    session.view.fit(session.model)
    session.document.get_ready()
    session.view.all_diagrams, session.view.quantity = True, quantity
    return compose(session.model, session.view, LIGHT), session


def all_areas(picture: Picture) -> dict[int, np.ndarray]:
    """The corners of the area along each rod that has one: its baseline, and back along the edge."""
    fills = [mark for mark in picture.marks if isinstance(mark, Fills) and mark.corners.shape[1] > 4]
    of_rods = [mark for mark in fills if mark.of is not None and mark.of[0] == "rods"]
    return {int(row): area for mark in of_rods for row, area in zip(mark.of[1], mark.corners, strict=True)}


def areas(picture: Picture, session: Session, name: str) -> np.ndarray:
    """The area along a rod."""
    return all_areas(picture)[session.model.rods[name].row]


def cantilever(force: float) -> dict[str, Any]:
    """Two metres to the right of a clamp, a force at the tip, at rest."""
    source = frame({"A": (0.0, 0.0, CLAMPED), "B": (2.0, 0.0, {"force": [0.0, force]})}, {"A B": {}})
    source["particles"][1] |= {"displacement": [0.0, force * 8.0 / 3.0 / EI], "rotation": force * 2.0 / EI}
    return source


@pytest.mark.parametrize("force", [-5.0, 5.0])
@pytest.mark.parametrize("turned", [False, True])
def test_moments_stand_on_the_side_in_tension(force: float, turned: bool) -> None:
    source = cantilever(force)
    if turned:
        source["rods"][0]["between"] = ["B", "A"]
    picture, session = shown(source, MOMENT)
    corners = areas(picture, session, "AB")
    count = len(corners) // 2
    rise = corners[::-1][:count] - corners[:count]
    at_clamp = rise[-1 if turned else 0]
    assert np.sign(at_clamp[1]) == np.sign(force), (
        "pushed down, the upper side is in tension; y is down in pixels"
    )
    assert abs(at_clamp[0]) < 0.05 * abs(at_clamp[1])
    assert np.hypot(*rise[0 if turned else -1]) < 1e-3 * abs(at_clamp[1])
    assert "10.00 kN·m" in picture.texts


def test_shear_is_signed_and_hatched() -> None:
    picture, session = shown(cantilever(-5.0), SHEAR)
    corners = areas(picture, session, "AB")
    count = len(corners) // 2
    rise = (corners[::-1][:count] - corners[:count])[:, 1]
    assert (rise < 0.0).all(), "positive: above a rod to the right"
    assert "+5.000 kN" in picture.texts
    hatch = [m for m in picture.marks if isinstance(m, Strokes) and m.colour == faded(LIGHT.ink, 0.4)]
    assert len(hatch[0].start) > 10
    assert not [
        m
        for m in shown(cantilever(-5.0), MOMENT)[0].marks
        if isinstance(m, Strokes) and m.colour == faded(LIGHT.ink, 0.4)
    ]


def test_shear_forces_of_a_gerber_beam_are_told_once_and_off_the_rows_of_loads() -> None:
    session = Session.open("gerber_beam")
    session.resize(1280, 800)
    session.press("i")
    session.update_view()
    (model, view), *_ = session.stages
    picture = compose(model, view, LIGHT)
    texts = [
        mark for mark in picture.marks if isinstance(mark, Text) and mark.text[1:] in ("20.00 kN", "40.00 kN")
    ]
    assert sorted(text.text for text in texts) == ["+20.00 kN"] * 2 + ["+40.00 kN"] * 2 + [
        "−20.00 kN",
        "−20.00 kN",
        "−40.00 kN",
        "−40.00 kN",
    ], "of equal ones to both sides of a hinge one"
    axis = view.camera.to_pixels((0.0, 0.0))[1]
    assert all(abs(text.y - axis) > 25.0 for text in texts), "of 7 px the row, the text and the room around it"


def test_values_extremes_and_zero_points_of_a_portal() -> None:
    picture, session = shown(portal_at_rest(), MOMENT)
    texts = picture.texts
    assert {"28.12 kN·m", "35.55 kN·m", "38.53 kN·m"} <= set(texts)
    assert texts.count("35.55 kN·m") == 1, "both members at a corner have it"
    zeros = [m for m in picture.marks if isinstance(m, Discs) and m.ink == INK]
    assert len(zeros[0].at) == 2
    model, place = session.model, session.view.camera.to_model(zeros[0].at[1])
    assert 4.5 < place[0] < 6.0, "right of the middle of the beam"
    assert place[1] == pytest.approx(4.0, abs=0.1)
    assert model.rods["BC"].bending_moment == pytest.approx((1.359, -35.55), rel=1e-3)


def test_axial_forces_have_their_colours_and_no_noise() -> None:
    picture, _session = shown(portal_at_rest(), AXIAL)
    assert "compression (kN)" in picture.texts
    assert {"−8.738 kN", "−29.82 kN"} <= set(picture.texts)
    assert not [mark for mark in picture.marks if isinstance(mark, Bars)]
    beam, _ = shown(gerber_at_rest(), AXIAL)
    areas_of = [m for m in beam.marks if isinstance(m, Fills) and m.corners.shape[1] > 4]
    for mark in areas_of:
        count = mark.corners.shape[1] // 2
        rise = np.abs(mark.corners[:, ::-1][:, :count] - mark.corners[:, :count]).max()
        assert rise < 12.0, "small beside the shears"


def test_a_moment_that_passes_a_joint_is_told_where_it_is_largest() -> None:
    picture, _ = shown(gerber_at_rest(), MOMENT)
    told = [text for text in picture.texts if text.endswith("kN·m")]
    assert len(told) == len(set(told)) == 3, "under the force, above C, within DE"


def test_a_constant_moment_is_told_once() -> None:
    names = "ABCDE"
    source = frame(
        {
            name: (0.5 * x, 0.0, {"A": CLAMPED, "E": {"moment": 3.0}}.get(name, {}))
            for x, name in enumerate(names)
        },
        {f"{a} {b}": {} for a, b in itertools.pairwise(names)},
    )
    at_rest(
        source,
        {name: (0.0, 3.0 * (0.5 * x) ** 2 / 2.0 / EI, 3.0 * 0.5 * x / EI) for x, name in enumerate(names)},
    )
    texts = shown(source, MOMENT)[0].texts
    assert len([text for text in texts if text.startswith("3.0") and text.endswith("kN·m")]) == 2, (
        "and the reaction"
    )


def deflected(session: Session) -> np.ndarray:
    """The ends (m) of the pieces of the thin line of the deflected shape, in order, (n, 2)."""
    colour = faded(LIGHT.sketch, 0.75)
    marks = [m for m in compose(session.model, session.view, LIGHT).marks if isinstance(m, Strokes)]
    lines = [np.concatenate([m.start, m.end]) for m in marks if m.colour == colour]
    return in_metres(session, np.concatenate(lines)) if lines else np.empty((0, 2))


def in_metres(session: Session, pixels: np.ndarray) -> np.ndarray:
    return np.array([session.view.camera.to_model(pixel) for pixel in pixels.tolist()])


def baseline(session: Session) -> np.ndarray:
    """The points (m) on which the diagram of AB stands, (n, 2)."""
    corners = areas(compose(session.model, session.view, LIGHT), session, "AB")
    return in_metres(session, corners[: len(corners) // 2])


def test_statics_is_drawn_undeformed_with_its_deflected_shape_beside() -> None:
    """5qL⁴/384EI at the middle of a simple beam, times the displacement scale."""
    session = simple_beam()
    model, scale, sag = session.model, session.settings.displacement_scale, 5.0 * 8.0 * 4.0**4 / 384.0 / EI
    assert scale * sag > 0.02 * 4.0
    np.testing.assert_allclose(baseline(session)[:, 1], 0.0, atol=1e-9)
    lines = deflected(session)
    assert lines[:, 1].min() == pytest.approx(-scale * sag, rel=1e-9)
    assert lines[:, 1].max() <= 1e-9
    assert "deflected" in picture_of(session).meanings
    assert (
        pick_rod(model, session.view, session.view.camera.to_pixels(np.array([2.0, 0.0]))) == model.rods["AB"]
    )
    session.settings.displacement_scale = 1.0
    assert not len(deflected(session)), "the eye sees no difference"


def test_y_draws_it_deformed_and_can_be_undone() -> None:
    session = simple_beam()
    places = session.model.particles.position
    session.particles["B"].displacement = (0.0, -0.01)  # a support that settles
    np.testing.assert_array_equal(drawn_positions(session.model), places)
    session.press("y")
    scale = session.settings.displacement_scale
    assert not len(deflected(session))
    assert drawn_positions(session.model)[1] == pytest.approx((4.0, -0.01 * scale))
    assert baseline(session)[-1] == pytest.approx((4.0, -0.01 * scale))
    session.undo()
    np.testing.assert_array_equal(drawn_positions(session.model), places)
    session.press("q")  # pause shows the state, as it is
    assert drawn_positions(session.model)[1] == pytest.approx(
        (4.0, -0.01 * session.settings.displacement_scale)
    )


def test_one_scale_for_all_which_is_steady() -> None:
    session = Session.open(portal_at_rest())
    session.resize(1000, 720)
    session.view.fit(session.model)
    session.document.get_ready()
    session.view.all_diagrams, session.view.quantity = True, MOMENT
    placed: dict[tuple[str, int], int] = {}
    before = areas(compose(session.model, session.view, LIGHT, placed), session, "BC")
    rotation = session.model.writable("particles.rotation")
    rotation *= 0.9
    displacement = session.model.writable("particles.displacement")
    displacement *= 0.9
    after = areas(compose(session.model, session.view, LIGHT, placed), session, "CD")
    assert before.shape == after.shape
    assert ("diagrams.M", 0) in placed


SIZES = [(640, 480), (1280, 800)]


def bundled_at_rest(width: int, height: int) -> Session:
    session = Session.open("portal")
    session.resize(width, height)
    session.press("e")
    session.update_view()
    assert session.view.all_diagrams
    session.view.status = replace(session.view.status, notice="")  # it goes by itself
    return session


@pytest.mark.parametrize("size", SIZES)
def test_all_values_of_a_portal_are_told(size: tuple[int, int]) -> None:
    session = bundled_at_rest(*size)
    for session.view.quantity in DIAGRAMS:
        said = [mark.text for mark in picture_of(session).marks if isinstance(mark, Text)]
        assert not [text for text in said if "hidden" in text], session.view.quantity
        assert {"2.600 kN", "32.40 kN", "20.58 kN·m"} <= set(said)


def test_rods_at_an_angle_tell_their_shear_each_where_it_is_almost_the_same() -> None:
    session = Session.open("three_hinged_arch")
    session.resize(1280, 800)
    for key in ("q", "z"):  # statics, exact
        session.press(key)
    session.update_view()
    session.view.quantity = SHEAR
    assert {"−15.13 kN", "−15.14 kN"} <= set(picture_of(session).texts)


@pytest.mark.parametrize("size", SIZES)
def test_diagrams_keep_off_the_legend(size: tuple[int, int]) -> None:
    session = bundled_at_rest(*size)
    for session.view.quantity in DIAGRAMS:
        picture = picture_of(session)
        rows = {mark.y for mark in picture.marks if isinstance(mark, Text) and mark.text in MEANINGS.values()}
        tops = [
            float(mark.corners[..., 1].min())
            for mark in picture.marks
            if isinstance(mark, Fills) and mark.of is not None and mark.of[0] == "rods" and len(mark.corners)
        ]
        assert min(tops) > max(rows) + 12.0, session.view.quantity


def picture_of(session: Session) -> Picture:
    return compose(session.model, session.view, LIGHT)


def test_diagrams_grow_as_a_person_wants() -> None:
    session = bundled_at_rest(1280, 800)
    far = np.ptp(areas(picture_of(session), session, "CD")[:, 0])
    session.settings.diagram_scale *= 2.0
    assert np.ptp(areas(picture_of(session), session, "CD")[:, 0]) > 1.5 * far


def test_the_largest_scale_that_a_model_can_have_leaves_numbers_to_draw_with() -> None:
    picture, _ = shown(portal_at_rest(), MOMENT, diagram_scale=1e30)
    for corners in all_areas(picture).values():
        assert np.abs(corners).max() < 1e8
    Canvas().draw(pygame.Surface((1000, 720), 0, 32), picture)


def test_only_tagged_rods_if_only_these_are_wanted() -> None:
    _, session = shown(portal_at_rest(), MOMENT)
    session.view.all_diagrams = False
    session.model.tag_only([session.model.rods["BC"]], DiagramShown)
    picture = compose(session.model, session.view, LIGHT)
    assert [*all_areas(picture)] == [session.model.rods["BC"].row]


def test_unknown_forces_are_not_drawn() -> None:
    session = Session.open(portal_at_rest())
    session.view.all_diagrams, session.view.forces_known = True, False
    picture = compose(session.model, session.view, LIGHT)
    assert not [m for m in picture.marks if isinstance(m, Fills) and m.corners.shape[1] > 4]


@pytest.mark.parametrize("quantity", DIAGRAMS)
def test_a_truss_shows_axial_forces_whatever_is_chosen(quantity: str) -> None:
    session = Session.open("isostatic")
    session.document.get_ready()
    session.view.all_diagrams = True
    expected = compose(session.model, session.view, LIGHT)
    session.view.quantity = quantity
    found = compose(session.model, session.view, LIGHT)
    assert found.texts == expected.texts
    assert [type(mark) for mark in found.marks] == [type(mark) for mark in expected.marks]


def test_many_members_are_drawn_without_single_values() -> None:
    count = 200
    particles = {
        f"P{i}": (0.1 * i, 0.02 * (i % 2), PINNED if i == 0 else ROLLER if i == count else {})
        for i in range(count + 1)
    }
    source = frame(particles, {f"P{i} P{i + 1}": {"distributed_force": [0.0, -1.0]} for i in range(count)})
    picture, _ = shown(source, MOMENT, 1900, 300)
    assert picture.marks
