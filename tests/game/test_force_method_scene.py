"""The force method as a person goes through it, by the real scenes and keys."""

from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.camera import Camera
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.documents import models
from pinjoint.editor.scenes.methods import ForceMethod
from pinjoint.methods import PARTS, words
from pinjoint.methods.copies import elastic_copy
from pinjoint.methods.guide import ForceGuide as Guide
from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.model.sheet import measure
from pinjoint.systems.render.picture import compose, compose_all
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.overlays import MEANINGS, meanings_of
from pinjoint.systems.render.ui.page import draw_page
from pinjoint.systems.statics.theory import linear
from tests.benchmarks.models import lattice
from tests.reference.models import model, square


def guide_of(session: Session) -> Guide:
    scene = session.scenes.active
    assert isinstance(scene, ForceMethod)
    assert scene.guide is not None
    return scene.guide


def asked(session: Session) -> Guide:
    """Go to part 2, which asks what to release."""
    session.press("k")
    session.press("k")
    return guide_of(session)


def test_seven_parts_from_pause_to_pause() -> None:
    session = Session.open("hyperstatic")
    before = models.document(session.model)
    session.press("k")
    assert session.scene == "force method"
    guide = guide_of(session)
    assert (guide.part, len(guide.sets)) == (1, 1)
    assert words.working(guide)[0] == "g = m + r − 2n = 6 + 3 − 2·4 = 1"
    session.frame(1 / 60)
    assert guide.sets[0].model.clock.steps > 0
    session.click(0.5, 1.0)
    assert session.notice == "Press K first: part 2 asks which rod or support to release."
    session.press("k")
    assert session.notice == ""
    assert words.message(guide) == "Choose a rod or a support to release"
    session.press("k")
    assert guide.part == 2  # nothing was picked yet
    session.click(0.5, 1.0)
    assert guide.part == 3
    assert guide.unknown is not None
    assert guide.unknown.name == "BD"
    assert "BD" not in guide.sets[1].model.rods
    for part in (4, 5, 6, 7):
        session.press("k")
        assert guide.part == part
        session.frame(1 / 60)
    assert guide.solution is not None
    assert guide.solution.force[0] == pytest.approx(-14.6446609406726, rel=1e-12)
    assert "−14.64 kN" in words.working(guide)[0]
    assert words.table(guide)[-1][:2] == ("BD", "−14.64")
    session.press("k")
    assert session.scene == "pause"
    assert models.document(session.model) == before  # the person's model was only read


def test_the_base_structure_keeps_all_nodal_masses_and_set_3_only_has_the_unit_force() -> None:
    session = Session.open("hyperstatic")
    session.press("k")
    guide = guide_of(session)
    session.press("k")
    session.click(0.5, 1.0)
    for _ in range(2):
        session.press("k")
    assert guide.sets[1].model.particles.mass.tolist() == session.model.particles.mass.tolist()
    unit = guide.sets[2].model
    assert abs(unit.particles.force).sum(axis=0).tolist() == pytest.approx([2 * 0.5**0.5, 2 * 0.5**0.5])
    assert unit.particles.force.sum() == 0.0


def test_a_particle_constrained_in_both_directions_asks_which() -> None:
    session = Session.open("three_bar_plastic")
    guide = asked(session)
    support = next(p for p in session.particles if p.fixed == (True, True))
    session.click(*support.position)
    assert words.message(guide) == "Which direction of the support?"
    session.press("y")
    assert guide.released or "mechanism" in guide.refusal


def test_a_rod_that_is_not_redundant_is_refused_and_the_method_goes_on() -> None:
    session = Session.open("isostatic")
    guide = asked(session)
    session.click(0.5, 0.5)
    assert guide.part == 2
    assert "mechanism" in words.message(guide)


def test_where_there_is_no_room_for_three_the_newest_set_is_shown_or_the_one_to_pick_from() -> None:
    session = Session.open("hyperstatic")
    session.resize(400, 300)
    session.press("k")
    seen = []
    for part in range(1, 8):
        (_, first) = session.stages[0]
        captions = [view.caption[0] for _, view in session.stages[:-3] if view.caption]
        seen.append([caption[:5] for caption in captions])
        if part == 2:
            session.click(0.5, 0.5)
            assert guide_of(session).unknown is not None
        else:
            session.press("k")
        assert first.camera.viewport.width == session.view.canvas.width
    assert seen == [["Set 1"], ["Set 1"], ["Set 2"], ["Set 2"], ["Set 3"], ["Set 3"], ["Set 3"]]
    session.resize(640, 480)
    session.press("k")
    assert len({view.camera.viewport for _, view in session.stages[:3]}) == 3


def test_a_support_without_rods_is_refused() -> None:
    session = Session.open("hyperstatic")
    session.model.create(Particle, position=[(3.0, 0.0)], fixed=[(True, False)])
    session.press("k")
    session.press("k")
    session.click(3.0, 0.0)
    assert guide_of(session).part == 2
    assert "no rod ends at particle 1" in words.message(guide_of(session))


def test_a_click_is_picked_where_it_is_seen_even_before_the_first_picture() -> None:
    """A recording is played without pictures; the sets are where they were when it was made."""
    seen, unseen = Session.open("hyperstatic"), Session.open("hyperstatic")
    for session in (seen, unseen):
        session.press("k")
        session.press("k")
    seen.update_view()
    stages = seen.stages  # as drawing does
    assert len(stages) > 3
    pixel = tuple(guide_of(seen).sets[0].view.camera.to_pixels((0.5, 1.0)).tolist())
    for session in (seen, unseen):
        session.press("click", pixel)
        assert guide_of(session).unknown is not None
        assert guide_of(session).unknown.name == "BD"


def released(session: Session, *names: str, part: int = PARTS) -> Guide:
    """Go through all parts, or to one of them, with these unknowns."""
    guide = asked(session)
    for name in names:
        guide.pick(guide.sets[0].model.rods[name])
    while guide.part < part:
        session.press("k")
    return guide


def test_the_mechanism_that_a_refused_release_would_leave_is_shown_and_swings() -> None:
    session = Session.open("isostatic")
    session.press("k")
    session.press("k")
    session.click(0.5, 0.5)
    guide = guide_of(session)
    assert "Without AB the structure is a mechanism" in words.message(guide)
    assert guide.mechanism is not None
    assert "AB" not in guide.mechanism.model.rods
    assert session.busy
    seen = []
    for _ in range(8):
        session.frame(0.1)
        seen.append(guide.mechanism.model.particles["B"].displacement)
    assert len(set(seen)) > 5
    rod = guide.mechanism.model.rods["BC"]  # nothing resists: the motion does not stretch what is left
    motion = guide.mechanism.model.particles.displacement
    assert abs((motion[2] - motion[1]) @ rod.difference) < 1e-12 * np.abs(motion).max()
    session.press("k")
    assert guide.mechanism is None


def test_a_structure_that_is_a_mechanism_already_is_shown_as_one() -> None:
    session = Session.open("pendulum")
    session.press("k")
    assert session.scene == "force method"
    heading = session.scenes.active.stages(session)[0][1].heading  # type: ignore[union-attr]
    assert "mechanism already (bob along y can move)" in heading
    assert session.busy
    session.press("escape")
    assert session.scene == "pause"


def on_two_pins() -> dict[str, Any]:
    """A square braced by both diagonals on two pins: g = 2."""
    document = square()
    document["particles"][0]["fixed"] = [True, True]
    return document


def test_all_unknowns_are_chosen_before_the_released_structure_is_shown() -> None:
    session = Session.open(on_two_pins())
    guide = asked(session)
    assert words.message(guide) == "Choose a rod or a support to release: number 1 of 2"
    guide.pick(guide.sets[0].model.rods["BD"])
    assert (guide.part, len(guide.sets)) == (2, 1)
    assert words.message(guide) == "Choose a rod or a support to release: number 2 of 2"
    assert words.working(guide) == ("X₁: rod BD: axial force, positive in tension",)
    guide.pick(guide.sets[0].model.rods["DA"])
    assert guide.part == 3
    assert not {"BD", "DA"} & set(guide.sets[1].model.rods.names)
    session.press("k")
    assert len(words.working(guide)) == 2  # δ₁₀ and δ₂₀
    seen = []
    while guide.part < PARTS:
        session.press("k")
        seen.append((guide.part, words.captions(guide)[2][1], guide.unknown.name if guide.unknown else ""))
    assert seen == [
        (5, "X₁ = 1", "BD"),
        (6, "X₁ = 1", "BD"),
        (5, "X₂ = 1", "DA"),
        (6, "X₂ = 1", "DA"),
        (7, "the unknowns below", "DA"),
    ]


def test_part_6_shows_the_products_of_unknowns() -> None:
    session = Session.open("tower")
    guide = released(session, "R0-R1", "R1-L2", part=6)
    session.press("k")
    session.press("k")
    assert words.working(guide)[0].endswith("δ₁₂ = Σ n₁ n₂ L/EA")
    table = words.table(guide)
    mixed = next(column for column, title in enumerate(table[0]) if title.startswith("n₁n₂L/EA"))
    assert guide.solution is not None
    found = float(table[-1][mixed].replace("−", "-"))
    assert found == pytest.approx(1e5 * guide.solution.flexibility[0, 1], rel=1e-3)  # 10⁻³ cm/kN


def test_some_unknowns_may_be_released_and_then_further_ones() -> None:
    session = Session.open(on_two_pins())
    guide = released(session, "BD")
    assert len(guide.released) == 1
    session.press("n")
    session.press("k")
    assert words.message(guide) == "First click the rod or the support to release, in set 1."
    guide.pick(guide.sets[0].model.rods["DA"])
    session.press("k")
    session.press("k")
    assert (guide.part, words.captions(guide)[2][1]) == (5, "X₂ = 1")


def test_it_is_done_for_two_unknowns() -> None:
    session = Session.open("tower")
    guide = released(session, "R0-R1", "R1-L2")
    assert [unknown.name for unknown in guide.released] == ["R0-R1", "R1-L2"]
    assert guide.solution is not None
    real = guide.solution.real.axial_force
    rows = [session.model.rods[name].row for name in ("R0-R1", "R1-L2")]
    assert guide.solution.force == pytest.approx(real[rows], rel=1e-9)
    assert len(guide.sets[1].model.rods) == session.model.rods.count - 2
    third = guide.sets[2]
    third.settle()
    unit = [solution.displacement for solution in guide.solution.units]
    expected = guide.solution.force[0] * unit[0] + guide.solution.force[1] * unit[1]
    largest = np.abs(expected).max()
    assert np.abs(third.model.particles.displacement - expected).max() < 0.02 * largest  # exact geometry
    assert "δ₁₀ + δ₁₁ X₁ + δ₁₂ X₂ = 0:" in words.working(guide)[0]
    assert "X₁ = −215.4 kN,  X₂ = −25.02 kN" in words.working(guide)[2]
    session.press("c")
    assert "Δ = Δ₀ + Σ Δ₁ p" in words.working(guide)[0]
    assert "p(R0-R1) = −215.4 kN,  p(R1-L2) = −25.02 kN" in words.working(guide)[2]


def test_the_degree_says_how_often() -> None:
    session = Session.open("hyperstatic")
    guide = released(session, "BD")
    assert guide.count.degree == 1
    assert not guide.can_release_another
    session.press("n")
    assert "Every unknown is released" in session.notice
    assert session.scenes.active.stages(session)[-2][1].heading == session.notice  # type: ignore[union-attr]
    assert "1 unknown to release" in words.degree_of(1)


def test_an_unknown_is_not_released_twice() -> None:
    session = Session.open("tower")
    guide = released(session, "R0-R1")
    session.press("n")
    guide.pick(guide.sets[0].model.rods["R0-R1"])
    assert words.message(guide) == "R0-R1 is released already; pick another one."


def cameras_of_sets(session: Session) -> list[Camera]:
    """The cameras of the three sets, before the message and the working."""
    return [view.camera for _, view in session.scenes.active.stages(session)[:-2]]


def test_all_sets_are_looked_at_alike() -> None:
    session = Session.open("hyperstatic")
    released(session, "BD")
    before = [(camera.centre, camera.scale) for camera in cameras_of_sets(session)]
    middle = cameras_of_sets(session)[1].middle
    session.press("wheel up", middle)
    session.press("drag middle", (10.0, 5.0))
    after = [(camera.centre, camera.scale) for camera in cameras_of_sets(session)]
    assert len({round(new[1] / old[1], 12) for old, new in zip(before, after, strict=True)}) == 1
    assert after[0][1] == pytest.approx(1.2 * before[0][1])
    session.press("home")
    assert [(camera.centre, camera.scale) for camera in cameras_of_sets(session)] == before


@pytest.mark.parametrize("size", [(240, 900), (320, 240), (1000, 700)])
def test_pictures_and_time_between_inputs_move_no_camera(size: tuple[int, int]) -> None:
    cameras = []
    for drawn in (True, False):
        session = Session.open("hyperstatic")
        session.resize(*size)
        for key in ("k", "t", "wheel up", "t", "i"):
            session.press(key, (100.0, 120.0))
            if drawn:
                session.frame(0.1)
                assert session.stages
        cameras.append([(camera.centre, camera.scale) for camera in cameras_of_sets(session)])
    assert cameras[0] == cameras[1]


def test_what_a_person_looks_at_stays_when_the_message_becomes_shorter() -> None:
    session = Session.open("hyperstatic")
    session.resize(240, 900)
    session.press("k")
    session.press("wheel up", (100.0, 200.0))
    before = cameras_of_sets(session)[0]
    looked_at, room = (before.centre, before.scale), before.viewport
    session.press("t")  # says less than the task does
    after = cameras_of_sets(session)[0]
    assert after.viewport != room
    assert (after.centre, after.scale) == looked_at


@pytest.mark.parametrize("size", [(640, 480), (1000, 700), (1920, 1080)])
def test_a_long_table_is_scrolled_with_the_wheel(size: tuple[int, int]) -> None:
    session = Session.open("tower")
    session.resize(*size)
    released(session, "R0-R1")
    page = session.stages[-2][1].page
    assert page is not None
    assert {"rod", "N (kN)", page.table[1][0]} <= texts_of_the_working(session)
    for _ in range(len(page.table)):
        session.press("wheel down", session.stages[-2][1].camera.viewport.middle)
    assert {"rod", page.table[-1][0]} <= texts_of_the_working(session)


def texts_of_the_working(session: Session) -> set[str]:
    model, view = session.stages[-2]  # the last stage is the toolbar
    assert isinstance(model, Model)
    return {
        mark.text for mark in draw_page(measure(model, view, load_theme("light"))) if isinstance(mark, Text)
    }


def test_displacements_of_all_sets_are_drawn_to_one_scale_in_every_part() -> None:
    """Else the released structure, which moves further, would look stiffer than the real one."""
    session = Session.open("hyperstatic")
    guide = released(session, "BD", part=3)
    for part in range(3, PARTS + 1):
        assert guide.part == part
        assert {one.model.settings.displacement_scale for one in guide.sets} == {100.0}
        if part == PARTS:  # where they add up
            assert len({one.model.settings.diagram_scale for one in guide.sets}) == 1
        session.press("k")


def test_the_slider_of_the_displacements_scales_all_sets_and_those_to_come() -> None:
    session = Session.open("hyperstatic")
    session.resize(1000, 720)
    guide = asked(session)
    guide.pick(guide.sets[0].model.rods["BD"])
    scales = {one.model.settings.displacement_scale for one in guide.sets}
    [place] = session.stages[0][1].slider_places
    left, right, y = place.track
    session.press("drag", ((left + right) / 2, y))
    session.press("drag to", (right, y))
    session.press("drop", (right, y))
    session.press("k")
    session.press("k")
    assert len(guide.sets) == 3
    assert {one.model.settings.displacement_scale for one in guide.sets} == {1000.0}
    session.press("double click", (left, y))
    assert {one.model.settings.displacement_scale for one in guide.sets} == scales


def test_a_large_structure_is_worked_on_after_a_picture_that_says_so() -> None:
    """Who asks for the guide, such as the next key, does not wait for a picture."""
    session = Session(lattice(600))
    session.press("k")
    session.frame(1 / 60)
    assert "Solving the structure" in "".join(said(session))
    assert session.busy
    session.frame(1 / 60)
    assert "Real structure under the real load" in "".join(said(session))
    assert guide_of(session).sets[0].model.clock.steps > 0
    session.press("k")
    assert "Computing part 2" in "".join(said(session))
    session.click(0.0, 6.0)
    session.press("x")
    assert "Releasing it" in "".join(said(session))
    session.press("k")
    assert guide_of(session).part == 3
    session.press("k")
    session.press("escape")
    assert session.scene == "pause"


def said(session: Session) -> list[str]:
    """All texts in the window."""
    marks = (mark for picture in compose_all(session.stages, load_theme("light")) for mark in picture.marks)
    return [mark.text for mark in marks if isinstance(mark, Text)]


def is_meaning(text: str) -> bool:
    """True for what a legend says of a colour, in whatever units."""
    return text.split(" (kN")[0] in {meaning.split(" (kN")[0] for meaning in MEANINGS.values()}


@pytest.mark.parametrize("size", [(640, 480), (1024, 640), (480, 800), (1920, 1080)])
@pytest.mark.parametrize("source", ["hyperstatic", "tower", "pendulum"])
def test_the_legend_explains_what_the_sets_show_in_every_part(source: str, size: tuple[int, int]) -> None:
    """All of it and no more, wholly in the window; Tab puts it away and brings it back."""
    session = Session.open(source)
    session.resize(*size)
    session.press("k")
    theme = load_theme("light")
    for key in ("", "i", "k", "click", *("k",) * 4):
        if key == "click":
            first, last = session.rods[-1].ends
            session.click(*np.add(np.multiply(first.position, 0.3), np.multiply(last.position, 0.7)))
        elif key:
            session.press(key)
        session.frame(1 / 60)
        pictures = compose_all(session.stages, theme)
        head = next(
            picture for picture, (_, view) in zip(pictures, session.stages, strict=True) if view.explains_all
        )
        shown = {meaning for picture in pictures for meaning in picture.meanings}
        words = set(meanings_of(sorted(shown)).values())
        explained = [mark for mark in head.marks if isinstance(mark, Text) and is_meaning(mark.text)]
        assert {mark.text for mark in explained} == words
        assert all(mark.y + mark.size / 2 < head.viewport.bottom for mark in explained)
    assert (source == "pendulum") == (session.scenes.active.shown_guide is None)  # type: ignore[attr-defined]
    explained_last = {text for text in said(session) if is_meaning(text)}
    for left in (set(), explained_last):
        session.press("tab")
        assert {text for text in said(session) if is_meaning(text)} == left


@pytest.mark.parametrize("width", [600, 1020, 1280])
def test_the_legend_of_a_frame_stands_above_the_sets_in_every_part_of_the_displacement_method(
    width: int,
) -> None:
    session = Session.open("portal")
    session.resize(width, 800)
    session.press("ctrl+k")
    for _ in range(10):
        session.press("k")
        session.frame(1 / 60)
        [head] = [
            picture
            for picture, (_, view) in zip(
                compose_all(session.stages, load_theme("light")), session.stages, strict=True
            )
            if view.explains_all
        ]
        explained = [mark for mark in head.marks if isinstance(mark, Text) and is_meaning(mark.text)]
        assert all(mark.y + mark.size / 2 < head.viewport.bottom for mark in explained)
    assert session.scene == "displacement method"


def test_while_a_direction_is_asked_for_the_next_part_asks_again() -> None:
    session = Session.open("portal")
    for _ in range(2):
        session.press("k")
    guide = guide_of(session)
    guide.pick(guide.sets[0].model.particles["A"])
    session.press("k")
    assert words.message(guide) == "Which direction of the support?"


@pytest.mark.parametrize("force", [1e-35, 1e29])
def test_forces_of_any_size_are_drawn(force: float) -> None:
    session = Session.open("hyperstatic")
    session.particles["C"].force = 0.0, -force
    for _ in range(4):
        session.press("k")
    assert session.scene == "force method"
    assert np.isfinite(guide_of(session).sets[0].model.settings.diagram_scale)


def test_a_copy_is_elastic_undisplaced_and_at_rest_and_keeps_what_else_was_drawn() -> None:
    session = Session.open("hyperstatic_yield")
    session.rods["AC"].temperature_change = 20.0
    session.model.environment.acceleration = (0.0, -9.81)
    session.run(time=0.01)
    session.model.writable("rods.plastic_strain")[2] = 1e-3
    copy = elastic_copy(session.model)
    expected = models.document(session.model)
    del expected["state"]
    for particle in expected["particles"]:
        for key in ("displacement", "velocity"):
            particle.pop(key, None)
    expected["settings"]["plasticity"] = False
    found = models.document(copy)
    assert found.pop("settings") == expected.pop("settings")
    for key in ("environment", "particles", "rods", "loads"):
        assert found.get(key) == expected.get(key), key


def test_a_single_support_that_was_moved_is_drawn_to_scale() -> None:
    model = Model()
    model.create(Particle, 1, position=[(0.0, 0.0)], displacement=[(0.016, 0.0)], fixed=[(True, True)])
    session = Session(model)
    session.press("k")
    assert session.stages[0][0].settings.displacement_scale == 1.0


def test_it_is_said_while_forces_and_displacements_are_not_final() -> None:
    session = Session.open("hyperstatic")
    session.press("k")
    assert any("still moving" in view.status.hint for _, view in session.stages)
    while guide_of(session).moving:
        session.frame(1 / 60)
    assert not any("still moving" in view.status.hint for _, view in session.stages)


# --- frames, conventions, report -------------------------------------------------------------------


def test_both_conventions_have_the_same_parts_and_unknowns() -> None:
    session = Session.open("hyperstatic")
    guide = released(session, "BD")
    textbook = words.working(guide), words.table(guide)[0], words.message(guide)
    assert textbook[0][0] == "δ₁₀ + δ₁₁ X₁ = 0:  0.064423 + 0.0043991 X₁ = 0  (cm, kN),  X₁ = −14.64 kN"
    session.press("c")
    assert guide.part == PARTS
    assert "p = (Δ − Δ₀) / Δ₁" in session.notice
    assert words.working(guide)[0].startswith(
        "p = (Δ − Δ₀) / Δ₁ = (−0.01887 − (−0.06442)) cm / (−0.003111 cm/kN)"
    )
    assert words.message(guide) == "Set 2 + set 3 = set 1"
    assert words.table(guide)[0] == ("kN", "set 1", "= set 2", "+ set 3", "residual")
    session.press("c")
    assert (words.working(guide), words.table(guide)[0], words.message(guide)) == textbook


def test_part_6_shows_the_virtual_work_of_every_rod() -> None:
    session = Session.open("hyperstatic")
    guide = released(session, "BD", part=6)
    assert words.working(guide) == ("δ₁₀ = Σ N₀ n₁ L/EA,  δ₁₁ = Σ n₁² L/EA > 0",)
    rows = {row[0]: row[1:] for row in words.table(guide)}
    assert rows["CD"] == ("150.0", "164640", "−100.0", "−0.7071", "0.06442", "0.45554")
    assert rows["Σ"][-2:] == ("0.06442", "4.39908")


@pytest.mark.parametrize(("key", "name"), [("x", "D.x"), ("y", "D.y"), ("m", "D.rotation")])
def test_a_clamp_asks_which_of_its_reactions(key: str, name: str) -> None:
    session = Session.open("portal")
    guide = asked(session)
    session.click(*session.model.particles["D"].position)
    assert "M moment" in words.hint(guide)
    session.press(key)
    assert [unknown.name for unknown in guide.released] == [name]
    assert not session.busy  # frames stay still
    session.press("m")
    assert session.notice == "Click a clamped support first; then M releases its moment."


@pytest.mark.parametrize(("share", "name"), [(0.2, "BC.start"), (0.7, "BC.end")])
def test_a_click_near_an_end_of_a_rod_that_bends_releases_the_moment_there(share: float, name: str) -> None:
    session = Session.open("portal")
    guide = asked(session)
    start, end = (np.array(particle.position) for particle in session.model.rods["BC"].ends)
    session.click(*((1.0 - share) * start + share * end).tolist())
    assert guide.unknown is not None
    assert guide.unknown.name == name
    session.press("k")
    assert guide.sets[1].model.rods["BC"].hinged == (name == "BC.start", name == "BC.end")


def test_sets_of_a_frame_show_the_forces_of_first_order_theory_and_add_up() -> None:
    session = Session.open("portal")
    guide = asked(session)
    session.click(*session.model.particles["D"].position)
    session.press("x")
    for _ in range(5):
        session.press("k")
    moments = [one.model.rods.bending_moment for one in guide.sets]
    theory = linear(session.model).diagrams["bending_moment"]
    assert moments[0] == pytest.approx(theory, rel=1e-9, abs=1e-9)
    assert moments[1] + moments[2] == pytest.approx(theory, rel=1e-9, abs=1e-9)
    reactions = [one.model.particles.reaction for one in guide.sets]
    assert reactions[0][0] == pytest.approx(reactions[1][0] + reactions[2][0], rel=1e-9)
    quantities = []
    for _ in range(3):
        session.press("i")
        quantities.append({one.view.quantity for one in guide.sets})
    assert quantities == [{"V"}, {"N"}, {"M"}]
    assert words.table(guide)[0][:2] == ("rod", "M (kN·m)")
    session.press("k")
    assert session.scene == "pause"


def test_a_mechanism_of_a_frame_swings() -> None:
    session = Session.open(three_hinged())
    guide = asked(session)
    session.click(0.4, 0.4)
    assert "the structure is a mechanism" in words.message(guide)
    session.frame(0.1)
    assert guide.mechanism is not None
    assert guide.mechanism.model.particles.displacement.any()


def three_hinged() -> dict[str, Any]:
    """An arch of two rods, rigid at the kink, hinged at both feet and at the top."""
    rod = {"bending_stiffness": 5000.0}
    particles = [
        {"name": "A", "position": [0, 0], "fixed": [True, True]},
        {"name": "B", "position": [1, 1]},
        {"name": "C", "position": [2, 1], "force": [0, -10]},
        {"name": "D", "position": [3, 0], "fixed": [True, True]},
    ]
    rods = [
        {"name": "AB", "between": ["A", "B"], **rod, "hinged": [True, False]},
        {"name": "BC", "between": ["B", "C"], **rod, "hinged": [False, True]},
        {"name": "CD", "between": ["C", "D"], **rod},
    ]
    return model(particles, rods)


def test_the_report_is_saved_in_the_last_part() -> None:
    saved: dict[str, bytes] = {}

    class Host:
        def save(self, name: str, contents: bytes) -> str:
            saved[name] = contents
            return f"/somewhere/{name}"

    session = Session.open("hyperstatic")
    session.window = Host()
    session.press("k")
    session.press("p")
    assert session.notice == "Go through all parts first, with K; then P writes the report."
    session.press("k")
    guide = guide_of(session)
    guide.pick(guide.sets[0].model.rods["BD"])
    for _ in range(4):
        session.press("k")
    session.press("p")
    assert session.notice == "Report saved: /somewhere/pinjoint-force-method.pdf"
    assert saved["pinjoint-force-method.pdf"].startswith(b"%PDF")


@pytest.mark.parametrize("size", [(1024, 768), (1280, 800)])
def test_sets_stand_still_and_tell_both_parts_of_a_load(size: tuple[int, int]) -> None:
    session = Session.open("hyperstatic")
    session.resize(*size)
    session.particles["C"].force = (10.0, -20.0)
    for key in "ki":
        session.press(key)
    places = set()
    for _ in range(5):
        session.frame(1 / 60)
        model, view = session.stages[0]
        assert isinstance(model, Model)
        places.add(tuple(view.camera.to_pixels([[0.0, 0.0]])[0].tolist()))
        load = load_theme("light").load
        marks = compose(model, view, load_theme("light")).marks
        told = [mark.text for mark in marks if isinstance(mark, Text) and mark.colour == load]
        assert {text.split()[0] for text in told} >= {"10", "20"}
        session.press("k")
        if guide_of(session).part == 2:
            session.click(0.5, 1.0)
    assert len(places) == 1
