"""What a person does with mouse and keys in a window, as presses of the session."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pygame
import pytest

from pinjoint import Session
from pinjoint.systems.input.pygame_input import PygameInput

LEFT, RIGHT = pygame.BUTTON_LEFT, pygame.BUTTON_RIGHT


@pytest.fixture
def session() -> Iterator[Session]:
    pygame.display.init()
    pygame.event.clear()
    made = Session.open("isostatic", [PygameInput()])
    made.view.camera.scale = 100.0
    yield made
    pygame.display.quit()


def pressed(session: Session, *events: tuple[int, dict[str, Any]]) -> list[str]:
    """The keys and buttons that events of one frame become."""
    for kind, values in events:
        pygame.event.post(pygame.event.Event(kind, values))
    pygame.event.post(pygame.event.Event(pygame.USEREVENT))  # so that nothing is waited for
    return [key for key, _ in session.frame(0.0).pressed]


def down(x: float, y: float, button: int = LEFT) -> tuple[int, dict[str, Any]]:
    return pygame.MOUSEBUTTONDOWN, {"pos": (x, y), "button": button}


def up(x: float, y: float, button: int = LEFT) -> tuple[int, dict[str, Any]]:
    return pygame.MOUSEBUTTONUP, {"pos": (x, y), "button": button}


def motion(x: float, y: float, buttons: tuple[int, int, int] = (1, 0, 0)) -> tuple[int, dict[str, Any]]:
    return pygame.MOUSEMOTION, {"pos": (x, y), "rel": (3, -2), "buttons": buttons}


def key(code: int, *, mod: int = 0, kind: int = pygame.KEYDOWN) -> tuple[int, dict[str, Any]]:
    return kind, {"key": code, "mod": mod}


def test_a_click_may_slip_by_4_points(session: Session) -> None:
    assert pressed(session, down(300, 500), motion(303, 502), up(303, 502)) == ["click"]


def test_a_drag_begins_where_the_button_went_down_and_ends_where_it_came_up(session: Session) -> None:
    x, y = session.view.camera.to_pixels((1.0, 1.0)).tolist()
    assert pressed(session, down(x, y)) == []
    assert pressed(session, motion(x + 2, y), motion(x + 10, y), motion(x + 20, y - 10)) == ["drag", "drag to"]
    assert session.particles["B"].position == (1.2, 1.1)
    assert pressed(session, motion(x + 30, y), up(x + 30, y)) == ["drag to", "drop"]
    assert session.particles["B"].position == (1.3, 1.0)
    assert session.gesture is None


def test_esc_in_a_drag_puts_back_and_what_follows_does_nothing(session: Session) -> None:
    x, y = session.view.camera.to_pixels((1.0, 1.0)).tolist()
    pressed(session, down(x, y), motion(x + 30, y))
    pressed(session, key(pygame.K_ESCAPE))
    pressed(session, motion(x + 60, y), up(x + 60, y))
    assert session.particles["B"].position == (1.0, 1.0)
    assert session.scene == "pause"


def test_the_other_buttons_move_the_view(session: Session) -> None:
    assert pressed(
        session,
        down(300, 500, RIGHT),
        motion(303, 498, (0, 0, 1)),
        motion(306, 496, (0, 0, 1)),
        up(306, 496, RIGHT),
    ) == ["drag middle"]


def test_a_held_key_repeats_only_where_that_makes_sense(session: Session) -> None:
    before = session.model.grids.count
    again = [key(pygame.K_RIGHT)] * 3
    assert pressed(session, *again) == ["right"] * 3
    assert pressed(session, *[key(pygame.K_g)] * 3) == ["g"]
    assert pressed(session, key(pygame.K_g)) == []
    assert pressed(session, key(pygame.K_g, kind=pygame.KEYUP), key(pygame.K_g)) == ["g"]
    assert session.model.grids.count == before + 2


def test_modifiers_come_first(session: Session) -> None:
    both = pygame.KMOD_CTRL | pygame.KMOD_SHIFT
    assert pressed(session, key(pygame.K_z, mod=both)) == ["ctrl+shift+z"]
    assert pressed(session, key(pygame.K_LEFT, mod=pygame.KMOD_SHIFT)) == ["shift+left"]
    assert pressed(session, key(pygame.K_p, mod=pygame.KMOD_SHIFT)) == ["p"]


@pytest.mark.parametrize("held", [pygame.KMOD_CTRL, pygame.KMOD_SHIFT])
def test_a_click_with_ctrl_or_shift_adds(session: Session, held: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pygame.key, "get_mods", lambda: held)
    assert pressed(session, down(300, 500), up(300, 500)) == ["ctrl+click"]


def test_losing_the_focus_ends_a_drag_but_makes_no_click(session: Session) -> None:
    x, y = session.view.camera.to_pixels((1.0, 1.0)).tolist()
    pressed(session, down(x, y), motion(x + 30, y))
    assert pressed(session, (pygame.WINDOWFOCUSLOST, {})) == ["drop"]
    assert session.gesture is None
    pressed(session, down(x, y))
    assert pressed(session, (pygame.WINDOWFOCUSLOST, {})) == []


def test_a_right_click_may_slip_by_4_points_else_it_moves_the_view(session: Session) -> None:
    assert pressed(session, down(300, 500, RIGHT), up(302, 501, RIGHT)) == ["right click"]
    slip = motion(303, 498, (0, 0, 1))
    assert pressed(session, down(300, 500, RIGHT), slip, up(303, 498, RIGHT)) == ["right click"]


def test_two_quick_clicks_at_a_place_are_a_double_click(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [0.0]
    monkeypatch.setattr("pinjoint.systems.input.pygame_input.time.monotonic", lambda: now[0])
    click = down(300, 500), up(300, 500)
    assert pressed(session, *click, *click, *click) == ["click", "double click", "click"]
    now[0] = 1.0
    assert pressed(session, *click) == ["click"]
    assert pressed(session, down(340, 500), up(340, 500)) == ["click"]  # elsewhere
    now[0] = 2.0
    assert pressed(session, down(340, 500), up(340, 500)) == ["click"]


def test_files_dropped_together_are_opened_together(session: Session, tmp_path: Path) -> None:
    for name in ("one", "two"):
        session.save(tmp_path / f"{name}.json")
    dropped = [(pygame.DROPFILE, {"file": str(tmp_path / f"{name}.json")}) for name in ("one", "two")]
    pressed(session, *dropped)
    assert session.notice == "Opened one and two. Ctrl+Z goes back."
    assert session.document.file.name == "two"
