"""What holds for every action, and for several in a row."""

from pinjoint import Session
from pinjoint.systems.input.actions import ACTIONS, EVERY, MENU, TABLE
from tests.systems.edit.hand import press_at


def test_no_key_leads_to_two_actions() -> None:
    seen = set()
    for action, binding in ACTIONS.bound():
        for scene in binding.scenes:
            assert scene in (*EVERY, MENU, TABLE)
            assert (scene, binding.key) not in seen, binding
            seen.add((scene, binding.key))
            assert ACTIONS.name_at(scene, binding.key) == action.name
            if binding.title:
                assert (binding.key, binding.title) in ACTIONS.help_lines(scene)


def test_another_action_ends_a_drag_but_a_look_does_not(triangle: Session) -> None:
    triangle.press("drag", triangle.point(1.0, 1.0))
    triangle.press("drag to", triangle.point(1.2, 1.0))
    triangle.press("tab")
    assert triangle.gesture is not None
    triangle.press("space")
    assert triangle.gesture is None
    assert triangle.particles["B"].position == (1.2, 1.0)


def test_single_steps_in_a_row_are_one_entry_of_the_log(triangle: Session) -> None:
    press_at(triangle, "p", 2.0, 2.0)
    for key in ("right", "right", "right", "left", "right"):
        triangle.press(key)
    triangle.press("ctrl+z")
    assert triangle.model.clock.steps == 0
    assert triangle.particles.count == 4
    triangle.press("ctrl+y")
    assert triangle.model.clock.steps == 3
