"""Habits: what a hand does in every program, here by the events of a real keyboard and mouse, in an unseen window."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pygame
import pytest

from pinjoint.app import App
from pinjoint.components.field import Vector
from pinjoint.documents import models
from pinjoint.documents.autosave import Autosave
from pinjoint.documents.open_documents import ModelFile
from pinjoint.documents.preferences import preferred_place
from pinjoint.editor.scenes.properties import Properties
from pinjoint.lessons.judging import named
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.game.test_autosave import values_until, window
from tests.reference.hits import hits_in

pytestmark = pytest.mark.usefixtures("data", "config")

SHIFT, CTRL = pygame.KMOD_LSHIFT, pygame.KMOD_LCTRL


class Hand:
    """A hand at the keyboard and mouse of a window."""

    def __init__(self, app: App) -> None:
        self.app, self.session = app, app.session
        self.at: Vector = (0.0, 0.0)
        app.next_frame(wait=False)

    def _post(self, kind: int, **facts: object) -> None:
        pygame.event.post(pygame.event.Event(kind, facts))
        self.app.next_frame(wait=False)

    def key(self, key: int, held: int = 0, text: str = "") -> None:
        """Press and release a key, which may type a text."""
        self._post(pygame.KEYDOWN, key=key, mod=held, unicode=text, scancode=0)
        if text:
            self._post(pygame.TEXTINPUT, text=text)
        self._post(pygame.KEYUP, key=key, mod=held)

    def write(self, text: str) -> None:
        """Type a text."""
        for character in text:
            self.key(pygame.key.key_code("space" if character == " " else character.lower()), text=character)

    def move(self, x: float, y: float, buttons: tuple[int, int, int] = (0, 0, 0)) -> None:
        """Move the pointer to a point of the model (m)."""
        at = self.session.point(x, y)
        rel = at[0] - self.at[0], at[1] - self.at[1]
        self.at = at
        self._post(pygame.MOUSEMOTION, pos=at, rel=rel, buttons=buttons)

    def down(self, button: int = 1, held: int = 0) -> None:
        pygame.key.set_mods(held)
        self._post(pygame.MOUSEBUTTONDOWN, button=button, pos=self.at)
        pygame.key.set_mods(0)

    def up(self, button: int = 1) -> None:
        self._post(pygame.MOUSEBUTTONUP, button=button, pos=self.at)

    def click(self, x: float, y: float, button: int = 1, held: int = 0) -> None:
        self.move(x, y)
        self.down(button, held)
        self.up(button)

    def drag(self, start: Vector, end: Vector, button: int = 1) -> None:
        self.move(*start)
        self.down(button)
        pressed = tuple(int(n == button) for n in (1, 2, 3))
        for share in (0.3, 0.6, 1.0):
            x, y = (start[n] + share * (end[n] - start[n]) for n in (0, 1))
            self.move(x, y, pressed)
        self.up(button)

    @property
    def selected(self) -> list[str]:
        """The names of what is selected."""
        return sorted(map(named, self.session.selected))

    @property
    def texts(self) -> list[str]:
        """All that is written in the window."""
        self.session.update_view()
        theme = load_theme(self.session.view.theme)
        return [text for shown, view in self.session.stages for text in compose(shown, view, theme).texts]


@pytest.fixture
def hand(data: Path) -> Iterator[Hand]:
    app = App(models.load("isostatic"), ModelFile(None, "isostatic"), Autosave(interval=0.0))
    yield Hand(app)
    app.close()


A, B, C = (0.0, 0.0), (1.0, 1.0), (2.0, 0.0)  # its joints


def test_click_selects_and_a_click_beside_selects_nothing(hand: Hand) -> None:
    hand.click(*A)
    assert hand.selected == ["A"]
    hand.click(*C)
    assert hand.selected == ["C"]
    hand.click(A[0], B[1])
    assert hand.selected == []


@pytest.mark.parametrize("held", [SHIFT, CTRL])
def test_shift_and_ctrl_add_to_the_selection_and_take_away(hand: Hand, held: int) -> None:
    hand.click(*A)
    hand.click(*C, held=held)
    assert hand.selected == ["A", "C"]
    hand.click(*A, held=held)
    assert hand.selected == ["C"]


def test_select_all_and_escape(hand: Hand) -> None:
    hand.key(pygame.K_a, CTRL)
    assert {"A", "B", "C", "AB", "BC", "CA"} <= set(hand.selected)
    hand.key(pygame.K_ESCAPE)
    assert hand.selected == []


def test_a_rubber_band_selects_what_it_covers(hand: Hand) -> None:
    hand.drag((A[0] - 0.3, A[1] - 0.3), (C[0] + 0.3, A[1] + 0.2))
    assert hand.selected == ["A", "C", "CA"]


def test_delete_undo_and_redo(hand: Hand) -> None:
    hand.click(*B)
    hand.key(pygame.K_DELETE)
    assert hand.session.particles.names == ["A", "C"]
    hand.key(pygame.K_z, CTRL)
    assert hand.session.particles.names == ["A", "B", "C"]
    hand.key(pygame.K_y, CTRL)
    assert hand.session.particles.names == ["A", "C"]
    hand.key(pygame.K_z, CTRL)
    hand.key(pygame.K_z, CTRL | SHIFT)
    assert hand.session.particles.names == ["A", "C"]


def test_copy_cut_paste_and_duplicate(hand: Hand) -> None:
    hand.key(pygame.K_a, CTRL)
    hand.key(pygame.K_c, CTRL)
    hand.move(C[0] + 1.0, C[1])
    hand.key(pygame.K_v, CTRL)
    assert (hand.session.particles.count, hand.session.rods.count) == (6, 6)
    hand.key(pygame.K_x, CTRL)
    assert (hand.session.particles.count, hand.session.rods.count) == (3, 3)
    hand.click(*B)
    hand.key(pygame.K_d, CTRL)
    assert hand.session.particles.count == 4


def test_drag_moves_and_one_undo_takes_it_back(hand: Hand) -> None:
    hand.drag(B, (B[0], B[1] + 0.5))
    assert hand.session.particles["B"].position[1] > B[1] + 0.3
    hand.key(pygame.K_z, CTRL)
    assert tuple(hand.session.particles["B"].position) == B


def test_escape_gives_up_a_drag(hand: Hand) -> None:
    hand.move(*B)
    hand.down()
    hand.move(B[0], B[1] + 0.5, (1, 0, 0))
    hand.key(pygame.K_ESCAPE)
    hand.up()
    assert tuple(hand.session.particles["B"].position) == B


def test_arrows_nudge(hand: Hand) -> None:
    hand.click(*B)
    hand.key(pygame.K_UP)
    assert hand.session.particles["B"].position[1] > B[1]
    hand.key(pygame.K_DOWN)
    assert hand.session.particles["B"].position[1] == pytest.approx(B[1])


def test_a_double_click_opens_properties_and_tab_goes_through_them(hand: Hand) -> None:
    hand.click(*B)
    hand.click(*B)
    assert hand.session.scene == "properties"
    scene = hand.session.scenes.active
    assert isinstance(scene, Properties)
    hand.key(pygame.K_TAB)
    first = scene.form.selected
    hand.key(pygame.K_TAB)
    second = scene.form.selected
    hand.key(pygame.K_TAB, SHIFT)
    assert first is not second
    assert scene.form.selected is first
    hand.key(pygame.K_ESCAPE)
    hand.key(pygame.K_ESCAPE)
    assert hand.session.scene == "pause"


def test_a_right_click_opens_a_menu_and_escape_closes_it(hand: Hand) -> None:
    hand.click(*B, button=3)
    assert hand.session.view.menu is not None
    hand.key(pygame.K_ESCAPE)
    assert hand.session.view.menu is None


def test_the_wheel_zooms_at_the_pointer_and_home_shows_all(hand: Hand) -> None:
    hand.move(*B)
    before, scale = hand.at, hand.session.view.camera.scale
    hand._post(pygame.MOUSEWHEEL, y=3, x=0, flipped=False)
    assert hand.session.view.camera.scale > 1.2 * scale
    assert hand.session.point(*B) == pytest.approx(before, abs=1e-6)
    hand.key(pygame.K_HOME)
    assert hand.session.view.camera.scale == pytest.approx(scale)


@pytest.mark.parametrize("button", [2, 3])
def test_two_buttons_pan(hand: Hand, button: int) -> None:
    before = hand.session.point(*A)
    hand.drag((A[0], B[1]), (A[0] + 0.4, B[1]), button)
    after = hand.session.point(*A)
    assert after[0] > before[0] + 10.0
    assert after[1] == pytest.approx(before[1], abs=1.5)
    assert hand.session.view.menu is None


def test_space_runs_and_pauses_step_and_back(hand: Hand) -> None:
    hand.key(pygame.K_RIGHT)
    assert hand.session.model.clock.steps == 1
    hand.key(pygame.K_LEFT)
    assert hand.session.model.clock.steps == 0
    hand.key(pygame.K_SPACE, text=" ")
    assert hand.session.scene == "simulation"
    hand.key(pygame.K_SPACE, text=" ")
    assert hand.session.scene == "pause"


def test_a_new_model_begins_from_the_start_page_too(hand: Hand) -> None:
    hand.key(pygame.K_d)
    assert hand.session.scene == "load"
    hand.key(pygame.K_n, CTRL)
    hand.app.next_frame(wait=False)
    assert (hand.session.scene, hand.session.particles.count) == ("statics", 0)


def test_help_opens_and_closes(hand: Hand) -> None:
    hand.key(pygame.K_F1)
    assert hand.session.view.help == 1
    hand.key(pygame.K_ESCAPE)
    assert hand.session.view.help == 0


def test_a_tip_names_the_button_under_the_pointer(hand: Hand) -> None:
    [place] = [hit for hit in hits_in(hand.session) if getattr(hit.item, "action", "") == "settle"]
    hand.at = place.middle
    hand._post(pygame.MOUSEMOTION, pos=hand.at, rel=(0, 0), buttons=(0, 0, 0))
    assert any("Find equilibrium at once" in text for text in hand.texts)


def test_a_disabled_button_says_why(hand: Hand) -> None:
    [place] = [hit for hit in hits_in(hand.session) if getattr(hit.item, "action", "") == "undo"]
    hand.at = place.middle
    hand.down()
    hand.up()
    assert hand.session.notice == "There is nothing to undo."


def test_new_rods_snap_to_the_grid_and_to_joints(hand: Hand) -> None:
    hand.move(C[0] + 0.5, C[1])
    hand.key(pygame.K_p, text="p")
    x, y = hand.session.particles.position[3].tolist()
    assert (x / 0.25) == pytest.approx(round(x / 0.25))
    hand.move(*A)
    hand.key(pygame.K_l, text="l")
    hand.move(x + 0.01, y + 0.01)
    preview = hand.session.view.preview
    assert preview is not None
    hand.down()
    hand.up()
    assert hand.session.rods.between[-1].tolist() == [0, 3]


def test_a_marker_shows_where_a_click_would_snap(hand: Hand) -> None:
    tools = hand.app.session.view.toolbar.groups
    hand.session.view.tool = next(tool.action for group in tools for tool in group if tool.action == "place")
    hand.move(C[0] + 0.507, C[1] + 0.004)
    hand.session.update_view()
    marker = hand.session.view.preview
    assert marker is not None
    assert marker.start == pytest.approx((2.5, 0.0))
    hand.down()
    hand.up()
    assert hand.session.particles.position[-1].tolist() == pytest.approx([2.5, 0.0])


def test_a_file_that_is_dropped_opens(hand: Hand, tmp_path: Path) -> None:
    path = tmp_path / "dropped.json"
    models.save(models.load("hyperstatic"), path)
    hand._post(pygame.DROPFILE, file=str(path))
    assert hand.session.rods.count == 6
    hand.key(pygame.K_z, CTRL)
    assert hand.session.rods.count == 3


def test_save_says_where_and_recent_models_stand_first(hand: Hand, data: Path) -> None:
    hand.click(*B)
    hand.key(pygame.K_UP)
    hand.key(pygame.K_s, CTRL)
    assert hand.session.scene == "save"
    hand.key(pygame.K_a, CTRL)
    hand.write("my truss")
    hand.key(pygame.K_RETURN)
    assert [path.name for path in data.rglob("my truss.json")] == ["my truss.json"]
    assert "my truss" in hand.session.notice
    hand.key(pygame.K_o, CTRL)
    assert hand.session.scene == "load"
    assert "my truss" in hand.texts


def test_a_picture_says_where_it_went(hand: Hand, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    hand.key(pygame.K_F12)
    assert str(tmp_path / "pinjoint.png") in hand.session.notice
    assert (tmp_path / "pinjoint.png").is_file()


def test_units_are_understood_in_boxes(hand: Hand) -> None:
    hand.click(*B)
    hand.key(pygame.K_RETURN)
    hand.session.click_box("load x")
    hand.write("0.5 MN")
    hand.key(pygame.K_RETURN)
    assert hand.session.particles["B"].force[0] == 500.0


def test_full_screen_and_back(hand: Hand) -> None:
    size = hand.app.size
    hand.key(pygame.K_F11)
    hand.key(pygame.K_F11)
    assert hand.app.size == size


def closed(app: App) -> None:
    """Close a window as its button does."""
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    app.run()


def test_a_window_opens_where_and_as_large_as_it_was(
    data: Path, config: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pinjoint.app.UNSEEN", ())
    app = App(models.load("isostatic"))
    app.window.size, app.window.position = (900, 600), (40, 30)
    closed(app)
    place = preferred_place()
    assert place is not None
    assert place[2:] == (900, 600)
    app = App(models.load("isostatic"), place=place)
    assert app.window.size == (900, 600)
    app.close()


def offered(data: Path) -> Hand:
    """A new window, in which the first of the models to open is opened."""
    hand = Hand(App(models.load("isostatic"), ModelFile(None, "isostatic"), Autosave(interval=0.0)))
    hand.key(pygame.K_o, CTRL)
    assert any(text.startswith("not saved") for text in hand.texts)
    hand.key(pygame.K_DOWN)
    hand.key(pygame.K_RETURN)
    return hand


def test_work_that_nobody_saved_is_offered_after_its_window_was_closed(hand: Hand, data: Path) -> None:
    hand.drag(B, (1.0, 1.5))
    closed(hand.app)
    again = offered(data)
    assert again.session.particles["B"].position == (1.0, 1.5)
    assert again.session.document.unsaved
    again.app.close()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_work_is_recovered_after_a_kill(data: Path, tmp_path: Path) -> None:
    models.save(models.load("isostatic"), tmp_path / "work.json")
    with window(tmp_path / "work.json") as process:
        values_until(process, 1.5)
        process.send_signal(signal.SIGKILL)
        process.wait()
    hand = offered(data)
    assert hand.session.rods[0].stiffness > 1000.0
    hand.app.close()
