"""A frame drawn, supported and loaded by mouse, with the toolbar and menus alone; hinges where they are clicked."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.camera import Viewport
from pinjoint.components.view import drawn_positions
from pinjoint.documents.document import document
from pinjoint.editor.view_model import offer_tools
from pinjoint.systems.edit.picking import RING
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.reference.hits import push
from tests.reference.models import model, particle, rod, triangle
from tests.systems.render.test_toolbar import tool

EMPTY = {"format": "pinjoint model", "version": 1}


def opened(source: object = EMPTY) -> Session:
    session = Session.open(source)  # type: ignore[arg-type]
    session.view.camera.viewport = Viewport(0, 0, 1024, 640)
    session.view.fit(session.model)
    offer_tools(session)
    return session


def portal() -> Session:
    particles = [
        particle("A", 0, 0, fixed=[True, True], fixed_rotation=True),
        *(particle("B", 0, 3), particle("C", 4, 3)),
        particle("D", 4, 0, fixed=[True, True], fixed_rotation=True),
    ]
    rods = [rod(*ends, section="HEA 200") for ends in ("AB", "BC", "CD")]
    return opened(model(particles, rods))


def choose(session: Session, action: str) -> None:
    push(session, action)


def titles(session: Session) -> list[str]:
    assert session.view.menu is not None
    return [entry.title for entry in session.view.menu.entries]


def drag_by(session: Session, start: tuple[float, float], points: tuple[float, float]) -> None:
    """Drag from a point (m) by points to the right and up."""
    x, y = session.point(*start)
    session.press("drag", (x, y))
    session.press("drag to", (x + points[0], y - points[1]))
    session.press("drop", (x + points[0], y - points[1]))


def test_a_portal_is_drawn_and_loaded_with_the_toolbar() -> None:
    session = opened()
    push(session, "rigid")
    assert tool(session, "rigid").pressed
    assert tool(session, "rod").pressed
    for at in ((-2, 0), (-2, 3), (2, 3), (2, 0)):
        session.click(*at)
    assert session.notice.startswith("Rod 3: 300")
    assert "IPE 200" in session.notice
    session.click(2, 0)  # where the chain has come to
    assert [each.section for each in session.rods] == ["IPE 200"] * 3
    assert (session.model.rods.turning_shares == 0.5).all()
    push(session, "support")
    for foot in (0, 3):
        place = session.particles[foot].position
        session.click(*place)
        assert session.notice.endswith("pinned: held in x and y")
        session.click(*place)
        assert session.notice.endswith("clamped: held in x and y, cannot turn")
    push(session, "force")
    drag_by(session, (0.0, 3.0), (0.0, -50.0))
    assert session.rods[1].distributed_force[1] < 0.0
    assert session.notice.startswith("Rod 2: distributed load (0, −")
    drag_by(session, session.particles[1].position, (60.0, 0.0))
    assert session.particles[1].force[0] > 0.0
    session.run(time=0.05)
    assert np.abs(session.model.rods.bending_moment).max() > 0.1
    for _ in range(12):
        session.undo()
    assert document(session.model).get("particles") is None


def test_the_key_of_the_kind_acts_while_a_rod_is_drawn() -> None:
    session = opened()
    push(session, "rod")
    session.click(-2.0, 0.0)
    assert session.gesture is not None
    assert "pinned (Ctrl+R: rigid ends)" in session.gesture.hint
    session.press("ctrl+r")
    assert "rigid ends (Ctrl+R: pinned)" in session.gesture.hint
    session.click(0.0, 0.0)
    session.press("ctrl+r")
    session.click(2.0, 0.0)
    assert (session.model.rods.bending_stiffness > 0.0).tolist() == [True, False]


def test_a_new_member_is_like_the_newest_one() -> None:
    session = portal()
    assert session.view.rigid, "what is drawn in a frame bends"
    session.press("l", session.point(0.0, 0.0))
    session.press("l", session.point(4.0, 3.0))
    assert session.rods[-1].section == "HEA 200"
    assert not Session.open(triangle()).view.rigid


def test_a_click_near_an_end_hinges_it_and_a_ring_says_so() -> None:
    session = portal()
    push(session, "hinge")
    x, y = session.point(0.0, 3.0)
    session.view.pointer = x + RING, y
    session.frame(0.02)
    preview = session.view.preview
    assert preview is not None
    assert (preview.kind, preview.label) == ("hinge", "hinge BC at B")
    assert "hinge BC at B" in compose(session.model, session.view, load_theme("light")).texts
    session.press("click", (x + RING, y))
    assert session.notice == "Rod BC: hinged at B"
    assert session.rods["BC"].hinged == (True, False)
    assert session.rods["AB"].hinged == (False, False)
    session.press("click", (x + RING, y))
    assert session.rods["BC"].hinged == (False, False)
    session.press("click", session.point(2.0, 3.0))
    assert session.notice.startswith("Click near the end of a rod")
    session.click(0.0, 3.0)
    assert session.notice == "Particle B: all rods hinged to it"
    assert session.rods["AB"].hinged == (False, True)
    session.press("ctrl+z")
    assert not session.model.rods.hinged.any()


def test_a_joint_of_a_truss_is_made_rigid_in_one_edit() -> None:
    session = opened(triangle())
    before = document(session.model)
    push(session, "hinge")
    session.click(1.0, 1.0)
    assert session.notice == "Particle B: all rods rigidly joined"
    assert [each.hinged for each in session.rods] == [(True, False), (False, True), (False, False)]
    assert session.rods["CA"].bending_stiffness == 0.0
    session.press("ctrl+z")
    assert document(session.model) == before


def test_menus_of_rods_name_the_nearer_end_and_divide() -> None:
    session = portal()
    session.click(3.0, 3.0, "right click")
    assert {"hinge at C", "rigid at both ends", "divide the rod here", "divide in two"} <= {*titles(session)}
    choose(session, "hinge")
    assert session.rods["BC"].hinged == (False, True)
    session.click(3.0, 3.0, "right click")
    assert "make rigid at C" in titles(session)
    choose(session, "split")
    assert session.notice == "Rod BC: divided at particle 1"
    assert session.selected == [session.particles["particle 1"]]
    assert session.particles["particle 1"].position == pytest.approx((3.0, 3.0), abs=0.01)
    session.press("ctrl+a")
    session.press("right click", session.point(0.0, 1.0))
    choose(session, "rigid")
    assert (session.model.rods.turning_shares == 0.5).all()
    assert session.notice == "4 rods: rigid at both ends, HEA 200"


def test_menus_of_a_truss_offer_no_divisions_and_no_clamps() -> None:
    session = opened(triangle())
    session.click(1.0, 1.0, "right click")
    assert not {"clamped: held in x and y, cannot turn", "moment: click left or right"} & {*titles(session)}
    session.click(0.5, 0.5, "right click")
    assert not {"divide the rod here", "divide in two"} & {*titles(session)}
    assert "make rigid at B" in titles(session) or "make rigid at A" in titles(session)


@pytest.mark.parametrize(
    ("action", "held"),
    [
        ("clamp", (True, True, True)),
        ("guide y", (False, True, True)),
        ("guide x", (True, False, True)),
        ("hold rotation", (False, False, True)),
        ("pin", (True, True, False)),
    ],
)
def test_supports_of_frames_are_in_the_menu(action: str, held: tuple[bool, bool, bool]) -> None:
    session = portal()
    session.click(0.0, 3.0, "right click")
    choose(session, action)
    b = session.particles["B"]
    assert (*b.fixed, b.fixed_rotation) == held
    session.click(0.0, 3.0, "right click")
    assert session.view.menu is not None
    assert next(entry for entry in session.view.menu.entries if entry.action == action).pressed


def test_a_support_drawn_farther_holds_the_rotation_too() -> None:
    session = portal()
    push(session, "support")
    drag_by(session, (4.0, 3.0), (0.0, 40.0))
    c = session.particles["C"]
    assert (c.fixed, c.fixed_rotation) == ((False, True), False)
    drag_by(session, (4.0, 3.0), (0.0, 90.0))
    assert (c.fixed, c.fixed_rotation) == ((False, True), True)
    truss = opened(triangle())
    push(truss, "support")
    drag_by(truss, (1.0, 1.0), (0.0, 90.0))
    assert not truss.particles["B"].fixed_rotation, "there is nothing to hold"


def test_a_moment_is_drawn_to_the_left_counter_clockwise() -> None:
    session = portal()
    push(session, "moment")
    drag_by(session, (0.0, 3.0), (-50.0, 10.0))
    assert session.particles["B"].moment > 0.0
    assert session.notice.endswith("kN·m, counter-clockwise")
    drag_by(session, (0.0, 3.0), (50.0, 10.0))
    assert session.particles["B"].moment < 0.0
    drag_by(session, (0.0, 3.0), (1.0, 50.0))
    assert session.particles["B"].moment == 0.0
    truss = opened(triangle())
    push(truss, "moment")
    truss.click(1.0, 1.0)
    assert truss.notice.startswith("A moment cannot act on B")


@pytest.mark.parametrize(("tool_name", "at"), [("force", (2.0, 3.0)), ("moment", (0.0, 3.0))])
def test_what_is_drawn_is_seen_before(tool_name: str, at: tuple[float, float]) -> None:
    session = portal()
    push(session, tool_name)
    x, y = session.point(*at)
    session.press("drag", (x, y))
    session.press("drag to", (x + 40.0, y + 50.0))
    session.view.pointer = x + 40.0, y + 50.0
    session.frame(0.02)
    preview = session.view.preview
    assert preview is not None
    session.press("escape")
    assert not session.model.rods.distributed_force.any()
    assert not session.model.particles.moment.any()


def test_weight_along_rods_replaces_the_environments() -> None:
    session = portal()
    session.environment.acceleration = (0.0, -9.81)
    session.particles["B"].mass = 500.0
    before = session.model.particles.constant_force.copy()
    session.click(2.0, 3.0, "right click")
    choose(session, "weight along")
    assert session.environment.acceleration == (0.0, 0.0)
    assert session.rods["BC"].distributed_force[1] == pytest.approx(-session.rods["BC"].density * 9.81e-3)
    assert session.model.particles.constant_force == pytest.approx(before)
    assert drawn_positions(session.model).any()
    session.press("ctrl+z")
    assert session.environment.acceleration == (0.0, -9.81)
    assert not session.model.rods.distributed_force.any()


def test_weight_along_one_rod_where_nothing_else_weighs() -> None:
    session = portal()
    session.click(2.0, 3.0, "right click")
    choose(session, "weight along")
    assert session.model.rods.distributed_force.any(axis=1).tolist() == [False, True, False]
    session.rods["AB"].density = 0.0
    session.select(session.rods["AB"])
    session.act("weight along")
    assert session.notice.startswith("These rods have no density")


def test_in_an_empty_model_ctrl_r_always_leads_to_rods_that_bend() -> None:
    session = opened()
    for _ in range(2):
        session.press("ctrl+r")
        assert session.view.rigid
        session.press("escape")


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_loaded_frame_is_drawn_in_statics_however_it_is_held_and_with_no_load_factor() -> None:
    session = portal()
    session.rods["BC"].distributed_force = (0.0, -20.0)
    session.press("q")
    for _ in range(8):
        session.press("c", session.point(0, 0))
        for _ in range(8):
            session.press("c", session.point(4, 0))
            session.update_view()
            compose(session.model, session.view, load_theme("light"))
    session.model.settings.load_steps = (0.0,)
    session.update_view()
    compose(session.model, session.view, load_theme("light"))
