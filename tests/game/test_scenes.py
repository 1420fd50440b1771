"""The six scenes: their transitions, and the keys and clicks of pause and simulation."""

from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.components.mistake import WrongValue
from pinjoint.components.tags import DiagramShown
from pinjoint.editor.scenes import all_scenes
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.reference import bits
from tests.systems.edit.hand import FRAME, run_frames

SCENES = ["pause", "simulation", "statics", "properties", "save", "load", "force method", "displacement method"]
HUBS = ("pause", "statics")


@pytest.fixture
def session() -> Session:
    return Session.open("isostatic")


def go(session: Session, scene: str) -> None:
    """From pause to any scene."""
    if scene != "pause":
        session.scenes.request(scene)
        session.scenes.apply(session)
    assert session.scene == scene


# --- the state machine -----------------------------------------------------------------------------------


def test_there_are_eight_and_pause_is_the_first(session: Session) -> None:
    assert [scene.name for scene in all_scenes()] == SCENES
    assert session.scene == "pause"


@pytest.mark.parametrize("start", SCENES)
@pytest.mark.parametrize("target", SCENES)
def test_pause_and_statics_are_hubs(session: Session, start: str, target: str) -> None:
    """From a hub to any other, from any other to a hub, between methods, and nothing else; a run ends in pause."""
    go(session, start)
    beside = start.endswith("method") and target.endswith("method")
    if start != target and (
        beside or start in HUBS or target == "pause" or (target in HUBS and start != "simulation")
    ):
        session.scenes.request(target)
        assert session.scene == start  # until the one point of the frame where it happens
        session.frame(0.0)
        assert session.scene == target
    else:
        with pytest.raises(WrongValue, match=f"From the scene '{start}' one cannot go to '{target}'"):
            session.scenes.request(target)
        session.frame(0.0)
        assert session.scene == start


def test_an_unknown_scene_is_refused_by_name(session: Session) -> None:
    with pytest.raises(WrongValue, match=r"no scene 'kitchen'.*pause, simulation"):
        session.scenes.request("kitchen")


def test_a_chain_of_transitions_is_checked_link_by_link(session: Session) -> None:
    session.scenes.request("save", "pause", "simulation")
    session.frame(0.0)
    assert session.scene == "simulation"
    with pytest.raises(WrongValue, match="From the scene 'save' one cannot go to 'load'"):
        session.scenes.request("pause", "save", "load")
    session.frame(0.0)
    assert session.scene == "simulation"  # a chain with an illegal link does nothing at all


@pytest.mark.parametrize(
    ("key", "scene"),
    [("space", "simulation"), ("return", "properties"), ("s", "save"), ("d", "load"), ("k", "force method")],
)
def test_keys_of_pause_lead_to_scenes_and_escape_leads_back(session: Session, key: str, scene: str) -> None:
    """Panels leave the model alone; the force method works on copies."""
    before = bits.columns(session.model)
    session.press(key)
    assert session.scene == scene
    if scene != "simulation":
        run_frames(session, 3)
    session.press("escape")
    if session.scene != "pause":  # a box was selected
        session.press("escape")
    assert session.scene == "pause"
    assert bits.different(bits.columns(session.model), before) == []
    assert not session.document.history.can_undo


def test_time_passes_in_simulation_only(session: Session) -> None:
    for scene in SCENES:
        go(session, scene)
        before = session.time
        run_frames(session, 5)
        assert (session.time > before) == (scene == "simulation"), scene
        while session.scene != "pause":
            session.press("q" if session.scene == "statics" else "escape")


def test_heading_and_state_are_shown(session: Session) -> None:
    session.frame(FRAME)
    assert session.view.heading == "Pause"
    assert session.view.status.state == "paused, not in equilibrium"
    assert session.view.status.speed == 0.0
    session.press("space")
    run_frames(session, 2)
    assert session.view.heading == ""
    assert session.view.status.state.startswith("running")
    assert session.view.status.speed > 0.0
    while not session.simulation.halted:
        session.run(steps=100)
    session.frame(FRAME)
    assert session.view.status.state == "at rest"


def test_a_key_without_meaning_does_nothing(session: Session) -> None:
    before = bits.columns(session.model)
    for key in ("f7", "ctrl+shift+q", "caps lock"):
        session.press(key)
    assert session.scene == "pause"
    assert bits.different(bits.columns(session.model), before) == []


# --- selection, diagrams, grids --------------------------------------------------------------------------


def test_escape_drops_the_selection_and_never_runs(session: Session) -> None:
    session.click(1, 1)
    assert session.selected == [session.particles["B"]]
    session.press("escape")
    assert (session.scene, session.selected) == ("pause", [])
    session.press("escape")
    assert (session.scene, session.time) == ("pause", 0.0)
    assert "Space starts it" in session.notice


def test_a_click_selects_particle_or_rod_and_never_the_grid(session: Session) -> None:
    """Particles before rods, each within its reach in pixels; the grid on purpose only, by Ctrl."""
    scale = session.view.camera.scale
    middle = (0.5, 0.5)  # of AB
    across = 1.0 / (scale * 2**0.5)  # 1 px at right angles to AB, in each coordinate
    for (x, y), expected in [
        ((1.0, 1.0), session.particles["B"]),
        ((middle[0] - 9 * across, middle[1] + 9 * across), session.rods["AB"]),
        ((middle[0] - 11 * across, middle[1] + 11 * across), None),
        ((2.5 + 4 / scale, 0.75), None),
    ]:
        session.click(x, y)
        assert session.selected == ([] if expected is None else [expected])
    session.click(2.5 + 6 / scale, 0.75, "ctrl+click")
    assert session.selected == []
    session.click(2.5 + 4 / scale, 0.75, "ctrl+click")
    assert session.selected == [session.model.grids[0]]


def test_properties_without_a_selection_hold_the_shown_grid(session: Session) -> None:
    session.press("return")
    session.click_box("spacing x")
    session.type("25")
    session.press("return")
    while session.scene != "pause":
        session.press("escape")
    assert session.model.grids[0].spacing == (0.25, 0.5)
    while any(grid.shown for grid in session.model.grids):
        session.press("h")
    session.press("return")
    assert "spacing x" not in session.boxes


def test_i_shows_the_diagrams_of_the_selected_or_of_all(session: Session) -> None:
    session.press("i")
    assert session.view.all_diagrams
    session.press("i")
    assert not session.view.all_diagrams
    session.click(1, 1)
    session.press("i")
    assert session.model.tagged(DiagramShown) == [session.particles["B"]]
    session.select(*session.model.rods, session.particles["B"])
    session.press("i")
    assert session.model.tagged(DiagramShown) == [session.particles["B"], *session.model.rods]
    session.select(session.rods["AB"])
    session.press("i")
    assert session.rods["AB"] not in session.model.tagged(DiagramShown)
    session.select(*session.model.rods, *session.model.grids)  # one of them shows none: all shall
    session.press("i")
    assert session.model.tagged(DiagramShown) == [session.particles["B"], *session.model.rods]
    session.select()
    session.press("i")
    assert session.model.tagged(DiagramShown) == []


def test_g_makes_a_grid_that_is_then_shown_and_h_goes_through_them(session: Session) -> None:
    grids = session.model.grids
    for _ in range(2):
        session.press("g")
    assert [grid.shown for grid in grids] == [False, False, True]
    seen = []
    for _ in range(5):
        session.press("h")
        seen.append([grid.shown for grid in grids].index(True) if any(g.shown for g in grids) else None)
    assert seen == [None, 0, 1, 2, None]


# --- undo, redo, restart ---------------------------------------------------------------------------------


def test_undo_while_it_runs_goes_back_to_the_edit_and_the_run_goes_on(session: Session) -> None:
    session.press("space")
    run_frames(session)
    at_edit = session.time
    session.particles["B"].force = (10, 20)
    run_frames(session)
    assert session.time > at_edit > 0.0
    session.press("ctrl+z")
    assert (session.time, session.particles["B"].force) == (at_edit, (10, 20))
    session.press("ctrl+z")
    assert (session.time, session.particles["B"].force) == (at_edit, (120, -160))
    session.press("ctrl+z")
    assert (session.time, session.scene) == (0.0, "simulation")
    run_frames(session)
    assert session.time > 0.0
    assert abs(session.energy.imbalance) < 0.05 * session.energy.work


def test_restart_goes_back_to_the_beginning_keeps_edits_and_can_be_undone(session: Session) -> None:
    start = bits.state(session.model)
    session.press("space")
    run_frames(session)
    session.particles["B"].force = (10, 20)
    run_frames(session)
    run = bits.state(session.model)
    session.press("r")
    assert bits.different(bits.state(session.model), start) == []
    assert session.particles["B"].force == (10, 20)
    session.press("space")
    session.press("ctrl+z")
    assert bits.different(bits.state(session.model), run) == []


def test_a_run_restarted_after_an_edit_is_the_run_of_the_edited_model(session: Session) -> None:
    session.run(steps=321)
    session.rods["AB"].stiffness = 200_000
    session.press("r")
    session.run(steps=321)
    fresh = Session.open("isostatic")
    fresh.rods["AB"].stiffness = 200_000
    fresh.run(steps=321)
    assert bits.different(bits.columns(session.model), bits.columns(fresh.model)) == []


def test_restart_goes_back_to_the_undeformed_beginning_after_settling_too(session: Session) -> None:
    """Before any run, and with one after it; it can be undone."""
    start = bits.state(session.model)
    for run in (0, 50):
        session.press("e")
        settled = session.particles["B"].displacement
        assert settled != (0.0, 0.0)
        session.run(steps=run)
        before = bits.state(session.model)
        session.press("r")
        assert session.particles.displacement.tolist() == [[0.0, 0.0]] * 3
        assert (session.time, session.rods["AB"].axial_force) == (0.0, 0.0)
        session.press("ctrl+z")
        assert bits.different(bits.state(session.model), before) == []
        session.press("ctrl+y")
        assert session.particles.displacement.tolist() == [[0.0, 0.0]] * 3
    session.press("r")
    assert "This is the beginning" in session.notice
    assert bits.different(bits.state(session.model), start) == []


def test_a_run_after_settling_and_restarting_is_the_run_of_a_fresh_model(session: Session) -> None:
    session.press("e")
    session.press("r")
    session.run(steps=321)
    fresh = Session.open("isostatic")
    fresh.run(steps=321)
    assert bits.different(bits.columns(session.model), bits.columns(fresh.model)) == []
    assert abs(session.energy.imbalance - fresh.energy.imbalance) <= 1e-9 * session.energy.work


def test_restart_of_a_model_that_was_saved_in_its_run(session: Session, tmp_path: Path) -> None:
    session.run(steps=100)
    session.save(tmp_path / "later.json")
    later = Session.open(tmp_path / "later.json")
    later.press("r")
    assert later.particles.displacement.tolist() == [[0.0, 0.0]] * 3
    assert later.time == 0.0
    assert "does not say with which velocities" in later.notice
    later.press("ctrl+z")
    assert bits.different(bits.state(later.model), bits.state(session.model)) == []


def test_the_pages_of_keys_are_turned_by_wheel_and_click_and_each_says_which_it_is() -> None:
    session = Session.open("hyperstatic")
    session.resize(640, 480)
    session.press("f1")
    session.update_view()

    def page() -> str:
        session.update_view()
        toolbar, view = session.stages[-1]
        [said] = [text for text in compose(toolbar, view, load_theme("light")).texts if text.startswith("Help")]
        return said

    count = int(page().rpartition(" ")[2])
    assert count > 1
    middle = session.view.camera.middle
    turned = [("wheel up", 1), *(("wheel down", min(there, count)) for there in range(2, count + 2))]
    for key, there in (*turned, ("wheel up", count - 1), ("click", count)):
        session.press(key, middle)
        assert page() == f"Help, page {there} of {count}"
    session.press("click", middle)
    assert session.view.help == 0


@pytest.mark.parametrize(
    ("keys", "scene"),
    [
        ((), "pause"),
        (("space",), "simulation"),
        (("k",), "force method"),
        (("d",), "load"),
        (("p", "l"), "pause"),
    ],
)
def test_escape_puts_the_list_of_keys_away_and_does_nothing_else(keys: tuple[str, ...], scene: str) -> None:
    session = Session.open("isostatic")
    for key in keys:
        session.press(key)
    gesture = session.gesture
    session.press("f1")
    session.press("escape")
    session.update_view()
    assert (session.view.help, session.scene, session.gesture) == (0, scene, gesture)


def test_the_page_of_keys_does_not_depend_on_pictures_between_inputs() -> None:
    pages = []
    for drawn in (True, False):
        session = Session.open("isostatic")
        for size, presses in (((320, 240), 2), ((1920, 1080), 0), ((320, 240), 1)):
            session.resize(*size)
            for _ in range(presses):
                session.press("f1")
            if drawn:
                session.update_view()
        session.update_view()
        pages.append((session.view.help, session.view.keys))
    assert pages[0] == pages[1]


def test_a_key_that_acts_in_pause_only_says_so_while_time_passes() -> None:
    session = Session.open("hyperstatic")
    session.press("space")
    session.press("k")
    assert session.scene == "simulation"
    assert session.notice == "Force method: press Space to pause first."
    session.press("i")
    assert session.notice == ""
    session.press("space")
    session.press("k")
    assert session.scene == "force method"


def test_a_model_opens_with_the_diagrams_that_it_names() -> None:
    session = Session.open("portal")
    assert (session.view.all_diagrams, session.view.quantity) == (True, "M")
    session.documents.open("isostatic")
    assert not session.view.all_diagrams
    session.documents.open("gerber_beam")
    assert (session.view.all_diagrams, session.view.quantity) == (True, "M")
