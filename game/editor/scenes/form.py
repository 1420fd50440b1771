"""Form scenes, the base of properties, save and load: boxes to type into, tiles to choose from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pinjoint.components.camera import Camera, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.form import NAME, NUMBER, WORD, Box, Form, Tile
from pinjoint.components.language import decimals, english, joined, marked, tr
from pinjoint.components.toolbar import Menu, Tool
from pinjoint.components.wording import missing
from pinjoint.editor.context import Context, Scene
from pinjoint.systems.forms.typing import YES_NO, Typing
from pinjoint.systems.render.model.sheet import Stage
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.form import FormLayout
from pinjoint.systems.render.ui.form_box import caret_at
from pinjoint.systems.render.ui.layout import Paper


class FormScene(Scene):
    """A mode with a form, which is made on entering and dropped on leaving."""

    def __init__(self) -> None:
        self.form = Form("")

    @property
    def typing(self) -> Typing:
        """Typing into its boxes."""
        return Typing(self.form)

    @property
    def message(self) -> str:
        """The message of the heading, and why the text of a box is refused."""
        return joined([self.form.message, *(box.problem for box in self.form.boxes)])

    def enter(self, context: Context) -> None:
        self.form = self.make_form(context)

    def exit(self, context: Context) -> None:
        self.form = Form("")

    # --- for subclasses -------------------------------------------------------------------------

    def make_form(self, context: Context) -> Form:
        """The boxes and tiles to begin with."""
        raise NotImplementedError

    def leave(self, context: Context) -> None:
        """Esc while no box is selected."""
        context.scenes.request(context.scenes.hub)

    def accept(self, context: Context) -> None:
        """Return: accept the selected box."""
        self.typing.accept()

    def changed(self, context: Context) -> None:
        """The text of a box was changed."""

    def choose(self, context: Context, tile: Tile) -> None:
        """A tile was clicked."""

    def viewport(self, context: Context) -> Viewport:
        """The part of the window that the form takes."""
        return context.view.camera.viewport

    def covers(self, context: Context) -> bool:
        return True

    def helped(self, context: Context) -> Viewport:
        return self.viewport(context) if self.covers(context) else super().helped(context)

    def move(self, context: Context, direction: str) -> None:
        """An arrow key: "left", "right", "up" or "down"."""
        box = self.form.selected
        if direction in ("up", "down"):
            by = 1 if direction == "down" else -1
            if box is not None and box.accepts in (WORD, NAME):
                self.typing.turn_word(box, by)
                self.changed(context)
            else:
                self.next_box(context, by)
        else:
            self.typing.step_caret(1 if direction == "right" else -1)
            self._reveal_selected(context)

    def say_again(self, context: Context) -> None:
        """Make the form again, with what was typed."""
        before, typed = self.form, False
        self.form = self.make_form(context)
        olds = {old.target: old for old in before.boxes}  # their order may change with the language
        for box in self.form.boxes:
            old = olds.get(box.target, box)
            if old is before.selected:
                self.typing.select(box)
            if old.text != box.text:
                self.typing.put(box, old.text)
                typed = True
        if typed:
            self.changed(context)
        self.form.first = before.first

    # --- pictures ----------------------------------------------------------------------------------

    def stages(self, context: Context) -> Sequence[Stage]:
        return [(self.form, replace(context.view, camera=Camera(viewport=self.viewport(context))))]

    def layout(self, context: Context) -> FormLayout:
        """Where its boxes and tiles are now."""
        view = context.view
        paper = Paper(view.pixel_ratio, draws=False)
        return FormLayout(self.form, self.viewport(context), paper, load_theme(view.theme))

    def resized(self, context: Context) -> None:
        """Keep the selected box in sight."""
        self._reveal_selected(context)

    # --- input -------------------------------------------------------------------------------------

    def type(self, context: Context, text: str) -> None:
        context.view.menu = None  # the list of a box
        refused = self.typing.write(text)
        self.form.message = ""
        self._reveal_selected(context)
        self.changed(context)
        self.form.message = refused or self.form.message

    def erase(self, context: Context, *, after: bool = False) -> None:
        """Backspace, or Delete."""
        self.form.message = ""
        self.typing.erase(after=after)
        self._reveal_selected(context)
        self.changed(context)

    def cancel(self, context: Context) -> None:
        """Esc: give the selected box back what it held, and say what was typed; without one, leave."""
        if self.form.selected is None:
            self.leave(context)
        else:
            given_up = self.typing.restore()
            self.changed(context)
            self.form.message = given_up

    def next_box(self, context: Context, by: int) -> None:
        """Tab: select the next box, or the previous one."""
        self.typing.move_on(by)
        self._reveal_selected(context)

    def click(self, context: Context, pixel: Vector) -> None:
        """Select a box (a switch also turns), put its caret, choose a tile, or press a button."""
        place = self.layout(context).at(pixel)
        match place.item if place is not None else None:
            case "close":
                self.typing.accept()
                self.leave(context)
            case "accept":
                self.accept(context)
            case Box() as box:
                again = box is self.form.selected
                if not again:
                    self.typing.select(box)
                if box.accepts in (WORD, NAME) and box.words == YES_NO:
                    self.typing.turn_word(box)
                    self.changed(context)
                elif box.accepts in (WORD, NAME):
                    words = (Tool("choose word", box.said_word(w), pressed=w == box.text) for w in box.words)
                    context.view.menu = Menu(box.said_title, (tuple(words),), pixel, pointed=pixel)
                elif again and place is not None:
                    self.typing.place_caret(caret_at(place, box, pixel[0], context.view.pixel_ratio))
            case Tile() as tile:
                self.choose(context, tile)
            case _:
                self.click_beside(context, pixel)

    def choose_word(self, context: Context, number: int) -> None:
        """A word of the list of the selected box was chosen."""
        if (box := self.form.selected) is not None:
            self.typing.put(box, box.words[number])
            self.accept(context)

    def click_beside(self, context: Context, pixel: Vector) -> None:
        """A click that hit neither a box nor a tile."""
        self.typing.accept()

    @property
    def boxes(self) -> dict[str, str]:
        return {english(box.title): box.text for box in self.form.boxes}

    def click_box(self, context: Context, title: str) -> None:
        """Select the box with that title, in English or as it is shown, as a click on it does. Raises LookupError."""
        wanted = title.strip().lower()
        for box in self.form.boxes:
            if wanted in (english(box.title).lower(), tr(box.title).lower()):
                self.reveal(context, box)
                self.typing.select(box)
                return
        titles = [english(box.title) for box in self.form.boxes]
        raise LookupError(missing(marked("boxes"), title, titles))

    def scroll(self, context: Context, rows: int) -> None:
        """Scroll by a number of rows."""
        self.form.first = max(self.layout(context).paper.scrolled[0] + rows, 0)
        self.form.first = self.layout(context).paper.scrolled[0]

    def page(self, context: Context, by: int) -> None:
        """Scroll by all visible rows but one."""
        self.scroll(context, by * max(self.layout(context).paper.scrolled[1] - 1, 1))

    def reveal(self, context: Context, item: Box | Tile) -> None:
        """Scroll until a box or tile is visible."""
        layout, form = self.layout(context), self.form
        if layout.place_of(item) is not None:
            return
        row = next(number for number, line in enumerate(layout.lines) if item in line.items)
        form.first = min(layout.paper.scrolled[0], row)
        while form.first < row and self.layout(context).place_of(item) is None:
            form.first += 1

    def _reveal_selected(self, context: Context) -> None:
        """Scroll to the selected box."""
        if self.form.selected is not None:
            self.reveal(context, self.form.selected)

    # --- clipboard ---------------------------------------------------------------------------------

    def copy(self, context: Context) -> None:
        """Put the text of the selected box on the clipboard, numbers as other programs of the language write them."""
        if (box := self.form.selected) is not None:
            context.clipboard = decimals(box.text) if box.accepts == NUMBER else box.text

    def cut(self, context: Context) -> None:
        """Copy, then empty the box."""
        self.copy(context)
        self.typing.mark_all()
        self.erase(context)

    def paste(self, context: Context) -> None:
        """Type what is on the clipboard."""
        self.type(context, context.clipboard)
