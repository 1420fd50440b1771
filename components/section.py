"""Sections and materials: standard profiles from their dimensions, rectangles, and what rods of them are given.

Read from assets/sections.json, which names its sources. Sections are bent about their strong axis.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from pinjoint.components.field import LARGEST, FieldError
from pinjoint.components.language import joined, marked
from pinjoint.components.wording import cut, missing

USUAL_SECTION, USUAL_MATERIAL = "IPE 200", "S235"  # of members of which nothing else is known
_RECTANGLE = re.compile(r"rect(?:angle)? (\d+(?:\.\d+)?)×(\d+(?:\.\d+)?)")
_SQUARE = re.compile(r"(shs [\d.]+)×([\d.]+)×([\d.]+)")  # with both widths, as catalogues write it
_MPA, _GPA = 1e3, 1e6  # kN/m²
Numbers = tuple[float, float, float]


@dataclass(frozen=True)
class Section:
    """A cross-section, with area (m²), second moment of area (m⁴), plastic section modulus (m³) and depth (m)."""

    name: str
    area: float
    second_moment: float
    plastic_modulus: float
    depth: float

    @classmethod
    def named(cls, name: str) -> Section | None:
        """The section of a name, whatever its capitals and spaces: "ipe200", "SHS 100x5", "rectangle 300x500"."""
        wanted = _folded(name)
        if found := _RECTANGLE.fullmatch(wanted):
            b, h = map(float, found.groups())
            sound = 0.0 < b < LARGEST and 0.0 < h < LARGEST
            return _section(f"rectangle {b:.12g}×{h:.12g}", rectangle(b, h), h) if sound else None
        if (square := _SQUARE.fullmatch(wanted)) and square[1] == f"shs {square[2]}":
            wanted = f"{square[1]}×{square[3]}"
        return next((each for known, each in SECTIONS.items() if _folded(known) == wanted), None)


@dataclass(frozen=True)
class Material:
    """A material: E and strengths in kN/m², density in kg/m³, thermal expansion in 1/K."""

    name: str
    youngs_modulus: float
    density: float
    tension: float
    compression: float
    expansion: float

    @classmethod
    def named(cls, name: str) -> Material | None:
        """The material of a name, whatever its capitals and spaces."""
        wanted = _folded(name)
        return next((each for known, each in MATERIALS.items() if _folded(known) == wanted), None)


# --- properties from dimensions --------------------------------------------------------------------------


def rolled(h: float, b: float, t_w: float, t_f: float, r: float) -> Numbers:
    """A, I and W_pl of an I-section with fillets of radius r between web and flanges."""
    clear = h - 2.0 * t_f
    corner = (1.0 - math.pi / 4.0) * r**2  # each of four fillets: a square less a quarter of a disc
    centre = (10.0 - 3.0 * math.pi) / (12.0 - 3.0 * math.pi) * r  # of it, from the flange
    own = (1.0 / 3.0 - math.pi / 16.0 - 1.0 / (9.0 * (4.0 - math.pi))) * r**4  # about its centre
    arm = 0.5 * clear - centre
    area = 2.0 * b * t_f + clear * t_w + 4.0 * corner
    second = (b * h**3 - (b - t_w) * clear**3) / 12.0 + 4.0 * (own + corner * arm**2)
    return area, second, (b * h**2 - (b - t_w) * clear**2) / 4.0 + 4.0 * corner * arm


def tube(d: float, t: float) -> Numbers:
    """A, I and W_pl of a circular hollow section."""
    inner = d - 2.0 * t
    return math.pi / 4.0 * (d**2 - inner**2), math.pi / 64.0 * (d**4 - inner**4), (d**3 - inner**3) / 6.0


def box(b: float, t: float) -> Numbers:
    """A, I and W_pl of a square hollow section, with corners of radius 1.5 t outside and t inside.

    Corners are cut away as the fillets of an I-section without flanges are added.
    """
    c = b - 2.0 * t
    parts = rectangle(b, b), rolled(b, 0.0, 0.0, 0.0, 1.5 * t), rectangle(c, c), rolled(c, 0.0, 0.0, 0.0, t)
    area, second, plastic = (
        (outer - cut) - (inner - left) for outer, cut, inner, left in zip(*parts, strict=True)
    )
    return area, second, plastic


def rectangle(b: float, h: float) -> Numbers:
    """A, I and W_pl of a solid rectangle."""
    return b * h, b * h**3 / 12.0, b * h**2 / 4.0


_SHAPES: dict[str, Callable[..., Numbers]] = {"I": rolled, "tube": tube, "box": box}


# --- by name ---------------------------------------------------------------------------------------------


def _section(name: str, in_mm: Numbers, depth: float) -> Section:
    area, second, plastic = (
        float(f"{value * unit:.6g}") for value, unit in zip(in_mm, (1e-6, 1e-12, 1e-9), strict=True)
    )
    return Section(name, area, second, plastic, 1e-3 * depth)


_HELD = json.loads((Path(__file__).parents[1] / "assets" / "sections.json").read_text(encoding="utf-8"))
SECTIONS = {
    (name := f"{family} {size}"): _section(name, _SHAPES[of["shape"]](*dimensions), dimensions[0])
    for family, of in _HELD["families"].items()
    for size, dimensions in of["sizes"].items()
}
MATERIALS = {
    name: Material(
        name,
        of["youngs_modulus"] * _GPA,
        float(of["density"]),
        of["tension"] * _MPA,
        of["compression"] * _MPA,
        of["expansion"],
    )
    for name, of in _HELD["materials"].items()
}


@cache
def _folded(name: str) -> str:
    tidy = re.sub(r"\s+", "", name).casefold()
    tidy = re.sub(r"(?<=\d)[x*](?=\d)", "×", tidy)
    return re.sub(r"^(ipe|hea|heb|chs|shs|rectangle|rect|timber|concrete)", r"\1 ", tidy)


def check_section(value: str, where: str) -> str:
    """The usual spelling of a section's name, or FieldError."""
    if (found := Section.named(value)) is not None:
        return found.name
    family = value.strip()[:3].upper()
    sizes = [name.removeprefix(f"{family} ") for name in SECTIONS if name.startswith(f"{family} ")]
    if sizes:
        raise FieldError(
            "{where}: there is no section '{value}'; {family} sections have these sizes: {sizes}.",
            where=where,
            value=cut(value),
            family=family,
            sizes=", ".join(sizes),
        )
    raise FieldError(
        "{where}: there is no section '{value}'; write it like IPE 200, HEA 200, HEB 200, CHS 60.3×4,"
        " SHS 100×5 or {rectangle} (mm).",
        where=where,
        value=cut(value),
        rectangle="rectangle 300×500",
    )


def check_material(value: str, where: str) -> str:
    """The usual spelling of a material's name, or FieldError."""
    found = Material.named(value)
    if found is None:
        problem = missing(marked("materials"), value, MATERIALS)
        raise FieldError(joined([f"{where}:", problem]))
    return found.name


# --- what they give to rods ------------------------------------------------------------------------------


NAMES = ("section", "material")  # Fields of rods


def given_by(section: str | None = None, material: str | None = None) -> dict[str, Any]:
    """What rods of a section and a material are given, by Field; a section alone is of the usual material."""
    found: dict[str, Any] = {}
    profile = Section.named(section) if section is not None else None
    if profile is not None:
        found = {"area": profile.area, "second_moment": profile.second_moment}
        material = USUAL_MATERIAL if material is None else material
    substance = Material.named(material) if material is not None else None
    if substance is not None:
        found["material"] = substance.name
        found |= {"youngs_modulus": substance.youngs_modulus, "thermal_expansion": substance.expansion}
        if profile is not None:
            found |= by_area(substance, profile.area)
    return found


def by_area(material: Material, area: float) -> dict[str, float]:
    """What rods of a material with an area (m²) are given, by Field."""
    return {
        "density": _tidy(material.density * area),
        "tensile_strength": _tidy(material.tension * area),
        "compressive_strength": _tidy(material.compression * area),
    }


def _tidy(value: float) -> float:
    return float(f"{value:.9g}")


def plastic_moment(section: str | None, material: str | None) -> float:
    """W_pl f_y of a section of a metal (kN·m), of the usual one if none is named; infinite of all else."""
    profile = Section.named(section) if section is not None else None
    substance = Material.named(USUAL_MATERIAL if material is None else material)
    if profile is None or substance is None or substance.tension != substance.compression:
        return math.inf
    return _tidy(substance.tension * profile.plastic_modulus)
