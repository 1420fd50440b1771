"""Sections and materials: catalogue values from dimensions, what they give to rods, and what is refused."""

import itertools
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.section import MATERIALS, SECTIONS, Section
from pinjoint.documents.document import document, parse
from pinjoint.documents.format import ModelError
from pinjoint.paths import PathError, apply_override
from tests.reference.models import model, particle, rod

# A (cm²), I (cm⁴) and W_pl (cm³) as ArcelorMittal's and Tata's catalogues print them.
CATALOGUE = {
    "IPE 80": (7.64, 80.1, 23.2),
    "IPE 200": (28.5, 1943, 220.6),
    "IPE 300": (53.8, 8356, 628.4),
    "IPE 450": (98.8, 33740, 1702),
    "IPE 600": (156.0, 92080, 3512),
    "HEA 100": (21.2, 349.2, 83.0),
    "HEA 200": (53.8, 3692, 429.5),
    "HEA 300": (112.5, 18260, 1383),
    "HEA 700": (260.5, 215300, 7032),
    "HEA 1000": (346.8, 553800, 12820),
    "HEB 100": (26.0, 449.5, 104.2),
    "HEB 200": (78.1, 5696, 642.5),
    "HEB 400": (197.8, 57680, 3232),
    "HEB 1000": (400.0, 644700, 14860),
    "CHS 60.3×4": (7.07, 28.2, 12.7),
    "CHS 219.1×8": (53.1, 2960, 357),
    "SHS 60×5": (10.7, 53.3, 21.9),
    "SHS 200×10": (74.9, 4471, 531),
}


@pytest.mark.parametrize("name", CATALOGUE)
def test_properties_are_those_of_catalogues(name: str) -> None:
    found = Section.named(name)
    assert found is not None
    shown = found.area * 1e4, found.second_moment * 1e8, found.plastic_modulus * 1e6
    assert shown == pytest.approx(CATALOGUE[name], rel=3e-3), "which print three digits"


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("ipe200", "IPE 200"),
        ("  Hea  300 ", "HEA 300"),
        ("chs 60.3x4", "CHS 60.3×4"),
        ("SHS 100x100x5", "SHS 100×5"),
        ("rectangle 300x500", "rectangle 300×500"),
        ("rect 30*50", "rectangle 30×50"),
    ],
)
def test_names_are_found_however_they_are_typed(typed: str, name: str) -> None:
    found = Section.named(typed)
    assert found is not None
    assert found.name == name


def beam(**properties: Any) -> Session:
    return Session.open(model([particle("A", 0, 0), particle("B", 4, 0)], [rod("A", "B", **properties)]))


def test_a_file_may_say_no_more_than_the_names() -> None:
    made = beam(section="ipe200", material="s235").rods["AB"]
    assert (made.section, made.material) == ("IPE 200", "S235")
    assert made.stiffness == pytest.approx(210e6 * 28.4841e-4)
    assert made.bending_stiffness == pytest.approx(210e6 * 1943.17e-8)
    assert made.density == pytest.approx(22.36, abs=0.01)
    assert made.tensile_strength == pytest.approx(235e3 * 28.4841e-4)
    assert made.hinged == (False, False)


def test_numbers_that_are_stated_stay_and_are_kept_beside_the_names() -> None:
    session = beam(section="IPE 200", stiffness=1e8, density=50.0, hinged=[True, False])
    made = session.rods["AB"]
    assert (made.stiffness, made.density, made.hinged) == (1e8, 50.0, (True, False))
    assert made.material == "S235", "of a profile of which no other is known"
    saved = document(session.model)
    assert saved["rods"][0]["section"] == "IPE 200"
    assert saved["rods"][0]["area"] == 28.4841e-4
    assert document(parse(saved)) == saved


def test_choosing_a_section_is_one_edit_and_leaves_the_joints_as_they_are() -> None:
    session = beam()
    before, made = document(session.model), session.rods["AB"]
    made.section = "HEB 200"
    assert made.bending_stiffness == pytest.approx(210e6 * 5696e-8, rel=1e-3)
    assert made.hinged == (True, True), "a bar that did not bend stays pinned"
    assert made.section == "HEB 200"
    made.material = "timber C24"
    assert made.bending_stiffness == pytest.approx(11e6 * 5696e-8, rel=1e-3)
    assert made.tensile_strength == pytest.approx(14.5e3 * 78.1e-4, rel=1e-3)
    session.undo()
    assert made.material == "S235"
    session.undo()
    assert document(session.model) == before
    rigid = beam(bending_stiffness=100.0, stiffness=5e5)
    rigid.rods["AB"].section = "IPE 300"
    assert rigid.rods["AB"].hinged == (False, False)
    assert rigid.rods["AB"].stiffness == pytest.approx(210e6 * 53.8e-4, rel=1e-3), "no more that stated before"


def test_a_material_alone_gives_what_follows_from_the_area() -> None:
    made = beam(area=10e-4, stiffness=7.0).rods["AB"]
    made.material = "S355"
    assert (made.stiffness, made.tensile_strength) == pytest.approx((210e3, 355.0))
    assert made.density == pytest.approx(7.85)
    without = beam().rods["AB"]
    without.material = "aluminium"
    assert (without.youngs_modulus, without.stiffness, without.density) == (70e6, 164640.0, 6.15)


def test_a_number_of_ones_own_takes_the_name_away() -> None:
    made = beam(section="IPE 200").rods["AB"]
    made.area = 30e-4
    assert (made.section, made.material) == (None, "S235")
    made.youngs_modulus = 200e6
    assert made.material is None


def test_scripts_create_members_by_section() -> None:
    session = beam()
    far = session.model.create(Particle, 2, position=[(8.0, 0.0), (12.0, 0.0)])
    rows = [session.particles["B"].row, *(each.row for each in far)]
    made = session.model.create(
        Rod, 2, between=list(itertools.pairwise(rows)), section=["HEA 200", None], material=[None, "S355"]
    )
    assert made[0].material == "S235"
    assert made[0].bending_stiffness > 7000.0
    assert (made[1].youngs_modulus, made[1].bending_stiffness, made[1].density) == (210e6, 0.0, 6.15)


def test_overrides_choose_sections_and_take_them_away() -> None:
    session = beam()
    apply_override(session.model, "rods.*.section=ipe 300")
    assert session.rods["AB"].section == "IPE 300"
    assert session.rods["AB"].bending_stiffness > 1e4
    apply_override(session.model, "rods.AB.section=none")
    assert session.rods["AB"].section is None
    with pytest.raises(
        PathError, match=r"there is no section 'IPE 205'; IPE sections have these sizes: 80, 100, .*600\."
    ):
        apply_override(session.model, "rods.AB.section=IPE 205")


@pytest.mark.parametrize(
    ("properties", "told"),
    [
        (
            {"section": "IPE 205"},
            r"\$.rods\[0\].section \(rod AB\): there is no section 'IPE 205'; IPE sections have these sizes: 80",
        ),
        ({"section": 200}, r"section is 200; it must be a text\."),
        ({"section": "rectangle 0×500"}, "no section 'rectangle 0×500'; write it like IPE 200"),
        ({"material": "steal"}, r"There is no 'steal' among the materials; choose one of S235"),
        ({"material": ["S235"]}, "it must be a text"),
        (
            {"section": "IPE 200", "area": 1e-2},
            r"area is 100 cm², but IPE 200 has another value; leave out one",
        ),
    ],
)
def test_what_is_wrong_is_named_with_the_remedy(properties: dict[str, Any], told: str) -> None:
    with pytest.raises(ModelError, match=told):
        beam(**properties)


def test_all_sections_and_materials_are_sound() -> None:
    for name in SECTIONS:
        made = beam(section=name).rods["AB"]
        assert made.section == name
        assert 0.0 < made.bending_stiffness < made.stiffness
    for name in MATERIALS:
        made = beam(section="IPE 200", material=name).rods["AB"]
        assert made.material == name
        assert np.isfinite([made.stiffness, made.tensile_strength or 0.0, made.density]).all()
