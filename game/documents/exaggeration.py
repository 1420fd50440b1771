"""Exaggeration: the automatic factor by which displacements are drawn larger, so that a person sees them."""

from __future__ import annotations

import math

import numpy as np

from pinjoint.components.bent import largest_sag
from pinjoint.components.field import Role
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.obstacles import obstacles
from pinjoint.components.round_numbers import round_down
from pinjoint.documents.assessment import LARGEST
from pinjoint.systems.edit.arrows import extent
from pinjoint.systems.physics.pace import expected_response, loaded_mode
from pinjoint.systems.statics.counting import Count

DRAWN = 0.08  # of the structure's size: the largest displacement as drawn, at most, when a factor is chosen
KEPT = (0.02, 0.25)  # of the size, drawn, within which a factor stays as it is
_TRUE = 1.0  # the factor of motions that are seen without one
LEAST = 1e-7  # of the size: smaller displacements are rounding


class Exaggeration:
    """Chooses the automatic factor of one model, in round steps, and keeps it while it shows enough and not too much.

    It follows from those of a static solution, where that is shown; else from the displacements that theory expects and,
    while time stands still, from those that there are: never from a frame of a run, so that a picture does not jump with
    what vibrates, and a recording is replayed in the same.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self._seen: tuple[int, ...] = ()

    def review(self, *, still: bool) -> bool:
        """Choose anew if the model was edited, or moved and stands `still` now; True if the drawn factor changed."""
        model = self._model
        solved = -1 if model.solution is None else model.solution.revision
        seen = model.newest(Role.DOCUMENT, Role.LOOK), model.newest(Role.STATE) if still else -1, solved
        if model.settings.prescribed_displacement_scale is not None or seen == self._seen:
            return False
        self._seen = seen
        before, found = model.settings.automatic_displacement_scale, self._chosen(still)
        if found != before:
            model.writable("settings.automatic_displacement_scale")[0] = found
        return found != before

    def _chosen(self, still: bool) -> float:
        """The factor that suits the model, the present one if it does."""
        model, present = self._model, float(self._model.settings.automatic_displacement_scale)
        size = extent(model) if model.particles.count else 0.0
        if not 0.0 < size < math.inf or incomputable(model):
            return _TRUE
        if model.solution is None and _moves_far(model):
            return _TRUE
        expected = 0.0 if model.solution is not None else _largest_expected(model)
        largest = max(expected, _amplitude(model) if still else 0.0)
        if not math.isfinite(largest):
            return _TRUE
        if largest < LEAST * size:
            return present
        if KEPT[0] <= present * largest / size <= KEPT[1]:
            return present
        most = DRAWN * size / largest
        return round_down(most) if most >= 5.0 else _TRUE  # what would need less is seen without one


def _largest_expected(model: Model) -> float:
    """The largest displacement that theory expects (m), infinite if not a small one; 0 of a large structure."""
    if model.rods.count > LARGEST:
        return 0.0
    found = expected_response(model)
    if found is None:
        return math.inf
    rods, (displacement, force) = model.rods, found
    yields = model.settings.plasticity & ((force > rods.tension_limit) | (force < -rods.compression_limit))
    if Count.of(model).degree <= 0 and (yields | rods.tension_only & (force < 0.0)).any():
        return math.inf  # it collapses
    return float(np.abs(displacement).max(initial=0.0))


def _moves_far(model: Model) -> bool:
    """True if anything moves freely: a mechanism by its count of rods, a loose particle, one that meets an obstacle."""
    particles, rods = model.particles, model.rods
    free = particles.mobility > 0.0
    if not rods.count or Count.of(model).degree < 0 or (model.settings.collisions and len(obstacles(model))):
        return True
    jointed = np.zeros(particles.count, dtype=bool)
    jointed[rods.between.ravel()] = True
    return bool((free.any(axis=1) & ~jointed).any())


def _amplitude(model: Model) -> float:
    """The largest displacement that there is, or that a vibration as fast as the present one leads to (m)."""
    particles = model.particles
    displacement, velocity = particles.displacement, particles.velocity
    if velocity.any() and model.rods.count <= LARGEST:
        mode = loaded_mode(model)
        if mode is not None:
            displacement = np.hypot(displacement, velocity / mode[0])
    return max(float(np.abs(displacement).max(initial=0.0)), largest_sag(model))
