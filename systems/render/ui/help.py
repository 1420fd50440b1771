"""Help: a card with everything that can be pressed in the present mode, by purpose, and then the glossary.

The terms of the program stand beside those of courses, each explained in plain sentences (assets/glossary.json).
"""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Sequence
from functools import cache, lru_cache
from importlib.resources import files
from itertools import groupby

import numpy as np

from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.language import language, tr
from pinjoint.components.view import Hit, View
from pinjoint.systems.render.marks import Fills
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import ALL, in_rows
from pinjoint.systems.render.ui.buttons import closing, written_key
from pinjoint.systems.render.ui.layout import Column, Gap, Paper, Part, Plate, Row, Text, in_columns, rule

_SIZE, _APART = 12.0, 16.5  # points: of its type, and from line to line
_SIDE, _HEAD, _GAP = 18.0, 46.0, 26.0  # points: around all, the heading, between columns
_TERM, _MEANING = 140.0, 330.0  # points across a term and its meaning

Lines = tuple[tuple[str, str], ...]  # (key, meaning); ("", purpose) stands above the keys of a purpose


@cache
def terms() -> list[tuple[str, str, str]]:
    """All terms, as the file has them: each, what it means, and what it is also called, or ""."""
    held = json.loads((files("pinjoint.assets") / "glossary.json").read_text(encoding="utf-8"))
    return [(entry["term"], entry["meaning"], entry.get("also", "")) for entry in held]


def help_pages(keys: Lines, viewport: Viewport, unit: float, theme: Theme) -> list[list[Column]]:
    """The pages in the present language that a viewport needs, each in columns; those of the glossary are the last."""
    return _pages(keys, viewport, unit, theme, language())


@lru_cache(maxsize=4)
def _pages(keys: Lines, viewport: Viewport, u: float, theme: Theme, _: str) -> list[list[Column]]:
    glossary = sorted(
        (tuple(map(tr, entry)) for entry in terms()),
        key=lambda entry: unicodedata.normalize("NFKD", entry[0].casefold()),
    )  # in the alphabetical order of the present language
    known = [(f"{term} ({also})" if also else term, meaning) for term, meaning, also in glossary]
    joined = _joined(keys)
    widest = max(Text(names, _SIZE, theme.text, "semibold").width(u) for names, _ in joined) / u
    return [
        page
        for lines, first in ((joined, widest + 12.0), ([("", tr("Glossary")), *known], _TERM))
        for page in _paged(lines, first, viewport, u, theme)
    ]


def _paged(
    lines: Sequence[tuple[str, str]], first: float, v: Viewport, u: float, theme: Theme
) -> list[list[Column]]:
    """Lines in columns of equal width, as many on a page as have room; first: points across what is explained."""
    room = max(v.width - (2 * _SIDE + 4.0) * u, 1.0)
    first = min(first, 0.35 * room / u)
    meant = max(Text(meaning, _SIZE, theme.muted).width(u) for _, meaning in lines)
    width = min(first * u + min(meant, _MEANING * u), room)
    groups: list[list[Part]] = []
    for is_key, those in groupby(lines, lambda line: bool(line[0])):
        if is_key:
            groups[-1] += [_line(key, meaning, first, theme) for key, meaning in those]
        else:
            for _, purpose in those:
                title = Text(purpose, _SIZE, theme.text, "semibold", apart=_APART)
                groups.append([Column((title, Row((rule(theme.line, 2.0),))))])
    high = v.height - (_HEAD + _SIDE) * u
    columns = [Column(parts, wide=width / u) for parts in in_columns(groups, Gap(), u, high, width, heads=True)]
    return in_rows(columns, max(int((room + _GAP * u) / (width + _GAP * u)), 1))


def _line(key: str, meaning: str, first: float, theme: Theme) -> Row:
    name = Text(key, _SIZE, theme.text, "semibold", lines=ALL, apart=_APART, wide=first)
    return Row((name, Text(meaning, _SIZE, theme.muted, lines=ALL, apart=_APART, grow=1.0)), top=True)


def put_help(paper: Paper, view: View, v: Viewport, theme: Theme) -> None:
    """A page of the help over everything else in a viewport; a press leafs through it, or closes it."""
    if not view.keys:
        return
    pages, u = help_pages(tuple(view.keys), v, paper.unit, theme), paper.unit
    number, wheel = min(view.help, len(pages)), ("help back", "help on")
    corners = [(v.left, v.top), (v.right, v.top), (v.right, v.bottom), (v.left, v.bottom)]
    paper.marks.append(Fills(np.array([corners], dtype=np.float64), faded(theme.background, 0.75)))
    paper.hits.append(Hit(*view.camera.viewport.box, "close help", wheel=wheel))
    heading = tr("Help, page {page} of {pages}", page=number, pages=len(pages))
    goes_on = number < len(pages)
    says = tr("F1, click or wheel: next page") if goes_on else tr("F1 or click: close")
    head = Row(
        (
            Text(heading, (16.0, 13.0, 11.0), theme.text, "semibold"),
            Text(says, (_SIZE, 10.0), theme.muted, anchor="right", grow=1.0),
            closing("close help", theme, 22.0),
        ),
        10.0,
        (0.0, 0.0, 0.0),
        high=_HEAD - 12.0,
    )
    columns = Row(pages[number - 1], _GAP, even=True)
    action = "toggle help" if goes_on else "close help"
    inside = Column((head, columns), around=(_SIDE, 6.0, _SIDE))
    card = Plate(inside, theme.panel, theme.line, radius=10.0, action=action, wheel=wheel)
    width = min(card.width(u), v.width - 4.0 * u)
    height = min(card.height(u, width), v.height)
    paper.put(card, Rectangle(v.left + (v.width - width) / 2, v.top + (v.height - height) / 2, width, height))


def _joined(keys: Lines) -> list[tuple[str, str]]:
    """Keys that do the same for one purpose, in one line: ("Ctrl+Y, Ctrl+Shift+Z", "redo")."""
    by_title: dict[tuple[str, str], list[str]] = {}
    purpose = ""
    for key, title in keys:
        purpose = purpose if key else title
        by_title.setdefault((purpose, title), []).append(key)
    return [(_written_keys(names), title) for (_, title), names in by_title.items()]


def _written_keys(keys: list[str]) -> str:
    """Some keys; all four arrows are called so."""
    stem = keys[0].removesuffix("left")
    if keys == [f"{stem}{way}" for way in ("left", "right", "up", "down")]:
        keys = [f"{stem}arrows"]
    return ", ".join(map(written_key, keys)) if keys != [""] else ""
