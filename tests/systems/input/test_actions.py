"""The table of keys is true: in every scene that it names, every key does something."""

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.components.settings import PAUSE, STATICS
from pinjoint.components.tags import DiagramShown
from pinjoint.documents.library import DATA_VARIABLE, models_folder
from pinjoint.editor.scenes.form import FormScene
from pinjoint.editor.scenes.methods import Method
from pinjoint.systems.input.actions import (
    ACTIONS,
    DISPLACEMENT_METHOD,
    FORCE_METHOD,
    LOAD,
    MENU,
    PROPERTIES,
    SAVE,
    SIMULATION,
    TABLE,
    Action,
    Binding,
)
from tests.properties.soundness import contents
from tests.reference.hits import hits_in

CASES = [(scene, action, binding) for action, binding in ACTIONS.bound() for scene in binding.scenes]
FOLLOWING = {"drag to", "shift+drag to", "drop"}  # are part of a drag


@pytest.fixture(autouse=True)
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More saved models than there is room for on the screen."""
    monkeypatch.setenv(DATA_VARIABLE, str(tmp_path))
    models_folder().mkdir()
    text = (files("pinjoint.assets") / "models" / "isostatic.json").read_text(encoding="utf-8")
    for number in range(20):
        (models_folder() / f"model {number}.json").write_text(text, encoding="utf-8")


class FakeWindow:
    """Notes what a window is asked for."""

    def __init__(self) -> None:
        self.asked = 0

    def toggle_full_screen(self) -> None:
        self.asked += 1

    def magnify(self, by: int) -> str:
        self.asked += 1
        return "110 %"

    def screenshot(self, suffix: str) -> str:
        self.asked += 1
        return "picture.png"

    def save(self, name: str, contents: bytes) -> str:
        self.asked += 1
        return name

    def copied(self) -> str:
        return ""

    def copy(self, text: str) -> None:
        self.asked += 1


def in_scene(scene: str) -> Session:
    """A session there, in a small window, with a structure that has moved, edits and B selected."""
    session = Session.open("hyperstatic")
    session.resize(640, 480)
    session.rods["AB"].stiffness = 1e5
    session.run(steps=300)
    session.select(session.particles["B"])
    session.point(*session.particles["B"].position)
    keys = {
        SIMULATION: "space",
        STATICS: "q",
        PROPERTIES: "return",
        SAVE: "s",
        LOAD: "d",
        FORCE_METHOD: "k",
        DISPLACEMENT_METHOD: "ctrl+k",
        MENU: "menu",
        TABLE: "n",
    }
    if scene in keys:
        session.press(keys[scene])
    if scene == STATICS:  # which has one slider more, that nothing is to lie under
        session.point(*session.particles["B"].position)
    if scene == TABLE:
        session.view.pointer = session.view.table_place.middle
    assert scene in (MENU, TABLE) or session.scene == scene
    assert (scene == MENU) == (session.view.menu is not None)
    return session


def _in_wide_menu(session: Session) -> None:
    """The menu of the canvas, which has several columns here; the second entry is chosen."""
    session.press("escape")
    session.press("right click", session.view.camera.middle)
    session.press("down")
    session.press("right")


def _at_left_in_wide_menu(session: Session) -> None:
    _in_wide_menu(session)
    session.press("left")


def _over_an_entry(session: Session) -> None:
    session.view.pointer = next(hit.middle for hit in hits_in(session) if hit.item == 1)


def _deselected(session: Session) -> None:
    session.select()


def _pasting(session: Session) -> None:
    _typed(session)
    session.clipboard = "7"


def _undone(session: Session) -> None:
    session.undo()


def _typed(session: Session) -> None:
    """Some text in a box, the caret in its middle."""
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    session.click_box(scene.form.boxes[0].title)
    session.type("12")
    session.press("left")


def _copied(session: Session) -> None:
    session.act("copy")


def _at_end(session: Session) -> None:
    """Scrolled down as far as it goes."""
    for _ in range(40):
        session.press("wheel down")


def _low_table(session: Session) -> None:
    """So low that not all rows are in sight."""
    session.resize(640, 300)
    session.view.pointer = session.view.table_place.middle


def _at_end_of_table(session: Session) -> None:
    _low_table(session)
    session.press("end")


def _part(number: int, pick: str = "BD") -> Callable[[Session], None]:
    def go(session: Session) -> None:
        guide = session.scenes.active.guide  # type: ignore[attr-defined]
        session.press("k")
        if number > 2 and pick:
            guide.pick(guide.sets[0].model.rods[pick])
        for _ in range(number - (3 if pick else 2)):
            session.press("k")

    return go


def _support_of_d(session: Session) -> None:
    _part(2)(session)
    guide = session.scenes.active.guide  # type: ignore[attr-defined]
    guide.pick(guide.sets[0].model.particles["D"])


def _over_a_rod(session: Session) -> None:
    """Part 2, the pointer over BD."""
    _part(2)(session)
    session.point(0.5, 1.0)
    session.view.pointer = session.stages[0][1].pointer


def _window(session: Session) -> None:
    session.window = FakeWindow()


def _grids(session: Session) -> None:
    session.press("g")


def _named(session: Session) -> None:
    session.press("ctrl+a")
    session.type("a name")


PREPARED: dict[tuple[str, str], Callable[[Session], None]] = {
    ("menu left", MENU): _in_wide_menu,
    ("menu right", MENU): _at_left_in_wide_menu,
    ("choose entry", MENU): _over_an_entry,
    ("row above", TABLE): _deselected,
    ("rows above", TABLE): _at_end_of_table,
    ("rows below", TABLE): _low_table,
    ("last rows", TABLE): _low_table,
    ("first rows", TABLE): _at_end_of_table,
    ("redo", PAUSE): _undone,
    ("redo", SIMULATION): _undone,
    ("paste", PAUSE): _copied,
    ("paste", SIMULATION): _copied,
    ("fit", FORCE_METHOD): lambda session: session.press("drag middle", (30.0, 30.0)),
    ("fit", DISPLACEMENT_METHOD): lambda session: session.press("drag middle", (30.0, 30.0)),
    ("fit", PAUSE): lambda session: session.press("drag middle", (30.0, 30.0)),
    ("fit", STATICS): lambda session: session.press("drag middle", (30.0, 30.0)),
    ("fit", SIMULATION): lambda session: session.press("drag middle", (30.0, 30.0)),
    ("natural pace", PAUSE): lambda session: session.press("+"),
    ("natural pace", SIMULATION): lambda session: session.press("+"),
    ("next grid", PAUSE): _grids,
    ("select", STATICS): lambda session: session.select(),
    ("pick unknown", FORCE_METHOD): _over_a_rod,
    ("pick unknown", DISPLACEMENT_METHOD): _over_a_rod,
    ("part before", FORCE_METHOD): lambda session: session.press("k"),
    ("part before", DISPLACEMENT_METHOD): lambda session: session.press("k"),
    ("to the equations", DISPLACEMENT_METHOD): _part(4, ""),
    ("release x", FORCE_METHOD): _support_of_d,
    ("release y", FORCE_METHOD): _support_of_d,
    ("release another", FORCE_METHOD): _part(7),
    ("toggle full screen", ""): _window,
    ("screenshot", ""): _window,
    ("picture as svg", ""): _window,
    ("picture as pdf", ""): _window,
    ("sheet", ""): _window,
    ("larger", ""): _window,
    ("smaller", ""): _window,
    ("usual size", ""): _window,
    **{(f"{by} up", scene): _at_end for by in ("scroll", "page") for scene in (PROPERTIES, SAVE, LOAD)},
    ("accept", PROPERTIES): _typed,
    ("accept", SAVE): _named,
    ("accept", LOAD): lambda session: session.type("tower"),
    **{
        (action, scene): _typed
        for action in ("cancel", "erase", "erase after", "go left", "go right", "to the beginning", "to the end",
                       "mark all", "copy text", "cut text", "paste text", "next box", "previous box")
        for scene in (PROPERTIES, SAVE, LOAD)
    },
    **{("paste text", scene): _pasting for scene in (PROPERTIES, SAVE, LOAD)},
    ("select", PAUSE): _deselected,
    ("select", SIMULATION): _deselected,
    ("click form", PROPERTIES): lambda session: setattr(session.view, "pointer", _place_of_a_box(session)),
    ("click form", SAVE): lambda session: setattr(session.view, "pointer", _place_of_a_box(session)),
    ("click form", LOAD): lambda session: setattr(session.view, "pointer", _place_of_a_box(session)),
}  # fmt: skip


def _place_of_a_box(session: Session) -> tuple[float, float]:
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    place = scene.layout(session).place_of(scene.form.boxes[0])
    assert place is not None
    return place.left + 5.0, place.top + 5.0


def seen(session: Session) -> Any:
    """All that a person could see change."""
    scene = session.scenes.active
    shown: list[Any] = [session.scene, contents(session.model), session.selected, repr(session.view)]
    shown += [
        session.model.tagged(DiagramShown),
        session.settings.original_diagrams,
        session.document.live.clock.factor,
        session.view.tool,
        repr(session.gesture),
    ]
    shown += [session.clipboard, getattr(session.window, "asked", 0), session.notice]
    if session.view.table[0]:
        shown.append(session.lister.listing)
    if isinstance(scene, FormScene):
        form = scene.form
        shown += [form.selected, form.chosen, form.first, form.message]
        shown += [(box.text, box.caret, box.marked) for box in form.boxes]
    if isinstance(scene, Method) and scene.guide is not None:
        shown += [scene.guide.shown_now, len(scene.guide.sets), scene.guide.refusal, scene.hint(session)]
        shown += [repr(view.camera) for _, view in scene.stages(session)]
    return shown


@pytest.mark.parametrize(
    ("scene", "action", "binding"), CASES, ids=[f"{scene}-{b.key}-{action.name}" for scene, action, b in CASES]
)
def test_every_key_does_something_in_every_scene_that_it_names(
    scene: str, action: Action, binding: Binding
) -> None:
    if binding.key in FOLLOWING:
        pytest.skip("part of a drag, which is tested by itself")
    session = in_scene(scene)
    prepare = PREPARED.get((action.name, scene)) or PREPARED.get((action.name, ""))
    if prepare is not None:
        prepare(session)
    session.notice = ""
    before = seen(session)
    session.press(binding.key, (7.0, 9.0) if binding.key == "drag middle" else None)
    assert seen(session) != before


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("K", "k"),
        ("Esc", "escape"),
        ("Enter", "return"),
        ("Shift+Ctrl+Z", "ctrl+shift+z"),
        ("ctrl++", "ctrl++"),
        ("shift++", "+"),
        ("Shift+Left", "shift+left"),
        ("F9", "f9"),
        ("text Esc", "text Esc"),
    ],
)
def test_keys_are_known_by_the_names_that_people_use(said: str, meant: str) -> None:
    assert ACTIONS.key_named(said) == meant


def test_every_bound_key_is_called_as_it_is() -> None:
    keys = [binding.key for _, binding in ACTIONS.bound()]
    assert keys == list(map(ACTIONS.key_named, keys))


@pytest.mark.parametrize("text", ["", "spacebarr", "ctrl+", "alt+x", "undo"])
def test_what_no_key_is_called_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="among the keys"):
        Session.open("isostatic").press(text)
