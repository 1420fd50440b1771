"""Statics: what is shown is the equilibrium of what is there, beside the state, which nothing of it touches."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import app
from pinjoint.components.bent import Axes
from pinjoint.components.camera import Camera
from pinjoint.components.theory import EXACT, FIRST_ORDER, THEORIES
from pinjoint.documents import statics as statics_of_documents
from pinjoint.documents.document import document, parse
from pinjoint.documents.models import load
from pinjoint.documents.open_documents import ModelFile
from pinjoint.lessons.course import take_up_lesson
from pinjoint.results import Results
from pinjoint.scripts.lines import Failure
from pinjoint.scripts.script import NEW
from pinjoint.session import Session
from pinjoint.systems.base import Phase
from pinjoint.systems.render.labels.placing import Placed
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.statics.vibration import Vibrations
from tests.reference import bits
from tests.reference.sessions import solved_afresh
from tests.scripted.test_scripted import replayed_from

GERBER: dict[str, Any] = {  # 3 m + 2 m to the hinge, 3 m, q = 12 kN/m
    "format": "pinjoint model",
    "version": 1,
    "particles": [
        {"name": "A", "position": [0, 0], "fixed": [True, True]},
        {"name": "B", "position": [3, 0], "fixed": [False, True]},
        {"name": "H", "position": [5, 0]},
        {"name": "C", "position": [8, 0], "fixed": [False, True]},
    ],
    "rods": [
        {"name": name, "between": list(name), "section": "IPE 200", "distributed_force": [0, -12]}
        for name in ("AB", "BH", "HC")
    ],
}
GERBER["rods"][2]["hinged"] = [True, False]


def shown(source: Any) -> Session:
    session = Session.open(source)
    session.press("q")
    assert session.scene == "statics"
    return session


def assert_is_solution(session: Session, theory: str) -> None:
    for name, wanted in solved_afresh(session.model, theory).final.columns.items():
        np.testing.assert_array_equal(session.model.column(name), wanted, err_msg=name)


def test_nothing_is_solved_in_the_midst_of_an_edit() -> None:
    session = shown("portal")
    before = session.document.statics.revision
    session.particles["C"].position = (0.1, 3.0)
    session.rods["CD"].stiffness = 2e6
    session.model.delete([session.loads[0]])
    assert session.document.statics.revision == before
    assert session.rods["CD"].axial_force
    assert session.document.statics.revision > before


def test_what_is_said_of_theories_changes_with_the_language() -> None:
    session = shown("portal")
    session.update_view()
    said = session.document.statics.second_order()
    session.press("f2")
    assert session.document.statics.second_order() not in ("", said)
    session.press("f2")
    assert session.document.statics.second_order() == said


def test_a_gerber_beam_shows_what_a_hand_calculates() -> None:
    """M_B = −(q·2²/2 + 2·q·3/2) = −60 kN·m; H carries q·3/2 = 18 kN; A: 18 − 60/3 = −2 kN."""
    session = shown(GERBER)
    assert session.rods["AB"].bending_moment[1] == pytest.approx(-60.0, rel=1e-12)
    assert session.rods["HC"].bending_moment[0] == 0.0
    assert session.rods["HC"].largest_moment == pytest.approx((13.5, 1.5), rel=1e-12)
    reactions = [session.particles[name].reaction[1] for name in "ABC"]
    assert reactions == pytest.approx([-2.0, 80.0, 18.0], rel=1e-11)


@pytest.mark.parametrize("name", ["portal", "three_bar_plastic", "braced_portal", "isostatic"])
def test_the_state_stays_as_it_is(name: str) -> None:
    session = Session.open(name)
    before, saved = bits.columns(session.model), document(session.model)
    session.press("q")
    session.frame(0.02)
    assert session.model.rods.axial_force.any()
    assert document(session.model) == saved
    session.press("z")
    assert_is_solution(session, "exact")
    session.press("z")
    session.press("q")
    assert session.scene == "pause"
    different = bits.different(bits.columns(session.model), before)
    assert different == []
    assert session.undo() != ""  # the theory, twice
    assert session.undo() != ""
    assert not session.document.history.can_undo


def test_edits_undo_and_redo_are_followed() -> None:
    session = shown("portal")
    session.particles["B"].force = (10.0, 0.0)
    assert_is_solution(session, "first-order")
    session.rods["AB"].hinged = (True, False)
    assert_is_solution(session, "first-order")
    session.model.delete([session.rods["CD"]])
    assert_is_solution(session, "first-order")
    for _ in range(3):
        session.undo()
        assert_is_solution(session, "first-order")
    session.redo()
    assert_is_solution(session, "first-order")
    session.model.settings.load_steps = [1.0, 0.5]
    assert_is_solution(session, "first-order")
    session.divide("BC", 2)
    assert_is_solution(session, "first-order")
    assert session.particles[-1].position[1] == 4.0  # on the undeformed axis, not where it is drawn


def test_what_a_drag_shows_is_the_solution_of_each_frame() -> None:
    """All values of a portal, where they were a frame before; let go, all is placed anew."""
    session, placed = shown("portal"), Placed()
    session.resize(1280, 800)

    def texts() -> list[str]:
        session.frame(1.0 / 60.0)
        return compose(session.model, session.view, load_theme("light"), placed).texts

    before = texts()
    x, y = session.point(*session.particles["B"].position)
    session.press("drag", (x, y))
    for number in range(1, 8):
        session.press("drag to", (x + 9.0 * number, y - 5.0 * number))
        seen, fresh = texts(), shown(document(session.model))
        fresh.resize(1280, 800)
        fresh.view.camera = session.view.camera
        fresh.frame(0.0)
        values = {key for key in placed if key[0] == "rods.M"}
        anew: Placed = {}
        told = compose(fresh.model, fresh.view, load_theme("light"), anew).texts
        assert values == {key for key in anew if key[0] == "rods.M"}
        moments = [text for text in told if text.endswith("kN·m")]
        assert sorted(moments) == sorted(text for text in seen if text.endswith("kN·m")), number
        assert seen != before
    session.press("drop")
    assert not session.frame(0.0).session.view.steady


def test_in_a_window_theories_are_compared_once_the_hand_rests() -> None:
    session = shown("portal")
    statics, frames = session.document.statics, 1.0 / 60.0
    said = statics.second_order()
    assert said.startswith("second order")
    session.particles["B"].force = (35.0, -20.0)
    assert [statics.second_order(frames) for _ in range(10)] == [""] * 10
    other = [statics.second_order(frames) for _ in range(10)][-1]
    assert other.startswith("second order")
    assert other != said
    assert statics.second_order() == other


@pytest.mark.parametrize("theory", THEORIES)
def test_in_a_window_what_takes_long_comes_frames_later(monkeypatch: pytest.MonkeyPatch, theory: str) -> None:
    """Pale until then, with the solution of before; an edit meanwhile begins anew; the bits are those of who waits."""
    session = shown("portal")
    session.settings.theory = theory
    for limit in ("PART", "SMALL"):
        monkeypatch.setattr(statics_of_documents, limit, 0)  # so that it rests whenever it may
    session.frame(0.0)
    session.window = object()
    session.frame(0.0)
    before = session.model.rods.end_axial_force.copy()
    for force in (35.0, 45.0):
        session.particles["B"].force = (force, -20.0)
        session.frame(0.0)
        np.testing.assert_array_equal(session.model.rods.end_axial_force, before)
        assert session.view.provisional == session.view.status.state == "not solved yet"
    frames = 0
    while session.view.provisional:
        session.frame(0.0)
        frames += 1
    assert frames > 1
    assert_is_solution(session, theory)
    statics, other = session.document.statics, ""
    while not other:
        session.frame(0.1)
        other = statics.second_order(0.1)
    assert other == shown(document(session.model)).document.statics.second_order()


def test_esc_gives_up_what_is_being_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    session = shown("portal")
    for limit in ("PART", "REST", "SMALL"):
        monkeypatch.setattr(statics_of_documents, limit, 0)
    session.window = object()
    session.frame(0.0)
    session.particles["B"].force = (35.0, -20.0)
    session.frame(0.0)
    assert "Esc gives up" in session.view.status.notice
    session.press("escape")
    for _ in range(30):
        session.frame(0.0)
    assert session.view.provisional == "not solved yet"
    monkeypatch.undo()
    session.particles["B"].force = (36.0, -20.0)
    assert_is_solution(session, "first-order")


def test_a_run_is_not_changed_by_a_look_at_statics() -> None:
    one, other = Session.open("portal"), Session.open("portal")
    for session in (one, other):
        session.run(steps=20)
    other.press("q")
    other.frame(0.02)
    other.press("q")
    for session in (one, other):
        session.run(steps=20)
    assert bits.different(bits.columns(one.model), bits.columns(other.model)) == []


def test_what_moves_in_no_equilibrium_says_so() -> None:
    session = Session.open("isostatic")
    session.model.delete([session.rods["AB"]])
    session.press("q")
    session.update_view()
    assert session.view.provisional == "mechanism"
    assert not session.view.forces_known  # none is told as 0
    assert session.view.status.state == "mechanism"
    assert "Mechanism: the load moves" in session.view.status.notice
    session.press("space")  # which it does
    assert session.scene == "simulation"


def test_space_offers_to_begin_undeformed_and_then_does() -> None:
    session = shown("two_storey_frame")
    session.press("space")
    assert session.scene == "statics"
    assert "Space again" in session.notice
    session.press("space")
    assert session.scene == "simulation"
    assert session.model.solution is None


def test_panels_lead_back_to_statics() -> None:
    session = shown("portal")
    for key, scene in (("return", "properties"), ("s", "save"), ("d", "load"), ("k", "force method")):
        session.press(key)
        assert session.scene == scene
        for _ in range(3):
            if session.scene != "statics":
                session.press("escape")
        assert session.scene == "statics"


@pytest.mark.parametrize(("source", "scene"), [("portal", "statics"), ("isostatic", "pause"), (NEW, "statics")])
def test_a_window_begins_in_the_mode_of_its_model_and_so_does_what_it_records(
    source: Any, scene: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[tuple[str, Camera]] = []

    def run(self: app.App) -> list[Failure]:
        begun.append((self.session.scene, self.session.view.camera))
        assert self.preparation is not None
        self.preparation.close()
        self.close()
        return []

    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr(app.App, "run", run)
    path = tmp_path / "recorded.jsonl"
    app.open_window(load(source), ModelFile(), record=(str(path), source))
    replayed = replayed_from(path)
    assert begun == [(scene, replayed.view.camera)]
    assert replayed.scene == scene


def test_what_is_dropped_is_shown_in_its_mode(tmp_path: Path) -> None:
    session = Session.open("isostatic")
    session.save(tmp_path / "truss.json")
    Session.open("portal").save(tmp_path / "frame.json")
    for name, scene in (("frame", "statics"), ("truss", "pause")):
        session.press(f"files {tmp_path}/{name}.json")
        assert session.scene == scene


@pytest.mark.usefixtures("config")
def test_a_lesson_leads_back_to_where_one_was() -> None:
    session = shown("isostatic")
    session.press("d")
    session.type("14_buckling")
    session.press("return")
    assert session.course is not None
    take_up_lesson(session)
    session.press("f9")
    assert (session.scene, session.document.file.name) == ("statics", "isostatic")


def test_particles_without_rods_are_left_out_of_first_order() -> None:
    session = Session.open("ball_on_truss")
    without = Session(parse(document(session.model)))
    without.model.delete([without.particles["ball"]])
    session.press("q")
    session.update_view()
    assert not session.view.provisional
    left_out, differ = "Statics leaves out ball, which has no rods. ", session.document.statics.second_order()
    assert session.view.status.notice == left_out + differ
    assert not differ.endswith("at ball")
    forces = session.rods.axial_force
    np.testing.assert_array_equal(forces, without.statics("first-order").final.axial_force)
    loads, reactions = Results.of(session.model).sums.columns[1].values
    assert loads == pytest.approx(-reactions, rel=1e-12)
    session.press("z")  # there the ball lies on it
    session.notice = ""
    session.update_view()
    assert "leaves out" not in session.view.status.notice
    assert np.abs(session.rods.axial_force - forces).max() > 0.1


@pytest.mark.parametrize(("name", "factor"), [("eulers_columns", "0.8333"), ("von_mises", "0.9972")])
def test_first_order_above_the_critical_load_says_so(name: str, factor: str) -> None:
    session = shown(name)
    said = session.document.statics.second_order()
    assert said == f"above the critical load factor {factor}"
    session.settings.load_steps = (0.5,)
    assert "critical" not in session.document.statics.second_order()
    session.settings.load_steps = (1.0,)
    session.press("z")
    assert "critical" not in session.document.statics.second_order()


def test_no_time_passes() -> None:
    plan = Session.open("portal").plan("statics")
    assert plan.phases[Phase.STEP] == ()
    assert "statics.solve" in [system.name for system in plan.phases[Phase.EDIT]]
    session = shown("portal")
    session.press(".")
    assert "no time passes" in session.notice
    session.run(steps=1)  # which leaves it
    assert session.scene == "pause"


def test_what_is_asked_of_load_steps_is_checked() -> None:
    session = Session.open("portal")
    with pytest.raises(ValueError, match=r"load steps are \[\]; give a list of one to"):
        session.model.settings.load_steps = []


# --- by the canvas -----------------------------------------------------------------------------------------


def in_statics(source: Any) -> Session:
    session = Session.open(source)
    session.resize(1280, 800)
    if session.scene != "statics":
        session.press("q")
    session.update_view()
    return session


def test_a_slider_moves_the_last_load_step() -> None:
    session = in_statics("portal")
    before = session.rods["BC"].bending_moment
    [place] = [place for place in session.view.slider_places if place.control.title == "load factor"]
    left, right, y = place.track
    session.press("drag", ((left + right) / 2.0, y))
    for share in (0.6, 0.75):
        session.press("drag to", (left + share * (right - left), y))
    session.press("drop", (left + 0.75 * (right - left), y))
    assert session.settings.load_steps == (1.5,)
    assert session.rods["BC"].bending_moment == pytest.approx([1.5 * moment for moment in before], rel=1e-9)
    session.undo()
    assert session.settings.load_steps == (1.0,)
    session.settings.load_steps = (1.0, 3.0)
    session.update_view()
    session.press("click", place.button.middle)
    assert session.settings.load_steps == (1.0, 1.0)
    session.press("q")
    session.update_view()
    assert "load factor" not in {place.control.title for place in session.view.slider_places}


def test_a_button_beside_the_comparison_leads_to_the_other_theory() -> None:
    session = in_statics("portal")
    for offered, theory in (("exact geometry", EXACT), ("first order", FIRST_ORDER)):
        assert session.view.status.offer == (offered, "next theory")
        picture = compose(session.model, session.view, load_theme("light"))
        [hit] = [hit for hit in picture.hits if hit.action == "next theory"]
        session.press("click", hit.middle)
        assert session.settings.theory == theory
        assert session.view.status.offer is None or session.notice
        session.notice = ""
        session.update_view()
        picture = compose(session.model, session.view, load_theme("light"))
        assert offered in picture.texts  # the legend names it


def test_what_has_no_equilibrium_moves_as_it_does_then() -> None:
    session = in_statics("three_bar_plastic")
    assert session.view.shape is None
    session.settings.load_steps = (2.0,)
    session.update_view()
    shape = session.view.shape
    assert shape is not None
    assert shape.title == "A mechanism: nothing resists this motion"
    moved = np.abs(shape.displacement)
    assert moved.argmax() == moved.shape[1] * session.model.particles["D"].row + 1
    session.press("q")
    session.update_view()
    assert session.view.shape is None


@pytest.mark.parametrize(("theory", "within"), [("first-order", 1e-6), ("exact", 0.1)])
def test_a_collapse_moves_straight_members_between_plastic_hinges(theory: str, within: float) -> None:
    """Of the portal, sway by δ takes the middle of its beam down by 3/4 δ; members that bend would bulge beside that."""
    session = in_statics("portal_collapse")
    session.settings.theory, session.settings.load_steps = theory, (1.6,)
    session.update_view()
    shape = session.view.shape
    assert shape is not None
    assert shape.parts is not None
    x, y = shape.displacement[session.model.particles["C"].row]
    assert y == pytest.approx(-0.75 * x, rel=within)
    moved = session.model.particles.position + shape.displacement
    bow = Axes.moved(shape.parts, moved, shape.displacement, shape.rotation).bow
    assert np.abs(bow.at(np.linspace(0.0, 1.0, 9))).max() <= within / 10.0 * x


def test_modes_are_of_the_unloaded_structure_in_first_order_and_about_the_equilibrium_else() -> None:
    session = in_statics("portal")
    titles = []
    for _ in range(2):
        while session.view.shape is None or not session.view.shape.title.startswith("Mode 1"):
            session.press("b")
            session.update_view()
        titles.append(session.view.shape.title)
        session.press("z")
        session.update_view()
        assert session.view.shape is None
    loaded = Vibrations.of(session.model, session.statics("exact").final).hertz[0]
    free = Vibrations.of(session.model).hertz[0]
    assert titles == [f"Mode 1 of 3: {free:.4g} Hz", f"Mode 1 of 3 under load: {loaded:.4g} Hz"]


@pytest.mark.parametrize("name", ["portal", "portal_collapse"])
def test_frames_change_nothing_while_nothing_happens(name: str) -> None:
    session = in_statics(name)
    session.frame(0.0)
    limit, before = session.document.statics.limit_load, session.model.revision
    session.frame(0.1)
    assert session.document.statics.limit_load is limit
    assert session.model.revision == before


def test_plots_go_from_no_load_to_the_last_step() -> None:
    session = in_statics("portal")
    session.settings.theory, session.settings.load_steps = EXACT, (20.0,)
    session.press("o")
    assert "Select a particle or a rod first" in session.notice
    session.select(session.particles["B"])
    session.press("o")
    for last in (20.0, 10.0):  # after an edit, that of the new solution
        session.settings.load_steps = (last,)
        session.frame(0.0)
        session.update_view()
        [readout] = [one for one in session.view.readouts if one.plot is not None]
        assert readout.plot is not None
        [(_, factors, moved)] = readout.plot.curves
        expected = [
            100.0 * state.displacement[1, 0] for state in session.statics("exact", factors.tolist()).states
        ]
        assert (factors[0], factors[-1]) == (0.0, last)
        assert moved == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert session.particles["B"].displacement[0] == pytest.approx(expected[-1] / 100.0, rel=1e-12)
    session.press("q")
    session.update_view()
    assert not session.view.readouts


@pytest.mark.parametrize("source", [NEW, "isostatic"])
def test_a_velocity_that_is_drawn_in_statics_begins_the_run(source: Any) -> None:
    session = Session.open(source)
    session.resize(1000, 720)
    if not session.particles.count:
        session.press("p", session.point(0.0, 0.0))
    name = session.particles[-1].name if source == NEW else "B"
    session.press("q")
    session.press("v", session.point(*session.particles[name].position))
    session.type("3 m/s; 0")
    session.press("return")
    session.press("escape")
    session.press("space")
    assert session.scene == "simulation"
    assert tuple(session.particles[name].velocity) == (3.0, 0.0)


def test_a_run_below_its_speed_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session.open("isostatic")
    session.press("space")
    session.document.live.clock.lagging = True
    for readies, said in ((False, "steps take too long"), (True, "getting ready")):
        monkeypatch.setattr(type(session.readiness), "readies", readies)
        session.update_view()
        assert session.view.status.state == f"running below the set speed: {said}"


def test_the_button_of_a_notice_stands_below_its_text_where_there_is_little_room() -> None:
    """Beside the panel of properties in a small window; beside the button it had a word a line."""
    session = shown("portal")
    session.resize(640, 480)
    session.select(session.rods["BC"])
    session.press("return")
    session.frame(0.0)
    said = [text for shown, view in session.stages for text in compose(shown, view, load_theme("light")).texts]
    assert any(text.startswith("second order: +") for text in said)
    assert "exact geometry" in said
