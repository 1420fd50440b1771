"""Sentences in the language of the person, and the same in English for scripts."""

import pickle

import pytest

from pinjoint.components import language
from pinjoint.components.language import Said, begun, english, joined, listed, plural, tr, tr_in
from pinjoint.components.mistake import Mistake

HELD = {
    "{rod} carries {force:.1f} kN.": "A barra {rod} suporta {force:.1f} kN.",
    "free\x04support": "livre",
    "It says: {error}": "Diz: {error}",
    "{names} and {last}": "{names} e {last}",
}


class _Held:
    """A catalogue of four messages."""

    def gettext(self, message: str) -> str:
        return HELD.get(message, message)

    def pgettext(self, context: str, message: str) -> str:
        return HELD.get(f"{message}\x04{context}", message)

    def ngettext(self, one: str, many: str, count: int) -> str:
        return "{count} barras" if count > 1 else "uma barra"


@pytest.fixture
def portuguese(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(language._SPOKEN, "code", "pt")
    monkeypatch.setattr(language._SPOKEN, "catalogue", _Held())


def test_in_english_messages_are_filled_in_as_they_are() -> None:
    assert tr("{rod} carries {force:.1f} kN.", rod="AB", force=-70.71) == "AB carries -70.7 kN."
    assert tr("a set {1, 2}") == "a set {1, 2}"
    assert [plural("one rod", "{count} rods", count) for count in (1, 3)] == ["one rod", "3 rods"]
    assert listed(["A", "B", "C"]) == "A, B and C"


@pytest.mark.usefixtures("portuguese")
def test_messages_are_translated_numbers_with_commas_names_as_they_are() -> None:
    said = tr("{rod} carries {force:.1f} kN.", rod="A.B", force=-70.71)
    assert said == "A barra A.B suporta -70,7 kN."
    assert english(said) == "A.B carries -70.7 kN."
    assert tr_in("support", "free") == "livre"
    assert plural("one rod", "{count} rods", 3) == "3 barras"
    assert listed(["A", "B", "C"]) == "A, B e C"


@pytest.mark.usefixtures("portuguese")
def test_errors_and_sentences_in_a_row_keep_their_english() -> None:
    error = Mistake("{rod} carries {force:.1f} kN.", rod="AB", force=1.0)
    said = tr("It says: {error}", error=error)
    assert said == "Diz: A barra AB suporta 1,0 kN."
    assert english(said) == "It says: AB carries 1.0 kN."
    both = joined([said, "", "More."])
    assert isinstance(both, Said)
    assert both.english == "It says: AB carries 1.0 kN. More."


@pytest.mark.usefixtures("portuguese")
def test_what_is_translated_already_and_nothing_stay_as_they_are() -> None:
    said = tr("{rod} carries {force:.1f} kN.", rod="AB", force=1.0)
    assert tr(said) is said
    assert tr("") == ""
    raised = begun(tr_in("support", "free"))
    assert (raised, english(raised)) == ("Livre", "Free")
    assert begun("rod AB") == "Rod AB"


@pytest.mark.usefixtures("portuguese")
def test_what_was_said_in_english_is_said_anew_with_what_it_is_filled_with(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(language._SPOKEN, "code", "en")
    error = Mistake("{rod} carries {force:.1f} kN.", rod=begun(tr_in("support", "free")), force=1.0)
    both = joined([tr("It says: {error}", error=error), "AB"], "; ")
    assert (str(error), both) == ("Free carries 1.0 kN.", "It says: Free carries 1.0 kN.; AB")
    monkeypatch.setattr(language._SPOKEN, "code", "pt")
    assert str(error) == "A barra Livre suporta 1,0 kN."
    assert tr(both) == "Diz: A barra Livre suporta 1,0 kN.; AB"
    monkeypatch.setattr(language._SPOKEN, "code", "en")
    assert tr(tr(both)) == "It says: Free carries 1.0 kN.; AB"


def test_an_error_can_be_copied_and_sent_to_another_process() -> None:
    error = pickle.loads(pickle.dumps(Mistake("{rod} carries {force:.1f} kN.", rod=object(), force=1.0)))
    assert type(error) is Mistake
    assert str(error).endswith("carries 1.0 kN.")


def test_an_unknown_language_is_refused_and_nothing_changes() -> None:
    with pytest.raises(ValueError, match="'xx'"), language.spoken("xx"):
        pass
    assert language.language() == "en"
