"""Sliders: numbers that a person moves on the canvas; what each moves, and where it is: the same for drawing and hitting."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from pinjoint.components.camera import LEAST_MARGIN, Rectangle, Viewport
from pinjoint.components.field import Role
from pinjoint.components.handle import Handle
from pinjoint.components.round_numbers import round_down
from pinjoint.components.toolbar import Tool

WIDTH, HEIGHT, GAP, EDGE = 226.0, 36.0, 4.0, 8.0  # points, of a slider, between and around them
CHOICES = 32.0  # points, of a row of choices above them
PAD, BUTTON = 10.0, 30.0  # points: beside the track, and the width of the button at its right
SUPPORT, ARROW, NARROW = 30.0, 44.0, 620.0  # points about a particle; and the width of a narrow canvas
SHARE = 0.6  # of the height of a canvas that sliders take at most
STEPS = 100.0  # from end to end; on a logarithmic one numbers have DIGITS
DIGITS = 2


@dataclass(frozen=True)
class Aim:
    """One number that a slider moves: a Field, or its component along an axis ("x", "y", or "" for the whole).

    element: that has it; None: every element of the table.
    """

    table: str
    element: Handle | None
    field: str
    axis: str = ""

    def handles(self, tables: Any) -> list[Handle]:
        """The elements that exist, of the tables of a model."""
        if self.element is None:
            return list(tables[self.table])
        return [self.element] if self.element.exists else []


@dataclass(frozen=True)
class Slider:
    """Gives all its aims one value, from `first` at its left to `last` at its right end, as units of files are.

    title: what it is called; "": after its first aim. logarithmic: equal ways are equal ratios.
    """

    aims: tuple[Aim, ...]
    first: float
    last: float
    logarithmic: bool = False
    title: str = ""

    def share_of(self, value: float) -> float:
        """Where a value lies, from 0 at the left end to 1 at the right."""
        if self.logarithmic:
            value = math.log(max(value / self.first, 1e-300)) / math.log(self.last / self.first)
        else:
            value = (value - self.first) / (self.last - self.first)
        return min(max(value, 0.0), 1.0)

    def value_at(self, share: float) -> float:
        """The round number nearest to a place; at the ends theirs."""
        share = min(max(share, 0.0), 1.0)
        if share in (0.0, 1.0):
            return self.last if share else self.first
        if self.logarithmic:
            return float(f"{self.first * (self.last / self.first) ** share:.{DIGITS - 1}e}")
        step = round_down(abs(self.last - self.first) / STEPS)
        return float(f"{round((self.first + share * (self.last - self.first)) / step) * step:.12g}")


@dataclass(frozen=True)
class SetSliders:
    """The command that gives a model other sliders."""

    sliders: tuple[Slider, ...]
    concerns_runs: ClassVar[bool] = False

    def apply(self, world: Any) -> SetSliders:
        """Make the change; returns the inverse."""
        before = SetSliders(world.sliders)
        world.sliders = self.sliders
        world.next_revision(Role.LOOK)
        return before


# --- on the canvas -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Control:
    """What one slider shows.

    key: which one it is, of those of the model; -1: that of the displacement scale. title, value: as texts. share: where
    its knob is; None: its value is no number. button: what its button says. pressed: what the button does is done.
    """

    key: int
    title: str
    value: str
    share: float | None
    button: str
    pressed: bool = False


@dataclass(frozen=True)
class Place(Rectangle):
    """A control and the rectangle of its panel in pixels. unit: pixels per point."""

    control: Control
    unit: float

    @property
    def track(self) -> tuple[float, float, float]:
        """Left end, right end and height of the line on which the knob goes."""
        u = self.unit
        return self.left + PAD * u, self.right - (PAD + BUTTON) * u, self.top + 0.7 * self.height

    @property
    def button(self) -> Rectangle:
        """The button at the right."""
        width = BUTTON * self.unit
        return Rectangle(self.right - width, self.top, width, self.height)

    def share_at(self, x: float) -> float:
        """The share that a pixel's x means."""
        left, right, _ = self.track
        return min(max((x - left) / (right - left), 0.0), 1.0)


@dataclass(frozen=True)
class SliderStack:
    """Controls above each other at the lower left of a canvas, the first at the bottom, `above` points up.

    Those for which there is no room are left out. choices: buttons in a row above them, of which one is pressed.
    """

    controls: tuple[Control, ...] = ()
    above: float = 0.0
    choices: tuple[Tool, ...] = ()

    def reserve(self, canvas: Viewport, unit: float, margin: float, *, arrows: bool) -> int:
        """Pixels of the height to be left free of a model, below which there is a margin (points) anyway.

        Supports stand in the margin above the sliders, and if need be arrows; where a canvas is narrow, always.
        """
        if not self.controls:
            return 0
        first = self.above + EDGE + HEIGHT + SUPPORT
        first += ARROW if arrows or canvas.width < NARROW * unit else 0.0
        least = min(margin, LEAST_MARGIN * canvas.height / unit)
        missing = max(first - least, 0.0) + (len(self.controls) - 1) * (HEIGHT + GAP)
        missing += bool(self.choices) * CHOICES
        kept = 1.0 - LEAST_MARGIN if arrows and least < margin else 1.0  # the margin shrinks with the room
        return round(missing / kept * unit)

    def places(self, canvas: Viewport, unit: float) -> list[Place]:
        """Where the controls are in a canvas with `unit` pixels per point."""
        width = min(WIDTH * unit, canvas.width - 2 * EDGE * unit)
        if width < 0.6 * WIDTH * unit:
            return []
        row, bottom = (HEIGHT + GAP) * unit, canvas.bottom - (self.above + EDGE) * unit
        most = max(int((SHARE * canvas.height - (self.above + EDGE) * unit) / row), 0)
        left, tops = canvas.left + EDGE * unit, (bottom - (n + 1) * row + GAP * unit for n in range(most))
        return [
            Place(left, top, width, HEIGHT * unit, control, unit)
            for top, control in zip(tops, self.controls, strict=False)
        ]
