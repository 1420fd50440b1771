"""check_system finds what a system does beside what it declares; all of ours pass."""

import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from pinjoint import Session, SystemCheckError, check_system
from pinjoint.checks import BODIES, ELASTIC, EVERYTHING
from pinjoint.components import Model
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.documents.autosave import Autosave
from pinjoint.documents.document import document
from pinjoint.included.probes import Sampling
from pinjoint.mods import ModError
from pinjoint.preparation import Preparation
from pinjoint.systems.base import Law, Phase, StepSystem, System
from pinjoint.systems.catalogue import step_systems
from pinjoint.systems.collision.system import Collision
from pinjoint.systems.edit.hover import Hover
from pinjoint.systems.edit.pull import Hand, Pull
from pinjoint.systems.input.pygame_input import PygameInput
from pinjoint.systems.physics.integrators import INTEGRATORS, VelocityVerlet
from pinjoint.systems.program.kernel import compiled
from pinjoint.systems.render.pygame_render import PygameRender
from tests.mods.conftest import Write

CABLES = EVERYTHING | {"rods": [rod | {"tension_only": True} for rod in EVERYTHING["rods"]]}
FRAME = EVERYTHING | {
    "rods": [rod | {"bending_stiffness": 50.0, "temperature_gradient": 5.0} for rod in EVERYTHING["rods"]]
}
HINGES = FRAME | {"rods": [rod | {"plastic_moment": 1.0} for rod in FRAME["rods"]]}
STRUTS = EVERYTHING | {
    "rods": [
        rod | {"buckles": True, "hinged": [True, True], "bending_stiffness": 1.0} for rod in EVERYTHING["rods"]
    ]
}
OURS = {system.name: system for system in [*step_systems(), *(make() for make in EXTENSIONS.systems)]}


def again(system: StepSystem) -> System:
    return system


@pytest.mark.parametrize("name", [n for n in OURS if n.startswith(("physics", "plasticity", "loads.ramp"))])
def test_our_step_systems_pass(name: str) -> None:
    others = {
        "physics.elasticity": ELASTIC,
        "physics.slackness": CABLES,
        "physics.buckling": STRUTS,
        "physics.axial_damping_of_cables": CABLES,
        **dict.fromkeys(("plasticity.hinges", "plasticity.turning", "plasticity.first_hinges"), HINGES),
        **dict.fromkeys(("physics.bending", "physics.bending_damping", "physics.turning_drag"), FRAME),
    }
    assert check_system(partial(again, OURS[name]), [others.get(name, EVERYTHING)]).needed == 1


@pytest.mark.parametrize("name", INTEGRATORS)
def test_our_integrators_pass(name: str) -> None:
    assert check_system(type(INTEGRATORS[name]), ["isostatic"]).needed == 1


def test_collisions_pass_in_free_flight_and_with_a_wall_that_steps_end_at() -> None:
    falling = BODIES | {
        "environment": {"acceleration": [0.0, -9.81]},
        "settings": {"restitution": 0.5},
        "components": {"walls.Wall": [{"name": "floor", "start": [-9.0, -0.1], "end": [9.0, -0.1]}]},
    }
    driven = falling | {"environment": {"acceleration": [0.0, -9.81], "drag": 0.1}, "settings": {}}
    assert check_system(Collision, [falling, driven]).needed == 2


class Pulling(Pull):
    """A hand that holds particle B of whatever model it meets first."""

    def needs(self, model: Model) -> bool:
        if self.hand is None:
            self.take(Hand(model.particles["B"], 100.0, 1.0, (0.01, 0.0)))
        return super().needs(model)


def test_the_hand_passes() -> None:
    assert check_system(Pulling, [EVERYTHING]).needed == 1


def test_what_lies_in_contact_passes() -> None:
    lying = BODIES | {
        "environment": {"acceleration": [0.0, -9.81], "drag": 0.1},
        "settings": {"restitution": 0.0},
        "components": {"walls.Wall": [{"name": "floor", "start": [-9.0, -0.1], "end": [9.0, -0.1]}]},
    }
    session = Session.open(lying)
    session.run(time=0.5)
    assert check_system(Collision, [document(session.model)]).needed == 1


def test_our_frame_systems_pass(tmp_path: Path) -> None:
    pygame.init()
    surface = pygame.Surface((320, 200))
    preparations: list[Preparation] = []

    def preparation() -> Preparation:
        preparations.append(Preparation())
        return preparations[-1]

    frames = [
        Hover,
        Sampling,
        PygameInput,
        partial(PygameRender, surface),
        preparation,
        partial(Autosave, tmp_path),
    ]
    for make in frames:
        assert check_system(make, [EVERYTHING, BODIES]).needed == 2
    for made in preparations:
        made.close()


def test_an_integrator_is_checked_where_it_takes_the_steps() -> None:
    assert check_system(VelocityVerlet, [BODIES, ELASTIC]).needed == 1
    with pytest.raises(SystemCheckError, match=r"No model uses physics.velocity_verlet; .* with rods or drag"):
        check_system(VelocityVerlet, [BODIES])


AGEING = """
from pinjoint.components import Component, Field, Rod, Role
from numba import njit
from pinjoint.systems.base import Commit, Law

class Age(Component):
    of = Rod
    age: Field[float] = Field("s", title="age", doc="Grows with time.", role=Role.STATE)

@njit
def older(rods_aged_age, dt):
    return rods_aged_age + dt, 0.0

@njit
def weak(rods_aged_age):
    return 0.001 * rods_aged_age

class Ageing(Commit):
    name = "aged.ageing"
    kernel = older
    writes = ("rods.aged_age",)

class Weak(Law):
    name = "aged.weak"
    kernel = weak
    reads = ("rods.aged_age",)

def plugin(app):
    app.component(Age)
    app.system(Ageing)
    app.system(Weak)
"""


def test_what_another_system_of_the_mod_writes_is_not_held_against_a_law(write_mod: Write) -> None:
    Session.open("isostatic", mods=[write_mod("aged", AGEING)])
    aged = sys.modules["aged"]
    assert check_system(aged.Weak, [ELASTIC]).needed == 1
    assert check_system(aged.Ageing, [ELASTIC]).needed == 1


def test_an_integrator_that_depends_on_chance_is_found_out() -> None:
    class Moody(VelocityVerlet):
        name = "test.moody"

        @staticmethod
        def stable_step(frequency: float, decay: float) -> float:
            return float(np.random.default_rng().uniform(1e-5, 1e-4))

    with pytest.raises(SystemCheckError, match=r"test\.moody: run twice, it gives another"):
        check_system(Moody, ["isostatic"])
    assert "moody" not in INTEGRATORS


@compiled
def nothing(particles_mass):
    return 0.0 * particles_mass, 0.0


@compiled
def root(particles_position):
    return (particles_position[0] - 1.0) ** 0.5, 0.0


class Still(Law):
    name = "test.still"
    each = "particles"
    kernel: ClassVar[str | Callable[..., Any]] = nothing
    reads = ("particles.mass",)


class Root(Still):
    kernel = root
    reads = ("particles.position",)


class Meddling(Still):
    def arrays(self, model: Model) -> Mapping[str, NDArray[Any]]:
        model.particles[0].force = (9.0, 9.0)
        return {}


class Asking(Still):
    def needs(self, model: Model) -> bool:
        model.particles[0].force = (9.0, 9.0)
        return True


class Undeclared(Still):
    reads = ()


class Unneeded(Still):
    def needs(self, model: Model) -> bool:
        return False


class Frames(System):
    name = "test.frames"
    phase = Phase.EDIT
    writes: ClassVar[tuple[str, ...]] = ("particles.velocity",)

    def process(self, frame: Any) -> None:
        frame.session.model.writable("particles.velocity")[:, 0] += 1.0


class Silent(Frames):
    writes = ()


class Random(Frames):
    def process(self, frame: Any) -> None:
        velocity = frame.session.model.writable("particles.velocity")
        velocity[:, 0] += np.random.default_rng().random()


class Endless(Frames):
    def process(self, frame: Any) -> None:
        frame.session.model.writable("particles.velocity")[:] = np.inf


class Raising(Frames):
    def process(self, frame: Any) -> None:
        raise KeyError("gone")


@pytest.mark.parametrize("system", [Still, Frames])
def test_a_good_system_passes(system: type[System]) -> None:
    assert check_system(system, [BODIES]).needed == 1


@pytest.mark.parametrize(
    ("system", "said"),
    [
        (Root, "numbers grow without limit"),
        (Meddling, "it changed particles.force"),
        (Asking, r"needs\(model\) changed particles.force"),
        (Undeclared, "does not declare that it reads 'particles.mass'"),
        (Unneeded, "No model needs test.still"),
        (Silent, "changed particles.velocity, which it does not declare"),
        (Random, "run twice, it gives another particles.velocity"),
        (Endless, "particles.velocity is not finite"),
        (Raising, "raises KeyError"),
    ],
)
def test_a_bad_system_is_found_out(system: type[System], said: str) -> None:
    with pytest.raises(SystemCheckError, match=said):
        check_system(system, [BODIES])


def test_the_order_of_registration_must_not_matter() -> None:
    """Two laws that replace the axial force, unordered: which comes last decides."""

    class Tight(Law):
        name = "test.tight"
        kernel = compiled(lambda axial_force: axial_force + 100.0)
        adds = ("rods.axial_force",)

    with pytest.raises(SystemCheckError, match="registered in another order"):
        check_system(Tight, [EVERYTHING])


def test_a_system_of_a_mod_is_checked_by_its_name_with_its_components(unloaded: None) -> None:
    ball = {"name": "A", "position": [0, 0], "components": {"wind.Sail": {"area": 1.0}}}
    document = {"format": "pinjoint model", "version": 1, "particles": [ball]}
    folder = Path(__file__).parents[2] / "assets" / "mods" / "wind"
    assert check_system("wind.push", [document], mods=[folder]).needed == 1
    with pytest.raises(SystemCheckError, match=r"no 'wind\.pull' among the systems.*did you mean 'wind\.push'"):
        check_system("wind.pull", [document])
    with pytest.raises(ModError, match="There is no mod in"):
        check_system("wind.push", mods=[folder.parent.parent / "fonts"])


class Attraction(Law):
    name = "test.attraction"
    each = "pairs"
    kernel = compiled(
        lambda apart, particles_mass: (particles_mass[0] * apart[0], particles_mass[0] * apart[1])
    )
    reads = ("particles.mass",)


class Spring(Attraction):
    kernel = compiled(lambda apart: (0.1 * apart[0], 0.1 * apart[1]))
    potential = compiled(lambda apart: 0.05 * (apart[0] * apart[0] + apart[1] * apart[1]))


class Harder(Spring):
    potential = compiled(lambda apart: 0.1 * (apart[0] * apart[0] + apart[1] * apart[1]))


def test_laws_of_pairs_are_checked_for_opposite_forces_and_those_of_their_potential() -> None:
    apart = BODIES | {
        "particles": [one | {"position": [9e3 * n, 0]} for n, one in enumerate(BODIES["particles"])]
    }
    assert check_system(Spring, [BODIES, apart]).needed == 2
    with pytest.raises(SystemCheckError, match="change if the two are swapped"):
        check_system(Attraction, [BODIES])
    with pytest.raises(
        SystemCheckError, match=r"the slope of its potential is 0\.52.* kN, but the force on the .* is 0\.26"
    ):
        check_system(Harder, [BODIES])
