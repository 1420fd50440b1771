"""Whole sessions by hand, and what holds for every action."""

import numpy as np

from pinjoint import Session
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.input.actions import ACTIONS, EVERY, MENU, action_for, help_lines
from tests.systems.edit.hand import FRAME, assert_same_state, opened, press_at


def test_the_thesis_triangle_by_hand_from_an_empty_window(empty: Session) -> None:
    empty.press("g")
    for x, y in ((-1.0, -0.5), (0.0, 0.5), (1.0, -0.5)):
        press_at(empty, "p", x + 0.02, y - 0.03)  # near the grid is enough
    for start, end in (((-1.0, -0.5), (0.0, 0.5)), ((0.0, 0.5), (1.0, -0.5)), ((1.0, -0.5), (-1.0, -0.5))):
        press_at(empty, "l", *start)
        press_at(empty, "l", *end)
    press_at(empty, "c", 1.0, -0.5)
    press_at(empty, "c", -1.0, -0.5)
    press_at(empty, "c", -1.0, -0.5)
    press_at(empty, "f", 0.0, 0.5)
    empty.click(1.2, -1.1)
    a, b, c = empty.particles
    assert (a.fixed, b.force, c.fixed) == ((False, True), (120.0, -160.0), (True, True))
    empty.press("space")
    for _ in range(2000):
        empty.frame(FRAME)
        if empty.simulation.halted:
            break
    forces = empty.model.rods.axial_force
    np.testing.assert_allclose(forces, [-28.34277, -198.02746, 20.06790], atol=6e-6)
    assert empty.simulation.message.startswith("At rest")


def test_no_key_leads_to_two_actions() -> None:
    seen = set()
    for action, binding in ACTIONS.bound():
        for scene in binding.scenes:
            assert scene in (*EVERY, MENU)
            assert (scene, binding.key) not in seen, binding
            seen.add((scene, binding.key))
            assert action_for(scene, binding.key) == action.name
            if binding.title:
                assert (binding.key, binding.title) in help_lines(scene)


def test_another_action_ends_a_drag_but_a_look_does_not(triangle: Session) -> None:
    triangle.grab(1.0, 1.0)
    triangle.drag_to(1.2, 1.0)
    triangle.press("tab")
    assert triangle.gesture is not None
    triangle.press("space")
    assert triangle.gesture is None
    assert triangle.particles["B"].position == (1.2, 1.0)


def test_what_is_undone_leaves_no_trace() -> None:
    triangle = opened(integrator="velocity_verlet")  # whose steps do not end at rest
    triangle.run(steps=200)
    triangle.particles["B"].force = (10.0, 20.0)
    triangle.run(steps=100)
    triangle.click(2.0, 0.0)
    triangle.press("delete")
    triangle.run(steps=100)
    triangle.press("e")
    for _ in range(5):
        triangle.press("ctrl+z")
    triangle.run(steps=300)
    reference = opened(integrator="velocity_verlet")
    reference.run(steps=200)
    reference.run(steps=300)
    assert_same_state(triangle, Snapshot.take(reference.model))
    assert triangle.energy == reference.energy


def test_single_steps_in_a_row_are_one_entry_of_the_log(triangle: Session) -> None:
    press_at(triangle, "p", 2.0, 2.0)
    for key in ("right", "right", "right", "left", "right"):
        triangle.press(key)
    triangle.press("ctrl+z")
    assert triangle.model.clock.steps == 0
    assert triangle.particles.count == 4
    triangle.press("ctrl+y")
    assert triangle.model.clock.steps == 3
