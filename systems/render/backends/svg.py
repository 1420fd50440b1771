"""SVG: pictures as drawings in which every element is a group with its path as id, and texts are texts.

Others can restyle them and check what they show: all lines, areas and texts of the rod AB stand in the group `rods.AB`,
which has the class `rods`. Ids have no spaces, which are written %20 there; `data-path` is the path as it is.
Coordinates are pixels; the same picture gives the same file. It carries its fonts, so that texts are as wide as they were
measured; programs that read no such fonts take one of the system.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from base64 import b64encode
from collections.abc import Sequence
from importlib.resources import files
from itertools import groupby
from urllib.parse import quote

from pinjoint.components.wording import UNPRINTABLE
from pinjoint.systems.render.backends.shapes import Circle, Line, Name, Polygon, Shape, grouped
from pinjoint.systems.render.marks import Panel, Picture, Text
from pinjoint.systems.render.theme import Colour
from pinjoint.systems.render.typography import WEIGHTS, capital_height

_WEIGHTS = {"regular": "400", "semibold": "600"}
_ANCHORS = {"left": "start", "centre": "middle", "right": "end"}
_NOT_IN_IDS = re.compile(r"[\s%]|" + UNPRINTABLE.pattern)


def as_svg(pictures: Sequence[tuple[Picture, Name]], size: tuple[int, int], title: str) -> bytes:
    """Pictures, each in its viewport of a drawing of that size in pixels, as the contents of an SVG file.

    With each picture comes what gives the paths of its elements. Ids in a second one begin with "2.", and so on.
    """
    width, height = (str(length) for length in size)
    root = ET.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "width": width,
            "height": height,
            "viewBox": f"0 0 {width} {height}",
            "font-family": "Inter, sans-serif",
        },
    )
    ET.SubElement(root, "title").text = UNPRINTABLE.sub("�", title)
    fonts = ET.SubElement(root, "style")
    number = 0
    for picture, path in pictures:
        drawn = root if len(pictures) == 1 else _frame(root, picture)
        v = picture.viewport
        if picture.background is not None:
            ET.SubElement(drawn, "rect", _box(*v.box) | _fill(picture.background))
        groups = grouped(picture)
        number += any(owner is not None for owner, _ in groups)
        for owner, parts in groups:
            into = drawn
            if owner is not None:
                name = _NOT_IN_IDS.sub(lambda found: quote(found[0], errors="replace"), path(owner))
                known = f"{number}.{name}" if number > 1 else name
                told = UNPRINTABLE.sub("�", path(owner))
                into = ET.SubElement(drawn, "g", {"id": known, "class": owner[0], "data-path": told})
            # Lines that one path can hold.
            for alike, run in groupby(
                parts, lambda one: (one.width, one.colour) if isinstance(one, Line) else None
            ):
                if alike is not None:
                    _add_lines(into, list(run))  # type: ignore[arg-type]
                else:
                    for shape in run:
                        _add(into, shape)
    weights = {text.get("font-weight", "") for text in root.iter("text")}
    fonts.text = "".join(
        _font(file, _WEIGHTS[name]) for name, file in WEIGHTS.items() if _WEIGHTS[name] in weights
    )
    ET.indent(root)
    made: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return made + b"\n"


def _font(file: str, weight: str) -> str:
    """A rule that holds a font."""
    code = b64encode((files("pinjoint.assets") / "fonts" / file).read_bytes()).decode()
    source = f"url(data:font/otf;base64,{code})"
    return f"@font-face{{font-family:Inter;font-weight:{weight};src:{source}}}"


def _frame(root: ET.Element, picture: Picture) -> ET.Element:
    """A part of the drawing outside of which nothing of a picture is seen."""
    v = picture.viewport
    view = {"viewBox": f"{v.left} {v.top} {v.width} {v.height}"}
    return ET.SubElement(root, "svg", _box(*v.box) | view)


def _add_lines(into: ET.Element, lines: Sequence[Line]) -> None:
    """Lines of one look as a path: the dashes of a line, the sides of a diagram."""
    points: list[tuple[str, tuple[float, float]]] = []
    for line in lines:
        if not points or points[-1][1] != line.start:
            points.append(("M", line.start))
        points.append(("L", line.end))
    way = " ".join(f"{step}{_number(x)},{_number(y)}" for step, (x, y) in points)
    ET.SubElement(into, "path", {"d": way, "fill": "none"} | _stroke(lines[0].colour, lines[0].width))


def _add(into: ET.Element, shape: Shape) -> None:
    match shape:
        case Polygon():
            points = " ".join(f"{_number(x)},{_number(y)}" for x, y in shape.corners)
            ET.SubElement(into, "polygon", {"points": points} | _fill(shape.colour))
        case Circle():
            (x, y), fill = shape.middle, shape.hollow if shape.rim else shape.ink
            colours = _fill(fill) | (_stroke(shape.ink, shape.rim) if shape.rim else {})
            ET.SubElement(into, "circle", _numbers(cx=x, cy=y, r=shape.radius - shape.rim / 2) | colours)
        case Panel():
            inset = 0.5 if shape.outline is not None else 0.0  # a hairline lies within the box
            box = _box(shape.left + inset, shape.top + inset, shape.width - 2 * inset, shape.height - 2 * inset)
            round_off = _numbers(rx=shape.radius) if shape.radius else {}
            outline = _stroke(shape.outline, 1.0) if shape.outline is not None else {}
            ET.SubElement(into, "rect", box | round_off | _fill(shape.fill) | outline)
        case Text():
            _write(into, shape)


def _write(into: ET.Element, text: Text) -> None:
    place = _numbers(x=text.x, y=text.y + capital_height(text.size) / 2)
    look = {
        "font-size": str(text.size),
        "font-weight": _WEIGHTS[text.weight],
        "text-anchor": _ANCHORS[text.anchor],
    }
    said = UNPRINTABLE.sub("�", text.text)
    spaces = {"xml:space": "preserve"} if "  " in said else {}
    ET.SubElement(into, "text", place | look | _fill(text.colour) | spaces).text = said


def _box(left: float, top: float, width: float, height: float) -> dict[str, str]:
    return _numbers(x=left, y=top, width=max(width, 0.0), height=max(height, 0.0))


def _fill(colour: Colour) -> dict[str, str]:
    return _paint("fill", colour)


def _stroke(colour: Colour, width: float) -> dict[str, str]:
    return _paint("stroke", colour) | {"stroke-width": _number(width)}


def _paint(part: str, colour: Colour) -> dict[str, str]:
    opacity = {f"{part}-opacity": f"{colour[3] / 255:.2g}"} if colour[3] < 255 else {}
    return {part: f"#{bytes(colour[:3]).hex()}", **opacity}


def _numbers(**values: float) -> dict[str, str]:
    return {name: _number(value) for name, value in values.items()}


def _number(value: float) -> str:
    """Hundredths of a pixel."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
