"""Layers: what mods draw with every picture of a model."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from systems.render.marks import Mark
from systems.render.sheet import Sheet

Layer = Callable[[Sheet], Iterable[Mark]]

BELOW: list[Layer] = []  # below the elements of a model, in small pictures of it, too
ABOVE: list[Layer] = []  # above them
