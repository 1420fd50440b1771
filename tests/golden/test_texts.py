"""All that can be read is translated, whole, in the window and clear of one another: every scene, size and language.

For a short list of what is not: python -m tests.golden.test_texts
"""

import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from itertools import combinations

import pytest

from pinjoint import Session
from pinjoint.components.language import spoken
from pinjoint.documents.library import data_in
from pinjoint.documents.models import bundled
from pinjoint.editor.scenes.form import FormScene
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.render.marks import Panel, Picture, Text
from pinjoint.systems.render.typography import capital_height
from tests.golden.scenes import SCENES, WINDOWS, Scene, Window, composed, opened, pressed
from tests.golden.states import LONG_NAME, STATES
from tests.pseudo import pseudo
from tests.reference.boxes import Box, overlap, text_box

SIZES = {
    **WINDOWS,
    "narrow": Window(480, 800),
    "flat": Window(1200, 420),
    "dense": Window(1600, 1200, 2.0),
    "full HD": Window(1920, 1080),
    "tiny": Window(320, 360),
}
LANGUAGES: dict[str, Callable[[], AbstractContextManager[None]]] = {
    "en": lambda: spoken("en"),
    "pt": lambda: spoken("pt"),
    "pseudo": pseudo,
}
WHOLE = 640  # pixels of width from which no text may be cut
SHORT = 400  # pixels of height below which only forms have room, which scroll
PAGES = 60  # more than there are to scroll through


def _all_panels(name: str) -> Scene:
    """A bundled model at rest with all that is told of one."""
    return lambda window: pressed(window, "e", "m", "j", "ctrl+h", "i", "x", "a", source=name)


def _tool(key: str, *clicks: str) -> Scene:
    """A tool that is taken up, and what it says after clicks on joints."""

    def scene(window: Window) -> Session:
        session = opened(window, "portal")
        session.press(key, (session.view.strip.left + 1, session.view.strip.top + 1))
        for name in clicks:
            session.click(*session.particles[name].position)
        return session

    return scene


MODELS = {
    f"model {name}": _all_panels(name)
    for name in bundled()
    if name not in ("pile", "hard_disc_gas", "billiards_break")
}
TOOLS = {
    f"tool {key} {clicks}": _tool(key, *clicks)
    for key in ("l", "ctrl+j", "c", "f", "ctrl+m", "v", "w", "p")
    for clicks in ("", "B", "BC")
}
ALL = SCENES | STATES | TOOLS | MODELS


def read(name: str, window: Window) -> Iterator[list[Picture]]:
    """What a scene shows in a window, and what is reached by scrolling or on further pages."""
    with data_in():
        session = ALL[name](window)
        on = "f1" if session.view.help else "wheel down" if isinstance(session.scenes.active, FormScene) else ""
        if window.height < SHORT and on != "wheel down":
            return
        before: list[str] = []
        for _ in range(PAGES):
            shown = composed(session)
            now = [text.text for text, _ in texts(shown)]
            if now == before or (on == "f1" and not session.view.help):
                return
            yield shown
            if not on:
                return
            before = now
            session.press(on)
        raise AssertionError("it is scrolled without end")


# --- what is wrong with a picture ------------------------------------------------------------------------


def problems(shown: list[Picture], window: Window) -> Iterator[str]:
    """What is cut, outside the window, or over something else."""
    seen = list(texts(shown))
    for mark, (left, top, right, bottom) in seen:
        if window.width >= WHOLE and mark.text.endswith("…"):
            yield f"cut: {mark.text!r}"
        if left < -1.0 or top < -1.0 or right > window.width + 1.0 or bottom > window.height + 1.0:
            yield f"outside: {mark.text!r} {left:.0f} {top:.0f} {right:.0f} {bottom:.0f}"
    for (one, box), (other, beside) in combinations(seen, 2):
        if overlap(box, beside):
            yield f"over one another: {one.text!r} {box} and {other.text!r} {beside}"


def texts(shown: list[Picture]) -> Iterator[tuple[Text, Box]]:
    """What can be read, and where its capitals are (left, top, right, bottom), without what lies under a panel."""
    marks = [mark for picture in shown for mark in picture.marks]
    for place, mark in enumerate(marks):
        if isinstance(mark, Text) and mark.text.strip():
            box = text_box(mark, capital_height(mark.size))
            above = [box_of(panel) for panel in marks[place:] if isinstance(panel, Panel)]
            if not any(overlap(box, panel) for panel in above):
                yield mark, box


@pytest.mark.parametrize("name", ["drawing-a-force", "drawing-a-wall"])
def test_what_a_tool_says_hides_no_name_in_part(name: str) -> None:
    marks = [mark for shown in read(name, SIZES["small"]) for picture in shown for mark in picture.marks]
    boxes = [text_box(mark, capital_height(mark.size)) for mark in marks if isinstance(mark, Text)]
    said = next(n for n, mark in enumerate(marks) if isinstance(mark, Text) and re.match(r"\(|.*°$", mark.text))
    bubble = marks[said - 1]
    assert isinstance(bubble, Panel)
    assert sum(overlap(box, box_of(bubble)) for box in boxes) == 1, "its own"


def box_of(panel: Panel) -> Box:
    return panel.left, panel.top, panel.left + panel.width, panel.top + panel.height


_WORD = re.compile(r"(?<![^\W_])[A-Za-z]{3,}(?![^\W_])")
_PATH = re.compile(r"\S*/\S*")
_UNITS = {"MPa", "GPa", "mrad", "rad", "kNm"}
_PROPER = {"Pinjoint", "English", "IPE", "HEA", "HEB", "CHS", "SHS", "Lee", "Euler", "Williams", "Rayleigh"}
_KEYS = {part.capitalize() for _, binding in ACTIONS.bound() for part in re.split(r"[+ ]", binding.key)}
_TYPED = re.findall("[A-Za-z]+", 3 * LONG_NAME)  # a box shows the end
_GIVEN = {"isostatik", "bridge", "Wall", *(word[n:] for word in _TYPED for n in range(len(word)))}
IN_ENGLISH = {  # written so in the scenes
    "notice-long",
    "problem-long",
    "unkept",
    "compiling",
    "lesson",
    "properties-all-refused",
}


@pytest.fixture(scope="module")
def known() -> set[str]:
    return known_words()


def known_words() -> set[str]:
    """Words that are nobody's language: names of elements and combinations, units, keys, and what scenes type."""
    models = [Session.open(name.removeprefix("model ")).model for name in MODELS]
    tables = [table for model in models for table in model.tables.values() if not table.kind.single]
    names = [name for table in tables for name in table.names]
    names += [name for model in models for name in model.settings.combinations]
    words = {word for name in [*names, *bundled()] for word in re.findall("[A-Za-z]+", name)}
    return words | _UNITS | _PROPER | _KEYS | {"Esc", "Ctrl", "Shift"} | _GIVEN


def untranslated(shown: list[Picture], known: set[str]) -> Iterator[str]:
    """Texts with a word in plain letters that is somebody's language."""
    for picture in shown:
        for text in picture.texts:
            if set(_WORD.findall(_PATH.sub("", text))) - known:
                yield f"not translated: {text!r}"


def sizes(name: str, language: str) -> Iterable[str]:
    """Those in which a scene is read in a language; in English, the shortest, in half of the others, in turns."""
    if name in MODELS:
        return ["full HD"]
    if language == "en" and name not in TOOLS:
        return [size for size in SIZES if size not in ("small", "usual", "full HD")][
            [*ALL].index(name) % 2 :: 2
        ]
    if language == "pt":
        return ["small"] if name in TOOLS else ["small", "full HD"]
    # of hints a third longer the lower edge of a small window has no room
    hinted = name in TOOLS or name == "pulling"
    return ["usual"] if hinted else ["small", "usual"]


def found(name: str, language: str, known: set[str]) -> Iterator[str]:
    """All that is wrong with a scene in a language."""
    for size in sizes(name, language):
        for shown in read(name, SIZES[size]):
            if name not in MODELS:
                yield from (f"{language} {size}: {problem}" for problem in problems(shown, SIZES[size]))
            if language == "pseudo" and name not in IN_ENGLISH:
                yield from untranslated(shown, known)


@pytest.mark.parametrize(
    ("name", "language"),
    [(name, code) for name in ALL for code in (LANGUAGES if name not in MODELS else ["pseudo"])],
)
def test_texts_are_translated_whole_and_clear_of_one_another(name: str, language: str, known: set[str]) -> None:
    with LANGUAGES[language]():
        assert not "\n".join(dict.fromkeys(found(name, language, known)))


@pytest.mark.parametrize("size", ["tiny", "small", "large"])
@pytest.mark.parametrize("name", ["properties-all-refused", "properties-environment"])
def test_every_box_is_reached_by_scrolling(name: str, size: str) -> None:
    told = {text for shown in read(name, SIZES[size]) for picture in shown for text in picture.texts}
    with data_in():
        scene = ALL[name](SIZES[size]).scenes.active
    assert isinstance(scene, FormScene)
    assert {box.title for box in scene.form.boxes} <= told


def test_what_the_pointer_finds_is_translated(known: set[str]) -> None:
    """Tips of tools and entries of menus, of a joint and of nothing."""
    with pseudo():
        session = Session.open("hyperstatic_yield")
        said = [tool.title for group in session.view.toolbar.groups for tool in group]
        for pixel in (session.point(*session.particles["B"].position), session.view.camera.middle):
            session.press("right click", pixel)
            assert session.view.menu is not None
            said += [session.view.menu.title, *(entry.title for entry in session.view.menu.entries)]
            session.press("escape")
    assert len(said) > 40
    assert not [text for text in said if set(_WORD.findall(text)) - known]


@pytest.mark.parametrize("size", [(320, 240), (480, 800), (640, 480), (1920, 1080)])
@pytest.mark.parametrize("key", ["", "space", "return", "s", "d", "k"])
def test_every_key_is_explained_in_a_window_of_any_size(key: str, size: tuple[int, int]) -> None:
    """On as many pages as that takes; F1 goes through them and closes the last."""
    session = Session.open("hyperstatic")
    session.resize(*size)
    session.press("i")
    if key:
        session.press(key)
    told = ""
    for _ in range(200):
        session.press("f1")
        shown = list(texts(composed(session))) if session.view.help else []
        if not shown:
            break
        told = " ".join([told, *(mark.text for mark, _ in shown)])
        card = [box for mark, box in shown if not mark.text.endswith("…")]
        assert all(left >= 0.0 and right <= size[0] and bottom <= size[1] for left, _, right, bottom in card)
    assert session.view.help == 0
    assert not [title for _, title in ACTIONS.help_lines(session.scene) if title not in told]


def main() -> None:
    """Print what is wrong, once each; with words: in those scenes only."""
    known, told = known_words(), set[str]()
    for name in sys.argv[1:] or ALL:
        for language in LANGUAGES:
            with LANGUAGES[language]():
                for problem in found(name, language, known):
                    if problem not in told:
                        print(f"{name}: {problem}", flush=True)
                    told.add(problem)


if __name__ == "__main__":
    main()
