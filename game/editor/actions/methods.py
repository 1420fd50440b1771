"""Actions of the guides through the force method and the displacement method."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.view import CONVENTIONS
from pinjoint.editor.actions.results import shows_diagrams
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.methods import Method
from pinjoint.systems.edit import Refusal, saving
from pinjoint.systems.edit.picking import pick
from pinjoint.systems.input.actions import (
    DISPLACEMENT_METHOD,
    FORCE_METHOD,
    METHODS,
    Condition,
    Perform,
    actions_of,
)

if TYPE_CHECKING:  # it imports scipy
    from pinjoint.methods.displacements import DisplacementGuide
    from pinjoint.methods.guide import ForceGuide

    Guide = ForceGuide | DisplacementGuide

action = actions_of("Methods", METHODS)
_OF_FORCE, _OF_DISPLACEMENT = (FORCE_METHOD,), (DISPLACEMENT_METHOD,)


def _guided(act: Callable[[Context, Any, Vector], object]) -> Perform:
    """An action with the guide, its announced work done; without one, as of a mechanism, it does nothing."""

    def perform(context: Context, pixel: Vector) -> None:
        scene = context.scenes.active
        if isinstance(scene, Method) and (guide := scene.guide) is not None:
            act(context, guide, pixel)

    return perform


def _where(condition: Callable[[Any], object]) -> Condition:
    """Whether there is a guide of which a condition is true."""
    return lambda context: (guide := getattr(context.scenes.active, "shown_guide", None)) and condition(guide)


def _work(context: Context, text: str, do: Callable[[], object]) -> None:
    scene = context.scenes.active
    assert isinstance(scene, Method)
    scene.work(context, text, do)


@action("next part", "k", "go to the next part")
@_guided
def _next_part(context: Context, guide: Guide, pixel: Vector) -> None:
    if guide.part == guide.parts:
        context.scenes.request(context.scenes.hub)
    elif guide.part == 2:
        guide.next()
    else:
        _work(context, tr("Computing part {part}", part=guide.part + 1), guide.next)


@action("part before", "b", "go back to the part before", enabled=_where(lambda guide: guide.part > 1))
@_guided
def _part_before(context: Context, guide: Guide, pixel: Vector) -> None:
    guide.back()


@action(
    "to the equations",
    "n",
    "leave out the other unknowns",
    _OF_DISPLACEMENT,
    enabled=_where(lambda guide: getattr(guide, "can_skip", False)),
)
@_guided
def _to_the_equations(context: Context, guide: DisplacementGuide, pixel: Vector) -> None:
    if guide.can_skip:
        guide.to_equations()


@action("pick unknown", "click", "show the stiffness of a rod", _OF_DISPLACEMENT)
@action(
    "pick unknown",
    "click",
    "choose the redundant in set 1",
    _OF_FORCE,
    enabled=_where(lambda guide: guide.part == 2),
)
@_guided
def _pick_unknown(context: Context, guide: Guide, pixel: Vector) -> None:
    if guide.part == 1 and context.scene == FORCE_METHOD:
        raise Refusal("Press K first: part 2 asks which rod or support to release.")
    if guide.part == 2 or guide.whole:
        _, view = context.stages[0]
        hit = pick(guide.sets[0].model, view, pixel) if view.camera.viewport.contains(pixel) else None
        near = view.camera.to_model(pixel)
        _work(context, tr("Releasing it and solving anew"), lambda: guide.pick(hit, near))


@action(
    "release another",
    "n",
    "release one more redundant",
    _OF_FORCE,
    enabled=_where(lambda guide: guide.can_release_another),
)
@_guided
def _release_another(context: Context, guide: ForceGuide, pixel: Vector) -> None:
    if not guide.can_release_another:
        raise Refusal(
            tr("Every unknown is released.")
            if guide.part == guide.parts
            else tr("Go through all parts first, with K.")
        )
    guide.release_another()


def _pick_axis(axis: int, context: Context, guide: ForceGuide, pixel: Vector) -> None:
    if axis == 2 and not guide.clamp_wanted:
        raise Refusal("Click a clamped support first; then M releases its moment.")
    _work(context, tr("Releasing it and solving anew"), lambda: guide.pick_axis(axis))


_AXIS = _where(lambda guide: guide.axis_wanted is not None)
action("release x", "x", "release the support along x", _OF_FORCE, enabled=_AXIS)(
    _guided(partial(_pick_axis, 0))
)
action("release y", "y", "release the support along y", _OF_FORCE, enabled=_AXIS)(
    _guided(partial(_pick_axis, 1))
)
action(
    "release moment",
    "m",
    "release the moment of the clamp",
    _OF_FORCE,
    enabled=_where(lambda guide: guide.clamp_wanted),
)(_guided(partial(_pick_axis, 2)))


@action("next convention", "c", "change the convention: textbook or thesis", _OF_FORCE)
def _next_convention(context: Context, pixel: Vector) -> None:
    """The textbook's convention, or the thesis'."""
    at = CONVENTIONS.index(context.view.convention) + 1
    context.view.convention = CONVENTIONS[at % len(CONVENTIONS)]
    if context.view.convention == CONVENTIONS[0]:
        context.notice = tr("Convention of textbooks: δ₁₀ + δ₁₁ X₁ = 0")
    else:
        context.notice = tr("Convention of the thesis: p = (Δ − Δ₀) / Δ₁")


@action(
    "report",
    "p",
    "save a report of the solution as a PDF",
    enabled=_where(lambda guide: guide.part == guide.parts),
)
def _report(context: Context, pixel: Vector) -> None:
    """Write the whole solution to a PDF beside the model (the last part)."""
    scene = context.scenes.active
    guide = getattr(scene, "guide", None)
    if guide is None or guide.part < guide.parts or guide.solution is None:
        raise Refusal("Go through all parts first, with K; then P writes the report.")
    if context.window is None:
        return
    from pinjoint.methods.report import report  # it imports reportlab

    with saving():
        made = report(guide.tables, context.view.convention)
        path = context.window.save(f"pinjoint-{scene.name.replace(' ', '-')}.pdf", made)
    context.notice = tr("Report saved: {file}", file=path)


@action("toggle diagrams of sets", "i", "show or hide force diagrams", pressed=shows_diagrams)
@_guided
def _toggle_diagrams(context: Context, guide: Guide, pixel: Vector) -> None:
    if guide.is_frame:
        guide.next_quantity()
    else:
        context.view.all_diagrams = not context.view.all_diagrams
        for one in guide.shown:
            one.view.all_diagrams = context.view.all_diagrams


action("back", "escape", "leave the method")(lambda context, pixel: context.scenes.request(context.scenes.hub))
