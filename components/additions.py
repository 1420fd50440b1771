"""What mods add to models: facts about elements, by a Component, and elements of kinds of their own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.components.table import Table


class Component:
    """Facts that a mod adds to elements of one kind; a subclass declares them as Fields.

    Every element of the kind has them, at their defaults to begin with. In Python and in kernels they go by
    `<mod>_<field>`: `particle.wind_area`, `particles_wind_area`. Files keep them at the element, under
    "components": {"<mod>.<Component>": {…}}.

    of: the kind of element, such as Particle, Rod, Environment or Settings.
    """

    of: ClassVar[type[Handle]]


def outlines(model: Model) -> Iterator[tuple[Table[Any], NDArray[np.float64]]]:
    """The tables of mods' kinds that have points and elements, with those points (m), shape (n, points, 2)."""
    for kind in EXTENSIONS.kinds.values():
        table = model.tables.get(kind.table)
        if table is not None and table.count and kind.points:
            yield table, np.stack([table.column(point) for point in kind.points], axis=1)
