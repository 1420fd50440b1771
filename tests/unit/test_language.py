"""Sentences in the language of the person, and the same in English for scripts."""

import pickle

import pytest

from pinjoint.components import language
from pinjoint.components.language import Said, begun, english, joined, listed, plural, spoken, tr, tr_in
from pinjoint.components.mistake import Mistake

PASSED = "{time:.1f} s have passed. Space lets it run, + makes it faster."
FAILED = "{what} failed: {error}"


def test_in_english_messages_are_filled_in_as_they_are() -> None:
    assert tr("{rod} carries {force:.1f} kN.", rod="AB", force=-70.71) == "AB carries -70.7 kN."
    assert tr("a set {1, 2}") == "a set {1, 2}"
    assert [plural("one rod", "{count} rods", count) for count in (1, 3)] == ["one rod", "3 rods"]
    assert listed(["A", "B", "C"]) == "A, B and C"


def test_messages_are_translated_numbers_with_commas_names_as_they_are() -> None:
    with spoken("pt"):
        said = tr(FAILED, what="A.B", error=-70.71)
        assert (said, english(said)) == ("A.B falhou: -70,71", "A.B failed: -70.71")
        assert tr_in("key", "Arrows") == "Setas"
        assert plural("{count} rod", "{count} rods", 3) == "3 barras"
        assert listed(["A", "B", "C"]) == "A, B e C"


def test_errors_and_sentences_in_a_row_keep_their_english() -> None:
    with spoken("pt"):
        said = tr(FAILED, what="It", error=Mistake(PASSED, time=0.5))
        both = joined([said, "", "More."])
    assert said == "It falhou: Passaram 0,5 s. Espaço põe a correr, + acelera."
    assert isinstance(both, Said)
    assert english(both) == f"It failed: {PASSED} More.".format(time=0.5)


def test_what_is_translated_already_and_nothing_stay_as_they_are() -> None:
    with spoken("pt"):
        said = tr(PASSED, time=1.0)
        assert tr(said) is said
        assert tr("") == ""
        raised = begun(tr("free"))
        assert (raised, english(raised)) == ("Livre", "Free")
    assert begun("rod AB") == "Rod AB"


def test_what_was_said_in_english_is_said_anew_with_what_it_is_filled_with() -> None:
    error = Mistake(FAILED, what=begun(tr("free")), error=Mistake(PASSED, time=1.0))
    both = joined([tr(FAILED, what="A", error=error), "B"], "; ")
    first = str(error), str(both)
    with spoken("pt"):
        again = "Livre falhou: Passaram 1,0 s. Espaço põe a correr, + acelera."
        assert (str(error), tr(both)) == (again, f"A falhou: {again}; B")
    assert (str(error), tr(both)) == first


def test_an_error_can_be_copied_and_sent_to_another_process() -> None:
    error = pickle.loads(pickle.dumps(Mistake("{rod} carries {force:.1f} kN.", rod=object(), force=1.0)))
    assert type(error) is Mistake
    assert str(error).endswith("carries 1.0 kN.")


def test_an_unknown_language_is_refused_and_nothing_changes() -> None:
    with pytest.raises(ValueError, match="'xx'"), language.spoken("xx"):
        pass
    assert language.language() == "en"
