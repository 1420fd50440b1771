"""Pictures as SVG and PDF: what stands in them, and whose it is."""

import re
import xml.etree.ElementTree as ET
from base64 import b64decode
from functools import partial
from importlib.resources import files

import numpy as np
import pytest

from pinjoint.components.camera import Viewport
from pinjoint.components.model import Model
from pinjoint.components.tags import Selected
from pinjoint.pictures import path_of
from pinjoint.systems.render.backends.pdf import as_pdf
from pinjoint.systems.render.backends.shapes import Circle, Line, grouped
from pinjoint.systems.render.backends.svg import as_svg
from pinjoint.systems.render.marks import Discs, Mark, Panel, Picture, Stamps, Strokes, Text
from pinjoint.systems.render.typography import WEIGHTS
from tests.systems.render.pictures import picture_of, triangle

SVG = "{http://www.w3.org/2000/svg}"
RED, WHITE = (255, 0, 0, 255), (255, 255, 255, 255)
SIZE = 600, 600


def svg_of(picture: Picture, model: Model) -> ET.Element:
    return ET.fromstring(as_svg([(picture, partial(path_of, model))], SIZE, "Triangle"))


def groups_of(root: ET.Element) -> dict[str, ET.Element]:
    found = [(group.get("id"), group) for group in root.iter(f"{SVG}g")]
    assert len(dict(found)) == len(found)  # each once
    return {str(name): group for name, group in found}


def texts_of(element: ET.Element) -> list[str]:
    return [text.text or "" for text in element.iter(f"{SVG}text")]


def test_every_element_is_one_group_with_its_path_as_id() -> None:
    model = triangle()
    model.tag_only([model.rods["BC"]], Selected)
    picture = picture_of(model, all_diagrams=True)
    root = svg_of(picture, model)
    groups = groups_of(root)
    assert set(groups) == {
        f"{kind}.{name}" for kind in ("particles", "rods") for name in model_names(model, kind)
    }
    assert {"AB", "−28.34 kN"} <= set(texts_of(groups["rods.AB"]))
    assert groups["rods.AB"].get("class") == "rods"
    assert "B" in texts_of(groups["particles.B"])
    assert sorted(texts_of(root)) == sorted(picture.texts)


def test_a_picture_carries_the_fonts_of_its_texts() -> None:
    root = svg_of(picture_of(triangle(), all_diagrams=True), triangle())
    rules = (root.findtext(f"{SVG}style") or "").split("@font-face")[1:]
    assert {text.get("font-weight") for text in root.iter(f"{SVG}text")} == {"400", "600"}
    for rule, weight, file in zip(rules, ("400", "600"), WEIGHTS.values(), strict=True):
        assert f"font-weight:{weight};" in rule
        carried = b64decode(re.search("base64,([^)]*)", rule)[1])  # type: ignore[index]
        assert carried == (files("pinjoint.assets") / "fonts" / file).read_bytes()
    assert svg_of(Picture(Viewport(0, 0, *SIZE), WHITE), triangle()).findtext(f"{SVG}style") == ""


def model_names(model: Model, table: str) -> list[str]:
    return list(model.tables[table].names)


def test_nothing_is_rasterised_and_text_is_text() -> None:
    root = svg_of(picture_of(triangle(), all_diagrams=True), triangle())
    assert {element.tag.removeprefix(SVG) for element in root.iter()} <= {
        *("svg", "style", "title", "g", "rect", "path", "polygon", "circle", "text")
    }
    assert root.get("font-family") == "Inter, sans-serif"
    assert {text.get("font-size") for text in root.iter(f"{SVG}text")} <= {"11", "12", "13"}


def test_the_same_picture_gives_the_same_bytes() -> None:
    files = []
    for _ in range(2):
        model = triangle()
        picture = picture_of(model, all_diagrams=True)
        files.append((as_svg([(picture, partial(path_of, model))], SIZE, "A"), as_pdf([picture], SIZE, "A")))
    assert files[0] == files[1]
    assert not re.search(rb"D:20[1-9]", files[0][1])  # no date of today


def test_elements_lie_over_the_diagrams_of_others() -> None:
    model = triangle()
    order = list(groups_of(svg_of(picture_of(model, all_diagrams=True), model)))
    assert [name.partition(".")[0] for name in order] == ["rods"] * 3 + ["particles"] * 3


@pytest.mark.parametrize(
    ("name", "known"),
    [("my rod", "rods.my%20rod"), ("50%", "rods.50%25"), ("<&>", "rods.<&>"), ("ω\x07", "rods.ω%07")],
)
def test_any_name_can_be_an_id(name: str, known: str) -> None:
    model = triangle()
    model.rods["AB"].name = name
    assert known in groups_of(svg_of(picture_of(model), model))


def test_shapes_are_what_marks_say() -> None:
    at = np.array([[10.0, 20.0]])
    marks: list[Mark] = [
        Strokes(at, at + 5.0, 2.0, RED, ("rods", np.array([3]))),
        Discs(at, np.array([4.0]), RED, WHITE, 1.5, ("particles", np.array([0]))),
        Stamps("disc", at, 6.0, 1.0, RED, RED),
        Panel(0, 0, 5, 5, 0.0, WHITE),
        Panel(1.0, 2.0, 30.0, 10.0, 3.0, WHITE, RED),
        Text("A  B", 5.0, 5.0, 12, RED, of=("rods", 3)),
    ]
    picture = Picture(Viewport(0, 0, 100, 100), WHITE, marks)
    groups = grouped(picture)
    assert groups[0] == (("rods", 3), [Line((10.0, 20.0), (15.0, 25.0), 2.0, RED), marks[-1]])
    assert groups[1] == (("particles", 0), [Circle((10.0, 20.0), 4.0, RED, WHITE, 1.5)])
    assert [owner for owner, _ in groups[2:]] == [None, None, None]
    root = ET.fromstring(as_svg([(picture, lambda owner: f"{owner[0]}.{owner[1]}")], (100, 100), ""))
    circle = root.find(f".//{SVG}g[@id='particles.0']/{SVG}circle")
    assert circle is not None
    assert circle.get("r") == "3.25"  # the middle of its rim
    assert circle.get("stroke-width") == "1.5"
    text = root.find(f".//{SVG}text")
    assert text is not None
    assert text.text == "A  B"
    assert text.get("{http://www.w3.org/XML/1998/namespace}space") == "preserve"


def test_pictures_beside_each_other_stay_in_their_frames() -> None:
    model = triangle()
    left, right = picture_of(model), picture_of(model)
    named = [(picture, partial(path_of, model)) for picture in (left, right)]
    root = ET.fromstring(as_svg(named, SIZE, ""))
    assert len(root.findall(f"{SVG}svg")) == 2
    assert {"rods.AB", "2.rods.AB"} <= set(groups_of(root))


def test_a_pdf_has_its_fonts_and_its_texts() -> None:
    model = triangle()
    made = as_pdf([picture_of(model, all_diagrams=True)], SIZE, "Triangle")
    assert made.startswith(b"%PDF-")
    assert made.count(b"/FontFile2") == 2  # regular and semibold, embedded
    assert b"/ToUnicode" in made  # so that texts can be searched for and copied
    assert b"/Image" not in made.replace(b"/ImageB", b"").replace(b"/ImageC", b"").replace(b"/ImageI", b"")
    assert b"0 0 450 450" in made  # 600 pixels
