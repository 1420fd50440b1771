"""Every value stands nearer to its own rod or arrow than to any other, in every bundled model and window."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import FLAT, borne_between
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.written import DIGITS, given, number
from pinjoint.documents import models
from pinjoint.systems.render.labels.placing import LEADER_OPACITY, half_size
from pinjoint.systems.render.marks import Owner, Panel, Picture, Points, Strokes, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import faded, load_theme
from tests.reference.boxes import Box, text_box
from tests.reference.nearness import Part, Parts, distance, near, parts_of
from tests.systems.render.frame_models import FRAMES

SMALLER = 10.0  # points, type that is smaller than usual
LIGHT = load_theme("light")
SIZES = [(640, 480, 1.0), (1280, 800, 1.0), (420, 620, 1.0), (1600, 1200, 2.0)]


def at_the_start(session: Session) -> None:
    session.press("i")


def in_motion(session: Session) -> None:
    session.press("i")
    session.press("space")
    for _ in range(20):
        session.frame(0.05)


def settled(session: Session) -> None:
    session.press("i")
    session.press("e")
    session.settings.displacement_scale *= 3.0


WINDOWS = {at_the_start: (SIZES[0], SIZES[3]), in_motion: (SIZES[1], SIZES[2]), settled: (SIZES[0], SIZES[2])}


def values(picture: Picture, model: Model) -> Iterator[Text]:
    """The texts of elements that are neither their names nor numbers that stand for values."""
    for before, mark in pairwise(picture.marks):
        is_number = isinstance(before, Panel) and before.outline is not None
        if isinstance(mark, Text) and mark.of is not None and not is_number:
            table, row = mark.of
            if mark.text != model.tables[table].names[row]:
                yield mark


def misplaced(picture: Picture, model: Model) -> Iterator[str]:
    """Values to which something else than their own rod or arrow is as near, or that stand on another's diagram.

    In its own diagram a value may be nearer to an arrow than to its rod, but not nearer to another rod. What stands away
    from all that is led to its own by a line.
    """
    parts = Parts(replace(part, owner=_member(part.owner, model)) for part in parts_of(picture, LIGHT))
    for text in values(picture, model):
        whose = table, row = _member(text.of, model)  # type: ignore[arg-type]
        box, own = text_box(text, text.size), [part for part in parts if part.owner == whose]
        line = leader(text, picture)
        if text.text.endswith("kN·m") and table == "particles":
            own = _arc(text, own)
            if not _turns(text, model, row):
                yield f"{text.text} of {model.tables[table].names[row]} stands at another moment"
        elif table != "rods":
            own = _arrow(text_box(text, text.size) if line is None else (*line[1], *line[1]), text, own)
            if not _says(text, own[0], model, row if table == "particles" else int(model.loads.on[row])):
                yield f"{text.text} of {model.tables[table].names[row]} stands at another arrow"
        if line is not None:
            # Curves are drawn flat within so many pixels of where they are.
            yield from _astray(text, whose, line, own, parts, FLAT if bends(model) else 0.1)
            continue
        to_any = min(distance(box, part) for part in own)
        to_line = min((distance(box, part) for part in own if part.kind == "line"), default=to_any)
        for part, away in near(box, parts, to_line):
            kin = part.owner == whose and (table == "rods" or part.kind in ("disc", "support") or part in own)
            if not kin and away <= (to_line if part.kind == "line" else to_any):
                its, other = (model.tables[name].names[index] for name, index in (whose, part.owner))
                yield f"{text.text} of {its}: {to_any:.1f} pixels from it, {away:.1f} from the {part.kind} of {other}"


def _member(owner: Owner, model: Model) -> Owner:
    """Of what acts between the ends of a member the member, whose own distributed force is drawn alike; else the same."""
    table, row = owner
    return ("rods", int(model.span_loads.rod[row])) if table == "span_loads" else owner


def leader(text: Text, picture: Picture) -> Points | None:
    """The ends of the line from a value to what it belongs to, shape (2, 2); None where it stands beside that."""
    for mark in picture.marks:
        if isinstance(mark, Strokes) and mark.colour == faded(text.colour, LEADER_OPACITY) and mark.of:
            wide, tall = half_size(text.text, text.size, text.weight, unit=mark.width)
            for (x, y), end, row in zip(mark.start, mark.end, mark.of[1].tolist(), strict=True):
                off = max(abs(x - text.x) - wide, abs(y - text.y) - tall)
                if abs(off) < 1e-6 and (mark.of[0], row) == text.of:
                    return np.array([[x, y], end])
    return None


def _astray(
    text: Text, whose: Owner, line: Points, own: list[Part], parts: Parts, within: float
) -> Iterator[str]:
    """What is wrong with a value that stands away: on something, or its line leads elsewhere, or across others."""
    end = (*line[1], *line[1])
    if min(distance(end, part) for part in own) > within:
        yield f"the line from {text.text} ends elsewhere"
    for part, _ in near(text_box(text, text.size), parts, 0.0):
        if part.kind == "diagram" and text.size < SMALLER:
            continue  # in smaller type, where there is no other room
        yield f"{text.text} stands on the {part.kind} of {part.owner}"
    for share in np.linspace(0.0, 1.0, 60)[:-1]:
        x, y = line[0] + share * (line[1] - line[0])
        for part, _ in near((x, y, x, y), parts, 0.5):
            if part.kind != "diagram" and part.owner != text.of:
                yield f"the line from {text.text} crosses the {part.kind} of {part.owner}"


def _arrow(box: Box, text: Text, parts: list[Part]) -> list[Part]:
    """Shaft and head of the arrow of the text's colour that is nearest to it."""
    arrows = [
        [shaft, head]
        for shaft in parts
        for head in parts
        if shaft.kind == "shaft" and head.kind == "head" and shaft.colour == head.colour == text.colour
        if np.abs(head.points[1:].mean(axis=0) - shaft.points[1]).max() < 1e-6
    ]
    return min(arrows, key=lambda arrow: min(distance(box, part) for part in arrow))


def _arc(text: Text, parts: list[Part]) -> list[Part]:
    """The curved arrow of the text's colour: what is as far from the middle of the joint at both ends, and its head."""
    (middle,) = next(part.points for part in parts if part.kind == "disc")
    found = []
    for part in parts:
        away = np.hypot(*(part.points - middle).T)
        if part.colour == text.colour and part.kind == "shaft" and abs(away[0] - away[1]) < 1e-6:
            found.append(part)
    ends = {tuple(np.round(part.points[1], 6)) for part in found}
    heads = [part for part in parts if part.kind == "head" and part.colour == text.colour]
    return found + [h for h in heads if tuple(np.round(h.points[1:].mean(axis=0), 6)) in ends]


def _turns(text: Text, model: Model, row: int) -> bool:
    """Whether a text is the size of the moment of its colour on a joint."""
    particles = model.particles
    moment = particles.applied_moment if text.colour == LIGHT.load else particles.reaction_moment
    size = abs(float(moment[row]))
    return text.text.removesuffix(" kN·m") in (given(size, DIGITS), number(size))


def _says(text: Text, shaft: Part, model: Model, row: int) -> bool:
    """Whether a text is the size of the force that an arrow shows."""
    particles = model.particles
    applied = particles.applied_force - borne_between(model)
    force = (applied if text.colour == LIGHT.load else particles.reaction)[row]
    step = np.abs(shaft.points[1] - shaft.points[0])
    size = abs(float(force[int(step[1] > step[0])]))
    return text.text.removesuffix(" kN") == (given(size, DIGITS) if text.colour == LIGHT.load else number(size))


@pytest.mark.parametrize("moment", WINDOWS)
@pytest.mark.parametrize("name", models.bundled())
def test_values_stand_nearest_to_what_they_are_of(name: str, moment: Callable[[Session], None]) -> None:
    session = Session.open(name)
    moment(session)
    for width, height, ratio in WINDOWS[moment]:
        session.resize(width, height, ratio)
        session.view.fit(session.model)
        session.update_view()
        for model, view in session.stages:
            if isinstance(model, Model):
                assert list(misplaced(compose(model, view, LIGHT), model)) == [], (width, height)


@pytest.mark.parametrize("name", FRAMES)
def test_values_of_frames_stand_nearest_to_what_they_are_of(name: str) -> None:
    session = Session.open(FRAMES[name]())
    session.run(time=0.05)
    session.view.all_diagrams = True
    for width, height, ratio in SIZES[1:3]:
        session.resize(width, height, ratio)
        session.view.fit(session.model)
        session.update_view()
        for session.view.quantity in DIAGRAMS:
            (model, view), *_ = session.stages
            assert isinstance(model, Model)
            found = list(misplaced(compose(model, view, LIGHT), model))
            assert found == [], (width, height, session.view.quantity)
