"""In another language all that can be read is translated, whole, in the window and clear of one another.

For a short list of what is not: python -m tests.golden.test_languages
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager

import pytest

from pinjoint.components.language import spoken
from pinjoint.components.model import Model
from pinjoint.documents.models import bundled
from pinjoint.session import Session
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.render.marks import Picture, Text
from tests.golden.scenes import SCENES, Window, composed, opened
from tests.golden.states import LONG_NAME, STATES, seen
from tests.golden.test_layout import problems
from tests.pseudo import pseudo

SIZES = {"1024×640": Window(1024, 640), "640×480": Window(640, 480), "1920×1080": Window(1920, 1080)}
LANGUAGES = {"pseudo": pseudo, "pt": lambda: spoken("pt")}
SHOWN = [*SCENES, *STATES]

_WORD = re.compile(r"(?<![^\W_])[A-Za-z]{3,}(?![^\W_])")
_UNITS = {"MPa", "GPa", "mrad", "rad", "kNm"}
_PROPER = {"Pinjoint", "English", "IPE", "HEA", "HEB", "CHS", "SHS", "Lee", "Euler", "Williams", "Rayleigh"}
_KEYS = {part.capitalize() for _, binding in ACTIONS.bound() for part in re.split(r"[+ ]", binding.key)} | {
    "Esc",
    "Ctrl",
    "Shift",
}
_TYPED = re.findall("[A-Za-z]+", 3 * LONG_NAME)
_GIVEN = {
    "isostatik",
    "bridge",
    *(word[n:] for word in _TYPED for n in range(len(word))),
}  # a box shows the end
_PATH = re.compile(r"\S*/\S*")
IN_ENGLISH = {
    "notice-long",
    "problem-long",
    "unkept",
    "compiling",
    "lesson",
}  # their sentences are written in the scenes


def speaking(language: str) -> AbstractContextManager[None]:
    return LANGUAGES[language]()


def named(models: list[Model]) -> set[str]:
    """The words of the names of elements, which are nobody's language."""
    names = [
        name
        for model in models
        for table in model.tables.values()
        if not table.kind.single
        for name in table.names
    ]
    return {word for name in [*names, *bundled()] for word in re.findall("[A-Za-z]+", name)}


def untranslated(shown: list[Picture], names: set[str]) -> Iterator[str]:
    """Texts with a word in plain letters that is no name, unit or key."""
    known = names | _UNITS | _PROPER | _KEYS | _GIVEN
    for picture in shown:
        for mark in picture.marks:
            if isinstance(mark, Text) and set(_WORD.findall(_PATH.sub("", mark.text))) - known:
                yield mark.text


def all_names() -> set[str]:
    """Of all models that the scenes show."""
    return named([Session.open(name).model for name in bundled() if name not in ("pile", "hard_disc_gas")])


@pytest.fixture(scope="module")
def names() -> set[str]:
    return all_names()


def looked_at(name: str, window: Window) -> list[Picture]:
    """A scene, a state, or a bundled model at rest in pause with all panels, as "model NAME"."""
    if not name.startswith("model "):
        return seen(name, window)
    session = opened(window, name.removeprefix("model "))
    for key in ("e", "m", "j", "ctrl+h", "i", "x", "a"):
        session.press(key)
    return composed(session)


MODELS = [f"model {name}" for name in bundled() if name not in ("pile", "hard_disc_gas", "billiards_break")]


@pytest.mark.parametrize("name", sorted({*SHOWN, *MODELS} - IN_ENGLISH))
def test_all_that_can_be_read_is_translated(name: str, names: set[str]) -> None:
    with pseudo():
        found = sorted(set(untranslated(looked_at(name, SIZES["1920×1080"]), names)))
    assert not found, "\n".join(found)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", SHOWN)
def test_texts_have_room_in_every_language(name: str, language: str, size: str) -> None:
    with speaking(language):
        found = list(problems(seen(name, SIZES[size]), SIZES[size]))
    assert not found, "\n".join(found)


def main() -> None:
    """Print what is not translated, once each, then what has no room, by scene; with words: those scenes only."""
    names, wanted = all_names(), sys.argv[1:]
    told: set[str] = set()
    for name in wanted or [name for name in [*SHOWN, *MODELS] if name not in IN_ENGLISH]:
        with pseudo():
            new = set(untranslated(looked_at(name, SIZES["1920×1080"]), names)) - told
        told |= new
        for text in sorted(new):
            print(f"not translated ({name}): {text}")
    for language in LANGUAGES:
        for name in wanted or SHOWN:
            for size, window in SIZES.items():
                with speaking(language):
                    for problem in problems(seen(name, window), window):
                        print(f"{language} {size} {name}: {problem}")


if __name__ == "__main__":
    main()
