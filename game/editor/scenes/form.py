"""Form scene: what properties, save and load have in common: boxes to type into, tiles to choose from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from components.box import WORD, Box
from components.camera import Camera, Viewport
from components.field import Vector
from components.form import Form, Tile
from components.spelling import missing
from components.view import View
from game.editor.scenes.base import Scene, Stage
from systems.forms import typing
from systems.render.form_layout import FormLayout, lay_out, row_of
from systems.render.panel import caret_at

if TYPE_CHECKING:
    from game.session import Session


class FormScene(Scene):
    """A mode with a form, which it makes on entering and which is gone on leaving."""

    targets: ClassVar[tuple[str, ...]] = ("pause",)

    def __init__(self) -> None:
        self.form = Form("")

    @property
    def message(self) -> str:
        """What its heading says, and why the text of a box is refused."""
        return " ".join(filter(None, [self.form.heading.message, *(box.problem for box in self.form.boxes)]))

    def enter(self, session: Session) -> None:
        self.form = self.make_form(session)

    def exit(self, session: Session) -> None:
        self.form = Form("")

    # --- what a kind of form decides ---------------------------------------------------------------

    def make_form(self, session: Session) -> Form:
        """The boxes and tiles to begin with."""
        raise NotImplementedError

    def leave(self, session: Session) -> None:
        """Esc while no box is selected."""
        session.scenes.request("pause")

    def accept(self, session: Session) -> None:
        """Return: accept the selected box."""
        typing.accept(self.form)

    def changed(self, session: Session) -> None:
        """The text of a box was changed."""

    def choose(self, session: Session, tile: Tile) -> None:
        """A tile was clicked."""

    def viewport(self, session: Session) -> Viewport:
        """The part of the window that the form takes."""
        return session.view.camera.viewport

    def helped(self, session: Session) -> Viewport:
        return self.viewport(session)

    def move(self, session: Session, direction: str) -> None:
        """An arrow key: "left", "right", "up" or "down"."""
        box = self.form.selected
        if direction in ("up", "down"):
            by = 1 if direction == "down" else -1
            if box is not None and box.accepts == WORD:
                typing.turn_word(self.form, box, by)
                self.changed(session)
            else:
                self.next_box(session, by)
        else:
            typing.step_caret(self.form, 1 if direction == "right" else -1)
            self._reveal_selected(session)

    # --- pictures ----------------------------------------------------------------------------------

    def stages(self, session: Session) -> Sequence[Stage]:
        return [(self.form, self.form_view(session))]

    def form_view(self, session: Session) -> View:
        """How the form is shown."""
        return replace(session.view, camera=Camera(viewport=self.viewport(session)))

    def layout(self, session: Session) -> FormLayout:
        """Where its boxes and tiles are now."""
        return lay_out(self.form, self.viewport(session), session.view.pixel_ratio)

    def resized(self, session: Session) -> None:
        """Keep the selected box in sight."""
        self._reveal_selected(session)

    # --- input -------------------------------------------------------------------------------------

    def type(self, session: Session, text: str) -> None:
        typing.write(self.form, text)
        self._reveal_selected(session)
        self.changed(session)

    def erase(self, session: Session, *, after: bool = False) -> None:
        """Backspace, or Delete."""
        typing.erase(self.form, after=after)
        self._reveal_selected(session)
        self.changed(session)

    def cancel(self, session: Session) -> None:
        """Esc: give the selected box back what it held; without one, leave."""
        if self.form.selected is None:
            self.leave(session)
        else:
            typing.restore(self.form)
            self.changed(session)

    def next_box(self, session: Session, by: int) -> None:
        """Tab: select the next box, or the previous one."""
        typing.move_on(self.form, by)
        self._reveal_selected(session)

    def click(self, session: Session, pixel: Vector) -> None:
        """Select a box (a switch also turns), put its caret, or choose a tile."""
        place = next((p for p in self.layout(session).places if p.contains(pixel)), None)
        match place.item if place is not None else None:
            case Box() as box:
                again = box is self.form.selected
                if not again:
                    typing.select(self.form, box)
                if box.accepts == WORD and (again or box.words == typing.YES_NO):
                    typing.turn_word(self.form, box)
                    self.changed(session)
                elif again and place is not None:
                    typing.place_caret(self.form, caret_at(place, box, pixel[0], session.view.pixel_ratio))
            case Tile() as tile:
                self.choose(session, tile)
            case _:
                self.click_beside(session, pixel)

    def click_beside(self, session: Session, pixel: Vector) -> None:
        """A click that hit neither a box nor a tile."""
        typing.accept(self.form)

    @property
    def boxes(self) -> dict[str, str]:
        return {box.title: box.text for box in self.form.boxes}

    def click_box(self, session: Session, title: str) -> None:
        """Select the box with that title, as a click on it does. Raises LookupError."""
        wanted = title.strip().lower()
        for box in self.form.boxes:
            if box.title.lower() == wanted:
                self.reveal(session, box)
                typing.select(self.form, box)
                return
        titles = [box.title for box in self.form.boxes]
        raise LookupError(missing("boxes", title, titles))

    def scroll(self, session: Session, rows: int) -> None:
        """Let so many rows go by."""
        heading = self.form.heading
        heading.first = max(self.layout(session).first + rows, 0)
        heading.first = self.layout(session).first

    def page(self, session: Session, by: int) -> None:
        """Let all rows that are seen but one go by."""
        self.scroll(session, by * max(self.layout(session).shown - 1, 1))

    def reveal(self, session: Session, item: Box | Tile) -> None:
        """Scroll until a box or tile is seen, with the heading of its section if it is the first there."""
        layout, heading = self.layout(session), self.form.heading
        if layout.place_of(item) is not None:
            return
        row, above = row_of(self.form, item, layout)
        heading.first = min(layout.first, above)
        while heading.first < row and self.layout(session).place_of(item) is None:
            heading.first += 1

    def _reveal_selected(self, session: Session) -> None:
        """What is typed into is seen."""
        if self.form.selected is not None:
            self.reveal(session, self.form.selected)

    # --- clipboard ---------------------------------------------------------------------------------

    def copy(self, session: Session) -> None:
        """Put the text of the selected box on the clipboard."""
        if self.form.selected is not None:
            session.clipboard = self.form.selected.text

    def cut(self, session: Session) -> None:
        """Copy, then empty the box."""
        self.copy(session)
        typing.mark_all(self.form)
        self.erase(session)

    def paste(self, session: Session) -> None:
        """Type what is on the clipboard."""
        self.type(session, session.clipboard)
