"""Every end value of a diagram can be read: beside its rod, at the end of a line, or in the list of numbered ones."""

import re
from collections import defaultdict
from itertools import pairwise

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import AXIAL, is_frame
from pinjoint.components.model import Model
from pinjoint.components.settings import DIAGRAMS
from pinjoint.documents import models
from pinjoint.pictures import on_paper
from pinjoint.systems.render.marks import Panel, Picture, Text, Values
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme

LIGHT = load_theme("light")
ALWAYS, SOMETIMES = ((640, 480), (1280, 800)), ((800, 600), (1920, 1080), (2400, 1500))
# In the smallest size pictures in files are looked at: panels of a window leave no room for a list beside 50 rods there.
TOO_MANY = "hanging_net"  # 264 rods, of which a window shows all values from 1920 by 1080 on
FEW = 20  # members, up to which none is told by a number in 1280 by 800

_NUMBER = re.compile(r"[+−]?\d[\d.]*")


def told(picture: Picture, model: Model) -> tuple[dict[int, list[float]], int]:
    """The sizes that are told of each rod, and how many of them only in the list."""
    found, numbered = defaultdict(list), dict[str, int]()
    listed: list[tuple[str, str]] = []
    marks = picture.marks
    for before, mark in pairwise(marks):
        if not isinstance(mark, Text):
            continue
        if mark.of is None:
            listed.append((mark.text, mark.text))
        elif mark.of[0] == "rods" and isinstance(before, Panel) and before.outline is not None:
            numbered[mark.text] = mark.of[1]
        elif mark.of[0] == "rods" and (value := _NUMBER.match(mark.text)):
            found[mark.of[1]].append(abs(float(value[0].replace("−", "-"))))
    texts, only = [text for text, _ in listed], 0
    numbered |= {name: row for row, name in enumerate(model.rods.names)}
    for name, value in pairwise(texts):
        if name in numbered and _NUMBER.fullmatch(value.split()[0]):
            found[numbered[name]].append(abs(float(value.split()[0].replace("−", "-"))))
            only += 1
    return found, only


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
    session.settle()
    session.view.all_diagrams = True
    kept = SOMETIMES if hash_of(name) == 0 or name in ("vierendeel", "two_storey_frame", TOO_MANY) else ()
    for width, height in (*ALWAYS, *kept):
        if name == TOO_MANY and width < 1920:
            continue
        session.resize(width, height, 1.0)
        session.view.fit(session.model)
        session.update_view()
        model, view = session.stages[0]
        assert isinstance(model, Model)
        for quantity in DIAGRAMS if is_frame(model) else (AXIAL,):
            view.quantity = quantity
            paper = on_paper(view)
            for shown in (view, paper) if width == 1280 else (paper,) if width < 800 else (view,):
                picture = compose(model, shown, LIGHT)
                found, only_listed = told(picture, model)
                assert missing(model, quantity, found) == [], (width, quantity)
                assert shown is view or width < 1280 or model.rods.count > FEW or not only_listed
                assert not any("hidden" in text for text in picture.texts), (width, quantity)
                assert shown is view or not any("zoom in" in text for text in picture.texts)


def hash_of(name: str) -> int:
    """0 for a third of the models."""
    return sum(name.encode()) % 3
