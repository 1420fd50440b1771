"""Actions that make, change, copy and delete elements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import Vector
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, listed, marked, plural, tr
from pinjoint.components.particle import Particle
from pinjoint.editor.clipboard import Part, as_text, part_in, part_of, paste, selected_rows
from pinjoint.editor.context import Context, action
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.moving import Movable, nudged
from pinjoint.systems.edit.picking import pick_particle
from pinjoint.systems.edit.placing import place, snapped
from pinjoint.systems.edit.rods import delete
from pinjoint.systems.edit.supports import next_support
from pinjoint.systems.forms.properties import counted, heading


@action("place", while_drawing=True)
def _place(context: Context, pixel: Vector) -> None:
    """A particle under the pointer; from the toolbar, under the clicks that follow."""
    if context.view.strip.contains(pixel):
        context.take_up("place")
        return
    particle = place(context.model, context.view, pixel)
    context.notice = tr(
        "{element}: {value}",
        element=context.name(particle),
        value=written.place(particle.position, written.DIGITS),
    )


@action("delete")
def _delete(context: Context, pixel: Vector) -> None:
    doomed = context.selected
    if not doomed:
        raise Refusal("Nothing is selected; first click what you want to delete.")
    before = {table.name: table.count for table in context.model.tables.values()}
    named = context.name(doomed[0])
    delete(context.model, doomed)
    gone = {name: count - context.model.tables[name].count for name, count in before.items()}
    if sum(gone.values()) == 1:
        context.notice = tr("{element} deleted.", element=named)
    else:
        elements = [
            counted(context.model.tables[name].kind.noun, count) for name, count in gone.items() if count
        ]
        context.notice = tr("{elements} deleted.", elements=listed(elements))


@action("support")
def _support(context: Context, pixel: Vector) -> None:
    """The next support of the particle under the pointer, else of the selected ones; without any, take up the tool."""
    hit = pick_particle(context.model, context.view, pixel)
    chosen = [handle for handle in context.selected if isinstance(handle, Particle)]
    if hit is not None and hit not in chosen:
        chosen = [hit]
    if not chosen:
        context.take_up("support")
        return
    support = next_support(context.model, chosen)
    context.notice = tr("{element}: {value}", element=all_of(context, chosen), value=tr(support))


def all_of(context: Context, elements: Sequence[Handle]) -> str:
    """Some elements as a sentence begins with them."""
    return begun(heading(context.model, elements))


def nudge(context: Context, direction: Vector, *, far: bool) -> bool:
    """Move the selected elements by about a pixel or, if far, a grid spacing; False if none are selected."""
    model = context.model
    chosen = Movable(model, context.selected)
    if not len(chosen):
        return False
    positions = nudged(model, context.view, chosen.positions, direction, far=far)
    moved = [*chosen.particles, *chosen.others]
    with context.document.history.as_one(("nudge", *(handle.entity for handle in moved))):
        chosen.place(positions)
    place = written.place(positions[0], written.DIGITS)
    context.notice = tr("{element}: {value}", element=all_of(context, moved), value=place)
    return True


# --- grids -----------------------------------------------------------------------------------------------


@action("new grid")
def _new_grid(context: Context, pixel: Vector) -> None:
    with context.model.transaction(marked("new grid")):
        for grid in context.model.grids:
            if grid.shown:
                grid.shown = False
        context.model.create(Grid)


@action("next grid")
def _next_grid(context: Context, pixel: Vector) -> None:
    """Show the grid after the shown one; after the last, none; after none, the first."""
    grids = list(context.model.grids)
    shown = [index for index, grid in enumerate(grids) if grid.shown]
    following = shown[-1] + 1 if shown else 0
    with context.model.transaction(marked("next grid")):
        for index, grid in enumerate(grids):
            if grid.shown != (index == following):
                grid.shown = index == following


# --- clipboard ----------------------------------------------------------------------------------------


BESIDE = 30.0  # points to the right and down, where a duplicate appears


@action("copy")
def _copy(context: Context, pixel: Vector) -> None:
    _put_on_clipboard(context)
    context.notice = tr("Copied. Ctrl+V pastes it at the pointer.")


@action("cut")
def _cut(context: Context, pixel: Vector) -> None:
    _put_on_clipboard(context)
    delete(context.model, context.selected)
    context.notice = tr("Cut. Ctrl+V pastes it at the pointer.")


@action("paste")
def _paste(context: Context, pixel: Vector) -> None:
    """Paste around the pointer, from the toolbar around the middle of the view; the first place snaps to the grid."""
    if context.view.strip.contains(pixel):
        pixel = context.view.canvas.middle
    source = _clipboard(context)
    position = source.position
    middle = 0.5 * (position.min(axis=0) + position.max(axis=0))
    x, y = (position[0] + context.view.camera.to_model(pixel) - middle).tolist()
    offset = np.subtract(snapped(context.model, context.view, (x, y)), position[0]).tolist()
    made = paste(context.model, source, (offset[0], offset[1]))
    context.select(*made)
    context.notice = plural(
        "Pasted {count} element; drag it where it belongs.",
        "Pasted {count} elements; drag them where they belong.",
        len(made),
    )


@action("duplicate")
def _duplicate(context: Context, pixel: Vector) -> None:
    view = context.view
    beside = BESIDE * view.pixel_ratio / view.camera.scale
    source = part_of(context.model, selected_rows(context.model))
    made = paste(context.model, source, snapped(context.model, view, (beside, -beside)), marked("duplicate"))
    context.select(*made)
    context.notice = plural(
        "Duplicated {count} element; drag the copy where it belongs.",
        "Duplicated {count} elements; drag the copies where they belong.",
        len(made),
    )


def _put_on_clipboard(context: Context) -> None:
    rows = selected_rows(context.model)
    context.clipboard = text = as_text(context.model, rows)
    context.copied = text, part_of(context.model, rows)


def _clipboard(context: Context) -> Part:
    """The part on the clipboard; its text is parsed only if it was not copied here."""
    text, copied = context.clipboard, context.copied
    return copied[1] if copied is not None and copied[0] == text else part_in(text)
