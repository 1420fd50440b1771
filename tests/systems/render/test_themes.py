"""Themes, and their colours to those who see few."""

import itertools

import numpy as np
import pytest

from pinjoint.systems.render.model.utilisation import LEVELS, shade
from pinjoint.systems.render.theme import load_theme, theme_names
from tests.systems.render.pictures import LIGHT


def test_themes_load_and_the_default_is_the_thesis() -> None:
    assert {"light", "dark", "colour-blind", "colour-blind-dark"} == set(theme_names())
    assert len({load_theme(name).title for name in theme_names()}) == 4
    assert LIGHT.background[:3] == (255, 255, 255)
    assert LIGHT.yielding[:3] == (255, 0, 255)


def test_an_unknown_theme_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="no theme 'pink'; choose one of"):
        load_theme("pink")


# Linear RGB as people without red, green or blue cones see it: Machado, Oliveira, Fernandes (2009), severity 1.
VISIONS = {
    "all cones": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
CURVES = ("curve_1", "curve_2", "curve_3", "curve_4")
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour: tuple[int, ...], vision: object) -> np.ndarray:
    """CIE L*a*b* (D65) of an sRGB colour as seen by a vision."""
    c = np.array(colour[:3]) / 255.0
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = XYZ @ np.clip(np.asarray(vision) @ linear, 0, 1) / [0.9505, 1.0, 1.089]
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("name", ["colour-blind", "colour-blind-dark"])
def test_colour_blind_themes_tell_meanings_apart(name: str, vision: str) -> None:
    """A difference of 25 in L*a*b* is ten times what is just noticeable."""
    theme = load_theme(name)
    colours = {
        key: getattr(theme, key) for key in ("tension", "compression", "yielding", "load", "reaction", "ink")
    }
    for (a, first), (b, second) in itertools.combinations(colours.items(), 2):
        assert np.linalg.norm(lab(first, VISIONS[vision]) - lab(second, VISIONS[vision])) > 25, (a, b)


@pytest.mark.parametrize("name", theme_names())
def test_red_and_blue_mean_forces_and_nothing_else(name: str) -> None:
    """Every other colour among elements, plots and messages keeps away from both; halos are neutral."""
    theme = load_theme(name)
    others = ("ink", "selected", "hover", "sketch", "load", "reaction", "problem", *CURVES)
    for meaning in ("tension", "compression"):
        for other in others:
            apart = np.linalg.norm(
                lab(getattr(theme, meaning), np.eye(3)) - lab(getattr(theme, other), np.eye(3))
            )
            assert apart > 30, (meaning, other)
    for halo in (theme.selected, theme.hover):
        assert np.hypot(*lab(halo, np.eye(3))[1:]) < 15, "a* and b* of grey are 0"


@pytest.mark.parametrize("name", theme_names())
def test_no_colour_of_utilisation_looks_like_a_reaction_or_a_load(name: str) -> None:
    theme = load_theme(name)
    for level in range(LEVELS):
        shown = shade(theme, level / (LEVELS - 1))
        for meaning in ("reaction", "load"):
            arrow = getattr(theme, meaning)
            assert np.linalg.norm(lab(shown, np.eye(3)) - lab(arrow, np.eye(3))) > 25, (level, meaning)
            if "colour-blind" in name:
                for vision in VISIONS.values():
                    assert np.linalg.norm(lab(shown, vision) - lab(arrow, vision)) > 18, (level, meaning)


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("name", ["colour-blind", "colour-blind-dark"])
def test_curves_are_told_apart(name: str, vision: str) -> None:
    colours = [lab(getattr(load_theme(name), curve), VISIONS[vision]) for curve in CURVES]
    assert all(np.linalg.norm(a - b) > 20 for a, b in itertools.combinations(colours, 2))


@pytest.mark.parametrize("name", theme_names())
def test_numbers_in_the_colours_of_their_arrows_can_be_read(name: str) -> None:
    """At least 4 to 1 against the background, for numbers in semibold beside their symbols."""
    theme = load_theme(name)
    for meaning in ("tension", "compression", "load", "reaction", "sketch"):
        lights = sorted(lab(getattr(theme, key), np.eye(3))[0] for key in (meaning, "background"))
        dark, light = (((lightness + 16.0) / 116.0) ** 3 for lightness in lights)
        assert (light + 0.05) / (dark + 0.05) > 4.0, meaning
