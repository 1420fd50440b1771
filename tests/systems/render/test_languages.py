"""What the window draws in another language: keys, their meanings, the glossary, boxes; here every message in ‹ ›."""

from __future__ import annotations

import gettext

import pytest

from pinjoint.components import language
from pinjoint.components.camera import Viewport
from pinjoint.session import Session
from pinjoint.systems.input.actions import help_lines
from pinjoint.systems.render.glossary import terms
from pinjoint.systems.render.help import help_pages, written_key
from pinjoint.systems.render.marks import Text
from tests.golden.scenes import composed


class _Quoting(gettext.NullTranslations):
    """Every message between quotation marks, so that one that was not looked up is seen."""

    def gettext(self, message: str) -> str:
        return f"‹{message}›"

    def pgettext(self, context: str, message: str) -> str:
        return f"‹{message}›"

    def ngettext(self, one: str, many: str, number: int) -> str:
        return f"‹{one if number == 1 else many}›"


@pytest.fixture
def quoting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(language._SPOKEN, "catalogue", _Quoting())
    monkeypatch.setattr(language._SPOKEN, "code", "quoted")


@pytest.mark.usefixtures("quoting")
def test_an_empty_text_stays_empty() -> None:
    assert language.tr("") == ""


@pytest.mark.usefixtures("quoting")
def test_all_of_the_help_is_translated() -> None:
    for page in help_pages(help_lines("pause"), Viewport(0, 0, 640, 480), 1.0):
        for key, meaning in page:
            whole = key.strip() and not key.startswith(" ")
            assert key or meaning.startswith("‹"), "a purpose"
            assert not whole or meaning.startswith("‹") or not meaning, (key, meaning)
    assert written_key("ctrl+space") == "Ctrl+‹Space›"
    assert written_key("ctrl+z") == "Ctrl+Z"


def test_the_help_is_not_kept_in_the_language_of_before(monkeypatch: pytest.MonkeyPatch) -> None:
    viewport = Viewport(0, 0, 640, 480)
    before = help_pages(help_lines("pause"), viewport, 1.0)
    monkeypatch.setattr(language._SPOKEN, "catalogue", _Quoting())
    monkeypatch.setattr(language._SPOKEN, "code", "quoted")
    assert written_key("space") == "‹Space›"
    assert help_pages(help_lines("pause"), viewport, 1.0) != before


@pytest.mark.usefixtures("quoting")
def test_titles_words_and_headings_of_boxes_are_translated_and_scripts_keep_theirs() -> None:
    session = Session.open("hyperstatic")
    session.select(session.rods["AB"])
    session.press("return")
    session.click_box("tension only")
    session.type("y")  # as in English
    assert session.boxes["tension only"] == "yes"
    session.click_box("stiffness")
    session.update_view()
    read = {m.text for picture in composed(session) for m in picture.marks if isinstance(m, Text)}
    assert {"‹tension only›", "‹yes›", "‹stiffness›", "‹Results›", "‹axial force›"} <= read
    assert not {"tension only", "yes", "stiffness", "Results", "axial force"} & read


def test_every_term_is_explained_in_whole_sentences() -> None:
    for term, meaning, _ in terms():
        assert meaning.endswith("."), term
        assert meaning[0].isupper() or meaning[0] == "δ", term
    assert len({entry.term for entry in terms()}) == len(terms())


def test_the_glossary_comes_after_the_keys_and_tells_every_term() -> None:
    for width, height in ((320, 240), (640, 480), (1280, 800)):
        pages = help_pages(help_lines("pause"), Viewport(0, 0, width, height), 1.0)
        first = next(number for number, page in enumerate(pages) if page[0] == ("", "Glossary"))
        assert first > 0
        assert all(page[0] == ("", "Glossary") for page in pages[first:])
        told = " ".join(key.strip() for page in pages[first:] for key, _ in page)
        assert all(entry.term in told for entry in terms()), (width, height)
