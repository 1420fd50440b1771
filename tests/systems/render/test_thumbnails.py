"""Thumbnails: what is drawn of a model stays inside its card and shows what happens."""

from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.components.camera import Viewport
from pinjoint.documents import models
from pinjoint.documents.previews import preview
from pinjoint.systems.render.marks import Bars
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.thumbnails import extent, thumbnail
from tests.reference.models import triangle


@pytest.mark.parametrize("name", models.bundled())
@pytest.mark.parametrize("size", [(195, 88), (192, 115), (186, 42)])
def test_everything_lies_inside_the_card(name: str, size: tuple[int, int]) -> None:
    marks = thumbnail(preview(name), Viewport(30, 50, *size), 1.0, load_theme("light"))
    low, high = extent(marks)
    assert 30 <= low[0] <= high[0] <= 30 + size[0]
    assert 50 <= low[1] <= high[1] <= 50 + size[1]
    assert (high - low).max() > 0.4 * min(size), "it is no speck"


def test_forces_are_shown_in_colour() -> None:
    theme = load_theme("light")
    marks = thumbnail(preview("warren_bridge"), Viewport(0, 0, 195, 88), 1.0, theme)
    colours = {mark.colour[:3] for mark in marks if isinstance(mark, Bars)}
    assert {theme.tension[:3], theme.compression[:3]} <= colours


def test_a_model_that_never_moved_shows_forces_of_linear_theory(tmp_path: Path) -> None:
    models.save(models.parse(triangle()), tmp_path / "mine.json")
    shown = preview(tmp_path / "mine.json")
    assert shown.rods["BC"].axial_force == pytest.approx(-197.99, abs=0.01)
    assert not shown.particles.displacement.any()


def test_a_model_that_was_run_shows_the_forces_with_which_it_was_saved(tmp_path: Path) -> None:
    session = Session.open(triangle(tensile_strength=215))
    session.settle()
    session.save(tmp_path / "mine.json")
    shown = preview(tmp_path / "mine.json")
    assert shown.rods["BC"].axial_force == pytest.approx(session.rods["BC"].axial_force)
