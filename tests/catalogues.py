"""Catalogues of the sentences, kept by Babel: `python -m tests.catalogues update`, with `fr` for a new language.

`update` extracts the sentences of the sources as [tool.babel] in pyproject.toml says, brings every .po up to date and
compiles it. A sentence whose English changed a little keeps its translation, marked fuzzy, until somebody has read it.
Mods among the assets have catalogues of their own.
"""

import argparse
import ast
import json
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, Any

from babel.messages.catalog import Catalog, Message
from babel.messages.extract import extract_from_dir
from babel.messages.frontend import parse_keywords
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

from pinjoint.components.language import DOMAIN, ENGLISH, LANGUAGES, LOCALE

ROOT = Path(__file__).parents[1]
MODS = ROOT / "assets" / "mods"
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["babel"]
# names of functions whose arguments are sentences, and which of them are
KEYWORDS = parse_keywords(SETTINGS["keywords"])
FIELDS = ("Field", "state", "derived", "look", "by_end", "if_known")  # what makes them
NO_DATE = datetime(2000, 1, 1, tzinfo=UTC)  # a date would make every update a change
_HEADER = """\
msgid ""
msgstr ""
"Language: {catalogue.locale}\\n"
"MIME-Version: 1.0\\n"
"Content-Type: text/plain; charset=utf-8\\n"
"Content-Transfer-Encoding: 8bit\\n"
"Plural-Forms: {catalogue.plural_forms}\\n"

"""


def sentences(
    file: IO[bytes], keywords: Iterable[str], comment_tags: object, options: object
) -> Iterator[tuple[int, str | None, Any, list[str]]]:
    """The sentences of a module in Python, as Babel asks for them, whose own way passes over some calls within calls."""
    for node in ast.walk(ast.parse(file.read())):
        match node:
            case ast.Call(func=ast.Name(name) | ast.Attribute(attr=name), args=[_, *_]) if name in keywords:
                said = [part.value if isinstance(part, ast.Constant) else None for part in node.args]
                texts = tuple(part if isinstance(part, str) else None for part in said)
                yield node.lineno, name, texts if len(texts) > 1 else texts[0], []


def kinds(
    file: IO[bytes], keywords: Iterable[str], comment_tags: object, options: object
) -> Iterator[tuple[int, str | None, Any, list[str]]]:
    """The sentences of a module in Python, as Babel asks for them, and what people call its kinds and their Fields."""
    yield from sentences(file, keywords, comment_tags, options)
    file.seek(0)
    for node in ast.walk(ast.parse(file.read())):
        match node:
            case ast.AnnAssign(target=ast.Name(name), value=ast.Call(func=ast.Name(maker), keywords=given)):
                if maker in FIELDS:
                    known = {g.arg: g.value.value for g in given if isinstance(g.value, ast.Constant)}
                    words = {"title": known.get("overrides", name).replace("_", " ")} | known
                    said = [words.get(key) for key in ("title", "doc", "absent")]
                    yield from ((node.lineno, None, text, []) for text in said if text)
            case ast.Assign(targets=[ast.Tuple([ast.Name("table"), *_])], value=ast.Tuple(names)):
                said = [word.value for word in names[:2] if isinstance(word, ast.Constant)]
                yield from ((node.lineno, None, text, []) for text in said)


def texts(
    file: IO[bytes], _keywords: object, _tags: object, options: Mapping[str, Any]
) -> Iterator[tuple[int, None, str, list[str]]]:
    """The texts of a file of JSON, or of JSON lines, as Babel asks for them.

    options: `keys` whose values, or lists of values, are texts; `names_of` objects whose keys are texts.
    """
    keys, names_of = options.get("keys", ()), options.get("names_of", ())
    text = file.read().decode("utf-8")
    lines = text.splitlines() if file.name.endswith(".jsonl") else [text]
    for number, line in enumerate(lines, start=1):
        if line.strip() and not line.startswith("#"):
            yield from ((number, None, found, []) for found in _found(json.loads(line), keys, names_of))


def _found(value: object, keys: Iterable[str], names_of: Iterable[str]) -> Iterator[str]:
    if isinstance(value, dict):
        for key, part in value.items():
            if key in names_of:
                yield from part
            if key in keys:
                yield from (
                    text for text in (part if isinstance(part, list) else [part]) if isinstance(text, str)
                )
            yield from _found(part, keys, names_of)
    elif isinstance(value, list):
        for part in value:
            yield from _found(part, keys, names_of)


def folders() -> dict[str, tuple[Path, Path]]:
    """By domain: the folder whose sentences it holds, and that of its catalogues. Ours and those of the mods."""
    mods = {
        folder.name: (folder, folder / "locale") for folder in MODS.iterdir() if (folder / "mod.toml").is_file()
    }
    return {DOMAIN: (ROOT, LOCALE)} | dict(sorted(mods.items()))


def extracted(domain: str) -> Catalog:
    """The sentences of the sources of a domain."""
    if domain == DOMAIN:
        mappings = [
            (pattern, mapping["method"], mapping)
            for mapping in SETTINGS["mappings"]
            for pattern in mapping["patterns"]
        ]
    else:
        mappings = [("**.py", "tests.catalogues:kinds", {})]
    found = Catalog(domain=domain, creation_date=NO_DATE)
    places = extract_from_dir(
        folders()[domain][0],
        [(pattern, method) for pattern, method, _ in mappings],
        {pattern: options for pattern, _, options in mappings},
        KEYWORDS,
    )
    for file, line, message, comments, context in places:
        found.add(message, None, [(file, line)], auto_comments=comments, context=context)
    return found


def path_of(domain: str, language: str) -> Path:
    """The file of the translations, which need not exist yet."""
    return folders()[domain][1] / language / "LC_MESSAGES" / f"{domain}.po"


def translations(domain: str, language: str) -> Catalog:
    """The translations of a domain, as they are."""
    with path_of(domain, language).open("rb") as file:
        return read_po(file, locale=language, domain=domain)


def update(domain: str, language: str) -> Catalog:
    """Write the translations of the present sentences, and what the program reads."""
    path = path_of(domain, language)
    catalogue = translations(domain, language) if path.is_file() else Catalog(locale=language, domain=domain)
    catalogue.update(extracted(domain))
    catalogue.creation_date = NO_DATE
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        file.write(_HEADER.format(catalogue=catalogue).encode())
        write_po(
            file, catalogue, 0, omit_header=True, sort_output=True, ignore_obsolete=True, include_lineno=False
        )
    catalogue = translations(domain, language)
    catalogue.creation_date = NO_DATE
    with path.with_suffix(".mo").open("wb") as file:
        write_mo(file, catalogue)
    return catalogue


def is_translated(message: Message) -> bool:
    """True if nothing of a sentence is missing."""
    return all(message.string) if isinstance(message.string, tuple) else bool(message.string)


def main() -> None:
    """Update the catalogues, and count what is left to translate."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.catalogues", description="Keep the catalogues of sentences."
    )
    parser.add_argument("command", choices=("update",))
    parser.add_argument(
        "languages", nargs="*", metavar="LANGUAGE", help="a code such as fr; default: those there are"
    )
    options = parser.parse_args()
    for language in options.languages or (code for code in LANGUAGES if code != ENGLISH):
        for domain in folders():
            if not len(extracted(domain)):
                continue
            messages = [message for message in update(domain, language) if message.id]
            left = sum(not is_translated(message) for message in messages)
            fuzzy = sum(message.fuzzy for message in messages)
            print(
                f"{domain} {language}: {len(messages)} sentences, {left} not translated, {fuzzy} to be read again"
            )


if __name__ == "__main__":
    main()
