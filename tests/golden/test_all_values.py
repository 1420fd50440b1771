"""Every end value of a diagram can be read: beside its rod, at the end of a line, or in the list of numbered ones."""

import re
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise, product

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import AXIAL, is_frame
from pinjoint.components.language import spoken
from pinjoint.components.model import Model
from pinjoint.components.settings import DIAGRAMS, STATICS
from pinjoint.components.view import View
from pinjoint.documents import models
from pinjoint.pictures import on_paper
from pinjoint.systems.render.marks import Panel, Picture, Text, Values
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.golden.test_nearness import misplaced

LIGHT = load_theme("light")
SIZES = (640, 480), (800, 600), (1024, 768), (1280, 800), (1920, 1080)
PANELS = ("en", ""), ("pt", "m"), ("pt", "n")  # in which language, and the keys that open them
TOO_MANY, WIDE = 200, 1300  # rods, of which only wider canvases show all values
FEW, SHORT = 20, 24.0  # members up to which, and pixels from which on, none is told by a number in 1280 by 800

_NUMBER = re.compile(r"[+−]?\d[\d.,]*")


def told(picture: Picture, model: Model) -> tuple[dict[int, list[float]], int]:
    """The sizes that are told of each rod, and how many of them only in the list."""
    found, numbered = defaultdict(list), defaultdict[str, list[int]](list)
    listed: list[tuple[str, str]] = []
    marks = picture.marks
    for before, mark in pairwise(marks):
        if not isinstance(mark, Text) or mark.colour == LIGHT.load:
            continue
        if mark.of is None:
            listed.append((mark.text, mark.text))
        elif mark.of[0] == "rods" and isinstance(before, Panel) and before.outline is not None:
            numbered[mark.text].append(mark.of[1])
        elif mark.of[0] == "rods" and (value := _NUMBER.match(mark.text)):
            found[mark.of[1]].append(_size(value[0]))
    texts, only = [text for text, _ in listed], 0
    names = list(model.rods.names)
    for said, value in pairwise(texts):
        rows = list(numbered.get(said, ()))
        for one in said.split(", "):
            first, _, last = one.partition(" … ")
            if {first, last or first} <= {*names}:
                rows += range(names.index(first), names.index(last or first) + 1)
        for row in rows * bool(_NUMBER.fullmatch(value.split()[0])):
            found[row].append(_size(value.split()[0]))
            only += 1
    return found, only


def _size(text: str) -> float:
    return abs(float(text.replace("−", "-").replace(",", ".")))


def missing(model: Model, quantity: str, found: dict[int, list[float]]) -> list[str]:
    """Ends of rods whose value no rod at the same joint tells, but where it is that of the only other rod there, too."""
    rods = model.rods
    if is_frame(model):
        column = {"N": "end_axial_force", "V": "shear", "M": "bending_moment"}[quantity]
        ends = np.abs(getattr(rods, column))
    else:
        ends = np.abs(np.repeat(rods.axial_force[:, None], 2, axis=1))
    joints, largest = rods.between.astype(int), ends.max(initial=0.0)
    at = defaultdict(list)
    for row, pair in enumerate(joints.tolist()):
        for end, joint in enumerate(pair):
            at[joint].append((row, end))
    spread(found, ends, at, largest)
    left = []
    for row, end in np.ndindex(*ends.shape):
        value, here = ends[row, end], at[int(joints[row, end])]
        if value <= max(1.1e-3 * largest, 1e-4):
            continue
        same = len(here) == 2 and abs(ends[here[0]] - ends[here[1]]) <= 1e-2 * largest
        near = any(abs(size - value) <= 6e-3 * largest for other, _ in here for size in found[other])
        if not same and not near:
            left.append(f"{value:.4g} at the {('start', 'end')[end]} of {rods.names[row]}")
    return left


def spread(
    found: dict[int, list[float]], ends: Values, at: dict[int, list[tuple[int, int]]], largest: float
) -> None:
    """Let rods with constant values tell what others do that go on from them with the same."""
    constant = np.abs(ends[:, 0] - ends[:, 1]) <= 1e-2 * largest
    for _ in range(len(ends)):
        for here in at.values():
            if len(here) == 2 and abs(ends[here[0]] - ends[here[1]]) <= 1e-2 * largest:
                for (one, _), (other, _) in (here, here[::-1]):
                    if constant[one] and constant[other] and not found[one]:
                        found[one] += found[other]


@pytest.mark.parametrize("name", models.bundled())
def test_no_value_is_missing(name: str) -> None:
    session = Session.open(name)
    if not session.model.rods.count:
        return
    if session.scene != STATICS:
        session.press("q")
    session.view.all_diagrams = True
    for size, (code, panel) in product(SIZES, PANELS):
        session.resize(*size, 1.0)
        session.view.wanted = frozenset()
        with spoken(code):
            for key in [*panel, "home"]:
                session.press(key)
            session.update_view()
            (model, view), *_ = session.stages
            assert isinstance(model, Model)
            for view.quantity in DIAGRAMS if is_frame(model) else (AXIAL,):
                where = name, size, panel, view.quantity
                assert list(unreadable(session, model, view)) == [], where
                assert panel or list(unreadable(session, model, on_paper(view))) == [], where


def unreadable(session: Session, model: Model, view: View) -> Iterator[str]:
    """What cannot be read in a picture or the table beside it, or stands at something else; advice in a file."""
    picture = compose(model, view, LIGHT)
    found, listed = told(picture, model)
    # A panel leaves no room for a list.
    small = model.rods.count > FEW or float(np.median(model.rods.length)) * view.camera.scale < SHORT
    crowded = view.shares and view.canvas.height < 500 and small
    yield from misplaced(picture, model)
    if view.table[0]:
        assert session.lister.tables["rods"].names == model.rods.names
        texts = compose(session.lister.listing, view, LIGHT).texts
        yield from (text for text in texts if "…" in text and text[0] in "−0123456789")
    elif (model.rods.count < TOO_MANY and not crowded) or view.canvas.width > WIDE:
        yield from missing(model, view.quantity, found)
        yield from (text for text in picture.texts if "hidden" in text)
        if listed and not small and session.view.camera.viewport.width >= 1280 and not view.shares:
            yield f"{listed} of them are numbered"
    if not view.advises:
        yield from (text for text in picture.texts if "zoom in" in text)
