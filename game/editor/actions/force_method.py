"""Actions of the force method's guide."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.view import CONVENTIONS
from pinjoint.editor.actions.results import shows_diagrams
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.force_method import ForceMethod
from pinjoint.force_method import PARTS
from pinjoint.systems.edit import Refusal, saving
from pinjoint.systems.edit.picking import pick
from pinjoint.systems.input.actions import FORCE_METHOD, Condition, Perform, actions_of

if TYPE_CHECKING:  # it imports scipy
    from pinjoint.force_method.guide import Guide

action = actions_of("Force method", (FORCE_METHOD,))


def _guided(act: Callable[[Context, Guide, Vector], object]) -> Perform:
    """An action with the guide, its announced work done; without one, as of a mechanism, it does nothing."""

    def perform(context: Context, pixel: Vector) -> None:
        scene = context.scenes.active
        if isinstance(scene, ForceMethod) and (guide := scene.guide) is not None:
            act(context, guide, pixel)

    return perform


def _where(condition: Callable[[Guide], bool]) -> Condition:
    """Whether there is a guide of which a condition is true."""
    return lambda context: (guide := getattr(context.scenes.active, "shown_guide", None)) and condition(guide)


def _work(context: Context, text: str, do: Callable[[], object]) -> None:
    scene = context.scenes.active
    assert isinstance(scene, ForceMethod)
    scene.work(context, text, do)


@action("next part", "k", "go to the next part")
@_guided
def _next_part(context: Context, guide: Guide, pixel: Vector) -> None:
    if guide.part == PARTS:
        context.scenes.request(context.scenes.hub)
    elif guide.part == 2:
        guide.next()
    else:
        _work(context, tr("Computing part {part}", part=guide.part + 1), guide.next)


@action("pick unknown", "click", "choose the redundant in set 1", enabled=_where(lambda guide: guide.part == 2))
@_guided
def _pick_unknown(context: Context, guide: Guide, pixel: Vector) -> None:
    if guide.part == 1:
        raise Refusal("Press K first: part 2 asks which rod or support to release.")
    if guide.part == 2:
        _, view = context.stages[0]
        hit = pick(guide.sets[0].model, view, pixel) if view.camera.viewport.contains(pixel) else None
        near = view.camera.to_model(pixel)
        _work(context, tr("Releasing it and solving anew"), lambda: guide.pick(hit, near))


@action(
    "release another",
    "n",
    "release one more redundant",
    enabled=_where(lambda guide: guide.can_release_another),
)
@_guided
def _release_another(context: Context, guide: Guide, pixel: Vector) -> None:
    if not guide.can_release_another:
        raise Refusal(
            tr("Every unknown is released.")
            if guide.part == PARTS
            else tr("Go through all parts first, with K.")
        )
    guide.release_another()


def _pick_axis(axis: int, context: Context, guide: Guide, pixel: Vector) -> None:
    if axis == 2 and not guide.clamp_wanted:
        raise Refusal("Click a clamped support first; then M releases its moment.")
    _work(context, tr("Releasing it and solving anew"), lambda: guide.pick_axis(axis))


_AXIS = _where(lambda guide: guide.axis_wanted is not None)
_CLAMP = _where(lambda guide: guide.clamp_wanted)
action("release x", "x", "release the support along x", enabled=_AXIS)(_guided(partial(_pick_axis, 0)))
action("release y", "y", "release the support along y", enabled=_AXIS)(_guided(partial(_pick_axis, 1)))
action("release moment", "m", "release the moment of the clamp", enabled=_CLAMP)(
    _guided(partial(_pick_axis, 2))
)


@action("next convention", "c", "change the convention: textbook or thesis")
def _next_convention(context: Context, pixel: Vector) -> None:
    """The textbook's convention, or the thesis'."""
    at = CONVENTIONS.index(context.view.convention) + 1
    context.view.convention = CONVENTIONS[at % len(CONVENTIONS)]
    if context.view.convention == CONVENTIONS[0]:
        context.notice = tr("Convention of textbooks: δ₁₀ + δ₁₁ X₁ = 0")
    else:
        context.notice = tr("Convention of the thesis: p = (Δ − Δ₀) / Δ₁")


@action(
    "report", "p", "save a report of the solution as a PDF", enabled=_where(lambda guide: guide.part == PARTS)
)
def _report(context: Context, pixel: Vector) -> None:
    """Write the whole solution to a PDF beside the model (part 7)."""
    guide = getattr(context.scenes.active, "guide", None)
    if guide is None or guide.part < PARTS or guide.solution is None:
        raise Refusal("Go through all parts first, with K; then P writes the report.")
    if context.window is None:
        return
    from pinjoint.force_method.report import report  # it imports reportlab

    with saving():
        path = context.window.save("pinjoint-force-method.pdf", report(guide.tables, context.view.convention))
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


action("back", "escape", "leave the force method")(
    lambda context, pixel: context.scenes.request(context.scenes.hub)
)
