"""`pinjoint render`: pictures for reports."""

import json
import warnings
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pygame
import pytest

from pinjoint.app import App
from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.systems.render.theme import load_theme
from tests.reference.models import model, particle, rod

SVG = "{http://www.w3.org/2000/svg}"
RUN = ["isostatic", "--until-rest", "--diagrams"]


def rendered(path: Path, *words: str) -> Path:
    assert main(["render", *RUN, "--size", "640x480", "--output", str(path), *words]) == 0
    return path


def colours(path: Path) -> np.ndarray:
    surface = pygame.image.load(path)
    return np.dstack([pygame.surfarray.array3d(surface), pygame.surfarray.array_alpha(surface)]).astype(int)


def test_a_transparent_picture_over_white_is_the_opaque_one(tmp_path: Path) -> None:
    opaque = colours(rendered(tmp_path / "a.png"))
    clear = colours(rendered(tmp_path / "b.png", "--background", "transparent"))
    assert clear[-1, -1, 3] == 0
    assert (clear[..., 3] == 0).mean() > 0.5
    share = clear[..., 3:] / 255
    # Levels are whole numbers in each of the two pictures that it is computed from, and in itself.
    assert np.abs(share * clear[..., :3] + 255 * (1 - share) - opaque[..., :3]).max() <= 2.0


def test_no_status_bar_stands_in_a_picture_for_a_report(tmp_path: Path) -> None:
    root = ET.parse(rendered(tmp_path / "a.svg")).getroot()
    texts = {text.text for text in root.iter(f"{SVG}text")}
    assert {"AB", "−28.34 kN"} <= texts
    assert not [text for text in texts if text and (text.startswith("t =") or text == "At rest")]
    assert root.find(f"{SVG}rect").get("fill") == "#ffffff"
    clear = ET.parse(rendered(tmp_path / "b.svg", "--background", "transparent")).getroot()
    assert clear.find(f"{SVG}rect").get("width") == "1"  # a line of the grid: there is no background


def test_type_grows_with_the_size_of_a_picture(tmp_path: Path) -> None:
    found = []
    for size in ("640x480", "1280x800", "2560x1600"):
        path = rendered(tmp_path / "a.svg", "--size", size)
        texts = ET.parse(path).getroot().iter(f"{SVG}text")
        found.append({text.text: float(text.get("font-size", "nan")) for text in texts})
    assert found[0]["−28.34 kN"] == found[1]["−28.34 kN"]
    shared = found[1].keys() & found[2].keys()
    assert {"AB", "−28.34 kN"} <= shared
    assert {found[2][text] / found[1][text] for text in shared} == {2.0}


def test_a_plain_picture_has_no_grid_and_says_nothing_of_scales(tmp_path: Path) -> None:
    usual, plain = (ET.parse(rendered(tmp_path / "a.svg", *words)).getroot() for words in ((), ("--plain",)))
    told = [{text.text for text in root.iter(f"{SVG}text")} for root in (usual, plain)]
    (scale,) = told[0] - told[1]
    assert "displacements ×" in (scale or "")
    assert any(rect.get("width") == "1" for rect in usual.findall(f"{SVG}rect"))
    assert not any(rect.get("width") == "1" for rect in plain.findall(f"{SVG}rect"))


def test_walls_have_groups_too(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    assert main(["render", "pile", "--output", str(path)]) == 0
    groups = {group.get("data-path"): group for group in ET.parse(path).getroot().iter(f"{SVG}g")}
    walls = {f"walls.{name}" for name in models.load("pile").tables["walls"].names}
    assert walls
    assert walls <= set(groups)
    assert len(groups["walls.floor"]) == 3  # a line and two round ends


@pytest.mark.parametrize("diagrams", [False, True])
def test_loads_have_groups_of_their_own(diagrams: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    words = ["render", "braced_portal", "--at", "0.6", "--output", str(path)]
    assert main([*words, "--diagrams"] if diagrams else words) == 0
    groups = {group.get("data-path"): group for group in ET.parse(path).getroot().iter(f"{SVG}g")}
    [name] = models.load("braced_portal").tables["loads"].names
    assert groups[f"loads.{name}"].findall(f"{SVG}polygon")  # the head of its arrow
    texts = [text.text for text in groups[f"loads.{name}"].iter(f"{SVG}text")]
    assert texts == (["50 kN"] if diagrams else [])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["a.jpg", "--background", "transparent"], "a .jpg cannot be transparent"),
        (["a.gif", "--background", "white"], "always has the background of its theme"),
        (["a.png", "--background", "white", "--theme", "dark"], "choose a light theme"),
        (["a.tiff"], "ends with one of .png, .svg, .pdf"),
    ],
)
def test_what_does_not_go_together_is_refused(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["render", "isostatic", "--output", str(tmp_path / words[0]), *words[1:]]) == 2
    assert told in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [["--at", "0.01"], ["--mode", "1"], ["--mechanism", "1"]])
def test_why_numbers_of_a_model_lead_nowhere_is_told(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A mass of 3e30 kg, which follows from a density."""
    far = [particle("A", 0, 0), particle("B", 1e30, 0), particle("C", 0, 1, fixed=[True, True])]
    document = model(far, [rod("A", "B", density=6.15), rod("A", "C", bending_stiffness=1e3)])
    (tmp_path / "m.json").write_text(json.dumps(document))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        status = main(["render", str(tmp_path / "m.json"), "--output", str(tmp_path / "m.png"), *words])
    assert status == (1 if "--at" in words else 2)
    assert "mass is 3.075e+30 kg, too large to compute with" in capsys.readouterr().err


def test_pictures_of_the_window(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    app = App(models.load("isostatic"))
    app.next_frame(wait=False)
    for key in ("f12", "shift+f12", "ctrl+f12", "shift+f12"):
        app.session.press(key)
        app.next_frame(wait=False)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("pinjoint-2.svg", "pinjoint.pdf", "pinjoint.png", "pinjoint.svg")
    ]
    texts = [text.text for text in ET.parse(tmp_path / "pinjoint.svg").getroot().iter(f"{SVG}text")]
    assert "AB" in texts
    assert "Paused" not in texts
    assert pygame.image.load(tmp_path / "pinjoint.png").get_size() == app.render.surface.get_size()
    app.close()


def test_a_picture_of_several_sets_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Toolbar and message bar leave no hole in it."""
    monkeypatch.chdir(tmp_path)
    app = App(models.load("hyperstatic"))
    app.next_frame(wait=False)
    for key in ("k", "f12", "escape", "return", "f12"):
        app.session.press(key)
        app.next_frame(wait=False)
    for name in ("pinjoint.png", "pinjoint-2.png"):
        corner = colours(tmp_path / name)[0, 0, :3]
        assert tuple(corner) == load_theme(app.session.view.theme).background[:3]
    app.close()


def test_the_static_equilibrium_is_drawn_with_the_numbers_of_a_hand_calculation(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    words = ["render", "gerber_beam", "--static", "--output", str(path)]
    assert main([*words, "--theory", "first-order"]) == 0
    texts = {text.text for text in ET.parse(path).getroot().iter(f"{SVG}text")}
    assert {"60.00 kN·m", "20.00 kN·m", "80.00 kN", "20.00 kN"} <= texts
    undeformed = path.read_text()
    assert "deflected" in texts
    assert main([*words, "--undeformed"]) == 0
    assert path.read_text() == undeformed
    assert main([*words, "--deformed"]) == 0
    assert "deflected" not in {text.text for text in ET.parse(path).getroot().iter(f"{SVG}text")}
    assert main([*words[:2], "--deformed", *words[3:]]) == 2  # not in statics
    assert main([*words, "--set", "particles.B.fixed=false,false"]) == 1  # a mechanism: the last equilibrium
    assert main([*words, "--at", "1"]) == 2
