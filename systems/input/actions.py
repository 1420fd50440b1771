"""Actions: one record of each thing that a person can do, of which keys, toolbar, menus, help and mods are queries."""

from __future__ import annotations

from collections import UserDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.language import marked, tr
from pinjoint.components.settings import HUBS
from pinjoint.components.wording import missing

SIMULATION = "simulation"
PROPERTIES, SAVE, LOAD = "properties", "save", "load"
METHODS = FORCE_METHOD, DISPLACEMENT_METHOD = "force method", "displacement method"
LIVE = (SIMULATION, *HUBS)
FORMS = (PROPERTIES, SAVE, LOAD)
EVERY = (*LIVE, *FORMS, *METHODS)
IN_LESSONS = (*LIVE, PROPERTIES, *METHODS)
IN_PICTURES = (*LIVE, *METHODS)
MENU = "menu"  # no scene: the keys while a menu is open
TABLE = "table"  # no scene: the keys while the pointer is over a table of results

TEXT = "text "  # prefix of the "key" of typed text, such as "text a"
FILES = "files "  # prefix of the "key" of files dropped on the window: their paths, a line each

_MODIFIERS = {"ctrl+": "ctrl+", "control+": "ctrl+", "cmd+": "ctrl+", "shift+": "shift+"}
_ALSO_CALLED = {"esc": "escape", "enter": "return", "del": "delete", "spacebar": "space", " ": "space"}
_ALSO_CALLED |= {"pageup": "page up", "pagedown": "page down"}

# In the order in which the help lists them.
_PURPOSES = (
    *(marked("Time"), marked("Draw"), marked("Select and edit"), marked("Results"), marked("Methods")),
    *(marked("Boxes"), marked("View"), marked("Lessons"), marked("Files"), marked("Menu"), marked("More")),
)

Perform = Callable[[Any, Vector], object]  # is given the context, and the pixel where the pointer is
Condition = Callable[[Any], object]  # of the context: whether something is so

P = TypeVar("P", bound=Perform)


@dataclass(frozen=True)
class Binding:
    """A way to an action in some scenes: a key (or "click", "wheel up", …), or "" for what only buttons and menus offer.

    Key names are lower case: "escape", "return", "space", "a", "+", "left", "f1"; modifiers come first,
    in the order ctrl, shift: "ctrl+z", "ctrl+shift+z". "drag" begins a drag, "drag to" and "drop" follow.
    title: for the help, tips and menus, translated where shown; "" leaves the key out of the help.
    """

    key: str
    scenes: tuple[str, ...]
    title: str = ""


@dataclass(frozen=True)
class Action:
    """Something that a person can do, and all that is said of it anywhere.

    bindings: the keys by which it is done, where, and what it is called there. purpose: under which the help lists it.
    repeats: while its key is held. while_drawing: it belongs to a gesture or only looks; all others end the gesture first.
    in_menu: it keeps an open menu open. enabled: whether it would do something now. pressed: whether what it shows is on.
    pressed_as: icon and title of its button while it is on; "": as ever. draws: of tools, begins the gesture.
    begins: of tools, where it would begin (m), which a ring marks. hint: the status line while clicks use it as a tool.
    """

    name: str
    perform: Perform
    bindings: tuple[Binding, ...] = ()
    purpose: str = "More"
    repeats: bool = False
    while_drawing: bool = False
    in_menu: bool = False
    enabled: Condition = lambda context: True
    pressed: Condition = lambda context: False
    pressed_as: Callable[[Any], tuple[str, str]] = lambda context: ("", "")
    draws: Callable[[Any, Vector], Any] | None = None
    begins: Callable[[Any, Vector], Vector | None] = lambda context, pixel: None
    hint: str = ""


class Actions(UserDict[str, Action]):
    """All actions by name, and what follows from them: which does what a key does, and how each is offered."""

    def __init__(self) -> None:
        super().__init__()
        self._index()

    def _index(self) -> None:
        """Forget what follows from the actions: by scene and key, and by name and scene."""
        self._by_key: dict[tuple[str, str], tuple[Action, Binding]] = {}
        self._offers: dict[tuple[str, str, str], Binding | None] = {}
        self._known: set[str] = set()  # keys, without those that are held beside them

    def __setitem__(self, name: str, action: Action) -> None:
        super().__setitem__(name, action)
        self._index()

    def __delitem__(self, name: str) -> None:
        super().__delitem__(name)
        self._index()

    def bound(self) -> Iterator[tuple[Action, Binding]]:
        """Every key with its action, by purpose."""
        for action in sorted(self.values(), key=lambda action: _PURPOSES.index(action.purpose)):
            yield from ((action, binding) for binding in action.bindings if binding.key)

    def at(self, scene: str, key: str) -> tuple[Action, Binding] | None:
        """What a key does in a scene; in scenes of mods, keys that do the same in all of ours do so, too."""
        found = self._keys.get((scene, key)) or self._keys.get((EXTENSIONS.likes.get(scene, ""), key))
        if found is None and scene not in EVERY:
            found = self._keys.get((EVERY[0], key))
            return found if found is not None and set(EVERY) <= set(found[1].scenes) else None
        return found

    @property
    def _keys(self) -> dict[tuple[str, str], tuple[Action, Binding]]:
        if not self._by_key:
            self._by_key = {(scene, b.key): (a, b) for a, b in self.bound() for scene in b.scenes}
        return self._by_key

    def offer(self, name: str, scene: str) -> Binding | None:
        """How toolbar and menus offer an action in a scene; the same while time passes as in pause. None: they do not.

        Keys that perform it in the scene come first, then those of the other, then no key.
        """
        like = EXTENSIONS.likes.get(scene, scene)
        if (name, scene, like) not in self._offers:
            found = sorted(self[name].bindings if name in self else (), key=lambda binding: not binding.key)
            scenes = (scene, like, *(LIVE if like in LIVE else ()))
            offers = (binding for where in scenes for binding in found if where in binding.scenes)
            self._offers[name, scene, like] = next(offers, None)
        return self._offers[name, scene, like]

    def bind(self, name: str, binding: Binding) -> list[tuple[Action, Binding]]:
        """Let a key perform an action in the scenes in which it is free; returns what has it in the others."""
        taken = {s: self._keys[s, binding.key] for s in binding.scenes if (s, binding.key) in self._keys}
        free = replace(binding, scenes=tuple(scene for scene in binding.scenes if scene not in taken))
        if free.scenes:
            self[name] = replace(self[name], bindings=(*self[name].bindings, free))
        return list(dict.fromkeys(taken.values()))

    def prefer(self, scene: str, key: str, name: str) -> None:
        """Let a key perform the action that a person chose, whatever it did before."""
        if name not in self:
            return
        if (former := self._keys.get((scene, key))) is not None:
            action, old = former
            left = replace(old, scenes=tuple(other for other in old.scenes if other != scene))
            self[action.name] = replace(
                action, bindings=tuple(left if b is old else b for b in action.bindings)
            )
        titles = [binding.title for binding in self[name].bindings]
        self.bind(name, Binding(key, (scene,), (titles or [name])[0]))

    def name_at(self, scene: str, key: str) -> str | None:
        """The action that a key performs in a scene, or None."""
        found = self.at(scene, key)
        return found[0].name if found else None

    def key_named(self, text: str) -> str:
        """The name that bindings use for a key such as "K", "Esc" or "Ctrl+Z". Raises ValueError if there is no such key.

        Shift with a character is the same key: on some keyboards "+" needs it, on others not.
        """
        if text.startswith((TEXT, FILES)):
            return text
        name, held = text.lower(), set()
        while modifier := next((m for m in _MODIFIERS if name.startswith(m) and len(name) > len(m)), None):
            held.add(_MODIFIERS[modifier])
            name = name.removeprefix(modifier)
        name = _ALSO_CALLED.get(name, name)
        if not self._known:
            bound = (binding.key for _, binding in self.bound())
            self._known = {key.removeprefix("ctrl+").removeprefix("shift+") for key in bound}
            self._known |= {"insert", "caps lock", "print screen", "menu", *(f"f{n}" for n in range(1, 13))}
        if len(name) != 1 and name not in self._known:
            raise ValueError(missing(marked("keys"), text, sorted(key for key in self._known if len(key) > 1)))
        if len(name) == 1 and "ctrl+" not in held:
            held.clear()
        return "".join(sorted(held)) + name  # ctrl comes before shift

    def help_lines(self, scene: str) -> list[tuple[str, str]]:
        """(key, title) of all keys of a scene by purpose, in the present language; before those of each, ("", purpose)."""
        lines: dict[str, list[tuple[str, str]]] = {}
        for action, binding in self.bound():
            found = self.at(scene, binding.key)
            if binding.title and found is not None and found[1] is binding:
                heading = [("", tr(action.purpose))]
                lines.setdefault(action.purpose, heading).append((binding.key, tr(binding.title)))
        return [line for keys in lines.values() for line in keys]


ACTIONS = Actions()


def actions_of(purpose: str, scenes: tuple[str, ...] = LIVE, **usual: Any) -> Callable[..., Callable[[P], P]]:
    """The decorator that registers functions of (context, pixel) as actions of a purpose, with what is usual of them.

    It is given the name, a key (or keys) and a title if there are, other scenes, and other facts. Stacked, those above the
    lowest bind further keys.
    """

    def action(
        name: str, keys: str | tuple[str, ...] = (), title: str = "", where: Any = scenes, **facts: Any
    ) -> Any:
        several = (keys,) if isinstance(keys, str) else keys
        bindings = [Binding(key, where, title) for key in several]

        def register(perform: P) -> P:
            known = ACTIONS.get(name) or Action(name, perform, (), purpose, **usual | facts)
            assert known.perform is perform, f"there is an action '{name}' already"
            ACTIONS[name] = replace(known, bindings=(*known.bindings, *bindings))
            return perform

        return register

    return action
