"""Envelopes of a document: N, V, M and reactions in all its combinations, each solved by itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pinjoint.components.bent import inner_forces
from pinjoint.components.envelope import Envelope
from pinjoint.components.field import Column, Role
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.spans import Curves, extremes
from pinjoint.documents.statics import Statics

_STATIONS = np.linspace(0.0, 1.0, 21)  # of each rod, beside its kinks and extremes


class NoEnvelope(Mistake, ValueError):
    """There are no combinations, or none has an equilibrium; the message says so."""


class Envelopes:
    """The envelope of a model, found anew when it is asked for after an edit.

    permanent: plastic strain and rotations of its undeformed beginning, (rods, 3).
    """

    def __init__(self, model: Model, permanent: Callable[[], Column]) -> None:
        self._model, self._permanent = model, permanent
        self._found: tuple[int, Envelope | None] = -1, None

    @property
    def envelope(self) -> Envelope:
        """Up to date. Raises NoEnvelope."""
        model = self._model
        revision = model.newest(Role.DOCUMENT)
        if self._found[0] != revision:
            with model.own_state():
                self._found = revision, self._solved()
        found = self._found[1]
        if found is None:
            raise NoEnvelope(
                "There is no envelope: no combination of load cases has an equilibrium. Boxes of the environment hold them."
            )
        return found

    def _solved(self) -> Envelope | None:
        curves: list[dict[str, Curves]] = []
        reactions, names, unsolved = list[Column](), list[str](), list[str]()
        for name in self._model.settings.combinations:
            copy = self._model.undeformed_copy()
            copy.settings.combination = name
            statics = Statics(copy, self._permanent)
            if not statics.balanced:
                unsolved.append(name)
                continue
            copy.show(statics)
            every, particles = np.arange(copy.rods.count), copy.particles
            curves.append({quantity: inner_forces(copy, every, quantity) for quantity in DIAGRAMS})
            reactions.append(np.column_stack([particles.reaction, particles.reaction_moment]))
            names.append(name)
        if not names:
            return None
        of_all = [of for some in curves for of in some.values()]
        at = [extremes(of.stretches)[1] for of in of_all] + [of.with_kinks(_STATIONS) for of in of_all]
        shares = np.sort(np.concatenate(at, axis=1), axis=1)
        values = {quantity: np.array([some[quantity].at(shares) for some in curves]) for quantity in DIAGRAMS}
        return Envelope(tuple(names), shares, values, np.array(reactions), tuple(unsolved))
