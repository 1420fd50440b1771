"""Actions that show results: diagrams, utilisation, theory, energies, shapes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from operator import attrgetter

from pinjoint.components.bent import AXIAL, is_frame
from pinjoint.components.cases import acting, choices
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.load import Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, has_strength
from pinjoint.components.settings import DIAGRAMS, HUBS, PAUSE, STATICS
from pinjoint.components.tags import DiagramShown, Selected
from pinjoint.components.theory import EXACT, FIRST_ORDER
from pinjoint.editor.actions.view import toggle
from pinjoint.editor.context import Context
from pinjoint.editor.readouts import pinned
from pinjoint.editor.sliders import add_slider
from pinjoint.systems.edit import Refusal
from pinjoint.systems.forms.properties import COMBINATION
from pinjoint.systems.input.actions import (
    ACTIONS,
    DISPLACEMENT_METHOD,
    FORCE_METHOD,
    SIMULATION,
    TABLE,
    actions_of,
)
from pinjoint.systems.render.model.diagrams import NAMES

action = actions_of("Results", while_drawing=True)


def shows_diagrams(context: Context) -> bool:
    """True if there are diagrams of what is selected, else of anything."""
    if context.model.any_tagged(Selected) and not context.view.all_diagrams:
        shown = {handle.entity for handle in context.model.tagged(DiagramShown)}
        return {handle.entity for handle in context.model.tagged(Selected, Particle, Rod)} <= shown
    return context.view.all_diagrams or context.model.any_tagged(DiagramShown)


def _quantity(context: Context) -> tuple[str, str]:
    """Icon and title of the button while diagrams are shown; where rods bend, of which quantity."""
    quantity = context.view.quantity
    if not is_frame(context.model):
        return "", ""
    return f"diagram {quantity}", tr("diagrams, now: {quantity}", quantity=tr(NAMES[quantity]))


# Diagrams, utilisation and shapes are not seen while rods and joints are apart.
@action(
    "toggle diagrams",
    "i",
    "show or hide force diagrams (N, M, V)",
    pressed_as=_quantity,
    pressed=lambda context: not context.view.free_bodies and shows_diagrams(context),
)
def _toggle_diagrams(context: Context, pixel: Vector) -> None:
    """The diagrams of the selected particles and rods; of all when nothing is selected, or all are shown.

    Where rods bend, those of N, M and V follow one another before there are none.
    """
    model, view = context.model, context.view
    apart = view.put_together()
    if apart and (view.all_diagrams or model.any_tagged(DiagramShown)):
        return
    if view.all_diagrams or not context.model.any_tagged(Selected):
        view.all_diagrams = _following(context, view.all_diagrams)
        model.tag_only([], DiagramShown)
        return
    chosen = {handle.entity: handle for handle in context.selected if isinstance(handle, Particle | Rod)}
    shown = {handle.entity: handle for handle in model.tagged(DiagramShown)}
    shows = _following(context, chosen.keys() <= shown.keys())
    others = [shown[entity] for entity in shown.keys() - chosen.keys()]
    model.tag_only([*others, *chosen.values()] if shows else others, DiagramShown)


def _following(context: Context, shown: bool) -> bool:
    """Whether diagrams are shown after this, of the next quantity where rods bend."""
    view, last = context.view, DIAGRAMS[-1]
    if not is_frame(context.model):
        return not shown
    if shown and view.quantity == last:
        return False
    view.quantity = DIAGRAMS[DIAGRAMS.index(view.quantity) + 1] if shown else AXIAL
    context.notice = tr("{quantity}. Press I for the next.", quantity=begun(tr(NAMES[view.quantity])))
    return True


action(
    "toggle statics",
    "q",
    "statics: the equilibrium",
    pressed=lambda context: context.scenes.hub == STATICS and context.scene != SIMULATION,
    while_drawing=False,
)(lambda context, pixel: context.scenes.request_from_pause(PAUSE if context.scene == STATICS else STATICS))


@action(
    "next theory",
    "z",
    "theory: first order or exact",
    (STATICS,),
    pressed=lambda context: context.model.settings.theory == EXACT,
    while_drawing=False,
)
def _next_theory(context: Context, pixel: Vector) -> None:
    """First-order theory, or exact geometry."""
    settings = context.model.settings
    settings.theory = FIRST_ORDER if settings.theory == EXACT else EXACT
    context.notice = (
        tr("First-order theory: forces act on the original shape, as in a course.")
        if settings.theory == FIRST_ORDER
        else tr("Exact: forces act on the deformed shape, however far it moves.")
    )


action(
    "toggle undeformed",
    "y",
    "shape: undeformed or deformed",
    (STATICS,),
    pressed=attrgetter("model.settings.original_diagrams"),
    while_drawing=False,
)(toggle("original_diagrams", "settings"))
action("toggle free bodies", "x", "show or hide free-body diagrams", pressed=attrgetter("view.free_bodies"))(
    toggle("free_bodies")
)


@action(
    "toggle utilisation",
    "a",
    "show or hide utilisation of strength",
    pressed=lambda context: context.view.utilisation and not context.view.free_bodies,
)
def _toggle_utilisation(context: Context, pixel: Vector) -> None:
    """Show how much of its strength each rod bears, or hide it."""
    view = context.view
    if not view.utilisation and not has_strength(context.model):
        raise Refusal(
            "No rod has a strength yet. Select rods, press Return, and type in a tensile or compressive strength."
        )
    view.utilisation = view.put_together() or not view.utilisation


for _panel, _key, _title in (
    ("theory", "m", marked("show or hide comparison with theory")),
    ("energy", "j", marked("show or hide energies")),
    ("events", "ctrl+h", marked("show or hide the list of events")),
    (TABLE, "n", marked("show or hide the table of results")),
):
    action(
        f"toggle {_panel}", _key, _title, pressed=lambda context, panel=_panel: panel in context.view.wanted
    )(lambda context, pixel, panel=_panel: setattr(context.view, "wanted", context.view.wanted ^ {panel}))


@action(
    "next shape",
    "b",
    "show mechanisms, buckling, vibration modes",
    pressed=lambda context: context.view.shape is not None and not context.view.free_bodies,
)
def _next_shape(context: Context, pixel: Vector) -> None:
    """Show the next mechanism, buckling mode or natural mode; after the last, none."""
    if context.view.put_together() and context.view.shape is not None:
        return
    context.document.shapes.next()
    context.view.shape = shown = context.document.shapes.shown
    context.notice = shown.note if shown is not None else ""


@action(
    "next influence line",
    "ctrl+i",
    "influence lines; along several rods: a moving force",
    while_drawing=False,
    enabled=attrgetter("selected"),
)
def _next_influence_line(context: Context, pixel: Vector) -> None:
    """The next influence line of what is selected: N, M and V of a rod, at the place where it was clicked in statics, else
    at its ends and in its middle, and then what a force does that moves along it; reactions or displacements of a particle.
    Of several rods, what a force does that moves along all of them."""
    from pinjoint.documents.influence import lines_of  # it imports scipy

    chosen, shapes = context.selected, context.document.shapes
    path = tuple(handle for handle in chosen if isinstance(handle, Rod))
    if len(path) != len(chosen) > 1 or not any(isinstance(handle, Particle | Rod) for handle in chosen):
        raise Refusal(
            "Select one rod or one particle first, whose influence lines this draws, one after the other, or several rods,"
            " along which a force moves."
        )
    if (moves := context.view.path == path != ()) or len(path) > 1:
        _let_move(context, () if moves else path)
        return
    if context.view.path:
        _let_move(context, ())
    pin = pinned(context)
    found = lines_of(context.model, chosen[0], None if pin is None else pin.distance)
    shapes.go_through(lambda: found, begins=shapes.shown not in found)
    context.view.shape = shapes.shown
    if path and shapes.shown is None and context.scene == STATICS:
        _let_move(context, path)


def _let_move(context: Context, path: tuple[Rod, ...]) -> None:
    """Show the envelope of a force that moves along a path; (): no more."""
    if path and context.scene != STATICS:
        raise Refusal("What a force does that moves along several rods is shown in statics; press Q first.")
    context.view.envelope, context.view.path = bool(path), path
    context.document.shapes.hide()


@action("new slider", "ctrl+l", "add a slider for selected load or stiffness", while_drawing=False)
def _new_slider(context: Context, pixel: Vector) -> None:
    """A slider for what is moved most of the selected elements: their load, their stiffness."""
    chosen = context.selected
    for kind in (Load, Particle, Rod):
        elements = [handle for handle in chosen if isinstance(handle, kind)]
        if elements:
            add_slider(context, *_usual(context.model, elements))
            return
    raise Refusal("Select a particle or a rod first; then this makes a slider for its load or its stiffness.")


def _usual(model: Model, elements: Sequence[Handle]) -> tuple[Sequence[Handle], str, str]:
    """Elements, and their Field and axis that people move most."""
    first = elements[0]
    if isinstance(first, Rod) and not any(first.distributed_force):
        for load in (load for load in model.span_loads if load.rod == first.row):
            for field in ("force", "end_intensity", "start_intensity"):
                x, y = getattr(load, field)
                if x or y:
                    return [load], field, "x" if abs(x) > abs(y) else "y"
            if load.moment:
                return [load], "moment", ""
        return elements, "bending_stiffness" if first.bending_stiffness else "stiffness", ""
    if isinstance(first, Particle) and not any(first.force):
        loads = [load for load in model.loads if load.on == first.row]
        elements, first = (loads[:1], loads[0]) if loads else (elements, first)
    field = "distributed_force" if isinstance(first, Rod) else "force"
    x, y = getattr(first, field)
    return elements, field, "x" if abs(x) > abs(y) else "y"


@action("next combination", "ctrl+g", "what acts: all cases, combinations, single cases", while_drawing=False)
def _next_combination(context: Context, pixel: Vector) -> None:
    """Let the next combination or load case act; after the last, the envelope in statics, then all cases again."""
    names, settings = choices(context.model), context.model.settings
    if not names:
        raise Refusal(
            "There is one load case only. The boxes of a load say its case: select what bears it and press Return."
        )
    following = 0 if context.view.envelope else names.index(settings.combination) + 1
    if following == len(names) and settings.combinations and context.scene == STATICS:
        context.view.envelope = True
    else:
        _let_act(context, names[following % len(names)])


@action("show combination")
def _show_combination(context: Context, pixel: Vector) -> None:
    """The one whose button was pressed."""
    if context.view.pressed is not None:
        _let_act(context, choices(context.model)[context.view.pressed.item])


def _let_act(context: Context, name: str) -> None:
    context.view.envelope, context.view.path = False, ()
    context.model.settings.combination = name
    if not context.view.legend:
        context.notice = acting(context.model)


@action("toggle envelope", pressed=lambda context: context.view.envelope and not context.view.path)
def _toggle_envelope(context: Context, pixel: Vector) -> None:
    """That of all combinations."""
    context.view.envelope, context.view.path = not context.view.envelope or bool(context.view.path), ()


@action("edit combinations", "", "load combinations", while_drawing=False)
def _edit_combinations(context: Context, pixel: Vector) -> None:
    """The boxes of all combinations, in which a new one is named first."""
    context.select()
    ACTIONS["properties"].perform(context, pixel)
    context.scenes.apply(context)
    context.scenes.active.click_box(context, COMBINATION)


def _method(name: str, context: Context, pixel: Vector) -> None:
    """Begin a method, from the other one too."""
    if context.model.particles.count == 0:
        raise Refusal("There is nothing to solve yet; draw a structure with P and L, or open one with D.")
    context.scenes.request(name)


_solved = {"while_drawing": False, "enabled": attrgetter("model.rods.count")}
_by_forces, _by_displacements = partial(_method, FORCE_METHOD), partial(_method, DISPLACEMENT_METHOD)
action("force method", "k", "force method", HUBS, **_solved)(_by_forces)
action("force method", "ctrl+k", "force method", (DISPLACEMENT_METHOD,))(_by_forces)
action("displacement method", "ctrl+k", "displacement method", (*HUBS, FORCE_METHOD), **_solved)(
    _by_displacements
)
