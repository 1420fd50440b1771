"""PDF: pictures as pages of lines, areas and texts, with their fonts embedded; the same picture gives the same file."""

from __future__ import annotations

import io
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from pinjoint.components.wording import UNPRINTABLE
from pinjoint.systems.render.backends.shapes import Circle, Line, Polygon, Shape, shapes
from pinjoint.systems.render.marks import Panel, Picture, Text
from pinjoint.systems.render.theme import Colour
from pinjoint.systems.render.typography import capital_height

_POINTS = 0.75  # of a page for each pixel, as browsers print
# With quadratic outlines, as libraries embed them; what pygame draws has cubic ones.


def as_pdf(pictures: Sequence[Picture], size: tuple[int, int], title: str) -> bytes:
    """Pictures, each in its viewport of a page of that size in pixels, as the contents of a PDF file."""
    from reportlab.pdfgen.canvas import Canvas

    embed_fonts()
    made = io.BytesIO()
    width, height = size
    page = Canvas(made, pagesize=(_POINTS * width, _POINTS * height), invariant=1, pageCompression=1)
    page.setTitle(UNPRINTABLE.sub("�", title))
    page.setAuthor("")
    page.setCreator("Pinjoint")
    page.scale(_POINTS, _POINTS)
    for picture in pictures:
        draw_picture(page, picture, height)
    page.showPage()
    page.save()
    return made.getvalue()


def draw_picture(page: Any, picture: Picture, height: float) -> None:
    """A picture in its viewport of a page of that height, both in pixels."""
    v = picture.viewport
    page.saveState()
    frame = page.beginPath()
    frame.rect(v.left, height - v.bottom, v.width, v.height)
    page.clipPath(frame, stroke=0, fill=0)
    if picture.background is not None:
        _fill(page, picture.background)
        page.rect(v.left, height - v.bottom, v.width, v.height, stroke=0, fill=1)
    for mark in picture.marks:
        for _, shape in shapes(mark):
            _draw(page, shape, height)
    page.restoreState()


@cache
def embed_fonts() -> None:
    """Make the fonts known, under the names of weights."""
    from reportlab.pdfbase.pdfmetrics import registerFont
    from reportlab.pdfbase.ttfonts import TTFont

    for weight, name in {"regular": "Inter-Regular.ttf", "semibold": "Inter-SemiBold.ttf"}.items():
        registerFont(
            TTFont(f"Inter {weight}", io.BytesIO((files("pinjoint.assets") / "fonts" / name).read_bytes()))
        )


def _draw(page: Any, shape: Shape, height: float) -> None:
    """A shape; in a page y points up."""
    match shape:
        case Line():
            (x, y), (far_x, far_y) = shape.start, shape.end
            _stroke(page, shape.colour, shape.width)
            page.line(x, height - y, far_x, height - far_y)
        case Polygon():
            _fill(page, shape.colour)
            outline = page.beginPath()
            for number, (x, y) in enumerate(shape.corners):
                (outline.lineTo if number else outline.moveTo)(x, height - y)
            outline.close()
            page.drawPath(outline, stroke=0, fill=1)
        case Circle():
            (x, y), radius = shape.middle, shape.radius - shape.rim / 2
            _fill(page, shape.hollow if shape.rim else shape.ink)
            if shape.rim:
                _stroke(page, shape.ink, shape.rim)
            page.circle(x, height - y, radius, stroke=int(shape.rim > 0.0), fill=1)
        case Panel():
            _panel(page, shape, height)
        case Text():
            _write(page, shape, height)


def _panel(page: Any, panel: Panel, height: float) -> None:
    inset = 0.5 if panel.outline is not None else 0.0  # a hairline lies within the box
    _fill(page, panel.fill)
    if panel.outline is not None:
        _stroke(page, panel.outline, 1.0)
    box = panel.left + inset, height - panel.top - panel.height + inset
    size = max(panel.width - 2 * inset, 0.0), max(panel.height - 2 * inset, 0.0)
    stroke = int(panel.outline is not None)
    if panel.radius:
        page.roundRect(*box, *size, panel.radius, stroke=stroke, fill=1)
    else:
        page.rect(*box, *size, stroke=stroke, fill=1)


def _write(page: Any, text: Text, height: float) -> None:
    _fill(page, text.colour)
    page.setFont(f"Inter {text.weight}", text.size)
    draw = {"left": page.drawString, "centre": page.drawCentredString, "right": page.drawRightString}
    baseline = height - text.y - capital_height(text.size) / 2
    draw[text.anchor](text.x, baseline, UNPRINTABLE.sub("�", text.text))


def _fill(page: Any, colour: Colour) -> None:
    red, green, blue, opacity = (part / 255 for part in colour)
    page.setFillColorRGB(red, green, blue, opacity)


def _stroke(page: Any, colour: Colour, width: float) -> None:
    red, green, blue, opacity = (part / 255 for part in colour)
    page.setStrokeColorRGB(red, green, blue, opacity)
    page.setLineWidth(width)
