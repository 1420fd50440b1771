"""The drawing of free bodies: pairs of opposite arrows, values beside them, and sums with their numbers."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.view import drawn_positions
from pinjoint.systems.render.marks import Fills, Picture, Strokes, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.golden.test_nearness import leader

LIGHT = load_theme("light")


def apart(model: str, size: tuple[int, int] = (1280, 800), *selected: str) -> Session:
    session = Session.open(model)
    session.resize(*size)
    session.settle()
    session.select(*[session.particles[name] for name in selected])
    session.press("x")
    session.frame(0.0)
    session.update_view()
    return session


def picture_of(session: Session) -> Picture:
    return compose(session.model, session.view, LIGHT)


def of_rod(picture: Picture, kind: type, row: int) -> list[np.ndarray]:
    """The geometry of the items of a rod in marks of a kind."""
    found = []
    for mark in picture.marks:
        if isinstance(mark, kind) and mark.of is not None and mark.of[0] == "rods":
            chosen = mark.of[1] == row
            found += (
                list(mark.corners[chosen])
                if kind is Fills
                else list(zip(mark.start[chosen], mark.end[chosen], strict=True))
            )
    return found


def test_every_rod_has_two_pairs_of_opposite_arrows_in_its_gaps() -> None:
    session = apart("isostatic")
    picture = picture_of(session)
    for rod in session.model.rods:
        heads = of_rod(picture, Fills, rod.row)
        assert len(heads) == 4
        directions = [head[0] - head[1:].mean(axis=0) for head in heads]
        assert sum(directions) == pytest.approx([0.0, 0.0], abs=1e-9)
        start, end = of_rod(picture, Strokes, rod.row)[0]
        first, last = session.view.camera.to_pixels(session.model.particles.position)[list(rod.between)]
        assert np.hypot(*(end - start)) < 0.8 * np.hypot(*(last - first))  # apart from its joints


def test_values_and_sums_are_told() -> None:
    session = apart("isostatic")
    texts = picture_of(session).texts
    assert {"28.34 kN", "198.0 kN", "20.07 kN", "140.0 kN", "120.0 kN"} <= set(texts)
    assert "20.1 − 140.1 + 120.0 = 0" in texts
    [readout] = session.view.readouts
    assert dict(readout.rows)["A ΣFy"] == "−20.01 + 20.01 = 0"


def test_a_selected_joint_tells_all_its_forces() -> None:
    session = apart("isostatic", (1280, 800), "B")
    [readout] = session.view.readouts
    assert readout.title == "Free body: particle B"
    assert dict(readout.rows) == {
        "rod AB": "x 20.07   y 20.01 kN",
        "rod BC": "x −140.1   y 140.0 kN",
        "force": "x 120.0   y −160.0 kN",
        "ΣFx": "20.1 − 140.1 + 120.0 = 0",
        "ΣFy": "20.0 + 140.0 − 160.0 = 0",
    }


def test_inertia_closes_the_sum_while_a_structure_moves() -> None:
    session = Session.open("isostatic")
    session.resize(1280, 800)
    session.run(steps=3)
    session.select(session.particles["B"])
    session.press("x")
    session.update_view()
    rows = dict(session.view.readouts[0].rows)
    assert "inertia −m a" in rows
    assert rows["ΣFx"].endswith("= 0")
    assert "inertia −m a (kN)" in picture_of(session).texts  # in the legend


@pytest.mark.parametrize("model", ["warren_bridge", "tower", "hanging_net", "pile"])
@pytest.mark.parametrize("size", [(640, 480), (1920, 1080)])
def test_it_can_be_drawn_of_any_model(model: str, size: tuple[int, int]) -> None:
    session = apart(model, size)
    assert picture_of(session).marks
    session.press("x")
    assert not session.view.free_bodies


@pytest.mark.parametrize("model", ["isostatic", "hyperstatic", "braced_portal", "warren_bridge", "tower"])
@pytest.mark.parametrize("size", [(640, 480), (1024, 640), (1280, 800), (1920, 1080)])
def test_no_value_of_a_rod_is_nearer_to_another(model: str, size: tuple[int, int]) -> None:
    session = apart(model, size)
    places = session.view.camera.to_pixels(drawn_positions(session.model))
    start, end = places[session.model.rods.between.astype(int).T]
    picture = picture_of(session)
    for mark in picture.marks:
        if isinstance(mark, Text) and mark.of is not None and mark.of[0] == "rods" and mark.text.endswith("kN"):
            line = leader(mark, picture)
            distance = distances(np.array([mark.x, mark.y]) if line is None else line[1], start, end)
            assert distance.argmin() == mark.of[1], mark


@pytest.mark.parametrize("model", ["isostatic", "hyperstatic", "portal", "two_storey_frame", "gerber_beam"])
def test_all_values_of_small_structures_are_told(model: str) -> None:
    session = apart(model, (1280, 800))
    assert not [text for text in picture_of(session).texts if "hidden" in text]


def distances(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """From a point to each of lines (m, 2)."""
    way = end - start
    share = np.clip(((point - start) * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
    return np.hypot(*(point - start - share[:, None] * way).T)


@pytest.mark.parametrize("size", [(640, 480), (1024, 640), (1280, 800)])
def test_the_scale_is_told_whole_beside_them(size: tuple[int, int]) -> None:
    texts = picture_of(apart("isostatic", size)).texts
    assert any(text.split("   ")[0].endswith(" cm") for text in texts)
    assert not any("…" in text or "-" in text for text in texts), texts


def test_nothing_far_from_the_window_is_drawn() -> None:
    """Of a frame with displacements drawn 1e9 times as large, a canvas without compiled code filled 20 GB."""
    session = apart("portal")
    session.settings.displacement_scale = 1e9
    session.update_view()
    for mark in picture_of(session).marks:
        if isinstance(mark, Strokes):
            assert not len(mark.start) or max(np.abs(mark.start).max(), np.abs(mark.end).max()) < 4000.0
