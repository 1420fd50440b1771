"""The force method as a person goes through it, by the real scenes and keys."""

from __future__ import annotations

import pytest

from components.particle import Particle
from game import Session, models
from game.force_method import Guide
from game.scenes.force_method import ForceMethod
from systems.render.picture import compose
from systems.render.theme import load_theme


def guide_of(session: Session) -> Guide:
    scene = session.scenes.active
    assert isinstance(scene, ForceMethod)
    assert scene.guide is not None
    return scene.guide


def test_seven_parts_from_pause_to_pause() -> None:
    session = Session.open("hyperstatic")
    before = models.document(session.model)
    session.press("k")
    assert session.scene == "force method"
    guide = guide_of(session)
    assert (guide.part, len(guide.sets)) == (1, 1)
    session.frame(1 / 60)
    assert guide.sets[0].model.clock.steps > 0
    session.press("k")
    assert guide.message == "Select the discontinuity element"
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
    assert "−14.64 kN" in guide.working()[0]
    assert guide.table()[-1][:2] == ("BD", "−14.64")
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
    session.press("k")
    session.press("k")
    guide = guide_of(session)
    support = next(p for p in session.particles if p.fixed == (True, True))
    session.click(*support.position)
    assert guide.message == "Select constraint direction"
    session.press("y")
    assert guide.part == 3 or "mechanism" in guide.refusal


def test_a_rod_that_is_not_redundant_is_refused_and_the_method_goes_on() -> None:
    session = Session.open("isostatic")
    session.press("k")
    session.press("k")
    guide = guide_of(session)
    session.click(0.5, 0.5)
    assert guide.part == 2
    assert "mechanism" in guide.message


def test_escape_leaves_at_once() -> None:
    session = Session.open("hyperstatic")
    session.press("k")
    session.press("escape")
    assert session.scene == "pause"


@pytest.mark.parametrize("size", [(640, 480), (1280, 800), (500, 900)])
def test_every_part_is_drawn_at_any_size(size: tuple[int, int]) -> None:
    from components.camera import Viewport

    session = Session.open("hyperstatic")
    session.view.camera.viewport = Viewport(0, 0, *size)
    session.press("k")
    theme = load_theme("light")
    for part in range(1, 8):
        guide = guide_of(session)
        assert guide.part == part
        session.update_view()
        texts = [text for model, view in session.stages for text in compose(model, view, theme).texts]
        assert f"Part {part} of 7" in texts
        if part == 2:
            session.stages  # noqa: B018 - places the views
            session.click(0.5, 1.0)
        else:
            session.press("k")


def test_a_support_without_rods_is_refused() -> None:
    session = Session.open("hyperstatic")
    session.model.create(Particle, position=[(3.0, 0.0)], fixed=[(True, False)])
    session.press("k")
    session.press("k")
    session.click(3.0, 0.0)
    assert guide_of(session).part == 2
    assert "no rod ends at particle 1" in guide_of(session).message


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
