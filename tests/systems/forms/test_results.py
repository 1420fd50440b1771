"""Results: what stands beside the boxes of properties."""

import math
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.bent import farthest
from pinjoint.components.language import spoken
from pinjoint.documents import models
from pinjoint.editor.scenes.properties import Properties
from pinjoint.systems.forms.results import results
from tests.reference.models import triangle
from tests.systems.render.frame_models import EI, frame


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
    assert shown["length"] == "141.3 cm"


def test_the_most_used_of_several_rods_is_named_in_the_present_language() -> None:
    session = at_rest(tensile_strength=215, compressive_strength=215)
    session.rods["BC"].name = "rod 7"
    session.select(*session.rods)
    with spoken("pt"):
        session.press("return")
        assert readings(session)["maior aproveitamento"] == "92,1 % (barra 7)"


def test_a_rod_whose_section_forms_plastic_hinges_says_its_plastic_moment() -> None:
    session = Session.open("portal_collapse")
    session.rods.plastic_moment = None
    session.rods.section, session.rods.material = "IPE 200", "S235"
    for of_sections in (False, True):
        session.model.settings.plastic_hinges = of_sections
        session.select(session.model.rods[0])
        session.press("return")
        assert readings(session).get("plastic moment") == ("51.85 kN·m" if of_sections else None)
        session.press("escape")


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
    assert shown["displacement"].endswith("y 0 cm")
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


FAR = (1.0 + math.sqrt(33.0)) / 16.0  # where 1 − 9ξ² + 8ξ³ = 0


@pytest.mark.parametrize(
    ("supports", "factor", "at"),
    [
        (("AB", ""), 5.0 / 384.0, 0.5),
        (("AB", "A"), (FAR - 3.0 * FAR**3 + 2.0 * FAR**4) / 48.0, 1.0 - FAR),
        (("A", "A"), 1.0 / 8.0, None),
    ],
)
def test_the_largest_displacement_counts_points_inside_members(
    supports: tuple[str, str], factor: float, at: float | None
) -> None:
    """Under q: 5qL⁴/384EI in the middle; (ξ − 3ξ³ + 2ξ⁴) qL⁴/48EI at ξ = FAR from a hinge; qL⁴/8EI at a free end."""
    held, clamped = supports
    ends = {"A": 0.0, "B": 4.0}
    facts = {name: {"fixed": [name in held] * 2, "fixed_rotation": name in clamped} for name in ends}
    source = frame(
        {name: (x, 0.0, facts[name]) for name, x in ends.items()}, {"A B": {"distributed_force": [0, -8]}}
    )
    session = Session.open(source)
    session.press("q")
    for chosen in ([session.rods["AB"]], [*session.rods, *session.particles]):
        said = {one.title: one.text for one in results(session.model, chosen)}["largest displacement"]
        size, _, where = said.partition(" cm ")
        assert float(size) == pytest.approx(100.0 * factor * 8.0 * 4.0**4 / EI, rel=5e-4)
        assert where == ("(B)" if at is None else "(AB)")
    [size], [share] = farthest(session.model, np.array([0]))
    assert size == pytest.approx(factor * 8.0 * 4.0**4 / EI, rel=1e-9)
    assert share == pytest.approx(1.0 if at is None else at, abs=1e-7)
    assert "largest displacement" not in {one.title for one in results(session.model, [session.particles["A"]])}


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


def test_what_is_not_known_is_not_said_and_boxes_stay_where_they_are() -> None:
    session = at_rest(tensile_strength=215)
    session.select(session.rods["AB"], session.particles["A"])
    session.press("return")
    before = [reading.title for reading in session.scenes.active.form.readings]  # type: ignore[attr-defined]
    session.view.forces_known = False
    shown = readings(session)
    assert [*shown] == before, "they are there before anything is drawn"
    assert shown["axial force"] == shown["utilisation"] == "—"


def test_the_environment_has_no_results() -> None:
    session = at_rest()
    assert [*results(session.model, [])] == []


# --- E and A ---------------------------------------------------------------------------------------------


def test_the_stiffness_follows_from_youngs_modulus_and_area_and_the_stress_is_shown() -> None:
    session = at_rest()
    rod = session.rods["BC"]
    session.select(rod)
    session.press("return")
    assert "stress" not in readings(session)
    for title, text in (("stiffness", "a"), ("young's modulus", "210"), ("area", "20")):
        session.click_box(title)
        session.type(text)
        session.press("return")
    assert (rod.youngs_modulus, rod.area) == pytest.approx((210e6, 20e-4))
    assert rod.stiffness == pytest.approx(420_000.0)
    assert session.boxes["stiffness"] == "420000"
    force = rod.axial_force
    assert readings(session)["stress"] == f"{force / 20e-4 / 1000:.4g} MPa".replace("-", "−")
    session.press("escape")
    session.undo()
    assert (rod.youngs_modulus, rod.area, rod.stiffness) == (None, None, 164640.0)


def test_a_stiffness_of_its_own_counts_more_than_e_and_a() -> None:
    session = Session.open(triangle(youngs_modulus=210e6, area=1e-3, stiffness=500.0))
    rod = session.rods["AB"]
    assert rod.stiffness == 500.0
    rod.stiffness = None  # type: ignore[assignment]
    assert rod.stiffness == pytest.approx(210e3)
    rod.area = 2e-3
    assert rod.stiffness == pytest.approx(420e3)
    rod.area = None
    assert rod.stiffness == 164640.0, "of a rod of which nothing is known"


def test_a_file_keeps_e_and_a_and_old_files_keep_their_stiffness(tmp_path: Path) -> None:
    path = tmp_path / "bars.json"
    models.save(models.parse(triangle(youngs_modulus=70e6, area=3e-4)), path)
    again = models.load(path)
    assert (again.rods.youngs_modulus[0], again.rods.area[0]) == (70e6, 3e-4)
    assert again.rods.stiffness[0] == 70e6 * 3e-4
    models.save(models.parse(triangle(stiffness=0.1 + 0.2)), path)
    assert "area" not in path.read_text(encoding="utf-8")
    old = models.load(path)
    assert old.rods.stiffness[0] == 0.1 + 0.2


def test_of_a_member_that_bends_utilisation_and_stress_are_said_to_be_axial() -> None:
    session = at_rest(tensile_strength=215, compressive_strength=215, bending_stiffness=1000, area=20e-4)
    session.select(session.rods["BC"])
    session.press("return")
    shown = readings(session)
    assert {"axial utilisation", "axial stress"} <= {*shown}
    assert not {"utilisation", "stress"} & {*shown}
