"""Sliders on the canvas: what they move, live and undoable, how they are made, removed, saved and refused."""

from types import SimpleNamespace
from typing import Any

import pytest

from pinjoint.components.slider import Place, Slider
from pinjoint.documents import models
from pinjoint.editor.sliders import add_slider
from pinjoint.editor.view_model import exaggerate, offer_tools
from pinjoint.session import Session
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import pick

FORCE = {"of": "particles.B.force.x", "from": 0, "to": 240}
STIFFNESS = {"of": "rods.*.stiffness", "from": 1e4, "to": 1e6, "logarithmic": True, "title": "EA"}


def opened(*sliders: dict[str, Any], name: str = "isostatic") -> Session:
    content = models.document(models.load(name)) | ({"sliders": list(sliders)} if sliders else {})
    session = Session.open(content)
    session.resize(1000, 720)
    return session


def place(session: Session, title: str) -> Place:
    offer_tools(session)
    return next(p for p in session.view.slider_places if title in p.control.title)


def at(where: Place, share: float) -> tuple[float, float]:
    left, right, middle = where.track
    return left + share * (right - left), middle


def slide(session: Session, title: str, *shares: float) -> None:
    where = place(session, title)
    session.press("drag", at(where, where.control.share or 0.0))
    for share in shares:
        session.press("drag to", at(where, share))
    session.press("drop", at(where, shares[-1]))


# --- the displacement scale ----------------------------------------------------------------------------------


def test_the_displacement_scale_is_dragged_and_goes_back_to_automatic() -> None:
    session = opened()
    where = place(session, "displacements")
    exaggerate(session)
    assert (place(session, "displacements").control.value, where.control.pressed) == ("× 100", True)
    slide(session, "displacements", 0.0)
    assert session.settings.displacement_scale == 1.0
    slide(session, "displacements", 0.7, 1.0)
    assert (session.settings.displacement_scale, len(session.document.history._done)) == (1000.0, 2)
    assert not place(session, "displacements").control.pressed
    button = where.button
    session.press("click", (button.left + 3, button.top + 3))
    assert session.settings.prescribed_displacement_scale is None
    assert session.settings.displacement_scale == 100.0
    session.press("click", (button.left + 3, button.top + 3))
    assert session.settings.prescribed_displacement_scale == 100.0  # kept from now on
    session.settings.displacement_scale = 20_000.0
    session.update_view()
    assert place(session, "displacements").control.value == "× 20000"


def test_without_rods_or_with_the_legend_hidden_there_is_no_slider() -> None:
    assert opened(name="newtons_cradle").view.slider_places == []
    session = opened(FORCE)
    assert len(session.view.slider_places) == 2
    session.press("tab")
    assert session.view.slider_places == []


def test_a_click_beside_the_knob_takes_it_there_and_selects_nothing() -> None:
    session = opened()
    session.press("click", at(place(session, "displacements"), 1.0))
    assert session.settings.displacement_scale == 1000.0
    assert not session.selected
    x, y = at(place(session, "displacements"), 0.4)
    assert pick(session.model, session.view, (x, y)) is None


def test_the_wheel_moves_a_slider_and_does_not_zoom() -> None:
    session = opened(FORCE)
    scale = session.view.camera.scale
    for _ in range(3):
        session.press("wheel up", at(place(session, "B: load x"), 0.2))
    assert 130.0 < session.particles["B"].force[0] < 140.0  # three times 2 % of the length
    assert session.view.camera.scale == scale
    assert len(session.document.history._done) == 1


def test_the_slider_of_a_load_that_grows_says_how_much_of_it_acts_now() -> None:
    session = Session.open("portal")
    session.resize(1024, 640)
    session.update_view()
    assert place(session, "wind").control.value == "35 kN, now 0 %"
    session.run(time=0.75)
    session.update_view()
    assert place(session, "wind").control.value == "35 kN, now 50 %"
    session.run(time=0.3)
    session.update_view()
    assert place(session, "wind").control.value == "35 kN"


# --- any property --------------------------------------------------------------------------------------------


def test_a_slider_moves_its_number_and_one_drag_is_one_edit() -> None:
    session = opened(FORCE)
    assert place(session, "B: load x").control.value == "120 kN"
    slide(session, "B: load x", 0.6, 0.7, 1.0)
    assert session.particles["B"].force == (240.0, -160.0)
    assert session.undo() == "B: load x"
    assert session.particles["B"].force == (120.0, -160.0)
    assert not session.document.history.can_undo
    session.redo()
    assert session.particles["B"].force == (240.0, -160.0)


def test_all_targets_get_the_same_value() -> None:
    session = opened(STIFFNESS, {"of": ["rods.AB.stiffness", "rods.BC.damping"], "from": 10, "to": 1000})
    slide(session, "EA", 1.0)
    assert set(session.rods.stiffness) == {1e6}
    slide(session, "AB: stiffness", 0.0)
    assert (session.rods["AB"].stiffness, session.rods["BC"].damping) == (10.0, 10.0)
    session.undo()
    assert (session.rods["AB"].stiffness, session.rods["BC"].damping) == (1e6, 100.0)


def test_a_drag_while_time_passes_acts_live_and_is_one_edit() -> None:
    session = opened(FORCE)
    session.press("space")
    for _ in range(3):
        session.frame(0.016)
    before, time, where = session.particles["B"].displacement, session.time, place(session, "B: load x")
    session.press("drag", at(where, 0.5))
    for n in range(1, 11):
        session.press("drag to", at(where, 0.5 + 0.05 * n))
        session.frame(0.016)
    session.press("drop", at(where, 1.0))
    end, late = session.particles["B"].displacement, session.time
    assert late > time
    assert end != before
    session.press("space")
    session.undo()  # what passed since the drag, if anything did
    if session.particles["B"].force[0] != 120.0:
        session.undo()
    assert (session.particles["B"].force, session.time) == ((120.0, -160.0), time)
    assert session.particles["B"].displacement == before
    while session.document.history.can_redo:
        session.redo()
    assert session.particles["B"].force == (240.0, -160.0)
    assert session.time == late
    assert session.particles["B"].displacement == end


def test_escape_in_a_drag_while_time_passes_puts_the_value_back_and_keeps_the_time() -> None:
    session = opened(FORCE)
    session.press("space")
    session.frame(0.016)
    where = place(session, "B: load x")
    session.press("drag", at(where, 0.5))
    session.press("drag to", at(where, 1.0))
    session.frame(0.016)
    time = session.time
    session.press("escape")
    assert (session.particles["B"].force, session.time, session.scene) == ((120.0, -160.0), time, "simulation")


def test_a_value_that_cannot_be_is_said_and_not_taken() -> None:
    session = opened({"of": "settings.restitution", "from": 0, "to": 1})
    session.model.sliders = (Slider(session.model.sliders[0].aims, 0.0, 2.0),)
    slide(session, "restitution", 1.0)
    assert session.settings.restitution == 1.0
    slide(session, "restitution", 0.9)
    assert "at most 1" in session.notice
    assert session.settings.restitution == 1.0


# --- making and removing -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("select", "title", "share"),
    [(("rods", "AB"), "AB: stiffness", 0.5), (("particles", "B"), "B: load y", 0.4)],
)
def test_q_makes_a_slider_for_what_is_selected(select: tuple[str, str], title: str, share: float) -> None:
    session = opened()
    session.press("ctrl+l")
    assert "Select" in session.notice
    session.select(session.table(select[0])[select[1]])
    session.press("ctrl+l")
    assert place(session, title).control.share == pytest.approx(share, abs=0.11)
    session.press("ctrl+l")
    assert "already" in session.notice
    assert len(session.model.sliders) == 1
    assert session.undo() == "new slider"
    assert not session.model.sliders
    session.redo()
    assert len(session.model.sliders) == 1


def test_its_button_removes_it_and_undo_brings_it_back() -> None:
    session = opened(FORCE)
    button = place(session, "B: load x").button
    session.press("click", (button.left + 3, button.top + 3))
    assert not session.model.sliders
    assert "Ctrl+Z" in session.notice
    session.undo()
    assert len(session.model.sliders) == 1


@pytest.mark.parametrize(
    ("table", "field", "axis", "range_"),
    [
        ("rods", "temperature_change", "", (-50.0, 50.0)),
        ("rods", "rest_length", "", (0.5, 1.5)),
        ("rods", "tensile_strength", "", (0.0, 500.0)),
        ("particles", "position", "x", (-0.5, 0.5)),
        ("particles", "radius", "", (0.025, 0.075)),
        ("settings", "restitution", "", (0.0, 1.0)),
        ("environment", "acceleration", "y", (-10.0, 10.0)),
    ],
)
def test_any_number_can_have_a_slider(table: str, field: str, axis: str, range_: tuple[float, float]) -> None:
    session = opened()
    element = session.model.tables[table][0]
    slider = add_slider(session, [element], field, axis)
    start = element.rest_length if field == "rest_length" else 1.0
    offset = element.position[0] if field == "position" else 0.0
    assert (slider.first, slider.last) == pytest.approx([end * start + offset for end in range_])
    slide(session, session.view.slider_places[-1].control.title, 0.75)
    assert session.document.history.can_undo


def test_a_box_of_properties_makes_one_for_its_number() -> None:
    session = opened()
    session.select(session.particles["B"])
    session.press("return")
    session.press("ctrl+l")
    assert "Click the box" in session.notice
    for box in ("name", "load y", "radius"):
        session.click_box(box)
        session.press("ctrl+l")
    session.press("escape")
    session.press("escape")
    assert session.scene == "pause"
    titles = [p.control.title for p in session.view.slider_places]
    assert titles == ["displacements", "B: load y", "B: radius"]


def test_what_is_no_number_has_none() -> None:
    session = opened()
    rod, particle = session.rods["AB"], session.particles["B"]
    for elements, field in (
        ([rod], "name"),
        ([particle], "fixed"),
        ([particle], "force"),
        ([rod], "tension_only"),
    ):
        with pytest.raises(Refusal):
            add_slider(session, elements, field)
    rod.tensile_strength = None
    with pytest.raises(Refusal, match="unlimited; give it a number"):
        add_slider(session, [rod], "tensile_strength")


def test_a_slider_of_a_deleted_element_is_gone_until_undo() -> None:
    session = opened(FORCE, STIFFNESS)
    session.particles["B"].name = "top"
    assert place(session, "top: load x")
    session.select(session.particles["top"])
    session.press("delete")
    offer_tools(session)
    assert not [p for p in session.view.slider_places if "force" in p.control.title]
    assert [entry["of"] for entry in models.document(session.model)["sliders"]] == ["rods.*.stiffness"]
    session.undo()
    assert place(session, "top: load x")


# --- files ---------------------------------------------------------------------------------------------------


def test_sliders_are_saved_and_old_files_have_none() -> None:
    assert "sliders" not in models.document(models.load("isostatic"))
    saved = models.document(opened(FORCE, STIFFNESS).model)
    assert saved["sliders"] == [FORCE, STIFFNESS]
    again = models.load(saved)
    assert models.document(again) == saved


BAD: list[tuple[Any, str]] = [
    (3, r"\$\.sliders: it is 3; it must be a list"),
    ([3], r"\$\.sliders\[0\]: it is 3"),
    ([{"from": 0, "to": 1}], "its 'of' is missing"),
    ([FORCE | {"too": 1}], "no key 'too' here; did you mean 'to'"),
    ([FORCE | {"of": []}], "a path or a list of paths"),
    ([FORCE | {"of": "rods.ZZ.stiffness"}], r"\$\.sliders\[0\]\.of: rods.ZZ.stiffness: There is no 'ZZ'"),
    ([FORCE | {"of": "particles.B.force"}], "write force.x or force.y"),
    ([FORCE | {"of": "particles.B.name"}], "is not a number"),
    ([FORCE | {"of": "rods.AB.axial_force"}], "computed"),
    ([FORCE | {"of": "particles.B.force.x=3"}], "leave it out"),
    ([FORCE | {"to": 0}], "its ends must differ"),
    ([FORCE | {"to": True}], "finite number"),
    ([FORCE | {"to": 1e40}], "at most"),
    ([FORCE | {"logarithmic": True}], "both ends of a logarithmic slider must be above 0"),
    ([FORCE | {"logarithmic": 1}], "true or false"),
    ([FORCE | {"title": 1}], "it must be a text"),
    ([{"of": "rods.AB.stiffness", "from": 0, "to": 5}], "greater than 0"),
]


@pytest.mark.parametrize(("sliders", "message"), BAD)
def test_wrong_sliders_are_refused_by_their_path(sliders: Any, message: str) -> None:
    content = models.document(models.load("isostatic")) | {"sliders": sliders}
    with pytest.raises(models.ModelError, match=message):
        models.load(content)


# --- what is seen --------------------------------------------------------------------------------------------


def test_a_recording_replays_what_was_dragged() -> None:
    first, second = opened(FORCE), opened(FORCE)
    presses: list[Any] = []
    first.recorder = SimpleNamespace(press=lambda key, pixel: presses.append((key, pixel)))
    slide(first, "B: load x", 0.3, 0.9)
    slide(first, "displacements", 0.2)
    for key, pixel in presses:
        second.press(key, pixel)
    assert second.particles["B"].force == first.particles["B"].force != (120.0, -160.0)
    assert second.settings.displacement_scale == first.settings.displacement_scale


def test_a_new_slider_shows_all_sliders_where_they_were_hidden() -> None:
    session = opened()
    session.press("tab")
    session.select(session.rods["AB"])
    session.press("ctrl+l")
    assert "AB: stiffness" in [place.control.title for place in session.view.slider_places]


def test_what_was_settled_and_edited_is_said_to_be_out_of_equilibrium() -> None:
    """A slider of a stiffness changes forces at once; those of a settled structure are no answer then."""
    session = Session.open("isostatic")
    session.rods["AB"].stiffness *= 1.1
    session.update_view()
    assert session.view.status.notice == "", "it was neither run nor settled"
    session.settle()
    session.act("toggle diagrams")
    session.update_view()
    assert "equilibrium." in session.view.status.notice
    with session.model.transaction("stiffer"):
        session.rods["AB"].stiffness *= 2.0
    session.notice = ""
    session.update_view()
    assert (
        session.view.status.notice
        == "The model was edited and is no longer in equilibrium. Press E for the new equilibrium (right click: settle)."
    )
    session.undo()
    session.notice = ""
    session.update_view()
    assert session.view.status.notice == ""
    session.redo()
    session.settle()
    session.notice = ""
    session.update_view()
    assert session.view.status.notice == ""
