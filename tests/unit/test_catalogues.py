"""The catalogues hold the sentences of the sources, and their translations can stand in their place."""

import ast
import gettext
import re
from collections.abc import Iterator
from pathlib import Path
from string import Formatter

import pytest

from pinjoint.components.language import DOMAIN, ENGLISH, LANGUAGES
from pinjoint.components.view import BETWEEN
from tests.catalogues import KEYWORDS, ROOT, extracted, folders, is_translated, path_of, texts, translations

SOURCES = [
    path for folder in ("components", "systems", "game") for path in sorted((ROOT / folder).rglob("*.py"))
]
CATALOGUES = [
    (domain, language)
    for domain in folders()
    for language in LANGUAGES
    if language != ENGLISH and path_of(domain, language).is_file()
]
AGAIN = "run: python -m tests.catalogues update"


def sentences(domain: str) -> set[tuple[str | None, object]]:
    return {(message.context, message.id) for message in extracted(domain) if message.id}


@pytest.fixture(scope="module")
def present() -> dict[str, set[tuple[str | None, object]]]:
    return {domain: sentences(domain) for domain in folders()}


@pytest.mark.parametrize(("domain", "language"), CATALOGUES)
def test_a_catalogue_holds_the_sentences_of_the_sources_and_no_others(domain, language, present):
    held = {(message.context, message.id) for message in translations(domain, language) if message.id}
    assert not held ^ present[domain], AGAIN


def test_every_mod_with_sentences_has_its_catalogues(present):
    missing = [d for d, said in present.items() if said and (d, "pt") not in CATALOGUES]
    assert not missing, AGAIN


@pytest.mark.parametrize(("domain", "language"), CATALOGUES)
def test_what_the_program_reads_is_what_translators_wrote(domain, language):
    with path_of(domain, language).with_suffix(".mo").open("rb") as file:
        compiled = gettext.GNUTranslations(file)
    for message in translations(domain, language):
        if not message.id or message.fuzzy or not is_translated(message):
            continue
        if isinstance(message.id, tuple):
            one, many = message.id
            got = tuple(compiled.ngettext(one, many, number) for number in (1, 2))
        elif message.context is not None:
            got = compiled.pgettext(message.context, message.id)
        else:
            got = compiled.gettext(message.id)
        assert got == message.string, AGAIN


def fields(text: str) -> set[tuple[str, str, str]]:
    return {(name, spec, kind or "") for _, name, spec, kind in Formatter().parse(text) if name is not None}


@pytest.mark.parametrize(("domain", "language"), CATALOGUES)
def test_translations_fill_in_the_same_values(domain, language):
    for message in translations(domain, language):
        if not message.id or not is_translated(message) or message.fuzzy:
            continue
        if isinstance(message.id, tuple):
            for source, said in zip(message.id, message.string, strict=True):
                assert fields(said) - {("count", "", "")} == fields(source) - {("count", "", "")}
        elif can_be_filled(message.id):
            assert fields(message.string) == fields(message.id)


@pytest.mark.parametrize(("domain", "language"), CATALOGUES)
def test_translations_keep_the_steps_of_a_hint_apart(domain, language):
    """They are shown one by one, where there is room."""
    for message in translations(domain, language):
        if isinstance(message.id, str) and is_translated(message):
            assert message.string.count(BETWEEN) == message.id.count(BETWEEN), message.id


def can_be_filled(text: str) -> bool:
    """False for examples with single braces."""
    try:
        return bool(fields(text))
    except ValueError:
        return False


def calls() -> Iterator[tuple[Path, ast.Call, str]]:
    """But for those in functions whose own arguments are sentences: they pass them on."""
    for path in SOURCES:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        outer = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.name in KEYWORDS]
        passed_on = {inner for function in outer for inner in ast.walk(function)}
        for node in ast.walk(tree):
            match node:
                case ast.Call(func=ast.Name(name), args=[_, *_]) if name in KEYWORDS and node not in passed_on:
                    yield path, node, name


def test_the_sentences_of_every_error_are_extracted():
    kinds = re.compile(r"^class (\w+)\(.*\b(?:Explained|Mistake|ModError|ModelError)\b", re.MULTILINE)
    assert {name for path in SOURCES for name in kinds.findall(path.read_text("utf-8"))} <= KEYWORDS.keys()


def test_sentences_are_literals_so_that_catalogues_hold_them(present):
    """Babel finds literals only: no f-strings, no choices in the argument, no sentence within an f-string."""
    held = {part for _, said in present[DOMAIN] for part in (said if isinstance(said, tuple) else (said,))}
    wrong = []
    for path, call, keyword in calls():
        places = [place for place in KEYWORDS[keyword] or (1,) if isinstance(place, int)]
        for argument in [call.args[place - 1] for place in places if place <= len(call.args)]:
            if isinstance(argument, ast.Constant):
                known = argument.value in held or not argument.value
            else:  # of what is marked elsewhere
                literals = ast.Constant, ast.JoinedStr, ast.BinOp
                known = keyword not in ("marked", "plural") and not any(
                    isinstance(b, literals) for b in branches(argument)
                )
            if not known:
                wrong.append(f"{path.relative_to(ROOT)}:{call.lineno}: {ast.unparse(argument)}")
    assert not wrong, "\n".join(wrong)


def branches(node: ast.expr) -> Iterator[ast.expr]:
    """What an expression may become, by its conditions."""
    if isinstance(node, ast.IfExp):
        yield from branches(node.body)
        yield from branches(node.orelse)
    else:
        yield node


def test_nothing_is_translated_while_modules_are_imported():
    """At import nobody has chosen a language yet."""
    wrong = []
    for path in SOURCES:
        for statement in ast.parse(path.read_text(encoding="utf-8")).body:
            wrong += [f"{path.relative_to(ROOT)}:{line}" for line in said_at_import(statement)]
    assert not wrong, "\n".join(wrong)


def said_at_import(node: ast.AST) -> Iterator[int]:
    """Lines of calls of tr, tr_in and plural that run when a module is imported."""
    if (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in ("tr", "tr_in", "plural")
    ):
        yield node.lineno
    if isinstance(node, ast.Lambda):
        return
    later = node.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) else ()
    for child in ast.iter_child_nodes(node):
        if child not in later:
            yield from said_at_import(child)


def test_what_people_call_kinds_and_fields_is_extracted(present):
    said = {message for _, message in present[DOMAIN]}
    assert {"particles", "particle", "angular velocity", "stiffness", "unlimited", "Mass per length."} <= said
    assert "sail area" in {message for _, message in present["wind"]}


def test_texts_of_data_are_extracted_by_their_keys(tmp_path):
    (tmp_path / "film.jsonl").write_text(
        '{"say": "Go."}\n# note\n{"hints": ["One", "Two"], "right": {"say": "Yes"}}\n'
    )
    (tmp_path / "data.json").write_text('{"materials": {"steel": {}, "oak": {"title": "Oak"}}}')
    with (tmp_path / "film.jsonl").open("rb") as file:
        assert [text for _, _, text, _ in texts(file, (), (), {"keys": ["say", "hints"]})] == [
            "Go.",
            "One",
            "Two",
            "Yes",
        ]
    with (tmp_path / "data.json").open("rb") as file:
        options = {"keys": ["title"], "names_of": ["materials"]}
        assert [text for _, _, text, _ in texts(file, (), (), options)] == ["steel", "oak", "Oak"]


@pytest.mark.parametrize(("domain", "language"), CATALOGUES)
def test_every_sentence_is_translated_and_none_waits_to_be_read_again(domain, language):
    messages = [message for message in translations(domain, language) if message.id]
    left = [message.id for message in messages if message.fuzzy or not is_translated(message)]
    assert not left, f"{len(left)} of {len(messages)}: {left[:20]}"
