"""Theme: the named colours of a picture, read from assets/themes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from pinjoint.components.mistake import WrongValue

Colour = tuple[int, int, int, int]  # red, green, blue, opacity, each 0 to 255


@dataclass(frozen=True)
class Theme:
    """What each colour of a picture means.

    title: what a person calls the theme.
    background, panel, line: behind the model; behind bars and boxes; hairlines around those.
    text, muted: what is said; what is said in passing.
    ink, hollow: rods, rims and supports; the inside of particles and supports.
    ghost, grid: the undeformed structure; lines to draw along.
    selected, hover: halos of what a person selected, and of what a click would hit; neutral, so that they hide no force.
    sketch: what is about to be drawn; mechanisms and modes; the deflected shape beside the undeformed.
    tension, compression, zero, yielding: rods by their axial force.
    load, reaction: what acts on particles, and what their supports answer.
    scale_low, scale_middle, scale_high: the share of a strength that a rod bears: 0, 50 and 100 %.
    curve_1, …: curves of plots, in their order.
    problem, problem_panel: why something stopped, and what it is written on.
    running, resting, halted: the state's dot in the status bar.
    focus: the box that is typed into, the tile that Return opens, and buttons that are pressed; not used among elements.
    """

    title: str
    background: Colour
    panel: Colour
    line: Colour
    text: Colour
    muted: Colour
    ink: Colour
    hollow: Colour
    ghost: Colour
    grid: Colour
    selected: Colour
    hover: Colour
    sketch: Colour
    tension: Colour
    compression: Colour
    zero: Colour
    yielding: Colour
    load: Colour
    reaction: Colour
    scale_low: Colour
    scale_middle: Colour
    scale_high: Colour
    curve_1: Colour
    curve_2: Colour
    curve_3: Colour
    curve_4: Colour
    problem: Colour
    problem_panel: Colour
    running: Colour
    resting: Colour
    halted: Colour
    focus: Colour


def theme_names() -> list[str]:
    """Names of the themes that come with the program, in alphabetical order."""
    folder = files("pinjoint.assets") / "themes"
    return sorted(
        entry.name.removesuffix(".json") for entry in folder.iterdir() if entry.name.endswith(".json")
    )


@cache
def load_theme(name: str = "light") -> Theme:
    """The theme of that name. Raises ValueError if there is none."""
    if name not in theme_names():
        known = ", ".join(theme_names())
        raise WrongValue("There is no theme '{name}'; choose one of {known}.", name=name, known=known)
    text = (files("pinjoint.assets") / "themes" / f"{name}.json").read_text(encoding="utf-8")
    entries = json.loads(text)
    return Theme(entries.pop("title"), **{name: _colour(code) for name, code in entries.items()})


def _colour(code: str) -> Colour:
    """A colour from "#RRGGBB"."""
    red, green, blue = bytes.fromhex(code.removeprefix("#"))
    return red, green, blue, 255


def pale(colour: Colour, background: Colour) -> Colour:
    """The colour half way to that of the background."""
    red, green, blue = (
        round(0.45 * own + 0.55 * behind) for own, behind in zip(colour[:3], background[:3], strict=True)
    )
    return red, green, blue, colour[3]


@cache
def faded(colour: Colour, opacity: float) -> Colour:
    """The colour at that opacity, 0 to 1."""
    return (*colour[:3], round(255 * opacity))
