"""Sliders: their ranges, and where they are."""

import itertools

import pytest

from pinjoint.components.camera import Viewport
from pinjoint.components.slider import Control, Slider, SliderStack

LINEAR = Slider((), 0.0, -200.0)
DECADES = Slider((), 1e3, 1e6, logarithmic=True)


@pytest.mark.parametrize("slider", [LINEAR, DECADES, Slider((), -0.3, 0.7)])
def test_a_place_means_a_value_that_lies_there(slider: Slider) -> None:
    for n in range(101):
        value = slider.value_at(n / 100)
        assert slider.share_of(value) == pytest.approx(n / 100, abs=0.011)
    assert (slider.value_at(0.0), slider.value_at(1.0)) == (slider.first, slider.last)
    assert (slider.value_at(-1.0), slider.value_at(2.0)) == (slider.first, slider.last)


def test_values_are_round() -> None:
    assert LINEAR.value_at(0.3337) == -66.0
    assert Slider((), 0.0, 0.3).value_at(0.51) == 0.152
    assert DECADES.value_at(0.5) == 32000.0


def test_values_beyond_the_ends_lie_at_the_ends() -> None:
    assert LINEAR.share_of(10.0) == 0.0
    assert LINEAR.share_of(-1e9) == 1.0
    assert DECADES.share_of(0.0) == 0.0
    assert DECADES.share_of(-5.0) == 0.0


@pytest.mark.parametrize("unit", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("size", [(600, 452), (930, 700), (300, 200), (120, 100)])
def test_sliders_stand_inside_the_canvas_and_not_over_each_other(size: tuple[int, int], unit: float) -> None:
    canvas = Viewport(38, 0, round(size[0] * unit), round(size[1] * unit))
    stack = SliderStack(tuple(Control(n, "", "", 0.5, "×") for n in range(12)), 28.0)
    places = stack.places(canvas, unit)
    for place in places:
        assert canvas.left <= place.left
        assert place.right <= canvas.right
        assert canvas.top <= place.top
        assert place.bottom <= canvas.bottom - 28.0 * unit
        left, right, middle = place.track
        assert place.left < left < right <= place.button.left + 1e-9
        assert place.top < middle < place.bottom
        assert place.share_at(left) == 0.0
        assert place.share_at(right + 9.0) == 1.0
        assert [other for other in places if other.contains((left, middle))] == [place]
    tops = [place.top for place in places]
    assert all(a - b >= places[0].height for a, b in itertools.pairwise(tops))
    assert len(places) == {600: 5, 930: 9, 300: 2, 120: 0}[size[0]]
