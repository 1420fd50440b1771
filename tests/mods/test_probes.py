"""Probes: what they read, when, how it is drawn and written."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.camera import Rectangle
from pinjoint.components.view import Plot
from pinjoint.documents import statics
from pinjoint.included.probes import ENERGIES, probes_of, record
from pinjoint.paths import quantity
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.render.marks import Strokes, Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.plots import draw_plot, round_ticks
from tests.systems.render.frame_models import portal_at_rest

LIGHT = load_theme("light")
BOX = Rectangle(0.0, 0.0, 300.0, 150.0)


def test_quantities_are_read_in_the_units_on_screen() -> None:
    session = Session.open("isostatic")
    session.run(until="rest")
    read = quantity(session.model, "particles.B.displacement.y")
    assert read.title == "displacement y of particle B (cm)"
    assert read.read(session) == 100.0 * session.particles["B"].displacement[1]
    session.model.delete([session.particles["B"]])
    assert math.isnan(read.read(session))
    session.undo()
    assert read.read(session) < 0.0


def test_the_force_strain_loop_encloses_what_yielding_dissipates() -> None:
    """∮ N dε · L₀ = plastic dissipation (J), from zero force to zero force: N L₀ ε in kN·m."""
    session = Session.open("hyperstatic_yield")
    session.run(time=0.6)
    name = max(session.rods, key=lambda rod: abs(rod.plastic_strain)).name
    session.undo()
    probe = probes_of(session).add(session, [f"rods.{name}.axial_force"], f"rods.{name}.strain")
    record(session, probe, 0.6, 4000)
    table = probe.table
    force, strain = table[:, 2], table[:, 1]
    work = 1000.0 * session.rods[name].rest_length * np.trapezoid(force, strain)
    rod = session.rods[name]
    stored = 500.0 * rod.axial_force**2 * rod.rest_length / rod.stiffness
    plastic = 1000.0 * abs(rod.axial_force) * abs(rod.plastic_strain) * rod.rest_length
    assert plastic > 0.0
    assert work == pytest.approx(stored + plastic, rel=1e-3)


def test_o_plots_one_quantity_of_the_selected_element_after_the_other() -> None:
    session = Session.open("isostatic")
    session.run(steps=0)
    session.select(session.rods["AB"])
    session.press("o")
    session.press("space")
    for _ in range(5):
        session.frame(1 / 60)
    (readout,) = session.view.readouts
    assert isinstance(readout.plot, Plot)
    assert readout.title == "Plot of axial force of rod AB"
    assert len(readout.plot.curves[0][1]) > 2
    texts = compose(session.model, session.view, LIGHT).texts
    assert "axial force of rod AB (kN)" in texts
    session.press("o")
    assert probes_of(session).all[0].key == ("rods.AB.strain", "rods.AB.axial_force")
    session.press("o")
    assert not probes_of(session).all
    session.select()
    session.press("o")
    assert probes_of(session).all[0].key == ("time", *ENERGIES)


@pytest.mark.parametrize(
    ("name", "pulled"), [("pendulum", False), ("hyperstatic_yield", False), ("hyperstatic_yield", True)]
)
def test_a_plot_that_is_opened_after_a_run_shows_it_and_changes_nothing(name: str, pulled: bool) -> None:
    """The bits of one that was open all the time, at the same times, and those of the run that goes on."""
    early, late = Session.open(name), Session.open(name)
    rod = early.rods.names[-1]
    early.select(early.rods[rod])
    early.press("o")
    for session in (early, late):
        session.step(150)
        if pulled:
            timeline = session.document.timeline
            timeline.hold(Hand(session.particles["C"], 1e4, 1.0, (0.01, 0.02)))
            session.step(40)
            timeline.hold(Hand(session.particles["C"], 1e4, 1.0, (-0.01, 0.0)))
            session.step(40)
            timeline.hold(None)
        session.step(150)
    late.select(late.rods[rod])
    before = late.time, late.particles.velocity.tobytes(), late.simulation.events, late.document.timeline.kept
    late.press("o")
    after = late.time, late.particles.velocity.tobytes(), late.simulation.events, late.document.timeline.kept
    assert after == before
    [probe] = probes_of(late).all
    assert len(probe.table) > 250
    for session in (early, late):
        session.step(50)
    assert early.particles.displacement.tobytes() == late.particles.displacement.tobytes()
    found = {row[0]: row[2] for row in probes_of(early).all[0].table.tolist()}
    assert all(found.get(time, value) == value for time, _, value in probe.table.tolist())


def test_what_time_took_back_is_dropped() -> None:
    session = Session.open("pendulum")
    session.step()
    probe = probes_of(session).add(session, ["particles.bob.velocity.x"])
    for _ in range(5):
        session.step()
        session.frame(0.0)
    assert len(probe.table) == 6, "the beginning, too"
    session.step(-3)
    session.frame(0.0)
    assert probe.table[:, 0].tolist() == sorted(set(probe.table[:, 0].tolist()))
    assert probe.table[-1, 0] == session.time
    assert len(probe.table) == 3


def test_plots_zoom_to_the_last_part_of_the_time() -> None:
    session = Session.open("pendulum")
    probe = probes_of(session).add(session, ["particles.bob.velocity.x"])
    record(session, probe, 0.1, 101)
    session.press("]")
    shown = probe.plot(probes_of(session).span).curves[0][1]
    assert shown[0] == pytest.approx(0.05, abs=2e-3)
    session.press("[")
    session.press("[")
    assert probes_of(session).span == 1.0


def test_plots_are_saved_as_csv_and_png(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    session = Session.open("pendulum")
    session.press("ctrl+e")
    assert "no plot to save" in session.notice
    probe = probes_of(session).add(session, ["particles.bob.velocity.x"])
    record(session, probe, 0.01, 11)
    session.press("ctrl+e")
    rows = list(csv.reader((tmp_path / "pinjoint-plot-1.csv").open(encoding="utf-8")))
    assert rows[0] == ["time (s)", "velocity x of particle bob (m/s)"]
    assert len(rows) == 12
    assert (tmp_path / "pinjoint-plot-1.png").read_bytes().startswith(b"\x89PNG")


def test_plot_is_a_command_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "loop.csv"
    words = ["plot", "pendulum", "--of", "particles.bob.velocity.x", "--until", "0.01", "--output", str(out)]
    assert main([*words, "--against", "particles.bob.displacement.x"]) == 0
    assert out.read_text(encoding="utf-8").startswith("time (s),displacement x of particle bob (cm),")
    still = out.read_bytes()
    assert main([*words, "--set", "environment.acceleration=0,-1.6"]) == 0
    assert out.read_bytes() != still
    assert main([*words, "--of", "rods.none.strain"]) == 2
    assert "There is no 'none' among the rods" in capsys.readouterr().err


# --- drawing -----------------------------------------------------------------------------------------------


def test_a_plot_draws_its_curves_inside_the_box_and_parts_them_at_gaps() -> None:
    x = np.linspace(0.0, 1.0, 200)
    y = np.sin(6.0 * x)
    y[100] = np.nan
    marks = draw_plot(Plot("t (s)", "u (m)", (("u", x, y),)), BOX, LIGHT, 1.0, None)
    (curve,) = [mark for mark in marks if isinstance(mark, Strokes) and mark.colour == LIGHT.curve_1]
    assert (curve.start >= 0.0).all()
    assert (curve.start[:, 0] <= 300.0).all()
    assert (curve.start[:, 1] <= 150.0).all()
    assert not np.isnan(curve.start).any()
    assert np.hypot(*(curve.end - curve.start).T).max() < 8.0


def test_the_pointer_reads_the_nearest_point() -> None:
    plot = Plot("t (s)", "u (m)", (("u", np.array([0.0, 1.0, 2.0]), np.array([0.0, 5.0, 0.0])),))
    marks = draw_plot(plot, BOX, LIGHT, 1.0, None)
    (curve,) = [mark for mark in marks if isinstance(mark, Strokes) and mark.colour == LIGHT.curve_1]
    top = curve.end[np.argmin(curve.end[:, 1])]
    near = draw_plot(plot, BOX, LIGHT, 1.0, (float(top[0]) + 3.0, float(top[1]) + 3.0))
    assert "1, 5" in [mark.text for mark in near if isinstance(mark, Text)]
    assert "1, 5" not in [mark.text for mark in marks if isinstance(mark, Text)]


@pytest.mark.parametrize("values", [(0.0, 1.0), (-3.7e-9, 1.2e-8), (1e6, 1.1e6), (-5.0, -4.99)])
def test_ticks_are_round_and_few(values: tuple[float, float]) -> None:
    ticks = [tick for tick, _ in round_ticks(values)]
    assert 2 <= len(ticks) <= 6
    assert all(values[0] <= tick <= values[1] for tick in ticks)
    assert len({text for _, text in round_ticks(values)}) == len(ticks)


def test_a_plot_of_nothing_or_of_one_value_is_drawn() -> None:
    empty = np.empty(0)
    assert draw_plot(Plot("t", "u", (("u", empty, empty),)), BOX, LIGHT, 1.0, (100.0, 50.0))
    one = np.array([3.0])
    assert draw_plot(Plot("t", "u", (("u", one, one),)), BOX, LIGHT, 1.0, (100.0, 50.0))


def test_members_offer_their_moments_and_joints_their_rotation() -> None:
    session = Session.open(portal_at_rest())
    session.document.get_ready()
    session.select(session.rods["BC"])
    session.press("o")
    assert [read.title for read in probes_of(session).all[0].read] == [
        "bending moment at the start of rod BC (kN·m)"
    ]
    assert probes_of(session).all[0].table[-1, 2] == pytest.approx(1.359, rel=1e-3)
    session.select(session.particles["B"])
    for _ in range(5):
        session.press("o")
    assert "rotation of particle B" in session.notice


def test_in_a_window_a_plot_against_the_load_factor_comes_frames_later(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each frame has its part of solving the states on the way; the samples are those of who waits."""
    tables = []
    for window in (None, object()):
        session = Session.open("portal")
        session.press("q")
        session.select(session.rods["AB"])
        for limit in ("PART", "_MOST") if window else ():
            monkeypatch.setattr(statics, limit, 0.0)  # so that it rests whenever it may
        session.window = window
        session.frame(0.0)
        session.press("o")
        probe, frames = probes_of(session).all[0], 0
        session.particles["B"].force = (35.0, -20.0)
        session.frame(0.0)
        while session.document.statics.is_late or probe.solved != session.document.statics.revision:
            session.frame(0.0)
            frames += 1
        assert (frames > 20) == (window is not None)
        tables.append(probe.table)
    assert (tables[0] == tables[1]).all()
    assert len(tables[0]) > 20
