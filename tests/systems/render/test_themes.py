"""Themes, and their colours to those who see few."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from systems.render.theme import load_theme, theme_from, theme_names
from tests.systems.render.pictures import (
    LIGHT,
)


def test_themes_load_and_the_default_is_the_thesis() -> None:
    assert {"light", "dark", "colour-blind", "colour-blind-dark"} == set(theme_names())
    assert len({load_theme(name).title for name in theme_names()}) == 4
    assert LIGHT.background[:3] == (255, 255, 255)
    assert LIGHT.yielding[:3] == (255, 0, 255)
    assert LIGHT.force[:3] == (0, 100, 255)


def test_wrong_themes_are_refused_by_name() -> None:
    entries = {"title": "T"} | dict.fromkeys(LIGHT.__dataclass_fields__, "#102030") | {"title": "T"}
    assert theme_from(entries, "theme t").force == (16, 32, 48, 255)
    with pytest.raises(ValueError, match="no theme 'pink'; choose one of"):
        load_theme("pink")
    with pytest.raises(ValueError, match="theme t lacks the colour 'force'"):
        theme_from({k: v for k, v in entries.items() if k != "force"}, "theme t")
    with pytest.raises(ValueError, match="theme t has an unknown colour 'glow'"):
        theme_from(entries | {"glow": "#000000"}, "theme t")
    with pytest.raises(ValueError, match="theme t, force: 'blue' is no colour"):
        theme_from(entries | {"force": "blue"}, "theme t")


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
        key: getattr(theme, key) for key in ("tension", "compression", "yielding", "selected", "force", "ink")
    }
    for (a, first), (b, second) in itertools.combinations(colours.items(), 2):
        assert np.linalg.norm(lab(first, VISIONS[vision]) - lab(second, VISIONS[vision])) > 25, (a, b)
