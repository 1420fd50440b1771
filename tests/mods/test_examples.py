"""The mods in assets/mods do what they say, and are short."""

from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session, check_system, mods
from pinjoint.commands.analysis import Analysis
from pinjoint.scripts.lines import perform
from pinjoint.sweeps import sweep
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.mods.conftest import Write
from tests.reference.models import model, particle, rod

FOLDER = Path(__file__).parents[2] / "assets" / "mods"
NAMES = sorted(path.parent.name for path in FOLDER.glob("*/mod.toml"))
VERLET = {"integrator": "velocity_verlet"}  # the quickest to compile
BALL: dict[str, Any] = model([particle("A", 0, 0)], [], settings=VERLET)

HANGING = model(
    [
        particle("A", 0, 0, fixed=[True, True]),
        particle("B", 1, 0, fixed=[False, True], force=[15.0, 0.0], mass=100.0),
    ],
    [rod("A", "B", stiffness=100.0, damping=5.0, components={"stiffening.Material": {"cubic": 50.0}})],
    settings=VERLET,
)


@pytest.mark.parametrize("name", NAMES)
def test_an_example_loads_and_has_less_than_65_lines(name: str, unloaded: None) -> None:
    (mod,) = mods.load([FOLDER / name])
    assert (mod.name, mod.problem, mod.notes) == (name, "", [])
    assert mod.description
    assert len((FOLDER / name / "__init__.py").read_text(encoding="utf-8").splitlines()) < 65


def test_wind_accelerates_a_ball_towards_its_speed(unloaded: None) -> None:
    """m dv/dt = k (u − v)²  with k = ρ A / 2:  v = u − u / (1 + k u t / m)."""
    session = Session.open(BALL, mods=[FOLDER / "wind"])
    ball, air = session.particles["A"], session.environment
    ball.wind_area = 0.5  # type: ignore[attr-defined]
    air.wind_velocity = (12.0, 0.0)  # type: ignore[attr-defined]
    session.settings.time_step = 1e-4
    session.run(time=0.4)
    k = 0.5 * 1.2 * 0.5
    assert ball.velocity[0] == pytest.approx(12.0 - 12.0 / (1.0 + k * 12.0 * 0.4), rel=1e-7)
    assert ball.velocity[1] == 0.0
    assert abs(session.energy.imbalance) < 1e-4 * session.energy.kinetic
    session.update_view()
    assert session.view.readouts[0].rows == (("speed", "12 m/s"),)


def test_a_stiffening_rod_rests_where_its_law_says(unloaded: None) -> None:
    """F = EA (ε + β ε³): with EA = 100 kN and β = 50, a strain of 0.1 takes 15 kN."""
    session = Session.open(HANGING, mods=[FOLDER / "stiffening"])
    assert session.run(until="rest") == "at rest"
    assert session.rods["AB"].strain == pytest.approx(0.1, rel=1e-7)
    assert session.rods["AB"].axial_force == pytest.approx(15.0, rel=1e-7)
    session.particles["B"].force = (0.0, 0.0)
    assert session.run(until="rest") == "at rest"
    assert session.rods["AB"].strain == pytest.approx(0.0, abs=1e-8)


def test_the_count_down_has_keys_of_its_own_and_ends_in_the_simulation(unloaded: None) -> None:
    session = Session.open("pendulum", mods=[FOLDER / "countdown"])
    session.press("y")
    assert session.scene == "count down"
    session.frame(1.0)
    assert session.view.heading == "2 …"
    session.press("+")
    session.frame(0.5)
    assert session.view.heading == "3 …"
    session.press("escape")
    assert session.scene == "pause"
    session.press("y")
    session.press("space")
    assert session.scene == "simulation"
    session.press("escape")
    session.press("y")
    for _ in range(4):
        session.frame(1.0)
    assert session.scene == "simulation"


def magnets(**further: Any) -> dict[str, Any]:
    """Three on a line, the middle one of another sign than the last; one far away."""
    places = {"A": (0.0, 2.0), "B": (0.4, 1.0), "C": (0.9, -1.5), "D": (7.0, 1.0)}
    particles = [
        {
            "name": name,
            "position": [x, 0],
            "mass": 1,
            "radius": 0.01,
            "components": {"magnets.Magnet": {"pole": pole}},
        }
        for name, (x, pole) in places.items()
    ]
    return {**BALL, "particles": particles, **further}


def test_magnets_attract_and_repel_up_to_their_reach_and_keep_the_energy(unloaded: None) -> None:
    session = Session.open(magnets(), mods=[FOLDER / "magnets"])

    def force(distance: float) -> float:
        return 0.001 * (1.0 / distance**2 - 1.0)

    pulls = session.particles.applied_force[:, 0]
    expected = [
        -2.0 * force(0.4) + 3.0 * force(0.9),
        2.0 * force(0.4) + 1.5 * force(0.5),
        -1.5 * force(0.5) - 3.0 * force(0.9),
        0.0,
    ]
    assert pulls == pytest.approx(expected, abs=1e-15)
    session.settings.time_step = 1e-5
    session.settings.collisions = False
    session.simulation.program.module.load()  # it takes ten thousand steps
    session.run(time=0.1)
    assert session.energy.kinetic > 0.1
    assert abs(session.energy.imbalance) < 1e-6 * session.energy.kinetic
    assert check_system("magnets.force", [magnets()]).needed == 1


def test_magnets_reach_discs_that_lie_on_the_ground(unloaded: None) -> None:
    """Contacts and impacts know of the forces between pairs: a magnet below a disc holds it against its weight."""
    fixed = {"name": "held", "position": [0, 0], "fixed": [True, True], "radius": 0.1}
    disc = {"name": "disc", "position": [0, -0.2], "mass": 0.1, "radius": 0.1}
    document = {**BALL, "particles": [fixed, disc], "environment": {"acceleration": [0, -9.81]}}
    for one, pole in ((fixed, 1.0), (disc, -1.0)):
        one["components"] = {"magnets.Magnet": {"pole": pole}}
    session = Session.open(document, mods=[FOLDER / "magnets"])
    session.run(time=0.05)
    assert session.particles["disc"].displacement[1] == pytest.approx(0.0, abs=1e-6)
    session.particles["disc"].magnets_pole = 0.0  # type: ignore[attr-defined]
    session.run(time=0.05)
    assert session.particles["disc"].displacement[1] < -0.01


def test_one_can_point_and_click_in_the_scene_of_a_mod(unloaded: None) -> None:
    session = Session.open("pendulum", mods=[FOLDER / "countdown"])
    session.press("y")
    pixel = session.point(0.5, 0.25)
    assert session.stages[0][1].pointer == pixel
    session.click(0.5, 0.25)
    session.drag((0.0, 0.0), (0.5, 0.0))
    session.frame(0.5)
    assert session.scene == "count down"
    assert "switched off" not in session.message
    assert list(perform(session, {"click": [0.5, 0.25]})) == []


TARGETS = """
from pinjoint.editor.scenes import Scene

class Aim(Scene):
    name = "aim"
    heading = "Aim"
    sources = ("pause",)
    hits = 0
    finished = False

    @property
    def message(self):
        return f"{self.hits} hits" if self.hits else ""

    def finish(self):
        self.finished = True

def plugin(app):
    app.scene(Aim)
    app.action("apple.aim", key="y", scenes=("pause",))(lambda session, pixel: session.scenes.request("aim"))

    @app.action("apple.hit", key="click", scenes=("aim",))
    def hit(session, pixel):
        session.scenes.active.hits += 1
        session.scenes.active.at = pixel
"""


def test_the_message_of_a_mods_scene_is_seen_and_clicks_are_its_own(write_mod: Write) -> None:
    session = Session.open("pendulum", mods=[write_mod("apple", TARGETS)])
    session.press("y")
    assert session.message == ""
    session.click(0.5, 0.25)
    scene: Any = session.scenes.active
    assert scene.at == session.point(0.5, 0.25)
    assert scene.finished
    session.update_view()
    assert session.view.status.notice == session.message == "1 hits"
    texts = compose(session.model, session.view, load_theme("light")).texts
    assert "1 hits" in texts
    assert "Aim" in texts


def test_sweeps_load_the_mods_that_they_are_given(unloaded: None) -> None:
    sail = {"wind.Sail": {"area": 1.0}}
    ball = model([particle("A", 0, 0, components=sail)], [], settings=VERLET)
    vary, measure = {"environment.wind_velocity.x": [0.0, 10.0]}, "particles.A.displacement"
    found = sweep(ball, vary, [measure], Analysis(times=(0.05,)), mods=["wind"])
    assert found[f"{measure}.x"][0] == 0.0 < found[f"{measure}.x"][1]


def test_sweeps_know_of_forces_between_pairs(unloaded: None) -> None:
    mods.load([FOLDER / "magnets"])
    poles, measure = [0.5, 1.0], "particles.A.velocity"
    found = sweep(magnets(), {"particles.B.magnets_pole": poles}, [measure], Analysis(times=(0.05,)))
    for row, pole in enumerate(poles):
        session = Session.open(magnets())
        session.particles["B"].magnets_pole = pole  # type: ignore[attr-defined]
        session.run(time=0.05)
        assert found[f"{measure}.x"][row] == session.particles["A"].velocity[0] != 0.0
