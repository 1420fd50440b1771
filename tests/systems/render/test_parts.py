"""Clipping, wrapping and type."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.labels.placing import half_size
from pinjoint.systems.render.typography import shortened, text_width, wrapped

coordinate = st.floats(-50, 50)


@given(coordinate, coordinate, coordinate, coordinate)
def test_clipping_keeps_exactly_what_lies_inside(ax: float, ay: float, bx: float, by: float) -> None:
    start, end = np.array([[ax, ay]]), np.array([[bx, by]])
    low, high = np.array([-10.0, -20.0]), np.array([30.0, 15.0])
    t = np.linspace(0.0, 1.0, 501)[:, None]
    samples = start + t * (end - start)
    inside = ((samples > low + 1e-9) & (samples < high - 1e-9)).all(axis=1)
    kept_start, kept_end, rows = clip_segments(start, end, low, high)
    if len(rows) == 0:
        assert not inside.any()
        return
    for point in (kept_start, kept_end):
        assert (point >= low - 1e-6).all()
        assert (point <= high + 1e-6).all()
    step = (end - start)[0]
    along = samples @ step
    between = (along >= kept_start @ step - 1e-6) & (along <= kept_end @ step + 1e-6)
    assert (between | ~inside).all()


@given(st.text("abc de,fgh", max_size=80), st.integers(30, 400))
def test_wrapping_keeps_the_words_and_the_width(text: str, width: int) -> None:
    lines = wrapped(text, width, 13)
    assert all(text_width(line, 13) <= width for line in lines)
    if all(text_width(word, 13) <= width for word in text.split()):
        assert " ".join(lines).split() == text.split()


def test_shortening() -> None:
    assert shortened("Esc pauses", 500, 12) == "Esc pauses"
    assert shortened("Esc pauses", 50, 12).endswith("…")
    assert text_width(shortened("Esc pauses", 50, 12), 12) <= 50
    assert shortened("Esc", 1, 12) == ""


def test_figures_have_one_width() -> None:
    for weight in ("regular", "semibold"):
        assert len({text_width(figure, 12, weight) for figure in "0123456789"}) == 1
    assert half_size("−1", 12, "regular", 1.0)[0] > half_size("1", 12, "regular", 1.0)[0]
