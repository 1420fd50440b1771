"""`mods check` finds what a mod names and does not exist, and nothing in mods that are as they should be."""

import pytest

from pinjoint import mods
from pinjoint.checks import Trial
from tests.mods.conftest import Write

KERNEL = """
from pinjoint.api import *

@compiled
def pull(particles_mass):
    return 0.0, 0.0

class Pull(Law):
    name, each, kernel, reads = "fig.pull", "particles", pull, ("particles.mass",)
    {law}

def plugin(app):
    app.system(Pull)
"""
SCENE = """
from pinjoint.api import *

class Arcade(Scene):
    name = "arcade"
    {scene}

class Score(System):
    name, phase = "fig.score", Phase.EVENTS
    {system}
    def process(self, frame): self.read()
    def read(self): "Not its `reads`."

def plugin(app):
    app.scene(Arcade)
    app.system(Score)
"""
KIND = """
from pinjoint.api import *

class Tie(Handle):
    table, noun = "ties", "tie"
    name: Field[str] = Field(dtype=str, doc="Unique.")
    on: Field[int] = Field(dtype="reference", references="particles", doc="Where it is.")
    {kind}

class Load(Component):
    of = Particle
    amount: Field[float] = Field("C", doc="Of electricity.")
    {component}

def plugin(app):
    app.kind(Tie)
    app.component(Load)
"""
NEEDED = """
from pinjoint.api import *
import numpy as np

class Charge(Component):
    of = Particle
    amount: Field[float] = Field("C", doc="Of electricity.")

@compiled
def push(much):
    return much, 0.0

class Push(Law):
    name, each, kernel = "fig.push", "particles", push
    def needs(self, model):
        return bool((model.particles.fig_amount > 100.0).any())
    def arrays(self, model):
        return {{"much": 0.01 * model.particles.fig_amount}} if self.needs(model) else {nothing}

def plugin(app):
    app.component(Charge)
    app.system(Push)
"""


def found(write_mod: Write, code: str) -> list[str]:
    (mod,) = mods.load([write_mod("fig", code)])
    assert not mod.problem
    return Trial(mod).found


@pytest.mark.parametrize(
    "code",
    [
        SCENE.format(
            scene='sources, systems, hits = ("pause",), (*PHYSICS, "fig.*"), 0',
            system='before, after = ("probes.sampling",), ("absent.system",)',
        ),
        KIND.format(kind="", component="LARGEST: float = 2.0"),
        KIND.format(
            kind="between: Field[tuple[int, int]] = Field(dtype='reference', references='particles', shape=(2,), doc='2')",
            component="",
        ),
        NEEDED.format(nothing='{"much": np.zeros(0)}'),
        NEEDED.format(nothing="{}"),
    ],
)
def test_a_good_mod_has_no_problem(code: str, write_mod: Write) -> None:
    assert found(write_mod, code) == []


def test_a_kernel_that_no_model_of_the_check_needs_is_told_as_a_note(write_mod: Write) -> None:
    found(write_mod, NEEDED.format(nothing="{}"))
    assert mods.MODS[-1].notes == ["fig.push was not tried: the model of this check does not need it."]


@pytest.mark.parametrize(
    ("code", "said"),
    [
        (KERNEL.format(law='scenes = ("simulatoin",)'), "fig.pull, scenes: There is no 'simulatoin' among the scenes"),
        (KERNEL.format(law="def need(self, model): return True"), "Pull.need means nothing; did you mean 'needs'?"),
        (KERNEL.replace("kernel, reads", "kernle, reads").format(law=""), "Pull.kernle means nothing; did you mean 'ke"),
        (KERNEL.format(law="scnees = ()"), "Pull.scnees means nothing; did you mean 'scenes'?"),
        (KERNEL.replace("    return 0.0", "    print(1)\n    return 0.0").format(law=""), "The kernel of fig.pull prints"),
        (SCENE.format(scene='sources = ("nowhere",)', system=""), "arcade, sources: There is no 'nowhere'"),
        (SCENE.format(scene='targets = ("pause", "staitcs")', system=""), "did you mean 'statics'?"),
        (SCENE.format(scene='systems = ("physisc.*",)', system=""), "arcade, systems: There is no 'physisc.*'"),
        (SCENE.format(scene='headnig = "A"', system=""), "Arcade.headnig means nothing; did you mean 'heading'?"),
        (SCENE.format(scene='', system='before = ("files.autosaev",)'), "did you mean 'files.autosave'?"),
        (SCENE.format(scene='', system='after = ("probse.sampling",)'), "did you mean 'probes.sampling'?"),
        (KIND.format(kind="size: float = 1.0", component=""), "Tie.size is not a Field; write size: Field[float] = F"),
        (KIND.format(kind="", component="lost: Field[float]"), "Load.lost is not a Field; write lost: Field[float]"),
        (KIND.format(kind='point = ("on",)', component=""), "Tie.point means nothing; did you mean 'points'?"),
    ],
)  # fmt: skip
def test_a_bad_mod_is_told_what_is_wrong(code: str, said: str, write_mod: Write) -> None:
    problems = found(write_mod, code)
    assert any(said in problem for problem in problems), problems


def test_a_kind_that_refers_to_no_table_is_left_out(write_mod: Write) -> None:
    (mod,) = mods.load(
        [write_mod("fig", KIND.replace('"particles"', "Particle").format(kind="", component=""))]
    )
    assert "Tie.on: There is no " in mod.problem
    assert "choose one of environment, settings, clock, particles, rods" in mod.problem
