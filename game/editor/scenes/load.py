"""Load: opening a saved model, an example or an empty one; the program starts with it."""

from __future__ import annotations

from typing import Any

from components.form import Form, Tile
from components.language import tr
from game.documents import library, models
from game.documents.autosave import recovered_name
from game.documents.open_documents import ModelFile
from game.editor.context import Context
from game.editor.scenes.files import FileScene, Offer, saved_models
from game.lessons import progress
from game.lessons.shelf import count_of, is_done, shelf
from game.scripts.script import Script, lessons

WELCOME = "Welcome to Pinjoint. What would you like to begin with?"
NEW = "New, empty model"
LESSONS = "Begin here"
TRUSSES, BENDING, COLLISIONS = EXAMPLES = "Trusses", "Members that bend", "Collisions"
YOURS = "Your models"
DISCARD = "discard unsaved work"  # the source of the tile that discards what windows left behind
ALL = "all of this section"  # the source of a tile that shows all tiles of its section, not only a row of them
# The first of each section; the others follow in alphabetical order.
FIRST = (
    *("isostatic", "hyperstatic", "pendulum", "warren_bridge", "hyperstatic_yield", "tower", "ball_on_truss"),
    *("portal", "eulers_columns", "rolled_cantilever", "ball_on_frame", "gerber_beam", "three_hinged_arch"),
    *("collision_iii", "newtons_cradle", "billiards_break", "pile", "staircase", "galperin_pi"),
)


class Load(FileScene):
    """Opening a model by its name or its picture.

    welcome: the program was just started; the heading says what it is.
    """

    name = "load"
    heading = "Open"

    def __init__(self) -> None:
        super().__init__()
        self.welcome = False
        self._asked = False  # the person chose once to discard unsaved work

    def make_form(self, context: Context) -> Form:
        self._asked = False
        new = Offer(LESSONS, NEW, "draw your own", "", None, "An empty plane to draw on.", "+")
        learn = _tasks()
        rest = Offer(
            LESSONS,
            tr("All lessons"),
            tr("{tasks} to do, {films} to watch", tasks=len(learn), films=len(lessons())),
            "",
            ALL,
            symbol="»",
            rest=True,
        )
        offers = [*learn[:1], new, *learn[1:], *_lessons(), rest, *_yours(context), *_examples()]
        form = self.new_form(WELCOME if self.welcome else "Open a model", "", offers, "Open")
        form.boxes[0].note = "type to search, or click a picture"
        return form

    def exit(self, context: Context) -> None:
        super().exit(context)
        self.welcome = False

    def choose(self, context: Context, tile: Tile) -> None:
        """Open the source of a tile; the tile "Discard", chosen twice, discards unsaved work."""
        if tile.source is ALL:
            self.form.delete([tile])
        elif tile.source is not DISCARD:
            self._open(context, tile.source)
        elif self._asked and context.autosave is not None:
            context.autosave.discard()
            self.form = self.make_form(context)
        else:
            self._asked = True
            self.form.choose(tile)
            self.say(
                "Unsaved work of earlier windows will be gone for ever. Choose this once more to discard it; Esc does not."
            )

    def accept(self, context: Context) -> None:
        """Return: open the chosen tile, else the model whose name was typed, else the only visible tile."""
        name, chosen = self.box.text.strip(), self.form.chosen
        left = [tile for tile in self.form.tiles if not tile.hidden]
        if chosen is not None:
            self.choose(context, chosen)
        elif not name:
            self.say("Type a name, or choose a picture with the arrow keys.")
        elif (source := library.find(name)) is not None:
            self._open(context, source)
        elif len(left) == 1:
            self.choose(context, left[0])
        else:
            nearest = library.nearest(name)
            hint = f" Did you mean '{nearest}'?" if nearest else ""
            self.say(f"File not found: there is no model '{name}'.{hint}")

    def _open(self, context: Context, source: Any) -> None:
        try:
            if isinstance(source, Script) and source.has_tasks:
                context.lesson = source  # it opens its models itself
            elif isinstance(source, Script):
                context.open_here(source.source)
                context.lesson = source
            elif context.autosave is not None and source in context.autosave.left():
                context.adopt(models.load(source), ModelFile(None, recovered_name(source)))
                context.autosave.take_over(source, context.document)
            else:
                context.open_here(source)
        except models.ModelError as error:
            self.say(str(error))
        else:
            context.scenes.request("pause")

    def changed(self, context: Context) -> None:
        """Show the tiles whose titles or names contain every word that was typed."""
        super().changed(context)
        self._asked = False
        words = self.box.text.lower().split()
        tiles = list(self.form.tiles)
        told = [f"{tile.title} {tile.file}".lower() for tile in tiles]
        hidden = [
            bool(words) and (tile.rest or not all(word in text for word in words))
            for tile, text in zip(tiles, told, strict=True)
        ]
        self.form.assign(tiles, "hidden", hidden)
        self.form.heading.first = 0
        if words and all(hidden):
            self.say("No model or lesson has that in its name. Backspace takes characters away again.")

    def hint(self, context: Context) -> str:
        layout = self.layout(context)
        more = "Wheel shows more     " if layout.shown < layout.count else ""
        return f"Click a picture     {more}Arrows choose     Return open     Type to search     Esc back"


def _yours(context: Context) -> list[Offer]:
    """Unsaved work that windows left behind, and saved models, the newest first."""
    files = context.autosave.left() if context.autosave is not None else []
    offers = [
        Offer(YOURS, recovered_name(path) or "Untitled", f"not saved, {library.written_age(path)}", "", path)
        for path in files
    ]
    if offers:
        offers.append(Offer(YOURS, "Discard", "what was not saved", "", DISCARD, symbol="×"))
    offers += [offer._replace(section=YOURS) for offer in saved_models()]
    count = sum(offer.source is not DISCARD for offer in offers)
    everything = Offer(YOURS, f"All {count}", "of your models", "", ALL, symbol="»", rest=True)
    return [*offers, everything] if offers else []


def _tasks() -> list[Offer]:
    """The lessons with tasks, from the first that is not done on; then those that are done."""
    offers = []
    for script in sorted(shelf(), key=is_done):
        count, done = count_of(script), len(progress.done(script.name).tasks)
        caption = tr("a lesson of {count} tasks", count=count)
        if is_done(script):
            caption = tr("done: all {count} tasks", count=count)
        elif done:
            caption = tr("continue: {done} of {count} tasks done", done=done, count=count)
        title, about = tr(script.title), tr(script.description)
        offers.append(
            Offer(LESSONS, title, caption, script.name, script, about, "✓" if is_done(script) else "▶")
        )
    if offers and not is_done(offers[0].source):
        offers[0] = offers[0]._replace(title=tr("Learn: {lesson}", lesson=offers[0].title))
    return offers


def _lessons() -> list[Offer]:
    scripts = [(name, Script(name)) for name in lessons()]
    return [Offer(LESSONS, s.title, "a lesson to watch", name, s, s.description, "▶") for name, s in scripts]


def _examples() -> list[Offer]:
    """The bundled models by subject, of each the first and a tile that stands for the rest."""
    told = {name: models.header_of(name) for name in models.bundled()}
    names = sorted(told, key=lambda name: told[name].title)
    names.sort(key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST))
    offers = []
    for section in EXAMPLES:
        some = [name for name in names if _subject(told[name]) == section]
        offers += [Offer(section, told[n].title or n, n, n, n, told[n].description) for n in some]
        offers.append(Offer(section, f"All {len(some)}", "of these", "", ALL, symbol="»", rest=True))
    return offers


def _subject(header: models.ModelHeader) -> str:
    """The section in which a bundled model is offered."""
    if not header.rods:
        return COLLISIONS
    return BENDING if header.bends else TRUSSES
