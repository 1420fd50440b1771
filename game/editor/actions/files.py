"""Actions on files: saving, opening, beginning anew."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.settings import HUBS, STATICS
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.context import Context
from pinjoint.scripts.script import NEW
from pinjoint.systems.edit import Refusal, saving
from pinjoint.systems.input.actions import ACTIONS, LIVE, LOAD, actions_of

action = actions_of("Files")


action("save", "s", "save as", HUBS)(lambda context, pixel: context.scenes.request_from_pause("save"))
action("save", "ctrl+shift+s", "save as")(ACTIONS["save"].perform)


@action("save again", "ctrl+s", "save")
def _save_again(context: Context, pixel: Vector) -> None:
    """Save to the same file; a model without one is named first, and a file that was changed since is asked about."""
    file = context.document.file
    if file.path is None:
        context.scenes.request_from_pause("save")
        return
    there = ModelFile.at(file.path)
    if there.stamp not in ((), file.stamp):
        context.document.file = there
        raise Refusal(
            "Another window or program has changed '{file}'. Press Ctrl+S again to replace it, or S to save under"
            " another name.",
            file=file.name,
        )
    context.notice = context.document.save_as(file.path)


action("load", "d", "open a model", HUBS)(lambda context, pixel: context.scenes.request_from_pause("load"))
action("load", "ctrl+o", "open a model")(ACTIONS["load"].perform)


@action("new", "ctrl+n", "start a new model", (*LIVE, LOAD))
def _new(context: Context, pixel: Vector) -> None:
    """An empty model, whose structure is drawn in statics."""
    context.documents.open(NEW)
    context.scenes.request_from_pause(STATICS)


@action("sheet", "", "save a sheet as PDF")
def _sheet(context: Context, pixel: Vector) -> None:
    """Write the static solution of the model, from its undeformed beginning, to a PDF in the working folder; with the
    mode or influence line that is shown."""
    if context.window is None:
        return
    from pinjoint.sheet import sheet  # it imports reportlab

    shape, theory = context.document.shapes.shown, context.model.settings.theory
    with saving():
        enveloped = context.view.enveloped
        made = sheet(
            context.model,
            theory,
            [] if shape is None else [shape],
            None if enveloped is None else enveloped.path,
        )
        path = context.window.save("pinjoint-sheet.pdf", made)
    context.notice = tr("Sheet saved: {file}", file=path)
