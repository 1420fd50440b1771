"""Load: opening a saved model, an example or an empty one; the program starts with it."""

from __future__ import annotations

from typing import Any

from pinjoint.components.form import Form, Tile
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.settings import PAUSE
from pinjoint.components.view import BETWEEN
from pinjoint.documents import library, models
from pinjoint.documents.autosave import recovered_name
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.files import FileScene, saved_models
from pinjoint.lessons import progress
from pinjoint.lessons.progress import is_done, shelf
from pinjoint.scripts.script import NEW, Script, lessons
from pinjoint.systems.input.actions import SIMULATION

LESSONS = marked("Begin here")
PLAYGROUND, TRUSSES, BENDING, COLLISIONS = EXAMPLES = (
    *(marked("Playground"), marked("Trusses"), marked("Members that bend"), marked("Collisions")),
)
YOURS = marked("Your models")
DISCARD = "discard unsaved work"  # the source of the tile that discards what windows left behind
ALL = "all of this section"  # the source of a tile that shows all tiles of its section, not only a row of them
# The first of each section; the others follow in alphabetical order.
PLAYED = (
    "swing",
    "catapult",
    "demolition",
    "falling_columns",
    "rope_bridge",
)  # of the playground: they run at once
FIRST = (
    *PLAYED,
    *("isostatic", "hyperstatic", "pendulum", "warren_bridge", "hyperstatic_yield", "tower", "ball_on_truss"),
    *("portal", "eulers_columns", "sway_frame", "portal_collapse", "rolled_cantilever", "ball_on_frame"),
    *("collision_iii", "newtons_cradle", "billiards_break", "pile", "staircase", "galperin_pi"),
)


class Load(FileScene):
    """Opening a model by its name or its picture.

    welcome: the program was just started; the heading says what it is.
    """

    name = "load"
    heading = marked("Open")

    def __init__(self) -> None:
        super().__init__()
        self.welcome = False
        self._asked = False  # the person chose once to discard unsaved work

    def make_form(self, context: Context) -> Form:
        self._asked = False
        own, about = tr("draw your own"), tr("An empty plane to draw on.")
        new = Tile(tr(LESSONS), tr("New, empty model"), own, "", NEW, about, "+")
        learn = _tasks()
        held = tr("{tasks} to do, {films} to watch", tasks=len(learn), films=len(lessons()))
        rest = Tile(tr(LESSONS), tr("All lessons"), held, "", ALL, symbol="»", rest=True)
        films = [Script(name) for name in lessons()]
        watch = [
            Tile(tr(LESSONS), tr(s.title), tr("a lesson to watch"), s.name, s, tr(s.description), "▶")
            for s in films
        ]
        offers = [*_yours(context), *learn[:1], new, *learn[1:], *watch, rest, *_examples()]
        heading = tr("Open a model")
        if self.welcome:
            heading = tr("Welcome to Pinjoint. What would you like to begin with?")
        form = self.new_form(heading, "", offers, tr("Open"))
        form.boxes[0].note = tr("type to search, or click a picture")
        return form

    def exit(self, context: Context) -> None:
        super().exit(context)
        self.welcome = False

    def choose(self, context: Context, tile: Tile) -> None:
        """Open the source of a tile; the tile "Discard", chosen twice, discards unsaved work."""
        if tile.source is ALL:
            self.form.tiles.remove(tile)
        elif tile.source is not DISCARD:
            self._open(context, tile.source)
        elif self._asked and context.autosave is not None:
            context.autosave.discard()
            self.form = self.make_form(context)
        else:
            self._asked = True
            self.form.chosen = tile
            self.form.message = tr(
                "Unsaved work of earlier windows will be deleted for ever. Choose this again to delete it, or press Esc to"
                " keep it."
            )

    def accept(self, context: Context) -> None:
        """Return: open the chosen tile, else the model whose name was typed, else the first visible tile."""
        if self.folder.text != self.folder.opened:
            if self.take_folder(make=False):
                self.form = self.make_form(context)
            return
        name, chosen = self.box.text.strip(), self.form.chosen
        left = [tile for tile in self.form.tiles if not tile.hidden]
        if chosen is not None:
            self.choose(context, chosen)
        elif not name:
            self.form.message = tr("Type a name, or choose a picture with the arrow keys.")
        elif (source := library.find(name)) is not None:
            self._open(context, source)
        elif left:
            self.choose(context, left[0])
        else:
            nearest = library.nearest(name)
            missing = tr("File not found: there is no model '{name}'.", name=name)
            self.form.message = joined([missing, tr("Did you mean '{name}'?", name=nearest) if nearest else ""])

    def _open(self, context: Context, source: Any) -> None:
        try:
            if isinstance(source, Script) and source.task_count:
                context.lesson = source  # it opens its models itself
            elif isinstance(source, Script):
                context.documents.open(source.source)
                context.lesson = source
            elif context.autosave is not None and source in context.autosave.left():
                context.documents.open(source, ModelFile(None, recovered_name(source)))
                context.autosave.take_over(source, context.document)
            else:
                context.documents.open(source)
        except models.ModelError as error:
            self.form.message = str(error)
        else:
            mode, lesson = context.model.settings.opens_in, context.lesson
            if lesson is not None:  # one with tasks leads back to where one was
                mode = context.scenes.hub if lesson.task_count else PAUSE
            context.scenes.request(mode)
            if source in PLAYED:
                context.scenes.request(SIMULATION)
                context.notice = tr(context.model.description).partition(". ")[0] + "."

    def changed(self, context: Context) -> None:
        """Show the tiles whose titles or names contain every word that was typed."""
        super().changed(context)
        self._asked = False
        words = self.box.text.lower().split()
        for tile in self.form.tiles:
            told = f"{tr(tile.title)} {tile.title} {tile.file}".lower()
            tile.hidden = bool(words) and (tile.rest or not all(word in told for word in words))
        self.form.first = 0
        if words and all(tile.hidden for tile in self.form.tiles):
            self.form.message = tr("No model or lesson has this in its name. Delete characters with Backspace.")

    def hint(self, context: Context) -> str:
        _, shown, count = self.layout(context).paper.scrolled
        more = tr("Wheel shows more") if shown < count else ""
        steps = tr("Arrows choose     Return open     Type to search     Esc back")
        return joined([tr("Click a picture"), more, steps], BETWEEN)


def _yours(context: Context) -> list[Tile]:
    """Unsaved work that windows left behind, and saved models, the newest first."""
    files = context.autosave.left() if context.autosave is not None else []
    offers = []
    for path in files:
        title, age = recovered_name(path) or tr("Untitled"), library.written_age(path)
        offers.append(Tile(tr(YOURS), title, joined([tr("not saved"), age], ", "), "", path))
    if offers:
        offers.append(Tile(tr(YOURS), tr("Discard"), tr("unsaved work"), "", DISCARD, symbol="×"))
    offers += saved_models(tr(YOURS))
    count = sum(offer.source is not DISCARD for offer in offers)
    everything = Tile(
        tr(YOURS), tr("All {count}", count=count), tr("your models"), "", ALL, symbol="»", rest=True
    )
    return [*offers, everything] if offers else []


def _tasks() -> list[Tile]:
    """The lessons with tasks, from the first that is not done on; then those that are done."""
    offers, scripts = [], shelf()
    for script in sorted(scripts, key=is_done):
        count, done = script.task_count, len(progress.done(script.name).tasks)
        caption = tr("a lesson of {count} tasks", count=count)
        if is_done(script):
            caption = tr("done: all {count} tasks", count=count)
        elif done:
            caption = tr("continue: {done} of {count} tasks done", done=done, count=count)
        title, about = tr(script.title), tr(script.description)
        offers.append(
            Tile(tr(LESSONS), title, caption, script.name, script, about, "✓" if is_done(script) else "▶")
        )
    if offers and not is_done(offers[0].source):
        first, title = offers[0].source, offers[0].title
        begun = first is not scripts[0] or progress.done(first.name).tasks
        title = tr("Continue: {lesson}", lesson=title) if begun else tr("Learn: {lesson}", lesson=title)
        offers[0].title = title
    return offers


def _examples() -> list[Tile]:
    """The bundled models by subject, of each the first and a tile that stands for the rest."""
    told = {name: models.header_of(name) for name in models.bundled()}
    names = sorted(told, key=lambda name: told[name].title)
    names.sort(key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST))
    subject = {name: (BENDING if of.bends else TRUSSES) if of.rods else COLLISIONS for name, of in told.items()}
    subject |= dict.fromkeys(PLAYED, PLAYGROUND)
    offers = []
    for section in EXAMPLES:
        some = [name for name in names if subject[name] == section]
        offers += [Tile(tr(section), tr(told[n].title or n), n, n, n, tr(told[n].description)) for n in some]
        offers.append(
            Tile(tr(section), tr("All {count}", count=len(some)), tr(section), "", ALL, symbol="»", rest=True)
        )
    return offers
