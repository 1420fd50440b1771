"""Written: numbers as people read them on screen, with few digits and one unit for each kind of thing.

Lengths, displacements among them, are in cm, forces in kN, unless a person wants other units (see units.py); strains are
in ‰, shares in %. Minus signs are real ones, what is nothing but rounding is 0, and the decimal sign is that of the
language.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from typing import Any

from pinjoint.components.field import CM, MOVED, SCREEN, on_screen
from pinjoint.components.language import decimals, english, joined, marked, several, tr

DIGITS = 4  # significant ones of a result
_GIVEN_DIGITS = 6  # of a number that a person set, without zeros at its end
MORE_DIGITS = 2  # that a sum may take so that it adds up as written
ROUNDING = 1e-9  # of the largest of its kind: a result below is written as 0

_LENGTH, _PER_METRE = CM
_PLAIN = range(-4, 7)  # powers of ten within which numbers are written out
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def as_csv(rows: Iterable[Iterable[Any]], *, local: bool = False, between: str = "") -> str:
    """Rows as CSV: numbers in full, True and False as 1 and 0, None as nothing, texts so that they stay texts.

    local: as spreadsheets of the present language read it, numbers with its decimal sign, and semicolons between them where
    that is a comma. between: what stands there instead.

    A spreadsheet takes a text that begins with =, +, -, @, a tabulator or a carriage return for a formula: such a text, or
    one with apostrophes before that, gets an apostrophe in front, which a reader takes away again.
    """

    def cell(value: Any) -> Any:
        if isinstance(value, str) and value.lstrip("'").startswith(("=", "+", "-", "@", "\t", "\r")):
            return f"'{value}"
        if local and isinstance(value, float):
            return decimals(repr(value))
        return int(value) if isinstance(value, bool) else value

    text = io.StringIO()
    between = between or (";" if local and decimals(".") == "," else ",")
    usual = csv.writer(text, delimiter=between, lineterminator="\n")  # leaves carriage returns bare
    quoted = csv.writer(text, delimiter=between, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    for row in rows:
        cells = list(map(cell, row))
        (quoted if any(isinstance(cell, str) and "\r" in cell for cell in cells) else usual).writerow(cells)
    return text.getvalue()


def number(value: float, digits: int = DIGITS, *, nothing: float = 0.0) -> str:
    """A result to so many significant digits: "−28.22", "1.235·10⁻⁷", and "0" if it is at most `nothing`."""
    return decimals(_number(value, digits, nothing))


def _number(value: float, digits: int, nothing: float = 0.0) -> str:
    if not math.isfinite(value):
        return "—" if math.isnan(value) else f"{'−' * (value < 0)}∞"
    if abs(value) <= nothing or value == 0.0:
        return "0"
    digits = wanted(digits)
    if digits <= _PLAIN.stop and "e" not in (plain := f"{value:#.{digits}g}"):  # in half the time
        return plain.rstrip(".").replace("-", "−")
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    power = int(exponent)
    if power in _PLAIN:
        return f"{value:.{max(digits - 1 - power, 0)}f}".replace("-", "−")
    return f"{mantissa}·10{str(power).translate(RAISED)}".replace("-", "−")


def wanted(digits: int) -> int:
    """So many significant digits; as many as a person wants where they are those of a result."""
    return round(SCREEN.get("digits", ("", DIGITS))[1]) if digits == DIGITS else digits


def given(value: float, digits: int = _GIVEN_DIGITS) -> str:
    """A number that a person set, or a round one, as short as it is: "0.5"."""
    head, dot, power = _number(value, digits).partition("·")
    return decimals((head.rstrip("0").rstrip(".") if "." in head else head) + dot + power)


def _with_unit(number: str, unit: str) -> str:
    return f"{number} {unit}" if type(number) is str else joined((number, unit))  # the latter keeps the English


def amount(value: float, usual: str, *, nothing: float = 0.0, bare: bool = False) -> str:
    """A number in a usual unit that was computed, in the unit that is on screen in its place, which bare ones leave out."""
    unit, factor = on_screen(usual)
    text = number(factor * value, nothing=factor * nothing)
    return text if bare else _with_unit(text, unit)


def stated(value: float | Iterable[float], usual: str, digits: int = _GIVEN_DIGITS) -> str:
    """A number or a vector in a usual unit that a person set, with the unit that is on screen in its place."""
    unit, factor = on_screen(usual)
    if isinstance(value, Iterable):
        return _with_unit(vector((factor * part for part in value), digits), unit)
    return _with_unit(given(factor * value, digits), unit)


def force(kilonewtons: float, *, nothing: float = 0.0) -> str:
    """A force that was computed."""
    return amount(kilonewtons, "kN", nothing=nothing)


def moment(kilonewton_metres: float, *, nothing: float = 0.0) -> str:
    """A moment that was computed."""
    return amount(kilonewton_metres, "kN·m", nothing=nothing)


def displacement(metres: float, *, nothing: float = 0.0) -> str:
    """A displacement or an elongation."""
    return amount(MOVED[1] * metres, MOVED[0], nothing=MOVED[1] * nothing)


def length(metres: float, digits: int = _GIVEN_DIGITS) -> str:
    """A length that a person set."""
    return stated(_PER_METRE * metres, _LENGTH, digits)


def place(metres: Iterable[float], digits: int = _GIVEN_DIGITS) -> str:
    """A point of the plane."""
    return stated((_PER_METRE * part for part in metres), _LENGTH, digits)


def vector(values: Iterable[float], digits: int = _GIVEN_DIGITS) -> str:
    """The two parts of what a person set: "(120, −160)"."""
    return joined(("(", several(given(value, digits) for value in values), ")"), "")


def total(terms: Iterable[float]) -> str:
    """A sum with its numbers filled in, to the digits of the largest: "20.1 − 140.1 + 120.0 = 0".

    Terms that are 0 to these digits are left out; the sum is of all. Where what is written does not add up by rounding,
    there are MORE_DIGITS at most so that it does, or else the sign is "≈".
    """
    known = list(terms)
    largest = max(map(abs, known), default=0.0)
    if largest == 0.0:
        return "0"
    usual = max(DIGITS - 1 - math.floor(math.log10(largest)), 0)
    found = sum(known)
    found = 0.0 if abs(found) <= ROUNDING * largest else found
    sign = "="
    for places in range(usual, usual + MORE_DIGITS + 1):
        rounded = [round(term, places) for term in known]
        if abs(sum(rounded) - round(found, places)) < 0.5 * 10.0**-places:
            break
    else:
        places, sign = usual, "≈"
    shown = [term for term in known if round(term, places)]
    first, *others = (f"{abs(term):.{places}f}" for term in shown)
    signed = [f"{'−' if term < 0.0 else '+'} {text}" for term, text in zip(shown[1:], others, strict=True)]
    result = f"{round(found, places) + 0.0:.{places}f}".replace("-", "−") if found else "0"
    return decimals(" ".join([f"{'−' * (shown[0] < 0.0)}{first}", *signed, sign, result]))


def strain(value: float) -> str:
    """Elongation per length."""
    return _with_unit(number(1000.0 * value), "‰")


def share(value: float, digits: int = 3) -> str:
    """A part of a whole."""
    return _with_unit(number(100.0 * value, digits), "%")


def time(seconds: float, digits: int = DIGITS) -> str:
    """A time with an SI prefix, such as "1.234 ms"; above 1000 s plain seconds, below 1 ps a power of ten of them."""
    if seconds == 0.0:
        return "0 s"
    if abs(seconds) < 1e-12:
        return f"{number(seconds, digits)} s"
    rounded = float(f"{seconds:.{digits - 1}e}")
    factor, prefix = next((f, p) for f, p in _PREFIXES if abs(rounded) >= 0.1 * f or f == 1e-9)
    places = max(digits - 1 - math.floor(math.log10(abs(rounded) / factor) + 1e-9), 0)
    return decimals(f"{seconds / factor:.{places}f} {prefix}s".replace("-", "−"))


def pace(speed: float) -> str:
    """How fast the simulation is shown, such as "slow motion: 1 s shown = 0.35 ms"; "" when halted."""
    if speed == 0.0:
        return ""
    if abs(speed - 1.0) < 0.005:
        return tr("real time")
    shown, unit = english(time(speed, 3)).split(" ")
    shown = shown.rstrip("0").rstrip(".") if "." in shown else shown
    said = marked("slow motion: 1 s shown = {time}") if speed < 1.0 else marked("1 s shown = {time} simulated")
    return tr(said, time=decimals(f"{shown} {unit}"))
