"""Drawing: rods from particle to particle, forces and velocities as arrows, supports, elements of mods."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar

from pinjoint.components import written
from pinjoint.components.cases import PERMANENT, alone
from pinjoint.components.field import CM, Field, FieldError, Vector, on_screen
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, joined, marked, plural, tr
from pinjoint.components.load import SpanLoad
from pinjoint.components.mistake import Mistake
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bends, rigid_joints
from pinjoint.components.round_numbers import round_down
from pinjoint.components.tags import Selected
from pinjoint.components.view import BETWEEN, COVERED, Preview, drawn_at, drawn_positions
from pinjoint.editor.context import Context, Gesture, tell
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.arrows import arrow_end, arrow_scale, arrow_value
from pinjoint.systems.edit.dividing import divide_at
from pinjoint.systems.edit.picking import PARTICLE_REACH, pick_particle, pick_rod
from pinjoint.systems.edit.placing import SAME, particle_at, place, snapped, snapped_to_points
from pinjoint.systems.edit.rods import check_ends, distance, join, members_met, place_at, share_at
from pinjoint.systems.edit.supports import SUPPORTS, Held, next_support, support, support_towards
from pinjoint.systems.edit.typed import UP, number, tidy, vector
from pinjoint.systems.forms.answers import draw_load
from pinjoint.systems.forms.properties import heading

STEP = 10.0  # points, by which arrows are dragged


class Drawing(Gesture):
    """A drawing from a particle or a point (m), by clicks, drags or the key of a tool.

    tool: the name of the tool and of its action. goes_on: it began by itself where the one before it ended.
    typed: where it ends, as a person types it, which counts before the pointer. problem: why that was refused.
    """

    tool: str
    goes_on = False
    typed = ""
    problem = ""

    def __init__(self, context: Context, origin: Particle | Vector) -> None:
        self.origin = origin

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        """A new drawing from the particle at a pixel; None if none can begin there, or one of this kind is to go on."""
        particle = pick_particle(context.model, context.view, pixel)
        return cls(context, particle) if particle is not None else None

    @classmethod
    def use(cls, context: Context, pixel: Vector) -> None:
        """The action of the tool: finish its drawing, else begin one at a pixel, else take the tool up or put it away."""
        gesture = context.gesture
        if isinstance(gesture, Drawing) and gesture.tool == cls.tool and not gesture.goes_on:
            gesture.finish(context, pixel)
            return
        context.leave_gesture()
        context.gesture = cls.begin(context, pixel)
        if context.gesture is None:
            take_up(context, cls.tool)

    def start(self, context: Context) -> Vector:
        """Where it begins (m), as it is drawn. Raises Refusal if that particle was deleted."""
        if not isinstance(self.origin, Particle):
            return self.origin
        if not self.origin.exists:
            raise Refusal("The particle where this began has been deleted; begin at another one.")
        return drawn_at(context.model, self.origin)

    @property
    def unit(self) -> tuple[str, str]:
        """The unit of what is typed inside the program, and that of numbers that name none."""
        return "m", on_screen(CM[0])[0]

    def accept(self, context: Context, pixel: Vector) -> None:
        """End as it is typed; why that is refused is said beside what was typed, which stays."""
        try:
            self.finish(context, pixel)
        except Mistake as error:
            self.problem = str(error)
        view = context.view
        if not self.problem and not view.shows(context.model, COVERED):
            view.fit(context.model)

    def end_typed(self, context: Context, pointed: Vector) -> Vector:
        """Where it ends as it is typed (m); the point that is pointed at if nothing is.

        Raises FieldError.
        """
        if not self.typed:
            return pointed
        x, y = self.start(context)
        across, up = vector(self.typed, *self.unit, (pointed[0] - x, pointed[1] - y))
        return tidy(x + across), tidy(y + up)

    def finish(self, context: Context, pixel: Vector) -> None:
        """End at a pixel; where that is refused, the drawing goes on."""
        self.drop(context, pixel)
        context.gesture = self.following(context)

    def following(self, context: Context) -> Drawing | None:
        """The drawing that begins by itself when this one is finished."""
        return None


class DrawRod(Drawing):
    """A rod from one particle or place to another; where there is no particle, one is made, on the grid if near it.

    While the tool is in hand, the next rod begins where this one ends.
    """

    tool = "rod"

    def __init__(self, context: Context, origin: Particle | Vector, *, goes_on: bool = False) -> None:
        super().__init__(context, origin)
        self.goes_on = goes_on
        self._end: Particle | None = None
        self.say(context)

    def say(self, context: Context) -> None:
        """Let the hint name the kind of rod that is drawn."""
        step = (
            tr("rod from {particle}: click where it ends (or L)", particle=self.origin.said)
            if isinstance(self.origin, Particle)
            else tr("rod: click where it ends (or L)")
        )
        done = tr("double click ends the chain     Esc done") if self.goes_on else tr("Esc cancel")
        typed = tr("or type its length, 3@45, or 3; 1.5")
        self.hint = joined([step, self.kind(context), done, typed], BETWEEN)

    @staticmethod
    def kind(context: Context) -> str:
        """What rods are drawn with now, and how to change that, for the status line."""
        ends = tr("rigid ends (Ctrl+R: pinned)") if context.view.rigid else tr("pinned (Ctrl+R: rigid ends)")
        if not bends(context.model):
            return ends
        meets = (
            tr("joins members (Ctrl+T: crosses)")
            if context.view.joins
            else tr("crosses members (Ctrl+T: joins)")
        )
        return joined([ends, meets], BETWEEN)

    @classmethod
    def begin_anywhere(cls, context: Context, pixel: Vector) -> Drawing:
        """A new drawing by a click or drag with the tool in hand."""
        return cls.begin(context, pixel) or cls(context, onto_member(context, pixel))

    def drop(self, context: Context, pixel: Vector) -> None:
        model, view, begin = context.model, context.view, self.origin
        end = self._ending(context, pixel)
        before, met = model.particles.count, self._met(context, end)
        with model.transaction(marked("new rod")):
            stops = [divide_at(model, rod, [share])[1].ends[0] for _, rod, share in met]
            if not met or met[0][0] > SAME:
                stops.insert(0, begin if isinstance(begin, Particle) else place(model, view, begin))
            if isinstance(end, Particle):
                stops.append(end)
            elif not met or met[-1][0] < math.dist(self.start(context), end) - SAME:
                stops.append(
                    model.create(Particle, position=[end])[0] if self.typed else place(model, view, end)
                )
            rods = [join(model, *pair, rigid=view.rigid) for pair in itertools.pairwise(stops)]
            self._end, rod = stops[-1], rods[-1]
        made = model.particles.count - before
        with_new = plural("with one new particle", "with {count} new particles", made) if made else ""
        made_of = (rod.section or tr("rigid")) if view.rigid else ""
        joins = plural("joined to a member", "joined to {count} members", len(met)) if met else ""
        said = [written.length(sum(rod.rest_length for rod in rods), written.DIGITS), made_of, with_new, joins]
        tell(context, joined(said, ", "), rod)

    def _met(self, context: Context, end: Particle | Vector) -> list[tuple[float, Rod, float]]:
        """The members that it is joined to on its way: how far along it, and at which share of each."""
        if not context.view.joins:
            return []
        start = self.start(context)
        last = drawn_at(context.model, end) if isinstance(end, Particle) else end
        farthest = math.dist(start, last) + SAME * (-1.0 if isinstance(end, Particle) else 1.0)
        nearest = SAME * (1.0 if isinstance(self.origin, Particle) else -1.0)
        return [met for met in members_met(context.model, start, last, SAME) if nearest < met[0] < farthest]

    def _ending(self, context: Context, pixel: Vector) -> Particle | Vector:
        """The particle or the point where it ends, as typed, else as pointed at: nearly level or upright rods are so."""
        model, view = context.model, context.view
        if not self.typed and (particle := pick_particle(model, view, pixel)) is not None:
            return particle
        pointed = onto_member(context, pixel, self.start(context))
        point = self.end_typed(context, pointed)
        return particle_at(model, point) or point if self.typed else point

    def finish(self, context: Context, pixel: Vector) -> None:
        """End at a pixel; a click where a chain of rods has come to ends the chain."""
        at_origin = pick_particle(context.model, context.view, pixel) is self.origin
        if self.goes_on and at_origin and not self.typed:
            context.gesture = None
        else:
            super().finish(context, pixel)

    def following(self, context: Context) -> Drawing | None:
        in_hand = context.view.tool == self.tool and self._end is not None
        return DrawRod(context, self._end, goes_on=True) if in_hand and self._end is not None else None

    def cancel(self, context: Context) -> None:
        if self.goes_on:
            context.view.tool = ""

    def leave(self, context: Context) -> None:
        """The tool stays in hand."""

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        start, other = self.start(context), self._ending(context, pixel)
        if not isinstance(other, Particle) or other is self.origin or not isinstance(self.origin, Particle):
            end = drawn_at(context.model, other) if isinstance(other, Particle) else other
            return Preview(
                "rod", start, end, _length_and_angle(start, end), joints=self._joints(context, other)
            )
        try:
            check_ends(context.model, self.origin, other)
            label = written.length(distance(self.origin, other), written.DIGITS)
        except Refusal:
            label = tr("joined already")
        return Preview("rod", start, drawn_at(context.model, other), label, joints=self._joints(context, other))

    def _joints(self, context: Context, end: Particle | Vector) -> tuple[Vector, ...]:
        return tuple(place_at(rod, share) for _, rod, share in self._met(context, end))


class DrawArrow(Drawing):
    """A vector of elements, by default of the particle where it begins, drawn as an arrow.

    field: the Field that it is. asks, says: the status line while it is drawn, and the notice then.
    """

    field: str
    asks: ClassVar[str]
    says: ClassVar[str]

    def __init__(self, context: Context, origin: Particle | Vector, *elements: Any) -> None:
        super().__init__(context, origin)
        self.elements: list[Any] = [*elements] or [origin]
        alone = len(self.elements) == 1
        named = self.elements[0].said if alone else heading(context.model, self.elements)
        typed = tr("or type its value: −15, 3; −15 or 15@−60")
        asks = tr(self.asks, particle=named, rods=named)
        self.hint = joined([asks, tr("Esc cancel"), typed, scale_said(context, self._field)], BETWEEN)

    def _scale(self, context: Context) -> float:
        return arrow_scale(context.model, context.view, self.field)

    @property
    def _field(self) -> Field[Any]:
        found: Field[Any] = getattr(type(self.elements[0]), self.field)
        return found

    @property
    def unit(self) -> tuple[str, str]:
        return self._field.unit, self._field.on_screen[0]

    def value(self, context: Context, pixel: Vector) -> Any:
        """What is typed, of which a number alone points up, or what the arrow to a pixel stands for."""
        drawn = arrow_value(context.view, self.start(context), pixel, self._scale(context))
        return vector(self.typed, *self.unit, drawn, UP) if self.typed else drawn

    def shown(self, value: Any) -> str:
        """The text of a value."""
        return written.stated(value, self._field.shown[0], written.DIGITS)

    def finish(self, context: Context, pixel: Vector) -> None:
        """The same; where it begins, only what is dropped there, or typed, takes a load away."""
        away = math.dist(context.view.camera.to_pixels(self.start(context)), pixel) / context.view.pixel_ratio
        if not self.typed and self.value(context, pixel) in (0.0, (0.0, 0.0)) and away <= PARTICLE_REACH:
            raise Refusal("This arrow has no length: draw it farther, or type its value, 0 for none.")
        super().finish(context, pixel)

    def drop(self, context: Context, pixel: Vector) -> None:
        value, elements = self.value(context, pixel), [one for one in self.elements if one.exists]
        if elements:
            draw_load(context.model, elements, self.field, value)
            named, rods = elements[0].said, begun(heading(context.model, elements))
            said = self.shown(value)
            context.notice = tr(self.says, particle=named, rods=rods, value=said, load=said)

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        value, start = self.value(context, pixel), self.start(context)
        end = arrow_end(context.view, start, value, self._scale(context))
        return Preview(self.field.replace("_", " "), start, end, self.shown(value))


class DrawForce(DrawArrow):
    """The constant force on a particle; beside one, the distributed force on a rod."""

    tool, field = "force", "force"
    asks = marked("load on {particle}: click where its arrow ends (or F)")
    says = marked("Load on {particle}: {value}")

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        begun = super().begin(context, pixel)
        rod = pick_rod(context.model, context.view, pixel) if begun is None else None
        if rod is None or context.view.covers(pixel):
            return begun
        rods = context.model.tagged(Selected, Rod)
        return DrawDistributedForce(
            context, context.view.camera.to_model(pixel), *(rods if rod in rods else [rod])
        )


class DrawDistributedForce(DrawArrow):
    """The distributed force on a rod, or on all selected rods if it is one of them, drawn from a point on it."""

    tool, field = "force", "distributed_force"
    asks = marked("distributed load on {rods}: click where its arrow ends (or F)")
    says = marked("{rods}: distributed load {load}")

    def shown(self, value: Any) -> str:
        return written.stated(value, self._field.shown[0])

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        made = super().preview(context, pixel)
        drawn = drawn_positions(context.model)
        ends = [drawn[list(rod.between)].tolist() for rod in self.elements if rod.exists]
        along = tuple(((first[0], first[1]), (last[0], last[1])) for first, last in ends)
        return replace(made, along=along) if made is not None else None


class DrawSpanLoad(DrawArrow):
    """A force at a place of a rod; after a second click on the rod, one that is distributed up to there; along all of it,
    where kN/m are typed."""

    tool, field = "span load", "force"
    asks = marked("load on {rods}: click where its arrow ends, or on the rod where a distributed load ends")
    says = marked("{rods}: {load}, {place} from its start")

    def __init__(self, context: Context, pixel: Vector, rod: Rod) -> None:
        self.places = [along(context, rod, pixel)]
        super().__init__(context, context.view.camera.to_model(pixel), rod)

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        rod = None if context.view.covers(pixel) else pick_rod(context.model, context.view, pixel)
        return None if rod is None else cls(context, pixel, rod)

    @property
    def _field(self) -> Field[Any]:
        found: Field[Any] = getattr(SpanLoad, self.field)
        return found

    def start(self, context: Context) -> Vector:
        """Where the arrow begins (m): at the last place on the rod, as it is drawn."""
        return self._at(self.places[-1])

    def _at(self, place: float) -> Vector:
        return place_at(self.elements[0], place / self.elements[0].original_length)

    def finish(self, context: Context, pixel: Vector) -> None:
        place, on_rod = along(context, self.elements[0], pixel), pick_rod(context.model, context.view, pixel)
        if len(self.places) == 1 and self._per_length():
            self.places = [0.0, float(self.elements[0].original_length)]
            self.field = SpanLoad.end_intensity.name
        if self.typed or len(self.places) > 1 or on_rod is not self.elements[0] or place in self.places:
            super().finish(context, pixel)
            return
        self.places.append(place)
        self.field = SpanLoad.end_intensity.name
        self.hint = joined([tr("distributed load: click where its arrow ends"), tr("Esc cancel")], BETWEEN)

    def _per_length(self) -> bool:
        """True if what is typed has a unit of force per length, for which a number alone, or none, does not pass."""
        try:
            typed = vector(self.typed, SpanLoad.end_intensity.unit, self.unit[1], (math.nan, math.nan), UP)
        except FieldError:
            return False
        return all(map(math.isfinite, typed))

    def drop(self, context: Context, pixel: Vector) -> None:
        value, [rod] = self.value(context, pixel), self.elements
        start, *end = sorted(self.places)
        fields = (self.field, *[SpanLoad.start_intensity.name] * len(end))
        where: dict[str, Any] = {"start": [start], "end": end or [None]}
        where["case"] = [alone(context.model) or PERMANENT]
        context.model.create(SpanLoad, 1, rod=[rod.row], **where, **{field: [value] for field in fields})
        context.select(rod)
        place = " … ".join(written.length(x, written.DIGITS) for x in (start, *end))
        context.notice = tr(self.says, rods=begun(rod.said), load=self.shown(value), place=place)

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        made = super().preview(context, pixel)
        along = list(map(self._at, self.places))
        if made is None or len(along) == 1:
            return made
        return replace(made, kind="distributed force", along=((along[0], along[1]),))


class DrawMoment(DrawArrow):
    """The constant moment on a particle or at a place of a rod: to the left counter-clockwise, to the right clockwise."""

    tool, field = "moment", "moment"
    asks = marked("moment on {particle}: click at its left (counter-clockwise) or right")
    says = marked("Moment on {particle}: {value}")

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        return super().begin(context, pixel) or DrawSpanMoment.begin(context, pixel)

    def __init__(self, context: Context, particle: Particle) -> None:
        if not rigid_joints(context.model)[particle.row]:
            raise Refusal(
                "A moment cannot act on {particle}, where no rod is rigidly joined. Ctrl+J makes the end of a rod"
                " rigid.",
                particle=particle.said,
            )
        super().__init__(context, particle)

    def value(self, context: Context, pixel: Vector) -> float:
        if self.typed:
            return number(self.typed, *self.unit)
        x, _ = DrawArrow.value(self, context, pixel)
        return -float(x) + 0.0

    def shown(self, value: float) -> str:
        way = tr("counter-clockwise") if value > 0.0 else tr("clockwise") if value < 0.0 else ""
        return joined([written.stated(abs(value), self._field.shown[0]), way], ", ")

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        value, start = self.value(context, pixel), self.start(context)
        x, _ = arrow_end(context.view, start, (-value, 0.0), self._scale(context)) if value else start
        return Preview("moment", start, (x, start[1]), self.shown(value))


class DrawSpanMoment(DrawSpanLoad):
    """A moment at a place of a rod."""

    tool, field = "moment", "moment"
    asks = marked("moment on {rods}: click at its left (counter-clockwise) or right")
    value, shown, preview = DrawMoment.value, DrawMoment.shown, DrawMoment.preview
    finish = Drawing.finish


class DrawVelocity(DrawArrow):
    """The velocity of a particle; zero where it is held."""

    tool, field = "velocity", "velocity"
    asks = marked("velocity of {particle}: click where its arrow ends (or V)")
    says = marked("Velocity of {particle}: {value}")

    def __init__(self, context: Context, particle: Particle) -> None:
        if all(particle.fixed):
            raise Refusal(
                "{particle} is held in x and y and cannot move; C changes its support.", particle=particle.said
            )
        super().__init__(context, particle)

    def value(self, context: Context, pixel: Vector) -> Vector:
        x, y = super().value(context, pixel)
        held = self.elements[0].fixed
        return 0.0 if held[0] else x, 0.0 if held[1] else y


class DrawElement(Drawing):
    """An element of a mod's kind, from one of its points to the next.

    placed: its points (m) before the one where the present piece begins.
    """

    kind: ClassVar[type[Handle]]
    key: ClassVar[str]

    @classmethod
    def of(cls, kind: type[Handle], tool: str, key: str) -> type[DrawElement]:
        """The drawing of elements of a kind, by a tool and its key."""
        return type(f"Draw{kind.__name__}", (cls,), {"kind": kind, "tool": tool, "key": key})

    def __init__(self, context: Context, origin: Particle | Vector) -> None:
        super().__init__(context, origin)
        self.placed: list[Vector] = []
        named = {"element": tr(self.kind.noun), "key": self.key.upper()}
        if self.kind.points[2:]:
            self.hint = tr("{element}: click its further points (or {key})     Esc cancel", **named)
        else:
            self.hint = tr("{element}: click where it ends (or {key})     Esc cancel", **named)

    @classmethod
    def begin(cls, context: Context, pixel: Vector) -> Drawing | None:
        if context.view.strip.contains(pixel):
            return None
        return cls(context, cls.place(context, pixel))

    @classmethod
    def place(cls, context: Context, pixel: Vector) -> Vector:
        """The point (m) that a click at a pixel gives."""
        return snapped_to_points(context.model, context.view, pixel, cls.kind)

    @classmethod
    def use(cls, context: Context, pixel: Vector) -> None:
        """The action of the tool; an element with one point is where it is clicked."""
        if cls.kind.points[1:]:
            super().use(context, pixel)
        elif context.view.strip.contains(pixel):
            take_up(context, cls.tool)
        else:
            point = cls.place(context, pixel)
            cls._make(context, [point], written.place(point, written.DIGITS))

    @classmethod
    def _make(cls, context: Context, points: list[Vector], said: str) -> None:
        with context.model.transaction(tr("new {noun}", noun=tr(cls.kind.noun))):
            [made] = context.model.create(
                cls.kind, 1, **{name: [at] for name, at in zip(cls.kind.points, points, strict=True)}
            )
        context.select(made)
        tell(context, said, made)

    def drop(self, context: Context, pixel: Vector) -> None:
        start, end = self.start(context), self._ending(context, pixel)
        if end == start:
            raise Refusal(
                "The {element} would begin and end at the same point; click another point.",
                element=tr(self.kind.noun),
            )
        points = [*self.placed, start, end]
        if len(points) < len(self.kind.points):
            self.placed, self.origin, self.typed = points[:-1], end, ""
            return
        self.placed = []
        self._make(context, points, _length_and_angle(start, end))

    def following(self, context: Context) -> Drawing | None:
        return self if self.placed else None

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        start, end = self.start(context), self._ending(context, pixel)
        return Preview("rod", start, end, _length_and_angle(start, end), before=tuple(self.placed))

    def _ending(self, context: Context, pixel: Vector) -> Vector:
        return self.end_typed(context, self.place(context, pixel))


class TypePoint(Drawing):
    """The coordinates of the place where a tool begins, typed before anything is drawn.

    act: what the tool does there.
    """

    hint = marked("type x; y     Return accept     Esc cancel")

    def __init__(self, context: Context, tool: str, act: Callable[[Vector], Drawing | None]) -> None:
        super().__init__(context, (0.0, 0.0))
        self.tool, self._act = tool, act

    def end_typed(self, context: Context, pointed: Vector) -> Vector:
        return vector(self.typed, *self.unit, pointed)

    def finish(self, context: Context, pixel: Vector) -> None:
        """Let the tool act there."""
        context.gesture = self._act(self.end_typed(context, context.view.camera.to_model(pixel)))

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        point = self.end_typed(context, context.view.camera.to_model(pixel))
        return Preview("rod", point, point, written.place(point, written.DIGITS))


def along(context: Context, rod: Rod, pixel: Vector, step: float = 0.0) -> float:
    """How far from its start (m) a pixel lies on a rod, at a line of the grid if one is near.

    step: else in round steps of at most so many points.
    """
    camera, point = context.view.camera, context.view.camera.to_model(pixel)
    on_grid = snapped(context.model, context.view, point)
    free = not step or math.dist(on_grid, point) * camera.scale > 1.0
    apart = 0.001 if free else round_down(step * context.view.pixel_ratio / camera.scale)
    place = min(max(share_at(rod, on_grid), 0.0), 1.0) * rod.original_length
    return min(tidy(round(place / apart) * apart), rod.original_length)


def _length_and_angle(start: Vector, end: Vector) -> str:
    angle = math.degrees(math.atan2(end[1] - start[1], end[0] - start[0])) + 0.0
    return f"{written.length(math.dist(start, end), written.DIGITS)}, {written.given(angle, 4)}°"


def scale_said(context: Context, field: Field[Any]) -> str:
    """The scale of the arrows of a Field, for the status line."""
    unit, factor = field.shown
    points = STEP * arrow_scale(context.model, context.view, field.name)
    return tr("{points:g} px = {value}", points=STEP, value=written.stated(factor * points, unit))


def onto_member(context: Context, pixel: Vector, start: Vector = (math.inf, math.inf)) -> Vector:
    """The point (m) under a pixel: on the grid or level with a start if near it, and on the member there if rods join it."""
    model, view = context.model, context.view
    point = snapped(model, view, view.camera.to_model(pixel), start)
    rod = pick_rod(model, view, pixel) if view.joins and not view.covers(pixel) else None
    return point if rod is None or not rod.bending_stiffness else place_at(rod, share_at(rod, point))


class DrawSupport(Drawing):
    """The support of a particle, or of all selected particles if it is one of them.

    A drag that ends on the particle counts as a click, which takes the next kind of support.
    """

    tool = "support"

    def __init__(self, context: Context, particle: Particle) -> None:
        super().__init__(context, particle)
        self.particle, selected = particle, context.model.tagged(Selected, Particle)
        self._particles = selected if particle in selected else [particle]
        self._turns = bool(rigid_joints(context.model)[particle.row])
        farther = tr("farther away: cannot turn, too") if self._turns else ""
        steps = tr("ground below or above: held in y     at a side: held in x     in between: held in both")
        self.hint = joined([steps, farther, tr("Esc cancel")], BETWEEN)

    def drop(self, context: Context, pixel: Vector) -> None:
        wanted = self._wanted(context, pixel)
        particles = [particle for particle in self._particles if particle.exists]
        name = (
            next_support(context.model, particles)
            if wanted is None
            else support(context.model, particles, wanted)
        )
        named, more = begun(heading(context.model, [self.particle])), len(particles) - 1
        named = tr("{element} and {count} more", element=named, count=more) if more > 0 else named
        context.notice = tr("{element}: {value}", element=named, value=tr(name))

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        """The symbol of the support on the side of the pointer, with its point on the rim of the particle."""
        along, wanted, (x, y) = self._along(context, pixel), self._wanted(context, pixel), self.start(context)
        if along is None or wanted is None:
            return None
        camera = context.view.camera
        level = abs(along[0]) > abs(along[1])
        side = (math.copysign(1.0, along[0]), 0.0) if level else (0.0, math.copysign(1.0, along[1]))
        rim = max(self.particle.radius, 5.0 * context.view.pixel_ratio / camera.scale)
        start = x + rim * side[0], y + rim * side[1]
        end = start[0] + side[0] / camera.scale, start[1] + side[1] / camera.scale
        symbols = ("guided", "clamped") if wanted[2] else ("roller", "pinned")
        return Preview(symbols[all(wanted[:2])], start, end, tr(SUPPORTS[wanted][1]))

    def _wanted(self, context: Context, pixel: Vector) -> Held | None:
        """What a ground at a pixel holds; None if the pixel lies on the particle."""
        along = self._along(context, pixel)
        if along is None:
            return None
        points = math.hypot(*along) * context.view.camera.scale / context.view.pixel_ratio
        return (*support_towards(along), self._turns and points > 60.0)  # far away also the rotation

    def _along(self, context: Context, pixel: Vector) -> Vector | None:
        """The vector from the particle to a pixel (m); None if the pixel lies on the particle."""
        start, end = self.start(context), context.view.camera.to_model(pixel)
        reach = PARTICLE_REACH * context.view.pixel_ratio / context.view.camera.scale
        along = end[0] - start[0], end[1] - start[1]
        return along if math.hypot(*along) > max(reach, self.particle.radius) else None


def take_up(context: Context, tool: str) -> None:
    """Let clicks use a tool from now on; if they use it already, put it away."""
    context.leave_gesture()
    context.view.tool = "" if context.view.tool == tool else tool


def tool_in_hand(context: Context) -> str:
    """The tool with which clicks draw, or ""."""
    return context.gesture.tool if isinstance(context.gesture, Drawing) else context.view.tool
