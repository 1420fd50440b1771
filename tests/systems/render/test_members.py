"""Members that bend: curves, hinges, clamps, distributed forces and moments in a picture."""

from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import Axes
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.tags import Selected
from pinjoint.components.view import Shape
from pinjoint.systems.edit.picking import pick_rod
from pinjoint.systems.render.marks import Discs, Fills, Picture, Stamps, Strokes
from pinjoint.systems.render.model.sheet import measure
from pinjoint.systems.render.model.supports import DOWN, LEFT, RIGHT
from pinjoint.systems.render.picture import compose
from tests.systems.render.frame_models import (
    CLAMPED,
    PINNED,
    all_supports,
    cantilever,
    frame,
    portal,
    portal_at_rest,
)
from tests.systems.render.pictures import LIGHT, triangle, view_of


def opened(source: Any, width: int = 1000, height: int = 720) -> Session:
    session = Session.open(source)
    session.resize(width, height)
    session.view.fit(session.model)
    return session


def drawn(session: Session) -> Picture:
    return compose(session.model, session.view, LIGHT)


def bent_cantilever() -> Session:
    session = opened(cantilever(1, 0.0))
    session.model.writable("particles.rotation")[1] = 1.0
    session.model.writable("particles.displacement")[1] = (-0.6, 1.8)
    session.view.fit(session.model)
    return session


def test_rods_are_curves_through_the_slopes_of_their_ends() -> None:
    session = bent_cantilever()
    (rod,) = [
        m
        for m in drawn(session).marks
        if isinstance(m, Strokes) and m.colour == LIGHT.ink and m.of and m.of[0] == "rods"
    ]
    assert len(rod.start) >= 8
    way = rod.end - rod.start
    angle = np.arctan2(-way[:, 1], way[:, 0])
    assert (np.diff(angle) > 0.0).all()
    tangents = Axes.of(session.model, np.array([0])).tangents(np.array([0.0, 1.0]))[0]
    wanted = np.arctan2(tangents[:, 1], tangents[:, 0])
    assert angle[[0, -1]] == pytest.approx(wanted, abs=0.1)


def test_a_selected_member_glows_along_its_curve() -> None:
    session = bent_cantilever()
    session.select(session.rods["P0P1"])
    halos = [m for m in drawn(session).marks if isinstance(m, Strokes) and m.colour[:3] == LIGHT.selected[:3]]
    assert len(halos[0].start) >= 8
    assert session.model.tagged(Selected)


def test_members_are_picked_along_their_curves() -> None:
    session = bent_cantilever()
    axis = Axes.of(session.model, np.array([0])).points(np.array([0.5]))[0, 0]
    chord = Axes.of(session.model, np.array([0])).points(np.array([0.0, 1.0]))[0].mean(axis=0)
    camera = session.view.camera
    assert np.hypot(*(camera.to_pixels(axis) - camera.to_pixels(chord))) > 20.0
    assert pick_rod(session.model, session.view, tuple(camera.to_pixels(axis))) is session.rods["P0P1"]
    assert pick_rod(session.model, session.view, tuple(camera.to_pixels(chord))) is None


def test_trusses_have_no_curves() -> None:
    model = triangle()
    sheet = measure(model, view_of(model), LIGHT)
    assert sheet.curved is None
    start, end, rows = sheet.lines()
    assert start is not sheet.end
    assert rows.tolist() == [0, 1, 2]
    assert end.tolist() == sheet.end.tolist()


def stamps(picture: Picture) -> dict[tuple[str, int], set[int]]:
    """Rows of the particles by symbol and side."""
    found: dict[tuple[str, int], set[int]] = {}
    for mark in picture.marks:
        if isinstance(mark, Stamps) and mark.of is not None:
            found.setdefault((mark.symbol, mark.turns), set()).update(mark.of[1].tolist())
    return found


def test_supports_have_the_symbols_of_the_textbook() -> None:
    session = opened(all_supports())
    found = stamps(drawn(session))
    row = {particle.name: particle.row for particle in session.model.particles}
    assert found[("clamped", LEFT)] == {row["A"]}, "where its member comes from"
    assert found[("guided", DOWN)] == {row["B"]}
    assert found[("unturned", 0)] == {row["C"]}
    assert found[("guided", RIGHT)] == {row["D"]}
    assert any(symbol == "pinned" and row["G"] in rows for (symbol, _), rows in found.items())


def test_a_column_is_clamped_from_below() -> None:
    assert stamps(drawn(opened(portal())))[("clamped", DOWN)] == {0}


def test_a_clamp_without_rigid_ends_is_a_pin() -> None:
    source = frame({"A": (0.0, 0.0, CLAMPED), "B": (1.0, 0.0, PINNED)}, {"A B": {"bending_stiffness": 0.0}})
    assert not [symbol for symbol, _ in stamps(drawn(opened(source))) if symbol == "clamped"]


def discs(picture: Picture, table: str, *, filled: bool) -> set[int]:
    """Whose the discs are that have a rim, or have none."""
    return {
        int(row)
        for mark in picture.marks
        if isinstance(mark, Discs)
        and mark.of is not None
        and mark.of[0] == table
        and (mark.rim == 0.0) == filled
        for row in mark.of[1]
    }


def test_hinges_are_open_and_rigid_joints_filled() -> None:
    session = opened(all_supports())
    picture = drawn(session)
    particles, rods = (
        {h.name: h.row for h in table} for table in (session.model.particles, session.model.rods)
    )
    assert discs(picture, "particles", filled=True) == {particles[name] for name in "ABCDF"}
    assert {particles[name] for name in "EG"} <= discs(picture, "particles", filled=False), (
        "all is hinged there"
    )
    assert discs(picture, "rods", filled=False) == {rods["CF"]}, "beside the rigid joint C"
    (hinge,) = [m for m in picture.marks if isinstance(m, Discs) and m.of and m.of[0] == "rods"]
    joint = session.view.camera.to_pixels(session.particles["C"].position)
    away = hinge.at[0] - joint
    assert abs(away[0]) < 1.0
    assert -20.0 < away[1] < -5.0, "up along the rod to F"
    assert "hinge" in picture.texts


def test_plastic_hinges_are_filled_the_larger_the_farther_they_turned_with_an_arrow_the_way_they_did() -> None:
    source = portal()
    for rod in source["rods"]:
        rod["plastic_moment"] = 1e6
    session = opened(source)
    model = session.model
    assert "plastic hinge" not in drawn(session).texts
    model.writable("rods.plastic_rotation")[0] = (0.1, 0.0)
    model.writable("rods.plastic_rotation")[1] = (0.0, -0.4)
    session.run(steps=1)
    picture = drawn(session)
    [hinges] = [m for m in picture.marks if isinstance(m, Discs) and m.ink == LIGHT.yielding and m.of]
    assert list(hinges.of[1]) == [0, 1]
    assert (hinges.rim, hinges.hollow) == (0.0, LIGHT.yielding)
    assert hinges.radius[1] > hinges.radius[0] > 0.0
    for at, rod, end in zip(hinges.at, (0, 1), (0, 1), strict=True):
        ends = (
            model.particles.position[model.rods.between[rod]]
            + model.particles.displacement[model.rods.between[rod]]
        )
        joint, other = session.view.camera.to_pixels(ends)[[end, 1 - end]]
        away, way = at - joint, other - joint
        assert 3.0 < np.hypot(*away) < 30.0
        assert away @ way / np.hypot(*away) / np.hypot(*way) > 0.8, "along its own rod"
    arrows = [m for m in picture.marks if isinstance(m, Fills) and m.colour == LIGHT.yielding]
    assert [list(m.of[1]) for m in arrows if m.of] == [[0, 1]]
    tips, necks = arrows[0].corners[:, 0], arrows[0].corners[:, 1:].mean(axis=1)
    out, forward = tips - hinges.at, tips - necks
    turns = out[:, 0] * forward[:, 1] - out[:, 1] * forward[:, 0]
    assert (np.sign(turns) == [1.0, -1.0]).all(), "y down: the rod turns the other way than its joint"
    assert "plastic hinge" in picture.texts


def test_distributed_forces_are_rows_of_arrows_that_end_at_the_member() -> None:
    session = opened(portal())
    picture = drawn(session)
    beam = session.rods["BC"].row
    heads = [
        mark.corners[mark.of[1] == beam]
        for mark in picture.marks
        if isinstance(mark, Fills)
        and mark.of is not None
        and mark.of[0] == "rods"
        and mark.corners.shape[1] == 3
    ]
    (tips,) = [corners[:, 0] for corners in heads if len(corners)]
    assert len(tips) > 10
    level = session.view.camera.to_pixels(session.particles["B"].position)[1]
    assert tips[:, 1] == pytest.approx(level, abs=2.5)
    assert {"12 kN/m", "3 kN/m"} <= set(picture.texts)


def test_a_load_over_several_rods_is_told_once() -> None:
    source = frame(
        {name: (float(x), 0.0, CLAMPED if x == 0 else {}) for x, name in enumerate("ABCDE")},
        {f"{a} {b}": {"distributed_force": [0.0, -5.0]} for a, b in ("AB", "BC", "CD", "DE")},
    )
    session = opened(source)
    assert drawn(session).texts.count("5 kN/m") == 1
    session.view.all_diagrams, session.rods["DE"].distributed_force = True, (0.0, -2.5)
    picture = drawn(session)
    assert [picture.texts.count(text) for text in ("5 kN/m", "2.5 kN/m")] == [1, 1]
    heads = [m for m in picture.marks if isinstance(m, Strokes) and m.colour[:3] == LIGHT.load[:3]]
    lengths = np.concatenate([np.abs(mark.end - mark.start)[:, 1] for mark in heads])
    assert len(set(lengths[lengths > 2.0].round(3).tolist())) == 2, (
        "what is told once ends where another begins"
    )


def test_moments_turn_as_they_act() -> None:
    session = opened(cantilever(1, 7.0))
    for moment in (7.0, -7.0):
        session.particles["P1"].moment = moment
        picture = drawn(session)
        assert "7 kN·m" in picture.texts
        (arc,) = [m for m in picture.marks if isinstance(m, Strokes) and m.colour == LIGHT.load]
        centre = session.view.camera.to_pixels(session.particles["P1"].position)
        one, other = arc.start[0] - centre, arc.end[0] - centre
        turn = -(one[0] * other[1] - one[1] * other[0])  # y down
        assert np.sign(turn) == np.sign(moment)


def test_shapes_turn_joints() -> None:
    """A portal that sways: its columns leave their clamps upright and meet the beam at right angles."""
    session = opened(portal())
    model = session.model
    displacement = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.0], [0.0, 0.0]])
    shape = Shape("sways", displacement, None, np.array([0.0, 0.0, 0.0, -0.1]))
    session.view.shape = shape
    (lines,) = [m for m in drawn(session).marks if isinstance(m, Strokes) and m.colour[:3] == LIGHT.sketch[:3]]
    assert len(lines.start) > 8
    foot = session.view.camera.to_pixels(model.particles.position[0])
    first = int(np.argmin(np.hypot(*(lines.start - foot).T)))
    way = lines.end[first] - lines.start[first]
    assert abs(way[0]) < 0.1 * abs(way[1])
    session.view.shape = Shape("sways", displacement)
    (lines,) = [m for m in drawn(session).marks if isinstance(m, Strokes) and m.colour[:3] == LIGHT.sketch[:3]]
    assert len(lines.start) == 3


def test_reactions_turn_in_diagrams() -> None:
    session = opened(portal_at_rest())
    session.document.get_ready()
    session.view.all_diagrams = True
    picture = drawn(session)
    assert "28.12 kN·m" in picture.texts
    assert [m for m in picture.marks if isinstance(m, Strokes) and m.colour == LIGHT.reaction]
    loads = {text for text in picture.texts if text.endswith(" kN")}
    assert "10 kN" in loads
    assert "36.00 kN" not in loads, "the arrows of the distributed force show it"


@pytest.mark.parametrize("quantity", DIAGRAMS)
@pytest.mark.parametrize("size", [1e-300, 1e150, np.nan])
def test_extreme_states_are_drawn_or_left_out(size: float, quantity: str) -> None:
    """Nothing raises, whatever a run that diverges has left."""
    for column in ("particles.displacement", "particles.rotation", "rods.end_moment", "rods.axial_force"):
        session = opened(portal_at_rest())
        session.document.get_ready()
        session.view.all_diagrams, session.view.quantity = True, quantity
        with np.errstate(all="ignore"):
            session.model.writable(column)[1] = size
            for free in (False, True):
                session.view.free_bodies = free
                drawn(session)
