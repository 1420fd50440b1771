"""Numbers of first order as they are read, in the picture, the table and its CSV, against an independent solver."""

import csv
import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from pinjoint import Session
from pinjoint.components.language import spoken
from pinjoint.components.model import Model
from pinjoint.components.settings import DIAGRAMS
from pinjoint.systems.render.marks import Picture, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.statics.theory import Indeterminacy
from tests.golden.test_all_values import FEW, missing, told
from tests.reference import frame_theory
from tests.verification.test_frame_theory import SEEDS, random_frame

LIGHT = load_theme("light")
RODS = {"N": "end_axial_force", "V": "shear", "M": "bending_moment"}
JOINTS = {"displacement": ("displacement", 100.0), "reaction": ("reaction", 1.0)}


def written(text: str) -> tuple[float, float]:
    """A number that is written, and how far it may be from what it stands for."""
    digits, _, power = text.replace("−", "-").partition("·10")
    ten = 10.0 ** int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)
    return float(digits) * ten, 0.5001 * ten * 10.0 ** -len(digits.partition(".")[2])


def read(session: Session, table: str) -> Iterator[tuple[str, str, float, str]]:
    """Of each number of a table its row and column, as the CSV has it in full, and as the window shows it."""
    session.lister.turn_to(table)
    shown, columns = session.lister.table, session.lister.table.columns
    head, *rows = csv.reader(io.StringIO(session.lister.text()))
    for at, (name, *numbers) in enumerate(rows):
        for title, column, number, text in zip(head[1:], columns, numbers, shown[1 + at][1:], strict=True):
            if number:
                said, within = written(text)
                assert abs(said - float(number) / 10.0**column.power) <= within, (name, title)
                yield name, title.partition(" (")[0], float(number), text


def expected(found: frame_theory.Found) -> dict[str, dict[tuple[str, str], float]]:
    """By kind, what rows and columns of the tables are to say, in units on screen."""
    kinds: dict[str, dict[tuple[str, str], float]] = {}
    for letter, name in RODS.items():
        ends = getattr(found, name).items()
        kinds[letter] = {
            (rod, f"{letter} {end}"): pair[k] for rod, pair in ends for k, end in enumerate(("start", "end"))
        }
    for title, (name, factor) in JOINTS.items():
        pairs = getattr(found, name).items()
        kinds[title] = {
            (joint, f"{title} {axis}"): factor * pair[k] for joint, pair in pairs for k, axis in enumerate("xy")
        }
    kinds["rotation"] = {(joint, "rotation"): 1e3 * turn for joint, turn in found.rotation.items()}
    kinds["moment"] = {(joint, "moment"): moment for joint, moment in found.reaction_moment.items()}
    return kinds


def values_of(found: frame_theory.Found, quantity: str, rod: str, length: float) -> list[float]:
    """The sizes that a diagram of a rod may tell: at its ends or, where these are alike, its middle; M where V is 0."""
    every, shear = getattr(found, RODS[quantity]), found.shear[rod]
    at_ends, largest = every[rod], max(np.abs(pair).max() for pair in every.values())
    sizes, turn = [*at_ends], shear[0] / ((shear[0] - shear[1]) or np.inf)
    if quantity == "M" and 0.0 < turn < 1.0:
        sizes.append(at_ends[0] + 0.5 * shear[0] * turn * length)
    if abs(at_ends[0] - at_ends[1]) <= 0.01 * largest:
        sizes.append(at_ends.mean())
    return np.abs(sizes).tolist()


def reactions(picture: Picture, model: Model) -> Iterator[tuple[str, str]]:
    """The joints whose reactions are written, and what is said of them."""
    for mark in picture.marks:
        if isinstance(mark, Text) and mark.of and mark.of[0] == "particles" and mark.colour == LIGHT.reaction:
            name, size = model.particles.names[mark.of[1]], mark.text.split()
            yield from [(name, mark.text)] * (len(size) == 2)  # else a number stands for it


@pytest.mark.timeout(120)
@settings(max_examples=8)
@given(seed=SEEDS)
def test_picture_table_and_csv_say_what_an_independent_solver_finds(seed: int) -> None:
    document: dict[str, Any] = random_frame(seed)
    session = Session.open(document)
    if Indeterminacy.of(session.model).mechanisms:
        return
    session.resize(1280, 800)
    found = frame_theory.solve(document)
    session.press("q")
    session.press("home")
    with spoken("en"):
        said = {
            (name, title): number
            for table in ("rods", "particles")
            for name, title, number, _ in read(session, table)
        }
        for kind, numbers in expected(found).items():
            size = max(1e-3, *map(abs, numbers.values()))
            compared = [abs(said[place] - number) for place, number in numbers.items() if place in said]
            assert max(compared, default=0.0) <= 1e-10 * size, kind
            assert compared or kind in ("moment", "rotation")
        session.view.all_diagrams = True
        for session.view.quantity in DIAGRAMS:
            session.update_view()
            (model, view), *_ = session.stages
            assert isinstance(model, Model)
            picture = compose(model, view, LIGHT)
            by_rod, _ = told(picture, model)
            if model.rods.count <= FEW:  # more values, with a load on every member, may be left to the table
                assert missing(model, view.quantity, by_rod) == []
            for row, sizes in by_rod.items():
                wanted = values_of(
                    found, view.quantity, model.rods.names[row], float(model.rods.original_length[row])
                )
                for size in sizes:
                    assert min(abs(size - value) for value in wanted) <= 5.01e-4 * size
            for joint, text in reactions(picture, model):
                number, within = written(text.split()[0])
                parts = [found.reaction_moment[joint]] if "kN·m" in text else found.reaction[joint]
                assert min(abs(abs(part) - number) for part in parts) <= within
