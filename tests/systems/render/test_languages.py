"""What the window draws in another language: keys, their meanings, the glossary, boxes; here every message in ‹ ›."""

from __future__ import annotations

import gettext

import pytest

from pinjoint.components import language
from pinjoint.session import Session
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.render.buttons import written_key
from pinjoint.systems.render.help import terms
from pinjoint.systems.render.marks import Text
from tests.golden.scenes import composed

IN_ENGLISH = {binding.title for _, binding in ACTIONS.bound() if binding.title}


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


def help_of(size: tuple[int, int]) -> list[list[tuple[str, str]]]:
    """What every page of the help says: each text, and its weight."""
    session = Session.open("hyperstatic")
    session.resize(*size)
    pages = []
    while session.press("f1") or session.view.help:
        card = [m for m in composed(session)[-1].marks if isinstance(m, Text)]
        pages.append([(text.text, text.weight) for text in card])
    return pages


@pytest.mark.usefixtures("quoting")
def test_all_of_the_help_is_translated() -> None:
    for page in help_of((640, 480)):
        plain = {text for text, weight in page if weight == "regular"}
        assert sum(text.startswith("‹") for text in plain) > 3
        assert not IN_ENGLISH & plain
    assert written_key("ctrl+space") == "Ctrl+‹Space›"
    assert written_key("ctrl+z") == "Ctrl+Z"


def test_the_help_is_not_kept_in_the_language_of_before(monkeypatch: pytest.MonkeyPatch) -> None:
    before = help_of((640, 480))
    monkeypatch.setattr(language._SPOKEN, "catalogue", _Quoting())
    monkeypatch.setattr(language._SPOKEN, "code", "quoted")
    assert written_key("space") == "‹Space›"
    assert help_of((640, 480)) != before


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


@pytest.mark.parametrize("size", [(320, 240), (640, 480), (1280, 800)])
def test_the_glossary_comes_after_the_keys_and_tells_every_term(size: tuple[int, int]) -> None:
    pages = help_of(size)
    first = next(number for number, page in enumerate(pages) if ("Glossary", "semibold") in page)
    assert first > 0
    assert all(("Glossary", "semibold") in page for page in pages[first:])
    told = " ".join(text for page in pages[first:] for text, _ in page)
    for entry in terms():
        assert all(word in told for word in entry.term.split()), entry.term
