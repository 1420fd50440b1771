"""Actions of menus: going through one, and what they offer that no key does."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from operator import attrgetter

from pinjoint.components.field import Vector
from pinjoint.components.language import begun, marked, plural, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import HUBS
from pinjoint.components.tags import Selected
from pinjoint.components.view import drawn_at
from pinjoint.editor.context import Context, tell
from pinjoint.editor.scenes.methods import ForceMethod
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.dividing import DIVISIONS, divide, divide_at, several
from pinjoint.systems.edit.picking import pick_rod
from pinjoint.systems.edit.placing import snapped
from pinjoint.systems.edit.rods import share_at, weigh_along
from pinjoint.systems.edit.supports import SPRING, SUPPORTS, Held, held, is_elastic, put_on_springs, support
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.input.actions import ACTIONS, FORCE_METHOD, MENU, Condition, Perform, actions_of
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.menu import entry_beside, pointed_at

action = actions_of("Menu", (MENU,), while_drawing=True, in_menu=True)
offer = actions_of("Menu")  # without a key


def _to_entry(down: int, right: int, context: Context, pixel: Vector) -> None:
    """An arrow key in an open menu."""
    view, menu = context.view, context.view.menu
    if menu is not None:
        theme = load_theme(view.theme)
        here, count = pointed_at(view, theme, pixel), len(menu.entries)
        along = here + 1 if down > 0 else max(here, 0) - 1
        chosen = entry_beside(view, theme, here, right) if right else along % count
        view.menu = replace(menu, chosen=chosen, pointed=pixel)


action("menu up", "up", "go to the entry above", repeats=True)(partial(_to_entry, -1, 0))
action("menu down", "down", "go to the entry below", repeats=True)(partial(_to_entry, 1, 0))
action("menu left", "left", "go to the column on the left", repeats=True)(partial(_to_entry, 0, -1))
action("menu right", "right", "go to the column on the right", repeats=True)(partial(_to_entry, 0, 1))
# A press that comes to no entry, or to one that would do nothing; others perform the action of the entry.
action("choose entry", "return", "choose the entry")(lambda context, pixel: None)
action("choose entry", "click", "choose the entry; outside, close the menu")(ACTIONS["choose entry"].perform)
action("close menu", "escape", "close the menu", in_menu=False)(
    lambda context, pixel: setattr(context.view, "menu", None)
)


@offer("environment", "", "open the properties of the environment")
def _environment(context: Context, pixel: Vector) -> None:
    context.select()
    ACTIONS["properties"].perform(context, pixel)


@offer(
    "follow",
    "",
    "let the view follow it",
    pressed=lambda context: context.view.followed is not None and context.view.followed[0] in context.selected,
)
def _follow(context: Context, pixel: Vector) -> None:
    """Let the view go with the selected particle, or, if it does so, stay where it is."""
    (particle, *_), view = _particles(context), context.view
    stays = view.followed is not None and view.followed[0] is particle
    view.followed, view.fitted = None if stays else (particle, drawn_at(context.model, particle)), False


def _particles(context: Context) -> list[Particle]:
    particles = context.model.tagged(Selected, Particle)
    if not particles:
        raise Refusal("No particle is selected; click one first.")
    return particles


def _are_held(wanted: Held, context: Context) -> bool:
    """Whether all selected particles have a support."""
    particles = context.model.tagged(Selected, Particle)
    return bool(particles) and all(held(one) == wanted and not is_elastic(one) for one in particles)


def _hold(wanted: Held, context: Context, pixel: Vector) -> None:
    """Give all selected particles a support."""
    particles = _particles(context)
    tell(context, tr(support(context.model, particles, wanted)), *particles)


for _wanted, (_name, _title) in SUPPORTS.items():
    _title = _title if any(_wanted) else marked("free: no support")
    offer(_name, "", _title, pressed=partial(_are_held, _wanted))(partial(_hold, _wanted))


@offer(
    "springs",
    "",
    "elastic: held by springs",
    pressed=lambda context: {is_elastic(one) for one in context.model.tagged(Selected, Particle)} == {True},
)
def _springs(context: Context, pixel: Vector) -> None:
    """Let springs hold the selected particles or, if all do so, rigid supports."""
    particles = _particles(context)
    tell(context, put_on_springs(context.model, particles), *particles)


@offer(
    "end springs",
    "",
    "springs at both ends",
    pressed=lambda context: {any(one.end_springs) for one in context.model.tagged(Selected, Rod)} == {True},
)
def _end_springs(context: Context, pixel: Vector) -> None:
    """Join the ends of the selected rods by springs or, if all have some, as before."""
    rods = _selected(context)
    back = all(any(rod.end_springs) for rod in rods)
    context.model.assign(rods, "end_springs", [(0.0, 0.0) if back else (SPRING, SPRING)] * len(rods))
    tell(context, tr("no springs at its ends") if back else tr("joined by springs"), *rods)


def _selected(context: Context) -> list[Rod]:
    rods = context.model.tagged(Selected, Rod)
    if not rods:
        raise Refusal("No rod is selected; click one first.")
    return rods


@offer("split", "", "divide the rod here")
def _split(context: Context, pixel: Vector) -> None:
    """Divide the rod under the pointer there, at a line of the grid if one is near."""
    rod = pick_rod(context.model, context.view, pixel)
    if rod is None:
        raise Refusal("There is no rod under the pointer; point at one.")
    name = begun(heading(context.model, [rod]))
    point = snapped(context.model, context.view, context.view.camera.to_model(pixel))
    parts = divide_at(context.model, rod, [round(share_at(rod, point), 6)])
    context.select(parts[0].ends[1])
    context.notice = tr("{rod}: divided at {particle}", rod=name, particle=parts[0].ends[1].name)


@offer("divide at hinges", "", "divide members where hinges form between their ends")
def _divide_at_hinges(context: Context, pixel: Vector) -> None:
    """Divide members where limit analysis has plastic hinges between their ends, so that load steps find them, too."""
    model, limit = context.model, context.document.statics.limit_load
    if limit is None or not limit.between:
        raise Refusal("No plastic hinge forms between the ends of a member.")
    places: dict[int, list[float]] = {}
    for section, _ in limit.between:
        places.setdefault(section.row, []).append(section.share)
    rods = {model.rods[row]: sorted(shares) for row, shares in places.items()}
    with model.transaction(tr("divide {rods}", rods=several(model, [*rods]))):
        parts = [part for rod, shares in rods.items() for part in divide_at(model, rod, shares)]
    added = len(parts) - len(rods)
    context.notice = plural(
        "{count} particle added where a plastic hinge forms",
        "{count} particles added where plastic hinges form",
        added,
    )


@offer("weight along", "", "add its weight as a distributed load", enabled=attrgetter("model.rods.count"))
def _weight_along(context: Context, pixel: Vector) -> None:
    """Let the selected rods, without any all, bear their weight along them."""
    context.notice = weigh_along(context.model, context.model.tagged(Selected, Rod) or list(context.model.rods))


@offer("clear span loads", "", "remove the loads between its ends")
def _clear_span_loads(context: Context, pixel: Vector) -> None:
    """Delete what acts between the ends of the selected rods, but for forces distributed all along."""
    rods = {rod.row for rod in _selected(context)}
    context.model.delete([load for load in context.model.span_loads if load.rod in rods])


def _toggle(field: str, on: str, off: str) -> Perform:
    """What gives all selected rods a property or, if all have it, takes it away, and says so."""

    def toggle(context: Context, pixel: Vector) -> None:
        rods = _selected(context)
        given = not all(getattr(rod, field) for rod in rods)
        context.model.assign(rods, field, given)
        tell(context, tr(on) if given else tr(off), *rods)

    return toggle


def _all_are(field: str) -> Condition:
    return lambda context: {getattr(rod, field) for rod in context.model.tagged(Selected, Rod)} == {True}


offer("toggle cable", "", "cable: tension only", pressed=_all_are("tension_only"))(
    _toggle("tension_only", marked("tension only, as a cable"), marked("tension and compression"))
)
offer(
    "toggle strut",
    "",
    "strut that buckles between its hinges",
    enabled=lambda context: any(
        rod.bending_stiffness > 0.0 and not any(rod.fixity) for rod in context.model.tagged(Selected, Rod)
    ),
    pressed=_all_are("buckles"),
)(
    _toggle(
        "buckles",
        marked("buckles between its hinges at π² EI/L²"),
        marked("does not buckle between its hinges"),
    )
)
offer("toggle inextensible", "", "inextensible in first-order theory", pressed=_all_are("inextensible"))(
    _toggle("inextensible", marked("inextensible in first-order theory"), marked("extensible, by its EA"))
)


def _divide(parts: int, context: Context, pixel: Vector) -> None:
    """Divide the selected rods, and select their parts."""
    rods = _selected(context)
    named = begun(heading(context.model, rods))
    context.select(*divide(context.model, rods, parts))
    context.notice = (
        tr("{rod}: divided into {parts} parts", rod=named, parts=parts)
        if len(rods) == 1
        else tr("{rods}: each divided into {parts} parts", rods=named, parts=parts)
    )


for _parts, _title in DIVISIONS.items():
    offer(
        _title,
        "",
        _title,
        enabled=lambda context: any(rod.bending_stiffness > 0.0 for rod in context.model.tagged(Selected, Rod)),
    )(partial(_divide, _parts))


@offer("release", "", "release it in the force method", HUBS)
def _release(context: Context, pixel: Vector) -> None:
    """Begin the force method with the selected rod as the static unknown."""
    rods, scene = context.model.tagged(Selected, Rod), context.scenes[FORCE_METHOD]
    if len(rods) != 1:
        raise Refusal("Select one rod only: the one that is to be released.")
    assert isinstance(scene, ForceMethod)
    scene.first_unknown = rods[0].name
    context.scenes.request(FORCE_METHOD)
