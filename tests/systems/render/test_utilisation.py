"""How much of its strength each rod bears, in colours."""

import numpy as np
import pytest

from pinjoint.components.model import Model
from pinjoint.components.rod import utilisation
from pinjoint.components.tags import Selected
from pinjoint.session import Session
from pinjoint.systems.render.marks import Panel, Strokes
from pinjoint.systems.render.model.utilisation import LEVELS, first_at_limit, shade
from pinjoint.systems.render.theme import load_theme, theme_names
from tests.reference import models as reference
from tests.systems.render.pictures import LIGHT, fill, marks_of, picture_of, triangle
from tests.systems.render.test_themes import VISIONS, lab


def limited() -> Model:
    """The triangle with strengths of 200 kN in both directions for AB and BC; CA has none."""
    model = triangle()
    for name in ("AB", "BC"):
        model.rods[name].tensile_strength = model.rods[name].compressive_strength = 200.0
    fill(model, "rods.yielding", [False, False, False])
    return model


def test_it_is_the_force_over_the_strength_in_its_direction() -> None:
    model = limited()
    model.rods["AB"].compressive_strength = 50.0
    model.rods["BC"].compressive_strength = None
    found = utilisation(model)
    np.testing.assert_allclose(found[:2], [28.34277 / 50.0, 0.0])
    assert np.isnan(found[2])


def test_of_a_member_that_bends_it_is_the_sum_of_both_stresses() -> None:
    """A column of IPE 200 (A = 28.5 cm², I = 1943 cm⁴, h = 20 cm) under a force above and one from the side."""
    source = reference.model(
        [
            {"name": "A", "position": [0.0, 0.0], "fixed": [True, True], "fixed_rotation": True},
            {"name": "B", "position": [0.0, 3.0], "force": [10.0, -100.0]},
        ],
        [{"name": "AB", "between": ["A", "B"], "section": "IPE 200"}],
    )
    session = Session.open(source)
    session.settle()
    moment, force = abs(session.rods["AB"].bending_moment[0]), 100.0
    assert moment == pytest.approx(30.0, rel=0.1)  # and what the sway adds
    stress = force / 28.5e-4 + moment / (1943e-8 / 0.1)
    assert utilisation(session.model)[0] == pytest.approx(stress / 235e3, rel=2e-3)
    session.press("a")
    texts = picture_of(session.model, utilisation=True).texts
    assert "utilisation 0 to 100 %" in texts
    session.rods["AB"].second_moment = 2e-5
    session.settle()
    assert utilisation(session.model)[0] == pytest.approx(force / (28.5e-4 * 235e3), rel=2e-3)
    texts = picture_of(session.model, utilisation=True).texts
    assert "utilisation 0 to 100 %, of N alone where the depth is unknown" in texts
    assert any(text.endswith("closest to yielding by axial force") for text in texts)


def test_rods_take_its_colours_only_where_they_are_asked_for() -> None:
    model = limited()
    assert not marks_of(picture_of(model), Strokes, shade(LIGHT, 1.0))
    picture = picture_of(model, utilisation=True)
    for name, level in (("AB", 1), ("BC", 9)):
        [line] = marks_of(picture, Strokes, shade(LIGHT, level / (LEVELS - 1)))
        assert line.of is not None
        assert line.of[1].tolist() == [model.rods[name].row]
    [free] = [m for m in marks_of(picture, Strokes, LIGHT.ghost) if m.of is not None]
    assert free.of[1].tolist() == [2]
    assert {"14.2 %", "BC 99.0 %: closest to yielding", "utilisation 0 to 100 %"} <= set(picture.texts)
    assert len(marks_of(picture, Panel, shade(LIGHT, 1.0))) == 1
    model.tag_only([model.rods["BC"]], Selected)
    assert marks_of(picture_of(model, utilisation=True), Strokes, shade(LIGHT, 1.0)), (
        "a selection hides nothing"
    )


def test_the_first_at_its_strength_is_marked() -> None:
    model = limited()
    model.writable("rods.yielded_at")[:2] = (0.25, 0.5)
    fill(model, "rods.yielding", [False, True, False])
    assert first_at_limit(model, utilisation(model)) == 0
    picture = picture_of(model, utilisation=True)
    [halo] = [m for m in marks_of(picture, Strokes, LIGHT.yielding) if m.colour[3] < 255 and m.of is not None]
    assert halo.of[1].tolist() == [0]
    assert "AB 14.2 %: yielded first, at 0.2500 s" in picture.texts
    assert {"first to yield", "yielding"} <= set(picture.texts)


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("name", theme_names())
def test_the_scale_can_be_read_by_its_lightness_alone(name: str, vision: str) -> None:
    theme = load_theme(name)
    lightness = [lab(shade(theme, step / (LEVELS - 1)), VISIONS[vision])[0] for step in range(LEVELS)]
    steps = np.diff(lightness)
    assert (np.abs(steps) > 3.0).all()
    assert (steps > 0.0).all() or (steps < 0.0).all()
    away = [abs(value - lab(theme.background, VISIONS[vision])[0]) for value in lightness]
    assert away[0] == min(away), "what bears most stands out most"
    assert away[0] > 15.0


def test_a_key_shows_it_where_rods_have_strengths() -> None:
    session = Session.open("hyperstatic_yield")
    session.press("a")
    assert session.view.utilisation
    session.press("a")
    assert not session.view.utilisation
    without = Session.open("von_mises")
    without.press("a")
    assert not without.view.utilisation
    assert without.notice.startswith("No rod has a strength")
