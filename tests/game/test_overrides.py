"""Overrides of the command line: what they change, what they refuse and how they say so."""

import pytest

from pinjoint.components.commands import Command
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.paths import PathError, apply_override
from tests.reference.models import model, particle, rod, triangle


@pytest.fixture
def frame() -> Model:
    loads = [{"on": "B", "force": [0, -10]}, {"on": "C", "name": "gust.1", "force": [1, 0]}]
    return models.parse(triangle() | {"loads": loads, "grids": [{}]})


def test_vectors(frame: Model) -> None:
    apply_override(frame, "particles.B.force=120.5,-1.6e2")
    assert frame.particles["B"].force == (120.5, -160.0)
    apply_override(frame, "particles.B.force = [ 1, 2 ]")
    assert frame.particles["B"].force == (1.0, 2.0)


def test_units_may_be_named(frame: Model) -> None:
    apply_override(frame, "particles.B.force=300 N,-2.5 MN")
    apply_override(frame, "rods.*.rest_length=150 cm")
    assert frame.particles["B"].force == (0.3, -2500.0)
    assert frame.rods["AB"].prescribed_rest_length == 1.5
    with pytest.raises(PathError, match=r"^particles.B.force.x=2 t: must be in N, kN, MN, not in t"):
        apply_override(frame, "particles.B.force.x=2 t")


def test_single_components(frame: Model) -> None:
    apply_override(frame, "particles.B.force.y=-1")
    assert frame.particles["B"].force == (120.0, -1.0)
    apply_override(frame, "particles.A.fixed.x=true")
    assert frame.particles["A"].fixed == (True, True)
    apply_override(frame, "environment.acceleration.y=-9.81")
    assert frame.environment.acceleration == (0.0, -9.81)


def test_single_elements_have_no_name(frame: Model) -> None:
    apply_override(frame, "settings.restitution=0.5")
    apply_override(frame, "settings.integrator=automatic")
    apply_override(frame, "settings.collisions=False")
    assert (frame.settings.restitution, frame.settings.collisions) == (0.5, False)


@pytest.mark.parametrize("word", ["null", "none", "None"])
def test_null_takes_a_value_away(frame: Model, word: str) -> None:
    for path in ("settings.time_step", "particles.B.mass", "rods.AB.rest_length", "rods.AB.tensile_strength"):
        apply_override(frame, f"{path}=0.25")
    assert frame.rods["AB"].tensile_strength == frame.settings.time_step == 0.25
    for path in ("settings.time_step", "particles.B.mass", "rods.AB.rest_length", "rods.AB.tensile_strength"):
        apply_override(frame, f"{path}={word}")
    assert frame.settings.time_step is None
    assert frame.particles["B"].prescribed_mass is None
    assert frame.rods["AB"].prescribed_rest_length is None
    assert frame.rods["AB"].tensile_strength is None


def test_keys_are_those_of_model_files(frame: Model) -> None:
    apply_override(frame, "particles.B.mass=7")
    apply_override(frame, "rods.AB.rest_length=1.5")
    apply_override(frame, "particles.B.velocity=1,0")
    apply_override(frame, "rods.AB.name=first")
    assert frame.particles["B"].prescribed_mass == 7.0
    assert frame.rods["first"].prescribed_rest_length == 1.5
    assert frame.particles["B"].velocity == (1.0, 0.0)


def test_every_element_of_a_table(frame: Model) -> None:
    log: list[Command] = []
    frame.on_command = log.append
    apply_override(frame, "rods.*.damping=0")
    apply_override(frame, "particles.*.force.x=3")
    assert frame.rods.damping.tolist() == [0.0, 0.0, 0.0]
    assert frame.particles.force.tolist() == [[3.0, 0.0], [3.0, -160.0], [3.0, 0.0]]
    assert len(log) == 2  # undoable, one step each


def test_every_element_of_an_empty_table() -> None:
    empty = models.parse(model([], []))
    with pytest.raises(PathError, match=r"^rods\.\*\.damping=0: the model has no rods"):
        apply_override(empty, "rods.*.damping=0")
    assert len(empty.rods) == 0


def test_loads_and_their_histories(frame: Model) -> None:
    apply_override(frame, "loads.load 1.force=0,-20")
    apply_override(frame, 'loads.load 1.history={"kind": "ramp", "duration": 0.5}')
    assert frame.loads["load 1"].force == (0.0, -20.0)
    assert frame.loads["load 1"].history == {"kind": "ramp", "start": 0.0, "duration": 0.5}
    apply_override(frame, "loads.gust.1.force.y=4")
    assert frame.loads["gust.1"].force == (1.0, 4.0)


def test_names_with_dots_spaces_and_equals_signs() -> None:
    names = ["B", "B.force", "B.force.x", "a = b", ".", "=.=", "x.y z"]
    net = models.parse(model([particle(name, n, 0) for n, name in enumerate(names)], []))
    for number, name in enumerate(names):
        apply_override(net, f"particles.{name}.acceleration={number},0")
        apply_override(net, f"particles.{name}.acceleration.y={-number}")
    assert net.particles.acceleration.tolist() == [[n, -n] for n in range(len(names))]
    apply_override(net, "particles.B.force.x=5")  # a key follows "B", none follows "B.force"
    assert net.particles["B"].force == (5.0, 0.0)


REFUSED = {
    "particle.B.force=1,2": "there is no table 'particle'; did you mean 'particles'?",
    "clock.time=1": "there is no table 'clock'; choose one of environment, settings, particles",
    "particles.BB.force=1,2": "There is no 'BB' among the particles; did you mean 'B'?",
    "loads.gust 1.force.x=1": "There is no 'gust 1' among the loads; did you mean 'gust.1'?",
    "particles.B.forse=1,2": "there is no key 'forse'; did you mean 'force'?",
    "settings.restition=1": "there is no key 'restition'; did you mean 'restitution'?",
    "rods.AB=5": "what is meant of it is missing; write rods.AB.KEY, with one of ",
    "particles.force=1,2": "the name of the particle is missing; write particles.NAME.force=1,2, or * for every name",
    "particles.B.force": "it has no value; write it like particles.B.force=120,-160",
    "nonsense": "there is no table 'nonsense'; choose one of",
    "": "there is no table ''; choose one of",
    "rods.AB.axial_force=5": "'axial_force' is computed and cannot be set; choose one of name, stiffness",
    "rods.AB.between=A,C": "'between' names other elements and cannot be set here",
    "rods.AB.stiffness=-5": "rod AB: stiffness is -5 kN; it must be greater than 0 kN",
    "rods.*.stiffness=soft": "rod AB: stiffness is 'soft'; it must be a number",
    "rods.AB.stiffness=nan": "rod AB: stiffness is nan; it must be a finite number",
    "rods.AB.damping=null": "rod AB: damping coefficient is None; it must be a number",
    "rods.AB.stiffness=": "rod AB: stiffness is ''; it must be a number",
    "rods.AB.stiffness.x=5": "stiffness has no parts, such as 'x'; write stiffness.",
    "particles.B.force.z=5": "load has no part 'z'; write one of force.x, force.y",
    "particles.B.force=5": "particle B: load needs two entries, [x, y]; it has 1",
    "particles.B.force=1,2,3": "particle B: load needs two entries, [x, y]; it has 3",
    "particles.B.fixed=yes,no": "must be true or false",
    "particles.C.velocity=1,0": "particle C: velocity x is 1 m/s, but a support holds it along x",
    "particles.*.name=Q": "There is a particle 'Q' already",
    "rods.AB.rest_length=0": "rod AB: rest length is 0 m; it must be greater than 0 m",
    "loads.load 1.history=ramp": "load 1: history is 'ramp'; it must be like",
    "settings.integrator=rk9": "settings: integrator is 'rk9'; choose one of automatic",
}


@pytest.mark.parametrize(("override", "reason"), REFUSED.items(), ids=REFUSED.keys())
def test_mistakes_are_refused_and_explained(frame: Model, override: str, reason: str) -> None:
    before = models.document(frame)
    with pytest.raises(PathError) as caught:
        apply_override(frame, override)
    assert str(caught.value).startswith(f"{override}: ")
    assert reason in str(caught.value)
    assert models.document(frame) == before


def test_a_rod_may_lose_its_rest_length_only_while_it_has_a_distance() -> None:
    ends = [particle("A", 0, 0), particle("B", 0, 0)]
    stub = models.parse(model(ends, [rod("A", "B", rest_length=1)]))
    with pytest.raises(PathError, match="its ends are at the same place"):
        apply_override(stub, "rods.AB.rest_length=null")
    assert stub.rods["AB"].prescribed_rest_length == 1.0
