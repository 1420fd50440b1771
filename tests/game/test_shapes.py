"""Mechanisms and natural modes drawn over the model: titles, places, order, and when they go away."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.camera import Viewport
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.shapes import DRAWN_SHARE, NoShape, mechanism_shapes, mode_shapes, numbered
from pinjoint.systems.render.marks import Discs
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.reference.models import model, particle, pendulum, rod

GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0
STIFFNESS = 1.0  # kN, of rods 1 m long between masses of 1 kg


def chain() -> dict[str, Any]:
    """Two equal masses on equal springs in a row; ω² = (k/m)(3 ∓ √5)/2, motions 1 : φ and φ : −1."""
    particles = [particle(name, x, 0, fixed=[x == 0, True], mass=1) for x, name in enumerate("OAB")]
    return model(particles, [rod(a, b, stiffness=STIFFNESS, density=0) for a, b in pairwise("OAB")])


def session_of(source: Any) -> Session:
    session = Session.open(source)
    session.view.camera.viewport = Viewport(0, 0, 800, 600)
    session.view.fit(session.model)
    return session


def shown(session: Session) -> str:
    session.update_view()
    return session.view.shape.title if session.view.shape is not None else ""


def test_modes_of_a_chain_are_drawn_where_theory_says() -> None:
    session = session_of(chain())
    for number, (squared, motion) in enumerate(
        [(2 - GOLDEN, (1 / GOLDEN, 1.0)), (1 + GOLDEN, (1.0, -1 / GOLDEN))]
    ):
        session.press("b")
        hertz = math.sqrt(1000.0 * STIFFNESS * squared) / (2 * math.pi)
        assert shown(session) == f"Mode {number + 1} of 2: {hertz:.4g} Hz"
        picture = compose(session.model, session.view, load_theme())
        assert shown(session) in picture.texts
        (at,) = [mark.at for mark in picture.marks if isinstance(mark, Discs) and len(mark.at) == 2]
        places = _in_model(session, at)
        moved = (places - [[1.0, 0.0], [2.0, 0.0]]) / (DRAWN_SHARE * 2.0)
        assert moved * np.sign(moved[0, 0]) == pytest.approx(np.array([(x, 0.0) for x in motion]), abs=1e-9)


def _in_model(session: Session, pixels: Any) -> Any:
    return np.array([session.view.camera.to_model(tuple(pixel)) for pixel in pixels])


def test_at_rest_under_load_modes_are_those_about_the_equilibrium() -> None:
    """A pendulum that hangs: it swings with ω² = g/L instead of being a mechanism, and is drawn where it hangs."""
    hanging = pendulum(0.4)
    session = session_of(hanging)
    assert session.settle() == "equilibrium"
    session.press("b")
    session.press("b")
    swing = math.sqrt(9.81 / (1.0 + 9.81e-3 / hanging["rods"][0]["stiffness"])) / (2 * math.pi)
    assert shown(session) == f"Mode 1 of 2 under load: {swing:.4g} Hz"
    shape = session.view.shape
    assert shape is not None
    assert shape.about is not None
    lowest = session.model.particles.position + shape.about
    assert lowest[1] == pytest.approx((0.0, -1.0 - 9.81e-3 / hanging["rods"][0]["stiffness"]), abs=1e-9)
    session.simulation.model.give("particles.velocity", [[0.0, 0.0], [1.0, 0.0]])
    assert shown(session) == ""


def test_mechanisms_come_first_then_modes_then_none() -> None:
    session = session_of("pendulum")
    titles = []
    for _ in range(4):
        session.press("b")
        titles.append(shown(session))
    assert titles == ["Mechanism 1 of 1: moves bob along y", "Mode 1 of 1: 645.8 Hz", "", titles[0]]


def test_a_shape_stays_while_time_passes_and_goes_away_on_an_edit() -> None:
    session = session_of("isostatic")
    session.press("b")
    session.run(steps=10)
    assert shown(session) == "Mode 1 of 3: 347.6 Hz"
    session.rods["AB"].stiffness = 1e5
    assert shown(session) == ""
    session.press("b")
    assert shown(session).startswith("Mode 1 of 3")
    assert "347.6" not in shown(session)


def test_each_model_has_its_own() -> None:
    session = session_of("isostatic")
    session.press("b")
    session.documents.open("pendulum")
    assert shown(session) == ""


def test_what_has_none_says_so() -> None:
    session = session_of("collision_i")
    session.press("b")
    assert (
        session.notice
        == "There are no mechanisms and no modes, because no rod has an end that is free to move."
    )
    assert shown(session) == ""


@pytest.mark.parametrize("name", ["isostatic", "pendulum", "hanging_net", "warren_bridge", "pile"])
def test_mechanisms_vibrate_with_no_frequency_and_modes_with_some(name: str) -> None:
    model: Model = models.load(name)
    frequencies = [float(mode.title.split(": ")[1].removesuffix(" Hz")) for mode in mode_shapes(model)]
    assert all(frequency > 0.0 for frequency in frequencies)
    assert frequencies == sorted(frequencies)
    unknowns = np.unique(model.rods.between)
    free = int((~model.particles.fixed[unknowns]).sum()) if model.rods.count else 0
    assert len(frequencies) + len(mechanism_shapes(model)) == free


def test_of_a_large_structure_some_are_found_and_all_are_counted() -> None:
    """A square net held at the left, its right edge loose: without self-stress, so that every rod holds one motion."""
    side = 18
    name = [[f"P{x}.{y}" for y in range(side)] for x in range(side)]
    particles = [
        {"name": name[x][y], "position": [x, y], "fixed": [x == 0, x == 0]}
        for x in range(side)
        for y in range(side)
    ]
    pairs = [(name[x][y], name[x + 1][y]) for x in range(side - 1) for y in range(side)]
    pairs += [(name[x][y], name[x][y + 1]) for x in range(1, side - 1) for y in range(side - 1)]
    rods = [{"name": f"{a}-{b}", "between": [a, b]} for a, b in pairs]
    document = {"format": "pinjoint model", "version": 1, "particles": particles, "rods": rods}
    model = models.load(document)
    unknowns = 2 * side * (side - 1)
    still = unknowns - len(rods)
    shapes = mechanism_shapes(model)
    assert (still, len(shapes)) == (34, 20)
    assert shapes[0].title.startswith(f"Mechanism 1 of {still}: ")
    modes = mode_shapes(model)
    assert len(modes) == 50
    assert modes[0].title.startswith(f"Mode 1 of {unknowns - still}: ")


@pytest.mark.parametrize(
    ("kind", "number", "said"),
    [
        ("mechanism", 1, "There is no mechanism: every motion stretches a rod."),
        ("mode", 4, "There is no mode 4; choose a number from 1 to 3."),
        ("mode", 0, "There is no mode 0; choose a number from 1 to 3."),
    ],
)
def test_a_number_that_does_not_exist_is_refused(kind: str, number: int, said: str) -> None:
    with pytest.raises(NoShape, match=said):
        numbered(models.load("isostatic"), kind, number)


def test_pictures_of_modes_and_mechanisms(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain, mode, mechanism = (tmp_path / f"{name}.png" for name in ("plain", "mode", "mechanism"))
    size = ["--size", "320x240"]
    assert main(["render", "pendulum", "--output", str(plain), *size]) == 0
    assert main(["render", "pendulum", "--mode", "1", "--output", str(mode), *size]) == 0
    assert main(["render", "pendulum", "--mechanism", "1", "--output", str(mechanism), *size]) == 0
    assert len({path.read_bytes() for path in (plain, mode, mechanism)}) == 3
    assert main(["render", "pendulum", "--mode", "2", "--output", str(plain)]) == 2
    assert "choose a number from 1 to 1" in capsys.readouterr().err
