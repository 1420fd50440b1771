"""Sentences in the language of the person, and the same in English for scripts."""

import pytest

from pinjoint.components import language
from pinjoint.components.language import Said, begun, english, joined, listed, plural, spoken, tr, tr_in
from pinjoint.components.mistake import Mistake
from tests.pseudo import accented, pseudo


def test_in_english_messages_are_filled_in_as_they_are() -> None:
    assert tr("{rod} carries {force:.1f} kN.", rod="AB", force=-70.71) == "AB carries -70.7 kN."
    assert tr("a set {1, 2}") == "a set {1, 2}"
    assert [plural("one rod", "{count} rods", count) for count in (1, 3)] == ["one rod", "3 rods"]
    assert listed(["A", "B", "C"]) == "A, B and C"


def in_pseudo(message: str, **values: str) -> str:
    return accented(message).format(**values)


FORCE = "{rod} carries {force:.1f} kN."


def test_messages_are_translated_numbers_with_commas_names_as_they_are() -> None:
    with pseudo():
        said = tr(FORCE, rod="A.B", force=-70.71)
        assert said == in_pseudo("{rod} carries {force} kN.", rod="A.B", force="-70,7")
        assert english(said) == "A.B carries -70.7 kN."
        assert plural("one rod", "{count} rods", 3) == in_pseudo("{count} rods", count="3")
        assert listed(["A", "B", "C"]) == in_pseudo("{names} and {last}", names="A, B", last="C")
        assert tr_in("support", "free") == in_pseudo("free")


def test_errors_and_sentences_in_a_row_keep_their_english() -> None:
    with pseudo():
        error = Mistake(tr(FORCE, rod="AB", force=1.0))
        said = tr("It says: {error}", error=error)
        assert said == in_pseudo("It says: {error}", error=str(error))
        assert english(said) == "It says: AB carries 1.0 kN."
        both = joined([said, "", tr("More.")])
    assert isinstance(both, Said)
    assert both.english == "It says: AB carries 1.0 kN. More."


def test_what_is_translated_already_and_nothing_stay_as_they_are() -> None:
    with spoken("pt"):
        said = tr(FORCE, rod="AB", force=1.0)
        assert tr(said) is said
        assert tr("") == ""
    with pseudo():
        raised = begun(tr_in("support", "free"))
        assert (raised, english(raised)) == (in_pseudo("Free"), "Free")
        assert begun("rod AB") == "Rod AB"


def test_an_unknown_language_is_refused_and_nothing_changes() -> None:
    with pytest.raises(ValueError, match="'xx'"), language.spoken("xx"):
        pass
    assert language.language() == "en"
