"""What the window draws in another language: keys with their names, and the glossary. Nothing is kept from before."""

from pinjoint.session import Session
from pinjoint.systems.render.ui.buttons import written_key
from pinjoint.systems.render.ui.help import terms
from tests.golden.scenes import composed
from tests.pseudo import accented, pseudo


def help_in_small() -> list[set[str]]:
    """What every page of the help says in a small window."""
    session = Session.open("hyperstatic")
    session.resize(320, 240)
    pages = []
    while session.press("f1") or session.view.help:
        pages.append(set(composed(session)[-1].texts))
    return pages


def test_the_help_is_not_kept_in_the_language_of_before() -> None:
    before = help_in_small()
    with pseudo():
        assert written_key("ctrl+space") == f"Ctrl+{accented('Space')}"
        assert written_key("ctrl+z") == "Ctrl+Z"
        assert help_in_small() != before


def test_every_term_is_explained_in_whole_sentences() -> None:
    for term, meaning, _ in terms():
        assert meaning.endswith("."), term
        assert meaning[0].isupper() or meaning[0] == "δ", term
    assert len({term for term, _, _ in terms()}) == len(terms())


def test_the_glossary_comes_after_the_keys_and_tells_every_term() -> None:
    pages = help_in_small()
    first = next(number for number, page in enumerate(pages) if "Glossary" in page)
    assert first > 0
    assert all("Glossary" in page for page in pages[first:])
    told = " ".join(text for page in pages[first:] for text in page)
    for term, _, _ in terms():
        assert all(word in told for word in term.split()), term
