"""Shapes: mechanisms, buckling modes and natural modes of a structure, to be drawn over the model."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.bent import Parts
from pinjoint.components.field import Role
from pinjoint.components.language import marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.rod import can_collapse
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.view import Shape
from pinjoint.components.wording import cut
from pinjoint.documents.assessment import LARGEST
from pinjoint.systems.edit.arrows import extent

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.statics.limit_analysis import LimitLoad
    from pinjoint.systems.statics.settle import Settlement
    from pinjoint.systems.statics.state import Start

DRAWN_SHARE = 0.12  # of the structure's size that the largest displacement is drawn as
LOWEST = 10  # mechanisms, and modes, in the round of `next`
_LOWEST_BUCKLING = 3  # buckling modes in it
REST = 0.2  # s without an edit, after which a window compares theories and looks for buckling
PERIOD = 2.4  # s, in which a shape swings to and fro
NEAR_BUCKLING = 0.8  # of the compression at which a rod buckles with others, above which it pulses
_MOST_PULSING = 120  # rods, of which critical loads take a moment only
_LOWEST_OF_LARGE = 50  # modes of structures that are too large for all


class NoShape(Mistake, LookupError):
    """The shape that was asked for does not exist; the message says which do."""


class Shapes:
    """The shape that is shown over a model, if any, until the model changes in what the shape depends on."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._round: list[Shape] = []  # the shapes that `next` goes through
        self._shown: Shape | None = None
        self._revision: tuple[int, object, str] = (-1, None, "")
        self._time = 0.0
        # The newest edit, how long the hand has rested since, and of which edit the compressions are at which rods buckle.
        self._rest: tuple[int, float] = (-1, 0.0)
        self._critical: tuple[int, NDArray[np.float64]] = (-1, np.zeros(0))

    @property
    def shown(self) -> Shape | None:
        """The shape that is drawn now, if any."""
        if self._shown is not None and self._newest(self._shown) != self._revision:
            self._shown = None
        return self._shown

    def _newest(self, shape: Shape) -> tuple[int, object, str]:
        """What matters to a shape: the newest edit, change of the state if it is about an equilibrium, and the theory."""
        newest = self._model.newest(Role.DOCUMENT, *(() if shape.about is None else (Role.STATE,)))
        return newest, self._model.solution, self._model.settings.theory if self._model.solution else ""

    def show(self, shape: Shape) -> None:
        """Draw a shape until the model is edited, or leaves the equilibrium that the shape is about."""
        self._shown, self._revision, self._time = shape, self._newest(shape), 0.0

    def hide(self) -> None:
        """Draw none any more."""
        self._shown = None

    def swing(self, elapsed: float) -> float:
        """The share of the shape, from 1 to −1, that is drawn so many seconds after the last picture; 1 in the first."""
        self._time += elapsed * (self._shown is None or self._shown.swings)
        return math.cos(2.0 * math.pi * self._time / PERIOD)

    def near_buckling(self, elapsed: float) -> tuple[int, ...]:
        """Rows of the rods whose compression is nearly that at which they buckle, once the hand has rested after an edit."""
        model, newest, rods = self._model, self._model.newest(Role.DOCUMENT), self._model.rods
        if not 0 < rods.count <= _MOST_PULSING or not rods.bending_stiffness.any():
            return ()
        if self._critical[0] != newest:
            self._rest = newest, elapsed + (self._rest[1] if self._rest[0] == newest else 0.0)
            if self._rest[1] > REST:  # before a run begins, whose first frame it would hold up
                self._critical = newest, _critical_compression(model)
        if len(self._critical[1]) != rods.count:
            return ()
        pressed = -rods.axial_force > NEAR_BUCKLING * self._critical[1]
        return tuple(np.flatnonzero(pressed).tolist())

    def next(self) -> None:
        """Go on to the next: mechanisms, in statics collapse, buckling by its load, modes by their frequency, elsewhere
        collapse, then none. Raises NoShape.
        """
        self.go_through(lambda: _first_ones(self._model), begins=self.shown is None)

    def go_through(self, find: Callable[[], list[Shape]], *, begins: bool) -> None:
        """Go on to the next of some shapes, found where they begin; after the last, to none. Raises NoShape."""
        if begins:
            self._round = find()
            self.show(self._round[0])
            return
        after = self._round.index(self._shown) + 1 if self._shown in self._round else len(self._round)
        if after < len(self._round):
            self.show(self._round[after])
        else:
            self.hide()


def _critical_compression(model: Model) -> NDArray[np.float64]:
    """The compression (kN) at which each rod buckles, by itself or with the others of a mode, (rods,); else infinite."""
    from pinjoint.systems.statics.buckling import Buckling, members
    from pinjoint.systems.statics.events import NoEquilibrium

    found: NDArray[np.float64] = model.rods.buckling_load.copy()
    with suppress(NoEquilibrium, ValueError), model.own_state():
        buckling, member = Buckling.of(model), members(model)
        for number, (factor, leading) in enumerate(zip(buckling.factors, buckling.leading, strict=True)):
            taking = np.isfinite(buckling.effective_length) if number == 0 else member == member[leading]
            compression = -(buckling.dead + factor * buckling.live)
            found = np.where(taking & (compression > 0.0), np.minimum(found, compression), found)
    return found


def _first_ones(model: Model) -> list[Shape]:
    if model.rods.count > LARGEST:
        raise NoShape(
            "This takes long for more than {count} rods; use the command: pinjoint render --mode 1",
            count=LARGEST,
        )
    _check_range(model)
    found = mechanism_shapes(model, LOWEST)
    collapse, solved = collapse_shapes(model), model.solution is not None
    found += collapse * solved
    with suppress(NoShape):
        found += buckling_shapes(model, _LOWEST_BUCKLING, elastic=True)
    found += mode_shapes(model, LOWEST) + collapse * (not solved)
    if not found:
        raise NoShape("There are no mechanisms and no modes, because no rod has an end that is free to move.")
    return found


def _check_range(model: Model) -> None:
    if problem := incomputable(model):
        raise NoShape(problem)


def mechanism_shapes(model: Model, most: int | None = None) -> list[Shape]:
    """Motions that elongate no rod; at most 20 of large structures, or `most`."""
    from pinjoint.systems.statics.explain import describe_motion
    from pinjoint.systems.statics.theory import Indeterminacy, mechanisms

    motions, count = mechanisms(model), Indeterminacy.of(model).mechanisms
    shapes = []
    for number, motion in enumerate(motions[:most], start=1):
        moving = describe_motion(model, motion[None])
        title = tr("Mechanism {number} of {count}: moves {moving}", number=number, count=count, moving=moving)
        shapes.append(_shape(model, title, motion))
    return shapes


def buckling_shapes(model: Model, most: int = LOWEST, *, elastic: bool = False) -> list[Shape]:
    """The modes in which the structure gives way under its load, with their factors, and the effective length of the
    rod whose compression leads each. Raises NoShape, saying why there is none.

    About the present state, if that is an exact equilibrium under load; else by linear buckling.
    elastic: without those of factors at which what is compressed were strained beyond all that is elastic.
    """
    from pinjoint.systems.statics.buckling import STRAINED, Buckling
    from pinjoint.systems.statics.events import NoEquilibrium

    about = _equilibrium(model)
    try:
        found = Buckling.of(model, most, about)
    except NoEquilibrium as reason:
        raise NoShape(str(reason)) from None
    if found.message:
        raise NoShape(found.message)
    shapes = []
    for number, (factor, motion) in enumerate(zip(found.factors, found.modes, strict=True), start=1):
        if elastic and (-(found.dead + factor * found.live) / model.rods.stiffness).max() > STRAINED:
            continue
        row, length = int(found.leading[number - 1]), float(found.leading_length[number - 1])
        told = {
            "number": number,
            "factor": written.number(factor),
            "length": written.displacement(length),
            "rod": cut(str(model.rods.column("name")[row])),
        }
        title = marked("Buckling mode {number}: load × {factor}")
        if found.coarse:
            title = marked("Buckling mode {number}: load × {factor} at most; divide the members")
        elif math.isfinite(length):
            title = marked("Buckling mode {number}: load × {factor}; effective length {length} ({rod})")
        place, note = (about.displacement, found.notes[0]) if about is not None else (None, "")
        shapes.append(_shape(model, tr(title, **told), motion, place, note))
    return shapes


def _equilibrium(model: Model) -> Start | None:
    """The present state, if that is an exact equilibrium under load, about which a structure vibrates or gives way."""
    from pinjoint.systems.statics.state import Start
    from pinjoint.systems.statics.vibration import rests_under_load

    return Start.present(model) if not model.first_order and rests_under_load(model) else None


def mode_shapes(model: Model, most: int | None = None) -> list[Shape]:
    """Natural modes by frequency, the lowest 50 of a large structure, or `most`.

    About the present state, if that is an equilibrium under load, whose forces stiffen or soften the structure;
    else, and in first-order theory, of the unloaded structure, less its mechanisms.
    """
    from pinjoint.systems.statics.theory import FULL, Indeterminacy
    from pinjoint.systems.statics.vibration import Vibrations

    if model.rods.count == 0:
        return []
    degrees = Indeterminacy.of(model)
    about = _equilibrium(model)
    if most is None and degrees.mechanisms + degrees.rank > FULL:
        most = _LOWEST_OF_LARGE
    found = Vibrations.of(model, about, count=None if most is None else degrees.mechanisms + most)
    still = degrees.mechanisms if about is None else int((found.angular_squared <= 0.0).sum())
    modes = list(zip(found.hertz[still:].tolist(), found.modes[still:], strict=True))
    title, places = marked("Mode {number} of {count}: {hertz} Hz"), None
    if about is not None:
        title, places = marked("Mode {number} of {count} under load: {hertz} Hz"), found.place[:, :2]
    divided, structure = len(found.place) > model.particles.count, found.structure
    parts = None
    if divided and structure.bending is not None:
        parts = Parts(structure.position, structure.ends, structure.bending.fixity)
    shapes, count = [], found.total - still
    for number, (hertz, motion) in enumerate(modes[:most], start=1):
        said = tr(title, number=number, count=count, hertz=written.number(hertz))
        shapes.append(_shape(model, said, motion, places, found.note, parts))
    return shapes


def collapse_shapes(model: Model, found: LimitLoad | None = None) -> list[Shape]:
    """The mechanism of limit analysis with its load factor, if there is one; found: the answer, where it is known."""
    from pinjoint.systems.statics.limit_analysis import COLLAPSE, LimitLoad

    if found is None and can_collapse(model):
        found = LimitLoad.of(model)
    if found is None or found.status != COLLAPSE:
        return []
    parts, motion = found.mechanism(model)
    title = tr("Collapse by limit analysis: load × {factor}", factor=written.number(found.factor))
    return [_shape(model, title, motion, None, found.divides(model), parts)]


def last_motion(model: Model, settlement: Settlement) -> Shape | None:
    """The motion into which the last state passes that statics finds; None where that is an equilibrium.

    Ends that yield turn as hinges do. In first order nothing bends in it: rods stay straight between hinges.
    """
    motions = [event.motion for event in settlement.events if event.motion is not None]
    if settlement.final.balanced or not motions:
        return None
    said = tr("A mechanism: nothing resists this motion")
    straight, yields = model.settings.theory == FIRST_ORDER, settlement.final.hinge_yielding
    kept = replace(Parts.of(model), fixity=np.where(yields | straight, 0.0, model.rods.fixity))
    parts = kept if straight or yields.any() else None
    return _shape(model, said, motions[-1], settlement.final.displacement, parts=parts)


def numbered(model: Model, kind: str, number: int) -> Shape:
    """A "mechanism", "collapse", "buckling mode" or "mode" by its number, from 1. Raises NoShape."""
    find: dict[str, Callable[[Model], Sequence[Shape]]] = {
        marked("mechanism"): mechanism_shapes,
        marked("collapse"): collapse_shapes,
        marked("buckling mode"): buckling_shapes,
        marked("mode"): mode_shapes,
    }
    _check_range(model)
    found = find[kind](model)
    if not found:
        if kind == "mechanism":
            raise NoShape("There is no mechanism: every motion stretches a rod.")
        if kind == "collapse":
            raise NoShape("At no load factor the structure collapses: no strength or plastic moment limits it.")
        raise NoShape("There is no mode: nothing can vibrate.")
    if not 1 <= number <= len(found):
        raise NoShape(
            "There is no {kind} {number}; choose a number from 1 to {count}.",
            kind=tr(kind),
            number=number,
            count=len(found),
        )
    return found[number - 1]


def _shape(
    model: Model,
    title: str,
    motion: NDArray[np.float64],
    about: NDArray[np.float64] | None = None,
    note: str = "",
    parts: Parts | None = None,
) -> Shape:
    drawn = drawn_share(model) / max(1.0, 0.0 if parts else _bulge(model, motion)) * motion
    return Shape(title, drawn[:, :2], about, drawn[:, 2] if drawn.shape[1] > 2 else None, note, parts)


def drawn_share(model: Model) -> float:
    """How large the largest displacement is drawn (m)."""
    return DRAWN_SHARE * extent(model)


def _bulge(model: Model, motion: NDArray[np.float64]) -> float:
    """How far members deflect at most from the lines between their ends, in the unit of the motion.

    A cubic that leaves the line by the angle θ at one end deflects by 4/27 θ L, and both ends add up.
    """
    rods = model.rods
    if motion.shape[1] < 3 or rods.count == 0:
        return 0.0
    ends = motion[rods.between]  # (m, 2, 3)
    along = np.diff(model.particles.position[rods.between], axis=1)[:, 0]
    length = np.maximum(np.hypot(*along.T), 1e-300)
    moved = ends[:, 1, :2] - ends[:, 0, :2]
    chord = (along[:, 0] * moved[:, 1] - along[:, 1] * moved[:, 0]) / length**2
    angles = np.where(rods.turning_shares > 0.0, np.abs(ends[:, :, 2] - chord[:, None]), 0.0)
    return float((4.0 / 27.0 * length * angles.sum(axis=1)).max())
