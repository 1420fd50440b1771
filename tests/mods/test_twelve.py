"""Twelve mods as somebody writes them who has read only the guides; `mods check` finds nothing wrong with any of them."""

import json
import math
from math import cos, exp
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.checks import Trial
from pinjoint.commands.command_line import main
from tests.mods.conftest import Write

FORMAT = {"format": "pinjoint model", "version": 1}
PULLED = FORMAT | {
    "particles": [
        {"name": "wall", "position": [0, 0], "fixed": [True, True]},
        {"name": "mass", "position": [1, 0], "fixed": [False, True]},
    ],
    "rods": [{"name": "rod", "between": ["wall", "mass"], "stiffness": 1000}],
}
BALL = FORMAT | {"particles": [{"name": "A", "position": [0, 0], "mass": 1, "velocity": [1, 0]}]}


def opened(write_mod: Write, name: str, code: str, document: Any) -> Any:
    """A session with a mod in which the check finds no problem."""
    (mod,) = mods.load([write_mod(name, f"from pinjoint.api import *\n{code}")])
    assert mod.problem == ""
    assert Trial(mod).found == []
    return Session.open(document)


HARDENING = """
class Hardening(Component):
    of = Rod
    modulus: Field[float] = Field("kN/m", doc="Force per plastic elongation.", minimum=0.0)
    slip: Field[float] = Field("m", doc="Plastic elongation.", role=Role.STATE)

@compiled
def hard(axial_force, rods_stiffness, rods_rest_length, rods_tension_limit, rods_hard_modulus, rods_hard_slip):
    k = rods_stiffness / rods_rest_length
    trial = axial_force - k * rods_hard_slip
    beyond = trial - rods_hard_modulus * rods_hard_slip
    over = abs(beyond) - rods_tension_limit
    if over <= 0.0 or rods_hard_modulus == 0.0:
        return trial
    return trial - (over if beyond > 0.0 else -over) * k / (k + rods_hard_modulus)

@compiled
def slips(axial_force, rods_tension_limit, rods_hard_modulus, rods_hard_slip):
    beyond = axial_force - rods_hard_modulus * rods_hard_slip
    over = abs(beyond) - rods_tension_limit
    if over <= 0.0 or rods_hard_modulus == 0.0:
        return rods_hard_slip, 0.0
    change = (over if beyond > 0.0 else -over) / rods_hard_modulus
    return rods_hard_slip + change, axial_force * change  # what hardening stores included

READS = ("rods.tension_limit", "rods.hard_modulus", "rods.hard_slip")

class Harden(Law):
    name, kernel, adds, replaces = "hard.law", hard, ("rods.axial_force",), ("plasticity",)
    reads, elastic = (*READS, "rods.stiffness", "rods.rest_length"), True
    def needs(self, model):
        return bool((model.rods.hard_modulus > 0.0).any())

class Slip(Commit):
    name, kernel, reads, writes = "hard.slip", slips, READS, ("rods.hard_slip",)
    needs = Harden.needs

def plugin(app):
    app.component(Hardening)
    app.system(Harden)
    app.system(Slip)
"""


def test_a_law_of_hardening(write_mod: Write) -> None:
    rod = PULLED["rods"][0] | {"tensile_strength": 1.0, "components": {"hard.Hardening": {"modulus": 250.0}}}
    load = {"on": "mass", "force": [1.5, 0], "history": {"kind": "ramp", "duration": 2.0}}
    session = opened(write_mod, "hard", HARDENING, PULLED | {"rods": [rod], "loads": [load]})
    assert session.run(until="rest") == "at rest"
    slip = session.rods["rod"].hard_slip
    assert abs(session.rods["rod"].axial_force - 1.5) < 1e-6
    assert abs(slip - (1.5 - 1.0) / 250.0) < 2e-3 * slip
    assert abs(session.energy.elastic - 1.5**2 / 2000 * 1e3) < 1e-6  # J
    assert abs(session.energy.dissipated_plastic - (1.0 + 1.5) / 2 * slip * 1e3) < 0.02


COULOMB = """
from math import hypot

class Rough(Component):
    of = Environment
    friction: Field[float] = Field(doc="Of the ground, beneath all particles.", minimum=0.0)

@compiled
def drag(particles_velocity, particles_mass, environment_coulomb_friction):
    vx, vy = particles_velocity
    speed = hypot(vx, vy)
    force = 9.81e-3 * environment_coulomb_friction * particles_mass * min(1.0, speed / 1e-3)
    return (-force * vx / speed, -force * vy / speed) if speed > 0.0 else (0.0, 0.0)

class Drag(Law):
    name, each, kernel, account = "coulomb.drag", "particles", drag, "dissipated_damping"
    reads = ("particles.velocity", "particles.mass", "environment.coulomb_friction")
    def needs(self, model):
        return model.environment.coulomb_friction > 0.0

def plugin(app):
    app.component(Rough)
    app.system(Drag)
"""


def test_coulomb_friction(write_mod: Write) -> None:
    session = opened(write_mod, "coulomb", COULOMB, BALL)
    session.environment.coulomb_friction = 0.5
    session.settings.time_step = 1e-4
    session.run(time=0.5)
    assert abs(session.particles["A"].displacement[0] - 1.0 / (2 * 0.5 * 9.81)) < 1e-4  # v²/2μg
    assert abs(session.energy.dissipated_damping - 0.5) < 1e-6


FATIGUE = """
class Fatigue(Component):
    of = Rod
    limit: Field[float] = Field("kN", doc="That it bears for one second; twice of it, 1/8 s.", nullable=True)
    damage: Field[float] = Field(doc="It breaks at 1.", role=Role.STATE)

@compiled
def grow(axial_force, rods_fatigue_limit, rods_fatigue_damage, dt):
    if rods_fatigue_limit > 0.0:
        return rods_fatigue_damage + dt * abs(axial_force / rods_fatigue_limit) ** 3, 0.0
    return rods_fatigue_damage, 0.0

@compiled
def whole(rods_fatigue_damage):
    return 1.0 - rods_fatigue_damage

class Grow(Commit):
    name, kernel = "fatigue.grow", grow
    reads, writes = ("rods.fatigue_limit", "rods.fatigue_damage"), ("rods.fatigue_damage",)

class Break(Event):
    name, kernel, reads = "fatigue.broken", whole, ("rods.fatigue_damage",)
    def happen(self, model, fallen, risen):
        with model.transaction("fatigue"):
            model.delete(fallen)

def plugin(app):
    app.component(Fatigue)
    app.system(Grow)
    app.system(Break)
"""


def test_fatigue_with_an_event(write_mod: Write) -> None:
    pulled = json.loads(json.dumps(PULLED))
    pulled["particles"][1] |= {"velocity": [0.5, 0]}
    pulled["rods"][0] |= {"damping": 0.0, "components": {"fatigue.Fatigue": {"limit": 0.5}}}
    session = opened(write_mod, "fatigue", FATIGUE, pulled)
    session.run(time=0.1)
    assert 0.0 < session.rods["rod"].fatigue_damage < 1.0
    session.run(time=2.0)
    assert session.rods.count == 0
    session.undo()
    session.undo()
    assert session.rods.count == 1


TRAILS = """
from weakref import WeakKeyDictionary
import numpy as np

PLACES = WeakKeyDictionary()  # of each session

class Trails(System):
    name, phase, scenes = "trails.follow", Phase.EVENTS, ("simulation",)
    reads = ("particles.displacement",)
    def process(self, frame):
        particles = frame.session.particles
        PLACES.setdefault(frame.session, []).append(particles.position + particles.displacement)

def draw(sheet):
    places = [p for p in PLACES.get(sheet.session, ()) if len(p) == sheet.model.particles.count]
    if len(places) > 1 and len(places[0]):
        path = sheet.view.camera.to_pixels(np.array(places))
        ends = path[:-1].reshape(-1, 2), path[1:].reshape(-1, 2)
        yield Strokes(*ends, 2 * sheet.unit, faded(sheet.theme.ink, 0.5))

def plugin(app):
    app.system(Trails)
    app.layer(draw, below=True)
"""


def test_trails(write_mod: Write, tmp_path: Any) -> None:
    session = opened(write_mod, "trails", TRAILS, BALL)
    session.picture(tmp_path / "before.svg")
    session.press("space")
    for _ in range(10):
        session.frame(1 / 60)
    session.press("space")
    session.picture(tmp_path / "after.svg")
    before, after = ((tmp_path / f"{name}.svg").read_text().count("<line") for name in ("before", "after"))
    assert after > before or "<path" in (tmp_path / "after.svg").read_text()
    assert mods.FAULTS == []


CHALLENGE = """
class Challenge(Scene):
    name, heading, sources, like = "challenge", "Challenge", ("pause",), "pause"
    def hint(self, session):
        return f"{session.rods.count} of at most 3 rods"

def plugin(app):
    app.scene(Challenge)
    @app.action("puzzle.begin", key="y", scenes=("pause",), title="a challenge")
    def begin(session, pixel):
        session.scenes.request("challenge")
    app.key("backspace", "back", ("challenge",), "back to pause")
"""


def test_a_scene_as_in_pause(write_mod: Write) -> None:
    session = opened(write_mod, "puzzle", CHALLENGE, PULLED)
    session.press("y")
    session.frame(1 / 60)
    session.click(1, 0)
    assert session.scene == "challenge"
    assert session.selected == [session.particles["mass"]]
    assert session.view.status.hint == "1 of at most 3 rods"
    session.press("backspace")
    session.frame(1 / 60)
    assert session.scene == "pause"


CHARGES = """
class Lamp(Handle):
    table, noun, points = "lamps", "lamp", ("place",)
    name: Field[str] = Field(dtype=str, doc="Unique among the lamps.")
    place: Field[tuple] = Field("m", shape=(2,), doc="Where it hangs.", shown=CM)
    power: Field[float] = Field("W", default=60.0, above=0.0, doc="That it takes.")
    on: Field[int] = Field(dtype="reference", references="particles", doc="From which it hangs.")

def plugin(app):
    app.kind(Lamp)
"""


def test_a_kind_with_a_file_and_a_form(write_mod: Write, tmp_path: Any) -> None:
    lamp = {"name": "first", "place": [0.5, -0.5], "on": "mass"}
    session = opened(write_mod, "lamps", CHARGES, PULLED | {"components": {"lamps.Lamp": [lamp]}})
    session.click(0.5, -0.5)
    session.press("return")
    session.frame(1 / 60)
    assert session.boxes["power"].startswith("60")
    session.scenes.active.click_box(session, "power")
    session.press("ctrl+a")
    session.type("75")
    session.press("return")
    assert session.table("lamps")["first"].power == 75.0
    session.save(tmp_path / "lit.json")
    assert Session.open(tmp_path / "lit.json").table("lamps")["first"].on == 1
    session.model.delete([session.particles["mass"]])
    assert session.table("lamps").count == 0


PANEL = """
import numpy as np

def spectrum(session):
    force = np.sort(np.abs(session.rods.axial_force))[::-1]
    if len(force) == 0:
        return None
    rank = np.arange(1.0, len(force) + 1.0)
    rows = (("largest", f"{force[0]:.2f} kN"), ("rods", str(len(force))))
    return Readout("Forces", rows, Plot("rank", "kN", (("force", rank, force),)))

def plugin(app):
    app.panel(spectrum)
"""


def test_a_panel_with_a_curve(write_mod: Write) -> None:
    session = opened(write_mod, "ranks", PANEL, "isostatic")
    session.update_view()
    panel = next(panel for panel in session.view.readouts if panel.title == "Forces")
    assert panel.rows[1] == ("rods", "3")
    assert panel.plot is not None


EXPORTER = """
def export(words):
    parser = Parser(prog="pinjoint dxf", description="Write rods as lines of a DXF file.")
    add_model(parser)
    add_output(parser)
    options = parser.parse_args(words)
    session = Session.open(options.model)
    places = session.particles.position
    lines = [(rod.name, *places[rod.between[0]].tolist(), *places[rod.between[1]].tolist()) for rod in session.rods]
    write_result(options, lines, lambda lines: [("rod", "x1", "y1", "x2", "y2"), *lines],
        lambda lines: (f"0\\nLINE\\n8\\n{n}\\n10\\n{a}\\n20\\n{b}\\n11\\n{c}\\n21\\n{d}" for n, a, b, c, d in lines))
    return ANSWERED

def plugin(app):
    app.command("dxf", export, "write a DXF file")
"""


def test_an_exporter(write_mod: Write, tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    opened(write_mod, "dxf", EXPORTER, "isostatic")
    assert main(["dxf", "isostatic", "--output", str(tmp_path / "lines.dxf")]) == 0
    assert (tmp_path / "lines.dxf").read_text().count("LINE") == 3
    assert main(["dxf", "isostatic", "--format", "csv"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "rod,x1,y1,x2,y2"
    assert main(["dxf", "isostatc"]) == 2
    assert "isostatic" in capsys.readouterr().err


HEUN = """
class Heun(RungeKutta4):
    \"\"\"2nd order, two stages.\"\"\"
    name, order, particle_rows, radius = "heun.heun2", 2, 2 + 2, 0.5
    constants = runge_kutta_constants(Tableau(2, ({}, {0: 1.0}), {0: 0.5, 1: 0.5}))

def plugin(app):
    app.integrator(Heun)
"""


def test_an_integrator(write_mod: Write) -> None:
    pulled = json.loads(json.dumps(PULLED))
    pulled["particles"][1] |= {"velocity": [1, 0], "mass": 1}
    pulled["rods"][0] |= {"stiffness": 10, "damping": 0}
    errors = []
    session = opened(write_mod, "heun", HEUN, pulled)
    session.settings.integrator = "heun2"
    for step in (1e-3, 5e-4):
        session.settings.time_step = step
        session.run(time=0.05)
        errors.append(abs(session.particles["mass"].velocity[0] - cos(100 * 0.05)))
        session.restart()
    assert 3.5 < errors[0] / errors[1] < 4.5


PLATE = """
import numpy as np

class Plate(Handle):
    table, noun, points = "plates", "plate", ("a", "b", "c")
    name: Field[str] = Field(dtype=str, doc="Unique among the plates.")
    a: Field[tuple] = Field("m", shape=(2,), doc="First corner.", shown=CM)
    b: Field[tuple] = Field("m", shape=(2,), doc="Second corner.", shown=CM)
    c: Field[tuple] = Field("m", shape=(2,), doc="Third corner.", shown=CM)

def draw(sheet):
    plates = sheet.model.tables["plates"]
    if plates.count:
        corners = np.stack([plates.a, plates.b, plates.c], axis=1)
        yield Fills(sheet.view.camera.to_pixels(corners), faded(sheet.theme.ink, 0.2))

def plugin(app):
    app.kind(Plate)
    app.tool(Plate, key="y", title="draw a plate", icon=[("area", (-8, 6, 8, 6, 0, -8))])
    app.layer(draw, below=True)
"""


def test_a_tool_with_three_points(write_mod: Write) -> None:
    session = opened(write_mod, "plates", PLATE, PULLED)
    for place in ((0.0, -1.0), (1.0, -1.0), (0.5, -2.0)):
        session.press("y", session.point(*place))
    [plate] = session.table("plates")
    assert (plate.a, plate.b, plate.c) == ((0.0, -1.0), (1.0, -1.0), (0.5, -2.0))
    session.press("ctrl+z")
    assert session.table("plates").count == 0
    assert session.notice == "Undone: new plate"


SOFT = """
@compiled
def rub(apart, drift, particles_mass):
    near = max(0.0, 1.0 - (apart[0] ** 2 + apart[1] ** 2) / 0.25)
    grip = 0.001 * particles_mass[0] * particles_mass[1] * near
    return grip * drift[0], grip * drift[1]

class Rub(Law):
    name, each, kernel, account = "soft.rub", "pairs", rub, "dissipated_damping"
    reads = ("particles.mass",)
    def cutoff(self, model):
        return 0.5

def plugin(app):
    app.system(Rub)
"""


def test_soft_friction(write_mod: Write) -> None:
    two = [
        {"name": name, "position": [x, 0], "mass": 1, "velocity": [0, v], "radius": 0.01}
        for name, x, v in (("A", 0.0, 0.1), ("B", 0.3, -0.1))
    ]
    session = opened(write_mod, "soft", SOFT, FORMAT | {"particles": two})
    session.run(time=0.1)
    (_, v), (_, w) = session.particles.velocity.tolist()
    assert abs(v + w) < 1e-12
    assert abs(v - 0.1 * exp(-2 * (1 - 0.36) * 0.1)) < 1e-4
    assert math.isclose(session.energy.dissipated_damping, 0.01 - 0.5 * (v * v + w * w), rel_tol=1e-4)


LESSON = """
{"format": "pinjoint session", "version": 1, "title": "In the wind", "mods": {"breezy": "1.0"}}
{"task": "Double the wind.", "model": MODEL, "until": ["environment.breezy_speed = 20 ± 1"], "hints": ["The environment."],
 "right": "It blows at {environment.breezy_speed}.", "solution": [{"set": "environment.breezy_speed=20"}]}
"""
BREEZY = """
class Wind(Component):
    of = Environment
    speed: Field[float] = Field("m/s", doc="Of the wind, to the right.", default=10.0)

@compiled
def push(particles_velocity, environment_breezy_speed):
    return 1e-3 * (environment_breezy_speed - particles_velocity[0]), 0.0

class Push(Law):
    name, each, kernel = "breezy.push", "particles", push
    reads = ("particles.velocity", "environment.breezy_speed")

def plugin(app):
    app.component(Wind)
    app.system(Push)
"""


def test_a_lesson_about_a_mod(write_mod: Write, tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    session = opened(write_mod, "breezy", BREEZY, BALL)
    session.run(time=0.1)
    assert abs(session.particles["A"].velocity[0] - (10 - 9 * exp(-0.1))) < 1e-6
    head, task = LESSON.strip().split("\n", 1)
    text = f"{head}\n{task.replace('MODEL', json.dumps(BALL)).replace(chr(10), ' ')}\n"
    (tmp_path / "lesson.jsonl").write_text(text, encoding="utf-8")
    assert main(["play", str(tmp_path / "lesson.jsonl")]) == 0, capsys.readouterr()
