"""Units that people type: what they are worth, and what is none."""

from decimal import DecimalException

import pytest

from pinjoint.components.field import FieldError
from pinjoint.components.units import begins, inside


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("2", "kN", 2.0),
        ("300 N", "kN", 0.3),
        ("3daN", "kN", 0.03),
        ("1.5e-3 MN", "kN", 1.5),
        ("12 kNm", "kN·m", 12.0),
        ("12 kN.m", "kN·m", 12.0),
        ("5 N mm", "kN·m", 5e-6),
        ("20 N/mm", "kN/m", 20.0),
        ("355 MPa", "kN/m²", 355_000.0),
        ("355 N/mm²", "kN/m²", 355_000.0),
        ("355 N/mm^2", "kN/m²", 355_000.0),
        ("28.5 cm2", "m²", 28.5e-4),
        ("1943 cm⁴", "m⁴", 1943e-8),
        ("7.85 t/m", "kg/m", 7850.0),
        ("90°", "rad", 1.5707963267948966),
        ("90 deg", "rad", 1.5707963267948966),
        ("36 km/h", "m/s", 10.0),
        ("9.81 m/s2", "m/s²", 9.81),
        ("2 min", "s", 120.0),
        ("12e-6/K", "1/K", 12e-6),
        ("20 °C", "K", 20.0),
        ("50 %", "", 0.5),
    ],
)
def test_a_unit_is_worth_what_its_parts_are(text: str, unit: str, value: float) -> None:
    assert float(inside(text, unit)) == value


def test_a_number_alone_is_in_the_unit_on_screen() -> None:
    assert float(inside("7", "m", "cm")) == 0.07
    assert float(inside("210", "kN/m²", "GPa")) == 2.1e8


@pytest.mark.parametrize(("text", "unit"), [("2 t", "kN"), ("3 m", "rad"), ("5 ft", "m"), ("4 kN", "kN/m")])
def test_units_of_another_kind_are_refused_with_those_that_fit(text: str, unit: str) -> None:
    with pytest.raises(FieldError, match=f"must be in .*{unit}.*, not in {text.split()[1]}"):
        inside(text, unit)


def test_what_is_no_number_is_none() -> None:
    for text in ("", "kN", "1 2 kN", "-", "9,81", "1,5 kN", "1;2", "(1)"):
        with pytest.raises(DecimalException):
            inside(text, "kN")


def test_beginnings_of_units() -> None:
    assert all(begins(text) for text in ("k", "kN", "kN/", "kN/m", "kN·m2", "M", "°", "m s"))
    assert not any(begins(text) for text in ("", "/", "a", "kNx", "u", "y"))
