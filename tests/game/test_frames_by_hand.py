"""Members that bend in a session: what a person sees and reads of them."""

from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.free_body import Apart, on_joint, on_rod
from pinjoint.components.tags import DiagramShown
from pinjoint.systems.forms.results import told
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.systems.render.frame_models import FRAMES, PINNED, ROLLER, frame, portal, portal_at_rest


def test_the_key_of_diagrams_goes_through_all_quantities() -> None:
    session = Session.open(portal())
    seen = []
    for _ in range(4):
        session.press("i")
        seen.append((session.view.all_diagrams, session.view.quantity))
    assert seen == [(True, "N"), (True, "M"), (True, "V"), (False, "V")]
    session.press("i")
    assert session.view.quantity == "N"
    assert session.notice.startswith("Axial force N")


def test_and_of_selected_members() -> None:
    session = Session.open(portal())
    session.select(session.rods["BC"])
    for quantity in "NMV":
        session.press("i")
        assert session.model.tagged(DiagramShown) == [session.rods["BC"]]
        assert session.view.quantity == quantity
        tools = {tool.action: tool for group in session.view.toolbar.groups for tool in group}
        if tools:
            assert tools["toggle diagrams"].icon == f"diagram {quantity}"
    session.press("i")
    assert session.model.tagged(DiagramShown) == []


def test_the_button_says_which_diagram_is_on() -> None:
    session = Session.open(portal())
    session.press("i")
    session.press("i")
    session.update_view()
    (tool,) = [t for group in session.view.toolbar.groups for t in group if t.action == "toggle diagrams"]
    assert tool.pressed
    assert tool.icon == "diagram M"
    assert "bending moment M" in tool.title


def test_the_largest_moment_of_a_member() -> None:
    session = Session.open(portal_at_rest())
    session.document.get_ready()
    model = session.model
    rows = dict(told(model, model.rods["BC"], forces_known=True))
    assert rows["largest moment"] == "38.53 kN·m at 248.7 cm"


@pytest.mark.parametrize("name", FRAMES)
def test_everything_apart_is_in_equilibrium(name: str) -> None:
    """At any moment of a motion, inertia included, with dampers and distributed forces."""
    session = Session.open(FRAMES[name]())
    session.run(time=0.013)
    model = session.model
    known = Apart.of(model)
    scale = abs(known.on_ends).max()
    for particle in model.particles:
        forces = on_joint(model, particle.row, known)
        for part in ("x", "y", "moment"):
            assert abs(sum(getattr(force, part) for force in forces)) <= 1e-9 * scale
    for rod in model.rods:
        forces = on_rod(model, rod.row)
        assert abs(sum(force.x for force in forces)) <= 1e-12 * scale
        assert abs(sum(force.y for force in forces)) <= 1e-12 * scale
        assert abs(sum(force.moment + force.lever for force in forces)) <= 1e-12 * scale


def test_a_bar_between_hinges_bends_under_what_lies_on_it() -> None:
    source = frame(
        {"A": (0.0, 0.0, PINNED), "B": (4.0, 0.0, ROLLER)},
        {"A B": {"hinged": [True, True], "distributed_force": [0.0, -3.0]}},
    )
    session = Session.open(source)
    session.resize(900, 600)
    session.view.fit(session.model)
    session.press("i")
    session.press("i")
    session.document.get_ready()
    session.update_view()
    assert session.view.quantity == "M"
    assert "6.000 kN·m" in compose(session.model, session.view, load_theme("light")).texts


@pytest.mark.parametrize("stiffness", [0.0, 50.0])
def test_bars_with_a_force_along_them_are_in_equilibrium_apart(stiffness: float) -> None:
    facts = {"bending_stiffness": stiffness, "distributed_force": [1.0, -3.0]}
    source = frame({"A": (0.0, 0.0, PINNED), "B": (4.0, 1.0, ROLLER)}, {"A B": facts})
    session = Session.open(source)
    session.run(time=0.002)
    for particle in session.model.particles:
        forces = on_joint(session.model, particle.row)
        assert abs(sum(force.x for force in forces)) < 1e-9
        assert abs(sum(force.y for force in forces)) < 1e-9
    forces = on_rod(session.model, 0)
    assert abs(sum(force.y for force in forces)) < 1e-9
    assert abs(sum(force.moment + force.lever for force in forces)) < 1e-9


def test_what_is_left_over_turns_a_joint() -> None:
    session = Session.open(portal())
    session.settings.integrator, session.settings.time_step = "velocity_verlet", 1e-6
    session.run(time=0.002)
    joint, model = session.particles["B"], session.model
    before, first = joint.angular_velocity, Apart.of(model).left_over_moment[joint.row]
    session.run(time=1e-5)
    last = Apart.of(model).left_over_moment[joint.row]
    acceleration = (joint.angular_velocity - before) / 1e-5
    assert 1000.0 * 0.5 * (first + last) / joint.inertia == pytest.approx(acceleration, rel=1e-3)


def test_free_bodies_show_shears_and_moments_with_sums() -> None:
    session = Session.open(portal_at_rest())
    session.resize(1280, 800)
    session.document.get_ready()
    session.view.free_bodies = True
    session.select(session.particles["B"], session.rods["BC"])
    session.update_view()
    joint, rod = session.view.readouts[:2]
    assert "ΣM" in [name for name, _ in joint.rows]
    assert any("M 1.359 kN·m" in text for _, text in joint.rows)
    names = [name for name, _ in rod.rows]
    first = names.index("ΣM about its start")
    assert set(names[first + 1 :]) <= {""}, "a sum that is too long for a line goes on in the next"
    assert rod.rows[-1][1].endswith("= 0")


def test_forces_apart_are_those_of_the_true_shape() -> None:
    """However much larger displacements are drawn."""
    session = Session.open(portal_at_rest())
    session.resize(1280, 800)
    session.settings.displacement_scale = 40.0
    session.view.fit(session.model)
    session.document.get_ready()
    session.view.free_bodies = True
    session.update_view()
    texts = compose(session.model, session.view, load_theme("light")).texts
    assert {"1.369 kN", "8.889 kN", "29.85 kN", "42.15 kN"} <= set(texts)


def test_pictures_of_one_quantity(tmp_path: Path) -> None:
    import json

    model = tmp_path / "portal.json"
    model.write_text(json.dumps(portal_at_rest()), encoding="utf-8")
    for quantity, said in (("M", "38.53 kN·m"), ("V", "+29.85 kN"), ("N", "−8.738 kN")):
        picture = tmp_path / f"{quantity}.svg"
        assert main(["render", str(model), "--diagrams-of", quantity, "--output", str(picture)]) == 0
        assert said in picture.read_text("utf-8")
