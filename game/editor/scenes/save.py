"""Save: giving the model a name and a file."""

from __future__ import annotations

from pinjoint.components.form import Form, Tile
from pinjoint.components.language import marked, tr
from pinjoint.documents import library, models
from pinjoint.editor.context import Context
from pinjoint.editor.scenes.files import FileScene, saved_models
from pinjoint.systems.forms import typing


class Save(FileScene):
    """Saving under a name; a model of that name is replaced only when Return is pressed twice."""

    name = "save"
    heading = marked("Save")

    def __init__(self) -> None:
        super().__init__()
        self._confirmed = ""

    def make_form(self, context: Context) -> Form:
        self._confirmed = ""
        form = self.new_form(tr("Save"), context.document.file.name, saved_models(), tr("Save"))
        form.boxes[0].explanation = tr("A file in {folder}", folder=library.models_folder())
        return form

    def choose(self, context: Context, tile: Tile) -> None:
        """Take the name of a tile, to use it again or change it a little."""
        self.form.chosen = None
        typing.select(self.form, self.box)
        typing.put(self.form, self.box, tile.file)
        self.changed(context)

    def move(self, context: Context, direction: str) -> None:
        super().move(context, direction)
        chosen = self.form.chosen
        if chosen is not None and self.box.text != chosen.file:
            typing.put(self.form, self.box, chosen.file)
            self.say("")

    def accept(self, context: Context) -> None:
        """Return: save."""
        name = self.box.text.strip()
        try:
            path = library.path_of(name)
            if path.exists() and self._confirmed != name:
                self._confirmed = name
                self.say(
                    tr(
                        "There is already a model '{name}'. Press Return again to replace it, or Esc to keep it.",
                        name=name,
                    )
                )
                return
            path.parent.mkdir(parents=True, exist_ok=True)
            context.save_as(path)
        except OSError as error:
            self.say(
                tr(
                    "The folder {folder} cannot be made: {reason}. Set the variable {variable} to a folder where you may"
                    " write, and start Pinjoint again.",
                    folder=library.models_folder(),
                    reason=error.strerror,
                    variable=library.DATA_VARIABLE,
                )
            )
            return
        except (library.NameRefused, models.ModelError) as error:
            self.say(str(error))
            return
        context.scenes.request("pause")

    def changed(self, context: Context) -> None:
        super().changed(context)
        self._confirmed = ""

    def hint(self, context: Context) -> str:
        return tr("Type a name     Return save     Esc back")
