"""File scenes: a box for the name, and tiles with pictures of models; and save, which gives the model a name and a file."""

from __future__ import annotations

import time
from typing import Any

from pinjoint.components.form import FILE_NAME, TEXT, Box, Form, Tile
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import reason_of
from pinjoint.documents import library, models
from pinjoint.documents.previews import preview
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.form import FormScene
from pinjoint.systems.base import Phase, System

READING = 0.005  # s of each frame spent on reading pictures; one picture at least


class FileScene(FormScene):
    """A mode in which a file is named or chosen."""

    def __init__(self) -> None:
        super().__init__()
        self._unread: list[Tile] = []

    def exit(self, context: Context) -> None:
        super().exit(context)
        self._unread = []

    def new_form(self, heading: str, name: str, tiles: list[Tile], accept: str) -> Form:
        """A form with a box for the name, a button, and tiles whose pictures are to be read later."""
        self._unread = [tile for tile in tiles if not tile.symbol]
        folder, own = str(library.models_folder()), library.own_folder()
        where = tr("Models and pictures go there; left empty: to {folder}.", folder=own)
        kept = tr("Unsaved work is kept in {folder}.", folder=library.data_folder() / "autosave")
        boxes = [
            Box(tr("name"), "name", name, opened=name, accepts=FILE_NAME),
            Box(tr("folder"), "folder", folder, opened=folder, accepts=TEXT, explanation=joined([where, kept])),
        ]
        return Form(heading, accept=accept, boxes=boxes, tiles=tiles)

    @property
    def box(self) -> Box:
        """The box for the name."""
        return self.form.boxes[0]

    @property
    def folder(self) -> Box:
        """The box for the folder of models."""
        return self.form.boxes[1]

    def take_folder(self, *, make: bool) -> bool:
        """Use the folder that was typed from now on, a new one if it may be made; False if it is refused, which is said."""
        if self.folder.text == self.folder.opened:
            return True
        try:
            library.choose_folder(self.folder.text, make=make)
        except library.NameRefused as error:
            self.form.message = str(error)
            return False
        return True

    # --- typing and choosing -----------------------------------------------------------------------

    def type(self, context: Context, text: str) -> None:
        if self.form.selected is None:
            self.typing.select(self.box)
        super().type(context, text)

    def changed(self, context: Context) -> None:
        self.form.message = ""
        self.form.chosen = None

    def move(self, context: Context, direction: str) -> None:
        """Arrows choose a tile; left and right move the caret until one is chosen."""
        if direction in ("left", "right") and self.form.chosen is None and self.form.selected is not None:
            super().move(context, direction)
            return
        tile = self._neighbour(context, direction)
        if tile is not None:
            self.form.chosen = tile
            self.reveal(context, tile)

    def _neighbour(self, context: Context, direction: str) -> Tile | None:
        """The tile next to the chosen one in a direction; the first visible tile if none is chosen yet."""
        layout, chosen = self.layout(context), self.form.chosen
        rows = [[item for item in line.items if isinstance(item, Tile)] for line in layout.lines]
        at = next(((row, row.index(chosen)) for row in rows if chosen in row), None)
        if at is None:
            return next((place.item for place in layout.places if isinstance(place.item, Tile)), None)
        row, column = at
        if direction in ("up", "down"):
            other = rows.index(row) + (1 if direction == "down" else -1)
            row = rows[min(max(other, 0), len(rows) - 1)]
            return row[min(column, len(row) - 1)]
        tiles = [tile for row in rows for tile in row]
        beside = tiles.index(row[column]) + (1 if direction == "right" else -1)
        return tiles[min(max(beside, 0), len(tiles) - 1)]

    def next_box(self, context: Context, by: int) -> None:
        """Tab: select the next box, or accept the last one."""
        order = [None, *self.form.boxes]
        at = next(number for number, box in enumerate(order) if box is self.form.selected)
        self.typing.select(order[(at + by) % len(order)])

    # --- pictures ----------------------------------------------------------------------------------

    def busy(self, context: Context) -> bool:
        return self._next_unread(context) is not None

    def read_pictures(self, context: Context) -> None:
        """Read the next missing pictures among the visible tiles, few in a frame so that typing stays fluent."""
        until = time.perf_counter() + READING
        while (tile := self._next_unread(context)) is not None:
            self._unread.remove(tile)
            _read_picture(tile)
            if time.perf_counter() >= until:
                break

    def _next_unread(self, context: Context) -> Tile | None:
        if not self._unread:
            return None
        seen = [place.item for place in self.layout(context).places]
        return next((tile for tile in self._unread if tile in seen), None)


class Pictures(System):
    """Reads the pictures of the models that save and load offer."""

    name = "files.pictures"
    phase = Phase.EVENTS
    scenes = ("save", "load")
    reads = ("files",)
    writes = ("form",)
    headless = False

    def process(self, frame: Any) -> None:
        """Read a few pictures."""
        scene = frame.session.scenes.active
        if isinstance(scene, FileScene):
            scene.read_pictures(frame.session)


def saved_models(section: str) -> list[Tile]:
    """The person's own models, the newest first."""
    return [
        Tile(section, name, library.written_age(p), name, p)
        for p in library.saved()
        if (name := models.name_of(p))
    ]


def _read_picture(tile: Tile) -> None:
    try:
        if isinstance(tile.source, str):
            tile.picture = preview(tile.source)
        elif tile.source.stat().st_size <= 4 * 2**20:
            tile.picture = preview(tile.source)
            tile.explanation = tile.picture.description or tile.picture.title
        else:
            tile.caption = joined([tile.caption, tr("too large for a picture")], ", ")
    except (OSError, models.ModelError):
        tile.caption = tr("cannot be read")


class Save(FileScene):
    """Saving under a name; a model of that name is replaced only when Return is pressed twice."""

    name = "save"
    heading = marked("Save")

    def __init__(self) -> None:
        super().__init__()
        self._confirmed = ""

    def make_form(self, context: Context) -> Form:
        self._confirmed = ""
        form = self.new_form(
            tr("Save"), context.document.file.name, saved_models(tr("Saved models")), tr("Save")
        )
        form.boxes[0].explanation = tr("A file in {folder}", folder=library.models_folder())
        return form

    def choose(self, context: Context, tile: Tile) -> None:
        """Take the name of a tile, to use it again or change it a little."""
        self.form.chosen = None
        self.typing.select(self.box)
        self.typing.put(self.box, tile.file)
        self.changed(context)

    def move(self, context: Context, direction: str) -> None:
        super().move(context, direction)
        chosen = self.form.chosen
        if chosen is not None and self.box.text != chosen.file:
            self.typing.put(self.box, chosen.file)
            self.form.message = ""

    def accept(self, context: Context) -> None:
        """Return: save."""
        name = self.box.text.strip()
        if not self.take_folder(make=True):
            return
        try:
            path = library.path_of(name)
            if path.exists() and self._confirmed != name:
                self._confirmed = name
                self.form.message = tr(
                    "There is already a model '{name}'. Press Return again to replace it, or Esc to keep it.",
                    name=name,
                )
                return
            path.parent.mkdir(parents=True, exist_ok=True)
            context.notice = context.document.save_as(path)
        except OSError as error:
            self.form.message = tr(
                "The folder {folder} cannot be made: {reason}. Write another one where you may write.",
                folder=library.models_folder(),
                reason=reason_of(error),
            )
            return
        except (library.NameRefused, models.ModelError) as error:
            self.form.message = str(error)
            return
        context.scenes.request(context.scenes.hub)

    def changed(self, context: Context) -> None:
        super().changed(context)
        self._confirmed = ""

    def hint(self, context: Context) -> str:
        return tr("Type a name     Return save     Esc back")
