"""The language of the program: --language, PINJOINT_LANGUAGE, what the person chose, what the system speaks."""

import json
import locale
import sys

import pytest

from pinjoint import __main__ as program
from pinjoint.commands import language as choice
from pinjoint.components.language import language
from pinjoint.components.mistake import Mistake
from pinjoint.documents.preferences import preferred, remember

OF_SYSTEM = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")


@pytest.fixture
def person(config, monkeypatch):
    """Somebody who has asked for nothing yet, on a system without a language."""
    for variable in (*OF_SYSTEM, choice.VARIABLE):
        monkeypatch.setenv(variable, "")
    monkeypatch.setattr(locale, "getlocale", lambda: (None, None))
    # the next signal would end the process of the tests
    monkeypatch.setattr(program, "end_in_time", lambda: None)
    return monkeypatch


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({}, "en"),
        ({"LANG": "pt_PT.UTF-8"}, "pt"),
        ({"LANG": "pt_BR.UTF-8"}, "pt"),
        ({"LANG": "pt"}, "pt"),
        ({"LANG": "pt_PT@euro"}, "pt"),
        ({"LANG": "fr_FR.UTF-8"}, "en"),
        ({"LANG": "C.UTF-8"}, "en"),
        ({"LANG": "pt_PT", "LC_MESSAGES": "en_GB"}, "en"),
        ({"LANG": "en_GB", "LC_ALL": "pt_PT", "LC_MESSAGES": "en_GB"}, "pt"),
        ({"LANG": "en_GB", "LANGUAGE": "fr:pt_BR:en"}, "pt"),
        ({"LANG": "pt_PT", "LANGUAGE": "de:en:pt"}, "en"),
    ],
)
def test_the_language_of_the_system_is_that_of_gettext(person, variables, expected):
    for variable, value in variables.items():
        person.setenv(variable, value)
    assert choice.speak_as_asked(["run"]) == ["run"]
    assert language() == expected


@pytest.mark.parametrize(
    ("name", "expected"), [("Portuguese_Brazil", "pt"), ("pt_PT", "pt"), ("German_Austria", "en")]
)
def test_systems_without_these_variables_name_their_language(person, name, expected):
    person.setattr(locale, "getlocale", lambda: (name, "1252"))
    assert choice.language_of_system() == expected


def test_the_choice_of_the_person_goes_before_the_system_and_what_is_asked_before_both(person):
    person.setenv("LANG", "pt_PT")
    remember("language", "en")
    choice.speak_as_asked([])
    assert language() == "en"
    person.setenv(choice.VARIABLE, "pt_PT")
    choice.speak_as_asked([])
    assert language() == "pt"
    assert choice.speak_as_asked(["--language", "en", "run", "x"]) == ["run", "x"]
    assert language() == "en" == choice.asked_language()


def test_a_variable_that_names_no_language_is_refused(person):
    person.setenv(choice.VARIABLE, "xx")
    with pytest.raises(Mistake, match="PINJOINT_LANGUAGE is 'xx'; set it to en, pt, or leave it out"):
        choice.speak_as_asked([])


@pytest.mark.parametrize("kept", ['"xx"', "7", "null", '["pt"]'])
def test_a_preference_that_is_no_language_counts_as_none(person, tmp_path, kept):
    (tmp_path / "settings.json").write_text(f'{{"language": {kept}}}')
    assert preferred("language") == ""


@pytest.mark.parametrize("place", ["before", "after"])
def test_the_option_stands_before_or_after_the_command(person, capsys, place):
    words = ["run", "isostatic", "--format", "json"]
    words = ["--language", "pt", *words] if place == "before" else [*words, "--language=pt"]
    person.setattr(sys, "argv", ["pinjoint", *words])
    assert program.main() == 0
    assert json.loads(capsys.readouterr().out)["status"] == "at rest"


def test_a_language_that_there_is_not_is_refused_in_one_sentence(person, capsys):
    person.setattr(sys, "argv", ["pinjoint", "run", "isostatic", "--language", "klingon"])
    assert program.main() == 2
    assert (
        capsys.readouterr().err
        == "pinjoint: --language klingon: there is no such language; write one of en, pt.\n"
    )


def test_argparse_speaks_the_language_too(person, capsys):
    person.setattr(sys, "argv", ["pinjoint", "--language", "pt", "run", "--help"])
    with pytest.raises(SystemExit):
        program.main()
    said = capsys.readouterr().out
    assert said.startswith("utilização: pinjoint run")
    assert "usage" not in said
    assert "mostrar esta ajuda e sair" in said
    person.setattr(sys, "argv", ["pinjoint", "--language", "pt", "run"])
    assert program.main() == 2
    assert "argumentos obrigatórios" in capsys.readouterr().err.lower()


def test_help_names_the_option(capsys):
    from pinjoint.commands.command_line import main

    with pytest.raises(SystemExit):
        main(["--help"])
    assert "--language en|pt" in capsys.readouterr().out
