"""Numbers as people read them."""

import csv
import io
import math

import pytest
from hypothesis import assume, example
from hypothesis import given as generated
from hypothesis import strategies as st

from pinjoint.components import written
from pinjoint.components.language import english, spoken


@generated(st.lists(st.one_of(st.text(st.characters(exclude_categories=["Cs"])), st.floats(), st.integers())))
@example(["=1+1", "+x", "-x", "@x", "\tx", "\rx", "'=x", "''-", "'x", "x=1", "−1", -1.5, "-1.5", True, None])
def test_texts_in_csv_are_no_formulas_and_numbers_are_numbers(row: list[object]) -> None:
    assume(row)
    (cells,) = csv.reader(io.StringIO(written.as_csv([row]), newline=""))
    for value, cell in zip(row, cells, strict=True):
        if isinstance(value, str):
            assert not cell.startswith(("=", "+", "-", "@", "\t", "\r"))
            assert value == (cell[1:] if cell != value else cell)
            assert cell in (value, f"'{value}")
        elif isinstance(value, float):
            assert float(cell) == value or math.isnan(value)
        else:
            assert cell == ("" if value is None else str(int(value)))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (-28.21949, "−28.22"),
        (139.98521, "140.0"),
        (5.0, "5.000"),
        (0.00012346, "0.0001235"),
        (164640.0, "164640"),
        (9999.96, "10000"),
        (1.2346e-7, "1.235·10⁻⁷"),
        (-2.5e9, "−2.500·10⁹"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
        (math.nan, "—"),
    ],
)
def test_results(value: float, text: str) -> None:
    assert written.number(value) == text


def test_what_is_rounding_only_is_nothing() -> None:
    assert written.force(3.1e-14, nothing=1e-9) == "0 kN"
    assert written.displacement(-2e-16, nothing=1e-12) == "0 cm"
    assert written.strain(1.2e-4) == "0.1200 ‰"
    assert written.displacement(-0.0012346) == "−0.1235 cm"


def test_what_a_person_set_is_as_short_as_it_is() -> None:
    assert [written.length(x) for x in (0.5, 2.0, 0.1 + 0.2, 1e-9)] == ["50 cm", "200 cm", "30 cm", "1·10⁻⁷ cm"]
    assert written.vector((120.0, -160.5)) == "(120, −160.5)"
    assert written.place((0.0, 1e3)) == "(0, 100000) cm"
    assert written.given(100.0) == "100"
    assert [written.given(21099238.4, digits) for digits in (7, 8)] == ["2.109924·10⁷", "2.1099238·10⁷"]
    assert written.share(0.875) == "87.5 %"


@generated(st.floats(-1e300, 1e300), st.integers(1, 8))
def test_a_number_that_is_read_back_is_near(value: float, digits: int) -> None:
    text = written.number(value, digits).replace("−", "-")
    head, _, power = text.partition("·10")
    exponent = int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)
    read = float(f"{head}e{exponent}")
    assert math.isclose(read, value, rel_tol=0.51 * 10.0 ** (1 - digits)) or abs(value) < 1e-300


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 s"),
        (1.234e-3, "1.234 ms"),
        (0.5, "0.5000 s"),
        (12.3456, "12.35 s"),
        (3.5e-8, "35.00 ns"),
        (1e-300, "1.000·10⁻³⁰⁰ s"),
        (12345.6, "12346 s"),
        (0.0009999999, "1.000 ms"),
    ],
)
def test_times(seconds: float, text: str) -> None:
    assert written.time(seconds) == text


def test_the_pace_and_rulers() -> None:
    assert written.pace(0.0) == ""
    assert written.pace(1.0) == "real time"
    assert written.pace(20.0) == "1 s shown = 20 s simulated"
    assert [written.length(x) for x in (0.005, 1000.0, 1e5)] == ["0.5 cm", "100000 cm", "1·10⁷ cm"]


@pytest.mark.parametrize(
    ("terms", "text"),
    [
        ([20.1, -140.1, 120.0], "20.1 − 140.1 + 120.0 = 0"),
        ([10.3441, -10.3481, 0.004], "10.344 − 10.348 + 0.004 = 0"),  # not 10.34 − 10.35 = 0
        ([2.0, 1e-9], "2.000 = 2.000"),
        ([100.0 / 3.0, 100.0 / 3.0, -200.0 / 3.0], "33.33 + 33.33 − 66.67 ≈ 0"),  # whatever its digits
        ([0.0, 0.0], "0"),
    ],
)
def test_a_sum_adds_up_as_it_is_written(terms: list[float], text: str) -> None:
    assert written.total(terms) == text


def test_numbers_are_written_with_the_signs_of_the_language_and_known_in_english():
    def all_kinds() -> list[str]:
        return [
            *(written.number(-28.2843), written.number(1.2345e-7), written.given(0.5), written.given(120.0)),
            *(written.force(-70.71), written.moment(0.5), written.displacement(0.012), written.strain(0.0012)),
            *(written.total([20.123, -140.123, 120.0]), written.time(0.001234), written.share(0.869)),
        ]

    in_english = all_kinds()
    with spoken("pt"):
        said = all_kinds()
        assert said == [text.replace(".", ",") for text in in_english]
        assert [english(text) for text in said] == in_english
        assert written.place((1.205, -1.6)) == "(120,5; −160) cm"
        assert written.vector((120.0, -160.0)) == "(120; −160)"
        assert english(written.place((1.205, -1.6))) == "(120.5, −160) cm"
        assert english(written.pace(0.00035)) == "slow motion: 1 s shown = 0.35 ms"
