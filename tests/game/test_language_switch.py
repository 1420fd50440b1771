"""F2 changes the language of all that a window shows, in every scene."""

import pytest

from pinjoint.components.language import language, spoken
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.documents.preferences import preferred
from pinjoint.editor.scenes.form import FormScene
from pinjoint.results import Results
from pinjoint.session import Session
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme


def test_f2_goes_from_language_to_language_and_begins_again():
    session = Session.open("isostatic")
    session.press("f2")
    assert language() == "pt"
    assert session.message.endswith("Português")
    session.press("f2")
    assert language() == "en"
    assert session.message == "Language: English"


@pytest.mark.parametrize("scene", ["properties", "load", "save"])
def test_what_was_typed_into_a_form_stays(scene):
    session = Session.open("isostatic")
    session.click(1.0, 1.0)
    session.act(scene)
    session.click_box("load x" if scene == "properties" else "name")
    session.press("ctrl+a")
    session.type("12.")
    session.press("f2")
    scene_of_form = session.scenes.active
    assert isinstance(scene_of_form, FormScene)
    form = scene_of_form.form
    assert form.selected is not None
    assert form.selected.text == "12."
    session.press("escape")
    assert session.scene == scene
    assert session.scenes.active.boxes["load x" if scene == "properties" else "name"] == (
        "120" if scene == "properties" else "isostatic" if scene == "save" else ""
    )


@pytest.mark.usefixtures("config")
def test_a_window_remembers_the_choice():
    from pinjoint.app import App
    from pinjoint.documents import models

    app = App(models.load("isostatic"))
    app.frame(0.0)
    assert preferred("language") == ""
    app.session.press("f2")
    app.frame(0.0)
    assert app.render.drawn
    assert preferred("language") == "pt"
    app.close()


def test_boxes_show_and_take_a_comma_in_portuguese_and_give_scripts_the_point():
    session = Session.open("isostatic")
    with spoken("pt"):
        session.click(1.0, 1.0)
        session.act("properties")
        session.click_box("load x")
        session.press("ctrl+a")
        session.type("12,5")
        texts = [text for picture in compose_all(session.stages, load_theme()) for text in picture.texts]
        assert "12,5" in texts
        session.press("ctrl+a")
        session.press("ctrl+x")
        assert session.clipboard == "12,5"
        session.press("ctrl+v")
        session.press("return")
        assert session.scenes.active.boxes["load x"] == "12.5"
    assert session.particles["B"].force[0] == 12.5


def test_boxes_show_what_may_be_chosen_in_portuguese():
    session = Session.open("gerber_beam")
    with spoken("pt"):
        session.select(session.rods["AB"])
        session.act("properties")
        scene = session.scenes.active
        assert isinstance(scene, FormScene)
        said = [box.said_text for box in scene.form.boxes]
    assert {"estática", "primeira ordem"} <= set(said)


def test_names_that_nobody_gave_are_read_in_the_present_language():
    session = Session.open("collision_i")
    session.model.create(Rod, between=[(0, 1)])
    session.rods["rod 1"].bending_stiffness = 1.0
    with spoken("pt"):
        session.update_view()
        texts = [text for picture in compose_all(session.stages, load_theme()) for text in picture.texts]
        assert {"barra 1", "partícula 1", "partícula 2"} <= set(texts)
        assert session.model.describe(session.rods["rod 1"]) == "barra 1"
        assert Results.of(session.model).particles.names == ["partícula 1", "partícula 2"]
        assert session.rods["rod 1"].name == "rod 1", "files and scripts are the same in every language"


def test_undo_says_in_the_present_language_what_was_done_in_another():
    session = Session.open("isostatic")
    rod = session.model.rods[0]
    rod.youngs_modulus = 2.1e8
    session.model.create(Particle, position=[(5.0, 5.0)])
    session.press("f2")
    said = []
    for _ in range(2):
        session.press("ctrl+z")
        said.append(session.message)
    assert said == ["Anulado: criar partícula", f"Anulado: módulo de elasticidade de barra {rod.name}"]
