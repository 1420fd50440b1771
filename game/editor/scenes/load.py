"""Load: opening a saved model, an example, or an empty one; also what the program starts with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from components.form import Form, Tile
from game.documents import library, models
from game.documents.autosave import spare_name
from game.documents.open_documents import ModelFile
from game.editor.scenes.files import FileScene, saved_tiles, tile
from game.scripts.script import Script, lessons

if TYPE_CHECKING:
    from game.session import Session

WELCOME = "Welcome to Pinjoint. What would you like to begin with?"
NEW = "New, empty model"
LESSONS = "Begin here"
EXAMPLES = "Examples"
LEFT_BEHIND = "Unsaved work, recovered"
DISCARD = "discard what was recovered"  # what a tile stands for that opens nothing
# Of the examples, those to look at first; the others follow in alphabetical order.
FIRST = ("isostatic", "hyperstatic", "pendulum", "collision_iii", "warren_bridge", "hyperstatic_yield", "tower")


class Load(FileScene):
    """Opening a model by its name or its picture.

    welcome: the program was just started; it says what it is.
    """

    name = "load"
    heading = "Load"

    def __init__(self) -> None:
        super().__init__()
        self.welcome = False
        self._asked = False  # whether what was recovered is to be discarded

    def make_form(self, session: Session) -> Form:
        self._asked = False
        saved = saved_tiles()
        new = tile(
            saved[0]["section"] if saved else LESSONS,
            NEW,
            "draw your own",
            "",
            None,
            "An empty plane to draw on.",
            symbol="+",
        )
        tiles = [*_left_behind(session), new, *saved, *_lessons(), *_examples()]
        form = self.new_form(WELCOME if self.welcome else "Load", "", tiles)
        form.boxes[0].note = "type to search, or click a picture"
        return form

    def exit(self, session: Session) -> None:
        super().exit(session)
        self.welcome = False

    def choose(self, session: Session, tile: Tile) -> None:
        """Open what was clicked."""
        self._take(session, tile)

    def _take(self, session: Session, tile: Tile) -> None:
        """Open what a tile stands for, or, asked twice, discard what was recovered."""
        if tile.source is not DISCARD:
            self._open(session, tile.source)
        elif self._asked and session.autosave is not None:
            session.autosave.discard()
            self.form = self.make_form(session)
        else:
            self._asked = True
            self.form.choose(tile)
            self.say(
                "What was recovered will be gone for ever. Choose this once more to discard it; Esc does not."
            )

    def accept(self, session: Session) -> None:
        """Return: open the chosen tile, the model whose name was typed, or the only one that is left to choose."""
        name, chosen = self.box.text.strip(), self.form.chosen
        left = [tile for tile in self.form.tiles if not tile.hidden]
        if chosen is not None:
            self._take(session, chosen)
        elif not name:
            self.say("Type a name, or choose a picture with the arrow keys.")
        elif (source := library.find(name)) is not None:
            self._open(session, source)
        elif len(left) == 1:
            self._take(session, left[0])
        else:
            nearest = library.nearest(name)
            hint = f" Did you mean '{nearest}'?" if nearest else ""
            self.say(f"File not found: there is no model '{name}'.{hint}")

    def _open(self, session: Session, source: Any) -> None:
        try:
            if isinstance(source, Script):
                session.open_here(source.source)
                session.lesson = source
            elif session.autosave is not None and source in session.autosave.left():
                session.adopt(models.load(source), ModelFile(None, spare_name(source)))
                session.autosave.take_over(source, session.desk)
            else:
                session.open_here(source)
        except models.ModelError as error:
            self.say(str(error))
        else:
            session.scenes.request("pause")

    def changed(self, session: Session) -> None:
        """Show the tiles whose titles or names contain every word that was typed."""
        super().changed(session)
        self._asked = False
        words = self.box.text.lower().split()
        tiles = list(self.form.tiles)
        hidden = [not all(word in f"{tile.title} {tile.file}".lower() for word in words) for tile in tiles]
        self.form.assign(tiles, "hidden", hidden)
        self.form.heading.first = 0

    def hint(self, session: Session) -> str:
        layout = self.layout(session)
        more = "Wheel shows more     " if layout.shown < layout.count else ""
        return f"Click a picture     {more}Arrows choose     Return open     Type to search     Esc back"


def _left_behind(session: Session) -> list[dict[str, Any]]:
    """Unsaved work that a crash left behind."""
    files = session.autosave.left() if session.autosave is not None else []
    tiles = [
        tile(LEFT_BEHIND, spare_name(path) or "Untitled", library.written_age(path), "", path) for path in files
    ]
    discard = tile(LEFT_BEHIND, "Discard", "what was recovered", "", DISCARD, symbol="×")
    return [*tiles, discard] if tiles else []


def _lessons() -> list[dict[str, Any]]:
    scripts = [(name, Script(name)) for name in lessons()]
    return [
        tile(LESSONS, s.title, "a lesson to watch", name, s, s.description, symbol="▶") for name, s in scripts
    ]


def _examples() -> list[dict[str, Any]]:
    """Tiles of the bundled models, their pictures to be read later."""
    names = sorted(models.bundled(), key=lambda name: models.told(name).title)
    names.sort(key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST))
    shown = [(name, models.told(name)) for name in names]
    return [tile(EXAMPLES, told.title or name, name, name, name, told.description) for name, told in shown]
