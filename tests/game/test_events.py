"""What is said of a run when it happens, and the list of it."""

import json
from itertools import pairwise
from pathlib import Path

import pytest

from pinjoint.components.view import drawn_positions
from pinjoint.documents.chronicle import TOLD
from pinjoint.scripts.lines import perform
from pinjoint.scripts.playing import Recorder
from pinjoint.session import Session
from pinjoint.systems.statics.factor import is_held


def watched(name: str, seconds: float, start: str = "space") -> Session:
    """A session in which time passed in frames, for so long or until rest."""
    session = Session.open(name)
    session.press(start)
    for _ in range(round(60 * seconds)):
        session.frame(1 / 60)
        if session.simulation.halted:
            break
    return session


def kinds(session: Session) -> list[str]:
    return [event.kind for event in session.document.chronicle.happenings]


# --- instants --------------------------------------------------------------------------------------------


def test_a_rod_yields_at_the_instant_and_load_at_which_it_reaches_its_strength() -> None:
    """Hyperstatic square: in statics CD reaches 215 kN at 92.4 % of the load, and the load grows slowly."""
    session = Session.open("hyperstatic_yield")
    assert session.rods["CD"].yielded_at is None
    session.run(until="rest")
    [yields, rests] = session.document.chronicle.happenings
    assert (yields.kind, yields.elements, rests.kind) == ("yield", ("CD",), "rest")
    assert yields.time == session.rods["CD"].yielded_at
    assert yields.load_factor == pytest.approx(yields.time / 0.5, rel=1e-12)
    assert yields.message == "Rod CD yields."
    assert yields.when == "0.4620 s, 92.4 % of the load"
    again = Session.open("hyperstatic_yield")
    again.run(time=yields.time * (1.0 - 1e-9))
    assert again.document.chronicle.happenings == ()
    assert abs(again.rods["CD"].axial_force) == pytest.approx(215.0, rel=1e-6)
    again.run(time=yields.time * 3e-9)
    assert kinds(again) == ["yield"]


def test_the_instant_does_not_depend_on_frames_or_the_integrator() -> None:
    script = Session.open("hyperstatic_yield")
    script.run(until="rest")
    seen = watched("hyperstatic_yield", 20.0)
    assert [event.time for event in seen.document.chronicle.happenings] == [
        event.time for event in script.document.chronicle.happenings
    ]
    fixed = Session.open("hyperstatic_yield")
    fixed.settings.integrator = "velocity_verlet"
    fixed.run(until="rest")
    assert fixed.document.chronicle.happenings[0].time == pytest.approx(
        script.document.chronicle.happenings[0].time, abs=3 * fixed.model.clock.step_size
    )


def test_what_is_taken_back_did_not_happen() -> None:
    session = Session.open("hyperstatic_yield")
    session.run(time=0.5)
    assert kinds(session) == ["yield"]
    session.press("ctrl+z")
    assert session.document.chronicle.happenings == ()
    session.press("ctrl+y")
    assert kinds(session) == ["yield"]
    session.restart()
    assert session.document.chronicle.happenings == ()


# --- by looking ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "seconds", "found"),
    [
        ("von_mises", 8.0, ["snap-through", "rest"]),
        ("braced_portal", 10.0, ["slack", "rest"]),
        ("pendulum", 2.0, []),
        ("overshoot_yield", 2.0, ["yield"]),
    ],
)
def test_what_happens_is_noted(name: str, seconds: float, found: list[str]) -> None:
    session = watched(name, seconds)
    assert kinds(session) == found
    assert all(event.message.endswith(".") for event in session.document.chronicle.happenings)
    session.restart()
    assert session.document.chronicle.happenings == ()


def test_a_collapse_begins_when_the_rod_that_lets_go_yields_and_a_panel_lists_it() -> None:
    session = watched("isostatic_collapse", 5.0)
    yields, collapse = session.document.chronicle.happenings
    assert collapse.time == yields.time
    assert collapse.load_factor == pytest.approx(0.8686, abs=2e-3), (
        "that of plastic theory, and a little inertia"
    )
    assert collapse.message == "The structure collapses: rod BC yields, and nothing else resists."
    session.press("ctrl+h")
    session.update_view()
    [panel] = [readout for readout in session.view.readouts if readout.title == "What happened"]
    assert panel.rows[0] == ("0.4345 s, 86.9 % of the load", "Rod BC yields")
    session.press("ctrl+h")
    session.update_view()
    assert not session.view.readouts


def test_a_structure_is_held_by_what_its_rods_resist() -> None:
    model = Session.open("von_mises").model
    assert is_held(model)
    assert is_held(model, at_first=True)
    model.writable("particles.displacement")[1] = -model.particles.position[1] * [0.0, 1.0]  # flat
    assert not is_held(model)
    assert is_held(Session.open("isostatic").model)
    assert not is_held(Session.open("pendulum").model, at_first=True)


# --- how it is said --------------------------------------------------------------------------------------


def test_it_is_said_for_a_few_seconds() -> None:
    session = watched("hyperstatic_yield", 5.2)
    assert kinds(session) == ["yield"]
    assert session.view.status.notice == "0.4620 s, 92.4 % of the load: Rod CD yields."
    session.press("space")
    for _ in range(round(60 * TOLD)):
        session.frame(1 / 60)
    assert "yields" not in session.view.status.notice


def test_what_leaves_the_picture_is_told() -> None:
    session = watched("collision_vi", 0.05)
    assert session.view.status.notice == ""
    said = set()
    for _ in range(600):
        session.frame(1 / 60)
        said.add(session.view.status.notice)
    shown_by = "Press Home to see {} (right click: fit the view)."
    one = f"Particle 2 has left the picture. {shown_by.format('everything')}"
    assert any(notice.endswith(one) for notice in said)
    everything = f"Everything that moves has left the picture. {shown_by.format('it')}"
    assert session.view.status.notice == everything
    session.press("home")
    session.frame(1 / 60)
    assert session.view.status.notice == ""


class Glass:
    """A window that nobody sees."""


@pytest.mark.parametrize(("name", "frames"), [("collision_vi", 40), ("isostatic_collapse", 660)])
def test_a_window_follows_what_moves_and_a_recording_of_it_plays(
    name: str, frames: int, tmp_path: Path
) -> None:
    session = Session.open(name)
    session.window = Glass()  # type: ignore[assignment]
    script = tmp_path / "recording.jsonl"
    with script.open("w") as file:
        Recorder(session, file, name)
        session.resize(1000, 720)
        session.press("home")
        session.press("space")
        seen = []
        for _ in range(frames):
            session.frame(1 / 60)
            assert "left the picture" not in session.view.status.notice
            seen.append(session.view.camera.scale)
        moved = [after != before for before, after in pairwise(seen)]
        assert 1 <= sum(moved) < 20, "in steps, now and then"
        session.press("space")
        session.click(*drawn_positions(session.model)[1])
    again = Session.open(name)
    for line in script.read_text().splitlines()[1:]:
        list(perform(again, json.loads(line)))
    assert again.view.camera == session.view.camera
    assert again.selected == [again.particles[1]]


def test_a_window_follows_nobody_who_looks_elsewhere_and_nothing_too_far() -> None:
    session = Session.open("collision_vi")
    session.window = Glass()  # type: ignore[assignment]
    session.press("home")
    session.press("wheel up")
    chosen = session.view.camera.scale
    session.press("space")
    for _ in range(600):
        session.frame(1 / 60)
    assert session.view.camera.scale == chosen
    assert "left the picture" in session.view.status.notice
    session.press("home")
    first = session.view.camera.scale
    session.run(time=60.0)
    session.frame(1 / 60)
    assert session.view.camera.scale == first, "it would be too small to see"
    assert "left the picture" in session.view.status.notice


def test_many_rods_that_yield_at_once_are_one_event() -> None:
    session = Session.open("tower")
    session.model.writable("rods.yielded_at")[:5] = 0.0
    [event] = session.document.chronicle.happenings
    assert event.message.startswith("Rods ")
    assert "2 more yield." in event.message


def test_a_run_that_diverges_says_so() -> None:
    session = Session.open("isostatic")
    session.settings.integrator = "velocity_verlet"
    session.settings.time_step = 1e-2
    assert session.run(time=5.0) == "diverged"
    assert kinds(session) == ["diverged"]


def test_impacts_are_told_first_one_by_one_then_counted() -> None:
    session = Session.open("collision_vi")
    session.run(time=0.05)
    assert session.document.chronicle.happenings == ()
    session.run(time=0.1)
    [event] = session.document.chronicle.happenings
    assert (event.kind, event.elements) == ("impact", ("particle 1", "particle 2"))
    assert event.message == "Impact of particle 1 and particle 2."
    assert event.time == session.impacts.time[0]
    session.restart()
    assert session.document.chronicle.happenings == ()

    billiards = Session.open("billiards_break")
    billiards.run(time=0.5)
    *first, further = billiards.document.chronicle.happenings
    count = len(billiards.impacts)
    assert [event.kind for event in first] == 3 * ["impact"]
    told = int((billiards.impacts.time < first[-1].time * (1.0 + 1e-9)).sum())
    assert (further.kind, further.message) == ("impacts", f"{count - told} more impacts.")
    assert further.time == billiards.impacts.time[-1]
    assert "more impacts" not in billiards.document.chronicle.told(0.0), "it would be told again and again"
