"""Marks of others are cut to what is seen: the picture is the same, and none is too much for a canvas."""

import time
from typing import Any

import numpy as np
import pygame
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinjoint.components.camera import Viewport
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from pinjoint.systems.render.framing import framed
from pinjoint.systems.render.marks import Bars, Discs, Fills, Mark, Panel, Picture, Stamps, Strokes, Text
from pinjoint.systems.render.symbols import SYMBOLS

INK, PALE = (20, 30, 40, 255), (200, 210, 220, 255)
VIEW = Viewport(0, 0, 120, 80)
CANVAS = Canvas()


def drawn(*marks: Mark) -> Any:
    surface = pygame.Surface((VIEW.width, VIEW.height), depth=32)
    CANVAS.draw(surface, Picture(VIEW, (255, 255, 255, 255), list(marks)))
    return pygame.surfarray.array3d(surface)


def at(*places: float) -> Any:
    return np.array(places, dtype=np.float64).reshape(-1, 2)


INSIDE: list[Mark] = [
    Strokes(at(9, 9, 20, 70), at(100, 50, 60, 9), 3.0, INK),
    Fills(at(10, 10, 60, 15, 30, 70)[None], INK),
    Bars(at(10, 10), at(100, 20), at(-2, 20), INK),
    Stamps("arrow", at(50, 40), 20.0, 1.0, INK, PALE, turns=3),
    Stamps("pinned", at(50, 40), 5.0, 1.0, INK, PALE, turns=1),
    Discs(at(30, 30, 80, 50), np.array([10.0, 20.0]), INK, PALE, 2.0),
    Panel(5, 5, 20, 30, 0.0, INK),
    Panel(10, 10, 80, 50, 6.0, PALE, INK),
    Text("hello", 60, 40, 14, INK, "semibold", "centre"),
]


@pytest.mark.parametrize("mark", INSIDE, ids=lambda mark: type(mark).__name__)
def test_what_lies_inside_is_drawn_as_it_is(mark: Mark) -> None:
    assert (drawn(*framed(mark, VIEW, 1.0)) == drawn(mark)).all()


@pytest.mark.parametrize(
    "mark",
    [
        Strokes(at(-500, 40), at(600, 40), 6.0, INK),
        Fills(at(-300, -300, 400, -300, 60, 400)[None], INK),
        Bars(at(-300, 30), at(300, 30), at(0, 20), INK),
        Panel(-500, 20, 1000, 30, 0.0, INK),
        Panel(-400, 10, 700, 500, 12.0, PALE, INK),
        Text("a long line of text that does not fit", -20, 40, 14, INK),
    ],
    ids=lambda mark: type(mark).__name__,
)
def test_what_sticks_out_looks_the_same(mark: Mark) -> None:
    assert (drawn(*framed(mark, VIEW, 1.0)) == drawn(mark)).mean() > 0.999


def test_very_large_discs_and_symbols_cover_what_they_should() -> None:
    for mark in (
        Discs(at(60, 1e6 + 40), np.array([1e6]), INK, INK),
        Stamps("disc", at(60, 1e6 + 40), 1e6, 1.0, INK, PALE),
    ):
        picture = drawn(*framed(mark, VIEW, 1.0))[..., 0]
        assert (picture[:, :36] == 255).all()
        assert (picture[:, 44:] == INK[0]).all()


OF = st.sampled_from([None, ("rods", np.array([3]))])
LENGTHS = st.floats(allow_nan=False, allow_infinity=False)
SIZES = st.floats(min_value=0.0, allow_nan=False, allow_infinity=False)
PLACES = st.lists(LENGTHS, min_size=2, max_size=2).map(lambda place: at(*place))
MARKS = st.one_of(
    st.builds(Strokes, PLACES, PLACES, SIZES, st.just(INK), OF),
    st.builds(lambda *corners: Fills(np.stack(corners, axis=1), INK), PLACES, PLACES, PLACES),
    st.builds(Bars, PLACES, PLACES, PLACES, st.just(INK), OF),
    st.builds(
        Stamps,
        st.sampled_from([*SYMBOLS, "rod"]),
        PLACES,
        SIZES,
        SIZES,
        st.just(INK),
        st.just(PALE),
        st.integers(),
        OF,
    ),
    st.builds(lambda p, r, rim: Discs(p, np.array([r]), INK, PALE, rim), PLACES, SIZES, SIZES),
    st.builds(Panel, LENGTHS, LENGTHS, SIZES, SIZES, SIZES, st.just(INK), st.none(), st.just(("rods", 3))),
    st.builds(
        Text,
        st.text(),
        LENGTHS,
        LENGTHS,
        st.integers(0, 10**9),
        st.just(INK),
        weight=st.just("semibold"),
        anchor=st.sampled_from(["left", "right"]),
        of=st.just(("rods", 3)),
    ),
)


@given(st.lists(MARKS, max_size=4))
def test_whatever_is_finite_can_be_drawn(marks: list[Mark]) -> None:
    with np.errstate(all="raise", under="ignore"):
        parts = [part for mark in marks for part in framed(mark, VIEW, 1.0)]
    assert drawn(*parts).shape == (120, 80, 3)


def test_polygons_that_are_not_seen_cost_little() -> None:
    """A million of them: cut one by one they would take a minute."""
    began = time.process_time()
    assert not list(framed(Fills(np.full((10**6, 4, 2), 1e6), INK), VIEW, 1.0))
    assert time.process_time() - began < 5.0


def test_what_is_cut_still_says_whose_it_is() -> None:
    rows = np.array([4, 7, 9])
    far = at(50, 40, 9000, 40, 60, 30)
    marks = [
        Strokes(far, far + 5.0, 1.0, INK, ("rods", rows)),
        Fills(far[:, None] + at(0, 0, 5, 0, 0, 5), INK, ("rods", rows)),
        Fills(at(50, 40, 55, 40, 50, 45)[None] + at(0, 0, 9000, 0, 70, 0)[:, None], INK, ("rods", rows)),
        Stamps("disc", far, 5.0, 1.0, INK, INK, of=("rods", rows)),
        Discs(far, np.array([5.0, 5.0, 900.0]), INK, INK, of=("rods", rows)),
    ]
    for mark in marks:
        parts = list(framed(mark, VIEW, 1.0))
        assert np.concatenate([part.of[1] for part in parts]).tolist() == [4, 9]
    with pytest.raises(ValueError, match="different numbers of rows"):
        list(framed(Strokes(far, far, 1.0, INK, ("rods", rows[:2])), VIEW, 1.0))
