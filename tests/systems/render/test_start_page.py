"""The start page: nothing of it is cut, and its rows look intended, at every size that is promised."""

from __future__ import annotations

from itertools import pairwise

import pytest

from pinjoint.components.form import Tile
from pinjoint.documents.library import data_apart
from pinjoint.editor.scenes.load import Load
from pinjoint.systems.render.marks import Text
from tests.golden.scenes import Window, composed
from tests.golden.states import STATES
from tests.reference.boxes import overlapping, text_box, text_boxes

WINDOWS = [Window(640, 480), Window(1024, 640), Window(1280, 800), Window(1920, 1080), Window(1600, 1200, 1.5)]


@pytest.mark.parametrize("window", WINDOWS, ids=str)
def test_the_whole_explanation_of_every_tile_is_shown(window: Window) -> None:
    with data_apart():
        session = STATES["welcome"](window)
        scene = session.scenes.active
        assert isinstance(scene, Load)
        told = [tile for tile in scene.form.tiles if tile.explanation]
        assert max(len(tile.explanation) for tile in told) > 400
        for tile in told:
            scene.form.chosen = tile
            [picture] = composed(session)
            said = " ".join(mark.text for mark in picture.marks if isinstance(mark, Text))
            assert " ".join(tile.explanation.split()) in said
            texts = [text_box(mark, mark.size) for mark in picture.marks if isinstance(mark, Text)]
            assert max(bottom for _, _, _, bottom in texts) <= window.height


@pytest.mark.parametrize("window", WINDOWS, ids=str)
def test_rows_of_a_section_are_about_equally_long(window: Window) -> None:
    with data_apart():
        session = STATES["welcome"](window)
        scene = session.scenes.active
        assert isinstance(scene, Load)
        scene.form.tiles = [tile for tile in scene.form.tiles if not tile.rest]  # nothing is folded
        layout = scene.layout(session)
        pills = [row for row in layout.rows if all(isinstance(item, Tile) and item.symbol for item in row)]
        assert sum(map(len, pills)) >= 5
        assert all(len(one) - len(other) <= 1 for one, other in pairwise(pills))
        widths = {
            round(place.width) for place in layout.places if place.item in [p for row in pills for p in row]
        }
        assert len(widths) == 1
        [picture] = composed(session)
        said = " ".join(mark.text for mark in picture.marks if isinstance(mark, Text))
        for place in layout.places:
            if isinstance(place.item, Tile) and place.item.symbol:
                assert place.item.title in said
        texts = text_boxes(mark for mark in picture.marks if isinstance(mark, Text))
        assert overlapping(texts) == []
