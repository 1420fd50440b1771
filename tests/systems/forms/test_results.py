"""Results: what stands beside the boxes of properties."""

from __future__ import annotations

import pytest

from game import Session
from game.editor.scenes.properties import Properties
from systems.forms.results import results
from tests.reference.models import triangle


def readings(session: Session) -> dict[str, str]:
    """The results that the picture shows."""
    assert isinstance(session.scenes.active, Properties)
    assert session.stages
    return {reading.title: reading.text for reading in session.scenes.active.form.readings}


def at_rest(**columns: object) -> Session:
    session = Session.open(triangle(**columns))
    assert session.settle() == "equilibrium"
    return session


def test_a_rod_says_its_force_utilisation_strain_and_length() -> None:
    session = at_rest(tensile_strength=215, compressive_strength=215)
    session.select(session.rods["BC"])
    session.press("return")
    shown = readings(session)
    assert shown["axial force"] == "−198.0 kN"
    assert shown["utilisation"] == "92.1 %"
    assert shown["strain"] == "−1.203 ‰"
    assert shown["length"] == "1.413 m"


def test_a_rod_without_strength_has_no_utilisation() -> None:
    session = at_rest()
    session.select(session.rods["BC"])
    session.press("return")
    assert "utilisation" not in readings(session)


def test_a_particle_says_its_displacement_and_its_reactions_only_where_it_is_held() -> None:
    session = at_rest()
    session.select(session.particles["A"])
    session.press("return")
    shown = readings(session)
    assert shown["reaction"] == "y 20.01 kN"
    assert shown["displacement"].endswith("y 0 mm")
    session.press("escape")
    session.select(session.particles["B"])
    session.press("return")
    assert "reaction" not in readings(session)
    assert readings(session)["displacement"].startswith("x ")


def test_several_elements_show_the_extremes_and_whose_they_are() -> None:
    session = at_rest(tensile_strength=215, compressive_strength=215)
    session.press("ctrl+a")
    session.press("return")
    shown = readings(session)
    assert shown["largest tension"] == "20.07 kN (CA)"
    assert shown["largest compression"] == "−198.0 kN (BC)"
    assert shown["largest utilisation"] == "92.1 % (BC)"
    assert shown["largest displacement"].endswith("(B)")
    assert shown["sum of reactions"] == "x −120.0   y 160.0 kN"


def test_results_follow_an_accepted_value_at_once() -> None:
    session = at_rest()
    session.select(session.rods["AB"])
    session.press("return")
    before = float(readings(session)["axial force"].removesuffix(" kN").replace("−", "-"))
    session.click_box("stiffness")
    session.type(str(2 * 164640))
    session.press("return")
    after = float(readings(session)["axial force"].removesuffix(" kN").replace("−", "-"))
    assert after == pytest.approx(2 * before, rel=1e-3), "twice as stiff at the same strain"


def test_what_is_not_known_is_not_shown() -> None:
    session = at_rest()
    session.select(session.rods["AB"])
    session.press("return")
    session.view.forces_known = False
    assert readings(session) == {}


def test_the_environment_has_no_results() -> None:
    session = at_rest()
    assert [*results(session.model, [])] == []
