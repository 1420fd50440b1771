"""App: what a mod's `plugin(app)` registers with."""

from __future__ import annotations

import gettext
from collections.abc import Callable, Container, MutableMapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pinjoint.commands import Command
from pinjoint.components.additions import Component
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Role
from pinjoint.components.handle import Handle
from pinjoint.components.language import LANGUAGES, joined, language, marked, plural, speak, tr
from pinjoint.components.load import HISTORIES, HistoryKind
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import KINDS, Model
from pinjoint.components.obstacles import Shape
from pinjoint.components.table import fields_of
from pinjoint.components.wording import is_identifier, missing
from pinjoint.documents import models
from pinjoint.documents.format import Upgrade
from pinjoint.mods.declared import check
from pinjoint.mods.guard import Guard, Panel
from pinjoint.mods.mod import Mod, ModError
from pinjoint.systems.base import Integrator, System
from pinjoint.systems.input.actions import ACTIONS, LIVE, Action, Binding, Perform
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.render.model.sheet import Layer
from pinjoint.systems.render.symbols import Part, check_icon

if TYPE_CHECKING:  # a command needs no editor
    from pinjoint.editor.context import Scene


class App:
    """The program, as a mod's `plugin(app)` sees it: one method for each kind of extension.

    If `plugin` raises, everything that it registered is taken back. An exception in registered code switches the
    whole mod off, and the session goes on.
    """

    def __init__(self, mod: Mod) -> None:
        self._mod, self._guard = mod, Guard(mod)
        self._undo: list[Callable[[], object]] = []

    @property
    def name(self) -> str:
        """The mod's name."""
        return self._mod.name

    # --- data and physics ----------------------------------------------------------------------------

    def component(self, component: type[Component]) -> None:
        """Add the Fields of a component to all elements of its kind; see components.Component.

        Raises ValueError if a column of that name is there, or a Field is none that a mod can add.
        """
        mod, kind, fields = self.name, component.of, fields_of(component)
        self._guard.checkers(fields)
        names = [f"{mod}_{field.name.removeprefix(f'{mod}_')}" for field in fields]
        for field, name in zip(fields, names, strict=True):
            if hasattr(kind, name):
                raise WrongValue(
                    "{component}: {table} have a '{name}' already; give this Field another name.",
                    component=component.__name__,
                    table=kind.table,
                    name=name,
                )
            if field.references is not None or field.role is Role.DERIVED:
                raise WrongValue(
                    "{component}.{field}: a mod cannot add references or derived columns, only Fields with values of"
                    " their own (document or state).",
                    component=component.__name__,
                    field=field.name,
                )
            field.check_default(component.__name__)
        for field, name in zip(fields, names, strict=True):
            field.name, field.component = name, f"{mod}.{component.__name__}"
            field.key = field.key.removeprefix(f"{mod}_")
            setattr(kind, name, field)
            self._undo.append(partial(delattr, kind, name))
        self._keeps_data()

    def kind(self, kind: type[Handle]) -> None:
        """Add a kind of elements: a class with Fields, whose table every model has; see components.Handle.

        Files keep them under "components": {"<mod>.<Kind>": […]}. Those with `points` can be picked, dragged,
        copied and selected in a box like others; a layer of the mod draws them. Raises ValueError if a model has such
        elements already, or a Field is none that a mod can add.
        """
        fields = {field.name: field for field in fields_of(kind)}
        self._guard.checkers(fields.values())
        others: list[type[Handle]] = [*KINDS, *EXTENSIONS.kinds.values()]
        for part in ("table", "noun"):
            word = getattr(kind, part, "")
            if not word or word in [getattr(other, part) for other in others]:
                raise WrongValue(
                    "{name}: its {part} '{word}' is missing or already used; give it another.",
                    name=kind.__name__,
                    part=part,
                    word=word,
                )
        if not is_identifier(kind.table) or hasattr(Model, kind.table):
            raise WrongValue(
                "{name}: '{table}' cannot be the name of a table; use another word.",
                name=kind.__name__,
                table=kind.table,
            )
        if kind.single:
            raise WrongValue(
                "{name}: a mod's kind cannot be `single`. For facts about the whole model, add a component of"
                " Settings or Environment.",
                name=kind.__name__,
            )
        if "name" not in fields or fields["name"].dtype is not str:
            raise WrongValue(
                "{name} needs a Field 'name' of dtype str, by which people tell its elements apart.",
                name=kind.__name__,
            )
        for field in fields.values():
            if field.role is Role.DERIVED:
                raise WrongValue(
                    "{name}.{field}: a mod cannot add derived columns.", name=kind.__name__, field=field.name
                )
            tables = [other.table for other in others]
            if field.references is not None and field.references not in tables:
                where = f"{kind.__name__}.{field.name}:"
                raise ModError(joined([where, missing(marked("tables"), str(field.references), tables)]))
            field.check_default(kind.__name__)
        for point in kind.points:
            if point not in fields or fields[point].shape != (2,) or fields[point].role is not Role.DOCUMENT:
                raise WrongValue(
                    "{name}: its point '{point}' must be one of its Fields, of shape (2,) and with the role DOCUMENT.",
                    name=kind.__name__,
                    point=point,
                )
        self._put(EXTENSIONS.kinds, f"{self.name}.{kind.__name__}", kind)
        self._keeps_data()

    def upgrade(self, upgrade: Upgrade) -> None:
        """Bring data of earlier versions of the mod in files up to date, such as Fields that were renamed.

        upgrade(document, version) changes the document, what a model file says, before it is read. version: of the
        mod that wrote the file, older than the present one; "" if the file does not say.
        """
        name, what = self.name, tr("upgrading its data in a file")

        def upgraded(document: dict[str, Any], version: str) -> None:
            self._mod.call(what, upgrade, document, version)
            if self._mod.off:
                raise WrongValue(
                    "the data of {mod} {version} could not be upgraded; --no-mods opens it without the mod.",
                    mod=name,
                    version=version or "?",
                )

        self._put(EXTENSIONS.upgrades, name, upgraded)

    def tool(self, kind: type[Handle], *, key: str, title: str = "", icon: Sequence[Part] = ()) -> None:
        """Let a person draw elements of a kind with points, from one to the next, by a key and a button.

        The action is "<mod>.<noun>". icon: lines and areas, as in systems/render/symbols.py; none, no button.
        """
        if not kind.points:
            raise ModError("A tool draws points; name those of {kind} in its `points`.", kind=kind.__name__)
        name = f"{self.name}.{kind.noun}"

        def drawing() -> Any:
            from pinjoint.editor.gestures.drawing import DrawElement

            return DrawElement.of(kind, name, key)

        keyed = {"table": tr(kind.table), "key": key.upper()}
        if len(kind.points) == 2:
            hint = tr("{table}: click two points, or drag from one to the other     {key} or Esc done", **keyed)
        else:
            hint = plural(
                "{table}: click where you want them     {key} or Esc done",
                "{table}: click {count} points, one after the other     {key} or Esc done",
                len(kind.points),
                **keyed,
            )
        act = self._guard.action(name, lambda context, pixel: drawing().use(context, pixel))
        self._act(
            Action(
                name,
                act,
                while_drawing=True,
                begins=lambda context, pixel: drawing().place(context, pixel),
                draws=(lambda context, pixel: drawing().begin(context, pixel)) if kind.points[1:] else None,
                hint=hint,
            )
        )
        self.key(key, name, title=title or tr("{kind}, from point to point", kind=tr(kind.noun)))
        self._icon(name, icon)

    def shape(self, kind: type[Handle], shape: Shape) -> None:
        """Let particles collide with elements of a kind: `shape(table)` returns the Pieces that they are."""
        if kind in EXTENSIONS.obstacles:
            raise ModError("The shape of {table} is registered already; register it once.", table=kind.table)
        self._put(EXTENSIONS.obstacles, kind, self._guard.shape(kind, shape))

    def system(self, system: Callable[[], System]) -> None:
        """Add a frame system, a law or a commit, by its class: every session makes one of its own."""
        name = getattr(system, "name", "")
        self._check_prefix("system", name or getattr(system, "__name__", "?"))
        self._add(EXTENSIONS.systems, self._guard.system(system))

    def integrator(self, integrator: type[Integrator]) -> None:
        """Add an integrator that models, the command line and the properties can choose."""
        self._check_prefix("integrator", integrator.name)
        made = self._guard.integrator(integrator())
        self._check_free(marked("an integrator"), made.key, INTEGRATORS)
        self._put(INTEGRATORS, made.key, made)

    def history(self, kind: HistoryKind) -> None:
        """Add a way in which loads change in time."""
        kind = self._guard.history(kind)
        self._check_free(marked("a kind of history"), kind.name, HISTORIES)
        self._put(HISTORIES, kind.name, kind)

    def models(self, folder: str | Path) -> None:
        """Let the models in a folder be opened by name, like those that come with Pinjoint."""
        path = Path(folder)
        if not path.is_dir():
            raise ModError("There is no folder of models {folder}; check its path.", folder=path)
        for file in sorted(path.glob("*.json")):
            self._check_free(marked("a bundled model"), file.stem, models.bundled())
        self._add(EXTENSIONS.folders, path)

    # --- scenes, actions, keys -------------------------------------------------------------------------

    def scene(self, scene: type[Scene]) -> None:
        """Add a mode. Its `sources` are the scenes from which it can be reached; "pause" must be a target.

        like: the one of ours as in which keys, clicks, tools and systems act in it that it does not use otherwise.
        """
        from pinjoint.editor import scenes

        self._check_free(marked("a scene"), scene.name, {other.name for other in scenes.all_scenes()})
        made = self._guard.scene(scene, scenes.Scene)
        if "pause" not in scene.targets:
            raise ModError(
                "The scene '{name}' must lead to pause; add 'pause' to its targets.", name=scene.name
            )
        if scene.like not in ("", *LIVE):
            raise ModError(joined([f"{scene.__name__}.like:", missing(marked("scenes"), scene.like, LIVE)]))
        if hasattr(scene, "advance"):
            raise ModError(
                "The scene '{name}' has a method 'advance', which is no longer called; write a System with"
                " phase = Phase.STEP and scenes = ('{name}',), and register it by app.system.",
                name=scene.name,
            )
        self._add(EXTENSIONS.scenes, made)
        if scene.like:
            self._put(EXTENSIONS.likes, scene.name, scene.like)

    def action(
        self,
        name: str,
        *,
        key: str = "",
        scenes: Sequence[str] = LIVE,
        title: str = "",
        while_drawing: bool = False,
        icon: Sequence[Part] = (),
    ) -> Callable[[Perform], Perform]:
        """Register a function(session, pixel) as a named action, and perhaps a key and a button for it.

        Everything that it changes in the model is one step of undo, dropped whole if it raises. icon: of its button
        in the toolbar of these scenes, as that of a tool; none, no button.
        """
        self._check_prefix("action", name)

        def register(function: Perform) -> Perform:
            act = self._guard.action(name, function, title)
            offered = (Binding("", tuple(scenes), title or name),) if icon else ()
            self._act(Action(name, act, offered, while_drawing=while_drawing))
            if key:
                self.key(key, name, scenes, title)
            self._icon(name, icon)
            return function

        return register

    def _act(self, action: Action) -> None:
        self._check_free(marked("an action"), action.name, ACTIONS)
        self._put(ACTIONS, action.name, action)

    def key(self, key: str, name: str, scenes: Sequence[str] = LIVE, title: str = "") -> None:
        """Let a key, such as "w" or "ctrl+w", perform a named action in some scenes.

        A key that does something there already goes on doing it, and that is reported; a person can decide
        otherwise in the settings file, {"keys": {"pause": {"w": "wind.toggle"}}}.
        """
        if name not in ACTIONS:
            raise ModError(
                "The key '{key}' is for the action '{name}', which is not registered; register the action first.",
                key=key,
                name=name,
            )
        key = _checked_key(key)
        check(title, str, "title")
        before = ACTIONS[name]
        self._undo.append(lambda: ACTIONS.__setitem__(name, before))
        for other, taken in ACTIONS.bind(name, Binding(key, tuple(scenes), title or name)):
            self._mod.notes.append(
                tr(
                    "The key '{key}' for {name} already does '{other}' in {scenes}; to change that, write {form} in the"
                    " settings file.",
                    key=key,
                    name=name,
                    other=other.name,
                    scenes=", ".join(taken.scenes),
                    form=f'{{"keys": {{"{taken.scenes[0]}": {{"{key}": "{name}"}}}}}}',
                )
            )

    def command(self, name: str, run: Callable[[list[str]], int], about: str = "") -> None:
        """Add `pinjoint <name> …`: `run` gets the words after it and returns the exit status; --help says what about.

        UsageError, ModelError, FieldError and PathError that it raises are shown as mistakes of the person.
        """
        self._check_free(marked("a command"), name, EXTENSIONS.commands)
        self._put(EXTENSIONS.commands, name, Command(self._guard.command(name, run), about))

    # --- what is seen ------------------------------------------------------------------------------------

    def layer(self, draw: Layer, *, below: bool = False) -> None:
        """Draw marks with every picture of a model, above its elements or below them; see systems/render/marks.py."""
        self._add(EXTENSIONS.below if below else EXTENSIONS.above, self._guard.layer(draw))

    def panel(self, read: Panel) -> None:
        """Show small panels beside the model: `read(session)` returns a Readout, several, or None."""
        self._add(EXTENSIONS.panels, self._guard.panel(read))

    def catalogues(self) -> None:
        """Say what the mod says in the languages of its folder `locale`, if it has one; Pinjoint calls this itself."""
        folder = self._mod.folder / "locale" if self._mod.folder is not None else None
        if folder is None or not folder.is_dir():
            return
        for code in LANGUAGES:
            try:
                gettext.translation(self.name, folder, languages=[code], fallback=True)
            except Exception as error:  # whatever damaged bytes lead to
                place = folder / code / "LC_MESSAGES" / f"{self.name}.mo"
                raise ModError("The catalogue {file} cannot be read; compile it again.", file=place) from error
        EXTENSIONS.catalogues[self.name] = folder
        self._undo += [lambda: speak(language()), lambda: EXTENSIONS.catalogues.pop(self.name)]
        speak(language())

    def _icon(self, name: str, icon: Sequence[Part]) -> None:
        if not icon:
            return
        try:
            check_icon(icon)
        except ValueError as error:
            raise ModError("The icon of '{name}': {error}", name=name, error=error) from None
        self._put(EXTENSIONS.icons, name, tuple(icon))

    def _keeps_data(self) -> None:
        """Note the version, which files state that hold data of the mod."""
        if not self._mod.included and self.name not in EXTENSIONS.versions:
            self._put(EXTENSIONS.versions, self.name, self._mod.version)

    # --- all or nothing ------------------------------------------------------------------------------------

    def withdraw(self) -> None:
        """Take back everything that was registered, the last first."""
        while self._undo:
            self._undo.pop()()

    def _put(self, entries: MutableMapping[Any, Any], key: Any, entry: Any) -> None:
        entries[key] = entry
        self._undo.append(lambda: entries.pop(key))

    def _add(self, entries: list[Any], entry: Any) -> None:
        entries.append(entry)
        self._undo.append(lambda: entries.remove(entry))

    def _check_free(self, noun: str, name: str, taken: Container[str]) -> None:
        if name in taken:
            raise ModError("There is {noun} '{name}' already; choose another name.", noun=tr(noun), name=name)

    def _check_prefix(self, what: str, name: str) -> None:
        if not name.startswith(f"{self.name}."):
            raise ModError(
                "The name of the {kind} '{name}' must begin with the name of its mod, such as '{better}'.",
                kind=what,
                name=name,
                better=f"{self.name}.{name}",
            )


def _checked_key(key: str) -> str:
    """The name of a key in the bindings. Raises ModError."""
    try:
        named = ACTIONS.key_named(key)
    except ValueError as error:
        names = tr("Keys have names such as 'w', 'ctrl+w', 'page up' or 'f5'.")
        raise ModError(joined([str(error), names])) from None
    if "shift" in key.lower() and "shift" not in named:
        raise ModError(
            "The key '{key}' is the same as '{named}'; use that, or 'ctrl+shift+{named}'.", key=key, named=named
        )
    return named
