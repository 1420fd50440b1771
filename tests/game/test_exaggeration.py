"""The automatic displacement scale: what it is, that it is steady, and that nothing but pictures depends on it."""

import itertools
from typing import Any

import numpy as np
import pytest

from pinjoint.components.view import drawn_positions
from pinjoint.documents import models
from pinjoint.documents.exaggeration import DRAWN, Exaggeration
from pinjoint.editor.view_model import exaggerate
from pinjoint.session import Session
from pinjoint.systems.physics.pace import expected_response

STIFF = [
    "isostatic",
    "hyperstatic",
    "isostatic_10x",
    "hyperstatic_10x",
    "braced_portal",
    "portal",
    "three_hinged_arch",
    "tower",
    "two_storey_frame",
    "vierendeel",
    "warren_bridge",
]


def truss(**changes: Any) -> dict[str, Any]:
    """A triangle under a load, without a scale of its own."""
    content = models.document(models.load("isostatic"))
    return content | {"settings": {"diagram_scale": 0.2}} | changes


def reviewed(source: Any) -> Session:
    session = Session.open(source)
    exaggerate(session)
    return session


def drawn_share(session: Session) -> float:
    """The largest displacement drawn, of the structure's size."""
    original = session.model.particles.position
    size = float(np.ptp(original, axis=0).max())
    return float(np.abs(drawn_positions(session.model) - original).max()) / size


@pytest.mark.parametrize("name", STIFF)
def test_stiff_structures_at_rest_are_drawn_with_a_visible_displacement(name: str) -> None:
    session = reviewed(name)
    session.settle()
    exaggerate(session)
    assert 0.03 <= drawn_share(session) <= DRAWN


@pytest.mark.parametrize("name", [name for name in models.bundled() if name not in STIFF])
def test_large_motions_loose_particles_and_collapses_are_true_to_scale(name: str) -> None:
    session = Session.open(name)
    session.settings.displacement_scale = None
    exaggerate(session)
    # Before it buckles or snaps, a frame moves little; its file says how it is drawn.
    small = {"three_bar_plastic": 100.0, "hyperstatic_yield": 50.0, "overshoot_yield": 5.0}
    small |= {
        "eulers_columns": 100.0,
        "williams_toggle": 20.0,
        "sway_frame": 1000.0,
        "gerber_beam": 50.0,
        "load_cases": 200.0,
        "fixed_beam_collapse": 20.0,
        "portal_collapse": 20.0,
        "sway_resonance": 100.0,
    }
    assert session.settings.displacement_scale == small.get(name, 1.0)


def test_an_old_file_keeps_its_factor_and_a_new_model_has_none() -> None:
    old = reviewed(truss(settings={"displacement_scale": 1.0}))
    assert (old.settings.displacement_scale, old.settings.prescribed_displacement_scale) == (1.0, 1.0)
    new = reviewed(truss())
    assert (new.settings.displacement_scale, new.settings.prescribed_displacement_scale) == (100.0, None)
    saved = models.document(new.model)
    assert saved["settings"]["displacement_scale"] is None
    assert Session.open(saved).settings.prescribed_displacement_scale is None


def test_factors_are_round_steps_and_steady_under_loads_that_change_little() -> None:
    session, seen = reviewed(truss()), []
    for force in range(4, 280, 4):  # beyond it yields and collapses
        session.particles["B"].force = (0.0, -float(force))
        exaggerate(session)
        seen.append(session.settings.displacement_scale)
    assert set(seen) <= {50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0}
    changes = sum(a != b for a, b in itertools.pairwise(seen))
    assert changes <= 3  # over a range of 1 to 70


def test_it_never_changes_while_time_passes() -> None:
    session = reviewed(truss())
    session.press("space")
    for _ in range(200):
        session.frame(0.016)
        assert session.settings.displacement_scale == 100.0


def test_it_does_not_change_in_the_middle_of_a_drag() -> None:
    session = reviewed(truss())
    session.press("space")
    session.gesture = object()  # type: ignore[assignment]
    session.particles["B"].force = (0.0, -1e5)
    exaggerate(session)
    assert session.settings.displacement_scale == 100.0
    session.gesture = None
    exaggerate(session)
    assert session.settings.displacement_scale < 100.0


def test_runs_do_not_depend_on_it() -> None:
    def end(scales: list[float | None]) -> Any:
        session = Session.open(truss())
        for scale in scales:
            session.run(steps=37)
            session.settings.displacement_scale = scale
        return session.particles.displacement.tobytes(), session.time, session.energy.imbalance

    assert end([1.0] * 5) == end([None, 50.0, 3.0, 0.0, 1000.0])


def test_changing_it_in_a_run_leaves_what_was_measured_and_the_way_back() -> None:
    session = Session.open(truss())
    session.run(steps=300)
    session.settings.displacement_scale = 20.0
    assert session.document.assessment.undisturbed
    assert session.document.timeline.first == 0
    assert session.document.unsaved
    time = session.time
    assert "scale" in session.undo()
    assert session.time == time
    assert session.settings.prescribed_displacement_scale is None


def test_a_vibration_without_load_is_seen_by_its_amplitude() -> None:
    session = Session.open(truss())
    session.particles["B"].force = (0.0, 0.0)
    session.particles.velocity  # noqa: B018
    session.model.writable("particles.velocity")[1] = (0.3, 0.0)
    exaggerate(session)
    assert session.settings.displacement_scale > 10.0


def test_warmth_and_moved_supports_are_expected() -> None:
    warm = truss()
    warm["particles"][1].pop("force")
    warm["rods"][0]["temperature_change"] = 40.0
    assert reviewed(warm).settings.displacement_scale > 10.0


def test_a_large_structure_is_looked_at_and_not_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pinjoint.documents.exaggeration.LARGEST", 2)
    session = reviewed(truss())
    assert session.settings.displacement_scale == 1.0
    session.settle()
    exaggerate(session)
    assert session.settings.displacement_scale == 100.0


def test_nothing_breaks_without_elements_or_with_impossible_numbers() -> None:
    assert reviewed({"format": "pinjoint model", "version": 1}).settings.displacement_scale == 1.0
    hostile = truss()
    hostile["rods"][0]["stiffness"] = 1e-29
    review = Exaggeration(models.load(hostile))
    review.review(still=True)


def test_a_constant_load_counts_once() -> None:
    """Constant loads are part of the constant force, to which all loads were added."""
    content = truss()
    for particle in content["particles"]:
        if force := particle.pop("force", None):
            content.setdefault("loads", []).append({"on": particle["name"], "force": force})
    of_loads, of_forces = expected_response(models.parse(content)), expected_response(models.parse(truss()))
    assert of_loads is not None
    assert of_forces is not None
    assert np.array_equal(of_loads[0], of_forces[0])
