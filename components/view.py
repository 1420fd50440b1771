"""View: everything that decides how a model is shown, besides the model itself."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.additions import outlines
from pinjoint.components.bent import AXIAL, Parts, drawn_scale, middles
from pinjoint.components.camera import LEAST_MARGIN, Camera, Rectangle, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bends
from pinjoint.components.slider import ARROW, CHOICES, EDGE, GAP, SUPPORT, Place, SliderStack
from pinjoint.components.toolbar import Menu, Tool, Toolbar

CONVENTIONS = TEXTBOOK, THESIS = ("textbook", "thesis")  # of the force method

# Sizes of type and symbols that a person can choose, relative to the usual one.
MAGNIFICATIONS = (0.5, 0.65, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0)
COMFORTABLE = 1080.0  # points: on displays higher than this, type and symbols grow
COMFORTABLE_HEIGHT, LEAST_HEIGHT = 480.0, 240.0  # points that are left in a window by itself, and at all
BETWEEN = " " * 5  # the steps of a hint
MARGIN = 110.0  # points around a fitted model, room for supports, diagrams and labels
ABOVE = 102.0  # points above members that bend, for a legend in two rows and diagrams
COVERED = 0.75  # of this margin, what arrows and the legend may take
_COLUMN = 310.0  # points: the width of panels, boxes to type into, or a lesson, beside a model
LEAST_MODEL = 230.0  # points that the model keeps beside boxes, or they take all
LEAST_BESIDE, LEAST_ABOVE = 520.0, 300.0  # points of a canvas's width or height that is shared with panels
TABLE_SHARE = 0.36  # of a window's height, that a table of results takes below a model at most
STRIP, STRIP_SHARE = 230.0, 0.4  # points, and share of the height at most, of this strip


def magnified(height: float, display: float, chosen: float) -> float:
    """The size of type and symbols, relative to the usual one, in a window on a display (heights in points).

    chosen: the factor that a person chose, relative to the size that suits the window.
    """
    fitting = max(max(height, display) / COMFORTABLE, 1.0)
    by_itself = max(factor for factor in MAGNIFICATIONS if factor <= fitting)
    by_itself = min(by_itself, max(height / COMFORTABLE_HEIGHT, 1.0))
    return min(by_itself * chosen, max(height / LEAST_HEIGHT, 1.0))


def lesson_share(width: int, height: int, unit: float) -> tuple[int, int]:
    """The pixels that a lesson takes of a window: of its width, at the right, or of its height, at the bottom."""
    if width >= 860.0 * unit:  # a column; else a strip below
        return round(_COLUMN * unit), 0
    return 0, round(min(STRIP_SHARE * height, STRIP * unit))


@dataclass(frozen=True)
class Status:
    """The contents of the status line.

    time: simulated seconds, if they matter. speed: simulated seconds per second shown (0: halted). state: such as
    "running", "at rest", "diverged". hint: the next possible step. problem: why it stopped, or "".
    notice: what the last action did, or what is being waited for, or "". offer: title and action of a
    button beside it. share: how much of what the notice says is done, from 0 to 1; None: it is no work.
    """

    time: float | None = 0.0
    speed: float = 0.0
    state: str = ""
    hint: str = ""
    problem: str = ""
    notice: str = ""
    share: float | None = None
    offer: tuple[str, str] | None = None


@dataclass(frozen=True)
class Preview:
    """The element that a tool is about to make, or the state of a drag, drawn over the model.

    kind: "rod", "force", "distributed force", "moment", "velocity", "hinge", "roller", "pinned", "guided", "clamped",
    "pull" or "box"; "": none. start, end: points of the picture (m); of a box, two opposite corners; of a support, its
    point and towards its ground. label: its value with its unit, or "". along: the ends of the rods that bear it.
    joints: points (m) where it is joined to members. before: those through which it came to its start. typed: what is typed
    of it at the pointer, or "". problem: why that was refused.
    """

    kind: str
    start: Vector
    end: Vector
    label: str = ""
    along: tuple[tuple[Vector, Vector], ...] = ()
    joints: tuple[Vector, ...] = ()
    before: tuple[Vector, ...] = ()
    typed: str = ""
    problem: str = ""


@dataclass(frozen=True)
class Cut:
    """A static unknown that is released: between the ends of a rod, or the moment at one of them.

    between: the particles that the rod joins. end: 0 or 1, of a moment; None: the rod is cut through. label: of the pair
    of unit forces or moments that acts there; "": none acts. held: nothing but a support is left at the joint.
    """

    between: tuple[str, str]
    end: int | None = None
    label: str = ""
    held: bool = False


@dataclass(frozen=True)
class Page:
    """Text in place of a model: lines, then a table whose columns are aligned; the first row is its head.

    first: rows of the table that are scrolled away. whole: it is not parted into blocks side by side.
    """

    lines: tuple[str, ...] = ()
    table: Sequence[tuple[str, ...]] = ()
    first: int = 0
    whole: bool = False


@dataclass(frozen=True)
class Listing:
    """Those rows of a table of results that are in sight, beside or below a model.

    titles: of all tables; title: of the one that is shown. heads: (title, unit) of its columns. by: the column by which its
    rows are ordered, falls: the largest first. rows: their texts, each with its number in the table, and whether it is
    selected. longest: the longest name. first: of how many rows, `count`, the first is that is in sight.
    """

    titles: tuple[str, ...]
    title: str
    heads: tuple[tuple[str, str], ...]
    by: int
    falls: bool
    rows: tuple[tuple[int, bool, tuple[str, ...]], ...]
    longest: str
    first: int
    count: int


@dataclass(frozen=True)
class Plot:
    """Curves over common axes, whose titles name quantity and unit.

    curves: (name, x (n,), y (n,)) of each; what is not finite parts a curve. revision: grows when they change.
    dots: places (k, 2) that are marked on them.
    """

    x_title: str
    y_title: str
    curves: tuple[tuple[str, NDArray[np.float64], NDArray[np.float64]], ...] = field(compare=False, repr=False)
    revision: int = 0
    dots: NDArray[np.float64] | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Readout:
    """A small panel beside the model: a title, rows of (what, value), and perhaps a plot.

    closes: the action of the button in its corner, which takes it away; "": it has none.
    """

    title: str
    rows: tuple[tuple[str, str], ...] = ()
    plot: Plot | None = None
    closes: str = ""

    @property
    def is_large(self) -> bool:
        """True if it does not fit into a corner of the picture."""
        return self.plot is not None or len(self.rows) > 1


@dataclass(frozen=True)
class Pin:
    """A place on a rod, so far from its start (m), whose numbers stay while that rod alone is selected.

    typed: the distance as a person types it (cm). told: the numbers; None while they are not to be seen.
    """

    rod: Rod
    distance: float
    typed: str = ""
    told: Readout | None = None


@dataclass(frozen=True)
class Card:
    """A task of a lesson as it stands, for drawing and clicking.

    title: of the lesson. progress: which task of how many, and done: those that were done. paragraphs: the task.
    choices: (text, chosen) of possible answers, with the action of each in `answers`. entry: what was typed, with its unit;
    None: nothing is to be typed. said: what is said of the last check, or a hint, and its `mood`: "right", "wrong", "hint".
    buttons: the first that is enabled is the next thing to do. first: by how many lines it is scrolled on, or back if
    negative.
    """

    title: str
    progress: str = ""
    count: int = 0
    at: int = 0
    done: frozenset[int] = frozenset()
    paragraphs: tuple[str, ...] = ()
    choices: tuple[tuple[str, bool], ...] = ()
    entry: str | None = None
    said: tuple[str, ...] = ()
    mood: str = ""
    buttons: tuple[Tool, ...] = ()
    first: int = 0


@dataclass(frozen=True)
class Shape:
    """A mechanism, or a mode of buckling or vibration, to be drawn over the model.

    title: such as "Mode 1 of 5: 9.276 Hz". displacement: (m), as drawn, (n, 2). about: the displacement (m) of the
    equilibrium that it leads away from, (n, 2); None: it leads away from the original positions. rotation: (rad), on the
    scale of the displacement, (n,); None: nothing turns. note: a sentence about what it leaves out, or "". parts: what is
    drawn, where rods are divided for it; its places follow the particles in all arrays of the shape. swings: to and fro.
    values: texts of it, each with its place (m) and how far from there it is drawn.
    """

    title: str
    displacement: NDArray[np.float64] = field(compare=False, repr=False)
    about: NDArray[np.float64] | None = field(default=None, compare=False, repr=False)
    rotation: NDArray[np.float64] | None = field(default=None, compare=False, repr=False)
    note: str = field(default="", compare=False)
    parts: Parts | None = field(default=None, compare=False, repr=False)
    swings: bool = True
    values: tuple[tuple[str, NDArray[np.float64], NDArray[np.float64]], ...] = field(
        default=(), compare=False, repr=False
    )


@dataclass(frozen=True)
class Trails:
    """Where what is selected was drawn in the run so far.

    of: the particles, and the scale of displacements. time: of the last moment (s). places: (moments, particles, 2), m.
    """

    of: tuple[object, ...] = ()
    time: float = 0.0
    places: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0, 2)), compare=False, repr=False)


@dataclass(frozen=True)
class Hit(Rectangle):
    """Where a press does something.

    action: what; "": nothing, but what lies below does not get it; None: what the scene says. enabled: it would do
    something now. item: what it is for, such as a tool, a box or a slider. at: the pixel where it acts, where that is not
    the one that was pressed. wheel: what that does, up and down; None: it goes to what lies below. again: the second click
    of a double click is another click.
    """

    action: str | None
    enabled: bool = True
    item: Any = None
    at: Vector | None = None
    wheel: tuple[str, str] | None = None
    again: bool = False


@dataclass
class View:
    """How one model is shown in one viewport.

    rigid: rods are drawn with rigid ends. joins: they are joined to members that they meet, which they cross else.
    heading: the word top left ("Pause"), or "". all_diagrams: force diagrams of all elements. quantity: which force
    diagrams show where rods bend, "N", "M" or "V".
    legend: show the meaning of colours. explains_all: of those of the pictures beside this one, too.
    help: the page of keys that is shown, from 1; 0: none. keys: the lines of all pages (key, meaning), while it is.
    pointer: the pixel under the mouse, or None outside. pixel_ratio: device pixels per point (HiDPI).
    forces_known: False while a large model waits for the program that computes forces; then no forces are shown.
    caption: lines at the top: a title, and facts about the model. page: text in place of the model.
    pressed: what was pressed and is still under the pointer: it shows no tip.
    tool: "place", "rod", "support", "force" or "velocity" while clicks and drags make one, or "".
    preview: what is being drawn. toolbar: what can be clicked at the left edge; hidden with the legend.
    flashes: points (m) where particles collided just now, shape (k, 2).
    sliders: what can be moved at the lower left; none with the legend hidden.
    menu: the list of what can be done somewhere, while it is open.
    theme: the name of its colours. readouts: panels at the right edge; hidden with the legend.
    convention: of the force method. has_scale: a length to scale, and notes about what is hidden, are shown.
    advises: they may say what to do, as in a window.
    pointed: what is said of the element under the pointer, beside it. pin: the place of which numbers stay.
    shape: a mechanism or mode that is drawn over the model, with its title below the caption. swing: the share of it, from
    1 to −1, that is drawn now.
    names: all elements have their names, not only few.
    utilisation: rods show in colours how much of their strength they bear.
    envelope: diagrams show what is most and least in all combinations, or while a force moves along a path of rods.
    enveloped: which that is, a statics.envelope.Envelope; None: they do not.
    largest_force: that (kN) of pictures beside this one, with which its arrows share a scale; 0: none.
    free_bodies: rods and joints are drawn apart, with the forces on each.
    wanted: which of our own a person switched on among them: theory beside the run, its energy, its events.
    fitted: the camera shows the whole model, and follows the size of the window until a person zooms or pans.
    shares: the model is fitted beside the panels; else panels may cover it. since: by title, the rank in which each
    panel appeared. table: the points across and high that a table of results wants beside the model; 0, 0: there is none.
    aside: the part of the window, at its left or right, that boxes to type into take; None: none.
    provisional: why what is shown is no equilibrium, which makes results pale; "": it is one.
    card: a task of a lesson, in place of a model. cuts: rods that are drawn cut. has_units: values of forces tell theirs.
    trails: where what is selected was. followed: the particle that the view goes with, and where it was drawn (m); or None.
    sound: what happens is heard, in a window.
    bare: loads, reactions and velocities are left out, as beside diagrams on paper.
    near_buckling: rows of rods whose compression is nearly critical: they pulse as a shape swings.
    steady: a hand moves something, so that labels stay beside what they belong to. arrow_scales: of vectors by Field, how
    much a point of an arrow is that is drawn or dragged. session: a weak reference to the context that shows it; or None.
    """

    camera: Camera = field(default_factory=Camera)
    heading: str = ""
    all_diagrams: bool = False
    rigid: bool = False
    joins: bool = True
    quantity: str = AXIAL
    forces_known: bool = True
    legend: bool = True
    explains_all: bool = False
    help: int = 0
    pixel_ratio: float = 1.0
    status: Status = field(default_factory=Status)
    keys: tuple[tuple[str, str], ...] = ()
    pointer: Vector | None = None
    tool: str = ""
    preview: Preview | None = None
    flashes: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    caption: tuple[str, ...] = ()
    page: Page | None = None
    toolbar: Toolbar = field(default_factory=Toolbar)
    pressed: Hit | None = None
    sliders: SliderStack = field(default_factory=SliderStack)
    menu: Menu | None = None
    theme: str = "light"
    convention: str = TEXTBOOK
    has_scale: bool = True
    advises: bool = True
    readouts: tuple[Readout, ...] = ()
    since: dict[str, int] = field(default_factory=dict)
    largest_force: float = 0.0
    utilisation: bool = False
    envelope: bool = False
    path: tuple[Rod, ...] = ()
    enveloped: Any = None
    names: bool = False
    wanted: frozenset[str] = frozenset()
    free_bodies: bool = False
    shape: Shape | None = None
    swing: float = 1.0
    near_buckling: tuple[int, ...] = ()
    pointed: Readout | None = None
    pin: Pin | None = None
    fitted: bool = False
    shares: bool = False
    table: Vector = (0.0, 0.0)
    aside: Viewport | None = None
    provisional: str = ""
    card: Card | None = None
    session: Any = None
    cuts: tuple[Cut, ...] = ()
    has_units: bool = True
    bare: bool = False
    steady: bool = False
    trails: Trails = field(default_factory=Trails)
    followed: tuple[Particle, Vector] | None = None
    sound: bool = False
    arrow_scales: dict[str, float] = field(default_factory=dict)

    @property
    def looks(self) -> tuple[object, ...]:
        """All that is shown, to be compared with what was: what changes in place is copied, all else is frozen."""
        copies = {"camera": copy(self.camera), "keys": tuple(self.keys), "since": tuple(self.since.items())}
        return tuple((vars(self) | copies | {"flashes": self.flashes.tobytes()}).values())

    def fit(self, model: Model) -> None:
        """Let the camera show the whole model, clear of the sliders, and with room for arrows or diagrams above it."""
        room = self.room
        if self.legend:
            above = ABOVE if bends(model) else SUPPORT + ARROW
            missing = min(above * self.pixel_ratio - LEAST_MARGIN * room.height, LEAST_MARGIN / 2 * room.height)
            top, kept = round(max(missing, 0.0)), 1.0 - LEAST_MARGIN  # the margin shrinks with the room
            room = replace(room, top=room.top + top, height=max(room.height - round(top / kept), 1))
        self.camera.fit(drawn_places(model), MARGIN, room, self.pixel_ratio)
        if self._meets_sliders(model):
            more = self._reserve(arrows=True) - self._reserve(arrows=False)
            room = replace(room, height=max(room.height - more, 1))
            self.camera.fit(drawn_places(model), MARGIN, room, self.pixel_ratio)
        self.fitted = True

    @property
    def pixel(self) -> Vector:
        """The pixel where the pointer is; the middle of the view if it is outside."""
        return self.pointer or self.camera.middle

    def follow(self, model: Model, *, clear: bool = False) -> None:
        """Fit the model anew if it has left the picture, unless somebody looks closer; clear: or lies under something."""
        shown = self.shows(model, COVERED) and not self._meets_sliders(model) if clear else self.shows(model)
        if self.fitted and not shown:
            self.fit(model)

    def shows(self, model: Model, share: float = 0.0) -> bool:
        """True if all of the model lies in the room for it, a share of the margin of a fit away from its sides."""
        room, (x, y) = self.room, self.camera.to_pixels(drawn_places(model)).T
        margin = share * min(MARGIN * self.pixel_ratio, LEAST_MARGIN * room.height)
        aside = share * min(MARGIN * self.pixel_ratio, LEAST_MARGIN * room.width)
        across = (x >= room.left + aside) & (x <= room.right - aside)
        return bool((across & (y >= room.top + margin) & (y <= room.bottom - margin)).all())

    @property
    def _has_sliders(self) -> bool:
        """False where a table below leaves the model too little beside sliders."""
        return not self.table[0] or self.canvas.height >= (LEAST_ABOVE + self.sliders.above) * self.pixel_ratio

    def _reserve(self, *, arrows: bool) -> int:
        """Pixels of the height of the canvas that are left to the sliders; arrows: with those that reach down to them."""
        if not self._has_sliders:
            return round(SUPPORT * self.pixel_ratio)
        return self.sliders.reserve(self.canvas, self.pixel_ratio, MARGIN, arrows=arrows)

    def _meets_sliders(self, model: Model) -> bool:
        """True if some of a model, with its supports and arrows, may lie under the sliders."""
        places, reach = self.slider_places, (SUPPORT + ARROW) * self.pixel_ratio
        x, y = self.camera.to_pixels(drawn_places(model)).T
        if not places or not len(x):
            return False
        right, top = places[0].right, places[-1].top
        return bool(x.min() - ARROW * self.pixel_ratio < right and y.max() + reach > top)

    def share(self, model: Model, *, shares: bool, table: Vector = (0.0, 0.0)) -> None:
        """Leave room for panels and a table, or not, and fit the model into what is left, unless somebody looks closer."""
        before, self.shares, self.table = (self.shares, self.table), shares, table
        if self.fitted and (shares, table[0]) != (before[0], before[1][0]):
            self.fit(model)
        elif table != before[1]:  # other rows
            self.follow(model, clear=True)

    @property
    def strip(self) -> Viewport:
        """The part of the viewport that the toolbar takes; of no width where it is hidden."""
        window = self.camera.viewport
        if not self.legend:
            return Viewport(window.left, window.top, 0, window.height)
        return self.toolbar.strip(window, self.pixel_ratio)

    def put_together(self) -> bool:
        """Show the structure in one piece, for what free bodies do not show; False if it was."""
        apart, self.free_bodies = self.free_bodies, False
        return apart

    @property
    def table_place(self) -> Viewport:
        """Where a table of results stands: at the right where the model keeps enough, else below; of no size without one."""
        window, taken = self.camera.viewport, self.strip.width
        wide, high = (round(points * self.pixel_ratio) for points in self.table)
        if wide == 0 or window.width >= taken + wide + LEAST_BESIDE * self.pixel_ratio:
            return Viewport(window.left + window.width - wide, window.top, wide, window.height)
        high = min(high, round(TABLE_SHARE * window.height))
        return Viewport(window.left + taken, window.top + window.height - high, window.width - taken, high)

    @property
    def canvas(self) -> Viewport:
        """The part of the viewport that is left for the model."""
        window, taken = self.camera.viewport, self.strip.width
        left, right, bottom = window.left + taken, window.left + window.width, window.top + window.height
        if self.table[0]:
            table = self.table_place
            right, bottom = (table.left, bottom) if table.top == window.top else (right, table.top)
        if self.aside is not None and self.aside.left > left:
            right = self.aside.left
        elif self.aside is not None:
            left = self.aside.left + self.aside.width
        return Viewport(left, window.top, right - left, bottom - window.top)

    def beside(self, *, at_left: bool) -> Viewport | None:
        """Where boxes to type into stand beside the model; None where they would leave too little of it."""
        c, u = self.canvas, self.pixel_ratio
        if c.width < (_COLUMN + LEAST_MODEL) * u:
            return None
        width = round(_COLUMN * u)
        return replace(c, left=c.left if at_left else c.left + c.width - width, width=width)

    def covers(self, pixel: Vector) -> bool:
        """True if the toolbar, a table, a slider or boxes to type into are at a pixel of the window, not the model."""
        taken = any(place.contains(pixel) for place in (self.strip, self.table_place))
        taken = taken or self.slider_at(pixel) is not None
        return taken or (self.aside is not None and self.aside.contains(pixel))

    @property
    def slider_places(self) -> list[Place]:
        """Where the sliders are: at the lower left of the canvas, above panels that take its lower half."""
        c, panels = self.canvas, self.panels
        beside = not self.shares or panels.width < c.width or panels == c
        sliders = self.sliders if self._has_sliders else SliderStack()
        return sliders.places(c if beside else replace(c, height=c.height - panels.height), self.pixel_ratio)

    @property
    def choices_place(self) -> Rectangle:
        """Where choices are: above the sliders, up to the right edge of the canvas."""
        c, u, places = self.canvas, self.pixel_ratio, self.slider_places
        bottom = places[-1].top if places else c.bottom - self.sliders.above * u
        return Rectangle(c.left + EDGE * u, bottom - CHOICES * u, c.width - 2.0 * EDGE * u, (CHOICES - GAP) * u)

    def slider_at(self, pixel: Vector) -> Place | None:
        """The slider under a pixel."""
        return next((place for place in self.slider_places if place.contains(pixel)), None)

    @property
    def panels(self) -> Viewport:
        """Where panels stand: in a column at the right, if that is too narrow in the lower half, else anywhere."""
        c, u = self.canvas, self.pixel_ratio
        if c.width >= LEAST_BESIDE * u:
            width = round(_COLUMN * u)
            return replace(c, left=c.left + c.width - width, width=width)
        if c.height >= LEAST_ABOVE * u:
            return Viewport(c.left, c.top + c.height // 2, c.width, c.height - c.height // 2)
        return c

    @property
    def room(self) -> Viewport:
        """The part of the canvas that a model is fitted into."""
        c, panels = self.canvas, self.panels
        c = replace(c, height=max(c.height - self._reserve(arrows=False), 1))
        if not self.shares or panels == self.canvas:
            return c
        if panels.width < c.width:
            return replace(c, width=c.width - panels.width)
        return replace(c, height=c.height - panels.height)


def drawn_positions(model: Model) -> NDArray[np.float64]:
    """Where particles are drawn (m), shape (n, 2): original position + displacement × scale."""
    return model.particles.position + model.particles.displacement * drawn_scale(model)


def drawn_at(model: Model, particle: Particle) -> Vector:
    """Where a particle is drawn (m)."""
    x, y = drawn_positions(model)[particle.row].tolist()
    return x, y


def drawn_places(model: Model) -> NDArray[np.float64]:
    """All that a picture of a model is to show (m), (n, 2): positions as drawn and deflected, bent rods, and points of other
    elements; what only a thin line shows deflected up to a structure's length away.
    """
    position, scale = model.particles.position, float(model.settings.displacement_scale)
    deflected = np.concatenate([position + model.particles.displacement * scale, middles(model)])
    if len(position) and scale != drawn_scale(model):
        low, high = position.min(axis=0), position.max(axis=0)
        far = (high - low).max()
        deflected = np.clip(deflected, low - far, high + far)
    others = (points.reshape(-1, 2) for _, points in outlines(model))
    return np.concatenate([drawn_positions(model), deflected, *others])
