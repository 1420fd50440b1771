"""The force method and the displacement method: guided solutions of a structure, three systems side by side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from pinjoint.components.camera import Viewport
from pinjoint.components.cases import acting
from pinjoint.components.field import Vector
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.components.settings import HUBS, Settings
from pinjoint.components.slider import SliderStack
from pinjoint.components.units import USUAL, show_in, units_on_screen
from pinjoint.components.view import BETWEEN, Page, Status, View
from pinjoint.editor.context import Context, Scene
from pinjoint.editor.sliders import scale_control
from pinjoint.methods import displacement_words, words
from pinjoint.systems.base import Phase, System
from pinjoint.systems.input.actions import DISPLACEMENT_METHOD, FORCE_METHOD, METHODS
from pinjoint.systems.render.model.arrows import largest_force
from pinjoint.systems.render.model.diagrams import EXPLAINED
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.overlays import heading_height
from pinjoint.systems.render.ui.page import cell_at, page_height

if TYPE_CHECKING:  # it imports scipy
    from pinjoint.methods.guide import Guide, Mechanism, Set

WIDE = 1.1  # width / height from which the sets stand side by side
LARGE = 500  # rods; work on larger structures is announced in a picture first
LOW = 1.8  # width / height of a place from which a structure stands beside its caption
LEAST_WIDTH, LEAST_HEIGHT, LEAST_LOW = 140.0, 160.0, 90.0  # points of a set; below or beside its caption
HIGH = 340.0  # points of a set in which a slider has room below supports and reactions
MOVED = 0.08  # of the size of a structure: about what drawn displacements add to it
CAPTION, SCALE, MARGIN = 66.0, 48.0, 40.0  # points above, below (its slider), at most about a structure


@dataclass
class _Work:
    """Work that takes a while. text: its announcement. said: a frame has shown the announcement."""

    text: str
    do: Callable[[], object]
    said: bool = False


class Method(Scene):
    """The parts of a method.

    shown_guide: the guide as pictures show it, announced work not yet done. words: the module of its texts.
    """

    words: ClassVar[ModuleType]

    def __init__(self) -> None:
        self.shown_guide: Guide | None = None
        self._work: _Work | None = None
        self._problem = ""
        self._mechanism: Mechanism | None = None  # the whole structure, if it cannot be solved
        self._page, self._first = Page(), 0
        self._page_of: tuple[object, ...] | None = None
        self._blank = Model()
        self._places = [View(page=Page(), legend=False, fitted=True) for _ in range(3)]
        self._head, self._foot = View(page=Page(), explains_all=True), View(page=Page(), legend=False)

    @property
    def message(self) -> str:
        """The next task, or why the structure cannot be solved."""
        self.finish()
        return self._said

    @property
    def _said(self) -> str:
        return self.words.message(self.shown_guide) if self.shown_guide else self._problem

    def enter(self, context: Context) -> None:
        self._problem, self._mechanism, self._page_of = "", None, None
        self._units = units_on_screen()
        show_in(USUAL)  # of which their equations are
        self.work(context, tr("Solving the structure"), partial(self._begin, context))

    def _begin(self, context: Context) -> None:
        # Here only, since they import scipy.
        from pinjoint.methods.copies import base_structure
        from pinjoint.methods.guide import Mechanism, view_like
        from pinjoint.systems.statics.unknowns import MethodError

        try:
            self.shown_guide = self.guide_of(context)
        except MethodError as error:
            self._problem = str(error)
            if error.motion is not None:
                copy = base_structure(context.model, [])
                self._mechanism = Mechanism(copy, error.motion, view_like(context.view))

    def guide_of(self, context: Context) -> Guide:
        """The guide at its beginning. Raises MethodError."""
        raise NotImplementedError

    def exit(self, context: Context) -> None:
        self.shown_guide = self._mechanism = self._work = None
        show_in(self._units)

    @property
    def guide(self) -> Guide | None:
        """The guide with all announced work done; None if the structure cannot be solved."""
        self.finish()
        return self.shown_guide

    def finish(self) -> None:
        work, self._work = self._work, None
        if work is not None:
            work.do()

    def work(self, context: Context, text: str, do: Callable[[], object]) -> None:
        """Do work at once; in large structures, once a picture has announced it or the guide is asked for."""
        if context.model.rods.count <= LARGE:
            do()
        else:
            self._work = _Work(tr("{work} with {count} rods …", work=text, count=context.model.rods.count), do)

    def _moving(self) -> list[Set | Mechanism]:
        if self.shown_guide is not None:
            return self.shown_guide.moving
        return [self._mechanism] if self._mechanism is not None else []

    def advance(self, context: Context, elapsed: float) -> None:
        """Let the time of one frame pass in the sets that move; work that takes a while is announced first."""
        if self._work is not None and not self._work.said:
            self._work.said = True
            return
        self.finish()
        for moving in self._moving():
            moving.view.forces_known = moving.simulation is None or context.readiness.lets(moving.simulation)
            if moving.view.forces_known:
                moving.advance(elapsed)

    def busy(self, context: Context) -> bool:
        return self._work is not None or bool(self._moving())

    def hint(self, context: Context) -> str:
        return str(self.words.hint(self.shown_guide)) if self.shown_guide else tr("Esc back")

    # --- what is seen ------------------------------------------------------------------------------

    def stages(self, context: Context) -> list[tuple[Model, View]]:
        """The sets, the message with the legend of all sets, and the working with the status line.

        What cannot be solved comes last, since nothing is picked from it.
        """
        sets, around = self._lay_out(context), [(self._blank, self._head), (self._blank, self._foot)]
        return [*sets, *around] if self.shown_guide is not None else [*around, *sets]

    def _lay_out(self, context: Context) -> list[tuple[Model, View]]:
        """Place message, sets and equations in the window; returns the stages of the sets."""
        guide, ratio, whole = self.shown_guide, context.view.pixel_ratio, context.view.canvas
        self._foot.page = self._working()
        wanted = page_height(self._foot.page, whole.width, ratio)
        foot = min(wanted, round(0.45 * whole.height))  # the rest is scrolled
        _place(self._foot, Viewport(whole.left, round(whole.bottom) - foot, whole.width, foot), ratio)
        if guide is not None:
            guide.point(cell_at(self._foot.page, self._foot.camera.viewport, ratio, context.view.pointer))
        self._head.heading = context.notice or self._said
        part = tr("Part {part} of {parts}", part=guide.part, parts=guide.parts) if guide else tr("Not possible")
        if self._work is not None:
            self._head.heading, part = self._work.text, tr("Working")
        hint = joined([tr("still moving") if self._moving() else "", self.hint(context)], BETWEEN)
        hint = joined([tr("Wheel more rows") if foot < wanted else "", hint], BETWEEN)
        part = joined([part, acting(context.model)], ": ")
        self._foot.status = Status(time=None, state=part, hint=hint)
        self._head.legend = context.view.legend and whole.height >= 300.0 * ratio  # points
        explained = self._explained() if self._head.legend else ()
        head = round(
            heading_height(self._head.heading, whole.width, ratio, load_theme(context.view.theme), explained)
        )
        middle = Viewport(whole.left, whole.top + head, whole.width, max(whole.height - head - foot, 1))
        _place(self._head, Viewport(whole.left, whole.top, whole.width, head), ratio)
        return self._sets(context, middle, ratio)

    def _explained(self) -> list[str]:
        """All that the legend may have to explain in this part."""
        there = self.shown_guide.sets if self.shown_guide is not None else self._moving()
        quantity = next((one.view.quantity for one in there if one.view.all_diagrams), None)
        if quantity is not None and bends(there[0].model):
            return [*EXPLAINED[quantity]]
        return [
            *["tension", "compression", "reaction"] * (quantity is not None),
            *["load", "ghost"] * bool(there),
        ]

    def _working(self) -> Page:
        """The equations and the table; made once in every part, since a table may be long."""
        guide = self.shown_guide
        if guide is None:
            return Page()
        if guide.shown_now != self._page_of:
            self._page = Page(self.words.working(guide), self.words.table(guide), whole=guide.whole)
            self._page_of, self._first = guide.shown_now, 0
        return replace(self._page, first=self._first)

    def _sets(self, context: Context, middle: Viewport, ratio: float) -> list[tuple[Model, View]]:
        captions = self.words.captions(self.shown_guide) if self.shown_guide else [("",)] * 3
        there: list[Set | Mechanism] = [*self.shown_guide.shown] if self.shown_guide else self._moving()
        places = [(index, _third(middle, index)) for index in range(3)]
        first = places[0][1]  # where it has no room for a set beside or above others, only one is shown
        if there and (
            first.width < LEAST_WIDTH * ratio
            or first.height < (LEAST_LOW if _is_low(first) else LEAST_HEIGHT) * ratio
        ):
            picks = self.shown_guide is not None and self.shown_guide.part == 2  # from set 1
            places = [(0 if picks else len(there) - 1, middle)]
        stages = [(one.model, one.view) for one in there]
        largest = max((largest_force(*stage) for stage in stages if stage[1].has_units), default=0.0)
        for _, view in stages:
            view.largest_force = largest * view.has_units  # units of an unknown are no forces
        stages += [(self._blank, view) for view in self._places[len(there) :]]
        shown = []
        for index, viewport in places:
            model, view = stages[index]
            _place(view, viewport, ratio)
            if view.fitted:
                _fit(model, view, context)
            view.caption = captions[index]
            shown.append((model, view))
        if self.shown_guide is not None and self.shown_guide.one_scale:
            control = scale_control(self.shown_guide.sets[0].model.settings)
            high = shown[0][1].camera.viewport.height >= HIGH * ratio
            for number, (_, view) in enumerate(shown):
                view.sliders = SliderStack((control,)) if high and not number else SliderStack()
        return shown

    def scaled(self, context: Context) -> list[Settings]:
        """All sets are drawn to one scale."""
        guide = self.shown_guide
        return [one.model.settings for one in guide.sets] if guide is not None and guide.one_scale else []

    # --- looking closer: all sets alike ----------------------------------------------------------------

    def zoom(self, context: Context, factor: float, pixel: Vector) -> None:
        self.finish()
        stages = self._lay_out(context)  # places the foot, too, which no picture may have done yet
        if self._foot.camera.viewport.contains(pixel):
            last = max(len(self._page.table) - 2, 0)
            self._first = min(max(self._first + (1 if factor < 1.0 else -1), 0), last)
            return
        places = [view.camera.viewport for _, view in stages]
        under = next((place for place in places if place.contains(pixel)), places[0])
        for (_, view), v in zip(stages, places, strict=True):
            view.camera.zoom(factor, (pixel[0] - under.left + v.left, pixel[1] - under.top + v.top))
            view.fitted = False

    def pan(self, context: Context, pixels: Vector) -> None:
        self.finish()
        for _, view in self._lay_out(context):
            view.camera.pan(pixels)
            view.fitted = False

    def fit(self, context: Context) -> None:
        self.finish()
        for model, view in self._lay_out(context):
            view.fitted = True
            _fit(model, view, context)


class ForceMethod(Method):
    """The seven parts of the force method. first_unknown: the name of the rod to release when it begins; "": a person will
    choose."""

    name: ClassVar[str] = FORCE_METHOD
    words: ClassVar[ModuleType] = words
    targets = (*HUBS, DISPLACEMENT_METHOD)
    first_unknown = ""

    def guide_of(self, context: Context) -> Guide:
        """The guide in part 1, or with the first unknown, which then is forgotten."""
        from pinjoint.methods.guide import ForceGuide

        unknown, self.first_unknown = self.first_unknown, ""
        guide = ForceGuide(context.model, context.schedule, context.view)
        if unknown:
            guide.next()
            guide.pick(guide.sets[0].model.rods[unknown])
        return guide


class DisplacementMethod(Method):
    """The six parts of the displacement method."""

    name: ClassVar[str] = DISPLACEMENT_METHOD
    words: ClassVar[ModuleType] = displacement_words
    targets = (*HUBS, FORCE_METHOD)

    def guide_of(self, context: Context) -> Guide:
        """The guide in part 1."""
        from pinjoint.methods.displacements import DisplacementGuide

        return DisplacementGuide(context.model, context.schedule, context.view)


class Sets(System):
    """Lets the time of one frame pass in the sets of a method that move."""

    name = "methods.sets"
    phase = Phase.STEP
    scenes = METHODS
    reads = ("pace",)
    writes = ("sets",)

    def process(self, frame: Any) -> None:
        """Let their time pass."""
        scene = frame.session.scenes.active
        if isinstance(scene, Method):
            scene.advance(frame.session, frame.elapsed)


def _place(view: View, viewport: Viewport, ratio: float) -> None:
    view.camera.viewport, view.pixel_ratio = viewport, ratio


def _fit(model: Model, view: View, context: Context) -> None:
    """Show the whole model below or, in a low place, beside the caption, which grows from part to part.

    Around its original positions and a little more, so that the picture does not depend on how far frames have moved it;
    in a part of the window that most equations leave, so that it stays where it is while these change.
    """
    v, u = view.camera.viewport, view.pixel_ratio
    left, above = (v.width // 3, 0) if _is_low(v) else (0, round(min(CAPTION * u, 0.4 * v.height)))
    below = round(min(SCALE * u, 0.1 * v.height))
    high = min(v.height, round(0.66 * context.view.canvas.height))  # sets stand still while equations change
    within = Viewport(v.left + left, v.top + above, v.width - left, max(high - above - below, 1))
    original = model.particles.position
    reserve = MOVED * float(np.ptp(original, axis=0).max()) if len(original) else 0.0
    view.camera.fit(
        np.concatenate([original - reserve, original + reserve]), min(MARGIN, 0.2 * v.height / u), within, u
    )


def _is_low(place: Viewport) -> bool:
    return place.width > LOW * place.height


def _third(middle: Viewport, index: int) -> Viewport:
    """One of three equal parts: beside each other in a wide window, else above each other."""
    if middle.width >= WIDE * middle.height:
        edges = [middle.left + middle.width * i // 3 for i in range(4)]
        return Viewport(edges[index], middle.top, edges[index + 1] - edges[index], middle.height)
    edges = [middle.top + middle.height * i // 3 for i in range(4)]
    return Viewport(middle.left, edges[index], middle.width, edges[index + 1] - edges[index])
