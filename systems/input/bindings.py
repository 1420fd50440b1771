"""The table of keys and buttons: the key, the named action that it performs, and the scenes in which it does."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import marked, tr
from pinjoint.components.suggestions import missing

SIMULATION, PAUSE = "simulation", "pause"
PROPERTIES, SAVE, LOAD, FORCE_METHOD = "properties", "save", "load", "force method"
LIVE = (SIMULATION, PAUSE)
FORMS = (PROPERTIES, SAVE, LOAD)
EVERY = (*LIVE, *FORMS, FORCE_METHOD)
IN_LESSONS = (*LIVE, PROPERTIES, FORCE_METHOD)
MENU = "menu"  # no scene: the keys while a menu is open

TEXT = "text "  # prefix of the "key" of typed text, such as "text a"
FILES = "files "  # prefix of the "key" of files dropped on the window: their paths, a line each

MODIFIERS = {"ctrl+": "ctrl+", "control+": "ctrl+", "cmd+": "ctrl+", "shift+": "shift+"}
ALSO_CALLED = {"esc": "escape", "enter": "return", "del": "delete", "spacebar": "space", " ": "space"}
ALSO_CALLED |= {"pageup": "page up", "pagedown": "page down"}
UNBOUND = ("insert", "caps lock", "print screen", "menu", *(f"f{number}" for number in range(1, 13)))


@dataclass(frozen=True)
class Binding:
    """A key (or "click", "wheel up", …) that performs an action in some scenes.

    Key names are lower case: "escape", "return", "space", "a", "+", "left", "f1"; modifiers come first,
    in the order ctrl, shift: "ctrl+z", "ctrl+shift+z". "drag" begins a drag, "drag to" and "drop" follow.
    title: for the help, tips and menus, translated where shown; "" leaves the key out of the help. repeats: the action is
    repeated while the key is held. group: the purpose under which the help lists it.
    """

    key: str
    action: str
    scenes: tuple[str, ...]
    title: str = ""
    repeats: bool = False
    group: str = marked("More")


# By purpose, in the order in which the help lists them. The keys of an open menu go before those of its scene.
_BY_PURPOSE: dict[str, tuple[Binding, ...]] = {
    marked("Time"): (
        Binding("space", "toggle run", LIVE, "run or pause"),
        Binding("right", "arrow right", (PAUSE,), "step forward", repeats=True),
        Binding("left", "arrow left", (PAUSE,), "step back", repeats=True),
        Binding("shift+right", "far arrow right", (PAUSE,), "skip ahead", repeats=True),
        Binding("shift+left", "far arrow left", (PAUSE,), "skip back", repeats=True),
        Binding(".", "step", (PAUSE,), "step forward", repeats=True),
        Binding(",", "step back", (PAUSE,), "step back", repeats=True),
        Binding("r", "restart", LIVE, "restart from the undeformed shape"),
        Binding("e", "settle", LIVE, "find equilibrium at once"),
        Binding("+", "faster", LIVE, "run faster", repeats=True),
        Binding("-", "slower", LIVE, "run slower", repeats=True),
        Binding("0", "natural pace", LIVE, "reset the speed to suit the model"),
    ),
    marked("Draw"): (
        Binding("p", "place", LIVE, "draw a particle"),
        Binding("l", "rod", LIVE, "draw a rod between two particles"),
        Binding("ctrl+r", "rigid", LIVE, "draw frame rods, or make selected rods rigid"),
        Binding("ctrl+j", "hinge", LIVE, "hinge an end of a rod, or make it rigid"),
        Binding("c", "support", LIVE, "add or change a support"),
        Binding("f", "force", LIVE, "draw a load on a particle or a rod"),
        Binding("ctrl+m", "moment", LIVE, "draw a moment on a particle"),
        Binding("v", "velocity", LIVE, "draw the velocity of a particle"),
        Binding("g", "new grid", (PAUSE,), "add a grid"),
        Binding("h", "next grid", (PAUSE,), "show the next grid"),
    ),
    marked("Select and edit"): (
        Binding("click", "select", LIVE, "select"),
        Binding("ctrl+click", "add to selection", LIVE, "add to the selection"),
        Binding("double click", "open", LIVE, "open the properties of an element"),
        Binding("right click", "open menu", (*LIVE, FORCE_METHOD), "open the menu at the pointer"),
        Binding("menu", "open menu", (*LIVE, FORCE_METHOD), "open the menu at the pointer"),
        Binding("shift+f10", "open menu", (*LIVE, FORCE_METHOD)),
        Binding("drag", "drag", (PAUSE,), "move an element, or select in a box"),
        Binding("drag", "drag", (SIMULATION,), "pull a particle, or select in a box"),
        Binding("ctrl+drag", "drag to add", LIVE, "add all in a box to the selection"),
        Binding("drag to", "drag to", (*LIVE, PROPERTIES, FORCE_METHOD)),
        Binding("drop", "drop", (*LIVE, PROPERTIES, FORCE_METHOD)),
        Binding("escape", "escape", (SIMULATION,), "put the tool away, or pause"),
        Binding("escape", "escape", (PAUSE,), "put the tool away, or deselect"),
        Binding("return", "properties", LIVE, "open the properties of the selection"),
        Binding("delete", "delete", LIVE, "delete the selection"),
        Binding("backspace", "delete", LIVE, "delete the selection"),
        Binding("up", "arrow up", (PAUSE,), "move the selection (before a run)", repeats=True),
        Binding("down", "arrow down", (PAUSE,), "move the selection (before a run)", repeats=True),
        Binding("shift+up", "far arrow up", (PAUSE,), "move it by the grid (before a run)", repeats=True),
        Binding("shift+down", "far arrow down", (PAUSE,), "move it by the grid (before a run)", repeats=True),
        *(
            Binding(f"ctrl+{shift}{way}", f"move {far}{way}", (PAUSE,), title, repeats=True)
            for shift, far, title in (
                ("", "", marked("move the selection")),
                ("shift+", "far ", marked("move it by the grid")),
            )
            for way in ("left", "right", "up", "down")
        ),
        Binding("ctrl+z", "undo", LIVE, "undo", repeats=True),
        Binding("ctrl+y", "redo", LIVE, "redo", repeats=True),
        Binding("ctrl+shift+z", "redo", LIVE, "redo", repeats=True),
        Binding("ctrl+a", "select all", LIVE, "select all"),
        Binding("ctrl+c", "copy", LIVE, "copy the selection"),
        Binding("ctrl+x", "cut", LIVE, "cut the selection"),
        Binding("ctrl+v", "paste", LIVE, "paste at the pointer"),
        Binding("ctrl+d", "duplicate", LIVE, "duplicate the selection"),
    ),
    marked("Results"): (
        Binding("i", "toggle diagrams", LIVE, "show or hide force diagrams (N, M, V)"),
        Binding("x", "toggle free bodies", LIVE, "show or hide free-body diagrams"),
        Binding("a", "toggle utilisation", LIVE, "show or hide utilisation of strength"),
        Binding("m", "toggle theory", LIVE, "show or hide comparison with theory"),
        Binding("j", "toggle energy", LIVE, "show or hide energies"),
        Binding("ctrl+h", "toggle events", LIVE, "show or hide the list of events"),
        Binding("b", "next shape", LIVE, "show mechanisms, buckling, vibration modes"),
        Binding("ctrl+l", "new slider", LIVE, "add a slider for selected load or stiffness"),
        Binding("k", "force method", (PAUSE,), "force method"),
    ),
    marked("Force method"): (
        Binding("k", "next part", (FORCE_METHOD,), "go to the next part"),
        Binding("click", "pick unknown", (FORCE_METHOD,), "choose the redundant in set 1"),
        Binding("n", "release another", (FORCE_METHOD,), "release one more redundant"),
        Binding("x", "release x", (FORCE_METHOD,), "release the support along x"),
        Binding("y", "release y", (FORCE_METHOD,), "release the support along y"),
        Binding("m", "release moment", (FORCE_METHOD,), "release the moment of the clamp"),
        Binding("c", "next convention", (FORCE_METHOD,), "change the convention: textbook or thesis"),
        Binding("p", "report", (FORCE_METHOD,), "save a report of the solution as a PDF"),
        Binding("i", "toggle diagrams of sets", (FORCE_METHOD,), "show or hide force diagrams"),
        Binding("escape", "back", (FORCE_METHOD,), "leave the force method"),
    ),
    marked("Boxes"): (
        Binding("return", "accept", (PROPERTIES,), "accept the value, or go back"),
        Binding("return", "accept", (SAVE,), "save"),
        Binding("return", "accept", (LOAD,), "open"),
        Binding("escape", "cancel", FORMS, "restore the old value, or go back"),
        Binding("tab", "next box", FORMS, "go to the next box", repeats=True),
        Binding("shift+tab", "previous box", FORMS, "go to the previous box", repeats=True),
        Binding("click", "click form", (PROPERTIES,), "select a box, or accept its value"),
        Binding("click", "click form", (SAVE, LOAD), "choose"),
        Binding("up", "go up", (PROPERTIES,), "go up, or to the previous choice", repeats=True),
        Binding("down", "go down", (PROPERTIES,), "go down, or to the next choice", repeats=True),
        Binding("left", "go left", (PROPERTIES,), "move the cursor left", repeats=True),
        Binding("right", "go right", (PROPERTIES,), "move the cursor right", repeats=True),
        Binding("up", "go up", (SAVE, LOAD), "choose a picture", repeats=True),
        Binding("down", "go down", (SAVE, LOAD), "choose a picture", repeats=True),
        Binding("left", "go left", (SAVE, LOAD), "choose a picture", repeats=True),
        Binding("right", "go right", (SAVE, LOAD), "choose a picture", repeats=True),
        Binding("home", "to the beginning", FORMS),
        Binding("end", "to the end", FORMS),
        Binding("backspace", "erase", FORMS, "erase", repeats=True),
        Binding("delete", "erase after", FORMS, "erase after the cursor", repeats=True),
        Binding("ctrl+a", "mark all", FORMS, "select all text"),
        Binding("ctrl+c", "copy text", FORMS, "copy"),
        Binding("ctrl+x", "cut text", FORMS, "cut"),
        Binding("ctrl+v", "paste text", FORMS, "paste"),
        Binding("ctrl+l", "slider of box", (PROPERTIES,), "add a slider for this number"),
        Binding("wheel up", "scroll up", FORMS, "scroll up"),
        Binding("wheel down", "scroll down", FORMS, "scroll down"),
        Binding("page up", "page up", FORMS, repeats=True),
        Binding("page down", "page down", FORMS, repeats=True),
    ),
    marked("View"): (
        Binding("wheel up", "zoom in", (*LIVE, FORCE_METHOD), "zoom in at the pointer"),
        Binding("wheel down", "zoom out", (*LIVE, FORCE_METHOD), "zoom out"),
        Binding("drag middle", "pan", (*LIVE, FORCE_METHOD), "move the view (right button, too)"),
        Binding("home", "fit", (*LIVE, FORCE_METHOD), "show the whole model"),
        Binding("tab", "toggle legend", (*LIVE, FORCE_METHOD), "show or hide legend and toolbar"),
        Binding("t", "next theme", (*LIVE, FORCE_METHOD), "change the colours"),
        Binding("f2", "next language", EVERY, "change the language: English, Português"),
        Binding("ctrl++", "larger", EVERY, "make text larger or smaller", repeats=True),
        Binding("ctrl+shift++", "larger", EVERY, repeats=True),
        Binding("ctrl+-", "smaller", EVERY, "make text larger or smaller", repeats=True),
        Binding("ctrl+0", "usual size", EVERY, "reset the size of text"),
        Binding("f1", "toggle help", EVERY, "show help: keys and glossary"),
        Binding("f11", "toggle full screen", EVERY, "full screen on or off"),
        Binding("f12", "screenshot", EVERY, "save a picture"),
        Binding("shift+f12", "picture as svg", EVERY, "save a picture as SVG"),
        Binding("ctrl+f12", "picture as pdf", EVERY, "save a picture as PDF"),
    ),
    marked("Lessons"): (
        Binding("f5", "check answer", IN_LESSONS, "check the task of the lesson, or go on"),
        Binding("f6", "hint", IN_LESSONS, "show a hint for the task"),
        Binding("f7", "show solution", IN_LESSONS, "show how the task is done"),
        Binding("f8", "task again", IN_LESSONS, "begin the task again"),
        Binding("f9", "leave lesson", IN_LESSONS, "leave the lesson"),
    ),
    marked("Files"): (
        Binding("s", "save", (PAUSE,), "save as"),
        Binding("ctrl+shift+s", "save", LIVE, "save as"),
        Binding("ctrl+s", "save again", LIVE, "save"),
        Binding("d", "load", (PAUSE,), "open a model"),
        Binding("ctrl+o", "load", LIVE, "open a model"),
        Binding("ctrl+n", "new", LIVE, "start a new model"),
    ),
    marked("Menu"): (
        Binding("up", "menu up", (MENU,), "go to the entry above", repeats=True),
        Binding("down", "menu down", (MENU,), "go to the entry below", repeats=True),
        Binding("left", "menu left", (MENU,), "go to the column on the left", repeats=True),
        Binding("right", "menu right", (MENU,), "go to the column on the right", repeats=True),
        Binding("return", "choose entry", (MENU,), "choose the entry"),
        Binding("click", "choose entry", (MENU,), "choose the entry; outside, close the menu"),
        Binding("escape", "close menu", (MENU,), "close the menu"),
    ),
}
BINDINGS: list[Binding] = [
    replace(binding, group=group) for group, bindings in _BY_PURPOSE.items() for binding in bindings
]

# Actions that menus and the toolbar offer without a key.
WITHOUT_KEY: tuple[Binding, ...] = (
    Binding("", "free", LIVE, "free: no support"),
    Binding("", "pin", LIVE, "pinned: held in x and y"),
    Binding("", "hold y", LIVE, "roller: held in y"),
    Binding("", "hold x", LIVE, "roller: held in x"),
    Binding("", "clamp", LIVE, "clamped: held in x and y, cannot turn"),
    Binding("", "guide y", LIVE, "guided: held in y, cannot turn"),
    Binding("", "guide x", LIVE, "guided: held in x, cannot turn"),
    Binding("", "hold rotation", LIVE, "cannot turn, free in x and y"),
    Binding("", "split", LIVE, "divide the rod here"),
    Binding("", "weight along", LIVE, "add its weight as a distributed load"),
    Binding("", "toggle cable", LIVE, "cable: tension only"),
    Binding("", "divide in two", LIVE, "divide in two"),
    Binding("", "divide in four", LIVE, "divide in four"),
    Binding("", "release", (PAUSE,), "release it in the force method"),
    Binding("", "environment", LIVE, "open the properties of the environment"),
    Binding("", "more tools", (*LIVE, FORCE_METHOD), "show more tools"),
)

# The actions of the toolbar, in groups from the top to the bottom.
TOOLBAR: tuple[tuple[str, ...], ...] = (
    ("toggle run", "restart", "step back", "step", "slower", "faster", "settle"),
    ("next part", "release x", "release y", "release another"),
    ("toggle diagrams of sets", "back"),
    ("undo", "redo", "copy", "paste", "duplicate", "delete"),
    ("place", "rod", "rigid", "hinge", "support", "force", "moment", "velocity"),
    (
        *("toggle diagrams", "toggle free bodies", "toggle theory", "toggle energy"),
        *("next shape", "fit", "new grid", "next grid"),
    ),
    ("properties", "force method", "new", "load", "save again", "save"),
    ("screenshot", "toggle full screen", "next theme", "toggle help"),
)

PLACE = "place"  # the tools of mods stand at the end of its group, their other buttons in a group of their own

_BY_KEY = {(scene, binding.key): binding for binding in BINDINGS for scene in binding.scenes}


def add_binding(binding: Binding) -> list[Binding]:
    """Let a key perform an action in the scenes in which it is free; returns the bindings that have it in the others."""
    taken = {scene: _BY_KEY[scene, binding.key] for scene in binding.scenes if (scene, binding.key) in _BY_KEY}
    free = tuple(scene for scene in binding.scenes if scene not in taken)
    if free:
        BINDINGS.append(replace(binding, scenes=free))
        _index()
    return list(dict.fromkeys(taken.values()))


def remove_binding(binding: Binding) -> None:
    """Take back what `add_binding` did."""
    BINDINGS[:] = [
        other
        for other in BINDINGS
        if replace(other, scenes=binding.scenes) != binding or not set(other.scenes) <= set(binding.scenes)
    ]
    _index()


def prefer(scene: str, key: str, action: str) -> None:
    """Let a key perform the action that a person chose, whatever it did before."""
    titles = (binding.title for binding in BINDINGS if binding.action == action)
    old = _BY_KEY.get((scene, key))
    if old is not None:
        BINDINGS[BINDINGS.index(old)] = replace(old, scenes=tuple(s for s in old.scenes if s != scene))
    BINDINGS.append(Binding(key, action, (scene,), next(titles, action)))
    _index()


def _index() -> None:
    _BY_KEY.clear()
    _BY_KEY.update({(scene, binding.key): binding for binding in BINDINGS for scene in binding.scenes})


def _binding(scene: str, key: str) -> Binding | None:
    """The binding of a key in a scene; in scenes of mods, keys that do the same in all of ours do so, too."""
    found = _BY_KEY.get((scene, key))
    if found is None and scene not in EVERY:
        found = next((b for b in BINDINGS if b.key == key and set(EVERY) <= set(b.scenes)), None)
    return found


def action_for(scene: str, key: str) -> str | None:
    """The action that a key performs in a scene, or None."""
    binding = _binding(scene, key)
    return binding.action if binding else None


def only_in_pause(scene: str, key: str) -> str:
    """What a key does in pause, if it does nothing in the scene in which time passes; "" else."""
    found = _binding(PAUSE, key) if scene == LIVE[0] and _binding(scene, key) is None else None
    return tr(found.title) if found else ""


def key_named(text: str) -> str:
    """The name that bindings use for a key such as "K", "Esc" or "Ctrl+Z". Raises ValueError if there is no such key.

    Shift with a character is the same key: on some keyboards "+" needs it, on others not.
    """
    if text.startswith((TEXT, FILES)):
        return text
    name, held = text.lower(), set()
    while modifier := next((m for m in MODIFIERS if name.startswith(m) and len(name) > len(m)), None):
        held.add(MODIFIERS[modifier])
        name = name.removeprefix(modifier)
    name = ALSO_CALLED.get(name, name)
    known = {binding.key.removeprefix("ctrl+").removeprefix("shift+") for binding in BINDINGS} | {*UNBOUND}
    if len(name) != 1 and name not in known:
        raise ValueError(missing(marked("keys"), text, sorted(key for key in known if len(key) > 1)))
    if len(name) == 1 and "ctrl+" not in held:
        held.clear()
    return "".join(sorted(held)) + name  # ctrl comes before shift


def repeats(scene: str, key: str) -> bool:
    """True if holding a key performs its action again and again in a scene."""
    binding = _binding(scene, key)
    return binding is not None and binding.repeats


def offers(scene: str) -> dict[str, Binding]:
    """By action: the binding by which the toolbar and menus offer it; the same while time passes as in pause.

    Keys that perform it in the scene come first, then those of the other, then no key.
    """
    scenes = set(LIVE if scene in LIVE else (scene,))
    found = [b for b in (*BINDINGS, *WITHOUT_KEY, *EXTENSIONS.buttons) if scenes & set(b.scenes)]
    found.sort(key=lambda binding: (scene not in binding.scenes, not binding.key))
    return {binding.action: binding for binding in reversed(found)}


def toolbar(scene: str) -> tuple[tuple[Binding, ...], ...]:
    """Groups of bindings of the toolbar in a scene: the same while time passes as in pause; none in forms."""
    offered = {} if scene in FORMS else offers(scene)
    wanted = [[*group, *(EXTENSIONS.tools if PLACE in group else ())] for group in TOOLBAR]
    wanted.insert(-1, [binding.action for binding in EXTENSIONS.buttons])  # the last group stands at the bottom
    groups = (tuple(offered[action] for action in group if action in offered) for group in wanted)
    return tuple(group for group in groups if group)


def help_lines(scene: str) -> list[tuple[str, str]]:
    """(key, title) of all keys of a scene by purpose, in the present language; before those of each, ("", purpose)."""
    shown = [b for b in BINDINGS if b.title and _binding(scene, b.key) is b]
    purposes = dict.fromkeys([*_BY_PURPOSE, *(binding.group for binding in shown)])
    lines: list[tuple[str, str]] = []
    for purpose in purposes:
        keys = [(binding.key, tr(binding.title)) for binding in shown if binding.group == purpose]
        lines += [("", tr(purpose)), *keys] if keys else []
    return lines
