"""Units that people type, such as "N/mm²", "kNm", "cm4" or "°", in those that the program has inside.

>>> inside("2 N/mm²", "kN/m²")
Decimal('2000')
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from decimal import Decimal
from typing import Any

from pinjoint.components.field import CM, MOVED, SCREEN, FieldError, on_screen
from pinjoint.components.language import joined, marked

_Dimension = tuple[int, ...]  # powers of m, kg, s, K; angles have none

_BASES: dict[str, tuple[str, _Dimension]] = {  # that prefixes may stand before
    "m": ("1", (1, 0, 0, 0)),
    "g": ("1e-3", (0, 1, 0, 0)),
    "s": ("1", (0, 0, 1, 0)),
    "N": ("1", (1, 1, -2, 0)),
    "Pa": ("1", (-1, 1, -2, 0)),
    "J": ("1", (2, 1, -2, 0)),
    "rad": ("1", (0, 0, 0, 0)),
    "t": ("1e3", (0, 1, 0, 0)),
    "K": ("1", (0, 0, 0, 1)),
}
_PREFIXES = {"": "1", "µ": "1e-6", "m": "1e-3", "c": "1e-2", "da": "1e1", "k": "1e3", "M": "1e6", "G": "1e9"}
_OTHERS: dict[str, tuple[str, _Dimension]] = {
    "min": ("60", (0, 0, 1, 0)),
    "h": ("3600", (0, 0, 1, 0)),
    "Hz": ("1", (0, 0, -1, 0)),
    **{sign: (repr(math.pi / 180.0), (0, 0, 0, 0)) for sign in ("°", "º", "deg")},
    "°C": ("1", (0, 0, 0, 1)),
    "%": ("0.01", (0, 0, 0, 0)),
    "‰": ("0.001", (0, 0, 0, 0)),
    "1": ("1", (0, 0, 0, 0)),  # as in 1/K and 10⁻⁶/K
    "10": ("10", (0, 0, 0, 0)),
}
_SYMBOLS: dict[str, tuple[Decimal, _Dimension]] = {
    prefix + name: (Decimal(size) * Decimal(factor), dimension)
    for name, (factor, dimension) in _BASES.items()
    for prefix, size in _PREFIXES.items()
} | {name: (Decimal(factor), dimension) for name, (factor, dimension) in _OTHERS.items()}
_NAMES = "|".join(map(re.escape, sorted(_SYMBOLS, key=len, reverse=True)))  # kNm is of kN and m, not of k…
_MARKS = "·*./ "
_PART = re.compile(rf"([{_MARKS}]?)({_NAMES})(?:\^?(-?\d)|(⁻?[²³⁴⁶]))?")
_RAISED = str.maketrans("²³⁴⁶⁻", "2346-")
_WITH_UNIT = re.compile(r"(.*?[\d.]) ?([^\d\s.,;()eE].*)")
# What people choose on screen, by name; "" are the usual units, of which the others replace those of the same kind.
USUAL = "cm kN"
PRESETS = {
    USUAL: "",
    "m kN mm": "m, mm displacement, kg/m",
    "N mm": "mm, N, N·mm, N/mm, N·mm², N/mm², mm², mm³, mm⁴, kg/m, N·mm/rad, N·s/mm",
}
# Single ones to choose, by quantities; the first of each are the usual ones.
SINGLE = {
    marked("lengths"): ("cm", "m", "mm"),
    marked("displacements"): ("cm displacement", "mm displacement", "m displacement"),
    marked("forces"): ("kN", "N", "MN"),
    marked("moments"): ("kN·m", "N·m", "N·mm"),
    marked("forces per length"): ("kN/m", "N/m", "N/mm"),
    marked("bending stiffness"): ("kN·m²", "N·mm²", "MN·m²"),
    marked("moduli of elasticity"): ("GPa GPa", "MPa GPa", "kN/cm² GPa"),
    marked("stresses"): ("MPa MPa", "N/mm² MPa", "kN/cm² MPa"),
    marked("rotational springs"): ("kN·m/rad", "N·mm/rad", "MN·m/rad"),
    marked("mass per length"): ("kg/cm", "kg/m", "t/m"),
    marked("angles"): ("rad", "°", "mrad"),
    marked("digits"): tuple(f"{number} digits" for number in range(3, 7)),
}
_ON_SCREEN = (
    *(CM[0], MOVED[0], "kN", "kN·m", "kN/m", "kN·m²", "kN·m/rad", "kN·s/m", "kg/cm", "GPa", "MPa"),
    *("cm²", "cm³", "cm⁴", "rad", "mrad"),
)
# Of these, an error names those that fit.
_USUAL = (
    *("m", "cm", "mm", "N", "kN", "MN", "N·m", "kN·m", "N/m", "kN/m", "N/mm"),
    *("kg", "t", "kg/m", "s", "rad", "°"),
    *("MPa", "GPa", "m²", "cm²", "mm²", "m³", "cm³", "m⁴", "cm⁴", "m/s", "km/h", "K", "%"),
)


def number_and_unit(text: str) -> tuple[str, str]:
    """What was typed, such as "1.5 m", as its number and its unit, which may be ""."""
    found = _WITH_UNIT.fullmatch(text)
    return (found[1], found[2].rstrip()) if found else (text, "")


def inside(text: str, unit: str, otherwise: str = "") -> Decimal:
    """The number that a text means, in a unit of the program.

    otherwise: the unit of a number that has none; "": that of the program. Raises DecimalException if it is no number, and
    FieldError if its unit is of another kind.
    """
    digits, typed = number_and_unit(text)
    typed = typed or otherwise or unit
    if typed == unit:
        return Decimal(digits)
    (here, powers, rest), (there, wanted, _) = _read(typed), _read(unit)
    if rest or powers != wanted:
        usual = [name for name in _USUAL if _read(name)[1] == wanted] or [otherwise or unit]
        raise FieldError("must be in {units}, not in {unit}", units=", ".join(usual), unit=typed)
    return Decimal(digits) * (here / there)


def begins(text: str) -> bool:
    """True for the beginnings of units: "k", "kN", "kN/", "kN·m"."""
    rest = _read(text)[2].lstrip(_MARKS)
    return text[:1] not in _MARKS and any(name.startswith(rest) for name in _SYMBOLS)


def _read(unit: str) -> tuple[Decimal, _Dimension, str]:
    """How many of m, kg, s and K to their powers a unit is, these powers, and what is left of its text."""
    factor, rest = Decimal(1), unit
    powers: _Dimension = (0, 0, 0, 0)
    while part := _PART.match(rest):
        mark, name, typed, raised = part.groups()
        power = int(typed or (raised or "1").translate(_RAISED)) * (-1 if mark == "/" else 1)
        size, own = _SYMBOLS[name]
        factor *= size**power
        powers = tuple(one + power * other for one, other in zip(powers, own, strict=True))
        rest = rest[part.end() :]
    return factor, powers, rest


def show_in(text: str) -> None:
    """Say numbers on screen in other units: those of a preset, or some, such as "m, kN, mm displacement, °, 5 digits".

    Raises FieldError if one is none, or is of no kind that is shown; then all stays as it was.
    """
    found = {"units": (text, 0.0)}
    for part in _parts(text):
        found |= _meant(part)
    SCREEN.clear()
    SCREEN.update(found)


def show_single(part: str) -> None:
    """Say numbers of one kind in another unit, or with so many "digits", and the others as before. Raises FieldError."""
    kinds = _meant(part).keys()
    others = [one for one in _parts(units_on_screen()) if not _meant(one).keys() <= kinds]
    show_in(", ".join([*others, part]))


def is_shown(part: str) -> bool:
    """True if numbers of a kind are said in such a unit, or with so many "digits", now."""
    kind, meant = next(iter(_meant(part).items()))
    return SCREEN.get(kind, ("", 4.0) if kind == "digits" else on_screen(kind)) == meant


def can_show(text: Any) -> bool:
    """True if `show_in` takes a text."""
    try:
        return isinstance(text, str) and all(map(_meant, _parts(text)))
    except FieldError:
        return False


def _parts(text: str) -> list[str]:
    return [part for part in map(str.strip, PRESETS.get(text, text).split(",")) if part]


def _meant(part: str) -> dict[str, tuple[str, float]]:
    """By kinds of numbers the unit that a part means, and how many of it are one of the usual; or "digits"."""
    unit, _, what = part.partition(" ")
    if what == "digits" and unit in tuple("345678"):
        return {what: ("", float(unit))}
    size, powers, rest = _read(unit)
    usual = {kind: _read(CM[0] if kind == MOVED[0] else kind) for kind in _ON_SCREEN if what in ("", kind)}
    chosen = {
        kind: (unit, float(own / size))
        for kind, (own, its, _) in usual.items()
        if its == powers and ("/rad" in kind) == ("/rad" in unit)
    }
    if rest or not chosen:
        raise FieldError(
            "“{part}” is no unit on screen; write units such as {units}, or 3 to 8 digits.",
            part=part,
            units=joined(_ON_SCREEN, ", "),
        )
    return chosen


def units_on_screen() -> str:
    """What was chosen last: the name of a preset, or units."""
    return SCREEN.get("units", (USUAL, 0.0))[0]


@contextmanager
def shown_in(text: str) -> Iterator[None]:
    """Say numbers in such units for a while. Raises FieldError."""
    before = units_on_screen()
    show_in(text)
    try:
        yield
    finally:
        show_in(before)
