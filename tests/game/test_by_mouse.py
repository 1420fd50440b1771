"""Everything by mouse: menus, double clicks, buttons that close, clicks that go no further, files that are dropped."""

import io
from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.components.language import spoken
from pinjoint.components.model import Model
from pinjoint.components.tags import DiagramShown
from pinjoint.components.toolbar import Menu, Tool
from pinjoint.components.view import Hit
from pinjoint.documents import models
from pinjoint.editor.scenes.form import FormScene
from pinjoint.editor.scenes.properties import Properties
from pinjoint.editor.toolbar import of_mods
from pinjoint.scripts.playing import Recorder, play, session_of
from pinjoint.scripts.script import Script
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.menu import pointed_at
from tests.reference import bits
from tests.reference.hits import hits_in, push

pytestmark = pytest.mark.usefixtures("data")

LIGHT = load_theme("light")
SIZES = [(320, 240), (640, 480), (1280, 800)]


@pytest.fixture
def session() -> Session:
    made = Session.open("hyperstatic")
    made.resize(1024, 640)
    return made


def menu(session: Session) -> Menu:
    assert session.view.menu is not None
    return session.view.menu


def entries(session: Session) -> list[Hit]:
    """The entries of the open menu that are in sight, in their order."""
    return [hit for hit in hits_in(session) if isinstance(hit.item, int)]


def actions(shown: Menu) -> list[str]:
    return [entry.action for entry in shown.entries]


def choose(session: Session, action: str, button: str = "click") -> None:
    """Click an entry of the open menu."""
    push(session, action, button)


def click_button(session: Session, name: str) -> None:
    """Click "close" or "accept" of a form."""
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    place = scene.layout(session).place_of(name)
    assert place is not None
    session.press("click", place.middle)


# --- menus -----------------------------------------------------------------------------------------------


def test_a_right_click_selects_what_it_hits_and_opens_its_menu(session: Session) -> None:
    session.click(1.5, 1.5, "right click")
    assert session.selected == [session.particles["C"]]
    assert menu(session).title == "Particle C"
    assert {"properties", "toggle diagrams", "probes.plot", "pin", "force", "delete"} <= {
        *actions(menu(session))
    }
    session.press("escape")
    assert (session.view.menu, session.selected) == (None, [session.particles["C"]])
    session.click(0.0, 0.75, "right click")
    assert menu(session).title == "Rod AB"
    assert {"properties", "toggle cable", "release", "delete"} <= {*actions(menu(session))}
    session.press("right click", (900.0, 100.0))  # beside the menu: another one
    assert (session.selected, menu(session).title) == ([], "")
    wanted = {"place", "paste", "fit", "toggle diagrams", "new grid", "walls.wall", "picture as svg"}
    assert wanted <= {*actions(menu(session))}


def test_a_menu_without_room_for_all_its_columns_goes_on_by_the_wheel(session: Session) -> None:
    session.resize(320, 240)
    session.press("right click", session.view.camera.middle)
    first = {hit.item for hit in entries(session)}
    assert first < {*range(len(menu(session).entries))}
    session.press("wheel down", entries(session)[0].middle)
    assert not first & {hit.item for hit in entries(session)}


def test_a_right_click_on_one_of_several_selected_keeps_them(session: Session) -> None:
    session.press("ctrl+a")
    session.click(1.5, 1.5, "right click")
    assert len(session.selected) == 10
    assert menu(session).title == "4 particles, 6 rods"
    choose(session, "toggle cable")
    assert all(rod.tension_only for rod in session.rods)
    assert session.notice == "6 rods: tension only, as a cable"
    session.press("ctrl+z")
    assert not any(rod.tension_only for rod in session.rods)


def test_entries_act_where_the_menu_was_opened(session: Session) -> None:
    session.press("right click", session.point(0.75, 1.75))
    choose(session, "place")
    assert session.view.menu is None
    assert session.particles[-1].position == pytest.approx((0.75, 1.75), abs=0.01)
    made = session.particles[-1]
    session.click(*made.position, "right click")
    choose(session, "force")
    session.click(1.0, 1.75)
    assert made.force != (0.0, 0.0)
    session.click(*made.position, "right click")
    choose(session, "rod")
    session.click(1.5, 1.5)
    assert session.rods[-1].ends == (made, session.particles["C"])


@pytest.mark.parametrize(
    ("action", "fixed"),
    [("pin", (True, True)), ("hold x", (True, False)), ("hold y", (False, True)), ("free", (False, False))],
)
def test_supports_are_chosen_and_the_present_one_is_marked(
    session: Session, action: str, fixed: tuple[bool, bool]
) -> None:
    session.click(1.5, 1.5, "right click")
    choose(session, action)
    assert session.particles["C"].fixed == fixed
    session.click(1.5, 1.5, "right click")
    supports = ("pin", "hold x", "hold y", "free")
    assert [e.action for e in menu(session).entries if e.pressed and e.action in supports] == [action]


def test_a_rod_is_released_in_the_force_method(session: Session) -> None:
    session.click(0.5, 1.0, "right click")
    choose(session, "release")
    assert session.scene == "force method"
    session.expect("force_method.unknown = BD")
    session.press("right click", session.view.camera.middle)
    choose(session, "next part")
    session.expect("force_method.part = 4")


def test_keys_go_through_a_menu(session: Session) -> None:
    session.point(1.5, 1.5)
    session.press("menu")
    session.press("up")  # the last
    assert menu(session).entries[menu(session).chosen].action == "delete"
    session.press("down")
    session.press("down")
    session.press("return")  # the diagram
    assert session.model.tagged(DiagramShown) == [session.particles["C"]]
    session.press("shift+f10")
    session.press("return")  # nothing is chosen yet
    assert session.view.menu is not None
    session.press("k")  # no key of menus
    assert (session.view.menu, session.scene) == (None, "force method")


def test_the_entry_under_the_pointer_counts_once_it_moves(session: Session) -> None:
    session.press("right click", session.point(1.5, 1.5))
    place = entries(session)[2]
    session.view.pointer = pointed = (place.left + 5.0, place.top + 5.0)
    assert pointed_at(session.view, LIGHT, pointed) == 2
    session.press("down")
    assert pointed_at(session.view, LIGHT, pointed) == 3
    session.view.pointer = (pointed[0] + 1.0, pointed[1])
    assert pointed_at(session.view, LIGHT, session.view.pointer) == 2


def test_a_click_beside_a_menu_closes_it_and_does_nothing_else(session: Session) -> None:
    before = bits.columns(session.model)
    session.click(1.5, 1.5, "right click")
    session.click(0.0, 0.0)
    assert (session.view.menu, session.selected) == (None, [session.particles["C"]])
    session.click(1.5, 1.5, "right click")
    first = entries(session)[0]
    session.press("click", (first.left + 5.0, first.top - 5.0))  # the title
    assert session.view.menu is not None
    session.press("i")  # a key that menus do not know
    assert session.view.menu is None
    assert session.model.tagged(DiagramShown) == [session.particles["C"]]
    assert bits.different(bits.columns(session.model), before) == []


def test_a_click_with_the_pointer_unmoved_chooses_nothing_that_came_to_lie_under_it(session: Session) -> None:
    session.resize(320, 240)
    session.press("right click", (160.0, 150.0))
    assert any(entry.contains((160.0, 150.0)) for entry in entries(session))
    before = bits.columns(session.model)
    session.press("click", (160.0, 150.0))
    assert (session.view.menu, session.scene, session.notice) == (None, "pause", "")
    assert bits.different(bits.columns(session.model), before) == []


def test_what_would_do_nothing_cannot_be_chosen(session: Session) -> None:
    session.press("right click", session.view.camera.middle)
    assert not next(e for e in menu(session).entries if e.action == "restart").enabled
    choose(session, "restart")
    assert session.view.menu is not None


@pytest.mark.parametrize(
    ("size", "ratio"), [(SIZES[0], 1.5), (SIZES[1], 1.0), (SIZES[1], 1.5), (SIZES[2], 1.0)]
)
def test_menus_open_inside_the_window_with_all_their_entries_to_be_read(
    size: tuple[int, int], ratio: float
) -> None:
    """With the pointer anywhere, of a particle and of the canvas, with and without a toolbar."""
    session = Session.open("hyperstatic")
    session.resize(*size, ratio)
    for legend in (True, False):
        session.view.legend = legend
        for share in ((0.0, 0.0), (0.99, 0.02), (0.5, 0.5), (0.99, 0.99)):
            for chosen in ([], [session.particles["C"]]):
                session.select(*chosen)
                session.view.menu = None
                session.press("menu", (share[0] * size[0] + 0.5, share[1] * size[1]))
                if session.view.menu is None:
                    continue  # the pointer is over the toolbar
                places, count = entries(session), len(menu(session).entries)
                for place in places:
                    assert place.left >= 0.0
                    assert place.top >= 0.0
                    assert place.right <= size[0]
                    assert place.bottom <= size[1]
                    assert [other for other in places if other.contains(place.middle)] == [place]
                assert len(places) == count or size[0] < 640 * ratio or size[1] < 480 * ratio
                if legend or share != (0.5, 0.5):  # the longest menus are those without a toolbar
                    continue
                for _ in range(count):  # what is not in sight comes there by keys
                    session.press("down")
                    assert menu(session).chosen in {entry.item for entry in entries(session)}


def test_menus_offer_all_that_the_toolbar_has_where_it_is_hidden(session: Session) -> None:
    session.press("tab")
    session.press("right click", session.view.camera.middle)
    offered = {entry.action for entry in menu(session).entries}
    bar = {tool.action for group in session.view.toolbar.groups for tool in group}
    assert {*bar, *of_mods(draw=True), "toggle legend"} <= offered
    choose(session, "toggle legend")
    assert session.view.legend


def test_a_recording_of_menus_and_double_clicks_plays_to_the_same_bits(
    session: Session, tmp_path: Path
) -> None:
    session = Session.open("isostatic")
    file = io.StringIO()
    Recorder(session, file, "isostatic")
    session.click(1.0, 1.0, "right click")
    choose(session, "pin")
    session.click(0.5, 0.5, "right click")
    choose(session, "toggle cable")
    session.press("right click", session.point(1.5, 1.5))
    choose(session, "place", "double click")
    session.click(1.0, 1.0, "double click")
    assert session.scene == "properties"
    click_button(session, "close")
    assert session.scene == "pause"
    path = tmp_path / "recorded.jsonl"
    path.write_text(file.getvalue(), encoding="utf-8")
    replayed = session_of(Script(path))
    assert play(Script(path), replayed) == []
    assert replayed.particles.count == 4
    assert bits.different(bits.columns(session.model), bits.columns(replayed.model)) == []


# --- double clicks ---------------------------------------------------------------------------------------


def test_a_double_click_opens_properties_and_leads_back(session: Session) -> None:
    session.press("space")
    session.click(1.5, 1.5)
    session.click(1.5, 1.5, "double click")
    assert (session.scene, session.selected) == ("properties", [session.particles["C"]])
    session.press("escape")
    assert session.scene == "simulation"
    session.press("space")
    session.click(0.75, 2.1, "double click")  # nothing
    assert session.scene == "pause"


def test_a_double_click_elsewhere_is_two_clicks(session: Session) -> None:
    for key in ("click", "double click"):
        push(session, "faster", key)
    assert session.document.live.clock.factor == 4.0
    push(session, "faster")
    session.click(1.5, 1.5, "double click")  # which a script means as a whole
    assert session.scene == "properties"


def test_the_second_click_on_a_picture_is_not_meant_for_the_model_that_it_opened(session: Session) -> None:
    session.press("d")
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    tile = next(tile for tile in scene.form.tiles if tile.file == "isostatic")
    place = scene.layout(session).place_of(tile)
    assert place is not None
    pixel = place.left + 10.0, place.top + 10.0
    session.press("click", pixel)
    assert session.scene == "pause"
    session.press("double click", pixel)
    assert (session.scene, session.selected) == ("pause", [])


# --- what lies on top takes clicks -----------------------------------------------------------------------


def test_clicks_do_not_go_through_the_help(session: Session) -> None:
    session.press("f1")
    for button in ("drag", "wheel up"):
        session.press(button, session.point(1.5, 1.5))
    assert (session.view.help, session.gesture) == (1, None)
    session.click(1.5, 1.5)  # a click in the card goes on, one beside it closes
    assert (session.view.help, session.selected) == (2, [])
    session.press("click", (1.0, 1.0))
    assert (session.view.help, session.scene) == (0, "pause")


def test_clicks_do_not_go_through_panels_and_the_status_bar(session: Session) -> None:
    session.press("m")
    session.press("j")
    session.update_view()
    session.select(session.particles["A"])
    panels = session.view.panels
    at = panels.left + panels.width / 2, panels.top + 80.0
    for pixel in (at, (500.0, 635.0)):
        for button in ("click", "drag", "right click", "double click"):
            session.press(button, pixel)
        assert session.selected == [session.particles["A"]]
        assert (session.gesture, session.view.menu, session.scene) == (None, None, "pause")


# --- buttons of forms ------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("key", ["return", "s", "d"])
def test_properties_save_and_load_have_a_button_that_closes_them(key: str, size: tuple[int, int]) -> None:
    session = Session.open("hyperstatic")
    session.resize(*size)
    session.click(1.5, 1.5)
    session.press(key)
    assert session.scene != "pause"
    click_button(session, "close")
    assert session.scene == "pause"


def test_a_model_is_saved_and_replaced_by_mouse(session: Session, data: Path) -> None:
    for stiffness in (1000.0, 2000.0):
        session.rods["AB"].stiffness = stiffness
        session.press("ctrl+shift+s")
        click_button(session, "accept")
        if stiffness == 2000.0:
            assert "There is already a model 'hyperstatic'" in session.message
            click_button(session, "accept")
        assert session.scene == "pause"
        saved = models.load(data / "models" / "hyperstatic.json")
        assert saved.rods["AB"].stiffness == stiffness


def test_escape_says_in_the_present_language_which_word_was_not_taken(session: Session) -> None:
    session.select(session.rods["AB"])
    with spoken("pt"):
        session.press("return")
        session.click_box("tension only")
        session.type("s")
        session.press("escape")
        assert session.message.startswith("“sim” foi rejeitado; só tração continua a ser não.")


def test_escape_says_what_was_typed_and_not_taken(session: Session) -> None:
    session.select(session.rods["AB"])
    session.press("return")
    session.click_box("stiffness")
    before = session.boxes["stiffness"]
    session.type("7")
    session.press("escape")
    assert session.scene == "properties"
    assert (
        session.message
        == f"“7” was discarded; stiffness is still {before}. Press Return to accept what you typed."
    )
    session.click_box("stiffness")
    session.type("8")
    assert "not taken" not in session.message
    click_button(session, "close")  # which takes it
    assert session.rods["AB"].stiffness == 8.0


def test_what_a_box_does_not_take_is_said(session: Session) -> None:
    session.select(session.rods["AB"])
    session.press("return")
    session.click_box("stiffness")
    session.type("50x")
    assert session.message == (
        "Type a number in kN, such as 2.5 or 1e3, without “x”. “automatic” is possible, too."
    )
    session.type("\ud800")  # half a character
    assert "without “\\ud800”" in session.message
    session.type("0")
    assert session.message == ""
    session.click_box("tension only")
    session.type("yes")
    assert session.message == ""


# --- files -----------------------------------------------------------------------------------------------


def test_files_that_are_dropped_are_opened_and_wrong_ones_explained(session: Session, tmp_path: Path) -> None:
    for name in ("isostatic", "tower"):
        Session.open(name).save(tmp_path / f"{name}.json")
    (tmp_path / "photo.png").write_bytes(b"\x89PNG")
    (tmp_path / "broken.json").write_text(
        '{"format": "pinjoint model", "version": 1, "rodz": []}', encoding="utf-8"
    )
    session.press("s")
    session.press(f"files {tmp_path / 'photo.png'}")
    assert session.scene == "save"
    assert session.message == (
        "'photo.png' is not a model: Pinjoint opens model files (.json) and recorded sessions (.jsonl)."
    )
    session.press(f"files {tmp_path / 'broken.json'}\n{tmp_path}\n{tmp_path / 'gone.json'}")
    assert "rodz" in session.message
    assert "is a folder" in session.message
    assert "gone.json" in session.message
    session.press(f"files {tmp_path}/isostatic.json\n{tmp_path}/photo.png\n{tmp_path}/tower.json")
    assert (session.scene, session.document.file.name) == ("pause", "tower")
    assert session.notice.endswith("Opened isostatic and tower. Ctrl+Z goes back.")
    assert "photo.png" in session.notice
    session.press("ctrl+z")
    assert session.document.file.name == "isostatic"
    session.press("ctrl+z")
    assert session.document.file.name == "hyperstatic"


def test_a_recorded_session_that_is_dropped_is_played(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "lesson.jsonl"
    path.write_text(
        '{"format": "pinjoint session", "version": 1, "model": "tower", "title": "T"}\n', encoding="utf-8"
    )
    session.press("space")
    session.press(f"files {path}")
    assert session.lesson is not None
    assert session.lesson.title == "T"
    assert (session.scene, session.document.file.name) == ("pause", "tower")


def test_properties_stand_where_they_cover_nothing(session: Session) -> None:
    """A person who zoomed or drew in part of the window has no picture that is fitted anew beside them."""
    session.resize(1280, 800)
    session.update_view()
    camera, rod = session.view.camera, session.rods["CD"]
    camera.zoom(0.5, (0.0, 0.0))
    camera.pan((850.0 - camera.to_pixels(session.particles["C"].position)[0], 0.0))
    session.view.fitted = False
    session.select(rod)
    session.press("return")
    assert isinstance(session.scenes.active, Properties)
    assert session.scenes.active.viewport(session).left > 850.0
    session.press("escape")
    session.act("fit")
    session.press("return")
    assert session.scenes.active.viewport(session).left == session.view.strip.right


@pytest.mark.parametrize("source", ["isostatic", None])
@pytest.mark.parametrize("scene", ["pause", "statics", "simulation"])
def test_a_button_that_does_nothing_now_says_why(source: str | None, scene: str) -> None:
    session = Session(Model()) if source is None else Session.open(source)
    session.press({"pause": "escape", "statics": "q", "simulation": "space"}[scene])
    session.update_view()
    tools = [hit for hit in hits_in(session) if isinstance(hit.item, Tool) and not hit.enabled]
    assert len(tools) > 5
    for hit in tools:
        session.notice = ""
        session.press("click", hit.middle)
        assert session.notice, hit.item.action
        assert session.scene == scene
