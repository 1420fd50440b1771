"""Copying, cutting, pasting and duplicating."""

from typing import Any

import numpy as np

from pinjoint import Session
from pinjoint.components.language import tr
from pinjoint.documents.document import document


def test_copy_and_paste_at_the_pointer(triangle: Session) -> None:
    triangle.press("ctrl+a")
    triangle.press("ctrl+c")
    triangle.point(5.0, 2.5)
    triangle.press("ctrl+v")
    assert (triangle.particles.count, triangle.rods.count) == (6, 6)
    pasted = triangle.selected
    assert len(pasted) == 6
    offset = np.array([4.0, 2.0])  # the middle (1, 0.5) of the triangle is at the pointer
    np.testing.assert_allclose(
        triangle.model.particles.position[3:], triangle.model.particles.position[:3] + offset
    )
    np.testing.assert_array_equal(triangle.model.rods.between[3:], triangle.model.rods.between[:3] + 3)
    np.testing.assert_array_equal(triangle.model.particles.force[3:], triangle.model.particles.force[:3])
    assert triangle.particles.names[3:] == ["particle 1", "particle 2", "particle 3"]
    triangle.press("ctrl+z")
    assert triangle.particles.count == 3


def test_cut_and_paste_keeps_names(triangle: Session) -> None:
    before = document(triangle.model)
    triangle.press("ctrl+a")
    triangle.press("ctrl+x")
    assert (triangle.particles.count, triangle.rods.count) == (0, 0)
    triangle.point(1.0, 0.5)
    triangle.press("ctrl+v")
    assert document(triangle.model) == before


def test_duplicate_beside(triangle: Session) -> None:
    triangle.click(1.0, 1.0)
    triangle.press("ctrl+d")
    copy: Any
    [copy] = triangle.selected
    assert copy.position == (1.3, 0.7)
    assert copy.force == triangle.particles["B"].force
    triangle.press("ctrl+z")
    assert triangle.notice == "Undone: duplicate"


def test_rods_are_copied_with_their_ends_and_nothing_else(triangle: Session) -> None:
    triangle.select(triangle.rods["AB"], triangle.particles["C"])
    triangle.press("ctrl+d")
    assert (triangle.particles.count, triangle.rods.count) == (6, 4)


def test_pasting_what_is_no_model_is_refused(triangle: Session) -> None:
    triangle.press("ctrl+v")
    assert triangle.notice.startswith("The clipboard holds no particles or rods")
    assert triangle.particles.count == 3


def test_a_text_that_is_told_in_a_language_can_be_pasted_and_is_refused(triangle: Session) -> None:
    triangle.clipboard = tr("There is nothing to undo.")
    triangle.press("ctrl+v")
    assert triangle.notice.startswith("The clipboard holds no particles or rods")
