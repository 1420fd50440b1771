"""Properties: boxes from Fields, typing into them, and all of them applied at once."""

import itertools

import pytest

from pinjoint import Session
from pinjoint.components.camera import Viewport
from pinjoint.components.field import SAVED, Field, same
from pinjoint.components.form import Box
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.tags import Selected
from pinjoint.editor.scenes.form import FormScene
from pinjoint.editor.scenes.properties import Properties
from pinjoint.systems.render.ui.form import FormLayout
from tests.golden.scenes import composed
from tests.reference.models import model, particle, rod, triangle

SIZES = [(320, 240), (640, 480), (3840, 2160)]


@pytest.fixture
def session() -> Session:
    return Session.open(triangle(tensile_strength=215))


def open_of(session: Session, *names: str) -> Properties:
    """The properties of elements by name, as a person opens them."""
    tables = [session.particles, session.rods]
    session.select(*(table[name] for name in names for table in tables if name in table))
    session.press("return")
    scene = session.scenes.active
    assert isinstance(scene, Properties)
    return scene


def box_of(session: Session, title: str) -> Box:
    scene = session.scenes.active
    assert isinstance(scene, Properties)
    return next(box for box in scene.form.boxes if box.title == title)


def entered(session: Session, title: str, text: str) -> Box:
    """Select a box, type into it and accept it."""
    session.click_box(title)
    session.type(text)
    session.press("return")
    return box_of(session, title)


def layout_of(session: Session) -> FormLayout:
    scene = session.scenes.active
    assert isinstance(scene, Properties)
    return scene.layout(session)


# --- what is shown -----------------------------------------------------------------------------------


def test_a_rod_has_the_boxes_that_the_thesis_names(session: Session) -> None:
    scene = open_of(session, "AB")
    assert session.scene == "properties"
    assert scene.form.heading == "rod AB"
    shown = {
        "rest length": "141.421356",
        "tensile strength": "215",
        "compressive strength": "unlimited",
        "stiffness": "164640",
        "damping coefficient": "100",
        "density": "0.0615",
        "force diagram scale": "1",
    }
    assert shown.items() <= session.boxes.items()
    units = {box.title: box.unit for box in scene.form.boxes}
    assert units["rest length"] == "cm"
    assert units["density"] == "kg/cm"
    assert units["damping coefficient"] == "kN·s/m"


def test_a_particle_has_the_boxes_that_the_thesis_names(session: Session) -> None:
    open_of(session, "B")
    for title in ("displacement", "original position", "load", "applied acceleration", "velocity"):
        assert {f"{title} x", f"{title} y"} <= session.boxes.keys()
    assert session.boxes["original position x"] == "100"
    assert session.boxes["load y"] == "-160"
    assert session.boxes["constrained x"] == "no"
    assert session.boxes["radius"] == "5"
    together = {"displacement scale": "100", "coefficient of restitution": "1", "time step": "automatic"}
    assert together.items() <= session.boxes.items()


def test_nothing_selected_is_the_environment_and_all_settings(session: Session) -> None:
    scene = open_of(session)
    assert scene.form.heading == "Environment"
    assert {box.section for box in scene.form.boxes} == {
        *("Environment", "All particles", "Load combinations", "All rods")
    }
    assert {"force x", "acceleration y", "drag", "integrator", "force diagram scale"} <= session.boxes.keys()


@pytest.mark.parametrize(
    ("names", "sections"),
    [
        (("B",), ["particle B", "Supports and joints", "Loads", "Motion and contact", "All particles"]),
        (("AB",), ["rod AB", "Section and material", "Loads", "Motion and contact", "All rods"]),
        ((), ["Environment", "All particles", "Load combinations", "All rods"]),
    ],
)
def test_boxes_stand_in_groups_in_the_order_of_the_work(
    session: Session, names: tuple[str, ...], sections: list[str]
) -> None:
    boxes = open_of(session, *names).form.boxes
    assert [section for section, _ in itertools.groupby(boxes, lambda box: box.section)] == sections


def test_what_matters_first_stands_first(session: Session) -> None:
    titles = [box.title for box in open_of(session, "AB").form.boxes]
    assert titles[:4] == ["name", "rest length", "section", "material"]


def test_groups_of_several_kinds_follow_those_of_each(session: Session) -> None:
    boxes = open_of(session, "A", "B", "AB").form.boxes
    sections = [section for section, _ in itertools.groupby(boxes, lambda box: box.section)]
    assert sections[0] == "2 particles"
    assert sections[sections.index("rod AB") :] == [
        *("rod AB", "Section and material", "Loads", "Motion and contact", "All particles", "All rods")
    ]


def test_every_field_that_a_person_can_set_has_a_box(session: Session) -> None:
    session.model.rods.bending_stiffness = 10.0
    for name, kind in (("B", Particle), ("AB", Rod)):
        targets = {box.target for box in open_of(session, name).form.boxes}
        for field in vars(kind).values():
            # By the run, or when it was drawn.
            decided = field in (Particle.asleep, Rod.yielded_at, Rod.hinge_formed_at, Rod.between)
            if isinstance(field, Field) and field.role in SAVED and not decided:
                axes = field.axes if field.shape else ("",)
                wanted = {f"{kind.table}.{field.name}{'.' * bool(axis)}{axis}" for axis in axes}
                assert wanted <= targets
        session.press("escape")


# --- members that bend -----------------------------------------------------------------------------


def cantilever(**properties: object) -> Session:
    """A rod that bends, clamped at A, loaded at B."""
    particles = [
        particle("A", 0, 0, fixed=[True, True], fixed_rotation=True),
        particle("B", 2, 0, force=[0, -1]),
    ]
    given = {"bending_stiffness": 100.0, "damping": 1e4, **properties}
    return Session.open(model(particles, [rod("A", "B", **given)]))


def sections_of(scene: Properties) -> set[str]:
    return {box.section for box in scene.form.boxes}


def test_what_bends_has_boxes_of_its_own_and_others_have_not(session: Session) -> None:
    scene = open_of(session, "AB")
    assert "Supports and joints" not in sections_of(scene)
    titles = {box.title for box in scene.form.boxes}
    assert {"bending stiffness", "distributed force x"} <= titles
    assert not {"hinged start", "temperature gradient", "bending damping"} & titles
    session.press("escape")
    assert "rotation" not in {box.title for box in open_of(session, "B").form.boxes}
    session.press("escape")
    bent = cantilever()
    assert {"hinged start", "hinged end", "temperature gradient", "bending damping"} <= {
        box.title for box in open_of(bent, "AB").form.boxes
    }
    bent.press("escape")
    assert {"rotation", "rotation constrained"} <= {box.title for box in open_of(bent, "B").form.boxes}


def test_a_bar_begins_to_bend_while_its_box_stays_selected(session: Session) -> None:
    scene = open_of(session, "AB")
    session.click_box("bending stiffness")
    session.type("50")
    session.press("tab")
    assert session.rods["AB"].bending_stiffness == 50.0
    assert "hinged start" in session.boxes
    assert scene.form.selected is not None
    entered(session, "hinged end", "yes")
    assert session.rods["AB"].hinged == (False, True)
    entered(session, "distributed force y", "-3.5")
    assert session.rods["AB"].distributed_force == (0.0, -3.5)
    session.press("escape")
    session.undo()
    assert session.rods["AB"].bending_stiffness == 0.0
    assert session.rods["AB"].distributed_force == (0.0, 0.0)


def test_a_clamp_and_a_moment_are_typed() -> None:
    session = cantilever()
    open_of(session, "B")
    entered(session, "applied moment", "2")
    entered(session, "rotation constrained", "yes")
    assert (session.particles["B"].moment, session.particles["B"].fixed_rotation) == (2.0, True)


def test_a_section_and_a_material_are_typed_or_turned_to() -> None:
    session = cantilever()
    open_of(session, "AB")
    assert session.boxes["section"] == "none"
    entered(session, "section", "ipe 2")
    assert session.rods["AB"].section == "IPE 200"
    assert session.boxes["section"] == "IPE 200"
    assert session.boxes["second moment"] == "1943.17"
    assert session.boxes["material"] == "S235"
    box = box_of(session, "bending stiffness")
    assert (box.text[:4], box.note) == ("4080", "automatic")
    session.click_box("section")
    session.press("down")
    session.press("return")
    assert session.rods["AB"].section == "IPE 220"
    entered(session, "section", "rect 60x100")
    assert session.boxes["section"] == "rectangle 60×100"
    entered(session, "material", "alu")
    assert session.rods["AB"].youngs_modulus == 70e6
    entered(session, "area", "30")
    assert session.boxes["section"] == "none"


def test_results_tell_of_both_ends() -> None:
    session = cantilever(distributed_force=[0, -2])
    session.run(until="rest", limit=20.0)
    scene = open_of(session, "AB")
    told = {reading.title: reading.text for reading in scene.form.readings}
    assert told["M at its ends"].startswith("A −")
    assert told["V at its ends"].endswith("kN")
    assert "mrad" in told["rotation of its ends"]
    session.press("escape")
    told = {reading.title: reading.text for reading in open_of(session, "A").form.readings}
    assert told["reaction moment"].endswith("kN·m")


# --- typing ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("typed", "text"),
    [
        ("200000", "200000"),
        ("2a0 0y", "200"),
        ("1.5.2", "1.52"),
        ("1e5", "1e5"),
        ("2,5", "2.5"),
        ("--3", "-3"),
        ("/3", "-3"),
        ("e", ""),
        ("5-", "5"),
    ],
)
def test_a_number_takes_what_can_become_a_number(session: Session, typed: str, text: str) -> None:
    open_of(session, "AB")
    session.click_box("density")
    session.press("backspace")
    session.type(typed)
    assert session.boxes["density"] == text


@pytest.mark.parametrize(
    ("element", "title", "typed", "field", "value"),
    [
        ("B", "radius", "0.07 m", "radius", 0.07),
        ("B", "radius", "70mm", "radius", 0.07),
        ("B", "radius", "7 cm", "radius", 0.07),
        ("B", "displacement y", "−1e0 mm", "displacement", (0.0, -0.001)),
        ("B", "original position x", "1,5 m", "position", (1.5, 1.0)),
        ("AB", "rest length", "1.5 m", "rest_length", 1.5),
        ("AB", "stiffness", "3 kN", "stiffness", 3.0),
        ("AB", "stiffness", "50MN", "stiffness", 50_000.0),
        ("AB", "Young's modulus", "210000 N/mm2", "youngs_modulus", 2.1e8),
        ("AB", "area", "28.5 cm²", "area", 28.5e-4),
        ("AB", "damping coefficient", "3 N·s/mm", "damping", 3.0),
        ("B", "mass", "2.5 t", "mass", 2500.0),
        ("B", "load y", "-300 N", "force", (120.0, -0.3)),
        ("B", "radius", "7", "radius", 0.07),
        ("B", "original position x", "33", "position", (0.33, 1.0)),
        ("B", "constrained x", "1", "fixed", (True, False)),
        ("B", "constrained y", "yes", "fixed", (False, True)),
        ("B", "mass", "2.5", "mass", 2.5),
        ("B", "load x", "-1.5e2", "force", (-150.0, -160.0)),
    ],
)
def test_a_number_is_taken_in_the_unit_shown_or_in_the_one_typed(
    session: Session, element: str, title: str, typed: str, field: str, value: object
) -> None:
    scene = open_of(session, element)
    box = entered(session, title, typed)
    assert getattr(scene.form.boxes[0].elements[0], field) == value
    assert box.text[-1].isdigit() or box.text == "yes", "shown again in the unit of the box"


def test_return_accepts_and_deselects_and_the_value_acts_at_once(session: Session) -> None:
    scene = open_of(session, "AB")
    session.click_box("stiffness")
    session.type("200000")
    assert scene.form.selected is box_of(session, "stiffness")
    assert session.rods["AB"].stiffness == 164640.0, "not while it is typed"
    session.press("return")
    assert scene.form.selected is None
    assert session.rods["AB"].stiffness == 200000.0
    session.press("escape")
    assert session.scene == "pause"
    assert session.rods["AB"].stiffness == 200000.0


@pytest.mark.parametrize("accept", ["return", "tab", "shift+tab", "down"])
def test_every_way_to_accept_a_box_applies_it(session: Session, accept: str) -> None:
    open_of(session, "B")
    session.click_box("load x")
    session.type("7")
    session.press(accept)
    assert session.particles["B"].force == (7.0, -160.0)


def test_a_click_into_another_box_or_beside_applies_the_first(session: Session) -> None:
    session.resize(1000, 720)
    open_of(session, "B")
    session.click_box("load x")
    session.type("7")
    place = layout_of(session).place_of(box_of(session, "load y"))
    assert place is not None
    session.press("click", (place.left + 3, place.top + 3))
    assert session.particles["B"].force == (7.0, -160.0)
    session.type("9")
    session.press("click", (place.left + 3, place.top - 60))
    assert session.particles["B"].force == (7.0, 9.0)


def test_a_switch_acts_at_the_click_and_escape_turns_it_back(session: Session) -> None:
    session.resize(1000, 720)
    open_of(session, "B")
    place = layout_of(session).place_of(box_of(session, "constrained x"))
    assert place is not None
    session.press("click", (place.left + 3, place.top + 3))
    assert session.particles["B"].fixed == (True, False)
    session.press("escape")
    assert session.particles["B"].fixed == (False, False)
    assert session.scene == "properties"


def test_boxes_follow_what_others_change(session: Session) -> None:
    scene = open_of(session, "AB")
    before = session.boxes["rest length"]
    session.press("escape")
    open_of(session, "B")
    mass = session.boxes["mass"]
    entered(session, "original position x", "150")
    assert session.boxes["mass"] != mass, "half of the mass of longer rods"
    session.press("escape")
    assert open_of(session, "AB") is scene
    assert session.boxes["rest length"] != before
    entered(session, "name", "strut")
    assert scene.form.heading == "rod strut"


def test_an_empty_box_leaves_its_value(session: Session) -> None:
    open_of(session, "AB")
    session.click_box("stiffness")
    session.press("backspace")
    session.press("return")
    assert session.boxes["stiffness"] == ""
    session.press("escape")
    assert session.rods["AB"].stiffness == 164640.0


def test_what_was_not_typed_keeps_its_bits() -> None:
    odd = 0.1 + 0.2
    session = Session.open(model([particle("A", odd, -0.0, velocity=[1 / 3, 1e-300])], []))
    before = {name: session.particles.column(name).copy() for name in session.particles.fields}
    session.select(session.particles["A"])
    session.press("return")
    session.press("escape")
    assert all(same(column, session.particles.column(name)) for name, column in before.items())
    assert not session.document.history.can_undo


def test_a_mass_can_be_given_back_to_the_rods(session: Session) -> None:
    lumped = session.particles["B"].mass
    session.particles["B"].mass = 2.0
    open_of(session, "B")
    assert session.boxes["mass"] == "2"
    assert entered(session, "mass", "a").note == "automatic"
    assert float(session.boxes["mass"]) == pytest.approx(lumped, rel=1e-8)
    session.press("escape")
    assert session.particles["B"].mass == lumped


def test_switches_take_words_digits_and_clicks(session: Session) -> None:
    scene = open_of(session, "B")
    assert [entered(session, "collisions", typed).text for typed in "01ny"] == 2 * ["no", "yes"]
    session.view.camera.viewport = Viewport(0, 0, 1000, 1000)
    place = layout_of(session).place_of(box_of(session, "collisions"))
    assert place is not None
    session.press("click", (place.left + 5, place.top + 5))
    assert session.boxes["collisions"] == "no"
    assert scene.form.selected is box_of(session, "collisions")


def test_the_integrator_is_one_of_the_known(session: Session) -> None:
    open_of(session)
    assert entered(session, "integrator", "taylor2").text == "taylor2"
    session.click_box("integrator")
    session.type("xx9")
    assert session.boxes["integrator"] == "taylor2"
    seen = set()
    for _ in range(10):
        session.press("down")
        seen.add(session.boxes["integrator"])
    assert {"automatic", "velocity_verlet", "taylor2"} <= seen
    session.type("taylor2")
    session.press("return")
    session.press("escape")
    assert session.settings.integrator == "taylor2"


def test_tab_goes_round_all_boxes_and_back(session: Session) -> None:
    scene = open_of(session, "AB")
    count = len(scene.form.boxes)
    visited = []
    for _ in range(count + 1):
        session.press("tab")
        assert scene.form.selected is not None
        visited.append(scene.form.boxes.index(scene.form.selected))
    assert visited == [*range(count), 0]
    session.press("shift+tab")
    assert scene.form.selected is scene.form.boxes[count - 1]


def test_the_caret_edits_in_the_middle(session: Session) -> None:
    open_of(session, "AB")
    session.click_box("stiffness")
    for key in ("left", "right", "right", "backspace"):
        session.press(key)
    session.type("99")
    session.press("delete")
    assert session.boxes["stiffness"] == "199640"


def test_text_goes_through_the_clipboard(session: Session) -> None:
    open_of(session, "AB")
    session.click_box("stiffness")
    session.press("ctrl+c")
    session.click_box("damping coefficient")
    session.press("ctrl+v")
    assert session.boxes["damping coefficient"] == "164640"
    session.clipboard = "1 234,5 kN"
    session.press("ctrl+a")
    session.press("ctrl+v")
    assert session.boxes["damping coefficient"] == "1234.5 kN"
    assert box_of(session, "damping coefficient").problem == "must be in kN·s/m, not in kN"
    session.press("ctrl+x")
    assert session.boxes["damping coefficient"] == ""
    assert session.clipboard == "1234.5 kN"


# --- loads -------------------------------------------------------------------------------------------


def ramped() -> Session:
    """The triangle with a load at B that grows in half a second."""
    load = {"on": "B", "force": [3, 0], "history": {"kind": "ramp", "duration": 0.5}}
    return Session.open(triangle() | {"loads": [load]})


def test_a_load_is_edited_with_its_particle() -> None:
    session = ramped()
    scene = open_of(session, "B")
    assert "load 1" in {box.section for box in scene.form.boxes}
    assert session.boxes["history"] == "ramp"
    assert (session.boxes["history start"], session.boxes["history duration"]) == ("0", "0.5")
    entered(session, "history duration", "2")
    entered(session, "force x", "4")
    session.press("escape")
    load = session.loads["load 1"]
    assert load.force == (4.0, 0.0)
    assert dict(load.history) == {"kind": "ramp", "start": 0.0, "duration": 2.0}


def test_a_history_can_become_another() -> None:
    session = ramped()
    open_of(session, "B")
    assert "history duration" in session.boxes
    entered(session, "history", "constant")
    assert "history duration" not in session.boxes
    session.press("escape")
    load = session.loads["load 1"]
    assert dict(load.history) == {"kind": "constant"}
    session.undo()
    assert load.history["kind"] == "ramp"


def test_a_bad_history_is_refused() -> None:
    session = ramped()
    open_of(session, "B")
    box = entered(session, "history duration", "-1")
    assert "at least 0" in box.problem
    session.press("escape")
    session.press("escape")
    assert session.loads["load 1"].history["duration"] == 0.5


# --- what is refused ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("element", "title", "text", "reason"),
    [
        ("AB", "stiffness", "0", "must be greater than 0 kN"),
        ("AB", "stiffness", "-", "must be a number"),
        ("AB", "rest length", "-3", "must be greater than 0 cm"),
        ("AB", "damping coefficient", "-1", "must be at least 0 kN·s/m"),
        ("AB", "density", "1e999", "must be a finite number"),
        ("AB", "name", "BC", "there is a rod 'BC' already"),
        ("B", "coefficient of restitution", "1.5", "must be at most 1"),
        ("B", "time step", "1e", "must be a number"),
        ("B", "radius", "3 kN", "must be in m, cm, mm, not in kN"),
        ("B", "radius", "-70 mm", "must be greater than 0 cm"),
    ],
)
def test_a_bad_value_is_refused_with_the_reason(
    session: Session, element: str, title: str, text: str, reason: str
) -> None:
    scene = open_of(session, element)
    before = session.document.newest
    box = entered(session, title, text)
    assert box.problem == reason
    assert scene.form.selected is box, "Return does not accept it"
    session.click_box("force diagram scale" if element == "AB" else "mass")
    session.press("escape")
    session.press("escape")
    assert session.scene == "pause"
    assert session.document.newest == before, "the old value stays"
    assert reason in session.notice
    assert title in session.notice


def test_what_contradicts_another_property_is_refused_and_the_rest_is_applied(session: Session) -> None:
    open_of(session, "A")
    entered(session, "velocity y", "3")
    entered(session, "mass", "4")
    session.press("escape")
    assert session.particles["A"].velocity == (0.0, 0.0)
    assert session.particles["A"].mass == 4.0
    assert "a support holds it along y" in session.notice


def test_freeing_a_direction_and_moving_in_it_go_together(session: Session) -> None:
    open_of(session, "A")
    entered(session, "velocity y", "3")
    entered(session, "constrained y", "0")
    session.press("escape")
    assert session.particles["A"].velocity == (0.0, 3.0)
    assert session.notice == ""


# --- several at once, undo, runs -----------------------------------------------------------------------


def test_several_elements_are_edited_together(session: Session) -> None:
    scene = open_of(session, "A", "B", "C")
    assert scene.form.heading == "3 particles"
    assert session.boxes["load x"] == ""
    assert box_of(session, "load x").note == "mixed"
    assert session.boxes["displacement x"] == "0"
    assert "name" not in session.boxes
    entered(session, "load x", "5")
    session.press("escape")
    assert [p.force for p in session.particles] == [(5.0, 0.0), (5.0, -160.0), (5.0, 0.0)]


def test_all_boxes_are_one_step_to_undo(session: Session) -> None:
    open_of(session, "AB")
    entered(session, "stiffness", "5")
    entered(session, "density", "5")
    entered(session, "name", "first rod")
    session.press("escape")
    assert session.rods["first rod"].density == 500.0
    session.undo()
    assert (session.rods["AB"].stiffness, session.rods["AB"].density) == (164640.0, 6.15)
    assert not session.document.history.can_undo
    session.redo()
    assert session.rods["first rod"].stiffness == 5.0


def test_properties_of_a_run_return_to_it(session: Session) -> None:
    session.press("space")
    assert session.scene == "simulation"
    session.select(session.rods["AB"])
    session.press("return")
    assert session.scene == "properties"
    entered(session, "damping coefficient", "7")
    session.press("escape")
    assert session.scene == "simulation"
    assert session.rods["AB"].damping == 7.0
    session.press("space")
    session.press("return")
    session.press("escape")
    assert session.scene == "pause"


def test_looking_at_properties_does_not_change_a_run() -> None:
    states = []
    for looks in (False, True):
        session = Session.open(triangle())
        session.run(steps=500)
        if looks:
            open_of(session, "B")
            session.press("tab")
            session.press("escape")
            session.press("escape")
        session.run(steps=500)
        states.append(session.particles.displacement.copy())
    assert same(*states)


def test_a_click_on_another_element_shows_that_one(session: Session) -> None:
    scene = open_of(session, "AB")
    session.view.camera.viewport = Viewport(0, 0, 1000, 720)
    entered(session, "stiffness", "5")
    session.click(2.0, 0.0)
    assert session.scene == "properties"
    assert scene.form.heading == "particle C"
    assert session.rods["AB"].stiffness == 5.0
    assert session.model.tagged(Selected) == [session.particles["C"]]


# --- where it is -------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", SIZES)
def test_tab_scrolls_to_the_box_and_a_click_there_selects_it(session: Session, size: tuple[int, int]) -> None:
    session.view.camera.viewport = Viewport(0, 0, *size)
    scene = open_of(session, "B")
    for _ in scene.form.boxes:
        session.press("tab")
        box = scene.form.selected
        assert box is not None
        place = layout_of(session).place_of(box)
        assert place is not None
        session.press("escape")
        session.press("click", (place.left + place.width / 2, place.top + place.height / 2))
        assert scene.form.selected is box


def test_the_window_keeps_its_size_and_the_model_is_seen_beside(session: Session) -> None:
    session.view.camera.viewport = Viewport(0, 0, 1000, 720)
    open_of(session, "B")
    (_, beside), (_, form), _ = session.stages
    assert form.aside is not None
    assert session.view.strip.width + beside.canvas.width + form.aside.width == 1000
    assert session.view.camera.viewport == Viewport(0, 0, 1000, 720)
    pixels = beside.camera.to_pixels(session.particles.position)
    assert (pixels[:, 0] >= beside.canvas.left).all()
    assert (pixels[:, 0] <= beside.canvas.left + beside.canvas.width).all()


def test_a_model_for_which_there_is_room_stays_in_its_place(session: Session) -> None:
    session.resize(1920, 1080)
    session.view.camera.scale = 200.0
    open_of(session, "A")
    (_, beside), *_ = session.stages
    assert (beside.camera.scale, beside.camera.centre) == (200.0, session.view.camera.centre)
    session.press("escape")
    session.resize(1000, 720)
    session.view.camera.scale = 2000.0
    session.view.fitted = False
    open_of(session, "A")
    (_, beside), *_ = session.stages
    assert beside.camera.scale == 2000.0, "a person who looks closer goes on doing so"


def test_typing_brings_back_a_box_that_was_scrolled_away(session: Session) -> None:
    session.resize(640, 480)
    session.press("return")
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    box = next(iter(scene.form.boxes))
    session.click_box(box.title)
    for _ in range(10):
        session.press("wheel down")
    assert scene.layout(session).place_of(box) is None
    session.type("1")
    assert scene.layout(session).place_of(box) is not None


def test_page_keys_scroll_by_pages_and_tab_brings_back_the_section(session: Session) -> None:
    session.resize(640, 480)
    session.press("ctrl+a")
    session.press("return")
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    _, shown, _ = scene.layout(session).paper.scrolled
    assert shown > 2
    session.press("page down")
    assert scene.layout(session).paper.scrolled[0] == shown - 1
    for _ in range(20):
        session.press("page down")
    first, shown, count = scene.layout(session).paper.scrolled
    assert first + shown == count
    session.press("tab")
    assert scene.form.selected is scene.form.boxes[0]
    assert scene.layout(session).paper.scrolled[0] == 0


def test_boxes_stand_where_they_are_drawn_before_any_picture() -> None:
    """Else a recorded click hits another box when it is played."""
    session = Session.open("isostatic")
    session.resize(1000, 720)
    session.select(session.particles["B"])
    session.press("return")
    scene = session.scenes.active
    assert isinstance(scene, Properties)
    before = [(place.left, place.top) for place in scene.layout(session).places]
    session.frame(0.0)
    assert list(session.stages)
    assert [(place.left, place.top) for place in scene.layout(session).places] == before


# --- lists ---------------------------------------------------------------------------------------------


def listed(session: Session, title: str) -> list[str]:
    """Click a box, and what the list that opens has."""
    session.resize(1280, 800)
    place = layout_of(session).place_of(box_of(session, title))
    assert place is not None
    session.press("click", place.middle)
    assert session.view.menu is not None
    return [entry.title for entry in session.view.menu.entries]


def entry_of(session: Session, word: str) -> tuple[float, float]:
    """The middle of an entry of the open list, as the picture has it."""
    session.update_view()
    hits = [hit for picture in composed(session) for hit in picture.hits if hit.action == "choose word"]
    assert session.view.menu is not None
    number = [entry.title for entry in session.view.menu.entries].index(word)
    return next(hit.middle for hit in hits if hit.item == number)


def test_a_list_opens_by_a_click_and_a_click_chooses() -> None:
    bent = cantilever()
    open_of(bent, "AB")
    words = listed(bent, "material")
    assert words[0] == "none"
    assert "S355" in words
    bent.press("click", entry_of(bent, "S355"))
    assert bent.view.menu is None
    assert bent.rods["AB"].material == "S355"
    assert bent.scene == "properties"
    bent.press("escape")
    bent.undo()
    assert bent.rods["AB"].material is None


def test_a_list_is_gone_through_by_keys_and_closes_where_something_is_typed(session: Session) -> None:
    open_of(session)
    words = listed(session, "integrator")
    session.press("down")
    session.press("down")
    session.press("return")
    assert session.settings.integrator == words[1]
    listed(session, "integrator")
    session.press("escape")
    assert session.view.menu is None
    assert session.settings.integrator == words[1]
    listed(session, "integrator")
    session.type("r")
    assert session.view.menu is None
    session.press("return")
    assert session.settings.integrator == "rk4"


def test_boxes_are_as_wide_as_what_they_hold_and_grow_with_it(session: Session) -> None:
    session.resize(1280, 800)
    open_of(session, "B")

    def width(title: str) -> float:
        place = layout_of(session).place_of(box_of(session, title))
        assert place is not None
        return place.width

    short = width("original position x")
    assert short == width("original position y") < layout_of(session).width / 2
    session.click_box("original position x")
    session.type("100.123456789012")
    assert short < width("original position x") <= layout_of(session).width / 2
