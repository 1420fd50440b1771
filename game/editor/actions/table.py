"""Actions on the table of results: what is pressed in it, and the keys while the pointer is over it."""

from __future__ import annotations

from pinjoint.components.field import Vector
from pinjoint.components.language import marked, tr
from pinjoint.editor.context import Context
from pinjoint.systems.edit import saving
from pinjoint.systems.input.actions import TABLE, actions_of
from pinjoint.systems.render.ui.listing import PRESSED

action = actions_of("Results", (TABLE,), while_drawing=True)


for _name, _key, _title, _act in (
    ("row above", "up", marked("select the row above"), lambda lister: lister.choose(-1)),
    ("row below", "down", marked("select the row below"), lambda lister: lister.choose(1)),
    ("table before", "left", marked("show the table before"), lambda lister: lister.turn(-1)),
    ("table after", "right", marked("show the next table"), lambda lister: lister.turn(1)),
    ("rows above", "page up", marked("scroll up"), lambda lister: lister.page(-1)),
    ("rows below", "page down", marked("scroll down"), lambda lister: lister.page(1)),
    ("first rows", "home", "", lambda lister: lister.scroll(-lister.first)),
    ("last rows", "end", "", lambda lister: lister.scroll(lister.listing.count)),
    ("table up", "", "", lambda lister: lister.scroll(-3)),
    ("table down", "", "", lambda lister: lister.scroll(3)),
):
    action(_name, _key or (), _title, repeats=True)(lambda context, pixel, act=_act: act(context.lister))


@action(PRESSED)
def _press(context: Context, pixel: Vector) -> None:
    """What lies under the pixel."""
    if context.view.pressed is not None:
        context.lister.press(context.view.pressed.item)


@action("copy table", "ctrl+c", "copy")
def _copy(context: Context, pixel: Vector) -> None:
    """With tabulators, as spreadsheets paste it."""
    context.clipboard = context.lister.text("\t")
    context.notice = tr("The table is copied; paste it into a spreadsheet.")


@action("save table", "", "save as CSV")
def _save(context: Context, pixel: Vector) -> None:
    """As spreadsheets of the present language open it, in the working folder."""
    if context.window is not None:
        with saving():  # by the mark at its beginning, spreadsheets know the letters
            name, text = f"pinjoint-{context.lister.shown}.csv", context.lister.text().encode("utf-8-sig")
            context.notice = tr("Table saved: {file}", file=context.window.save(name, text))
